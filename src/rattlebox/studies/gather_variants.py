"""Some variants of a packed grid, in any order."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

_TABLES = "times", "values", "speeds"


def gather_variants(node: Any, shape: Sequence[int], members: NDArray[np.intp], further: int = 0) -> Any:
    """Return what some variants have of packed variants, or of a number or vector among them.

    Parameters
    ----------
    node
        From `rattlebox.engines.pack.pack_batch`; numbers and vectors have the axes of the grid after their own.
    shape
        Of the grid.
    members
        Variants, counted along the grid with its last axis fastest.
    further
        Axes of length one, behind that of the variants.

    Returns
    -------
    Any
        The same with one axis for the variants, and the further ones, in place of the grid's.
    """
    return _gather(node, np.unravel_index(members, tuple(shape)) if shape else (), (1,) * further)


def _gather(node: Any, places: tuple[NDArray[np.intp], ...], further: tuple[int, ...], key: str = "") -> Any:
    if isinstance(node, dict):
        return {name: _gather(item, places, further, name) for name, item in node.items()}
    if isinstance(node, list):
        return [_gather(item, places, further) for item in node]
    if not isinstance(node, np.ndarray) or key in _TABLES or node.ndim == 0:
        return node
    own = node.ndim - len(places)  # axes of a vector
    if all(n == 1 for n in node.shape[own:]):
        return node.reshape(*node.shape[:own], 1, *further)
    there = tuple(place if n > 1 else 0 * place for place, n in zip(places, node.shape[own:], strict=True))
    found = node[(slice(None),) * own + there]
    return np.ascontiguousarray(found, dtype=float).reshape(*found.shape, *further)
