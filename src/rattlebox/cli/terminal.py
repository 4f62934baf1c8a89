"""What commands print on."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from rich.console import Console
from rich.segment import Segment

from rattlebox._util.text import printable


class _Printable(Console):
    """Console without the control characters that texts hold; results of others may have any."""

    def render(self, renderable: Any, options: Any = None) -> Iterable[Segment]:
        """Return what is printed."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=printable(segment.text))


def terminal(*, stderr: bool = False) -> Console:
    """Return a console that prints texts as they are: names of files and parts may hold square brackets and colons.

    Parameters
    ----------
    stderr
        Print where errors go.
    """
    return _Printable(stderr=stderr, highlight=False, markup=False, emoji=False)
