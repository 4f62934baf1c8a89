"""Studies of real cases: killed and stopped."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import rattlebox as rb
from rattlebox.studies.axes import Design
from rattlebox.studies.runner import Stopped, run_task
from rattlebox.studies.store import open_study, progress_of
from rattlebox.studies.studyfile import read_study
from rattlebox.studies.task import SweepTask

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
from rattlebox.studies.axes import Design
from rattlebox.studies.runner import run_task
from rattlebox.studies.studyfile import read_study
from rattlebox.studies.task import SweepTask
study = read_study("study.toml")
design = Design.of(study.case, study.axes)
task = SweepTask(study.case, design, study.options["measure"])
run_task(task, design=design, store="study.zarr", threads=1, block=100)
"""


def test_a_killed_study_goes_on(tmp_path: Path) -> None:
    """A study of 2000 runs, killed in the middle, goes on by the command and gives the same bits as in memory."""
    (tmp_path / "study.toml").write_text(STUDY)
    store = tmp_path / "study.zarr"
    process = subprocess.Popen([sys.executable, "-c", SMALL_BLOCKS], cwd=tmp_path)
    until = time.monotonic() + 30
    while not (store / "progress/finished/c/0").exists() and time.monotonic() < until:
        time.sleep(0.01)
    process.kill()
    process.wait()
    assert 0 < progress_of(store).done < 2000
    command = [sys.executable, "-m", "rattlebox.cli", "sweep", "study.toml"]
    told = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert told == "2,000 variants: 2,000 finished\nwritten to study.zarr\n"
    study = read_study(tmp_path / "study.toml")
    whole = rb.sweep(study.case, study.axes, threads=2, **study.options)
    found = open_study(store)
    assert {name: found[name].values.tobytes() for name in found} == {
        name: whole[name].values.tobytes() for name in whole
    }


def test_ctrl_c_stops_the_core(tmp_path: Path) -> None:
    """Ctrl-C in the middle of a long block stops the threads of the core at once."""
    case = rb.Case.from_file(EXAMPLE)
    design = Design.of(case, {"damper.start": rb.linspace(-0.5, 0.5, 100_000)})
    pressed: list[float] = []

    def press() -> None:
        pressed.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    threading.Timer(0.5, press).start()
    with pytest.raises(Stopped, match="0 of 100,000 variants"):
        run_task(SweepTask(case, design, ["impacts"]), design=design, store=tmp_path / "study.zarr", block=100_000)
    assert time.perf_counter() - pressed[0] < 2.0  # 0.2 s where nothing else runs
