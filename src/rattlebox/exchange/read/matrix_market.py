"""Matrices in Matrix Market files, .mtx."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from rattlebox._util.exceptions import DataError

from .modes_in_file import FloatArray, read_start

MOST = 3000
"""Most degrees of freedom of a matrix that is read in full."""


def read_matrix(path: Path) -> FloatArray:
    """Read a square real matrix.

    Parameters
    ----------
    path
        An existing file in Matrix Market format, with coordinates or as an array, general or symmetric.

    Returns
    -------
    (n, n) float
        The whole matrix.

    Raises
    ------
    DataError
        If the file is damaged, or the matrix is complex, not square, not finite or too large.
    """
    from scipy.io import mminfo, mmread

    if not read_start(path, 32).startswith(b"%%MatrixMarket"):
        raise DataError(f"{path} does not begin with %%MatrixMarket", "scipy.io.mmwrite('K.mtx', K)")
    try:
        rows, columns, _, _, kind, _ = mminfo(str(path))
        if kind == "complex":
            raise DataError(f"{path} holds complex numbers", "a real matrix")
        if rows != columns:
            raise DataError(f"{path} holds a matrix of {rows} rows and {columns} columns; it must be square")
        if rows > MOST:
            raise DataError(
                f"{path} holds {rows} degrees of freedom; at most {MOST} are read in full",
                "modes of the finite element program, or a Craig-Bampton reduction",
            )
        found: Any = mmread(str(path))
    except DataError:
        raise
    except Exception as error:
        raise DataError(f"{path} cannot be read: {error}", "the whole file") from None
    matrix = np.asarray(found.toarray() if hasattr(found, "toarray") else found, dtype=float)
    if not np.isfinite(matrix).all():
        raise DataError(f"{path} holds numbers that are not finite")
    return matrix
