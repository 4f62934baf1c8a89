"""Studies of real cases: killed and stopped."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import rattlebox as rb
from rattlebox.studies.axes import read_axes
from rattlebox.studies.impact_work import ImpactWork
from rattlebox.studies.runner import Stopped, run_work
from rattlebox.studies.stored import open_study, progress_of
from rattlebox.studies.study_file import read_study

from .fake import done_in

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
from rattlebox.studies.runner import run_work
from rattlebox.studies.study_file import read_study
study = read_study("study.toml")
run_work(study.work, store="study.zarr", workers=1, block=100)
"""


def test_a_killed_study_goes_on(tmp_path: Path) -> None:
    """A study of 2000 runs, killed in the middle, goes on by the command and gives the same bits as in memory."""
    (tmp_path / "study.toml").write_text(STUDY)
    store = tmp_path / "study.zarr"
    process = subprocess.Popen([sys.executable, "-c", SMALL_BLOCKS], cwd=tmp_path)
    until = time.monotonic() + 30
    while not done_in(store) and time.monotonic() < until:
        time.sleep(0.01)
    process.kill()
    process.wait()
    assert 0 < progress_of(store).done < 2000
    command = [sys.executable, "-m", "rattlebox.cli", "sweep", "study.toml"]
    output = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert output == "2,000 variants: 2,000 finished\nwritten to study.zarr\n"
    study = read_study(tmp_path / "study.toml")
    whole = study.run(workers=2)
    result = open_study(store)
    assert {name: result[name].values.tobytes() for name in result} == {
        name: whole[name].values.tobytes() for name in whole
    }


def own(run: rb.Run) -> float:
    """A measure of one's own."""
    return float(len(run.arrays.impacts))


def ball() -> rb.Case:
    """A ball that a shaker throws to and fro."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="10 mm", material="steel"), gap="1 mm", velocity=0.1, contact=rb.Tsuji(restitution=0.6)
    )
    motion = rb.Harmonic(amplitude="1 mm", frequency="10 Hz")
    return rb.Case(structure=rb.Shaker(motion=motion), damper=damper, duration="1 s", method=rb.Newton())


def one_block(store: Path) -> None:
    """One block that takes minutes."""
    case = rb.Case.from_file(EXAMPLE)
    design = read_axes(case, {"damper.start": rb.linspace(-0.5, 0.5, 100_000)})
    run_work(ImpactWork(case, design, ["impacts"]), store=store, block=100_000, progress=False)


STARTS = {"damper.start": rb.linspace(-0.5, 0.5, 100_000)}
WORK: dict[str, Callable[[Path], object]] = {
    "one block": one_block,
    "sweep": lambda store: rb.sweep(rb.Case.from_file(EXAMPLE), STARTS, ["impacts"], store=store, progress=False),
    "own measure": lambda store: rb.sweep(rb.Case.from_file(EXAMPLE), STARTS, [own], store=store, progress=False),
    "bifurcation": lambda store: rb.bifurcation(
        ball(), "damper.gap", [1e-3, 2e-3], cycles=(10**8, 4), store=store, progress=False
    ),
    "lyapunov": lambda store: rb.lyapunov(ball(), STARTS, cycles=(10**4, 10**4), store=store, progress=False),
    "design": lambda store: rb.design(
        rb.Case.from_file(EXAMPLE), {"damper.gap": (1e-4, 1e-3)}, starts=100_000, store=store, progress=False
    ),
}


@pytest.mark.parametrize("work", WORK)
def test_ctrl_c_stops_within_a_fifth_of_a_second(work: str, tmp_path: Path) -> None:
    """Ctrl-C in the middle of hours of work ends it within 0.2 s, and says how to go on."""
    took = []
    for attempt in range(5):  # something else may need the processor
        pressed: list[float] = []

        def press(pressed: list[float] = pressed) -> None:
            pressed.append(time.perf_counter())
            os.kill(os.getpid(), signal.SIGINT)

        threading.Timer(0.5 + 0.2 * attempt, press).start()
        with pytest.raises(Stopped, match="the same command resumes from there"):
            WORK[work](tmp_path / "study.zarr")
        took.append(time.perf_counter() - pressed[0])
        if took[-1] < 0.2:
            return
    pytest.fail(f"Ctrl-C took {took}")
