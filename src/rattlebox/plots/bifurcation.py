"""Bifurcation diagrams: stroboscopic points or impacts over a parameter, and the period of the motion in cycles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.typing import ColorType

from rattlebox._util.narrow import present

from ..model.errors import Hint, nearest
from ..studies.work.reductions import Motion
from .labels import LabelledValues, capitalised, name_of, unit_of
from .style import FAINT, INK, SERIES_COLOURS, StyledFigure, figure_style, label, legend_above, pen, scaled
from .types import Size, Style, Vector

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

TEXTS = {
    "relative_position": "Ball position in cavity",
    "relative_velocity": "Ball velocity in cavity",
    "displacement": "Displacement",
    "velocity": "Velocity",
    "approach_speed": "Approach speed",
    "impact_phase": "Phase of the load at impact",
}
_PERIODS = ("1", "2", "3", "4", "more", "none", "transient")
_NONE, _TRANSIENT = 5, 6
_LABELS = {"status", "period", "motion"}
"""Variables over direction and parameter that are no measures."""
_PHASES = 0.5 * np.pi * np.arange(5)
_PHASE_NAMES = ("0", "π/2", "π", "3π/2", "2π")


def plot_bifurcation(maps: xr.Dataset, of: str | None = None, *, ball: int = 0, size: Size = "column") -> Figure:
    """Draw a bifurcation diagram: each stroboscopic point, impact or measure is a dot over the parameter.

    The strip below shows the period of the motion in cycles, one row for each direction, and where the motion is still
    transient.

    Parameters
    ----------
    maps
        Dataset from `rb.bifurcation`.
    of
        At the strobes "relative_position" or "relative_velocity" of a ball, or "displacement" or "velocity" of the
        structure; of the impacts "approach_speed" or "impact_phase"; or "impacts_per_cycle" and other measures of the
        dataset. Default: the approach speed, or the position of the ball if the dataset has no impacts.
    ball
        Index of the ball, for a quantity of balls.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with two panels.

    Raises
    ------
    CaseError
        If there is no such quantity or ball.
    ValueError
        If the size is unknown.
    """
    measures = [str(name) for name, one in maps.items() if one.dims == maps["period"].dims and name not in _LABELS]
    known = [*(name for name in TEXTS if name in maps), *measures]
    of = of or ("approach_speed" if "approach_speed" in known else "relative_position")
    if of not in known:
        raise Hint(f"of = {of!r}: the diagram has no such quantity", nearest(of, known))
    values = maps[of]
    if "ball" in values.dims:
        if not 0 <= ball < values.sizes["ball"]:
            raise Hint(f"ball = {ball!r}: the case has no ball with this index", f"0 to {values.sizes['ball'] - 1}")
        values = values.isel(ball=ball)
    parameter = LabelledValues.of(maps[next(dim for dim in maps["period"].dims if dim != "direction")])
    with figure_style(size):
        figure = StyledFigure(size, 0.95 if size == "column" else 0.6)
        directions = maps["direction"].values.tolist()
        heights = (8 - len(directions) * 0.5, len(directions) * 0.6)
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=heights)
        _draw_points(upper, parameter.numbers, values, directions)
        _draw_periods(lower, parameter.numbers, maps)
        parameter.label(lower, "x")
    return figure


def _draw_points(axes: Axes, x: Vector, values: xr.DataArray, directions: list[str]) -> None:
    unit = unit_of(values)
    divisor, prefixed = (1.0, unit) if unit in ("rad", "") else scaled(values.values, unit)
    for number, direction in reversed(list(enumerate(directions))):  # the first one is drawn on top
        y = values.isel(direction=number).values / divisor
        dots: Style = {"linestyle": "none", "marker": "o", "markersize": pen(0.9 + 0.7 * number), "markeredgewidth": 0}
        colour = SERIES_COLOURS[number]
        axes.plot(np.repeat(x, y[0].size), y.ravel(), color=colour, label=direction, rasterized=True, **dots)
    label(axes, "y", TEXTS.get(str(values.name)) or capitalised(name_of(values)), prefixed)
    axes.margins(y=0.04)
    if unit == "rad":
        axes.set_yticks(_PHASES, _PHASE_NAMES)
        axes.set_ylim(-0.1, 2 * np.pi + 0.1)
    if len(directions) > 1:
        legend_above(axes, markerscale=pen(4.0), reverse=True)


def _draw_periods(axes: Axes, x: Vector, maps: xr.Dataset) -> None:
    """Draw the period of the motion in cycles."""
    from cmcrameri import cm  # type: ignore[import-untyped]

    palette = ListedColormap([*cm.devon(np.linspace(0.95, 0.35, _NONE)), INK, FAINT])
    period = maps["period"].transpose("direction", ...).values
    kinds = np.where(period == 0, _NONE, np.minimum(period, _NONE) - 1).astype(float)
    if "motion" in maps:
        kinds[maps["motion"].transpose("direction", ...).values == Motion.TRANSIENT] = _TRANSIENT
    kinds[maps["status"].transpose("direction", ...).values != 0] = np.nan
    edges = np.concatenate([x[:1], 0.5 * (x[1:] + x[:-1]), x[-1:]]) if len(x) > 1 else x[0] + np.array([-0.5, 0.5])
    norm = BoundaryNorm(np.arange(-0.5, len(_PERIODS)), len(_PERIODS))
    rows = np.arange(len(kinds) + 1)
    axes.pcolormesh(edges, rows, kinds, cmap=palette, norm=norm, rasterized=True)
    axes.hlines(rows[1:-1], edges[0], edges[-1], color="white", linewidth=pen(1.0))
    axes.set_yticks(rows[:-1] + 0.5, maps["direction"].values.tolist())
    axes.invert_yaxis()
    axes.tick_params(axis="y", length=0)
    colours: dict[str, ColorType] = {text: palette(kind) for kind, text in enumerate(_PERIODS) if (kinds == kind).any()}
    if np.isnan(kinds).any():
        colours["did not finish"] = "white"
    frame: Style = {"edgecolor": FAINT, "linewidth": pen(0.5)}
    handles = [Patch(facecolor=colour, label=text, **frame) for text, colour in colours.items()]
    figure = present(axes.get_figure(root=True))
    spacing: Style = {"handlelength": 1.0, "columnspacing": 1.0, "title_fontsize": "small"}
    figure.legend(handles=handles, title="Period in cycles", loc="outside lower center", ncols=len(handles), **spacing)
