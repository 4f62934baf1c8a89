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
    alpha_of_restitution,
    contact_pairs,
    materials,
    restitution_of_alpha,
)
from rattlebox.plots import FAINT, INK, SERIES_COLOURS, SERIES_MARKERS, StyledFigure, figure_style, pen

from .ensemble import Band, band, ensemble, near
from .figure import Claim, Reproduction
from .models import described
from .reference import (
    ALPHA,
    CONSTANT,
    GAP,
    MASS,
    PLASTIC,
    PLASTIC_RIGID,
    RADIUS,
    START,
    STIFFNESS,
    Contact,
    Ending,
    paper_case,
)
from .runs import simulate

_CAVITY, _SIZE = 67.14e-3, 33.17e-3
"""Printed length of the cavity and size of the ball [m]."""
_RADII = {"radius": _SIZE, "diameter": _SIZE / 2}
_MASS_SHARE, _RESTITUTION, _RESONANCE = 0.06, 0.99, 61.3
_STEEL = materials()["steel"]
_ENDINGS: tuple[Ending, Ending] = ("zero_overlap", "zero_force")
_EACH = ("reading", "start", "level")
_MEMBERS = 16

_ROWS = (
    *(f"{name}, 33.17 mm as the {size}" for name in ("m/M", "2 d0") for size in _RADII),
    "e of the printed α",
    "ω = √(K/(M+m))",
    "ω = √(K/M)",
)
"""Readings of printed numbers."""

PAIR = contact_pairs(paper_case(), 0)[0]
"""The ball and the wall of the structure that moves."""
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


_NAMED = dict(
    zip(("overlap", "force", "steel", "rigid"), [list(INTERPRETATIONS)[k] for k in (0, 1, 5, 7)], strict=True)
)


def cases() -> Mapping[str, Case]:
    """Return the case of each interpretation with the ball at the centre of the cavity."""
    return {reading: make(0.0) for reading, make in INTERPRETATIONS.items()}


def data() -> xr.Dataset:
    """Compute the results of each interpretation."""
    radii = np.array(list(_RADII.values()))
    shares = [[_shares(make, start) for start in START.values()] for make in INTERPRETATIONS.values()]
    met = [[_impacts(partial(_sized, radius), start) for start in START.values()] for radius in _RADII.values()]
    weak = [_impacts(lambda start: _recorded(start=start, amplitude=100.0), start) for start in START.values()]
    # The printed size in either way, mass and clearance as printed; then restitution and resonances.
    given = (
        4 / 3 * pi * radii**3 * _STEEL.density / MASS,
        _CAVITY - 2 * radii,
        [restitution_of_alpha(ALPHA, _ENDINGS[0])],
    )
    limits = [
        [JacksonGreen().critical_speed(pair) * sqrt(_REDUCED / mass) for mass in (_REDUCED, _BALL)]
        for pair in _WALLS.values()
    ]
    first = simulate(_recorded()).impacts.isel(impact=0)
    deepest = float(first.peak_overlap)
    stiffness = PAIR.hertz_stiffness
    gamma = ALPHA * sqrt(_REDUCED * stiffness) * deepest**0.25
    forces = [_force(deepest, square_root, unit) for square_root in (True, False) for unit in (1.0, 1e-3)]
    printed = (_MASS_SHARE, 2 * GAP, _RESTITUTION, _RESONANCE)
    resonance = np.sqrt(STIFFNESS / np.array([MASS + _BALL, MASS]))
    ratios = [np.asarray(values) / number for values, number in zip((*given, resonance), printed, strict=True)]
    return xr.Dataset(
        {
            "ratio": described("row", np.concatenate(ratios), "", "interpreted over printed number"),
            "share": described(_EACH, shares, "", "share of the work lost in impacts in 10 s after 5 kN"),
            "mass_share": described("size", given[0], "", "mass ratio m/M"),
            "clearance": described("size", given[1], "m", "total clearance"),
            "impacts": described(
                ("size", "start", "level"), met, "", "number of impacts in 10 s after 5 kN, ensemble of start positions"
            ),
            "weak_impacts": described(
                ("start", "level"), weak, "", "number of impacts in 10 s after 100 N, ensemble of start positions"
            ),
            "restitution": described(
                "ending",
                [restitution_of_alpha(ALPHA, one) for one in _ENDINGS],
                "",
                "restitution at the printed coefficient",
            ),
            "needed": described(
                "ending", [alpha_of_restitution(_RESTITUTION, one) for one in _ENDINGS], "", "coefficient for e = 0.99"
            ),
            "gamma": described((), gamma, "N s/m", "γ of equation (9) where the first impact is deepest"),
            "resonance": described("inertia", resonance, "rad/s", "angular frequency"),
            "critical_speed": described(("wall", "moving"), limits, "m/s", "elastic limit V_c"),
            "first_speed": described((), first.approach_speed, "m/s", "speed of the first impact after 5 kN, case 1"),
            "force": described(
                ("formula", "unit"), np.reshape(forces, (2, 2)), "N", "elastic force where the first impact is deepest"
            ),
            "stiffness": described(
                "formula", [stiffness, stiffness * sqrt(RADIUS)], "N m^-1.5", "number of A in SI units"
            ),
            "printed": described("quantity", printed, "", "printed number, in SI units"),
        },
        {
            "row": described("row", list(_ROWS), "", "interpretation of a printed number"),
            "reading": described("reading", list(INTERPRETATIONS), "", "interpretation of the paper"),
            "start": described("start", list(START), "", "the paper's case"),
            "level": described("level", [0.1, 0.5, 0.9], "", "quantile of an ensemble within a micrometre"),
            "size": described("size", list(_RADII), "", "what the printed 33.17 mm is"),
            "ending": described("ending", list(_ENDINGS), "", "where the contact ends"),
            "inertia": described("inertia", ["M + m", "M"], "", "mass that vibrates"),
            "wall": described("wall", list(_WALLS), "", "elasticity of the wall in V_c"),
            "moving": described("moving", ["m* = mM/(m+M)", "m* = m"], "", "reduced mass in V_c"),
            "formula": described("formula", ["(4/3) E* sqrt(R*)", "(4/3) E* R*"], "", "A of equation (5)"),
            "unit": described("unit", ["m", "mm"], "", "unit of length of the computation"),
            "quantity": described("quantity", ["m/M", "2 d0", "e", "ω"], "", "what the paper prints"),
        },
    )


def _shares(make: Callable[[float], Case], start: float) -> Band:
    runs = ensemble(lambda offset: make(near(start, offset)), _MEMBERS)
    return band([run.ledger.shares["normal"] for run in runs])


def _impacts(make: Callable[[float], Case], start: float) -> Band:
    runs = ensemble(lambda offset: make(near(start, offset)), _MEMBERS)
    return band([len(run.arrays.impacts) for run in runs])


def _force(overlap: float, square_root: bool, unit: float) -> float:
    """Return A d^1.5 [N] for numbers in newtons and a unit of length [m]."""
    modulus, radius, depth = PAIR.modulus * unit**2, PAIR.radius / unit, overlap / unit
    return float(4 / 3 * modulus * (sqrt(radius) if square_root else radius) * depth**1.5)


def draw(data: xr.Dataset) -> Figure:
    """Draw the loss for each interpretation, and the printed numbers with their interpreted values."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.82)
        upper, lower = np.asarray(figure.subfigures(2, 1, height_ratios=(1.55, 1)))
        left, right = lower.subplots(1, 2)
        _draw_shares(upper.subplots(), data)
        _draw_printed(left, data)
        _draw_limits(right, data)
    return figure


def _rows(axes: Axes, names: Sequence[str]) -> None:
    """Label the rows from the top, with a faint line each."""
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.grid(axis="y", color=FAINT, lw=pen(0.4))
    axes.set_axisbelow(True)
    axes.tick_params(axis="y", length=0)


def _values(axes: Axes, values: Sequence[float], text: str) -> None:
    """Mark a value in each row and write its number."""
    axes.plot(values, range(len(values)), "o", color=SERIES_COLOURS[0], ms=4)
    for row, value in enumerate(values):
        axes.annotate(
            format(value, text),
            (value, row),
            (5, 0),
            textcoords="offset points",
            va="center",
            fontsize="small",
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.4},
        )


def _draw_shares(axes: Axes, data: xr.Dataset) -> None:
    """Draw median and band of every interpretation."""
    for k, start in enumerate(data.start.values):
        low, median, high = (100 * data.share.sel(start=start, level=level) for level in data.level.values)
        axes.errorbar(
            median,
            np.arange(data.sizes["reading"]) + 0.22 * (k - 1),
            xerr=(median - low, high - median),
            fmt=SERIES_MARKERS[k],
            color=SERIES_COLOURS[k],
            ms=3.5,
            elinewidth=pen(0.9),
            label=f"case {start}",
        )
    _rows(axes, [str(reading) for reading in data.reading.values])
    axes.set_xlim(-0.2, 105 * float(data.share.max()))
    axes.set_xlabel("Share of the work lost in impacts (%), median and 10 to 90 % of starts within 1 µm")
    axes.legend(loc="lower right", title="10 s after 5 kN", frameon=True, facecolor="white", edgecolor="none")


def _draw_printed(axes: Axes, data: xr.Dataset) -> None:
    """Draw the ratio of interpreted to printed values."""
    axes.axvline(1, color=INK, lw=pen(0.6), zorder=0)
    _values(axes, data.ratio.values.tolist(), ".4g")
    _rows(axes, data.row.values.tolist())
    axes.set(xscale="log", xlim=(0.05, 500), xlabel="Reading over printed number")


def _draw_limits(axes: Axes, data: xr.Dataset) -> None:
    """Draw the elastic limit and a typical speed."""
    speed = float(data.first_speed)
    axes.axvline(speed, color=SERIES_COLOURS[1], linestyle=(0, (4, 1.5)), label="first impact in case 1, 5 kN")
    _values(axes, data.critical_speed.values.ravel().tolist(), ".4f")
    _rows(axes, [f"{wall} wall, {moving}" for wall in data.wall.values for moving in data.moving.values])
    axes.set(xlim=(0, 0.23), xlabel="Elastic limit $V_c$ (m/s)")
    axes.legend(loc="lower right", bbox_to_anchor=(1, 1))


def _range(counts: xr.DataArray) -> str:
    low, _, high = counts.values
    return f"{low:.0f} to {high:.0f}" if high > low else f"{low:.0f}"


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    share = 100 * data.share.sel(level=0.5)
    centred = {name: float(share.sel(reading=reading, start=1)) for name, reading in _NAMED.items()}
    steel, rigid = (data.critical_speed.sel(wall=wall) for wall in ("steel", "rigid"))
    ratios = {size: float(data.mass_share.sel(size=size)) for size in _RADII}
    weak = ", ".join(_range(data.weak_impacts.sel(start=start)) for start in data.start.values)
    return (
        "Top: the share of the pulse's work that impacts take, for each interpretation of the paper. Where a contact ends "
        f"has little effect ({centred['overlap']:.1f} and {centred['force']:.1f} % in case 1); whether the wall counts as "
        f"elastic or rigid in the elastic limit matters most ({centred['steel']:.2f} or {centred['rigid']:.1f} %). "
        f"With 33.17 mm as the diameter the ball of case 1 meets a wall "
        f"{_range(data.impacts.sel(size='diameter', start=1))} times in 10 s; after 100 N the balls of cases 1, 2 and 3, "
        f"as read here, meet one {weak} times (10 to 90 % of starts within 1 µm). "
        f"Bottom left: as a radius 33.17 mm gives a mass ratio of "
        f"{100 * ratios['radius']:.3f} %, as a diameter {100 * ratios['diameter']:.3f} %. Bottom right: the rigid wall "
        f"lowers the elastic limit {float(steel[0] / rigid[0]):.0f} times; the first impact after 5 kN comes at "
        f"{float(data.first_speed):.4f} m/s, {100 * float(1 - data.first_speed / steel[1]):.0f} and "
        f"{100 * float(1 - data.first_speed / steel[0]):.0f} % below the limits of the steel wall with either mass."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the verdicts on ambiguous statements."""
    mass, clearance = data.mass_share, data.clearance
    printed = data.printed
    fits = {
        size: abs(float(mass.sel(size=size) / printed.sel(quantity="m/M")) - 1) < 1e-3
        and abs(float(clearance.sel(size=size) / printed.sel(quantity="2 d0")) - 1) < 1e-3
        for size in _RADII
    }
    numbers = {
        size: f"{100 * float(mass.sel(size=size)):.3f} % and {1e3 * float(clearance.sel(size=size)):.2f} mm"
        for size in _RADII
    }
    force = data.force
    rooted, bare = (
        float(force.sel(formula=formula, unit="mm") / force.sel(formula=formula, unit="m"))
        for formula in force.formula.values
    )
    gamma = float(data.gamma)
    return (
        Claim(
            "The ball has 6 % of the structure's mass.",
            "section 4.3",
            f"mass ratio and clearance are {numbers['radius']}",
            "33.17 mm is the radius",
            "reproduced" if fits["radius"] else "not reproducible",
        ),
        Claim(
            "33.17 mm is the diameter of the ball.",
            "table 1",
            f"mass ratio and clearance are {numbers['diameter']} as a diameter, {numbers['radius']} as a radius; printed "
            "are 6 % and 0.80 mm",
            "radius",
            "misprint"
            if fits["radius"] and not fits["diameter"]
            else "reproduced"
            if fits["diameter"]
            else "not reproducible",
        ),
        Claim(
            "The contact stiffness is A = (4/3) E* R*.",
            "equation (5)",
            f"in mm instead of m the force comes out {bare:.1f} times as large; with sqrt(R*) it is the same, and "
            f"A = {float(data.stiffness[0]):.6e} N m^-1.5",
            "sqrt(R*)",
            "misprint" if abs(rooted - 1) < 1e-9 < abs(bare - 1) else "reproduced",
        ),
        Claim(
            "The damping of the constant model is γ = 0.006313.",
            "section 5.1",
            f"γ of equation (9) reaches {gamma:.0f} N s/m in the first impact; as α the number gives "
            f"e = {float(data.restitution[0]):.6f}",
            "α",
            "misprint" if gamma > 1 and round(float(data.restitution[0]), 2) == _RESTITUTION else "reproduced",
        ),
    )


FIGURE = Reproduction(
    number="R1",
    title="Interpretations of the paper",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
