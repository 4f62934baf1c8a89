"""Results of Ansys: modes in .rst files, matrices in .full files."""

from __future__ import annotations

import struct
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox._util.optional_imports import optional_import

from .modes_in_file import FloatArray, ModesInFile, read_start

_MASS_UNITS = {
    "SI": 1.0, "MKS": 1.0, "uMKS": 1.0, "CGS": 1e-3, "MPA": 1e3, "BFT": 14.593902937206, "BIN": 175.12683524648,
}  # fmt: skip
_MOST_DENSE = 400  # degrees of freedom up to which a dense solver is used


def _open(path: Path, kind: str) -> Any:
    """Return a reader of the file after checks of its header.

    Raises
    ------
    DataError
        If the file is not of this kind, has swapped bytes, or is cut short.
    """
    start = read_start(path, 8)
    words = struct.unpack("<ii", start) if len(start) == 8 else (0, 0)
    if words[0] != 100:
        swapped = len(start) == 8 and struct.unpack(">ii", start)[0] == 100
        raise DataError(
            f"{path} {'has big-endian bytes' if swapped else 'is not a binary file of Ansys'}",
            "a file that Ansys wrote on an x86 machine",
        )
    if path.stat().st_size < 4096:
        raise DataError(f"{path} ends within its header", "the complete file")
    reader = optional_import("ansys.mapdl.reader", "fe", "a modal table in CSV")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            standard = reader.common.read_standard_header(str(path))
            wanted = {"rst": 12, "full": 4}[kind]
            if int(standard["file format"]) != wanted:
                raise DataError(f"{path} is not a .{kind} file; its format is {int(standard['file format'])}")
            return reader.read_binary(str(path))
    except DataError:
        raise
    except Exception as error:
        raise DataError(
            f"{path} cannot be read as .{kind}: {str(error).strip() or type(error).__name__}", "the complete file"
        ) from None


def _check_size(path: Path, words: int) -> None:
    """Raise DataError if a file is shorter than its header states."""
    size = path.stat().st_size
    if size < 4 * words:
        raise DataError(f"{path} has {size} bytes, but its header states {4 * words}", "the complete file")


def read_result(path: Path) -> ModesInFile:
    """Read the modes of an Ansys result file.

    Parameters
    ----------
    path
        An existing .rst file of a modal analysis.

    Returns
    -------
    ModesInFile
        The modes, assumed to be mass-normalised.

    Raises
    ------
    DataError
        If the file is damaged or not of a modal analysis, or if all shapes have a largest component of 1, so that the modal
        masses are unknown.
    """
    result = _open(path, "rst")
    header = result._resultheader
    if int(header["kan"]) != 2:
        raise DataError(f"{path} has an analysis of type {int(header['kan'])}; type 2 (modal) is needed")
    if int(header["nSector"]) > 1:
        raise DataError(f"{path} has a cyclic sector, which is not supported", "modes of the whole structure")
    _check_size(path, int(header["ptrend"]))
    try:
        shapes = [np.asarray(result.nodal_solution(k)[1], dtype=float) for k in range(int(result.n_results))]
        nodes = result.nodal_solution(0)[0]
    except Exception as error:
        raise DataError(f"{path}: the modes cannot be read: {error}", "the complete file") from None
    modes = np.array(shapes)[:, :, :3]
    if modes.shape[2] != 3 or not np.isfinite(modes).all():
        raise DataError(f"{path}: the modes have {modes.shape[2]} components at nodes; three finite ones are needed")
    largest = np.abs(modes).max(axis=(1, 2))
    if len(largest) > 1 and np.allclose(largest, 1.0, rtol=1e-9):
        raise DataError(
            f"{path}: every mode has a largest component of 1, so that the modal masses are unknown",
            "MODOPT with Nrmkey = OFF, for modes that are mass-normalised; or modal_masses",
        )
    return ModesInFile(
        frequencies=np.asarray(result.time_values, dtype=float),
        shapes={str(int(node)): modes[:, k] for k, node in enumerate(nodes)},
        mass_unit=_MASS_UNITS.get(str(header["units"])),
        notes=(
            f"the modes of {path.name} are assumed to be mass-normalised, the default of Ansys (MODOPT, Nrmkey = OFF)",
        ),
    )


def read_full(path: Path, count: int) -> ModesInFile:
    """Read the matrices of an Ansys .full file and compute their lowest modes.

    Parameters
    ----------
    path
        An existing .full file.
    count
        Number of modes.

    Returns
    -------
    ModesInFile
        Mass-normalised modes, and their participation in motions of the base along x, y and z, without the mass at the
        supports.

    Raises
    ------
    DataError
        If the file is damaged, or contains no mass matrix.
    """
    from scipy.sparse import csr_array, triu

    file = _open(path, "full")
    _check_size(path, int(file._header["ptrEND"]))
    if not int(file._header["ntermMl"]):
        raise DataError(f"{path} contains no mass matrix", "the .full file of a modal analysis")
    try:
        numbers, stiffness, mass = file.load_km(sort=False)
    except Exception as error:
        raise DataError(f"{path}: the matrices cannot be read: {error}", "the complete file") from None
    K, M = (csr_array(matrix + triu(matrix, 1).T) for matrix in (csr_array(stiffness), csr_array(mass)))
    fixed = {(int(node), int(axis)) for node, axis in np.atleast_2d(file.const)[:, :2]} if len(file.const) else set()
    free = np.array([(int(node), int(axis)) not in fixed for node, axis in numbers])
    values, free_vectors = lowest_modes(K[free][:, free], M[free][:, free], count)
    axes = numbers[:, 1]
    vectors = np.zeros((len(numbers), values.size))
    vectors[free] = free_vectors
    directions = np.array([axes == axis for axis in range(3)], dtype=float).T
    directions[~free] = 0.0
    shapes = {}
    for node in np.unique(numbers[:, 0]):
        shapes[str(int(node))] = np.zeros((values.size, 3))
    for row, (node, axis) in enumerate(numbers):
        if axis < 3:
            shapes[str(int(node))][:, axis] = vectors[row]
    return ModesInFile(
        frequencies=np.sqrt(values) / (2 * np.pi),
        shapes=shapes,
        participation=vectors.T @ (M @ directions),
        total_mass=np.asarray(directions.T @ (M @ directions)).diagonal().copy(),
    )


def lowest_modes(stiffness: Any, mass: Any, count: int) -> tuple[FloatArray, FloatArray]:
    """Compute the lowest modes of sparse matrices.

    Parameters
    ----------
    stiffness, mass : (n, n) sparse array
        K and M, symmetric.
    count
        Number of modes.

    Returns
    -------
    (m,) float
        Squared angular frequencies [rad^2/s^2], ascending; those of rigid-body modes are exactly zero.
    (n, m) float
        Mass-normalised mode shapes.

    Raises
    ------
    DataError
        If M is not positive definite, or K not positive semidefinite.
    """
    from scipy.linalg import LinAlgError, eigh
    from scipy.sparse.linalg import eigsh

    n = stiffness.shape[0]
    count = min(count, n)
    scale = float(np.median(np.abs(stiffness.diagonal())) / np.median(np.abs(mass.diagonal())))
    try:
        if n <= _MOST_DENSE or count > n // 3:
            values, vectors = eigh(stiffness.toarray(), mass.toarray(), subset_by_index=(0, count - 1))
        else:  # with a shift below zero the shifted matrix is regular in spite of rigid-body modes
            start = np.random.default_rng(0).standard_normal(n)
            values, vectors = eigsh(stiffness, count, mass, sigma=-1e-6 * scale, v0=start, tol=1e-12)
    except (LinAlgError, RuntimeError, ValueError) as error:
        raise DataError(
            f"the modes of K and M cannot be computed: {error}", "a positive definite mass matrix"
        ) from None
    order = np.argsort(values)
    values, vectors = values[order], vectors[:, order]
    if values[0] < -1e-7 * scale:
        raise DataError("K is not positive semidefinite: the structure would be unstable")
    return np.where(values < 1e-9 * scale, 0.0, values), np.asarray(vectors)
