"""Confidence intervals of correlated series whose mean is known."""

import numpy as np
import pytest
from scipy.signal import lfilter

from rattlebox.analysis import mean_interval


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.9])
def test_coverage_of_autoregressive_series(memory):
    """Of 400 intervals of an autoregressive series, 91 to 98 % hold the mean."""
    rng = np.random.default_rng(11)
    inside, given = 0, 0
    for _ in range(400):
        found = mean_interval(3 + lfilter([1], [1, -memory], rng.normal(size=6000))[1000:])
        given += found.is_long_enough
        inside += found.lower < 3 < found.upper
    assert given > 390
    assert 0.91 < inside / given < 0.98


def test_a_short_or_drifting_series_has_no_interval():
    """A random walk, a trend and nine samples leave the limits open; the mean is still given."""
    rng = np.random.default_rng(2)
    for series in (np.cumsum(rng.normal(size=300)), np.linspace(0, 1, 500) + 0.01 * rng.normal(size=500), range(9)):
        found = mean_interval(series)
        assert not found.is_long_enough and np.isnan(found.half_width)
        assert found.mean == pytest.approx(np.mean(series))


def test_a_constant_is_exact():
    """A constant series has an interval of no width."""
    assert mean_interval([2.5] * 20)[:3] == (2.5, 2.5, 2.5)


def test_the_mean_of_a_periodic_series():
    """The interval of a sine over many periods holds zero and is not wider than that of independent samples."""
    series = np.sin(0.3 * np.arange(5000))
    found = mean_interval(series)
    assert found.lower < 0 < found.upper
    assert found.half_width < 2 * 1.96 * series.std() / np.sqrt(series.size) + 0.02
