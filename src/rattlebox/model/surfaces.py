"""Surfaces of cavities as polygons: one mesh for drawings, pictures, ParaView and the browser."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .elementwise import Vector

Polygons = tuple[tuple[int, ...], ...]

_SHARP = np.cos(np.radians(20.0))
"""Cosine of the angle between the normals of two faces above which their edge is drawn from every side."""


_FLAT_SPREAD = 1.324717957244746
"""Root of g^3 = g + 1, for the sequence of `Cavity.spread` in a plane."""


@dataclass(frozen=True, eq=False)
class Surface:
    """A closed surface of polygons, whose corners are counter-clockwise as seen from the space for particles."""

    points: Vector  # Corners, from the centre of the cavity [m], (n, 3)
    polygons: Polygons

    @cached_property
    def normals(self) -> Vector:
        """Unit normals of the polygons, towards the inside, (m, 3)."""
        normals = np.array([_normal(self.points[list(polygon)]) for polygon in self.polygons])
        return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))

    @property
    def areas(self) -> Vector:
        """Area of each polygon, (m,) [m^2]."""
        normals = [_normal(self.points[list(polygon)]) for polygon in self.polygons]
        return np.asarray(0.5 * np.linalg.norm(normals, axis=1))

    @property
    def area(self) -> float:
        """Sum of the areas of the polygons [m^2]."""
        return float(self.areas.sum())

    @property
    def volume(self) -> float:
        """Volume inside [m^3]: that of the pyramids from the centre over the polygons."""
        pyramids = [self.points[polygon[0]] @ _normal(self.points[list(polygon)]) for polygon in self.polygons]
        return -float(np.sum(pyramids)) / 6

    def spread(self, count: int) -> tuple[Vector, Vector]:
        """Return points that cover the surface evenly, (count, 3) [m], and the unit normals there, into the space."""
        fans = [(face[0], face[k], face[k + 1]) for face in self.polygons for k in range(1, len(face) - 1)]
        corners = self.points[np.array(fans)]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        areas = np.linalg.norm(normals, axis=1)
        # Each triangle has points by its area; in it they are a Kronecker sequence.
        share = (np.arange(count) + 0.5) / count
        u, v = ((np.arange(count)[:, None] * _FLAT_SPREAD ** -np.arange(1.0, 3.0) + 0.5) % 1.0).T
        index = np.searchsorted(np.cumsum(areas) / areas.sum(), share).clip(max=len(fans) - 1)
        u, v = np.where(u + v > 1, 1 - u, u)[:, None], np.where(u + v > 1, 1 - v, v)[:, None]
        first, second, third = corners[index].transpose(1, 0, 2)
        return first * (1 - u - v) + second * u + third * v, normals[index] / areas[index, None]

    @cached_property
    def edges(self) -> dict[tuple[int, int], tuple[int, int]]:
        """The two faces at each edge, by the indices of its corners."""
        faces: dict[tuple[int, int], list[int]] = {}
        for face, polygon in enumerate(self.polygons):
            for a, b in zip(polygon, (*polygon[1:], polygon[0]), strict=True):
                faces.setdefault((min(a, b), max(a, b)), []).append(face)
        return {edge: (pair[0], pair[-1]) for edge, pair in faces.items()}

    def is_sharp(self, edge: tuple[int, int]) -> bool:
        """Return whether the faces at an edge are at an angle, so that it is seen from every side."""
        a, b = self.edges[edge]
        return bool(self.normals[a] @ self.normals[b] < _SHARP)

    def lines(self, towards_viewer: Vector) -> list[Vector]:
        """Return the lines that a viewer sees, each (n, 3) [m] and as a whole in front of the centre or behind it."""
        facing = self.normals @ towards_viewer
        facing[np.abs(facing) < 1e-9] = 0.0  # faces seen from the side, whatever the rounding
        shown = [
            edge for edge, (a, b) in self.edges.items() if self.is_sharp(edge) or (facing[a] > 0) != (facing[b] > 0)
        ]
        behind = self.points[np.array(shown)].mean(axis=1) @ towards_viewer < 0
        halves = [[edge for edge, other in zip(shown, behind, strict=True) if other == half] for half in (False, True)]
        return [line for half in halves for line in _chained(half, self.points)]


def _chained(edges: Sequence[tuple[int, int]], points: Vector) -> list[Vector]:
    """Return edges as lines that end where other than two of them meet."""
    neighbours: dict[int, list[int]] = {}
    for a, b in edges:
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    left = set(edges) | {(b, a) for a, b in edges}
    lines = []
    # Ends first: what is left after them are closed lines.
    for start in sorted(neighbours, key=lambda corner: len(neighbours[corner]) == 2):
        for first in neighbours[start]:
            if (start, first) not in left:
                continue
            line = [start]
            following: int | None = first
            while following is not None:
                left -= {(line[-1], following), (following, line[-1])}
                line.append(following)
                ahead = neighbours[following] if len(neighbours[following]) == 2 else ()
                following = next((corner for corner in ahead if (line[-1], corner) in left), None)
            lines.append(points[line])
    return lines


def circle(corners: int) -> Vector:
    """Return corners of a polygon in a circle of radius 1 around z, (n, 3)."""
    angles = np.linspace(0.0, 2 * np.pi, corners, endpoint=False)
    return np.stack([np.cos(angles), np.sin(angles), np.zeros(corners)], axis=1)


def bands(rings: int, around: int) -> Polygons:
    """Return the faces between circles that follow each other."""
    turn = [(k, (k + 1) % around) for k in range(around)]
    starts = range(0, (rings - 1) * around, around)
    return tuple((low + a, low + b, low + around + b, low + around + a) for low in starts for a, b in turn)


def facing_inward(points: Vector, polygons: Iterable[tuple[int, ...]]) -> Surface:
    """Return a convex surface whose polygons are ordered counter-clockwise as seen from its centre."""
    ordered = []
    for polygon in polygons:
        corners = points[list(polygon)]
        ordered.append(polygon[::-1] if _normal(corners) @ corners.mean(axis=0) > 0 else polygon)
    return Surface(points, tuple(ordered))


def _normal(corners: Vector) -> Vector:
    """Return a normal of a polygon by Newell's formula; its length is twice the area."""
    return np.asarray(np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0))
