"""Rows of numbers in a text file, read quickly by NumPy where all are alike, or line by line to name the one at fault."""

from __future__ import annotations

import csv
import io
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice, takewhile
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np

from rattlebox._util.exceptions import DataError, unreadable
from rattlebox._util.text_tables import Dialect, decode, dialect_of, has_point
from rattlebox.exchange.read.sheets import SHEETS, sheet_lines

from .errors import several
from .files import Array

_HEAD, _TAIL = 1 << 16, 1 << 14
"""Bytes at the beginning and at the end of a large file that are read line by line."""


class Row(NamedTuple):
    """A line of text with its number, its cells, and its content without comment mark."""

    number: int
    cells: list[str]
    is_comment: bool
    content: str


@dataclass(frozen=True, eq=False)
class Rows:
    """Rows of data: those in the head of a file as text, the numbers of those below, and the last row of the file as text.

    A file that is read line by line has all rows in its head.
    """

    head: list[Row]
    below: Array  # (m, width), finite
    last: list[Row]

    def __len__(self) -> int:
        return len(self.head) + len(self.below) + len(self.last)

    def __iter__(self) -> Iterator[Row]:
        yield from self.head
        yield from self.last

    @property
    def end(self) -> Row:
        """The last row, which may be shorter."""
        return (self.last or self.head)[-1]

    @property
    def width(self) -> int:
        """Number of columns."""
        return len(self.head[0].cells)

    @property
    def cells(self) -> int:
        """Number of all cells."""
        return self.below.size + sum(len(row.cells) for row in self)

    def numbers(self, indices: Sequence[int]) -> Array:
        """Return the numbers of some columns, without rows that have another width; raise ValueError for other text."""
        parts = [
            np.array([[float(row.cells[k]) for k in indices] for row in rows if len(row.cells) == self.width])
            for rows in (self.head, self.last)
        ]
        first, end = (part.reshape(-1, len(indices)) for part in parts)
        if not len(self.below):
            return first
        below = (
            self.below if len(indices) == self.below.shape[1] and indices == sorted(indices) else self.below[:, indices]
        )
        return np.concatenate([first, below, end])


def numbers_by_rows(file: Path, rows: Rows) -> Array:
    """Return all numbers row by row; the last row may be shorter."""
    parts = [rows]
    if len(rows) > 1 and len(rows.end.cells) < rows.width:
        full = Rows(rows.head if rows.last else rows.head[:-1], rows.below, [])
        parts = [full, Rows([rows.end], np.empty((0, 0)), [])]
    return np.concatenate([numbers_of_columns(file, part, list(range(part.width))).ravel() for part in parts])


def numbers_of_columns(file: Path, rows: Rows, indices: list[int]) -> Array:
    """Return the numbers of some columns; raise an error that names the first line that is not a row of numbers."""
    try:
        numbers = rows.numbers(indices)
    except ValueError:
        raise _bad_row(file, list(rows), indices) from None
    if len(numbers) < len(rows) or not np.isfinite(numbers).all():
        raise _bad_row(file, list(rows), indices)
    return numbers


def _bad_row(file: Path, lines: list[Row], indices: list[int]) -> DataError:
    """Return the error of the first line that is not a row of numbers."""
    width = len(lines[0].cells)
    for number, cells, _, _ in lines:
        if len(cells) != width:
            advice = "the whole file, if its last line is cut short"
            return DataError(
                f"{file}, line {number}: {several(len(cells), 'column')}, but {width} in line {lines[0].number}",
                advice
                if number == lines[-1].number and len(cells) < width
                else "as many cells in each line of numbers",
            )
        row = [cells[k] for k in indices]
        bad = next((cell for cell in row if not is_number(cell)), None)
        if bad is not None:
            is_decimal_comma = is_number(with_decimal_point(bad))
            advice = "a decimal point, not a comma" if is_decimal_comma else "a number, or # before lines of text"
            return DataError(f"{file}, line {number}: {bad!r} is not a number", advice)
        if not np.isfinite([float(cell) for cell in row]).all():
            return DataError(f"{file}, line {number}: {', '.join(row)} is not finite", "finite numbers in all lines")
    raise AssertionError("all lines are rows of numbers")


def is_of_numbers(rows: Rows) -> bool:
    """Return whether all rows are of numbers, and the last one at most is shorter than the others."""
    same = all(len(row.cells) == rows.width for row in rows.head)
    if not same or rows.below.shape[1] != rows.width or len(rows.end.cells) > rows.width:
        return False
    try:
        return bool(np.isfinite([float(cell) for row in rows for cell in row.cells]).all())
    except ValueError:
        return False


def read_quickly(file: Path) -> tuple[list[Row], Array, list[Row], Dialect] | None:
    """Return the first lines of a large file, the numbers of the rows below, and the last row; None for other content."""
    try:
        with _open(file) as stream:
            # Both ends are read as lines of text: they show delimiter, names and units, and where the file is cut short.
            start = stream.read(_HEAD)
            rows_start, size = start.rfind(b"\n") + 1, stream.seek(0, io.SEEK_END)
            stream.seek(max(rows_start, size - _TAIL))
            tail = stream.read()
            cut = tail.rstrip().rfind(b"\n") + 1
            ending = tail[tail.find(b"\n") + 1 :].rstrip().decode().splitlines()
            above = start[:rows_start].decode("utf-8-sig").splitlines()
            if size <= len(start) or len(ending) < 4 or len(above) != start.count(b"\n"):
                return None
            dialect = dialect_of(ending, b'"' in start or b'"' in tail)
            if dialect.has_comma and dialect.quoted:
                return None
            # Between them only rows of numbers are expected; anything else raises.
            stream.seek(rows_start)
            between = 0
            for block in iter(lambda: stream.read(1 << 20), b""):
                between += block.count(b"\n")
                if dialect.has_comma and b"." in block:
                    return None
            between -= tail[cut:].count(b"\n")
            stream.seek(rows_start)
            with io.TextIOWrapper(stream, "utf-8", newline="\n") as lines, warnings.catch_warnings():
                warnings.simplefilter("error", UserWarning)  # no data
                rows = islice(lines, between)
                below = np.loadtxt(
                    rows if dialect.is_plain else _plain_rows(rows, dialect),
                    delimiter=dialect.delimiter,
                    comments=None,
                    quotechar='"' if dialect.quoted and dialect.delimiter else None,
                    ndmin=2,
                )
        head = _as_rows(file, above, dialect)
        last = [row._replace(number=len(above) + between + 1) for row in _as_rows(file, ending[-1:], dialect)]
    except (ValueError, OSError, Warning):
        return None
    is_data = head and last and not last[0].is_comment
    return (head, below, last, dialect) if is_data and np.isfinite(below).all() else None


def _plain_rows(lines: Iterator[str], dialect: Dialect) -> Iterator[str]:
    """Yield lines of numbers as `numpy.loadtxt` reads them."""
    # Thousands of lines are rewritten at once: one by one, a file with decimal commas takes three times as long.
    while block := "".join(islice(lines, 4096)):
        yield from dialect.plain(block).removesuffix("\n").split("\n")


def _open(file: Path) -> BinaryIO:
    """Return the text of a file as a stream in UTF-8."""
    stream = file.open("rb")
    start = stream.read(_HEAD)
    stream.seek(0)
    try:
        start[: start.rfind(b"\n") + 1].decode()
        is_ready = b"\0" not in start
    except UnicodeDecodeError:
        is_ready = False
    if is_ready:
        return stream
    with stream:
        return io.BytesIO(_decoded(file, stream.read()).encode())


def _decoded(file: Path, content: bytes) -> str:
    text = decode(content)
    if text is None:
        raise DataError(f"{file} is not text", "CSV, or a file that ends in .npy, .npz or .mat")
    return text[0]


def split_lines(file: Path) -> tuple[list[Row], Dialect]:
    """Return the lines that are not empty, and how they are written."""
    try:
        is_sheet = file.suffix.lower() in SHEETS
        text = sheet_lines(file) if is_sheet else _decoded(file, file.read_bytes()).splitlines()
    except OSError as error:
        raise unreadable(file, error) from None
    dialect = dialect_of(text, any('"' in line for line in text))
    return _as_rows(file, text, dialect), dialect


def _as_rows(file: Path, text: Sequence[str], dialect: Dialect) -> list[Row]:
    """Return the lines that are not empty, with their cells."""
    lines = []
    delimiter = dialect.delimiter
    for number, line in enumerate(text, start=1):
        is_comment = line.lstrip()[:1] in ("#", "%")
        content = line.lstrip("#% \t") if is_comment and delimiter != "\t" else line.strip(" ").lstrip("#%")
        content = dialect.parts(content)
        try:
            if dialect.quoted and delimiter is not None:
                cells = next(csv.reader([content], delimiter=delimiter), [])
            else:
                cells = content.split(delimiter)
        except csv.Error as error:
            raise DataError(f"{file}, line {number}: {error}", "numbers and names of usual lengths") from None
        cells = [cell.strip() for cell in cells]
        while cells and not cells[-1]:
            cells.pop()
        if not dialect.is_plain:
            plain = [dialect.number(cell) for cell in cells]
            if dialect.has_comma and not is_comment and has_point(cells) and all(map(is_number, plain)):
                raise DataError(
                    f"{file}, line {number}: {content.strip()[:60]!r} has a decimal point, but other lines decimal commas",
                    "the same decimal mark in all lines",
                )
            cells = plain
        if cells:
            lines.append(Row(number, cells, is_comment, content))
    return lines


def empty_at_end(row: Row, dialect: Dialect) -> int:
    """Return the number of empty cells at the end of a line, which are not among its cells."""
    if dialect.delimiter is None:
        return 0
    return sum(1 for _ in takewhile(lambda cell: not cell.strip(), reversed(row.content.split(dialect.delimiter))))


def is_number(cell: str) -> bool:
    """Return whether a cell is a number as Python writes it."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def with_decimal_point(cell: str) -> str:
    """Return the cell with a point in place of a decimal comma."""
    return cell.replace(",", ".", 1)
