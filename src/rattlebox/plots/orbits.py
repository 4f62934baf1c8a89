"""Figures of periodic motions: one period with its multipliers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from .style import FAINT, INK, StyledFigure, figure_style, label, legend_above, pen, scaled, series_colour
from .types import Size

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from rattlebox.studies.orbits.orbit import Orbit


def plot_orbit(orbit: Orbit, *, size: Size = "page") -> Figure:
    """Draw a periodic motion over one period, and its Floquet multipliers in the complex plane.

    Parameters
    ----------
    orbit
        Periodic motion from `rattlebox.find_orbit`.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with two panels: displacements of the first point and of the balls in their cavities, with marks at impacts;
        and the multipliers with the unit circle.

    Raises
    ------
    ValueError
        If the size is unknown.
    """
    with figure_style(size):
        figure = StyledFigure(size, 0.42 if size != "column" else 1.3)
        if size == "column":
            motion, plane = figure.subplots(2, 1, height_ratios=[1.0, 1.2])
        else:
            motion, plane = figure.subplots(1, 2, width_ratios=[1.7, 1.0])
        _draw_motion(motion, orbit)
        _draw_multipliers(plane, orbit.multipliers)
    return figure


def _draw_motion(axes: Axes, orbit: Orbit) -> None:
    """Draw displacements over one period, and marks at the impacts."""
    arrays = orbit.run().arrays
    time = arrays.time / orbit.period
    lines = [(name, arrays.displacement[:, k]) for k, name in enumerate(arrays.points[:1])]
    lines += [
        (f"ball {name}" if "/" in name else name, arrays.ball_position[:, k]) for k, name in enumerate(arrays.balls)
    ]
    scale, unit = scaled(np.concatenate([values for _, values in lines]) if lines else np.zeros(1), "m")
    for number, (name, values) in enumerate(lines):
        axes.plot(time, values / scale, color=series_colour(number), label=name)
    for damper, half in enumerate(0.5 * arrays.clearance[: len(arrays.dampers) - len(arrays.stops)]):
        own = np.flatnonzero(arrays.ball_damper == damper)
        centre = (arrays.ball_position - arrays.relative_position)[:, own[0]] if own.size else np.zeros(time.size)
        for side in (-1, 1):
            axes.plot(time, (centre + side * half) / scale, color=FAINT, lw=pen(0.7), zorder=0)
    for moment in np.asarray(arrays.impacts.time) / orbit.period:
        axes.axvline(moment, color=INK, lw=pen(0.4), ls=":", zorder=0)
    axes.set_xlim(0, 1)
    label(axes, "x", "Time over the period", "")
    label(axes, "y", "Position", unit)
    legend_above(axes)


def _draw_multipliers(axes: Axes, multipliers: NDArray[np.complex128]) -> None:
    """Draw multipliers with the unit circle; those far outside are clipped to the edge and named."""
    angle = np.linspace(0, 2 * np.pi, 361)
    axes.plot(np.cos(angle), np.sin(angle), color=FAINT, lw=pen(0.9))
    axes.axhline(0, color=FAINT, lw=pen(0.4), zorder=0)
    axes.axvline(0, color=FAINT, lw=pen(0.4), zorder=0)
    reach = 1.15 * min(max(1.1, float(np.abs(multipliers).max(initial=0.0))), 4.0)
    for value in multipliers:
        inside = abs(value) < 1
        drawn = value if abs(value) <= reach else reach * value / abs(value)
        axes.plot(
            drawn.real,
            drawn.imag,
            marker="o" if abs(value) <= reach else ("<" if value.real < 0 else ">"),
            color=series_colour(0 if inside else 1),
            markerfacecolor=series_colour(0) if inside else "white",
            clip_on=False,
        )
    axes.set_xlim(-reach, reach)
    axes.set_ylim(-reach, reach)
    axes.set_aspect("equal")
    label(axes, "x", "Real part of multipliers", "")
    label(axes, "y", "Imaginary part", "")
