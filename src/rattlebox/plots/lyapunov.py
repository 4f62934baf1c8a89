"""Figures of Lyapunov exponents: their convergence, and their values over one or two axes of a study."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import LinearSegmentedColormap, ListedColormap, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import ArrayLike

from rattlebox._util.exceptions import CaseError

from .labels import StudyAxis, unit_of
from .style import ABOVE, FAINT, INK, SERIES_COLOURS, StyledFigure, colour_bar, figure_style, label, pen
from .types import Size, Style

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

_REGULAR, _CHAOTIC = SERIES_COLOURS[:2]
_MAX_LINES = 200  # of the convergence


def plot_lyapunov(study: xarray.Dataset, *, size: Size = "column") -> Figure:
    """Draw Lyapunov exponents per cycle of the load, or per second if there is no cycle.

    For one case, the figure shows the convergence of the exponent; over one axis, also the exponents with twice their
    standard error; over two axes, a map. Positive exponents (chaos) have warm, light colours and negative ones cold, dark
    colours. Exponents are grey if they are positive but no larger than those of neighbouring motions that separate in
    proportion to time. Exponents of -inf are drawn at the lower edge.

    Parameters
    ----------
    study
        Dataset from `rattlebox.lyapunov`, over at most two axes.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with one panel, or two for a study over one axis.

    Raises
    ------
    CaseError
        If the study has more than two axes.
    ValueError
        If the size is unknown.
    """
    values = study.growth_per_cycle if "growth_per_cycle" in study else study.exponent
    if values.ndim > 2:
        raise CaseError(
            f"the study varies along {', '.join(map(str, values.dims))}; at most two axes can be drawn",
            "study.sel(...) to fix the others",
        )
    with figure_style(size):
        if values.ndim == 2:
            figure = StyledFigure(size, 0.75 if size == "column" else 0.6)
            _map(figure, study, values)
            return figure
        figure = StyledFigure(size, 0.6 if values.ndim == 0 else 1.1 if size == "column" else 0.45)
        if values.ndim == 0:
            _convergence(figure.subplots(), study, values)
        else:
            panels = figure.subplots(*((2, 1) if size == "column" else (1, 2)), sharey=True)
            _exponents(panels[0], study, values)
            _convergence(panels[1], study, values)
    return figure


def _text(values: xarray.DataArray) -> str:
    return "Growth per cycle" if values.name == "growth_per_cycle" else "Exponent"


def _resolution(study: xarray.Dataset) -> float:
    """Return the exponent of a separation that grows in proportion to time from the first step to the last."""
    steps = study[study.running_exponent.dims[-1]].values
    return float(np.log(steps.size) / steps[-1])


def _limits(values: ArrayLike) -> tuple[float, float]:
    """Return the limits of an axis that shows all finite values and zero."""
    finite = np.asarray(values)[np.isfinite(values)]
    low, high = min(0.0, finite.min(initial=0.0)), max(0.0, finite.max(initial=0.0))
    margin = 0.06 * (high - low) or 1.0
    return low - margin, high + margin


def _convergence(axes: Axes, study: xarray.Dataset, values: xarray.DataArray) -> None:
    running = study.running_exponent
    over = running.dims[-1]
    times = study[over]
    factor = values / study.exponent if values.name == "growth_per_cycle" else 1.0
    lines = np.atleast_2d((running * factor).transpose(..., over).values)
    ends = np.atleast_1d(values.values)
    indices = np.unique(np.linspace(0, len(lines) - 1, _MAX_LINES).astype(int))
    for k in indices:
        colour = _REGULAR if ends[k] <= 0 else _CHAOTIC if ends[k] > _resolution(study) else FAINT
        axes.plot(times, lines[k], color=colour, lw=pen(0.9 if len(indices) == 1 else 0.4))
    axes.axhline(0, color=INK, lw=pen(0.5), zorder=0)
    if values.ndim == 0:
        error = 2 * float(study.standard_error * factor)
        axes.axhspan(float(values) - error, float(values) + error, color=FAINT, alpha=0.5, lw=0, zorder=0)
    # The first tenth of the steps, where the exponent still jumps, does not set the scale.
    axes.set_ylim(*_limits(lines[:, lines.shape[1] // 10 :]))
    axes.set_xlim(0, float(times[-1]))
    label(axes, "x", "Cycles" if over == "cycle" else "Averaging time", "" if over == "cycle" else "s")
    label(axes, "y", _text(values), unit_of(values))


def _exponents(axes: Axes, study: xarray.Dataset, values: xarray.DataArray) -> None:
    axis = StudyAxis.of(values[values.dims[0]])
    x = axis.values.numbers
    error = 2 * np.nan_to_num(study.standard_error.values * (values / study.exponent).fillna(1.0).values)
    positive, chaotic = values.values > 0, values.values > _resolution(study)
    style: Style = {"ms": pen(2), "lw": pen(0.6), "mew": 0}
    kinds = ((chaotic, _CHAOTIC, "o"), (positive & ~chaotic, FAINT, "D"), (~positive, _REGULAR, "s"))
    for mask, colour, marker in kinds:
        axes.errorbar(x[mask], values.values[mask], error[mask], fmt=marker, color=colour, **style)
    endless = x[np.isneginf(values.values)]
    if endless.size:
        axes.plot(endless, np.full(endless.size, _limits(values)[0]), "v", color=_REGULAR, ms=pen(3), clip_on=False)
    axes.axhline(0, color=INK, lw=pen(0.5), zorder=0)
    axes.margins(x=0.02)
    axis.label(axes, "x")
    label(axes, "y", _text(values), unit_of(values))


def _map(figure: Figure, study: xarray.Dataset, values: xarray.DataArray) -> None:
    axes = figure.subplots()
    y, x = (StudyAxis.of(values[name]) for name in values.dims)
    finite = values.values[np.isfinite(values.values)]
    # Single runs with extreme exponents would leave one colour for all others. Both sides of zero need a colour.
    low, high = np.quantile(finite, (0.02, 0.98)) if finite.size else (-1.0, 1.0)
    norm = TwoSlopeNorm(0.0, min(low, -1e-9 * abs(high) - 1e-12), max(high, 1e-9 * abs(low) + 1e-12))
    shown = np.clip(values.values, norm.vmin, norm.vmax)
    mesh = axes.pcolormesh(x.edges, y.edges, shown, norm=norm, cmap=_colours(), rasterized=True)
    neutral = (values.values > 0) & (values.values <= _resolution(study))
    if neutral.any():
        grey = np.where(neutral, 0.0, np.nan)
        axes.pcolormesh(x.edges, y.edges, grey, cmap=ListedColormap([FAINT]), rasterized=True)
        patch = Patch(color=FAINT, label="indistinguishable from zero")
        axes.legend(handles=[patch], **ABOVE)
    x.label(axes, "x")
    y.label(axes, "y")
    unit = unit_of(values)
    text = f"{_text(values)} ({unit})" if unit else _text(values)
    colour_bar(figure, mesh, axes, text, extend="both", aspect=30)


def _colours() -> LinearSegmentedColormap:
    """Return colours whose lightness rises monotonically, and whose hue changes at zero."""
    stops = [(0.0, "#0a1f3a"), (0.5, "#5f86a8"), (0.5, "#d1742c"), (1.0, "#fdf0d2")]
    return LinearSegmentedColormap.from_list("sign", stops)
