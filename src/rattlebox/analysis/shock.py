"""Shock response spectra."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .signals import FloatArray, evenly_sampled, finite, labelled, positive, step_of, units_of

if TYPE_CHECKING:
    import xarray

SAMPLES_PER_PERIOD = 32
MIN_STEPS_PER_SAMPLE = 2
"""Fewest steps of the response in a period of the oscillator and in an interval between samples. The peak is that of a
parabola through the highest values; its error on random records is below 5e-4."""

MIN_SAMPLES_PER_PERIOD = 2.0
"""Fewest samples of the record in a period of the highest oscillator."""


def shock_response_spectrum(
    time: ArrayLike,
    acceleration: ArrayLike,
    frequencies: ArrayLike | None = None,
    *,
    damping_ratio: float = 0.05,
) -> xarray.Dataset:
    r"""Compute the peak response of linear oscillators to a base acceleration, frequency by frequency.

    Parameters
    ----------
    time : (N,) array_like
        Evenly spaced times [s]; the last step may be shorter, and its sample is then not used.
    acceleration : (N,) array_like
        Acceleration of the base, linear between samples and zero before and after; the unit of a DataArray is used.
    frequencies : (F,) array_like
        Natural frequencies of the oscillators [Hz]; default twelve per octave, from one over the duration to a tenth of
        the sampling rate.
    damping_ratio
        Damping ratio of the oscillators, from 0 to below 1; 0.05 is a quality factor of 10.

    Returns
    -------
    xarray.Dataset
        Over `frequency` [Hz]: largest absolute acceleration in the positive (`positive`) and negative (`negative`)
        direction and the larger of the two (`maximax`), all in the unit of the record and at or above zero, during the shock
        and in the free vibration after it; and `relative_displacement`, the largest displacement from the base [m] if the
        record is in m/s^2, else in its unit times s^2.

    Raises
    ------
    ValueError
        If times are not evenly spaced, a sample is not finite, the damping ratio is out of range, or a frequency is above
        half the sampling rate.

    Notes
    -----
    .. math:: \ddot z + 2 \zeta \omega \dot z + \omega^2 z = -a

    with the absolute acceleration :math:`a + \ddot z = -(2 \zeta \omega \dot z + \omega^2 z)`. The recursion is exact for
    straight lines between samples (ramp invariant, ISO 18431-4), with at least 32 steps per period. Straight lines
    reduce the amplitude of a band-limited record by more than 3 % above a tenth of the sampling rate.

    References
    ----------
    D. O. Smallwood (1981), Shock and Vibration Bulletin 51, 279-287. ISO 18431-4:2007.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.linspace(0, 0.5, 50_001)
    >>> pulse = np.where(time < 0.011, 20 * np.sin(np.pi * time / 0.011), 0)
    >>> spectrum = shock_response_spectrum(time, pulse, [75.0], damping_ratio=0.0)
    >>> round(float(spectrum.maximax[0]) / 20, 2)  # largest for f T = 0.8
    1.77
    """
    import xarray

    t, a = evenly_sampled(time, 4, acceleration=acceleration)
    step = step_of(t)
    zeta = float(damping_ratio)
    if not 0 <= zeta < 1:
        raise ValueError(f"damping_ratio is {damping_ratio}, but it must be at least 0 and below 1")
    if frequencies is None:
        lowest, highest = 1 / (t[-1] - t[0]), 0.1 / step
        f = lowest * 2 ** (np.arange(max(math.floor(12 * math.log2(highest / lowest)), 0) + 1) / 12)
    else:
        f = finite("frequencies", frequencies)
        for value in f:
            positive("frequencies", value, "Hz")
    # A high oscillator sees the straight lines between samples, not the shock.
    if f.max() > 1 / (MIN_SAMPLES_PER_PERIOD * step):
        raise ValueError(
            f"frequencies go up to {f.max():g} Hz, but a record sampled at {1 / step:g} Hz has no information above "
            f"{1 / (MIN_SAMPLES_PER_PERIOD * step):g} Hz; try: lower frequencies, or a higher sampling rate"
        )
    # Each oscillator alone: their time steps differ by orders of magnitude.
    peaks = np.array([_peaks(a, step, 2 * math.pi * value, zeta) for value in f])
    unit = units_of(acceleration)
    axis = ("frequency", f, {"units": "Hz", "long_name": "natural frequency"})
    named = (
        ("maximax", peaks[:, :2].max(axis=1), unit, "largest absolute acceleration"),
        ("positive", peaks[:, 0], unit, "largest positive absolute acceleration"),
        ("negative", peaks[:, 1], unit, "largest negative absolute acceleration"),
        ("relative_displacement", peaks[:, 2], _displacement(unit), "largest displacement from the base"),
    )
    return xarray.Dataset(
        {name: labelled(name, values, units, label, frequency=axis) for name, values, units, label in named},
        attrs={"damping_ratio": zeta},
    )


def _peaks(acceleration: FloatArray, step: float, w: float, zeta: float) -> tuple[float, float, float]:
    """Return the largest positive and negative absolute acceleration and relative displacement of one oscillator."""
    from scipy.signal import lfilter

    # The recursion is exact at any step; samples are added only so that peaks are not missed between them.
    split = max(math.ceil(SAMPLES_PER_PERIOD * step * w / (2 * math.pi)), MIN_STEPS_PER_SAMPLE)
    h = step / split
    size = acceleration.size
    fine = np.interp(np.arange((size - 1) * split + 1) / split, np.arange(size), acceleration)

    # r(t) = integral of exp(p (t - s)) a(s) ds with the pole p; z = -Im(r) / wd.
    wd = w * math.sqrt(1 - zeta**2)
    pole = complex(-zeta * w, wd)
    first, second = _phi(pole * h)
    decay = np.exp(pole * h)
    now, before = h * second, h * (first - second)
    r, _ = lfilter([now, before], [1.0, -decay], fine, zi=[-now * fine[0]])
    # The largest response may come after the record: one period of free motion contains it.
    free = r[-1] * np.exp(pole * h * np.arange(1, math.ceil(2 * math.pi / (wd * h)) + 3))
    r = np.concatenate([r, free])
    relative, rate = -r.imag / wd, -(pole * r).imag / wd
    absolute = -(2 * zeta * w * rate + w * w * relative)
    return _highest(absolute), _highest(-absolute), max(_highest(relative), _highest(-relative))


def _phi(x: complex) -> tuple[complex, complex]:
    """Return (exp(x) - 1) / x and (exp(x) - 1 - x) / x^2."""
    if abs(x) > 0.5:
        return (np.exp(x) - 1) / x, (np.exp(x) - 1 - x) / x**2
    first, second = ([x**k / math.factorial(k + n) for k in range(16)] for n in (1, 2))
    return sum(first), sum(second)


def _highest(x: FloatArray) -> float:
    """Return the largest value of a smooth signal, at least 0, from a parabola through its highest samples."""
    k = int(np.argmax(x))
    if k in (0, x.size - 1):
        return max(float(x[k]), 0.0)
    left, middle, right = (float(v) for v in x[k - 1 : k + 2])
    bend = left - 2 * middle + right
    return max(middle - (left - right) ** 2 / (8 * bend) if bend else middle, 0.0)


def _displacement(unit: str) -> str:
    return "m" if unit == "m/s^2" else f"{unit} s^2" if unit else ""
