"""Figures 7a to 7e: energies and dissipation."""

import pytest

from rattlebox.paper import figure_07a, figure_07b
from rattlebox.paper.seed import DAMPING, MASS

PULSE_WORK = 0.2532  # J, of 5000 N


@pytest.fixture(scope="module", params=[figure_07a, figure_07b])
def energies(request):
    """Return the data of figures 7a and 7b."""
    return request.param.FIGURE.data()


def test_pulse_gives_the_structure_its_work(energies):
    """Right after the pulse the structure holds its work, less what damping can have taken; the ball holds nothing."""
    energy = energies.begin_energy.sel(begin=1.2e-3, method="nearest")
    most_damped = 2 * DAMPING / MASS * 1.2e-3
    assert (energy.sel(part="structure") > (1 - most_damped) * PULSE_WORK).all()
    assert (energy.sel(part="structure") < PULSE_WORK).all()
    assert energy.sel(part="ball").values == pytest.approx(0.0, abs=1e-15)


def test_band_of_energies_is_ordered_and_falls(energies):
    """Median energies lie in their band and fall by more than a decade."""
    low, median, high = energies["mean"].transpose("quantile", ...)
    assert (low <= median).all()
    assert (median <= high).all()
    structure = median.sel(part="structure")
    assert (structure.isel(window=-1) < 0.1 * structure.isel(window=0)).all()


def test_smoothness_is_judged_by_the_data():
    """The verdict follows the numbers: with rises below those of constant restitution it turns."""
    data = figure_07a.FIGURE.data()
    (claim,) = figure_07a.FIGURE.claims(data)
    assert claim.verdict == "not reproducible"
    smooth = data.assign(rises=data.rises.where(data.judged == "constant restitution", 0.0))
    (claim,) = figure_07a.FIGURE.claims(smooth)
    assert claim.verdict == "reproduced"
