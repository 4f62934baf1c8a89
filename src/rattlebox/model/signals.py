"""Base classes of signals, for loads and motions."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator, WithJsonSchema, field_validator, model_validator

from .as_written import Given
from .base import Part
from .elementwise import Vector
from .errors import Hint, at
from .space import Direction
from .units import factor_of, parse

Unit = Literal["N", "m/s^2", "m"]
UNITS: tuple[Unit, ...] = ("N", "m/s^2", "m")
UNIT_NAMES = {"N": "a force", "m/s^2": "an acceleration", "m": "a displacement"}


_PROFILES = "a Random, a SineSweep, or pairs of frequency and amplitude"
_EXAMPLES = {"N": "5 kN", "m/s^2": "9.81 m/s^2", "m": "1 mm"}


def _amplitude(value: object) -> float:
    return parse(value, UNITS)[0]


Amplitude = Annotated[
    float,
    BeforeValidator(_amplitude),
    WithJsonSchema(
        {
            "anyOf": [{"type": "number"}, {"type": "string"}],
            "description": "force as a load, acceleration as base motion, displacement or acceleration on a shaker",
            "examples": list(_EXAMPLES.values()),
        }
    ),
]


class Signal(Part):
    """Base class of signals.

    Parameters
    ----------
    unit
        SI unit of the values, "N", "m/s^2" or "m"; default that of the amplitude, or of the field of the case.
    point
        Point of the structure at which a load acts; needed if there are several.
    direction
        Direction of a load at a point in 3-D, or of a motion of the base with particle dampers: "x", "y", "z" or three
        numbers. By default the base moves along the direction of the dampers.
    """

    field_names: ClassVar[tuple[str, ...]] = ("load", "loads", "base", "motion")
    kinds: ClassVar[dict[str, type[Part]]] = {}
    examples_in: ClassVar[dict[str, dict[str, str]]] = {
        "base": {"amplitude": '"9.81 m/s^2"'},
        "motion": {"amplitude": '"1 mm"'},
    }
    kind: str
    is_sweep: ClassVar[bool] = False
    """Whether the frequency changes slowly, so that the response is nearly that of each frequency."""
    is_sampled: ClassVar[bool] = False
    """Whether the signal is known at samples only, of which a step in time takes the mean."""
    spectra: ClassVar[tuple[str, ...]] = ()
    """Figures over frequency, methods of `Run.plot`, that suit a response to the signal."""
    is_density: ClassVar[bool] = False
    """Whether the levels of the profile are a power spectral density."""
    unit: Unit | None = None
    point: str | None = None
    direction: Direction | None = None

    @property
    def is_lasting(self) -> bool:
        """Whether a steady excitation continues to the end of every run."""
        return False

    @field_validator("unit", mode="before")
    @classmethod
    def _without_prefix(cls, value: object) -> Any:
        if not isinstance(value, str) or value in UNITS:
            return value
        known = factor_of(value, UNITS)
        try:
            factor, unit = known or parse(f"1 {value}", UNITS)
        except Hint:
            return value
        if factor == 1:
            return unit
        raise Hint(f"must be {', '.join(map(repr, UNITS[:-1]))} or {UNITS[-1]!r}", f'amplitude = "5 {value}"')

    @model_validator(mode="before")
    @classmethod
    def _read_amplitude(cls, values: object) -> Any:
        try:
            return _with_unit_of_amplitude(values, UNITS) if isinstance(values, dict) else values
        except Hint as hint:
            if hint.place == ("unit",):
                raise
            return values  # the field raises, together with other fields

    @classmethod
    def excluded_by(cls, name: str, value: object) -> list[str]:
        """Return the fields that a value of a field excludes; an amplitude with a unit excludes `unit`."""
        excluded = super().excluded_by(name, value)
        try:
            is_unit = name == "amplitude" and parse(value, UNITS)[1] is not None
        except (Hint, TypeError):  # the validation of the signal raises a better message
            is_unit = False
        return [*excluded, "unit"] if is_unit else excluded

    def placed(self, allowed: Sequence[Unit], place: str) -> Signal:
        """Return the signal with the unit of the field in which it is used.

        Parameters
        ----------
        allowed
            SI units that the field accepts; the first is the unit of bare numbers.
        place
            Name of the field, for the message.

        Returns
        -------
        Signal
            The signal with its unit.

        Raises
        ------
        Hint
            If the signal is in another unit.
        """
        unit = allowed[0] if self.unit is None else self.unit
        if unit not in allowed:
            wanted = " or ".join(f"{UNIT_NAMES[a]} ({a})" for a in allowed)
            where = "amplitude" if "amplitude" in type(self).model_fields else "unit"
            raise Hint(f"{place} needs {wanted}, not {UNIT_NAMES[unit]}", self.unplaced(allowed), [where])
        return self if self.unit == unit else self.model_copy(update={"unit": unit})

    def unplaced(self, allowed: Sequence[Unit]) -> str:
        """Return advice for a signal in another unit than a field of a case accepts; `allowed` are those of the field."""
        examples = " or ".join(f'"{_EXAMPLES[unit]}"' for unit in allowed)
        return (
            f"an amplitude such as {examples}" if "amplitude" in type(self).model_fields else f"values in {allowed[0]}"
        )

    def notes(self) -> Iterator[str]:
        """Return notes on assumptions, such as the unit of a file."""
        return iter(())

    @abstractmethod
    def evaluate(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the values at the given times [s], in the unit of the signal, same shape."""

    @abstractmethod
    def coefficients(self) -> dict[str, Any]:
        """Return the coefficients for the core, by name."""

    @abstractmethod
    def motion(self, time: Vector) -> Vector:
        """Return displacement, velocity and acceleration, (3, T), of which the signal is the acceleration.

        They have no discretisation error. The motion starts from rest; that of an unlimited harmonic has zero means.
        """

    @property
    def levels(self) -> NDArray[np.float64]:
        """Levels of a test profile, (n, 2): frequency [Hz] and amplitude or density, straight in log-log scales."""
        raise Hint(f"a signal of kind {self.kind!r} has no levels over frequency", _PROFILES)

    def with_levels(self, levels: NDArray[np.float64]) -> Signal:
        """Return the profile with other levels in the same unit, (n, 2)."""
        raise Hint(f"a signal of kind {self.kind!r} has no levels over frequency", _PROFILES)

    @property
    def is_resolved(self) -> bool:
        """Whether steps of the output resolve the signal; others, such as pulses, are averaged over each step."""
        return False

    @property
    def shortest_time(self) -> tuple[float, str] | None:
        """Time that a step must resolve [s], with its name; None if the signal is smooth between its samples."""
        return None

    def mean_harmonic(self, duration: float) -> tuple[float, float]:
        """Return frequency [Hz] and amplitude of the harmonic with the same mean squares of acceleration and velocity."""
        _, velocity, acceleration = self.motion(np.linspace(0.0, duration, _INSTANTS))
        size, speed = float(acceleration.std()), float(velocity.std())
        return (size / speed / (2 * math.pi) if speed > 0 else 0.0), math.sqrt(2) * size

    def words(self) -> str:
        """Return a phrase: "a harmonic force of 5 N at 10 Hz"."""
        return f"a {self.kind.replace('_', ' ')} {self._quantity}"

    @property
    def _quantity(self) -> str:
        """Name of the quantity."""
        return {"N": "force", "m/s^2": "acceleration", "m": "displacement"}.get(self.unit or "", "signal")


_INSTANTS = 1 << 14
"""Times at which the mean squares of a signal are computed."""

ROUNDING = 1e-9
"""Tolerance for the rounding of accumulated times of a record, relative to the duration."""


@dataclass(frozen=True, eq=False)
class Points:
    """Times [s] and values of a polyline, computed once and not compared."""

    times: Vector
    values: Vector


class Polyline(Signal):
    """Piecewise linear signal, zero before its first and after its last point.

    Two points at the same time are a jump.
    """

    elementwise: ClassVar[bool] = False

    @abstractmethod
    def polyline(self) -> tuple[Vector, Vector]:
        """Return times [s], in order, and values, (n,) each."""

    def evaluate(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the values at the given times [s], by linear interpolation; at a jump, the value after it."""
        t = np.asarray(time, dtype=float)
        times, values = self.polyline()
        after = np.clip(np.searchsorted(times, t, side="right"), 1, times.size - 1)
        span = times[after] - times[after - 1]
        share = np.where(span > 0, (t - times[after - 1]) / np.where(span > 0, span, 1.0), 1.0)
        inside = (t >= times[0]) & (t <= times[-1])
        return np.where(inside, values[after - 1] + share * (values[after] - values[after - 1]), 0.0)

    def coefficients(self) -> dict[str, Any]:
        """Return the coefficients for the core."""
        times, values = self.polyline()
        return {"kind": "record", "times": times, "values": values}

    def motion(self, time: Vector) -> Vector:
        """Return displacement, velocity and acceleration, (3, T).

        Over an interval with a + s t, v = v_0 + a t + s t^2 / 2 and u = u_0 + v_0 t + a t^2 / 2 + s t^3 / 6. There is no
        correction of the baseline: the mean of a record is part of its motion.
        """
        t, a = self.polyline()
        h = np.diff(t)
        v_knots = np.concatenate([[0.0], np.cumsum(h * (a[1:] + a[:-1]) / 2)])
        u_knots = np.concatenate([[0.0], np.cumsum(h * v_knots[:-1] + h**2 * (2 * a[:-1] + a[1:]) / 6)])

        def integrate(at: Any) -> tuple[Any, Any]:
            k = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 2)
            s = at - t[k]
            slope = (a[k + 1] - a[k]) / h[k]
            v = v_knots[k] + s * (a[k] + s * slope / 2)
            return v, u_knots[k] + s * (v_knots[k] + s * (a[k] / 2 + s * slope / 6))

        v, u = integrate(time)
        if t[0] < 0:  # The base is at rest at time 0, whatever the record contains before it.
            v0, u0 = integrate(0.0)
            v, u = v - v0, u - u0 - v0 * time
        return np.array([u, v, self.evaluate(time)])


class Sampled(Polyline):
    """Piecewise linear signal through samples, which must cover the run."""

    start_advice: ClassVar[str] = "a record that begins at 0 s"  # for one that begins later
    is_sampled: ClassVar[bool] = True

    def words(self) -> str:
        """Return a phrase."""
        return f"a {self.kind.replace('_', ' ')} of {self._quantity}"

    def covers(self, duration: float) -> bool:
        """Return whether the signal covers a run from 0 to its duration [s], to within rounding."""
        slack = ROUNDING * duration
        times, _ = self.polyline()
        return bool(times[0] <= slack and times[-1] >= duration - slack)

    def evaluate(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the values at the given times [s]."""
        t = np.asarray(time, dtype=float)
        times, values = self.polyline()
        near = np.clip(t, times[0], times[-1])  # The last time may differ from the end of the run by rounding.
        t = np.where(np.abs(t - near) <= ROUNDING * times[-1], near, t)
        return np.asarray(np.interp(t, times, values, left=0.0, right=0.0))

    @property
    def where(self) -> tuple[str, ...]:
        """Field that determines the length, for messages."""
        return ("duration",)


def _with_unit_of_amplitude(values: dict[str, Any], units: tuple[Unit, ...]) -> dict[str, Any]:
    """Return the fields of a signal with the number of its amplitude, and its unit as that of the signal."""
    if "amplitude" not in values:
        return values
    with at("amplitude"):
        number, unit = parse(values["amplitude"], units)
    if unit is not None and values.get("unit") not in (None, unit):
        raise Hint(f"the amplitude is in {unit}", "leave unit out", ["unit"])
    return Given.read_from(values, {**values, "amplitude": number, **({} if unit is None else {"unit": unit})})


def as_several(value: object) -> Any:
    """Return a tuple; a single value becomes a tuple of one, None an empty tuple."""
    if value is None:
        return ()
    return tuple(value) if isinstance(value, (list, tuple)) else (value,)


def signals_in(*units: Unit) -> BeforeValidator:
    """Return a validator of one or several signals that reads their amplitudes in these units."""

    def validate(value: object) -> Any:
        signals, read = as_several(value), []
        # `placed` has better advice for a displacement.
        readable = (*units, "m") if units == ("m/s^2",) else units
        for index, signal in enumerate(signals):
            if isinstance(signal, dict):
                with at(index):
                    signal = _with_unit_of_amplitude(signal, readable)
            read.append(signal)
        return tuple(read)

    return BeforeValidator(validate)
