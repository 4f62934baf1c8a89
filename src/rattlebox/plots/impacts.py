"""Figure of the impact log: approach speed, peak force and restitution over time."""

from __future__ import annotations

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from ..results import Run, RunArrays
from ..results.figures import run_figure
from .style import (
    FAINT,
    INK,
    StyledFigure,
    figure_style,
    label,
    letters,
    pen,
    scaled,
    series_colour,
    shorten,
    time_axis,
)
from .types import Size, Style, Vector

_SIDES: dict[str, Style] = {
    "trailing wall": {"marker": "o", "color": "colour", "linewidths": 0.0},
    "leading wall": {"marker": "o", "facecolors": "none", "edgecolors": "colour", "linewidths": 0.6},
    "between balls": {"marker": "x", "color": "colour", "linewidths": 0.6},
    "stop": {"marker": "D", "color": "colour", "linewidths": 0.0},
}


@run_figure("impacts", needs="impacts")
def plot_impacts(run: Run, *, size: Size = "column", log: bool = False) -> Figure:
    """Draw approach speed, peak force and restitution of every impact over the time at which its contact begins.

    Filled circles are impacts on the trailing wall, open ones on the leading wall, crosses impacts between balls, and
    diamonds impacts at stops; each damper and stop has its colour. Quantities without values (force of hard impacts,
    restitution of hysteretic laws) are omitted.

    Parameters
    ----------
    run
        Run to draw.
    size
        Width of the figure: "column", "page" or "slide".
    log
        Whether to use logarithmic axes for speed and force.

    Returns
    -------
    Figure
        Figure with one panel per quantity, or a note if there was no impact.

    Raises
    ------
    ValueError
        If the size is unknown.
    """
    impacts = run.arrays.impacts
    quantities = (
        ("Approach speed", "m/s", impacts.approach_speed),
        ("Peak force", "N", impacts.peak_force),
        ("Coefficient of restitution", "", impacts.restitution),
    )
    panels = [quantity for quantity in quantities if np.any(np.isfinite(quantity[2]))] or [quantities[0]]
    time = scaled(run.arrays.time, "s")
    with figure_style(size):
        margin, panel_height = (0.2, 0.34) if size == "column" else (0.1, 0.18)
        figure = StyledFigure(size, margin + panel_height * len(panels))
        axes = list(np.ravel(figure.subplots(len(panels), 1, sharex=True)))
        for panel, (name, unit, values) in zip(axes, panels, strict=True):
            scale, prefixed = scaled(values, unit) if unit else (1.0, "")
            _scatter(panel, run.arrays, impacts.time / time.divisor, values / scale)
            label(panel, "y", name, prefixed)
            if log and unit and len(impacts):
                panel.set_yscale("log")
            elif unit:
                panel.set_ylim(bottom=0.0)
            else:
                _limit_restitution(panel, values)
                panel.yaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
        if not len(impacts):
            axes[0].text(0.5, 0.5, "no impacts", transform=axes[0].transAxes, ha="center", va="center")
            axes[0].set_yticks([])
        time_axis(axes[-1], run.arrays.time, time)
        _add_legend(figure, run.arrays)
        figure.align_ylabels(axes)
    return figure


def _limit_restitution(axes: Axes, values: Vector) -> None:
    """Limit the axis to the range of the values, at least 0.1, so that a constant appears as a flat line."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    span = max(high - low, 0.1)
    middle = (low + high) / 2
    top = min(middle + 0.6 * span, 1.0 + 0.05 * span)
    axes.set_ylim(max(top - 1.2 * span, -0.05 * span), top)
    if top >= 1.0:
        axes.axhline(1.0, color=FAINT, linewidth=pen(0.5), zorder=0)


def _scatter(axes: Axes, arrays: RunArrays, x: Vector, y: Vector) -> None:
    """Draw each impact with the colour of its damper and the marker of the side of the contact."""
    log = arrays.impacts
    area = (9.0 if len(log) < 300 else 3.0) * pen(1.0) ** 2
    for d in range(len(arrays.dampers)):
        for side, marks in _SIDES.items():
            here = (log.damper == d) & (_sides(arrays) == side)
            axes.scatter(x[here], y[here], s=area, **_marker_style(marks, series_colour(d)))
    axes.margins(x=0.02, y=0.08)


def _sides(arrays: RunArrays) -> NDArray[np.str_]:
    """Return the name of the side of each impact."""
    last = np.bincount(arrays.ball_damper, minlength=len(arrays.dampers))[arrays.impacts.damper]
    contact = arrays.impacts.contact
    sides = ["stop", "trailing wall", "leading wall"]
    return np.select([last == 0, contact == 0, contact == last], sides, "between balls")


def _marker_style(marks: Style, colour: str) -> Style:
    """Return the options of a scatter in a colour, with edges in proportion to the font size."""
    style = {name: colour if value == "colour" else value for name, value in marks.items()}
    return style | {"linewidths": pen(marks["linewidths"])}


def _add_legend(figure: Figure, arrays: RunArrays) -> None:
    """Add a legend of the markers that occur, and in a second row of the colours if there are several dampers."""
    present = set(_sides(arrays).tolist())
    size = float(rcParams["lines.markersize"])
    sides = [
        Line2D([], [], linestyle="", markersize=size, marker=marks["marker"], color=INK, label=side,
               markerfacecolor="none" if marks.get("facecolors") == "none" else INK)
        for side, marks in _SIDES.items()
        if side in present
    ]  # fmt: skip
    room = letters(figure.axes[0]) // 3
    dampers = [
        Line2D([], [], linestyle="", markersize=1.6 * size, marker="s", label=shorten(name, room),
               color=series_colour(d))
        for d, name in enumerate(arrays.dampers)
    ]  # fmt: skip
    if not sides:
        return
    columns = 3
    entries = _padded(sides, columns)
    if len(dampers) > 1:
        entries += _padded(dampers, columns)
    # Legends fill column by column.
    by_column = [entry for k in range(columns) for entry in entries[k::columns]]
    figure.legend(handles=by_column, loc="outside upper left", ncols=columns, handletextpad=0.2, handlelength=1.0)


def _padded(entries: list[Line2D], columns: int) -> list[Line2D]:
    """Return entries with blank ones appended, so that they fill whole rows of the legend."""
    blank = [Line2D([], [], linestyle="", label=" ") for _ in range(-len(entries) % columns)]
    return entries + blank
