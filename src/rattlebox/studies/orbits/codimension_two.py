"""Points of a curve of special points at which a second condition is met.

References
----------
Yu. A. Kuznetsov (2004), Elements of Applied Bifurcation Theory, 3rd ed., Springer, chapter 9,
doi:10.1007/978-1-4757-3978-7.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

_CRITICAL = {"fold": 1.0, "pitchfork": 1.0, "flip": -1.0}
"""Multiplier on a curve."""
_SECOND = {
    ("fold", 1.0): "1:1 resonance",
    ("fold", -1.0): "fold-flip",
    ("flip", -1.0): "1:2 resonance",
    ("flip", 1.0): "fold-flip",
    ("pitchfork", 1.0): "second multiplier +1",
}
"""Names by the curve and a second real multiplier on the unit circle."""
_STRONG = {2 * np.pi / 3: "1:3 resonance", np.pi / 2: "1:4 resonance"}
"""Names by the angle of the pair of a Neimark-Sacker curve; 1:1 and 1:2 are its ends."""


def names_along(kind: str, multipliers: NDArray[np.complex128], places: NDArray[np.float64]) -> list[str]:
    """Return the name of each point of a curve, "" where there is none, at the points nearest to the second condition.

    `multipliers` (points, n) and `places` (points, 2), the parameters over their ranges.
    """
    names = [""] * len(multipliers)

    def mark(values: NDArray[np.float64], name: str) -> None:
        for k in np.flatnonzero(np.diff(values >= 0)):  # a point exactly at the condition counts, too
            names[k + int(abs(values[k + 1]) < abs(values[k]))] = name

    if kind == "torus":
        pairs = np.array([row[np.argmin(np.abs(np.abs(row) - 1))] for row in multipliers])
        for angle, name in _STRONG.items():
            mark(np.abs(np.angle(pairs)) - angle, name)
    for (curve, value), name in _SECOND.items():
        if curve == kind:
            mark(np.array([_others(row, _CRITICAL[kind])(value) for row in multipliers]), name)
    if kind == "fold":
        # The curve has a corner in the plane of the parameters, where its projection turns back.
        steps = np.diff(places, axis=0)
        for k in np.flatnonzero(np.sum(steps[:-1] * steps[1:], axis=1) < 0):
            names[k + 1] = "cusp"
    return names


def _others(multipliers: NDArray[np.complex128], critical: float) -> Callable[[float], float]:
    """Return the function of a value that is zero if another multiplier than the critical one has it."""
    rest = np.delete(multipliers, np.argmin(np.abs(multipliers - critical)))
    return lambda value: float(np.prod(rest - value).real)
