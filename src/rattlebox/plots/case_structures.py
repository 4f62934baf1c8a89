"""Drawings of structures: beams and plates to scale, others as symbols."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import singledispatch
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon, Rectangle

from rattlebox._util.quantities import amount

from ..model.beams import Beam
from ..model.case import Case
from ..model.plates import Plate
from ..model.shear_buildings import ShearBuilding
from ..model.structures import SDOF, Fixed, Shaker, StructurePart
from ..model.tuned_mass import TunedMass
from ..results.case_words import each_damper
from .style import FAINT, INK, SERIES_COLOURS, label, pen, scaled, shorten
from .technical import LOAD_COLOUR, SOLID, Point, arrow, body, dashpot, dimension, ground, mark, spring, text
from .types import Style

Marks = Mapping[int, str]
"""Text in the mark of each damper, by its number in the case."""

_MAX_STOREYS = 12
_MAX_STEMS = 40


def draw_structure(axes: Axes, case: Case, marks: Marks) -> None:
    """Draw the structure of a case with its loads, dampers and tuned masses."""
    _draw(case.structure, axes, case, marks)


@singledispatch
def _draw(structure: StructurePart, axes: Axes, case: Case, marks: Marks) -> None:
    """Draw the effective masses of a structure without a drawing of its own."""
    _draw_modes(axes, case, marks)


def _equal_scales(axes: Axes) -> None:
    axes.set_aspect("equal")
    axes.set_axis_off()


@dataclass
class _Attached:
    """What is drawn at a point of a structure, or on a tuned mass: marks of dampers, number of loads, tuned masses."""

    marks: list[str] = field(default_factory=list)
    loads: int = 0
    tuned: list[tuple[TunedMass, _Attached]] = field(default_factory=list)


def _attached(case: Case, marks: Marks) -> dict[str, _Attached]:
    """Return the points of the structure with dampers, loads or tuned masses, in this order."""
    points: defaultdict[str, _Attached] = defaultdict(_Attached)
    tuned = [part.label(number, len(case.tuned_masses)) for number, part in enumerate(case.tuned_masses)]
    for number, damper in enumerate(each_damper(case)):
        there = points[case.modes.point(damper.point)].marks
        there += [marks[number]] if marks[number] not in there else []  # cells and equal dampers share a mark
    for load in case.loads:
        points[case.modes.point(load.point)].loads += 1
    carried = [points.pop(name, _Attached()) for name in tuned]
    for part, parts in zip(case.tuned_masses, carried, strict=True):
        points[case.structure.modes().point(part.point)].tuned.append((part, parts))
    return dict(points)


@_draw.register
def _draw_oscillator(structure: SDOF, axes: Axes, case: Case, marks: Marks) -> None:
    """Draw a mass on spring and dashpot, with their values."""
    left = 0.0
    if structure.frequency is not None or structure.stiffness:
        left = -1.3
        ground(axes, (left, -0.5), (left, 0.5), 0.15)
        spring(axes, (left, 0.2), (0.0, 0.2), 0.2)
        frequency, stiffness = structure.frequency, structure.stiffness or 0.0
        value = amount(stiffness, "N/m") if frequency is None else amount(frequency, "Hz")
        text(axes, (left / 2, 0.38), value, va="bottom", fontsize="small")
        if structure.damping or structure.damping_ratio:
            dashpot(axes, (left, -0.2), (0.0, -0.2), 0.22)
            damping, ratio = structure.damping, structure.damping_ratio or 0.0
            value = amount(damping, "N s/m") if damping else amount(ratio, "%")
            text(axes, (left / 2, -0.38), value, va="top", fontsize="small")
    _draw_block(axes, case, marks, amount(structure.mass, "kg"), left)


@_draw.register
def _draw_shaker(structure: Shaker, axes: Axes, case: Case, marks: Marks) -> None:
    """Draw a shaker table."""
    arrow(axes, (0.2, -0.62), (1.0, -0.62), both=True, colour=LOAD_COLOUR, width=1.2)
    _draw_block(axes, case, marks, "shaker", 0.0)


@_draw.register
def _draw_fixed(structure: Fixed, axes: Axes, case: Case, marks: Marks) -> None:
    """Draw a fixed cavity."""
    ground(axes, (1.2, -0.4), (0.0, -0.4), 0.15)
    _draw_block(axes, case, marks, "fixed", 0.0)


def _draw_block(axes: Axes, case: Case, marks: Marks, words: str, left: float) -> None:
    """Draw a block without size, its dampers, loads and tuned masses; `left` is the edge of what is drawn beside it."""
    _equal_scales(axes)
    body(axes, (0.0, -0.4), 1.2, 0.8)
    own = next(iter(_attached(case, marks).values()), _Attached())  # of the only point
    text(axes, (0.6, 0.2 if own.marks else 0.0), words)
    _row_of_marks(axes, own.marks, (0.6, -0.15), 0.13)
    right = 1.2
    if own.loads:
        arrow(axes, (1.3, 0.0), (1.95, 0.0), colour=LOAD_COLOUR, width=1.4)
        text(axes, (1.62, 0.12), "F(t)", va="bottom", color=LOAD_COLOUR)
        right = 2.1
    top = 0.5 + _draw_tuned_masses(axes, own, (0.6, 0.4), 0.45)
    _draw_base_motion(axes, case, (left - 0.35, -0.75), (left + 0.35, -0.75), (left + 0.45, -0.75), ha="left")
    text(axes, ((left + right) / 2, -1.15), "symbols, not to scale", color=FAINT, fontsize="small")
    axes.set_xlim(left - 0.5, right + 0.3)
    axes.set_ylim(-1.35, top)


def _draw_base_motion(axes: Axes, case: Case, start: Point, end: Point, at: Point, **options: Any) -> None:
    """Draw the motion of the base as an arrow with its name."""
    if case.base:
        arrow(axes, start, end, both=True, colour=LOAD_COLOUR, width=1.2)
        text(axes, at, "motion of the base", color=LOAD_COLOUR, fontsize="small", **options)


def _row_of_marks(axes: Axes, words: Sequence[str], at: Point, radius: float) -> None:
    """Draw marks next to each other."""
    for k, each in enumerate(words):
        mark(axes, (at[0] + 2.4 * radius * (k - (len(words) - 1) / 2), at[1]), each, radius)


def _draw_tuned_masses(axes: Axes, parts: _Attached, at: Point, size: float) -> float:
    """Draw tuned masses, with their dampers, above their point; return the height that they take."""
    x, y = at
    for part, carried in parts.tuned:
        top = y + 1.2 * size
        spring(axes, (x - 0.3 * size, y), (x - 0.3 * size, top), 0.25 * size, 3)
        dashpot(axes, (x + 0.3 * size, y), (x + 0.3 * size, top), 0.25 * size)
        body(axes, (x - 0.6 * size, top), 1.2 * size, 0.6 * size)
        _row_of_marks(axes, carried.marks, (x, top + 0.3 * size), 0.22 * size)
        words = f"{amount(part.mass, 'kg')}, {amount(part.frequency, 'Hz')}" + (", F(t)" if carried.loads else "")
        text(axes, (x + 0.75 * size, top + 0.3 * size), words, ha="left", fontsize="small")
        y = top + 0.6 * size  # further ones, which stand on the same point, are drawn above
    return y - at[1] + (0.4 * size if parts.tuned else 0.0)


@_draw.register
def _draw_beam(beam: Beam, axes: Axes, case: Case, marks: Marks) -> None:
    """Draw a beam to scale with its supports, points, cross-section and first mode."""
    _equal_scales(axes)
    length = beam.length
    thick = beam.diameter or beam.height or 0.0
    shown = max(thick, 0.012 * length)
    unit = 0.06 * length
    axes.add_patch(Rectangle((0.0, -shown / 2), length, shown, facecolor=SOLID, edgecolor=INK, lw=pen(0.8), zorder=3))
    first, second = beam.ends.split("-")
    for x, end, side in ((0.0, first, -1), (length, second, 1)):
        _draw_support(axes, x, end, side, shown, unit)
    _draw_mode(axes, beam, unit)
    if beam.tip_mass:
        edge = max(shown, unit)
        body(axes, (length, -edge / 2), 0.7 * edge, edge)
        text(axes, (length + 0.85 * edge, 0.6 * edge), f"+ {amount(beam.tip_mass, 'kg')}", ha="left", fontsize="small")
    places = {"tip": length, "middle": length / 2} | dict(beam.points)
    above: dict[str, Point] = {name: (x, shown / 2) for name, x in places.items()}
    _draw_points(axes, case, marks, above, shown, unit)
    dimension(axes, (0.0, -shown / 2), (length, -shown / 2), amount(length, "m"), -3.0 * unit)
    beside = length * 1.15 + (3 * unit if beam.tip_mass else 0.0)  # the tip mass has its value there
    _draw_section(axes, beam, beside, unit, thick)
    attached = _attached(case, marks).items()
    heights = [_draw_tuned_masses(axes, parts, above[name], 2.2 * unit) for name, parts in attached]
    top = 4.5 * unit + max(heights, default=0.0)
    axes.set_xlim(-3 * unit, beside + max(thick, unit) + 6 * unit)
    axes.set_ylim(-0.5 * shown - 5.5 * unit, 0.5 * shown + top)


def _draw_support(axes: Axes, x: float, end: str, side: int, thick: float, unit: float) -> None:
    """Draw the support at an end of a beam."""
    if end == "clamped":
        half = 0.5 * thick + unit
        start, stop = ((x, half), (x, -half)) if side > 0 else ((x, -half), (x, half))
        ground(axes, start, stop, 0.8 * unit)
    elif end == "pinned":
        tip = (x, -0.5 * thick)
        corners = [tip, (x - 0.6 * unit, tip[1] - unit), (x + 0.6 * unit, tip[1] - unit)]
        axes.add_patch(Polygon(corners, facecolor="white", edgecolor=INK, lw=pen(0.8), zorder=3))
        ground(axes, (x + unit, tip[1] - unit), (x - unit, tip[1] - unit), 0.5 * unit)


def _draw_mode(axes: Axes, beam: Beam, unit: float) -> None:
    """Draw the shape of the first elastic mode in grey."""
    x = np.linspace(0.0, beam.length, 41)
    points = {str(k): float(x[k]) for k in range(x.size)}
    modes = beam.model_copy(update={"points": points, "mode_count": beam.mode_count}).modes()
    elastic = np.flatnonzero(modes.stiffness > 0)
    if not elastic.size:
        return
    shape = np.array([modes.shapes[name][elastic[0]] for name in points])
    axes.plot(x, 2.2 * unit * shape / np.abs(shape).max(), color=FAINT, lw=pen(0.8), ls=(0, (4, 2)), zorder=1)


def _draw_section(axes: Axes, beam: Beam, x: float, unit: float, thick: float) -> None:
    """Draw the cross-section at the right of a beam: to scale if it is large enough to be seen."""
    if not thick:
        return
    enlarged = max(1.0, 2.0 * unit / thick)
    centre = x + 2 * unit + 0.5 * thick * enlarged
    words = [amount(thick, "m")]
    if beam.diameter is not None:
        axes.add_patch(Circle((centre, 0.0), 0.5 * thick * enlarged, facecolor=SOLID, edgecolor=INK, lw=pen(0.8)))
        if beam.inner_diameter:
            inner = 0.5 * beam.inner_diameter * enlarged
            axes.add_patch(Circle((centre, 0.0), inner, facecolor="white", edgecolor=INK, lw=pen(0.8)))
            words.append(f"inner {amount(beam.inner_diameter, 'm')}")
    elif beam.width is not None:
        wide = beam.width * enlarged
        body(axes, (centre - wide / 2, -thick * enlarged / 2), wide, thick * enlarged)
        words = [f"{amount(beam.width, 'm')} x {amount(thick, 'm')}"]
    words.append("section" if enlarged == 1 else f"section, x {enlarged:.2g}")
    text(axes, (centre, -0.5 * thick * enlarged - 0.4 * unit), "\n".join(words), va="top", fontsize="small")


def _draw_points(axes: Axes, case: Case, marks: Marks, places: Mapping[str, Point], thick: float, unit: float) -> None:
    """Draw marks of dampers on a beam, and arrows of loads above, at their points, whose names are below."""
    for name, parts in _attached(case, marks).items():
        x, y = places[name]
        for k, words in enumerate(parts.marks):
            mark(axes, (x - 1.7 * unit * k, y - thick / 2), words, 0.75 * unit)
        text(axes, (x, y - thick - 0.9 * unit), shorten(name, 14), fontsize="small", va="top")
        if parts.loads:
            # A tuned mass stands above its point.
            left = x - 2.0 * unit if parts.tuned else x
            arrow(axes, (left, y + 3.2 * unit), (left, y + 0.9 * unit), colour=LOAD_COLOUR, width=1.4)
            _force(axes, (left + 0.4 * unit, y + 2.6 * unit))
    ends = (-unit, -4.2 * unit), (-unit, -2.2 * unit)
    _draw_base_motion(axes, case, *ends, (-0.5 * unit, -4.6 * unit), ha="left")


def _force(axes: Axes, at: Point) -> None:
    text(axes, at, "F(t)", ha="left", color=LOAD_COLOUR, fontsize="small")


@_draw.register
def _draw_plate(plate: Plate, axes: Axes, case: Case, marks: Marks) -> None:
    """Draw a plate from above to scale, with its points."""
    _equal_scales(axes)
    a, b = plate.length, plate.width
    unit = 0.05 * max(a, b)
    body(axes, (0.0, 0.0), a, b)
    inside = (0.3 * unit, 0.3 * unit), a - 0.6 * unit, b - 0.6 * unit
    axes.add_patch(Rectangle(*inside, fill=False, edgecolor=FAINT, lw=pen(0.6), ls="--", zorder=3))
    places: dict[str, Point] = {"middle": (a / 2, b / 2)} | {name: (x, y) for name, (x, y) in plate.points.items()}
    for name, parts in _attached(case, marks).items():
        x, y = places[name]
        for k, words in enumerate(parts.marks):
            mark(axes, (x + 1.7 * unit * k, y), words, 0.75 * unit)
        if parts.loads:
            axes.plot(x, y, marker="x", color=LOAD_COLOUR, ms=pen(6), mew=pen(1.4), zorder=9)
            _force(axes, (x + unit, y - unit))
        for k, (_, carried) in enumerate(parts.tuned):
            _row_of_marks(axes, carried.marks, (x, y - 2.0 * unit * (k + 1)), 0.75 * unit)
            axes.add_patch(Rectangle((x - unit / 2, y - unit / 2), unit, unit, facecolor=SERIES_COLOURS[2], zorder=7))
        text(axes, (x, y + 1.2 * unit), shorten(name, 14), va="bottom", fontsize="small", zorder=9)
    dimension(axes, (0.0, 0.0), (a, 0.0), amount(a, "m"), -1.5 * unit)
    dimension(axes, (a, 0.0), (a, b), amount(b, "m"), -1.5 * unit, rotate=True)
    thickness = f"{amount(plate.thickness, 'm')} thick, " if plate.thickness else ""
    note = f"{thickness}simply supported, seen from above"
    if case.base:
        note += "; the base moves normal to the plate"
    text(axes, (a / 2, -3.6 * unit), note, va="top", fontsize="small")
    axes.set_xlim(-unit, a + 3.5 * unit)
    axes.set_ylim(-5.5 * unit, b + unit)


@_draw.register
def _draw_building(building: ShearBuilding, axes: Axes, case: Case, marks: Marks) -> None:
    """Draw the storeys of a building as symbols with masses and stiffnesses."""
    _equal_scales(axes)
    count = len(building.masses)
    step = max(1, -(-count // _MAX_STOREYS))
    ground(axes, (1.5, 0.0), (-0.5, 0.0), 0.2)
    attached = _attached(case, marks)
    for k in range(count):
        y = k + 1.0
        for x in (0.0, 1.0):
            axes.plot([x, x], [k, y], color=INK, lw=pen(1.0), zorder=1)
        axes.add_patch(Rectangle((-0.15, y - 0.08), 1.3, 0.16, facecolor=SOLID, edgecolor=INK, lw=pen(0.8), zorder=2))
        if k % step == 0:
            text(axes, (-0.25, y), amount(building.masses[k], "kg"), ha="right", fontsize="small")
            text(axes, (1.25, y - 0.5), amount(building.stiffnesses[k], "N/m"), ha="left", fontsize="small", color=INK)
        parts = attached.get(f"storey {k + 1}", _Attached())
        for j, words in enumerate(parts.marks):
            mark(axes, (1.45 + 0.45 * j, y), words, 0.2)
        offset = 0.45 * len(parts.marks)
        if parts.loads:
            arrow(axes, (1.9 + offset, y), (1.2 + offset, y), colour=LOAD_COLOUR, width=1.4)
        for part, carried in parts.tuned:
            for words in carried.marks:
                mark(axes, (1.45 + offset, y), words, 0.2)
                offset += 0.45
            offset += 0.1 if carried.marks else 0.0
            words = ("in" if carried.marks else "+") + f" tuned mass {amount(part.mass, 'kg')}"
            text(axes, (1.25 + offset, y), words, ha="left", fontsize="small")
    _draw_base_motion(axes, case, (-0.2, -0.45), (1.2, -0.45), (0.5, -0.6), va="top")
    text(axes, (0.5, -1.3), "symbols, not to scale", color=FAINT, fontsize="small")
    axes.set_xlim(-1.6, 3.2)
    axes.set_ylim(-1.6, count + 0.6)


def _draw_modes(axes: Axes, case: Case, marks: Marks) -> None:
    """Draw the effective mass of each mode at the points of the dampers over the natural frequency."""
    modes, frequencies = case.structure.modes(), np.array(case.structure.natural_frequencies)
    stiff = np.asarray(modes.stiffness) > 0
    attached = {
        name: parts for name, parts in _attached(case, marks).items() if parts.marks or parts.loads or parts.tuned
    }
    names = list(attached) or list(modes.shapes)[:1]
    divisor, unit = scaled(frequencies, "Hz")
    for k, name in enumerate(names[: len(SERIES_COLOURS)]):
        shape = np.asarray(modes.shapes[name])[stiff]
        square = (shape.reshape(len(shape), -1) ** 2).sum(axis=1)
        moved = square > 1e-12 * square.max(initial=0.0)
        there = attached.get(name, _Attached())
        carried = [words for _, each in there.tuned for words in each.marks]
        numbers = ", ".join(filter(None, [*there.marks, *carried]))
        style: Style = {"color": SERIES_COLOURS[k], "marker": "o", "ms": pen(3), "ls": ""}
        x, y = frequencies[moved][:_MAX_STEMS] / divisor, square[moved][:_MAX_STEMS]
        axes.plot(x, y, label=f"at {shorten(name, 20)}" + (f" ({numbers})" if numbers else ""), **style)
        axes.vlines(x, 0, y, color=SERIES_COLOURS[k], lw=pen(0.8))
    axes.margins(x=0.1)
    axes.set_ylim(0.0, 1.4 * axes.get_ylim()[1])  # room for the legend
    label(axes, "x", "Natural frequency", unit)
    label(axes, "y", "1 / effective mass", "1/kg")
    for name_text in axes.legend(loc="upper right", fontsize="small").get_texts():
        name_text.set_parse_math(False)
