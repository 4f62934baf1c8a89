"""The best design: parameters within bounds that make a measure small over load levels and start positions."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import KW_ONLY, dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass as pydantic_dataclass

from rattlebox._util.exceptions import CaseError, StoreError
from rattlebox._util.optional_imports import optional_import
from rattlebox._util.owned_folder import read_marker
from rattlebox._util.progress import progress_bar
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint, nearest
from rattlebox.model.paths import replaced
from rattlebox.studies.axes import materials_in, read_axes
from rattlebox.studies.case_digest import describe_case
from rattlebox.studies.fingerprint import fingerprint
from rattlebox.studies.grid import Grid, labels
from rattlebox.studies.impact_work import ImpactWork
from rattlebox.studies.kinds.sweep import Sweep
from rattlebox.studies.measures import check_names
from rattlebox.studies.parameter import Parameter
from rattlebox.studies.robust import robust_axes
from rattlebox.studies.runner import Stopped
from rattlebox.studies.store import JOURNAL, exclusive_writer, keep_map
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

if TYPE_CHECKING:
    import xarray as xr

    from rattlebox.results import Run

Robust = Literal["worst", "mean", "median"]
Vector = NDArray[np.float64]

_MASS = "added_mass"


@pydantic_dataclass(frozen=True, config=CONFIG)
class Design(Study):
    """Find parameters of a case that make a measure small, or a trade-off between several.

    Each trial is a sweep over all levels and starts, of which the worst counts. Optuna's tree of Parzen estimators proposes
    the trials; the same seed gives the same ones, however often they were stopped.

    Parameters
    ----------
    case
        The case, with the values that stay as they are.
    parameters
        By path: a pair (smallest, largest) in round brackets, {"damper.gap": ("0.1 mm", "2 mm")}; or a list to choose from,
        {"damper.ball.diameter": ["10 mm", "12 mm", "15 mm"], "damper.ball.material": ["steel", "brass"]}.
    objective
        What shall be small: the name of a measure (rb.MEASURES), "added_mass" (of the balls), or a function of a Run;
        {"reduced_loss": "max"} for what shall be large. Several, in a list or a mapping, give a Pareto front.
    levels
        Axes of loads that the design must serve, {"load.amplitude": ["1 kN", "5 kN"]}, as for `rb.sweep`.
    starts
        Start positions of the ball; a number spreads so many evenly from wall to wall. Default the case's own.
    robust
        What counts of all levels and starts: the "worst", the "mean" or the "median".
    max_added_mass
        Limit of the mass of all balls [kg].
    log
        Paths of parameters that are searched in their logarithm.
    trials
        How many.
    seed
        The same seed gives the same trials.
    skip, cycles, samples, point, workers, backend
        See `rb.sweep`. Trials run one after the other; workers share the levels and starts of each.
    store
        Folder that keeps all trials: the same call goes on after a stop, and one with more trials goes further.
    progress
        True for a progress bar after 2 s, False for none, or a function of the numbers of trials done and of all,
        which stops the study by returning False.

    Returns
    -------
    xarray.Dataset
        Over `trial`: the parameters, the objectives, added_mass, missing (share of the runs that gave no value: they did not
        finish, or never settled) and feasible (nothing is missing, and the mass is within its limit). Over `front`: the
        numbers of the best trial, or of those that no other is better than in everything, and their case files.

    Raises
    ------
    CaseError
        When an argument does not fit, Optuna is not installed, or the store holds the trials of another study.
    Stopped
        After Ctrl-C.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.reference_case(rb.Tsuji(restitution=0.6), duration=8.0)
    >>> found = rb.design(case, {"damper.gap": ("0.1 mm", "2 mm")}, starts=3, trials=5)
    >>> best = rb.Case.from_toml(found.case.item(0))
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
            parameters=[_Parameter.of(self.case, path, given, path in log) for path, given in parameters.items()],
            goals=_goals(self.objective),
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
        """Raise if the fields do not fit the case or each other; see `Study.validate`."""
        self._search.check(self.log)

    def compute(self) -> xr.Dataset:
        """Run the trials; see `Study.compute`."""
        done, store = 0, self.store
        search = replace(self._search, where={**self.where, "store": None, "progress": False})
        try:
            optuna = optional_import("optuna", "design")
            with (
                _quiet(optuna),
                _storage(optuna, store) as storage,
                progress_bar(self.progress, "trials") as report,
            ):
                trials = _study(optuna, storage, search, self.seed, store)
                while (done := len(_told(optuna, trials))) < self.trials:
                    report.advance(done, self.trials)
                    trials.sampler = optuna.samplers.TPESampler(seed=_seed(self.seed, done))
                    search.run_trial(optuna, trials)
                report(self.trials, self.trials)
                found = search.result(_told(optuna, trials)[: self.trials])
            return keep_map(found, self.kind, store)
        except KeyboardInterrupt:
            kept = "which are lost; a store would have kept them"
            if store is not None:
                kept = f"which are in {os.fspath(store)}, and the same command resumes from there"
            raise Stopped(f"stopped after {done} of {self.trials} trials, {kept}") from None


design = study_function(Design)
"""Run a study of this kind: see `Design`."""


@dataclass(frozen=True)
class _Parameter:
    """What may be chosen of one parameter: numbers between two, or one of some things by name."""

    path: str
    bounds: tuple[float, float] | None
    choices: dict[Any, Any]
    log: bool
    attrs: dict[str, str]

    @classmethod
    def of(cls, case: Case, path: Any, given: Any, log: bool) -> _Parameter:
        parameter = Parameter(case, path, "parameters", materials_in(case))
        ranged = isinstance(given, tuple)
        if ranged and len(given) != 2:
            raise parameter.wrong("a pair (smallest, largest) is needed, or a list to choose from", "", None, given)
        values = parameter.values(list(given) if ranged else given)
        if parameter.is_start and values.unit == "m":
            raise parameter.wrong("a length, but the gap may vary", "fractions of the gap, -1 to 1", None, given)
        attrs = {"long_name": parameter.path.replace(".", " ").replace("_", " ")}
        if values.unit is not None:
            attrs["units"] = values.unit
        if not ranged:
            names = labels(values.array) if values.unit is None else values.array
            return cls(
                parameter.path, None, dict(zip(names.tolist(), values.array.tolist(), strict=True)), False, attrs
            )
        if values.unit is None:
            raise parameter.wrong("it has no bounds, being no number", "a list to choose from, in square brackets")
        low, high = values.array.tolist()
        if not low < high or (log and low <= 0):
            least = " and greater than zero" if log else ""
            raise parameter.wrong(f"the first must be the smaller one{least}", "", None, given)
        return cls(parameter.path, (low, high), {}, log, attrs)

    def propose(self, trial: Any) -> Any:
        if self.bounds:
            return trial.suggest_float(self.path, *self.bounds, log=self.log)
        return self.choices[trial.suggest_categorical(self.path, list(self.choices))]

    def describe(self) -> dict[str, Any]:
        return {"bounds": self.bounds, "choices": [str(name) for name in self.choices], "log": self.log}


@dataclass(frozen=True)
class _Goal:
    """One objective."""

    measure: str | Callable[[Run], float]
    largest: bool

    @property
    def name(self) -> str:
        return self.measure if isinstance(self.measure, str) else getattr(self.measure, "__name__", repr(self.measure))

    @property
    def sign(self) -> float:
        return -1.0 if self.largest else 1.0


def _goals(objective: Any) -> list[_Goal]:
    """The objectives with their directions."""
    if isinstance(objective, str) or not hasattr(objective, "__iter__"):
        objective = [objective]
    given = dict(objective) if isinstance(objective, Mapping) else dict.fromkeys(objective, "min")
    if not given:
        raise Hint("objective: there is none", '"settling_time"')
    for name, direction in given.items():
        if direction not in ("min", "max"):
            raise Hint(f"objective: {name} = {direction!r}", '"min" or "max"')
    goals = [_Goal(measure, direction == "max") for measure, direction in given.items()]
    if [goal.name for goal in goals] == [_MASS]:
        raise Hint("objective: the smallest added mass is that of the smallest ball", '["added_mass", "settling_time"]')
    return goals


@dataclass(frozen=True)
class _Search:
    """What is looked for."""

    case: Case
    parameters: list[_Parameter]
    goals: list[_Goal]
    axes: list[Any]
    robust: Robust
    limit: float | None
    options: dict[str, Any]
    where: dict[str, Any] = field(default_factory=dict)

    def check(self, log: Sequence[str]) -> None:
        """Refuse what no trial could use."""
        paths = [parameter.path for parameter in self.parameters]
        for path in (log,) if isinstance(log, str) else log:
            if path not in paths:
                raise Hint(f"log = {path!r}: there is no parameter of that name", nearest(path, paths))
        together: list[Parameter] = []
        for path in [*(self.members.columns if self.axes else ()), *paths]:
            new = Parameter(self.case, path, "parameters", materials_in(self.case))
            new.check_beside(together)
            together.append(new)
        check_names(goal.measure for goal in self.goals)
        measures = known_measures([goal.measure for goal in self.measured])
        ImpactWork(self.case, self.members, measures=measures, **self.options).validate()

    @cached_property
    def members(self) -> Grid:
        """The runs of a trial."""
        return read_axes(self.case, self.axes_of(self.case), source="levels")

    def axes_of(self, case: Case) -> list[Any]:
        """The axes over which a design is judged; without any it is run once."""
        return self.axes or [{"duration": [case.duration]}]

    @property
    def measured(self) -> list[_Goal]:
        """Objectives that need runs."""
        return [goal for goal in self.goals if goal.name != _MASS]

    def describe(self) -> dict[str, Any]:
        """What tells this search from others, in JSON's types."""
        functions = {goal.name: fingerprint(goal.measure) for goal in self.goals if not isinstance(goal.measure, str)}
        return {
            **describe_case(self.case, self.members.columns),
            "parameters": {parameter.path: parameter.describe() for parameter in self.parameters},
            "objective": {goal.name: "max" if goal.largest else "min" for goal in self.goals},
            **({"functions": functions} if functions else {}),
            "members": self.members.describe(),
            "robust": self.robust,
            "max_added_mass": self.limit,
            "options": self.options,
        }

    # ---- one trial

    def run_trial(self, optuna: Any, study: Any) -> None:
        """Let the sampler propose parameters, and tell it what they give."""
        trial = study.ask()
        values = {parameter.path: parameter.propose(trial) for parameter in self.parameters}
        found, mass = np.full(len(self.measured), np.nan), np.nan
        missing = 1.0
        fitting: Case | None = None
        with suppress(CaseError):  # the parameters do not fit together
            case = replaced(self.case, values)
            mass = sum(ball.weight for damper in case.impact_dampers for ball in damper.balls)
            read_axes(case, self.axes_of(case))
            fitting = case
        if fitting and (self.limit is None or mass <= self.limit):
            found, missing = self.judge(fitting)
        excess = 0.0 if self.limit is None or not mass > self.limit else mass / self.limit - 1
        trial.set_constraint("missing", missing)
        trial.set_constraint(_MASS, excess)
        trial.set_user_attr(_MASS, None if np.isnan(mass) else mass)
        if missing or excess:
            study.tell(trial, state=optuna.trial.TrialState.PRUNED)
            return
        values_of = dict(zip([goal.name for goal in self.measured], found.tolist(), strict=True)) | {_MASS: mass}
        study.tell(trial, [values_of[goal.name] for goal in self.goals])

    def judge(self, case: Case) -> tuple[Vector, float]:
        """What counts of all runs of a design, and the share of the runs that have no value."""
        runs = Sweep(
            case,
            self.axes_of(case),
            [goal.measure for goal in self.measured],
            **self.options,
        ).run(**self.where)
        values = np.array([runs[goal.name].values.ravel() for goal in self.measured])
        gone = ~np.isfinite(values).all(axis=0) | (runs["status"].values.ravel() != 0)
        if gone.any():
            return np.full(len(values), np.nan), float(gone.mean())
        signs = np.array([goal.sign for goal in self.measured])
        return signs * _ROBUST[self.robust](signs[:, None] * values, axis=1), 0.0

    # ---- all trials

    def result(self, trials: Sequence[Any]) -> xr.Dataset:
        """All trials, and the best ones."""
        import xarray as xr

        from rattlebox.studies.measures import MEASURES

        masses = np.array([trial.user_attrs[_MASS] for trial in trials], dtype=float)
        missing = np.array([trial.constraints["missing"] for trial in trials])
        values = np.array([trial.values or [np.nan] * len(self.goals) for trial in trials])
        about = {
            name: value if isinstance(value, str) else json.dumps(value) for name, value in self.describe().items()
        }
        found = xr.Dataset(attrs={"title": "Rattlebox design", **about})
        for parameter in self.parameters:
            column = [trial.params[parameter.path] for trial in trials]
            found = found.assign_coords({parameter.path: ("trial", column, parameter.attrs)})
        for goal, column in zip(self.goals, values.T, strict=True):
            attrs = {"units": "", "long_name": goal.name.replace("_", " ")}
            if goal.name in MEASURES:
                attrs = {"units": MEASURES[goal.name].units, "long_name": MEASURES[goal.name].long_name}
            found[goal.name] = ("trial", column, attrs | {"goal": "max" if goal.largest else "min"})
        mass = {"units": "kg", "long_name": "mass of the balls"}
        found[_MASS] = ("trial", masses, found[_MASS].attrs | mass if _MASS in found else mass)
        found["missing"] = ("trial", missing, {"units": "1", "long_name": "share of the runs without a value"})
        feasible = np.array([trial.values is not None for trial in trials])
        found["feasible"] = ("trial", feasible, {"long_name": "within the limits, with a value of each run"})
        front = _front(values * np.array([goal.sign for goal in self.goals]), feasible)
        cases = []
        for number in front:
            chosen = trials[number].params
            values_of = {p.path: p.choices.get(chosen[p.path], chosen[p.path]) for p in self.parameters}
            cases.append(replaced(self.case, values_of).to_toml())
        return found.assign_coords(trial=np.arange(len(trials))).assign(
            front=("front", front, {"long_name": "number of the trial"}),
            case=("front", np.array(cases, dtype=object), {"long_name": "case file"}),
        )


_ROBUST: dict[str, Any] = {"worst": np.max, "mean": np.mean, "median": np.median}


def _front(values: Vector, feasible: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Numbers of the best trial, or of those that none beats in everything, the best in the first objective first."""
    numbers = np.flatnonzero(feasible)
    if not numbers.size:
        return numbers
    own = values[numbers]
    if own.shape[1] == 1:
        return numbers[[own.argmin()]]
    others = own[:, None, :]
    beaten = ((others <= own).all(axis=2) & (others < own).any(axis=2)).any(axis=0)
    kept = numbers[~beaten]
    return kept[np.lexsort(values[kept].T[::-1])]


# ---- Optuna


@contextmanager
def _quiet(optuna: Any) -> Iterator[None]:
    before = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    try:
        yield
    finally:
        optuna.logging.set_verbosity(before)


class _NoLock:
    """The whole file is ours already; and a lock of Optuna's own outlives a process that is killed."""

    def acquire(self) -> bool:
        return True

    def release(self) -> None:
        pass


@contextmanager
def _storage(optuna: Any, store: str | os.PathLike[str] | None) -> Iterator[Any]:
    """Where trials are kept: a journal, to which each trial adds some lines."""
    if store is None:
        yield None
        return
    with exclusive_writer(Path(store)) as progress:
        if (marker := read_marker(Path(store))) and marker.complete:
            raise StoreError(f"{store} holds another study\n  try: another folder, or remove this one")
        path = progress / JOURNAL
        if path.exists():
            with path.open("r+b") as file:  # cut off a line that was not written to its end
                file.truncate(file.read().rfind(b"\n") + 1)
        journal = optuna.storages.journal
        yield optuna.storages.JournalStorage(journal.JournalFileBackend(str(path), lock_obj=_NoLock()))


def trials_in(path: str | os.PathLike[str]) -> int | None:
    """Return how many trials of a design are done in a store; None when it holds no design.

    Parameters
    ----------
    path
        Folder of the design.
    """
    journal = Path(path) / "progress" / JOURNAL
    if not journal.exists():
        return None
    return len(re.findall(r'^{"op_code":6,.*"state":[12],', journal.read_text(), re.MULTILINE))  # complete or set aside


def _study(optuna: Any, storage: Any, search: _Search, seed: int, store: Any) -> Any:
    """The study, with what other runs of the same have found."""
    from rattlebox import __version__

    about = json.loads(json.dumps({"version": __version__, "seed": seed, **search.describe()}))
    study = optuna.create_study(
        storage=storage,
        study_name="rattlebox",
        load_if_exists=True,
        directions=["maximize" if goal.largest else "minimize" for goal in search.goals],
    )
    there = study.user_attrs.get("about")
    if there is None:
        study.set_user_attr("about", about)
    elif there != about:
        names = ", ".join(name for name in {**there, **about} if there.get(name) != about.get(name))
        raise StoreError(f"{store} holds the trials of another study; different: {names}\n  try: another folder")
    for trial in study.get_trials(
        deepcopy=False, states=(optuna.trial.TrialState.RUNNING,)
    ):  # of a process that was stopped
        study.tell(trial.number, state=optuna.trial.TrialState.FAIL)
    return study


def _told(optuna: Any, study: Any) -> list[Any]:
    """The trials that are done."""
    states = optuna.trial.TrialState
    done: list[Any] = study.get_trials(deepcopy=False, states=(states.COMPLETE, states.PRUNED))
    return done


def _seed(seed: int, number: int) -> int:
    """A seed of each trial of its own, so that it does not matter where a search was stopped."""
    return int(np.random.SeedSequence([seed, number]).generate_state(1)[0])
