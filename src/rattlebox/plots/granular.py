"""Motion of a structure and of the particles in its cavities against time."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..results import GranularArrays, GranularRun
from .motion import MOST_SERIES, draw_structure, name_aside
from .style import (
    FAINT,
    SERIES_COLOURS,
    SERIES_STYLES,
    Scale,
    Size,
    StyledFigure,
    figure_style,
    label,
    legend_above,
    pen,
    scaled,
    time_axis,
)


def plot_granular_motion(run: GranularRun, *, size: Size = "column") -> Figure:
    """Draw the displacement of the structure, how far the particles' centre of mass has moved in each cavity, and contacts.

    Parameters
    ----------
    run
        Run to draw.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        With one panel for the structure (unless it cannot move), one for each cavity, and one for contacts.

    Raises
    ------
    ValueError
        When the size is unknown.
    """
    arrays = run.arrays
    moving = arrays.mode_frequency.size > 0
    panels = int(moving) + len(arrays.dampers) + 1
    with figure_style(size):
        figure = StyledFigure(size, 0.14 + 0.36 * panels if size == "column" else 0.1 + 0.2 * panels)
        axes = list(np.ravel(figure.subplots(panels, 1, sharex=True)))
        time = scaled(arrays.time, "s")
        left = iter(axes)
        if moving:
            draw_structure(next(left), arrays, slice(None), time, scaled(arrays.displacement, "m"))
        for d, name in enumerate(arrays.dampers):
            panel = next(left)
            _draw_centre(panel, arrays, d, time)
            if len(arrays.dampers) > 1:
                name_aside(panel, name)
        _draw_contacts(next(left), run, time)
        time_axis(axes[-1], arrays.time, time)
        figure.align_ylabels(axes)
    return figure


def _draw_centre(axes: Axes, arrays: GranularArrays, damper: int, time: Scale) -> None:
    x = arrays.centre_of_mass[:, damper] - arrays.centre_of_mass[0, damper]
    axes.axhline(0.0, color=FAINT, linewidth=pen(0.5), zorder=0)
    length = scaled(x, "m")
    for k, name in enumerate(arrays.axes):
        _line(axes, arrays, time, x[:, k] / length.divisor, k, f"along {name}")
    label(axes, "y", "Shift of particles", length.unit)
    legend_above(axes)


def _draw_contacts(axes: Axes, run: GranularRun, time: Scale) -> None:
    arrays = run.arrays
    for k, name in enumerate(arrays.dampers[:MOST_SERIES]):
        told = name if len(arrays.dampers) > 1 else None
        _line(axes, arrays, time, run.ledger.coordination[:, k], k, told)
    axes.set_ylim(bottom=0.0)
    label(axes, "y", "Contacts of a particle", "")
    legend_above(axes)


def _line(axes: Axes, arrays: GranularArrays, time: Scale, values: object, k: int, name: str | None) -> None:
    axes.plot(
        arrays.time / time.divisor,
        np.asarray(values),
        color=SERIES_COLOURS[k],
        linestyle=SERIES_STYLES[k],
        linewidth=pen(),
        label=name,
    )
