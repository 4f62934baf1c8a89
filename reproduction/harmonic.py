"""The paper's system under a harmonic load, which is not in the paper."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, sqrt
from typing import NamedTuple

from rattlebox import SDOF, Case, EventDriven, Harmonic, ImpactDamper, Newton, Output, Sphere, restitution_of_alpha

from .reference import ALPHA, CONSTANT, DAMPING, GAP, MASS, RADIUS, STIFFNESS, Contact
from .two_impacts import TwoImpacts, two_impacts

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
