"""Strong-motion files of the networks: PEER, K-NET, SMC, COSMOS and CSMIP, ESM, CSMNC. Only PEER accelerations had tests."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest
from support.mutants import mutant

import rattlebox as rb

SAMPLES = 3.0 * np.sin(0.9 * np.arange(37)) + 0.02 * np.arange(37)
COUNTS = np.round(2000 * np.sin(0.4 * np.arange(37))).astype(int) - 3100


def rows(cells: list[str], count: int) -> str:
    """Return cells, so many in a row."""
    return "".join("".join(cells[k : k + count]) + "\n" for k in range(0, len(cells), count))


def short(value: float) -> str:
    """Return a number as 1pE10.4E1 writes it: ten columns, an exponent of one digit."""
    mantissa, exponent = f"{value:.4e}".split("e")
    return f"{mantissa}E{int(exponent)}".rjust(10)


KNET = """Origin Time       2003/09/26 04:50:00
Lat.              41.78
Long.             144.08
Depth. (km)       42
Mag.              8.0
Station Code      HKD100
Station Lat.      42.1303
Station Long.     142.9336
Station Height(m) 25
Record Time       2003/09/26 04:50:40
Sampling Freq(Hz) 200Hz
Duration Time(s)  0.185
Dir.              N-S
Scale Factor      3920(gal)/6182761
Max. Acc. (gal)   2.1
Last Correction   2003/09/26 04:50:00
Memo.
""" + rows([f"{count:9d}" for count in COUNTS], 8)  # fmt: skip

_INTEGERS = [-32768] * 48
_INTEGERS[15], _INTEGERS[16] = 2, 37
_REALS = [1.7e38] * 50
_REALS[1] = 50.0
SMC = (
    "2 CORRECTED ACCELEROGRAM\n" + "*\n" * 10
    + rows([f"{value:10d}" for value in _INTEGERS], 8)
    + rows([f"{value:15.7E}" for value in _REALS], 5)
    + "|\n| a comment with 12.5\n"
    + rows([short(value) for value in SAMPLES], 8)
)  # fmt: skip

_COSMOS_REALS = [-999.0] * 100
_COSMOS_REALS[61] = 5.0
COSMOS = (
    "Corrected acceleration   (Format v01.20 with 13 text lines)\nA title with 25 pts\n"
    " 100 Real-header values follow on  17 lines, Format= (6F13.6)\n"
    + rows([f"{value:13.6f}" for value in _COSMOS_REALS], 6)
    + "   1 Comment line(s) follow, each starting with a \"|\":\n| none\n"
    + "      37  acceleration pts, approx    0 secs, units= cm/sec2(04), Format=(8F10.5)\n"
    + rows([f"{value:10.5f}" for value in SAMPLES], 8)
    + "End-of-data for Chan  1 acceleration\n"
)  # fmt: skip

CSMIP = "".join(
    f"      37 points of {kind} data equally spaced at  .020 sec, in {unit}. (8f10.5)\n"
    + rows([f"{factor * value:10.5f}" for value in SAMPLES], 8)
    for kind, unit, factor in (("accel", "cm/sec2", 100.0), ("veloc", "cm/sec", 2.0), ("displ", "cm", 0.5))
)
CSMIP = "CORRECTED ACCELEROGRAM  CHAN 1\nA TITLE\n" + CSMIP + "/&  ----------  End of data for channel  1  ----------\n"

ESM = """EVENT_NAME: A TEST
EVENT_DATE_YYYYMMDD: 20090406
DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS: 20090406_013232.000
SAMPLING_INTERVAL_S: 0.005000
NDATA: 37
DURATION_S: 0.185
STREAM: HNE
UNITS: cm/s^2
DATA_TYPE: ACCELERATION
USER1:
""" + rows([f"{value:.6f}" for value in SAMPLES], 1)  # fmt: skip

CSMNC = """051ABC080512142801
A TEST EARTHQUAKE
MAGNITUDE  5.0(Ms)
COMP. NS
CORRECTED ACCELERATION          UNIT: CM/SEC/SEC
NO. OF POINTS:  37  EQUALLY SPACED INTERVALS OF:  0.005  SEC
PEAK VALUE:    3.7   AT   0.1 SEC    DURATION:  0.185 SEC
PRE-EVENT TIME:  20  SEC
CSMNC

""" + rows([f"{value:13.6E}" for value in SAMPLES], 8)  # fmt: skip

AT2 = "PEER\nA TEST\n{} TIME SERIES IN UNITS OF {}\nNPTS=   37, DT=   .0100 SEC\n" + rows(
    [f"{value:15.7E}" for value in SAMPLES], 5
)

FILES = {
    "HKD100.NS2": (KNET, 0.01 * 3920 / 6182761 * COUNTS, 0.005),
    "knet.txt": (KNET, 0.01 * 3920 / 6182761 * COUNTS, 0.005),
    "a.smc": (SMC, 0.01 * SAMPLES, 0.02),
    "a.v2c": (COSMOS, 0.01 * SAMPLES, 0.005),
    "a.V2": (CSMIP, SAMPLES, 0.02),
    "a.ASC": (ESM, 0.01 * SAMPLES, 0.005),
    "a.dat": (CSMNC, 0.01 * SAMPLES, 0.005),
    "a.AT2": (AT2.format("ACCELERATION", "G"), 9.80665 * SAMPLES, 0.01),
    "a.DT2": (AT2.format("DISPLACEMENT", "CM"), 0.01 * SAMPLES, 0.01),
}


def write(folder: Path, name: str, content: str) -> Path:
    """Write a file and return its path."""
    path = folder / name
    path.write_bytes(content.encode("latin-1"))
    return path


@pytest.mark.parametrize("name", FILES)
def test_right_values(tmp_path: Path, name: str) -> None:
    """Samples, step and unit come from the file alone, in SI units."""
    content, values, step = FILES[name]
    record = rb.Record.from_file(write(tmp_path, name, content))
    assert record.unit == ("m" if name == "a.DT2" else "m/s^2") and not record.unit_is_assumed
    np.testing.assert_allclose(record.values, values, rtol=1e-4, atol=2e-5 * np.abs(values).max())
    np.testing.assert_allclose(record.times, step * np.arange(37), rtol=1e-12)
    case = (
        rb.Case(structure=rb.SDOF(mass=1.0, frequency=2.0), base=record, duration=0.1) if record.unit != "m" else None
    )
    assert case is None or rb.Case.from_toml(case.to_toml()) == case


def test_displacements_of_a_v2_file_are_chosen_by_name(tmp_path: Path) -> None:
    """A file with integrated motions is read as acceleration, unless a name selects another one."""
    path = write(tmp_path, "a.v2", CSMIP)
    record = rb.Record.from_file(path, columns=("displacement 1",))
    assert record.unit == "m"
    np.testing.assert_allclose(record.values, 0.005 * SAMPLES, atol=1e-7)
    with pytest.raises(rb.RattleboxError, match="cm/sec"):
        rb.Record.from_file(path, columns=("velocity 1",))


def test_numbers_without_blanks(tmp_path: Path) -> None:
    """Columns of a Fortran format may touch, which no file of words shows."""
    text = "A\n 4 points of accel data equally spaced at .02 sec, in cm/sec2. (2f10.6)\n"
    text += "123.456789-12.345678\n-99.999999100.000001\n"
    record = rb.Record.from_file(write(tmp_path, "a.v2", text))
    np.testing.assert_allclose(record.values, [1.23456789, -0.12345678, -0.99999999, 1.00000001], rtol=1e-12)
    with pytest.raises(rb.RattleboxError, match=r"line 3.*row of numbers"):
        rb.Record.from_file(write(tmp_path, "b.v2", text.replace("(2f10.6)", "").replace("-12.345678", "212.345678")))
    touching = AT2.format("ACCELERATION", "G").replace(" -", "-").replace("E+", "D+")
    np.testing.assert_allclose(
        rb.Record.from_file(write(tmp_path, "c.at2", touching)).values, 9.80665 * SAMPLES, rtol=1e-6, atol=1e-6
    )


def test_short_files_have_a_note(tmp_path: Path) -> None:
    """A file with fewer samples than its header states is not read without a word."""
    for name in ("HKD100.NS2", "a.smc", "a.ASC", "a.dat"):
        content = FILES[name][0].rsplit("\n", 3)[0] + "\n"
        content = content.replace("(s)  0.185", "(s)  30")
        assert any("states" in note for note in rb.Record.from_file(write(tmp_path, name, content)).notes()), name
    assert any("mean" in note for note in rb.Record.from_file(write(tmp_path, "a.ns", KNET)).notes())


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.vt2", AT2.format("VELOCITY", "CM/SEC"), "a.vt2 contains a velocity, not an acceleration"),
        ("a.vt2", AT2.format("A", "G"), "contains a velocity"),
        ("a.at2", AT2.format("DISPLACEMENT", "CM"), "contains a displacement by its header"),
        ("a.dt2", AT2.format("ACCELERATION", "G"), "contains an acceleration by its header"),
        ("a.ew", KNET.replace("3920(gal)", "3920(V)"), "scale factor .*V.*, not one such as"),
        ("a.ew", KNET.replace("200Hz", "0Hz"), "sampling frequency .* a positive number is needed"),
        ("a.ew", KNET.replace("Memo.", "End."), "begins with 'Memo.'"),
        ("a.ew", KNET.replace("-3100", "-31x0"), "line 18: .*-31x0.* a row of numbers is expected"),
        ("a.smc", SMC.replace("ACCELEROGRAM", "SPECTRA"), "line 1: .* 'ACCELEROGRAM', 'VELOCITY' or"),
        ("a.smc", SMC.replace("CORRECTED ACCELEROGRAM", "VELOCITY"), "cm/s"),
        ("a.smc", SMC.replace("| a comment with 12.5\n", ""), "2 lines of comment"),
        ("a.smc", SMC.replace("5.0000000E+01", "0.0000000E+00"), "sampling rate"),
        ("a.v2", COSMOS.replace("approx    0", "approx   90"), "37 samples of 0.005 s are 0.185 s, but 90 s are stated"),
        ("a.v2", COSMOS.replace("     5.000000", "  -999.000000"), "time step; a positive number"),
        ("a.v2", CSMIP.replace("37 points of accel", "47 points of accel"), "a.v2, line"),
        ("a.v2", "nothing\n", "no line states a number of points"),
        ("a.asc", ESM.replace("NDATA: 37", "NDATA: 30"), "states 30 samples, but contains 37"),
        ("a.asc", ESM.replace("UNITS: cm/s^2", "UNITS: cm/s"), "'cm/s'"),
        ("a.asc", ESM.replace("UNITS: cm/s^2\n", ""), "does not state UNITS"),
        ("a.dat", CSMNC.replace("UNIT: CM/SEC/SEC", ""), "unit of its samples in 0 lines"),
        ("a.dat", CSMNC.replace("  37  EQ", "  31  EQ"), "states 31 samples, but contains 37"),
        ("a.dat", CSMNC + "1.0 x\n", "line 16: .* a row of numbers is expected"),
    ],
)  # fmt: skip
def test_bad_files(tmp_path: Path, name: str, content: str, message: str) -> None:
    """Foreign quantities and damaged headers are refused with the place, what was found and what is needed."""
    with pytest.raises(rb.RattleboxError, match=message) as error:
        rb.Record.from_file(write(tmp_path, name, content))
    assert name in str(error.value) and "try: " in str(error.value)


@pytest.mark.parametrize("name", FILES)
def test_mutants(tmp_path: Path, name: str) -> None:
    """A damaged file is read to finite numbers or refused, in two seconds at most, never with another error."""
    content = FILES[name][0].encode()
    path = tmp_path / name
    for number in range(300):
        path.write_bytes(mutant(content, number))
        start = time.process_time()
        try:
            assert np.isfinite(rb.Record.from_file(path, unit=None).values).all()
        except rb.RattleboxError as error:
            message = str(error)
        else:
            message = "try: "
        assert "try: " in message and len(message) < 5000, f"mutant {number}"
        assert time.process_time() - start < 2, f"mutant {number}"


def test_a_velocity_is_no_length(tmp_path: Path) -> None:
    """A heading "a (cm/s)" is refused: no test had the name of a unit (a for year) before a unit in brackets."""
    path = write(tmp_path, "a.csv", "t (s),a (cm/s)\n0,0\n0.1,1\n0.2,0\n")
    with pytest.raises(rb.RattleboxError, match="'cm/s', written above the column"):
        rb.Record.from_file(path)


@pytest.mark.parametrize("name", ["a.dat", "a.smc", "a.V2", "a.ASC"])
def test_long_rows_of_digits(tmp_path: Path, name: str) -> None:
    """Thousands of digits before a letter are refused at once: 300 mutants had none, and the pattern took cubic time."""
    lines = FILES[name][0].splitlines()
    for text in ("9" * 100_000 + "x", "1" * 50_000 + "-" + "." * 50_000, "-1E" * 30_000):
        path = write(tmp_path, name, "\n".join([*lines[:-2], text, lines[-1]]))
        start = time.process_time()
        with pytest.raises(rb.RattleboxError, match="try: "):
            rb.Record.from_file(path)
        assert time.process_time() - start < 2


def test_samples_beyond_all_measurements_name_the_file(tmp_path: Path) -> None:
    """A sample of 1e38 is refused with the name of the file, which the message of the fields did not have."""
    path = write(tmp_path, "a.smc", SMC.replace(short(SAMPLES[1]), "   1.7E+38"))
    with pytest.raises(rb.RattleboxError, match=r"a\.smc.*1\.7e\+38"):
        rb.Record.from_file(path)


def test_a_time_step_that_nothing_confirms_is_noted(tmp_path: Path) -> None:
    """A V2 file that states its time step only among the numbers of its header is read with a note."""
    text = COSMOS.replace(" approx    0 secs,", "")
    for content, is_noted in ((COSMOS, False), (text, True)):
        notes = list(rb.Record.from_file(write(tmp_path, "a.v2", content)).notes())
        assert any("the time step of 0.005 s is real value 62 of its header" in note for note in notes) == is_noted
