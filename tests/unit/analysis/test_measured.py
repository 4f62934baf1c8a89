"""Measured frequency response functions: universal files, tables, their units and damage."""

from __future__ import annotations

import math
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.set_58 import set58

import rattlebox as rb
from rattlebox.analysis import read_frequency_response, transfer_function

UFF = Path(__file__).parents[2] / "data/uff"
FRF = (UFF / "frf_58.uff").read_bytes()


def test_a_measured_function_of_a_universal_file() -> None:
    """Values, frequencies and the unit are those of a file that a measuring program wrote."""
    result = read_frequency_response(UFF / "frf_58.uff")
    assert result.transfer.attrs["units"] == "m/s^2/N"
    np.testing.assert_allclose(result.frequency[:3], [0, 0.195313, 0.390626])
    np.testing.assert_allclose(result.transfer[1], -0.0599924 - 0.055326j, rtol=1e-4)
    assert result.attrs["warnings"] == []


def test_the_response_of_a_run_beside_a_measured_one(tmp_path: Path) -> None:
    """A table of the closed form of a structure lies on the transfer function of its run."""
    frequency = np.arange(30.0, 50.0, 0.5)
    ratio = frequency / 40
    receptance = 1 / (2 * (2 * math.pi * 40) ** 2 * (1 - ratio**2 + 0.1j * ratio))
    rows = "\n".join(
        f"{f},{1e3 * abs(h):.6e},{math.degrees(np.angle(h)):.5f}" for f, h in zip(frequency, receptance, strict=True)
    )
    (tmp_path / "frf.csv").write_text("frequency (Hz),magnitude (mm/N),phase (deg)\n" + rows)
    measured = read_frequency_response(tmp_path / "frf.csv")
    force = rb.Random(psd=[(5, 1), (200, 1)], duration="60 s", unit="N")
    structure = rb.SDOF(mass="2 kg", frequency="40 Hz", damping_ratio=0.05)
    run = rb.simulate(rb.Case(structure=structure, load=force, duration="60 s", output=rb.Output(rate=2000)))
    time = run.motion.time
    even = np.arange(0, 60, 1 / 2000)
    push, moved = run.case.loads[0].evaluate(even), np.interp(even, time, run.motion.displacement[:, 0])
    simulated = transfer_function(even, push, moved, resolution=0.5).transfer.sel(frequency=frequency)
    np.testing.assert_allclose(simulated.values, measured.transfer.values, atol=0.06 * abs(measured.transfer).max())
    assert measured.transfer.attrs["units"] == "m/N"


@pytest.mark.parametrize(
    ("head", "row", "value", "unit"),
    [
        ("f (Hz),real (m/s^2/N),imag (m/s^2/N)", "3,4", 3 + 4j, "m/s^2/N"),
        ("f (Hz);real (g/N);imag (g/N)", "3;4", 9.80665 * (3 + 4j), "m/s^2/N"),
        ("f (Hz),real ((1/N)*(mm)),imag", "3,4", 1e-3 * (3 + 4j), "m/N"),
        ("f (Hz),magnitude (mm/s/N),phase (rad)", "2,1.5707963267948966", 2e-3j, "m/s/N"),
        ("f (Hz),magnitude (g/kN),phase [deg]", "2,180", -2e-3 * 9.80665, "m/s^2/N"),
        ("f (Hz),magnitude (dB m/N),phase (deg)", "-40,0", 0.01, "m/N"),
        ("f (Hz),magnitude (g/g),phase (deg)", "2,0", 2, "1"),
    ],
)
def test_tables(tmp_path: Path, head: str, row: str, value: complex, unit: str) -> None:
    """Real and imaginary part, magnitude and phase, decibels and usual units come out in SI."""
    mark = ";" if ";" in head else ","
    (tmp_path / "a.csv").write_text(f"{head}\n10{mark}{row}\n20{mark}{row}\n")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = read_frequency_response(tmp_path / "a.csv")
    np.testing.assert_allclose(result.transfer, [value, value], rtol=1e-12, atol=1e-15)
    assert result.transfer.attrs["units"] == unit
    np.testing.assert_allclose(result.frequency, [10, 20])


def test_an_assumed_unit_is_stated_with_the_peak(tmp_path: Path) -> None:
    """Without units the assumed ones are named with the largest value; a unit that is given is taken."""
    (tmp_path / "a.csv").write_text("frequency,magnitude,phase\n10,0.2,-5\n20,1.5,-90\n")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = read_frequency_response(tmp_path / "a.csv")
    assert [str(each.message) for each in caught] == result.attrs["warnings"]
    assert re.search(r"no unit; SI is assumed: the largest magnitude is 1\.5 .*at 20 Hz", result.attrs["warnings"][0])
    assert any("degrees are assumed: the largest is 90 deg" in note for note in result.attrs["warnings"])
    with pytest.warns(UserWarning, match="degrees"):
        given = read_frequency_response(tmp_path / "a.csv", unit="g_0/N")
    np.testing.assert_allclose(given.transfer, 9.80665 * result.transfer)
    bare = FRF.replace("(1/N)*(m/s²)".encode("latin-1"), b"NONE".ljust(12))
    assert bare != FRF
    (tmp_path / "a.uff").write_bytes(bare)
    with pytest.warns(UserWarning, match=r"largest magnitude is 4\.761 at 0\.9766 Hz"):
        read_frequency_response(tmp_path / "a.uff")


@pytest.mark.parametrize(
    ("name", "content", "options", "message"),
    [
        ("a.csv", b"", {}, "no numbers"),
        ("a.csv", b"f,real,imag\n", {}, "no numbers"),
        ("a.csv", b"f,real,imag\n1,2,3\n2,3\n", {}, "2 columns, but 3"),
        ("a.csv", b"f,real,imag\n1,2,nan\n2,3,4\n", {}, "not finite"),
        ("a.csv", b"f,real,imag\n2,2,3\n1,3,4\n", {}, "do not rise"),
        ("a.csv", b"f,a,b\n1,2,3\n2,3,4\n", {}, "neither an imaginary part nor a phase"),
        ("a.csv", b"f,magnitude (m/N),phase (deg)\n1,-2,3\n2,3,4\n", {}, "magnitude is negative"),
        ("a.csv", b"f,real (furlong/N),imag\n1,2,3\n2,3,4\n", {}, "furlong/N"),
        ("a.csv", b"f,real (m/N),imag (mm/N)\n1,2,3\n2,3,4\n", {}, "one unit for both"),
        ("a.csv", b"f,real,imag,coh\n1,2,3,1\n2,3,4,1\n", {}, "4 columns"),
        ("a.csv", b"f,real,imag\n1,2,3\n2,3,4\n", {"unit": "kg"}, "'kg' is not a unit"),
        ("a.uff", b"", {}, "is empty"),
        ("a.uff", FRF[: len(FRF) // 2], {}, "cut short|complete data set|cannot be read"),
        ("a.uff", FRF, {"function": "H9"}, "no function 'H9'"),
        ("a.uff", FRF, {"function": 2}, "no function 2"),
        ("a.uff", FRF, {"function": 0}, "no function 0"),
        ("a.uff", (UFF / "time_history_58.uff").read_bytes(), {}, "no frequency response function"),
        ("a.uff", (UFF / "normal_modes_55.uff").read_bytes(), {}, "no set 58"),
        ("a.uff", (UFF / "cut_58.uff").read_bytes(), {}, "states 2508876 points, but has 42"),
    ],
)
def test_damaged_files(tmp_path: Path, name: str, content: bytes, options: dict[str, Any], message: str) -> None:
    """Empty, cut and mistaken files are refused with the reason."""
    (tmp_path / name).write_bytes(content)
    with pytest.raises(rb.DataError, match=message):
        read_frequency_response(tmp_path / name, **options)


def test_the_wrong_order_of_bytes(tmp_path: Path) -> None:
    """A binary function whose header states the other order of bytes is refused."""
    content = (UFF / "time_history_58b.uff").read_bytes()
    lines = content.split(b"\n")
    place = next(k for k, line in enumerate(lines) if line.startswith(b"    1         0"))
    lines[place] = b"    4" + lines[place][5:]
    lines[place + 2] = lines[place + 2].replace(b"s         ", b"Hz        ")
    content = b"\n".join(lines)
    path = tmp_path / "b.uff"
    path.write_bytes(content)
    result = read_frequency_response(path, unit="m/s^2/N")
    assert result.transfer.size == 250 and abs(result.transfer).max() < 1.1
    assert b"58b     1     2" in content
    path.write_bytes(content.replace(b"58b     1     2", b"58b     2     2"))
    with pytest.raises(rb.DataError, match=r"any measurement|cannot be read"):
        read_frequency_response(path, unit="m/s^2/N")


@pytest.mark.parametrize(("label", "factor"), [("kHz", 1e3), ("HZ", 1.0), ("rad/s", 0.5 / np.pi), ("NONE", 1.0)])
def test_units_of_frequencies_of_universal_files(tmp_path: Path, label: str, factor: float) -> None:
    """Frequencies are in the unit of their label; every file of the tests had Hz, which was assumed."""
    path = tmp_path / "a.uff"
    text = set58(4, np.array([1.0, 2.5 - 3.0j, 0.25j]), "m/s^2/N", step=4.0)
    path.write_text(text.replace(f"{'Hz':<20}", f"{label:<20}"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        measured = read_frequency_response(path)
    np.testing.assert_allclose(measured.frequency, factor * np.array([0.0, 4.0, 8.0]), rtol=1e-12)
    path.write_text(text.replace(f"{'Hz':<20}", f"{'rpm':<20}"))
    with pytest.raises(rb.DataError, match="over 'rpm', which is no unit of frequency"):
        read_frequency_response(path)
