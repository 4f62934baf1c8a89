"""Figure of the motion of the structure, and of the balls or particles in their cavities, over time."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..results import Run, RunArrays
from ..results.figures import run_figure
from ..results.schema import AXES
from .panels import MAX_SERIES, draw_largest, draw_line, time_panels, time_window
from .style import FAINT, INK, Scale, figure_style, label, legend_above, pen, scaled, shorten, time_axis
from .types import Size, Style, Vector

MAX_NAME_LETTERS = 14
WALL_DISTANCE = 3.0  # a wall farther away than this multiple of the balls' travel is not drawn


@run_figure("motion")
def plot_motion(run: Run, *, size: Size = "column", between: tuple[float, float] | None = None) -> Figure:
    """Draw the displacement of the structure, and below it the motion in each cavity.

    For balls, the figure shows their positions and the limits at which they touch a wall. For particles, it shows the
    displacement of their centre of mass, and below it their mean number of contacts.

    Parameters
    ----------
    run
        Run to draw.
    size
        Width of the figure: "column", "page" or "slide".
    between
        First and last time to draw [s]; default the whole run.

    Returns
    -------
    Figure
        Figure with one panel for the structure (unless it cannot move), one for each damper, and one for contacts of
        particles.

    Raises
    ------
    ValueError
        If no output time lies within `between`, or the size is unknown.
    """
    arrays = run.arrays
    window = time_window(arrays, between)
    with_particles = "particles" in run.groups
    filled = [d for d in range(len(arrays.dampers)) if with_particles or np.any(arrays.ball_damper == d)]
    moving = arrays.mode_frequency.size > 0 or not filled
    panels = int(moving) + len(filled) + int(with_particles)
    with figure_style(size):
        figure, axes = time_panels(size, panels)
        time = scaled(arrays.time[window], "s")
        free_panels = iter(axes)
        if moving:
            draw_structure(next(free_panels), arrays, window, time, scaled(arrays.displacement[window], "m"))
        for d in filled:
            panel = next(free_panels)
            if with_particles:
                _draw_centre_of_mass(panel, arrays, d, window, time)
            else:
                draw_cavity(panel, arrays, d, window, time, scaled(ball_displacements(arrays, d), "m"))
            if len(arrays.dampers) > 1:
                label_panel(panel, arrays.dampers[d])
        if with_particles:
            _draw_contacts(next(free_panels), run, window, time)
        time_axis(axes[-1], arrays.time[window], time)
        figure.align_ylabels(axes)
    return figure


def _draw_centre_of_mass(axes: Axes, arrays: RunArrays, damper: int, window: slice, time: Scale) -> None:
    """Draw the displacement of the particles' centre of mass relative to the cavity since the start, along each axis."""
    x = (arrays.centre_of_mass[:, damper] - arrays.centre_of_mass[0, damper])[window]
    axes.axhline(0.0, color=FAINT, linewidth=pen(0.5), zorder=0)
    length = scaled(x, "m")
    for k, name in enumerate(AXES):
        draw_line(axes, arrays.time[window] / time.divisor, x[:, k] / length.divisor, k, f"along {name}")
    label(axes, "y", "Shift of particles", length.unit)
    legend_above(axes)


def _draw_contacts(axes: Axes, run: Run, window: slice, time: Scale) -> None:
    """Draw the mean number of contacts of a particle in each cavity."""
    arrays = run.arrays
    for k, name in enumerate(arrays.dampers[:MAX_SERIES]):
        text = name if len(arrays.dampers) > 1 else None
        draw_line(axes, arrays.time[window] / time.divisor, run.ledger.coordination[window, k], k, text)
    axes.set_ylim(bottom=0.0)
    label(axes, "y", "Contacts per particle", "")
    legend_above(axes)


def label_panel(axes: Axes, name: str) -> None:
    """Write the name of a damper to the right of its panel."""
    style: Style = {"rotation": 270, "ha": "left", "va": "center", "transform": axes.transAxes}
    axes.text(1.03, 0.5, shorten(name, MAX_NAME_LETTERS), **style)


def ball_displacements(arrays: RunArrays, damper: int) -> Vector:
    """Return displacements of the balls of a damper from the packed, centred row, and half the clearance, together [m]."""
    in_damper = arrays.ball_damper == damper
    return np.append((arrays.relative_position - arrays.ball_centre)[:, in_damper], arrays.clearance[damper] / 2)


def draw_structure(axes: Axes, arrays: RunArrays, window: slice, time: Scale, length: Scale) -> None:
    """Draw the displacement of the points of the structure that move; of many points, those that move most."""
    displacement = arrays.displacement[window] / length.divisor
    draw_largest(axes, arrays.time[window] / time.divisor, displacement, arrays.points)
    label(axes, "y", "Displacement", length.unit)


def draw_cavity(axes: Axes, arrays: RunArrays, damper: int, window: slice, time: Scale, length: Scale) -> None:
    """Draw the displacements of the balls of one damper from the packed, centred row, and walls that are not far away."""
    balls = np.flatnonzero(arrays.ball_damper == damper)
    half = arrays.clearance[damper] / 2
    x = (arrays.relative_position - arrays.ball_centre)[window][:, balls]
    low, high = float(x.min()), float(x.max())
    travel = WALL_DISTANCE * (high - low) or 2 * half
    for wall in (wall for wall in (-half, half) if low - travel <= wall <= high + travel):
        axes.axhline(wall / length.divisor, color=INK, linewidth=pen(0.5), zorder=3)
    for k in range(min(len(balls), MAX_SERIES)):
        name = f"ball {k + 1}" if len(balls) > 1 else None
        position = x[:, k] / length.divisor
        draw_line(axes, arrays.time[window] / time.divisor, position, k, name, colour=(k + 1) % MAX_SERIES)
    axes.margins(y=0.12)
    label(axes, "y", "Position in cavity", length.unit)
    legend_above(axes)
