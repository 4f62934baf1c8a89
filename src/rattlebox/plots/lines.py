"""Lines of a measure of a study over one axis, one line for each value of a second axis."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import LinearSegmentedColormap, LogNorm, Normalize
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from .gaps import NOT_STEADY, gaps_of, unsteady_runs
from .labels import REPLICA, LabelledValues, StudyAxis, interval_ends, log_ticks, name_of, upper_limit, value_of
from .style import INK, SERIES_COLOURS, SERIES_MARKERS, SERIES_STYLES, colour_bar, map_colours, pen
from .types import Style, Vector

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MAX_MARKED_POINTS = 30  # of a line
_CLIP_RATIO = 4.0  # largest value over the end of the scale at which lines are clipped


def draw_lines(figure: Figure, axes: Axes, study: xr.Dataset, name: str, dims: list[str]) -> list[Line2D]:
    """Draw a measure over the longest axis, one line for each value of the other."""
    along, *others = sorted(dims, key=lambda dim: study.sizes[dim], reverse=True)
    x_axis, values = StudyAxis.of(study[along]), study[name]
    measure = LabelledValues.of(values)
    styles: list[Style] = [{"color": SERIES_COLOURS[0], "marker": SERIES_MARKERS[0]}]
    for other in others:
        styles = _series_styles(figure, axes, study[other])
        values = values.transpose(other, ...)
    marks: list[Line2D] = []
    doubtful = unsteady_runs(study)
    half_widths = study.get(f"{name}_interval")
    for number, (member, style) in enumerate(zip(values if others else [values], styles, strict=True)):
        # Names have no order, so no line connects them; few points are marked, many are not.
        if x_axis.values.names:
            style |= {"linestyle": "", "marker": "o"}
        elif x_axis.values.numbers.size <= _MAX_MARKED_POINTS:
            style |= {"markersize": pen(2.4)}
        else:
            del style["marker"]
        member, ends = member / measure.divisor, None
        if half_widths is not None:
            half = half_widths.transpose(*values.dims)[number if others else ...] / measure.divisor
            ends = interval_ends(name, member, half)
        count = len(axes.lines)
        _draw_line(axes, x_axis.values.numbers, member, ends, style)
        if doubtful is not None and set(dims) <= set(doubtful.dims):
            replicas = set(doubtful.dims) - set(dims)
            hollow = doubtful.any(replicas).transpose(*others, along)
            marks = _draw_hollow(axes, axes.lines[count], hollow.values[number if others else ...], style) or marks
    marks += _clip_peaks(axes, name, values, along, x_axis) + _mark_gaps(axes, study, name, along, x_axis)
    x_axis.label(axes, "x")
    measure.label(axes, "y")
    measure.axis_in_g(axes, "y")
    return marks


def _clip_peaks(axes: Axes, name: str, values: xr.DataArray, along: str, x_axis: StudyAxis) -> list[Line2D]:
    """Limit the scale of an unbounded measure whose peaks would flatten all other values, and mark the peaks."""
    top = upper_limit(name, values.values)
    if top is None or float(values.max()) < _CLIP_RATIO * top:
        return []
    for line in axes.lines:
        line.set_clip_on(True)
    axes.set_ylim(0.0, 1.25 * top / LabelledValues.of(values).divisor)
    # A marker at the upper edge states where a peak is cut off.
    peaks = (values > 1.25 * top).transpose(along, ...).values.reshape(x_axis.values.numbers.size, -1)
    x = x_axis.values.numbers[peaks.any(axis=1)]
    style: Style = {"marker": "^", "color": INK, "linestyle": ""}
    axes.plot(x, np.full(x.size, 1.0), transform=axes.get_xaxis_transform(), clip_on=False, **style)
    return [Line2D([], [], label="beyond the scale", **style)]


def _draw_line(
    axes: Axes, x: Vector, member: xr.DataArray, ends: tuple[xr.DataArray, xr.DataArray] | None, style: Style
) -> None:
    """Draw a line with its interval, or the median of replicas within their band."""
    middle = member
    if REPLICA in member.dims:
        computed = member.notnull().any(REPLICA)
        low, middle, high = member.where(computed, 0.0).quantile([0.1, 0.5, 0.9], REPLICA).where(computed)
        axes.fill_between(x, low.values, high.values, color=style["color"], alpha=0.25, linewidth=0)
    elif ends is not None:
        low, high = ends
        axes.fill_between(x, low.values, high.values, color=style["color"], alpha=0.25, linewidth=0)
    axes.plot(x, middle.values, clip_on="marker" not in style, **style)
    if "marker" in style:
        return
    # A point between two gaps has no line, so it needs a dot.
    finite = np.pad(np.isfinite(middle.values), 1)
    isolated = finite[1:-1] & ~finite[:-2] & ~finite[2:]
    if isolated.any():
        dots: Style = {"linestyle": "", "marker": "o", "markersize": 2.5, "clip_on": False}
        axes.plot(x[isolated], middle.values[isolated], color=style["color"], **dots)


def _draw_hollow(axes: Axes, line: Line2D, hollow: NDArray[np.bool_], style: Style) -> list[Line2D]:
    """Draw hollow marks at the points of a line that are not steady; return the mark for the legend."""
    x, middle = (np.asarray(each, float) for each in line.get_data())
    marks: Style = {"linestyle": "", "marker": "o", "markersize": pen(2.4), "markerfacecolor": "white", "zorder": 3}
    marks |= {name: style[name] for name in ("marker", "markersize") if name in style}
    hollow = hollow & np.isfinite(middle)
    if not hollow.any():
        return []
    axes.plot(x[hollow], middle[hollow], color=style["color"], clip_on=False, **marks)
    return [Line2D([], [], label=NOT_STEADY, color=INK, **marks)]


def _series_styles(figure: Figure, axes: Axes, coord: xr.DataArray) -> list[Style]:
    """Return styles and legend texts of lines; add a colour bar if there are too many lines for a legend."""
    from matplotlib.cm import ScalarMappable

    if coord.size <= len(SERIES_COLOURS):
        names = [f"{name_of(coord)} {value_of(coord, value)}" for value in coord.values]
        series = zip(SERIES_COLOURS, SERIES_STYLES, SERIES_MARKERS, names, strict=False)
        return [dict(zip(("color", "linestyle", "marker", "label"), style, strict=True)) for style in series]
    axis = StudyAxis.of(coord)
    dark = LinearSegmentedColormap.from_list("dark", map_colours()(np.linspace(0, 0.85, 256)))
    numbers = axis.values.numbers
    norm = (LogNorm if axis.log else Normalize)(float(numbers.min()), float(numbers.max()))
    bar = colour_bar(figure, ScalarMappable(norm, dark), axes, axis.values.with_unit, aspect=28)
    if axis.log:
        log_ticks(bar.ax.yaxis)
    return [{"color": dark(norm(number)), "marker": SERIES_MARKERS[0]} for number in numbers]


def _mark_gaps(axes: Axes, study: xr.Dataset, name: str, along: str, x_axis: StudyAxis) -> list[Line2D]:
    """Mark values of the horizontal axis at which runs have no value."""
    marks = []
    for number, gap in enumerate(gaps_of(study, name)):
        mask = gap.mask.transpose(along, ...).values.reshape(x_axis.values.numbers.size, -1).any(axis=1)
        style: Style = {"marker": gap.marker, "color": INK, "linestyle": ""}
        height = np.full(mask.sum(), 0.02 + 0.03 * number)
        axes.plot(x_axis.values.numbers[mask], height, transform=axes.get_xaxis_transform(), clip_on=False, **style)
        marks.append(Line2D([], [], label=gap.text, **style))
    return marks
