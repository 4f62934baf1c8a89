"""Members of a batch on a graphics card, one trajectory a thread."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from math import prod
from time import sleep
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.errors import CaseError

from .card import Card, this_card
from .core import core
from .gpu import nvrtc

THREADS = 128  # of a block
_SPARE = 0.9  # of the free memory is taken at most
_NAP = 0.02  # s, between two looks at a launch
_DESK, _STOP = 128, 64  # bytes of what threads and host tell each other; where among them a stop is told
_INTERRUPTED = 4


@dataclass(frozen=True)
class Need:
    """Bytes that members of a batch need on a card.

    Attributes
    ----------
    thread
        Of each thread at work, in the card's memory.
    member
        Of each member: its numbers and its results.
    local
        Set aside for the local memory of all threads that the card can hold.
    """

    thread: int
    member: int
    local: int

    def threads(self, free: int, members: int, most: int) -> int:
        """Say how many threads can work at once.

        Parameters
        ----------
        free
            Free bytes on the card.
        members
            How many members there are in one launch.
        most
            Threads that the card runs at once.

        Raises
        ------
        CaseError
            When not even one block of threads fits, with the number.
        """
        room = int(_SPARE * free) - self.local - members * self.member
        fit = room // self.thread // THREADS * THREADS
        if fit < THREADS:
            needed = (self.local + members * self.member + THREADS * self.thread) / 2**30
            raise CaseError(
                f"{members:,} variants need {needed:.3g} GiB on the card, {free / 2**30:.3g} GiB are free\n"
                "  try: fewer samples, or without motion; a card with more memory"
            )
        return min(fit, most, -(-members // THREADS) * THREADS)


class Members:
    """Members of a batch as the card reads them.

    Parameters
    ----------
    packed, shape, start, stop, look
        As for `rattlebox.engines.batch.run_block`, `look` as the keyword arguments of the core.

    Attributes
    ----------
    count
        Number of members.
    image
        Bytes that the kernel reads.
    memory
        Bytes that a thread needs for its vectors.
    numbers
        How many numbers come back.
    """

    def __init__(self, packed: Any, shape: Sequence[int], start: int, stop: int, **look: Any) -> None:
        found = core().gpu_image(packed, list(shape), start, stop, **look)
        self.count, self.image, self.numbers = stop - start, found["image"], found["numbers"]
        self.memory = -(-found["memory"] // 64) * 64
        self._arrays = found["arrays"]

    def named(self, status: NDArray[np.int8], numbers: NDArray[np.float64]) -> dict[str, NDArray[Any]]:
        """Return the results by name, as the processor's sweep does."""
        arrays = {name: numbers[at : at + prod(shape)].reshape(shape) for name, at, shape in self._arrays}
        return {"status": status, **arrays}


def ready() -> tuple[str, str]:
    """See to it that there is a card with compiled kernels.

    Returns
    -------
    tuple of str
        What decides the last bits of a result, and what to tell of card, driver and compilation.

    Raises
    ------
    CaseError
        When there is no card that can be used, naming what is missing.
    """
    card = Card()
    compiled, _ = card.kernels("impact.cpp", RATTLEBOX_THREADS=THREADS)
    return f"{card.arch}, NVRTC {'.'.join(map(str, nvrtc()))}", card.told(compiled.seconds)


def run_members(
    packed: Any,
    shape: Sequence[int],
    start: int,
    stop: int,
    progress: Callable[[int], bool | None] | None = None,
    **look: Any,
) -> Mapping[str, NDArray[Any]] | None:
    """Run some members of a batch on the card.

    Parameters
    ----------
    packed, shape, start, stop, progress
        As for `rattlebox.engines.batch.run_block`.
    **look
        Keyword arguments of the core's sweep: measures, window, motion, state, last.

    Raises
    ------
    CaseError
        When there is no card that can be used, or its memory is too small.
    """
    card = this_card()
    _, kernel = card.kernels("impact.cpp", RATTLEBOX_THREADS=THREADS)
    work = kernel("impact")
    blocks = work.occupancy.max_active_blocks_per_multiprocessor(THREADS, 0)
    most = blocks * card.multiprocessors * THREADS
    local = int(work.attributes.local_size_bytes) * card.resident * card.multiprocessors
    card.launch(kernel("prepare"), 1, 1)
    members = Members(packed, shape, start, stop, **look)
    each = -(-(len(members.image) + 8 * members.numbers) // members.count) + 1
    threads = Need(members.memory, each, local).threads(card.memory()[0], members.count, most)
    return _launch(card, work, members, threads, lambda done: progress is None or progress(done) is not False)


def _launch(
    card: Card, work: Any, members: Members, threads: int, go_on: Callable[[int], bool]
) -> dict[str, NDArray[Any]] | None:
    """Run members; None when it was stopped, which threads hear at their next event."""
    status, numbers = np.full(members.count, _INTERRUPTED, np.int8), np.empty(members.numbers)
    with ExitStack() as stack:

        def room(size: int) -> Any:
            return stack.enter_context(card.room(size))

        image, states, values = room(len(members.image)), room(members.count), room(numbers.nbytes)
        far, desk = room(threads * members.memory), room(_DESK)
        card.fill(desk, 0)
        card.fill(values, 0xFF)  # not a number, where a run does not finish
        card.upload(image, members.image)  # waits for what was asked before, so that a stop comes after it
        card.launch(work, threads // THREADS, THREADS, image, states, values, members.count, far, members.memory, desk)
        try:
            whole = _followed(card, desk, members.count, threads, go_on)
        except BaseException:
            card.poke(desk, _STOP, np.ones(1, np.uint8))
            raise
        if not whole:
            card.poke(desk, _STOP, np.ones(1, np.uint8))
            return None
        card.download(states, status)
        if numbers.size:
            card.download(values, numbers)
    return members.named(status, numbers) if go_on(members.count) else None


def _followed(card: Card, desk: Any, count: int, threads: int, go_on: Callable[[int], bool]) -> bool:
    """Wait for the card, and ask now and then whether to go on."""
    begun, nap = np.zeros(1, np.uint64), 1e-4
    while card.works():
        sleep(nap)
        nap = min(2 * nap, _NAP)
        if nap == _NAP:
            card.peek(desk, begun)
            if not go_on(max(0, min(int(begun[0]), count) - threads)):
                return False
    return True
