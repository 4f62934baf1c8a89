"""Structures defined by mass, damping and stiffness matrices."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from rattlebox._util.exceptions import DataError
from rattlebox.exchange.read.matrix_market import read_matrix
from rattlebox.exchange.read.modes_in_file import listed

from .base import FilePart
from .elementwise import Vector
from .errors import Hint, at, nearest
from .files import absolute, check_finite, existing, read_arrays
from .modes import ModalModel
from .structures import DampedModes, Matrix, Numbers, Point, Weights
from .units import SI

if TYPE_CHECKING:
    from typing import Self


class Matrices(FilePart, DampedModes):
    r"""Structure defined by its mass, damping and stiffness matrices.

    The structure is transformed to the modes of the undamped structure; all modes are used. C is any symmetric, positive
    semidefinite matrix. If it is not diagonal in these modes, it couples them: flights are then computed as Taylor series,
    step by step, which takes longer. `damping_ratio` and `rayleigh` are alternatives.

    Parameters
    ----------
    M, C, K
        Mass, damping and stiffness matrices, (n, n), SI units; default without damping.
    points
        Named points: index of the degree of freedom, from 0, or a vector of n weights; three vectors, along x, y and z, for
        a point in 3-D.
    file
        Files in place of M, C and K: in Matrix Market format, `{"M": "M.mtx", "K": "K.mtx"}`, or a NPZ or MAT file with full
        or sparse matrices of these names. NPZ and MAT files may also contain points as vectors of weights: `point_tip` for
        a point "tip", or the fields of a struct `points`. Points of the case override those of the file.
    influence
        Motion of each degree of freedom with the base; default 1 for all. With points in 3-D, three rows for motion of the
        base along x, y and z, which are then needed for base motion.
    displacement, velocity
        Initial displacements and velocities of the degrees of freedom [m], [m/s]; default 0.

    Notes
    -----
    .. math:: M \ddot z + C \dot z + K z = F - M r a

    with the influence :math:`r` and the acceleration :math:`a` of the base. The modes solve
    :math:`K \phi = \omega^2 M \phi` with :math:`\phi^T M \phi = 1`, and :math:`z = \phi q`. `Modal` has the equations of
    the modal displacements q and their sources.
    """

    elementwise: ClassVar[bool] = False
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (
        ("C", "damping_ratio"),
        ("C", "rayleigh"),
        ("damping_ratio", "rayleigh"),
    )
    file_fields: ClassVar[tuple[str, ...]] = ("M", "C", "K")
    is_truncated: ClassVar[bool] = False
    kind: Literal["matrices"] = "matrices"
    M: Annotated[Matrix, SI("kg")] = Field(examples=[[[2, 0], [0, 1]]])
    C: Annotated[Matrix | None, SI("N s/m")] = None
    K: Annotated[Matrix, SI("N/m")] = Field(examples=[[[3e4, -1e4], [-1e4, 1e4]]])
    points: dict[str, Point] = Field(examples=[{"tip": 1}])
    file: str | dict[Literal["M", "C", "K"], str] | None = None
    influence: Weights | None = None
    displacement: Annotated[Numbers | None, SI("m")] = None
    velocity: Annotated[Numbers | None, SI("m/s")] = None

    @model_validator(mode="before")
    @classmethod
    def _from_file(cls, values: object) -> Any:
        if not isinstance(values, dict) or values.get("file") is None:
            return values
        twice = sorted({"M", "C", "K"} & set(values))
        if twice:
            raise Hint(f"give {twice[0]} or a file, not both", "one of them")
        with at("file"):
            path: str | dict[str, str]
            if isinstance(values["file"], dict):
                path, matrices = _read_each(values["file"])
                points: dict[str, Vector] = {}
            else:
                path = absolute(values["file"])
                matrices, points = _read_matrices(path)
        own = values.get("points")
        if own is not None and not isinstance(own, dict):
            return values
        return {**values, **matrices, "points": points | (own or {}), "file": path}

    @model_validator(mode="after")
    def _validate(self) -> Self:
        mass, damping, stiffness = self.matrices()
        n = len(self.M)
        for name, matrix in (("M", mass), ("C", damping), ("K", stiffness)):
            if matrix.shape != (n, n) or n == 0:
                raise Hint(
                    f"{name} has shape {matrix.shape}" + (f", but M has {n} rows" if name != "M" else ""),
                    "three square matrices of one size",
                    self._where(name),
                )
            if not np.allclose(matrix, matrix.T, rtol=1e-12, atol=1e-12 * np.abs(matrix).max(initial=0)):
                raise Hint(
                    f"{name} is not symmetric",
                    f"{name} = ({name} + {name}^T) / 2, if the difference is rounding",
                    self._where(name),
                )
        # A degree of freedom without mass has an infinite frequency.
        if np.linalg.eigvalsh(mass).min() <= 0:
            raise Hint(
                "M is not positive definite: some motion has no mass",
                "a mass at each degree of freedom, or matrices without those that have none",
                self._where("M"),
            )
        if not self.points:
            raise Hint("at least one named point is needed", "points = { tip = 0 }", ["points"])
        for name, point in self.points.items():
            if isinstance(point, int) and not 0 <= point < n:
                raise Hint("there is no such degree of freedom", f"0 to {n - 1}", ["points", name])
            if not isinstance(point, int) and np.shape(point)[-1] != n:
                raise Hint(
                    f"{np.shape(point)[-1]} weights, but there are {n} degrees of freedom",
                    f"{n} weights, or the number of a degree of freedom",
                    ["points", name],
                )
        for name in ("influence", "displacement", "velocity"):
            row = getattr(self, name)
            if row is not None and np.shape(row)[-1] != n:
                raise Hint(f"{np.shape(row)[-1]} numbers, but there are {n} degrees of freedom", f"{n} numbers", [name])
        if self.influence is not None and (np.ndim(self.influence) == 2) != bool(self._spatial()):
            rows = "three rows, for x, y and z" if self._spatial() else "one row of numbers"
            raise Hint("influence has three rows if points move in 3-D, else one", rows, ["influence"])
        self.modes()
        return self

    def _spatial(self) -> frozenset[str]:
        """Return the points that move in 3-D."""
        return frozenset(name for name, point in self.points.items() if np.ndim(point) == 2)

    def _where(self, name: str) -> list[str]:
        """Return the field with a matrix, for messages."""
        if isinstance(self.file, dict):
            return ["file", name]
        return ["file"] if self.file else [name]

    @classmethod
    def from_file(cls, path: str | os.PathLike[str] | Mapping[str, str | os.PathLike[str]], **options: Any) -> Matrices:
        """Read a structure from a NPZ or MAT file, or from Matrix Market files.

        Parameters
        ----------
        path
            The file, with M, K, optionally C, and points as `point_<name>` or in a struct `points`. Matrix Market files by
            the name of their matrix: `{"M": "M.mtx", "K": "K.mtx"}`.
        **options
            points, influence, displacement, velocity.

        Returns
        -------
        Matrices
            The structure.

        Raises
        ------
        DataError
            If a file cannot be read, or contains no such matrix; the message lists its content.
        CaseError
            If a matrix is invalid.
        """
        each = {name: os.fspath(file) for name, file in path.items()} if isinstance(path, Mapping) else os.fspath(path)
        return cls(**{"file": each, **options})

    def notes(self) -> Iterator[str]:
        """Yield the units that are assumed for matrices from files, which state none."""
        if self.file is None:
            return
        paths = [self.file] if isinstance(self.file, str) else list(self.file.values())
        names = listed(list(dict.fromkeys(Path(path).name for path in paths)))
        mass, _, stiffness = self.matrices()
        values = self.modes().stiffness
        lowest = math.sqrt(float(min(values[values > 0], default=0.0))) / (2 * math.pi)
        largest = f"entries of M up to {np.abs(mass).max():.4g} kg and of K up to {np.abs(stiffness).max():.4g} N/m"
        yield (
            f"{names}: matrices state no units; kg and N/m are assumed, with {largest}, and a lowest natural frequency of "
            f"{lowest:.4g} Hz; a model in t, mm and N needs both matrices times 1000"
        )

    def matrices(self) -> tuple[Vector, Vector, Vector]:
        """Return mass, damping and stiffness, (n, n) each; the damping is zero if it is given by damping ratios."""
        mass, stiffness = np.array(self.M), np.array(self.K)
        if self.rayleigh is not None:
            return mass, self.rayleigh[0] * mass + self.rayleigh[1] * stiffness, stiffness
        return mass, np.zeros_like(mass) if self.C is None else np.array(self.C), stiffness

    def modes(self) -> ModalModel:
        """Compute the modes of the undamped structure, K phi = omega^2 M phi, and the modal damping phi^T C phi.

        `Modal` names the sources.
        """
        from scipy.linalg import eigh

        # Eigenvalues below zero are an unstable structure; those near zero are rigid-body modes, exactly zero but for
        # rounding.
        mass, damping, stiffness = self.matrices()
        values, vectors = eigh(stiffness, mass)
        largest = np.abs(values).max()
        if values.min() < -1e-9 * largest:
            raise Hint(
                "K is not positive semidefinite: the structure would be unstable",
                "a matrix whose eigenvalues are not negative",
                self._where("K"),
            )
        # Negative ones show the size of the rounding, also that of matrices in files.
        values = np.where(np.abs(values) <= max(1e-12 * largest, -10 * values.min()), 0.0, values)
        # Modes of equal frequency may be turned into each other: those are chosen between which there is no damping.
        vectors = _align(vectors, values, damping, 1e-9 * largest)
        modal = vectors.T @ damping @ vectors
        diagonal = np.diag(modal)
        if len(modal) and (least := np.linalg.eigvalsh(modal).min()) < -1e-9 * np.abs(modal).max():
            raise Hint(
                f"C is not positive semidefinite: a motion would gain energy (smallest eigenvalue {least:.3g} 1/s)",
                "a matrix whose eigenvalues are not negative",
                self._where("C"),
            )
        # Below this, damping between modes is rounding of the eigenvectors.
        coupling = modal - np.diag(diagonal)
        size = np.sqrt(np.abs(np.outer(diagonal, diagonal)))
        proportional = bool((np.abs(coupling) <= 1e-8 * np.where(size > 0, size, np.abs(modal).max(initial=0.0))).all())
        # M phi projects displacements, velocities and the motion of the base onto the modes.
        n = len(values)
        weights = {name: np.eye(n)[p] if isinstance(p, int) else np.array(p) for name, p in self.points.items()}
        projection = vectors.T @ mass
        spatial, zero = self._spatial(), np.zeros(n)
        influence = self.influence if self.influence is not None or spatial else np.ones(n)
        return ModalModel(
            decay=np.maximum(diagonal, 0) / 2 if self.damping_ratio is None else self.decay_rates(values),
            stiffness=values,
            shapes={name: (weight @ vectors).T for name, weight in weights.items()},
            participation=None if influence is None else projection @ np.transpose(influence),
            q0=zero if self.displacement is None else projection @ np.array(self.displacement),
            p0=zero if self.velocity is None else projection @ np.array(self.velocity),
            spatial=spatial,
            coupling=None if proportional else 0.5 * (coupling + coupling.T),
            total_mass=None if influence is None else np.asarray(influence) @ mass @ np.transpose(influence),
        )


def _read_each(files: dict[str, Any]) -> tuple[dict[str, str], dict[str, Vector]]:
    """Return paths and matrices of Matrix Market files, one file for each matrix."""
    for name in files:
        if name not in ("M", "C", "K"):
            raise Hint(f"there is no matrix {name!r} here", nearest(name, ("M", "C", "K")))
    for name in ("M", "K"):
        if name not in files:
            raise Hint(f"a file of {name} is needed", 'file = { M = "M.mtx", K = "K.mtx" }')
    paths, matrices = {}, {}
    for name, file in files.items():
        with at(name):
            paths[name] = absolute(file)
            matrices[name] = check_finite(read_matrix(existing(paths[name])), paths[name])
    return paths, matrices


def _read_matrices(path: str) -> tuple[dict[str, Vector], dict[str, Vector]]:
    """Return matrices and points of a file, by name."""
    file = existing(path)
    if file.suffix.lower() not in (".npz", ".mat"):
        if file.suffix.lower() == ".mtx":
            raise DataError(f"{path} is one matrix; M and K are needed", 'file = {"M": "M.mtx", "K": "K.mtx"}')
        raise DataError(f"{path} is neither NPZ nor MAT", "numpy.savez('beam.npz', M=M, C=C, K=K, point_tip=weights)")
    arrays = read_arrays(file)
    if not arrays:
        raise DataError(f"{path} contains no numbers", "arrays M, C and K")
    for name in ("M", "K"):
        if name not in arrays:
            raise DataError(f"{path} contains no {name}, but {', '.join(arrays)}", nearest(name, arrays))
    matrices: dict[str, Vector] = {name: np.atleast_2d(arrays[name]) for name in ("M", "C", "K") if name in arrays}
    points: dict[str, Vector] = {}
    for name, array in arrays.items():
        mark = next((mark for mark in ("point_", "points.") if name.startswith(mark)), None)
        if mark is not None:
            n = len(matrices["M"])
            if array.size != n and array.shape != (3, n):
                raise DataError(
                    f"{path}: {name} has {array.size} numbers, but there are {n} degrees of freedom",
                    f"a vector of weights, or points = {{ {name.removeprefix(mark)} = 0 }} and the file without it",
                )
            points[name.removeprefix(mark)] = array.ravel() if array.size == n else array
    for name, array in (matrices | points).items():
        check_finite(array, f"{path}: {name}")
    return matrices, points


def _align(vectors: Vector, values: Vector, damping: Vector, tolerance: float) -> Vector:
    """Return the modes, with those of a repeated frequency rotated so that damping does not couple them."""
    vectors = vectors.copy()
    start = 0
    for end in range(1, len(values) + 1):
        if end < len(values) and values[end] - values[start] <= tolerance:
            continue
        if end - start > 1:
            block = vectors[:, start:end]
            _, turn = np.linalg.eigh(block.T @ damping @ block)
            vectors[:, start:end] = block @ turn
        start = end
    return vectors
