"""Modes and matrices of other programs: real files, units, mass normalisation and damaged files."""

from __future__ import annotations

import contextlib
import math
import re
import struct
import subprocess
import sys
import time
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff
import scipy.io
import scipy.sparse
from ansys.mapdl.reader import examples

import rattlebox as rb
from rattlebox.exchange.read import ansys, ansys_arrays, guarded
from rattlebox.exchange.read.matrix_market import read_matrix
from rattlebox.exchange.read.universal import _phase_scatter, read_functions
from rattlebox.model.plausibility import plausibility_notes

UFF = Path(__file__).parents[2] / "data/uff"
RST, FULL = Path(examples.rstfile), Path(examples.fullfile)

HEAD = "frequency (Hz), damping (%), modal mass (kg), tip, root x, root y, root z"
TABLE = f"""{HEAD}, participation x, participation y, participation z
10, 1, 4, 2, 1, 0, 0.5, 3, 0, 1
25, 2, 1, -1, 0, 1, 0, 0, 2, 0
"""  # fmt: skip


def test_modes_of_an_ansys_result() -> None:
    """The frequencies of an Ansys result are those of the analysis; each point has shapes in three directions."""
    modal = rb.Modal.from_file(RST, points={"a": 100, "b": "100 y", "c": "100 -y"}, damping_ratio=0.01)
    expected = [7366.495, 7366.495, 11504.895, 17285.705, 17285.705, 20137.193]
    np.testing.assert_allclose(modal.frequencies, expected, atol=6e-4)
    modes = modal.modes()
    np.testing.assert_array_equal(modes.shapes["b"], modes.shapes["a"][:, 1])
    np.testing.assert_array_equal(modes.shapes["c"], -modes.shapes["a"][:, 1])
    notes = list(modal.notes())
    assert any("states no unit of mass; kg is assumed" in note for note in notes)
    largest = max(np.abs(row).max() for row in modes.shapes.values())
    assert sum(f"{largest:.4g} kg^-0.5" in note for note in notes) == 1
    tonnes = rb.Modal.from_file(RST, points={"a": 100}, damping_ratio=0.01, mass_unit="t")
    np.testing.assert_allclose(tonnes.modes().shapes["a"], modes.shapes["a"] / math.sqrt(1e3), rtol=1e-12)


def test_modes_of_ansys_matrices() -> None:
    """The modes of K and M agree with those that Ansys documents, with consistent participation."""
    modal = rb.Modal.from_file(FULL, points={"a": 100}, mode_count=4, damping_ratio=0)
    np.testing.assert_allclose(modal.frequencies, [1283.200, 1283.200, 5781.975, 6919.399], atol=6e-4)
    many = rb.Modal.from_file(FULL, points={"a": 100}, mode_count=120, damping_ratio=0)
    np.testing.assert_allclose(many.frequencies[:4], modal.frequencies, rtol=1e-9)
    # The effective masses of all modes add up to the mass of the free nodes; 120 of 900 modes have a part of it.
    from ansys.mapdl import reader

    file = reader.read_binary(str(FULL))
    numbers, _, upper = file.load_km(sort=False)
    mass = (upper + upper.T).toarray() - np.diag(upper.diagonal())
    held = {tuple(map(int, row[:2])) for row in file.const}
    free = np.array([tuple(map(int, row)) not in held for row in numbers])
    for axis in range(3):
        r = (numbers[:, 1] == axis) * free * 1.0
        effective = np.sum(np.array(many.participation)[:, axis] ** 2)
        assert 0.9 < effective / (r @ mass @ r) <= 1 + 1e-9


def test_modes_in_millimetres_and_millinewtons() -> None:
    """In a universal file in mm and mN, data set 164 gives the unit of mass, mN s^2/mm = kg."""
    modal = rb.Modal.from_file(UFF / "modes_mm_mN_2414.uff", points={"a": 9581}, damping_ratio=0.01)
    np.testing.assert_allclose(modal.frequencies, [23383.2, 23384.1, 37317.1, 54308.9, 54313.4])
    np.testing.assert_allclose(modal.modes().shapes["a"][0], [0.156530, 13.1011, -3.2994e-05], rtol=1e-5)
    (note,) = modal.notes()  # the file numbers coordinate systems, but does not define them
    assert "does not define the coordinate system 2 " in note and "global axes are assumed" in note


def system_2420(kind: int, angle: float, origin: tuple[float, ...] = (0, 0, 0)) -> bytes:
    """Return a data set 2420 with the coordinate systems 1 to 321, turned about z by an angle [rad]."""
    c, s = math.cos(angle), math.sin(angle)
    rows = "".join("".join(f"{x:25.16e}" for x in row) + "\n" for row in ([c, s, 0], [-s, c, 0], [0, 0, 1], origin))
    systems = "".join(f"{label:10d}{kind:10d}{1:10d}\nsystem\n{rows}" for label in range(1, 322))
    return f"    -1\n  2420\n{1:10d}\npart\n{systems}    -1\n".encode()


@pytest.mark.parametrize("angle", [0.0, 0.3, -2.1])
def test_displacements_along_turned_axes(tmp_path: Path, angle: float) -> None:
    """Displacements along turned axes, the rows of the set 2420, are turned to the global ones.

    Turned axes were refused, so that no test had a right value for them: here modes are planted along turned axes.
    """
    plain = rb.Modal.from_file(UFF / "modes_mm_mN_2414.uff", points={"a": 9581}, damping_ratio=0.01).modes().shapes["a"]
    (tmp_path / "modes.unv").write_bytes(system_2420(0, angle) + MODES)
    modal = rb.Modal.from_file(tmp_path / "modes.unv", points={"a": 9581}, damping_ratio=0.01)
    c, s = math.cos(angle), math.sin(angle)
    e_x, e_y = np.array([c, s, 0.0]), np.array([-s, c, 0.0])  # the local axes in the global system
    expected = [u * e_x + v * e_y + [0.0, 0.0, w] for u, v, w in plain]
    np.testing.assert_allclose(modal.modes().shapes["a"], expected, rtol=1e-12, atol=1e-12)
    assert not list(modal.notes())


@pytest.mark.parametrize(("kind", "angle"), [(1, 0.0), (1, 0.7), (2, 0.0), (2, -1.9)])
def test_displacements_along_curved_axes(tmp_path: Path, kind: int, angle: float) -> None:
    """Displacements along cylindrical and spherical axes are turned at the position of each node.

    Such files were refused. The directions are derivatives of the position by the coordinates, computed here.
    """
    origin = np.array([3.0, -2.0, 1.5])
    (nodes,) = (block for block in pyuff.UFF(str(UFF / "modes_mm_mN_2414.uff")).read_sets() if block["type"] == 2411)
    k = list(nodes["node_nums"]).index(9581)
    c, s = math.cos(angle), math.sin(angle)
    axes = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    x, y, z = axes @ (np.array([nodes[name][k] for name in "xyz"]) - origin)

    def position(a: float, b: float, third: float) -> Any:
        if kind == 1:
            return np.array([a * math.cos(b), a * math.sin(b), third]) @ axes
        return a * np.array([math.sin(b) * math.cos(third), math.sin(b) * math.sin(third), math.cos(b)]) @ axes

    coordinates = [math.hypot(x, y), math.atan2(y, x), z]
    if kind == 2:
        distance = math.sqrt(x * x + y * y + z * z)
        coordinates = [distance, math.acos(z / distance), math.atan2(y, x)]
    steps = [(position(*(coordinates + h)) - position(*(coordinates - h))) / 2e-6 for h in 1e-6 * np.eye(3)]
    directions = np.array([step / np.linalg.norm(step) for step in steps])
    plain = rb.Modal.from_file(UFF / "modes_mm_mN_2414.uff", points={"a": 9581}, damping_ratio=0.01).modes().shapes["a"]
    (tmp_path / "modes.unv").write_bytes(system_2420(kind, angle, tuple(origin)) + MODES)
    modal = rb.Modal.from_file(tmp_path / "modes.unv", points={"a": 9581}, damping_ratio=0.01)
    np.testing.assert_allclose(modal.modes().shapes["a"], plain @ directions, atol=1e-7)
    assert ["spherical axes" in note for note in modal.notes()] == [True] * (kind == 2)


def test_axes_that_cannot_be_used(tmp_path: Path) -> None:
    """Nodes on the axis of a cylinder or without a position, skewed axes, and contradictions are refused."""
    skewed = system_2420(0, 0.0).replace(b"   1.0000000000000000e+00", b"   1.1000000000000000e+00")
    (nodes,) = (block for block in pyuff.UFF(str(UFF / "modes_mm_mN_2414.uff")).read_sets() if block["type"] == 2411)
    k = list(nodes["node_nums"]).index(9581)
    on_axis = tuple(float(nodes[name][k]) for name in "xyz")
    with_15 = system_15(9581, definition=4, displacement=4)
    for systems, modes, message in (
        (system_2420(1, 0.0, on_axis), MODES, "no radial direction there\n.*Cartesian axes"),
        (system_2420(1, 0.0) + with_15, MODES[MODES.index(b"    -1\n  2414") :], "needs the position of the node"),
        (system_2420(3, 0.0), MODES, "unknown type 3"),
        (skewed, MODES, "not perpendicular unit vectors"),
        (system_2420(0, 0.1) + system_2420(0, 0.2), MODES, "coordinate system 1 is defined twice"),
        (system_2420(1, 0.1) + system_2420(1, 0.1, (1, 0, 0)), MODES, "coordinate system 1 is defined twice"),
    ):
        (tmp_path / "modes.unv").write_bytes(systems + modes)
        with pytest.raises(rb.DataError, match=message):
            rb.Modal.from_file(tmp_path / "modes.unv", points={"a": 9581}, damping_ratio=0.01)


def system_15(node: int, definition: int, displacement: int) -> bytes:
    """Return a data set 15 with a node."""
    numbers = "".join(f"{value:10d}" for value in (node, definition, displacement, 1))
    return f"    -1\n    15\n{numbers}{1.0:13.5E}{2.0:13.5E}{3.0:13.5E}\n    -1\n".encode()


@pytest.mark.parametrize("name", ["modes_mm_mN_2414.uff", "normal_modes_55.uff"])
@pytest.mark.parametrize("letter", [b"D", b"d"])
def test_exponents_of_fortran(tmp_path: Path, name: str, letter: bytes) -> None:
    """Exponents D in the numbers of modes are read as E.

    Only records had a test of them: pyuff refuses them in the sets 55 and 2414.
    """
    content = (UFF / name).read_bytes()
    (tmp_path / "modes.uff").write_bytes(re.sub(rb"(?<=\d)[Ee](?=[-+]\d)", letter, content))
    node, count = (9581, 5) if "2414" in name else (2, 3)
    options: dict[str, Any] = {"damping_ratio": 0.01, "modal_masses": ["1 kg"] * count, "points": {"a": node}}
    first = rb.Modal.from_file(UFF / name, **options)
    second = rb.Modal.from_file(tmp_path / "modes.uff", **options)
    assert first.frequencies == second.frequencies and first.shapes == second.shapes


def test_a_set_that_cannot_be_read_has_a_line(tmp_path: Path) -> None:
    """A damaged set of a universal file is named by its type and its line, which pyuff does not state."""
    content = (UFF / "normal_modes_55.uff").read_bytes()
    start = content.index(b"    -1", content.index(b"    -1", 10) + 1)  # that of the second set
    place = content.index(b"e+", start)
    (tmp_path / "modes.uff").write_bytes(content[:place] + b"X+" + content[place + 2 :])
    line = content[:start].count(b"\n") + 1
    with pytest.raises(rb.DataError, match=rf"modes.uff, line {line}: the data set 2, of type 55, cannot be read"):
        rb.Modal.from_file(tmp_path / "modes.uff", damping_ratio=0.01, modal_masses=["1 kg"])


def complex_55(modes: list[tuple[complex, complex, list[complex]]], kind: int = 3) -> str:
    """Return sets 55 of complex modes at the nodes 7 and 9: eigenvalue, modal A, and components."""
    text = ""
    for number, (eigenvalue, a, shape) in enumerate(modes, start=1):
        values = [eigenvalue.real, eigenvalue.imag, a.real, a.imag, 0.0, 0.0]
        text += "    -1\n    55\n" + "NONE\n" * 5 + f"{1:10d}{kind:10d}{2:10d}{8:10d}{5:10d}{3:10d}\n"
        text += f"{2:10d}{6:10d}{1:10d}{number:10d}\n" + "".join(f"{x:13.5E}" for x in values) + "\n"
        for node, row in ((7, shape[:3]), (9, shape[3:])):
            text += f"{node:10d}\n" + "".join(f"{x:13.5E}" for z in row for x in (z.real, z.imag)) + "\n"
        text += "    -1\n"
    return text


@pytest.mark.parametrize("analysis", [3, 7])
def test_complex_modes_of_a_modal_test(tmp_path: Path, analysis: int) -> None:
    """A normal mode with any complex factor is read as that mode, with the frequency, damping and modal mass it had.

    Complex modes were refused, although programs of modal tests write no others.
    """
    phi, m, omega, zeta, factor = np.array([0.3, 0.0, -1.2, 0.5, 0.1, 0.9]), 3.4, 271.0, 0.021, 0.6 * np.exp(1.1j)
    damped = omega * math.sqrt(1 - zeta**2)
    psi = factor * phi
    a = 2j * damped * m * factor**2  # psi^T (2 lambda M + C) psi
    mode = complex(-zeta * omega, damped), complex(a), [complex(z) for z in psi]
    (tmp_path / "test.unv").write_text(complex_55([mode], analysis))
    modal = rb.Modal.from_file(tmp_path / "test.unv", points={"a": 7, "b": 9})
    assert modal.frequencies[0] == pytest.approx(omega / (2 * math.pi), rel=1e-5)
    assert modal.damping_ratios is not None
    assert modal.damping_ratios[0] == pytest.approx(zeta, rel=1e-4)
    shape = np.concatenate([modal.modes().shapes["a"][0], modal.modes().shapes["b"][0]])
    np.testing.assert_allclose(shape * np.sign(shape[0]), phi / math.sqrt(m), atol=1e-5)
    assert any("rotated to the real axis" in note for note in modal.notes())


def test_modes_beyond_the_limit_of_scatter(tmp_path: Path) -> None:
    """A mode whose phases scatter too much is refused, and the advice chooses the others; so does a wrong modal A."""
    turn = np.exp(0.2j)

    def mode(spread: float, a: complex = 200j) -> tuple[complex, complex, list[complex]]:
        phases = np.exp(1j * np.radians(spread) * np.array([1, -1, 1, -1, 1, -1]))
        return -1 + 100j, a * turn**2, [complex(z) for z in turn * phases]

    path = tmp_path / "test.unv"
    path.write_text(complex_55([mode(9.9), mode(10.2), mode(2.0), mode(1.0, 200 + 0j), (1 + 90j, 180j, mode(1.0)[2])]))
    options: dict[str, Any] = {"points": {"a": "7 z"}}
    with pytest.raises(rb.DataError, match=r"mode 2 at .* scatter by 10\.2 degrees.*\n.*mode_numbers = \[1, 3\],"):
        rb.Modal.from_file(path, **options)
    modal = rb.Modal.from_file(path, **options, mode_numbers=[3, 1])
    assert "scatter by 9.9, 10, 2, 1, 1 degrees" in " ".join(modal.notes())
    assert rb.Modal.from_file(path, **options, modes=[3, 1]) == modal
    assert len(rb.Modal.from_file(path, **options, mode_count=1).frequencies) == 1
    with pytest.raises(rb.DataError, match=r"mode 1 .* modal A is .*90 degrees"):
        rb.Modal.from_file(path, **options, mode_numbers=[4])
    with pytest.raises(rb.DataError, match="damped oscillation"):
        rb.Modal.from_file(path, **options, mode_numbers=[5])


def test_a_complex_mode_of_a_real_file() -> None:
    """The complex mode of a file of a modal test is read with a note of its scatter."""
    modal = rb.Modal.from_file(UFF / "complex_mode_55.uff", points={"a": 111111})
    assert any("scatter by 6.5 degrees" in note for note in modal.notes())


@pytest.mark.parametrize("numbers", [[0], [3], [1, 1], [], [1.5], "1"])
def test_numbers_of_modes_that_a_file_does_not_have(tmp_path: Path, numbers: Any) -> None:
    """Numbers of modes outside of the file, repeated or not whole are refused."""
    (tmp_path / "modes.csv").write_text(TABLE)
    with pytest.raises(rb.CaseError, match="mode_numbers"):
        rb.Modal.from_file(tmp_path / "modes.csv", points={"tip": "tip"}, mode_numbers=numbers)


def test_modes_by_their_numbers(tmp_path: Path) -> None:
    """The chosen modes have their own frequencies, damping, masses, shapes and participation, in the given order."""
    (tmp_path / "modes.csv").write_text(TABLE)
    every = rb.Modal.from_file(tmp_path / "modes.csv", points={"a": "root"}).modes()
    second = rb.Modal.from_file(tmp_path / "modes.csv", points={"a": "root"}, mode_numbers=[2, 1]).modes()
    assert every.participation is not None
    for one, other in (
        (every.shapes["a"], second.shapes["a"]),
        (every.stiffness, second.stiffness),
        (every.decay, second.decay),
        (every.participation, second.participation),
    ):
        np.testing.assert_array_equal(np.asarray(one)[::-1], other)


def test_modes_of_set_55_need_modal_masses() -> None:
    """A file with modal masses of zero is refused; given modal masses scale its shapes."""
    file = UFF / "normal_modes_55.uff"
    with pytest.raises(rb.DataError, match="mode 1 has a modal mass of 0"):
        rb.Modal.from_file(file, damping_ratio=0.01)
    one = rb.Modal.from_file(file, damping_ratio=0.01, modal_masses=["1 kg"] * 3)
    four = rb.Modal.from_file(file, damping_ratio=0.01, modal_masses=[4.0] * 3)
    assert len(one.frequencies) == 3 and one.frequencies[0] == 10.0
    for name, shape in one.shapes.items():
        np.testing.assert_allclose(four.shapes[name], np.array(shape) / 2, rtol=1e-12)


def test_a_unit_of_mass_does_not_multiply_modal_masses_in_another_one(tmp_path: Path) -> None:
    """`mass_unit` applies to masses without unit in a file; with modal masses in kg or with units it is refused."""
    (tmp_path / "modes.csv").write_text("frequency (Hz),damping (1),tip\n10,0.01,1\n")
    modes = rb.Modal.from_file(tmp_path / "modes.csv", modal_masses=["2 t"]).modes()
    assert modes.effective_mass("tip") == pytest.approx(2000.0)
    for masses in (["2 t"], [2.0]):
        with pytest.raises(rb.CaseError, match="mass_unit = 't' contradicts"):
            rb.Modal.from_file(tmp_path / "modes.csv", modal_masses=masses, mass_unit="t")
    text = 'frequencies = ["10 Hz"]\ndamping_ratios = [0.01]\nmodal_masses = [{}]\n[shapes]\ntip = [1]\n'
    (tmp_path / "modes.toml").write_text(text.format(2))
    modes = rb.Modal.from_file(tmp_path / "modes.toml", mass_unit="t").modes()
    assert modes.effective_mass("tip") == pytest.approx(2000.0)
    (tmp_path / "modes.toml").write_text(text.format('"2 kg"'))
    with pytest.raises(rb.CaseError, match="mass_unit = 't' contradicts"):
        rb.Modal.from_file(tmp_path / "modes.toml", mass_unit="t")


def test_tables_of_modes(tmp_path: Path) -> None:
    """Modal masses, damping in percent and participation of a table are converted to mass-normalised modes."""
    (tmp_path / "modes.csv").write_text(TABLE)
    modal = rb.Modal.from_file(tmp_path / "modes.csv")
    assert modal.frequencies == [10, 25]
    assert modal.damping_ratios == [0.01, 0.02]
    np.testing.assert_allclose(modal.shapes["tip"], [1, -1])
    np.testing.assert_allclose(modal.shapes["root"], [[0.5, 0, 0.25], [0, 1, 0]])
    np.testing.assert_allclose(modal.participation, [[1.5, 0, 0.5], [0, 2, 0]])
    assert not list(modal.notes())
    grams = TABLE.replace("(kg)", "(g)").replace("10, 1, 4", "10, 1, 4000").replace("25, 2, 1,", "25, 2, 1000,")
    grams = grams.replace("0.5, 3, 0, 1", "0.5, 3000, 0, 1000").replace("0, 0, 2, 0", "0, 0, 2000, 0")
    (tmp_path / "grams.csv").write_text(grams)
    same = rb.Modal.from_file(tmp_path / "grams.csv")
    np.testing.assert_allclose(same.participation, modal.participation)
    np.testing.assert_allclose(same.shapes["tip"], modal.shapes["tip"])
    case = rb.Case(structure=modal, load=rb.HalfSine(amplitude="1 N", duration="1 ms", point="tip"), duration="0.1 s")
    again = rb.Case.from_toml(case.to_toml())
    assert again == case and 'file = "' in case.to_toml() and "frequencies" not in case.to_toml()
    assert rb.simulate(case).ok
    fewer = case.replaced({"structure.mode_count": 1, "structure.damping_ratio": 0.05})
    assert fewer.structure.frequencies == [10] and fewer.modes.decay[0] == pytest.approx(0.05 * 2 * math.pi * 10)
    with pytest.raises(rb.CaseError, match="was read from"):
        case.replaced({"structure.frequencies[0]": 3})


def test_a_table_without_units_gives_a_note(tmp_path: Path) -> None:
    """Shapes without unit and modal mass are read in kg^-1/2, with a note that gives the largest."""
    (tmp_path / "modes.csv").write_text("frequency,damping,tip\n10,0.01,2\n25,0.01,-3\n")
    case = rb.Case(structure=rb.Modal.from_file(tmp_path / "modes.csv"), duration=1.0)
    (text,) = [note for note in plausibility_notes(case) if "kg is assumed" in note]
    assert "the largest mass-normalised shape is 3 kg^-0.5, at tip" in text


@pytest.mark.parametrize("name", ["Mode", "no.", "Mode number", "Set"])
def test_columns_that_number_the_modes_are_left_out(tmp_path: Path, name: str) -> None:
    """A column with numbers or names of modes is not the shape at a point."""
    (tmp_path / "modes.csv").write_text(TABLE)
    head, *rows = TABLE.splitlines()
    numbers = ["1", "second"]
    (tmp_path / "numbered.csv").write_text(
        "\n".join([f"{name}, {head}", *(f"{k}, {row}" for k, row in zip(numbers, rows, strict=True))])
    )
    plain = rb.Modal.from_file(tmp_path / "modes.csv").modes()
    numbered = rb.Modal.from_file(tmp_path / "numbered.csv").modes()
    assert list(numbered.shapes) == list(plain.shapes)
    np.testing.assert_array_equal(numbered.participation, plain.participation)


def test_headings_with_underscores(tmp_path: Path) -> None:
    """A column damping_ratio or modal_mass is a quantity, not a point; tests had headings with blanks only."""
    (tmp_path / "modes.csv").write_text("frequency (Hz),damping_ratio (%),modal_mass (kg),tip\n12,3,4,2\n")
    modal = rb.Modal.from_file(tmp_path / "modes.csv")
    assert list(modal.shapes) == ["tip"]
    np.testing.assert_allclose(modal.damping_ratios, [0.03])
    np.testing.assert_allclose(modal.shapes["tip"], [1.0])


def set_55(kind: int, frequency: float, *, number: int = 3) -> str:
    """Return a set 55 of a normal mode at two nodes, with data of this kind."""
    cells = "".join(f"{x:13.5E}" for x in (1.2, -0.4, 0.9)[:number])
    head = (
        f"    -1\n    55\n{'NONE' + chr(10):s}"
        + "NONE\n" * 4
        + f"         1         2         2{kind:10d}         2{number:10d}\n"
    )
    values = f"{frequency:13.5E}{2.5:13.5E}{0.01:13.5E}{0.0:13.5E}"
    return (
        f"{head}         2         4         1         1\n{values}\n         7\n{cells}\n         9\n{cells}\n    -1\n"
    )


@pytest.mark.parametrize("kind", [2, 3, 5, 9, 11, 12])
def test_sets_of_other_quantities_are_no_modes(tmp_path: Path, kind: int) -> None:
    """A set 55 of stresses, velocities or accelerations is refused, and left out beside that of displacements.

    All sets 55 of the tests were displacements, and their type of data was not read.
    """
    (tmp_path / "a.uff").write_text(set_55(kind, 11.0) + set_55(kind, 17.0))
    options: dict[str, Any] = {"points": {"p": 7}, "mass_unit": "kg"}
    with pytest.raises(
        rb.DataError, match=r"contains normal modes of .*; mode shapes are displacements \(type 8\)\n  try:"
    ):
        rb.Modal.from_file(tmp_path / "a.uff", **options)
    (tmp_path / "a.uff").write_text("".join(set_55(each, f) for f in (11.0, 17.0) for each in (8, kind)))
    assert rb.Modal.from_file(tmp_path / "a.uff", **options).frequencies == [11.0, 17.0]
    (tmp_path / "a.uff").write_text(set_55(0, 11.0))
    unknown = rb.Modal.from_file(tmp_path / "a.uff", **options)
    assert any("does not state the quantity of its modes" in note for note in unknown.notes())
    (tmp_path / "a.uff").write_text(set_55(8, 11.0, number=1))
    with pytest.raises(rb.DataError, match="1 values at a node"):
        rb.Modal.from_file(tmp_path / "a.uff", **options)


def test_a_unit_of_mass_that_contradicts_the_file(tmp_path: Path) -> None:
    """A unit of mass other than that of set 164, or of a table, is refused; where units contradict each other it decides.

    Tests gave `mass_unit` for files that state none.
    """
    units = "    -1\n   164\n{:10d}{:20s}{:10d}\n{:25.17E}{:25.17E}{:25.17E}\n{:25.17E}\n    -1\n"
    mm_t_N = units.format(10, "mm, t, N", 2, 1e3, 1.0, 1.0, 273.15)
    (tmp_path / "a.uff").write_text(mm_t_N + set_55(8, 11.0))
    right = rb.Modal.from_file(tmp_path / "a.uff", points={"p": 7})
    assert rb.Modal.from_file(tmp_path / "a.uff", points={"p": 7}, mass_unit="t").shapes == right.shapes
    assert right.modes().shapes["p"][0, 0] == pytest.approx(1.2 / math.sqrt(2500))
    for unit in ("kg", "g"):
        with pytest.raises(
            rb.CaseError, match=r"a\.uff states that its unit of mass is 1000 kg, and mass_unit is .* kg"
        ):
            rb.Modal.from_file(tmp_path / "a.uff", points={"p": 7}, mass_unit=unit)
    (tmp_path / "a.csv").write_text("frequency (Hz),damping,modal mass (g),p\n11,0.01,2500,1.2\n")
    with pytest.raises(
        rb.CaseError, match=r"a\.csv states that its unit of mass is 0\.001 kg, and mass_unit is 1000 kg"
    ):
        rb.Modal.from_file(tmp_path / "a.csv", mass_unit="t")
    (tmp_path / "a.uff").write_text(units.format(10, "mm", 2, 1.0, 1.0, 1.0, 273.15) + set_55(8, 11.0))
    with pytest.raises(rb.DataError, match="try: mass_unit"):
        rb.Modal.from_file(tmp_path / "a.uff", points={"p": 7})
    decided = rb.Modal.from_file(tmp_path / "a.uff", points={"p": 7}, mass_unit="t")
    assert decided.shapes == right.shapes


@pytest.mark.parametrize("text", ["-0.05 t^0.5", "-0.05 t^1/2", "-0.05 sqrt(t)", f"{-50 * math.sqrt(1e-3)!r} kg^0.5"])
def test_participation_with_a_unit(text: str) -> None:
    """Participation is converted from its unit; its share of the total mass is noted, and a small one is a warning.

    The signature allowed text, but only numbers were read, and no test gave numbers of a model in mm, t and N.
    """
    options: dict[str, Any] = {
        "frequencies": [11.0],
        "damping_ratio": 0.01,
        "shapes": {"p": [0.5]},
        "total_mass": "6 kg",
    }
    base = rb.HalfSine(amplitude="1 g", duration="5 ms")
    modal = rb.Modal(participation=[text], **options)
    np.testing.assert_allclose(modal.participation, [-0.05 * math.sqrt(1e3)], rtol=1e-12)
    notes = plausibility_notes(rb.Case(structure=modal, base=base, duration="0.1 s"))
    assert notes == ("note: the effective masses of the modes are 41.7 % of the total mass",)
    assert plausibility_notes(rb.Case(structure=modal, duration="0.1 s")) == ()
    slip = rb.Modal(participation=[-0.05], **options)
    notes = plausibility_notes(rb.Case(structure=slip, base=base, duration="0.1 s"))
    assert any(note.startswith("warning") and "0.042 % of the total mass" in note and "t^0.5" in note for note in notes)
    with pytest.raises(rb.CaseError, match=r"participation\[0\] = '1 kg'\n  a participation .* is needed, not a mass"):
        rb.Modal(participation=["1 kg"], **options)


def test_a_column_of_participation_with_a_unit(tmp_path: Path) -> None:
    """The unit above a column of participation is that of the modes, or the table is refused."""
    (tmp_path / "a.csv").write_text("frequency (Hz),damping,p (t^-0.5),participation (t^0.5)\n11,0.01,16,0.05\n")
    np.testing.assert_allclose(rb.Modal.from_file(tmp_path / "a.csv").participation, [0.05 * math.sqrt(1e3)])
    (tmp_path / "a.csv").write_text("frequency (Hz),damping,p (kg^-0.5),participation (t^0.5)\n11,0.01,0.5,0.05\n")
    with pytest.raises(rb.DataError, match="participation is in another unit of mass"):
        rb.Modal.from_file(tmp_path / "a.csv")


@pytest.mark.parametrize(("mark", "encoding"), [(";", "utf-8"), ("\t", "utf-16"), (";", "cp1252"), (",", "utf-8-sig")])
def test_tables_as_spreadsheets_write_them(tmp_path: Path, mark: str, encoding: str) -> None:
    """Decimal commas, exponents D and the encodings of Windows are read in tables of modes, as they are in records.

    Only records had tests of them: tables of modes were refused as no text, or as no numbers.
    """
    rows = ["frequency (Hz)|damping (%)|modal mass (kg)|Stütze", "12.5|1.5|2.0D+00|0.25", "70.25|1|5D-1|-1.0"]
    text = "\n".join(rows) if mark == "," else "\n".join(rows).replace(".", ",")
    (tmp_path / "a.csv").write_bytes(text.replace("|", mark).encode(encoding))
    modal = rb.Modal.from_file(tmp_path / "a.csv")
    assert modal.frequencies == [12.5, 70.25] and modal.damping_ratios == [0.015, 0.01]
    np.testing.assert_allclose(modal.modes().shapes["Stütze"], [0.25 / 2**0.5, -1 / 0.5**0.5])
    assert ["the comma is read as the decimal mark" in note for note in modal.notes()] == [True] * (mark != ",")
    for cells in ("1,250;1;2;1", "12,5;1;2.0;1"):
        (tmp_path / "b.csv").write_text(f"frequency (Hz);damping (%);modal mass (kg);tip\n{cells}\n")
        with pytest.raises(rb.DataError, match=r"may be decimal marks|is not a number"):
            rb.Modal.from_file(tmp_path / "b.csv")


def test_columns_of_participation_in_any_order(tmp_path: Path) -> None:
    """Columns of participation belong to the axes in their names, whatever their order; incomplete ones are refused.

    They were taken as x, y and z in the order of the columns: all tests had this order.
    """
    head = "frequency (Hz),damping (%),modal mass (kg),tip x,tip y,tip z,"
    row = "\n12,1,1,1,0,0.5,3,1,2\n"
    (tmp_path / "a.csv").write_text(head + "participation z,participation x,participation y" + row)
    assert rb.Modal.from_file(tmp_path / "a.csv").participation == [[1.0, 2.0, 3.0]]
    for others in ("participation z,participation x,mode", "participation 1,participation 2,participation 3"):
        (tmp_path / "a.csv").write_text(head + others + row)
        with pytest.raises(rb.DataError, match="are not the participation along x, y and z"):
            rb.Modal.from_file(tmp_path / "a.csv")


def test_other_quantities_in_tables_of_modes(tmp_path: Path) -> None:
    """Ratios of masses are no participation factors, and effective masses no shapes; no table of a test had them."""
    head = "frequency (Hz),damping (%),modal mass (kg),tip,"
    for others in (
        "participation ratio",
        "participation mass (kg)",
        "effective mass x (kg)",
        "modal stiffness",
        "zeta",
    ):
        (tmp_path / "a.csv").write_text(head + others + "\n12,1,4,1,0.5\n")
        modal = rb.Modal.from_file(tmp_path / "a.csv")
        assert modal.participation is None and list(modal.shapes) == ["tip"]
        assert f"a.csv: the column '{others.removesuffix(' (kg)')}' is not read" in modal.notes()
    (tmp_path / "a.csv").write_text(head + "participation factor\n12,1,4,1,0.5\n")
    assert rb.Modal.from_file(tmp_path / "a.csv").participation == [0.25]


def test_toml_tables(tmp_path: Path) -> None:
    """A TOML table has the fields of Modal and, optionally, modal masses."""
    (tmp_path / "modes.toml").write_text(
        'frequencies = ["10 Hz", 25]\ndamping_ratios = [0.01, 0.02]\nmodal_masses = ["4 kg", 1]\n[shapes]\ntip = [2, -1]\n'
    )
    modal = rb.Modal.from_file(tmp_path / "modes.toml")
    np.testing.assert_allclose(modal.shapes["tip"], [1, -1])
    assert modal.frequencies == [10, 25] and modal.damping_ratios == [0.01, 0.02]


def test_matrices_in_matrix_market_files(tmp_path: Path) -> None:
    """K and M are read from one file each, full or as one triangle."""
    K, M = np.array([[3e4, -1e4], [-1e4, 1e4]]), np.diag([2.0, 1.0])
    scipy.io.mmwrite(tmp_path / "K.mtx", K, symmetry="symmetric")
    scipy.io.mmwrite(tmp_path / "M.mtx", scipy.sparse.coo_array(M))
    (tmp_path / "case.toml").write_text(
        'duration = 1.0\n[structure]\nkind = "matrices"\nfile = { M = "M.mtx", K = "K.mtx" }\npoints = { tip = 1 }\n'
        'damping_ratio = 0.01\n[load]\nkind = "half_sine"\namplitude = "1 N"\nduration = "1 ms"\n'
    )
    case = rb.Case.from_file(tmp_path / "case.toml")
    same = rb.Matrices(M=M, K=K, points={"tip": 1}, damping_ratio=0.01).modes()
    np.testing.assert_allclose(case.modes.stiffness, same.stiffness, rtol=1e-14)
    assert rb.Case.from_toml(case.to_toml()) == case
    case.to_file(tmp_path / "again.toml")
    assert 'K = "K.mtx"' in (tmp_path / "again.toml").read_text()
    assert rb.Case.from_file(tmp_path / "again.toml") == case


def test_matrices_of_files_by_name(tmp_path: Path) -> None:
    """`from_file` takes one Matrix Market file for each matrix, as its page describes, and refuses a single one."""
    scipy.io.mmwrite(tmp_path / "K.mtx", np.array([[3e4, -1e4], [-1e4, 1e4]]))
    scipy.io.mmwrite(tmp_path / "M.mtx", scipy.sparse.coo_array(np.diag([2.0, 1.0])))
    paths = {"M": tmp_path / "M.mtx", "K": str(tmp_path / "K.mtx")}
    read = rb.Matrices.from_file(paths, points={"tip": 0})
    assert read == rb.Matrices(file={name: str(path) for name, path in paths.items()}, points={"tip": 0})
    with pytest.raises(rb.DataError, match=r"is one matrix; M and K are needed\n  try: file = {\"M\""):
        rb.Matrices.from_file(tmp_path / "M.mtx", points={"tip": 0})
    with pytest.raises(rb.DataError, match="there is no file"):
        rb.Matrices.from_file({"M": tmp_path / "M.mtx", "K": tmp_path / "none.mtx"}, points={"tip": 0})
    with pytest.raises(rb.DataError, match="there is no file"):
        rb.Positions.from_file(tmp_path / "none.csv")


@pytest.mark.parametrize("kind", ["coordinate", "array"])
@pytest.mark.parametrize("symmetry", ["general", "symmetric"])
@pytest.mark.parametrize("field", ["real", "integer"])
def test_matrix_market_against_scipy(tmp_path: Path, kind: str, symmetry: str, field: str) -> None:
    """Random matrices that SciPy writes in each form of the format are read as SciPy reads them."""
    random = np.random.default_rng(3)
    for n in (1, 2, 7, 40):
        matrix = np.round(random.standard_normal((n, n)) * 100, 0 if field == "integer" else 17)
        matrix = matrix + matrix.T if symmetry == "symmetric" else matrix
        matrix[random.random((n, n)) < 0.4] = 0
        matrix = np.tril(matrix) + np.tril(matrix, -1).T if symmetry == "symmetric" else matrix
        given = matrix.astype(int) if field == "integer" else matrix
        written = scipy.sparse.coo_array(given) if kind == "coordinate" else given
        scipy.io.mmwrite(tmp_path / "A.mtx", written, comment=" two\n lines", symmetry=symmetry, precision=17)
        expected = scipy.io.mmread(tmp_path / "A.mtx")
        expected = expected.toarray() if kind == "coordinate" else expected
        np.testing.assert_array_equal(read_matrix(tmp_path / "A.mtx"), expected)


def test_a_child_process_with_limits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A reader that takes too long, or asks for too much memory, is stopped, and the file is refused."""
    monkeypatch.setattr(guarded, "LEAST_TIME", 0.001)
    monkeypatch.setattr(guarded, "BYTES_PER_SECOND", 1e12)
    with pytest.raises(rb.DataError, match=r"cannot be read as \.rst within 0 s"):
        guarded.arrays_from_child(RST, "rst")
    monkeypatch.undo()
    monkeypatch.setattr(guarded, "LEAST_MEMORY", 1 << 20)
    monkeypatch.setattr(guarded, "MEMORY_PER_BYTE", 0)
    with pytest.raises(rb.DataError, match="try: the complete file"):
        guarded.arrays_from_child(RST, "rst")
    assert set(guarded.IN_CHILD) == {"rst", "full", "mat", "h5"}


@pytest.mark.parametrize("replaced", [True, False])
def test_libraries_for_pictures_are_not_loaded(replaced: bool, tmp_path: Path) -> None:
    """Arrays of Ansys are read without the libraries for pictures, which took most of the time that no test measured.

    A version of the reader that needs one of them when it is imported gets it, and the arrays are the same.
    """
    script = (
        "import sys; from pathlib import Path; from rattlebox.exchange.read import ansys_arrays as a;"
        f"a._Unused = a._Unused if {replaced} else 0; a.copy_arrays('rst', sys.argv[1], sys.argv[2]);"
        "print(isinstance(getattr(sys.modules.get('vtkmodules.vtkCommonCore'), '__file__', 0), str))"
    )
    output = tmp_path / "arrays.npz"
    command = [sys.executable, "-c", script, str(RST), str(output)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.stdout == f"{not replaced}\n", done.stderr
    with np.load(output) as arrays:
        assert arrays["frequencies"] == pytest.approx([7366.495, 7366.495, 11504.895, 17285.705, 17285.705, 20137.193])
        assert arrays["shapes"].shape == (6, len(arrays["nodes"]), 3)


@pytest.mark.parametrize("count", [6, 140])
def test_a_free_structure(monkeypatch: pytest.MonkeyPatch, count: int) -> None:
    """Matrices of Ansys without a support have six rigid-body modes, by the dense and by the sparse solver.

    Every file that was tried had supports.
    """
    random = np.random.default_rng(5)
    places, masses = random.uniform(-1, 1, (count, 3)), random.uniform(1, 2, count)
    K = np.zeros((count, 3, count, 3))
    for a, b in combinations(range(count), 2):
        unit = (places[b] - places[a]) / np.linalg.norm(places[b] - places[a])
        block = 1e5 * np.outer(unit, unit)
        for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
            K[i, :, j] += sign * block
    upper = scipy.sparse.coo_array(np.triu(K.reshape(3 * count, -1)))
    n = np.arange(3 * count)
    arrays = {
        "rows": np.column_stack([1 + n // 3, n % 3]), "fixed": ansys_arrays._read_fixed([]),
        "K_row": upper.row, "K_column": upper.col, "K_value": upper.data,
        "M_row": n, "M_column": n, "M_value": np.repeat(masses, 3),
    }  # fmt: skip
    monkeypatch.setattr(ansys, "_read_arrays", lambda *_: arrays)
    modal = rb.Modal.from_file(FULL, points={"a": 2}, damping_ratio=0.01, mode_count=8)
    assert [frequency == 0 for frequency in modal.frequencies] == [True] * 6 + [False] * 2
    assert np.isfinite(modal.modes().decay).all() and not modal.modes().decay[:6].any()
    np.testing.assert_allclose(modal.total_mass, masses.sum(), rtol=1e-12)
    np.testing.assert_allclose(rb.effective_masses(modal).shares, 1.0, rtol=1e-9)
    assert "6 rigid-body modes, without stiffness" in list(modal.notes())[-1]


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("a.med", "FORMAT='IDEAS'.*modal_masses"),
        ("a.op2", r"\.f06"),
        ("a.odb", "table of modes"),
    ],
)
def test_files_that_are_not_read_name_an_export(tmp_path: Path, name: str, advice: str) -> None:
    """Files of modes without a reader are refused with the output that is read instead; a preview says the same."""
    (tmp_path / name).write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(range(256)))
    for read in (lambda path: rb.Modal.from_file(path, damping_ratio=0.01), rb.inspect):
        with pytest.raises(rb.DataError, match=advice):
            read(tmp_path / name)


def test_rigid_body_modes_of_results(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Frequencies of rigid-body modes that are rounding of zero become zero, with a note, and do not stop a run.

    Those of universal files and .rst files were read as oscillations that last hours.
    """
    content = (UFF / "normal_modes_55.uff").read_bytes()
    (tmp_path / "modes.uff").write_bytes(
        content.replace(b"  1.00000e+01  0.00000e+00", b"  1.30000e-05  0.00000e+00", 1)
    )
    options: dict[str, Any] = {"points": {"a": "2 x"}, "damping_ratio": 0.01}
    uff = rb.Modal.from_file(tmp_path / "modes.uff", modal_masses=["1 kg"] * 3, **options)
    arrays = ansys._read_arrays(RST, "rst")
    frequencies = np.array([2e-4, *arrays["frequencies"][1:]])
    monkeypatch.setattr(ansys, "_read_arrays", lambda *_: {**arrays, "frequencies": frequencies})
    for modal in (uff, rb.Modal.from_file(RST, **options)):
        assert modal.frequencies[0] == 0.0 < modal.frequencies[1]
        assert "1 rigid-body mode, without stiffness and damping" in list(modal.notes())[-1]
    # A push moves the structure on with its impulse over the mass of the rigid-body mode.
    one = rb.Modal.from_file(tmp_path / "modes.uff", modal_masses=["2 kg"] * 3, mode_numbers=[1], **options)
    push = rb.HalfSine(amplitude="30 N", duration="0.1 s")
    run = rb.simulate(rb.Case(structure=one, load=push, duration="0.2 s"))
    shape = one.modes().shapes["a"][0]
    assert run.motion.velocity.isel(time=-1).item() == pytest.approx(30 * 0.1 * 2 / np.pi * shape**2, rel=1e-9)


def test_errors_of_other_libraries_name_the_file(tmp_path: Path) -> None:
    """Every exception of a reader becomes an error with the name of the file, of a length that can be read."""
    for error in (
        KeyError("data"),
        OverflowError("too large"),
        ValueError(""),
        MemoryError(),
        OSError(22, "Invalid"),
        RecursionError(),
    ):
        with (
            pytest.raises(rb.DataError, match=r"a\.uff.*\n  try: ") as caught,
            guarded.errors_of(tmp_path / "a.uff", "a file"),
        ):
            raise error
        assert len(str(caught.value)) < 500
    with pytest.raises(rb.DataError) as caught, guarded.errors_of(tmp_path / "a.uff", "a file"):
        raise rb.DataError("a.uff: " + "A" * 100_000, "another")
    assert len(str(caught.value)) < 1100


@pytest.mark.parametrize("heading", ["P1" + " " * 9000 + "x", "A" * 140_000, "(" * 9000, "x " * 5000, '"' * 1001])
def test_headings_of_any_length(tmp_path: Path, heading: str) -> None:
    """A heading of thousands of blanks, letters or brackets is read or refused at once; a pattern took cubic time."""
    (tmp_path / "a.csv").write_text(f"frequency (Hz),damping,{heading}\n10,0.1,1\n")
    start = time.process_time()
    with contextlib.suppress(rb.RattleboxError):
        rb.Modal.from_file(tmp_path / "a.csv")
    with contextlib.suppress(rb.RattleboxError):
        rb.SDOF(mass=f"1 {heading}", stiffness=1)
    with contextlib.suppress(rb.RattleboxError):
        rb.Modal.from_file(FULL, points={"a": heading}, damping_ratio=0.01)
    assert time.process_time() - start < 2


def test_records_of_universal_files() -> None:
    """Text and binary time histories are read as records in the unit of the file."""
    binary = rb.Record.from_file(UFF / "time_history_58b.uff")
    assert binary.unit == "m/s^2" and len(binary.times) == 250
    np.testing.assert_allclose(
        binary.evaluate(binary.times), 9.80665 * np.sin(2 * np.pi * 5 * np.array(binary.times)), atol=1e-4
    )
    text = rb.Record.from_file(UFF / "time_history_58.uff")
    assert text.unit == "m/s^2" and len(text.times) == 13
    with pytest.raises(rb.DataError, match="no time history 3"):
        rb.Record.from_file(UFF / "time_history_58b.uff", columns=[3])
    with pytest.raises(rb.DataError, match="no time history"):
        rb.Record.from_file(UFF / "frf_58.uff")
    assert np.iscomplexobj(read_functions(UFF / "frf_58.uff")[0].values)


def test_functions_that_are_no_record_are_named(tmp_path: Path) -> None:
    """The message names the types of functions; a general function over frequency was read as times, since all had times."""
    with pytest.raises(rb.DataError, match="no time history, but 1 x frequency response function"):
        rb.Record.from_file(UFF / "frf_58.uff")
    lines = (UFF / "time_history_58.uff").read_text(encoding="latin-1").splitlines(keepends=True)
    first = next(k for k, line in enumerate(lines) if line.strip() == "58")
    for kind, over, message in (
        (9, 18, "power spectral density"),
        (6, 18, "coherence"),
        (0, 18, "general function"),
        (99, 17, "function of type 99"),
    ):
        edit = [*lines]
        edit[first + 6] = f"{kind:5d}" + edit[first + 6][5:]
        edit[first + 8] = f"{over:10d}" + edit[first + 8][10:]
        (tmp_path / "a.uff").write_text("".join(edit), encoding="latin-1")
        with pytest.raises(rb.DataError, match=f"no time history, but 1 x {message}"):
            rb.Record.from_file(tmp_path / "a.uff")


def edited(content: bytes, old: bytes, new: bytes) -> bytes:
    """Replace the first occurrence of `old`, which must exist."""
    assert old in content
    return content.replace(old, new, 1)


MODES = (UFF / "modes_mm_mN_2414.uff").read_bytes()
BINARY = (UFF / "time_history_58b.uff").read_bytes()
RESULT, MATRICES = RST.read_bytes(), FULL.read_bytes()
MTX = b"%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 1.0\n2 2 1.0\n"


def swapped(content: bytes) -> bytes:
    """Swap the byte order of 4-byte words."""
    whole = len(content) // 4 * 4
    return np.frombuffer(content[:whole], "<u4").byteswap().tobytes()


DAMAGED: list[tuple[str, str, bytes, str]] = [
    ("empty table", "a.csv", b"", "is empty"),
    ("table of text", "a.csv", b"hello\nworld\n", "no column is called frequency"),
    ("header alone", "a.csv", b"frequency,tip\n", "no mode below it"),
    ("cut table", "a.csv", TABLE.encode()[:-12], "its last line is cut short"),
    ("no shapes", "a.csv", b"frequency,damping\n10,0.1\n", "no mode shape at any point"),
    ("unknown unit", "a.csv", b"frequency (rpm),damping,tip\n10,0.1,1\n", "'frequency' .*'rpm'"),
    ("text in a table", "a.csv", b"frequency,damping,tip\n10,0.1,one\n", "column 'tip': 'one' is not a number"),
    ("nan in a table", "a.csv", b"frequency,damping,tip\n10,0.1,nan\n", "is not finite"),
    ("per cent without sign", "a.csv", b"frequency,tip\n10,0\n", "states no damping"),
    ("negative damping", "a.csv", b"frequency,damping,tip\n10,-0.1,1\n", r"a\.csv: damping_ratios contains -0\.1"),
    ("negative frequency", "a.csv", b"frequency,damping,tip\n-10,0.1,1\n", r"a\.csv: frequencies contains -10"),
    ("text as mass", "a.toml", b'frequencies=[1]\nmodal_masses=["x"]\n[shapes]\ntip=[1]\n', r"a\.toml: a mass .*\n.*try:"),
    ("nothing moves", "a.csv", b"frequency,damping,tip\n10,0.1,0\n", "points tip"),
    ("negative mass", "a.csv", b"frequency,damping,modal mass,tip\n10,0.1,-1,1\n", "modal mass of -1"),
    ("bytes as a table", "a.csv", bytes(range(128, 256)), "contains a control character"),
    ("empty toml", "a.toml", b"", "is empty"),
    ("foreign toml", "a.toml", b"[shape]\ntip = [1]\n", "no field 'shape'"),
    ("empty universal file", "a.uff", b"", "is empty"),
    ("no universal file", "a.uff", b"hello\nworld\n" * 10, "data set of a universal file"),
    ("cut universal file", "a.uff", MODES[: len(MODES) * 2 // 3], "with -1"),
    ("mis-scaled units", "a.uff", edited(MODES, b"1.00000000000000000D+03", b"1.00000000000000000D-03"),
     "set 164 states a factor of 0.001 for lengths, but its code 5 means 1000"),
    ("temperatures", "a.uff", (UFF / "temperatures_2414.uff").read_bytes(), "no modes of displacements"),
    ("measurement", "a.uff", BINARY, "no set 55 or 2414; .* 58"),
    ("empty result", "a.rst", b"", "is empty"),
    ("text as a result", "a.rst", b"hello world " * 1000, "binary file of Ansys"),
    ("swapped result", "a.rst", swapped(RESULT), "big-endian"),
    ("cut header", "a.rst", RESULT[:2000], "ends within its header"),
    ("cut result", "a.rst", RESULT[: len(RESULT) // 2], "but its header states"),
    ("matrices as a result", "a.rst", MATRICES, ".rst file; its format is"),
    ("swapped matrices", "a.full", swapped(MATRICES), "big-endian"),
    ("cut matrices", "a.full", MATRICES[: len(MATRICES) // 2], "but its header states"),
    ("unknown ending", "a.op2", b"abc", "the ending '.op2'"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "content", "message"), [row[1:] for row in DAMAGED], ids=[row[0] for row in DAMAGED])
def test_damaged_files_of_modes(tmp_path: Path, name: str, content: bytes, message: str) -> None:
    """Truncated, mis-scaled, byte-swapped and empty files are refused with the reason."""
    (tmp_path / name).write_bytes(content)
    options: dict[str, Any] = {} if name.endswith(("csv", "toml")) else {"damping_ratio": 0.01, "points": {"a": 9581}}
    with pytest.raises(rb.RattleboxError, match=message):
        rb.Modal.from_file(tmp_path / name, **options)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is empty"),
        (b"1 0\n0 1\n", "does not begin with %%MatrixMarket"),
        (MTX[:-9], "states 2 entries, but contains 1"),
        (MTX.replace(b"1.0\n2", b"1.0\x002"), "which is not a number"),
        (MTX + bytes(16), "which is not a number"),
        (MTX[:60] + bytes(12), "which is not a number|whole numbers"),
        (MTX.replace(b"1 1 1.0", b"1 3 1.0"), "an entry outside of its 2 rows and columns"),
        (MTX.replace(b"1 1 1.0", b"1 1.5 1"), "an entry outside of its 2 rows and columns"),
        (MTX.replace(b"2 2 2", b"2 2 99999999999"), "size in whole numbers"),
        (MTX.replace(b"2 2 2", b"-2 2 2"), "size in whole numbers"),
        (MTX.replace(b"2 2 2\n1 1 1.0\n2 2 1.0", b"2 2 3\n1 2 1\n2 1 1\n2 2 1"), "on both sides of the diagonal"),
        (MTX.replace(b"symmetric", b"skew-symmetric"), "a skew-symmetric matrix of the field real"),
        (MTX.replace(b"real", b"pattern"), "a symmetric matrix of the field pattern"),
        (MTX.replace(b"matrix", b"vector"), "is no heading of a matrix"),
        (MTX.replace(b"real", b"complex").replace(b"1.0\n", b"1.0 0.0\n"), "complex numbers"),
        (MTX.replace(b"2 2 2", b"2 3 2").replace(b"symmetric", b"general"), "2 rows and 3 columns"),
        (MTX.replace(b"2 2 2", b"9000 9000 2"), "9000 degrees of freedom; at most 3000"),
        (MTX.replace(b"1 1 1.0", b"1 1 nan"), "not finite"),
    ],
)
def test_damaged_matrices(tmp_path: Path, content: bytes, message: str) -> None:
    """Damaged, complex, rectangular and large matrices are refused with the reason."""
    (tmp_path / "M.mtx").write_bytes(MTX)
    (tmp_path / "K.mtx").write_bytes(content)
    with pytest.raises(rb.RattleboxError, match=message):
        rb.Matrices(file={"M": str(tmp_path / "M.mtx"), "K": str(tmp_path / "K.mtx")}, points={"tip": 0})


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (BINARY[: len(BINARY) // 2], "data set of a universal file"),
        ((UFF / "cut_58.uff").read_bytes(), "states 2508876 points, but has 42"),
        (
            edited(BINARY, b"58b     1     2", b"58b     2     2"),
            "any measurement|cannot be read as a universal file",
        ),
        (
            edited(BINARY, struct.pack("<d", math.sin(2 * math.pi * 5 * 0.05)), struct.pack("<d", math.nan)),
            "any measurement",
        ),
    ],
)
def test_damaged_measurements(tmp_path: Path, content: bytes, message: str) -> None:
    """Truncated functions, a wrong byte order and NaN are refused."""
    (tmp_path / "a.uff").write_bytes(content)
    with pytest.raises(rb.DataError, match=message):
        rb.Record.from_file(tmp_path / "a.uff")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"points": {"a": 1}}, "states no damping\n  try: damping_ratio"),
        ({"damping_ratio": 0.01}, "has 321 points"),
        ({"damping_ratio": 0.01, "points": {"a": 99999}}, "has no point '99999'"),
        ({"damping_ratio": 0.01, "points": {"a": 1}, "mode_count": 7}, "has 6 modes"),
        ({"damping_ratio": 0.01, "points": {"a": 1}, "mode_count": 0}, "at least 1"),
        (
            {"damping_ratio": 0.01, "points": {"a": 1}, "modal_masses": [1.0]},
            "1 modal masses, but file.rst has 6 modes",
        ),
        ({"damping_ratio": 0.01, "points": {"a": 1}, "frequencies": [1.0]}, "give frequencies or a file"),
        ({"damping_ratio": 0.01, "damping_ratios": [0.1] * 6, "points": {"a": 1}}, "exclude each other"),
    ],
)
def test_fields_that_contradict_the_file(options: dict[str, Any], message: str) -> None:
    """Fields that contradict the file are refused."""
    with pytest.raises(rb.RattleboxError, match=message):
        rb.Modal.from_file(RST, **options)


def test_fields_of_files_need_a_file() -> None:
    """Fields that refer to a file are refused without a file."""
    with pytest.raises(rb.CaseError, match="points are those of a file"):
        rb.Modal(frequencies=[1.0], damping_ratio=0.0, shapes={"tip": [1.0]}, points={"tip": 1})


def test_a_base_motion_of_a_3_d_point_needs_a_direction() -> None:
    """Without a particle damper, a structure with 3-D points accepts loads, but no base motion without direction."""
    modal = rb.Modal(frequencies=[10.0], damping_ratio=0.01, shapes={"a": [[1, 0, 0.5]]}, participation=[[1, 0, 0.5]])
    with pytest.raises(rb.CaseError, match="has no direction"):
        rb.Case(structure=modal, base=rb.HalfSine(amplitude="1 g", duration="1 ms"), duration=0.1)
    load = rb.HalfSine(amplitude="1 N", duration="1 ms", direction="z")
    assert rb.simulate(rb.Case(structure=modal, load=load, duration=0.1)).ok


def test_the_phase_scatter_of_a_complex_mode() -> None:
    """Components at phases of +-20 degrees about any line, on both sides of zero, have a scatter of 20 degrees."""
    turn = np.exp(0.7j)
    z = turn * np.exp(1j * np.radians([20, -20, 200])), turn * np.exp(1j * np.radians([160, 20, -20])), np.zeros(3)
    assert _phase_scatter(np.concatenate(z)) == pytest.approx(20.0)
