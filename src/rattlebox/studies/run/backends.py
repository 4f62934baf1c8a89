"""Backends that run blocks of a study on threads, processes or a Dask cluster."""

from __future__ import annotations

import os
import pickle
import signal
import threading
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
from typing import Any, Protocol, TypeVar

from rattlebox._util.exceptions import CaseError, ResourceError
from rattlebox._util.interrupts import StoppableCalls, raise_if_pressed
from rattlebox.model.errors import Hint
from rattlebox.studies.work.work import Block, Cancelled, Chain, Values, Work

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


def workers_of(backend: Any, workers: int | None) -> int:
    """Return the number of workers of a backend; see `make_backend`."""
    if isinstance(backend, str):
        return workers or cores()
    return sum(backend.nthreads().values())


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
