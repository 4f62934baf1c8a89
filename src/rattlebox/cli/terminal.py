"""Consoles on which the commands print."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from rich.console import Console
from rich.segment import Segment

from rattlebox._util.text import printable


class _Printable(Console):
    """Console that replaces control characters, which files from elsewhere may contain."""

    def render(self, renderable: Any, options: Any = None) -> Iterable[Segment]:
        """Return the segments to print."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=printable(segment.text))


def terminal(*, stderr: bool = False) -> Console:
    """Return a console without markup, since names of files and parts may contain square brackets and colons."""
    return _Printable(stderr=stderr, highlight=False, markup=False, emoji=False)
