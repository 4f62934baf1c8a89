"""Time histories in the form of SEP005."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb


@pytest.mark.parametrize("output", [rb.Output(), rb.Output(rate="2 kHz"), rb.Output(times=[0.0, 0.001, 0.1])])
def test_channels_of_sep005(output: rb.Output) -> None:
    """Each channel has data, name, unit, and a rate or times from which the times of the run follow."""
    case = rb.reference_case(duration=0.1)
    run = rb.simulate(case.model_copy(update={"output": output}), progress=False)
    channels = {channel["name"]: channel for channel in run.to_sep005()}
    assert {"displacement mass", "velocity mass", "load half_sine 1"} < set(channels)
    for channel in channels.values():
        assert channel["data"].ndim == 1 and isinstance(channel["unit_str"], str)
        if "fs" in channel:
            np.testing.assert_allclose(np.arange(channel["data"].size) / channel["fs"], run.arrays.time, atol=1e-12)
        else:
            assert channel["time"] == run.arrays.time.tolist()
    np.testing.assert_array_equal(channels["velocity mass"]["data"], run.arrays.velocity[:, 0])
    assert [channels[f"{name} mass"]["quantity"] for name in ("displacement", "velocity", "acceleration")] == [
        "d",
        "v",
        "a",
    ]
    assert ("fs" in channels["velocity mass"]) is (output.rate is not None)
    (only,) = run.to_sep005(variables=["interface_force"])
    assert (only["unit_str"], only["quantity"]) == ("N", "f")
    with pytest.raises(rb.DataError, match="no time history"):
        run.to_sep005(variables=["impacts"])


@pytest.mark.parametrize("output", [rb.Output(rate="2 kHz"), rb.Output(times=[0.0, 0.001, 0.07, 0.1])])
def test_channels_and_universal_files_become_records(output: rb.Output, tmp_path: Path) -> None:
    """A run that is written is read as records with its times, values and units: each way was tested without the other.

    Velocities are refused by both readers.
    """
    pytest.importorskip("pyuff")
    case = rb.reference_case(duration=0.1)
    run = rb.simulate(case.model_copy(update={"output": output}), progress=False)
    run.to_uff(tmp_path / "run.uff")
    read = 0
    for number, channel in enumerate(run.to_sep005(), start=1):
        readers = (
            lambda given=channel: rb.Record.from_sep005(given),
            lambda place=number: rb.Record.from_file(tmp_path / "run.uff", columns=[place]),
        )
        for reader in readers:
            if channel["unit_str"] == "m/s":
                with pytest.raises(rb.RattleboxError, match=r"velocity|derivative"):
                    reader()
                continue
            record = reader()
            assert record.unit == channel["unit_str"] and not record.unit_is_assumed
            np.testing.assert_array_equal(record.values, channel["data"])
            np.testing.assert_allclose(record.times, run.arrays.time, atol=1e-12)
            read += 1
    assert read >= 8
