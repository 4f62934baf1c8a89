"""Continuation of 1-D runs: each starts from the final state of the one before.

A slow sweep thus stays on its attractor until the attractor disappears, as in an experiment. The load continues without a
break: each variant lasts whole cycles. The first variant starts from the initial state of the case. A variant that does not
finish leaves the state unchanged.

No run starts inside a closed soft contact. If a contact is closed at the end of the last cycle, the state is taken one or
more eighths of a cycle earlier, when all contacts are open, and the next run starts at that phase of the load. If there is
no such time, balls are moved to the wall that they touch.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import CaseError
from rattlebox.core import _core
from rattlebox.core._core import Status
from rattlebox.engines.batch import BlockOutput, run_block
from rattlebox.model.errors import Hint, nearest
from rattlebox.model.paths import place_of
from rattlebox.studies.work.measures import MEASURES, OF_RUN, check_names, name_of, shortest_windows, with_intervals
from rattlebox.studies.work.variants import gather_values, gather_variants
from rattlebox.studies.work.work import Cancelled, Values, proceed_unless

if TYPE_CHECKING:
    from rattlebox.studies.work.variants import Variants

Vector = NDArray[np.float64]
Members = NDArray[np.intp]

_INITIAL_VALUES = ("start", "velocity", "displacement")
_LEADS = np.arange(1, 8) / 8
"""Fractions of a cycle by which the state may be taken before the end of a run."""

_CLOSED = -1e-12
"""Gap over the clearance below which a contact counts as closed; far above rounding."""


def check_variants(variants: Variants) -> None:
    """Raise if a measure or a parameter is not valid in a continuation."""
    known = [name for name in MEASURES if name not in OF_RUN]
    for name in variants.measures:
        if name not in known:
            raise Hint(f"there is no measure {name_of(name)!r} in a continuation", nearest(name_of(name), known))
    check_names(variants.measures)
    for path, column in variants.grid.columns.items():
        if column.shape[-1] > 1 and place_of(variants.case, path)[-1] in _INITIAL_VALUES:
            raise CaseError(f"{path} is an initial value, which affects only the first run", "an axis of a sweep")


def require_periodic(packed: _core.Problem, period: object) -> None:
    """Raise if a load or motion is not periodic with the first one."""
    for load in packed.loads:
        signal = load.signal
        repeats = False
        if isinstance(signal, _core.Harmonic):
            turns = np.asarray(signal.frequency) * np.asarray(period) / (2 * np.pi)
            acts = np.equal(signal.start, 0) & np.isinf(signal.stop)
            repeats = bool(np.all(acts) and np.all(np.abs(turns - np.rint(turns)) < 1e-9))
        if not repeats:
            raise Hint(
                "a load or motion is not periodic with the first one; a continuation requires periodic loads",
                "harmonics without start and stop, the slowest one first, the others at multiples of its frequency",
            )


class Batch(NamedTuple):
    """All variants of a continuation: the problem of the core, the shape of the grid and the outputs of each."""

    packed: _core.Problem
    shape: tuple[int, ...]
    output: BlockOutput


def follow(batch: Batch, numbers: range, before: Values | None, cancelled: Cancelled) -> dict[str, Any] | None:
    """Run variants of one chain in their order; see `ChainEngine.follow`."""
    states = None if before is None else _States(before["state"][-1:], before["lead"][-1:])
    results: dict[int, Values] = {}
    for index in numbers:
        values = _follow_one(batch, states, np.array([index]), cancelled)
        if values is None:
            return None
        states = _States(values["state"], values["lead"])
        results[index] = values
    rows = [results[index] for index in sorted(numbers)]
    return {name: np.concatenate([row[name] for row in rows]) for name in rows[0]}


def _follow_one(batch: Batch, before: _States | None, members: Members, cancelled: Cancelled) -> Values | None:
    """Run one variant of each chain."""
    step = _Step(batch, before, members, cancelled)
    values = step.run()
    if values is None:
        return None
    after = before or _States(step.initial_states(), np.zeros(len(members)))
    if "last_time" in values:
        values["last_time"] = values["last_time"] - (after.lead * step.period)[:, None]
    finished = values["status"] == Status.finished
    after = _States(np.where(finished[:, None], values["state"], after.state), np.where(finished, 0.0, after.lead))
    closed = finished & step.has_closed_contact(after.state)
    after = step.open_states(after, closed)
    return {**values, "state": after.state, "lead": after.lead}


@dataclass
class _States:
    """States of the chains, (chains, components), each taken `lead` cycles before the end of a cycle, (chains,)."""

    state: Vector
    lead: Vector


class _Step:
    """One variant of each chain, run from the states before it."""

    def __init__(self, batch: Batch, before: _States | None, members: Members, cancelled: Cancelled) -> None:
        self._cancelled, self._count = cancelled, len(members)
        shape, output = batch.shape, batch.output
        self._variants = gather_variants(batch.packed, shape, members)

        def each(number: Any) -> Any:
            return gather_values(number, shape, members) if np.size(number) else number

        names = ("shape", "participation", "residual_mass", "start", "period")
        self.output = replace(output, **{name: each(getattr(output, name)) for name in names})
        self.period = np.asarray(self.output.period)
        self._packed = self._variants if before is None else self._start_from(before)

    def run(self) -> dict[str, NDArray[Any]] | None:
        """Return the outputs; None if the work was cancelled."""
        return self._run(self._packed, self.output, self._count)

    def _run(self, packed: _core.Problem, output: BlockOutput, count: int) -> dict[str, NDArray[Any]] | None:
        values = run_block(
            packed,
            (count,),
            0,
            count,
            output,
            progress=proceed_unless(self._cancelled),
        )
        if values is None:
            return None
        return with_intervals(values, output, shortest_windows(packed, (count,), output))

    def _start_from(self, before: _States) -> _core.Problem:
        """Return the problem of the core with other initial states."""
        q, p, _, _ = self._split(before.state)
        dampers = [
            damper.replace(position=np.clip(np.maximum.accumulate(place, axis=0), *walls), velocity=speed)
            for damper, place, speed, walls in self._dampers(before.state)
        ]
        problem = self._variants.replace(mode_displacement=q, mode_velocity=p, dampers=dampers)
        if not before.lead.any():
            return problem
        # The state was taken before the end of a cycle: the load starts at that phase, and the run is longer by the rest.
        wait = before.lead * self.period
        loads = [load.replace(signal=_start_earlier(load.signal, wait)) for load in problem.loads]
        settings = problem.settings.replace(duration=problem.settings.duration + wait)
        self.output = replace(self.output, start=self.output.start + wait)
        return problem.replace(loads=loads, settings=settings)

    def initial_states(self) -> Vector:
        """Return the initial states of the variants, (chains, components)."""
        packed = self._variants
        q, p = packed.mode_displacement, packed.mode_velocity
        place, speed = (
            [np.broadcast_to(values, (len(values), self._count)) for values in parts]
            for parts in (
                [damper.position for damper in packed.dampers],
                [damper.velocity for damper in packed.dampers],
            )
        )
        modes = [np.broadcast_to(part, (self._count,)) for pair in zip(q, p, strict=True) for part in pair]
        return np.concatenate([np.reshape(modes, (-1, self._count)), *place, *speed]).T

    def _dampers(self, state: Vector) -> Iterator[tuple[_core.Damper, Vector, Vector, tuple[Vector, Vector]]]:
        """Yield each damper with positions and velocities of its balls, (balls, chains), and its walls."""
        q, _, place, speed = self._split(state)
        first = 0
        for damper in self._variants.dampers:
            balls = slice(first, first := first + len(damper.mass))
            centre = np.sum(damper.shape * q, axis=0)
            half = 0.5 * np.asarray(damper.clearance)
            yield damper, place[balls], speed[balls], (centre - half, centre + half)

    def _split(self, state: Vector) -> tuple[Vector, Vector, Vector, Vector]:
        """Return displacements and velocities of modes, positions and velocities of balls, each (components, chains)."""
        modes = len(self._variants.mode_decay)
        rows = np.ascontiguousarray(state.T)
        place, speed = np.split(rows[2 * modes :], 2)
        parts = rows[0 : 2 * modes : 2], rows[1 : 2 * modes : 2], place, speed
        q, p, place, speed = map(np.ascontiguousarray, parts)
        return q, p, place, speed

    def has_closed_contact(self, state: Vector) -> NDArray[np.bool_]:
        """Return whether each chain has a closed soft contact, (chains,)."""
        closed = np.zeros(self._count, bool)
        if self._variants.settings.method is not _core.Method.newton:
            for damper, place, _, (left, right) in self._dampers(state):
                if not len(damper.mass):  # a stop, at half of the clearance
                    closed |= left >= 0
                    continue
                row = np.concatenate([left[None], place, right[None]])
                closed |= (np.diff(row, axis=0) < _CLOSED * (right - left)).any(axis=0)
        return closed

    def open_states(self, end: _States, closed: NDArray[np.bool_]) -> _States:
        """Return states shortly before the end with all contacts open; the final states if there are none.

        `closed`: chains with a closed contact in the final state, (chains,).
        """
        settings, waiting = self._packed.settings, closed
        nothing: dict[str, Any] = {"participation": np.zeros(0), "residual_mass": 0.0, "measures": (), "batched": ()}
        only_state = replace(self.output, **nothing, start=0.0, samples=2, motion=False, last=0)
        # The end of a run cannot be moved back: run again to ever earlier times, only the chains that are still closed.
        for lead in _LEADS:
            if not waiting.any():
                break
            sooner = self._packed.replace(settings=settings.replace(duration=settings.duration - lead * self.period))
            members = np.flatnonzero(waiting)
            shape, period = (gather_values(part, (self._count,), members) for part in (self.output.shape, self.period))
            there = gather_variants(sooner, (self._count,), members)
            values = self._run(there, replace(only_state, shape=shape, period=period), len(members))
            if values is None:
                break
            state = end.state.copy()
            state[members] = values["state"]
            opened = waiting & ~self.has_closed_contact(state)
            opened[members] &= values["status"] == Status.finished
            end = _States(np.where(opened[:, None], state, end.state), np.where(opened, lead, end.lead))
            waiting = waiting & ~opened
        return end


def _start_earlier(signal: _core.HalfSine | _core.Harmonic | _core.Record, wait: Vector) -> _core.Harmonic:
    """Return a harmonic in a time that starts earlier [s]."""
    if not isinstance(signal, _core.Harmonic):
        raise TypeError("a load that is not harmonic cannot start earlier")
    return signal.replace(phase=signal.phase - signal.frequency * wait)
