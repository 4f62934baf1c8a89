"""Figure R1: results of the possible interpretations of the printed text."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from math import pi, sqrt
from typing import Any, Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rattlebox import (
    Case,
    JacksonGreen,
    Sphere,
    Tsuji,
    contact_pairs,
    materials,
    restitution_of_alpha,
)
from rattlebox.plots import FAINT, INK, SERIES_MARKERS, StyledFigure, figure_style, pen

from .ensemble import Band, band, ensemble, near
from .figure import Reproduction, letters
from .judge import CORRECTED, PRINTED, SYSTEM, Claim, exact
from .models import COLOURS, CONSTANT_E, RIGID, STEEL, STIFF, described, two
from .reference import (
    ALPHA,
    CONSTANT,
    GAP,
    MASS,
    PLASTIC,
    PLASTIC_RIGID,
    RADIUS,
    START,
    Contact,
    paper_case,
)
from .runs import simulate

_CAVITY, _SIZE = 67.14e-3, 33.17e-3  # Printed length of the cavity and size of the ball [m]
_RADII = {"radius": _SIZE, "diameter": _SIZE / 2}
_MASS_SHARE = 0.06
_STEEL = materials()["steel"]
_EACH = ("reading", "start", "level")
_MEMBERS = 16

PAIR = contact_pairs(paper_case(), 0)[0]  # The ball and the wall of the structure that moves
_WALLS = {"steel": PAIR, "rigid": PAIR.against("rigid")}
_REDUCED, _BALL = float(PAIR.mass), float(PAIR.above.mass)


def _as_if_fixed(law: JacksonGreen) -> Tsuji:
    """Return a law with the yield speed for m* = m; V_c scales with the yield stress to 5/2 and the mass to -1/2."""
    assert _STEEL.yield_stress is not None
    strength = _STEEL.yield_stress * (_REDUCED / _BALL) ** 0.2
    return Tsuji(restitution=law.model_copy(update={"yield_stress": strength}), ending="zero_overlap")


def _recorded(contact: Contact = CONSTANT, **options: Any) -> Case:
    """Return the paper's case with output at its end only."""
    return paper_case(contact, times=[10.0], **options)


def _with(case: Case, **parts: Any) -> Case:
    """Replace fields of the damper."""
    return case.model_copy(update={"dampers": (case.dampers[0].model_copy(update=parts),)})


def _sized(radius: float, start: float) -> Case:
    """Use another ball radius in the printed cavity; the start is within a micrometre of START."""
    gap = _CAVITY / 2 - radius
    case = _recorded(start=round(start) + (start - round(start)) * GAP / gap)
    return _with(case, balls=(Sphere(radius=radius, material="steel"),), gap=gap)


def _soft(start: float) -> Case:
    """Use A = (4/3) E* R* as printed, in SI units."""
    steel = _STEEL.model_copy(update={"young": _STEEL.young * sqrt(RADIUS)})
    return _with(_recorded(start=start), balls=(Sphere(radius=RADIUS, material=steel, mass=_BALL),))


def _contact(contact: Contact, wall: Literal["rigid"] | None = None) -> Callable[[float], Case]:
    return lambda start: _recorded(contact, start=start, wall=wall)


INTERPRETATIONS: Mapping[str, Callable[[float], Case]] = {
    "constant α, contact ends at zero overlap": _contact(CONSTANT),
    "constant α, contact ends at zero force": _contact(Tsuji(alpha=ALPHA, ending="zero_force")),
    "constant e = 0.99": _contact(Tsuji(restitution=0.99, ending="zero_overlap")),
    "constant α, A = (4/3) E* R* as printed": _soft,
    "constant α, 33.17 mm as the diameter": lambda start: _sized(_RADII["diameter"], start),
    "elasto-plastic, steel wall": _contact(PLASTIC),
    "elasto-plastic, steel wall, m* = m": _contact(_as_if_fixed(JacksonGreen())),
    "elasto-plastic, rigid wall": _contact(PLASTIC_RIGID),
    "elasto-plastic, rigid wall, m* = m": _contact(_as_if_fixed(JacksonGreen(wall="rigid"))),
    "elasto-plastic, wall rigid in A too": _contact(PLASTIC_RIGID, "rigid"),
}
"""Function of the reduced start position that returns the paper's case, by interpretation."""


def cases() -> Mapping[str, Case]:
    """Return the case of each interpretation with the ball at the centre of the cavity."""
    return {reading: make(0.0) for reading, make in INTERPRETATIONS.items()}


def data() -> xr.Dataset:
    """Compute the results of each interpretation."""
    radii = np.array(list(_RADII.values()))
    shares = [[_shares(make, start) for start in START.values()] for make in INTERPRETATIONS.values()]
    met = [[_impacts(partial(_sized, radius), start) for start in START.values()] for radius in _RADII.values()]
    limits = [
        [JacksonGreen().critical_speed(pair) * sqrt(_REDUCED / mass) for mass in (_REDUCED, _BALL)]
        for pair in _WALLS.values()
    ]
    first = simulate(_recorded()).impacts.isel(impact=0)
    deepest = float(first.peak_overlap)
    gamma = ALPHA * sqrt(_REDUCED * PAIR.hertz_stiffness) * deepest**0.25
    forces = [[_force(deepest, root, unit) for unit in (1.0, 1e-3)] for root in (True, False)]
    return xr.Dataset(
        {
            "share": described(_EACH, shares, "", "share of the work lost in impacts in 10 s after 5 kN"),
            "mass_share": described("size", 4 / 3 * pi * radii**3 * _STEEL.density / MASS, "", "mass ratio m/M"),
            "clearance": described("size", _CAVITY - 2 * radii, "m", "total clearance"),
            "impacts": described(("size", "start", "level"), met, "", "number of impacts in 10 s after 5 kN, ensemble"),
            "gamma": described((), gamma, "N s/m", "γ of equation (9) where the first impact is deepest"),
            "critical_speed": described(("wall", "moving"), limits, "m/s", "elastic limit V_c"),
            "first_speed": described((), first.approach_speed, "m/s", "speed of the first impact after 5 kN, case 1"),
            "force": described(("formula", "unit"), forces, "N", "elastic force where the first impact is deepest"),
            "stiffness": described((), PAIR.hertz_stiffness, "N m^-1.5", "A of a ball on a steel wall"),
        },
        {
            "reading": described("reading", list(INTERPRETATIONS), "", "interpretation of the paper"),
            "start": described("start", list(START), "", "the paper's case"),
            "level": described("level", [0.1, 0.5, 0.9], "", "quantile of an ensemble within a micrometre"),
            "size": described("size", list(_RADII), "", "what the printed 33.17 mm is"),
            "wall": described("wall", list(_WALLS), "", "elasticity of the wall in V_c"),
            "moving": described("moving", ["m* = mM/(m+M)", "m* = m"], "", "reduced mass in V_c"),
            "formula": described("formula", ["(4/3) E* sqrt(R*)", "(4/3) E* R*"], "", "A of equation (5)"),
            "unit": described("unit", ["m", "mm"], "", "unit of length of the computation"),
        },
    )


def _shares(make: Callable[[float], Case], start: float) -> Band:
    runs = ensemble(lambda offset: make(near(start, offset)), _MEMBERS)
    return band([max(run.ledger.shares["normal"], 0.0) for run in runs])


def _impacts(make: Callable[[float], Case], start: float) -> Band:
    runs = ensemble(lambda offset: make(near(start, offset)), _MEMBERS)
    return band([len(run.arrays.impacts) for run in runs])


def _force(overlap: float, square_root: bool, unit: float) -> float:
    """Return A d^1.5 [N] for numbers in newtons and a unit of length [m]."""
    modulus, radius, depth = PAIR.modulus * unit**2, PAIR.radius / unit, overlap / unit
    return float(4 / 3 * modulus * (sqrt(radius) if square_root else radius) * depth**1.5)


def draw(data: xr.Dataset) -> Figure:
    """Draw the loss for each interpretation, and the elastic limits."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.5)
        left, right = figure.subplots(1, 2, width_ratios=(1.5, 1))
        names = [str(reading) for reading in data.reading.values]
        for k, start in enumerate(data.start.values):
            low, median, high = (100 * data.share.sel(start=start, level=level).values for level in data.level.values)
            for row, (name, least, middle, most) in enumerate(zip(names, low, median, high, strict=True)):
                at = row + 0.22 * (k - 1)
                left.plot([middle], [at], SERIES_MARKERS[k], color=_colour(name), ms=3.5)
                left.plot([least, most], [at, at], color=_colour(name), lw=pen(0.9))
            left.plot([], [], SERIES_MARKERS[k], color=INK, ms=3.5, label=f"case {start}")
        _rows(left, names)
        left.set(
            xlim=(-0.2, 105 * float(data.share.max())),
            xlabel="Share of the work (%)",
            title="Lost in impacts, 10 s after 5 kN",
        )
        left.legend(loc="lower right", frameon=True, facecolor="white", edgecolor="none")
        speed = float(data.first_speed)
        right.axvline(speed, color=INK, ls=(0, (4, 1.5)), label="first impact in case 1, 5 kN")
        limits = data.critical_speed.values.ravel()
        for row, (value, model) in enumerate(zip(limits, (STEEL, STEEL, RIGID, RIGID), strict=True)):
            right.plot([value], [row], "o", color=COLOURS[model], ms=4)
            right.annotate(f"{value:.4f}", (value, row), (5, 5), textcoords="offset points", fontsize="small")
        _rows(right, [f"{wall} wall,\n{moving}" for wall in data.wall.values for moving in data.moving.values])
        right.set(xlim=(0, 0.23), xlabel="Speed (m/s)", title="Elastic limit $V_c$")
        right.legend(loc="lower right")
        letters(figure)
    return figure


def _colour(name: str) -> str:
    """Return the colour of the model of an interpretation."""
    if name.startswith("constant"):
        return COLOURS[CONSTANT_E]
    return COLOURS[STIFF if "A too" in name else RIGID if "rigid" in name else STEEL]


def _rows(axes: Axes, names: Sequence[str]) -> None:
    """Label the rows from the top, with a faint line each."""
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.grid(axis="y", color=FAINT, lw=pen(0.4))
    axes.set_axisbelow(True)
    axes.tick_params(axis="y", length=0)


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    steel, rigid = (float(data.critical_speed.sel(wall=wall)[0]) for wall in ("steel", "rigid"))
    speed = float(data.first_speed)
    share = 100 * data.share.sel(level=0.5, start=1)
    return (
        f"The elasticity of the wall in V_c matters most: the first impact, at {speed:.4f} m/s, is below the limit of "
        "a steel wall "
        f"({steel:.4f} m/s) and {speed / rigid:.1f} times that of a rigid one. Where a contact ends matters little "
        f"({two(share[0])} and {two(share[1])} %). Median and 10 to 90 % of {_MEMBERS} starts within 1 µm."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the claims on printed numbers that contradict each other."""
    mass, clearance = 100 * data.mass_share, 1e3 * data.clearance
    ratios = data.force.sel(unit="mm") / data.force.sel(unit="m")
    return (
        Claim(
            "The ball has 6 % of the structure's mass.",
            "section 4.3",
            "mass ratio, with 33.17 mm as the radius (%)",
            {SYSTEM: exact(mass.sel(size="radius"))},
            accept=(5.5, 6.5),
            printed="6 %",
            scope="system",
            note=f"the clearance is then {float(clearance.sel(size='radius')):.2f} mm, twice the printed d_0 = 0.4 mm",
        ),
        Claim(
            "33.17 mm is the diameter of the ball.",
            "table 1",
            "mass ratio with 33.17 mm as the diameter, and as the radius (%)",
            {PRINTED: exact(mass.sel(size="diameter")), CORRECTED: exact(mass.sel(size="radius"))},
            accept=(5.5, 6.5),
            printed="6 %",
            kind="misprint",
            note=f"as a diameter the clearance would be {float(clearance.sel(size='diameter')):.1f} mm, and the "
            "centred ball would never "
            "be touched",
        ),
        Claim(
            "The contact stiffness is A = (4/3) E* R*.",
            "equation (5)",
            "force computed in mm over force computed in m, as printed and with sqrt(R*)",
            {PRINTED: exact(ratios[1]), CORRECTED: exact(ratios[0])},
            accept=(1 - 1e-9, 1 + 1e-9),
            kind="misprint",
            note=f"A = {float(data.stiffness):.6e} N m^-1.5",
        ),
        Claim(
            "The damping of the constant model is γ = 0.006313.",
            "section 5.1",
            "restitution with the number as γ (N s/m) where the first impact is deepest, and with the number as α",
            {
                PRINTED: exact(restitution_of_alpha(ALPHA**2 / float(data.gamma))),
                CORRECTED: exact(restitution_of_alpha(ALPHA)),
            },
            accept=(0.985, 0.995),
            printed="γ = 0.006313, e ~ 0.99",
            kind="misprint",
            note=f"γ depends on the overlap and reaches {float(data.gamma):.0f} N s/m",
        ),
    )


FIGURE = Reproduction(
    number="R1", title="Interpretations of the paper", data=data, draw=draw, caption=caption, cases=cases, claims=claims
)
