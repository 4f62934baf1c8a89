"""What the rattlebox command can do."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from rattlebox._util.exceptions import CaseError, DataError, RattleboxError
from rattlebox._util.text import printable
from rattlebox.cli.exit_codes import STOPPED


class _PlainFlags:
    """Leaves out the type of options that take no value, in the help of commands."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Return the arguments and options of a command."""
        params: list[Any] = super().get_params(ctx)  # type: ignore[misc]
        for param in params:
            if getattr(param, "is_flag", False):
                param.metavar = ""
        return params


class _Command(_PlainFlags, TyperCommand):
    pass


class _Group(_PlainFlags, TyperGroup):
    pass


_WRITES = {"allow_extra_args": True}  # so that _check_single can say how the output is named

app = typer.Typer(
    cls=_Group,
    help="Simulate and design particle and impact dampers.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)


def _version(asked: bool) -> None:
    if asked:
        from rattlebox import __version__

        typer.echo(__version__)
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


def _check_single(ctx: typer.Context, first: Path) -> None:
    """Raise if a command got more than its one file or folder."""
    if ctx.args:
        raise CaseError(
            f"{' '.join(ctx.args)}: 'rattlebox {ctx.info_name}' takes one argument, {first}\n"
            f"  try: rattlebox {ctx.info_name} {first} -o {ctx.args[0]}"
        )


@app.command(cls=_Command, context_settings=_WRITES)
def run(
    ctx: typer.Context,
    case: Annotated[Path, typer.Argument(help="Case file (TOML).")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for results.")] = Path("out"),
    csv: Annotated[bool, typer.Option(help="Write CSV files too.")] = False,
    mat: Annotated[bool, typer.Option(help="Write a MAT file too.")] = False,
    figures: Annotated[bool, typer.Option(help="Draw motion and energy, and the impacts of impact dampers.")] = True,
    checkpoint: Annotated[
        Path | None,
        typer.Option(help="File that keeps a run with particles on its way; default run.checkpoint in the folder."),
    ] = None,
    replace: Annotated[
        bool, typer.Option("--replace", help="Take the place of a run of another case, once the new one is over.")
    ] = False,
) -> None:
    """Run a case file: summary on the terminal, netCDF and figures in a folder. The same command goes on after a stop."""
    _check_single(ctx, case)
    from rattlebox.cli.run import run_case

    run_case(case, out, csv=csv, mat=mat, figures=figures, checkpoint=checkpoint, replace=replace)


@app.command(cls=_Command, context_settings=_WRITES)
def sweep(
    ctx: typer.Context,
    study: Annotated[Path, typer.Argument(help="Study file (TOML).")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder of results (Zarr); default named after the study file.")
    ] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Threads; default one for each core.")] = None,
    dask: Annotated[
        str | None, typer.Option(help="Address or file of a Dask scheduler, to run on its workers.")
    ] = None,
) -> None:
    """Run a study file: variants of a case over axes, or a ready map. The same command goes on after a stop."""
    _check_single(ctx, study)
    from rattlebox.cli.sweep import run_sweep

    run_sweep(study, out, workers, dask)


def _check_results(path: Path, wanted: str) -> None:
    """Raise if a result does not exist, or is a case file or a study file."""
    if not path.exists():
        raise DataError(f"{path} is not there", wanted)
    if path.suffix == ".toml" and path.is_file():
        raise DataError(f"{path} is a case file or a study file, not a result", wanted)


@app.command(cls=_Command)
def show(results: Annotated[Path, typer.Argument(help="Folder that run or sweep wrote; or run.nc.")]) -> None:
    """Tell what is in a study, and how far it is; or the summary, notes and files of a run."""
    _check_results(results, "the folder that 'rattlebox run -o' or 'rattlebox sweep -o' wrote")
    from rattlebox.cli.folder import is_run

    if is_run(results):
        from rattlebox.cli.show_run import show_run

        show_run(results)
        return
    from rattlebox.cli.show import show_study

    show_study(results)


@app.command(cls=_Command, context_settings=_WRITES)
def plot(
    ctx: typer.Context,
    results: Annotated[
        Path, typer.Argument(help="Folder that run or sweep wrote; or one of the files run.nc and run.vtkhdf.")
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            help="File to write: PNG, SVG or PDF; a film of snapshots as GIF or MP4. Default study.png or run.png here.",
        ),
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option(
            help="map or lines of a measure, or the kind that the study file names; default that, and of a sweep a map "
            "where both axes have more than six values. "
            "Of a run motion, energy, impacts or particles."
        ),
    ] = None,
    of: Annotated[str | None, typer.Option(help="Measure of a study; default the first.")] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(help='Value of a further axis of a study, "load.amplitude=5 kN"; repeat for more.'),
    ] = None,
    number: Annotated[int | None, typer.Option(help="Which snapshot of a run, from 0; default the last.")] = None,
    size: Annotated[str | None, typer.Option(help="column, page or slide; not of films.")] = None,
    colour: Annotated[
        str | None, typer.Option(help="Colour of particles: speed, spin, radius, species or none; default speed.")
    ] = None,
    view: Annotated[
        str | None,
        typer.Option(help="View of particles: oblique, front, side, top, corner, or azimuth,elevation in degrees."),
    ] = None,
    pixels: Annotated[str | None, typer.Option(help="Width and height of a film; default 1280x720.")] = None,
) -> None:
    """Draw a study: its own figure, or a measure over one or two of its axes. Draw a run, or film its particles."""
    _check_single(ctx, results)
    _check_results(results, "the folder that 'rattlebox run -o' or 'rattlebox sweep -o' wrote")
    from rattlebox.cli.folder import is_run

    if is_run(results):
        from rattlebox.cli.plot_run import plot_run

        plot_run(
            results,
            out,
            kind=kind,
            of=of,
            at=at or (),
            number=number,
            size=size,
            colour=colour,
            view=view,
            pixels=pixels,
        )
        return
    from rattlebox.cli.plot import plot_study, refuse_particle_options

    refuse_particle_options(colour=colour, view=view, pixels=pixels)

    plot_study(results, out, kind=kind, of=of, at=at or (), number=number, size=size)


@app.command(cls=_Command)
def demo(
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for results.")] = Path("demo"),
) -> None:
    """Run a steel ball on a pulsed structure with two restitution models side by side."""
    from rattlebox.cli.demo import run_demo

    run_demo(out)


@app.command(cls=_Command)
def schema(
    out: Annotated[Path | None, typer.Option("--out", "-o", help="File; default the terminal.")] = None,
) -> None:
    """Export the JSON Schema of case files, for editors."""
    import json

    from rattlebox._util.atomic_io import atomic_write
    from rattlebox.model.case import Case

    text = json.dumps(Case.json_schema(), indent=2) + "\n"
    if out is None:
        typer.echo(text, nl=False)
    else:
        with atomic_write(out) as name:
            name.write_text(text, encoding="utf-8")


@app.command(cls=_Command)
def materials() -> None:
    """List the materials of the library, with their sources."""
    from rattlebox.cli.materials import show_materials

    show_materials()


@app.command(cls=_Command)
def doctor() -> None:
    """Say what this machine can do, and which core is used and why."""
    from rattlebox.cli.doctor import examine

    examine()


def carry_out() -> None:
    """Run the command that the arguments of this process name.

    This is the only place where errors end the program: those of the package, and those of the system that reach it, are
    printed without a traceback, with exit code 2.
    """
    try:
        code = app(standalone_mode=False)
        if code == STOPPED:
            raise typer.Abort
        sys.exit(code)
    except RattleboxError as error:
        typer.echo(printable(f"error: {error}"), err=True)
        sys.exit(2)
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        typer.echo(printable(f"error: {where}{error.strerror or error}"), err=True)
        sys.exit(2)
    except MemoryError:
        typer.echo("error: there is not enough memory\n  try: a lower output rate, or fewer particles", err=True)
        sys.exit(2)
    except typer.Abort:
        typer.echo("stopped", err=True)
        sys.exit(STOPPED)
    except typer.Exit as stop:
        sys.exit(stop.exit_code)
    except Exception as error:
        show = getattr(error, "show", None)
        if show is None:
            raise
        show()
        sys.exit(getattr(error, "exit_code", 2))
