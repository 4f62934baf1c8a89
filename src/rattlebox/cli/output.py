"""The file that a command writes: the one that the user named, or a default name, which replaces no file of others."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rattlebox._util.own_files import claim


@contextmanager
def output_file(out: Path | None, default: str) -> Iterator[tuple[Path, str]]:
    """Claim the file that a command writes in this block."""
    path = out or Path(default)
    note = " (replaced an earlier file; choose another name with -o)" if out is None and path.exists() else ""
    with claim([path], named=out is not None):
        yield path, note
