"""Envelope and damping ratio of a free decay."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from .signals import FloatArray, evenly_sampled, labelled, step_of, units_of

if TYPE_CHECKING:
    import xarray

_CYCLES = 4
"""Length of the Hilbert transformer in cycles of the signal."""
_KAISER = 10.0
"""Shape of its window: the passband, flat to 1e-5, begins at 0.8 of the signal's frequency."""


def decay_envelope(time: ArrayLike, values: ArrayLike) -> xarray.DataArray:
    r"""Compute the amplitude of a decaying oscillation over time.

    Parameters
    ----------
    time : (N,) array_like
        Evenly spaced times [s], at least 5 per cycle, over more than 6 cycles; the last step may be shorter, and its
        sample is then not used.
    values : (N,) array_like
        Oscillation about zero with one dominant frequency; subtract the rest position first. A DataArray passes its
        unit on.

    Returns
    -------
    xarray.DataArray
        Amplitude over `time` [s], without the first and the last two cycles.

    Raises
    ------
    ValueError
        If times are not evenly spaced, a sample is not finite, or the record is too short or too coarse.

    Notes
    -----
    The amplitude is the magnitude of the analytic signal,

    .. math:: A(t) = |x(t) + i H[x](t)|, \qquad H[x]_k = \sum_{n\ \text{odd}} \frac{2 w_n x_{k-n}}{\pi n}

    with a Hilbert transformer :math:`H` of four cycles and a Kaiser window :math:`w`. It depends only on the neighbourhood
    of each sample. A transform of the whole record would let large amplitudes at the start leak into small ones at the end.

    References
    ----------
    M. Feldman (1994), Non-linear system vibration analysis using Hilbert transform: I. Free vibration analysis method
    'FREEVIB', Mechanical Systems and Signal Processing 8, 119-127, doi:10.1006/mssp.1994.1011.
    A. V. Oppenheim, R. W. Schafer, J. R. Buck (1999), Discrete-Time Signal Processing, 2nd ed., Prentice Hall,
    ISBN 0-13-754920-2, chapter 11.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.arange(2000) / 1000
    >>> envelope = decay_envelope(time, np.exp(-time) * np.cos(2 * np.pi * 10 * time))
    >>> round(float(envelope.sel(time=1.0, method="nearest")), 4)
    0.3679
    """
    t, signal, _ = analytic_signal(time, values)
    return labelled("amplitude", np.abs(signal), units_of(values), "amplitude", time=t)


def damping_ratio(
    time: ArrayLike, values: ArrayLike, *, method: Literal["hilbert", "decrement"] = "hilbert"
) -> xarray.Dataset:
    r"""Compute the damping ratio of a free decay over time and amplitude.

    Parameters
    ----------
    time : (N,) array_like
        Evenly spaced times [s], at least 5 per cycle, over more than 6 cycles; the last step may be shorter, and its
        sample is then not used.
    values : (N,) array_like
        Free decay about zero of one mode. The unit of a DataArray is used.
    method
        "hilbert": slope of the logarithmic envelope over the instantaneous frequency, both from a cubic fit over two cycles
        around each sample; resolves ratios to 1e-6, without the first and last three cycles. "decrement": logarithmic
        decrement between extremes one cycle apart, a value every half cycle, at the time of the extreme between them.

    Returns
    -------
    xarray.Dataset
        `damping_ratio`, that of the linear oscillator with the same local decay, and `amplitude`, over `time` [s].

    Raises
    ------
    ValueError
        If times are not evenly spaced, a sample is not finite, the record is too short or too coarse, or the method
        is unknown.

    Notes
    -----
    "hilbert", with the envelope :math:`A` and the phase :math:`\varphi` of the analytic signal (see `decay_envelope`), and
    "decrement", with the extremes :math:`x_k`:

    .. math::

        \zeta = -\frac{\dot A}{\sqrt{\dot A^2 + (A \dot\varphi)^2}}, \qquad
        \zeta = \frac{\delta}{\sqrt{4 \pi^2 + \delta^2}}, \quad \delta = \ln\frac{x_k}{x_{k+2}}

    Both are exact for a linear decay.

    References
    ----------
    M. Feldman (1994), Non-linear system vibration analysis using Hilbert transform: I. Free vibration analysis method
    'FREEVIB', Mechanical Systems and Signal Processing 8, 119-127, doi:10.1006/mssp.1994.1011.
    A. Savitzky, M. J. E. Golay (1964), Analytical Chemistry 36, 1627-1639, doi:10.1021/ac60214a047 (cubic fit).

    Examples
    --------
    >>> import numpy as np
    >>> time = np.arange(2000) / 1000
    >>> decay = np.exp(-0.02 * 2 * np.pi * 10 * time) * np.cos(2 * np.pi * 10 * time)
    >>> round(float(damping_ratio(time, decay).damping_ratio.mean()), 4)
    0.02
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
    from scipy.signal import oaconvolve, savgol_coeffs

    t, signal, cycle = analytic_signal(time, values)
    zero = np.abs(signal) < 1e-15 * np.max(np.abs(signal))
    if zero.any():
        raise ValueError(f"values are zero from {t[zero][0]:.4g} s on; try: end the record before that time")
    half = round(cycle)
    slope = savgol_coeffs(2 * half + 1, 3, deriv=1, delta=step_of(t))
    decay = -oaconvolve(np.log(np.abs(signal)), slope, mode="valid")
    frequency = oaconvolve(np.unwrap(np.angle(signal)), slope, mode="valid")
    inner = slice(half, t.size - half)
    return t[inner], np.abs(signal[inner]), decay / np.hypot(decay, frequency)


def _by_decrement(time: ArrayLike, values: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    from scipy.signal import find_peaks

    t, x, cycle = oscillation(time, values)
    size = np.abs(x)
    k = find_peaks(size, distance=max(1.0, 0.35 * cycle))[0]
    # Extreme of the sinusoid through three samples.
    sign, turn = np.sign(x[k]), 2 * np.pi / cycle
    rise = sign * (x[k + 1] - x[k - 1]) / (2 * np.sin(turn))
    times, peaks = t[k] + np.arctan2(rise, size[k]) / turn * step_of(t), np.hypot(rise, size[k])
    if k.size < 3:
        raise ValueError(f"values have {k.size} extremes, but the decrement needs at least 3")
    decrement = np.log(peaks[:-2] / peaks[2:])
    ratio = decrement / np.hypot(2 * np.pi, decrement)
    # An extreme of a damped oscillation lies below its envelope.
    return times[1:-1], peaks[1:-1] / np.sqrt(1 - ratio**2), ratio


def analytic_signal(time: ArrayLike, values: ArrayLike) -> tuple[FloatArray, np.ndarray, float]:
    """Return times, analytic signal and samples per cycle.

    Notes
    -----
    The imaginary part is the convolution of the signal with the Hilbert transformer h_n = 2 / (pi n), n odd, times a Kaiser
    window.

    References
    ----------
    A. V. Oppenheim, R. W. Schafer (2010), Discrete-Time Signal Processing, 3rd ed., chapter 12, ISBN 978-0-13-198842-2.
    """
    from scipy.signal import oaconvolve

    t, x, cycle = oscillation(time, values)
    half = round(_CYCLES * cycle / 2)
    n = np.arange(-half, half + 1)
    odd = n % 2 == 1
    transformer = np.zeros(n.size)
    transformer[odd] = 2 / (np.pi * n[odd])
    # Convolution in blocks keeps rounding errors of large amplitudes away from small ones.
    quadrature = oaconvolve(x, transformer * np.kaiser(n.size, _KAISER), mode="valid")
    inner = slice(half, t.size - half)
    return t[inner], x[inner] + 1j * quadrature, cycle


def oscillation(time: ArrayLike, values: ArrayLike) -> tuple[FloatArray, FloatArray, float]:
    """Return times, signal, and samples per cycle of its dominant frequency."""
    from scipy.fft import next_fast_len
    from scipy.signal import periodogram

    t, x = evenly_sampled(time, 16, values=values)
    step = step_of(t)
    # A length with a large prime factor would take ten times as long, and nothing can interrupt a transform.
    length = next_fast_len(4 * t.size, real=True)
    frequency, power = periodogram(x, 1 / step, nfft=length, detrend="constant")
    peak = float(frequency[np.argmax(power)])
    if not peak > 0:
        raise ValueError("values do not oscillate; a record of an oscillation about zero is needed")
    cycle = 1 / (peak * step)
    if cycle < 5:
        raise ValueError(f"values have {cycle:.3g} samples in a cycle of {peak:.4g} Hz, but at least 5 are needed")
    if t.size <= (_CYCLES + 2) * cycle + 2:
        raise ValueError(
            f"values cover {t.size / cycle:.3g} cycles of {peak:.4g} Hz, but more than {_CYCLES + 2} are needed"
        )
    return t, x, cycle
