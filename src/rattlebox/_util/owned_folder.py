"""Output folders with a marker that lists the files of Rattlebox; other files are never changed or removed.

The marker is a small JSON file in the folder. It contains the kind of the folder, the version that created it, an
identifier, and the name and digest of each file of the fixed part. A file that is not in this list is foreign.
"""

from __future__ import annotations

import hashlib
import json
import os
import uuid
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path, PurePosixPath
from typing import Any

from .atomic_io import atomic_write, disk_errors, sync, temporaries
from .exceptions import DataError

MARKER = "rattlebox.json"
"""Name of the marker in an owned folder."""


class DamagedError(DataError):
    """A file of an owned folder is missing or has changed."""


class ForeignFile(DataError):
    """A file to be written exists and was not written by Rattlebox."""


@dataclass(frozen=True)
class Marker:
    """Content of the marker of an owned folder."""

    name: str
    version: str
    identifier: str = field(default_factory=lambda: uuid.uuid4().hex)
    complete: bool = False
    about: Mapping[str, Any] = field(default_factory=dict)
    files: Mapping[str, str] = field(default_factory=dict)


def read_marker(folder: Path) -> Marker | None:
    """Return the marker of a folder; None if there is none."""
    file = folder / MARKER
    try:
        text = file.read_text(encoding="utf-8")
    except (FileNotFoundError, NotADirectoryError):
        return None
    except UnicodeDecodeError:
        raise DamagedError(f"{MARKER} is not text") from None
    if not text:  # the process or the machine stopped during the write
        return Marker("", "")
    try:
        content = json.loads(text)
        digest = content.pop("digest")
        marker = Marker(**content)
        if digest == _digest(_text(marker).encode()) and all(map(_is_inside, marker.files)):
            return marker
    except (ValueError, TypeError, AttributeError, LookupError):
        pass
    raise DamagedError(f"{MARKER} has changed or is cut off")


def write_marker(folder: Path, marker: Marker, *, new: bool = False) -> None:
    """Write the marker of a folder."""
    path = folder / MARKER
    text = json.dumps({**asdict(marker), "digest": _digest(_text(marker).encode())}, indent=1)
    if new:
        with disk_errors(path), suppress(FileExistsError), path.open("x", encoding="utf-8") as file:
            file.write(text)
        return
    with atomic_write(path, replace=True) as name:
        name.write_text(text, encoding="utf-8")


def is_free(folder: Path) -> bool:
    """Return whether a folder is empty, except for temporary files of the marker."""
    allowed = {path.name for path in temporaries(folder / MARKER)}
    return {path.name for path in folder.iterdir()} <= allowed


def fill(folder: Path, marker: Marker, files: Mapping[str, bytes]) -> Marker:
    """Write the fixed part of an owned folder; it replaces an earlier one."""
    earlier = read_marker(folder)
    earlier_files = earlier.files if earlier else {}
    foreign = [name for name in files if name not in earlier_files and os.path.lexists(folder / name)]
    if foreign:
        raise ForeignFile(f"{folder / foreign[0]} was not written by Rattlebox", "move it out of this folder")
    folder.mkdir(parents=True, exist_ok=True)
    if not (earlier and earlier.complete and earlier_files.keys() == files.keys()):
        write_marker(folder, replace(marker, complete=False, files=dict.fromkeys((*earlier_files, *files), "")))
        remove(folder, earlier_files.keys() - files.keys())
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(path, replace=True) as temporary:
            temporary.write_bytes(content)
    complete = replace(marker, complete=True, files={name: _digest(content) for name, content in files.items()})
    write_marker(folder, complete)
    return complete


def damaged_files(folder: Path, marker: Marker) -> list[str]:
    """Return the files of the fixed part that are missing or have changed."""
    return [name for name, digest in marker.files.items() if digest_of(folder / name) != digest]


def remove(folder: Path, names: Iterable[str]) -> None:
    """Remove files of an owned folder by name, and subfolders that are then empty."""
    root = folder.resolve()
    for name in names:
        path = folder / name
        if not path.parent.resolve().is_relative_to(root):  # a link leads out of the folder
            continue
        with suppress(FileNotFoundError, NotADirectoryError):
            path.unlink()
        for parent in path.parents:
            if parent == folder:
                break
            try:
                parent.rmdir()
            except OSError:  # it contains other files, or does not exist
                break
    sync(folder)


def _is_inside(name: str) -> bool:
    path = PurePosixPath(name)
    return not path.is_absolute() and ".." not in path.parts


def _text(marker: Marker) -> str:
    return json.dumps(asdict(marker), sort_keys=True)


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def digest_of(path: Path) -> str:
    """Return the digest of a file; "" if it cannot be read."""
    try:
        return _digest(path.read_bytes())
    except OSError:
        return ""
