"""Forms of frequency response functions and of damping, and the estimates of modal tests from a resonance."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeVar, cast, get_args

import numpy as np
from numpy.typing import NDArray

from .measured import ratio_of_units
from .signals import FloatArray, units_of

if TYPE_CHECKING:
    import xarray

T = TypeVar("T", float, FloatArray, "xarray.DataArray")
Form = Literal["receptance", "mobility", "accelerance", "dynamic_stiffness", "impedance", "apparent_mass"]
Damping = Literal[
    "damping_ratio", "quality_factor", "loss_factor", "logarithmic_decrement", "specific_damping_capacity"
]

_RESPONSES = {"m": 0, "m/s": 1, "m/s^2": 2}
"""Power of i omega of a response over a displacement."""
_FORMS: dict[str, tuple[int, int, str, str]] = {
    "receptance": (0, 1, "m/N", "displacement over force"),
    "mobility": (1, 1, "m/s/N", "velocity over force"),
    "accelerance": (2, 1, "m/s^2/N", "acceleration over force"),
    "dynamic_stiffness": (0, -1, "N/m", "force over displacement"),
    "impedance": (1, -1, "N s/m", "force over velocity"),
    "apparent_mass": (2, -1, "kg", "force over acceleration"),
}
"""Power of i omega, 1 for response over force and -1 for its inverse, unit and meaning."""
_PER_RATIO = {"damping_ratio": 1.0, "loss_factor": 2.0, "specific_damping_capacity": 4 * math.pi}
"""Measures of damping over the damping ratio, of those that are proportional to it."""
_SHARE = 0.5  # of the largest mobility, from which on samples belong to the circle of a resonance
_FEWEST = 5  # samples of a resonance
_JUMP = 0.3  # share of 1 / |H|^2 by which samples may leave a parabola through three others


class Resonance(NamedTuple):
    """Natural frequency and damping of a resonance, from a frequency response function."""

    frequency: float
    """Natural frequency [Hz]."""
    damping_ratio: float
    """Damping ratio of the linear oscillator with this resonance."""
    misfit: float
    """Largest distance of the samples from those of this oscillator, over its peak; NaN for the half-power method."""


def frequency_response_as(response: xarray.Dataset | xarray.DataArray, form: Form) -> xarray.DataArray:
    r"""Convert a frequency response function to receptance, mobility, accelerance or their inverses.

    Parameters
    ----------
    response
        Result of `transfer_function`, `read_frequency_response` or, for a load in N, of `rb.frequency_response`; or complex
        values over `frequency` [Hz] with a unit such as "m/s^2/N".
    form
        "receptance" (compliance) [m/N], "mobility" [m/s/N], "accelerance" (inertance) [m/s^2/N], "dynamic_stiffness" [N/m],
        "impedance" [N s/m] or "apparent_mass" (dynamic mass) [kg].

    Returns
    -------
    xarray.DataArray
        Complex values with the dimensions of the response; NaN at 0 Hz where the form does not exist.

    Raises
    ------
    ValueError
        If the form is unknown, or the unit is not that of a motion over a force.

    Notes
    -----
    .. math:: Y = i \omega H, \qquad A = (i \omega)^2 H, \qquad Z = 1 / Y

    with the receptance :math:`H`, mobility :math:`Y`, accelerance :math:`A`, and the inverse of each, for the phase
    convention exp(+i omega t). The inverse of one element of a matrix of responses is the force at that point for a motion
    of it alone if all other points are free.

    References
    ----------
    D. J. Ewins (2000), Modal Testing: Theory, Practice and Application, 2nd ed., Research Studies Press, section 2.1.

    Examples
    --------
    >>> import xarray
    >>> stiffness = xarray.DataArray([1e-6 + 0j], {"frequency": [50.0]}, attrs={"units": "m/N"})
    >>> float(frequency_response_as(stiffness, "dynamic_stiffness").real[0])  # doctest: +NUMBER
    1000000.0
    """
    if form not in _FORMS:
        raise ValueError(f"form is {form!r}, but it must be one of {', '.join(_FORMS)}")
    values = _transfer(response)
    power, exponent = _form_of(units_of(values))
    wanted, sign, unit, meaning = _FORMS[form]
    omega = 2 * math.pi * values["frequency"]
    with np.errstate(divide="ignore", invalid="ignore"):
        motion = (values if exponent > 0 else 1 / values) * (1j * omega) ** (wanted - power)
        converted = motion if sign > 0 else 1 / motion
    converted = converted.where(np.isfinite(converted))
    return converted.rename(form).assign_attrs({"units": unit, "long_name": f"{form.replace('_', ' ')}, {meaning}"})


def _transfer(response: Any) -> xarray.DataArray:
    """Return complex values over frequency with their unit."""
    if not hasattr(response, "data_vars"):
        return response  # type: ignore[no-any-return]
    if "transfer" in response:
        return response["transfer"]  # type: ignore[no-any-return]
    if not {"amplitude", "phase"} <= set(response.data_vars) or "level" not in response.coords:
        raise ValueError(
            "response has neither transfer nor amplitude and phase over a level; try: transfer_function(...)"
        )
    values = response["amplitude"] * np.exp(1j * response["phase"]) / response["level"]
    return values.assign_attrs(units=f"m/{units_of(response['level'])}")  # type: ignore[no-any-return]


def _form_of(unit: str) -> tuple[int, int]:
    """Return the power of i omega of a unit, and 1 for a motion over a force, -1 for its inverse."""
    for power, exponent, known, _ in _FORMS.values():
        if unit == known:
            return power, exponent
    above, below = ratio_of_units(unit) or ("", "")
    if below.strip() == "N" and above.strip() in _RESPONSES:
        return _RESPONSES[above.strip()], 1
    raise ValueError(f"response is in {unit or 'no unit'}, but a motion over a force is needed, such as m/s^2/N")


def damping_as(value: T, wanted: Damping, *, given: Damping = "damping_ratio") -> T:
    r"""Convert a measure of damping to another one.

    Parameters
    ----------
    value
        Number, array or DataArray, such as `rb.damping_curve(...).damping_ratio`.
    wanted, given
        Wanted and given measure: "damping_ratio", "quality_factor" (Q, amplification), "loss_factor",
        "logarithmic_decrement" or "specific_damping_capacity".

    Returns
    -------
    float, array or DataArray
        Value of the wanted measure.

    Raises
    ------
    ValueError
        If a measure is unknown, a value is negative, or a motion without oscillation is to have a decrement.

    Notes
    -----
    .. math:: Q = \frac{1}{2 \zeta}, \quad \eta = 2 \zeta, \quad \delta = \frac{2 \pi \zeta}{\sqrt{1 - \zeta^2}}, \quad
        \psi = 2 \pi \eta

    at resonance, with the damping ratio :math:`\zeta`.

    Examples
    --------
    >>> damping_as(0.01, "quality_factor"), damping_as(25.0, "loss_factor", given="quality_factor")
    (50.0, 0.04)
    """
    for name in (wanted, given):
        if name not in get_args(Damping):
            raise ValueError(f"{name!r} is not a measure of damping; there are {', '.join(get_args(Damping))}")
    x = np.asarray(value, dtype=float)
    if np.any(x < 0):
        raise ValueError(f"{given} has negative values; damping is at least 0")
    with np.errstate(divide="ignore"):
        if given == "quality_factor":
            zeta = 0.5 / x
        elif given == "logarithmic_decrement":
            zeta = x / np.sqrt(4 * math.pi**2 + x**2)
        else:
            zeta = x / _PER_RATIO[given]
        if wanted == "quality_factor":
            found = 0.5 / zeta
        elif wanted == "logarithmic_decrement":
            if np.any(zeta >= 1):
                raise ValueError("with a damping ratio of 1 or more a motion does not oscillate and has no decrement")
            found = 2 * math.pi * zeta / np.sqrt(1 - zeta**2)
        else:
            found = _PER_RATIO[wanted] * zeta
    labelled: Any = value
    if hasattr(value, "attrs"):
        labelled = labelled.copy(data=found).rename(wanted)
        return cast("T", labelled.assign_attrs(units="1", long_name=wanted.replace("_", " ")))
    return cast("T", found if found.ndim else float(found))


def half_power(response: xarray.Dataset | xarray.DataArray) -> Resonance:
    r"""Estimate frequency and damping of the largest resonance from its half-power bandwidth.

    Parameters
    ----------
    response : (F,) Dataset or DataArray
        Frequency response function at a point, as for `frequency_response_as`; select the frequencies around one resonance.

    Returns
    -------
    Resonance
        Natural frequency [Hz] and damping ratio.

    Raises
    ------
    ValueError
        If the receptance is not known on both sides of its peak down to 0.71 of it, or jumps there from one motion to
        another, or there are fewer than 5 samples.

    Notes
    -----
    With the frequencies :math:`f_1` and :math:`f_2` at which the receptance is the peak over :math:`\sqrt 2`,

    .. math:: \tan 2 \theta = \frac{f_2^2 - f_1^2}{f_2^2 + f_1^2}, \qquad \zeta = \sin \theta, \qquad
        f_n^2 = \frac{f_1^2 + f_2^2}{2 \cos 2 \theta}

    which is exact for a linear oscillator; :math:`\zeta \approx (f_2 - f_1) / (2 f_n)` if it is small. Between samples,
    :math:`1 / |H|^2` is a parabola in :math:`f^2`. With an impact or particle damper, damping depends on amplitude, which
    falls along the flanks of the resonance: the estimate is then not the damping at the peak.

    Examples
    --------
    >>> import numpy as np
    >>> import xarray
    >>> r = np.linspace(0.9, 1.1, 201)
    >>> values = xarray.DataArray(1 / (1 - r**2 + 0.06j * r), {"frequency": 80 * r}, attrs={"units": "m/N"})
    >>> round(half_power(values).damping_ratio, 9)
    0.03
    """
    frequency, receptance = _samples(response)
    x, y = frequency**2, 1 / np.abs(receptance) ** 2
    k = int(np.argmin(y))
    if not 0 < k < y.size - 1:
        raise ValueError(
            "the largest receptance is at the edge of the frequencies; more frequencies beyond it are needed"
        )
    bend = _parabola(x[k - 1 : k + 2], y[k - 1 : k + 2])
    level = 2 * float(np.polyval(bend, -bend[1] / (2 * bend[0])) if bend[0] > 0 else y[k])
    below, above = np.flatnonzero(y[:k] >= level), np.flatnonzero(y[k:] >= level)
    if not below.size or not above.size:
        raise ValueError("the receptance does not fall to 0.71 of its peak on both sides; a wider range is needed")
    _require_no_jump(x, y, int(below[-1]), k + max(int(above[0]), 1))
    first, second = (_crossing(x, y, side, level) for side in (below[-1], k + above[0] - 1))
    angle = 0.5 * math.atan2(second - first, second + first)
    return Resonance(math.sqrt((first + second) / (2 * math.cos(2 * angle))), math.sin(angle), math.nan)


def circle_fit(response: xarray.Dataset | xarray.DataArray) -> Resonance:
    r"""Estimate frequency and damping of the largest resonance from a circle through the mobility in the complex plane.

    Parameters
    ----------
    response : (F,) Dataset or DataArray
        Frequency response function at a point, as for `frequency_response_as`; select the frequencies around one resonance.

    Returns
    -------
    Resonance
        Natural frequency [Hz], damping ratio, and the misfit of the circle and its angles.

    Raises
    ------
    ValueError
        If fewer than 5 samples have at least half of the largest mobility, or they are of one flank of the resonance
        only, as next to a jump.

    Notes
    -----
    The mobility of an oscillator with viscous damping is a circle, on which the angle from the point of resonance is

    .. math:: \varphi = -2 \arctan \frac{f / f_n - f_n / f}{2 \zeta}

    The circle is a linear least-squares fit, which allows for a constant contribution of other modes; then f_n and zeta are
    fitted to the angles. Used are the samples around the peak with at least half of its mobility. As with `half_power`, an
    amplitude-dependent damping gives an average over these samples, and the misfit shows it.

    References
    ----------
    C. C. Kennedy, C. D. P. Pancu (1947), Use of vectors in vibration measurement and analysis, J. Aeronaut. Sci. 14,
    603-625, doi:10.2514/8.1475.

    Examples
    --------
    >>> import numpy as np
    >>> import xarray
    >>> r = np.linspace(0.9, 1.1, 201)
    >>> values = xarray.DataArray(1 / (1 - r**2 + 0.06j * r), {"frequency": 80 * r}, attrs={"units": "m/N"})
    >>> fit = circle_fit(values)
    >>> round(fit.frequency, 6), round(fit.damping_ratio, 9)
    (80.0, 0.03)
    """
    from scipy.optimize import least_squares

    frequency, receptance = _samples(response)
    mobility = 2j * math.pi * frequency * receptance
    size = np.abs(mobility)
    peak = int(np.argmax(size))
    outside = np.flatnonzero(size < _SHARE * size[peak])
    first = int(outside[outside < peak].max(initial=-1)) + 1
    last = int(outside[outside > peak].min(initial=size.size))
    f, y = frequency[first:last], mobility[first:last]
    if f.size < _FEWEST:
        raise ValueError(f"only {f.size} samples have half of the largest mobility; at least {_FEWEST} are needed")
    # |y - c|^2 = R^2 is linear in c and R^2 - |c|^2.
    scale = size[peak]
    real, imag = y.real / scale, y.imag / scale
    basis = np.stack([2 * real, 2 * imag, np.ones(f.size)], axis=1)
    a, b, c = np.linalg.lstsq(basis, real**2 + imag**2, rcond=None)[0]
    centre, radius = complex(a, b), math.sqrt(max(c + a * a + b * b, 0.0))
    angle = np.unwrap(np.angle(y / scale - centre))

    def angles(parameters: FloatArray) -> FloatArray:
        start, natural, zeta = parameters
        return np.asarray(start - 2 * np.arctan((f / natural - natural / f) / (2 * zeta)))

    near = peak - first
    slope = np.abs(np.gradient(angle, f)).max()
    guess = np.array([angle[near], f[near], min(max(2 / (f[near] * slope), 1e-5), 0.5)])

    def error(parameters: FloatArray) -> FloatArray:
        return np.asarray(angles(parameters) - angle)

    scales, least = [1.0, guess[1], guess[2]], 1e-15
    found = least_squares(error, guess, x_scale=scales, xtol=least, ftol=least, gtol=least).x
    if not f[0] <= found[1] <= f[-1]:
        raise ValueError(
            f"the samples used, from {f[0]:g} to {f[-1]:g} Hz, are of one flank of the resonance, as next to a jump from "
            "one motion to another; try: rb.backbone or rb.damping_curve"
        )
    fitted = centre + radius * np.exp(1j * angles(found))
    misfit = float(np.abs(fitted - y / scale).max())
    return Resonance(float(found[1]), float(abs(found[2])), misfit)


def _samples(response: Any) -> tuple[FloatArray, NDArray[np.complex128]]:
    """Return frequencies and receptance of one function where they are known."""
    receptance = frequency_response_as(response, "receptance").squeeze()
    if receptance.dims != ("frequency",):
        raise ValueError(
            f"response has the dimensions {receptance.dims}, but one function is needed; try: .sel(level=...)"
        )
    known = np.isfinite(receptance.values) & (np.abs(receptance.values) > 0)
    frequency, values = receptance.frequency.values[known], receptance.values[known]
    if frequency.size < _FEWEST:
        raise ValueError(f"response has {frequency.size} known values above 0 Hz; at least {_FEWEST} are needed")
    return np.asarray(frequency, float), np.asarray(values, complex)


def _parabola(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the coefficients of the parabola through three points."""
    return np.asarray(np.polyfit(x, y, 2))


def _require_no_jump(x: FloatArray, y: FloatArray, first: int, last: int) -> None:
    """Raise if 1 / |H|^2 changes from one sample to the next in another way than along a parabola, as of one motion."""
    for i in range(first, last):
        if max(y[i : i + 2]) <= 2 * min(y[i : i + 2]):
            continue
        low = min(max(i - 1, 0), y.size - 4)
        near, values = x[low : low + 4] - x[i], y[low : low + 4]
        expected = np.polyval(_parabola(near[:3], values[:3]), near[3])
        if abs(expected - values[3]) > _JUMP * values.max():
            raise ValueError(
                f"the response jumps from one motion to another between {x[i] ** 0.5:g} and {x[i + 1] ** 0.5:g} Hz, where "
                "it has no half-power bandwidth, or the steps of the frequency are too long; try: rb.backbone or "
                "rb.damping_curve"
            )


def _crossing(x: FloatArray, y: FloatArray, k: int, level: float) -> float:
    """Return where a parabola through three samples about an interval from k to k + 1 crosses a level."""
    low = min(max(k - 1, 0), x.size - 3)
    middle, width = 0.5 * (x[k] + x[k + 1]), x[k + 1] - x[k]
    roots = np.roots(_parabola((x[low : low + 3] - middle) / width, y[low : low + 3] - level))
    real = roots.real[np.abs(roots.imag) < 1e-6]
    nearest = real[np.argmin(np.abs(real))] if real.size else 0.0
    return float(middle + width * min(max(nearest, -0.5), 0.5))
