"""Figures of branches of periodic motions: amplitude over a parameter, stable and unstable."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from rattlebox.studies.orbits.branch_words import size_of_motion, special_kinds

from .labels import capitalised, log_ticks, name_of, unit_of
from .style import INK, SERIES_MARKERS, StyledFigure, figure_style, label, legend_above, pen, scaled, series_colour
from .types import Size

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from rattlebox.studies.orbits.branch import Branch

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
_NAMES = {"torus": "Neimark-Sacker"}
"""Names of special points in legends, where they are not the kind itself."""


def plot_branches(
    branches: Branch | xarray.Dataset | Mapping[str, Branch | xarray.Dataset],
    *,
    point: str | None = None,
    log: bool = False,
    size: Size = "column",
) -> Figure:
    """Draw the amplitude of periodic motions over a parameter: stable ones solid, unstable ones dashed.

    Without a structure that responds, the approach speed of the slowest impact is drawn.

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
    # xarray, whose datasets are mappings, and what computes branches are not imported for the figures of runs.
    from rattlebox.studies.orbits.branch import Branch

    several = isinstance(branches, Mapping) and not hasattr(branches, "data_vars")
    given: Mapping[str, Any] = cast("Mapping[str, Any]", branches) if several else {"": branches}
    named = {name: each if isinstance(each, Branch) else Branch(each) for name, each in given.items()}
    first = next(iter(named.values()))
    if any(branch.parameter != first.parameter for branch in named.values()):
        raise ValueError("all branches must have the same parameter")
    with figure_style(size):
        figure = StyledFigure(size, 0.75 if size == "column" else 0.5)
        axes = figure.subplots()
        sizes = {name: size_of_motion(branch.data, point) for name, branch in named.items()}
        heights = {name: size.values for name, size in sizes.items()}
        shown = sizes[next(iter(sizes))]
        scale, unit = scaled(np.concatenate(list(heights.values())), unit_of(shown))
        across, across_unit = scaled(first.data.value.values, str(first.data.attrs["unit"]))
        marks: dict[str, Line2D] = {}
        for number, (name, branch) in enumerate(named.items()):
            _draw_branch(axes, branch, branch.data.value.values / across, heights[name] / scale, number, name, marks)
        if log:
            axes.set_yscale("log")
            log_ticks(axes.yaxis)
        else:
            axes.set_ylim(bottom=0)
        axes.margins(x=0.02)
        path = capitalised(first.parameter.replace(".", " ").replace("_", " "))
        label(axes, "x", _WORDS.get(first.parameter, path), "" if across_unit == "1" else across_unit)
        place = f" of {shown.place.item()}" if "place" in shown.coords and first.data.sizes["place"] > 1 else ""
        label(axes, "y", capitalised(name_of(shown)) + place, unit)
        for mark in marks.values():
            axes.add_line(mark)
        legend_above(axes)
    return figure


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
        style_of = {
            "marker": _MARKS.get(kind, SERIES_MARKERS[0]),
            "color": INK,
            "ls": "",
            "mfc": "white",
            "clip_on": False,
        }
        axes.plot(x[k : k + 1], y[k : k + 1], zorder=5, **style_of)  # type: ignore[arg-type]
        marks.setdefault(kind, Line2D([], [], label=_NAMES.get(kind, kind), **style_of))  # type: ignore[arg-type]
