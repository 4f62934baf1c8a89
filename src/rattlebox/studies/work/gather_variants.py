"""Selection of variants of a batch, in any order."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rattlebox.core import _core

Packed = TypeVar("Packed", bound=_core.Node)


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

    Returns
    -------
    (..., n, 1, ...) float
        Values with one axis for the variants, or a number if they do not vary.
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
