"""Particles in space on a graphics card: small cases side by side, one a block, or a large one by all of the card."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.errors import CaseError

from .card import Card
from .core import core

SMALL = 2000
"""Particles up to which a case is one block's."""

SAMPLES, MANY_SAMPLES = 256, 20_000
"""Samples for which there is room on the card, of a large case and of a small one; they are fetched when it is full."""

MOST_BEDS = 8
"""Cavities of a case, at most, that a block finds room for."""

_SPARE = 0.9  # of the free memory is taken at most
_GRAIN = 256  # of addresses
_PIECE = 0.1  # time of a launch [s]: a stop is heard soon

Bytes = NDArray[np.uint8]


def laws(packed: Sequence[Mapping[str, Any]]) -> dict[str, int]:
    """Say for which laws kernels are compiled: what all contacts of some cases have in common.

    Parameters
    ----------
    packed
        Cases, as packed for the core.

    Returns
    -------
    dict
        Macros: RATTLEBOX_NORMAL where there is one kind of normal law, RATTLEBOX_RUBS where friction and rolling are alike.
    """
    normal, rubs = set(), set()
    for case in packed:
        for cavity in case["cavities"]:
            for entries in (cavity["particle_entry"], cavity["wall_entry"]):
                contacts = [case["contacts"][int(k)] for k in np.unique(entries)]
                normal |= {("hertz_tsuji", "linear", "thornton").index(one["normal"]["law"]) for one in contacts}
                rolls = any(one["rolling"] > 0 for one in contacts)
                rubs.add(2 if rolls else int(any(one["friction"] > 0 for one in contacts)))
    named = {"RATTLEBOX_NORMAL": normal, "RATTLEBOX_RUBS": rubs}
    return {name: found.pop() for name, found in named.items() if len(found) == 1}


def launch_bounds(particles: int) -> dict[str, int]:
    """Return the threads of a block for so many particles of a case, and how many blocks share a multiprocessor."""
    large = 512 < particles <= SMALL
    return {"RATTLEBOX_THREADS": 512 if large else 128, "RATTLEBOX_BLOCKS": 1 if large else 4}


def count_of(packed: Mapping[str, Any]) -> int:
    """Return the number of particles of a packed case."""
    return sum(cavity["radius"].size for cavity in packed["cavities"])


class CardDem:
    """A case with particles whose steps are done on a card; for the rest what core().Dem is.

    Parameters
    ----------
    packed
        The case, as packed for the core.
    card
        The card; default the first of this machine.

    Raises
    ------
    CaseError
        When there is no card that can be used.
    """

    threads = 1

    def __init__(self, packed: Mapping[str, Any], card: Card | None = None) -> None:
        self._card = card or Card()
        small = count_of(packed) <= SMALL
        samples = packed["steps"] // packed["every"] + 2
        self._dem = core().DemWide(packed, slots=12, samples=min(samples, MANY_SAMPLES if small else SAMPLES))
        self._packed = packed
        self._seconds = 0.0

    def __getattr__(self, name: str) -> Any:
        return getattr(self._dem, name)

    def run(self, until: int, progress: Callable[[int], object] | None = None) -> bool:
        """Go on until the sample of step `until` is taken; False when it was stopped before.

        Raises
        ------
        CaseError
            When the card's memory is too small, with the number.
        """
        begin = perf_counter()
        try:
            return run_together(
                [self], until, self._card, lambda *_: progress is None or progress(self.step) is not False
            )
        finally:
            self._seconds += perf_counter() - begin

    def counters(self) -> dict[str, Any]:
        """As of the core."""
        return {**self._dem.counters(), "seconds": self._seconds}

    def save(self) -> Bytes:
        """All that a bitwise restart on a card needs."""
        return np.asarray(self._dem.image(0))

    def restore(self, state: Bytes) -> None:
        """Go on from what was saved."""
        self._dem.absorb(state)


def run_together(
    cases: Sequence[CardDem], until: int, card: Card, progress: Callable[[int, int], object] | None = None
) -> bool:
    """Run cases to a step, or to their end where that comes before.

    Parameters
    ----------
    cases
        One of any size, or several small ones.
    until
        Last step.
    card
        The card.
    progress
        Called between launches with the number of cases done and of all; False stops.

    Returns
    -------
    bool
        Whether all came so far.

    Raises
    ------
    CaseError
        When the card's memory is too small, with the number.
    """
    most = max(count_of(case._packed) for case in cases)
    if most > SMALL and len(cases) > 1:
        raise CaseError(f"a case of {most:,} particles has the card for itself\n  try: one case after the other")
    kernel = _Kernel(card, cases, most)
    waiting = _unfinished(cases, until)
    while waiting:
        before = len(cases) - len(waiting)

        def go_on(done: int, before: int = before) -> bool:
            return progress is None or progress(before + done, len(cases)) is not False

        with _Blocks(card, waiting).filled() as blocks:
            stopped = not kernel.work(blocks, until, go_on)
        for case in waiting:
            case._dem.make_room()
        if stopped:
            return False
        waiting = _unfinished(cases, until)
    return True


def _unfinished(cases: Sequence[CardDem], until: int) -> list[CardDem]:
    return [case for case in cases if case.step <= min(until, case._packed["steps"]) and not case.status]


class _Blocks:
    """Cases in the memory of a card, one behind the other."""

    def __init__(self, card: Card, cases: Sequence[CardDem]) -> None:
        self.card, self.cases = card, cases
        sizes = [-(-case.memory // _GRAIN) * _GRAIN for case in cases]
        self.begins = np.concatenate([[0], np.cumsum(sizes)]).astype(np.uint64)
        needed, (free, _) = int(self.begins[-1]), card.memory()
        if needed > _SPARE * free:
            raise CaseError(
                f"{sum(count_of(case._packed) for case in cases):,} particles need {needed / 2**30:.3g} GiB on the card, "
                f"{free / 2**30:.3g} GiB are free\n  try: fewer particles or cases at once, or a card with more memory"
            )

    @contextmanager
    def filled(self) -> Iterator[_Blocks]:
        """Bring the cases to the card, and back again."""
        with self.card.room(int(self.begins[-1])) as self.block:
            address = int(self.block.handle)
            images = np.zeros(int(self.begins[-1]), np.uint8)
            for case, begin in zip(self.cases, self.begins, strict=False):
                image = np.asarray(case.image(address + int(begin)))
                images[int(begin) : int(begin) + image.size] = image
            self.card.upload(self.block, images)
            yield self
            self.card.download(self.block, images)
            for case, begin in zip(self.cases, self.begins, strict=False):
                case._dem.absorb(images[int(begin) : int(begin) + case.memory])

    def glance(self) -> list[tuple[int, int, int]]:
        """Step, status and pause of each case."""
        head = np.empty(core().DemWide.head(), np.uint8)
        found = []
        for begin in self.begins[:-1]:
            self.card.download(self.block, head, int(begin))
            found.append(core().DemWide.glance(head))
        return found


class _Kernel:
    """The kernel for some cases."""

    def __init__(self, card: Card, cases: Sequence[CardDem], most: int) -> None:
        small = most <= SMALL and all(len(case._packed["cavities"]) <= MOST_BEDS for case in cases)
        bounds = launch_bounds(most)
        self._card, self._threads = card, bounds["RATTLEBOX_THREADS"]
        self.compiled, kernel = card.kernels("dem.cpp", **bounds, **laws([case._packed for case in cases]))
        self._kernel = kernel("block" if small else "grid")
        self._small, self._steps = small, 16
        if small:
            self._near = card.allow_shared(self._kernel, max(int(case.near) for case in cases))
        else:
            self._blocks = card.blocks_at_once(self._kernel, self._threads)

    def work(self, blocks: _Blocks, until: int, go_on: Callable[[int], bool]) -> bool:
        """Launch until each case is done or pauses; False when it was stopped."""
        card, count = self._card, len(blocks.cases)
        limits = [min(until, case._packed["steps"]) for case in blocks.cases]
        with card.room(8 * count) as offsets, card.room(8) as barrier:
            card.upload(offsets, blocks.begins[:-1])
            card.fill(barrier, 0)
            at_work = [case.step for case in blocks.cases]
            while at_work:
                goal, begin = min(at_work) + self._steps - 1, perf_counter()
                if self._small:
                    given = blocks.block, offsets, goal, self._near
                    card.launch(self._kernel, count, self._threads, *given, shared=self._near)
                else:
                    card.launch(self._kernel, self._blocks, self._threads, blocks.block, barrier, goal, at_once=True)
                found = blocks.glance()
                self._steps = max(1, int(self._steps * min(4.0, _PIECE / (perf_counter() - begin))))
                over = [step > limit or status for (step, status, _), limit in zip(found, limits, strict=True)]
                if not go_on(sum(map(bool, over))):
                    return False
                at_work = [step for (step, _, pause), done in zip(found, over, strict=True) if not (done or pause)]
        return True
