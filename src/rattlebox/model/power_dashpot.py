"""Dashpot coefficient of a power law for a restitution at a speed."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from rattlebox._util.narrow import present

from .errors import Hint

SMALLEST = 1e-3
"""Smallest restitution for which a dashpot coefficient is computed."""


@cache
def dimensionless_damping(restitution: float, exponent: float, damping_exponent: float, zero_overlap: bool) -> float:
    """Compute the dimensionless dashpot coefficient for a restitution.

    Notes
    -----
    With overlap over L and time over L/V the motion obeys x'' + gamma x^p x' + x^n = 0, x(0) = 0, x'(0) = 1. `PowerLaw`
    names the sources.
    """
    from scipy.optimize import brentq

    if restitution >= 1:
        return 0.0

    def excess(logarithm: float) -> float:
        return rebound(math.exp(logarithm), exponent, damping_exponent, zero_overlap) - restitution

    low, high = math.log(1 - restitution) - 3, 3.0
    if restitution >= SMALLEST:
        for _ in range(12):
            if excess(high) < 0:
                return math.exp(brentq(excess, low, high, xtol=1e-13, rtol=1e-13))
            high += 1.0
    raise Hint(
        f"no dashpot with this exponent has a restitution of {restitution:g}",
        "a larger restitution, or damping in place of it",
        ["restitution"],
    )


def rebound(damping: float, exponent: float, damping_exponent: float, zero_overlap: bool) -> float:
    """Return the restitution of an impact with a dimensionless dashpot coefficient (see `dimensionless_damping`)."""
    from scipy.integrate import solve_ivp

    def force(x: float, speed: float) -> float:
        x = max(x, 0.0)
        return float(x**exponent + damping * x**damping_exponent * speed)

    def ends(_: float, y: np.ndarray) -> float:
        return float(y[0]) if zero_overlap or y[1] > -1e-12 else min(float(y[0]), force(float(y[0]), float(y[1])))

    ends.terminal, ends.direction = True, -1.0  # type: ignore[attr-defined]
    motion = solve_ivp(
        lambda _, y: [y[1], -force(y[0], y[1])],
        (0.0, 1e4),
        [0.0, 1.0],
        method="DOP853",
        events=ends,
        rtol=1e-12,
        atol=1e-14,
    )
    states = present(motion.y_events)[0]
    return max(0.0, -float(states[-1][1])) if len(states) else 0.0
