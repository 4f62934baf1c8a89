"""Figures 1 and 8: the system, and the start positions of the ball."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Rectangle

from rattlebox import Case
from rattlebox.plots import CHANNEL_COLOURS, FAINT, INK, StyledFigure, pen

from .figure import Reproduction
from .system import GAP, START, paper_case

_CASES = {1: "Case 1: centred", 2: "Case 2: at the trailing wall", 3: "Case 3: at the leading wall"}
_BALL, _ROOM = 1.0, 0.55  # radius of the drawn ball and clearance on each side, far larger than to scale
_HALF = _BALL + _ROOM


def cases() -> Mapping[str, Case]:
    """Return the paper's cases."""
    return {f"case {k}": paper_case(start=start) for k, start in START.items()}


def data() -> xr.Dataset:
    """Return the start positions."""
    return xr.Dataset({"start": ("case", [GAP * start for start in START.values()])}, {"case": list(START)})


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw the structure on its spring and dashpot, and below it the three starts."""
    panels = figure.subplot_mosaic([["system"] * 3, list("123")], height_ratios=(1.7, 1))
    _system(panels["system"])
    for case in data.case.values:
        _cavity(panels[str(case)], float(data.start.sel(case=case)) / GAP)
        panels[str(case)].set(xlim=(-2.4, 2.4), ylim=(-1.35, 1.35), title=_CASES[int(case)])
    for axes in panels.values():
        axes.set_aspect("equal")
        axes.set_axis_off()


def _cavity(axes: Axes, start: float) -> None:
    """Draw a cavity with its ball."""
    edge: dict[str, Any] = {"ec": INK, "lw": pen(0.7)}
    axes.add_patch(Rectangle((-_HALF - 0.5, -1.3), 2 * _HALF + 1, 2.6, fc=CHANNEL_COLOURS["motion"], **edge))
    axes.add_patch(Rectangle((-_HALF, -_BALL - 0.08), 2 * _HALF, 2 * _BALL + 0.16, fc="white", **edge))
    axes.add_patch(Circle((_ROOM * start, 0.0), _BALL, fc=FAINT, **edge))


def _system(axes: Axes) -> None:
    """Draw the structure between its support and the load."""
    line: dict[str, Any] = {"color": INK, "lw": pen(0.9), "solid_joinstyle": "miter"}
    wall, left = -8.0, -2.05
    middle = (wall + left) / 2
    axes.plot([wall, wall], [-1.6, 1.6], **line)
    for y in np.arange(-1.6, 1.6, 0.4):
        axes.plot([wall - 0.35, wall], [y, y + 0.35], color=FAINT, lw=pen(0.6))
    coil = np.linspace(wall + 1.2, left - 1.2, 14)
    axes.plot([wall, *coil, left], [0.8, *(0.8 + 0.3 * np.array([0, *[1, -1] * 6, 0])), 0.8], **line)
    axes.plot([wall, middle - 0.5], [-0.7, -0.7], **line)
    axes.plot([middle + 0.6, middle - 0.5, middle - 0.5, middle + 0.6], [-0.35, -0.35, -1.05, -1.05], **line)
    axes.plot([middle + 0.3, middle + 0.3], [-0.95, -0.45], **line)
    axes.plot([middle + 0.3, left], [-0.7, -0.7], **line)
    _cavity(axes, 0.0)
    for tip, tail in (((3.6, 0.0), (2.05, 0.0)), ((1.0, -1.95), (0.0, -1.95))):
        axes.annotate("", tip, tail, arrowprops={"arrowstyle": "-|>", "color": INK, "lw": pen(0.9)})
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
    centred: dict[str, Any] = {"arrowprops": thin, "ha": "center", "va": "center"}
    for side, place, text in ((-1, -3.2, "trailing wall"), (1, 4.4, "leading wall")):
        axes.annotate(text, (side * _HALF, -0.6), (place, -1.75), **centred)
    for side in (-1, 1):
        both = {**thin, "arrowstyle": "<->", "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (side * _HALF, 0.0), (side * _BALL, 0.0), arrowprops=both)
        axes.annotate("$d_0$", (side * (_HALF - 0.27), 0.05), (side * 2.8, 1.6), **centred)
    axes.set(xlim=(-9, 6), ylim=(-2.3, 2.1))


FIGURE = Reproduction("figure_01", data, draw, 0.46, cases, lambda data: {"gap": 1e3 * GAP})
