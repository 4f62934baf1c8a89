"""Figure 4: two schemes for one ball."""

import numpy as np
import pytest

from reproduction import figure_04
from reproduction.judge import verdict


@pytest.fixture
def data(computed):
    """Return the data of the figure."""
    return computed("figure_04").data


def test_both_schemes_lose_the_known_share(data):
    """Both schemes lose 5.4 % of the work of the pulse in impacts, as the ensemble does, and shares add up to the work."""
    assert data.impact_share.values == pytest.approx(0.054, abs=0.0015)
    assert data.scatter.values == pytest.approx(0.054, abs=0.0015)
    assert data.level.isel(channel=-1, time=-1).values == pytest.approx(1, abs=1e-5)


def test_starts_within_a_micrometre_part_too(data):
    """The band of the ensemble is thin at first and later as wide as the cavity."""
    early, late = data.ball_spread.isel(later=0), data.ball_spread.sel(later=slice(1.2, None))
    assert np.ptp(early.values) < 0.1 * figure_04.CAVITY
    assert float((late.sel(quantile=0.9) - late.sel(quantile=0.1)).max()) > 0.5 * figure_04.CAVITY


def test_pulse_gives_its_work(data):
    """After the pulse the structure has the work of 0.2532 J, less the little that damping can take."""
    energy = data.energy.sel(part="structure", begin=1.5e-3, method=None)
    assert ((energy > 0.997 * 0.2532) & (energy < 0.2532)).all()


def test_rounding_errors_alone_stay_small_for_a_second(data):
    """Two double-precision solutions agree to 1e-9 m for more than a second, and have nothing in common after two."""
    twin = data.distance.sel(other="event-driven, step by step")
    assert (twin.sel(window=slice(0, 1.1)) < 1e-9).all()
    assert (twin.sel(window=slice(2.5, 4)) > 0.1 * figure_04.CAVITY).any()
    assert 1.2 < float(data.parted.sel(other="event-driven, step by step")) < 2.5


def test_time_stepping_parts_earlier_than_rounding_does(data):
    """The steps of the paper make a larger error than rounding, so they part earlier."""
    theirs, twin = data.parted.sel(other=["time-stepping", "event-driven, step by step"]).values
    assert 0.5 < theirs < twin


def test_growth_is_exponential_until_the_size_of_the_cavity(data):
    """Pairs separate at a rate well above its error, along the fit, and no farther than the cavity lets them."""
    assert float(data.exponent) > 10 * float(data.error) > 0
    fit = data.fit.dropna("window")
    decades = np.log10(data.pairs.sel(quantile=0.5, window=fit.window) / fit)
    assert abs(decades).max() < 1
    assert data.pairs.max() < 1.1 * figure_04.CAVITY


def test_claims_follow_the_data(data):
    """The curves of Li et al. cannot be checked; chaos needs a growth rate above its error."""
    assert [verdict(claim) for claim in figure_04.FIGURE.claims(data)] == ["cannot be checked", "reproduced"]
    assert verdict(figure_04.FIGURE.claims(data.assign(error=data.exponent))[1]) == "not reproducible"
