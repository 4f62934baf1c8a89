"""Impact damper with two impacts a cycle: S. F. Masri and T. K. Caughey, J. Appl. Mech. 33 (1966) 586.

M = K = F0 = 1, a ball of mass mu in a cavity of total clearance d, hard impacts of restitution e. The
right-hand impact is at t = 0, the left-hand one half a cycle later with everything mirrored.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .oscillator import amplitude, lag, roots, transition


@dataclass(frozen=True)
class Orbit:
    """A symmetric orbit with two impacts a cycle.

    `speed` is the ball's velocity w after the right-hand impact; `position`, `before` and `after` belong to
    the structure at that impact; `load_phase` makes the load sin(omega t + load_phase).
    """

    mass_ratio: float
    restitution: float
    clearance: float
    zeta: float
    omega: float
    speed: float
    position: float
    before: float
    after: float
    load_phase: float

    @property
    def half_period(self) -> float:
        """Time between impacts."""
        return math.pi / self.omega

    @property
    def approach(self) -> float:
        """Approach speed of every impact."""
        return abs(-self.speed - self.before)

    def structure(self, t: float) -> tuple[float, float]:
        """Position and velocity of the structure at 0 <= t <= half period."""
        steady, slope = self._steady(0.0)
        free = transition(self.zeta, t) @ np.array([self.position - steady, self.after - slope])
        steady, slope = self._steady(t)
        return float(free[0] + steady), float(free[1] + slope)

    def ball(self, t: float) -> tuple[float, float]:
        """Position and velocity of the ball at 0 <= t <= half period."""
        return self.position + 0.5 * self.clearance + self.speed * t, self.speed

    def _steady(self, t: float) -> tuple[float, float]:
        size = amplitude(self.zeta, self.omega)
        phase = self.omega * t + self.load_phase - lag(self.zeta, self.omega)
        return size * math.sin(phase), size * self.omega * math.cos(phase)

    def largest(self) -> float:
        """Largest displacement of the structure."""
        times = np.linspace(0, self.half_period, 20001)
        values = np.array([abs(self.structure(float(t))[0]) for t in times])
        k = int(values.argmax())
        if k in (0, times.size - 1):
            return float(values[k])
        left, mid, right = values[k - 1 : k + 2]
        return float(mid + (right - left) ** 2 / (8 * (2 * mid - left - right)))

    def admissible(self) -> bool:
        """Whether the ball stays inside the cavity between the impacts."""
        times = np.linspace(0, self.half_period, 4001)[1:-1]
        gap = np.array([self.ball(float(t))[0] - self.structure(float(t))[0] for t in times])
        return bool(np.all(np.abs(gap) < 0.5 * self.clearance))

    def zero_crossing(self) -> float:
        """A time between the impacts at which the structure passes through rest."""
        low, high = 0.0, self.half_period
        sign = math.copysign(1.0, self.structure(low)[0])
        for _ in range(200):
            middle = 0.5 * (low + high)
            if sign * self.structure(middle)[0] > 0:
                low = middle
            else:
                high = middle
        return 0.5 * (low + high)

    def multipliers(self) -> NDArray[np.complex128]:
        """Eigenvalues of the mirrored half-cycle map, from its variational equation.

        Between impacts a disturbance of (x, x', y, y') is carried by the transition matrix; at an impact the
        jump in state and in time is differentiated (saltation).
        """
        mu, e = self.mass_ratio, self.restitution
        flight = np.zeros((4, 4))
        flight[:2, :2] = transition(self.zeta, self.half_period)
        flight[2:, 2:] = [[1, self.half_period], [0, 1]]
        reset = np.eye(4)
        reset[1, 1], reset[1, 3] = (1 - mu * e) / (1 + mu), mu * (1 + e) / (1 + mu)
        reset[3, 1], reset[3, 3] = (1 + e) / (1 + mu), (mu - e) / (1 + mu)
        normal = np.array([-1.0, 0.0, 1.0, 0.0])
        load = math.sin(self.load_phase)
        before = np.array([self.before, self._pull(self.before, load), -self.speed, 0.0])
        after = np.array([self.after, self._pull(self.after, load), self.speed, 0.0])
        jump = reset + np.outer(after - reset @ before, normal) / (normal @ before)
        return np.linalg.eigvals(-jump @ flight)

    def _pull(self, velocity: float, load: float) -> float:
        return load - self.position - 2 * self.zeta * velocity


def orbits(
    mass_ratio: float, restitution: float, clearance: float, zeta: float = 0.01, omega: float = 1.0
) -> list[Orbit]:
    """All admissible symmetric orbits in which the ball leaves the right-hand wall."""
    mu, e = mass_ratio, restitution
    half = math.pi / omega
    after, before = (1 - e - 2 * mu * e) / (1 + e), (1 - e + 2 * mu) / (1 + e)
    # The free part h repeats mirrored but for the jump: (E + 1) h(0) = (0, -2 mu w), so h(0) = w g.
    g = np.linalg.solve(transition(zeta, half) + np.eye(2), [0.0, -2 * mu])
    # Steady part at t = 0: displacement p + q w, velocity r w.
    p, q, r = -0.5 * clearance, -0.5 * half - g[0], after - g[1]
    size = amplitude(zeta, omega)
    result = []
    for w in roots(q * q + (r / omega) ** 2, 2 * p * q, p * p - size * size):
        phase = math.atan2(p + q * w, r * w / omega) + lag(zeta, omega)
        position = -0.5 * half * w - 0.5 * clearance
        orbit = Orbit(mu, e, clearance, zeta, omega, w, position, before * w, after * w, phase)
        if orbit.speed < orbit.after and orbit.admissible():
            result.append(orbit)
    return result
