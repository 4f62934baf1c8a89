"""Studies that are interrupted, killed, and started twice."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
import weakref
from collections.abc import Callable
from pathlib import Path

import pytest
import xarray as xr

import rattlebox as rb
from rattlebox.studies.runner import Stopped, run_work
from rattlebox.studies.stored import open_study, progress_of

from .fake import Logistic, done_in

FAKE = Path(__file__).with_name("fake.py")


def bits(data: xr.Dataset) -> dict[str, bytes]:
    """Every variable to the last bit."""
    return {str(name): values.values.tobytes() for name, values in data.data_vars.items()}


def start(store: Path, pause: float = 0.02) -> subprocess.Popen[str]:
    """Start the fake study in a process of its own."""
    return subprocess.Popen([sys.executable, str(FAKE), str(store), str(pause)], stderr=subprocess.PIPE, text=True)


def wait_for(condition: Callable[[], bool]) -> None:
    """Wait until something is so."""
    until = time.monotonic() + 30
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.005)


def has_begun(store: Path, variants: int = 10) -> Callable[[], bool]:
    """Whether some variants are on disk."""
    return lambda: done_in(store) >= variants


def test_killed_and_resumed_is_bit_for_bit_the_same(tmp_path: Path) -> None:
    """A study killed twice without warning, then finished, has the bits of one that ran through."""
    store = tmp_path / "study.zarr"
    done = 0
    for _ in range(2):
        process = start(store)
        wait_for(has_begun(store, done + 10))
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
def test_killed_while_the_store_is_made(tmp_path: Path, after: float) -> None:
    """A kill at any moment while the store is being made leaves nothing that is in the way."""
    store = tmp_path / "study.zarr"
    process = start(store)
    wait_for((store / "progress/writer").exists)
    time.sleep(after)
    process.kill()
    process.communicate()
    assert bits(run_work(Logistic(), store=store)) == bits(run_work(Logistic()))


def test_ctrl_c_in_a_process(tmp_path: Path) -> None:
    """Ctrl-C ends a study at once, keeps the finished blocks, and says how to go on."""
    store = tmp_path / "study.zarr"
    process = start(store, pause=0.06)
    wait_for(has_begun(store, 5))
    process.send_signal(signal.SIGINT)
    _, message = process.communicate(timeout=20)
    assert process.returncode != 0
    assert f"of 60 variants are in {store}, and the same command resumes from there" in message
    assert 5 <= progress_of(store).done < 60
    assert bits(run_work(Logistic(), store=store)) == bits(run_work(Logistic()))


def test_ctrl_c_is_quick(tmp_path: Path) -> None:
    """Ctrl-C in the middle of a block of minutes ends the study in a fraction of a second."""
    pressed: list[float] = []

    def press() -> None:
        pressed.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    threading.Timer(0.3, press).start()
    with pytest.raises(Stopped, match="0 of 60 variants are in"):
        run_work(Logistic(pause=10), store=tmp_path / "study.zarr", block=30)
    assert time.perf_counter() - pressed[0] < 2.0  # 0.2 s where nothing else runs
    threading.Timer(0.3, press).start()
    with pytest.raises(Stopped, match="which are lost"):
        run_work(Logistic(pause=10))


def test_ctrl_c_between_blocks(tmp_path: Path) -> None:
    """Ctrl-C while a result is being kept keeps it, and a later study is not stopped by it."""
    with pytest.raises(KeyboardInterrupt):
        run_work(Logistic(), store=tmp_path / "study.zarr", block=5, progress=_press_once())
    assert 0 < progress_of(tmp_path / "study.zarr").done < 60
    run_work(Logistic(), store=tmp_path / "study.zarr")
    assert progress_of(tmp_path / "study.zarr").done == 60


def _press_once() -> Callable[[int, int], object]:
    return lambda done, total: os.kill(os.getpid(), signal.SIGINT) if done == 20 else None


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_ctrl_c_in_a_callback_of_the_garbage_collector(tmp_path: Path) -> None:
    """Ctrl-C stops a study even where Python discards the exception, and does not stop a later one."""

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
    """While a process writes to a store another is refused, which names it; its lock ends with it."""
    store = tmp_path / "study.zarr"
    process = start(store, pause=0.06)
    wait_for(has_begun(store, 5))
    with pytest.raises(rb.StoreError, match=rf"is being written by process {process.pid} on "):
        run_work(Logistic(), store=store)
    assert open_study(store).sizes["gap"] == 6
    process.kill()
    process.communicate()
    assert bits(run_work(Logistic(), store=store)) == bits(run_work(Logistic()))
