"""Tells how far a study is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TaskProgressColumn, TextColumn, TimeRemainingColumn
from rich.text import Text


class _Rate(ProgressColumn):
    """Variants a second."""

    def render(self, task: Task) -> Text:
        """Return the rate, once it is known."""
        speed = task.finished_speed or task.speed
        if not speed:
            return Text("")
        return Text(f"{speed:,.0f}/s" if speed > 10 else f"{60 * speed:,.0f}/min", style="progress.data.speed")


@contextmanager
def progress_bar(
    progress: bool | Callable[[int, int], object] | None, total: int, what: str = "variants"
) -> Iterator[Callable[[int], object]]:
    """Give a function to tell the number of variants that are done.

    Parameters
    ----------
    progress
        True or False for a bar, None for a bar on a terminal, or a function of the number done and of all.
    total
        Number of all.
    what
        What they are called.
    """
    if callable(progress):
        yield lambda done: progress(done, total)
        return
    console = Console(stderr=True)
    columns = (
        TextColumn(f"{{task.completed:,.0f}} of {{task.total:,.0f}} {what}"),
        BarColumn(),
        TaskProgressColumn(),
        _Rate(),
        TimeRemainingColumn(),
        TextColumn("left"),
    )
    shown = console.is_terminal if progress is None else progress
    with Progress(*columns, console=console, transient=True, disable=not shown) as bar:
        line = bar.add_task("", total=total)
        yield lambda done: bar.update(line, completed=done)
