"""Figure A3: approach speed of impacts against frequency and amplitude of a harmonic load."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rattlebox import Case, JacksonGreen, Run, contact_pairs, restitution_of_alpha
from rattlebox.plots import INK, StyledFigure, figure_style, pen

from .ensemble import band, ensemble, near
from .figure import Reproduction, letters
from .harmonic import BALL, State, harmonic_case
from .models import COLOURS, CONSTANT_E, MODELS, RIGID, SHORT, described
from .reference import ALPHA, DAMPING, GAP, MASS, STIFFNESS
from .runs import simulate_many
from .two_impacts import TwoImpacts, two_impacts

AMPLITUDE, FREQUENCY = 20.0, 18.0  # Of the load, while the other one varies [N], [Hz]
FREQUENCIES = np.arange(120, 241) / 10
AMPLITUDES = np.arange(8, 161) / 2
DURATION = 30.0  # Of each run [s]; the last impacts count
HITS = 60  # Impacts kept of each run
MEMBERS = 6
SHOWN = CONSTANT_E, RIGID  # Models of the rows


def _case(model: str, amplitude: float, frequency: float, offset: float = 0.0) -> Case:
    return harmonic_case(
        MODELS[model],
        amplitude=amplitude,
        frequency=frequency,
        state=State(ball_position=GAP * near(1.0, offset)),
        duration=DURATION,
        times=(0.0,),
    )


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
    border = FREQUENCIES.size
    variables: dict[str, Any] = {
        "amplitude_at": described((), AMPLITUDE, "N", "amplitude while frequency varies"),
        "frequency_at": described((), FREQUENCY, "Hz", "frequency while amplitude varies"),
        "critical_speed": described((), _critical_speed(), "m/s", "elastic limit of the elasto-plastic model"),
    }
    for name, part in (("frequency", slice(border)), ("amplitude", slice(border, None))):
        variables[f"speed_over_{name}"] = described(
            ("model", name, "hit"), by_model[:, part], "m/s", "relative speed at impact, one run"
        )
        variables[f"spread_over_{name}"] = described(
            ("model", name, "quantile"), spread[:, part], "m/s", "relative speed at impact, ensemble of start positions"
        )
        variables[f"alike_over_{name}"] = described(
            ("model", name), alike[:, part], "", "share of the starts whose last impacts are all alike"
        )
        for column, kind in enumerate(("stable", "unstable")):
            variables[f"{kind}_over_{name}"] = described(
                name, exact[part, column], "m/s", f"exact speed with two hard impacts a cycle, {kind}"
            )
    return xr.Dataset(
        variables,
        {
            "model": described("model", list(SHOWN), "", "contact model"),
            "frequency": described("frequency", FREQUENCIES, "Hz", "frequency of the load"),
            "amplitude": described("amplitude", AMPLITUDES, "N", "amplitude of the load"),
            "quantile": described("quantile", [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
            "hit": described("hit", np.arange(HITS), "", "number of the kept impact"),
        },
    )


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


def _critical_speed() -> float:
    """Return the speed below which the elasto-plastic model with a rigid wall is lossless [m/s]."""
    law = MODELS[RIGID].restitution
    assert isinstance(law, JacksonGreen)
    return law.critical_speed(contact_pairs(_case(RIGID, AMPLITUDE, FREQUENCY), 0)[0])


def _exact(amplitude: float, frequency: float) -> NDArray[np.float64]:
    """Return the speed of the faster motion with two impacts per cycle [m/s], first if it is stable, else second."""
    found: tuple[TwoImpacts, ...] = two_impacts(
        mass=MASS,
        stiffness=STIFFNESS,
        damping=DAMPING,
        ball=BALL,
        clearance=2 * GAP,
        restitution=float(restitution_of_alpha(ALPHA, "zero_overlap")),
        amplitude=amplitude,
        frequency=frequency,
    )
    speeds = np.full(2, np.nan)
    if found:
        speeds[int(found[0].multiplier >= 1)] = found[0].approach_speed
    return speeds


def draw(data: xr.Dataset) -> Figure:
    """Draw the speeds over frequency and amplitude, one row per model, with the exact motion in the first row."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.78)
        panels = figure.subplots(data.model.size, 2, sharex="col", sharey=True)
        for row, model in zip(panels, data.model.values, strict=True):
            for axes, name in zip(row, ("frequency", "amplitude"), strict=True):
                speeds = data[f"speed_over_{name}"].sel(model=model)
                low, median, high = (
                    1e3 * data[f"spread_over_{name}"].sel(model=model).transpose("quantile", name).values
                )
                look: dict[str, Any] = {"color": COLOURS[model], "zorder": 0.5}
                axes.fill_between(
                    data[name], low, high, alpha=0.2, lw=0, label="starts within 1 µm, 10 to 90 %", **look
                )
                axes.plot(data[name], median, lw=pen(0.6), label="their median", **look)
                at = np.repeat(data[name].values, data.hit.size)
                axes.plot(at, 1e3 * speeds.values.ravel(), ".", ms=1.3, mew=0, color=INK, rasterized=True)
                if model == CONSTANT_E:
                    _draw_exact(axes, data, name)
                else:
                    limit = 1e3 * float(data.critical_speed)
                    axes.axhline(
                        limit, color=INK, ls=(0, (4, 2)), lw=pen(0.8), zorder=0, label="elastic below this speed"
                    )
            row[0].set_title(SHORT[model])
            row[0].set_ylabel("Speed at impact (mm/s)")
        panels[0, 0].set_ylim(0, 1050 * float(data.speed_over_amplitude.max()))
        panels[0, 0].set_xlim(float(data.frequency[0]), float(data.frequency[-1]))
        panels[0, 1].set_xlim(float(data.amplitude[0]), float(data.amplitude[-1]))
        panels[-1, 0].set_xlabel(f"Frequency of the load of {float(data.amplitude_at):g} N (Hz)")
        panels[-1, 1].set_xlabel(f"Amplitude of the load at {float(data.frequency_at):g} Hz (N)")
        letters(figure)
        lines = {line.get_label(): line for axes in panels[::-1, 0] for line in axes.get_legend_handles_labels()[0]}
        figure.legend(handles=list(lines.values()), loc="outside upper left", ncols=3)
    return figure


def _draw_exact(axes: Axes, data: xr.Dataset, name: str) -> None:
    for kind, style in (("stable", "-"), ("unstable", (0, (1.2, 0.8)))):
        axes.plot(
            data[name],
            1e3 * data[f"{kind}_over_{name}"],
            color=INK,
            alpha=0.45,
            ls=style,
            lw=pen(2.6),
            zorder=0.8,
            label=f"exact, two hard impacts a cycle, {kind}",
        )


def is_settled(data: xr.Dataset, name: str) -> xr.DataArray:
    """Return for which runs all speeds agree within 1 %."""
    speeds = data[f"speed_over_{name}"].transpose(..., "hit")
    return speeds.isel(hit=0).copy(data=_agree(speeds.values))


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    one = data.sel(model=CONSTANT_E)
    stable = np.isfinite(one.stable_over_frequency)
    off = np.abs(one.speed_over_frequency.mean("hit") / one.stable_over_frequency - 1)
    met = is_settled(one, "frequency") & (off < 0.05)
    shares = np.concatenate([one[f"alike_over_{name}"] for name in ("frequency", "amplitude")])
    return (
        "One dot per load means that all impacts are alike. With constant restitution all starts settle so at "
        f"{np.sum(shares == 1)} of "
        f"{shares.size} loads and none at {np.sum(shares == 0)}; elsewhere a micrometre decides. Runs settle on the "
        "exact motion at "
        f"{int(met.sum())} of the {int(stable.sum())} frequencies at which it is stable. Last {data.hit.size} impacts "
        f"of {DURATION:g} s."
    )


FIGURE = Reproduction(
    number="A3",
    title="Bifurcations of the relative speed at impact",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
)
