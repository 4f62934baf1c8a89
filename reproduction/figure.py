"""Parts of a reproduced figure: data, drawing, caption and claims."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from string import ascii_lowercase
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from rattlebox import Case

    from .judge import Claim


@dataclass(frozen=True)
class Reproduction:
    """One reproduced figure."""

    number: str
    title: str
    data: Callable[[], xarray.Dataset]
    draw: Callable[[xarray.Dataset], Figure]
    caption: Callable[[xarray.Dataset], str]
    cases: Callable[[], Mapping[str, Case]] = dict
    claims: Callable[[xarray.Dataset], Sequence[Claim]] = lambda data: ()
    lessons: Callable[[xarray.Dataset], Sequence[str]] = lambda data: ()
    film: Callable[[xarray.Dataset], str] = lambda data: ""

    @property
    def name(self) -> str:
        """Stem of the file names of the figure: "figure_07c", "figure_07de" for "7d, 7e"."""
        whole, *parts = re.findall(r"^[A-Z]?\d+|[a-z]", self.number)
        return f"figure_{whole.zfill(2)}{''.join(parts)}"


def letters(figure: Figure) -> None:
    """Put a bold letter before the title of each panel of a figure, in the order in which the panels were made."""
    panels = [axes for axes in figure.axes if axes.get_label() != "<colorbar>"]
    for letter, axes in zip(ascii_lowercase, panels, strict=False):
        axes.set_title(rf"$\bf{{({letter})}}$ {axes.get_title('left')}".rstrip(), loc="left")
