"""A closed surface of triangles as cavity."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.phrases import counted

from .cavities import Cavity, Walls
from .elementwise import Vector
from .necks import neck_notes, widest_sphere
from .solids import Solid, Solids, mesh
from .space import components_along
from .surfaces import Surface
from .triangle_surface import TriangleSurface, surface_notes, surface_words

_PROBES = 4096  # points of the bounding box for which an overlap of two cells is tested


class Mesh(TriangleSurface, Cavity):
    """A cavity with a closed surface of triangles, from a file of a CAD program or from arrays.

    The surface is that of the space for the particles. Shells inside the largest one are bodies. Its centre, from which
    positions are measured and which moves with the point of the structure, is the middle of its bounding box; `centre` has
    its coordinates in the file.

    Parameters
    ----------
    file
        STL, OBJ, PLY or OFF file, or a STEP file, which states its unit.
    unit
        Unit of the coordinates, such as "mm"; it is never assumed.
    vertices, faces
        Corners, (n, 3), and numbers of the three corners of each triangle, (m, 3), in place of a file.
    smooth_angle
        Largest angle between the normals of two triangles that approximate one curved surface [rad]. A particle has one
        contact with such triangles, the nearest; at sharper edges one with each side.

    Notes
    -----
    The wall is a surface like the exact walls of the other cavities, with the same contact laws, and flat faces have the
    same contacts. A facet of a curved wall of radius R that is w wide lies up to w^2 / (8 R) inside of it.

    Examples
    --------
    A tetrahedron:

    >>> import rattlebox as rb
    >>> cavity = rb.Mesh(
    ...     vertices=[[0, 0, 0], [60, 0, 0], [0, 60, 0], [0, 0, 60]],
    ...     faces=[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    ...     unit="mm",
    ... )
    >>> print(f"{1e6 * cavity.volume:.1f} cm^3")
    36.0 cm^3
    """

    kind: Literal["mesh"] = "mesh"

    @property
    def centre(self) -> Vector:
        """Middle of the bounding box in the coordinates of the file [m], (3,)."""
        corners = self.triangles.vertices
        return np.asarray(0.5 * (corners.min(axis=0) + corners.max(axis=0)))

    @cached_property
    def solid(self) -> Solid:
        """The surface, around the centre."""
        return mesh("mesh", self.triangles.vertices - self.centre, self.triangles.faces, self.smooth, encloses=True)

    @cached_property
    def _walls(self) -> Walls:
        return Walls((self.solid.name,), np.zeros((0, 3)), np.zeros(0), (), Solids((self.solid,)))

    def walls(self) -> Walls:
        """Return the surface as the only wall, with the name "mesh"."""
        return self._walls

    @property
    def face_instead(self) -> str:
        """Advice for a part of the surface, or a group of its file, that should be a face."""
        return (
            "walls = { mesh = ... } for the whole surface, or a body in front of this part, which is a face: bodies = "
            '[{ kind = "plate", name = "lid", size = ..., position = ... }], walls = { lid = ... }'
        )

    @cached_property
    def volume(self) -> float:
        """Volume of the space for particles [m^3]."""
        return self.triangles.volume

    @property
    def lengths(self) -> Vector:
        """Edges of the bounding box, (3,) [m]."""
        return np.asarray(np.ptp(self.triangles.vertices, axis=0))

    @property
    def inside(self) -> Vector:
        """Zeros: no box is known to be inside, (3,) [m]."""
        return np.zeros(3)

    @cached_property
    def _surface(self) -> Surface:
        return self.solid.surface()

    def surface(self) -> Surface:
        """Return the triangles."""
        return self._surface

    def extent(self, direction: Vector) -> float:
        """Return the width of the surface along a unit vector [m]."""
        return float(np.ptp(components_along(self.solid.vertices, direction)))

    @property
    def surface_over_volume(self) -> float:
        """Area of the triangles over the volume [1/m]."""
        return self.solid.area / self.volume

    @cached_property
    def _probes(self) -> Vector:
        """Points in and on the surface, (n, 3) [m]."""
        corners = self.solid.vertices
        return np.concatenate([self.spread(_PROBES), corners[:: 1 + len(corners) // _PROBES]])

    def overlaps(self, shifts: Vector, tolerance: float) -> NDArray[np.bool_]:
        """Return whether the surface and its copies overlap, for points of one that are in the other."""
        near = np.all(np.abs(shifts) < self.lengths - tolerance, axis=1)
        result = np.zeros(len(shifts), np.bool_)
        for k in np.flatnonzero(near):
            moved = np.concatenate([self._probes + shifts[k], self._probes - shifts[k]])
            result[k] = np.any(2 * self.depth(moved) > tolerance)
        return result

    def words(self) -> str:
        """Return a phrase with the edges of the bounding box."""
        shells = self.triangles.shells - 1
        inside = f", with {counted(shells, 'body', 'bodies')} inside" if shells else ""
        return surface_words("a surface", self.lengths, len(self.faces)) + inside

    def notes(self, radius: float) -> Iterator[str]:
        """Yield what was changed or assumed in reading the surface, and where spheres do not pass."""
        yield from surface_notes(self)
        yield from neck_notes(self, radius)

    @cached_property
    def widest(self) -> float:
        """Diameter of the largest sphere inside [m]."""
        return 2 * widest_sphere(self)
