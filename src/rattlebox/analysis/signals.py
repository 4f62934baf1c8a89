"""Validation and labelling of sampled signals."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rattlebox._util.narrow import unmasked

if TYPE_CHECKING:
    import xarray

FloatArray = NDArray[np.float64]
_LARGEST_ROUNDING = 0.01
"""Largest rounding error of times with single precision, in sampling intervals."""
TIME = {"units": "s", "long_name": "time"}


def finite(name: str, values: ArrayLike, least: int = 1) -> FloatArray:
    """Return a signal as (N,) floats; raise for NaN, infinity, other shapes and fewer than `least` samples."""
    array = np.asarray(unmasked(values), dtype=np.float64)
    if array.ndim != 1:
        raise ValueError(f"{name} has shape {array.shape}, but one signal (N,) is needed; try: one point or ball")
    if array.size < least:
        raise ValueError(f"{name} has {array.size} samples, but at least {least} are needed")
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        raise ValueError(
            f"{name}[{bad[0]}] is {array[bad[0]]}, but all samples must be finite; try: remove or interpolate such samples"
        )
    return array


def sampled(time: ArrayLike, least: int = 2, **signals: ArrayLike) -> tuple[FloatArray, ...]:
    """Return increasing times and signals of the same length."""
    t = finite("time", time, least)
    if np.any(np.diff(t) <= 0):
        k = int(np.flatnonzero(np.diff(t) <= 0)[0])
        raise ValueError(f"time must increase, but time[{k + 1}] = {t[k + 1]:g} s follows time[{k}] = {t[k]:g} s")
    arrays = [finite(name, values) for name, values in signals.items()]
    for name, array in zip(signals, arrays, strict=True):
        if array.size != t.size:
            raise ValueError(f"{name} has {array.size} samples, but time has {t.size}")
    return t, *arrays


def evenly_sampled(time: ArrayLike, least: int = 2, **signals: ArrayLike) -> tuple[FloatArray, ...]:
    """Return evenly spaced times and signals of the same length; a sample after a shorter last step is omitted.

    A run with a sampling rate always records its end, which is rarely a multiple of the sampling interval.
    """
    t, *arrays = sampled(time, least, **signals)
    single = float(np.spacing(np.float32(np.max(np.abs(t))))) if getattr(time, "dtype", None) == np.float32 else 0.0
    if t.size > 2 and not is_even(t, single) and t[-1] - t[-2] < t[-2] - t[-3] and is_even(t[:-1], single):
        t, *arrays = sampled(t[:-1], least, **{name: array[:-1] for name, array in zip(signals, arrays, strict=True)})
    if not is_even(t, single):
        steps = np.diff(t)
        raise ValueError(
            f"time must be evenly spaced, but its steps range from {steps.min():g} s to {steps.max():g} s; only the last "
            "one may be shorter; try: a run with Output(rate=...), or interpolation"
        )
    return np.linspace(t[0], t[-1], t.size) if single else t, *arrays


def is_even(time: FloatArray, single: float = 0.0) -> bool:
    """Return whether times are evenly spaced; `single` is the spacing of numbers near them in single precision [s]."""
    step = step_of(time)
    # The other terms are for the rounding of times that are large compared with their step.
    rounding = 4 * np.spacing(np.max(np.abs(time))) + min(single, _LARGEST_ROUNDING * step)
    return bool(np.max(np.abs(np.diff(time) - step)) <= 1e-6 * step + rounding)


def step_of(time: FloatArray) -> float:
    """Return the sampling interval of evenly spaced times."""
    return float(time[-1] - time[0]) / (time.size - 1)


def steps_inside(time: FloatArray, start: float) -> FloatArray:
    """Return the length of the part of each sampling interval after `start`, (N - 1,) [s]."""
    return np.clip(time[1:] - start, 0.0, np.diff(time))


def trapezoid_weights(time: FloatArray, start: float) -> FloatArray:
    """Return the weights of samples in the integral from `start` on by the trapezoidal rule, (N,) [s]."""
    inside = steps_inside(time, start)
    of_earlier = 0.5 * inside**2 / np.diff(time)
    weights = np.zeros(time.size)
    weights[:-1] += of_earlier
    weights[1:] += inside - of_earlier
    return weights


def first_harmonic(
    time: FloatArray, values: FloatArray, weights: FloatArray, frequency: float, gain: FloatArray | float = 1.0
) -> Any:
    """Fit a mean and a harmonic to samples.

    `time`: times of the samples [s], (N,). `values`: samples, (N,) or (N, K). `weights`: weights of the samples in an
    integral over whole cycles [s], (N,). `frequency`: frequency of the harmonic [Hz]. `gain`: amplitude in the samples of a
    harmonic of amplitude one: sinc(frequency step) for means over steps, (N,). Returns amplitude A of x(t) = mean + Re(A
    exp(2 pi i frequency t)), () or (K,).

    Notes
    -----
    Weighted least squares of a mean, a cosine and a sine. With equal steps that divide a cycle this is the Fourier
    coefficient over the gain; with other steps it is exact for harmonic samples.
    """
    angle = 2 * np.pi * frequency * time
    basis = np.stack([np.ones(time.size), gain * np.cos(angle), gain * np.sin(angle)])
    weighted = basis * weights
    _, cosine, sine = np.linalg.lstsq(weighted @ basis.T, weighted @ values, rcond=None)[0]
    return cosine - 1j * sine


def positive(name: str, value: Any, unit: str) -> float:
    """Return a number above zero."""
    try:
        number = float("text" if isinstance(value, str) else value)
    except (TypeError, ValueError):
        needed = "a number is needed" + (f", in {unit}" if unit else "")
        raise TypeError(f"{name} is {value!r:.60}, but {needed}") from None
    if not (np.isfinite(number) and number > 0):
        raise ValueError(f"{name} is {number} {unit}".rstrip() + ", but it must be finite and above zero")
    return number


def units_of(values: Any) -> str:
    """Return the unit of labelled values; "" for a plain array."""
    return str(getattr(values, "attrs", {}).get("units", ""))


def labelled(name: str, values: ArrayLike, units: str, long_name: str, **coords: Any) -> xarray.DataArray:
    """Return a labelled array; each coordinate is an array of times or a tuple (dim, values, attrs)."""
    import xarray

    coords = {dim: c if isinstance(c, tuple) else (dim, c, TIME) for dim, c in coords.items()}
    return xarray.DataArray(values, coords, list(coords), name, {"units": units, "long_name": long_name})
