"""Figure 2: Tsuji's damping coefficient for a restitution, exact and fitted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import sqrt

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rattlebox import Case, Fixed, ImpactDamper, Sphere, Tsuji, alpha_of_restitution, restitution_of_alpha
from rattlebox.plots import FAINT, INK, StyledFigure, figure_style, pen

from .figure import Reproduction, letters
from .judge import SYSTEM, Claim, exact
from .models import COLOURS, CONSTANT_E, described
from .reference import ALPHA, GAP, RADIUS
from .runs import simulate_many

_DEGREE = 9
_FIT_FROM = (0.1, 0.01, 0.001)  # Least restitution of the fits; the paper does not print it
_STYLES = ("-", (0, (5, 1.5)), (0, (1, 1.2)))
_TRIED = (1e-4, 1e-3, ALPHA, 0.03, 0.1 * sqrt(5), 0.3 * sqrt(5), 0.5 * sqrt(5), 0.9 * sqrt(5))
"""Coefficients of the simulated impacts."""
_SHARED = (1.2728, -4.2783, 11.087, -22.348, 27.467, -18.022, 4.8218)
"""Polynomial in e of discrete-element programs (LAMMPS, documentation of pair_style granular, tsuji)."""


def _impact(alpha: float) -> Case:
    """Return a case of a ball that hits a fixed wall once."""
    damper = ImpactDamper(
        balls=(Sphere(radius=RADIUS, material="steel"),),
        gap=GAP,
        velocity=(0.1,),
        contact=Tsuji(alpha=alpha, ending="zero_overlap"),
    )
    return Case(structure=Fixed(), dampers=(damper,), duration=8e-3)


def cases() -> Mapping[str, Case]:
    """Return the impact with the paper's coefficient."""
    return {"impact": _impact(ALPHA)}


def data() -> xr.Dataset:
    """Compute the exact relation, its fits, and simulated impacts."""
    missed = np.unique(np.concatenate([np.geomspace(1e-4, 0.999, 300), (0.01, 0.1)]))
    e = 1 - missed
    exact_alpha = alpha_of_restitution(e, "zero_overlap")
    fitted = np.array([np.polynomial.Polynomial(_fit(least))(np.log10(e)) for least in _FIT_FROM])
    fitted[e < np.array(_FIT_FROM)[:, None]] = np.nan
    shared = np.polynomial.Polynomial(_SHARED)(e)
    runs = simulate_many([_impact(alpha) for alpha in _TRIED])
    first = [float(run.arrays.impacts.separation_speed[0] / run.arrays.impacts.approach_speed[0]) for run in runs]
    return xr.Dataset(
        {
            "alpha": described("missed", exact_alpha, "", "damping coefficient α, exact"),
            "deviation": described(("fit_from", "missed"), np.abs(fitted / exact_alpha - 1), "", "relative error of "
            "the fit"),
            "shared": described("missed", shared, "", "damping coefficient α, polynomial of degree 6 in e of other "
            "programs"),
            "shared_deviation": described("missed", np.abs(shared / exact_alpha - 1), "", "relative error of that "
            "polynomial"),
            "simulated_missed": described("tried", 1 - np.array(first), "", "1 - e of a simulated impact"),
            "expected_missed": described(
                "tried", 1 - np.array([restitution_of_alpha(a, "zero_overlap") for a in _TRIED]), "", "1 - e that α gives"
            ),
            "printed_alpha": described((), ALPHA, "", "printed coefficient"),
            "printed_missed": described((), 1 - restitution_of_alpha(ALPHA, "zero_overlap"), "", "1 - e of the printed α"),
            "needed_alpha": described((), alpha_of_restitution(0.99, "zero_overlap"), "", "α for e = 0.99"),
        },
        {
            "missed": described("missed", missed, "", "1 - e"),
            "fit_from": described("fit_from", list(_FIT_FROM), "", "least restitution of the fit"),
            "tried": described("tried", list(_TRIED), "", "damping coefficient α of the simulated impact"),
        },
    )  # fmt: skip


def _fit(least: float) -> NDArray[np.float64]:
    """Fit by least squares on even steps of log10 e."""
    x = np.linspace(np.log10(least), 0.0, 2001)
    fit = np.polynomial.Polynomial.fit(x, alpha_of_restitution(10**x, "zero_overlap"), _DEGREE)
    return np.asarray(fit.convert().coef)


def draw(data: xr.Dataset) -> Figure:
    """Draw the coefficient and the errors of the polynomials."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.42)
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
            right.plot(
                data.missed, data.deviation.sel(fit_from=least), ls=style, label=f"degree 9, e ≥ {least:g}", **look
            )
        right.plot(data.missed, data.shared_deviation, color=FAINT, lw=pen(1.2), label="degree 6 in e")
        right.set(
            xscale="log", yscale="log", ylim=(1e-9, 10), title="Relative error of the polynomials", ylabel="Error of α"
        )
        for axes in (left, right):
            axes.set(xlabel="1 - e", xlim=(1e-4, 1))
        left.legend(loc="upper left")
        right.legend(loc="lower left")
        letters(figure)
    return figure


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    error = float(np.abs(data.simulated_missed / data.expected_missed - 1).max())
    off = 100 * data.deviation.sel(missed=1e-3, method="nearest").values
    return (
        "A polynomial of degree 9 serves everywhere but near e = 1, where steel is: at e = 0.999 it is off by "
        f"{off[0]:.1g}, "
        f"{off[1]:.1g} or {off[2]:.0f} %, depending on its range, which the paper does not print. Simulated impacts "
        "agree with the "
        f"exact relation to {error:.0e} of 1 - e."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the claims on the printed coefficient and the fit."""
    off = 100 * data.deviation.sel(missed=0.01)
    return (
        Claim(
            "A coefficient of 0.006313 stands for a restitution of about 0.99.",
            "section 5.1",
            "restitution with α = 0.006313",
            {SYSTEM: exact(1 - data.printed_missed)},
            accept=(0.985, 0.995),
            printed="~0.99",
            scope="system",
            note=f"the printed γ is read as α; e = 0.99 would need α = {float(data.needed_alpha):.6f}",
        ),
        Claim(
            "A polynomial of degree 9 in log10 e stands for the relation between restitution and damping.",
            "section 3.1, figure 2",
            "neither coefficients nor range are printed",
            kind="unchecked",
            note=f"our fits over e ≥ {', '.join(f'{x:g}' for x in data.fit_from.values)} are off by "
            f"{', '.join(f'{x:.1g}' for x in off.values)} % at e = 0.99",
        ),
    )


FIGURE = Reproduction(
    number="2",
    title="Damping coefficient for a restitution",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
