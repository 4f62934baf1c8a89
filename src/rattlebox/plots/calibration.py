"""Figure of a calibration: the data with the fit, and the parameters that agree with them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from .labels import capitalised
from .style import ABOVE, FAINT, INK, SERIES_COLOURS, SERIES_MARKERS, StyledFigure, figure_style, label, pen, scaled
from .types import Size, Style

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_MOST_NAMES = 8
"""Largest number of data whose places are written at the axis."""


def plot_calibration(result: xr.Dataset, *, size: Size = "page") -> Figure:
    """Draw the data of a calibration with the fit, and its parameters with their 95 % intervals.

    From drops and bounces: the restitution of each impact over its approach speed, their mean, and its interval. From
    losses: simulated values at the result over measured ones with bars of two standard deviations; and the parameters that
    agree with the data: chi^2 over one parameter, or the region of two in which it is above its minimum by less than the
    threshold of the intervals (line), 1 and three times the threshold (shades).

    Parameters
    ----------
    result
        Dataset from `rb.calibrate`.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with one panel for single impacts; for losses with two, or one for the data and one for each parameter if
        there are three.

    Raises
    ------
    ValueError
        If the size is unknown.
    """
    with figure_style(size):
        narrow = size == "column"
        if "approach_speed" in result:
            figure = StyledFigure(size, 0.62 if narrow else 0.4)
            _draw_impacts(figure.subplots(), result)
            return figure
        count = 1 + (3 if result.sizes["parameter"] > 2 else 1)
        rows, columns = (count, 1) if narrow else (count // 2, 2)
        figure = StyledFigure(size, (0.75 if narrow else 0.42) * rows)
        panels = figure.subplots(rows, columns).ravel()
        _draw_data(panels[0], result)
        if result.sizes["parameter"] == 2:
            _draw_region(panels[1], result)
        else:
            for axis, panel in enumerate(panels[1:]):
                _draw_profile(panel, result.isel(parameter=axis), float(result.threshold))
    return figure


def _draw_impacts(axes: Axes, result: xr.Dataset) -> None:
    """Draw the restitution of each impact over its approach speed."""
    speed, unit = scaled(result.approach_speed, "m/s")
    value, lower, upper = (float(result[name][0]) for name in ("value", "lower", "upper"))
    axes.axhspan(lower, upper, color=SERIES_COLOURS[0], alpha=0.25, lw=0, label="95 % interval of the mean")
    axes.axhline(value, color=SERIES_COLOURS[0], label=f"mean, {value:.3f}")
    for number in np.unique(result.data_set.values):
        mine = result.data_set.values == number
        style = {"color": INK, "ms": pen(3), "marker": SERIES_MARKERS[number % len(SERIES_MARKERS)], "ls": ""}
        name = "impacts" if result.data_set.values.max() == 0 else f"measurement {number + 1}"
        axes.plot(result.approach_speed.values[mine] / speed, result.restitution.values[mine], label=name, **style)
    axes.margins(0.08)
    label(axes, "x", "Approach speed", unit)
    label(axes, "y", "Restitution", "")
    axes.legend(**ABOVE, ncols=3)


def _places(result: xr.Dataset) -> list[str]:
    """Return a short name of each datum."""
    names = []
    columns = (result[name].values for name in ("amplitude", "amplitude_unit", "frequency"))
    for amplitude, unit, frequency in zip(*columns, strict=True):
        divisor, prefixed = scaled(amplitude, str(unit))
        text = f"{amplitude / divisor:.3g} {prefixed}".replace("^2", "²")
        names.append(text if np.isnan(frequency) else f"{text}, {frequency:.3g} Hz")
    return names


def _draw_data(axes: Axes, result: xr.Dataset) -> None:
    """Draw measured values over the mean of simulated ones, with standard uncertainties on both sides."""
    measured, check = result.measured.values, result.check.values
    x = np.arange(measured.size)
    bars: Style = {"ls": "", "elinewidth": pen(0.8), "ms": pen(3)}
    series = (
        ("measured", -0.1, np.ones(x.size), result.error, INK, "o"),
        ("simulated at the result", 0.1, check / measured, result.check_deviation, SERIES_COLOURS[1], "D"),
    )
    for name, beside, values, deviation, colour, marker in series:
        half = 1.96 * deviation.values / measured
        axes.errorbar(x + beside, values, half, color=colour, marker=marker, label=name, **bars)
    axes.axhline(1.0, color=FAINT, lw=pen(0.8), zorder=0)
    if x.size <= _MOST_NAMES:
        axes.set_xticks(x, _places(result), rotation=30, ha="right", rotation_mode="anchor")
    else:
        label(axes, "x", "Number of the datum", "")
    axes.margins(x=0.08)
    label(axes, "y", "Value over measured value", "")
    axes.legend(**ABOVE, ncols=2)


def _axis(one: xr.Dataset, values: xr.DataArray) -> tuple[float, str, str]:
    """Return divisor, unit and text of a parameter."""
    unit, path = str(one.unit.item()), str(one.parameter.item())
    divisor, prefixed = (1.0, "") if unit == "1" else scaled(values, unit)
    return divisor, prefixed, capitalised(path.removeprefix("damper.").replace(".", " ").replace("_", " "))


def _draw_region(axes: Axes, result: xr.Dataset) -> None:
    """Draw the region of two parameters that agree with the data."""
    scales = [_axis(result.isel(parameter=k), result[name]) for k, name in enumerate(("first_value", "second_value"))]
    divisors = [scale[0] for scale in scales]
    x, y = result.first_value.values / divisors[0], result.second_value.values / divisors[1]
    region, threshold = result.region.values.T, float(result.threshold)
    for level, alpha in ((3 * threshold, 0.15), (threshold, 0.3), (1.0, 0.5)):
        axes.contourf(x, y, region, levels=[0.0, level], colors=[SERIES_COLOURS[0]], alpha=alpha)
    axes.contour(x, y, region, levels=[threshold], colors=[INK], linewidths=pen(0.8))
    value, lower, upper = (result[name].values / divisors for name in ("value", "lower", "upper"))
    # One column for each bar: below and above the value. A value may lie at an end of its range.
    bars = np.maximum(0.0, np.stack([value - lower, upper - value]))
    style: Style = {"color": SERIES_COLOURS[1], "marker": "D", "ms": pen(3.5), "elinewidth": pen(1), "ls": ""}
    axes.errorbar(value[0], value[1], xerr=bars[:, :1], yerr=bars[:, 1:], label="value and 95 % intervals", **style)
    label(axes, "x", scales[0][2], scales[0][1])
    label(axes, "y", scales[1][2], scales[1][1])
    axes.legend(**ABOVE)


def _draw_profile(axes: Axes, one: xr.Dataset, threshold: float) -> None:
    """Draw chi^2 over one parameter."""
    divisor, unit, text = _axis(one, one.profile_value)
    axes.plot(one.profile_value / divisor, one.profile, color=INK)
    axes.axhline(threshold, color=FAINT, lw=pen(0.8))
    lower, upper = float(one.lower) / divisor, float(one.upper) / divisor
    axes.axvspan(lower, upper, color=SERIES_COLOURS[0], alpha=0.25, lw=0, label="95 % interval")
    axes.axvline(float(one.value) / divisor, color=SERIES_COLOURS[1], label="value")
    axes.set_ylim(0, min(4 * threshold, max(float(one.profile.max()), 1.5 * threshold)))
    label(axes, "x", text, unit)
    label(axes, "y", "Chi² above its minimum", "")
    axes.legend(**ABOVE, ncols=2)
