"""Structures and records from files."""

from __future__ import annotations

import errno
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csc_matrix

import rattlebox as rb

K = 1e4 * np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
M = np.diag([1.0, 2.0, 3.0])
C = 0.1 * M + 2e-5 * K
TIP = np.array([0.0, 0.0, 1.0])
MIDDLE = np.array([0.25, 0.5, 0.25])
DIRECT = rb.Matrices(M=M, C=C, K=K, points={"tip": TIP, "middle": MIDDLE})

TIMES = np.array([0.0, 0.5, 2.0])
FORCE = np.array([1.0, 1 / 3, -4.0])
NUMBERS = (tuple(TIMES), tuple(FORCE))


def points(record: rb.Record) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the times and values of a record."""
    return tuple(record.times.tolist()), tuple(record.values.tolist())


def beam(folder: Path, name: str) -> Path:
    """Write the chain of three masses to a file; the name gives the format."""
    path = folder / name
    if path.suffix == ".npz":
        np.savez(path, M=M, C=C, K=K, point_tip=TIP, point_middle=MIDDLE)
    elif "sparse" in name:
        parts = {key: csc_matrix(value) for key, value in {"M": M, "C": C, "K": K}.items()}
        savemat(path, {**parts, "points": {"tip": TIP, "middle": MIDDLE}})
    else:
        savemat(path, {"M": M, "C": C, "K": K, "point_tip": TIP[:, None], "point_middle": MIDDLE})
    return path


@pytest.mark.parametrize("name", ["beam.npz", "beam.mat", "sparse.mat"])
def test_matrices_of_a_file(tmp_path: Path, name: str) -> None:
    """Matrices and points are read from NPZ, MAT and sparse MAT with a struct of points."""
    read = rb.Matrices.from_file(beam(tmp_path, name))
    for mine, given in zip(read.matrices(), (M, C, K), strict=True):
        np.testing.assert_array_equal(mine, given)
    assert read.points == DIRECT.points
    np.testing.assert_array_equal(read.modes().shape("middle"), DIRECT.modes().shape("middle"))


def test_points_in_addition_to_the_file(tmp_path: Path) -> None:
    """Points given with a file are added to those in it and override them."""
    read = rb.Matrices.from_file(beam(tmp_path, "beam.npz"), points={"foot": 0, "tip": 1})
    assert read.points == {"foot": 0, "tip": 1, "middle": MIDDLE.tolist()}


def test_a_structure_without_damping(tmp_path: Path) -> None:
    """A file without C describes an undamped structure."""
    np.savez(tmp_path / "beam.npz", M=M, K=K)
    modes = rb.Matrices.from_file(tmp_path / "beam.npz", points={"tip": 2}).modes()
    np.testing.assert_array_equal(modes.decay, np.zeros(3))


@pytest.mark.parametrize(
    ("arrays", "options", "message"),
    [
        ({"M": M, "C": C}, {}, r"beam\.npz contains no K, but M, C"),
        ({"M": np.array("soft")}, {}, r"beam\.npz .*no numbers\n  try: arrays M, C and K"),
        ({"M": M, "stiffness": K}, {}, r"contains no K, but M, stiffness"),
        ({"M": M, "K": K}, {}, r"points.*\n  at least one named point"),
        ({"M": M, "K": K[:2]}, {"points": {"tip": 2}}, r"beam\.npz\'\n  K has shape \(2, 3\), but M has 3 rows"),
        ({"M": M, "K": np.triu(K)}, {"points": {"tip": 2}}, r"beam\.npz\'\n  K is not symmetric"),
        ({"M": 0 * M, "K": K}, {"points": {"tip": 2}}, r"beam\.npz\'\n  M is not positive definite"),
        ({"M": M, "K": K * [1, np.nan, 1]}, {"points": {"tip": 2}}, r"beam\.npz: K .*nan in row 1, column 2"),
        ({"M": M, "K": K, "point_tip": [1.0, 0.0]}, {}, r"point_tip has 2 numbers, but there are 3 degrees"),
        ({"M": M, "K": K}, {"points": {"tip": 2}, "M": M}, "give M or a file, not both"),
        (
            {"M": M, "K": K},
            {"points": {"tip": 3}},
            r"points\.tip = 3\n  there is no such degree of freedom\n  try: 0 to 2",
        ),
    ],
)
def test_files_without_a_structure(
    tmp_path: Path, arrays: dict[str, Any], options: dict[str, Any], message: str
) -> None:
    """A file with invalid matrices is refused with its name and the reason."""
    np.savez(tmp_path / "beam.npz", **arrays)
    with pytest.raises((rb.CaseError, rb.DataError), match=message):
        rb.Matrices.from_file(tmp_path / "beam.npz", **options)


def record_file(folder: Path, name: str) -> Path:
    """Write times, an unused column and forces."""
    path = folder / name
    other = np.array([7.0, 8.0, 9.0])
    table = np.column_stack([TIMES, other, FORCE])
    if path.suffix == ".csv":
        path.write_text("t,speed,force\n" + "".join(f"{a!r},{b!r},{c!r}\n" for a, b, c in table.tolist()))
    elif path.suffix == ".npy":
        np.save(path, np.rec.fromarrays(table.T, names="t,speed,force"))
    elif path.suffix == ".npz":
        np.savez(path, t=TIMES, speed=other, force=FORCE)
    elif "struct" in name:
        savemat(path, {"run": {"t": TIMES, "speed": other, "force": FORCE}, "note": "by hand"})
    else:
        savemat(path, {"t": TIMES, "speed": other[:, None], "force": FORCE})
    return path


@pytest.mark.parametrize("name", ["push.csv", "push.npy", "push.npz", "push.mat"])
def test_columns_by_name(tmp_path: Path, name: str) -> None:
    """Columns of CSV and NPY and variables of NPZ and MAT are selected by name."""
    record = rb.Record.from_file(record_file(tmp_path, name), columns=("t", "force"), unit="N")
    assert points(record) == NUMBERS


def test_columns_by_number(tmp_path: Path) -> None:
    """Columns of a table are selected by number, counted from 1, in the order times, values."""
    record = rb.Record.from_file(record_file(tmp_path, "push.csv"), columns=(1, 3), unit="N")
    assert points(record) == NUMBERS
    np.save(tmp_path / "swapped.npy", np.column_stack([FORCE, TIMES]))
    record = rb.Record.from_file(tmp_path / "swapped.npy", columns=(2, 1), unit="N")
    assert points(record) == NUMBERS


def test_fields_of_a_matlab_struct(tmp_path: Path) -> None:
    """Fields of a struct are named with a dot; text variables are ignored."""
    record = rb.Record.from_file(record_file(tmp_path, "struct.mat"), columns=("run.t", "run.force"), unit="N")
    assert points(record) == NUMBERS


@pytest.mark.parametrize("name", ["push.csv", "push.npz", "push.mat"])
def test_a_column_that_is_not_there(tmp_path: Path, name: str) -> None:
    """A misspelt column is refused with the columns of the file and the nearest name."""
    with pytest.raises(rb.DataError, match=r"(?s)push\.\w+ .*speed.*did you mean 'force'\?"):
        rb.Record.from_file(record_file(tmp_path, name), columns=("t", "forces"), unit="N")


@pytest.mark.parametrize("name", ["push.csv", "push.npz", "push.mat"])
def test_three_columns_need_a_choice(tmp_path: Path, name: str) -> None:
    """Three columns without a choice are refused with an example of one."""
    with pytest.raises(rb.DataError, match=r"(?s)speed.*try: columns = "):
        rb.Record.from_file(record_file(tmp_path, name), unit="N")


def test_arrays_of_two_rows(tmp_path: Path) -> None:
    """An array of two rows is transposed only without a choice of columns."""
    np.save(tmp_path / "push.npy", [[0, 5, 9], [1, 6, 8]])
    record = rb.Record(file=tmp_path / "push.npy", columns=(1, 2))
    assert points(record) == ((0, 1), (5, 6))
    record = rb.Record(file=tmp_path / "push.npy")
    assert points(record) == ((0, 5, 9), (1, 6, 8))


@pytest.mark.parametrize("name", ["push.npy", "push.npz", "push.mat", "struct.mat"])
def test_variables_by_number(tmp_path: Path, name: str) -> None:
    """Variables are selected by number, counted from 1 in the order of the file, not of the alphabet."""
    record = rb.Record.from_file(record_file(tmp_path, name), columns=(1, 3), unit="N")
    assert points(record) == NUMBERS


@pytest.mark.parametrize("name", ["push.npz", "push.mat"])
def test_two_variables_need_no_choice(tmp_path: Path, name: str) -> None:
    """The first of two variables in a file has the times, whatever their names."""
    if name.endswith("npz"):
        np.savez(tmp_path / name, t=TIMES, a=FORCE)
    else:
        savemat(tmp_path / name, {"t": TIMES, "a": FORCE})
    record = rb.Record(file=tmp_path / name)
    assert points(record) == NUMBERS


@pytest.mark.parametrize(
    ("text", "columns", "message"),
    [
        ("t,a,a\n0,1,2\n1,2,3\n", ("t", "a"), r"push\.csv has 2 columns 'a'\n  try: its number, 2 or 3"),
        ("t,a\n0,1\n1,2\n", (1, 1), r"times and values are both column 1; it has 1 t, 2 a"),
        ("t,a\n0,1\n1,2\n", ("t", 1), r"times and values are both column 't'"),
    ],
)
def test_ambiguous_columns(tmp_path: Path, text: str, columns: tuple[Any, Any], message: str) -> None:
    """A name of two columns and one column for both times and values are refused."""
    (tmp_path / "push.csv").write_text(text)
    with pytest.raises(rb.DataError, match=message):
        rb.Record(file=tmp_path / "push.csv", columns=columns)


@pytest.mark.parametrize(
    ("arrays", "options", "message"),
    [
        ({"t": TIMES, "a": FORCE}, {"columns": (1, 3)}, r"has no variable 3; it has 1 t \(3,\), 2 a \(3,\)"),
        ({"t": TIMES, "a": FORCE}, {"columns": (2, 2)}, "times and values are both variable 2"),
        ({"t": TIMES, "table": np.ones((3, 2))}, {}, r"table has shape \(3, 2\)"),
        ({"t": TIMES}, {}, r"push.npz has 1 variable \(1 t \(3,\)\), two are needed"),
        ({"note": "by hand"}, {}, "push.npz contains no variable of real numbers"),
    ],
)
def test_variables_without_a_record(
    tmp_path: Path, arrays: dict[str, Any], options: dict[str, Any], message: str
) -> None:
    """Missing variables and variables that are not 1-D numbers are refused with the variables of the file."""
    np.savez(tmp_path / "push.npz", **arrays)
    with pytest.raises(rb.DataError, match=message):
        rb.Record(file=tmp_path / "push.npz", **options)


@pytest.mark.parametrize(
    "text",
    [
        "# made by X, version 2\nt,a\n0,1\n1,2\n",
        "# t,a\n0,1\n1,2\n",
        "Rate,1000\nUnit,N\nt,a\n0,1\n1,2\n",
        "t,a\ns,m/s^2\n0,1\n1,2\n",
        "left,right\nt,a\ns,N\nRate,1000\n0,1\n1,2\n",
        "t,day,a\n0,mon,1\n1,tue,2\n",
    ],
)
def test_names_among_other_lines_above_the_data(tmp_path: Path, text: str) -> None:
    """The line of column names is recognised below titles and above units; lines of text and numbers are not data."""
    (tmp_path / "push.csv").write_text(text)
    record = rb.Record(file=tmp_path / "push.csv", columns=("t", "a"))
    assert points(record) == ((0, 1), (1, 2))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t;f\n0,0;1.5\n1,0;2.5\n", r"line 2: '0,0' is not a number\n  try: a decimal point, not a comma"),
        ("t,f\n0,soft\n1,2\n2,3\n", r"line 2: 'soft' is not a number"),
        (
            "t,f\n0,1\n1,2\n2",
            r"line 4: 1 column, but 2 in line 2\n  try: the whole file, if its last line is cut short",
        ),
    ],
)
def test_faults_in_the_first_lines_of_data(tmp_path: Path, text: str, message: str) -> None:
    """Decimal commas and text in the first line of data are errors, not part of the header."""
    (tmp_path / "push.csv").write_text(text)
    with pytest.raises(rb.DataError, match=message):
        rb.Record(file=tmp_path / "push.csv")


@pytest.mark.parametrize("name", ["push.NPY", "push.NPZ", "push.MAT"])
def test_suffixes_in_capitals(tmp_path: Path, name: str) -> None:
    """Suffixes of binary records may be in capitals."""
    record_file(tmp_path, name.lower()).rename(tmp_path / name)
    record = rb.Record(file=tmp_path / name, columns=("t", "force"))
    assert points(record) == NUMBERS


@pytest.mark.parametrize("name", ["BEAM.NPZ", "BEAM.MAT"])
def test_suffixes_of_structures_in_capitals(tmp_path: Path, name: str) -> None:
    """Suffixes of files with matrices may be in capitals."""
    beam(tmp_path, name.lower()).rename(tmp_path / name)
    assert rb.Matrices.from_file(tmp_path / name).points == DIRECT.points


UNITS_ABOVE = {
    "time (ms),acceleration (g)": (1e-3, 9.80665, "m/s^2"),
    "t [s],a [m/s²]": (1.0, 1.0, "m/s^2"),
    "t,a\ns,mm/s^2": (1.0, 1e-3, "m/s^2"),
    "# Time [sec],Force [kN]": (1.0, 1e3, "N"),
    "t [µs],x [mm]": (1e-6, 1e-3, "m"),
    "t (s),a (in/s^2)": (1.0, 0.0254, "m/s^2"),
    "time,a(t)": (1.0, 1.0, None),
}


@pytest.mark.parametrize("above", UNITS_ABOVE, ids=str)
def test_units_above_columns_are_applied(tmp_path: Path, above: str) -> None:
    """Times and values have the units in the header; other text belongs to the name."""
    (tmp_path / "push.csv").write_text(f"{above}\n0,1\n2,3\n", encoding="utf-8")
    slower, scale, unit = UNITS_ABOVE[above]
    record = rb.Record(file=tmp_path / "push.csv")
    assert record.times == pytest.approx((0, 2 * slower), rel=1e-15)
    assert record.values == pytest.approx((scale, 3 * scale), rel=1e-15)
    assert (record.scale, record.unit) == (1.0, unit)
    parts = {} if unit == "m" else {"load" if unit == "N" else "base": record}
    case = rb.Case(structure=rb.SDOF(mass=1, stiffness=1), duration=1e-9, **parts)
    assert rb.Case.from_toml(case.to_toml()) == case


def test_scale_and_unit_of_a_record(tmp_path: Path) -> None:
    """A scale multiplies the record in physical units; a unit that contradicts the heading is refused, also with a scale."""
    (tmp_path / "push.csv").write_text("t (s),a (g)\n0,1\n2,3\n")
    scaled = rb.Record(file=tmp_path / "push.csv", scale=2.5)
    assert (scaled.scale, scaled.unit) == (2.5, "m/s^2")
    np.testing.assert_allclose(scaled.evaluate([0.0, 2.0]), [2.5 * 9.80665, 7.5 * 9.80665], rtol=1e-15)
    for options in ({}, {"scale": 2.5}):
        with pytest.raises(
            rb.CaseError, match=r"unit = 'N'\n  the file has an acceleration in this column, not a force"
        ):
            rb.Record(file=tmp_path / "push.csv", unit="N", **options)
        for unit in ("gal", "m/s^2"):
            with pytest.raises(rb.CaseError, match=r"the file states another unit above the column: 'a \(g\)'"):
                rb.Record(file=tmp_path / "push.csv", unit=unit, **options)
    assert points(rb.Record(file=tmp_path / "push.csv", unit="g")) == points(scaled)


@pytest.mark.parametrize("name", ["push.csv", "push.npy", "push.npz", "push.mat"])
def test_a_record_without_permission_to_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """A file that cannot be opened is refused with its name and the reason."""
    file = record_file(tmp_path, name)

    def refuse(*_: Any, **__: Any) -> None:
        raise PermissionError(errno.EACCES, "Permission denied", str(file))

    monkeypatch.setattr("io.open", refuse)
    monkeypatch.setattr("builtins.open", refuse)
    with pytest.raises(rb.DataError, match=rf"{name} cannot be read: Permission denied"):
        rb.Record(file=file, columns=(1, 3))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("name", ["push.npy", "push.npz", "push.mat"])
def test_numbers_that_are_not_finite(tmp_path: Path, name: str, bad: float) -> None:
    """NaN and infinity in a binary record are refused with the file and the row."""
    values = np.array([0.0, bad, 1.0])
    if name.endswith("npy"):
        np.save(tmp_path / name, np.column_stack([TIMES, values]))
    elif name.endswith("npz"):
        np.savez(tmp_path / name, time=TIMES, value=values)
    else:
        savemat(tmp_path / name, {"time": TIMES, "value": values})
    with pytest.raises(rb.DataError, match=rf"push\.\w+: .*value.* {bad} in row 2"):
        rb.Record.from_file(tmp_path / name, unit="N")


def test_columns_of_unequal_length(tmp_path: Path) -> None:
    """Times and values of different length are refused with both lengths."""
    np.savez(tmp_path / "push.npz", time=TIMES, value=FORCE[:2])
    with pytest.raises(rb.DataError, match=r"time .*3 numbers.* value 2"):
        rb.Record.from_file(tmp_path / "push.npz", unit="N")


@pytest.mark.parametrize("part", [rb.Record, rb.Matrices])
def test_a_mat_file_of_version_7_3(tmp_path: Path, part: type[rb.Record] | type[rb.Matrices]) -> None:
    """A MAT file of version 7.3 without the HDF5 content that follows its header is refused."""
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + (0x0200).to_bytes(2, "little") + b"IM"
    (tmp_path / "new.mat").write_bytes(head.ljust(512, b"\0"))
    with pytest.raises(rb.DataError, match=r"(?s)new\.mat.*version 7\.3.*the complete file"):
        part.from_file(tmp_path / "new.mat")


def test_python_objects_in_a_file_are_ignored(tmp_path: Path) -> None:
    """The numbers of an NPZ file are read although it also has an array of Python objects."""
    np.savez(tmp_path / "beam.npz", M=M, K=K, names=np.array(["foot", None], dtype=object))
    modes = rb.Matrices.from_file(tmp_path / "beam.npz", points={"tip": 2}).modes()
    assert modes.decay.shape == (3,)


def test_pickles_are_refused(tmp_path: Path) -> None:
    """An NPY file of Python objects, which could run code when it is read, is refused."""
    np.save(tmp_path / "evil.npy", np.array([{"a": 1}], dtype=object), allow_pickle=True)
    (tmp_path / "bare.npy").write_bytes(pickle.dumps([1.0, 2.0]))
    for name in ("evil.npy", "bare.npy"):
        with pytest.raises(rb.DataError, match=name):
            rb.Record.from_file(tmp_path / name, unit="N")


@pytest.mark.parametrize("name", ["none.npz", "none.mat", "none.txt"])
def test_a_structure_file_that_is_not_there(tmp_path: Path, name: str) -> None:
    """A missing file of matrices is refused with its name."""
    with pytest.raises(rb.DataError, match=name):
        rb.Matrices.from_file(tmp_path / name)


CASE = """\
duration = 1.5

[structure]
kind = "matrices"
file = "parts/beam.npz"

[[loads]]
kind = "record"
file = "parts/push.csv"
columns = ["t", "force"]
point = "tip"
"""


def test_paths_in_a_case_file_are_relative_to_its_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Relative paths in a case file start at its folder, whatever the working directory."""
    (tmp_path / "parts").mkdir()
    beam(tmp_path / "parts", "beam.npz")
    record_file(tmp_path / "parts", "push.csv")
    (tmp_path / "case.toml").write_text(CASE)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    case = rb.Case.from_file(tmp_path / "case.toml")
    assert points(case.loads[0]) == NUMBERS  # type: ignore[arg-type]
    assert set(case.modes.shapes) == {"tip", "middle"}


def test_files_named_in_a_case_survive_a_round_trip(tmp_path: Path) -> None:
    """A case with files is written with their paths relative to the new file and reads back equal."""
    folder = tmp_path / "parts"
    folder.mkdir()
    structure = rb.Matrices.from_file(beam(folder, "beam.mat"))
    push = rb.Record.from_file(record_file(folder, "push.npz"), columns=("t", "force"), scale=2.0, point="tip")
    case = rb.Case(structure=structure, load=push, duration=1.5)
    (tmp_path / "cases").mkdir()
    case.to_file(tmp_path / "cases" / "case.toml")
    text = (tmp_path / "cases" / "case.toml").read_text()
    assert 'file = "../parts/beam.mat"' in text
    assert "times" not in text
    assert "M =" not in text
    assert rb.Case.from_file(tmp_path / "cases" / "case.toml") == case
    assert rb.Case.from_toml(case.to_toml()) == case


def test_a_case_from_files_runs_like_one_from_numbers(tmp_path: Path) -> None:
    """Matrices and a record from files give the same bits as the same numbers in arrays."""
    push = rb.Record.from_file(record_file(tmp_path, "push.mat"), columns=("t", "force"), point="tip")
    plain = rb.Record(times=TIMES, values=FORCE, point="tip")
    cases = [
        rb.Case(structure=rb.Matrices.from_file(beam(tmp_path, "beam.mat")), load=push, duration=1.5),
        rb.Case(structure=DIRECT, load=plain, duration=1.5),
    ]
    first, second = rb.simulate_many(cases)
    np.testing.assert_array_equal(first.arrays.displacement, second.arrays.displacement)
    assert first.energy_residual < 1e-12


@pytest.mark.parametrize("name", ["gone.csv", "nowhere/gone.csv", "empty"])
def test_every_absent_file_has_advice(name: str, tmp_path: Path) -> None:
    """A name without a similar file, an absent folder and an empty folder have advice; only similar names were tested."""
    (tmp_path / "empty").mkdir()
    with pytest.raises(rb.DataError) as caught:
        rb.Record.from_file(tmp_path / name)
    assert "\n  try: " in str(caught.value)


def test_times_are_said_to_be_swapped_only_if_values_rise(tmp_path: Path) -> None:
    """Two equal times have no advice to swap the columns, which cannot help; the advice was always the same."""
    (tmp_path / "twice.csv").write_text("time (s),acc (g)\n0,0\n1,2\n1,3\n2,-1\n")
    (tmp_path / "swapped.csv").write_text("a,b\n5,0\n7,1\n3,2\n4,3\n")
    with pytest.raises(rb.RattleboxError, match="try: times in their order"):
        rb.Record.from_file(tmp_path / "twice.csv")
    with pytest.raises(rb.RattleboxError, match=r"try: columns = \[2, 1\]"):
        rb.Record.from_file(tmp_path / "swapped.csv")


@pytest.mark.parametrize("value", [["2 mm", "3 mm"], ["2 mm", "3"], ("1 mm", "mm")])
def test_a_list_is_no_quantity(value: Any) -> None:
    """Lists of quantities are not multiplied; only pairs of a number and a unit were tested."""
    with pytest.raises(rb.CaseError, match=r"a length \(m\) is needed\n"):
        rb.Stop(gap=value, contact=rb.Linear(stiffness="1 MN/m", restitution=0.5))
