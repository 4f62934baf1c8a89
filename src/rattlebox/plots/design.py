"""Trials of a design: how the best one was found, or what a trade-off costs."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from .labels import LabelledValues
from .style import INK, SERIES_COLOURS, Size, StyledFigure, figure_style, label, legend_above

if TYPE_CHECKING:
    import xarray as xr

_PARAMETERS = 3  # that are drawn
_DOTS: dict[str, Any] = {"linestyle": "", "marker": "o", "color": SERIES_COLOURS[0], "alpha": 0.5, "markeredgewidth": 0}
_BEST: dict[str, Any] = {"linestyle": "", "marker": "D", "color": SERIES_COLOURS[1]}


def plot_design(found: xr.Dataset, *, size: Size = "page") -> Figure:
    """Draw the trials of a design.

    Of one objective: its value in each trial with the best one so far, and over each parameter. Of several: the second over
    the first with the front of those trials that none beats, and each parameter along the front.

    Parameters
    ----------
    found
        From `rb.design`.
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        With one panel, and one for each parameter, up to three.

    Raises
    ------
    ValueError
        When the size is unknown.
    """
    goals = [str(name) for name, values in found.data_vars.items() if "goal" in values.attrs]
    paths = [str(name) for name, values in found.coords.items() if values.dims == ("trial",) and name != "trial"]
    paths = paths[:_PARAMETERS]
    count = 1 + len(paths)
    with figure_style(size):
        narrow = size == "column"
        figure = StyledFigure(size, 0.62 * count if narrow else 0.42 if count < 4 else 0.34)
        panels = figure.subplots(*((count, 1) if narrow else (1, count)), squeeze=False).ravel()
        (_draw_progress if len(goals) == 1 else _draw_front)(panels[0], found, goals)
        for panel, path in zip(panels[1:], paths, strict=True):
            (_draw_over if len(goals) == 1 else _draw_along)(panel, found, path, goals[0])
        legend_above(panels[0])
    return figure


def _draw_progress(axes: Axes, found: xr.Dataset, goals: list[str]) -> None:
    """Draw the objective of each trial, and the best so far."""
    goal = LabelledValues.of(found[goals[0]])
    best = (np.fmax if found[goals[0]].attrs["goal"] == "max" else np.fmin).accumulate(goal.numbers)
    axes.plot(found.trial, goal.numbers, label="trial", **_DOTS)
    axes.step(found.trial, best, where="post", color=SERIES_COLOURS[1], label="best so far")
    limit = json.loads(found.attrs["max_added_mass"])
    heavy = found.added_mass.values > (np.inf if limit is None else limit)
    look: dict[str, Any] = {"color": INK, "linestyle": "", "transform": axes.get_xaxis_transform(), "clip_on": False}
    for told, marker, which in (("too heavy", "|", heavy), ("without a value", "x", ~found.feasible.values & ~heavy)):
        if np.any(which):
            trials = found.trial.values[which]
            axes.plot(trials, np.zeros(trials.size), marker=marker, label=f"{told} ({trials.size})", **look)
    axes.margins(x=0.02)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    label(axes, "x", "Trial", "")
    goal.along(axes, "y")


def _draw_front(axes: Axes, found: xr.Dataset, goals: list[str]) -> None:
    """Draw the second objective over the first, and the trials that none beats."""
    across, up = LabelledValues.of(found[goals[0]]), LabelledValues.of(found[goals[1]])
    axes.plot(across.numbers, up.numbers, label="trial", **_DOTS)
    best = found.front.values
    axes.plot(across.numbers[best], up.numbers[best], label="not beaten", **_BEST)
    axes.margins(0.04)
    across.along(axes, "x")
    up.along(axes, "y")


def _draw_over(axes: Axes, found: xr.Dataset, path: str, goal: str) -> None:
    """Draw the objective over a parameter."""
    across, up = LabelledValues.of(found[path]), LabelledValues.of(found[goal])
    best = found.front.values
    axes.plot(across.numbers, up.numbers, **_DOTS)
    axes.plot(across.numbers[best], up.numbers[best], **_BEST)
    axes.margins(0.04)
    across.along(axes, "x", log=_is_log(found, path))
    up.along(axes, "y")


def _draw_along(axes: Axes, found: xr.Dataset, path: str, goal: str) -> None:
    """Draw a parameter along the front."""
    across, up = LabelledValues.of(found[goal]), LabelledValues.of(found[path])
    best = found.front.values
    axes.plot(across.numbers[best], up.numbers[best], **_BEST)
    axes.margins(0.04)
    across.along(axes, "x")
    up.along(axes, "y", log=_is_log(found, path))


def _is_log(found: xr.Dataset, path: str) -> bool:
    return bool(json.loads(found.attrs["parameters"])[path]["log"])
