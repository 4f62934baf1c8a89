"""Figure A2: number of contacts per cycle of a harmonic load against its frequency."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from math import ceil, inf, pi

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rattlebox import Case, Run
from rattlebox.analysis import impacts_per_cycle
from rattlebox.plots import INK, StyledFigure, figure_style, pen

from .ensemble import band, ensemble, near
from .figure import Reproduction, letters
from .harmonic import State, harmonic_case, resonance
from .judge import Claim, by_wall, exact
from .models import COLOURS, MODELS, SHORT, described
from .reference import DAMPING, GAP, MASS, STIFFNESS
from .runs import simulate_many

AMPLITUDE = 20.0  # Of the load [N]
FREQUENCIES = np.arange(30, 231, 2) / 10  # Of the load [Hz]
APART = 0.5  # Difference of mean counts above which two motions differ
SETTLING, COUNTED = 30.0, 15.0  # Time left to settle, and least time counted afterwards [s]
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
            colour = COLOURS[str(model)]
            axes.fill_between(data.frequency, low, high, color=colour, alpha=0.35, lw=0, label="mean, 10 to 90 %")
            axes.plot(data.frequency, median, color=colour, lw=pen(0.9), label="mean, median of starts")
            axes.plot(data.frequency, one["mean"], color=INK, lw=pen(0.5), ls=(0, (1, 1.2)), label="mean, one run")
            steady = one.sel(frequency=one.frequency[_steady(one)])
            axes.plot(
                steady.frequency, steady["mean"], "s", ms=2.5, mew=0, color=INK, label="one run, all cycles alike"
            )
            axes.axvline(float(data.resonance), color=INK, lw=pen(0.5), ls=(0, (4, 3)), zorder=0)
            axes.set_title(SHORT[str(model)])
        # Low counts, where the steps are, get the room.
        axes.set_yscale("function", functions=(lambda y: np.sqrt(np.maximum(y + 1.5, 0)), lambda y: y**2 - 1.5))
        axes.set_yticks([0, 1, 2, 4, 8, 12, 16, 20, 24])
        axes.set_ylim(-0.5, float(rows[-1]))
        axes.set_xlim(edges[0], edges[-1])
        axes.set_xlabel("Frequency of the load (Hz)")
        panels[1].set_ylabel("Contacts in a cycle (uneven scale)")
        panels[0].text(
            float(data.resonance) + 0.3, 20, "natural frequency with\nthe ball riding along", va="top", ha="left"
        )
        figure.legend(*axes.get_legend_handles_labels(), loc="outside upper left", ncols=4)
        figure.colorbar(shade, ax=panels, aspect=50, pad=0.01, label="Share of the cycles")
        letters(figure)
    return figure


def _steady(one: xr.Dataset) -> NDArray[np.bool_]:
    """Return for each frequency whether all cycles have the same count."""
    return np.asarray((one.share == 1).any("count"))


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    low, _, high = data.mean_spread.transpose("quantile", ...)
    none, wide = 100 * float(((high - low) == 0).mean()), 100 * float(((high - low) > APART).mean())
    return (
        f"The number of contacts in a cycle jumps with the frequency of a load of {float(data.amplitude):g} N. Grey: "
        "share of the cycles of "
        f"one run; squares: all cycles alike; lines: mean, of one run and of {MEMBERS} starts within 1 µm, which "
        f"agree at {none:.0f} % "
        f"of the frequencies and differ by more than {APART:g} at {wide:.0f} %."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the claim on the expected bifurcation."""
    cells, numbers = {}, set()
    for model in data.model.values:
        one = data.sel(model=model)
        steady = _steady(one)
        counts = {int(count) for count in one.share.argmax("count").values[steady]}
        cells[str(model)] = exact(len(counts) if 0 < steady.mean() < 1 else 1)
        numbers |= counts
    return (
        Claim(
            "A bifurcation in the number of contacts in a cycle is expected as the frequency of a harmonic load varies.",
            "section 6.1",
            f"different numbers of contacts that all cycles of a run share, {float(data.frequency[0]):g} to "
            f"{float(data.frequency[-1]):g} Hz",
            by_wall(cells),
            accept=(2, inf),
            note=f"expected there, not computed; the load of {float(data.amplitude):g} N is ours; numbers: "
            f"{', '.join(map(str, sorted(numbers)))}",
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
