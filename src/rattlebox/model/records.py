"""Tables of numbers in text, NPY, NPZ and MAT files: columns of times and values.

`numpy.loadtxt` is 8 times as fast (0.1 s instead of 0.8 s for 200 000 lines), but needs the delimiter, the number of
lines above the data and the columns, and detects neither units nor decimal commas.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from rattlebox._util.exceptions import DataError

from .errors import Hint, nearest, several
from .files import BINARY, Array, check_finite, existing, read_arrays

Column = int | str
"""Number of a column, counted from 1, or its name."""

_ANY = "one or two columns of numbers below their names and units: time (s), acceleration (g)"
_NEEDED = {1: "one is", 2: "two are", 3: "three are"}


class Columns(NamedTuple):
    """Columns of times and values, (n,) float, and the headings (names, units) above each."""

    times: Array
    values: Array
    headings: tuple[list[str], list[str]] = ([], [])


def read_columns(path: str, columns: Sequence[Column] | None = None) -> Columns:
    """Read times and values from a file.

    Parameters
    ----------
    path
        CSV and other text, with columns separated by comma, semicolon, tab or blank; lines above the numbers and lines that
        begin with # or % are not data. NPY, NPZ, MAT: an array of columns, or a variable for each, numbered in the order of
        the file; without `columns` also an array of two rows.
    columns
        Columns or variables with times and values. Optional if there are two, or variables called time and value.

    Returns
    -------
    Columns
        Times and values, with their headings.

    Raises
    ------
    DataError
        If the file cannot be read; with the line at fault, or the available columns.
    """
    file = existing(path)
    if file.suffix.lower() in BINARY:
        return Columns(*_select_arrays(file, read_arrays(file), columns))
    lines, names, headings = _parse_text(file, requested=[str(column) for column in columns or ()])
    indices = _column_indices(file, columns, names)
    times, values = _parse_rows(file, lines, indices).T
    above_times, above_values = ([cells[index] for cells in headings] for index in indices)
    return Columns(times, values, (above_times, above_values))


def read_samples(path: str, column: Column | None = None) -> tuple[Array, list[str]]:
    """Read evenly spaced samples from a file.

    Parameters
    ----------
    path
        File as for `read_columns`.
    column
        Column or variable of the samples. Optional if there is only one.

    Returns
    -------
    (n,) float
        Samples.
    list of str
        Headings of the column.

    Raises
    ------
    DataError
        If the file cannot be read; with the line at fault, or the available columns.
    """
    file = existing(path)
    columns = None if column is None else [column]
    if file.suffix.lower() not in BINARY:
        lines, names, headings = _parse_text(file, requested=[] if column is None else [str(column)])
        (index,) = _column_indices(file, columns, names, needed=1)
        return _parse_rows(file, lines, [index])[:, 0], [cells[index] for cells in headings]
    arrays = read_arrays(file)
    if not arrays:
        raise DataError(f"{file} contains no numbers", _ANY)
    if len(arrays) == 1 and next(iter(arrays.values())).ndim == 2 and not isinstance(column, str):
        (table,) = arrays.values()
        table = table.T if table.shape[0] == 1 else table
        (index,) = _column_indices(file, columns, [str(k + 1) for k in range(table.shape[1])], needed=1)
        return check_finite(table[:, index], f"{file}: column {index + 1}"), []
    variables = [f"{name or 'an array'} {array.shape}" for name, array in arrays.items()]
    (index,) = _column_indices(file, columns, list(arrays), variables, needed=1)
    name, array = list(arrays.items())[index]
    if array.size != max(array.shape, default=1):
        raise DataError(f"{file}: {name} has shape {array.shape}; one row of numbers is needed")
    return check_finite(array.ravel(), f"{file}: {name}"), []


def as_columns(value: Any, count: int = 2) -> Any:
    """Return `count` columns as a tuple; None stays None.

    Raises
    ------
    Hint
        If the value is not a sequence of so many numbers and names.
    """
    if value is None:
        return None
    good = isinstance(value, (list, tuple)) and len(value) == count
    if not good or not all(isinstance(item, (int, str)) and not isinstance(item, bool) for item in value):
        if count == 1:
            raise Hint("with dt, one column is needed, that of the values", 'columns = ["force"]')
        raise Hint("two numbers or names are needed: columns of times and of values", 'columns = ["time", "force"]')
    return tuple(value)


def _select_arrays(file: Path, arrays: dict[str, Array], columns: Sequence[Column] | None) -> tuple[Array, Array]:
    """Return times and values: two variables, or two columns of the only variable."""
    if not arrays:
        raise DataError(f"{file} contains no numbers", _ANY)
    if columns is None and {"time", "value"} <= set(arrays):
        columns = ("time", "value")
    if len(arrays) == 1 and (columns is None or all(isinstance(column, int) for column in columns)):
        ((_, table),) = arrays.items()
        if columns is None and table.ndim == 2 and table.shape[0] == 2 != table.shape[1]:
            table = table.T
        if table.ndim == 2:
            names = [str(k + 1) for k in range(table.shape[1])]
            first, second = (table[:, k] for k in _column_indices(file, columns, names))
            return check_finite(first, f"{file}: the times"), check_finite(second, f"{file}: the values")
    variables = [f"{name or 'an array'} {array.shape}" for name, array in arrays.items()]
    pair = [list(arrays.items())[k] for k in _column_indices(file, columns, list(arrays), variables)]
    for name, array in pair:
        if array.size != max(array.shape, default=1):
            raise DataError(f"{file}: {name} has shape {array.shape}; one row of numbers is needed")
        check_finite(array.ravel(), f"{file}: {name}")
    (time, times), (value, values) = pair
    if times.size != values.size:
        raise DataError(f"{file}: {time} has {times.size} numbers, but {value} {values.size}", "as many of both")
    return times.ravel(), values.ravel()


def _column_indices(
    file: Path,
    columns: Sequence[Column] | None,
    names: list[str],
    variables: Sequence[str] | None = None,
    needed: int = 2,
) -> list[int]:
    """Return the indices of columns, or of variables described by `variables`; None stands for the first ones."""
    what = "column" if variables is None else "variable"
    listed = enumerate(variables or names, start=1)
    available = ", ".join(f"{k} {name}" if name != str(k) else name for k, name in listed)
    if columns is None:
        if len(names) != needed:
            advice = 'dt = "0.01 s", the time between samples' if (needed, len(names)) == (2, 1) else ""
            raise DataError(
                f"{file} has {several(len(names), what)} ({available}), {_NEEDED[needed]} needed",
                f"columns = {list(range(1, needed + 1))}" if len(names) > needed else advice,
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

    Parameters
    ----------
    file
        Path of an existing text file, as for `read_columns`.
    known
        Possible names of columns; a line of them determines the number of columns.

    Returns
    -------
    dict of str to (n,) float
        Columns by name, or by number from 1 if they have no names.

    Raises
    ------
    DataError
        If the file cannot be read; with the line at fault.
    """
    lines, names, _ = _parse_text(file, known)
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise DataError(f"{file} has two columns {twice!r}", "another name for one of them")
    return dict(zip(names, _parse_rows(file, lines, list(range(len(names)))).T, strict=True))


def read_numbers(path: str, columns: Sequence[Column] | None, count: int) -> tuple[Array, list[list[str]]]:
    """Read some columns of a text file.

    Parameters
    ----------
    path
        File as for `read_columns`.
    columns
        Columns. Optional if the file has exactly `count`.
    count
        Number of columns to read.

    Returns
    -------
    (n, count) float
        Numbers.
    list of list of str
        Headings of each column.

    Raises
    ------
    DataError
        If the file cannot be read; with the line at fault, or the available columns.
    """
    file = existing(path)
    lines, names, headings = _parse_text(file, requested=[str(column) for column in columns or ()])
    indices = _column_indices(file, columns, names, needed=count)
    return _parse_rows(file, lines, indices), [[cells[index] for cells in headings] for index in indices]


def _parse_text(
    file: Path, known: Sequence[str] = (), requested: Sequence[str] = ()
) -> tuple[list[tuple[int, list[str]]], list[str], list[list[str]]]:
    """Return the numbered lines of data as cells, the names of the columns, and all headings with as many cells.

    The names are the last line above the data with as many cells and no number in them, or an earlier one (above a line of
    units) that contains more of the known or requested names.
    """
    lines = _split_lines(file)
    start = _first_data_line(lines)
    if start is None:
        raise DataError(f"{file} contains no numbers", _ANY)
    width = len(lines[start][1])
    for number, cells, _ in lines[:start]:
        if len(cells) != width and set(cells) <= set(known):
            raise DataError(f"{file}, line {lines[start][0]}: {width} columns, but {len(cells)} in line {number}")
    above = [cells for _, cells, _ in lines[:start]]
    if width == 1:
        above = [[" ".join(cells)] for cells in above]  # a single column has no delimiter
    headings = [cells for cells in above if len(cells) == width and not any(map(_is_number, cells))]
    expected = {*known, *requested}
    names = max(reversed(headings), key=lambda cells: len(expected & set(cells)), default=None)
    data = [(number, cells) for number, cells, is_comment in lines[start:] if not is_comment]
    return data, names or [str(k + 1) for k in range(width)], headings


def _first_data_line(lines: list[tuple[int, list[str], bool]]) -> int | None:
    """Return the index of the first line of data: one with numbers only, or else (columns of text) with a number.

    Lines directly above that begin with a number count as data, so that an error in them is reported.
    """
    uncommented = [k for k, (_, _, is_comment) in enumerate(lines) if not is_comment]

    def is_numeric(place: int, cell: int) -> bool:
        return _is_number(_with_decimal_point(lines[uncommented[place]][1][cell]))

    only_numbers = (place for place, k in enumerate(uncommented) if all(map(_is_number, lines[k][1])))
    first = next(only_numbers, None)
    if first is None:
        widths = (len(lines[k][1]) for k in uncommented)
        first = next((p for p, width in enumerate(widths) if any(is_numeric(p, cell) for cell in range(width))), None)
    while first and is_numeric(first - 1, 0):
        first -= 1
    return None if first is None else uncommented[first]


def _parse_rows(file: Path, lines: list[tuple[int, list[str]]], indices: list[int]) -> Array:
    width = len(lines[0][1])
    try:
        rows = [[float(cells[k]) for k in indices] for _, cells in lines if len(cells) == width]
    except ValueError:
        rows = []
    numbers = np.array(rows).reshape(len(rows), len(indices))
    if len(rows) < len(lines) or not np.isfinite(numbers).all():
        raise _bad_row(file, lines, indices)
    return numbers


def _bad_row(file: Path, lines: list[tuple[int, list[str]]], indices: list[int]) -> DataError:
    """Return the error of the first line that is not a row of numbers."""
    width = len(lines[0][1])
    for number, cells in lines:
        if len(cells) != width:
            advice = "the whole file: its last line is cut short"
            return DataError(
                f"{file}, line {number}: {several(len(cells), 'column')}, but {width} in line {lines[0][0]}",
                advice if number == lines[-1][0] and len(cells) < width else "",
            )
        row = [cells[k] for k in indices]
        bad = next((cell for cell in row if not _is_number(cell)), None)
        if bad is not None:
            is_decimal_comma = _is_number(_with_decimal_point(bad))
            advice = "a decimal point, not a comma" if is_decimal_comma else "a number, or # before lines of text"
            return DataError(f"{file}, line {number}: {bad!r} is not a number", advice)
        if not np.isfinite([float(cell) for cell in row]).all():
            return DataError(f"{file}, line {number}: {', '.join(row)} is not finite", "finite numbers in all lines")
    raise AssertionError("all lines are rows of numbers")


def _split_lines(file: Path) -> list[tuple[int, list[str], bool]]:
    """Return the number, the cells and the comment flag of each line that is not empty."""
    try:
        text = file.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise DataError(f"{file} is not text", "CSV, or a file that ends in .npy, .npz or .mat") from None
    except OSError as error:
        raise DataError(f"{file} cannot be read: {error.strerror or error}") from None
    data = [line for line in text if line.strip() and line.lstrip()[0] not in "#%"][-3:]
    # The last line may be cut short, so that the delimiter is the one of most of the last three lines.
    delimiter = next((mark for mark in ";\t," if 2 * sum(mark in line for line in data) >= max(1, len(data))), None)
    quoted = any('"' in line for line in text)
    lines = []
    for number, line in enumerate(text, start=1):
        is_comment = line.lstrip()[:1] in ("#", "%")
        content = line.lstrip("#% \t") if is_comment and delimiter != "\t" else line.strip(" ").lstrip("#%")
        try:
            if quoted and delimiter is not None:
                cells = next(csv.reader([content], delimiter=delimiter), [])
            else:
                cells = content.split(delimiter)
        except csv.Error as error:
            raise DataError(f"{file}, line {number}: {error}") from None
        cells = [cell.strip() for cell in cells]
        while cells and not cells[-1]:
            cells.pop()
        if cells:
            lines.append((number, cells, is_comment))
    return lines


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _with_decimal_point(cell: str) -> str:
    """Return the cell with a point in place of a decimal comma."""
    return cell.replace(",", ".", 1)
