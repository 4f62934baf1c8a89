"""Figure 5: restitution against approach speed."""

import numpy as np
import pytest

from reproduction.figure_05 import FIGURE


@pytest.fixture
def data(computed):
    """Compute the figure once."""
    return computed("figure_05").data


def test_elastic_limits(data):
    """Yield begins at the speeds that follow from the paper's parameters, fourfold lower on a rigid wall."""
    np.testing.assert_allclose(data.critical_speed, [0.1694607, 0.0423652], atol=6e-8)


def test_marks_are_on_the_jackson_green_law(data):
    """At 1, 10, 60, 100 and 1000 times the elastic limit the law has its published values on both walls."""
    for wall in data.wall.values:
        np.testing.assert_allclose(
            data.marked_restitution.sel(wall=wall), [1.0, 0.8282785, 0.5905655, 0.5317981, 0.2542389], atol=6e-8
        )


def test_curves_are_reduced_by_the_elastic_limit(data):
    """Thornton's curve falls below 1 at its yield speed, and its tail falls with the fourth root of the speed."""
    tail = data.restitution.sel(law="Thornton", wall="rigid").where(data.speed > 100, drop=True)
    slope = np.polyfit(np.log(tail.speed), np.log(tail), 1)[0]
    assert slope == pytest.approx(-0.25, abs=2e-3)
    beyond = data.restitution.sel(law="Jackson-Green").where(data.speed > 1000 * data.critical_speed)
    assert bool(beyond.isnull().all())


def test_impacts_stay_slow(data):
    """The pulse of 5 kN gives the structure 0.159 m/s, and no impact comes much faster than that."""
    assert 0.159 < float(data.largest_speed.max()) < 1.25 * 0.1591549
    assert np.all(np.diff(data.faster, axis=-1) <= 0)
    assert bool((data.faster.where(data.speed > data.largest_speed, 0.0) == 0).all())


def test_verdicts_follow_the_data(data):
    """A restitution below the constant one is found on the rigid wall only, and the verdict says so."""
    elastic, low = FIGURE.claims(data)
    assert elastic.verdict == "reproduced"
    assert low.verdict == "reproduced qualitatively"
    assert FIGURE.claims(data.assign(constant=0.5))[1].verdict == "not reproducible"
    assert FIGURE.claims(data.assign(constant=1.0))[1].verdict == "reproduced"
