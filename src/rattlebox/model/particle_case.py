"""Cases with particle dampers: directions of motion, and checks of consistency."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.narrow import instance

from .elementwise import Vector
from .errors import Hint, at
from .methods import Dem
from .particle_damper import ParticleDamper
from .space import unit_vector

if TYPE_CHECKING:
    from .case import Case
    from .signals import Signal


def direction_of_base(case: Case, signal: Signal) -> Vector:
    """Return the direction in which a signal moves the base, (3,): its own, or that of all dampers."""
    if signal.direction is not None:
        return unit_vector(signal.direction)
    directions = {damper.direction for damper in case.particle_dampers}
    if len(directions) > 1:
        raise Hint("dampers move in several directions, and the base needs one", 'direction = "x"', ["direction"])
    return unit_vector(directions.pop())


def inertia_along(case: Case, direction: Vector) -> Vector:
    """Return the inertia of each mode per unit of base acceleration along a direction, (m,) [kg^1/2]."""
    modes = case.modes
    if modes.participation is None:
        return np.zeros(modes.decay.size)
    if modes.spatial:
        return np.asarray(modes.participation @ direction)
    own = unit_vector(case.particle_dampers[0].direction)
    return np.asarray(modes.participation * (own @ direction))


def check_particle_case(case: Case) -> None:
    """Raise if the parts of a case with particle dampers are inconsistent."""
    first = case.particle_dampers[0]
    if case.impact_dampers:
        raise Hint(
            "impact dampers and particle dampers cannot be in one case",
            "a ParticleDamper with one particle in place of each impact damper",
            ["dampers"],
        )
    if not isinstance(case.method, Dem):
        raise Hint(f"{case.method.kind} computes impact dampers only", 'kind = "dem"', ["method"])
    if case.output.times is not None:
        times = case.sample_times()
        even = np.linspace(0.0, case.duration, times.size)
        if np.abs(times - even).max() > 1e-6 * even[1]:
            raise Hint(
                "particles move in equal steps: output times must be evenly spaced, together with 0 and the end",
                "a rate",
                ["output", "times"],
            )
    for index, damper in enumerate(case.dampers):
        damper = instance(damper, ParticleDamper)
        with at("dampers", index):
            if damper.gravity != first.gravity:
                raise Hint(
                    f"gravity must be the same for all dampers of a case, and another one has {list(first.gravity)} m/s^2",
                    "the same gravity",
                    ["gravity"],
                )
            for number, point in enumerate(damper.points or (damper.point,)):
                with at(*(("points", number) if damper.points else ("point",))):
                    case.modes.space_shape(point, damper.direction)
    if case.base and not case.modes.spatial and len({damper.direction for damper in case.particle_dampers}) > 1:
        raise Hint(
            "a structure whose points move along lines has one direction, but its dampers have several",
            "mode shapes of three components, or the same direction",
            ["dampers"],
        )
    for field, signals in (("base", case.base), ("motion", case.shaker_motion)):
        for index, signal in enumerate(signals):
            with at(*(("structure",) if field == "motion" else ()), field, index):
                direction_of_base(case, signal)
