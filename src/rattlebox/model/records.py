"""Tables of numbers in text, NPY, NPZ and MAT files: columns of times and values, or samples row by row."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox.exchange.read.guarded import errors_of

from .errors import Hint, nearest, several
from .files import BINARY, Array, check_finite, existing, read_arrays
from .text_rows import (
    numbers_by_rows,
    numbers_of_columns,
)
from .text_table import ANY, PROBED, TIMES, TextTable, continues, increases, parse_text, without_unit
from .units_in_text import Line

Column = int | str
"""Number of a column, counted from 1, or its name."""

Selection = Sequence[Column] | Literal["rows"] | None
"""Columns of a record; "rows" for samples that go on from row to row; None for all that there are."""

_NO_ARRAYS = "contains no variable of real numbers that is read: cells, arrays of structs and complex numbers are not"
_NEEDED = {1: "one is", 2: "two are", 3: "three are"}
_BY_ROWS = 'columns = "rows"'


@dataclass(frozen=True, eq=False)
class Columns:
    """Columns of times and values."""

    times: Array  # Times and values, in the units of the file, (n,)
    values: Array
    # Text (names, units) above the times and above the values, from top to bottom
    headings: tuple[list[str], list[str]] = ([], [])
    lines: tuple[Line, ...] = ()
    notes: tuple[str, ...] = ()


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
                raise DataError(f"{file} {_NO_ARRAYS}", ANY)
            if step is None and columns != "rows":
                return _select_arrays(file, arrays, columns)
            values, name, notes = _select_samples(file, arrays, columns)
            return Columns(_even_times(file, values.size, step), values, ([], _heading(name)), notes=notes)
        text = parse_text(file, requested=[str(column) for column in columns or ()])
        by_rows = columns == "rows" or (columns is None and text.goes_by_rows() and (step or text.step))
        if step is None and (columns not in (None, "rows") or not (by_rows or (text.step and text.width == 1))):
            return _times_and_values(text, columns if columns != "rows" else None)
        return _samples(text, columns, step, bool(by_rows))


def _times_and_values(text: TextTable, columns: Sequence[Column] | None) -> Columns:
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


def _samples(text: TextTable, columns: Selection, step: float | None, by_rows: bool) -> Columns:
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


def _by_rows_error(file: Path, width: int, advice: str) -> DataError:
    return DataError(f"{file}: its {width} columns are one signal, whose samples go on from row to row", advice)


def _not_a_row(file: Path, name: str, array: Array) -> DataError:
    return DataError(
        f"{file}: {name} has shape {array.shape}; one row of numbers is needed", "a file with one signal an array"
    )


def _select_samples(file: Path, arrays: dict[str, Array], columns: Selection) -> tuple[Array, str, tuple[str, ...]]:
    """Return the samples of a column of the only array, or of one variable, the name of the variable, and notes."""
    if len(arrays) == 1 and next(iter(arrays.values())).ndim == 2 and not (columns and isinstance(columns[0], str)):
        ((name, table),) = arrays.items()
        table = table.T if table.shape[0] == 1 else table
        one_signal = table.shape[1] > 1 and continues(check_finite(table, f"{file}")[:PROBED])
        if one_signal and columns is not None:
            raise _by_rows_error(file, table.shape[1], _BY_ROWS)
        if one_signal:
            notes = f"the samples are read row by row, {table.shape[1]} a row, {table.size} in all"
            return table.ravel(), name, (notes,)
        labels = [str(k + 1) for k in range(table.shape[1])]
        rises = table.shape[1] > 1 and increases(table[:PROBED])
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
        raise _not_a_row(file, name, array)
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
        text = parse_text(file, requested=[str(column) for column in columns or ()], has_samples=False)
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
    text = parse_text(file)
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
        raise DataError(f"{file} {_NO_ARRAYS}", ANY)
    if len(arrays) == 1:
        ((name, table),) = arrays.items()
        width = table.shape[1] if table.ndim == 2 and table.shape[0] > 1 else 1
        if width == 1:
            yield name or "samples", {"dt": None}
        elif _has_times(table) and table.shape[1] > 2:
            yield name or "values", {}
        else:
            rises = increases(table[:PROBED])
            for index in range(1 if rises else 0, width):
                fields = {"columns": (1, index + 1)} if rises else {"dt": None, "columns": (index + 1,)}
                yield f"column {index + 1}", fields
        return
    for name, array in arrays.items():
        is_time = bool(TIMES.fullmatch(name.rpartition(".")[2]))
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
            if not (table.shape[1] == 2 and increases(table)) and continues(table[:PROBED]):
                raise _by_rows_error(file, table.shape[1], 'dt = "0.01 s" and columns = "rows"')
            names = [str(k + 1) for k in range(table.shape[1])]
            first, second = (
                table[:, k] for k in _column_indices(file, columns, names, is_named=False, rises=increases(table))
            )
            times, values = check_finite(first, f"{file}: the times"), check_finite(second, f"{file}: the values")
            return Columns(times, values, ([], _heading(name)))
    variables = [f"{name or 'an array'} {array.shape}" for name, array in arrays.items()]
    pair = [list(arrays.items())[k] for k in _column_indices(file, columns, list(arrays), variables)]
    for name, array in pair:
        if array.size != max(array.shape, default=1):
            raise _not_a_row(file, name, array)
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
    vectors = [name for name in arrays if TIMES.fullmatch(name.rpartition(".")[2])]
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
    return increases(array if array.shape[1] == 2 else array.T)


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
    # The advice for other numbers of columns depends on what the first rows show.
    if columns is None:
        if len(names) != needed:
            is_time = bool(TIMES.fullmatch(without_unit(names[0]))) if names else False
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
    # By name, if it stands once, or by number.
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
        text = parse_text(file, known)
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
        text = parse_text(file, requested=[str(column) for column in columns or ()])
        indices = _column_indices(file, columns, text.labels, needed=count)
        return numbers_of_columns(file, text.rows, indices), [text.above(index) for index in indices]
