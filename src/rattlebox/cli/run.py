"""`rattlebox run`: one case file."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

from rattlebox.cli.main import STOPPED
from rattlebox.engines.simulate import simulate
from rattlebox.model.case import Case
from rattlebox.model.errors import CaseError, Hint
from rattlebox.results import GranularRun, Run

_RESULTS = (".nc", ".vtkhdf", ".mat", ".csv", ".png")


def make_folder(out: Path) -> None:
    """Make a folder for results.

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


def _simulated(case: Case, out: Path, checkpoint: Path) -> Run:
    """Run a case; one with particles shows on a terminal how far it is, and goes on where it was stopped."""
    if not case.particle_dampers:
        return simulate(case)
    console = Console(stderr=True, highlight=False)
    if checkpoint.is_file():
        console.print(f"going on from {checkpoint}", soft_wrap=True)
    snapshots = out / "run.vtkhdf" if case.output.snapshots else None
    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        line = bar.add_task("filling in", total=None)

        def progress(done: int, total: int) -> None:
            bar.update(line, description="steps", completed=done, total=total)

        return simulate(case, checkpoint=checkpoint, snapshots=snapshots, progress=progress)


def run_case(path: Path, out: Path, *, csv: bool, mat: bool, figures: bool, checkpoint: Path | None = None) -> None:
    """Run a case file and write what comes back.

    Parameters
    ----------
    path
        Case file.
    out
        Folder for results, made if needed.
    csv, mat, figures
        What to write besides run.nc.
    checkpoint
        From which a run with particles goes on; default run.checkpoint in the folder. Removed when the results are written.
    """
    case = Case.from_file(path)
    if checkpoint is not None and not case.particle_dampers:
        raise CaseError(
            "--checkpoint: there are no particles in space, and other runs take no time\n  try: leave it out"
        )
    if checkpoint is not None and checkpoint.suffix in _RESULTS and checkpoint.parent.resolve() == out.resolve():
        raise CaseError(f"--checkpoint {checkpoint}: results are written there\n  try: {out / 'run.checkpoint'}")
    make_folder(out)
    checkpoint = checkpoint or out / "run.checkpoint"
    written: list[str] = []
    try:
        run = _simulated(case, out, checkpoint)
        if run.status == "interrupted" and case.particle_dampers:
            typer.echo(run.message, err=True)
            sys.exit(STOPPED)
        if case.output.snapshots:
            written.append("run.vtkhdf")
        for name in _write(run, out, csv=csv, mat=mat, figures=figures):
            written.append(name)
        if run.status in ("finished", "ledger_open"):
            checkpoint.unlink(missing_ok=True)
    except Hint as hint:
        raise CaseError(f"{path}: {hint}") from None
    except KeyboardInterrupt:
        typer.echo(f"stopped; {_kept(checkpoint, out, written)}", err=True)
        sys.exit(STOPPED)
    console = Console()  # last, since who reads may have gone
    console.print(run.summary())
    console.print(f"written to {out}: {', '.join(written)}")
    if not run.ok:
        told = Console(stderr=True, highlight=False, soft_wrap=True)
        told.print(f"[bold]{run.status}[/bold]: {run.message}")
        if checkpoint.is_file():
            told.print(f"{checkpoint} is kept; a case that you have changed needs it removed, or another folder")
        sys.exit(1)


def _write(run: Run, out: Path, *, csv: bool, mat: bool, figures: bool) -> Iterator[str]:
    """Write files one after the other, and give the name of each when it is there."""
    run.save(out / "run.nc")
    yield "run.nc"
    if mat:
        run.to_mat(out / "run.mat")
        yield "run.mat"
    if csv:
        yield from [path.name for path in run.to_csv(out)]
    if figures:
        for name in ("motion", "energy") if isinstance(run, GranularRun) else ("motion", "energy", "impacts"):
            getattr(run.plot, name)().savefig(out / f"{name}.png")
            yield f"{name}.png"


def _kept(checkpoint: Path, out: Path, written: Sequence[str]) -> str:
    """What there is of a run that was stopped."""
    if checkpoint.is_file():
        return f"the same command goes on from {checkpoint}"
    return f"written to {out}: {', '.join(written)}" if written else "nothing is kept yet"
