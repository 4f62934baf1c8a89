"""Settling time and reduction of a motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from rattlebox.core import _core

from .signals import FloatArray, finite, positive, sampled


def settling_time(time: ArrayLike, values: ArrayLike, *, band: float = 0.05, reference: float | None = None) -> float:
    """Compute the time after which a signal remains within a band around zero.

    Parameters
    ----------
    time : (N,) array_like
        Increasing times [s], evenly spaced or not.
    values : (N,) array_like
        Signal about its rest position.
    band
        Half width of the band over the reference.
    reference
        Reference in the unit of the values; default their largest magnitude. Use the peak of the bare structure to compare
        dampers.

    Returns
    -------
    float
        Time [s], interpolated linearly between samples; the first time for a signal that never leaves the band. NaN if the
        signal is outside the band at the end, or has been inside for less than its last half cycle across the band.

    Raises
    ------
    ValueError
        If a sample is not finite, times do not increase, or band or reference is not above zero.

    Notes
    -----
    The smallest t_s for which abs(x(t)) <= band reference at all later samples t.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.linspace(0, 10, 1001)
    >>> round(settling_time(time, np.exp(-time)), 2)
    3.0
    """
    t, x = sampled(time, 2, values=values)
    size = np.abs(x)
    peak = float(size.max()) if reference is None else positive("reference", reference, "")
    limit = positive("band", band, "") * peak
    settled: float = _core.settled_after(t, x, limit)
    return settled


def peak_reduction(without: ArrayLike, with_damper: ArrayLike) -> float:
    """Return one minus the ratio of the peaks with and without a damper.

    Parameters
    ----------
    without, with_damper : (N,), (M,) array_like
        The same signal without and with the damper.

    Returns
    -------
    float
        Reduction; negative if the damper increases the peak.

    Raises
    ------
    ValueError
        If a sample is not finite, or the signal without the damper is zero.

    Notes
    -----
    1 - max abs(with_damper) / max abs(without).

    Examples
    --------
    >>> peak_reduction([0.0, 2.0, -1.0], [0.0, 0.5, -0.5])
    0.75
    """
    a, b = finite("without", without), finite("with_damper", with_damper)
    return _reduction(float(np.max(np.abs(a))), float(np.max(np.abs(b))))


def rms_reduction(without: ArrayLike, with_damper: ArrayLike) -> float:
    r"""Return one minus the ratio of the root mean squares with and without a damper.

    Parameters
    ----------
    without, with_damper : (N,) array_like
        The same signal without and with the damper, sampled at the same, evenly spaced times.

    Returns
    -------
    float
        Reduction; negative if the damper increases the RMS value.

    Raises
    ------
    ValueError
        If a sample is not finite, the lengths differ, or the signal without the damper is zero.

    Notes
    -----
    .. math:: 1 - \frac{\text{rms}(x_{with})}{\text{rms}(x_{without})}, \qquad \text{rms}(x)^2 = \frac{1}{n} \sum_k x_k^2

    Examples
    --------
    >>> rms_reduction([3.0, 4.0], [1.5, 2.0])
    0.5
    """
    a, b = finite("without", without), finite("with_damper", with_damper)
    if a.size != b.size:
        raise ValueError(f"with_damper has {b.size} samples, but without has {a.size}; sample both at the same times")
    return _reduction(_rms(a), _rms(b))


def _rms(x: FloatArray) -> float:
    return float(np.sqrt(np.mean(x**2)))


def _reduction(before: float, after: float) -> float:
    if before == 0:
        raise ValueError("without is zero throughout; a signal that moves is needed")
    return 1 - after / before
