"""Simply supported rectangular plates with the exact modes of Kirchhoff's theory."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from rattlebox._util.narrow import present
from rattlebox._util.phrases import sizes

from .beams import NEGLECTED, ROUNDING, ModeCount
from .elementwise import Vector
from .errors import Hint
from .materials import AnyMaterial
from .modes import ModalModel
from .structures import DampedModes
from .units import Length, MassPerArea, PlateStiffness, PositiveLength

if TYPE_CHECKING:
    from typing import Self

Place = Annotated[tuple[Length, Length], Field(examples=[["0.1 m", "0.1 m"]])]


class Plate(DampedModes):
    r"""Thin rectangular plate in bending, simply supported on all edges, represented by its lowest modes.

    Its points move along one line, normal to the plate. The point "middle", the centre, is predefined.

    Parameters
    ----------
    length, width
        Edges a, along x, and b, along y [m].
    thickness, material
        Thickness h [m], and material of the plate.
    bending_stiffness, mass_per_area
        D [N m] and rho h [kg/m^2], in place of thickness and material, for example those of a sandwich.
    mode_count
        Number of modes, in the order of their frequencies.
    points
        Named points by their distances x and y from a corner [m].

    Notes
    -----
    The modes :math:`\sin(m \pi x / a) \sin(n \pi y / b)`, :math:`m, n = 1, 2, \ldots`, have the angular frequencies

    .. math::

        \omega = \pi^2 \left(\frac{m^2}{a^2} + \frac{n^2}{b^2}\right) \sqrt{\frac{D}{\rho h}}, \qquad
        D = \frac{E h^3}{12 (1 - \nu^2)}

    Edges do not deflect but rotate freely.

    Shear and rotary inertia lower the frequencies by about :math:`k^2 h^2 (1/12 + 1 / (5 (1 - \nu))) / 2`, with the wave
    number :math:`k^2 = \pi^2 (m^2 / a^2 + n^2 / b^2)`; a run has a warning if this exceeds 5 % and the thickness is known.

    References
    ----------
    A. W. Leissa (1969): Vibration of plates. NASA SP-160, chapter 4.

    R. D. Mindlin (1951): Influence of rotatory inertia and shear on flexural motions of isotropic, elastic plates. Journal
    of Applied Mechanics 18, 31-38, doi:10.1115/1.4010217.

    Examples
    --------
    >>> import rattlebox as rb
    >>> panel = rb.Plate(length="0.6 m", width="0.4 m", thickness="3 mm", material="aluminium", damping_ratio=0.005)
    >>> panel.frequencies.round(1)
    array([ 65.7, 126.4, 202.2, 227.5])
    """

    elementwise: ClassVar[bool] = False
    kind: Literal["plate"] = "plate"
    length: PositiveLength
    width: PositiveLength
    thickness: PositiveLength | None = None
    material: AnyMaterial | None = None
    bending_stiffness: PlateStiffness | None = None
    mass_per_area: MassPerArea | None = None
    mode_count: ModeCount = 4
    points: dict[str, Place] = Field(default_factory=dict, examples=[{"cavity": ["0.1 m", "0.1 m"]}])

    @model_validator(mode="after")
    def _validate(self) -> Self:
        of_material = [self.material, self.thickness]
        of_numbers = [self.bending_stiffness, self.mass_per_area]
        if any(of_material) == any(of_numbers) or None in (of_material if any(of_material) else of_numbers):
            raise Hint(
                "a plate needs a material and a thickness, or bending_stiffness and mass_per_area",
                'material = "aluminium", thickness = "3 mm"',
            )
        for name, (x, y) in self.points.items():
            if not (0 <= x <= self.length * (1 + ROUNDING) and 0 <= y <= self.width * (1 + ROUNDING)):
                raise Hint(
                    f"({x:g}, {y:g}) m is outside the plate of {self.length:g} m x {self.width:g} m",
                    "0 to its length, and 0 to its width",
                    ["points", name],
                )
        self.modes()
        return self

    @property
    def section(self) -> tuple[float, float]:
        """Bending stiffness D [N m] and mass per area rho h [kg/m^2]."""
        if self.material is None or self.thickness is None:
            return present(self.bending_stiffness), present(self.mass_per_area)
        return (
            self.material.young * self.thickness**3 / (12 * (1 - self.material.poisson**2)),
            self.material.density * self.thickness,
        )

    @property
    def frequencies(self) -> Vector:
        """Natural frequencies of the modes, (m,) [Hz]."""
        return np.sqrt(self.modes().stiffness) / (2 * math.pi)

    @property
    def half_waves(self) -> tuple[tuple[int, int], ...]:
        """Number of half waves of each mode along x and y, (m, n)."""
        # The lowest modes are among those with m n <= mode_count: any other has at least m n - 1 modes below it.
        count = self.mode_count
        pairs = [(m, n) for m in range(1, count + 1) for n in range(1, count // m + 1)]
        return tuple(sorted(pairs, key=lambda pair: (self._squared_wave_number(*pair), pair))[:count])

    def _squared_wave_number(self, m: int, n: int) -> float:
        return math.pi**2 * ((m / self.length) ** 2 + (n / self.width) ** 2)

    def words(self) -> str:
        """Return a phrase with material, lengths and first mode."""
        material = f"{self.material.words} " if self.material else ""
        lengths = sizes((self.length, self.width))
        return self._with_first_mode(f"a simply supported {material}plate of {lengths}")

    def modes(self) -> ModalModel:
        """Compute the lowest mass-normalised modes; the class has the equation."""
        stiffness, per_area = self.section
        pairs = np.array(self.half_waves)
        squared = stiffness / per_area * np.array([self._squared_wave_number(m, n) for m, n in self.half_waves]) ** 2
        mass = per_area * self.length * self.width
        places = {"middle": (self.length / 2, self.width / 2)} | self.points
        means = np.where(pairs % 2 == 1, 2 / (math.pi * pairs), 0.0)  # means of the half waves over the edges
        zero = np.zeros(len(pairs))
        return ModalModel(
            decay=self.decay_rates(squared),
            stiffness=squared,
            shapes={
                name: 2
                / math.sqrt(mass)
                * np.sin(math.pi * pairs[:, 0] * x / self.length)
                * np.sin(math.pi * pairs[:, 1] * y / self.width)
                for name, (x, y) in places.items()
            },
            participation=2 * math.sqrt(mass) * means[:, 0] * means[:, 1],
            q0=zero,
            p0=zero,
            total_mass=mass,
        )

    def warnings(self) -> Iterator[str]:
        """Yield a warning if shear and rotary inertia would change the frequency of a mode by more than 5 %."""
        if self.material is None or self.thickness is None:
            return
        for (m, n), frequency in zip(self.half_waves, self.frequencies, strict=True):
            factor = 1 / 12 + 1 / (5 * (1 - self.material.poisson))
            change = self._squared_wave_number(m, n) * self.thickness**2 * factor / 2
            if change > NEGLECTED:
                yield (
                    f"shear and rotary inertia, which the plate neglects, would lower the frequency of its mode ({m}, {n}),"
                    f" at {frequency:.4g} Hz, by about {100 * change:.2g} %; up to {100 * NEGLECTED:g} % is allowed; try:"
                    " fewer modes, or a finite element model"
                )
                return
