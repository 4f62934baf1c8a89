"""What every figure of the reproduction is made of."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from rattlebox import Case

Verdict = Literal["reproduced", "reproduced in kind", "not reproducible", "misprint"]


class Claim(NamedTuple):
    """A measurable statement of the paper, judged."""

    statement: str
    """What the paper asserts, in our words."""
    where: str
    """Section, figure or equation of the paper."""
    ours: str
    """What we get, with units."""
    interpretation: str
    """Interpretation of the paper under which the result holds."""
    verdict: Verdict


@dataclass(frozen=True)
class Reproduction:
    """One figure: its data, its drawing, its words.

    Parameters
    ----------
    number
        The paper's number ("4", "7c"), or "A1", "A2", ... for what the paper left for later.
    title
        One line.
    data
        Computes everything that is drawn: an xarray.Dataset in SI units, each variable and coordinate with the
        attributes `units` ("" for a pure number) and `long_name`.
    draw
        Draws a dataset, in the style of `rattlebox.plots`.
    caption
        Says in one to four sentences what one sees, with the numbers of this dataset.
    cases
        The exact cases behind the figure, by name; every run of `data` is one of them, but for the values of numbers.
    claims
        Judges the paper's statements that this figure bears on, from this dataset.
    """

    number: str
    title: str
    data: Callable[[], xarray.Dataset]
    draw: Callable[[xarray.Dataset], Figure]
    caption: Callable[[xarray.Dataset], str]
    cases: Callable[[], Mapping[str, Case]] = dict
    claims: Callable[[xarray.Dataset], Sequence[Claim]] = lambda data: ()

    @property
    def name(self) -> str:
        """Stem of this figure's files: "figure_07c", "figure_07de" for "7d, 7e"."""
        whole, *parts = re.findall(r"^[A-Z]?\d+|[a-z]", self.number)
        return f"figure_{whole.zfill(2)}{''.join(parts)}"
