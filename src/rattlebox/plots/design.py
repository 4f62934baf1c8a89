"""Figures of the trials of a design: progress of the search, or trade-off between two objectives."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from rattlebox.studies.work.measures import INTERVAL

from .labels import LabelledValues, capitalised, interval_ends, is_geometric, plain
from .style import INK, SERIES_COLOURS, StyledFigure, figure_style, label, pen
from .types import Size, Style, Vector

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axis import Axis

_MAX_PARAMETERS = 3
_MAX_TICKS = 5  # of the values of a list; more would touch each other
_LEGEND_COLUMNS = 5
_DOTS: Style = {"linestyle": "", "marker": "o", "color": SERIES_COLOURS[0], "alpha": 0.5, "markeredgewidth": 0}
_RINGS: Style = {
    "linestyle": "",
    "marker": "o",
    "markerfacecolor": "none",
    "color": INK,
    "markersize": 5,
    "markeredgewidth": 0.6,
}
_BEST: Style = {"linestyle": "", "marker": "D", "color": SERIES_COLOURS[1]}


def plot_design(study: xr.Dataset, *, size: Size = "page") -> Figure:
    """Draw the trials of a design.

    For one objective: its value in each trial, the best value so far, and its value over each parameter. For several: the
    second objective over the first with the Pareto front, and each parameter along the front. Bars are 95 % intervals, and
    rings are trials that exceed validity limits.

    Parameters
    ----------
    study
        Dataset from `rb.design`.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with one panel for the objectives, and one for each of up to three parameters.

    Raises
    ------
    ValueError
        If the size is unknown.
    """
    goals, paths = goals_of(study), _separate(study, parameters_of(study))[:_MAX_PARAMETERS]
    count = 1 + len(paths)
    with figure_style(size):
        narrow = size == "column"
        figure = StyledFigure(size, 0.62 * count if narrow else 0.42 if count < 4 else 0.34)
        panels = figure.subplots(*((count, 1) if narrow else (1, count)), squeeze=False).ravel()
        (_draw_progress if len(goals) == 1 else _draw_front)(panels[0], study, goals)
        for panel, path in zip(panels[1:], paths, strict=True):
            (_draw_objective if len(goals) == 1 else _draw_parameter)(panel, study, path, goals[0])
        # Of the figure, since a panel is too narrow for the names.
        figure.legend(
            *panels[0].get_legend_handles_labels(), loc="outside upper left", ncols=2 if narrow else _LEGEND_COLUMNS
        )
    return figure


def goals_of(study: xr.Dataset) -> list[str]:
    """Return the objectives of a design."""
    return [str(name) for name, values in study.data_vars.items() if "goal" in values.attrs]


def parameters_of(study: xr.Dataset) -> list[str]:
    """Return the paths of the parameters of a design."""
    return [str(name) for name, values in study.coords.items() if values.dims == ("trial",) and name != "trial"]


def _separate(study: xr.Dataset, paths: list[str]) -> list[str]:
    """Return the parameters without those that vary together with one before them."""
    about = json.loads(study.attrs["parameters"])
    return list({about[path].get("together", path): path for path in reversed(paths)}.values())[::-1]


def _lengths(study: xr.Dataset, name: str, values: LabelledValues) -> Vector | None:
    """Return the lengths of the intervals below and above an objective in the unit of the figure; None if it has none."""
    half = study.get(name + INTERVAL)
    if half is None:
        return None
    low, high = interval_ends(name, study[name], half)
    return np.nan_to_num(np.stack([study[name] - low, high - study[name]]) / values.divisor)


def _draw_trials(
    axes: Axes, study: xr.Dataset, x: Vector, y: Vector, x_bar: Vector | None = None, y_bar: Vector | None = None
) -> None:
    """Draw trials with their intervals, and rings around those that exceed validity limits."""
    axes.errorbar(x, y, y_bar, x_bar, fmt="none", ecolor=SERIES_COLOURS[0], elinewidth=pen(0.8), alpha=0.7)
    axes.plot(x, y, label="trial", **_DOTS)
    flagged = (study.warnings.values != 0) & np.isfinite(y)
    if flagged.any():
        label = f"limits exceeded ({np.count_nonzero(flagged)})"
        axes.plot(x[flagged], y[flagged], label=label, **_RINGS)


def _draw_progress(axes: Axes, study: xr.Dataset, goals: list[str]) -> None:
    """Draw the objective of each trial, and the best value so far."""
    goal = LabelledValues.of(study[goals[0]])
    best = (np.fmax if study[goals[0]].attrs["goal"] == "max" else np.fmin).accumulate(goal.numbers)
    _draw_trials(axes, study, study.trial.values, goal.numbers, y_bar=_lengths(study, goals[0], goal))
    axes.step(study.trial, best, where="post", color=SERIES_COLOURS[1], label="best so far")
    limit = json.loads(study.attrs["max_added_mass"])
    # Trials without a value are marked on the axis, by reason, so that gaps of the search are visible.
    heavy = study.added_mass.values > (np.inf if limit is None else limit)
    style: Style = {"color": INK, "linestyle": "", "transform": axes.get_xaxis_transform(), "clip_on": False}
    for reason, marker, mask in (("too heavy", "|", heavy), ("no value", "x", ~study.feasible.values & ~heavy)):
        if np.any(mask):
            trials = study.trial.values[mask]
            axes.plot(trials, np.zeros(trials.size), marker=marker, label=f"{reason} ({trials.size})", **style)
    axes.margins(x=0.02)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    label(axes, "x", "Trial", "")
    goal.label(axes, "y")


def _draw_front(axes: Axes, study: xr.Dataset, goals: list[str]) -> None:
    """Draw the second objective over the first, and the Pareto front."""
    x, y = LabelledValues.of(study[goals[0]]), LabelledValues.of(study[goals[1]])
    bars = (_lengths(study, name, values) for name, values in zip(goals[:2], (x, y), strict=True))
    _draw_trials(axes, study, x.numbers, y.numbers, *bars)
    best = study.front.values
    axes.plot(x.numbers[best], y.numbers[best], label="Pareto front", **_BEST)
    axes.margins(0.04)
    x.label(axes, "x")
    y.label(axes, "y")


def _draw_objective(axes: Axes, study: xr.Dataset, path: str, goal: str) -> None:
    """Draw the objective over a parameter."""
    x, y = _parameter(study, path), LabelledValues.of(study[goal])
    best = study.front.values
    _draw_trials(axes, study, x.numbers, y.numbers, y_bar=_lengths(study, goal, y))
    axes.plot(x.numbers[best], y.numbers[best], **_BEST)
    axes.margins(0.04)
    x.label(axes, "x", log=_is_log(study, path))
    y.label(axes, "y")
    _tick_choices(axes.xaxis, study, path)


def _draw_parameter(axes: Axes, study: xr.Dataset, path: str, goal: str) -> None:
    """Draw a parameter along the Pareto front."""
    x, y = LabelledValues.of(study[goal]), _parameter(study, path)
    best = study.front.values
    axes.plot(x.numbers[best], y.numbers[best], **_BEST)
    axes.margins(0.04)
    x.label(axes, "x")
    y.label(axes, "y", log=_is_log(study, path))
    _tick_choices(axes.yaxis, study, path)


def _parameter(study: xr.Dataset, path: str) -> LabelledValues:
    """Return a parameter with a text that is short enough for its axis."""
    values = LabelledValues.of(study[path])
    return values._replace(text=capitalised(values.text.removeprefix("Damper ")))


def _tick_choices(axis: Axis, study: xr.Dataset, path: str) -> None:
    """Place ticks at the values of a short list of numbers, and those of a whole number at whole numbers only."""
    values = study[path]
    if values.dtype.kind == "i":
        axis.set_major_locator(MaxNLocator(integer=True))
    choices = _choices(study, path)
    if 0 < choices.size <= _MAX_TICKS and not _is_log(study, path):
        divisor = LabelledValues.of(values).divisor
        axis.set_ticks(choices / divisor, [plain(choice) for choice in choices / divisor])


def _choices(study: xr.Dataset, path: str) -> Vector:
    """Return the numbers of which a parameter has one, in ascending order; none for bounds and lists of names."""
    is_number = study[path].dtype.kind in "fiu"
    chosen = json.loads(study.attrs["parameters"])[path]["choices"] if is_number else None
    return np.unique(np.asarray(chosen or [], dtype=float))


def _is_log(study: xr.Dataset, path: str) -> bool:
    return bool(json.loads(study.attrs["parameters"])[path]["log"]) or is_geometric(_choices(study, path))
