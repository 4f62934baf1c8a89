"""Measurements from which contact parameters are calibrated: drops, bounces, decays, losses on a shaker."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rattlebox._util.frozen import complete
from rattlebox._util.narrow import unmasked
from rattlebox._util.quantities import amount
from rattlebox.analysis.damping_curve import damping_over_amplitude
from rattlebox.model.dampers import Sphere
from rattlebox.model.errors import Hint, at, nearest, one_of, several
from rattlebox.model.units import parse, plain, whole_number
from rattlebox.studies.run.study import whole_cycles

FloatArray = NDArray[np.float64]
MeasuredTo = Literal["bottom", "centre", "top"]

_RADII: dict[str, int] = {"bottom": 0, "centre": 1, "top": 2}
"""Distance of the point to which heights are measured from the lowest point of the ball, in radii."""
_LARGEST_RATIO = 0.5
"""Largest damping ratio that a free decay can show."""
_LOSSES = {"loss_factor": "1", "reduced_loss": "1", "loss_per_cycle": "J"}
"""Measures of the loss on a shaker, with their units."""


class Column(NamedTuple):
    """Measured values in SI units, with their unit, or None for bare numbers."""

    values: FloatArray
    unit: str | None


def read_column(place: str | tuple[str | int, ...], values: Any, units: tuple[str, ...], least: float = 0.0) -> Column:
    """Return measured values in SI units.

    `values`: a list of numbers in SI units, texts with units, or quantities; a pair (numbers, unit); or a single value.
    """
    place = (place,) if isinstance(place, str) else place
    shared = None
    if _has_shared_unit(values):
        values, shared = values
    if hasattr(values, "tolist") and not hasattr(values, "magnitude"):  # arrays of NumPy and xarray
        values = np.asarray(unmasked(values)).tolist()
    single = not _is_list(values)
    items = [values] if single else list(values)
    if not items:
        raise Hint("there is no value", "a list of measured values", place)
    numbers, found = [], []
    for index, item in enumerate(items):
        with at(*place, *([] if single else [index])):
            number, unit = parse(item if shared is None else (item, shared), units) if units else (_pure(item), None)
            if not number > least:
                raise Hint(
                    f"{number:g} is not greater than {'zero' if least == 0 else f'{least:g}'}", "omit this measurement"
                )
            numbers.append(number)
            found.append(unit)
    if len(set(found)) > 1:
        raise Hint("some values have a unit, others have another one or none", "one unit for all", place)
    return Column(np.array(numbers), found[0])


def _has_shared_unit(values: object) -> bool:
    """Return whether values are a pair of numbers and their unit."""
    return isinstance(values, tuple) and len(values) == 2 and isinstance(values[1], str) and _is_list(values[0])


def _is_list(values: object) -> bool:
    """Return whether values are several; quantities and arrays without dimensions are single."""
    return not isinstance(values, str) and hasattr(values, "__iter__") and getattr(values, "ndim", 1) > 0


def _pure(value: object) -> float:
    """Return a number without unit; percentages become fractions."""
    try:
        number = float(plain(value))
    except (TypeError, ValueError) as error:
        raise error if isinstance(error, Hint) else Hint("a number is needed", '0.02 or "2 %"') from None
    if not np.isfinite(number):
        raise Hint("a finite number is needed", "omit this measurement")
    return number


def read_error(value: object, measured: FloatArray, units: tuple[str, ...]) -> FloatArray:
    """Return the standard uncertainty of measured values.

    `measured`: the values, (M,).
    """
    items = [value] if isinstance(value, str) else value
    if isinstance(items, (list, tuple)) and all(isinstance(each, str) and "%" in each for each in items):
        found = _one_or_all("error", read_column("error", items, ()).values, measured.size)
        if (found >= 1).any():
            with at("error"):
                raise Hint(f"{100 * found.max():g} % is not smaller than the value itself", 'error = "5 %"')
        return found * measured
    found = _one_or_all("error", read_column("error", value, units).values, measured.size)
    large = np.flatnonzero(found >= measured)
    if large.size:
        k = int(large[0])
        with at("error"):
            raise Hint(f"{found[k]:g} is not smaller than value {k + 1}, {measured[k]:g}", 'error = "5 %"')
    return found


def _one_or_all(name: str, values: FloatArray, count: int) -> FloatArray:
    """Return an array of `count` values from one or from all."""
    if values.size not in (1, count):
        with at(name):
            raise Hint(f"{values.size} values, but {count} are needed", "as many as measured values, or one")
    return np.broadcast_to(values, (count,)).astype(float)


@dataclass(frozen=True, eq=False)
class Drops:
    """Drop tests: a ball falls from rest onto a plate, and the height of its first rebound is measured.

    The restitution is the ratio of the speeds after and before the impact, sqrt(h_1 / h_0) without air.

    Parameters
    ----------
    height : (N,)
        Heights from which the ball is released, as ["300 mm", ...] or ([300, ...], "mm"); a single one for all rebounds.
    rebound : (N,)
        Heights of the rebounds.
    measured_to
        Point of the ball to which both heights are measured from the plate: "bottom" (the lowest point, the free fall),
        "centre" or "top"; the latter two need `ball`.
    ball
        The ball. The drag of air at 20 °C is corrected if it is given, and neglected otherwise.
    error
        Standard uncertainty of a height, which the interval contains if the scatter of the drops is smaller.

    Raises
    ------
    CaseError
        If a value is not valid, the numbers of heights and rebounds differ, or a rebound is above its drop.
    """

    height: Any
    rebound: Any
    measured_to: MeasuredTo = "bottom"
    ball: Sphere | None = None
    error: Any = None
    unit: Any = field(init=False, default=None, repr=False)

    def __post_init__(self) -> None:
        if self.measured_to not in _RADII:
            with at("measured_to"):
                raise Hint(f"{self.measured_to!r} is not a point of the ball", nearest(str(self.measured_to), _RADII))
        if self.ball is not None and not isinstance(self.ball, Sphere):
            with at("ball"):
                raise Hint(f"{self.ball!r:.60} is not a ball", 'rb.Sphere(diameter="10 mm", material="steel")')
        if self.ball is None and self.measured_to != "bottom":
            raise Hint(
                f"heights to the {self.measured_to} of the ball need its radius",
                'ball = rb.Sphere(diameter="10 mm", material="steel")',
            )
        columns = [read_column(name, getattr(self, name), ("m",)) for name in ("height", "rebound")]
        below = 0.0 if self.ball is None else _RADII[self.measured_to] * self.ball.half
        heights, rebounds = (column.values - below for column in columns)
        if heights.size == 1:
            heights = np.broadcast_to(heights, rebounds.shape).copy()
        if heights.size != rebounds.size:
            raise Hint(f"{heights.size} heights, but {rebounds.size} rebounds", "one height for each rebound, or one")
        for name, falls in (("height", heights), ("rebound", rebounds)):
            if (falls <= 0).any():
                k = int(np.argmin(falls))
                with at(name, k):
                    raise Hint(
                        f"the {self.measured_to} of the ball would be below that of a ball on the plate",
                        "measured_to, the part of the ball to which heights were measured",
                    )
        high = np.flatnonzero(rebounds > heights)
        if high.size:
            k = int(high[0])
            with at("rebound", k):
                raise Hint(
                    f"{amount(rebounds[k] + below, 'm')} is above the height of the drop, "
                    f"{amount(heights[k] + below, 'm')}, which needs a restitution above 1",
                    "height first, rebound second",
                )
        error = None if self.error is None else _uncertainty(self.error, "m")
        complete(self, height=heights, rebound=rebounds, error=error, unit=columns[0].unit and columns[1].unit)

    def arguments(self) -> dict[str, Any]:
        """Return the arguments of the class, in SI units."""
        return {"height": (self.height, "m"), "rebound": (self.rebound, "m"), "ball": self.ball, "error": self.error}


@dataclass(frozen=True, eq=False)
class BounceTimes:
    """Times at which a ball that bounces on a plate hits it, as from a recorded sound.

    The flight between two contacts takes T = 2 v / g, and the restitution is the ratio of consecutive flights, T_2 / T_1.

    Parameters
    ----------
    times : (N,), or a list of these
        Times of consecutive contacts, none omitted, of one or several drops: at least four, or three with `error`.
    error
        Standard uncertainty of a time, which the interval contains if the scatter is smaller.

    Raises
    ------
    CaseError
        If a value is not valid, there are too few contacts, times do not rise, or a flight is longer than the one before.
    """

    times: Any
    error: Any = None
    unit: Any = field(init=False, default=None, repr=False)

    def __post_init__(self) -> None:
        given = self.times
        is_nested = isinstance(given, (list, tuple)) and not _has_shared_unit(given) and all(map(_is_list, given))
        rows = list(given) if is_nested and given else [given]
        columns = []
        for number, row in enumerate(rows):
            place = ("times", number) if is_nested else ("times",)
            columns.append(read_column(place, row, ("s",), -np.inf))
            with at(*place):
                _check_contacts(columns[-1].values)
        error = None if self.error is None else _uncertainty(self.error, "s")
        unit = None if any(column.unit is None for column in columns) else "s"
        complete(self, times=tuple(column.values for column in columns), error=error, unit=unit)

    def arguments(self) -> dict[str, Any]:
        """Return the arguments of the class, in SI units."""
        return {"times": [(times.tolist(), "s") for times in self.times], "error": self.error}


def _check_contacts(times: FloatArray) -> None:
    """Raise if contacts of one drop are too few or not those of one ball."""
    if times.size < 3:
        raise Hint(
            f"{several(times.size, 'contact')} cannot give a restitution, the ratio of two flights",
            "three contacts or more, none omitted",
        )
    flights = np.diff(times)
    if (flights <= 0).any():
        k = int(np.argmin(flights > 0))
        raise Hint(f"time {k + 2}, {times[k + 1]:g} s, is not after time {k + 1}, {times[k]:g} s", "rising times")
    longer = np.flatnonzero(flights[1:] > flights[:-1])
    if longer.size:
        k = int(longer[0])
        raise Hint(
            f"flight {k + 2}, {amount(flights[k + 1], 's')}, is longer than the one before, {amount(flights[k], 's')}, "
            "which needs a restitution above 1",
            "all contacts, none omitted; and only flights that are long compared with the uncertainty of the times",
        )


def _uncertainty(value: object, unit: str) -> float:
    """Return a standard uncertainty in SI units."""
    with at("error"):
        number, _ = parse(value, (unit,))
        if not number > 0:
            raise Hint(f"{number:g} is not greater than zero", "a positive uncertainty, or none")
    return number


@dataclass(frozen=True, eq=False)
class RingDown:
    """Damping ratios over the amplitude in a measured free decay of a structure with its filled damper.

    Parameters
    ----------
    amplitude : (M,)
        Amplitudes of the point: displacements, or accelerations at the frequency of the mode. Two or more.
    damping_ratio : (M,)
        Damping ratio at each of them, of structure and damper together.
    error
        Standard uncertainty of a damping ratio: "5 %" of each value, or numbers.
    mode, point
        See `rb.damping_curve`.

    Raises
    ------
    CaseError
        If a value is not valid, or the numbers of amplitudes and damping ratios differ.

    See Also
    --------
    from_signal : Damping ratios of a measured decay.
    """

    amplitude: Any
    damping_ratio: Any
    error: Any
    mode: int = 1
    point: str | None = None
    unit: Any = field(init=False, default=None, repr=False)

    def __post_init__(self) -> None:
        amplitude, unit = read_column("amplitude", self.amplitude, ("m", "m/s^2"))
        ratio = read_column("damping_ratio", self.damping_ratio, ()).values
        if amplitude.size != ratio.size:
            raise Hint(f"{amplitude.size} amplitudes, but {ratio.size} damping ratios", "one for each amplitude")
        if amplitude.size < 2:
            raise Hint("a ring-down with one amplitude cannot be compared", "two amplitudes or more")
        if (ratio >= _LARGEST_RATIO).any():
            k = int(np.argmax(ratio))
            with at("damping_ratio", k):
                raise Hint(f"{ratio[k]:g} is more than a decay can show, {_LARGEST_RATIO:g}", f'"{ratio[k]:g} %"')
        order = np.argsort(amplitude)
        if (np.diff(amplitude[order]) <= 0).any():
            with at("amplitude"):
                raise Hint("an amplitude is given twice", "the mean of its damping ratios")
        error = read_error(self.error, ratio, ())
        mode = whole_number(self.mode, "mode", 1)
        complete(self, amplitude=amplitude[order], damping_ratio=ratio[order], error=error[order], mode=mode, unit=unit)

    def arguments(self) -> dict[str, Any]:
        """Return the arguments of the class, in SI units."""
        names = ("damping_ratio", "error", "mode", "point")
        return {"amplitude": (self.amplitude, self.unit or "m"), **{name: getattr(self, name) for name in names}}

    @classmethod
    def from_signal(
        cls,
        time: ArrayLike,
        displacement: ArrayLike,
        amplitudes: object,
        *,
        error: object,
        mode: int = 1,
        point: str | None = None,
    ) -> RingDown:
        """Return the damping ratios of a measured decay at given amplitudes.

        Parameters
        ----------
        time : (N,) array_like
            Evenly spaced times [s].
        displacement : (N,) array_like
            Displacement [m]; an acceleration over (2 pi f)^2.
        amplitudes : (M,)
            Rising amplitudes: numbers [m], or texts with units.
        error, mode, point
            See `RingDown`.

        Raises
        ------
        CaseError
            If the decay does not pass an amplitude; see `rattlebox.analysis.damping_over_amplitude`.
        ValueError
            If times are not evenly spaced, or the record is too short or too coarse.
        """
        levels, unit = read_column("amplitudes", amplitudes, ("m",))
        found = damping_over_amplitude(time, np.asarray(unmasked(displacement), float), levels).damping_ratio.values
        missing = np.flatnonzero(~np.isfinite(found))
        if missing.size:
            with at("amplitudes", int(missing[0])):
                raise Hint(
                    f"the decay does not pass the band about {amount(levels[missing[0]], 'm')} outside of its first and "
                    "last three cycles",
                    "other amplitudes; rattlebox.analysis.decay_envelope shows those of the record",
                )
        return cls(levels if unit is None else (levels, unit), found, error, mode, point)


@dataclass(frozen=True, eq=False)
class ShakerLoss:
    """Loss of a damper on a shaker, over amplitude and frequency of its harmonic motion.

    Parameters
    ----------
    amplitude : (M,)
        Amplitudes of the shaker: displacements or accelerations, with units; a single one for all points.
    frequency : (M,)
        Frequency of each point, or a single one.
    loss_factor, reduced_loss, loss_per_cycle : (M,)
        One of them: damping mass over the size of the effective mass; loss per cycle over m V^2; or loss per cycle [J].
        See `rb.loss_map`. The first one is unbounded where the effective mass passes through zero; prefer the others.
    error
        Standard uncertainty of a loss: "5 %" of each value, or numbers.
    cycles
        Numbers of cycles of the simulation to skip, and to average over.

    Raises
    ------
    CaseError
        If a value is not valid, not exactly one kind of loss is given, or their numbers differ.
    """

    amplitude: Any
    frequency: Any
    loss_factor: Any = None
    reduced_loss: Any = None
    loss_per_cycle: Any = None
    error: Any = None
    cycles: tuple[int, int] = (20, 40)
    unit: Any = field(init=False, default=None, repr=False)
    measure: Any = field(init=False, default=None, repr=False)
    loss: Any = field(init=False, default=None, repr=False)

    def __post_init__(self) -> None:
        given = {name: getattr(self, name) for name in _LOSSES}
        one_of("reduced_loss = [0.6, 0.4]", **given)
        if self.error is None:
            raise Hint("the standard uncertainty of the loss is needed", 'error = "5 %"', ["error"])
        (measure,) = (name for name, value in given.items() if value is not None)
        units = () if _LOSSES[measure] == "1" else (_LOSSES[measure],)
        loss = read_column(measure, given[measure], units).values
        amplitude, unit = read_column("amplitude", self.amplitude, ("m", "m/s^2"))
        if unit is None:
            with at("amplitude"):
                raise Hint(
                    "the unit distinguishes a displacement from an acceleration", '"20 m/s^2", "2 g" or "0.5 mm"'
                )
        amplitude = _one_or_all("amplitude", amplitude, loss.size)
        frequency = _one_or_all("frequency", read_column("frequency", self.frequency, ("Hz",)).values, loss.size)
        complete(
            self,
            amplitude=amplitude,
            frequency=frequency,
            error=read_error(self.error, loss, units),
            cycles=whole_cycles(self.cycles),
            measure=measure,
            loss=loss,
            unit=unit,
        )

    def arguments(self) -> dict[str, Any]:
        """Return the arguments of the class, in SI units."""
        return {
            "amplitude": (self.amplitude, self.unit),
            "frequency": self.frequency,
            self.measure: self.loss,
            "error": self.error,
            "cycles": self.cycles,
        }


Contacts = Drops | BounceTimes
"""Data that give the restitution in closed form."""
Losses = RingDown | ShakerLoss
"""Data that are compared with simulations."""


def read_data(data: object) -> tuple[list[Contacts], list[Losses]]:
    """Return the measurements of single impacts, and those of losses."""
    items = list(data) if isinstance(data, Sequence) and not isinstance(data, str) else [data]
    example = 'rb.Drops(height="300 mm", rebound=["192 mm", "189 mm", "194 mm"])'
    if not items:
        raise Hint("data is empty", example, ["data"])
    for number, item in enumerate(items):
        if not isinstance(item, (Drops, BounceTimes, RingDown, ShakerLoss)):
            raise Hint(f"{item!r:.60} is not a measurement", example, ["data", number])
    contacts: list[Contacts] = [item for item in items if isinstance(item, (Drops, BounceTimes))]
    losses: list[Losses] = [item for item in items if isinstance(item, (RingDown, ShakerLoss))]
    if contacts and losses:
        raise Hint(
            "measurements of single impacts and of losses are not calibrated together",
            "the restitution first, from drops or bounces; then the friction, with known = {...: (restitution, half width)}",
            ["data"],
        )
    return contacts, losses


def source_of(data: Contacts | Losses) -> str:
    """Return the Python source of a measurement, with numbers in SI units."""
    words = [f"{name}={_source(value)}" for name, value in data.arguments().items() if value is not None]
    return f"rb.{type(data).__name__}({', '.join(words)})"


def _source(value: object) -> str:
    if isinstance(value, Sphere):
        return f"rb.Sphere(radius={value.half!r}, mass={value.weight!r}, material='steel')"
    if isinstance(value, tuple) and isinstance(value[0], np.ndarray):
        return f"({value[0].tolist()!r}, {value[1]!r})"
    return repr(value.tolist() if isinstance(value, np.ndarray) else value)
