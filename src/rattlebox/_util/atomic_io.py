"""Atomic writes: an output file is either complete or unchanged.

Every output file is written with `atomic_write`. Files that grow in place (snapshots, stores, the journal of a design) have
their own protection and use `disk_errors` for the messages.
"""

from __future__ import annotations

import errno
import glob
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from .exceptions import DataError, RattleboxError, ResourceError

HDF5_ERRORS = (OSError, AttributeError, LookupError, RuntimeError, TypeError, ValueError, OverflowError)
"""Exceptions of the HDF5 libraries for damaged files and files with other content."""

DISK_HINT = "free disk space and give the same command again"
"""Default advice for a full disk."""

_WRITERS = {
    ".nc": "run.save",
    ".mat": "run.to_mat",
    ".csv": "run.to_csv",
    ".vtkhdf": "rb.simulate(case, snapshots=...), for particle dampers",
    ".toml": "case.to_file",
    ".html": "rb.write_report",
}


def check_suffix(path: Path, own: str) -> None:
    """Raise if the suffix of a path belongs to another kind of file.

    Parameters
    ----------
    path
        The file, or a folder.
    own
        Suffix of the file to be written; "" for a folder.

    Raises
    ------
    DataError
        If the suffix belongs to another kind; the message names the function that writes the other kind.
    """
    suffix = path.suffix.lower()
    if suffix != own and suffix in _WRITERS:
        what = f"a {own} file" if own else "a folder"
        name, other = path.with_suffix(own).name, _WRITERS[suffix]
        raise DataError(f"{path}: {what} is written, not a {suffix} file", f"{name}; the other is written by {other}")


def require_folder(path: Path) -> None:
    """Raise if the folder of a file does not exist.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    DataError
        If there is no such folder.
    """
    if not path.parent.is_dir():
        raise DataError(f"{path} cannot be written: there is no folder {path.parent}", "another folder, or create it")


def require_readable(path: Path) -> None:
    """Raise if a file cannot be read, with the reason, which HDF5 does not report.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    DataError
        If there is no such file, if it is a folder, or if the system refuses to open it.
    """
    if path.is_dir():
        raise DataError(f"{path} is a folder, not a file")
    try:
        path.open("rb").close()
    except FileNotFoundError:
        raise DataError(f"there is no file {path}") from None
    except OSError as error:
        raise DataError(f"{path} cannot be read: {error.strerror or error}") from None


def check_format(path: Path, version: object, own: int) -> None:
    """Raise if a file has a different version of its format.

    Parameters
    ----------
    path
        The file.
    version
        Version of the format in the file.
    own
        Version of the format that the package reads and writes.

    Raises
    ------
    DataError
        If the versions differ.
    """
    if version != own:
        raise DataError(
            f"{path} has format {version}, and this version of Rattlebox reads format {own}",
            "the version of Rattlebox that wrote it, or run the case again",
        )


@contextmanager
def atomic_write(path: str | os.PathLike[str], advice: str = DISK_HINT) -> Iterator[Path]:
    """Yield the name of a temporary file, which replaces the target once the block has ended.

    The content is flushed to the disk before the temporary file is renamed, and the new name before the context ends: after
    a crash of the program or the machine, the target is either the new or the earlier file. If the target is a symbolic
    link, the file to which it points is replaced.

    Parameters
    ----------
    path
        File to write, in an existing folder.
    advice
        Advice in the message about a full disk.

    Raises
    ------
    DataError
        If the file cannot be written. An earlier file is then unchanged, and the temporary file is removed.
    ResourceError
        If no space is left on the disk, with the same state of the files.
    """
    path = Path(path)
    with disk_errors(path, advice):
        if path.exists() and not path.is_file():  # a device or a pipe; for a folder the caller raises
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
    """Return the temporary files of processes that were killed in `atomic_write`.

    Parameters
    ----------
    path
        Target of the write.
    """
    return list(path.parent.glob(glob.escape(f".{path.name}.") + "?" * 8 + glob.escape(f".partial{path.suffix}")))


def remove_temporaries(path: Path) -> None:
    """Remove the temporary files of killed processes. The caller must be the only writer of the file.

    Parameters
    ----------
    path
        Target of the write, which is not changed.
    """
    for temporary in temporaries(path):
        temporary.unlink(missing_ok=True)


def sync(path: Path) -> None:
    """Flush the content of a file, or the names in a folder, to the disk.

    Parameters
    ----------
    path
        The file or the folder.

    Raises
    ------
    OSError
        If the content of a file cannot be written. Systems that cannot flush folders raise no error.
    """
    folder = path.is_dir()
    with suppress(*(OSError,) if folder else ()):
        handle = os.open(path, os.O_RDONLY if folder else os.O_RDWR)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


@contextmanager
def disk_errors(path: Path, advice: str = DISK_HINT) -> Iterator[None]:
    """Convert errors of a full or read-only disk to errors of the package.

    Parameters
    ----------
    path
        File to be written.
    advice
        Advice in the message about a full disk.

    Raises
    ------
    ResourceError
        If no space is left.
    DataError
        If the file cannot be written for another reason.
    """
    try:
        yield
    except RattleboxError:
        raise
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            raised: DataError | ResourceError = ResourceError(f"{path}: no space is left on the disk", advice)
        else:
            raised = DataError(f"{path} cannot be written: {error.strerror or error}", "another folder")
        raised.errno, raised.filename = error.errno or errno.EIO, str(path)
        raise raised from error


def reserve_space(path: Path, size: int) -> None:
    """Reserve disk space for the first bytes of a file, on systems that support it; the content is unchanged.

    HDF5 buffers part of a file and crashes if the disk is full when it writes that part. Space is therefore reserved for
    files that it changes in place.

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
