"""Studies on processes of this machine: bits, functions of a Run, crashes and Ctrl-C."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import cloudpickle  # type: ignore[import-untyped]
import pytest
from support import logistic_study
from support.ctrl_c import CtrlC
from support.datasets import bits
from support.logistic_study import Logistic

import rattlebox as rb
from rattlebox.studies.run.runner import Stopped, run_work
from rattlebox.studies.run.stored import progress_of

for module in (logistic_study, sys.modules[__name__]):  # worker processes cannot import the tests
    cloudpickle.register_pickle_by_value(module)


def mean_speed(run: rb.Run) -> float:
    """Return the mean velocity; fail in the process of the test."""
    assert os.getpid() != PROCESS
    return float(run.arrays.velocity.mean())


PROCESS = os.getpid()


def test_processes_give_the_bits_of_threads(tmp_path: Path) -> None:
    """A study on processes, with a store, has the bits of one on threads."""
    result = run_work(Logistic(), backend="processes", workers=2, store=tmp_path / "study.zarr", progress=False)
    assert bits(result) == bits(run_work(Logistic(), progress=False))


def test_functions_and_continuations_run_on_processes(tmp_path: Path) -> None:
    """A function of a Run is called in other processes; a continuation with a store has the bits of one thread."""
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
    """An error of a block is raised unchanged; a crashed process ends the study with advice, and the store resumes."""
    with pytest.raises(ZeroDivisionError, match="an error of the task"):
        run_work(Logistic(fail=True), backend="processes", workers=2, progress=False)
    store = tmp_path / "study.zarr"
    with pytest.raises(rb.ResourceError, match="a worker process ended before its block was computed\n  try: "):
        run_work(Logistic(crash=True), backend="processes", workers=2, store=store, block=60, progress=False)
    assert progress_of(store).done == 0
    assert bits(run_work(Logistic(), store=store, progress=False)) == bits(run_work(Logistic(), progress=False))


def test_ctrl_c_stops_processes() -> None:
    """Ctrl-C during a block ends the study at once."""
    with CtrlC(0.3) as ctrl_c, pytest.raises(Stopped, match="0 of 60 variants"):
        run_work(Logistic(pause=10), backend="processes", workers=2, progress=False)
    assert ctrl_c.elapsed() < 5


def test_unknown_backends_are_refused() -> None:
    """An unknown backend is refused with the known ones."""
    for wrong in ("thread", 3, None):
        with pytest.raises(rb.CaseError, match="is not a backend"):
            run_work(Logistic(), backend=wrong)
