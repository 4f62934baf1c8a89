"""The folder that `rattlebox run` writes."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path

from rattlebox._util.atomic_io import remove_temporaries, sync
from rattlebox._util.exceptions import DataError, RattleboxError
from rattlebox._util.owned_folder import (
    MARKER,
    DamagedError,
    Marker,
    digest_of,
    is_free,
    read_marker,
    remove,
    write_marker,
)
from rattlebox.engines.checkpoint import Checkpoint, comparable_toml, is_checkpoint
from rattlebox.model.case import Case
from rattlebox.model.differences import differences
from rattlebox.results.netcdf import read_case
from rattlebox.results.snapshots import is_snapshots

RUN, SNAPSHOTS, CHECKPOINT = "run.nc", "run.vtkhdf", "run.checkpoint"

WRITTEN = (
    RUN,
    SNAPSHOTS,
    "run.mat",
    *(f"{group}.csv" for group in ("motion", "energy", "impacts", "particles")),
    *(f"{figure}.png" for figure in ("motion", "energy", "impacts")),
    CHECKPOINT,
)
"""All files that the command writes there."""

KIND, _REPLACEMENT = "Rattlebox run", "Rattlebox replacement"
"""Kinds of folders in their markers."""


def make_folder(out: Path) -> None:
    """Make a folder for results.

    Parameters
    ----------
    out
        Folder.

    Raises
    ------
    DataError
        When it cannot be made.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise DataError(f"{out} is a file; results need a folder\n  try: --out results") from None
    except OSError as error:
        raise DataError(f"the folder {out} cannot be made: {error.strerror}\n  try: --out results") from None


@dataclass(frozen=True)
class Place:
    """Where a run writes its files.

    Attributes
    ----------
    out
        Folder of the results.
    folder
        Folder to write to: `out`, or a folder in it whose files replace those of an earlier run in the end.
    checkpoint
        Checkpoint of the run.
    snapshots
        Snapshots of the run.
    again
        Names of the files of an earlier run of the same case, which are written again.
    notes
        Facts about the folder that the user should know.
    gone
        Names of the files of an earlier run of another case, which are removed in the end.
    """

    out: Path
    folder: Path
    checkpoint: Path
    snapshots: Path
    again: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    gone: tuple[str, ...] = ()

    def finish(self, names: Sequence[str], *, keep_checkpoint: bool) -> Path:
        """Put the files in their place, and remove those that they replace.

        Parameters
        ----------
        names
            Names of the files that were written.
        keep_checkpoint
            Whether the checkpoint is needed further.

        Returns
        -------
        Path
            The checkpoint, if it is kept.
        """
        kept = [CHECKPOINT] if keep_checkpoint and self.checkpoint == self.folder / CHECKPOINT else []
        if self.folder == self.out:
            note_written(self.out, [*names, *kept])
        else:
            files = _digests(self.folder, [*names, *kept])
            remaining = {self.checkpoint, self.snapshots}  # of this run, where they lie in the folder itself
            gone = [name for name in self.gone if name not in files and self.out / name not in remaining]
            write_marker(self.folder, replace(_new(_REPLACEMENT, files), complete=True, about={"gone": gone}))
            _swap(self.out, self.folder)
        checkpoint = self.out / CHECKPOINT if kept else self.checkpoint
        if not keep_checkpoint:
            checkpoint.unlink(missing_ok=True)
        return checkpoint


def check_own(out: Path, names: Iterable[str]) -> None:
    """Raise if a file that is to be written exists and is not a result of this program.

    Parameters
    ----------
    out
        Folder of the results.
    names
        Names of the files.

    Raises
    ------
    DataError
        If there is one.
    """
    marker = _marker(out)
    for name in names:
        if not _is_own(out, name, marker):
            raise DataError(_NOT_OURS.format(out / name))


def note_begun(out: Path, names: Iterable[str]) -> None:
    """Add the names of files that are about to be written to the list of results.

    Parameters
    ----------
    out
        Folder of the results.
    names
        Names of the files.
    """
    _add(out, dict.fromkeys(names, ""))


def note_written(out: Path, names: Iterable[str]) -> None:
    """Add the digests of files that were written to the list of results.

    Parameters
    ----------
    out
        Folder of the results.
    names
        Names of the files.
    """
    _add(out, _digests(out, names))


def _add(out: Path, files: Mapping[str, str]) -> None:
    earlier = _marker(out)
    write_marker(out, _new(KIND, {**(earlier.files if earlier else {}), **files}))


@contextmanager
def taken(out: Path, case: Case, *, checkpoint: Path | None, replace: bool) -> Iterator[Place]:
    """Hold a folder for the results of a case, which may have those of an earlier run of it.

    Parameters
    ----------
    out
        Folder.
    case
        What is to be run.
    checkpoint
        From which it goes on, if that is not in the folder.
    replace
        Replace a run of another case. All its files stay until those of the new run are complete; a run that is stopped
        before then leaves them unchanged. A checkpoint of the same case stays, since the run continues from it.

    Raises
    ------
    DataError
        When the folder cannot be made, holds a study, a run of another case, with what differs, or what is no run; when
        another process uses it, or the case reads a file that results would be written over.
    """
    make_folder(out)
    marker = _marker(out)
    if (out / "zarr.json").exists() or (marker and marker.name not in (KIND, "")):
        raise DataError(f"{out} holds a study\n  try: another -o folder")
    _check_inputs(out, case)
    own = Checkpoint(out / CHECKPOINT, case)
    goes_on = bool(case.particle_dampers) and checkpoint is None
    with ExitStack() as stack:
        with own.lock():
            for name in WRITTEN:
                remove_temporaries(out / name)
            for folder in replacements(out):
                _swap(out, folder)
            earlier = _case_in(out / RUN)
            there = tuple(name for name in files_in(out) if _is_own(out, name, _marker(out)))
            lines = (
                differences({"case": _bare(earlier)}, {"case": comparable_toml(case)}) if earlier is not None else []
            )
            if lines and not replace:
                raise DataError("\n".join([f"{out / RUN} holds another run", *lines, _ADVICE]))
            foreign = own.path.is_file() and not (goes_on and (not replace or _is_of(own)))
            if foreign and not replace:
                raise DataError(f"{own.path} is of a run that is not over\n{_ADVICE}")
            if foreign and not is_checkpoint(own.path):
                raise DataError(_NOT_OURS.format(own.path))
        notes = [f"{folder} {_UNFINISHED}" for folder in replacements(out)]
        here = goes_on and own.path.is_file() and not foreign  # the run continues from the checkpoint in the folder
        if not goes_on or (not here and (lines or foreign)):  # else the run holds it
            stack.enter_context(own.lock())
        if not lines and not foreign:
            again = () if earlier is None else there
            yield Place(out, out, checkpoint or own.path, out / SNAPSHOTS, again, tuple(notes))
            return
        folder = stack.enter_context(_replacement(out, case))
        notes = [note for note in notes if not note.startswith(f"{folder} ")]
        mine = own.path if here else folder / CHECKPOINT
        shots = (out if here else folder) / SNAPSHOTS
        yield Place(out, folder, checkpoint or mine, shots, (), tuple(notes), there)


def replacements(out: Path) -> list[Path]:
    """Return the folders of runs that were begun to replace another run, and are not over.

    Parameters
    ----------
    out
        Folder of the results.
    """
    found = []
    for path in sorted(out.glob("replacement-*")):
        try:
            marker = read_marker(path)
        except DamagedError:
            continue
        if marker and marker.name == _REPLACEMENT:
            found.append(path)
    return found


_UNFINISHED = (
    "holds a run that was begun with --replace and is not over: its command continues it; "
    "remove the folder if it is not needed"
)


@contextmanager
def _replacement(out: Path, case: Case) -> Iterator[Path]:
    """Yield a folder for the files of a run that replaces another one; it stays if the run can continue from it."""
    folder = out / f"replacement-{hashlib.sha256(comparable_toml(case).encode()).hexdigest()[:8]}"
    if folder.exists() and folder not in replacements(out) and not (folder.is_dir() and is_free(folder)):
        raise DataError(f"{folder} was not written by Rattlebox\n  try: another -o folder, or move it")
    folder.mkdir(exist_ok=True)
    write_marker(folder, _new(_REPLACEMENT, dict.fromkeys(WRITTEN, "")))
    try:
        yield folder
    finally:
        if not any((folder / name).is_file() for name in (CHECKPOINT, SNAPSHOTS)):
            _discard(folder)


def _swap(out: Path, folder: Path) -> None:
    """Move the files of a run that is over to their place; where that was begun before, end it."""
    marker = read_marker(folder)
    if not marker or not marker.complete:
        return
    remove(out, marker.about["gone"])
    for name in marker.files:
        if (folder / name).is_file():
            (folder / name).replace(out / name)
    sync(out)
    write_marker(out, _new(KIND, marker.files))
    _discard(folder)


def _discard(folder: Path) -> None:
    """Remove what a run wrote to a folder of its own, and the folder if nothing else is in it."""
    for name in WRITTEN:
        remove_temporaries(folder / name)
    with suppress(FileNotFoundError):
        remove(folder, [*WRITTEN, f".{CHECKPOINT}.lock", MARKER])
    with suppress(OSError):
        folder.rmdir()


def _new(kind: str, files: Mapping[str, str]) -> Marker:
    from rattlebox import __version__

    return Marker(kind, __version__, files=files)


def _marker(out: Path) -> Marker | None:
    try:
        return read_marker(out)
    except DamagedError as error:
        raise DataError(f"{out / MARKER}: {error}", "another -o folder, or remove this file") from None


_BY_CONTENT = (RUN, SNAPSHOTS, CHECKPOINT)
"""Files that say themselves that Rattlebox wrote them; they may be large, and the last two grow."""


def _digests(folder: Path, names: Iterable[str]) -> dict[str, str]:
    return {name: "" if name in _BY_CONTENT else digest_of(folder / name) for name in names}


def _is_own(out: Path, name: str, marker: Marker | None) -> bool:
    """Return whether a file is not there, or is a result of Rattlebox."""
    path = out / name
    if not os.path.lexists(path):
        return True
    if name == RUN:
        return _case_in(path) is not None
    if name == SNAPSHOTS:
        return path.is_file() and is_snapshots(path)
    if name == CHECKPOINT:
        return path.is_file() and is_checkpoint(path)
    return marker is not None and marker.files.get(name) in ("", digest_of(path))


_NOT_OURS = (
    "{} was not written by this command, or has changed since; it is not replaced\n  try: another -o folder, or move it"
)
_ADVICE = "  try: another -o folder, or --replace"


def _case_in(file: Path) -> str | None:
    try:
        return read_case(file) if file.is_file() else None
    except DataError as error:
        raise DataError(error.complaint, "another -o folder, or remove this file") from None


def _is_of(checkpoint: Checkpoint) -> bool:
    try:
        return checkpoint.read() is not None
    except DataError:
        return False


def _check_inputs(out: Path, case: Case) -> None:
    """Refuse a case that reads what would be written over."""
    signals = (*case.loads, *case.base, *case.shaker_motion)
    packings = [damper.packing for damper in case.particle_dampers]
    for part in (case.structure, *signals, *packings):
        named = getattr(part, "file", None) or ()
        for file in [named] if isinstance(named, str) else [*named.values()] if named else []:
            if Path(file).name in WRITTEN and Path(file).resolve().parent == out.resolve():
                raise DataError(
                    f"{out / Path(file).name} is read by the case, and results go there\n  try: another -o folder"
                )


def _bare(text: str) -> str:
    """The text of a case without what its results do not depend on, or as it is where a file that it names is gone."""
    try:
        return comparable_toml(Case.from_toml(text))
    except RattleboxError:
        return text


def is_run(path: Path) -> bool:
    """Tell whether a path is of a run, finished or not: a file, or the folder of one.

    Parameters
    ----------
    path
        What a user names.
    """
    if path.exists():
        return path.is_file() or any((path / name).is_file() for name in (RUN, CHECKPOINT, SNAPSHOTS))
    return path.suffix in (".nc", ".vtkhdf")


def files_in(folder: Path) -> list[str]:
    """Return the names of the files of a run that are in a folder.

    Parameters
    ----------
    folder
        Folder of the run.
    """
    return [name for name in WRITTEN if (folder / name).is_file()]
