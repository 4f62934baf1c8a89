"""Run the work of a study in blocks on a backend, and store the results; or run single cases."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, closing
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.interrupts import remember_ctrl_c
from rattlebox._util.progress import progress_bar
from rattlebox.engines.simulate import simulate_many
from rattlebox.model.errors import Hint
from rattlebox.studies.run.backends import make_backend, wait_for
from rattlebox.studies.run.store import RESERVED, MemoryResult, Plan, Store
from rattlebox.studies.work.work import Block, Blocks, Cancelled, Chain, Values, Work, make_chains, proceed_unless

if TYPE_CHECKING:
    import xarray as xr

    from rattlebox.model.case import Case
    from rattlebox.results.run import Run


MOST_BLOCKS = 2000
"""Largest number of blocks, so that a store has thousands of files rather than millions."""

_BLOCK_BYTES = 2**27


class Stopped(KeyboardInterrupt):
    """A study was stopped by Ctrl-C; the message explains how to resume it."""


def run_work(
    work: Work,
    *,
    backend: object = "threads",
    workers: int | None = None,
    store: str | os.PathLike[str] | None = None,
    progress: bool | Callable[[int, int], object] = True,
    block: int | None = None,
) -> xr.Dataset:
    """Run all variants of a work.

    Notes
    -----
    The size of a block depends only on the work, so that the layout of a store is the same on all machines.
    """
    from rattlebox import __version__

    executor = make_backend(backend, workers)
    plan = Plan(
        dims=tuple(work.grid.dims),
        shape=tuple(work.grid.shape),
        outputs=work.outputs,
        coords={**work.grid.coords(), **work.coords()},
        about={**work.describe(), "design": dict(work.grid.describe()), "version": __version__, "core": _core()},
    )
    _check_names(plan)
    # All that can be refused is refused before a store is opened or a variant runs.
    blocks = _partition(work, plan, block)
    opened: list[MemoryResult | Store] = []
    try:
        with ExitStack() as stack:
            stack.enter_context(remember_ctrl_c())
            result: MemoryResult | Store = MemoryResult(plan, blocks) if store is None else Store(store, plan, blocks)
            opened.append(result)
            stack.enter_context(result)
            report = stack.enter_context(progress_bar(progress, "variants"))
            # A separate thread completes its write when Ctrl-C interrupts this thread.
            writer = stack.enter_context(ThreadPoolExecutor(1))
            report.advance(result.done, work.size)
            # A resumed chain continues from the stored outputs of its last finished variant.
            chains = [
                Chain(left, None if before is None else _values_after(work, result, plan, before))
                for left, before in make_chains(work, result.blocks, result.finished, result.has_state)
            ]
            stale = _stale_states(work, result.blocks)
            finished = executor.run(work, chains)
            stack.callback(finished.close)
            # Blocks arrive in the order in which they finish, and are written while the workers compute the next ones.
            for done, values in finished:
                wait_for(writer.submit(result.write, done.number, values, stale.get(done.number, ())))
                report.advance(result.done, work.size)
            return result.result()
    except KeyboardInterrupt:
        raise Stopped(_stop_message(sum(each.done for each in opened), work.size, store)) from None


def _partition(work: Work, plan: Plan, block: int | None) -> Blocks:
    """Partition the grid into blocks."""
    fitting = math.ceil(_BLOCK_BYTES / max(1, plan.bytes_each))
    size = block or max(work.engine.block, math.ceil(work.size / MOST_BLOCKS))
    size = max(1, min(size, fitting))
    return Blocks.of(plan.shape, min(size, plan.shape[-1]) if work.order.is_chain else size)


def _values_after(work: Work, result: MemoryResult | Store, plan: Plan, block: Block) -> Values:
    """Return the outputs and states of the last variant of a block, with a dimension of length one for it."""
    last = work.order.order(block.start, block.stop)[-1]
    place = map(int, np.unravel_index(last, plan.shape))
    data = result.result().isel(dict(zip(plan.dims, place, strict=True)))
    outputs = {str(name): values.values[None] for name, values in data.data_vars.items()}
    return {**outputs, **result.state(block.number)}


def _stale_states(work: Work, blocks: Blocks) -> dict[int, list[int]]:
    """Return the blocks whose states are no longer needed when a block is written, by its number.

    The state before the last one remains: if the process is killed while a block is written, it starts from there.
    """
    stale: dict[int, list[int]] = {}
    for chain in work.order.chains(blocks) if work.has_states else ():
        stale |= {block: [before] for before, block in zip(chain, chain[2:], strict=False)}
        stale[chain[-1]] = chain[-3:]
    return stale


def _core() -> str:
    """Return the name of the instruction set, which decides the last bits."""
    from rattlebox.core.choose import instructions

    return instructions()


def _check_names(plan: Plan) -> None:
    """Raise if an axis or a measure has the name of another part of the result."""
    inner = {name for extra, _, _ in plan.outputs.values() for name, _ in extra} | {*RESERVED}
    for name in plan.dims:
        if name in inner or name in plan.outputs:
            raise Hint(f"{name} is the name of another variable of studies and cannot name an axis", "another name")
    for name in plan.outputs:
        if name in inner:
            raise Hint(f"{name} is the name of another variable of studies and cannot name a function", "another name")


def _stop_message(done: int, total: int, store: str | os.PathLike[str] | None) -> str:
    if store is None:
        return f"stopped after {done:,} of {total:,} variants, which are lost; use a store to resume"
    return f"stopped; {done:,} of {total:,} variants are in {os.fspath(store)}, and the same command resumes from there"


# ---- single cases


def evaluate_cases(
    cases: Sequence[Case],
    evaluate: Callable[[Run], object],
    *,
    simulate: Callable[..., Run] | None = None,
    backend: object = "threads",
    workers: int | None = None,
    progress: bool | Callable[[int, int], object] = True,
) -> list[Any]:
    """Simulate cases and return the value of a function of each run, in the order of the cases."""
    work = Work(_Cases(cases, evaluate, simulate or _simulate))
    chains = [Chain([Block(number, number, number + 1)]) for number in range(len(cases))]
    found: dict[int, Any] = {}
    chosen = make_backend(backend, workers)
    with progress_bar(progress, "runs") as report, closing(chosen.run(work, chains)) as finished:
        for block, values in finished:
            found[block.number] = values["found"][0]
            report.advance(len(found), len(cases))
    return [found[number] for number in range(len(cases))]


@dataclass(frozen=True)
class _Cases:
    """Engine of single cases, which has neither a grid nor outputs: backends do not use them."""

    cases: Sequence[Case]
    evaluate: Callable[[Run], Any]
    simulate: Callable[..., Run]

    def run(self, numbers: range, *, threads: int, cancelled: Cancelled, reduction: None = None) -> Values | None:
        proceed = proceed_unless(cancelled)
        found = np.empty(len(numbers), object)
        for place, number in enumerate(numbers):
            run = self.simulate(self.cases[number], threads=threads, progress=proceed)
            if not proceed():
                return None
            found[place] = self.evaluate(run)
        return {"found": found}


def _simulate(case: Case, *, threads: int, progress: Callable[..., bool]) -> Run:
    """Return the run of one case."""
    (run,) = simulate_many([case], threads=threads, progress=progress)
    return run
