"""Envelope and damping ratio of a free decay."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from .signals import FloatArray, labelled, sampled, step_of, units_of

if TYPE_CHECKING:
    import xarray

_CYCLES = 4
"""Length of the Hilbert transformer in cycles of the signal."""
_KAISER = 8.7
"""Shape of its window: the passband, flat to 5e-5, begins at 0.7 of the signal's frequency."""


def decay_envelope(time: ArrayLike, values: ArrayLike) -> xarray.DataArray:
    """Amplitude of a decaying oscillation over time.

    The magnitude of the analytic signal, from a Hilbert transformer four cycles long: it sees only the neighbourhood
    of each sample, so that the strong start does not leak into the weak end as it does in a transform of the whole
    record. Two cycles are lost at each end.

    Parameters
    ----------
    time : (N,) array_like
        Evenly spaced times [s], at least 5 a cycle, over more than 6 cycles.
    values : (N,) array_like
        Oscillation about zero with one dominant frequency; subtract the rest position first. A DataArray passes its
        unit on.

    Returns
    -------
    xarray.DataArray
        Amplitude over `time` [s].

    Raises
    ------
    ValueError
        When times are not evenly spaced, a sample is not finite, or the record is too short or too coarse.
    """
    t, signal, _ = _analytic(time, values)
    return labelled("amplitude", np.abs(signal), units_of(values), "amplitude", time=t)


def damping_ratio(
    time: ArrayLike, values: ArrayLike, *, method: Literal["hilbert", "decrement"] = "hilbert"
) -> xarray.Dataset:
    """Damping ratio of a free decay, amplitude by amplitude.

    Parameters
    ----------
    time : (N,) array_like
        Evenly spaced times [s], at least 5 a cycle, over more than 6 cycles.
    values : (N,) array_like
        Free decay about zero of one mode. A DataArray passes its unit on.
    method
        "hilbert": slope of the logarithmic envelope over the instantaneous frequency, both from a straight line through
        two cycles about each sample. "decrement": logarithmic decrement between extremes one cycle apart, a value every
        half cycle, at the time of the extreme between them.

    Returns
    -------
    xarray.Dataset
        `damping_ratio`, that of the linear oscillator with the same local decay, and `amplitude`, over `time` [s].

    Raises
    ------
    ValueError
        When times are not evenly spaced, a sample is not finite, the record is too short or too coarse, or the method
        is unknown.
    """
    import xarray

    if method == "hilbert":
        t, amplitude, ratio = _by_hilbert(time, values)
    elif method == "decrement":
        t, amplitude, ratio = _by_decrement(time, values)
    else:
        raise ValueError(f"method is {method!r}, but it must be 'hilbert' or 'decrement'")
    return xarray.Dataset(
        {
            "damping_ratio": labelled("damping_ratio", ratio, "1", "damping ratio", time=t),
            "amplitude": labelled("amplitude", amplitude, units_of(values), "amplitude", time=t),
        },
        attrs={"method": method},
    )


def _by_hilbert(time: ArrayLike, values: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    from scipy.signal import savgol_filter

    t, signal, cycle = _analytic(time, values)
    length = 2 * round(cycle) + 1
    logs = np.log(signal)
    rates = savgol_filter([logs.real, np.unwrap(logs.imag)], length, 1, deriv=1, delta=step_of(t))
    inner = slice(length // 2, t.size - length // 2)
    decay, frequency = -rates[0, inner], rates[1, inner]
    return t[inner], np.abs(signal[inner]), decay / np.hypot(decay, frequency)


def _by_decrement(time: ArrayLike, values: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    from scipy.signal import find_peaks

    t, x, cycle = _oscillation(time, values)
    size = np.abs(x)
    k = find_peaks(size, distance=max(1.0, 0.35 * cycle))[0]
    # The vertex of the parabola through three samples.
    left, middle, right = size[k - 1], size[k], size[k + 1]
    shift = 0.5 * (left - right) / (left - 2 * middle + right)
    times, peaks = t[k] + shift * step_of(t), middle - 0.25 * (left - right) * shift
    if k.size < 3:
        raise ValueError(f"values have {k.size} extremes, but the decrement needs at least 3")
    decrement = np.log(peaks[:-2] / peaks[2:])
    ratio = decrement / np.hypot(2 * np.pi, decrement)
    # An extreme of a damped oscillation lies below its envelope.
    return times[1:-1], np.sqrt(peaks[:-2] * peaks[2:] / (1 - ratio**2)), ratio


def _analytic(time: ArrayLike, values: ArrayLike) -> tuple[FloatArray, np.ndarray, float]:
    """Return times, analytic signal and samples a cycle."""
    from scipy.signal import convolve

    t, x, cycle = _oscillation(time, values)
    half = round(_CYCLES * cycle / 2)
    n = np.arange(-half, half + 1)
    odd = n % 2 == 1
    transformer = np.zeros(n.size)
    transformer[odd] = 2 / (np.pi * n[odd])
    # The direct sum keeps the digits of a weak end beside a strong start.
    quadrature = convolve(x, transformer * np.kaiser(n.size, _KAISER), mode="valid", method="direct")
    inner = slice(half, t.size - half)
    return t[inner], x[inner] + 1j * quadrature, cycle


def _oscillation(time: ArrayLike, values: ArrayLike) -> tuple[FloatArray, FloatArray, float]:
    """Return a signal and the samples in a cycle of its dominant frequency."""
    from scipy.signal import periodogram

    t, x = sampled(time, 16, values=values)
    step = step_of(t)
    frequency, power = periodogram(x, 1 / step, "hann", 4 * t.size, detrend="constant")
    peak = float(frequency[np.argmax(power)])
    if not peak > 0:
        raise ValueError("values do not oscillate")
    cycle = 1 / (peak * step)
    if cycle < 5:
        raise ValueError(f"values have {cycle:.3g} samples in a cycle of {peak:.4g} Hz, but at least 5 are needed")
    if t.size <= (_CYCLES + 2) * cycle + 2:
        raise ValueError(
            f"values cover {t.size / cycle:.3g} cycles of {peak:.4g} Hz, but more than {_CYCLES + 2} are needed"
        )
    return t, x, cycle
