"""`rattlebox run`: one case file."""

from __future__ import annotations

import sys
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

from rattlebox.engines.simulate import simulate
from rattlebox.model.case import Case
from rattlebox.model.errors import CaseError
from rattlebox.results import GranularRun, Run


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


def _simulated(case: Case) -> Run:
    """Run a case; one with particles shows on a terminal how far it is."""
    if not case.particle_dampers:
        return simulate(case)
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        line = bar.add_task("steps", total=None)
        return simulate(case, progress=lambda done, total: bar.update(line, completed=done, total=total))


def run_case(path: Path, out: Path, *, csv: bool, mat: bool, figures: bool) -> None:
    """Run a case file and write what comes back.

    Parameters
    ----------
    path
        Case file.
    out
        Folder for results, made if needed.
    csv, mat, figures
        What to write besides run.nc.
    """
    case = Case.from_file(path)
    make_folder(out)
    run = _simulated(case)
    console = Console()
    console.print(run.summary())
    run.save(out / "run.nc")
    written = ["run.nc"]
    if mat:
        run.to_mat(out / "run.mat")
        written.append("run.mat")
    if csv:
        written += [path.name for path in run.to_csv(out)]
    if figures:
        for name in ("motion", "energy") if isinstance(run, GranularRun) else ("motion", "energy", "impacts"):
            getattr(run.plot, name)().savefig(out / f"{name}.png")
            written.append(f"{name}.png")
    console.print(f"written to {out}: {', '.join(written)}")
    if not run.ok:
        console.print(f"[bold]{run.status}[/bold]: {run.message}")
        sys.exit(1)
