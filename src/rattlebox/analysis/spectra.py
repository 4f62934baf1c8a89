"""Amplitude spectra of uniformly sampled signals."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .signals import evenly_sampled, labelled, step_of, units_of

if TYPE_CHECKING:
    import xarray


def amplitude_spectrum(
    time: ArrayLike, values: ArrayLike, *, window: str | tuple[str, float] = "hann", padding: int = 1
) -> xarray.DataArray:
    r"""Compute the amplitude spectrum of a signal, in the unit of the signal.

    Parameters
    ----------
    time : (N,) array_like
        Evenly spaced times [s]; the last step may be shorter, and its sample is then not used.
    values : (N,) array_like
        Signal; the unit of a DataArray is used.
    window
        Name of a window of `scipy.signal.get_window`, or a tuple of name and parameter such as ("kaiser", 14.0).
    padding
        Length of the transform over that of the signal: appended zeros interpolate the spectrum. The resolution remains one
        over the duration.

    Returns
    -------
    xarray.DataArray
        Amplitude over `frequency` [Hz], from zero to half the sampling rate.

    Raises
    ------
    ValueError
        If times are not evenly spaced, a sample is not finite, there are fewer than 4, or the window or padding is
        unknown.

    Notes
    -----
    With the window :math:`w` and the sampling rate :math:`f_s`,

    .. math:: a(f) = \frac{2}{\sum_n w_n} \left|\sum_n w_n x_n e^{-2 \pi i f n / f_s}\right|

    without the factor of 2 at zero frequency, where it is the magnitude of the mean, and at half the sampling rate. A sine
    of amplitude a at the frequency of a bin has the amplitude a for any window; between two bins it is reduced by the
    scalloping loss of the window (hann 15 %, boxcar 36 %, flattop 0.1 %; less with padding).

    References
    ----------
    F. J. Harris (1978), On the use of windows for harmonic analysis with the discrete Fourier transform, Proceedings of the
    IEEE 66, 51-83, doi:10.1109/PROC.1978.10837.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.arange(1000) / 1000
    >>> spectrum = amplitude_spectrum(time, 3 * np.sin(2 * np.pi * 50 * time))
    >>> round(float(spectrum.sel(frequency=50)), 6)
    3.0
    """
    from scipy.signal import periodogram

    t, x = evenly_sampled(time, 4, values=values)
    if not (isinstance(padding, (int, float, np.number)) and math.isfinite(padding) and padding == int(padding) >= 1):
        raise ValueError(f"padding is {padding}, but it must be a whole number of at least 1")
    size = int(padding) * t.size
    _check_window(window)
    frequency, power = periodogram(x, 1 / step_of(t), window, size, detrend=False, scaling="spectrum")
    # The power of a sine is half its amplitude squared; the mean and the Nyquist bin have no factor of two.
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
            f"window is {window!r}: {error} Allowed are boxcar, hann, hamming, blackman, blackmanharris, nuttall, flattop, "
            '("kaiser", beta), ("tukey", share) and the others of scipy.signal.get_window'
        ) from None
