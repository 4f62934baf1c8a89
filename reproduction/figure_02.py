"""Figure 2: Tsuji's damping coefficient for a restitution, exact and fitted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import sqrt
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rattlebox import Case, Fixed, ImpactDamper, Sphere, Tsuji, alpha_of_restitution, restitution_of_alpha
from rattlebox.plots import INK, SERIES_COLOURS, SERIES_MARKERS, StyledFigure, figure_style, pen

from .figure import Claim, Reproduction
from .models import described
from .reference import ALPHA, GAP, RADIUS, Ending
from .runs import simulate_many

ENDINGS: tuple[Ending, Ending] = ("zero_overlap", "zero_force")
_NAMES = {"zero_overlap": "zero overlap", "zero_force": "zero force"}
_STYLES: tuple[Any, ...] = ("-", (0, (4, 1.5)))

_DEGREE = 9
_FIT_FROM = (0.1, 0.01, 0.001)
"""Least restitution that the fit is made for; the paper does not say it."""
_TRIED = (1e-4, 1e-3, ALPHA, 0.03, 0.1 * sqrt(5), 0.3 * sqrt(5), 0.5 * sqrt(5), 0.9 * sqrt(5))
"""Coefficients put to the test in a simulated impact."""
_SHARED = (1.2728, -4.2783, 11.087, -22.348, 27.467, -18.022, 4.8218)
"""Polynomial in e that discrete-element programs hand on (LAMMPS, documentation of pair_style granular, tsuji)."""


def _impact(alpha: float, ending: Ending) -> Case:
    """Return a case of a ball that hits a wall at rest once."""
    damper = ImpactDamper(
        balls=(Sphere(radius=RADIUS, material="steel"),),
        gap=GAP,
        velocity=(0.1,),
        contact=Tsuji(alpha=alpha, ending=ending),
    )
    return Case(structure=Fixed(), dampers=(damper,), duration=8e-3)


def cases() -> Mapping[str, Case]:
    """Return the impacts with the paper's coefficient, by the ending of the contact."""
    return {ending: _impact(ALPHA, ending) for ending in ENDINGS}


def data() -> xr.Dataset:
    """Compute the exact relation, its fits, and simulated impacts."""
    e = np.unique(
        np.concatenate(
            [np.geomspace(1e-3, 0.2, 150), np.linspace(0.2, 0.9, 176), 1 - np.geomspace(0.1, 1e-4, 120), (0.99, 0.999)]
        )
    )
    exact = np.array([alpha_of_restitution(e, ending) for ending in ENDINGS])
    fits = np.array([[_fit(ending, least) for least in _FIT_FROM] for ending in ENDINGS])
    fitted = np.array([[np.polynomial.Polynomial(c)(np.log10(e)) for c in row] for row in fits])
    fitted[:, e < np.array(_FIT_FROM)[:, None]] = np.nan
    shared = np.polynomial.Polynomial(_SHARED)(e)
    runs = simulate_many([_impact(alpha, ending) for ending in ENDINGS for alpha in _TRIED])
    met = [run.impacts.isel(impact=0) for run in runs]
    first = [float(impact.separation_speed / impact.approach_speed) for impact in met]
    expected = [restitution_of_alpha(_TRIED, ending) for ending in ENDINGS]
    printed = [restitution_of_alpha(ALPHA, ending) for ending in ENDINGS]
    needed = [alpha_of_restitution(0.99, ending) for ending in ENDINGS]

    return xr.Dataset(
        {
            "alpha": described(("ending", "e"), exact, "", "damping coefficient α, exact"),
            "fitted": described(
                ("ending", "fit_from", "e"), fitted, "", "damping coefficient α, fit of degree 9 in log10 e"
            ),
            "coefficient": described(
                ("ending", "fit_from", "power"), fits, "", "coefficient of the fit at a power of log10 e"
            ),
            "deviation": described(
                ("ending", "fit_from", "e"), np.abs(fitted / exact[:, None] - 1), "", "deviation of the fit from exact"
            ),
            "shared": described(
                "e", shared, "", "damping coefficient α, polynomial of degree 6 in e that programs share"
            ),
            "shared_deviation": described("e", np.abs(shared / exact[0] - 1), "", "deviation of the shared polynomial"),
            "simulated": described(
                ("ending", "tried"), np.reshape(first, (2, -1)), "", "restitution of a simulated impact"
            ),
            "expected": described(("ending", "tried"), expected, "", "restitution that the exact relation gives"),
            "printed_alpha": described((), ALPHA, "", "printed coefficient"),
            "printed_e": described("ending", printed, "", "restitution at the printed coefficient"),
            "printed_missed": described("ending", 1 - np.array(printed), "", "1 - e at the printed coefficient"),
            "missed": described("e", 1 - e, "", "1 - e"),
            "simulated_missed": described(
                ("ending", "tried"), 1 - np.reshape(first, (2, -1)), "", "1 - e of a simulated impact"
            ),
            "needed_alpha": described("ending", needed, "", "coefficient for a restitution of 0.99"),
        },
        {
            "e": described("e", e, "", "restitution"),
            "ending": described("ending", list(ENDINGS), "", "where the contact ends"),
            "fit_from": described("fit_from", list(_FIT_FROM), "", "least restitution of the fit"),
            "power": described("power", np.arange(_DEGREE + 1), "", "power of log10 e"),
            "tried": described("tried", _TRIED, "", "damping coefficient α of the simulated impact"),
        },
    )


def _fit(ending: Ending, least: float) -> NDArray[np.float64]:
    """Fit by least squares on even steps of log10 e."""
    x = np.linspace(np.log10(least), 0.0, 2001)
    fit = np.polynomial.Polynomial.fit(x, alpha_of_restitution(10**x, ending), _DEGREE)
    return np.asarray(fit.convert().coef)


def draw(data: xr.Dataset) -> Figure:
    """Draw coefficients above and deviations below, over all restitutions and over those of steel."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.72)
        axes = figure.subplots(2, 2, sharex="col", height_ratios=(1.2, 1))
        for column in range(2):
            _column(axes[:, column], data, near_one=bool(column))
        upper, lower = axes[:, 1]
        alpha = float(data.printed_alpha)
        overlap = data.sel(ending="zero_overlap")
        missed = float(overlap.printed_missed)
        upper.axhline(alpha, color=INK, lw=pen(0.4), zorder=0)
        upper.axvline(missed, color=INK, lw=pen(0.4), zorder=0)
        upper.text(
            1.25 * missed, 4e-5, f"printed: α = {alpha:g}\nexact: e = {float(overlap.printed_e):.5f}", va="bottom"
        )
        upper.set(xscale="log", yscale="log", xlim=(1e-4, 1), ylim=(3e-5, 4))
        upper.set_xlabel("")
        lower.set_xlabel("1 - e")
        axes[0, 0].set(xlim=(0, 1), ylim=(0, 3))
        axes[1, 0].set_xlabel("Restitution e")
        axes[0, 0].set_ylabel("Damping coefficient α")
        axes[1, 0].set_ylabel("Deviation over exact α")
        handles, names = (a + b for a, b in zip(*(x.get_legend_handles_labels() for x in axes[:, 0]), strict=True))
        figure.legend(handles, names, loc="outside upper left", ncols=3)
    return figure


def _column(axes: Any, data: xr.Dataset, near_one: bool) -> None:
    """Draw one column, over e or over 1 - e."""
    upper, lower = axes
    x, met = (data.missed, data.simulated_missed) if near_one else (data.e, data.simulated)
    for ending, style, marker in zip(data.ending.values, _STYLES, SERIES_MARKERS, strict=False):
        one = data.sel(ending=ending)
        upper.plot(x, one.alpha, color=INK, linestyle=style, label=f"exact, contact ends at {_NAMES[ending]}")
        upper.plot(
            met.sel(ending=ending),
            data.tried,
            marker,
            color=INK,
            mfc="white",
            ms=3.5,
            mew=pen(0.7),
            label=f"simulated impacts, {_NAMES[ending]}",
        )
        widest = one.fitted.isel(fit_from=-1)
        upper.plot(x, widest, color=SERIES_COLOURS[2], alpha=0.4, lw=pen(3), zorder=1)
        for least, colour in zip(data.fit_from.values, SERIES_COLOURS, strict=False):
            lower.plot(
                x,
                one.deviation.sel(fit_from=least),
                color=colour,
                linestyle=style,
                lw=pen(0.9),
                label=f"fit of degree 9, e ≥ {least:g}, {_NAMES[ending]}",
            )
    dots = (0, (1, 1.2))
    upper.plot(x, data.shared, color=SERIES_COLOURS[3], linestyle=dots, label="degree 6 in e, as programs share it")
    lower.plot(x, data.shared_deviation, color=SERIES_COLOURS[3], linestyle=dots)
    lower.set_yscale("log")
    lower.set_ylim(1e-9, 10)


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    here = data.sel(ending="zero_overlap")
    near = [f"{value:.2g}" for value in 100 * here.deviation.sel(e=0.999).values]
    ranges = [f"{value:g}" for value in data.fit_from.values]
    constant = here.coefficient.sel(power=0).values
    worst = float(np.abs(data.simulated / data.expected - 1).max())
    gains = [f"{ranges[k]} ({value:.1e})" for k, value in enumerate(constant) if value < 0]
    return (
        "Tsuji's coefficient α for a restitution e, exact for both endings of the contact (lines) and confirmed by "
        f"simulated impacts to {worst:.0e} (marks); below, how far polynomials deviate. The paper fits degree 9 in "
        f"log10 e and prints neither coefficients nor range; fitted here from e = {', '.join(ranges)} (broad line: the "
        "last), it serves everywhere but near e = 1, where steel lives: at e = 0.999 it is off by "
        f"{', '.join(near)} %."
        + (f" Fits from {' and '.join(gains)} have a negative α at e = 1: impacts would gain energy." if gains else "")
        + f" The polynomial of degree 6 in e that discrete-element programs share is off by "
        f"{100 * float(data.shared_deviation.sel(e=0.9, method='nearest')):.0f} % at e = 0.9: a factor of √2, because "
        "it counts the mass of one sphere instead of the reduced mass."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the verdicts on the printed coefficient and the fit."""
    overlap, force = (float(value) for value in data.printed_e)
    needed = float(data.needed_alpha.sel(ending="zero_overlap"))
    alpha = float(data.printed_alpha)
    off = 100 * data.deviation.sel(ending="zero_overlap", e=0.99)
    return (
        Claim(
            f"A coefficient of {alpha:g} stands for a restitution of about 0.99.",
            "section 5.1",
            f"e = {overlap:.5f} if the contact ends at zero overlap, {force:.5f} if at zero force; e = 0.99 needs "
            f"α = {needed:.6f}",
            "the printed γ is α of equation (9)",
            "reproduced" if round(overlap, 2) == round(force, 2) == 0.99 else "not reproducible",
        ),
        Claim(
            "A polynomial of degree 9 in log10 e stands for the relation between restitution and damping.",
            "section 3.1, figure 2",
            f"at e = 0.99, α is off by {' or '.join(f'{value:.2g} %' for value in off.values)}: fits from "
            f"e = {' or '.join(f'{value:g}' for value in data.fit_from.values)} on",
            "neither coefficients nor range are printed: our least squares on even steps of log10 e",
            "reproduced qualitatively" if float(off.max()) < 5 else "not reproducible",
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
