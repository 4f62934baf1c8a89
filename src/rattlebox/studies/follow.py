"""Values of a parameter one after the other, each from the state in which the one before ended."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from rattlebox.engines.batch import Look, run_block
from rattlebox.engines.pack import Packed
from rattlebox.engines.status import STATUSES
from rattlebox.model.errors import CaseError, Hint, nearest
from rattlebox.model.paths import place_of

from .axes import Axes, Design
from .blocks import Blocks
from .measures import MEASURES
from .runner import run_task
from .task import Extra, SweepTask

if TYPE_CHECKING:
    import os

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
    ways: Sequence[str] = ("up",),
    turning: bool = False,
    measure: Sequence[str] = (),
    beside: Axes | None = None,
    samples: int | None = None,
    point: str | None = None,
    motion: bool = False,
    last: int = 0,
    threads: int | None = None,
    on: Any = None,
    store: str | os.PathLike[str] | None = None,
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
        Its values.
    cycles
        How many cycles of each value to skip, and how many to look at.
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
    threads, on, store, progress
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
    paths = path if isinstance(path, tuple) else (path,)
    for name in paths:
        if isinstance(name, str) and place_of(case, name)[-1] in _STARTS:
            raise CaseError(
                f"{name} is a start, which only the first value would have\n  try: it as an axis of rb.sweep"
            )
    task = FollowTask(
        case,
        _there_and_back(Design.of(case, axes), ways),
        measures=_named(measure),
        cycles=whole_cycles(cycles),
        samples=samples,
        point=point,
        motion=motion,
        last=last,
        state=True,
        ways=tuple(ways),
        turning=turning,
    )
    task.check()
    found = run_task(
        task, design=task.design, coords=task.coords(), store=store, on=on, threads=threads, progress=progress
    )
    return found.drop_dims("component").drop_vars("early")


def _there_and_back(design: Design, ways: Sequence[str]) -> Design:
    """The same variants, once for each direction."""
    directions = "direction", np.array(ways), {"long_name": "direction"}
    return Design(
        ("direction", *design.dims),
        (len(ways), *design.shape),
        {path: column[None] for path, column in design.columns.items()},
        {"direction": directions, **design.coords()},
    )


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
class FollowTask(SweepTask):
    """Variants that are followed along the last dimension of the design, in the directions of the first one.

    Attributes
    ----------
    ways, turning
        As of `follow`.
    """

    ways: tuple[str, ...] = ("up",)
    turning: bool = False
    no_card: ClassVar[str] = "variants that go on from each other"

    @property
    def outputs(self) -> dict[str, tuple[Extra, str, dict[str, str]]]:
        """Those of a sweep, and when the state at the end was taken."""
        early = {"units": "1", "long_name": "cycles from the state to the end of the run"}
        return {**super().outputs, "early": ((), "float64", early)}

    def describe(self) -> dict[str, Any]:
        """What is computed besides the design, in JSON's types."""
        return {"study": "follow", **super().describe(), "ways": list(self.ways), "turning": self.turning}

    def check(self) -> None:
        """Refuse loads that do not repeat.

        Raises
        ------
        CaseError
            With what to try.
        """
        period = np.asarray(self.look.period)
        for load in self.packed["loads"]:
            forever = load["kind"] == "harmonic" and np.all(load["start"] == 0) and np.all(np.isinf(load["stop"]))
            if forever:
                turns = np.asarray(load["frequency"]) * period / (2 * np.pi)
                forever = np.all(np.abs(turns - np.rint(turns)) < 1e-9)
            if not forever:
                raise Hint(
                    "a load or motion does not repeat after a cycle of the first one, so no value can go on from another",
                    "harmonics that act for good, the slowest one first, the others at multiples of its frequency",
                )

    # ---- walks

    def chains(self, blocks: Blocks) -> list[list[int]]:
        """Return the numbers of the blocks of each walk, in the order in which they follow each other."""
        rows = np.arange(len(blocks)).reshape(len(self.ways), -1, blocks.counts[-1])
        walks = [row if way == "up" else row[:, ::-1] for way, row in zip(self.ways, rows, strict=True)]
        if self.turning:
            walks = [np.concatenate(walks, axis=1)]
        return [walk.tolist() for way in walks for walk in way]

    def order(self, start: int, stop: int) -> range:
        """Return variants of one walk in the order in which they follow each other."""
        way = self.ways[start * len(self.ways) // self.size]
        return range(start, stop) if way == "up" else range(stop - 1, start - 1, -1)

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
        at = None if before is None else _At(before["state"][-1], float(before["early"][-1]))
        found: dict[int, Values] = {}
        for index in self.order(start, stop):
            values = self._step(at, index, cancelled)
            if values is None:
                return None
            at = _At(values["state"][0], float(values["early"][0]))
            found[index] = values
        return {name: np.concatenate([found[index][name] for index in range(start, stop)]) for name in self.outputs}

    def _step(self, at: _At | None, index: int, cancelled: Callable[[], bool] | None) -> Values | None:
        """What is found of one variant that begins where another one has ended; state and early are those to go on from."""
        packed, look = self._begun(at, index)
        found = self._alone(packed, look, index, cancelled)
        if found is None:
            return None
        after = at or _At(self._own(index), 0.0)
        if "last_time" in found:
            found["last_time"] = found["last_time"] - after.early * self._number(self.look.period, index)
        if found["status"][0] == _FINISHED:
            after = _At(found["state"][0], 0.0)
            if self._closed(after.state, index):
                after = self._back(after, packed, look, index, cancelled)
        return {**found, "state": after.state[None], "early": np.array([after.early])}

    def _alone(
        self, packed: Packed, look: Look, index: int, cancelled: Callable[[], bool] | None
    ) -> dict[str, NDArray[Any]] | None:
        found = run_block(
            packed, self.design.shape, index, index + 1, look, progress=lambda _: not (cancelled and cancelled())
        )
        return None if found is None else dict(found)

    def _number(self, number: Any, index: int) -> float:
        """What a variant has of a packed number."""
        return float(np.broadcast_to(number, self.design.shape).flat[index])

    def _vector(self, vector: Any, index: int) -> Vector:
        """What a variant has of a packed vector, (components,)."""
        return np.array([self._number(component, index) for component in vector])

    def _column(self, values: Vector) -> Vector:
        """A vector as the core reads it."""
        return np.ascontiguousarray(values).reshape(-1, *(1,) * len(self.design.shape))

    def _begun(self, at: _At | None, index: int) -> tuple[Packed, Look]:
        """What the core runs of a variant from where the walk is."""
        packed, look = self.packed, self.look
        if at is None:
            return packed, look
        q, p, _, _ = self._parts(at.state)
        dampers = [
            {
                **damper,
                "position": self._column(np.clip(np.maximum.accumulate(place), *walls)),
                "velocity": self._column(speed),
            }
            for damper, place, speed, walls in self._rows(at.state, index)
        ]
        begun = {
            **packed,
            "mode_displacement": self._column(q),
            "mode_velocity": self._column(p),
            "dampers": dampers,
        }
        if not at.early:
            return begun, look
        wait = at.early * np.asarray(look.period)
        loads = [{**load, "phase": load["phase"] - load["frequency"] * wait} for load in packed["loads"]]
        settings = {**packed["settings"], "duration": packed["settings"]["duration"] + wait}
        return {**begun, "loads": loads, "settings": settings}, replace(look, start=look.start + wait)

    def _own(self, index: int) -> Vector:
        """The state that the case gives to a variant."""
        packed = self.packed
        q, p = (self._vector(packed[name], index) for name in ("mode_displacement", "mode_velocity"))
        place, speed = (
            np.concatenate([self._vector(damper[name], index) for damper in packed["dampers"]] or [q[:0]])
            for name in ("position", "velocity")
        )
        return np.concatenate([np.stack([q, p], axis=1).ravel(), place, speed])

    def _rows(self, state: Vector, index: int) -> Iterator[tuple[Packed, Vector, Vector, tuple[float, float]]]:
        """Each damper with places and velocities of its balls, and its walls."""
        q, _, place, speed = self._parts(state)
        first = 0
        for damper in self.packed["dampers"]:
            balls = slice(first, first := first + len(damper["mass"]))
            centre = float(self._vector(damper["shape"], index) @ q)
            half = 0.5 * self._number(damper["clearance"], index)
            yield damper, place[balls], speed[balls], (centre - half, centre + half)

    def _parts(self, state: Vector) -> tuple[Vector, Vector, Vector, Vector]:
        """Displacements and velocities of modes, places and velocities of balls."""
        modes = len(self.packed["mode_decay"])
        place, speed = np.split(state[2 * modes :], 2)
        return state[0 : 2 * modes : 2], state[1 : 2 * modes : 2], place, speed

    def _closed(self, state: Vector, index: int) -> bool:
        """Tell whether a soft contact is closed."""
        return self.packed["settings"]["method"] != "newton" and any(
            bool((np.diff([left, *place, right]) < _CLOSED * (right - left)).any())
            for _, place, _, (left, right) in self._rows(state, index)
        )

    def _back(self, end: _At, packed: Packed, look: Look, index: int, cancelled: Callable[[], bool] | None) -> _At:
        """The state at an earlier moment, at which all contacts are open; or that at the end, where there is none."""
        settings = packed["settings"]
        bare = replace(look, measures=(), start=0.0, samples=2, motion=False, last=0)
        for early in _EARLIER:
            duration = np.asarray(settings["duration"] - early * np.asarray(look.period))
            sooner = {**packed, "settings": {**settings, "duration": duration}}
            found = self._alone(sooner, bare, index, cancelled)
            if found and found["status"][0] == _FINISHED and not self._closed(found["state"][0], index):
                return _At(found["state"][0], float(early))
        return end


@dataclass
class _At:
    """Where a walk is: a state, (components,), taken `early` cycles before a cycle ends."""

    state: Vector
    early: float
