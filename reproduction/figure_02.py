"""Figure 2: Tsuji's damping coefficient for a restitution, exact and fitted."""

from __future__ import annotations

from collections.abc import Mapping
from math import sqrt
from typing import Any

import numpy as np
import xarray as xr
from numpy.polynomial import Polynomial

from rattlebox import Case, Fixed, ImpactDamper, Sphere, Tsuji, alpha_of_restitution, restitution_of_alpha
from rattlebox.plots import FAINT, INK, StyledFigure, pen

from .figure import Reproduction
from .files import simulate_many
from .models import COLOURS, CONSTANT_E
from .system import ALPHA, GAP, RADIUS

_DEGREE = 9
_FIT_FROM = (0.1, 0.01, 0.001)  # least restitution of the fits; the paper does not print it
_STYLES = ("-", (0, (5, 1.5)), (0, (1, 1.2)))
_TRIED = (1e-4, 1e-3, ALPHA, 0.03, 0.1 * sqrt(5), 0.3 * sqrt(5), 0.5 * sqrt(5), 0.9 * sqrt(5))  # of simulated impacts
_SHARED = (1.2728, -4.2783, 11.087, -22.348, 27.467, -18.022, 4.8218)
"""Polynomial in e of discrete-element programs (LAMMPS, documentation of pair_style granular, tsuji)."""


def _impact(alpha: float) -> Case:
    """Return a case of a ball that hits a fixed wall once."""
    ball, contact = Sphere(radius=RADIUS, material="steel"), Tsuji(alpha=alpha, ending="zero_overlap")
    damper = ImpactDamper(balls=(ball,), gap=GAP, velocity=(0.1,), contact=contact)
    return Case(structure=Fixed(), dampers=(damper,), duration=8e-3)


def cases() -> Mapping[str, Case]:
    """Return the impact with the paper's coefficient."""
    return {"impact": _impact(ALPHA)}


def data() -> xr.Dataset:
    """Compute the exact relation, its fits, and simulated impacts."""
    missed = np.unique(np.concatenate([np.geomspace(1e-4, 0.999, 300), (0.01, 0.1)]))
    e = 1 - missed
    exact_alpha = alpha_of_restitution(e, "zero_overlap")
    fitted = np.array([_fit(least)(np.log10(e)) for least in _FIT_FROM])
    fitted[e < np.array(_FIT_FROM)[:, None]] = np.nan
    shared = Polynomial(_SHARED)(e)
    impacts = [run.arrays.impacts for run in simulate_many([_impact(alpha) for alpha in _TRIED])]
    first = [float(log.separation_speed[0] / log.approach_speed[0]) for log in impacts]
    expected = [restitution_of_alpha(a, "zero_overlap") for a in _TRIED]
    return xr.Dataset(
        {
            "alpha": ("missed", exact_alpha),
            "deviation": (("fit_from", "missed"), np.abs(fitted / exact_alpha - 1)),
            "shared": ("missed", shared),
            "shared_deviation": ("missed", np.abs(shared / exact_alpha - 1)),
            "simulated_missed": ("tried", 1 - np.array(first)),
            "expected_missed": ("tried", 1 - np.array(expected)),
            "printed_alpha": ((), ALPHA),
            "printed_missed": ((), 1 - restitution_of_alpha(ALPHA, "zero_overlap")),
            "needed_alpha": ((), alpha_of_restitution(0.99, "zero_overlap")),
        },
        {"missed": missed, "fit_from": list(_FIT_FROM), "tried": list(_TRIED)},
    )


def _fit(least: float) -> Polynomial:
    """Fit by least squares on even steps of log10 e."""
    x = np.linspace(np.log10(least), 0.0, 2001)
    return Polynomial(Polynomial.fit(x, alpha_of_restitution(10**x, "zero_overlap"), _DEGREE).convert().coef)


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw the coefficient and the errors of the polynomials."""
    left, right = figure.subplots(1, 2)
    look = {"color": COLOURS[CONSTANT_E]}
    left.plot(data.missed, data.alpha, label="exact", **look)
    left.plot(data.simulated_missed, data.tried, "o", mfc="white", ms=3.5, label="simulated impacts", **look)
    left.plot(data.missed, data.shared, color=FAINT, lw=pen(1.2), zorder=0, label="degree 6 in e of other programs")
    left.axhline(float(data.printed_alpha), color=INK, lw=pen(0.4), zorder=0)
    left.axvline(float(data.printed_missed), color=INK, lw=pen(0.4), zorder=0)
    text = f"printed: α = {float(data.printed_alpha):g},\ne = {1 - float(data.printed_missed):.5f}"
    left.text(1.25 * float(data.printed_missed), 7e-5, text, va="bottom")
    left.set(xscale="log", yscale="log", ylim=(3e-5, 4), title="Damping coefficient", ylabel="α")
    for least, style in zip(data.fit_from.values, _STYLES, strict=True):
        one = data.deviation.sel(fit_from=least)
        right.plot(data.missed, one, ls=style, label=f"degree 9, e ≥ {least:g}", **look)
    right.plot(data.missed, data.shared_deviation, color=FAINT, lw=pen(1.2), label="degree 6 in e")
    right.set(xscale="log", yscale="log", ylim=(1e-9, 10), title="Relative error of the polynomials")
    right.set_ylabel("Error of α")
    for axes, place in ((left, "upper left"), (right, "lower left")):
        axes.set(xlabel="1 - e", xlim=(1e-4, 1))
        axes.legend(loc=place)


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return the errors of simulated impacts and of the fits, and the restitution of the printed coefficient."""
    off = 100 * data.deviation.sel(missed=0.01)
    return {
        "error": np.abs(data.simulated_missed / data.expected_missed - 1).max(),
        "off": 100 * data.deviation.sel(missed=1e-3, method="nearest"),
        "ranges": ", ".join(f"{x:g}" for x in data.fit_from.values),
        "errors": ", ".join(f"{x:.1g}" for x in off.values),
        "coefficient": 1 - data.printed_missed,
    }


FIGURE = Reproduction("figure_02", data, draw, 0.42, cases, values)
