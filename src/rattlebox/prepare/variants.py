"""Variants of a case: arrays in place of numbers, merged problems, comparison of a variant with its batch."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from rattlebox._util.exceptions import CaseError, RattleboxError
from rattlebox.core import _core
from rattlebox.model.base import Part, full_text
from rattlebox.model.errors import Hint
from rattlebox.model.paths import Place, get, part_at, place_of, replaced

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.case import Case

Columns = Mapping[str, "NDArray[Any]"]
Index = tuple[int, ...]
Packed = TypeVar("Packed", bound=_core.Node)

_ULPS = 4
_RANDOM = 8  # random variants that are compared, besides the extreme ones
_CORNERS = 16


def column(path: str, values: object, shape: Sequence[int]) -> NDArray[Any]:
    """Return the values of a parameter as numbers or objects, with the axes of the grid."""
    array = np.asarray(values)
    array = np.asarray(array, dtype=float if array.dtype.kind in "fiu" else object, order="C")
    if array.ndim != len(shape) or any(n not in (1, whole) for n, whole in zip(array.shape, shape, strict=True)):
        raise ValueError(f"{path}: values of shape {array.shape} do not broadcast to {tuple(shape)}")
    return array


def is_number(case: Case, path: str, values: NDArray[Any]) -> bool:
    """Return whether an array can replace the number at a path."""
    if values.dtype == object or isinstance(get(case, path), int):
        return False
    place = place_of(case, path)
    parts = (part_at(case, place[:n]) for n in range(len(place)))
    return all(part.elementwise for part in parts if isinstance(part, Part))


def with_value(node: Any, place: Place, value: Any) -> Any:
    """Return a copy with another value at a place, without validation."""
    if not place:
        return value
    step, *rest = place
    if isinstance(step, int):
        return type(node)(with_value(item, tuple(rest), value) if i == step else item for i, item in enumerate(node))
    if isinstance(node, dict):
        return {**node, step: with_value(node[step], tuple(rest), value)}
    return node.model_copy(update={step: with_value(getattr(node, step), tuple(rest), value)})


# ---- merging of variants that are packed separately


def group_equal(values: NDArray[Any], axis: int) -> list[NDArray[np.intp]]:
    """Return the indices along an axis, grouped by equal values."""
    if values.dtype == object:
        different = {id(value): value for value in values.flat}
        number = {text: n for n, text in enumerate(dict.fromkeys(map(full_text, different.values())))}
        codes = {key: number[full_text(value)] for key, value in different.items()}
        values = np.fromiter((codes[id(value)] for value in values.flat), int, values.size).reshape(values.shape)
    rows = np.moveaxis(values, axis, 0).reshape(values.shape[axis], -1)
    if rows.shape[1] > 1:
        rows = np.unique(rows, axis=0, return_inverse=True)[1]
    _, which, counts = np.unique(rows, return_inverse=True, return_counts=True)
    return np.split(np.argsort(which.ravel(), kind="stable"), np.cumsum(counts)[:-1])


class NotMergeable(Hint):
    """Variants that differ in more than numbers and cannot be merged."""


class Merger:
    """Merger of packed variants that differ in the value at one path."""

    def __init__(self, path: str, groups: Sequence[NDArray[np.intp]], axis: int, shape: Sequence[int]) -> None:
        self._path, self._groups, self._axis, self._shape = path, groups, axis, shape

    def merge(self, parts: Sequence[Packed], *where: str) -> Packed:
        """Return a part of a problem for the whole grid, from that of each group."""
        first = parts[0]
        if any(type(part) is not type(first) for part in parts):
            raise self._obstacle(where)
        fields = first.fields().items()
        return first.replace(
            **{
                name: self._merge_field([getattr(part, name) for part in parts], varies, (*where, name))
                for name, varies in fields
            }
        )

    def merge_points(self, parts: Sequence[Mapping[str, NDArray[np.float64]]]) -> dict[str, NDArray[np.float64]]:
        """Return vectors by name for the whole grid, from those of each group."""
        if any(part.keys() != parts[0].keys() for part in parts):
            raise self._obstacle(("points",))
        return {name: self._merge_arrays([part[name] for part in parts], (name,)) for name in parts[0]}

    def _merge_field(self, values: Sequence[Any], varies: _core.Varies, where: Sequence[str]) -> Any:
        first = values[0]
        if varies is not _core.Varies.never:
            if any((value is None) != (first is None) for value in values):
                raise self._obstacle(where)
            return None if first is None else self._merge_arrays(values, where)
        if isinstance(first, _core.Node):
            return self.merge(values, *where)
        if isinstance(first, list):
            if any(len(value) != len(first) for value in values):
                raise self._obstacle(where)
            return [self.merge(items, *where) for items in zip(*values, strict=True)]
        if any(not np.array_equal(value, first) for value in values):
            raise self._obstacle(where)
        return first

    def _merge_arrays(self, parts: Sequence[object], where: Sequence[str]) -> Any:
        axes = len(self._shape)
        arrays = [part if isinstance(part, np.ndarray) else np.full((1,) * axes, part) for part in parts]
        first = arrays[0]
        dimensions = first.ndim - axes  # 1 for a vector, 0 for a number
        if any(array.shape[:dimensions] != first.shape[:dimensions] for array in arrays):
            raise self._obstacle(where)
        axis = dimensions + self._axis
        if all(array.shape[axis] == 1 and np.array_equal(array, first) for array in arrays):
            return parts[0]
        shape = list(np.broadcast_shapes(*((*array.shape[:axis], 1, *array.shape[axis + 1 :]) for array in arrays)))
        shape[axis] = self._shape[self._axis]
        whole = np.empty(shape)
        for group, array in zip(self._groups, arrays, strict=True):
            whole[(slice(None),) * axis + (group,)] = array
        return whole

    def _obstacle(self, where: Sequence[str]) -> NotMergeable:
        return NotMergeable(
            f"{self._path}: its values make cases that differ in more than numbers ({' of '.join(reversed(where))})",
            "a separate sweep for each value",
        )


# ---- checks


def invalid_starts(packed: _core.Problem, shape: Sequence[int]) -> Iterator[Index]:
    """Yield, for each damper, a variant with an invalid start: balls in a wall, in each other, or in too short a cavity."""
    for damper in packed.dampers:
        position, half = damper.position, 0.5 * np.asarray(damper.clearance)
        cavity = np.sum(damper.shape * packed.mode_displacement, axis=0)
        if not len(position):  # a stop: the point may start inside it
            inside = np.argwhere(np.asarray(cavity > half * (1 + 1e-12)))
            if len(inside):
                yield _grid_index(inside[0].tolist(), shape)
            continue
        overlap = np.argwhere(np.diff(position, axis=0) < 0)
        if len(overlap):
            yield _grid_index(overlap[0][1:], shape)
        whole = np.broadcast_shapes(position.shape, half.shape, cavity.shape)
        with np.nditer(
            [position, half, cavity], ["external_loop", "buffered"], buffersize=1 << 16, order="C"
        ) as pieces:
            done = 0
            for ball, room, centre in pieces:
                outside = np.abs(ball - centre) - room > 4e-16 * (room + np.abs(centre))
                if outside.any():
                    yield _grid_index(np.unravel_index(done + int(outside.argmax()), whole)[1:], shape)
                    break
                done += outside.size


def _grid_index(index: Sequence[Any], shape: Sequence[int]) -> Index:
    return tuple(map(int, index)) if len(index) else (0,) * len(shape)


def examples(columns: Columns, shape: Sequence[int]) -> list[Index]:
    """Choose variants to be compared: corners of the grid, extremes of each number, and a few random ones."""
    chosen = list(itertools.islice(itertools.product(*({0, n - 1} for n in shape)), _CORNERS))
    for values in columns.values():
        if values.dtype != object:
            chosen += [
                _grid_index(np.unravel_index(i, values.shape), shape) for i in (values.argmin(), values.argmax())
            ]
    random = np.random.default_rng(0).integers(np.array(shape, dtype=int), size=(_RANDOM, len(shape)))
    chosen += [_grid_index(index, shape) for index in random]
    return list(dict.fromkeys(chosen))


def variant(case: Case, columns: Columns, index: Index) -> Case:
    """Return the case of one variant."""
    values = {path: values[_broadcast_index(values.shape, index)] for path, values in columns.items()}
    plain = {path: value.item() if isinstance(value, np.generic) else value for path, value in values.items()}
    try:
        return replaced(case, plain)
    except RattleboxError as error:
        text = ", ".join(f"{path} = {value!r:.60}" for path, value in plain.items())
        raise CaseError(f"the variant with {text} is invalid\n{error}") from None


def _broadcast_index(shape: Sequence[int], index: Index) -> Index:
    return tuple(0 if n == 1 else i for n, i in zip(shape, index, strict=True))


def compare(one: Any, batch: Any, index: Index, *where: str) -> None:
    """Compare the numbers of one packed variant with those in a batch."""
    if isinstance(one, _core.Node):
        if type(one) is not type(batch):
            raise _mismatch(one, batch, index, where)
        for name, varies in one.fields().items():
            mine, theirs = getattr(one, name), getattr(batch, name)
            if varies is _core.Varies.never:
                compare(mine, theirs, index, *where, name)
            else:
                _compare_numbers(mine, theirs, index, (*where, name))
        return
    if isinstance(one, Mapping):
        for name in one.keys() | batch.keys():
            _compare_numbers(one[name], batch[name], index, (*where, name))
        return
    if isinstance(one, list):
        for number, (item, other) in enumerate(zip(one, batch, strict=True)):
            compare(item, other, index, *where, str(number))
        return
    if not np.array_equal(one, batch):
        raise _mismatch(one, batch, index, where)


def _compare_numbers(one: Any, batch: Any, index: Index, where: Sequence[str]) -> None:
    if one is None or batch is None:
        if one is not batch:
            raise _mismatch(one, batch, index, where)
        return
    dimensions = np.ndim(one)
    one, batch = np.asarray(one, dtype=float), np.asarray(batch, dtype=float)
    if batch.ndim > dimensions:
        batch = batch[(slice(None),) * dimensions + _broadcast_index(batch.shape[dimensions:], index)]
    with np.errstate(invalid="ignore"):  # The differences of infinite numbers are NaN; these must be equal.
        near = np.abs(one - batch) <= _ULPS * np.spacing(np.maximum(np.abs(one), np.abs(batch)))
    if not np.all((one == batch) | near):
        raise _mismatch(one, batch, index, where)


def _mismatch(one: object, batch: object, index: Index, where: Sequence[str]) -> RuntimeError:
    return RuntimeError(f"{'.'.join(where)} of variant {index} is {one}, in the batch {batch}: see model.elementwise")
