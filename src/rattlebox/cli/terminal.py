"""What commands print on."""

from __future__ import annotations

from rich.console import Console


def terminal(*, stderr: bool = False) -> Console:
    """Return a console that prints texts as they are: names of files and parts may hold square brackets and colons.

    Parameters
    ----------
    stderr
        Print where errors go.
    """
    return Console(stderr=stderr, highlight=False, markup=False, emoji=False)
