"""Figure 5: restitution against approach speed, and the approach speeds that occur."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from rattlebox import Case, JacksonGreen, ThorntonRestitution, contact_pairs, restitution_curve, restitution_of_alpha
from rattlebox.plots import FAINT, INK, StyledFigure, label, pen

from .figure import Reproduction
from .models import COLOURS, CONSTANT_E, MODELS, RIGID, SHORT, STEEL, STYLES, critical_speed, model_case, model_runs
from .system import ALPHA, paper_case

_WALLS = {STEEL: "steel", RIGID: "rigid"}
_LAWS = {"Jackson-Green": JacksonGreen(), "Thornton": ThorntonRestitution()}
_MEMBERS = 16
EDGES = np.geomspace(1e-3, 0.3, 61)  # of the classes of approach speed [m/s]


def cases() -> Mapping[str, Case]:
    """Return the paper's case with each model."""
    return {model: model_case(model, times=[0.0]) for model in MODELS}


def data() -> xr.Dataset:
    """Compute the laws, and the approach speeds after a pulse of 5 kN."""
    pair = contact_pairs(paper_case(), 0)[0]
    pairs = {STEEL: pair, RIGID: pair.against("rigid")}
    critical = np.array([critical_speed(model) for model in _WALLS])
    speed = np.unique(np.concatenate([np.geomspace(1e-3, 30, 601), critical]))
    curves = [[restitution_curve(law, pairs[model], speed) for model in _WALLS] for law in _LAWS.values()]
    many = [model_runs(model, 1, _MEMBERS, times=[0.0]) for model in MODELS]
    speeds = [np.concatenate([run.arrays.impacts.approach_speed for run in runs]) for runs in many]
    return xr.Dataset(
        {
            "restitution": (("law", "wall", "speed"), curves),
            "constant": ((), restitution_of_alpha(ALPHA, "zero_overlap")),
            "critical_speed": ("wall", critical),
            "share": (("model", "class"), [np.histogram(each, EDGES)[0] / each.size for each in speeds]),
            "largest_speed": ("model", [each.max() for each in speeds]),
        },
        {
            "speed": speed,
            "law": list(_LAWS),
            "wall": list(_WALLS),
            "model": list(MODELS),
            "class": np.sqrt(EDGES[1:] * EDGES[:-1]),
        },
    )


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw the laws where impacts occur, their whole range, and the distribution of the speeds."""
    layout: Any = [["near", "wide"], ["speeds", "wide"]]
    panels = figure.subplot_mosaic(layout, width_ratios=(1.7, 1), height_ratios=(1.3, 1))
    near, wide, speeds = (panels[name] for name in ("near", "wide", "speeds"))
    fastest = float(data.largest_speed.max())
    limits = {model: float(data.critical_speed.sel(wall=model)) for model in data.wall.values}
    for axes in (near, wide):
        for model in data.wall.values:
            for law, width in zip(data.law.values, (1.4, 0.6), strict=True):
                look: dict[str, Any] = {"color": COLOURS[model], "ls": STYLES[model], "lw": pen(width)}
                curve = data.restitution.sel(law=law, wall=model)
                axes.plot(data.speed, curve, label=f"{law}, {SHORT[model]}", **look)
        axes.axhline(float(data.constant), color=COLOURS[CONSTANT_E], label=SHORT[CONSTANT_E])
    for model in data.model.values:
        speeds.plot(data["class"], data.share.sel(model=model), color=COLOURS[model], ls=STYLES[model])
    for axes in panels.values():
        for model, limit in limits.items():
            axes.axvline(limit, color=COLOURS[model], lw=pen(0.5), zorder=0)
        axes.axvline(fastest, color=INK, lw=pen(0.5), ls=(0, (4, 3)), zorder=0)
        axes.set_xscale("log")
        label(axes, "x", "Approach speed V", "m/s")
    for model, limit in limits.items():
        speeds.text(0.97 * limit, 0.225, f"$V_c$, {SHORT[model]}", ha="right", va="top")
    near.set(xlim=(0.01, 0.3), ylim=(0.9, 1.003), ylabel="Restitution e", title="Restitution where impacts occur")
    wide.set(xlim=(0.01, 30), ylim=(0, 1.02), ylabel="Restitution e", title="The whole law")
    wide.axvspan(0.01, fastest, fc=FAINT, alpha=0.25, lw=0, zorder=0)
    wide.text(fastest, 0.03, " fastest impact", ha="left", va="bottom")
    speeds.set(xlim=(0.01, 0.3), ylim=(0, 0.23), title="Approach speeds, case 1, 5 kN")
    speeds.set_ylabel("Share of impacts\nper class of speed")
    for axes in (near, speeds):
        axes.minorticks_off()
        axes.set_xticks([0.01, 0.02, 0.05, 0.1, 0.2], ["0.01", "0.02", "0.05", "0.1", "0.2"])
    near.legend(loc="lower left")


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return the fastest impact, and the lowest restitution of slow ones."""
    law = data.restitution.sel(law="Jackson-Green")
    slow = law.where(data.speed <= data.critical_speed, 1.0).min("speed")
    return {
        "fastest": data.largest_speed.max(),
        "members": _MEMBERS,
        "slow": {model: slow.sel(wall=model) for model in _WALLS},
    }


FIGURE = Reproduction("figure_05", data, draw, 0.6, cases, values)
