"""Motion of the structure and of the balls in their cavities against time."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..results import Run, RunArrays
from ..results.figures import run_figure
from ..results.schema import AXES
from ..results.summary import largest_points
from .style import (
    FAINT,
    INK,
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
    shorten,
    time_axis,
)

MOST_SERIES = len(SERIES_COLOURS)
LETTERS_ASIDE = 14
FAR = 3.0  # a wall at this many times the balls' travel is out of sight


@run_figure("motion")
def plot_motion(run: Run, *, size: Size = "column", between: tuple[float, float] | None = None) -> Figure:
    """Draw the displacement of the structure, and below it the motion in each cavity.

    Of balls, their positions are drawn, and their range is marked: a ball touches a wall or its neighbour when it reaches
    the edge of its band. Of particles, the shift of their centre of mass is drawn, and below it their mean number of
    contacts.

    Parameters
    ----------
    run
        Run to draw.
    size
        Width of the figure: "column", "page" or "slide".
    between
        First and last time to show [s]; the whole run when left out.

    Returns
    -------
    Figure
        With one panel for the structure (unless it cannot move), one for each damper, and one for contacts of particles.

    Raises
    ------
    ValueError
        When no output time lies between the given ones, or the size is unknown.
    """
    arrays = run.arrays
    shown = _window(arrays, between)
    with_particles = "particles" in run.groups
    filled = [d for d in range(len(arrays.dampers)) if with_particles or np.any(arrays.ball_damper == d)]
    moving = arrays.mode_frequency.size > 0 or not filled
    panels = int(moving) + len(filled) + int(with_particles)
    with figure_style(size):
        figure = StyledFigure(size, 0.14 + 0.36 * panels if size == "column" else 0.1 + 0.2 * panels)
        axes = list(np.ravel(figure.subplots(panels, 1, sharex=True)))
        time = scaled(arrays.time[shown], "s")
        left = iter(axes)
        if moving:
            draw_structure(next(left), arrays, shown, time, scaled(arrays.displacement[shown], "m"))
        for d in filled:
            panel = next(left)
            if with_particles:
                _draw_centre_of_mass(panel, arrays, d, shown, time)
            else:
                draw_cavity(panel, arrays, d, shown, time, scaled(row_places(arrays, d), "m"))
            if len(arrays.dampers) > 1:
                name_aside(panel, arrays.dampers[d])
        if with_particles:
            _draw_contacts(next(left), run, shown, time)
        time_axis(axes[-1], arrays.time[shown], time)
        figure.align_ylabels(axes)
    return figure


def _draw_centre_of_mass(axes: Axes, arrays: RunArrays, damper: int, shown: slice, time: Scale) -> None:
    """Draw the shift of the particles' centre of mass in a cavity since the start, along each axis."""
    x = (arrays.centre_of_mass[:, damper] - arrays.centre_of_mass[0, damper])[shown]
    axes.axhline(0.0, color=FAINT, linewidth=pen(0.5), zorder=0)
    length = scaled(x, "m")
    for k, name in enumerate(AXES):
        _line(axes, arrays.time[shown] / time.divisor, x[:, k] / length.divisor, k, f"along {name}")
    label(axes, "y", "Shift of particles", length.unit)
    legend_above(axes)


def _draw_contacts(axes: Axes, run: Run, shown: slice, time: Scale) -> None:
    """Draw the mean number of contacts of a particle in each cavity."""
    arrays = run.arrays
    for k, name in enumerate(arrays.dampers[:MOST_SERIES]):
        told = name if len(arrays.dampers) > 1 else None
        _line(axes, arrays.time[shown] / time.divisor, run.ledger.coordination[shown, k], k, told)
    axes.set_ylim(bottom=0.0)
    label(axes, "y", "Contacts of a particle", "")
    legend_above(axes)


def _line(axes: Axes, x: Any, y: Any, series: int, name: str | None) -> None:
    style = {"color": SERIES_COLOURS[series], "linestyle": SERIES_STYLES[series], "linewidth": pen()}
    axes.plot(x, y, label=name, **style)


def _window(arrays: RunArrays, between: tuple[float, float] | None) -> slice:
    if between is None:
        return slice(0, arrays.time.size)
    first, last = np.searchsorted(arrays.time, between[0]), np.searchsorted(arrays.time, between[1], "right")
    if first >= last:
        raise ValueError(f"no output time lies between {between[0]} s and {between[1]} s")
    return slice(int(first), int(last))


def name_aside(axes: Axes, name: str) -> None:
    """Write the name of a damper beside its panel.

    Parameters
    ----------
    axes
        Panel.
    name
        Of the damper.
    """
    aside: dict[str, Any] = {"rotation": 270, "ha": "left", "va": "center", "transform": axes.transAxes}
    axes.text(1.03, 0.5, shorten(name, LETTERS_ASIDE), **aside)


def row_places(arrays: RunArrays, damper: int) -> Any:
    """Departures of the balls of one damper from the packed, centred row, and the range of both sides [m].

    Parameters
    ----------
    arrays
        Arrays of the run.
    damper
        Damper, counted from 0.
    """
    own = arrays.ball_damper == damper
    return np.append((arrays.relative_position - arrays.ball_centre)[:, own], arrays.clearance[damper] / 2)


def draw_structure(axes: Axes, arrays: RunArrays, shown: slice, time: Scale, length: Scale) -> None:
    """Draw the displacement of the structure's points that move, of many those that move most.

    Parameters
    ----------
    axes
        Axes to fill.
    arrays
        Arrays of the run.
    shown
        Output times to show.
    time, length
        Scales of the axes.
    """
    x = arrays.displacement[shown]
    axes.axhline(0.0, color=FAINT, linewidth=pen(0.5), zorder=0)
    for k, point in enumerate(largest_points(np.abs(x).max(axis=0), MOST_SERIES)):
        axes.plot(
            arrays.time[shown] / time.divisor,
            x[:, point] / length.divisor,
            color=SERIES_COLOURS[k],
            linestyle=SERIES_STYLES[k],
            label=arrays.points[point] if len(arrays.points) > 1 else None,
        )
    label(axes, "y", "Displacement", length.unit)
    legend_above(axes)


def draw_cavity(axes: Axes, arrays: RunArrays, damper: int, shown: slice, time: Scale, length: Scale) -> None:
    """Draw the place of the balls of one damper in its cavity, as departures from the packed, centred row.

    A wall that the balls stay far away from is left out.

    Parameters
    ----------
    axes
        Axes to fill.
    arrays
        Arrays of the run.
    damper
        Damper, counted from 0.
    shown
        Output times to show.
    time, length
        Scales of the axes.
    """
    own = np.flatnonzero(arrays.ball_damper == damper)
    half = arrays.clearance[damper] / 2
    x = (arrays.relative_position - arrays.ball_centre)[shown][:, own]
    low, high = float(x.min()), float(x.max())
    travel = FAR * (high - low) or 2 * half
    for wall in (wall for wall in (-half, half) if low - travel <= wall <= high + travel):
        axes.axhline(wall / length.divisor, color=INK, linewidth=pen(0.5), zorder=3)
    for k in range(min(len(own), MOST_SERIES)):
        axes.plot(
            arrays.time[shown] / time.divisor,
            x[:, k] / length.divisor,
            color=SERIES_COLOURS[(k + 1) % MOST_SERIES],
            linestyle=SERIES_STYLES[k],
            linewidth=pen(),
            label=f"ball {k + 1}" if len(own) > 1 else None,
        )
    axes.margins(y=0.12)
    label(axes, "y", "Place in cavity", length.unit)
    legend_above(axes)
