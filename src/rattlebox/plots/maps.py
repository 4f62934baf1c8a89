"""Maps and lines of a study: a measure over one or two of its axes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from rattlebox._util.exceptions import CaseError

from ..model.errors import nearest
from ..results.schema import OUTCOMES
from .gaps import GREY, add_gap_legend, gaps_of
from .labels import REPLICA, LabelledValues, StudyAxis, capitalised, upper_limit, value_of
from .lines import draw_lines
from .selection import select
from .style import SERIES_COLOURS, StyledFigure, colour_bar, figure_style, legend_above, letters, map_colours, shorten
from .types import Size, Style

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


def plot_map(
    study: xr.Dataset,
    of: str | None = None,
    *,
    kind: Literal["map", "lines"] | None = None,
    at: Mapping[str, Any] | None = None,
    size: Size = "column",
) -> Figure:
    """Draw a measure of a study over one or two of its axes.

    Axes with a constant ratio between their values are logarithmic. For replicas, and along an axis of seeds, a map shows
    the median, and lines show the median with a band from 10 to 90 %. Without replicas, lines have a band of the 95 %
    interval if the measure has one. Lines of up to 30 points have markers; points are hollow if the motion is not
    steady. Runs that did not finish are hatched in a map
    and marked on the axis below lines; a legend states why.

    Parameters
    ----------
    study
        Dataset from `rb.sweep` or a store, or any dataset of measures over axes.
    of
        Name of the measure; default the first.
    kind
        "map" for colours over two axes, "lines" for lines over one axis, one for each value of the other. The default is
        a map if both axes have more than six values, otherwise lines.
    at
        Values of further axes, {"load.amplitude": "5 kN"}; the nearest value in the study is drawn.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with one panel.

    Raises
    ------
    CaseError
        If there is no such measure or axis, or the study varies along more axes than can be drawn.
    ValueError
        If the size is unknown.

    Examples
    --------
    >>> import rattlebox as rb
    >>> gaps = {"damper.gap": rb.linspace("0.2 mm", "1 mm", 5)}
    >>> figure = rb.plot_map(rb.sweep(rb.reference_case(duration=1.0), gaps, ["impact_share"]))
    """
    if kind not in (None, "map", "lines"):
        raise CaseError(f"kind = {kind!r}: unknown kind of figure", nearest(str(kind), ("map", "lines")))
    # First everything that can be refused, before a figure is made.
    name = _measure_name(study, of)
    selected, title = select(study, at or {})
    selected = _seeds_as_replicas(selected, name)
    # Values that repeat along an axis are drawn once, except where a second, linked parameter distinguishes them.
    coord_dims = [coord.dims for coord in selected.coords.values()]
    repeated = [dim for dim in selected[name].dims if dim in selected.coords and coord_dims.count((dim,)) == 1]
    selected = selected.drop_duplicates(repeated).squeeze(drop=True)
    dims = [str(dim) for dim in selected[name].dims if dim != REPLICA]
    _check_axes(selected, name, dims, kind)
    with figure_style(size):
        many = len(dims) == 2 and min(selected.sizes[dim] for dim in dims) > len(SERIES_COLOURS)
        if kind == "map" or (kind is None and many):
            figure = _map_figure(selected, name, dims, size)
        else:
            figure = _lines_figure(selected, name, dims, size)
        if title:
            figure.suptitle(shorten(capitalised(title), letters(figure.axes[0])), x=0.01, ha="left", fontsize="medium")
    return figure


def _seeds_as_replicas(study: xr.Dataset, name: str) -> xr.Dataset:
    """Rename an axis of seeds to that of replicas, if there is another axis to draw along."""
    dims = [str(dim) for dim in study[name].dims if study.sizes[dim] > 1]
    seeds = [dim for dim in dims if dim.rpartition(".")[2] == "seed"]
    return study.rename({seeds[0]: REPLICA}) if len(seeds) == 1 < len(dims) and REPLICA not in dims else study


def _measure_name(study: xr.Dataset, of: str | None) -> str:
    results = ((str(name), values) for name, values in study.data_vars.items() if name not in OUTCOMES)
    measures = [name for name, values in results if values.dtype.kind in "fiu"]
    if of is None:
        if not measures:
            raise CaseError("this study has no measure to draw", "name one as measure in the study")
        return measures[0]
    if of not in study.data_vars:
        raise CaseError(f"of = {of!r}: the study has no such measure", nearest(of, measures))
    return of


def _check_axes(study: xr.Dataset, name: str, dims: list[str], kind: str | None) -> None:
    """Raise if a measure cannot be drawn over the axes that are left."""
    series = [dim for dim in dims if "status" in study and dim not in study["status"].dims]
    if series:
        raise CaseError(
            f"{name} has several values per run, along {', '.join(series)}; a map needs one", "a scalar measure"
        )
    if dims == ["sample"] and "sample" not in study.indexes:
        raise CaseError("a random design has no axes to draw along", "a grid of values")
    if not dims:
        raise CaseError(
            f"no axis of the study is left to draw along: {name} = {float(study[name].values):.6g}",
            "fewer values of at",
        )
    if len(dims) > 2 or (kind == "map" and len(dims) == 1):
        variation = f"varies along {', '.join(dims)}"
        if len(dims) == 1:
            raise CaseError(f"a map needs two axes, but {name} {variation}", "kind lines")
        last = study[dims[-1]]
        value = value_of(last, last.values[0])
        raise CaseError(f"{name} {variation}; two axes can be drawn", f"at {dims[-1]} = {value}")


def _map_figure(study: xr.Dataset, name: str, dims: list[str], size: Size) -> Figure:
    figure = StyledFigure(size, 0.78 if size == "column" else 0.56)
    axes = figure.subplots()
    draw_map(figure, axes, study, name, dims[0], dims[1])
    add_gap_legend(figure, study, name)
    return figure


def _lines_figure(study: xr.Dataset, name: str, dims: list[str], size: Size) -> Figure:
    figure = StyledFigure(size, 0.72 if size == "column" else 0.5)
    axes = figure.subplots()
    marks = draw_lines(figure, axes, study, name, dims)
    legend_above(axes)
    if marks:
        figure.legend(handles=marks, loc="outside lower left", ncols=2, handlelength=1.0)
    return figure


def draw_map(
    figure: Figure,
    axes: Axes,
    study: xr.Dataset,
    name: str,
    x: str,
    y: str,
    *,
    text: str | None = None,
    in_g: bool = True,
) -> None:
    """Draw a measure in colours over two axes, with hatches where runs did not finish."""
    values = study[name]
    if REPLICA in values.dims:
        values = values.median(REPLICA)
    measure = LabelledValues.of(values.transpose(y, x))
    x_axis, y_axis = StudyAxis.of(study[x]), StudyAxis.of(study[y])
    top = upper_limit(name, measure.numbers)
    norm = None if top is None else Normalize(0.0, top)
    mesh = axes.pcolormesh(
        x_axis.edges, y_axis.edges, measure.numbers, cmap=map_colours(), norm=norm, rasterized=True, shading="flat"
    )
    for gap in gaps_of(study, name):
        mask = gap.mask.transpose(y, x, ...).values.reshape((*measure.numbers.shape, -1)).any(axis=-1)
        left, low = x_axis.edges[:-1], y_axis.edges[:-1]
        right, high = x_axis.edges[1:], y_axis.edges[1:]
        cells = [
            [(left[i], low[j]), (right[i], low[j]), (right[i], high[j]), (left[i], high[j])]
            for j, i in np.argwhere(mask)
        ]
        style: Style = {"facecolors": gap.face, "edgecolors": GREY, "linewidths": 0, "hatch": gap.hatch}
        axes.add_collection(PolyCollection(cells, zorder=2, **style))
    x_axis.label(axes, "x", in_g=in_g)
    y_axis.label(axes, "y", in_g=in_g)
    text = measure.with_unit if text is None else text
    text += ", median" if REPLICA in study[name].dims else ""
    colour_bar(figure, mesh, axes, text, aspect=28, extend="neither" if norm is None else "max")
