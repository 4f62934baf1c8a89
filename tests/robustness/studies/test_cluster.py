"""Studies on a Dask cluster: a local one, and a scheduler with workers started by command line, one of them killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cloudpickle  # type: ignore[import-untyped]
import dask
import pytest
import xarray as xr
from distributed import Client, LocalCluster

import rattlebox as rb
from rattlebox.core.choose import choice, supported
from rattlebox.studies.runner import Stopped, run_work
from rattlebox.studies.stored import progress_of

from . import fake
from .fake import Logistic

EXAMPLE = Path(__file__).parents[3] / "examples" / "steel_ball.toml"

for module in (fake, sys.modules[__name__]):  # workers cannot import the tests
    cloudpickle.register_pickle_by_value(module)


def bits(data: xr.Dataset) -> dict[str, bytes]:
    """Every variable to the last bit."""
    return {str(name): values.values.tobytes() for name, values in data.data_vars.items()}


@contextmanager
def program(*arguments: str, **environment: str) -> Iterator[subprocess.Popen[bytes]]:
    """Start a program of Dask on the loopback; end it after use."""
    command = [sys.executable, "-m", f"distributed.cli.{arguments[0]}", *arguments[1:]]
    command += ["--host", "127.0.0.1", "--no-dashboard", "--dashboard-address", "127.0.0.1:0"]
    environment["DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT"] = "3s"  # tries the dead for so long
    quiet = subprocess.DEVNULL
    with subprocess.Popen(command, stdout=quiet, stderr=quiet, env=os.environ | environment) as process:
        try:
            yield process
        finally:
            process.kill()


@contextmanager
def worker(scheduler: Path, **environment: str) -> Iterator[subprocess.Popen[bytes]]:
    """Start a worker that nobody starts again."""
    options = ["--scheduler-file", str(scheduler), "--nthreads", "1", "--no-nanny", "--death-timeout", "20"]
    with program("dask_worker", *options, **environment) as process:
        yield process


@contextmanager
def running_scheduler(folder: Path, **environment: str) -> Iterator[tuple[Path, subprocess.Popen[bytes]]]:
    """Start a scheduler; give the file that says where it listens."""
    file = folder / "scheduler.json"
    with program("dask_scheduler", "--port", "0", "--scheduler-file", str(file), **environment) as process:
        wait_for(file.exists)
        yield file, process


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """File that says where a scheduler listens."""
    with running_scheduler(tmp_path_factory.mktemp("scheduler")) as (file, _):
        yield file


def wait_for(condition: Callable[[], bool]) -> None:
    """Wait until something is so."""
    until = time.monotonic() + 30
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.01)


def test_a_worker_is_killed_in_the_middle(scheduler: Path, tmp_path: Path) -> None:
    """When one of two workers dies with a block half done, the result is complete and has the bits of this process."""

    def kill(done: int, total: int) -> None:
        if done >= 20 and first.poll() is None:
            first.kill()

    with worker(scheduler) as first, worker(scheduler) as second, Client(scheduler_file=str(scheduler)) as client:
        client.wait_for_workers(2, timeout=30)
        assert set(client.run(os.getpid).values()) == {first.pid, second.pid}
        slow = Logistic(pause=0.02)
        result = run_work(slow, backend=client, store=tmp_path / "study.zarr", block=3, progress=kill)
        assert first.poll() is not None
        assert len(client.scheduler_info()["workers"]) == 1
    assert bits(result) == bits(run_work(Logistic()))


@pytest.fixture(scope="module")
def local() -> Iterator[Client]:
    """Client of a cluster of processes on this machine."""
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster) as client,
    ):
        yield client


def test_a_local_cluster(local: Client) -> None:
    """A cluster of processes gives the bits of this process; blocks are chosen by time, and a fault arrives as it is."""
    result = run_work(Logistic(), backend=local)
    assert bits(result) == bits(run_work(Logistic()))
    with pytest.raises(ZeroDivisionError, match="a fault in the task"):
        run_work(Logistic(broken=True), backend=local, block=20)


def last_speed(run: rb.Run) -> float:
    """Approach speed of the last impact [m/s]."""
    return float(run.impacts.approach_speed[-1])


def test_a_measure_of_ones_own(local: Client) -> None:
    """A function of a Run travels to the workers with its study and gives the bits of this process."""
    case = rb.Case.from_file(EXAMPLE)
    axes = {"damper.start": rb.linspace(-0.5, 0.5, 5)}
    result = rb.sweep(case, axes, [last_speed, "impacts"], backend=local)
    here = rb.sweep(case, axes, [last_speed, "impacts"])
    assert bits(result) == bits(here)
    damper = case.dampers[0].model_copy(update={"start": -0.25})
    assert float(here.last_speed[1]) == last_speed(rb.simulate(case.model_copy(update={"dampers": (damper,)})))


def test_particles_in_space(local: Client) -> None:
    """Runs of particles on workers are those at home, functions of a run included."""
    case = rb.Case.from_file(EXAMPLE.with_name("steel_balls_in_a_box.toml"))
    short = case.model_copy(update={"duration": 0.01, "output": rb.Output()})
    axes = {"damper.contact.restitution": [0.5, 0.7, 0.9]}
    here = rb.sweep(short, axes, ["impact_share", spins], progress=False)
    there = rb.sweep(short, axes, ["impact_share", spins], backend=local, progress=False)
    assert bits(here) == bits(there)
    assert (here.status == 0).all()


def spins(run: rb.Run) -> float:
    """Return the energy of all spins at the end."""
    return float(run.arrays.rotation_energy[-1].sum())  # type: ignore[attr-defined]


def test_ready_maps(local: Client) -> None:
    """Maps that are made of independent runs, and trials of a design, have the bits of this process on a cluster."""
    case = rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz")),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="10 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        duration="1 s",
        method=rb.Newton(),
    )
    starts = {"damper.start": rb.linspace(-1, 1, 5)}
    gaps = {"damper.gap": ("0.5 mm", "5 mm")}
    maps: list[Callable[[Any], xr.Dataset]] = [
        lambda backend: rb.bifurcation(
            case, "damper.gap", [1e-3, 2e-3], cycles=(20, 8), direction="fresh", backend=backend
        ),
        lambda backend: rb.basins(case, starts, cycles=(20, 8), backend=backend),
        lambda backend: rb.lyapunov(case, starts, cycles=(20, 8), pairs=2, backend=backend),
        lambda backend: rb.loss_map(case, ["1 mm", "2 mm"], [10.0], cycles=(10, 10), backend=backend),
        lambda backend: rb.sensitivity(case, gaps, "reduced_loss", 8, cycles=(10, 10), backend=backend),
        lambda backend: rb.design(
            case, gaps, {"reduced_loss": "max"}, starts=3, cycles=(10, 10), trials=3, backend=backend
        ),
    ]
    for made in maps:
        there, here = (made(on).drop_vars("case", errors="ignore") for on in (local, "threads"))  # texts have no bits
        assert bits(there) == bits(here)


def test_ctrl_c_stops_the_workers_too(scheduler: Path, tmp_path: Path) -> None:
    """Ctrl-C in the middle of blocks of minutes ends the study at once, and the workers are free for the next one."""
    pressed: list[float] = []

    def press() -> None:
        pressed.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    def busy(dask_worker: Any) -> int:
        return len(dask_worker.active_threads)

    with worker(scheduler), Client(scheduler_file=str(scheduler)) as client:
        client.wait_for_workers(1, timeout=30)
        threading.Timer(1.0, press).start()
        with pytest.raises(Stopped, match="0 of 60 variants are in"):
            run_work(Logistic(pause=10), backend=client, store=tmp_path / "study.zarr", block=10)
        assert time.perf_counter() - pressed[0] < 2.0
        wait_for(lambda: sum(client.run(busy).values()) == 0)
        run_work(Logistic(), backend=client, store=tmp_path / "study.zarr")
    assert progress_of(tmp_path / "study.zarr").done == 60


@pytest.mark.skipif(len(supported()) < 2, reason="one core was built, which cannot differ from itself")
def test_a_worker_with_other_instructions_is_refused(scheduler: Path) -> None:
    """A worker that would compute other last bits ends the study, naming it and what to set."""
    other = next(level for level in supported() if level != choice()[0])
    with worker(scheduler, RATTLEBOX_SIMD=other), Client(scheduler_file=str(scheduler)) as client:
        client.wait_for_workers(1, timeout=30)
        with pytest.raises(rb.ResourceError, match=rf"{other} instructions, the study .* {choice()[0]} instructions"):
            run_work(Logistic(), backend=client, block=20)


def test_a_block_that_kills_its_worker(tmp_path: Path) -> None:
    """A study whose block ends one worker after another gives up with a hint."""
    with (
        running_scheduler(tmp_path, DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="1") as (file, _),
        worker(file),
        worker(file),
        Client(scheduler_file=str(file)) as client,
    ):
        client.wait_for_workers(2, timeout=30)
        with pytest.raises(rb.ResourceError, match="2 workers in turn ended"):
            run_work(Logistic(deadly=True), backend=client, block=60)


def test_the_scheduler_dies(tmp_path: Path) -> None:
    """Without its scheduler a study ends with what it has on disk, and goes on elsewhere."""
    store = tmp_path / "study.zarr"
    with (
        dask.config.set({"distributed.comm.timeouts.connect": "1s"}),
        running_scheduler(tmp_path) as (file, process),
        worker(file),
        Client(scheduler_file=str(file)) as client,
    ):

        def kill(done: int, total: int) -> None:
            if done >= 20:
                process.kill()

        with pytest.raises(rb.ResourceError, match="the cluster is lost"):
            run_work(Logistic(pause=0.02), backend=client, store=store, block=3, progress=kill)
    assert 20 <= progress_of(store).done < 60
    assert bits(run_work(Logistic(), store=store)) == bits(run_work(Logistic()))
