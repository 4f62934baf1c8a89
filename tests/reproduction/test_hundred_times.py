"""Figure A1: losses of the elasto-plastic model over its yield stress."""

import pytest

from reproduction import hundred_times
from reproduction.models import RIGID, STEEL


@pytest.fixture
def data(computed):
    """Return the data of the figure."""
    return computed("hundred_times").data


@pytest.mark.parametrize(("model", "expected"), [(STEEL, 0.0032 / 0.054), (RIGID, 0.069 / 0.054)])
def test_printed_yield_stress_gives_the_known_ratio(data, model, expected):
    """With the printed yield stress the ratios of the losses in 10 s have their stored values."""
    ratio = data.ratio.sel(measure="total", model=model, yield_stress=1030e6, quantile=0.5)
    assert float(ratio) == pytest.approx(expected, rel=0.05)


def test_one_contact_cannot_lose_a_hundred_times_more(data):
    """A contact with e = 0.991170 loses 1 - e^2 of the energy, so another law loses at most 57 times as much."""
    assert float(data.bound.sel(measure="first")) == pytest.approx(1 / (1 - 0.991170**2), rel=1e-4)
    assert (data.ratio.sel(measure="first").dropna("yield_stress") < data.bound.sel(measure="first")).all()


def test_no_yield_stress_reaches_the_bounds(data):
    """Losses and speeds stay within what any restitution law can do, but for the scatter of the first touch."""
    assert (data.ratio.where(data.ratio.notnull(), 0) <= 1.005 * data.bound).all()


def test_curves_end_where_the_law_does(data):
    """A rigid wall lowers the critical speed, so its curve leaves the law at a higher yield stress."""
    ends = data.ratio.sel(measure="total", quantile=0.5).isnull().sum("yield_stress")
    assert ends.sel(model=RIGID) > ends.sel(model=STEEL)


def test_caption_has_the_largest_ratio(data):
    """The caption states the largest of the four ratios, and that it is below the claimed one."""
    most = float(data.ratio.sel(quantile=0.5, yield_stress=1030e6, model=RIGID).max())
    assert 8.8 < most < 12
    assert "no meaning of “faster” reaches 100 times" in hundred_times.FIGURE.caption(data)
