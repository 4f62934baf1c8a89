"""Some variants of a packed grid, in any order."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rattlebox.core import _core

Packed = TypeVar("Packed", bound=_core.Node)


def gather_variants(node: Packed, shape: Sequence[int], members: NDArray[np.intp], further: int = 0) -> Packed:
    """Return the same part of a batch for some variants.

    Parameters
    ----------
    node
        Batch from `rattlebox.prepare.pack.pack_batch`, or a part of it.
    shape
        Shape of the grid.
    members
        Variants, counted along the grid with its last axis fastest.
    further
        Axes of length one, behind that of the variants.

    Returns
    -------
    Node
        The same with one axis for the variants, and the further ones, in place of the grid's.
    """
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
    """Return some variants of a number, or of a vector with the axes of the grid after its own.

    Parameters
    ----------
    values
        A number, or an array over the grid.
    shape, members, further
        As of `gather_variants`.
    """
    found = np.asarray(values, dtype=float)
    if found.ndim == 0:
        return found
    places = np.unravel_index(members, tuple(shape)) if shape else ()
    own = found.ndim - len(places)  # axes of a vector
    ones = (1,) * further
    if all(n == 1 for n in found.shape[own:]):
        return found.reshape(*found.shape[:own], 1, *ones)
    there = tuple(place if n > 1 else 0 * place for place, n in zip(places, found.shape[own:], strict=True))
    chosen = found[(slice(None),) * own + there]
    return np.ascontiguousarray(chosen).reshape(*chosen.shape, *ones)
