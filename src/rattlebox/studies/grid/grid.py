"""Grid of the variants of a case, along whose dimensions parameters vary."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from hashlib import sha256
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.base import Part
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint
from rattlebox.model.paths import replaced, unit_of
from rattlebox.model.restitutions import Constant

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

    def describe_variant(self, case: Case, index: int) -> str:
        """Return the values of one variant with units in one line; for the parameters see `case_at`."""
        units = {path: unit_of(case, path) for path in self.columns}
        return ", ".join(
            f"{path} = {_label(value)}" + (f" {units[path]}" if units[path] not in (None, "1") else "")
            for path, value in self.values_at(index).items()
        )

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
        }


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


def _plain(value: Any) -> Any:
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


def _label(value: Any) -> str:
    """Return a short text for a value."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_label, value))}]"
    if not isinstance(value, Part):
        return str(value)
    if getattr(value, "name", ""):
        return str(getattr(value, "name", ""))
    fields = {key: _label(getattr(value, key)) for key in sorted(value.model_fields_set - {"kind"})}
    if isinstance(value, Constant) and fields.keys() == {"e"}:
        return fields["e"]
    kind = getattr(value, "kind", type(value).__name__)
    return f"{kind}({', '.join(f'{key}={text}' for key, text in fields.items())})" if fields else str(kind)
