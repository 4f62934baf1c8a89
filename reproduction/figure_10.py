"""Figure 10: amplitude spectra of the ball in its cavity and of the structure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from rattlebox import Case, Run
from rattlebox.analysis import amplitude_spectrum
from rattlebox.plots import FAINT, INK, StyledFigure, label, pen

from .figure import QUANTILES, Reproduction, spread
from .files import simulate
from .judge import HEDGED, WALLS, estimate
from .models import ALL_MODELS, COLOURS, CONSTANT_E, MODELS, SHORT, STEEL, model_case, model_runs
from .system import MASS, STIFFNESS, band, paper_case

DURATION, RATE = 10.0, 2000.0  # of the record [s], and its samples a second [Hz]
WINDOW = "boxcar"
"""A transient that begins and ends near rest needs no taper, and a taper would hide how it begins."""
SHOWN = slice(1.0, 300.0)  # frequencies [Hz]
NEAR, PADDING = slice(9.0, 11.0), 8
"""Frequencies about the resonance [Hz], and how much finer their spectrum is drawn."""
MEMBERS = 20
_PARTS = ("ball", "structure", "near")


def _bare() -> Case:
    return paper_case(ball=False, duration=DURATION, rate=RATE)


def cases() -> Mapping[str, Case]:
    """Return the centred cases at 5000 N with all models, and without the damper."""
    damped = {model: model_case(model, duration=DURATION, rate=RATE) for model in ALL_MODELS}
    return damped | {"without damper": _bare()}


def _spectra(runs: Sequence[Run], part: str) -> xr.DataArray:
    """Return spectra of full seconds, (run, angular frequency); the last sample belongs to the next period."""
    padding, shown = (PADDING, NEAR) if part == "near" else (1, SHOWN)
    each = []
    for run in runs:
        motion = run.arrays.relative_position if part == "ball" else run.arrays.displacement
        spectrum = amplitude_spectrum(run.arrays.time[:-1], motion[:-1, 0], window=WINDOW, padding=padding)
        each.append(spectrum.sel(frequency=shown))
    joined = xr.concat(each, "run")
    return joined.assign_coords(frequency=2 * np.pi * joined.frequency)


def data() -> xr.Dataset:
    """Compute the spectra of the ensembles and of the bare structure, and the rates of the ball."""
    spectra: dict[str, list[NDArray[np.float64]]] = {part: [] for part in _PARTS}
    peaks, trips = [], []
    for model in ALL_MODELS:
        runs = model_runs(model, 1, MEMBERS, duration=DURATION, rate=RATE)
        found = {part: _spectra(runs, part) for part in _PARTS}
        for part, values in found.items():
            spectra[part].append(band(values))
        peaks.append(found["near"].frequency.values[found["near"].argmax("frequency")])
        # Two contacts make a round trip.
        trips.append(band(np.concatenate([np.pi / np.diff(run.arrays.impacts.time) for run in runs])))
    bare = [simulate(_bare())]
    without, close = _spectra(bare, "structure")[0], _spectra(bare, "near")[0]
    together = MASS + model_case(CONSTANT_E).impact_dampers[0].masses[0]
    return xr.Dataset(
        {
            "ball": (("model", "quantile", "frequency"), spectra["ball"]),
            "structure": (("model", "quantile", "frequency"), spectra["structure"]),
            "near": (("model", "quantile", "fine"), spectra["near"]),
            "without": ("frequency", without.values),
            "near_without": ("fine", close.values),
            "peak": (("model", "member"), peaks),
            "trips": (("model", "quantile"), trips),
            "riding": ((), np.sqrt(STIFFNESS / together)),
            "bare": ((), np.sqrt(STIFFNESS / MASS)),
        },
        {
            "model": list(ALL_MODELS),
            "frequency": without.frequency.values,
            "fine": close.frequency.values,
            "member": np.arange(MEMBERS),
            **QUANTILES,
        },
        {"window": WINDOW, "duration": DURATION},
    )


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw one column per model: ball, structure, and the structure near its resonance."""
    grid = figure.subplots(3, len(MODELS), sharey="row")
    for column, model in zip(grid.T, MODELS, strict=True):
        for axes, name in zip(column, _PARTS, strict=True):
            at = data["fine" if name == "near" else "frequency"].values
            look: dict[str, Any] = {"lw": pen(0.4), "rasterized": name != "near"}
            spread(axes, at, data[name].sel(model=model).values, COLOURS[model], alpha=0.35, raster=True, **look)
            if name != "ball":
                bare = data["without" if name == "structure" else "near_without"]
                axes.plot(at, bare, color=INK, ls=(0, (4, 2)), lw=pen(0.7), label="without damper")
            for place, style in ((data.riding, "-"), (data.bare, (0, (1, 1.2)))):
                axes.axvline(float(place), color=FAINT, ls=style, lw=pen(0.7), zorder=0)
            axes.set(yscale="log", xlim=(at[0], at[-1]))
            label(axes, "x", "Angular frequency", "rad/s")
        for axes in column[:2]:
            axes.set_xscale("log")
            axes.set_xticks([10, 100, 1000], ["10", "100", "1000"])
        column[0].set_title(SHORT[model])
    for axes, text in zip(grid[:, 0], ("Ball in its cavity", "Structure", "Structure, close up"), strict=True):
        label(axes, "y", text, "m")
    close, top = grid[2, 0], float(data.near.sel(quantile=0.5).max())
    close.set_ylim(10 ** np.floor(np.log10(top / 25)), 2 * top)
    close.text(float(data.riding), 1.9 * top, r"$\sqrt{K/(M+m)}$ ", ha="right", va="top")
    close.text(float(data.bare), 1.9 * top, r" $\sqrt{K/M}$", ha="left", va="top")
    grid[1, 0].legend(loc="lower left")


def _hump(data: xr.Dataset, model: str) -> tuple[float, float, float]:
    """Return the rise of the ball's median above twice the resonance over the dip before it, and its half width.

    The half width is a pair of angular frequencies [rad/s] between which the amplitude is at least half of the maximum.
    """
    spectrum = data.ball.sel(quantile=0.5, model=model, frequency=slice(float(data.bare), None))
    above = spectrum.sel(frequency=slice(2 * float(data.riding), None))
    top = above.frequency[int(above.argmax("frequency"))]
    dip = spectrum.sel(frequency=slice(None, float(top))).min()
    wide = above.frequency[above.values > 0.5 * float(above.max())]
    return float(above.max() / dip), float(wide[0]), float(wide[-1])


def _width(spectrum: xr.DataArray) -> float:
    """Return the width of the band of angular frequencies [rad/s] in which a spectrum exceeds a tenth of its maximum."""
    below = spectrum.frequency.values[spectrum.values < 0.1 * float(spectrum.max())]
    top = float(spectrum.frequency[int(spectrum.argmax("frequency"))])
    first, last = float(spectrum.frequency[0]), float(spectrum.frequency[-1])
    return float(min(below[below > top], default=last) - max(below[below < top], default=first))


def _lower(data: xr.Dataset, model: str) -> float:
    """Return the share of bins of both spectra in which the median of a model is below that of constant restitution."""
    shares = [data[name].sel(quantile=0.5) for name in ("ball", "structure")]
    return float(np.mean([(one.sel(model=model) < one.sel(model=CONSTANT_E)).mean() for one in shares]))


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return resonances, the band of the rattle, the resolution [rad/s], and the share of lower amplitudes."""
    peak = data.peak.median("member")
    peaks = {m: estimate(lambda x: x, data.peak.sel(model=m).values) for m in data.model.values}
    medians = data.sel(quantile=0.5)
    widths = {m: _width(medians.ball.sel(model=m)) / _width(medians.structure.sel(model=m)) for m in ALL_MODELS}
    rises = {m: _hump(data, m)[0] for m in ALL_MODELS}
    lower = {m: _lower(data, m) for m in WALLS}
    return {
        "low": peak.min(),
        "high": peak.max(),
        "hump": _hump(data, STEEL),
        "members": MEMBERS,
        "bin": 2 * np.pi / DURATION,
        "hedged": 100 * HEDGED,
        "rattle": data.trips.sel(model=STEEL),
        "bins": data.sizes["frequency"],
        "last": data.frequency[-1],
        "peak": peaks,
        "natural": peaks,
        "second": rises,
        "range": widths,
        "lower": lower,
    }


FIGURE = Reproduction("figure_10", data, draw, 0.85, cases, values)
