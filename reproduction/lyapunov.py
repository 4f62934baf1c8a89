"""Figure A5: growth rates of the separation of neighbouring motions, and the presence of chaos."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import product
from math import log, sqrt
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from rattlebox import Case, Run
from rattlebox.analysis import lyapunov_exponent
from rattlebox.plots import FAINT, INK, SERIES_MARKERS, SERIES_STYLES, StyledFigure, pen

from .figure import QUANTILES, Reproduction
from .files import simulate, simulate_many
from .harmonic import State, harmonic_case, paper_two_impacts
from .judge import Estimate, exact
from .models import COLOURS, MODELS, SHORT, two
from .system import DAMPING, GAP, MASS, START, STIFFNESS, band, near, paper_case

Array = NDArray[np.float64]

DISTANCE = 1e-12  # between the starts of neighbours [m]
SATURATION = GAP / 100  # separation at which growth ends [m]
PAIRS = 16
REACH = 1e-6  # starts of the pairs differ by up to this much to either side [m]
PULSES = {5000.0: 6.0, 100.0: 9.0}  # amplitude [N] and length of the run [s]
WINDOWS, SAMPLES = 300, 5  # windows of time of a run after a pulse, and samples in each
AMPLITUDE = 20.0  # of the harmonic load [N]
IRREGULAR, REGULAR = 18.5, 22.0
"""Frequencies of it at which the motion is irregular, and has two contacts in each cycle [Hz]."""
SETTLED, STROBES = 600, 80  # cycles to settle, and cycles watched
KINDS = f"irregular, {IRREGULAR:g} Hz", f"two contacts a cycle, {REGULAR:g} Hz", f"without the ball, {REGULAR:g} Hz"
_FIT: Mapping[str, Any] = {"color": INK, "lw": 2.0, "alpha": 0.4}


class Separation(NamedTuple):
    """Separation of the pairs of an ensemble."""

    separation: Array  # geometric mean [m]
    spread: Array  # tenth percentile, median and ninetieth percentile of the pairs [m]
    fit: Array  # exponential fitted to it [m], NaN outside
    exponent: float
    standard_error: float
    onset: float  # time at which growth begins [s]
    determination: float  # share of the variance of the logarithm that the fit explains


def _pulse(model: str, case: int, amplitude: float, offset: float) -> Case:
    duration = PULSES[amplitude]
    times = tuple(np.arange(1, WINDOWS * SAMPLES + 1) * duration / (WINDOWS * SAMPLES))
    start = near(START[case], offset)
    return paper_case(MODELS[model], start=start, amplitude=amplitude, duration=duration, times=times)


def cases() -> Mapping[str, Case]:
    """Return the paper's cases, and for harmonic loads the settling runs and the first runs of the pairs."""
    grid = product(PULSES, MODELS, START)
    pulses = {f"{load:g} N, {model}, case {case}": _pulse(model, case, load, 0.0) for load, model, case in grid}
    settling = {f"{f:g} Hz, to settle": _settling(f) for f in (IRREGULAR, REGULAR)}
    steady = {f"{f:g} Hz, settled": _sampled_case(f, State()) for f in (IRREGULAR, REGULAR)}
    return pulses | settling | steady | {KINDS[2]: _sampled_case(REGULAR, State(), ball=False)}


def _settling(frequency: float) -> Case:
    """Return a duration in which enough states after settling can be selected, one in every few cycles."""
    cycles = SETTLED + np.arange(3 * PAIRS) * 17
    duration, times = float(cycles[-1] + 1) / frequency, tuple(cycles / frequency)
    state = State(ball_position=GAP)
    return harmonic_case(amplitude=AMPLITUDE, frequency=frequency, state=state, duration=duration, times=times)


def _states(frequency: float) -> list[State]:
    """Return distant states at the beginning of cycles with the ball in flight."""
    a = simulate(_settling(frequency)).arrays
    motions = (a.displacement[:, 0], a.velocity[:, 0], a.relative_position[:, 0], a.ball_velocity[:, 0], a.time)
    rows = zip(*motions, strict=True)
    states = [State(*map(float, row[:4])) for row in rows if row[4] > 0 and abs(row[2]) < GAP - REACH]
    return states[:PAIRS]


def _sampled_case(frequency: float, state: State, ball: bool = True) -> Case:
    times = tuple(np.arange(1, STROBES + 1) / frequency)
    options: dict[str, Any] = {"duration": times[-1], "times": times, "ball": ball}
    return harmonic_case(amplitude=AMPLITUDE, frequency=frequency, state=state, **options)


def _separations(neighbours: Callable[[float], Sequence[Case]]) -> tuple[Array, Array]:
    """Return times (T,) and distances (P, T) of the runs of cases from those of their neighbours."""
    first, second = neighbours(0.0), neighbours(DISTANCE)
    runs = simulate_many([*first, *second])
    pairs = zip(runs[: len(first)], runs[len(first) :], strict=True)
    return runs[0].arrays.time[1:], np.array([_distance(a, b)[1:] for a, b in pairs])


def _distance(one: Run, other: Run) -> Array:
    """Return the distance in state space [m], (T,), with velocities divided by the natural frequency."""
    omega = sqrt(STIFFNESS / MASS)
    a, b = one.arrays, other.arrays
    parts = (
        a.displacement - b.displacement,
        (a.velocity - b.velocity) / omega,
        a.relative_position - b.relative_position,
        (a.relative_velocity - b.relative_velocity) / omega,
    )
    return np.asarray(np.linalg.norm(np.hstack(parts), axis=1))


def _separation(time: Array, separations: Array) -> Separation:
    """Fit the growth from its beginning to its saturation, or over the whole time if there is none."""
    mean = np.exp(np.log(separations).mean(axis=0))
    begun = mean > 100 * DISTANCE
    begin = int(np.flatnonzero(~begun)[-1]) + 1 if begun[-1] and not begun.all() else 0
    found = lyapunov_exponent(time[begin:], separations[:, begin:], saturation=SATURATION)
    fit = np.full(time.size, np.nan)
    fit[begin:] = mean[begin] * np.exp(found.fit)
    kept = np.isfinite(fit)
    logs = np.log(mean[kept])
    explained = 1 - np.var(logs - np.log(fit[kept])) / max(np.var(logs), 1e-30)
    rates = float(found.exponent), float(found.standard_error)
    return Separation(mean, band(separations), fit, *rates, float(time[begin]), float(explained))


def _after_pulse(model: str, case: int, amplitude: float) -> tuple[Array, Separation]:
    """Simulate pairs near a case of the paper."""
    offsets = REACH * (2 * (np.arange(PAIRS) + 0.25) / PAIRS - 1)
    time, all_separations = _separations(
        lambda shift: [_pulse(model, case, amplitude, float(offset) + shift) for offset in offsets]
    )
    # One that has hit a wall and one that is about to are far apart for an instant only; the median leaves that out.
    windows = np.median(all_separations.reshape(PAIRS, WINDOWS, SAMPLES), axis=2)
    middle = time.reshape(WINDOWS, SAMPLES)[:, SAMPLES // 2]
    return middle, _separation(middle, windows)


def _steady(frequency: float, ball: bool = True) -> tuple[Array, Separation]:
    """Simulate pairs in steady motion, with one sample per cycle; without the ball, the structure is displaced."""
    states, moved = _states(frequency), "ball_position" if ball else "displacement"

    def shifted(state: State, shift: float) -> State:
        return state._replace(**{moved: getattr(state, moved) + shift})

    time, separations = _separations(lambda shift: [_sampled_case(frequency, shifted(s, shift), ball) for s in states])
    return time, _separation(time, separations)


def data() -> xr.Dataset:
    """Compute separations of pairs after pulses, in steady motion, and without the ball."""
    after = [_after_pulse(model, case, load) for load, model, case in product(PULSES, MODELS, START)]
    steady = [_steady(IRREGULAR), _steady(REGULAR), _steady(REGULAR, ball=False)]
    shape = len(PULSES), len(MODELS), len(START)
    times = np.array([time for time, _ in after]).reshape(*shape, WINDOWS)[:, 0, 0]
    # The motion with two hard impacts per cycle, and the structure alone [1/s].
    exact = 2 * REGULAR * log(paper_two_impacts(AMPLITUDE, REGULAR)[0].multiplier)
    expected = np.array([np.nan, exact, -DAMPING / (2 * MASS)])
    theory = [DISTANCE * np.exp(rate * time) for rate, (time, _) in zip(expected, steady, strict=True)]
    watched = _variables(("kind",), "strobe", [part for _, part in steady], (3,))
    return xr.Dataset(
        {
            "time": (("pulse", "window"), times),
            **_variables(("pulse", "model", "case"), "window", [part for _, part in after], shape),
            "steady_time": (("kind", "strobe"), [time for time, _ in steady]),
            **{f"steady_{name}": variable for name, variable in watched.items()},
            "expected": ("kind", expected),
            "expected_separation": (("kind", "strobe"), theory),
            "distance": ((), DISTANCE),
            "saturation": ((), SATURATION),
            "pairs": ((), PAIRS),
        },
        {
            "pulse": list(PULSES),
            "model": list(MODELS),
            "case": list(START),
            "window": np.arange(WINDOWS),
            "kind": list(KINDS),
            **QUANTILES,
            "strobe": np.arange(1, STROBES + 1),
        },
    )


def _variables(over: tuple[str, ...], last: str, parts: list[Separation], shape: tuple[int, ...]) -> dict[str, Any]:
    """Return the variables of an ensemble of separations."""

    def stacked(name: str) -> Array:
        values = np.array([getattr(part, name) for part in parts])
        return values.reshape(*shape, *values.shape[1:])

    exponent, error = stacked("exponent"), stacked("standard_error")
    chaotic = [part.exponent > 3 * part.standard_error and np.isnan(part.fit[-1]) for part in parts]
    return {
        "separation": ((*over, last), stacked("separation")),
        "spread": ((*over, "quantile", last), stacked("spread")),
        "fit": ((*over, last), stacked("fit")),
        "exponent": (over, exponent),
        "standard_error": (over, error),
        "lower": (over, exponent - 2 * error),
        "upper": (over, exponent + 2 * error),
        "onset": (over, stacked("onset")),
        "determination": (over, stacked("determination")),
        "chaotic": (over, np.reshape(chaotic, shape)),
    }


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw separations after pulses, one panel per model, in steady motion, and all exponents."""
    grid = figure.add_gridspec(3, 6)
    first: Axes | None = None
    for row, load in enumerate(data.pulse.values):
        for k, model in enumerate(data.model.values):
            axes = figure.add_subplot(grid[row, 2 * k : 2 * k + 2], sharey=first)
            first = first or axes
            _draw_separations(axes, data.sel(pulse=load, model=model), COLOURS[model])
            axes.set_title(f"{SHORT[model]}, {load:g} N")
            if k:
                axes.tick_params(labelleft=False)
            else:
                axes.set_ylabel("Separation (m)")
    assert first is not None
    first.set_ylim(1e-13, 1e-2)
    styles = zip(SERIES_STYLES, data.case.values, strict=False)
    proxies = [Line2D([], [], color=INK, ls=style, label=f"case {case}") for style, case in styles]
    proxies.append(Line2D([], [], label="exponential fitted", **_FIT))
    figure.legend(handles=proxies, loc="outside upper left", ncols=4)
    steady = figure.add_subplot(grid[2, :3], sharey=first)
    _draw_steady(steady, data)
    steady.set_ylabel("Separation (m)")
    _draw_exponents(figure.add_subplot(grid[2, 3:]), data)


def _draw_separations(axes: Axes, one: xr.Dataset, colour: str) -> None:
    for k, case in enumerate(one.case.values):
        part = one.sel(case=case)
        low, _, high = part.spread.values
        axes.fill_between(one.time, low, high, color=colour, alpha=0.15, lw=0, rasterized=True)
        axes.semilogy(one.time, part.separation, color=colour, ls=SERIES_STYLES[k])
    for case in one.case.values[one.chaotic]:
        axes.semilogy(one.time, one.fit.sel(case=case), **_FIT)
    axes.axhline(float(one.saturation), color=FAINT, lw=pen(0.6), zorder=0)
    axes.set(xlim=(0, float(one.time.max())), xlabel="Time (s)")


def _draw_steady(axes: Axes, data: xr.Dataset) -> None:
    """Draw steady motions under a harmonic load, all with constant restitution."""
    colour = COLOURS[data.model.values[0]]
    theory: dict[str, Any] = {"color": INK, "lw": pen(3), "alpha": 0.25}
    for k, kind in enumerate(data.kind.values):
        part = data.sel(kind=kind)
        low, _, high = part.steady_spread.values
        axes.fill_between(part.steady_time, low, high, color=colour, alpha=0.15, lw=0)
        axes.semilogy(part.steady_time, part.steady_separation, color=colour, ls=SERIES_STYLES[k], label=kind)
        if np.isfinite(part.expected):
            axes.semilogy(part.steady_time, part.expected_separation, **theory)
    axes.plot([], [], label="theory", **theory)
    axes.set(xlim=(0, float(data.steady_time.max())), xlabel="Time (s)")
    axes.set_title(f"Harmonic load, {AMPLITUDE:g} N, constant e")
    axes.legend(loc="center right")


def _draw_exponents(axes: Axes, data: xr.Dataset) -> None:
    for (row, load), (k, model) in product(enumerate(data.pulse.values), enumerate(data.model.values)):
        one, colour = data.sel(pulse=load, model=model), COLOURS[model]
        at, bars = (
            np.arange(one.case.size) + 0.24 * (k - 1) + 0.08 * row,
            (one.exponent - one.lower, one.upper - one.exponent),
        )
        look: dict[str, Any] = {"mfc": "white" if row else colour, "label": None if row else SHORT[model]}
        axes.errorbar(at, one.exponent, bars, fmt=SERIES_MARKERS[k], ms=3.5, color=colour, lw=pen(0.8), **look)
    axes.axhline(0, color=INK, lw=pen(0.5), zorder=0)
    axes.set_xticks(np.arange(data.case.size), [f"case {case}" for case in data.case.values])
    top = float(data.upper.max())
    axes.set(xlim=(-0.5, data.case.size - 0.5), ylim=(-0.05 * top, 1.5 * top), ylabel="Exponent (1/s)")
    axes.set_title(f"Growth rates: filled {data.pulse.values[0]:g} N, open {data.pulse.values[1]:g} N")
    axes.legend(loc="upper left", ncols=3)


def _pulses(data: xr.Dataset) -> tuple[xr.Dataset, xr.Dataset]:
    """Return the data of the strong and of the weak pulse."""
    return data.sel(pulse=data.pulse.max()), data.sel(pulse=data.pulse.min())


def _rate(one: xr.Dataset) -> Any:
    return one.exponent.where(one.chaotic)


def _slowest(part: xr.Dataset, model: str) -> Estimate:
    """Return the lowest growth rate of the cases with its interval, 0 where deviations do not grow."""
    one = part.sel(model=model)
    rate = one.exponent.where(one.chaotic, 0.0)
    k = int(rate.argmin("case"))
    value, error = float(rate[k]), 2 * float(one.standard_error[k]) if float(rate[k]) else 0.0
    return exact(value)._replace(low=value - error, high=value + error)


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return growth and decay rates with those of theory, and the motions that do not grow."""
    (strong, weak), models = _pulses(data), data.model.values
    grid = product(models, data.case.values)
    orderly = [f"{SHORT[m]}, case {k}" for m, k in grid if not strong.chaotic.sel(model=m, case=k)]
    regular = f"no growth to saturation: {', '.join(orderly)}; the motion there is regular" if orderly else ""
    off_centre = weak.sel(case=[2, 3])
    ratio = _rate(off_centre).mean("case") / _rate(strong).mean("case")
    return {
        "strong": strong.pulse,
        "weak": weak.pulse,
        "quick": [float(_rate(strong).min()), float(_rate(strong).max())],
        "slow": [two(_rate(weak).min()), two(_rate(weak).max())],
        "regular": regular,
        "chaotic": {m: _slowest(strong, m) for m in models},
        "portraits": {m: _slowest(off_centre, m) for m in models},
        "low_loads": {m: ratio.sel(model=m) for m in models},
    }


FIGURE = Reproduction("lyapunov", data, draw, 0.85, cases, values)
