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
from .core import core, instructions
from .gpu import nvrtc

SMALL = 2000
"""Particles up to which a case is one block's."""

SAMPLES, MANY_SAMPLES = 256, 2048
"""Samples for which there is room on the card, of a large case and of a small one; they are fetched when it is full."""

MOST_BEDS = 8
"""Cavities of a case, at most, that a block finds room for."""

_TOLD = np.dtype([("step", np.int64), ("status", np.int32), ("pause", np.int32)])  # as in core/gpu/dem.cpp
_SPARE = 0.9  # of the free memory is taken at most
_GRAIN = 256  # of addresses
_PIECE = 0.1  # time of a launch [s]: a stop is heard soon
_PATIENCE = 4  # exchanges of all cases with the card, that one which needs room waits for the others

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

    Attributes
    ----------
    particles, steps
        How many there are.
    alone
        It takes all of the card.
    macros
        For which its kernels are compiled. They depend on nothing but the case, and so do its bits.
    refused
        Why the card cannot go on with it, None while it can.

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
        self.particles, self.steps = count_of(packed), int(packed["steps"])
        self.alone = not small or len(packed["cavities"]) > MOST_BEDS
        self.macros = {**launch_bounds(self.particles), **laws([packed])}
        self.refused: CaseError | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._dem, name)

    def run(self, until: int, progress: Callable[[int], object] | None = None) -> bool:
        """Go on until the sample of step `until` is taken; False when it was stopped before.

        Raises
        ------
        CaseError
            When the card's memory is too small, with the number, or a particle has too many neighbours.
        """
        begin = perf_counter()
        try:
            whole = run_together(
                [self], until, self._card, lambda steps: progress is None or progress(steps[0]) is not False
            )
        finally:
            self._seconds += perf_counter() - begin
        if self.refused:
            raise self.refused
        return whole

    def make_room(self) -> None:
        """Take samples out, and grow what was too small, or say that it cannot."""
        try:
            self._dem.make_room()
        except ValueError as error:
            self.refused = CaseError(f"on a card, {error}\n  try: the processor")

    def counters(self) -> dict[str, Any]:
        """As of the core."""
        return {**self._dem.counters(), "seconds": self._seconds}

    def told(self) -> str:
        """Return what to tell of the card, and of how long its kernels were compiled."""
        return self._card.told(self._card.compiling)

    def save(self) -> Bytes:
        """All that a bitwise restart on a card needs."""
        return np.asarray(self._dem.image(0))

    def restore(self, state: Bytes) -> None:
        """Go on from what was saved."""
        self._dem.absorb(state)


def ready() -> str:
    """See to it that there is a card.

    Returns
    -------
    str
        What decides the last bits of a result, those of the processor included, on which beds settle. Kernels are compiled
        for the laws of a case when it is run.

    Raises
    ------
    CaseError
        When there is no card that can be used, naming what is missing.
    """
    card = Card()
    return f"{card.arch}, NVRTC {'.'.join(map(str, nvrtc()))}, beds by {instructions()}"


def run_together(
    cases: Sequence[CardDem], until: int, card: Card, progress: Callable[[list[int]], object] | None = None
) -> bool:
    """Run cases to a step, or to their end where that comes before.

    Parameters
    ----------
    cases
        Of any size and kind. Small ones that are alike run side by side, as many as fit, others one by one.
    until
        Last step.
    card
        The card.
    progress
        Called between launches with the step of each case; False stops.

    Returns
    -------
    bool
        Whether all came so far, but for those that are refused.

    Raises
    ------
    CaseError
        When the card's memory is too small for one of them, with the number.
    """
    kernels: dict[tuple[Any, ...], _Kernel] = {}
    while waiting := [case for case in cases if _goes_on(case, until)]:
        group = _side_by_side(waiting, card)
        kind = group[0].alone, *group[0].macros.items()
        kernel = kernels.get(kind) or kernels.setdefault(kind, _Kernel(card, group[0]))
        steps = {id(case): case.step for case in cases}

        def go_on(now: list[int], group: list[CardDem] = group, steps: dict[int, int] = steps) -> bool:
            steps.update({id(case): step for case, step in zip(group, now, strict=True)})
            return progress is None or progress(list(steps.values())) is not False

        with _Blocks(card, group).filled() as blocks:
            stopped = not kernel.work(blocks, until, go_on)
        for case in group:
            case.make_room()
        if stopped:
            return False
    return True


def _goes_on(case: CardDem, until: int) -> bool:
    return case.step <= min(until, case.steps) and not case.status and not case.refused


def _side_by_side(waiting: Sequence[CardDem], card: Card) -> list[CardDem]:
    """Return the first of some cases with those like it that fit beside it."""
    first, room = waiting[0], _SPARE * card.memory()[0]
    alike = [
        case for case in waiting if case is first or not (first.alone or case.alone or case.macros != first.macros)
    ]
    fit = int(np.searchsorted(np.cumsum([_room(case) for case in alike]), room, side="right"))
    return alike[: max(1, fit)]


def _room(case: CardDem) -> int:
    """Bytes of a case in the card's memory."""
    return -(-int(case.memory) // _GRAIN) * _GRAIN


class _Blocks:
    """Cases in the memory of a card, one behind the other."""

    def __init__(self, card: Card, cases: Sequence[CardDem]) -> None:
        self.card, self.cases = card, cases
        self.seconds = 0.0  # that bringing them there took
        self.begins = np.concatenate([[0], np.cumsum([_room(case) for case in cases])]).astype(np.uint64)
        needed, (free, _) = int(self.begins[-1]), card.memory()
        if needed > _SPARE * free:
            raise CaseError(
                f"{cases[0].particles:,} particles need {needed / 2**30:.3g} GiB on the card, "
                f"{free / 2**30:.3g} GiB are free\n  try: fewer particles, or a card with more memory"
            )

    @contextmanager
    def filled(self) -> Iterator[_Blocks]:
        """Bring the cases to the card, and back again."""
        with self.card.room(int(self.begins[-1])) as self.block:
            begun, address = perf_counter(), int(self.block.handle)
            images = np.zeros(int(self.begins[-1]), np.uint8)
            for case, begin in zip(self.cases, self.begins, strict=False):
                image = np.asarray(case.image(address + int(begin)))
                images[int(begin) : int(begin) + image.size] = image
            self.card.upload(self.block, images)
            self.seconds = perf_counter() - begun
            yield self
            self.card.download(self.block, images)
            for case, begin in zip(self.cases, self.begins, strict=False):
                case._dem.absorb(images[int(begin) : int(begin) + case.memory])


class _Kernel:
    """The kernel for cases like one."""

    def __init__(self, card: Card, case: CardDem) -> None:
        self._card, self._threads = card, case.macros["RATTLEBOX_THREADS"]
        self.compiled, kernel = card.kernels("dem.cpp", **case.macros)
        self._kernel = kernel("grid" if case.alone else "block")
        self._alone, self._steps = case.alone, 16
        if case.alone:
            self._blocks = card.blocks_at_once(self._kernel, self._threads)

    def work(self, blocks: _Blocks, until: int, go_on: Callable[[list[int]], bool]) -> bool:
        """Launch until each case is done, or those that pause have waited long enough; False when it was stopped."""
        card, count, late = self._card, len(blocks.cases), 0.0
        limits = np.array([min(until, case.steps) for case in blocks.cases])
        near = 0 if self._alone else card.allow_shared(self._kernel, max(int(case.near) for case in blocks.cases))
        told = np.empty(count, _TOLD)
        with card.room(8 * count) as offsets, card.room(8) as barrier, card.room(told.nbytes) as board:
            card.upload(offsets, blocks.begins[:-1])
            card.fill(barrier, 0)
            at_work = [case.step for case in blocks.cases]
            while at_work and late <= _PATIENCE * blocks.seconds:
                goal, begin = min(until, min(at_work) + self._steps - 1), perf_counter()
                given: tuple[Any, ...]
                if self._alone:
                    given = blocks.block, barrier, goal, board
                    card.launch(self._kernel, self._blocks, self._threads, *given, at_once=True)
                else:
                    given = blocks.block, offsets, goal, near, board
                    card.launch(self._kernel, count, self._threads, *given, shared=near)
                card.download(board, told)
                took = perf_counter() - begin
                self._steps = max(1, int(self._steps * min(4.0, _PIECE / took)))
                if not go_on(told["step"].tolist()):
                    return False
                going = (told["step"] <= limits) & (told["status"] == 0)
                at_work = told["step"][going & (told["pause"] == 0)].tolist()
                late += took if len(at_work) < going.sum() else 0.0
        return True
