"""Spellings of tables of text: encodings, delimiters, decimal commas, exponents of Fortran and complex numbers."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

_REAL = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_COMMA = re.compile(r"[-+]?\d*,\d+(?:[eEdD][-+]?\d+)?")
_POINT = re.compile(r"[-+]?\d*\.\d*(?:[eEdD][-+]?\d+)?")
_WHOLE = re.compile(r"[-+]?\d+")
_FORTRAN = re.compile(r"([-+]?(?:\d+[.,]\d*|\.\d+))[dD]([-+]?\d{1,3})|([-+]?\d+)[dD]([-+]\d{1,3})")
_COMPLEX = re.compile(rf"\(?(?<![\w.])({_REAL})([-+])(?=[-+]?[\d.])({_REAL})[ij]\)?(?![\w.])")
"""Complex numbers of numpy.savetxt, "(1.5e+00+-2.0e-01j)", and of others, "1.5-0.2i"."""
_CONTROLS = re.compile(rb"[\x00-\x08\x0e-\x1a\x1c-\x1f\x7f]")
_NO_TEXT = re.compile(r"[\x00-\x08\x0e-\x19]")
_PAIR = re.compile(r"(\d*),(\d+)")
_LINES = 3  # last lines of data that show delimiter and decimal mark; the very last may be cut short


def decode(content: bytes) -> tuple[str, str] | None:
    """Return text and its encoding, UTF-8, UTF-16 or that of Windows in western Europe; None for binary content."""
    start = content[:400]
    if start[:2] in (b"\xff\xfe", b"\xfe\xff"):
        encoding = "utf-16"
    elif len(start) > 3 and start.count(0) >= 0.4 * len(start):  # no byte order mark: ASCII has each second byte zero
        encoding = "utf-16-le" if start[1::2].count(0) > start[::2].count(0) else "utf-16-be"
    else:
        encoding = "utf-8-sig"
    for name in dict.fromkeys((encoding, "cp1252", "latin-1")):
        if name in ("cp1252", "latin-1") and (encoding != "utf-8-sig" or _CONTROLS.search(content)):
            return None
        try:
            text = content.decode(name)
        except UnicodeError:
            continue
        # Zeros of numbers in a binary file look like those of UTF-16.
        return None if encoding != "utf-8-sig" and _NO_TEXT.search(text) else (text, name)
    return None


@dataclass(frozen=True)
class Dialect:
    """How the rows of a table of text are written."""

    delimiter: str | None  # Character between columns; None for blanks
    # Whether numbers have a decimal comma, an exponent such as D-03, or a real and an imaginary part
    has_comma: bool = False
    has_fortran: bool = False
    has_complex: bool = False
    quoted: bool = False  # Whether cells may be in quotation marks

    @property
    def is_plain(self) -> bool:
        """Whether all numbers are written as Python reads them."""
        return not (self.has_comma or self.has_fortran or self.has_complex)

    def number(self, cell: str) -> str:
        """Return a cell as Python writes numbers; other text is returned unchanged."""
        if self.has_comma and _COMMA.fullmatch(cell):
            cell = cell.replace(",", ".")
        if self.has_fortran and (match := _FORTRAN.fullmatch(cell)):
            return f"{match[1] or match[3]}E{match[2] or match[4]}"
        return cell

    def parts(self, line: str) -> str:
        """Return a line, or several, with two cells, real and imaginary part, in place of each complex number."""
        if not self.has_complex:
            return line
        mark = self.delimiter or " "
        # "+-2" is -2, and "--2" is 2.
        return _COMPLEX.sub(
            lambda match: (
                match[1]
                + mark
                + (match[3] if match[2] == "+" else match[3][1:] if match[3][0] == "-" else f"-{match[3].lstrip('+')}")
            ),
            line,
        )

    def plain(self, lines: str) -> str:
        """Return lines of numbers only, as `numpy.loadtxt` reads them."""
        lines = self.parts(lines)
        return lines.translate(_PLAIN) if self.has_comma else lines.translate(_EXPONENTS) if self.has_fortran else lines

    def note(self) -> str:
        """Return a note on a reading that is an assumption; "" for others."""
        return "the comma is read as the decimal mark" if self.has_comma else ""


_EXPONENTS = str.maketrans("dD", "eE")
_PLAIN = str.maketrans("dD,", "eE.")


def dialect_of(text: Sequence[str], quoted: bool) -> Dialect:
    """Return the dialect of the last lines of data."""
    data = [line for line in text if line.strip() and line.lstrip()[0] not in "#%"][-_LINES:]
    has_complex = 2 * sum(bool(_COMPLEX.search(line)) for line in data) >= max(1, len(data))
    delimiter = next((mark for mark in ";\t," if 2 * sum(mark in line for line in data) >= max(1, len(data))), None)
    dialect = Dialect(delimiter, has_complex=has_complex, quoted=quoted)
    lines = [dialect.parts(line) for line in data]
    # Blanks between numbers with decimal commas: "0,001  0,2".
    if delimiter == "," and not quoted:
        words = [line.split() for line in lines]
        if all(len(row) > 1 and all(_COMMA.fullmatch(word) or _WHOLE.fullmatch(word) for word in row) for row in words):
            dialect = replace(dialect, delimiter=None)
    cells = [cell.strip(' "') for line in lines for cell in _split(line, dialect)]
    commas = sum(bool(_COMMA.fullmatch(cell)) for cell in cells)
    return replace(
        dialect,
        has_comma=commas > 0 and not any(_POINT.fullmatch(cell) for cell in cells if len(cell) > 1),
        has_fortran=any(_FORTRAN.fullmatch(cell) for cell in cells),
    )


def _split(line: str, dialect: Dialect) -> list[str]:
    """Return the cells of a line, with quotation marks."""
    if dialect.delimiter == "," and dialect.quoted:
        return re.findall(r'"[^"]*"|[^,"]+', line)
    return line.split(dialect.delimiter)


def has_point(cells: Sequence[str]) -> bool:
    """Return whether one of the cells is a number with a decimal point."""
    return any(len(cell) > 1 and _POINT.fullmatch(cell) for cell in cells)


def may_separate_thousands(lines: Iterable[str]) -> bool:
    """Return whether the commas in rows of numbers may separate thousands, as in "1,250", instead of decimals."""
    pairs = (pair for line in lines for pair in _PAIR.findall(line))
    return all(len(end) == 3 and 0 < len(start) < 4 and start[0] != "0" for start, end in pairs)


def comma_is_both(rows: Sequence[Sequence[str]], headings: Sequence[Sequence[str]]) -> bool:
    """Return whether the comma seems to be separator and decimal mark at once, as in "0,000,0,15"."""
    width = len(rows[0]) if rows else 1
    if width % 2 or any(len(row) != width for row in rows[:-1]):
        return False
    full = [row for row in rows if len(row) == width]
    halves = [(row[k], row[k + 1]) for row in full for k in range(0, width, 2)]
    if not all(_WHOLE.fullmatch(one) and re.fullmatch(r"\d+(?:[eE][-+]?\d+)?", other) for one, other in halves):
        return False
    return any(len(other) > 1 and other[0] == "0" for _, other in halves) or any(
        len(cells) == width // 2 and not any(map(_WHOLE.fullmatch, cells)) for cells in headings
    )
