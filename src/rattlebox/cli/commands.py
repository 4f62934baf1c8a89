"""The subcommands of `rattlebox` and their options."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer
from typer.core import TyperCommand, TyperGroup

from rattlebox._util.atomic_io import only_watched_files
from rattlebox._util.exceptions import CaseError, DataError, RattleboxError, ResourceError, message
from rattlebox._util.plugins import PluginWarning
from rattlebox._util.text import printable
from rattlebox.cli.exit_codes import STOPPED
from rattlebox.cli.registry import commands_of_plugins

Command = TypeVar("Command", bound=Callable[..., Any])


class _PlainFlags:
    """Mixin that hides the type of flags in the help of commands."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Return the arguments and options of a command."""
        params: list[Any] = super().get_params(ctx)  # type: ignore[misc]
        for param in params:
            if getattr(param, "is_flag", False):
                param.metavar = ""
        return params


_LESS_MEMORY = {
    "run": "a lower output rate, a shorter duration, or fewer particles",
    "sweep": "fewer workers, fewer samples, or fewer variants",
    "fmu": "fewer particles",
    "pack": "fewer particles",
    "show": "a result of a run with a lower output rate",
    "plot": "a result of a run with a lower output rate",
    "report": "fewer results in one report",
}
"""What needs less memory, by command; other commands need little."""


class _Command(_PlainFlags, TyperCommand):
    def invoke(self, ctx: Any) -> Any:
        """Run the command; a lack of memory becomes an error with advice for this command."""
        try:
            return super().invoke(ctx)
        except MemoryError as error:
            advice = _LESS_MEMORY.get(self.name or "", "end other programs that need much memory")
            raise ResourceError(f"not enough memory for 'rattlebox {self.name}'", advice) from error


class _Group(_PlainFlags, TyperGroup):
    pass


app = typer.Typer(
    cls=_Group,
    help="Simulate and design particle and impact dampers.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)


_REGISTERED = app.registered_commands


def _command(name: str | None = None, *, example: str | None = None) -> Callable[[Command], Command]:
    """Register a function as a command.

    Extra arguments reach _check_single, whose message suggests the option for the output.
    """
    epilog = f"Example: rattlebox {example}" if example else None
    return app.command(name, cls=_Command, context_settings={"allow_extra_args": True}, epilog=epilog)


def _out(help: str) -> Any:
    """Return the option for the output of a command."""
    return typer.Option("--out", "-o", help=help)


_CaseFile = Annotated[Path, typer.Argument(help="Case file (TOML).")]
_NamedAfterCase = Annotated[Path | None, _out("File to write; default named after the case file.")]
_Alone = Annotated[
    bool, typer.Option("--alone", help="Only the damper: its attachment moves as prescribed, and it returns the force.")
]


def _print_version(requested: bool) -> None:
    if requested:
        from rattlebox import __version__

        typer.echo(__version__)
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


def _check_single(ctx: typer.Context, first: Path) -> None:
    """Raise if a command received more than one file or folder."""
    if ctx.args:
        raise CaseError(
            f"unexpected argument {' '.join(ctx.args)}: 'rattlebox {ctx.info_name}' takes one argument, here {first}",
            f"rattlebox {ctx.info_name} {first} -o {ctx.args[0]}",
        )


@_command(example="run case.toml -o out")
def run(
    ctx: typer.Context,
    case: _CaseFile,
    out: Annotated[Path, _out("Folder for results.")] = Path("out"),
    csv: Annotated[bool, typer.Option(help="Also write CSV files.")] = False,
    mat: Annotated[bool, typer.Option(help="Also write a MATLAB file, run.mat.")] = False,
    figures: Annotated[bool, typer.Option(help="Draw motion and energy, and the impacts of impact dampers.")] = True,
    checkpoint: Annotated[
        Path | None,
        typer.Option(help="Checkpoint file, for particle dampers only; default run.checkpoint in the results folder."),
    ] = None,
    start: Annotated[
        Path | None,
        typer.Option(help="Result of a run, run.nc, from whose end this one continues; time continues, too."),
    ] = None,
    replace: Annotated[
        bool,
        typer.Option("--replace", help="Replace the results of another case in the folder when this run is finished."),
    ] = False,
) -> None:
    """Simulate a case file; print a summary, write netCDF and figures. Repeat the command to resume a stopped run."""
    _check_single(ctx, case)
    from rattlebox.cli.run import run_case

    run_case(case, out, csv=csv, mat=mat, figures=figures, checkpoint=checkpoint, start=start, replace=replace)


@_command(example="inspect quake.csv")
def inspect(
    ctx: typer.Context, file: Annotated[Path, typer.Argument(help="File of records or modes, of any program.")]
) -> None:
    """Show what a file of another program contains, what would be assumed, and the lines that use it."""
    _check_single(ctx, file)
    from rattlebox.model.case import Case  # noqa: F401  (a message about one part names the fields of others)
    from rattlebox.model.inspect_file import inspect

    typer.echo(printable(str(inspect(file))))


@_command(example="sweep study.toml -o study.zarr --workers 4")
def sweep(
    ctx: typer.Context,
    study: Annotated[Path, typer.Argument(help="Study file (TOML).")],
    out: Annotated[Path | None, _out("Folder for results (Zarr); default named after the study file.")] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, metavar="<int>", help="Number of threads; default one per core.")
    ] = None,
    dask: Annotated[
        str | None, typer.Option(help="Address or scheduler file of a Dask cluster on which to run.")
    ] = None,
    estimate: Annotated[
        bool, typer.Option("--estimate", help="Print the predicted processor time, from a few short runs, and stop.")
    ] = False,
) -> None:
    """Run a study file: many variants of one case. Repeat the command to resume a stopped study."""
    _check_single(ctx, study)
    from rattlebox.cli.sweep import run_sweep

    run_sweep(study, out, workers, dask, estimate=estimate)


@_command(example="fmu case.toml --alone -o damper.fmu")
def fmu(
    ctx: typer.Context,
    case: _CaseFile,
    out: _NamedAfterCase = None,
    fmi: Annotated[int, typer.Option(help="Version of FMI, 2 or 3.")] = 3,
    input: Annotated[
        str, typer.Option(help="Input of a damper alone: velocity or acceleration of its attachment.")
    ] = "velocity",
    alone: _Alone = False,
    other_systems: Annotated[
        bool,
        typer.Option("--other-systems", help="Add libraries for Windows, macOS and arm64, compiled but never run."),
    ] = False,
) -> None:
    """Write a case as an FMU for co-simulation: a structure with dampers, or a damper alone."""
    _check_single(ctx, case)
    from rattlebox.cli.component import write_fmu

    write_fmu(case, out, fmi, input, alone, other_systems)


@_command(example="pack case.toml --alone -o damper.bin")
def pack(ctx: typer.Context, case: _CaseFile, out: _NamedAfterCase = None, alone: _Alone = False) -> None:
    """Write a case as a packed case, for the C interface rattlebox.h."""
    _check_single(ctx, case)
    from rattlebox.cli.component import write_packed

    write_packed(case, out, alone)


def _check_results(path: Path) -> None:
    """Raise if a path does not exist, or is a case file or a study file."""
    suggestion = "the folder that 'rattlebox run -o' or 'rattlebox sweep -o' wrote"
    if not path.exists():
        raise DataError(f"{path} does not exist", suggestion)
    if path.suffix == ".toml" and path.is_file():
        raise DataError(f"{path} is a case file or a study file, not a result", suggestion)


@app.command(cls=_Command, epilog="Example: rattlebox show out")
def show(
    results: Annotated[Path, typer.Argument(help="Folder written by run or sweep, or a file run.nc or branch.nc.")],
) -> None:
    """Print the summary, notes and files of a run, or the progress, axes and results of a study."""
    _check_results(results)
    from rattlebox.cli.folder import is_run

    if is_run(results):
        from rattlebox.cli.show_run import show_run

        show_run(results)
        return
    from rattlebox.cli.show import show_study

    show_study(results)


@_command(example="plot out --kind energy -o energy.pdf")
def plot(
    ctx: typer.Context,
    results: Annotated[
        Path, typer.Argument(help="Folder written by run or sweep, or a file run.nc, run.vtkhdf or branch.nc.")
    ],
    out: Annotated[
        Path | None,
        _out(
            "File to write: PNG, SVG or PDF; GIF or MP4 for a film of the snapshots. Default run.png or study.png in the "
            "current folder."
        ),
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option(
            help="Run: motion, energy, phase_portrait, impacts, particles, responses, or case. Study: map, lines, or "
            "the kind in the study file. Default: motion, or the figure of the study's kind; for a sweep, a map if both "
            "axes have more than six values, otherwise lines."
        ),
    ] = None,
    of: Annotated[str | None, typer.Option(help="Measure to draw; default the first. Studies only.")] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            metavar="<axis=value>",
            help='Value of a further axis, such as "load.amplitude=5 kN"; may be repeated. Studies only.',
        ),
    ] = None,
    number: Annotated[
        int | None, typer.Option(help="Number of the snapshot, from 0; default the last. Particles only.")
    ] = None,
    size: Annotated[str | None, typer.Option(help="Width of the figure: column, page or slide. Not for films.")] = None,
    colour: Annotated[
        str | None, typer.Option(help="Colour of particles: speed, spin, radius, species or none; default speed.")
    ] = None,
    view: Annotated[
        str | None,
        typer.Option(help="View of particles: oblique, front, side, top, corner, or azimuth,elevation in degrees."),
    ] = None,
    pixels: Annotated[str | None, typer.Option(help="Width and height of a film; default 1280x720.")] = None,
) -> None:
    """Draw a figure of a run or a study, or a film of the particles of a run."""
    _check_single(ctx, results)
    _check_results(results)
    from rattlebox.cli.folder import is_run
    from rattlebox.cli.plot import PlotOptions, plot_study

    options = PlotOptions(kind, of, tuple(at or ()), number, size, colour, view, pixels)
    if is_run(results):
        from rattlebox.cli.plot_run import plot_run

        plot_run(results, out, options)
    else:
        plot_study(results, out, options)


@app.command(cls=_Command, epilog="Example: rattlebox report bare damped -o comparison.html")
def report(
    results: Annotated[
        list[Path],
        typer.Argument(
            help="Folder written by run or sweep, or a file run.nc or branch.nc. Several runs are compared with each other."
        ),
    ],
    out: Annotated[
        Path | None, _out("File to write (HTML); default named after the first results, in the current folder.")
    ] = None,
    title: Annotated[str | None, typer.Option(help="Title of the page.")] = None,
    question: Annotated[str | None, typer.Option(help="Question that the results answer, one sentence.")] = None,
) -> None:
    """Write a report about a run or a study: one HTML page without other files, which prints on A4."""
    from rattlebox.cli.report import write

    for path in results:
        _check_results(path)
    write(results, out, title, question)


@app.command(cls=_Command, epilog="Example: rattlebox demo -o demo")
def demo(out: Annotated[Path, _out("Folder for results.")] = Path("demo")) -> None:
    """Simulate a steel ball on a pulsed structure with two restitution models and compare them."""
    from rattlebox.cli.demo import run_demo

    run_demo(out)


@_command("app", example="app my_dampers")
def browser_app(
    ctx: typer.Context,
    folder: Annotated[Path, typer.Argument(help="Folder for case files and results.")] = Path("rattlebox"),
    port: Annotated[
        int, typer.Option(min=0, max=65535, metavar="<int>", help="Port on 127.0.0.1; 0 chooses a free one.")
    ] = 0,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Print the address only.")] = False,
) -> None:
    """Open the browser application: change a case and watch it, map it, keep results."""
    _check_single(ctx, folder)
    from rattlebox._util.optional_imports import optional_import

    optional_import("nicegui", "app")
    from rattlebox.app.server import serve

    serve(folder, port=port, show=not no_browser)


@app.command(cls=_Command, epilog="Example: rattlebox schema -o case.schema.json")
def schema(out: Annotated[Path | None, _out("File to write; default: print on the terminal.")] = None) -> None:
    """Write the JSON Schema of case files, with which an editor completes and checks them."""
    import json

    from rattlebox._util.atomic_io import atomic_write
    from rattlebox.cli.output import output_file
    from rattlebox.model.case import Case

    text = json.dumps(Case.json_schema(), indent=2) + "\n"
    if out is None:
        typer.echo(text, nl=False)
    else:
        with output_file(out, ""), atomic_write(out) as name:
            name.write_text(text, encoding="utf-8")


@app.command(cls=_Command, epilog="Example: rattlebox new-law my_law")
def new_law(
    name: Annotated[str, typer.Argument(help="Name of the law, such as my_law.")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder to write; default named after the law.")
    ] = None,
) -> None:
    """Write a package with a contact law in C++, to be changed, compiled and installed."""
    from rattlebox.cli import new_law as command

    command.new_law(name, out)


@app.command(cls=_Command)
def materials() -> None:
    """List the materials of the library with their sources."""
    from rattlebox.cli.materials import show_materials

    show_materials()


@app.command(cls=_Command)
def doctor() -> None:
    """Print versions, the instruction set of the compiled core in use, and the required and optional libraries."""
    from rattlebox.cli.doctor import print_environment

    print_environment()


def _add_commands_of_plugins() -> None:
    """Add the commands of other packages, and print which packages cannot be used."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", PluginWarning)
        present = {_name_of(each): each.callback for each in _REGISTERED}
        own = [name for name, function in present.items() if getattr(function, "__module__", "") == __name__]
        for name, function in commands_of_plugins(own).items():
            if present.get(name) is not function:
                app.command(name, cls=_Command)(function)
    for each in caught:
        if issubclass(each.category, PluginWarning):
            typer.echo(printable(f"warning: {each.message}"), err=True)


def _name_of(info: Any) -> str:
    """Return the name of an own command as it is typed."""
    return str(info.name or info.callback.__name__.replace("_", "-"))


def run_command() -> None:
    """Run the command that the arguments of this process name.

    This is the only place where errors end the program, and where all commands are kept from replacing files that they
    did not claim. Errors of the package and of the operating system are printed
    without a traceback, with exit code 2.
    """
    try:
        _add_commands_of_plugins()
        with only_watched_files():
            code = app(standalone_mode=False)
        if code == STOPPED:
            raise typer.Abort
        sys.exit(code)
    except RattleboxError as error:
        typer.echo(printable(f"error: {error}"), err=True)
        sys.exit(2)
    except OSError as error:
        file = f"{error.filename}: " if error.filename else ""
        advice = "a folder in which you may write" if isinstance(error, PermissionError) else ""
        typer.echo(printable(message(f"error: {file}{error.strerror or error}", advice)), err=True)
        sys.exit(2)
    except typer.Abort:
        typer.echo("stopped", err=True)
        sys.exit(STOPPED)
    except typer.Exit as end:
        sys.exit(end.exit_code)
    except Exception as error:  # usage errors of typer print themselves
        show = getattr(error, "show", None)
        if show is None:
            raise
        show()
        sys.exit(getattr(error, "exit_code", 2))
