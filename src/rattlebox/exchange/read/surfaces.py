"""Closed surfaces of triangles from STL, OBJ, PLY, OFF and STEP files, read by trimesh."""

from __future__ import annotations

import re
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import DataError
from rattlebox._util.optional_imports import optional_import

from .guarded import errors_of

STEP = (".step", ".stp")
ENDINGS = (".stl", ".obj", ".ply", ".off", *STEP)
_OF_FACES = ("group", "label", "material_index", "region")  # properties of faces in PLY files that number groups
_OBJ = ("g", "o", "usemtl")  # lines of OBJ files that begin a group, an object or a material, in the order of their use
_IN_PATHS = str.maketrans(".[]", "___")  # characters that have a meaning in the path of a value of a case


def read_surface(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return corners in the unit of the file, (n, 3), and triangles, (m, 3); a STEP file is triangulated, in mm."""
    ending, trimesh = _library(path)
    with errors_of(path, f"a surface in {ending}"):
        # Several bodies of a file become one surface; its shells are separated again by their edges.
        return _arrays(path, [mesh for _, mesh in _parts(trimesh.load(path, process=False))])


def read_groups(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64], tuple[str, ...]]:
    """Return the arrays of `read_surface`, and the name of the group of each triangle, "" if it has none, (m,).

    Raises
    ------
    DataError
        If the file has fewer than two groups.
    """
    ending, trimesh = _library(path)
    with errors_of(path, f"a surface in {ending}"):
        parts = _grouped(path, ending, trimesh)
        vertices, faces = _arrays(path, [mesh for _, mesh in parts])
        names = tuple(name.translate(_IN_PATHS) for name, mesh in parts for _ in range(len(mesh.faces)))
    known = sorted(set(names) - {""})
    if len(known) < 2 - ("" in names):
        what = f"one group, {known[0]!r}" if known else "no groups of faces"
        raise DataError(f"{path} has {what}", 'groups by direction, such as { floor = "-z", side = "rest" }')
    return vertices, faces, names


def _library(path: Path) -> tuple[str, Any]:
    """Return the ending of a file and the library that reads it."""
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise DataError(f"{path} has no ending of a surface", f"a file that ends in {', '.join(ENDINGS)}")
    if ending in STEP:
        optional_import("cascadio", "cad", "export the surface as STL")
    if ending == ".stl":
        _check_length(path)
    return ending, optional_import("trimesh", "mesh", "pass the arrays vertices and faces")


def _check_length(path: Path) -> None:
    """Raise if a binary STL file is not as long as its number of triangles, for which trimesh finds none."""
    size = path.stat().st_size
    with path.open("rb") as stream:
        head = stream.read(84)
    if len(head) < 84 or b"solid" in head[:80].lower():  # a text file, if it is none of both
        return
    count = int.from_bytes(head[80:], "little")
    if size != 84 + 50 * count:
        what = f"{path} is damaged: it states {count} triangles, for which it needs {84 + 50 * count} bytes, and has {size}"
        raise DataError(what, "the file copied or exported again")


def _parts(loaded: Any) -> list[tuple[str, Any]]:
    """Return the surfaces of a file, with their names."""
    if not hasattr(loaded, "geometry"):
        return [("", loaded)]
    parts = []
    for node in loaded.graph.nodes_geometry:
        place, name = loaded.graph[node]
        mesh = loaded.geometry[name]
        if getattr(mesh, "faces", None) is not None:
            parts.append((str(name), mesh.copy().apply_transform(place)))
    return parts


def _arrays(path: Path, meshes: list[Any]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the corners and triangles of several surfaces."""
    meshes = [mesh for mesh in meshes if getattr(mesh, "faces", None) is not None and len(mesh.faces)]
    if not meshes:
        raise DataError(f"{path} contains no triangles", "a surface of triangles, not of points or lines")
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    vertices = np.concatenate([np.asarray(mesh.vertices, np.float64) for mesh in meshes])
    if vertices.ndim != 2 or vertices.shape[1] != 3 or not np.isfinite(vertices).all():
        raise DataError(f"{path} has corners without three finite coordinates", "the surface exported again")
    faces = [np.asarray(mesh.faces, np.int64) + start for mesh, start in zip(meshes, starts, strict=False)]
    scale = 1e3 if path.suffix.lower() in STEP else 1.0  # the triangulation is in metres
    return scale * vertices, np.concatenate(faces)


def _grouped(path: Path, ending: str, trimesh: Any) -> list[tuple[str, Any]]:
    """Return the surfaces of the groups in a file, with their names."""
    if ending == ".obj":
        return _obj_groups(path.read_text(encoding="utf-8", errors="replace"), trimesh)
    loaded = trimesh.load(path, process=False)
    if ending == ".ply":
        raw = loaded.metadata.get("_ply_raw", {}).get("face", {})
        name = next((name for name in _OF_FACES if name in raw.get("properties", ())), None)
        if name is not None:
            number = _numbers(path, raw["data"], name, len(loaded.faces))
            each = sorted(set(number.tolist()))
            return [(f"{name} {k:g}", loaded.submesh([np.flatnonzero(number == k)], append=True)) for k in each]
    parts = _parts(loaded)
    if ending in STEP and len(parts) == 1:  # a single body has a group for each of its faces
        whole = _parts(trimesh.load(path, process=False, merge_primitives=False))
        return [(f"face {k + 1}", mesh) for k, (_, mesh) in enumerate(whole)]
    return parts


def _numbers(path: Path, data: Any, name: str, faces: int) -> NDArray[Any]:
    """Return the number of each triangle in a PLY file; trimesh loses them where faces have more corners."""
    with suppress(KeyError, ValueError):
        number = np.asarray(data[name]).reshape(-1)
        if len(number) == faces:
            return number
    raise DataError(f"{path} has a {name} of faces with more than three corners, which are divided", "triangles only")


def _obj_groups(text: str, trimesh: Any) -> list[tuple[str, Any]]:
    """Return the surfaces of the groups of an OBJ file; without several, those of its objects or of its materials."""
    line = re.compile(rf"^[ \t]*({'|'.join(_OBJ)})(?:[ \t]+(\S.*?)?)?[ \t\r]*$", re.MULTILINE)
    names = {word: sorted({name for other, name in line.findall(text) if other == word}) for word in _OBJ}
    word = next((word for word in _OBJ if len(names[word]) > 1), _OBJ[0])
    # trimesh joins names and omits those of materials without a file of their own, so that it reads numbers in their place.
    rows = line.sub(lambda found: f"g {names[word].index(found[2] or '')}" if found[1] == word else "", text)
    stream = BytesIO(f"g {len(names[word])}\n{rows}".encode())
    options = {"split_groups": True, "split_objects": False, "group_material": False}
    parts = _parts(trimesh.load(stream, file_type="obj", process=False, **options))
    each = (*names[word], "")
    return [(each[int(number)] if number.isdigit() else each[0], mesh) for number, mesh in parts]
