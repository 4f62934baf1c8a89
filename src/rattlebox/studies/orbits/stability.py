"""Kinds of stability of a periodic motion, and test functions of its limits, from its multipliers."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

ON_CIRCLE = 1e-7
"""Distance of a multiplier from the unit circle, below which it counts as being on it."""


def fold_test(multipliers: NDArray[np.complex128]) -> float:
    """Return the determinant of M - 1."""
    return float(np.prod(multipliers - 1).real)


def flip_test(multipliers: NDArray[np.complex128]) -> float:
    """Return the determinant of M + 1."""
    return float(np.prod(multipliers + 1).real)


def torus_test(multipliers: NDArray[np.complex128]) -> float:
    """Return a number that is zero if the product of two multipliers is 1."""
    return float(np.prod([one * other - 1 for one, other in combinations(multipliers, 2)]).real)


def stability_words(multipliers: NDArray[np.complex128]) -> str:
    """Return the kind of stability of a motion with some multipliers."""
    sizes = np.abs(multipliers)
    outside = multipliers[sizes > 1 + ON_CIRCLE]
    if not outside.size:
        return "at the limit of stability" if (sizes > 1 - ON_CIRCLE).any() else "stable"
    real = np.abs(outside.imag) <= 1e-12 * np.abs(outside)
    parts = []
    if above := int((real & (outside.real > 0)).sum()):
        parts.append(f"{_number(above)} above 1 (beyond a fold or pitchfork)")
    if below := int((real & (outside.real < 0)).sum()):
        parts.append(f"{_number(below)} below -1 (beyond a flip)")
    if pairs := int((~real).sum()) // 2:
        parts.append(f"{'a complex pair' if pairs == 1 else f'{pairs} complex pairs'} outside of the unit circle")
    return f"unstable: {', '.join(parts)}"


def _number(count: int) -> str:
    return "one multiplier" if count == 1 else f"{count} multipliers"
