"""Results of Ansys: modes in .rst files, matrices in .full files."""

from __future__ import annotations

import struct
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox._util.optional_imports import optional_import

from .formats import ModesRequest, modes_reader
from .guarded import arrays_from_child, errors_of
from .modes_in_file import FloatArray, ModesInFile, read_start, without_rounding

_MASS_UNITS = {
    "SI": 1.0, "MKS": 1.0, "uMKS": 1.0, "CGS": 1e-3, "MPA": 1e3, "BFT": 14.593902937206, "BIN": 175.12683524648,
}  # fmt: skip
_DEFAULT_MODES = 10  # number of modes computed from a .full file
_MOST_DENSE = 400  # degrees of freedom up to which a dense solver is used


def _read_arrays(path: Path, kind: str) -> dict[str, Any]:
    """Return the arrays of a file, see `ansys_arrays`."""
    start = read_start(path, 8)
    words = struct.unpack("<ii", start) if len(start) == 8 else (0, 0)
    if words[0] != 100:
        swapped = len(start) == 8 and struct.unpack(">ii", start)[0] == 100
        raise DataError(
            f"{path} {'has big-endian bytes' if swapped else 'is not a binary file of Ansys'}",
            "a file that Ansys wrote on an x86 machine",
        )
    stat = path.stat()
    if stat.st_size < 4096:
        raise DataError(f"{path} ends within its header", "the complete file")
    return _read_once(path, kind, stat.st_mtime_ns, stat.st_size)


@lru_cache(maxsize=4)
def _read_once(path: Path, kind: str, modified: int, size: int) -> dict[str, Any]:
    """Return the arrays of a file; those of the last files are cached until the files change."""
    optional_import("ansys.mapdl", "fe", "a modal table in CSV")
    return arrays_from_child(path, kind)


@modes_reader(".rst")
def read_result(path: Path, _: ModesRequest) -> ModesInFile:
    """Read the modes of an Ansys result file."""
    with errors_of(path, "a result of Ansys"):
        result = _read_arrays(path, "rst")
        if result["analysis"] != 2:
            raise DataError(
                f"{path} has an analysis of type {result['analysis']}; type 2 (modal) is needed",
                "the result of a modal analysis",
            )
        if result["sectors"] > 1:
            raise DataError(f"{path} has a cyclic sector, which is not supported", "modes of the whole structure")
        modes = result["shapes"][:, :, :3]
        if modes.shape[2] != 3 or not np.isfinite(modes).all():
            raise DataError(
                f"{path}: the modes have {modes.shape[2]} components at nodes; three finite ones are needed",
                "a model in 3-D, with translations along x, y and z",
            )
        # Ansys can scale modes to a largest component of 1, which the file does not state. It is seen in the numbers.
        largest = np.abs(modes).max(axis=(1, 2))
        if len(largest) > 1 and np.allclose(largest, 1.0, rtol=1e-9):
            raise DataError(
                f"{path}: every mode has a largest component of 1, so that the modal masses are unknown",
                "MODOPT with Nrmkey = OFF, for modes that are mass-normalised; or modal_masses",
            )
        return ModesInFile(
            frequencies=np.sqrt(without_rounding(np.square(np.asarray(result["frequencies"], dtype=float)))),
            shapes={str(int(node)): modes[:, k] for k, node in enumerate(result["nodes"])},
            mass_unit=_MASS_UNITS.get(str(result["units"])),
            notes=(
                f"the modes of {path.name} are assumed to be mass-normalised, the default of Ansys (MODOPT, Nrmkey = OFF)",
            ),
        )


@modes_reader(".full")
def read_full(path: Path, request: ModesRequest) -> ModesInFile:
    """Read the matrices of an Ansys .full file and compute their lowest modes.

    Notes
    -----
    The participation is phi^T M r, with r = 1 for the free degrees of freedom along an axis and 0 for all others; the total
    mass is r^T M r. `lowest_modes` names the method and its source.
    """
    with errors_of(path, "matrices of Ansys"):
        from scipy.sparse import coo_array, csr_array, triu

        arrays = _read_arrays(path, "full")
        numbers, n = arrays["rows"], len(arrays["rows"])
        upper = [
            coo_array(
                (arrays[f"{name}_value"], (arrays[f"{name}_row"], arrays[f"{name}_column"])), shape=(n, n)
            ).tocsr()
            for name in ("K", "M")
        ]
        # The file holds one triangle. Supported degrees of freedom are in it, too, and are removed: otherwise each
        # would be a mode of frequency zero.
        K, M = (csr_array(matrix + triu(matrix, 1).T) for matrix in upper)
        fixed = {(int(node), int(axis)) for node, axis in arrays["fixed"][:, :2]}
        free = np.array([(int(node), int(axis)) not in fixed for node, axis in numbers])
        values, free_vectors = lowest_modes(K[free][:, free], M[free][:, free], request.count or _DEFAULT_MODES)
        axes = numbers[:, 1]
        vectors = np.zeros((len(numbers), values.size))
        vectors[free] = free_vectors
        # A rigid motion along an axis moves the free translations; rotations and supports do not take part.
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

    `stiffness` and `mass`: K and M, symmetric. Returns squared angular frequencies [rad^2/s^2], ascending; those of
    rigid-body modes are exactly zero, (m,); and mass-normalised mode shapes, (n, m).

    Notes
    -----
    K phi = omega^2 M phi with phi^T M phi = 1. Up to 400 degrees of freedom all eigenvalues are computed by LAPACK, above by
    the Lanczos method of ARPACK for (K - s M)^(-1) M, with a shift s slightly below zero.

    References
    ----------
    R. B. Lehoucq, D. C. Sorensen, C. Yang (1998), ARPACK Users' Guide, SIAM, doi:10.1137/1.9780898719628.
    """
    from scipy.linalg import LinAlgError, eigh
    from scipy.sparse.linalg import eigsh

    n = stiffness.shape[0]
    count = min(count, n)
    # A typical squared frequency of the matrices is the unit of shift and tolerances, whatever the units of the file.
    scale = float(np.median(np.abs(stiffness.diagonal())) / np.median(np.abs(mass.diagonal())))
    try:
        if n <= _MOST_DENSE or count > n // 3:
            values, vectors = eigh(stiffness.toarray(), mass.toarray(), subset_by_index=(0, count - 1))
        else:  # With a shift below zero the shifted matrix is regular in spite of rigid-body modes.
            start = np.random.default_rng(0).standard_normal(n)
            values, vectors = eigsh(stiffness, count, mass, sigma=-1e-6 * scale, v0=start, tol=1e-12)
    except (LinAlgError, RuntimeError, ValueError) as error:
        raise DataError(
            f"the modes of K and M cannot be computed: {error}", "a positive definite mass matrix"
        ) from None
    order = np.argsort(values)
    values, vectors = values[order], vectors[:, order]
    if values[0] < -1e-7 * scale:
        raise DataError(
            "K is not positive semidefinite: the structure would be unstable",
            "a model without prestress beyond buckling",
        )
    return np.where(values < 1e-9 * scale, 0.0, values), np.asarray(vectors)
