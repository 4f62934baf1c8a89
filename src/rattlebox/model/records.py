"""Reads records from files: two columns, time and value."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .errors import Hint

Column = NDArray[np.float64]


def read_columns(path: str) -> tuple[Column, Column]:
    """Read time and value from a CSV, NPY or MAT file.

    Parameters
    ----------
    path
        CSV: one header line allowed, comma, semicolon or blank between columns. NPY: array (n, 2) or (2, n). MAT: variables
        `time` and `value`, or a single array (n, 2).

    Returns
    -------
    tuple of (n,) float

    Raises
    ------
    Hint
        When the file cannot be read, naming the line that is wrong.
    """
    file = Path(path)
    if not file.is_file():
        raise Hint(f"there is no file {path}")
    if file.suffix == ".npy":
        try:
            return _two_columns(np.load(file, allow_pickle=False), path)
        except (ValueError, OSError) as error:
            raise Hint(f"{path} is not a NumPy array of numbers: {error}") from None
    if file.suffix == ".mat":
        return _from_mat(path)
    return _from_csv(file)


def _two_columns(array: Column, path: str) -> tuple[Column, Column]:
    if array.ndim == 2 and array.shape[1] != 2 and array.shape[0] == 2:
        array = array.T
    if array.ndim != 2 or array.shape[1] != 2:
        raise Hint(f"{path} holds an array of shape {array.shape}; two columns are needed, time and value")
    return array[:, 0].astype(float), array[:, 1].astype(float)


def _from_mat(path: str) -> tuple[Column, Column]:
    from scipy.io import loadmat

    try:
        content = {k: v for k, v in loadmat(path).items() if not k.startswith("__")}
    except Exception as error:
        raise Hint(f"{path} cannot be read as a MAT file (version 7 or earlier): {error}") from None
    if {"time", "value"} <= set(content):
        return content["time"].ravel().astype(float), content["value"].ravel().astype(float)
    if len(content) == 1:
        return _two_columns(next(iter(content.values())), path)
    raise Hint(
        f"{path} holds {', '.join(content)}; variables 'time' and 'value' are needed, or one array of two columns"
    )


def _from_csv(file: Path) -> tuple[Column, Column]:
    rows: list[tuple[float, float]] = []
    try:
        lines = file.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise Hint(f"{file} is not text") from None
    for number, line in enumerate(lines, start=1):
        cells = line.replace(";", ",").replace("\t", ",").split(",") if any(c in line for c in ";,\t") else line.split()
        cells = [cell.strip() for cell in cells if cell.strip()]
        if not cells or line.lstrip().startswith("#"):
            continue
        try:
            values = [float(cell) for cell in cells]
        except ValueError:
            if not rows and number == 1:
                continue
            raise Hint(f"{file}, line {number}: {line.strip()!r} is not two numbers") from None
        if len(values) != 2:
            raise Hint(f"{file}, line {number}: {len(values)} numbers, two are needed (time, value)")
        if not all(np.isfinite(values)):
            raise Hint(f"{file}, line {number}: {line.strip()!r} is not finite")
        rows.append((values[0], values[1]))
    if not rows:
        raise Hint(f"{file} holds no numbers")
    array = np.array(rows)
    return array[:, 0], array[:, 1]
