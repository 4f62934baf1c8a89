"""Studies that are interrupted, killed, and started twice."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
import weakref
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support import logistic_study
from support.ctrl_c import CtrlC
from support.datasets import bits
from support.logistic_study import Logistic, variants_in
from support.waiting import wait_for

import rattlebox as rb
from rattlebox.studies.design.trials import count_trials
from rattlebox.studies.run.runner import Stopped, run_work
from rattlebox.studies.run.stored import open_study, progress_of

SCRIPT = Path(logistic_study.__file__)


def start(store: Path, pause: float = 0.02) -> subprocess.Popen[str]:
    """Start the logistic study in another process."""
    return subprocess.Popen([sys.executable, str(SCRIPT), str(store), str(pause)], stderr=subprocess.PIPE, text=True)


def has_stored(store: Path, variants: int = 10) -> Callable[[], bool]:
    """Return a condition: a number of variants is in the store."""
    return lambda: variants_in(store) >= variants


def test_killed_and_resumed_study_has_the_same_bits(tmp_path: Path) -> None:
    """A study that is killed twice and then finished has the bits of an uninterrupted one."""
    store = tmp_path / "study.zarr"
    done = 0
    for _ in range(2):
        process = start(store)
        wait_for(has_stored(store, done + 10))
        process.kill()
        process.communicate()
        before, done = done, progress_of(store).done
        assert before < done < 60
    steps: list[int] = []
    finished = run_work(Logistic(), store=store, progress=lambda n, _: steps.append(n))
    assert steps[0] == done
    assert bits(finished) == bits(run_work(Logistic()))
    assert not list(store.rglob("*.partial"))


@pytest.mark.parametrize("after", [0.0, 0.005, 0.02])
def test_killed_while_the_store_is_created(tmp_path: Path, after: float) -> None:
    """After a kill at any time while the store is created, the same study runs."""
    store = tmp_path / "study.zarr"
    process = start(store)
    wait_for((store / "progress/writer").exists)
    time.sleep(after)
    process.kill()
    process.communicate()
    assert bits(run_work(Logistic(), store=store)) == bits(run_work(Logistic()))


def test_ctrl_c_in_another_process(tmp_path: Path) -> None:
    """Ctrl-C ends a study at once, stores the finished blocks and prints how to resume."""
    store = tmp_path / "study.zarr"
    process = start(store, pause=0.06)
    wait_for(has_stored(store, 5))
    process.send_signal(signal.SIGINT)
    _, message = process.communicate(timeout=20)
    assert process.returncode != 0
    assert f"of 60 variants are in {store}, and the same command resumes from there" in message
    assert 5 <= progress_of(store).done < 60
    assert bits(run_work(Logistic(), store=store)) == bits(run_work(Logistic()))


def test_ctrl_c_is_quick(tmp_path: Path) -> None:
    """Ctrl-C during a block of minutes ends the study in a fraction of a second."""
    with CtrlC(0.3) as ctrl_c, pytest.raises(Stopped, match="0 of 60 variants are in"):
        run_work(Logistic(pause=10), store=tmp_path / "study.zarr", block=30)
    assert ctrl_c.elapsed() < 2.0  # 0.2 s on an idle machine
    with CtrlC(0.3), pytest.raises(Stopped, match="which are lost"):
        run_work(Logistic(pause=10))


def test_ctrl_c_between_blocks(tmp_path: Path) -> None:
    """Ctrl-C while a block is stored does not lose it, and does not stop a later study."""
    with pytest.raises(KeyboardInterrupt):
        run_work(Logistic(), store=tmp_path / "study.zarr", block=5, progress=_press_once())
    assert 0 < progress_of(tmp_path / "study.zarr").done < 60
    run_work(Logistic(), store=tmp_path / "study.zarr")
    assert progress_of(tmp_path / "study.zarr").done == 60


def _press_once() -> Callable[[int, int], object]:
    return lambda done, total: os.kill(os.getpid(), signal.SIGINT) if done == 20 else None


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_ctrl_c_in_a_callback_of_the_garbage_collector(tmp_path: Path) -> None:
    """Ctrl-C where Python discards exceptions stops a study, and does not stop a later one."""

    class Garbage: ...

    def press(done: int, total: int) -> None:
        if done == 20:
            garbage = Garbage()
            callback = weakref.ref(garbage, lambda _: signal.raise_signal(signal.SIGINT))
            del garbage
            assert callback() is None

    with pytest.raises(Stopped):
        run_work(Logistic(), store=tmp_path / "study.zarr", block=5, progress=press)
    assert progress_of(tmp_path / "study.zarr").done < 60
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    run_work(Logistic(), store=tmp_path / "study.zarr")


def test_two_processes_on_one_store(tmp_path: Path) -> None:
    """While a process writes to a store, another one is refused with its number; the lock ends with the process."""
    store = tmp_path / "study.zarr"
    process = start(store, pause=0.06)
    wait_for(has_stored(store, 5))
    with pytest.raises(rb.StoreError, match=rf"is being written by process {process.pid} on "):
        run_work(Logistic(), store=store)
    assert open_study(store).sizes["gap"] == 6
    process.kill()
    process.communicate()
    assert bits(run_work(Logistic(), store=store)) == bits(run_work(Logistic()))


PARTICLES = """
import sys
import rattlebox as rb

case = rb.Case(
    structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping="20 N s/m"),
    damper=rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="6 mm", count=12),
        cavity=rb.Box(size=("20 mm", "20 mm", "24 mm")),
        contact=rb.Tsuji(restitution=0.7),
        direction="z",
        packing=rb.Settled(seed=1),
        softening=1000,
    ),
    load=rb.Harmonic(amplitude="10 N", frequency="30 Hz"),
    duration="1 s",
)


def response(store, progress):
    return rb.frequency_response(
        case, rb.linspace("26 Hz", "32 Hz", 8), cycles=(3, 4), samples=16, workers=2, store=store, progress=progress
    )


if __name__ == "__main__":
    response(sys.argv[1], False)
"""


@pytest.mark.slow
def test_a_killed_sweep_with_particles_continues_within_it(tmp_path: Path) -> None:
    """Stepped sines killed twice continue from their last frequencies, with the bits of those that ran through."""
    script, store = tmp_path / "response.py", tmp_path / "response.zarr"
    script.write_text(PARTICLES)
    done = 0
    for _ in range(2):
        with subprocess.Popen([sys.executable, str(script), str(store)]) as process:
            wait_for(has_stored(store, done + 2))
            process.kill()
        before, done = done, progress_of(store).done
        assert before < done < 16
    names: dict[str, Any] = {}
    exec(PARTICLES.replace("__main__", "never"), names)
    steps: list[int] = []
    resumed = names["response"](store, lambda n, _: steps.append(n))
    assert steps[0] == done
    assert bits(resumed) == bits(names["response"](None, False))


DESIGN = """
import runpy, sys

bar = runpy.run_path(sys.argv[1])


def search(**options):
    return bar["search"](bar["bar"](softening=300), ["50 um", "80 um"], 2, [0.2, 0.4], [1, 2, 3], workers=2, **options)
"""


@pytest.mark.slow
def test_a_killed_design_with_particles_resumes_with_its_trials(tmp_path: Path) -> None:
    """A search for fill and number of cavities killed twice computes the missing trials only, with the same results."""
    script, store = str(Path(__file__).parents[3] / "examples" / "boring_bar_design.py"), tmp_path / "design.zarr"
    command = [sys.executable, "-c", DESIGN + "\nsearch(store=sys.argv[2], progress=False)", script, str(store)]
    done = 0
    for _ in range(2):
        with subprocess.Popen(command) as process:
            wait_for(lambda least=done + 1: (count_trials(store) or 0) >= least)
            process.kill()
        before, done = done, count_trials(store) or 0
        assert before < done < 6
    names: dict[str, Any] = {}
    exec(DESIGN.replace("sys.argv[1]", repr(script)), names)
    steps: list[int] = []
    resumed = names["search"](store=store, progress=lambda n, _: steps.append(n))
    assert steps[0] == done and resumed.sizes["trial"] == 6
    whole = names["search"](progress=False)
    for name in ("added_mass", "damping_ratio", "damping_ratio_interval", "front"):
        assert resumed[name].values.tobytes() == whole[name].values.tobytes(), name
