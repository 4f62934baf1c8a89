"""Solids in a cavity: rods, plates, balls and closed surfaces of triangles, placed relative to its centre."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rattlebox.core import _core

from .elementwise import Vector
from .space import to_global
from .surfaces import Surface, bands, circle, facing_inward

SolidForm = Literal["rod", "plate", "ball", "mesh"]

_SAMPLES = 2**18, 2**22  # points by which the share of a solid in a cavity is computed, and those of all together
_AROUND, _LATITUDES = 36, 17  # corners of drawn rods and balls
_SPREAD = 1.2207440846057596  # of the sequence in `Cavity.spread`


@dataclass(frozen=True, eq=False)
class Solid:
    """A body, which is one wall with a name, or a closed surface of triangles, of which each group is a wall."""

    name: str
    form: SolidForm
    centre: Vector  # Of a body, from the centre of the cavity [m], (3,)
    axes: Vector  # Unit vectors in the rows; the third is along a rod, (3, 3)
    size: Vector  # Half of the edges of a plate; radius and half of the length of a rod; radius of a ball [m], (3,)
    # Of a surface: corners [m], (n, 3), and triangles whose normals point out of the space of the particles, (m, 3)
    vertices: Vector
    faces: NDArray[np.int64]
    smooth: float = 0.9  # Cosine of the largest angle between normals at a smooth edge
    encloses: bool = False  # Whether the surface is the cavity
    # Names of the walls of a surface, and the number of that of each triangle, (m,); none if it is one wall
    groups: tuple[str, ...] = ()
    group: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))

    @property
    def walls(self) -> tuple[str, ...]:
        """Names of its walls."""
        return self.groups or (self.name,)

    @property
    def hides_centres(self) -> bool:
        """Whether a sphere whose centre is beyond the surface has no contact with it."""
        return self.form == "mesh"

    def moved(self, shift: Vector, frame: Vector | None = None) -> Solid:
        """Return the solid turned, if the axes of another frame are given in rows, and then shifted."""
        turned = np.eye(3) if frame is None else frame
        return replace(
            self,
            centre=to_global(self.centre[None], turned)[0] + shift,
            axes=to_global(self.axes, turned),
            vertices=to_global(self.vertices, turned) + shift,
        )

    def packed(self, materials: Sequence[int], labels: Sequence[int]) -> _core.Solid:
        """Return the solid for the core, with the indices of the material and of the name of each of its walls."""
        return _core.Solid(
            form=_core.SolidForm[self.form],
            materials=np.array(materials, np.int64),
            labels=np.array(labels, np.int64),
            groups=np.ascontiguousarray(self.group),
            encloses=self.encloses,
            smooth=self.smooth,
            centre=np.ascontiguousarray(self.centre),
            size=np.ascontiguousarray(self.size),
            axes=np.ascontiguousarray(self.axes),
            vertices=np.ascontiguousarray(self.vertices),
            faces=np.ascontiguousarray(self.faces),
        )

    @property
    def volume(self) -> float:
        """Volume of the body, or between a surface and its bodies [m^3]."""
        if self.form == "rod":
            return 2 * math.pi * float(self.size[0] ** 2 * self.size[1])
        if self.form == "plate":
            return 8 * float(np.prod(self.size))
        if self.form == "ball":
            return 4 / 3 * math.pi * float(self.size[0] ** 3)
        corners = self.vertices[self.faces]
        return abs(float(np.sum(corners[:, 0] * np.cross(corners[:, 1], corners[:, 2])))) / 6

    @property
    def area(self) -> float:
        """Area of the surface [m^2]."""
        if self.form == "rod":
            return 2 * math.pi * float(self.size[0] * (2 * self.size[1] + self.size[0]))
        if self.form == "plate":
            return 8 * float(self.size @ np.roll(self.size, 1))
        if self.form == "ball":
            return 4 * math.pi * float(self.size[0] ** 2)
        normals = face_normals(self.vertices, self.faces)
        return 0.5 * float(np.linalg.norm(normals, axis=1).sum())

    @property
    def wall_areas(self) -> Vector:
        """Area of each of its walls, (w,) [m^2]."""
        if not self.groups:
            return np.array([self.area])
        areas = 0.5 * np.linalg.norm(face_normals(self.vertices, self.faces), axis=1)
        return np.asarray(np.bincount(self.group, areas, len(self.groups)), np.float64)

    def samples(self, solids: int) -> Vector:
        """Return points that fill one of several bodies evenly, (n, 3) [m]; see `Cavity.spread` for the sequence."""
        count = min(_SAMPLES[0], _SAMPLES[1] // solids)
        share = (np.arange(count)[:, None] * _SPREAD ** -np.arange(1.0, 4.0) + 0.5) % 1.0
        if self.form == "mesh":
            low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
            points = low + share * (high - low)
            return np.asarray(points[self.is_within(points)])
        if self.form == "plate":
            local = (2 * share - 1) * self.size
        else:
            angle = 2 * np.pi * share[:, 0]
            if self.form == "rod":
                radius, height = self.size[0] * np.sqrt(share[:, 1]), (2 * share[:, 2] - 1) * self.size[1]
            else:
                distance, slope = self.size[0] * np.cbrt(share[:, 1]), 2 * share[:, 2] - 1
                radius, height = distance * np.sqrt(1 - slope**2), distance * slope
            local = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1)
        return to_global(local, self.axes) + self.centre

    def surface_samples(self, count: int) -> tuple[Vector, Vector]:
        """Return points that cover the surface evenly, (count, 3) [m], and the normals there, out of the body."""
        points, outward = self.surface().spread(count)
        if self.form in ("rod", "ball"):  # drawn facets are chords of the round surface
            along = self.axes[2]
            is_round = np.ones(count, bool) if self.form == "ball" else np.abs(outward @ along) < 0.5
            spoke = points[is_round] - self.centre
            if self.form == "rod":
                spoke -= (spoke @ along)[:, None] * along
            outward[is_round] = spoke / np.linalg.norm(spoke, axis=1)[:, None]
            points[is_round] += self.size[0] * outward[is_round] - spoke
        return points, outward

    def is_within(self, points: Vector) -> NDArray[np.bool_]:
        """Return whether points are in the body, where there are no particles, (n,)."""
        return np.asarray((Solids((self,)).distances(points) < 0).any(axis=1))

    @property
    def bounds(self) -> tuple[Vector, Vector]:
        """Lowest and highest coordinates [m], (3,) each."""
        if self.form == "mesh":
            return self.vertices.min(axis=0), self.vertices.max(axis=0)
        if self.form == "ball":
            half = np.full(3, self.size[0])
        else:
            size = self.size if self.form == "plate" else self.size[[0, 0, 1]]
            half = np.abs(self.axes).T @ size
        return self.centre - half, self.centre + half

    def surface(self) -> Surface:
        """Return polygons that face the particles, for pictures, files and drawings."""
        if self.form == "mesh":
            # A polygon faces the particles: against the normals, which point away from them.
            return Surface(self.vertices, tuple((int(a), int(c), int(b)) for a, b, c in self.faces))
        if self.form == "plate":
            corners = np.array([(i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) * self.size
            around = facing_inward(
                corners, ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
            )
        elif self.form == "rod":
            ring, up = self.size[0] * circle(_AROUND), np.array([0.0, 0.0, self.size[1]])
            ends = (tuple(range(_AROUND)), tuple(range(_AROUND, 2 * _AROUND)))
            around = facing_inward(np.concatenate([ring - up, ring + up]), (*bands(2, _AROUND), *ends))
        else:
            angles = np.linspace(-np.pi / 2, np.pi / 2, _LATITUDES + 2)[1:-1]
            up = np.array([0.0, 0.0, 1.0])
            rings = [self.size[0] * (np.cos(each) * circle(_AROUND) + np.sin(each) * up) for each in angles]
            last, south = (_LATITUDES - 1) * _AROUND, _LATITUDES * _AROUND
            turn = [(k, (k + 1) % _AROUND) for k in range(_AROUND)]
            caps = [(a, b, south) for a, b in turn] + [(last + a, last + b, south + 1) for a, b in turn]
            points = np.concatenate([*rings, self.size[0] * np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])])
            around = facing_inward(points, (*bands(_LATITUDES, _AROUND), *caps))
        outside = tuple(polygon[::-1] for polygon in around.polygons)
        return Surface(to_global(around.points, self.axes) + self.centre, outside)


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


def body(
    name: str, form: SolidForm, size: Sequence[float] | Vector, centre: Vector, axes: Vector | None = None
) -> Solid:
    """Return a rod, plate or ball."""
    none = np.zeros((0, 3))
    frame = np.eye(3) if axes is None else axes
    return Solid(name, form, np.asarray(centre, float), frame, np.asarray(size, float), none, none.astype(np.int64))


def face_normals(vertices: Vector, faces: NDArray[np.int64]) -> Vector:
    """Return normals of triangles whose lengths are twice their areas, (m, 3) [m^2]."""
    corners = vertices[faces]
    return np.asarray(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))


def mesh(name: str, vertices: Vector, faces: NDArray[np.int64], smooth: float, *, encloses: bool = False) -> Solid:
    """Return a closed surface of triangles."""
    return Solid(name, "mesh", np.zeros(3), np.eye(3), np.zeros(3), vertices, faces, smooth, encloses)
