"""Tables of numbers in text, NPY, NPZ and MAT files: columns of times and values, or samples row by row.

Names, units and layout are concluded from the first lines of a text file and from its last one. `numpy.loadtxt` reads the
rows between them, as long as all are rows of finite numbers; any other file is read line by line, to name the line at fault.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox._util.text_tables import Dialect, comma_is_both, may_separate_thousands
from rattlebox.exchange.read.guarded import errors_of
from rattlebox.exchange.read.sheets import SHEETS

from .errors import Hint, nearest, several
from .files import BINARY, Array, check_finite, existing, read_arrays
from .text_rows import (
    Row,
    Rows,
    empty_at_end,
    is_number,
    is_of_numbers,
    numbers_by_rows,
    numbers_of_columns,
    read_quickly,
    split_lines,
    with_decimal_point,
)
from .units_in_text import Line

Column = int | str
"""Number of a column, counted from 1, or its name."""

Selection = Sequence[Column] | Literal["rows"] | None
"""Columns of a record; "rows" for samples that go on from row to row; None for all that there are."""

_ANY = "one or two columns of numbers below their names and units: time (s), acceleration (g)"
_NO_ARRAYS = "contains no variable of real numbers that is read: cells, arrays of structs and complex numbers are not"
_NEEDED = {1: "one is", 2: "two are", 3: "three are"}
_BY_ROWS = 'columns = "rows"'
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
_TIMES = re.compile(r"(?:t|times?|zeit|temps|tiempo|tempo)(?:[ _](?:s|sec|ms|us|µs|ns|min|h))?", re.I)
"""Names of times, with their unit or without."""
_COUNTS = re.compile(
    r"#|(?:[ikn]|no|nr|num(?:ber)?|idx|index|samples?|points?|rows?|counts?|scans?|punkte?|messpunkte?)\.?",
    re.I,
)
"""Names of columns that count the rows."""
_EXPONENT_ALONE = re.compile(r"[-+]?\d*\.\d+[-+]\d{3}")  # 1.5-101, which Fortran writes for exponents of three digits
_LARGE = 10  # samples from which a number in a text is no coincidence
_EVEN_STEPS = 5  # even steps from which a first column is no coincidence
_PROBED = 2000  # rows from which the layout is concluded


@dataclass(frozen=True, eq=False)
class Columns:
    """Columns of times and values."""

    times: Array  # Times and values, in the units of the file, (n,)
    values: Array
    # Text (names, units) above the times and above the values, from top to bottom
    headings: tuple[list[str], list[str]] = ([], [])
    lines: tuple[Line, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class _Text:
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
            probe = np.array([[float(cell) for cell in row.cells] for row in full[:_PROBED]])
        except ValueError:
            probe = np.empty((0, self.width))
        return probe.reshape(-1, self.width)

    def goes_by_rows(self) -> bool:
        """Return whether the samples go on from row to row, as far as that can be told."""
        if self.width == 1:
            return False
        cells = self.rows.cells
        beside = {int(number) for _, line in self.lines for pair in _SAMPLES.findall(line) for number in pair if number}
        anywhere = {int(number) for _, line in self.lines for number in _WHOLE.findall(line)}
        for stated in (beside, anywhere if cells >= _LARGE else set()):
            if (cells in stated) != (len(self.rows) in stated):
                return cells in stated
        if self.names is None and len(self.rows.end.cells) < self.width:
            return True
        return not self._has_even_times() and _continues(self.table())

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
        names = [] if self.names is None else [_without_unit(name) for name in self.names]
        table = self.table()
        called = [k for k, name in enumerate(names) if _TIMES.fullmatch(name) and _increases(table[:, k:])]
        if len(called) == 1:
            return called[0]
        return 0 if _increases(table) and not self.counts_rows(0) else None

    def counts_rows(self, index: int) -> bool:
        """Return whether a column counts the rows, by its name, or without a name beside others, as those of pandas."""
        if self.names is None:
            return False
        name, column = _without_unit(self.names[index]), self.table()[:, index]
        is_whole = len(column) > 2 and bool(np.all(np.diff(column) == np.round(np.diff(column))))
        is_count = is_whole and column[0] in (0, 1) and bool(np.all(np.diff(column) == 1))
        return (is_whole and bool(_COUNTS.fullmatch(name))) or (is_count and not self.names[index].strip())

    def rises(self) -> bool:
        """Return whether the first column increases, as times do."""
        return _increases(self.table())

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


def read_columns(path: str, columns: Selection = None, step: float | None = None) -> Columns:
    """Read times and values from a file.

    `step`: time between evenly spaced samples [s], the first at 0 s; None for a column of times, or a step in the first
    line.
    """
    with errors_of(path, "columns of numbers"):
        file = existing(path)
        if file.suffix.lower() in BINARY:
            arrays = read_arrays(file)
            if not arrays:
                raise DataError(f"{file} {_NO_ARRAYS}", _ANY)
            if step is None and columns != "rows":
                return _select_arrays(file, arrays, columns)
            values, name, notes = _select_samples(file, arrays, columns)
            return Columns(_even_times(file, values.size, step), values, ([], _heading(name)), notes=notes)
        text = _parse_text(file, requested=[str(column) for column in columns or ()])
        by_rows = columns == "rows" or (columns is None and text.goes_by_rows() and (step or text.step))
        if step is None and (columns not in (None, "rows") or not (by_rows or (text.step and text.width == 1))):
            return _times_and_values(text, columns if columns != "rows" else None)
        return _samples(text, columns, step, bool(by_rows))


def _without_unit(name: str) -> str:
    """Return the name of a column without a unit in brackets behind it."""
    return re.sub(r"\s*[(\[].*", "", name.strip())


def _times_and_values(text: _Text, columns: Sequence[Column] | None) -> Columns:
    by_number = not any(isinstance(column, str) for column in columns or ())
    if by_number and not (text.width == 2 and text.rises()) and text.goes_by_rows():
        raise _by_rows_error(text.file, text.width, 'dt = "0.01 s", the time between samples, and columns = "rows"')
    if columns is None and text.dialect.has_complex:
        raise DataError(
            f"{text.file} has complex numbers, whose real and imaginary parts are read as columns 1 to {text.width}",
            "columns = [1, 3], the real parts of the first two numbers of each row, if all are complex",
        )
    place = text.place_of_times()
    counts = place is None and text.rises()
    if columns is not None and len(columns) == 1:
        (index,) = _column_indices(text.file, columns, text.labels, needed=1)
        if place is None or index == place:
            what = "counts the rows" if counts else "does not increase as times do"
            raise DataError(
                f"{text.file}: its first column {what}, so the times of {columns[0]!r} are not known"
                if index and place is None
                else f"{text.file}: {columns[0]!r} is its {'column of times' if place else 'first column'}, "
                "and so has no times",
                'columns = ["time", "force"], or dt = "0.01 s", the time between samples',
            )
        columns = (place + 1, index + 1)
    elif columns is None and text.width == 2:
        if counts:
            raise DataError(
                f"{text.file}: its first column, {text.labels[0]!r}, counts the rows, so the times are not known",
                f'dt = "0.01 s", the time between samples, and columns = {text.labels[1]!r}',
            )
        columns = (2, 1) if place == 1 else None
    indices = _column_indices(text.file, columns, text.labels, is_named=text.is_named, rises=text.rises())
    times, values = numbers_of_columns(text.file, text.rows, indices).T
    headings = text.above(indices[0]), text.above(indices[1])
    return Columns(times, values, headings, tuple(text.lines), text.notes)


def _samples(text: _Text, columns: Selection, step: float | None, by_rows: bool) -> Columns:
    """Return evenly spaced samples: those of one column, or all numbers row by row."""
    notes = list(text.notes)
    if step is not None and text.step is not None and abs(step / text.step - 1) > 1e-6:
        raise DataError(
            f"{text.file} states a time step of {text.step:g} s above its samples, not {step:g} s",
            f'dt = "{text.step:g} s"',
        )
    # All numbers in the order of the text, or one column.
    if by_rows:
        values = numbers_by_rows(text.file, text.rows)
        if text.width > 1:
            notes.append(f"the samples are read row by row, {text.width} a row, {values.size} in all")
        headings: list[str] = []
    else:
        is_named = text.is_named
        rises = text.rises()
        (index,) = _column_indices(text.file, columns, text.labels, needed=1, is_named=is_named, rises=rises)
        if rises and index == 0 and text.width > 1:
            notes.append("column 1 increases as times do, and is read as values")
        by_name = columns is not None and isinstance(columns[0], str)
        if not by_name and text.goes_by_rows():
            raise _by_rows_error(text.file, text.width, _BY_ROWS)
        if step is not None and (note := text.other_step(index, step)):
            notes.append(note)
        values = numbers_of_columns(text.file, text.rows, [index])[:, 0]
        headings = text.above(index)
        if not is_named and text.width > 2:
            notes.append(
                f"column {index + 1} of {text.width} columns without names is read, one sample a row, {values.size} in all"
            )
    # A step from the header is an assumption that the run must show; that of the first line is noted already.
    if step is None and text.step is not None and not text.step_is_noted:
        notes.append(f"the time step of {text.step:g} s is taken from the text above the samples")
    times = _even_times(text.file, values.size, step or text.step)
    return Columns(times, values, ([], headings), tuple(text.lines), tuple(notes))


def _even_times(file: Path, count: int, step: float | None) -> Array:
    if step is None:
        raise DataError(f"{file} does not state the time between its samples", 'dt = "0.01 s"')
    return np.arange(count, dtype=float) * step


def _continues(table: Array) -> bool:
    """Return whether the numbers of a table go on from row to row as they do within rows.

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


def _increases(table: Array) -> bool:
    """Return whether the first column of a table increases, as times do."""
    return len(table) > 2 and bool(np.all(np.diff(table[:, 0]) > 0))


def _by_rows_error(file: Path, width: int, advice: str) -> DataError:
    return DataError(f"{file}: its {width} columns are one signal, whose samples go on from row to row", advice)


def _select_samples(file: Path, arrays: dict[str, Array], columns: Selection) -> tuple[Array, str, tuple[str, ...]]:
    """Return the samples of a column of the only array, or of one variable, the name of the variable, and notes."""
    if len(arrays) == 1 and next(iter(arrays.values())).ndim == 2 and not (columns and isinstance(columns[0], str)):
        ((name, table),) = arrays.items()
        table = table.T if table.shape[0] == 1 else table
        one_signal = table.shape[1] > 1 and _continues(check_finite(table, f"{file}")[:_PROBED])
        if one_signal and columns is not None:
            raise _by_rows_error(file, table.shape[1], _BY_ROWS)
        if one_signal:
            notes = f"the samples are read row by row, {table.shape[1]} a row, {table.size} in all"
            return table.ravel(), name, (notes,)
        labels = [str(k + 1) for k in range(table.shape[1])]
        rises = table.shape[1] > 1 and _increases(table[:_PROBED])
        (index,) = _column_indices(file, columns, labels, needed=1, is_named=False, rises=rises)
        return check_finite(table[:, index], f"{file}: column {index + 1}"), name, ()
    if columns == "rows":
        if len(arrays) != 1:
            raise DataError(f"{file} has {len(arrays)} arrays ({', '.join(arrays)})", "a file with one of them")
        ((name, array),) = arrays.items()
        return check_finite(array.ravel(), f"{file}"), name, ()
    variables = [f"{name or 'an array'} {array.shape}" for name, array in arrays.items()]
    (index,) = _column_indices(file, columns, list(arrays), variables, needed=1)
    name, array = list(arrays.items())[index]
    if array.size != max(array.shape, default=1):
        raise DataError(f"{file}: {name} has shape {array.shape}; one row of numbers is needed")
    return check_finite(array.ravel(), f"{file}: {name}"), name, ()


def read_pairs(path: str, columns: Sequence[Column] | None) -> Columns:
    """Read two columns of which the first is not time, so that no line states a number of samples.

    One column in `columns` is that of the values; the other one is then the first of the file.
    """
    with errors_of(path, "columns of numbers"):
        file = existing(path)
        if file.suffix.lower() in BINARY:
            arrays = read_arrays(file)
            if not arrays:
                raise DataError(f"{file} {_NO_ARRAYS}", "two columns of numbers")
            return _select_arrays(file, arrays, columns)
        text = _parse_text(file, requested=[str(column) for column in columns or ()], has_samples=False)
        if columns is not None and len(columns) == 1:
            columns = (1, *columns)
        if columns is None and text.width != 2:
            names = ", ".join(f"{k} {name}" if text.names else name for k, name in enumerate(text.labels, start=1))
            raise DataError(f"{file} has {several(text.width, 'column')} ({names}), two are needed", "columns = [1, 2]")
        indices = _column_indices(file, columns, text.labels, is_named=text.is_named)
        first, second = numbers_of_columns(file, text.rows, indices).T
        headings = text.above(indices[0]), text.above(indices[1])
        return Columns(first, second, headings, tuple(text.lines), text.notes)


def columns_of_text(file: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the name of each channel of a table of text, and the fields of a record that read it; dt None is unknown."""
    text = _parse_text(file)
    step: dict[str, Any] = {} if text.step else {"dt": None}
    if text.width == 1 or text.goes_by_rows():
        yield "samples", {**step, "columns": "rows"} if text.width > 1 else step
        return
    place = text.place_of_times()
    for index in range(text.width):
        name = text.labels[index]
        if index == place or (index == 0 and text.counts_rows(0)):
            continue
        by_name = text.is_named and text.labels.count(name) == 1 and name != "rows"
        yield (
            name if by_name else f"column {index + 1}",
            ({"columns": name} if by_name else {"columns": (place + 1, index + 1)})
            if place is not None
            else {"dt": None, "columns": (name if by_name else index + 1,)},
        )


def columns_of_arrays(file: Path, arrays: dict[str, Array]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the name of each channel of arrays, and the fields of a record that read it; dt None is unknown."""
    if not arrays:
        raise DataError(f"{file} {_NO_ARRAYS}", _ANY)
    if len(arrays) == 1:
        ((name, table),) = arrays.items()
        width = table.shape[1] if table.ndim == 2 and table.shape[0] > 1 else 1
        if width == 1:
            yield name or "samples", {"dt": None}
        elif _has_times(table) and table.shape[1] > 2:
            yield name or "values", {}
        else:
            rises = _increases(table[:_PROBED])
            for index in range(1 if rises else 0, width):
                fields = {"columns": (1, index + 1)} if rises else {"dt": None, "columns": (index + 1,)}
                yield f"column {index + 1}", fields
        return
    for name, array in arrays.items():
        is_time = bool(_TIMES.fullmatch(name.rpartition(".")[2]))
        if is_time or array.size < 2 or not (_has_times(array) or array.size == max(array.shape)):
            continue
        try:
            _select_arrays(file, arrays, (name,))
            yield name, {"columns": name}
        except DataError:
            yield name, {"dt": None, "columns": (name,)}


def as_columns(value: Any, count: int = 2) -> Any:
    """Return `count` columns as a tuple; None and "rows" are returned unchanged."""
    if value is None or (isinstance(value, str) and value == "rows"):
        return value
    value = (value,) if isinstance(value, str) else value
    good = isinstance(value, (list, tuple)) and len(value) in {count, 1}
    if not good or not all(isinstance(item, (int, str)) and not isinstance(item, bool) for item in value):
        if count == 1:
            raise Hint(
                "with dt, one column is needed, that of the values",
                'columns = ["force"], or columns = "rows" for samples that go on from row to row',
            )
        raise Hint(
            "two numbers or names are needed, columns of times and of values, or one, that of the values",
            'columns = ["time", "force"], or columns = "force"',
        )
    return tuple(value)


def _select_arrays(file: Path, arrays: dict[str, Array], columns: Sequence[Column] | None) -> Columns:
    """Return times and values: two variables, or two columns of the only variable."""
    if columns is None and {"time", "value"} <= set(arrays):
        columns = ("time", "value")
    columns, arrays = _variable_of_values(file, arrays, columns)
    if len(arrays) == 1 and (columns is None or all(isinstance(column, int) for column in columns)):
        ((name, table),) = arrays.items()
        if columns is None and table.ndim == 2 and table.shape[0] == 2 != table.shape[1]:
            table = table.T
        if table.ndim == 2:
            if not (table.shape[1] == 2 and _increases(table)) and _continues(table[:_PROBED]):
                raise _by_rows_error(file, table.shape[1], 'dt = "0.01 s" and columns = "rows"')
            names = [str(k + 1) for k in range(table.shape[1])]
            first, second = (
                table[:, k] for k in _column_indices(file, columns, names, is_named=False, rises=_increases(table))
            )
            times, values = check_finite(first, f"{file}: the times"), check_finite(second, f"{file}: the values")
            return Columns(times, values, ([], _heading(name)))
    variables = [f"{name or 'an array'} {array.shape}" for name, array in arrays.items()]
    pair = [list(arrays.items())[k] for k in _column_indices(file, columns, list(arrays), variables)]
    for name, array in pair:
        if array.size != max(array.shape, default=1):
            raise DataError(f"{file}: {name} has shape {array.shape}; one row of numbers is needed")
        check_finite(array.ravel(), f"{file}: {name}")
    (time, times), (value, values) = pair
    if times.size != values.size:
        raise DataError(f"{file}: {time} has {times.size} numbers, but {value} {values.size}", "as many of both")
    return Columns(times.ravel(), values.ravel(), (_heading(time), _heading(value)))


def _heading(name: str) -> list[str]:
    """Return the text above the values of a variable: its name, which may end with a unit, such as acc_g."""
    return [name.rpartition(".")[2]] if name else []


def _variable_of_values(
    file: Path, arrays: dict[str, Array], columns: Sequence[Column] | None
) -> tuple[Sequence[Column] | None, dict[str, Array]]:
    """Return the columns of times and values, and the arrays that contain them, for a name of the values alone."""
    variables = [f"{name or 'an array'} {array.shape}" for name, array in arrays.items()]
    timed = [name for name, array in arrays.items() if _has_times(array)]
    vectors = [name for name in arrays if _TIMES.fullmatch(name.rpartition(".")[2])]
    if columns is None and len(arrays) > 1 and (timed or (vectors and len(arrays) > 2)):
        beside = [
            key for key in arrays if vectors and key not in vectors and arrays[key].size == arrays[vectors[0]].size
        ]
        if timed or beside:
            raise DataError(
                f"{file} has {several(len(arrays), 'variable')} ({', '.join(variables)})",
                f'columns = "{(timed or beside)[0]}"',
            )
    if columns is None or len(columns) != 1:
        return columns, arrays
    (index,) = _column_indices(file, columns, list(arrays), variables, needed=1)
    values = list(arrays)[index]
    if values in timed:
        return None, {values: arrays[values]}
    # Times of the same struct, or the only ones of this length.
    struct = values.rpartition(".")[0]
    like = [name for name in vectors if name != values and arrays[name].size == arrays[values].size]
    own = [name for name in like if name.rpartition(".")[0] == struct]
    if len(own or like) != 1:
        raise DataError(
            f"{file}: {values} has shape {arrays[values].shape}; it has no times, and there is no variable t or time",
            'columns = ["time", "force"], the variables of both, or dt = "0.01 s"',
        )
    return ((own or like)[0], values), arrays


def _has_times(array: Array) -> bool:
    """Return whether an array is a table of times and values, in two columns or two rows."""
    if array.ndim != 2 or 2 not in array.shape or array.size < 6:
        return False
    return _increases(array if array.shape[1] == 2 else array.T)


def _column_indices(
    file: Path,
    columns: Sequence[Column] | None,
    names: list[str],
    variables: Sequence[str] | None = None,
    needed: int = 2,
    is_named: bool = True,
    rises: bool = False,
) -> list[int]:
    """Return the indices of columns, or of variables described by `variables`; None stands for the first ones.

    The advice of messages depends on whether the columns have names, and whether the first one increases, as times do.
    """
    what = "column" if variables is None else "variable"
    listed = enumerate(variables or names, start=1)
    available = ", ".join(f"{k} {name}" if name != str(k) else name for k, name in listed)
    if columns is None:
        if len(names) != needed:
            is_time = bool(_TIMES.fullmatch(_without_unit(names[0]))) if names else False
            advice = 'dt = "0.01 s", the time between samples' if (needed, len(names)) == (2, 1) else ""
            if advice and is_time:
                advice = "a second column of values"
            if len(names) > needed:
                advice = f"columns = {[2] if rises and needed == 1 else list(range(1, needed + 1))}"
            if len(names) > needed == 1 and rises:
                advice = f"dt left out, since the first column increases as times do; or {advice}"
            elif len(names) > needed and not is_named and not rises:
                advice = 'dt = "0.01 s" and ' if needed == 2 else ""
                advice += f"{_BY_ROWS}, if the samples go on from row to row; else a line of names above the columns"
                advice += ', and columns = ["time", "force"]' if needed == 2 else ', and columns = ["force"]'
            raise DataError(
                f"{file} has {several(len(names), what)} ({available}), {_NEEDED[needed]} needed",
                advice or f"a file of {needed} columns of numbers",
            )
        columns = range(1, needed + 1)
    indices = []
    for column in columns:
        if isinstance(column, str) and names.count(column) > 1:
            same = " or ".join(str(k) for k, name in enumerate(names, start=1) if name == column)
            raise DataError(f"{file} has {names.count(column)} {what}s {column!r}", f"its number, {same}")
        if isinstance(column, str) and column in names:
            indices.append(names.index(column))
        elif isinstance(column, int) and 1 <= column <= len(names):
            indices.append(column - 1)
        else:
            suggestion = nearest(column, names) if isinstance(column, str) else f"{what}s count from 1"
            raise DataError(f"{file} has no {what} {column!r}; it has {available}", suggestion)
    if needed == 2 and indices[0] == indices[1]:
        raise DataError(
            f"{file}: times and values are both {what} {columns[0]!r}; it has {available}", f"two different {what}s"
        )
    return indices


def read_table(file: Path, known: Sequence[str] = ()) -> dict[str, Array]:
    """Read all columns of a text file with numbers.

    Returns columns by name, or by number from 1 if they have no names.
    """
    with errors_of(file, "columns of numbers"):
        text = _parse_text(file, known)
        names = text.labels
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise DataError(f"{file} has two columns {twice!r}", "another name for one of them")
        return dict(zip(names, numbers_of_columns(file, text.rows, list(range(len(names)))).T, strict=True))


def read_numbers(path: str, columns: Sequence[Column] | None, count: int) -> tuple[Array, list[list[str]]]:
    """Read some columns of a text file.

    Returns numbers, (n, count).
    """
    with errors_of(path, "columns of numbers"):
        file = existing(path)
        text = _parse_text(file, requested=[str(column) for column in columns or ()])
        indices = _column_indices(file, columns, text.labels, needed=count)
        return numbers_of_columns(file, text.rows, indices), [text.above(index) for index in indices]


def _parse_text(
    file: Path, known: Sequence[str] = (), requested: Sequence[str] = (), *, has_samples: bool = True
) -> _Text:
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
        raise DataError(f"{file} contains no numbers", _ANY)
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
) -> _Text | None:
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
    width = max((len(row.cells) for row in head[:_PROBED]), default=0)
    trailing = min((empty_at_end(row, dialect) for row in head[:_PROBED]), default=0)
    for k, row in enumerate(lines[:start] if leading or trailing else ()):
        first = leading * (len(row.cells) == leading + width + trailing)
        if len(row.cells) == first + width + trailing:
            lines[k] = row._replace(cells=row.cells[first : first + width])
    if dialect.delimiter == "," and comma_is_both(
        [row.cells for row in head[:_PROBED]], [r.cells for r in lines[:start]]
    ):
        raise DataError(
            f"{file}, line {head[0].number}: the comma separates columns and seems to be the decimal mark, too:"
            f" {head[0].content[:60]!r}",
            "semicolons between the columns, or decimal points",
        )
    rows = Rows(head, below, last)
    # One row with another number of digits tells; a factor of a thousand is not a matter of a note.
    if dialect.has_comma and may_separate_thousands(row.content for row in rows):
        if below.size:
            return None  # a row that is not here as text may tell
        raise DataError(
            f"{file}, line {head[0].number}: the commas are decimal marks or separate thousands, which rows such as"
            f" {head[0].content.strip()[:60]!r} do not tell",
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
    is_blank = all(row.cells == row.content.split() for row in rows.head[:_PROBED])
    return _Text(file, rows, names, headings, free, step, notes, is_blank, step_is_noted, dialect)


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
        times = np.array([float(row.cells[0]) for row in rest.head[:_PROBED]])
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
