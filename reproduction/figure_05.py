"""Figure 5: restitution against approach speed, and the approach speeds that occur."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from rattlebox import Case, JacksonGreen, ThorntonRestitution, contact_pairs, restitution_curve, restitution_of_alpha
from rattlebox.plots import FAINT, INK, StyledFigure, figure_style, label, pen

from .evidence import critical_speed
from .figure import Reproduction, letters
from .judge import Claim, by_wall, exact
from .models import COLOURS, CONSTANT_E, MODELS, RIGID, SHORT, STEEL, STYLES, described, model_case, model_runs
from .reference import ALPHA, paper_case

_WALLS = {STEEL: "steel", RIGID: "rigid"}
_LAWS = {"Jackson-Green": JacksonGreen(), "Thornton": ThorntonRestitution()}
_MEMBERS = 16
EDGES = np.geomspace(1e-3, 0.3, 61)  # Edges of the classes of approach speed [m/s]


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
    speeds = [
        np.concatenate([run.arrays.impacts.approach_speed for run in model_runs(model, 1, _MEMBERS, times=[0.0])])
        for model in MODELS
    ]
    shares = [np.histogram(each, EDGES)[0] / each.size for each in speeds]
    return xr.Dataset(
        {
            "restitution": described(("law", "wall", "speed"), curves, "", "restitution"),
            "constant": described((), restitution_of_alpha(ALPHA, "zero_overlap"), "", "restitution of the constant model"),
            "critical_speed": described("wall", critical, "m/s", "elastic limit V_c"),
            "share": described(("model", "class"), shares, "", "share of the impacts of case 1 after 5 kN in a class "
            "of speeds"),
            "largest_speed": described("model", [each.max() for each in speeds], "m/s", "largest approach speed after 5 kN"),
        },
        {
            "speed": described("speed", speed, "m/s", "approach speed V"),
            "law": described("law", list(_LAWS), "", "restitution law"),
            "wall": described("wall", list(_WALLS), "", "model"),
            "model": described("model", list(MODELS), "", "model"),
            "class": described("class", np.sqrt(EDGES[1:] * EDGES[:-1]), "m/s", "approach speed V, middle of a class"),
        },
    )  # fmt: skip


def draw(data: xr.Dataset) -> Figure:
    """Draw the laws where impacts occur, their whole range, and the distribution of the speeds."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.6)
        panels = figure.subplot_mosaic(
            [["near", "wide"], ["speeds", "wide"]], width_ratios=(1.7, 1), height_ratios=(1.3, 1)
        )
        for axes in (panels["near"], panels["wide"]):
            for model in data.wall.values:
                for law, width in zip(data.law.values, (1.4, 0.6), strict=True):
                    axes.plot(
                        data.speed,
                        data.restitution.sel(law=law, wall=model),
                        color=COLOURS[model],
                        ls=STYLES[model],
                        lw=pen(width),
                        label=f"{law}, {SHORT[model]}",
                    )
            axes.axhline(float(data.constant), color=COLOURS[CONSTANT_E], label=SHORT[CONSTANT_E])
        for model in data.model.values:
            panels["speeds"].plot(data["class"], data.share.sel(model=model), color=COLOURS[model], ls=STYLES[model])
        for axes in panels.values():
            for model in data.wall.values:
                limit = float(data.critical_speed.sel(wall=model))
                axes.axvline(limit, color=COLOURS[model], lw=pen(0.5), zorder=0)
            axes.axvline(float(data.largest_speed.max()), color=INK, lw=pen(0.5), ls=(0, (4, 3)), zorder=0)
            axes.set_xscale("log")
            label(axes, "x", "Approach speed V", "m/s")
        for model in data.wall.values:
            limit = float(data.critical_speed.sel(wall=model))
            panels["speeds"].text(0.97 * limit, 0.225, f"$V_c$, {SHORT[model]}", ha="right", va="top")
        panels["near"].set(
            xlim=(0.01, 0.3), ylim=(0.9, 1.003), ylabel="Restitution e", title="Restitution where impacts occur"
        )
        panels["wide"].set(xlim=(0.01, 30), ylim=(0, 1.02), ylabel="Restitution e", title="The whole law")
        panels["wide"].axvspan(0.01, float(data.largest_speed.max()), fc=FAINT, alpha=0.25, lw=0, zorder=0)
        panels["wide"].text(float(data.largest_speed.max()), 0.03, " fastest impact", ha="left", va="bottom")
        panels["speeds"].set(xlim=(0.01, 0.3), ylim=(0, 0.23), title="Approach speeds, case 1, 5 kN")
        panels["speeds"].set_ylabel("Share of impacts\nper class of speed")
        for axes in (panels["near"], panels["speeds"]):
            axes.minorticks_off()
            axes.set_xticks([0.01, 0.02, 0.05, 0.1, 0.2], ["0.01", "0.02", "0.05", "0.1", "0.2"])
        panels["near"].legend(loc="lower left")
        letters(figure)
    return figure


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    limit = {model: float(data.critical_speed.sel(wall=model)) for model in _WALLS}
    return (
        f"The wall decides whether impacts yield: V_c is {limit[STEEL]:.4f} m/s on a steel wall and "
        f"{limit[RIGID]:.4f} m/s on a rigid "
        f"one, and no impact exceeds {float(data.largest_speed.max()):.3f} m/s. Thornton's law (thin) with the same "
        "V_c loses more. "
        f"{_MEMBERS} starts within 1 µm."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the claim on slow impacts."""
    law = data.restitution.sel(law="Jackson-Green")
    slow = law.where(data.speed <= data.critical_speed, 1.0).min("speed")
    limits = ", ".join(f"{float(data.critical_speed.sel(wall=m)):.5f} m/s ({SHORT[m]})" for m in _WALLS)
    return (
        Claim(
            "Steel loses nothing in slow impacts, so that a constant restitution does not suit it.",
            "sections 2 and 3.2, figure 5",
            "lowest restitution up to V_c",
            by_wall({model: exact(slow.sel(wall=model)) for model in _WALLS}),
            accept=(1, 1),
            kind="construction",
            note=f"V_c = {limits} with m* = mM/(m + M)",
        ),
    )


FIGURE = Reproduction(
    number="5",
    title="Restitution against approach speed",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
