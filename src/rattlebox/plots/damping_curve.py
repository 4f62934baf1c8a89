"""Figure of damping curves: damping ratio over the amplitude of vibration."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from ..model.units import STANDARD_GRAVITY
from .style import (
    FAINT,
    SERIES_MARKERS,
    SERIES_STYLES,
    StyledFigure,
    axis_in_g,
    figure_style,
    label,
    pen,
    scaled,
    series_colour,
)
from .types import Size, Style

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes


def plot_damping_curve(curves: xarray.Dataset | Mapping[str, xarray.Dataset], *, size: Size = "column") -> Figure:
    """Draw the damping ratio over the amplitude, with its 95 % interval, and the damping ratio of the structure alone.

    Parameters
    ----------
    curves
        Dataset from `rattlebox.damping_curve`, or several datasets by name.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with one panel. The axis above it has the amplitudes as accelerations at the frequency of the mode, if all
        curves have the same.

    Raises
    ------
    ValueError
        If the size is unknown.
    """
    import xarray  # importing it takes longer than drawing a figure of a run

    named = {"": curves} if isinstance(curves, xarray.Dataset) else dict(curves)
    with figure_style(size):
        figure = StyledFigure(size, 0.62)
        axes = figure.subplots()
        amplitudes = xarray.concat([curve.amplitude.reset_coords(drop=True) for curve in named.values()], "amplitude")
        divisor, unit = scaled(amplitudes.assign_attrs(units="m"), "m")
        for number, (name, curve) in enumerate(named.items()):
            x, limits = curve.amplitude / divisor, (100 * curve.lower, 100 * curve.upper)
            doubtful = ~curve.steady.all("packing") if "steady" in curve else None
            draw_with_interval(axes, x, 100 * curve.damping_ratio, limits, name, number, doubtful, "not steady")
        first = next(iter(named.values()))
        for curve in named.values():
            text = "structure alone" if curve is first else None
            axes.plot(curve.amplitude / divisor, 100 * curve.bare, color=FAINT, lw=pen(0.8), zorder=0, label=text)
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_ylim(bottom=0)
        label(axes, "x", "Amplitude", unit)
        label(axes, "y", "Damping ratio", "%")
        frequencies = {curve.attrs.get("frequency", math.nan) for curve in named.values()}
        if len(frequencies) == 1 and (frequency := frequencies.pop()) > 0:  # False for NaN
            axis_in_g(axes, "x", STANDARD_GRAVITY / (2 * math.pi * frequency) ** 2 / divisor, "Acceleration")
        figure.legend(*axes.get_legend_handles_labels(), loc="outside upper left", ncols=3)
    return figure


def draw_with_interval(
    axes: Axes,
    x: xarray.DataArray,
    values: xarray.DataArray,
    limits: tuple[xarray.DataArray, xarray.DataArray],
    name: str,
    number: int,
    doubtful: xarray.DataArray | None = None,
    doubt: str = "",
) -> None:
    """Draw a curve with its 95 % interval in the style of a series, counted from 0; doubtful points have hollow marks."""
    colour = series_colour(number)
    axes.fill_between(x, *limits, color=colour, alpha=0.25, lw=0)
    marks: Style = {"marker": SERIES_MARKERS[number % len(SERIES_MARKERS)], "ms": pen(3), "clip_on": False, "zorder": 3}
    axes.plot(
        x, values, color=colour, ls=SERIES_STYLES[number % len(SERIES_STYLES)], label=name or "with damper", **marks
    )
    if doubtful is not None and (hollow := doubtful & values.notnull()).any():
        # One entry of the legend for all curves.
        text = doubt if doubt not in axes.get_legend_handles_labels()[1] else None
        axes.plot(x[hollow], values[hollow], color=colour, ls="", mfc="white", label=text, **marks)
