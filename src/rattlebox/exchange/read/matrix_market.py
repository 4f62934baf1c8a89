"""Matrices in files of the Matrix Market format, .mtx.

SciPy's reader is faster, but its compiled code crashes on a zero byte; these matrices are small.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from rattlebox._util.exceptions import DataError

from .guarded import errors_of
from .modes_in_file import FloatArray, read_start

MOST = 3000
"""Largest number of degrees of freedom of a matrix."""

_FORMATS, _FIELDS = ("coordinate", "array"), ("real", "double", "integer")
_SYMMETRIES = ("general", "symmetric", "hermitian")
_NO_NUMBER = re.compile(rb"[^-+.\dEe\s]")
_LINES = 100_000  # that are converted at once
_WHOLE = "the complete file"


def read_matrix(path: Path) -> FloatArray:
    """Read a square real matrix.

    Returns the matrix, dense, (n, n).

    References
    ----------
    R. F. Boisvert, R. Pozo, K. A. Remington (1996), The Matrix Market Exchange Formats: Initial Design, NISTIR 5935.
    """
    if not read_start(path, 32).startswith(b"%%MatrixMarket"):
        raise DataError(f"{path} does not begin with %%MatrixMarket", "scipy.io.mmwrite('K.mtx', K)")
    with errors_of(path, "a Matrix Market file"):
        banner, _, rest = path.read_bytes().partition(b"\n")
        is_sparse, is_symmetric = _kind(path, banner.decode("latin-1"))
        lines = [line for line in rest.splitlines() if line.strip() and not line.lstrip().startswith(b"%")]
        n, stated = _size(path, lines[0] if lines else b"", is_sparse, is_symmetric)
        numbers = _numbers(path, lines[1:])
        width = 3 if is_sparse else 1
        if numbers.size != width * stated:
            raise DataError(f"{path} states {stated} entries, but contains {numbers.size / width:.6g}", _WHOLE)
        if not np.isfinite(numbers).all():
            raise DataError(f"{path} contains numbers that are not finite", "the file as the program wrote it")
        return _sparse(path, numbers.reshape(-1, 3), n, is_symmetric) if is_sparse else _full(numbers, n, is_symmetric)


def _kind(path: Path, banner: str) -> tuple[bool, bool]:
    """Return whether a matrix is sparse, and whether its file has one triangle."""
    words = banner.lower().split()
    if len(words) != 5 or words[1] != "matrix" or words[2] not in _FORMATS:
        raise DataError(f"{path}: the first line, {banner.strip()[:60]!r}, is no heading of a matrix", _WHOLE)
    if words[3] == "complex":
        raise DataError(f"{path} contains complex numbers", "a real matrix")
    if words[3] not in _FIELDS or words[4] not in _SYMMETRIES:
        raise DataError(
            f"{path} contains a {words[4]} matrix of the field {words[3]}", "a real matrix, general or symmetric"
        )
    return words[2] == "coordinate", words[4] != "general"


def _size(path: Path, line: bytes, is_sparse: bool, is_symmetric: bool) -> tuple[int, int]:
    """Return the number of rows, and the number of entries that follow."""
    words = line.split()
    if len(words) != 2 + is_sparse or not all(word.isdigit() and len(word) < 10 for word in words):
        raise DataError(f"{path} does not state its size in whole numbers: {line[:60].decode('latin-1')!r}", _WHOLE)
    rows, columns, *count = map(int, words)
    if rows != columns:
        raise DataError(
            f"{path} contains a matrix of {rows} rows and {columns} columns; it must be square",
            "the files of M, C and K, each with a row and a column for each degree of freedom",
        )
    if rows > MOST:
        raise DataError(
            f"{path} has {rows} degrees of freedom; at most {MOST} are allowed",
            "modes of the finite-element program, or a Craig-Bampton reduction",
        )
    return rows, count[0] if is_sparse else rows * (rows + 1) // 2 if is_symmetric else rows * rows


def _numbers(path: Path, lines: list[bytes]) -> FloatArray:
    """Return all numbers of lines."""
    parts = [np.empty(0)]
    for first in range(0, len(lines), _LINES):
        text = b" ".join(lines[first : first + _LINES]).replace(b"D", b"E").replace(b"d", b"e")
        words = text.split()
        if _NO_NUMBER.search(text):  # Python would read 1_000, and SciPy crashes on a zero byte
            wrong = next(word for word in words if _NO_NUMBER.search(word))
            not_finite = wrong.lower().lstrip(b"+-") in (b"nan", b"inf", b"infinity")
            fault = "not finite" if not_finite else "not a number"
            raise DataError(f"{path} contains {wrong[:40].decode('latin-1')!r}, which is {fault}", _WHOLE)
        parts.append(np.array(words, dtype=float))
    return np.concatenate(parts)


def _sparse(path: Path, entries: FloatArray, n: int, is_symmetric: bool) -> FloatArray:
    """Return the matrix of rows of row number, column number and value."""
    places = entries[:, :2]
    if np.any((places != np.round(places)) | (places < 1) | (places > n)):
        raise DataError(f"{path} contains an entry outside of its {n} rows and columns", _WHOLE)
    rows, columns = places.astype(int).T - 1
    if is_symmetric and np.any(rows < columns) and np.any(rows > columns):
        raise DataError(
            f"{path} is symmetric, but contains entries on both sides of the diagonal", "its lower triangle"
        )
    matrix = np.zeros((n, n))
    np.add.at(matrix, (rows, columns), entries[:, 2])
    return matrix + matrix.T - np.diag(matrix.diagonal()) if is_symmetric else matrix


def _full(numbers: FloatArray, n: int, is_symmetric: bool) -> FloatArray:
    """Return the matrix of numbers column by column; the lower triangle if it is symmetric."""
    if not is_symmetric:
        return numbers.reshape(n, n).T.copy()
    matrix = np.zeros((n, n))
    rows, columns = np.triu_indices(n)  # row by row of the upper triangle: column by column of the lower one
    matrix[rows, columns] = matrix[columns, rows] = numbers
    return matrix
