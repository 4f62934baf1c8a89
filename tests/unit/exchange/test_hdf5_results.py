"""Modes in HDF5 results of Nastran."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from support.mutants import mutant

import rattlebox as rb

EIGEN = [-3.1e-6, 6.4e5, 3.24e6]
MASSES = [1.0, 2.5, 0.4]
POINTS = [104, 7, 3000]
SCALAR = 88
OPTIONS: dict[str, Any] = {"points": {"a": 104, "b": 7, "c": 3000}, "damping_ratio": 0.02}
OWN = np.random.default_rng(3).standard_normal((3, 3, 3))
"""Displacements (mode, point, component) along the own axes of the points."""
SYSTEMS = {  # label, reference, origin, point of the third axis, point of the half plane of the first
    "CORD2R": [(5, 0, (1.0, 2.0, 0.0), (1.0, 2.0, 4.0), (1.0, 6.0, 0.0))],
    "CORD2C": [(6, 5, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (2.0, 0.0, 0.0))],
    "CORD2S": [(9, 0, (0.0, 0.0, 1.0), (0.0, 0.0, 3.0), (1.0, 0.0, 1.0))],
}
GRID = [(104, 0, (0.3, 0.0, 0.1), 0), (7, 5, (2.0, 2.0, 0.7), 6), (3000, 0, (0.0, 0.4, 1.3), 9)]
"""Label, system of the position, position, and system of the displacements of each point."""


def write(path: Path, **changes: Any) -> Path:
    """Write a file with three modes at three points and a scalar point; `changes` are columns as TABLE_COLUMN."""

    def table(group: Any, name: str, columns: dict[str, Any]) -> None:
        short = name.rpartition("/")[2]
        columns = {key: changes.get(f"{short}_{key}", values) for key, values in columns.items()}
        columns = {key: np.asarray(values) for key, values in columns.items() if values is not None}
        if columns:
            rows = np.zeros(len(next(iter(columns.values()))), [(k, v.dtype, v.shape[1:]) for k, v in columns.items()])
            for key, values in columns.items():
                rows[key] = values
            group.create_dataset(name, data=rows, compression="gzip")

    with h5py.File(path, "w") as file:
        root = file.create_group(changes.get("root", "NASTRAN"))
        table(root, "RESULT/SUMMARY/EIGENVALUE", {"MODE": [1, 2, 3], "EIGEN": EIGEN, "MASS": MASSES})
        # The domains of the table of eigenvalues come first.
        columns = {
            "ID": range(1, 7),
            "SUBCASE": [0] * 3 + [1] * 3,
            "ANALYSIS": [0] * 3 + [2] * 3,
            "MODE": [1, 2, 3] * 2,
        }
        table(root, "RESULT/DOMAINS", {key: list(values) for key, values in columns.items()})
        count = len(POINTS) + 1
        motion = np.concatenate([OWN, np.full((3, 1, 3), 0.5)], axis=1).reshape(-1, 3)
        columns = {"ID": [*POINTS, SCALAR] * 3, "X": motion[:, 0], "Y": motion[:, 1], "Z": motion[:, 2]}
        name = changes.get("vectors", "EIGENVECTOR")
        table(root, f"RESULT/NODAL/{name}", {**columns, "DOMAIN_ID": np.repeat([4, 5, 6], count)})
        labels, cp, x, cd = (list(values) for values in zip(*GRID, strict=True))
        table(root, "INPUT/NODE/GRID", {"ID": labels, "CP": cp, "X": x, "CD": cd})
        for name, rows in SYSTEMS.items():
            names = ("CID", "RID", *(f"{p}{k}" for p in "ABC" for k in (1, 2, 3)))
            flat = [(label, reference, *a, *b, *c) for label, reference, a, b, c in rows]
            columns = dict(zip(names, (list(values) for values in zip(*flat, strict=True)), strict=True))
            table(root, f"INPUT/COORDINATE_SYSTEM/{name}", columns)
    return path


def test_planted_modes(tmp_path: Path) -> None:
    """Frequencies, generalized masses and shapes are read; displacements along cylindrical and spherical axes are turned.

    HDF5 results of Nastran could not be read at all. The directions are those of derivatives of positions, computed here
    from the coordinates.
    """
    path = write(tmp_path / "a.h5")
    modal = rb.Modal.from_file(path, **OPTIONS)
    np.testing.assert_allclose(modal.frequencies, [0.0, *(np.sqrt(EIGEN[1:]) / (2 * np.pi))], rtol=1e-12)
    # The system 5 has its first axis along y and its second along -x; the point 7 is at (x, y) = (2, 2) in it.
    e_1, e_2, e_3 = np.array([0, 1, 0]), np.array([-1, 0, 0]), np.array([0, 0, 1])
    radial, tangential = (e_1 + e_2) / 2**0.5, (e_2 - e_1) / 2**0.5
    # The point 3000 is at (0, 0.4, 0.3) from the origin of the spherical system.
    outwards, polar, azimuth = np.array([0, 0.8, 0.6]), np.array([0, 0.6, -0.8]), np.array([-1, 0, 0])
    axes = {"a": np.eye(3), "b": [radial, tangential, e_3], "c": [outwards, polar, azimuth]}
    shapes = modal.modes().shapes
    for k, (point, own) in enumerate(axes.items()):
        np.testing.assert_allclose(shapes[point], OWN[:, k] @ np.array(own) / np.sqrt(MASSES)[:, None], atol=1e-12)
    with pytest.raises(rb.CaseError, match="no point '88'"):
        rb.Modal.from_file(path, points={"s": 88}, damping_ratio=0.02)


def test_files_without_grid_or_masses(tmp_path: Path) -> None:
    """Without the points of the model the axes are assumed, without generalized masses the normalisation, with notes."""
    path = write(tmp_path / "a.h5", GRID_ID=None, GRID_CP=None, GRID_X=None, GRID_CD=None, EIGENVALUE_MASS=None)
    modal = rb.Modal.from_file(path, **OPTIONS)
    np.testing.assert_allclose(modal.modes().shapes["b"], OWN[:, 1], rtol=1e-12)
    notes = "\n".join(modal.notes())
    assert "assumed to be along the global axes" in notes and "assumed to be mass-normalised" in notes


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"root": "OTHER"}, r"no group NASTRAN, but OTHER\n.*SOL 103"),
        ({"vectors": "EIGENVECTOR_CPLX"}, "complex modes"),
        ({"vectors": "DISPLACEMENT"}, "no table EIGENVECTOR in NASTRAN/RESULT/NODAL, but DISPLACEMENT"),
        ({"DOMAINS_ANALYSIS": [0] * 3 + [8] * 3}, "an analysis of buckling, no normal modes"),
        ({"DOMAINS_SUBCASE": [0] * 3 + [1, 1, 2]}, "several analyses, SUBCASE 1, 2"),
        ({"DOMAINS_MODE": [1, 2, 3, 1, 2, 2]}, "number of a mode is in the file twice"),
        ({"DOMAINS_ID": [1, 2, 3, 4, 5, 9]}, "no domain 6"),
        ({"EIGENVALUE_MODE": [1, 2, 4]}, "no eigenvalue of mode 3"),
        ({"EIGENVALUE_EIGEN": [-3.1e5, 6.4e5, 3.24e6]}, "negative eigenvalue"),
        ({"EIGENVALUE_MASS": [1.0, 0.0, 1.0]}, "mode 2 has a modal mass of 0"),
        ({"EIGENVECTOR_Z": None}, "EIGENVECTOR has no column Z"),
        ({"EIGENVECTOR_ID": [*POINTS, 88, *POINTS, 88, *POINTS, 89]}, "other points than the first one"),
        ({"EIGENVECTOR_X": np.full(12, np.nan)}, "the shape at"),
        ({"GRID_CD": [0, 12, 9]}, "coordinate system 12 of points is no CORD2R"),
        (
            {"GRID_X": [(0.3, 0, 0.1), (0.0, 0.0, 0.7), (0, 0.4, 1.3)]},
            "point 7 lies on the axis of the coordinate system 6",
        ),
        ({"CORD2R_RID": [6]}, "coordinate system 5 of points is defined by itself"),
        ({"CORD2S_C1": [0.0]}, "coordinate system 9 are on one line"),
    ],
)
def test_files_that_are_refused(tmp_path: Path, changes: dict[str, Any], message: str) -> None:
    """Other results, several analyses, and tables that contradict each other are refused with the reason."""
    path = write(tmp_path / "a.h5", **changes)
    with pytest.raises(rb.RattleboxError, match=message) as error:
        rb.Modal.from_file(path, **OPTIONS)
    assert "a.h5" in str(error.value)


def test_no_hdf5_file(tmp_path: Path) -> None:
    """A file of another kind with this ending is refused before HDF5 reads it."""
    (tmp_path / "a.h5").write_text("0 1\n2 3\n")
    with pytest.raises(rb.DataError, match=r"is no HDF5 file\n.*SOL 103"):
        rb.Modal.from_file(tmp_path / "a.h5", **OPTIONS)
    content = write(tmp_path / "a.h5").read_bytes()
    (tmp_path / "a.h5").write_bytes(content.replace(b"\r\n", b"\n"))
    with pytest.raises(rb.DataError, match="changed by a transfer as text"):
        rb.Modal.from_file(tmp_path / "a.h5", **OPTIONS)


def test_mutants(tmp_path: Path) -> None:
    """Files with random damage are read or refused with the name of the file; `docs/validation/robustness.md` has more."""
    content, path = write(tmp_path / "a.h5").read_bytes(), tmp_path / "b.h5"
    for number in range(8):
        path.write_bytes(mutant(content, number))
        begin, message = time.process_time(), "b.h5"
        try:
            rb.Modal.from_file(path, **OPTIONS)
        except rb.RattleboxError as error:
            message = str(error)
        assert "b.h5" in message, f"mutant {number}"
        assert time.process_time() - begin < 2.0
