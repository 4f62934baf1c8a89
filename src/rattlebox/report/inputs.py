"""Tables of the inputs of a case: every field with its unit, and numbers that follow from them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.quantities import amount
from rattlebox.model.base import Part
from rattlebox.model.case_tree import with_files
from rattlebox.model.materials import Material
from rattlebox.model.paths import unit_of_field
from rattlebox.model.units import as_written

from .parts import Table

if TYPE_CHECKING:
    from rattlebox.model.case import Case

_MAX_NUMBERS = 6
"""Longest list that is written out."""
_MAX_MODES = 6
"""Most modes in the line of natural frequencies."""
_PARTS = {
    "dampers": "Damper",
    "tuned_masses": "Tuned mass",
    "stops": "Stop",
    "loads": "Load",
    "base": "Motion of the base",
}
_HIDDEN = ("name", "kind", "title", "source")


def input_tables(case: Case) -> list[Table]:
    """Return the inputs of a case, one table for each part."""
    structure = case.structure
    tables = [Table(f"Structure: {_kind(structure)}", (), [*_structure_lines(case), *_lines(structure)])]
    for field, title in _PARTS.items():
        items = getattr(case, field)
        for number, part in enumerate(items):
            computed = _computed_lines(case, field, number)
            name = getattr(part, "name", "") or (str(number + 1) if len(items) > 1 else "")
            heading = f"{title} {name}".rstrip() + f": {_kind(part)}"
            tables.append(Table(heading, (), [*computed, *_lines(part)]))
    tables.append(Table("Run", (), list(_lines(case, ("structure", *_PARTS)))))
    return [table for table in tables if table.rows]


def _structure_lines(case: Case) -> Iterator[tuple[str, str]]:
    """Yield natural frequencies and damping ratios of the structure."""
    modes, frequencies = case.structure.modes(), case.structure.natural_frequencies
    if not frequencies:
        return
    stiff = np.asarray(modes.stiffness) > 0
    ratios = np.asarray(modes.decay)[stiff] / np.sqrt(np.asarray(modes.stiffness)[stiff])
    more = f" and {len(frequencies) - _MAX_MODES} more" if len(frequencies) > _MAX_MODES else ""
    yield "= natural frequencies", ", ".join(amount(each, "Hz") for each in frequencies[:_MAX_MODES]) + more
    yield "= damping ratios", ", ".join(amount(float(each), "%", 3) for each in ratios[:_MAX_MODES]) + more
    if modes.total_mass is not None and np.ndim(modes.total_mass) == 0:
        yield "= total mass", amount(float(modes.total_mass), "kg")


def _computed_lines(case: Case, field: str, number: int) -> Iterator[tuple[str, str]]:
    """Yield numbers that follow from the fields of a part and the structure."""
    if field == "dampers":
        yield from _damper_lines(case, number)
    if field == "stops":
        yield from ((f"= {name}", value) for name, value in case.stops[number].facts(case.modes))


def _damper_lines(case: Case, number: int) -> Iterator[tuple[str, str]]:
    """Yield mass, mass ratio, clearance or fill of a damper."""
    damper = case.dampers[number]
    points = [each.point for each in damper.each()]
    if len(points) > 1:
        yield "= identical dampers", f"{len(points)}, {amount(damper.mass * len(points), 'kg')} in all"
    for name, value in damper.facts():
        yield f"= {name}" + (", each" if len(points) > 1 else ""), value
    tuned = case.tuned_masses
    boxes = {part.label(index, len(tuned)): part.mass for index, part in enumerate(tuned)}
    if hung := sorted({point for point in points if point in boxes}):
        names = "mass over that of its box" if len(hung) == 1 else "mass over that of each box"
        yield f"= {names}", ", ".join(amount(damper.mass * points.count(box) / boxes[box], "%", 3) for box in hung)
    modes = case.structure.modes()
    if not len(modes.stiffness):
        return
    # The mass ratio of a mode is m phi^2, summed over the points of the structure and directions in which the damper acts.
    ratio = np.zeros(len(modes.stiffness))
    for point in (point for point in points if point not in boxes):
        shape = np.asarray(modes.shapes[modes.point(point)])
        ratio += damper.mass * np.sum(shape.reshape(len(shape), -1) ** 2, axis=1)
    moved = np.flatnonzero((ratio > 0) & (np.asarray(modes.stiffness) > 0))
    if moved.size:
        yield f"= mass over the effective mass of mode {moved[0] + 1}", amount(float(ratio[moved[0]]), "%", 3)


def _lines(part: Part, leave_out: Sequence[str] = ()) -> Iterator[tuple[str, str]]:
    """Yield names and values of the fields of a part that are set."""
    # Numbers that were read from a file would fill pages; the name of the file stands for them.
    from_file = part.fields_from_file()
    for name, field in type(part).model_fields.items():
        if name in _HIDDEN or name in leave_out or field.exclude or name in from_file:
            continue
        value = getattr(part, name)
        if name == "balls":
            name, value = _balls(value)
        elif name == "file":  # the path belongs to the computer of the author
            value = with_files({name: value}, lambda file: Path(file).name)[name]
        elif name == "unit" and isinstance(getattr(part, "amplitude", None), float):
            continue
        text = _text(value, unit_of_field(part, name) if name in type(part).model_fields else None)
        if text:
            yield name.replace("_", " "), text


def _balls(balls: Sequence[Part]) -> tuple[str, Part | Sequence[Part]]:
    """Return the name and value of the line of balls; equal balls are listed once."""
    if all(ball == balls[0] for ball in balls):
        return "ball" if len(balls) == 1 else f"{len(balls)} balls, each", balls[0]
    return "balls", balls


def _kind(part: object) -> str:
    return str(getattr(part, "kind", "")).replace("_", " ")


def _text(value: Any, unit: str | None = None) -> str:
    """Return the value of a field as text; "" for values that are not set."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if value is None or value == ():
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return amount(value, unit or "", 6)
    if isinstance(value, str):
        number = as_written(value)
        return amount(number[0], number[1], 6) if number and number[1] else value
    if isinstance(value, Part):
        return _part(value)
    if isinstance(value, Mapping):
        return "; ".join(f"{name}: {_text(item, unit)}" for name, item in value.items())
    if len(value) > _MAX_NUMBERS and all(isinstance(item, (list, tuple)) for item in value):
        return f"{len(value)} rows of {len(value[0])} numbers"
    items = [_text(item, unit) for item in value]
    if len(items) == 1:
        return items[0]
    if len(items) > _MAX_NUMBERS:
        if all(isinstance(item, (int, float)) for item in value):
            low, high = (_text(each(value), unit) for each in (min, max))
            return f"{len(items)} numbers from {low} to {high}"
        return f"{'; '.join(items[:_MAX_NUMBERS])}; and {len(items) - _MAX_NUMBERS} more"
    numbers, units = zip(*(item.partition(" ")[::2] for item in items), strict=True)
    if len(set(units)) == 1 and all(isinstance(item, float) for item in value):
        return f"{', '.join(numbers)} {units[0]}".rstrip()
    return ("; " if any(isinstance(item, (list, tuple, Part)) for item in value) else ", ").join(items)


def _part(part: Part) -> str:
    """Return a part inside a part in one line; a material by its name and main numbers."""
    if isinstance(part, Material):
        numbers = f"{amount(part.density, 'kg/m^3')}, E {amount(part.young, 'Pa')}, Poisson's ratio {part.poisson:g}"
        strength = "" if part.yield_stress is None else f", yield stress {amount(part.yield_stress, 'Pa')}"
        return f"{(part.name or 'own material').replace('_', ' ')} ({numbers}{strength})"
    kind = [_kind(part)] if "kind" in type(part).model_fields else []
    return ", ".join([*kind, *(f"{name} {text}" for name, text in _lines(part))])
