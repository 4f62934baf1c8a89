"""Bodies inside cavities: rods, plates, balls, surfaces of triangles, and arrays of them."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from rattlebox._util.phrases import counted, sizes
from rattlebox._util.quantities import amount

from .base import Part
from .elementwise import Vector
from .errors import Hint
from .kinds import AnyKind
from .round_part import RoundPart
from .solids import Ball, Plate, Rod, Solid, TriangleMesh
from .space import Direction, Lengths, unit_vector
from .triangle_surface import TriangleSurface, surface_notes, surface_words
from .units import Angle, PositiveLength, Whole

if TYPE_CHECKING:
    from .cavities import Cavity

MOST_BODIES = 5000


def frame_along(direction: str | tuple[float, float, float]) -> Vector:
    """Return two directions perpendicular to an axis, and the axis, in rows, (3, 3); x, y and z for the axis z."""
    along = unit_vector(direction)
    first = np.eye(3)[0] if abs(along[2]) > 1 - 1e-12 else np.cross(np.eye(3)[2], along)
    first = first / np.linalg.norm(first)
    return np.array([first, np.cross(along, first), along])


def turned(frame: Vector, angle: float) -> Vector:
    """Return the frame that follows from x, y and z by a turn about the third axis of a frame."""
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(frame.T @ turn @ frame)


class Body(Part):
    """Base class of fixed bodies inside a cavity, which moves with them; positions are relative to its centre."""

    field_names: ClassVar[tuple[str, ...]] = ("bodies", "body")
    kinds: ClassVar[dict[str, type[Part]]] = {}
    elementwise: ClassVar[bool] = False
    kind: str
    name: str = ""

    @abstractmethod
    def solids(self, cavity: Cavity) -> list[Solid]:
        """Return the solids in a cavity, which decides on lengths that are not given."""

    @property
    def number(self) -> int:
        """Number of bodies for which it stands at least: millions are refused before they are made."""
        return 1

    @abstractmethod
    def words(self) -> str:
        """Return a phrase with the sizes: "a rod, 6 mm in diameter"."""

    def short_label(self) -> str:
        """Return the phrase with the sizes, without its article."""
        return self.words().removeprefix("a ")

    @property
    def label(self) -> str:
        """The name, or the kind."""
        return self.name or self.kind

    def notes(self) -> Iterator[str]:
        """Yield what a user should know about assumptions."""
        yield from ()

    @property
    def digest(self) -> str:
        """Text that differs for bodies with other surfaces."""
        return self.model_dump_json()


class RodBody(RoundPart, Body):
    """A circular rod with flat ends.

    Parameters
    ----------
    radius, diameter
        One of them [m].
    length
        Length [m]; by default the rod goes through the whole cavity.
    axis
        "x", "y", "z" or three components.
    position
        Middle of the rod, relative to the centre of the cavity [m].
    name
        Name of its wall in results; default "rod".

    Examples
    --------
    A ring: a cylinder around a rod.

    >>> import rattlebox as rb
    >>> damper = rb.ParticleDamper(
    ...     particles=rb.Particles(material="steel", diameter="3 mm", count=100),
    ...     cavity=rb.Cylinder(diameter="40 mm", length="20 mm"),
    ...     bodies=[rb.RodBody(diameter="20 mm")],
    ...     contact=rb.Tsuji(restitution=0.8),
    ... )
    >>> print(f"{1e6 * damper.interior.volume:.2f} cm^3")
    18.85 cm^3
    """

    kind: Literal["rod"] = "rod"
    length: PositiveLength | None = None
    axis: Direction = "z"
    position: Lengths = (0.0, 0.0, 0.0)

    def solids(self, cavity: Cavity) -> list[Solid]:
        """Return the rod."""
        length = _through(cavity, self.axis) if self.length is None else self.length
        sizes = np.array([self.radius, length / 2, 0.0])
        return [Rod(self.label, np.array(self.position), sizes, frame_along(self.axis))]

    def words(self) -> str:
        """Return a phrase with the diameter."""
        return f"a rod, {amount(2 * self.radius, 'm')} in diameter"


class PlateBody(Body):
    """A plate or block with edges along x, y and z, or turned about one of them.

    Parameters
    ----------
    size
        Lengths along its edges [m].
    position
        Centre, relative to that of the cavity [m].
    axis, angle
        Axis and angle of a turn about its centre [rad]; default none.
    name
        Name of its wall in results; default "plate".
    """

    kind: Literal["plate"] = "plate"
    size: Lengths
    position: Lengths = (0.0, 0.0, 0.0)
    axis: Direction = "z"
    angle: Angle = 0.0

    @model_validator(mode="after")
    def _has_size(self) -> PlateBody:
        for index, length in enumerate(self.size):
            if not length > 0:
                raise Hint(
                    "must be greater than zero", 'three lengths, such as ("20 mm", "20 mm", "1 mm")', ["size", index]
                )
        return self

    def solids(self, cavity: Cavity) -> list[Solid]:
        """Return the plate."""
        axes = turned(frame_along(self.axis), self.angle) if self.angle else np.eye(3)
        return [Plate(self.label, np.array(self.position), np.array(self.size) / 2, axes)]

    def words(self) -> str:
        """Return a phrase with the edges."""
        return f"a plate of {sizes(self.size)}"


class BallBody(RoundPart, Body):
    """A fixed ball.

    Parameters
    ----------
    radius, diameter
        One of them [m].
    position
        Centre, relative to that of the cavity [m].
    name
        Name of its wall in results; default "ball".
    """

    kind: Literal["ball"] = "ball"
    position: Lengths = (0.0, 0.0, 0.0)

    def solids(self, cavity: Cavity) -> list[Solid]:
        """Return the ball."""
        return [Ball(self.label, np.array(self.position), np.array([self.radius, 0.0, 0.0]))]

    def words(self) -> str:
        """Return a phrase with the diameter."""
        return f"a fixed ball, {amount(2 * self.radius, 'm')} in diameter"


class MeshBody(TriangleSurface, Body):
    """A body with a closed surface of triangles, from a file or arrays.

    Parameters
    ----------
    file
        STL, OBJ, PLY or OFF file, or a STEP file, which states its unit.
    unit
        Unit of the coordinates, such as "mm"; it is never assumed.
    vertices, faces
        Corners, (n, 3), and numbers of the three corners of each triangle, (m, 3), in place of a file.
    position
        Centre of its bounding box, relative to the centre of the cavity [m].
    smooth_angle
        Largest angle between the normals of two triangles that approximate one curved surface [rad].
    name
        Name of its wall in results; default "mesh".
    """

    kind: Literal["mesh"] = "mesh"
    position: Lengths = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _has_one_shell(self) -> MeshBody:
        if self.triangles.shells > 1:
            raise Hint(
                f"the surface of a body has {self.triangles.shells} shells", "one file for each body", [self.where]
            )
        return self

    def solids(self, cavity: Cavity) -> list[Solid]:
        """Return the surface."""
        corners = self.triangles.vertices
        middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
        faces = np.ascontiguousarray(self.triangles.faces[:, ::-1])
        placed = corners - middle + np.array(self.position)
        return [TriangleMesh(self.label, vertices=placed, faces=faces, smooth=self.smooth)]

    def words(self) -> str:
        """Return a phrase with the bounding box."""
        return surface_words("a body", np.ptp(self.triangles.vertices, axis=0), len(self.triangles.faces))

    def notes(self) -> Iterator[str]:
        """Yield what was changed or assumed."""
        return surface_notes(self)


class BodyArray(Body):
    """Base class of arrays of equal bodies, which are one wall."""

    kind: str
    body: AnyBody = Field(examples=[{"kind": "rod", "diameter": "4 mm"}])
    count: Annotated[Whole, Field(ge=1, le=MOST_BODIES)] = Field(examples=[6])

    @property
    def label(self) -> str:
        """The name, or that of the body."""
        return self.name or self.body.label

    @property
    def number(self) -> int:
        """That of the body, times the count."""
        return self.count * self.body.number

    @property
    def digest(self) -> str:
        """Text that differs for other bodies."""
        return f"{super().digest} {self.body.digest}"

    def words(self) -> str:
        """Return a phrase with the number."""
        return f"a {self.kind} of {self.count} bodies, each {self.body.words()}"

    def notes(self) -> Iterator[str]:
        """Yield those of the body."""
        return self.body.notes()


class BodyRing(BodyArray):
    """Equal bodies on a circle, turned with it.

    Parameters
    ----------
    body
        The body, with its position relative to the place on the circle.
    count
        Number of bodies.
    radius
        Radius of the circle [m].
    axis
        Axis of the circle through `position`.
    angle
        Angle of the first body [rad].
    position
        Centre of the circle, relative to that of the cavity [m].
    name
        Name of the wall of all of them; default that of the body.
    """

    kind: Literal["ring"] = "ring"
    radius: PositiveLength
    axis: Direction = "z"
    angle: Angle = 0.0
    position: Lengths = (0.0, 0.0, 0.0)

    def solids(self, cavity: Cavity) -> list[Solid]:
        """Return all bodies."""
        frame = frame_along(self.axis)
        result = []
        for k in range(self.count):
            turn = turned(frame, self.angle + 2 * math.pi * k / self.count)
            shift = np.array(self.position) + self.radius * (frame[0] @ turn)
            result += [each.moved(shift, turn) for each in self.body.solids(cavity)]
        return _named(result, self.label)


class BodyRow(BodyArray):
    """Equal bodies in a row; a row of rows is a grid.

    Parameters
    ----------
    body
        The body, with its position relative to its place in the row.
    count
        Number of bodies.
    step
        Distance from one to the next along x, y and z [m].
    position
        Middle of the row, relative to the centre of the cavity [m].
    name
        Name of the wall of all of them; default that of the body.
    """

    kind: Literal["row"] = "row"
    step: Lengths
    position: Lengths = (0.0, 0.0, 0.0)

    def solids(self, cavity: Cavity) -> list[Solid]:
        """Return all bodies."""
        one = self.body.solids(cavity)
        places = (np.arange(self.count) - 0.5 * (self.count - 1))[:, None] * np.array(self.step)
        return _named([each.moved(place + np.array(self.position)) for place in places for each in one], self.label)


class BodyCross(Body):
    """Plates through a common axis, such as a cross of two, which divide a cavity into sectors.

    Parameters
    ----------
    thickness
        Thickness of the plates [m].
    count
        Number of plates; 2 for a cross.
    width, length
        Lengths across and along the axis [m]; by default they go through the whole cavity.
    axis
        Common axis of the plates.
    angle
        Angle of the first plate [rad].
    position
        Centre of the cross, relative to that of the cavity [m].
    name
        Name of its wall in results; default "cross".
    """

    kind: Literal["cross"] = "cross"
    thickness: PositiveLength
    count: Annotated[Whole, Field(ge=1, le=MOST_BODIES)] = 2
    width: PositiveLength | None = None
    length: PositiveLength | None = None
    axis: Direction = "z"
    angle: Angle = 0.0
    position: Lengths = (0.0, 0.0, 0.0)

    def solids(self, cavity: Cavity) -> list[Solid]:
        """Return the plates."""
        frame = frame_along(self.axis)
        length = _through(cavity, self.axis) if self.length is None else self.length
        # As wide as the cavity is across the axis in any direction.
        width = 2 * float(np.linalg.norm(cavity.lengths)) if self.width is None else self.width
        half = np.array([width / 2, self.thickness / 2, length / 2])
        angles = (self.angle + math.pi * k / self.count for k in range(self.count))
        return [Plate(self.label, np.array(self.position), half, frame @ turned(frame, angle)) for angle in angles]

    def words(self) -> str:
        """Return a phrase with the number of plates and their thickness."""
        return f"a cross of {counted(self.count, 'plate')}, {amount(self.thickness, 'm')} thick"


class Honeycomb(Body):
    """Walls of hexagonal cells around a central one.

    Parameters
    ----------
    cell
        Distance between the middles of two opposite walls of a cell [m].
    thickness
        Thickness of the walls [m].
    rings
        Rings of cells around the central one: 0 for one cell, 1 for 7, 2 for 19.
    length
        Length along the axis [m]; by default through the whole cavity.
    axis
        Axis of the cells.
    position
        Centre of the central cell, relative to that of the cavity [m].
    name
        Name of its wall in results; default "honeycomb".
    """

    kind: Literal["honeycomb"] = "honeycomb"
    cell: PositiveLength
    thickness: PositiveLength
    rings: Annotated[Whole, Field(ge=0, le=30)] = 1
    length: PositiveLength | None = None
    axis: Direction = "z"
    position: Lengths = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _has_cells(self) -> Honeycomb:
        if self.thickness >= self.cell:
            raise Hint("the walls are as thick as a cell is wide", "thinner walls, or wider cells", ["thickness"])
        return self

    def centres(self) -> Vector:
        """Return the centres of the cells in the plane across the axis, (n, 2) [m]."""
        steps = [
            (a, b)
            for a in range(-self.rings, self.rings + 1)
            for b in range(-self.rings, self.rings + 1)
            if abs(a + b) <= self.rings
        ]
        return np.array(steps, float) @ (self.cell * np.array([[1.0, 0.0], [0.5, math.sqrt(0.75)]]))

    def solids(self, cavity: Cavity) -> list[Solid]:
        """Return a plate for each wall."""
        frame = frame_along(self.axis)
        length = _through(cavity, self.axis) if self.length is None else self.length
        # The walls reach into each other at the joints, so that no gap is left.
        half = np.array([self.cell / math.sqrt(3) / 2, self.thickness / 2, length / 2])
        angles = np.arange(6) * math.pi / 3
        result: list[Solid] = []
        middles = self.centres()[:, None] + 0.5 * self.cell * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        _, first = np.unique(np.round(middles.reshape(-1, 2) / (1e-6 * self.cell)), axis=0, return_index=True)
        for k in np.sort(first):
            axes = frame @ turned(frame, float(angles[k % 6]) + math.pi / 2)
            centre = np.array(self.position) + middles.reshape(-1, 2)[k] @ frame[:2]
            result.append(Plate(self.label, centre, half, axes))
        return result

    def words(self) -> str:
        """Return a phrase with the number and width of the cells."""
        cells = counted(len(self.centres()), "cell")
        return f"a honeycomb of {cells}, {amount(self.cell, 'm')} wide, walls {amount(self.thickness, 'm')} thick"


AnyBody = Annotated[Body, AnyKind()]


def _through(cavity: Cavity, axis: str | tuple[float, float, float]) -> float:
    return cavity.extent(unit_vector(axis))


def _named(solids: Sequence[Solid], name: str) -> list[Solid]:
    return [replace(each, name=name) for each in solids]


def bodies_words(bodies: Sequence[Body]) -> str:
    """Return a phrase about the bodies in a cavity: "with a rod, 6 mm in diameter, inside"."""
    return f"with {' and '.join(each.words() for each in bodies)} inside"
