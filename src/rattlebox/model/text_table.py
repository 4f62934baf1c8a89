"""Tables of numbers in text: where the rows begin, what the lines above them say, and how the samples are laid out.

Names, units and layout are concluded from the first lines of a text file and from its last one. `numpy.loadtxt` reads the
rows between them, as long as all are rows of finite numbers; any other file is read line by line, to name the line at fault.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox._util.text_tables import Dialect, comma_is_both, may_separate_thousands
from rattlebox.exchange.read.sheets import SHEETS

from .files import Array
from .text_rows import (
    Row,
    Rows,
    empty_at_end,
    is_number,
    is_of_numbers,
    read_quickly,
    split_lines,
    with_decimal_point,
)
from .units_in_text import Line

ANY = "one or two columns of numbers below their names and units: time (s), acceleration (g)"
_COUNT = re.compile(r"\+?\d+\.?")
_WHOLE = re.compile(r"(?<![\d.])\d{1,12}(?![\d.])")
_SAMPLES = re.compile(
    r"\b(?:npts|points|samples|values|data)\b\W{0,12}(\d{1,12})(?![\d.])"
    r"|(?<![\d.])(\d{1,12})\s+(?:(?:data\s+)?points|samples|values)\b",
    re.I,
)
"""Numbers of samples in text: "NPTS= 24", "NO. OF POINTS: 32", "12 samples"."""
_HEADINGS = 2  # lines above a single column that may name it
_STEP = re.compile(r"\bDT\s*[=:]\s*(\d*\.?\d+(?:E[-+]?\d+)?)\s*(?:$|[,;)]|s\b|sec)", re.I)
"""Time step in a line above the numbers: "NPTS= 2676, DT= .0200 SEC"."""
TIMES = re.compile(r"(?:t|times?|zeit|temps|tiempo|tempo)(?:[ _](?:s|sec|ms|us|µs|ns|min|h))?", re.I)
"""Names of times, with their unit or without."""
_COUNTS = re.compile(
    r"#|(?:[ikn]|no|nr|num(?:ber)?|idx|index|samples?|points?|rows?|counts?|scans?|punkte?|messpunkte?)\.?",
    re.I,
)
"""Names of columns that count the rows."""
_EXPONENT_ALONE = re.compile(r"[-+]?\d*\.\d+[-+]\d{3}")  # 1.5-101, which Fortran writes for exponents of three digits
_LARGE = 10  # samples from which a number in a text is no coincidence
_EVEN_STEPS = 5  # even steps from which a first column is no coincidence
PROBED = 2000  # rows from which the layout is concluded


@dataclass(frozen=True, eq=False)
class TextTable:
    """A table of text: rows of data, and the lines above them."""

    file: Path
    rows: Rows
    names: list[str] | None
    headings: list[list[str]]
    lines: list[Line]
    step: float | None
    notes: tuple[str, ...]
    is_blank: bool  # whether blanks separate the columns
    step_is_noted: bool
    dialect: Dialect

    @property
    def width(self) -> int:
        """Number of columns."""
        return self.rows.width

    @property
    def is_named(self) -> bool:
        """Whether the columns have names for sure: a line of words above may as well be a title."""
        return self.names is not None and not (self.is_blank and all("(" not in name for name in self.names))

    @property
    def labels(self) -> list[str]:
        """Names of the columns, or their numbers from 1."""
        return self.names or [str(k + 1) for k in range(self.width)]

    def above(self, index: int) -> list[str]:
        """Return the headings of a column."""
        return [cells[index] for cells in self.headings]

    def table(self) -> Array:
        """Return the first full rows, (n, width) float; no rows if one is not of numbers."""
        rows = self.rows.head
        full = rows if self.rows.last or len(rows[-1].cells) == self.width else rows[:-1]
        try:
            probe = np.array([[float(cell) for cell in row.cells] for row in full[:PROBED]])
        except ValueError:
            probe = np.empty((0, self.width))
        return probe.reshape(-1, self.width)

    def goes_by_rows(self) -> bool:
        """Return whether the samples continue from row to row, as far as the lines above and the numbers show it."""
        if self.width == 1:
            return False
        cells = self.rows.cells
        stated_together = {
            int(number) for _, line in self.lines for pair in _SAMPLES.findall(line) for number in pair if number
        }
        anywhere = {int(number) for _, line in self.lines for number in _WHOLE.findall(line)}
        for stated in (stated_together, anywhere if cells >= _LARGE else set()):
            if (cells in stated) != (len(self.rows) in stated):
                return cells in stated
        if self.names is None and len(self.rows.end.cells) < self.width:
            return True
        return not self._has_even_times() and continues(self.table())

    def _has_even_times(self) -> bool:
        """Return whether the first column rises by even steps, and not all others do, as those of a ramp."""
        steps = np.diff(self.table(), axis=0)
        if len(steps) < _EVEN_STEPS:
            return False
        with np.errstate(over="ignore", invalid="ignore"):  # of a damaged file
            mean = steps.mean(axis=0)
            is_even = (mean > 0) & np.all(np.abs(steps - mean) < 0.01 * mean, axis=0)
        return bool(is_even[0] and not is_even.all())

    def place_of_times(self) -> int | None:
        """Return the index of the column of times: the only one with such a name, or the first one if it increases."""
        names = [] if self.names is None else [without_unit(name) for name in self.names]
        table = self.table()
        called = [k for k, name in enumerate(names) if TIMES.fullmatch(name) and increases(table[:, k:])]
        if len(called) == 1:
            return called[0]
        return 0 if increases(table) and not self.counts_rows(0) else None

    def counts_rows(self, index: int) -> bool:
        """Return whether a column counts the rows, by its name, or unnamed among named ones, as in files of pandas."""
        if self.names is None:
            return False
        name, column = without_unit(self.names[index]), self.table()[:, index]
        is_whole = len(column) > 2 and bool(np.all(np.diff(column) == np.round(np.diff(column))))
        is_count = is_whole and column[0] in (0, 1) and bool(np.all(np.diff(column) == 1))
        return (is_whole and bool(_COUNTS.fullmatch(name))) or (is_count and not self.names[index].strip())

    def rises(self) -> bool:
        """Return whether the first column increases, as times do."""
        return increases(self.table())

    def other_step(self, index: int, step: float) -> str:
        """Return a note if another column looks like times with another step than that of the user; else ""."""
        probe = self.table()
        if index == 0 or self.width < 2 or len(probe) < 3:
            return ""
        rises = np.diff(probe[:, 0])
        even = float(rises[0])
        if (
            even <= 0
            or np.any(np.abs(rises - even) > 0.01 * even)
            or even == round(even)
            or abs(step / even - 1) < 0.01
        ):
            return ""
        return f"dt is {step:.6g} s, but the first column rises evenly by {even:.6g}"


def without_unit(name: str) -> str:
    """Return the name of a column without a unit in brackets behind it."""
    return re.sub(r"\s*[(\[].*", "", name.strip())


def continues(table: Array) -> bool:
    """Return whether the numbers of a table continue from row to row as they do within rows.

    Samples of one signal change as much from the end of a row to the beginning of the next one as within rows, and more
    from row to row. Columns of several signals do neither.
    """
    if len(table) < 3 or table.shape[1] < 2:
        return False
    with np.errstate(over="ignore", invalid="ignore"):  # of a damaged file
        inside = float(np.mean(np.diff(table, axis=1) ** 2))
        across = float(np.mean((table[1:, 0] - table[:-1, -1]) ** 2))
        down = float(np.mean(np.diff(table, axis=0) ** 2))
    return 0.1 * inside <= across <= 10 * inside and inside + across < down


def increases(table: Array) -> bool:
    """Return whether the first column of a table increases, as times do."""
    return len(table) > 2 and bool(np.all(np.diff(table[:, 0]) > 0))


def parse_text(
    file: Path, known: Sequence[str] = (), requested: Sequence[str] = (), *, has_samples: bool = True
) -> TextTable:
    """Return the table of a text file; without `has_samples` no line states their number.

    The names are the last line above the data with as many cells and no number in them, or an earlier one (above a line of
    units) that contains more of the known or requested names.
    """
    quick = None if file.suffix.lower() in SHEETS else read_quickly(file)
    text = quick and _layout(file, *quick, known, requested, has_samples)
    if text and is_of_numbers(text.rows):
        return text
    lines, dialect = split_lines(file)
    text = _layout(file, lines, np.empty((0, 0)), [], dialect, known, requested, has_samples)
    if text is None:
        raise DataError(f"{file} contains no numbers", ANY)
    return text


def _layout(
    file: Path,
    lines: list[Row],
    below: Array,
    last: list[Row],
    dialect: Dialect,
    known: Sequence[str],
    requested: Sequence[str],
    has_samples: bool,
) -> TextTable | None:
    """Return the table in the lines of a file, with the numbers of the rows below; None if the lines do not suffice."""
    # Where the rows begin.
    start = _first_data_line(lines)
    if start is None:
        return None
    head = [row for row in lines[start:] if not row.is_comment]
    leading = int(all(not row.cells[0] for row in head))  # a delimiter at the beginning of each line
    if leading:
        lines = [row._replace(cells=row.cells[1:] if not row.cells[0] else row.cells) for row in lines]
        head = [row._replace(cells=row.cells[1:]) for row in head]
    # A heading above a column without any value is not that of the next column.
    width = max((len(row.cells) for row in head[:PROBED]), default=0)
    trailing = min((empty_at_end(row, dialect) for row in head[:PROBED]), default=0)
    for k, row in enumerate(lines[:start] if leading or trailing else ()):
        first = leading * (len(row.cells) == leading + width + trailing)
        if len(row.cells) == first + width + trailing:
            lines[k] = row._replace(cells=row.cells[first : first + width])
    if dialect.delimiter == "," and comma_is_both(
        [row.cells for row in head[:PROBED]], [r.cells for r in lines[:start]]
    ):
        raise DataError(
            f"{file}, line {head[0].number}: the comma separates columns and seems to be the decimal mark, too:"
            f" {head[0].content[:60]!r}",
            "semicolons between the columns, or decimal points",
        )
    rows = Rows(head, below, last)
    # One row with another number of digits decides it; a note would not do for a factor of a thousand.
    if dialect.has_comma and may_separate_thousands(row.content for row in rows):
        if below.size:
            return None  # a row that is not stored as text may decide it
        raise DataError(
            f"{file}, line {head[0].number}: the commas are decimal marks or separate thousands; rows such as"
            f" {head[0].content.strip()[:60]!r} may be either",
            "decimal points, or numbers without commas",
        )
    # What the lines above and the first row state about the sampling.
    step: float | None = None
    notes: tuple[str, ...] = ()
    if has_samples and (counted := _number_of_samples(file, rows)):
        step, note = counted
        rows, notes = Rows(head[1:], below, last), (note,)
    step_is_noted = bool(notes)
    if reading := dialect.note():
        notes = (*notes, reading)
    if step is None:
        stated = {float(match[1]) for row in lines[:start] for match in _STEP.finditer(row.content)}
        step = stated.pop() if len(stated) == 1 and 0 < min(stated) < np.inf else None
    names, headings, free = _headings(file, lines[:start], rows, known, requested)
    is_blank = all(row.cells == row.content.split() for row in rows.head[:PROBED])
    return TextTable(file, rows, names, headings, free, step, notes, is_blank, step_is_noted, dialect)


def _headings(
    file: Path, lines: list[Row], rows: Rows, known: Sequence[str], requested: Sequence[str]
) -> tuple[list[str] | None, list[list[str]], list[tuple[int, str]]]:
    """Return the names of the columns, all headings, and the lines of free text among the lines above the data."""
    width = rows.width
    for row in lines:
        if len(row.cells) != width and set(row.cells) <= set(known):
            raise DataError(
                f"{file}, line {rows.head[0].number}: {width} columns, but {len(row.cells)} in line {row.number}",
                "a name above each column",
            )
    above = [(row, _heading_cells(row, width)) for row in lines]
    if width == 1:  # a name and a unit; further lines are text
        above = [(row, cells if len(lines) - k <= _HEADINGS else None) for k, (row, cells) in enumerate(above)]
    headings = [cells for _, cells in above if cells and not any(map(is_number, cells))]
    expected = {*known, *requested}
    names = max(reversed(headings), key=lambda cells: len(expected & set(cells)), default=None)
    # The unit in the heading of a column is not that of another one.
    free = [
        (row.number, row.content)
        for row, cells in above
        if cells is None or cells not in headings or "unit" in row.content.lower()
    ]
    return names, headings, free


def _heading_cells(row: Row, width: int) -> list[str] | None:
    """Return the cells of a line above a table of so many columns; None if it has another number of cells.

    Columns that are separated by blanks may have blanks in their headings: "Time (s)  Ground acceleration (cm/s^2)".
    """
    if width == 1:
        return [" ".join(row.cells)]  # a single column has no delimiter
    text = row.content.strip()
    has_brackets = "(" in text or "[" in text
    if len(row.cells) == width and not (has_brackets and row.cells == text.split()):
        return row.cells
    if row.cells != text.split():  # another delimiter
        return None
    ways = (_words(text), re.split(r"\s{2,}|\t", text), re.split(r"(?<=[)\]])\s+", text), re.split(r"[;,\t]", text))
    return next(([cell.strip() for cell in cells] for cells in ways if len(cells) == width), None)


def _words(text: str) -> list[str]:
    """Return the words of a line; brackets belong to the word before them."""
    words: list[str] = []
    depth = 0
    for token in text.split():
        if words and (depth > 0 or token[0] in "(["):
            words[-1] += f" {token}"
        else:
            words.append(token)
        depth = max(0, depth + token.count("(") + token.count("[") - token.count(")") - token.count("]"))
    return words


def _number_of_samples(file: Path, rows: Rows) -> tuple[float | None, str] | None:
    """Return the time step and a note if the first line of numbers states the number of samples; None if it is data."""
    first, rest = rows.head[0], Rows(rows.head[1:], rows.below, rows.last)
    if len(rest) < 2 or len(first.cells) > 2 or not all(map(is_number, first.cells)):
        return None
    counts = [cell for cell in first.cells if _COUNT.fullmatch(cell) and len(cell) < 13]
    if not counts:
        return None
    fits = (len(rest), rest.cells)
    count = next((cell for cell in counts if int(float(cell)) in fits), counts[0])
    others = [float(cell) for cell in first.cells if cell is not count]
    step = next((number for number in others if 0 < number < np.inf), None)
    is_exact = int(float(count)) in fits and (step is not None or len(first.cells) == 1)
    same_width = len(first.cells) == rest.width
    if same_width and len(first.cells) == 2 and int(float(count)) < _LARGE:  # "3 0.7" may be the first of four points
        is_exact = is_exact and _breaks_times(first, rest, step)
    if not is_exact and same_width and len(first.cells) == 2 and not _breaks_times(first, rest, step):
        return None
    if not is_exact and len(first.cells) == 1:
        if same_width and not _is_far_above(first, rest):
            return None
        raise DataError(
            f"{file}, line {first.number}: {count} is no number of samples, of which {fits[-1]} follow, and no row like"
            " those below it",
            f"# before the line, or {float(count)!r} if it is a sample",
        )
    if not is_exact and step is None:
        return None
    note = f"line {first.number}, {first.content.strip()!r}, is read as the number of samples"
    note += ("" if step is None else " and the time step") + ", not as data"
    return step, note if is_exact else f"{note}; it states {count} samples, but {fits[0]} rows follow"


def _breaks_times(first: Row, rest: Rows, step: float | None) -> bool:
    """Return whether a first row is not the point before those of a table with times, but has their step."""
    try:
        times = np.array([float(row.cells[0]) for row in rest.head[:PROBED]])
    except ValueError:
        return False
    even = float(times[1] - times[0])
    rises = even > 0 and bool(np.all(np.abs(np.diff(times) - even) < 0.01 * even))
    return rises and step is not None and float(first.cells[0]) >= times[0] and abs(step / even - 1) < 0.01


def _is_far_above(first: Row, rest: Rows) -> bool:
    """Return whether a first whole number is far above all others, which are not whole."""
    try:
        others = rest.numbers([0])
    except ValueError:
        return False
    far = float(first.cells[0]) > 10 * float(np.abs(others).max())
    return far and float(first.cells[0]) >= 10 and not all(_COUNT.fullmatch(row.cells[0].lstrip("-")) for row in rest)


def _first_data_line(lines: list[Row]) -> int | None:
    """Return the index of the first line of data: one with numbers only, or else (columns of text) with a number.

    Lines directly above that begin with a number count as data, so that an error in them is reported.
    """
    uncommented = [k for k, row in enumerate(lines) if not row.is_comment]

    def is_numeric(place: int, cell: int) -> bool:
        text = with_decimal_point(lines[uncommented[place]].cells[cell])
        return is_number(text) or bool(_EXPONENT_ALONE.fullmatch(text))

    only_numbers = (place for place, k in enumerate(uncommented) if all(map(is_number, lines[k].cells)))
    first = next(only_numbers, None)
    if first is None:
        widths = (len(lines[k].cells) for k in uncommented)
        first = next((p for p, width in enumerate(widths) if any(is_numeric(p, cell) for cell in range(width))), None)
    while first and is_numeric(first - 1, 0):
        width = len(lines[uncommented[first - 1]].cells)
        if 2 * sum(is_numeric(first - 1, cell) for cell in range(width)) < width:
            break  # "203 points at equal spacing of 0.02 sec"
        first -= 1
    return None if first is None else uncommented[first]
