"""Figures 9a and 9b: phase portraits of ball and structure after a weak pulse."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from math import inf

import numpy as np
import xarray as xr
from cmcrameri import cm  # type: ignore[import-untyped]
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rattlebox import Case
from rattlebox.analysis import phase_portrait
from rattlebox.plots import FAINT, INK, StyledFigure, figure_style, pen

from .ensemble import band
from .figure import Reproduction, letters
from .judge import SYSTEM, Claim, by_wall, exact
from .models import ALL_MODELS, CONSTANT_E, RIGID, described, model_case, model_runs
from .reference import DAMPING, GAP, MASS, PULSE, START, STIFFNESS
from .runs import simulate_many

AMPLITUDE = 100.0  # Of the pulse [N]
DURATION, RATE, MEMBERS = 4.0, 1000.0, 24
SHOWN: Mapping[str, str] = {CONSTANT_E: "constant e", RIGID: "elasto-plastic, no loss"}
"""Models of the rows; at these speeds steel and rigid wall are the same."""
_PLACES = {1: "centred", 2: "at the trailing wall", 3: "at the leading wall"}


def cases() -> Mapping[str, Case]:
    """Return the runs of all models and start positions."""
    return {
        f"{model}, case {k}": model_case(model, start=START[k], amplitude=AMPLITUDE, duration=DURATION, rate=RATE)
        for model, k in product(ALL_MODELS, START)
    }


def data() -> xr.Dataset:
    """Compute the phase portraits of the models shown, and contacts and jumps of all."""
    runs = simulate_many(list(cases().values()))
    shape = (len(ALL_MODELS), len(START))
    time = runs[0].arrays.time
    portraits = [[phase_portrait(run, point) for run in runs] for point in (None, runs[0].arrays.points[0])]
    radii = [
        np.hypot(p.position.values, p.velocity.values * np.sqrt(MASS / STIFFNESS))[time > PULSE] for p in portraits[1]
    ]
    shown = [k for k, model in enumerate(ALL_MODELS) if model in SHOWN]

    def drawn(name: str) -> NDArray[np.float64]:
        values = np.reshape([[p[name].values[::2] for p in body] for body in portraits], (2, *shape, -1))
        return np.asarray(values[:, shown])

    counts = [
        [
            len(run.arrays.impacts)
            for run in model_runs(m, k, MEMBERS, amplitude=AMPLITUDE, duration=DURATION, rate=RATE)
        ]
        for m, k in product(ALL_MODELS, START)
    ]
    over = ("body", "shown", "case", "time")
    return xr.Dataset(
        {
            "position": described(over, drawn("position"), "m", "position in the cavity, or displacement"),
            "velocity": described(over, drawn("velocity"), "m/s", "velocity in the cavity, or over ground"),
            "contacts": described(
                ("quantile", "model", "case"), np.reshape(band(counts, axis=1), (3, *shape)), "", "contacts in 4 s, ensemble"
            ),
            "jump": described(
                ("model", "case"), np.reshape([np.diff(r).max() / r[0] for r in radii], shape), "",
                "largest rise of the structure's amplitude between samples over its first amplitude",
            ),
            "decay": described(
                (), -np.polyfit(time[time > PULSE], np.log(radii[0]), 1)[0], "1/s", "decay rate of the amplitude, case 1"
            ),
            "reach": described((), np.abs(portraits[0][0].position).max(), "m", "largest position of the ball in case 1"),
            "wall_place": described("side", [-GAP, GAP], "m", "position of the walls"),
        },
        {
            "body": described("body", ["ball in its cavity", "structure"], "", "body"),
            "model": described("model", list(ALL_MODELS), "", "contact model"),
            "shown": described("shown", list(SHOWN), "", "contact model"),
            "case": described("case", list(START), "", "start position"),
            "time": described("time", time[::2], "s", "time"),
            "side": described("side", [-1, 1], "", "side of the cavity"),
            "quantile": described("quantile", [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
        },
    )  # fmt: skip


def draw(data: xr.Dataset) -> Figure:
    """Draw the portraits: rows for bodies and models, columns for cases."""
    with figure_style("page"):
        figure = StyledFigure("page", 1.05)
        grid = figure.subplots(4, len(START))
        rows = list(product(data.body.values, SHOWN))
        for index, panel in enumerate(grid.flat):
            first = grid[index // len(START) // 2 * 2, 0]
            if panel is not first:
                panel.sharex(first)
                panel.sharey(first)
        line = None
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
        assert line is not None
        bar = figure.colorbar(line, ax=grid, aspect=60, pad=0.02)
        bar.outline.set_visible(False)
        bar.set_label("Time (s)")
        letters(figure)
    return figure


def _portrait(axes: Axes, x: NDArray[np.float64], v: NDArray[np.float64], time: NDArray[np.float64]) -> LineCollection:
    """Draw a line coloured by time."""
    points = np.column_stack((x, v))
    line = LineCollection(
        list(np.stack((points[:-1], points[1:]), axis=1)),
        array=time[:-1],
        cmap=LinearSegmentedColormap.from_list("dark", cm.batlow(np.linspace(0, 0.78, 256))),
        linewidths=pen(0.5),
        rasterized=True,
    )
    axes.add_collection(line)
    return line


def touching_pulse(data: xr.Dataset) -> float:
    """Return the amplitude of the pulse [N] from which the centred ball has contacts; below, the system is linear."""
    return AMPLITUDE * GAP / float(data.reach)


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    low, _, high = data.contacts.sel(model=CONSTANT_E).values
    return (
        f"After {AMPLITUDE:g} N the centred ball is never touched; it would be from {touching_pulse(data):.0f} N on. "
        "From either wall it "
        f"is set flying, and each contact moves the structure to another spiral. Single runs of {DURATION:g} s; "
        "contacts in cases 2 and 3 "
        f"of {MEMBERS} starts within 1 µm: {low[1]:.0f} to {high[1]:.0f} and {low[2]:.0f} to {high[2]:.0f} (constant e)."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the claims on the portraits."""
    viscous, reach = DAMPING / (2 * MASS), float(data.reach)
    jump = data.jump.sel(case=[2, 3]).min("case")
    return (
        Claim(
            "After 100 N the ball of case 1 never touches a wall.",
            "section 5.1, figure 9",
            "amplitude over the clearance, case 1",
            {SYSTEM: exact(reach / GAP)},
            accept=(0, 1),
            printed="d_0 = 0.4 mm",
            scope="system",
            note=f"the amplitude is {1e3 * reach:.4f} mm; contact begins at {touching_pulse(data):.0f} N",
        ),
        Claim(
            "Case 1 is a pure stable focus because of the viscous damping.",
            "section 5.1, figure 9",
            "decay rate over C/(2M)",
            {SYSTEM: exact(data.decay / viscous)},
            accept=(0.99, 1.01),
            scope="system",
            note=f"{float(data.decay):.4f} per second",
        ),
        Claim(
            "With contacts (cases 2 and 3) the behaviour differs fundamentally.",
            "section 5.1, figure 9",
            "largest outward jump of the structure over its first amplitude, the smaller of both cases",
            by_wall({str(model): exact(jump.sel(model=model)) for model in data.model.values}),
            accept=(0.05, inf),
            scope="both",
            note="without contacts the amplitude only falls",
        ),
    )


FIGURE = Reproduction(
    number="9a, 9b",
    title="Phase portraits after a weak pulse",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
