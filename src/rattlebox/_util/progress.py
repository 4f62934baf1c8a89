"""Progress bars of long calls, drawn by rich in terminals and by IPython in notebooks."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from typing import Any

Progress = bool | Callable[[int, int], object]
"""True for a bar, False for none, or a function of the number done and the total number; False as its result stops the
call."""

_DELAY = 2.0  # s
_REDRAWN = 0.1  # s
_in_use = threading.Lock()


class Report:
    """Progress of a call, passed on to a function or to a bar that appears after a delay.

    Parameters
    ----------
    delay
        Time after which a bar appears [s].
    """

    def __init__(self, progress: Progress, what: str, delay: float) -> None:
        self._function = progress if callable(progress) else None
        self._what = what
        self._state = 0, 0
        self._drawn_at = 0.0
        self._draw: Callable[[int, int], None] | None = None
        self._stack = ExitStack()
        self._lock = threading.RLock()
        self._timer: threading.Timer | None = None
        if progress is True and _may_draw():
            # A timer shows the bar even if nothing is reported for a long time.
            self._timer = threading.Timer(delay, self._show)
            self._timer.daemon = True
            self._timer.start()

    def __call__(self, done: int, total: int) -> object:
        """Report the number done and the total number; the result False is a request to stop."""
        if self._function is not None:
            return self._function(done, total)
        self._state = done, total
        if self._draw is not None and time.monotonic() > self._drawn_at + _REDRAWN:
            self._drawn_at = time.monotonic()
            self._draw(done, total)
        return None

    def advance(self, done: int, total: int) -> None:
        """Report the number done and the total number; raise KeyboardInterrupt if the progress function returns False."""
        if self(done, total) is False:
            raise KeyboardInterrupt

    def close(self) -> None:
        """Remove the bar."""
        with self._lock:
            if self._timer is not None:
                self._timer.cancel()
            self._timer = None
            self._stack.close()

    def _show(self) -> None:
        with self._lock:
            if self._timer is not None:
                self._draw = _drawing(self._stack, self._what)
                self._draw(*self._state)


@contextmanager
def progress_bar(progress: Progress, what: str, *, delay: float = _DELAY) -> Iterator[Report]:
    """Yield a function to which the number done and the total number are reported.

    A bar is drawn in notebooks, and on the standard error if that is a terminal; inside another bar none is drawn.

    `delay`: time after which the bar appears [s].
    """
    report = Report(progress, what, delay)
    try:
        yield report
    finally:
        report.close()


def announce(progress: Progress, line: str) -> None:
    """Print a line on the standard error if progress is shown."""
    if progress is True:
        print(line, file=sys.stderr, flush=True)


def _may_draw() -> bool:
    return threading.current_thread() is threading.main_thread() and (sys.stderr.isatty() or _in_notebook())


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    return hasattr(ipython and ipython.get_ipython(), "kernel")


def _drawing(stack: ExitStack, what: str) -> Callable[[int, int], None]:
    """Show a bar until the stack is closed, and return the function that updates it."""
    if not _in_use.acquire(blocking=False):
        return lambda done, total: None
    stack.callback(_in_use.release)
    with suppress(ImportError):
        return _in_cell(stack) if _in_notebook() else _in_terminal(stack, what)
    return lambda done, total: None


def _in_cell(stack: ExitStack) -> Callable[[int, int], None]:
    from IPython.display import ProgressBar, clear_output  # type: ignore[import-not-found]

    bar = ProgressBar(1)
    bar.display()
    stack.callback(clear_output)

    def draw(done: int, total: int) -> None:
        bar.total = total or 1
        bar.progress = done

    return draw


def _in_terminal(stack: ExitStack, what: str) -> Callable[[int, int], None]:
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        Progress,
        ProgressColumn,
        Task,
        TaskProgressColumn,
        TextColumn,
        TimeRemainingColumn,
    )
    from rich.text import Text

    class Rate(ProgressColumn):
        """Number done per second or minute."""

        def render(self, task: Task) -> Text:
            speed = task.finished_speed or task.speed
            if not speed:
                return Text("")
            return Text(f"{speed:,.0f}/s" if speed > 10 else f"{60 * speed:,.0f}/min", style="progress.data.speed")

    columns: list[Any] = [TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), Rate()]
    columns += [TimeRemainingColumn(), TextColumn("left")]
    bar = stack.enter_context(Progress(*columns, console=Console(stderr=True), transient=True))
    line = bar.add_task("preparing", total=None)

    def draw(done: int, total: int) -> None:
        if total:
            bar.update(line, description=f"{done:,} of {total:,} {what}", completed=done, total=total)

    return draw
