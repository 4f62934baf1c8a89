"""Confidence intervals of correlated series whose mean is known."""

import numpy as np
import pytest
from scipy.signal import lfilter

from rattlebox._util.batch_means import half_widths
from rattlebox.analysis import mean_interval


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.9])
def test_coverage_of_autoregressive_series(memory):
    """Of 400 intervals of an autoregressive series, 91 to 98 % hold the mean."""
    rng = np.random.default_rng(11)
    inside, given = 0, 0
    for _ in range(400):
        result = mean_interval(3 + lfilter([1], [1, -memory], rng.normal(size=6000))[1000:])
        given += result.is_long_enough
        inside += result.lower < 3 < result.upper
    assert given > 390
    assert 0.91 < inside / given < 0.98


def test_a_short_or_drifting_series_has_no_interval():
    """A random walk, a trend and nine samples leave the limits open; the mean is still given."""
    rng = np.random.default_rng(2)
    for series in (np.cumsum(rng.normal(size=300)), np.linspace(0, 1, 500) + 0.01 * rng.normal(size=500), range(9)):
        result = mean_interval(series)
        assert not result.is_long_enough and np.isnan(result.half_width)
        assert result.mean == pytest.approx(np.mean(series))


def test_a_constant_is_exact():
    """A constant series has an interval of no width."""
    assert mean_interval([2.5] * 20)[:3] == (2.5, 2.5, 2.5)


def test_the_mean_of_a_periodic_series():
    """The interval of a sine over many periods holds zero and is not wider than that of independent samples."""
    series = np.sin(0.3 * np.arange(5000))
    result = mean_interval(series)
    assert result.lower < 0 < result.upper
    assert result.half_width < 2 * 1.96 * series.std() / np.sqrt(series.size) + 0.02


def test_many_series_at_once():
    """Series that are evaluated together have the intervals that each has alone; one with a gap has none."""
    rng = np.random.default_rng(5)
    series = np.array([lfilter([1], [1, -memory], rng.normal(size=64)) for memory in np.linspace(0, 0.95, 30)])
    series[3, 7] = np.nan
    half, batches = half_widths(series)
    for k, row in enumerate(series):
        if k == 3:
            assert np.isnan(half[k]) and batches[k] == 0
        else:
            alone = mean_interval(row)
            assert batches[k] == alone.batches
            assert half[k] == pytest.approx(alone.half_width, rel=1e-12, nan_ok=True)
    assert 0 < np.count_nonzero(batches) < 30


def test_the_end_of_a_transient():
    """A trend below 0.1 % of the mean gives the range of ten means; one of 1 % gives no interval."""
    decay = np.exp(-np.arange(200) / 60)
    result = mean_interval(5 + 2e-3 * decay)
    assert result.lower < 5.0 < result.upper and result.half_width < 2e-3
    assert np.isnan(mean_interval(5 + 5e-2 * decay).half_width)
