"""Design search: parameters that minimise or maximise measures over load levels, start positions and packings."""

from __future__ import annotations

import math
import os
import time
import warnings
from dataclasses import KW_ONLY
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic.dataclasses import dataclass

from rattlebox._util.interrupts import deadline
from rattlebox._util.optional_imports import optional_import
from rattlebox._util.progress import announce, progress_bar
from rattlebox.model.errors import Hint
from rattlebox.studies.damping_curve import Way, mode_of, read_amplitudes
from rattlebox.studies.design.candidate import Curve
from rattlebox.studies.design.cost import predict
from rattlebox.studies.design.result import result_of
from rattlebox.studies.design.search import FIRST, DesignSearch, Robust
from rattlebox.studies.design.space import ADDED_MASS, DAMPING_RATIO, DesignVariable, read_objectives
from rattlebox.studies.design.trials import LAYOUT, Trials, load_study, number_of_trials, quiet, trial_storage
from rattlebox.studies.grid.axes import ParsedAxes, packing_axis, parse_axes, robust_axes
from rattlebox.studies.run.estimate import Estimate, duration
from rattlebox.studies.run.runner import Stopped
from rattlebox.studies.run.store import save_result
from rattlebox.studies.run.study import (
    CONFIG,
    Axes,
    Bounds,
    Count,
    Cycles,
    Fraction,
    Kilograms,
    Samples,
    Seconds,
    Seed,
    Study,
    TimeLimit,
    Values,
    split_bounds,
    study_function,
)

if TYPE_CHECKING:
    import xarray as xr

_SHOWN_FROM = 2.0
"""Predicted wall time from which it is printed without a given budget [s]."""


@dataclass(frozen=True, config=CONFIG)
class Design(Study):
    """Find parameters of a case that minimise or maximise a measure, or the Pareto front of several.

    Each trial runs a design at all levels, start positions and random packings, and reduces the results to one value for
    each objective. If all parameters have lists of choices with at most 100 combinations, every combination is a trial;
    otherwise the tree-structured Parzen estimator of Optuna suggests the trials. The same seed gives the same trials, also
    after a stop.

    Parameters
    ----------
    case
        Case with the values that do not vary, with impact dampers or particle dampers.
    parameters
        By path: a pair (smallest, largest) in round brackets, {"damper.gap": ("0.1 mm", "2 mm")}; or a list to choose from,
        {"damper.particles.diameter": ["4 mm", "6 mm"], "damper.number": [1, 2, 4]}; or a tuple of paths with a list for
        each, or a name with a mapping of paths to lists, for parameters that vary together, as for `rb.sweep`.
    objective
        Quantity to minimise: name of a measure (`rb.MEASURES`), "added_mass" (of all balls or particles), or a function of a
        Run. {"reduced_loss": "max"} maximises a measure. "damping_ratio" is that of a mode with its dampers over the
        `amplitudes`, and is maximised. Several, in a list or a mapping, give a Pareto front.
    levels
        Axes of load levels and directions as for `rb.sweep`, such as {"load.amplitude": ["1 kN", "5 kN"]} or
        {"damper.direction": ["x", "z"]}.
    starts
        Start positions of a single ball, or the number of evenly spaced ones from wall to wall; default that of the case.
    packings
        Number of random initial states: packings of particles, and positions of balls for a damping ratio. Default 3 with
        random packings, otherwise 1.
    drop
        Whether a trial ends before all its packings, or after few cycles, as soon as it is certainly worse than a complete
        trial; see Notes.
    precision
        Half width of the 95 % interval over the mean, such as 0.05, below which a trial ends before all its packings, in all
        objectives; default none.
    robust
        Reduction over levels, start positions and amplitudes: "worst", "mean" or "median". An objective is the mean of the
        reduced values of all packings.
    amplitudes, way, mode
        Amplitudes of the objective "damping_ratio", way of its computation, and number of the mode; see
        `rb.damping_curve`. Accelerations, such as "2 g", need a structure that no parameter changes.
    max_added_mass
        Upper limit of the mass of all balls or particles [kg].
    log
        Paths of parameters whose search is uniform in the logarithm.
    trials
        Number of trials; default 100, or all combinations.
    budget
        Longest wall time of this call, such as "10 min"; the search stops there with the trials that are finished. If more
        is predicted for all combinations or a given number of trials, even if they are dropped as early as they can be,
        nothing runs.
    seed
        Random seed of the trials.
    skip, cycles, samples, point, workers, backend
        See `rb.sweep`. Trials run one after the other; workers share the runs of a trial.
    store
        Folder for the trials. The same call resumes after a stop; a call with more trials continues.
    progress
        True for a progress bar after 2 s, False for none, or a function of the number of finished trials and of all; the
        study stops if it returns False. With True, the predicted time is printed if it is above 2 s or a budget is given.

    Returns
    -------
    xarray.Dataset
        Over `trial`: the parameters; each objective, with half of the width of its 95 % interval (`..._interval`) and, over
        `packing`, its value for each one (`..._packings`); `added_mass` [kg]; `missing`, the share of runs without a value
        (because they did not finish or never settled); `feasible`, whether no value is missing and the mass is within
        its limit, otherwise the `reason`; `warnings`, the exceeded validity limits of all runs (`flag_meanings`);
        `may_be_best`, whether it is on the front or cannot be excluded from it within the 95 % intervals. With a damping
        ratio, over `amplitude`, too (and `level`): `damping_curve`, its `..._interval` and `..._packings`; `bare`, of the
        structure alone; and, for the worst amplitude, `bare_decides`, whether the damper adds nothing there. With `drop` or
        `precision`: `dropped`, with the stage and the better trial in `reason`; `packings_run`, the number of packings that
        a trial has (the others are NaN); and, where trials can be dropped after few cycles, `cycles_run`. Over
        `front`: the numbers of the Pareto-optimal trials (of the best trial for one objective) and their case files; if no
        trial is feasible it is empty, and a warning, also in the attribute `warnings`, lists the reasons.
        Attributes: `predicted_wall_time` and `predicted_cpu_time` [s] of all trials before the first one, `wall_time`
        and, on threads, `cpu_time` [s] that they took; `order`, the trials that cannot be told apart; `at_end`, the
        parameters whose best value is the smallest or largest one of its list, or within 5 % of a bound, where values
        beyond it are valid; `flagged`, if a trial on the front exceeds validity limits; and `stopped`, if the budget ended
        the search.

    Raises
    ------
    CaseError
        If an argument is not valid for the case, no design is valid, or the predicted time exceeds the budget.
    StoreError
        If the store holds the trials of another study.
    MissingDependency
        If Optuna is not installed.
    Stopped
        After Ctrl-C.

    Notes
    -----
    The interval of an objective is that of Student's t over the packings, whose results are independent. For a single
    packing it follows from the intervals of the runs (see `rb.sweep`): of the worst run, of the middle ones, or of the mean
    of independent runs; NaN for measures without an interval.

    A trial with the objectives f dominates another one, g, if all f_k <= g_k and one f_k < g_k (of objectives to minimise).
    The front is the feasible trials that no other one dominates. A trial is excluded from it with certainty if one on the
    front dominates it even with f_k + its half width and g_k - its half width.

    With `drop` or `precision`, the first three packings of a trial run, then half as many again as it has, until all have
    run. After each step it is dropped if a complete trial (with all packings, or as precise as asked) excludes it from the
    front with certainty as above. Since three packings may agree by chance, intervals are here at least as wide as for the
    root mean square of the standard deviations of all trials. If all combinations are
    tried, the first packings of all run first, and those that are then best are completed first: this is the order of the
    trials. Decisions depend on results only, and are the same for any number of workers and after a stop. Predicted times
    are those of all packings, and the least time is stated, too.

    With `drop`, if damping ratios by "shaking" are the only objectives beside the mass and there are at least 16 cycles, the
    first packings stop after a quarter of the cycles, at least 8, and with particles after each doubling of them, as long as
    half of the cycles are left. If all combinations are tried, the best one after the first part is completed; after each
    part, each of the others is dropped if that one (otherwise any complete trial) excludes it as above, although its half
    width is increased by

        abs(d) log2(N / n) + abs(f) (r - 1)

    with its objective f after n cycles, the change d of f from the first to the second half of the evaluated cycles, the
    largest number N of cycles, and the ratio r, above one, by which the objective of the complete trial changed from then
    on. The first term bounds the change of a motion that relaxes, or compacts with the logarithm of time; the second one
    is for changes that begin later. Runs of particles that are left continue from there, up to 500 MB of their states in
    memory; others, and those of balls, start again. In both ways complete trials have the bits of a search without `drop`.

    `bare_decides`: at the amplitude with the least damping ratio the damper adds less than a tenth of the ratio of the
    structure alone, or less than the half width of the interval. A warning is issued if this holds for the best trial.

    References
    ----------
    K. Miettinen (1999), Nonlinear Multiobjective Optimization, Springer, doi:10.1007/978-1-4615-5563-6.
    J. Bergstra, R. Bardenet, Y. Bengio, B. Kegl (2011), Algorithms for hyper-parameter optimization, Advances in Neural
    Information Processing Systems 24.
    T. Akiba et al. (2019), Optuna, Proc. 25th ACM SIGKDD, 2623-2631, doi:10.1145/3292500.3330701.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.reference_case(rb.Tsuji(restitution=0.6), duration=8.0)
    >>> result = rb.design(case, {"damper.gap": ("0.1 mm", "2 mm")}, starts=3, trials=5)
    >>> best = rb.Case.from_toml(result.case.item(0))
    """

    kind: ClassVar[str] = "design"
    figure: ClassVar[str] = "rattlebox.plots.design:plot_design"
    report: ClassVar[str] = "rattlebox.report.kinds.design:KIND"

    parameters: Bounds
    objective: Any = "settling_time"
    _: KW_ONLY
    levels: Axes | None = None
    starts: Any = None
    packings: Count | None = None
    drop: bool = False
    precision: Fraction | None = None
    robust: Robust = "worst"
    amplitudes: Values | None = None
    way: Way = "decay"
    mode: Count = 1
    max_added_mass: Kilograms | None = None
    log: Any = ()
    trials: Count | None = None
    budget: TimeLimit | None = None
    seed: Seed = 0
    skip: Seconds = 0.0
    cycles: Cycles | None = None
    samples: Samples | None = None
    point: str | None = None

    @cached_property
    def _search(self) -> DesignSearch:
        parameters, log = split_bounds(self.parameters, self.log)
        objectives = read_objectives(self.objective)
        names = [each.name for each in objectives]
        measured = [name for name in names if name not in (ADDED_MASS, DAMPING_RATIO)]
        curve = mode = None
        if self.amplitudes is not None:
            # Keys are paths or tuples of several; amplitudes in g need one frequency of the mode for all trials and levels.
            if "structure" not in f"{list(parameters)} {list(self.levels or ())}":
                mode = mode_of(self.case, self.mode, self.point)
            amplitudes = tuple(read_amplitudes(self.amplitudes, None if mode is None else mode.omega).tolist())
            curve = Curve(amplitudes, self.way, self.mode, self.cycles)
        if (curve is None) == (DAMPING_RATIO in names):
            raise (
                Hint("the damping ratio requires amplitudes", 'amplitudes = ["20 um", "40 um", "80 um"]')
                if curve is None
                else Hint("amplitudes are those of the damping ratio, which is not an objective", '"damping_ratio"')
            )
        levels = robust_axes(self.case, self.levels, self.starts)
        count, packings = self._packings(bool(measured))
        search = DesignSearch(
            case=self.case,
            variables=[DesignVariable.read(self.case, key, each, log) for key, each in parameters.items()],
            objectives=objectives,
            levels=parse_axes(self.case, levels, source="levels") if levels else None,
            packings=packings,
            count=count,
            drop=self.drop,
            precision=self.precision,
            robust=self.robust,
            limit=None if self.max_added_mass is None else float(self.max_added_mass),
            curve=curve,
            frequency=None if mode is None else mode.frequency,
            options={
                "skip": float(self.skip),
                "cycles": self.cycles,
                "samples": self.samples,
                "point": self.point,
            },
        )
        if (self.drop or self.precision is not None) and count < FIRST + (not search.parts):
            name = "drop" if self.drop else "precision"
            raise Hint(
                f"{name} decides after {FIRST} packings, and packings = {count} has no more of them",
                f"packings = 12, or no {name}",
            )
        return search

    def _packings(self, measured: bool) -> tuple[int, ParsedAxes | None]:
        """Return the number of random initial states, and the axis of random packings."""
        if not self.case.particle_dampers:
            if measured and (self.packings or 1) > 1:
                raise Hint(f"packings = {self.packings} are those of particle dampers", f"starts = {self.packings}")
            return self.packings or (1 if measured else 3), None
        random = any(damper.packing.is_random for damper in self.case.particle_dampers)
        count = self.packings or (3 if random else 1)
        return count, parse_axes(self.case, packing_axis(self.case, count), source="levels") if count > 1 else None

    def validate(self) -> None:
        """Raise if the fields are not valid; see `Study.validate`."""
        self._search.validate(split_bounds(self.parameters, self.log)[1])

    def predict(self) -> Estimate:
        """Return the estimate of all trials; see `Study.estimate`."""
        optional_import("optuna", "design")  # the import is no part of the trials
        search = self._search.on(self.where)
        return predict(search, number_of_trials(search, self.trials))

    def compute(self) -> xr.Dataset:
        """Run the trials; see `Study.compute`."""
        from rattlebox import __version__

        store, stopped = self.store, {}
        end = math.inf if self.budget is None else time.monotonic() + float(self.budget)
        search = self._search.on(self.where)
        optuna = optional_import("optuna", "design")
        about = {"version": __version__, "seed": self.seed, **search.describe()}
        with quiet(optuna), trial_storage(optuna, store) as storage:
            study = load_study(optuna, storage, search.directions, about, store)
            study.set_user_attr(LAYOUT, search.layout())
            trials = Trials(optuna, study, search, self.seed, self.trials)
            try:
                with deadline(end):
                    self._check_budget(search, trials)
                    with progress_bar(self.progress, "trials") as report:
                        while trials.done < trials.total:
                            report.advance(trials.done, trials.total)
                            trials.run_next()
                        report(trials.total, trials.total)
            except KeyboardInterrupt:
                if time.monotonic() < end:
                    raise _stopped(trials, store) from None
                stopped = self._out_of_time(trials)
            found = result_of(search, trials.finished)
        for line in found.attrs.get("warnings", ()):
            warnings.warn(line.removeprefix("warning: "), stacklevel=4)
        return save_result(
            found.assign_attrs({"version": __version__, "seed": self.seed} | trials.times | stopped), self.kind, store
        )

    def _check_budget(self, search: DesignSearch, trials: Trials) -> None:
        """Predict the time of the trials that are left, and print it."""
        left = trials.total - trials.done
        if not left:
            return
        predicted = predict(search, left)
        line, wall = f"design: {predicted}", predicted.wall_time
        least = wall if predicted.least is None else wall * predicted.least / predicted.cpu_time
        allowed = math.inf if self.budget is None else float(self.budget)
        if wall > allowed:
            given, fitting = duration(allowed), math.floor(left * allowed / wall)
            if least > allowed and (self.trials is not None or search.combinations is not None or not fitting):
                fewer = f"trials = {fitting}, " if fitting else ""
                raise Hint(
                    f"budget = {given} is less than predicted for {predicted}",
                    f'{fewer}budget = "{duration(1.2 * wall)}", fewer levels, packings or particles, or more softening',
                )
            end = f"about {fitting} trials" if least == wall else "perhaps not all trials are"
            line += f"; {end} within the budget of {given}"
        if self.budget is not None or wall > _SHOWN_FROM:
            announce(self.progress, line)
        trials.store_prediction(predicted)

    def _out_of_time(self, trials: Trials) -> dict[str, str]:
        """Return the attribute of a search that the budget ended."""
        given = duration(float(self.budget or 0))
        if not trials.done:
            raise Hint(f"the budget of {given} ended before the first trial", "a longer budget, or fewer levels")
        line = f"stopped at the budget of {given} after {trials.done} of {trials.total} trials"
        announce(self.progress, f"design: {line}")
        return {"stopped": line}


design = study_function(Design)


def _stopped(trials: Trials, store: Any) -> Stopped:
    """Return the exception after Ctrl-C."""
    where = "which are lost; use a store to resume"
    if store is not None:
        where = f"which are in {os.fspath(store)}, and the same command resumes from there"
    return Stopped(f"stopped after {trials.done} of {trials.total} trials, {where}")
