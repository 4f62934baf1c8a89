"""`rattlebox plot` of a run on disk: its figures, or pictures and films of its particles."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from rattlebox._util.exceptions import CaseError, DataError
from rattlebox.cli.exit_codes import STOPPED
from rattlebox.cli.folder import CHECKPOINT, RUN, SNAPSHOTS
from rattlebox.cli.plot import FORMATS, refuse_particle_options, target
from rattlebox.cli.terminal import terminal
from rattlebox.model.errors import nearest
from rattlebox.plots.particles import FILMS, film_particles, plot_particles
from rattlebox.plots.spheres import usual_renderer
from rattlebox.results import load
from rattlebox.results.snapshots import Snapshots

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plot_run(
    path: Path,
    out: Path | None,
    *,
    kind: str | None,
    of: str | None,
    at: Sequence[str],
    number: int | None,
    size: str | None,
    colour: str | None = None,
    view: str | None = None,
    pixels: str | None = None,
) -> None:
    """Draw a run or its snapshots and write the figure or the film.

    Parameters
    ----------
    path
        run.nc, run.vtkhdf, or the folder that holds them: a film, and a snapshot by its number, are of the latter.
    out
        File to write: PNG, SVG or PDF, or of snapshots GIF or MP4; default run.png in the current folder.
    kind
        "motion", "energy", "impacts" or "particles"; default the first, of snapshots the last.
    of, at
        What to draw of a study, which a run is not.
    number
        Which snapshot, from 0; default the last.
    size
        Width; default that of the figure.
    colour, view
        Colour of particles, and name of a view or "azimuth,elevation" in degrees.
    pixels
        "1280x720", for films.

    Raises
    ------
    CaseError
        When an argument does not fit.
    DataError
        When there is no such file.
    """
    out, told = target(out, "run.png", size, (*FORMATS, *FILMS))
    if path.is_dir():
        path /= SNAPSHOTS if out.suffix in FILMS or number is not None else RUN
    for option, value in (("--of", of), ("--at", at and at[0])):
        if value:
            what = "--number" if path.suffix == ".vtkhdf" else "--kind"
            raise CaseError(f"{option} {value}: this applies to a study, and {path} is a run\n  try: {what}")
    film = out.suffix in FILMS
    if film and size is not None:
        raise CaseError(f"--size {size}: films have a number of pixels", "--pixels 1280x720")
    if not film and pixels is not None:
        raise CaseError(f"--pixels {pixels}: this applies to films", f"-o {out.with_suffix('.gif')}, or --size page")
    particles = {"colour": colour, "view": view if view is None or "," not in view else _numbers("view", view, ",")}
    given = {"size": size, **particles, "pixels": pixels and tuple(map(int, _numbers("pixels", pixels, "x")))}
    options: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    if not path.exists():
        raise DataError(f"there is no file {path}{_instead(path)}")
    run = Snapshots(path) if path.suffix == ".vtkhdf" else load(path)
    if number is not None and not isinstance(run, Snapshots):
        raise CaseError(
            "--number: a run has no snapshots\n  try: run.vtkhdf beside it, with output.snapshots in the case"
        )
    console = terminal()
    try:
        if film:
            _check_film(out, kind, number)
            _film(run, out, options)
        else:
            figure = _figure(run, kind, -1 if number is None else number, options)
            figure.savefig(out)
    except (ValueError, IndexError) as error:
        raise CaseError(str(error)) from None
    if (kind == "particles" or isinstance(run, Snapshots)) and usual_renderer() == "plain":
        console.print(
            "drawn without PyVista, which uses the graphics card: python -m pip install 'rattlebox[3d]'",
            soft_wrap=True,
        )
    console.print(told, soft_wrap=True)


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


def _instead(path: Path) -> str:
    """What to try where a file of a run is not there."""
    there = {name for name in (RUN, SNAPSHOTS, CHECKPOINT) if (path.parent / name).is_file()}
    if path.name == SNAPSHOTS and RUN in there and "particles" not in load(path.parent / RUN).groups:
        return ", and this run has no particles in space to show"
    if path.name == SNAPSHOTS:
        return "\n  try: output.snapshots in the case"
    over = ": the run is not over" if CHECKPOINT in there else ""
    hints = [f"rattlebox plot {path.parent / SNAPSHOTS}"] if SNAPSHOTS in there else []
    hints += ["the command that began it, which goes on"] if over else []
    told = ", or ".join(hints) or "the folder that 'rattlebox run -o' wrote"
    return f"{over}\n  try: {told}"


def _check_film(out: Path, kind: str | None, number: int | None) -> None:
    """Refuse what does not apply to a film."""
    picture = out.with_suffix(".png")
    if number is not None:
        raise CaseError(f"--number {number}: a film shows all snapshots\n  try: -o {picture}")
    if kind not in (None, "particles"):
        raise CaseError(f"--kind {kind}: a film shows particles\n  try: run.nc, -o {picture}")


def _film(of: Any, out: Path, options: dict[str, Any]) -> None:
    if not isinstance(of, Snapshots):
        raise CaseError(f"-o {out}: a film needs snapshots\n  try: run.vtkhdf, with output.snapshots in the case")
    try:
        film_particles(of, out, **options)
    except KeyboardInterrupt:
        typer.echo(f"stopped; {out} is not written", err=True)
        sys.exit(STOPPED)


def _figure(of: Any, kind: str | None, number: int, options: dict[str, Any]) -> Figure:
    if isinstance(of, Snapshots):
        kinds: tuple[str, ...] = ("particles",)
    else:
        kinds = of.groups
    if (kind or kinds[0]) not in kinds:
        raise CaseError(f"--kind {kind}: there is no such kind here\n  {nearest(str(kind), kinds)}")
    if isinstance(of, Snapshots):
        return plot_particles(of, number=number, **options)
    if (kind or kinds[0]) != "particles":
        refuse_particle_options(colour=options.get("colour"), view=options.get("view"))
    figure: Figure = getattr(of.plot, kind or kinds[0])(**options)
    return figure
