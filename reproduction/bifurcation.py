"""Figure A3: approach speed of impacts against frequency and amplitude of a harmonic load."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from numpy.typing import NDArray

from rattlebox import Case, Run
from rattlebox.plots import INK, StyledFigure, pen

from .figure import QUANTILES, Reproduction
from .files import simulate_many
from .harmonic import State, harmonic_case, paper_two_impacts
from .models import COLOURS, CONSTANT_E, MODELS, RIGID, SHORT, critical_speed
from .system import GAP, band, ensemble, near

AMPLITUDE, FREQUENCY = 20.0, 18.0  # of the load, while the other one varies [N], [Hz]
FREQUENCIES = np.arange(120, 241) / 10
AMPLITUDES = np.arange(8, 161) / 2
DURATION = 30.0  # of each run [s]; the last impacts count
HITS = 60  # impacts kept of each run
MEMBERS = 6
SHOWN = CONSTANT_E, RIGID  # models of the rows


def _case(model: str, amplitude: float, frequency: float, offset: float = 0.0) -> Case:
    state = State(ball_position=GAP * near(1.0, offset))
    options: dict[str, Any] = {"duration": DURATION, "times": (0.0,)}
    return harmonic_case(MODELS[model], amplitude=amplitude, frequency=frequency, state=state, **options)


def cases() -> Mapping[str, Case]:
    """Return the case at the crossing of both parameter lines, by model."""
    return {model: _case(model, AMPLITUDE, FREQUENCY) for model in SHOWN}


def data() -> xr.Dataset:
    """Compute the last impacts of each run, and the exact motion with two impacts per cycle."""
    loads = [(AMPLITUDE, f) for f in FREQUENCIES] + [(a, FREQUENCY) for a in AMPLITUDES]
    grid = [(model, float(a), float(f)) for model in SHOWN for a, f in loads]
    by_model = _speeds(simulate_many([_case(*point) for point in grid])).reshape(len(SHOWN), len(loads), HITS)
    many = [_speeds(ensemble(partial(_case, *point), MEMBERS)) for point in grid]
    spread = np.reshape([band(speeds[np.isfinite(speeds)]) for speeds in many], (*by_model.shape[:2], 3))
    alike = np.reshape([_agree(speeds).mean() for speeds in many], by_model.shape[:2])
    exact = np.array([_exact(float(a), float(f)) for a, f in loads])
    variables: dict[str, Any] = {
        "amplitude_at": ((), AMPLITUDE),
        "frequency_at": ((), FREQUENCY),
        "critical_speed": ((), critical_speed(RIGID)),
    }
    for name, part in (("frequency", slice(FREQUENCIES.size)), ("amplitude", slice(FREQUENCIES.size, None))):
        variables[f"speed_over_{name}"] = (("model", name, "hit"), by_model[:, part])
        variables[f"spread_over_{name}"] = (("model", name, "quantile"), spread[:, part])
        variables[f"alike_over_{name}"] = (("model", name), alike[:, part])
        variables[f"stable_over_{name}"] = (name, exact[part, 0])
        variables[f"unstable_over_{name}"] = (name, exact[part, 1])
    axes = {"frequency": FREQUENCIES, "amplitude": AMPLITUDES}
    return xr.Dataset(variables, {"model": list(SHOWN), **axes, **QUANTILES, "hit": np.arange(HITS)})


def _speeds(runs: Sequence[Run]) -> NDArray[np.float64]:
    """Return the speeds of the last impacts of each run [m/s], (run, hit), NaN if there are fewer."""
    speeds = np.full((len(runs), HITS), np.nan)
    for row, run in zip(speeds, runs, strict=True):
        last = run.arrays.impacts.approach_speed[-HITS:]
        row[: last.size] = last
    return speeds


def _agree(speeds: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return whether all speeds of a run agree within 1 %."""
    return np.asarray(np.ptp(speeds, axis=-1) < 0.01 * speeds.mean(axis=-1))


def _exact(amplitude: float, frequency: float) -> NDArray[np.float64]:
    """Return the speed of the faster motion with two impacts per cycle [m/s], first if it is stable, else second."""
    found = paper_two_impacts(amplitude, frequency)
    speeds = np.full(2, np.nan)
    if found:
        speeds[int(found[0].multiplier >= 1)] = found[0].approach_speed
    return speeds


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw the speeds over frequency and amplitude, one row per model, with the exact motion in the first row."""
    panels = figure.subplots(data.model.size, 2, sharex="col", sharey=True)
    for row, model in zip(panels, data.model.values, strict=True):
        for axes, name in zip(row, ("frequency", "amplitude"), strict=True):
            speeds, spreads = (data[f"{kind}_over_{name}"].sel(model=model) for kind in ("speed", "spread"))
            low, median, high = 1e3 * spreads.transpose("quantile", name).values
            look: dict[str, Any] = {"color": COLOURS[model], "zorder": 0.5}
            axes.fill_between(data[name], low, high, alpha=0.2, lw=0, label="starts within 1 µm, 10 to 90 %", **look)
            axes.plot(data[name], median, lw=pen(0.6), label="their median", **look)
            at = np.repeat(data[name].values, data.hit.size)
            axes.plot(at, 1e3 * speeds.values.ravel(), ".", ms=1.3, mew=0, color=INK, rasterized=True)
            if model == CONSTANT_E:
                _draw_exact(axes, data, name)
            else:
                line: dict[str, Any] = {"ls": (0, (4, 2)), "lw": pen(0.8), "zorder": 0}
                axes.axhline(1e3 * float(data.critical_speed), color=INK, label="elastic below this speed", **line)
        row[0].set_title(SHORT[model])
        row[0].set_ylabel("Speed at impact (mm/s)")
    panels[0, 0].set_ylim(0, 1050 * float(data.speed_over_amplitude.max()))
    panels[0, 0].set_xlim(float(data.frequency[0]), float(data.frequency[-1]))
    panels[0, 1].set_xlim(float(data.amplitude[0]), float(data.amplitude[-1]))
    panels[-1, 0].set_xlabel(f"Frequency of the load of {float(data.amplitude_at):g} N (Hz)")
    panels[-1, 1].set_xlabel(f"Amplitude of the load at {float(data.frequency_at):g} Hz (N)")
    lines = {line.get_label(): line for axes in panels[::-1, 0] for line in axes.get_legend_handles_labels()[0]}
    figure.legend(handles=list(lines.values()), loc="outside upper left", ncols=3)


def _draw_exact(axes: Axes, data: xr.Dataset, name: str) -> None:
    for kind, style in (("stable", "-"), ("unstable", (0, (1.2, 0.8)))):
        look: dict[str, Any] = {"alpha": 0.45, "ls": style, "lw": pen(2.6), "zorder": 0.8}
        text = f"exact, two hard impacts a cycle, {kind}"
        axes.plot(data[name], 1e3 * data[f"{kind}_over_{name}"], color=INK, label=text, **look)


def is_settled(data: xr.Dataset, name: str) -> xr.DataArray:
    """Return for which runs over "frequency" or "amplitude" all speeds agree within 1 %."""
    speeds = data[f"speed_over_{name}"].transpose(..., "hit")
    return speeds.isel(hit=0).copy(data=_agree(speeds.values))


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return how many runs settle, and how many of them on the exact motion."""
    one = data.sel(model=CONSTANT_E)
    stable = np.isfinite(one.stable_over_frequency)
    off = np.abs(one.speed_over_frequency.mean("hit") / one.stable_over_frequency - 1)
    shares = np.concatenate([one[f"alike_over_{name}"] for name in ("frequency", "amplitude")])
    return {
        "all": np.sum(shares == 1),
        "none": np.sum(shares == 0),
        "loads": shares.size,
        "met": (is_settled(one, "frequency") & (off < 0.05)).sum(),
        "stable": stable.sum(),
        "hits": data.hit.size,
        "duration": DURATION,
    }


FIGURE = Reproduction("bifurcation", data, draw, 0.78, cases, values)
