"""`rattlebox plot`: a figure of a study on disk."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING

from rattlebox._util.exceptions import CaseError, DataError
from rattlebox._util.plugins import named_object
from rattlebox.cli.output import output_file
from rattlebox.cli.terminal import terminal
from rattlebox.model.errors import nearest
from rattlebox.plots.maps import plot_map
from rattlebox.plots.selection import nearest_value_notes, select
from rattlebox.plots.style import WIDTHS
from rattlebox.studies.kinds import study_kind, study_kinds
from rattlebox.studies.run.stored import open_study

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

FORMATS = (".png", ".svg", ".pdf")


@dataclass(frozen=True)
class PlotOptions:
    """Options of `rattlebox plot` as they were typed, None for those that were not."""

    kind: str | None = None
    of: str | None = None
    at: tuple[str, ...] = ()
    number: int | None = None
    size: str | None = None
    colour: str | None = None
    view: str | None = None
    pixels: str | None = None


def plot_study(study: Path, out: Path | None, options: PlotOptions) -> None:
    """Draw a study and write the figure."""
    refuse_particle_options(colour=options.colour, view=options.view, pixels=options.pixels)
    check_output(out, options.size)
    number, kind = options.number, options.kind
    with output_file(out, "study.png") as (file, note):
        if number is not None:
            raise CaseError(
                f"--number {number}: {study} is a study, which has no snapshots", "leave out --number, or plot a run"
            )
        data, at = open_study(study), _axis_values(options.at)
        chosen = {name: value for name, value in {"of": options.of, "size": options.size}.items() if value is not None}
        own, figures = str(data.attrs.get("study", "sweep")), _figures()
        if (kind or own) in figures:
            figure = _draw_kind(data, kind or own, own, chosen, at)
        elif kind in (None, "map", "lines"):
            figure = plot_map(data, kind=kind, at=at, **chosen)  # type: ignore[arg-type]
        else:
            raise CaseError(f"--kind {kind}: unknown kind of figure", nearest(kind, ("map", "lines", *figures)))
        figure.savefig(file)
        for line in nearest_value_notes(data, at):
            terminal().print(line, soft_wrap=True)
        terminal().print(f"written: {file}{note}", soft_wrap=True)


def refuse_particle_options(**options: str | None) -> None:
    """Raise if an option is given that applies to pictures of particles only."""
    for name, value in options.items():
        if value is not None:
            raise CaseError(
                f"--{name} {value}: this option is for pictures of particles",
                "the folder of a run with particles, --kind particles",
            )


def check_output(out: Path | None, size: str | None, formats: Sequence[str] = FORMATS) -> None:
    """Raise if a figure cannot be written to a file."""
    if out is not None and out.suffix not in formats:
        raise CaseError(f"-o {out}: the suffix must be one of {', '.join(formats)}", f"-o {out.stem or 'study'}.png")
    if size is not None and size not in WIDTHS:
        raise CaseError(f"--size {size}: unknown size", ", ".join(WIDTHS))
    if out is not None and not out.parent.is_dir():
        raise DataError(f"-o {out}: the folder {out.parent} does not exist", "another folder, or create it first")


def _figures() -> dict[str, str]:
    """Return the references of the figures of the kinds of studies that have one of their own."""
    return {name: figure for name in study_kinds() if (figure := study_kind(name).figure)}


def _draw_kind(data: xr.Dataset, kind: str, own: str, options: dict[str, str], at: dict[str, str]) -> Figure:
    """Draw the figure that belongs to a kind of study."""
    figures = _figures()
    if kind != own:
        other = own if own in figures else "lines"
        raise CaseError(
            f"--kind {kind}: this study is a {own.replace('_', ' ')}, or is not finished",
            f"--kind {other}, or 'rattlebox show' to see its progress",
        )
    draw: Callable[..., Figure] = named_object(figures[kind], f"the kind of study {kind!r}")
    if "of" in options and "of" not in signature(draw).parameters:
        raise CaseError(f"--of {options['of']}: a figure of the kind {kind} has no choice of measures", "--kind lines")
    return draw(select(data, at)[0], **options)


def _axis_values(at: Sequence[str]) -> dict[str, str]:
    values = {}
    for text in at:
        name, sign, value = text.partition("=")
        if not sign or not name.strip() or not value.strip():
            raise CaseError(f'--at "{text}": an axis and a value are needed', '--at "load.amplitude=5 kN"')
        values[name.strip()] = value.strip()
    return values
