"""Variants of cases with impact dampers, run in the core without storing trajectories."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.batch_means import shortest_window
from rattlebox.analysis.shaken import MIN_SAMPLES
from rattlebox.core import _core
from rattlebox.engines.batch import BlockOutput, run_block
from rattlebox.engines.simulate import simulate_many
from rattlebox.model.errors import Hint
from rattlebox.prepare.pack import Batch, pack_parts
from rattlebox.studies.work.case_work import CaseWork, Extra
from rattlebox.studies.work.measures import INTERVAL, MEASURES, interval_of, parts_needed
from rattlebox.studies.work.observed import Observed
from rattlebox.studies.work.work import Cancelled, Values, proceed_unless


@dataclass
class ImpactWork(CaseWork):
    """Variants of a case with impact dampers, run in the core without storing trajectories."""

    motion: bool = False
    last: int = 0
    state: bool = False

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_parts"}

    @property
    def block(self) -> int:
        """Preferred number of variants in a block: the square root of all, or 1 with functions of a Run."""
        return 1 if self.functions else math.isqrt(self.size)

    @cached_property
    def outputs(self) -> dict[str, tuple[Extra, str, dict[str, Any]]]:
        """Further dimensions, number type and attributes of each output."""
        found = dict(super().outputs)
        balls = self._balls
        if self.motion:
            time: Extra = (("instant", self.output.samples),)
            found["displacement"] = (time, "float64", {"units": self.units_of("m"), "long_name": "displacement"})
            found["velocity"] = (time, "float64", {"units": self.units_of("m/s"), "long_name": "velocity"})
            ball: Extra = (*time, ("ball", balls))
            place = "ball position from its place in the packed, centred row"
            found["relative_position"] = (ball, "float64", {"units": "m", "long_name": place})
            found["relative_velocity"] = (
                ball,
                "float64",
                {"units": "m/s", "long_name": "ball velocity relative to the cavity"},
            )
        if self.last:
            tail: Extra = (("last", self.last),)
            found["last_time"] = (tail, "float64", {"units": "s", "long_name": "time of impact"})
            found["last_approach_speed"] = (tail, "float64", {"units": "m/s", "long_name": "approach speed"})
            found["last_contact"] = (tail, "float64", {"units": "", "long_name": "number of the contact"})
        if self.state:
            states: Extra = (("component", 2 * (len(self.case.modes.decay) + balls)),)
            found["state"] = (states, "float64", {"units": "", "long_name": "modes, ball positions, ball velocities"})
        return found

    def coords(self) -> dict[str, Any]:
        """Return the coordinates of the further dimensions."""
        found: dict[str, tuple[NDArray[Any], str, str]] = {}
        durations = np.unique(np.concatenate([np.ravel(p.packed.settings.duration) for p, *_ in self._parts]))
        lengths = {name: length for extra, _, _ in self.outputs.values() for name, length in extra}
        if self.motion:
            found["ball"] = np.arange(1, lengths["ball"] + 1), "1", "number of the ball"
            if self.cycles is not None:
                found["instant"] = self._window(0.0, self.cycles[1]), "1", "evaluated cycles"
            elif len(durations) == 1:
                found["instant"] = self._window(self.skip, durations.item()), "s", "time"
            else:
                found["instant"] = self._window(0.0, 1.0), "1", "fraction of the evaluated time"
        if self.last:
            found["last"] = np.arange(-self.last, 0), "1", "number of the impact, from the end"
        if self.state:
            found["component"] = np.arange(1, lengths["component"] + 1), "1", "number of the component"
        return {
            name: (name, values, {"units": unit, "long_name": text}) for name, (values, unit, text) in found.items()
        }

    def _window(self, start: float, stop: float) -> NDArray[np.float64]:
        return np.linspace(start, stop, self.output.samples)

    def describe(self) -> dict[str, Any]:
        """Return a description of everything except the grid, in JSON types."""
        return {**super().describe(), **{name: getattr(self, name) for name in ("motion", "last", "state")}}

    def run(self, start: int, stop: int, *, threads: int = 1, cancelled: Cancelled = None) -> Values | None:
        """Run a range of variants; see `Work.run`."""
        proceed = proceed_unless(cancelled)
        result = self._run_core(start, stop, threads, proceed)
        if result is None or not self.functions:
            return result
        columns = {name: np.full(stop - start, np.nan) for name in self.functions}
        for index in range(start, stop):
            if not proceed():
                return None
            (run,) = simulate_many([self.grid.case_at(self.case, index)], threads=1)
            if run.status == "finished":
                for name, number in self.call_functions(run, index).items():
                    columns[name][index - start] = number
        return {**result, **columns}

    def _run_core(self, start: int, stop: int, threads: int, proceed: Callable[[int], bool]) -> Values | None:
        """Return the outputs that the core computes; None if the work was cancelled."""
        found: dict[str, NDArray[Any]] = {}
        for part, output, numbers in self._parts:
            first, last = (start, stop) if numbers is None else np.searchsorted(numbers, (start, stop)).tolist()
            if first == last:
                continue
            values = run_block(part.packed, part.shape, first, last, output, threads=threads, progress=proceed)
            if values is not None:
                values = self.reduced(
                    with_intervals(values, output, shortest_windows(part.packed, part.shape, output)[first:last]),
                    first,
                    last,
                )
            if values is None or numbers is None:
                return values
            for name, array in values.items():
                column = found.setdefault(name, np.empty((stop - start, *array.shape[1:]), array.dtype))
                column[numbers[first:last] - start] = array
        return found

    def reduced(self, values: dict[str, NDArray[Any]], start: int, stop: int) -> dict[str, NDArray[Any]]:
        """Return the outputs of variants start to stop from those of the core; subclasses reduce motions to numbers."""
        return values

    def validate(self) -> None:
        """Raise if a variant is not valid, before anything runs."""
        _ = self._parts

    def require_alike(self) -> None:
        """Raise if the variants differ in more than numbers, before anything runs."""
        _ = self.packed

    # ---- input of the core

    @property
    def packed(self) -> _core.Problem:
        """All variants as one batch."""
        part = self._parts[0][0]
        if part.obstacle:
            raise part.obstacle
        return part.packed

    @property
    def output(self) -> BlockOutput:
        """Quantities that the core returns; those of the first part if variants differ in more than numbers."""
        return self._parts[0][1]

    @cached_property
    def _parts(self) -> list[tuple[Batch, BlockOutput, NDArray[np.intp] | None]]:
        """Batches whose variants differ only in numbers, their outputs, and the numbers of their variants."""
        parts = pack_parts(self.case, self.grid.columns, self.grid.shape)
        found = []
        for part in parts:
            balls = sum(len(damper.mass) for damper in part.packed.dampers)
            modes = len(part.packed.mode_decay)
            if (
                part.obstacle
                and (self.motion or self.state)
                and (balls, modes) != (self._balls, len(self.case.modes.decay))
            ):
                raise part.obstacle
            numbers = part.flat_indices(self.grid.shape) if len(parts) > 1 else None
            found.append((*self._set_window(part), numbers))
        return found

    def _set_window(self, part: Batch) -> tuple[Batch, BlockOutput]:
        """Return a batch with its duration, and the quantities to return."""
        packed = part.packed
        settings = packed.settings
        self.require_interface_force()
        observed = self._observed or Observed.of(self.case.modes, self._point)
        period = _period(packed)
        if self.cycles is not None:
            if period is None:
                raise Hint("cycles require a harmonic load or motion", 'duration and skip in seconds: skip = "2 s"')
            settings = settings.replace(duration=sum(self.cycles) * period)
        for name in self.measure_names:
            if MEASURES[name].cyclic and period is None:
                raise Hint(f"{name} is defined per cycle and requires a harmonic load or motion", 'kind = "harmonic"')
        start = self.skip if self.cycles is None else self.cycles[0] * period
        if np.any(np.asarray(start) >= settings.duration):
            raise Hint(
                f"skip = {np.max(start):.6g} s is not before the end of the run", "a smaller skip or a longer duration"
            )
        dense = self.motion or any(MEASURES[name].samples for name in self.measure_names)
        usual = 2001 if self.cycles is None else 1 + int(np.ceil(64 * self.cycles[1]))
        ends = 2
        if self.averages and not dense:  # energies at the ends of cycles, or of equal parts
            cycles = 64.0 if period is None else float(np.max((settings.duration - np.asarray(start)) / period))
            ends = 1 + int(np.clip(np.ceil(cycles - 1e-9), 1, 2000))
        harmonic = [name for name in self.measure_names if MEASURES[name].samples and MEASURES[name].cyclic]
        if harmonic:
            cycles = float(np.max((settings.duration - np.asarray(start)) / period))
            usual = max(usual, 1 + int(np.ceil(20 * cycles)))
            rate = ((self.samples or usual) - 1) / cycles
            if rate < MIN_SAMPLES * (1 - 1e-6):
                raise Hint(
                    f"{rate:.3g} samples per cycle are too few for {harmonic[0]}, which requires {MIN_SAMPLES}",
                    "more samples, or leave out the number",
                )
        output = BlockOutput(
            measures=self.measure_names,
            shape=observed.shape(part.points, len(packed.mode_decay)),
            base=float(observed.moves_with_base),
            participation=part.inertia.get("participation", np.zeros(0)),
            residual_mass=part.inertia.get("residual_mass", np.zeros(1))[0],
            start=start,
            period=np.nan if period is None else period,
            samples=self.samples or (usual if dense else ends),
            motion=self.motion,
            last=self.last,
            state=self.state,
            batched=[*parts_needed(self.averages), _CONTACTS] if self.averages else (),
        )
        return replace(part, packed=packed.replace(settings=settings)), output

    @property
    def _balls(self) -> int:
        return sum(len(damper.balls) for damper in self.case.impact_dampers)

    @property
    def _point(self) -> str:
        return self.case.modes.point(self.case.dampers[0].point if self.case.dampers else None)


_CONTACTS = "impacts"
"""Batched in every window with intervals, last: without any, the motion is that of the linear structure."""


def with_intervals(values: Values, output: BlockOutput, shortest: NDArray[np.float64]) -> dict[str, NDArray[Any]]:
    """Return outputs in which the intervals of measures replace the batches.

    Parameters
    ----------
    values
        Outputs of `run_block`.
    output
        Requested quantities.
    shortest : (n,) float
        Shortest window for an interval of each variant whose damper does not act [s].
    """
    found = dict(values)
    if output.batched:
        batches, lengths = found.pop("batches"), found.pop("batch_length")
        parts = dict(zip((*output.batched[:-1], ""), batches, strict=True))
        least = np.where(np.nansum(parts.pop(""), axis=1) > 0, 0.0, shortest)
        for name in output.measures:
            if set(parts_needed([name])) <= set(parts) and MEASURES[name].average:
                found[name + INTERVAL] = interval_of(name, found[name], parts, lengths, least)
    return found


def shortest_windows(packed: _core.Problem, shape: Sequence[int], output: BlockOutput) -> NDArray[np.float64]:
    """Return the shortest window for an interval of the linear motion of each variant, see `shortest_window`, flat [s].

    Parameters
    ----------
    packed
        Variants.
    shape
        Shape of their grid.
    output
        Requested quantities, with the shapes of the modes at the observed point.
    """
    modes = len(packed.mode_decay)
    if not modes:  # a cavity with a given motion
        return np.zeros(math.prod(shape))

    def over_grid(values: Any) -> Any:
        array = np.asarray(values, dtype=float)
        array = array.reshape(modes, *(1,) * (len(shape) + 1 - array.ndim), *array.shape[1:])
        return np.broadcast_to(array, (modes, *shape)).reshape(modes, -1)

    decay, motion = over_grid(packed.mode_decay), np.abs(over_grid(output.shape))
    seen = np.where(motion > 1e-9 * motion.max(axis=0, initial=0.0), decay, 0.0)
    # Few variants differ in their structure.
    different, inverse = np.unique(seen, axis=1, return_inverse=True)
    return np.array([shortest_window(column) for column in different.T])[inverse.ravel()]


def _period(packed: _core.Problem) -> Any:
    """Return the period of the first harmonic load or motion [s]; None if there is none."""
    for load in packed.loads:
        if isinstance(load.signal, _core.Harmonic):
            return 2 * np.pi / np.asarray(load.signal.frequency)
    return None
