"""Process that computes runs, maps and live views of a page, so that the server never blocks.

The parent sends a task, a tuple of a name of `TASKS` and its arguments; the worker answers with ("progress", ...) and at
last ("done", result) or ("failed", text). It ends when its parent ends. Finished results are written before they are
reported, so that a server that is killed loses none.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import rattlebox as rb

from .draft import FAILURES, FIRST, said, template
from .results import save_run
from .views import view_of_run

Report = Callable[..., None]

FIRST_LOOK = 1.0
"""Computing time until the first intermediate result of a particle run [s]; later ones take twice as long each."""
MOST_WAIT = 16.0


def main(connection: Connection) -> None:
    """Do the tasks of a connection until it closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C ends the server, which ends its workers
    threading.Thread(target=_end_with_parent, args=(os.getppid(),), daemon=True).start()
    live(lambda *_: None, template(FIRST), ".", False)  # loads all libraries before the first task
    while True:
        try:
            name, *arguments = connection.recv()
        except EOFError:
            return
        if name in BACKGROUND and hasattr(os, "nice"):
            os.nice(10)  # so that page and browser get the processor first
        try:
            result = TASKS[name](lambda *what: connection.send(("progress", *what)), *arguments)
            answer: tuple[Any, ...] = ("done", result)
        except FAILURES as error:
            answer = ("failed", said(error))
        try:
            connection.send(answer)
        except BrokenPipeError:
            return


def _end_with_parent(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(0.5)
    os._exit(1)


def live(report: Report, toml: str, folder: str, compare: bool) -> bytes:
    """Run a 1-D case and return its view; nothing is written."""
    case = rb.Case.from_toml(toml, folder=Path(folder))
    return _view(rb.simulate(case, progress=False), case, compare)


_unsaved: list[tuple[rb.Run, Path]] = []
"""The last run if it could not be written."""


def run(report: Report, toml: str, folder: str, name: str, compare: bool) -> tuple[bytes, str, str]:
    """Run a case, write its results, and report views of the motion so far.

    A particle run is stopped at intervals and resumed from its checkpoint, which gives the same bits.
    """
    case = rb.Case.from_toml(toml, folder=Path(folder))
    target = Path(folder) / f"{name}.nc"
    if not case.particle_dampers:
        result = rb.simulate(case, progress=False)
    else:
        checkpoint, snapshots = target.with_suffix(".checkpoint"), target.with_suffix(".vtkhdf")
        # Each look costs a checkpoint and a view, so that they become rarer the longer the run takes.
        wait = FIRST_LOOK
        while True:
            due = time.monotonic() + wait

            def proceed(done: int, total: int, due: float = due) -> bool:
                report("steps", done, total)
                return time.monotonic() < due or done >= total

            result = rb.simulate(case, checkpoint=checkpoint, snapshots=snapshots, progress=proceed)
            if result.status != "interrupted":
                break
            report("view", view_of_run(result))
            wait = min(2 * wait, MOST_WAIT)
    # Kept until the next run, so that a full disk loses no result.
    _unsaved[:] = [(result, target)]
    view = _view(result, case, compare)
    try:
        return view, "", save(report)
    except (rb.RattleboxError, OSError) as error:
        return view, str(error), name


def save(report: Report) -> str:
    """Write the last run, remove its checkpoint, and return the name of the run."""
    result, target = _unsaved[0]
    name = save_run(result, target.parent, target.stem)
    if result.case.particle_dampers:
        target.with_suffix(".checkpoint").unlink(missing_ok=True)
    return name


def _view(result: rb.Run, case: rb.Case, compare: bool) -> bytes:
    bare = None
    if compare and case.dampers and case.modes.decay.size and "impacts" in result.groups:
        bare = rb.simulate(case.without_dampers(), progress=False)
    return view_of_run(result, bare)


def sweep(
    report: Report, toml: str, folder: str, name: str, axes: dict[str, tuple[Any, ...]], measure: str, compare: bool
) -> None:
    """Run a case over one or two axes and write the map to the folder, and the same without dampers if requested."""
    case = rb.Case.from_toml(toml, folder=Path(folder))
    spaced = {path: _spaced(*values) for path, values in axes.items()}
    store = Path(folder) / f"{name}.zarr"

    def compute(case: rb.Case, axes: dict[str, Any], store: Path, what: str) -> None:
        rb.sweep(case, axes, measure, store=store, progress=lambda done, total: report(what, done, total))

    if compare:  # first, so that the map shows the ratio while it fills
        varied = {path: values for path, values in spaced.items() if not path.startswith("damper")}
        without = case.without_dampers()
        varied = varied or {"duration": [case.duration]}
        compute(without, varied, store.with_suffix(".bare.zarr"), "variants without damper")
    compute(case, spaced, store, "variants")


def _spaced(start: str, stop: str, count: int, logarithmic: bool) -> Any:
    return (rb.geomspace if logarithmic else rb.linspace)(start, stop, count)


BACKGROUND = {"run", "sweep"}
"""Tasks with a lower priority; they are the first task of their process."""

TASKS: dict[str, Callable[..., Any]] = {
    "start": lambda report: None,
    "live": live,
    "run": run,
    "save": save,
    "sweep": sweep,
}
