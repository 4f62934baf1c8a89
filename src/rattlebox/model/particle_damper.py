"""Particle dampers: many spheres in a cavity, in 3-D."""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, TypeAdapter, ValidationError, WithJsonSchema, model_validator

from rattlebox._util.exceptions import ResourceError
from rattlebox._util.frozen import complete
from rattlebox._util.narrow import present
from rattlebox._util.phrases import counted, joined
from rattlebox._util.quantities import amount

from .also_accepts import AlsoAccepts
from .any_cavity import AnyCavity
from .bodies import AnyBody
from .cavities import Cavity
from .cells import overlapping_cells, separation
from .contact_table import WALL, ContactTable, Entry, PairLaws, check_alike
from .contacts import AnyContact
from .crowds import Crowd, bed_density
from .damper_base import Damper
from .elementwise import Vector
from .errors import Hint, at, several
from .friction import AnyFriction, AnyRolling, Mindlin, Rolling
from .interior import Interior
from .materials import AnyWall, Material
from .mixing import Mixing, mixed
from .overlaps import check_size
from .packing import AnyPacking, Lattice
from .pairs import Body, Pair
from .particles import MAX_PARTICLES, Particles, as_species
from .rotation import Rotation
from .space import AXES, Accelerations, Direction, Lengths, Velocities, unit_vector
from .units import Number, Whole
from .walls import AnyFace, Wall

MAX_DAMPERS = 10_000  # identical ones at a point
_BYTES = 1000  # smallest memory of a particle and its contacts


def memory() -> float:
    """Return the memory of this machine [bytes]; infinite if it is unknown."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, OSError, ValueError):  # not on every system
        return math.inf


def _softening(value: object) -> Any:
    """Return "auto", or a number within the limits."""
    try:
        return value if value == "auto" else _FACTOR.validate_python(value)
    except ValidationError:
        if isinstance(value, str):
            raise Hint('a factor is a number of at least 1, or "auto"', 'softening = "auto"') from None
        raise


def _rows(value: object) -> Any:
    """Return an array as nested lists."""
    return value.tolist() if isinstance(value, np.ndarray) else value


_FACTOR: TypeAdapter[float] = TypeAdapter(Annotated[Number, Field(ge=1, le=1e6)])


@dataclass(frozen=True, eq=False)
class Contents:
    """The particles in a cavity, species after species."""

    radius: Vector  # Radius [m], mass [kg], moment of inertia [kg m^2], (n,)
    mass: Vector
    inertia: Vector
    species: NDArray[np.int64]  # Index of the species, (n,)


@dataclass(frozen=True, eq=False)
class Start:
    """Initial state of the particles."""

    # Position relative to the centre of the cavity [m], velocity relative to the base [m/s], angular velocity [rad/s], (n,
    # 3)
    position: Vector
    velocity: Vector
    spin: Vector


class ParticleDamper(Damper):
    """Spheres in a cavity that moves with a point of the structure.

    Parameters
    ----------
    particles
        Particles of one species, or a list of several.
    cavity
        Box, Cylinder, SphericalCavity or Mesh.
    bodies
        Fixed bodies inside the cavity, such as RodBody, PlateBody, BallBody, MeshBody, and arrays of them.
    wall
        Material of the walls, or "rigid"; default that of the first species.
    contact, wall_contact
        Contact laws among particles and at walls; the default of the second is the first.
    friction, wall_friction
        Friction laws or coefficients among particles and at walls; default none, and that of the particles at walls.
    rolling, wall_rolling
        Rolling resistances or their coefficients among particles and at walls; defaults as for friction.
    walls
        Faces that differ from the other walls, by name: "-x", "+x", "-y", ... of a box, "side", "first end" and "last end"
        of a cylinder. Each is a `Wall`, a material, "rigid" or "frictionless".
    pairs
        Laws for pairs of species, or a species and the wall, that differ from the laws above.
    mixing
        Rule for two different species without an entry in `pairs`: the "arithmetic", "geometric" or "harmonic" mean of the
        numbers in the laws of each species, or the "smaller" or "larger" number. By default all species have the same laws.
    gravity
        Gravity along x, y and z [m/s^2].
    rotation
        Rotation of the cavity about an axis of the machine; default none. Velocities at the start are then relative to the
        turning cavity, and so are the positions and velocities of particles in the results.
    point, points
        Point of the structure, needed if there are several; or points that have such a damper each.
    number
        Number of identical dampers at each point. Each has a random packing of its own, with a seed that follows from that
        of the packing. By default it is the number of offsets, or 1.
    offsets
        From the point to the centre of each of these dampers [m], the cells, along the axes of the cavity. Pictures and
        snapshots show the cells there. In a cavity that turns, the arm of each cell is that of the rotation plus its offset.
        Without a rotation an offset does not change the motion, since points of the structure only translate.
    direction
        Direction of the base motion, and of a point whose mode shapes have one component.
    packing
        Lattice, Settled, Compacted or Positions.
    velocity
        Initial velocity of all particles [m/s], relative to the base; Positions may add individual velocities.
    softening
        Factor by which moduli in contacts are divided (not in restitution laws), which allows longer steps; or "auto", the
        largest one with an estimated change of the loss in a cycle of at most 0.1 m V^2. Contacts last longer and overlap
        more, and beds under their own weight are more compliant; a run has a warning if that affects the result.
    name
        Name in results and messages; default "damper", "damper2", ...

    Examples
    --------
    >>> import rattlebox as rb
    >>> damper = rb.ParticleDamper(
    ...     particles=rb.Particles(material="steel", diameter="5 mm", count=100),
    ...     cavity=rb.Box(size=("30 mm", "30 mm", "25 mm")),
    ...     contact=rb.Tsuji(restitution=0.8),
    ...     friction=0.2,
    ... )
    >>> print(f"{1e3 * damper.contents.mass.sum():.1f} g of balls")
    51.4 g of balls
    """

    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("point", "points"),)
    kind: Literal["particle"] = "particle"
    name: str = ""
    particles: Annotated[tuple[Particles, ...], BeforeValidator(as_species), AlsoAccepts()] = Field(
        examples=[{"material": "steel", "diameter": "4 mm", "count": 100}]
    )
    cavity: AnyCavity
    bodies: tuple[AnyBody, ...] = ()
    wall: AnyWall | None = None
    contact: AnyContact
    wall_contact: AnyContact | None = None
    friction: AnyFriction | None = None
    wall_friction: AnyFriction | None = None
    rolling: AnyRolling | None = None
    wall_rolling: AnyRolling | None = None
    walls: dict[str, AnyFace] = Field(default_factory=dict, examples=[{"-z": {"friction": 0.3}}])
    pairs: tuple[PairLaws, ...] = ()
    mixing: Mixing | None = None
    gravity: Accelerations = (0.0, 0.0, -9.81)
    rotation: Rotation | None = None
    point: str | None = None
    points: tuple[str, ...] = Field(default=(), examples=[["tip", "middle"]])
    number: Annotated[Whole, Field(ge=1, le=MAX_DAMPERS)] = 1
    offsets: Annotated[tuple[Lengths, ...], BeforeValidator(_rows)] = Field(
        default=(), examples=[[["-15 mm", 0, 0], ["15 mm", 0, 0]]]
    )
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
        self._check_offsets()
        self._check_group()
        if isinstance(self.interior, Interior):
            self.interior.check()
        self._check_faces()
        self._check_amounts()
        self._check_room()
        self._check_rotation()
        self._check_pairs()
        self._check_filling()
        return self

    def alike(self) -> ParticleDamper:
        """Return the damper without the seed of its packing and its rotation, in which the cells of a damper differ."""
        packing = self.packing.model_copy(update={"seed": 0}) if self.packing.is_random else self.packing
        return self.model_copy(update={"packing": packing, "rotation": None})

    @cached_property
    def interior(self) -> Cavity:
        """The space for particles: the cavity less the bodies inside."""
        return Interior.of(self.cavity, self.bodies)

    @property
    def mass(self) -> float:
        """Mass of the particles [kg]."""
        return float(self.contents.mass.sum())

    def check_packable(self) -> None:
        """Raise if the cavity turns, is a surface of triangles or has bodies inside."""
        if self.rotation is not None:
            raise Hint(
                "a stepper has cavities that do not turn about an axis, but this damper has a rotation",
                "rb.simulate, or a damper without rotation",
                ["rotation"],
            )
        parts = {
            "a surface of triangles": ("cavity", self.cavity.walls().solids.each),
            "bodies": ("bodies", self.bodies),
        }
        for what, (field, solids) in parts.items():
            if solids:
                raise Hint(
                    f"a packed case cannot contain {what}",
                    "rb.simulate, which can; or a Box, Cylinder or SphericalCavity without bodies",
                    [field],
                )

    def facts(self) -> list[tuple[str, str]]:
        """Return numbers that follow from the fields, with their names."""
        radii = self.contents.radius
        share = float((4 / 3 * math.pi * radii**3).sum()) / self.interior.volume
        return [
            ("particles", counted(len(radii), "particle")),
            ("mass of the particles", amount(self.mass, "kg")),
            ("share of the volume of the cavity", amount(share, "%", 3)),
            *(
                [("centrifugal acceleration at the centre", f"{self.rotation.centrifugal_ratio():.3g} g")]
                if self.rotation
                else []
            ),
        ]

    def words(self) -> str:
        """Return a phrase about the particles and their cavity."""
        radii, mass = self.contents.radius, amount(self.mass, "kg")
        materials = list(dict.fromkeys(each.material.words for each in self.particles))
        size = amount(2 * float(radii.min()), "m")
        if not np.isclose(radii.min(), radii.max()):
            size += f" to {amount(2 * float(radii.max()), 'm')}"
        return f"{counted(len(radii), f'{joined(materials)} ball')} of {size} ({mass}) in {self.interior.words()}"

    def _check_offsets(self) -> None:
        """Raise if the offsets and the number differ, or if cells overlap; set the number to that of the offsets."""
        count = len(self.offsets)
        if not count:
            return
        if count > MAX_DAMPERS:
            raise Hint(f"{several(count, 'offset')}; at most {MAX_DAMPERS} are allowed", "fewer cells", ["offsets"])
        if "number" not in self.model_fields_set:
            complete(self, number=count)
        if self.number != count:
            raise Hint(
                f"number and offsets must agree: {several(self.number, 'cell')}, but {several(count, 'offset')}",
                f"number = {count}, or no number",
                ["offsets"],
            )
        places = np.array(self.offsets)
        pair = overlapping_cells(self.cavity, places)
        if pair is None:
            return
        apart = separation(self.cavity, places[pair[1]] - places[pair[0]])
        raise Hint(
            f"cells {pair[0] + 1} and {pair[1] + 1} overlap: their centres are"
            f" {amount(float(np.linalg.norm(places[pair[1]] - places[pair[0]])), 'm')} apart",
            f"centres at least {amount(apart, 'm')} apart in this direction, or a smaller cavity",
            ["offsets", pair[1]],
        )

    def _check_group(self) -> None:
        """Raise if point and points are both given, or if identical dampers have the same packing."""
        if self.point is not None and self.points:
            raise Hint("point and points exclude each other", "one of them", ["points"])
        each = Counter(self.points or (self.point,))
        if self.number * max(each.values()) > 1 and not self.packing.is_random:
            raise Hint(
                "identical dampers with the same packing would move in step, like a single heavier one",
                'packing = { kind = "settled" }, or a lattice with noise',
                ["packing"],
            )

    def absent_item(self, field: str, name: str) -> str:
        """Return advice on a face without an entry in `walls`, or a name that another table lacks."""
        if field != "walls":
            return super().absent_item(field, name)
        labels = self.interior.walls().labels
        if name not in labels:
            return self.interior.face_instead(name, labels)
        return (
            f'walls = {{ "{name}" = {{}} }} in the case: a face with the properties of the others, which may then vary'
        )

    def _check_faces(self) -> None:
        """Raise if a face does not exist, or if particles would fall forever along a periodic direction."""
        with at("walls"):
            self.interior.check_faces(self.walls)
        for axis, pull, length in zip(AXES, self.gravity, self.interior.period, strict=True):
            if length and pull:
                raise Hint(
                    f"gravity has a component along {axis}, in which the box is periodic: particles would fall forever",
                    f"a direction of gravity without {axis}, or walls along {axis}",
                    ["gravity"],
                )

    def _check_amounts(self) -> None:
        if not self.particles:
            raise Hint(
                "a particle damper needs particles",
                "particles = { material = ..., radius = ..., count = ... }",
                ["particles"],
            )
        labels = [species.label for species in self.particles]
        for index, species in enumerate(self.particles):
            place = self._place(index)
            if labels.index(species.label) != index or species.label == WALL:
                raise Hint(
                    f"the name {species.label!r} is that of another species, or of the walls",
                    "another name",
                    [*place, "name"],
                )
            if not species.has_amount and (self.packing.stated_count is None or len(labels) > 1):
                raise Hint("count, mass, fill_ratio or bed_fill is needed", "count = 200", place)
            if species.bed_fill is not None and len(labels) > 1:
                raise Hint(
                    "bed_fill needs the density of the bed, which is unknown for several species",
                    "fill_ratio = 0.3",
                    [*place, "bed_fill"],
                )
            radii = self.packing.stated_radii is not None
            if species.has_size == radii:
                raise Hint(
                    "the size is given here and by the radii of the packing; only one of them is allowed"
                    if radii
                    else "radius, diameter or distribution is needed",
                    "positions without radii" if radii else 'radius = "2 mm"',
                    place,
                )

    def _place(self, index: int) -> list[str | int]:
        """Return the place of a species in the damper, for messages."""
        return ["particles", index] if len(self.particles) > 1 else ["particles"]

    def _check_pairs(self) -> None:
        known = [*(species.label for species in self.particles), WALL]
        seen: set[frozenset[str]] = set()
        for index, pair in enumerate(self.pairs):
            with at("pairs", index):
                for number, name in enumerate(pair.between):
                    if name not in known:
                        raise Hint(f"the damper has no species {name!r}", " or ".join(known), ["between", number])
                both = frozenset(pair.between)
                if both in seen or both == {WALL}:
                    raise Hint(
                        "a pair is two species, or a species and the wall, and each pair may occur once",
                        "one entry for each pair",
                        ["between"],
                    )
                seen.add(both)
        for walls in (False, True):
            entries = [entry for entry in self._laws() if entry.at_wall == walls]
            contacts = [(entry.contact, entry.place) for entry in entries]
            check_alike("kind of law", [(law.kind, place) for law, place in contacts])
            check_alike("ending", [(law.ending, place) for law, place in contacts if hasattr(law, "ending")])
            for entry in entries:
                entry.check_friction()
            frictions = [(entry.friction, entry.friction_place) for entry in entries]
            check_alike("kind of friction", [(law.kind, place) for law, place in frictions if law and law.coefficient])

    def _check_rotation(self) -> None:
        """Raise if images of a periodic cavity would be in another field than the particles."""
        if self.rotation is None:
            return
        axis = unit_vector(self.rotation.axis)
        if np.any((self.interior.period > 0) & (np.abs(axis) < 1 - 1e-12)):
            raise Hint(
                "a periodic direction across the axis of a rotation has no images in the same field",
                "periodic directions along the axis only",
                ["rotation", "axis"],
            )

    def check_base(self, advice: str) -> None:
        """Raise if the vibration is along axes of a turning cavity, which no motion of the base is."""
        if self.rotation is not None and self.rotation.vibration == "cavity":
            raise Hint(
                "a motion of the base is along axes of the machine, but this vibration along those of the cavity",
                f'vibration = "machine", or {advice}',
                ["rotation", "vibration"],
            )

    def _check_room(self) -> None:
        """Raise, before arrays are allocated, if the particles exceed the volume of the cavity or the memory."""
        if self.packing.stated_count is not None:
            return
        crowds = [species.crowd(self.interior.volume, self._density(species)) for species in self.particles]
        count = sum(crowd.count for crowd in crowds)
        if not 0 < count <= MAX_PARTICLES:  # `Particles.number` raises.
            return
        filled = sum(crowd.count * crowd.volume for crowd in crowds) / self.interior.volume
        largest = max((crowd.largest for crowd in crowds), default=0.0)
        whole = Crowd(count, filled * self.interior.volume / count, largest)
        if (
            filled >= 1
            and 2 * largest < self.interior.lengths.min()
            and largest**3 * 4 / 3 * math.pi < self.interior.volume
        ):
            raise self.packing.too_many(self.interior, whole)
        count *= self.number * max(1, len(self.points))
        if count * _BYTES > memory():
            raise ResourceError(
                f"{count:.3g} particles take {1e-9 * count * _BYTES:.3g} GB, and this machine has {1e-9 * memory():.3g} GB",
                f"at most {memory() / _BYTES:.2g} of them, or larger particles",
                ["particles"],
            )

    def _check_filling(self) -> None:
        contents = self.contents
        largest = int(contents.radius.argmax())
        with at(*self._place(int(contents.species[largest]))):
            check_size(self.interior, float(contents.radius[largest]))
        filled = float(contents.radius @ contents.radius**2) * 4 / 3 * math.pi / self.interior.volume
        crowd = Crowd.of(contents.radius)
        if filled >= 1:
            raise self.packing.too_many(self.interior, crowd)
        self.packing.check(self.interior, crowd, settles=self._settles)
        _ = self.start

    @property
    def base_direction(self) -> Direction:
        """The direction of the damper."""
        return self.direction

    @property
    def has_adjusted_dashpots(self) -> bool:
        """False: a particle is much lighter than the structure."""
        return False

    @property
    def has_random_start(self) -> bool:
        """Whether repeated runs can start differently."""
        return self.packing.is_random

    @property
    def has_equal_cells(self) -> bool:
        """Whether all cells are in the same field."""
        if self.rotation is None or not self.offsets:
            return True
        axis, places = unit_vector(self.rotation.axis), np.array(self.offsets)
        moved = np.linalg.norm(np.cross(places - places[0], axis), axis=1)
        return bool(moved.max() <= 1e-9 * self._reach)

    def restarted(self, number: int, generator: np.random.Generator) -> ParticleDamper:
        """Return the damper with the packing of a repeated run."""
        return self.model_copy(update={"packing": self.packing.reseeded(number)})

    def each(self) -> tuple[ParticleDamper, ...]:
        """Return the identical dampers that this one stands for (see `number`), each with its own point and packing."""
        points = self.points or (self.point,)
        places = [(point, offset) for point in points for offset in self.offsets or (None,) * self.number]
        if len(places) == 1 and not self.points and not self.offsets:
            return (self,)
        return tuple(
            self.model_copy(
                update={
                    "name": f"{self.name}{index + 1}" if self.name and index else self.name,
                    "point": point,
                    "points": (),
                    "number": 1,
                    "offsets": (),
                    "rotation": self.rotation
                    if offset is None or self.rotation is None
                    else self.rotation.at_cell(offset),
                    "packing": self.packing.repeated(index),
                }
            )
            for index, (point, offset) in enumerate(places)
        )

    def groups(self) -> list[Vector]:
        """Return the places of the cells that are drawn together, relative to their point, (k, 3) [m]; see `each`."""
        points = max(1, len(self.points))
        return [np.array(self.offsets)] * points if self.offsets else [np.zeros((1, 3))] * (points * self.number)

    @cached_property
    def contents(self) -> Contents:
        """The particles, species after species."""
        numbers = [self._number(index) for index in range(len(self.particles))]
        species = np.repeat(np.arange(len(numbers)), numbers)
        radius = self.packing.stated_radii
        if radius is None:
            sizes = [each.diameters(n) / 2 for each, n in zip(self.particles, numbers, strict=True)]
            radius = np.concatenate(sizes)
        rows = self.packing.stated_count
        if rows is not None and radius.size != rows:
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
            return present(self.packing.stated_count)
        with at(*self._place(index)):
            return species.number(self.interior.volume, self._density(species))

    def _density(self, species: Particles) -> float:
        """Return the volume of the particles over that of their bed; 1 without `bed_fill`."""
        if species.bed_fill is None or not species.has_size:
            return 1.0
        bulk = self.packing.bulk_density(self.largest_friction)
        return bed_density(self.interior, species.mean_diameter, bulk, species.bed_fill, self.up)

    @property
    def up(self) -> Vector | None:
        """Unit vector against the field at the start, (3,); None without one."""
        pull = float(np.linalg.norm(self.field))
        return -self.field / pull if pull else None

    @property
    def field(self) -> Vector:
        """Acceleration of particles at rest at the centre of the cavity at the start, along its axes, (3,) [m/s^2].

        It is gravity, and in a cavity that turns the centrifugal acceleration; of several cells, that of the first.
        """
        gravity, rotation = np.array(self.gravity), self.each()[0].rotation
        return gravity if rotation is None else rotation.field(gravity)

    @property
    def _settles(self) -> bool:
        """Whether particles settle in every cell."""
        return all(bool(np.any(cell.field)) for cell in self.each())

    def fall_speed(self, duration: float) -> float:
        """Return a bound on the speed after a fall through the cavity in a run of this duration [m/s]."""
        size = self.strongest_field(duration)
        if self.rotation is not None:
            return math.sqrt(4 * self._reach * size)
        return math.sqrt(2 * size * self.interior.extent(np.array(self.gravity) / size)) if size else 0.0

    def strongest_field(self, duration: float) -> float:
        """Return a bound on gravity and centrifugal acceleration in the cavity in a run of this duration [m/s^2]."""
        gravity = np.array(self.gravity)
        if self.rotation is not None:
            return self.rotation.strongest_field(gravity, self._reach, duration)
        return float(np.linalg.norm(gravity))

    @property
    def _reach(self) -> float:
        """Bound on the distance of a point of the cavity from its centre [m]."""
        return float(np.linalg.norm(self.interior.lengths)) / 2

    @property
    def largest_friction(self) -> float:
        """Largest coefficient of friction among particles and at walls."""
        names = [species.label for species in self.particles]
        laws = [self._law("friction", first, second)[0] for k, first in enumerate(names) for second in names[k:]]
        for _, own in self._wall_kinds:
            of_face = None if own is None else own.friction
            laws += [self._law("friction", name, WALL)[0] for name in names] if of_face is None else [of_face]
        return max((law.coefficient for law in laws if law is not None), default=0.0)

    @cached_property
    def start(self) -> Start:
        """Initial state of the particles; the positions of settled packings are NaN until `prepare` computes them.

        Raises
        ------
        Hint
            If particles overlap, extend beyond the cavity, or do not fit.
        """
        radius = self.contents.radius
        positions = self.packing.place(self.interior, radius, settles=self._settles)
        velocity, spin = self.packing.motion(radius.size)
        positions = self.interior.wrapped(positions)
        return Start(positions, np.array(self.velocity) + velocity, spin)

    # ---- contacts

    def _law(self, field: str, first: str, second: str) -> tuple[Any, tuple[str | int, ...]]:
        """Return the law of a pair, and its place in the damper."""
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

    @property
    def _wall_kinds(self) -> tuple[tuple[tuple[str, ...], Wall | None], ...]:
        """The faces with the same properties, and these; None for those of the damper."""
        kinds: list[tuple[list[str], Wall | None]] = []
        for name in self.interior.walls().labels:
            own = self.walls.get(name)
            faces = next((faces for faces, wall in kinds if wall == own), None)
            if faces is None:
                kinds.append(([name], own))
            else:
                faces.append(name)
        return tuple((tuple(faces), wall) for faces, wall in kinds)

    def _laws(self) -> Iterator[Entry]:
        """Yield the entries of all pairs of species, then of each species and each kind of wall."""
        names = [species.label for species in self.particles]
        bodies = [self._body(index) for index in range(len(names))]
        for i, first in enumerate(bodies):
            for j in range(i, len(bodies)):
                yield self._entry(names[i], names[j], Pair(first, bodies[j]))
        usual = self.particles[0].material if self.wall is None else self.wall
        for faces, own in self._wall_kinds:
            material = usual if own is None or own.material is None else own.material
            side = Body(material if isinstance(material, Material) else None)
            for name, body in zip(names, bodies, strict=True):
                entry = self._entry(name, WALL, Pair(body, side))
                yield entry if own is None else self._of_face(entry, faces, own)

    def _entry(self, first: str, second: str, pair: Pair) -> Entry:
        contact, place = self._law("contact", first, second)
        friction, friction_place = self._law("friction", first, second)
        rolling, rolling_place = self._law("rolling", first, second)
        at_wall = second == WALL
        return Entry(pair, contact, friction, rolling, (first, second), at_wall, place, friction_place, rolling_place)

    def _of_face(self, entry: Entry, faces: tuple[str, ...], own: Wall) -> Entry:
        """Return the entry of a species and a face that differs from the other walls."""
        place = ("walls", faces[0])
        with at(*place):
            contact = own.contact_from(entry.contact)
        changes: dict[str, Any] = {"contact": contact, "names": (entry.names[0], f"{WALL} {' '.join(faces)}")}
        if contact is not entry.contact:
            changes["place"] = (*place, "contact" if own.contact is not None else "restitution")
        if own.friction is not None:
            changes |= {"friction": own.friction, "friction_place": (*place, "friction")}
            if not own.friction.coefficient:
                changes |= {"rolling": None}
        if own.rolling is not None:
            changes |= {"rolling": own.rolling, "rolling_place": (*place, "rolling")}
        return replace(entry, **changes)

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
        kinds, walls = self._wall_kinds, self.interior.walls()
        kind = {face: number for number, (faces, _) in enumerate(kinds) for face in faces}
        return ContactTable(
            tuple(self._laws()),
            np.maximum(particle, particle.T),
            k * (k + 1) // 2 + np.arange(k)[:, None] + k * np.arange(len(kinds)),
            np.array([kind[name] for name in walls.names], np.int64),
        )

    @property
    def softening_factor(self) -> float:
        """The softening as a number; 1 for "auto", which a run replaces by a number."""
        return 1.0 if self.softening == "auto" else self.softening

    def softened(self, entry: Entry) -> tuple[str, dict[str, Any]]:
        """Return the name of a contact law in the core and its coefficients, with moduli divided by the softening.

        Dashpots and limiting pressures are reduced so that the restitution is the same; see `Contact.softened`.
        """
        return entry.contact.softened(entry.pair, self.softening_factor)

    def softened_friction(self, entry: Entry) -> tuple[str, dict[str, Any]]:
        """Return the name of a friction law in the core and its coefficients, with moduli divided by the softening."""
        friction = Mindlin(coefficient=0.0) if entry.friction is None else entry.friction
        law, values = friction.coefficients(entry.pair)
        soft = dict.fromkeys(("shear_modulus", "stiffness"), self.softening_factor)
        return law, {key: value / soft.get(key, 1.0) for key, value in values.items()}

    def rolling_of(self, entry: Entry) -> Rolling:
        """Return the rolling resistance of a pair; by default one with coefficient 0."""
        return Rolling(coefficient=0.0) if entry.rolling is None else entry.rolling
