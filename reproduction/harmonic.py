"""The paper's system under a harmonic load, which is not in the paper."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, sqrt
from typing import NamedTuple

from rattlebox import SDOF, Case, EventDriven, Harmonic, ImpactDamper, Newton, Output, Sphere

from .reference import CONSTANT, DAMPING, GAP, MASS, RADIUS, STIFFNESS, Contact

BALL = Sphere(radius=RADIUS, material="steel").weight  # Mass of the ball [kg]


class State(NamedTuple):
    """State of structure and ball when the sine begins."""

    displacement: float = 0.0  # Of the structure [m]
    velocity: float = 0.0  # Of the structure [m/s]
    ball_position: float = 0.0  # Of the ball in its cavity, from the centre [m]
    ball_velocity: float = 0.0  # Of the ball over ground [m/s]


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
    """Return the paper's system under a sinusoidal force that starts at zero."""
    z, v, y, w = state or State()
    damper = ImpactDamper(
        balls=(Sphere(radius=RADIUS, material="steel"),),
        gap=GAP,
        start=y / GAP,
        velocity=(w,),
        contact=contact,
    )
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
    """Return the initial state of the steady motion in which the ball moves with the structure."""
    omega = 2 * pi * frequency
    response = amplitude / (STIFFNESS - (MASS + BALL) * omega**2 + 1j * DAMPING * omega)
    speed = omega * response.real
    return State(response.imag, speed, place, speed)


def resonance() -> float:
    """Return the natural frequency of the structure with the ball attached [Hz]."""
    return sqrt(STIFFNESS / (MASS + BALL)) / (2 * pi)
