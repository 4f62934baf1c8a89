"""Figures of frequency responses: the steady motion over frequency at several levels, swept up and down."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from rattlebox._util.exceptions import CaseError

from ..model.errors import nearest
from ..studies.work.reductions import Motion
from .labels import capitalised, interval_ends, log_ticks, name_of
from .style import ABOVE, FAINT, INK, StyledFigure, figure_style, label, pen, scaled, series_colour
from .types import Size, Style

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

_STYLES = {"up": "-", "down": (0, (3.5, 1.5)), "fresh": (0, (1, 1.2))}
_COEXISTING = 0.02  # relative difference between up and down above which two motions coexist
_DISPLACEMENTS = "amplitude", "peak", "rms", "bare_amplitude"


def plot_frequency_response(
    response: xarray.Dataset, of: str | Sequence[str] | None = None, *, per_level: bool = False, size: Size = "column"
) -> Figure:
    """Draw measures of the steady motion over frequency, one colour per level and one panel per measure.

    Upward sweeps are solid lines and downward sweeps dashed; the area between two coexisting motions is shaded, and so are
    the 95 % intervals. Crosses mark motions of impact dampers that are not periodic, triangles those that are still
    transient.

    Parameters
    ----------
    response
        Dataset from `rattlebox.frequency_response`.
    of
        Measures: "amplitude", "peak", "rms", "phase", "impacts_per_cycle", or another measure of the dataset; default
        "amplitude" and "impacts_per_cycle", or "phase" for particle dampers.
    per_level
        Whether to divide displacements by the level, so that the curves of a linear structure coincide.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with one panel per measure.

    Raises
    ------
    CaseError
        If there is no such measure.
    ValueError
        If the size is unknown.
    """
    if of is None:
        of = "amplitude", "impacts_per_cycle" if "impacts_per_cycle" in response else "phase"
    names = [of] if isinstance(of, str) else list(of)
    for name in names:
        if name not in response or response[name].dims != ("direction", "level", "frequency"):
            known = [str(n) for n, v in response.items() if v.dims == ("direction", "level", "frequency")]
            raise CaseError(f"the response has no measure {name!r}", nearest(name, known))
    with figure_style(size):
        figure = StyledFigure(size, 0.3 + (0.4 if size == "column" else 0.2) * len(names))
        panels = np.atleast_1d(figure.subplots(len(names), 1, sharex=True, height_ratios=[2] + [1] * (len(names) - 1)))
        for axes, name in zip(panels, names, strict=True):
            _draw(axes, response, name, per_level and name in _DISPLACEMENTS)
        divisor, unit = scaled(response.frequency, "Hz")
        label(panels[-1], "x", "Frequency", unit)
        panels[-1].set_xlim(float(response.frequency[0]) / divisor, float(response.frequency[-1]) / divisor)
        panels[0].legend(handles=level_handles(response), **ABOVE, ncols=4)
        figure.legend(handles=_line_handles(response), loc="outside upper left", ncols=3 if size == "column" else 5)
    return figure


def _draw(axes: Axes, response: xarray.Dataset, name: str, per_level: bool) -> None:
    values = response[name] / response.level if per_level else response[name]
    unit = str(response[name].attrs["units"]).replace("1", "") + (f"/{response.level.attrs['units']}" * per_level)
    divisor, prefixed = scaled(values, unit) if unit != "rad" else (1.0, unit)
    frequency = response.frequency / scaled(response.frequency, "Hz").divisor
    if name in _DISPLACEMENTS:
        bare = (response.bare_amplitude / response.level)[:1] if per_level else response.bare_amplitude
        axes.plot(frequency, bare.T / divisor, color=FAINT, lw=pen(0.8), zorder=0)
        axes.set_yscale("log")
        log_ticks(axes.yaxis)
    for k, level in enumerate(response.level.values):
        colour = series_colour(k)
        lines = values.sel(level=level) / divisor
        if {"up", "down"} <= set(response.direction.values):
            low, high = lines.min("direction"), lines.max("direction")
            coexisting = high - low > _COEXISTING * np.maximum(abs(high), abs(low))
            axes.fill_between(frequency, low, high, where=coexisting, color=colour, alpha=0.25, lw=0)
        for direction in response.direction.values:
            line = lines.sel(direction=direction)
            axes.plot(frequency, line, color=colour, ls=_STYLES[str(direction)])
            if f"{name}_interval" in response:
                half = response[f"{name}_interval"].sel(level=level, direction=direction) / divisor
                half = half / level if per_level else half
                axes.fill_between(frequency, *interval_ends(name, line, half), color=colour, alpha=0.4, lw=0)
            if _has_impacts(response):
                one = response.sel(level=level, direction=direction)
                transient = _is_transient(one)
                axes.plot(frequency, line.where((one.period == 0) & ~transient), "x", color=colour, **_mark())
                axes.plot(frequency, line.where(transient), "v", color=colour, mfc="none", **_mark())
    observed = response.attrs.get("observed") if name in _DISPLACEMENTS else None
    place = f" of {observed}" if observed else ""
    label(axes, "y", capitalised(name_of(response[name])) + place + " over level" * per_level, prefixed)


def level_handles(response: xarray.Dataset) -> list[Line2D]:
    """Return the entries of a legend for the levels of a response, in the colours of their order."""
    divisor, unit = scaled(response.level, str(response.level.attrs["units"]))
    return [
        Line2D([], [], color=series_colour(k), label=f"{level:.4g} {unit}")
        for k, level in enumerate(response.level.values / divisor)
    ]


def _line_handles(response: xarray.Dataset) -> list[Line2D | Patch]:
    directions = [str(direction) for direction in response.direction.values]
    handles: list[Line2D | Patch] = [
        Line2D([], [], color=INK, ls=_STYLES[direction], label=direction) for direction in directions
    ]
    if {"up", "down"} <= set(directions):
        handles.append(Patch(color=INK, alpha=0.25, lw=0, label="coexisting"))
    if _has_impacts(response):
        handles.append(Line2D([], [], color=INK, ls="", marker="x", label="irregular", **_mark()))
        if _is_transient(response).any():
            handles.append(Line2D([], [], color=INK, ls="", marker="v", mfc="none", label="transient", **_mark()))
    return [*handles, Line2D([], [], color=FAINT, lw=pen(0.8), label="no damper")]


def _mark() -> Style:
    """Return the size of marks."""
    return {"ms": pen(2.5), "mew": pen(0.5)}


def _is_transient(response: xarray.Dataset) -> xarray.DataArray:
    """Return where motions still come closer to a periodic one."""
    found: xarray.DataArray = response.motion == Motion.TRANSIENT if "motion" in response else response.period < 0
    return found


def _has_impacts(response: xarray.Dataset) -> bool:
    """Return whether motions may repeat: those of particles do not."""
    return "impacts_per_cycle" in response
