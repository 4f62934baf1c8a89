"""Figure 11: the response to a weak pulse with and without the damper, for both orders of the cases."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.ticker import PercentFormatter
from numpy.typing import NDArray

from rattlebox import Case, Run
from rattlebox.analysis import settling_time
from rattlebox.plots import FAINT, INK, StyledFigure, label, pen, scaled

from .figure import QUANTILES, Reproduction
from .files import simulate
from .models import COLOURS, CONSTANT_E, RIGID, SHORT, STYLES, model_case, model_runs
from .system import START, band, paper_case

AMPLITUDE = 100.0  # of the pulse [N]
DURATION, RATE, MEMBERS = 30.0, 500.0, 48
SHOWN, EVERY = 2.0, 2  # time that is drawn [s], and of how many samples one
LEVELS = np.append(np.geomspace(0.9, 0.04, 25), (0.5, 0.05))
"""Shares of the bare structure's peak below which the response is to stay."""
WALLS: Mapping[str, int] = {"leading": 3, "trailing": 2}
"""Wall that the ball of the paper's case 3 touches, as read and with cases 2 and 3 swapped, and our number of that start."""
MODELS = CONSTANT_E, RIGID  # models shown; at these speeds a steel wall is the same as a rigid one
_OPTIONS: Mapping[str, Any] = {"amplitude": AMPLITUDE, "duration": DURATION, "rate": RATE}


def cases() -> Mapping[str, Case]:
    """Return the cases of both walls and models, and without damper."""
    every = product(MODELS, WALLS.items())
    damped = {f"{model}, {wall} wall": model_case(model, start=START[k], **_OPTIONS) for model, (wall, k) in every}
    return damped | {"without damper": paper_case(ball=False, **_OPTIONS)}


def data() -> xr.Dataset:
    """Compute the responses and their settling times for each level."""
    bare = simulate(cases()["without damper"]).arrays
    time, without = bare.time, bare.displacement[:, 0]
    peak = float(np.abs(without).max())
    levels = np.sort(LEVELS)[::-1]

    def settled(motion: NDArray[np.float64]) -> list[float]:
        return [settling_time(time, motion, band=level, reference=peak) for level in levels]

    def motion(run: Run) -> NDArray[np.float64]:
        return np.asarray(run.arrays.displacement[:, 0])

    drawn = np.flatnonzero(time <= SHOWN)[::EVERY]
    many = [model_runs(model, k, MEMBERS, **_OPTIONS) for model, k in product(MODELS, WALLS.values())]
    peaks = [np.median([np.abs(motion(run)).max() for run in runs]) for runs in many]
    shape = (len(MODELS), len(WALLS))
    over = ("model", "wall", "quantile")

    def spread(of: Any) -> NDArray[np.float64]:
        return np.reshape([band([of(run) for run in runs]) for runs in many], (*shape, 3, -1))

    return xr.Dataset(
        {
            "without": ("time", without[drawn]),
            "displacement": ((*over, "time"), spread(lambda run: motion(run)[drawn])),
            "settled_without": ("level", settled(without)),
            "settled": ((*over, "level"), spread(lambda run: settled(motion(run)))),
            "peak_reduction": (("model", "wall"), 1 - np.reshape(peaks, shape) / peak),
            "first_contact": (
                ("model", "wall"),
                np.reshape([np.median([run.arrays.impacts.time[0] for run in runs]) for runs in many], shape),
            ),
            "peak": ((), peak),
        },
        {"model": list(MODELS), "wall": list(WALLS), "time": time[drawn], "level": levels, **QUANTILES},
    )


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw displacements above and settling times below, one column per wall."""
    names = {CONSTANT_E: SHORT[CONSTANT_E], RIGID: "elasto-plastic"}
    grid = figure.subplots(2, 2, sharey="row")
    scale = scaled(data.without, "m")
    for (upper, lower), wall in zip(grid.T, data.wall.values, strict=True):
        upper.plot(data.time, data.without / scale.divisor, color=FAINT, lw=pen(0.8))
        for model in data.model.values:
            one, pale = data.sel(model=model, wall=wall), {"color": COLOURS[model], "alpha": 0.25, "lw": 0}
            look = {"color": COLOURS[model], "ls": STYLES[model]}
            low, median, high = one.displacement.values / scale.divisor
            upper.fill_between(data.time, low, high, **pale)
            upper.plot(data.time, median, lw=pen(0.6), **look)
            low, median, high = one.settled.values
            lower.fill_betweenx(data.level, low, high, **pale)
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


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return the times at which half and 5 % of the peak are reached: leading wall, trailing wall, bare."""
    settled = data.settled.sel(quantile=0.5, model=CONSTANT_E, wall=["leading", "trailing"])
    half, late = ([*settled.sel(level=x).values, float(data.settled_without.sel(level=x))] for x in (0.5, 0.05))
    reduced = 100 * data.peak_reduction.sel(wall="trailing", model=CONSTANT_E)
    return {"half": half, "late": late, "reduced": reduced, "members": MEMBERS}


FIGURE = Reproduction("figure_11", data, draw, 0.62, cases, values)
