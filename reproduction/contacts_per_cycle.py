"""Figure A2: number of contacts per cycle of a harmonic load against its frequency."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from math import ceil, pi
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from rattlebox import Case, Run
from rattlebox.analysis import impacts_per_cycle
from rattlebox.plots import INK, StyledFigure, pen

from .figure import QUANTILES, Reproduction
from .files import simulate_many
from .harmonic import State, harmonic_case, resonance
from .models import COLOURS, MODELS, SHORT
from .system import DAMPING, GAP, MASS, STIFFNESS, band, ensemble, near

AMPLITUDE = 20.0  # of the load [N]
FREQUENCIES = np.arange(30, 231, 2) / 10  # of the load [Hz]
APART = 0.5  # difference of mean counts above which two motions differ
SETTLING, COUNTED = 30.0, 15.0  # time left to settle, and least time counted afterwards [s]
MEMBERS = 6


def _case(model: str, frequency: float, offset: float = 0.0) -> Case:
    """Return a case whose ball starts at the leading wall; from the centre it has no contact at high frequencies."""
    duration = (ceil(SETTLING * frequency) + ceil(COUNTED * frequency)) / frequency
    state = State(ball_position=GAP * near(1.0, offset))
    options: dict[str, Any] = {"duration": duration, "times": (0.0,)}
    return harmonic_case(MODELS[model], amplitude=AMPLITUDE, frequency=frequency, state=state, **options)


def cases() -> Mapping[str, Case]:
    """Return the case of each model nearest to resonance."""
    nearest = float(FREQUENCIES[np.abs(FREQUENCIES - resonance()).argmin()])
    return {f"{model}, {nearest:g} Hz": _case(model, nearest) for model in MODELS}


def _counts(run: Run, frequency: float) -> NDArray[np.int64]:
    """Return the number of contacts in each cycle after settling."""
    start, end = ceil(SETTLING * frequency) / frequency, float(run.arrays.time[-1])
    return np.asarray(impacts_per_cycle(run.arrays.impacts.time, 1 / frequency, start=start, end=end))


def _bare_amplitude(frequency: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the amplitude of the structure without the ball [m]."""
    omega = 2 * pi * frequency
    return np.asarray(AMPLITUDE / np.abs(STIFFNESS - MASS * omega**2 + 1j * DAMPING * omega))


def data() -> xr.Dataset:
    """Count the contacts of each cycle for all models and frequencies."""
    grid = [(model, float(frequency)) for model in MODELS for frequency in FREQUENCIES]
    runs = simulate_many([_case(*point) for point in grid])
    counts = [_counts(run, frequency) for run, (_, frequency) in zip(runs, grid, strict=True)]
    means = [[_counts(run, f).mean() for run in ensemble(partial(_case, model, f), MEMBERS)] for model, f in grid]
    top = max(int(count.max()) for count in counts)
    shape = len(MODELS), FREQUENCIES.size
    shares = np.array([np.bincount(count, minlength=top + 1) / count.size for count in counts])
    over = ("model", "frequency")
    return xr.Dataset(
        {
            "share": ((*over, "count"), shares.reshape(*shape, -1)),
            "mean": (over, np.reshape([c.mean() for c in counts], shape)),
            "mean_spread": (("quantile", *over), np.reshape(band(means, axis=1), (3, *shape))),
            "cycles": ("frequency", [c.size for c in counts[: shape[1]]]),
            "alone": ("frequency", _bare_amplitude(FREQUENCIES)),
            "gap": ((), GAP),
            "resonance": ((), resonance()),
            "amplitude": ((), AMPLITUDE),
        },
        {"model": list(MODELS), "frequency": FREQUENCIES, **QUANTILES, "count": np.arange(top + 1)},
    )


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw how often each count occurs, one panel per model."""
    panels = figure.subplots(data.model.size, 1, sharex=True, sharey=True)
    step = float(data.frequency[1] - data.frequency[0])
    edges = np.append(data.frequency - step / 2, data.frequency[-1] + step / 2)
    rows = np.append(data["count"] - 0.5, data["count"][-1] + 0.5)
    for axes, model in zip(panels, data.model.values, strict=True):
        one, colour = data.sel(model=model), COLOURS[model]
        shares = one.share.where(one.share > 0).T
        shade = axes.pcolormesh(edges, rows, shares, cmap="Greys", vmin=0, vmax=1, rasterized=True)
        low, median, high = one.mean_spread.values
        axes.fill_between(data.frequency, low, high, color=colour, alpha=0.35, lw=0, label="mean, 10 to 90 %")
        axes.plot(data.frequency, median, color=colour, lw=pen(0.9), label="mean, median of starts")
        axes.plot(data.frequency, one["mean"], color=INK, lw=pen(0.5), ls=(0, (1, 1.2)), label="mean, one run")
        steady = one.sel(frequency=one.frequency[_steady(one)])
        square: dict[str, Any] = {"ms": 2.5, "mew": 0, "color": INK, "label": "one run, all cycles alike"}
        axes.plot(steady.frequency, steady["mean"], "s", **square)
        axes.axvline(float(data.resonance), color=INK, lw=pen(0.5), ls=(0, (4, 3)), zorder=0)
        axes.set_title(SHORT[model])
    # Low counts, where the steps are, get the room.
    axes.set_yscale("function", functions=(lambda y: np.sqrt(np.maximum(y + 1.5, 0)), lambda y: y**2 - 1.5))
    axes.set_yticks([0, 1, 2, 4, 8, 12, 16, 20, 24])
    axes.set_ylim(-0.5, float(rows[-1]))
    axes.set_xlim(edges[0], edges[-1])
    axes.set_xlabel("Frequency of the load (Hz)")
    panels[1].set_ylabel("Contacts in a cycle (uneven scale)")
    text = "natural frequency with\nthe ball riding along"
    panels[0].text(float(data.resonance) + 0.3, 20, text, va="top", ha="left")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper left", ncols=4)
    figure.colorbar(shade, ax=panels, aspect=50, pad=0.01, label="Share of the cycles")


def _steady(one: xr.Dataset) -> NDArray[np.bool_]:
    """Return for each frequency whether all cycles have the same count."""
    return np.asarray((one.share == 1).any("count"))


def _steady_counts(data: xr.Dataset, model: str) -> set[int]:
    """Return the numbers of contacts that all cycles of a run share."""
    one = data.sel(model=model)
    return {int(count) for count in one.share.argmax("count").values[_steady(one)]}


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return the agreement of the starts, and the number of different counts; 1 if all runs are steady, or none."""
    low, _, high = data.mean_spread.transpose("quantile", ...)
    numbers = set().union(*(_steady_counts(data, model) for model in data.model.values))
    some = {m: 0 < _steady(data.sel(model=m)).mean() < 1 for m in data.model.values}
    return {
        "members": MEMBERS,
        "none": 100 * ((high - low) == 0).mean(),
        "wide": 100 * ((high - low) > APART).mean(),
        "apart": APART,
        "ends": data.frequency[[0, -1]],
        "numbers": ", ".join(map(str, sorted(numbers))),
        "bifurcation": {m: len(_steady_counts(data, m)) if some[m] else 1 for m in some},
    }


FIGURE = Reproduction("contacts_per_cycle", data, draw, 0.85, cases, values)
