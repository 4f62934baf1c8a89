"""Tables of modes: one row per mode, one column per quantity or point."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox._util.text import has_controls
from rattlebox._util.text_tables import Dialect, decode, dialect_of, has_point, may_separate_thousands

from .formats import ModesRequest, modes_reader
from .guarded import errors_of
from .modes_in_file import FloatArray, ModesInFile, read_start

_AXES = {"x": 0, "y": 1, "z": 2}
_QUANTITIES = {
    "frequency": "frequency", "f": "frequency", "damping": "damping", "damping ratio": "damping", "modal mass": "mass",
    "participation": "participation", "participation factor": "participation",
}  # fmt: skip
_OTHER_QUANTITIES = re.compile(
    r"(?:effective|participating|generali[sz]ed|modal) .*|participation (?:factor )?(?:ratio|mass|share|percent|r[xyz]).*"
    r"|period|eigenvalue|zeta|xi|omega|quality factor"
)
"""Quantities of modes that are not read, and are no shapes at a point either."""
_NUMBERING = ("mode", "mode number", "mode no", "mode no.", "number", "no", "no.", "nr", "nr.", "set")
"""Headings of columns that only number or name the modes."""
_FREQUENCY = {"": 1.0, "hz": 1.0, "khz": 1e3, "rad/s": 1 / (2 * np.pi)}
_DAMPING = {"": 1.0, "1": 1.0, "-": 1.0, "%": 0.01}
_SHAPE = {"": None, "kg^-0.5": 1.0, "kg^-1/2": 1.0, "t^-0.5": 1e3, "t^-1/2": 1e3, "g^-0.5": 1e-3, "g^-1/2": 1e-3}
_PARTICIPATION = {"": None, "kg^0.5": 1.0, "kg^1/2": 1.0, "t^0.5": 1e3, "t^1/2": 1e3, "g^0.5": 1e-3, "g^1/2": 1e-3}
_MASS = {"": None, "kg": 1.0, "g": 1e-3, "t": 1e3}


@modes_reader(".csv", ".txt", ".tsv")
def read_modal_table(path: Path, _: ModesRequest) -> ModesInFile:
    """Read a table of modes from a CSV file."""
    with errors_of(path, "a table of modes"):
        read_start(path, 64)
        decoded = decode(path.read_bytes())
        if decoded is None:
            raise DataError(f"{path} is not text", "a CSV file in UTF-8")
        lines = decoded[0].splitlines()
        numbered = [
            (k, line) for k, line in enumerate(lines, start=1) if line.strip() and not line.lstrip().startswith("#")
        ]
        if not numbered:
            raise DataError(f"{path} contains no table", "a first line such as frequency (Hz), damping (%), tip")
        # Programs of countries with decimal commas separate by semicolons; the first line decides for all.
        mark = next((mark for mark in ";\t," if mark in numbered[0][1]), ",")
        rows = [(k, _cells(path, k, line, mark)) for k, line in numbered]
        head, body = rows[0][1], rows[1:]
        names, units = zip(*map(_name_and_unit, head), strict=True)
        if bad := next((name for name in names if has_controls(name)), None):
            raise DataError(
                f"{path}, line {rows[0][0]}: the name {bad!r} contains a control character", "printable names"
            )
        if "frequency" not in {_QUANTITIES.get(_words(name)) for name in names}:
            raise DataError(
                f"{path}, line {rows[0][0]}: no column is called frequency; the columns are {', '.join(map(repr, names))}",
                "frequency (Hz), damping (%), tip",
            )
        if not body:
            raise DataError(f"{path} has a header, but no mode below it", "a line of numbers for each mode")
        dialect = _dialect(path, [line for _, line in numbered[1:]], mark)
        table = np.zeros((len(body), len(head)))
        for row, (number, cells) in enumerate(body):
            if len(cells) != len(head):
                # A short last line is what a full disk or a broken download leaves; elsewhere it is a slip of the user.
                is_last = row == len(body) - 1
                advice = "the complete file: its last line is cut short" if is_last else "a number below each name"
                raise DataError(f"{path}, line {number}: {len(cells)} cells, but {len(head)} names above", advice)
            for column, cell in enumerate(cells):
                if names[column].lower() in _NUMBERING:
                    continue
                try:
                    table[row, column] = float(dialect.number(cell))
                except ValueError:
                    raise DataError(
                        f"{path}, line {number}, column {names[column]!r}: {cell!r} is not a number", "a number"
                    ) from None
                if not np.isfinite(table[row, column]):
                    raise DataError(
                        f"{path}, line {number}, column {names[column]!r}: {cell} is not finite", "a number"
                    )
        modes = _modes(path, names, units, table)
        note = dialect.note()
        return replace(modes, notes=(*modes.notes, f"{path.name}: {note}")) if note else modes


def _dialect(path: Path, lines: list[str], mark: str) -> Dialect:
    """Return how numbers are written; raise if commas in them may be decimal marks or not."""
    dialect = replace(dialect_of(lines, quoted=False), delimiter=mark, has_complex=False)
    if mark == "," or not dialect.has_comma:
        return replace(dialect, has_comma=False)
    if has_point([cell.strip() for line in lines for cell in line.split(mark)]) or may_separate_thousands(lines):
        raise DataError(
            f"{path}: the commas in numbers may be decimal marks, or separate thousands",
            "decimal points in all numbers",
        )
    return dialect


def _cells(path: Path, number: int, line: str, mark: str) -> list[str]:
    """Return the cells of a line."""
    try:
        return [cell.strip() for row in csv.reader([line], delimiter=mark) for cell in row]
    except csv.Error as error:
        raise DataError(f"{path}, line {number}: {error}", "numbers and names of usual lengths") from None


def _name_and_unit(heading: str) -> tuple[str, str]:
    """Return the name of a column and the unit in brackets at its end, "" if there is none."""
    text = heading.strip()
    bracket = max(text.rfind("("), text.rfind("[")) if text.endswith((")", "]")) else -1
    return (text[:bracket].rstrip(), text[bracket + 1 : -1]) if bracket >= 0 else (text, "")


def _words(name: str) -> str:
    """Return a heading in small letters, with blanks in place of underscores."""
    return " ".join(name.lower().replace("_", " ").split())


@dataclass(frozen=True)
class _Columns:
    """Columns of a table of modes."""

    path: Path
    names: tuple[str, ...]
    units: tuple[str, ...]
    table: FloatArray

    def scale(self, column: int, factors: Mapping[str, float | None]) -> float | None:
        """Return the factor of the unit of a column; raise if it is none of those in `factors`."""
        unit = self.units[column].strip()
        key = unit.lower() if unit.lower() in factors else unit
        if key not in factors:
            raise DataError(
                f"{self.path}: the column {self.names[column]!r} has the unknown unit {unit!r}",
                " or ".join(repr(word) for word in factors if word),
            )
        return factors[key]

    def participation(self, columns: list[int]) -> FloatArray:
        """Return the participation, (modes,) or along three axes, (modes, 3)."""
        if len(columns) == 1:
            return self.table[:, columns[0]]
        by_axis = {_AXES.get(_words(self.names[column]).rpartition(" ")[2], -1): column for column in columns}
        if sorted(by_axis) != [0, 1, 2]:
            found = " and ".join(repr(self.names[column]) for column in columns)
            raise DataError(
                f"{self.path}: {found} are not the participation along x, y and z",
                "participation x, participation y and participation z; or one column for points on a line",
            )
        return self.table[:, [by_axis[axis] for axis in range(3)]]

    def mass_unit(self, quantities: dict[str, list[int]], points: dict[str, dict[int, int]]) -> float | None:
        """Return the unit of mass [kg]; None if no column states it.

        It is that of the modal masses, or else follows from the unit kg^-1/2 of mass-normalised shapes.
        """
        has_masses = "mass" in quantities
        if has_masses:
            unit = self.scale(quantities["mass"][0], _MASS)
        else:
            roots = {self.scale(column, _SHAPE) for axes in points.values() for column in axes.values()}
            if len(roots) > 1:
                raise DataError(f"{self.path}: the mode shapes are in different units", "one unit for all of them")
            unit = roots.pop()
        # phi^T M r has the unit of mass for shapes with modal masses, and of its root for mass-normalised shapes.
        factors = _MASS if has_masses else _PARTICIPATION
        stated = {self.scale(column, factors) for column in quantities.get("participation", ())} - {None}
        if unit is None and len(stated) == 1:
            (unit,) = stated
        if stated - {unit}:
            raise DataError(
                f"{self.path}: the participation is in another unit of mass than the mode shapes or modal masses",
                "one unit of mass: (kg^0.5) and (kg^-0.5) without modal masses, (kg) with them",
            )
        return unit


def _modes(path: Path, names: tuple[str, ...], units: tuple[str, ...], table: FloatArray) -> ModesInFile:
    """Return the modes in a table of columns with these names and units."""
    quantities, points, others = _quantities_and_points(path, names)
    columns = _Columns(path, names, units, table)
    participation = quantities.get("participation")
    along = columns.participation(participation) if participation else None
    mass_unit = columns.mass_unit(quantities, points)
    # Units that the table leaves out are assumed, and noted with the largest value, which shows a wrong assumption.
    (frequency,) = quantities["frequency"]
    frequencies, damping = table[:, frequency] * float(columns.scale(frequency, _FREQUENCY) or 1.0), None
    notes = [f"{path.name}: the column {name!r} is not read" for name in others]
    if not units[frequency].strip():
        notes.append(f"{path.name} states no unit of frequency; Hz is assumed, up to {frequencies.max():.4g} Hz")
    if "damping" in quantities:
        (column,) = quantities["damping"]
        damping = table[:, column] * float(columns.scale(column, _DAMPING) or 1.0)
        if not units[column].strip():
            notes.append(f"{path.name} states no unit of damping; shares of one are assumed, up to {damping.max():.4g}")
    return ModesInFile(
        frequencies=frequencies,
        shapes={name: _shape(table, axes) for name, axes in points.items()},
        modal_masses=table[:, quantities["mass"][0]] if "mass" in quantities else None,
        damping_ratios=damping,
        participation=along,
        mass_unit=mass_unit,
        notes=tuple(notes),
    )


def _quantities_and_points(
    path: Path, names: tuple[str, ...]
) -> tuple[dict[str, list[int]], dict[str, dict[int, int]], list[str]]:
    """Return columns of quantities, columns of the axes of points (-1 is a shape without axes), and names of others."""
    # Each column is a quantity of the mode, its number, or a mode shape: a name that is no quantity is a point, with an
    # axis after a blank.
    columns: dict[str, list[int]] = {}
    points: dict[str, dict[int, int]] = {}
    others: list[str] = []
    for column, name in enumerate(names):
        words = _words(name)
        if words in _NUMBERING:
            continue
        quantity = _QUANTITIES.get(words, "")
        if not quantity and _OTHER_QUANTITIES.fullmatch(words):
            others.append(name)
            continue
        quantity = quantity or ("participation" if words.startswith("participation ") else "")
        if quantity:
            columns.setdefault(quantity, []).append(column)
            continue
        stem, _, axis = name.rpartition(" ")
        point = stem if axis.lower() in _AXES and stem else name
        axes = points.setdefault(point, {})
        component = _AXES[axis.lower()] if point != name else -1
        if component in axes:
            raise DataError(f"{path}: two columns are called {name!r}", "another name for one of them")
        axes[component] = column
    for quantity, places in columns.items():
        if len(places) > (3 if quantity == "participation" else 1):
            raise DataError(f"{path}: two columns are called {names[places[1]]!r}", "another name for one of them")
    if not points:
        raise DataError(f"{path} contains no mode shape at any point", "a column for each point, called by its name")
    return columns, points, others


def _shape(table: FloatArray, axes: dict[int, int]) -> FloatArray:
    """Return the mode shape of a point, (modes,) or (modes, 3)."""
    if -1 in axes:
        return table[:, axes[-1]]
    shape = np.zeros((len(table), 3))
    for component, column in axes.items():
        shape[:, component] = table[:, column]
    return shape
