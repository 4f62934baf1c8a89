"""Checkpoints of particle runs: the state from which a run resumes bit by bit."""

from __future__ import annotations

import io
import json
import os
import socket
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

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
    watch,
)
from rattlebox._util.digests import array_digest
from rattlebox._util.exceptions import DataError
from rattlebox._util.own_files import register_format
from rattlebox.core import _core
from rattlebox.core.choose import instructions
from rattlebox.engines.fingerprint import fingerprint
from rattlebox.model.differences import differences
from rattlebox.model.foreign_code import foreign_code
from rattlebox.results.provenance import Provenance, with_version

if TYPE_CHECKING:
    from rattlebox.model.case import Case

FORMAT = 4
"""Version of the layout; files of other versions are rejected."""
EARLIER = (3,)
"""Formats whose description is read, so that messages name the version that resumes the run."""

_FREE_FIELDS: dict[str, set[str]] = {"method": {"threads", "checkpoint", "checkpoint_every"}, "output": {"snapshots"}}
"""Fields of the case that may differ when a run resumes: the results do not depend on them."""

_OTHER_FILE = "another file, or remove this one"
_DISK_HINT = "free disk space and give the same command again; it resumes from the last checkpoint"


class CheckpointMismatch(DataError):
    """The checkpoint belongs to another run."""


@dataclass(frozen=True)
class CheckpointData:
    """Content of a checkpoint file."""

    numbers: str
    time: float  # Simulated time that the run has reached [s]
    seconds: float  # Computing time so far [s]
    positions: tuple[NDArray[np.float64], ...]  # Start positions of the particles of each damper, (n, 3) [m]
    records: _core.Records
    state: NDArray[np.uint8]  # State of the core, (bytes,)


def is_checkpoint(path: Path) -> bool:
    """Return whether a file is a Rattlebox checkpoint, of any run."""
    try:
        with path.open("rb") as content, np.load(content, allow_pickle=False) as file:
            return bool({"case", "numbers"} <= json.loads(file["about"].tobytes()).keys())
    except Exception:  # NumPy and zipfile raise nearly any exception for damaged files
        return False


register_format(".checkpoint", is_checkpoint)


class Unfinished(NamedTuple):
    """State of a run that is not finished: the text of its case, simulated time and computing time so far [s], version."""

    case_toml: str
    time: float
    seconds: float
    version: str


def read_unfinished(path: Path) -> Unfinished:
    """Return the case and the progress of a run from its checkpoint, of any case and version."""
    require_readable(path)
    try:
        with zipfile.ZipFile(path) as archive:
            about = json.loads(_read_array(archive, "about").tobytes())
        check_format(path, about["format"], FORMAT, EARLIER)
        return Unfinished(str(about["case"]), float(about["time"]), float(about["seconds"]), str(about["version"]))
    except (DataError, MemoryError):
        raise
    except Exception:  # NumPy and zipfile raise nearly any exception for damaged files
        raise _damaged(path, "its description") from None


def started_with(path: Path) -> str:
    """Return the words that name the version which began a run, "" if it is the present one or unknown."""
    try:
        return with_version(read_unfinished(path).version)
    except DataError:
        return ""


def _damaged(path: Path, block: str) -> DataError:
    return DataError(f"{path} is not an intact checkpoint: {block} is damaged", _OTHER_FILE)


class Checkpoint:
    """The file that stores the state of a run, and from which the run resumes."""

    def __init__(self, path: str | os.PathLike[str], case: Case) -> None:
        self.path = Path(path)
        self.time: float | None = None  # simulated time of the state in the file [s]
        self._numbers = ""
        self._about = {
            "case": comparable_toml(case),
            "version": Provenance.now().version,
            "core": instructions(),
            "code": foreign_code(case),
        }

    @contextmanager
    def lock(self) -> Iterator[None]:
        """Reserve the file for this run."""
        with disk_errors(self.path, _DISK_HINT):
            require_folder(self.path)
            name = self.path.with_name(f".{self.path.name}.lock")
            lock = FileLock(name)
            try:
                lock.acquire(blocking=False)
            except Timeout:
                holder = name.read_text() or "another process"
                raise DataError(
                    f"{self.path} is in use by {holder}", "another file, or wait until that run has ended"
                ) from None
        try:
            # The lock is ours: leftovers of a process that was killed can be removed.
            name.write_text(f"process {os.getpid()} on {socket.gethostname()}")
            remove_temporaries(self.path)
            with watch([self.path]):
                yield
        finally:
            name.unlink(missing_ok=True)
            lock.release()

    def read(self) -> CheckpointData | None:
        """Return the content of the file; None if there is no file."""
        if not self.path.exists():
            return None
        require_readable(self.path)
        block = "its description"
        try:
            with zipfile.ZipFile(self.path) as archive:
                about = json.loads(_read_array(archive, "about").tobytes())
                check_format(self.path, about["format"], FORMAT, EARLIER)
                self._compare(about)
                arrays: dict[str, NDArray[Any]] = {}
                for name, digest in about["digests"].items():
                    block = f"the block {name!r}"
                    arrays[name] = _read_array(archive, name)
                    if array_digest([arrays[name]]).hex() != digest:
                        raise ValueError("the digest does not match")
            # Names of arrays are "group.member"; the state of the core has no group.
            groups: dict[str, dict[str, NDArray[Any]]] = {"records": {}, "position": {}}
            for name, array in arrays.items():
                group, _, member = name.partition(".")
                if member:
                    groups[group][member] = array
            positions = tuple(groups["position"][str(k)] for k in range(len(groups["position"])))
            records = _core.Records(**groups["records"])
            data = CheckpointData(
                about["numbers"], about["time"], about["seconds"], positions, records, arrays["state"]
            )
        except (DataError, MemoryError):
            raise
        # NumPy and zipfile raise nearly any exception for damaged files; `block` is the part that was being read.
        except Exception:
            raise _damaged(self.path, block) from None
        self.time = data.time
        return data

    def check(self, data: CheckpointData, packed: _core.DemProblem) -> None:
        """Raise if the core's input differs from that of the checkpoint although the case files agree."""
        if data.numbers != self._fingerprint(packed):
            raise CheckpointMismatch(
                f"{self.path} holds another run\n  the case files agree but their numbers differ: a file that the case "
                "names has changed, or a library that prepares the run",
                _OTHER_FILE,
            )

    def write(self, dem: _core.Dem, packed: _core.DemProblem, records: _core.Records, seconds: float) -> None:
        """Replace the state in the file."""
        time = dem.step * packed.dt
        header = {
            "format": FORMAT,
            "time": time,
            "seconds": seconds,
            "numbers": self._fingerprint(packed),
        } | self._about
        arrays = {f"records.{name}": getattr(records, name) for name in records.fields()}
        arrays |= {f"position.{k}": cavity.position for k, cavity in enumerate(packed.cavities)}
        arrays["state"] = dem.save()
        digests = {name: array_digest([array]).hex() for name, array in arrays.items()}
        about = np.frombuffer(json.dumps({**header, "digests": digests}).encode(), np.uint8)
        with atomic_write(self.path, _DISK_HINT) as name, name.open("wb") as file:
            np.savez(file, allow_pickle=False, about=about, **arrays)
        self.time = time

    def _fingerprint(self, packed: _core.DemProblem) -> str:
        self._numbers = self._numbers or fingerprint(packed)  # the input never changes
        return self._numbers

    def _compare(self, about: Mapping[str, Any]) -> None:
        stored = {"code": {}, **about}  # older files state no code
        stored = {name: stored[name] for name in self._about}
        if lines := differences(stored, self._about):
            hint = _OTHER_FILE
            if other := with_version(stored["version"]):
                hint = f"another file, or the same command{other}"
            if len(lines) == 1 and stored["core"] != self._about["core"]:
                hint = f"RATTLEBOX_SIMD={stored['core']} in the environment, or another file"
            raise CheckpointMismatch("\n".join([f"{self.path} holds another run", *lines]), hint)


def _read_array(archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    """Read all bytes of an array first: zipfile then compares the checksum before NumPy parses the shape."""
    array: NDArray[Any] = np.lib.format.read_array(io.BytesIO(archive.read(f"{name}.npy")), allow_pickle=False)
    return array


def concatenate(pieces: Sequence[_core.Records]) -> _core.Records:
    """Concatenate the samples of consecutive parts of a run."""
    return _core.Records(
        **{name: np.concatenate([getattr(piece, name) for piece in pieces]) for name in _core.Records.fields()}
    )


def comparable_toml(case: Case) -> str:
    """Return the text of a case file without the fields that do not affect the results."""
    parts = {name: getattr(case, name) for name in _FREE_FIELDS}
    free = {name: dict.fromkeys(_FREE_FIELDS[name] & type(part).model_fields.keys()) for name, part in parts.items()}
    return case.model_copy(update={name: part.model_copy(update=free[name]) for name, part in parts.items()}).to_toml()
