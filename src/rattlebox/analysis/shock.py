"""Shock response spectra."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from rattlebox._util.oscillator import MIN_SAMPLES_PER_PERIOD, peaks

from .signals import evenly_sampled, finite, labelled, positive, step_of, units_of

if TYPE_CHECKING:
    import xarray


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
        and in the free vibration after it; `relative_displacement`, the largest displacement from the base, and
        `pseudo_velocity`, 2 pi f times it, in m and m/s if the record is in m/s^2, else in its unit times s^2 and s.

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

    The pseudo-velocity is close to the largest relative velocity and a measure of stress: the stress of a resonating part
    is about rho c times its modal velocity. In low oscillators it is 2 pi f times the displacement of the base, in high ones
    its peak acceleration over 2 pi f.

    References
    ----------
    D. O. Smallwood (1981), Shock and Vibration Bulletin 51, 279-287. ISO 18431-4:2007.
    H. A. Gaberson, R. H. Chalmers (1969), Modal velocity as a criterion of shock severity, Shock and Vibration Bulletin 40,
    part 2, 31-49.

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
    largest = np.array([peaks(a, step, 2 * math.pi * value, zeta) for value in f])
    unit = units_of(acceleration)
    axis = ("frequency", f, {"units": "Hz", "long_name": "natural frequency"})
    named = (
        ("maximax", largest[:, :2].max(axis=1), unit, "largest absolute acceleration"),
        ("positive", largest[:, 0], unit, "largest positive absolute acceleration"),
        ("negative", largest[:, 1], unit, "largest negative absolute acceleration"),
        ("relative_displacement", largest[:, 2], _integrated(unit, "m", " s^2"), "largest displacement from the base"),
        ("pseudo_velocity", 2 * math.pi * f * largest[:, 2], _integrated(unit, "m/s", " s"), "pseudo-velocity"),
    )
    return xarray.Dataset(
        {name: labelled(name, values, units, label, frequency=axis) for name, values, units, label in named},
        attrs={"damping_ratio": zeta},
    )


def _integrated(unit: str, known: str, times: str) -> str:
    return known if unit == "m/s^2" else f"{unit}{times}" if unit else ""
