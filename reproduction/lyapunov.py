"""Figure A5: growth rates of the separation of neighbouring motions, and the presence of chaos."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import inf, log, sqrt
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from rattlebox import Case, Run, restitution_of_alpha
from rattlebox.analysis import lyapunov_exponent
from rattlebox.plots import FAINT, INK, SERIES_MARKERS, SERIES_STYLES, StyledFigure, figure_style, pen

from .ensemble import band, near
from .figure import Reproduction, letters
from .harmonic import BALL, State, harmonic_case
from .judge import Claim, Estimate, by_wall, exact
from .models import COLOURS, MODELS, SHORT, described, two
from .reference import ALPHA, DAMPING, GAP, MASS, START, STIFFNESS, paper_case
from .runs import simulate, simulate_many
from .two_impacts import two_impacts

Array = NDArray[np.float64]

DISTANCE = 1e-12  # Between the starts of neighbours [m]
SATURATION = GAP / 100  # Separation at which growth ends [m]
PAIRS = 16
REACH = 1e-6  # Starts of the pairs differ by up to this much to either side [m]
PULSES = {5000.0: 6.0, 100.0: 9.0}  # Amplitude [N] and length of the run [s]
WINDOWS, SAMPLES = 300, 5  # Windows of time of a run after a pulse, and samples in each
AMPLITUDE = 20.0  # Of the harmonic load [N]
IRREGULAR, REGULAR = 18.5, 22.0
"""Frequencies of it at which the motion is irregular, and has two contacts in each cycle [Hz]."""
SETTLED, STROBES = 600, 80  # Cycles to settle, and cycles watched
KINDS = f"irregular, {IRREGULAR:g} Hz", f"two contacts a cycle, {REGULAR:g} Hz", f"without the ball, {REGULAR:g} Hz"


_FIT: Mapping[str, Any] = {"color": INK, "lw": 2.0, "alpha": 0.4}


class Separation(NamedTuple):
    """Separation of the pairs of an ensemble."""

    separation: Array  # Geometric mean [m]
    spread: Array  # Tenth percentile, median and ninetieth percentile of the pairs [m]
    fit: Array  # Exponential fitted to it [m], NaN outside
    exponent: float
    standard_error: float
    onset: float  # Time at which growth begins [s]
    determination: float  # Share of the variance of the logarithm that the fit explains


def _pulse(model: str, case: int, amplitude: float, offset: float) -> Case:
    duration = PULSES[amplitude]
    times = np.arange(1, WINDOWS * SAMPLES + 1) * duration / (WINDOWS * SAMPLES)
    return paper_case(
        MODELS[model], start=near(START[case], offset), amplitude=amplitude, duration=duration, times=tuple(times)
    )


def cases() -> Mapping[str, Case]:
    """Return the paper's cases, and for harmonic loads the settling runs and the first runs of the pairs."""
    pulses = {
        f"{load:g} N, {model}, case {case}": _pulse(model, case, load, 0.0)
        for load in PULSES
        for model in MODELS
        for case in START
    }
    settling = {f"{f:g} Hz, to settle": _settling(f) for f in (IRREGULAR, REGULAR)}
    steady = {f"{f:g} Hz, settled": _sampled_case(f, State()) for f in (IRREGULAR, REGULAR)}
    return pulses | settling | steady | {KINDS[2]: _sampled_case(REGULAR, State(), ball=False)}


def _settling(frequency: float) -> Case:
    """Return a duration in which enough states after settling can be selected, one in every few cycles."""
    cycles = SETTLED + np.arange(3 * PAIRS) * 17
    return harmonic_case(
        amplitude=AMPLITUDE,
        frequency=frequency,
        state=State(ball_position=GAP),
        duration=float(cycles[-1] + 1) / frequency,
        times=tuple(cycles / frequency),
    )


def _states(frequency: float) -> list[State]:
    """Return distant states at the beginning of cycles with the ball in flight."""
    a = simulate(_settling(frequency)).arrays
    rows = zip(
        a.displacement[:, 0], a.velocity[:, 0], a.relative_position[:, 0], a.ball_velocity[:, 0], a.time, strict=True
    )
    states = [State(*map(float, row[:4])) for row in rows if row[4] > 0 and abs(row[2]) < GAP - REACH]
    return states[:PAIRS]


def _sampled_case(frequency: float, state: State, ball: bool = True) -> Case:
    times = tuple(np.arange(1, STROBES + 1) / frequency)
    return harmonic_case(
        amplitude=AMPLITUDE, frequency=frequency, state=state, duration=times[-1], times=times, ball=ball
    )


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
    spread = np.array(band(separations))
    return Separation(
        mean, spread, fit, float(found.exponent), float(found.standard_error), float(time[begin]), float(explained)
    )


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
    states = _states(frequency)

    def shifted(state: State, shift: float) -> State:
        if ball:
            return state._replace(ball_position=state.ball_position + shift)
        return state._replace(displacement=state.displacement + shift)

    time, separations = _separations(lambda shift: [_sampled_case(frequency, shifted(s, shift), ball) for s in states])
    return time, _separation(time, separations)


def data() -> xr.Dataset:
    """Compute separations of pairs after pulses, in steady motion, and without the ball."""
    grid = [(load, model, case) for load in PULSES for model in MODELS for case in START]
    after = [_after_pulse(model, case, load) for load, model, case in grid]
    steady = [_steady(IRREGULAR), _steady(REGULAR), _steady(REGULAR, ball=False)]
    shape = len(PULSES), len(MODELS), len(START)
    over = ("pulse", "model", "case")
    expected = np.array([np.nan, *_expected()])
    times = np.array([time for time, _ in after]).reshape(*shape, WINDOWS)[:, 0, 0]
    return xr.Dataset(
        {
            "time": described(("pulse", "window"), times, "s", "time"),
            **_ensemble_variables(over, "window", [part for _, part in after], shape),
            "steady_time": described(("kind", "strobe"), [time for time, _ in steady], "s", "time"),
            **{
                f"steady_{name}": variable
                for name, variable in _ensemble_variables(
                    ("kind",), "strobe", [part for _, part in steady], (3,)
                ).items()
            },
            "expected": described("kind", expected, "1/s", "exponent of theory"),
            "expected_separation": described(
                ("kind", "strobe"),
                [DISTANCE * np.exp(rate * time) for rate, (time, _) in zip(expected, steady, strict=True)],
                "m",
                "separation in theory",
            ),
            "distance": described((), DISTANCE, "m", "distance of the starts of neighbours"),
            "saturation": described((), SATURATION, "m", "separation at which growth ends"),
            "pairs": described((), PAIRS, "", "pairs"),
        },
        {
            "pulse": described("pulse", list(PULSES), "N", "amplitude of the pulse"),
            "model": described("model", list(MODELS), "", "contact model"),
            "case": described("case", list(START), "", "case of the paper: start of the ball"),
            "window": described("window", np.arange(WINDOWS), "", "number of the window of time"),
            "kind": described("kind", list(KINDS), "", "steady motion"),
            "quantile": described("quantile", [0.1, 0.5, 0.9], "", "quantile of the pairs"),
            "strobe": described("strobe", np.arange(1, STROBES + 1), "", "cycles of the load"),
        },
    )


def _ensemble_variables(
    over: tuple[str, ...], last: str, parts: list[Separation], shape: tuple[int, ...]
) -> dict[str, Any]:
    """Return the variables of an ensemble of separations."""

    def stacked(name: str) -> Array:
        values = np.array([getattr(part, name) for part in parts])
        return values.reshape(*shape, *values.shape[1:])

    exponent, error = stacked("exponent"), stacked("standard_error")
    chaotic = [part.exponent > 3 * part.standard_error and np.isnan(part.fit[-1]) for part in parts]
    return {
        "separation": described((*over, last), stacked("separation"), "m", "separation, geometric mean of the pairs"),
        "spread": described((*over, "quantile", last), stacked("spread"), "m", "separation of the pairs"),
        "fit": described((*over, last), stacked("fit"), "m", "exponential fitted to the separation"),
        "exponent": described(over, exponent, "1/s", "finite-time Lyapunov exponent"),
        "standard_error": described(over, error, "1/s", "standard error of the exponent"),
        "lower": described(over, exponent - 2 * error, "1/s", "exponent less two standard errors"),
        "upper": described(over, exponent + 2 * error, "1/s", "exponent and two standard errors"),
        "onset": described(over, stacked("onset"), "s", "time at which the fit begins"),
        "determination": described(over, stacked("determination"), "", "share of the variance that the fit explains"),
        "chaotic": described(over, np.reshape(chaotic, shape), "", "exponent above zero and growth to saturation"),
    }


def _expected() -> tuple[float, float]:
    """Return exponents of the motion with two hard impacts per cycle, and of the structure alone [1/s]."""
    exact = two_impacts(
        mass=MASS,
        stiffness=STIFFNESS,
        damping=DAMPING,
        ball=BALL,
        clearance=2 * GAP,
        restitution=float(restitution_of_alpha(ALPHA, "zero_overlap")),
        amplitude=AMPLITUDE,
        frequency=REGULAR,
    )[0]
    return 2 * REGULAR * log(exact.multiplier), -DAMPING / (2 * MASS)


def draw(data: xr.Dataset) -> Figure:
    """Draw separations after pulses, one panel per model, in steady motion, and all exponents."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.85)
        grid = figure.add_gridspec(3, 6)
        first: Axes | None = None
        for row, load in enumerate(data.pulse.values):
            for k, model in enumerate(data.model.values):
                axes = figure.add_subplot(grid[row, 2 * k : 2 * k + 2], sharey=first)
                first = first or axes
                _draw_separations(axes, data.sel(pulse=load, model=model), COLOURS[str(model)])
                axes.set_title(f"{SHORT[str(model)]}, {load:g} N")
                if k:
                    axes.tick_params(labelleft=False)
                else:
                    axes.set_ylabel("Separation (m)")
        assert first is not None
        first.set_ylim(1e-13, 1e-2)
        proxies = [
            Line2D([], [], color=INK, ls=SERIES_STYLES[k], label=f"case {case}")
            for k, case in enumerate(data.case.values)
        ]
        figure.legend(
            handles=[*proxies, Line2D([], [], label="exponential fitted", **_FIT)], loc="outside upper left", ncols=4
        )
        steady = figure.add_subplot(grid[2, :3], sharey=first)
        _draw_steady(steady, data)
        steady.set_ylabel("Separation (m)")
        _draw_exponents(figure.add_subplot(grid[2, 3:]), data)
        letters(figure)
    return figure


def _draw_separations(axes: Axes, one: xr.Dataset, colour: str) -> None:
    for k, case in enumerate(one.case.values):
        part = one.sel(case=case)
        low, _, high = part.spread.values
        axes.fill_between(one.time, low, high, color=colour, alpha=0.15, lw=0, rasterized=True)
        axes.semilogy(one.time, part.separation, color=colour, ls=SERIES_STYLES[k])
    for case in one.case.values[one.chaotic]:
        axes.semilogy(one.time, one.fit.sel(case=case), **_FIT)
    axes.axhline(float(one.saturation), color=FAINT, lw=pen(0.6), zorder=0)
    axes.set_xlim(0, float(one.time.max()))
    axes.set_xlabel("Time (s)")


def _draw_steady(axes: Axes, data: xr.Dataset) -> None:
    """Draw steady motions under a harmonic load, all with constant restitution."""
    colour = COLOURS[str(data.model.values[0])]
    for k, kind in enumerate(data.kind.values):
        part = data.sel(kind=kind)
        low, _, high = part.steady_spread.values
        axes.fill_between(part.steady_time, low, high, color=colour, alpha=0.15, lw=0)
        axes.semilogy(part.steady_time, part.steady_separation, color=colour, ls=SERIES_STYLES[k], label=kind)
        if np.isfinite(part.expected):
            axes.semilogy(part.steady_time, part.expected_separation, color=INK, lw=pen(3), alpha=0.25)
    axes.plot([], [], color=INK, lw=pen(3), alpha=0.25, label="theory")
    axes.set_xlim(0, float(data.steady_time.max()))
    axes.set_xlabel("Time (s)")
    axes.set_title(f"Harmonic load, {AMPLITUDE:g} N, constant e")
    axes.legend(loc="center right")


def _draw_exponents(axes: Axes, data: xr.Dataset) -> None:
    for row, load in enumerate(data.pulse.values):
        for k, model in enumerate(data.model.values):
            one = data.sel(pulse=load, model=model)
            axes.errorbar(
                np.arange(one.case.size) + 0.24 * (k - 1) + 0.08 * row,
                one.exponent,
                (one.exponent - one.lower, one.upper - one.exponent),
                fmt=SERIES_MARKERS[k],
                ms=3.5,
                color=COLOURS[str(model)],
                mfc="white" if row else COLOURS[str(model)],
                lw=pen(0.8),
                label=None if row else SHORT[str(model)],
            )
    axes.axhline(0, color=INK, lw=pen(0.5), zorder=0)
    axes.set_xticks(np.arange(data.case.size), [f"case {case}" for case in data.case.values])
    top = float(data.upper.max())
    axes.set(xlim=(-0.5, data.case.size - 0.5), ylim=(-0.05 * top, 1.5 * top))
    axes.set_ylabel("Exponent (1/s)")
    axes.set_title(f"Growth rates: filled {data.pulse.values[0]:g} N, open {data.pulse.values[1]:g} N")
    axes.legend(loc="upper left", ncols=3)


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    strong, weak = data.sel(pulse=data.pulse.max()), data.sel(pulse=data.pulse.min())
    rates = [one.exponent.where(one.chaotic) for one in (strong, weak)]
    found, expected = data.steady_exponent.values, data.expected.values
    return (
        f"Small deviations grow at {float(rates[0].min()):.0f} to {float(rates[0].max()):.0f} per second after "
        f"{float(strong.pulse):g} N and at "
        f"{two(rates[1].min())} to {two(rates[1].max())} after {float(weak.pulse):g} N. Controls with two contacts a "
        "cycle and without the ball "
        f"decay as theory says: {found[1]:.3f} ({expected[1]:.3f}) and {found[2]:.4f} ({expected[2]:.4f}). "
        f"{int(data.pairs)} pairs, 10 to 90 %."
    )


def _slowest(part: xr.Dataset, model: str) -> Estimate:
    """Return the lowest growth rate of the cases with its interval, 0 where deviations do not grow."""
    one = part.sel(model=model)
    rate = one.exponent.where(one.chaotic, 0.0)
    k = int(rate.argmin("case"))
    value, error = float(rate[k]), 2 * float(one.standard_error[k]) if float(rate[k]) else 0.0
    return exact(value)._replace(low=value - error, high=value + error)


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the claims on chaos after a strong and after a weak pulse."""
    strong, weak = data.sel(pulse=data.pulse.max()), data.sel(pulse=data.pulse.min()).sel(case=[2, 3])
    quick, slow = (one.exponent.where(one.chaotic).mean("case") for one in (strong, weak))
    models = [str(model) for model in data.model.values]
    orderly = [
        f"{SHORT[model]}, case {case}"
        for model in models
        for case in strong.case.values
        if not strong.chaotic.sel(model=model, case=case)
    ]
    return (
        Claim(
            "The system moves chaotically.",
            "conclusion 3, section 6.1",
            f"growth rate of small deviations after {float(strong.pulse):g} N, the lowest of cases 1 to 3 (1/s)",
            by_wall({model: _slowest(strong, model) for model in models}),
            accept=(1e-3, inf),
            scope="both",
            note=f"no growth to saturation: {', '.join(orderly)}; the motion there is regular" if orderly else "",
        ),
        Claim(
            "The portraits suggest chaos.",
            "section 5.1, figure 9",
            f"growth rate of small deviations after {float(weak.pulse):g} N, the lower of cases 2 and 3 (1/s)",
            by_wall({model: _slowest(weak, model) for model in models}),
            accept=(1e-3, inf),
            scope="both",
        ),
        Claim(
            "The sensitive dependence, as chaos, is found particularly at low loads.",
            "section 5.1, figure 9",
            f"growth rate after {float(weak.pulse):g} N over that after {float(strong.pulse):g} N, means of the "
            "chaotic cases",
            by_wall({model: exact(slow.sel(model=model) / quick.sel(model=model)) for model in models}),
            accept=(1, inf),
            scope="both",
            note="contacts are rare at low loads, so that small deviations grow more slowly",
        ),
    )


FIGURE = Reproduction(
    number="A5",
    title="Finite-time Lyapunov exponents",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
