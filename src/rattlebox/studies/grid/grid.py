"""Grid of the variants of a case, and the parameters that vary along its dimensions."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, field
from functools import cache
from hashlib import sha256
from numbers import Real
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, ValidationError, create_model

from rattlebox._util.exceptions import CaseError
from rattlebox.model.base import Part, vocabulary
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint, translate
from rattlebox.model.materials import Material
from rattlebox.model.paths import Place, get_field, place_of, replaced, unit_of
from rattlebox.model.record_sets import RecordSet
from rattlebox.model.restitutions import Restitution
from rattlebox.model.signals import Signal
from rattlebox.model.units import parse, plain
from rattlebox.studies.grid.sampling import Spaced
from rattlebox.studies.grid.starts import StartPoint, Starts

Column = NDArray[Any]
"""Values of a parameter: float64, or objects."""

_LISTED = 16
"""Largest number of values that a description lists."""


@dataclass(frozen=True, eq=False)
class Grid:
    """The variants of a case: a grid, along each dimension of which one or several parameters vary."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    columns: dict[str, Column]
    _coords: dict[str, tuple[str, Column, dict[str, str]]] = field(repr=False)
    # Dimension along which the starts vary, and these; None if all variants start as their case says
    starts: tuple[str, Starts] | None = None

    @property
    def size(self) -> int:
        """Number of variants."""
        return math.prod(self.shape)

    def coords(self) -> dict[str, tuple[str, Column, dict[str, str]]]:
        """Return the coordinates of an xarray Dataset: (dimension, values, attributes) by name."""
        return dict(self._coords)

    def values_at(self, index: int) -> dict[str, Any]:
        """Return the values of one variant by path."""
        if not 0 <= index < self.size:
            raise Hint(f"{index} is not the number of a variant", f"0 to {self.size - 1}")
        place = np.unravel_index(index, self.shape)
        members = {
            path: values[tuple(0 if length == 1 else at for at, length in zip(place, values.shape, strict=True))]
            for path, values in self.columns.items()
        }
        return {path: float(value) if isinstance(value, float) else value for path, value in members.items()}

    def case_at(self, case: Case, index: int) -> Case:
        """Return the case of one variant."""
        return replaced(case, self.values_at(index))

    def start_at(self, index: int) -> StartPoint | None:
        """Return the run, or time of a run, from which a variant continues; None if it starts as its case says."""
        if self.starts is None:
            return None
        dim, starts = self.starts
        return starts.points[np.unravel_index(index, self.shape)[self.dims.index(dim)]]

    def describe_variant(self, case: Case, index: int) -> str:
        """Return the values of one variant with units in one line; for the parameters see `case_at`."""
        units = {path: unit_of(case, path) for path in self.columns}
        parts = [
            f"{path} = {_label(value)}" + (f" {units[path]}" if units[path] not in (None, "1") else "")
            for path, value in self.values_at(index).items()
        ]
        if self.starts is not None:
            dim, starts = self.starts
            parts.append(f"start = {starts.labels[np.unravel_index(index, self.shape)[self.dims.index(dim)]]}")
        return ", ".join(parts)

    def describe(self) -> dict[str, Any]:
        """Return a description in JSON types; equal grids have equal descriptions."""
        return {
            "dims": [[name, length] for name, length in zip(self.dims, self.shape, strict=True)],
            "columns": {
                path: {"varies_along": [d for d, n in zip(self.dims, values.shape, strict=True) if n > 1]}
                | _summary(values)
                for path, values in sorted(self.columns.items())
            },
            "coords": {
                name: {"dim": dim, "units": attrs.get("units")} | _summary(values)
                for name, (dim, values, attrs) in sorted(self._coords.items())
                if name not in self.columns and values.dtype.kind == "f"
            },
            **self._describe_starts(),
        }

    def _describe_starts(self) -> dict[str, Any]:
        if self.starts is None:
            return {}
        dim, starts = self.starts
        return {"starts": {"varies_along": dim, "points": [point.describe() for point in starts.points]}}


def _summary(values: Column) -> dict[str, Any]:
    """Return the values of an array, or a digest of many values."""
    flat = values.ravel()
    if flat.dtype.kind == "f":
        if flat.size <= _LISTED:
            return {"values": flat.tolist()}
        ends = {"first": flat[0], "last": flat[-1], "smallest": flat.min(), "largest": flat.max()}
        digest = sha256(np.ascontiguousarray(flat, dtype="<f8").tobytes()).hexdigest()
        return {"count": flat.size, **{name: float(value) for name, value in ends.items()}, "sha256": digest}
    plain = {id(value): _plain(value) for value in {id(value): value for value in flat}.values()}
    if flat.size <= _LISTED:
        return {"values": [plain[id(value)] for value in flat]}
    digests = {key: sha256(json.dumps(item, sort_keys=True).encode()).digest() for key, item in plain.items()}
    return {"count": flat.size, "sha256": sha256(b"".join(digests[id(value)] for value in flat)).hexdigest()}


def _plain(value: object) -> Any:
    """Return an object in JSON types."""
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value.model_dump(mode="json", exclude_none=True) if isinstance(value, Part) else value


def labels(items: Column) -> Column:
    """Return different labels for different objects."""
    different = {id(item): item for item in items}
    texts = {key: _label(item) for key, item in different.items()}
    first: dict[str, Any] = {}
    if any(first.setdefault(texts[key], item) != item for key, item in different.items()):
        return np.array([f"{texts[id(item)]} ({number})" for number, item in enumerate(items, start=1)])
    return np.array([texts[id(item)] for item in items])


_LONGEST_LIST = 6
"""Number of numbers of a list that its label shows; of a longer one the first and the last."""


def _label(value: object) -> str:
    """Return a short text for a value."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, tuple) and len(value) == 1 and isinstance(value[0], Part):  # of a field for several
        (value,) = value
    if isinstance(value, (list, tuple)):
        items = [_label(item) for item in value]
        if len(items) > _LONGEST_LIST and all(isinstance(item, (int, float)) for item in value):
            items = [items[0], "...", items[-1]]
        return f"[{', '.join(items)}]" if items else "none"
    if not isinstance(value, Part):
        return str(value)
    if getattr(value, "name", ""):
        return str(getattr(value, "name", ""))
    if label := value.short_label():
        return label
    fields = {key: _label(getattr(value, key)) for key in sorted(value.model_fields_set - {"kind"})}
    if fields.keys() == {"e"}:
        return fields["e"]
    kind = getattr(value, "kind", type(value).__name__)
    return f"{kind}({', '.join(f'{key}={text}' for key, text in fields.items())})" if fields else str(kind)


# ---- parameters


@dataclass(frozen=True, eq=False)
class Values:
    """Values of a parameter along one dimension: numbers in SI units with their unit, or objects with unit None."""

    parameter: Parameter
    array: Column
    unit: str | None


class Parameter:
    """A parameter of a case, addressed by its path."""

    def __init__(self, case: Case, path: object, source: str, materials: dict[str, Material]) -> None:
        if not isinstance(path, str):
            raise Hint(f"{path!r} is not a path", '"damper.gap"')
        self.path, self.source, self.materials = path, source, materials
        self.place: Place = place_of(case, path)
        if self.place[-1] == "kind":
            whole = path.rpartition(".")[0]
            raise Hint(
                f"{path} cannot vary alone: each kind has fields of its own", f'whole parts, {{"{whole}": [...]}}'
            )
        node: Any = case
        for number, step in enumerate(self.place):
            if isinstance(node, Part):
                self.part, self.name, self.inner = node, str(step), self.place[number + 1 :]
            node = get_field(node, str(step)) if isinstance(node, Part) else node[step]
        self.now = node
        self.is_start = self.name in getattr(self.part, "gap_fractions", ())
        self.unit = "1" if self.is_start else unit_of(case, path)

    @property
    def is_whole(self) -> bool:
        """Whether the values are whole numbers."""
        return not self.inner and _numbers(type(self.part).model_fields[self.name].annotation) == {int}

    def check_independent(self, others: Iterable[Parameter]) -> None:
        """Raise if other parameters are the same as this one, or exclude it."""
        for other in others:
            if other.place == self.place:
                also = f", also as {other.path}" if other.path != self.path else ""
                raise Hint(f"{self.path} varies twice{also}", "one axis with all of its values")
            pairs = self.part.alternatives if other.place[:-1] == self.place[:-1] else ()
            if (other.name, self.name) in pairs or (self.name, other.name) in pairs:
                raise Hint(f"{other.path} and {self.path} exclude each other", "one of them")

    def read(self, value: object, which: int | str | None = None) -> Any:
        """Return a value as the case stores it."""
        content = {self.name: _put(get_field(self.part, self.name), self.inner, value)}
        try:
            result = getattr(
                _field(type(self.part), self.name).model_validate(content, context=self.materials), self.name
            )
        except ValidationError as error:
            message = str(translate(error, "\0", vocabulary(), content))
            inside = self.name + "".join(f"[{s}]" if isinstance(s, int) else f".{s}" for s in self.inner)
            name = self.label(which)
            raise CaseError(message.replace(f"\0: {inside}", name).replace("\0:", f"{name}:")) from None
        for step in self.inner:
            result = result[step]
        return result

    def number(self, value: object, which: int | str | None = None) -> tuple[float, str] | None:
        """Return a value in SI units with its unit; None if it is not a number."""
        if isinstance(self.part, Signal) and self.name == "amplitude":
            # The field itself would accept the units of other signals.
            try:
                value, _ = parse(value, (self.unit or "1",))
            except Hint as hint:
                raise self.wrong(hint.complaint, hint.suggestion, which, value) from None
        result = self.read(value, which)
        if isinstance(result, tuple) and len(result) == 1:  # a list of one load, ball or start position
            (result,) = result
        if isinstance(result, Restitution) and result.constant_value is not None and result.maximum == 1:
            result = result.constant_value
        number = None if isinstance(value, bool) else plain(value)
        if isinstance(result, Part) and isinstance(number, Real):  # the case accepts a number in place of the part
            result = number
        if isinstance(result, str) and self.is_start:
            return parse(result, ("m",))[0], "m"
        if isinstance(result, bool) or not isinstance(result, Real):
            return None
        return float(result), self.unit or "1"

    def ends(self, low: object, high: object, names: Sequence[str | int] = (0, 1)) -> tuple[float, float, str]:
        """Return the ends of a range in SI units with their unit."""
        if self.unit is None:
            raise self.wrong("its values are not numbers", "a list of values")
        return self.ends_of(self.number(low, names[0]), self.number(high, names[1]))

    def ends_of(self, start: tuple[float, str] | None, stop: tuple[float, str] | None) -> tuple[float, float, str]:
        """Return the ends of a range with their unit from two results of `number`."""
        if self.unit is None or start is None or stop is None:
            raise self.wrong("its values are not numbers", "a list of values")
        if start[1] != stop[1]:
            raise self.mixed()
        return start[0], stop[0], start[1]

    def values(self, given: object) -> Values:
        """Validate a list of values."""
        if isinstance(given, RecordSet):
            given = list(given.values())
        if isinstance(given, Spaced):
            start, stop, unit = self.ends(given.start, given.stop, given.names)
            try:
                return Values(self, given.values(start, stop), unit)
            except Hint as hint:
                raise self.wrong(hint.complaint, hint.suggestion) from None
        if isinstance(given, (str, bytes, Mapping, Set, Part)) or not hasattr(given, "__iter__"):
            raise self.not_a_list(given)
        numbers = _as_numbers(given)
        if numbers is not None and numbers.size:
            bad = np.flatnonzero(~np.isfinite(numbers))
            if bad.size:
                raise self.wrong("a finite number is needed", "", int(bad[0]), float(numbers[bad[0]]))
            found = [self.number(float(numbers[which]), int(which)) for which in (numbers.argmin(), numbers.argmax())]
            if found[0] is not None:
                return Values(self, numbers, found[0][1])
        try:
            items = given.tolist() if isinstance(given, np.ndarray) and given.ndim else list(given)
        except TypeError:  # an array without dimensions
            raise self.not_a_list(given) from None
        if not items:
            raise self.wrong("there are no values", "a list of at least one")
        found = [self.number(item, which) for which, item in enumerate(items)]
        quantities = [number for number in found if number is not None]
        if len(quantities) < len(found):
            return Values(self, objects([self.read(item) for item in items]), None)
        if len({unit for _, unit in quantities}) > 1:
            raise self.mixed()
        return Values(self, np.array([number for number, _ in quantities]), quantities[0][1])

    def label(self, which: int | str | None = None) -> str:
        """Return the name of the parameter, or of one of its values, for messages."""
        item = "" if which is None else f"[{which}]" if isinstance(which, int) else f", {which}"
        return f"{self.source}: {self.path}{item}"

    def wrong(self, complaint: str, suggestion: str = "", which: int | str | None = None, *value: Any) -> CaseError:
        """Return an error about the parameter, or about one of its values."""
        content = "".join(f" = {item!r:.60}" for item in value)
        return CaseError(f"{self.label(which)}{content}\n  {Hint(complaint, suggestion)}")

    def mixed(self) -> CaseError:
        """Return an error about start positions of both kinds."""
        return self.wrong("some values are fractions of the gap and some are lengths", "all of one kind")

    def not_a_list(self, given: object) -> CaseError:
        """Return an error about a single value in place of a list."""
        suggestion = f"[{given!r}]" if isinstance(given, (str, int, float)) else ""
        return self.wrong("a list of values is needed", suggestion, None, given)


def _numbers(annotation: object) -> set[type]:
    """Return the types of numbers in an annotation."""
    if annotation in (int, float):
        return {annotation}
    return {number for each in get_args(annotation) for number in _numbers(each)}


@cache
def _field(part: type[Part], name: str) -> type[BaseModel]:
    """Return a pydantic model with one field of a part."""
    info = part.model_fields[name]
    config = ConfigDict(arbitrary_types_allowed=True, allow_inf_nan=False)
    fields: dict[str, Any] = {name: (info.annotation, info)}
    return create_model("Value", __config__=config, **fields)


def _put(node: Any, inner: Place, value: Any) -> Any:
    """Return a copy of nested lists and dictionaries with another value at a place."""
    if not inner:
        return value
    copy: Any = dict(node) if isinstance(node, dict) else list(node)
    copy[inner[0]] = _put(copy[inner[0]], inner[1:], value)
    return copy


def _as_numbers(given: object) -> NDArray[np.float64] | None:
    """Return values as a vector if all are plain numbers; else None."""
    if isinstance(given, (list, tuple, range)):
        if not all(isinstance(item, (int, float, np.number)) and not isinstance(item, bool) for item in given):
            return None
    elif not hasattr(given, "__array__") or hasattr(given, "magnitude"):
        return None
    try:
        array = np.asarray(given)
    except OverflowError:
        return None
    return array.astype(float) if array.ndim == 1 and array.dtype.kind in "iuf" else None


def objects(items: Sequence[object]) -> Column:
    """Return an array of objects, without conversion of the items."""
    array = np.empty(len(items), dtype=object)
    for number, item in enumerate(items):
        array[number] = item
    return array
