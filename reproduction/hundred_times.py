"""Figure A1: ratio of the dissipation of the elasto-plastic model to constant restitution, over the yield stress."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rattlebox import Case, JacksonGreen, Run, Tsuji, restitution_of_alpha
from rattlebox.plots import (
    FAINT,
    INK,
    SERIES_COLOURS,
    SERIES_MARKERS,
    SERIES_STYLES,
    StyledFigure,
    figure_style,
    label,
    pen,
)

from .ensemble import band, ensemble, near
from .figure import Claim, Reproduction
from .models import CONSTANT_E, MODELS, RIGID, STEEL, described
from .reference import ALPHA, CONSTANT, START, paper_case

PRINTED = 1030e6
"""Yield stress of the paper [Pa]."""
YIELD_STRESSES = (80e6, 100e6, 120e6, 150e6, 200e6, 300e6, 400e6, 500e6, 700e6, 850e6, PRINTED, 1.2e9, 1.5e9)
"""Range from the validity limit of the restitution law to almost elastic impacts [Pa]."""
CLAIMED = 100.0
MEASURES: Mapping[str, str] = {
    "first": "loss in the first contact",
    "total": "loss in 10 s",
    "half": "speed to half of the constant model's loss",
    "most": "speed to 90 % of the constant model's loss",
}
_WALLS: Mapping[str, Literal["rigid"] | None] = {STEEL: None, RIGID: "rigid"}
_PARTS = {"half": 0.5, "most": 0.9}
_MEMBERS, _SPAN = 16, 10.0


def cases() -> Mapping[str, Case]:
    """Return the constant model and both interpretations of the elasto-plastic model with the printed yield stress."""
    return {model: _case(contact) for model, contact in MODELS.items()}


def _case(contact: Tsuji, offset: float = 0.0) -> Case:
    return paper_case(contact, start=near(START[1], offset), duration=_SPAN, times=[_SPAN])


def _contact(model: str, yield_stress: float) -> Tsuji:
    return Tsuji(restitution=JacksonGreen(wall=_WALLS[model], yield_stress=yield_stress), ending=CONSTANT.ending)


def _runs(contact: Tsuji) -> list[Run]:
    return ensemble(partial(_case, contact), _MEMBERS)


def _time_to(run: Run, loss: float) -> float:
    """Return the time of the contact at which the loss reaches a value, inf if it does not."""
    lost = np.cumsum(run.arrays.impacts.energy_lost)
    return float(np.append(run.arrays.impacts.time, np.inf)[np.searchsorted(lost, loss)])


def _measured(run: Run, losses: Sequence[float]) -> list[float]:
    """Return first loss, total loss, and the times at which given losses are reached."""
    return [
        run.arrays.impacts.energy_lost[0],
        run.ledger.channels["normal"][-1],
        *(_time_to(run, loss) for loss in losses),
    ]


def data() -> xr.Dataset:
    """Compute losses and times of both models over the yield stress of the elasto-plastic one."""
    constant = _runs(MODELS[CONSTANT_E])
    total = float(np.median([run.ledger.channels["normal"][-1] for run in constant]))
    losses = [part * total for part in _PARTS.values()]
    reference = np.median([_measured(run, losses) for run in constant], axis=0)
    powers = np.array([1, 1, -1, -1])  # faster is more energy, but less time
    values = np.full((3, len(_WALLS), len(YIELD_STRESSES), len(MEASURES)), np.nan)
    for i, model in enumerate(_WALLS):
        for j, yield_stress in enumerate(YIELD_STRESSES):
            runs = _runs(_contact(model, yield_stress))
            if all(run.ok for run in runs):  # otherwise an impact was beyond the restitution law
                members = np.array([_measured(run, losses) for run in runs])
                values[:, i, j] = band((members / reference) ** powers)
    # Nothing can be lost before the first contact, and not more than there is.
    touch = constant[0].arrays.impacts.time[0]
    e = restitution_of_alpha(ALPHA, CONSTANT.ending)
    bounds = [1 / (1 - e**2), constant[0].arrays.load_work[-1] / total, *(reference[2:] / touch)]
    return xr.Dataset(
        {
            "ratio": described(
                ("quantile", "model", "yield_stress", "measure"), values, "", "elasto-plastic / constant"
            ),
            "claimed": described((), CLAIMED, "", "claimed ratio"),
            "printed": described((), PRINTED, "Pa", "printed yield stress"),
            "bound": described("measure", bounds, "", "largest ratio of any restitution law"),
        },
        {
            "model": described("model", list(_WALLS), "", "interpretation"),
            "yield_stress": described("yield_stress", YIELD_STRESSES, "Pa", "yield stress"),
            "measure": described("measure", list(MEASURES), "", "what is compared"),
            "quantile": described("quantile", [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
        },
    )


def draw(data: xr.Dataset) -> Figure:
    """Draw one panel per interpretation: four meanings of "faster" over the yield stress."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.52)
        panels = figure.subplots(1, data.model.size, sharey=True)
        for axes, model in zip(panels, data.model.values, strict=True):
            axes.set_title(str(model))
            _panel(axes, data.sel(model=model))
        panels[0].set_ylabel("Elasto-plastic over\nconstant restitution")
        handles, names = panels[0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=2)
    return figure


def _panel(axes: Axes, data: xr.Dataset) -> None:
    stress, printed, claimed = data.yield_stress / 1e6, float(data.printed) / 1e6, float(data.claimed)
    for k, (measure, name) in enumerate(MEASURES.items()):
        low, median, high = data.ratio.sel(measure=measure).where(lambda x: x > 0).values
        axes.fill_between(stress, low, high, color=SERIES_COLOURS[k], alpha=0.3, lw=0)
        axes.plot(
            stress,
            median,
            color=SERIES_COLOURS[k],
            ls=SERIES_STYLES[k],
            marker=SERIES_MARKERS[k],
            ms=pen(2),
            label=name,
        )
    axes.axhline(claimed, color=INK, lw=pen())
    axes.text(float(stress[-1]), 1.1 * claimed, f"claimed: about {claimed:g}", ha="right", va="bottom")
    axes.axvline(printed, color=FAINT, lw=pen(), zorder=0)
    axes.text(printed, 1000, "printed ", ha="right", va="center")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(0.95 * float(stress[0]), 1.05 * float(stress[-1]))
    axes.set_ylim(0.01, 2000)
    axes.set_xticks([100, 200, 500, 1000], ["100", "200", "500", "1000"])
    axes.minorticks_off()
    label(axes, "x", "Yield stress", "MPa")


def _wall(model: str) -> str:
    return model.removeprefix("elasto-plastic, ")


def _up_to(reached: xr.DataArray) -> list[str]:
    """Return each model with the yield stress up to which it reaches a value, as text."""
    highest = reached.yield_stress.where(reached).max("yield_stress").dropna("model")
    return [f"{_wall(model)} up to {float(highest.sel(model=model)) / 1e6:.0f} MPa" for model in highest.model.values]


def caption(data: xr.Dataset) -> str:
    """Return a caption with the result of each meaning of "faster", and the bound for all laws."""
    median = data.ratio.sel(quantile=0.5, yield_stress=PRINTED)
    low, middle, high = data.ratio.sel(measure="total").transpose("quantile", ...)
    wide = 100 * float(((high - low) / middle).where(middle > 0).max())

    def loss_text(model: str) -> str:
        first, total, half, most = (float(median.sel(model=model, measure=measure)) for measure in MEASURES)
        arrives = f"reaches half and 90 % of the constant model's loss {half:.3g} and {most:.3g} times as fast"
        return f"{first:.2g} times as much in the first contact and {total:.2g} times as much in 10 s, and " + (
            arrives if most else "never reaches 90 % of the constant model's loss"
        )

    return (
        "What the elasto-plastic model dissipates in comparison with constant restitution, centred ball, 5000 N, over the "
        f"yield stress, median and 10 to 90 % of {_MEMBERS} starts within 1 µm (bands of the loss in 10 s are up to "
        f"{wide:.0f} % wide); the curves end where an impact would leave the restitution law. With the printed "
        f"{PRINTED / 1e6:.0f} MPa and a steel wall, it loses {loss_text(STEEL)}; with a rigid wall, "
        f"{loss_text(RIGID)}. No restitution law could exceed "
        + ", ".join(f"{float(data.bound.sel(measure=measure)):.0f} ({name})" for measure, name in MEASURES.items())
        + "."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the verdict on the factor of about a hundred for all yield stresses."""
    median = data.ratio.sel(quantile=0.5)
    printed = median.sel(yield_stress=PRINTED)
    interpretations = [
        f"{model}, {name}"
        for model in data.model.values
        for measure, name in MEASURES.items()
        if CLAIMED / 2 <= printed.sel(model=model, measure=measure) <= 2 * CLAIMED
    ]
    every = printed.stack(way=("model", "measure"))
    model, measure = every.idxmax("way").item()
    reached = median >= CLAIMED
    softer = [
        f"{MEASURES[other]} ({' or '.join(_up_to(reached.sel(measure=other)))})"
        for other in data.measure.values
        if reached.sel(measure=other).any()
    ]
    return (
        Claim(
            statement="The damper dissipates about 100 times faster with the elasto-plastic model than with constant "
            "restitution.",
            where="section 5.1, figure 7c",
            ours=f"{float(every.max()):.0f} times at most with the printed yield stress: {MEASURES[measure]}, "
            f"{_wall(model)}; {CLAIMED:.0f} times "
            + (f"only in {' and '.join(softer)}" if softer else "with no yield stress"),
            interpretation=" or ".join(interpretations)
            if interpretations
            else "every meaning of faster, steel and rigid wall",
            verdict="reproduced" if interpretations else "not reproducible",
        ),
    )


FIGURE = Reproduction(
    number="A1",
    title="About a hundred times faster? The elasto-plastic model over its yield stress",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
