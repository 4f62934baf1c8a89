"""Amplitude spectra of uniformly sampled signals."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .signals import labelled, sampled, step_of, units_of

if TYPE_CHECKING:
    import xarray


def amplitude_spectrum(
    time: ArrayLike, values: ArrayLike, *, window: str | tuple[str, float] = "hann", padding: int = 1
) -> xarray.DataArray:
    """Amplitude of each frequency in a signal, in the signal's own unit.

    A sine of amplitude a whose frequency lies on a bin reads a, whatever the window; between two bins it reads less, by
    the scalloping loss of the window (hann 15 %, boxcar 36 %, flattop 0.1 %; less with padding). The mean is kept: it
    is the absolute value at zero frequency.

    Parameters
    ----------
    time : (N,) array_like
        Evenly spaced times [s].
    values : (N,) array_like
        Signal; a DataArray passes its unit on.
    window
        Name of a window of `scipy.signal.get_window`, or a tuple of name and parameter such as ("kaiser", 14.0).
    padding
        Length of the transform in lengths of the signal: zeros appended to draw the spectrum finer. The resolution
        remains one over the duration.

    Returns
    -------
    xarray.DataArray
        Over `frequency` [Hz], from zero to half the sampling rate.

    Raises
    ------
    ValueError
        When times are not evenly spaced, a sample is not finite, there are fewer than 4, or the window or padding is
        unknown.
    """
    from scipy.signal import periodogram

    t, x = sampled(time, 4, values=values)
    if not (isinstance(padding, (int, float, np.number)) and math.isfinite(padding) and padding == int(padding) >= 1):
        raise ValueError(f"padding is {padding}, but it must be a whole number of at least 1")
    size = int(padding) * t.size
    _check_window(window)
    frequency, power = periodogram(x, 1 / step_of(t), window, size, detrend=False, scaling="spectrum")
    # The power of a sine is half its amplitude squared, but neither the mean nor the last even bin is a pair of bins.
    power[1 : None if size % 2 else -1] *= 2
    spectrum = labelled(
        "amplitude",
        np.sqrt(power),
        units_of(values),
        "amplitude",
        frequency=("frequency", frequency, {"units": "Hz", "long_name": "frequency"}),
    )
    return spectrum.assign_attrs(window=str(window))


def _check_window(window: str | tuple[str, float]) -> None:
    from scipy.signal import get_window

    try:
        get_window(window, 4)
    except (ValueError, TypeError) as error:
        raise ValueError(
            f"window is {window!r}: {error} Known are boxcar, hann, hamming, blackman, blackmanharris, nuttall, flattop, "
            '("kaiser", beta), ("tukey", share) and the others of scipy.signal.get_window'
        ) from None
