"""Figure of basins of attraction: the motion to which each start leads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ..model.errors import Hint
from .labels import StudyAxis, unit_of
from .style import FAINT, INK, StyledFigure, figure_style, map_colours, pen
from .types import Size, Style

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

_COLOURED = 6
_OTHER, _NONE, _FAILED, _TRANSIENT = range(_COLOURED, _COLOURED + 4)
_TEXTS = {_OTHER: "smaller basins", _NONE: "no period found", _FAILED: "did not finish", _TRANSIENT: "still transient"}


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
        x, y = (_axis(maps[dim]) for dim in dims)
        attractor = maps["attractor"].values.T
        # Attractors are numbered from 1 by size; 0 is a motion without period, -2 transient, other negatives failed.
        kinds = np.where(attractor > _COLOURED, _OTHER, attractor - 1)
        kinds = np.where(attractor == 0, _NONE, np.where(attractor < 0, _FAILED, kinds))
        kinds = np.where(attractor == -2, _TRANSIENT, kinds)
        palette = _palette()
        norm = BoundaryNorm(np.arange(-0.5, _TRANSIENT + 1), _TRANSIENT + 1)
        axes.pcolormesh(x.edges, y.edges, kinds, cmap=palette, norm=norm, rasterized=True)
        x.label(axes, "x")
        y.label(axes, "y")
        _draw_strobes(axes, maps, dict(zip(dims, (x, y), strict=True)), palette)
        handles = [
            Patch(facecolor=palette(kind), edgecolor=FAINT, linewidth=pen(0.5), label=_legend_text(maps, kind, kinds))
            for kind in np.unique(kinds).tolist()
        ]
        figure.legend(handles=handles, loc="outside lower left", ncols=1 if size == "column" else 2, handlelength=1.2)
    return figure


def _axis(coord: xr.DataArray) -> StudyAxis:
    """Return an axis of the map; a start without unit is a part of the gap."""
    axis = StudyAxis.of(coord)
    if str(coord.name).endswith("start") and not axis.values.unit:
        return axis._replace(values=axis.values._replace(unit="part of the gap"))
    return axis


def _palette() -> ListedColormap:
    """Return colours in even steps of lightness for the attractors, and greys, black and white for other motions."""
    order = [0.08, 0.62, 0.86, 0.36, 0.74, 0.22]  # attractors of similar size differ most
    return ListedColormap([*map_colours()(order), FAINT, INK, "white", "0.9"])


def _legend_text(maps: xr.Dataset, kind: int, kinds: NDArray[np.int_]) -> str:
    if kind in _TEXTS:
        return f"{_TEXTS[kind]}, {_percent(float(np.mean(kinds == kind)))}"
    orbit = maps.isel(orbit=kind)
    period = int(orbit["orbit_period"])
    count = round(float(orbit["orbit_impacts_per_cycle"]) * period)
    span = "per cycle" if period == 1 else f"in {period} cycles"
    impacts = f"{count} impact{'s' * (count != 1)} {span}" if count else "no impacts"
    return f"{impacts}, {_percent(float(orbit['share']))}"


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %" if share < 0.1 else f"{100 * share:.0f} %"


def _draw_strobes(axes: Axes, maps: xr.Dataset, axis_of: Mapping[str, StudyAxis], palette: ListedColormap) -> None:
    """Mark the attractors in the phase plane of their ball, if the motion of the cavity is prescribed."""
    paths = {path.rpartition(".")[2]: path for path in axis_of}
    if paths.keys() != {"start", "velocity"} or "gap" not in maps.attrs:
        return
    length = 1.0 if unit_of(maps[paths["start"]]) else float(maps.attrs["gap"])
    for kind in range(min(_COLOURED, maps.sizes["orbit"])):
        orbit = maps.isel(orbit=kind, ball=0)
        if not orbit["orbit_impacts_per_cycle"] > 0:
            continue
        state = {
            paths["start"]: orbit["orbit_relative_position"].values / length,
            paths["velocity"]: orbit["orbit_relative_velocity"].values,
        }
        x, y = (state[path] / axis.values.divisor for path, axis in axis_of.items())
        style: Style = {"markeredgecolor": "white", "markeredgewidth": pen(0.8)}
        axes.plot(x, y, "o", markersize=pen(3.5), color=palette(kind), **style)
