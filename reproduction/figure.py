"""Parts of a reproduced figure: data, drawing, caption and claims."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from rattlebox import Case

Verdict = Literal["reproduced", "reproduced qualitatively", "not reproducible", "misprint"]


class Claim(NamedTuple):
    """Measurable statement of the paper with a verdict."""

    statement: str
    """Statement of the paper, paraphrased."""
    where: str
    """Section, figure or equation of the paper."""
    ours: str
    """Our result, with units."""
    interpretation: str
    """Interpretation of the paper under which the result holds."""
    verdict: Verdict


@dataclass(frozen=True)
class Reproduction:
    """One reproduced figure.

    Parameters
    ----------
    number
        Number in the paper ("4", "7c"), "A1", "A2", ... for additional studies, or "R1" for the interpretations.
    title
        Title of one line.
    data
        Function that computes the data: an xarray.Dataset in SI units, in which each variable and coordinate has the
        attributes `units` ("" for a pure number) and `long_name`.
    draw
        Function that draws the dataset in the style of `rattlebox.plots`.
    caption
        Function that describes the figure in one to four sentences with the numbers of the dataset.
    cases
        Function that returns the cases of the figure by name; all runs of `data` differ from them in numbers only.
    claims
        Function that returns verdicts on the statements of the paper, based on the dataset.
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
        """Stem of the file names of the figure: "figure_07c", "figure_07de" for "7d, 7e"."""
        whole, *parts = re.findall(r"^[A-Z]?\d+|[a-z]", self.number)
        return f"figure_{whole.zfill(2)}{''.join(parts)}"
