"""Values of a parameter one after the other, each from the state in which the one before ended."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import CaseError
from rattlebox.core import _core
from rattlebox.core._core import Status
from rattlebox.engines.batch import BlockOutput, run_block
from rattlebox.model.errors import Hint, nearest
from rattlebox.model.paths import place_of

from .axes import Axes, read_axes
from .blocks import Blocks
from .gather_variants import gather_values, gather_variants
from .grid import Grid
from .impact_work import Extra, ImpactWork, with_intervals
from .measures import MEASURES, check_names
from .runner import run_work
from .work import Values

if TYPE_CHECKING:
    import os

    import xarray

    from rattlebox.model.case import Case

Vector = NDArray[np.float64]
Members = NDArray[np.intp]

_STARTS = ("start", "velocity", "displacement")
_EARLIER = np.arange(1, 8) / 8  # parts of a cycle
_CLOSED = -1e-12  # part of the clearance, far above rounding


def follow(
    case: Case,
    path: Any,
    values: Any,
    *,
    cycles: tuple[int, int],
    ways: Sequence[str] = ("up",),
    turning: bool = False,
    measure: Sequence[str] = (),
    beside: Axes | None = None,
    samples: int | None = None,
    point: str | None = None,
    motion: bool = False,
    last: int = 0,
    workers: int | None = None,
    backend: Any = "threads",
    store: str | os.PathLike[str] | None = None,
    progress: bool | Callable[[int, int], object] = True,
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
        Its values.
    cycles
        Numbers of cycles of each value to skip and to evaluate.
    ways
        "up" runs the values as they stand, "down" from the last one to the first.
    turning
        Begin the second way where the first has ended, not as the case says.
    measure
        Names of measures (rb.MEASURES) over the cycles looked at.
    beside
        Axes as of `rb.sweep`, each variant of which is followed on its own: levels of the load, replicas.
    samples, point, motion, last
        As of `rb.sweep`: samples over the cycles looked at, the point that is watched, whether to keep its motion, how many
        of the last impacts to keep.
    workers, backend, store, progress
        As of `rb.sweep`. Ways and variants beside each other are independent work; with a store, a walk goes on from the
        last value that is there.

    Returns
    -------
    xarray.Dataset
        As of `rb.sweep`, over `direction`, what is beside, and the values as they stand. Times of impacts are counted from
        the cycle in which the value's run begins.

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
    axes: list[Any] = [*(beside if isinstance(beside, (list, tuple)) else [beside] if beside else []), {path: values}]
    work = ContinuationWork.along(
        case,
        read_axes(case, axes),
        measures=[measure] if isinstance(measure, str) else list(measure),
        cycles=cycles,
        samples=samples,
        point=point,
        motion=motion,
        last=last,
        ways=ways,
        turning=turning,
        intervals=True,
    )
    work.validate()
    return without_states(run_work(work, store=store, backend=backend, workers=workers, progress=progress))


def without_states(runs: xarray.Dataset) -> xarray.Dataset:
    """Return the results of a continuation without the states from which it resumes."""
    return runs.drop_dims("component").drop_vars("early")


@dataclass
class ContinuationWork(ImpactWork):
    """Variants that are followed along the last dimension of the grid, in the directions of the first one.

    Attributes
    ----------
    ways, turning
        As of `follow`.
    """

    ways: tuple[str, ...] = ("up",)
    turning: bool = False

    @classmethod
    def along(cls, case: Case, grid: Grid, *, ways: Sequence[str], turning: bool = False, **options: Any) -> Self:
        """Return the continuation along the last dimension of a grid.

        Parameters
        ----------
        case
            The case.
        grid
            Variants, once for each direction in the result.
        ways, turning
            Directions, see `follow`.
        **options
            Further attributes, see `ImpactWork`.
        """
        directions = "direction", np.array(ways), {"long_name": "direction"}
        both = Grid(
            ("direction", *grid.dims),
            (len(ways), *grid.shape),
            {path: column[None] for path, column in grid.columns.items()},
            {"direction": directions, **grid.coords()},
        )
        return cls(case, both, state=True, ways=tuple(ways), turning=turning, **options)

    @property
    def outputs(self) -> dict[str, tuple[Extra, str, dict[str, str]]]:
        """Those of a sweep, and when the state at the end was taken."""
        early = {"units": "1", "long_name": "cycles from the state to the end of the run"}
        return {**super().outputs, "early": ((), "float64", early)}

    def describe(self) -> dict[str, Any]:
        """What is computed besides the grid, in JSON's types."""
        return {"study": "follow", **super().describe(), "ways": list(self.ways), "turning": self.turning}

    def validate(self) -> None:
        """Refuse loads that do not repeat.

        Raises
        ------
        CaseError
            With what to try.
        """
        for name in self.measures:
            if name not in MEASURES:
                raise Hint(f"there is no measure {name!r} of a run that is followed", nearest(str(name), MEASURES))
        check_names(self.measures)
        along = (path for path, column in self.grid.columns.items() if column.shape[-1] > 1)
        for path in along:
            if place_of(self.case, path)[-1] in _STARTS:
                raise CaseError(
                    f"{path} is a start, which only the first value would have\n  try: it as an axis of a sweep"
                )
        period = np.asarray(self.output.period)
        for load in self.packed.loads:
            signal = load.signal
            repeats = False
            if isinstance(signal, _core.Harmonic):
                turns = np.asarray(signal.frequency) * period / (2 * np.pi)
                acts = np.equal(signal.start, 0) & np.isinf(signal.stop)
                repeats = bool(np.all(acts) and np.all(np.abs(turns - np.rint(turns)) < 1e-9))
            if not repeats:
                raise Hint(
                    "a load or motion does not repeat after a cycle of the first one, so no value can go on from another",
                    "harmonics that act for good, the slowest one first, the others at multiples of its frequency",
                )

    def way(self, index: int) -> str:
        """Return the direction of a variant."""
        return self.ways[index * len(self.ways) // self.size]

    def step(self, at: At | None, members: Members, cancelled: Callable[[], bool] | None) -> Values | None:
        """Run a variant of each of some walks.

        Parameters
        ----------
        at
            Where the walks are; None where they begin.
        members
            The variants.
        cancelled
            Asked some fifty times a second; True stops.

        Returns
        -------
        dict of str to array, or None
            What is found of them, state and early being those to go on from; None when it was stopped.
        """
        step = _Step(self, at, members, cancelled)
        found = step.run()
        if found is None:
            return None
        after = at or At(step.own(), np.zeros(len(members)))
        if "last_time" in found:
            found["last_time"] = found["last_time"] - (after.early * step.period)[:, None]
        finished = found["status"] == Status.finished
        after = At(np.where(finished[:, None], found["state"], after.state), np.where(finished, 0.0, after.early))
        closed = finished & step.closed(after.state)
        after = step.back(after, closed)
        return {**found, "state": after.state, "early": after.early}

    def chains(self, blocks: Blocks) -> list[list[int]]:
        """Return the numbers of the blocks of each walk, in the order in which they follow each other."""
        rows = np.arange(len(blocks)).reshape(len(self.ways), -1, blocks.counts[-1])
        walks = [row if way == "up" else row[:, ::-1] for way, row in zip(self.ways, rows, strict=True)]
        if self.turning:
            walks = [np.concatenate(walks, axis=1)]
        return [walk.tolist() for way in walks for walk in way]

    def order(self, start: int, stop: int) -> range:
        """Return variants of one walk in the order in which they follow each other."""
        return range(start, stop) if self.way(start) == "up" else range(stop - 1, start - 1, -1)

    def run(
        self,
        start: int,
        stop: int,
        *,
        threads: int = 1,
        cancelled: Callable[[], bool] | None = None,
        before: Values | None = None,
    ) -> Values | None:
        """Run variants of one walk.

        Parameters
        ----------
        start, stop
            Variants.
        threads
            Not used: each value needs the one before it.
        cancelled
            Asked some fifty times a second; True stops.
        before
            What was found of the variant before these; None where the walk begins.
        """
        at = None if before is None else At(before["state"][-1:], before["early"][-1:])
        found: dict[int, Values] = {}
        for index in self.order(start, stop):
            values = self.step(at, np.array([index]), cancelled)
            if values is None:
                return None
            at = At(values["state"], values["early"])
            found[index] = values
        return {name: np.concatenate([found[index][name] for index in range(start, stop)]) for name in self.outputs}


@dataclass
class At:
    """Where walks are: states, (walks, components), taken `early` cycles before a cycle ends, (walks,)."""

    state: Vector
    early: Vector


class _Step:
    """A variant of each of some walks, from where they are."""

    def __init__(
        self, work: ContinuationWork, at: At | None, members: Members, cancelled: Callable[[], bool] | None
    ) -> None:
        self._cancelled, self._count = cancelled, len(members)
        shape, output = work.grid.shape, work.output
        self._own = gather_variants(work.packed, shape, members)

        def each(number: Any) -> Any:
            return gather_values(number, shape, members)

        self.output = replace(output, shape=each(output.shape), start=each(output.start), period=each(output.period))
        self.period = np.asarray(self.output.period)
        self._packed = self._own if at is None else self._begun(at)

    def run(self) -> dict[str, NDArray[Any]] | None:
        """Return what is found; None when it was stopped."""
        return self._found(self._packed, self.output, self._count)

    def _found(self, packed: _core.Problem, output: BlockOutput, count: int) -> dict[str, NDArray[Any]] | None:
        found = run_block(
            packed,
            (count,),
            0,
            count,
            output,
            progress=lambda _: not (self._cancelled and self._cancelled()),
        )
        return None if found is None else with_intervals(found, output)

    def _begun(self, at: At) -> _core.Problem:
        """What the core runs from where the walks are."""
        q, p, _, _ = self._parts(at.state)
        dampers = [
            damper.replace(position=np.clip(np.maximum.accumulate(place, axis=0), *walls), velocity=speed)
            for damper, place, speed, walls in self._rows(at.state)
        ]
        begun = self._own.replace(mode_displacement=q, mode_velocity=p, dampers=dampers)
        if not at.early.any():
            return begun
        wait = at.early * self.period
        loads = [load.replace(signal=_earlier(load.signal, wait)) for load in begun.loads]
        settings = begun.settings.replace(duration=begun.settings.duration + wait)
        self.output = replace(self.output, start=self.output.start + wait)
        return begun.replace(loads=loads, settings=settings)

    def own(self) -> Vector:
        """Return the states that the case gives."""
        packed = self._own
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

    def _rows(self, state: Vector) -> Iterator[tuple[_core.Damper, Vector, Vector, tuple[Vector, Vector]]]:
        """Each damper with places and velocities of its balls, (balls, walks), and its walls."""
        q, _, place, speed = self._parts(state)
        first = 0
        for damper in self._own.dampers:
            balls = slice(first, first := first + len(damper.mass))
            centre = np.sum(damper.shape * q, axis=0)
            half = 0.5 * np.asarray(damper.clearance)
            yield damper, place[balls], speed[balls], (centre - half, centre + half)

    def _parts(self, state: Vector) -> tuple[Vector, Vector, Vector, Vector]:
        """Displacements and velocities of modes, places and velocities of balls, each (components, walks)."""
        modes = len(self._own.mode_decay)
        rows = np.ascontiguousarray(state.T)
        place, speed = np.split(rows[2 * modes :], 2)
        parts = rows[0 : 2 * modes : 2], rows[1 : 2 * modes : 2], place, speed
        q, p, place, speed = map(np.ascontiguousarray, parts)
        return q, p, place, speed

    def closed(self, state: Vector) -> NDArray[np.bool_]:
        """Tell of each walk whether a soft contact is closed."""
        found = np.zeros(self._count, bool)
        if self._own.settings.method is not _core.Method.newton:
            for _, place, _, (left, right) in self._rows(state):
                row = np.concatenate([left[None], place, right[None]])
                found |= (np.diff(row, axis=0) < _CLOSED * (right - left)).any(axis=0)
        return found

    def back(self, end: At, closed: NDArray[np.bool_]) -> At:
        """Return states at an earlier moment, at which all contacts are open; or those at the end, where there is none.

        Parameters
        ----------
        end
            States at the end.
        closed
            For which an earlier moment is needed, (walks,).
        """
        settings, waiting = self._packed.settings, closed
        bare = replace(self.output, measures=(), batched=(), start=0.0, samples=2, motion=False, last=0)
        for early in _EARLIER:
            if not waiting.any():
                break
            sooner = self._packed.replace(settings=settings.replace(duration=settings.duration - early * self.period))
            members = np.flatnonzero(waiting)
            shape, period = (gather_values(part, (self._count,), members) for part in (self.output.shape, self.period))
            there = gather_variants(sooner, (self._count,), members)
            found = self._found(there, replace(bare, shape=shape, period=period), len(members))
            if found is None:
                break
            state = end.state.copy()
            state[members] = found["state"]
            taken = waiting & ~self.closed(state)
            taken[members] &= found["status"] == Status.finished
            end = At(np.where(taken[:, None], state, end.state), np.where(taken, early, end.early))
            waiting = waiting & ~taken
        return end


def _earlier(signal: _core.HalfSine | _core.Harmonic | _core.Record, wait: Vector) -> _core.Harmonic:
    """A harmonic as it is seen when time begins earlier."""
    if not isinstance(signal, _core.Harmonic):
        raise TypeError("a load that does not repeat does not begin earlier")
    return signal.replace(phase=signal.phase - signal.frequency * wait)
