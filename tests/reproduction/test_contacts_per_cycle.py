"""Figure A2: contacts per cycle."""

from math import pi

import numpy as np
import pytest

from rattlebox import simulate
from reproduction import contacts_per_cycle
from reproduction.harmonic import harmonic_case, two_impacts
from reproduction.judge import verdict
from reproduction.system import DAMPING, GAP, MASS, STIFFNESS

FEW = np.array([8.0, 21.0, 22.0, 23.0])


@pytest.fixture(scope="module")
def data():
    """Return the data for a few of the frequencies."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(contacts_per_cycle, "FREQUENCIES", FEW)
        yield contacts_per_cycle.FIGURE.data()


def test_two_contacts_where_theory_has_a_stable_motion_with_two(data):
    """Above 20 Hz every cycle has the two contacts of the exact motion, which is stable there."""
    for frequency in FEW[1:]:
        exact, _ = two_impacts(
            mass=MASS,
            stiffness=STIFFNESS,
            damping=DAMPING,
            ball=1.200037,
            clearance=2 * GAP,
            restitution=0.991170,
            amplitude=contacts_per_cycle.AMPLITUDE,
            frequency=frequency,
        )
        assert exact.multiplier < 1
        one = data.sel(model="constant restitution", frequency=frequency)
        assert float(one.share.sel(count=2)) == 1
        assert float(one["mean"]) == 2


def test_counts_change_where_it_is_irregular(data):
    """At 8 Hz the number differs from cycle to cycle."""
    assert float(data.share.sel(frequency=8.0).max()) < 0.9


def test_shares_are_those_of_all_counted_cycles(data):
    """Shares add up to one, their mean is the mean, and 15 s are counted."""
    np.testing.assert_allclose(data.share.sum("count"), 1)
    np.testing.assert_allclose((data.share * data["count"]).sum("count"), data["mean"])
    np.testing.assert_array_equal(data.cycles, 15 * FEW)


def test_marked_frequencies_are_those_of_the_system(data):
    """The attached ball lowers the natural frequency to 61.4295 rad/s; the bare amplitude is the analytical one."""
    assert 2 * pi * float(data.resonance) == pytest.approx(61.4295, abs=5e-5)
    bare = harmonic_case(amplitude=20.0, frequency=21.0, duration=20.0, rate=4200.0, ball=False)
    last = simulate(bare).motion.displacement.sel(time=slice(19.0, None))
    assert float(data.alone.sel(frequency=21.0)) == pytest.approx(float(last.max()), rel=1e-4)


def test_drawn_and_judged(data):
    """The figure can be drawn, and the claim depends on the data."""
    figure = contacts_per_cycle.FIGURE
    assert len(figure.draw(data).axes) == 4
    assert "The number of contacts in a cycle" in figure.caption(data)
    assert verdict(figure.claims(data)[0]) == "not reproducible"  # so few frequencies have one number only
    changing = data.copy()
    changing["share"] = data.share.where(data.frequency > 8, 0) + ((data["count"] == 3) & (data.frequency == 8))
    changing["share"] = changing.share.where(data.frequency < 23, 0.5 * (data["count"] < 2))
    assert verdict(figure.claims(changing)[0]) == "reproduced"
