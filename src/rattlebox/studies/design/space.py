"""Design variables and objectives of a design search, and its Pareto front."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.errors import Hint
from rattlebox.studies.grid.axes import materials_in, parse_axes
from rattlebox.studies.grid.grid import Parameter, labels
from rattlebox.studies.grid.grid import Values as Column
from rattlebox.studies.work.measures import about

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.results import Run

ADDED_MASS = "added_mass"
"""Objective that needs no run: the mass of all balls or particles."""

DAMPING_RATIO = "damping_ratio"
"""Objective from damping curves: the damping ratio of a mode with its dampers."""


@dataclass(frozen=True)
class DesignVariable:
    """A variable of a design search: numbers between two bounds, or one of several choices.

    Values are those that Optuna handles: numbers, and labels of choices. A choice sets one parameter, or several that vary
    together.
    """

    name: str
    bounds: tuple[float, float] | None
    choices: dict[Any, dict[str, Any]]
    shown: dict[Any, dict[str, Any]]
    log: bool
    whole: bool
    attrs: dict[str, dict[str, str]]

    @property
    def paths(self) -> list[str]:
        """Paths of the parameters."""
        return list(self.attrs)

    @classmethod
    def read(cls, case: Case, key: Any, values: Any, log: Sequence[str]) -> DesignVariable:
        """Read a pair of bounds, a list of choices, or lists of parameters that vary together."""
        if isinstance(key, tuple) or isinstance(values, Mapping):
            lists = values.values() if isinstance(values, Mapping) else values
            if any(isinstance(each, tuple) for each in lists):
                raise Hint(f"parameters: {key}: bounds cannot vary together", "lists in square brackets to choose from")
            (direction,) = parse_axes(case, {key: values}, source="parameters").directions
            return cls._of_choices(direction.name, direction.values, together=True)
        parameter = Parameter(case, key, "parameters", materials_in(case))
        is_range = isinstance(values, tuple)
        if is_range and len(values) != 2:
            raise parameter.wrong("bounds must be a pair (smallest, largest)", "a list to choose from", None, values)
        column = parameter.values(list(values) if is_range else values)
        if not is_range:
            return cls._of_choices(parameter.path, [column], together=False)
        _check_start(column)
        if column.unit is None:
            raise parameter.wrong("its values are not numbers and have no bounds", "a list to choose from")
        low, high = column.array.tolist()
        is_log = parameter.path in log
        if not low < high or (is_log and low <= 0):
            least = " and greater than zero" if is_log else ""
            raise parameter.wrong(f"the first bound must be smaller than the second{least}", "", None, values)
        return cls(parameter.path, (low, high), {}, {}, is_log, parameter.is_whole, _attributes([column]))

    @classmethod
    def _of_choices(cls, name: str, columns: Sequence[Column], *, together: bool) -> DesignVariable:
        """Return the variable of choices, one for each row of the columns."""
        paths, values, texts = [column.parameter.path for column in columns], [], []
        for column in columns:
            _check_start(column)
            array = column.array.astype(int) if column.parameter.is_whole else column.array
            values.append(array.tolist())
            texts.append((labels(array) if column.unit is None else array).tolist())
        choices, shown = {}, {}
        for row, text in zip(zip(*values, strict=True), zip(*texts, strict=True), strict=True):
            label = ", ".join(map(str, text)) if together else text[0]
            choices[label] = dict(zip(paths, row, strict=True))
            shown[label] = dict(zip(paths, text, strict=True))
        return cls(name, None, choices, shown, False, False, _attributes(columns))

    def suggest(self, trial: Any) -> None:
        """Let Optuna suggest a value for a trial."""
        if not self.bounds:
            trial.suggest_categorical(self.name, list(self.choices))
        elif self.whole:
            trial.suggest_int(self.name, *map(int, self.bounds), log=self.log)
        else:
            trial.suggest_float(self.name, *self.bounds, log=self.log)

    def sample(self, generator: np.random.Generator) -> Any:
        """Return a random value."""
        if not self.bounds:
            return list(self.choices)[generator.integers(len(self.choices))]
        low, high = self.bounds
        if self.whole:
            return int(generator.integers(int(low), int(high), endpoint=True))
        share = generator.random()
        return low * (high / low) ** share if self.log else low + (high - low) * share

    def in_case(self, value: object) -> dict[str, Any]:
        """Return the values of a case by path."""
        return {self.name: value} if self.bounds else self.choices[value]

    def coordinates(self, values: Sequence[object]) -> dict[str, tuple[list[Any], dict[str, str]]]:
        """Return the values of each parameter in several trials, and the attributes of the coordinate, by path."""
        if self.bounds:
            return {self.name: (list(values), self.attrs[self.name])}
        return {path: ([self.shown[value][path] for value in values], attrs) for path, attrs in self.attrs.items()}

    def to_json(self) -> dict[str, Any]:
        """Return in JSON types what `coordinates` needs."""
        shown = [[label, row] for label, row in self.shown.items()]
        return {"name": self.name, "bounds": self.bounds, "shown": shown, "attrs": self.attrs}

    @classmethod
    def from_json(cls, about: Mapping[str, Any]) -> DesignVariable:
        """Return a variable that has coordinates, from the result of `to_json`."""
        return cls(about["name"], about["bounds"], {}, dict(about["shown"]), False, False, about["attrs"])

    def describe(self) -> dict[str, dict[str, Any]]:
        """Return a description of each parameter in JSON types, by path."""
        together = {"together": self.name} if len(self.attrs) > 1 else {}

        def plain(value: object) -> Any:
            return value if isinstance(value, (int, float)) else str(value)

        return {
            path: {"bounds": self.bounds, "choices": [plain(row[path]) for row in self.shown.values()], "log": self.log}
            | together
            for path in self.attrs
        }


def _attributes(columns: Sequence[Column]) -> dict[str, dict[str, str]]:
    """Return the attributes of coordinates by path."""
    return {
        column.parameter.path: {"long_name": column.parameter.path.replace(".", " ").replace("_", " ")}
        | ({} if column.unit is None else {"units": column.unit})
        for column in columns
    }


def _check_start(column: Column) -> None:
    """Raise if start positions are lengths, whose limits depend on the gap of each trial."""
    if column.parameter.is_start and column.unit == "m":
        raise column.parameter.wrong("a start position must not be a length", "fractions of the gap, -1 to 1")


@dataclass(frozen=True)
class Objective:
    """One objective of a design search."""

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

    @property
    def attributes(self) -> dict[str, str]:
        """Unit and label in a result."""
        declared = about(self.measure)
        return {"units": "1" if self.name == DAMPING_RATIO else declared.units, "long_name": declared.long_name}

    @property
    def attributes_with_goal(self) -> dict[str, str]:
        """Unit, label and direction in a result."""
        return self.attributes | {"goal": "max" if self.maximise else "min"}


def read_objectives(objective: object) -> list[Objective]:
    """Return the objectives of a search with their directions."""
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

    `values`: objectives, to be minimised, (trials, objectives). `feasible`: whether each trial is feasible, (trials,).
    Returns feasible trials that no other one dominates (see `rb.design`); only the best trial if there is one objective,
    (n,).
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
