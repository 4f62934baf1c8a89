"""Engine of studies of impact dampers: variants run in the core without storing trajectories."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import RattleboxError
from rattlebox.analysis.shaken import MIN_SAMPLES
from rattlebox.core import _core
from rattlebox.engines.batch import BlockOutput, run_block
from rattlebox.engines.continued import checked_end, from_start, pack_continued, reading_state
from rattlebox.engines.simulate import run_from_core
from rattlebox.model.errors import Hint
from rattlebox.prepare.pack import Batch, contact_samples, pack_parts
from rattlebox.studies.work import continuation
from rattlebox.studies.work.measures import CONTACTS, MEASURES, parts_needed, shortest_windows, with_intervals
from rattlebox.studies.work.starting import check_starts, refused_row, window_start
from rattlebox.studies.work.variants import FREQUENCY, Observed, Variants, gather_values
from rattlebox.studies.work.window import cut_before
from rattlebox.studies.work.work import Cancelled, Outputs, Reduction, Signals, Values, proceed_unless

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.results.run import Run
    from rattlebox.studies.grid.grid import Grid

_NUMBERS = 2**23
"""Largest number of samples of the motions of a block."""


class _Alone(NamedTuple):
    """A variant by itself: its case, its batch with the outputs, its number in the batch, and the time of its start [s]."""

    case: Case
    part: Batch
    output: BlockOutput
    number: int
    begin: float = 0.0


@dataclass
class ImpactEngine:
    """Variants of a case with impact dampers."""

    variants: Variants
    motion: bool = False  # Whether to return the motion of each variant, and the number of its last impacts to return
    last: int = 0
    state: bool = False  # Whether to return the state at its end, from which another variant can start

    has_states = False  # the state is an output

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_parts"}

    @property
    def case(self) -> Case:
        """Case with the values that do not vary."""
        return self.variants.case

    @property
    def grid(self) -> Grid:
        """Grid of the variants."""
        return self.variants.grid

    @property
    def block(self) -> int:
        """Preferred number of variants in a block: the square root of all, or 1 with measures of a Run."""
        if self.variants.needs_run:
            return 1
        size = math.isqrt(self.grid.size)
        return max(1, min(size, _NUMBERS // (2 * self.output.samples * (1 + self._balls)))) if self.motion else size

    @cached_property
    def outputs(self) -> Outputs:
        """Further dimensions, number type and attributes of each output."""
        balls, units_of = self._balls, self.variants.units_of
        found = dict(self.variants.outputs)

        def add(name: str, units: str, long_name: str, *extra: tuple[str, int]) -> None:
            found[name] = extra, "float64", {"units": units, "long_name": long_name}

        if self.motion:
            time = "instant", self.output.samples
            add("displacement", units_of("m"), "displacement", time)
            add("velocity", units_of("m/s"), "velocity", time)
            add(
                "relative_position",
                "m",
                "ball position from its place in the packed, centred row",
                time,
                ("ball", balls),
            )
            add("relative_velocity", "m/s", "ball velocity relative to the cavity", time, ("ball", balls))
        if self.last:
            tail = "last", self.last
            add("last_time", "s", "time of impact", tail)
            add("last_approach_speed", "m/s", "approach speed", tail)
            add("last_contact", "", "number of the contact", tail)
        if self.state:
            size = 2 * (len(self.case.modes.decay) + balls)
            add("state", "", "modes, ball positions, ball velocities", ("component", size))
            add("lead", "1", "cycles from the state to the end of the run")
        return found

    def coords(self) -> dict[str, Any]:
        """Return the coordinates of the further dimensions."""
        found: dict[str, tuple[NDArray[Any], str, str]] = {}
        durations = np.unique(np.concatenate([np.ravel(p.packed.settings.duration) for p, *_ in self._parts]))
        starts = None if self.grid.starts is None or self.variants.skip else self.grid.starts[1]
        begins = {self.variants.skip} if starts is None else set(starts.times.tolist())
        lengths = {name: length for extra, _, _ in self.outputs.values() for name, length in extra}
        if self.motion:
            found["ball"] = np.arange(1, lengths["ball"] + 1), "1", "number of the ball"
            first, last, unit, text = 0.0, 1.0, "1", "fraction of the evaluated time"
            if self.variants.cycles is not None:
                last, text = self.variants.cycles[1], "evaluated cycles"
            elif len(durations) == len(begins) == 1:
                first, last, unit, text = *begins, durations.item(), "s", "time"
            found["instant"] = np.linspace(first, last, self.output.samples), unit, text
        if self.last:
            found["last"] = np.arange(-self.last, 0), "1", "number of the impact, from the end"
        if self.state:
            found["component"] = np.arange(1, lengths["component"] + 1), "1", "number of the component"
        return {
            name: (name, values, {"units": unit, "long_name": text}) for name, (values, unit, text) in found.items()
        }

    def describe(self) -> dict[str, Any]:
        """Return a description of everything except the grid, in JSON types."""
        return {**self.variants.describe(), **{name: getattr(self, name) for name in ("motion", "last", "state")}}

    def validate(self) -> None:
        """Raise if a variant is not valid, before anything runs."""
        _ = self._parts
        check_starts(self.grid, lambda index, run: self._continued(index, run))

    def require_alike(self) -> None:
        """Raise if the variants differ in more than numbers, before anything runs."""
        _ = self.packed

    def require_continuous(self) -> None:
        """Raise if a variant cannot start from the end of another one."""
        continuation.check_variants(self.variants)
        continuation.require_periodic(self.packed, self.output.period)

    def refusal_reason(self, index: int) -> str:
        """Return the reason why a variant cannot continue its start; "" if it can, or has none.

        Other invalid variants are refused before any runs.
        """
        start = self.grid.start_at(index)
        run = None if start is None else start.reached()
        try:
            if run is not None:
                self._continued(index, run)
        except RattleboxError as error:
            return str(error)
        return ""

    def timed_case(self, number: int) -> Case | None:
        """Return None: variants are timed in blocks; see `Engine.timed_case`."""
        return None

    def variant(self, index: int) -> Case:
        """Return the case of a variant, with the time at which its run ends."""
        part, _, number = self._part_of(index)
        duration = np.broadcast_to(part.packed.settings.duration, part.shape).flat[number]
        start = self.grid.start_at(index)
        if start is not None and self.variants.cycles is not None:  # which count from the start
            duration = start.begin + duration
        return self.grid.case_at(self.case, index).model_copy(update={"duration": float(duration)})

    def _part_of(self, index: int) -> tuple[Batch, BlockOutput, int]:
        """Return the batch of a variant, its outputs, and the number of the variant in it."""
        for part, output, numbers in self._parts:
            if numbers is None:
                return part, output, index
            if numbers[number := min(int(np.searchsorted(numbers, index)), len(numbers) - 1)] == index:
                return part, output, number
        raise IndexError(index)

    # ---- runs

    def run(
        self, numbers: range, *, threads: int = 1, cancelled: Cancelled = None, reduction: Reduction | None = None
    ) -> Values | None:
        """Run variants; see `Engine.run`."""
        proceed = proceed_unless(cancelled)
        if self.variants.needs_run or self.grid.starts is not None:
            rows = []
            for index in numbers:
                row = self._run_alone(index, proceed)
                if row is None:
                    return None
                rows.append(row)
            values = {name: np.concatenate([row[name] for row in rows]) for name in rows[0]}
        else:
            found = self._run_core(numbers.start, numbers.stop, threads, proceed)
            if found is None:
                return None
            values = found
        if reduction is None:
            return values
        masses = np.array([ball.weight for damper in self.case.impact_dampers for ball in damper.balls])
        last = self.variants.cycles[1] if self.variants.cycles else 1
        hertz = [float(self.grid.values_at(index)[FREQUENCY]) for index in numbers]
        # The motion of the cavity has the first harmonic only and is the same in each cycle, so that the momentum relative
        # to it has the same higher harmonics and the same variation.
        signals = Signals(
            np.linspace(0.0, last, self.output.samples),
            1.0,
            np.array(hertz)[:, None],
            values["displacement"],
            lambda: np.asarray(values["relative_velocity"] @ masses),
            {},
        )
        return values | reduction.reduce(signals)

    def follow(
        self,
        numbers: range,
        before: Values | None,
        *,
        threads: int = 1,
        cancelled: Cancelled = None,
        reduction: Reduction | None = None,
    ) -> Values | None:
        """Run variants of one chain; see `ChainEngine.follow`. Threads and reductions have no effect."""
        return continuation.follow(
            continuation.Batch(self.packed, self.grid.shape, self.output), numbers, before, cancelled
        )

    def _run_core(self, start: int, stop: int, threads: int, proceed: Callable[..., bool]) -> dict[str, Any] | None:
        """Return the outputs that the core computes; None if the work was cancelled."""
        found: dict[str, NDArray[Any]] = {}
        for part, output, numbers in self._parts:
            first, last = (start, stop) if numbers is None else np.searchsorted(numbers, (start, stop)).tolist()
            if first == last:
                continue
            values = self._run_part(part, output, first, last, threads, proceed)
            if values is None or numbers is None:
                return values
            for name, array in values.items():
                column = found.setdefault(name, np.empty((stop - start, *array.shape[1:]), array.dtype))
                column[numbers[first:last] - start] = array
        return found

    def _run_part(
        self, part: Batch, output: BlockOutput, first: int, last: int, threads: int, proceed: Callable[..., bool]
    ) -> dict[str, Any] | None:
        values = run_block(part.packed, part.shape, first, last, output, threads=threads, progress=proceed)
        if values is None:
            return None
        return with_intervals(values, output, shortest_windows(part.packed, part.shape, output)[first:last])

    def _run_alone(self, index: int, proceed: Callable[..., bool]) -> dict[str, Any] | None:
        """Return the outputs of one variant, which may continue a run; None if the work was cancelled."""
        start = self.grid.start_at(index)
        if start is None:
            return self._outputs_of(_Alone(self.variant(index), *self._part_of(index)), index, proceed)
        run = start.reached(proceed)
        if run is None:
            return None
        try:
            one = self._continued(index, run)
        except RattleboxError:  # the variant gets the status "refused"; see `refusal_reason`
            return refused_row(self.outputs)
        with reading_state():
            return self._outputs_of(one, index, proceed)

    def _outputs_of(self, one: _Alone, index: int, proceed: Callable[..., bool]) -> dict[str, Any] | None:
        """Return the outputs of a variant, with the values of functions of its run; None if the work was cancelled.

        The variant runs once: the core takes the samples of the window and those of the run at the same time.
        """
        if not self.variants.needs_run:
            return self._run_part(one.part, one.output, one.number, one.number + 1, 1, proceed)
        settings = one.part.packed.settings.replace(contact_samples=contact_samples(one.case))
        sampled = replace(one.part, packed=one.part.packed.replace(settings=settings))
        output = replace(one.output, times=one.case.sample_times(one.begin))
        values = self._run_part(sampled, output, one.number, one.number + 1, 1, proceed)
        if values is None:
            return None
        (raw,) = values.pop("runs")
        run = run_from_core(one.case, from_start(raw, one.begin, len(one.case.each_stop)) if one.begin else raw)
        own = {}
        if run.ok:
            start = float(np.broadcast_to(output.start, one.part.shape).flat[one.number])
            own = self.variants.call_functions(run, cut_before(run, start), index)
        names = (*self.variants.names_of_run, *self.variants.functions)
        return values | {name: np.array([own.get(name, np.nan)]) for name in names}

    def _continued(self, index: int, run: Run) -> _Alone:
        """Return a variant that continues a run; raise if it cannot."""
        case = self.variant(index)
        end = checked_end(case, run)
        packed = pack_continued(case, run, end)
        settings = packed.settings.replace(contact_samples=0, keep_end=False)
        part, output, number = self._part_of(index)

        def own(values: Any) -> Any:
            return gather_values(values, part.shape, np.array([number])) if np.size(values) else values

        names = ("shape", "participation", "residual_mass", "period")
        first = end.time + float(np.ravel(own(output.start))[0])
        if self.variants.cycles is None:
            first = window_start(self.variants.skip, end.time)
        return _Alone(
            case,
            Batch(packed.replace(settings=settings), (np.arange(1),)),
            replace(output, start=first, **{name: own(getattr(output, name)) for name in names}),
            0,
            end.time,
        )

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
        self.variants.require_structure()
        observed = self.variants.observed or self._usual(part)
        period = _period(packed)
        if self.variants.cycles is not None:
            if period is None:
                raise Hint("cycles require a harmonic load or motion", 'duration and skip in seconds: skip = "2 s"')
            settings = settings.replace(duration=sum(self.variants.cycles) * period)
        for name in self.variants.names:
            if MEASURES[name].cyclic and period is None:
                raise Hint(f"{name} is defined per cycle and requires a harmonic load or motion", 'kind = "harmonic"')
        start = self.variants.skip if self.variants.cycles is None else self.variants.cycles[0] * period
        if np.any(np.asarray(start) >= settings.duration):
            raise Hint(
                f"skip = {np.max(start):.6g} s is not before the end of the run", "a smaller skip or a longer duration"
            )
        dense = self.motion or any(MEASURES[name].samples for name in self.variants.names)
        usual = 2001 if self.variants.cycles is None else 1 + int(np.ceil(64 * self.variants.cycles[1]))
        ends = 2
        if self.variants.averages and not dense:  # energies at the ends of cycles, or of equal parts
            cycles = 64.0 if period is None else float(np.max((settings.duration - np.asarray(start)) / period))
            ends = 1 + int(np.clip(np.ceil(cycles - 1e-9), 1, 2000))
        harmonic = [name for name in self.variants.names if MEASURES[name].of_first_harmonic]
        if harmonic:
            cycles = float(np.max((settings.duration - np.asarray(start)) / period))
            usual = max(usual, 1 + int(np.ceil(20 * cycles)))
            rate = ((self.variants.samples or usual) - 1) / cycles
            if rate < MIN_SAMPLES * (1 - 1e-6):
                raise Hint(
                    f"{rate:.3g} samples per cycle are too few for {harmonic[0]}, which requires {MIN_SAMPLES}",
                    "more samples, or leave out the number",
                )
        output = BlockOutput(
            measures=self.variants.names,
            shape=observed.shape(part.points, len(packed.mode_decay)),
            base=float(observed.moves_with_base),
            participation=part.inertia.get("participation", np.zeros(0)),
            residual_mass=part.inertia.get("residual_mass", np.zeros(1))[0],
            start=start,
            period=np.nan if period is None else period,
            samples=self.variants.samples or (usual if dense else ends),
            motion=self.motion,
            last=self.last,
            state=self.state,
            batched=[*parts_needed(self.variants.averages), CONTACTS] if self.variants.averages else (),
        )
        return replace(part, packed=packed.replace(settings=settings)), output

    @property
    def _balls(self) -> int:
        return sum(len(damper.balls) for damper in self.case.impact_dampers)

    def _usual(self, part: Batch) -> Observed:
        """Return the motion that is observed unless a point is named: that of the first damper."""
        if not (self.motion or any(MEASURES[name].samples for name in self.variants.names)):
            return Observed(next(iter(part.points)))  # nothing observes it
        modes = self.case.modes
        return Observed.of(modes, modes.point(self.case.dampers[0].point if self.case.dampers else None))


def _period(packed: _core.Problem) -> Any:
    """Return the period of the first harmonic load or motion [s]; None if there is none."""
    for load in packed.loads:
        if isinstance(load.signal, _core.Harmonic):
            return 2 * np.pi / np.asarray(load.signal.frequency)
    return None
