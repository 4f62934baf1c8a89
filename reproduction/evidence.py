"""Figure R2: ensembles of all models and cases, from which the claims on impacts and losses are judged."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import product
from math import inf
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rattlebox import Case, JacksonGreen, Pair, Run, Thornton, Tsuji, contact_pairs, materials
from rattlebox.plots import SERIES_MARKERS, StyledFigure, figure_style, label, pen

from .ensemble import ensemble, near
from .figure import Reproduction, letters
from .judge import AS_READ, HEDGED, SWAPPED, Claim, Estimate, about, by_wall, estimate, exact, size_of
from .models import ALL_MODELS, COLOURS, CONSTANT_E, MODELS, RIGID, SHORT, STEEL, STIFF, STYLES, described, model_case
from .reference import CONSTANT, START, paper_case
from .runs import simulate

STRONG, WEAK = 5000.0, 100.0  # Amplitudes of the pulses of the paper [N]
MEMBERS, FEWER = 64, 8  # Runs of an ensemble, and of one with Thornton's contact, which takes twenty times as long
DURATION, RATE = 10.0, 500.0  # Of the runs [s], and their samples a second [Hz]
WINDOW = 50  # Samples of a mean over 0.1 s, one period of the structure
LATE, FEW = 2.0, 10
"""The time after which the paper compares the smoothness [s], and the number of contacts that are still a few."""
TIMES = np.round(np.arange(1, 101) * 0.1, 1)  # Ends of the intervals after the pulse in which impacts are counted [s]
_LASTING = 5.0  # A contact lasts if it takes this many times as long as an elastic collision at its speed
_THORNTON = {STEEL: None, RIGID: "rigid"}


def _case(model: str, start: float, amplitude: float) -> Case:
    return model_case(model, start=start, amplitude=amplitude, duration=DURATION, rate=RATE)


def _stiffer(model: str, offset: float = 0.0) -> Case:
    """Return case 1 with twice the contact stiffness and the same elastic limit."""
    contact = ALL_MODELS[model].contact
    if model == STEEL:  # the rigid wall divides V_c by 4, and V_c grows as the yield stress to the power 5/2
        strength = (materials()["steel"].yield_stress or 0.0) * 4**0.4
        contact = Tsuji(restitution=JacksonGreen(yield_stress=strength), ending=CONSTANT.ending)
    return paper_case(contact, start=near(0.0, offset), wall="rigid", times=[DURATION])


def _thornton(model: str, offset: float = 0.0) -> Case:
    return paper_case(Thornton(), start=near(0.0, offset), wall=_THORNTON[model], times=[DURATION])  # type: ignore[arg-type]


def _bare(amplitude: float) -> Case:
    return paper_case(ball=False, amplitude=amplitude, duration=DURATION, rate=RATE)


def cases() -> Mapping[str, Case]:
    """Return the cases of all models and starts under both pulses, and the variants that they are compared with."""
    return {
        **{
            f"{model}, case {k}, {load:g} N": _case(model, START[k], load)
            for model, k, load in product(ALL_MODELS, START, (STRONG, WEAK))
        },
        **{f"{model}, twice as stiff": _stiffer(model) for model in MODELS},
        **{f"Thornton, {wall or 'steel'} wall": _thornton(model) for model, wall in _THORNTON.items()},
        **{f"without damper, {load:g} N": _bare(load) for load in (STRONG, WEAK)},
    }


def critical_speed(model: str) -> float:
    """Return the speed at which yield begins in a model [m/s], infinite with constant restitution."""
    law = ALL_MODELS[model].contact.restitution
    pair = contact_pairs(_case(model, 0.0, STRONG), 0)[0]
    return law.critical_speed(pair) if isinstance(law, JacksonGreen) else inf


def envelope(displacement: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the RMS of a motion in windows of one period of the structure."""
    return np.asarray(np.sqrt(np.mean(displacement[1:].reshape(-1, WINDOW) ** 2, axis=1)))


_MEASURES: Mapping[str, tuple[str, str]] = {
    "loss": ("", "share of the work lost in impacts in 10 s"),
    "first": ("", "share of the work lost in the first contact"),
    "contacts": ("", "contacts in 10 s"),
    "plastic_until": ("s", "time until which most impacts are plastic"),
    "last_plastic": ("s", "time of the last plastic impact"),
    "to_half": ("", "contacts that take half of the loss"),
    "to_half_share": ("", "share of the contacts that take half of the loss"),
    "lowest": ("", "lowest restitution"),
    "returned": ("", "energy that impacts return to the structure after 2 s over its energy then"),
    "lasting": ("", "contacts that last"),
    "rms": ("m", "RMS displacement of the first 5 s"),
    "weaker_until": ("s", "time until which the motion is weaker than without the damper"),
}


def _measured(run: Run, pair: Pair, limit: float, bare: NDArray[np.float64]) -> list[float]:
    """Return the measures of a run, in the order of _MEASURES."""
    log, arrays = run.arrays.impacts, run.arrays
    plastic = log.approach_speed > limit
    most = np.flatnonzero(np.cumsum(plastic) > 0.5 * np.arange(1, plastic.size + 1))
    lost = np.cumsum(log.energy_lost)
    half = int(np.searchsorted(lost, lost[-1] / 2)) + 1 if lost.size and lost[-1] > 1e-9 else np.nan
    structure = run.ledger.structure[arrays.time >= LATE]
    speed = np.maximum(log.approach_speed, 1e-12)
    collision = 2.9432752 * (1.25 * pair.mass * speed**2 / pair.hertz_stiffness) ** 0.4 / speed
    shape = arrays.displacement[:, 0]
    stronger = np.flatnonzero(envelope(shape) > bare * (1 + 1e-9))
    return [
        max(run.ledger.shares["normal"], 0.0),
        float(log.energy_lost[:1].sum() / run.ledger.work[-1]),
        plastic.size,
        float(log.time[most[-1]]) if most.size else 0.0,
        float(log.time[plastic].max(initial=0.0)),
        half,
        half / max(plastic.size, 1),
        float(np.nanmin(log.restitution, initial=1.0)),
        # Only impacts can increase the energy of the structure.
        float(np.maximum(np.diff(structure), 0).sum() / structure[0]),
        float(np.sum(log.duration > _LASTING * collision)),
        float(np.sqrt(np.mean(shape[arrays.time <= 5.0] ** 2))),
        0.1 * float(stronger[0] if stronger.size else bare.size),
    ]


def _plastic_share(runs: Sequence[Run], limit: float) -> NDArray[np.float64]:
    """Return the median share of plastic impacts since the pulse, for each of TIMES."""
    shares = []
    for run in runs:
        log = run.arrays.impacts
        count = np.searchsorted(log.time, TIMES, side="right")
        shares.append(np.append(0, np.cumsum(log.approach_speed > limit))[count] / np.maximum(count, 1))
    return np.asarray(np.quantile(shares, (0.1, 0.5, 0.9), axis=0))


def data() -> xr.Dataset:
    """Compute the measures of each run of the ensembles."""
    pulses = (STRONG, WEAK)
    bare = {load: envelope(simulate(_bare(load)).arrays.displacement[:, 0]) for load in pulses}
    values = np.empty((len(ALL_MODELS), len(pulses), len(START), MEMBERS, len(_MEASURES)))
    shares = np.empty((3, len(MODELS), TIMES.size))
    for i, model in enumerate(ALL_MODELS):
        limit, pair = critical_speed(model), contact_pairs(_case(model, 0.0, STRONG), 0)[0]
        for j, load in enumerate(pulses):
            for k, start in enumerate(START.values()):
                runs = ensemble(lambda o, s=start, m=model, a=load: _case(m, near(s, o), a), MEMBERS)  # type: ignore[misc]
                values[i, j, k] = [_measured(run, pair, limit, bare[load]) for run in runs]
                if (load, k) == (STRONG, 0) and model in MODELS:
                    shares[:, i] = _plastic_share(runs, limit)
    over = ("model", "pulse", "case", "member")
    measured = {
        name: described(over, values[..., n], unit, text) for n, (name, (unit, text)) in enumerate(_MEASURES.items())
    }
    rms = measured["rms"][1]
    range_of_rms = np.ptp(np.median(rms, axis=-1), axis=2) / np.median(rms, axis=-1).mean(axis=2)

    def losses(case: Callable[..., Case], models: Mapping[str, Any], members: int = MEMBERS) -> list[list[float]]:
        runs = [ensemble(partial(case, model), members) for model in models]
        return [
            [sum(run.ledger.shares.get(name, 0.0) for name in ("normal", "plastic")) for run in each] for each in runs
        ]

    return xr.Dataset(
        {
            **measured,
            "plastic_share": described(
                ("quantile", "shown", "until"), shares, "", "share of plastic impacts since the pulse, case 1, 5 kN"
            ),
            "rms_range": described(
                ("model", "pulse"), range_of_rms, "", "difference of the RMS between the cases over their mean"
            ),
            "stiffer": described(
                ("shown", "member"),
                losses(_stiffer, MODELS),
                "",
                "share lost in case 1 with twice the contact stiffness",
            ),
            "thornton": described(
                ("wall", "fewer"),
                losses(_thornton, _THORNTON, FEWER),
                "",
                "share lost in case 1 with Thornton's contact",
            ),
        },
        {
            "model": described("model", list(ALL_MODELS), "", "contact model"),
            "pulse": described("pulse", list(pulses), "N", "amplitude of the pulse"),
            "case": described("case", list(START), "", "case: 1 centred, 2 trailing wall, 3 leading wall"),
            "member": described("member", np.arange(MEMBERS), "", "number of the start within a micrometre"),
            "fewer": described("fewer", np.arange(FEWER), "", "number of the start within a micrometre"),
            "shown": described("shown", list(MODELS), "", "contact model"),
            "wall": described("wall", list(_THORNTON), "", "interpretation with the same elastic limit"),
            "until": described("until", TIMES, "s", "time since the pulse"),
            "quantile": described("quantile", [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
        },
    )


def draw(data: xr.Dataset) -> Figure:
    """Draw the share of plastic impacts over time, and the effect of the start position for both pulses."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.42)
        left, right = figure.subplots(1, 2, width_ratios=(1.4, 1))
        for model in data.shown.values[1:]:
            low, median, high = data.plastic_share.sel(shown=model).values
            left.fill_between(data.until, low, high, color=COLOURS[model], alpha=0.25, lw=0)
            left.plot(data.until, median, color=COLOURS[model], ls=STYLES[model], label=SHORT[model])
        left.set(ylim=(0, 1), xlim=(0.1, DURATION), title="Impacts beyond the elastic limit, case 1, 5 kN")
        left.set_ylabel("Share of all impacts\nsince the pulse")
        label(left, "x", "Time since the pulse", "s")
        left.legend(loc="upper right")
        for k, model in enumerate(data.model.values):
            right.plot(
                data.pulse, data.rms_range.sel(model=model), color=COLOURS[model], ls=STYLES[model],
                marker=SERIES_MARKERS[k], ms=pen(3), label=SHORT[model],
            )  # fmt: skip
        right.set(xscale="log", yscale="log", title="Effect of the start position", xlim=(80, 6300))
        right.set_xticks([WEAK, STRONG], ["100", "5000"])
        right.minorticks_off()
        label(right, "x", "Amplitude of the pulse", "N")
        right.set_ylabel("Range of the RMS over\ncases 1 to 3, over its mean")
        right.legend(loc="lower left")
        letters(figure)
    return figure


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    until = data.plastic_until.sel(pulse=STRONG, case=1).median("member")
    return (
        f"With a rigid wall most impacts are plastic for {float(until.sel(model=RIGID)):.1f} s; with a steel wall they are "
        f"the exception. (b) The start position changes the motion much more after a weak pulse. {MEMBERS} starts within "
        "1 µm: medians, and in (a) 10 to 90 %."
    )


def _cells(
    data: xr.Dataset, name: str, case: int = 1, pulse: float = STRONG, scale: float = 1.0
) -> dict[str, Estimate]:
    """Return the estimates of a measure by model."""
    each = scale * data[name].sel(case=case, pulse=pulse)
    return {str(model): estimate(lambda x: x, each.sel(model=model).values) for model in data.model.values}


def _plastic(data: xr.Dataset, name: str) -> dict[str, Estimate]:
    """Return the estimates of a measure of the elasto-plastic models, case 1 after the strong pulse."""
    return {model: value for model, value in _cells(data, name).items() if model != CONSTANT_E}


def _ratio(data: xr.Dataset, name: str) -> dict[str, Estimate]:
    """Return the ratios of a measure of case 1 to its median with constant restitution."""
    each = data[name].sel(case=1, pulse=STRONG)
    constant = each.sel(model=CONSTANT_E).values
    return {m: estimate(lambda x, c: x / c, each.sel(model=m).values, constant) for m in (STEEL, RIGID, STIFF)}


def _drop(one: Any, two: Any, three: Any) -> Any:
    return 1 - np.minimum(two, three) / one


def _drops(data: xr.Dataset) -> dict[str, Estimate]:
    """Return by how much the loss of the worst start is below that of the centred one."""
    loss = data.loss.sel(pulse=STRONG)
    return {
        str(m): estimate(lambda b, a, c: _drop(a, b, c), *(loss.sel(model=m, case=k).values for k in (2, 1, 3)))
        for m in data.model.values
    }


def _sensitivity(data: xr.Dataset) -> dict[str, Estimate]:
    """Return the relative range of the loss over the cases, over that of constant restitution."""
    loss = data.loss.sel(pulse=STRONG)

    def span(*cases: Any) -> Any:
        return 1 - np.minimum.reduce(np.broadcast_arrays(*cases)) / np.maximum.reduce(np.broadcast_arrays(*cases))

    def both(*cases: Any) -> Any:
        return span(*cases[:3]) / span(*cases[3:])

    constant = [loss.sel(model=CONSTANT_E, case=k).values for k in START]
    return {
        m: estimate(both, *(loss.sel(model=m, case=k).values for k in START), *constant) for m in (STEEL, RIGID, STIFF)
    }


def _ranges(data: xr.Dataset) -> dict[str, Estimate]:
    """Return the range of the RMS over the cases at the weak pulse over that at the strong one, each over its mean."""

    def both(*rms: Any) -> Any:
        weak, strong = (np.broadcast_arrays(*part) for part in (rms[:3], rms[3:]))
        return (np.ptp(weak, axis=0) / np.mean(weak, axis=0)) / (np.ptp(strong, axis=0) / np.mean(strong, axis=0))

    return {
        str(m): estimate(
            both, *(data.rms.sel(model=m, case=k, pulse=load).values for load in (WEAK, STRONG) for k in START)
        )
        for m in data.model.values
    }


def _text(values: Mapping[str, Estimate], form: str, models: Sequence[str] = tuple(MODELS)) -> str:
    return ", ".join(f"{values[m].value:{form}} ({SHORT[m]})" for m in models)


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the claims on impacts, losses and start positions."""
    loss = _cells(data, "loss", scale=100)
    lowest = data.lowest.sel(pulse=STRONG)
    constant_e = 0.99117
    share = 100 * data.plastic_share.sel(quantile=0.5)
    plastic = {m: [f"{float(share.sel(shown=m, until=t)):.0f}" for t in (1.0, DURATION)] for m in (STEEL, RIGID)}
    shares = "; ".join(f"{SHORT[m]} {' and '.join(plastic[m])} %" for m in plastic)
    weak_loss = {k: _cells(data, "loss", k, WEAK, 100) for k in (2, 3)}
    contacts = {k: float(data.contacts.sel(pulse=WEAK, case=k).median("member").min()) for k in START}
    points = {
        str(m): float(np.ptp([100 * float(data.loss.sel(pulse=STRONG, model=m, case=k).median()) for k in START]))
        for m in data.model.values
    }
    drops = _drops(data)
    scatter = {m: exact((loss[m].most - loss[m].least) / (loss[m].value * drops[m].value)) for m in loss}
    strong = data.loss.sel(pulse=STRONG, case=1)
    change = {
        str(m): estimate(lambda a, b: np.abs(a / b - 1), data.stiffer.sel(shown=m).values, strong.sel(model=m).values)
        for m in data.shown.values
    }
    thornton = 100 * data.thornton.median("fewer")
    until = {k: _cells(data, "weaker_until", k, WEAK) for k in (2, 3)}
    ordered = {AS_READ: 3, SWAPPED: 2}
    return (
        Claim(
            "Impulse loads bring fast impacts, whose low restitution possibly explains the faster loss.",
            "section 5.1",
            "lowest restitution after 5 kN, case 1",
            by_wall({m: exact(lowest.sel(model=m, case=1).min()) for m in (STEEL, RIGID, STIFF)}),
            accept=(-inf, constant_e),
            note="the limit is the constant model's e",
            see="5",
        ),
        Claim(
            "The restitution differs vastly from contact to contact.",
            "conclusion 2, figure 5",
            "range of the restitution after 5 kN, case 1",
            by_wall({m: exact(1 - lowest.sel(model=m, case=1).min()) for m in (STEEL, RIGID, STIFF)}),
            accept=(0.1, inf),
            partly=(1 - constant_e, inf),
            note="“vastly” is read as at least 0.1; qualitatively, as more than the constant model loses, 1 - e = 0.009",
            see="5",
        ),
        Claim(
            "The particle collisions are predominantly plastic.",
            "section 6.1",
            "time until which most impacts since the pulse are plastic, case 1, 5 kN (s)",
            by_wall(_plastic(data, "plastic_until")),
            accept=(DURATION, inf),
            partly=(1.0, inf),
            note=f"plastic in the first second and in 10 s: {shares}; the paper prints no duration",
        ),
        Claim(
            "The time is too short to reach the steady state.",
            "section 6.1",
            "last plastic impact, case 1, 5 kN (s)",
            by_wall(_plastic(data, "last_plastic")),
            accept=(DURATION, inf),
            partly=(LATE, inf),
            note="afterwards the ball only exchanges energy without loss; 2 s is the only time that the paper prints",
        ),
        Claim(
            "With the elasto-plastic model a few contacts take most of the energy, and little is lost later.",
            "section 5.1, figure 7c",
            "contacts that take half of the loss, case 1, 5 kN",
            by_wall(_cells(data, "to_half")),
            accept=(0, FEW),
            partly=(0, 2 * FEW),
            note=f"of {_text(_cells(data, 'contacts'), '.0f')} contacts in 10 s",
            see="7c",
        ),
        Claim(
            "The damper dissipates faster, around 100 times, than with constant restitution.",
            "section 5.1, figure 7c",
            "loss in 10 s over that with constant restitution, case 1, 5 kN",
            by_wall(_ratio(data, "loss")),
            printed="100",
            accept=about(100),
            partly=size_of(100),
            note=f"in the first contact {_text(_ratio(data, 'first'), '.2g', (STEEL, RIGID))} times; no restitution "
            "law could exceed "
            f"{1 / (1 - constant_e**2):.0f} there, and {100 / loss[CONSTANT_E].value:.0f} in 10 s",
            see="7c",
        ),
        Claim(
            "Constant restitution underestimates the dissipated energy.",
            "conclusion 2, figures 7a to 7c",
            "loss in 10 s over that with constant restitution, case 1, 5 kN",
            by_wall(_ratio(data, "loss")),
            accept=(1, inf),
            note=f"share of the work: {_text(loss, '.2g')} %",
            see="7c",
        ),
        Claim(
            "After 2 s the structure's energy is smoother with the elasto-plastic model.",
            "section 5.1, figures 7a and 7b",
            "energy returned by impacts after 2 s over the structure's, relative to constant restitution",
            by_wall(_ratio(data, "returned")),
            accept=(-inf, 1 - HEDGED),
            note="a value of 1 means no difference; smoother is read as at least 10 % less",
            see="7a",
        ),
        Claim(
            "Dissipation depends more on the start with the elasto-plastic model than with constant restitution.",
            "section 5.1, figure 7d",
            "relative range of the loss over the three cases, over that with constant restitution, 5 kN",
            by_wall(_sensitivity(data)),
            accept=(1, inf),
            note=f"in points of the work the range is {', '.join(f'{points[m]:.2g} ({SHORT[m]})' for m in MODELS)}",
            see="7d",
        ),
        Claim(
            "A deviation of 0.4 mm lowers the dissipated energy by nearly 50 %.",
            "section 6.1, figure 7e",
            "reduction of the loss of the worst start against case 1, 5 kN (%)",
            by_wall({m: Estimate(*(100 * x for x in drops[m])) for m in drops}),
            printed="50 %",
            accept=about(50),
            partly=size_of(50),
            scope="both",
            note="0.4 mm is the whole clearance d_0",
            see="7e",
        ),
        Claim(
            "That drop is chaotic motion.",
            "section 6.1, figure 7e",
            "scatter of the loss over starts within 1 µm, over that drop",
            by_wall(scatter),
            accept=(0.5, inf),
            scope="both",
            note="the path cannot be predicted, the loss can: chaos does not decide about the dissipation at 5 kN",
            see="7e",
        ),
        Claim(
            "The motion depends on the start particularly at low loads.",
            "section 5.1, figure 9",
            "range of the RMS over the three cases at 100 N, over that at 5 kN",
            by_wall(_ranges(data)),
            accept=(1, inf),
            scope="both",
            note="this compares the cases; the growth of small deviations is the claim on chaos",
        ),
        Claim(
            "After 100 N the damper of case 3 dissipates nothing.",
            "section 5.1",
            "loss in impacts, case 3, 100 N (% of the work)",
            {(m, order): weak_loss[k][m] for order, k in ordered.items() for m in ALL_MODELS},
            accept=(-1e-9, 1e-9),
            note="all approach speeds are below V_c, so that e = 1",
            see="9a",
        ),
        Claim(
            "It dissipates nothing because the response is less than the clearance.",
            "section 5.1",
            "contacts in 10 s after 100 N, in case 3 as printed and in case 1",
            {("printed", ""): exact(min(contacts[2], contacts[3])), ("corrected", ""): exact(contacts[1])},
            accept=(0, 0),
            kind="misprint",
            note="the reason holds for case 1; the statement above holds for another reason",
            see="9a",
        ),
        Claim(
            "In cases 2 and 3 the relative velocity falls because collisions lose energy.",
            "section 5.1, figure 9a",
            "loss in impacts after 100 N, the larger of both cases (% of the work)",
            by_wall({m: max(weak_loss[2][m], weak_loss[3][m]) for m in ALL_MODELS}),
            accept=(50, inf),
            partly=(1, inf),
            scope="both",
            note="the viscous damper takes the rest; elasto-plastic impacts of this pulse lose nothing",
            see="9a",
        ),
        Claim(
            "With the damper the vibration is attenuated earlier.",
            "section 5.1, figure 11",
            "time until which the motion is weaker than without damper, case 3, 100 N (s)",
            {(m, order): until[k][m] for order, k in ordered.items() for m in ALL_MODELS},
            accept=(4.75, inf),
            partly=(0.5, inf),
            scope="both",
            note="the structure alone falls below 5 % of its peak after 4.75 s; with the damper it does so later",
            see="11",
        ),
        Claim(
            "The nonlinear spring of the contact does not show.",
            "section 6.1",
            "relative change of the loss if the contact is twice as stiff, case 1, 5 kN",
            by_wall({**change, STIFF: change[RIGID]}),
            accept=(0, 0.1),
            scope="both",
        ),
        Claim(
            "The wide band of frequencies is possibly due to chattering (sustained contacts).",
            "section 5.1, figure 10",
            "contacts in 10 s that last longer than five collisions, case 1, 5 kN",
            by_wall(_cells(data, "lasting")),
            accept=(1, inf),
            scope="both",
            note="the ball rattles from wall to wall; each contact is a single collision",
            see="10",
        ),
        Claim(
            "The elasto-plastic model predicts the energy loss accurately.",
            "abstract, section 6",
            "nothing is measured in the paper",
            kind="unchecked",
            note=f"Thornton's contact with the same elastic limit loses {float(thornton.sel(wall=STEEL)):.2f} % "
            "(steel wall) and "
            f"{float(thornton.sel(wall=RIGID)):.1f} % (rigid) of the work instead of {_text(loss, '.2g', (STEEL, STIFF))} %",
            see="5",
        ),
    )  # fmt: skip


FIGURE = Reproduction(
    number="R2",
    title="Ensembles of all models",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
