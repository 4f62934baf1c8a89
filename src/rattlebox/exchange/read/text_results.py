"""Modes in text results of finite element programs: Nastran (.f06, .pch) and CalculiX (.frd, .dat)."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from rattlebox._util.exceptions import DataError

from .formats import ModesRequest, modes_reader
from .guarded import errors_of
from .modes_in_file import FloatArray, ModesInFile, read_start, without_rounding

_NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[EeDd][-+]?\d+)?"
_F06_VECTOR = re.compile(r"(R E A L|C O M P L E X)\s+E I G E N V E C T O R\s+N\s?O\s?\.\s+(\d+)")
_F06_ABOVE = re.compile(rf"^0?\s*EIGENVALUE\s*=\s*({_NUMBER})\s*$")
_F06_STAGE = re.compile(r"\((BEFORE AUGMENTATION|AFTER AUGMENTATION|ACTUAL MODES USED)")
_SAME = 1e-3  # relative difference of eigenvalues that are printed twice
_F06_ROW = re.compile(rf"^0?\s*(\d+)\s+([GS])((?:\s+{_NUMBER}){{1,6}})\s*$")
_F06_VALUE = re.compile(rf"^0?\s*(\d+)\s+(\d+)((?:\s+{_NUMBER}){{5}})\s*$")
_PUNCH_VALUE = re.compile(rf"^\$EIGENVALUE\s*=\s*({_NUMBER})\s+MODE\s*=\s*(\d+)")
_DAT_STARTS = rb" for set \S+ and time |E I G E N V A L U E   O U T P U T|S T E P +\d"  # in the first lines
_ROUNDING = 1e-3  # relative rounding of the numbers in tables of .dat files
NORMALISED = "the modes of {} are assumed to be mass-normalised, the default of Nastran (EIGRL, NORM = MASS)"
AXES = "the displacements of {} are assumed to be along the global axes: Nastran does not write the axes (CD) of its points"

Table = dict[int, dict[int, list[float]]]
"""Displacements x, y, z by mode and node."""


def _lines(path: Path) -> list[str]:
    """Return the lines of a text file."""
    read_start(path, 64)
    return path.read_bytes().decode("latin-1").splitlines()


def _floats(path: Path, number: int, texts: list[str]) -> list[float]:
    """Return numbers of a line; Fortran writes exponents with D, and of three digits without a letter."""
    try:
        values = [
            float(re.sub(r"(?<=\d)([-+]\d{3})$", r"E\1", text.strip().upper().replace("D", "E"))) for text in texts
        ]
    except ValueError:
        raise DataError(f"{path}, line {number}: {' '.join(texts)[:80]!r} are not numbers", "numbers") from None
    if not np.isfinite(values).all():
        raise DataError(f"{path}, line {number}: a number is not finite", "the file as the program wrote it")
    return values


def _made(
    path: Path,
    squares: dict[int, float],
    shapes: Table,
    masses: dict[int, float] | None,
    notes: tuple[str, ...],
) -> ModesInFile:
    """Return the modes from squared angular frequencies, shapes and modal masses by number of the mode."""
    if not shapes:
        raise DataError(
            f"{path} contains no mode shape", "the displacements of all modes in the output of the analysis"
        )
    numbers = sorted(shapes)
    for number in numbers:
        if number not in squares:
            raise DataError(f"{path} states no eigenvalue of mode {number}", "the complete file")
        if shapes[number].keys() != shapes[numbers[0]].keys():
            raise DataError(
                f"{path}: mode {number} has other nodes than mode {numbers[0]}", "the complete file, of one analysis"
            )
        if masses is not None and number not in masses:
            raise DataError(f"{path} states no modal mass of mode {number}", "the complete file")
    nodes = sorted(shapes[numbers[0]])
    return modes_of_eigenvalues(
        path,
        np.array([squares[number] for number in numbers]),
        np.array([[shapes[number][node] for node in nodes] for number in numbers], dtype=float),
        [str(node) for node in nodes],
        None if masses is None else np.array([masses[number] for number in numbers]),
        notes,
    )


def modes_of_eigenvalues(
    path: Path,
    squares: FloatArray,
    shapes: FloatArray,
    nodes: list[str],
    masses: FloatArray | None,
    notes: tuple[str, ...],
) -> ModesInFile:
    """Return the modes from squared angular frequencies (m,), shapes (m, n, 3) and modal masses (m,)."""
    squares = without_rounding(squares)
    if (squares < 0).any():
        raise DataError(f"{path} has a negative eigenvalue", "a structure that is stable")
    # A file without modal masses may be scaled to a largest component of 1, which it does not state.
    if masses is None and len(shapes) > 1 and np.allclose(np.abs(shapes).max(axis=(1, 2)), 1.0, rtol=1e-5):
        raise DataError(
            f"{path}: every mode has a largest component of 1, so that the modal masses are unknown",
            'modal_masses = ["1 kg", ...], or modes that are mass-normalised',
        )
    return ModesInFile(
        frequencies=np.sqrt(squares) / (2 * np.pi),
        shapes={node: shapes[:, k] for k, node in enumerate(nodes)},
        modal_masses=masses,
        notes=notes,
    )


def _add(path: Path, number: int, shape: dict[int, list[float]], node: int, row: list[float]) -> None:
    """Add the displacements of a node to a mode; raise if it has others already."""
    if shape.setdefault(node, row) != row:
        raise DataError(f"{path}, line {number}: node {node} is in the same mode twice", "the results of one analysis")


@modes_reader(".f06")
def read_f06(path: Path, _: ModesRequest) -> ModesInFile:
    """Read the tables of real eigenvalues and eigenvectors of a Nastran .f06 file; those with residual vectors, if any."""
    with errors_of(path, "a .f06 file of Nastran"):
        squares: dict[int, float] = {}
        masses: dict[int, float] = {}
        shapes: Table = {}
        table, current, stage = "", 0, ""
        stated: dict[int, float] = {}  # eigenvalues above the eigenvectors
        above = 0.0
        for number, line in enumerate(_lines(path), start=1):
            if found := _F06_ABOVE.search(line):
                above = _floats(path, number, [found[1]])[0]
            elif found := _F06_STAGE.search(line):
                # Residual vectors give a second table, which replaces the first; pages repeat its heading.
                if found[1] != stage:
                    squares, masses, stage = {}, {}, found[1]
            elif found := _F06_VECTOR.search(line):
                if found[1] != "R E A L":
                    raise DataError(
                        f"{path}, line {number}: complex modes are not read from .f06 files",
                        "a real analysis (SOL 103)",
                    )
                table, current = "vector", int(found[2])
                shapes.setdefault(current, {})
                stated[current] = above
            elif "R E A L   E I G E N V A L U E S" in line:
                table = "values"
            elif line.startswith("1") or "    PAGE " in line:  # a table goes on below its heading on the next page
                table = ""
            elif table == "vector" and (found := _F06_ROW.match(line)):
                row = _floats(path, number, found[3].split())
                if found[2] == "S":  # a scalar point has no directions
                    continue
                if len(row) != 6:
                    raise DataError(f"{path}, line {number}: {len(row)} components; T1 to R3 are needed", "six numbers")
                _add(path, number, shapes[current], int(found[1]), row[:3])
            elif table == "values" and (found := _F06_VALUE.match(line)):
                row = _floats(path, number, found[3].split())
                mode = int(found[1])
                if squares.setdefault(mode, row[0]) != row[0]:
                    raise DataError(
                        f"{path}, line {number}: mode {mode} has two eigenvalues", "the results of one analysis"
                    )
                masses[mode] = row[3]
        largest = max(map(abs, squares.values()), default=0.0)
        for mode, value in stated.items():
            if abs(squares.get(mode, value) - value) > _SAME * max(abs(value), _SAME * largest):
                raise DataError(
                    f"{path}: mode {mode} has the eigenvalue {value:g} above its shape, but {squares[mode]:g} in the table",
                    "the results of one analysis",
                )
        notes = [AXES.format(path.name)]
        if len(shapes) < len(squares):
            notes.append(
                f"{path.name} has the shapes of {len(shapes)} of its {len(squares)} modes; the others are left out"
            )
        return _made(path, squares, shapes, masses, tuple(notes))


@modes_reader(".pch")
def read_punch(path: Path, _: ModesRequest) -> ModesInFile:
    """Read the eigenvectors of a punch file of Nastran."""
    with errors_of(path, "a punch file of Nastran"):
        squares: dict[int, float] = {}
        shapes: Table = {}
        current, is_vector, node, count = 0, False, 0, 0
        for number, line in enumerate(_lines(path), start=1):
            line = line[:72]  # the last eight columns number the lines
            if line.startswith("$"):
                if found := _PUNCH_VALUE.match(line):
                    current = int(found[2])
                    squares[current] = _floats(path, number, [found[1]])[0]
                elif re.match(r"\$[A-Z ]*EIGENVECTOR", line):
                    is_vector = True
                elif line.startswith("$COMPLEX") or "REAL-IMAGINARY" in line or "MAGNITUDE-PHASE" in line:
                    if is_vector:
                        raise DataError(f"{path}, line {number}: the modes are complex", "a real analysis (SOL 103)")
                elif re.match(r"\$(SPCF|MPCF|STRESS|STRAIN|ELEMENT|DISPL|VELO|ACCE|GRID|ESE|OLOAD)", line):
                    is_vector = False
                continue
            if not is_vector or not current or not line.strip():
                continue
            cells = [line[k : k + 18] for k in (18, 36, 54)]
            if line.startswith("-CONT-"):  # rotations
                count += 1
                continue
            kind, label = line[10:18].strip(), line[:10].strip()
            if kind == "S":
                continue
            if kind != "G" or not label.isdigit():
                raise DataError(
                    f"{path}, line {number}: {line.strip()[:60]!r} is no point (G) of a mode", "a number and G"
                )
            node = int(label)
            _add(path, number, shapes.setdefault(current, {}), node, _floats(path, number, cells))
        notes = (NORMALISED.format(path.name), AXES.format(path.name))
        return _made(path, squares, shapes, None, notes)


def _frd_steps(path: Path, lines: list[str]) -> Iterator[tuple[dict[str, float], dict[int, list[float]]]]:
    """Yield values (PGM, PGK, PMODE) and displacements of each mode."""
    values: dict[str, float] = {}
    shape: dict[int, list[float]] | None = None
    for number, line in enumerate(lines, start=1):
        if line.startswith("    1PSTEP"):
            values = {}
        elif found := re.match(r"    1(PGM|PGK|PMODE)\s+(\S+)", line):
            values[found[1]] = _floats(path, number, [found[2]])[0]
        elif line.startswith("  100C") and line[73:75].strip() not in ("0", "1", ""):
            raise DataError(f"{path}, line {number}: the results are binary", "*NODE FILE, which writes text")
        elif line.startswith(" -4"):
            shape = {} if line[5:13].strip() == "DISP" and "PMODE" in values else None
        elif line.startswith(" -1") and shape is not None:
            texts = [line[13 + 12 * k : 25 + 12 * k] for k in range(3)]
            label = line[3:13].strip()
            if not label.isdigit():
                raise DataError(f"{path}, line {number}: {label!r} is no number of a node", "an integer in ten columns")
            _add(path, number, shape, int(label), _floats(path, number, texts))
        elif line.startswith(" -3") and shape is not None:
            yield values, shape
            shape = None
    if shape is not None:
        raise DataError(f"{path} ends within the displacements of a mode", "the complete file")


@modes_reader(".frd")
def read_frd(path: Path, _: ModesRequest) -> ModesInFile:
    """Read the modes of a .frd file of CalculiX, with the generalized mass and stiffness of each."""
    with errors_of(path, "a .frd file of CalculiX"):
        lines = _lines(path)
        if not lines[0].startswith("    1C"):
            raise DataError(f"{path}, line 1: {lines[0][:20]!r} is no start of a .frd file", "    1C")
        squares, masses, shapes = {}, {}, {}
        for values, shape in _frd_steps(path, lines):
            mode = int(values["PMODE"])
            if mode in shapes:
                raise DataError(f"{path}: mode {mode} is in the file twice", "the results of one frequency step")
            if "PGM" not in values or "PGK" not in values or not values["PGM"] > 0:
                raise DataError(f"{path}: mode {mode} has no generalized mass and stiffness", "1PGM and 1PGK above it")
            masses[mode], squares[mode] = values["PGM"], values["PGK"] / values["PGM"]
            shapes[mode] = shape
        return _made(path, squares, shapes, masses, ())


def _tables_of_dat(path: Path) -> tuple[dict[str, dict[int, list[float]]], list[float], Table]:
    """Return the rows of each table of a .dat file by mode, the total effective masses, and the displacements."""
    rows: dict[str, dict[int, list[float]]] = {}
    total: list[float] = []
    shapes: Table = {}
    table, mode, is_shape = "", 0, False
    for number, line in enumerate(_lines(path), start=1):
        cells = line.split()
        # Headings: of a mode, of a table, and of displacements of the present mode.
        if found := re.match(r"^ +E I G E N V A L U E    N U M B E R +(\d+)", line):
            table, mode, is_shape = "", int(found[1]), False
        elif re.match(r"^ +[A-Z] [A-Z] ", line):
            table, is_shape = line.replace(" ", ""), False
            if table in rows:
                raise DataError(
                    f"{path}, line {number}: {line.strip()} is in the file twice",
                    "the results of one frequency step",
                )
            rows[table] = {}
            mode = 0
        elif " for set " in line and " and time " in line:
            is_shape = bool(mode) and line.startswith(" displacements (vx,vy,vz)")
        elif "NODAL" in cells or "DIAMETER" in cells:
            raise DataError(f"{path}, line {number}: the modes are those of a cyclic sector", "the whole structure")
        elif not cells:
            continue
        elif is_shape:
            if cells[-1] == "L":
                raise DataError(
                    f"{path}, line {number}: displacements are along local axes (*TRANSFORM)",
                    "*NODE PRINT, GLOBAL=YES",
                )
            label, texts = line[:10].strip(), [line[10 + 14 * k : 24 + 14 * k] for k in range(3)]
            if not label.isdigit():
                raise DataError(f"{path}, line {number}: {label[:20]!r} is no number of a node", "an integer")
            _add(path, number, shapes.setdefault(mode, {}), int(label), _floats(path, number, texts))
        elif table and cells[0].isdigit():
            rows[table][int(cells[0])] = _floats(path, number, cells[1:])
        elif table == "TOTALEFFECTIVEMASS" and cells[0] != "MODE":
            total = _floats(path, number, cells)
    return rows, total, shapes


@modes_reader(contents=_DAT_STARTS)
def read_dat(path: Path, _: ModesRequest) -> ModesInFile:
    """Read the modes of a .dat file of CalculiX: eigenvalues, participation, and displacements of *NODE PRINT.

    Notes
    -----
    The modes are mass-normalised: the effective masses are the squares of the participation, which is checked.
    """
    with errors_of(path, "a .dat file of CalculiX"):
        rows, total, shapes = _tables_of_dat(path)
        values = rows.get("EIGENVALUEOUTPUT")
        if not values:
            raise DataError(f"{path} contains no table of eigenvalues", "the results of a step with *FREQUENCY")
        if not shapes:
            raise DataError(
                f"{path} contains no mode shape",
                "*NODE PRINT, NSET=..., GLOBAL=YES with U in the step; or the .frd file",
            )
        if missing := sorted(values.keys() - shapes.keys()):
            raise DataError(f"{path} ends before the displacements of mode {missing[0]}", "the complete file")
        if bad := next((mode for mode, row in values.items() if len(row) != 4), 0):
            raise DataError(f"{path}: the eigenvalue of mode {bad} has {len(values[bad])} columns", "four numbers")
        factors = rows.get("PARTICIPATIONFACTORS", {})
        effective = rows.get("EFFECTIVEMODALMASS", {})
        modes = _made(path, {mode: row[0] for mode, row in values.items()}, shapes, None, ())
        if not all(len(factors.get(mode, ())) == 6 == len(effective.get(mode, ())) for mode in shapes):
            raise DataError(f"{path} states no participation or effective mass of a mode", "the complete file")
        participation = np.array([factors[mode][:3] for mode in sorted(shapes)])
        masses = np.array([effective[mode][:3] for mode in sorted(shapes)])
        if not np.allclose(participation**2, masses, rtol=_ROUNDING, atol=_ROUNDING**2 * masses.max(initial=0.0)):
            raise DataError(
                f"{path}: the effective masses are not the squares of the participation: the modes are not mass-normalised",
                "the file as CalculiX wrote it",
            )
        return replace(modes, participation=participation, total_mass=np.array(total[:3]) if len(total) == 6 else None)
