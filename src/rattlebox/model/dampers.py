"""Impact dampers: balls in a row in a cavity."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import reduce
from operator import add
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from rattlebox._util.narrow import present

from .also_takes import AlsoTakes
from .base import Part
from .contacts import AnyContact
from .elementwise import Vector, power, stacked
from .errors import Hint, at, one_of
from .materials import AnyMaterial, AnyWall
from .signals import as_several
from .units import SI, Acceleration, NotNegativeLength, PositiveLength, PositiveMass, parse, text


class Sphere(Part):
    """A ball.

    Parameters
    ----------
    radius, diameter
        One of them [m].
    material
        Name in the library, or a Material.
    mass
        Instead of density times volume [kg].
    """

    held_as: ClassVar[tuple[str, ...]] = ("ball", "balls")
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("radius", "diameter"),)
    radius: PositiveLength | None = None
    diameter: PositiveLength | None = Field(default=None, exclude=True)
    material: AnyMaterial = Field(examples=["steel"])
    mass: PositiveMass | None = None

    @model_validator(mode="before")
    @classmethod
    def _one_size(cls, values: Any) -> Any:
        if isinstance(values, dict):
            one_of('radius = "10 mm"', radius=values.get("radius"), diameter=values.get("diameter"))
            if values.get("radius") is None:
                with at("diameter"):
                    diameter = parse(values["diameter"], ("m",))[0]
                rest = {key: value for key, value in values.items() if key != "diameter"}
                return {**rest, "radius": diameter / 2}
        return values

    @property
    def half(self) -> float:
        """Radius [m], whichever way the size was given."""
        return present(self.radius)

    @property
    def weight(self) -> float:
        """Mass [kg]."""
        if self.mass is not None:
            return self.mass
        volume: float = 4 / 3 * math.pi * power(self.half, 3)
        return volume * self.material.density


def _each(values: Sequence[Any], read: Callable[[Any], Any]) -> list[Any]:
    """Read a list; a complaint tells the number in it."""
    result = []
    for index, value in enumerate(values):
        with at(index):
            result.append(read(value))
    return result


def _are_several(value: Any) -> bool:
    """Tell a list from one quantity (number, unit)."""
    return isinstance(value, (list, tuple)) and not (
        len(value) == 2
        and isinstance(value[0], (int, float))
        and isinstance(value[1], str)
        and value[1].strip()[:1] not in tuple("+-.0123456789")
    )


def _place(value: Any) -> Any:
    return _each(value, _one_place) if _are_several(value) else _one_place(value)


def _one_place(value: Any) -> float | str:
    if isinstance(value, (bool, dict)) or _are_several(value):
        raise Hint("a fraction of the gap from -1 to 1 is needed, or a length", 'start = -1 or start = "0.1 mm"')
    if isinstance(value, (int, float)):
        return parse(value, ("m",))[0]
    length, unit = parse(value, ("m",))
    return length if unit is None else text(length, "m")


def _speeds(value: Any) -> Any:
    return tuple(_each(value if _are_several(value) else [value], lambda item: parse(item, ("m/s",))[0]))


class ImpactDamper(Part):
    """Balls in a row in a cavity that moves with a point of the structure.

    Parameters
    ----------
    ball, balls
        One Sphere or several, from the trailing to the leading wall.
    gap, cavity_length
        Clearance on each side when the row is packed and centred, or inner length of the cavity [m]; one of them.
    wall
        Material of the walls, "rigid", or None: the same as the ball beside.
    start
        Reduced position of each ball: fraction of the gap in [-1, 1] (-1 at the trailing, +1 at the leading wall), or
        a length. One number for the whole row packed together, or one for each ball, rising.
    velocity
        Of each ball at the start, relative to the base [m/s].
    contact, ball_contact
        Law of the walls, and of the balls among themselves; left out, the latter is the same.
    gravity
        Along the line, with sign [m/s^2].
    point
        Of the structure; not needed where there is one only.
    name
        What results and messages call it; "damper", "damper2", ... if left out.
    """

    held_as: ClassVar[tuple[str, ...]] = ("damper", "dampers")
    spellings: ClassVar[dict[str, str]] = {"ball": "balls"}
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("gap", "cavity_length"),)
    kind: Literal["impact"] = "impact"
    name: str = ""
    balls: Annotated[tuple[Sphere, ...], BeforeValidator(as_several), AlsoTakes()] = Field(
        examples=[{"radius": "10 mm", "material": "steel"}]
    )
    gap: NotNegativeLength | None = None
    cavity_length: PositiveLength | None = Field(default=None, exclude=True)
    wall: AnyWall | None = None
    start: Annotated[
        float | str | list[float | str],
        BeforeValidator(_place),
        WithJsonSchema({"description": "fraction of the gap from -1 to 1, or a length; one, or one for each ball"}),
    ] = 0.0
    velocity: Annotated[
        tuple[float, ...],
        SI("m/s"),
        BeforeValidator(_speeds),
        WithJsonSchema({"description": "velocity in m/s, or text with a unit; one, or one for each ball"}),
    ] = (0.0,)
    contact: AnyContact
    ball_contact: AnyContact | None = None
    gravity: Acceleration = 0.0
    point: str | None = None

    @model_validator(mode="before")
    @classmethod
    def _spellings(cls, values: Any) -> Any:
        if not isinstance(values, dict):
            return values
        values = cls.in_full(values)
        if values.get("gap") is not None and values.get("cavity_length") is not None:
            raise Hint("give gap or cavity_length, not both", 'gap = "0.4 mm"')
        return values

    @model_validator(mode="after")
    def _gap_of_cavity(self) -> ImpactDamper:
        one_of('gap = "0.4 mm"', gap=self.gap, cavity_length=self.cavity_length)
        if self.cavity_length is not None:
            row = self.row
            if self.cavity_length < row:
                raise Hint(
                    f"the balls alone are {row:.6g} m long",
                    f'cavity_length = "{1e3 * row * 1.01:.4g} mm"',
                    ["cavity_length"],
                )
            put = object.__setattr__
            put(self, "gap", (self.cavity_length - row) / 2)
            put(self, "cavity_length", None)  # equal to a damper that is given by its gap
        return self

    @model_validator(mode="after")
    def _row_fits(self) -> ImpactDamper:
        count = len(self.balls)
        if count == 0:
            raise Hint("a damper needs at least one ball", place=["balls"])
        if isinstance(self.start, list) and len(self.start) != count:
            raise Hint(f"{len(self.start)} positions, but there are {count} balls", "one for each ball", ["start"])
        if len(self.velocity) not in (1, count):
            raise Hint(
                f"{len(self.velocity)} velocities, but there are {count} balls", "one for each ball", ["velocity"]
            )
        places = self.positions0
        for i in range(count - 1):
            if places[i + 1] < places[i]:
                raise Hint(
                    f"balls {i + 1} and {i + 2} overlap by {1e3 * (places[i] - places[i + 1]):.4g} mm",
                    "a start that rises from ball to ball",
                    ["start"],
                )
        return self

    def label(self, index: int) -> str:
        """Return the damper's name, or one made from its number in the case."""
        return self.name or ("damper" if index == 0 else f"damper{index + 1}")

    @property
    def row(self) -> float:
        """Length of the balls side by side [m]."""
        return reduce(add, [2 * ball.half for ball in self.balls])

    @property
    def clearance(self) -> float:
        """Total clearance of the row, twice the gap [m]."""
        return 2 * present(self.gap)

    @property
    def masses(self) -> Vector:
        """Of the balls, (n,) [kg]."""
        return stacked([ball.weight for ball in self.balls])

    @property
    def centres(self) -> Vector:
        """Places of the ball centres from the cavity's centre in the packed, centred row, (n,) [m]."""
        radii = np.array([ball.half for ball in self.balls])
        edges = np.concatenate([[0.0], np.cumsum(2 * radii)])
        centres: Vector = edges[:-1] + radii - radii.sum()
        return centres

    @property
    def positions0(self) -> Vector:
        """Reduced start positions, (n,) [m]."""
        half = 0.5 * self.clearance
        places = self.start if isinstance(self.start, list) else [self.start] * len(self.balls)
        return stacked([parse(p, ("m",))[0] if isinstance(p, str) else p * half for p in places])

    @property
    def velocities0(self) -> Vector:
        """Start velocities, (n,) [m/s]."""
        speeds = self.velocity if len(self.velocity) > 1 else self.velocity * len(self.balls)
        return stacked(speeds)
