"""Figure A4: chattering over time, and the loads at which it ends in a lasting contact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from math import pi
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from numpy.typing import NDArray

from rattlebox import Case, Run, contact_pairs
from rattlebox.analysis import impacts_per_cycle
from rattlebox.plots import FAINT, INK, SERIES_MARKERS, StyledFigure, pen

from .figure import QUANTILES, Reproduction, spread
from .files import simulate_many
from .harmonic import harmonic_case, resonance, riding
from .models import COLOURS, CONSTANT_E, MODELS, RIGID, SHORT, STYLES, critical_speed, lasting, two
from .system import GAP, band, ensemble

SHOWN = CONSTANT_E, RIGID
LOAD = 500.0  # of the runs shown in time [N]
LOADS = np.array([50.0, 100.0, 200.0, 300.0, 375.0, 400.0, 500.0, 600.0])  # of the runs that are counted [N]
CYCLES, COUNTED, DRAWN = 16, 8, 1.25
"""Length of each run, of its part that is counted and of its part that is drawn [cycles]."""
SAMPLES = 2500
MEMBERS = 6
_BESIDE: Mapping[str, Any] = {"color": "#8a8f98"}  # look of the ensemble in time


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
    ensembles = [[ensemble(partial(_case, model, float(load)), MEMBERS) for load in LOADS] for model in MODELS]
    rows, column = [list(MODELS).index(model) for model in SHOWN], int(np.flatnonzero(LOADS == LOAD)[0])
    shown, neighbours = ([grid[row][column] for row in rows], [ensembles[row][column] for row in rows])
    begin = float(shown[0].arrays.time[1])
    hits = _padded([_hits(run, begin) for run in shown])
    other_hits = _padded([_hits(run, begin) for many in neighbours for run in many])
    other_hits = other_hits.reshape(len(SHOWN), MEMBERS, *other_hits.shape[1:])

    def motion(run: Run) -> NDArray[np.float64]:
        return np.array([run.arrays.displacement[1:, 0], run.arrays.relative_position[1:, 0]])

    displacement, place = np.array([motion(run) for run in shown]).swapaxes(0, 1)
    displacements, places = np.moveaxis(np.array([[motion(run) for run in many] for many in neighbours]), 2, 0)
    peak = (2 * pi * resonance()) ** 2
    variables: dict[str, Any] = {}
    for name, of in (("contacts", _counted), ("longest", _longest), ("held", _held)):
        variables[name] = (("model", "amplitude"), [[of(run) for run in row] for row in grid])
        many = np.array([[[of(run) for run in each] for each in row] for row in ensembles])
        if name == "held":
            variables["held_starts"] = (("model", "amplitude"), many.mean(axis=2))
        else:
            variables[f"{name}_spread"] = (("quantile", "model", "amplitude"), band(many, axis=2))
    return xr.Dataset(
        {
            "displacement": (("shown", "time"), displacement),
            "displacement_spread": (("quantile", "shown", "time"), band(displacements, axis=1)),
            "place": (("shown", "time"), place),
            "place_spread": (("quantile", "shown", "time"), band(places, axis=1)),
            "hit_time": (("shown", "hit"), hits[:, 0]),
            "approach_speed": (("shown", "hit"), hits[:, 1]),
            "restitution": (("shown", "hit"), hits[:, 2]),
            "contact_time": (("shown", "hit"), hits[:, 3]),
            "hit_end": (("shown", "hit"), hits[:, 0] + hits[:, 3]),
            "lasting": (("shown", "hit"), hits[:, 4] == 1),
            "other_hit_time": (("shown", "start", "other_hit"), other_hits[:, :, 0]),
            "other_approach_speed": (("shown", "start", "other_hit"), other_hits[:, :, 1]),
            **variables,
            "shown_load": ((), LOAD),
            "frequency": ((), resonance()),
            "peak_acceleration": ((), float(np.abs(displacement[0]).max()) * peak),
            "critical_speed": ((), critical_speed(RIGID)),
            "wall_place": ("side", [-GAP, GAP]),
        },
        {
            "model": list(MODELS),
            "shown": list(SHOWN),
            "time": shown[0].arrays.time[1:] - begin,
            "hit": np.arange(hits.shape[2]),
            "start": np.arange(MEMBERS),
            "other_hit": np.arange(other_hits.shape[3]),
            "side": [-1, 1],
            **QUANTILES,
            "amplitude": LOADS,
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
    return lasting(run.arrays.impacts, contact_pairs(Case.from_toml(run.case_toml), 0)[0])


def _counted(run: Run) -> float:
    end = float(run.arrays.time[-1])
    start = end - COUNTED / resonance()
    return float(impacts_per_cycle(run.arrays.impacts.time, 1 / resonance(), start=start, end=end).mean())


def _longest(run: Run) -> float:
    return float(run.arrays.impacts.duration[_late(run)].max())


def _held(run: Run) -> bool:
    return bool(_lasting(run)[_late(run)].any())


def _late(run: Run) -> NDArray[np.bool_]:
    """Return the impacts whose contacts ended within the evaluated cycles."""
    log = run.arrays.impacts
    return np.asarray(log.complete & (log.time > run.arrays.time[-1] - COUNTED / resonance()))


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw the motion over time, one column per model, and below the contacts over the load."""
    panels = figure.subplots(4, 2, height_ratios=(0.5, 1, 1, 1))
    for column, model in zip(panels.T, data.shown.values, strict=True):
        column[0].set_title(f"{SHORT[model]}, {float(data.shown_load):g} N")
        for axes in column[1:3]:
            axes.sharex(column[0])
        _draw_in_time(column[:3], data.sel(shown=model), COLOURS[model])
    names = ("Structure\n(mm)", "Ball in its cavity\n(mm)", "Speed at impact\n(m/s)")
    for row, text in zip(panels[:3], names, strict=True):
        row[0].set_ylabel(text)
        row[1].sharey(row[0])
    panels[2, 0].set_ylim(0.004, 1.2)
    panels[1, 0].set_ylim(-0.5, 0.5)
    _draw_over_load(panels[3], data)
    handles = [line for axes in panels[1:3, 0] for line in axes.get_legend_handles_labels()[0]]
    figure.legend(handles=handles, loc="outside upper left", ncols=3)
    figure.align_ylabels()


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
    speed.set(xlim=(0, float(time[-1])), xlabel="Time (ms)")


def _draw_over_load(panels: Sequence[Axes], data: xr.Dataset) -> None:
    for k, model in enumerate(data.model.values):
        one, named = data.sel(model=model), {"ls": STYLES[model], "label": SHORT[model]}
        for axes, name, divisor in zip(panels, ("contacts", "longest"), (1.0, 1e-3), strict=True):
            values = one[f"{name}_spread"].transpose("quantile", "amplitude").values / divisor
            spread(axes, one.amplitude, values, COLOURS[model], alpha=0.3, **named)
            axes.plot(one.amplitude, one[name] / divisor, color=COLOURS[model], marker=SERIES_MARKERS[k], ls="")
    panels[1].set_yscale("log")
    for axes in panels:
        axes.set_xlabel("Amplitude of the load (N)")
        axes.margins(x=0.03)
    panels[0].set_ylabel("Contacts a cycle")
    panels[0].set_ylim(bottom=0)
    panels[1].set_ylabel("Longest contact\n(ms)")
    panels[1].legend(loc="upper left")


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return the longest contacts, the motion of the structure, and the share of starts with lasting contacts."""
    rigid = data.sel(model=RIGID, shown=RIGID)
    longest = 1e3 * data.longest_spread.sel(quantile=0.5).max("amplitude")
    held = data.held_starts.max("amplitude")
    return {
        "contact": 1e3 * rigid.contact_time.where(rigid.lasting).max().fillna(0.0),
        "swing": 1e3 * np.abs(data.displacement).max(),
        "acceleration": data.peak_acceleration / 9.80665,
        "members": MEMBERS,
        "largest": data.amplitude.max(),
        "longest": ", ".join(f"{two(longest.sel(model=m))} ms ({SHORT[m]})" for m in data.model.values),
        "expected": {m: held.sel(model=m) for m in data.model.values},
    }


FIGURE = Reproduction("chattering", data, draw, 1.03, cases, values)
