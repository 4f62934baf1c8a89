"""`rattlebox show` of a run on disk: its origin, summary and files."""

from __future__ import annotations

from pathlib import Path

from rich.text import Text

from rattlebox._util.exceptions import DataError
from rattlebox.cli.folder import CHECKPOINT, RUN, SNAPSHOTS, files_in, replacements
from rattlebox.cli.terminal import terminal
from rattlebox.engines.checkpoint import started_with
from rattlebox.results import load


def show_run(path: Path) -> None:
    """Print the date, version and platform of a run, its summary with its notes, and the files in its folder."""
    console, file = terminal(), path / RUN if path.is_dir() else path
    files = f"  files: {', '.join(files_in(file.parent))}" if file.name == RUN else ""
    if path.is_dir() and not file.is_file():
        unfinished = (path / CHECKPOINT).is_file()
        title = "an unfinished run" if unfinished else f"files of a run, without {RUN}"
        console.print(Text.assemble((str(path), "bold"), f": {title}"), soft_wrap=True)
        console.print(files, soft_wrap=True)
        if unfinished:
            by = started_with(path / CHECKPOINT)
            console.print(f"  Repeat the command that started the run{by} to resume it.", soft_wrap=True)
        elif (path / SNAPSHOTS).is_file():
            console.print(f"  To draw the snapshots: rattlebox plot {path / SNAPSHOTS}", soft_wrap=True)
        _show_replacements(path)
        return
    if not file.exists():
        raise DataError(f"{file} does not exist", "the folder that 'rattlebox run -o' wrote")
    run = load(file)
    origin = run.provenance
    title = f"run of {origin.created[:16].replace('T', ' ')} UTC, Rattlebox {origin.version}, {origin.platform}"
    console.print(Text.assemble((str(path), "bold"), f": {title}"), soft_wrap=True)
    console.print(run.summary())
    if files:
        console.print(files, soft_wrap=True)
        if (file.parent / CHECKPOINT).is_file():
            _print_replacement(CHECKPOINT)
        _show_replacements(file.parent)


def _show_replacements(folder: Path) -> None:
    """Print the unfinished runs that will replace the one in a folder."""
    for path in replacements(folder):
        _print_replacement(path.name)


def _print_replacement(name: str) -> None:
    terminal().print(
        f"  {name}: an unfinished run that replaces this one; repeat its command to resume", soft_wrap=True
    )
