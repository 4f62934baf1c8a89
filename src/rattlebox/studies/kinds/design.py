"""Design search: parameters that minimise or maximise measures over load levels and start positions."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import KW_ONLY, dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass as pydantic_dataclass

from rattlebox._util.exceptions import CaseError
from rattlebox._util.optional_imports import optional_import
from rattlebox._util.progress import progress_bar
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint, nearest
from rattlebox.model.paths import replaced
from rattlebox.studies.axes import materials_in, read_axes
from rattlebox.studies.case_digest import describe_case
from rattlebox.studies.design_space import ADDED_MASS, DesignVariable, Objective, pareto_front, read_objectives
from rattlebox.studies.fingerprint import fingerprint
from rattlebox.studies.grid import Grid
from rattlebox.studies.impact_work import ImpactWork
from rattlebox.studies.kinds.sweep import Sweep
from rattlebox.studies.measures import MEASURES, check_names
from rattlebox.studies.parameter import Parameter
from rattlebox.studies.robust import robust_axes
from rattlebox.studies.runner import Stopped
from rattlebox.studies.store import save_result
from rattlebox.studies.study import (
    CONFIG,
    Axes,
    Bounds,
    Count,
    Cycles,
    Kilograms,
    Samples,
    Seconds,
    Seed,
    Study,
    known_measures,
    split_bounds,
    study_function,
)
from rattlebox.studies.trial_store import finished_trials, load_study, quiet, trial_seed, trial_storage

if TYPE_CHECKING:
    import xarray as xr

Robust = Literal["worst", "mean", "median"]
Vector = NDArray[np.float64]


@pydantic_dataclass(frozen=True, config=CONFIG)
class Design(Study):
    """Find parameters of a case that minimise or maximise a measure, or the Pareto front of several.

    Each trial is a sweep over all levels and starts, reduced to one value per objective. The tree-structured Parzen
    estimator of Optuna suggests the trials. The same seed gives the same trials, also after a stop.

    Parameters
    ----------
    case
        Case with the values that do not vary.
    parameters
        By path: a pair (smallest, largest) in round brackets, {"damper.gap": ("0.1 mm", "2 mm")}; or a list to choose from,
        {"damper.ball.diameter": ["10 mm", "12 mm", "15 mm"], "damper.ball.material": ["steel", "brass"]}.
    objective
        Quantity to minimise: name of a measure (`rb.MEASURES`), "added_mass" (of the balls), or a function of a Run.
        {"reduced_loss": "max"} maximises a measure. Several, in a list or a mapping, give a Pareto front.
    levels
        Axes of load levels as for `rb.sweep`, such as {"load.amplitude": ["1 kN", "5 kN"]}.
    starts
        Start positions of the ball, or the number of evenly spaced ones from wall to wall; default that of the case.
    robust
        Reduction over all levels and starts: "worst", "mean" or "median".
    max_added_mass
        Upper limit of the mass of all balls [kg].
    log
        Paths of parameters whose search is uniform in the logarithm.
    trials
        Number of trials.
    seed
        Random seed of the trials.
    skip, cycles, samples, point, workers, backend
        See `rb.sweep`. Trials run one after the other; workers share the levels and starts of a trial.
    store
        Folder for the trials. The same call resumes after a stop; a call with more trials continues.
    progress
        True for a progress bar after 2 s, False for none, or a function of the number of finished trials and of all; the
        study stops if it returns False.

    Returns
    -------
    xarray.Dataset
        Over `trial`: the parameters; the objectives; `added_mass` [kg]; `missing`, the share of runs without a value
        (because they did not finish or never settled); `feasible`, whether no value is missing and the mass is within
        its limit. Over `front`: the numbers of the Pareto-optimal trials (of the best trial for one objective) and their
        case files.

    Raises
    ------
    CaseError
        If an argument is not valid for the case.
    StoreError
        If the store holds the trials of another study.
    MissingDependency
        If Optuna is not installed.
    Stopped
        After Ctrl-C.

    References
    ----------
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

    parameters: Bounds
    objective: Any = "settling_time"
    _: KW_ONLY
    levels: Axes | None = None
    starts: Any = None
    robust: Robust = "worst"
    max_added_mass: Kilograms | None = None
    log: Any = ()
    trials: Count = 100
    seed: Seed = 0
    skip: Seconds = 0.0
    cycles: Cycles | None = None
    samples: Samples | None = None
    point: str | None = None

    @cached_property
    def _search(self) -> _Search:
        parameters, log = split_bounds(self.parameters, self.log)
        return _Search(
            case=self.case,
            variables=[DesignVariable.read(self.case, path, each, path in log) for path, each in parameters.items()],
            objectives=read_objectives(self.objective),
            axes=robust_axes(self.case, self.levels, self.starts),
            robust=self.robust,
            limit=None if self.max_added_mass is None else float(self.max_added_mass),
            options={
                "skip": float(self.skip),
                "cycles": self.cycles,
                "samples": self.samples,
                "point": self.point,
            },
        )

    def validate(self) -> None:
        """Raise if the fields are not valid; see `Study.validate`."""
        self._search.check(self.log)

    def compute(self) -> xr.Dataset:
        """Run the trials; see `Study.compute`."""
        from rattlebox import __version__

        done, store = 0, self.store
        search = replace(self._search, where={**self.where, "store": None, "progress": False})
        try:
            optuna = optional_import("optuna", "design")
            about = {"version": __version__, "seed": self.seed}
            with (
                quiet(optuna),
                trial_storage(optuna, store) as storage,
                progress_bar(self.progress, "trials") as report,
            ):
                study = load_study(optuna, storage, search.directions, {**about, **search.describe()}, store)
                while (done := len(finished_trials(optuna, study))) < self.trials:
                    report.advance(done, self.trials)
                    study.sampler = optuna.samplers.TPESampler(seed=trial_seed(self.seed, done))
                    search.run_trial(optuna, study)
                report(self.trials, self.trials)
                found = search.result(finished_trials(optuna, study)[: self.trials])
            return save_result(found, self.kind, store)
        except KeyboardInterrupt:
            trials = "which are lost; use a store to resume"
            if store is not None:
                trials = f"which are in {os.fspath(store)}, and the same command resumes from there"
            raise Stopped(f"stopped after {done} of {self.trials} trials, {trials}") from None


design = study_function(Design)
"""Run a study of this kind: see `Design`."""


@dataclass(frozen=True)
class _Search:
    """A design search: variables, objectives and the runs of a trial."""

    case: Case
    variables: list[DesignVariable]
    objectives: list[Objective]
    axes: list[Any]
    robust: Robust
    limit: float | None
    options: dict[str, Any]
    where: dict[str, Any] = field(default_factory=dict)

    def check(self, log: Sequence[str]) -> None:
        """Raise if the arguments are not valid for the case."""
        paths = [variable.path for variable in self.variables]
        for path in (log,) if isinstance(log, str) else log:
            if path not in paths:
                raise Hint(f"log = {path!r} is not one of the parameters", nearest(path, paths))
        varied: list[Parameter] = []
        for path in [*(self.trial_grid.columns if self.axes else ()), *paths]:
            new = Parameter(self.case, path, "parameters", materials_in(self.case))
            new.check_independent(varied)
            varied.append(new)
        check_names(each.measure for each in self.objectives)
        measures = known_measures([each.measure for each in self.run_objectives])
        ImpactWork(self.case, self.trial_grid, measures=measures, **self.options).validate()

    @cached_property
    def trial_grid(self) -> Grid:
        """Grid of the runs of a trial."""
        return read_axes(self.case, self.axes_of(self.case), source="levels")

    def axes_of(self, case: Case) -> list[Any]:
        """Return the axes of a trial; one run of the case if there are none."""
        return self.axes or [{"duration": [case.duration]}]

    @property
    def run_objectives(self) -> list[Objective]:
        """Objectives that need runs."""
        return [each for each in self.objectives if each.name != ADDED_MASS]

    @property
    def directions(self) -> list[str]:
        """Direction of each objective as Optuna names it."""
        return ["maximize" if each.maximise else "minimize" for each in self.objectives]

    def describe(self) -> dict[str, Any]:
        """Return a description of the search in JSON types."""
        functions = {
            each.name: fingerprint(each.measure) for each in self.objectives if not isinstance(each.measure, str)
        }
        return {
            **describe_case(self.case, self.trial_grid.columns),
            "parameters": {variable.path: variable.describe() for variable in self.variables},
            "objective": {each.name: "max" if each.maximise else "min" for each in self.objectives},
            **({"functions": functions} if functions else {}),
            "trial": self.trial_grid.describe(),
            "robust": self.robust,
            "max_added_mass": self.limit,
            "options": self.options,
        }

    def run_trial(self, optuna: Any, study: Any) -> None:
        """Run the trial that the sampler suggests, and report its objectives to the study."""
        trial = study.ask()
        parameters = {variable.path: variable.suggest(trial) for variable in self.variables}
        values, mass = np.full(len(self.run_objectives), np.nan), np.nan
        missing = 1.0
        valid: Case | None = None
        with suppress(CaseError):  # the parameters may not be valid together
            case = replaced(self.case, parameters)
            mass = sum(ball.weight for damper in case.impact_dampers for ball in damper.balls)
            read_axes(case, self.axes_of(case))
            valid = case
        if valid and (self.limit is None or mass <= self.limit):
            values, missing = self.evaluate(valid)
        excess = 0.0 if self.limit is None or not mass > self.limit else mass / self.limit - 1
        trial.set_constraint("missing", missing)
        trial.set_constraint(ADDED_MASS, excess)
        trial.set_user_attr(ADDED_MASS, None if np.isnan(mass) else mass)
        if missing or excess:
            study.tell(trial, state=optuna.trial.TrialState.PRUNED)
            return
        by_name = dict(zip([each.name for each in self.run_objectives], values.tolist(), strict=True))
        by_name[ADDED_MASS] = mass
        study.tell(trial, [by_name[each.name] for each in self.objectives])

    def evaluate(self, case: Case) -> tuple[Vector, float]:
        """Run a design at all levels and starts; return the objectives and the share of runs without a value."""
        measures = [each.measure for each in self.run_objectives]
        runs = Sweep(case, self.axes_of(case), measures, **self.options).run(**self.where)
        values = np.array([runs[each.name].values.ravel() for each in self.run_objectives])
        missing = ~np.isfinite(values).all(axis=0) | (runs["status"].values.ravel() != 0)
        if missing.any():
            return np.full(len(values), np.nan), float(missing.mean())
        signs = np.array([each.sign for each in self.run_objectives])
        return signs * _REDUCTIONS[self.robust](signs[:, None] * values, axis=1), 0.0

    def result(self, trials: Sequence[Any]) -> xr.Dataset:
        """Return the dataset of all trials and of the Pareto front."""
        import xarray as xr

        masses = np.array([trial.user_attrs[ADDED_MASS] for trial in trials], dtype=float)
        missing = np.array([trial.constraints["missing"] for trial in trials])
        values = np.array([trial.values or [np.nan] * len(self.objectives) for trial in trials])
        about = {
            name: value if isinstance(value, str) else json.dumps(value) for name, value in self.describe().items()
        }
        found = xr.Dataset(attrs={"title": "Rattlebox design", **about})
        for variable in self.variables:
            column = [trial.params[variable.path] for trial in trials]
            found = found.assign_coords({variable.path: ("trial", column, variable.attrs)})
        for each, column in zip(self.objectives, values.T, strict=True):
            attrs = {"units": "", "long_name": each.name.replace("_", " ")}
            if each.name in MEASURES:
                attrs = {"units": MEASURES[each.name].units, "long_name": MEASURES[each.name].long_name}
            found[each.name] = ("trial", column, attrs | {"goal": "max" if each.maximise else "min"})
        mass = {"units": "kg", "long_name": "mass of the balls"}
        found[ADDED_MASS] = ("trial", masses, found[ADDED_MASS].attrs | mass if ADDED_MASS in found else mass)
        found["missing"] = ("trial", missing, {"units": "1", "long_name": "share of the runs without a value"})
        feasible = np.array([trial.values is not None for trial in trials])
        found["feasible"] = ("trial", feasible, {"long_name": "within the limits, with a value of each run"})
        front = pareto_front(values * np.array([each.sign for each in self.objectives]), feasible)
        cases = []
        for number in front:
            values = trials[number].params
            parameters = {each.path: each.choices.get(values[each.path], values[each.path]) for each in self.variables}
            cases.append(replaced(self.case, parameters).to_toml())
        return found.assign_coords(trial=np.arange(len(trials))).assign(
            front=("front", front, {"long_name": "number of the trial"}),
            case=("front", np.array(cases, dtype=object), {"long_name": "case file"}),
        )


_REDUCTIONS: dict[str, Any] = {"worst": np.max, "mean": np.mean, "median": np.median}
