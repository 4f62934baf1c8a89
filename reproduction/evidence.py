"""Figure R2: ensembles of all models and cases, from which the claims on impacts and losses are judged."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from rattlebox import Case, JacksonGreen, Pair, Run, Thornton, Tsuji, contact_pairs, materials
from rattlebox.plots import SERIES_MARKERS, StyledFigure, label, pen

from .figure import QUANTILES, Reproduction, spread
from .files import simulate
from .judge import AS_READ, SWAPPED, WALLS, Estimate, estimate
from .models import (
    ALL_MODELS,
    COLOURS,
    CONSTANT_E,
    MODELS,
    RIGID,
    SHORT,
    STEEL,
    STIFF,
    STYLES,
    critical_speed,
    lasting,
    model_case,
)
from .system import CONSTANT, START, ensemble, near, paper_case

STRONG, WEAK = 5000.0, 100.0  # amplitudes of the pulses of the paper [N]
MEMBERS, FEWER = 64, 8
"""Runs of an ensemble, and of one with Thornton's contact, which takes twenty times as long."""
DURATION, RATE = 10.0, 500.0  # of the runs [s], and their samples a second [Hz]
WINDOW = 50  # samples of a mean over 0.1 s, one period of the structure
LATE = 2.0  # the time after which the paper compares the smoothness [s]
TIMES = np.round(np.arange(1, 101) * 0.1, 1)
"""Ends of the intervals after the pulse in which impacts are counted [s]."""
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
    every = product(ALL_MODELS, START, (STRONG, WEAK))
    return {
        **{f"{model}, case {k}, {load:g} N": _case(model, START[k], load) for model, k, load in every},
        **{f"{model}, twice as stiff": _stiffer(model) for model in MODELS},
        **{f"Thornton, {wall or 'steel'} wall": _thornton(model) for model, wall in _THORNTON.items()},
        **{f"without damper, {load:g} N": _bare(load) for load in (STRONG, WEAK)},
    }


def envelope(displacement: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the RMS of a motion in windows of one period of the structure."""
    return np.asarray(np.sqrt(np.mean(displacement[1:].reshape(-1, WINDOW) ** 2, axis=1)))


def _measured(run: Run, pair: Pair, limit: float, bare: NDArray[np.float64]) -> dict[str, float]:
    """Return the measures of a run."""
    log, arrays = run.arrays.impacts, run.arrays
    plastic = log.approach_speed > limit
    most = np.flatnonzero(np.cumsum(plastic) > 0.5 * np.arange(1, plastic.size + 1))
    lost = np.cumsum(log.energy_lost)
    half = int(np.searchsorted(lost, lost[-1] / 2)) + 1 if lost.size and lost[-1] > 1e-9 else np.nan
    structure = run.ledger.structure[arrays.time >= LATE]
    shape = arrays.displacement[:, 0]
    stronger = np.flatnonzero(envelope(shape) > bare * (1 + 1e-9))
    return {
        "loss": max(run.ledger.shares["normal"], 0.0),
        "first": float(log.energy_lost[:1].sum() / run.ledger.work[-1]),
        "contacts": plastic.size,
        "plastic_until": float(log.time[most[-1]]) if most.size else 0.0,
        "last_plastic": float(log.time[plastic].max(initial=0.0)),
        "to_half": half,
        "to_half_share": half / max(plastic.size, 1),
        "lowest": float(np.nanmin(log.restitution, initial=1.0)),
        # Only impacts can increase the energy of the structure.
        "returned": float(np.maximum(np.diff(structure), 0).sum() / structure[0]),
        "lasting": float(np.sum(lasting(log, pair))),
        "rms": float(np.sqrt(np.mean(shape[arrays.time <= 5.0] ** 2))),
        "weaker_until": 0.1 * float(stronger[0] if stronger.size else bare.size),
    }


def _plastic_share(runs: Sequence[Run], limit: float) -> NDArray[np.float64]:
    """Return the median share of plastic impacts since the pulse, for each of TIMES."""
    shares = []
    for run in runs:
        log = run.arrays.impacts
        count = np.searchsorted(log.time, TIMES, side="right")
        shares.append(np.append(0, np.cumsum(log.approach_speed > limit))[count] / np.maximum(count, 1))
    return np.asarray(np.quantile(shares, (0.1, 0.5, 0.9), axis=0))


def _losses(case: Callable[..., Case], models: Mapping[str, Any], members: int) -> list[list[float]]:
    runs = [ensemble(partial(case, model), members) for model in models]
    return [[sum(run.ledger.shares.get(k, 0.0) for k in ("normal", "plastic")) for run in each] for each in runs]


def data() -> xr.Dataset:
    """Compute the measures of each run of the ensembles."""
    pulses = (STRONG, WEAK)
    bare = {load: envelope(simulate(_bare(load)).arrays.displacement[:, 0]) for load in pulses}
    measured: list[dict[str, float]] = []
    shares = np.empty((3, len(MODELS), TIMES.size))
    for i, model in enumerate(ALL_MODELS):
        limit, pair = critical_speed(model), contact_pairs(_case(model, 0.0, STRONG), 0)[0]
        for load, start in product(pulses, START.values()):
            runs = ensemble(lambda o, s=start, m=model, a=load: _case(m, near(s, o), a), MEMBERS)  # type: ignore[misc]
            measured += [_measured(run, pair, limit, bare[load]) for run in runs]
            if (load, start) == (STRONG, START[1]) and model in MODELS:
                shares[:, i] = _plastic_share(runs, limit)
    shape = (len(ALL_MODELS), len(pulses), len(START), MEMBERS)
    values = {name: np.reshape([float(one[name]) for one in measured], shape) for name in measured[0]}
    rms = np.median(values["rms"], axis=-1)
    return xr.Dataset(
        {
            **{name: (("model", "pulse", "case", "member"), each) for name, each in values.items()},
            "plastic_share": (("quantile", "shown", "until"), shares),
            "rms_range": (("model", "pulse"), np.ptp(rms, axis=2) / rms.mean(axis=2)),
            "stiffer": (("shown", "member"), _losses(_stiffer, MODELS, MEMBERS)),
            "thornton": (("wall", "fewer"), _losses(_thornton, _THORNTON, FEWER)),
        },
        {
            "model": list(ALL_MODELS),
            "pulse": list(pulses),
            "case": list(START),
            "member": np.arange(MEMBERS),
            "fewer": np.arange(FEWER),
            "shown": list(MODELS),
            "wall": list(_THORNTON),
            "until": TIMES,
            **QUANTILES,
        },
    )


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw the share of plastic impacts over time, and the effect of the start position for both pulses."""
    left, right = figure.subplots(1, 2, width_ratios=(1.4, 1))
    look: dict[str, Any]
    for model in data.shown.values[1:]:
        look = {"ls": STYLES[model], "label": SHORT[model]}
        spread(left, data.until, data.plastic_share.sel(shown=model).values, COLOURS[model], **look)
    left.set(ylim=(0, 1), xlim=(0.1, DURATION), title="Impacts beyond the elastic limit, case 1, 5 kN")
    left.set_ylabel("Share of all impacts\nsince the pulse")
    label(left, "x", "Time since the pulse", "s")
    left.legend(loc="upper right")
    for k, model in enumerate(data.model.values):
        look = {"color": COLOURS[model], "ls": STYLES[model], "marker": SERIES_MARKERS[k], "ms": pen(3)}
        right.plot(data.pulse, data.rms_range.sel(model=model), label=SHORT[model], **look)
    right.set(xscale="log", yscale="log", title="Effect of the start position", xlim=(80, 6300))
    right.set_xticks([WEAK, STRONG], ["100", "5000"])
    right.minorticks_off()
    label(right, "x", "Amplitude of the pulse", "N")
    right.set_ylabel("Range of the RMS over\ncases 1 to 3, over its mean")
    right.legend(loc="lower left")


def _estimates(
    data: xr.Dataset, name: str, case: int = 1, pulse: float = STRONG, scale: float = 1.0
) -> dict[str, Estimate]:
    """Return the estimates of a measure by model."""
    each = scale * data[name].sel(case=case, pulse=pulse)
    return {str(model): estimate(lambda x: x, each.sel(model=model).values) for model in data.model.values}


def _ratio(data: xr.Dataset, name: str) -> dict[str, Estimate]:
    """Return the ratios of a measure of case 1 to its median with constant restitution."""
    each = data[name].sel(case=1, pulse=STRONG)
    constant = each.sel(model=CONSTANT_E).values
    return {m: estimate(lambda x, c: x / c, each.sel(model=m).values, constant) for m in WALLS}


def _drop(one: Any, two: Any, three: Any) -> Any:
    """Return by how much the loss of the worst start is below that of the centred one."""
    return 1 - np.minimum(two, three) / one


def _sensitivity(*cases: Any) -> Any:
    """Return the relative range of a loss over the cases, over that of another loss."""
    one, other = (np.broadcast_arrays(*part) for part in (cases[:3], cases[3:]))
    return (1 - np.minimum.reduce(one) / np.maximum.reduce(one)) / (
        1 - np.minimum.reduce(other) / np.maximum.reduce(other)
    )


def _ranges(*rms: Any) -> Any:
    """Return the range of the RMS over the cases at the weak pulse over that at the strong one, each over its mean."""
    weak, strong = (np.broadcast_arrays(*part) for part in (rms[:3], rms[3:]))
    return (np.ptp(weak, axis=0) / np.mean(weak, axis=0)) / (np.ptp(strong, axis=0) / np.mean(strong, axis=0))


def _text(values: Mapping[str, Estimate], form: str, models: Sequence[str] = tuple(MODELS)) -> str:
    return ", ".join(f"{values[m].value:{form}} ({SHORT[m]})" for m in models)


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return losses, contacts and shares of plastic impacts as text, and the values of all claims."""
    loss, first = _estimates(data, "loss", scale=100), _ratio(data, "first")
    share = 100 * data.plastic_share.sel(quantile=0.5)
    plastic = {m: [f"{float(share.sel(shown=m, until=t)):.0f}" for t in (1.0, DURATION)] for m in (STEEL, RIGID)}
    points = 100 * np.ptp(data.loss.sel(pulse=STRONG).median("member").values, axis=1)
    thornton = 100 * data.thornton.median("fewer")
    constant_e = 0.99117
    loss = _estimates(data, "loss", scale=100)
    strong, weak = data.sel(pulse=STRONG), data.sel(pulse=WEAK)
    models = [str(model) for model in data.model.values]
    lowest = {m: float(strong.lowest.sel(model=m, case=1).min()) for m in WALLS}
    by_case = {m: [strong.loss.sel(model=m, case=k).values for k in START] for m in models}
    drops = {m: estimate(lambda b, a, c: _drop(a, b, c), *(by_case[m][k] for k in (1, 0, 2))) for m in models}
    rms = {m: [pulse.rms.sel(model=m, case=k).values for pulse in (weak, strong) for k in START] for m in models}
    until, lost = (
        {k: _estimates(data, name, k, WEAK, s) for k in (2, 3)} for name, s in (("weaker_until", 1), ("loss", 100))
    )
    contacts = {k: float(weak.contacts.sel(case=k).median("member").min()) for k in START}
    orders = list(product(((AS_READ, 3), (SWAPPED, 2)), ALL_MODELS))
    change = {
        str(m): estimate(lambda a, b: np.abs(a / b - 1), data.stiffer.sel(shown=m).values, by_case[str(m)][0])
        for m in data.shown.values
    }
    return {
        "until": data.plastic_until.sel(pulse=STRONG, case=1, model=RIGID).median("member"),
        "members": MEMBERS,
        "plastic": "; ".join(f"{SHORT[m]} {' and '.join(plastic[m])} %" for m in plastic),
        "contacts": _text(_estimates(data, "contacts"), ".0f"),
        "first": _text(first, ".2g", (STEEL, RIGID)),
        "once": 1 / (1 - constant_e**2),
        "total": 100 / loss[CONSTANT_E].value,
        "loss": _text(loss, ".2g"),
        "points": ", ".join(f"{points[k]:.2g} ({SHORT[m]})" for k, m in enumerate(MODELS)),
        "thornton": [float(thornton.sel(wall=wall)) for wall in (STEEL, RIGID)],
        "walls": _text(loss, ".2g", (STEEL, STIFF)),
        "fast": lowest,
        "vastly": {m: 1 - low for m, low in lowest.items()},
        "predominantly": {m: _estimates(data, "plastic_until")[m] for m in WALLS},
        "steady": {m: _estimates(data, "last_plastic")[m] for m in WALLS},
        "few": _estimates(data, "to_half"),
        "hundred": _ratio(data, "loss"),
        "underestimates": _ratio(data, "loss"),
        "smoother": _ratio(data, "returned"),
        "start": {m: estimate(_sensitivity, *by_case[m], *by_case[CONSTANT_E]) for m in WALLS},
        "half": {m: Estimate(*(100 * x for x in drops[m])) for m in drops},
        "drop": {m: (loss[m].most - loss[m].least) / (loss[m].value * drops[m].value) for m in loss},
        "low_loads": {m: estimate(_ranges, *rms[m]) for m in models},
        "nothing": {(m, order): lost[k][m] for (order, k), m in orders},
        "clearance": (min(contacts[2], contacts[3]), contacts[1]),
        "velocity": {m: max(lost[2][m], lost[3][m]) for m in models},
        "earlier": {(m, order): until[k][m] for (order, k), m in orders},
        "spring": {**change, STIFF: change[RIGID]},
        "chattering": _estimates(data, "lasting"),
    }


FIGURE = Reproduction("evidence", data, draw, 0.42, cases, values)
