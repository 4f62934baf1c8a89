"""Confidence intervals of correlated series whose mean is known."""

import numpy as np
import pytest
from scipy.signal import lfilter

from rattlebox._util.batch_means import _STUDENT, FEWEST_VALUES, half_widths
from rattlebox.analysis import mean_interval


def autoregressive(memory, length, count, seed=11):
    """Return series x_k = memory x_(k - 1) + noise, with zero mean."""
    noise = np.random.default_rng(seed).normal(size=(count, length + 2000))
    return lfilter([1], [1, -memory], noise, axis=1)[:, -length:]


def squared_mode(damping, cycles, count, seed=12, each=20):
    """Return 64 means of the squared displacement of a mode under white noise over a number of its cycles, and their mean.

    The mean is that of the stationary autoregressive series of second order.
    """
    length = 64 * max(round(cycles * each / 64), 1)
    turn = 2 * np.pi * cycles / length
    shrink = np.exp(-damping * turn)
    first, second = 2 * shrink * np.cos(turn), -(shrink**2)
    burn = int(6 / (damping * turn))
    noise = np.random.default_rng(seed).normal(size=(count, length + burn))
    x = lfilter([1], [1, -first, -second], noise, axis=1)[:, -length:]
    variance = (1 - second) / ((1 + second) * ((1 - second) ** 2 - first**2))
    return (x**2).reshape(count, 64, -1).mean(axis=2), variance


def coverage(series, mean):
    """Return the share of series with an interval, and the share of intervals that hold the mean."""
    half, _ = half_widths(series)
    given = np.isfinite(half)
    inside = np.abs(series.mean(axis=1) - mean)[given] <= half[given]
    return given.mean(), inside.mean() if given.any() else 1.0, int(np.count_nonzero(~inside))


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.9])
def test_coverage_of_autoregressive_series(memory):
    """Nearly all long autoregressive series have an interval, and 93 to 99.5 % of the intervals hold the mean."""
    given, inside, _ = coverage(autoregressive(memory, 5000, 400), 0)
    assert given > 0.95
    assert 0.93 < inside <= 0.995


@pytest.mark.parametrize(
    ("damping", "cycles"), [(0.005, 100), (0.005, 200), (0.002, 500), (0.01, 100), (0.001, 1000), (0.02, 60)]
)
def test_a_mode_observed_for_a_few_correlation_times_has_no_interval(damping, cycles):
    """A lightly damped mode in a window of up to six correlation times has no interval.

    The series of other tests were longer than their correlation by a hundred times: the test of neighbouring batches
    misses a correlation that is longer than the window, and its intervals held the mean of such modes in 40 to 80 %.
    """
    given, _, wrong = coverage(*squared_mode(damping, cycles, 300))
    assert given <= 0.01
    assert wrong <= 2


@pytest.mark.parametrize(("damping", "cycles"), [(0.05, 200), (0.05, 400), (0.01, 1000), (0.005, 4000)])
def test_a_mode_observed_for_long_has_an_interval(damping, cycles):
    """In windows of more than 60 correlation times most series have an interval, and more than 92 % hold the mean."""
    given, inside, _ = coverage(*squared_mode(damping, cycles, 200))
    times = 2 * np.pi * damping * cycles
    assert given > (0.9 if times > 100 else 0.6)
    assert inside > 0.92


@pytest.mark.slow
def test_coverage_for_all_damping_ratios_and_lengths():
    """For damping from 0.1 to 5 % and windows of 50 to 2000 cycles at least 90 % of the intervals hold the mean.

    Where one series in fifty or fewer has an interval, single intervals are too narrow: they are counted
    against all series.
    """
    for damping in (0.001, 0.002, 0.005, 0.01, 0.02, 0.05):
        for cycles in (64, 100, 200, 500, 1000, 2000):
            given, inside, wrong = coverage(*squared_mode(damping, cycles, 300, each=12))
            assert inside >= 0.9 or wrong <= 0.012 * 300, (damping, cycles, given, inside)
            if 2 * np.pi * damping * cycles > 100:
                assert given > 0.9


@pytest.mark.slow
def test_coverage_of_correlated_series_of_all_lengths():
    """For memories from 0.5 to 0.99 and 100 to 10 000 samples at least 90 % of the intervals hold the mean."""
    for memory in (0.5, 0.7, 0.9, 0.95, 0.99):
        for length in (100, 300, 1000, 3000, 10_000):
            given, inside, wrong = coverage(autoregressive(memory, length, 400), 0)
            assert inside >= 0.9 or wrong <= 2, (memory, length, given, inside)
            if length * (1 - memory) / (1 + memory) > 150:
                assert given > 0.9


def test_a_short_or_drifting_series_has_no_interval():
    """A random walk, a trend and nineteen samples have a mean, and an interval of NaN."""
    rng = np.random.default_rng(2)
    for series in (
        np.cumsum(rng.normal(size=300)),
        np.linspace(0, 1, 500) + 0.01 * rng.normal(size=500),
        rng.normal(size=19),
    ):
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


def test_an_oscillation_of_few_cycles_has_no_interval():
    """The square of a sine whose amplitude changes slowly has no interval if the series holds thirty of its cycles."""
    time = np.arange(600)
    slow = 1 + 0.3 * np.sin(2 * np.pi * 1.3 * time / 600)
    assert not mean_interval((slow * np.sin(2 * np.pi * 30.3 * time / 600)) ** 2).is_long_enough


@pytest.mark.parametrize("cycles", [12.3, 17.71, 40.5, 90.25])
@pytest.mark.parametrize("per_cycle", [5.3, 11.0, 40.0])
def test_a_periodic_square_of_a_few_cycles_has_an_interval(cycles, per_cycle):
    """The square of a steady sine has a narrow interval that holds its exact mean, in windows of any number of cycles.

    No test saw that such windows were refused as too short: the tests had whole cycles, or some hundred of them.
    """
    for phase in (0.0, 0.4, 1.3):
        angle = 2 * np.pi * np.arange(round(cycles * per_cycle)) / per_cycle
        result = mean_interval(3.0 * np.sin(angle + phase) ** 2)
        assert result.lower - 1e-4 <= 1.5 <= result.upper + 1e-4
        assert result.half_width < 0.6 * 1.5 / cycles


def test_many_series_at_once():
    """Series that are evaluated together have the intervals that each has alone; one with a gap has none."""
    series = np.array([autoregressive(memory, 64, 1, seed=5)[0] for memory in np.linspace(0, 0.95, 30)])
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


def test_the_quantiles_are_those_of_student() -> None:
    """The table equals SciPy's quantiles, and has those of the smallest spectra: no test compared the constants."""
    from scipy.special import stdtrit

    assert {freedom: float(stdtrit(freedom, 0.975)) for freedom in _STUDENT} == pytest.approx(_STUDENT, rel=1e-15)
    for length in range(FEWEST_VALUES, 2 * FEWEST_VALUES):
        series = np.random.default_rng(length).normal(size=(50, length)) ** 2
        half_widths(series)
