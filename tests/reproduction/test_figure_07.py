"""Figures 7a to 7e: energies and dissipation."""

import pytest

import rattlebox as rb
from reproduction import figure_07de
from reproduction.judge import verdict
from reproduction.system import DAMPING, MASS, PLASTIC_RIGID, paper_case

PULSE_WORK = 0.2532  # J, of 5000 N


@pytest.fixture
def energies(computed):
    """Return the data of figures 7a and 7b."""
    return computed("figure_07a").data


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


@pytest.fixture
def losses(computed):
    """Return the data of figure 7c."""
    return computed("figure_07c").data


@pytest.mark.parametrize(
    ("model", "share", "scatter"),
    [
        ("constant restitution", 0.054, 0.0015),
        ("elasto-plastic, steel wall", 0.0032, 0.0001),
        ("elasto-plastic, rigid wall", 0.069, 0.003),
    ],
)
def test_shares_of_the_centred_ball(losses, model, share, scatter):
    """The damper takes the known part of the pulse's work, in each interpretation."""
    lost = losses.lost.sel(model=model, quantile=0.5).isel(time=-1) / losses.work
    assert float(lost) == pytest.approx(share, abs=scatter)


def test_losses_only_grow(losses):
    """In no model does the energy lost in impacts decrease."""
    assert (losses.single.diff("time") >= 0).all()


def test_first_contact_has_the_ratio_of_the_two_laws(losses):
    """After one contact with the same approach the losses differ as 1 - e^2 of the two laws."""
    ratio = losses.ratio.sel(plastic="elasto-plastic, rigid wall", quantile=0.5).isel(time=1)
    (pair, *_) = rb.contact_pairs(paper_case(PLASTIC_RIGID), 0)
    approach = rb.simulate(paper_case(PLASTIC_RIGID, duration=4e-3)).arrays.impacts.approach_speed[0]
    e = rb.restitution_curve(PLASTIC_RIGID.restitution, pair, approach)
    assert float(ratio) == pytest.approx((1 - e**2) / (1 - 0.991170**2), rel=1e-3)


@pytest.fixture(scope="module")
def shares():
    """Return the data of figures 7d and 7e for fewer starts."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(figure_07de, "MEMBERS", 8)
        yield figure_07de.data()


@pytest.mark.parametrize(
    ("model", "expected"),
    [
        ("constant restitution", (0.054, 0.015, 0.052)),
        ("elasto-plastic, steel wall", (0.0032, 0.0, 0.0022)),
        ("elasto-plastic, rigid wall", (0.069, 0.029, 0.071)),
        ("elasto-plastic, rigid wall, also in stiffness", (0.073, 0.030, 0.068)),
    ],
)
def test_shares_of_three_starts_at_the_printed_pulse(shares, model, expected):
    """At 5000 N the damper takes the known shares, within the scatter of a chaotic system."""
    lost = shares.impact.sel(model=model, amplitude=5000.0)
    assert lost.sel(quantile=0.5).values == pytest.approx(expected, rel=0.08, abs=1e-4)


def test_shares_never_exceed_the_work(shares):
    """Impacts and viscous damping together take no more than the work of the pulse."""
    assert (shares.impact_single + shares.viscous_single <= 1 + 1e-12).all()


def test_consistency_follows_the_data(shares):
    """Case 2 is not the most consistent, and would be if its losses were the same at all amplitudes."""
    (claim,) = figure_07de.FIGURE.claims(shares)
    assert verdict(claim) == "not reproducible"
    (claim,) = figure_07de.FIGURE.claims(shares.assign(impacts=shares.impacts.where(shares.start != 2, 0.05)))
    assert verdict(claim) == "under one interpretation only"
    (claim,) = figure_07de.FIGURE.claims(shares.assign(impacts=shares.impacts.where(shares.start == 1, 0.05)))
    assert verdict(claim) == "not reproducible"  # both orders alike: neither is the most consistent
