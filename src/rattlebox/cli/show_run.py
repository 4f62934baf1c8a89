"""`rattlebox show` of a run on disk: how it ended, its numbers and its files."""

from __future__ import annotations

from pathlib import Path

from rich.text import Text

from rattlebox._util.exceptions import DataError
from rattlebox.cli.folder import CHECKPOINT, RUN, SNAPSHOTS, files_in, replacements
from rattlebox.cli.terminal import terminal
from rattlebox.results import load


def show_run(path: Path) -> None:
    """Print where a run comes from, its summary with its notes, and the files beside it.

    Parameters
    ----------
    path
        run.nc, or the folder of the run.

    Raises
    ------
    DataError
        When there is no such file, or it holds something else.
    """
    console, file = terminal(), path / RUN if path.is_dir() else path
    files = f"  files: {', '.join(files_in(file.parent))}" if file.name == RUN else ""
    if path.is_dir() and not file.is_file():
        goes_on = (path / CHECKPOINT).is_file()
        what = "a run that is not over" if goes_on else f"files of a run, without its {RUN}"
        console.print(Text.assemble((str(path), "bold"), f": {what}"), soft_wrap=True)
        told = "The command that began it goes on." if goes_on else f"rattlebox plot {path / SNAPSHOTS} draws it."
        console.print(f"{files}\n  {told}" if goes_on or (path / SNAPSHOTS).is_file() else files, soft_wrap=True)
        _show_replacements(path)
        return
    if not file.exists():
        raise DataError(f"there is no file {file}", "the folder that 'rattlebox run -o' wrote")
    run = load(file)
    came = run.provenance
    made = f"run of {came.created[:16].replace('T', ' ')} UTC, Rattlebox {came.version}, {came.platform}"
    console.print(Text.assemble((str(path), "bold"), f": {made}"), soft_wrap=True)
    console.print(run.summary())
    if files:
        console.print(files, soft_wrap=True)
        if (file.parent / CHECKPOINT).is_file():
            console.print(
                f"  {CHECKPOINT}: a run that takes its place is not over; its command continues it.", soft_wrap=True
            )
        _show_replacements(file.parent)


def _show_replacements(folder: Path) -> None:
    """Print which runs were begun to replace the one in a folder."""
    for path in replacements(folder):
        terminal().print(
            f"  {path.name}: a run that takes its place is not over; its command continues it.", soft_wrap=True
        )
