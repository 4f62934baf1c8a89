"""The modal form of all structures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .elementwise import Vector, inverse, total
from .errors import Hint, nearest
from .space import AXES, Triple, unit_vector
from .units import whole_number


def main_axis(vectors: Vector) -> str:
    """Return the axis along which mode shapes or participations, (m, 3), are largest: "x", "y" or "z"."""
    return AXES[int(np.argmax(np.sum(np.square(vectors), axis=0).reshape(3, -1)[:, 0]))]


@dataclass(frozen=True, eq=False)
class ModalModel:
    """Modes of a linear structure, with unit modal mass.

    Notes
    -----
    q'' + 2 a q' + D q' + k q = phi^T F - p a_b, with the decay rates a, the coupling D, the stiffness k, the shapes phi, the
    participation p and the acceleration a_b of the base. `Modal` names the sources.
    """

    decay: Vector  # Decay rate a [1/s] and squared natural frequency k [1/s^2], (m,)
    stiffness: Vector
    # Mass-normalised mode shapes at the named points [kg^-1/2]; with three components for a point in 3-D
    shapes: dict[str, Vector]
    # Inertia of each mode per unit of base acceleration [kg^1/2]; three components for points in 3-D, (m,) or (m, 3)
    participation: Vector | None
    q0: Vector  # Initial modal displacement and velocity [kg^1/2 m], [kg^1/2 m/s], (m,)
    p0: Vector
    spatial: frozenset[str] = frozenset()
    # Modal damping matrix D [1/s] without its diagonal, which is 2 decay; None for proportional damping. The modes are those
    # of the undamped structure, (m, m)
    coupling: Vector | None = None
    attached: frozenset[str] = frozenset()
    # Mass r^T M r that moves with the base if the structure is rigid [kg]; a matrix if points move in 3-D
    total_mass: Any = None

    @property
    def residual_mass(self) -> Vector | None:
        """Mass of the truncated modes, r^T M r - p^T p, with the participation p [kg]; None if it is unknown."""
        if self.total_mass is None or self.participation is None:
            return None
        rows = self.participation
        return np.asarray(self.total_mass - (rows.T @ rows))

    def point(self, name: str | None, field: str = "point") -> str:
        """Return the name of a point; None is the only point of the structure. A message names the field."""
        if name is None:
            own = [known for known in self.shapes if known not in self.attached]
            if len(own) != 1:
                raise Hint("a point must be named", " or ".join(f'{field} = "{known}"' for known in own))
            return own[0]
        if name not in self.shapes:
            raise Hint(f"the structure has no point {name!r}", nearest(name, self.shapes))
        return name

    def elastic(self, number: object) -> int:
        """Return the index of a mode with a natural frequency from its number, counted from 1."""
        index = whole_number(number, "mode", 1) - 1
        elastic = np.flatnonzero(self.stiffness > 0)
        if index not in elastic:
            known = ", ".join(str(k + 1) for k in elastic)
            raise Hint(f"mode = {number} is not a mode with a natural frequency", f"one of these: {known or 'none'}")
        return index

    def shape(self, name: str | None, direction: str | Triple | None = None) -> Vector:
        """Return the mode shapes at a point, (m,); along a direction if the point moves in 3-D."""
        point = self.point(name)
        if point not in self.spatial:
            if direction is not None:
                advice = 'leave it out; direction = "z" of a particle damper sets the direction of the line'
                raise Hint(f"the point {point!r} moves along one line only", advice, ["direction"])
            return self.shapes[point]
        if direction is None:
            advice = f'direction = "{main_axis(self.shapes[point])}"'
            raise Hint(f"the point {point!r} moves in 3-D and needs a direction", advice, ["direction"])
        return np.asarray(self.shapes[point] @ unit_vector(direction))

    def space_shape(self, name: str | None, direction: str | Triple) -> Vector:
        """Return the mode shapes at a point in 3-D, (m, 3); those of a point on a line are along the direction."""
        point = self.point(name)
        if point in self.spatial:
            return self.shapes[point]
        return np.multiply.outer(self.shapes[point], unit_vector(direction))

    def lines(self) -> dict[str, Vector]:
        """Return the scalar mode shapes of all points, (m,) each; a point "tip" in 3-D has "tip x", "tip y" and "tip z"."""
        lines: dict[str, Vector] = {}
        for name, shape in self.shapes.items():
            if name in self.spatial:
                lines |= {f"{name} {axis}": shape[:, k] for k, axis in enumerate(AXES)}
            else:
                lines[name] = shape
        return lines

    def mobility(self, name: str | None) -> float:
        """Return the largest inverse effective mass of a point over its directions [1/kg]; 0 for a fixed structure."""
        shape = self.shapes[self.point(name)]
        return float(np.max(np.sum(np.square(shape), axis=0), initial=0.0))

    def harmonic_response(self, omega: Vector, forces: Vector) -> NDArray[np.complex128]:
        """Return the complex amplitudes of the modal displacements for harmonic modal forces.

        `omega`: angular frequencies [rad/s], (F,). `forces`: amplitudes of modal forces of n loads, (m, n). Returns modal
        displacements q, (F, m, n).

        Notes
        -----
        q = (k - omega^2 + i omega D)^(-1) f, the amplitude of the solution of q'' + D q' + k q = f exp(i omega t).
        """
        dynamic = self.stiffness - omega[:, None] ** 2 + 2j * self.decay * omega[:, None]
        if self.coupling is None:
            return np.asarray(forces / dynamic[..., None], np.complex128)
        matrix = 1j * omega[:, None, None] * self.coupling + dynamic[..., None] * np.eye(self.stiffness.size)
        return np.asarray(np.linalg.solve(matrix, np.broadcast_to(forces, (omega.size, *forces.shape))), np.complex128)

    def effective_mass(self, name: str | None) -> float:
        """Return the effective mass for an impact at a point, 1 / sum(shape^2) [kg]; infinite for a fixed structure."""
        mass: float = inverse(total(self.shape(name) ** 2))
        return mass
