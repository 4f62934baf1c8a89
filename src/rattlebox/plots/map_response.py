"""Figure of a response from a loss map: amplitude over frequency at each level, and damping of the modes over amplitude."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from .labels import log_ticks
from .response import level_handles
from .selection import select
from .style import (
    ABOVE,
    FAINT,
    INK,
    SERIES_STYLES,
    StyledFigure,
    figure_style,
    label,
    pen,
    scaled,
    series_colour,
)
from .types import Size, Style, Vector

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes


def plot_response_from_map(
    response: xarray.Dataset,
    *,
    at: str | None = None,
    number: int | None = None,
    per_level: bool = False,
    size: Size = "page",
) -> Figure:
    """Draw the amplitude over frequency at each level, and the damping ratio of each mode over the amplitude of the damper.

    Unstable motions are dotted. Crosses mark motions with less than 95 % in the first harmonic. Lines end where the map
    ends. The structure without dampers is grey, and so are 95 % intervals of the damping ratio.

    Parameters
    ----------
    response
        Dataset from `rattlebox.response_from_map`.
    at, number
        Points and number of dampers, from the axes of the dataset; default the first.
    per_level
        Whether to divide amplitudes by the level, so that the curves of a linear structure coincide.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with two panels: side by side, or below each other at the size "column".

    Raises
    ------
    CaseError
        If the dataset has no such points or number.
    ValueError
        If the size is unknown.
    """
    chosen: Style = {"at": response["at"].values[0] if at is None else at}
    chosen["number"] = response.number.values[0] if number is None else number
    one, _ = select(response, chosen)
    with figure_style(size):
        figure = StyledFigure(size, 1.25 if size == "column" else 0.46)
        left, right = figure.subplots(2, 1) if size == "column" else figure.subplots(1, 2, width_ratios=[3, 2])
        _draw_response(left, one, per_level)
        _draw_damping(right, one)
        left.legend(handles=level_handles(response), **ABOVE, ncols=4)
        figure.legend(handles=_handles(one), loc="outside lower left", ncols=2 if size == "column" else 4)
    return figure


def _draw_response(axes: Axes, response: xarray.Dataset, per_level: bool) -> None:
    level = response.level if per_level else 1.0
    unit = "m" + f"/{response.level.attrs['units']}" * per_level
    amplitude = response.amplitude / level
    divisor, prefixed = scaled(amplitude, unit)
    hertz = scaled(response.frequency, "Hz")
    frequency = response.frequency.values / hertz.divisor
    bare = (response.bare_amplitude / level)[:1] if per_level else response.bare_amplitude
    axes.plot(frequency, bare.T / divisor, color=FAINT, lw=pen(0.8), zorder=0)
    for k, values in enumerate((amplitude / divisor).values):
        colour = series_colour(k)
        one = response.isel(level=k)
        unstable = one.is_unstable.values
        for stable in (True, False):
            _draw_lines(axes, frequency, np.where(unstable != stable, values, np.nan), colour, stable)
        rough = np.where(one.first_harmonic_share.values < 0.95, values, np.nan)
        axes.plot(frequency, rough, "x", ms=pen(2.5), mew=pen(0.5), color=colour)
    axes.set_yscale("log")
    log_ticks(axes.yaxis)
    axes.set_xlim(frequency[0], frequency[-1])
    label(axes, "x", "Frequency", hertz.unit)
    label(axes, "y", "Amplitude" + " over level" * per_level, prefixed)


def _draw_lines(axes: Axes, frequency: Vector, values: Vector, colour: str, stable: bool) -> None:
    """Draw motions of each kind, (F, S), as lines that are not connected across a change of their number."""
    counts = np.isfinite(values).sum(axis=1)
    ends = np.flatnonzero(np.diff(counts)) + 1
    # Between two changes of the number of motions, the k-th largest amplitude belongs to one branch.
    for part in np.split(np.arange(frequency.size), ends):
        order = np.sort(np.where(np.isfinite(values[part]), values[part], np.inf), axis=1)
        order = np.where(np.isfinite(order), order, np.nan)
        axes.plot(frequency[part], order, color=colour, ls="-" if stable else ":", marker="," if part.size == 1 else "")


def _draw_damping(axes: Axes, response: xarray.Dataset) -> None:
    divisor, unit = scaled(response.map_amplitude, str(response.map_amplitude.attrs["units"]))
    for k, mode in enumerate(response.mode.values):
        ratio = response.damping_ratio.sel(mode=mode)
        if np.isfinite(ratio).any():
            hertz, prefixed = scaled(response.mode_frequency.sel(mode=mode), "Hz")
            name = f"mode {mode}, {float(response.mode_frequency.sel(mode=mode).mean()) / hertz:.3g} {prefixed}"
            style = SERIES_STYLES[k % len(SERIES_STYLES)]
            amplitude = response.map_amplitude / divisor
            axes.plot(amplitude, 100 * ratio, color=INK, ls=style, label=name)
            half = response.damping_ratio_interval.sel(mode=mode)
            axes.fill_between(amplitude, 100 * (ratio - half), 100 * (ratio + half), color=FAINT, lw=0, zorder=0)
    axes.set_xscale("log")
    log_ticks(axes.xaxis)
    axes.set_ylim(bottom=0)
    label(axes, "x", "Amplitude of the damper", unit)
    label(axes, "y", "Damping ratio", "%")
    if axes.lines:
        axes.legend(**ABOVE, ncols=2)


def _handles(response: xarray.Dataset) -> list[Line2D]:
    handles = [Line2D([], [], color=FAINT, lw=pen(0.8), label="no damper")]
    if np.isfinite(response.damping_ratio_interval).any():
        handles.append(Line2D([], [], color=FAINT, lw=pen(4), label="95 % interval"))
    if response.is_unstable.any():
        handles.append(Line2D([], [], color=INK, ls=":", label="unstable"))
    if (response.first_harmonic_share < 0.95).any():
        handles.append(
            Line2D([], [], color=INK, ls="", marker="x", ms=pen(2.5), mew=pen(0.5), label="other harmonics above 5 %")
        )
    return handles
