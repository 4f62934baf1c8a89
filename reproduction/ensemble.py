"""Ensembles of runs that start within a micrometre of each other, and bands of their results."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .reference import GAP
from .runs import simulate_many

if TYPE_CHECKING:
    from rattlebox import Case, Run


def ensemble(make_case: Callable[[float], Case], members: int = 64, reach: float = 1e-6) -> list[Run]:
    """Simulate a case from many nearby start positions."""
    if members < 1:
        raise ValueError(f"members is {members}, but an ensemble needs at least 1")
    # A quarter step off centre: no two starts coincide when offsets are mirrored at a wall.
    steps = (np.arange(members) + 0.25) / members
    return simulate_many([make_case(float(offset)) for offset in reach * (2 * steps - 1)])


def near(start: float, offset: float) -> float:
    """Return the reduced start position displaced by an offset, mirrored at the walls."""
    place = start + offset / GAP
    return place if abs(place) <= 1 else float(np.copysign(2.0, place)) - place


def band(values: ArrayLike, axis: int = 0) -> NDArray[np.float64]:
    """Return the 10 %, 50 % and 90 % quantiles of an ensemble, (3, ...); NaN wherever a member is NaN."""
    return np.asarray(np.quantile(np.asarray(values, dtype=float), (0.1, 0.5, 0.9), axis=axis))
