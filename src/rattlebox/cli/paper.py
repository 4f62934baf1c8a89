"""`rattlebox paper`: the reference study of the single ball, reproduced."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import typer
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from rattlebox.cli.terminal import terminal
from rattlebox.paper.report import choose, write_report
from rattlebox.studies.runner import cores


def make_report(out: Path, only: Sequence[str], workers: int | None) -> None:
    """Write the report, with a bar that tells how far it is when somebody watches.

    Parameters
    ----------
    out
        Folder.
    only
        Numbers of figures; none means all.
    workers
        Processes; default one for each core.
    """
    try:
        figures = choose(only)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="--only") from None
    console = terminal()
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("reproducing the paper", total=len(figures))

        def progress(done: int, _: int, last: str) -> None:
            bar.update(task, completed=done, description=f"{last} done")

        page = write_report(out, only, workers=workers or cores(), progress=progress)
    console.print(
        f"written to {out}: {page.name}, and each figure as SVG, PNG and CSV with its case files", soft_wrap=True
    )
