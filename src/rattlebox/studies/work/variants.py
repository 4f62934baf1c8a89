"""Variants of a case with their measures, window and digests, the observed motion, and the selection of variants."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from hashlib import sha256
from inspect import getclosurevars, getsource
from pathlib import Path
from threading import Lock
from types import CodeType, FunctionType, MethodType
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rattlebox._util.exceptions import RattleboxError
from rattlebox._util.flags import flag_values
from rattlebox.core import _core
from rattlebox.model.base import Part, full_text
from rattlebox.model.errors import Hint, nearest
from rattlebox.model.foreign_code import foreign_code
from rattlebox.model.modes import ModalModel
from rattlebox.model.paths import all_paths, get
from rattlebox.results.extremes import require_storeys
from rattlebox.studies.grid.grid import Grid
from rattlebox.studies.work.measures import INTERVAL, MEASURES, OF_RUN, about, name_of
from rattlebox.studies.work.work import AlongLast, Independent, Outputs

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case
    from rattlebox.results import Run


# ---- fingerprints of functions


def fingerprint(function: Callable[..., object]) -> str:
    """Return a digest of the source of a function and of the values that it refers to."""
    return _Digest(function).hexdigest()


_PLAIN = (str, bytes, bool, int, float, complex, type(None))


class _Digest:
    """Digest of a function, to which the values that it refers to are added recursively."""

    def __init__(self, function: object) -> None:
        self._hash = sha256()
        self._added: list[Any] = []  # functions and types
        self._parents: list[Any] = []  # other objects, parts of which are being added
        innermost = function
        while isinstance(innermost, partial):
            innermost = innermost.func
        self._package = _package(innermost)
        self._add(function)

    def hexdigest(self) -> str:
        return self._hash.hexdigest()[:12]

    def _update(self, *values: object) -> None:
        """Add the text of values, without addresses in memory."""
        for value in values:
            text = value if isinstance(value, bytes) else re.sub(r" at 0x[0-9a-fA-F]+", "", str(value)).encode()
            self._hash.update(b"%d " % len(text) + text)

    def _add(self, value: object) -> None:
        if isinstance(value, _PLAIN):
            return self._update(repr(value))
        known = [number for number, each in enumerate([*self._added, *self._parents]) if each is value]
        if known:  # a function that calls itself, a list that holds itself
            return self._update("as", known[0])
        if isinstance(value, (FunctionType, type)):
            self._added.append(value)
            return self._add_content(value)
        self._parents.append(value)
        self._add_content(value)
        self._parents.pop()
        return None

    def _add_content(self, value: object) -> None:
        if isinstance(value, (FunctionType, type)) and _package(value) != self._package:
            self._update(value.__module__, value.__qualname__)
        elif isinstance(value, FunctionType):
            self._add_source(value, value.__code__)
            outer = getclosurevars(value)
            for part in (value.__defaults__, value.__kwdefaults__, outer.nonlocals, outer.globals):
                self._add(part)
        elif isinstance(value, type):
            self._add_source(value, value.__qualname__)
        elif isinstance(value, CodeType):
            self._update(value.co_code, value.co_names)
            self._add(value.co_consts)
        elif isinstance(value, partial):
            self._add((value.func, value.args, value.keywords))
        elif isinstance(value, MethodType):
            self._add((value.__func__, value.__self__))
        elif isinstance(value, np.ndarray) and value.dtype != object:
            self._update(value.dtype, value.shape, value.tobytes())
        elif isinstance(value, Mapping):
            self._add([*value, *value.values()])
        elif isinstance(value, (list, tuple)):
            self._update(type(value).__name__, len(value))
            for item in value:
                self._add(item)
        elif isinstance(value, (set, frozenset)):
            self._update(*sorted(map(repr, value)))
        else:
            self._update(full_text(value))
            if _package(type(value)) == self._package:
                self._add((type(value), getattr(value, "__dict__", None)))

    def _add_source(self, value: Any, otherwise: Any) -> None:
        """Add the source of a function or type, or something else if it is not available."""
        try:
            self._update(getsource(value))
        except (OSError, TypeError):
            self._add(otherwise)


def _package(value: object) -> str:
    module = getattr(value, "__module__", None) or type(value).__module__
    return str(module).partition(".")[0]


# ---- cases


_LENGTH = 12
"""Number of characters of a digest."""


def describe_case(case: Case, columns: Mapping[str, Any]) -> dict[str, Any]:
    """Return a case in JSON types, with digests of the files that it or its variants name, and of code of other packages."""
    files = {path: _digest_of_numbers(part) for path, part in _parts_from_files(case)}
    for path, values in columns.items():
        holder, _, name = path.rpartition(".")
        if name == "file":
            files |= {f"{path} = {file}": _digest_of_file(file) for file in sorted(set(np.ravel(values).tolist()))}
        elif name == "columns" and (file := getattr(get(case, holder), "file", None)):
            files[f"{holder}.file"] = _digest_of_file(file)
    code = foreign_code(case)
    return {"case": case.to_toml(), **({"files": files} if files else {}), **({"code": code} if code else {})}


def _parts_from_files(case: Case) -> Iterator[tuple[str, Part]]:
    """Yield the parts whose numbers come from files, with the path of the file."""
    for path in all_paths(case):
        value = get(case, path)
        for number, part in enumerate(value if isinstance(value, tuple) else (value,)):
            if isinstance(part, Part) and part.file_fields and getattr(part, "file", None) is not None:
                yield (f"{path}[{number}].file" if isinstance(value, tuple) else f"{path}.file"), part


def _digest_of_numbers(part: Part) -> str:
    digest = sha256()
    for name in part.file_fields:
        value = getattr(part, name)
        if isinstance(value, dict):
            value = [row for point in sorted(value) for row in np.ravel(value[point])]
        if value is not None:
            numbers = np.ascontiguousarray(np.asarray(value, dtype=float))
            digest.update(f"{name} {numbers.shape}".encode() + numbers.tobytes())
    return digest.hexdigest()[:_LENGTH]


def _digest_of_file(file: str) -> str:
    return sha256(Path(file).read_bytes()).hexdigest()[:_LENGTH]


# ---- variants


AMPLITUDE, FREQUENCY = "structure.motion.amplitude", "structure.motion.frequency"
"""Axes of a loss map."""

FloatArray = NDArray[np.float64]
Packed = TypeVar("Packed", bound=_core.Node)
UserMeasure = Callable[["Run"], float]
_function_lock = Lock()  # functions of users need not be thread-safe


class MeasureError(Hint):
    """Error of a function of a Run: it ends a study, while a variant that cannot run is only refused."""


@dataclass(frozen=True)
class Variants:
    """Variants of a case, the window in which they are evaluated, and the measures of each."""

    case: Case
    grid: Grid
    measures: Sequence[str | UserMeasure] = ()
    skip: float = 0.0  # Time from which measures are evaluated [s]
    cycles: tuple[int, int] | None = None
    samples: int | None = None
    point: str | None = None
    intervals: bool = False

    @cached_property
    def names(self) -> list[str]:
        """Measures that are given by name and computed by the core."""
        return [measure for measure in self.measures if isinstance(measure, str) and measure not in OF_RUN]

    @cached_property
    def names_of_run(self) -> list[str]:
        """Measures that are given by name and computed from a Run."""
        return [measure for measure in self.measures if isinstance(measure, str) and measure in OF_RUN]

    @cached_property
    def functions(self) -> dict[str, UserMeasure]:
        """Measures that are functions of a Run, by name."""
        return {name_of(measure): measure for measure in self.measures if not isinstance(measure, str)}

    @cached_property
    def averages(self) -> list[str]:
        """Measures with an interval: averages over a motion that is driven until the end of the run."""
        signals = (*self.case.loads, *self.case.base, *self.case.shaker_motion)
        if not self.intervals or not any(signal.is_lasting for signal in signals):
            return []
        return [name for name in self.names if MEASURES[name].average]

    @cached_property
    def outputs(self) -> Outputs:
        """Further dimensions, number type and attributes of the status and of each measure."""
        outputs: Outputs = {
            "status": ((), "int8", {"long_name": "status of the run", **flag_values(s.name for s in _core.Status)}),
            **{
                name: ((), "float64", {"units": self._units(name), "long_name": MEASURES[name].long_name})
                for name in self.names
            },
        }
        for name in self.names_of_run:
            outputs[name] = ((), "float64", {"units": MEASURES[name].units, "long_name": MEASURES[name].long_name})
        for name in self.averages:
            text = f"half of the 95 % interval, {MEASURES[name].long_name}"
            outputs[name + INTERVAL] = ((), "float64", {"units": self._units(name), "long_name": text})
        for name, function in self.functions.items():
            declared = about(function)
            outputs[name] = ((), "float64", {"units": declared.units, "long_name": declared.long_name})
        return outputs

    @property
    def observed(self) -> Observed | None:
        """The observed motion, if it is named."""
        return None if self.point is None else Observed.of(self.case.modes, self.point)

    def units_of(self, units: str) -> str:
        """Return the unit of the observed motion for that of a point."""
        observed = self.observed
        return observed.units(units) if observed else units

    def _units(self, name: str) -> str:
        return self.units_of(MEASURES[name].units) if MEASURES[name].samples else MEASURES[name].units

    def require_structure(self) -> None:
        """Raise if a measure needs floors or the participation of the modes, which the structure lacks."""
        if "largest_drift" in self.names_of_run:
            require_storeys(self.case.modes.lines())
        of_walls = [name for name in self.names_of_run if MEASURES[name].of_walls]
        if of_walls and not self.case.particle_dampers:
            raise Hint(f"{of_walls[0]} is that of the walls around particles", "a ParticleDamper")
        asked = [name for name in self.names if MEASURES[name].of_base_force]
        modes = self.case.modes
        if not asked:
            return
        if not modes.decay.size:
            raise Hint(f"{asked[0]} needs a structure that moves", "peak_damper_force, the force on the cavity")
        if modes.participation is None:
            raise Hint(f"{asked[0]} needs the participation of the modes", "participation = [...] of the structure")

    def describe(self) -> dict[str, Any]:
        """Return a description of everything except the grid, in JSON types."""
        functions = (f"{name} {fingerprint(function)}" for name, function in self.functions.items())
        return {
            **describe_case(self.case, self.grid.columns),
            "measures": [*self.names, *self.names_of_run, *functions],
            "cycles": None if self.cycles is None else list(self.cycles),
            **{name: getattr(self, name) for name in ("skip", "samples", "point")},
        }

    @property
    def needs_run(self) -> bool:
        """Whether a measure is computed from a Run."""
        return bool(self.functions or self.names_of_run)

    def call_functions(self, run: Run, evaluated: Run, index: int) -> dict[str, float]:
        """Return the values of the functions of a Run, and of the measures of its evaluated part."""
        values = {name: OF_RUN[name](evaluated) for name in self.names_of_run}
        for name, function in self.functions.items():
            try:
                with _function_lock:
                    value: Any = function(run)
            except RattleboxError as error:
                raise error.restated(MeasureError, f"measure {name}, variant {index}") from error
            try:
                if isinstance(value, str) or np.ndim(value):
                    raise TypeError
                values[name] = float(value)
            except TypeError:
                kind = type(value).__name__
                raise MeasureError(
                    f"measure {name}: the function returned {kind} for variant {index}, not one number", "float(...)"
                ) from None
        return values


# ---- observed motion


@dataclass(frozen=True)
class Observed:
    """A point of the structure, the difference of two points, or a mode."""

    name: str
    lower: str = ""
    mode: int | None = None

    @classmethod
    def of(cls, modes: ModalModel, text: str) -> Observed:
        """Return the quantity that a text names."""
        lines = modes.lines()
        if text in lines:
            return cls(text)
        if number := re.fullmatch(r"mode (\d+)", text):
            mode = int(number[1])
            if not 1 <= mode <= modes.decay.size:
                count = modes.decay.size
                raise Hint(f"there is no {text}", f'"mode 1" to "mode {count}"' if count else "a point", ["point"])
            return cls(text, mode=mode - 1)
        for upper in lines:
            if text.startswith(f"{upper} - ") and (lower := text.removeprefix(f"{upper} - ")) in lines:
                return cls(upper, lower)
        spatial = next((f"{text} {axis}" for axis in "xyz" if f"{text} {axis}" in lines), None)
        advice = nearest(text, lines) if spatial is None else f'point = "{spatial}", since it moves in 3-D'
        raise Hint(f"there is no point {text!r}", f'{advice}; "a - b" for a drift, "mode 1"', ["point"])

    @property
    def moves_with_base(self) -> bool:
        """Whether the absolute motion contains that of the base."""
        return not self.lower and self.mode is None

    def shape(self, points: Mapping[str, FloatArray], modes: int) -> FloatArray:
        """Return the mode shapes, (m, ...), from those of the points."""
        if self.mode is not None:
            unit = np.asarray(np.eye(modes)[self.mode])
            axes = next((shape.ndim for shape in points.values()), 1) - 1
            return np.asarray(unit.reshape(-1, *(1,) * axes))
        for name in (self.name, self.lower):
            if name and name not in points:
                raise Hint(f"the structure of a variant has no point {name!r}", nearest(name, points), ["point"])
        return points[self.name] - points[self.lower] if self.lower else points[self.name]

    def column(self, points: Sequence[str], of_points: FloatArray, of_modes: FloatArray) -> FloatArray:
        """Return the motion, (T,), from that of all points (T, P) and modes (T, M)."""
        if self.mode is not None:
            return np.asarray(of_modes[:, self.mode])
        own = of_points[:, points.index(self.name)]
        return np.asarray(own - of_points[:, points.index(self.lower)] if self.lower else own)

    def units(self, units: str) -> str:
        """Return the unit of a measure of this motion."""
        return f"kg^0.5 {units}" if self.mode is not None and units in ("m", "m/s", "m/s^2") else units


# ---- selection


def gather_variants(node: Packed, shape: Sequence[int], members: NDArray[np.intp], further: int = 0) -> Packed:
    """Return a batch, or a part of it, for some of its variants."""
    changes: dict[str, object] = {}
    for name, varies in node.fields().items():
        value = getattr(node, name)
        if varies is not _core.Varies.never:
            changes[name] = None if value is None else gather_values(value, shape, members, further)
        elif isinstance(value, _core.Node):
            changes[name] = gather_variants(value, shape, members, further)
        elif isinstance(value, list):
            changes[name] = [gather_variants(item, shape, members, further) for item in value]
    return node.replace(**changes)


def gather_values(
    values: ArrayLike, shape: Sequence[int], members: NDArray[np.intp], further: int = 0
) -> NDArray[np.float64]:
    """Return a number, or a vector with the axes of the grid after its own, for some variants.

    Returns values with one axis for the variants, or a number if they do not vary, (..., n, 1, ...).
    """
    array = np.asarray(values, dtype=float)
    if array.ndim == 0:
        return array
    places = np.unravel_index(members, tuple(shape)) if shape else ()
    own = array.ndim - len(places)  # axes of a vector
    ones = (1,) * further
    if all(n == 1 for n in array.shape[own:]):
        return array.reshape(*array.shape[:own], 1, *ones)
    index = tuple(place if n > 1 else 0 * place for place, n in zip(places, array.shape[own:], strict=True))
    selected = array[(slice(None),) * own + index]
    return np.ascontiguousarray(selected).reshape(*selected.shape, *ones)


# ---- directions


def order_along(grid: Grid, direction: str, *, turn_back: bool = False) -> tuple[Grid, AlongLast | Independent]:
    """Return grid and order of variants that start from each other in a direction; "fresh" for none of this.

    "both" is up and down. With `turn_back` the way down starts from the end of the way up.
    """
    if direction == "fresh":
        return grid, Independent()
    directions = ("up", "down") if direction == "both" else (direction,)
    coordinate = "direction", np.array(directions), {"long_name": "direction"}
    full = Grid(
        ("direction", *grid.dims),
        (len(directions), *grid.shape),
        {path: column[None] for path, column in grid.columns.items()},
        {"direction": coordinate, **grid.coords()},
    )
    return full, AlongLast(directions, full.size, turn_back and direction == "both")


def with_direction(runs: xarray.Dataset) -> xarray.Dataset:
    """Return runs over a direction, which is "fresh" for independent ones, without the states from which others started."""
    if "direction" not in runs.dims:
        return runs.expand_dims(direction=["fresh"])
    return runs.drop_dims("component", errors="ignore").drop_vars("lead", errors="ignore")
