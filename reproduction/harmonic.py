"""The paper's system under a harmonic load, which is not in the paper, and its exact motion with two impacts per cycle.

References
----------
S. F. Masri and T. K. Caughey, "On the stability of the impact damper", Journal of Applied Mechanics 33 (1966) 586-592.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, sqrt
from typing import NamedTuple

import numpy as np

from rattlebox import SDOF, Case, EventDriven, Harmonic, ImpactDamper, Newton, Output, Sphere, restitution_of_alpha

from .system import ALPHA, CONSTANT, DAMPING, GAP, MASS, RADIUS, STIFFNESS, Array, Contact

BALL = Sphere(radius=RADIUS, material="steel").weight  # mass of the ball [kg]


class State(NamedTuple):
    """State of structure and ball when the sine begins."""

    displacement: float = 0.0  # of the structure [m]
    velocity: float = 0.0  # of the structure [m/s]
    ball_position: float = 0.0  # of the ball in its cavity, from the centre [m]
    ball_velocity: float = 0.0  # of the ball over ground [m/s]


def harmonic_case(
    contact: Contact = CONSTANT,
    *,
    amplitude: float,
    frequency: float,
    state: State | None = None,
    duration: float = 10.0,
    times: Sequence[float] | None = None,
    rate: float | None = None,
    method: EventDriven | Newton | None = None,
    ball: bool = True,
    name: str = "",
) -> Case:
    """Return the paper's system under a sinusoidal force [N, Hz] that starts at zero; options as for `paper_case`."""
    z, v, y, w = state or State()
    sphere = Sphere(radius=RADIUS, material="steel")
    damper = ImpactDamper(balls=(sphere,), gap=GAP, start=y / GAP, velocity=(w,), contact=contact)
    return Case(
        name=name,
        structure=SDOF(mass=MASS, stiffness=STIFFNESS, damping=DAMPING, displacement=z, velocity=v),
        dampers=(damper,) if ball else (),
        loads=(Harmonic(amplitude=amplitude, frequency=frequency),),
        duration=duration,
        method=method or EventDriven(),
        output=Output(rate=rate) if times is None else Output(times=times),
    )


def riding(amplitude: float, frequency: float, place: float = 0.0) -> State:
    """Return the start of the steady motion with the ball at a place of its cavity [m], under a load [N, Hz]."""
    omega = 2 * pi * frequency
    response = amplitude / (STIFFNESS - (MASS + BALL) * omega**2 + 1j * DAMPING * omega)
    speed = omega * response.real
    return State(response.imag, speed, place, speed)


def resonance() -> float:
    """Return the natural frequency of the structure with the ball attached [Hz]."""
    return sqrt(STIFFNESS / (MASS + BALL)) / (2 * pi)


def paper_two_impacts(amplitude: float, frequency: float) -> tuple[TwoImpacts, ...]:
    """Return the exact motions with two impacts per cycle of the paper's system under a load [N, Hz]."""
    return two_impacts(
        mass=MASS,
        stiffness=STIFFNESS,
        damping=DAMPING,
        ball=BALL,
        clearance=2 * GAP,
        restitution=float(restitution_of_alpha(ALPHA, "zero_overlap")),
        amplitude=amplitude,
        frequency=frequency,
    )


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
