"""The folder that `rattlebox run` writes."""

from __future__ import annotations

from pathlib import Path

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


def take_over(out: Path, case: Case, *, replace: bool) -> None:
    """Make a folder for the results of a case, which may hold those of an earlier run of it.

    Parameters
    ----------
    out
        Folder.
    case
        What is to be run.
    replace
        Remove the files of an earlier run, of whatever case; other files stay.

    Raises
    ------
    CaseError
        When the folder cannot be made, or holds the results of another case, with what differs; when these are in use by
        another process, or no results of Rattlebox.
    """
    make_folder(out)
    file = out / RUN
    try:
        earlier = read_case(file) if file.is_file() else None
    except ValueError as error:
        raise CaseError(f"{error}\n  try: another -o folder, or remove this file") from None
    if replace and (earlier is not None or (out / CHECKPOINT).is_file()):
        with Checkpoint(out / CHECKPOINT, case).held():
            for name in files_in(out):
                (out / name).unlink()
    elif earlier is not None and (lines := differences({"case": _bare(earlier)}, {"case": bare(case)})):
        raise CaseError("\n".join([f"{file} holds another run", *lines, "  try: another -o folder, or --replace"]))


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
        return path.is_file() or any((path / name).is_file() for name in (RUN, CHECKPOINT))
    return path.suffix in (".nc", ".vtkhdf")


def files_in(folder: Path) -> list[str]:
    """Return the names of the files of a run that are in a folder.

    Parameters
    ----------
    folder
        Folder of the run.
    """
    return [name for name in WRITTEN if (folder / name).is_file()]
