"""The folder that `rattlebox run` writes."""

from __future__ import annotations

from pathlib import Path

from rattlebox.model.errors import CaseError

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
