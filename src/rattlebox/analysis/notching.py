"""Notches of test levels: profiles reduced where the force on the base would exceed a limit."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rattlebox.model.errors import Hint, at
from rattlebox.model.modes import main_axis
from rattlebox.model.signals import Signal
from rattlebox.model.space import unit_vector
from rattlebox.model.stops import refuse_stops
from rattlebox.model.units import parse, parse_density

from .signals import FloatArray, finite, labelled

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case
    from rattlebox.model.harmonics import SineSweep
    from rattlebox.model.recorded import Record

PER_OCTAVE = 96
"""Fewest frequencies in an octave at which a profile is compared with its limit."""
BEND = 1e-4
"""Largest deviation of the logarithm of an apparent mass from a straight line between two frequencies."""
_TRANSIENT = 0.05  # part by which the force in a sweep may exceed its limit without a warning
_AROUND = 1.3  # of the notches, in which the sweep is computed, over their ends
_POINTS = 24  # of a cycle at the highest frequency there
_HALVINGS = 16  # of an interval between frequencies
_ABOVE = 1e-9  # of a limit that is not reached, so that rounding makes no notch
_PASSES = 60  # halvings of an interval of the limit for an RMS force
_UNITS = ("N", "m/s^2")
_PAIRS = '[("5 Hz", "1 g"), ("100 Hz", "1 g")]'


def apparent_mass(case: Case, frequencies: ArrayLike, direction: Any = None) -> xarray.DataArray:
    r"""Compute the force on the base of a linear structure over the acceleration of its base.

    Parameters
    ----------
    case
        Case whose structure and tuned masses are used; it must have no other damper, which is not linear.
    frequencies : (F,) array_like
        Frequencies [Hz].
    direction
        Direction of the base motion, and of the force, if points of the structure move in 3-D.

    Returns
    -------
    xarray.DataArray
        Complex apparent mass over `frequency` [kg]; the total mass at low frequencies.

    Raises
    ------
    CaseError
        If the case has impact or particle dampers, the participation of the modes is unknown, or a direction is missing.

    Notes
    -----
    .. math:: M(\omega) = L^T (K + i \omega D) (K - \omega^2 + i \omega D)^{-1} L + R

    with the participation :math:`L`, stiffness :math:`K` and damping :math:`D` of the modes and the residual mass :math:`R`
    of the truncated ones, which is 0 if the total mass is unknown. With a damper take the transfer function of a run from
    the acceleration of the base to the force on it, at the level of the test: see `transfer_function`.

    Examples
    --------
    >>> import rattlebox as rb
    >>> box = rb.Case(structure=rb.SDOF(mass="2 kg", frequency="100 Hz", damping_ratio=0.05), duration="1 s")
    >>> [round(float(abs(value)), 2) for value in apparent_mass(box, [1, 100])]  # 2 kg, and times about 1 / (2 x 0.05)
    [2.0, 20.1]
    """
    if case.dampers:
        raise Hint(
            "the case has a damper, whose force is not proportional to the motion",
            "case.without_dampers(), or analysis.transfer_function of a run, base_acceleration and interface_force",
            ["dampers"],
        )
    refuse_stops(case.stops, "the force of a stop is not proportional to the motion", "the same case without stops")
    modes = case.modes
    if modes.participation is None or not modes.decay.size:
        raise Hint("the apparent mass needs the participation of the modes", "participation = [...] of the structure")
    along, residual = modes.participation, modes.residual_mass
    if along.ndim == 2:
        if direction is None:
            advice = f'direction = "{main_axis(along)}"'
            raise Hint("the structure moves in 3-D and its base needs a direction", advice, ["direction"])
        axis = unit_vector(direction)
        along, residual = along @ axis, None if residual is None else axis @ residual @ axis
    hertz = finite("frequencies", frequencies)
    omega = 2 * np.pi * hertz
    with np.errstate(divide="ignore", invalid="ignore"):  # checked below
        moved = -modes.harmonic_response(omega, along[:, None])[:, :, 0]  # of a unit acceleration
    if not np.isfinite(moved).all():
        infinite = hertz[~np.isfinite(moved).all(axis=1)][0]
        raise _without_damping(infinite)
    internal = moved * (modes.stiffness + 2j * modes.decay * omega[:, None])
    if modes.coupling is not None:
        internal = internal + 1j * omega[:, None] * (moved @ modes.coupling)
    values = -(internal @ along) + (0.0 if residual is None else float(residual))
    axis_of = ("frequency", hertz, {"units": "Hz", "long_name": "frequency"})
    return labelled("apparent_mass", values, "kg", "force on the base over its acceleration", frequency=axis_of)


def _without_damping(hertz: float) -> Hint:
    """Return the error of a structure that has no damping at a natural frequency [Hz]."""
    return Hint(
        f"the structure has no damping at {hertz:.6g} Hz, where its apparent mass is infinite", "damping_ratio = 0.01"
    )


@dataclass(frozen=True, eq=False)
class Notched:
    """A profile whose force on the base is within its limit."""

    profile: Any
    """The new profile: a `rb.Random`; a `rb.Record` in place of a sweep; pairs of frequency [Hz] and amplitude [m/s^2]."""

    levels: xarray.Dataset
    """Over `frequency` [Hz]: `before` and `after` of the profile, the same of the `force`, and the `notch` [dB]."""

    swept_force: float = math.nan
    """Largest force on the base in the sweep with the notch, with its transients [N]; NaN unless a sweep of a case."""

    @property
    def depth(self) -> float:
        """Depth of the deepest notch [dB]; 0 without one."""
        return float(-self.levels.notch.min())

    @property
    def frequency(self) -> float:
        """Frequency of the deepest notch [Hz]."""
        return float(self.levels.frequency.values[np.argmin(self.levels.notch.values)])

    @property
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency with a notch [Hz]; NaN without one."""
        inside = self.levels.frequency.values[self.levels.notch.values < 0]
        return (float(inside[0]), float(inside[-1])) if inside.size else (math.nan, math.nan)

    def __repr__(self) -> str:
        if not self.depth:
            return "<Notched: no notch, the force stays within its limit>"
        low, high = self.band
        return f"<Notched: {self.depth:.1f} dB at {self.frequency:.4g} Hz, from {low:.4g} to {high:.4g} Hz>"


def notch(
    profile: Signal | Sequence[Any],
    structure: Any,
    *,
    force: float | str | None = None,
    force_density: float | str | None = None,
    force_rms: float | str | None = None,
) -> Notched:
    r"""Reduce a random or sine profile so that the force on the base stays within a limit.

    Parameters
    ----------
    profile
        Base acceleration: a `rb.Random`; a `rb.SineSweep`; or the amplitudes of a sine profile as pairs of frequency and
        amplitude, [("5 Hz", "1 g"), ("100 Hz", "1 g")], linear in log-log scales between them.
    structure
        Case without dampers that are not linear (see `apparent_mass`), or the apparent mass over frequency as a labelled
        array or as the result of `transfer_function` from the acceleration of the base [m/s^2] to the force on it [N].
    force
        Limit of the amplitude of the force under a sine profile [N].
    force_density
        Limit of the power spectral density of the force under random vibration, "200 N^2/Hz".
    force_rms
        Limit of the RMS force under random vibration [N]: the limit of the density is the constant that leads to it.

    Returns
    -------
    Notched
        `profile`, the new one; `levels` over frequency; `depth` and `frequency` of the deepest notch, `band`; of a
        `rb.SineSweep` also `swept_force`.

    Raises
    ------
    CaseError
        If the limit does not fit the profile, the transfer function does not cover it, or a limit is not above zero.

    Notes
    -----
    With the apparent mass M the new level is

    .. math:: A' = \min\left(A, \frac{F}{|M|}\right), \qquad S' = \min\left(S, \frac{S_F}{|M|^2}\right)

    at 96 or more frequencies an octave, more near natural frequencies, and those of a transfer function. In the notch the
    force is at its limit there; between two of them the straight lines of the new profile exceed it by at most 0.05 %. The
    limit is that of the force along the motion, in steady vibration. A fast sweep over a narrow notch is not steady: over a
    mode of 80 Hz and 3 % the force exceeds the limit by less than 2 % at 1 oct/min, over one of 68 Hz and 1.2 % by 15 % at
    4 oct/min. The largest force in the sweep is computed, `swept_force`, and above the limit by 5 % it is a warning.
    A transfer function of a structure with a damper holds for the level at which it was computed: repeat run and notch until
    the level changes no more.

    References
    ----------
    NASA-HDBK-7004C (2012), Force limited vibration testing.

    Examples
    --------
    >>> import rattlebox as rb
    >>> box = rb.Case(structure=rb.SDOF(mass="2 kg", frequency="100 Hz", damping_ratio=0.05), duration="1 s")
    >>> notch([("20 Hz", "1 g"), ("200 Hz", "1 g")], box, force="50 N")
    <Notched: 11.9 dB at 99.74 Hz, from 78.82 to 117.2 Hz>
    """
    import xarray

    test = profile if isinstance(profile, Signal) else SineTable(profile)
    is_random = test.is_density
    limits = {"force": force, "force_density": force_density, "force_rms": force_rms}
    given = [name for name, value in limits.items() if value is not None]
    allowed = ["force_density", "force_rms"] if is_random else ["force"]
    if len(given) != 1 or given[0] not in allowed:
        advice = 'force_density = "200 N^2/Hz" or force_rms = "300 N"' if is_random else 'force = "2 kN"'
        kind = "random vibration" if is_random else "a sine profile"
        raise Hint(f"{kind} needs one limit, {' or '.join(allowed)}, not {' and '.join(given) or 'none'}", advice)
    with at("profile"):
        if test.unit not in ("m/s^2", None):
            raise Hint(f"the profile is in {test.unit}, not an acceleration of the base", 'unit = "g"')
        corners = test.levels
    frequency, mass = _sampled_mass(structure, corners[[0, -1], 0], corners[:, 0], test.direction)
    power = 2 if is_random else 1
    before = _at(corners, frequency)
    gain = np.abs(mass) ** power
    with at(given[0]):
        limit = _limit(given[0], limits[given[0]])
        if given[0] == "force_rms":
            limit = _density_for(limit**2, frequency, before, gain)
    after = np.minimum(before, limit / gain)
    inside = after < before
    # Corners of the profile, and all points of the notches with their edges.
    kept = inside | np.append(inside[1:], False) | np.insert(inside[:-1], 0, False) | np.isin(frequency, corners[:, 0])
    new = test.with_levels(np.stack([frequency[kept], after[kept]], axis=1))
    level, pushed = ("(m/s^2)^2/Hz", "N^2/Hz") if is_random else ("m/s^2", "N")
    axis = {"frequency": ("frequency", frequency, {"units": "Hz", "long_name": "frequency"})}
    decibels = (20 if power == 1 else 10) * np.log10(after / before)
    data = {
        "before": (before, level, "profile"),
        "after": (after, level, "profile with notch"),
        "force_before": (before * gain, pushed, "force on the base"),
        "force_after": (after * gain, pushed, "force on the base with notch"),
        "notch": (decibels, "dB", "level over that of the profile"),
    }
    variables = {name: ("frequency", v, {"units": u, "long_name": text}) for name, (v, u, text) in data.items()}
    swept = math.nan
    if getattr(profile, "is_sweep", False) and hasattr(structure, "modes"):
        sweep, levels = cast("SineSweep", profile), cast("Record", new)
        swept = _swept_force(structure, sweep, levels, frequency[inside]) if inside.any() else limit
        if swept > (1 + _TRANSIENT) * limit:
            warnings.warn(
                f"the sweep passes the notch so fast that the force on the base reaches {swept:.4g} N, "
                f"{swept / limit:.3g} times its limit; try: a lower sweep_rate, or force = {0.97 * limit**2 / swept:.4g}",
                stacklevel=2,
            )
    return Notched(new, xarray.Dataset(variables, axis, {"limit": limit}), swept)


def _swept_force(case: Any, sweep: SineSweep, profile: Record, notched: FloatArray) -> float:
    """Return the largest force on the base while a sweep passes its notches [N]."""
    times, values = profile.polyline()
    hertz = sweep.frequency_at(times)
    near = (hertz > notched[0] / _AROUND) & (hertz < notched[-1] * _AROUND)
    step = 1 / (_POINTS * hertz[near].max())
    start, end = times[near][[0, -1]]
    even = np.arange(start, end, step)
    size = 2 * even.size  # the zeros behind the sweep are its decay
    rates = np.fft.rfftfreq(size, step)
    mass = apparent_mass(case, rates[1:], sweep.direction).values
    pushed = np.fft.rfft(np.interp(even, times, values), size)
    pushed[1:] *= mass
    pushed[0] = 0.0
    return float(np.abs(np.fft.irfft(pushed, size)[: even.size]).max())


class SineTable:
    """A sine profile of pairs of frequency and amplitude, with what a signal says of its levels."""

    is_density = False
    unit = "m/s^2"
    direction = None

    def __init__(self, pairs: Any) -> None:
        with at("profile"):
            if isinstance(pairs, str) or np.ndim(np.asarray(pairs, dtype=object)) != 2 or np.shape(pairs)[1] != 2:
                raise Hint("a sine profile needs pairs of frequency and amplitude", _PAIRS)
            self.levels = np.array([(parse(f, ("Hz",))[0], parse(a, ("m/s^2",))[0]) for f, a in pairs])
            if len(self.levels) < 2 or np.any(self.levels <= 0) or np.any(np.diff(self.levels[:, 0]) <= 0):
                raise Hint("frequencies must rise, and all numbers be above zero", _PAIRS)

    def with_levels(self, levels: FloatArray) -> list[tuple[float, float]]:
        """Return the pairs of other levels."""
        return [(frequency, amplitude) for frequency, amplitude in levels.tolist()]


def _limit(name: str, value: Any) -> float:
    """Return a limit [N] or [N^2/Hz]."""
    number, unit = parse_density(value, _UNITS) if name == "force_density" else (parse(value, ("N",))[0], "N")
    if unit not in (None, "N"):
        raise Hint("the density of a force is needed", '"200 N^2/Hz"')
    if not (math.isfinite(number) and number > 0):
        raise Hint("must be finite and greater than zero", '"200 N" or "200 N^2/Hz"')
    return float(number)


def _at(corners: FloatArray, frequency: FloatArray) -> FloatArray:
    """Return a profile at some frequencies, linear in log-log scales."""
    return np.exp(np.interp(np.log(frequency), *np.log(corners).T))


def _sampled_mass(
    structure: Any, ends: FloatArray, corners: FloatArray, direction: Any
) -> tuple[FloatArray, NDArray[np.complex128]]:
    """Return frequencies that resolve the modes, from the first to the last of the profile, and the apparent mass there."""
    low, high = ends
    count = 1 + math.ceil(PER_OCTAVE * math.log2(high / low))
    even = np.geomspace(low, high, count)
    if hasattr(structure, "modes"):
        natural = np.sqrt(np.maximum(structure.modes.stiffness, 0.0)) / (2 * np.pi)
        inside = (natural > low) & (natural < high)
        if structure.modes.coupling is None and (undamped := inside & (structure.modes.decay <= 0)).any():
            raise _without_damping(natural[undamped][0])
        near = natural[inside]  # a narrow peak must not fall between two frequencies
        frequency = np.unique(np.concatenate([even, corners, near]))
        frequency[[0, -1]] = ends
        mass = apparent_mass(structure, frequency, direction).values
        for _ in range(_HALVINGS):
            # Around an inflection the middle of an interval is on the straight line, and its quarters are not.
            parts = np.array([[0.25], [0.5], [0.75]])
            between = frequency[:-1] ** (1 - parts) * frequency[1:] ** parts
            found = apparent_mass(structure, between.ravel(), direction).values.reshape(between.shape)
            logs = np.log(np.abs(mass))
            bend = np.abs(np.log(np.abs(found)) - (1 - parts) * logs[:-1] - parts * logs[1:])
            bent = np.flatnonzero((bend > BEND).any(axis=0))
            if not bent.size:
                break
            frequency, mass = (
                np.insert(old, bent + 1, new[1, bent]) for old, new in ((frequency, between), (mass, found))
            )
        return frequency, mass
    transfer = structure["transfer"] if "transfer" in getattr(structure, "data_vars", ()) else structure
    if "frequency" not in getattr(transfer, "coords", ()):
        raise Hint(
            f"{structure!r:.60} is neither a case nor a transfer function over frequency",
            "a Case, or analysis.transfer_function(...)",
        )
    own, values = transfer["frequency"].values, np.asarray(transfer.values, dtype=complex)
    if own[0] > low * (1 + 1e-9) or own[-1] < high * (1 - 1e-9):
        raise Hint(
            f"the transfer function is known from {own[0]:.4g} to {own[-1]:.4g} Hz, the profile goes from {low:.4g} to "
            f"{high:.4g} Hz",
            "a profile within, or a higher sampling rate or finer resolution of the transfer function",
        )
    frequency = np.unique(np.concatenate([even, corners, own[(own > low) & (own < high)]]))
    frequency[[0, -1]] = ends
    return frequency, np.interp(frequency, own, values)


def _density_for(square: float, frequency: FloatArray, before: FloatArray, gain: FloatArray) -> float:
    """Return the constant limit of the density of the force that leads to its mean square."""

    def reached(limit: float) -> float:
        return float(np.trapezoid(np.minimum(before * gain, limit), frequency))

    low, high = 0.0, float((before * gain).max())
    if reached(high) <= square:
        return high * (1 + _ABOVE)
    for _ in range(_PASSES):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if reached(middle) <= square else (low, middle)
    return low
