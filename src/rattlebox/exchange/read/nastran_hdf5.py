"""Modes in HDF5 results of MSC Nastran (.h5)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from rattlebox._util.exceptions import DataError

from .formats import ModesRequest, modes_reader
from .guarded import arrays_from_child, errors_of
from .local_axes import CARTESIAN, CYLINDRICAL, SPHERICAL, CoordinateSystem
from .modes_in_file import FloatArray, ModesInFile, listed, read_start
from .text_results import AXES, NORMALISED, modes_of_eigenvalues

_VECTORS, _VALUES, _DOMAINS = "RESULT/NODAL/EIGENVECTOR", "RESULT/SUMMARY/EIGENVALUE", "RESULT/DOMAINS"
_GRID, _SYSTEMS = "INPUT/NODE/GRID", {"R": CARTESIAN, "C": CYLINDRICAL, "S": SPHERICAL}
_NORMAL_MODES = 2  # ANALYSIS of real eigenvalues
_ANALYSES = {1: "statics", 5: "frequency response", 6: "transient response", 8: "buckling", 9: "complex eigenvalues"}
_ONE_ANALYSIS = ("SUBCASE", "STEP", "DESIGN_CYCLE", "SE", "AFPM", "TRMC", "MODULE")
_EXPORT = "the results of SOL 103 with VECTOR(PLOT) = ALL, written by MDLPRM, HDF5"
_FLUID = -1  # CD of points in a fluid, which have a pressure


@modes_reader(".h5", ".hdf5")
def read_nastran_hdf5(path: Path, _: ModesRequest) -> ModesInFile:
    """Read the real modes in a HDF5 file of MSC Nastran, with the generalized mass of each.

    Notes
    -----
    Displacements along own axes of points (CD of GRID) are turned to the basic system.

    References
    ----------
    MSC Nastran, HDF5 result database: tables of the group NASTRAN, such as RESULT/NODAL/EIGENVECTOR.
    """
    with errors_of(path, "a HDF5 result of Nastran"):
        start = read_start(path, 8)
        if start.startswith(b"\x89HDF\n"):
            raise DataError(
                f"{path} was changed by a transfer as text, which replaced line ends", "the file as written"
            )
        if start != b"\x89HDF\r\n\x1a\n":
            raise DataError(f"{path} is no HDF5 file", _EXPORT)
        arrays = arrays_from_child(path, "h5")
        tables = {str(name): arrays[f"array_{k}"] for k, name in enumerate(arrays["names"])}
        if others := [name.removeprefix("/") for name in tables if name.startswith("/")]:
            raise DataError(f"{path} has no group NASTRAN, but {listed(others)}", _EXPORT)
        domains, nodes, shapes = _vectors(path, tables)
        numbers = _mode_numbers(path, tables, domains)
        squares, masses = _eigenvalues(path, tables, numbers)
        order = np.argsort(numbers, kind="stable")
        nodes, shapes, notes = _in_global_axes(path, tables, nodes, shapes)
        if masses is None:
            notes = (NORMALISED.format(path.name), *notes)
        return modes_of_eigenvalues(
            path,
            squares[order],
            shapes[order],
            [str(int(node)) for node in nodes],
            None if masses is None else masses[order],
            notes,
        )


def _column(path: Path, tables: Mapping[str, object], table: str, column: str) -> Any:
    """Return a column of a table."""
    name = f"{table}.{column}"
    if name not in tables:
        raise DataError(f"{path}: the table NASTRAN/{table} has no column {column}", _EXPORT)
    return tables[name]


def _vectors(path: Path, tables: Mapping[str, Any]) -> tuple[Any, Any, FloatArray]:
    """Return domains (m,), nodes (n,) and displacements (m, n, 3) of the eigenvectors."""
    if f"{_VECTORS}.ID" not in tables:
        nodal = [name.rpartition("/")[2] for name in tables if name.startswith("RESULT/NODAL/") and "." not in name]
        if f"{_VECTORS}_CPLX" in tables:
            raise DataError(
                f"{path} contains complex modes, which are not read from HDF5 files", "real modes (SOL 103)"
            )
        raise DataError(
            f"{path} contains no table EIGENVECTOR in NASTRAN/RESULT/NODAL, but {listed(nodal) or 'no results of points'}",
            _EXPORT,
        )
    domain, node = _column(path, tables, _VECTORS, "DOMAIN_ID"), tables[f"{_VECTORS}.ID"]
    order = np.lexsort((node, domain))
    domains, counts = np.unique(domain, return_counts=True)
    if not domains.size or (counts != counts[0]).any():
        raise DataError(f"{path}: the modes have {'other' if domains.size else 'no'} points", "the complete file")
    rows = node[order].reshape(domains.size, -1)
    if (rows != rows[0]).any() or (np.diff(rows[0]) == 0).any():
        raise DataError(f"{path}: a mode has other points than the first one, or a point twice", "the complete file")
    parts = [_column(path, tables, _VECTORS, axis)[order].reshape(rows.shape) for axis in "XYZ"]
    return domains, rows[0], np.stack(parts, axis=2).astype(float)


def _mode_numbers(path: Path, tables: Mapping[str, Any], domains: Any) -> Any:
    """Return the number of the mode of each domain; raise if they are no normal modes of one analysis."""
    known = _column(path, tables, _DOMAINS, "ID")
    place = {int(label): k for k, label in enumerate(known)}
    if missing := [int(label) for label in domains if int(label) not in place]:
        raise DataError(f"{path}: NASTRAN/RESULT/DOMAINS has no domain {missing[0]}", "the complete file")
    rows = [place[int(label)] for label in domains]
    for analysis in np.unique(_column(path, tables, _DOMAINS, "ANALYSIS")[rows]):
        if analysis != _NORMAL_MODES:
            kind = _ANALYSES.get(int(analysis), f"type {int(analysis)}")
            raise DataError(f"{path} contains shapes of an analysis of {kind}, no normal modes", _EXPORT)
    for column in _ONE_ANALYSIS:
        values = np.unique(tables.get(f"{_DOMAINS}.{column}", np.zeros(len(known)))[rows])
        if values.size > 1:
            labels = listed([str(int(value)) for value in values])
            raise DataError(f"{path} contains modes of several analyses, {column} {labels}", "one of them in a file")
    numbers = _column(path, tables, _DOMAINS, "MODE")[rows]
    if np.unique(numbers).size < len(numbers):
        raise DataError(f"{path}: a number of a mode is in the file twice", "the results of one analysis")
    return numbers


def _eigenvalues(path: Path, tables: Mapping[str, Any], numbers: Any) -> tuple[FloatArray, FloatArray | None]:
    """Return squared angular frequencies and, if the file has them, generalized masses of modes."""
    modes, values = _column(path, tables, _VALUES, "MODE"), _column(path, tables, _VALUES, "EIGEN")
    masses = tables.get(f"{_VALUES}.MASS")
    rows: dict[int, int] = {}
    for row, mode in enumerate(modes):
        before = rows.setdefault(int(mode), row)
        if values[before] != values[row]:
            raise DataError(f"{path}: mode {int(mode)} has two eigenvalues", "the results of one analysis")
    if missing := [int(number) for number in numbers if int(number) not in rows]:
        raise DataError(f"{path} states no eigenvalue of mode {missing[0]}", "the complete file")
    chosen = [rows[int(number)] for number in numbers]
    return values[chosen].astype(float), None if masses is None else masses[chosen].astype(float)


def _in_global_axes(
    path: Path, tables: Mapping[str, Any], nodes: Any, shapes: FloatArray
) -> tuple[Any, FloatArray, tuple[str, ...]]:
    """Return points and shapes in the basic system, without scalar points and those of fluids, and notes."""
    if f"{_GRID}.ID" not in tables:
        return nodes, shapes, (AXES.format(path.name),)
    grid = tables[f"{_GRID}.ID"]
    place = {int(label): k for k, label in enumerate(grid)}
    axes_of = tables.get(f"{_GRID}.CD", np.zeros(len(grid), dtype=int))
    is_point = np.array(
        [int(axes_of[place[int(n)]]) != _FLUID if int(n) in place else False for n in nodes], dtype=bool
    )
    nodes, shapes = nodes[is_point], shapes[:, is_point].copy()
    if not nodes.size:
        raise DataError(f"{path}: the modes have no point of NASTRAN/INPUT/NODE/GRID", "displacements of points (GRID)")
    systems = _Systems(path, tables)
    for k, node in enumerate(nodes):
        row = place[int(node)]
        if label := int(axes_of[row]):
            at = systems.position(int(systems.cp[row]), systems.x[row])
            R = systems.system(label).at(at)
            if R is None:
                raise DataError(
                    f"{path}: point {int(node)} lies on the axis of the coordinate system {label} (CD), which has no "
                    "radial direction there",
                    "displacements along Cartesian axes at this point",
                )
            shapes[:, k] = shapes[:, k] @ R
    return nodes, shapes, ()


class _Systems:
    """The coordinate systems CORD2R, CORD2C and CORD2S of a file, by their labels."""

    def __init__(self, path: Path, tables: Mapping[str, Any]) -> None:
        self._path, self._rows = path, {}
        self._known: dict[int, CoordinateSystem] = {0: CoordinateSystem(CARTESIAN, np.eye(3), np.zeros(3))}
        self._open: set[int] = set()
        for letter, kind in _SYSTEMS.items():
            table = f"INPUT/COORDINATE_SYSTEM/CORD2{letter}"
            for row, label in enumerate(tables.get(f"{table}.CID", ())):
                points = [[float(_column(path, tables, table, f"{p}{k}")[row]) for k in (1, 2, 3)] for p in "ABC"]
                self._rows[int(label)] = kind, int(_column(path, tables, table, "RID")[row]), np.array(points)
        count = len(tables[f"{_GRID}.ID"])
        self.cp = tables.get(f"{_GRID}.CP", np.zeros(count, dtype=int))
        self.x = np.asarray(_column(path, tables, _GRID, "X"), dtype=float).reshape(count, 3)

    def position(self, label: int, coordinates: FloatArray) -> FloatArray:
        """Return the position of a point in the basic system."""
        return self.system(label).position(coordinates)

    def system(self, label: int) -> CoordinateSystem:
        """Return a coordinate system: A is its origin, B a point of its third axis, C one of the half plane of the first."""
        if label in self._known:
            return self._known[label]
        if label not in self._rows or label in self._open:
            raise DataError(
                f"{self._path}: the coordinate system {label} of points is "
                f"{'defined by itself' if label in self._open else 'no CORD2R, CORD2C or CORD2S of the file'}",
                "CORD2R, CORD2C or CORD2S in place of CORD1R, ...; or points with CD = 0",
            )
        self._open.add(label)
        kind, reference, points = self._rows[label]
        a, b, c = (self.position(reference, point) for point in points)
        z = b - a
        x = (c - a) - z * float((c - a) @ z) / max(float(z @ z), 1e-300)
        with np.errstate(all="ignore"):
            z, x = z / np.linalg.norm(z), x / np.linalg.norm(x)
        system = CoordinateSystem(kind, np.array([x, np.cross(z, x), z]), a)
        if not system.is_sound:
            raise DataError(
                f"{self._path}: the points of the coordinate system {label} are on one line", "three others"
            )
        self._known[label] = system
        return system
