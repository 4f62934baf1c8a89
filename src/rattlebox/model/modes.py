"""The modal form that every structure reduces to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .elementwise import Vector, inverse, total
from .errors import Hint, nearest
from .space import AXES, Triple, unit_vector


@dataclass(frozen=True, eq=False)
class ModalModel:
    """Modes of a linear structure, q'' + 2 decay q' + coupling q' + stiffness q = shape . F, with unit modal mass.

    Attributes
    ----------
    decay, stiffness : (m,) float
        Decay rate a [1/s] and squared natural frequency k [1/s^2].
    shapes : dict of str to (m,) or (m, 3) float
        Mass-normalised mode shapes at the named points [kg^-1/2]; with three components where the point moves in space.
    coupling : (m, m) float or None
        Modal damping matrix D [1/s] without its diagonal, which is 2 decay; None where damping is proportional. The
        modes are those of the undamped structure: q'' + D q' + stiffness q = shape . F.
    participation : (m,) or (m, 3) float or None
        Inertia of each mode per unit of base acceleration [kg^1/2], for each direction where points move in space.
    q0, p0 : (m,) float
        Modal displacement and velocity at the start [kg^1/2 m], [kg^1/2 m/s].
    """

    decay: Vector
    stiffness: Vector
    shapes: dict[str, Vector]
    participation: Vector | None
    q0: Vector
    p0: Vector
    spatial: frozenset[str] = frozenset()
    """Points that move in space."""
    coupling: Vector | None = None
    attached: frozenset[str] = frozenset()
    """Points of tuned masses; the others are those of the structure itself."""

    def point(self, name: str | None) -> str:
        """Return the name of a point; None stands for the only one.

        Raises
        ------
        CaseError
            When there is no such point, or None and more than one.
        """
        if name is None:
            own = [known for known in self.shapes if known not in self.attached]
            if len(own) != 1:
                raise Hint("a point must be named", " or ".join(f'point = "{known}"' for known in own))
            return own[0]
        if name not in self.shapes:
            raise Hint(f"the structure has no point {name!r}", nearest(name, self.shapes))
        return name

    def shape(self, name: str | None, direction: str | Triple | None = None) -> Vector:
        """Return the mode shapes at a point, (m,), along a direction where the point moves in space.

        Raises
        ------
        CaseError
            When there is no such point, or it moves in space and there is no direction, or the other way round.
        """
        point = self.point(name)
        if point not in self.spatial:
            if direction is not None:
                advice = 'leave it out; direction = "z" of a damper with particles is that of the line'
                raise Hint(f"the point {point!r} moves along one line only", advice, ["direction"])
            return self.shapes[point]
        if direction is None:
            raise Hint(f"the point {point!r} moves in space", 'direction = "z"', ["direction"])
        return np.asarray(self.shapes[point] @ unit_vector(direction))

    def space_shape(self, name: str | None, direction: str | Triple) -> Vector:
        """Return the mode shapes at a point in space, (m, 3); a point on a line moves along the direction."""
        point = self.point(name)
        if point in self.spatial:
            return self.shapes[point]
        return np.multiply.outer(self.shapes[point], unit_vector(direction))

    def lines(self) -> dict[str, Vector]:
        """Return the mode shapes of all points on lines, (m,) each: "tip x", "tip y" and "tip z" of one in space."""
        found: dict[str, Vector] = {}
        for name, shape in self.shapes.items():
            if name in self.spatial:
                found |= {f"{name} {axis}": shape[:, k] for k, axis in enumerate(AXES)}
            else:
                found[name] = shape
        return found

    def effective_mass(self, name: str | None) -> float:
        """Return the mass that an impact at a point feels, 1 / sum(shape^2) [kg]; infinite where nothing moves."""
        mass: float = inverse(total(self.shape(name) ** 2))
        return mass
