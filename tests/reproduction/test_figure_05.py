"""Figure 5: restitution against approach speed."""

import numpy as np
import pytest

from reproduction.figure_05 import FIGURE
from reproduction.judge import verdict
from reproduction.models import RIGID


@pytest.fixture
def data(computed):
    """Compute the figure once."""
    return computed("figure_05").data


def test_elastic_limits(data):
    """Yield begins at the speeds that follow from the paper's parameters, fourfold lower on a rigid wall."""
    np.testing.assert_allclose(data.critical_speed, [0.1694607, 0.0423652], atol=6e-8)


def test_curves_are_the_published_laws(data):
    """Jackson and Green's law has its published values at 10 and 30 V_c, and Thornton's tail its power law."""
    for wall in data.wall.values:
        at = float(data.critical_speed.sel(wall=wall)) * np.array([10.0, 30.0])
        law = data.restitution.sel(law="Jackson-Green", wall=wall)
        np.testing.assert_allclose(np.interp(at, data.speed, law), [0.8282785, 0.6955521], atol=2e-4)
    tail = data.restitution.sel(law="Thornton", wall=RIGID).where(data.speed > 10, drop=True)
    assert np.polyfit(np.log(tail.speed), np.log(tail), 1)[0] == pytest.approx(-0.25, abs=3e-3)


def test_impacts_stay_slow(data):
    """The pulse of 5 kN gives the structure 0.159 m/s, and no impact comes much faster than that."""
    assert 0.159 < float(data.largest_speed.max()) < 1.25 * 0.1591549
    np.testing.assert_array_less(data.share.sum("class"), 1 + 1e-12)


def test_claim_follows_the_data(data):
    """The claim that slow impacts lose nothing follows from the law, and fails with changed data."""
    assert verdict(FIGURE.claims(data)[0]) == "follows from the equations"
    assert verdict(FIGURE.claims(data.assign(restitution=0.99 * data.restitution))[0]) == "not reproducible"
