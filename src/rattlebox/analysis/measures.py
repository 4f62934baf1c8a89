"""How soon and how far a motion is reduced."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .signals import FloatArray, finite, positive, sampled


def settling_time(time: ArrayLike, values: ArrayLike, *, band: float = 0.05, reference: float | None = None) -> float:
    """Time after which a signal stays within a band about zero.

    Parameters
    ----------
    time : (N,) array_like
        Increasing times [s], evenly spaced or not.
    values : (N,) array_like
        Signal about its rest position.
    band
        Half width of the band, as a share of the reference.
    reference
        In the unit of the values; their largest magnitude when left out. Give the peak of the bare structure to compare
        dampers by one measure.

    Returns
    -------
    float
        On the axis of `time` [s], linear between samples; the first time for a signal that never leaves the band, NaN
        for one that is outside it at the end, or within it for less time than it took from side to side before: it may just
        pass through.

    Raises
    ------
    ValueError
        When a sample is not finite, times do not increase, or band or reference is not above zero.
    """
    t, x = sampled(time, 2, values=values)
    size = np.abs(x)
    peak = float(size.max()) if reference is None else positive("reference", reference, "")
    limit = positive("band", band, "") * peak
    side = np.where(size > limit, np.sign(x), 0.0)
    begins = np.flatnonzero(np.diff(side, prepend=np.nan))  # of samples on one side, or within the band
    if side[-1]:
        return float("nan")
    if begins.size == 1:
        return float(t[0])
    k = int(begins[-1]) - 1
    # A fast oscillation may cross zero between two samples; signed values tell where it passed the band.
    out = np.copysign(limit, x[k])
    passed = float(t[k] + (t[k + 1] - t[k]) * (out - x[k]) / (x[k + 1] - x[k]))
    swings = [begin for begin in begins[:-1] if side[begin]][-2:]
    if len(swings) < 2 or side[swings[0]] == side[swings[1]]:
        return passed
    return float("nan") if t[-1] - passed < t[swings[1]] - t[swings[0]] else passed


def peak_reduction(without: ArrayLike, with_damper: ArrayLike) -> float:
    """One minus the ratio of the largest magnitudes; negative when the damper makes it worse.

    Parameters
    ----------
    without, with_damper : (N,), (M,) array_like
        The same signal without and with the damper.

    Raises
    ------
    ValueError
        When a sample is not finite, or nothing moves without the damper.
    """
    a, b = finite("without", without), finite("with_damper", with_damper)
    return _reduction(float(np.max(np.abs(a))), float(np.max(np.abs(b))))


def rms_reduction(without: ArrayLike, with_damper: ArrayLike) -> float:
    """One minus the ratio of the root mean squares; negative when the damper makes it worse.

    Parameters
    ----------
    without, with_damper : (N,) array_like
        The same signal without and with the damper, sampled at the same, evenly spaced times.

    Raises
    ------
    ValueError
        When a sample is not finite, the lengths differ, or nothing moves without the damper.
    """
    a, b = finite("without", without), finite("with_damper", with_damper)
    if a.size != b.size:
        raise ValueError(f"with_damper has {b.size} samples, but without has {a.size}; sample both at the same times")
    return _reduction(_rms(a), _rms(b))


def _rms(x: FloatArray) -> float:
    return float(np.sqrt(np.mean(x**2)))


def _reduction(before: float, after: float) -> float:
    if before == 0:
        raise ValueError("without is zero throughout, so that there is nothing to reduce")
    return 1 - after / before
