"""Cells: equal cavities at several offsets from a point."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .cavities import Cavity
from .elementwise import Vector

_TOLERANCE = 1e-9
"""Overlap of two cells that is rounding, over the size of a cell."""


def overlapping_cells(cavity: Cavity, places: Vector) -> tuple[int, int] | None:
    """Return the first two cells that overlap, if any, of cavities with centres at places, (n, 3) [m]."""
    if len(places) < 2:
        return None
    from scipy.spatial import cKDTree  # takes a tenth of a second to load

    tree = cKDTree(places)
    found = np.asarray(
        tree.query(places, k=2)[1]
    )  # itself and the nearest other one, in any order if both are at one place
    own = np.arange(len(places))
    other = np.where(found[:, 0] == own, found[:, 1], found[:, 0])
    size = float(np.linalg.norm(cavity.lengths))
    # Nearest cells first: of many cells at one place, all pairs would not fit into the memory.
    nearest = np.sort(np.stack([own, other], axis=1), axis=1)
    return _first(cavity, places, nearest) or _first(cavity, places, tree.query_pairs(size, output_type="ndarray"))


def separation(cavity: Cavity, shift: Vector) -> float:
    """Return the distance from which two cells in the direction of a shift do not overlap [m], rounded up to 3 digits."""
    distance = float(np.linalg.norm(shift))
    direction = shift / distance if distance else np.array([1.0, 0.0, 0.0])
    low, high = 0.0, float(np.linalg.norm(cavity.lengths)) * (1 + 1e-6)
    while high - low > 1e-6 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _overlap(cavity, middle * direction[None])[0] else (low, middle)
    digit = 10.0 ** (math.floor(math.log10(high)) - 2)
    return digit * math.ceil(high / digit * (1 - 2e-6))


def _overlap(cavity: Cavity, shifts: Vector) -> NDArray[np.bool_]:
    """Return whether two cells at these shifts overlap by more than rounding, (n,)."""
    return cavity.overlaps(shifts, _TOLERANCE * float(cavity.lengths.max()))


def _first(cavity: Cavity, places: Vector, pairs: NDArray[np.intp]) -> tuple[int, int] | None:
    """Return the first of the pairs that overlap."""
    if not len(pairs):
        return None
    shifts = places[pairs[:, 1]] - places[pairs[:, 0]]
    # The shifts of a pattern repeat, and those of surfaces take long to check.
    digits = np.round(shifts / (_TOLERANCE * float(cavity.lengths.max())))
    _, first, inverse = np.unique(digits, axis=0, return_index=True, return_inverse=True)
    bad = pairs[_overlap(cavity, shifts[first])[inverse.ravel()]]
    if not len(bad):
        return None
    one, other = bad[np.lexsort((bad[:, 1], bad[:, 0]))[0]]
    return int(one), int(other)
