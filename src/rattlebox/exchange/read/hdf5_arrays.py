"""Script that copies arrays of a HDF5 file to an NPZ file: mat|h5 FILE OUTPUT MEMORY.

"mat" copies all arrays of a MAT file of version 7.3, "h5" the columns of the tables of modes of Nastran. The HDF5 library
can crash or loop on a damaged file, so this runs in a child process.
"""

from __future__ import annotations

import os
import sys
from importlib import import_module
from typing import Any

import numpy as np

MOST_ARRAYS, MOST_EXPANSION = 10_000, 1000
"""Limits of a file: arrays, and bytes of numbers per byte of the file."""

_COLUMNS = {
    "RESULT/DOMAINS": ("ID", "SUBCASE", "STEP", "ANALYSIS", "MODE", "DESIGN_CYCLE", "SE", "AFPM", "TRMC", "MODULE"),
    "RESULT/SUMMARY/EIGENVALUE": ("MODE", "EIGEN", "MASS"),
    "RESULT/NODAL/EIGENVECTOR": ("ID", "X", "Y", "Z", "DOMAIN_ID"),
    "INPUT/NODE/GRID": ("ID", "CP", "X", "CD"),
    **{
        f"INPUT/COORDINATE_SYSTEM/CORD2{kind}": ("CID", "RID", "A1", "A2", "A3", "B1", "B2", "B3", "C1", "C2", "C3")
        for kind in "RCS"
    },
}
"""Tables of modes of Nastran in the group NASTRAN, and their columns."""


class _Limit:
    """Limit of the numbers that are read from a file."""

    def __init__(self, path: str) -> None:
        self.left = MOST_EXPANSION * os.path.getsize(path)

    def take(self, dataset: Any) -> None:
        self.left -= dataset.size * dataset.dtype.itemsize
        if self.left < 0:
            sys.exit("contains more numbers than a file of this size can hold")


def _arrays_of_mat(h5py: Any, file: Any, limit: _Limit) -> dict[str, Any]:
    """Return all real arrays, in the order of MATLAB, with names such as struct.field."""
    arrays: dict[str, Any] = {}

    def visit(name: str, item: Any) -> None:
        is_own = name.startswith(("#refs#", "#subsystem#"))
        if is_own or not isinstance(item, h5py.Dataset) or item.dtype.kind not in "fiub":
            return
        if item.attrs.get("MATLAB_class") == b"char" or "MATLAB_empty" in item.attrs or item.shape is None:
            return
        limit.take(item)
        if len(arrays) >= MOST_ARRAYS:
            sys.exit("contains more numbers than a file of this size can hold")
        arrays[name.replace("/", ".")] = np.asarray(item[()], dtype=float).T

    file.visititems(visit)
    return arrays


def _tables_of_nastran(h5py: Any, file: Any, limit: _Limit) -> dict[str, Any]:
    """Return columns of tables, such as INPUT/NODE/GRID.ID, and empty arrays for other results of nodes.

    A file without the group NASTRAN gives empty arrays for its content, such as /time.
    """
    arrays: dict[str, Any] = {}
    root = file.get("NASTRAN")
    if not isinstance(root, h5py.Group):
        return {f"/{name}": np.zeros(0) for name in list(file)[:40]}
    nodal = root.get("RESULT/NODAL")
    if isinstance(nodal, h5py.Group):
        arrays = {f"RESULT/NODAL/{name}": np.zeros(0) for name in list(nodal)[:40]}
    for table, columns in _COLUMNS.items():
        item = root.get(table)
        if not isinstance(item, h5py.Dataset) or item.dtype.names is None or len(item.shape) != 1:
            continue
        limit.take(item)
        rows = item[()]
        for column in columns:
            if column in rows.dtype.names and rows[column].dtype.kind in "fiu":
                arrays[f"{table}.{column}"] = rows[column]
    return arrays


_READERS = {
    "mat": ("a MAT file of version 7.3", _arrays_of_mat),
    "h5": ("a HDF5 result of Nastran", _tables_of_nastran),
}


def copy_arrays(kind: str, path: str, output: str) -> None:
    """Write the arrays of a file to a NPZ file."""
    h5py: Any = import_module("h5py")
    with h5py.File(path, "r") as file:
        arrays = _READERS[kind][1](h5py, file, _Limit(path))
    # The names of an NPZ file are names of files, which cannot hold all those of MATLAB.
    names = np.array(list(arrays), dtype=str)
    np.savez(output, names=names, **{f"array_{k}": array for k, array in enumerate(arrays.values())})


if __name__ == "__main__":
    from rattlebox.exchange.read.ansys_arrays import limit_memory

    limit_memory(int(sys.argv.pop()))
    try:
        copy_arrays(*sys.argv[1:4])
    except (OSError, RuntimeError, ValueError, KeyError, TypeError, MemoryError) as error:
        reason = " ".join(str(error).split())[:200]
        sys.exit(f"cannot be read as {_READERS[sys.argv[1]][0]}: {reason}")
