"""Pairs of bodies in contact: effective modulus, radius and mass."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from rattlebox._util.narrow import present

from .elementwise import exp, less, power, sqrt
from .errors import Hint
from .materials import Material


def hardness(poisson: float, yield_stress: float) -> float:
    """Return the pressure at the centre of a contact at which yield begins, C S_y with C = 1.295 exp(0.736 nu) [Pa].

    References
    ----------
    R. L. Jackson, I. Green, J. Tribol. 127 (2005) 343, doi:10.1115/1.1866166.
    """
    factor: float = 1.295 * exp(0.736 * poisson)
    return factor * yield_stress


@dataclass(frozen=True)
class Body:
    """One side of a contact.

    Attributes
    ----------
    material
        Material; None for a rigid body.
    radius, mass
        Radius of the surface [m], infinite for a wall; mass of the body [kg], infinite for a fixed body.
    """

    material: Material | None
    radius: float = math.inf
    mass: float = math.inf

    @property
    def is_flat(self) -> bool:
        """Whether the body is a wall."""
        return isinstance(self.radius, float) and math.isinf(self.radius)

    @property
    def compliance(self) -> float:
        """(1 - nu^2) / E [1/Pa], 0 for a rigid body."""
        return 0.0 if self.material is None else (1 - power(self.material.poisson, 2)) / self.material.young

    @property
    def hardness(self) -> float:
        """Hardness [Pa]; the body with the lower hardness yields first."""
        if self.material is None or self.material.yield_stress is None:
            return math.inf
        return hardness(self.material.poisson, self.material.yield_stress)

    def or_weaker(self, other: Body) -> Body:
        """Return the body of two that yields first; for arrays, a body with the weaker material of each element."""
        own, others = present(self.material), present(other.material)
        weaker = less(other.hardness, self.hardness, others.young, own.young)
        if not isinstance(weaker, np.ndarray):
            return other if weaker else self
        chosen = {
            name: np.where(weaker, getattr(others, name), getattr(own, name))
            for name in ("young", "poisson", "yield_stress")
        }
        return Body(own.model_copy(update=chosen))


@dataclass(frozen=True)
class Pair:
    """Two bodies in contact.

    Attributes
    ----------
    below, above
        The bodies on the negative and on the positive side.
    """

    below: Body
    above: Body

    @property
    def is_wall(self) -> bool:
        """Whether one of the bodies is a wall."""
        return self.below.is_flat or self.above.is_flat

    @property
    def modulus(self) -> float:
        """Effective modulus E* [Pa], with 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2."""
        return 1 / (self.below.compliance + self.above.compliance)

    @property
    def radius(self) -> float:
        """Effective radius R* [m], with 1/R* = 1/R_1 + 1/R_2."""
        return 1 / (1 / self.below.radius + 1 / self.above.radius)

    @property
    def mass(self) -> float:
        """Effective mass m* [kg], with 1/m* = 1/m_1 + 1/m_2."""
        return 1 / (1 / self.below.mass + 1 / self.above.mass)

    @property
    def hertz_stiffness(self) -> float:
        """Stiffness of Hertz's law, 4/3 E* R*^(1/2) [N/m^1.5]; `Tsuji` names the source."""
        stiffness: float = 4 / 3 * self.modulus * sqrt(self.radius)
        return stiffness

    def first_to_yield(self, need: str) -> Body:
        """Return the body that yields first; the softer one of two with equal hardness.

        Raises
        ------
        Hint
            If neither material has a yield stress; `need` names the law in the message.
        """
        bodies = [b for b in (self.below, self.above) if b.material is not None and b.material.yield_stress is not None]
        if not bodies:
            raise Hint(f"{need} needs a material with a yield stress", 'yield_stress = "1030 MPa" in the material')
        return reduce(Body.or_weaker, bodies)

    def against(self, wall: Material | str | None) -> Pair:
        """Return the pair with another wall, a material or "rigid"; None and pairs of balls are unchanged."""
        if wall is None or not self.is_wall:
            return self
        material = None if isinstance(wall, str) else wall
        if self.below.is_flat:
            return replace(self, below=replace(self.below, material=material))
        return replace(self, above=replace(self.above, material=material))
