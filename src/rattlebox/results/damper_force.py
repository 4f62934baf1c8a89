"""Force of balls, particles and stops on the structure, averaged over each output step."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from rattlebox.model.case import Case

    from .arrays import RunArrays


def has_hard_impacts(arrays: RunArrays) -> bool:
    """Return whether impacts of a run have no duration, so that their forces and accelerations are infinite."""
    return arrays.engine != "dem" and bool(np.isposinf(arrays.impacts.peak_force).any())


def mean_damper_force(arrays: RunArrays, case: Case) -> NDArray[np.float64]:
    """Return the force on each cavity, averaged between output times, from the balance of momentum of its balls.

    The force of stops on their points follows from their impulses.

    Samples of `cavity_force` miss most of the short contacts.

    Returns force on each of D cavities [N]; three components in a 3-D run, (T - 1, D) or (T - 1, D, 3).

    Notes
    -----
    F = -dP/dt - m (a - g) with the momentum P relative to the base, the acceleration a of the base and gravity g.
    """
    step = np.diff(arrays.time)
    base = np.diff(arrays.base_velocity, axis=0)
    if arrays.engine == "dem":
        gravity = np.array([damper.gravity for damper in case.particle_dampers]).reshape(-1, 3)
        inertia = np.diff(arrays.momentum, axis=0) + arrays.particle_mass[:, None] * base[:, None]
        mean = np.asarray(arrays.particle_mass[:, None] * gravity - inertia / step[:, None, None])
        for index, rotation in enumerate(damper.rotation for damper in case.particle_dampers):
            # A structure that turns with its cavity is driven along the axes of the cavity.
            if rotation is not None and rotation.vibration == "cavity":
                angle = arrays.cavity_angle[:, index]
                mean[:, index] = rotation.to_cavity(mean[:, index], 0.5 * (angle[1:] + angle[:-1]))
        return mean
    force = np.zeros((step.size, len(arrays.dampers)))
    for index, damper in enumerate(case.impact_dampers):
        in_damper = arrays.ball_damper == index
        masses = np.asarray(damper.masses, dtype=float)
        inertia = (np.diff(arrays.ball_velocity[:, in_damper], axis=0) + base[:, None]) @ masses
        force[:, index] = masses.sum() * damper.gravity - inertia / step
    if arrays.stops:
        force[:, -len(arrays.stops) :] = np.diff(arrays.stop_impulse, axis=0) / step[:, None]
    return force
