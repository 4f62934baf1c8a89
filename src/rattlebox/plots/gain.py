"""Figure of what a ball in a cavity gains: the ball at work, the motion with and without it, and where the energy goes."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from ..results import Run
from .style import CHANNEL_COLOURS, FAINT, INK, StyledFigure, figure_style, label, pen, scaled, time_axis
from .types import Style

MOMENTS = 8
"""Number of pictures of the ball in its cavity."""
_GREY = "#6b6b6b"
_BALL, _WALL, _HEIGHT = 0.18, 0.12, 0.36
"""Radius of the ball, thickness of the walls and half of the height of the structure, over the width of a picture."""
_MOTION, _DISTANCE = 0.16, 1.3
"""Largest displacement, and distance between pictures, over the width of a picture."""


def plot_gain(bare: Run, damped: Run, title: str, subtitle: str, *, until: float) -> Figure:
    """Draw a struck structure with one degree of freedom, without a damper and with a ball, until a time [s]."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.64)
        strip, motion, energy = figure.subplots(3, height_ratios=(1, 2.6, 1.7))
        strip.set_title(title, fontweight="bold", fontsize=pen(9), pad=pen(16))
        strip.text(0.0, 1.02, subtitle, transform=strip.transAxes, color=_GREY, fontsize="small", va="bottom")
        _draw_moments(strip, damped)
        _draw_motion(motion, bare, damped, until)
        _draw_energy(energy, damped, until)
        figure.align_ylabels([motion, energy])
    return figure


def _draw_moments(axes: Axes, run: Run) -> None:
    """Draw the structure with its cavity and ball at moments of the first oscillation."""
    arrays = run.arrays
    displacement, ball, time = arrays.displacement[:, 0], arrays.relative_position[:, 0], arrays.time
    period = 1 / float(arrays.mode_frequency[0])
    scale = _MOTION / float(np.abs(displacement).max())
    room = _BALL + scale * 0.5 * run.case.impact_dampers[0].clearance
    axes.set_axis_off()
    axes.set_xlim(-0.5 * _DISTANCE, (MOMENTS - 0.5) * _DISTANCE)
    axes.set_ylim(-0.62, 0.5)
    axes.set_aspect("equal", anchor="W")
    thin: Style = {"edgecolor": CHANNEL_COLOURS["viscous"], "linewidth": pen(0.8)}
    ball_style: Style = {"facecolor": CHANNEL_COLOURS["normal"], "edgecolor": INK, "linewidth": pen(0.6)}
    for k, moment in enumerate(np.linspace(0.01, 1.0, MOMENTS) * period):
        x, b = (float(np.interp(moment, time, values)) for values in (displacement, ball))
        rest = k * _DISTANCE
        middle = rest + scale * x
        axes.plot([rest, rest], [-0.46, 0.46], color=FAINT, linewidth=pen(0.5), linestyle=":", zorder=0)
        outer = room + _WALL
        axes.add_patch(Rectangle((middle - outer, -_HEIGHT), 2 * outer, 2 * _HEIGHT, facecolor="#e3ecf3", **thin))
        inner = _HEIGHT - _WALL
        axes.add_patch(Rectangle((middle - room, -inner), 2 * room, 2 * inner, facecolor="white", **thin))
        axes.add_patch(Circle((middle + scale * b, 0), _BALL, **ball_style))
        axes.text(rest, -0.6, f"{1e3 * moment:.0f} ms", color=_GREY, fontsize="small", ha="center", va="center")


def _draw_motion(axes: Axes, bare: Run, damped: Run, until: float) -> None:
    """Draw the displacement of both runs."""
    length = scaled(bare.arrays.displacement, "m")
    for run, colour, width, name in (
        (bare, FAINT, 0.8, "without damper"),
        (damped, CHANNEL_COLOURS["viscous"], 1.3, ""),
    ):
        shown = run.arrays.time <= until
        values = run.arrays.displacement[shown, 0] / length.divisor
        axes.plot(run.arrays.time[shown], values, color=colour, linewidth=pen(width), label=name or "with the ball")
    peak = float(np.abs(bare.arrays.displacement).max()) / length.divisor
    axes.text(0.74 * until, 0.52 * peak, "without damper", color=_GREY)
    axes.text(0.46 * until, 0.2 * peak, "with the ball", color=CHANNEL_COLOURS["viscous"], fontweight="bold")
    axes.set_xlim(0, until)
    axes.tick_params(labelbottom=False)
    label(axes, "y", "Displacement", length.unit)


def _draw_energy(axes: Axes, run: Run, until: float) -> None:
    """Draw the energy that each part has lost, with words on the areas."""
    ledger, time = run.ledger, scaled(np.array([0.0, until]), "s")
    energy = scaled(ledger.supplied, "J")
    shown = run.arrays.time <= until
    parts = {name: ledger.channels[name][shown] / energy.divisor for name in ("viscous", "normal", "motion")}
    colours = [CHANNEL_COLOURS[name] for name in parts]
    axes.stackplot(run.arrays.time[shown], list(parts.values()), colors=colours, edgecolor="white", linewidth=pen(0.3))
    shares, whole = ledger.shares, float(ledger.supplied[-1]) / energy.divisor
    viscous = shares["viscous"] * whole
    words = (
        (0.5 * viscous, "white", f"lost in the damping of the structure: {100 * shares['viscous']:.0f} %"),
        (viscous + 0.45 * shares["normal"] * whole, "white", f"lost in impacts: {100 * shares['normal']:.0f} %"),
    )
    for height, colour, text in words:
        axes.text(0.5 * until, height, text, color=colour, fontweight="bold", va="center")
    axes.text(0.02 * until, 0.93 * whole, "still moving", color=INK, fontsize="small", va="top")
    axes.set_ylim(0, 1.04 * whole)
    axes.set_xlim(0, until)
    label(axes, "y", "Energy", energy.unit)
    time_axis(axes, run.arrays.time[shown], time)
