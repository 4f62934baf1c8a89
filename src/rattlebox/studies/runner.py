"""Where a study runs, block by block: threads of this process, or the workers of a Dask cluster."""

from __future__ import annotations

import math
import os
import pickle
import threading
import time
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import ResourceError
from rattlebox._util.progress import progress_bar
from rattlebox.model.errors import Hint

from .blocks import Blocks
from .store import IN_STORE, Memory, Output, Plan, Store

if TYPE_CHECKING:
    import xarray as xr
    from distributed import Client

Values = Mapping[str, NDArray[Any]]
Block = tuple[int, int, int]  # number, first variant, the one after the last

_BLOCKS = 2000  # at most, so that a store of weeks has no millions of files; a stop loses no more than one in so many
_BLOCK_BYTES = 2**27
_HERE_SECONDS = 1.0
_DASK_SECONDS = 5.0
_SHARE = 16  # blocks for each worker of a cluster, at least, unless they would take less than the next
_DASK_LEAST_SECONDS = 0.5


class Task(Protocol):
    """Work on many variants that can be cut anywhere: the bits of a variant depend on nothing but its number."""

    @property
    def size(self) -> int:
        """Number of variants."""

    @property
    def outputs(self) -> Mapping[str, Output]:
        """By name: further dimensions with their lengths, number type, attributes."""

    def describe(self) -> Mapping[str, Any]:
        """What is computed besides the design, in JSON's types: what differs in it is another study."""

    def run(self, start: int, stop: int, *, threads: int, cancelled: Callable[[], bool] | None) -> Values | None:
        """Return each output of variants start to stop, variants first; anything soon after `cancelled`."""


@runtime_checkable
class Chained(Task, Protocol):
    """Work of which each variant goes on from another one, along the last dimension."""

    def chains(self, blocks: Blocks) -> list[list[int]]:
        """Return the numbers of blocks that need each other, in order; chains need nothing of each other."""

    def order(self, start: int, stop: int) -> range:
        """Return variants of a block in the order in which they follow each other."""

    def run(
        self,
        start: int,
        stop: int,
        *,
        threads: int,
        cancelled: Callable[[], bool] | None,
        before: Values | None = None,
    ) -> Values | None:
        """Return each output of variants start to stop; `before` holds those of the one from which they go on."""


class Grid(Protocol):
    """The variants: see Design."""

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the dimensions."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Their lengths."""

    def coords(self) -> Mapping[str, Any]:
        """Coordinates as for a Dataset."""

    def describe(self) -> Mapping[str, Any]:
        """What JSON can hold of it; equal for equal designs."""


class Stopped(KeyboardInterrupt):
    """A study that was stopped by Ctrl-C, with a message that says how to go on."""


def run_work(
    task: Task,
    *,
    design: Grid,
    store: str | os.PathLike[str] | None = None,
    on: Client | None = None,
    threads: int | None = None,
    progress: bool | Callable[[int, int], object] | None = None,
    block: int | None = None,
    coords: Mapping[str, Any] | None = None,
) -> xr.Dataset:
    """Run all variants of a task.

    Parameters
    ----------
    task
        What to compute of each variant.
    design
        The grid of variants.
    store
        Folder on disk for the result, which need not exist. What is finished is there whatever happens, and the same
        call goes on from it.
    on
        Client of a Dask cluster that runs the blocks; default this process.
    threads
        Threads that share a block; default as many as this process may use cores, or one on a cluster.
    progress
        True or False for a bar, default a bar on a terminal; or a function of the number of variants that are there and
        of all.
    block
        Largest number of variants in a block; default so many as take about a second, or five on a cluster.
    coords
        Further coordinates.

    Returns
    -------
    xarray.Dataset
        Each output over the grid and its own dimensions, in memory or, with `store`, opened on disk. The bits
        depend neither on blocks, threads, workers nor on stops.

    Raises
    ------
    CaseError
        When `on` is no Dask client, when the store holds something else or is being written to, or when the cluster fails.
    OSError
        When the store cannot be written.
    Stopped
        After Ctrl-C.
    """
    from rattlebox import __version__

    if on is not None and not hasattr(on, "nthreads"):
        raise Hint(
            f"on = {on!r} is not a client of a Dask cluster",
            "on = distributed.Client(...), or leave it out to run on this machine",
        )
    threads = threads or (1 if on else cores())
    plan = Plan(
        dims=tuple(design.dims),
        shape=tuple(design.shape),
        outputs=task.outputs,
        coords={**design.coords(), **(coords or {})},
        about={**task.describe(), "design": dict(design.describe()), "version": __version__, "core": _core()},
    )

    _check_names(plan)

    def cut() -> Blocks:
        size = (block and _held(block, plan)) or _block_size(
            task, plan, on, 1 if isinstance(task, Chained) else threads
        )
        return Blocks.of(plan.shape, min(size, plan.shape[-1]) if isinstance(task, Chained) else size)

    opened: list[Memory | Store] = []
    try:
        with ExitStack() as stack:
            kept: Memory | Store = Memory(plan, cut()) if store is None else Store(store, plan, cut)
            opened.append(kept)
            stack.enter_context(kept)
            tell = stack.enter_context(progress_bar(progress, task.size))
            keeper = stack.enter_context(ThreadPoolExecutor(1))  # ends what it has begun when Ctrl-C comes
            tell(kept.done)
            todo = _chains(task, kept, plan.dims)
            results = _on_cluster(on, task, todo, threads) if on else _here(task, todo, threads)
            stack.callback(results.close)
            for (number, _, _), values in results:
                _heard(keeper.submit(kept.write, number, values))
                tell(kept.done)
            return kept.result()
    except KeyboardInterrupt:
        raise Stopped(_how_to_go_on(sum(kept.done for kept in opened), task.size, store)) from None


def cores() -> int:
    """Return how many processor cores this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on every system
        return os.cpu_count() or 1


def _core() -> str:
    """Name of the instructions that decide the last bits."""
    from rattlebox.engines.core import instructions

    return instructions()


def _check_names(plan: Plan) -> None:
    inner = {name for extra, _, _ in plan.outputs.values() for name, _ in extra} | {*IN_STORE}
    for name in plan.dims:
        if name in inner or name in plan.outputs:
            raise Hint(f"an axis cannot be called {name}: studies hold something else by that name", "another name")
    for name in plan.outputs:
        if name in inner:
            raise Hint(f"a function cannot be called {name}: studies hold something else by that name", "another name")


def _bits() -> str:
    from rattlebox import __version__

    return f"Rattlebox {__version__} and {_core()} instructions"


def _how_to_go_on(done: int, total: int, store: str | os.PathLike[str] | None) -> str:
    if store is None:
        return f"stopped after {done:,} of {total:,} variants, which are lost; with a store, they would be kept"
    return f"stopped; {done:,} of {total:,} variants are in {os.fspath(store)}, and the same command goes on from there"


# ---- what is to be done


class _Chain(NamedTuple):
    """Blocks that are run one after the other, and what the first of them goes on from."""

    blocks: list[Block]
    before: Values | None = None


def _chains(task: Task, kept: Memory | Store, dims: Sequence[str]) -> list[_Chain]:
    blocks = kept.blocks
    if not isinstance(task, Chained):
        return [_Chain([(number, *blocks.range(number)) for number in np.flatnonzero(~kept.finished).tolist()])]
    found = []
    for numbers in task.chains(blocks):
        done = int(np.argmin([*kept.finished[numbers], False]))
        before = None
        if 0 < done < len(numbers):
            last = np.unravel_index(task.order(*blocks.range(numbers[done - 1]))[-1], blocks.shape)
            there = kept.result().isel(dict(zip(dims, map(int, last), strict=True)))
            before = {str(name): values.values[None] for name, values in there.data_vars.items()}
        found.append(_Chain([(number, *blocks.range(number)) for number in numbers[done:]], before))
    return found


def _end(task: Task, block: Block, values: Values) -> Values | None:
    """What the next block of a chain goes on from."""
    if not isinstance(task, Chained):
        return None
    _, start, stop = block
    last = task.order(start, stop)[-1] - start
    return {name: array[last : last + 1] for name, array in values.items()}


def _from(task: Task, before: Values | None) -> Callable[..., Values | None]:
    return partial(task.run, before=before) if isinstance(task, Chained) else task.run


# ---- how large a block is


def _block_size(task: Task, plan: Plan, on: Any, threads: int) -> int:
    with _aside() as (pool, stop):
        each: float = _heard(pool.submit(_seconds_each, task, stop.is_set))
    if on:
        workers = sum(on.nthreads().values()) or 1
        share = each * task.size / (workers * threads * _SHARE)
        seconds = min(max(share, _DASK_LEAST_SECONDS), _DASK_SECONDS)
    else:
        seconds = _HERE_SECONDS
    least = 4 * threads if threads > 1 else 1  # so that no thread waits long for the others
    size = max(seconds * threads / each, least, task.size / _BLOCKS)
    return _held(math.ceil(size), plan)


def _held(size: int, plan: Plan) -> int:
    """So many variants, or what a block's bytes allow."""
    return max(1, min(size, math.ceil(_BLOCK_BYTES / max(1, plan.bytes_each))))


def _seconds_each(task: Task, cancelled: Callable[[], bool]) -> float:
    """Time a few variants from all over the study on one thread, more of them until it takes long enough to tell."""
    count, chained = 1, isinstance(task, Chained)
    while True:
        starts = np.unique(np.linspace(0, 0 if chained else task.size - count, 4).astype(int))
        begin = time.perf_counter()
        for start in starts.tolist():
            task.run(start, start + count, threads=1, cancelled=_after(begin + 1, cancelled))
        took = time.perf_counter() - begin
        if took > 0.05 or 4 * count >= task.size or cancelled():
            return took / (len(starts) * count)
        count = min(4 * count, task.size)


def _after(end: float, cancelled: Callable[[], bool]) -> Callable[[], bool]:
    return lambda: cancelled() or time.perf_counter() > end


# ---- in this process


@contextmanager
def _aside(count: int = 1) -> Iterator[tuple[ThreadPoolExecutor, threading.Event]]:
    """Threads beside the one that hears Ctrl-C; what runs there is told to stop on leaving, however that happens."""
    stop = threading.Event()
    with ThreadPoolExecutor(count) as pool:
        try:
            yield pool, stop
        finally:
            stop.set()
            pool.shutdown(wait=False, cancel_futures=True)


def _heard(future: Future[Any]) -> Any:
    """Wait for a result with an ear for Ctrl-C, which a wait without end may not hear."""
    while not wait([future], timeout=0.05).done:
        pass
    return future.result()


def _here(task: Task, chains: Sequence[_Chain], threads: int) -> Generator[tuple[Block, Values]]:
    """Run chains, several beside each other, block after block, the next one while a result is being kept."""
    waiting = [(deque(chain.blocks), chain.before) for chain in chains if chain.blocks]
    beside = max(1, min(threads, len(waiting)))
    running: dict[Future[Values | None], deque[Block]] = {}
    with _aside(beside) as (pool, stop):

        def submit(blocks: deque[Block], before: Values | None) -> None:
            work = partial(_from(task, before), threads=threads // beside, cancelled=stop.is_set)
            running[pool.submit(work, *blocks[0][1:])] = blocks

        for _ in range(beside):
            if waiting:
                submit(*waiting.pop(0))
        while running:
            for future in wait(running, timeout=0.05, return_when=FIRST_COMPLETED).done:  # with an ear for Ctrl-C
                blocks, values = running.pop(future), _whole(future.result())
                block = blocks.popleft()
                if blocks:
                    submit(blocks, _end(task, block, values))
                elif waiting:
                    submit(*waiting.pop(0))
                yield block, values


def _whole(values: Values | None) -> Values:
    if values is None:
        raise RuntimeError("a block ended before its time, though nobody stopped it")
    return values


# ---- on a cluster


def _on_cluster(client: Any, task: Task, chains: Sequence[_Chain], threads: int) -> Generator[tuple[Block, Values]]:
    """Run blocks wherever there is a worker; those of workers that die are run again by others."""
    cloudpickle, dask = import_module("cloudpickle"), import_module("distributed")
    broken = import_module("distributed.comm").CommClosedError
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Sending large graph")  # not scattered: what is lost there is gone for good
        shared = client.submit(pickle.loads, cloudpickle.dumps(task), pure=False)
    blocks: dict[Any, Block] = {}
    for chain in chains:
        earlier: tuple[Any, Block | None] = chain.before, None
        for block in chain.blocks:
            future = client.submit(_block, shared, block, threads, _bits(), *earlier, pure=False, priority=-len(blocks))
            blocks[future] = block
            earlier = (future, block) if isinstance(task, Chained) else (None, None)
    try:
        for future in dask.as_completed(list(blocks)):
            values = future.result()
            yield blocks.pop(future), _whole(values)
    except dask.KilledWorker as error:
        raise ResourceError(
            f"the cluster gave up: {error.allowed_failures + 1} workers in turn died of one block\n"
            "  try: workers with more memory, or smaller blocks"
        ) from None
    except (dask.CancelledError, broken) as error:
        raise ResourceError(f"the cluster is lost: {error}\n  try: whether its scheduler is running") from None
    finally:
        with suppress(broken):
            client.cancel([shared, *blocks], force=True)


def _block(
    task: Task, block: Block, threads: int, bits: str, before: Values | None, earlier: Block | None
) -> Values | None:
    """Run a block on a worker, from what was found of an earlier block or before all of them."""
    worker: Any = import_module("distributed").get_worker()
    if _bits() != bits:
        raise ResourceError(
            f"the worker {worker.address} computes with {_bits()}, the study with {bits}: results would differ\n"
            "  try: the same version, and the same RATTLEBOX_SIMD in the environment of all"
        )
    tasks, key = worker.state.tasks, worker.get_current_task()
    if before is not None and earlier is not None:
        before = _end(task, earlier, before)
    return _from(task, before)(
        *block[1:], threads=threads, cancelled=lambda: key not in tasks or tasks[key].state == "cancelled"
    )
