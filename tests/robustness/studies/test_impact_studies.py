"""Interruption and restart of studies of impact dampers."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from support.command import rattlebox
from support.ctrl_c import CtrlC
from support.logistic_study import variants_in
from support.waiting import wait_for

import rattlebox as rb
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.run.runner import Stopped, run_work
from rattlebox.studies.run.stored import open_study, progress_of
from rattlebox.studies.study_file import read_study
from rattlebox.studies.work.impact import ImpactEngine
from rattlebox.studies.work.variants import Variants
from rattlebox.studies.work.work import Work

EXAMPLE = Path(__file__).parents[3] / "examples" / "steel_ball.toml"
STUDY = f"""\
measure = ["impacts", "impact_share"]
[case]
file = "{EXAMPLE}"
[axes]
"damper.start" = {{ from = -0.5, to = 0.5, count = 1000 }}
"load.amplitude" = ["2 kN", "5 kN"]
"""
SMALL_BLOCKS = """\
from rattlebox.studies.run.runner import run_work
from rattlebox.studies.study_file import read_study
study = read_study("study.toml")
run_work(study.work, store="study.zarr", workers=1, block=100)
"""


def test_killed_study_resumes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A study of 2000 runs that is killed resumes by the command and has the bits of one in memory."""
    (tmp_path / "study.toml").write_text(STUDY)
    store = tmp_path / "study.zarr"
    process = subprocess.Popen([sys.executable, "-c", SMALL_BLOCKS], cwd=tmp_path)
    wait_for(lambda: variants_in(store))
    process.kill()
    process.wait()
    assert 0 < progress_of(store).done < 2000
    monkeypatch.chdir(tmp_path)
    assert rattlebox("sweep", "study.toml").stdout == "2,000 variants: 2,000 finished\nwritten to study.zarr\n"
    study = read_study(tmp_path / "study.toml")
    whole = study.run(workers=2)
    result = open_study(store)
    assert {name: result[name].values.tobytes() for name in result} == {
        name: whole[name].values.tobytes() for name in whole
    }


def impact_count(run: rb.Run) -> float:
    """Return the number of impacts, as a measure of a user."""
    return float(len(run.arrays.impacts))


def shaken_ball() -> rb.Case:
    """Return a shaken_ball in a shaken cavity."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="10 mm", material="steel"),
        gap="1 mm",
        velocity=0.1,
        contact=rb.Tsuji(restitution=0.6),
    )
    motion = rb.Harmonic(amplitude="1 mm", frequency="10 Hz")
    return rb.Case(structure=rb.Shaker(motion=motion), damper=damper, duration="1 s", method=rb.Newton())


def one_block(store: Path) -> None:
    """Run a study of one block that takes minutes."""
    case = rb.Case.from_file(EXAMPLE)
    design = read_axes(case, {"damper.start": rb.linspace(-0.5, 0.5, 100_000)})
    run_work(Work(ImpactEngine(Variants(case, design, ["impacts"]))), store=store, block=100_000, progress=False)


STARTS = {"damper.start": rb.linspace(-0.5, 0.5, 100_000)}
WORK: dict[str, Callable[[Path], object]] = {
    "one block": one_block,
    "sweep": lambda store: rb.sweep(rb.Case.from_file(EXAMPLE), STARTS, ["impacts"], store=store, progress=False),
    "measure of a user": lambda store: rb.sweep(
        rb.Case.from_file(EXAMPLE), STARTS, [impact_count], store=store, progress=False
    ),
    "bifurcation": lambda store: rb.bifurcation(
        shaken_ball(), "damper.gap", [1e-3, 2e-3], cycles=(10**8, 4), store=store, progress=False
    ),
    "lyapunov": lambda store: rb.lyapunov(shaken_ball(), STARTS, cycles=(10**4, 10**4), store=store, progress=False),
    "design": lambda store: rb.design(
        rb.Case.from_file(EXAMPLE), {"damper.gap": (1e-4, 1e-3)}, starts=100_000, store=store, progress=False
    ),
}


@pytest.mark.parametrize("work", WORK)
def test_ctrl_c_stops_within_a_fifth_of_a_second(work: str, tmp_path: Path) -> None:
    """Ctrl-C during hours of work ends it within 0.2 s, with a message on how to resume."""
    took = []
    for attempt in range(5):  # other programs may delay the signal
        stopped = pytest.raises(Stopped, match="the same command resumes from there")
        with CtrlC(0.5 + 0.2 * attempt) as ctrl_c, stopped:
            WORK[work](tmp_path / "study.zarr")
        took.append(ctrl_c.elapsed())
        if took[-1] < 0.2:
            return
    pytest.fail(f"Ctrl-C took {took}")
