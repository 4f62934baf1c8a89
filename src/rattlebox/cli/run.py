"""`rattlebox run`: simulate one case file."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from datetime import timedelta
from pathlib import Path
from time import monotonic

import typer
from rich.console import Console
from rich.text import Text

from rattlebox._util.exceptions import CaseError, DataError
from rattlebox._util.progress import progress_bar
from rattlebox._util.text import printable
from rattlebox.cli.exit_codes import STOPPED
from rattlebox.cli.folder import (
    CHECKPOINT,
    RUN,
    SNAPSHOTS,
    RunFolder,
    check_overwrite,
    register_names,
    reserve_folder,
)
from rattlebox.cli.terminal import terminal
from rattlebox.engines.checkpoint import CheckpointMismatch
from rattlebox.engines.simulate import simulate
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint
from rattlebox.results import Run
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


def _simulate(case: Case, folder: RunFolder) -> Run:
    """Simulate a case; a run with particles shows its progress and resumes from its checkpoint."""
    if not case.particle_dampers:
        return simulate(case)
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
    replace: bool = False,
) -> None:
    """Simulate a case file, write its results and print its summary.

    Parameters
    ----------
    path
        Case file.
    out
        Folder for results, created if needed.
    csv, mat, figures
        Whether to write CSV files, run.mat and figures besides run.nc.
    checkpoint
        Checkpoint file of a run with particles, from which it resumes; default run.checkpoint in the folder. It is
        removed when the results are written.
    replace
        Whether to replace the results of another case in the folder.
    """
    case = Case.from_file(path)
    if checkpoint is not None and not case.particle_dampers:
        raise CaseError(
            f"--checkpoint {checkpoint}: {path} has no particle damper, and only runs with particles write checkpoints\n"
            "  try: leave out --checkpoint"
        )
    if checkpoint is not None and checkpoint.suffix in _RESULTS and checkpoint.parent.resolve() == out.resolve():
        raise DataError(
            f"--checkpoint {checkpoint}: a result could overwrite a file with this suffix in the results folder\n"
            f"  try: --checkpoint {out / CHECKPOINT}"
        )
    with reserve_folder(out, case, checkpoint=checkpoint, replace=replace) as folder:
        for note in folder.notes:
            typer.echo(note, err=True)
        _run_in_folder(path, case, folder, csv=csv, mat=mat, figures=figures)


def _run_in_folder(path: Path, case: Case, folder: RunFolder, *, csv: bool, mat: bool, figures: bool) -> None:
    """Simulate a case and write its results to a reserved folder."""
    out, checkpoint = folder.out, folder.checkpoint
    # Files of an earlier run of the same case are written again, so that all files belong to one run.
    csv |= "motion.csv" in folder.rewritten
    mat |= "run.mat" in folder.rewritten
    figures |= "motion.png" in folder.rewritten
    names = _result_names(case, csv=csv, mat=mat, figures=figures)
    check_overwrite(out, names)
    written: list[str] = []
    installed = folder.folder == out
    try:
        run = _simulate(case, folder)
        if run.status == "interrupted" and case.particle_dampers:
            typer.echo(printable(run.message), err=True)
            sys.exit(STOPPED)
        if installed:
            register_names(out, names)
        if case.output.snapshots:
            written.append(SNAPSHOTS)
        for name in _write(run, folder.folder, csv=csv, mat=mat, figures=figures):
            written.append(name)
        unfinished = bool(case.particle_dampers) and run.status not in ("finished", "energy_error")
        checkpoint = folder.finish(written, keep_checkpoint=unfinished)
        installed = True
    except CheckpointMismatch as error:
        option = "--replace, " if checkpoint == out / CHECKPOINT else ""
        raise DataError(error.complaint, f"another -o folder, {option}{error.suggestion}") from None
    except Hint as hint:
        raise CaseError(f"{path}: {hint}") from None
    except KeyboardInterrupt:
        typer.echo(f"stopped; {_stop_message(checkpoint, out, written if installed else ())}", err=True)
        sys.exit(STOPPED)
    # The summary comes last, since the reader of a pipe may have closed it.
    console = terminal()
    console.print(run.summary())
    console.print(f"written to {out}: {', '.join(written)}", soft_wrap=True)
    if not run.ok:
        errors = terminal(stderr=True)
        errors.print(Text.assemble((run.status, "bold"), f": {run.message}"), soft_wrap=True)
        if checkpoint.is_file():
            option = "another -o folder, or --replace" if checkpoint == out / CHECKPOINT else "another --checkpoint"
            errors.print(f"{checkpoint} remains; to run a changed case, use {option}", soft_wrap=True)
        sys.exit(1)


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


def _write(run: Run, folder: Path, *, csv: bool, mat: bool, figures: bool) -> Iterator[str]:
    """Write the result files one after the other, and yield the name of each when it is complete."""
    run.save(folder / RUN)
    yield RUN
    if mat:
        run.to_mat(folder / "run.mat")
        yield "run.mat"
    if csv:
        yield from [path.name for path in run.to_csv(folder)]
    if figures:
        for name in (name for name in run.groups if name in _FIGURES):
            getattr(run.plot, name)().savefig(folder / f"{name}.png")
            yield f"{name}.png"


def _stop_message(checkpoint: Path, out: Path, written: Sequence[str]) -> str:
    """Return which files a stopped run leaves, and how to resume it."""
    if checkpoint.is_file():
        return f"repeat the command to resume from {checkpoint}"
    return f"written to {out}: {', '.join(written)}" if written else "no results were written"
