"""Figure 11: the response to a weak pulse with and without the damper."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from rattlebox import Case, Run
from rattlebox.analysis import peak_reduction, rms_reduction, settling_time
from rattlebox.plots import FAINT, INK, SERIES_COLOURS, StyledFigure, figure_style, label, pen, scaled

from .ensemble import band, ensemble, near
from .figure import Claim, Reproduction
from .models import described
from .reference import CONSTANT, MASS, PLASTIC, START, STIFFNESS, paper_case
from .runs import simulate

AMPLITUDE = 100.0
"""Of the pulse [N]."""
DURATION, RATE = 30.0, 1000.0
"""Of the runs [s], and their samples a second [Hz]."""
SHOWN, EVERY = 6.0, 4
"""Time that is drawn [s], and of how many samples one."""
LEVELS = np.append(np.geomspace(0.9, 0.03, 35), 0.05)
"""Shares of the bare structure's peak below which the response is to stay."""
SETTLED = 0.05
UNTIL = (1.0, 2.0, 5.0, 10.0)
"""Ends of the intervals, all from the pulse on, whose RMS is compared [s]."""
MEMBERS = 48

_MODELS = {"constant": CONSTANT, "elasto-plastic": PLASTIC}
_WITHOUT = "without damper"


def _case(model: str, start: float = START[3]) -> Case:
    if model == _WITHOUT:
        return paper_case(ball=False, amplitude=AMPLITUDE, duration=DURATION, rate=RATE)
    return paper_case(_MODELS[model], start=start, amplitude=AMPLITUDE, duration=DURATION, rate=RATE)


def cases() -> Mapping[str, Case]:
    """Return case 3 with both models of restitution, and without damper."""
    return {model: _case(model) for model in (*_MODELS, _WITHOUT)}


def _amplitude(run: Run) -> np.ndarray:
    """Return the amplitude of the free oscillation that follows each instant."""
    arrays = run.arrays
    return np.asarray(np.hypot(arrays.displacement[:, 0], arrays.velocity[:, 0] * np.sqrt(MASS / STIFFNESS)))


def data() -> xr.Dataset:
    """Compute the responses, their settling times for each level, and the reduction of peak and RMS."""
    bare = simulate(_case(_WITHOUT)).arrays
    time, without = bare.time, bare.displacement[:, 0]
    peak = float(np.abs(without).max())
    levels = np.sort(LEVELS)[::-1]

    def settled(values: np.ndarray) -> list[float]:
        return [settling_time(time, values, band=level, reference=peak) for level in levels]

    def reduced(values: np.ndarray) -> list[float]:
        """Return the reduction of the peak, then of the RMS in each interval."""
        parts = [time < until for until in UNTIL]
        return [peak_reduction(without, values), *(rms_reduction(without[part], values[part]) for part in parts)]

    drawn = np.flatnonzero(time <= SHOWN)[::EVERY]
    single, alone, spread, reductions, amplitudes, moves = [], [], [], [], [], []
    for model in _MODELS:
        run = simulate(_case(model))
        many = ensemble(lambda offset, model=model: _case(model, near(START[3], offset)), MEMBERS)  # type: ignore[misc]
        moved = [each.arrays.displacement[:, 0] for each in many]
        single.append(run)
        amplitudes.append(band([_amplitude(each)[drawn] for each in many]))
        moves.append(band([values[drawn] for values in moved]))
        alone.append(settled(run.arrays.displacement[:, 0]))
        spread.append(band([settled(values) for values in moved]))
        reductions.append(band([reduced(values) for values in moved]))
    low, median, high = np.moveaxis(np.array(spread), 1, 0)
    hits = [run.arrays.impacts.time[run.arrays.impacts.time <= SHOWN] for run in single]
    contacts = np.full((len(hits), max(map(len, hits))), np.nan)
    for row, times in zip(contacts, hits, strict=True):
        row[: len(times)] = times
    early = slice(1, int(SHOWN * RATE))
    flown = [np.max(run.ledger.particles[early] / run.ledger.total[early]) for run in single]

    each = ("model", "level")
    text = "time after which the displacement stays below a level"
    return xr.Dataset(
        {
            "without": described(("time",), without[drawn], "m", "displacement without damper"),
            "displacement": described(
                ("model", "time"), np.array([run.arrays.displacement[drawn, 0] for run in single]), "m", "displacement"
            ),
            "displacement_spread": described(
                ("model", "quantile", "time"), moves, "m", "displacement, ensemble of start positions"
            ),
            "amplitude": described(
                ("model", "quantile", "time"),
                amplitudes,
                "m",
                "amplitude of the displacement, the root of x^2 + v^2 M/K, ensemble of start positions",
            ),
            "mark": described((), 1.25 * peak, "m", "height at which contacts are marked"),
            "contact": described(("model", "count"), contacts, "s", "time of contact"),
            "settled_without": described(("level",), settled(without), "s", f"{text}, without damper"),
            "settled": described(each, np.array(alone), "s", f"{text}, single run"),
            "settled_low": described(each, low, "s", f"{text}, 10 % of the ensemble"),
            "settled_median": described(each, median, "s", f"{text}, median"),
            "settled_high": described(each, high, "s", f"{text}, 90 % of the ensemble"),
            "peak_reduction": described(
                ("model", "quantile"), np.array(reductions)[..., 0], "", "reduction of the peak"
            ),
            "rms_reduction": described(
                ("model", "quantile", "until"),
                np.array(reductions)[..., 1:],
                "",
                "reduction of the RMS since the pulse",
            ),
            "ball_share": described(
                ("model",), np.array(flown), "", "greatest share of the ball in the energy, single run"
            ),
            "impact_share": described(
                ("model",),
                np.array([(run.ledger.channels["normal"] / run.ledger.work[-1])[-1] for run in single]),
                "",
                "share of the work lost in impacts, single run",
            ),
            "peak": described((), peak, "m", "peak without damper"),
        },
        {
            "model": described(("model",), list(_MODELS), "", "model of restitution"),
            "time": described(("time",), time[drawn], "s", "time"),
            "count": described(("count",), np.arange(contacts.shape[1]), "", "number of the contact"),
            "level": described(("level",), levels, "", "share of the peak without damper"),
            "quantile": described(("quantile",), [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
            "until": described(("until",), list(UNTIL), "s", "end of the interval"),
        },
    )


def draw(data: xr.Dataset) -> Figure:
    """Draw the responses on the left, and their settling times on the right."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.58)
        grid = figure.subplot_mosaic([["constant", "level"], ["elasto-plastic", "level"]], width_ratios=(1.7, 1))
        grid["constant"].sharex(grid["elasto-plastic"])
        x = scaled(data.without, "m")
        right = grid["level"]
        top = float(data.mark) / x.divisor
        for model, colour, style in zip(data.model.values, SERIES_COLOURS, ("-", (0, (5, 1.5))), strict=False):
            one, axes = data.sel(model=model), grid[model]
            axes.plot(data.time, data.without / x.divisor, color=FAINT, linewidth=pen(1.0))
            axes.plot(data.time, one.displacement / x.divisor, color=colour, linewidth=pen(0.5))
            least, middle, most = one.displacement_spread.values / x.divisor
            axes.fill_between(data.time, least, most, color=colour, alpha=0.3, linewidth=0)
            (moved,) = axes.plot(
                data.time, middle, color=INK, linestyle=":", linewidth=pen(0.4), label="displacement, median and band"
            )
            least, middle, most = one.amplitude.values / x.divisor
            axes.fill_between(data.time, least, most, color=colour, alpha=0.3, linewidth=0)
            (median,) = axes.plot(data.time, middle, color=INK, linewidth=pen(0.8), label="amplitude, median and band")
            (hit,) = axes.plot(
                one.contact, np.full(one.contact.size, top), "|", color=INK, markersize=4, label="contact"
            )
            axes.set_title(f"{model} restitution")
            axes.set_xlim(0, SHOWN)
            axes.set_ylim(-1.1 * top, 1.1 * top)
            label(axes, "y", "Displacement", x.unit)
            right.fill_betweenx(data.level, one.settled_low, one.settled_high, color=colour, alpha=0.25, linewidth=0)
            right.plot(one.settled_median, data.level, color=colour, linestyle=style, label=f"{model}, median and band")
            (thin,) = right.plot(one.settled, data.level, color=colour, linewidth=pen(0.4), label="single run")
        grid["constant"].tick_params(labelbottom=False)
        label(grid["elasto-plastic"], "x", "Time", "s")
        right.plot(data.settled_without, data.level, color=FAINT, linewidth=pen(1.6), label="without damper")
        right.axhline(SETTLED, color=INK, linewidth=pen(0.4), zorder=0)
        right.set_yscale("log")
        right.set_ylim(float(data.level.min()), 1)
        right.set_yticks([0.03, 0.05, 0.1, 0.2, 0.5, 1], minor=False)
        right.set_yticks([], minor=True)
        right.yaxis.set_major_formatter(PercentFormatter(1.0))
        right.set_xlim(0, None)
        label(right, "x", "Time after which it stays below", "s")
        right.set_ylabel("Share of the peak without damper")
        handles = [line for line in right.get_legend_handles_labels()[0] if line.get_label() != "single run"]
        figure.legend(handles=[*handles, thin, hit, moved, median], loc="outside upper left", ncols=3)
    return figure


def _settled(data: xr.Dataset, model: str) -> str:
    one = data.sel(model=model, level=SETTLED)
    return f"{one.settled_median:.1f} s ({one.settled_low:.1f} to {one.settled_high:.1f} s) with {model} restitution"


def _rms(data: xr.Dataset, until: float) -> str:
    median = 100 * data.rms_reduction.sel(until=until, quantile=0.5)
    return " and ".join(f"{float(median.sel(model=model)):.1f} % ({model})" for model in data.model.values)


def _divergence(data: xr.Dataset) -> str:
    """Return a sentence on the time until which the bands have no width."""
    low, _, high = data.amplitude.transpose("quantile", ...)
    width = (high - low).max("model").coarsen(time=25, boundary="trim").mean()
    parted = width.time.values[width > 0.02 * data.peak]
    until = parted[0] if parted.size else data.time.values[-1]
    return (
        f"Up to {until:.1f} s all starts move alike; then a single run may leave its band, which holds four in five. "
    )


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    last = float(data.until[-1])
    bare = float(data.settled_without.sel(level=SETTLED))
    flown, lost = 100 * data.ball_share, 100 * data.impact_share
    return (
        f"Response to a pulse of {AMPLITUDE:g} N, the ball of case 3 touching the leading wall (left: single runs, with the "
        f"medians and bands of displacement and amplitude of {MEMBERS} starts within 1 µm, and the bare structure in grey; "
        f"right: time after which the response stays below a share of the bare structure's peak, "
        f"{1e6 * float(data.peak):.1f} µm). {_divergence(data)}The first peak comes before "
        f"the first contact, {1e3 * float(data.contact.min()):.0f} ms after the pulse. Then the ball takes energy from "
        f"the structure, at times {float(flown.min()):.0f} to {float(flown.max()):.0f} % of all that is left, and the RMS "
        f"of the first {data.until[0]:g} s falls by {_rms(data, float(data.until[0]))}. But it gives the energy back: "
        f"impacts dissipate only {float(lost.sel(model='constant')):.1f} % (constant) and "
        f"{float(lost.sel(model='elasto-plastic')):.2g} % (elasto-plastic, steel or rigid wall) of the work, the RMS of "
        f"{last:g} s falls by {_rms(data, last)}, and the response settles below {100 * SETTLED:g} % after "
        f"{' and '.join(_settled(data, str(model)) for model in data.model.values)}, against {bare:.1f} s without damper."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the verdict on earlier attenuation with the damper."""
    at = data.sel(level=SETTLED)
    bare = float(at.settled_without)
    sooner = bool((at.settled_high < bare).all())
    first, last = float(data.until[0]), float(data.until[-1])
    weaker = float(data.rms_reduction.sel(until=first, quantile=0.1).min()) > 0
    return (
        Claim(
            "With the damper the vibration is attenuated earlier.",
            "section 5.1, figure 11",
            f"the RMS falls by {_rms(data, first)} in {first:g} s, by {_rms(data, last)} in {last:g} s, the peak by "
            f"{abs(100 * float(data.peak_reduction.sel(quantile=0.5).max())):.1f} %; it settles below "
            f"{100 * SETTLED:g} % after {' and '.join(f'{float(time):.1f} s' for time in at.settled_median)}, "
            f"{bare:.1f} s without damper",
            f"case 3 touching the leading wall, {AMPLITUDE:g} N; both models, steel or rigid wall",
            "reproduced" if sooner else "reproduced qualitatively" if weaker else "not reproducible",
        ),
    )


FIGURE = Reproduction(
    number="11",
    title="Response to a weak pulse with and without the damper",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
