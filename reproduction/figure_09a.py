"""Figures 9a and 9b: phase portraits of ball and structure after a weak pulse."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from cmcrameri import cm  # type: ignore[import-untyped]
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap
from numpy.typing import NDArray

from rattlebox import Case
from rattlebox.analysis import phase_portrait
from rattlebox.plots import FAINT, INK, StyledFigure, pen

from .figure import QUANTILES, Reproduction
from .files import simulate_many
from .models import ALL_MODELS, CONSTANT_E, RIGID, model_case, model_runs
from .system import DAMPING, GAP, MASS, PULSE, START, STIFFNESS, band

AMPLITUDE = 100.0  # of the pulse [N]
DURATION, RATE, MEMBERS = 4.0, 1000.0, 24
SHOWN: Mapping[str, str] = {CONSTANT_E: "constant e", RIGID: "elasto-plastic, no loss"}
"""Models of the rows; at these speeds steel and rigid wall are the same."""
_PLACES = {1: "centred", 2: "at the trailing wall", 3: "at the leading wall"}
_OPTIONS: Mapping[str, Any] = {"amplitude": AMPLITUDE, "duration": DURATION, "rate": RATE}


def cases() -> Mapping[str, Case]:
    """Return the runs of all models and start positions."""
    every = product(ALL_MODELS, START)
    return {f"{model}, case {k}": model_case(model, start=START[k], **_OPTIONS) for model, k in every}


def data() -> xr.Dataset:
    """Compute the phase portraits of the models shown, and contacts and jumps of all."""
    runs = simulate_many(list(cases().values()))
    shape = (len(ALL_MODELS), len(START))
    time = runs[0].arrays.time
    late = time > PULSE
    portraits = [[phase_portrait(run, point) for run in runs] for point in (None, runs[0].arrays.points[0])]
    slow = np.sqrt(MASS / STIFFNESS)
    radii = [np.hypot(p.position.values, p.velocity.values * slow)[late] for p in portraits[1]]
    shown = [k for k, model in enumerate(ALL_MODELS) if model in SHOWN]

    def drawn(name: str) -> NDArray[np.float64]:
        values = np.reshape([[p[name].values[::2] for p in body] for body in portraits], (2, *shape, -1))
        return np.asarray(values[:, shown])

    many = [model_runs(m, k, MEMBERS, **_OPTIONS) for m, k in product(ALL_MODELS, START)]
    counts = [[len(run.arrays.impacts) for run in each] for each in many]
    over = ("body", "shown", "case", "time")
    return xr.Dataset(
        {
            "position": (over, drawn("position")),
            "velocity": (over, drawn("velocity")),
            "contacts": (("quantile", "model", "case"), np.reshape(band(counts, axis=1), (3, *shape))),
            "jump": (("model", "case"), np.reshape([np.diff(r).max() / r[0] for r in radii], shape)),
            "decay": ((), -np.polyfit(time[late], np.log(radii[0]), 1)[0]),
            "reach": ((), float(np.abs(portraits[0][0].position).max())),
            "wall_place": ("side", [-GAP, GAP]),
        },
        {
            "body": ["ball in its cavity", "structure"],
            "model": list(ALL_MODELS),
            "shown": list(SHOWN),
            "case": list(START),
            "time": time[::2],
            "side": [-1, 1],
            **QUANTILES,
        },
    )


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw the portraits: rows for bodies and models, columns for cases."""
    grid = figure.subplots(4, len(START))
    rows = list(product(data.body.values, SHOWN))
    for index, panel in enumerate(grid.flat):
        first = grid[index // len(START) // 2 * 2, 0]
        if panel is not first:
            panel.sharex(first)
            panel.sharey(first)
    for (row, (body, model)), (column, case) in product(enumerate(rows), enumerate(data.case.values)):
        axes: Axes = grid[row, column]
        one = data.sel(body=body, shown=model, case=case)
        line = _portrait(axes, 1e6 * one.position.values, 1e3 * one.velocity.values, one.time.values)
        if body == "structure":
            axes.set(xlim=(-62, 62), ylim=(-4.2, 4.2))
        else:
            axes.set(xlim=(-470, 470), ylim=(-12, 12))
            for side in 1e6 * data.wall_place.values:
                axes.axvspan(side, 2 * side, facecolor=FAINT, alpha=0.45, linewidth=0, zorder=0)
                axes.axvline(side, color=INK, linewidth=pen(0.7))
        axes.set_title(f"case {case}, {_PLACES[int(case)]}" if row == 0 else "")
        if column:
            axes.tick_params(labelleft=False)
        else:
            axes.set_ylabel(f"{body},\n{SHOWN[model]}\nVelocity (mm/s)")
        if row % 2:
            axes.set_xlabel("Position (µm)" if row == 1 else "Displacement (µm)")
        else:
            axes.tick_params(labelbottom=False)
    bar = figure.colorbar(line, ax=grid, aspect=60, pad=0.02)
    bar.outline.set_visible(False)
    bar.set_label("Time (s)")


def _portrait(axes: Axes, x: NDArray[np.float64], v: NDArray[np.float64], time: NDArray[np.float64]) -> LineCollection:
    """Draw a line coloured by time."""
    points = np.column_stack((x, v))
    dark = LinearSegmentedColormap.from_list("dark", cm.batlow(np.linspace(0, 0.78, 256)))
    steps = list(np.stack((points[:-1], points[1:]), axis=1))
    line = LineCollection(steps, array=time[:-1], cmap=dark, linewidths=pen(0.5), rasterized=True)
    axes.add_collection(line)
    return line


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return the pulse of first contact, contacts, and reach, decay and jumps over what they are compared with."""
    low, _, high = data.contacts.sel(model=CONSTANT_E).values
    touch = AMPLITUDE * GAP / float(data.reach)
    numbers = {"amplitude": AMPLITUDE, "duration": DURATION, "members": MEMBERS, "low": low, "high": high}
    jump = data.jump.sel(case=[2, 3]).min("case")
    differs = {model: jump.sel(model=model) for model in data.model.values}
    return {
        **numbers,
        "touch": touch,
        "reach": 1e3 * data.reach,
        "touches": float(data.reach) / GAP,
        "focus": data.decay / (DAMPING / (2 * MASS)),
        "differs": differs,
    }


FIGURE = Reproduction("figure_09a", data, draw, 1.05, cases, values)
