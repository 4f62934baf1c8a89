"""Coordinate systems in which files give displacements: Cartesian, cylindrical and spherical ones."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .modes_in_file import FloatArray

CARTESIAN, CYLINDRICAL, SPHERICAL = 0, 1, 2
_TURN = 1e-3  # largest deviation of axes from perpendicular unit vectors
_ON_AXIS = 1e-9  # distance from the axis at which there is no radial direction, over the distance from the origin


class CoordinateSystem(NamedTuple):
    """A coordinate system; the rows of `axes` are its Cartesian axes in the global system."""

    kind: int
    axes: FloatArray
    origin: FloatArray

    @property
    def is_sound(self) -> bool:
        """Whether the axes are perpendicular unit vectors of a right-handed system."""
        R = self.axes
        return bool(R.shape == (3, 3) and np.allclose(R @ R.T, np.eye(3), atol=_TURN) and np.linalg.det(R) > 0)

    def position(self, coordinates: FloatArray) -> FloatArray:
        """Return the global position of a point with these coordinates; angles are in degrees."""
        x = np.asarray(coordinates, dtype=float)
        if self.kind == CYLINDRICAL:
            angle = np.radians(x[1])
            x = np.array([x[0] * np.cos(angle), x[0] * np.sin(angle), x[2]])
        elif self.kind == SPHERICAL:
            polar, azimuth = np.radians(x[1:])
            x = x[0] * np.array([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)])
        return np.asarray(self.origin + x @ self.axes)

    def at(self, position: FloatArray | None) -> FloatArray | None:
        """Return the directions of displacements at a position, as rows; None if they are undefined there.

        Those of a cylindrical system are radial, tangential and axial; those of a spherical one are radial, along the polar
        angle from its third axis, and along the azimuth.
        """
        if self.kind == CARTESIAN:
            return self.axes
        if position is None:
            return None
        x, y, z = self.axes @ (np.asarray(position, dtype=float) - self.origin)
        radius, distance = float(np.hypot(x, y)), float(np.sqrt(x * x + y * y + z * z))
        if not radius > _ON_AXIS * max(distance, float(np.abs(self.origin).max()), float(np.abs(position).max())):
            return None
        c, s = x / radius, y / radius
        if self.kind == CYLINDRICAL:
            local = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        else:
            sine, cosine = radius / distance, z / distance
            local = np.array([[sine * c, sine * s, cosine], [cosine * c, cosine * s, -sine], [-s, c, 0.0]])
        return np.asarray(local @ self.axes)
