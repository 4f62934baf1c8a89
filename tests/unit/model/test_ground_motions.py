"""Earthquake records: AT2 files, one column with a time step, two columns, in the units that engineers use."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.model.plausibility import plausibility_notes

G = 9.80665
SAMPLES = 0.3 * np.sin(np.arange(23) * 0.7)
HEAD = "PEER NGA STRONG MOTION DATABASE RECORD\nIMPERIAL VALLEY 5/19/40 0439, EL CENTRO ARRAY #9, 180\n"
NEW = "ACCELERATION TIME SERIES IN UNITS OF G\nNPTS=  23, DT= .0100 SEC\n"
OLD = "ACCELERATION TIME HISTORY IN UNITS OF G\n   23    0.0100    NPTS, DT\n"


def rows(values: Any = SAMPLES) -> str:
    """Five samples a row, as in the data base."""
    return "".join("".join(f"{v:15.7E}" for v in values[k : k + 5]) + "\n" for k in range(0, len(values), 5))


@pytest.mark.parametrize("head", [NEW, OLD, NEW.replace("SEC", ""), NEW.replace(" OF G", " OF g")])
def test_at2_files(tmp_path: Path, head: str) -> None:
    """Time step, number and unit come from the header, old or new."""
    (tmp_path / "quake.AT2").write_text(HEAD + head + rows())
    record = rb.Record.from_file(tmp_path / "quake.AT2")
    assert record.unit == "m/s^2" and not record.unit_is_assumed
    np.testing.assert_allclose(record.times, np.arange(23) * 0.01, atol=1e-15)
    np.testing.assert_allclose(record.evaluate(record.times), SAMPLES * G, rtol=1e-6, atol=1e-7)
    case = rb.Case(structure=rb.SDOF(mass=1.0, frequency=2.0), base=record, duration=0.2)
    assert rb.Case.from_toml(case.to_toml()) == case
    assert rb.simulate(case).ok


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "none of the first 0 lines states NPTS and DT"),
        (HEAD, "none of the first 2 lines states NPTS and DT"),
        (HEAD + NEW + rows(SAMPLES[:-6]), "23 samples, .* 17\n  try: the complete file"),
        (HEAD + NEW + rows(np.append(SAMPLES, 1.0)), "23 samples, .* 24"),
        (HEAD + NEW + rows()[:-4] + "E\n", r"line 9: .* is not a row of numbers"),
        (HEAD + NEW.replace("ACCEL", "VEL").replace("VELERATION", "VELOCITY").replace(" G", " CM/S") + rows(), "velocity"),
        (HEAD + NEW.replace(" IN UNITS OF G", "") + rows(), "states no unit\n  try: unit = \"g\""),
        (HEAD + NEW.replace("OF G", "OF FURLONG") + rows(), "'FURLONG'.*is not a unit"),
        (HEAD + NEW.replace(".0100", ".0000") + rows(), "time step is .0000"),
        (HEAD + NEW + rows(np.where(np.arange(23) == 4, np.nan, SAMPLES)), "sample 5 is not finite"),
    ],
)  # fmt: skip
def test_damaged_at2_files(tmp_path: Path, content: str, message: str) -> None:
    """Empty, cut, unit-less and foreign files are refused with the reason and what to try."""
    (tmp_path / "quake.at2").write_text(content)
    with pytest.raises(rb.RattleboxError, match=message):
        rb.Record.from_file(tmp_path / "quake.at2")


@pytest.mark.parametrize(
    ("unit", "factor"),
    [
        ("g", G),
        ("gal", 0.01),
        ("Gal", 0.01),
        ("mg", 1e-3 * G),
        ("cm/s^2", 0.01),
        ("m/s^2", 1.0),
        ("g_0", G),
        ("ft/s^2", 0.3048),
    ],
)
def test_units_of_one_column(tmp_path: Path, unit: str, factor: float) -> None:
    """One column with `dt`: the unit is the one given, or the one above the column."""
    np.savetxt(tmp_path / "bare.txt", SAMPLES)
    np.savetxt(tmp_path / "named.csv", SAMPLES, header=f"acceleration ({unit})", comments="")
    given = rb.Record(file=str(tmp_path / "bare.txt"), dt="10 ms", unit=unit)
    named = rb.Record(file=str(tmp_path / "named.csv"), dt="10 ms")
    for record in (given, named):
        assert record.unit == "m/s^2" and not record.unit_is_assumed
        np.testing.assert_allclose(record.times, np.arange(23) * 0.01, atol=1e-15)
        np.testing.assert_allclose(record.evaluate(record.times), SAMPLES * factor, rtol=1e-12, atol=1e-12)
    case = rb.Case(structure=rb.SDOF(mass=1.0, frequency=2.0), base=given, duration=0.2)
    again = rb.Case.from_toml(case.to_toml())
    np.testing.assert_allclose(again.base[0].evaluate([0.03]), SAMPLES[3] * factor, rtol=1e-12)
    values = rb.Record(values=SAMPLES, dt=0.01, unit=unit)
    np.testing.assert_allclose(values.evaluate(values.times), SAMPLES * factor, rtol=1e-12, atol=1e-12)


def test_two_columns_in_a_given_unit(tmp_path: Path) -> None:
    """Two columns without a header are in the unit that is given."""
    np.savetxt(tmp_path / "two.txt", np.column_stack([np.arange(23) * 0.02, SAMPLES]))
    record = rb.Record(file=str(tmp_path / "two.txt"), unit="gal")
    np.testing.assert_allclose(record.evaluate([0.08]), SAMPLES[4] * 0.01, rtol=1e-12)


@pytest.mark.parametrize("ending", ["npy", "npz", "csv"])
def test_one_column_of_several(tmp_path: Path, ending: str) -> None:
    """With `dt`, `columns` names the one column of values."""
    table = np.column_stack([SAMPLES, 2 * SAMPLES])
    file = tmp_path / f"table.{ending}"
    if ending == "npy":
        np.save(file, table)
    elif ending == "npz":
        np.savez(file, north=SAMPLES, east=2 * SAMPLES)
    else:
        np.savetxt(file, table, delimiter=",", header="north,east", comments="")
    record = rb.Record(file=str(file), dt=0.01, columns=[2], unit="g")
    np.testing.assert_allclose(record.evaluate([0.03]), 2 * SAMPLES[3] * G, rtol=1e-12)
    with pytest.raises(rb.RattleboxError, match="one is needed\n  try: columns"):
        rb.Record(file=str(file), dt=0.01)


def test_an_assumed_unit_gives_a_note_with_the_peak(tmp_path: Path) -> None:
    """A base motion without unit is read in m/s^2, with a note that gives the peak."""
    np.savetxt(tmp_path / "bare.txt", SAMPLES)
    record = rb.Record(file=str(tmp_path / "bare.txt"), dt=0.01)
    case = rb.Case(structure=rb.SDOF(mass=1.0, frequency=2.0), base=record, duration=0.2)
    (result,) = [note for note in plausibility_notes(case) if "states no unit" in note]
    assert f"{np.abs(SAMPLES).max():.4g} m/s^2" in result


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"dt": 0}, "must be greater than zero"),
        ({"dt": "1 m"}, "a time"),
        ({"dt": 0.01, "columns": [1, 2]}, r"columns = \[1, 2\]\n"),
        ({}, 'two are needed\n  try: dt = "0.01 s"'),
    ],
)
def test_bad_records_of_one_column(tmp_path: Path, options: dict[str, Any], message: str) -> None:
    """Wrong steps and columns are refused, and the message for a missing step proposes one."""
    np.savetxt(tmp_path / "bare.txt", SAMPLES)
    with pytest.raises(rb.RattleboxError, match=message):
        rb.Record(file=str(tmp_path / "bare.txt"), **options)
    with pytest.raises(rb.RattleboxError, match="times or dt, not both"):
        rb.Record(values=[1.0, 2.0], times=[0.0, 1.0], dt=0.1)


def test_time_step_in_milliseconds(tmp_path: Path) -> None:
    """A header may state the time step in milliseconds, which was read as seconds: no header of a test had another unit."""
    (tmp_path / "quake.AT2").write_text(HEAD + NEW.replace(".0100 SEC", "12.5 MSEC") + rows())
    np.testing.assert_allclose(rb.Record.from_file(tmp_path / "quake.AT2").times, np.arange(23) * 0.0125, rtol=1e-12)
