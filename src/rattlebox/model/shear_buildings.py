"""Shear buildings: rigid floors that move sideways."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from rattlebox._util.phrases import counted

from .elementwise import Vector
from .errors import Hint, several
from .modes import ModalModel
from .structures import DampedModes
from .units import PositiveMass, PositiveStiffness

if TYPE_CHECKING:
    from typing import Self


class ShearBuilding(DampedModes):
    r"""Shear building: floors that move along one line, each on the columns of the storey below it.

    Its points are the floors, "storey 1" to "storey n" from the ground up. It has all n modes.

    Parameters
    ----------
    masses
        Mass of the floor above each storey, from the ground up [kg].
    stiffnesses
        Lateral stiffness of each storey, from the ground up: the force between its floors for a drift of 1 m [N/m].

    Notes
    -----
    .. math:: m_i \ddot x_i + k_i (x_i - x_{i-1}) - k_{i+1} (x_{i+1} - x_i) = -m_i a

    with :math:`x_i` relative to the ground, which accelerates with :math:`a`. With equal masses and stiffnesses the angular
    frequencies are

    .. math:: \omega_j = 2 \sqrt{\frac{k}{m}} \sin\frac{(2 j - 1) \pi}{2 (2 n + 1)}, \qquad j = 1, \ldots, n

    References
    ----------
    A. K. Chopra (2017): Dynamics of Structures, 5th edition, Pearson, section 9.1, ISBN 978-0-13-455512-6.

    Examples
    --------
    >>> import rattlebox as rb
    >>> tower = rb.ShearBuilding(masses=["50 t"] * 3, stiffnesses=["60 MN/m"] * 3, damping_ratio=0.02)
    >>> tower.frequencies.round(3)
    array([2.454, 6.875, 9.935])
    """

    elementwise: ClassVar[bool] = False
    is_truncated: ClassVar[bool] = False
    kind: Literal["shear_building"] = "shear_building"
    masses: list[PositiveMass] = Field(examples=[["50 t", "50 t"]])
    stiffnesses: list[PositiveStiffness] = Field(examples=[["60 MN/m", "60 MN/m"]])

    @model_validator(mode="after")
    def _validate(self) -> Self:
        if not self.masses:
            raise Hint("at least one storey is needed", 'masses = ["50 t"]', ["masses"])
        if len(self.masses) != len(self.stiffnesses):
            raise Hint(
                f"{several(len(self.stiffnesses), 'number')}, but there are {several(len(self.masses), 'number')} in masses",
                "one of each for each storey",
                ["stiffnesses"],
            )
        self.modes()
        return self

    @property
    def frequencies(self) -> Vector:
        """Natural frequencies of the modes, (m,) [Hz]."""
        return np.sqrt(self.modes().stiffness) / (2 * math.pi)

    def words(self) -> str:
        """Return a phrase with the number of storeys and the first mode."""
        return self._with_first_mode(f"a building of {counted(len(self.masses), 'storey')}")

    def modes(self) -> ModalModel:
        """Compute the mass-normalised modes; the class has the equation."""
        from scipy.linalg import eigh_tridiagonal

        root, storeys = np.sqrt(np.array(self.masses)), np.array(self.stiffnesses)
        diagonal = (storeys + np.append(storeys[1:], 0.0)) / root**2
        solved = eigh_tridiagonal(diagonal, -storeys[1:] / (root[1:] * root[:-1]))
        squared, vectors = (np.asarray(each, dtype=np.float64) for each in solved)
        vectors = vectors * np.where(vectors[-1] < 0, -1.0, 1.0)
        zero = np.zeros(squared.size)
        return ModalModel(
            decay=self.decay_rates(squared),
            stiffness=squared,
            shapes={f"storey {k + 1}": vectors[k] / root[k] for k in range(root.size)},
            participation=root @ vectors,
            q0=zero,
            p0=zero,
            total_mass=float(root @ root),
        )
