"""Figure 4: one ball with constant restitution, with the paper's time-stepping scheme and with ours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter
from numpy.typing import NDArray

from rattlebox import Case, EventDriven, Run, TwoStep
from rattlebox.analysis import lyapunov_exponent
from rattlebox.plots import FAINT, INK, StyledFigure, figure_style, label, pen, scaled

from .ensemble import band, ensemble, near
from .figure import Reproduction, letters
from .judge import SYSTEM, Claim, exact
from .models import COLOURS, CONSTANT_E, described
from .reference import CONSTANT, GAP, START, paper_case
from .runs import simulate_many

SCHEMES: Mapping[str, EventDriven | TwoStep] = {
    "event-driven": EventDriven(),
    "time-stepping": TwoStep(),
    "event-driven, step by step": EventDriven(collocation=False),
}
"""Ours, the paper's with its printed steps, and ours with other rounding errors."""
_OURS, _THEIRS, _TWIN = SCHEMES

CAVITY = 2 * GAP  # How far apart two balls in the same cavity can be [m]
PARTED = 0.1 * CAVITY  # Two motions that differ by more have parted [m]
_SPAN, _APART, _BEGIN = 10.0, 4.0, 0.3
_SLOW, _RATE, _FAST = (
    np.arange(int(span * rate) + 1) / rate for span, rate in ((_SPAN, 40), (_APART, 400), (_BEGIN, 2000))
)
"""Output times of shares, distances and motion [s]."""
_LATER = 0.9 + np.arange(801) / 2000  # Times around the parting [s]
_WINDOW = 20  # Samples of a window of 0.05 s, half the structure's period
_NEIGHBOUR, _MEMBERS = 1e-12, 32


_ALL = np.unique(np.concatenate([_SLOW, _RATE, _FAST, _LATER])).tolist()


def cases() -> Mapping[str, Case]:
    """Return the centred ball under the 5000 N pulse by scheme, and the first cases of the pairs."""
    schemes = {
        scheme: paper_case(CONSTANT, start=START[1], duration=_SPAN, times=_ALL, method=method, name=scheme)
        for scheme, method in SCHEMES.items()
    }
    return schemes | {"pairs": _neighbour(0.0)}


def _member(offset: float) -> Case:
    return paper_case(CONSTANT, start=near(START[1], offset), duration=_SPAN, times=_ALL)


def _neighbour(offset: float, apart: float = 0.0) -> Case:
    return paper_case(CONSTANT, start=near(START[1], offset + apart), duration=_APART, times=_RATE.tolist())


def _ball(run: Run) -> NDArray[np.float64]:
    return run.arrays.relative_position[:, 0]


def _largest(distance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the largest distance in each time window."""
    return np.asarray(np.abs(distance[..., 1:]).reshape(*distance.shape[:-1], -1, _WINDOW).max(axis=-1))


def data() -> xr.Dataset:
    """Compute the case with each scheme, an ensemble of it, and pairs of runs that start a picometre apart."""
    ours, theirs, twin = simulate_many([cases()[scheme] for scheme in SCHEMES])
    slow, apart, fast, later = (np.isin(ours.arrays.time, times) for times in (_SLOW, _RATE, _FAST, _LATER))
    distance = np.array([_ball(run)[apart] - _ball(ours)[apart] for run in (theirs, twin)])
    first = ensemble(_neighbour, _MEMBERS)
    second = ensemble(lambda offset: _neighbour(offset, _NEIGHBOUR), _MEMBERS)
    pairs = _largest(np.array([_ball(a) - _ball(b) for a, b in zip(first, second, strict=True)]))
    window = _RATE[1:].reshape(-1, _WINDOW).mean(axis=1)
    mean = np.exp(np.log(pairs).mean(axis=0))
    # At first the ball moves in step with the structure and neighbours stay together.
    growing = int(np.flatnonzero(mean < 10 * mean[0])[-1]) + 1
    growth = lyapunov_exponent(window[growing:], pairs[:, growing:], saturation=PARTED)
    fit = np.full_like(mean, np.nan)
    fit[growing:] = mean[growing] * np.exp(growth.fit)
    both, many = (ours, theirs), ensemble(_member, _MEMBERS)

    def ball(run: Run) -> NDArray[np.float64]:
        return np.asarray(_ball(run)[later])

    def energy(run: Run) -> NDArray[np.float64]:
        return np.array([run.ledger.structure[fast], run.ledger.particles[fast]])

    def level(run: Run) -> NDArray[np.float64]:
        parts = np.array([run.arrays.viscous_loss, run.ledger.channels["normal"], run.ledger.motion])[:, slow]
        return np.asarray(np.cumsum(parts, axis=0) / run.arrays.load_work[-1])

    variables = {}
    for name, of, dims, unit, text in (
        ("ball", ball, ("later",), "m", "place of the ball in its cavity"),
        ("energy", energy, ("part", "begin"), "J", "instantaneous energy"),
        ("level", level, ("channel", "time"), "", "share of the work of the pulse, added up over the channels"),
    ):
        variables[name] = described(("scheme", *dims), [of(run) for run in both], unit, text)
        variables[f"{name}_spread"] = described(
            ("quantile", *dims), band([of(run) for run in many]), unit, f"{text}, ensemble of start positions"
        )
    shares = [[np.diff(level(run)[:, -1], prepend=0.0)[1] for run in runs] for runs in (both, many)]

    return xr.Dataset(
        {
            **variables,
            "impact_share": described("scheme", shares[0], "", "share of the work lost in impacts in 10 s"),
            "scatter": described(
                "quantile",
                band(shares[1]),
                "",
                "share of the work lost in impacts in 10 s, ensemble of start positions",
            ),
            "clearance": described((), CAVITY, "m", "clearance of the cavity"),
            "distance": described(
                ("other", "window"), _largest(distance), "m", "distance of the balls from the event-driven run"
            ),
            "parted": described(
                "other", [_first(_RATE, np.abs(d) > PARTED) for d in distance], "s", "time at which the motions part"
            ),
            "pairs": described(
                ("quantile", "window"), band(pairs), "m", "distance of balls that started 1 pm apart, ensemble"
            ),
            "fit": described("window", fit, "m", "exponential fit to the geometric mean of the pairs"),
            "exponent": described((), growth.exponent, "1/s", "rate of the exponential growth"),
            "error": described((), growth.standard_error, "1/s", "standard error of the rate"),
            "growing": described((), window[growing], "s", "time at which the growth begins"),
        },
        {
            "scheme": described("scheme", [_OURS, _THEIRS], "", "scheme"),
            "other": described("other", [_THEIRS, _TWIN], "", "scheme compared with the event-driven one"),
            "part": described("part", ["structure", "ball"], "", "body"),
            "channel": described("channel", ["viscous", "normal", "motion"], "", "where the work of the pulse is"),
            "begin": described("begin", _FAST, "s", "time, beginning"),
            "later": described("later", _LATER, "s", "time, around the parting"),
            "time": described("time", _SLOW, "s", "time"),
            "window": described("window", window, "s", "middle of the window of 0.05 s"),
            "quantile": described("quantile", [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
        },
    )


def _first(time: NDArray[np.float64], met: NDArray[np.bool_]) -> float:
    return float(time[met][0]) if met.any() else np.nan


def draw(data: xr.Dataset) -> Figure:
    """Draw motion, energies and energy shares of both schemes, and the distance between their motions."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.8)
        panels = figure.subplot_mosaic(
            [["energy", "share"], ["ball", "ball"], ["distance", "distance"]], height_ratios=(1, 0.8, 1.2)
        )
        travel, energy = scaled(data.ball, "m"), scaled(data.energy, "J")
        for part in data.part.values:
            _compare(panels["energy"], data.sel(part=part), "energy", energy.divisor)
            high = float(data.energy.sel(part=part).max()) / energy.divisor
            panels["energy"].text(0.3, high, str(part), ha="right", va="bottom")
        _compare(panels["ball"], data, "ball", travel.divisor)
        panels["energy"].set(ylim=(0, None), title="Energies, beginning")
        panels["ball"].set_title("Ball in its cavity, when the programs part")
        label(panels["energy"], "y", "Energy", energy.unit)
        label(panels["ball"], "y", "Position", travel.unit)
        panels["ball"].axvline(float(data.parted.sel(other=_THEIRS)), color=INK, lw=pen(), zorder=0)
        figure.legend(*panels["ball"].get_legend_handles_labels(), loc="outside upper left", ncols=4)
        _shares(panels["share"], data)
        _distances(panels["distance"], data)
        letters(figure)
    return figure


def _compare(axes: Axes, data: xr.Dataset, name: str, divisor: float) -> None:
    """Draw our result as a broad pale line, that of time steps as a thin dark line, and the ensemble behind them."""
    values = data[name] / divisor
    time = values[values.dims[-1]]
    low, _, high = data[f"{name}_spread"].transpose("quantile", ...).values / divisor
    axes.fill_between(time, low, high, color=FAINT, alpha=0.5, lw=0, zorder=0, label="starts within 1 µm, 10 to 90 %")
    ours, theirs = values.transpose("scheme", ...).values
    axes.plot(time, ours, color=COLOURS[CONSTANT_E], alpha=0.5, lw=pen(2.0), label=_OURS)
    axes.plot(time, theirs, color=INK, ls=(0, (4, 2)), lw=pen(0.7), label=_THEIRS)
    axes.set_xlim(float(time[0]), float(time[-1]))
    label(axes, "x", "Time", "s")


def _shares(axes: Axes, data: xr.Dataset) -> None:
    ours, theirs = data.level.values
    low, _, high = data.level_spread.values
    for k, (text, place) in enumerate((("viscous damping", (6, 0.5)), ("impacts", (6, 0.965)))):
        axes.fill_between(data.time, low[k], high[k], color=FAINT, alpha=0.5, lw=0)
        axes.plot(data.time, ours[k], color=COLOURS[CONSTANT_E], alpha=0.5, lw=pen(2.0))
        axes.plot(data.time, theirs[k], color=INK, ls=(0, (4, 2)), lw=pen(0.7))
        axes.annotate(
            text,
            place,
            (6, place[1] - 0.25 * k),
            ha="center",
            arrowprops={"arrowstyle": "-", "lw": pen(0.5)} if k else None,
        )
    axes.set(xlim=(0, float(data.time[-1])), ylim=(0, 1.02), title="Where the work of the pulse goes")
    axes.yaxis.set_major_formatter(PercentFormatter(1.0, symbol=" %"))
    label(axes, "x", "Time", "s")
    label(axes, "y", "Share of work", "")


def _distances(axes: Axes, data: xr.Dataset) -> None:
    low, median, high = data.pairs.values
    look: dict[str, Any] = {"color": COLOURS[CONSTANT_E]}
    axes.plot(data.window, data.distance.sel(other=_THEIRS), ls="-", label="event-driven to time-stepping", **look)
    axes.plot(
        data.window,
        data.distance.sel(other=_TWIN),
        ls=(0, (5, 1.5)),
        label="to event-driven, other rounding errors",
        **look,
    )
    axes.fill_between(data.window, low, high, alpha=0.2, lw=0, **look)
    axes.plot(data.window, median, ls=(0, (1, 1.2)), label="pairs that start 1 pm apart, 10 to 90 %", **look)
    axes.plot(data.window, data.fit, color=INK, lw=pen(), label=f"exponential, {float(data.exponent):.0f} per second")
    axes.axhline(float(data.clearance), color=FAINT, lw=pen(), zorder=0)
    axes.text(float(data.window[-1]), 1.3 * float(data.clearance), "clearance of the cavity", ha="right", va="bottom")
    axes.set(
        yscale="log",
        ylim=(1e-15, 2e-2),
        xlim=(0, _APART),
        title="Growth of the distance between two motions of the ball",
    )
    label(axes, "x", "Time", "s")
    label(axes, "y", "Distance", "m")
    axes.legend(loc="lower right")


def _percent(share: object) -> str:
    return f"{100 * float(np.asarray(share)):.2f} %"


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    theirs = float(data.parted.sel(other=_THEIRS))
    low, median, high = data.scatter.values
    return (
        f"Two programs agree until {theirs:.2f} s, when chaos has amplified the difference of their schemes; the "
        "energies agree for "
        f"all times. Centred ball, constant restitution, 5 kN; the paper's steps are 5 µs and 30 ns. Loss in impacts: "
        f"{_percent(median)} ({_percent(low)} to {_percent(high)} of {_MEMBERS} starts)."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the claims on the agreement of two programs and on the integration scheme."""
    early = float(data.distance.sel(other=_THEIRS, window=slice(0, 0.5)).max())
    ours, theirs = (float(share) for share in data.impact_share)
    return (
        Claim(
            "The program repeats the results of Li et al. for a single ball identically.",
            "section 4.2, figure 4",
            "Li's curves are in figures 4b and 4d, which we do not have",
            kind="unchecked",
            note=f"two schemes of ours stay within {1e6 * early:.2g} µm for 0.5 s and part at "
            f"{float(data.parted.sel(other=_THEIRS)):.2f} s; impacts take {_percent(ours)} and {_percent(theirs)} of "
            "the work",
        ),
        Claim(
            "With constant restitution the motion is chaotic.",
            "conclusion 3, section 6.1",
            "growth rate of small deviations, case 1, 5 kN (1/s)",
            {
                SYSTEM: exact(data.exponent)._replace(
                    low=float(data.exponent - 2 * data.error), high=float(data.exponent + 2 * data.error)
                )
            },
            accept=(1e-3, inf),
            scope="constant",
            note="from pairs that start 1 pm apart; all cases and models are in figure A5",
        ),
    )


FIGURE = Reproduction(
    number="4",
    title="One ball with constant restitution, by two programs",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
