"""Phase portraits: velocity against position."""

from __future__ import annotations

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from ..analysis import phase_portrait
from ..results import Run
from ..results.figures import run_figure
from .style import FAINT, INK, StyledFigure, colour_bar, figure_style, label, map_colours, pen, scaled
from .types import Size


@run_figure("phase_portrait")
def plot_phase_portrait(run: Run, of: str | None = None, *, size: Size = "column") -> Figure:
    """Draw velocity against position of a ball relative to its cavity, or of a point of the structure.

    The line turns from dark to light with time. For a ball, the walls that limit its range are drawn (a ball in a row
    reaches them through its packed neighbours), and its position is relative to the packed, centred row.

    Parameters
    ----------
    run
        Run to draw.
    of
        Name of a ball or of a point; default the first ball, or the first point if there are no balls.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with one panel and a colour bar for time.

    Raises
    ------
    ValueError
        If no ball or point has that name, or the size is unknown.
    """
    arrays, portrait = run.arrays, phase_portrait(run, of)
    x, v = portrait.position.values, portrait.velocity.values
    half, texts = None, ("Displacement", "Velocity")
    if portrait.of in arrays.balls:
        half = float(arrays.clearance[arrays.ball_damper[arrays.balls.index(portrait.of)]]) / 2
        texts = "Position in cavity", "Relative velocity"
    x_scale, x_unit = scaled(x if half is None else np.append(x, half), "m")
    v_scale, v_unit = scaled(v, "m/s")
    t_scale, t_unit = scaled(arrays.time, "s")
    with figure_style(size):
        figure = StyledFigure(size, 0.8 if size == "column" else 0.6)
        axes = figure.subplots()
        points = np.column_stack((x / x_scale, v / v_scale))
        line = LineCollection(
            list(np.stack((points[:-1], points[1:]), axis=1)),
            array=arrays.time[:-1] / t_scale,
            cmap=_colours(),
            linewidths=pen(0.5),
            rasterized=True,
        )
        axes.add_collection(line)
        reach = max(float(np.max(np.abs(points[:, 0]))), (half or 0.0) / x_scale) or 1.0
        speed = float(np.max(np.abs(points[:, 1]))) or 1.0
        axes.set_xlim(-1.12 * reach, 1.12 * reach)
        axes.set_ylim(-1.08 * speed, 1.08 * speed)
        if half is not None:
            wall = half / x_scale
            for side in (-1, 1):
                axes.axvspan(side * wall, side * 2 * reach, facecolor=FAINT, alpha=0.45, linewidth=0, zorder=0)
                axes.axvline(side * wall, color=INK, linewidth=pen(0.7))
        label(axes, "x", texts[0], x_unit)
        label(axes, "y", texts[1], v_unit)
        colour_bar(figure, line, axes, f"Time ({t_unit})", aspect=30)
    return figure


def _colours() -> LinearSegmentedColormap:
    """Return the dark three quarters of the map colours; the pale end would not be visible on paper."""
    return LinearSegmentedColormap.from_list("batlow_dark", map_colours()(np.linspace(0.0, 0.78, 256)))
