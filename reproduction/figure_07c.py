"""Figure 7c: energy dissipated by the damper against time, with both models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rattlebox import Case, Run
from rattlebox.plots import FAINT, INK, StyledFigure, figure_style, label, pen, scaled

from .ensemble import band, ensemble, near
from .figure import Claim, Reproduction
from .models import COLOURS, CONSTANT_E, MODELS, STYLES, by_model, described
from .reference import START, paper_case
from .runs import simulate

CLAIMED = 100.0
"""Times that the elasto-plastic model dissipates faster, as the paper says."""
FEW = 10
"""Contacts that still count as a few."""
_TIMES = np.unique(np.round(np.concatenate([np.geomspace(4e-3, 10, 240), np.arange(0.05, 10, 0.05), [10.0]]), 6))


def cases() -> Mapping[str, Case]:
    """Return the centred ball under the 5000 N pulse, by contact model."""
    return {model: _case(model, name=model) for model in MODELS}


def _case(model: str, offset: float = 0.0, name: str = "") -> Case:
    return paper_case(MODELS[model], start=near(START[1], offset), times=_TIMES.tolist(), name=name)


def data() -> xr.Dataset:
    """Compute the energy lost in impacts, of one run and of an ensemble."""
    single = [simulate(case) for case in cases().values()]
    ensembles = [ensemble(partial(_case, model)) for model in MODELS]
    lost = np.array(band([[run.ledger.channels["normal"] for run in runs] for runs in ensembles], axis=1))
    counts = [[_contacts_to_half(run) for run in runs] for runs in ensembles]
    totals = [[len(run.arrays.impacts) for run in runs] for runs in ensembles]
    time = single[0].arrays.time
    plastic = [model for model in MODELS if model != CONSTANT_E]
    reference = lost[1, list(MODELS).index(CONSTANT_E)]
    with np.errstate(invalid="ignore"):
        ratio = lost[:, [list(MODELS).index(model) for model in plastic]] / reference
    many = ("quantile", "model")
    return xr.Dataset(
        {
            "single": described(
                ("model", "time"),
                [run.ledger.channels["normal"] for run in single],
                "J",
                "energy lost in impacts, one run",
            ),
            "lost": described((*many, "time"), lost, "J", "energy lost in impacts, ensemble of start positions"),
            "ratio": described(
                ("quantile", "plastic", "time"), ratio, "", "energy lost over the median with constant restitution"
            ),
            "contacts_to_half": described(many, band(counts, 1), "", "contacts that bring half of the loss"),
            "contacts": described(many, band(totals, 1), "", "contacts in 10 s"),
            "claimed": described((), CLAIMED, "", "claimed ratio of the losses"),
            "work": described("model", [run.arrays.load_work[-1] for run in single], "J", "work of the pulse"),
        },
        {
            "time": described("time", time, "s", "time"),
            "model": described("model", list(MODELS), "", "contact model"),
            "plastic": described("plastic", plastic, "", "elasto-plastic model"),
            "quantile": described("quantile", [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
        },
    )


def _contacts_to_half(run: Run) -> int:
    lost = np.cumsum(run.arrays.impacts.energy_lost)
    return int(np.searchsorted(lost, lost[-1] / 2)) + 1


def draw(data: xr.Dataset) -> Figure:
    """Draw the energy lost over time, and the ratio of the elasto-plastic to the constant model."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.45)
        left, right = figure.subplots(1, 2)
        _losses(left, data)
        _ratios(right, data)
        for axes in (left, right):
            label(axes, "x", "Time", "s")
        handles, names = left.get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=3)
    return figure


def _losses(axes: Axes, data: xr.Dataset) -> None:
    scale = scaled(data.lost, "J")
    for model in data.model.values:
        low, median, high = data.lost.sel(model=model).values / scale.divisor
        axes.fill_between(data.time, low, high, color=COLOURS[model], alpha=0.3, lw=0)
        axes.plot(data.time, median, color=COLOURS[model], ls=STYLES[model], label=f"{model}, median and 10 to 90 %")
        axes.plot(data.time, data.single.sel(model=model) / scale.divisor, color=INK, lw=pen(0.4), zorder=1)
    axes.plot([], [], color=INK, lw=pen(0.4), label="one run each")
    axes.set_xlim(0, float(data.time[-1]))
    axes.set_ylim(bottom=0)
    label(axes, "y", "Energy lost in impacts", scale.unit)


def _ratios(axes: Axes, data: xr.Dataset) -> None:
    for model in data.plastic.values:
        low, median, high = data.ratio.sel(plastic=model).values
        shown = data.time.values > 0
        axes.fill_between(data.time[shown], low[shown], high[shown], color=COLOURS[model], alpha=0.3, lw=0)
        axes.plot(data.time[shown], median[shown], color=COLOURS[model], ls=STYLES[model])
    claimed = float(data.claimed)
    axes.axhline(claimed, color=INK, lw=pen())
    axes.text(float(data.time[-1]), claimed, f"claimed: about {claimed:g}", ha="right", va="bottom")
    axes.axhline(1, color=FAINT, lw=pen(), zorder=0)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(float(data.time[data.time > 0][0]), float(data.time[-1]))
    axes.set_ylim(0.005, 300)
    axes.set_ylabel("Loss in impacts over that\nwith constant restitution")


def caption(data: xr.Dataset) -> str:
    """Return a caption with the loss of each model and its ratio to constant restitution."""
    median = data.lost.sel(quantile=0.5).isel(time=-1) / data.work
    said = by_model({model: f"{100 * float(median.sel(model=model)):.2g} %" for model in data.model.values})
    low, middle, high = data.lost.isel(time=-1).transpose("quantile", "model").values
    wide = {m: f"{x:.2g} %" for m, x in zip(data.model.values, 100 * (high - low) / middle, strict=True)}
    ratio = data.ratio.sel(quantile=0.5)
    develops = "; ".join(
        f"{model} {float(values[1]):.2g} after the first contact, {float(values[-1]):.2g} after 10 s"
        for model, values in zip(data.plastic.values, ratio.transpose("plastic", "time"), strict=True)
    )
    return (
        f"Energy lost in impacts of the centred ball after a pulse of 5000 N that brings {float(data.work[0]):.3g} J; "
        f"after 10 s, median of 64 starts within 1 µm: {said}. The band is then "
        f"{by_model(wide)} of the loss wide. Right, the ratio to constant restitution: {develops}; "
        f"once that contact is over it never exceeds {float(ratio.max()):.2g}."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the verdicts on the loss with constant restitution, and on the loss in the first contacts."""
    final = data.lost.isel(time=-1)
    plastic = data.plastic.values
    more = [m for m in plastic if final.sel(model=m, quantile=0.1) > final.sel(model=CONSTANT_E, quantile=0.9)]
    half = data.contacts_to_half.sel(quantile=0.5)
    few = [m for m in plastic if half.sel(model=m) <= FEW]

    total = data.contacts.sel(quantile=0.5)
    lost = {model: f"{1e3 * float(final.sel(model=model, quantile=0.5)):.2g} mJ" for model in data.model.values}
    counts = {m: f"{float(half.sel(model=m)):.0f} of {float(total.sel(model=m)):.0f}" for m in data.model.values}
    return (
        Claim(
            statement="Constant restitution underestimates the energy that the damper dissipates.",
            where="section 6, conclusion 2; figures 7a to 7c",
            ours=f"median loss in 10 s: {by_model(lost)}",
            interpretation=" or ".join(more or plastic),
            verdict="reproduced" if more else "not reproducible",
        ),
        Claim(
            statement="With the elasto-plastic model a few contacts take most of the energy, and little is lost later.",
            where="section 5.1, figure 7c",
            ours=f"contacts that bring half of the loss, medians: {by_model(counts)}",
            interpretation=" or ".join(few or plastic),
            verdict="reproduced" if few else "not reproducible",
        ),
    )


FIGURE = Reproduction(
    number="7c",
    title="Energy dissipated by the damper against time",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
