"""Files of measurement programs: LVM and WAV, which were refused or read with foreign names."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest
from scipy.io import wavfile
from support.mutants import mutant

import rattlebox as rb

LVM = """LabVIEW Measurement\t
Writer_Version\t2
Separator\tTab
Decimal_Separator\t,
Multi_Headings\tYes
X_Columns\tNo
***End_of_Header***\t
\t
Channels\t2\t\t
Samples\t4\t4\t
Y_Unit_Label\tNewtons\tg\t
X_Dimension\tTime\tTime\t
X0\t0,5\t0,5\t
Delta_X\t2,5E-3\t2,5E-3\t
***End_of_Header***\t\t\t
X_Value\thammer\tplate\tComment
\t1,5\t0,1
\t-2,5\t0,2
\t3,25\t-0,3
\t0\t0,4
"""


def test_lvm(tmp_path: Path) -> None:
    """Channels have names, units, steps and decimal commas of their header."""
    path = tmp_path / "a.lvm"
    path.write_text(LVM)
    force, plate = (rb.Record.from_file(path, columns=(name,)) for name in ("hammer", 2))
    assert (force.unit, plate.unit) == ("N", "m/s^2")
    np.testing.assert_allclose(force.values, [1.5, -2.5, 3.25, 0])
    np.testing.assert_allclose(plate.values, 9.80665 * np.array([0.1, 0.2, -0.3, 0.4]))
    np.testing.assert_allclose(force.times, 0.5 + 0.0025 * np.arange(4))
    np.testing.assert_allclose(force.polyline()[0], 0.0025 * np.arange(4), atol=1e-15)
    point = LVM.replace("\t,\n", "\t.\n").replace(",", ".").replace("X_Columns\tNo", "X_Columns\tOne")
    for k in range(4):
        point = point.replace(
            f"\n\t{('1.5', '-2.5', '3.25', '0')[k]}\t", f"\n{0.01 * k}\t{('1.5', '-2.5', '3.25', '0')[k]}\t"
        )
    path.write_text(point)
    np.testing.assert_allclose(rb.Record.from_file(path, columns=("plate",)).times, 0.01 * np.arange(4))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("LabVIEW", "Other", "line 1: .* 'LabVIEW Measurement' is expected"),
        ("3,25", "3,2x", "line 19: '3,2x' is found, but a number is expected"),
        ("Samples\t4", "Samples\t5", "states 5 samples of 'hammer', but contains 4"),
        ("Dimension\tTime", "Dimension\tFrequency", "is over 'Frequency', not over time"),
        ("Newtons", "Volts", "'Volts'"),
        ("Newtons", "", 'states no unit'),
        ("Separator\tTab", "Separator\tPipe", "the separator 'Pipe'"),
        ("Channels\t2", "Channels\t7", "a number of channels"),
    ],
)  # fmt: skip
def test_bad_lvm(tmp_path: Path, old: str, new: str, message: str) -> None:
    """A damaged or foreign file is refused with its place."""
    path = tmp_path / "a.lvm"
    path.write_text(LVM.replace(old, new, 1))
    with pytest.raises(rb.RattleboxError, match=message):
        rb.Record.from_file(path, columns=("hammer",))


def test_wav(tmp_path: Path) -> None:
    """Whole numbers are fractions of full scale, and a file without unit and scale is refused."""
    path = tmp_path / "a.wav"
    for kind, full in (("int16", 2**15), ("int32", 2**31), ("float32", 1)):
        wavfile.write(path, 400, (full * np.array([0.0, 0.5, -0.25, 0.125])).astype(kind))
        record = rb.Record.from_file(path, unit="g", scale=20.0)
        np.testing.assert_allclose(record.polyline()[1], 20 * 9.80665 * np.array([0, 0.5, -0.25, 0.125]))
        np.testing.assert_allclose(record.times, np.arange(4) / 400)
    for fields in ({}, {"unit": "g"}, {"scale": 2.0}):
        with pytest.raises(rb.RattleboxError, match="states no calibration"):
            rb.Record.from_file(path, **fields)


@pytest.mark.parametrize("name", ["a.lvm", "a.wav"])
def test_mutants(tmp_path: Path, name: str) -> None:
    """A damaged file is read to finite numbers or refused, in two seconds at most, never with another error."""
    path = tmp_path / name
    path.write_text(LVM) if name == "a.lvm" else wavfile.write(path, 400, np.arange(60, dtype="int16"))
    content = path.read_bytes()
    for number in range(300):
        path.write_bytes(mutant(content, number))
        start = time.process_time()
        try:
            assert np.isfinite(rb.Record.from_file(path, unit="N", scale=2.0, columns=(1,)).values).all()
        except rb.RattleboxError as error:
            message = str(error)
        else:
            message = "try: "
        assert "try: " in message and len(message) < 5000, f"mutant {number}"
        assert time.process_time() - start < 2, f"mutant {number}"
