"""Where all particles are at chosen times, in one VTKHDF file that grows during a run and opens in ParaView.

The file is a PolyData with time steps (VTKHDF 2): points with radius, velocity and spin, and the displacement of each
cavity as field data. Nothing but numbers at fixed places changes after the first snapshot, so that whatever ends the
process, the snapshots before are there.
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
)
from rattlebox._util.digests import SIZE, array_digest, group_digest
from rattlebox._util.exceptions import DataError

from .arrays import FloatArray, IntArray

if TYPE_CHECKING:
    from rattlebox.core import _core

FORMAT = 2
"""Number of the layout beside the VTKHDF; files of another one are refused."""

_DIGESTS = "digests"
"""Dataset beside the VTKHDF: the digest of each snapshot, zero before it is written, (steps, SIZE)."""

ROOT = "VTKHDF"
"""Group of a VTKHDF file that holds everything."""

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_MOVING = {"velocity": (3,), "spin": (3,), "push": ()}
_FIXED = ("radius", "mass", "cavity", "species")
_OFFSETS, _LAYOUT = 25, 1 << 16
"""Numbers of a snapshot that tell where it is; what names, places and sizes take at most [bytes]."""

_HEAD = 1 << 20
"""Length of the first part of a file, in which the name of our attribute lies [bytes]."""

_AGAIN = "a copy of the file, or run the case again"
_LOST = "make room and give the same call again, with fewer snapshots or another folder"


@dataclass(frozen=True)
class Frame:
    """The particles at one time.

    Attributes
    ----------
    time
        [s].
    position, velocity, spin : (N, 3) float
        From the rest place of the centre of the particle's own cavity [m], relative to the base [m/s], [rad/s].
    push : (N,) float
        Sum of the magnitudes of the forces that touch it [N]; where it is large, force chains are.
    radius, mass : (N,) float
        [m], [kg].
    cavity, species : (N,) int
        Numbers, from 0.
    displacement : (D, 3) float
        Of each cavity [m].
    """

    time: float
    position: FloatArray
    velocity: FloatArray
    spin: FloatArray
    push: FloatArray
    radius: FloatArray
    mass: FloatArray
    cavity: IntArray
    species: IntArray
    displacement: FloatArray


def is_snapshots(path: Path) -> bool:
    """Return whether Rattlebox wrote a file of snapshots, which may be damaged.

    Parameters
    ----------
    path
        An existing file.
    """
    import h5py  # type: ignore[import-untyped]

    with path.open("rb") as file:
        begin = file.read(_HEAD)
    if not begin.startswith(_SIGNATURE):
        return False
    try:
        with h5py.File(path, "r", locking=False) as content:
            return "rattlebox_format" in content.attrs and ROOT in content
    except HDF5_ERRORS:  # it is damaged
        return b"rattlebox_format" in begin


_GROWING = frozenset(
    (
        _DIGESTS,
        f"{ROOT}/Points",
        f"{ROOT}/FieldData/displacement",
        f"{ROOT}/Steps@NSteps",
        *(f"{ROOT}/PointData/{field}" for field in _MOVING),
    )
)
"""Parts of the file that change after it was made; the digest of the file does not cover their values."""


class SnapshotFile:
    """The file that a run adds snapshots to.

    Parameters
    ----------
    path
        File to write.
    times : (n,)
        Of all snapshots [s].
    places : (D, 3)
        Where each cavity is drawn [m]: cavities have no place of their own in a case, so they stand side by side.
    fixed
        "radius", "mass", "cavity" and "species" of the particles, (N,).
    case_toml
        The case, as the text of a case file.
    numbers
        What tells the run from others.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        times: FloatArray,
        places: FloatArray,
        fixed: Mapping[str, NDArray[Any]],
        case_toml: str,
        numbers: str,
    ) -> None:
        self.path = Path(path)
        self._times, self._places, self._fixed = times, places, fixed
        self._case, self._numbers = case_toml, numbers

    def create(self) -> None:
        """Make the file, without a snapshot, in the place of an earlier one.

        Raises
        ------
        DataError
            When something else than snapshots is in its place, or the file cannot be written.
        ResourceError
            When no space is left on the disk.
        """
        import h5py

        if self.path.is_file() and not is_snapshots(self.path):
            raise DataError(f"{self.path} holds no snapshots, and is kept", "another file for the snapshots")
        with atomic_write(self.path, _LOST) as name:
            reserve_space(name, self._room())
            with h5py.File(name, "w") as file:
                self._lay_out(file)
            with h5py.File(name, "r+") as file:
                file.attrs["digest"] = group_digest(file, _GROWING)
            reserve_space(name, name.stat().st_size)  # no holes that are to be filled when the disk may be full

    def _room(self) -> int:
        """How large the file is, or a little more [bytes]."""
        steps, count, cavities = self._times.size, self._fixed["radius"].size, len(self._places)
        moving = 3 + sum(math.prod(shape) for shape in _MOVING.values())
        numbers = steps * (moving * count + 3 * cavities + _OFFSETS) + (2 + len(_FIXED)) * count + 3 * cavities
        return 8 * numbers + SIZE * steps + len(self._case.encode()) + _LAYOUT

    def _lay_out(self, file: Any) -> None:
        """Make the places of all numbers, and write those that do not change."""
        steps, count, cavities = self._times.size, self._fixed["radius"].size, len(self._places)
        file.attrs["rattlebox_format"] = FORMAT
        file.attrs["case"] = self._case
        file.attrs["numbers"] = self._numbers
        root = file.create_group(ROOT)
        root.attrs["Version"] = (2, 0)
        root.attrs.create("Type", b"PolyData", dtype="S8")
        root["NumberOfPoints"] = [count]
        root.create_dataset("Points", (steps * count, 3), "f8")
        for cells in ("Vertices", "Lines", "Polygons", "Strips"):
            number = count if cells == "Vertices" else 0
            root[f"{cells}/NumberOfCells"] = [number]
            root[f"{cells}/NumberOfConnectivityIds"] = [number]
            root[f"{cells}/Offsets"] = np.arange(number + 1)
            root[f"{cells}/Connectivity"] = np.arange(number)
        every, once = np.arange(steps), np.zeros(steps, np.int64)
        kept = root.create_group("Steps")
        kept.attrs["NSteps"] = 0
        kept["Values"] = self._times
        kept["NumberOfParts"] = np.ones(steps, np.int64)
        kept["PartOffsets"] = once
        kept["PointOffsets"] = every * count
        kept["CellOffsets"] = np.zeros((steps, 4), np.int64)
        kept["ConnectivityIdOffsets"] = np.zeros((steps, 4), np.int64)
        for field, shape in _MOVING.items():
            root.create_dataset(f"PointData/{field}", (steps * count, *shape), "f8")
            kept[f"PointDataOffsets/{field}"] = every * count
        for field in _FIXED:
            root[f"PointData/{field}"] = self._fixed[field]
            kept[f"PointDataOffsets/{field}"] = once
        root.create_dataset("FieldData/displacement", (steps * cavities, 3), "f8")
        kept["FieldDataOffsets/displacement"] = every * cavities
        kept["FieldDataSizes/displacement"] = np.tile([3, cavities], (steps, 1))
        root["FieldData/place"] = self._places
        kept["FieldDataOffsets/place"] = once
        kept["FieldDataSizes/place"] = np.tile([3, cavities], (steps, 1))
        # Storage is given out with the first values, and nothing but numbers changes later.
        file.create_dataset(_DIGESTS, (steps, SIZE), "u1")
        moving = (root["Points"], *(root[f"PointData/{f}"] for f in _MOVING), root["FieldData/displacement"])
        for dataset in (*moving, file[_DIGESTS]):
            if dataset.size:
                dataset[-1] = 0

    def sync(self) -> None:
        """Wait until the snapshots are on the disk.

        Raises
        ------
        DataError
            If they cannot be written.
        ResourceError
            If no space is left on the disk.
        """
        if self.path.exists():
            with disk_errors(self.path, _LOST):
                sync(self.path)

    @property
    def taken(self) -> int:
        """Number of snapshots of this very run in the file; 0 without a file.

        Raises
        ------
        DataError
            When the file is something else, or torn.
        """
        if not self.path.exists():
            return 0
        found = Snapshots(self.path)
        same = found.numbers == self._numbers and np.array_equal(found.planned, self._times)
        return len(found) if same else 0

    def take(self, number: int, cavities: Sequence[_core.CavityState], contacts: Sequence[_core.ContactList]) -> None:
        """Add a snapshot.

        Parameters
        ----------
        number
            Which one, from 0; those before it are there.
        cavities, contacts
            State of the particles and their contacts, for each cavity.

        Raises
        ------
        DataError
            If it cannot be written.
        ResourceError
            If no space is left on the disk.
        """
        import h5py

        displacement = np.array([each.displacement for each in cavities])
        moving = {
            "velocity": [each.velocity for each in cavities],
            "spin": [each.spin for each in cavities],
            "push": [_pushes(one, len(each.position)) for each, one in zip(cavities, contacts, strict=True)],
        }
        placed = [each.position + place for each, place in zip(cavities, self._places, strict=True)]
        # Without a lock, so that others may look at the file during the run.
        with disk_errors(self.path, _LOST), h5py.File(self.path, "r+", locking=False) as file:
            root, blocks = file[ROOT], _blocks(number, self._fixed["radius"].size, len(cavities))
            fields = {field: np.concatenate(moving[field]) for field in _MOVING}
            parts = [np.concatenate(placed), *fields.values(), displacement]
            for (name, rows), part in zip(blocks.items(), parts, strict=True):
                root[name][rows] = part
            file.flush()
            file[_DIGESTS][number] = np.frombuffer(
                array_digest(root[name][rows] for name, rows in blocks.items()), "u1"
            )
            file.flush()
            root["Steps"].attrs.modify("NSteps", max(number + 1, int(root["Steps"].attrs["NSteps"])))


def _blocks(number: int, count: int, cavities: int) -> dict[str, slice]:
    """Datasets of the VTKHDF that hold a snapshot, and its rows in each."""
    rows = slice(number * count, (number + 1) * count)
    names = ("Points", *(f"PointData/{field}" for field in _MOVING))
    return dict.fromkeys(names, rows) | {"FieldData/displacement": slice(number * cavities, (number + 1) * cavities)}


def _pushes(touching: _core.ContactList, count: int) -> FloatArray:
    """Sum of the forces on each particle, by magnitude, (count,); walls are numbered after the particles."""
    force = np.linalg.norm(touching.force, axis=1)
    sides = np.concatenate([touching.first, touching.second])
    return np.asarray(np.bincount(sides, np.tile(force, 2), minlength=count)[:count])


class Snapshots:
    """The snapshots of a run, read when they are used.

    Parameters
    ----------
    path
        File that a run wrote.

    Raises
    ------
    DataError
        When there is no such file, or it cannot be read, holds no snapshots of particles, is damaged, or has another format.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        with self._opened() as file:
            self._check_format(file)
            if file.attrs.get("digest") != group_digest(file, _GROWING):
                raise self._damaged("its description")
            self.case_toml, self.numbers = str(file.attrs["case"]), str(file.attrs["numbers"])
            root = file[ROOT]
            self.planned: FloatArray = root["Steps/Values"][...]
            self._fixed = {field: root[f"PointData/{field}"][...] for field in _FIXED}
            self._places: FloatArray = root["FieldData/place"][...]
            self.times = self.planned[: self._taken(file)]

    @contextmanager
    def _opened(self) -> Iterator[Any]:
        """Open the file to read; errors of HDF5 meanwhile are reported as damage."""
        import h5py

        require_readable(self.path)
        try:
            with h5py.File(self.path, "r", locking=False) as file:
                yield file
        except DataError:
            raise
        except HDF5_ERRORS as error:
            raise DataError(f"{self.path} is not an HDF5 file that is whole", _AGAIN) from error

    def _check_format(self, file: Any) -> None:
        """Raise if a file of HDF5 holds no snapshots, or snapshots of another format."""
        layout = file.attrs.get("rattlebox_format")
        if layout is None or ROOT not in file:
            raise DataError(f"{self.path} holds no snapshots of particles written by Rattlebox")
        check_format(self.path, layout, FORMAT)

    def _damaged(self, block: str) -> DataError:
        return DataError(f"{self.path} is damaged: {block} is not as it was written", _AGAIN)

    def _taken(self, file: Any) -> int:
        """Number of snapshots that are complete.

        A process that is killed while it writes a snapshot may leave one that its digest does not fit, or one that
        is complete and not yet in the number of steps that ParaView reads.
        """
        written = np.any(file[_DIGESTS][...], axis=1)
        taken = int(written.size if written.all() else written.argmin())
        listed = int(file[ROOT]["Steps"].attrs["NSteps"])
        if listed not in (taken, taken - 1):
            raise self._damaged("the number of its steps")
        return taken - (listed < taken and self._read(file, taken - 1) is None)

    def _read(self, file: Any, number: int) -> list[FloatArray] | None:
        """Points, moving fields and displacements of a snapshot; None if it is damaged."""
        blocks = _blocks(number, self._fixed["radius"].size, len(self._places))
        parts = [file[ROOT][name][rows] for name, rows in blocks.items()]
        return parts if array_digest(parts) == file[_DIGESTS][number].tobytes() else None

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
            raise IndexError(f"{self.path} holds {len(self)} snapshots, numbered from 0; there is no number {number}")
        number %= len(self)
        with self._opened() as file:
            parts = self._read(file, number)
        if parts is None:
            raise self._damaged(f"snapshot {number}")
        points, velocity, spin, push, displacement = parts
        return Frame(
            time=float(self.times[number]),
            position=points - self._places[self._fixed["cavity"]],
            velocity=velocity,
            spin=spin,
            push=push,
            displacement=displacement,
            **self._fixed,
        )
