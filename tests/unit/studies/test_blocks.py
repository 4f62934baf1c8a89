"""A grid cut into blocks."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from rattlebox.studies.work.work import Blocks


@settings(derandomize=True, deadline=None)
@given(st.lists(st.integers(1, 8), max_size=4), st.integers(1, 60))
def test_blocks_are_boxes_and_ranges_and_cover_all_variants(shape: list[int], size: int) -> None:
    """Every variant is in one block, which is no larger than asked, a box of the grid and a range of numbers."""
    blocks = Blocks.of(shape, size)
    numbers = np.arange(math.prod(shape)).reshape(shape)
    result: list[int] = []
    for block in range(len(blocks)):
        start, stop = blocks.range(block)
        assert stop - start <= size
        assert numbers[blocks.region(block)].shape == blocks.sides(block)
        assert numbers[blocks.region(block)].ravel().tolist() == list(range(start, stop))
        result += range(start, stop)
        assert blocks.variants(np.arange(len(blocks)) == block) == stop - start
    assert result == list(range(math.prod(shape)))


def test_blocks_are_even() -> None:
    """A row that does not fit one block is halved, not cut into a large and a small piece; rows that fit share one."""
    assert Blocks.of((1000, 1000), 700).box == (1, 500)
    assert Blocks.of((1000, 100), 700).box == (7, 100)
    assert len(Blocks.of((), 5)) == 1
