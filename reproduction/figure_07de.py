"""Figures 7d and 7e: dissipation by damper and viscous damping over start position and pulse amplitude."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from rattlebox import Case, Run
from rattlebox.plots import FAINT, INK, SERIES_MARKERS, SERIES_STYLES, StyledFigure, label, pen

from .figure import QUANTILES, Reproduction, spread
from .files import simulate_many
from .judge import AS_READ, HEDGED, SWAPPED, estimate
from .models import ALL_MODELS, COLOURS, MODELS, SHORT, by_model, model_case, model_runs, two
from .system import START, band

AMPLITUDES = (100.0, 200.0, 500.0, 700.0, 1e3, 1.5e3, 2e3, 3e3, 5e3, 1e4, 2e4)
"""Of the pulse [N]; the paper prints only 100 and 5000 N."""
PRINTED = 5e3  # largest amplitude of the paper [N]
NAMES: Mapping[int, str] = {1: "centred", 2: "trailing wall", 3: "leading wall"}
MEMBERS = 24
_SPAN = 10.0


def cases() -> Mapping[str, Case]:
    """Return the cases of the three start positions under the largest pulse of the paper, for each model."""
    return {f"{model}, case {case}": _case(model, case, PRINTED) for model in ALL_MODELS for case in START}


def _case(model: str, case: int, amplitude: float) -> Case:
    return model_case(model, start=START[case], amplitude=amplitude, duration=_SPAN, times=[_SPAN])


def _results(run: Run) -> tuple[float, float]:
    work, lost = run.arrays.load_work[-1], run.ledger.channels["normal"][-1]
    return lost / work if lost > 1e-12 * work else 0.0, run.arrays.viscous_loss[-1] / work


def data() -> xr.Dataset:
    """Compute the shares of damper and viscous damping for all amplitudes, starts and models."""
    grid = (len(ALL_MODELS), len(START), len(AMPLITUDES))
    every = list(product(ALL_MODELS, START, AMPLITUDES))
    single = np.reshape([_results(run) for run in simulate_many([_case(*point) for point in every])], (*grid, 2))
    options: dict[str, Any] = {"duration": _SPAN, "times": [_SPAN]}
    runs = [model_runs(model, case, MEMBERS, amplitude=load, **options) for model, case, load in every]
    members = np.array([[_results(run) for run in many] for many in runs])
    many = band(members, axis=1).reshape(3, *grid, 2)
    over: Any = ("model", "start", "amplitude")
    return xr.Dataset(
        {
            "impact": (("quantile", *over), many[..., 0]),
            "impact_single": (over, single[..., 0]),
            "viscous": (("quantile", *over), many[..., 1]),
            "viscous_single": (over, single[..., 1]),
            "impacts": ((*over, "member"), members[..., 0].reshape(*grid, MEMBERS)),
        },
        {
            "model": list(ALL_MODELS),
            "start": list(START),
            "amplitude": list(AMPLITUDES),
            "member": np.arange(MEMBERS),
            **QUANTILES,
        },
    )


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw one column per model: loss in viscous damping and in impacts."""
    panels = figure.subplots(2, len(MODELS), sharex=True, sharey="row")
    for column, model in zip(panels.T, MODELS, strict=True):
        for axes, name in zip(column, ("viscous", "impact"), strict=True):
            _draw(axes, data.sel(model=model), name, COLOURS[model])
        column[0].set_title(SHORT[model])
        label(column[1], "x", "Amplitude of the pulse", "N")
    panels[0, 0].set(ylabel="Lost in viscous\ndamping (7d)", ylim=(0.6, 1.02))
    panels[1, 0].set(ylabel="Lost in impacts\n(7e)", yscale="log", ylim=(3e-4, 0.6))
    for axes in panels.flat:
        axes.yaxis.set_major_formatter(lambda value, _: f"{100 * value:g} %")
    proxies = []
    for k, (case, name) in enumerate(NAMES.items()):
        look: dict[str, Any] = {"color": INK, "ls": SERIES_STYLES[k], "marker": SERIES_MARKERS[k], "ms": pen(3)}
        proxies.append(Line2D([], [], label=f"case {case}, {name}", **look))
    figure.legend(handles=proxies, loc="outside lower center", ncols=3)


def _draw(axes: Axes, data: xr.Dataset, name: str, colour: str) -> None:
    for k, start in enumerate(NAMES):
        spread(axes, data.amplitude, data[name].sel(start=start).values, colour, ls=SERIES_STYLES[k])
        axes.plot(data.amplitude, data[f"{name}_single"].sel(start=start), SERIES_MARKERS[k], color=colour, ms=pen(3))
    axes.axvline(PRINTED, color=FAINT, lw=pen(), zorder=0)
    axes.set_xscale("log")


def _variation(*losses: NDArray[np.float64], case: int) -> NDArray[np.float64]:
    """Return the variation of a case over the amplitudes over the smaller one of the other cases."""
    by_case = np.array(np.broadcast_arrays(*losses)).reshape(len(START), -1, *np.shape(losses[0]))
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = by_case.mean(axis=1)
        varies = np.where(mean > 1e-9, by_case.std(axis=1) / mean, np.nan)
    others = [k for k in range(len(START)) if k != case - 1]
    return np.asarray(varies[case - 1] / np.fmin(*varies[others]))


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return the losses of the three starts, the consistency of case 2, and of case 3 if both are swapped."""
    lost = 100 * data.impact.sel(quantile=0.5, amplitude=PRINTED)
    losses = by_model(lambda m: ", ".join(two(x) for x in lost.sel(model=m)) + " %")
    printed = data.impacts.sel(amplitude=slice(None, PRINTED))
    samples = {model: printed.sel(model=model).values.reshape(-1, data.member.size) for model in ALL_MODELS}
    orders = {AS_READ: 2, SWAPPED: 3}
    return {
        "members": MEMBERS,
        "losses": losses,
        "hedged": 100 * HEDGED,
        "consistent": {
            (model, order): estimate(partial(_variation, case=case), *samples[model])
            for model, (order, case) in product(ALL_MODELS, orders.items())
        },
    }


FIGURE = Reproduction("figure_07de", data, draw, 0.62, cases, values)
