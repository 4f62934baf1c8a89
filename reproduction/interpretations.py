"""Figure R1: results of the possible interpretations of the printed text."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from math import pi, sqrt
from typing import Any, Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from rattlebox import Case, JacksonGreen, Run, Sphere, Tsuji, contact_pairs, materials, restitution_of_alpha
from rattlebox.plots import FAINT, INK, SERIES_MARKERS, StyledFigure, pen

from .figure import Reproduction
from .files import simulate
from .models import COLOURS, CONSTANT_E, RIGID, STEEL, STIFF, two
from .system import (
    ALPHA,
    CONSTANT,
    GAP,
    MASS,
    PLASTIC,
    PLASTIC_RIGID,
    RADIUS,
    START,
    Contact,
    band,
    ensemble,
    near,
    paper_case,
)

_CAVITY, _SIZE = 67.14e-3, 33.17e-3  # printed length of the cavity and size of the ball [m]
_RADII = {"radius": _SIZE, "diameter": _SIZE / 2}
_STEEL = materials()["steel"]
_MEMBERS = 16

PAIR = contact_pairs(paper_case(), 0)[0]  # the ball and the wall of the structure that moves
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
    limits = [
        [JacksonGreen().critical_speed(pair) * sqrt(_REDUCED / mass) for mass in (_REDUCED, _BALL)]
        for pair in _WALLS.values()
    ]
    first = simulate(_recorded()).impacts.isel(impact=0)
    deepest = float(first.peak_overlap)
    sizes = [partial(_sized, radius) for radius in radii]
    return xr.Dataset(
        {
            "share": (("reading", "start", "level"), _bands(INTERPRETATIONS.values(), _share)),
            "mass_share": ("size", 4 / 3 * pi * radii**3 * _STEEL.density / MASS),
            "clearance": ("size", _CAVITY - 2 * radii),
            "impacts": (("size", "start", "level"), _bands(sizes, lambda run: len(run.arrays.impacts))),
            "gamma": ((), ALPHA * sqrt(_REDUCED * PAIR.hertz_stiffness) * deepest**0.25),
            "critical_speed": (("wall", "moving"), limits),
            "first_speed": ((), float(first.approach_speed)),
            "force": (
                ("formula", "unit"),
                [[_force(deepest, root, unit) for unit in (1.0, 1e-3)] for root in (True, False)],
            ),
            "stiffness": ((), PAIR.hertz_stiffness),
        },
        {
            "reading": list(INTERPRETATIONS),
            "start": list(START),
            "level": [0.1, 0.5, 0.9],
            "size": list(_RADII),
            "wall": list(_WALLS),
            "moving": ["m* = mM/(m+M)", "m* = m"],
            "formula": ["(4/3) E* sqrt(R*)", "(4/3) E* R*"],
            "unit": ["m", "mm"],
        },
    )


def _share(run: Run) -> float:
    return max(run.ledger.shares["normal"], 0.0)


def _bands(makers: Any, of: Callable[[Run], float]) -> list[list[Any]]:
    """Return the bands of a result, (maker, start, quantile)."""

    def one(make: Callable[[float], Case], start: float) -> Any:
        return band([of(run) for run in ensemble(lambda offset: make(near(start, offset)), _MEMBERS)])

    return [[one(make, start) for start in START.values()] for make in makers]


def _force(overlap: float, square_root: bool, unit: float) -> float:
    """Return A d^1.5 [N] for numbers in newtons and a unit of length [m]."""
    modulus, radius, depth = PAIR.modulus * unit**2, PAIR.radius / unit, overlap / unit
    return float(4 / 3 * modulus * (sqrt(radius) if square_root else radius) * depth**1.5)


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw the loss for each interpretation, and the elastic limits."""
    left, right = figure.subplots(1, 2, width_ratios=(1.5, 1))
    names = [str(reading) for reading in data.reading.values]
    for k, start in enumerate(data.start.values):
        for row, (name, (least, middle, most)) in enumerate(
            zip(names, 100 * data.share.sel(start=start).values, strict=True)
        ):
            at = row + 0.22 * (k - 1)
            left.plot([middle], [at], SERIES_MARKERS[k], color=_colour(name), ms=3.5)
            left.plot([least, most], [at, at], color=_colour(name), lw=pen(0.9))
        left.plot([], [], SERIES_MARKERS[k], color=INK, ms=3.5, label=f"case {start}")
    _rows(left, names)
    left.set(xlim=(-0.2, 105 * float(data.share.max())), xlabel="Share of the work (%)")
    left.set_title("Lost in impacts, 10 s after 5 kN")
    left.legend(loc="lower right", frameon=True, facecolor="white", edgecolor="none")
    right.axvline(float(data.first_speed), color=INK, ls=(0, (4, 1.5)), label="first impact in case 1, 5 kN")
    limits = data.critical_speed.values.ravel()
    for row, (value, model) in enumerate(zip(limits, (STEEL, STEEL, RIGID, RIGID), strict=True)):
        right.plot([value], [row], "o", color=COLOURS[model], ms=4)
        right.annotate(f"{value:.4f}", (value, row), (5, 5), textcoords="offset points", fontsize="small")
    _rows(right, [f"{wall} wall,\n{moving}" for wall in data.wall.values for moving in data.moving.values])
    right.set(xlim=(0, 0.23), xlabel="Speed (m/s)", title="Elastic limit $V_c$")
    right.legend(loc="lower right")


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


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return speeds, losses, and the printed and corrected numbers."""
    steel, rigid = data.critical_speed[:, 0].values
    share = 100 * data.share.sel(level=0.5, start=1)
    mass, ratios = 100 * data.mass_share, data.force.sel(unit="mm") / data.force.sel(unit="m")
    radius, diameter = mass.sel(size="radius"), mass.sel(size="diameter")
    as_gamma, as_alpha = (restitution_of_alpha(alpha) for alpha in (ALPHA**2 / float(data.gamma), ALPHA))
    stiffness, damping = (ratios[1], ratios[0]), (as_gamma, as_alpha)
    return {
        "steel": steel,
        "times": data.first_speed / rigid,
        "shares": [two(share[0]), two(share[1])],
        "members": _MEMBERS,
        "clearance": 1e3 * data.clearance,
        "mass": radius,
        "diameter": (diameter, radius),
        "stiffness": stiffness,
        "damping": damping,
    }


FIGURE = Reproduction("interpretations", data, draw, 0.5, cases, values)
