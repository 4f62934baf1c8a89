"""Figure 2: the damping coefficient for a restitution."""

from math import sqrt

import numpy as np
import pytest

from reproduction.figure_02 import FIGURE
from reproduction.judge import verdict


@pytest.fixture
def data(computed):
    """Compute the figure once."""
    return computed("figure_02").data


def test_simulated_impacts_give_the_exact_restitution(data):
    """Impacts at damping ratios 0.1, 0.3, 0.5 and 0.9 have the loss of the exact solution."""
    met = [1 - data.simulated_missed.sel(tried=ratio * sqrt(5)) for ratio in (0.1, 0.3, 0.5, 0.9)]
    np.testing.assert_allclose(met, (0.7292476, 0.3723261, 0.1630335, 0.0015238), atol=6e-8)


def test_the_printed_coefficient(data):
    """The printed coefficient means a restitution of 0.991170, and 0.99 needs another one."""
    assert 1 - float(data.printed_missed) == pytest.approx(0.991170, abs=6e-7)
    assert float(data.needed_alpha) == pytest.approx(0.00715342, abs=6e-9)


def test_curves_pass_through_the_simulated_impacts(data):
    """The drawn line and the simulated impacts are the same relation."""
    inside = data.simulated_missed < 0.99
    drawn = np.interp(np.log(data.simulated_missed[inside]), np.log(data.missed), np.log(data.alpha))
    np.testing.assert_allclose(drawn, np.log(data.tried[inside]), atol=2e-3)


def test_fit_is_worse_near_one_the_wider_its_range(data):
    """Near e = 1 a fit from a smaller least restitution deviates more, and each of them serves elsewhere."""
    assert np.all(np.diff(data.deviation.sel(missed=1e-3, method="nearest")) > 0)
    assert float(data.deviation.where(data.missed > 0.1).max()) < 1e-3


def test_verdicts_follow_the_data(data):
    """The coefficient is confirmed unless its restitution does not round to 0.99; the fit cannot be checked."""
    assert [verdict(claim) for claim in FIGURE.claims(data)] == ["reproduced", "cannot be checked"]
    assert verdict(FIGURE.claims(data.assign(printed_missed=0.02))[0]) == "not reproducible"
