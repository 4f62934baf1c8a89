"""What loads and motions in time share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, WithJsonSchema, field_validator, model_validator

from .base import Part
from .elementwise import Vector
from .errors import Hint, at
from .space import Direction
from .units import factor_of, parse

Unit = Literal["N", "m/s^2", "m"]
UNITS: tuple[Unit, ...] = ("N", "m/s^2", "m")
UNIT_NAMES = {"N": "a force", "m/s^2": "an acceleration", "m": "a displacement"}


class _Amplitude(float):
    """A number that remembers which unit it was given in."""

    unit: str | None = None


def _amplitude(value: Any) -> _Amplitude:
    number, unit = parse(value, UNITS)
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

    field_names: ClassVar[tuple[str, ...]] = ("load", "loads", "base", "motion")
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
    def _unit_of_amplitude(cls, values: Any) -> Any:
        if isinstance(values, dict) and "amplitude" in values:
            try:
                unit = parse(values["amplitude"], UNITS)[1]
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
            wanted = " or ".join(f"{UNIT_NAMES[a]} ({a})" for a in allowed)
            where, amount = ("unit", "") if self.kind == "record" else ("amplitude", "1 ")
            raise Hint(f"{place} needs {wanted}, not {UNIT_NAMES[unit]}", f'{where} = "{amount}{allowed[0]}"', [where])
        return self if self.unit == unit else self.model_copy(update={"unit": unit})

    def evaluate(self, time: Any) -> NDArray[np.float64]:
        """Return the values at the given times [s], in the signal's unit, same shape."""
        raise NotImplementedError

    def coefficients(self) -> dict[str, Any]:
        """Return the coefficients of the core's signal of this kind, by name."""
        raise NotImplementedError


ROUNDING = 1e-9
"""Of the duration: what times of a record may miss by where they were added up."""


@dataclass(frozen=True, eq=False)
class Points:
    """Times [s] and values of a polyline, computed once and not compared."""

    times: Vector
    values: Vector


class Polyline(Signal):
    """A signal of straight lines between points, which the core takes as it does a record; zero outside them.

    Two points at one time make a jump.
    """

    elementwise: ClassVar[bool] = False

    def polyline(self) -> tuple[Vector, Vector]:
        """Return times [s], in order, and values, (n,) each."""
        raise NotImplementedError

    def evaluate(self, time: Any) -> NDArray[np.float64]:
        """Return the values at the given times [s]; at a jump the later one."""
        t = np.asarray(time, dtype=float)
        times, values = self.polyline()
        after = np.clip(np.searchsorted(times, t, side="right"), 1, times.size - 1)
        span = times[after] - times[after - 1]
        share = np.where(span > 0, (t - times[after - 1]) / np.where(span > 0, span, 1.0), 1.0)
        inside = (t >= times[0]) & (t <= times[-1])
        return np.where(inside, values[after - 1] + share * (values[after] - values[after - 1]), 0.0)

    def coefficients(self) -> dict[str, Any]:
        """Return what the core reads."""
        times, values = self.polyline()
        return {"kind": "record", "times": times, "values": values}


class Sampled(Polyline):
    """A signal that was sampled at evenly spaced times, and must cover the run."""

    def covers(self, duration: float) -> bool:
        """Return whether it lasts from 0 to the end of a run [s]; times that were added up may miss both by rounding."""
        slack = ROUNDING * duration
        times, _ = self.polyline()
        return bool(times[0] <= slack and times[-1] >= duration - slack)

    def evaluate(self, time: Any) -> NDArray[np.float64]:
        """Return the values at the given times [s]."""
        t = np.asarray(time, dtype=float)
        times, values = self.polyline()
        near = np.clip(t, times[0], times[-1])  # the end of a run that it covers but for rounding
        t = np.where(np.abs(t - near) <= ROUNDING * times[-1], near, t)
        return np.asarray(np.interp(t, times, values, left=0.0, right=0.0))

    @property
    def where(self) -> tuple[str, ...]:
        """The field that sets its length, for messages."""
        return ("duration",)


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
