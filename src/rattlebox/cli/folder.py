"""Results folder of `rattlebox run`: which files it may write, replace or resume."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path

import rattlebox
from rattlebox._util.atomic_io import FileTaken, install, remove_temporaries, sync, unchanged, watch
from rattlebox._util.exceptions import DataError, RattleboxError
from rattlebox._util.own_files import REPLACEMENT, RUN_FOLDER, folder_marker, list_files, may_replace
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
from rattlebox.studies.run.result_file import is_result_file

RUN, SNAPSHOTS, CHECKPOINT = "run.nc", "run.vtkhdf", "run.checkpoint"

WRITTEN = (
    RUN,
    SNAPSHOTS,
    "run.mat",
    *(f"{group}.csv" for group in ("motion", "energy", "impacts", "particles")),
    *(f"{figure}.png" for figure in ("motion", "energy", "impacts")),
    CHECKPOINT,
)
"""Names of all files that the command can write to the folder."""


def make_folder(out: Path) -> None:
    """Create a folder for results."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise DataError(f"{out} is a file; results need a folder", "--out results") from None
    except OSError as error:
        # Another name in the same folder would be refused, too.
        advice = "--out with a folder in which you may write, such as --out ~/results"
        raise DataError(f"the folder {out} cannot be created: {error.strerror}", advice) from None


@dataclass(frozen=True)
class RunFolder:
    """Paths to which a run writes its files."""

    out: Path
    folder: Path
    checkpoint: Path
    snapshots: Path
    rewritten: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()

    def finish(self, names: Sequence[str], *, keep_checkpoint: bool) -> Path:
        """Move the files to the results folder, and remove those that they replace."""
        own_checkpoint = [CHECKPOINT] if keep_checkpoint and self.checkpoint == self.folder / CHECKPOINT else []
        if self.folder == self.out:
            list_files(self.out, rattlebox.__version__, digests(self.out, [*names, *own_checkpoint]))
        else:
            files = digests(self.folder, [*names, *own_checkpoint])
            in_use = {self.checkpoint, self.snapshots}  # may be in `out` although the other files are not
            removed = [name for name in self.removed if name not in files and self.out / name not in in_use]
            write_marker(self.folder, replace(_new_marker(REPLACEMENT, files), complete=True, about={"gone": removed}))
            _install(self.out, self.folder)
        checkpoint = self.out / CHECKPOINT if own_checkpoint else self.checkpoint
        if not keep_checkpoint and unchanged(checkpoint):
            checkpoint.unlink(missing_ok=True)
        return checkpoint


@contextmanager
def reserve_folder(out: Path, case: Case, *, checkpoint: Path | None, replace: bool) -> Iterator[RunFolder]:
    """Lock a folder for the results of a case; it may contain results of an earlier run of the same case."""
    make_folder(out)
    marker = folder_marker(out)
    if (out / "zarr.json").exists() or (marker and marker.name not in (RUN_FOLDER, "")):
        raise DataError(f"{out} contains a study; a run needs a folder of its own", "another -o folder")
    _check_inputs(out, case)
    # The lock of the checkpoint stands for the folder: a second run into the same folder is refused.
    own = Checkpoint(out / CHECKPOINT, case)
    resumable = bool(case.particle_dampers) and checkpoint is None
    with ExitStack() as stack:
        with own.lock():
            # A process that was killed may have left temporary files, or a finished replacement that was not moved; the
            # lock shows that nobody else works on them.
            for name in WRITTEN:
                remove_temporaries(out / name)
            for folder in replacements(out):
                _install(out, folder)
            # Results of the same case may be replaced without a question; those of another one are what a user would
            # miss.
            earlier = _stored_case(out / RUN)
            present = tuple(name for name in files_in(out) if may_replace(out / name))
            lines = (
                differences({"case": _bare(earlier)}, {"case": comparable_toml(case)}) if earlier is not None else []
            )
            if lines and not replace:
                raise DataError("\n".join([f"{out / RUN} is the result of another case", *lines]), _SUGGESTION)
            # A checkpoint of an unfinished run holds hours of computation, and is kept unless this run resumes it.
            foreign = own.path.is_file() and not (resumable and (not replace or _is_readable(own)))
            if foreign and not replace:
                raise DataError(f"{own.path} belongs to an unfinished run", _SUGGESTION)
            if foreign and not is_checkpoint(own.path):
                raise DataError(
                    f"{own.path} was not written by this command, or has changed since, and is not overwritten",
                    "another -o folder, or move the file",
                )
        notes = [f"{folder} {_UNFINISHED}" for folder in replacements(out)]
        resumed = resumable and own.path.is_file() and not foreign
        # Otherwise the run itself locks its checkpoint, and with it the folder.
        if not resumable or (not resumed and (lines or foreign)):
            stack.enter_context(own.lock())
        # Nothing of value is in the way: the run writes into the folder itself.
        if not lines and not foreign:
            rewritten = () if earlier is None else present
            yield RunFolder(out, out, checkpoint or own.path, out / SNAPSHOTS, rewritten, tuple(notes))
            return
        # Otherwise it writes beside the earlier results, which are removed only when the new ones are complete.
        folder = stack.enter_context(_replacement(out, case))
        notes = [note for note in notes if not note.startswith(f"{folder} ")]
        default = own.path if resumed else folder / CHECKPOINT
        snapshots = (out if resumed else folder) / SNAPSHOTS
        yield RunFolder(out, folder, checkpoint or default, snapshots, (), tuple(notes), present)


def replacements(out: Path) -> list[Path]:
    """Return the folders of unfinished runs that will replace another run."""
    paths = []
    for path in sorted(out.glob("replacement-*")):
        try:
            marker = read_marker(path)
        except DamagedError:
            continue
        if marker and marker.name == REPLACEMENT:
            paths.append(path)
    return paths


_UNFINISHED = (
    "contains an unfinished run that was started with --replace: repeat its command to resume it, or remove the folder"
)


@contextmanager
def _replacement(out: Path, case: Case) -> Iterator[Path]:
    """Yield a folder for the files of a run that replaces another one; keep it if the run can resume from it."""
    folder = out / f"replacement-{hashlib.sha256(comparable_toml(case).encode()).hexdigest()[:8]}"
    if folder.exists() and folder not in replacements(out) and not (folder.is_dir() and is_free(folder)):
        raise DataError(f"{folder} was not written by Rattlebox", "another -o folder, or move this one")
    folder.mkdir(exist_ok=True)
    write_marker(folder, _new_marker(REPLACEMENT, dict.fromkeys(WRITTEN, "")))
    try:
        yield folder
    finally:
        marker = read_marker(folder)
        complete = marker is not None and marker.complete  # it waits for files of others that are in the way
        if not complete and not any((folder / name).is_file() for name in (CHECKPOINT, SNAPSHOTS)):
            _discard(folder)


def _install(out: Path, folder: Path) -> None:
    """Move the files of a finished replacement to the results folder, also if an earlier move was interrupted."""
    marker = read_marker(folder)
    if not marker or not marker.complete:
        return
    with watch(out / name for name in WRITTEN):
        remove(out, [name for name in marker.about["gone"] if unchanged(out / name) and may_replace(out / name)])
        taken = [name for name in marker.files if not _moved(folder / name, out / name)]
    sync(out)
    if taken:
        names = ", ".join(str(out / name) for name in taken)
        raise FileTaken(
            f"not written by Rattlebox, or put there during the run, and not overwritten: {names}; "
            f"the new results are in {folder}",
            "move your files, and repeat the command",
        )
    write_marker(out, _new_marker(RUN_FOLDER, marker.files))
    _discard(folder)


def _moved(source: Path, target: Path) -> bool:
    """Move a file, if it is still there; return False if the target must not be replaced."""
    if not source.is_file():
        return True
    try:
        if may_replace(target):
            install(source, target)
            return True
    except FileTaken:
        pass
    return False


def _discard(folder: Path) -> None:
    """Remove the files of a replacement, and its folder if nothing else is in it."""
    for name in WRITTEN:
        remove_temporaries(folder / name)
    with suppress(FileNotFoundError):
        remove(folder, [*WRITTEN, f".{CHECKPOINT}.lock", MARKER])
    with suppress(OSError):
        folder.rmdir()


def _new_marker(kind: str, files: Mapping[str, str]) -> Marker:
    return Marker(kind, rattlebox.__version__, files=files)


_SELF_DESCRIBING = (RUN, SNAPSHOTS, CHECKPOINT)
"""Files whose content identifies them as results of Rattlebox; they may be large, so they have no digest."""


def digests(folder: Path, names: Iterable[str]) -> dict[str, str]:
    """Return the digests of files of a run for the marker of their folder."""
    return {name: "" if name in _SELF_DESCRIBING else digest_of(folder / name) for name in names}


_SUGGESTION = "another -o folder, or --replace"


def _stored_case(file: Path) -> str | None:
    try:
        return read_case(file) if file.is_file() else None
    except DataError as error:
        raise DataError(error.complaint, "another -o folder, or remove this file") from None


def _is_readable(checkpoint: Checkpoint) -> bool:
    """Return whether a checkpoint can be read and belongs to its case."""
    try:
        return checkpoint.read() is not None
    except DataError:
        return False


def _check_inputs(out: Path, case: Case) -> None:
    """Raise if an output file would overwrite one of the case's input files."""
    signals = (*case.loads, *case.base, *case.shaker_motion)
    packings = [damper.packing for damper in case.particle_dampers]
    for part in (case.structure, *signals, *packings):
        named = getattr(part, "file", None) or ()
        for file in [named] if isinstance(named, str) else [*named.values()] if named else []:
            if Path(file).name in WRITTEN and Path(file).resolve().parent == out.resolve():
                raise DataError(
                    f"{out / Path(file).name} is an input of the case, and a result would overwrite it",
                    "another -o folder",
                )


def _bare(text: str) -> str:
    """Return the text of a case without fields that do not affect results, or unchanged if an input file is missing."""
    try:
        return comparable_toml(Case.from_toml(text))
    except RattleboxError:
        return text


def is_run(path: Path) -> bool:
    """Return whether a path is a file of a run, or the folder of one, finished or not."""
    if path.exists():
        return (path.is_file() and not is_result_file(path)) or any(
            (path / name).is_file() for name in (RUN, CHECKPOINT, SNAPSHOTS)
        )
    return path.suffix in (".nc", ".vtkhdf")


def files_in(folder: Path) -> list[str]:
    """Return the names of the files of a run that exist in a folder."""
    return [name for name in WRITTEN if (folder / name).is_file()]
