"""What a tab uses of the page that holds it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import ClassVar, Protocol

import rattlebox as rb

from .draft import Draft


class Host(Protocol):
    """The page of a tab: its case, its folder, and what a tab may ask for."""

    runs_in_progress: ClassVar[set[str]]
    draft: Draft
    folder: Path

    def publish(self, slot: str, body: Callable[..., bytes]) -> str:
        """Serve a body; return its URL."""

    def use_text(self, text: str) -> None:
        """Replace the case by the text of a case file."""

    def show_watch(self) -> None:
        """Show the tab with the run."""

    async def show_saved(self, name: str, run: rb.Run) -> None:
        """Show a run of the folder."""

    async def resume(self, name: str) -> None:
        """Resume a paused run of the folder."""
