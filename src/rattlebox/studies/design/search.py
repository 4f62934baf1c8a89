"""Trials of a design search: their cases, runs and objectives."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import product
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from rattlebox._util.exceptions import CaseError, RattleboxError
from rattlebox._util.narrow import instance
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint, nearest
from rattlebox.model.paths import replaced
from rattlebox.prepare.time_step import WARNINGS
from rattlebox.studies.damping_curve import CYCLES, OTHER_MOTION, Evaluate, curve_from, damping_curve_cases
from rattlebox.studies.design.candidate import Candidate, Curve, Curves, Evaluation, added_mass, reason_of
from rattlebox.studies.design.space import ADDED_MASS, DAMPING_RATIO, DesignVariable, Objective
from rattlebox.studies.grid.axes import ParsedAxes, materials_in, packing_axis, parse_axes, read_axes
from rattlebox.studies.grid.grid import Grid, Parameter
from rattlebox.studies.run.runner import evaluate_cases, run_work
from rattlebox.studies.run.study import known_measures
from rattlebox.studies.work.measures import INTERVAL, check_names
from rattlebox.studies.work.particles import EXTENSIONS, engine_of
from rattlebox.studies.work.variants import MeasureError, Variants, describe_case, fingerprint
from rattlebox.studies.work.work import Work

if TYPE_CHECKING:
    import xarray as xr


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

_PROBED = 64
"""Number of designs of which at least one must be valid."""
_REDUCTIONS: dict[str, Any] = {"worst": np.max, "mean": np.mean, "median": np.median}


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
    frequency: float | None = None  # Natural frequency of the mode [Hz]; None if it may vary
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
            "objectives": {each.name: each.attributes_with_goal for each in self.objectives},
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
            nothing = self._nothing(candidate.reason or reason_of(tables), missing, warnings)
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

    def on(self, where: Mapping[str, object]) -> DesignSearch:
        """Return the search with the backend and the workers of a study (see `Study.where`)."""
        return replace(self, where={"backend": where["backend"], "workers": where["workers"], "progress": False})
