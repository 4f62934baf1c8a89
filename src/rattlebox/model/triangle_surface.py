"""Closed surfaces of triangles, from files or arrays: their checks, shells and measures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from rattlebox._util.digests import array_digest
from rattlebox._util.phrases import counted
from rattlebox._util.quantities import amount
from rattlebox.core import _core
from rattlebox.exchange.read.surfaces import STEP, read_groups, read_surface

from .base import FilePart
from .elementwise import Vector
from .errors import Hint, at
from .face_groups import FROM_FILE
from .files import absolute, existing
from .solids import Solids, TriangleMesh
from .units import Angle, factor_of

Faces = NDArray[np.int64]

MOST_TRIANGLES = 500_000
_MERGED = 1e-7
"""Distance of corners that are one, over the size of the surface: files in single precision round to half of it."""
_SLIVER = 1e-9  # height over the longest edge of a triangle that has no normal
_LARGEST = 1e6  # coordinates [m]: squares and volumes stay finite
_FOLD = 1e-4  # angle between two triangles that lie on each other [rad]
_FLAT = 1e-9  # volume of a shell without space inside, over its area to the power of 3/2
_PROBES = 500  # corners and middles of triangles by which a shell is inside or outside of another one
_LENGTHS = ("mm", "m", "in")


def _table(columns: int, whole: bool, what: str) -> Any:
    def read(value: object) -> Any:
        if value is None:
            return None
        try:
            array = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            array = np.zeros(0)
        if array.ndim != 2 or array.shape[1] != columns or not np.isfinite(array).all():
            raise Hint(f"rows of {columns} finite numbers are needed", "[[0, 0, 0], [1, 0, 0], ...]")
        if not whole:
            return tuple(map(tuple, array.tolist()))
        if (array != np.round(array)).any() or array.min(initial=0) < 0:
            raise Hint("rows of three numbers of corners, from 0, are needed", "[[0, 1, 2], ...]")
        return tuple(map(tuple, array.astype(np.int64).tolist()))

    return BeforeValidator(read), WithJsonSchema({"type": "array", "description": what})


class TriangleSurface(FilePart):
    """Base class of parts with a closed surface of triangles."""

    file_fields: ClassVar[tuple[str, ...]] = ("vertices", "faces")
    elementwise: ClassVar[bool] = False
    kind: str
    file: str | None = None
    unit: str | None = Field(default=None, examples=["mm"])
    vertices: Annotated[tuple[tuple[float, float, float], ...], *_table(3, False, "corners")] = Field(
        examples=[[[0, 0, 0], [40, 0, 0], [0, 40, 0], [0, 0, 40]]]
    )
    faces: Annotated[tuple[tuple[int, int, int], ...], *_table(3, True, "numbers of three corners")] = Field(
        examples=[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]
    )
    smooth_angle: Angle = float(np.radians(20.0))

    @model_validator(mode="before")
    @classmethod
    def _from_file(cls, values: object) -> Any:
        if not isinstance(values, dict):
            return values
        if values.get("file") is None:
            if values.get("vertices") is None or values.get("faces") is None:
                raise Hint("either file, or vertices and faces are needed", 'file = "cavity.stl", unit = "mm"')
            return values
        twice = sorted(set(cls.file_fields) & {name for name, value in values.items() if value is not None})
        if twice:
            raise Hint(f"{twice[0]} and file exclude each other", "one of them", [twice[0]])
        with at("file"):
            values = dict(values)
            path = absolute(values["file"])
            if values.get("groups") == FROM_FILE:
                vertices, faces, values["face_groups"] = read_groups(existing(path))
            else:
                vertices, faces = read_surface(existing(path))
        return {**values, "vertices": vertices, "faces": faces, "file": path}

    @model_validator(mode="after")
    def _check_surface(self) -> TriangleSurface:
        if not 0 <= self.smooth_angle <= np.pi / 2:
            raise Hint("an angle from 0 to 90 degrees is needed", '"20 deg"', ["smooth_angle"])
        if self.unit is None and not self._is_step:
            largest = float(np.abs(self.vertices).max(initial=0.0))
            raise Hint(
                f"the unit of the coordinates is needed: {'the file' if self.file else 'an array'} does not state it; the "
                f"largest coordinate is {largest:.4g}",
                ", ".join(f'unit = "{unit}"' for unit in _LENGTHS),
                ["unit"],
            )
        _ = self.factor
        with at(self.where):
            _ = self.triangles
        return self

    @property
    def digest(self) -> str:
        """Text that differs for other surfaces, also of one file that has changed."""
        triangles = self.triangles
        return f"{self.model_dump_json()} {array_digest([triangles.vertices, triangles.faces]).hex()}"

    @property
    def where(self) -> str:
        """Field with the surface."""
        return "file" if self.file else "faces"

    @property
    def _is_step(self) -> bool:
        return self.file is not None and Path(self.file).suffix.lower() in STEP

    @property
    def factor(self) -> float:
        """Metres per unit of the coordinates."""
        if self._is_step:
            if self.unit not in (None, "mm"):
                raise Hint(
                    f"a STEP file states its own unit and is read in mm, not in {self.unit}", "no unit", ["unit"]
                )
            return 1e-3
        known = factor_of(str(self.unit), ("m",))
        if known is None:
            raise Hint(f"{self.unit!r} is not a unit of length", ", ".join(f'"{unit}"' for unit in _LENGTHS), ["unit"])
        return known[0]

    @cached_property
    def triangles(self) -> Triangles:
        """The surface in metres, checked, with normals out of the space between its shells."""
        corners = self.factor * np.array(self.vertices)
        if (largest := float(np.abs(corners).max(initial=0.0))) > _LARGEST:
            raise Hint(
                f"the surface has a corner {largest:.3g} m from the origin; at most {_LARGEST:g} m are allowed",
                "another unit, or another export: numbers of this size are no coordinates",
            )
        return checked(corners, np.array(self.faces, dtype=np.int64))

    @property
    def smooth(self) -> float:
        """Cosine of the largest angle between normals at a smooth edge; coplanar edges are always smooth."""
        return float(np.cos(max(self.smooth_angle, 1e-4)))


@dataclass(frozen=True, eq=False)
class Triangles:
    """A closed surface: a shell, and perhaps others inside it."""

    vertices: Vector  # Corners [m], (n, 3)
    faces: Faces  # Triangles, with normals out of the space between the shells, (m, 3)
    origin: NDArray[np.int64]  # Number of each triangle in the file or array, (m,)
    shells: int
    notes: tuple[str, ...]

    @property
    def volume(self) -> float:
        """Volume between the shells [m^3]."""
        return volume_of(self.vertices, self.faces)


def volume_of(vertices: Vector, faces: Faces) -> float:
    """Return the volume of the pyramids over triangles, positive if normals point outward [m^3]."""
    origin = vertices[faces].mean(axis=(0, 1)) if len(faces) else np.zeros(3)
    corners = vertices[faces] - origin
    return float(np.sum(corners[:, 0] * np.cross(corners[:, 1], corners[:, 2]))) / 6


def checked(vertices: Vector, faces: Faces) -> Triangles:
    """Return a closed surface with merged corners and normals out of its space.

    Raises
    ------
    Hint
        If it is open, crosses itself, has triangles that are turned against their neighbours, or several shells apart.
    """
    if not len(faces):
        raise Hint("the surface has no triangles", "a closed surface")
    if len(faces) > MOST_TRIANGLES:
        raise Hint(
            f"the surface has {len(faces)} triangles; at most {MOST_TRIANGLES} are possible",
            "a coarser export; contacts need facets of about a tenth of the radius of curvature",
        )
    if faces.max() >= len(vertices) or faces.min() < 0:
        raise Hint(
            f"a triangle has the corner {faces.max()}, but there are {len(vertices)}", "numbers of corners from 0"
        )
    notes: list[str] = []
    vertices, faces = _merged(vertices, faces)
    origin = _without_slivers(vertices, faces, notes)
    vertices, faces = _used(vertices, faces[origin])
    owner, other = _edges(vertices, faces)
    _check_folds(vertices, faces, owner, other)
    shell = _shells(len(faces), owner, other)
    crossing = np.asarray(_core.crossing_triangles(np.ascontiguousarray(vertices), np.ascontiguousarray(faces)))
    if len(crossing):
        at_least = "at least " if len(crossing) == 100 else ""
        raise Hint(
            f"the surface crosses itself: {at_least}{counted(len(crossing), 'pair')} of triangles, the first near "
            f"{_place(vertices[faces[crossing[0, 0]]].mean(axis=0))}",
            "a single boolean union in the CAD program before the export; bodies that overlap are separate `bodies`",
        )
    faces = _oriented(vertices, faces, shell, notes)
    return Triangles(vertices, faces, origin, int(shell.max()) + 1, tuple(notes))


def _place(point: Vector) -> str:
    return f"({', '.join(f'{1e3 * x:.4g}' for x in point)}) mm in the coordinates of the file"


def _merged(vertices: Vector, faces: Faces) -> tuple[Vector, Faces]:
    """Return corners without repetition: STL files state each corner once for each triangle."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    size = float(np.ptp(vertices, axis=0).max(initial=0.0))
    if not size > 0:
        raise Hint("all corners of the surface are at one place", "a closed surface")
    vertices, first = np.unique(vertices, axis=0, return_inverse=True)
    faces = first.reshape(-1)[faces]
    pairs = cKDTree(vertices).query_pairs(_MERGED * size, output_type="ndarray")
    if len(pairs):
        links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(vertices),) * 2)
        _, label = connected_components(links, directed=False)
        _, kept = np.unique(label, return_index=True)
        vertices, faces = vertices[kept], label[faces].astype(np.int64)
    return vertices, np.asarray(faces, dtype=np.int64)


def _without_slivers(vertices: Vector, faces: Faces, notes: list[str]) -> NDArray[np.int64]:
    """Return the numbers of triangles that have three corners; raise if one has them on a line."""
    corners = np.sort(faces, axis=1)
    repeated = (corners[:, 0] == corners[:, 1]) | (corners[:, 1] == corners[:, 2])
    if repeated.any():
        notes.append(f"{counted(int(repeated.sum()), 'triangle')} with two corners at one place left out")
    kept = np.flatnonzero(~repeated)
    if not kept.size:
        raise Hint("the surface has no triangle with an area", "a closed surface; check its unit and precision")
    points = vertices[faces[kept]]
    sides = np.linalg.norm(points - np.roll(points, 1, axis=1), axis=2).max(axis=1)
    twice = _double_areas(points)
    flat = np.flatnonzero(twice < _SLIVER * sides**2)
    if flat.size:
        raise Hint(
            f"{counted(flat.size, 'triangle')} of the surface {'has' if flat.size == 1 else 'have'} no area, the first near "
            f"{_place(points[flat[0]].mean(axis=0))}: three corners on a line have no normal",
            "another export, or a repair that removes degenerate triangles",
        )
    return kept


def _double_areas(points: Vector) -> Vector:
    """Return twice the areas of triangles with these corners, (m,) [m^2]."""
    return np.asarray(np.linalg.norm(np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]), axis=1))


def _used(vertices: Vector, faces: Faces) -> tuple[Vector, Faces]:
    used, number = np.unique(faces, return_inverse=True)
    return vertices[used], number.reshape(faces.shape).astype(np.int64)


def _edges(vertices: Vector, faces: Faces) -> tuple[Faces, Faces]:
    """Return the two triangles at each edge; raise unless each edge has two, which agree about the outside."""
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    face = np.repeat(np.arange(len(faces)), 3)
    forward = ends[:, 0] < ends[:, 1]
    key = np.sort(ends, axis=1)
    order = np.lexsort((key[:, 1], key[:, 0]))
    key, face, forward = key[order], face[order], forward[order]
    _, start, count = np.unique(key, axis=0, return_index=True, return_counts=True)
    single = np.flatnonzero(count == 1)
    if single.size:
        edge = key[start[single[0]]]
        raise Hint(
            f"the surface is open: {counted(single.size, 'edge')} {'has' if single.size == 1 else 'have'} a triangle on one "
            f"side only, the first near {_place(vertices[edge].mean(axis=0))}; particles would leave through the hole",
            "a closed surface: close the holes in the CAD program, or sew the faces before the export",
        )
    many = np.flatnonzero(count > 2)
    if many.size:
        edge = key[start[many[0]]]
        # Of shells that touch, triangles at one place are turned against each other.
        first_corner = faces.argmin(axis=1)[:, None]
        turned = np.take_along_axis(faces, (first_corner + np.arange(3)) % 3, axis=1)
        repeated = len(faces) - len(np.unique(turned, axis=0))
        raise Hint(
            f"{counted(many.size, 'edge')} of the surface {'has' if many.size == 1 else 'have'} more than two triangles, "
            f"the first near {_place(vertices[edge].mean(axis=0))}"
            + (
                f"; {counted(repeated, 'triangle')} {'is a copy' if repeated == 1 else 'are copies'} of others"
                if repeated
                else ""
            ),
            "each triangle once, in trimesh by mesh.update_faces(mesh.unique_faces())"
            if repeated
            else "shells that do not touch: one surface around the space, and bodies apart from it",
        )
    first, second = face[start], face[start + 1]
    against = forward[start] == forward[start + 1]
    if against.any():
        edge = key[start[np.flatnonzero(against)[0]]]
        raise Hint(
            f"the normals of the surface are not consistent: at {counted(int(against.sum()), 'edge')} one triangle is "
            f"turned inside out, the first near {_place(vertices[edge].mean(axis=0))}",
            "normals that all point outward: trimesh.repair.fix_normals, or another export",
        )
    return first, second


def _check_folds(vertices: Vector, faces: Faces, first: Faces, second: Faces) -> None:
    """Raise if two neighbours lie on each other: between them the surface has no inside."""
    points = vertices[faces]
    normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    folded = np.flatnonzero(np.linalg.norm(normals[first] + normals[second], axis=1) < _FOLD)
    if folded.size:
        raise Hint(
            f"the surface is folded onto itself at {counted(folded.size, 'edge')}, the first near "
            f"{_place(points[first[folded[0]]].mean(axis=0))}: two neighbouring triangles lie on each other",
            "another export, or a repair that removes folded triangles; a sheet has a thickness",
        )


def _shells(count: int, first: Faces, second: Faces) -> Faces:
    """Return the number of the shell of each triangle."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    links = coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    return np.asarray(connected_components(links, directed=False)[1], dtype=np.int64)


def _oriented(vertices: Vector, faces: Faces, shell: Faces, notes: list[str]) -> Faces:
    """Return triangles with normals out of the space between an outer shell and shells inside it."""
    faces = faces.copy()
    numbers = range(int(shell.max()) + 1)
    volumes = np.array([volume_of(vertices, faces[shell == k]) for k in numbers])
    for k in numbers:
        points = vertices[faces[shell == k]]
        if abs(volumes[k]) <= _FLAT * _double_areas(points).sum() ** 1.5:
            raise Hint(
                f"a shell of the surface near {_place(points[0].mean(axis=0))} contains no volume",
                "a surface around a space: a sheet without thickness is no cavity and no body; check its unit and precision",
            )
    outer = int(np.abs(volumes).argmax())
    shells = [_outward(faces[shell == k], volumes[k]) for k in numbers]
    inside = [Solids((TriangleMesh("", vertices=vertices, faces=each),)) for each in shells]
    for k in numbers:
        if k == outer:
            continue
        # Shells do not cross, but may touch: of the points of one, the farthest from the other shows its side.
        corners = vertices[faces[shell == k][:_PROBES]]
        points = np.concatenate([corners.mean(axis=1), corners.reshape(-1, 3)])
        if _side(inside[outer], points) < 0:
            raise Hint(
                f"the surface has {len(volumes)} shells; one near {_place(points[0])} is outside of the largest one",
                "one cell in a file, and offsets for equal cells; bodies inside are shells of the same file, or `bodies`",
            )
        for other in numbers:
            if other not in (k, outer) and _side(inside[other], points) > 0:
                raise Hint(
                    f"the shell near {_place(points[0])} is inside of another inner shell, where there is no space",
                    "an outer shell, and bodies inside that do not contain each other",
                )
        faces[shell == k] = _outward(faces[shell == k], -volumes[k])
    if len(volumes) > 1:
        bodies = counted(len(volumes) - 1, "shell")
        notes.append(f"the largest shell of the surface is the wall, and {bodies} inside it bound a body each")
    if volumes[outer] < 0:
        notes.append("warning: the normals of the surface point inward; they are turned around")
        faces[shell == outer] = _outward(faces[shell == outer], volumes[outer])
    return faces


def _side(surface: Solids, points: Vector) -> float:
    """Return the distance of the point that is farthest from a surface, positive inside [m]."""
    distances = surface.distances(points)[:, 0]
    return float(distances[np.abs(distances).argmax()])


def _outward(faces: Faces, volume: float) -> Faces:
    return faces if volume > 0 else np.ascontiguousarray(faces[:, ::-1])


def surface_words(what: str, lengths: Vector, triangles: int, groups: str = "") -> str:
    """Return a phrase about a surface with its bounding box."""
    sides = " x ".join(f"{amount(1e3 * float(x))}" for x in lengths)
    return f"{what} of {counted(triangles, 'triangle')}{groups}, {sides} mm"


def surface_notes(surface: TriangleSurface) -> Iterator[str]:
    """Yield what was changed or assumed in reading a surface."""
    name = Path(surface.file).name if surface.file else "the surface"
    yield from (
        f"warning: {name}: {note.removeprefix('warning: ')}" if note.startswith("warning: ") else f"{name}: {note}"
        for note in surface.triangles.notes
    )
