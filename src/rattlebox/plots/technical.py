"""Elements of technical drawings: dimensions, springs, dashpots, grounds, arrows, numbered marks."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, FancyArrowPatch, Polygon, Rectangle

from .style import INK, SERIES_COLOURS, pen
from .types import Style

SOLID = "#dfe6ec"
"""Fill of bodies."""
LOAD_COLOUR = SERIES_COLOURS[1]
"""Colour of loads and motions."""
MARK_COLOUR = SERIES_COLOURS[0]
"""Colour of dampers."""

Point = tuple[float, float]


def text(axes: Axes, at: Point, words: str, **options: Any) -> None:
    """Write a text that is never read as mathematics, since names of users may contain dollar signs."""
    chosen: Any = {"ha": "center", "va": "center", "parse_math": False} | options
    axes.text(*at, words, **chosen)


def arrow(axes: Axes, start: Point, end: Point, *, both: bool = False, colour: str = INK, width: float = 0.8) -> None:
    """Draw an arrow."""
    style = "<|-|>" if both else "-|>"
    options: Style = {"lw": pen(width), "mutation_scale": pen(6), "shrinkA": 0, "shrinkB": 0, "zorder": 6}
    axes.add_patch(FancyArrowPatch(start, end, arrowstyle=style, color=colour, **options))


def dimension(axes: Axes, start: Point, end: Point, words: str, offset: float, *, rotate: bool = False) -> None:
    """Draw a dimension line parallel to the line between two points, with its words."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    along = (b - a) / (np.linalg.norm(b - a) or 1.0)
    normal = np.array([-along[1], along[0]])
    shift = normal * offset
    for point in (a, b):
        tail = np.stack([point + 0.15 * shift, point + 1.15 * shift])
        axes.plot(*tail.T, color=INK, lw=pen(0.35), zorder=5)
    first, last = a + shift, b + shift
    arrow(axes, (first[0], first[1]), (last[0], last[1]), both=True, width=0.5)
    middle = (first + last) / 2 + 0.2 * shift
    # Words are never upside down.
    angle = float(np.degrees(np.arctan2(along[1], along[0]))) if rotate else 0.0
    angle = angle - 180 if angle > 90 else angle + 180 if angle <= -90 else angle
    # The words are next to the line, on the side to which it is shifted, which is above or below them as they are read.
    above = float(shift @ (-np.sin(np.radians(angle)), np.cos(np.radians(angle)))) > 0
    across = rotate or abs(shift[0]) < abs(shift[1])
    horizontal = "center" if across else "left" if shift[0] > 0 else "right"
    vertical = ("bottom" if above else "top") if across else "center"
    turned: Style = {"rotation": angle, "rotation_mode": "anchor"}
    text(axes, (middle[0], middle[1]), words, ha=horizontal, va=vertical, zorder=7, **turned)


def ground(axes: Axes, start: Point, end: Point, depth: float) -> None:
    """Draw a fixed edge with hatches on the left of the direction from start to end."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    along = (b - a) / np.linalg.norm(b - a)
    normal = np.array([-along[1], along[0]]) * depth
    corners = np.stack([a, b, b + normal, a + normal])
    axes.add_patch(Polygon(corners, facecolor="none", edgecolor=INK, hatch="/////", lw=0, zorder=1))
    axes.plot(*np.stack([a, b]).T, color=INK, lw=pen(1.2), zorder=3)


def spring(axes: Axes, start: Point, end: Point, width: float, turns: int = 5) -> None:
    """Draw a spring as a zigzag."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    along, length = (b - a) / np.linalg.norm(b - a), float(np.linalg.norm(b - a))
    normal = np.array([-along[1], along[0]])
    places = np.concatenate([[0.0, 0.2], np.linspace(0.2, 0.8, 2 * turns + 1)[1:-1], [0.8, 1.0]]) * length
    sides = np.concatenate([[0, 0], [(-1) ** k for k in range(2 * turns - 1)], [0, 0]]) * width / 2
    line = a + np.outer(places, along) + np.outer(sides, normal)
    axes.plot(*line.T, color=INK, lw=pen(0.8), zorder=3)


def dashpot(axes: Axes, start: Point, end: Point, width: float) -> None:
    """Draw a dashpot."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    along = b - a
    normal = np.array([-along[1], along[0]]) / np.linalg.norm(along) * width / 2

    def line(*points: Any) -> None:
        axes.plot(*np.stack(points).T, color=INK, lw=pen(0.8), zorder=3)

    line(a, a + 0.4 * along)
    line(a + 0.65 * along + normal, a + 0.4 * along + normal, a + 0.4 * along - normal, a + 0.65 * along - normal)
    line(a + 0.55 * along + 0.8 * normal, a + 0.55 * along - 0.8 * normal)
    line(a + 0.55 * along, b)


def body(axes: Axes, corner: Point, width: float, height: float) -> None:
    """Draw a rectangular body."""
    axes.add_patch(Rectangle(corner, width, height, facecolor=SOLID, edgecolor=INK, lw=pen(0.8), zorder=2))


def mark(axes: Axes, at: Point, words: str, radius: float) -> None:
    """Draw the number of a damper in a circle; without a number a ball in a cavity."""
    style: Any = {"facecolor": "white", "edgecolor": MARK_COLOUR, "lw": pen(0.9), "zorder": 8}
    if not words:
        axes.add_patch(Rectangle((at[0] - 1.2 * radius, at[1] - 0.8 * radius), 2.4 * radius, 1.6 * radius, **style))
        axes.add_patch(Circle(at, 0.7 * radius, facecolor=MARK_COLOUR, alpha=0.5, zorder=9))
        return
    axes.add_patch(Circle(at, radius, **style))
    text(axes, at, words, color=MARK_COLOUR, zorder=9, fontsize="small", fontweight="bold")
