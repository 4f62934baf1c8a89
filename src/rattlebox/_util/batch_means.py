"""Statistical error of means over steady or chaotic motions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .narrow import unmasked

FloatArray = NDArray[np.float64]

FEWEST_VALUES = 30
"""Smallest number of values for an interval; fewer cannot show how long they are correlated."""
_LEAST_DECAY = 31.4
"""Shortest window of a linear motion for an interval, times the decay rate of its least damped mode: 31 correlation times
of the squared displacement, 2 x 31.4 decay rates, half of the window that suffices for most intervals."""
ENOUGH_DECAY = 2 * _LEAST_DECAY
"""Length of a window that suffices for most intervals, times the decay rate: 10 cycles over the damping ratio."""


def smooth_weights(part: ArrayLike) -> FloatArray:
    """Return the weights exp(-1 / (s (1 - s))) of values at parts s of a window, 0 outside of 0 < s < 1.

    Means with them converge much faster for regular motion than even ones (Das et al. 2017, doi:10.1088/1361-6544/aa84c2).
    """
    s = np.asarray(part, dtype=float)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        return np.where((s > 0) & (s < 1), np.exp(-1 / (s * (1 - s))), 0.0)


def shortest_window(decay: ArrayLike) -> float:
    """Return the shortest window in which a linear motion has an interval [s].

    `decay`: decay rates of the modes [1/s]. Those of zero belong to modes that never come to rest, and are left out.
    """
    rates = np.asarray(decay, dtype=float)
    rates = rates[rates > 0]
    return float(_LEAST_DECAY / rates.min()) if rates.size else 0.0


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
    r"""Compute the mean of a correlated, stationary series and its 95 % confidence interval.

    Parameters
    ----------
    values : (N,) array_like
        One number per interval of equal length, such as evenly spaced samples of a signal or the loss in each cycle,
        without the transient.

    Returns
    -------
    Interval
        Mean, limits and number of independent batches, N var(values) / S(0). Limits are NaN if the values do not show that
        their correlation is much shorter than the series; the run is then too short.

    Raises
    ------
    ValueError
        If a value is not finite, or the array is not one-dimensional.

    Notes
    -----
    The variance of the mean is S(0) / N with the spectral density S at frequency zero. The lowest up to 32 ordinates of the
    periodogram I_j, at j cycles per series, are compared with spectra of a correlation that decays exponentially,

    .. math:: S_j = \frac{S(0)}{1 + (j / c)^2}

    by Whittle's likelihood, with a prior uniform in log(c). The upper quartile of S(0) gives the interval by Student's t
    with 20 degrees of freedom. The series holds about pi c independent batches. No interval is given if c may be below 6
    with a probability above 80 % over the number of ordinates; if the lowest 6 or 12 ordinates alone contradict it, which
    recognises trends; or if there are fewer than 30 values. If the upper of at most 64 ordinates are larger than those in
    the middle, as in squares of an oscillation, only the lower half counts. A series that passes by chance has too small a
    scatter: near that limit the interval is up to 3.5 times as wide. There is also none if few ordinates, such as those of
    an oscillation of fewer than about 50 cycles, hold most of the power. If there is no interval, but the means of ten
    parts differ by less than 0.1 % of the mean, as at the end of a transient to periodic motion, half the interval is the
    range of these ten. The same holds for seven parts of a quarter of the series that are tapered by sin^4, which finds
    squares of a steady sine of 12 cycles or more; half the interval is then at least the change of the mean by the taper.

    The guide [](/how-to/analysis.md) states how often the interval holds the mean, and where it does not.

    References
    ----------
    P. Heidelberger, P. D. Welch (1981), A spectral method for confidence interval generation and run length control in
    simulations, Communications of the ACM 24(4), 233-245, doi:10.1145/358598.358630.

    P. Whittle (1953), Estimation and information in stationary time series, Arkiv foer Matematik 2, 423-434,
    doi:10.1007/BF02590998.

    Examples
    --------
    >>> import numpy as np
    >>> result = mean_interval(np.random.default_rng(1).normal(5.0, 1.0, 4000))
    >>> result.lower < 5.0 < result.upper, round(result.half_width, 2)
    (True, 0.05)
    """
    x = np.asarray(unmasked(values), dtype=np.float64)
    if x.ndim != 1 or not x.size or not np.isfinite(x).all():
        raise ValueError(f"values of shape {x.shape} must be a one-dimensional array of finite numbers")
    mean = float(np.mean(x))
    (half,), (batches,) = half_widths(x[None])
    return Interval(mean, mean - float(half), mean + float(half), int(batches))


def half_widths(series: NDArray[np.float64], least: ArrayLike = 0.0) -> tuple[FloatArray, NDArray[np.intp]]:
    """Return half of the width of the 95 % interval of the mean of each of many series, and its number of batches.

    `series`: series, see `mean_interval`. Those with a number that is not finite have no interval, (K, N). `least`:
    smallest number of values for an interval of each series, where the correlation is known; they may still agree by 0.1 %
    in ten parts. Returns half widths; NaN without an interval, (K,); and numbers of independent batches; 0 without an
    interval, (K,).
    """
    rows, length = series.shape
    half, batches = np.full(rows, np.nan), np.zeros(rows, np.intp)
    least = np.broadcast_to(least, rows)
    finite = np.flatnonzero(np.isfinite(series).all(axis=1))
    if length < _PARTS:
        return half, batches
    for start in range(0, finite.size, _ROWS):
        chosen = finite[start : start + _ROWS]
        x = np.asarray(series[chosen], dtype=np.float64)
        mean = x.mean(axis=1)
        variance = x.var(axis=1)
        # A constant has only rounding in its periodogram, which is not random.
        constant = np.ptp(x, axis=1) <= 1e-12 * np.abs(mean)
        if length >= FEWEST_VALUES:
            with np.errstate(divide="ignore", invalid="ignore"):
                width, level = _spectral_half_widths(x - mean[:, None])
                width[length < least[chosen]] = np.nan
                count = np.clip(length * variance / level, 1, length)
        else:
            width, count = np.full(chosen.size, np.nan), np.full(chosen.size, np.nan)
        ten = np.array([part.mean(axis=1) for part in np.array_split(x, _PARTS, axis=1)])
        span = np.ptp(ten, axis=0)
        periodic = _periodic_half_widths(x, mean)
        span = np.where(span <= _CLOSE * np.abs(mean), span, periodic)
        close = ~np.isfinite(width) & np.isfinite(span)
        width = np.where(constant, 0.0, np.where(close, span, width))
        count = np.where(constant, length, np.where(close, _PARTS, count))
        half[chosen] = width
        batches[chosen] = np.where(np.isfinite(width), np.nan_to_num(count, nan=0.0), 0).astype(np.intp)
    return half, batches


_ROWS = 4096
"""Series evaluated at once, which bounds the memory."""
_PARTS = 10
_CLOSE = 1e-3
"""Range of ten means over the mean below which a trend does not matter."""
_CORNERS = np.geomspace(0.25, 256, 41)
"""Corner frequencies c of the spectra [cycles per series]."""
_ORDINATES = 32
_SHORTEST = 6.0
"""Corner frequency below which there is no interval: about 19 correlation times."""
_GATES = (6, 2.0), (12, 4.0)
"""Smaller numbers of ordinates, and the corner frequencies that each must make improbable."""
_PEAK, _OSCILLATION = 4.0, 96
"""An oscillation is a mean of three ordinates above 4 times the median of lower ones, searched in the first 96."""
_CLEAR_PEAK, _FEW = 7.0, 64
"""Such a ratio of up to 64 ordinates is an oscillation however much power it holds."""
_RISE = 1.25
"""Ratio of the upper to the middle third of up to 64 ordinates above which only the lower half counts."""
_LOBE = 2.0
"""Ratio of the lowest three ordinates to the median of the next ones above which the spectrum may have a lobe at zero."""
_SPREAD, _NARROW, _CLEAR_SPREAD = 0.16, 0.25, 0.33
"""Effective share of the ordinates that hold the power below which there is no interval, below which an oscillation is
narrow, and below which there is no interval if up to 64 ordinates have a lobe at zero."""
_QUANTILE, _WIDENING = 0.75, 2.5
_STUDENT = {14: 2.144786687917804, 16: 2.1199052992212546, 18: 2.1009220402410382, 20: 2.085963447265864}
"""97.5 % quantile of Student's t by degrees of freedom, twice the ordinates of a fit and at most 20. `scipy.special` takes
0.2 s of processor time to import, a quarter of a short command."""
_DOUBT, _REFUSED = 0.8, 0.7
"""Probability of too low a corner frequency that is tolerated, times the number of ordinates, and of fewer ordinates."""


def _periodic_half_widths(x: FloatArray, mean: FloatArray) -> FloatArray:
    """Return half widths of periodic series of any number of periods; NaN for other series.

    The means of parts of a periodic series differ by the part of a period at their ends, which a taper to zero removes. The
    plain mean of the whole series differs from the tapered one, which is nearly exact, for the same reason.
    """
    length = x.shape[1]
    part = length // 4
    starts = np.arange(7) * (length - part) // 6

    def tapered(values: FloatArray) -> FloatArray:
        count = values.shape[1]
        weight = np.sin(np.pi * (np.arange(count) + 0.5) / count) ** 4
        return np.asarray(values @ (weight / weight.sum()))

    span = np.ptp([tapered(x[:, start : start + part]) for start in starts], axis=0)
    return np.where(span <= _CLOSE * np.abs(mean), np.maximum(span, np.abs(tapered(x) - mean)), np.nan)


def _spectral_half_widths(x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return half widths (NaN if refused) and spectral densities S(0) of series with zero mean."""
    length = x.shape[1]
    periodograms = np.abs(np.fft.rfft(x, axis=1)[:, 1 : (length - 1) // 2 + 1]) ** 2 / length
    periodograms = periodograms[:, :_OSCILLATION]
    count = periodograms.shape[1]
    # Effective number of the ordinates that hold the power: about half of all for noise.
    holders = periodograms.sum(axis=1) ** 2 / (periodograms**2).sum(axis=1)
    # An oscillation concentrates the power in few ordinates, and its lobe at zero frequency is then a guess.
    peak = _peak(periodograms)
    refused = (holders < _SPREAD * count) | ((holders < _NARROW * count) & (peak > _PEAK))
    half, level = _fitted(periodograms[:, :_ORDINATES], length)
    if count <= _FEW:
        # The lobe of a squared oscillation at twice its frequency makes a spectrum look flat that has one at zero, too.
        # A spectrum that rises from zero on, of parts that make up for each other, has none.
        lobe = periodograms[:, :3].mean(axis=1) > _LOBE * np.median(periodograms[:, 3 : max(count // 2, 4)], axis=1)
        refused |= lobe & ((peak > _CLEAR_PEAK) | (holders < _CLEAR_SPREAD * count))
        third = count // 3
        rises = lobe & (periodograms[:, -third:].mean(axis=1) > _RISE * periodograms[:, third : 2 * third].mean(axis=1))
        if rises.any():
            half[rises], level[rises] = _fitted(periodograms[rises, : -(-count // 2)], length)
    half[refused] = np.nan
    return half, level


def _fitted(periodograms: FloatArray, length: int) -> tuple[FloatArray, FloatArray]:
    """Return half widths (NaN if refused) and densities S(0) from ordinates of the periodograms of series of a length."""
    full = periodograms.shape[1]
    low, level = _posterior(periodograms, min(_SHORTEST, full / 2.5))
    doubt = low / (_DOUBT / full)
    refused = doubt > 1
    for ordinates, limit in _GATES:
        if ordinates < full:
            low, rough = _posterior(periodograms[:, :ordinates], limit)
            refused |= low > _REFUSED
            level = rough if ordinates > 6 else level
    # The fit may lie below the lowest ordinates themselves, which would make intervals too narrow.
    level = np.maximum(level, periodograms[:, :4].mean(axis=1))
    factor = _STUDENT[min(max(_STUDENT), 2 * full)] * (1 + _WIDENING * np.cbrt(np.minimum(doubt, 1)))
    half = factor * np.sqrt(level / length)
    half[refused] = np.nan
    return half, level


def _peak(periodograms: FloatArray) -> FloatArray:
    """Return the largest ratio of three ordinates away from frequency zero to the median of lower ones."""
    peak = np.zeros(len(periodograms))
    for j in range(12, periodograms.shape[1]):
        ratio = periodograms[:, j - 1 : j + 2].mean(axis=1) / np.median(periodograms[:, : j - 3], axis=1)
        peak = np.fmax(peak, ratio)
    return peak


def _posterior(periodograms: FloatArray, corner: float) -> tuple[FloatArray, FloatArray]:
    """Return the probability of a corner frequency below a limit, and the upper quartile of S(0)."""
    count = periodograms.shape[1]
    shape = 1 / (1 + (np.arange(1, count + 1) / _CORNERS[:, None]) ** 2)
    level = np.maximum(periodograms @ (1 / shape).T / count, 1e-300)
    likelihood = -count * np.log(level) - np.log(shape).sum(axis=1)
    weight = np.exp(likelihood - likelihood.max(axis=1, keepdims=True))
    weight /= weight.sum(axis=1, keepdims=True)
    low = weight[:, corner > _CORNERS].sum(axis=1)
    # The density falls with the corner frequency: its quantile is that of the corners in reverse order.
    rank = (np.cumsum(weight[:, ::-1], axis=1) < _QUANTILE).sum(axis=1)
    rank = np.minimum(rank, _CORNERS.size - 1)
    return low, np.take_along_axis(level[:, ::-1], rank[:, None], axis=1)[:, 0]
