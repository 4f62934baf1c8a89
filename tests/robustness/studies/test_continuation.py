"""Studies with continuation: killed, stopped, and distributed over workers."""

from __future__ import annotations

import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
from distributed import Client
from support.dask_programs import running_scheduler, worker
from support.datasets import bits
from support.logistic_study import variants_in
from support.waiting import wait_for

import rattlebox as rb
from rattlebox.studies.run.runner import Stopped
from rattlebox.studies.run.stored import progress_of

AMPLITUDE = "structure.motion.amplitude"
STUDY = """\
import rattlebox as rb

case = rb.Case(
    structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz")),
    damper=rb.ImpactDamper(
        ball=rb.Sphere(radius="10 mm", material="steel"), gap="1 mm", velocity="0.1 m/s", contact=rb.Tsuji(restitution=0.6)
    ),
    duration="1 s",
    method=rb.Newton(),
)
values = rb.linspace("0.5 mm", "2.5 mm", 60)
"""
KILLED = (
    STUDY
    + """
rb.bifurcation(case, "structure.motion.amplitude", values, cycles=(400, 16), store="study.zarr")
"""
)


def diagram(**options: Any) -> xr.Dataset:
    """Return the bifurcation diagram of the study."""
    names: dict[str, Any] = {}
    exec(STUDY, names)
    return rb.bifurcation(
        names["case"], AMPLITUDE, names["values"], cycles=(400, 16), **({"progress": False} | options)
    )


@cache
def uninterrupted() -> dict[str, bytes]:
    """Return the bits of the diagram without a stop."""
    return bits(diagram())


@pytest.mark.parametrize("after", [pytest.param(10, marks=pytest.mark.slow), 70])  # on the way up, and down again
def test_killed_diagram_resumes(after: int, tmp_path: Path) -> None:
    """A diagram that is killed on its way up or down resumes with the bits of an uninterrupted one."""
    store = tmp_path / "study.zarr"
    process = subprocess.Popen([sys.executable, "-c", KILLED], cwd=tmp_path)
    wait_for(lambda: variants_in(store) >= after, pause=0.002)
    assert process.poll() is None
    process.kill()
    process.wait()
    assert after <= progress_of(store).done < 120
    assert bits(diagram(store=store)) == uninterrupted()


def test_resumed_diagram_computes_nothing_twice(tmp_path: Path) -> None:
    """A stopped diagram resumes from its finished points; a finished one computes nothing."""
    store = tmp_path / "study.zarr"

    def press(done: int, total: int) -> None:
        if done > 0:
            raise KeyboardInterrupt

    def again() -> list[int]:
        counts: list[int] = []
        diagram(store=store, progress=lambda n, _: counts.append(n))
        return counts

    with pytest.raises(Stopped, match=r"of 120 variants are in .* and the same command resumes"):
        diagram(store=store, progress=press)
    first = progress_of(store).done
    counts = again()
    assert 0 < counts[0] == first and counts[-1] == 120
    assert again() == [120]


def test_killed_worker(tmp_path: Path) -> None:
    """Sweeps up and down at two levels on two workers, one of which is killed, have the bits of this process."""
    case = rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        load=rb.Harmonic(amplitude="5 N", frequency="30 Hz"),
        duration="1 s",
        method=rb.Newton(),
    )
    options: dict[str, Any] = {"levels": ["5 N", "20 N"], "cycles": (150, 8), "samples": 8}
    frequencies = rb.linspace("28 Hz", "36 Hz", 40)

    def kill(done: int, total: int) -> None:
        if done > 0 and first.poll() is None:
            first.kill()

    with (
        running_scheduler(tmp_path) as (file, _),
        worker(file) as first,
        worker(file),
        Client(scheduler_file=str(file)) as client,
    ):
        client.wait_for_workers(2, timeout=30)
        result = rb.frequency_response(
            case, frequencies, backend=client, store=tmp_path / "study.zarr", progress=kill, **options
        )
        assert first.poll() is not None
    assert bits(result) == bits(rb.frequency_response(case, frequencies, progress=False, **options))
