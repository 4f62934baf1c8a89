"""Figure 11: the response to a weak pulse with and without the damper, for both orders of the cases."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter
from numpy.typing import NDArray

from rattlebox import Case, Run
from rattlebox.analysis import settling_time
from rattlebox.plots import FAINT, INK, StyledFigure, figure_style, label, pen, scaled

from .ensemble import band
from .figure import Reproduction, letters
from .models import COLOURS, CONSTANT_E, RIGID, SHORT, STYLES, described, model_case, model_runs
from .reference import START, paper_case
from .runs import simulate

AMPLITUDE = 100.0  # Of the pulse [N]
DURATION, RATE, MEMBERS = 30.0, 500.0, 48
SHOWN, EVERY = 2.0, 2  # Time that is drawn [s], and of how many samples one
LEVELS = np.append(np.geomspace(0.9, 0.04, 25), (0.5, 0.05))
"""Shares of the bare structure's peak below which the response is to stay."""
WALLS: Mapping[str, int] = {"leading": 3, "trailing": 2}
"""Wall that the ball of the paper's case 3 touches, as read and with cases 2 and 3 swapped, and our number of that start."""
MODELS = CONSTANT_E, RIGID  # Models shown; at these speeds a steel wall is the same as a rigid one


def _case(model: str, wall: str) -> Case:
    return model_case(model, start=START[WALLS[wall]], amplitude=AMPLITUDE, duration=DURATION, rate=RATE)


def _bare() -> Case:
    return paper_case(ball=False, amplitude=AMPLITUDE, duration=DURATION, rate=RATE)


def cases() -> Mapping[str, Case]:
    """Return the cases of both walls and models, and without damper."""
    return {f"{model}, {wall} wall": _case(model, wall) for model in MODELS for wall in WALLS} | {
        "without damper": _bare()
    }


def data() -> xr.Dataset:
    """Compute the responses and their settling times for each level."""
    bare = simulate(_bare()).arrays
    time, without = bare.time, bare.displacement[:, 0]
    peak = float(np.abs(without).max())
    levels = np.sort(LEVELS)[::-1]

    def settled(motion: NDArray[np.float64]) -> list[float]:
        return [settling_time(time, motion, band=level, reference=peak) for level in levels]

    def motion(run: Run) -> NDArray[np.float64]:
        return np.asarray(run.arrays.displacement[:, 0])

    drawn = np.flatnonzero(time <= SHOWN)[::EVERY]
    spread, settling, peaks, contacts = [], [], [], []
    for model in MODELS:
        for wall in WALLS:
            runs = model_runs(model, WALLS[wall], MEMBERS, amplitude=AMPLITUDE, duration=DURATION, rate=RATE)
            spread.append(band([motion(run)[drawn] for run in runs]))
            settling.append(band([settled(motion(run)) for run in runs]))
            peaks.append(np.median([np.abs(motion(run)).max() for run in runs]))
            contacts.append(np.median([run.arrays.impacts.time[0] for run in runs]))
    shape = (len(MODELS), len(WALLS))
    over = ("model", "wall", "quantile")
    text = "time after which the displacement stays below a level"
    return xr.Dataset(
        {
            "without": described("time", without[drawn], "m", "displacement without damper"),
            "displacement": described((*over, "time"), np.reshape(spread, (*shape, 3, -1)), "m", "displacement, ensemble"),
            "settled_without": described("level", settled(without), "s", f"{text}, without damper"),
            "settled": described((*over, "level"), np.reshape(settling, (*shape, 3, -1)), "s", f"{text}, ensemble"),
            "peak_reduction": described(("model", "wall"), 1 - np.reshape(peaks, shape) / peak, "", "median "
            "reduction of the peak"),
            "first_contact": described(("model", "wall"), np.reshape(contacts, shape), "s", "median time of the "
            "first contact"),
            "peak": described((), peak, "m", "peak without damper"),
        },
        {
            "model": described("model", list(MODELS), "", "contact model"),
            "wall": described("wall", list(WALLS), "", "wall that the ball touches at the start"),
            "time": described("time", time[drawn], "s", "time"),
            "level": described("level", levels, "", "share of the peak without damper"),
            "quantile": described("quantile", [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
        },
    )  # fmt: skip


def draw(data: xr.Dataset) -> Figure:
    """Draw displacements above and settling times below, one column per wall."""
    names = {CONSTANT_E: SHORT[CONSTANT_E], RIGID: "elasto-plastic"}
    with figure_style("page"):
        figure = StyledFigure("page", 0.62)
        grid = figure.subplots(2, 2, sharey="row")
        scale = scaled(data.without, "m")
        for (upper, lower), wall in zip(grid.T, data.wall.values, strict=True):
            upper.plot(data.time, data.without / scale.divisor, color=FAINT, lw=pen(0.8))
            for model in data.model.values:
                one = data.sel(model=model, wall=wall)
                look = {"color": COLOURS[model], "ls": STYLES[model]}
                low, median, high = one.displacement.values / scale.divisor
                upper.fill_between(data.time, low, high, color=COLOURS[model], alpha=0.25, lw=0)
                upper.plot(data.time, median, lw=pen(0.6), **look)
                low, median, high = one.settled.values
                lower.fill_betweenx(data.level, low, high, color=COLOURS[model], alpha=0.25, lw=0)
                lower.plot(median, data.level, label=f"{names[str(model)]}, median and 10 to 90 %", **look)
            lower.plot(data.settled_without, data.level, color=FAINT, lw=pen(1.4), label="without damper")
            upper.set(xlim=(0, 2), title=f"Ball at the {wall} wall")
            lower.set(xlim=(0, 12), yscale="log", ylim=(0.04, 1), title="Settling")
            lower.set_yticks([0.05, 0.1, 0.2, 0.5, 1], minor=False)
            lower.set_yticks([], minor=True)
            lower.yaxis.set_major_formatter(PercentFormatter(1.0, symbol=" %"))
            lower.axhline(0.5, color=INK, lw=pen(0.3), zorder=0)
            label(upper, "x", "Time", "s")
            label(lower, "x", "Time after which it stays below", "s")
        label(grid[0, 0], "y", "Displacement", scale.unit)
        grid[1, 0].set_ylabel("Share of the peak\nwithout damper")
        figure.legend(*grid[1, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
        letters(figure)
    return figure


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    half = data.settled.sel(quantile=0.5, level=0.5, model=CONSTANT_E)
    last = data.settled.sel(quantile=0.5, level=0.05, model=CONSTANT_E)
    bare, late = (float(data.settled_without.sel(level=x)) for x in (0.5, 0.05))
    reduced = 100 * float(data.peak_reduction.sel(wall="trailing", model=CONSTANT_E))
    return (
        "The damper attenuates the motion at first and prolongs it later. Half of the peak is reached after "
        f"{float(half.sel(wall='leading')):.2f} s (leading wall), {float(half.sel(wall='trailing')):.2f} s (trailing "
        "wall, which lowers "
        f"the peak by {reduced:.0f} %) and {bare:.2f} s (bare); 5 % after {float(last.sel(wall='leading')):.1f}, "
        f"{float(last.sel(wall='trailing')):.1f} and {late:.1f} s. 100 N, constant e, {MEMBERS} starts."
    )


FIGURE = Reproduction(
    number="11",
    title="Response to a weak pulse with and without the damper",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
)
