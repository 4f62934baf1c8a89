"""Convert axes, the description of what varies in a study, to a grid of variants."""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.exceptions import CaseError, RattleboxError
from rattlebox._util.narrow import instance
from rattlebox.model.case import Case
from rattlebox.model.dampers import ImpactDamper
from rattlebox.model.errors import Hint
from rattlebox.model.materials import Material
from rattlebox.model.paths import Place, all_paths, get, place_of, replaced
from rattlebox.model.plausibility import plausibility_notes
from rattlebox.model.record_sets import RecordSet
from rattlebox.model.signals import Signal
from rattlebox.model.units import whole_number
from rattlebox.studies.grid.grid import Column, Grid, Parameter, Values, labels, objects
from rattlebox.studies.grid.sampling import RandomDesign, Replicas, number_of_variants
from rattlebox.studies.grid.starts import PATH as STARTS
from rattlebox.studies.grid.starts import Starts, read_starts

if TYPE_CHECKING:
    from rattlebox.model.case import Case


Axes = (
    Mapping[Any, Any] | RandomDesign | Replicas | Sequence["Mapping[Any, Any] | RandomDesign | Replicas | ParsedAxes"]
)

_SAMPLED = 8
"""Number of variants that are checked in addition to the extreme ones."""

_EXAMPLE = '{"damper.gap": rb.linspace("0.1 mm", "2 mm", 20)}'


def read_axes(case: Case, axes: Axes, *, source: str = "axes", allow_starts: bool = False) -> Grid:
    """Return the grid of variants that axes describe, and check its extreme variants."""
    return parse_axes(case, axes, source=source, allow_starts=allow_starts).grid(case)


def parse_axes(case: Case, axes: Axes, *, source: str = "axes", allow_starts: bool = False) -> ParsedAxes:
    """Parse the values of axes.

    `axes`: a mapping, a random design, replicas, parsed axes, or a list of these, whose dimensions form the grid. A mapping
    has one dimension for each item: `path: values`; `(path, path, ...): (values, values, ...)` for parameters that vary
    together; or `name: {path: values, ...}` for the same with a name of the dimension. Values are a list or an array of
    numbers in SI units, text with units, names or parts; or `linspace`, `geomspace`. With `allow_starts` the path "start"
    has runs as values, from which variants continue.
    """
    try:
        return ParsedAxes(source, _Reader(case, source, allow_starts=allow_starts).directions(axes))
    except Hint as hint:
        raise CaseError(f"{source}: {hint}") from None


@dataclass(frozen=True, eq=False)
class _Direction:
    """One dimension."""

    name: str
    size: int
    values: list[Values]
    offsets: list[Values] = field(default_factory=list)
    starts: Starts | None = None

    def of(self, case: Case) -> _Direction:
        """Return the same dimension of another case."""

        def moved(values: Values) -> Values:
            old = values.parameter
            new = Parameter(case, old.path, old.source, old.materials)
            if new.unit != old.unit:
                raise new.wrong(
                    f"its unit is {new.unit}, but the values are for {old.unit}", "axes for each of the units"
                )
            return replace(values, parameter=new)

        return replace(self, values=[*map(moved, self.values)], offsets=[*map(moved, self.offsets)])


@dataclass(frozen=True, eq=False)
class ParsedAxes:
    """Axes with parsed values, for cases with the same parameters."""

    source: str
    directions: list[_Direction]

    def __post_init__(self) -> None:
        names = [direction.name for direction in self.directions]
        for name in names:
            if names.count(name) > 1:
                raise Hint(f"two dimensions are called {name!r}", '{"a name": {path: values, path: values}}')

    def grid(self, case: Case) -> Grid:
        """Return the grid of variants of a case, and check its extreme variants."""
        try:
            number_of_variants(math.prod(direction.size for direction in self.directions), "number of variants")
            directions = [direction.of(case) for direction in self.directions]
            columns = _Columns(case, directions).columns()
            names = [direction.name for direction in directions]
            for direction in directions:
                for values in direction.values:
                    if values.parameter.path in {*names} - {direction.name}:
                        raise Hint(f"{values.parameter.path} is the name of two dimensions", "another name")
            grid = Grid(
                tuple(names),
                tuple(direction.size for direction in directions),
                columns,
                {name: coord for direction in directions for name, coord in _coordinates(direction)},
                self._starts(directions),
            )
        except Hint as hint:
            raise CaseError(f"{self.source}: {hint}") from None
        _check_variants(case, grid, self.source)
        _warn_about_files(case, grid)
        return grid

    @staticmethod
    def _starts(directions: list[_Direction]) -> tuple[str, Starts] | None:
        """Return the dimension along which the starts vary, and these."""
        found = [(direction.name, direction.starts) for direction in directions if direction.starts is not None]
        if len(found) > 1:
            raise Hint(f"{STARTS} varies twice", "one list of all starts")
        return found[0] if found else None


def _warn_about_files(case: Case, grid: Grid) -> None:
    """Warn of the assumptions about each file of an axis, such as its unit, that the base case does not make."""
    known = set(plausibility_notes(case, signals=False))
    for path, values in grid.columns.items():
        different = {id(value): value for value in values.ravel().tolist()} if values.dtype == object else {}
        for value in {repr(value): value for value in different.values()}.values():
            if place_of(case, path)[-1] != "file" and not _has_signal(value):
                continue
            try:
                notes = plausibility_notes(replaced(case, {path: value}), signals=False)
            except RattleboxError:
                continue  # it varies together with another field
            for note in notes:
                if note.startswith("note: ") and note not in known:
                    known.add(note)
                    warnings.warn(note.removeprefix("note: "), stacklevel=5)


def _has_signal(value: object) -> bool:
    """Return whether a value is a signal or contains one; records have assumed units."""
    return any(isinstance(each, Signal) for each in (value if isinstance(value, tuple) else (value,)))


def materials_in(case: Case) -> dict[str, Material]:
    """Return the materials of a case by name."""
    parts = [get(case, path) for path in all_paths(case)]
    return {part.name: part for part in parts if isinstance(part, Material)}


class _Reader:
    """Reader of the axes of one case."""

    def __init__(self, case: Case, source: str, *, allow_starts: bool = False) -> None:
        self.case, self.source, self.allow_starts = case, source, allow_starts
        self.materials = materials_in(case)

    def directions(self, axes: object) -> list[_Direction]:
        """Return the dimensions of all axes."""
        directions: list[_Direction] = []
        for part in axes if isinstance(axes, (list, tuple)) else [axes]:
            if isinstance(part, RandomDesign):
                directions.append(self.sample(part))
            elif isinstance(part, Replicas):
                directions.append(self.replicas(part))
            elif isinstance(part, ParsedAxes):
                directions += part.directions
            elif isinstance(part, Mapping):
                directions += [self.axis(key, values) for key, values in part.items()]
            else:
                raise Hint(f"{part!r:.60} is not a mapping of paths to values", _EXAMPLE)
        if not directions:
            raise Hint("nothing varies", f"{_EXAMPLE}, or rb.simulate for one run")
        return directions

    def parameter(self, path: object) -> Parameter:
        return Parameter(self.case, path, self.source, self.materials)

    def axis(self, key: object, values: object) -> _Direction:
        """Return the dimension of an item of a mapping."""
        if isinstance(values, Mapping) and not isinstance(values, RecordSet):
            linked = dict(values)
        elif not isinstance(key, tuple):
            linked = {key: values}
        elif isinstance(values, (list, tuple)) and len(values) == len(key) == len(set(key)):
            linked = dict(zip(key, values, strict=True))
        else:
            raise Hint(
                f"{key}: the number of lists differs from the number of paths", "{(path, path): (values, values)}"
            )
        name = key[0] if isinstance(key, tuple) and key else key
        if not isinstance(name, str) or not name or not linked:
            raise Hint(f"{key!r} is not a path", _EXAMPLE)
        starts = self.starts(linked.pop(STARTS)) if STARTS in linked else None
        read = [self.parameter(path).values(given) for path, given in linked.items()]
        sizes = {one.parameter.path: one.array.size for one in read}
        if starts is not None:
            sizes[STARTS] = len(starts.points)
        if len(set(sizes.values())) > 1:
            counts = ", ".join(f"{path} has {size}" for path, size in sizes.items())
            raise Hint(
                f"parameters that vary together must have the same number of values, but {counts}",
                "as many values of each, or separate axes",
            )
        return _Direction(name, next(iter(sizes.values())), read, starts=starts)

    def starts(self, given: object) -> Starts:
        """Return the runs from which variants continue."""
        if not self.allow_starts:
            raise Hint(f"{STARTS}: variants of this study cannot continue runs", "an axis of rb.sweep")
        return read_starts(given)

    def sample(self, design: RandomDesign) -> _Direction:
        """Return the dimension of a random design."""
        read = []
        for (path, given), points in zip(design.ranges.items(), design.points().T, strict=True):
            parameter = self.parameter(path)
            if isinstance(given, (str, Mapping)) or not hasattr(given, "__len__") or len(given) < 2:
                raise parameter.wrong(
                    "a pair of the smallest and the largest value is needed", '("0.1 mm", "2 mm")', None, given
                )
            first = parameter.number(given[0], 0)
            if first is None:
                choice = objects([parameter.read(item, which) for which, item in enumerate(given)])
                read.append(Values(parameter, choice[(points * len(choice)).astype(int)], None))
                continue
            if len(given) > 2:
                raise parameter.wrong(
                    "a pair of the smallest and the largest value is needed", "an axis of its own", None, given
                )
            low, high, unit = parameter.ends_of(first, parameter.number(given[1], 1))
            if not low < high:
                raise parameter.wrong("the first value must be the smaller one", "", None, given)
            if path not in design.log:
                read.append(Values(parameter, low + (high - low) * points, unit))
            elif low > 0:
                read.append(Values(parameter, low * (high / low) ** points, unit))
            else:
                raise parameter.wrong(
                    "spread in its logarithm it must be greater than zero", "a positive smallest value", None, given
                )
        return _Direction("sample", design.count, read)

    def replicas(self, replicas: Replicas) -> _Direction:
        """Return the dimension of replicas."""
        read: list[Values] = []
        for (path, reach), offsets in zip(replicas.reach.items(), replicas.offsets().T, strict=True):
            parameter = self.parameter(path)
            number = parameter.number(reach, "reach")
            if number is None or number[0] <= 0:
                raise parameter.wrong("a reach greater than zero is needed", '"1 um"', "reach", reach)
            if parameter.place in [other.parameter.place for other in read]:
                raise Hint(f"{path} varies twice", "one reach for each parameter")
            read.append(Values(parameter, number[0] * offsets, number[1]))
        return _Direction("replica", replicas.count, [], read)


def _check_variants(case: Case, grid: Grid, source: str) -> None:
    """Raise if one of the extreme variants, or of a few others, is not valid."""
    # Most limits are on single values or on sums of them, which are largest at corners and extreme values.
    corners = itertools.product(*({0, length - 1} for length in grid.shape))
    indices = [int(np.ravel_multi_index(corner, grid.shape)) for corner in itertools.islice(corners, 4 * _SAMPLED)]
    for values in grid.columns.values():
        flat = values.ravel()
        numbers = flat.dtype.kind == "f"
        for which in (flat.argmin(), flat.argmax()) if numbers else range(min(flat.size, 8 * _SAMPLED)):
            indices.append(int(np.ravel_multi_index(np.unravel_index(which, values.shape), grid.shape)))
    indices += np.linspace(0, grid.size - 1, _SAMPLED).astype(int).tolist()
    for index in dict.fromkeys(indices):
        try:
            grid.case_at(case, index)
        except RattleboxError as error:
            reason = str(error).removeprefix("case: ").replace("\n", "\n  ")
            variant = grid.describe_variant(case, index)
            raise CaseError(f"{source}: variant {index} is not valid: {variant}\n  {reason}") from None


class _Columns:
    """Values of all parameters over the grid, from its dimensions."""

    def __init__(self, case: Case, directions: list[_Direction]) -> None:
        self.case, self.directions = case, directions
        self.parameters: dict[Place, Parameter] = {}
        self.found: dict[Place, Column] = {}

    def columns(self) -> dict[str, Column]:
        """Return the values by path. Start positions come last because they may depend on the gap."""
        for starts in (False, True):
            for number, direction in enumerate(self.directions):
                for values in direction.values:
                    if values.parameter.is_start == starts:
                        self.add(values.parameter, self.reduced(values, number))
            for number, direction in enumerate(self.directions):
                for values in direction.offsets:
                    if values.parameter.is_start == starts:
                        self.move(values.parameter, self.reduced(values, number))
        return {self.parameters[place].path: column for place, column in self.found.items()}

    def add(self, new: Parameter, column: Column) -> None:
        """Add a parameter; raise if it varies already."""
        new.check_independent(self.parameters.values())
        self.parameters[new.place], self.found[new.place] = new, column

    def move(self, parameter: Parameter, offsets: Column) -> None:
        """Add offsets to the values of an axis or of the case."""
        if parameter.place not in self.found:
            self.add(parameter, self.case_value(parameter))
        base = self.found[parameter.place]
        if base.dtype.kind != "f":
            raise parameter.wrong("its values are not numbers, so that offsets cannot be added")
        moved = base + offsets
        self.found[parameter.place] = self.mirrored(moved) if parameter.is_start else moved

    def case_value(self, parameter: Parameter) -> Column:
        """Return the value of the case."""
        number = None if parameter.now is None else parameter.number(parameter.now)
        if number is None:
            each = f"{parameter.path}[0]" if isinstance(parameter.now, (list, tuple)) else ""
            raise parameter.wrong("its value in the case is not one number, so that offsets cannot be added", each)
        return self.reduced(Values(parameter, np.array([number[0]]), number[1]), 0)

    def reduced(self, values: Values, number: int) -> Column:
        """Return values along one dimension of the grid; start positions as fractions of the gap."""
        shape = [1] * len(self.directions)
        shape[number] = values.array.size
        column = values.array.reshape(shape)
        return column / self.gap(values.parameter) if values.parameter.is_start and values.unit == "m" else column

    def gap(self, start: Parameter) -> Column:
        """Return the gap of the damper of a start position [m]."""
        number = int(start.place[1])
        damper = instance(self.case.dampers[number], ImpactDamper)
        own = {place[2:]: column for place, column in self.found.items() if place[:2] == ("dampers", number)}
        length, gap = own.get(("cavity_length",)), own.get(("gap",), np.array(damper.clearance / 2))
        wholes: set[Place] = {("balls",), *(("balls", ball) for ball in range(len(damper.balls)))}
        if ("dampers",) in self.found or () in own or (length is not None and wholes & own.keys()):
            raise start.wrong(
                "a length needs the gap, but the damper or its ball varies as a whole", "fractions of the gap, -1 to 1"
            )
        if length is not None:
            gap = length / 2
            for ball, sphere in enumerate(damper.balls):
                radius, diameter = own.get(("balls", ball, "radius")), own.get(("balls", ball, "diameter"))
                gap = gap - (
                    sphere.half_of(diameter / 2)
                    if diameter is not None
                    else sphere.half
                    if radius is None
                    else sphere.half_of(radius)
                )
        if not np.all(gap > 0):
            raise start.wrong("a length needs a gap greater than zero", "fractions of the gap, -1 to 1")
        return gap

    @staticmethod
    def mirrored(start: Column) -> Column:
        """Return start positions mirrored at the walls of the cavity."""
        return np.where(np.abs(start) > 1, np.copysign(2.0, start) - start, start)


def _coordinates(direction: _Direction) -> Iterator[tuple[str, tuple[str, Column, dict[str, str]]]]:
    """Yield the coordinates along one dimension."""
    name = direction.name
    if direction.starts is not None:
        yield STARTS, (name, direction.starts.labels, {"long_name": "start"})
        yield (
            f"{STARTS}.time",
            (name, direction.starts.times, {"units": "s", "long_name": "time at which the variant starts"}),
        )
    if name not in [values.parameter.path for values in direction.values] and (
        name != STARTS or direction.starts is None
    ):
        yield name, (name, np.arange(direction.size), {"units": "1", "long_name": f"number of {name}"})
    for values in direction.values:
        path = values.parameter.path
        attrs = {"long_name": _words(path)} | ({} if values.unit is None else {"units": values.unit})
        yield path, (name, labels(values.array) if values.unit is None else values.array, attrs)
    for values in direction.offsets:
        path = f"{values.parameter.path}.offset"
        yield path, (name, values.array, {"units": str(values.unit), "long_name": _words(path)})


def _words(path: str) -> str:
    return path.replace(".", " ").replace("_", " ")


# ---- axes of repeated runs


def robust_axes(case: Case, levels: object = None, starts: int | Sequence[Any] | None = None) -> list[Any]:
    """Return the axes of load levels and start positions; an empty list for one run."""
    axes = list(levels) if isinstance(levels, (list, tuple)) else [] if levels is None else [levels]
    if starts is not None:
        if [len(damper.balls) for damper in case.impact_dampers] != [1]:
            raise Hint("starts requires a case with exactly one ball", 'levels={"dampers[0].start": [...]}')
        is_list = hasattr(starts, "__len__")
        axes.append({"damper.start": starts if is_list else np.linspace(-1, 1, whole_number(starts, "starts", 2))})
    return axes


def packing_axis(case: Case, count: int, first: int = 0) -> dict[str, Any]:
    """Return an axis "packing" along which the random packings of all particle dampers vary together.

    `first`: number of packings that are left out at the beginning.
    """
    seeds: dict[str, list[int]] = {}
    for index, damper in enumerate(case.dampers):
        packing: Any = getattr(damper, "packing", None)
        if packing is not None and packing.is_random:
            seeds[f"dampers[{index}].packing.seed"] = list(range(packing.seed + first, packing.seed + count))
    if not seeds:
        raise no_random_packing()
    return {"packing": seeds}


def no_random_packing(argument: str = "packings") -> Hint:
    """Return the error for repeated runs of a case whose initial state has no random part; names their argument."""
    return Hint(
        "the packing has no random seed, so that all repeated runs would be equal",
        f"packing = rb.Settled(seed=1), rb.Lattice with noise, or {argument} = 1",
        ["packing"],
    )
