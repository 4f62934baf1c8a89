"""Figure R3: the structure with and without the damper after the strong pulse, over the gap and the restitution."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rattlebox import Case, Run, Tsuji
from rattlebox.analysis import settling_time
from rattlebox.plots import FAINT, INK, SERIES_MARKERS, StyledFigure, figure_style, label, pen

from .ensemble import ensemble
from .evidence import critical_speed
from .figure import Reproduction, letters
from .film import Row, film
from .models import ALL_MODELS, COLOURS, CONSTANT_E, MODELS, RIGID, SHORT, STEEL, STYLES, described, model_case, two
from .reference import CONSTANT, DAMPING, GAP, MASS, paper_case
from .runs import simulate

Array = NDArray[np.float64]

GAPS = np.array([0.1, 0.2, 0.4, 0.8, 1.2, 1.6, 2.0, 2.2, 2.3, 2.4, 2.6, 3.0]) * 1e-3
"""Clearances on each side of the centred ball [m]."""
BEST = 2.3e-3
"""Gap of the best damping that does not depend on chance [m]: from 2.4 mm on some starts settle much later."""
RESTITUTIONS = np.array([0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 0.97, 0.98, 0.99])
COMPARED = np.array([GAP, BEST])  # Gaps for which the restitution is varied [m]
SETTLED = 0.05  # Share of the peak without damper at which the motion has settled
UNTIL = 5.0  # Time in which RMS and losses are compared [s]
DURATION, RATE, MEMBERS = 10.0, 500.0, 24
FILMED, FRAMES = 3.0, 600  # Time that the animation shows [s], and its number of positions
MEASURES: Mapping[str, tuple[str, str]] = {
    "loss": ("", "share of the work lost in impacts in 10 s"),
    "settled": ("s", "time after which the displacement stays below 5 % of the peak without damper (10 s if later)"),
    "rms_change": ("", "change of the RMS of the first 5 s by the damper"),
    "held": ("", "loss that the dashpot misses because the ball holds energy, over its loss, first 5 s"),
    "taken": ("", "loss in impacts over loss in viscous damping, first 5 s"),
    "rest": ("m", "RMS displacement of the tenth second"),
}


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

    def spread(make: Callable[..., Case], first: Sequence[Any], second: Sequence[Any], members: int) -> Array:
        """Return 10 %, 50 % and 90 % quantiles of the measures, (quantile, first, second, measure)."""
        runs = [[[compare(run) for run in ensemble(partial(make, a, b), members)] for b in second] for a in first]
        return np.asarray(np.quantile(runs, (0.1, 0.5, 0.9), axis=2))

    gaps = spread(_case, list(ALL_MODELS), GAPS.tolist(), MEMBERS)
    restitutions = spread(_lossy, COMPARED.tolist(), RESTITUTIONS.tolist(), MEMBERS // 2)
    films = [bare, *(simulate(_case(RIGID, gap)) for gap in COMPARED)]
    shown = np.linspace(0, FILMED, FRAMES)

    def filmed(of: Callable[[Run], Array], units: str, text: str) -> tuple[Any, ...]:
        return described(("film", "frame"), [np.interp(shown, compare.time, of(run)) for run in films], units, text)

    over, over_e = ("quantile", "model", "gap"), ("quantile", "compared", "restitution")
    names = ["without damper", *(f"rigid wall, gap {1e3 * gap:.1f} mm" for gap in COMPARED)]
    limits = [critical_speed(model) for model in (STEEL, RIGID)]
    variables = {name: described(over, gaps[..., k], *text) for k, (name, text) in enumerate(MEASURES.items())}
    return xr.Dataset(
        {
            **variables,
            "settled_of_e": described(over_e, restitutions[..., 1], *MEASURES["settled"]),
            "settled_bare": described((), compare.settled(bare), "s", "settling time without damper"),
            "settled_attached": described(
                (), compare.settled(attached), "s", "settling time, ball fixed to the structure"
            ),
            "rest_bare": described((), compare.rms(compare.alone, compare.late), "m", "the same without damper"),
            "peak": described((), compare.peak, "m", "peak without damper"),
            "speed": described((), np.abs(bare.arrays.velocity[:, 0]).max(), "m/s", "largest speed without damper"),
            "critical_speed": described("yielding", limits, "m/s", "speed at which yield begins"),
            "film_structure": filmed(lambda run: run.arrays.displacement[:, 0], "m", "displacement of the structure"),
            "film_ball": filmed(_in_cavity, "m", "position of the ball in its cavity"),
            "film_energy": filmed(
                lambda run: run.ledger.total / run.ledger.work[-1], "", "share of the work that is left"
            ),
        },
        {
            "model": described("model", list(ALL_MODELS), "", "contact model"),
            "gap": described("gap", GAPS, "m", "clearance on each side of the centred ball"),
            "restitution": described("restitution", RESTITUTIONS, "", "constant restitution"),
            "compared": described("compared", COMPARED, "m", "clearance on each side of the centred ball"),
            "yielding": described("yielding", [STEEL, RIGID], "", "contact model"),
            "film": described("film", names, "", "run of the animation"),
            "frame": described("frame", shown, "s", "time"),
            "quantile": described("quantile", [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
        },
    )


def _in_cavity(run: Run) -> Array:
    place = run.arrays.relative_position
    return np.asarray(place[:, 0] if place.shape[1] else np.zeros(len(place)))


def draw(data: xr.Dataset) -> Figure:
    """Draw loss, settling time and RMS over the gap, the balance of energies, and settling over the restitution."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.66)
        grid = figure.subplots(2, 3).ravel()
        loss, settled, rms, balance, lossy, rest = grid
        for k, model in enumerate(MODELS):
            one, colour = data.sel(model=model), COLOURS[model]
            look: dict[str, Any] = {"color": colour, "marker": SERIES_MARKERS[k], "ms": pen(2.5)}
            for axes, name, scale in ((loss, "loss", 100), (settled, "settled", 1), (rms, "rms_change", 100)):
                low, median, high = scale * one[name].values
                axes.fill_between(1e3 * data.gap, low, high, color=colour, alpha=0.2, lw=0)
                axes.plot(1e3 * data.gap, median, label=SHORT[model], ls=STYLES[model], **look)
            middle = one.sel(quantile=0.5).where(one.loss.sel(quantile=0.5) > 0, drop=True)
            balance.plot(middle.held, middle.taken, ls="", **look)
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
            low, median, high = data.settled_of_e.sel(compared=gap).values
            look = {"color": COLOURS[CONSTANT_E], "ls": style, "marker": marker, "ms": pen(2.5)}
            lossy.fill_between(data.restitution, low, high, color=COLOURS[CONSTANT_E], alpha=0.2, lw=0)
            lossy.plot(data.restitution, median, label=f"gap {1e3 * gap:.1f} mm", **look)
        lossy.set(title="Settling to 5 %, constant e", xlabel="Restitution e", ylabel="Time (s)")
        lossy.set(xlim=(0.15, 1.0), ylim=(0, 8))
        lossy.legend(loc="upper left")
        rest.remove()
        letters(figure)
        names = dict(zip(*settled.get_legend_handles_labels()[::-1], strict=True))
        (names["paper's gap"],) = settled.plot([], [], color=FAINT, lw=pen())
        (names["peak without damper"],) = settled.plot([], [], color=FAINT, lw=pen(), ls=":")
        figure.legend(names.values(), names.keys(), loc="lower right", bbox_to_anchor=(0.97, 0.12), fontsize="medium")
    return figure


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    return (
        "After 5 kN only a rigid wall with a wide gap, or a lossy contact, beats the structure alone. (d) The energy decays "
        "faster only if impacts dissipate more than the dashpot misses because the ball holds energy. "
        f"Case 1; medians and 10 to 90 % of {MEMBERS} starts within 1 µm."
    )


def lessons(data: xr.Dataset) -> Sequence[str]:
    """Return what the comparison with the bare structure teaches."""
    middle = data.sel(quantile=0.5).where(data.loss.sel(quantile=0.5) > 0)
    paper, best = middle.sel(gap=GAP), data.sel(model=RIGID, gap=BEST)
    losses, shortest = 100 * paper.loss, middle.settled.min("gap")
    low, median, high = best.settled.values
    ratio = [float(data.speed / limit) for limit in data.critical_speed]

    def percent(values: xr.DataArray) -> str:
        return f"{100 * float(values.min()):.0f} to {100 * float(values.max()):.0f} %"

    balance = [
        f"{percent(middle.held.sel(model=m))} of the dashpot's loss, and impacts add only "
        f"{percent(middle.taken.sel(model=m))}"
        for m in (CONSTANT_E, STEEL)
    ]
    width = 100 * (data.loss.sel(quantile=0.9) - data.loss.sel(quantile=0.1)).sel(gap=GAP) / paper.loss
    scatter = ", ".join(f"{two(width.sel(model=m))} % ({SHORT[m]})" for m in MODELS)
    lossy = data.settled_of_e.sel(quantile=0.5)
    even = np.interp(float(data.settled_bare), lossy.sel(compared=GAP), data.restitution)
    return (
        f"**The paper's damper is useless after 5 kN.** With its gap of {1e3 * GAP:.1f} mm the RMS of the first 5 s "
        "changes by "
        f"at most {100 * float(np.abs(paper.rms_change).max()):.1f} % in every model, and the structure settles to 5 "
        "% after "
        f"{float(paper.settled.min()):.1f} to {float(paper.settled.max()):.1f} s instead of "
        f"{float(data.settled_bare):.2f} s: "
        f"{float(losses.min()):.1f} to {float(losses.max()):.0f} % of the work goes into impacts, the rest into the viscous "
        "damping of 1 %. The ball acts as added mass: welded to the structure it would give "
        f"{float(data.settled_attached):.2f} s.",
        f"**With a steel wall or e = 0.991 no gap helps:** the shortest settling over all gaps is "
        f"{float(shortest.sel(model=CONSTANT_E)):.2f} s (constant e) and {float(shortest.sel(model=STEEL)):.2f} s "
        "(steel wall). "
        "The dashpot does not reach the energy that the ball holds, and the impacts are too elastic to make up for it. With "
        f"constant e this costs {balance[0]}; with a steel wall {balance[1]} (figure R3d).",
        f"**With a rigid wall the gap decides.** A gap of {1e3 * BEST:.1f} mm, just below the peak of "
        f"{1e3 * float(data.peak):.2f} mm, raises the loss from {float(losses.sel(model=RIGID)):.0f} to "
        f"{100 * float(best.loss.sel(quantile=0.5)):.0f} % and settles in {median:.1f} s ({low:.1f} to {high:.1f} s). "
        "From 2.4 mm "
        "on some starts settle much later, and beyond the peak the centred ball is never touched. Below V_c the ball loses "
        "nothing more and shakes the structure: the RMS of the tenth second is "
        f"{1e6 * float(best.rest.sel(quantile=0.5)):.0f} µm "
        f"instead of {1e6 * float(data.rest_bare):.0f} µm.",
        f"**Elasto-plasticity matters only if impacts are several times faster than V_c.** The pulse gives the structure "
        f"{float(data.speed):.3f} m/s: {ratio[0]:.2f} V_c on a steel wall, where nearly every impact is elastic, and "
        f"{ratio[1]:.1f} V_c on a rigid one. The wall, which the paper leaves open in its equations, decides more "
        "than the model.",
        "**The path is chaotic, the loss is not.** Starts within 1 µm move differently after one or two seconds, but "
        "80 % of "
        f"them agree in the loss within {scatter}.",
        f"**A designer should look for a lossy contact first, then for the gap.** A wall with e = 0.6 settles in "
        f"{float(lossy.sel(restitution=0.6, compared=GAP)):.1f} s with the paper's gap and in "
        f"{float(lossy.sel(restitution=0.6, compared=BEST)):.1f} s with {1e3 * BEST:.1f} mm; above e = {even:.2f} the "
        "paper's gap "
        "does harm.",
    )


def animation(data: xr.Dataset) -> str:
    """Return the animation: the structure alone, with the paper's gap, and with the best gap."""
    rows = [
        Row(str(name), one.film_structure.values, one.film_ball.values, one.film_energy.values, float(gap))
        for name, gap in zip(data.film.values, (0.0, *COMPARED), strict=True)
        for one in [data.sel(film=name)]
    ]
    return film(rows, FILMED)


FIGURE = Reproduction(
    number="R3",
    title="With and without the damper, over the gap and the restitution",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    lessons=lessons,
    film=animation,
)
