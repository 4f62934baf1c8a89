"""Figure 10: amplitude spectra of the ball in its cavity and of the structure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rattlebox import Case, Run
from rattlebox.analysis import amplitude_spectrum
from rattlebox.plots import FAINT, INK, StyledFigure, figure_style, label, pen

from .ensemble import band
from .figure import Reproduction, letters
from .judge import HEDGED, WALLS, Claim, about, by_wall, estimate, exact
from .models import ALL_MODELS, COLOURS, CONSTANT_E, MODELS, SHORT, STEEL, described, model_case, model_runs
from .reference import MASS, STIFFNESS, paper_case
from .runs import simulate

DURATION, RATE = 10.0, 2000.0  # Of the record [s], and its samples a second [Hz]
WINDOW = "boxcar"  # A transient that begins and ends near rest needs no taper, and a taper would hide how it begins
SHOWN = slice(1.0, 300.0)  # Frequencies [Hz]
NEAR, PADDING = slice(9.0, 11.0), 8  # Frequencies about the resonance [Hz], and how much finer their spectrum is drawn
MEMBERS = 20
PRINTED = 61.3  # Resonance that the paper reads [rad/s]
_PARTS = ("ball", "structure", "near")


def _bare() -> Case:
    return paper_case(ball=False, duration=DURATION, rate=RATE)


def cases() -> Mapping[str, Case]:
    """Return the centred cases at 5000 N with all models, and without the damper."""
    return {model: model_case(model, duration=DURATION, rate=RATE) for model in ALL_MODELS} | {
        "without damper": _bare()
    }


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
            spectra[part].append(np.array(band(values)))
        peaks.append(found["near"].frequency.values[found["near"].argmax("frequency")])
        # Two contacts make a round trip.
        trips.append(band(np.concatenate([np.pi / np.diff(run.arrays.impacts.time) for run in runs])))
    bare = [simulate(_bare())]
    without, close = _spectra(bare, "structure")[0], _spectra(bare, "near")[0]
    together = MASS + model_case(CONSTANT_E).impact_dampers[0].masses[0]
    return xr.Dataset(
        {
            "ball": described(("model", "quantile", "frequency"), spectra["ball"], "m", "amplitude of the ball in "
            "its cavity"),
            "structure": described(("model", "quantile", "frequency"), spectra["structure"], "m", "amplitude of the "
            "structure"),
            "near": described(("model", "quantile", "fine"), spectra["near"], "m", "amplitude of the structure"),
            "without": described("frequency", without.values, "m", "amplitude of the structure without damper"),
            "near_without": described("fine", close.values, "m", "amplitude of the structure without damper"),
            "peak": described(("model", "member"), peaks, "rad/s", "highest peak of the structure"),
            "trips": described(("model", "quantile"), trips, "rad/s", "rate of round trips between the walls"),
            "riding": described((), np.sqrt(STIFFNESS / together), "rad/s", "sqrt(K/(M+m))"),
            "bare": described((), np.sqrt(STIFFNESS / MASS), "rad/s", "sqrt(K/M)"),
        },
        {
            "model": described("model", list(ALL_MODELS), "", "model"),
            "frequency": described("frequency", without.frequency.values, "rad/s", "angular frequency"),
            "fine": described("fine", close.frequency.values, "rad/s", "angular frequency about the resonance"),
            "member": described("member", np.arange(MEMBERS), "", "number of the start within a micrometre"),
            "quantile": described("quantile", [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
        },
        {"window": WINDOW, "duration": DURATION},
    )  # fmt: skip


def draw(data: xr.Dataset) -> Figure:
    """Draw one column per model: ball, structure, and the structure near its resonance."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.85)
        grid = figure.subplots(3, len(MODELS), sharey="row")
        for column, model in zip(grid.T, MODELS, strict=True):
            one, colour = data.sel(model=model), COLOURS[model]
            for axes, name in zip(column, _PARTS, strict=True):
                at = data["fine" if name == "near" else "frequency"].values
                low, median, high = one[name].values
                axes.fill_between(at, low, high, color=colour, alpha=0.35, lw=0, rasterized=True)
                axes.plot(at, median, color=colour, lw=pen(0.4), rasterized=name != "near")
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
        top = float(data.near.sel(quantile=0.5).max())
        grid[2, 0].set_ylim(10 ** np.floor(np.log10(top / 25)), 2 * top)
        grid[2, 0].text(float(data.riding), 1.9 * top, r"$\sqrt{K/(M+m)}$ ", ha="right", va="top")
        grid[2, 0].text(float(data.bare), 1.9 * top, r" $\sqrt{K/M}$", ha="left", va="top")
        grid[1, 0].legend(loc="lower left")
        letters(figure)
    return figure


def _hump(data: xr.Dataset, model: str) -> tuple[float, float, float]:
    """Return the ratio of the highest amplitude of the ball's median above twice the resonance to the minimum below it.

    Return as well the angular frequencies [rad/s] between which the amplitude is at least half of that maximum.
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


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    peak = data.peak.median("member")
    low, high = (float(x) for x in (peak.min(), peak.max()))
    _, first, last = _hump(data, STEEL)
    return (
        f"The ball rides along, so that the structure resonates at {low:.2f} to {high:.2f} rad/s, close to "
        "sqrt(K/(M+m)). With a steel wall "
        f"the ball rattles on without loss: the band from {first:.0f} to {last:.0f} rad/s. Case 1, 5 kN, "
        f"{data.attrs['duration']:g} s "
        f"({data.attrs['window']} window); median and 10 to 90 % of {MEMBERS} starts within 1 µm."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the claims on resonance, second peak, wide band, and reduction at all frequencies."""
    bin_width = 2 * np.pi / DURATION
    peaks = {str(m): estimate(lambda x: x, data.peak.sel(model=m).values) for m in data.model.values}
    humps = {m: _hump(data, m) for m in ALL_MODELS}
    medians = data.sel(quantile=0.5)
    widths = {m: _width(medians.ball.sel(model=m)) / _width(medians.structure.sel(model=m)) for m in ALL_MODELS}
    riding, bare = float(data.riding), float(data.bare)
    steel = data.trips.sel(model=STEEL).values
    return (
        Claim(
            "The response peaks at about 61.3 rad/s.",
            "section 5.1, figure 10",
            "highest peak of the structure, case 1, 5 kN (rad/s)",
            by_wall(peaks),
            accept=(PRINTED - bin_width / 2, PRINTED + bin_width / 2),
            printed="~61.3 rad/s",
            scope="both",
            note=f"the tolerance is half of the resolution of 10 s, {bin_width:.2f} rad/s, less than {100 * HEDGED:.0f} %",
        ),
        Claim(
            "That is approximately the natural frequency sqrt(K/M) = 63.24 rad/s.",
            "section 5.1, figure 10",
            "highest peak of the structure, case 1, 5 kN (rad/s)",
            by_wall(peaks),
            accept=about(63.24),
            printed="≈63.24 rad/s",
            scope="both",
            note=f"the ball rides along: sqrt(K/(M+m)) = {riding:.2f} rad/s is closer than sqrt(K/M) = {bare:.2f} rad/s",
        ),
        Claim(
            "A second peak is expected at higher frequencies.",
            "section 5.1, figure 10",
            "rise of the ball's spectrum above the dip before it",
            by_wall({m: exact(humps[m][0]) for m in ALL_MODELS}),
            accept=(2, inf),
            note=f"with a steel wall from {humps[STEEL][1]:.0f} to {humps[STEEL][2]:.0f} rad/s: the rattle of the "
            f"ball at {steel[0]:.0f} to "
            f"{steel[2]:.0f} rad/s, no second resonance; a peak is read as a rise by a factor of 2",
        ),
        Claim(
            "The amplitude is significant in a range of frequencies.",
            "section 5.1, figure 10a",
            "width of the ball's spectrum at a tenth of its peak, over that of the structure",
            by_wall({m: exact(widths[m]) for m in ALL_MODELS}),
            accept=(2, inf),
            scope="both",
        ),
        Claim(
            "The elasto-plastic model lowers the amplitude at all frequencies.",
            "section 5.1, figure 10",
            "share of the frequencies of both spectra at which its median is lower",
            by_wall({m: exact(_lower(data, m)) for m in WALLS}),
            accept=(0.95, 1),
            partly=(0.5, 1),
            note=f"{data.sizes['frequency']} frequencies to {float(data.frequency[-1]):.0f} rad/s",
        ),
    )


FIGURE = Reproduction(
    number="10",
    title="Spectra of the ball in its cavity and of the structure",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
