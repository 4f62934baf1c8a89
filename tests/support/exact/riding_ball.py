"""Plastic ball in a driven oscillator, which rides on each wall for a part of the cycle; solved by Newton's method.

M = K = F0 = 1, a ball of mass mu with the gap g on each side, e = 0. The ball leaves the right-hand wall at t = 0, where the
acceleration of both is zero, flies with its speed, strikes the left-hand wall at t1 without rebound, and rides on it until
half a cycle is over.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .oscillator import transition

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Riding:
    """Symmetric motion: state of the oscillator and phase of the load at the separation, and time of the impact."""

    mass_ratio: float
    gap: float
    zeta: float
    omega: float
    unknowns: Vector  # x0, v0, phase, t1

    @property
    def approach(self) -> float:
        """Approach speed of every impact."""
        _, v0, phase, t1 = self.unknowns
        return abs(v0 - float(self._moved(self.unknowns[:2], 0.0, t1, phase, joint=False)[1]))

    @property
    def pressing(self) -> float:
        """Acceleration of both bodies directly after the impact; positive if the wall presses on the ball."""
        state, t1 = self._after()
        return self._acceleration(state, self.unknowns[2] + self.omega * t1, joint=True)

    def multipliers(self) -> NDArray[np.complex128]:
        """Squares of the eigenvalues of the mirrored map over half a cycle that are not zero, by central differences."""
        half, (state, t1) = math.pi / self.omega, self._after()
        start = 0.5 * (t1 + half)
        here = self._moved(state, t1, start - t1, self.unknowns[2], joint=True)
        step = 1e-5
        columns = [
            (self._half_map(here + step * unit, start) - self._half_map(here - step * unit, start)) / (2 * step)
            for unit in np.eye(2)
        ]
        return np.linalg.eigvals(np.array(columns).T).astype(complex) ** 2

    def residual(self) -> Vector:
        """Return the four conditions of the motion."""
        x0, v0, phase, _ = self.unknowns
        state, t1 = self._after()
        end = self._moved(state, t1, math.pi / self.omega - t1, phase, joint=True)
        wall = float(self._moved(self.unknowns[:2], 0.0, t1, phase, joint=False)[0])
        at_rest = self._acceleration(self.unknowns[:2], phase, joint=True)
        return np.array([at_rest, x0 + 2 * self.gap + v0 * t1 - wall, end[0] + x0, end[1] + v0])

    def _after(self) -> tuple[Vector, float]:
        """Return the state directly after the impact, and its time."""
        _, v0, phase, t1 = self.unknowns
        x, v = self._moved(self.unknowns[:2], 0.0, t1, phase, joint=False)
        return np.array([x, (v + self.mass_ratio * v0) / (1 + self.mass_ratio)]), float(t1)

    def _acceleration(self, state: Vector, phase: float, *, joint: bool) -> float:
        mass = 1 + self.mass_ratio if joint else 1.0
        return float((math.sin(phase) - state[0] - 2 * self.zeta * state[1]) / mass)

    def _moved(self, state: Vector, begin: float, time: float, phase: float, *, joint: bool) -> Vector:
        """Return the state of the oscillator, alone or with the ball, after a time."""
        rate = 1 / math.sqrt(1 + self.mass_ratio) if joint else 1.0
        response = 1 / (1 - (self.omega / rate) ** 2 + 2j * self.zeta * self.omega)

        def steady(t: float) -> Vector:
            value = response * np.exp(1j * (self.omega * t + phase))
            return np.array([value.imag, (1j * self.omega * value).imag])

        scaled = np.diag([1.0, 1 / rate])
        free = np.linalg.inv(scaled) @ transition(self.zeta * rate, rate * time) @ scaled
        return np.asarray(free @ (state - steady(begin)) + steady(begin + time))

    def _half_map(self, state: Vector, start: float) -> Vector:
        """Return the mirrored state half a cycle after a start at which the ball rides on the left-hand wall."""
        half, phase = math.pi / self.omega, self.unknowns[2]

        def joint(time: float) -> Vector:
            return self._moved(state, start, time, phase, joint=True)

        leave = _root(
            lambda t: self._acceleration(joint(t), phase + self.omega * (start + t), joint=True), half - start
        )
        there = joint(leave)

        def closing(t: float) -> float:
            wall = self._moved(there, start + leave, t, phase, joint=False)[0]
            return float(there[0] - 2 * self.gap + there[1] * t - wall)

        flight = _root(closing, self.unknowns[3])
        x, v = self._moved(there, start + leave, flight, phase, joint=False)
        after = np.array([x, (v + self.mass_ratio * there[1]) / (1 + self.mass_ratio)])
        return -self._moved(after, start + leave + flight, half - leave - flight, phase, joint=True)


def _root(function: object, guess: float) -> float:
    """Return the zero of a function near a guess by the secant method."""
    a, b = guess, guess + 1e-4
    fa, fb = function(a), function(b)  # type: ignore[operator]
    for _ in range(30):
        if fb == fa or abs(b - a) < 1e-15:
            break
        a, b, fa = b, b - fb * (b - a) / (fb - fa), fb
        fb = function(b)  # type: ignore[operator]
    return b


def motion(mass_ratio: float, gap: float, zeta: float, omega: float) -> Riding:
    """Return the motion with a gap, followed from a small one, at which the ball rides nearly always."""
    response = 1 / (1 - (1 + mass_ratio) * omega**2 + 2j * zeta * omega)
    size, lag = abs(response), -float(np.angle(response))
    # It separates where the speed is greatest to the left: x = 0, x' = -size omega, x''' = size omega^3.
    unknowns = np.array([0.0, -size * omega, lag + math.pi, 0.0])
    for share in np.geomspace(1e-3, 1.0, 60):
        one = share * gap
        if unknowns[3] == 0:
            unknowns[3] = (12 * one / (size * omega**3)) ** (1 / 3)
        for _ in range(30):
            here = Riding(mass_ratio, one, zeta, omega, unknowns).residual()
            sides = [
                [Riding(mass_ratio, one, zeta, omega, unknowns + h * unit).residual() for h in (1e-6, -1e-6)]
                for unit in np.eye(4)
            ]
            change = np.linalg.solve(np.array([(up - down) / 2e-6 for up, down in sides]).T, -here)
            unknowns = unknowns + change
            if np.abs(change).max() < 1e-13:
                break
    return Riding(mass_ratio, gap, zeta, omega, unknowns)
