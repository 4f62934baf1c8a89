"""`rattlebox plot`: a figure of a study on disk."""

from __future__ import annotations

from collections.abc import Sequence
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

import rattlebox
from rattlebox._util.exceptions import CaseError, DataError
from rattlebox.cli.terminal import terminal
from rattlebox.model.errors import nearest
from rattlebox.plots.maps import plot_map, select, taken_instead
from rattlebox.plots.style import WIDTHS
from rattlebox.studies.kinds import KINDS
from rattlebox.studies.stored import open_study

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

FORMATS = (".png", ".svg", ".pdf")
MAPS = tuple(kind for kind in KINDS if kind != "sweep")


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
    """Draw a study and write the figure.

    Parameters
    ----------
    study
        Folder of the study.
    out
        File to write, as PNG, SVG or PDF; default study.png in the current folder.
    kind
        "map" or "lines" of one measure, or the name of a ready map; default that of the study.
    of
        What to draw, where there is a choice.
    at
        Texts "axis=value".
    number
        Of a snapshot, which a study has none of.
    size
        Width; default that of the figure.

    Raises
    ------
    CaseError
        When an argument does not fit, or there is no such study.
    """
    out, told = target(out, "study.png", size)
    if number is not None:
        raise CaseError(f"--number {number}: this applies to snapshots of a run, run.vtkhdf\n  try: leave it out")
    data, options, chosen = open_study(study), {"of": of, "size": size}, _values(at)
    own = str(data.attrs.get("study", "sweep"))
    options = {name: value for name, value in options.items() if value is not None}
    if (kind or own) in MAPS:
        figure = _map(data, kind or own, own, options, chosen)
    elif kind in (None, "map", "lines"):
        figure = plot_map(data, kind=kind, at=chosen, **options)  # type: ignore[arg-type]
    else:
        raise CaseError(f"--kind {kind}: there is no such kind\n  {nearest(kind, ('map', 'lines', *MAPS))}")
    figure.savefig(out)
    for line in taken_instead(data, chosen):
        terminal().print(line, soft_wrap=True)
    terminal().print(told, soft_wrap=True)


def refuse_particle_options(**options: str | None) -> None:
    """Raise if an option is given that applies to pictures of particles only.

    Parameters
    ----------
    **options
        Values by name of the option.

    Raises
    ------
    CaseError
        With the first option that is given.
    """
    for name, value in options.items():
        if value is not None:
            raise CaseError(
                f"--{name} {value}: this applies to pictures of particles",
                "the folder of a run with particles, --kind particles",
            )


def target(out: Path | None, usual: str, size: str | None, formats: Sequence[str] = FORMATS) -> tuple[Path, str]:
    """Return the file to write, and what is said when it is written; refuse what cannot be.

    Parameters
    ----------
    out
        File to write.
    usual
        Its name in the current folder when none is given.
    size
        Width, if one is asked for.
    formats
        Endings that are possible.

    Raises
    ------
    CaseError
        When the ending or the size is not one of those that are possible.
    DataError
        When its folder does not exist.
    """
    over = out is None and Path(usual).exists()
    out = out or Path(usual)
    told = f"written: {out}" + ", in the place of an earlier one; -o names another file" * over
    if out.suffix not in formats:
        raise CaseError(
            f"-o {out}: the ending must be one of {', '.join(formats)}\n  try: -o {out.stem or 'study'}.png"
        )
    if size is not None and size not in WIDTHS:
        raise CaseError(f"--size {size}: there is no such size\n  try: {', '.join(WIDTHS)}")
    if not out.parent.is_dir():
        raise DataError(f"-o {out}: there is no folder {out.parent}", "another folder, or make it first")
    return out, told


def _map(data: xr.Dataset, kind: str, own: str, options: dict[str, Any], at: dict[str, str]) -> Figure:
    """The figure of a ready map."""
    if kind != own:
        raise CaseError(
            f"--kind {kind}: there is none in this study, which holds a {own.replace('_', ' ')}, or is not finished\n"
            f"  try: {f'--kind {own}' if own in MAPS else '--kind lines'}, or 'rattlebox show' to see how far it is"
        )
    draw = getattr(rattlebox, f"plot_{kind}")
    if "of" in options and "of" not in signature(draw).parameters:
        raise CaseError(f"--of {options['of']}: a figure of {kind} shows all that there is\n  try: --kind lines")
    figure: Figure = draw(select(data, at)[0], **options)
    return figure


def _values(at: Sequence[str]) -> dict[str, str]:
    values = {}
    for text in at:
        name, sign, value = text.partition("=")
        if not sign or not name.strip() or not value.strip():
            raise CaseError(f'--at "{text}": an axis and a value are needed\n  try: --at "load.amplitude=5 kN"')
        values[name.strip()] = value.strip()
    return values
