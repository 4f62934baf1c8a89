"""Design variables and objectives of a design search, and its Pareto front."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.errors import Hint
from rattlebox.studies.axes import materials_in
from rattlebox.studies.grid import labels
from rattlebox.studies.parameter import Parameter

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.results import Run

ADDED_MASS = "added_mass"
"""Objective that needs no run: the mass of all balls or particles."""

DAMPING_RATIO = "damping_ratio"
"""Objective from damping curves: the damping ratio of a mode with its dampers."""


@dataclass(frozen=True)
class DesignVariable:
    """A parameter of a design search: numbers between two bounds, or one of several choices.

    Values are those that Optuna handles: numbers, and labels of choices.

    Attributes
    ----------
    path
        Path of the parameter.
    bounds
        Smallest and largest value in SI units; None for choices.
    choices
        Values by label; empty for bounds.
    log
        Whether the search is uniform in the logarithm.
    whole
        Whether values between the bounds are whole numbers.
    attrs
        Attributes of the coordinate in the result.
    """

    path: str
    bounds: tuple[float, float] | None
    choices: dict[Any, Any]
    log: bool
    whole: bool
    attrs: dict[str, str]

    @classmethod
    def read(cls, case: Case, path: Any, values: Any, log: bool) -> DesignVariable:
        """Read a pair of bounds, or a list of choices.

        Parameters
        ----------
        case
            Case with the parameter.
        path
            Path of the parameter.
        values
            A tuple of two values, or a list to choose from.
        log
            Whether the search is uniform in the logarithm.

        Raises
        ------
        CaseError
            If a value is not valid for the parameter.
        """
        parameter = Parameter(case, path, "parameters", materials_in(case))
        is_range = isinstance(values, tuple)
        if is_range and len(values) != 2:
            raise parameter.wrong("bounds must be a pair (smallest, largest)", "a list to choose from", None, values)
        column = parameter.values(list(values) if is_range else values)
        if parameter.is_start and column.unit == "m":
            raise parameter.wrong(
                "a start position must not be a length",
                "fractions of the gap, -1 to 1",
                None,
                values,
            )
        attrs = {"long_name": parameter.path.replace(".", " ").replace("_", " ")}
        if column.unit is not None:
            attrs["units"] = column.unit
        if not is_range:
            array = column.array.astype(int) if parameter.is_whole else column.array
            names = labels(array) if column.unit is None else array
            choices = dict(zip(names.tolist(), array.tolist(), strict=True))
            return cls(parameter.path, None, choices, False, False, attrs)
        if column.unit is None:
            raise parameter.wrong("its values are not numbers and have no bounds", "a list to choose from")
        low, high = column.array.tolist()
        if not low < high or (log and low <= 0):
            least = " and greater than zero" if log else ""
            raise parameter.wrong(f"the first bound must be smaller than the second{least}", "", None, values)
        return cls(parameter.path, (low, high), {}, log, parameter.is_whole, attrs)

    def suggest(self, trial: Any) -> None:
        """Let Optuna suggest a value for a trial."""
        if not self.bounds:
            trial.suggest_categorical(self.path, list(self.choices))
        elif self.whole:
            trial.suggest_int(self.path, *map(int, self.bounds), log=self.log)
        else:
            trial.suggest_float(self.path, *self.bounds, log=self.log)

    def sample(self, generator: np.random.Generator) -> Any:
        """Return a random value."""
        if not self.bounds:
            return list(self.choices)[generator.integers(len(self.choices))]
        low, high = self.bounds
        if self.whole:
            return int(generator.integers(int(low), int(high), endpoint=True))
        share = generator.random()
        return low * (high / low) ** share if self.log else low + (high - low) * share

    def in_case(self, value: Any) -> Any:
        """Return a value as a case takes it."""
        return value if self.bounds else self.choices[value]

    def describe(self) -> dict[str, Any]:
        """Return a description in JSON types."""
        choices = [name if isinstance(name, (int, float)) else str(name) for name in self.choices]
        return {"bounds": self.bounds, "choices": choices, "log": self.log}


@dataclass(frozen=True)
class Objective:
    """One objective of a design search.

    Attributes
    ----------
    measure
        Name of a measure, or function of a Run.
    maximise
        Whether the measure is maximised.
    """

    measure: str | Callable[[Run], float]
    maximise: bool

    @property
    def name(self) -> str:
        """Name of the measure."""
        return self.measure if isinstance(self.measure, str) else getattr(self.measure, "__name__", repr(self.measure))

    @property
    def sign(self) -> float:
        """Factor with which the measure is minimised."""
        return -1.0 if self.maximise else 1.0


def read_objectives(objective: Any) -> list[Objective]:
    """Return the objectives of a search with their directions.

    Parameters
    ----------
    objective
        A measure, a list of measures, or a mapping of measures to "min" or "max". Without a direction all are minimised but
        the damping ratio.

    Raises
    ------
    CaseError
        If there is no objective, or a direction is not valid.
    """
    if isinstance(objective, str) or not hasattr(objective, "__iter__"):
        objective = [objective]
    if not isinstance(objective, Mapping):
        objective = {each: "max" if each == DAMPING_RATIO else "min" for each in objective}
    directions = dict(objective)
    if not directions:
        raise Hint("objective is empty; at least one is required", '"settling_time"')
    for name, direction in directions.items():
        if direction not in ("min", "max"):
            raise Hint(f"objective: {name} = {direction!r} is not a direction", '"min" or "max"')
    objectives = [Objective(measure, direction == "max") for measure, direction in directions.items()]
    if [each.name for each in objectives] == [ADDED_MASS]:
        raise Hint("added_mass alone is smallest for the smallest damper", '["added_mass", "settling_time"]')
    return objectives


def pareto_front(values: NDArray[np.float64], feasible: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the numbers of the Pareto-optimal trials, the best in the first objective first.

    Parameters
    ----------
    values : (trials, objectives) float
        Objectives, to be minimised.
    feasible : (trials,) bool
        Whether each trial is feasible.

    Returns
    -------
    (n,) int
        Feasible trials that no other one dominates (see `rb.design`); only the best trial if there is one objective.
    """
    numbers = np.flatnonzero(feasible)
    if not numbers.size:
        return numbers
    own = values[numbers]
    if own.shape[1] == 1:
        return numbers[[own.argmin()]]
    others, rounding = own[:, None, :], 1e-12 * np.abs(own).max(axis=0)
    dominated = ((others <= own + rounding).all(axis=2) & (others < own - rounding).any(axis=2)).any(axis=0)
    front: NDArray[np.int64] = numbers[~dominated]
    return front[np.lexsort(values[front].T[::-1])]
