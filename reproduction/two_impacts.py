"""Exact motion with two impacts per cycle.

References
----------
S. F. Masri and T. K. Caughey, "On the stability of the impact damper", Journal of Applied Mechanics 33 (1966) 586-592.
"""

from __future__ import annotations

from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class TwoImpacts(NamedTuple):
    """Steady motion in which hard impacts alternate between the walls, half a cycle apart."""

    approach_speed: float  # Approach speed of every impact [m/s]
    ball_speed: float  # Absolute speed of the ball between impacts [m/s]
    multiplier: float  # Largest growth factor of a disturbance in half a cycle; the motion is stable below 1


def two_impacts(
    *,
    mass: float,
    stiffness: float,
    damping: float,
    ball: float,
    clearance: float,
    restitution: float,
    amplitude: float,
    frequency: float,
) -> tuple[TwoImpacts, ...]:
    """Return the motions with two impacts per cycle of a ball in a cavity on a harmonically forced oscillator."""
    omega, e, ratio = 2 * pi * frequency, restitution, ball / mass
    half = pi / omega
    flow = np.array([[0.0, 1.0], [-stiffness / mass, -damping / mass]])
    # Velocity of the structure before and after the impact on the leading wall, divided by the ball's velocity w after it.
    before, after = (1 - e + 2 * ratio) / (1 + e), (1 - e - 2 * ratio * e) / (1 + e)
    # The free part of the motion repeats with the opposite sign, apart from the jump at impact; it is w times this.
    free = np.linalg.solve(_decay(flow, half) + np.eye(2), [0.0, after - before])
    # The remainder is the steady response of known amplitude: at impact (-clearance/2 + shift w, slope w).
    shift, slope = -half / 2 - free[0], after - free[1]
    size = amplitude / abs(stiffness - mass * omega**2 + 1j * damping * omega)
    times = np.linspace(0.0, half, 200)[1:-1]
    decay = _decay(flow, times) @ free
    motions = []
    for w in np.roots([shift**2 + (slope / omega) ** 2, -clearance * shift, clearance**2 / 4 - size**2]):
        place, speed = -clearance / 2 + shift * w, slope * w
        structure = decay[:, 0] * w + place * np.cos(omega * times) + speed / omega * np.sin(omega * times)
        # The ball starts from the leading wall at -(half w + clearance)/2 of the structure plus half a clearance.
        inside = np.abs(w * (times - half / 2) - structure) < clearance / 2
        if np.isreal(w) and w < after * w and inside.all():
            pull = w * (flow @ free)[1] - omega**2 * place
            pulls = pull + damping / mass * w * (after - before), pull
            saltation = _saltation(ratio, e, (before * w, -w), (after * w, w), pulls)
            flight = np.eye(4)
            flight[:2, :2], flight[2, 3] = _decay(flow, half), half
            multiplier = np.abs(np.linalg.eigvals(saltation @ flight)).max()
            motions.append(TwoImpacts(float(-w * (1 + before)), float(-w), float(multiplier)))
    return tuple(sorted(motions, reverse=True))


def _decay(flow: Array, time: float | Array) -> Array:
    """Return the transition matrix of the free motion over a time, (..., 2, 2)."""
    rates, shapes = np.linalg.eig(flow)
    grown = np.exp(np.multiply.outer(time, rates))
    return np.asarray(((shapes * grown[..., None, :]) @ np.linalg.inv(shapes)).real)


def _saltation(
    ratio: float, e: float, before: tuple[float, float], after: tuple[float, float], pulls: tuple[float, float]
) -> Array:
    """Return the saltation matrix of an impact on the leading wall for a disturbance of (x, x', y, y')."""
    reset = np.eye(4)
    reset[1, 1::2] = (1 - ratio * e) / (1 + ratio), ratio * (1 + e) / (1 + ratio)
    reset[3, 1::2] = (1 + e) / (1 + ratio), (ratio - e) / (1 + ratio)
    normal = np.array([-1.0, 0.0, 1.0, 0.0])
    rate_before = np.array([before[0], pulls[0], before[1], 0.0])
    rate_after = np.array([after[0], pulls[1], after[1], 0.0])
    return np.asarray(reset + np.outer(rate_after - reset @ rate_before, normal) / (normal @ rate_before))
