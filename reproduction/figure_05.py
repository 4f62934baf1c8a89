"""Figure 5: restitution against approach speed, and the approach speeds that occur."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rattlebox import (
    Case,
    JacksonGreen,
    Johnson,
    ThorntonRestitution,
    contact_pairs,
    restitution_curve,
    restitution_of_alpha,
)
from rattlebox.plots import FAINT, INK, SERIES_COLOURS, StyledFigure, figure_style, pen

from .ensemble import ensemble, near
from .figure import Claim, Reproduction
from .models import described
from .reference import ALPHA, PLASTIC, PLASTIC_RIGID, START, paper_case

WALLS = ("steel", "rigid")
_CONTACTS = {"steel": PLASTIC, "rigid": PLASTIC_RIGID}
_MARKS = (1.0, 10.0, 60.0, 100.0, 1000.0)
_LAWS = {"Jackson-Green": JacksonGreen(), "Thornton": ThorntonRestitution(), "Johnson": Johnson()}
_STYLES: dict[str, Any] = {"steel": "-", "rigid": (0, (4, 1.5))}
_MEMBERS = 16


def cases() -> Mapping[str, Case]:
    """Return the paper's case with each wall and start position."""
    return {f"{wall} wall, case {k}": _case(wall, start) for wall in WALLS for k, start in START.items()}


def _case(wall: str, start: float, offset: float = 0.0) -> Case:
    return paper_case(_CONTACTS[wall], start=near(start, offset), times=[0.0])


def data() -> xr.Dataset:
    """Compute the laws, and the approach speeds after a pulse of 5 kN."""
    pair = contact_pairs(paper_case(PLASTIC), 0)[0]
    pairs = {"steel": pair, "rigid": pair.against("rigid")}
    critical = np.array([JacksonGreen().critical_speed(pairs[wall]) for wall in WALLS])
    speed = np.unique(np.concatenate([np.geomspace(1e-3, 600, 501), critical]))
    curves = [[restitution_curve(law, pairs[wall], speed) for wall in WALLS] for law in _LAWS.values()]
    marked = np.multiply.outer(critical, _MARKS)
    marks = [restitution_curve(JacksonGreen(), pairs[wall], at) for wall, at in zip(WALLS, marked, strict=True)]
    met = [_impacts(wall, start) for wall in WALLS for start in START.values()]
    faster = np.reshape([[np.mean(speeds > x) for x in speed] for speeds, _ in met], (len(WALLS), len(START), -1))
    largest = np.reshape([speeds.max() for speeds, _ in met], (len(WALLS), len(START)))
    lowest = np.reshape([values.min() for _, values in met], (len(WALLS), len(START)))
    runs = ("wall", "start")

    return xr.Dataset(
        {
            "restitution": described(("law", "wall", "speed"), curves, "", "restitution"),
            "constant": described(
                (), restitution_of_alpha(ALPHA, "zero_overlap"), "", "restitution of the constant model"
            ),
            "critical_speed": described("wall", critical, "m/s", "elastic limit V_c of the Jackson-Green law"),
            "marked_speed": described(("wall", "reduced"), marked, "m/s", "approach speed at multiples of V_c"),
            "marked_restitution": described(("wall", "reduced"), marks, "", "Jackson-Green restitution there"),
            "faster": described((*runs, "speed"), faster, "", "share of the impacts after 5 kN that are faster"),
            "largest_speed": described(runs, largest, "m/s", "largest approach speed after 5 kN"),
            "lowest_restitution": described(runs, lowest, "", "lowest restitution after 5 kN"),
        },
        {
            "speed": described("speed", speed, "m/s", "approach speed V"),
            "law": described("law", list(_LAWS), "", "restitution law"),
            "wall": described("wall", list(WALLS), "", "elasticity of the wall in the law"),
            "start": described("start", list(START), "", "start position, the paper's case"),
            "reduced": described("reduced", _MARKS, "", "V* = V/V_c"),
        },
    )


def _impacts(wall: str, start: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return approach speeds and restitutions of all impacts of an ensemble."""
    runs = ensemble(partial(_case, wall, start), _MEMBERS)
    impacts = [run.impacts.isel(impact=run.impacts.restitution.notnull().values) for run in runs]
    speeds, values = ([log[name].values for log in impacts] for name in ("approach_speed", "restitution"))
    return np.concatenate(speeds), np.concatenate(values)


def draw(data: xr.Dataset) -> Figure:
    """Draw the laws, and below them the distribution of the speeds."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.74)
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2.2, 1))
        for law, colour, width in zip(data.law.values, SERIES_COLOURS, (1.6, 0.9, 0.9), strict=False):
            for wall in data.wall.values:
                curve = data.restitution.sel(law=law, wall=wall)
                name = f"{law}, {wall} wall"
                upper.plot(data.speed, curve, color=colour, linestyle=_STYLES[wall], lw=pen(width), label=name)
        upper.axhline(float(data.constant), color=INK, linestyle=(0, (1, 1.2)), lw=pen(0.8), label="constant model")
        for wall in data.wall.values:
            _limit((upper, lower), data.sel(wall=wall))
        for start, colour, width in zip(data.start.values, SERIES_COLOURS[3:], (2.2, 1.0, 0.9), strict=False):
            for wall in data.wall.values:
                share = data.faster.sel(start=start, wall=wall)
                name = f"case {start}, {wall} wall"
                lower.plot(data.speed, share, color=colour, linestyle=_STYLES[wall], lw=pen(width), label=name)
        upper.set(xscale="log", ylim=(0, 1.04))
        lower.set(xlim=(float(data.speed[0]), float(data.speed[-1])), ylim=(0, 1.04))
        upper.set_ylabel("Restitution e")
        lower.set_ylabel("Share of faster impacts\nafter 5 kN")
        lower.set_xlabel("Approach speed V (m/s)")
        upper.legend(loc="lower left")
        lower.legend(loc="upper right", ncols=3)
    return figure


def _limit(both: tuple[Axes, Axes], data: xr.Dataset) -> None:
    """Mark the elastic limit of a wall, and multiples of it on the curve."""
    upper, _ = both
    critical = float(data.critical_speed)
    wall = str(data.wall.values)
    for axes in both:
        axes.axvline(critical, color=FAINT, linestyle=_STYLES[wall], lw=pen(0.8), zorder=0)
    text = f"V* = 1, elastic limit, {wall} wall"
    upper.text(1.05 * critical, 0.02, text, rotation=90, va="bottom", fontsize="small")
    upper.plot(data.marked_speed, data.marked_restitution, "o", color=SERIES_COLOURS[0], mfc="white", ms=3.5)
    for reduced, x, y in zip(data.reduced.values, data.marked_speed, data.marked_restitution, strict=True):
        if reduced > 1:
            upper.annotate(
                f"V* = {reduced:g}",
                (float(x), float(y)),
                (5, 2) if wall == "steel" else (-5, -3),
                textcoords="offset points",
                ha="left" if wall == "steel" else "right",
                fontsize="small",
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.3},
            )


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    limit = {wall: float(data.critical_speed.sel(wall=wall)) for wall in WALLS}
    largest = {wall: float(data.largest_speed.sel(wall=wall).max()) for wall in WALLS}
    lowest = {wall: float(data.lowest_restitution.sel(wall=wall).min()) for wall in WALLS}
    beyond = {wall: 100 * float(data.faster.sel(wall=wall, speed=limit[wall], start=1)) for wall in WALLS}
    return (
        f"Restitution against approach speed for the paper's ball, by three laws. The elastic limit is "
        f"{limit['steel']:.4f} m/s on a steel wall and {limit['rigid']:.4f} m/s on a rigid one, "
        f"{limit['steel'] / limit['rigid']:.0f} times less: the paper does not say which it takes. Johnson's law holds for "
        "fully plastic impacts only and is capped at 1 here. Below, the share of "
        f"impacts that are faster than V in 10 s after the 5 kN pulse, over {_MEMBERS} starts within a micrometre: "
        f"{beyond['steel']:.1f} % of those in case 1 are beyond the limit on the steel wall, {beyond['rigid']:.0f} % on the "
        f"rigid one. No impact is faster than {max(largest.values()):.3f} m/s, so the restitution never falls below "
        f"{lowest['steel']:.4f} on the steel wall and {lowest['rigid']:.3f} on the rigid one."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the verdicts on restitution at low and at high speeds."""
    constant = float(data.constant)
    limit = {wall: float(data.critical_speed.sel(wall=wall)) for wall in WALLS}
    lowest = {wall: float(data.lowest_restitution.sel(wall=wall).min()) for wall in WALLS}
    law = data.restitution.sel(law="Jackson-Green")
    at_most = law.where(data.speed <= data.critical_speed, 1.0)
    beyond = law.where(data.speed > data.critical_speed, 0.0).fillna(0.0)
    elastic = bool((at_most == 1).all() and (beyond < 1).all())
    lower = [wall for wall in WALLS if lowest[wall] < constant]
    return (
        Claim(
            "Steel loses nothing in slow impacts, so a constant restitution does not suit it.",
            "section 2, figure 5",
            f"no loss up to V_c = {limit['steel']:.5f} m/s on a steel wall and {limit['rigid']:.5f} m/s on a rigid one",
            "Jackson-Green law with m* = mM/(m + M)",
            "reproduced" if elastic else "not reproducible",
        ),
        Claim(
            "An impulse load brings impacts so fast that their restitution is low, below that of the constant model.",
            "section 5.1, conclusion 2",
            f"the fastest of all impacts after 5 kN have e = {lowest['steel']:.4f} on a steel wall and "
            f"{lowest['rigid']:.4f} on a rigid one, against {constant:.4f} of the constant model",
            "holds for " + (" and ".join(f"the {wall} wall" for wall in lower) + " only" if lower else "no wall"),
            "reproduced" if len(lower) == len(WALLS) else "reproduced qualitatively" if lower else "not reproducible",
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
