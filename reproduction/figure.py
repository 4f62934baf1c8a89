"""A reproduced figure: numbers and drawing from its module, words from figures.toml and claims.toml."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from string import ascii_lowercase
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rattlebox import Case
from rattlebox.plots import StyledFigure, figure_style

from .judge import CLAIMS, Claim, cells_of, claim_of

WORDS: Mapping[str, Any] = tomllib.loads(Path(__file__).with_name("figures.toml").read_text(encoding="utf-8"))
QUANTILES = {"quantile": [0.1, 0.5, 0.9]}  # of an ensemble, as a coordinate


@dataclass(frozen=True)
class Reproduction:
    """One figure; all runs of `compute` differ from its cases in numbers only."""

    key: str  # in figures.toml and claims.toml
    compute: Callable[[], xr.Dataset]  # in SI units
    paint: Callable[[StyledFigure, xr.Dataset], None]
    height: float  # over the width
    cases: Callable[[], Mapping[str, Case]]
    values: Callable[
        [xr.Dataset], Mapping[str, Any]
    ]  # numbers of caption, notes and lessons, and of claims by their id
    film: Callable[[xr.Dataset], str] = field(default=lambda data: "")  # as an SVG element

    @property
    def number(self) -> str:
        """Number in the paper ("7c"), "R1", ... for figures that judge the paper, "A1", ... for its extensions."""
        return str(WORDS[self.key]["number"])

    @property
    def title(self) -> str:
        """Title of one line."""
        return str(WORDS[self.key]["title"])

    @property
    def name(self) -> str:
        """Stem of the file names of the figure: "figure_07c", "figure_07de" for "7d, 7e"."""
        whole, *parts = re.findall(r"^[A-Z]?\d+|[a-z]", self.number)
        return f"figure_{whole.zfill(2)}{''.join(parts)}"

    def data(self) -> xr.Dataset:
        """Compute the data; each variable and coordinate has the attributes `units` and `long_name`."""
        data = self.compute()
        columns = WORDS["columns"] | WORDS[self.key]["columns"]
        for name, variable in data.variables.items():
            variable.attrs.update(zip(("units", "long_name"), columns[name], strict=True))
        return data

    def draw(self, data: xr.Dataset) -> Figure:
        """Draw the data in the style of `rattlebox.plots`, with a bold letter before the title of each panel."""
        with figure_style("page"):
            figure = StyledFigure("page", self.height)
            self.paint(figure, data)
            panels = [axes for axes in figure.axes if axes.get_label() != "<colorbar>"]
            for letter, axes in zip(ascii_lowercase, panels, strict=False):
                axes.set_title(rf"$\bf{{({letter})}}$ {axes.get_title('left')}".rstrip(), loc="left")
        return figure

    def _fill(self, data: xr.Dataset, values: Mapping[str, Any], texts: Sequence[str]) -> list[str]:
        """Return texts with the numbers of the data: its variables of one number or row, attributes, and values."""
        rows = {str(name): variable for name, variable in data.variables.items() if variable.ndim < 2}
        claims = {row["id"] for row in CLAIMS.get(self.key, ())}  # their values are no numbers of texts
        every = {**rows, **data.attrs, **{name: value for name, value in values.items() if name not in claims}}
        numbers = {k: np.asarray(v) if isinstance(v, xr.DataArray | xr.Variable) else v for k, v in every.items()}
        return [text.format_map(numbers) for text in texts]

    def caption(self, data: xr.Dataset) -> str:
        """Return the message of the figure, then its symbols, in at most three lines of the page."""
        return self._fill(data, self.values(data), [WORDS[self.key]["caption"]])[0]

    def lessons(self, data: xr.Dataset) -> Sequence[str]:
        """Return sentences for the summary of the page."""
        return self._fill(data, self.values(data), WORDS[self.key].get("lessons", ()))

    def claims(self, data: xr.Dataset) -> Sequence[Claim]:
        """Return the claims of the paper that the data test."""
        rows, values = CLAIMS.get(self.key, ()), self.values(data)
        texts = iter(self._fill(data, values, [row.get(name, "") for row in rows for name in ("quantity", "note")]))
        return [claim_of(row, next(texts), next(texts), cells_of(values.get(row["id"], {}))) for row in rows]


def spread(
    axes: Axes, x: Any, values: Any, colour: str, *, alpha: float = 0.25, raster: bool = False, **line: Any
) -> None:
    """Draw the band of the middle 80 % of an ensemble, and its median as a line."""
    low, median, high = values
    axes.fill_between(x, low, high, color=colour, alpha=alpha, lw=0, rasterized=raster or None)
    axes.plot(x, median, color=colour, **line)
