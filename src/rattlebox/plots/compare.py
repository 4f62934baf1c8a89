"""Comparison of runs: motion and energy ledger, one column per run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure

from rattlebox._util.exceptions import CaseError

from ..results import Run
from ..results.summary import Comparison, checked_point, common_points
from .energy import draw_ledger
from .motion import ball_displacements, draw_cavity
from .panels import draw_largest
from .responses import response
from .style import StyledFigure, figure_style, label, letters, scaled, shorten, time_axis
from .types import Size


def plot_comparison(
    runs: Mapping[str, Run] | Comparison, *, point: str | None = None, of: str | None = None, size: Size = "page"
) -> Figure:
    """Draw the motion and the energy ledger of several runs in columns with common axes.

    Parameters
    ----------
    runs
        Runs by the title of their column, or the result of `rb.compare`; two to four runs fit well.
    point
        Point of the structure; by default that of the comparison, or the one with the largest displacement in the first run.
    of
        Variable of the motion or drift of `rattlebox.plots.plot_responses` in the first row; default that of the comparison,
        or "displacement".
    size
        Width of the figure: "column", "page" or "slide".

    Returns
    -------
    Figure
        Figure with one column per run: displacement of the point, balls of the first damper, ledger. Rows that
        are empty for all runs are omitted.

    Raises
    ------
    ValueError
        If there is no run, not all of them have the point or the variable, or the size is unknown.
    """
    if isinstance(runs, Comparison):
        point, of = point or runs.point or None, of or runs.drawn()
        runs = cast("Mapping[str, Run]", runs.runs)
    if not runs:
        raise CaseError("runs is empty; a comparison needs at least one run", '{"name": run}')
    every = list(runs.values())
    point = checked_point(point, common_points(runs))
    moving = bool(of) or any(run.arrays.mode_frequency.size for run in every)
    lines = [response(run, of or "displacement", point or None) for run in every] if moving else []
    with_balls = [run for run in every if _has_balls(run)]
    rows = int(bool(lines)) + int(bool(with_balls)) + 1
    with figure_style(size):
        figure = StyledFigure(size, 0.1 + 0.17 * rows)
        panels = figure.subplots(rows, len(every), sharex="col", sharey="row", squeeze=False)
        # Common units for all columns, since rows share their vertical axis.
        distances = [np.abs(ball_displacements(run.arrays, 0)).max() for run in with_balls]
        travel = scaled(distances, "m")
        energy = scaled([run.ledger.supplied.max() for run in every], "J")
        for column, (name, run) in enumerate(runs.items()):
            arrays, free_panels = run.arrays, iter(panels[:, column])
            shown, time = slice(0, arrays.time.size), scaled(arrays.time, "s")
            panels[0, column].set_title(shorten(name, letters(panels[0, column])))
            if lines:
                line, panel = lines[column], next(free_panels)
                unit = scaled([np.abs(other.values).max(initial=0.0) for other in lines], line.unit)
                draw_largest(panel, arrays.time / time.divisor, line.values / unit.divisor, line.names)
                label(panel, "y", line.text, unit.unit)
            if with_balls:
                panel = next(free_panels)
                if _has_balls(run):
                    draw_cavity(panel, arrays, 0, shown, time, travel)
                else:
                    panel.text(0.5, 0.5, "no ball on a line", transform=panel.transAxes, ha="center", va="center")
            draw_ledger(run, next(free_panels), time, energy)
            time_axis(panels[-1, column], arrays.time, time, 5)
        # Only the first column is labelled, and all legends are merged, since their entries repeat.
        for row in panels:
            # The first column may have no ball, and then no label.
            row[0].set_ylabel(next(filter(None, (panel.get_ylabel() for panel in row)), ""))
            for panel in row[1:]:
                panel.set_ylabel("")
        for panel in panels.flat:
            if legend := panel.get_legend():  # it would cover the title
                legend.remove()
        entries: dict[str, Artist] = {}
        for panel in (*panels[0], *panels[-1]):
            handles, names = panel.get_legend_handles_labels()
            entries |= dict(zip(names, handles, strict=True))
        figure.legend(list(entries.values()), list(entries), loc="outside lower center", ncols=len(entries))
        figure.align_ylabels(panels[:, 0])
    return figure


def _has_balls(run: Run) -> bool:
    """Return whether the first damper of a run has balls."""
    return "impacts" in run.groups and bool(np.any(run.arrays.ball_damper == 0))
