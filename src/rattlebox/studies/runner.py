"""Runs the work of a study: cuts it into blocks, hands them to a backend, and keeps their results."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.progress import progress_bar
from rattlebox.model.errors import Hint

from .backends import make_backend, wait_for
from .blocks import Blocks
from .plan import MemoryResult, Plan
from .store import RESERVED, Store
from .work import Chain, ChainedWork, Values, Work, make_chains

if TYPE_CHECKING:
    import xarray as xr

MOST_BLOCKS = 2000
"""Largest number of blocks, so that a store has thousands of files rather than millions."""

_BLOCK_BYTES = 2**27


class Stopped(KeyboardInterrupt):
    """A study that Ctrl-C stopped; the message says how to resume it."""


def run_work(
    work: Work,
    *,
    backend: Any = "threads",
    workers: int | None = None,
    store: str | os.PathLike[str] | None = None,
    progress: bool | Callable[[int, int], object] = True,
    block: int | None = None,
) -> xr.Dataset:
    """Run all variants of some work.

    Parameters
    ----------
    work
        The work.
    backend, workers
        Backend that runs the blocks, see `make_backend`.
    store
        Folder on disk for the result, which need not exist. Finished blocks are in it at all times, and the same call
        resumes from it.
    progress
        True for a progress bar after 2 s, False for none, or a function of the numbers of variants done and of all,
        which stops the study by returning False.
    block
        Largest number of variants in a block; default the one that the work prefers.

    Returns
    -------
    xarray.Dataset
        Each output over the grid and its own dimensions, in memory or, with `store`, opened on disk. The bits
        depend neither on blocks, backends, workers nor on stops.

    Raises
    ------
    CaseError
        If there is no such backend.
    StoreError
        If the store holds other work, another process writes to it, or it cannot be written.
    ResourceError
        If the disk is full or workers fail.
    Stopped
        After Ctrl-C.

    Notes
    -----
    The size of a block follows from the work alone, so that the layout of a store depends neither on the machine nor on
    its load.
    """
    from rattlebox import __version__

    chosen = make_backend(backend, workers)
    plan = Plan(
        dims=tuple(work.grid.dims),
        shape=tuple(work.grid.shape),
        outputs=work.outputs,
        coords={**work.grid.coords(), **work.coords()},
        about={**work.describe(), "design": dict(work.grid.describe()), "version": __version__, "core": _core()},
    )
    _check_names(plan)
    blocks = _cut(work, plan, block)
    opened: list[MemoryResult | Store] = []
    try:
        with ExitStack() as stack:
            result: MemoryResult | Store = MemoryResult(plan, blocks) if store is None else Store(store, plan, blocks)
            opened.append(result)
            stack.enter_context(result)
            report = stack.enter_context(progress_bar(progress, "variants"))
            # A thread of its own finishes the block that it writes when Ctrl-C interrupts this one.
            writer = stack.enter_context(ThreadPoolExecutor(1))
            report.advance(result.done, work.size)
            chains = [
                Chain(left, None if variant is None else _values_of(result, plan, variant))
                for left, variant in make_chains(work, result.blocks, result.finished)
            ]
            finished = chosen.run(work, chains)
            stack.callback(finished.close)
            for done, values in finished:
                wait_for(writer.submit(result.write, done.number, values))
                report.advance(result.done, work.size)
            return result.result()
    except KeyboardInterrupt:
        raise Stopped(_how_to_resume(sum(each.done for each in opened), work.size, store)) from None


def _cut(work: Work, plan: Plan, block: int | None) -> Blocks:
    """Cut the grid into blocks."""
    fitting = math.ceil(_BLOCK_BYTES / max(1, plan.bytes_each))
    size = block or max(work.block, math.ceil(work.size / MOST_BLOCKS))
    size = max(1, min(size, fitting))
    return Blocks.of(plan.shape, min(size, plan.shape[-1]) if isinstance(work, ChainedWork) else size)


def _values_of(result: MemoryResult | Store, plan: Plan, variant: int) -> Values:
    """Return the outputs of a variant, with a dimension of length one for it."""
    place = map(int, np.unravel_index(variant, plan.shape))
    data = result.result().isel(dict(zip(plan.dims, place, strict=True)))
    return {str(name): values.values[None] for name, values in data.data_vars.items()}


def _core() -> str:
    """Return the name of the instruction set, which decides the last bits."""
    from rattlebox.core.choose import instructions

    return instructions()


def _check_names(plan: Plan) -> None:
    """Raise if an axis or a measure has the name of another part of the result."""
    inner = {name for extra, _, _ in plan.outputs.values() for name, _ in extra} | {*RESERVED}
    for name in plan.dims:
        if name in inner or name in plan.outputs:
            raise Hint(f"an axis cannot be called {name}: studies hold something else by that name", "another name")
    for name in plan.outputs:
        if name in inner:
            raise Hint(f"a function cannot be called {name}: studies hold something else by that name", "another name")


def _how_to_resume(done: int, total: int, store: str | os.PathLike[str] | None) -> str:
    if store is None:
        return f"stopped after {done:,} of {total:,} variants, which are lost; a store would have kept them"
    return f"stopped; {done:,} of {total:,} variants are in {os.fspath(store)}, and the same command resumes from there"
