"""The paper's system: a steel ball in a cavity on a sprung mass, hit by a short pulse."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from rattlebox.model.case import Case
from rattlebox.model.contacts import Contact, Tsuji
from rattlebox.model.dampers import ImpactDamper, Sphere
from rattlebox.model.methods import EventDriven, Newton, Output, TwoStep
from rattlebox.model.restitutions import JacksonGreen
from rattlebox.model.signals import HalfSine
from rattlebox.model.structures import SDOF

MASS, STIFFNESS, DAMPING = 20.0, 80e3, 25.3
"""Of the structure [kg, N/m, N s/m]."""
RADIUS, GAP = 33.17e-3, 0.4e-3
"""Of the ball; d0, the clearance on each side when it is centred [m]."""
ALPHA = 0.006313
"""Tsuji's coefficient of the constant-restitution model."""
PULSE = 1e-3
"""Duration of the half sine [s]."""

START = {1: 0.0, 2: -1.0, 3: 1.0}
"""Reduced start position of the paper's cases: centred, touching the trailing wall, touching the leading wall."""

CONSTANT = Tsuji(alpha=ALPHA, ending="zero_overlap")
"""The constant-restitution model."""
PLASTIC = Tsuji(restitution=JacksonGreen(), ending="zero_overlap")
"""The elasto-plastic impact model between a steel ball and a steel wall."""
PLASTIC_RIGID = Tsuji(restitution=JacksonGreen(wall="rigid"), ending="zero_overlap")
"""The same with a wall that counts as rigid in the critical speed."""


def seed_case(
    contact: Contact = CONSTANT,
    *,
    start: float = 0.0,
    amplitude: float = 5000.0,
    duration: float = 10.0,
    times: Sequence[float] | None = None,
    rate: float | None = None,
    method: EventDriven | TwoStep | Newton | None = None,
    wall: Literal["rigid"] | None = None,
    ball: bool = True,
    name: str = "",
) -> Case:
    """Return the paper's case.

    Parameters
    ----------
    contact
        Contact law: CONSTANT, PLASTIC, PLASTIC_RIGID, or any other.
    start
        Reduced start position of the ball, -1 at the trailing wall to 1 at the leading wall; see START.
    amplitude
        Of the half sine [N].
    duration
        Of the run [s].
    times, rate
        Output times [s], or samples a second [Hz]; default those that suit pictures of the motion.
    method
        Default event-driven.
    wall
        "rigid" makes the wall rigid in the contact stiffness too.
    ball
        False leaves the damper out.
    name
        Of the case.
    """
    damper = ImpactDamper(
        balls=(Sphere(radius=RADIUS, material="steel"),), gap=GAP, start=start, contact=contact, wall=wall
    )
    return Case(
        name=name,
        structure=SDOF(mass=MASS, stiffness=STIFFNESS, damping=DAMPING),
        dampers=(damper,) if ball else (),
        loads=(HalfSine(amplitude=amplitude, duration=PULSE),),
        duration=duration,
        method=method or EventDriven(),
        output=Output(rate=rate) if times is None else Output(times=times),
    )
