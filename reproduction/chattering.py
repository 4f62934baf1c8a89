"""Figure A4: chattering over time, and the loads at which it ends in a lasting contact."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from math import pi
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rattlebox import Case, JacksonGreen, Run, contact_pairs
from rattlebox.analysis import impacts_per_cycle
from rattlebox.plots import FAINT, INK, SERIES_MARKERS, StyledFigure, figure_style, pen

from .ensemble import band, ensemble
from .figure import Reproduction, letters
from .harmonic import harmonic_case, resonance, riding
from .judge import Claim, by_wall, exact
from .models import COLOURS, CONSTANT_E, MODELS, RIGID, SHORT, STYLES, described, two
from .reference import GAP
from .runs import simulate_many

SHOWN = CONSTANT_E, RIGID
LOAD = 500.0  # Of the runs shown in time [N]
LOADS = np.array([50.0, 100.0, 200.0, 300.0, 375.0, 400.0, 500.0, 600.0])  # Of the runs that are counted [N]
CYCLES, COUNTED, DRAWN = 16, 8, 1.25
"""Length of each run, of its part that is counted and of its part that is drawn [cycles]."""
SAMPLES = 2500
MEMBERS = 6
_LASTING = 5.0  # A contact lasts when it takes that many times as long as the collision of its speed


def _case(model: str, amplitude: float, offset: float = 0.0) -> Case:
    """Return a case at resonance that starts on the steady motion, so that it settles in few cycles."""
    frequency = resonance()
    end = CYCLES / frequency
    return harmonic_case(
        MODELS[model],
        amplitude=amplitude,
        frequency=frequency,
        state=riding(amplitude, frequency, 0.9 * GAP + offset),
        duration=end,
        times=tuple(np.linspace(end - DRAWN / frequency, end, SAMPLES)) if amplitude == LOAD else (0.0,),
    )


def cases() -> Mapping[str, Case]:
    """Return the runs drawn over time, and those at the smallest load of the counts."""
    shown = {f"{model}, {LOAD:g} N": _case(model, LOAD) for model in MODELS}
    return shown | {f"{model}, {LOADS[0]:g} N": _case(model, float(LOADS[0])) for model in MODELS}


def data() -> xr.Dataset:
    """Compute contacts of all models at all loads, and motion and impacts at one load."""
    runs = simulate_many([_case(model, float(load)) for model in MODELS for load in LOADS])
    grid = [runs[k : k + LOADS.size] for k in range(0, len(runs), LOADS.size)]
    shown = [
        row[int(np.flatnonzero(LOADS == LOAD)[0])] for row, model in zip(grid, MODELS, strict=True) if model in SHOWN
    ]
    begin = float(shown[0].arrays.time[1])
    hits = _padded([_hits(run, begin) for run in shown])
    ensembles = [[ensemble(partial(_case, model, float(load)), MEMBERS) for load in LOADS] for model in MODELS]
    neighbours = [
        row[int(np.flatnonzero(LOADS == LOAD)[0])]
        for row, model in zip(ensembles, MODELS, strict=True)
        if model in SHOWN
    ]
    other_hits = _padded([_hits(run, begin) for many in neighbours for run in many])
    other_hits = other_hits.reshape(len(SHOWN), MEMBERS, *other_hits.shape[1:])
    displacements = [[run.arrays.displacement[1:, 0] for run in many] for many in neighbours]
    positions = [[run.arrays.relative_position[1:, 0] for run in many] for many in neighbours]

    def spread(of: Callable[[Run], float], units: str, text: str) -> tuple[Any, ...]:
        values = band([[[of(run) for run in many] for many in row] for row in ensembles], axis=2)
        return described(("quantile", *over), values, units, f"{text}, ensemble of start positions")

    law = MODELS[RIGID].restitution
    assert isinstance(law, JacksonGreen)
    motion = np.array([(run.arrays.displacement[1:, 0], run.arrays.relative_position[1:, 0]) for run in shown])
    peak = float(np.abs(motion[0, 0]).max()) * (2 * pi * resonance()) ** 2
    over = ("model", "amplitude")
    hit = ("shown", "hit")
    return xr.Dataset(
        {
            "displacement": described(("shown", "time"), motion[:, 0], "m", "displacement of the structure"),
            "displacement_spread": described(
                ("quantile", "shown", "time"),
                band(displacements, axis=1),
                "m",
                "displacement of the structure, ensemble of start positions",
            ),
            "place": described(("shown", "time"), motion[:, 1], "m", "place of the ball in its cavity"),
            "place_spread": described(
                ("quantile", "shown", "time"),
                band(positions, axis=1),
                "m",
                "place of the ball, ensemble of start positions",
            ),
            "hit_time": described(hit, hits[:, 0], "s", "time of first touch"),
            "approach_speed": described(hit, hits[:, 1], "m/s", "relative speed at first touch"),
            "restitution": described(hit, hits[:, 2], "", "restitution"),
            "contact_time": described(hit, hits[:, 3], "s", "duration of the contact"),
            "hit_end": described(hit, hits[:, 0] + hits[:, 3], "s", "time of the last touch"),
            "lasting": described(hit, hits[:, 4] == 1, "", "contact lasts"),
            "other_hit_time": described(
                ("shown", "start", "other_hit"), other_hits[:, :, 0], "s", "time of first touch"
            ),
            "other_approach_speed": described(
                ("shown", "start", "other_hit"), other_hits[:, :, 1], "m/s", "relative speed at first touch"
            ),
            "contacts": described(
                over, [[_counted(run) for run in row] for row in grid], "", "contacts a cycle, one run"
            ),
            "contacts_spread": spread(_counted, "", "contacts a cycle"),
            "longest": described(
                over, [[_longest(run) for run in row] for row in grid], "s", "longest contact, one run"
            ),
            "longest_spread": spread(_longest, "s", "longest contact"),
            "held": described(over, [[_held(run) for run in row] for row in grid], "", "some contacts last, one run"),
            "held_starts": described(
                over,
                [[np.mean([_held(run) for run in many]) for many in row] for row in ensembles],
                "",
                "share of the starts in which some contacts last",
            ),
            "shown_load": described((), LOAD, "N", "amplitude of the load of the motion shown"),
            "frequency": described((), resonance(), "Hz", "frequency of the load"),
            "peak_acceleration": described((), peak, "m/s^2", "largest acceleration of the walls"),
            "critical_speed": described(
                (), law.critical_speed(contact_pairs(_case(RIGID, LOAD), 0)[0]), "m/s", "elastic limit"
            ),
            "wall_place": described("side", [-GAP, GAP], "m", "place of the walls"),
        },
        {
            "model": described("model", list(MODELS), "", "contact model"),
            "shown": described("shown", list(SHOWN), "", "contact model shown in time"),
            "time": described("time", shown[0].arrays.time[1:] - begin, "s", "time"),
            "hit": described("hit", np.arange(hits.shape[2]), "", "number of the impact"),
            "start": described("start", np.arange(MEMBERS), "", "number of the start position"),
            "other_hit": described("other_hit", np.arange(other_hits.shape[3]), "", "number of the impact"),
            "side": described("side", [-1, 1], "", "side of the cavity"),
            "quantile": described("quantile", [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
            "amplitude": described("amplitude", LOADS, "N", "amplitude of the load"),
        },
    )


def _padded(hits: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the impacts of several runs, padded with NaN."""
    size = max(each.shape[1] for each in hits)
    return np.array([np.pad(each, ((0, 0), (0, size - each.shape[1])), constant_values=np.nan) for each in hits])


def _hits(run: Run, begin: float) -> NDArray[np.float64]:
    """Return time, speed, restitution and duration of each impact after a time, and whether its contact lasts."""
    log = run.arrays.impacts
    end = np.where(log.complete, log.time + log.duration, run.arrays.time[-1])
    kept = end > begin
    columns = log.time - begin, log.approach_speed, log.restitution, end - log.time, _lasting(run)
    return np.array([np.asarray(column, dtype=float)[kept] for column in columns])


def _lasting(run: Run) -> NDArray[np.bool_]:
    """Return for each contact whether it lasts much longer than a collision at its approach speed."""
    log = run.arrays.impacts
    pair = contact_pairs(Case.from_toml(run.case_toml), 0)[0]
    depth = (1.25 * pair.mass * log.approach_speed**2 / pair.hertz_stiffness) ** 0.4
    return np.asarray(log.duration > _LASTING * 2.9432752 * depth / log.approach_speed)


def _counted(run: Run) -> float:
    end = float(run.arrays.time[-1])
    start = end - COUNTED / resonance()
    return float(impacts_per_cycle(run.arrays.impacts.time, 1 / resonance(), start=start, end=end).mean())


def _longest(run: Run) -> float:
    log = run.arrays.impacts
    return float(log.duration[_late(run)].max())


def _held(run: Run) -> bool:
    return bool(_lasting(run)[_late(run)].any())


def _late(run: Run) -> NDArray[np.bool_]:
    """Return the impacts whose contacts ended within the evaluated cycles."""
    log = run.arrays.impacts
    return np.asarray(log.complete & (log.time > run.arrays.time[-1] - COUNTED / resonance()))


def draw(data: xr.Dataset) -> Figure:
    """Draw the motion over time, one column per model, and below the contacts over the load."""
    with figure_style("page"):
        figure = StyledFigure("page", 1.03)
        panels = figure.subplots(4, 2, height_ratios=(0.5, 1, 1, 1))
        for column, model in zip(panels.T, data.shown.values, strict=True):
            column[0].set_title(f"{SHORT[model]}, {float(data.shown_load):g} N")
            for axes in column[1:3]:
                axes.sharex(column[0])
            _draw_in_time(column[:3], data.sel(shown=model), COLOURS[model])
        for row, texts in zip(
            panels[:3], ("Structure\n(mm)", "Ball in its cavity\n(mm)", "Speed at impact\n(m/s)"), strict=True
        ):
            row[0].set_ylabel(texts)
            row[1].sharey(row[0])
        panels[2, 0].set_ylim(0.004, 1.2)
        panels[1, 0].set_ylim(-0.5, 0.5)
        _draw_over_load(panels[3], data)
        handles = [line for axes in panels[1:3, 0] for line in axes.get_legend_handles_labels()[0]]
        figure.legend(handles=handles, loc="outside upper left", ncols=3)
        figure.align_ylabels()
        letters(figure)
    return figure


_BESIDE: Mapping[str, Any] = {"color": "#8a8f98"}  # Look of the ensemble in time


def _draw_in_time(panels: Sequence[Axes], one: xr.Dataset, colour: str) -> None:
    time = 1e3 * one.time
    displacements, place, speed = panels
    for axes, name in ((displacements, "displacement"), (place, "place")):
        low, median, high = 1e3 * one[f"{name}_spread"].transpose("quantile", "time").values
        text = f"{MEMBERS} starts within 1 µm, 10 to 90 %"
        axes.fill_between(time, low, high, alpha=0.4, lw=0, zorder=1, rasterized=True, label=text, **_BESIDE)
        axes.plot(time, median, lw=pen(0.5), zorder=1.5, rasterized=True, label="their median", **_BESIDE)
    displacements.plot(time[::10], 1e3 * one.displacement[::10], color=INK)
    place.plot(time, 1e3 * one.place, color=colour, lw=pen(0.6), rasterized=True)
    for side in 1e3 * one.wall_place.values:
        place.axhline(side, color=INK, lw=pen(0.6))
    others = 1e3 * one.other_hit_time.values.ravel(), one.other_approach_speed.values.ravel()
    speed.semilogy(*others, "o", ms=1.5, mew=0, alpha=0.5, rasterized=True, label="their impacts", **_BESIDE)
    speed.semilogy(1e3 * one.hit_time, one.approach_speed, "o", ms=2.0, mew=0, color=colour)
    for begin, end in zip(one.hit_time.values[one.lasting], one.hit_end.values[one.lasting], strict=True):
        for axes in (place, speed):
            axes.axvspan(1e3 * begin, 1e3 * end, color=FAINT, alpha=0.5, lw=0, zorder=0)
    if one.lasting.any():
        limit = float(one.critical_speed)
        speed.axhline(limit, color=INK, ls=(0, (4, 3)), lw=pen(0.6), zorder=0)
        speed.text(38.0, 0.8 * limit, "elastic below", va="top", fontsize="small")
    speed.set_xlim(0, float(time[-1]))
    speed.set_xlabel("Time (ms)")


def _draw_over_load(panels: Sequence[Axes], data: xr.Dataset) -> None:
    for k, model in enumerate(data.model.values):
        one = data.sel(model=model)
        look: dict[str, Any] = {"color": COLOURS[model], "marker": SERIES_MARKERS[k], "ls": ""}
        for axes, name, divisor in zip(panels, ("contacts", "longest"), (1.0, 1e-3), strict=True):
            low, median, high = one[f"{name}_spread"].transpose("quantile", "amplitude").values / divisor
            axes.fill_between(one.amplitude, low, high, color=COLOURS[model], alpha=0.3, lw=0)
            axes.plot(one.amplitude, median, color=COLOURS[model], ls=STYLES[model], label=SHORT[model])
            axes.plot(one.amplitude, one[name] / divisor, **look)
    panels[1].set_yscale("log")
    for axes in panels:
        axes.set_xlabel("Amplitude of the load (N)")
        axes.margins(x=0.03)
    panels[0].set_ylabel("Contacts a cycle")
    panels[0].set_ylim(bottom=0)
    panels[1].set_ylabel("Longest contact\n(ms)")
    panels[1].legend(loc="upper left")


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    rigid = data.sel(model=RIGID, shown=RIGID)
    lasting = rigid.where(rigid.lasting, drop=True)
    contact = 1e3 * float(lasting.contact_time.max()) if lasting.hit.size else 0.0
    swing = 1e3 * float(np.abs(data.displacement).max())
    return (
        f"With a rigid wall the chatter ends in contacts of up to {contact:.0f} ms (grey), as impacts below V_c lose "
        "nothing and the "
        f"acceleration of the wall grows. Load at {float(data.frequency):.2f} Hz; at {float(data.shown_load):g} N the "
        "structure swings "
        f"by {swing:.0f} mm and {float(data.peak_acceleration) / 9.80665:.0f} g, with a gap of 0.4 mm. Bands: "
        f"{MEMBERS} starts."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the claim on the expected chattering."""
    held = data.held_starts.max("amplitude")
    longest = 1e3 * data.longest_spread.sel(quantile=0.5).max("amplitude")
    text = ", ".join(f"{two(longest.sel(model=m))} ms ({SHORT[m]})" for m in data.model.values)
    return (
        Claim(
            "The elasto-plastic model is expected to chatter: regularly sustained contacts within a cycle.",
            "section 6.1",
            "largest share of the starts with contacts that last, over the loads",
            by_wall({str(m): exact(held.sel(model=m)) for m in data.model.values}),
            accept=(0.5, 1),
            partly=(0.1, 1),
            note=f"expected there, not computed; loads to {float(data.amplitude.max()):g} N are ours; longest "
            f"contact, medians: {text}",
        ),
    )


FIGURE = Reproduction(
    number="A4",
    title="Chattering in time",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
