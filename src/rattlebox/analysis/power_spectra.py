"""Power spectral densities, levels in octave bands, and transfer functions of sampled signals."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .signals import FloatArray, evenly_sampled, labelled, positive, sampled, step_of, units_of

if TYPE_CHECKING:
    import xarray

WINDOW = "hann"
OVERLAP = 0.5
MIN_BINS = 4
"""Fewest frequency bins in a band with a level."""


@dataclass(frozen=True)
class _Segments:
    """Segments of a signal for Welch's average."""

    rate: float  # Sampling rate [Hz]
    length: int
    shift: int
    count: int
    independent: float


def _segments(time: FloatArray, resolution: float | None) -> _Segments:
    step, size = step_of(time), time.size
    if resolution is None:
        # Eight segments of this length with 50 % overlap cover the signal.
        length = max(2 * size // 9, 4)
    else:
        length = round(1 / (positive("resolution", resolution, "Hz") * step))
        if not 4 <= length <= size:
            raise ValueError(
                f"resolution is {resolution:g} Hz, which takes segments of {length} samples; allowed is "
                f"{1 / (size * step):.4g} Hz to {1 / (4 * step):.4g} Hz for this signal of {size} samples"
            )
    shift = max(length - math.floor(OVERLAP * length), 1)
    count = 1 + (size - length) // shift
    return _Segments(1 / step, length, shift, count, _independent(length, shift, count))


def _independent(length: int, shift: int, count: int) -> float:
    """Return the number of independent segments, from the correlation of overlapping windows (Welch 1967)."""
    from scipy.signal import get_window

    window = get_window(WINDOW, length)
    total = 1.0
    for k in range(1, count):
        if k * shift >= length:
            break
        correlation = np.dot(window[: length - k * shift], window[k * shift :]) / np.dot(window, window)
        total += 2 * (1 - k / count) * correlation**2
    return count / total


def power_spectral_density(time: ArrayLike, values: ArrayLike, *, resolution: float | None = None) -> xarray.Dataset:
    r"""Estimate the one-sided power spectral density of a stationary random signal by Welch's average.

    Parameters
    ----------
    time : (N,) array_like
        Evenly spaced times [s]; the last step may be shorter, and its sample is then not used.
    values : (N,) array_like
        Signal; the unit of a DataArray is used. The mean of each segment is removed.
    resolution
        Spacing of the frequencies [Hz]; the finer, the fewer segments are averaged. By default the signal has eight segments
        of equal length with 50 % overlap.

    Returns
    -------
    xarray.Dataset
        `density` and the limits `lower` and `upper` of its 95 % confidence interval [unit^2/Hz], over `frequency` [Hz]. Its
        integral over all frequencies is the variance of the signal. Attributes: `resolution` [Hz], `segments`, and
        `degrees_of_freedom` of the chi-squared distribution of the estimate.

    Raises
    ------
    ValueError
        If times are not evenly spaced, a sample is not finite, or the resolution does not fit the signal.

    Notes
    -----
    With K segments x_k of the length of a Hann window w, which overlap by 50 %, and the sampling rate f_s,

    .. math::

        S(f) = \frac{2}{f_s \sum_n w_n^2} \frac{1}{K} \sum_k \left|\sum_n w_n x_{k,n} e^{-2 \pi i f n / f_s}\right|^2

    The interval is :math:`\nu S / \chi^2_{0.975}(\nu)` to :math:`\nu S / \chi^2_{0.025}(\nu)` with :math:`\nu` degrees of
    freedom: that of a Gaussian signal,
    for each frequency separately. Peaks narrower than two or three times the resolution are broadened: a mode of damping
    ratio z at f needs a resolution below z f / 2.

    References
    ----------
    P. D. Welch (1967), The use of fast Fourier transform for the estimation of power spectra, IEEE Trans. Audio
    Electroacoust. 15, 70-73, doi:10.1109/TAU.1967.1161901.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.arange(100_000) / 1000
    >>> white = np.random.default_rng(1).normal(size=time.size)
    >>> result = power_spectral_density(time, white, resolution=2.0)
    >>> round(float(result.density.sel(frequency=slice(20, 480)).mean()), 4)  # 1 / 500 Hz
    0.002
    """
    import xarray
    from scipy.signal import welch
    from scipy.stats import chi2

    t, x = evenly_sampled(time, 16, values=values)
    cut = _segments(t, resolution)
    frequency, density = welch(x, cut.rate, WINDOW, cut.length, cut.length - cut.shift, detrend="constant")
    freedom = 2 * cut.independent
    upper, lower = (density * freedom / chi2.ppf(p, freedom) for p in (0.025, 0.975))
    unit = _per_hertz(units_of(values))
    axis = ("frequency", frequency, {"units": "Hz", "long_name": "frequency"})
    named = (
        ("density", density, "power spectral density"),
        ("lower", lower, "lower 95 % limit of the power spectral density"),
        ("upper", upper, "upper 95 % limit of the power spectral density"),
    )
    return xarray.Dataset(
        {name: labelled(name, numbers, unit, label, frequency=axis) for name, numbers, label in named},
        attrs={"resolution": cut.rate / cut.length, "segments": cut.count, "degrees_of_freedom": freedom},
    )


def band_levels(density: xarray.DataArray, *, fraction: int = 3) -> xarray.DataArray:
    r"""Compute the RMS value of a signal in each octave or third-octave band.

    Parameters
    ----------
    density : (F,) DataArray
        Power spectral density over `frequency` [Hz], such as `power_spectral_density(...).density`.
    fraction
        Bands in an octave: 1, 3, 6, 12 or 24.

    Returns
    -------
    xarray.DataArray
        RMS values over `band`, the exact mid-band frequency [Hz], with the coordinates `lower` and `upper` (band edges
        [Hz]) and `nominal` (the name of the band, "31.5"). Bands outside the frequencies of the density are omitted, and
        low bands up to the last one with fewer than four frequencies.

    Raises
    ------
    ValueError
        If the fraction is not allowed, or no band has four frequencies.

    Notes
    -----
    Base-ten bands: mid-band frequencies :math:`f = 1000\, G^{k/b}` for odd :math:`b` and
    :math:`1000\, G^{(2k+1)/(2b)}` for even :math:`b`, with :math:`G = 10^{3/10}`, and edges :math:`f\, G^{\pm 1/(2b)}`. The
    density is integrated as straight lines between its samples.

    References
    ----------
    IEC 61260-1:2014, Electroacoustics - Octave-band and fractional-octave-band filters - Part 1: Specifications.

    Examples
    --------
    >>> import numpy as np
    >>> import xarray
    >>> flat = xarray.DataArray(np.full(1001, 4.0), {"frequency": np.arange(1001.0)})
    >>> levels = band_levels(flat, fraction=1)
    >>> round(float(levels.sel(nominal="500") ** 2 / 4.0), 1)  # width of the band in Hz
    353.1
    """
    if fraction not in (1, 3, 6, 12, 24):
        raise ValueError(f"fraction is {fraction!r}, but it must be 1, 3, 6, 12 or 24 bands in an octave")
    f, d = sampled(density["frequency"], 2, density=density)
    octave = 10.0**0.3
    shift = 0.0 if fraction % 2 else 0.5
    # The first frequency may be zero, which has no logarithm and lies in no band.
    lowest = max(f[0], f[1] - f[0])
    numbers = np.arange(
        math.floor(fraction * math.log(lowest / 1000, octave)) - 1,
        math.ceil(fraction * math.log(f[-1] / 1000, octave)) + 2,
    )
    middle = 1000 * octave ** ((numbers + shift) / fraction)
    lower, upper = middle * octave ** (-0.5 / fraction), middle * octave ** (0.5 / fraction)
    # A band of few frequencies would show the resolution of the spectrum, not the level. Once a band is too narrow, all
    # below it are.
    bins = np.searchsorted(f, upper, "right") - np.searchsorted(f, lower, "left")
    inside = (lower >= f[0]) & (upper <= f[-1]) & (bins >= MIN_BINS)
    narrow = np.flatnonzero((bins < MIN_BINS) & (lower < f[-1]))
    inside[: narrow[-1] + 1 if narrow.size else 0] = False
    middle, lower, upper = middle[inside], lower[inside], upper[inside]
    if not middle.size:
        raise ValueError(
            f"density has frequencies from {f[0]:g} Hz to {f[-1]:g} Hz, and no band has {MIN_BINS} of them; "
            "try: a finer resolution or a smaller fraction"
        )
    # Edges lie between frequencies, so that the density is integrated as straight lines; then neighbouring bands add up
    # exactly.
    total = np.concatenate([[0.0], np.cumsum(0.5 * (d[1:] + d[:-1]) * np.diff(f))])

    def integral(edge: FloatArray) -> FloatArray:
        k = np.clip(np.searchsorted(f, edge, "right") - 1, 0, f.size - 2)
        part = edge - f[k]
        return total[k] + part * (d[k] + 0.5 * part * (d[k + 1] - d[k]) / (f[k + 1] - f[k]))

    axis = ("band", middle, {"units": "Hz", "long_name": "mid-band frequency"})
    levels = labelled(
        "level", np.sqrt(integral(upper) - integral(lower)), _root_of(units_of(density)), "RMS in the band", band=axis
    )
    levels = levels.assign_coords(
        lower=("band", lower, {"units": "Hz", "long_name": "lower edge of the band"}),
        upper=("band", upper, {"units": "Hz", "long_name": "upper edge of the band"}),
        nominal=("band", [_nominal(m) for m in middle], {"units": "", "long_name": "nominal mid-band frequency [Hz]"}),
    )
    return levels.set_xindex("nominal").assign_attrs(fraction=fraction)


def transfer_function(
    time: ArrayLike, source: ArrayLike, response: ArrayLike, *, resolution: float | None = None
) -> xarray.Dataset:
    r"""Estimate the frequency response function between two measured or computed signals, with its coherence.

    With a force as the source and a displacement, velocity or acceleration as the response it is a receptance, mobility
    or accelerance; with the same quantity of the base as the source it is a transmissibility.

    Parameters
    ----------
    time : (N,) array_like
        Evenly spaced times [s]; the last step may be shorter, and its sample is then not used.
    source, response : (N,) array_like
        Input and output signals; the units of DataArrays are used.
    resolution
        Spacing of the frequencies [Hz]; default as in `power_spectral_density`.

    Returns
    -------
    xarray.Dataset
        Over `frequency` [Hz]: complex `transfer` [response/source], `coherence` (0 to 1), and `random_error`, the
        normalised standard deviation of the magnitude.

    Raises
    ------
    ValueError
        If times are not evenly spaced, a sample is not finite, the source is zero throughout, the resolution does not fit
        the signal, or there is one segment only, for which the coherence is one for any signals.

    Notes
    -----
    .. math::

        H_1 = \frac{S_{xy}}{S_{xx}}, \qquad \gamma^2 = \frac{|S_{xy}|^2}{S_{xx} S_{yy}}, \qquad
        \varepsilon = \sqrt{\frac{1 - \gamma^2}{2 n \gamma^2}}

    are the transfer function of Welch averages, the coherence and the random error with :math:`n` independent segments:
    noise in the response does not bias :math:`H_1`, noise in the source reduces it. For a damper whose damping depends on
    amplitude the result is the best linear approximation at this level, and the coherence is below one even without noise.

    References
    ----------
    J. S. Bendat and A. G. Piersol (2010), Random Data, 4th ed., Wiley, chapters 6 and 9, doi:10.1002/9781118032428.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.arange(20_000) / 1000
    >>> force = np.random.default_rng(1).normal(size=time.size)
    >>> result = transfer_function(time, force, 3 * force, resolution=1.0)
    >>> complex(result.transfer.sel(frequency=50)).real, float(result.coherence.sel(frequency=50))  # doctest: +NUMBER
    (3.0, 1.0)
    """
    import xarray
    from scipy.signal import csd, welch

    t, x, y = evenly_sampled(time, 16, source=source, response=response)
    cut = _segments(t, resolution)
    # With one segment the coherence is 1 for any two signals.
    if cut.count < 2:
        raise ValueError(
            f"resolution is {cut.rate / cut.length:.4g} Hz, which leaves one segment, but at least 2 are needed; try: a "
            "coarser one or a longer signal"
        )
    if not x.any():
        raise ValueError("source is zero throughout; a source that moves is needed")
    options = (cut.rate, WINDOW, cut.length, cut.length - cut.shift)
    # H1 divides by the power of the source: noise in the response cancels in the mean, noise in the source does not.
    frequency, cross = csd(x, y, *options, detrend="constant")
    source_density, response_density = (welch(z, *options, detrend="constant")[1] for z in (x, y))
    with np.errstate(divide="ignore", invalid="ignore"):
        transfer = cross / source_density
        coherence = np.clip(np.abs(cross) ** 2 / (source_density * response_density), 0.0, 1.0)
        error = np.sqrt((1 - coherence) / (2 * cut.independent * coherence))
    axis = ("frequency", frequency, {"units": "Hz", "long_name": "frequency"})
    unit = _ratio(units_of(response), units_of(source))
    return xarray.Dataset(
        {
            "transfer": labelled("transfer", transfer, unit, "transfer function H1", frequency=axis),
            "coherence": labelled("coherence", coherence, "1", "coherence", frequency=axis),
            "random_error": labelled(
                "random_error", error, "1", "relative random error of the magnitude", frequency=axis
            ),
        },
        attrs={"resolution": cut.rate / cut.length, "segments": cut.count},
    )


def transmissibility(
    time: ArrayLike, base: ArrayLike, response: ArrayLike, *, resolution: float | None = None
) -> xarray.Dataset:
    """Estimate the transmissibility, the motion of a point over the motion of the base, from two signals.

    Parameters
    ----------
    time : (N,) array_like
        Evenly spaced times [s]; the last step may be shorter, and its sample is then not used.
    base, response : (N,) array_like
        The same quantity at the base and at the point, both absolute, such as two accelerations.
    resolution
        Spacing of the frequencies [Hz]; default as in `power_spectral_density`.

    Returns
    -------
    xarray.Dataset
        As `transfer_function` returns it.

    Raises
    ------
    ValueError
        As `transfer_function`, and if the units of the two signals differ.

    Notes
    -----
    H1 = S_xy / S_xx with the base as x; for equation and reference see `transfer_function`.
    """
    if units_of(base) != units_of(response):
        raise ValueError(
            f"base is in {units_of(base) or 'no unit'} and response in {units_of(response) or 'no unit'}, but a "
            "transmissibility compares the same quantity; transfer_function takes any two"
        )
    return transfer_function(time, base, response, resolution=resolution)


def miles_rms(frequency: float, damping_ratio: float, density: float) -> float:
    r"""Compute the RMS absolute acceleration of a linear oscillator on a base with a flat acceleration density.

    Parameters
    ----------
    frequency
        Natural frequency [Hz].
    damping_ratio
        Damping ratio.
    density
        Power spectral density of the base acceleration [unit^2/Hz], flat about the natural frequency.

    Returns
    -------
    float
        RMS of the absolute acceleration [unit].

    Raises
    ------
    ValueError
        If a number is not above zero.

    Notes
    -----
    .. math:: a = \sqrt{\frac{\pi f W (1 + 4 \zeta^2)}{4 \zeta}}

    with the density :math:`W`, exact if it is flat over all frequencies. Miles' equation of 1954 neglects
    :math:`4 \zeta^2`.

    References
    ----------
    J. W. Miles (1954), On structural fatigue under random loading, J. Aeronaut. Sci. 21, 753-762, doi:10.2514/8.3199.

    Examples
    --------
    >>> round(miles_rms(100.0, 0.05, 0.04), 3)  # g, from g^2/Hz
    7.966
    """
    f, z = positive("frequency", frequency, "Hz"), positive("damping_ratio", damping_ratio, "")
    return math.sqrt(math.pi * f * positive("density", density, "") * (1 + 4 * z**2) / (4 * z))


def _per_hertz(unit: str) -> str:
    return f"({unit})^2/Hz" if unit else ""


def _root_of(unit: str) -> str:
    return unit.removesuffix(")^2/Hz").removeprefix("(") if unit.endswith(")^2/Hz") else ""


def _ratio(above: str, below: str) -> str:
    if above == below:
        return "1" if above else ""
    return f"({above or '1'})/({below or '1'})"


def _nominal(frequency: float) -> str:
    """Return a frequency to three digits, as IEC 61260 names bands: 31.6 is "31.5"."""
    preferred = (1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0, 10.0)
    decade = 10.0 ** math.floor(math.log10(frequency))
    nearest = min(preferred, key=lambda p: abs(math.log(p * decade / frequency)))
    close = abs(nearest * decade / frequency - 1) < 0.02
    value = nearest * decade if close else float(f"{frequency:.3g}")
    return f"{value:.0f}" if value >= 1000 else f"{value:.4g}"
