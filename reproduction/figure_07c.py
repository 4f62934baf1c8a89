"""Figure 7c: energy dissipated by the damper against time, with all models."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rattlebox import Case
from rattlebox.plots import FAINT, INK, StyledFigure, figure_style, label, pen, scaled

from .ensemble import band
from .figure import Reproduction, letters
from .models import (
    COLOURS,
    CONSTANT_E,
    MODELS,
    RIGID,
    SHORT,
    STEEL,
    STYLES,
    by_model,
    described,
    model_case,
    model_runs,
    two,
)
from .runs import simulate

CLAIMED = 100.0  # Times that the elasto-plastic model dissipates faster, as the paper says
_TIMES = np.unique(np.round(np.concatenate([np.geomspace(4e-3, 10, 240), [10.0]]), 6)).tolist()
_MEMBERS = 64


def cases() -> Mapping[str, Case]:
    """Return the centred ball under the 5000 N pulse, by contact model."""
    return {model: model_case(model, times=_TIMES, name=model) for model in MODELS}


def data() -> xr.Dataset:
    """Compute the energy lost in impacts, of one run and of an ensemble."""
    single = [simulate(case) for case in cases().values()]
    lost = np.array(
        [band([run.ledger.channels["normal"] for run in model_runs(m, 1, _MEMBERS, times=_TIMES)]) for m in MODELS]
    )
    constant, plastic = lost[list(MODELS).index(CONSTANT_E), 1], [list(MODELS).index(m) for m in (STEEL, RIGID)]
    with np.errstate(invalid="ignore"):
        ratio = lost[plastic] / constant
    return xr.Dataset(
        {
            "single": described(
                ("model", "time"), [run.ledger.channels["normal"] for run in single], "J", "energy lost in impacts, one run"
            ),
            "lost": described(("model", "quantile", "time"), lost, "J", "energy lost in impacts, ensemble of start "
            "positions"),
            "ratio": described(
                ("plastic", "quantile", "time"), ratio, "", "energy lost over the median with constant restitution"
            ),
            "claimed": described((), CLAIMED, "", "claimed ratio of the losses"),
            "work": described((), single[0].arrays.load_work[-1], "J", "work of the pulse"),
        },
        {
            "time": described("time", single[0].arrays.time, "s", "time"),
            "model": described("model", list(MODELS), "", "contact model"),
            "plastic": described("plastic", [STEEL, RIGID], "", "elasto-plastic model"),
            "quantile": described("quantile", [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
        },
    )  # fmt: skip


def draw(data: xr.Dataset) -> Figure:
    """Draw the energy lost over time, and the ratio of the elasto-plastic to the constant model."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.42)
        left, right = figure.subplots(1, 2)
        scale = scaled(data.lost, "J")
        for model in data.model.values:
            _draw(left, data.time, data.lost.sel(model=model) / scale.divisor, str(model))
            left.plot(data.time, data.single.sel(model=model) / scale.divisor, color=INK, lw=pen(0.4), zorder=1)
        left.plot([], [], color=INK, lw=pen(0.4), label="one run each")
        left.set(ylim=(0, None), title="Energy lost in impacts")
        label(left, "y", "Energy lost", scale.unit)
        for model in data.plastic.values:
            _draw(right, data.time, data.ratio.sel(plastic=model), str(model))
        right.axhline(float(data.claimed), color=INK, lw=pen())
        right.text(10, float(data.claimed), f"claimed: about {float(data.claimed):g}", ha="right", va="bottom")
        right.axhline(1, color=FAINT, lw=pen(), zorder=0)
        right.set(
            yscale="log", ylim=(0.005, 300), title="Relative to constant restitution", ylabel="Ratio of the losses"
        )
        for axes in (left, right):
            axes.set(xscale="log", xlim=(4e-3, 10))
            label(axes, "x", "Time", "s")
        left.legend(loc="upper left")
        letters(figure)
    return figure


def _draw(axes: Axes, time: xr.DataArray, values: xr.DataArray, model: str) -> None:
    shown = time.values > 0
    low, median, high = values.values[:, shown]
    axes.fill_between(time[shown], low, high, color=COLOURS[model], alpha=0.3, lw=0)
    axes.plot(time[shown], median, color=COLOURS[model], ls=STYLES[model], label=SHORT[model])


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    share = 100 * data.lost.sel(quantile=0.5).isel(time=-1) / data.work
    return (
        f"The elasto-plastic model never dissipates 100 times as much: after the first contact at most "
        f"{two(data.ratio.sel(quantile=0.5).max())} times. Loss in 10 s: "
        f"{by_model(lambda m: f'{two(share.sel(model=m))} %')} "
        f"of {float(data.work):.3g} J. Centred ball, 5 kN; median and 10 to 90 % of {_MEMBERS} starts within 1 µm."
    )


FIGURE = Reproduction(
    number="7c",
    title="Energy dissipated by the damper against time",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
)
