"""Figure 6: phase portrait in a fixed cavity."""

import numpy as np
import pytest

from reproduction.figure_06 import FIGURE
from reproduction.judge import verdict


@pytest.fixture
def data(computed):
    """Compute the figure once."""
    return computed("figure_06").data


def test_speeds_after_hits(data):
    """From ten times the elastic limit the simulated ball slows down by the law."""
    hits = (1, 2, 5, 10, 20, 50, 100)
    expected = (8.282785, 7.019261, 4.725903, 3.028556, 1.853870, 1.164212, 1.026469)
    np.testing.assert_allclose(data.simulated.sel(hit=list(hits)), expected, atol=6e-7)


def test_elastic_limit_with_the_mass_of_the_ball(data):
    """In a cavity that does not move the reduced mass is that of the ball."""
    assert float(data.critical_speed.sel(yield_stress=1.03e9)) == pytest.approx(0.1645947, abs=6e-8)


def test_approach_ends_in_the_power_law(data):
    """The simulated approach follows the law to round-off, and its late slope that of the power law."""
    np.testing.assert_allclose(data.above, data.predicted_above, atol=1e-12)
    late = data.isel(hit=slice(1500, None))
    slope, expected = (np.polyfit(np.log(late.hit), np.log(values), 1)[0] for values in (late.above, late.asymptote))
    assert expected == pytest.approx(-1 / 0.156, rel=1e-6)
    assert slope == pytest.approx(expected, rel=0.07)


def test_portrait_stays_in_its_zone(data):
    """Between the walls the ball that starts plastic is faster than the limit, the elastic one keeps its speed."""
    inside = np.abs(data.place) < 1 - 1e-9
    plastic, elastic = (np.abs(data.speed.sel(zone=zone).where(inside.sel(zone=zone))) for zone in data.zone.values)
    assert float(plastic.min()) > 1
    assert float(np.abs(elastic - 0.8).max()) < 1e-9
    assert 1.2 < float(np.abs(data.place).max()) < 1.4


def test_motion_is_not_chaotic(data):
    """Starts that differ by a micrometre have the same speeds after the same hits."""
    assert float(data.spread.max()) < 1e-9


def test_verdicts_follow_the_data(data):
    """A ball that lost speed in the elastic zone would reverse the verdict on the misprint."""
    assert [verdict(claim) for claim in FIGURE.claims(data)] == [
        "follows from the equations",
        "misprint",
        "follows from the equations",
    ]
    assert verdict(FIGURE.claims(data.assign(elastic_drift=0.01))[1]) == "reproduced"
