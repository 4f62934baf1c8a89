"""Impact dampers: balls in a row in a cavity."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import reduce
from itertools import pairwise
from operator import add
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import (
    BeforeValidator,
    Discriminator,
    Field,
    GetJsonSchemaHandler,
    Tag,
    TypeAdapter,
    WithJsonSchema,
    model_validator,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from rattlebox._util.frozen import complete
from rattlebox._util.narrow import present
from rattlebox._util.phrases import joined, with_article
from rattlebox._util.quantities import amount

from .also_accepts import AlsoAccepts
from .base import Part
from .cavities import Box
from .contacts import AnyContact
from .damper_base import Damper
from .elementwise import Vector, power, stacked
from .errors import Hint, at, one_of
from .materials import AnyMaterial, AnyWall
from .packing import Positions
from .pairs import Body, Pair
from .particle_damper import MAX_DAMPERS, ParticleDamper
from .particles import Particles
from .signals import as_several
from .space import Accelerations, unit_vector
from .units import (
    SI,
    STANDARD_GRAVITY,
    Acceleration,
    NotNegativeLength,
    PositiveLength,
    PositiveMass,
    Whole,
    parse,
    radius_of_diameter,
    text,
)

_PLAY = 1e-3
"""Room for a ball across its line, over its diameter, in the 3-D engine."""
_GOLDEN = (math.sqrt(5) - 1) / 2
"""The fractional parts of its multiples are evenly spread, for any number of them."""


class Sphere(Part):
    """A ball of an impact damper.

    Parameters
    ----------
    radius, diameter
        One of them [m].
    material
        Name of a material in the library, or a Material.
    mass
        Mass [kg]; default density times volume.

    Examples
    --------
    >>> import rattlebox as rb
    >>> ball = rb.Sphere(diameter="20 mm", material="steel")
    >>> print(f"{1e3 * ball.weight:.1f} g")
    32.9 g
    """

    field_names: ClassVar[tuple[str, ...]] = ("ball", "balls")
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("radius", "diameter"),)
    radius: PositiveLength | None = None
    diameter: PositiveLength | None = Field(default=None, exclude=True)
    material: AnyMaterial = Field(examples=["steel"])
    mass: PositiveMass | None = None

    @model_validator(mode="before")
    @classmethod
    def _one_size(cls, values: object) -> Any:
        if isinstance(values, dict):
            one_of('radius = "10 mm"', radius=values.get("radius"), diameter=values.get("diameter"))
        return radius_of_diameter(values)

    noun: ClassVar[str] = "ball"

    @property
    def half(self) -> float:
        """Half of the length along the line: the radius [m]."""
        return present(self.radius)

    @property
    def curvature(self) -> float:
        """Radius of the surface in contact [m]."""
        return present(self.radius)

    def half_of(self, radius: Any) -> Any:
        """Return the half length of the body with another radius [m]."""
        return radius

    @property
    def weight(self) -> float:
        """Mass [kg]."""
        if self.mass is not None:
            return self.mass
        volume: float = 4 / 3 * math.pi * power(self.half, 3)
        return volume * self.material.density


class Striker(Sphere):
    """Rigid body of an impact damper, given by its mass: a slug, a weight on rollers, a pounding mass.

    Only its mass and its contacts count, not its length: it moves along the line by the gap on each side.

    Parameters
    ----------
    mass
        Mass [kg].
    radius, diameter
        Radius or diameter of curvature of its ends, for laws that take the stiffness of a contact from the shape and the
        material of the bodies [m]. Laws with a contact time or a stiffness of their own, and hard impacts, need none.
    material
        Material of its ends, for the same laws.

    Examples
    --------
    >>> import rattlebox as rb
    >>> pads = rb.Linear(contact_time="10 ms", restitution=0.5)
    >>> rb.ImpactDamper(ball=rb.Striker(mass="12 t"), gap="0.2 m", contact=pads).words()
    'a striker of 12 t with 400 mm of clearance'
    """

    kind: Literal["striker"] = "striker"
    mass: PositiveMass = Field(examples=["12 t"])
    material: AnyMaterial = Field(default="steel", validate_default=True, examples=["steel"])
    noun: ClassVar[str] = "striker"

    @model_validator(mode="before")
    @classmethod
    def _one_size(cls, values: object) -> Any:
        return radius_of_diameter(values)

    @classmethod
    def __get_pydantic_json_schema__(cls, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        schema = super().__get_pydantic_json_schema__(core, handler)
        content = handler.resolve_ref_schema(schema)
        content["required"] = ["kind", *content.get("required", [])]  # a table without a kind is a sphere
        return schema

    @property
    def half(self) -> float:
        """Zero: the length of the body does not count [m]."""
        return 0.0

    @property
    def curvature(self) -> float:
        """Radius of its ends [m]; NaN if it has none."""
        return math.nan if self.radius is None else self.radius

    def half_of(self, radius: Any) -> Any:
        """Return the half length of the body with another radius [m]: zero."""
        return 0.0 * radius


def _kind_of_ball(value: object) -> str:
    """Return the kind of a ball; one without a kind is a sphere."""
    kind = value.get("kind") if isinstance(value, dict) else getattr(value, "kind", None)
    return "striker" if kind == "striker" else "sphere"


AnyBall = Annotated[Annotated[Sphere, Tag("sphere")] | Annotated[Striker, Tag("striker")], Discriminator(_kind_of_ball)]


def _each(values: Sequence[object], read: Callable[[Any], Any]) -> list[Any]:
    """Read each item of a list; an error names the index of the item."""
    result = []
    for index, value in enumerate(values):
        with at(index):
            result.append(read(value))
    return result


def _are_several(value: object) -> bool:
    """Return whether a value is a list, as opposed to one quantity (number, unit)."""
    return isinstance(value, (list, tuple)) and not (
        len(value) == 2
        and isinstance(value[0], (int, float))
        and isinstance(value[1], str)
        and value[1].strip()[:1] not in tuple("+-.0123456789")
    )


def _place(value: Any) -> Any:
    return _each(value, _one_place) if _are_several(value) else _one_place(value)


def _one_place(value: object) -> float | str:
    if isinstance(value, (bool, dict)) or _are_several(value):
        raise Hint("a fraction of the gap from -1 to 1 is needed, or a length", 'start = -1 or start = "0.1 mm"')
    if isinstance(value, (int, float)):
        return parse(value, ("m",))[0]
    length, unit = parse(value, ("m",))
    return length if unit is None else text(length, "m")


def _speeds(value: Any) -> Any:
    return tuple(_each(value if _are_several(value) else [value], lambda item: parse(item, ("m/s",))[0]))


class ImpactDamper(Damper):
    """Balls on a line in a cavity that moves with a point of the structure.

    Parameters
    ----------
    ball, balls
        One Sphere or Striker, or several, from the trailing to the leading wall.
    gap, cavity_length
        Clearance on each side when the row is packed and centred, or inner length of the cavity [m]; one of them.
    wall
        Material of the walls, or "rigid"; default that of the adjacent ball.
    start
        Reduced position of each ball in the cavity at t = 0, wherever the structure then is: fraction of the gap in [-1, 1]
        (-1 at the trailing, +1 at the leading wall), or a length from the centre. One number for a row of balls in contact,
        or one for each ball, ascending.
    velocity
        Initial velocity of the balls, relative to the base [m/s]; one for all, or one for each.
    contact, ball_contact
        Contact laws between balls and walls, and between balls; the default of the second is the first.
    gravity
        Component of gravity along the line [m/s^2].
    point
        Point of the structure; needed if there are several.
    number
        Number of identical dampers at the point. The first has the given start, the others start at other places between
        the walls, evenly spread: with the same start all would move in step, like one heavier damper.
    name
        Name in results and messages; default "damper", "damper2", ...

    Examples
    --------
    >>> import rattlebox as rb
    >>> ball = rb.Sphere(diameter="20 mm", material="steel")
    >>> damper = rb.ImpactDamper(ball=ball, gap="0.4 mm", contact=rb.Tsuji(restitution=0.9))
    >>> damper.clearance
    0.0008
    """

    aliases: ClassVar[dict[str, str]] = {"ball": "balls"}
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("gap", "cavity_length"),)
    kind: Literal["impact"] = "impact"
    name: str = ""
    balls: Annotated[tuple[AnyBall, ...], BeforeValidator(as_several), AlsoAccepts()] = Field(
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
    number: Annotated[Whole, Field(ge=1, le=MAX_DAMPERS)] = 1

    @model_validator(mode="before")
    @classmethod
    def _expand_aliases(cls, values: object) -> Any:
        if not isinstance(values, dict):
            return values
        values = cls.expand_aliases(values)
        if values.get("gap") is not None and values.get("cavity_length") is not None:
            raise Hint("gap and cavity_length exclude each other", 'gap = "0.4 mm"')
        return values

    @model_validator(mode="after")
    def _gap_of_cavity(self) -> ImpactDamper:
        one_of('gap = "0.4 mm"', gap=self.gap, cavity_length=self.cavity_length)
        if self.cavity_length is not None:
            row = self.row
            if self.cavity_length < row:
                raise Hint(
                    f"is shorter than the row of balls, which is {1e3 * row:.6g} mm long",
                    f'cavity_length = "{1e3 * row * 1.01:.4g} mm"',
                    ["cavity_length"],
                )
            # Equal to a damper that has a gap from the outset.
            complete(self, gap=(self.cavity_length - row) / 2, cavity_length=None)
        return self

    @model_validator(mode="after")
    def _row_fits(self) -> ImpactDamper:
        count = len(self.balls)
        if count == 0:
            raise Hint("a damper needs at least one ball", 'ball = { material = "steel", radius = "10 mm" }', ["balls"])
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
                    "start positions in ascending order",
                    ["start"],
                )
        return self

    @model_validator(mode="after")
    def _starts_apart(self) -> ImpactDamper:
        if self.number > 1 and isinstance(self.start, list):
            raise Hint(
                f"{self.number} identical dampers start at different places, but a list of starts holds for one damper",
                "start = 0, or a list of dampers",
                ["start"],
            )
        if self.number > 1 and not self.clearance:
            raise Hint(
                f"{self.number} dampers without a gap would move in step", "a damper with their mass", ["number"]
            )
        return self

    gap_fractions: ClassVar[tuple[str, ...]] = ("start",)
    """Fields whose numbers are fractions of the gap."""

    @property
    def base_direction(self) -> None:
        """None: the balls move along a line without a direction."""

    @property
    def has_adjusted_dashpots(self) -> bool:
        """True: the effective mass of the structure is that of the walls."""
        return True

    @property
    def has_random_start(self) -> bool:
        """Whether repeated runs can start differently: a row of balls can start anywhere."""
        return True

    def restarted(self, number: int, generator: np.random.Generator) -> ImpactDamper:
        """Return the damper with the start of a repeated run: the row at rest in its centre, then anywhere in the gap."""
        return self.model_copy(update={"start": float(generator.uniform(-1, 1)) if number else 0.0})

    def each(self) -> tuple[ImpactDamper, ...]:
        """Return the identical dampers that this one stands for (see `number`), each with its own start."""
        if self.number == 1:
            return (self,)
        first = self.positions0[0] / (0.5 * self.clearance)
        dampers = [self.model_copy(update={"number": 1})]
        for index in range(1, self.number):
            place = (first + 1 + 2 * _GOLDEN * index) % 2 - 1
            start = place if np.ndim(place) else float(place)
            name = f"{self.name}{index + 1}" if self.name else ""
            dampers.append(self.model_copy(update={"number": 1, "name": name, "start": start}))
        return tuple(dampers)

    def in_space(self, direction: Any = "x", *, gravity: Any = (0.0, 0.0, -STANDARD_GRAVITY)) -> ParticleDamper:
        r"""Return the ball in a box of the 3-D engine, for a case that has particle dampers, too.

        The ball moves along the line in a box of its size, without friction, so that a floor below it does not act along
        the line.

        Parameters
        ----------
        direction
            Direction of the line, "x", "y", "z" or three numbers along one of these axes.
        gravity
            Gravity of the other dampers of the case [m/s^2]; its component along the line must be that of this damper.

        Returns
        -------
        ParticleDamper
            A box with one ball, with name, point, start and velocity of this damper.

        Raises
        ------
        CaseError
            If the damper has several balls, a striker, or a number of dampers; if the direction is not along an axis; or if
            gravity along the line differs.

        Notes
        -----
        The dashpots of the 3-D engine belong to rigid walls. Those of the 1-D engine are adjusted to the effective mass M
        of the structure, so that contacts have their restitution against it. Here the damping ratio of a contact of a ball
        of mass m is larger by the factor :math:`\sqrt{1 + m / M}`.

        Examples
        --------
        >>> import rattlebox as rb
        >>> ball = rb.Sphere(diameter="20 mm", material="steel")
        >>> damper = rb.ImpactDamper(ball=ball, gap="2 mm", contact=rb.Tsuji(restitution=0.6))
        >>> box = damper.in_space("x")
        >>> box.cavity.size
        (0.024, 0.02002, 0.02002)
        """
        axis, down = np.asarray(unit_vector(direction)), np.asarray(TypeAdapter(Accelerations).validate_python(gravity))
        if len(self.balls) > 1 or self.number > 1 or isinstance(self.balls[0], Striker):
            raise Hint(f"only one ball can move in space, not {self.words()}", "an ImpactDamper with one Sphere")
        if np.count_nonzero(axis) > 1:
            raise Hint(
                f"the direction {axis.tolist()} is not along an axis of the box", '"x", "y" or "z"', ["direction"]
            )
        along = float(axis @ down)
        if abs(along - self.gravity) > 1e-3 * STANDARD_GRAVITY:
            raise Hint(
                f"gravity along the line is {self.gravity:.6g} m/s^2 in the damper and {along:.6g} m/s^2 in the case",
                f'gravity = "{along:.6g} m/s^2" of the ImpactDamper',
                ["gravity"],
            )
        ball, line = self.balls[0], np.abs(axis)
        size = 2 * ball.half * (1 + _PLAY * (1 - line)) + self.clearance * line
        place = float(self.positions0[0]) * axis + 0.5 * (size - 2 * ball.half) * np.sign(down) * (1 - line)
        density = ball.weight / (4 / 3 * math.pi * ball.half**3)
        return ParticleDamper(
            name=self.name,
            particles=Particles(
                material=ball.material.model_copy(update={"density": density}), radius=ball.half, count=1
            ),
            cavity=Box(size=tuple(size.tolist())),
            wall=self.wall,
            contact=self.contact,
            gravity=tuple(down.tolist()),
            point=self.point,
            direction=tuple(axis.tolist()),
            packing=Positions(positions=[tuple(place.tolist())]),
            velocity=tuple((float(self.velocities0[0]) * axis).tolist()),
        )

    def alike(self) -> ImpactDamper:
        """Return the damper without its start, in which identical dampers differ."""
        return self.model_copy(update={"start": 0.0})

    @property
    def mass(self) -> float:
        """Mass of the balls [kg]."""
        return float(np.sum(self.masses))

    def facts(self) -> list[tuple[str, str]]:
        """Return numbers that follow from the fields, with their names."""
        return [
            ("mass of the balls", amount(self.mass, "kg")),
            ("clearance", f"{amount(self.clearance, 'm')}, twice the gap"),
        ]

    def words(self) -> str:
        """Return a phrase about the balls and their clearance."""
        mass, count = amount(self.mass, "kg"), len(self.balls)
        nouns = list(dict.fromkeys(ball.noun for ball in self.balls))
        materials = list(dict.fromkeys(ball.material.words for ball in self.balls if not isinstance(ball, Striker)))
        one = f"{with_article(' '.join([*materials, nouns[0]]))} of {mass}"
        of = f"{joined(materials)} " if materials else ""
        several = f"a row of {count} {of}{joined([f'{noun}s' for noun in nouns])} of {mass} in all"
        return f"{one if count == 1 else several} with {amount(self.clearance, 'm')} of clearance"

    def pairs(self, wall_mass: float) -> list[Pair]:
        """Return the pairs of bodies in contact, from the trailing to the leading wall.

        Parameters
        ----------
        wall_mass
            Effective mass of the walls [kg].

        Returns
        -------
        list of Pair
            Trailing wall and ball 1, ball 1 and ball 2, ..., last ball and leading wall.
        """
        balls = [Body(ball.material, ball.curvature, ball.weight) for ball in self.balls]
        materials = (balls[0].material, balls[-1].material) if self.wall is None else (self.wall, self.wall)
        walls = [Body(None if isinstance(one, str) else one, mass=wall_mass) for one in materials]
        return [Pair(below, above) for below, above in pairwise([walls[0], *balls, walls[1]])]

    @property
    def row(self) -> float:
        """Length of the row of balls in contact [m]."""
        return reduce(add, [2 * ball.half for ball in self.balls])

    @property
    def clearance(self) -> float:
        """Total clearance of the row, twice the gap [m]."""
        return 2 * present(self.gap)

    @property
    def masses(self) -> Vector:
        """Masses of the balls, (n,) [kg]."""
        return stacked([ball.weight for ball in self.balls])

    @property
    def centres(self) -> Vector:
        """Centres of the balls in the packed and centred row, relative to the centre of the cavity, (n,) [m]."""
        radii = np.array([ball.half for ball in self.balls])
        edges = np.concatenate([[0.0], np.cumsum(2 * radii)])
        centres: Vector = edges[:-1] + radii - radii.sum()
        return centres

    @property
    def positions0(self) -> Vector:
        """Reduced start positions in the cavity, (n,) [m]."""
        half = 0.5 * self.clearance
        places = self.start if isinstance(self.start, list) else [self.start] * len(self.balls)
        return stacked([parse(p, ("m",))[0] if isinstance(p, str) else p * half for p in places])

    @property
    def velocities0(self) -> Vector:
        """Start velocities, (n,) [m/s]."""
        speeds = self.velocity if len(self.velocity) > 1 else self.velocity * len(self.balls)
        return stacked(speeds)
