"""`rattlebox run`: one case file."""

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
from rattlebox.cli.folder import CHECKPOINT, RUN, SNAPSHOTS, Place, check_own, note_begun, taken
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


class _Lines:
    """Lines on how far a run is, one a minute, where there is no terminal for a bar."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._last: tuple[float, int] | None = None  # time of the last line or of the first steps, and steps done

    def tell(self, done: int, total: int) -> None:
        """Print a line if it is time."""
        now = monotonic()
        if self._console.is_terminal or (self._last and (now < self._last[0] + _MINUTE or done <= self._last[1])):
            return
        if self._last:
            then, before = self._last
            left = timedelta(seconds=round((total - done) * (now - then) / (done - before)))
            self._console.print(f"{done:,} of {total:,} steps ({done / total:.0%}), {left} left", soft_wrap=True)
        self._last = now, done


def _simulated(case: Case, place: Place) -> Run:
    """Run a case; one with particles tells how far it is, and goes on where it was stopped."""
    if not case.particle_dampers:
        return simulate(case)
    console = terminal(stderr=True)
    checkpoint, snapshots = place.checkpoint, place.snapshots if case.output.snapshots else None
    with progress_bar(True, "steps") as bar:
        lines = _Lines(console)
        going_on = checkpoint.is_file()

        def tell() -> None:
            """Say where the run goes on from, once the checkpoint has proved to be of this case."""
            nonlocal going_on
            if going_on:
                console.print(f"going on from {checkpoint}", soft_wrap=True)
            going_on = False

        def progress(done: int, total: int) -> None:
            tell()
            lines.tell(done, total)
            bar(done, total)

        run = simulate(case, checkpoint=checkpoint, snapshots=snapshots, progress=progress)
        tell()
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
    replace
        Take the place of a run of another case in the folder.
    """
    case = Case.from_file(path)
    if checkpoint is not None and not case.particle_dampers:
        raise CaseError(
            "--checkpoint: there are no particles in space, and other runs take no time\n  try: leave it out"
        )
    if checkpoint is not None and checkpoint.suffix in _RESULTS and checkpoint.parent.resolve() == out.resolve():
        raise DataError(f"--checkpoint {checkpoint}: results are written there\n  try: {out / CHECKPOINT}")
    with taken(out, case, checkpoint=checkpoint, replace=replace) as place:
        for note in place.notes:
            typer.echo(note, err=True)
        _run_in(path, case, place, csv=csv, mat=mat, figures=figures)


def _run_in(path: Path, case: Case, place: Place, *, csv: bool, mat: bool, figures: bool) -> None:
    """Run a case in a folder that is held."""
    out, checkpoint = place.out, place.checkpoint
    csv |= "motion.csv" in place.again  # so that all files are of one run
    mat |= "run.mat" in place.again
    figures |= "motion.png" in place.again
    names = _names(case, csv=csv, mat=mat, figures=figures)
    check_own(out, names)
    written: list[str] = []
    in_place = place.folder == out
    try:
        run = _simulated(case, place)
        if run.status == "interrupted" and case.particle_dampers:
            typer.echo(printable(run.message), err=True)
            sys.exit(STOPPED)
        if in_place:
            note_begun(out, names)
        if case.output.snapshots:
            written.append(SNAPSHOTS)
        for name in _write(run, place.folder, csv=csv, mat=mat, figures=figures):
            written.append(name)
        unfinished = bool(case.particle_dampers) and run.status not in ("finished", "energy_error")
        checkpoint = place.finish(written, keep_checkpoint=unfinished)
        in_place = True
    except CheckpointMismatch as refused:
        replacing = "--replace, " if checkpoint == out / CHECKPOINT else ""
        raise DataError(refused.complaint, f"another -o folder, {replacing}{refused.suggestion}") from None
    except Hint as hint:
        raise CaseError(f"{path}: {hint}") from None
    except KeyboardInterrupt:
        typer.echo(f"stopped; {_kept(checkpoint, out, written if in_place else ())}", err=True)
        sys.exit(STOPPED)
    console = terminal()  # last, since who reads may have gone
    console.print(run.summary())
    console.print(f"written to {out}: {', '.join(written)}", soft_wrap=True)
    if not run.ok:
        told = terminal(stderr=True)
        told.print(Text.assemble((run.status, "bold"), f": {run.message}"), soft_wrap=True)
        if checkpoint.is_file():
            needed = "another -o folder, or --replace" if checkpoint == out / CHECKPOINT else "another --checkpoint"
            told.print(f"{checkpoint} is kept; a case that you have changed needs {needed}", soft_wrap=True)
        sys.exit(1)


def _names(case: Case, *, csv: bool, mat: bool, figures: bool) -> list[str]:
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
    """Write files one after the other, and give the name of each when it is there."""
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


def _kept(checkpoint: Path, out: Path, written: Sequence[str]) -> str:
    """What there is of a run that was stopped."""
    if checkpoint.is_file():
        return f"the same command goes on from {checkpoint}"
    return f"written to {out}: {', '.join(written)}" if written else "nothing is kept yet"
