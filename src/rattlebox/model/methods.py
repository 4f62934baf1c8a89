"""How a case is computed, and what comes out."""

from __future__ import annotations

import operator
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema, field_validator, model_validator

from .base import Part
from .elementwise import Vector
from .errors import Hint, at
from .restitutions import AnyRestitution
from .units import Number, PositiveFrequency, PositiveTime, Whole, numbers, parse


class EventDriven(Part):
    """Exact flights, contacts integrated with error control. The method to use.

    Parameters
    ----------
    tolerance
        Relative error of one step through a contact.
    max_events
        Budget of flights and contacts; a run that spends it ends with a status.
    collocation
        Solve lone Hertz contacts whole; False integrates all of them step by step (slower, for comparison).
    """

    held_as: ClassVar[tuple[str, ...]] = ("method",)
    kind: Literal["event_driven"] = "event_driven"
    tolerance: Annotated[Number, Field(ge=1e-14, le=1e-3)] = 1e-12
    max_events: Annotated[Whole, Field(ge=1)] = 10_000_000
    collocation: bool = True


class TwoStep(Part):
    """Fixed steps, long in flight and short in contact, as in discrete-element programs. For comparison.

    Parameters
    ----------
    dt_flight, dt_contact
        Steps [s].
    inner
        "rk4": one Runge-Kutta step each; "dopri5": an adaptive solution of each with MATLAB's ode45 defaults.
    """

    held_as: ClassVar[tuple[str, ...]] = ("method",)
    kind: Literal["two_step"] = "two_step"
    dt_flight: PositiveTime = 5e-6
    dt_contact: PositiveTime = 3e-8
    inner: Literal["rk4", "dopri5"] = "rk4"


class Newton(Part):
    """Hard impacts without duration. For theory.

    Parameters
    ----------
    restitution
        A law or a number from 0 to 1; default the contact's own law.
    stick
        A contact whose next bounce would last less than this part of the shortest period sticks, and one that closes
        more slowly than this part of the largest speed so far of a ball in its cavity does not rebound.
    max_events
        Budget of flights and impacts.
    """

    held_as: ClassVar[tuple[str, ...]] = ("method",)
    kind: Literal["newton"] = "newton"
    restitution: AnyRestitution | None = None
    stick: Annotated[Number, Field(ge=0, le=0.1)] = 1e-6
    max_events: Annotated[Whole, Field(ge=1)] = 10_000_000


def _step(value: Any) -> Any:
    return value if value == "auto" else parse(value, ("s",))[0]


class Dem(Part):
    """Fixed steps of all particles in space. The method of particle dampers.

    Parameters
    ----------
    dt
        Step [s], or "auto". Either is shortened a little so that samples fall on steps. A step too long for any contact that
        is to be expected is refused.
    fraction
        With "auto": of the shortest contact and of the period of the fastest mode.
    threads
        How many at once; default as many as there are cores and enough particles for. The results do not depend on it, to
        the last bit.
    checkpoint
        How often the state is kept from which the run can go on, where a file for it is given: by the clock [s]; default ten
        minutes.
    checkpoint_every
        Instead: in simulated time [s].
    """

    held_as: ClassVar[tuple[str, ...]] = ("method",)
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("checkpoint", "checkpoint_every"),)
    kind: Literal["dem"] = "dem"
    dt: Annotated[
        Literal["auto"] | float,
        BeforeValidator(_step),
        WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}], "description": "step in s, or auto"}),
    ] = "auto"
    fraction: Annotated[Number, Field(gt=0, le=0.2)] = 0.025
    threads: Annotated[Whole, Field(ge=1)] | None = None
    checkpoint: PositiveTime | None = None
    checkpoint_every: PositiveTime | None = None

    @field_validator("dt")
    @classmethod
    def _forward(cls, dt: float | str) -> float | str:
        if isinstance(dt, float) and not dt > 0:
            raise Hint("must be greater than zero")
        return dt

    @model_validator(mode="after")
    def _one_clock(self) -> Dem:
        if self.checkpoint is not None and self.checkpoint_every is not None:
            raise Hint("give checkpoint or checkpoint_every, not both")
        return self


AnyMethod = Annotated[EventDriven | TwoStep | Newton | Dem, Field(discriminator="kind")]


USUAL_SNAPSHOTS = 101


def _times(value: Any) -> Any:
    if value is None:
        return None
    if isinstance(value, np.ndarray) and value.dtype.kind in "iuf":
        return tuple(np.unique(numbers(value)).tolist())
    times = set()
    for index, item in enumerate(np.asarray(value, dtype=object).ravel().tolist()):
        with at(index):
            times.add(parse(item, ("s",))[0])
    return tuple(sorted(times))


def _count_or_times(value: Any) -> Any:
    if isinstance(value, (bool, np.bool_, str, float, np.floating)):
        raise Hint("a number of snapshots is needed, or a list of times", "snapshots = 100")
    try:
        count = operator.index(value)
    except TypeError:
        return _times(value)
    if count < 2:
        raise Hint("two snapshots are the least: at 0 and at the end", "snapshots = 100")
    return count


class Output(Part):
    """At which times motion and energies are recorded; 0 and the end always are. Output does not change the run.

    Without a choice the times are such that pictures of the motion are true: evenly spaced, 2001 of them or 20 in each
    period of the fastest mode or harmonic (up to 100 001); 20 in each pulse; and, in runs of up to 200 000 events, begin,
    deepest overlap and end of every contact and the middle of the flights beside it. Spectra and the like need evenly spaced
    times: give a rate.

    Parameters
    ----------
    rate
        Samples per second [Hz].
    times
        Instead: the times themselves [s]; with particles in space evenly spaced, together with 0 and the end.
    snapshots
        Of particles in space: how many snapshots, evenly spaced from 0 to the end, go to the file that is given for them, or
        their times [s], up to the end; default 101. An empty list asks for none.
    """

    held_as: ClassVar[tuple[str, ...]] = ("output",)
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("rate", "times"),)
    rate: PositiveFrequency | None = None
    times: Annotated[tuple[float, ...] | None, BeforeValidator(_times)] = None
    snapshots: Annotated[int | tuple[float, ...] | None, BeforeValidator(_count_or_times)] = None

    @model_validator(mode="after")
    def _one_of_both(self) -> Output:
        if self.rate is not None and self.times is not None:
            raise Hint("give rate or times, not both")
        return self

    @field_validator("times", "snapshots")
    @classmethod
    def _not_before(cls, times: tuple[float, ...] | int | None) -> tuple[float, ...] | int | None:
        if isinstance(times, tuple) and times and times[0] < 0:
            raise Hint("output times must not be negative")
        return times

    @property
    def is_chosen(self) -> bool:
        """Whether the user has chosen the times."""
        return self.rate is not None or self.times is not None

    def sample_times(self, duration: float, fastest: float = 0.0) -> Vector:
        """Return the times for a run, (T,) [s]; without a choice the evenly spaced ones.

        Parameters
        ----------
        duration
            Of the run [s].
        fastest
            Highest frequency in it [Hz], which matters where the user has made no choice.
        """
        if self.times is not None:
            inside = [t for t in self.times if 0 < t < duration * (1 - 1e-12)]  # 8 x 0.1 may be a little less than 0.8
            return np.array([0.0, *inside, duration])
        if self.rate is None:
            return np.linspace(0.0, duration, 1 + int(np.clip(20 * duration * fastest, 2000, 100_000)))
        before = max(
            1, int(np.ceil(duration * self.rate - 1e-6))
        )  # 10 000 steps of 0.1 ms may be a little less than 1 s
        return np.append(np.arange(before) / self.rate, duration)

    def snapshot_times(self, duration: float) -> Vector:
        """Return the times of snapshots of a run, (n,) [s].

        Parameters
        ----------
        duration
            Of the run [s].
        """
        if isinstance(self.snapshots, tuple):
            return np.array(self.snapshots)
        return np.linspace(0.0, duration, self.snapshots or USUAL_SNAPSHOTS)
