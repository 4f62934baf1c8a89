"""Statistical error of means over steady or chaotic motions."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]

FEWEST_BATCHES = 10
"""Smallest number of batches for an interval."""


class Interval(NamedTuple):
    """Mean with its 95 % confidence interval: `mean`, its limits `lower` and `upper` (NaN if the samples are too few), and
    the number of independent `batches` (0 if there are too few).
    """

    mean: float
    lower: float
    upper: float
    batches: int

    @property
    def half_width(self) -> float:
        """Half of the width of the interval; NaN if the samples are too few for it."""
        return 0.5 * (self.upper - self.lower)

    @property
    def is_long_enough(self) -> bool:
        """Whether there are enough samples for an interval."""
        return self.batches > 0


def mean_interval(values: ArrayLike) -> Interval:
    """Compute the mean of a correlated, stationary series and its 95 % confidence interval by batch means.

    Parameters
    ----------
    values : (N,) array_like
        One number per interval of equal length, such as evenly spaced samples of a signal or the loss in each cycle,
        without the transient.

    Returns
    -------
    Interval
        Mean, limits and number of batches. Limits are NaN if there are fewer than ten independent batches; the run is then
        too short.

    Raises
    ------
    ValueError
        If a value is not finite, or the array is not one-dimensional.

    Notes
    -----
    Neighbouring batches are averaged in pairs until the means of the batches are no longer correlated (lag-one correlation r
    below 1.645 / sqrt(n), one-sided, for n batches) nor follow a trend (Mann-Kendall test of ten batches, 1 %). Then mean +-
    t s sqrt((1 + r) / (1 - r)) / sqrt(n), r >= 0, with Student's t of n - 1 degrees of freedom. If no batches are found
    and the means of ten batches differ by less than 0.1 % of the mean, as at the end of a transient to periodic motion,
    half the interval is the range of these ten.

    References
    ----------
    G. S. Fishman (1978), Grouping observations in digital simulation, Management Science 24(5), 510-521,
    doi:10.1287/mnsc.24.5.510.

    H. B. Mann (1945), Nonparametric tests against trend, Econometrica 13, 245-259, doi:10.2307/1907187.

    Examples
    --------
    >>> import numpy as np
    >>> result = mean_interval(np.random.default_rng(1).normal(5.0, 1.0, 4000))
    >>> result.lower < 5.0 < result.upper, round(result.half_width, 2)
    (True, 0.03)
    """
    x = np.asarray(values, dtype=np.float64)
    if x.ndim != 1 or not x.size or not np.isfinite(x).all():
        raise ValueError(f"values of shape {x.shape} must be a one-dimensional array of finite numbers")
    mean = float(np.mean(x))
    (half,), (batches,) = half_widths(x[None])
    return Interval(mean, mean - float(half), mean + float(half), int(batches))


def half_widths(series: NDArray[np.float64]) -> tuple[FloatArray, NDArray[np.intp]]:
    """Return half of the width of the 95 % interval of the mean of each of many series, and its number of batches.

    Parameters
    ----------
    series : (K, N) float
        Series, see `mean_interval`. Those with a number that is not finite have no interval.

    Returns
    -------
    half : (K,) float
        Half widths; NaN without an interval.
    batches : (K,) int
        Numbers of independent batches; 0 without an interval.
    """
    from scipy.special import stdtrit

    count = len(series)
    half, found = np.full(count, np.nan), np.zeros(count, np.intp)
    left = np.flatnonzero(np.isfinite(series).all(axis=1))
    x = np.asarray(series, dtype=np.float64)[left]
    if x.shape[1] >= FEWEST_BATCHES and left.size:
        constant = np.ptp(x, axis=1) <= 1e-12 * np.abs(x.mean(axis=1))
        half[left[constant]], found[left[constant]] = 0.0, x.shape[1]
        left, x = left[~constant], x[~constant]
    ten, which = _ten_means(x) if x.shape[1] >= FEWEST_BATCHES else x.T, left
    while x.shape[1] >= FEWEST_BATCHES and left.size:
        n = x.shape[1]
        r = _lag_one(x)
        enough = (r < 1.645 / math.sqrt(n)) & (np.abs(_trend(_ten_means(x))) < _TREND)
        r = np.maximum(r[enough], 0.0)
        error = np.std(x[enough], ddof=1, axis=1) * np.sqrt((1 + r) / (1 - r) / n)
        half[left[enough]], found[left[enough]] = float(stdtrit(n - 1, 0.975)) * error, n
        left, x = left[~enough], x[~enough]
        x = x[:, : n // 2 * 2].reshape(len(x), n // 2, 2).mean(axis=2)
    if len(ten) >= FEWEST_BATCHES:
        span = np.ptp(ten, axis=0)
        close = (found[which] == 0) & (span <= _CLOSE * np.abs(ten.mean(axis=0)))
        half[which[close]], found[which[close]] = span[close], FEWEST_BATCHES
    return half, found


_CLOSE = 1e-3
"""Range of ten means over the mean below which a trend does not matter."""
_TREND = 29
"""Sum of signs of ten numbers (Mann-Kendall) from which they follow a trend: both sides, 1 %."""


def _lag_one(x: FloatArray) -> FloatArray:
    d = x - x.mean(axis=1, keepdims=True)
    total = (d * d).sum(axis=1)
    return np.asarray((d[:, 1:] * d[:, :-1]).sum(axis=1) / np.where(total > 0, total, 1.0))


def _ten_means(x: FloatArray) -> FloatArray:
    """Return the means of ten parts of each series, (10, K)."""
    return np.array([part.mean(axis=1) for part in np.array_split(x, FEWEST_BATCHES, axis=1)])


def _trend(ten: FloatArray) -> FloatArray:
    """Return the sum of the signs of all differences of ten means of each series (Mann-Kendall)."""
    return np.asarray(sum(np.sign(ten[k + 1 :] - ten[k]).sum(axis=0) for k in range(FEWEST_BATCHES - 1)))
