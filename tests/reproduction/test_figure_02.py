"""Figure 2: the damping coefficient for a restitution."""

from math import sqrt

import numpy as np
import pytest

from reproduction.figure_02 import FIGURE


@pytest.fixture
def data(computed):
    """Compute the figure once."""
    return computed("figure_02").data


@pytest.mark.parametrize(
    ("ending", "expected"),
    [
        ("zero_overlap", (0.7292476, 0.3723261, 0.1630335, 0.0015238)),
        ("zero_force", (0.7440794, 0.4509755, 0.2984361, 0.1552827)),
    ],
)
def test_simulated_impacts_give_the_exact_restitution(data, ending, expected):
    """Impacts at damping ratios 0.1, 0.3, 0.5 and 0.9 lose what the exact solution says, at both endings."""
    met = [data.simulated.sel(ending=ending).sel(tried=ratio * sqrt(5)) for ratio in (0.1, 0.3, 0.5, 0.9)]
    np.testing.assert_allclose(met, expected, atol=6e-8)


def test_the_printed_coefficient(data):
    """The printed coefficient means a restitution of 0.991170, and 0.99 needs another one."""
    overlap = data.sel(ending="zero_overlap")
    assert float(overlap.printed_e) == pytest.approx(0.991170, abs=6e-7)
    assert float(overlap.needed_alpha) == pytest.approx(0.00715342, abs=6e-9)


def test_curves_pass_through_the_simulated_impacts(data):
    """The drawn line and the simulated impacts are the same relation."""
    for ending in data.ending.values:
        one = data.sel(ending=ending)
        inside = one.simulated > float(data.e[0])
        drawn = np.interp(one.simulated[inside][::-1], data.e, np.log(one.alpha))
        np.testing.assert_allclose(drawn[::-1], np.log(data.tried[inside]), atol=2e-3)


def test_fit_is_worse_near_one_the_wider_its_range(data):
    """Where steel lives a fit from a smaller least restitution deviates more, and each of them serves elsewhere."""
    deviation = data.deviation.sel(ending="zero_overlap")
    assert np.all(np.diff(deviation.sel(e=0.999)) > 0)
    assert float(deviation.where(data.e < 0.9).max()) < 1e-3


def test_verdicts_follow_the_data(data):
    """The paper's coefficient and fit are confirmed, and a restitution that does not round to 0.99 is not."""
    assert [claim.verdict for claim in FIGURE.claims(data)] == ["reproduced", "reproduced qualitatively"]
    wrong = data.assign(printed_e=data.printed_e * 0.98)
    assert FIGURE.claims(wrong)[0].verdict == "not reproducible"
