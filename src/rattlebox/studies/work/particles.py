"""Engine of studies of particle dampers: complete 3-D runs, reduced to measures."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import RattleboxError
from rattlebox._util.flags import flag_masks
from rattlebox.analysis.cycle_loss import UNSTEADY, cycle_loss
from rattlebox.analysis.shaken import MIN_SAMPLES
from rattlebox.core._core import Status
from rattlebox.engines.continued import checked_end
from rattlebox.engines.dem import PausedRun, continue_dem, run_part, simulate_dem
from rattlebox.engines.dem_continued import pack_continued
from rattlebox.engines.end_state import EndState
from rattlebox.engines.simulate import continue_run, simulate_many
from rattlebox.model.errors import Hint
from rattlebox.model.methods import Output
from rattlebox.model.particle_case import direction_of_base
from rattlebox.prepare.particles import refusal_reason, settle_all
from rattlebox.prepare.time_step import WARNINGS, exceeded_limits
from rattlebox.results import Run
from rattlebox.studies.work.impact import ImpactEngine
from rattlebox.studies.work.measures import MEASURES
from rattlebox.studies.work.starting import check_starts, missing_value, window_start
from rattlebox.studies.work.variants import MeasureError, Variants
from rattlebox.studies.work.window import Window
from rattlebox.studies.work.work import Cancelled, Outputs, Reduction, Signals, Values, proceed_unless

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.studies.grid.grid import Grid

_UNSTEADY = 2 ** list(WARNINGS).index(UNSTEADY)
"""Bit of a motion that is not steady in the `warnings` of a variant."""

FLAGS: dict[str, Any] = {"long_name": "exceeded validity limits", **flag_masks(WARNINGS)}
"""Attributes of the exceeded validity limits of runs."""

EXTENSIONS = 4
"""How often the default evaluated cycles are repeated, at most."""


@dataclass
class ParticleEngine:
    """Variants of a case with particle dampers.

    Functions of a Run get the run from which the measures are evaluated. Its samples are those of the output of the case,
    unless `samples` or `cycles` is given.
    """

    variants: Variants
    extensions: int = 0  # How often a run may be continued by the evaluated cycles, until its motion is steady

    has_states = True  # of a size of their own
    block = 1

    @property
    def case(self) -> Case:
        """Case with the values that do not vary."""
        return self.variants.case

    @property
    def grid(self) -> Grid:
        """Grid of the variants."""
        return self.variants.grid

    @cached_property
    def outputs(self) -> Outputs:
        """Further dimensions, number type and attributes of each output, with the exceeded validity limits."""
        outputs = dict(self.variants.outputs)
        flags: Outputs = {"status": outputs.pop("status"), "warnings": ((), "int8", FLAGS)}
        if self.extensions:
            skipped = {"units": "1", "long_name": "cycles before the evaluated ones"}
            outputs["skipped_cycles"] = (), "int32", skipped
        return {**flags, **outputs}

    def coords(self) -> dict[str, Any]:
        """Return the coordinates of the dimensions beyond the grid: none."""
        return {}

    def describe(self) -> dict[str, Any]:
        """Return a description of everything except the grid, in JSON types."""
        return self.variants.describe() | ({"extensions": self.extensions} if self.extensions else {})

    # ---- checks

    def validate(self) -> None:
        """Raise if the arguments do not fit the case or each other."""
        variants, frequency = self.variants, _frequency(self.case)
        for name in variants.names:
            if MEASURES[name].of_impacts:
                others = ", ".join(other for other, measure in MEASURES.items() if not measure.of_impacts)
                raise Hint(f"{name} refers to single impacts, which particle runs do not store", others)
            if MEASURES[name].cyclic and math.isnan(frequency):
                raise Hint(f"{name} is defined per cycle and requires a harmonic load or motion", 'kind = "harmonic"')
        if variants.cycles is not None and math.isnan(frequency):
            raise Hint("cycles require a harmonic load or motion", 'duration and skip in seconds: skip = "2 s"')
        self._check_ends()
        check_starts(self.grid, self._check_continuation)
        if variants.cycles is None:
            self._check_window(frequency)
        variants.require_structure()
        _ = variants.observed  # raises if there is no such point

    def _check_window(self, frequency: float) -> None:
        """Raise if nothing is left of the run, or less than a cycle that a measure requires."""
        skip, duration = self.variants.skip, self.case.duration
        if skip >= duration:
            raise Hint(f"skip = {skip:.6g} s is not before the end of the run", "a smaller skip or a longer duration")
        cyclic = [name for name in self.variants.names if MEASURES[name].cyclic]
        if cyclic and (duration - skip) * frequency < 1 - 1e-9:
            raise Hint(
                f"skip = {skip:.6g} s leaves less than the one cycle that {cyclic[0]} requires", "a longer duration"
            )

    def _check_ends(self) -> None:
        """Raise if neither the first nor the last variant is valid."""
        for index in (0, self.grid.size - 1):
            try:
                self.variant(index)
                return
            except RattleboxError as error:
                refused = error
        raise refused

    def _check_continuation(self, index: int, run: Run) -> None:
        """Raise if a variant cannot continue a run."""
        case = self.variant(index)
        pack_continued(case, run.case, checked_end(case, run))

    def require_continuous(self) -> None:
        """Raise if the loads do not continue from one variant to the next."""
        self.validate()
        harmonics = self.case.harmonics.values()
        if len(harmonics) < len((*self.case.loads, *self.case.base)) or any(
            signal.start > 0 or signal.stop is not None for signal in harmonics
        ):
            raise Hint(
                "a load or motion does not continue from one frequency to the next",
                'one harmonic without start and stop, or direction = "fresh"',
            )

    def refusal_reason(self, index: int) -> str:
        """Return the reason why a variant cannot run; "" if it can."""
        start = self.grid.start_at(index)
        run = None if start is None else start.reached()
        try:
            if run is not None:
                self._check_continuation(index, run)
                return ""
            return refusal_reason(self.variant(index))
        except RattleboxError as error:
            return str(error)

    # ---- variants

    def variant(self, index: int) -> Case:
        """Return the case of a variant, with the duration and samples of its run."""
        case = self.grid.case_at(self.case, index)
        if not case.particle_dampers:
            raise Hint("a variant has no particle damper", "one sweep for each kind of damper")
        start = self.grid.start_at(index)
        return self._set_window(case, 0.0 if start is None else start.begin)

    def _set_window(self, case: Case, begin: float) -> Case:
        """Return a case with the duration and the samples of the study, for a run from a time on [s]."""
        cycles, samples = self.variants.cycles, self.variants.samples
        duration, skip = case.duration, window_start(self.variants.skip, begin)
        if cycles is not None:
            period = 1 / _frequency(case)
            duration, skip = begin + sum(cycles) * period, begin + cycles[0] * period
            _check_start(case, skip)
            each = 64 if samples is None else max(1, math.ceil((samples - 1) / cycles[1]))
            samples = 1 + each * cycles[1]
        if samples is not None and duration > skip:
            output = Output(rate=(samples - 1) / (duration - skip))
            case = case.model_copy(update={"duration": duration, "output": output})
        for name in self.variants.names:
            if MEASURES[name].of_first_harmonic:
                _check_samples(case, name)
        if any(MEASURES[name].of_walls for name in self.variants.names_of_run):
            case = case.model_copy(update={"output": case.output.model_copy(update={"walls": True})})
        return case

    def window(self, run: Run, case: Case) -> Window:
        """Return the part of the run of a variant over which measures are evaluated."""
        cycles, begin = self.variants.cycles, float(run.arrays.time[0])
        start = window_start(self.variants.skip, begin) if cycles is None else begin + cycles[0] / _frequency(case)
        return Window.of(run, case, start, self.variants.observed)

    def timed_case(self, number: int) -> Case | None:
        """Return the case of a variant, or None if it cannot run; see `Engine.timed_case`."""
        start = self.grid.start_at(number)
        try:
            case = self.variant(number)
            return case if start is None else case.model_copy(update={"duration": case.duration - start.begin})
        except RattleboxError:  # the variant gets the status "refused"
            return None

    @property
    def longest(self) -> float:
        """Largest length of a run that continues until its motion is steady, over its length without a continuation."""
        cycles = self.variants.cycles
        return 1 + self.extensions * cycles[1] / sum(cycles) if self.extensions and cycles else 1.0

    # ---- runs

    def run(
        self, numbers: range, *, threads: int = 1, cancelled: Cancelled = None, reduction: Reduction | None = None
    ) -> Values | None:
        """Run variants; see `Engine.run`."""
        proceed = proceed_unless(cancelled)
        rows = {}
        for index in numbers:
            try:
                row = self._row_of(index, threads, proceed, reduction)
            except MeasureError:
                raise
            except RattleboxError:  # the variant gets the status "refused"; see `refusal_reason`
                continue
            if row is None:
                return None
            rows[index] = row
        return self._columns(rows, numbers, reduction)

    def follow(
        self,
        numbers: range,
        before: Values | None,
        *,
        threads: int = 1,
        cancelled: Cancelled = None,
        reduction: Reduction | None = None,
    ) -> Values | None:
        """Run variants of one chain; see `ChainEngine.follow`. The state is that at the end of the last one.

        Particles, contacts and structure start as the variant before left them. The load continues without a break, since
        each variant lasts whole cycles. A variant that does not finish leaves the state unchanged.
        """
        proceed = proceed_unless(cancelled)
        end = None if before is None else EndState.from_arrays(before)
        rows = {}
        for index in numbers:
            try:
                case = self.variant(index)
                if end is None and not settle_all(case, proceed):
                    return None
                run, after = continue_dem(case, end, threads=threads, progress=proceed)
            except MeasureError:
                raise
            except RattleboxError:  # the variant gets the status "refused"; see `refusal_reason`
                continue
            if run.status == "interrupted":
                return None
            rows[index] = self._row(case, run, index, reduction)
            end = after if run.ok else end
        states = {} if end is None else end.arrays()
        repeated = {name: np.repeat(array, len(numbers), axis=0) for name, array in states.items()}
        return {**self._columns(rows, numbers, reduction), **repeated}

    def _row_of(
        self, index: int, threads: int, proceed: Callable[..., bool], reduction: Reduction | None
    ) -> dict[str, Any] | None:
        """Run a variant, repeatedly until its motion is steady if allowed; return its outputs, None if it was stopped."""
        start, cycles = self.grid.start_at(index), self.variants.cycles
        if start is not None:
            before = start.reached(proceed)
            if before is None:
                return None
            case = self.variant(index)
            run = continue_run(case, before, threads=threads, progress=proceed)
            return None if run.status == "interrupted" else self._row(case, run, index, reduction)
        case = self.variant(index)
        if not settle_all(case, proceed):
            return None
        if not self.extensions or cycles is None:
            run = simulate_dem(case, threads=threads, progress=proceed)
            return None if run.status == "interrupted" else self._row(case, run, index, reduction)
        skip, kept = cycles
        (driver, *_) = case.harmonics.values()
        repeats = self.extensions if driver.start == 0 and driver.stop is None else 0
        run, end = continue_dem(case, None, threads=threads, progress=proceed)
        row = self._row(case, run, index, reduction)
        # A repetition starts from the end of the run and has nothing to skip.
        later = replace(self, variants=replace(self.variants, cycles=(0, kept)))
        for repeated in range(repeats):
            row["skipped_cycles"] = skip + repeated * kept
            if run.status == "interrupted":
                return None
            if not row["warnings"] & _UNSTEADY:
                break
            case = later.variant(index)
            run, end = continue_dem(case, end, threads=threads, progress=proceed)
            row = later._row(case, run, index, reduction) | {"skipped_cycles": skip + (repeated + 1) * kept}
        return None if run.status == "interrupted" else row

    def _row(self, case: Case, run: Run, index: int, reduction: Reduction | None) -> dict[str, Any]:
        """Return the outputs of one variant by name."""
        exceeded = exceeded_limits(run.diagnostics)
        row: dict[str, Any] = {
            "status": Status[run.status],
            "warnings": sum(2**bit for bit, name in enumerate(WARNINGS) if name in exceeded),
        }
        names = self.variants.names
        if run.status == "energy_error" and "energy_residual" in names:
            row |= self.window(run, case).values(["energy_residual"])
        if not run.ok:
            return row
        window = self.window(run, case)
        is_tested = self.variants.cycles is not None or any(MEASURES[name].cyclic for name in names)
        if is_tested and window.cycle is not None and not window.cycle.is_steady:
            row["warnings"] |= _UNSTEADY
        row |= window.values(names)
        row |= window.intervals(self.variants.averages, row, self.variants.observed)
        row |= self.variants.call_functions(run, window.run, index)
        if reduction is not None:
            found = reduction.reduce(self._signals(case, run, window))
            row |= {name: np.asarray(values)[0] for name, values in found.items()}
        return row

    def _signals(self, case: Case, run: Run, window: Window) -> Signals:
        """Return the motions of a run for a reduction."""
        arrays = window.run.arrays

        def momentum() -> NDArray[np.float64]:
            (motion,) = case.shaker_motion
            return np.asarray(arrays.momentum.sum(axis=1) @ direction_of_base(case.particle_dampers, motion))[None]

        weightless = not all(np.any(damper.gravity) for damper in case.particle_dampers)
        diagnostics = {**run.diagnostics, "weightless": weightless}
        return Signals(arrays.time, _frequency(case), 1.0, window.displacement[None], momentum, diagnostics)

    def _columns(self, rows: Mapping[int, Mapping[str, Any]], numbers: range, reduction: Reduction | None) -> Values:
        """Return each output of variants, ascending; those without a row have the status "refused"."""
        outputs = self.outputs if reduction is None else {**self.outputs, **reduction.outputs}

        def column(name: str) -> NDArray[Any]:
            empty = missing_value(outputs[name], name)
            return np.array([rows.get(index, {}).get(name, empty) for index in sorted(numbers)], outputs[name][1])

        return {name: column(name) for name in outputs}


def engine_of(variants: Variants, **options: Any) -> ImpactEngine | ParticleEngine:
    """Return the engine for the variants of a case, by the kind of its dampers."""
    return ParticleEngine(variants, **options) if variants.case.particle_dampers else ImpactEngine(variants, **options)


def _frequency(case: Case) -> float:
    """Return the frequency of the first harmonic load or motion, which defines the cycle [Hz]; NaN if there is none."""
    return next((signal.frequency for signal in case.harmonics.values()), math.nan)


def _check_start(case: Case, skip: float) -> None:
    """Raise if the harmonic starts after the evaluated cycles."""
    driver = next(iter(case.harmonics.values()), None)
    if driver and driver.start > skip * (1 + 1e-9):
        raise Hint(
            f"the evaluated cycles start at {skip:.4g} s, before the harmonic at {driver.start:.4g} s",
            "start = 0, or more cycles to skip",
        )


def _check_samples(case: Case, name: str) -> None:
    """Raise if a cycle has too few samples for a measure of the first harmonic."""
    rate = (case.sample_times().size - 1) / (case.duration * _frequency(case))
    if rate < MIN_SAMPLES * (1 - 1e-6):
        raise Hint(
            f"{rate:.3g} samples per cycle are too few for {name}, which requires {MIN_SAMPLES}",
            "more samples, or leave out the number",
        )


class SteadyRun(NamedTuple):
    """A run of a shaken case, and the state from which its later parts continue; None if they start anew."""

    run: Run
    paused: PausedRun | None


def steady_run(
    case: Case,
    *,
    frequency: float,
    kept: int,
    extensions: int,
    part: float = 1.0,
    before: PausedRun | None = None,
    room: float = 0.0,
    threads: int | None = None,
    progress: Callable[..., bool] | None = None,
) -> SteadyRun:
    """Run a shaken case until the motion in its last cycles is steady, or only a part of it.

    `frequency`: frequency of the motion [Hz]. `part`: share of the duration; with less than all, the motion need not be
    steady. `before`: an earlier part of the run. `room`: largest state that is returned [bytes].
    """
    if not case.particle_dampers:
        return SteadyRun(_steady_impact_run(case, frequency, kept, extensions, part, threads, progress), None)
    run, paused = run_part(case, part, before, threads=threads, progress=progress)
    if part < 1:
        return SteadyRun(run, paused if run.ok and paused.memory <= room else None)
    more, end = case.model_copy(update={"duration": kept / frequency}), paused.state
    for _ in range(extensions):
        if not run.ok or not _may_settle(run, frequency, kept):
            break
        run, end = continue_dem(more, end, threads=threads, progress=progress)
    return SteadyRun(run, None)


def _steady_impact_run(
    case: Case,
    frequency: float,
    kept: int,
    extensions: int,
    part: float,
    threads: int | None,
    progress: Callable[..., bool] | None,
) -> Run:
    """Run a shaken 1-D case, ever longer until its motion is steady, or only a part of it."""
    for number in range(extensions + 1 if part == 1 else 1):
        longer = case.model_copy(update={"duration": part * case.duration + number * kept / frequency})
        (run,) = simulate_many([longer], threads=threads, progress=progress or False)
        if not run.ok or not _may_settle(run, frequency, kept):
            break
    return run


def _may_settle(run: Run, frequency: float, kept: int) -> bool:
    """Return whether a motion is not steady yet, but may become so in further cycles."""
    loss = cycle_loss(run, frequency, kept)
    return not loss.is_steady and loss.is_whole_turn
