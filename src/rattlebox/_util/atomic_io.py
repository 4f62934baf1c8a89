"""Atomic writes: an output file is complete, or it is what it was before.

Every file that the package writes for a user goes through `atomic_write`. Files that grow in place (snapshots, stores, the
journal of a design) have their own protection and use `disk_errors` for the messages.
"""

from __future__ import annotations

import errno
import glob
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

HDF5_ERRORS = (OSError, AttributeError, LookupError, RuntimeError, TypeError, ValueError, OverflowError)
"""Exceptions that HDF5 libraries raise for a damaged file, or for one with other content."""

WRITE_AGAIN = "make room and give the same command again"
"""Default advice for a full disk."""

_WRITERS = {
    ".nc": "run.save",
    ".mat": "run.to_mat",
    ".csv": "run.to_csv",
    ".vtkhdf": "rb.simulate(case, snapshots=...), of particles in space",
    ".toml": "case.to_file",
}


def check_suffix(path: Path, own: str) -> None:
    """Raise if the suffix of a path belongs to another kind of file.

    Parameters
    ----------
    path
        The file, or a folder.
    own
        Suffix of the kind of file that is written; "" for a folder.

    Raises
    ------
    ValueError
        If it does; the message names the function that writes the other kind.
    """
    suffix = path.suffix.lower()
    if suffix != own and suffix in _WRITERS:
        what = f"a {own} file" if own else "a folder"
        name, other = path.with_suffix(own).name, _WRITERS[suffix]
        raise ValueError(
            f"{path}: {what} is written, not a {suffix} file\n  try: {name}; the other is written by {other}"
        )


def require_folder(path: Path) -> None:
    """Raise if the folder of a file does not exist.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    FileNotFoundError
        If there is no such folder.
    """
    if not path.parent.is_dir():
        raise FileNotFoundError(f"cannot write {path}: there is no folder {path.parent}")


@contextmanager
def atomic_write(path: str | os.PathLike[str], advice: str = WRITE_AGAIN) -> Iterator[Path]:
    """Yield the name of a temporary file, which replaces the target once the block has ended.

    The content is on the disk before the name changes, and the name before the function returns: after a crash of the
    program or of the machine, the target is either the new file or the earlier one. Where the target is a symbolic link,
    the file that it points to is replaced.

    Parameters
    ----------
    path
        File to write, in an existing folder.
    advice
        Advice in the message about a full disk.

    Raises
    ------
    OSError
        If the file cannot be written; an earlier file is then unchanged, and nothing else is left behind.
    """
    path = Path(path)
    with disk_errors(path, advice):
        if path.exists() and not path.is_file():  # a device or a pipe; a folder is refused by the writer
            yield path
            return
        target = path.resolve() if path.is_symlink() else path
        require_folder(target)
        handle, name = tempfile.mkstemp(f".partial{target.suffix}", f".{target.name}.", target.parent)
        os.close(handle)
        temporary = Path(name)
        try:
            yield temporary
            mask = os.umask(0)
            os.umask(mask)
            temporary.chmod(0o666 & ~mask)
            sync(temporary)
            temporary.replace(target)
            sync(target.parent)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise


def temporaries(path: Path) -> list[Path]:
    """Return the temporary files that processes left that were killed in `atomic_write`.

    Parameters
    ----------
    path
        Target of the write.
    """
    return list(path.parent.glob(glob.escape(f".{path.name}.") + "?" * 8 + glob.escape(f".partial{path.suffix}")))


def remove_temporaries(path: Path) -> None:
    """Remove the temporary files of killed processes. Only for the sole writer of a file.

    Parameters
    ----------
    path
        Target of the write, which is not touched.
    """
    for left in temporaries(path):
        left.unlink(missing_ok=True)


def sync(path: Path) -> None:
    """Wait until the content of a file, or the names in a folder, are on the disk.

    Parameters
    ----------
    path
        The file or the folder.

    Raises
    ------
    OSError
        If the content of a file cannot be written. Folders are synchronised where the system can.
    """
    folder = path.is_dir()
    with suppress(*(OSError,) if folder else ()):
        handle = os.open(path, os.O_RDONLY if folder else os.O_RDWR)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


@contextmanager
def disk_errors(path: Path, advice: str = WRITE_AGAIN) -> Iterator[None]:
    """Add the file and an advice to the errors of a disk that is full or cannot be written.

    Parameters
    ----------
    path
        The file that is written.
    advice
        Advice in the message about a full disk.
    """
    try:
        yield
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            said = f"no space is left on the disk\n  try: {advice}"
        else:
            why = error.strerror or str(error).removeprefix(f"cannot write {path}: ")
            said = f"it cannot be written: {why}\n  try: another folder"
        raise OSError(error.errno or errno.EIO, said, str(path)) from error


def reserve_space(path: Path, size: int) -> None:
    """Reserve disk space for the first bytes of a file, where the system can, and keep their content.

    HDF5 keeps part of a file in memory and crashes if the disk is full when it writes that part. The files that it
    changes in place therefore have their space reserved first.

    Parameters
    ----------
    path
        An existing file.
    size
        Number of bytes.

    Raises
    ------
    OSError
        If there is no space.
    """
    if hasattr(os, "posix_fallocate"):
        with path.open("r+b") as file:
            os.posix_fallocate(file.fileno(), 0, size)
