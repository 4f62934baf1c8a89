"""Particles of one species: material, size or distribution of sizes, and amount."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from functools import cache
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from rattlebox._util.narrow import present

from .base import Part
from .crowds import COMPACTED, Crowd
from .elementwise import Vector
from .errors import Hint, at
from .kinds import AnyKind
from .materials import AnyMaterial
from .units import SI, Number, PositiveLength, PositiveMass, Whole, parse, radius_of_diameter

MAX_PARTICLES = 100_000_000  # of one kind
_AMOUNTS = ("count", "mass", "fill_ratio", "bed_fill")
_MANY = 4096  # sizes from which the mean volume is estimated


class Distribution(Part):
    """Base class of distributions of diameters."""

    field_names: ClassVar[tuple[str, ...]] = ("distribution",)
    kinds: ClassVar[dict[str, type[Part]]] = {}
    kind: str

    @abstractmethod
    def diameters(self, share: Vector) -> Vector:
        """Return quantiles of the diameter by number [m], (n,), for shares of the number of particles."""


class _Bounded(Distribution):
    """A distribution between two sizes."""

    kind: str
    smallest: PositiveLength = Field(examples=["3 mm"])
    largest: PositiveLength = Field(examples=["6 mm"])

    @model_validator(mode="after")
    def _in_order(self) -> _Bounded:
        if self.smallest >= self.largest:
            raise Hint(
                f"must be larger than the smallest, {1e3 * self.smallest:.4g} mm",
                "particles of one diameter, or a larger value",
                ["largest"],
            )
        return self

    def _between(self, share: Vector, low: float, high: float) -> Vector:
        """Return quantiles of the standard normal distribution, truncated at `low` and `high`."""
        from scipy.special import ndtr, ndtri

        first, last = ndtr(low), ndtr(high)
        if not last - first > 1e-12:
            raise Hint("the distribution is zero between smallest and largest", "a range around its mean or median")
        return np.clip(ndtri(first + share * (last - first)), low, high)


class NormalSizes(_Bounded):
    r"""Normal distribution of diameters by number, truncated on both sides.

    Parameters
    ----------
    mean, deviation
        Mean and standard deviation of the diameter before truncation [m].
    smallest, largest
        Smallest and largest diameter [m].

    Notes
    -----
    The density is proportional to :math:`\exp(-(d - \mu)^2 / (2 \sigma^2))` between the smallest and the largest diameter
    :math:`d`, with mean :math:`\mu` and deviation :math:`\sigma`, and 0 outside.
    """

    kind: Literal["normal"] = "normal"
    mean: PositiveLength = Field(examples=["4 mm"])
    deviation: PositiveLength = Field(examples=["0.5 mm"])

    def diameters(self, share: Vector) -> Vector:
        """Return quantiles of the diameter [m], (n,)."""
        low, high = ((size - self.mean) / self.deviation for size in (self.smallest, self.largest))
        return self.mean + self.deviation * self._between(share, low, high)


class LogNormal(_Bounded):
    r"""Log-normal distribution of diameters by number, truncated on both sides.

    Parameters
    ----------
    median
        Median of the diameter before truncation [m].
    geometric_standard_deviation
        Geometric standard deviation s, greater than 1: two thirds of the diameters lie between median / s and median x s.
    smallest, largest
        Smallest and largest diameter [m].

    Notes
    -----
    The density of :math:`\ln d` is proportional to :math:`\exp(-(\ln(d / m) / \ln s)^2 / 2)` between the smallest and the
    largest diameter :math:`d`, with median :math:`m` and geometric standard deviation :math:`s`, and 0 outside.
    """

    kind: Literal["log_normal"] = "log_normal"
    median: PositiveLength = Field(examples=["4 mm"])
    geometric_standard_deviation: Annotated[Number, Field(le=100, examples=[1.2])]

    @model_validator(mode="after")
    def _has_width(self) -> LogNormal:
        if not self.geometric_standard_deviation > 1:
            raise Hint("must be greater than 1", "1.2", ["geometric_standard_deviation"])
        return self

    def diameters(self, share: Vector) -> Vector:
        """Return quantiles of the diameter [m], (n,)."""
        width = math.log(self.geometric_standard_deviation)
        low, high = (math.log(size / self.median) / width for size in (self.smallest, self.largest))
        return self.median * np.exp(width * self._between(share, low, high))


def _lengths(value: object) -> Any:
    sizes = []
    for index, item in enumerate(value if isinstance(value, (list, tuple, np.ndarray)) else [value]):
        with at(index):
            sizes.append(parse(item, ("m",))[0])
    return tuple(sizes)


class Sieve(Distribution):
    """Distribution of diameters from a sieve table, with mass evenly distributed over the sizes between two sieves.

    Parameters
    ----------
    sizes
        Mesh sizes, increasing [m].
    passing
        Share of the mass that passes each of them, from 0 at the finest to 1 at the coarsest.

    Notes
    -----
    Between two sieves the number of particles of diameter d is proportional to d^-3.
    """

    kind: Literal["sieve"] = "sieve"
    sizes: Annotated[tuple[float, ...], SI("m"), BeforeValidator(_lengths)] = Field(examples=[["3 mm", "4 mm", "6 mm"]])
    passing: tuple[Number, ...] = Field(examples=[[0, 0.4, 1]])

    @model_validator(mode="after")
    def _validate(self) -> Sieve:
        if len(self.sizes) != len(self.passing) or len(self.sizes) < 2:
            raise Hint(f"{len(self.sizes)} sizes, but {len(self.passing)} shares", "as many of both, at least two")
        if self.sizes[0] <= 0 or np.any(np.diff(self.sizes) <= 0):
            raise Hint("sizes must be greater than zero and increase", '["3 mm", "4 mm", "6 mm"]', ["sizes"])
        if self.passing[0] != 0 or self.passing[-1] != 1 or np.any(np.diff(self.passing) < 0):
            raise Hint("shares rise from 0 at the finest sieve to 1 at the coarsest", "[0, 0.3, 1]", ["passing"])
        return self

    def diameters(self, share: Vector) -> Vector:
        """Return quantiles of the diameter [m], (n,)."""
        edges = np.array(self.sizes)
        squares = edges**-2
        # Mass is even over the diameter, so that number is proportional to d^-3.
        number = np.diff(self.passing) / np.diff(edges) * -np.diff(squares)
        below = np.concatenate([[0.0], np.cumsum(number)]) / number.sum()
        return np.asarray(np.interp(share, below, squares) ** -0.5)


AnyDistribution = Annotated[Distribution, AnyKind()]


class Particles(Part):
    """Spheres of one material.

    Parameters
    ----------
    material
        Name of a material in the library, or a Material.
    radius, diameter, distribution
        One of them: the size of all particles [m], or a distribution of diameters.
    count, mass, fill_ratio, bed_fill
        One of them: number of particles; total mass [kg]; volume of the particles over that of the cavity; or volume of
        their bed, with the voids in it, over that of the cavity, 1 for a full cavity. All are rounded to a whole number of
        particles. The number for a `bed_fill` follows from the usual density of such a bed, and the bed differs by some
        percent; `rb.measure_bed` measures it.
    name
        Name of the species in `pairs`; default that of the material.

    Examples
    --------
    >>> import rattlebox as rb
    >>> rb.Particles(material="steel", diameter="4 mm", mass="100 g").number(volume=1e-3)
    380
    """

    field_names: ClassVar[tuple[str, ...]] = ("particles",)
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (
        ("radius", "diameter"),
        ("radius", "distribution"),
        ("diameter", "distribution"),
        ("count", "mass"),
        ("count", "fill_ratio"),
        ("mass", "fill_ratio"),
        ("count", "bed_fill"),
        ("mass", "bed_fill"),
        ("fill_ratio", "bed_fill"),
    )
    name: str = ""
    material: AnyMaterial = Field(examples=["steel"])
    radius: PositiveLength | None = None
    diameter: PositiveLength | None = Field(default=None, exclude=True)
    distribution: AnyDistribution | None = None
    count: Annotated[Whole, Field(ge=0, le=MAX_PARTICLES)] | None = None
    mass: PositiveMass | None = None
    fill_ratio: Number | None = None
    bed_fill: Annotated[Number, Field(examples=[0.9])] | None = None

    @model_validator(mode="before")
    @classmethod
    def _radius_of_diameter(cls, values: object) -> Any:
        given = values if isinstance(values, dict) else {}
        for size in ("radius", "diameter"):
            if isinstance(given.get(size), (dict, Distribution)):
                raise Hint(
                    "sizes that differ are a distribution, which has its own field", "distribution = ...", [size]
                )
        return radius_of_diameter(values)

    @model_validator(mode="after")
    def _validate(self) -> Particles:
        if self.radius is not None and self.distribution is not None:
            raise Hint("one size is needed: radius, diameter or distribution", 'radius = "2 mm"')
        amounts = self.amounts
        if len(amounts) > 1:
            raise Hint(f"{amounts[0]} and {amounts[1]} exclude each other", "give one of them")
        if self.count == 0:
            raise Hint("must be at least one", "at least one particle", ["count"])
        if self.fill_ratio is not None and not 0 < self.fill_ratio < 1:
            raise Hint(
                "a fill ratio lies between 0 and 1: loose beds reach about 0.58, packed ones 0.64",
                "0.4",
                ["fill_ratio"],
            )
        if self.bed_fill is not None and not 0 < self.bed_fill <= 1:
            raise Hint("a bed fill must be greater than 0 and at most 1, a full cavity", "0.9", ["bed_fill"])
        if self.distribution is not None:
            with at("distribution"):
                self.diameters(1)
        return self

    @property
    def amounts(self) -> list[str]:
        """Names of the given ones of count, mass, fill ratio and bed fill."""
        return [name for name in _AMOUNTS if getattr(self, name) is not None]

    @property
    def label(self) -> str:
        """Name of the species."""
        return self.name or self.material.name or "particles"

    @property
    def has_size(self) -> bool:
        """Whether a size is given; otherwise the packing needs radii."""
        return self.radius is not None or self.distribution is not None

    @property
    def has_amount(self) -> bool:
        """Whether an amount is given; otherwise the packing needs positions."""
        return bool(self.amounts)

    def diameters(self, count: int) -> Vector:
        """Return the diameters of n particles, (n,) [m], ascending: the medians of n equal shares of the distribution."""
        if self.distribution is None:
            return np.full(count, 2 * present(self.radius))
        return self.distribution.diameters((np.arange(count) + 0.5) / count)

    @property
    def mean_diameter(self) -> float:
        """Mean diameter by surface, sum(d^3) / sum(d^2) [m]."""
        some = self.diameters(1 if self.distribution is None else _MANY)
        return float(np.sum(some**3) / np.sum(some**2))

    def number(self, volume: float, density: float = COMPACTED) -> int:
        """Return the number of particles in a cavity.

        Parameters
        ----------
        volume
            Volume of the cavity [m^3].
        density
            Volume of the particles over that of their bed, for a `bed_fill`.

        Raises
        ------
        Hint
            If the amount is less than one particle, or more than a hundred million.
        """
        if self.count is not None:
            return self.count
        filled = self._filled(volume, density)
        with at(*self.amounts):
            count = self._closest(filled)
            if self.bed_fill is not None and self._volume(count) > filled * (1 + 1e-9):
                count = max(1, count - 1) if count else 0  # A full cavity may not hold one more.
            if count < 1:
                mass = self._volume(1) * self.material.density
                weight = f"{mass:.4g} kg" if mass >= 1 else f"{1e3 * mass:.4g} g"
                raise Hint(
                    f"this is less than one particle of {weight} and {1e3 * float(self.diameters(1)[0]):.4g} mm in diameter",
                    "more of them, or smaller ones",
                )
        return count

    def _filled(self, volume: float, density: float) -> float:
        """Return the volume of the particles [m^3]; see `number`."""
        if self.mass is not None:
            return self.mass / self.material.density
        return (self.fill_ratio or (self.bed_fill or 0.0) * density) * volume

    def crowd(self, volume: float, density: float = COMPACTED) -> Crowd:
        """Return a summary of the particles, without arrays, with an approximate count; see `number`."""
        some = self.diameters(1 if self.distribution is None else _MANY)
        each = float(np.mean(math.pi / 6 * some**3))
        count = round(min(self._filled(volume, density) / each, 1e18)) if self.count is None else self.count
        return Crowd(count, each, 0.5 * float(some.max()))

    def _volume(self, count: int) -> float:
        """Return the volume of this number of particles [m^3]."""
        return float(np.sum(math.pi / 6 * self.diameters(count) ** 3))

    def _closest(self, filled: float) -> int:
        """Return the number of particles whose volume is closest to a volume [m^3]."""
        some = 1 if self.distribution is None else _MANY
        guess = filled * some / self._volume(some)
        if guess > MAX_PARTICLES:
            raise Hint(
                f"this is {guess:.3g} particles; at most {MAX_PARTICLES:.0e} are allowed",
                "fewer of them, or larger ones",
            )
        if self.distribution is None:
            return round(guess)
        from scipy.optimize import brentq

        # The volume increases with the number: each of n + 1 quantiles but the first exceeds one of n.
        volume = cache(self._volume)
        most = max(1, round(guess))
        while volume(most) < filled:
            most *= 2
        about = round(brentq(lambda count: volume(round(count)) - filled, 0, most, xtol=0.5))
        return min((max(about - 1, 0), about, about + 1), key=lambda count: abs(volume(count) - filled))


def as_species(value: object) -> Any:
    """Return a tuple of species; a single one becomes a tuple of one."""
    if isinstance(value, Sequence) and not isinstance(value, str):
        return tuple(value)
    return (value,)
