"""Script that copies the numeric arrays of a MAT file of version 7.3 (HDF5) to an NPZ file: HDF5 FILE OUTPUT MEMORY.

The HDF5 library can crash or loop on a damaged file, so this runs in a child process.
"""

from __future__ import annotations

import os
import sys
from importlib import import_module
from typing import Any

import numpy as np

MOST_ARRAYS, MOST_EXPANSION = 10_000, 1000
"""Limits of a file: arrays, and bytes of numbers per byte of the file."""


def copy_arrays(path: str, output: str) -> None:
    """Write all real arrays, in the order of MATLAB, with names such as struct.field."""
    h5py: Any = import_module("h5py")
    arrays: dict[str, Any] = {}
    most = MOST_EXPANSION * os.path.getsize(path)

    def visit(name: str, item: Any) -> None:
        nonlocal most
        is_own = name.startswith(("#refs#", "#subsystem#"))
        if is_own or not isinstance(item, h5py.Dataset) or item.dtype.kind not in "fiub":
            return
        if item.attrs.get("MATLAB_class") == b"char" or "MATLAB_empty" in item.attrs or item.shape is None:
            return
        most -= item.size * item.dtype.itemsize
        if most < 0 or len(arrays) >= MOST_ARRAYS:
            sys.exit("contains more numbers than a file of this size can hold")
        arrays[name.replace("/", ".")] = np.asarray(item[()], dtype=float).T

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    # The names of an NPZ file are names of files, which cannot hold all those of MATLAB.
    names = np.array(list(arrays), dtype=str)
    np.savez(output, names=names, **{f"array_{k}": array for k, array in enumerate(arrays.values())})


if __name__ == "__main__":
    from rattlebox.exchange.read.ansys_arrays import limit_memory

    limit_memory(int(sys.argv.pop()))
    try:
        copy_arrays(*sys.argv[2:4])
    except (OSError, RuntimeError, ValueError, KeyError, TypeError, MemoryError) as error:
        reason = " ".join(str(error).split())[:200]
        sys.exit(f"cannot be read as a MAT file of version 7.3: {reason}")
