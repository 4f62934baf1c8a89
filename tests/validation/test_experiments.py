"""Published experiments: short versions of the scripts in examples/validation, and the scripts themselves (slow)."""

import runpy
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

ROOT = Path(__file__).parents[2]
SCRIPTS = ROOT / "examples" / "validation"
DATA = ROOT / "docs" / "validation" / "data"


def script(name):
    """Return the names that a script defines."""
    return runpy.run_path(str(SCRIPTS / f"{name}.py"))


def test_amplitude_falls_linearly_in_weightlessness():
    """The decrement of the first cycles is constant and between 0.7 and 1.0 diameters."""
    import rattlebox as rb

    names = script("microgravity_decay")
    decrement, deviation = names["linear_part"](names["peaks"](rb.simulate(names["case"](duration=5.0)))[1])
    assert 0.7 < decrement / names["DIAMETER"] < 1.0
    assert deviation < 0.01


def test_best_amplitude_is_the_clearance_over_pi():
    """The loss is near 4 m A^2 w^2 there, and small at three quarters of the amplitude."""
    names = script("collect_and_collide")
    best = names["clearance"]() / np.pi
    loss = names["losses"](best * np.array([0.75, 1.0]), cycles=(3, 3))
    assert loss[1] > 3.5
    assert loss[0] < 0.5 * loss[1]


def test_variants_repeat_the_number_with_other_contacts_and_steps(monkeypatch):
    """Means and intervals of the variants are those of the values; softening and step reach the function."""
    monkeypatch.syspath_prepend(SCRIPTS)
    names = script("stiffer_and_finer")
    means, errors = names["variants"](lambda seed, softening, fraction: seed + softening * fraction, 1000, 4)
    assert means == pytest.approx([2.5 + 25, 2.5 + 12.5, 2.5 + 12.5])
    assert errors == pytest.approx(np.std([1, 2, 3, 4], ddof=1))
    fine = names["microgravity_decay"].case(fraction=0.0125, softening=500)
    assert (fine.method.fraction, fine.dampers[0].softening) == (0.0125, 500)


def test_data_set_can_be_read_and_has_units():
    """The published numbers have units, and those of the page."""
    losses = xr.open_dataset(DATA / "losses.nc").load()
    assert losses.loss.sel(ratio=1.0).values == pytest.approx([3.81, 3.76, 3.82, 3.55], abs=0.01)
    decays = xr.open_dataset(DATA / "decays.nc").load()
    assert decays.displacement.attrs["units"] == "m"
    masses = xr.open_dataset(DATA / "masses.nc").load()
    assert (masses.effective_mass.sel(acceleration=slice(20, None)) < 0).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["microgravity_decay", "collect_and_collide", "bouncing_bed", "six_per_cent", "stiffer_and_finer"]
)
def test_script(name, tmp_path, monkeypatch):
    """Each script asserts the numbers of the page."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(SCRIPTS)
    runpy.run_path(str(SCRIPTS / f"{name}.py"), run_name="__main__")
