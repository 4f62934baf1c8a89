"""Solids in a cavity: rods, plates, balls and closed surfaces of triangles, placed relative to its centre."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from rattlebox.core import _core

from .elementwise import Vector
from .space import to_global
from .surfaces import Surface, bands, circle, facing_inward

SMOOTH = 0.9  # cosine of the largest angle between normals at a smooth edge
_SAMPLES = 2**18, 2**22  # points by which the share of a solid in a cavity is computed, and those of all together
_AROUND, _LATITUDES = 36, 17  # corners of drawn rods and balls
_SPREAD = 1.2207440846057596  # of the sequence in `Cavity.spread`


@dataclass(frozen=True, eq=False)
class Solid(ABC):
    """A body in a cavity, which is one wall with its name; a surface of triangles may have several walls."""

    form: ClassVar[_core.SolidForm]
    hides_centres: ClassVar[bool] = False  # whether a sphere whose centre is beyond the surface has no contact with it

    name: str
    centre: Vector  # from the centre of the cavity [m], (3,)
    size: Vector  # [m], (3,)
    axes: Vector = field(default_factory=lambda: np.eye(3))  # unit vectors in the rows, (3, 3)

    @property
    @abstractmethod
    def volume(self) -> float:
        """Volume of the body, or between a surface and its bodies [m^3]."""

    @property
    @abstractmethod
    def area(self) -> float:
        """Area of the surface [m^2]."""

    @property
    @abstractmethod
    def bounds(self) -> tuple[Vector, Vector]:
        """Lowest and highest coordinates [m], (3,) each."""

    @abstractmethod
    def surface(self) -> Surface:
        """Return polygons that face the particles, for pictures, files and drawings."""

    @abstractmethod
    def filled(self, share: Vector) -> Vector:
        """Return points along the axes [m] that fill the body as evenly as `share`, (n, 3), fills the unit cube."""

    def fitted(self, points: Vector, outward: Vector) -> tuple[Vector, Vector]:
        """Return points of drawn facets, which are chords of a round surface, and their normals, fitted to the surface."""
        return points, outward

    @property
    def walls(self) -> tuple[str, ...]:
        """Names of its walls."""
        return (self.name,)

    @property
    def wall_areas(self) -> Vector:
        """Area of each of its walls, (w,) [m^2]."""
        return np.array([self.area])

    def moved(self, shift: Vector, frame: Vector | None = None) -> Self:
        """Return the solid turned, if the axes of another frame are given in rows, and then shifted."""
        turned = np.eye(3) if frame is None else frame
        return replace(self, centre=to_global(self.centre[None], turned)[0] + shift, axes=to_global(self.axes, turned))

    def packed(self, materials: Sequence[int], labels: Sequence[int]) -> _core.Solid:
        """Return the solid for the core, with the indices of the material and of the name of each of its walls."""
        return _core.Solid(
            form=self.form,
            materials=np.array(materials, np.int64),
            labels=np.array(labels, np.int64),
            centre=np.ascontiguousarray(self.centre),
            size=np.ascontiguousarray(self.size),
            axes=np.ascontiguousarray(self.axes),
            vertices=np.zeros((0, 3)),
            faces=np.zeros((0, 3), np.int64),
            smooth=SMOOTH,
            groups=np.zeros(0, np.int64),
            encloses=False,
        )

    def samples(self, solids: int) -> Vector:
        """Return points that fill one of several bodies evenly, (n, 3) [m]; see `Cavity.spread` for the sequence."""
        count = min(_SAMPLES[0], _SAMPLES[1] // solids)
        share = (np.arange(count)[:, None] * _SPREAD ** -np.arange(1.0, 4.0) + 0.5) % 1.0
        return to_global(self.filled(share), self.axes) + self.centre

    def surface_samples(self, count: int) -> tuple[Vector, Vector]:
        """Return points that cover the surface evenly, (count, 3) [m], and the normals there, out of the body."""
        return self.fitted(*self.surface().spread(count))

    def is_within(self, points: Vector) -> NDArray[np.bool_]:
        """Return whether points are in the body, where there are no particles, (n,)."""
        return np.asarray((Solids((self,)).distances(points) < 0).any(axis=1))

    def _placed(self, corners: Vector, polygons: Sequence[tuple[int, ...]]) -> Surface:
        """Return the outer side of a convex body with corners along its axes."""
        around = facing_inward(corners, polygons)
        outside = tuple(polygon[::-1] for polygon in around.polygons)
        return Surface(to_global(around.points, self.axes) + self.centre, outside)


class Rod(Solid):
    """A circular rod along the third axis; sizes: its radius and half of its length."""

    form = _core.SolidForm.rod

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return 2 * math.pi * float(self.size[0] ** 2 * self.size[1])

    @property
    def area(self) -> float:
        """Area of the surface [m^2]."""
        return 2 * math.pi * float(self.size[0] * (2 * self.size[1] + self.size[0]))

    @property
    def bounds(self) -> tuple[Vector, Vector]:
        """Lowest and highest coordinates [m], (3,) each."""
        half = np.abs(self.axes).T @ self.size[[0, 0, 1]]
        return self.centre - half, self.centre + half

    def surface(self) -> Surface:
        """Return the ends, and a band of rectangles."""
        ring, up = self.size[0] * circle(_AROUND), np.array([0.0, 0.0, self.size[1]])
        ends = (tuple(range(_AROUND)), tuple(range(_AROUND, 2 * _AROUND)))
        return self._placed(np.concatenate([ring - up, ring + up]), (*bands(2, _AROUND), *ends))

    def filled(self, share: Vector) -> Vector:
        """Return points in the rod."""
        return _around(
            2 * np.pi * share[:, 0], self.size[0] * np.sqrt(share[:, 1]), (2 * share[:, 2] - 1) * self.size[1]
        )

    def fitted(self, points: Vector, outward: Vector) -> tuple[Vector, Vector]:
        """Return the points with those that are not at the ends on the round surface."""
        along = self.axes[2]
        is_round = np.abs(outward @ along) < 0.5
        spoke = points[is_round] - self.centre
        spoke -= (spoke @ along)[:, None] * along
        outward[is_round] = spoke / np.linalg.norm(spoke, axis=1)[:, None]
        points[is_round] += self.size[0] * outward[is_round] - spoke
        return points, outward


class Plate(Solid):
    """A plate or block; sizes: half of its edges."""

    form = _core.SolidForm.plate

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return 8 * float(np.prod(self.size))

    @property
    def area(self) -> float:
        """Area of the surface [m^2]."""
        return 8 * float(self.size @ np.roll(self.size, 1))

    @property
    def bounds(self) -> tuple[Vector, Vector]:
        """Lowest and highest coordinates [m], (3,) each."""
        half = np.abs(self.axes).T @ self.size
        return self.centre - half, self.centre + half

    def surface(self) -> Surface:
        """Return the six faces."""
        corners = np.array([(i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) * self.size
        faces = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
        return self._placed(corners, faces)

    def filled(self, share: Vector) -> Vector:
        """Return points in the plate."""
        return (2 * share - 1) * self.size


class Ball(Solid):
    """A ball; the first size is its radius."""

    form = _core.SolidForm.ball

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return 4 / 3 * math.pi * float(self.size[0] ** 3)

    @property
    def area(self) -> float:
        """Area of the surface [m^2]."""
        return 4 * math.pi * float(self.size[0] ** 2)

    @property
    def bounds(self) -> tuple[Vector, Vector]:
        """Lowest and highest coordinates [m], (3,) each."""
        return self.centre - self.size[0], self.centre + self.size[0]

    def surface(self) -> Surface:
        """Return bands along circles of latitude, and a cap of triangles at each pole."""
        angles = np.linspace(-np.pi / 2, np.pi / 2, _LATITUDES + 2)[1:-1]
        up = np.array([0.0, 0.0, 1.0])
        rings = [self.size[0] * (np.cos(each) * circle(_AROUND) + np.sin(each) * up) for each in angles]
        last, south = (_LATITUDES - 1) * _AROUND, _LATITUDES * _AROUND
        turn = [(k, (k + 1) % _AROUND) for k in range(_AROUND)]
        caps = [(a, b, south) for a, b in turn] + [(last + a, last + b, south + 1) for a, b in turn]
        points = np.concatenate([*rings, self.size[0] * np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])])
        return self._placed(points, (*bands(_LATITUDES, _AROUND), *caps))

    def filled(self, share: Vector) -> Vector:
        """Return points in the ball."""
        distance, slope = self.size[0] * np.cbrt(share[:, 1]), 2 * share[:, 2] - 1
        return _around(2 * np.pi * share[:, 0], distance * np.sqrt(1 - slope**2), distance * slope)

    def fitted(self, points: Vector, outward: Vector) -> tuple[Vector, Vector]:
        """Return all points on the sphere."""
        spoke = points - self.centre
        radial = spoke / np.linalg.norm(spoke, axis=1)[:, None]
        return points + (self.size[0] * radial - spoke), radial


@dataclass(frozen=True, eq=False)
class TriangleMesh(Solid):
    """A closed surface of triangles, of which each group is a wall."""

    form = _core.SolidForm.mesh
    hides_centres = True

    centre: Vector = field(default_factory=lambda: np.zeros(3))
    size: Vector = field(default_factory=lambda: np.zeros(3))
    # Corners [m], (n, 3), and triangles whose normals point out of the space of the particles, (m, 3)
    vertices: Vector = field(kw_only=True)
    faces: NDArray[np.int64] = field(kw_only=True)
    smooth: float = field(default=SMOOTH, kw_only=True)  # cosine of the largest angle between normals at a smooth edge
    encloses: bool = field(default=False, kw_only=True)  # whether the surface is the cavity
    # Names of its walls, and the number of that of each triangle, (m,); none if it is one wall
    groups: tuple[str, ...] = field(default=(), kw_only=True)
    group: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64), kw_only=True)

    @property
    def volume(self) -> float:
        """Volume between the surface and its bodies [m^3]."""
        corners = self.vertices[self.faces]
        return abs(float(np.sum(corners[:, 0] * np.cross(corners[:, 1], corners[:, 2])))) / 6

    @property
    def area(self) -> float:
        """Area of the triangles [m^2]."""
        return float(self._areas().sum())

    @property
    def bounds(self) -> tuple[Vector, Vector]:
        """Lowest and highest coordinates [m], (3,) each."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    def surface(self) -> Surface:
        """Return the triangles, which face the particles: against the normals, which point away from them."""
        return Surface(self.vertices, tuple((int(a), int(c), int(b)) for a, b, c in self.faces))

    def filled(self, share: Vector) -> Vector:
        """Return points in the surface: those of its bounding box that are within."""
        low, high = self.bounds
        points = low + share * (high - low)
        return np.asarray(points[self.is_within(points)])

    @property
    def walls(self) -> tuple[str, ...]:
        """Names of its walls."""
        return self.groups or (self.name,)

    @property
    def wall_areas(self) -> Vector:
        """Area of each of its walls, (w,) [m^2]."""
        if not self.groups:
            return np.array([self.area])
        return np.asarray(np.bincount(self.group, self._areas(), len(self.groups)), np.float64)

    def _areas(self) -> Vector:
        """Return the areas of the triangles, (m,) [m^2]."""
        return np.asarray(0.5 * np.linalg.norm(face_normals(self.vertices, self.faces), axis=1))

    def moved(self, shift: Vector, frame: Vector | None = None) -> TriangleMesh:
        """Return the surface turned, if the axes of another frame are given in rows, and then shifted."""
        turned = np.eye(3) if frame is None else frame
        return replace(self, vertices=to_global(self.vertices, turned) + shift)

    def packed(self, materials: Sequence[int], labels: Sequence[int]) -> _core.Solid:
        """Return the surface for the core, with the indices of the material and of the name of each of its walls."""
        return (
            super()
            .packed(materials, labels)
            .replace(
                vertices=np.ascontiguousarray(self.vertices),
                faces=np.ascontiguousarray(self.faces),
                smooth=self.smooth,
                groups=np.ascontiguousarray(self.group),
                encloses=self.encloses,
            )
        )


@dataclass(frozen=True, eq=False)
class Solids:
    """The solids of a cavity."""

    each: tuple[Solid, ...] = ()

    @cached_property
    def _surfaces(self) -> _core.Surfaces:
        return _core.Surfaces([solid.packed(none := [0] * len(solid.walls), none) for solid in self.each])

    def distances(self, positions: Vector) -> Vector:
        """Return the distances of points from the walls of the solids, (n, w) [m], positive where particles may be.

        They are infinite for walls of a surface of which another one is nearer.
        """
        if not self.each:
            return np.zeros((len(positions), 0))
        return np.asarray(self._surfaces.distances(np.ascontiguousarray(positions, dtype=np.float64)))

    def contacts(self, positions: Vector, radii: Vector) -> tuple[NDArray[np.int64], Vector, Vector]:
        """Return the contacts of spheres as a run has them: number of the sphere, outward normal, and distance [m]."""
        found = self._surfaces.contacts(
            np.ascontiguousarray(positions, dtype=np.float64), np.ascontiguousarray(radii, dtype=np.float64)
        )
        return np.asarray(found.point), np.asarray(found.normal), np.asarray(found.distance)


def face_normals(vertices: Vector, faces: NDArray[np.int64]) -> Vector:
    """Return normals of triangles whose lengths are twice their areas, (m, 3) [m^2]."""
    corners = vertices[faces]
    return np.asarray(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))


def _around(angle: Vector, radius: Vector, height: Vector) -> Vector:
    """Return points in cylindrical coordinates as components, (n, 3) [m]."""
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1)
