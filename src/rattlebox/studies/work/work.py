"""Work that studies run: an engine computes variants, in an order, in blocks, and a reduction turns runs into numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from rattlebox.core._core import Status

if TYPE_CHECKING:
    from rattlebox.model.case import Case

Values = Mapping[str, NDArray[Any]]
"""Arrays by the name of the output, variants first."""

Extra = tuple[tuple[str, int], ...]
"""Dimensions of an output beyond those of the grid, with their lengths."""

Output = tuple[Extra, Any, Mapping[str, Any]]
"""Dimensions beyond those of the grid with their lengths, number type, attributes."""

Outputs = dict[str, tuple[Extra, str, dict[str, Any]]]

Cancelled = Callable[[], bool] | None
"""Function that returns True when the work must stop; work calls it about fifty times a second."""


def proceed_unless(cancelled: Cancelled) -> Callable[..., bool]:
    """Return a progress function that stops a run when the work is cancelled."""
    return lambda *_: not (cancelled and cancelled())


# ---- members of a work


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


class Engine(Protocol):
    """Computation of variants. The bits of a variant depend on its number alone, not on the blocks."""

    @property
    def grid(self) -> VariantGrid:
        """Variants."""

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

    def timed_case(self, number: int) -> Case | None:
        """Return the case of a variant whose first steps can be timed alone; None if variants are timed in blocks."""

    def run(self, numbers: range, *, threads: int, cancelled: Cancelled, reduction: Reduction | None) -> Values | None:
        """Return the outputs of some variants, ascending, and the values of a reduction; None if it was cancelled."""


class ChainEngine(Engine, Protocol):
    """Engine that can start a variant from the end of another one.

    `follow` may return arrays that are not outputs, variants first: states of any size, which a store holds only until the
    next variant is finished.
    """

    @property
    def has_states(self) -> bool:
        """Whether `follow` returns and needs arrays that are not outputs."""

    def follow(
        self, numbers: range, before: Values | None, *, threads: int, cancelled: Cancelled, reduction: Reduction | None
    ) -> Values | None:
        """Run variants one after the other, in their order; `before` are the values of the one before the first."""


class Signals(NamedTuple):
    """Motions of one or several runs, from which a reduction computes numbers."""

    time: NDArray[np.float64]  # Times, in s or in cycles, (T,)
    frequency: float  # Frequency of the load, in the reciprocal unit of time
    rate: Any  # Units of time per second, (n, 1)
    # Displacement of the observed point [m], and momentum of all balls or particles [kg m/s], (n, T)
    displacement: NDArray[np.float64]
    momentum: Callable[[], NDArray[np.float64]]
    diagnostics: Mapping[str, Any]  # Diagnostics of a particle run


class Reduction(Protocol):
    """Numbers that are computed from the motions of runs, which are then dropped."""

    @property
    def outputs(self) -> Outputs:
        """Outputs by name."""

    def coords(self) -> dict[str, Any]:
        """Return the coordinates of their dimensions beyond those of the grid."""

    def describe(self) -> dict[str, Any]:
        """Return a description in JSON types."""

    def reduce(self, signals: Signals) -> dict[str, Any]:
        """Return the outputs of some runs, runs first."""


# ---- blocks


@dataclass(frozen=True)
class Blocks:
    """Blocks of a grid, each of which is a rectangular region and a contiguous range of variants in C order.

    A block is a range for the core, a region of the result, and one file per variable in a store.
    """

    shape: tuple[int, ...]
    box: tuple[int, ...]

    @classmethod
    def of(cls, shape: Sequence[int], size: int) -> Blocks:
        """Partition a grid into blocks of nearly equal size."""
        box: list[int] = []
        for length in reversed(shape):
            parts = math.ceil(length / max(1, size))
            box.append(math.ceil(length / parts))
            size //= length
        return cls(tuple(shape), tuple(reversed(box)))

    @property
    def counts(self) -> tuple[int, ...]:
        """Number of blocks along each dimension."""
        return tuple(math.ceil(length / edge) for length, edge in zip(self.shape, self.box, strict=True))

    def __len__(self) -> int:
        return math.prod(self.counts)

    def region(self, block: int) -> tuple[slice, ...]:
        """Return the region of a block in the grid."""
        place = np.unravel_index(block, self.counts) if self.shape else ()
        return tuple(
            slice(int(i) * edge, min((int(i) + 1) * edge, length))
            for i, edge, length in zip(place, self.box, self.shape, strict=True)
        )

    def sides(self, block: int) -> tuple[int, ...]:
        """Return the shape of a block."""
        return tuple(part.stop - part.start for part in self.region(block))

    def range(self, block: int) -> tuple[int, int]:
        """Return the first variant of a block and the one after its last."""
        corner = tuple(part.start for part in self.region(block))
        start = int(np.ravel_multi_index(corner, self.shape)) if self.shape else 0
        return start, start + math.prod(self.sides(block))

    def variants(self, mask: NDArray[np.bool_]) -> int:
        """Return the number of variants in some blocks."""
        return int(self._sizes[mask].sum())

    @cached_property
    def _sizes(self) -> NDArray[np.int64]:
        sizes = np.ones(1, np.int64)
        for edge, length in zip(self.box, self.shape, strict=True):
            sizes = np.multiply.outer(sizes, np.minimum(edge, length - np.arange(0, length, edge))).ravel()
        return sizes


# ---- orders


@dataclass(frozen=True)
class Independent:
    """Order of variants that do not depend on each other: each block is a chain of its own."""

    is_chain = False

    def describe(self) -> dict[str, Any]:
        """Return a description in JSON types."""
        return {}

    def chains(self, blocks: Blocks) -> list[list[int]]:
        """Return the numbers of the blocks of each chain in order of execution; chains are independent of each other."""
        return [[number] for number in range(len(blocks))]

    def order(self, start: int, stop: int) -> range:
        """Return the variants of a block in the order in which they follow each other."""
        return range(start, stop)


@dataclass(frozen=True)
class AlongLast:
    """Order in which each variant starts from the end of the one before, along the last dimension of the grid.

    The first dimension is the direction: "up" or "down".
    """

    directions: tuple[str, ...]
    size: int
    turn_back: bool = False

    is_chain = True

    def describe(self) -> dict[str, Any]:
        """Return a description in JSON types."""
        return {"study": "continuation", "directions": list(self.directions), "turn_back": self.turn_back}

    def chains(self, blocks: Blocks) -> list[list[int]]:
        """Return the numbers of the blocks of each chain in order of execution; chains are independent of each other."""
        rows = np.arange(len(blocks)).reshape(len(self.directions), -1, blocks.counts[-1])
        chains = [row if way == "up" else row[:, ::-1] for way, row in zip(self.directions, rows, strict=True)]
        if self.turn_back:
            chains = [np.concatenate(chains, axis=1)]
        return [chain.tolist() for rows in chains for chain in rows]

    def order(self, start: int, stop: int) -> range:
        """Return the variants of a block in the order in which they follow each other."""
        up = self.directions[start * len(self.directions) // self.size] == "up"
        return range(start, stop) if up else range(stop - 1, start - 1, -1)


# ---- work


_MOTIONS = ("displacement", "velocity", "relative_position", "relative_velocity")
"""Outputs that a reduction replaces."""


class Block(NamedTuple):
    """A range of variants."""

    number: int
    start: int
    stop: int


class Chain(NamedTuple):
    """Blocks that must run one after the other."""

    blocks: list[Block]
    before: Values | None = None


@dataclass
class Work:
    """Computation of many variants by an engine, in an order, with a reduction of each run if motions are not stored."""

    engine: Any
    order: Independent | AlongLast = field(default_factory=Independent)
    reduction: Reduction | None = None

    @property
    def grid(self) -> Any:
        """Variants."""
        return self.engine.grid

    @property
    def size(self) -> int:
        """Number of variants."""
        return math.prod(self.grid.shape)

    @property
    def outputs(self) -> dict[str, Output]:
        """Outputs by name."""
        own = dict(self.engine.outputs)
        if self.reduction is None:
            return own
        return {name: output for name, output in own.items() if name not in _MOTIONS} | self.reduction.outputs

    def coords(self) -> Mapping[str, Any]:
        """Return the coordinates of the dimensions beyond those of the grid."""
        found: Mapping[str, Any] = (self.reduction or self.engine).coords()
        return found

    def describe(self) -> dict[str, Any]:
        """Return a description of the results of each variant, in JSON types; a store refuses work with another one."""
        reduction = self.reduction.describe() if self.reduction else {}
        return {**self.order.describe(), **self.engine.describe(), **reduction}

    def validate(self) -> None:
        """Raise if a variant is not valid, before anything runs."""
        if self.order.is_chain:
            self.engine.require_continuous()
        else:
            self.engine.validate()

    @property
    def has_states(self) -> bool:
        """Whether a variant needs arrays of the one before that are not outputs."""
        return bool(self.order.is_chain and self.engine.has_states)

    def run(self, block: Block, before: Values | None, *, threads: int, cancelled: Cancelled) -> Values | None:
        """Return the outputs of a block, variants ascending; None if it was cancelled."""
        numbers = self.order.order(block.start, block.stop)
        options: dict[str, Any] = {"threads": threads, "cancelled": cancelled, "reduction": self.reduction}
        values: Values | None = (
            self.engine.follow(numbers, before, **options)
            if self.order.is_chain
            else self.engine.run(numbers, **options)
        )
        return values

    def last_values(self, block: Block, values: Values) -> Values | None:
        """Return the outputs of the variant from which the next block of a chain continues; None without chains."""
        if not self.order.is_chain:
            return None
        last = self.order.order(block.start, block.stop)[-1] - block.start
        return {name: array[last : last + 1] for name, array in values.items()}

    def first_refused(self, status: object) -> str:
        """Return the values of the first refused variant and the reason; "" if none is refused."""
        refused = np.flatnonzero(status == Status.refused)
        if not refused.size or not (why := self.engine.refusal_reason(int(refused[0]))):
            return ""
        reason = why.replace("\n", "\n  ")
        return f"{self.grid.describe_variant(self.engine.case, int(refused[0]))}\n  {reason}"


def make_chains(
    work: Work, blocks: Blocks, finished: NDArray[np.bool_], has_state: Callable[[int], bool]
) -> list[tuple[list[Block], Block | None]]:
    """Return the blocks that remain to be computed, by chain, and the finished block before them."""
    chains: list[tuple[list[Block], Block | None]] = []
    for chain in work.order.chains(blocks):
        done = int(np.argmin([*finished[chain], False]))
        if done == len(chain):
            continue
        # A state that is not an output may be lost: go back to the last block whose state is on disk.
        while work.has_states and done and not has_state(chain[done - 1]):
            done -= 1
        left = [Block(number, *blocks.range(number)) for number in chain]
        chains.append((left[done:], left[done - 1] if work.order.is_chain and done else None))
    return chains
