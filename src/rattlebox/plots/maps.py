"""Maps and lines of a study: a measure over one or two of its axes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from rattlebox._util.exceptions import CaseError

from ..model.errors import Hint, nearest
from ..model.units import parse
from ..results.schema import OUTCOMES
from .labels import LabelledValues, Vector, log_ticks, name_of, unit_of, value_of
from .style import (
    FAINT,
    INK,
    SERIES_COLOURS,
    SERIES_MARKERS,
    SERIES_STYLES,
    Size,
    StyledFigure,
    figure_style,
    legend_above,
    letters,
    pen,
    shorten,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_BAND = "replica"
_HATCHES = ("////", "....", "xxxx", "\\\\\\\\", "++++", "oooo", "****")
_MARKERS = ("x", "+", "1", "2", "3", "4", "*")
_GREY = "#c8c8c8"
_FEW = 30  # points of a line, each of which is marked
_UNBOUNDED = ("loss_factor",)  # where the effective mass passes through zero
_SHOWN = 95  # per cent of such values
_LEAP = 4.0  # times as much as these, at which lines are cut


def plot_map(
    study: xr.Dataset,
    of: str | None = None,
    *,
    kind: Literal["map", "lines"] | None = None,
    at: Mapping[str, Any] | None = None,
    size: Size = "column",
) -> Figure:
    """Draw a measure of a study over one or two of its axes.

    Axes whose values grow by a factor are logarithmic. Of replicas, and along an axis of seeds, a map shows the median, and
    lines the median within the band from 10 to 90 %; without replicas, a line lies within its 95 % interval, if the measure
    has one. Points of a line are marked where there are at most 30. Runs that did not finish are hatched in a map and
    crossed on the axis below lines, and named.

    Parameters
    ----------
    study
        From `rb.sweep` or a store; any dataset of measures over axes.
    of
        Name of the measure; default the first.
    kind
        "map" in colours over two axes, "lines" over one, one line for each value of the other; default a map where both
        axes have more than six values, and lines, from which values can be read, where one has fewer.
    at
        Values of further axes, {"load.amplitude": "5 kN"}; the nearest one in the study is taken.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        With one panel.

    Raises
    ------
    CaseError
        When there is no such measure or axis, or the study varies along more axes than can be drawn.
    ValueError
        When the size is unknown.

    Examples
    --------
    >>> import rattlebox as rb
    >>> gaps = {"damper.gap": rb.linspace("0.2 mm", "1 mm", 5)}
    >>> figure = rb.plot_map(rb.sweep(rb.reference_case(duration=1.0), gaps, ["impact_share"]))
    """
    if kind not in (None, "map", "lines"):
        raise CaseError(f"kind = {kind!r}: there is no such kind\n  {nearest(str(kind), ('map', 'lines'))}")
    name = _measure(study, of)
    chosen, told = select(study, at or {})
    chosen = _seeds_as_replicas(chosen, name)
    along = [coord.dims for coord in chosen.coords.values()]  # of linked parameters another one tells them apart
    repeated = [dim for dim in chosen[name].dims if dim in chosen.coords and along.count((dim,)) == 1]
    chosen = chosen.drop_duplicates(repeated).squeeze(drop=True)
    dims = [str(dim) for dim in chosen[name].dims if dim != _BAND]
    _check_axes(chosen, name, dims, kind)
    with figure_style(size):
        many = len(dims) == 2 and min(chosen.sizes[dim] for dim in dims) > len(SERIES_COLOURS)
        if kind == "map" or (kind is None and many):
            figure = _map_figure(chosen, name, dims, size)
        else:
            figure = _lines_figure(chosen, name, dims, size)
        if told:
            figure.suptitle(
                shorten(told[0].upper() + told[1:], letters(figure.axes[0])), x=0.01, ha="left", fontsize="medium"
            )
    return figure


def _seeds_as_replicas(study: xr.Dataset, name: str) -> xr.Dataset:
    """Members of an axis of seeds are replicas, where there is another axis to draw along."""
    dims = [str(dim) for dim in study[name].dims if study.sizes[dim] > 1]
    seeds = [dim for dim in dims if dim.rpartition(".")[2] == "seed"]
    return study.rename({seeds[0]: _BAND}) if len(seeds) == 1 < len(dims) and _BAND not in dims else study


def select(study: xr.Dataset, at: Mapping[str, Any]) -> tuple[xr.Dataset, str]:
    """Take the members of a study at values of its axes.

    Parameters
    ----------
    study
        Dataset over axes.
    at
        By the name of a coordinate: the value, a number in SI or text with a unit; the nearest one is taken.

    Returns
    -------
    tuple
        The study without these axes, and what was taken in words.

    Raises
    ------
    CaseError
        When there is no such axis, or the value lies outside its range.
    """
    words = []
    for name, value in at.items():
        known = [str(other) for other, coord in study.coords.items() if coord.ndim == 1]
        if name not in known:
            raise CaseError(f"at = {name!r}: the study has no such axis\n  {nearest(name, known)}")
        coord = study[name]
        number = _position(coord, name, value)
        words.append(f"{name_of(coord)} {value_of(coord, coord.values[number])}")
        study = study.isel({coord.dims[0]: number})
    return study, ", ".join(words)


def nearest_value_notes(study: xr.Dataset, at: Mapping[str, Any]) -> list[str]:
    """Tell where `select` takes another value than the one that is asked for.

    Parameters
    ----------
    study, at
        As for `select`, which takes them.

    Returns
    -------
    list of str
        A line for each axis where the two differ as they are written in figures.
    """
    lines = []
    for name, value in at.items():
        coord = study[name]
        taken = value_of(coord, coord.values[_position(coord, name, value)])
        if taken != value_of(coord, _asked(coord, name, value)):
            lines.append(f"{name} = {taken}, the nearest to {value} in the study")
    return lines


def _asked(coord: xr.DataArray, name: str, value: Any) -> Any:
    """The number that is asked for in the unit of a coordinate; of names the name."""
    if coord.dtype.kind not in "fiu":
        return value
    try:
        return parse(value, (unit_of(coord) or "1",))[0]
    except Hint as hint:
        raise CaseError(f"at: {name} = {value!r}\n  {hint}") from None


def _position(coord: xr.DataArray, name: str, value: Any) -> int:
    """Number of the value of a coordinate that is nearest."""
    values = coord.values
    if values.dtype.kind not in "fiu":
        if value not in values.tolist():
            raise CaseError(f"at: {name} = {value!r} is not in the study\n  {nearest(str(value), map(str, values))}")
        return int(values.tolist().index(value))
    number = _asked(coord, name, value)
    low, high = float(values.min()), float(values.max())
    if not low - 1e-6 * abs(low) <= number <= high + 1e-6 * abs(high):
        shown = f"{value_of(coord, low)} to {value_of(coord, high)}"
        raise CaseError(f"at: {name} = {value!r} lies outside the study\n  try: {shown}")
    return int(np.argmin(np.abs(values - number)))


def _measure(study: xr.Dataset, of: str | None) -> str:
    results = ((str(name), values) for name, values in study.data_vars.items() if name not in OUTCOMES)
    numbers = [name for name, values in results if values.dtype.kind in "fiu"]
    if of is None:
        if not numbers:
            raise CaseError("there is no measure in this study")
        return numbers[0]
    if of not in study.data_vars:
        raise CaseError(f"of = {of!r}: there is no such measure in the study\n  {nearest(of, numbers)}")
    return of


def _check_axes(study: xr.Dataset, name: str, dims: list[str], kind: str | None) -> None:
    """Refuse what cannot be drawn."""
    own = [dim for dim in dims if "status" in study and dim not in study["status"].dims]
    if own:
        raise CaseError(f"{name} is no one number of a run, but runs along {', '.join(own)}\n  try: a measure")
    if dims == ["sample"] and "sample" not in study.indexes:
        raise CaseError("a random design has no axes to draw along\n  try: a grid of values")
    if not dims:
        raise CaseError(f"nothing varies in what is left of the study: {name} = {float(study[name].values):.6g}")
    if len(dims) > 2 or (kind == "map" and len(dims) == 1):
        which = f"varies along {', '.join(dims)}"
        if len(dims) == 1:
            raise CaseError(f"a map needs two axes, but {name} {which}\n  try: kind lines")
        last = study[dims[-1]]
        one = value_of(last, last.values[0])
        raise CaseError(f"{name} {which}; two axes can be drawn\n  try: at {dims[-1]} = {one}")


# ---- maps


def _map_figure(study: xr.Dataset, name: str, dims: list[str], size: Size) -> Figure:
    figure = StyledFigure(size, 0.78 if size == "column" else 0.56)
    axes = figure.subplots()
    draw_map(figure, axes, study, name, dims[0], dims[1])
    explain_gaps(figure, study, name)
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
) -> None:
    """Draw a measure in colours over two axes, with hatches where runs did not finish.

    Parameters
    ----------
    figure, axes
        Where.
    study
        Dataset over the two axes, and perhaps replicas, of which the median is shown.
    name
        Measure.
    x, y
        Axes of the study.
    text
        Label of the colour bar; default from the attributes.
    """
    values = study[name]
    if _BAND in values.dims:
        values = values.median(_BAND)
    measure = LabelledValues.of(values.transpose(y, x))
    across, up = _Axis.of(study[x]), _Axis.of(study[y])
    top = _largest_shown(name, measure.numbers)
    norm = None if top is None else Normalize(0.0, top)
    mesh = axes.pcolormesh(
        across.edges, up.edges, measure.numbers, cmap=colours(), norm=norm, rasterized=True, shading="flat"
    )
    for gap in _gaps(study, name):
        where = gap.where.transpose(y, x, ...).values.reshape((*measure.numbers.shape, -1)).any(axis=-1)
        left, low = across.edges[:-1], up.edges[:-1]
        right, high = across.edges[1:], up.edges[1:]
        cells = [
            [(left[i], low[j]), (right[i], low[j]), (right[i], high[j]), (left[i], high[j])]
            for j, i in np.argwhere(where)
        ]
        axes.add_collection(
            PolyCollection(cells, facecolors=gap.face, edgecolors=_GREY, linewidths=0, hatch=gap.hatch, zorder=2)
        )
    across.finish(axes, "x")
    up.finish(axes, "y")
    bar = figure.colorbar(mesh, ax=axes, aspect=28, pad=0.02, extend="neither" if norm is None else "max")
    bar.outline.set_visible(False)
    said = measure.with_unit if text is None else text
    bar.set_label(f"{said}, median" if _BAND in study[name].dims else said)


def _largest_shown(name: str, values: Vector) -> float | None:
    """Where the scale of a measure ends that has no bound and here leaps beyond the rest; None for all others."""
    there = values[np.isfinite(values)]
    if name not in _UNBOUNDED or not there.size:
        return None
    usual = float(np.percentile(there, _SHOWN))
    return usual if there.max() > usual > 0 else None


def colours() -> Any:
    """Return the colours of maps: even in lightness, so that they survive greyscale and colour blindness."""
    from cmcrameri import cm  # type: ignore[import-untyped]

    return cm.batlow


def explain_gaps(figure: Figure, study: xr.Dataset, name: str) -> None:
    """Write below a map what its hatches mean, and how many runs each stands for.

    Parameters
    ----------
    figure
        Figure with the map.
    study, name
        What is drawn.
    """
    look: dict[str, Any] = {"edgecolor": FAINT, "linewidth": pen(0.5)}
    notes = [Patch(facecolor=gap.face, hatch=gap.hatch, label=gap.text, **look) for gap in _gaps(study, name)]
    if notes:
        figure.legend(
            handles=notes,
            loc="outside lower left",
            ncols=len(notes) if figure.get_figwidth() > 5 else 2,
            handlelength=1.4,
        )


class _Axis(NamedTuple):
    """An axis of a map, with the edges of its cells."""

    shown: LabelledValues
    edges: Vector
    log: bool

    @classmethod
    def of(cls, coord: xr.DataArray) -> _Axis:
        shown = LabelledValues.of(coord)
        log = shown.names is None and _grows_by_factor(shown.numbers)
        inner = np.log(shown.numbers) if log else shown.numbers
        if inner.size == 1:
            half = 0.5 * abs(inner[0]) or 0.5
            return cls(shown, np.array([inner[0] - half, inner[0] + half]), log)
        between = 0.5 * (inner[1:] + inner[:-1])
        edges = np.concatenate(([2 * inner[0] - between[0]], between, [2 * inner[-1] - between[-1]]))
        return cls(shown, np.asarray(np.exp(edges) if log else edges, dtype=float), log)

    def finish(self, axes: Axes, which: Literal["x", "y"]) -> None:
        self.shown.along(axes, which, log=self.log)


def _grows_by_factor(values: Vector) -> bool:
    if values.size < 4 or np.any(values <= 0):
        return False
    ratios = values[1:] / values[:-1]
    return bool(np.allclose(ratios, ratios[0], rtol=1e-6) and abs(ratios[0] - 1) > 1e-6)


# ---- lines


def _lines_figure(study: xr.Dataset, name: str, dims: list[str], size: Size) -> Figure:
    figure = StyledFigure(size, 0.72 if size == "column" else 0.5)
    axes = figure.subplots()
    marks = draw_lines(figure, axes, study, name, dims)
    legend_above(axes)
    if marks:
        figure.legend(handles=marks, loc="outside lower left", ncols=2, handlelength=1.0)
    return figure


def draw_lines(figure: Figure, axes: Axes, study: xr.Dataset, name: str, dims: list[str]) -> list[Line2D]:
    """Draw a measure over the longest axis, one line for each value of the other.

    Parameters
    ----------
    figure, axes
        Figure and axes to draw into.
    study
        Dataset over the axes, and perhaps replicas, whose median and band are drawn.
    name
        Measure.
    dims
        One or two axes of the study.

    Returns
    -------
    list of Line2D
        Marks of runs without a value, with their legend texts.
    """
    along, *others = sorted(dims, key=lambda dim: study.sizes[dim], reverse=True)
    across, values = _Axis.of(study[along]), study[name]
    measure = LabelledValues.of(values)
    looks: list[dict[str, Any]] = [{"color": SERIES_COLOURS[0], "marker": SERIES_MARKERS[0]}]
    for other in others:
        looks = _series(figure, axes, study[other])
        values = values.transpose(other, ...)
    halves = study.get(f"{name}_interval")
    for number, (member, look) in enumerate(zip(values if others else [values], looks, strict=True)):
        if across.shown.names:
            look |= {"linestyle": "", "marker": "o"}
        elif across.shown.numbers.size <= _FEW:
            look |= {"markersize": pen(2.4)}
        else:
            del look["marker"]
        half = None if halves is None else halves.transpose(*values.dims)[number if others else ...] / measure.divisor
        _draw_line(axes, across.shown.numbers, member / measure.divisor, half, look)
    marks = _cut_leaps(axes, name, values, along, across) + _mark_gaps(axes, study, name, along, across)
    across.finish(axes, "x")
    measure.along(axes, "y")
    return marks


def _cut_leaps(axes: Axes, name: str, values: xr.DataArray, along: str, across: _Axis) -> list[Line2D]:
    """End the scale of a measure that has no bound where its leaps would press all else flat, and mark where they are."""
    top = _largest_shown(name, values.values)
    if top is None or float(values.max()) < _LEAP * top:
        return []
    for line in axes.lines:
        line.set_clip_on(True)
    axes.set_ylim(0.0, 1.25 * top / LabelledValues.of(values).divisor)
    leaps = (values > 1.25 * top).transpose(along, ...).values.reshape(across.shown.numbers.size, -1)
    places = across.shown.numbers[leaps.any(axis=1)]
    look: dict[str, Any] = {"marker": "^", "color": INK, "linestyle": ""}
    axes.plot(places, np.full(places.size, 1.0), transform=axes.get_xaxis_transform(), clip_on=False, **look)
    return [Line2D([], [], label="beyond the scale", **look)]


def _draw_line(
    axes: Axes, places: Vector, member: xr.DataArray, half: xr.DataArray | None, look: dict[str, Any]
) -> None:
    """Draw a line, with its interval of given half width; or the median of replicas within their band."""
    middle = member
    if _BAND in member.dims:
        some = member.notnull().any(_BAND)
        low, middle, high = member.where(some, 0.0).quantile([0.1, 0.5, 0.9], _BAND).where(some)
        axes.fill_between(places, low.values, high.values, color=look["color"], alpha=0.25, linewidth=0)
    elif half is not None:
        low, high = member - half, member + half
        axes.fill_between(places, low.values, high.values, color=look["color"], alpha=0.25, linewidth=0)
    axes.plot(places, middle.values, clip_on="marker" not in look, **look)
    if "marker" in look:
        return
    there = np.pad(np.isfinite(middle.values), 1)
    alone = there[1:-1] & ~there[:-2] & ~there[2:]  # between gaps, where a line has no length
    if alone.any():
        dots: dict[str, Any] = {"linestyle": "", "marker": "o", "markersize": 2.5, "clip_on": False}
        axes.plot(places[alone], middle.values[alone], color=look["color"], **dots)


def _series(figure: Figure, axes: Axes, coord: xr.DataArray) -> list[dict[str, Any]]:
    """Colours and names of lines; a colour bar where they are too many to be named."""
    from matplotlib.cm import ScalarMappable

    if coord.size <= len(SERIES_COLOURS):
        names = [f"{name_of(coord)} {value_of(coord, value)}" for value in coord.values]
        looks = zip(SERIES_COLOURS, SERIES_STYLES, SERIES_MARKERS, names, strict=False)
        return [dict(zip(("color", "linestyle", "marker", "label"), look, strict=True)) for look in looks]
    axis = _Axis.of(coord)
    dark = LinearSegmentedColormap.from_list("dark", colours()(np.linspace(0, 0.85, 256)))
    places = axis.shown.numbers
    norm = (LogNorm if axis.log else Normalize)(float(places.min()), float(places.max()))
    bar = figure.colorbar(ScalarMappable(norm, dark), ax=axes, aspect=28, pad=0.02)
    if axis.log:
        log_ticks(bar.ax.yaxis)
    bar.outline.set_visible(False)
    bar.set_label(axis.shown.with_unit)
    return [{"color": dark(norm(value)), "marker": SERIES_MARKERS[0]} for value in places]


def _mark_gaps(axes: Axes, study: xr.Dataset, name: str, along: str, across: _Axis) -> list[Line2D]:
    """Mark on the axis where there is no value."""
    marks = []
    for number, gap in enumerate(_gaps(study, name)):
        here = gap.where.transpose(along, ...).values.reshape(across.shown.numbers.size, -1).any(axis=1)
        look: dict[str, Any] = {"marker": gap.marker, "color": INK, "linestyle": ""}
        height = np.full(here.sum(), 0.02 + 0.03 * number)
        axes.plot(across.shown.numbers[here], height, transform=axes.get_xaxis_transform(), clip_on=False, **look)
        marks.append(Line2D([], [], label=gap.text, **look))
    return marks


# ---- members without a value


class _Gap(NamedTuple):
    """Members that have no value for one reason."""

    text: str
    where: xr.DataArray
    face: str
    hatch: str
    marker: str


def _gaps(study: xr.Dataset, name: str) -> list[_Gap]:
    """Why members have no value, if some have none."""
    values = study[name]
    finished, found = np.isfinite(values), []
    if "status" in study:
        states = study["status"]
        finished = finished | (states != 0)
        names = str(states.attrs.get("flag_meanings", "")).split()
        for status in np.unique(states.values[states.values != 0]).tolist():
            known = names[status].replace("_", " ") if 0 <= status < len(names) else "not computed yet"
            number = status % len(_HATCHES)
            found.append((known, states == status, "none", "" if status < 0 else _HATCHES[number], _MARKERS[number]))
    found.append(("no value", ~finished, _GREY, "", "|"))
    return [_Gap(f"{text} ({int(where.sum())})", where, *look) for text, where, *look in found if where.any()]
