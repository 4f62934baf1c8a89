"""Closed surfaces of triangles from STL, OBJ, PLY, OFF and STEP files, read by trimesh."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import DataError
from rattlebox._util.optional_imports import optional_import

from .guarded import errors_of

STEP = (".step", ".stp")
ENDINGS = (".stl", ".obj", ".ply", ".off", *STEP)


def read_surface(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return corners in the unit of the file, (n, 3), and triangles, (m, 3); a STEP file is triangulated, in mm."""
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise DataError(f"{path} has no ending of a surface", f"a file that ends in {', '.join(ENDINGS)}")
    if ending in STEP:
        optional_import("cascadio", "cad", "export the surface as STL")
    trimesh = optional_import("trimesh", "mesh", "pass the arrays vertices and faces")
    with errors_of(path, f"a surface in {ending}"):
        loaded = trimesh.load(path, process=False)
        # Several bodies of a file become one surface; its shells are separated again by their edges.
        mesh = loaded.to_mesh() if hasattr(loaded, "to_mesh") else loaded
        vertices, faces = getattr(mesh, "vertices", None), getattr(mesh, "faces", None)
        if vertices is None or faces is None or not len(faces):
            raise DataError(f"{path} contains no triangles", "a surface of triangles, not of points or lines")
        scale = 1e3 if ending in STEP else 1.0  # the triangulation is in metres
        return scale * np.array(vertices, dtype=np.float64), np.array(faces, dtype=np.int64)
