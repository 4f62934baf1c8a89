"""Studies on processes of this machine: the same bits, a function of a Run, a process that dies, and Ctrl-C."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from pathlib import Path

import cloudpickle  # type: ignore[import-untyped]
import pytest
import xarray as xr

import rattlebox as rb
from rattlebox.studies.runner import Stopped, run_work
from rattlebox.studies.stored import progress_of

from . import fake
from .fake import Logistic

for module in (fake, sys.modules[__name__]):  # worker processes cannot import the tests
    cloudpickle.register_pickle_by_value(module)


def bits(data: xr.Dataset) -> dict[str, bytes]:
    """Return every variable to the last bit."""
    return {str(name): values.values.tobytes() for name, values in data.data_vars.items()}


def mean_speed(run: rb.Run) -> float:
    """Return a measure of a user, which refuses to run in the process of the test."""
    assert os.getpid() != PROCESS
    return float(run.arrays.velocity.mean())


PROCESS = os.getpid()


def test_processes_give_the_bits_of_threads(tmp_path: Path) -> None:
    """A study on processes, with a store, has the bits of one on threads."""
    result = run_work(Logistic(), backend="processes", workers=2, store=tmp_path / "study.zarr", progress=False)
    assert bits(result) == bits(run_work(Logistic(), progress=False))


def test_kinds_run_on_processes(tmp_path: Path) -> None:
    """A function of a Run is called in other processes; a continuation with a store has the bits of one on a thread."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="10 mm", material="steel"), gap="1 mm", velocity=0.1, contact=rb.Tsuji(restitution=0.6)
    )
    motion = rb.Harmonic(amplitude="1 mm", frequency="10 Hz")
    case = rb.Case(structure=rb.Shaker(motion=motion), damper=damper, duration="1 s", method=rb.Newton())
    result = rb.sweep(case, {"damper.gap": [1e-3, 2e-3]}, mean_speed, backend="processes", workers=2, progress=False)
    assert result.mean_speed.notnull().all()
    arguments = case, "damper.gap", [1e-3, 2e-3]
    store = tmp_path / "diagram.zarr"
    there = rb.bifurcation(*arguments, cycles=(20, 8), backend="processes", workers=2, store=store, progress=False)
    assert bits(there) == bits(rb.bifurcation(*arguments, cycles=(20, 8), progress=False))


def test_errors_of_processes_are_reported(tmp_path: Path) -> None:
    """An error of a block arrives as it is; a process that dies ends the study with advice, and the store resumes."""
    with pytest.raises(ZeroDivisionError, match="a fault in the task"):
        run_work(Logistic(broken=True), backend="processes", workers=2, progress=False)
    store = tmp_path / "study.zarr"
    with pytest.raises(rb.ResourceError, match="a worker process ended before its block was computed\n  try: "):
        run_work(Logistic(deadly=True), backend="processes", workers=2, store=store, block=60, progress=False)
    assert progress_of(store).done == 0
    assert bits(run_work(Logistic(), store=store, progress=False)) == bits(run_work(Logistic(), progress=False))


def test_ctrl_c_stops_processes() -> None:
    """Ctrl-C in the middle of a block ends the study at once."""
    pressed: list[float] = []

    def press() -> None:
        pressed.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    threading.Timer(0.3, press).start()
    with pytest.raises(Stopped, match="0 of 60 variants"):
        run_work(Logistic(pause=10), backend="processes", workers=2, progress=False)
    assert time.perf_counter() - pressed[0] < 5


def test_backends_are_named() -> None:
    """Backends that do not exist are refused with those that do."""
    for wrong in ("thread", 3, None):
        with pytest.raises(rb.CaseError, match="is not a backend"):
            run_work(Logistic(), backend=wrong)
