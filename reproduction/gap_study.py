"""Figure R3: the structure with and without the damper after the strong pulse, over the gap and the restitution."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from rattlebox import Case, Run, Tsuji
from rattlebox.analysis import settling_time
from rattlebox.plots import FAINT, INK, SERIES_MARKERS, StyledFigure, label, pen

from .figure import QUANTILES, Reproduction, spread
from .files import simulate
from .film import Row, film
from .models import (
    ALL_MODELS,
    COLOURS,
    CONSTANT_E,
    MODELS,
    RIGID,
    SHORT,
    STEEL,
    STYLES,
    critical_speed,
    model_case,
    two,
)
from .system import CONSTANT, DAMPING, GAP, MASS, ensemble, paper_case

Array = NDArray[np.float64]

GAPS = np.array([0.1, 0.2, 0.4, 0.8, 1.2, 1.6, 2.0, 2.2, 2.3, 2.4, 2.6, 3.0]) * 1e-3
"""Clearances on each side of the centred ball [m]."""
BEST = 2.3e-3
"""Gap of the best damping that does not depend on chance [m]: from 2.4 mm on some starts settle much later."""
RESTITUTIONS = np.array([0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 0.97, 0.98, 0.99])
COMPARED = np.array([GAP, BEST])  # gaps for which the restitution is varied [m]
SETTLED = 0.05  # share of the peak without damper at which the motion has settled
UNTIL = 5.0  # time in which RMS and losses are compared [s]
DURATION, RATE, MEMBERS = 10.0, 500.0, 24
FILMED, FRAMES = 3.0, 600  # time that the animation shows [s], and its number of positions
MEASURES = ("loss", "settled", "rms_change", "held", "taken", "rest")


def _case(model: str, gap: float, offset: float = 0.0) -> Case:
    """Return the centred case with another gap, displaced by an offset [m]."""
    return model_case(model, duration=DURATION, rate=RATE).replaced({"damper.gap": gap, "damper.start": offset / gap})


def _lossy(gap: float, restitution: float, offset: float = 0.0) -> Case:
    case = paper_case(Tsuji(restitution=restitution, ending=CONSTANT.ending), duration=DURATION, rate=RATE)
    return case.replaced({"damper.gap": gap, "damper.start": offset / gap})


def _bare(mass: float = MASS) -> Case:
    return paper_case(ball=False, duration=DURATION, rate=RATE).replaced({"structure.mass": mass})


def _attached() -> Case:
    """Return the structure with the ball fixed to it."""
    return _bare(MASS + float(_case(CONSTANT_E, GAP).impact_dampers[0].masses[0]))


def cases() -> Mapping[str, Case]:
    """Return the paper's gap with each model and with another restitution, and the structure without the damper."""
    return {
        **{model: _case(model, GAP) for model in ALL_MODELS},
        "constant restitution, other values": _lossy(GAP, float(RESTITUTIONS[0])),
        "without damper": _bare(),
        "ball attached": _attached(),
    }


class _Comparison:
    """Measures of a run in comparison with the structure alone."""

    def __init__(self, bare: Run) -> None:
        self.time, self.alone = bare.arrays.time, bare.arrays.displacement[:, 0]
        self.peak = float(np.abs(self.alone).max())
        self.early, self.late = self.time <= UNTIL, self.time >= DURATION - 1

    def settled(self, run: Run) -> float:
        found = settling_time(self.time, run.arrays.displacement[:, 0], band=SETTLED, reference=self.peak)
        return DURATION if np.isnan(found) else float(found)

    def rms(self, motion: Array, part: NDArray[np.bool_]) -> float:
        return float(np.sqrt(np.mean(motion[part] ** 2)))

    def __call__(self, run: Run) -> list[float]:
        """Return the measures in the order of MEASURES."""
        motion, ledger, last = run.arrays.displacement[:, 0], run.ledger, int(np.flatnonzero(self.early)[-1])
        viscous = run.arrays.viscous_loss[last]
        # Alone, the structure would lose C/M of its energy per second.
        alone = DAMPING / MASS * np.trapezoid(ledger.total[self.early], self.time[self.early])
        return [
            ledger.shares["normal"],
            self.settled(run),
            self.rms(motion, self.early) / self.rms(self.alone, self.early) - 1,
            alone / viscous - 1,
            ledger.channels["normal"][last] / viscous,
            self.rms(motion, self.late),
        ]


def data() -> xr.Dataset:
    """Compute loss, settling time and RMS for all gaps and models, and for other restitutions."""
    bare, attached = simulate(_bare()), simulate(_attached())
    compare = _Comparison(bare)

    def quantiles(make: Callable[..., Case], first: Sequence[Any], second: Sequence[Any], members: int) -> Array:
        """Return 10 %, 50 % and 90 % quantiles of the measures, (quantile, first, second, measure)."""
        runs = [[[compare(run) for run in ensemble(partial(make, a, b), members)] for b in second] for a in first]
        return np.asarray(np.quantile(runs, (0.1, 0.5, 0.9), axis=2))

    gaps = quantiles(_case, list(ALL_MODELS), GAPS.tolist(), MEMBERS)
    restitutions = quantiles(_lossy, COMPARED.tolist(), RESTITUTIONS.tolist(), MEMBERS // 2)
    films = [bare, *(simulate(_case(RIGID, gap)) for gap in COMPARED)]
    shown = np.linspace(0, FILMED, FRAMES)

    def filmed(of: Callable[[Run], Array]) -> Any:
        return (("film", "frame"), [np.interp(shown, compare.time, of(run)) for run in films])

    return xr.Dataset(
        {
            **{name: (("quantile", "model", "gap"), gaps[..., k]) for k, name in enumerate(MEASURES)},
            "settled_of_e": (("quantile", "compared", "restitution"), restitutions[..., 1]),
            "settled_bare": ((), compare.settled(bare)),
            "settled_attached": ((), compare.settled(attached)),
            "rest_bare": ((), compare.rms(compare.alone, compare.late)),
            "peak": ((), compare.peak),
            "speed": ((), np.abs(bare.arrays.velocity[:, 0]).max()),
            "critical_speed": ("yielding", [critical_speed(model) for model in (STEEL, RIGID)]),
            "film_structure": filmed(lambda run: run.arrays.displacement[:, 0]),
            "film_ball": filmed(_in_cavity),
            "film_energy": filmed(lambda run: run.ledger.total / run.ledger.work[-1]),
        },
        {
            "model": list(ALL_MODELS),
            "gap": GAPS,
            "restitution": RESTITUTIONS,
            "compared": COMPARED,
            "yielding": [STEEL, RIGID],
            "film": ["without damper", *(f"rigid wall, gap {1e3 * gap:.1f} mm" for gap in COMPARED)],
            "frame": shown,
            **QUANTILES,
        },
    )


def _in_cavity(run: Run) -> Array:
    place = run.arrays.relative_position
    return np.asarray(place[:, 0] if place.shape[1] else np.zeros(len(place)))


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw loss, settling time and RMS over the gap, the balance of energies, and settling over the restitution."""
    loss, settled, rms, balance, lossy, rest = figure.subplots(2, 3).ravel()
    for k, model in enumerate(MODELS):
        one, colour = data.sel(model=model), COLOURS[model]
        look: dict[str, Any] = {"marker": SERIES_MARKERS[k], "ms": pen(2.5)}
        named = {"label": SHORT[model], "ls": STYLES[model], **look}
        for axes, name, scale in ((loss, "loss", 100), (settled, "settled", 1), (rms, "rms_change", 100)):
            spread(axes, 1e3 * data.gap, scale * one[name].values, colour, alpha=0.2, **named)
        middle = one.sel(quantile=0.5).where(one.loss.sel(quantile=0.5) > 0, drop=True)
        balance.plot(middle.held, middle.taken, ls="", color=colour, **look)
    loss.set(title="Lost in impacts", ylabel="Share of the work (%)")
    settled.set(title="Settling to 5 %", ylabel="Time (s)", ylim=(0, 8))
    rms.set(title="RMS of the first 5 s", ylabel="Change by the damper (%)")
    for axes in (loss, settled, rms):
        axes.set_xlim(0, 3)
        label(axes, "x", "Gap", "mm")
        axes.axvline(1e3 * GAP, color=FAINT, lw=pen(), zorder=0)
        axes.axvline(1e3 * float(data.peak), color=FAINT, lw=pen(), ls=":", zorder=0)
    for axes in (settled, lossy):
        axes.axhline(float(data.settled_bare), color=INK, lw=pen(), label="without damper")
    settled.axhline(float(data.settled_attached), color=INK, lw=pen(), ls=(0, (1, 1.2)), label="ball attached")
    rms.axhline(0, color=INK, lw=pen())
    held = data.held.where(data.loss > 0)
    line = np.array([float(held.min()), float(held.max())])
    balance.plot(line, line, color=INK, lw=pen(0.8))
    balance.text(0.052, 0.9, "faster decay\nabove the line", fontsize="small", va="top")
    balance.set(xscale="log", yscale="log", title="What decides", xlim=(0.05, 0.4), ylim=(1e-3, 1.5))
    balance.set(xlabel="Loss that the dashpot misses\nover its loss", ylabel="Impact loss over\nthe dashpot's loss")
    balance.set_xticks([0.1, 0.2, 0.3], ["0.1", "0.2", "0.3"])
    balance.minorticks_off()
    for gap, style, marker in zip(data.compared.values, ("-", (0, (5, 1.5))), "oD", strict=True):
        look = {"ls": style, "marker": marker, "ms": pen(2.5), "label": f"gap {1e3 * gap:.1f} mm"}
        values = data.settled_of_e.sel(compared=gap).values
        spread(lossy, data.restitution, values, COLOURS[CONSTANT_E], alpha=0.2, **look)
    lossy.set(title="Settling to 5 %, constant e", xlabel="Restitution e", ylabel="Time (s)")
    lossy.set(xlim=(0.15, 1.0), ylim=(0, 8))
    lossy.legend(loc="upper left")
    rest.remove()
    names = dict(zip(*settled.get_legend_handles_labels()[::-1], strict=True))
    (names["paper's gap"],) = settled.plot([], [], color=FAINT, lw=pen())
    (names["peak without damper"],) = settled.plot([], [], color=FAINT, lw=pen(), ls=":")
    figure.legend(names.values(), names.keys(), loc="lower right", bbox_to_anchor=(0.97, 0.12), fontsize="medium")


def _percent(values: xr.DataArray) -> str:
    return f"{100 * float(values.min()):.0f} to {100 * float(values.max()):.0f} %"


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return what the comparison with the bare structure teaches."""
    middle = data.sel(quantile=0.5).where(data.loss.sel(quantile=0.5) > 0)
    paper, best = middle.sel(gap=GAP), data.sel(model=RIGID, gap=BEST)
    losses, shortest = 100 * paper.loss, middle.settled.min("gap")
    width = 100 * (data.loss.sel(quantile=0.9) - data.loss.sel(quantile=0.1)).sel(gap=GAP) / paper.loss
    lossy = data.settled_of_e.sel(quantile=0.5)
    even = np.interp(float(data.settled_bare), lossy.sel(compared=GAP), data.restitution)
    return {
        "members": MEMBERS,
        "gap": 1e3 * GAP,
        "best": 1e3 * BEST,
        "change": 100 * float(np.abs(paper.rms_change).max()),
        "settled": [float(paper.settled.min()), float(paper.settled.max())],
        "losses": [float(losses.min()), float(losses.max())],
        "shortest": [float(shortest.sel(model=model)) for model in (CONSTANT_E, STEEL)],
        "held": [_percent(middle.held.sel(model=model)) for model in (CONSTANT_E, STEEL)],
        "taken": [_percent(middle.taken.sel(model=model)) for model in (CONSTANT_E, STEEL)],
        "peak": 1e3 * data.peak,
        "loss": [float(losses.sel(model=RIGID)), 100 * float(best.loss.sel(quantile=0.5))],
        "time": best.settled.values,
        "rest": [1e6 * float(best.rest.sel(quantile=0.5)), 1e6 * float(data.rest_bare)],
        "ratio": (data.speed / data.critical_speed).values,
        "scatter": ", ".join(f"{two(width.sel(model=m))} % ({SHORT[m]})" for m in MODELS),
        "lossy": [float(lossy.sel(restitution=0.6, compared=gap)) for gap in (GAP, BEST)],
        "even": even,
    }


def animation(data: xr.Dataset) -> str:
    """Return the animation: the structure alone, with the paper's gap, and with the best gap."""
    rows = []
    for name, gap in zip(data.film.values, (0.0, *COMPARED), strict=True):
        one = data.sel(film=name)
        rows.append(Row(name, one.film_structure.values, one.film_ball.values, one.film_energy.values, float(gap)))
    return film(rows, FILMED)


FIGURE = Reproduction("gap_study", data, draw, 0.66, cases, values, film=animation)
