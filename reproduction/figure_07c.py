"""Figure 7c: energy dissipated by the damper against time, with all models."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from rattlebox import Case
from rattlebox.plots import FAINT, INK, StyledFigure, label, pen, scaled

from .figure import QUANTILES, Reproduction, spread
from .files import simulate
from .models import COLOURS, CONSTANT_E, MODELS, RIGID, SHORT, STEEL, STYLES, by_model, model_case, model_runs, two
from .system import band

CLAIMED = 100.0  # times that the elasto-plastic model dissipates faster, as the paper says
_TIMES = np.unique(np.round(np.concatenate([np.geomspace(4e-3, 10, 240), [10.0]]), 6)).tolist()
_MEMBERS = 64


def cases() -> Mapping[str, Case]:
    """Return the centred ball under the 5000 N pulse, by contact model."""
    return {model: model_case(model, times=_TIMES, name=model) for model in MODELS}


def data() -> xr.Dataset:
    """Compute the energy lost in impacts, of one run and of an ensemble."""
    single = [simulate(case) for case in cases().values()]
    many = [model_runs(model, 1, _MEMBERS, times=_TIMES) for model in MODELS]
    lost = np.array([band([run.ledger.channels["normal"] for run in runs]) for runs in many])
    constant, plastic = lost[list(MODELS).index(CONSTANT_E), 1], [list(MODELS).index(m) for m in (STEEL, RIGID)]
    with np.errstate(invalid="ignore"):
        ratio = lost[plastic] / constant
    return xr.Dataset(
        {
            "single": (("model", "time"), [run.ledger.channels["normal"] for run in single]),
            "lost": (("model", "quantile", "time"), lost),
            "ratio": (("plastic", "quantile", "time"), ratio),
            "claimed": ((), CLAIMED),
            "work": ((), single[0].arrays.load_work[-1]),
        },
        {"time": single[0].arrays.time, "model": list(MODELS), "plastic": [STEEL, RIGID], **QUANTILES},
    )


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw the energy lost over time, and the ratio of the elasto-plastic to the constant model."""
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
    right.set(yscale="log", ylim=(0.005, 300), title="Relative to constant restitution", ylabel="Ratio of the losses")
    for axes in (left, right):
        axes.set(xscale="log", xlim=(4e-3, 10))
        label(axes, "x", "Time", "s")
    left.legend(loc="upper left")


def _draw(axes: Axes, time: xr.DataArray, values: xr.DataArray, model: str) -> None:
    shown = time.values > 0
    look: dict[str, Any] = {"ls": STYLES[model], "label": SHORT[model]}
    spread(axes, time[shown], values.values[:, shown], COLOURS[model], alpha=0.3, **look)


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return the largest ratio, and the loss of each model in per cent."""
    share = 100 * data.lost.sel(quantile=0.5).isel(time=-1) / data.work
    shares = by_model(lambda m: f"{two(share.sel(model=m))} %")
    highest = two(data.ratio.sel(quantile=0.5).max())
    return {"highest": highest, "shares": shares, "members": _MEMBERS}


FIGURE = Reproduction("figure_07c", data, draw, 0.42, cases, values)
