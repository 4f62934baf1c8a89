"""Figure of basins of attraction: the motion to which each start leads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ..model.errors import Hint
from ..results.figures import study_figure
from .style import FAINT, INK, Size, StyledFigure, figure_style, label, map_colours, pen, scaled

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_COLOURED = 6
_OTHER, _NONE, _FAILED, _TRANSIENT = _COLOURED, _COLOURED + 1, _COLOURED + 2, _COLOURED + 3


@study_figure("basins")
def plot_basins(maps: xr.Dataset, *, size: Size = "column") -> Figure:
    """Draw a map of starts, each in the colour of the attractor to which it leads.

    If there are more than six attractors, the smaller ones share a colour. A map over position and velocity of one ball in
    a cavity with prescribed motion also shows the stroboscopic points of the attractors.

    Parameters
    ----------
    maps
        Dataset from `rb.basins`, over two axes.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with one panel.

    Raises
    ------
    CaseError
        If the starts vary along one axis, or along more than two.
    ValueError
        If the size is unknown.
    """
    dims = [str(dim) for dim in maps["attractor"].dims]
    if len(dims) != 2:
        raise Hint(
            f"the starts vary along {', '.join(dims)}; a map needs two axes", "maps.isel(...) to fix further axes"
        )
    with figure_style(size):
        figure = StyledFigure(size, 1.0 if size == "column" else 0.62)
        axes = figure.subplots()
        x, y = (_Axis(maps[dim]) for dim in dims)
        attractor = maps["attractor"].values.T
        kinds = np.where(attractor > _COLOURED, _OTHER, attractor - 1)
        kinds = np.where(attractor == 0, _NONE, np.where(attractor < 0, _FAILED, kinds))
        kinds = np.where(attractor == -2, _TRANSIENT, kinds)
        palette = _palette()
        norm = BoundaryNorm(np.arange(-0.5, _TRANSIENT + 1), _TRANSIENT + 1)
        axes.pcolormesh(x.edges, y.edges, kinds, cmap=palette, norm=norm, rasterized=True)
        x.label(axes, "x")
        y.label(axes, "y")
        _draw_strobes(axes, maps, x, y, palette)
        handles = [
            Patch(facecolor=palette(kind), edgecolor=FAINT, linewidth=pen(0.5), label=_legend_text(maps, kind, kinds))
            for kind in np.unique(kinds).tolist()
        ]
        figure.legend(handles=handles, loc="outside lower left", ncols=1 if size == "column" else 2, handlelength=1.2)
    return figure


class _Axis:
    """Axis of the map."""

    def __init__(self, coord: xr.DataArray) -> None:
        unit = str(coord.attrs.get("units", "1"))
        numbers = coord.dtype.kind in "fiu"
        values = coord.values if numbers else np.arange(coord.size)
        self.divisor, self.unit = scaled(values, unit) if numbers and unit != "1" else (1.0, "")
        self.coord, self.centres = coord, values / self.divisor
        self.texts = None if numbers else [str(value) for value in coord.values]

    @property
    def edges(self) -> Any:
        """Edges of the cells, (n + 1,)."""
        c = self.centres
        if len(c) == 1:
            return c[0] + np.array([-0.5, 0.5])
        inner = 0.5 * (c[1:] + c[:-1])
        return np.concatenate([[2 * c[0] - inner[0]], inner, [2 * c[-1] - inner[-1]]])

    def label(self, axes: Axes, which: Any) -> None:
        """Label an axis of the figure and its ticks."""
        text = str(self.coord.attrs.get("long_name", self.coord.name))
        fraction = str(self.coord.name).endswith("start") and not self.unit
        label(axes, which, text[:1].upper() + text[1:], "part of the gap" if fraction else self.unit)
        if self.texts:
            axis = axes.xaxis if which == "x" else axes.yaxis
            axis.set_ticks(self.centres, self.texts)


def _palette() -> ListedColormap:
    """Return colours in even steps of lightness for the attractors, and greys, black and white for other motions."""
    order = [0.08, 0.62, 0.86, 0.36, 0.74, 0.22]  # attractors of similar size differ most
    return ListedColormap([*map_colours()(order), FAINT, INK, "white", "0.9"])


def _legend_text(maps: xr.Dataset, kind: int, kinds: Any) -> str:
    if kind >= _OTHER:
        text = {
            _OTHER: "smaller basins",
            _NONE: "no period found",
            _FAILED: "did not finish",
            _TRANSIENT: "still transient",
        }[kind]
        return f"{text}, {_percent(float(np.mean(kinds == kind)))}"
    orbit = maps.isel(orbit=kind)
    period, hits = int(orbit["orbit_period"]), float(orbit["orbit_impacts_per_cycle"])
    if hits == 0:
        text = "no impacts"
    else:
        count = round(hits * period)
        span = "per cycle" if period == 1 else f"in {period} cycles"
        text = f"{count} impact{'s' * (count != 1)} {span}"
    return f"{text}, {_percent(float(orbit['share']))}"


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %" if share < 0.1 else f"{100 * share:.0f} %"


def _draw_strobes(axes: Axes, maps: xr.Dataset, x: _Axis, y: _Axis, palette: ListedColormap) -> None:
    """Mark the attractors in the phase plane of their ball, if the motion of the cavity is prescribed."""
    names = [str(axis.coord.name).rsplit(".", 1)[-1] for axis in (x, y)]
    if names not in (["start", "velocity"], ["velocity", "start"]) or "gap" not in maps.attrs:
        return
    for kind in range(min(_COLOURED, maps.sizes["orbit"])):
        orbit = maps.isel(orbit=kind, ball=0)
        place, speed = orbit["orbit_relative_position"].values, orbit["orbit_relative_velocity"].values
        if not orbit["orbit_impacts_per_cycle"] > 0:
            continue
        start = place / (1.0 if (x if names[0] == "start" else y).unit else maps.attrs["gap"])
        points = (
            [start / x.divisor, speed / y.divisor] if names[0] == "start" else [speed / x.divisor, start / y.divisor]
        )
        axes.plot(
            *points, "o", markersize=pen(3.5), color=palette(kind), markeredgecolor="white", markeredgewidth=pen(0.8)
        )
