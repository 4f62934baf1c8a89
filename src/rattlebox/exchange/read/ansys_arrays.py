"""Script that copies the arrays of an Ansys file to a NPZ file: python -P ansys_arrays.py rst|full FILE OUTPUT MEMORY.

It runs in a separate process (`guarded.py`), because the C code of the reader does not check the pointers in a file and
crashes on wrong ones, or asks for any amount of memory.
"""

from __future__ import annotations

import sys
import warnings
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from pathlib import Path
from typing import Any

import numpy as np

_FORMATS = {"rst": 12, "full": 4}
_FOR_PICTURES = ("pyvista", "vtkmodules", "matplotlib", "tqdm", "scooby")
"""Libraries that the reader imports, but needs for pictures only; they take seconds to load."""
_READERS = ("ansys.mapdl.reader", *(f"ansys.mapdl.reader.{name}" for name in ("full", "rst", "dis_result")))


class _Anything(type):
    """Metaclass of a class that has every attribute, the class itself, but none that Python looks for."""

    def __getattr__(cls, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return cls


class _Unused(metaclass=_Anything):
    """Every class, function and setting of a library for pictures."""


class _Placeholders(MetaPathFinder, Loader):
    """Importer of modules without content in place of libraries for pictures."""

    def find_spec(self, name: str, *_: Any) -> ModuleSpec | None:
        return ModuleSpec(name, self, is_package=True) if name.partition(".")[0] in _FOR_PICTURES else None

    def exec_module(self, module: Any) -> None:
        module.__getattr__ = lambda _: _Unused


def _import_reader() -> Any:
    """Return the reader; without the libraries for pictures, unless this version of it uses one when it is imported."""
    before = set(sys.modules)
    placeholders = _Placeholders()
    sys.meta_path.insert(0, placeholders)
    try:
        for name in _READERS:  # it imports them when it reads a file
            import_module(name)
    except Exception:
        for name in sys.modules.keys() - before:
            del sys.modules[name]
    sys.meta_path.remove(placeholders)
    return import_module(_READERS[0])


def copy_arrays(kind: str, path: str, output: str) -> None:
    """Write the arrays of a file to a NPZ file."""
    reader = _import_reader()
    try:
        file_format = int(reader.common.read_standard_header(path)["file format"])
        if file_format != _FORMATS[kind]:
            sys.exit(f"is not a .{kind} file; its format is {file_format}")
        file = reader.read_binary(path, **({"flag_vtk_parse": False, "ignore_cyclic": True} if kind == "rst" else {}))
        arrays = _result(file, path) if kind == "rst" else _matrices(file, path)
    except MemoryError:
        sys.exit(f"cannot be read as .{kind}: it asks for more memory than its size allows; it may be damaged")
    except Exception as error:
        sys.exit(f"cannot be read as .{kind}: {' '.join(str(error).split()) or type(error).__name__}")
    np.savez(output, **arrays)


def _check_size(path: str, words: int) -> None:
    """Exit if a file is shorter than its header states."""
    size = Path(path).stat().st_size
    if size < 4 * words:
        sys.exit(f"has {size} bytes, but its header states {4 * words}")


def _result(file: Any, path: str) -> dict[str, Any]:
    """Return kind of analysis, number of sectors, units, frequencies, nodes and shapes (m, n, components)."""
    header = file._resultheader
    _check_size(path, int(header["ptrend"]))
    arrays: dict[str, Any] = {
        "analysis": int(header["kan"]),
        "sectors": int(header["nSector"]),
        "units": str(header["units"]),
    }
    if arrays["analysis"] != 2 or arrays["sectors"] > 1:
        return arrays
    solutions = [file.nodal_solution(k) for k in range(int(file.n_results))]
    shapes = np.array([np.asarray(values, dtype=float) for _, values in solutions])
    return {**arrays, "frequencies": file.time_values, "nodes": solutions[0][0], "shapes": shapes}


def _read_fixed(supports: Any) -> Any:
    """Return node and axis of each fixed degree of freedom, (n, 2 or more)."""
    return np.asarray(supports, dtype=int).reshape(len(supports), -1) if len(supports) else np.zeros((0, 2), dtype=int)


def _matrices(file: Any, path: str) -> dict[str, Any]:
    """Return the upper triangles of K and M, the node and axis of each row, and those that are fixed."""
    _check_size(path, int(file._header["ptrEND"]))
    if not int(file._header["ntermMl"]):
        sys.exit("contains no mass matrix")
    rows, stiffness, mass = file.load_km(sort=False)
    arrays = {"rows": rows, "fixed": _read_fixed(file.const)}
    for name, matrix in (("K", stiffness), ("M", mass)):
        entries = matrix.tocoo()
        arrays |= {f"{name}_row": entries.row, f"{name}_column": entries.col, f"{name}_value": entries.data}
    return arrays


def limit_memory(size: int) -> None:
    """Limit the memory of this process [bytes], where the system can do it."""
    try:
        resource: Any = import_module("resource")
        resource.setrlimit(resource.RLIMIT_AS, (size, size))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    except (ImportError, OSError, ValueError):
        pass  # Windows, or a lower limit that is set already


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    limit_memory(int(sys.argv.pop()))
    copy_arrays(*sys.argv[1:])
