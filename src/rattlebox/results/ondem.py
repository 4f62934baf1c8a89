"""One snapshot in the common data model of the DEM community (ON-DEM), a VTKHDF file for ParaView and other DEM programs.

The group VTKHDF holds the particles as a block of points, with the names of the model; ONDEM holds the scene and the
materials. Integers that do not apply are -1, floats NaN.

References
----------
ON-DEM, COST Action CA22132, work group 3, "File format", https://github.com/ON-DEM/ON-DEM-WG3-FileFormat (state of 2 October
2026).
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.atomic_io import HDF5_ERRORS, atomic_write, check_suffix, require_folder
from rattlebox._util.digests import group_digest
from rattlebox._util.exceptions import DataError
from rattlebox._util.own_files import check_replaceable

if TYPE_CHECKING:
    from rattlebox.model.case import Case

_VERSION = (2, 5)
_BLOCK, _SHAPE = "particles", "sphere"
_DIGEST = "rattlebox_digest"
Node = Any
"""File or group of h5py, which has no types."""

Frame = Any
"""A `snapshots.Frame`, whose module imports this one."""


def is_ondem(path: Path) -> bool:
    """Return whether `write` wrote a file, and nobody has changed it since."""
    import h5py  # type: ignore[import-untyped]

    try:
        with h5py.File(path, "r", locking=False) as file:
            return bool(file.attrs.get(_DIGEST) == _content_digest(file))
    except HDF5_ERRORS:
        return False


def _content_digest(file: Node) -> str:
    """Return the digest of the content, without the links of the assembly."""
    return "".join(group_digest(file[name]) for name in (f"VTKHDF/{_BLOCK}", "ONDEM"))


def write(path: Path, frame: Frame, places: NDArray[np.float64], case: Case) -> Path:
    """Write a snapshot; `places` are the positions at which the cavities are drawn, (D, 3) [m]."""
    if any(damper.rotation is not None for damper in case.particle_dampers):
        raise DataError(
            f"{path} cannot hold particles of a cavity that turns: the model has no frame that turns",
            "the VTKHDF file of the snapshots, whose positions are along the axes of the cavity",
        )
    import h5py

    check_suffix(path, ".vtkhdf")
    require_folder(path)
    check_replaceable(path)
    with atomic_write(path, "free disk space and write the file again") as name, h5py.File(name, "w") as file:
        _write_block(file, frame, places, _materials_of(frame))
        _write_scene(file.create_group("ONDEM/Scene"), frame, case)
        for (damper, species), number in _materials_of(frame).items():
            _write_material(file.create_group(f"ONDEM/Materials/{number}"), number, case, damper, species)
        file.create_group("ONDEM/Interactions")
        file.attrs[_DIGEST] = _content_digest(file)
    return path


def _materials_of(frame: Frame) -> dict[tuple[int, int], int]:
    """Return the number of the material of each species of each cavity."""
    pairs = sorted(set(zip(frame.cavity.tolist(), frame.species.tolist(), strict=True)))
    return {pair: number for number, pair in enumerate(pairs)}


def _write_block(file: Node, frame: Frame, places: NDArray[np.float64], materials: dict[tuple[int, int], int]) -> None:
    """Write the particles as points with one vertex each."""
    import h5py

    count = frame.radius.size
    root = file.create_group("VTKHDF", track_order=True)
    root.attrs.create("Version", np.array(_VERSION, np.int64))
    _write_type(root, "MultiBlockDataSet")
    # The block of the particles, which the assembly names.
    assembly = root.create_group("Assembly", track_order=True)
    block = root.create_group(_BLOCK, track_order=True)
    block.attrs.create("Version", np.array(_VERSION, np.int64))
    _write_type(block, "PolyData")
    block["NumberOfPoints"] = np.array([count], np.int64)
    block["Points"] = frame.position + places[frame.cavity]
    # PolyData needs all four kinds of cells, also those without any.
    for kind in ("Vertices", "Lines", "Polygons", "Strips"):
        cells = count if kind == "Vertices" else 0
        group = block.create_group(kind, track_order=True)
        group["NumberOfCells"] = group["NumberOfConnectivityIds"] = np.array([cells], np.int64)
        group["Offsets"] = np.arange(cells + 1)
        group["Connectivity"] = np.arange(cells)
    inertia = 0.4 * frame.mass * frame.radius**2
    fields: dict[str, Any] = {
        "body_id": np.arange(count),
        "shape_type": np.zeros(count, np.int64),
        "material_id": [materials[pair] for pair in zip(frame.cavity.tolist(), frame.species.tolist(), strict=True)],
        "clump_id": np.full(count, -1),
        "velocity": frame.velocity,
        "angular_velocity": frame.spin,
        "orientation": np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)),
        "mass": frame.mass,
        "volume": 4 / 3 * math.pi * frame.radius**3,
        "inertia": inertia[:, None] * np.eye(3).ravel(),
        "blocked_dofs": np.zeros(count, np.int64),
        "radius": frame.radius,
        "contact_force": frame.contact_force,
        "cavity": frame.cavity,
    }
    data = block.create_group("PointData", track_order=True)
    for name, values in fields.items():
        data[name] = np.asarray(values, np.int64 if np.asarray(values).dtype.kind == "i" else np.float64)
    data["orientation"].attrs["order"] = "wxyz"
    assembly[_BLOCK] = h5py.SoftLink(f"/VTKHDF/{_BLOCK}")


def _write_type(group: Node, text: str) -> None:
    """Write the type of a group as VTK expects it, in ASCII characters of a fixed number."""
    group.attrs.create("Type", text.encode(), dtype=f"S{len(text)}")


def _write_scene(scene: Node, frame: Frame, case: Case) -> None:
    """Write time, gravity, units and names; the step of the run is not in a snapshot."""
    scene.attrs["time"] = frame.time
    scene.attrs["timestep"] = math.nan
    scene.attrs["iteration"] = -1
    scene["gravity"] = np.array(case.particle_dampers[0].gravity, float)
    scene["units"] = ["second", "meter", "kilogram"]
    scene["display_group_names"] = [_BLOCK]
    scene["shape_names"] = [_SHAPE]


def _write_material(group: Node, number: int, case: Case, damper: int, species: int) -> None:
    """Write the constants of a material; laws of contacts have no common names yet."""
    material = case.particle_dampers[damper].particles[species].material
    group["id"] = np.int64(number)
    for name in ("density", "young", "poisson"):
        group[name] = np.float64(getattr(material, name))
    group["friction_coefficient"] = np.float64(getattr(case.particle_dampers[damper].friction, "coefficient", math.nan))
    group["label"] = np.bytes_((material.name or f"material {number}").encode())
