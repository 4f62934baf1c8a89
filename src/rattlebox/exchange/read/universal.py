"""Universal files (UFF, UNV): mode shapes in the sets 55 and 2414, units in 164, measured functions in 58 and 58b."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox._util.optional_imports import optional_import

from .formats import ModesRequest, SignalInFile, modes_reader, record_reader
from .guarded import errors_of
from .modes_in_file import FloatArray, ModesInFile, read_start

# Factors of length and force from SI to the units of a file, by code; code 9 stands for units of the user.
_UNIT_CODES = {
    1: (1.0, 1.0), 2: (3.28084, 0.224809), 3: (1.0, 0.101972), 4: (3.28084, 7.23301), 5: (1e3, 1e3), 6: (1e2, 1e2),
    7: (39.37008, 0.224809), 8: (1e3, 0.101972), 10: (1e3, 1.0),
}  # fmt: skip
# Analysis types of the sets 55 and 2414, type of result of the set 2414, types of sets.
_NORMAL_MODES = 2
_COMPLEX_MODES = (3, 7)
_DISPLACEMENT, _UNKNOWN = 8, (0, 1)  # also types of data of the set 55
_QUANTITIES = {
    0: "unknown data", 1: "general data", 2: "stress", 3: "strain", 4: "element force", 5: "temperature",
    6: "heat flux", 7: "strain energy",
    9: "reaction force", 10: "kinetic energy", 11: "velocity", 12: "acceleration",
}  # fmt: skip
_GEOMETRY = (15, 2411, 2420)  # nodes, nodes, coordinate systems
_TAIL = 4096  # bytes that contain the last line
_LARGEST_IMAGINARY = 1e-6  # largest imaginary part of a real mode, over the largest component


@dataclass(frozen=True, eq=False)
class Function:
    """A measured function of a set 58 or 58b.

    Attributes
    ----------
    abscissa : (n,) float
        Times [s] or frequencies [Hz].
    values : (n,) float or complex
        Values, in `unit`, or `unit` over `source_unit`.
    """

    name: str
    kind: int
    abscissa: FloatArray
    values: Any
    unit: str
    source_unit: str = ""
    quantities: tuple[int, int] = (0, 0)


def _read_sets(path: Path, kinds: tuple[int, ...], further: tuple[int, ...] = ()) -> list[dict[str, Any]]:
    """Return the data sets of these kinds, of which one is needed, and of further kinds."""
    read_start(path, 64)
    with path.open("rb") as stream:
        stream.seek(-min(path.stat().st_size, _TAIL), 2)
        end = stream.read().rstrip().rsplit(b"\n", 1)[-1].strip()
    pyuff = optional_import("pyuff", "uff", "a modal table in CSV")
    with errors_of(path, "a universal file"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        file = pyuff.UFF(str(path))
        types = [int(kind) for kind in file.get_set_types()]
        sets = [file.read_sets(number) for number, kind in enumerate(types) if kind in kinds + further]
    if not types:
        raise DataError(
            f"{path} contains no complete data set of a universal file", "the complete file, with -1 around each set"
        )
    if not end.endswith(b"-1"):
        raise DataError(
            f"{path}: the last data set does not end with -1; the file may be cut short", "the complete file"
        )
    if not {block["type"] for block in sets} & set(kinds):
        available = ", ".join(map(str, sorted(set(types))))
        raise DataError(
            f"{path} contains no set {' or '.join(map(str, kinds))}; it contains {available}",
            "an export with mode shapes (sets 55 or 2414) or with functions (set 58)",
        )
    return sets


def read_universal_modes(path: Path, *, needs_units: bool = True) -> ModesInFile:
    """Read the normal modes of a universal file.

    Notes
    -----
    The unit of mass is that of force over that of acceleration, l / f kg, with the factors l and f of the set 164 from m and
    N to the units of length and force of the file.

    References
    ----------
    Structural Dynamics Research Corporation, I-DEAS universal file datasets 15, 55, 58, 164, 2411, 2414 and 2420; published
    by the University of Cincinnati, Structural Dynamics Research Laboratory (UC-SDRL).
    """
    with errors_of(path, "a universal file"):
        every = _read_sets(path, (55, 2414, 164), _GEOMETRY)
        sets = [block for block in every if block["type"] not in _GEOMETRY]
        # The set 55 may also have stresses, velocities or accelerations of the same modes.
        normal = [block for block in sets if block["type"] == 55 and _is_normal(block)]
        quantities = {int(block["spec_data_type"]) for block in normal}
        wanted = (_DISPLACEMENT,) if _DISPLACEMENT in quantities else _UNKNOWN
        chosen = [block for block in sets if block["type"] != 164 and _is_mode(block, wanted)]
        modes = [_mode(path, block) for block in _without_twins(chosen)]
        others = [_QUANTITIES.get(kind, f"data of type {kind}") for kind in sorted(quantities - set(wanted))]
        notes = [f"{path.name} does not state the quantity of its modes; displacements are assumed"] * (
            bool(quantities) and wanted == _UNKNOWN and bool(modes)
        )
        # From here on the errors say why there are no modes: other quantities, complex modes, other analyses.
        if not modes and others:
            raise DataError(
                f"{path} contains normal modes of {' and '.join(others)}; mode shapes are displacements (type 8)",
                "an export of displacements",
            )
        if not modes:
            kinds = sorted({int(block["analysis_type"]) for block in sets if block["type"] != 164})
            scatter = [
                _phase_scatter(block)
                for block in sets
                if block["type"] == 55 and int(block["analysis_type"]) in _COMPLEX_MODES
            ]
            if scatter:
                raise DataError(
                    f"{path} contains only complex modes, whose phases scatter by up to {max(scatter):.3g} degrees; "
                    "normal modes are needed",
                    "an export of real normal modes; they are similar if the phases scatter by less than about 10 degrees",
                )
            raise DataError(
                f"{path} contains no normal modes (analysis type 2); its types are {', '.join(map(str, kinds)) or 'none'}",
                "an export of real normal modes",
            )
        # A structure needs all shapes at the same nodes; files that join several exports may differ.
        nodes = modes[0][3]
        for number, mode in enumerate(modes, start=1):
            if not np.array_equal(mode[3], nodes):
                raise DataError(f"{path}: mode {number} has other nodes than mode 1", "the same nodes for all modes")
        frequencies = np.array([mode[0] for mode in modes])
        shapes = np.array([mode[4] for mode in modes])
        for what, values in (("frequency", frequencies), ("mode shape", shapes)):
            if not np.isfinite(values).all() or np.abs(values).max(initial=0.0) > 1e30:
                raise DataError(f"{path}: a {what} is not finite", "the file as it was written: bytes may be swapped")
        if (frequencies < 0).any():
            raise DataError(f"{path}: a frequency is negative", "the file as the program wrote it")
        masses = np.array([mode[1] for mode in modes])
        damping = np.array([mode[2] for mode in modes])
        return ModesInFile(
            frequencies=frequencies,
            shapes={str(int(node)): shapes[:, k] for k, node in enumerate(nodes)},
            modal_masses=masses,
            damping_ratios=damping if damping.any() else None,
            mass_unit=_mass_unit(path, [block for block in sets if block["type"] == 164], needs_units),
            notes=tuple(notes) + _check_axes(path, [block for block in every if block["type"] in _GEOMETRY], nodes),
        )


def _check_axes(path: Path, sets: list[dict[str, Any]], nodes: Any) -> tuple[str, ...]:
    """Return a note if a node has displacements along the axes of a system that the file does not define."""
    turned: dict[int, str] = {}
    defined = {0, 1}  # 1 is the global Cartesian system of most programs
    for block in sets:
        if block["type"] == 2420:
            for label, kind, matrix in zip(
                block["CS_sys_labels"], block["CS_types"], block["CS_matrices"], strict=True
            ):
                defined.add(int(label))
                if int(kind) != 0 or not np.allclose(np.asarray(matrix)[:3], np.eye(3), atol=1e-6):
                    turned[int(label)] = "Cartesian, with turned axes" if int(kind) == 0 else "not Cartesian"
    used = {
        int(node): int(system)
        for block in sets
        if block["type"] != 2420
        for node, system in zip(block["node_nums"], block["disp_cs"], strict=True)
    }
    # Displacements along turned axes would be mixed with those along global ones. Only nodes with modes matter.
    undefined: dict[int, int] = {}
    for node in map(int, nodes):
        system = used.get(node, 0)
        if system in turned:
            raise DataError(
                f"{path}: node {node} has displacements in the coordinate system {system}, which is {turned[system]}",
                "an export with displacements along the global axes x, y and z",
            )
        if system not in defined:
            undefined.setdefault(system, node)
    if not undefined:
        return ()
    system, node = next(iter(undefined.items()))
    return (
        f"{path.name} does not define the coordinate system {system} of the displacements of node {node}; the global axes "
        "are assumed",
    )


def _phase_scatter(block: dict[str, Any]) -> float:
    """Return the RMS deviation of the phases of a complex mode from a line through zero, weighted by amplitude [degrees].

    The line is the principal axis of the components z in the complex plane, at half the phase of sum(z^2).
    """
    z = np.concatenate([np.asarray(block[f"r{k}"], dtype=complex) for k in (1, 2, 3)])
    z = z * np.exp(-0.5j * np.angle(np.sum(z**2)))
    return float(np.degrees(np.arctan2(np.linalg.norm(z.imag), np.linalg.norm(z.real))))


def _without_twins(sets: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the sets without those of type 55 if those of type 2414 are the same modes."""
    of_55 = [float(block["freq"]) for block in sets if block["type"] == 55]
    of_2414 = [float(block["record12_field2"]) for block in sets if block["type"] == 2414]
    if of_2414 and len(of_55) == len(of_2414) and np.allclose(of_55, of_2414, rtol=1e-4):
        return [block for block in sets if block["type"] == 2414]
    return sets


def _is_normal(block: dict[str, Any]) -> bool:
    return int(block["analysis_type"]) == _NORMAL_MODES


def _is_mode(block: dict[str, Any], wanted: tuple[int, ...]) -> bool:
    """Return whether a set has a mode shape; `wanted` are the types of data in the set 55."""
    if block["type"] == 55:
        return _is_normal(block) and int(block["spec_data_type"]) in wanted
    at_nodes = int(block.get("dataset_location", 1)) == 1
    return int(block["analysis_type"]) == _NORMAL_MODES and int(block["result_type"]) == _DISPLACEMENT and at_nodes


def _mode(path: Path, block: dict[str, Any]) -> tuple[float, float, float, Any, Any]:
    """Return frequency, modal mass, damping ratio, nodes and shape of a set."""
    if block["type"] == 55:
        if int(block["n_data_per_node"]) not in (3, 6):
            raise DataError(
                f"{path}: a mode has {block['n_data_per_node']} values at a node; 3 or 6 are needed",
                "translations x, y, z",
            )
        nodes = np.asarray(block["node_nums"])
        shape = np.array([block[f"r{k}"] for k in (1, 2, 3)]).T
        values = block["freq"], block["modal_m"], block["modal_damp_vis"]
    else:
        nodes = np.asarray(block["node_nums"])
        table = np.atleast_2d(np.asarray(block["data_at_node"], dtype=complex))
        if int(block["data_type"]) in (5, 6) and not np.iscomplexobj(block["data_at_node"]):
            table = table[:, 0::2] + 1j * table[:, 1::2]
        shape = table[:, :3]
        values = block["record12_field2"], block["record12_field4"], block["record12_field5"]
    if shape.shape != (len(nodes), 3):
        raise DataError(f"{path}: a mode has {shape.shape} components for {len(nodes)} nodes", "the complete file")
    if np.abs(np.imag(shape)).max(initial=0.0) > _LARGEST_IMAGINARY * np.abs(shape).max(initial=0.0):
        raise DataError(f"{path}: the mode at {float(values[0]):.6g} Hz is complex", "an export of real normal modes")
    frequency, mass, damping = (float(value) for value in values)
    return frequency, mass, damping, nodes, np.real(shape)


def _mass_unit(path: Path, sets: list[dict[str, Any]], is_needed: bool) -> float | None:
    """Return the unit of mass of a file [kg]; None if it states none, or a contradiction and the unit is not needed."""
    if not sets:
        return None
    length, force, code = float(sets[0]["length"]), float(sets[0]["force"]), int(sets[0]["units_code"])
    if not (1e-9 < length < 1e9 and 1e-9 < force < 1e9):
        raise DataError(
            f"{path}: set 164 states factors of {length:g} for lengths and {force:g} for forces, which no units have",
            "the file as the program wrote it: bytes may be swapped",
        )
    if code in _UNIT_CODES:
        for what, value, expected in zip(("lengths", "forces"), (length, force), _UNIT_CODES[code], strict=True):
            if abs(value / expected - 1) > 1e-2:
                if not is_needed:
                    return None
                raise DataError(
                    f"{path}: set 164 states a factor of {value:g} for {what}, but its code {code} means {expected:g}",
                    "mass_unit, the unit of mass of the file",
                )
    return length / force


def read_functions(path: Path) -> list[Function]:
    """Read the functions of the sets 58 and 58b of a universal file.

    See Also
    --------
    read_universal_modes : Modes, with the source of the format.
    """
    with errors_of(path, "a universal file"):
        functions = []
        for number, block in enumerate(_read_sets(path, (58,)), start=1):
            # The number of points and the size of the values show a truncated file and a wrong byte order, which the
            # reader does not notice.
            values = np.asarray(block["data"])
            stated = int(block["num_pts"])
            if values.size != stated:
                raise DataError(
                    f"{path}: function {number} states {stated} points, but has {values.size}", "the complete file"
                )
            size = np.abs(values)
            if not np.isfinite(size).all() or size.max(initial=0.0) > 1e30 or 0 < size.max(initial=0.0) < 1e-30:
                raise DataError(
                    f"{path}: function {number} has values up to {size.max(initial=0.0):.3g}, outside any"
                    " measurement's range",
                    "the other byte order; the header may state the wrong one",
                )
            functions.append(
                Function(
                    name=str(block.get("rsp_ent_name") or block.get("id1", "")).strip(),
                    kind=int(block["func_type"]),
                    abscissa=np.asarray(block["x"], dtype=float),
                    values=values,
                    unit=_label(block, "ordinate"),
                    source_unit=_label(block, "orddenom"),
                    quantities=(int(block["ordinate_spec_data_type"]), int(block["orddenom_spec_data_type"])),
                )
            )
        return functions


@record_reader(".uff", ".unv", ".uf", starts_at_first=True)
def time_histories(path: Path) -> list[SignalInFile]:
    """Return the time histories among the functions of a universal file."""
    functions = [each for each in read_functions(path) if each.kind in (0, 1) and not np.iscomplexobj(each.values)]
    if not functions:
        raise DataError(f"{path} contains no time history", "a function of type 1 in a set 58")
    return [
        SignalInFile(each.abscissa, np.asarray(each.values, dtype=float), each.name, each.unit) for each in functions
    ]


@modes_reader(".uff", ".unv", ".uf")
def modes_of_universal(path: Path, request: ModesRequest) -> ModesInFile:
    """Read the modes of a universal file; units that contradict each other are no error if the user states them."""
    return read_universal_modes(path, needs_units=not request.has_mass_unit)


def _label(block: dict[str, Any], axis: str) -> str:
    """Return the unit of an axis; pyuff replaces the superscript 2 of other encodings by U+FFFD."""
    unit = str(block.get(f"{axis}_axis_units_lab", "")).strip().replace("\ufffd", "²")
    return "" if unit.upper() == "NONE" else unit
