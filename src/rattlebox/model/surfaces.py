"""Surfaces of cavities as polygons, for pictures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .cavities import Box, Cavity, Cylinder
from .elementwise import Vector

# Corners of a cylinder's end, meridians and circles of latitude of a sphere: few, since their positions are stored at each
# time. The faces are inside the wall by up to 0.1 % of the radius of a cylinder and 0.8 % of that of a sphere.
_AROUND = 72
_MERIDIANS, _LATITUDES = 36, 17


@dataclass(frozen=True)
class Surface:
    """A surface of polygons.

    Attributes
    ----------
    points : (n, 3) float
        Corners, from the centre of the cavity [m].
    polygons : tuple of tuple of int
        Indices of the corners of each polygon, counter-clockwise as seen from inside the cavity.
    """

    points: Vector
    polygons: tuple[tuple[int, ...], ...]


def surface(cavity: Cavity) -> Surface:
    """Return the walls of a cavity as a closed surface.

    Parameters
    ----------
    cavity
        Cavity.

    Returns
    -------
    Surface
        Six faces of a box; the side and flat ends of a cylinder; a grid of latitude and longitude of a sphere.
    """
    if isinstance(cavity, Box):
        corners = np.array([(i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        faces = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
        return _facing_inward(corners * cavity.lengths / 2, faces)
    if isinstance(cavity, Cylinder):
        ends = [
            cavity.radius * _circle(_AROUND) + [0.0, 0.0, height] for height in (-cavity.length / 2, cavity.length / 2)
        ]
        lids = (tuple(range(_AROUND)), tuple(range(_AROUND, 2 * _AROUND)))
        return _facing_inward(np.concatenate(ends) @ cavity.frame, (*_bands(2, _AROUND), *lids))
    radius = float(cavity.lengths[0]) / 2
    angles = np.linspace(-np.pi / 2, np.pi / 2, _LATITUDES + 2)[1:-1]
    rings = [radius * (np.cos(angle) * _circle(_MERIDIANS) + [0.0, 0.0, np.sin(angle)]) for angle in angles]
    last, south = (_LATITUDES - 1) * _MERIDIANS, _LATITUDES * _MERIDIANS
    turn = [(k, (k + 1) % _MERIDIANS) for k in range(_MERIDIANS)]
    caps = [(a, b, south) for a, b in turn] + [(last + a, last + b, south + 1) for a, b in turn]
    points = np.concatenate([*rings, [[0.0, 0.0, -radius], [0.0, 0.0, radius]]])
    return _facing_inward(points, (*_bands(_LATITUDES, _MERIDIANS), *caps))


def _circle(corners: int) -> Vector:
    """Return corners of a polygon in a circle of radius 1 around z, (n, 3)."""
    angles = np.linspace(0.0, 2 * np.pi, corners, endpoint=False)
    return np.stack([np.cos(angles), np.sin(angles), np.zeros(corners)], axis=1)


def _bands(rings: int, around: int) -> list[tuple[int, ...]]:
    """Return the faces between circles that follow each other."""
    turn = [(k, (k + 1) % around) for k in range(around)]
    starts = range(0, (rings - 1) * around, around)
    return [(low + a, low + b, low + around + b, low + around + a) for low in starts for a, b in turn]


def _facing_inward(points: Vector, polygons: tuple[tuple[int, ...], ...]) -> Surface:
    """Return a convex surface whose polygons are ordered counter-clockwise as seen from its centre."""
    ordered = []
    for polygon in polygons:
        corners = points[list(polygon)]
        normal = np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0)
        ordered.append(polygon[::-1] if normal @ corners.mean(axis=0) > 0 else polygon)
    return Surface(points, tuple(ordered))
