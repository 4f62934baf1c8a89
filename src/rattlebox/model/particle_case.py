"""Directions of motion in cases with particle dampers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .elementwise import Vector
from .errors import Hint
from .modes import ModalModel
from .particle_damper import ParticleDamper
from .signals import Signal
from .space import unit_vector


def direction_of_base(dampers: Sequence[ParticleDamper], signal: Signal) -> Vector:
    """Return the direction in which a signal moves the base, (3,): its own, or that of all dampers."""
    if signal.direction is not None:
        return unit_vector(signal.direction)
    directions = {damper.direction for damper in dampers}
    if len(directions) > 1:
        raise Hint("dampers move in several directions, and the base needs one", 'direction = "x"', ["direction"])
    return unit_vector(directions.pop())


def inertia_along(modes: ModalModel, dampers: Sequence[ParticleDamper], direction: Vector) -> Vector:
    """Return the inertia of each mode per unit of base acceleration along a direction, (m,) [kg^1/2]."""
    if modes.participation is None:
        return np.zeros(modes.decay.size)
    if modes.spatial:
        return np.asarray(modes.participation @ direction)
    own = unit_vector(dampers[0].direction)
    return np.asarray(modes.participation * (own @ direction))
