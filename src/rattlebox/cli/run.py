"""`rattlebox run`: one case file."""

from __future__ import annotations

import sys
from pathlib import Path

from rich.console import Console

from rattlebox.engines.simulate import simulate
from rattlebox.model.case import Case


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
    run = simulate(Case.from_file(path))
    out.mkdir(parents=True, exist_ok=True)
    console = Console()
    console.print(run.summary())
    run.save(out / "run.nc")
    written = ["run.nc"]
    if mat:
        run.to_mat(out / "run.mat")
        written.append("run.mat")
    if csv:
        run.to_csv(out)
        written.append("motion.csv, energy.csv, impacts.csv")
    if figures:
        for name in ("motion", "energy", "impacts"):
            getattr(run.plot, name)().savefig(out / f"{name}.png")
            written.append(f"{name}.png")
    console.print(f"written to {out}: {', '.join(written)}")
    if not run.ok:
        console.print(f"[bold]{run.status}[/bold]: {run.message}")
        sys.exit(1)
