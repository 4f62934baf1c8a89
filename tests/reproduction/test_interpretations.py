"""Figure R1: interpretations of the paper."""

import numpy as np
import pytest

from reproduction.interpretations import FIGURE
from reproduction.judge import verdict


@pytest.fixture
def data(computed):
    """Compute the figure once."""
    return computed("interpretations").data


def test_size_of_the_ball(data):
    """The printed size gives 6 % of the structure's mass and 0.8 mm of clearance as a radius, and neither as a diameter."""
    assert float(data.mass_share.sel(size="radius")) * 20 == pytest.approx(1.200037, abs=6e-7)
    np.testing.assert_allclose(data.clearance, [0.8e-3, 33.97e-3], rtol=1e-12)
    assert float(data.impacts.sel(size="diameter", start=1).max()) == 0
    assert float(data.impacts.sel(size="radius", start=1).min()) > 100


def test_elastic_limits(data):
    """Wall and reduced mass give the four elastic limits."""
    np.testing.assert_allclose(data.critical_speed, [[0.1694607, 0.1645947], [0.0423652, 0.0411487]], atol=6e-8, rtol=0)


def test_numbers_of_the_contact(data):
    """The stiffness follows from the paper's parameters, and γ in the first impact is four orders above the print."""
    assert float(data.stiffness) == pytest.approx(2.668518e10, rel=3e-7)
    assert float(data.gamma) == pytest.approx(71.0, abs=0.1)


@pytest.mark.parametrize(
    ("reading", "expected"),
    [
        ("constant α, contact ends at zero overlap", (0.054, 0.015, 0.052)),
        ("elasto-plastic, steel wall", (0.0032, 0.0, 0.0022)),
        ("elasto-plastic, rigid wall", (0.069, 0.027, 0.070)),
    ],
)
def test_losses_of_the_main_interpretations(data, reading, expected):
    """The stored shares lie in the band of each case, to their last digit."""
    low, _, high = data.share.sel(reading=reading).transpose("level", "start").values
    last_digit = 1e-3 if max(expected) > 0.01 else 1e-4
    assert np.all(low - last_digit <= expected)
    assert np.all(high + last_digit >= expected)


def test_loss_does_not_depend_on_the_ending_or_the_stiffness(data):
    """With a constant coefficient the ending moves the loss by a few per cent, and so does the printed stiffness."""
    first = data.share.sel(level=0.5, start=1)
    np.testing.assert_allclose(first[[1, 3]] / first[0], 1, atol=0.05)


def test_verdicts_follow_the_data(data):
    """The mass is confirmed and three prints are not; with the two sizes swapped the diameter would be right."""
    assert [verdict(claim) for claim in FIGURE.claims(data)] == ["reproduced", "misprint", "misprint", "misprint"]
    swapped = data.assign({name: ("size", data[name].values[::-1]) for name in ("mass_share", "clearance")})
    assert [verdict(claim) for claim in FIGURE.claims(swapped)][:2] == ["not reproducible", "reproduced"]
