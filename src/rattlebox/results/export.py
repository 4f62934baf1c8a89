"""Export of runs to MATLAB and CSV files."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
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
from rattlebox.exchange.write.universal import (
    EXCITATION_FORCE,
    GENERAL,
    TIME_RESPONSE,
    Function,
    Node,
    function_set,
    write_universal,
)
from rattlebox.model.space import unit_vector

from .datasets import labelled_parts, parts
from .schema import AXES, groups

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
        for v, values, labels in labelled_parts(run, group):
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


_HISTORIES = (
    "displacement", "velocity", "acceleration", "absolute_acceleration", "base_displacement", "base_velocity",
    "base_acceleration", "interface_force", "load",
)  # fmt: skip
"""Variables of the motion that measurement programs know."""

_LETTERS = {"m": "d", "m/s": "v", "m/s^2": "a", "N": "f"}
"""Quantities of SEP005, by unit."""


def histories(run: Record, names: Iterable[str] | None = None) -> Iterator[tuple[str, str, NDArray[Any], str]]:
    """Yield name, label, values and unit of each time history of the motion.

    Variables that a run lacks, or cannot know, are left out of the default ones.
    """
    group, labels = "motion", run.arrays.labels
    known = {v.name: (v, values) for v, values, _ in parts(run, group) if v.dims[:1] == ("time",)}
    for name in _HISTORIES if names is None else names:
        if name not in known:
            if names is None:
                continue
            raise DataError(f"this run has no time history {name!r}", ", ".join(known))
        v, values = known[name]
        for index in product(*(range(len(labels[dim])) for dim in v.dims[1:])):
            series = np.moveaxis(values, 0, -1)[index]
            if names is not None or np.isfinite(series).all():
                label = " ".join(str(labels[dim][k]) for dim, k in zip(v.dims[1:], index, strict=True))
                yield name, label, series, v.units


def nodes_of(points: Iterable[str], nodes: Mapping[str, Node]) -> dict[str, Node]:
    """Return the node and direction of each point; "tip x", "tip y" and "tip z" belong to one node, as does "tip".

    Points without a given node are numbered in their order, from 1.
    """
    found: dict[str, Node] = {}
    order: dict[str, int] = {}
    used: dict[Node, str] = {}
    for point in points:
        name, _, axis = point.rpartition(" ")
        direction = "xyz".find(axis) + 1 if name and axis in AXES else 0
        own = name if direction else point
        number = order.setdefault(own, len(order) + 1)
        node = nodes.get(point) or nodes.get(own) or (number, 0)
        found[point] = node[0], node[1] if point in nodes else direction or node[1]
        other = used.setdefault(found[point], point)
        if other != point:
            raise DataError(
                f"nodes: {other!r} and {point!r} are both node {node[0]} in one direction", "a node for each of them"
            )
    unknown = sorted(set(nodes) - set(found) - set(order))
    if unknown:
        raise DataError(f"nodes: there is no point {unknown[0]!r}", ", ".join(found) or "none")
    return found


def to_uff(run: Record, path: Path, variables: Iterable[str] | None, nodes: Mapping[str, Node]) -> Path:
    """Write a universal file with a set 58b for each time history."""
    sets = []
    numbers = nodes_of(run.arrays.points, nodes)
    for name, label, values, unit in histories(run, variables):
        kind = TIME_RESPONSE if unit in _LETTERS else GENERAL
        axis = label.rpartition(" ")[2]
        node = numbers.get(label, (0, AXES.index(axis) + 1 if axis in AXES else 0))
        if name == "load":
            node = _node_of_load(run, label, numbers)
        full, quantity = f"{name} {label}".strip(), EXCITATION_FORCE if name == "load" else None
        function = Function(full, kind, run.arrays.time, "s", values, unit, response=node, quantity=quantity)
        sets.append(function_set(function))
    return write_universal(path, sets)


def _node_of_load(run: Record, label: str, numbers: Mapping[str, Node]) -> Node:
    """Return node and direction of the point on which a load acts; the direction is 0 if it is along no axis."""
    signal = run.case.loads[run.arrays.loads.index(label)]
    point = run.case.modes.point(signal.point)
    if signal.direction is None or point in numbers:
        node, direction = numbers.get(point, (0, 0))
    else:  # its components are points of the run
        node, direction = numbers.get(f"{point} x", (0, 0))[0], 0
    if signal.direction is not None:
        axis = unit_vector(signal.direction)
        k = int(np.argmax(np.abs(axis)))
        own = numbers.get(f"{point} {AXES[k]}", (node, k + 1))[1]
        direction = int(np.sign(axis[k])) * own if abs(axis[k]) == 1 else 0
    return node, direction


def to_sep005(run: Record, variables: Iterable[str] | None) -> list[dict[str, Any]]:
    """Return the time histories in the form of SEP005."""
    time = run.arrays.time
    even = time[0] + np.arange(time.size) * ((time[-1] - time[0]) / max(time.size - 1, 1))
    is_even = time.size > 1 and np.abs(even - time).max() <= 1e-9 * time[-1]
    channels = []
    for name, label, values, unit in histories(run, variables):
        channel: dict[str, Any] = {"name": f"{name} {label}".strip(), "data": np.array(values, float), "unit_str": unit}
        if unit in _LETTERS:
            channel["quantity"] = _LETTERS[unit]
        if is_even and time[0] == 0:
            channel["fs"] = (time.size - 1) / float(time[-1])
        else:  # in equal steps not from 0 s, or in others
            channel["time"] = time.tolist()
        channels.append(channel | {"group": "rattlebox"})
    return channels


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
