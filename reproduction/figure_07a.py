"""Figures 7a and 7b: instantaneous energies with all models."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from rattlebox import Case, Run
from rattlebox.plots import FAINT, INK, StyledFigure, label, pen, scaled

from .figure import QUANTILES, Reproduction
from .files import simulate
from .models import COLOURS, MODELS, SHORT, model_case, model_runs
from .system import band

PARTS: Mapping[str, str] = {"structure": "structure", "particles": "ball"}
_LOOKS: Mapping[str, tuple[str, float]] = {"structure": ("-", 1.0), "ball": (":", 0.5)}
"""Line of the median and opacity of the single run."""
_SPAN, _RATE, _BEGIN, _MEMBERS = 10.0, 1000.0, 0.6, 64
_WINDOW = 100  # samples of a mean over 0.1 s, one period of the structure


def cases() -> Mapping[str, Case]:
    """Return the centred ball under the 5000 N pulse."""
    return {model: model_case(model, duration=_SPAN, rate=_RATE) for model in MODELS}


def _energies(run: Run) -> NDArray[np.float64]:
    return np.array([getattr(run.ledger, part) for part in PARTS])


def data() -> xr.Dataset:
    """Compute the energies of structure and ball, of one run and of an ensemble."""
    single = [simulate(case) for case in cases().values()]
    time = single[0].arrays.time
    begun = int(_BEGIN * _RATE) + 1
    energies = np.array([_energies(run) for run in single])
    means, begins = [], []
    for model in MODELS:
        many = np.array([_energies(run) for run in model_runs(model, 1, _MEMBERS, duration=_SPAN, rate=_RATE)])
        means.append(band(many[..., 1:].reshape(_MEMBERS, len(PARTS), -1, _WINDOW).mean(axis=-1)))
        begins.append(band(many[..., :begun]))
    over = ("model", "quantile", "part")
    return xr.Dataset(
        {
            "energy": (("model", "part", "time"), energies[..., ::2]),
            "begin_energy": (("model", "part", "begin"), energies[..., :begun]),
            "begin_spread": ((*over, "begin"), begins),
            "mean": ((*over, "window"), means),
        },
        {
            "time": time[::2],
            "begin": time[:begun],
            "window": time[1:].reshape(-1, _WINDOW).mean(axis=1),
            "model": list(MODELS),
            "part": list(PARTS.values()),
            **QUANTILES,
        },
    )


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw one row per model: the beginning, and ten seconds on a logarithmic axis."""
    panels = figure.subplots(data.model.size, 2, sharex="col", sharey="col", squeeze=False, width_ratios=(1, 1.2))
    for row, model in zip(panels, data.model.values, strict=True):
        _begin(row[0], data.sel(model=model), COLOURS[model])
        _whole(row[1], data.sel(model=model), COLOURS[model])
        row[0].set_title(SHORT[model])
    proxies = [
        Line2D([], [], color=FAINT, lw=pen(0.5), label="one run"),
        Patch(color=FAINT, lw=0, label="10 to 90 %"),
        *(Line2D([], [], color=INK, ls=line, label=f"{part}, median") for part, (line, _) in _LOOKS.items()),
    ]
    figure.legend(handles=proxies, loc="outside lower center", ncols=4)
    for panel in panels[-1]:
        label(panel, "x", "Time", "s")


def _begin(axes: Axes, data: xr.Dataset, colour: str) -> None:
    """Draw the energies before most of them is dissipated."""
    scale = scaled(data.begin_energy, "J")
    for part in data.part.values:
        low, _, high = data.begin_spread.sel(part=part).values / scale.divisor
        energy = data.begin_energy.sel(part=part) / scale.divisor
        axes.fill_between(data.begin, low, high, color=colour, alpha=0.25, lw=0, rasterized=True)
        axes.plot(data.begin, energy, color=colour, lw=pen(0.7))
        axes.text(0.4, float(energy.max()) * (0.95 if part == "structure" else 1.25), part, color=colour)
    axes.set(xlim=(0, _BEGIN), ylim=(0, None))
    label(axes, "y", "Energy", scale.unit)


def _whole(axes: Axes, data: xr.Dataset, colour: str) -> None:
    """Draw all ten seconds: the single run, and median and band of the ensemble's means."""
    for part in data.part.values:
        low, median, high = data["mean"].sel(part=part).values
        line, opacity = _LOOKS[part]
        look: dict[str, Any] = {"lw": pen(0.3), "alpha": 0.5 * opacity, "rasterized": True}
        axes.plot(data.time, data.energy.sel(part=part), color=colour, **look)
        axes.fill_between(data.window, low, high, color=colour, alpha=0.35, lw=0)
        axes.plot(data.window, median, color=INK, ls=line, zorder=3)
    highest = float(data.energy.max())
    axes.set(yscale="log", ylim=(highest * 1e-6, 2 * highest), xlim=(0, float(data.time[-1])))
    label(axes, "y", "Energy", "J")


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return the energies of structure and ball that are left, by model."""
    left = data["mean"].sel(quantile=0.5).isel(window=-1).values
    ends = [f"{one[0]:.0e} and {one[1]:.0e} J ({SHORT[m]})" for one, m in zip(left, data.model.values, strict=True)]
    return {"members": _MEMBERS, "ends": ", ".join(ends)}


FIGURE = Reproduction("figure_07a", data, draw, 0.8, cases, values)
