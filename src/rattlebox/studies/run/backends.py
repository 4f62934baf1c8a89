"""Backends that run blocks of a study on threads, processes or a Dask cluster, and the predicted cost of studies."""

from __future__ import annotations

import math
import os
import pickle
import signal
import threading
import time
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib import import_module
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, TypeVar

import numpy as np

from rattlebox._util.exceptions import CaseError, RattleboxError, ResourceError
from rattlebox._util.interrupts import StoppableCalls, raise_if_pressed
from rattlebox.engines.dem import simulate_dem
from rattlebox.model.errors import Hint
from rattlebox.prepare.particles import count_steps, settle_all
from rattlebox.studies.work.work import Block, Cancelled, Chain, Values, Work

if TYPE_CHECKING:
    from rattlebox.model.case import Case


Results = Generator[tuple[Block, Values]]
"""Blocks with their outputs, in the order in which they finish. Closing the generator stops the rest."""

Pool = TypeVar("Pool", bound=Executor)

_POLL = 0.05  # s, the longest wait in which Ctrl-C has no effect


class Backend(Protocol):
    """Interface of the backends."""

    def run(self, work: Work, chains: Sequence[Chain]) -> Results:
        """Run the blocks of several chains: chains in parallel, the blocks of each chain in order."""


def make_backend(backend: object = "threads", workers: int | None = None) -> Backend:
    """Return the backend for the arguments of a study."""
    if backend == "threads":
        return Threads(workers or cores())
    if backend == "processes":
        return Processes(workers or cores())
    if not hasattr(backend, "nthreads"):
        raise Hint(
            f"backend = {backend!r} is not a backend",
            '"threads", "processes" or distributed.Client(...)',
        )
    if workers is not None:
        raise Hint(
            f"workers = {workers} cannot be set for a Dask cluster, which has its own",
            "leave it out, or scale the cluster",
        )
    return DaskCluster(backend)


def cores() -> int:
    """Return the number of processor cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not available on every system
        return os.cpu_count() or 1


def wait_for(future: Future[Any]) -> Any:
    """Return the result of a future; unlike `future.result()`, Ctrl-C interrupts the wait on every system."""
    while not wait([future], timeout=_POLL).done:
        raise_if_pressed()
    return future.result()


# ---- this machine


@dataclass(frozen=True)
class Threads:
    """Threads of this process, which run in parallel because the core releases the interpreter lock."""

    count: int

    def run(self, work: Work, chains: Sequence[Chain]) -> Results:
        """Run blocks; see `Backend.run`."""
        parallel, calls = max(1, min(self.count, len(chains))), StoppableCalls()

        def submit(block: Block, before: Values | None) -> Future[Values | None]:
            def run() -> Values | None:
                return work.run(block, before, threads=self.count // parallel, cancelled=calls.is_stopped)

            return pool.submit(calls.call, run)

        with _cancel_on_exit(ThreadPoolExecutor(parallel), calls.stop) as pool:
            yield from _run_chains(work, chains, parallel, submit)


@dataclass(frozen=True)
class Processes:
    """Processes of this machine, for measures in Python, which do not run in parallel threads."""

    count: int

    def run(self, work: Work, chains: Sequence[Chain]) -> Results:
        """Run blocks; see `Backend.run`."""
        parallel = max(1, min(self.count, len(chains)))
        # A fork of a process with threads may deadlock.
        context = get_context("spawn")
        running, stop = context.Pipe(duplex=False)
        pool = ProcessPoolExecutor(parallel, context, _start_process, (_pickled(work), running))
        try:
            with _cancel_on_exit(pool, stop.close):
                yield from _run_chains(
                    work, chains, parallel, lambda block, before: pool.submit(_run_in_process, block, before)
                )
        except BrokenProcessPool:
            raise ResourceError(
                "a worker process ended before its block was computed",
                'in a script, the call below `if __name__ == "__main__":`; if memory is short, fewer workers',
            ) from None


def _pickled(work: Work) -> bytes:
    """Return the pickled work; functions of a notebook require cloudpickle, which Dask installs."""
    with suppress(ImportError):
        content: bytes = import_module("cloudpickle").dumps(work)
        return content
    try:
        return pickle.dumps(work)
    except (pickle.PicklingError, AttributeError) as error:
        raise CaseError(
            f"a function cannot be sent to other processes: {error}",
            "define it at the top level of a module, or pip install cloudpickle",
        ) from None


_process_work: Work  # work of this worker process


def _start_process(content: bytes, running: Connection) -> None:
    """Prepare a worker process."""
    global _process_work
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # all processes receive Ctrl-C; only the parent handles it
    threading.Thread(target=_exit_at_end_of, args=[running], daemon=True).start()
    _process_work = pickle.loads(content)


def _exit_at_end_of(running: Connection) -> None:
    """Exit this process when the other end of a pipe closes, because the study stopped or its process ended."""
    with suppress(EOFError, OSError):
        running.recv()
    os._exit(1)


def _run_in_process(block: Block, before: Values | None) -> Values | None:
    values = _process_work.run(block, before, threads=1, cancelled=None)
    return None if values is None else dict(values)


@contextmanager
def _cancel_on_exit(pool: Pool, stop: Callable[[], None]) -> Iterator[Pool]:
    """Cancel the work of a pool on exit, without waiting for it."""
    try:
        yield pool
    finally:
        stop()
        pool.shutdown(wait=False, cancel_futures=True)


def _run_chains(
    work: Work,
    chains: Sequence[Chain],
    parallel: int,
    submit: Callable[[Block, Values | None], Future[Values | None]],
) -> Results:
    """Run chains on a pool, `parallel` of them at a time; each worker starts its next block before a result is yielded."""
    waiting = deque(chains)
    running: dict[Future[Values | None], deque[Block]] = {}

    def start(blocks: deque[Block], before: Values | None) -> None:
        running[submit(blocks[0], before)] = blocks

    def start_chain() -> None:
        if waiting:
            chain = waiting.popleft()
            start(deque(chain.blocks), chain.before)

    for _ in range(parallel):
        start_chain()
    while running:
        raise_if_pressed()
        for future in wait(running, timeout=_POLL, return_when=FIRST_COMPLETED).done:
            blocks, values = running.pop(future), _complete(future.result())
            block = blocks.popleft()
            if blocks:
                start(blocks, work.last_values(block, values))
            else:
                start_chain()
            yield block, values


def _complete(values: Values | None) -> Values:
    if values is None:
        raise RuntimeError("a block was cancelled although the study was not")
    return values


# ---- a cluster


@dataclass(frozen=True)
class DaskCluster:
    """Workers of a Dask cluster, one thread per block. If a worker ends, its blocks run again on others."""

    client: Any

    def run(self, work: Work, chains: Sequence[Chain]) -> Results:
        """Run blocks; see `Backend.run`."""
        client, dask, cloudpickle = self.client, import_module("distributed"), import_module("cloudpickle")
        disconnected = import_module("distributed.comm").CommClosedError
        with warnings.catch_warnings():
            # Scattered data would be lost with the worker that holds it; a submitted task is run again.
            warnings.filterwarnings("ignore", "Sending large graph")
            shared = client.submit(pickle.loads, cloudpickle.dumps(work), pure=False)
        blocks: dict[Any, Block] = {}
        for chain in chains:
            before: Any = chain.before
            previous: Block | None = None
            for block in chain.blocks:
                future = client.submit(
                    _run_on_worker, shared, block, before, previous, bits(), pure=False, priority=-len(blocks)
                )
                blocks[future] = block
                before, previous = future, block
        try:
            for future in dask.as_completed(list(blocks)):
                values = future.result()
                yield blocks.pop(future), _complete(values)
        except dask.KilledWorker as error:
            raise ResourceError(
                f"{error.allowed_failures + 1} workers in turn ended while they ran the same block",
                "workers with more memory, or smaller blocks",
            ) from None
        except (dask.CancelledError, disconnected) as error:
            raise ResourceError(f"the cluster is lost: {error}", "check that its scheduler is running") from None
        finally:
            with suppress(disconnected):
                client.cancel([shared, *blocks], force=True)


def bits() -> str:
    """Return version and instruction set, on which the last bits of results depend."""
    from rattlebox import __version__
    from rattlebox.core.choose import instructions

    return f"Rattlebox {__version__} and {instructions()} instructions"


def _run_on_worker(work: Work, block: Block, before: Values | None, previous: Block | None, expected: str) -> Any:
    """Run a block on a Dask worker; `before` holds the outputs of the previous block, or of the variant before the chain."""
    worker: Any = import_module("distributed").get_worker()
    if bits() != expected:
        raise ResourceError(
            f"the worker {worker.address} has {bits()}, the study {expected}; the results would differ",
            "the same version, and the same RATTLEBOX_SIMD in the environment of all workers",
        )
    tasks, key = worker.state.tasks, worker.get_current_task()
    if before is not None and previous is not None:
        before = work.last_values(previous, before)
    cancelled: Cancelled = lambda: key not in tasks or tasks[key].state == "cancelled"  # noqa: E731
    return work.run(block, before, threads=1, cancelled=cancelled)


# ---- predicted cost


TIMED = 1.0
"""Processor time for which a run is timed [s]."""
TRIAL = 0.03
"""Time of a trial of a design besides its runs [s]."""
SETTLING = 10.0
"""Longest time for which the settling of a bed is timed, except that of the smallest one [s]."""


@dataclass(frozen=True)
class Budget:
    """Predicted cost of a study."""

    trials: int
    runs: int
    cpu_time: float  # Processor time [s]
    wall_time: float  # Wall time on the workers of the study [s]
    workers: int

    def __str__(self) -> str:
        return (
            f"{self.trials:,} trials, {self.runs:,} runs: about {duration(self.cpu_time)} of processor time, "
            f"{duration(self.wall_time)} with {self.workers} worker{'s' * (self.workers != 1)}"
        )


class RunGroup(NamedTuple):
    """Runs that cost about as much as each other."""

    case: Case
    runs: float
    settlings: float
    particles: int
    steps: int

    @classmethod
    def of(cls, case: Case, runs: float, settlings: float) -> RunGroup | None:
        """Return a group; None if the case cannot run."""
        particles = sum(int(damper.contents.radius.size) for damper in case.particle_dampers)
        try:
            return cls(case, runs, min(runs, settlings), particles, count_steps(case))
        except RattleboxError:  # such a run has the status "refused"
            return None


class _Timed(NamedTuple):
    """Cost of a run."""

    particles: int
    steps: int
    settling: float  # Processor time in which the beds settle [s]
    setup: float  # Other processor time before the first step and after the last [s]
    stepping: float  # Processor time of all steps [s]
    share: float


def duration(seconds: float) -> str:
    """Return a time with a unit from seconds to hours, with two digits."""
    for unit, size in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 1.95 * size:
            return f"{_two_digits(seconds / size)} {unit}"
    return f"{_two_digits(seconds)} s"


def _two_digits(value: float) -> str:
    return f"{value:,.0f}" if value >= 9.5 else f"{value:.2g}"


def time_of_particle_runs(groups: Sequence[RunGroup]) -> tuple[list[float], float]:
    """Predict the processor time of groups of particle runs.

    Returns processor time of all runs of each group [s].

    Notes
    -----
    The runs with the fewest and with the most particles are timed: the settling of their beds, and up to a second of
    their steps, whose latest rate is extrapolated. The time of a step of another run is interpolated over the number of
    particles, and the number of its steps is computed exactly. The prediction is accurate to a factor of about 1.5.
    """
    # Two timed runs suffice: the time of a step depends on the number of particles, the number of steps is known.
    order = sorted(groups, key=lambda group: group.particles)
    smallest = next((timed for group in order if (timed := _time_run(group, math.inf))), None)
    if smallest is None:
        return [0.0] * len(groups), 1.0
    largest = _time_run(order[-1], SETTLING) if order[-1].particles > smallest.particles else None
    known = [smallest, largest] if largest else [smallest]
    particles = [each.particles for each in known]
    times = []
    for group in groups:
        beyond = max(
            1.0, group.particles / particles[-1]
        )  # if the settling of the largest bed was too long to be timed
        settling, setup, step = (
            float(np.interp(group.particles, particles, costs)) * beyond
            for costs in zip(*((each.settling, each.setup, each.stepping / each.steps) for each in known), strict=True)
        )
        times.append(group.settlings * settling + group.runs * (setup + step * group.steps))
    return times, min(each.share for each in known)


def _time_run(group: RunGroup, limit: float) -> _Timed | None:
    """Return the cost of a run of a group; None if its bed does not settle, or not within a limit [s]."""
    begun = time.monotonic()
    before = time.process_time()
    try:
        if not settle_all(group.case, lambda: time.monotonic() < begun + limit):
            return None
    except RattleboxError:
        return None
    settling = time.process_time() - before
    done: list[tuple[float, int]] = []  # processor time and number of steps

    def proceed(steps: int, total: int) -> bool:
        done.append((time.process_time(), steps))
        return done[-1][0] < done[0][0] + TIMED

    run = simulate_dem(group.case, threads=1, progress=proceed)
    used, passed = time.process_time() - before, time.monotonic() - begun
    reached = max(1, int(run.counts["steps"]))
    stepping = min(used - settling, run.wall_time)
    # The first steps of a bed are faster or slower than the later ones: extrapolate the second half.
    rate = stepping / reached
    if len(done) > 1 and done[-1][1] > (half := min(done, key=lambda each: abs(each[1] - reached / 2)))[1]:
        rate = (done[-1][0] - half[0]) / (done[-1][1] - half[1])
    rest = rate * max(0, group.steps - reached)
    setup = max(0.0, used - settling - stepping)
    return _Timed(group.particles, group.steps, settling, setup, stepping + rest, min(1.0, used / passed))


def workers_of(backend: Any, workers: int | None) -> int:
    """Return the number of workers of a backend; see `make_backend`."""
    if isinstance(backend, str):
        return workers or cores()
    return sum(backend.nthreads().values())
