"""The modal form that every structure reduces to."""

from __future__ import annotations

from dataclasses import dataclass

from .elementwise import Vector, inverse, total
from .errors import Hint, nearest


@dataclass(frozen=True, eq=False)
class ModalModel:
    """Modes of a linear structure, q'' + 2 decay q' + stiffness q = shape . F, with unit modal mass.

    Attributes
    ----------
    decay, stiffness : (m,) float
        Decay rate a [1/s] and squared natural frequency k [1/s^2].
    shapes : dict of str to (m,) float
        Mass-normalised mode shapes at the named points [kg^-1/2].
    participation : (m,) float or None
        Inertia of each mode per unit of base acceleration [kg^1/2].
    q0, p0 : (m,) float
        Modal displacement and velocity at the start [kg^1/2 m], [kg^1/2 m/s].
    """

    decay: Vector
    stiffness: Vector
    shapes: dict[str, Vector]
    participation: Vector | None
    q0: Vector
    p0: Vector

    def point(self, name: str | None) -> str:
        """Return the name of a point; None stands for the only one.

        Raises
        ------
        CaseError
            When there is no such point, or None and more than one.
        """
        if name is None:
            if len(self.shapes) != 1:
                raise Hint("a point must be named", " or ".join(f'point = "{known}"' for known in self.shapes))
            return next(iter(self.shapes))
        if name not in self.shapes:
            raise Hint(f"the structure has no point {name!r}", nearest(name, self.shapes))
        return name

    def shape(self, name: str | None) -> Vector:
        """Return the mode shapes at a point, (m,)."""
        return self.shapes[self.point(name)]

    def effective_mass(self, name: str | None) -> float:
        """Return the mass that an impact at a point feels, 1 / sum(shape^2) [kg]; infinite where nothing moves."""
        mass: float = inverse(total(self.shape(name) ** 2))
        return mass
