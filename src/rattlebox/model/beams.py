"""Uniform Euler-Bernoulli beams with their exact modes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from rattlebox._util.narrow import present
from rattlebox._util.quantities import amount

from .elementwise import Vector
from .errors import Hint, one_of
from .materials import AnyMaterial
from .modes import ModalModel
from .structures import DampedModes
from .units import BendingStiffness, Length, MassPerLength, NotNegativeMass, PositiveLength, Whole

if TYPE_CHECKING:
    from typing import Self

Ends = Literal["clamped-free", "clamped-clamped", "clamped-pinned", "pinned-pinned", "pinned-free", "free-free"]
ModeCount = Annotated[Whole, Field(ge=1, le=200)]

HEAVIEST = 1e9
"""Largest tip mass, in masses of the beam, for which the modes are accurate."""

ROUNDING = 1e-9
"""Tolerance for positions of points beyond the end, relative to the length."""

NEGLECTED = 0.05
"""Largest relative change of a natural frequency by shear and rotary inertia without a warning."""


class Beam(DampedModes):
    r"""Uniform Euler-Bernoulli beam in bending, represented by its lowest modes.

    Its points move along one line, perpendicular to the beam. The points "tip", the free second end (x = length), and
    "middle", at half the length, are predefined.

    Parameters
    ----------
    length
        Length L [m].
    ends
        First end (x = 0) and second end (x = L): "clamped-free", "clamped-clamped", "clamped-pinned", "pinned-pinned",
        "pinned-free" or "free-free".
    material
        Material of the beam; needs a cross-section.
    diameter, inner_diameter
        Diameters of a round bar or tube [m].
    width, height
        Edges of a rectangular cross-section [m]; the height is in the direction of the motion.
    bending_stiffness, mass_per_length
        E I [N m^2] and rho A [kg/m], in place of material and cross-section.
    tip_mass
        Mass of a point at the free second end [kg].
    mode_count
        Number of modes, including rigid-body modes: one for "pinned-free", two for "free-free".
    points
        Named points by their distance x from the first end [m].

    Notes
    -----
    The modes :math:`w(x) \sin(\omega t)` satisfy

    .. math:: E I w'''' = \omega^2 \rho A w

    with :math:`E I w''' = -\omega^2 m w` at the end with a tip mass :math:`m`. With :math:`z = \beta L`,
    :math:`\omega^2 = E I \beta^4 / (\rho A)` and :math:`\mu = m / (\rho A L)`, :math:`z` is a root of

    ===============  ======================================================================
    clamped-clamped  :math:`\cos z - \text{sech} z = 0`
    clamped-pinned   :math:`\sin z - \cos z \tanh z = 0`
    pinned-pinned    :math:`\sin z = 0`
    clamped-free     :math:`\cos z + \text{sech} z + \mu z (\cos z \tanh z - \sin z) = 0`
    pinned-free      :math:`\sin z - \cos z \tanh z + 2 \mu z \sin z \tanh z = 0`
    free-free        :math:`\cos z - \text{sech} z + \mu z (\cos z \tanh z - \sin z) = 0`
    ===============  ======================================================================

    Shear and rotary inertia lower the frequencies by about :math:`(\beta r)^2 (1 + E / (\kappa G)) / 2`, with the radius of
    gyration :math:`r` and the shear coefficient :math:`\kappa`; a run has a warning if this exceeds 5 % and the
    cross-section is known.

    References
    ----------
    S. S. Rao (2007): Vibration of Continuous Systems, Wiley, chapter 11, ISBN 978-0-471-77171-5.

    G. R. Cowper (1966): The shear coefficient in Timoshenko's beam theory. Journal of Applied Mechanics 33, 335-340,
    doi:10.1115/1.3625046.

    Examples
    --------
    >>> import rattlebox as rb
    >>> bar = rb.Beam(length="200 mm", material="steel", diameter="20 mm", tip_mass="50 g", damping_ratio=0.01)
    >>> bar.frequencies.round(1)
    array([  297.4,  1941.5,  5570.9, 11111.5])
    """

    elementwise: ClassVar[bool] = False
    kind: Literal["beam"] = "beam"
    length: PositiveLength
    ends: Ends = "clamped-free"
    material: AnyMaterial | None = None
    diameter: PositiveLength | None = None
    inner_diameter: PositiveLength | None = None
    width: PositiveLength | None = None
    height: PositiveLength | None = None
    bending_stiffness: BendingStiffness | None = None
    mass_per_length: MassPerLength | None = None
    tip_mass: NotNegativeMass = 0.0
    mode_count: ModeCount = 4
    points: dict[str, Length] = Field(default_factory=dict, examples=[{"cavity": "0.15 m"}])

    @model_validator(mode="after")
    def _validate(self) -> Self:
        if self.material is not None:
            if self.bending_stiffness is not None or self.mass_per_length is not None:
                raise Hint(
                    "a material excludes bending_stiffness and mass_per_length",
                    "material and cross-section, or bending_stiffness and mass_per_length",
                )
            one_of('diameter = "20 mm", or width and height', diameter=self.diameter, height=self.height)
            if self.height is not None and self.width is None:
                raise Hint("a rectangular cross-section needs a width", 'width = "30 mm"', ["width"])
            if self.inner_diameter is not None and not self.inner_diameter < (self.diameter or 0.0):
                raise Hint("must be less than the diameter", "the diameter of the bore", ["inner_diameter"])
        else:
            if self.bending_stiffness is None or self.mass_per_length is None:
                raise Hint(
                    "a beam needs a material and a cross-section, or bending_stiffness and mass_per_length",
                    'material = "steel", diameter = "20 mm"',
                )
            for name in ("diameter", "inner_diameter", "width", "height"):
                if getattr(self, name) is not None:
                    raise Hint("a cross-section needs a material", 'material = "steel"', [name])
        if self.tip_mass > HEAVIEST * self.section[1] * self.length:
            raise Hint(
                f"is more than {HEAVIEST:g} times the mass of the beam",
                "SDOF, with the stiffness of the beam",
                ["tip_mass"],
            )
        if self.tip_mass and not self.ends.endswith("free"):
            raise Hint(f"a {self.ends} beam has no free second end", 'ends = "clamped-free"', ["tip_mass"])
        for name, x in self.points.items():
            if not 0 <= x <= self.length * (1 + ROUNDING):
                raise Hint(
                    f"{x:g} m is outside the beam, which is {self.length:g} m long", "0 to its length", ["points", name]
                )
        self.modes()
        return self

    @property
    def section(self) -> tuple[float, float]:
        """Bending stiffness E I [N m^2] and mass per length rho A [kg/m]."""
        if self.material is None:
            return present(self.bending_stiffness), present(self.mass_per_length)
        area, inertia = self._area_and_inertia()
        return self.material.young * inertia, self.material.density * area

    def _area_and_inertia(self) -> tuple[float, float]:
        if self.diameter is not None:
            inner = self.inner_diameter or 0.0
            return math.pi / 4 * (self.diameter**2 - inner**2), math.pi / 64 * (self.diameter**4 - inner**4)
        width, height = present(self.width), present(self.height)
        return width * height, width * height**3 / 12

    @property
    def frequencies(self) -> Vector:
        """Natural frequencies of the modes, (m,) [Hz]."""
        return np.sqrt(self.modes().stiffness) / (2 * math.pi)

    def words(self) -> str:
        """Return a phrase with ends, material, length and first mode."""
        material = f"{self.material.words} " if self.material else ""
        return self._with_first_mode(f"a {self.ends} {material}beam of {amount(self.length, 'm')}")

    def modes(self) -> ModalModel:
        """Compute the lowest mass-normalised modes; the class has the equation."""
        stiffness, per_length = self.section
        mass = per_length * self.length
        mu = self.tip_mass / mass
        shapes = _rigid_shapes(self.ends, mu)[: self.mode_count]
        roots = np.zeros(len(shapes))
        if len(shapes) < self.mode_count:
            elastic = wave_numbers(self.ends, self.mode_count - len(shapes), mu)
            roots = np.concatenate([roots, elastic])
            shapes = [*shapes, *(_shape(self.ends, z) for z in elastic)]
        places = {"tip": self.length} if self.ends.endswith("free") else {}
        places |= {"middle": self.length / 2} | self.points
        x, weight = np.polynomial.legendre.leggauss(40 + 2 * int(roots[-1]))
        x, weight = (1 + x) / 2, weight / 2
        rows = np.array(
            [shape(np.array([*x, 1.0, *(place / self.length for place in places.values())])) for shape in shapes]
        )
        inside, tip, at_points = rows[:, : x.size], rows[:, x.size], rows[:, x.size + 1 :]
        norm = np.sqrt(mass * (inside**2 @ weight + mu * tip**2))
        squared = roots**4 * stiffness / (per_length * self.length**4)
        zero = np.zeros(roots.size)
        return ModalModel(
            decay=self.decay_rates(squared),
            stiffness=squared,
            shapes={name: at_points[:, k] / norm for k, name in enumerate(places)},
            participation=mass * (inside @ weight + mu * tip) / norm,
            q0=zero,
            p0=zero,
            total_mass=mass * (1 + mu),
        )

    def warnings(self) -> Iterator[str]:
        """Yield a warning if shear and rotary inertia would change the frequency of a mode by more than 5 %."""
        if self.material is None:
            return
        area, inertia = self._area_and_inertia()
        nu = self.material.poisson
        if self.diameter is None:
            kappa = 10 * (1 + nu) / (12 + 11 * nu)
        else:
            m = ((self.inner_diameter or 0.0) / self.diameter) ** 2
            kappa = 6 * (1 + nu) * (1 + m) ** 2 / ((7 + 6 * nu) * (1 + m) ** 2 + (20 + 12 * nu) * m)
        stiffness, per_length = self.section
        squared = np.sqrt(self.modes().stiffness * per_length / stiffness)  # beta^2
        change = squared * inertia / area * (1 + 2 * (1 + nu) / kappa) / 2
        if (change > NEGLECTED).any():
            first = int(np.argmax(change > NEGLECTED))
            advice = f"mode_count = {first}" if first else "a finite element model"
            yield (
                f"shear and rotary inertia, which the beam neglects, would lower the frequency of its mode {first + 1}, at"
                f" {self.frequencies[first]:.4g} Hz, by about {100 * change[first]:.2g} %; up to {100 * NEGLECTED:g} % is"
                f" allowed; try: {advice}"
            )


def wave_numbers(ends: Ends, count: int, mu: float = 0.0) -> Vector:
    """Compute the dimensionless wave numbers beta L of the lowest elastic modes of a beam.

    Returns wave numbers, ascending, to rounding, (count,).

    Notes
    -----
    They are the roots z of the characteristic equations, of which `Beam` has a table and the source. A mass at an end lowers
    each root, at most to that of a beam that is pinned at this end: both limits bracket it.
    """
    free = np.array([_root(ends, 0.0, *_bracket(ends, n)) for n in range(1, count + 1)])
    if mu == 0:
        return free
    # A mass at an end lowers each frequency; the limit is that of a beam pinned there.
    if ends == "clamped-free":
        pinned = [0.0, *wave_numbers("clamped-pinned", count, 0.0)]
    else:
        pinned = list(wave_numbers("pinned-pinned" if ends == "pinned-free" else "pinned-free", count, 0.0))
    margin = 1e-12  # for the rounding of the ends of the intervals
    return np.array(
        [_root(ends, mu, low * (1 - margin), high * (1 + margin)) for low, high in zip(pinned, free, strict=False)]
    )


def _bracket(ends: str, n: int) -> tuple[float, float]:
    """Return an interval that contains the n-th elastic root (n from 1) without tip mass."""
    if ends == "pinned-pinned":
        return (n - 0.5) * math.pi, (n + 0.5) * math.pi
    if ends == "clamped-free":
        return (n - 1) * math.pi, n * math.pi
    return n * math.pi, (n + 1) * math.pi if ends in ("clamped-clamped", "free-free") else (n + 0.5) * math.pi


def _root(ends: str, mu: float, low: float, high: float) -> float:
    from scipy.optimize import brentq

    def characteristic(z: float) -> float:
        cos, sin, tanh, sech = math.cos(z), math.sin(z), math.tanh(z), 1 / math.cosh(min(z, 700.0))
        if ends == "pinned-pinned":
            return sin
        if ends in ("clamped-pinned", "pinned-free"):
            return sin - cos * tanh + 2 * mu * z * sin * tanh
        sign = 1.0 if ends == "clamped-free" else -1.0
        return cos + sign * sech + mu * z * (cos * tanh - sin)

    return float(brentq(characteristic, low, high, xtol=1e-15, rtol=4 * np.finfo(float).eps, maxiter=200))


def _rigid_shapes(ends: Ends, mu: float) -> list[Callable[[Vector], Vector]]:
    """Return the orthogonal rigid-body shapes as functions of x / L."""
    if ends == "pinned-free":
        return [np.array]
    if ends == "free-free":
        centre = (0.5 + mu) / (1 + mu)
        return [np.ones_like, lambda x: np.asarray(x - centre)]
    return []


def _shape(ends: Ends, z: float) -> Callable[[Vector], Vector]:
    """Return the shape of an elastic mode as a function of x / L, in a form without differences of large numbers."""
    if ends == "pinned-pinned":
        return lambda x: np.sin(z * x)
    decayed, sin, cos = math.exp(-z), math.sin(z), math.cos(z)
    if ends == "pinned-free":  # sin(z x) + sin(z) sinh(z x) / sinh(z)
        return lambda x: np.sin(z * x) + sin * (np.exp(z * (x - 1)) - np.exp(-z * (x + 1))) / (1 - decayed**2)
    # cosh(z x) + s cos(z x) - sigma (sinh(z x) + s sin(z x)), s = -1 of a clamped and 1 of a free first end, and
    # sigma = (cosh z + g cos z) / (sinh z + g sin z)
    s = 1.0 if ends == "free-free" else -1.0
    g = 1.0 if ends == "clamped-free" else -1.0
    below = 1 - decayed**2 + 2 * g * decayed * sin
    sigma = (1 + decayed**2 + 2 * g * decayed * cos) / below
    growing = (g * (sin - cos) - decayed) / below
    return lambda x: np.asarray(
        growing * np.exp(z * (x - 1)) + (1 + sigma) / 2 * np.exp(-z * x) + s * (np.cos(z * x) - sigma * np.sin(z * x))
    )
