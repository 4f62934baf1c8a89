"""`rattlebox plot`: a figure of a study on disk."""

from __future__ import annotations

from collections.abc import Sequence
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rattlebox._util.exceptions import CaseError, DataError
from rattlebox.cli.output import output_file
from rattlebox.cli.terminal import terminal
from rattlebox.model.errors import nearest
from rattlebox.plots.maps import plot_map
from rattlebox.plots.selection import nearest_value_notes, select
from rattlebox.plots.style import WIDTHS
from rattlebox.results.figures import figures_of_studies
from rattlebox.studies.run.stored import open_study

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

FORMATS = (".png", ".svg", ".pdf")


def plot_study(
    study: Path,
    out: Path | None,
    *,
    kind: str | None,
    of: str | None,
    at: Sequence[str],
    number: int | None,
    size: str | None,
) -> None:
    """Draw a study and write the figure."""
    check_output(out, size)
    with output_file(out, "study.png") as (file, note):
        if number is not None:
            raise CaseError(
                f"--number {number}: {study} is a study, which has no snapshots", "leave out --number, or plot a run"
            )
        data, options, values = open_study(study), {"of": of, "size": size}, _axis_values(at)
        own = str(data.attrs.get("study", "sweep"))
        options = {name: value for name, value in options.items() if value is not None}
        if (kind or own) in figures_of_studies():
            figure = _draw_kind(data, kind or own, own, options, values)
        elif kind in (None, "map", "lines"):
            figure = plot_map(data, kind=kind, at=values, **options)  # type: ignore[arg-type]
        else:
            raise CaseError(
                f"--kind {kind}: unknown kind of figure\n  {nearest(kind, ('map', 'lines', *figures_of_studies()))}"
            )
        figure.savefig(file)
        for line in nearest_value_notes(data, values):
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


def _draw_kind(data: xr.Dataset, kind: str, own: str, options: dict[str, Any], at: dict[str, str]) -> Figure:
    """Draw the figure that belongs to a kind of study."""
    if kind != own:
        other = own if own in figures_of_studies() else "lines"
        raise CaseError(
            f"--kind {kind}: this study is a {own.replace('_', ' ')}, or is not finished",
            f"--kind {other}, or 'rattlebox show' to see its progress",
        )
    draw = figures_of_studies()[kind]
    if "of" in options and "of" not in signature(draw).parameters:
        raise CaseError(f"--of {options['of']}: a figure of the kind {kind} has no choice of measures", "--kind lines")
    figure: Figure = draw(select(data, at)[0], **options)
    return figure


def _axis_values(at: Sequence[str]) -> dict[str, str]:
    values = {}
    for text in at:
        name, sign, value = text.partition("=")
        if not sign or not name.strip() or not value.strip():
            raise CaseError(f'--at "{text}": an axis and a value are needed', '--at "load.amplitude=5 kN"')
        values[name.strip()] = value.strip()
    return values
