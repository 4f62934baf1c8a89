"""Figure 4: one ball with constant restitution, with the paper's time-stepping scheme and with ours."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import PercentFormatter
from numpy.typing import NDArray

from rattlebox import Case, EventDriven, Run, TwoStep
from rattlebox.analysis import lyapunov_exponent
from rattlebox.plots import FAINT, INK, StyledFigure, label, pen, scaled

from .figure import QUANTILES, Reproduction, spread
from .files import simulate_many
from .judge import exact
from .models import COLOURS, CONSTANT_E
from .system import CONSTANT, GAP, START, band, ensemble, near, paper_case

SCHEMES: Mapping[str, EventDriven | TwoStep] = {
    "event-driven": EventDriven(),
    "time-stepping": TwoStep(),
    "event-driven, step by step": EventDriven(collocation=False),
}
"""Ours, the paper's with its printed steps, and ours with other rounding errors."""
_OURS, _THEIRS, _TWIN = SCHEMES

CAVITY = 2 * GAP  # how far apart two balls in the same cavity can be [m]
PARTED = 0.1 * CAVITY  # two motions that differ by more have parted [m]
_SPAN, _APART, _BEGIN = 10.0, 4.0, 0.3
_SLOW, _RATE, _FAST = (np.arange(int(s * rate) + 1) / rate for s, rate in ((_SPAN, 40), (_APART, 400), (_BEGIN, 2000)))
"""Output times of shares, distances and motion [s]."""
_LATER = 0.9 + np.arange(801) / 2000  # times around the parting [s]
_WINDOW = 20  # samples of a window of 0.05 s, half the structure's period
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

    def energy(run: Run) -> NDArray[np.float64]:
        return np.array([run.ledger.structure[fast], run.ledger.particles[fast]])

    def level(run: Run) -> NDArray[np.float64]:
        parts = np.array([run.arrays.viscous_loss, run.ledger.channels["normal"], run.ledger.motion])[:, slow]
        return np.asarray(np.cumsum(parts, axis=0) / run.arrays.load_work[-1])

    variables: dict[str, Any] = {}
    for name, of, dims in (
        ("ball", lambda run: _ball(run)[later], ("later",)),
        ("energy", energy, ("part", "begin")),
        ("level", level, ("channel", "time")),
    ):
        variables[name] = (("scheme", *dims), [of(run) for run in both])
        variables[f"{name}_spread"] = (("quantile", *dims), band([of(run) for run in many]))
    shares = [[np.diff(level(run)[:, -1], prepend=0.0)[1] for run in runs] for runs in (both, many)]
    return xr.Dataset(
        {
            **variables,
            "impact_share": ("scheme", shares[0]),
            "scatter": ("quantile", band(shares[1])),
            "clearance": ((), CAVITY),
            "distance": (("other", "window"), _largest(distance)),
            "parted": ("other", [_first(_RATE, np.abs(d) > PARTED) for d in distance]),
            "pairs": (("quantile", "window"), band(pairs)),
            "fit": ("window", fit),
            "exponent": ((), float(growth.exponent)),
            "error": ((), float(growth.standard_error)),
            "growing": ((), window[growing]),
        },
        {
            "scheme": [_OURS, _THEIRS],
            "other": [_THEIRS, _TWIN],
            "part": ["structure", "ball"],
            "channel": ["viscous", "normal", "motion"],
            "begin": _FAST,
            "later": _LATER,
            "time": _SLOW,
            "window": window,
            **QUANTILES,
        },
    )


def _first(time: NDArray[np.float64], met: NDArray[np.bool_]) -> float:
    return float(time[met][0]) if met.any() else np.nan


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw motion, energies and energy shares of both schemes, and the distance between their motions."""
    layout: Any = [["energy", "share"], ["ball", "ball"], ["distance", "distance"]]
    panels = figure.subplot_mosaic(layout, height_ratios=(1, 0.8, 1.2))
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


def _both(axes: Axes, time: Any, ours: Any, theirs: Any) -> None:
    """Draw our result as a broad pale line, that of time steps as a thin dark line."""
    axes.plot(time, ours, color=COLOURS[CONSTANT_E], alpha=0.5, lw=pen(2.0), label=_OURS)
    axes.plot(time, theirs, color=INK, ls=(0, (4, 2)), lw=pen(0.7), label=_THEIRS)


def _compare(axes: Axes, data: xr.Dataset, name: str, divisor: float) -> None:
    """Draw both results, and the ensemble behind them."""
    values = data[name] / divisor
    time = values[values.dims[-1]]
    low, _, high = data[f"{name}_spread"].transpose("quantile", ...).values / divisor
    axes.fill_between(time, low, high, color=FAINT, alpha=0.5, lw=0, zorder=0, label="starts within 1 µm, 10 to 90 %")
    _both(axes, time, *values.transpose("scheme", ...).values)
    axes.set_xlim(float(time[0]), float(time[-1]))
    label(axes, "x", "Time", "s")


def _shares(axes: Axes, data: xr.Dataset) -> None:
    ours, theirs = data.level.values
    low, _, high = data.level_spread.values
    for k, (text, place) in enumerate((("viscous damping", (6, 0.5)), ("impacts", (6, 0.965)))):
        axes.fill_between(data.time, low[k], high[k], color=FAINT, alpha=0.5, lw=0)
        _both(axes, data.time, ours[k], theirs[k])
        arrow = {"arrowstyle": "-", "lw": pen(0.5)} if k else None
        axes.annotate(text, place, (6, place[1] - 0.25 * k), ha="center", arrowprops=arrow)
    axes.set(xlim=(0, float(data.time[-1])), ylim=(0, 1.02), title="Where the work of the pulse goes")
    axes.yaxis.set_major_formatter(PercentFormatter(1.0, symbol=" %"))
    label(axes, "x", "Time", "s")
    label(axes, "y", "Share of work", "")


def _distances(axes: Axes, data: xr.Dataset) -> None:
    at, colour, clearance = data.window, COLOURS[CONSTANT_E], float(data.clearance)
    theirs, twin = (data.distance.sel(other=name) for name in (_THEIRS, _TWIN))
    axes.plot(at, theirs, ls="-", label="event-driven to time-stepping", color=colour)
    axes.plot(at, twin, ls=(0, (5, 1.5)), label="to event-driven, other rounding errors", color=colour)
    dotted: dict[str, Any] = {"ls": (0, (1, 1.2)), "label": "pairs that start 1 pm apart, 10 to 90 %"}
    spread(axes, at, data.pairs.values, colour, alpha=0.2, **dotted)
    axes.plot(at, data.fit, color=INK, lw=pen(), label=f"exponential, {float(data.exponent):.0f} per second")
    axes.axhline(clearance, color=FAINT, lw=pen(), zorder=0)
    axes.text(float(at[-1]), 1.3 * clearance, "clearance of the cavity", ha="right", va="bottom")
    axes.set(yscale="log", ylim=(1e-15, 2e-2), xlim=(0, _APART))
    axes.set_title("Growth of the distance between two motions of the ball")
    label(axes, "x", "Time", "s")
    label(axes, "y", "Distance", "m")
    axes.legend(loc="lower right")


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return the time of parting, losses in per cent, and the growth rate with two standard errors to each side."""
    low, high = (float(data.exponent + sign * data.error) for sign in (-2, 2))
    return {
        "parted": data.parted.sel(other=_THEIRS),
        "scatter": 100 * data.scatter,
        "members": _MEMBERS,
        "early": 1e6 * data.distance.sel(other=_THEIRS, window=slice(0, 0.5)).max(),
        "share": 100 * data.impact_share,
        "chaotic": exact(data.exponent)._replace(low=low, high=high),
    }


FIGURE = Reproduction("figure_04", data, draw, 0.8, cases, values)
