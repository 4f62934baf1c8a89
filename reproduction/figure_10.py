"""Figure 10: amplitude spectra of the ball in its cavity and of the structure."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from rattlebox import Case, Run
from rattlebox.analysis import amplitude_spectrum
from rattlebox.plots import FAINT, INK, StyledFigure, figure_style, label, pen

from .ensemble import band, ensemble, near
from .figure import Claim, Reproduction
from .models import COLOURS, CONSTANT_E, MODELS, RIGID, STEEL, by_model, described
from .reference import MASS, START, STIFFNESS, paper_case
from .runs import simulate

DURATION, RATE = 10.0, 2000.0
"""Of the record [s], and its samples a second [Hz]."""
WINDOW = "boxcar"
"""A transient that begins and ends near rest needs no taper, and a taper would hide how it begins."""
SHOWN = slice(1.0, 300.0)
"""Frequencies [Hz]."""
NEAR, PADDING = slice(9.0, 11.0), 8
"""Frequencies about the resonance [Hz], and how much finer their spectrum is drawn."""
MEMBERS = 20
PRINTED = 61.3
"""Resonance that the paper reads [rad/s]."""

_WITHOUT = "without damper"


def _case(model: str, start: float = START[1]) -> Case:
    if model == _WITHOUT:
        return paper_case(ball=False, duration=DURATION, rate=RATE)
    return paper_case(MODELS[model], start=start, duration=DURATION, rate=RATE)


def cases() -> Mapping[str, Case]:
    """Return the centred cases at 5000 N: constant restitution, both walls of the elasto-plastic model, no damper."""
    return {model: _case(model) for model in (*MODELS, _WITHOUT)}


def _structure(run: Run) -> np.ndarray:
    return run.arrays.displacement[:-1, 0]


def _ball(run: Run) -> np.ndarray:
    return run.arrays.relative_position[:-1, 0]


def _spectra(runs: Sequence[Run], signal: Callable[[Run], np.ndarray], shown: slice, padding: int = 1) -> xr.DataArray:
    """Return spectra of full seconds, (run, angular frequency); the last sample belongs to the next period."""
    each = [
        amplitude_spectrum(run.arrays.time[:-1], signal(run), window=WINDOW, padding=padding).sel(frequency=shown)
        for run in runs
    ]
    joined = xr.concat(each, "run")
    return joined.assign_coords(frequency=2 * np.pi * joined.frequency)


def data() -> xr.Dataset:
    """Compute the spectra of single runs and ensembles, and the impact rates of the ball."""
    out: dict[str, list[np.ndarray]] = {}
    for model in MODELS:
        single = simulate(_case(model))
        many = ensemble(lambda offset, model=model: _case(model, near(START[1], offset)), MEMBERS)  # type: ignore[misc]
        for name, signal in (("ball", _ball), ("structure", _structure)):
            alone, spread = (_spectra(runs, signal, SHOWN) for runs in ([single], many))
            low, median, high = band(spread)
            for key, values in (("_single", alone[0]), ("_low", low), ("_median", median), ("_high", high)):
                out.setdefault(name + key, []).append(np.asarray(values))
        close = _spectra(many, _structure, NEAR, PADDING)
        out.setdefault("near_single", []).append(_spectra([single], _structure, NEAR, PADDING)[0].values)
        low, median, high = band(close)
        peaks = close.frequency.values[close.argmax("frequency")]
        # Two contacts make a round trip.
        trips = np.concatenate([np.pi / np.diff(run.arrays.impacts.time) for run in many])
        for key, value in (("near_low", low), ("near_median", median), ("near_high", high), ("peak", band(peaks))):
            out.setdefault(key, []).append(np.asarray(value))
        out.setdefault("trips", []).append(np.asarray(band(trips)))
        impacts = single.arrays.impacts
        last = impacts.time[impacts.energy_lost > 0].max(initial=0.0)
        out.setdefault("last_loss", []).append(np.asarray(last))
    bare = [simulate(_case(_WITHOUT))]
    without, close = _spectra(bare, _structure, SHOWN)[0], _spectra(bare, _structure, NEAR, PADDING)[0]

    texts = {"_single": ", single run", "_low": ", 10 % of the ensemble", "_median": ", median", "_high": ", 90 %"}
    spectra = {
        name + key: described(("model", "frequency"), np.array(out[name + key]), "m", f"amplitude of the {name}{text}")
        for name in ("ball", "structure")
        for key, text in texts.items()
    }
    zoomed = {
        "near" + key: described(
            ("model", "near"), np.array(out["near" + key]), "m", "amplitude of the structure" + texts[key]
        )
        for key in texts
    }
    ball_mass = _case(CONSTANT_E).impact_dampers[0].masses[0]
    return xr.Dataset(
        {
            **spectra,
            **zoomed,
            "without": described(("frequency",), without.values, "m", "amplitude of the structure without damper"),
            "near_without": described(("near",), close.values, "m", "amplitude of the structure without damper"),
            "peak": described(("model", "quantile"), np.array(out["peak"]), "rad/s", "highest peak of the structure"),
            "trips": described(
                ("model", "quantile"), np.array(out["trips"]), "rad/s", "rate of round trips between the walls"
            ),
            "last_loss": described(
                ("model",), np.array(out["last_loss"]), "s", "last contact that loses energy, single run"
            ),
            "riding": described((), np.sqrt(STIFFNESS / (MASS + ball_mass)), "rad/s", "sqrt(K/(M+m))"),
            "bare": described((), np.sqrt(STIFFNESS / MASS), "rad/s", "sqrt(K/M)"),
        },
        {
            "model": described(("model",), list(MODELS), "", "model of restitution"),
            "frequency": described(("frequency",), without.frequency.values, "rad/s", "angular frequency"),
            "near": described(("near",), close.frequency.values, "rad/s", "angular frequency about the resonance"),
            "quantile": described(("quantile",), [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
        },
        {"window": WINDOW, "duration": DURATION},
    )


def draw(data: xr.Dataset) -> Figure:
    """Draw one column per model: ball, structure, and the structure near its resonance."""
    with figure_style("page"):
        figure = StyledFigure("page", 1.0)
        grid = figure.subplots(3, len(data.model), sharey="row")
        for j, model in enumerate(data.model.values):
            one, colour = data.sel(model=model), COLOURS[model]
            for axes, name, x in zip(
                grid[:, j], ("ball", "structure", "near"), ("frequency", "frequency", "near"), strict=True
            ):
                at = data[x].values
                axes.plot(at, one[f"{name}_single"], color=FAINT, linewidth=pen(0.4), zorder=1, label="single run")
                axes.fill_between(
                    at,
                    one[f"{name}_low"],
                    one[f"{name}_high"],
                    color=colour,
                    alpha=0.3,
                    linewidth=0,
                    label="10 to 90 %",
                )
                axes.plot(at, one[f"{name}_median"], color=colour, linewidth=pen(0.9), label="median")
                if model != CONSTANT_E:
                    reference = data[f"{name}_median"].sel(model=CONSTANT_E)
                    axes.plot(
                        at, reference, color=INK, linewidth=pen(0.5), zorder=1.5, label="constant restitution, median"
                    )
                if name != "ball":
                    bare = data["without" if name == "structure" else "near_without"]
                    axes.plot(at, bare, color=INK, linestyle=(0, (1, 1.2)), linewidth=pen(0.8), label="without damper")
                axes.set_yscale("log")
                for place, style in ((data.riding, "-"), (data.bare, (0, (5, 1.5)))):
                    axes.axvline(float(place), color=INK, linestyle=style, linewidth=pen(0.4), zorder=0)
                axes.set_xlim(at[0], at[-1])
            for axes in grid[:2, j]:
                axes.set_xscale("log")
                axes.set_xticks([10, 100, 1000], ["10", "100", "1000"])
            for axes in grid[:, j]:
                label(axes, "x", "Angular frequency", "rad/s")
            grid[0, j].set_title(model.replace(", ", ",\n") if ", " in model else f"{model}\n")
        for axes, text in zip(
            grid[:, 0], ("10a  Ball in cavity", "10b  Structure", "10b  near resonance"), strict=True
        ):
            label(axes, "y", text, "m")
        top = float(data.near_median.max())
        grid[2, 0].set_ylim(10 ** np.floor(np.log10(top / 25)), 2 * top)
        grid[2, 0].text(float(data.riding), 1.9 * top, r"$\sqrt{K/(M+m)}$ ", ha="right", va="top")
        grid[2, 0].text(float(data.bare), 1.9 * top, r" $\sqrt{K/M}$", ha="left", va="top")
        handles, names = grid[1, 1].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside upper center", ncols=5)
    return figure


def _hump(data: xr.Dataset, model: str) -> tuple[float, float, float]:
    """Return the ratio of the highest amplitude of the ball's median above twice the resonance to the minimum below it.

    Return as well the angular frequencies [rad/s] between which the amplitude is at least half of that maximum.
    """
    spectrum = data.ball_median.sel(model=model, frequency=slice(float(data.bare), None))
    above = spectrum.sel(frequency=slice(2 * float(data.riding), None))
    top = above.frequency[int(above.argmax("frequency"))]
    dip = spectrum.sel(frequency=slice(None, float(top))).min()
    wide = above.frequency[above.values > 0.5 * float(above.max())]
    return float(above.max() / dip), float(wide[0]), float(wide[-1])


def _wide(spectrum: xr.DataArray) -> tuple[float, float]:
    """Return the angular frequencies [rad/s] between which a spectrum exceeds a tenth of its maximum."""
    below = spectrum.frequency.values[spectrum.values < 0.1 * float(spectrum.max())]
    top = float(spectrum.frequency[int(spectrum.argmax("frequency"))])
    first, last = float(spectrum.frequency[0]), float(spectrum.frequency[-1])
    return float(max(below[below < top], default=first)), float(min(below[below > top], default=last))


def _lower(data: xr.Dataset, name: str, model: str) -> float:
    """Return the share of bins in which the median of a model is below that of constant restitution."""
    median = data[f"{name}_median"]
    return float((median.sel(model=model) < median.sel(model=CONSTANT_E)).mean())


def _lifted(data: xr.Dataset, model: str) -> float:
    """Return the largest ratio of the structure's median to its amplitude without damper above twice the resonance."""
    ratio = data.structure_median.sel(model=model) / data.without
    return float(ratio.sel(frequency=slice(2 * float(data.riding), None)).max())


def _bare_peak(data: xr.Dataset) -> float:
    return float(data.near[int(data.near_without.argmax("near"))])


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    peak = data.peak.sel(quantile=0.5)
    rise, low, high = _hump(data, STEEL)
    trips = data.trips.sel(model=STEEL).values
    wide = (data.ball_high - data.ball_low) / data.ball_median
    out = (data.ball_single < data.ball_low) | (data.ball_single > data.ball_high)
    width = {str(m): f"{100 * float(wide.sel(model=m).median()):.3g} %" for m in data.model.values}
    apart = np.abs(np.log(data.ball_median.sel(model=RIGID) / data.ball_median.sel(model=CONSTANT_E)))
    return (
        f"Amplitude spectra of the first {data.attrs['duration']:g} s after the pulse of 5000 N, case 1, without a taper "
        f"({data.attrs['window']} window); an amplitude is that of a steady sine over the record, and bins are "
        f"{2 * np.pi / data.attrs['duration']:.2f} rad/s apart. Bands: {MEMBERS} starts within 1 µm; "
        f"their width in the ball's spectrum is, in the middle, {by_model(width)} of the median, and a "
        f"single run leaves it at {100 * float(out.mean()):.0f} % of the frequencies. "
        "The ball rides along: with it the structure resonates "
        f"at {float(peak.min()):.2f} to {float(peak.max()):.2f} rad/s, close to sqrt(K/(M+m)) = {float(data.riding):.2f}; "
        f"without it at {_bare_peak(data):.2f} rad/s, close to sqrt(K/M) = {float(data.bare):.2f}. With the elasto-plastic "
        f"model and a steel wall no contact loses energy after {float(data.last_loss.sel(model=STEEL)):.2f} s, and the "
        f"ball rattles on from wall to wall at {trips[0]:.0f} to {trips[2]:.0f} rad/s: a band from {low:.0f} to "
        f"{high:.0f} rad/s, {rise:.0f} times above the dip before it, that lifts the structure to up to "
        f"{_lifted(data, STEEL):.0f} times its amplitude without damper. With a rigid wall the ball's median stays "
        f"within a factor of {float(np.exp(apart.quantile(0.9))):.1f} of that of constant restitution in nine of ten bins."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the verdicts on resonance, second peak, wide band, and reduction at all frequencies."""
    peak = data.peak.sel(quantile=0.5)
    listed = by_model({model: f"{float(peak.sel(model=model)):.2f} rad/s" for model in peak.model.values})
    bin_width = 2 * np.pi / data.attrs["duration"]
    riding, bare, alone = float(data.riding), float(data.bare), _bare_peak(data)
    near_riding = bool((np.abs(peak - riding) < np.abs(peak - bare)).all())
    humps = {str(model): _hump(data, str(model)) for model in data.model.values}
    best = max(humps, key=lambda model: humps[model][0])
    ball, structure = (_wide(data[f"{name}_median"].sel(model=CONSTANT_E)) for name in ("ball", "structure"))
    shares = {(name, model): _lower(data, name, model) for name in ("ball", "structure") for model in (STEEL, RIGID)}
    least = min(shares.values())
    return (
        Claim(
            f"The response peaks at about {PRINTED} rad/s.",
            "section 5.1, figure 10",
            f"{listed}; resolved to {bin_width:.2f} rad/s",
            "case 1 at 5000 N; all models",
            "reproduced" if float(np.abs(peak - PRINTED).max()) < bin_width / 2 else "not reproducible",
        ),
        Claim(
            "The peak of the response is the natural frequency sqrt(K/M) of the structure.",
            "section 5.1, figure 10",
            f"it is sqrt(K/(M+m)) = {riding:.2f} rad/s: the ball rides along; sqrt(K/M) = {bare:.2f} rad/s is the peak "
            f"without it ({alone:.2f} rad/s)",
            "case 1 at 5000 N; all models",
            "not reproducible" if near_riding else "reproduced",
        ),
        Claim(
            "A second resonance shows at higher frequencies.",
            "section 5.1, figure 10",
            f"a band from {humps[best][1]:.0f} to {humps[best][2]:.0f} rad/s stands {humps[best][0]:.0f} times above the "
            "dip before it: the rattle of the ball from wall to wall, not a resonance; with the others the rise is "
            + " and ".join(f"{rise:.1f}fold" for model, (rise, _, _) in humps.items() if model != best),
            f"{best}; case 1 at 5000 N",
            "reproduced qualitatively" if humps[best][0] > 10 else "not reproducible",
        ),
        Claim(
            "The ball's amplitude is significant over a range of frequencies.",
            "section 5.1, figure 10a",
            f"the ball keeps above a tenth of its peak up to {ball[1]:.0f} rad/s, the structure only from "
            f"{structure[0]:.0f} to {structure[1]:.0f} rad/s",
            "constant restitution, case 1 at 5000 N; medians",
            "reproduced" if np.diff(ball) > 3 * np.diff(structure) else "not reproducible",
        ),
        Claim(
            "The elasto-plastic model lowers the amplitude at all frequencies.",
            "section 5.1, figure 10",
            "frequencies at which it does (medians): "
            + "; ".join(
                f"{100 * shares['ball', model]:.0f} % (ball) and {100 * shares['structure', model]:.0f} % (structure) with "
                f"the {wall} wall"
                for model, wall in ((STEEL, "steel"), (RIGID, "rigid"))
            ),
            f"steel or rigid wall against α = 0.006313, {len(data.frequency)} bins to {float(data.frequency[-1]):.0f} rad/s",
            "reproduced" if least > 0.99 else "reproduced qualitatively" if least > 0.9 else "not reproducible",
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
