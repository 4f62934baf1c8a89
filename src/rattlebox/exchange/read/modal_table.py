"""Tables of modes: one row a mode, one column a quantity or a point."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np

from rattlebox._util.exceptions import DataError

from .modes_in_file import FloatArray, ModesInFile, read_start

_HEAD = re.compile(r"^\s*(.*?)\s*(?:[\[(]([^\])]*)[\])])?\s*$")
_AXES = {"x": 0, "y": 1, "z": 2}
_MEANS = {
    "frequency": "frequency", "f": "frequency", "damping": "damping", "damping ratio": "damping", "modal mass": "mass",
    "participation": "participation",
}  # fmt: skip
_FREQUENCY = {"": 1.0, "hz": 1.0, "khz": 1e3, "rad/s": 1 / (2 * np.pi)}
_DAMPING = {"": 1.0, "1": 1.0, "-": 1.0, "%": 0.01}
_SHAPE = {"": None, "kg^-0.5": 1.0, "kg^-1/2": 1.0, "t^-0.5": 1e3, "t^-1/2": 1e3, "g^-0.5": 1e-3, "g^-1/2": 1e-3}
_MASS = {"": None, "kg": 1.0, "g": 1e-3, "t": 1e3}


def read_modal_table(path: Path) -> ModesInFile:
    """Read a table of modes from a CSV file.

    Parameters
    ----------
    path
        An existing file. The first line names the columns: "frequency (Hz)", "damping (%)", "modal mass (kg)",
        "participation" (or "participation x", "y", "z"); every other column is the mode shape at a point, "tip", or three of
        them, "tip x", "tip y", "tip z". Lines that begin with # are no data.

    Returns
    -------
    ModesInFile
        The modes. Without a column of modal masses the shapes count as mass-normalised.

    Raises
    ------
    DataError
        If the file is no such table, naming the line and the column.
    """
    read_start(path, 64)
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise DataError(f"{path} is not text", "a CSV file in UTF-8") from None
    numbered = [
        (k, line) for k, line in enumerate(lines, start=1) if line.strip() and not line.lstrip().startswith("#")
    ]
    if not numbered:
        raise DataError(f"{path} holds no table")
    mark = next((mark for mark in ";\t," if mark in numbered[0][1]), ",")
    rows = [(k, [cell.strip() for cell in row]) for k, line in numbered for row in csv.reader([line], delimiter=mark)]
    head, body = rows[0][1], rows[1:]
    names, units = zip(*((match[1], match[2] or "") for match in map(_HEAD.match, head) if match), strict=True)
    if "frequency" not in {_MEANS.get(name.lower()) for name in names}:
        raise DataError(
            f"{path}, line {rows[0][0]}: no column is called frequency, but {', '.join(map(repr, names))}",
            "frequency (Hz), damping (%), tip",
        )
    if not body:
        raise DataError(f"{path} has a header, but no mode below it")
    table = np.empty((len(body), len(head)))
    for row, (number, cells) in enumerate(body):
        if len(cells) != len(head):
            cut = "the whole file: its last line is cut short" if row == len(body) - 1 else ""
            raise DataError(f"{path}, line {number}: {len(cells)} columns, but {len(head)} names above", cut)
        for place, cell in enumerate(cells):
            try:
                table[row, place] = float(cell)
            except ValueError:
                raise DataError(f"{path}, line {number}, column {names[place]!r}: {cell!r} is not a number") from None
            if not np.isfinite(table[row, place]):
                raise DataError(f"{path}, line {number}, column {names[place]!r}: {cell} is not finite")
    return _modes(path, names, units, table)


def _modes(path: Path, names: tuple[str, ...], units: tuple[str, ...], table: FloatArray) -> ModesInFile:
    def scale(place: int, known: dict[str, float] | dict[str, float | None]) -> float | None:
        unit = units[place].strip()
        key = unit.lower() if unit.lower() in known else unit
        if key not in known:
            raise DataError(
                f"{path}: {unit!r}, the unit of the column {names[place]!r}, is not known here",
                " or ".join(repr(word) for word in known if word),
            )
        return known[key]

    found: dict[str, list[int]] = {}
    points: dict[str, dict[int, int]] = {}
    for place, name in enumerate(names):
        meaning = _MEANS.get(name.lower()) or ("participation" if name.lower().startswith("participation ") else "")
        if meaning:
            found.setdefault(meaning, []).append(place)
            continue
        stem, _, axis = name.rpartition(" ")
        key = stem if axis.lower() in _AXES and stem else name
        axes = points.setdefault(key, {})
        along = _AXES[axis.lower()] if key != name else -1
        if along in axes:
            raise DataError(f"{path}: two columns are called {name!r}")
        axes[along] = place
    for meaning, places in found.items():
        if len(places) > (3 if meaning == "participation" else 1):
            raise DataError(f"{path}: two columns are called {names[places[1]]!r}")
    if not points:
        raise DataError(f"{path} holds no mode shape at any point", "a column for each point, called by its name")
    (frequency,) = found["frequency"]
    modal_masses, mass_unit = None, None
    if "mass" in found:
        (place,) = found["mass"]
        mass_unit, modal_masses = scale(place, _MASS), table[:, place]
    else:
        roots = {scale(place, _SHAPE) for axes in points.values() for place in axes.values()}
        if len(roots) > 1:
            raise DataError(f"{path}: the mode shapes are in different units", "one unit for all of them")
        mass_unit = roots.pop()
    shapes = {}
    for name, axes in points.items():
        if -1 in axes:
            shapes[name] = table[:, axes[-1]]
        else:
            shapes[name] = np.zeros((len(table), 3))
            for along, place in axes.items():
                shapes[name][:, along] = table[:, place]
    participation = None
    if "participation" in found:
        places = found["participation"]
        participation = table[:, places[0]] if len(places) == 1 else table[:, places]
    damping = None
    if "damping" in found:
        (place,) = found["damping"]
        damping = table[:, place] * float(scale(place, _DAMPING) or 1.0)
    return ModesInFile(
        frequencies=table[:, frequency] * float(scale(frequency, _FREQUENCY) or 1.0),
        shapes=shapes,
        modal_masses=modal_masses,
        damping_ratios=damping,
        participation=participation,
        mass_unit=mass_unit,
    )
