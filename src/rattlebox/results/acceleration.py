"""Acceleration of a structure from its modes and the forces on it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.space import unit_vector

from .damper_force import mean_damper_force

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.model.modes import ModalModel

    from .arrays import RunArrays

FloatArray = NDArray[np.float64]


def internal_force(modes: ModalModel, q: FloatArray, p: FloatArray) -> FloatArray:
    """Return the modal force of springs and dashpots, D p + k q, (T, M), against the motion."""
    internal = 2 * modes.decay * p + modes.stiffness * q
    return internal if modes.coupling is None else internal + p @ modes.coupling


def inertia(case: Case, three_d: bool) -> FloatArray | None:
    """Return the participation of the modes, (M,) or (M, 3) [kg^1/2]; None if it is unknown."""
    modes = case.modes
    if not three_d and modes.spatial:
        return None  # the base of a 1-D run has no direction, and does not move
    if modes.participation is None or not three_d or modes.spatial:
        return modes.participation
    return np.multiply.outer(modes.participation, unit_vector(case.particle_dampers[0].direction))


def force_on_modes(
    case: Case, load: FloatArray, base: FloatArray, force: FloatArray, shapes: Iterable[FloatArray]
) -> FloatArray:
    """Return the modal force of loads, of a motion of the base, and of contacts.

    `load`: loads [N], (T, L). `base`: acceleration of the base [m/s^2]; three components in a 3-D run, (T,) or (T, 3).
    `force`: contact force on each cavity [N], (T, D) or (T, D, 3). `shapes`: mode shapes at each cavity, (M,) or (M, 3)
    [kg^-1/2]. Returns modal force [kg^1/2 m/s^2], (T, M).
    """
    modes, three_d = case.modes, base.ndim == 2
    driven = np.zeros((len(base), modes.decay.size))
    for index, signal in enumerate(case.loads):
        driven += np.multiply.outer(load[:, index], modes.shape(signal.point, signal.direction))
    for index, shape in enumerate(shapes):
        driven += force[:, index] @ shape.T if three_d else np.multiply.outer(force[:, index], shape)
    moved = inertia(case, three_d)
    if moved is not None:
        driven -= base @ moved.T if three_d else np.multiply.outer(base, moved)
    return driven


def base_at_points(case: Case, base: FloatArray) -> FloatArray:
    """Project a motion of the base on the direction of each point.

    `base`: displacement, velocity or acceleration of the base; three components in a 3-D run, (T,) or (T, 3). Returns
    component of the motion at each point, (T, P).
    """
    modes = case.modes
    if base.ndim == 1:
        return np.repeat(base[:, None], len(modes.lines()), axis=1)
    along = base @ unit_vector(case.particle_dampers[0].direction)
    parts = [base if name in modes.spatial else along[:, None] for name in modes.shapes]
    return np.concatenate([*parts, np.zeros((len(base), 0))], axis=1)


def accelerations_of_steps(arrays: RunArrays, case: Case, shapes: FloatArray) -> FloatArray:
    """Return the acceleration relative to the base at the start and at the end of each output step.

    `shapes`: mode shapes of K motions, for instance of points [kg^-1/2], (M, K). Returns accelerations, (2, T - 1, K).

    Notes
    -----
    Springs, dashpots, harmonic loads and the base act with their values at these times. Contacts and other loads, whose
    pulses may be shorter than the step, act with their mean over the step. A mean of the whole, the difference of the
    velocities, would lack (pi f dt)^2 / 6 of a motion of frequency f.
    """
    modes, time = case.modes, arrays.time
    step = np.diff(time)
    sampled = arrays.load * np.array([signal.is_resolved for signal in case.loads], dtype=float)
    still = np.zeros_like(arrays.cavity_force)
    at = force_on_modes(case, sampled, arrays.base_acceleration, still, ())
    at = at - internal_force(modes, arrays.modal_displacement, arrays.modal_velocity)
    pulses = np.zeros((step.size, len(case.loads)))
    for index, signal in enumerate(case.loads):
        if not signal.is_resolved:
            pulses[:, index] = np.diff(signal.motion(time)[1]) / step  # a velocity is the integral of the signal
    if arrays.engine == "dem":
        cavities = [modes.space_shape(damper.point, damper.direction) for damper in case.particle_dampers]
    else:
        cavities = [modes.shape(damper.point) for damper in case.impact_dampers]
        cavities += [stop.shape(modes) for stop in case.each_stop]
    mean = force_on_modes(
        case, pulses, np.zeros_like(arrays.base_acceleration[1:]), mean_damper_force(arrays, case), cavities
    )
    return np.stack([at[:-1] + mean, at[1:] + mean]) @ shapes
