"""Drawings of dampers to scale, with dimensions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import singledispatch
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Rectangle
from numpy.typing import NDArray

from rattlebox._util.phrases import counted, joined
from rattlebox._util.quantities import amount

from ..model.cavities import Cavity
from ..model.dampers import ImpactDamper
from ..model.particle_damper import ParticleDamper
from ..prepare.settle import start_positions
from .spheres import draw_spheres
from .style import FAINT, INK, SERIES_COLOURS, pen, series_colour
from .technical import SOLID, arrow, dimension, text
from .types import Style

Array = NDArray[np.float64]

MAX_DRAWN = 2000
"""Most particles that are drawn one by one."""
_PACKED = 0.6
"""Share of the volume that particles fill in a bed whose level is drawn."""
_VISIBLE = 0.04
"""Gap over the length of the cavity below which a detail shows it enlarged."""
_PIXELS = 700
_FRONT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Right, up and towards the viewer of a view along y."""


Cells = Sequence[tuple[ParticleDamper, Array]]
"""Cavities that are drawn together, and their places [m]."""


@singledispatch
def draw_damper(damper: Any, axes: Axes, cells: Cells) -> None:
    """Draw a damper to scale, with its dimensions; one with particles with all its cells."""
    raise TypeError(f"no drawing of a {type(damper).__name__}")


@draw_damper.register
def _draw_impact_damper(damper: ImpactDamper, axes: Axes, cells: Cells) -> None:
    """Draw the row of balls in its cavity to scale, with the clearance; a detail enlarges a small gap."""
    halves = np.array([ball.half for ball in damper.balls])
    # Strikers have no length and are drawn as large as the other bodies, or half as long as their clearance.
    radii = np.where(halves > 0, halves, halves.max() or 0.25 * damper.clearance or 1.0)
    length, to_scale = 2 * radii.sum() + damper.clearance, bool((halves > 0).all())
    high = 2 * float(radii.max())
    wall = 0.06 * max(length, high)
    axes.set_aspect("equal")
    axes.set_axis_off()
    centres = np.cumsum(2 * radii) - radii - radii.sum()
    bottom = -0.5 * high
    for x in (-length / 2 - wall, length / 2):
        axes.add_patch(Rectangle((x, bottom), wall, high, **_solid()))
    axes.plot([-length / 2, length / 2], [bottom, bottom], color=INK, lw=pen(0.5))
    axes.plot([-length / 2, length / 2], [bottom + high, bottom + high], color=INK, lw=pen(0.5), ls=(0, (4, 3)))
    materials = [ball.material.name or "own material" for ball in damper.balls]
    names = list(dict.fromkeys(materials))
    for centre, radius, material, half in zip(centres, radii, materials, halves, strict=True):
        style: Style = {
            "facecolor": series_colour(names.index(material)),
            "alpha": 0.35,
            "edgecolor": INK,
            "lw": pen(0.8),
        }
        block = Rectangle((centre - radius, -0.8 * radius), 2 * radius, 1.6 * radius, **style)
        axes.add_patch(Circle((centre, 0.0), radius, **style) if half > 0 else block)
    unit = 0.16 * max(high, 0.5 * length)
    if to_scale:
        dimension(axes, (-length / 2, bottom), (length / 2, bottom), amount(length, "m"), -1.2 * unit)
    # A gap that would be thinner than its dimension line is drawn in a detail instead.
    gap = 0.5 * damper.clearance
    edge = float(centres[0] - radii[0])
    small = gap < _VISIBLE * length
    if gap > 0 and not small:
        for a, b in ((-length / 2, edge), (-edge, length / 2)):
            dimension(axes, (a, bottom + high), (b, bottom + high), amount(gap, "m"), 0.8 * unit)
    sizes = list(dict.fromkeys(halves[halves > 0].tolist()))
    diameters = " and ".join(amount(2 * radius, "m") for radius in sizes) if len(sizes) < 4 else "of several sizes"
    many = "s" if len(damper.balls) > 1 else ""
    noun = joined(list(dict.fromkeys(ball.noun + many for ball in damper.balls)))
    words = [
        f"{len(damper.balls)} {joined([name.replace('_', ' ') for name in names])} {noun}"
        if sizes
        else f"{len(damper.balls)} {noun}",
        (f"diameter {diameters}, " if sizes else "") + amount(float(np.sum(damper.masses)), "kg"),
        f"gap 2 x {amount(gap, 'm')}" + (", enlarged on the right" if small and gap > 0 else ""),
    ]
    right = length / 2 + wall
    if small and gap > 0:
        _detail(axes, right + 0.45 * high, high, radii[-1], gap)
        right += 1.25 * high
    text(axes, ((right - length / 2 - wall) / 2, bottom - 2.4 * unit), "\n".join(words), va="top")
    axes.set_xlim(-length / 2 - 2 * wall, right + wall)
    axes.set_ylim(bottom - (3.4 + 1.4 * len(words)) * unit, bottom + high + 2.6 * unit)


def _detail(axes: Axes, left: float, high: float, radius: float, gap: float) -> None:
    """Draw the gap at the leading wall enlarged, in a circle at the right of the cavity."""
    reach = 0.42 * high
    centre = (left + reach, 0.0)
    frame = Circle(centre, reach, facecolor="white", edgecolor=FAINT, lw=pen(0.8), zorder=3)
    axes.add_patch(frame)
    scale = 0.5 * reach / gap
    surface = centre[0] - 0.5 * gap * scale
    middle = (surface - radius * scale, 0.0)
    edge: Style = {"facecolor": "none", "edgecolor": INK, "lw": pen(0.8), "zorder": 5}
    for patch in (
        Circle(middle, radius * scale, facecolor=SERIES_COLOURS[0], alpha=0.35, zorder=4),
        Circle(middle, radius * scale, **edge),
        Rectangle((surface + gap * scale, -high), high, 2 * high, zorder=4, **_solid()),
    ):
        axes.add_patch(patch)
        patch.set_clip_path(frame)
    arrow(axes, (surface, 0.0), (surface + gap * scale, 0.0), both=True, width=0.5)
    text(axes, (centre[0], -reach - 0.05 * high), f"gap {amount(gap, 'm')}, x {scale:.0f}", va="top", fontsize="small")


def _solid() -> Style:
    """Return the style of a wall in section."""
    return {"facecolor": SOLID, "edgecolor": INK, "lw": pen(0.8), "hatch": "////"}


@draw_damper.register
def _draw_particle_damper(damper: ParticleDamper, axes: Axes, cells: Cells) -> None:
    """Draw the cells of a damper from the front (along y) to scale, with their particles and the dimensions of one."""
    cavity = damper.interior
    axes.set_aspect("equal")
    axes.set_axis_off()
    half = np.array([0.5 * cavity.extent(np.array(direction)) for direction in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0))])
    places = np.array([place for _, place in cells]) @ _FRONT.T
    (left, bottom), (right, top) = places[:, :2].min(axis=0) - half, places[:, :2].max(axis=0) + half
    if len(cells) * len(damper.contents.radius) <= MAX_DRAWN:
        _draw_particles(axes, cells, (left, right, bottom, top))
    else:
        _draw_level(axes, damper, places[:, :2], *half)
    unit = 0.08 * max(right - left, top - bottom)
    for place in places[:, :2]:
        _draw_walls(axes, cavity, place)
    if cavity.is_aligned:  # else the extents are no dimensions of the cavity
        corners = np.concatenate(damper.cavity.outline(_FRONT)) @ _FRONT[:2].T
        low, high = corners.min(axis=0), corners.max(axis=0)
        # The dimensions are those of the lowest and of the rightmost cell, so that they cross no other one.
        lowest, rightmost = places[np.lexsort((places[:, 0], places[:, 1]))[0]], places[np.argmax(places[:, 0])]
        (x, z), (end, _) = low + lowest[:2], high + lowest[:2]
        dimension(axes, (x, z), (end, z), amount(end - x, "m"), -1.5 * unit)
        (_, z), (x, end) = low + rightmost[:2], high + rightmost[:2]
        dimension(axes, (x, z), (x, end), amount(end - z, "m"), -1.5 * unit, rotate=True)
    several = [f"{len(cells)} cells, in each:"] if len(cells) > 1 else []
    inside = [each.words() for each in damper.bodies]
    words = [
        *several,
        *_contents(damper),
        damper.cavity.words().removeprefix("a "),
        *(f"with {each}" for each in inside),
        *([damper.rotation.words()] if damper.rotation else []),
    ]
    _draw_directions(axes, damper, left - 5.2 * unit, bottom, unit)
    text(axes, (0.5 * (left + right), bottom - 3.4 * unit), "\n".join(words), va="top")
    axes.set_xlim(left - 7 * unit, right + 4 * unit)
    axes.set_ylim(
        bottom - (9 + bool(several) + bool(damper.rotation)) * unit, max(top + unit, bottom + 7 * unit)
    )  # the latter for gravity


def _contents(damper: ParticleDamper) -> list[str]:
    radii = damper.contents.radius
    materials = [species.material.name or "own material" for species in damper.particles]
    names = list(dict.fromkeys(name.replace("_", " ") for name in materials))
    size = amount(2 * float(radii.min()), "m")
    if not math.isclose(radii.min(), radii.max()):
        size += f" to {amount(2 * float(radii.max()), 'm')}"
    share = float((4 / 3 * math.pi * radii**3).sum()) / damper.interior.volume
    mass = amount(float(damper.contents.mass.sum()), "kg")
    balls = counted(len(radii), f"{joined(names)} ball")
    return [f"{balls} of {size}", f"{mass}, {amount(share, '%', 3)} of the volume"]


def _draw_particles(axes: Axes, cells: Cells, extent: tuple[float, float, float, float]) -> None:
    left, right, bottom, top = extent
    colours = np.array([_rgb(series_colour(k)) for damper, _ in cells for k in damper.contents.species])
    width = max(16, round(_PIXELS * min(1.0, (right - left) / (top - bottom))))
    centres = np.concatenate([start_positions(damper) + place for damper, place in cells]) @ _FRONT.T
    radii = np.concatenate([damper.contents.radius for damper, _ in cells])
    picture = draw_spheres(centres, radii, colours, extent, width, "plain")
    axes.imshow(picture, extent=extent, zorder=2, interpolation="antialiased")


def _rgb(colour: str) -> tuple[float, ...]:
    return tuple(0.5 + 0.5 * int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5))


def _draw_level(axes: Axes, damper: ParticleDamper, places: Array, half_x: float, half_z: float) -> None:
    """Draw the level of a bed of many particles in each cell; `places`: of the cells in the drawing, (k, 2) [m]."""
    radii, cavity = damper.contents.radius, damper.interior
    filled = float((4 / 3 * math.pi * radii**3).sum()) / _PACKED
    rng = np.random.default_rng(0)
    # The level below which this share of the cavity lies, from random points inside.
    points = rng.uniform(-1, 1, (20_000, 3)) * [half_x, 0.5 * cavity.extent(np.array([0.0, 1.0, 0.0])), half_z]
    heights = np.sort(points[cavity.depth(points) > 0, 2])
    level = float(heights[min(heights.size - 1, int(heights.size * min(1.0, filled / cavity.volume)))])
    # A section through the middle, of any cavity: where the depth below the walls is positive and below the level.
    grid_x, grid_z = np.meshgrid(np.linspace(-half_x, half_x, 400), np.linspace(-half_z, half_z, 400))
    inside = cavity.depth(np.stack([grid_x.ravel(), np.zeros(grid_x.size), grid_z.ravel()], axis=1)) > 0
    shown = (inside & (grid_z.ravel() < level)).reshape(grid_x.shape)
    colour = np.zeros((*shown.shape, 4))
    colour[shown] = (*_rgb(SERIES_COLOURS[0]), 1.0)
    for x, z in places:
        axes.imshow(colour, extent=(x - half_x, x + half_x, z - half_z, z + half_z), origin="lower", zorder=2)


def _draw_walls(axes: Axes, cavity: Cavity, place: Array) -> None:
    """Draw the outline of a cavity as seen along y, at a place in the drawing."""
    for line in cavity.outline(_FRONT):
        axes.plot(*((line @ _FRONT.T)[:, :2] + place).T, color=INK, lw=pen(1.0), zorder=4)


def _draw_directions(axes: Axes, damper: ParticleDamper, x: float, z: float, unit: float) -> None:
    """Draw the axes, the direction of the motion and of gravity at the left of the cavity."""
    for direction, name in (((1.0, 0.0), "x"), ((0.0, 1.0), "z")):
        end = (x + 1.6 * unit * direction[0], z + 1.6 * unit * direction[1])
        arrow(axes, (x, z), end, width=0.5)
        text(axes, (x + 2.2 * unit * direction[0], z + 2.2 * unit * direction[1]), name, fontsize="small")
    gravity = np.array(damper.gravity)[[0, 2]]
    if np.any(gravity):
        start = x + 0.8 * unit, z + 6.0 * unit
        pull = 1.8 * unit * gravity / np.linalg.norm(gravity)
        arrow(axes, start, (start[0] + pull[0], start[1] + pull[1]))
        text(axes, (start[0] + 0.9 * unit, start[1] - 0.6 * unit), "g", fontsize="small", fontstyle="italic")
