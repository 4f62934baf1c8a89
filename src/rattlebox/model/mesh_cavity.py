"""A closed surface of triangles as cavity."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, model_validator

from rattlebox._util.digests import array_digest
from rattlebox._util.exceptions import DataError
from rattlebox._util.phrases import counted
from rattlebox.exchange.read.surfaces import read_groups

from .cavities import Cavity, Walls
from .elementwise import Vector
from .errors import Hint, at, several
from .face_groups import DIRECTIONS, FROM_FILE, UNGROUPED, AnyGroups, check_names, named_groups, select_groups
from .necks import neck_notes, widest_sphere
from .solids import Solids, TriangleMesh, face_normals
from .space import components_along
from .surfaces import Surface
from .triangle_surface import TriangleSurface, surface_notes, surface_words

_PROBES = 4096  # points of the bounding box for which an overlap of two cells is tested


def _names(value: object) -> object:
    """Return an array of names as a list."""
    return value.tolist() if isinstance(value, np.ndarray) else value


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
    groups
        Faces that are walls of their own, by name: each a direction such as "-z", a `FaceGroup`, or "rest"; or "file" for
        the groups of the file. Triangles in no group are the wall "mesh".
    face_groups
        Name of the group of each triangle, (m,), with arrays in place of a file.
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

    With a wall of its own below:

    >>> cavity = cavity.model_copy(update={"groups": {"floor": rb.FaceGroup("-z")}})
    >>> cavity.walls().labels
    ('floor', 'mesh')
    """

    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("groups", "face_groups"),)
    file_fields: ClassVar[tuple[str, ...]] = (*TriangleSurface.file_fields, "face_groups")
    kind: Literal["mesh"] = "mesh"
    groups: AnyGroups = Field(default_factory=dict, examples=[{"floor": "-z", "side": "rest"}])
    face_groups: Annotated[tuple[str, ...], BeforeValidator(_names)] = Field(default=(), examples=[["floor", "side"]])

    @model_validator(mode="after")
    def _check_groups(self) -> Mesh:
        if self.groups == FROM_FILE and self.file is None:
            raise Hint("there is no file with groups", "face_groups, a name for each triangle", ["groups"])
        if self.groups and self.groups != FROM_FILE and self.face_groups:
            raise Hint("groups and face_groups exclude each other", "one of them", ["face_groups"])
        if self.face_groups and len(self.face_groups) != len(self.faces):
            raise Hint(
                f"{several(len(self.face_groups), 'name')}, but {several(len(self.faces), 'triangle')}",
                "a name for each triangle",
                ["face_groups"],
            )
        with at("groups" if self.groups else "face_groups"):
            if isinstance(self.groups, dict):
                check_names(self.groups)
            _ = self._grouped
        return self

    @cached_property
    def _grouped(self) -> tuple[tuple[str, ...], NDArray[np.int64], tuple[str, ...]]:
        """Names of the walls, number of that of each triangle, (m,), and warnings; without groups none."""
        triangles = self.triangles
        if self.face_groups:
            return *named_groups([self.face_groups[k] for k in triangles.origin]), ()
        if not isinstance(self.groups, dict) or not self.groups:
            return (), np.zeros(0, np.int64), ()
        corners = triangles.vertices - self.centre
        normals = face_normals(corners, triangles.faces)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        return select_groups(self.groups, corners[triangles.faces], normals)

    def __hash__(self) -> int:
        """Return the hash of the surface; groups, a table, have none."""
        return hash((self.file, self.unit, self.vertices, self.faces))

    @property
    def centre(self) -> Vector:
        """Middle of the bounding box in the coordinates of the file [m], (3,)."""
        corners = self.triangles.vertices
        return np.asarray(0.5 * (corners.min(axis=0) + corners.max(axis=0)))

    @cached_property
    def solid(self) -> TriangleMesh:
        """The surface, around the centre."""
        names, number, _ = self._grouped
        surface = TriangleMesh(
            names[0] if len(names) == 1 else UNGROUPED,
            vertices=self.triangles.vertices - self.centre,
            faces=self.triangles.faces,
            smooth=self.smooth,
            encloses=True,
        )
        # One group is the same as none, but for its name.
        return replace(surface, groups=names, group=number) if len(names) > 1 else surface

    @cached_property
    def _walls(self) -> Walls:
        return Walls(self.solid.walls, np.zeros((0, 3)), np.zeros(0), (), Solids((self.solid,)))

    def walls(self) -> Walls:
        """Return the groups of triangles, or the surface as the only wall, with the name "mesh"."""
        return self._walls

    def face_instead(self, name: str, labels: Sequence[str]) -> str:
        """Return the nearest name, or advice for groups in a cavity that has none."""
        if self.solid.groups:
            return super().face_instead(name, labels)
        if self.file is not None:
            with suppress(DataError):
                if name in read_groups(Path(self.file))[2]:
                    return 'cavity.groups = "file", which is needed for the groups of the file'
        like = name if name in DIRECTIONS else "+z"
        return f'a group in the cavity, such as groups = {{ "{name}" = "{like}" }} for the faces in this direction'

    @property
    def face_areas(self) -> Vector:
        """Area of each wall, (f,) [m^2]."""
        return self.solid.wall_areas

    @property
    def digest(self) -> str:
        """Text that differs for other surfaces and groups."""
        return f"{super().digest} {array_digest([self.solid.group]).hex()}"

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
        groups = f" in {len(self.solid.groups)} groups" if self.solid.groups else ""
        return surface_words("a surface", self.lengths, len(self.faces), groups) + inside

    def notes(self, radius: float) -> Iterator[str]:
        """Yield what was changed or assumed in reading the surface, and where spheres do not pass."""
        yield from surface_notes(self)
        yield from self._grouped[2]
        yield from neck_notes(self, radius)

    @cached_property
    def widest(self) -> float:
        """Diameter of the largest sphere inside [m]."""
        return 2 * widest_sphere(self)
