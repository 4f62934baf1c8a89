"""Figure A2: number of contacts per cycle of a harmonic load against its frequency."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from math import ceil, pi

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rattlebox import Case, Run
from rattlebox.analysis import impacts_per_cycle
from rattlebox.plots import INK, SERIES_COLOURS, StyledFigure, figure_style, pen

from .ensemble import band, ensemble, near
from .figure import Claim, Reproduction
from .harmonic import State, harmonic_case, resonance
from .models import MODELS, by_model, described
from .reference import DAMPING, GAP, MASS, STIFFNESS
from .runs import simulate_many

AMPLITUDE = 20.0
"""Of the load [N]."""
FREQUENCIES = np.arange(30, 231, 2) / 10
"""Of the load [Hz]."""
APART = 0.5
"""Difference of mean counts above which two motions differ."""
SETTLING, COUNTED = 30.0, 15.0
"""Time left to settle, and least time counted afterwards [s]."""
MEMBERS = 6


def _case(model: str, frequency: float, offset: float = 0.0) -> Case:
    """Return a case whose ball starts at the leading wall; from the centre it has no contact at high frequencies."""
    duration = (ceil(SETTLING * frequency) + ceil(COUNTED * frequency)) / frequency
    return harmonic_case(
        MODELS[model],
        amplitude=AMPLITUDE,
        frequency=frequency,
        state=State(ball_position=GAP * near(1.0, offset)),
        duration=duration,
        times=(0.0,),
    )


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
    runs = simulate_many([_case(model, frequency) for model, frequency in grid])
    counts = [_counts(run, frequency) for run, (_, frequency) in zip(runs, grid, strict=True)]
    means = [
        [_counts(run, frequency).mean() for run in ensemble(partial(_case, model, frequency), MEMBERS)]
        for model, frequency in grid
    ]
    top = max(int(count.max()) for count in counts)
    shape = len(MODELS), FREQUENCIES.size
    shares = np.array([np.bincount(count, minlength=top + 1) / count.size for count in counts])
    over = ("model", "frequency")
    return xr.Dataset(
        {
            "share": described((*over, "count"), shares.reshape(*shape, -1), "", "share of the cycles with this count"),
            "mean": described(
                over, np.reshape([c.mean() for c in counts], shape), "", "mean contacts a cycle, one run"
            ),
            "mean_spread": described(
                ("quantile", *over),
                np.reshape(band(means, axis=1), (3, *shape)),
                "",
                "mean contacts a cycle, ensemble of start positions",
            ),
            "cycles": described("frequency", [c.size for c in counts[: shape[1]]], "", "cycles counted"),
            "alone": described("frequency", _bare_amplitude(FREQUENCIES), "m", "amplitude of the structure alone"),
            "gap": described((), GAP, "m", "clearance on each side of the centred ball"),
            "resonance": described((), resonance(), "Hz", "natural frequency with the ball riding along"),
            "amplitude": described((), AMPLITUDE, "N", "amplitude of the load"),
        },
        {
            "model": described("model", list(MODELS), "", "contact model"),
            "frequency": described("frequency", FREQUENCIES, "Hz", "frequency of the load"),
            "quantile": described("quantile", [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
            "count": described("count", np.arange(top + 1), "", "contacts in a cycle"),
        },
    )


def draw(data: xr.Dataset) -> Figure:
    """Draw how often each count occurs, one panel per model."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.85)
        panels = figure.subplots(data.model.size, 1, sharex=True, sharey=True)
        step = float(data.frequency[1] - data.frequency[0])
        edges = np.append(data.frequency - step / 2, data.frequency[-1] + step / 2)
        rows = np.append(data["count"] - 0.5, data["count"][-1] + 0.5)
        for axes, model in zip(panels, data.model.values, strict=True):
            one = data.sel(model=model)
            shade = axes.pcolormesh(
                edges, rows, one.share.where(one.share > 0).T, cmap="Greys", vmin=0, vmax=1, rasterized=True
            )
            low, median, high = one.mean_spread.values
            axes.fill_between(
                data.frequency, low, high, color=SERIES_COLOURS[0], alpha=0.35, lw=0, label="mean, 10 to 90 %"
            )
            axes.plot(data.frequency, median, color=SERIES_COLOURS[0], lw=pen(0.9), label="mean, median of starts")
            axes.plot(data.frequency, one["mean"], color=SERIES_COLOURS[2], lw=pen(0.4), label="mean, one run")
            steady = one.sel(frequency=one.frequency[_steady(one)])
            axes.plot(steady.frequency, steady["mean"], "s", ms=2.2, mew=0, color=SERIES_COLOURS[1],
                      label="one run, all cycles alike")  # fmt: skip
            axes.axvline(float(data.resonance), color=INK, lw=pen(0.5), ls=(0, (4, 3)), zorder=0)
            axes.set_title(model)
        # Low counts, where the steps are, get the room.
        axes.set_yscale("function", functions=(lambda y: np.sqrt(np.maximum(y + 1.5, 0)), lambda y: y**2 - 1.5))
        axes.set_yticks([0, 1, 2, 3, 4, 6, 8, 12, 16, 20, 24])
        axes.set_ylim(-0.5, float(rows[-1]))
        axes.set_xlim(edges[0], edges[-1])
        axes.set_xlabel("Frequency of the load (Hz)")
        panels[1].set_ylabel("Contacts in a cycle")
        panels[0].text(
            float(data.resonance) + 0.3, 20, "natural frequency with\nthe ball riding along", va="top", ha="left"
        )
        figure.legend(*axes.get_legend_handles_labels(), loc="outside upper left", ncols=4)
        figure.colorbar(shade, ax=panels, aspect=50, pad=0.01, label="Share of the cycles")
    return figure


def _steady(one: xr.Dataset) -> NDArray[np.bool_]:
    """Return for each frequency whether all cycles have the same count."""
    return np.asarray((one.share == 1).any("count"))


def _bands(one: xr.Dataset) -> list[tuple[float, float, int]]:
    """Return the widest frequency bands with the same count in all cycles, as (from, to, count) by frequency."""
    counts = np.where(_steady(one), one.share.argmax("count"), -1)
    borders = np.flatnonzero(np.diff(counts)) + 1
    bands = [
        (float(one.frequency[k[0]]), float(one.frequency[k[-1]]), int(counts[k[0]]))
        for k in np.split(np.arange(counts.size), borders)
        if counts[k[0]] >= 0 and k.size > 2
    ]
    return sorted(sorted(bands, key=lambda band: band[0] - band[1])[:3])


def _band_text(bands: list[tuple[float, float, int]]) -> str:
    return ", ".join(f"{count} from {low:g} to {high:g} Hz" for low, high, count in bands) or "in no band"


def _sensitivity(data: xr.Dataset) -> str:
    """Return a sentence on frequencies at which a micrometre changes the steady motion."""
    low, _, high = data.mean_spread.transpose("quantile", ...)
    none, wide = (high - low) == 0, (high - low) > APART
    return (
        f"The band has no width at {100 * float(none.mean()):.0f} % of all frequencies and models, where all starts come to "
        f"the same count; it is wider than {APART:g} contacts at {100 * float(wide.mean()):.0f} %; there, and where the "
        "single run lies outside, a micrometre decides in which motion a run ends."
    )


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    one = data.isel(model=0)
    at = float(one["mean"].idxmax())
    reached = data.frequency.values[data.alone > data.gap]
    texts = "; ".join(f"{model}: {_band_text(_bands(data.sel(model=model)))}" for model in data.model.values)
    return (
        f"Number of contacts in a cycle of a load of {float(data.amplitude):g} N, after {SETTLING:g} s of settling: of one "
        "run in grey, the darker, the more cycles have it (marks: all have the same number), and the mean of the cycles for "
        f"that run and for {MEMBERS} starts within 1 µm. {_sensitivity(data)} The constant model has "
        f"{float(one['mean'].max()):.1f} contacts a cycle on average at {at:g} Hz, close to the natural frequency with "
        f"the ball riding along, {float(data.resonance):.2f} Hz. Wide bands with one number in all cycles: {texts}. "
        "Between them the number changes from cycle to cycle. Only from "
        f"{reached[0]:g} to {reached[-1]:g} Hz would the structure alone reach the walls around a ball at rest in the "
        "centre; elsewhere the ball may also lose touch for good."
    )


def _join(numbers: Sequence[int]) -> str:
    *first, last = map(str, numbers)
    return f"{', '.join(first)} or {last}" if first else last


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the verdict on the expected bifurcation."""
    found = []
    for model in data.model.values:
        one = data.sel(model=model)
        steady = _steady(one)
        share = float(steady.mean())
        kinds = np.unique(one.share.argmax("count").values[steady])
        found.append((model, share, kinds, one))
    changing = all(0 < share < 1 for _, share, _, _ in found)
    ours = by_model({model: f"{100 * share:.0f} %" for model, share, _, _ in found})
    numbers = sorted({int(kind) for _, _, each, _ in found for kind in each})
    highest = max(float(one["mean"].max()) for *_, one in found)
    return (
        Claim(
            "The number of contacts in a cycle is expected to bifurcate as the frequency of a harmonic load varies.",
            "section 6.1",
            f"up to {highest:.0f} contacts a cycle; all cycles have one number ({_join(numbers)}) at {ours} of the "
            "frequencies",
            f"expected there, not computed; {float(data.amplitude):g} N and {float(data.frequency[0]):g} to "
            f"{float(data.frequency[-1]):g} Hz are ours",
            "reproduced" if changing else "not reproducible",
        ),
    )


FIGURE = Reproduction(
    number="A2",
    title="Contacts in a cycle of a harmonic load",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
