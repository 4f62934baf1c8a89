"""Files that are either whole or not there."""

from __future__ import annotations

import errno
import glob
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

DAMAGE = (OSError, AttributeError, LookupError, RuntimeError, TypeError, ValueError, OverflowError)
"""What libraries raise where a file of HDF5 is torn, or holds other things than it should."""


_WRITERS = {
    ".nc": "run.save",
    ".mat": "run.to_mat",
    ".csv": "run.to_csv",
    ".vtkhdf": "rb.simulate(case, snapshots=...), of particles in space",
    ".toml": "case.to_file",
}


def check_suffix(path: Path, own: str) -> None:
    """Refuse a name that says that a file holds something else.

    Parameters
    ----------
    path
        The file, or a folder.
    own
        Its suffix; "" of a folder.

    Raises
    ------
    ValueError
        When the suffix is that of another kind of file, with what writes those.
    """
    suffix = path.suffix.lower()
    if suffix != own and suffix in _WRITERS:
        what = f"a {own} file" if own else "a folder"
        name, other = path.with_suffix(own).name, _WRITERS[suffix]
        raise ValueError(
            f"{path}: {what} is written, not a {suffix} file\n  try: {name}; the other is written by {other}"
        )


def needs_folder(path: Path) -> None:
    """Refuse a file in a folder that is not there.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    FileNotFoundError
        When there is no such folder.
    """
    if not path.parent.is_dir():
        raise FileNotFoundError(f"cannot write {path}: there is no folder {path.parent}")


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Give a name to write to, and put that file in the place of another one once it is complete.

    Parameters
    ----------
    path
        File to write, in a folder that exists.

    Raises
    ------
    OSError
        When the file cannot be written; an earlier one is then as it was.
    """
    path = path.resolve() if path.is_symlink() else path  # a link stays one
    needs_folder(path)
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=path.suffix, dir=path.parent)
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o666 & ~mask)
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def clear_remains(path: Path) -> None:
    """Remove what a process that was killed while it wrote this file has left; for who alone writes it.

    Parameters
    ----------
    path
        The file, which stays.
    """
    for left in path.parent.glob(glob.escape(f".{path.name}.") + "?" * 8 + glob.escape(path.suffix)):
        left.unlink(missing_ok=True)


@contextmanager
def telling(path: Path, lost: str) -> Iterator[None]:
    """Say of a disk that takes no more what that means.

    Parameters
    ----------
    path
        What is written.
    lost
        What a full disk means, and what to do when there is room.
    """
    try:
        yield
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            said = f"no space is left on the disk\n  try: {lost}"
        else:
            why = error.strerror or str(error).removeprefix(f"cannot write {path}: ")
            said = f"it cannot be written: {why}\n  try: another folder"
        raise OSError(error.errno or errno.EIO, said, str(path)) from error


def reserve(path: Path, size: int) -> None:
    """Take up the room that the first bytes of a file need, where the system can, and leave what they hold.

    Libraries that keep part of a file in memory cannot be rid of it when the disk is full, and take the process with them.
    They are therefore given files whose room is there.

    Parameters
    ----------
    path
        An existing file.
    size
        How many bytes.

    Raises
    ------
    OSError
        When there is no room.
    """
    if hasattr(os, "posix_fallocate"):
        with path.open("r+b") as file:
            os.posix_fallocate(file.fileno(), 0, size)
