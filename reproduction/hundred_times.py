"""Figure A1: ratio of the dissipation of the elasto-plastic model to constant restitution, over the yield stress."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from rattlebox import Case, JacksonGreen, Run, Tsuji, restitution_of_alpha
from rattlebox.plots import FAINT, INK, SERIES_MARKERS, SERIES_STYLES, StyledFigure, figure_style, label, pen

from .ensemble import band, ensemble, near
from .figure import Reproduction, letters
from .models import COLOURS, CONSTANT_E, MODELS, RIGID, SHORT, STEEL, described, two
from .reference import ALPHA, CONSTANT, START, paper_case

PRINTED = 1030e6  # Yield stress of the paper [Pa]
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
            axes.set_title(SHORT[model])
            _panel(axes, data.sel(model=model), COLOURS[model])
        panels[0].set_ylabel("Elasto-plastic over\nconstant restitution")
        proxies = [
            Line2D([], [], color=INK, ls=SERIES_STYLES[k], marker=SERIES_MARKERS[k], ms=pen(3), label=name)
            for k, name in enumerate(MEASURES.values())
        ]
        figure.legend(handles=proxies, loc="outside lower center", ncols=2)
        letters(figure)
    return figure


def _panel(axes: Axes, data: xr.Dataset, colour: str) -> None:
    stress, printed, claimed = data.yield_stress / 1e6, float(data.printed) / 1e6, float(data.claimed)
    for k, measure in enumerate(MEASURES):
        low, median, high = data.ratio.sel(measure=measure).where(lambda x: x > 0).values
        axes.fill_between(stress, low, high, color=colour, alpha=0.2, lw=0)
        axes.plot(stress, median, color=colour, ls=SERIES_STYLES[k], marker=SERIES_MARKERS[k], ms=pen(2.5))
    axes.axhline(claimed, color=INK, lw=pen())
    axes.text(
        1350,
        1.1 * claimed,
        f"claimed: about {claimed:g}",
        ha="right",
        va="bottom",
        bbox={"fc": "white", "ec": "none", "pad": 0.5},
    )
    axes.axvline(printed, color=FAINT, lw=pen(), zorder=0)
    axes.text(printed, 1000, "printed ", ha="right", va="center")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(0.95 * float(stress[0]), 1.05 * float(stress[-1]))
    axes.set_ylim(0.01, 2000)
    axes.set_xticks([100, 200, 500, 1000], ["100", "200", "500", "1000"])
    axes.minorticks_off()
    label(axes, "x", "Yield stress", "MPa")


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    most = data.ratio.sel(quantile=0.5, yield_stress=PRINTED).max("measure")
    bounds = ", ".join(f"{float(data.bound.sel(measure=measure)):.0f}" for measure in MEASURES)
    return (
        f"With the printed yield stress no meaning of “faster” reaches {CLAIMED:.0f} times: at most "
        f"{two(most.sel(model=STEEL))} (steel wall) and {two(most.sel(model=RIGID))} (rigid wall). No restitution law "
        f"could exceed {bounds} in "
        f"the four measures. Case 1, 5 kN, {_MEMBERS} starts; curves end where the law does."
    )


FIGURE = Reproduction(
    number="A1",
    title="About a hundred times faster? The elasto-plastic model over its yield stress",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
)
