"""Interfaces of the work that studies run: many variants, computed in blocks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from rattlebox.studies.work.blocks import Blocks

Values = Mapping[str, NDArray[Any]]
"""Arrays by the name of the output, variants first."""

Output = tuple[tuple[tuple[str, int], ...], Any, Mapping[str, Any]]
"""Dimensions beyond those of the grid with their lengths, number type, attributes."""

Cancelled = Callable[[], bool] | None
"""Function that returns True when the work must stop; work calls it about fifty times a second."""


def proceed_unless(cancelled: Cancelled) -> Callable[..., bool]:
    """Return a progress function that stops a run when the work is cancelled."""
    return lambda *_: not (cancelled and cancelled())


class VariantGrid(Protocol):
    """Variants along the dimensions of a study; see `rattlebox.studies.grid.grid.Grid`."""

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the dimensions."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Lengths of the dimensions."""

    def coords(self) -> Mapping[str, Any]:
        """Return the coordinates as `xarray.Dataset` takes them."""

    def describe(self) -> Mapping[str, Any]:
        """Return a description in JSON types; equal grids have equal descriptions."""


class Work(Protocol):
    """Computation of many variants. The bits of a variant depend on its number alone, not on the blocks."""

    @property
    def grid(self) -> VariantGrid:
        """Variants."""

    @property
    def size(self) -> int:
        """Number of variants."""

    @property
    def block(self) -> int:
        """Preferred number of variants in a block: 1 where a variant takes seconds."""

    @property
    def outputs(self) -> Mapping[str, Output]:
        """Outputs by name."""

    def coords(self) -> Mapping[str, Any]:
        """Return the coordinates of the dimensions beyond those of the grid."""

    def describe(self) -> Mapping[str, Any]:
        """Return a description of the results of each variant, in JSON types; a store refuses work with another one."""

    def run(self, start: int, stop: int, *, threads: int, cancelled: Cancelled) -> Values | None:
        """Run a range of variants."""


@runtime_checkable
class ChainedWork(Work, Protocol):
    """Work in which a variant starts from the final state of another one, along the last dimension.

    `run` may return arrays that are not outputs, variants first: states of any size, which a store holds only until the
    next variant is finished.
    """

    @property
    def has_states(self) -> bool:
        """Whether `run` returns and needs arrays that are not outputs."""

    def chains(self, blocks: Blocks) -> list[list[int]]:
        """Return the numbers of the blocks of each chain in their order; chains are independent of each other."""

    def order(self, start: int, stop: int) -> range:
        """Return the variants of a block in the order in which they follow each other."""

    def run(
        self, start: int, stop: int, *, threads: int, cancelled: Cancelled, before: Values | None = None
    ) -> Values | None:
        """Run a range of variants of one chain; see `Work.run`."""


class Block(NamedTuple):
    """A range of variants."""

    number: int
    start: int
    stop: int


class Chain(NamedTuple):
    """Blocks that must run one after the other."""

    blocks: list[Block]
    before: Values | None = None


def run_block(work: Work, block: Block, before: Values | None, *, threads: int, cancelled: Cancelled) -> Values | None:
    """Return the outputs of a block; None if it was cancelled."""
    if isinstance(work, ChainedWork):
        return work.run(block.start, block.stop, threads=threads, cancelled=cancelled, before=before)
    return work.run(block.start, block.stop, threads=threads, cancelled=cancelled)


def last_values(work: Work, block: Block, values: Values) -> Values | None:
    """Return the outputs of the variant from which the next block of a chain continues; None for independent blocks."""
    if not isinstance(work, ChainedWork):
        return None
    last = work.order(block.start, block.stop)[-1] - block.start
    return {name: array[last : last + 1] for name, array in values.items()}


def make_chains(
    work: Work, blocks: Blocks, finished: NDArray[np.bool_], has_state: Callable[[int], bool]
) -> list[tuple[list[Block], Block | None]]:
    """Return the blocks that remain to be computed, by chain."""
    numbers = work.chains(blocks) if isinstance(work, ChainedWork) else [[number] for number in range(len(blocks))]
    chains: list[tuple[list[Block], Block | None]] = []
    for chain in numbers:
        done = int(np.argmin([*finished[chain], False]))
        if done == len(chain):
            continue
        if isinstance(work, ChainedWork) and work.has_states:
            while done and not has_state(chain[done - 1]):
                done -= 1
        left = [Block(number, *blocks.range(number)) for number in chain]
        before = left[done - 1] if isinstance(work, ChainedWork) and done else None
        chains.append((left[done:], before))
    return chains
