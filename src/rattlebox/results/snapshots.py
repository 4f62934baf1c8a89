"""Snapshots of all particles in one VTKHDF file, which grows during a run and opens in ParaView.

The file is a PolyData with time steps (VTKHDF 2): points with radius, velocity and spin, the walls of the cavities as
polygons, and the displacement of each cavity as field data. The corners of the walls are the last points, with radius 0 and
species -1.

All space is allocated when the file is created, and each snapshot only overwrites numbers. Earlier snapshots therefore
survive when the process is killed.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.atomic_io import (
    HDF5_ERRORS,
    atomic_write,
    check_format,
    disk_errors,
    require_readable,
    reserve_space,
    sync,
    watch,
)
from rattlebox._util.digests import SIZE, array_digest, group_digest
from rattlebox._util.exceptions import DataError
from rattlebox._util.own_files import register_format
from rattlebox.model.space import wrapped
from rattlebox.model.surfaces import Surface

from . import ondem
from .arrays import FloatArray, IntArray

if TYPE_CHECKING:
    from rattlebox.core import _core

Node = Any
"""File or group of h5py, which has no types."""

FORMAT = 4
"""Version of the layout beyond VTKHDF; files of other versions are rejected."""

_DIGESTS = "digests"
"""Dataset outside the VTKHDF group: digest of each snapshot, zero until it is written, (steps, SIZE)."""

ROOT = "VTKHDF"
"""Root group of a VTKHDF file."""

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_MOVING = {"velocity": (3,), "spin": (3,), "contact_force": ()}
_FIXED = ("radius", "mass", "cavity", "species")
_OFFSETS, _LAYOUT = 25, 1 << 16
"""Number of offsets stored for each snapshot; upper bound of the size of names, offsets and shapes [bytes]."""

_HEAD = 1 << 20
"""Length of the first part of a file, which contains the name of the format attribute [bytes]."""

_DAMAGE_HINT = "a copy of the file, or run the case again"
_DISK_HINT = "free disk space and repeat the call, with fewer snapshots or another folder"


@dataclass(frozen=True)
class Frame:
    """The particles at one time.

    Attributes
    ----------
    time
        Time [s].
    position : (N, 3) float
        Position from the rest position of the centre of the particle's cavity [m].
    velocity : (N, 3) float
        Velocity relative to the base [m/s].
    spin : (N, 3) float
        Angular velocity [rad/s].
    contact_force : (N,) float
        Sum of the magnitudes of the contact forces on the particle [N]; it is large in force chains.
    radius : (N,) float
        Radius [m].
    mass : (N,) float
        Mass [kg].
    cavity : (N,) int
        Index of the cavity.
    species : (N,) int
        Index of the species.
    displacement : (D, 3) float
        Displacement of each cavity [m].
    """

    time: float
    position: FloatArray
    velocity: FloatArray
    spin: FloatArray
    contact_force: FloatArray
    radius: FloatArray
    mass: FloatArray
    cavity: IntArray
    species: IntArray
    displacement: FloatArray


def is_snapshots(path: Path) -> bool:
    """Return whether a file is a snapshot file of Rattlebox, intact or damaged."""
    import h5py  # type: ignore[import-untyped]

    with path.open("rb") as file:
        head = file.read(_HEAD)
    if not head.startswith(_SIGNATURE):
        return False
    try:
        with h5py.File(path, "r", locking=False) as content:
            return "rattlebox_format" in content.attrs and ROOT in content
    except HDF5_ERRORS:  # the file is damaged
        return b"rattlebox_format" in head


register_format(".vtkhdf", lambda path: is_snapshots(path) or ondem.is_ondem(path))

_GROWING = frozenset(
    (
        _DIGESTS,
        f"{ROOT}/Points",
        f"{ROOT}/FieldData/displacement",
        f"{ROOT}/Steps@NSteps",
        *(f"{ROOT}/PointData/{field}" for field in _MOVING),
    )
)
"""Parts of the file that change after its creation; the digest of the file does not cover their values."""


class SnapshotFile:
    """Writer of a snapshot file.

    Parameters
    ----------
    times : (n,)
        Times of all snapshots [s].
    places : (D, 3)
        Position at which each cavity is drawn [m]. A case does not define positions of cavities.
    fixed
        Arrays "radius", "mass", "cavity" and "species" of the particles, (N,).
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        times: FloatArray,
        places: FloatArray,
        fixed: Mapping[str, NDArray[Any]],
        walls: Sequence[Surface],
        case_toml: str,
        numbers: str,
        periods: FloatArray | None = None,
    ) -> None:
        self.path = Path(path)
        self._times, self._places, self._walls = times, places, tuple(walls)
        self._periods = np.zeros_like(places) if periods is None else periods  # of each cavity, (D, 3) [m]
        self._particles = int(fixed["radius"].size)
        self._wall_cavity = np.repeat(np.arange(len(walls)), [len(wall.points) for wall in walls])
        of_walls: dict[str, Any] = {"radius": 0.0, "mass": 0.0, "cavity": self._wall_cavity, "species": -1}
        self._fixed = {
            name: np.concatenate([values, np.broadcast_to(of_walls[name], self._wall_cavity.size)]).astype(values.dtype)
            for name, values in fixed.items()
        }
        self._case, self._numbers = case_toml, numbers

    def create(self) -> None:
        """Create the file without snapshots; it replaces an earlier one."""
        import h5py

        if os.path.lexists(self.path) and not (self.path.is_file() and is_snapshots(self.path)):
            raise DataError(f"{self.path} is not a snapshot file and is not overwritten", "another file")
        with watch([self.path]), atomic_write(self.path, _DISK_HINT) as name:
            reserve_space(name, self._size())
            with h5py.File(name, "w") as file:
                self._create_datasets(file)
            with h5py.File(name, "r+") as file:
                file.attrs["digest"] = group_digest(file, _GROWING)
            reserve_space(name, name.stat().st_size)  # a sparse file could fail later on a full disk

    def _size(self) -> int:
        """Return an upper bound of the size of the file [bytes]."""
        steps, count, cavities = self._times.size, self._fixed["radius"].size, len(self._places)
        moving = 3 + sum(math.prod(shape) for shape in _MOVING.values())
        corners = sum(1 + len(polygon) for wall in self._walls for polygon in wall.polygons)
        numbers = steps * (moving * count + 3 * cavities + _OFFSETS) + len(_FIXED) * count + 3 * cavities
        numbers += 2 * self._particles + corners
        return 8 * numbers + SIZE * steps + len(self._case.encode()) + _LAYOUT

    def _create_datasets(self, file: Node) -> None:
        """Create all datasets and write those that do not change."""
        steps, count, cavities = self._times.size, self._fixed["radius"].size, len(self._places)
        file.attrs["rattlebox_format"] = FORMAT
        file.attrs["particles"] = self._particles
        file.attrs["case"] = self._case
        file.attrs["numbers"] = self._numbers
        root = file.create_group(ROOT)
        root.attrs["Version"] = (2, 0)
        root.attrs.create("Type", b"PolyData", dtype="S8")
        root["NumberOfPoints"] = [count]
        root.create_dataset("Points", (steps * count, 3), "f8")
        # ParaView draws particles as vertices and walls as polygons of one list of points.
        particles, polygons = np.arange(self._particles + 1), self._polygons()
        corners = np.array([corner for polygon in polygons for corner in polygon], np.int64)
        cells = {"Vertices": (particles, particles[:-1]), "Polygons": (np.cumsum([0, *map(len, polygons)]), corners)}
        for kind in ("Vertices", "Lines", "Polygons", "Strips"):
            offsets, connectivity = cells.get(kind, (np.zeros(1, np.int64), np.zeros(0, np.int64)))
            root[f"{kind}/NumberOfCells"] = [offsets.size - 1]
            root[f"{kind}/NumberOfConnectivityIds"] = [connectivity.size]
            root[f"{kind}/Offsets"] = offsets
            root[f"{kind}/Connectivity"] = connectivity
        # For each step a reader needs the offset of its values: those that move have a block each, the others share one.
        every, once = np.arange(steps), np.zeros(steps, np.int64)
        catalogue = root.create_group("Steps")
        catalogue.attrs["NSteps"] = 0
        catalogue["Values"] = self._times
        catalogue["NumberOfParts"] = np.ones(steps, np.int64)
        catalogue["PartOffsets"] = once
        catalogue["PointOffsets"] = every * count
        catalogue["CellOffsets"] = np.zeros((steps, 4), np.int64)
        catalogue["ConnectivityIdOffsets"] = np.zeros((steps, 4), np.int64)
        for field, shape in _MOVING.items():
            root.create_dataset(f"PointData/{field}", (steps * count, *shape), "f8")
            catalogue[f"PointDataOffsets/{field}"] = every * count
        for field in _FIXED:
            root[f"PointData/{field}"] = self._fixed[field]
            catalogue[f"PointDataOffsets/{field}"] = once
        root.create_dataset("FieldData/displacement", (steps * cavities, 3), "f8")
        catalogue["FieldDataOffsets/displacement"] = every * cavities
        catalogue["FieldDataSizes/displacement"] = np.tile([3, cavities], (steps, 1))
        root["FieldData/place"] = self._places
        catalogue["FieldDataOffsets/place"] = once
        catalogue["FieldDataSizes/place"] = np.tile([3, cavities], (steps, 1))
        # HDF5 allocates storage with the first values; later writes then change only numbers.
        file.create_dataset(_DIGESTS, (steps, SIZE), "u1")
        moving = (root["Points"], *(root[f"PointData/{f}"] for f in _MOVING), root["FieldData/displacement"])
        for dataset in (*moving, file[_DIGESTS]):
            if dataset.size:
                dataset[-1] = 0

    def _polygons(self) -> list[Sequence[int]]:
        """Return the points of each polygon of the walls, which follow those of the particles."""
        polygons: list[Sequence[int]] = []
        first = self._particles
        for wall in self._walls:
            polygons += [[first + corner for corner in polygon] for polygon in wall.polygons]
            first += len(wall.points)
        return polygons

    def sync(self) -> None:
        """Flush the snapshots to the disk."""
        if self.path.exists():
            with disk_errors(self.path, _DISK_HINT):
                sync(self.path)

    @property
    def written(self) -> int:
        """Number of snapshots of this run in the file; 0 without a file."""
        if not self.path.exists():
            return 0
        stored = Snapshots(self.path)
        same = stored.numbers == self._numbers and np.array_equal(stored.planned, self._times)
        return len(stored) if same else 0

    def append(self, number: int, cavities: Sequence[_core.CavityState], contacts: Sequence[_core.ContactList]) -> None:
        """Write the next snapshot."""
        import h5py

        # The walls move with their cavities, so their corners are points of each snapshot, too.
        displacement = np.array([each.displacement for each in cavities])
        moving = {
            "velocity": [each.velocity for each in cavities],
            "spin": [each.spin for each in cavities],
            "contact_force": [
                _force_sums(touching, len(each.position)) for each, touching in zip(cavities, contacts, strict=True)
            ],
        }
        placed = [
            _inside(each, period) + place
            for each, period, place in zip(cavities, self._periods, self._places, strict=True)
        ]
        placed += [wall.points + moved for wall, moved in zip(self._walls, displacement + self._places, strict=True)]
        for field, shape in _MOVING.items():  # the corners of the walls have neither spin nor contacts
            moving[field].append(np.zeros((self._wall_cavity.size, *shape)))
        # Without a lock, other programs can read the file during the run.
        with disk_errors(self.path, _DISK_HINT), h5py.File(self.path, "r+", locking=False) as file:
            root, blocks = file[ROOT], _blocks(number, self._fixed["radius"].size, len(cavities))
            fields = {field: np.concatenate(moving[field]) for field in _MOVING}
            parts = [np.concatenate(placed), *fields.values(), displacement]
            for (name, rows), part in zip(blocks.items(), parts, strict=True):
                root[name][rows] = part
            file.flush()
            # The digest follows the values, and the count of the steps the digest, so that a process that is killed
            # in between leaves a snapshot that is recognised as incomplete.
            file[_DIGESTS][number] = np.frombuffer(
                array_digest(root[name][rows] for name, rows in blocks.items()), "u1"
            )
            file.flush()
            root["Steps"].attrs.modify("NSteps", max(number + 1, int(root["Steps"].attrs["NSteps"])))


def _inside(cavity: _core.CavityState, period: FloatArray) -> FloatArray:
    """Return the positions of particles, of the images inside of a periodic cavity, (n, 3) [m]."""
    position, centre = cavity.position, cavity.displacement
    return centre + wrapped(position - centre, period) if period.any() else np.asarray(position)


def _blocks(number: int, count: int, cavities: int) -> dict[str, slice]:
    """Return the datasets of a snapshot and its rows in each."""
    rows = slice(number * count, (number + 1) * count)
    names = ("Points", *(f"PointData/{field}" for field in _MOVING))
    return dict.fromkeys(names, rows) | {"FieldData/displacement": slice(number * cavities, (number + 1) * cavities)}


def _force_sums(touching: _core.ContactList, count: int) -> FloatArray:
    """Return the sum of the force magnitudes on each particle, (count,); walls are numbered after the particles."""
    force = np.linalg.norm(touching.force, axis=1)
    sides = np.concatenate([touching.first, touching.second])
    return np.asarray(np.bincount(sides, np.tile(force, 2), minlength=count)[:count])


class Snapshots:
    """The snapshots of a run: a sequence of `Frame`, each read from the file on access.

    Parameters
    ----------
    path
        Snapshot file of a run.

    Attributes
    ----------
    times : (n,) float
        Times of the snapshots in the file [s].
    planned : (m,) float
        Times of all snapshots of the run, m >= n [s].
    case_toml
        Text of the case file.

    Raises
    ------
    DataError
        If the file does not exist, cannot be read, holds no snapshots of particles, is damaged, or has another format.

    References
    ----------
    Kitware, "VTKHDF file format", https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/index.html.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        with self._open() as file:
            self._check_format(file)
            if file.attrs.get("digest") != group_digest(file, _GROWING):
                raise self._damaged("its description")
            self.case_toml, self.numbers = str(file.attrs["case"]), str(file.attrs["numbers"])
            root = file[ROOT]
            self.planned: FloatArray = root["Steps/Values"][...]
            self._particles = int(file.attrs["particles"])
            self._points = int(root["NumberOfPoints"][0])
            self._fixed = {field: root[f"PointData/{field}"][: self._particles] for field in _FIXED}
            self._places: FloatArray = root["FieldData/place"][...]
            self.times = self.planned[: self._count_complete(file)]

    @contextmanager
    def _open(self) -> Iterator[Node]:
        """Open the file for reading; report errors of HDF5 as damage."""
        import h5py

        require_readable(self.path)
        try:
            with h5py.File(self.path, "r", locking=False) as file:
                yield file
        except DataError:
            raise
        except HDF5_ERRORS as error:
            raise DataError(f"{self.path} is not an intact HDF5 file", _DAMAGE_HINT) from error

    def _check_format(self, file: Node) -> None:
        """Raise if an HDF5 file holds no snapshots, or snapshots of another format."""
        layout = file.attrs.get("rattlebox_format")
        if layout is None or ROOT not in file:
            raise DataError(
                f"{self.path} holds no snapshots of particles written by Rattlebox", "run.vtkhdf of a particle run"
            )
        check_format(self.path, layout, FORMAT)

    def _damaged(self, block: str) -> DataError:
        return DataError(f"{self.path} is damaged: {block} has changed", _DAMAGE_HINT)

    def _count_complete(self, file: Node) -> int:
        """Return the number of complete snapshots.

        A process that is killed while it writes a snapshot may leave one with a wrong digest, or a complete one that
        NSteps, which ParaView reads, does not count yet.
        """
        # Snapshots are written in order: those with a digest are the first ones.
        written = np.any(file[_DIGESTS][...], axis=1)
        complete = int(written.size if written.all() else written.argmin())
        listed = int(file[ROOT]["Steps"].attrs["NSteps"])
        if listed not in (complete, complete - 1):
            raise self._damaged("the number of its steps")
        return complete - (listed < complete and self._read(file, complete - 1) is None)

    def _read(self, file: Node, number: int) -> list[FloatArray] | None:
        """Return points, moving fields and displacements of a snapshot; None if it is damaged."""
        blocks = _blocks(number, self._points, len(self._places))
        parts = [file[ROOT][name][rows] for name, rows in blocks.items()]
        return parts if array_digest(parts) == file[_DIGESTS][number].tobytes() else None

    def to_ondem(self, path: str | os.PathLike[str], number: int = -1) -> Path:
        """Write one snapshot with the names of the common data model of the DEM community (ON-DEM), a VTKHDF file.

        Parameters
        ----------
        path
            File to write (.vtkhdf). A file that Rattlebox did not write, or that has changed since, is not replaced.
        number
            Number of the snapshot, from 0; default the last one.

        Returns
        -------
        Path
            The file. It opens in ParaView.

        Raises
        ------
        CaseError
            If a file that the case names can no longer be read.
        DataError
            If the file cannot be written or must not be replaced, or is that of the snapshots.
        ResourceError
            If no space is left on the disk.

        Notes
        -----
        Cavities stand side by side, as in the file of the snapshots. Walls and contacts are not written: the model has no
        shapes for them yet, and a snapshot no history of contacts. The rotations of spheres are not computed: their
        orientation is (1, 0, 0, 0).

        References
        ----------
        ON-DEM, COST Action CA22132, "File format", https://github.com/ON-DEM/ON-DEM-WG3-FileFormat.
        """
        from rattlebox.model.case import Case

        file = Path(path)
        if file.exists() and file.samefile(self.path):
            raise DataError(f"{file} is the file of the snapshots", "another name")
        return ondem.write(file, self[number], self._places, Case.from_toml(self.case_toml))

    def __len__(self) -> int:
        return int(self.times.size)

    def __iter__(self) -> Iterator[Frame]:
        return (self[number] for number in range(len(self)))

    @overload
    def __getitem__(self, number: int) -> Frame: ...

    @overload
    def __getitem__(self, number: slice) -> list[Frame]: ...

    def __getitem__(self, number: int | slice) -> Frame | list[Frame]:
        if isinstance(number, slice):
            return [self[n] for n in range(*number.indices(len(self)))]
        if not -len(self) <= number < len(self):
            raise IndexError(f"{self.path} holds {len(self)} snapshots; {number} is not from 0 to {len(self) - 1}")
        number %= len(self)
        with self._open() as file:
            parts = self._read(file, number)
        if parts is None:
            raise self._damaged(f"snapshot {number}")
        *of_points, displacement = parts
        points, velocity, spin, contact_force = (part[: self._particles] for part in of_points)
        return Frame(
            time=float(self.times[number]),
            position=points - self._places[self._fixed["cavity"]],
            velocity=velocity,
            spin=spin,
            contact_force=contact_force,
            displacement=displacement,
            **self._fixed,
        )
