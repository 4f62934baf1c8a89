"""Universal files (UFF, UNV): mode shapes in the sets 55 and 2414, units in 164, measured functions in 58 and 58b."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple, NoReturn

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox._util.optional_imports import optional_import

from .formats import DensityInFile, ModesRequest, SignalInFile, density_reader, modes_reader, record_reader
from .guarded import errors_of
from .local_axes import CARTESIAN, CYLINDRICAL, SPHERICAL, CoordinateSystem
from .modes_in_file import FloatArray, ModesInFile, read_start, without_rounding

# Factors of length and force from SI to the units of a file, by code; code 9 stands for units of the user.
_UNIT_CODES = {
    1: (1.0, 1.0), 2: (3.28084, 0.224809), 3: (1.0, 0.101972), 4: (3.28084, 7.23301), 5: (1e3, 1e3), 6: (1e2, 1e2),
    7: (39.37008, 0.224809), 8: (1e3, 0.101972), 10: (1e3, 1.0),
}  # fmt: skip
# Analysis types of the sets 55 and 2414, type of result of the set 2414, types of sets.
_NORMAL_MODES = 2
_COMPLEX_MODES = (3, 7)
_DISPLACEMENT, _UNKNOWN = 8, (0, 1)  # also types of data of the set 55
_LENGTHS = {1e3: "mm", 1e2: "cm", 39.37008: "in", 3.28084: "ft"}
_FORCES = {1e3: "mN", 0.224809: "lbf", 0.101972: "kgf"}
"""Units by their factor from SI."""
_ACCELERATION, _VELOCITY, _FORCE_TYPES = 12, 11, (4, 9, 13)
"""Types of data of functions."""
_QUANTITIES = {
    0: "unknown data", 1: "general data", 2: "stress", 3: "strain", 4: "element force", 5: "temperature",
    6: "heat flux", 7: "strain energy",
    9: "reaction force", 10: "kinetic energy", 11: "velocity", 12: "acceleration",
}  # fmt: skip
_GEOMETRY = (15, 2411, 2420)  # nodes, nodes, coordinate systems
_LISTED = 12  # modes in a note
_SHOWN = 200  # characters of a message of the library
_FUNCTIONS = {
    0: "general function", 1: "time response", 2: "auto spectrum", 3: "cross spectrum", 4: "frequency response function",
    5: "transmissibility", 6: "coherence", 7: "auto correlation", 8: "cross correlation", 9: "power spectral density",
    10: "energy spectral density", 11: "probability density", 12: "spectrum", 13: "cumulative frequency distribution",
    14: "peaks and valleys", 15: "stress cycles", 16: "strain cycles", 17: "orbit", 18: "mode indicator function",
    19: "force pattern", 20: "partial power", 21: "partial coherence", 22: "eigenvalue", 23: "eigenvector",
    24: "shock response spectrum", 25: "impulse response filter", 26: "multiple coherence", 27: "order function",
}  # fmt: skip
"""Names of the types of functions in the set 58."""
_GENERAL, _TIME_RESPONSE, _FREQUENCY_RESPONSE, _TRANSMISSIBILITY, _DENSITY = 0, 1, 4, 5, 9
_USES = {
    _TIME_RESPONSE: "rb.Record.from_file",
    _FREQUENCY_RESPONSE: "rb.analysis.read_frequency_response",
    _TRANSMISSIBILITY: "rb.analysis.read_frequency_response",
    _DENSITY: "rb.Random.from_file",
}
"""Functions that read types of functions; the other types are refused."""
_EXPORTS = {
    2: "an export of the power spectral density (type 9): an auto spectrum does not state its bandwidth",
    3: "an export of the frequency response function (type 4)",
    10: "an export of the power spectral density (type 9): an energy spectral density does not state its duration",
    12: "an export of the time history (type 1), of which the spectrum was computed",
    24: "an export of the time history (type 1): many shocks have the same response spectrum",
}
"""Advice on other types."""
_OVER_FREQUENCY = 18  # type of data of an abscissa
_D_EXPONENT = re.compile(rb"(?m)^[ \t0-9+.DEde-]*\d[Dd][+-]\d[ \t0-9+.DEde-]*\r?$")
"""A line of numbers of which one has the exponent D of Fortran."""
_TAIL = 4096  # bytes that contain the last line
_LARGEST_IMAGINARY = 1e-6  # largest imaginary part of a real mode, over the largest component
LARGEST_SCATTER = 10.0
"""Largest scatter of the phases of a complex mode that is read as a real one [degrees]."""
_LARGEST_PHASE = 45.0  # largest deviation of modal A from that of a normal mode [degrees]


@dataclass(frozen=True, eq=False)
class Function:
    """A measured function of a set 58 or 58b."""

    name: str
    kind: int
    abscissa: FloatArray  # Times [s] or frequencies [Hz], (n,)
    values: Any  # Values, in `unit`, or `unit` over `source_unit`, (n,)
    unit: str
    source_unit: str = ""
    quantities: tuple[int, int] = (0, 0)
    over: int = 0
    abscissa_unit: str = ""
    texts: tuple[str, ...] = ()
    units_of_file: tuple[
        tuple[int, str], ...
    ] = ()  # Line and text of the unit after the set 164, if that has no SI units

    @property
    def is_history(self) -> bool:
        """Whether it is a time history."""
        is_over_time = self.over != _OVER_FREQUENCY and not np.iscomplexobj(self.values)
        return self.kind in (_GENERAL, _TIME_RESPONSE) and is_over_time

    def words(self) -> str:
        """Return the name of the type of the function."""
        words = _FUNCTIONS.get(self.kind, f"function of type {self.kind}")
        if self.kind in (_GENERAL, _TIME_RESPONSE) and not self.is_history:
            words += " of complex values" if np.iscomplexobj(self.values) else " over frequency"
        return words


def _read_sets(path: Path, kinds: tuple[int, ...], further: tuple[int, ...] = ()) -> list[dict[str, Any]]:
    """Return the data sets of these kinds, of which one is needed, and of further kinds."""
    read_start(path, 64)
    with path.open("rb") as stream:
        stream.seek(-min(path.stat().st_size, _TAIL), 2)
        end = stream.read().rstrip().rsplit(b"\n", 1)[-1].strip()
    pyuff = optional_import("pyuff", "uff", "a modal table in CSV")
    with errors_of(path, "a universal file"), warnings.catch_warnings(), _with_exponents_e(path) as copy:
        warnings.simplefilter("ignore")
        file = pyuff.UFF(str(copy))
        types = [int(kind) for kind in file.get_set_types()]
        sets = [_read_set(path, file, number, kind) for number, kind in enumerate(types) if kind in kinds + further]
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


@contextmanager
def _with_exponents_e(path: Path) -> Iterator[Path]:
    """Yield the file, or a copy with exponents E in place of those of Fortran, which the library does not read."""
    content = path.read_bytes()
    replaced = _D_EXPONENT.sub(lambda line: line[0].replace(b"D", b"E").replace(b"d", b"e"), content)
    if replaced == content:
        yield path
        return
    with TemporaryDirectory() as folder:
        copy = Path(folder) / path.name
        copy.write_bytes(replaced)
        yield copy


def _read_set(path: Path, file: Any, number: int, kind: int) -> dict[str, Any]:
    """Return a data set; the library does not say where an error is."""
    try:
        block: dict[str, Any] = file.read_sets(number)
    except Exception as error:
        cause = " ".join(str(error.__cause__ or error.__context__ or error).split())[:_SHOWN]
        content = path.read_bytes()
        marks = [found.start() for found in re.finditer(rb"^ {4}-1[ \r]*$", content, re.MULTILINE)]
        line = 1 + content.count(b"\n", 0, marks[2 * number]) if 2 * number < len(marks) else 1
        raise DataError(
            f"{path}, line {line}: the data set {number + 1}, of type {kind}, cannot be read"
            + (f": {cause}" if cause else ""),
            "the file as the program wrote it",
        ) from None
    return block


def read_universal_modes(path: Path, *, needs_units: bool = True) -> ModesInFile:
    """Read the normal modes of a universal file; complex modes if it has no others, rotated to the real axis.

    Notes
    -----
    The unit of mass is that of force over that of acceleration, l / f kg, with the factors l and f of the set 164 from m and
    N to the units of length and force of the file.

    A complex mode psi of the eigenvalue lambda = -zeta w + i w_d is read as Re(psi exp(-i theta)), with the angle theta of
    its principal axis, and has the modal mass |a| / (2 w_d): with proportional damping psi is normal, and
    a = psi^T (2 lambda M + C) psi = 2 i w_d m exp(2 i theta). Its sign depends on the sense of the measured force.

    References
    ----------
    Structural Dynamics Research Corporation, I-DEAS universal file datasets 15, 55, 58, 164, 2411, 2414 and 2420; published
    by the University of Cincinnati, Structural Dynamics Research Laboratory (UC-SDRL).
    """
    with errors_of(path, "a universal file"):
        every = _read_sets(path, (55, 2414), (164, *_GEOMETRY))
        sets = [block for block in every if block["type"] not in _GEOMETRY]
        chosen, note = _sets_of_modes(path, [block for block in sets if block["type"] != 164])
        is_complex = not _is_normal(chosen[0])
        modes = [_complex_mode(path, block) if is_complex else _mode(path, block) for block in _without_twins(chosen)]
        notes = [*note]
        if is_complex:
            scatters = ", ".join(f"{mode.scatter:.2g}" for mode in modes[:_LISTED]) + ", ..." * (len(modes) > _LISTED)
            notes.append(
                f"the complex modes of {path.name} are rotated to the real axis; their phases scatter by {scatters} degrees"
            )
        # A structure needs all shapes at the same nodes; files that join several exports may differ.
        nodes = modes[0].nodes
        for number, mode in enumerate(modes, start=1):
            if not np.array_equal(mode.nodes, nodes):
                raise DataError(f"{path}: mode {number} has other nodes than mode 1", "the same nodes for all modes")
        frequencies = np.array([mode.frequency for mode in modes])
        shapes = np.array([mode.shape for mode in modes])
        for what, values in (("frequency", frequencies), ("mode shape", shapes)):
            if not np.isfinite(values).all() or np.abs(values).max(initial=0.0) > 1e30:
                raise DataError(f"{path}: a {what} is not finite", "the file as it was written: bytes may be swapped")
        if (frequencies < 0).any():
            raise DataError(f"{path}: a frequency is negative", "the file as the program wrote it")
        if not is_complex:
            frequencies = np.sqrt(without_rounding(frequencies**2))
        damping = np.array([mode.damping for mode in modes])
        axes, assumed = _axes_of_nodes(path, [block for block in every if block["type"] in _GEOMETRY], nodes)
        for k, R in axes.items():  # rows of R are the axes of the system: u = R^T u_local
            shapes[:, k] = shapes[:, k] @ R
        return ModesInFile(
            frequencies=frequencies,
            shapes={str(int(node)): shapes[:, k] for k, node in enumerate(nodes)},
            modal_masses=np.array([mode.mass for mode in modes]),
            damping_ratios=damping if damping.any() else None,
            mass_unit=_mass_unit(path, [block for block in sets if block["type"] == 164], needs_units),
            unfit={number: mode.unfit for number, mode in enumerate(modes, start=1) if mode.unfit},
            notes=(*notes, *assumed),
        )


def _sets_of_modes(path: Path, sets: list[dict[str, Any]]) -> tuple[list[dict[str, Any]], tuple[str, ...]]:
    """Return the sets with normal modes, or else those with complex modes, and a note if their quantity is assumed."""
    # The set 55 may also have stresses, velocities or accelerations of the same modes.
    normal = [block for block in sets if block["type"] == 55 and _is_normal(block)]
    quantities = {int(block["spec_data_type"]) for block in normal}
    wanted: tuple[int, ...] = (_DISPLACEMENT,) if _DISPLACEMENT in quantities else _UNKNOWN
    if chosen := [block for block in sets if _is_mode(block, wanted, (_NORMAL_MODES,))]:
        is_assumed = bool(quantities) and wanted == _UNKNOWN
        note = f"{path.name} does not state the quantity of its modes; displacements are assumed"
        return chosen, (note,) if is_assumed else ()
    # From here on the errors say why there are no modes: other quantities, other analyses.
    others = [_QUANTITIES.get(kind, f"data of type {kind}") for kind in sorted(quantities - set(wanted))]
    if others:
        raise DataError(
            f"{path} contains normal modes of {' and '.join(others)}; mode shapes are displacements (type 8)",
            "an export of displacements",
        )
    # Most programs of modal tests write complex modes.
    chosen = [block for block in sets if _is_mode(block, (_DISPLACEMENT, *_UNKNOWN), _COMPLEX_MODES)]
    if not chosen:
        kinds = sorted({int(block["analysis_type"]) for block in sets})
        raise DataError(
            f"{path} contains no modes of displacements (analysis types 2, 3 and 7); its analysis types are "
            f"{', '.join(map(str, kinds)) or 'none'}",
            "an export of mode shapes",
        )
    return chosen, ()


def _axes_of_nodes(path: Path, sets: list[dict[str, Any]], nodes: Any) -> tuple[dict[int, FloatArray], tuple[str, ...]]:
    """Return the axes, as rows, of the nodes with own ones, and notes of what is assumed about axes."""
    systems = _systems(path, sets)
    used: dict[int, int] = {}
    places: dict[int, FloatArray | None] = {}
    for block in sets:
        if block["type"] == 2420:
            continue
        columns = (block[name] for name in ("node_nums", "def_cs", "disp_cs", "x", "y", "z"))
        for node, definition, displacement, *x in zip(*columns, strict=True):
            used[int(node)] = int(displacement)
            # Coordinates of the set 2411 are Cartesian ones, those of the set 15 are in the system of definition.
            system = systems.get(int(definition) if block["type"] == 15 else 0, systems[0])
            places[int(node)] = system.position(np.array(x)) if system.kind == CARTESIAN else None
    turned: dict[int, FloatArray] = {}
    undefined: dict[int, int] = {}
    kinds: set[int] = set()
    for k, node in enumerate(map(int, nodes)):
        label = used.get(node, 0)
        if label not in systems:
            if label != 1:  # the global Cartesian system of most programs
                undefined.setdefault(label, node)
            continue
        R = systems[label].at(places.get(node))
        kinds.add(systems[label].kind)
        if R is None:
            reason = (
                "has no radial direction there" if places.get(node) is not None else "needs the position of the node"
            )
            raise DataError(
                f"{path}: node {node} has displacements in the coordinate system {label}, which {reason}",
                "an export with displacements along Cartesian axes, such as the global ones",
            )
        if not np.array_equal(R, np.eye(3)):
            turned[k] = R
    notes = [
        f"{path.name} has displacements along spherical axes; their second component is assumed to be along the polar angle "
        "from the third axis, the third one along the azimuth"
    ] * (SPHERICAL in kinds)
    for label, node in list(undefined.items())[:1]:
        notes.append(
            f"{path.name} does not define the coordinate system {label} of the displacements of node {node}; the global "
            "axes are assumed"
        )
    return turned, tuple(notes)


def _systems(path: Path, sets: list[dict[str, Any]]) -> dict[int, CoordinateSystem]:
    """Return the coordinate systems of the sets 2420 by their labels, with the global one as 0."""
    systems = {0: CoordinateSystem(CARTESIAN, np.eye(3), np.zeros(3))}
    for block in sets:
        if block["type"] != 2420:
            continue
        for label, kind, matrix in zip(block["CS_sys_labels"], block["CS_types"], block["CS_matrices"], strict=True):
            rows = np.asarray(matrix, dtype=float)
            system = CoordinateSystem(int(kind), rows[:3], rows[3] if len(rows) > 3 else np.zeros(3))
            where = f"{path}: the coordinate system {int(label)}"
            if system.kind not in (CARTESIAN, CYLINDRICAL, SPHERICAL):
                raise DataError(
                    f"{where} has the unknown type {int(kind)}", "0, 1 or 2: Cartesian, cylindrical, spherical"
                )
            if not system.is_sound:
                raise DataError(
                    f"{where} has axes that are not perpendicular unit vectors", "the file as it was written"
                )
            before = systems.get(int(label), system)
            same = before.kind == system.kind and np.allclose(before.axes, system.axes, atol=1e-6)
            if label and not (same and np.allclose(before.origin, system.origin, rtol=1e-6, atol=1e-9)):
                raise DataError(f"{where} is defined twice", "one definition, or one part")
            systems[int(label)] = system
    return systems


class _Mode(NamedTuple):
    """A mode of a set; `unfit` says why a complex mode is not read as a real one, "" if it is."""

    frequency: float
    mass: float
    damping: float
    nodes: Any
    shape: Any
    scatter: float = 0.0
    unfit: str = ""


def _principal_angle(z: Any) -> float:
    """Return the angle of the principal axis of complex components, half the phase of sum(z^2) [rad]."""
    return 0.5 * float(np.angle(np.sum(np.square(z))))


def _phase_scatter(z: Any) -> float:
    """Return the RMS deviation of phases from the principal axis, weighted by amplitude [degrees]."""
    z = np.asarray(z) * np.exp(-1j * _principal_angle(z))
    return float(np.degrees(np.arctan2(np.linalg.norm(z.imag), np.linalg.norm(z.real))))


def _complex_mode(path: Path, block: dict[str, Any]) -> _Mode:
    """Return the real mode that is closest to a complex one."""
    nodes, z = _nodes_and_shape(path, block)
    if block["type"] == 55:
        eigenvalue, a = complex(block["eig"]), complex(block["modal_a"])
    else:
        values = [float(block[f"record13_field{k}"]) for k in range(1, 5)]
        eigenvalue, a = complex(*values[:2]), complex(*values[2:])
    angle, scatter = _principal_angle(z), _phase_scatter(z)
    omega, decay = abs(eigenvalue.imag), -eigenvalue.real
    unfit = ""
    if scatter > LARGEST_SCATTER:
        unfit = f"its phases scatter by {scatter:.3g} degrees; at most {LARGEST_SCATTER:g} are read as a real mode"
    elif not omega > 0 or decay < 0:
        unfit = f"its eigenvalue is {eigenvalue.real:.4g} {eigenvalue.imag:+.4g}i rad/s; a damped oscillation is needed"
    elif a:
        # A quarter of a turn apart, modal A belongs to another quantity, such as a velocity, or to another scale.
        phase = float(np.degrees(np.angle((a * np.exp(-2j * angle) / 1j) ** 2))) / 2
        if abs(phase) > _LARGEST_PHASE:
            unfit = f"its modal A is {phase:.3g} degrees from that of a normal mode of displacements"
    mass = abs(a) / (2 * omega) if omega > 0 else 0.0
    size = abs(eigenvalue)
    damping = decay / size if size > 0 and not unfit else 0.0
    return _Mode(size / (2 * np.pi), mass, damping, nodes, np.real(z * np.exp(-1j * angle)), scatter, unfit)


def _without_twins(sets: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the sets without those of type 55 if those of type 2414 are the same modes."""
    of_55 = [float(block["freq"]) for block in sets if block["type"] == 55 and "freq" in block]
    of_2414 = [float(block["record12_field2"]) for block in sets if block["type"] == 2414]
    if of_2414 and len(of_55) == len(of_2414) and np.allclose(of_55, of_2414, rtol=1e-4):
        return [block for block in sets if block["type"] == 2414]
    return sets


def _is_normal(block: dict[str, Any]) -> bool:
    return int(block["analysis_type"]) == _NORMAL_MODES


def _is_mode(block: dict[str, Any], wanted: tuple[int, ...], analyses: tuple[int, ...]) -> bool:
    """Return whether a set has a mode shape of these analyses; `wanted` are the types of data in the set 55."""
    if int(block["analysis_type"]) not in analyses:
        return False
    if block["type"] == 55:
        return int(block["spec_data_type"]) in wanted
    return int(block["result_type"]) == _DISPLACEMENT and int(block.get("dataset_location", 1)) == 1


def _nodes_and_shape(path: Path, block: dict[str, Any]) -> tuple[Any, Any]:
    """Return the nodes and the translations of a set, (n, 3)."""
    nodes = np.asarray(block["node_nums"])
    if block["type"] == 55:
        if int(block["n_data_per_node"]) not in (3, 6):
            raise DataError(
                f"{path}: a mode has {block['n_data_per_node']} values at a node; 3 or 6 are needed",
                "translations x, y, z",
            )
        shape = np.array([block[f"r{k}"] for k in (1, 2, 3)]).T
    else:
        table = np.atleast_2d(np.asarray(block["data_at_node"], dtype=complex))
        if int(block["data_type"]) in (5, 6) and not np.iscomplexobj(block["data_at_node"]):
            table = table[:, 0::2] + 1j * table[:, 1::2]
        shape = table[:, :3]
    if shape.shape != (len(nodes), 3):
        raise DataError(f"{path}: a mode has {shape.shape} components for {len(nodes)} nodes", "the complete file")
    return nodes, shape


def _mode(path: Path, block: dict[str, Any]) -> _Mode:
    """Return the normal mode of a set."""
    nodes, shape = _nodes_and_shape(path, block)
    if block["type"] == 55:
        values = block["freq"], block["modal_m"], block["modal_damp_vis"]
    else:
        values = block["record12_field2"], block["record12_field4"], block["record12_field5"]
    if np.abs(np.imag(shape)).max(initial=0.0) > _LARGEST_IMAGINARY * np.abs(shape).max(initial=0.0):
        raise DataError(f"{path}: the mode at {float(values[0]):.6g} Hz is complex", "an export of real normal modes")
    frequency, mass, damping = (float(value) for value in values)
    return _Mode(frequency, mass, damping, nodes, np.real(shape))


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


def _unit_of_quantity(sets: list[dict[str, Any]], quantity: int) -> tuple[tuple[int, str], ...]:
    """Return the unit of a quantity after the set 164, as a line of text; none for SI units, other quantities and units."""
    known, name = (_LENGTHS, "length") if quantity in (_DISPLACEMENT, _ACCELERATION) else (_FORCES, "force")
    if not sets or quantity not in (_DISPLACEMENT, _ACCELERATION, *_FORCE_TYPES):
        return ()
    factor = float(sets[0][name])
    unit = next((unit for size, unit in known.items() if abs(factor / size - 1) < 1e-3), "")
    if not unit:
        return () if abs(factor - 1) < 1e-3 else ((1, f"unit of the set 164: {name} {factor:g}"),)
    return ((1, f"the set 164, unit: {unit}/s^2" if quantity == _ACCELERATION else f"the set 164, unit: {unit}"),)


def read_functions(path: Path) -> list[Function]:
    """Read the functions of the sets 58 and 58b of a universal file.

    See Also
    --------
    read_universal_modes : Modes, with the source of the format.
    """
    with errors_of(path, "a universal file"):
        functions = []
        every = _read_sets(path, (58,), (164,))
        units = [block for block in every if block["type"] == 164]
        for number, block in enumerate((block for block in every if block["type"] == 58), start=1):
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
                    over=int(block.get("abscissa_spec_data_type", 0)),
                    abscissa_unit=_label(block, "abscissa"),
                    texts=tuple(str(block.get(f"id{k}", "")) for k in range(1, 6)),
                    units_of_file=_unit_of_quantity(units, int(block["ordinate_spec_data_type"])),
                )
            )
        return functions


@record_reader(".uff", ".unv", ".uf", starts_at_first=True)
def time_histories(path: Path) -> list[SignalInFile]:
    """Return the time histories among the functions of a universal file."""
    every = read_functions(path)
    return [
        SignalInFile(
            each.abscissa,
            np.asarray(each.values, dtype=float),
            each.name,
            each.unit or ("m/s" if each.quantities[0] == _VELOCITY else ""),
            each.abscissa_unit,
            each.units_of_file if not each.unit else (),
        )
        for each in every
        if each.is_history
    ] or _refuse(path, every, _TIME_RESPONSE)


@density_reader(".uff", ".unv", ".uf")
def densities(path: Path) -> list[DensityInFile]:
    """Return the power spectral densities among the functions of a universal file."""
    every = read_functions(path)
    chosen = [each for each in every if each.kind == _DENSITY] or _refuse(path, every, _DENSITY)
    for each in chosen:
        if each.over not in (0, _OVER_FREQUENCY):
            raise DataError(f"{path}: the density {each.name!r} is not over frequency", "a density over frequency")
        if np.iscomplexobj(each.values) and np.abs(np.imag(each.values)).max(initial=0.0) > 0:
            raise DataError(f"{path}: the density {each.name!r} is complex", "the density of one signal, which is real")
    return [
        DensityInFile(
            each.abscissa,
            np.real(each.values).astype(float),
            each.name,
            _unit_of_density(each),
            each.abscissa_unit,
            tuple(enumerate(each.texts, start=1)),
        )
        for each in chosen
    ]


def _unit_of_density(density: Function) -> str:
    """Return the unit of a density; some programs write its numerator, g^2, and its denominator, Hz, as two labels."""
    unit = density.unit
    return f"{unit}/Hz" if unit and "hz" not in unit.lower() and density.source_unit.lower() == "hz" else unit


def frequency_responses(path: Path) -> list[Function]:
    """Return the frequency response functions and transmissibilities among the functions of a universal file."""
    every = read_functions(path)
    kinds = (_FREQUENCY_RESPONSE, _TRANSMISSIBILITY)
    return [each for each in every if each.kind in kinds] or _refuse(path, every, _FREQUENCY_RESPONSE)


def _refuse(path: Path, functions: list[Function], wanted: int) -> NoReturn:
    """Raise for a file without functions of the wanted type: which it has, and what reads them."""
    words = [each.words() for each in functions]
    found = ", ".join(f"{words.count(word)} x {word}" for word in dict.fromkeys(words))
    kinds = sorted({_TIME_RESPONSE if each.is_history else each.kind for each in functions} - {wanted})
    readers = dict.fromkeys(f"{_USES[kind]} for a {_FUNCTIONS[kind]}" for kind in kinds if kind in _USES)
    exports = dict.fromkeys(_EXPORTS[kind] for kind in kinds if kind in _EXPORTS)
    name = "time history" if wanted == _TIME_RESPONSE else _FUNCTIONS[wanted]
    advice = "; ".join([*readers, *exports]) or f"an export of the {name} (type {wanted}) in a set 58"
    raise DataError(f"{path} contains no {name}, but {found}", advice)


@modes_reader(".uff", ".unv", ".uf")
def modes_of_universal(path: Path, request: ModesRequest) -> ModesInFile:
    """Read the modes of a universal file; units that contradict each other are no error if the user states them."""
    return read_universal_modes(path, needs_units=not request.has_mass_unit)


def _label(block: dict[str, Any], axis: str) -> str:
    """Return the unit of an axis; pyuff replaces the superscript 2 of other encodings by U+FFFD."""
    unit = str(block.get(f"{axis}_axis_units_lab", "")).strip().replace("\ufffd", "²")
    return "" if unit.upper() == "NONE" else unit
