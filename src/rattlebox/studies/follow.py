"""Values of a parameter one after the other, each from the state in which the one before ended."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.engines.batch import Look, run_block
from rattlebox.engines.pack import Packed
from rattlebox.engines.status import STATUSES
from rattlebox.model.errors import CaseError, Hint, nearest
from rattlebox.model.paths import place_of

from .axes import Axes, Design
from .bar import telling
from .blocks import Blocks
from .measures import MEASURES
from .runner import Stopped, cores
from .store import Memory, Plan
from .task import SweepTask

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case

Vector = NDArray[np.float64]
Values = Mapping[str, NDArray[Any]]

_FINISHED = [name for name, _ in STATUSES].index("finished")
_STARTS = ("start", "velocity", "displacement")
_EARLIER = np.arange(1, 8) / 8  # parts of a cycle
_CLOSED = -1e-12  # part of the clearance, far above rounding


def follow(
    case: Case,
    path: Any,
    values: Any,
    *,
    cycles: tuple[int, int],
    measure: Sequence[str] = (),
    beside: Axes | None = None,
    samples: int | None = None,
    point: str | None = None,
    motion: bool = False,
    last: int = 0,
    threads: int | None = None,
    progress: bool | Callable[[int, int], object] | None = None,
) -> xarray.Dataset:
    """Run a case for one value of a parameter after another, each from the state in which the one before ended.

    So a slow sweep stays on its attractor until that is gone, as an experiment does. The load goes on without a break: each
    value lasts whole cycles. The first one starts as the case says. A value whose run does not finish leaves the state as
    it was.

    Parameters
    ----------
    case
        The case, under harmonic loads or motions that repeat after a cycle of the first one.
    path
        What varies: a path, or a tuple of paths that vary together, as an axis of `rb.sweep`.
    values
        Its values, in the order in which they are run.
    cycles
        How many cycles of each value to skip, and how many to look at.
    measure
        Names of measures (rb.MEASURES) over the cycles looked at.
    beside
        Axes as of `rb.sweep`, each variant of which is followed on its own: levels of the load, replicas.
    samples, point, motion, last
        As of `rb.sweep`: samples over the cycles looked at, the point that is watched, whether to keep its motion, how many
        of the last impacts to keep.
    threads
        Threads that share the variants beside each other. Results do not depend on it, to the last bit.
    progress
        True or False for a bar, or a function of the numbers of values done and in all; default a bar on a terminal.

    Returns
    -------
    xarray.Dataset
        As of `rb.sweep`, the dimension of `path` first. Times of impacts are counted from the cycle in which the value's
        run begins.

    Raises
    ------
    CaseError
        When an axis or a measure does not fit the case, or the loads do not repeat after a cycle.
    Stopped
        After Ctrl-C.

    Notes
    -----
    No run starts inside a soft contact that is closed. Where the last cycle ends so, the state is taken an eighth of a cycle
    earlier, or two, until all contacts are open, and the next value starts in that phase of the load. Where no such moment
    is found, balls are put to the wall that they touch.
    """
    axes: list[Any] = [{path: values}, *(beside if isinstance(beside, (list, tuple)) else [beside] if beside else [])]
    paths = path if isinstance(path, tuple) else (path,)
    for name in paths:
        if isinstance(name, str) and place_of(case, name)[-1] in _STARTS:
            raise CaseError(
                f"{name} is a start, which only the first value would have\n  try: it as an axis of rb.sweep"
            )
    walk = _Walk(
        SweepTask(
            case,
            Design.of(case, axes),
            measures=_named(measure),
            cycles=whole_cycles(cycles),
            samples=samples,
            point=point,
            motion=motion,
            last=last,
            state=True,
        ),
        threads or cores(),
    )
    design, task = walk.task.design, walk.task
    outputs = {name: output for name, output in task.outputs.items() if name != "state"}
    plan = Plan(design.dims, design.shape, outputs, design.coords(), {**task.describe(), "design": design.describe()})
    kept = Memory(plan, Blocks.of(design.shape, walk.lanes))
    done = 0
    try:
        with telling(progress, walk.values, what="values") as tell:
            for found in walk.steps():
                kept.write(done, found)
                done += 1
                tell(done)
    except KeyboardInterrupt:
        raise Stopped(f"stopped after {done} of {walk.values} values, which are lost") from None
    return kept.result()


def _named(measure: Sequence[str]) -> list[str]:
    names = [measure] if isinstance(measure, str) else list(measure)
    for name in names:
        if name not in MEASURES:
            raise Hint(f"there is no measure {name!r} of a run that is followed", nearest(str(name), MEASURES))
    return names


def whole_cycles(cycles: Any) -> tuple[int, int]:
    """Return how many cycles to skip and to look at.

    Raises
    ------
    Hint
        When they are no two whole numbers, or there is nothing to look at.
    """
    try:
        skip, look = (operator.index(number) for number in cycles)
    except (TypeError, ValueError):
        skip = look = -1
    if skip < 0 or look < 1:
        raise Hint(f"cycles = {cycles!r}: whole numbers of cycles to skip and to look at are needed", "(200, 50)")
    return skip, look


@dataclass
class _Lanes:
    """Where the variants beside each other are: a state each, (n, components), taken `early` cycles before a cycle ends."""

    state: Vector
    early: Vector


class _Walk:
    """Runs one value after the other; the variants beside each other are lanes."""

    def __init__(self, task: SweepTask, threads: int) -> None:
        self.task, self.threads = task, threads
        self.values, *beside = task.design.shape
        self.beside = tuple(beside)
        self.lanes = task.size // self.values
        self._refuse_what_does_not_repeat()

    @cached_property
    def period(self) -> Vector:
        """Length of a cycle [s], broadcastable to the grid."""
        return np.asarray(self.task.look.period, dtype=float)

    def _refuse_what_does_not_repeat(self) -> None:
        for load in self.task.packed["loads"]:
            forever = load["kind"] == "harmonic" and np.all(load["start"] == 0) and np.all(np.isinf(load["stop"]))
            if forever:
                turns = np.asarray(load["frequency"]) * self.period / (2 * np.pi)
                forever = np.all(np.abs(turns - np.rint(turns)) < 1e-9)
            if not forever:
                raise Hint(
                    "a load or motion does not repeat after a cycle of the first one, so no value can go on from another",
                    "harmonics that act for good, the slowest one first, the others at multiples of its frequency",
                )

    def steps(self) -> Iterator[Values]:
        """Give the results of one value after the other."""
        at: _Lanes | None = None
        for value in range(self.values):
            packed, look = self._begun(at, value)
            first = value * self.lanes
            found = dict(self._run(packed, look, first, first + self.lanes))
            ended = found["status"] == _FINISHED
            end = _Lanes(found["state"].copy(), np.zeros(self.lanes))
            for lane in np.flatnonzero(ended & self._closed(end.state, value)):
                self._back(end, int(lane), packed, look, value)
            if at is None:
                at = _Lanes(self._own(value), np.zeros(self.lanes))
            if "last_time" in found:
                found["last_time"] = found["last_time"] - (at.early * self._number(self.period, value))[:, None]
            at.state[ended], at.early[ended] = end.state[ended], end.early[ended]
            yield found

    def _run(self, packed: Packed, look: Look, start: int, stop: int) -> Values:
        found = run_block(packed, self.task.design.shape, start, stop, look, threads=self.threads)
        assert found is not None  # nothing asks it to stop
        return found

    def _number(self, number: Any, value: int) -> Vector:
        """What lanes have of a packed number at a value, (lanes,)."""
        lanes: Vector = np.broadcast_to(number, self.task.design.shape)[value].reshape(self.lanes)
        return lanes

    def _vector(self, vector: Any, value: int) -> Vector:
        """What lanes have of a packed vector at a value, (components, lanes)."""
        rows = np.broadcast_to(vector, (len(vector), *self.task.design.shape))
        return rows[:, value].reshape(len(vector), self.lanes)

    def _column(self, rows: Vector) -> Vector:
        """Lanes of a vector, (components, lanes), as the core reads them."""
        return np.ascontiguousarray(rows).reshape(len(rows), 1, *self.beside)

    def _begun(self, at: _Lanes | None, value: int) -> tuple[Packed, Look]:
        """What the core runs for a value from where the lanes are."""
        packed, look = self.task.packed, self.task.look
        if at is None:
            return packed, look
        q, p, _, _ = self._parts(at.state)
        dampers = [
            {
                **damper,
                "position": self._column(np.clip(np.maximum.accumulate(place), *walls)),
                "velocity": self._column(speed),
            }
            for damper, place, speed, walls in self._rows(at.state, value)
        ]
        begun = {
            **packed,
            "mode_displacement": self._column(q),
            "mode_velocity": self._column(p),
            "dampers": dampers,
        }
        if not at.early.any():
            return begun, look
        wait = at.early.reshape(1, *self.beside) * self.period
        loads = [{**load, "phase": load["phase"] - load["frequency"] * wait} for load in packed["loads"]]
        settings = {**packed["settings"], "duration": packed["settings"]["duration"] + wait}
        return {**begun, "loads": loads, "settings": settings}, replace(look, start=look.start + wait)

    def _own(self, value: int) -> Vector:
        """The states that the case gives to the lanes."""
        packed, modes = self.task.packed, len(self.task.packed["mode_decay"])
        q, p = (self._vector(packed[name], value) for name in ("mode_displacement", "mode_velocity"))
        place, speed = (
            np.concatenate([self._vector(d[name], value) for d in packed["dampers"]] or [q[:0]])
            for name in ("position", "velocity")
        )
        return np.concatenate([np.stack([q, p], axis=1).reshape(2 * modes, self.lanes), place, speed]).T

    def _rows(
        self, state: Vector, value: int, lanes: slice = slice(None)
    ) -> Iterator[tuple[Packed, Vector, Vector, Vector]]:
        """Each damper with places and velocities of its balls, (n, lanes), and its walls, (2, lanes)."""
        q, _, place, speed = self._parts(state)
        first = 0
        for damper in self.task.packed["dampers"]:
            balls = slice(first, first := first + len(damper["mass"]))
            centre = np.sum(self._vector(damper["shape"], value)[:, lanes] * q, axis=0)
            half = 0.5 * self._number(damper["clearance"], value)[lanes]
            yield damper, place[balls], speed[balls], np.stack([centre - half, centre + half])

    def _parts(self, state: Vector) -> tuple[Vector, Vector, Vector, Vector]:
        """Displacements and velocities of modes, places and velocities of balls, (n, lanes) each."""
        rows, modes = state.T, len(self.task.packed["mode_decay"])
        q, p, (place, speed) = rows[0 : 2 * modes : 2], rows[1 : 2 * modes : 2], np.split(rows[2 * modes :], 2)
        return q, p, place, speed

    def _closed(self, state: Vector, value: int, lanes: slice = slice(None)) -> NDArray[np.bool_]:
        """Lanes with a soft contact that is closed."""
        closed = np.zeros(len(state), dtype=bool)
        if self.task.packed["settings"]["method"] != "newton":
            for _, place, _, (left, right) in self._rows(state, value, lanes):
                room = np.diff(np.stack([left, *place, right]), axis=0)
                closed |= (room < _CLOSED * (right - left)).any(axis=0)
        return closed

    def _back(self, end: _Lanes, lane: int, packed: Packed, look: Look, value: int) -> None:
        """Take the state of a lane at an earlier moment, at which all contacts are open."""
        settings, index = packed["settings"], value * self.lanes + lane
        bare = replace(look, measures=(), start=0.0, samples=2, motion=False, last=0)
        for early in _EARLIER:
            duration = np.asarray(settings["duration"] - early * self.period)
            sooner = {**packed, "settings": {**settings, "duration": duration}}
            found = self._run(sooner, bare, index, index + 1)
            state = found["state"]
            if found["status"][0] == _FINISHED and not self._closed(state, value, slice(lane, lane + 1))[0]:
                end.state[lane], end.early[lane] = state[0], early
                return
