"""Partition of a grid of variants into blocks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray


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
