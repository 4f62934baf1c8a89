"""Studies on a Dask cluster, local or with workers from the command line, one of which is killed."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cloudpickle  # type: ignore[import-untyped]
import dask
import pytest
import xarray as xr
from distributed import Client, LocalCluster
from support import logistic_study
from support.ctrl_c import CtrlC
from support.dask_programs import running_scheduler, worker
from support.datasets import bits
from support.logistic_study import Logistic
from support.waiting import wait_for

import rattlebox as rb
from rattlebox.core.choose import choice, supported
from rattlebox.studies.run.runner import Stopped, run_work
from rattlebox.studies.run.stored import progress_of

EXAMPLE = Path(__file__).parents[3] / "examples" / "steel_ball.toml"

for module in (logistic_study, sys.modules[__name__]):  # workers cannot import the tests
    cloudpickle.register_pickle_by_value(module)


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Yield the file with the address of a running scheduler."""
    with running_scheduler(tmp_path_factory.mktemp("scheduler")) as (file, _):
        yield file


def test_killed_worker(scheduler: Path, tmp_path: Path) -> None:
    """If one of two workers is killed during a block, the result is complete and has the bits of this process."""

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
    """Return the client of a cluster of processes on this machine."""
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster) as client,
    ):
        yield client


def test_local_cluster(local: Client) -> None:
    """A cluster of processes gives the bits of this process; an error of the task is raised unchanged."""
    result = run_work(Logistic(), backend=local)
    assert bits(result) == bits(run_work(Logistic()))
    with pytest.raises(ZeroDivisionError, match="an error of the task"):
        run_work(Logistic(fail=True), backend=local, block=20)


def last_speed(run: rb.Run) -> float:
    """Return the approach speed of the last impact [m/s]."""
    return float(run.impacts.approach_speed[-1])


def test_measure_of_a_user(local: Client) -> None:
    """A function of a Run is sent to the workers with its study and gives the bits of this process."""
    case = rb.Case.from_file(EXAMPLE)
    axes = {"damper.start": rb.linspace(-0.5, 0.5, 5)}
    result = rb.sweep(case, axes, [last_speed, "impacts"], backend=local)
    here = rb.sweep(case, axes, [last_speed, "impacts"])
    assert bits(result) == bits(here)
    damper = case.dampers[0].model_copy(update={"start": -0.25})
    assert float(here.last_speed[1]) == last_speed(rb.simulate(case.model_copy(update={"dampers": (damper,)})))


def test_particle_runs(local: Client) -> None:
    """Runs of particles on workers, with a function of the run as measure, have the bits of this process."""
    case = rb.Case.from_file(EXAMPLE.with_name("steel_balls_in_a_box.toml"))
    short = case.model_copy(update={"duration": 0.01, "output": rb.Output()})
    axes = {"damper.contact.restitution": [0.5, 0.7, 0.9]}
    here = rb.sweep(short, axes, ["impact_share", spin_energy], progress=False)
    there = rb.sweep(short, axes, ["impact_share", spin_energy], backend=local, progress=False)
    assert bits(here) == bits(there)
    assert (here.status == 0).all()


def test_stepped_sines_of_particles(local: Client) -> None:
    """The state of the particles travels from one frequency to the next between workers, with the bits of this process."""
    case = rb.Case.from_file(EXAMPLE.with_name("steel_balls_in_a_box.toml")).model_copy(
        update={"loads": (rb.Harmonic(amplitude="500 N", frequency="10 Hz", unit="N"),), "output": rb.Output()}
    )
    options: dict[str, Any] = {"cycles": (0, 1), "samples": 16, "progress": False}
    here, there = (
        rb.frequency_response(case, [10.0, 12.0], direction="up", backend=backend, **options)
        for backend in ("threads", local)
    )
    assert bits(here.drop_vars("direction")) == bits(there.drop_vars("direction"))
    assert (here.status == 0).all()


def spin_energy(run: rb.Run) -> float:
    """Return the rotational energy of all particles at the end [J]."""
    return float(run.arrays.rotation_energy[-1].sum())  # type: ignore[attr-defined]


def test_all_kinds_of_studies(local: Client) -> None:
    """Studies of independent runs and the trials of a design have the bits of this process on a cluster."""
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
    for study in maps:
        there, here = (study(on).drop_vars("case", errors="ignore") for on in (local, "threads"))  # texts have no bits
        assert bits(there) == bits(here)


def test_ctrl_c_stops_the_workers(scheduler: Path, tmp_path: Path) -> None:
    """Ctrl-C during blocks of minutes ends the study at once, and the workers are free for the next one."""

    def busy(dask_worker: Any) -> int:
        return len(dask_worker.active_threads)

    with worker(scheduler), Client(scheduler_file=str(scheduler)) as client:
        client.wait_for_workers(1, timeout=30)
        with CtrlC(1.0) as ctrl_c, pytest.raises(Stopped, match="0 of 60 variants are in"):
            run_work(Logistic(pause=10), backend=client, store=tmp_path / "study.zarr", block=10)
        assert ctrl_c.elapsed() < 2.0
        wait_for(lambda: sum(client.run(busy).values()) == 0)
        run_work(Logistic(), backend=client, store=tmp_path / "study.zarr")
    assert progress_of(tmp_path / "study.zarr").done == 60


@pytest.mark.skipif(len(supported()) < 2, reason="one core was built, which cannot differ from itself")
def test_worker_with_another_instruction_set_is_refused(scheduler: Path) -> None:
    """A worker with another instruction set, and so other last bits, ends the study with what to set."""
    other = next(level for level in supported() if level != choice()[0])
    with worker(scheduler, RATTLEBOX_SIMD=other), Client(scheduler_file=str(scheduler)) as client:
        client.wait_for_workers(1, timeout=30)
        with pytest.raises(rb.ResourceError, match=rf"{other} instructions, the study .* {choice()[0]} instructions"):
            run_work(Logistic(), backend=client, block=20)


def test_block_that_crashes_its_worker(tmp_path: Path) -> None:
    """A block that crashes one worker after another ends the study with a suggestion."""
    with (
        running_scheduler(tmp_path, DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="1") as (file, _),
        worker(file),
        worker(file),
        Client(scheduler_file=str(file)) as client,
    ):
        client.wait_for_workers(2, timeout=30)
        with pytest.raises(rb.ResourceError, match="2 workers in turn ended"):
            run_work(Logistic(crash=True), backend=client, block=60)


@pytest.mark.slow
def test_killed_scheduler(tmp_path: Path) -> None:
    """Without its scheduler a study ends with the blocks that are stored, and resumes on another backend."""
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
