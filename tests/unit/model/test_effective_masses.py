"""Effective masses of modes against closed forms, and their table in previews of files."""

from __future__ import annotations

import math
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io

import rattlebox as rb
from rattlebox.model.beams import wave_numbers


def test_a_clamped_beam() -> None:
    """The effective masses of a cantilever are (2 s / z)^2 of its mass, s = (sinh z - sin z) / (cosh z + cos z)."""
    table = rb.effective_masses(rb.Beam(length="0.7 m", material="aluminium", diameter="31 mm", mode_count=5))
    z = np.array(wave_numbers("clamped-free", 5, 0.0))
    s = (np.sinh(z) - np.sin(z)) / (np.cosh(z) + np.cos(z))
    assert table.total is not None
    np.testing.assert_allclose(table.masses[:, 0] / table.total, (2 * s / z) ** 2, rtol=1e-9)
    assert table.masses[0, 0] / table.total[0] == pytest.approx(0.61308, abs=1e-5)
    assert table.directions == ("base",)


def test_a_free_beam() -> None:
    """The rigid-body modes of a free beam have its whole mass, its elastic modes none."""
    beam = rb.Beam(length="0.7 m", material="aluminium", diameter="31 mm", mode_count=6, ends="free-free")
    table = rb.effective_masses(beam)
    assert table.total is not None and table.shares is not None
    assert table.masses[:2].sum() == pytest.approx(table.total[0], rel=1e-12)
    assert np.abs(table.masses[2:]).max() < 1e-12 * table.total[0]
    np.testing.assert_allclose(table.shares, 1.0, rtol=1e-12)


def test_a_chain_of_masses() -> None:
    """The shapes of n equal masses are sin(i t), t = (2 j - 1) pi / (2 n + 1), with masses m cot^2(t/2) / (2 n + 1)."""
    n, m, k = 7, 1.7, 4e4
    K = k * (2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))
    K[-1, -1] = k
    table = rb.effective_masses(rb.Matrices(M=m * np.eye(n), K=K, points={"end": n - 1}))
    t = (2 * np.arange(1, n + 1) - 1) * math.pi / (2 * n + 1)
    np.testing.assert_allclose(table.frequencies, 2 * math.sqrt(k / m) * np.sin(t / 2) / (2 * math.pi), rtol=1e-10)
    np.testing.assert_allclose(table.masses[:, 0], m / np.tan(t / 2) ** 2 / (2 * n + 1), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(table.shares, 1.0, rtol=1e-12)


def euler_beam(count: int, length: float, mass: float) -> tuple[Any, Any, Any, list[str]]:
    """Return M and K of a free beam of Hermite elements along x, and positions and directions (y, rz) of its freedoms."""
    h = length / count
    k = np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h],
                  [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h * h, -6 * h, 4 * h * h]]) * 5e3 / h**3  # fmt: skip
    m = np.array([[156, 22 * h, 54, -13 * h], [22 * h, 4 * h * h, 13 * h, -3 * h * h],
                  [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h * h, -22 * h, 4 * h * h]]) * mass / count / 420  # fmt: skip
    M, K = np.zeros((2, 2 * count + 2, 2 * count + 2))
    for e in range(count):
        part = slice(2 * e, 2 * e + 4)
        M[part, part] += m
        K[part, part] += k
    positions = np.zeros((2 * count + 2, 3))
    positions[:, 0] = np.repeat(np.arange(count + 1) * h, 2)
    return M, K, positions, ["y", "rz"] * (count + 1)


def test_rotations_of_a_beam() -> None:
    """Rotations are about the origin: a free beam has m L^2 / 3 in its rigid-body modes; a clamped one 61.3 % along y."""
    mass, length = 2.4, 1.6
    M, K, positions, directions = euler_beam(24, length, mass)
    free = rb.effective_masses(rb.Matrices(M=M, K=K, points={"end": 0}), positions, directions)
    assert free.directions == ("x", "y", "z", "rx", "ry", "rz")
    assert free.total is not None
    np.testing.assert_allclose(free.total, [0, mass, 0, 0, 0, mass * length**2 / 3], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(free.masses[:2].sum(axis=0), free.total, rtol=1e-6, atol=1e-9)
    assert free.masses[2:].max() < 1e-9
    clamped = rb.Matrices(M=M[2:, 2:], K=K[2:, 2:], points={"end": 46})
    held = rb.effective_masses(clamped, positions[2:], directions[2:])
    assert held.masses[0, 1] / mass == pytest.approx(0.61308, rel=1e-4)
    assert held.frequencies[0] == pytest.approx(
        1.8751041**2 * math.sqrt(5e3 / mass / length**3) / (2 * math.pi), rel=1e-5
    )


def test_all_directions_of_a_free_truss() -> None:
    """A free truss in 3-D has its mass and its moments of inertia in six rigid-body modes, and nothing in the others.

    Unit vectors as directions give the same as names.
    """
    random = np.random.default_rng(11)
    places, masses = random.uniform(-1, 1, (6, 3)), random.uniform(0.5, 2, 6)
    K = np.zeros((18, 18))
    for a, b in combinations(range(6), 2):
        g = np.zeros(18)
        unit = (places[b] - places[a]) / np.linalg.norm(places[b] - places[a])
        g[3 * a : 3 * a + 3], g[3 * b : 3 * b + 3] = -unit, unit
        K += 1e5 * np.outer(g, g)
    structure = rb.Matrices(M=np.diag(np.repeat(masses, 3)), K=(K + K.T) / 2, points={"a": 0})
    positions = np.repeat(places, 3, axis=0)
    table = rb.effective_masses(structure, positions, ["x", "y", "z"] * 6)
    x, y, z = places.T
    inertia = [masses @ (y**2 + z**2), masses @ (x**2 + z**2), masses @ (x**2 + y**2)]
    expected = [masses.sum()] * 3 + inertia
    np.testing.assert_allclose(table.total, expected, rtol=1e-12)
    np.testing.assert_allclose(table.masses[:6].sum(axis=0), expected, rtol=1e-9)
    assert table.frequencies[:6].max() == 0.0 < table.frequencies[6:].min()
    assert table.masses[6:].max() < 1e-9
    same = rb.effective_masses(structure, positions, np.tile(np.eye(3), (6, 1)))
    np.testing.assert_allclose(same.masses, table.masses)
    assert str(table).splitlines()[-1].split() == ["share", *["100.0", "%"] * 6]


def test_rounding_of_rigid_body_modes() -> None:
    """Eigenvalues of either sign that are rounding become zero, so that no decay rate is a square root of a negative one.

    Only exact matrices were tested; those of files have six digits, and gave decay rates that are no numbers.
    """
    K = 1e5 * np.array([[1, -1, 0], [-1, 2, -1], [0, -1, 1]]) - 3e-5 * np.eye(3)
    model = rb.Matrices(M=np.eye(3), K=K, points={"a": 0}, damping_ratio=0.01).modes()
    assert model.stiffness[0] == 0.0 and model.decay[0] == 0.0 and np.isfinite(model.decay).all()


def test_structures_without_participation() -> None:
    """Without participation, or with directions that do not fit, the table is refused with what is needed."""
    modal = rb.Modal(frequencies=[10.0], damping_ratio=0.01, shapes={"tip": [1.0]})
    chain = rb.Matrices(M=np.eye(2), K=np.eye(2), points={"a": 0})
    for structure, arguments, message in (
        (modal, (), "states no participation"),
        (modal, (np.zeros((1, 3)), ["x"]), "those of the degrees of freedom of rb.Matrices"),
        (chain, (np.zeros((2, 3)), None), "both together"),
        (chain, (np.zeros((3, 3)), ["x", "y"]), r"shape \(3, 3\), but there are 2 degrees"),
        (chain, (np.zeros((2, 3)), ["x"]), "1 direction, but there are 2"),
        (chain, (np.zeros((2, 3)), ["x", "w"]), "'w' is no direction"),
        (chain, (np.zeros((2, 3)), [[1, 0, 0], [1, 1, 0]]), "direction 2 is no unit vector"),
        ("beam", (), "a structure is needed; got str"),
    ):
        with pytest.raises(rb.CaseError, match=message):
            rb.effective_masses(structure, *arguments)


def test_the_table_in_a_preview(tmp_path: Path) -> None:
    """A preview of modes has the table if the file states the participation, and says what it lacks if not."""
    (tmp_path / "a.csv").write_text(
        "frequency (Hz),damping (%),modal mass (kg),tip,participation (kg)\n12,1,2,1,3\n70,1,0.5,-1,0.25\n"
    )
    lines = rb.inspect(tmp_path / "a.csv").lines
    table = [line.split() for line in lines[lines.index("effective masses:") + 1 :]]
    assert table[1:] == [["1", "12", "4.5"], ["2", "70", "0.125"], ["sum", "4.625"]]
    (tmp_path / "b.csv").write_text("frequency (Hz),damping (%),modal mass (kg),tip\n12,1,2,1\n")
    assert "states no participation" in rb.inspect(tmp_path / "b.csv").lines[-1]


def test_a_preview_of_matrices(tmp_path: Path) -> None:
    """Files with M and K are previewed as structures, with lines that read them; one matrix alone is refused.

    Points in such files were previewed as records of accelerations.
    """
    M, K = np.diag([2.0, 1.0, 0.5]), 1e4 * (2 * np.eye(3) - np.eye(3, k=1) - np.eye(3, k=-1))
    scipy.io.savemat(tmp_path / "a.mat", {"M": M, "K": K, "point_tip": [0.0, 0.0, 1.0]})
    np.savez(tmp_path / "b.npz", M=M, K=K)
    for name, points in (("a.mat", "tip"), ("b.npz", "first")):
        view = rb.inspect(tmp_path / name)
        assert view.content == "matrices of a structure" and view.lines[1] == f"1 point: {points}"
        assert view.lines[-2].split() == ["total", "3.5"] and view.lines[-1].split() == ["share", "100.0", "%"]
        structure = eval(view.python, {"rb": rb})
        assert list(structure.modes().shapes) == [points]
        (tmp_path / "case.toml").write_text(f'duration = "1 ms"\n{view.toml}\n')
        assert rb.Case.from_file(tmp_path / "case.toml").structure.kind == "matrices"
    np.savez(tmp_path / "c.npz", M=np.arange(5.0), K=np.arange(5.0))
    assert rb.inspect(tmp_path / "c.npz").content.startswith("a file of arrays")  # rows of numbers, no matrices
    (tmp_path / "K.mtx").write_text("%%MatrixMarket matrix array real general\n1 1\n2\n")
    with pytest.raises(rb.DataError, match=r"is one matrix; M and K are needed\n.*rb\.Matrices"):
        rb.inspect(tmp_path / "K.mtx")


def test_many_modes_and_fixed_cavities() -> None:
    """A long table is cut after twenty modes, with the sum over all; a cavity that does not move has no participation."""
    n = 30
    K = 2e4 * (2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))
    text = str(rb.effective_masses(rb.Matrices(M=np.eye(n), K=K, points={"a": 0})))
    assert "  ..." in text and len(text.splitlines()) == 25 and text.splitlines()[-1].split() == ["share", "100.0", "%"]
    with pytest.raises(rb.CaseError, match="no participation"):
        rb.effective_masses(rb.Fixed())
