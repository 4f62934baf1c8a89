"""Runs, and times of runs, are an axis of a sweep: each variant is the run that `rb.simulate(case, start=...)` gives.

No earlier test could see a fault here, because a list of starts was a loop outside of any study.
"""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.studies.kinds.sweep import Sweep
from rattlebox.studies.study_file import study_from_toml

BALL = rb.Sphere(diameter="30 mm", material="steel")


def line(**changes: Any) -> rb.Case:
    """Return a driven oscillator with an impact damper."""
    parts: dict[str, Any] = {
        "structure": rb.SDOF(mass="4 kg", frequency="14 Hz", damping_ratio=0.008),
        "damper": rb.ImpactDamper(ball=BALL, gap="0.7 mm", contact=rb.Tsuji(restitution=0.55)),
        "load": rb.Harmonic(amplitude="5 N", frequency="14.2 Hz"),
        "duration": "0.7 s",
        "output": rb.Output(rate="2 kHz"),
    }
    return rb.Case(**(parts | changes))


def bed(**changes: Any) -> rb.Case:
    """Return a driven oscillator with a box of balls, in equal time steps."""
    parts: dict[str, Any] = {
        "structure": rb.SDOF(mass="1 kg", frequency="30 Hz", damping_ratio=0.01),
        "damper": rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="6 mm", count=12),
            cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
            contact=rb.Tsuji(restitution=0.7),
            friction=0.3,
            direction="z",
            packing=rb.Settled(seed=2),
            softening=100,
        ),
        "load": rb.Harmonic(amplitude="6 N", frequency="30 Hz"),
        "duration": "0.1 s",
        "output": rb.Output(rate=1920),
        "method": rb.Dem(dt=1 / 1920 / 100),
    }
    return rb.Case(**(parts | changes))


def last_place(run: rb.Run) -> float:
    """Return the displacement at the end of a run, which every earlier difference changes."""
    return float(run.arrays.displacement[-1, 0])


def first_time(run: rb.Run) -> float:
    """Return the first time of a run."""
    return float(run.arrays.time[0])


@pytest.mark.parametrize("make", [line, bed])
def test_a_variant_is_a_continued_run(make: Any) -> None:
    """Each variant has the bits of the run that continues its start, and its measures are those of that run alone."""
    whole = make()
    a, b = rb.simulate(whole), rb.simulate(whole.replaced({"load.amplitude": 9.0}))
    starts = [a, b, (a, 0.5 * whole.duration)]
    longer = whole.replaced({"duration": 2 * whole.duration})
    amplitudes = [2.0, 7.0]
    axes = {"start": starts, "load.amplitude": amplitudes}
    found = rb.sweep(longer, axes, ["peak", "energy_residual", last_place, first_time])
    assert found.sizes["start"] == 3
    assert (found.status == 0).all()
    for i, start in enumerate(starts):
        for k, amplitude in enumerate(amplitudes):
            run = rb.simulate(longer.replaced({"load.amplitude": amplitude}), start=start)
            one = found.isel({"start": i, "load.amplitude": k})
            assert float(one.last_place) == last_place(run)
            assert float(one.first_time) == run.arrays.time[0]
            assert float(one.peak) == pytest.approx(np.abs(run.arrays.displacement).max(), rel=2e-3)
    assert found["start.time"].values == pytest.approx([whole.duration, whole.duration, 0.5 * whole.duration])
    assert len(set(found.start.values.tolist())) == 3


def test_work_of_a_variant_counts_from_its_start() -> None:
    """Shares and impacts of a variant refer to the part that it computes, also without functions of a run."""
    whole = line()
    start = rb.simulate(whole)
    longer = whole.replaced({"duration": "1.4 s"})
    found = rb.sweep(longer, {"start": [start]}, ["impacts", "impact_share"])
    run = rb.simulate(longer, start=start)
    assert float(found.impacts[0]) == np.count_nonzero(run.arrays.impacts.time >= 0.7)
    assert float(found.impact_share[0]) == pytest.approx(run.energy.share.sel(channel="normal").item(), rel=1e-6)


@pytest.mark.parametrize("make", [line, bed])
def test_cycles_count_from_each_start(make: Any) -> None:
    """Variants from different times have windows of equal length, and the first sample of each is its start."""
    whole = make()
    run = rb.simulate(whole)
    starts = [(run, 0.4 * whole.duration), run]
    found = rb.sweep(whole, {"start": starts}, ["rms", first_time, last_place], cycles=(1, 3), samples=193)
    period = 1 / whole.loads[0].frequency
    for i, start in enumerate(starts):
        begin = float(found.first_time[i])
        end = begin + 4 * period
        rate = 64 / period
        again = rb.simulate(whole.replaced({"duration": end, "output": rb.Output(rate=rate)}), start=start)
        evaluated = again.arrays.time >= end - 3 * period - 1e-9
        mean = np.trapezoid(again.arrays.displacement[evaluated, 0] ** 2, again.arrays.time[evaluated]) / (3 * period)
        # A 1-D run has its samples at multiples of their distance, so that the window begins up to one of them later.
        assert float(found.rms[i]) == pytest.approx(np.sqrt(mean), rel=3e-3)


def test_start_and_duration_vary_together() -> None:
    """A start and a case's parameter are one axis with a tuple as key, or with a name."""
    run = rb.simulate(line())
    starts, ends = [(run, "0.2 s"), (run, "0.5 s")], ["0.4 s", "0.7 s"]
    by_tuple = rb.sweep(line(), {("start", "duration"): (starts, ends)}, ["peak"])
    by_name = rb.sweep(line(), {"half": {"start": starts, "duration": ends}}, ["peak"])
    assert by_tuple.sizes == {"start": 2}
    assert by_name.sizes == {"half": 2}
    assert by_tuple.peak.values.tolist() == by_name.peak.values.tolist()
    assert by_tuple.duration.values.tolist() == [0.4, 0.7]
    assert by_tuple.start.values.tolist() == ["0.2 s", "0.5 s"]


def test_store_resumes_and_knows_its_starts(tmp_path: Path) -> None:
    """A store of the same starts is complete, also when they were run again; one of other starts is refused."""
    longer, store = line(duration="1.1 s"), tmp_path / "starts.zarr"
    axes = {"start": [rb.simulate(line())], "damper.contact.restitution": [0.55, 0.7]}
    first = rb.sweep(longer, axes, ["peak"], store=store)
    again = rb.sweep(longer, {**axes, "start": [rb.simulate(line())]}, ["peak"], store=store)
    assert first.peak.values.tolist() == again.peak.values.tolist()
    other = rb.simulate(line(load=rb.Harmonic(amplitude="5.1 N", frequency="14.2 Hz")))
    with pytest.raises(rb.RattleboxError, match="another study"):
        rb.sweep(longer, {**axes, "start": [other]}, ["peak"], store=store)


def test_variants_that_cannot_continue_are_refused() -> None:
    """A variant whose gap is too small at the seam has the status refused and a reason; all of them raise beforehand."""
    run = rb.simulate(line())
    longer = line(duration="0.9 s")
    found = rb.sweep(longer, {"start": [run], "damper.gap": ["0.7 mm", "0.05 mm"]}, ["peak"])
    assert int(found.status[0, 0]) == 0
    assert np.isnan(found.peak.values[0, 1])
    assert "gap" in found.attrs["refused"]
    with pytest.raises(rb.CaseError, match="case must end later"):
        rb.sweep(line(duration="0.6 s"), {"start": [run]}, ["peak"])


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("driven", "a list is needed"),
        ([], "needs a list of runs"),
        ([("a", 1, 2)], "a run and a time are needed"),
        ([3], "must be a run"),
    ],
)
def test_wrong_starts(given: Any, words: str) -> None:
    """What is not a list of runs is refused with the form that is allowed."""
    with pytest.raises(rb.CaseError, match=words):
        rb.sweep(line(), {"start": given}, ["peak"])


def test_skip_before_a_start() -> None:
    """A `skip` before the start of a variant is refused: it counts from the start of the first run, like `duration`."""
    run = rb.simulate(line())
    with pytest.raises(rb.CaseError, match=r"skip = 0\.3 s is before the start at 0.7 s"):
        rb.sweep(line(duration="1 s"), {"start": [run]}, ["peak"], skip="0.3 s")


def test_other_studies_refuse_starts() -> None:
    """Studies whose variants cannot continue a run say so: ignored starts would be a silent wrong answer."""
    run = rb.simulate(line())
    with pytest.raises(rb.CaseError, match=r"cannot continue runs"):
        rb.basins(line(), {"start": [run]})
    with pytest.raises(rb.CaseError, match=r"cannot continue runs"):
        rb.lyapunov(line(), {"start": [run]})


def test_other_processes_get_the_state() -> None:
    """Work that is sent to another process contains the state, so that no process repeats the run."""
    study = Sweep(line(duration="1 s"), {"start": [(rb.simulate(line()), "0.3 s")]}, ["peak"])
    engine = study.work.engine
    here = engine.run(range(1))
    there = pickle.loads(pickle.dumps(engine)).run(range(1))
    assert here["peak"].tobytes() == there["peak"].tobytes()


def test_study_file_names_saved_runs(tmp_path: Path) -> None:
    """A study file names runs relative to its own folder, and times of them."""
    run = rb.simulate(line())
    run.save(tmp_path / "driven.nc")
    line(duration="1 s").to_file(tmp_path / "case.toml")
    text = 'kind = "sweep"\ncase = "case.toml"\nmeasure = ["peak"]\n[axes]\nstart = ["driven.nc", ["driven.nc", "0.4 s"]]\n'
    found = study_from_toml(text, folder=tmp_path).run()
    direct = rb.sweep(line(duration="1 s"), {"start": [run, (run, "0.4 s")]}, ["peak"])
    assert found.peak.values.tolist() == direct.peak.values.tolist()
    assert study_from_toml(text, folder=tmp_path).estimate().cpu_time > 0


def test_figure_and_report_of_starts(tmp_path: Path) -> None:
    """Figures and reports of a sweep over starts name the starts."""
    run = rb.simulate(line())
    found = rb.sweep(
        line(duration="1 s"), {"start": [(run, "0.3 s"), run], "load.amplitude": [2.0, 5.0, 8.0]}, ["peak"]
    )
    rb.plot_map(found, "peak")
    file = rb.write_report(found, tmp_path / "starts.html")
    assert "0.3 s" in file.read_text()
