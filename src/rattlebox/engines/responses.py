"""Motion of the structure and its base, loads and the force on the base, from the modal motion and the contact forces."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.space import unit_vector
from rattlebox.results.acceleration import base_at_points, force_on_modes, inertia, internal_force

if TYPE_CHECKING:
    from rattlebox.model.case import Case

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
    internal = internal_force(modes, q, p)
    # Modal forces of loads, contacts and the acceleration of the base; their sum less the internal ones accelerates.
    driven = force_on_modes(case, load, acceleration_of_base, force, shapes)
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
        "interface_force": _interface_force(case, internal, inertia(case, three_d), force, acceleration_of_base),
        "load": load,
        "mode_frequency": np.sqrt(modes.stiffness) / (2 * np.pi),
        "mode_energy": 0.5 * (p**2 + modes.stiffness * q**2),
    }


def _interface_force(
    case: Case, internal: FloatArray, moved: FloatArray | None, force: FloatArray, base: FloatArray
) -> FloatArray:
    """Return the force on the base; NaN if the participation of the modes is unknown."""
    modes = case.modes
    if not modes.decay.size:
        return np.asarray(force.sum(axis=1))
    if moved is None:
        return np.full(base.shape, np.nan)
    residual = modes.residual_mass
    if residual is None:
        return np.asarray(internal @ moved)
    if base.ndim == 1:
        return np.asarray(internal @ moved - residual * base)
    if not modes.spatial:
        axis = unit_vector(case.particle_dampers[0].direction)
        residual = residual * np.multiply.outer(axis, axis)
    return np.asarray(internal @ moved - base @ residual)
