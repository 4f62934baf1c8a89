"""Power spectral densities in files, which had to be copied by hand into break points."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest
from support.mutants import mutant
from support.set_58 import set58

import rattlebox as rb

G = 9.80665
LINES = "10, 0.002\n40, 0.05\n350, 0.05\n900, 0.004\n"
POINTS = [(10, 0.002), (40, 0.05), (350, 0.05), (900, 0.004)]


@pytest.mark.parametrize(
    ("head", "fields", "factor", "unit"),
    [
        ("frequency (Hz), PSD (g^2/Hz)\n", {}, G**2, "m/s^2"),
        ("Frequency [Hz], ASD [(m/s²)²/Hz]\n", {}, 1, "m/s^2"),
        ("f/Hz, S/(N^2/Hz)\n", {}, 1, "N"),
        ("Hz, G2/HZ\n", {}, G**2, "m/s^2"),
        ("frequency, density\nHz, kN^2/Hz\n", {}, 1e6, "N"),
        ("# Random level of the shelf, in Grms^2/Hz\n", {}, G**2, "m/s^2"),
        ("# qualification\n", {"unit": "g"}, G**2, "m/s^2"),
        ("", {"unit": "mm"}, 1e-6, "m"),
        ("f (Hz), PSD (V^2/Hz)\n", {"unit": "kN"}, 1e6, "N"),
        ("f (Hz), PSD (g^2/Hz)\n", {"unit": "g"}, G**2, "m/s^2"),
        ("f (Hz), PSD two-sided (N^2/Hz)\n", {}, 2, "N"),
        ("f (Hz), S (g^2/kHz)\n", {}, 1e-3 * G**2, "m/s^2"),
        ("f (Hz), S (mm^2/s^4/Hz)\n", {}, 1e-6, "m/s^2"),
    ],
)
def test_tables(tmp_path: Path, head: str, fields: dict, factor: float, unit: str) -> None:
    """A table of densities is the same vibration as its break points, with the unit above it or that of the user."""
    (tmp_path / "level.csv").write_text(head + LINES)
    random = rb.Random.from_file(tmp_path / "level.csv", "0.3 s", seed=4, **fields)
    same = rb.Random([(f, factor * S) for f, S in POINTS], "0.3 s", seed=4, unit=unit)
    assert random.unit == same.unit == unit
    np.testing.assert_allclose(random.corners, same.corners, rtol=1e-12)
    np.testing.assert_allclose(random.values, same.values, rtol=1e-9)
    assert any("RMS from 10 to 900 Hz" in note for note in random.notes())
    side = "two-sided" if "two" in head else "one-sided"
    assert any(side in note for note in random.notes())


def test_other_tables(tmp_path: Path) -> None:
    """Decimal commas, kHz, further columns by name, arrays, and as many rows as the first frequency says are read."""
    (tmp_path / "a.csv").write_text("f (kHz);x (g^2/Hz);y (g^2/Hz)\n0,01;0,1;0,2\n0,02;0,3;0,4\n")
    random = rb.Random.from_file(tmp_path / "a.csv", "1 s", columns="y (g^2/Hz)")
    np.testing.assert_allclose(random.corners, [(10, 0.2 * G**2), (20, 0.4 * G**2)])
    np.savez(tmp_path / "a.npz", f=np.array([5.0, 9.0, 30.0]), S=np.array([1.0, 2.0, 3.0]))
    random = rb.Random.from_file(tmp_path / "a.npz", "1 s", columns=("f", "S"), unit="N")
    np.testing.assert_allclose(random.corners, [(5, 1), (9, 2), (30, 3)])
    rows = "".join(f"{20 + 5 * k} 0.01\n" for k in range(21))
    (tmp_path / "b.txt").write_text(rows)
    assert rb.Random.from_file(tmp_path / "b.txt", "1 s", unit="g").corners.shape == (21, 2)


@pytest.mark.parametrize(
    ("content", "fields", "message"),
    [
        ("f (Hz), S\n" + LINES, {}, r"no unit of the density is stated\n.*unit = \"g\""),
        ("f (Hz), S (g)\n" + LINES, {}, "states the unit of m/s\\^2, not that of a density"),
        ("f (Hz), S (g/sqrt(Hz))\n" + LINES, {"unit": "g"}, "is the root of a density"),
        ("f (Hz), S (g^2/oct)\n" + LINES, {"unit": "g"}, "is no mean square per Hz"),
        ("f (Hz), S (g^2 s/Hz)\n" + LINES, {"unit": "g"}, "is no mean square per Hz"),
        *[
            (f"f (Hz), S ({unit})\n" + LINES, {}, "is no mean square per Hz")
            for unit in ("g^2/Hz*s", "g^2-s/Hz", "g^2/Hz s")
        ],
        ("f (Hz), S (dB)\n" + LINES, {}, "decibels of an unknown reference"),
        ("f (Hz), S (V^2/Hz)\n" + LINES, {}, r"V\^2/Hz.* is no unit of a density"),
        ("f (Hz), S (g^2/Hz)\n" + LINES, {"unit": "m/s^2"}, r"states another unit of the density.*\n.*unit left out"),
        ("omega (rad/s), S (g^2/Hz)\n" + LINES, {}, "angular frequency"),
        ("t (s), S (g^2/Hz)\n" + LINES, {}, "'s', written above the column"),
        ("f (Hz), peak hold (g^2/Hz)\n" + LINES, {}, "states a peak"),
        ("# g^2/Hz or (m/s^2)^2/Hz\n" + LINES, {}, "its lines state 2 units"),
        ("S (g^2/Hz), f (Hz)\n0.1, 20\n0.1, 40\n", {}, "'g\\^2/Hz', written above"),
        ("30, 1\n20, 2\n", {"unit": "g"}, r"frequencies must rise, but 20 follows 30"),
        ("-20, 1\n20, 2\n", {"unit": "g"}, r"negative frequencies, from -20 on: the density is two-sided"),
        ("10, -12.5\n20, 2\n", {"unit": "g"}, "the density -12.5 at 10 Hz is negative"),
        ("10, 1\n20, 0\n30, 1\n", {"unit": "g"}, "the density at 20 Hz, between others, is 0"),
        ("10, 0\n20, 0\n30, 1\n", {"unit": "g"}, "1 line with a density greater than zero"),
        ("10, 1, 2\n20, 1, 3\n", {"unit": "g"}, r"3 columns \(1, 2, 3\), two are needed\n.*columns = \[1, 2\]"),
        ("10, 1\n20, 1e400\n", {"unit": "g"}, "inf|finite|not a number"),
        ("nothing\n", {"unit": "g"}, "contains no numbers"),
        (LINES, {"unit": "Pa"}, "'Pa' is not a unit of force, acceleration or displacement"),
        (LINES, {"unit": "g", "columns": "rows"}, "no rows of samples"),
        (LINES, {"unit": "g", "psd": POINTS}, "give psd or file, not both"),
        (LINES, {"unit": "g", "columns": (1, 7)}, "no column 7"),
    ],
)
def test_bad_tables(tmp_path: Path, content: str, fields: dict, message: str) -> None:
    """What is no density of a known unit is refused with the reason and what to try."""
    (tmp_path / "level.csv").write_text(content)
    with pytest.raises(rb.RattleboxError, match=message) as error:
        rb.Random.from_file(tmp_path / "level.csv", "1 s", **fields)
    assert "try: " in str(error.value)


def test_universal_file(tmp_path: Path) -> None:
    """Functions of type 9 were refused; the density is that of the set, without its line at 0 Hz."""
    density = np.array([0.0, 0.01, 0.04, 0.04, 0.02, 0.0])
    path = tmp_path / "level.uff"
    path.write_text(set58(9, density, "(m/s^2)^2/Hz") + set58(9, 2 * density, "g²/Hz", name="Foot"), encoding="latin-1")
    with pytest.raises(rb.DataError, match=r"contains 2 densities \(Head, Foot\)"):
        rb.Random.from_file(path, "1 s")
    for columns, factor in ((1, 1), ("Head", 1), (2, 2 * G**2), ("Foot", 2 * G**2)):
        random = rb.Random.from_file(path, "1 s", columns=[columns] if isinstance(columns, int) else columns)
        np.testing.assert_allclose(random.corners, np.column_stack((5.0 * np.arange(1, 5), factor * density[1:5])))
    assert any("is 0 outside of 5 to 20 Hz" in note for note in random.notes())
    with pytest.raises(rb.DataError, match="contains no density 3, but Head, Foot"):
        rb.Random.from_file(path, "1 s", columns=[3])


@pytest.mark.parametrize(
    ("unit", "fields", "message"),
    [
        ("g", {}, "states the unit of m/s\\^2, not that of a density"),
        ("NONE", {}, "no unit of the density is stated"),
        ("Pa^2/Hz", {}, "no unit of a density"),
    ],
)
def test_units_of_universal_files(tmp_path: Path, unit: str, fields: dict, message: str) -> None:
    """A label that is no unit of a density needs that of the user."""
    path = tmp_path / "level.uff"
    path.write_text(set58(9, np.full(4, 0.02), unit))
    with pytest.raises(rb.RattleboxError, match=message):
        rb.Random.from_file(path, "1 s")
    assert rb.Random.from_file(path, "1 s", unit="g").corners[0, 1] == pytest.approx(0.02 * G**2)


KINDS = {
    0: "general function", 2: "auto spectrum", 3: "cross spectrum", 5: "transmissibility", 6: "coherence",
    7: "auto correlation", 8: "cross correlation", 10: "energy spectral density", 11: "probability density",
    12: "spectrum", 13: "cumulative frequency distribution", 14: "peaks and valleys", 15: "stress cycles",
    16: "strain cycles", 17: "orbit", 18: "mode indicator function", 19: "force pattern", 20: "partial power",
    21: "partial coherence", 22: "eigenvalue", 23: "eigenvector", 24: "shock response spectrum",
    25: "impulse response filter", 26: "multiple coherence", 27: "order function",
}  # fmt: skip


@pytest.mark.parametrize("kind", range(29))
def test_every_type_of_function(tmp_path: Path, kind: int) -> None:
    """Types of functions were refused with one sentence for all: each is read by one function or refused by its name."""
    path = tmp_path / "a.uff"
    values = np.array([0.0, 1.0, 2.0, 1.5, 0.5])
    path.write_text(set58(kind, values + 0.5j if kind in (4, 5) else values, "g", over=17 if kind == 1 else 18))
    readers = {
        1: lambda: rb.Record.from_file(path),
        4: lambda: rb.analysis.read_frequency_response(path, unit="g/N"),
        5: lambda: rb.analysis.read_frequency_response(path, unit="1"),
        9: lambda: rb.Random.from_file(path, "1 s", unit="g"),
    }
    names = {1: "time response", 4: "frequency response function", 9: "power spectral density"}
    for reads, call in readers.items():
        if reads == kind or {reads, kind} == {4, 5}:
            call()
            continue
        with pytest.raises(rb.DataError) as error:
            call()
        name = KINDS.get(kind, names.get(kind, "function of type 28"))
        assert f"but 1 x {name}" in str(error.value)
        uses = {1: "rb.Record.from_file", 9: "rb.Random.from_file"}
        uses |= dict.fromkeys((4, 5), "rb.analysis.read_frequency_response")
        used = uses.get(kind, "an export")
        assert f"try: {used}" in str(error.value)


def test_times_in_the_unit_of_the_label(tmp_path: Path) -> None:
    """Times of a set 58 were taken as seconds whatever its label says, since no sample has another label."""
    path = tmp_path / "a.uff"
    text = set58(1, np.array([0.0, 1.0, -2.0, 0.5]), "N", step=2.5, over=17)
    for label, factor in (("s", 1), ("ms", 1e-3), ("sec", 1), ("NONE", 1), ("Zeit", 1)):
        path.write_text(text.replace("s                   \n", f"{label:<20}\n", 1))
        np.testing.assert_allclose(rb.Record.from_file(path).times, 2.5 * factor * np.arange(4), rtol=1e-12)


@pytest.mark.parametrize(
    ("over", "under", "factor"),
    [("g^2", "Hz", G**2), ("(m/s^2)^2", "HZ", 1), ("g^2/Hz", "Hz", G**2), ("g^2/Hz", "g", G**2)],
)
def test_numerator_and_denominator_of_a_density(tmp_path: Path, over: str, under: str, factor: float) -> None:
    """Labels g^2 and Hz of numerator and denominator are g^2/Hz; only whole units in one label had been tried."""
    path = tmp_path / "level.uff"
    path.write_text(set58(9, np.full(4, 0.02), over, under=under))
    assert rb.Random.from_file(path, "1 s").corners[0, 1] == pytest.approx(0.02 * factor)
    path.write_text(set58(9, np.full(4, 0.02), "g", under="Hz"))
    with pytest.raises(rb.DataError, match="'g/Hz' is no unit of a density"):
        rb.Random.from_file(path, "1 s")


def test_exponents_of_fortran(tmp_path: Path) -> None:
    """Universal files with exponents D ended in "Error when reading data-set(s)", without the reason."""
    path = tmp_path / "a.uff"
    content = set58(9, np.array([0.5, 1.25e-3, 2e-4, 3e-2, 4e-3, 5e-3, 7e-3]), "g^2/Hz")
    path.write_text(content)
    expected = rb.Random.from_file(path, "1 s").corners
    lines = [line.replace("E", "D") if line.startswith("  ") and "E-" in line else line for line in content.split("\n")]
    path.write_text("\n".join(lines))
    assert "D-0" in path.read_text()
    np.testing.assert_array_equal(rb.Random.from_file(path, "1 s").corners, expected)


def test_case_files(tmp_path: Path) -> None:
    """A case file names the density relative to its folder, keeps the name when it is written, and runs alike."""
    (tmp_path / "level.csv").write_text("f, S\n" + LINES)
    text = """
        duration = "0.2 s"
        [structure]
        kind = "sdof"
        mass = "2 kg"
        frequency = "60 Hz"
        damping_ratio = 0.03
        [base]
        kind = "random"
        file = "level.csv"
        duration = "0.2 s"
        unit = "g"
    """
    (tmp_path / "case.toml").write_text(text)
    case = rb.Case.from_file(tmp_path / "case.toml")
    assert case.base[0].corners[1] == pytest.approx((40, 0.05 * G**2))
    case.to_file(tmp_path / "again.toml")
    written = (tmp_path / "again.toml").read_text()
    assert 'file = "level.csv"' in written and "psd" not in written and 'unit = "g"' in written
    again = rb.Case.from_file(tmp_path / "again.toml")
    assert again == case
    assert rb.simulate(case).motion.equals(rb.simulate(again).motion)
    seeds = rb.sweep(case, {"base.seed": [0, 1]}, ["peak"], progress=False)
    assert len(set(seeds.peak.values.tolist())) == 2
    (tmp_path / "other.csv").write_text("f, S\n" + LINES.replace("0.05", "0.2"))
    files = [str(tmp_path / name) for name in ("level.csv", "other.csv")]
    with pytest.warns(UserWarning, match="other.csv is read as"):
        assert rb.sweep(case, {"base.file": files}, ["peak"], progress=False).peak.shape == (2,)
    with pytest.raises(rb.CaseError, match=r"the value was read from .*level\.csv"):
        case.replaced({"base.psd": POINTS})


def test_previews(tmp_path: Path) -> None:
    """A preview of a density said that its frequencies are no times; its lines of Python now read it."""
    (tmp_path / "a.csv").write_text("f (Hz), S (N^2/Hz)\n" + LINES)
    (tmp_path / "a.uff").write_text(
        set58(9, np.full(9, 0.02), "g^2/Hz") + set58(9, np.full(9, 0.02), "Pa^2/Hz", name="B")
    )
    (tmp_path / "b.uff").write_text(set58(9, np.full(9, 0.02), "NONE"))
    for name, words in [
        ("a.csv", "4 lines from 10 to 900 Hz"),
        ("a.uff", "B: cannot be read"),
        ("b.uff", "unit = 'g'"),
    ]:
        preview = rb.inspect(tmp_path / name)
        assert words in str(preview) and "power spectral densit" in preview.content
        assert isinstance(eval(preview.python, {"rb": rb}), rb.Random)


@pytest.mark.parametrize("name", ["a.csv", "a.uff"])
def test_mutants(tmp_path: Path, name: str) -> None:
    """A damaged file is read to a finite density or refused, in two seconds at most, never with another error."""
    path = tmp_path / name
    text = "f (Hz), S (g^2/Hz)\n" + LINES if name == "a.csv" else set58(9, np.linspace(0.1, 1, 20), "g^2/Hz")
    path.write_text(text)
    assert len(rb.Random.from_file(path, "0.1 s", unit="g").corners) > 3  # the sound file is read
    for number in range(300):
        path.write_bytes(mutant(text.encode(), number))
        start = time.process_time()
        message = "try: "
        try:
            assert np.isfinite(rb.Random.from_file(path, "0.1 s", unit="g").corners).all()
        except rb.RattleboxError as error:
            message = str(error)
        assert "try: " in message and len(message) < 5000, f"mutant {number}"
        assert time.process_time() - start < 2, f"mutant {number}"
