"""Loads and motions in time: half-sine pulse, harmonic, record; and helpers that make records."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, WithJsonSchema, field_validator, model_serializer, model_validator

from .base import Part
from .elementwise import power
from .errors import Hint, at, nearest
from .files import absolute
from .records import Column, Columns, as_columns, read_columns
from .space import Direction
from .units import Angle, NotNegativeTime, Number, PositiveFrequency, PositiveTime, numbers, parse, stated

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
        known = stated(value, _UNITS)
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
    """Times and values of a file; unit and scale as they are given, or as they are written above the values."""
    times, values, (above_times, above_values) = found
    slower = next((known[0] for text in reversed(above_times) if (known := stated(text, ("s",)))), 1.0)
    read = {"times": times * slower if slower != 1 else times, "values": values}
    written = next((known for text in reversed(above_values) if (known := stated(text, _UNITS))), None)
    if written is None or given.get("scale") is not None:
        return read
    scale, unit = written
    wanted = given.get("unit")
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
        acceleration (g)", are kept to; else times are in s.
    """

    in_file: ClassVar[tuple[str, ...]] = ("times", "values")
    kind: Literal["record"] = "record"
    times: Annotated[tuple[float, ...], BeforeValidator(_column)] = ()
    values: Annotated[tuple[float, ...], BeforeValidator(_column)] = ()
    file: str | None = None
    columns: tuple[Column, Column] | None = None
    scale: Number = 1.0

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
        return self

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


def random_record(
    psd: Sequence[tuple[float, float]],
    duration: Any,
    rate: Any,
    *,
    seed: int = 0,
    unit: Unit | None = None,
    point: str | None = None,
) -> Record:
    """Make a Gaussian random record of a given power spectral density.

    Parameters
    ----------
    psd
        Points (frequency [Hz], one-sided density [unit^2/Hz]); straight lines in log-log between, nothing outside.
    duration, rate
        Length [s] and points per second [Hz], or text with units; the last point is at the duration or the first after it.
    seed
        Of the random phases and amplitudes: the same seed gives the same record.
    unit, point
        Unit of the values, point of the structure.

    Raises
    ------
    CaseError
        When something is no such number, or the rate less than twice the highest frequency.
    """
    with at("psd"):
        corners = numbers(psd)
    if (
        corners.ndim != 2
        or corners.shape[1] != 2
        or not corners.size
        or np.any(corners <= 0)
        or np.any(np.diff(corners[:, 0]) <= 0)
    ):
        raise Hint(
            "a PSD needs positive (frequency, density) pairs with rising frequencies",
            "[(10, 1e-3), (200, 1e-3)]",
        )
    duration, rate = _si("duration", duration, "s"), _si("rate", rate, "Hz")
    if not (duration > 0 and rate >= 2 * corners[-1, 0]):
        raise Hint(
            "a random record needs a positive duration, and a rate of at least twice the highest frequency",
            f"rate = {10 * corners[-1, 0]:g}",
        )
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0:
        raise Hint(f"{seed!r} is no seed, a whole number from 0 on", "seed = 0", ["seed"])
    count = math.ceil(duration * rate * (1 - 1e-12))  # 0.07 s of 100 Hz may be a little more than 7
    frequency = np.fft.rfftfreq(count, 1 / rate)
    inside = (frequency >= corners[0, 0]) & (frequency <= corners[-1, 0])
    if not inside.any():
        raise Hint(f"no frequency of a record of {duration:g} s lies in the band", "a longer record")
    density = np.zeros(frequency.size)
    logs = np.log(corners)
    density[inside] = np.exp(np.interp(np.log(frequency[inside]), logs[:, 0], logs[:, 1]))
    generator = np.random.default_rng(seed)
    noise = generator.standard_normal((2, frequency.size))
    spectrum = np.sqrt(density * rate * count / 4) * (noise[0] + 1j * noise[1])
    values = np.fft.irfft(spectrum, count)
    times = np.arange(count + 1) / rate
    return Record(times=times, values=np.append(values, values[0]), unit=unit, point=point)
