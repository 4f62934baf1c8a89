"""Runs that are not over, on disk: what a run with particles needs to go on, bit by bit."""

from __future__ import annotations

import hashlib
import io
import json
import os
import socket
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from filelock import FileLock, Timeout
from numpy.typing import NDArray

from rattlebox._util.atomic_io import (
    atomic_write,
    check_format,
    disk_errors,
    remove_temporaries,
    require_folder,
    require_readable,
)
from rattlebox._util.digests import array_digest
from rattlebox._util.exceptions import DataError
from rattlebox.core import _core
from rattlebox.core.choose import instructions
from rattlebox.model.differences import differences
from rattlebox.results.provenance import Provenance

if TYPE_CHECKING:
    from rattlebox.model.case import Case

FORMAT = 3
"""Number of the layout; files of another one are refused."""

_FREE: dict[str, set[str]] = {"method": {"threads", "checkpoint", "checkpoint_every"}, "output": {"snapshots"}}
"""Fields of the case that may change: the bits do not depend on them."""

_LOST = "make room and give the same command again, which goes on from the last checkpoint"


class AnotherRun(DataError):
    """A checkpoint belongs to another run."""


@dataclass(frozen=True)
class Kept:
    """What a checkpoint holds.

    Attributes
    ----------
    numbers
        Fingerprint of all that the core was given.
    time
        How far the run is [s].
    seconds
        Computing time so far [s].
    positions
        Of the particles at the start, in each damper, (n, 3) [m].
    records
        Samples so far.
    state : (bytes,) uint8
        Of the core.
    """

    numbers: str
    time: float
    seconds: float
    positions: tuple[NDArray[np.float64], ...]
    records: _core.Records
    state: NDArray[np.uint8]


def is_checkpoint(path: Path) -> bool:
    """Return whether Rattlebox wrote a checkpoint, whichever run it belongs to.

    Parameters
    ----------
    path
        An existing file.
    """
    try:
        with path.open("rb") as content, np.load(content, allow_pickle=False) as file:
            return bool({"case", "numbers"} <= json.loads(file["about"].tobytes()).keys())
    except Exception:  # NumPy and zipfile raise nearly any exception for damaged files
        return False


class Checkpoint:
    """The file that a run goes on from.

    Parameters
    ----------
    path
        File, which need not exist.
    case
        What is run.
    """

    def __init__(self, path: str | os.PathLike[str], case: Case) -> None:
        self.path = Path(path)
        self.time: float | None = None  # of what is in the file
        self._numbers = ""
        self._about = {"case": bare(case), "version": Provenance.now().version, "core": instructions()}

    @contextmanager
    def held(self) -> Iterator[None]:
        """Be the only run that keeps its state in this file.

        Raises
        ------
        DataError
            When another run does (its hold ends with its process, however that ends), or when the folder is missing or
            cannot be written.
        """
        with disk_errors(self.path, _LOST):
            require_folder(self.path)
            name = self.path.with_name(f".{self.path.name}.lock")
            lock = FileLock(name)
            try:
                lock.acquire(blocking=False)
            except Timeout:
                holder = name.read_text() or "another process"
                raise DataError(
                    f"{self.path} is in use by {holder}\n  try: another file, or wait until that run is over"
                ) from None
        try:
            name.write_text(f"process {os.getpid()} on {socket.gethostname()}")
            remove_temporaries(self.path)
            yield
        finally:
            name.unlink(missing_ok=True)
            lock.release()

    def read(self) -> Kept | None:
        """Return what is in the file, None where there is no file.

        Raises
        ------
        DataError
            When the file is something else, or of another case, version or core; with what differs.
        """
        if not self.path.exists():
            return None
        require_readable(self.path)
        block = "its description"
        try:
            with zipfile.ZipFile(self.path) as archive:
                about = json.loads(_member(archive, "about").tobytes())
                check_format(self.path, about["format"], FORMAT)
                self._compare(about)
                arrays: dict[str, NDArray[Any]] = {}
                for name, digest in about["digests"].items():
                    block = f"the block {name!r}"
                    arrays[name] = _member(archive, name)
                    if array_digest([arrays[name]]).hex() != digest:
                        raise ValueError("the array is not the one that was written")
            groups: dict[str, dict[str, NDArray[Any]]] = {"records": {}, "position": {}}
            for name, array in arrays.items():
                group, _, own = name.partition(".")
                if own:
                    groups[group][own] = array
            positions = tuple(groups["position"][str(k)] for k in range(len(groups["position"])))
            records = _core.Records(**groups["records"])
            kept = Kept(about["numbers"], about["time"], about["seconds"], positions, records, arrays["state"])
        except (DataError, MemoryError):
            raise
        except Exception:
            raise DataError(
                f"{self.path} is not a whole checkpoint: {block} is damaged", "another file, or remove this one"
            ) from None
        self.time = kept.time
        return kept

    def check(self, kept: Kept, packed: _core.DemProblem) -> None:
        """Refuse a checkpoint of a case that reads the same but has other numbers."""
        if kept.numbers != self._fingerprint(packed):
            raise AnotherRun(
                f"{self.path} holds another run\n  the case reads the same but has other numbers: a file that it names has "
                "changed, or a library that prepares it",
                "another file, or remove this one",
            )

    def write(self, dem: _core.Dem, packed: _core.DemProblem, records: _core.Records, seconds: float) -> None:
        """Put a state in the place of the one in the file.

        Raises
        ------
        DataError
            If that cannot be done; the file is then as it was.
        ResourceError
            If no space is left on the disk; likewise.
        """
        time = dem.step * packed.dt
        told = {"format": FORMAT, "time": time, "seconds": seconds, "numbers": self._fingerprint(packed), **self._about}
        arrays = {f"records.{name}": getattr(records, name) for name in records.fields()}
        arrays |= {f"position.{k}": cavity.position for k, cavity in enumerate(packed.cavities)}
        arrays["state"] = dem.save()
        digests = {name: array_digest([array]).hex() for name, array in arrays.items()}
        about = np.frombuffer(json.dumps({**told, "digests": digests}).encode(), np.uint8)
        with atomic_write(self.path, _LOST) as name, name.open("wb") as file:
            np.savez(file, allow_pickle=False, about=about, **arrays)
        self.time = time

    def _fingerprint(self, packed: _core.DemProblem) -> str:
        self._numbers = self._numbers or fingerprint(packed)  # which do not change
        return self._numbers

    def _compare(self, about: Mapping[str, Any]) -> None:
        there = {name: about[name] for name in self._about}
        if lines := differences(there, self._about):
            hint = "another file, or remove this one"
            if len(lines) == 1 and there["core"] != self._about["core"]:
                hint = f"RATTLEBOX_SIMD={there['core']} in the environment, or another file"
            raise AnotherRun("\n".join([f"{self.path} holds another run", *lines]), hint)


def _member(archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    """Read an array whole, so that its checksum is compared before its shape is believed."""
    array: NDArray[Any] = np.lib.format.read_array(io.BytesIO(archive.read(f"{name}.npy")), allow_pickle=False)
    return array


def joined(pieces: Sequence[_core.Records]) -> _core.Records:
    """Return samples that were taken one piece after another as one.

    Parameters
    ----------
    pieces
        Samples, earliest first.
    """
    return _core.Records(
        **{name: np.concatenate([getattr(piece, name) for piece in pieces]) for name in _core.Records.fields()}
    )


def bare(case: Case) -> str:
    """Return the text of a case file without the fields that the results do not depend on.

    Parameters
    ----------
    case
        What is run.
    """
    parts = {name: getattr(case, name) for name in _FREE}
    free = {name: dict.fromkeys(_FREE[name] & type(part).model_fields.keys()) for name, part in parts.items()}
    return case.model_copy(update={name: part.model_copy(update=free[name]) for name, part in parts.items()}).to_toml()


def fingerprint(packed: _core.Node | Mapping[str, Any]) -> str:
    """Return a short text that differs when any number that the core is given differs."""
    digest = hashlib.sha256()

    def add(value: Any) -> None:
        if isinstance(value, _core.Node):
            for name in sorted(value.fields()):
                digest.update(name.encode())
                add(getattr(value, name))
        elif isinstance(value, Mapping):
            for name in sorted(value):
                digest.update(name.encode())
                add(value[name])
        elif isinstance(value, (list, tuple)):
            digest.update(b"%d" % len(value))
            for item in value:
                add(item)
        elif isinstance(value, np.ndarray):
            digest.update(f"{value.dtype}{value.shape}".encode())
            digest.update(np.ascontiguousarray(value).tobytes())
        else:
            digest.update(repr(value).encode())

    add(packed)
    return digest.hexdigest()
