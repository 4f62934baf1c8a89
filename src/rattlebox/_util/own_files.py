"""The files that may be replaced although the user did not name them: those of Rattlebox that nobody has changed.

The content decides. Files of results and checkpoints have a format of their own, whose modules register how to recognise it;
figures, reports and FMUs have a seal at their end, a text with the digest of all bytes before it; tables (CSV, MAT) are in
the list of the marker of their folder.
"""

from __future__ import annotations

import hashlib
import os
import re
import struct
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from .atomic_io import watch
from .exceptions import DataError
from .owned_folder import MARKER, DamagedError, Marker, digest_of, read_marker, write_marker

RUN_FOLDER, REPLACEMENT = "Rattlebox run", "Rattlebox replacement"
"""Kinds of folders of results, as stored in their markers: those of a run, and those that will replace another run."""

_SEALS = {".png": "figure", ".html": "report", ".htm": "report", ".fmu": "FMU"}
"""Kinds of sealed files, by suffix."""

_SEAL = re.compile(rb"(?:\n<!-- )?Rattlebox (\w+), SHA-256 of the text above: ([0-9a-f]{64})")
_LONGEST_END = 256  # bytes from the seal to the end of the file, at most

_recognise: dict[str, Callable[[Path], bool]] = {}


def register_format(suffix: str, recognise: Callable[[Path], bool]) -> None:
    """Register how a format of Rattlebox is recognised."""
    _recognise[suffix] = recognise


def seal(content: bytes, suffix: str) -> bytes:
    """Return the content of a file with a seal, in a place of its format for comments."""

    def text(before: bytes) -> bytes:
        return f"Rattlebox {_SEALS[suffix]}, SHA-256 of the text above: {hashlib.sha256(before).hexdigest()}".encode()

    size = len(text(b""))
    if suffix == ".png":  # a chunk of text before the chunk that ends the file
        head = b"tEXtComment\0"
        before = content[:-12] + struct.pack(">I", size + len(head) - 4) + head
        chunk = head + text(before)
        return before + text(before) + struct.pack(">I", zlib.crc32(chunk)) + content[-12:]
    if suffix == ".fmu":  # the comment of the archive, after its length
        before = content[:-2] + struct.pack("<H", size)
        return before + text(before)
    return content + b"\n<!-- " + text(content) + b" -->\n"


def sealed_kind(path: Path) -> str:
    """Return the kind of a sealed file, "" without a seal; "changed" if the bytes before the seal have changed."""
    content = path.read_bytes()
    seals = list(_SEAL.finditer(content, max(0, len(content) - _LONGEST_END)))
    if not seals:
        return ""
    last = seals[-1]
    intact = hashlib.sha256(content[: last.start()]).hexdigest().encode() == last[2]
    return last[1].decode() if intact else "changed"


def may_replace(path: Path) -> bool:
    """Return whether there is no file at a path, or an unchanged one of Rattlebox of the kind of its suffix."""
    if not os.path.lexists(path):
        return True
    if not path.is_file():
        return False
    suffix = path.suffix.lower()
    if suffix in _recognise and _recognise[suffix](path):
        return True
    if suffix in _SEALS and sealed_kind(path) == _SEALS[suffix]:
        return True
    marker = folder_marker(path.parent)
    return marker is not None and marker.files.get(path.name) in ("", digest_of(path))


def folder_marker(folder: Path) -> Marker | None:
    """Return the marker of a folder; None if there is none."""
    try:
        return read_marker(folder)
    except DamagedError as error:
        raise DataError(f"{folder / MARKER}: {error}", "another folder, or remove this file") from None


def check_replaceable(path: Path) -> None:
    """Raise if there is a file at a path that must not be replaced."""
    if not may_replace(path):
        raise DataError(
            f"{path} was not written by Rattlebox, or has changed since, and is not overwritten",
            "another name or folder, or move the file",
        )


def list_files(folder: Path, version: str, files: Mapping[str, str | None]) -> None:
    """Add files to the list in the marker of a folder of results."""
    marker = folder_marker(folder)
    if marker and marker.name not in (RUN_FOLDER, REPLACEMENT, ""):
        raise DataError(f"{folder} contains a study, and results of a run need a folder of their own", "another folder")
    marker = marker if marker and marker.name else Marker(RUN_FOLDER, version)
    listed = {**marker.files, **files}
    write_marker(folder, replace(marker, files={name: digest for name, digest in listed.items() if digest is not None}))


@contextmanager
def claim(paths: Iterable[Path], *, named: bool = False) -> Iterator[None]:
    """Check that files may be written, and let `atomic_write` in this block replace them only if they did not change."""
    paths = list(paths)
    for path in paths:
        if not named:
            check_replaceable(path)
    with watch(paths):
        yield
