"""Loads and motions in time: half-sine pulse, harmonic, record; and helpers that make records."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    BaseModel,
    BeforeValidator,
    Field,
    PrivateAttr,
    WithJsonSchema,
    field_validator,
    model_serializer,
    model_validator,
)

from rattlebox._util.exceptions import DataError

from .base import Part
from .elementwise import power
from .errors import Hint, at, nearest
from .files import absolute
from .records import Column, Columns, as_columns, read_columns
from .space import Direction
from .units import (
    Angle,
    NotNegativeTime,
    Number,
    PositiveFrequency,
    PositiveTime,
    factor_of,
    numbers,
    parse,
    parse_density,
    unit_above,
)

Unit = Literal["N", "m/s^2", "m"]
_UNITS: tuple[Unit, ...] = ("N", "m/s^2", "m")
_NAMES = {"N": "a force", "m/s^2": "an acceleration", "m": "a displacement"}

ROUNDING = 1e-9
"""Of the duration: what times of a record may miss by where they were added up."""


class _Amplitude(float):
    """A number that remembers which unit it was given in."""

    unit: str | None = None


def _amplitude(value: Any) -> _Amplitude:
    number, unit = parse(value, _UNITS)
    result = _Amplitude(number)
    result.unit = getattr(value, "unit", None) if isinstance(value, _Amplitude) else unit
    return result


Amplitude = Annotated[
    float,
    BeforeValidator(_amplitude),
    WithJsonSchema(
        {
            "anyOf": [{"type": "number"}, {"type": "string"}],
            "description": "force as a load, acceleration as base motion, displacement or acceleration on a shaker",
            "examples": ["5 kN", "9.81 m/s^2", "1 mm"],
        }
    ),
]


class Signal(Part):
    """What all signals share.

    Parameters
    ----------
    unit
        SI unit of the values, "N", "m/s^2" or "m"; taken from the amplitude, or from the place of use.
    point
        Point of the structure that a load acts at; not needed where there is one only.
    direction
        Of a load at a point that moves in space, or of a motion of the base with particle dampers: "x", "y", "z" or three
        numbers. Left out, the base moves along the direction of the dampers.
    """

    held_as: ClassVar[tuple[str, ...]] = ("load", "loads", "base", "motion")
    examples_in: ClassVar[dict[str, dict[str, str]]] = {
        "base": {"amplitude": '"9.81 m/s^2"'},
        "motion": {"amplitude": '"1 mm"'},
    }
    kind: str
    unit: Unit | None = None
    point: str | None = None
    direction: Direction | None = None

    @field_validator("unit", mode="before")
    @classmethod
    def _without_prefix(cls, value: Any) -> Any:
        if not isinstance(value, str) or value in _UNITS:
            return value
        known = factor_of(value, _UNITS)
        try:
            factor, unit = known or parse(f"1 {value}", _UNITS)
        except Hint:
            return value
        if factor == 1:
            return unit
        advice = f'unit = "{unit}", scale = {factor!r}' if "scale" in cls.model_fields else f'amplitude = "5 {value}"'
        raise Hint(f"must be {', '.join(map(repr, _UNITS[:-1]))} or {_UNITS[-1]!r}", advice)

    @model_validator(mode="before")
    @classmethod
    def _unit_of_amplitude(cls, values: Any) -> Any:
        if isinstance(values, dict) and "amplitude" in values:
            try:
                unit = parse(values["amplitude"], _UNITS)[1]
            except Hint:
                return values
            if unit is not None:
                if values.get("unit") not in (None, unit):
                    raise Hint(f"the amplitude is in {unit}", "leave unit out", ["unit"])
                return {**values, "unit": unit}
        return values

    def placed(self, allowed: Sequence[Unit], place: str) -> Signal:
        """Return the signal with its unit settled for the place it is used in.

        Parameters
        ----------
        allowed
            SI units that the place takes; the first is what bare numbers mean.
        place
            Name of the place, for the message.

        Raises
        ------
        Hint
            When the signal is in another unit.
        """
        unit = allowed[0] if self.unit is None else self.unit
        if unit not in allowed:
            wanted = " or ".join(f"{_NAMES[a]} ({a})" for a in allowed)
            where, amount = ("unit", "") if self.kind == "record" else ("amplitude", "1 ")
            raise Hint(f"{place} needs {wanted}, not {_NAMES[unit]}", f'{where} = "{amount}{allowed[0]}"', [where])
        return self if self.unit == unit else self.model_copy(update={"unit": unit})

    def evaluate(self, time: Any) -> NDArray[np.float64]:
        """Return the values at the given times [s], in the signal's unit, same shape."""
        raise NotImplementedError

    def coefficients(self) -> dict[str, Any]:
        """Return what the core reads (core/structure/signal.hpp)."""
        raise NotImplementedError


class HalfSine(Signal):
    """A half-sine pulse, amplitude sin(pi (t - start) / duration) for start <= t < start + duration.

    Parameters
    ----------
    amplitude
        Peak value, with its unit.
    duration, start
        Length and begin of the pulse [s].
    """

    kind: Literal["half_sine"] = "half_sine"
    amplitude: Amplitude
    duration: PositiveTime
    start: NotNegativeTime = 0.0

    def evaluate(self, time: Any) -> NDArray[np.float64]:
        """Return the values at the given times [s]."""
        t = np.asarray(time, dtype=float)
        inside = (t >= self.start) & (t < self.start + self.duration)
        return np.where(inside, self.amplitude * np.sin(math.pi * (t - self.start) / self.duration), 0.0)

    def coefficients(self) -> dict[str, Any]:
        """Return what the core reads."""
        return {
            "kind": "half_sine",
            "amplitude": +self.amplitude,  # a plain number
            "frequency": math.pi / self.duration,
            "phase": 0.0,
            "start": self.start,
            "stop": self.start + self.duration,
        }


class Harmonic(Signal):
    """A harmonic, amplitude sin(2 pi frequency t + phase) for start <= t < stop.

    Parameters
    ----------
    amplitude
        Peak value, with its unit.
    frequency
        In Hz; text in "rad/s" is an angular frequency.
    phase
        In rad, or text in "deg".
    start, stop
        When it acts [s]; stop is left out for good.
    """

    kind: Literal["harmonic"] = "harmonic"
    amplitude: Amplitude
    frequency: PositiveFrequency
    phase: Angle = 0.0
    start: NotNegativeTime = 0.0
    stop: PositiveTime | None = None

    @model_validator(mode="after")
    def _in_order(self) -> Harmonic:
        if self.stop is not None and self.stop <= self.start:
            raise Hint(f"must be later than start, {self.start:g} s", place=["stop"])
        return self

    def evaluate(self, time: Any) -> NDArray[np.float64]:
        """Return the values at the given times [s]."""
        t = np.asarray(time, dtype=float)
        inside = (t >= self.start) & (t < (math.inf if self.stop is None else self.stop))
        return np.where(inside, self.amplitude * np.sin(2 * math.pi * self.frequency * t + self.phase), 0.0)

    def coefficients(self) -> dict[str, Any]:
        """Return what the core reads."""
        return {
            "kind": "harmonic",
            "amplitude": +self.amplitude,  # a plain number
            "frequency": 2 * math.pi * self.frequency,
            "phase": self.phase,
            "start": self.start,
            "stop": math.inf if self.stop is None else self.stop,
        }

    def acceleration(self) -> Harmonic:
        """Return the acceleration that belongs to a harmonic displacement."""
        factor = -power(2 * math.pi * self.frequency, 2)
        return self.model_copy(update={"amplitude": self.amplitude * factor, "unit": "m/s^2"})


def _in_si(found: Columns, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return times and values of a file, with unit and scale as given, or else as stated above the columns.

    Raises
    ------
    DataError
        If the file states a unit that is unknown.
    Hint
        If the unit is of another kind than the one given.
    """
    times, values, (above_times, above_values) = found
    try:
        slower, _ = unit_above(above_times, ("s",)) or (1.0, "s")
    except Hint as hint:
        raise DataError(hint.complaint, 'times in seconds below the heading "time (s)"', ["file"]) from None
    read = {"times": times * slower if slower != 1 else times, "values": values}
    if given.get("scale") is not None:
        return read
    wanted = given.get("unit")
    try:
        written = unit_above(above_values, _UNITS)
    except Hint as hint:
        if wanted in _UNITS:
            return read  # the numbers are in the unit that is given
        advice = 'unit = "m/s^2", and scale = ..., the factor from the numbers to that unit'
        raise DataError(hint.complaint, advice, ["file"]) from None
    if written is None:
        return read
    scale, unit = written
    if wanted in _UNITS and wanted != unit:
        raise Hint(
            f"the file has {_NAMES[unit]} in this column, not {_NAMES[wanted]}",
            f"another column, or scale = ..., what its numbers are multiplied by to be in {wanted}",
            ["unit"],
        )
    return {**read, "unit": wanted or unit, "scale": scale}


def _column(value: Any) -> tuple[float, ...]:
    try:
        array = numbers(value)
    except Hint as hint:
        advice = 'numbers alone: times in s, values in `unit` ("N"), which are multiplied by `scale`'
        raise Hint(hint.complaint, hint.suggestion or advice, hint.place) from None
    if array.ndim != 1:
        raise Hint(f"one row of numbers is needed, not shape {array.shape}")
    return tuple(array.tolist())


class Record(Signal):
    """A record, straight lines between points; it must cover the whole run.

    Samples of a signal lose high frequencies: the straight lines between samples at a rate R multiply the amplitude at
    frequency f by sinc^2(f / R) = (sin(pi f / R) / (pi f / R))^2, and add images at k R +- f, of amplitude
    sinc^2(k +- f / R). It is 1 % at 18 samples a period, 3 % at 10 and 19 % at 4. A run warns where this changes the
    response of a mode by more than 2 %.

    Parameters
    ----------
    times
        Strictly increasing [s].
    values, scale
        As many, in `unit`, and what they are multiplied by. Left out, `scale` is 1, or follows from the unit in the file.
    file, columns
        Instead of both: a CSV, NPY, NPZ or MAT file, and its columns of times and values, by number counted from 1 or by
        name: `columns=(1, 3)`, `columns=("t", "a")`. Variables count in the order of the file. They may be left out where
        there are only two, or variables called time and value. Units above the columns of a text file, as in "time (ms),
        acceleration (g)", are converted; unknown ones are refused. Without them times are in s, and values in `unit`; if
        neither states a unit, the run notes the unit that is assumed, and the peak.
    """

    elementwise: ClassVar[bool] = False
    in_file: ClassVar[tuple[str, ...]] = ("times", "values")
    kind: Literal["record"] = "record"
    times: Annotated[tuple[float, ...], BeforeValidator(_column)] = ()
    values: Annotated[tuple[float, ...], BeforeValidator(_column)] = ()
    file: str | None = None
    columns: tuple[Column, Column] | None = None
    scale: Number = 1.0
    _unit_is_assumed: bool = PrivateAttr(default=False)

    @model_validator(mode="before")
    @classmethod
    def _from_file(cls, values: Any) -> Any:
        if not isinstance(values, dict):
            return values
        if values.get("file") is None:
            if values.get("columns") is not None:
                raise Hint("columns are those of a file", 'file = "push.csv"', ["columns"])
            return values
        if "times" in values or "values" in values:
            raise Hint(
                "give times and values, or a file, not both", 'columns = ["time", "force"] names those of the file'
            )
        with at("columns"):
            columns = as_columns(values.get("columns"))
        with at("file"):
            path = absolute(values["file"])
            found = read_columns(path, columns)
        return {**values, **_in_si(found, values), "file": path}

    @model_validator(mode="after")
    def _sound(self) -> Record:
        if len(self.times) != len(self.values):
            raise Hint(f"{len(self.times)} times, but {len(self.values)} values", "as many of both")
        if len(self.times) < 2:
            raise Hint("a record needs at least two points", place=self.where)
        steps = np.flatnonzero(np.diff(self.times) <= 0)
        if steps.size:
            raise Hint(
                f"times must increase, but point {int(steps[0]) + 2} is not later than the one before",
                "columns = [2, 1], if times and values are swapped" if self.file else "",
                self.where,
            )
        BaseModel.__setattr__(self, "_unit_is_assumed", self.file is not None and self.unit is None)
        return self

    @property
    def unit_is_assumed(self) -> bool:
        """Whether neither the file nor the user states the unit of the values."""
        return self._unit_is_assumed

    @property
    def where(self) -> tuple[str, ...]:
        """The field that gives the numbers, for messages."""
        return ("file",) if self.file else ("times",)

    @model_serializer(mode="wrap")
    def _file_stands_for_numbers(self, handler: Any) -> Any:
        data = handler(self)
        if self.file is not None:
            for name in self.in_file:
                data.pop(name, None)
        if self._unit_is_assumed:
            data.pop("unit", None)
        return data

    @classmethod
    def from_file(cls, path: str | os.PathLike[str], **options: Any) -> Record:
        """Read a record from a CSV, NPY, NPZ or MAT file.

        Parameters
        ----------
        path
            The file; times in seconds, unless it says otherwise above them.
        **options
            columns, unit, scale, point.

        Raises
        ------
        CaseError
            When the file cannot be read, naming the line that is wrong or the columns that there are.
        """
        return cls(file=os.fspath(path), **options)

    def evaluate(self, time: Any) -> NDArray[np.float64]:
        """Return the values at the given times [s]."""
        t, values = np.asarray(time, dtype=float), self.scale * np.asarray(self.values)
        first, last = self.times[0], self.times[-1]
        near = np.clip(t, first, last)  # the end of a run that the record covers but for rounding
        t = np.where(np.abs(t - near) <= ROUNDING * last, near, t)
        return np.asarray(np.interp(t, self.times, values, left=0.0, right=0.0))

    def covers(self, duration: float) -> bool:
        """Return whether it lasts from 0 to the end of a run [s]; times that were added up may miss both by rounding."""
        slack = ROUNDING * duration
        return self.times[0] <= slack and self.times[-1] >= duration - slack

    def coefficients(self) -> dict[str, Any]:
        """Return what the core reads."""
        return {
            "kind": "record",
            "times": np.array(self.times),
            "values": self.scale * np.array(self.values),
        }


AnySignal = Annotated[HalfSine | Harmonic | Record, Field(discriminator="kind")]


def as_several(value: Any) -> Any:
    """Let one stand for a list of one, None for none."""
    if value is None:
        return ()
    return tuple(value) if isinstance(value, (list, tuple)) else (value,)


def signals_in(*units: Unit) -> BeforeValidator:
    """Return a validator that lets one signal stand for a list of one, and looks at the units of amplitudes."""

    def read(value: Any) -> Any:
        signals = as_several(value)
        for index, signal in enumerate(signals):
            if isinstance(signal, dict) and "amplitude" in signal:
                with at(index, "amplitude"):
                    parse(signal["amplitude"], units)
        return signals

    return BeforeValidator(read)


_SWEEPS = ("linear", "logarithmic")


def _si(name: str, value: Any, unit: str) -> float:
    """The argument of this name in an SI unit."""
    with at(name):
        return parse(value, (unit,))[0]


def chirp(
    amplitude: Any,
    f0: Any,
    f1: Any,
    duration: Any,
    *,
    rate: Any = None,
    method: Literal["linear", "logarithmic"] = "linear",
    point: str | None = None,
) -> Record:
    """Make a sweep from f0 to f1 as a record.

    Parameters
    ----------
    amplitude
        Peak value, with its unit.
    f0, f1
        First and last frequency [Hz], or text with a unit.
    duration
        Length [s], or text with a unit.
    rate
        Points per second [Hz]; default 200 per period of the highest frequency (error below 1.3e-4 of the amplitude).
    method
        How frequency grows with time.
    point
        Point of the structure.

    Raises
    ------
    CaseError
        When something is no such quantity, or the rate less than twice the highest frequency.
    """
    f0, f1, duration = _si("f0", f0, "Hz"), _si("f1", f1, "Hz"), _si("duration", duration, "s")
    if not (f0 > 0 and f1 > 0 and duration > 0):
        raise Hint("a chirp needs positive frequencies and duration")
    if method not in _SWEEPS:
        raise Hint(f"there is no method {method!r}", nearest(str(method), _SWEEPS), ["method"])
    highest = max(f0, f1)
    rate = 200 * highest if rate is None else _si("rate", rate, "Hz")
    if rate < 2 * highest:
        raise Hint(
            "a chirp needs a rate of at least twice the highest frequency", f"rate = {200 * highest:g}", ["rate"]
        )
    with at("amplitude"):
        number, unit = parse(amplitude, _UNITS)
    count = math.ceil(duration * rate) + 1
    t = np.linspace(0, duration, count)
    if method == "linear" or f0 == f1:
        phase = 2 * np.pi * (f0 * t + (f1 - f0) * t**2 / (2 * duration))
    else:
        growth = math.log(f1 / f0)
        phase = 2 * np.pi * f0 * duration / growth * np.expm1(growth * t / duration)
    return Record(times=t, values=number * np.sin(phase), unit=unit, point=point)


POINTS_PER_PERIOD = 16
"""Least number of points in a period of the highest frequency of a random record."""


def random_record(
    psd: Sequence[tuple[Any, Any]],
    duration: Any,
    rate: Any = None,
    *,
    seed: int = 0,
    unit: str | None = None,
    point: str | None = None,
    direction: Any = None,
) -> Record:
    """Make a Gaussian random record of a given power spectral density.

    The record has the density asked for, although it consists of straight lines between its points: below the highest
    frequency of `psd` the expected density is the one given, and less than 0.1 % of the power lies above it.

    Parameters
    ----------
    psd
        Points (frequency [Hz], one-sided density), numbers or text with units: ("20 Hz", "0.04 g_0^2/Hz"). The density is
        linear in log-log scales between points, and zero outside.
    duration
        Length [s]; the last point is at the duration or the first after it.
    rate
        Points per second [Hz]. The record has at least 16 points in a period of the highest frequency of `psd`: a lower
        rate is raised to that, which is the default.
    seed
        Seed of the random amplitudes. The same seed and duration give the same signal, at any rate.
    unit
        Unit of the values, whose square per Hz is the unit of densities without one: "N", "m/s^2", "m", or another of these
        dimensions, such as "g_0", "gal", "kN" or "mm". The record is in the SI unit.
    point, direction
        Point of the structure and direction, as for `Record`.

    Returns
    -------
    Record
        The record, in SI units.

    Raises
    ------
    CaseError
        If an argument is not such a quantity, units contradict each other, or the record is too short for its band.

    Notes
    -----
    The signal is a sum of harmonics at the multiples of 1 / duration, whose sine and cosine amplitudes are independent
    Gaussian numbers of variance S(f) / duration (compare Shinozuka and Deodatis 1991). Straight lines between points at the
    rate R multiply the amplitude at f by sinc^2(f / R) = (sin(pi f / R) / (pi f / R))^2, by which it is divided here, and
    add images at k R +- f with sinc^2(k +- f / R) of it: at 16 points a period, less than 4e-5 of the power.

    References
    ----------
    M. Shinozuka, G. Deodatis (1991): Simulation of stochastic processes by spectral representation. Applied Mechanics
    Reviews 44, 191-204, doi:10.1115/1.3119501.

    Examples
    --------
    >>> import rattlebox as rb
    >>> shaking = rb.random_record([(20, "0.01 g_0^2/Hz"), (2000, "0.01 g_0^2/Hz")], "0.5 s")
    >>> shaking.unit, len(shaking.times)
    ('m/s^2', 16001)
    """
    corners, unit = _densities(psd, unit)
    duration = _si("duration", duration, "s")
    highest = float(corners[-1, 0])
    rate = 0.0 if rate is None else _si("rate", rate, "Hz")
    if not (duration > 0 and rate >= 0):
        raise Hint("a random record needs a positive duration and rate", 'duration = "10 s", and no rate')
    rate = max(rate, POINTS_PER_PERIOD * highest)
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0:
        raise Hint(f"{seed!r} is no seed, a whole number from 0 on", "seed = 0", ["seed"])
    count = math.ceil(duration * rate * (1 - 1e-12))  # 0.07 s of 100 Hz may be a little more than 7
    frequency = np.fft.rfftfreq(count, 1 / rate)
    inside = np.flatnonzero((frequency >= corners[0, 0]) & (frequency <= highest))
    if not inside.size:
        raise Hint(f"no frequency of a record of {duration:g} s lies in the band", "a longer record")
    logs = np.log(corners)
    density = np.exp(np.interp(np.log(frequency[inside]), logs[:, 0], logs[:, 1]))
    noise = np.random.default_rng(seed).standard_normal((inside.size, 2)) @ (1, 1j)
    spectrum = np.zeros(frequency.size, complex)
    spectrum[inside] = np.sqrt(density * rate * count / 4) * noise / np.sinc(frequency[inside] / rate) ** 2
    values = np.fft.irfft(spectrum, count)
    times = np.arange(count + 1) / rate
    return Record(times=times, values=np.append(values, values[0]), unit=unit, point=point, direction=direction)


def _densities(psd: Any, unit: str | None) -> tuple[NDArray[np.float64], Any]:
    """Return the points of a density in SI, (n, 2), and the SI unit of the signal.

    Raises
    ------
    Hint
        If a number or a unit is wrong, or units contradict each other.
    """
    factor, found = 1.0, None
    if unit is not None:
        with at("unit"):
            known = factor_of(unit, _UNITS) if isinstance(unit, str) else None
            if known is None:
                raise Hint(f"{unit!r} is not a unit of force, acceleration or displacement", 'unit = "g_0"')
            factor, found = known
    corners = []
    with at("psd"):
        needed = "a PSD needs positive (frequency, density) pairs with rising frequencies"
        advice = '[(10, 1e-3), (200, 1e-3)] or [(10, "0.04 g_0^2/Hz"), (200, "0.04 g_0^2/Hz")]'
        if isinstance(psd, (str, Mapping)) or np.ndim(np.asarray(psd, dtype=object)) != 2 or np.shape(psd)[1] != 2:
            raise Hint(needed, advice)
        for index, (frequency, density) in enumerate(psd):
            with at(index):
                with at(0):
                    hertz = parse(frequency, ("Hz",))[0]
                with at(1):
                    number, own = parse_density(density, _UNITS)
                    if own is not None and found not in (None, own):
                        raise Hint(f"the density of {_NAMES[own]}, but others are of {_NAMES[str(found)]}", "one unit")
            found = own or found
            corners.append((hertz, number if own else number * factor**2))
        points = np.array(corners).reshape(-1, 2)
        if not points.size or np.any(points <= 0) or np.any(np.diff(points[:, 0]) <= 0):
            raise Hint(needed, advice)
    return points, found
