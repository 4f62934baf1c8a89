"""Trials of a design search in an Optuna study, and their store."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.exceptions import StoreError
from rattlebox._util.narrow import instance
from rattlebox._util.owned_folder import read_marker
from rattlebox.model.differences import differences
from rattlebox.results.provenance import with_version
from rattlebox.studies.design.candidate import Candidate, Curves, Evaluation, pooled
from rattlebox.studies.design.evidence import DROPPED, certainly_worse
from rattlebox.studies.design.result import padded
from rattlebox.studies.design.search import MOST_COMBINATIONS, MOST_PAUSED, DesignSearch, Values
from rattlebox.studies.design.space import ADDED_MASS, DesignVariable
from rattlebox.studies.run.estimate import Estimate
from rattlebox.studies.run.store import JOURNAL, exclusive_writer

if TYPE_CHECKING:
    import xarray as xr


# ---- store


_NAME = "rattlebox"
"""Name of the study in its journal."""
LAYOUT = "layout"
"""Attribute with the variables and objectives of a design, in the study of its trials."""


@contextmanager
def quiet(optuna: Any) -> Iterator[None]:
    """Suppress messages of Optuna below errors."""
    before = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    try:
        yield
    finally:
        optuna.logging.set_verbosity(before)


class _NoLock:
    """No lock: the store has one already, and a lock of Optuna remains after its process is killed."""

    def acquire(self) -> bool:
        """Return True."""
        return True

    def release(self) -> None:
        """Do nothing."""


@contextmanager
def trial_storage(optuna: Any, store: str | os.PathLike[str] | None) -> Iterator[Any]:
    """Open the journal of a store, to which each trial appends lines."""
    if store is None:
        yield None
        return
    with exclusive_writer(Path(store)) as progress:
        if (marker := read_marker(Path(store))) and marker.complete:
            raise StoreError(f"{store} holds another study", "another folder, or remove this one")
        path = progress / JOURNAL
        if path.exists():
            with path.open("r+b") as file:  # remove an incomplete last line
                file.truncate(file.read().rfind(b"\n") + 1)
        journal = optuna.storages.journal
        yield optuna.storages.JournalStorage(journal.JournalFileBackend(str(path), lock_obj=_NoLock()))


def count_trials(path: str | os.PathLike[str]) -> int | None:
    """Return the number of finished trials in the store of a design; None if it holds no design."""
    journal = Path(path) / "progress" / JOURNAL
    if not journal.exists():
        return None
    return len(re.findall(r'^{"op_code":6,.*"state":[12],', journal.read_text(), re.MULTILINE))  # complete or pruned


def open_trials(path: str | os.PathLike[str]) -> xr.Dataset | None:
    """Return the finished trials of a design that is not finished; None without Optuna."""
    import xarray as xr

    try:
        optuna: Any = import_module("optuna")
    except ImportError:
        return None
    journal = Path(path) / "progress" / JOURNAL
    with quiet(optuna):
        backend = optuna.storages.journal.JournalFileBackend(str(journal), lock_obj=_NoLock())
        study = optuna.load_study(study_name=_NAME, storage=optuna.storages.JournalStorage(backend))
    trials = finished_trials(optuna, study)
    layout = study.user_attrs.get(LAYOUT)
    if layout is None or not trials:
        return None
    found = xr.Dataset(coords={"trial": np.arange(len(trials))})
    for about in layout["variables"]:
        variable = DesignVariable.from_json(about)
        own = variable.coordinates([trial.params[variable.name] for trial in trials])
        found = found.assign_coords({name: ("trial", *column) for name, column in own.items()})
    for number, (name, attrs) in enumerate(layout["objectives"].items()):
        found[name] = ("trial", [math.nan if trial.values is None else trial.values[number] for trial in trials], attrs)
    reasons = np.array([trial.user_attrs["reason"] for trial in trials], dtype=object)
    return found.assign(reason=("trial", reasons))


def load_study(optuna: Any, storage: Any, directions: Sequence[str], description: Mapping[str, Any], store: Any) -> Any:
    """Return an Optuna study with the earlier trials of its storage."""
    about = json.loads(json.dumps(description))
    study = optuna.create_study(
        storage=storage,
        study_name=_NAME,
        load_if_exists=True,
        directions=list(directions),
    )
    stored = study.user_attrs.get("about")
    if stored is None:
        study.set_user_attr("about", about)
    elif stored != about:
        other = with_version(stored["version"])
        advice = f"another folder, or the same command{other}" if other else "another folder"
        lines = [f"{store} holds the trials of another study", *differences(stored, about)]
        raise StoreError("\n".join(lines), advice)
    # A trial that a stopped process was running is lost.
    for trial in study.get_trials(deepcopy=False, states=(optuna.trial.TrialState.RUNNING,)):
        study.tell(trial.number, state=optuna.trial.TrialState.FAIL)
    return study


def finished_trials(optuna: Any, study: Any) -> list[Any]:
    """Return the trials that are complete or pruned."""
    states = optuna.trial.TrialState
    trials: list[Any] = study.get_trials(deepcopy=False, states=(states.COMPLETE, states.PRUNED))
    return trials


def trial_seed(seed: int, number: int) -> int:
    """Return the random seed of a trial; it does not depend on where the search was stopped."""
    return int(np.random.SeedSequence([seed, number]).generate_state(1)[0])


# ---- trials


def number_of_trials(search: DesignSearch, wanted: int | None) -> int:
    """Return the number of trials of a new search."""
    most = wanted or MOST_COMBINATIONS
    return most if search.combinations is None else min(most, len(search.combinations))


class Trials:
    """Trials of a design search: those that are finished, and the next one."""

    def __init__(self, optuna: Any, study: Any, search: DesignSearch, seed: int, wanted: int | None) -> None:
        self._optuna, self._study, self._search, self._seed = optuna, study, search, seed
        self._stored = finished_trials(optuna, study)
        combinations = search.combinations
        self._all = combinations is not None and (wanted is None or wanted >= len(combinations))
        self._begun: dict[str, _Begun] = {}  # Designs after their first packings
        self.total = wanted or MOST_COMBINATIONS
        if self._all:
            self.total = len(self._stored) + len(self._missing())

    @property
    def finished(self) -> list[Any]:
        """Trials of Optuna that are finished, at most `total`."""
        return self._stored[: self.total]

    @property
    def done(self) -> int:
        """Number of finished trials."""
        return len(self.finished)

    @property
    def times(self) -> dict[str, float]:
        """Predicted times of all trials, and wall time and, if known, processor time of the finished ones [s]."""
        wall, cpu = np.sum([trial.user_attrs["seconds"] for trial in self.finished] or [[0.0, 0.0]], axis=0).tolist()
        own = self._search.where["backend"] == "threads"
        predicted = self._study.user_attrs.get("predicted", {}).get("times", {})
        return {**predicted, "wall_time": wall, **({"cpu_time": cpu} if own else {})}

    def store_prediction(self, left: Estimate) -> None:
        """Store the predicted times of all trials, if this is their first prediction."""
        if self._study.user_attrs.get("predicted", {}).get("trials") != self.total:
            scale = self.total / left.trials
            times = {"predicted_cpu_time": scale * left.cpu_time, "predicted_wall_time": scale * left.wall_time}
            self._study.set_user_attr("predicted", {"trials": self.total, "times": times})

    def run_next(self) -> None:
        """Run the next trial, or the first packings of a combination that has none."""
        samplers = self._optuna.samplers
        if self._all:
            missing = self._missing()
            values = self._next(missing) if self._search.drop else missing[0]
            if values is None:
                return
            self._study.sampler = _fixed(samplers, values)
        else:
            self._study.sampler = samplers.TPESampler(seed=trial_seed(self._seed, self.done))
        # The sampler proposes values through the variables of the trial.
        trial = self._study.ask()
        for variable in self._search.variables:
            variable.suggest(trial)
        candidate, found = self._evaluate(trial.params)
        mass = candidate.mass
        limit = self._search.limit
        excess = mass / limit - 1 if limit is not None and mass > limit else 0.0
        trial.set_constraint("missing", found.missing)
        trial.set_constraint(ADDED_MASS, excess)
        # All that a restart needs, since trials are not computed again.
        attributes = {
            ADDED_MASS: mass,
            "intervals": found.intervals.tolist(),
            "packings": found.packings.tolist(),
            "warnings": found.warnings,
            "reason": found.reason,
            "seconds": candidate.seconds.tolist(),
            DROPPED: found.dropped,
            "ran": candidate.ran,
            "cycles": found.cycles or self._search.cycles if self._search.parts else None,
            "short": [each.packings.tolist() for each in candidate.short],
            "curves": None if found.curves is None else [each.tolist() for each in found.curves],
        }
        for name, value in attributes.items():
            trial.set_user_attr(name, value)
        if found.missing or excess:
            self._study.tell(trial, state=self._optuna.trial.TrialState.PRUNED)
        else:
            self._study.tell(trial, self._search.objective_values(mass, found)[0].tolist())
        self._stored = finished_trials(self._optuna, self._study)

    def _missing(self) -> list[Values]:
        """Return the combinations without a trial."""
        tried = [trial.params for trial in self._stored]
        return [values for values in self._search.combinations or () if values not in tried]

    def _next(self, missing: list[Values]) -> Values | None:
        """Return the combination whose trial is the next one; None if first packings of a combination ran instead.

        The first parts of the runs of all come first. The best one is completed, and each of the others is compared with it.
        Those that are left continue to the next part, after which they are compared again, and finally run their first
        packings with all cycles. Then the best ones are completed first. All decisions depend on results alone that are the
        same after a stop, whatever was finished before it.
        """
        for values in missing:
            if _key(values) not in self._begun:
                self._begin(values)
                return None
        levels = range(len(self._search.parts))
        if levels:
            missing.sort(key=self._order(short=True))
            if not self._complete():
                return missing[0]
        begun = [(values, self._begun[_key(values)]) for values in missing]
        # All are compared before any of them continues: the scatter of all is the same after a stop.
        for level in levels:
            for values, each in begun:
                if each.compared == level and each.found is None:
                    each.compared += 1
                    each.found = self._dropped_after_few_cycles(each.candidate)
                    if each.found is not None:
                        return values
            for _, each in begun:
                if each.found is None and len(each.candidate.short) == level + 1:
                    self._extend(each)
                    return None
        missing.sort(key=self._order(short=False))
        return missing[0]

    def _begin(self, values: Values) -> _Begun:
        """Return a design after the first part of its first packings."""
        begun = self._begun[_key(values)] = _Begun(self._search.candidate(values))
        self._extend(begun)
        return begun

    def _extend(self, begun: _Begun) -> None:
        """Run the first packings of a design to the end of the next part, or with all cycles if no part is left."""
        search, candidate = self._search, begun.candidate
        candidate.room = MOST_PAUSED - sum(each.candidate.memory for each in self._begun.values())
        parts = [] if any(each.missing for each in candidate.short) else search.parts[len(candidate.short) :]
        found = (parts[0] if parts else search).evaluate(candidate, search.stages[0])
        if parts:
            candidate.short.append(found)
        else:
            begun.found = found

    def _continue(self, begun: _Begun) -> Evaluation:
        """Return the result of the first packings of a design: with all cycles, unless few of them exclude it."""
        while begun.found is None:
            begun.found = self._dropped_after_few_cycles(begun.candidate)
            if begun.found is None:
                self._extend(begun)
        return begun.found

    def _order(self, *, short: bool) -> Callable[[Values], float]:
        """Return the rank of a combination after its first packings, summed over the objectives: the best one runs first.

        It is the same after a stop, since it covers the finished trials, too. `short`: whether shortened runs decide.
        """
        first = self._search.stages[0]
        found: dict[str, tuple[Candidate, Evaluation | None]] = {
            _key(trial.params): _stored(self._search, trial) for trial in self._stored
        }
        found |= {key: (each.candidate, each.found) for key, each in self._begun.items()}
        parts = []
        for candidate, own in found.values():
            each = candidate.short[0] if short else instance(own, Evaluation)
            values = np.mean(each.packings[:, :first], axis=1)
            parts.append(self._search.objective_values(candidate.mass, replace(each, values=values))[0])
        signs = np.array([each.sign for each in self._search.objectives])
        table = np.nan_to_num(signs * np.array(parts), nan=np.inf)
        ranks = np.sum(table[:, None] > table, axis=(1, 2))
        order = dict(zip(found, ranks.tolist(), strict=True))
        return lambda values: order[_key(values)]

    def _evaluate(self, values: Values) -> tuple[Candidate, Evaluation]:
        """Return a design and its result; that of an earlier trial with the same values, if there is one."""
        for trial in self._stored:
            if trial.params == values:
                return _stored(self._search, trial)
        begun = self._begun.get(_key(values)) or self._begin(values)
        found = self._continue(begun)
        candidate = begun.candidate
        del self._begun[_key(values)]
        if found.dropped:
            return candidate, found
        for count in self._search.stages[1:]:
            if found.missing or self._search.is_precise(found):
                break
            if self._search.drop and (rival := self._better(candidate.mass, found)) is not None:
                reason = f"dropped after {candidate.ran} of {self._search.count} packings: worse than trial {rival}"
                return candidate, replace(found, dropped=True, reason=reason)
            found = self._search.evaluate(candidate, count)
        return candidate, found

    def _complete(self) -> dict[int, Any]:
        """Return the trials that are complete, by number."""
        return {
            number: trial
            for number, trial in enumerate(self._stored)
            if trial.values is not None and not trial.user_attrs[DROPPED]
        }

    def _better(self, mass: float, found: Evaluation) -> int | None:
        """Return the first complete trial that is certainly better than a design, within the intervals of both."""
        rivals = self._complete()
        others = [_result(self._search, each)[1] for each in self._stored if each.values is not None]
        begun = [each.found for each in self._begun.values() if each.found is not None and not each.found.missing]
        scatter = pooled([found, *others, *begun])
        return self._rival(mass, found.widened(scatter), rivals, scatter)

    def _dropped_after_few_cycles(self, candidate: Candidate) -> Evaluation | None:
        """Return the result of a design after the latest parts of its runs if a complete trial excludes it; else None."""
        search, level = self._search, len(candidate.short) - 1
        rivals = self._complete()
        if self._all:  # later ones may be complete or not after a stop
            rivals = dict(list(rivals.items())[:1])
        if level < 0 or candidate.short[level].missing or not rivals:
            return None
        found, cycles = candidate.short[level], search.parts[level].cycles
        known = {number: _stored(search, trial) for number, trial in enumerate(self._stored)}
        candidates = [each for each, _ in known.values()] + [each.candidate for each in self._begun.values()]
        scatter = pooled([part for each in candidates for part in each.short[level : level + 1] if not part.missing])
        changes = [
            result.packings[:, : search.stages[0]].mean(axis=1) / part.values
            for each, result in (known[number] for number in rivals)
            for part in each.short[level : level + 1]
            if not part.missing
        ]
        if not changes or np.any(np.array(changes) <= 0):
            return None
        bias = search.transient(found, cycles, changes)
        wide = found.widened(scatter)
        rival = self._rival(candidate.mass, replace(wide, intervals=wide.intervals + bias), rivals, scatter)
        if rival is None:
            return None
        runs = f"{candidate.ran} of {search.count} packings and {cycles} of {search.cycles} cycles"
        reason = f"dropped after {runs}: worse than trial {rival}"
        return replace(found, intervals=found.intervals + bias, dropped=True, cycles=cycles, reason=reason)

    def _rival(self, mass: float, found: Evaluation, rivals: Mapping[int, Any], scatter: Any) -> int | None:
        """Return the first of some trials that is certainly better than a design, within the intervals of both.

        `scatter`: that with which the intervals of the trials are widened; those of the design are `found`.
        """
        signs = np.array([each.sign for each in self._search.objectives])
        values, half = self._search.objective_values(mass, found)
        for number, trial in rivals.items():
            other, rival = _result(self._search, trial)
            best, width = self._search.objective_values(other, rival.widened(scatter))
            if certainly_worse((signs * values - half)[None], (signs * best + width)[None]).item():
                return number
        return None


@dataclass
class _Begun:
    """A design after its first packings."""

    candidate: Candidate
    found: Evaluation | None = None  # Their result with all cycles, or that with which it is dropped
    compared: int = 0  # Number of parts of its runs after which it was compared


def _key(values: Values) -> str:
    """Return the values of the parameters as text."""
    return json.dumps(values, sort_keys=True)


def _result(search: DesignSearch, trial: Any) -> tuple[float, Evaluation]:
    """Return the mass and the result of a finished trial."""
    about = trial.user_attrs
    names = [each.name for each in search.objectives]
    known = dict(zip(names, trial.values or [np.nan] * len(names), strict=True))
    return about[ADDED_MASS], Evaluation(
        np.array([known[each.name] for each in search.computed]),
        np.array(about["intervals"]),
        padded([about["packings"]], search.count, len(search.computed))[0],
        trial.constraints["missing"],
        about["warnings"],
        about["reason"],
        None if about["curves"] is None else Curves(*map(np.array, about["curves"])),
        about[DROPPED],
        about["cycles"] or 0,
    )


def _stored(search: DesignSearch, trial: Any) -> tuple[Candidate, Evaluation]:
    """Return the design of a finished trial, which needs no time, and its result."""
    mass, found = _result(search, trial)
    short = []
    for packings in (np.array(each, float) for each in trial.user_attrs["short"]):
        values = packings.mean(axis=1)
        nothing = np.full(values.shape, np.nan)
        short.append(Evaluation(values, nothing, packings, float(not np.isfinite(values).all())))
    return Candidate(None, mass, ran=trial.user_attrs["ran"], short=short), found


def _fixed(samplers: Any, values: Values) -> Any:
    """Return a sampler of Optuna that suggests given values."""

    class Fixed(samplers.BaseSampler):  # type: ignore[misc]
        def infer_relative_search_space(self, study: object, trial: object) -> dict[str, Any]:
            return {}

        def sample_relative(self, study: object, trial: object, search_space: object) -> dict[str, Any]:
            return {}

        def sample_independent(self, study: object, trial: object, param_name: str, param_distribution: object) -> Any:
            return values[param_name]

    return Fixed()
