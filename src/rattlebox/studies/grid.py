"""Variants of a case: a grid along whose dimensions parameters vary."""

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

_LISTED = 16  # values that a description lists in full


@dataclass(frozen=True, eq=False)
class Grid:
    """The variants of a case: a grid of some dimensions, along each of which one parameter varies, or several linked ones.

    Attributes
    ----------
    dims : tuple of str
        Names of the dimensions; the last one varies fastest.
    shape : tuple of int
        Their lengths.
    columns : dict of str to array
        By path: the values, broadcastable to `shape`. Numbers in SI, float64; else an array of objects as they stand in a
        Case. Start positions are fractions of the gap.
    """

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
        """Return what is different in one variant, by path.

        Parameters
        ----------
        index
            Number of the variant, from 0, the last dimension varying fastest.
        """
        if not 0 <= index < self.size:
            raise Hint(f"there is no variant {index}", f"0 to {self.size - 1}")
        place = np.unravel_index(index, self.shape)
        members = {
            path: values[tuple(0 if length == 1 else at for at, length in zip(place, values.shape, strict=True))]
            for path, values in self.columns.items()
        }
        return {path: float(value) if isinstance(value, float) else value for path, value in members.items()}

    def case_at(self, case: Case, index: int) -> Case:
        """Return the case of one variant.

        Parameters
        ----------
        case
            The case that varies.
        index
            Number of the variant, from 0, the last dimension varying fastest.

        Raises
        ------
        CaseError
            When there is no such variant, or its parts do not fit together.
        """
        return replaced(case, self.values_at(index))

    def told(self, case: Case, index: int) -> str:
        """Return what is different in one variant in a line, with units; arguments as of `case_at`."""
        units = {path: unit_of(case, path) for path in self.columns}
        return ", ".join(
            f"{path} = {_label(value)}" + (f" {units[path]}" if units[path] not in (None, "1") else "")
            for path, value in self.values_at(index).items()
        )

    def describe(self) -> dict[str, Any]:
        """Return what JSON can hold of the design; equal designs have equal descriptions, however they were spelt."""
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
    """What tells an array from any other."""
    flat = values.ravel()
    if flat.dtype.kind == "f":
        if flat.size <= _LISTED:
            return {"values": flat.tolist()}
        ends = {"first": flat[0], "last": flat[-1], "smallest": flat.min(), "largest": flat.max()}
        digest = sha256(np.ascontiguousarray(flat, dtype="<f8").tobytes()).hexdigest()
        return {"count": flat.size, **{name: float(value) for name, value in ends.items()}, "sha256": digest}
    told = {id(value): _plain(value) for value in {id(value): value for value in flat}.values()}
    if flat.size <= _LISTED:
        return {"values": [told[id(value)] for value in flat]}
    digests = {key: sha256(json.dumps(item, sort_keys=True).encode()).digest() for key, item in told.items()}
    return {"count": flat.size, "sha256": sha256(b"".join(digests[id(value)] for value in flat)).hexdigest()}


def _plain(value: Any) -> Any:
    """What JSON can hold of an object."""
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value.model_dump(mode="json", exclude_none=True) if isinstance(value, Part) else value


def labels(items: Column) -> Column:
    """Return texts that tell objects apart."""
    different = {id(item): item for item in items}
    texts = {key: _label(item) for key, item in different.items()}
    first: dict[str, Any] = {}
    if any(first.setdefault(texts[key], item) != item for key, item in different.items()):
        return np.array([f"{texts[id(item)]} ({number})" for number, item in enumerate(items, start=1)])
    return np.array([texts[id(item)] for item in items])


def _label(value: Any) -> str:
    """A short text for a value."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_label, value))}]"
    if not isinstance(value, Part):
        return str(value)
    if getattr(value, "name", ""):
        return str(getattr(value, "name", ""))
    given = {key: _label(getattr(value, key)) for key in sorted(value.model_fields_set - {"kind"})}
    if isinstance(value, Constant) and given.keys() == {"e"}:
        return given["e"]
    kind = getattr(value, "kind", type(value).__name__)
    return f"{kind}({', '.join(f'{key}={text}' for key, text in given.items())})" if given else str(kind)
