"""`rattlebox run --start`, and what summaries, reports and comparisons state of a run that continues another one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.command import RunCli

import rattlebox as rb


def case(duration: float, **changes: object) -> rb.Case:
    """Return a driven oscillator with an impact damper."""
    parts = {
        "structure": rb.SDOF(mass="4 kg", frequency="14 Hz", damping_ratio=0.03),
        "damper": rb.ImpactDamper(
            ball=rb.Sphere(diameter="24 mm", material="steel"), gap="0.6 mm", contact=rb.Tsuji(restitution=0.7)
        ),
        "load": rb.Harmonic(amplitude="5 N", frequency="14 Hz"),
        "duration": duration,
    }
    return rb.Case(**(parts | changes))


def test_the_command_continues_a_run(run_cli: RunCli) -> None:
    """The command continues a file, states the times, and refuses folders and options with one clear error."""
    case(1.0).to_file("first.toml")
    case(2.0, load=None).to_file("decay.toml")
    assert run_cli("run", "first.toml", "-o", "first", "--no-figures")[0] == 0
    code, out, _ = run_cli("run", "decay.toml", "--start", "first/run.nc", "-o", "decay")
    assert code == 0
    assert "1.000 s to 2.000 s" in out
    run, first = rb.load("decay/run.nc"), rb.load("first/run.nc")
    assert run == rb.simulate(rb.Case.from_file("decay.toml"), start=first)
    refused = {
        ("run", "decay.toml", "--start", "first/run.nc", "-o", "first"): "could overwrite",
        ("run", "first.toml", "--start", "first/run.nc", "-o", "again"): "must end later",
        ("run", "decay.toml", "--start", "none.nc", "-o", "again"): "none.nc",
        ("run", "decay.toml", "--start", "first/run.nc", "--checkpoint", "x", "-o", "again"): "checkpoint",
    }
    for words, message in refused.items():
        code, _, errors = run_cli(*words)
        assert code == 2, words
        assert message in errors, words
        assert "Traceback" not in errors


def test_report_and_comparison(tmp_path: Path) -> None:
    """A report says from where a run continues and how to repeat it; settling times count from its start."""
    first = rb.simulate(case(1.0))
    decay = rb.simulate(case(3.0, load=None), start=first)
    page = decay.report(tmp_path / "report.html").read_text()
    assert "The run continues a run from 1 s" in page
    assert "from 1 s to 3 s" in page
    assert "--start first.nc" in page
    bare = rb.simulate(case(3.0, load=None, damper=None), start=rb.simulate(case(1.0, damper=None)))
    values = rb.compare({"bare": bare, "damped": decay}).values
    settled = values["damped"]["settling_time[mass]"]
    assert 0 < settled < 2
    peak = np.abs(bare.arrays.displacement).max()
    late = decay.arrays.time > 1 + settled + 1e-6
    assert np.abs(decay.arrays.displacement[late]).max() < 0.0501 * peak


def test_second_half_of_a_continued_run() -> None:
    """Steady values are of the second half of the part that was computed, not of the time from zero."""
    steady = case(1.0, damper=None, structure=rb.SDOF(mass="4 kg", frequency="14 Hz", damping_ratio=0.2))
    first = rb.simulate(steady)
    later = rb.simulate(steady.replaced({"duration": 2.0}), start=first)
    whole = rb.simulate(steady.replaced({"duration": 2.0}))
    key = "steady_rms_displacement[mass]"
    assert later.summary().values[key] == pytest.approx(whole.summary().values[key], rel=1e-3)
    assert later.summary().values["supplied_energy"] < whole.summary().values["supplied_energy"]


def test_output_times_of_a_continued_run() -> None:
    """Rates count from zero, so that samples fall on those of one long run; the first one is the start."""
    assert rb.Output(rate="10 Hz").sample_times(1.0, start=0.45).tolist() == [0.45, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
    assert rb.Output(rate="10 Hz").sample_times(1.0, start=0.5).tolist() == [0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
    assert rb.Output(times=(0.1, 0.5, 0.7)).sample_times(1.0, start=0.5).tolist() == [0.5, 0.7, 1.0]
    assert rb.Output().sample_times(3.0, 1.0, 2.0)[[0, -1]].tolist() == [2.0, 3.0]
    assert rb.Output(rate="10 Hz").sample_times(0.3).tolist() == [0.0, 0.1, 0.2, 0.3]
