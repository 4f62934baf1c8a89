"""Trials of a design search: their cases, runs and objectives."""

from __future__ import annotations

import json
import math
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import product
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from rattlebox._util.exceptions import CaseError, RattleboxError
from rattlebox._util.flags import flag_masks
from rattlebox._util.narrow import instance
from rattlebox.engines.simulate import simulate_many
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint, nearest
from rattlebox.model.paths import replaced
from rattlebox.prepare.time_step import WARNINGS
from rattlebox.studies.damping_curve import CYCLES, OTHER_MOTION, Evaluate, Way, curve_from, damping_curve_cases
from rattlebox.studies.design.evidence import (
    CYCLES_RUN,
    DROPPED,
    PACKINGS_RUN,
    deciding_note,
    order_note,
    with_curves,
    with_order,
)
from rattlebox.studies.design.space import ADDED_MASS, DAMPING_RATIO, DesignVariable, Objective, pareto_front
from rattlebox.studies.grid.axes import ParsedAxes, materials_in, packing_axis, parse_axes, read_axes
from rattlebox.studies.grid.grid import Grid, Parameter
from rattlebox.studies.run.backends import workers_of
from rattlebox.studies.run.estimate import SEARCH, START, TRIAL, Estimate, RunGroup, time_of_particle_runs
from rattlebox.studies.run.runner import evaluate_cases, run_work
from rattlebox.studies.run.study import known_measures
from rattlebox.studies.work.measures import INTERVAL, about, check_names
from rattlebox.studies.work.particles import EXTENSIONS, ParticleEngine, engine_of
from rattlebox.studies.work.variants import MeasureError, Variants, describe_case, fingerprint
from rattlebox.studies.work.work import Block, Work

if TYPE_CHECKING:
    import xarray as xr

    from rattlebox.engines.dem import PausedRun

Robust = Literal["worst", "mean", "median"]
Vector = NDArray[np.float64]
Values = dict[str, Any]
"""Values of the parameters by path, as Optuna has them: numbers, and labels of choices."""

PACKING = "packing"
"""Dimension of the random packings."""

FLAGS = {**WARNINGS, OTHER_MOTION: "decays with another frequency than that of the mode"}
"""Validity limits that a run of a trial can exceed: name and description."""

FIRST = 3
"""Number of packings after which a trial can be dropped."""
_SHORTER = 4
"""Factor by which the first part of a run is shorter than the run, if a trial can be dropped after few cycles."""
_FEWEST_CYCLES = 8
"""Smallest number of cycles of such a part; below twice as many, a run has no parts."""
MOST_PAUSED = 500_000_000
"""Size of all paused runs of a search that stay in memory [bytes]; others start anew, with the same results."""
_GROWTH = 1.5
"""Factor by which the number of packings grows from one decision about a trial to the next one."""

MOST_COMBINATIONS = 100
"""Largest number of combinations of choices that are all tried by default, and the default number of trials."""

_SAMPLED = 16
"""Number of designs from which the cost of all trials is predicted."""
_TINY = 0.3
"""Predicted time of a trial below which whole trials are timed [s]."""
_WHOLE_TRIALS = 5
"""Number of whole trials that are timed."""
_PROBED = 64
"""Number of designs of which at least one must be valid."""
_REASONS = 3
"""Number of reasons that the warning about a search without a feasible trial lists."""
_REDUCTIONS: dict[str, Any] = {"worst": np.max, "mean": np.mean, "median": np.median}


@dataclass(frozen=True)
class Curve:
    """Settings of the damping curves of a search; see `rattlebox.studies.damping_curve.damping_curve`."""

    amplitudes: Sequence[Any]
    way: Way
    mode: int
    cycles: tuple[int, int] | None


class Curves(NamedTuple):
    """Damping curves of a trial, or of several ones, trials first."""

    ratios: Vector  # Damping ratios, (levels, amplitudes, packings)
    halves: Vector  # Half of the widths of the intervals of their means, (levels, amplitudes)
    bare: Vector  # Damping ratios of the structure alone, (levels,)


@dataclass
class Evaluation:
    """Result of the runs of a trial."""

    values: Vector  # Objectives that need runs, and half of the widths of their 95 % intervals, (objectives,)
    intervals: Vector
    packings: Vector  # Their values for each packing that ran, (objectives, P)
    missing: float = 0.0
    warnings: int = 0
    reason: str = ""
    curves: Curves | None = None
    dropped: bool = False
    cycles: int = 0  # Number of cycles of its runs if they are known
    # Rise of the objectives from the first to the second half of the cycles of shaken runs, (objectives,)
    drift: Vector = field(default_factory=lambda: np.zeros(1))

    def widened(self, scatter: Vector) -> Evaluation:
        """Return the result with intervals of its packings for at least a given scatter, (objectives,)."""
        count = np.isfinite(self.packings).sum(axis=1)
        return replace(self, intervals=np.fmax(self.intervals, scatter / np.sqrt(count)))


class _Costs(NamedTuple):
    """Runs of a trial."""

    runs: float  # Number of runs
    groups: list[RunGroup]  # Particle runs of some designs
    others: float  # Processor time of the 1-D runs of these designs [s]


def pooled(found: Sequence[Evaluation]) -> Vector:
    """Return the scatter of the packings of some trials with which their intervals are widened, (objectives,).

    It is the root mean square of their standard deviations, times the quantile of Student's t. A few packings of one trial
    may agree by chance, as where each has one of two steady motions, and their own interval is then too narrow.
    """
    # Sorted, so that the order of the trials, which a stop may change, has no effect on the last digit.
    variances = np.mean(np.sort([np.nanvar(each.packings, axis=1, ddof=1) for each in found], axis=0), axis=0)
    freedom = sum(np.isfinite(each.packings).sum(axis=1) - 1 for each in found)
    return np.asarray(stdtrit(freedom, 0.975) * np.sqrt(variances))


@dataclass
class Candidate:
    """A design and the results of its packings so far."""

    case: Case | None  # None if it is refused
    mass: float = math.nan
    refused: str = ""
    ran: int = 0  # Number of packings in the tables
    short: list[Evaluation] = field(default_factory=list)  # Results after the parts of its first packings
    tables: dict[str, tuple[Vector, Vector | None]] = field(default_factory=dict)
    missing: float = 0.0
    warnings: int = 0
    reason: str = ""
    rows: dict[str, Any] = field(default_factory=dict)  # Results of the runs of damping curves, by case
    seconds: Vector = field(default_factory=lambda: np.zeros(2))  # Wall and processor time of its runs [s]

    paused: dict[str, PausedRun] = field(default_factory=dict)  # Runs after a part, by case
    room: int = 0  # Size of further paused runs that may be stored [bytes]

    @property
    def memory(self) -> int:
        """Size of its paused runs [bytes]."""
        return sum(each.memory for each in self.paused.values())

    def remember(self, evaluate: Evaluate, part: tuple[int, int] | None) -> Evaluate:
        """Return a function like `evaluate_cases` that runs each case once, from where an earlier part of it paused."""

        def run(cases: Sequence[Case], function: Any, **options: Any) -> list[Any]:
            texts = [case.to_toml() for case in cases]
            keys = [f"{part} {text}" for text in texts]
            new = [k for k, key in enumerate(keys) if key not in self.rows]
            if not new:
                return [self.rows[key] for key in keys]
            if simulate := options.get("simulate"):  # shaken
                before = {texts[k]: self.paused.pop(texts[k], None) for k in new}
                options["simulate"] = partial(_continued, partial(simulate, room=self.room / len(new)))
                found = evaluate([(cases[k], before[texts[k]]) for k in new], function, **options)
                self.paused |= {texts[k]: row.paused for k, row in zip(new, found, strict=True) if row.paused}
                found = [row._replace(paused=None) for row in found]
            else:
                found = evaluate([cases[k] for k in new], function, **options)
            self.rows |= {keys[k]: row for k, row in zip(new, found, strict=True)}
            return [self.rows[key] for key in keys]

        return run


def _continued(simulate: Callable[..., Any], item: tuple[Case, PausedRun | None], **options: Any) -> Any:
    """Return the run of a case from where an earlier part of it paused."""
    case, before = item
    return simulate(case, before=before, **options)


@dataclass(frozen=True)
class DesignSearch:
    """A design search: variables, objectives and the runs of a trial."""

    case: Case
    variables: list[DesignVariable]
    objectives: list[Objective]
    levels: ParsedAxes | None
    packings: ParsedAxes | None
    count: int
    robust: Robust
    limit: float | None  # Largest mass of the dampers [kg]
    curve: Curve | None
    options: dict[str, Any]
    drop: bool = False
    precision: float | None = None  # Half width over mean below which no packings are added
    where: dict[str, Any] = field(default_factory=dict)
    part: tuple[int, int] | None = None  # Cycles to skip and to evaluate after which runs stop; None for all

    # ---- description and checks

    @property
    def measured(self) -> list[Objective]:
        """Objectives that are measures of runs."""
        return [each for each in self.objectives if each.name not in (ADDED_MASS, DAMPING_RATIO)]

    @property
    def computed(self) -> list[Objective]:
        """Objectives that need runs, in the order of `Evaluation.values`."""
        return [each for each in self.objectives if each.name != ADDED_MASS]

    @property
    def directions(self) -> list[str]:
        """Direction of each objective as Optuna names it."""
        return ["maximize" if each.maximise else "minimize" for each in self.objectives]

    @cached_property
    def grid(self) -> Grid:
        """Grid of the runs of a trial."""
        return self.grid_of(self.case)

    def grid_of(self, case: Case) -> Grid:
        """Return the grid of the runs of a trial; one run of the case if nothing varies."""
        axes = [each for each in (self.levels, self.packings) if each is not None]
        return read_axes(case, axes or {"duration": [case.duration]}, source="levels")

    @property
    def stages(self) -> list[int]:
        """Numbers of packings after each of which a decision about a trial is taken; the last one is all."""
        stages = [FIRST if self.drop or self.precision is not None else self.count]
        while stages[-1] < self.count:
            stages.append(min(self.count, math.ceil(_GROWTH * stages[-1])))
        return stages

    @cached_property
    def parts(self) -> list[DesignSearch]:
        """The search after ever longer parts of runs, after which trials can be dropped; none if runs have no parts.

        A decay must pass all amplitudes, and the window of a measure may have to follow the transient of a structure, while
        the contents of a shaken cavity forget their start within some cycles.
        """
        if not self.drop or self.measured or self.curve is None or self.curve.way != "shaking":
            return []
        skip, kept = self.curve.cycles or CYCLES
        count = max(_FEWEST_CYCLES, math.ceil((skip + kept) / _SHORTER))
        parts = []
        while 2 * count <= skip + kept:
            skipped = min(max(1, round(count * skip / (skip + kept))), count - 2)  # a cycle in each half of the others
            parts.append(replace(self, part=(skipped, count - skipped)))
            count *= 2
        # A run of balls starts anew after each part, so that only one part is worth its cost.
        return parts if self.case.particle_dampers else parts[:1]

    @property
    def cycles(self) -> int:
        """Number of cycles of each run of a damping curve by shaking, before those that a run adds until it is steady."""
        return sum(self.part or instance(self.curve, Curve).cycles or CYCLES)

    def transient(self, short: Evaluation, cycles: int, changes: Sequence[Vector]) -> Vector:
        """Return by how much objectives may still change after parts of runs with some number of cycles, (objectives,).

        `changes`: objectives of complete trials over those after such parts, (objectives,) each.

        Notes
        -----
        A bed that compacts changes about as much in each doubling of the number of cycles, and any that relaxes changes
        less. The change from the first to the second half of the cycles is that of about one doubling. Changes that begin
        later show in complete trials only.
        """
        longest = self.cycles
        if instance(self.curve, Curve).cycles is None:
            longest += EXTENSIONS * CYCLES[1]
        ratio = np.max([np.fmax(change, 1 / change) for change in changes], axis=0)
        return np.asarray(math.log2(longest / cycles) * np.abs(short.drift) + (ratio - 1) * np.abs(short.values))

    def work_of(self, case: Case) -> Work:
        """Return the work that measures the runs of a trial."""
        measures = [each.measure for each in self.measured]
        return Work(engine_of(Variants(case, self.grid_of(case), measures, intervals=True, **self.options)))

    def curve_cases(self, case: Case) -> list[Case]:
        """Return the cases of a trial whose damping curves are computed, one for each level."""
        if self.curve is None or self.levels is None:
            return [] if self.curve is None else [case]
        grid = self.levels.grid(case)
        return [grid.case_at(case, index) for index in range(grid.size)]

    @property
    def curve_levels(self) -> list[str]:
        """Texts of the levels of the damping curves; one without levels."""
        if self.levels is None:
            return [""]
        grid = self.levels.grid(self.case)
        return [grid.describe_variant(self.case, index) for index in range(grid.size)]

    @property
    def curve_options(self) -> dict[str, Any]:
        """Arguments of `damping_curve` with all packings."""
        return {**vars(instance(self.curve, Curve)), "point": self.options["point"], "packings": self.count}

    def curve_runs(self, case: Case) -> list[Case]:
        """Return the runs of the damping curves of a trial."""
        return [run for each in self.curve_cases(case) for run in damping_curve_cases(each, **self.curve_options)]

    def validate(self, log: Sequence[str]) -> None:
        """Raise if the arguments are not valid for the case."""
        paths = [path for variable in self.variables for path in variable.paths]
        for path in log:
            if path not in paths:
                raise Hint(f"log = {path!r} is not one of the parameters", nearest(path, paths))
        varied: list[Parameter] = []
        for path in [*(self.grid.columns if self.levels or self.packings else ()), *paths]:
            new = Parameter(self.case, path, "parameters", materials_in(self.case))
            new.check_independent(varied)
            varied.append(new)
        check_names(each.measure for each in self.objectives)
        known_measures([each.measure for each in self.measured])
        if self.measured:
            self.work_of(self.case).validate()
        _ = self.curve_runs(self.case)
        self._check_designs("no design", {})
        for variable in self.variables:
            for label in variable.choices:
                self._check_designs(f"no design with {variable.name} = {label}", {variable.name: label})

    def _check_designs(self, none: str, chosen: Values) -> None:
        """Raise if none of some designs with some chosen values is valid; `none` names them in the message."""
        first: CaseError | None = None
        for values in self.sample(_PROBED):
            try:
                self.case_of({**values, **chosen})
                return
            except CaseError as error:
                first = first or error
        reason = str(first).removeprefix("case: ").replace("\n", "\n  ")
        raise CaseError(f"parameters: {none} is valid, for example because of\n  {reason}") from None

    def describe(self) -> dict[str, Any]:
        """Return a description of the search in JSON types."""
        functions = {
            each.name: fingerprint(each.measure) for each in self.objectives if not isinstance(each.measure, str)
        }
        curve = {} if self.curve is None else {"curve": vars(self.curve)}
        early: dict[str, Any] = {"drop": True} if self.drop else {}
        early |= {} if self.precision is None else {"precision": self.precision}
        early |= {"drop_cycles": [each.cycles for each in self.parts]} if self.parts else {}
        return {
            **describe_case(self.case, self.grid.columns),
            "parameters": {path: about for each in self.variables for path, about in each.describe().items()},
            "objective": {each.name: "max" if each.maximise else "min" for each in self.objectives},
            **({"functions": functions} if functions else {}),
            "trial": self.grid.describe(),
            **curve,
            "packings": self.count,
            **early,
            "robust": self.robust,
            "max_added_mass": self.limit,
            "options": self.options,
        }

    def layout(self) -> dict[str, Any]:
        """Return in JSON types what `open_trials` needs: the variables, and the attributes of the objectives."""
        return {
            "variables": [each.to_json() for each in self.variables],
            "objectives": {each.name: _with_goal(each) for each in self.objectives},
        }

    # ---- designs

    @cached_property
    def combinations(self) -> list[Values] | None:
        """All combinations of choices; None if a parameter has bounds, or there are more than `MOST_COMBINATIONS`."""
        if any(each.bounds for each in self.variables):
            return None
        if math.prod(len(each.choices) for each in self.variables) > MOST_COMBINATIONS:
            return None
        names = [each.name for each in self.variables]
        return [dict(zip(names, labels, strict=True)) for labels in product(*(v.choices for v in self.variables))]

    def sample(self, count: int) -> list[Values]:
        """Return random designs, or some or all of the combinations."""
        if self.combinations is not None:
            step = max(1, math.ceil(len(self.combinations) / count))
            return self.combinations[::step]
        generator = np.random.default_rng(0)
        return [{each.name: each.sample(generator) for each in self.variables} for _ in range(count)]

    def case_of(self, values: Values) -> Case:
        """Return the case of a design."""
        changes = [each.in_case(values[each.name]) for each in self.variables]
        case = replaced(self.case, {path: value for change in changes for path, value in change.items()})
        self.grid_of(case)  # raises if a level is not valid for the case
        return case

    def is_too_heavy(self, case: Case) -> bool:
        """Return whether the dampers of a case are heavier than the limit."""
        return self.limit is not None and added_mass(case) > self.limit

    def case_file(self, values: Values) -> str:
        """Return the case file of a design."""
        return self.case_of(values).to_toml()

    # ---- cost

    def predict(self, trials: int) -> Estimate:
        """Return the predicted cost of a number of trials: of all packings and cycles, and the least if trials end early."""
        designs = self.sample(_SAMPLED)
        costs = self._costs(designs)
        times, share = time_of_particle_runs(costs.groups) if costs.groups else ([], 1.0)
        trial, runs = self._time_of(costs, times, designs), costs.runs
        first = self.stages[0] / self.count
        early = trial * first
        if self.parts:
            early *= self.parts[0].cycles / self.cycles
            if not self.case.particle_dampers:  # the parts start anew
                trial, runs = trial + early, runs * (1 + first)
        cpu_time = START + trials * trial
        # At least one trial is complete, unless it is precise enough before.
        least = START + trials * early + (trial - early if self.precision is None else 0.0)
        workers = workers_of(self.where.get("backend", "threads"), self.where.get("workers"))
        wall_time = cpu_time / share / max(1, min(workers, runs))
        return Estimate(trials, round(trials * runs), cpu_time, wall_time, workers, least=min(least, cpu_time))

    def _costs(self, designs: Sequence[Values]) -> _Costs:
        """Return the runs of a trial, whose time is predicted, from some designs."""
        runs, others = 0, 0.0
        groups: list[RunGroup] = []
        for case in self._valid(designs):
            curves = self.curve_runs(case)
            sweep = self.grid.size if self.measured else 0
            runs += sweep + len(curves)
            if case.particle_dampers:
                groups += self._groups(case, sweep, curves)
            elif not others:  # 1-D designs cost about the same
                others = len(designs) * self._time_of_impact_runs(case, curves)
        return _Costs(runs / max(1, len(designs)), groups, others)

    def _time_of(self, costs: _Costs, times: Sequence[float], designs: Sequence[Values]) -> float:
        """Return the processor time of a trial [s]; `times`: those of the groups of particle runs [s]."""
        each = TRIAL + (sum(times) if costs.groups else costs.others) / max(1, len(designs))
        # If it is short, what is done beside the runs counts.
        return (self._time_of_trial(designs) or each) if each < _TINY else each

    def _time_of_trial(self, designs: Sequence[Values]) -> float:
        """Return the processor time of a trial [s], from the first packings of a few; 0 if there is no valid design."""
        times = []
        for values in designs:
            before = time.process_time()
            candidate = self.candidate(values)
            if candidate.case is not None:
                self.evaluate(candidate, self.stages[0])
                times.append(time.process_time() - before)
            if len(times) == _WHOLE_TRIALS:
                break
        # The first one also reads modules.
        return SEARCH + self.count / self.stages[0] * float(np.mean(times[1:] or times)) if times else 0.0

    def _valid(self, designs: Sequence[Values]) -> Iterator[Case]:
        """Yield the cases of the designs that a trial would run."""
        for values in designs:
            try:
                case = self.case_of(values)
            except CaseError:
                continue
            if not self.is_too_heavy(case):
                yield case

    def _groups(self, case: Case, sweep: int, curves: Sequence[Case]) -> list[RunGroup]:
        """Return the first and the last run of the sweep and of the curves of a trial for their halves."""
        ends = [(curves[index], len(curves) / 2) for index in ((0, -1) if curves else ())]
        if sweep:
            engine = instance(self.work_of(case).engine, ParticleEngine)
            ends += [(engine.variant(index), sweep / 2) for index in (0, sweep - 1)]
        # Each packing of each damper settles once. A shaken damper is alone in its run.
        beds = self.count * len(case.particle_dampers) / len(ends)
        groups = (RunGroup.of(each, runs, beds / len(each.particle_dampers)) for each, runs in ends)
        return [group for group in groups if group]

    def _time_of_impact_runs(self, case: Case, curves: Sequence[Case]) -> float:
        """Return the time of all runs of a trial with impact dampers, from a few of them [s]."""
        total = 0.0
        if self.measured:
            work = self.work_of(case)
            some = min(work.size, 4)
            before = time.process_time()
            work.run(Block(0, 0, some), None, threads=1, cancelled=None)
            total += (time.process_time() - before) * work.size / some
        if curves:
            before = time.process_time()
            simulate_many(curves[:1], progress=False)
            total += (time.process_time() - before) * len(curves)
        return total

    # ---- trials

    def candidate(self, values: Values) -> Candidate:
        """Return a design before its runs, with its mass [kg]."""
        try:
            case = self.case_of(values)
        except CaseError as error:
            return Candidate(None, refused=str(error))
        mass = added_mass(case)
        if self.is_too_heavy(case):
            return Candidate(None, mass, f"heavier than {self.limit:g} kg")
        return Candidate(case, mass)

    def evaluate(self, candidate: Candidate, count: int) -> Evaluation:
        """Return the result of a design from its first packings; only those that it lacks run."""
        if candidate.case is None:
            return self._nothing(candidate.refused)
        before = time.monotonic(), time.process_time()
        try:
            return self._run(candidate, candidate.case, count)
        except MeasureError:
            raise
        except RattleboxError as error:
            return self._nothing(str(error))
        finally:
            candidate.seconds += time.monotonic() - before[0], time.process_time() - before[1]

    def objective_values(self, mass: float, found: Evaluation) -> tuple[Vector, Vector]:
        """Return all objectives of a design, and half of the widths of their intervals, zero where it has none."""
        values = dict(zip((each.name for each in self.computed), found.values.tolist(), strict=True))
        halves = dict(zip(values, np.nan_to_num(found.intervals).tolist(), strict=True))
        names = [each.name for each in self.objectives]
        values[ADDED_MASS] = mass
        return np.array([values[name] for name in names]), np.array([halves.get(name, 0.0) for name in names])

    def is_precise(self, found: Evaluation) -> bool:
        """Return whether all intervals are as narrow as asked."""
        if self.precision is None:
            return False
        return bool(np.all(found.intervals <= self.precision * np.abs(found.values)))

    def _nothing(self, reason: str, missing: float = 1.0, warnings: int = 0) -> Evaluation:
        none = np.full(len(self.computed), np.nan)
        return Evaluation(none, none, np.full((none.size, self.count), np.nan), missing, warnings, reason)

    def _run(self, candidate: Candidate, case: Case, count: int) -> Evaluation:
        """Run a design with the packings that it lacks."""
        if self.measured and count > candidate.ran:
            self._measure(candidate, case, count)
        tables, missing, warnings = dict(candidate.tables), candidate.missing, candidate.warnings
        curves: Curves | None = None
        if self.curve is not None:
            curves, drift, names = self._curves(candidate, case, count)
            warnings |= sum(2**bit for bit, name in enumerate(FLAGS) if name in names)
            tables[DAMPING_RATIO] = curves.ratios.reshape(-1, count), None
            missing = max(missing, float(1 - np.isfinite(curves.ratios).mean()))
        candidate.ran = count
        if missing:
            nothing = self._nothing(candidate.reason or _reason(tables), missing, warnings)
            return replace(nothing, curves=curves)
        parts = [self._reduced(each, *tables[each.name]) for each in self.computed]
        values, halves, packings = (np.array(part) for part in zip(*parts, strict=True)) if parts else 3 * [np.zeros(0)]
        found = Evaluation(values, halves, packings.reshape(len(parts), count), 0.0, warnings, curves=curves)
        if curves is None or self.measured:
            return found
        late, early = (
            self._reduced(self.computed[0], tables[DAMPING_RATIO][0] + side * drift, None)[0] for side in (0.5, -0.5)
        )
        return replace(found, drift=np.array([late - early]))

    def _measure(self, candidate: Candidate, case: Case, count: int) -> None:
        """Add the measures of the packings that a design lacks to its tables."""
        part = self
        if count - candidate.ran < self.count:
            packings = parse_axes(self.case, packing_axis(self.case, count, candidate.ran), source="levels")
            part = replace(self, packings=packings, count=count - candidate.ran)
        work = part.work_of(case)
        runs = run_work(work, **self.where)
        candidate.reason = candidate.reason or work.first_refused(runs["status"].values)
        failed = runs["status"].values != 0
        if "warnings" in runs:
            candidate.warnings |= int(np.bitwise_or.reduce(runs["warnings"].values, axis=None))
        for each in self.measured:
            failed |= ~np.isfinite(runs[each.name].values)
            half = runs.get(each.name + INTERVAL)
            values, widths = part._table(runs[each.name]), None if half is None else part._table(half)
            if each.name in candidate.tables:
                before, widths_before = candidate.tables[each.name]
                values = np.hstack([before, values])
                widths = None if widths is None or widths_before is None else np.hstack([widths_before, widths])
            candidate.tables[each.name] = values, widths
        candidate.missing = max(candidate.missing, float(failed.mean()))

    def _table(self, values: xr.DataArray) -> Vector:
        """Return a result of a sweep as a table, (levels, packings)."""
        if PACKING not in values.dims:
            return np.asarray(values.values.reshape(-1, 1))
        return np.asarray(values.transpose(..., PACKING).values.reshape(-1, self.count))

    def _curves(self, candidate: Candidate, case: Case, count: int) -> tuple[Curves, Vector, set[str]]:
        """Return the damping curves of a trial, the drift of all values, (..., P), and the names of exceeded limits."""
        run: Evaluate = partial(evaluate_cases, **self.where)
        if len(self.stages) > 1:
            run = candidate.remember(run, self.part)
        options = {**self.curve_options, "packings": count, "part": self.part}
        found = [curve_from(run, each, **options) for each in self.curve_cases(case)]
        curves = Curves(
            np.array([each.damping_ratios.transpose("amplitude", "packing").values for each in found]),
            np.array([(each.upper - each.lower).values / 2 for each in found]),
            np.array([float(each.bare[0]) for each in found]),
        )
        drift = [each.drift.values.T if "drift" in each else np.zeros((each.amplitude.size, count)) for each in found]
        return curves, np.concatenate(drift), {name for each in found for name in each.attrs["exceeded"]}

    def _reduced(self, objective: Objective, values: Vector, half: Vector | None) -> tuple[float, float, Vector]:
        """Return an objective, half of the width of its interval, and its value for each packing.

        `values`: its values, (levels, P). `half`: half of the widths of the intervals of its values, (levels, P).
        """
        sign = objective.sign
        each = sign * _REDUCTIONS[self.robust](sign * values, axis=0)
        if each.size > 1:
            width = float(stdtrit(each.size - 1, 0.975)) * each.std(ddof=1) / math.sqrt(each.size)
        elif half is None:
            width = math.nan
        else:
            width = self._width(sign * values[:, 0], half[:, 0])
        return float(each.mean()), float(width), each

    def _width(self, values: Vector, half: Vector) -> float:
        """Return half of the width of the interval of a reduction from those of its independent values."""
        order = np.argsort(values, kind="stable")
        middle = order[(order.size - 1) // 2 : order.size // 2 + 1]
        used = {"worst": order[-1:], "mean": order, "median": middle}[self.robust]
        return float(np.linalg.norm(half[used]) / used.size)

    # ---- result

    def result(self, trials: Sequence[Any]) -> xr.Dataset:
        """Return the dataset of all trials and of the Pareto front."""
        import xarray as xr

        about = {
            name: value if isinstance(value, str) else json.dumps(value) for name, value in self.describe().items()
        }
        found = xr.Dataset(attrs={"title": "Rattlebox design", **about})
        for variable in self.variables:
            columns = variable.coordinates([trial.params[variable.name] for trial in trials])
            found = found.assign_coords({path: ("trial", *column) for path, column in columns.items()})
        values = _rows([trial.values for trial in trials], len(self.objectives))
        halves = _rows([trial.user_attrs["intervals"] for trial in trials], len(self.computed))
        packings = padded([trial.user_attrs["packings"] for trial in trials], self.count, len(self.computed))
        for number, each in enumerate(self.objectives):
            attrs = _attributes(each)
            found[each.name] = ("trial", values[:, number], _with_goal(each))
            if each.name == ADDED_MASS:
                continue
            own = self.computed.index(each)
            text = attrs["long_name"]
            width = attrs | {"long_name": f"half of the 95 % interval, {text}"}
            found[each.name + INTERVAL] = ("trial", halves[:, own], width)
            if self.count > 1:
                single = attrs | {"long_name": f"{text}, each packing"}
                found[f"{each.name}_packings"] = (("trial", PACKING), packings[:, own], single)
        if self.count > 1:
            found = found.assign_coords({PACKING: np.arange(self.count)})
        mass = np.array([trial.user_attrs[ADDED_MASS] for trial in trials], dtype=float)
        attrs = {"units": "kg", "long_name": "added mass"}
        found[ADDED_MASS] = ("trial", mass, found[ADDED_MASS].attrs | attrs if ADDED_MASS in found else attrs)
        missing = np.array([trial.constraints["missing"] for trial in trials])
        found["missing"] = ("trial", missing, {"units": "1", "long_name": "share of the runs without a value"})
        feasible = np.array([trial.values is not None for trial in trials], bool)
        found["feasible"] = ("trial", feasible, {"long_name": "within the limits, with a value of each run"})
        flags = {"long_name": "exceeded validity limits", **flag_masks(FLAGS)}
        exceeded = np.array([trial.user_attrs["warnings"] for trial in trials], np.int8)
        found["warnings"] = ("trial", exceeded, flags)
        reasons = np.array([trial.user_attrs["reason"] for trial in trials], dtype=object)
        found["reason"] = ("trial", reasons, {"long_name": "why a trial is not feasible"})
        if self.drop or self.precision is not None:
            dropped = np.array([trial.user_attrs[DROPPED] for trial in trials], bool)
            found[DROPPED] = "trial", dropped, {"long_name": "ended early, because certainly worse than another trial"}
            ran = {"units": "1", "long_name": "number of packings that ran"}
            found[PACKINGS_RUN] = "trial", [trial.user_attrs["ran"] for trial in trials], ran
        if self.parts:
            cycles = {"units": "1", "long_name": "number of cycles of each run, before those until it is steady"}
            found[CYCLES_RUN] = "trial", [trial.user_attrs["cycles"] for trial in trials], cycles
        front = pareto_front(values * np.array([each.sign for each in self.objectives]), feasible)
        if notes := [_exceeded(number, exceeded[number]) for number in front if exceeded[number]]:
            found.attrs["flagged"] = "; ".join(notes)
        cases = np.array([self.case_file(trials[number].params) for number in front], dtype=object)
        found = found.assign_coords(trial=np.arange(len(trials))).assign(
            front=("front", front, {"long_name": "number of the trial"}),
            case=("front", cases, {"long_name": "case file"}),
        )
        return self._with_evidence(found, trials)

    def _with_evidence(self, found: xr.Dataset, trials: Sequence[Any]) -> xr.Dataset:
        """Return a result with the damping curves, the trials that may be best, and notes about both."""
        found = with_order(found, [each.sign for each in self.objectives])
        if self.curve is not None:
            levels = self.curve_levels
            shape = len(levels), len(self.curve.amplitudes)
            stored = [trial.user_attrs["curves"] or (None, None, None) for trial in trials]
            ratios, halves, bare = zip(*stored, strict=True) if stored else ((), (), ())
            found = with_curves(
                found,
                padded(ratios, self.count, *shape),
                _rows(halves, *shape),
                _rows(bare, len(levels)),
                self.curve.amplitudes,
                levels,
                [np.shape(each)[-1] if each is not None else self.count for each in ratios],
            )
        if not found.front.size:
            found.attrs["warnings"] = [_none_feasible([str(reason) for reason in found.reason.values])]
        elif note := deciding_note(found):
            found.attrs["warnings"] = [note]
        if note := order_note(found):
            found.attrs["order"] = note
        return found

    def on(self, where: Mapping[str, object]) -> DesignSearch:
        """Return the search with the backend and the workers of a study (see `Study.where`)."""
        return replace(self, where={"backend": where["backend"], "workers": where["workers"], "progress": False})


def added_mass(case: Case) -> float:
    """Return the mass of all balls and particles of a case [kg]."""
    balls = sum(ball.weight for damper in case.impact_dampers for ball in damper.balls)
    return balls + sum(float(damper.contents.mass.sum()) for damper in case.particle_dampers)


def _reason(tables: dict[str, tuple[Vector, Vector | None]]) -> str:
    """Return which objectives lack a value."""
    names = [name for name, (values, _) in tables.items() if not np.isfinite(values).all()]
    if DAMPING_RATIO in names:
        return "some decays do not pass all amplitudes within the duration"
    return f"no {' and no '.join(names)} in some runs" if names else "some runs did not finish"


def _none_feasible(reasons: Sequence[str]) -> str:
    """Return a warning about a search without a feasible trial, with the most frequent reasons."""
    counts = Counter(reason.replace("\n", " ") for reason in reasons).most_common()
    shown = "; ".join(
        f"{count:,} of {len(reasons):,}: {' '.join(reason.split())}" for reason, count in counts[:_REASONS]
    )
    more = f"; and {len(counts) - _REASONS} more reasons" if len(counts) > _REASONS else ""
    return f"warning: no trial is feasible, and the result has no design ({shown}{more})"


def _exceeded(trial: int, warnings: int) -> str:
    """Return the validity limits that a trial exceeds."""
    return f"trial {trial}: {', '.join(text for bit, text in enumerate(FLAGS.values()) if warnings & 2**bit)}"


def _rows(rows: Sequence[object], *shape: int) -> Vector:
    """Return lists of numbers as an array; NaN for None."""
    nothing = np.full(shape, np.nan)
    return np.array([nothing if row is None else np.asarray(row, float).reshape(shape) for row in rows]).reshape(
        len(rows), *shape
    )


def padded(rows: Sequence[Any], count: int, *shape: int) -> Vector:
    """Return lists of numbers of some packings, (*shape, P), as an array of all `count` packings; NaN for the others."""
    array = np.full((len(rows), *shape, count), np.nan)
    for values, row in zip(array, rows, strict=True):
        if row is not None and np.size(row):
            known = np.array(row, float)
            values[..., : known.shape[-1]] = known
    return array


def _with_goal(objective: Objective) -> dict[str, str]:
    """Return the attributes of an objective in the result."""
    return _attributes(objective) | {"goal": "max" if objective.maximise else "min"}


def _attributes(objective: Objective) -> dict[str, str]:
    declared = about(objective.measure)
    return {"units": "1" if objective.name == DAMPING_RATIO else declared.units, "long_name": declared.long_name}
