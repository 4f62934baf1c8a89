"""What is filled into a cavity: material, size or distribution of sizes, and how much of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from rattlebox._util.narrow import present

from .base import Part
from .elementwise import Vector
from .errors import Hint, at
from .materials import AnyMaterial
from .packing import Crowd
from .units import SI, Number, PositiveLength, PositiveMass, Whole, parse, radius_of_diameter

MOST_PARTICLES = 100_000_000  # of one kind
_MANY = 4096  # sizes from which the mean volume is guessed


class Distribution(Part):
    """What all distributions of diameters share."""

    held_as: ClassVar[tuple[str, ...]] = ("distribution",)
    kind: str

    def diameters(self, share: Vector) -> Vector:
        """Return the diameters [m] below which these shares of the number of particles are, (n,)."""
        raise NotImplementedError


class _Bounded(Distribution):
    """A distribution between two sizes."""

    kind: str
    smallest: PositiveLength = Field(examples=["3 mm"])
    largest: PositiveLength = Field(examples=["6 mm"])

    @model_validator(mode="after")
    def _in_order(self) -> _Bounded:
        if self.smallest >= self.largest:
            raise Hint(f"must be larger than the smallest, {1e3 * self.smallest:.4g} mm", place=["largest"])
        return self

    def _between(self, share: Vector, low: float, high: float) -> Vector:
        """Quantiles of the standard normal distribution, cut off at two of them."""
        from scipy.special import ndtr, ndtri

        first, last = ndtr(low), ndtr(high)
        if not last - first > 1e-12:
            raise Hint("there is next to nothing of the distribution between smallest and largest", "a wider range")
        return np.clip(ndtri(first + share * (last - first)), low, high)


class NormalSizes(_Bounded):
    """Diameters normally distributed by number, cut off on both sides.

    Parameters
    ----------
    mean, deviation
        Mean and standard deviation of the diameter before it is cut off [m].
    smallest, largest
        Diameters between which all particles lie [m].
    """

    kind: Literal["normal"] = "normal"
    mean: PositiveLength = Field(examples=["4 mm"])
    deviation: PositiveLength = Field(examples=["0.5 mm"])

    def diameters(self, share: Vector) -> Vector:
        """Return quantiles of the diameter [m], (n,)."""
        low, high = ((size - self.mean) / self.deviation for size in (self.smallest, self.largest))
        return self.mean + self.deviation * self._between(share, low, high)


class LogNormal(_Bounded):
    """Diameters whose logarithms are normally distributed by number, cut off on both sides.

    Parameters
    ----------
    median
        Median of the diameter before it is cut off [m].
    geometric_standard_deviation
        Geometric standard deviation s, greater than 1: two thirds of the diameters lie between median / s and median x s.
    smallest, largest
        Diameters between which all particles lie [m].
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


def _lengths(value: Any) -> Any:
    sizes = []
    for index, item in enumerate(value if isinstance(value, (list, tuple, np.ndarray)) else [value]):
        with at(index):
            sizes.append(parse(item, ("m",))[0])
    return tuple(sizes)


class Sieve(Distribution):
    """Diameters by a sieve table, in which mass is spread evenly over the sizes between two sieves.

    Parameters
    ----------
    sizes
        Mesh sizes, increasing [m].
    passing
        Share of the mass that passes each of them, from 0 at the finest to 1 at the coarsest.
    """

    kind: Literal["sieve"] = "sieve"
    sizes: Annotated[tuple[float, ...], SI("m"), BeforeValidator(_lengths)] = Field(examples=[["3 mm", "4 mm", "6 mm"]])
    passing: tuple[Number, ...] = Field(examples=[[0, 0.4, 1]])

    @model_validator(mode="after")
    def _sound(self) -> Sieve:
        if len(self.sizes) != len(self.passing) or len(self.sizes) < 2:
            raise Hint(f"{len(self.sizes)} sizes, but {len(self.passing)} shares", "as many of both, at least two")
        if self.sizes[0] <= 0 or np.any(np.diff(self.sizes) <= 0):
            raise Hint("sizes must be above zero and increase", place=["sizes"])
        if self.passing[0] != 0 or self.passing[-1] != 1 or np.any(np.diff(self.passing) < 0):
            raise Hint("shares rise from 0 at the finest sieve to 1 at the coarsest", "[0, 0.3, 1]", ["passing"])
        return self

    def diameters(self, share: Vector) -> Vector:
        """Return quantiles of the diameter [m], (n,)."""
        edges = np.array(self.sizes)
        squares = edges**-2
        # mass evenly over the diameter: number goes with d^-3
        number = np.diff(self.passing) / np.diff(edges) * -np.diff(squares)
        below = np.concatenate([[0.0], np.cumsum(number)]) / number.sum()
        return np.asarray(np.interp(share, below, squares) ** -0.5)


AnyDistribution = Annotated[NormalSizes | LogNormal | Sieve, Field(discriminator="kind")]


class Particles(Part):
    """Spheres of one material.

    Parameters
    ----------
    material
        Name in the library, or a Material.
    radius, diameter, distribution
        One of them: one size for all [m], or a distribution of diameters.
    count, mass, fill_ratio
        One of them: how many, their mass in all [kg], or their volume over that of the cavity. Mass and fill ratio are met
        as closely as a whole number of particles can.
    name
        By which a table of pairs speaks of them; default the material's name.
    """

    held_as: ClassVar[tuple[str, ...]] = ("particles",)
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (
        ("radius", "diameter"),
        ("radius", "distribution"),
        ("diameter", "distribution"),
        ("count", "mass"),
        ("count", "fill_ratio"),
        ("mass", "fill_ratio"),
    )
    name: str = ""
    material: AnyMaterial = Field(examples=["steel"])
    radius: PositiveLength | None = None
    diameter: PositiveLength | None = Field(default=None, exclude=True)
    distribution: AnyDistribution | None = None
    count: Annotated[Whole, Field(ge=0, le=MOST_PARTICLES)] | None = None
    mass: PositiveMass | None = None
    fill_ratio: Number | None = None

    @model_validator(mode="before")
    @classmethod
    def _radius_of_diameter(cls, values: Any) -> Any:
        return radius_of_diameter(values)

    @model_validator(mode="after")
    def _sound(self) -> Particles:
        if self.radius is not None and self.distribution is not None:
            raise Hint("one size is needed: radius, diameter or distribution", 'radius = "2 mm"')
        amounts = [name for name in ("count", "mass", "fill_ratio") if getattr(self, name) is not None]
        if len(amounts) > 1:
            raise Hint(f"{amounts[0]} and {amounts[1]} say the same thing twice", "give one of them")
        if self.count == 0:
            raise Hint("there is nothing in it", "at least one particle", ["count"])
        if self.fill_ratio is not None and not 0 < self.fill_ratio < 1:
            raise Hint(
                "a fill ratio lies between 0 and 1: loose beds reach about 0.58, packed ones 0.64",
                "0.4",
                ["fill_ratio"],
            )
        if self.distribution is not None:
            with at("distribution"):
                self.diameters(1)
        return self

    @property
    def label(self) -> str:
        """Name of the species."""
        return self.name or self.material.name or "particles"

    @property
    def has_size(self) -> bool:
        """Whether a size is given; else positions must tell the radii."""
        return self.radius is not None or self.distribution is not None

    @property
    def has_amount(self) -> bool:
        """Whether it is given how much there is; else positions tell it."""
        return self.count is not None or self.mass is not None or self.fill_ratio is not None

    def diameters(self, count: int) -> Vector:
        """Return the diameters of so many particles, (n,) [m], rising: the middles of n equal shares of the distribution."""
        if self.distribution is None:
            return np.full(count, 2 * present(self.radius))
        return self.distribution.diameters((np.arange(count) + 0.5) / count)

    def number(self, volume: float) -> int:
        """Return how many particles there are in a cavity of a volume [m^3].

        Raises
        ------
        Hint
            When mass or fill ratio amount to less than one, or to more than a hundred million.
        """
        if self.count is not None:
            return self.count
        filled = self.mass / self.material.density if self.mass is not None else (self.fill_ratio or 0.0) * volume
        with at("mass" if self.mass is not None else "fill_ratio"):
            count = self._closest(filled)
            if count < 1:
                mass = self._volume(1) * self.material.density
                told = f"{mass:.4g} kg" if mass >= 1 else f"{1e3 * mass:.4g} g"
                raise Hint(
                    f"this is less than one particle of {told} and {1e3 * float(self.diameters(1)[0]):.4g} mm in diameter",
                    "more of them, or smaller ones",
                )
        return count

    def crowd(self, volume: float) -> Crowd:
        """Return about how many there are in a cavity of a volume [m^3], before any number is made for each of them."""
        some = self.diameters(1 if self.distribution is None else _MANY)
        each = float(np.mean(math.pi / 6 * some**3))
        if self.count is not None:
            count = self.count
        else:
            filled = self.mass / self.material.density if self.mass is not None else (self.fill_ratio or 0.0) * volume
            count = round(min(filled / each, 1e18))
        return Crowd(count, each, 0.5 * float(some.max()))

    def _volume(self, count: int) -> float:
        """The volume of so many [m^3]."""
        return float(np.sum(math.pi / 6 * self.diameters(count) ** 3))

    def _closest(self, filled: float) -> int:
        """How many have the volume that is closest to one [m^3]."""
        some = 1 if self.distribution is None else _MANY
        guess = filled * some / self._volume(some)
        if guess > MOST_PARTICLES:
            raise Hint(f"this is {guess:.3g} particles; {MOST_PARTICLES:.0e} at most", "less of them, or larger ones")
        if self.distribution is None:
            return round(guess)
        from scipy.optimize import brentq

        volume = cache(self._volume)  # rises with the number: of n + 1 quantiles each but the first is above one of n
        most = max(1, round(guess))
        while volume(most) < filled:
            most *= 2
        about = round(brentq(lambda count: volume(round(count)) - filled, 0, most, xtol=0.5))
        return min((max(about - 1, 0), about, about + 1), key=lambda count: abs(volume(count) - filled))


def as_species(value: Any) -> Any:
    """Let one stand for a list of one."""
    if isinstance(value, Sequence) and not isinstance(value, str):
        return tuple(value)
    return (value,)
