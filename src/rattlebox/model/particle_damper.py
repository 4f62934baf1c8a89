"""Particle dampers: many spheres in a cavity in space."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, TypeAdapter, WithJsonSchema, model_validator

from rattlebox._util.exceptions import ResourceError, named
from rattlebox._util.narrow import instance

from .also_takes import AlsoTakes
from .base import Part
from .cavities import AnyCavity
from .contacts import AnyContact, Linear
from .elementwise import Vector
from .errors import Hint, at, several
from .friction import AnyFriction, AnyRolling, Friction, LinearSpring, Mindlin, Rolling
from .materials import AnyWall, Material
from .mixing import Mixing, mixed
from .packing import (
    AnyPacking,
    Crowd,
    Lattice,
    Positions,
    Settled,
    check_packing,
    check_size,
    fewer_at_random,
    lattice_is_full,
)
from .pairs import Body, Pair
from .particles import MOST_PARTICLES, Particles, as_species
from .space import Accelerations, Direction, Velocities
from .units import Number

WALL = "wall"
_BYTES = 1000  # of a particle and its contacts, at least


def memory() -> float:
    """Return the memory of this machine [bytes], infinite where it is not known."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, OSError, ValueError):  # not on every system
        return math.inf


def _two_names(value: Any) -> Any:
    """One name is no pair: not even of a species with itself."""
    names = [value] if isinstance(value, str) else value
    if isinstance(names, (list, tuple)) and len(names) == 1 and isinstance(names[0], str):
        one = names[0]
        like = f'["{one}", "{WALL}"], or ["{one}", "{one}"] among themselves' if one != WALL else f'["steel", "{WALL}"]'
        raise Hint("two names are needed", like)
    return value


def _softening(value: Any) -> Any:
    """Return "auto", or a number within the limits."""
    return value if value == "auto" else _FACTOR.validate_python(value)


_FACTOR: TypeAdapter[float] = TypeAdapter(Annotated[Number, Field(ge=1, le=1e6)])


class PairLaws(Part):
    """Laws of two species, or of a species and the wall, instead of those of all.

    Parameters
    ----------
    between
        Names of two species, or of one and "wall".
    contact, friction, rolling
        What is left out stays as it is for all; friction = 0 is none.
    """

    held_as: ClassVar[tuple[str, ...]] = ("pairs",)
    between: Annotated[tuple[str, str], BeforeValidator(_two_names)] = Field(examples=[["shot", "wall"]])
    contact: AnyContact | None = None
    friction: AnyFriction | None = None
    rolling: AnyRolling | None = None


@dataclass(frozen=True, eq=False)
class Contents:
    """The particles in a cavity, species after species.

    Attributes
    ----------
    radius, mass, inertia : (n,) float
        [m], [kg], [kg m^2].
    species : (n,) int
        Number of the species.
    """

    radius: Vector
    mass: Vector
    inertia: Vector
    species: Any


@dataclass(frozen=True, eq=False)
class Start:
    """State of the particles at the start.

    Attributes
    ----------
    position, velocity, spin : (n, 3) float
        From the centre of the cavity [m], relative to the base [m/s], [rad/s].
    """

    position: Vector
    velocity: Vector
    spin: Vector


@dataclass(frozen=True)
class Entry:
    """How one kind of pair touches.

    Attributes
    ----------
    pair
        The bodies of reference: of a species that has several sizes, particles of its mean radius; a wall that cannot move.
    contact, friction, rolling
        The laws.
    names
        Of the two sides.
    place, friction_place, rolling_place
        Where the laws are given, for messages.
    """

    pair: Pair
    contact: AnyContact
    friction: Friction | None
    rolling: Rolling | None
    names: tuple[str, str]
    place: tuple[str | int, ...]
    friction_place: tuple[str | int, ...]
    rolling_place: tuple[str | int, ...]


@dataclass(frozen=True)
class ContactTable:
    """Entries of all kinds of pairs in a damper.

    Attributes
    ----------
    entries
        The entries.
    particle_entry : (k, k) int
        Entry of two species.
    wall_entry : (k, w) int
        Entry of a species and a kind of wall.
    wall_kind : (walls,) int
        Kind of each wall.
    """

    entries: tuple[Entry, ...]
    particle_entry: Any
    wall_entry: Any
    wall_kind: Any


def _check_alike(what: str, given: Sequence[tuple[str, tuple[str | int, ...]]]) -> None:
    """Refuse what is not computed side by side: words, with the places where they are given."""
    for word, place in given:
        if word != given[0][0]:
            raise Hint(
                f"{word} beside {given[0][0]}: one {what} is needed among particles, and one at walls",
                f"{given[0][0]} in both",
                place,
            )


class ParticleDamper(Part):
    """Spheres in a cavity that moves with a point of the structure.

    Parameters
    ----------
    particles
        One kind of Particles, or several.
    cavity
        Box, Cylinder or SphericalCavity.
    wall
        Material of the walls, "rigid", or None: that of the first particles.
    contact, wall_contact
        Law among particles, and at walls if it is another one.
    friction, wall_friction
        A law or a coefficient; none if left out. At walls the same unless given.
    rolling, wall_rolling
        Resistance to rolling, or its coefficient; none if left out. At walls the same unless given.
    pairs
        Exceptions for pairs of species, or of a species and the wall.
    mixing
        How two unlike species meet that `pairs` does not tell: with the "arithmetic", "geometric" or "harmonic" mean of the
        numbers in the laws that each has among its own kind, or the "smaller" or "larger" ones. Left out, as all do.
    gravity
        [m/s^2], along x, y and z.
    point
        Of the structure; not needed where there is one only.
    direction
        Along which a point moves whose mode shapes have one component, and the base.
    packing
        Lattice, Settled or Positions.
    velocity
        Of all particles at the start [m/s], relative to the base; Positions may give them one by one.
    softening
        Factor by which moduli are divided in contacts (not in laws of restitution), which allows longer steps, or "auto":
        the largest one that is estimated to change the loss in a cycle by at most 0.1 m V^2. Contacts last longer and
        overlap more, and beds under their own weight are more compliant; a run warns where that matters.
    name
        What results and messages call it; "damper", "damper2", ... if left out.
    """

    held_as: ClassVar[tuple[str, ...]] = ("damper", "dampers")
    kind: Literal["particle"] = "particle"
    name: str = ""
    particles: Annotated[tuple[Particles, ...], BeforeValidator(as_species), AlsoTakes()] = Field(
        examples=[{"material": "steel", "diameter": "4 mm", "count": 100}]
    )
    cavity: AnyCavity
    wall: AnyWall | None = None
    contact: AnyContact
    wall_contact: AnyContact | None = None
    friction: AnyFriction | None = None
    wall_friction: AnyFriction | None = None
    rolling: AnyRolling | None = None
    wall_rolling: AnyRolling | None = None
    pairs: tuple[PairLaws, ...] = ()
    mixing: Mixing | None = None
    gravity: Accelerations = (0.0, 0.0, -9.81)
    point: str | None = None
    direction: Direction = "x"
    packing: AnyPacking = Field(default_factory=Lattice)
    velocity: Velocities = (0.0, 0.0, 0.0)
    softening: Annotated[
        Literal["auto"] | float,
        BeforeValidator(_softening),
        WithJsonSchema(
            {"anyOf": [{"type": "number"}, {"type": "string"}], "description": "a number from 1 on, or auto"}
        ),
    ] = 1.0

    @model_validator(mode="after")
    def _fits(self) -> ParticleDamper:
        self._check_amounts()
        self._check_room()
        self._check_pairs()
        self._check_filling()
        return self

    def _check_amounts(self) -> None:
        if not self.particles:
            raise Hint(
                "an empty damper damps nothing",
                "particles = { material = ..., radius = ..., count = ... }",
                ["particles"],
            )
        labels = [species.label for species in self.particles]
        for index, species in enumerate(self.particles):
            place = self._place(index)
            if labels.index(species.label) != index or species.label == WALL:
                raise Hint(f"the name {species.label!r} is taken", "a name of its own", [*place, "name"])
            given = isinstance(self.packing, Positions)
            if not species.has_amount and (not given or len(labels) > 1):
                raise Hint("count, mass or fill_ratio is needed", "count = 200", place)
            radii = isinstance(self.packing, Positions) and self.packing.radii is not None
            if species.has_size == radii:
                raise Hint(
                    "the size is told twice, here and by the packing's radii"
                    if radii
                    else "radius, diameter or distribution is needed",
                    "" if radii else 'radius = "2 mm"',
                    place,
                )

    def _place(self, index: int) -> list[str | int]:
        """Where a species is given, for messages."""
        return ["particles", index] if len(self.particles) > 1 else ["particles"]

    def _check_pairs(self) -> None:
        known = [*(species.label for species in self.particles), WALL]
        seen: set[frozenset[str]] = set()
        for index, pair in enumerate(self.pairs):
            with at("pairs", index):
                for number, name in enumerate(pair.between):
                    if name not in known:
                        raise Hint(f"there are no particles {name!r} here", " or ".join(known), ["between", number])
                both = frozenset(pair.between)
                if both in seen or both == {WALL}:
                    raise Hint("each pair of species, or of one and the wall, is told once", place=["between"])
                seen.add(both)
        for walls in (False, True):
            entries = [entry for entry in self._laws() if (WALL in entry.names) == walls]
            contacts = [(entry.contact, entry.place) for entry in entries]
            _check_alike("kind of law", [(law.kind, place) for law, place in contacts])
            _check_alike("ending", [(law.ending, place) for law, place in contacts if hasattr(law, "ending")])
            for entry in entries:
                self._check_friction(entry)
            frictions = [(entry.friction, entry.friction_place) for entry in entries]
            _check_alike("kind of friction", [(law.kind, place) for law, place in frictions if law and law.coefficient])

    def _check_friction(self, entry: Entry) -> None:
        between = " and ".join(entry.names)
        if (
            entry.rolling is not None
            and entry.rolling.coefficient
            and not (entry.friction and entry.friction.coefficient)
        ):
            raise Hint(
                f"rolling resistance needs friction, and there is none between {between}",
                f"{named(entry.friction_place)} = 0.3, or no rolling",
                entry.rolling_place,
            )
        if isinstance(entry.friction, Mindlin) and entry.friction.coefficient and isinstance(entry.contact, Linear):
            raise Hint(
                f"Mindlin's stiffness belongs to Hertz contacts, but that of {between} is linear",
                f'friction = {{ kind = "spring", coefficient = {entry.friction.coefficient:g}, ratio = 0.286 }}',
                entry.friction_place,
            )
        if isinstance(entry.friction, LinearSpring) and entry.friction.ratio and not isinstance(entry.contact, Linear):
            raise Hint(
                f"a ratio of stiffnesses belongs to linear contacts, but that of {between} is not",
                "friction = 0.3, for Mindlin's stiffness, or stiffness",
                entry.friction_place,
            )

    def _check_room(self) -> None:
        """Refuse more particles than the cavity has room for, or memory holds, before there is a number for each."""
        if isinstance(self.packing, Positions):
            return
        crowds = [species.crowd(self.cavity.volume) for species in self.particles]
        count = sum(crowd.count for crowd in crowds)
        if not 0 < count <= MOST_PARTICLES:  # said where the number is found
            return
        filled = sum(crowd.count * crowd.volume for crowd in crowds) / self.cavity.volume
        largest = max((crowd.largest for crowd in crowds), default=0.0)
        whole = Crowd(count, filled * self.cavity.volume / count, largest)
        if (
            filled >= 1
            and 2 * largest < self.cavity.lengths.min()
            and largest**3 * 4 / 3 * math.pi < self.cavity.volume
        ):
            raise self._too_many(whole)
        if count * _BYTES > memory():
            raise ResourceError(
                f"{count:.3g} particles take {1e-9 * count * _BYTES:.3g} GB, and this machine has {1e-9 * memory():.3g} GB",
                f"at most {memory() / _BYTES:.2g} of them, or larger ones",
                ["particles"],
            )

    def _too_many(self, crowd: Crowd) -> Hint:
        if isinstance(self.packing, Lattice):
            hint = lattice_is_full(self.cavity, crowd, settles=False)
            return Hint(hint.complaint, hint.suggestion, ["particles"])
        times = crowd.count * crowd.volume / self.cavity.volume
        return Hint(
            f"{crowd.count} particles do not fit: their volume is {times:.3g} times that of the cavity",
            fewer_at_random(self.cavity, crowd),
            ["particles"],
        )

    def _check_filling(self) -> None:
        contents = self.contents
        largest = int(contents.radius.argmax())
        with at(*self._place(int(contents.species[largest]))):
            check_size(self.cavity, float(contents.radius[largest]))
        filled = float(contents.radius @ contents.radius**2) * 4 / 3 * math.pi / self.cavity.volume
        crowd = Crowd.of(contents.radius)
        if filled >= 1 and not isinstance(self.packing, Lattice):  # which tells how many it holds
            raise self._too_many(crowd)
        if isinstance(self.packing, Settled):
            if not any(self.gravity):
                held = crowd.on_lattice(self.cavity)
                some = "" if held >= crowd.count else f" with at most {held} of them"
                raise Hint(
                    "nothing settles without gravity",
                    f'packing = {{ kind = "lattice" }}{some}, or gravity = [0, 0, -9.81]',
                    ["packing"],
                )
            if filled > 0.64 and contents.radius.size > 1:
                raise Hint(
                    f"{contents.radius.size} particles fill {100 * filled:.3g} % of the cavity; "
                    "inserted at random they fill 60 % or a little more",
                    fewer_at_random(self.cavity, crowd),
                    ["particles"],
                )
        else:
            _ = self.start

    def label(self, index: int) -> str:
        """Return the damper's name, or one made from its number in the case."""
        return self.name or ("damper" if index == 0 else f"damper{index + 1}")

    @cached_property
    def contents(self) -> Contents:
        """The particles, species after species."""
        numbers = [self._number(index) for index in range(len(self.particles))]
        species = np.repeat(np.arange(len(numbers)), numbers)
        given = self.packing.radii if isinstance(self.packing, Positions) else None
        if given is not None:
            radius = np.array(given)
        else:
            sizes = [each.diameters(n) / 2 for each, n in zip(self.particles, numbers, strict=True)]
            radius = np.concatenate(sizes)
        if isinstance(self.packing, Positions) and radius.size != len(self.packing.positions):
            rows = len(self.packing.positions)
            raise Hint(
                f"{several(radius.size, 'particle')}, but {several(rows, 'position')}",
                f"a row for each particle, or count = {rows}",
                ["packing", self.packing.where],
            )
        density = np.array([each.material.density for each in self.particles])
        mass = 4 / 3 * math.pi * radius**3 * density[species]
        return Contents(radius, mass, 0.4 * mass * radius**2, species)

    def _number(self, index: int) -> int:
        species = self.particles[index]
        if not species.has_amount:
            return len(instance(self.packing, Positions).positions)
        with at(*self._place(index)):
            return species.number(self.cavity.volume)

    @cached_property
    def start(self) -> Start:
        """Where particles are at the start, and how they move; positions of settled ones are for the engine to find.

        Raises
        ------
        Hint
            When particles overlap, stick out, or do not fit.
        """
        packing, radius = self.packing, self.contents.radius
        velocity: Vector = np.tile(self.velocity, (radius.size, 1))
        spin: Vector = np.zeros_like(velocity)
        if isinstance(packing, Positions):
            positions = np.array(packing.positions)
            with at("packing", packing.where):
                check_packing(self.cavity, positions, radius)
            velocity += 0.0 if packing.velocities is None else np.array(packing.velocities)
            spin += 0.0 if packing.spins is None else np.array(packing.spins)
        elif isinstance(packing, Lattice):
            with at("particles"):
                positions = packing.place(self.cavity, radius, settles=any(self.gravity))
        else:
            positions = np.full_like(velocity, np.nan)
        return Start(positions, velocity, spin)

    # ---- contacts

    def _law(self, field: str, first: str, second: str) -> tuple[Any, tuple[str | int, ...]]:
        """The law that a pair has, and where it is given."""
        for index, pair in enumerate(self.pairs):
            law = getattr(pair, field)
            if law is not None and frozenset(pair.between) == frozenset((first, second)):
                return law, ("pairs", index, field)
        if self.mixing is not None and first != second and second != WALL:
            one, other = (self._law(field, name, name)[0] for name in (first, second))
            try:
                return mixed(one, other, self.mixing), ("mixing",)
            except TypeError:
                raise Hint(
                    f"the laws of {field} of {first} and of {second} differ in more than numbers, and cannot be mixed",
                    f'pairs = [{{ between = ["{first}", "{second}"], {field} = ... }}]',
                    ["mixing"],
                ) from None
        wall = getattr(self, f"wall_{field}", None) if second == WALL else None
        return (wall, (f"wall_{field}",)) if wall is not None else (getattr(self, field), (field,))

    def _laws(self) -> Iterator[Entry]:
        """Entries of all pairs of species, then of each species with the wall, which stands as if immovable."""
        names = [species.label for species in self.particles]
        bodies = [self._body(index) for index in range(len(names))]
        wall = self.particles[0].material if self.wall is None else self.wall
        side = Body(wall if isinstance(wall, Material) else None)
        for i, first in enumerate(bodies):
            for j in range(i, len(bodies)):
                yield self._entry(names[i], names[j], Pair(first, bodies[j]))
        for name, body in zip(names, bodies, strict=True):
            yield self._entry(name, WALL, Pair(body, side))

    def _entry(self, first: str, second: str, pair: Pair) -> Entry:
        contact, place = self._law("contact", first, second)
        friction, friction_place = self._law("friction", first, second)
        rolling, rolling_place = self._law("rolling", first, second)
        return Entry(pair, contact, friction, rolling, (first, second), place, friction_place, rolling_place)

    def _body(self, index: int) -> Body:
        contents, material = self.contents, self.particles[index].material
        radius = float(contents.radius[contents.species == index].mean())
        return Body(material, radius, 4 / 3 * math.pi * radius**3 * material.density)

    @property
    def contact_table(self) -> ContactTable:
        """Entries of all pairs."""
        k = len(self.particles)
        particle = np.zeros((k, k), np.int64)
        particle[np.triu_indices(k)] = np.arange(k * (k + 1) // 2)
        return ContactTable(
            tuple(self._laws()),
            np.maximum(particle, particle.T),
            k * (k + 1) // 2 + np.arange(k)[:, None],
            np.zeros(self.cavity.walls().offset.size, np.int64),
        )

    @property
    def softening_factor(self) -> float:
        """The softening as a number: 1 for "auto", which a run replaces by its choice."""
        return 1.0 if self.softening == "auto" else self.softening

    def softened(self, entry: Entry) -> tuple[str, dict[str, Any]]:
        """Return the core's name of a contact law and its coefficients, with moduli divided by the softening.

        Restitution stays: dashpots and limiting pressures are lowered as far as that needs.
        """
        return entry.contact.softened(entry.pair, self.softening_factor)

    def softened_friction(self, entry: Entry) -> tuple[str, dict[str, Any]]:
        """Return the core's name of a friction law and its coefficients, with moduli divided by the softening."""
        friction = Mindlin(coefficient=0.0) if entry.friction is None else entry.friction
        law, values = friction.coefficients(entry.pair)
        soft = dict.fromkeys(("shear_modulus", "stiffness"), self.softening_factor)
        return law, {key: value / soft.get(key, 1.0) for key, value in values.items()}

    def rolling_of(self, entry: Entry) -> Rolling:
        """Return the rolling resistance of a pair, 0 where there is none."""
        return Rolling(coefficient=0.0) if entry.rolling is None else entry.rolling
