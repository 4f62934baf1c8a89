"""`rattlebox run`: simulate one case file."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from datetime import timedelta
from functools import partial
from itertools import chain, count
from pathlib import Path
from time import monotonic

import typer
from rich.console import Console
from rich.text import Text

import rattlebox
from rattlebox._util.atomic_io import FileTaken, watch
from rattlebox._util.exceptions import CaseError, DataError
from rattlebox._util.own_files import claim, list_files
from rattlebox._util.progress import progress_bar
from rattlebox._util.text import printable
from rattlebox.cli.exit_codes import STOPPED
from rattlebox.cli.folder import CHECKPOINT, RUN, SNAPSHOTS, RunFolder, reserve_folder
from rattlebox.cli.terminal import terminal
from rattlebox.engines.checkpoint import CheckpointMismatch
from rattlebox.engines.simulate import simulate
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint
from rattlebox.results import Run
from rattlebox.results.export import write_table
from rattlebox.results.schema import Engine, groups

_FIGURES = ("motion", "energy", "impacts")
_RESULTS = (".nc", ".vtkhdf", ".mat", ".csv", ".png")
_MINUTE = 60.0  # s


class _ProgressLog:
    """Progress of a run as one line per minute, for output that is not a terminal and so cannot show a bar."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._last: tuple[float, int] | None = None  # time of the last line or of the first steps, and steps done

    def update(self, done: int, total: int) -> None:
        """Print a line if a minute has passed."""
        now = monotonic()
        if self._console.is_terminal or (self._last and (now < self._last[0] + _MINUTE or done <= self._last[1])):
            return
        if self._last:
            then, before = self._last
            left = timedelta(seconds=round((total - done) * (now - then) / (done - before)))
            self._console.print(f"{done:,} of {total:,} steps ({done / total:.0%}), {left} left", soft_wrap=True)
        self._last = now, done


def _simulate(case: Case, folder: RunFolder, start: Path | None) -> Run:
    """Simulate a case; a run with particles shows its progress and resumes from its checkpoint."""
    if start is not None or not case.particle_dampers:
        return simulate(case, start=start)
    console = terminal(stderr=True)
    checkpoint, snapshots = folder.checkpoint, folder.snapshots if case.output.snapshots else None
    with progress_bar(True, "steps") as bar:
        log = _ProgressLog(console)
        resuming = checkpoint.is_file()

        def report_resume() -> None:
            """Print the checkpoint from which the run resumes, as soon as it is known to belong to this case."""
            nonlocal resuming
            if resuming:
                console.print(f"resuming from {checkpoint}", soft_wrap=True)
            resuming = False

        def progress(done: int, total: int) -> None:
            report_resume()
            log.update(done, total)
            bar(done, total)

        run = simulate(case, checkpoint=checkpoint, snapshots=snapshots, progress=progress)
        report_resume()
        return run


def run_case(
    path: Path,
    out: Path,
    *,
    csv: bool,
    mat: bool,
    figures: bool,
    checkpoint: Path | None = None,
    start: Path | None = None,
    replace: bool = False,
) -> None:
    """Simulate a case file, write its results and print its summary."""
    case = Case.from_file(path)
    if checkpoint is not None and not case.particle_dampers:
        raise CaseError(
            f"--checkpoint {checkpoint}: {path} has no particle damper, and only runs with particles write checkpoints",
            "leave out --checkpoint",
        )
    if checkpoint is not None and start is not None:
        raise CaseError("--start: a run that continues another one writes no checkpoints", "leave out --checkpoint")
    if start is not None and start.resolve().parent == out.resolve():
        raise DataError(f"--start {start}: a result could overwrite this file", "another -o folder")
    if checkpoint is not None and checkpoint.suffix in _RESULTS and checkpoint.parent.resolve() == out.resolve():
        raise DataError(
            f"--checkpoint {checkpoint}: a result could overwrite a file with this suffix in the results folder",
            f"--checkpoint {out / CHECKPOINT}",
        )
    with reserve_folder(out, case, checkpoint=checkpoint, replace=replace) as folder:
        for note in folder.notes:
            typer.echo(note, err=True)
        _run_in_folder(path, case, folder, start, csv=csv, mat=mat, figures=figures)


def _run_in_folder(
    path: Path, case: Case, folder: RunFolder, start: Path | None, *, csv: bool, mat: bool, figures: bool
) -> None:
    """Simulate a case and write its results to a reserved folder."""
    out, checkpoint = folder.out, folder.checkpoint
    # Files of an earlier run of the same case are written again, so that all files belong to one run.
    csv |= "motion.csv" in folder.rewritten
    mat |= "run.mat" in folder.rewritten
    figures |= "motion.png" in folder.rewritten
    names = _result_names(case, csv=csv, mat=mat, figures=figures)
    written: dict[str, str] = {}
    installed = folder.folder == out
    watched = [checkpoint, *(out / name for name in folder.removed), *(folder.folder / name for name in names)]
    try:
        # The names are checked now, and each again when its file is complete: hours may lie between.
        with claim(out / name for name in names), watch(watched):
            run = _simulate(case, folder, start)
            if run.status == "interrupted" and case.particle_dampers:
                typer.echo(printable(run.message), err=True)
                sys.exit(STOPPED)
            if installed:  # so that the next command recognises the files if this one is killed
                list_files(out, rattlebox.__version__, dict.fromkeys(names, ""))
            if case.output.snapshots:
                written[SNAPSHOTS] = SNAPSHOTS
            for name, used in _write(run, folder.folder, csv=csv, mat=mat, figures=figures):
                written[name] = used
            others = [name for name, used in written.items() if used != name]
            if others:
                list_files(out, rattlebox.__version__, dict.fromkeys(others))
            unfinished = bool(case.particle_dampers) and run.status not in ("finished", "energy_error")
            checkpoint = folder.finish(list(written.values()), keep_checkpoint=unfinished)
        installed = True
    # The folder was free, so only the checkpoint can be of another run.
    except CheckpointMismatch as error:
        option = "--replace, " if checkpoint == out / CHECKPOINT else ""
        raise DataError(error.complaint, f"another -o folder, {option}{error.suggestion}") from None
    except Hint as hint:
        raise hint.restated(CaseError, str(path)) from None
    except KeyboardInterrupt:
        typer.echo(f"stopped; {_stop_message(checkpoint, out, list(written.values()) if installed else ())}", err=True)
        sys.exit(STOPPED)
    # The summary comes last, since the reader of a pipe may have closed it.
    console = terminal()
    console.print(run.summary())
    console.print(f"written to {out}: {', '.join(written.values())}", soft_wrap=True)
    if not run.ok:
        errors = terminal(stderr=True)
        errors.print(Text.assemble((run.status, "bold"), f": {run.message}"), soft_wrap=True)
        if checkpoint.is_file():
            option = "another -o folder, or --replace" if checkpoint == out / CHECKPOINT else "another --checkpoint"
            errors.print(f"{checkpoint} remains; to run a changed case, use {option}", soft_wrap=True)
    if others:
        raise DataError(
            f"files of others that appeared or changed in {out} during the run are not overwritten: {', '.join(others)}; "
            f"the results are in {', '.join(written[name] for name in others)}",
            "move your files; then the same command writes the results with their usual names",
        )
    if not run.ok:
        sys.exit(STOPPED if run.status == "interrupted" else 1)


def _result_names(case: Case, *, csv: bool, mat: bool, figures: bool) -> list[str]:
    """Return the names of the files that a run of a case writes."""
    engine: Engine = "dem" if case.particle_dampers else "impact"
    names = [SNAPSHOTS] if case.output.snapshots else []
    names.append(RUN)
    if mat:
        names.append("run.mat")
    if csv:
        names += [f"{group}.csv" for group in groups(engine)]
    if figures:
        names += [f"{name}.png" for name in groups(engine) if name in _FIGURES]
    return names


def _write(run: Run, folder: Path, *, csv: bool, mat: bool, figures: bool) -> Iterator[tuple[str, str]]:
    """Write the result files one after the other, and yield the usual name and the name of each when it is complete.

    They differ if a file that must not be replaced has the usual name.
    """
    writers: dict[str, Callable[[Path], object]] = {RUN: run.save}
    if mat:
        writers["run.mat"] = run.to_mat
    if csv:
        writers |= {f"{group}.csv": partial(write_table, run, group) for group in run.groups}
    if figures:
        writers |= {f"{name}.png": partial(_draw, run, name) for name in run.groups if name in _FIGURES}
    for name, write in writers.items():
        path = folder / name
        for used in chain([path], (path.with_stem(f"{path.stem}-{number}") for number in count(2))):
            try:
                write(used)
            except FileTaken:
                continue
            yield name, used.name
            break


def _draw(run: Run, figure: str, path: Path) -> None:
    getattr(run.plot, figure)().savefig(path)


def _stop_message(checkpoint: Path, out: Path, written: Sequence[str]) -> str:
    """Return which files a stopped run leaves, and how to resume it."""
    if checkpoint.is_file():
        return f"repeat the command to resume from {checkpoint}"
    return f"written to {out}: {', '.join(written)}" if written else "no results were written"
