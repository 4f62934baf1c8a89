"""Matrices in files of the Matrix Market format, .mtx."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from rattlebox._util.exceptions import DataError

from .modes_in_file import FloatArray, read_start

MOST = 3000
"""Largest number of degrees of freedom of a matrix."""


def read_matrix(path: Path) -> FloatArray:
    """Read a square real matrix.

    Parameters
    ----------
    path
        An existing file in Matrix Market format, with coordinates or as an array, general or symmetric.

    Returns
    -------
    (n, n) float
        The matrix, dense.

    Raises
    ------
    DataError
        If the file is damaged, or the matrix is complex, not square, not finite or too large.

    References
    ----------
    R. F. Boisvert, R. Pozo, K. A. Remington (1996), The Matrix Market Exchange Formats: Initial Design, NISTIR 5935.
    """
    from scipy.io import mminfo, mmread

    if not read_start(path, 32).startswith(b"%%MatrixMarket"):
        raise DataError(f"{path} does not begin with %%MatrixMarket", "scipy.io.mmwrite('K.mtx', K)")
    try:
        rows, columns, _, _, kind, _ = mminfo(str(path))
        if kind == "complex":
            raise DataError(f"{path} contains complex numbers", "a real matrix")
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
        content: Any = mmread(str(path))
    except DataError:
        raise
    except Exception as error:
        raise DataError(f"{path} cannot be read: {error}", "the complete file") from None
    matrix = np.asarray(content.toarray() if hasattr(content, "toarray") else content, dtype=float)
    if not np.isfinite(matrix).all():
        raise DataError(f"{path} contains numbers that are not finite", "the file as the program wrote it")
    return matrix
