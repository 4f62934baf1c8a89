"""Motion of the structure and its base, loads and the force on the base, from the modal motion and the contact forces."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.space import unit_vector

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.model.modes import ModalModel

FloatArray = NDArray[np.float64]


def structure_arrays(
    case: Case,
    time: FloatArray,
    q: FloatArray,
    p: FloatArray,
    base: FloatArray,
    force: FloatArray,
    shapes: Iterable[FloatArray],
) -> dict[str, Any]:
    """Return the arrays of a run that describe structure, loads and base, by name; both engines have them.

    Parameters
    ----------
    q, p : (T, M) float
        Modal displacement and velocity [kg^1/2 m], [kg^1/2 m/s].
    base : (3, T) or (3, T, 3) float
        Displacement, velocity and acceleration of the base; three components in a 3-D run.
    force : (T, D) or (T, D, 3) float
        Contact force on each cavity [N].
    shapes
        Mode shapes at each cavity, (M,) or (M, 3) [kg^-1/2].

    Notes
    -----
    The modal acceleration is q'' = f - D p - k q with the modal forces f of loads, contacts and base, the damping matrix D
    and the stiffness k. The force on the base is L . (D p + k q) - R a with the participation L: the force in springs and
    dashpots, and the truncated modes, which follow the acceleration a of the base without vibrating. Their residual mass is
    R = r^T M r - L^T L, the total mass less the effective masses of the modes; if the total mass is unknown, the second
    term is omitted and a run warns. For a fixed cavity the force is the contact force.

    References
    ----------
    R. W. Clough, J. Penzien (1993), Dynamics of Structures, 2nd ed., McGraw-Hill, ISBN 0-07-011394-7.
    """
    modes, acceleration_of_base = case.modes, base[2]
    three_d = acceleration_of_base.ndim == 2
    lines = modes.lines()
    at_points = np.array(list(lines.values())).reshape(len(lines), modes.decay.size)
    load = np.array([signal.evaluate(time) for signal in case.loads]).reshape(len(case.loads), time.size).T
    # Forces of springs and dashpots in modal coordinates; coupled damping adds a full matrix.
    internal = 2 * modes.decay * p + modes.stiffness * q
    if modes.coupling is not None:
        internal = internal + p @ modes.coupling
    # Modal forces of loads, contacts and the acceleration of the base; their sum less the internal ones accelerates.
    driven = np.zeros_like(q)
    for index, signal in enumerate(case.loads):
        driven += np.multiply.outer(load[:, index], modes.shape(signal.point, signal.direction))
    for index, shape in enumerate(shapes):
        driven += force[:, index] @ shape.T if three_d else np.multiply.outer(force[:, index], shape)
    inertia = _inertia(case, modes, three_d)
    if inertia is not None:
        driven -= acceleration_of_base @ inertia.T if three_d else np.multiply.outer(acceleration_of_base, inertia)
    acceleration = (driven - internal) @ at_points.T
    return {
        "time": time,
        "points": tuple(lines),
        "loads": tuple(f"{signal.kind} {number}" for number, signal in enumerate(case.loads, 1)),
        "displacement": q @ at_points.T,
        "velocity": p @ at_points.T,
        "acceleration": acceleration,
        "absolute_acceleration": acceleration + base_at_points(case, acceleration_of_base),
        "modal_displacement": q,
        "modal_velocity": p,
        "base_displacement": base[0],
        "base_velocity": base[1],
        "base_acceleration": acceleration_of_base,
        "cavity_force": force,
        "interface_force": _interface_force(case, internal, inertia, force, acceleration_of_base),
        "load": load,
        "mode_frequency": np.sqrt(modes.stiffness) / (2 * np.pi),
        "mode_energy": 0.5 * (p**2 + modes.stiffness * q**2),
    }


def _inertia(case: Case, modes: ModalModel, three_d: bool) -> FloatArray | None:
    """Return the participation of the modes, (M,) or (M, 3) [kg^1/2]; None if it is unknown."""
    if not three_d and modes.spatial:
        return None  # the base of a 1-D run has no direction, and does not move
    if modes.participation is None or not three_d or modes.spatial:
        return modes.participation
    return np.multiply.outer(modes.participation, unit_vector(case.particle_dampers[0].direction))


def base_at_points(case: Case, base: FloatArray) -> FloatArray:
    """Project a motion of the base on the direction of each point.

    Parameters
    ----------
    base : (T,) or (T, 3) float
        Displacement, velocity or acceleration of the base; three components in a 3-D run.

    Returns
    -------
    (T, P) float
        Component of the motion at each point.
    """
    modes = case.modes
    if base.ndim == 1:
        return np.repeat(base[:, None], len(modes.lines()), axis=1)
    along = base @ unit_vector(case.particle_dampers[0].direction)
    parts = [base if name in modes.spatial else along[:, None] for name in modes.shapes]
    return np.concatenate([*parts, np.zeros((len(base), 0))], axis=1)


def _interface_force(
    case: Case, internal: FloatArray, inertia: FloatArray | None, force: FloatArray, base: FloatArray
) -> FloatArray:
    """Return the force on the base; NaN if the participation of the modes is unknown."""
    modes = case.modes
    if not modes.decay.size:
        return np.asarray(force.sum(axis=1))
    if inertia is None:
        return np.full(base.shape, np.nan)
    residual = modes.residual_mass
    if residual is None:
        return np.asarray(internal @ inertia)
    if base.ndim == 1:
        return np.asarray(internal @ inertia - residual * base)
    if not modes.spatial:
        axis = unit_vector(case.particle_dampers[0].direction)
        residual = residual * np.multiply.outer(axis, axis)
    return np.asarray(internal @ inertia - base @ residual)
