"""Records of other programs: scale, units in any place of the text, counts in the first line, samples row by row, start."""

from __future__ import annotations

import itertools
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.interpolate

import rattlebox as rb
from rattlebox.model.plausibility import plausibility_notes
from rattlebox.model.units_in_text import unit_above, units_in_lines

G = 9.80665
STEP = 0.0125
TIMES = STEP * np.arange(203)
SHAKE = 2.7 * np.sin(9.1 * TIMES) * np.exp(-((TIMES - 1.1) ** 2))
"""A motion of the base [m/s^2], 203 samples."""


def table(head: str, factor: float, mark: str = " ") -> str:
    """Write times and accelerations in the unit of this factor below a head."""
    rows = "\n".join(f"{t!r}{mark}{a!r}" for t, a in zip(TIMES.tolist(), (SHAKE / factor).tolist(), strict=True))
    return f"{head}\n{rows}\n" if head else f"{rows}\n"


def by_rows(head: str, width: int, factor: float = 1.0, values: Any = SHAKE) -> str:
    """Write samples row by row."""
    rows = (values[k : k + width] / factor for k in range(0, len(values), width))
    return head + "\n".join(" ".join(f"{v:.9e}" for v in row) for row in rows) + "\n"


def case(record: rb.Record) -> rb.Case:
    """Return a case with the record as motion of the base."""
    structure = rb.SDOF(mass="3 kg", frequency="1.7 Hz", damping_ratio=0.04)
    return rb.Case(structure=structure, base=record, duration="2.4 s", output=rb.Output(rate="80 Hz"))


def written(folder: Path) -> dict[str, dict[str, Any]]:
    """Write the same motion in several files and units; return the options that read each."""
    at2 = "QUAKE\nSITE\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 203, DT= .0125 SEC\n"
    (folder / "a.at2").write_text(by_rows(at2, 5, G))
    (folder / "gal.csv").write_text(table("t (s),a (gal)", 0.01, ","))
    (folder / "blanks.txt").write_text(table("Time (s)   Acceleration (mm/s^2)", 1e-3))
    (folder / "above.txt").write_text(table("SOIL SITE\nUNIT: CM/SEC/SEC", 0.01))
    (folder / "bare.txt").write_text(table("", G))
    (folder / "rows.dat").write_text(by_rows("NO. OF POINTS: 203\n", 7, 0.3048))
    np.save(folder / "array.npy", np.column_stack([TIMES, SHAKE / 0.0254]))
    return {
        "a.at2": {}, "gal.csv": {}, "blanks.txt": {}, "above.txt": {}, "bare.txt": {"unit": "g"},
        "rows.dat": {"unit": "ft/s^2", "dt": "12.5 ms"}, "array.npy": {"unit": "in/s^2"},
    }  # fmt: skip


@pytest.mark.parametrize("name", ["a.at2", "gal.csv", "blanks.txt", "above.txt", "bare.txt", "rows.dat", "array.npy"])
def test_a_scale_multiplies_the_physical_record(tmp_path: Path, name: str) -> None:
    """The scale is a factor apart from the unit: in a run, in `replaced`, and in a case that was written and read.

    Tests compared the product of scale and numbers of one record, and never gave a scale to a file that states its unit.
    """
    options = written(tmp_path)[name]
    for scale in (1.0, 0.25, -3.0):
        record = rb.Record.from_file(tmp_path / name, scale=scale, **options)
        assert record.scale == scale and record.unit == "m/s^2"
        plain = case(rb.Record.from_file(tmp_path / name, **options))
        for each in (
            case(record),
            plain.replaced({"base.scale": scale}),
            plain.replaced({"base.scale": 7.0}).replaced({"base.scale": scale}),
            rb.Case.from_toml(case(record).to_toml()),
            rb.Case.from_toml(plain.replaced({"base.scale": scale}).to_toml()),
        ):
            assert each == case(record)
            np.testing.assert_allclose(each.base[0].evaluate(TIMES), scale * SHAKE, rtol=1e-8, atol=1e-9)
            assert not [note for note in plausibility_notes(each) if "assumed" in note or "warning" in note]


def test_scale_and_file_as_axes(tmp_path: Path) -> None:
    """A study over `scale` is linear in it, and one over `file` converts each file by its own unit.

    The axes of tests were numbers of dampers; no test varied a field of a part that is read from a file.
    """
    written(tmp_path)
    base = case(rb.Record.from_file(tmp_path / "a.at2"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scaled = rb.sweep(base, {"base.scale": [0.5, 1.0, 2.0]}, ["peak"], progress=False).peak.values
        files = [str(tmp_path / name) for name in ("a.at2", "gal.csv", "blanks.txt", "above.txt")]
        both = rb.sweep(base, {"base.file": files, "base.scale": [1.0, 4.0]}, ["peak"], progress=False).peak.values
    np.testing.assert_allclose(scaled, scaled[1] * np.array([0.5, 1.0, 2.0]), rtol=1e-9)
    alone = rb.simulate(base, progress=False).motion.displacement
    assert scaled[1] == pytest.approx(float(np.abs(alone).max()), rel=5e-3)  # that of a sweep is between the samples
    np.testing.assert_allclose(both, scaled[1] * np.array([[1.0, 4.0]] * 4), rtol=1e-7)


def test_a_study_warns_of_assumptions_about_files(tmp_path: Path) -> None:
    """A file of an axis that states no unit gives a warning with the peak, as a run of it gives a note."""
    written(tmp_path)
    base = case(rb.Record.from_file(tmp_path / "gal.csv"))
    files = [str(tmp_path / name) for name in ("gal.csv", "bare.txt", "a.at2")]
    with pytest.warns(UserWarning, match=r"bare\.txt states no unit; m/s\^2 is assumed, with a peak of ") as caught:
        rb.sweep(base, {"base.file": files}, ["peak"], progress=False)
    assert len([each for each in caught if "assumed" in str(each.message)]) == 1


def test_a_unit_is_an_axis_of_its_own(tmp_path: Path) -> None:
    """Another unit of a file without one replaces the first one; it does not multiply it."""
    written(tmp_path)
    base = case(rb.Record.from_file(tmp_path / "bare.txt", unit="g", scale=2.0))
    other = base.replaced({"base.unit": "gal"})
    np.testing.assert_allclose(other.base[0].evaluate(TIMES), 2 * SHAKE / G * 0.01, rtol=1e-12, atol=1e-15)
    assert 'unit = "gal"' in other.to_toml()


@pytest.mark.parametrize("unit", ["g", "kN", "mm"])
def test_numbers_in_another_unit(unit: str) -> None:
    """Values without a file are stored in SI units, in which a written case states them."""
    factor = {"g": G, "kN": 1e3, "mm": 1e-3}[unit]
    record = rb.Record(times=[0, 1, 3], values=[1, -2, 4], unit=unit, scale=0.5)
    np.testing.assert_allclose(record.values, factor * np.array([1.0, -2.0, 4.0]), rtol=1e-15)
    np.testing.assert_allclose(record.evaluate([1.0]), -1.0 * factor, rtol=1e-15)


HEADS = {
    "Time (s)   Acceleration ({})": " ", "Time [s]  Acc [{}]": " ", "t[sec] acc[{}]": " ", "% t (s) a ({})": " ",
    "Elapsed time (s) Ground acceleration ({})": " ", "Elapsed time (s)    Ground acceleration ({})": " ",
    "time (s), acceleration ({})": " ", "t\ta ({})": " ", "t (s)\tacceleration, filtered ({})": "\t",
    "time,acc in {}": ",", "t/s,a/({})": ",", "t,a\ns,{}": ",", "t;a [{}]": ";",
    "UNIT: {}": " ", "Units of {}": " ", "units = {}": ",", "The units are ({})": " ", "# unit {}": " ",
    "Y_Unit_Label\t{}": " ", "Unit Y: {}": " ", "acceleration_unit: {}": ",", "Einheit: {}": " ",
    "EW component, acceleration in {}, dt = 0.0125 s": " ", "# {}": " ", "[{}]": " ",
    "STATION 17\nPEAK 2.7 AT 1.1 SEC\nCORRECTED ACCELERATION  UNIT: {}\nDEPTH 9 KM": " ",
}  # fmt: skip
UNITS = {
    "g": G, "G": G, "cm/s^2": 0.01, "CM/SEC/SEC": 0.01, "CM/S/S": 0.01, "M/S2": 1.0, "m/s²": 1.0, "cm/sec2": 0.01,
    "gal": 0.01, "Gal": 0.01, "GAL": 0.01, "gals": 0.01, "MM/S^2": 1e-3, "in/s^2": 0.0254, "FT/SEC^2": 0.3048, "m s^-2": 1.0,
    "cm/s**2": 0.01, "meters per second squared": 1.0, "cm/second^2": 0.01, "g's": G,
    "m·s⁻²": 1.0, "m.s-2": 1.0, "ms^-2": 1.0, "Cm/Sec²": 0.01, "m/s^{2}": 1.0, "MG": G / 1e3,
}  # fmt: skip


@pytest.mark.parametrize("head", HEADS)
def test_a_unit_above_the_numbers_is_used_or_refused(tmp_path: Path, head: str) -> None:
    """A known unit that stands above the numbers is used, or the file is refused; a note never denies it.

    The units of tests were in cells of tables with commas; none was separated by blanks, in capitals, or in a line of text.
    """
    for unit, factor in UNITS.items():
        mark = HEADS[head]
        above = head.format(unit)
        if " " in unit and not ("(" in head or "[" in head) and head not in ("time,acc in {}", "t,a\ns,{}"):
            continue  # words of a unit, without anything around them
        (tmp_path / "a.txt").write_text(table(above, factor, mark), encoding="utf-8")
        record = rb.Record.from_file(tmp_path / "a.txt")
        np.testing.assert_allclose(record.evaluate(TIMES), SHAKE, rtol=1e-9, atol=1e-12, err_msg=above)
        assert not any("assumed" in note for note in record.notes()), above


@pytest.mark.parametrize(
    ("head", "words"),
    [
        ("PGA 34.2 cm/s^2", "line 1, 'PGA 34.2 cm/s^2'"),
        ("Scale Factor 2000(gal)/8388608", "scale factor of its header is not applied"),
        ("recorded in g\nfiltered then in cm/s^2", "in line 1, 'recorded in g' and 2"),
        ("Y_Unit_Label Volts", "'Volts', which is not a unit of"),
        ("unit: psi", "'psi', which is not a unit of"),
    ],
)
def test_units_that_are_not_clear_are_refused(tmp_path: Path, head: str, words: str) -> None:
    """A unit that may be another quantity's is refused with the line, and the advised `unit` decides."""
    (tmp_path / "a.txt").write_text(table(head, 0.01))
    with pytest.raises(rb.RattleboxError, match=r"try: .*unit") as error:
        rb.Record.from_file(tmp_path / "a.txt")
    assert words in str(error.value)
    decided = rb.Record.from_file(tmp_path / "a.txt", unit="gal")
    np.testing.assert_allclose(decided.evaluate(TIMES), SHAKE, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize(
    "head", ["EPICENTER 39.939N 77.339E DEPTH 9 KM", "mass 5 kg, stroke 10 mm", "Station Height(m) 34", "made in a lab"]
)
def test_units_of_other_things_are_no_units_of_the_values(tmp_path: Path, head: str) -> None:
    """Units of coordinates, depths and strokes are not used for the values; the note does not deny that they exist."""
    (tmp_path / "a.txt").write_text(table(head, 1.0))
    (note,) = plausibility_notes(case(rb.Record.from_file(tmp_path / "a.txt")))
    assert "m/s^2 is assumed" in note and "no unit that is recognised" in note and "states no unit" not in note


def test_a_unit_in_a_line_is_noted(tmp_path: Path) -> None:
    """A run notes the line from which a unit is taken, and a user's unit that differs from it."""
    (tmp_path / "a.txt").write_text("UNIT: GAL\nEL NIDO\nNS\n" + "\n".join(f"{a!r}" for a in (SHAKE / 0.01).tolist()))
    (note,) = plausibility_notes(case(rb.Record.from_file(tmp_path / "a.txt", dt=STEP)))
    assert "a.txt is taken from line 1, 'UNIT: GAL'" in note
    (note,) = plausibility_notes(case(rb.Record.from_file(tmp_path / "a.txt", dt=STEP, unit="mm/s^2")))
    assert "unit = 'mm/s^2' is used, but line 1 states another one" in note


COUNTED = {
    "203 0.0125\n": ({}, 2), "203  .0125\n": ({"unit": "m/s^2"}, 2), "0.0125 203\n": ({}, 1), "203\n": ({"dt": STEP}, 1),
    "203 0.0125 \n": ({"dt": STEP}, 1), "EL CENTRO\n203 0.0125\n": ({}, 1),
}  # fmt: skip


@pytest.mark.parametrize("head", COUNTED)
def test_a_number_of_samples_is_no_data(tmp_path: Path, head: str) -> None:
    """A first line with the number of samples, with or without the time step, is not read as data, and is noted.

    The first line of each table in tests was data or text.
    """
    options, columns = COUNTED[head]
    rows = table("", 1.0) if columns == 2 else "\n".join(f"{a!r}" for a in SHAKE.tolist())
    (tmp_path / "a.txt").write_text(head + rows)
    record = rb.Record.from_file(tmp_path / "a.txt", **options)
    np.testing.assert_allclose(record.times, TIMES, atol=1e-12)
    np.testing.assert_allclose(record.evaluate(TIMES), SHAKE, rtol=1e-12, atol=1e-15)
    assert any("is read as the number of samples" in note for note in record.notes())
    if columns == 2:
        second = rb.Record.from_file(tmp_path / "a.txt", dt=STEP, columns=(2,))
        np.testing.assert_array_equal(second.values, record.values)


def test_a_number_of_samples_that_does_not_fit(tmp_path: Path) -> None:
    """A stated number of samples that differs from the rows is refused or noted, and is never read as data."""
    (tmp_path / "a.txt").write_text("900\n" + "\n".join(f"{a!r}" for a in SHAKE.tolist()))
    with pytest.raises(rb.DataError, match="900 is no number of samples, of which 203 follow"):
        rb.Record.from_file(tmp_path / "a.txt", dt=STEP)
    (tmp_path / "a.txt").write_text("900 0.0125\n" + table("", 1.0).split("\n", 1)[1])
    record = rb.Record.from_file(tmp_path / "a.txt", dt=STEP, columns=(2,))
    np.testing.assert_array_equal(record.values, SHAKE[1:])
    assert any("states 900 samples, but 202 rows follow" in note for note in record.notes())
    (tmp_path / "a.txt").write_text("203 0.01\n" + "\n".join(f"{a!r}" for a in SHAKE.tolist()))
    with pytest.raises(rb.DataError, match=r"time step of 0\.01 s above its samples, not 0\.0125 s"):
        rb.Record.from_file(tmp_path / "a.txt", dt=STEP)


@pytest.mark.parametrize("head", ["NPTS= 203, DT= .0125 SEC\n", "dt=0.0125\nacc\n", "203 POINTS, DT: 1.25E-2 s\n"])
@pytest.mark.parametrize("width", [1, 5])
def test_a_time_step_in_the_text_above(tmp_path: Path, head: str, width: int) -> None:
    """A time step that the lines above samples state is used, with a note, and a `dt` that contradicts it is refused."""
    (tmp_path / "a.txt").write_text(by_rows(head, width))
    record = rb.Record.from_file(tmp_path / "a.txt", unit="m/s^2")
    np.testing.assert_allclose(record.times, TIMES, rtol=1e-12)
    np.testing.assert_allclose(record.values, SHAKE, rtol=1e-8, atol=1e-9)
    assert any("the time step of 0.0125 s is taken from the text" in note for note in record.notes())
    np.testing.assert_array_equal(rb.Record.from_file(tmp_path / "a.txt", unit="m/s^2", dt=STEP).values, record.values)
    with pytest.raises(rb.DataError, match=r'0\.0125 s above its samples, not 0\.01 s\n  try: dt = "0\.0125 s"'):
        rb.Record.from_file(tmp_path / "a.txt", unit="m/s^2", dt="10 ms")


def test_a_column_of_times_is_not_advised_as_values(tmp_path: Path) -> None:
    """The advice for a table with times and a time step is to leave one of them out, and following it is right."""
    channels = np.column_stack([TIMES, SHAKE, 2 * SHAKE])
    np.savetxt(tmp_path / "a.txt", channels)
    np.save(tmp_path / "a.npy", channels)
    for name in ("a.txt", "a.npy"):
        with pytest.raises(
            rb.DataError, match=r"try: dt left out, since the first column increases .* columns = \[2\]"
        ):
            rb.Record.from_file(tmp_path / name, dt=STEP, unit="m/s^2")
        with pytest.raises(rb.DataError, match=r"try: columns = \[1, 2\]"):
            rb.Record.from_file(tmp_path / name, unit="m/s^2")
        np.testing.assert_allclose(rb.Record.from_file(tmp_path / name, columns=[1, 2], unit="m/s^2").values, SHAKE)
    first = rb.Record.from_file(tmp_path / "a.txt", dt=STEP, columns=[1], unit="m/s^2")
    assert any("increases as times do, and is read as values" in note for note in first.notes())


@pytest.mark.parametrize(
    "head", ["VELOCITY TIME SERIES IN UNITS OF CM/S", "UNITS OF CM/SEC", "unit: in/s", "units: mm/s"]
)
def test_velocities_are_refused(tmp_path: Path, head: str) -> None:
    """A record of velocities, in capitals too, is refused."""
    (tmp_path / "a.txt").write_text(by_rows(f"A\nB C\n{head}\n", 5))
    with pytest.raises(rb.DataError, match="is not a unit of force or acceleration or length"):
        rb.Record.from_file(tmp_path / "a.txt", dt=STEP)


@pytest.mark.parametrize("first", ["203.5 0.0125", "3 0.7", "-203 0.0125", "0 0.1"])
def test_other_first_lines_are_data(tmp_path: Path, first: str) -> None:
    """A first line that is not a number of samples is read as the first row."""
    (tmp_path / "a.txt").write_text(f"{first}\n400 1.0\n500 2.0\n600 3.5\n")
    record = rb.Record.from_file(tmp_path / "a.txt", unit="N")
    assert len(record.times) == 4


@pytest.mark.parametrize("width", [2, 3, 5, 6, 8])
@pytest.mark.parametrize("count", [203, 200, 240, 41])
@pytest.mark.parametrize("head", ["", "MOTION OF A TABLE\n", "one two three four five six seven eight\n"])
def test_samples_row_by_row_are_never_thinned(tmp_path: Path, width: int, count: int, head: str) -> None:
    """Samples that continue from row to row are read completely, or refused with advice that reads them completely.

    The tables of tests had a column for each quantity, and the advice of no message was followed.
    """
    times = STEP * np.arange(count)
    values = np.sin(31.0 * times) + 0.3 * np.sin(77.0 * times + 1)
    (tmp_path / "a.dat").write_text(by_rows(head, width, 1.0, values))
    np.save(tmp_path / "a.npy", values[: count // width * width].reshape(-1, width))
    for name, options in itertools.product(
        ("a.dat", "a.npy"), ({"dt": STEP}, {"dt": STEP, "columns": (1,)}, {"dt": STEP, "columns": (2,)}, {})
    ):
        whole = values if name == "a.dat" else values[: count // width * width]
        message = ""
        try:
            record = rb.Record.from_file(tmp_path / name, unit="m/s^2", **options)
        except rb.RattleboxError as error:
            message = str(error)
            record = rb.Record.from_file(tmp_path / name, unit="m/s^2", dt=STEP, columns="rows")
        assert "columns = [" not in message.replace('columns = ["', "") and (not message or '"rows"' in message), (
            message
        )
        np.testing.assert_allclose(record.values, whole, rtol=1e-8, atol=1e-9)


def test_columns_of_several_signals_are_not_rows(tmp_path: Path) -> None:
    """Channels side by side are columns, with or without names and with noise, and one is read where it is named."""
    random = np.random.default_rng(5)
    for count, noise in itertools.product((3, 6), (0.0, 0.05, 3.0)):
        phase = np.arange(count)
        channels = np.sin(40 * TIMES[:, None] + 0.4 * phase) * (1 + phase) + noise * random.standard_normal(
            (203, count)
        )
        np.savetxt(tmp_path / "a.txt", channels)
        record = rb.Record.from_file(tmp_path / "a.txt", dt=STEP, columns=(2,), unit="m/s^2")
        np.testing.assert_allclose(record.values, channels[:, 1], rtol=1e-12)
        assert any("column 2 of" in note for note in record.notes())
        with pytest.raises(rb.DataError, match="one is needed"):
            rb.Record.from_file(tmp_path / "a.txt", dt=STEP, unit="m/s^2")
        names = ",".join(f"c{k}" for k in range(count))
        np.savetxt(tmp_path / "a.csv", channels, delimiter=",", header=names, comments="")
        record = rb.Record.from_file(tmp_path / "a.csv", dt=STEP, columns=("c1",), unit="m/s^2")
        np.testing.assert_allclose(record.values, channels[:, 1], rtol=1e-12)


def test_a_step_that_contradicts_the_first_column_is_noted(tmp_path: Path) -> None:
    """A column of times with another step than `dt` gives a note."""
    (tmp_path / "a.txt").write_text(table("", 1.0))
    record = rb.Record.from_file(tmp_path / "a.txt", dt="0.02 s", columns=(2,), unit="m/s^2")
    assert any("dt is 0.02 s, but the first column rises evenly by 0.0125" in note for note in record.notes())


@pytest.mark.parametrize("start", [-0.5, 0.0125, 9.4])
def test_a_record_that_does_not_begin_at_zero(tmp_path: Path, start: float) -> None:
    """Points before 0 s are left out with a note, a later start is refused with advice, and `time_zero` controls both."""
    np.savetxt(tmp_path / "a.txt", np.column_stack([TIMES + start, SHAKE]), fmt="%.16e")
    first = rb.Record.from_file(tmp_path / "a.txt", unit="m/s^2", time_zero="first")
    np.testing.assert_allclose(first.evaluate(TIMES), SHAKE, rtol=1e-9, atol=1e-9)
    assert any("is shifted" in note for note in first.notes())
    again = rb.Case.from_toml(case(first).to_toml())
    assert again == case(first) and again.replaced({"base.scale": 1.0}) == case(first)
    later = rb.Record.from_file(tmp_path / "a.txt", unit="m/s^2", time_zero=f"{start + 1} s")
    np.testing.assert_allclose(later.evaluate([0.1]), np.interp(1.1, TIMES, SHAKE), rtol=1e-9)
    assert any("80 points before" in note for note in later.notes())
    as_it_is = rb.Record.from_file(tmp_path / "a.txt", unit="m/s^2")
    if start > 0:
        with pytest.raises(rb.CaseError, match='try: time_zero = "first"'):
            case(as_it_is)
    else:
        peak = np.abs(SHAKE[:40]).max()
        (note,) = [note for note in as_it_is.notes() if "40 points before 0 s" in note]
        assert f"with a peak of {peak:.4g} m/s^2" in note


def test_the_begin_of_a_record_is_an_axis(tmp_path: Path) -> None:
    """A study may vary the time of the record at which the run begins, in its unit."""
    written(tmp_path)
    base = case(rb.Record.from_file(tmp_path / "gal.csv")).replaced({"duration": "1 s"})
    peaks = rb.sweep(base, {"base.time_zero": ["0 s", "500 ms", "1 s"]}, ["peak"], progress=False)
    assert peaks["base.time_zero"].attrs["units"] == "s"
    later = base.replaced({"base.time_zero": "500 ms"})
    np.testing.assert_allclose(later.base[0].evaluate([0.1]), np.interp(0.6, TIMES, SHAKE), rtol=1e-9)
    alone = float(np.abs(rb.simulate(later, progress=False).motion.displacement).max())
    assert peaks.peak.values[1] == pytest.approx(alone, rel=5e-3)


def test_a_universal_file_is_shifted_with_a_note() -> None:
    """The time history of a universal file begins with its first point; a run notes it if that is not at 0 s."""
    folder = Path(__file__).parents[2] / "data/uff"
    record = rb.Record.from_file(folder / "time_history_58.uff")
    times, _ = record.polyline()
    assert times[0] == 0
    assert any("is shifted" in note for note in record.notes()) == (record.times[0] != 0)


def test_advice_for_displacements_is_right() -> None:
    """The advised acceleration of a harmonic displacement, and of a record, gives the motion that was meant."""
    harmonic = rb.Harmonic(amplitude="1.3 mm", frequency="7.3 Hz", phase=0.4)
    with pytest.raises(rb.CaseError, match=r"the base needs an acceleration .*\n  try: amplitude = \"(.*?)\"") as error:
        case(harmonic)  # type: ignore[arg-type]
    advised = str(error.value).split('amplitude = "')[1].split('"')[0]
    followed = rb.Harmonic(amplitude=advised, frequency="7.3 Hz", phase=0.4)
    twice = np.gradient(np.gradient(harmonic.evaluate(1e-4 * np.arange(2000)), 1e-4), 1e-4)
    np.testing.assert_allclose(followed.evaluate(1e-4 * np.arange(2000))[5:-5], twice[5:-5], rtol=1e-3, atol=1e-3)
    for given in ({"amplitude": "1.3 mm", "frequency": "7.3 Hz", "phase": 0.4, "kind": "harmonic"},):
        with pytest.raises(rb.CaseError, match=re.escape(f'amplitude = "{advised}"')):
            case(given)  # type: ignore[arg-type]
    t = 1e-3 * np.arange(2000)
    x = 2e-3 * np.sin(12 * t)
    with pytest.raises(rb.CaseError, match=r"CubicSpline\(t, x\)\(t, 2\)"):
        case(rb.Record(times=t, values=x, unit="m"))
    record = rb.Record(times=t, values=scipy.interpolate.CubicSpline(t, x)(t, 2), unit="m/s^2")
    np.testing.assert_allclose(record.values[10:-10], (-144 * x)[10:-10], atol=1e-5)


def test_a_ton_is_refused() -> None:
    """A ton differs between countries and is refused; the advised units are read with their exact masses."""
    for text in ("20 ton", "20 tons", "2 Ton", "2 kton"):
        with pytest.raises(rb.CaseError, match=r'"\d+ t" or "\d+ short_ton" or "\d+ long_ton"') as error:
            rb.SDOF(mass=text, stiffness=1)
        advised = str(error.value).split('try: "')[1].split('"')[0]
        assert rb.SDOF(mass=advised, stiffness=1).mass == {"20": 2e4, "2 T": 2e3, "2 k": 2e6}[text[:3].rstrip()]
    assert rb.SDOF(mass="20 short_ton", stiffness=1).mass == pytest.approx(18143.69, rel=1e-6)
    assert rb.SDOF(mass="20 t", stiffness=1).mass == 20000


@pytest.mark.parametrize("text", ["2 m", "200 cm", 2])
def test_no_warning_supposes_a_missing_unit(text: Any) -> None:
    """A warning about a large gap does not state that its unit is missing, since it may have been given."""
    damper = rb.ImpactDamper(gap=text, ball=rb.Sphere(diameter="1.43 m", mass="12 t", material="steel"),
                             contact=rb.Tsuji(restitution=0.6))  # fmt: skip
    building = rb.SDOF(mass="1000 t", frequency="1 Hz", damping_ratio=0.01, displacement="1 mm")
    notes = plausibility_notes(rb.Case(structure=building, damper=damper, duration="1 s"))
    assert any("the gap of damper is 2 m" in note for note in notes) and any("1.43 m wide" in note for note in notes)
    assert not any("without a unit" in note for note in notes)


def test_free_lines() -> None:
    """Lines state a unit, mention one, or have none; the first line with each unit is kept."""
    found, mentioned = units_in_lines([(1, "Units: g"), (2, "in g"), (3, "peak 3 m/s^2")], ("m/s^2",))
    assert [(each.number, each.factor) for each in found] == [(1, G)] and [each.number for each in mentioned] == [3]
    assert unit_above(["acc g"], ("m/s^2",)) == (G, "m/s^2")
    assert unit_above(["force N"], ("N",)) is None  # may be north


NUMBERED = "{}\n" + "".join(
    f"{k},{0.004 * k:g},{v:g}\n" for k, v in enumerate([0.0, 1.5, -2.25, 0.5, 0.75, -0.25, 1.0])
)


def test_times_by_their_name(tmp_path: Path) -> None:
    """Beside numbers of rows the column called time has the times: the first column of each table in tests was time."""
    path = tmp_path / "a.csv"
    for head in ("n,time (ms),acc (g)", "No.,t [ms],acc (g)", "sample,Zeit ms,acc (g)"):
        path.write_text(NUMBERED.format(head))
        for columns in ("acc (g)", (3,)):
            record = rb.Record.from_file(path, columns=columns)
            np.testing.assert_allclose(record.times, 4e-6 * np.arange(7), rtol=1e-12)
        content = rb.inspect(path)
        assert len(content.lines) == 1 and content.lines[0].startswith("acc (g): 7 samples every 4e-06 s")
    path.write_text("acc (g),time (s)\n0.5,0\n0.75,0.02\n1.5,0.04\n")
    np.testing.assert_allclose(rb.Record.from_file(path).times, [0.0, 0.02, 0.04])


@pytest.mark.parametrize("name", ["n", "No", "Sample", "index", "#", "", "Point", "Messpunkt"])
def test_numbers_of_rows_are_no_times(tmp_path: Path, name: str) -> None:
    """A first column that counts the rows was read as seconds; the advised step is used instead."""
    path = tmp_path / "a.csv"
    path.write_text(f"{name},acc (g)\n0,0.5\n1,1.5\n2,-0.75\n3,1\n")
    for options in ({}, {"columns": "acc (g)"}):
        with pytest.raises(rb.DataError, match=r"counts the rows(.|\n)*dt = "):
            rb.Record.from_file(path, **options)
    record = rb.Record.from_file(path, columns="acc (g)", dt="0.01 s")
    np.testing.assert_allclose(record.times, [0.0, 0.01, 0.02, 0.03])
    assert rb.inspect(path).lines[0].startswith("acc (g)")


def test_units_in_names_of_variables(tmp_path: Path) -> None:
    """Names of variables may end with a unit, as those of columns; no variable in tests did, and ms were read as s."""
    times = np.array([0.0, 2.5, 5.0, 7.5])
    np.savez(tmp_path / "a.npz", time_ms=times, acc_mg=[0.0, 40.0, -80.0, 20.0], mark=np.arange(4))
    record = rb.Record.from_file(tmp_path / "a.npz", columns="acc_mg")
    np.testing.assert_allclose(record.times, times / 1000, rtol=1e-15)
    assert record.peak == pytest.approx(0.08 * 9.80665, rel=1e-12)
    both = rb.Record.from_file(tmp_path / "a.npz", columns=("time_ms", "acc_mg"))
    np.testing.assert_array_equal(both.times, record.times)


def test_columns_below_even_times_are_no_rows_of_samples(tmp_path: Path) -> None:
    """Three columns of large values below small times were taken for one signal, since no test had few of them."""
    times, values = 0.004 * np.arange(8), np.array([0.0, 1.5, -3.25, 2.0, 0.5, -0.25, 0.125, 2.5])
    np.savetxt(tmp_path / "a.txt", np.column_stack((times, values, 2 * values)), fmt="%.5f")
    record = rb.Record.from_file(tmp_path / "a.txt", columns=(1, 3), unit="g")
    np.testing.assert_allclose(record.times, times)


def test_first_rows_with_exponents_of_three_digits(tmp_path: Path) -> None:
    """A first row such as 1.5-101, which Fortran writes, was left out as a heading: tests had such cells in no first row."""
    (tmp_path / "a.txt").write_text("0.1234-101 1\n0.1 2\n0.2 1\n0.3 0\n")
    with pytest.raises(rb.DataError, match=r"line 1: '0\.1234-101' is not a number"):
        rb.Record.from_file(tmp_path / "a.txt", unit="g")


def test_a_file_in_place_of_numbers(tmp_path: Path) -> None:
    """A file as another value excludes the numbers of the case and their unit; axes in tests replaced files by files."""
    (tmp_path / "level.csv").write_text("f (Hz),S (g^2/Hz)\n12,0.02\n70,0.02\n")
    (tmp_path / "a.csv").write_text("t (s),a (g)\n0,0\n0.5,1.5\n1.5,0\n")
    structure = rb.SDOF(mass="2 kg", frequency="6 Hz", damping_ratio=0.02)
    psd = [("15 Hz", "0.3 (m/s^2)^2/Hz"), ("60 Hz", "0.3 (m/s^2)^2/Hz")]
    for given, file, peak in [
        (rb.Random([(15, 0.3), (60, 0.3)], "1 s", unit="m/s^2"), "level.csv", None),
        (rb.Random(psd, "1 s"), "level.csv", None),
        (rb.Random("gevs_acceptance", "1 s"), "level.csv", None),
        (rb.Record(times=[0, 1], values=[0, 3], unit="gal"), "a.csv", 1.5 * 9.80665),
        (rb.Record(values=[0, 3, 1], dt="0.5 s"), "a.csv", 1.5 * 9.80665),
    ]:
        base = rb.Case(structure=structure, base=given, duration="0.8 s")
        case = base.replaced({"base.file": str(tmp_path / file)})
        signal: Any = case.base[0]
        assert signal.unit == "m/s^2"
        if peak is None:
            assert signal.rms == pytest.approx(9.80665 * (0.02 * 58) ** 0.5, rel=1e-12)
        else:
            assert signal.peak == pytest.approx(peak, rel=1e-12)
        assert rb.Case.from_toml(case.to_toml()) == case and "gal" not in case.to_toml()


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
@pytest.mark.parametrize(
    ("heading", "row", "options", "unit", "step"),
    [
        (["time (ms)", "acc (g)", "force (N)"], "{t},{y},", {}, "g", 0.005),
        (["no", "time (ms)", "acc (cm/s^2)"], ",{t},{y}", {}, "cm/s^2", 0.005),
        (["no", "time (ms)", "acc (mg)", "force (N)"], ",{t},{y},", {}, "mg", 0.005),
        (["time (ms)", "acc (g)", "a", "b"], "{t},{y},,", {"columns": "acc (g)"}, "g", 0.005),
        (["acc (g)", "remark (mm)"], "{y},", {"dt": "2 ms"}, "g", 0.002),
    ],
)
def test_headings_above_empty_columns_are_left_out(
    delimiter: str, heading: Any, row: str, options: Any, unit: str, step: float, tmp_path: Path
) -> None:
    """Headings stay above their columns if a column at the edge is empty; only full columns, or cells, were tested."""
    lines = [",".join(heading), *(row.format(t=5 * k, y=0.25 * (k % 3)) for k in range(40))]
    (tmp_path / "log.csv").write_text("\n".join(lines).replace(",", delimiter) + "\n")
    record = rb.Record.from_file(tmp_path / "log.csv", **options)
    factor = {"g": 9.80665, "mg": 9.80665e-3, "cm/s^2": 0.01}[unit]
    assert max(record.values) == pytest.approx(0.5 * factor, rel=1e-12)
    assert record.times[1] == pytest.approx(step, rel=1e-12)
    assert not list(record.notes())


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
@pytest.mark.parametrize("options", [{}, {"dt": "2 ms"}])
def test_times_without_values_are_refused(delimiter: str, options: Any, tmp_path: Path) -> None:
    """Times next to an empty column are refused, also with a step; both headings were joined into one unit."""
    lines = ["time (s),acc (g)", *(f"{0.01 * k:.2f}," for k in range(40))]
    (tmp_path / "log.csv").write_text("\n".join(lines).replace(",", delimiter) + "\n")
    with pytest.raises(rb.DataError, match=r"column of values|'s', written above"):
        rb.Record.from_file(tmp_path / "log.csv", **options)


@pytest.mark.parametrize("columns", [[["a"], 2], [(1, 2), 3], [1, {"a": 2}], {"a": 1}, [1.5, 2]])
def test_columns_of_other_types(columns: object, tmp_path: Path) -> None:
    """Lists in a list are no columns and are refused like other types; the message was one of NumPy without a place."""
    (tmp_path / "push.csv").write_text("time (s),force (N)\n0,0\n0.1,3\n0.2,1\n")
    with pytest.raises(
        rb.CaseError, match=r"^Record: columns.*\n  two numbers or names are needed.*\n  try: columns = "
    ):
        rb.Record.from_file(tmp_path / "push.csv", columns=columns)
