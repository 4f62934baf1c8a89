"""x'' + 2 zeta x' + x = cos(omega t) with a rigid stop at x = s: one impact a cycle."""

import math
from dataclasses import dataclass

import numpy as np

from .oscillator import amplitude, lag, roots, transition


@dataclass(frozen=True)
class StopOrbit:
    """Motion with the impact at t = 0 under the load cos(omega t + load_phase)."""

    zeta: float
    omega: float
    stop: float
    restitution: float
    speed: float
    load_phase: float

    @property
    def departure(self) -> float:
        """Acceleration away from the stop directly after the impact; the mass rests there if it is negative."""
        return self.stop - 2 * self.zeta * self.restitution * self.speed - math.cos(self.load_phase)

    def state(self, t: float) -> tuple[float, float]:
        """Position and velocity at 0 <= t <= 2 pi / omega."""
        steady = self._steady(0.0)
        free = transition(self.zeta, t) @ np.array([self.stop - steady[0], -self.restitution * self.speed - steady[1]])
        steady = self._steady(t)
        return float(free[0] + steady[0]), float(free[1] + steady[1])

    def _steady(self, t: float) -> tuple[float, float]:
        size = amplitude(self.zeta, self.omega)
        phase = self.omega * t + self.load_phase - lag(self.zeta, self.omega)
        return size * math.cos(phase), -size * self.omega * math.sin(phase)

    def admissible(self) -> bool:
        """Whether the mass stays clear of the stop between impacts."""
        times = np.linspace(0, 2 * math.pi / self.omega, 4001)[1:-1]
        return all(self.state(float(t))[0] < self.stop for t in times)


def orbits(zeta: float, omega: float, stop: float, restitution: float) -> list[StopOrbit]:
    """All admissible motions with one impact in each cycle of the load."""
    return [orbit for orbit in candidates(zeta, omega, stop, restitution) if orbit.admissible()]


def candidates(zeta: float, omega: float, stop: float, restitution: float) -> list[StopOrbit]:
    """All solutions with one impact in each cycle, whether or not the mass stays clear of the stop between them."""
    period = 2 * math.pi / omega
    # The free part h repeats but for the jump: (E - 1) h(0) = (0, (1 + e) v), so h(0) = v g.
    g = np.linalg.solve(transition(zeta, period) - np.eye(2), [0.0, 1 + restitution])
    p, q, r = stop, -g[0], -restitution - g[1]
    size = amplitude(zeta, omega)
    result = []
    for v in roots(q * q + (r / omega) ** 2, 2 * p * q, p * p - size * size):
        phase = math.atan2(-r * v / omega, p + q * v) + lag(zeta, omega)
        orbit = StopOrbit(zeta, omega, stop, restitution, v, phase)
        if v > 0:
            result.append(orbit)
    return result
