"""`rattlebox plot` of a run on disk: its figures, pictures of its particles and films."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from rattlebox._util.exceptions import CaseError, DataError
from rattlebox.cli.exit_codes import STOPPED
from rattlebox.cli.folder import CHECKPOINT, RUN, SNAPSHOTS
from rattlebox.cli.output import output_file
from rattlebox.cli.plot import FORMATS, PlotOptions, check_output, refuse_particle_options
from rattlebox.cli.terminal import terminal
from rattlebox.engines.checkpoint import started_with
from rattlebox.model.errors import nearest
from rattlebox.plots.particles import FILMS, film_particles, plot_particles
from rattlebox.plots.spheres import default_renderer
from rattlebox.results import Run, load
from rattlebox.results.snapshots import Snapshots

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plot_run(path: Path, out: Path | None, options: PlotOptions) -> None:
    """Draw a run or its snapshots and write the figure or the film."""
    check_output(out, options.size, (*FORMATS, *FILMS))
    with output_file(out, "run.png") as (file, note):
        _plot(path, file, options)
        terminal().print(f"written: {file}{note}", soft_wrap=True)


def _plot(path: Path, out: Path, options: PlotOptions) -> None:
    """Draw a run or its snapshots and write a file; see `plot_run`."""
    kind, number, is_film = options.kind, options.number, out.suffix in FILMS
    if path.is_dir():
        path /= SNAPSHOTS if is_film or number is not None else RUN
    # First the options that do not apply, before anything is read.
    for option, value in (("--of", options.of), ("--at", options.at and options.at[0])):
        if value:
            alternative = "--number" if path.suffix == ".vtkhdf" else "--kind"
            raise CaseError(f"{option} {value}: this option is for studies, and {path} is a run", alternative)
    if is_film and options.size is not None:
        raise CaseError(f"--size {options.size}: the size of films is in pixels", "--pixels 1280x720")
    if not is_film and options.pixels is not None:
        alternative = f"-o {out.with_suffix('.gif')}, or --size page"
        raise CaseError(f"--pixels {options.pixels}: this option is for films", alternative)
    drawing = _drawing_options(options)
    if not path.exists():
        reason, suggestion = _why_missing(path)
        raise DataError(f"{path} does not exist{reason}", suggestion)
    run = Snapshots(path) if path.suffix == ".vtkhdf" else load(path)
    if number is not None and not isinstance(run, Snapshots):
        raise CaseError(
            f"--number {number}: {path} has no snapshots",
            "run.vtkhdf in the same folder; output.snapshots in the case creates it",
        )
    try:
        if is_film:
            _check_film(out, kind, number)
            _write_film(run, out, drawing)
        else:
            _draw(run, kind, -1 if number is None else number, drawing).savefig(out)
    except (ValueError, IndexError) as error:
        raise CaseError(str(error)) from None
    if (kind == "particles" or isinstance(run, Snapshots)) and default_renderer() == "plain":
        terminal().print(
            "drawn without PyVista, which uses the graphics card: python -m pip install 'rattlebox[3d]'", soft_wrap=True
        )


def _drawing_options(options: PlotOptions) -> dict[str, Any]:
    """Return the options that were typed as arguments of the functions that draw."""
    view, pixels = options.view, options.pixels
    values = {
        "size": options.size,
        "colour": options.colour,
        "view": _numbers("view", view, ",") if view and "," in view else view,
        "pixels": pixels and tuple(map(int, _numbers("pixels", pixels, "x"))),
    }
    return {name: value for name, value in values.items() if value is not None}


def _numbers(option: str, text: str, separator: str) -> tuple[float, ...]:
    """Return the two numbers of an option."""
    parts = text.split(separator)
    try:
        numbers = tuple(float(part) for part in parts)
    except ValueError:
        numbers = ()
    if len(numbers) != 2 or not all(map(math.isfinite, numbers)):
        example = {"view": "-60,18", "pixels": "1280x720"}[option]
        raise CaseError(f"--{option} {text}: two numbers are needed", f"--{option} {example}")
    return numbers


def _why_missing(path: Path) -> tuple[str, str]:
    """Return the reason why a file of a run is missing, "" if it is not known, and a suggestion."""
    present = {name for name in (RUN, SNAPSHOTS, CHECKPOINT) if (path.parent / name).is_file()}
    if path.name == SNAPSHOTS and RUN in present and "particles" not in load(path.parent / RUN).groups:
        return ": only runs of particle dampers have snapshots", "-o run.png"
    if path.name == SNAPSHOTS:
        return "", "output.snapshots in the case"
    unfinished = ": the run is not finished" if CHECKPOINT in present else ""
    hints = [f"rattlebox plot {path.parent / SNAPSHOTS}"] if SNAPSHOTS in present else []
    if unfinished:
        hints.append(f"repeat the command that started the run{started_with(path.parent / CHECKPOINT)}; it resumes")
    return unfinished, ", or ".join(hints) or "the folder that 'rattlebox run -o' wrote"


def _check_film(out: Path, kind: str | None, number: int | None) -> None:
    """Raise if an option does not apply to a film."""
    picture = out.with_suffix(".png")
    if number is not None:
        raise CaseError(f"--number {number}: a film shows all snapshots", f"-o {picture}")
    if kind not in (None, "particles"):
        raise CaseError(f"--kind {kind}: a film can only show particles", f"run.nc, -o {picture}")


def _write_film(run: Run | Snapshots, out: Path, options: dict[str, Any]) -> None:
    if not isinstance(run, Snapshots):
        raise CaseError(
            f"-o {out}: a film needs the snapshots in run.vtkhdf", "run.vtkhdf; output.snapshots in the case creates it"
        )
    try:
        film_particles(run, out, **options)
    except KeyboardInterrupt:
        typer.echo(f"stopped; {out} was not written", err=True)
        sys.exit(STOPPED)


def _draw(run: Run | Snapshots, kind: str | None, number: int, options: dict[str, Any]) -> Figure:
    kinds = ["particles"] if isinstance(run, Snapshots) else dir(run.plot)
    wanted = kind or ("particles" if isinstance(run, Snapshots) else "motion")
    if wanted not in kinds:
        raise CaseError(f"--kind {kind}: this run has no such figure", nearest(str(kind), kinds))
    if isinstance(run, Snapshots):
        return plot_particles(run, number=number, **options)
    if wanted != "particles":
        refuse_particle_options(colour=options.get("colour"), view=options.get("view"))
    figure: Figure = getattr(run.plot, wanted)(**options)
    return figure
