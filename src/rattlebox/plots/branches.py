"""Figures of branches of periodic motions: amplitude over a parameter, stable and unstable."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from rattlebox.studies.orbits.branch import Branch
from rattlebox.studies.orbits.branch_words import special_kinds

from .style import INK, SERIES_MARKERS, StyledFigure, figure_style, label, legend_above, pen, scaled, series_colour
from .types import Size

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

_WORDS = {
    "load.frequency": "Frequency of the load",
    "load.amplitude": "Amplitude of the load",
    "damper.gap": "Gap",
    "method.restitution": "Restitution",
}
_MARKS = dict(
    zip(
        ("fold", "flip", "pitchfork", "torus", "grazing", "impact lost", "sticking", "branch point"),
        ("o", "s", "^", "D", "x", "+", "v", "*"),
        strict=True,
    )
)


def plot_branches(
    branches: Branch | xarray.Dataset | Mapping[str, Branch | xarray.Dataset],
    *,
    point: str | None = None,
    log: bool = False,
    size: Size = "column",
) -> Figure:
    """Draw the amplitude of periodic motions over a parameter: stable ones solid, unstable ones dashed.

    Parameters
    ----------
    branches
        Branch from `rattlebox.continue_orbit`, the dataset of one from `rattlebox.open_study`, or several of them by name.
    point
        Point of the structure; default the first one.
    log
        Whether the amplitude has a logarithmic scale.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with one panel; special points are marked and named.

    Raises
    ------
    ValueError
        If the branches have different parameters, or the size is unknown.
    """
    given = {"": branches} if isinstance(branches, Branch | xarray.Dataset) else dict(branches)
    named = {name: each if isinstance(each, Branch) else Branch(each) for name, each in given.items()}
    first = next(iter(named.values()))
    if any(branch.parameter != first.parameter for branch in named.values()):
        raise ValueError("all branches must have the same parameter")
    with figure_style(size):
        figure = StyledFigure(size, 0.75 if size == "column" else 0.5)
        axes = figure.subplots()
        heights = {name: _amplitude(branch, point) for name, branch in named.items()}
        scale, unit = scaled(np.concatenate(list(heights.values())), "m")
        across, across_unit = scaled(first.data.value.values, str(first.data.attrs["unit"]))
        marks: dict[str, Line2D] = {}
        for number, (name, branch) in enumerate(named.items()):
            _draw_branch(axes, branch, branch.data.value.values / across, heights[name] / scale, number, name, marks)
        if log:
            axes.set_yscale("log")
        else:
            axes.set_ylim(bottom=0)
        axes.margins(x=0.02)
        label(axes, "x", _WORDS.get(first.parameter, first.parameter), "" if across_unit == "1" else across_unit)
        label(axes, "y", "Amplitude", unit)
        for mark in marks.values():
            axes.add_line(mark)
        legend_above(axes)
    return figure


def _amplitude(branch: Branch, point: str | None) -> NDArray[np.float64]:
    """Return the amplitudes of a point of the structure, or of the balls if there is no structure."""
    data = branch.data
    if not data.sizes["place"]:
        values: NDArray[np.float64] = data.slowest_impact.values
        return values
    return np.asarray(data.amplitude.isel(place=0) if point is None else data.amplitude.sel(place=point))


def _draw_branch(
    axes: Axes,
    branch: Branch,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    number: int,
    name: str,
    marks: dict[str, Line2D],
) -> None:
    """Draw the stretches of a branch and its special points."""
    stable, colour = branch.data.stable.values.astype(bool), series_colour(number)
    # A special point is a limit of stability: the line to each side of it is as its neighbour there.
    limit = special_kinds(branch.data) != ""
    solid = (stable[:-1] | limit[:-1]) & (stable[1:] | limit[1:])
    for value, style, width in ((True, "-", 1.2), (False, "--", 0.8)):
        for stretch in np.split(np.arange(solid.size), np.flatnonzero(np.diff(solid)) + 1):
            if stretch.size and solid[stretch[0]] == value:
                part = slice(stretch[0], stretch[-1] + 2)
                axes.plot(x[part], y[part], color=colour, ls=style, lw=pen(width))
    title = name or "stable"
    axes.plot([], [], color=colour, lw=pen(1.2), label=title)
    if number == 0:
        axes.plot([], [], color=colour if not name else INK, lw=pen(0.8), ls="--", label="unstable")
    special = special_kinds(branch.data)
    for k in np.flatnonzero(special != ""):
        kind = str(special[k])
        style_of = {"marker": _MARKS.get(kind, SERIES_MARKERS[0]), "color": INK, "ls": "", "mfc": "white"}
        axes.plot(x[k : k + 1], y[k : k + 1], zorder=5, **style_of)  # type: ignore[arg-type]
        marks.setdefault(kind, Line2D([], [], label=kind, **style_of))  # type: ignore[arg-type]
