"""Figures 1 and 8: the system, and the start positions of the ball."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from rattlebox import Case
from rattlebox.plots import CHANNEL_COLOURS, FAINT, INK, StyledFigure, figure_style, pen

from .figure import Reproduction, letters
from .models import described
from .reference import GAP, START, paper_case

_CASES = {1: "Case 1: centred", 2: "Case 2: at the trailing wall", 3: "Case 3: at the leading wall"}
_BALL, _ROOM = 1.0, 0.55  # Radius of the drawn ball and clearance on each side, far larger than to scale


def cases() -> Mapping[str, Case]:
    """Return the paper's cases."""
    return {f"case {k}": paper_case(start=start) for k, start in START.items()}


def data() -> xr.Dataset:
    """Return the start positions."""
    return xr.Dataset(
        {"start": described("case", [GAP * start for start in START.values()], "m", "start of the ball in its cavity")},
        {"case": described("case", list(START), "", "case of the paper")},
    )


def draw(data: xr.Dataset) -> Figure:
    """Draw the structure on its spring and dashpot, and below it the three starts."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.46)
        panels = figure.subplot_mosaic([["system"] * 3, list("123")], height_ratios=(1.7, 1))
        _system(panels["system"])
        for case in data.case.values:
            axes = panels[str(case)]
            _cavity(axes, 0.0, 0.0, float(data.start.sel(case=case)) / GAP)
            axes.set(xlim=(-2.4, 2.4), ylim=(-1.35, 1.35), title=_CASES[int(case)])
        for axes in panels.values():
            axes.set_aspect("equal")
            axes.set_axis_off()
        letters(figure)
    return figure


def _cavity(axes: Axes, x: float, y: float, start: float) -> None:
    """Draw a cavity with its ball."""
    half = _BALL + _ROOM
    axes.add_patch(
        Rectangle((x - half - 0.5, y - 1.3), 2 * half + 1, 2.6, fc=CHANNEL_COLOURS["motion"], ec=INK, lw=pen(0.7))
    )
    axes.add_patch(Rectangle((x - half, y - _BALL - 0.08), 2 * half, 2 * _BALL + 0.16, fc="white", ec=INK, lw=pen(0.7)))
    axes.add_patch(Circle((x + _ROOM * start, y), _BALL, fc=FAINT, ec=INK, lw=pen(0.7)))


def _system(axes: Axes) -> None:
    """Draw the structure between its support and the load."""
    line: dict[str, Any] = {"color": INK, "lw": pen(0.9), "solid_joinstyle": "miter"}
    wall, left = -8.0, -2.05
    axes.plot([wall, wall], [-1.6, 1.6], **line)
    for y in np.arange(-1.6, 1.6, 0.4):
        axes.plot([wall - 0.35, wall], [y, y + 0.35], color=FAINT, lw=pen(0.6))
    coil = np.linspace(wall + 1.2, left - 1.2, 14)
    zigzag = 0.8 + 0.3 * np.array([0, *[1, -1] * 6, 0])
    axes.plot([wall, *coil, left], [0.8, *zigzag, 0.8], **line)
    middle = (wall + left) / 2
    axes.plot([wall, middle - 0.5], [-0.7, -0.7], **line)
    axes.plot([middle + 0.6, middle - 0.5, middle - 0.5, middle + 0.6], [-0.35, -0.35, -1.05, -1.05], **line)
    axes.plot([middle + 0.3, middle + 0.3], [-0.95, -0.45], **line)
    axes.plot([middle + 0.3, left], [-0.7, -0.7], **line)
    _cavity(axes, 0.0, 0.0, 0.0)
    arrow: dict[str, Any] = {"arrowstyle": "-|>", "color": INK, "lw": pen(0.9)}
    axes.annotate("", (3.6, 0.0), (2.05, 0.0), arrowprops=arrow)
    axes.annotate("", (1.0, -1.95), (0.0, -1.95), arrowprops=arrow)
    for x, y, text in (
        (middle, 1.4, "stiffness $K$"),
        (middle, -1.35, "damping $C$"),
        (4.5, 0.0, "load $F(t)$"),
        (0.0, 0.0, "ball, $m$"),
        (2.3, -1.95, "displacement $z$"),
        (0.0, 1.75, "structure, $M$"),
    ):
        axes.text(x, y, text, ha="center", va="center")
    thin = {"arrowstyle": "-", "color": INK, "lw": pen(0.5)}
    half = _BALL + _ROOM
    for side, place, text in ((-1, -3.2, "trailing wall"), (1, 4.4, "leading wall")):
        axes.annotate(text, (side * half, -0.6), (place, -1.75), arrowprops=thin, ha="center", va="center")
    for side in (-1, 1):
        axes.annotate(
            "",
            (side * half, 0.0),
            (side * _BALL, 0.0),
            arrowprops={**thin, "arrowstyle": "<->", "shrinkA": 0, "shrinkB": 0},
        )
        axes.annotate(
            "$d_0$", (side * (half - 0.27), 0.05), (side * 2.8, 1.6), arrowprops=thin, ha="center", va="center"
        )
    axes.set(xlim=(-9, 6), ylim=(-2.3, 2.1))


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    return (
        f"The pulse pushes the structure towards its leading wall. Clearance d_0 = {1e3 * GAP:.1f} mm, not to scale. "
        "The order of "
        "cases 2 and 3 is our interpretation: the paper shows it in a figure that we do not have."
    )


FIGURE = Reproduction(
    number="1, 8",
    title="The system and the start positions of the ball",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
)
