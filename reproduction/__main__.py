"""`python -m reproduction`: compute the figures and claims of the reference paper, and write the report."""

from __future__ import annotations

import argparse
import signal
import sys
from pathlib import Path


def main() -> int:
    """Write the report that the command line requests."""
    purpose = "Reproduce and judge the reference paper: all figures and claims on one page."
    only = 'number of a figure ("4", "7c", "A1"), or "paper" for all but A1 to A6; may be repeated (default: all)'
    parser = argparse.ArgumentParser(prog="python -m reproduction", description=purpose)
    add = parser.add_argument
    add(
        "-o",
        "--out",
        type=Path,
        default=Path("report"),
        help="new folder, or that of an earlier report (default: report)",
    )
    add("--only", action="append", default=[], metavar="FIGURE", help=only)
    add("--workers", type=_positive, help="number of processes (default: one per core)")
    arguments = parser.parse_args()

    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    import rattlebox as rb

    from .report import choose, cores, write_report

    console = Console(highlight=False, markup=False, emoji=False)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    try:
        figures = choose(arguments.only)
    except ValueError as error:
        parser.error(str(error))
    try:
        with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
            task = bar.add_task("computing figures", total=len(figures))

            def progress(done: int, _: int, last: str) -> None:
                bar.update(task, completed=done, description=f"{last} done")

            page = write_report(arguments.out, arguments.only, workers=arguments.workers or cores(), progress=progress)
    except rb.RattleboxError as error:
        parser.error(str(error))
    except OSError as error:
        parser.error(f"{error.filename}: {error.strerror}" if error.filename else str(error.strerror or error))
    text = f"written to {arguments.out}: {page.name}, and each figure as SVG, PNG and CSV with its case files"
    console.print(text, soft_wrap=True)
    return 0


def _positive(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of processes; whole numbers >= 1 are allowed")
    return int(text)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.stderr.write("stopped\n")
        sys.exit(128 + signal.SIGINT)
