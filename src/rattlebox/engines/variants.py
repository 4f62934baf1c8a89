"""Variants of a case: numbers replaced by arrays, what was packed apart put together, members taken out and compared."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.exceptions import CaseError, RattleboxError
from rattlebox.model.base import Part
from rattlebox.model.errors import Hint
from rattlebox.model.paths import Place, get, part_at, place_of, replaced

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.case import Case

Columns = Mapping[str, "NDArray[Any]"]
Index = tuple[int, ...]

_TABLES = ("times", "values", "speeds")  # of records and laws: the same for all variants
_ULPS = 4
_DRAWN = 8  # variants that are compared besides the extreme ones
_CORNERS = 16


def column(path: str, values: Any, shape: Sequence[int]) -> NDArray[Any]:
    """Return the values of a parameter as numbers or objects, with the axes of the grid."""
    found = np.asarray(values)
    found = np.asarray(found, dtype=float if found.dtype.kind in "fiu" else object, order="C")
    if found.ndim != len(shape) or any(n not in (1, whole) for n, whole in zip(found.shape, shape, strict=True)):
        raise ValueError(f"{path}: values of shape {found.shape} do not broadcast to {tuple(shape)}")
    return found


def is_number(case: Case, path: str, values: NDArray[Any]) -> bool:
    """Tell whether an array can stand in place of the number at a path."""
    if values.dtype == object or isinstance(get(case, path), int):
        return False
    place = place_of(case, path)
    parts = (part_at(case, place[:n]) for n in range(len(place)))
    return all(part.elementwise for part in parts if isinstance(part, Part))


def with_value(node: Any, place: Place, value: Any) -> Any:
    """Return the same with another value at a place, unseen by any validation."""
    if not place:
        return value
    step, *rest = place
    if isinstance(step, int):
        return type(node)(with_value(item, tuple(rest), value) if i == step else item for i, item in enumerate(node))
    if isinstance(node, dict):
        return {**node, step: with_value(node[step], tuple(rest), value)}
    return node.model_copy(update={step: with_value(getattr(node, step), tuple(rest), value)})


def contiguous(node: Any) -> Any:
    """Return packed numbers with every array in one piece."""
    if isinstance(node, dict):
        return {key: contiguous(item) for key, item in node.items()}
    if isinstance(node, list):
        return [contiguous(item) for item in node]
    return np.asarray(node, dtype=float, order="C") if isinstance(node, np.ndarray) else node


# ---- variants that are packed apart


def alike(values: NDArray[Any], axis: int) -> list[NDArray[np.intp]]:
    """Return the places along an axis, grouped by what stands there."""
    if values.dtype == object:
        different = {id(value): value for value in values.flat}
        number = {text: n for n, text in enumerate(dict.fromkeys(map(repr, different.values())))}
        codes = {key: number[repr(value)] for key, value in different.items()}
        values = np.fromiter((codes[id(value)] for value in values.flat), int, values.size).reshape(values.shape)
    rows = np.moveaxis(values, axis, 0).reshape(values.shape[axis], -1)
    if rows.shape[1] > 1:
        rows = np.unique(rows, axis=0, return_inverse=True)[1]
    _, which, counts = np.unique(rows, return_inverse=True, return_counts=True)
    return np.split(np.argsort(which.ravel(), kind="stable"), np.cumsum(counts)[:-1])


class Unlike(Hint):
    """Says of variants that they differ in more than numbers."""


class Joint:
    """Puts packed variants together that differ in what stands at a path.

    Parameters
    ----------
    path
        Where they differ.
    groups
        Places of each along the axis.
    axis, shape
        Axis of the grid along which they differ, and shape of the grid.
    """

    def __init__(self, path: str, groups: Sequence[NDArray[np.intp]], axis: int, shape: Sequence[int]) -> None:
        self._path, self._groups, self._axis, self._shape = path, groups, axis, shape

    def of(self, parts: Sequence[Any], *where: str) -> Any:
        """Return the whole grid of the variants, one part a group.

        Raises
        ------
        Unlike
            When the parts differ in more than numbers.
        """
        first = parts[0]
        if isinstance(first, dict):
            if any(part.keys() != first.keys() for part in parts):
                raise self._unlike(where)
            return {key: self.of([part[key] for part in parts], *where, key) for key in first}
        if isinstance(first, list):
            if any(len(part) != len(first) for part in parts):
                raise self._unlike(where)
            return [self.of(members, *where) for members in zip(*parts, strict=True)]
        if isinstance(first, (str, int)) or (where[-1] in _TABLES and isinstance(first, np.ndarray)):
            if any(not np.array_equal(part, first) for part in parts):
                raise self._unlike(where)
            return first
        return self._joined(parts, where)

    def _joined(self, parts: Sequence[Any], where: Sequence[str]) -> Any:
        axes = len(self._shape)
        arrays = [part if isinstance(part, np.ndarray) else np.full((1,) * axes, part) for part in parts]
        first = arrays[0]
        own = first.ndim - axes  # axes of a vector
        if any(array.shape[:own] != first.shape[:own] for array in arrays):
            raise self._unlike(where)
        axis = own + self._axis
        if all(array.shape[axis] == 1 and np.array_equal(array, first) for array in arrays):
            return parts[0]
        shape = list(np.broadcast_shapes(*((*array.shape[:axis], 1, *array.shape[axis + 1 :]) for array in arrays)))
        shape[axis] = self._shape[self._axis]
        whole = np.empty(shape)
        for group, array in zip(self._groups, arrays, strict=True):
            whole[(slice(None),) * axis + (group,)] = array
        return whole

    def _unlike(self, where: Sequence[str]) -> Unlike:
        return Unlike(
            f"{self._path}: its values make cases that differ in more than numbers ({' of '.join(reversed(where))})",
            "one sweep for each",
        )


# ---- checks


def misplaced(packed: Mapping[str, Any], shape: Sequence[int]) -> Iterator[Index]:
    """Find a variant of each damper whose balls start in a wall, in each other or in a cavity too short, if there is one."""
    for damper in packed["dampers"]:
        position, half = damper["position"], np.asarray(0.5 * damper["clearance"])
        cavity = np.sum(damper["shape"] * packed["mode_displacement"], axis=0)
        overlap = np.argwhere(np.diff(position, axis=0) < 0)
        if len(overlap):
            yield _member(overlap[0][1:], shape)
        whole = np.broadcast_shapes(position.shape, half.shape, cavity.shape)
        with np.nditer(
            [position, half, cavity], ["external_loop", "buffered"], buffersize=1 << 16, order="C"
        ) as pieces:
            done = 0
            for place, room, centre in pieces:
                outside = np.abs(place - centre) - room > 4e-16 * (room + np.abs(centre))
                if outside.any():
                    yield _member(np.unravel_index(done + int(outside.argmax()), whole)[1:], shape)
                    break
                done += outside.size


def _member(index: Sequence[Any], shape: Sequence[int]) -> Index:
    return tuple(map(int, index)) if len(index) else (0,) * len(shape)


def examples(columns: Columns, shape: Sequence[int]) -> list[Index]:
    """Choose variants: corners of the grid, those where a number is extreme, and a few more."""
    found = list(itertools.islice(itertools.product(*({0, n - 1} for n in shape)), _CORNERS))
    for values in columns.values():
        if values.dtype != object:
            found += [_member(np.unravel_index(i, values.shape), shape) for i in (values.argmin(), values.argmax())]
    drawn = np.random.default_rng(0).integers(np.array(shape, dtype=int), size=(_DRAWN, len(shape)))
    found += [_member(index, shape) for index in drawn]
    return list(dict.fromkeys(found))


def variant(case: Case, columns: Columns, index: Index) -> Case:
    """Return the case of one variant.

    Raises
    ------
    CaseError
        When it does not fit, with its values.
    """
    values = {path: values[_inside(values.shape, index)] for path, values in columns.items()}
    plain = {path: value.item() if isinstance(value, np.generic) else value for path, value in values.items()}
    try:
        return replaced(case, plain)
    except RattleboxError as error:
        told = ", ".join(f"{path} = {value!r:.60}" for path, value in plain.items())
        raise CaseError(f"the variant with {told} does not fit\n{error}") from None


def _inside(shape: Sequence[int], index: Index) -> Index:
    return tuple(0 if n == 1 else i for n, i in zip(shape, index, strict=True))


def compare(one: Any, batch: Any, index: Index, *where: str) -> None:
    """Find the numbers of one packed variant in a batch.

    Raises
    ------
    RuntimeError
        When one is not there: a formula of the model is not elementwise.
    """
    if isinstance(one, dict):
        for key in one | batch:
            compare(one[key], batch[key], index, *where, key)
        return
    if isinstance(one, list):
        for number, (item, other) in enumerate(zip(one, batch, strict=True)):
            compare(item, other, index, *where, str(number))
        return
    if isinstance(one, str):
        same = one == batch
    else:
        own = np.ndim(one)
        one, batch = np.asarray(one, dtype=float), np.asarray(batch, dtype=float)
        if batch.ndim > own:
            batch = batch[(slice(None),) * own + _inside(batch.shape[own:], index)]
        with np.errstate(invalid="ignore"):  # infinite ones, which must be equal
            near = np.abs(one - batch) <= _ULPS * np.spacing(np.maximum(np.abs(one), np.abs(batch)))
        same = bool(np.all((one == batch) | near))
    if not same:
        raise RuntimeError(
            f"{'.'.join(where)} of variant {index} is {one}, in the batch {batch}: see model.elementwise"
        )
