"""A ball in a cavity whose motion is prescribed: A sin(omega t), ball light or cavity heavy."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq


@dataclass(frozen=True)
class TwoImpacts:
    """Symmetric motion with two impacts a cycle, in units of the half clearance and of 1 / omega.

    Cavity `amplitude` sin(t + phase); the ball is at +`reach` at t = 0, where it leaves the right wall, and
    crosses to -`reach` in half a cycle.
    """

    restitution: float
    amplitude: float
    reach: float
    phase: float

    @property
    def speed(self) -> float:
        """Speed of the ball."""
        return 2 * self.reach / math.pi

    @property
    def approach(self) -> float:
        """Approach speed of each impact."""
        return 2 * self.speed / (1 + self.restitution)


def threshold(restitution: float) -> float:
    """Smallest amplitude over half clearance with two impacts a cycle."""
    rho = 2 / math.pi * (1 - restitution) / (1 + restitution)
    return rho / math.sqrt(1 + rho * rho)


def two_impacts(restitution: float, amplitude: float) -> TwoImpacts:
    """Return the upper branch of the slow manifold of the vibro-impact sink."""
    rho = 2 / math.pi * (1 - restitution) / (1 + restitution)
    reach = (1 + math.sqrt((1 + rho * rho) * amplitude**2 - rho * rho)) / (1 + rho * rho)
    phase = math.atan2(reach - 1, -rho * reach)
    return TwoImpacts(restitution, amplitude, reach, phase)


def collide_phase(ratio: float) -> float:
    """Phase after take-off at which a ball that sticks hits the other wall; ratio = A / clearance."""
    return float(brentq(lambda tau: tau - math.sin(tau) - 1 / ratio, 1e-9, 1 / ratio + 1, xtol=1e-15, rtol=1e-15))


def collect_and_collide(ratio: float) -> float:
    """Energy lost in a cycle over m A^2 omega^2 for e = 0, A / clearance = ratio >= 1 / pi."""
    return (1 - math.cos(collide_phase(ratio))) ** 2


@dataclass(frozen=True)
class TableOrbit:
    """A ball that bounces on a table A sin(omega t) with g = omega = 1: one impact in n cycles.

    The impact is at the table's phase `phase`; the ball leaves it at the speed `launch` over ground.
    """

    restitution: float
    gamma: float
    cycles: int
    phase: float
    launch: float

    @property
    def approach(self) -> float:
        """Approach speed of each impact."""
        return 2 * self.launch / (1 + self.restitution)


def table_bounds(restitution: float, cycles: int) -> tuple[float, float]:
    """Gamma at which the orbit with one impact in n cycles appears and at which it doubles."""
    e = restitution
    start = cycles * math.pi * (1 - e) / (1 + e)
    return start, math.hypot(start, 2 * (1 + e * e) / (1 + e) ** 2)


def table_orbit(restitution: float, gamma: float, cycles: int) -> TableOrbit:
    """Return the stable orbit with one impact in n cycles."""
    launch = math.pi * cycles
    phase = math.acos(table_bounds(restitution, cycles)[0] / gamma)
    return TableOrbit(restitution, gamma, cycles, phase, launch)


def chatter_time(height: float, restitution: float, gravity: float, hits: int | None = None) -> float:
    """Time of an impact (counted from 1) of a dropped ball, or time at which it comes to rest."""
    e, fall = restitution, math.sqrt(2 * height / gravity)
    if hits is None:
        return fall * (1 + e) / (1 - e)
    return fall * (1 + 2 * sum(e**k for k in range(1, hits)))


def chatter_path(height: float, restitution: float) -> float:
    """Path of a dropped ball until it comes to rest."""
    return height * (1 + restitution**2) / (1 - restitution**2)


@dataclass(frozen=True)
class InelasticBall:
    """An inelastic ball on a shaker A sin(t) with g = 1, m = 1 and A = gamma: one flight a cycle.

    It takes off at `take_off` and lands at `landing` (phases) with the relative speed `approach`.
    """

    gamma: float
    take_off: float
    landing: float
    approach: float

    def apparent_mass(self) -> tuple[float, float]:
        """Parts of m' - i m'', first harmonic of the force over that of the table's acceleration."""
        g = self.gamma
        start, stop = self.landing, self.take_off + 2 * math.pi
        # Force on the ball: 1 - gamma sin t while it rests on the table, and an impulse on landing.
        sines = self.approach * math.sin(start) + _integral(
            lambda t: -math.cos(t) - g * (0.5 * t - 0.25 * math.sin(2 * t)), start, stop
        )
        cosines = self.approach * math.cos(start) + _integral(
            lambda t: math.sin(t) + g * 0.25 * math.cos(2 * t), start, stop
        )
        return -sines / (math.pi * g), cosines / (math.pi * g)


def _integral(primitive, start, stop):  # type: ignore[no-untyped-def]
    return primitive(stop) - primitive(start)


def inelastic_ball(gamma: float) -> InelasticBall:
    """Return the motion with one flight a cycle; gamma > 1 and a landing where the table holds the ball."""
    off = math.asin(1 / gamma)
    speed = gamma * math.cos(off)

    def height(t: float) -> float:
        s = t - off
        return 1 + speed * s - 0.5 * s * s - gamma * math.sin(t)

    times = np.linspace(off, off + 2 * math.pi, 20001)[10:]
    low = next(i for i, t in enumerate(times) if height(float(t)) < 0)
    land = float(brentq(height, times[low - 1], times[low], xtol=1e-15, rtol=1e-15))
    if gamma * math.sin(land) > 1 or land > off + 2 * math.pi:
        raise ValueError(f"no motion with one flight a cycle at gamma = {gamma}")
    return InelasticBall(gamma, off, land, -(speed - (land - off) - gamma * math.cos(land)))
