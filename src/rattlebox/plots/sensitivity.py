"""Figure of Sobol indices as bars."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from .style import INK, SERIES_COLOURS, StyledFigure, figure_style, pen, shorten
from .types import Size

if TYPE_CHECKING:
    import xarray as xr

_BARS = (("first", "alone", SERIES_COLOURS[0]), ("total", "with interactions", SERIES_COLOURS[1]))


def plot_sensitivity(study: xr.Dataset, *, size: Size = "column") -> Figure:
    """Draw first-order and total Sobol indices with their confidence intervals, the most important parameter on top.

    Parameters
    ----------
    study
        Dataset from `rb.sensitivity`.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with one panel per measure, in one column.

    Raises
    ------
    ValueError
        If the size is unknown.
    """
    order = np.argsort(study.total.mean("measure").values)
    rows, count = study.isel(parameter=order), study.sizes["measure"]
    with figure_style(size):
        inches = count * (0.5 + 0.36 * order.size) + 0.5
        figure = StyledFigure(size, 1.0)
        scale = 1.0 if size != "slide" else 15 / 8
        figure.set_figheight(scale * inches)
        panels = figure.subplots(count, 1, sharex=True, squeeze=False).ravel()
        positions = np.arange(order.size)
        for panel, (_, row) in zip(panels, rows.groupby("measure", squeeze=False), strict=True):
            row = row.squeeze("measure")
            for side, (name, text, colour) in zip((0.19, -0.19), _BARS, strict=True):
                panel.barh(positions + side, row[name], 0.36, xerr=row[f"{name}_confidence"], color=colour, label=text,
                           error_kw={"ecolor": INK, "elinewidth": pen(0.8), "capsize": pen(1.5)})  # fmt: skip
            panel.set_yticks(positions, [shorten(str(path).replace("_", " "), 34) for path in row.parameter.values])
            panel.tick_params(axis="y", length=0)
            panel.axvline(0.0, color=INK, linewidth=pen(0.6))
            panel.spines["left"].set_visible(False)
            panel.margins(x=0.03)
            panel.set_title(str(row.measure.item()).replace("_", " "))
        panels[-1].set_xlabel("Share of the variance")
        handles, texts = panels[0].get_legend_handles_labels()
        figure.legend(handles, texts, loc="outside lower right", ncols=2)
    return figure
