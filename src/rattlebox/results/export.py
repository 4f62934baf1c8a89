"""Export of runs to MATLAB and CSV files."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import asdict
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.atomic_io import atomic_write, check_suffix, disk_errors, require_folder
from rattlebox._util.exceptions import DataError
from rattlebox._util.own_files import claim, list_files
from rattlebox._util.owned_folder import digest_of

from .datasets import parts
from .schema import groups

if TYPE_CHECKING:
    from .record import Record

_DISK_HINT = "free disk space and write the file again"


def as_cells(texts: Iterable[object]) -> NDArray[np.object_]:
    """Return texts as a column of cells of a MATLAB file."""
    values = [str(text) for text in texts]
    cells = np.empty((len(values), 1), dtype=object)
    cells[:, 0] = values
    return cells


def as_column(values: NDArray[Any]) -> NDArray[Any]:
    """Return a vector, also an empty one, as a column, and other arrays as they are."""
    return values[:, None] if values.ndim == 1 else values


def to_mat(run: Record, path: Path) -> Path:
    """Write a MATLAB file (version 5, up to 2 GB a variable).

    It holds a struct for each dataset of the run, such as `motion`, with a field for each variable and coordinate,
    `units` with the unit of each of those, and `info` with the case, the status and the provenance. Time runs
    along the first dimension; vectors are columns. Indices count from 0, as in all other files.
    """
    from scipy.io import savemat

    check_suffix(path, ".mat")
    require_folder(path)
    content: dict[str, Any] = {}
    units: dict[str, dict[str, str]] = {}
    for group in run.groups:
        struct, unit = content.setdefault(group, {}), units.setdefault(group, {})
        for v, values, labels in parts(run, group):
            for dim, names in labels:
                struct[dim.name] = as_cells(names) if isinstance(names, tuple) else as_column(names)
                unit[dim.name] = dim.units
            struct[v.name], unit[v.name] = as_column(values), v.units
    info: dict[str, Any] = asdict(run.provenance)
    info |= {
        "case_toml": run.case_toml,
        "status": run.status,
        "message": run.message,
        "energy_residual": run.energy_residual,
        "wall_time": run.wall_time,
        "counts": dict(run.counts) or np.zeros((0, 0)),
        "diagnostics": dict(run.diagnostics) or np.zeros((0, 0)),
    }
    with atomic_write(path, _DISK_HINT) as name:
        savemat(name, content | {"units": units, "info": info}, long_field_names=True, appendmat=False)
    return path


def _header(name: str, label: str, units: str) -> str:
    full = f"{name} {label}".strip()
    return full if units == "1" else f"{full} [{units}]"


def _columns(run: Record, group: str) -> Iterator[tuple[str, NDArray[Any]]]:
    """Return header and values of every column of a CSV file, the index first."""
    labels, along = run.arrays.labels, groups(run.arrays.engine)[group].along
    if along == "time":
        yield _header("time", "", "s"), run.arrays.time
    for v, values, _ in parts(run, group):
        if v.dims[0] != along:
            continue
        # One column for each label of the other dimensions, such as each ball, or each axis of each damper.
        for index in product(*(range(len(labels[dim])) for dim in v.dims[1:])):
            label = " ".join(str(labels[dim][k]) for dim, k in zip(v.dims[1:], index, strict=True))
            yield _header(v.name, label, v.units), np.moveaxis(values, 0, -1)[index]


def to_csv(run: Record, folder: Path) -> tuple[Path, ...]:
    """Write a CSV file for each dataset of the run, such as motion.csv.

    The first line holds the headers, "name label [unit]"; numbers are written with all digits. Variables without a value
    for each row (clearances, natural frequencies, final shares) are only in the other formats.
    """
    check_suffix(folder, "")
    if folder.is_file():
        raise DataError(f"{folder} is a file; CSV files are written to a folder", "another name")
    with disk_errors(folder):
        folder.mkdir(parents=True, exist_ok=True)
    paths = tuple(folder / f"{group}.csv" for group in run.groups)
    with claim(paths):
        list_files(folder, run.provenance.version, {path.name: "" for path in paths})
        for group, path in zip(run.groups, paths, strict=True):
            write_table(run, group, path)
        list_files(folder, run.provenance.version, {path.name: digest_of(path) for path in paths})
    return paths


def write_table(run: Record, group: str, path: Path) -> None:
    """Write a dataset of a run to a CSV file; see `to_csv`."""
    import csv

    header, data = zip(*_columns(run, group), strict=True)
    # tolist() returns Python numbers, whose repr is the shortest text that parses to the same number.
    lists = [array.astype(int).tolist() if array.dtype == bool else array.tolist() for array in data]
    with atomic_write(path, _DISK_HINT) as name, name.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows(zip(*lists, strict=True))
