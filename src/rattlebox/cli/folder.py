"""The folder that `rattlebox run` writes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import NamedTuple

from rattlebox.engines.checkpoint import Checkpoint, bare
from rattlebox.model.case import Case
from rattlebox.model.differences import differences
from rattlebox.model.errors import CaseError
from rattlebox.results.netcdf import read_case

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


def make_folder(out: Path) -> None:
    """Make a folder for results.

    Parameters
    ----------
    out
        Folder.

    Raises
    ------
    CaseError
        When it cannot be made.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise CaseError(f"{out} is a file; results need a folder\n  try: --out results") from None
    except OSError as error:
        raise CaseError(f"the folder {out} cannot be made: {error.strerror}\n  try: --out results") from None


class Earlier(NamedTuple):
    """Names of files of an earlier run in a folder: those that go when results are written, and those written anew."""

    gone: tuple[str, ...]
    anew: tuple[str, ...]


@contextmanager
def taken(out: Path, case: Case, *, checkpoint: Path | None, replace: bool) -> Iterator[Earlier]:
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
        Take the place of a run of another case. Its files go when the new results are written; a checkpoint of the same case
        stays, since the run goes on from it.

    Raises
    ------
    CaseError
        When the folder cannot be made, holds a study, a run of another case, with what differs, or what is no run; when
        another process uses it, or the case reads a file that results would be written over.
    """
    make_folder(out)
    if (out / "zarr.json").exists():
        raise CaseError(f"{out} holds a study\n  try: another -o folder")
    _check_inputs(out, case)
    own = Checkpoint(out / CHECKPOINT, case)
    goes_on = bool(case.particle_dampers) and checkpoint is None
    with ExitStack() as stack:
        with own.held():
            earlier, there = _case_in(out / RUN), files_in(out)
            lines = differences({"case": _bare(earlier)}, {"case": bare(case)}) if earlier is not None else []
            if lines and not replace:
                raise CaseError("\n".join([f"{out / RUN} holds another run", *lines, _ADVICE]))
            if own.path.is_file() and not (goes_on and (not replace or _is_of(own))):
                if not replace:
                    raise CaseError(f"{own.path} is of a run that is not over\n{_ADVICE}")
                stack.enter_context(_aside(own.path))
        if not goes_on:  # else the run holds it
            stack.enter_context(own.held())
        yield Earlier(tuple(there) if lines else (), () if lines or earlier is None else tuple(there))


_ADVICE = "  try: another -o folder, or --replace"


def _case_in(file: Path) -> str | None:
    try:
        return read_case(file) if file.is_file() else None
    except ValueError as error:
        raise CaseError(f"{error}\n  try: another -o folder, or remove this file") from None


def _is_of(checkpoint: Checkpoint) -> bool:
    try:
        return checkpoint.read() is not None
    except CaseError:
        return False


@contextmanager
def _aside(path: Path) -> Iterator[None]:
    """Put a file out of the way; it comes back unless something took its place, or all went well."""
    aside = path.with_name(f".{path.name}.earlier")
    path.replace(aside)
    try:
        yield
    except BaseException:
        if not path.exists():
            aside.replace(path)
        raise
    finally:
        aside.unlink(missing_ok=True)


def _check_inputs(out: Path, case: Case) -> None:
    """Refuse a case that reads what would be written over."""
    signals = (*case.loads, *case.base, *case.shaker_motion)
    packings = [damper.packing for damper in case.particle_dampers]
    for part in (case.structure, *signals, *packings):
        file = getattr(part, "file", None)
        if file and Path(file).name in WRITTEN and Path(file).resolve().parent == out.resolve():
            raise CaseError(
                f"{out / Path(file).name} is read by the case, and results go there\n  try: another -o folder"
            )


def _bare(text: str) -> str:
    """The text of a case without what its results do not depend on, or as it is where a file that it names is gone."""
    try:
        return bare(Case.from_toml(text))
    except CaseError:
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
