"""Tests of a graphics card: `make gpu-test`. They are skipped, and say why, where there is none.

Where there is none, tests/unit/engines/test_gpu_on_stand_in.py runs them on the processor (tests/stand_in).
"""

from __future__ import annotations

from typing import Any

import pytest

from rattlebox.engines.card import Card
from rattlebox.model.errors import CaseError


@pytest.fixture(scope="session", autouse=True)
def card() -> Card:
    """The card of this machine."""
    try:
        return Card()
    except CaseError as error:
        pytest.skip(f"no graphics card to test on: {' '.join(str(error).split())}")


class Watched:
    """What is asked of any card, and how much memory it says that it has.

    Attributes
    ----------
    blocks, threads
        Of each launch; zero blocks where all of the card was asked for.
    free, shared
        Bytes of its memory, and of that of a block; None for what there is.
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.blocks: list[int] = []
        self.threads: list[int] = []
        self.free: int | None = None
        self.shared: int | None = None
        launch, memory, allow_shared = Card.launch, Card.memory, Card.allow_shared

        def launched(card: Card, kernel: Any, blocks: int, threads: int, *arguments: Any, **how: Any) -> None:
            # The driver takes any number of arguments of any size.
            assert [info.size for info in kernel.arguments_info] == [8] * len(arguments)
            self.blocks.append(0 if how.get("at_once") else blocks)
            self.threads.append(threads)
            launch(card, kernel, blocks, threads, *arguments, **how)

        def free(card: Card) -> tuple[int, int]:
            found = memory(card)
            return (found[0] if self.free is None else self.free), found[1]

        def shared(card: Card, kernel: Any, size: int) -> int:
            return allow_shared(card, kernel, size if self.shared is None else min(size, self.shared))

        for name, own in (("launch", launched), ("memory", free), ("allow_shared", shared)):
            monkeypatch.setattr(Card, name, own)


@pytest.fixture
def watched(monkeypatch: pytest.MonkeyPatch) -> Watched:
    """What is asked of cards."""
    return Watched(monkeypatch)
