"""Figure of the energy of a run: instantaneous energies, and the ledger of the energy supplied."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..results import Run
from ..results.figures import run_figure
from .style import (
    CHANNEL_COLOURS,
    INK,
    SERIES_STYLES,
    Scale,
    StyledFigure,
    figure_style,
    label,
    legend_above,
    pen,
    scaled,
    time_axis,
)
from .types import Size

LOG_DECADES = 6.0
_LEDGER_LABELS = {
    "viscous": "structure damping",
    "normal": "normal damping",
    "plastic": "plastic flow",
    "sliding": "sliding",
    "rolling": "rolling",
    "motion": "remaining motion",
}


@run_figure("energy")
def plot_energy(run: Run, *, size: Size = "column", log: bool = False) -> Figure:
    """Draw the instantaneous energies, and below them the energy ledger as stacked areas.

    The areas of the ledger are the losses since the start and the energy that remains in the motion. The line is the energy
    supplied by load, base, initial motion and gravity; the distance between the line and the areas is the energy residual.

    Parameters
    ----------
    run
        Run to draw.
    size
        Width of the figure: "column", "page" or "slide".
    log
        Whether to draw the instantaneous energies on a logarithmic axis of six decades.

    Returns
    -------
    Figure
        Figure with two panels with a common time axis.

    Raises
    ------
    ValueError
        If the size is unknown.
    """
    with figure_style(size):
        figure = StyledFigure(size, 1.15 if size == "column" else 0.62)
        upper, lower = figure.subplots(2, 1, sharex=True)
        time = scaled(run.arrays.time, "s")
        draw_energies(run, upper, time, log=log)
        draw_ledger(run, lower, time, scaled(run.ledger.supplied, "J"))
        legend_above(upper)
        legend_above(lower)
        time_axis(lower, run.arrays.time, time)
        figure.align_ylabels([upper, lower])
    return figure


def draw_energies(run: Run, axes: Axes, time: Scale, *, log: bool = False) -> None:
    """Draw the energies of structure, balls, contacts and gravity against time."""
    ledger = run.ledger
    parts = {
        "structure": ledger.structure,
        "particles": ledger.particles,
        "contact": ledger.contact,
        "gravity": ledger.gravity - ledger.gravity.min(),
    }
    parts = {name: energy for name, energy in parts.items() if np.any(energy != 0.0)}
    highest = max((float(np.nanmax(energy)) for energy in parts.values()), default=0.0)
    scale, unit = scaled(highest, "J")
    names = {"particles": "balls" if "impacts" in run.groups else "particles", "contact": "contacts"}
    for (name, energy), style in zip(parts.items(), SERIES_STYLES, strict=False):
        axes.plot(
            run.arrays.time / time.divisor,
            np.where(energy > 0.0, energy, np.nan) / scale if log else energy / scale,
            color=CHANNEL_COLOURS[name],
            label=names.get(name, name),
            linestyle=style,
            linewidth=pen(),
        )
    if log and highest > 0.0:
        axes.set_yscale("log")
        axes.set_ylim(highest / scale * 10.0**-LOG_DECADES, 2.0 * highest / scale)
    else:
        axes.set_ylim(bottom=0.0)
    label(axes, "y", "Energy", unit)


def draw_ledger(run: Run, axes: Axes, time: Scale, energy: Scale) -> None:
    """Draw losses and remaining energy as stacked areas, and the energy supplied as a line."""
    ledger = run.ledger
    parts = {name: part for name, part in ledger.channels.items() if name == "motion" or np.any(part != 0.0)}
    t = run.arrays.time / time.divisor
    axes.stackplot(
        t,
        [part / energy.divisor for part in parts.values()],
        labels=[_LEDGER_LABELS[name] for name in parts],
        colors=[CHANNEL_COLOURS[name] for name in parts],
        edgecolor="white",
        linewidth=pen(0.3),
    )
    axes.plot(t, ledger.supplied / energy.divisor, color=INK, label="supplied", clip_on=False)
    axes.set_ylim(bottom=0.0, auto=None)  # the axis is that of all columns of a comparison, of which others may follow
    label(axes, "y", "Energy ledger", energy.unit)
