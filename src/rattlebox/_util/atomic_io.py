"""Atomic writes: an output file is either complete or unchanged.

Every output file is written with `atomic_write`. Files that grow in place (snapshots, stores, the journal of a design) have
their own protection and use `disk_errors` for the messages.
"""

from __future__ import annotations

import errno
import glob
import os
import tempfile
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from difflib import get_close_matches
from pathlib import Path

from .exceptions import DataError, RattleboxError, ResourceError, unreadable

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


def check_suffix(path: Path, suffix_of_kind: str) -> None:
    """Raise if the suffix of a path belongs to another kind of file."""
    suffix = path.suffix.lower()
    if suffix != suffix_of_kind and suffix in _WRITERS:
        what = f"a {suffix_of_kind} file" if suffix_of_kind else "a folder"
        name, other = path.with_suffix(suffix_of_kind).name, _WRITERS[suffix]
        raise DataError(f"{path}: {what} is written, not a {suffix} file", f"{name}; the other is written by {other}")


def require_folder(path: Path) -> None:
    """Raise if the folder of a file does not exist."""
    if not path.parent.is_dir():
        raise DataError(f"{path} cannot be written: there is no folder {path.parent}", "another folder, or create it")


def existing(path: str | os.PathLike[str]) -> Path:
    """Return the file at a path."""
    file = Path(path)
    if file.is_file():
        return file
    if file.is_dir():
        names = sorted(other.name for other in file.iterdir() if other.is_file())[:2]
        advice = " or ".join(str(file / name) for name in names) or "a file; the folder contains none"
        raise DataError(f"{file} is a folder, not a file", advice)
    folder = file.parent
    if not folder.is_dir():
        raise DataError(
            f"there is no file {file}: there is no folder {folder}", f"a path from {Path.cwd()}, or a full one"
        )
    like = get_close_matches(file.name, [other.name for other in folder.iterdir() if other.is_file()], n=2)
    advice = " or ".join(str(folder / name) for name in like) or f"another name; no file in {folder} has a similar one"
    raise DataError(f"there is no file {file}", advice)


def require_readable(path: Path) -> None:
    """Raise if a file cannot be read, with the reason, which HDF5 does not report."""
    if path.is_dir():
        results = sorted(path.glob("*.nc"))
        raise DataError(f"{path} is a folder, not a file", str(results[0]) if results else "a file")
    if path.exists() and not path.is_file():  # opening a pipe would wait for somebody to write to it
        raise DataError(f"{path} is a pipe or a device, not a file", "a file")
    existing(path)
    try:
        path.open("rb").close()
    except OSError as error:
        raise unreadable(path, error) from None


def check_format(path: Path, version: object, supported: int, older: Collection[int] = ()) -> None:
    """Raise if a file has a version of its format other than the supported one and the older ones that are read, too."""
    if version != supported and version not in older:
        raise DataError(
            f"{path} has format {version}, and this version of Rattlebox reads format {supported}",
            "the version of Rattlebox that wrote it, or run the case again",
        )


class FileTaken(DataError):
    """A file to be written appeared, or was changed by others, after its name was chosen."""


Identity = tuple[int, int, int, int]

_watched: ContextVar[dict[str, list[Identity | None]] | None] = ContextVar("watched", default=None)
_watched_only: ContextVar[bool] = ContextVar("watched_only", default=False)


def _identity(path: Path) -> Identity | None:
    """Return numbers that differ between the file at a path, a changed one and another one; None if there is none."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns


@contextmanager
def watch(paths: Iterable[Path]) -> Iterator[None]:
    """Let `atomic_write` in this block write to paths only while nobody else has created or changed their files."""
    now = {os.path.abspath(path): [_identity(path)] for path in paths}
    token = _watched.set({**now, **(_watched.get() or {})})  # an outer block has looked earlier
    try:
        yield
    finally:
        _watched.reset(token)


def unchanged(path: Path) -> bool:
    """Return whether a file is still as it was when a block of `watch` began, or is not watched."""
    seen = (_watched.get() or {}).get(os.path.abspath(path))
    return seen is None or seen[0] == _identity(path)


@contextmanager
def only_watched_files() -> Iterator[None]:
    """Let `atomic_write` in this block replace no file that is not watched, so that no command can forget it."""
    token = _watched_only.set(True)
    try:
        yield
    finally:
        _watched_only.reset(token)


@contextmanager
def atomic_write(
    path: str | os.PathLike[str], advice: str = DISK_HINT, *, replace: bool | None = None
) -> Iterator[Path]:
    """Yield the name of a temporary file, which replaces the target once the block has ended.

    The content is flushed to the disk before the temporary file is renamed, and the new name before the context ends: after
    a crash of the program or the machine, the target is either the new or the earlier file. If the target is a symbolic
    link, the file to which it points is replaced.
    """
    path = Path(path)
    with disk_errors(path, advice):
        # The caller raises for a folder, and may write to a device or a pipe, unless nothing must be there.
        if path.exists() and not path.is_file() and replace is not False:
            yield path
            return
        target = path.resolve() if path.is_symlink() else path
        require_folder(target)
        if replace is False and os.path.lexists(path):  # before a long computation in the block
            raise _taken(path)
        # In the same folder, since only within a file system a rename is atomic.
        handle, name = tempfile.mkstemp(f".partial{target.suffix}", f".{target.name}.", target.parent)
        os.close(handle)
        temporary = Path(name)
        try:
            yield temporary
            # A temporary file is private; the result gets the permissions of any new file, which can only be asked by
            # setting the mask.
            mask = os.umask(0)
            os.umask(mask)
            temporary.chmod(0o666 & ~mask)
            sync(temporary)
            install(temporary, path, replace=replace)
            # Without this a crash of the machine may lose the new name although the content is on the disk.
            sync(target.parent)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise


def install(source: Path, path: Path, *, replace: bool | None = None) -> None:
    """Give a complete file its name."""
    target = path.resolve() if path.is_symlink() else path
    seen = (_watched.get() or {}).get(os.path.abspath(path))
    if replace is None and seen:
        now = _identity(target)
        if now not in (None, seen[0]):
            raise _taken(target)
        replace = now is not None
    if replace or (replace is None and not _watched_only.get()):
        source.replace(target)
    else:
        _install_new(source, target)
    if seen:
        seen[0] = _identity(target)


def _install_new(source: Path, target: Path) -> None:
    """Rename a file to a name that must be free, also if another process creates a file there at the same time."""
    try:
        os.link(source, target)
    except FileExistsError:
        raise _taken(target) from None
    except OSError:  # a file system without links; an empty file then reserves the name
        try:
            os.close(os.open(target, os.O_CREAT | os.O_EXCL | os.O_WRONLY))
        except FileExistsError:
            raise _taken(target) from None
        source.replace(target)
    else:
        source.unlink()


def _taken(target: Path) -> FileTaken:
    raised = FileTaken(
        f"{target} exists, or has changed since it was looked at, and is not overwritten", "another name"
    )
    raised.errno, raised.filename = errno.EEXIST, str(target)
    return raised


def temporaries(path: Path) -> list[Path]:
    """Return the temporary files of processes that were killed in `atomic_write`."""
    return list(path.parent.glob(glob.escape(f".{path.name}.") + "?" * 8 + glob.escape(f".partial{path.suffix}")))


def remove_temporaries(path: Path) -> None:
    """Remove the temporary files of killed processes. The caller must be the only writer of the file."""
    for temporary in temporaries(path):
        temporary.unlink(missing_ok=True)


def sync(path: Path) -> None:
    """Flush the content of a file, or the names in a folder, to the disk."""
    folder = path.is_dir()
    with suppress(*(OSError,) if folder else ()):
        handle = os.open(path, os.O_RDONLY if folder else os.O_RDWR)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


@contextmanager
def disk_errors(path: Path, advice: str = DISK_HINT) -> Iterator[None]:
    """Convert errors of a full or read-only disk to errors of the package."""
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
    """
    if hasattr(os, "posix_fallocate"):
        with path.open("r+b") as file:
            os.posix_fallocate(file.fileno(), 0, size)
