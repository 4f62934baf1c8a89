"""Trials of a design search in an Optuna study."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from rattlebox.studies.design.search import MOST_COMBINATIONS, DesignSearch, Evaluation, Values
from rattlebox.studies.design.space import ADDED_MASS
from rattlebox.studies.design.trial_store import finished_trials, trial_seed
from rattlebox.studies.run.budget import Budget


class Trials:
    """Trials of a design search: those that are finished, and the next one."""

    def __init__(self, optuna: Any, study: Any, search: DesignSearch, seed: int, wanted: int | None) -> None:
        self._optuna, self._study, self._search, self._seed = optuna, study, search, seed
        self._stored = finished_trials(optuna, study)
        combinations = search.combinations
        self._all = combinations is not None and (wanted is None or wanted >= len(combinations))
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

    def store_prediction(self, left: Budget) -> None:
        """Store the predicted times of all trials, if this is their first prediction."""
        if self._study.user_attrs.get("predicted", {}).get("trials") != self.total:
            scale = self.total / left.trials
            times = {"predicted_cpu_time": scale * left.cpu_time, "predicted_wall_time": scale * left.wall_time}
            self._study.set_user_attr("predicted", {"trials": self.total, "times": times})

    def run_next(self) -> None:
        """Run the next trial."""
        samplers = self._optuna.samplers
        if self._all:
            self._study.sampler = _fixed(samplers, self._missing()[0])
        else:
            self._study.sampler = samplers.TPESampler(seed=trial_seed(self._seed, self.done))
        trial = self._study.ask()
        for variable in self._search.variables:
            variable.suggest(trial)
        before = time.monotonic(), time.process_time()
        mass, found = self._evaluate(trial.params)
        seconds = [time.monotonic() - before[0], time.process_time() - before[1]]
        limit = self._search.limit
        excess = mass / limit - 1 if limit is not None and mass > limit else 0.0
        trial.set_constraint("missing", found.missing)
        trial.set_constraint(ADDED_MASS, excess)
        attributes = {
            ADDED_MASS: mass,
            "intervals": found.intervals.tolist(),
            "packings": found.packings.tolist(),
            "warnings": found.warnings,
            "reason": found.reason,
            "seconds": seconds,
        }
        for name, value in attributes.items():
            trial.set_user_attr(name, value)
        if found.missing or excess:
            self._study.tell(trial, state=self._optuna.trial.TrialState.PRUNED)
        else:
            values = dict(zip((each.name for each in self._search.computed), found.values.tolist(), strict=True))
            values[ADDED_MASS] = mass
            self._study.tell(trial, [values[each.name] for each in self._search.objectives])
        self._stored = finished_trials(self._optuna, self._study)

    def _missing(self) -> list[Values]:
        """Return the combinations without a trial."""
        tried = [trial.params for trial in self._stored]
        return [values for values in self._search.combinations or () if values not in tried]

    def _evaluate(self, values: Values) -> tuple[float, Evaluation]:
        """Return the mass and the result of a design; that of an earlier trial with the same values, if there is one."""
        for trial in self._stored:
            if trial.params == values:
                about = trial.user_attrs
                names = [each.name for each in self._search.objectives]
                known = dict(zip(names, trial.values or [np.nan] * len(names), strict=True))
                found = Evaluation(
                    np.array([known[each.name] for each in self._search.computed]),
                    np.array(about["intervals"]),
                    np.array(about["packings"]),
                    trial.constraints["missing"],
                    about["warnings"],
                    about["reason"],
                )
                return about[ADDED_MASS], found
        return self._search.evaluate(values)


def _fixed(samplers: Any, values: Values) -> Any:
    """Return a sampler of Optuna that suggests given values."""

    class Fixed(samplers.BaseSampler):  # type: ignore[misc]
        def infer_relative_search_space(self, study: Any, trial: Any) -> dict[str, Any]:
            return {}

        def sample_relative(self, study: Any, trial: Any, search_space: Any) -> dict[str, Any]:
            return {}

        def sample_independent(self, study: Any, trial: Any, param_name: str, param_distribution: Any) -> Any:
            return values[param_name]

    return Fixed()
