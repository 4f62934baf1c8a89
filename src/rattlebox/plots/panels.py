"""Panels over a common time axis, and the lines that they show."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from rattlebox._util.exceptions import CaseError

from ..results import RunArrays
from ..results.summary import largest_points
from .style import FAINT, SERIES_COLOURS, SERIES_STYLES, StyledFigure, legend_above, pen
from .types import Size, Style, Vector

MAX_SERIES = len(SERIES_COLOURS)


def time_panels(size: Size, count: int) -> tuple[StyledFigure, list[Axes]]:
    """Return a figure with panels below each other that share their time axis."""
    figure = StyledFigure(size, 0.14 + 0.36 * count if size == "column" else 0.1 + 0.2 * count)
    return figure, list(np.ravel(figure.subplots(count, 1, sharex=True)))


def time_window(arrays: RunArrays, between: tuple[float, float] | None) -> slice:
    """Return the output times between a first and a last time [s]; all if `between` is None."""
    if between is None:
        return slice(0, arrays.time.size)
    first, last = np.searchsorted(arrays.time, between[0]), np.searchsorted(arrays.time, between[1], "right")
    if first >= last:
        raise CaseError(
            f"between = {between}: the run has no output time in this interval",
            f"times from {arrays.time[0]:g} s to {arrays.time[-1]:g} s",
        )
    return slice(int(first), int(last))


def draw_line(axes: Axes, x: Vector, y: Vector, series: int, name: str | None, *, colour: int | None = None) -> None:
    """Draw one of several lines, (n,) in the units of the axes, in the colour and dashes of its number."""
    axes.plot(
        x,
        y,
        color=SERIES_COLOURS[series if colour is None else colour],
        linestyle=SERIES_STYLES[series],
        linewidth=pen(),
        label=name,
    )


def draw_largest(axes: Axes, x: Vector, y: Vector, names: Sequence[str]) -> None:
    """Draw lines about zero, y (n, lines) over x (n,): of many those with the largest values, with a legend of several."""
    axes.axhline(0.0, color=FAINT, linewidth=pen(0.5), zorder=0)
    peaks = np.abs(y).max(axis=0)
    moving = len(largest_points(peaks, len(names)))
    for k, line in enumerate(largest_points(peaks, MAX_SERIES)):
        draw_line(axes, x, y[:, line], k, names[line] if len(names) > 1 else None)
    # The choice is stated: of ten storeys, the reader must not take six for all.
    choice: Style = {"title": f"the largest {MAX_SERIES} of {moving}", "alignment": "left"}
    legend_above(axes, **(choice if moving > MAX_SERIES else {}))
