"""Figure A1: ratio of the dissipation of the elasto-plastic model to constant restitution, over the yield stress."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from rattlebox import Case, JacksonGreen, Run, Tsuji, restitution_of_alpha
from rattlebox.plots import FAINT, INK, SERIES_MARKERS, SERIES_STYLES, StyledFigure, label, pen

from .figure import QUANTILES, Reproduction, spread
from .models import COLOURS, CONSTANT_E, MODELS, RIGID, SHORT, STEEL, two
from .system import ALPHA, CONSTANT, START, band, ensemble, near, paper_case

PRINTED = 1030e6  # yield stress of the paper [Pa]
YIELD_STRESSES = [80e6, 100e6, 120e6, 150e6, 200e6, 300e6, 400e6, 500e6, 700e6, 850e6, PRINTED, 1.2e9, 1.5e9]
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
    first, total = run.arrays.impacts.energy_lost[0], run.ledger.channels["normal"][-1]
    return [first, total, *(_time_to(run, loss) for loss in losses)]


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
            "ratio": (("quantile", "model", "yield_stress", "measure"), values),
            "claimed": ((), CLAIMED),
            "printed": ((), PRINTED),
            "bound": ("measure", bounds),
        },
        {"model": list(_WALLS), "yield_stress": YIELD_STRESSES, "measure": list(MEASURES), **QUANTILES},
    )


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw one panel per interpretation: four meanings of "faster" over the yield stress."""
    panels = figure.subplots(1, data.model.size, sharey=True)
    for axes, model in zip(panels, data.model.values, strict=True):
        axes.set_title(SHORT[model])
        _panel(axes, data.sel(model=model), COLOURS[model])
    panels[0].set_ylabel("Elasto-plastic over\nconstant restitution")
    looks: list[dict[str, Any]] = [{"ls": SERIES_STYLES[k], "marker": SERIES_MARKERS[k]} for k in range(len(MEASURES))]
    names = zip(MEASURES.values(), looks, strict=True)
    proxies = [Line2D([], [], color=INK, ms=pen(3), label=name, **look) for name, look in names]
    figure.legend(handles=proxies, loc="outside lower center", ncols=2)


def _panel(axes: Axes, data: xr.Dataset, colour: str) -> None:
    stress, printed, claimed = data.yield_stress / 1e6, float(data.printed) / 1e6, float(data.claimed)
    for k, measure in enumerate(MEASURES):
        values = data.ratio.sel(measure=measure).where(lambda x: x > 0).values
        look: dict[str, Any] = {"ls": SERIES_STYLES[k], "marker": SERIES_MARKERS[k], "ms": pen(2.5)}
        spread(axes, stress, values, colour, alpha=0.2, **look)
    axes.axhline(claimed, color=INK, lw=pen())
    box: dict[str, Any] = {"fc": "white", "ec": "none", "pad": 0.5}
    axes.text(1350, 1.1 * claimed, f"claimed: about {claimed:g}", ha="right", va="bottom", bbox=box)
    axes.axvline(printed, color=FAINT, lw=pen(), zorder=0)
    axes.text(printed, 1000, "printed ", ha="right", va="center")
    axes.set(xscale="log", yscale="log", ylim=(0.01, 2000))
    axes.set_xlim(0.95 * float(stress[0]), 1.05 * float(stress[-1]))
    axes.set_xticks([100, 200, 500, 1000], ["100", "200", "500", "1000"])
    axes.minorticks_off()
    label(axes, "x", "Yield stress", "MPa")


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return the largest ratios with the printed yield stress, and the bounds of all laws."""
    most = data.ratio.sel(quantile=0.5, yield_stress=PRINTED).max("measure")
    bounds = ", ".join(f"{float(data.bound.sel(measure=measure)):.0f}" for measure in MEASURES)
    largest = [two(most.sel(model=model)) for model in (STEEL, RIGID)]
    return {"claimed": CLAIMED, "most": largest, "bounds": bounds, "members": _MEMBERS}


FIGURE = Reproduction("hundred_times", data, draw, 0.52, cases, values)
