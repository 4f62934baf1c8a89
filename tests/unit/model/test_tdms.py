"""TDMS files of LabVIEW, the most common files of its users, which were refused."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.mutants import mutant

import rattlebox as rb

nptdms = pytest.importorskip("nptdms")

SAMPLES = np.array([0.5, -1.25, 2.0, 0.25, -0.75])


def channel(name: str, values: Any = SAMPLES, group: str = "run", **properties: Any) -> Any:
    """Return a channel for the writer of the library."""
    return nptdms.ChannelObject(group, name, values, properties=properties)


def write(path: Path, *channels: Any) -> Path:
    """Write one segment."""
    with nptdms.TdmsWriter(str(path)) as writer:
        writer.write_segment(list(channels))
    return path


def waveform(unit: str, step: float = 0.004, **more: Any) -> dict[str, Any]:
    """Return the properties of a waveform."""
    return {"wf_increment": step, "wf_start_offset": 0.0, "unit_string": unit, **more}


def test_waveforms(tmp_path: Path) -> None:
    """Channels of waveforms have names, units, increments and offsets."""
    path = write(
        tmp_path / "a.tdms",
        channel("hammer", **waveform("N")),
        channel("plate", np.array([1, -2, 3, 0, 1], dtype=np.int16), **waveform("g", 0.008, wf_start_offset=-0.016)),
        channel("comment", ["a", "b"]),
    )
    hammer, plate = (rb.Record.from_file(path, columns=name) for name in ("hammer", "plate"))
    assert (hammer.unit, plate.unit) == ("N", "m/s^2")
    np.testing.assert_array_equal(hammer.values, SAMPLES)
    np.testing.assert_allclose(hammer.times, 0.004 * np.arange(5), rtol=1e-15)
    np.testing.assert_allclose(plate.values, 9.80665 * np.array([1, -2, 3, 0, 1]), rtol=1e-15)
    np.testing.assert_allclose(plate.times, 0.008 * np.arange(-2, 3), atol=1e-17)
    assert plate.polyline()[0][0] == 0  # the first point, as of other measurement files
    assert np.array_equal(rb.Record.from_file(path, columns=(2,)).values, plate.values)
    assert "2 channels" in rb.inspect(path).content


def test_segments_and_groups(tmp_path: Path) -> None:
    """Segments are joined; equal names in two groups are told apart by the group."""
    path = tmp_path / "a.tdms"
    with nptdms.TdmsWriter(str(path)) as writer:
        for k in range(3):
            writer.write_segment(
                [channel("z", SAMPLES + k, **waveform("m/s^2")), channel("z", -SAMPLES, "other", **waveform("g"))]
            )
    record = rb.Record.from_file(path, columns="run/z")
    np.testing.assert_array_equal(record.values, np.concatenate([SAMPLES, SAMPLES + 1, SAMPLES + 2]))
    np.testing.assert_allclose(record.times, 0.004 * np.arange(15))
    with pytest.raises(rb.DataError, match=r"contains 2 time histories \(other/z, run/z\)"):
        rb.Record.from_file(path)


def test_times_in_a_channel(tmp_path: Path) -> None:
    """Without an increment, a channel of times or of time stamps of the same group has the times."""
    times = np.array([0.0, 0.1, 0.3, 0.4, 0.9])
    stamps = np.datetime64("2024-03-05T10:00:00") + (1e9 * times).astype("timedelta64[ns]")
    for name, values in (("Time (s)", times), ("stamp", stamps)):
        path = write(tmp_path / "a.tdms", channel(name, values), channel("push", unit_string="kN"))
        record = rb.Record.from_file(path)
        np.testing.assert_allclose(record.times, times, atol=1e-6)
        np.testing.assert_allclose(record.values, 1e3 * SAMPLES)


def test_step_of_the_user(tmp_path: Path) -> None:
    """A channel without times needs `dt`; one with times refuses it."""
    path = write(tmp_path / "a.tdms", channel("push", unit_string="N"))
    with pytest.raises(rb.DataError, match=r"does not state the time between the samples of 'push'\n.*dt = "):
        rb.Record.from_file(path)
    np.testing.assert_allclose(rb.Record.from_file(path, dt="2 ms").times, 0.002 * np.arange(5))
    path = write(tmp_path / "b.tdms", channel("push", **waveform("N")))
    with pytest.raises(rb.RattleboxError, match=r"states its time step\n.*leave dt out"):
        rb.Record.from_file(path, dt="2 ms")


def test_times_in_other_units(tmp_path: Path) -> None:
    """An increment in ms is not one in seconds."""
    path = write(tmp_path / "a.tdms", channel("push", **waveform("N", 4.0, wf_xunit_string="ms")))
    np.testing.assert_allclose(rb.Record.from_file(path).times, 0.004 * np.arange(5))


def test_values_that_the_library_cannot_place(tmp_path: Path) -> None:
    """A wrong number of samples gave fewer values and a line on the terminal: the file is refused."""
    path = write(tmp_path / "a.tdms", channel("push", **waveform("N")))
    content = path.read_bytes()
    path.write_bytes(content.replace((5).to_bytes(8, "little"), (4).to_bytes(8, "little"), 1))
    with pytest.raises(rb.DataError, match="is damaged, or of a newer version: Data size"):
        rb.Record.from_file(path)


@pytest.mark.parametrize(
    ("channels", "message"),
    [
        ([("push", SAMPLES, waveform("V"))], "'V'"),
        ([("push", SAMPLES, waveform(""))], r"states no unit\n.*unit = "),
        ([("push", SAMPLES, waveform("N", -0.1))], "has the increment -0.1"),
        ([("push", SAMPLES, waveform("N", wf_xname="Frequency", wf_xunit_string="Hz"))], "over Frequency Hz"),
        ([("push", SAMPLES[:1], waveform("N"))], r"no time history, but push \(1 samples\)"),
        ([("note", ["x", "y", "z"], {})], r"no time history, but note \(no numbers\)"),
        ([("push", np.array([1.0, np.nan, 2.0]), waveform("N"))], "nan"),
        ([], "no time history, but no channel"),
    ],
)
def test_bad_channels(tmp_path: Path, channels: list, message: str) -> None:
    """Channels that are no time histories of a known unit are refused with the reason."""
    path = write(tmp_path / "a.tdms", *(channel(name, values, **about) for name, values, about in channels))
    with pytest.raises(rb.RattleboxError, match=message) as error:
        rb.Record.from_file(path)
    assert "try: " in str(error.value)


def test_cut_and_unfinished_files(tmp_path: Path) -> None:
    """The library reads what is left of a cut file without a word: it is refused, unless its writer was stopped."""
    path = write(tmp_path / "a.tdms", channel("push", **waveform("N")))
    content = path.read_bytes()
    path.write_bytes(content[:-16])
    with pytest.raises(rb.DataError, match="is cut short: its last segment is not complete"):
        rb.Record.from_file(path)
    path.write_bytes(content[:12] + b"\xff" * 8 + content[20:-16])
    record = rb.Record.from_file(path)
    assert np.array_equal(record.values, SAMPLES[:3])
    assert any("was stopped" in note for note in record.notes())
    path.write_bytes(content + b"rest of another file")
    with pytest.raises(rb.DataError, match=f"byte {len(content)}: no segment"):
        rb.Record.from_file(path)


def test_without_the_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A missing library is named with the command that installs it, and is not loaded with Rattlebox."""
    path = write(tmp_path / "a.tdms", channel("push", **waveform("N")))
    monkeypatch.setitem(sys.modules, "nptdms", None)
    with pytest.raises(rb.MissingDependency, match=r"rattlebox\[tdms\]"):
        rb.Record.from_file(path)


def test_mutants(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """A damaged file is read to finite numbers or refused, in two seconds at most, never with another error."""
    path = write(tmp_path / "a.tdms", channel("push", **waveform("N")), channel("tip", **waveform("g")))
    content = path.read_bytes()
    for number in range(300):
        path.write_bytes(mutant(content, number))
        start = time.process_time()
        message = "try: "
        try:
            assert np.isfinite(rb.Record.from_file(path, unit="N", columns=(1,)).values).all()
        except rb.RattleboxError as error:
            message = str(error)
        assert "try: " in message and len(message) < 5000, f"mutant {number}"
        assert time.process_time() - start < 2, f"mutant {number}"
    assert not capfd.readouterr().err  # the library prints damaged texts


def test_unit_of_the_channel_of_times(tmp_path: Path) -> None:
    """A channel of times may be in milliseconds by its unit, which was overlooked: all times in tests were in seconds."""
    times = np.array([0.0, 3.0, 6.0, 9.0, 12.0])
    path = write(tmp_path / "a.tdms", channel("Time", times, unit_string="ms"), channel("plate", unit_string="g"))
    np.testing.assert_allclose(rb.Record.from_file(path, columns="plate").times, times / 1000, rtol=1e-15)
