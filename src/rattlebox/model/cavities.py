"""Cavities of particle dampers: box, cylinder, sphere, with exact walls."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, WithJsonSchema, model_validator

from rattlebox._util.phrases import sizes
from rattlebox._util.quantities import amount

from .base import Part
from .elementwise import Vector
from .errors import Hint, nearest
from .round_part import RoundPart
from .solids import Solids
from .space import AXES, Direction, Lengths, components_along, to_global, unit_vector, wrapped
from .surfaces import Surface, bands, circle, facing_inward
from .units import PositiveLength

WallForm = Literal["plane", "cylinder", "sphere"]

# Corners of a cylinder's end, meridians and circles of latitude of a sphere: few, since their positions are stored at each
# time. The faces are inside the wall by up to 0.1 % of the radius of a cylinder and 0.8 % of that of a sphere.
_AROUND = 72
_MERIDIANS, _LATITUDES = 36, 17
_NO_SOLIDS = Solids()


@dataclass(frozen=True)
class Walls:
    """Walls around the centre of a cavity."""

    names: tuple[str, ...]  # Of the walls, then of the solids
    axis: Vector  # Outward normal of a plane, axis of a cylinder's side; zeros for a sphere, (w, 3)
    offset: Vector  # Distance of a plane from the centre, radius of a cylinder or a sphere [m], (w,)
    form: tuple[WallForm, ...]
    solids: Solids = _NO_SOLIDS  # Bodies and surfaces of triangles

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the walls, each once: walls of the same name are one face."""
        return tuple(dict.fromkeys(self.names))

    @property
    def label_numbers(self) -> NDArray[np.int64]:
        """Index of the name of each wall in `labels`, (w,)."""
        number = {name: k for k, name in enumerate(self.labels)}
        return np.array([number[name] for name in self.names], np.int64)

    def distances(self, positions: Vector) -> Vector:
        """Return the distances of points from the walls and solids, (n, w) [m], positive inside."""
        result = np.empty((len(positions), len(self.names)))
        for k, (axis, offset, form) in enumerate(zip(self.axis, self.offset, self.form, strict=True)):
            along = components_along(positions, axis)
            if form != "plane":
                square = np.einsum("ij,ij->i", positions, positions)
                along = np.sqrt(np.maximum(square - along**2, 0.0))
            result[:, k] = offset - along
        if self.solids.each:
            result[:, self.offset.size :] = self.solids.distances(positions)
        return result

    def with_lid(self, up: Vector, level: float) -> Walls:
        """Return the walls with a plane at a level above the centre [m]."""
        plain = self.offset.size
        return Walls(
            (*self.names[:plain], "lid", *self.names[plain:]),
            np.vstack([self.axis, up]),
            np.append(self.offset, level),
            (*self.form, "plane"),
            self.solids,
        )


class Cavity(Part):
    """Base class of cavities; positions are relative to the centre."""

    field_names: ClassVar[tuple[str, ...]] = ("cavity",)
    kinds: ClassVar[dict[str, type[Part]]] = {}
    kind: str

    @abstractmethod
    def walls(self) -> Walls:
        """Return the walls."""

    @property
    @abstractmethod
    def volume(self) -> float:
        """Volume inside [m^3]."""

    @property
    @abstractmethod
    def lengths(self) -> Vector:
        """Edges of the bounding box along the axes of the cavity, (3,) [m]."""

    @property
    @abstractmethod
    def inside(self) -> Vector:
        """Edges of an inscribed box along the axes of the cavity, (3,) [m]."""

    @abstractmethod
    def surface(self) -> Surface:
        """Return the walls as polygons, for pictures, files and drawings."""

    @abstractmethod
    def words(self) -> str:
        """Return a phrase with the sizes: "a box of 100 x 70 x 60 mm"."""

    def short_label(self) -> str:
        """Return the phrase with the sizes, without its article."""
        return self.words().removeprefix("a ")

    def outline(self, view: Vector) -> list[Vector]:
        """Return the lines that show the cavity, each (n, 3) [m], for the axes (right, up, towards the viewer) of a view."""
        return self.surface().lines(view[2])

    @property
    def face_areas(self) -> Vector:
        """Area of each face, in the order of `walls().labels`, (f,) [m^2]; by default from the polygons of the surface."""
        walls, surface = self.walls(), self.surface()
        areas = np.zeros(len(walls.labels))
        centres = np.array([surface.points[list(polygon)].mean(axis=0) for polygon in surface.polygons])
        nearest = walls.label_numbers[np.abs(walls.distances(centres)).argmin(axis=1)]
        np.add.at(areas, nearest, surface.areas)
        return areas

    @property
    def period(self) -> Vector:
        """Distance of the images of a particle along x, y and z, (3,) [m]; 0 along an axis that is not periodic."""
        return np.zeros(3)

    def wrapped(self, positions: Vector) -> Vector:
        """Return positions with those of the images inside, (n, 3) [m]; only a periodic cavity has images."""
        return positions

    def face_instead(self, name: str, labels: Sequence[str]) -> str:
        """Return advice for a face that does not exist; by default the nearest name."""
        return nearest(name, labels)

    def check_faces(self, names: Iterable[str]) -> None:
        """Raise unless the cavity has faces of these names."""
        labels = self.walls().labels
        for name in names:
            if name not in labels:
                what = f"a {self.kind} has no face {name!r}"
                raise Hint(f"{what}; its faces are {', '.join(labels)}", self.face_instead(name, labels), [name])

    @property
    def frame(self) -> Vector:
        """Axes of the cavity, (3, 3), one in each row."""
        return np.eye(3)

    @property
    def is_aligned(self) -> bool:
        """Whether the axes of the cavity are along x, y and z, in any order."""
        return bool(np.all(np.abs(self.frame).max(axis=1) >= 1 - 1e-9))

    def depth(self, positions: Vector) -> Vector:
        """Return the distances of points from the nearest wall, (n,) [m], positive inside."""
        return np.asarray(self.walls().distances(positions).min(axis=1))

    def nearest_wall(self, positions: Vector) -> NDArray[np.intp]:
        """Return the index of the wall that is nearest to each point, (n,)."""
        return np.asarray(self.walls().distances(positions).argmin(axis=1))

    def room(self, positions: Vector, radii: Vector) -> Vector:
        """Return the distances of the surfaces of spheres from the nearest wall, (n,) [m], positive inside."""
        return np.asarray(self.depth(positions) - radii)

    def overlaps(self, shifts: Vector, tolerance: float) -> NDArray[np.bool_]:
        """Return whether the cavity and its copies moved by shifts, (n, 3) [m], overlap by more than a tolerance, (n,)."""
        # Two copies of a convex shape that is symmetric about its centre overlap if the middle between them is in both.
        return np.asarray(2 * self.depth(0.5 * shifts) > tolerance)

    def notes(self, radius: float) -> Iterator[str]:
        """Yield notes, and warnings that begin with "warning: ", on its surface and on the room for spheres."""
        yield from ()

    @property
    def widest(self) -> float:
        """Upper bound of the diameter of a sphere inside [m]."""
        return float(self.lengths.min())

    @property
    def digest(self) -> str:
        """Text that differs for cavities with other walls."""
        return self.model_dump_json()

    def extent(self, direction: Vector) -> float:
        """Return the width of the cavity along a unit vector u [m]; that of a box is the sum of abs(u_i) times its edges."""
        return float(np.sum(np.abs(components_along(self.frame, direction)) * self.lengths))

    @property
    def surface_over_volume(self) -> float:
        """Area of the walls over the volume [1/m]."""
        return 2 * float(np.sum(1 / self.lengths))

    def spread(self, count: int) -> Vector:
        """Return evenly spread points inside, (n, 3) [m]; n is `count` times the share of the bounding box inside.

        Notes
        -----
        The points k * (1/g, 1/g^2, 1/g^3) modulo 1, with g^4 = g + 1 and k = 0, 1, ..., are a Kronecker sequence. They fill
        the bounding box more evenly than random ones: the share of points in a part of the cavity has an error of about 1e-4
        for 1e5 of them.

        References
        ----------
        H. Niederreiter (1992), Random Number Generation and Quasi-Monte Carlo Methods, SIAM, section 3.1,
        doi:10.1137/1.9781611970081.

        M. Roberts (2018), The unreasonable effectiveness of quasirandom sequences, extremelearning.com.au (choice of g).
        """
        steps = _SPREAD ** -np.arange(1.0, 4.0)
        points = to_global(((np.arange(count)[:, None] * steps + 0.5) % 1.0 - 0.5) * self.lengths, self.frame)
        return np.asarray(points[self.depth(points) >= 0])


_SPREAD = 1.2207440846057596  # g^4 = g + 1

_PERIODIC = WithJsonSchema(
    {
        "enum": ["", "x", "y", "z", "xy", "xz", "yz"],
        "description": "axes along which particles leave through one face and enter through the opposite one",
        "examples": ["xy"],
    }
)


def _periodic(value: object) -> Any:
    """Return the periodic axes of a box as a text in alphabetical order."""
    axes = "".join(map(str, value)) if isinstance(value, (list, tuple)) else value
    if not isinstance(axes, str) or not set(axes.replace(",", "").replace(" ", "")) <= set(AXES):
        raise Hint("the periodic directions of a box are axes: one or two of x, y and z", '"x" or "xy"')
    given = axes.replace(",", "").replace(" ", "")
    if len(set(given)) != len(given):
        raise Hint("an axis is named twice", f'"{"".join(sorted(set(given)))}"')
    if len(given) == len(AXES):
        raise Hint(
            "a box that is periodic along x, y and z has no wall, so that no force acts on the structure", '"xy"'
        )
    return "".join(sorted(given))


class Box(Cavity):
    """A box with edges along x, y and z.

    Parameters
    ----------
    size
        Inner lengths [m].
    periodic
        Directions without walls, "x" or "xy" for example: a particle that leaves through one face enters through the
        opposite one, as in a slice of a much wider bed. The edges along them are more than two diameters long.

    Examples
    --------
    >>> import rattlebox as rb
    >>> print(f"{1e6 * rb.Box(size=('30 mm', '30 mm', '25 mm')).volume:.1f} cm^3")
    22.5 cm^3
    """

    kind: Literal["box"] = "box"
    size: Lengths
    periodic: Annotated[str, BeforeValidator(_periodic), _PERIODIC] = ""

    @model_validator(mode="after")
    def _has_size(self) -> Box:
        for index, length in enumerate(self.size):
            if not length > 0:
                raise Hint(
                    "must be greater than zero", 'three lengths, such as ("20 mm", "20 mm", "30 mm")', ["size", index]
                )
        return self

    def walls(self) -> Walls:
        """Return six planes, without those of periodic directions."""
        solid = [k for k, axis in enumerate(AXES) if axis not in self.periodic]
        axis = np.concatenate([-np.eye(3)[solid], np.eye(3)[solid]])
        names = tuple(sign + AXES[k] for sign in "-+" for k in solid)
        plane: WallForm = "plane"
        return Walls(names, axis, np.tile(self.lengths[solid] / 2, 2), (plane,) * len(names))

    @property
    def face_areas(self) -> Vector:
        """Area of each face, (f,) [m^2]."""
        return np.array([self.volume / self.size[AXES.index(name[-1])] for name in self.walls().labels])

    @property
    def period(self) -> Vector:
        """Edges along periodic directions, (3,) [m]; 0 along the others."""
        return np.array(
            [length if axis in self.periodic else 0.0 for axis, length in zip(AXES, self.size, strict=True)]
        )

    def check_faces(self, names: Iterable[str]) -> None:
        """Raise unless the box has faces of these names, which are not periodic."""
        names = list(names)
        for name in names:
            if self.periodic and name[-1:] in self.periodic and name[:-1] in ("-", "+"):
                raise Hint(
                    f"the face {name} has no wall, since the box is periodic along {name[-1]}",
                    f"no wall at {name}, or no {name[-1]} in periodic",
                    [name],
                )
        super().check_faces(names)

    def wrapped(self, positions: Vector) -> Vector:
        """Return positions with those of the images inside, from minus to plus half of the edge, (n, 3) [m]."""
        return wrapped(positions, self.period)

    def overlaps(self, shifts: Vector, tolerance: float) -> NDArray[np.bool_]:
        """Return whether the box and its copies overlap; periodic ones end at their faces, too."""
        return np.asarray(np.all(np.abs(shifts) < self.lengths - tolerance, axis=1))

    @property
    def surface_over_volume(self) -> float:
        """Area of the walls over the volume [1/m]."""
        return 2 * float(np.sum(1 / self.lengths[self.period == 0]))

    def surface(self) -> Surface:
        """Return six faces."""
        corners = np.array([(i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        faces = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
        return facing_inward(corners * self.lengths / 2, faces)

    def words(self) -> str:
        """Return a phrase with the three edges."""
        along = " and ".join(self.periodic)
        return f"a box of {sizes(self.size)}" + (f", periodic along {along}" if along else "")

    @property
    def volume(self) -> float:
        """Volume inside [m^3]."""
        return math.prod(self.size)

    @property
    def lengths(self) -> Vector:
        """Edges, (3,) [m]."""
        return np.array(self.size)

    @property
    def inside(self) -> Vector:
        """Edges, (3,) [m]."""
        return self.lengths


class PlaneCavity(Cavity):
    """Base class of convex cavities between planes; a shape defines its walls and words, and the rest follows."""

    kind: str

    @cached_property
    def _polyhedron(self) -> Surface:
        """Faces, from the half-spaces inside of the walls."""
        from scipy.spatial import HalfspaceIntersection  # only for shapes that users add

        walls = self.walls()
        corners = HalfspaceIntersection(np.column_stack([walls.axis, -walls.offset]), np.zeros(3)).intersections
        # A corner of more than three planes is found once for each three of them.
        size = float(np.abs(corners).max())
        _, first = np.unique(np.round(corners / (1e-9 * size)), axis=0, return_index=True)
        corners = corners[np.sort(first)]
        faces = []
        for axis, offset in zip(walls.axis, walls.offset, strict=True):
            (on,) = np.nonzero(np.abs(components_along(corners, axis) - offset) < 1e-9 * size)
            if on.size > 2:
                spokes = corners[on] - corners[on].mean(axis=0)
                angles = np.arctan2(
                    components_along(spokes, np.cross(axis, spokes[0])), components_along(spokes, spokes[0])
                )
                faces.append(tuple(on[np.argsort(angles)].tolist()))
        return facing_inward(corners, faces)

    def surface(self) -> Surface:
        """Return a polygon for each plane."""
        return self._polyhedron

    @property
    def volume(self) -> float:
        """Volume inside [m^3], of the pyramids over the faces."""
        return self._polyhedron.volume

    @property
    def lengths(self) -> Vector:
        """Edges of the box around the centre that holds all corners, (3,) [m]."""
        return np.asarray(2 * np.abs(self._polyhedron.points).max(axis=0))

    @property
    def inside(self) -> Vector:
        """Edges of the largest box of the proportions of `lengths` around the centre, (3,) [m]."""
        walls = self.walls()
        reach = components_along(np.abs(walls.axis), self.lengths / 2)
        return np.asarray(self.lengths * float((walls.offset / reach).min()))

    @property
    def surface_over_volume(self) -> float:
        """Area of the walls over the volume [1/m]."""
        return self._polyhedron.area / self.volume


class Cylinder(RoundPart, Cavity):
    """A circular cylinder with flat ends.

    Parameters
    ----------
    radius, diameter
        One of them [m].
    length
        Inner length along the axis [m].
    axis
        "x", "y", "z" or three components; gravity usually acts along z.

    Examples
    --------
    >>> import rattlebox as rb
    >>> print(f"{1e6 * rb.Cylinder(diameter='40 mm', length='60 mm', axis='x').volume:.1f} cm^3")
    75.4 cm^3
    """

    kind: Literal["cylinder"] = "cylinder"
    length: PositiveLength
    axis: Direction = "z"

    def walls(self) -> Walls:
        """Return the side and the two ends."""
        along = unit_vector(self.axis)
        offset = np.array([self.radius, self.length / 2, self.length / 2])
        return Walls(
            ("side", "first end", "last end"),
            np.array([along, -along, along]),
            offset,
            ("cylinder", "plane", "plane"),
        )

    @property
    def face_areas(self) -> Vector:
        """Area of the side and of each end, (3,) [m^2]."""
        end = math.pi * self.radius**2
        return np.array([2 * math.pi * self.radius * self.length, end, end])

    def surface(self) -> Surface:
        """Return the side, of `_AROUND` faces, and the flat ends."""
        ring, up = self.radius * circle(_AROUND), np.array([0.0, 0.0, self.length / 2])
        points = np.concatenate([ring - up, ring + up])
        ends = (tuple(range(_AROUND)), tuple(range(_AROUND, 2 * _AROUND)))
        return facing_inward(points @ self.frame, (*bands(2, _AROUND), *ends))

    def words(self) -> str:
        """Return a phrase with diameter and length."""
        return f"a cylinder, {amount(2 * self.radius, 'm')} in diameter, {amount(self.length, 'm')} long"

    @property
    def volume(self) -> float:
        """Volume inside [m^3]."""
        return math.pi * self.radius**2 * self.length

    @property
    def lengths(self) -> Vector:
        """Diameter, diameter and length, (3,) [m]."""
        return np.array([2 * self.radius, 2 * self.radius, self.length])

    @property
    def inside(self) -> Vector:
        """Edges of a square in its cross-section, and length, (3,) [m]."""
        return np.array([math.sqrt(2) * self.radius, math.sqrt(2) * self.radius, self.length])

    @property
    def frame(self) -> Vector:
        """Two directions perpendicular to the axis, and the axis, (3, 3)."""
        along = unit_vector(self.axis)
        first = np.cross(np.eye(3)[np.abs(along).argmin()], along)
        first /= np.linalg.norm(first)
        return np.array([first, np.cross(along, first), along])

    def extent(self, direction: Vector) -> float:
        """Return the width of the cavity along a unit vector [m]."""
        along = unit_vector(self.axis)
        across = np.linalg.norm(np.cross(along, direction))
        return float(self.length * abs(np.sum(along * direction)) + 2 * self.radius * across)


class SphericalCavity(RoundPart, Cavity):
    """A hollow sphere.

    Parameters
    ----------
    radius, diameter
        One of them [m].
    """

    kind: Literal["sphere"] = "sphere"

    def walls(self) -> Walls:
        """Return the spherical wall."""
        return Walls(("sphere",), np.zeros((1, 3)), np.array([self.radius]), ("sphere",))

    @property
    def face_areas(self) -> Vector:
        """Area of the sphere, (1,) [m^2]."""
        return np.array([4 * math.pi * self.radius**2])

    def surface(self) -> Surface:
        """Return a grid of latitude and longitude."""
        angles = np.linspace(-np.pi / 2, np.pi / 2, _LATITUDES + 2)[1:-1]
        up = np.array([0.0, 0.0, 1.0])
        rings = [self.radius * (np.cos(each) * circle(_MERIDIANS) + np.sin(each) * up) for each in angles]
        last, south = (_LATITUDES - 1) * _MERIDIANS, _LATITUDES * _MERIDIANS
        turn = [(k, (k + 1) % _MERIDIANS) for k in range(_MERIDIANS)]
        caps = [(a, b, south) for a, b in turn] + [(last + a, last + b, south + 1) for a, b in turn]
        points = np.concatenate([*rings, [[0.0, 0.0, -self.radius], [0.0, 0.0, self.radius]]])
        return facing_inward(points, (*bands(_LATITUDES, _MERIDIANS), *caps))

    def outline(self, view: Vector) -> list[Vector]:
        """Return a circle, which is rounder than the edges of the surface."""
        ring = circle(_AROUND)
        return [self.radius * np.concatenate([ring, ring[:1]])[:, :2] @ view[:2]]

    def words(self) -> str:
        """Return a phrase with the diameter."""
        return f"a sphere, {amount(2 * self.radius, 'm')} in diameter"

    @property
    def volume(self) -> float:
        """Volume inside [m^3]."""
        return 4 / 3 * math.pi * self.radius**3

    @property
    def lengths(self) -> Vector:
        """Edges of the bounding cube, (3,) [m]."""
        return np.full(3, 2 * self.radius)

    def extent(self, direction: Vector) -> float:
        """Return the diameter [m]."""
        return 2 * self.radius

    @property
    def inside(self) -> Vector:
        """Edges of the inscribed cube, (3,) [m]."""
        return np.full(3, 2 * self.radius / math.sqrt(3))
