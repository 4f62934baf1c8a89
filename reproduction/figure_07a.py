"""Figure 7a: instantaneous energies with the elasto-plastic impact model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rattlebox import Case, Run
from rattlebox.plots import CHANNEL_COLOURS, INK, StyledFigure, figure_style, label, pen, scaled

from .ensemble import band, ensemble, near
from .figure import Claim, Reproduction
from .models import CONSTANT_E, MODELS, RIGID, STEEL, by_model, described
from .reference import START, paper_case
from .runs import simulate

PARTS: Mapping[str, str] = {"structure": "structure", "particles": "ball"}
LATE = 2.0
"""From here on the paper looks at the smoothness [s]."""
_SPAN, _RATE = 10.0, 250.0
_BEGIN, _BEGIN_RATE = 0.6, 2500.0
_WINDOW = 25
"""Samples of a mean over 0.1 s, one period of the structure."""


def cases(models: Sequence[str] = (STEEL, RIGID)) -> Mapping[str, Case]:
    """Return the centred ball under the 5000 N pulse.

    Parameters
    ----------
    models
        Names of the contact models.
    """
    whole = {model: _case(model, name=model) for model in {**dict.fromkeys(models), CONSTANT_E: None}}
    return whole | {f"{model}, beginning": _begun(model) for model in models}


def _case(model: str, offset: float = 0.0, span: float = _SPAN, rate: float = _RATE, name: str = "") -> Case:
    return paper_case(MODELS[model], start=near(START[1], offset), duration=span, rate=rate, name=name)


def _begun(model: str, offset: float = 0.0) -> Case:
    return _case(model, offset, span=_BEGIN, rate=_BEGIN_RATE)


def _energies(run: Run) -> NDArray[np.float64]:
    return np.array([getattr(run.ledger, part) for part in PARTS])


def _means(energies: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(energies[:, 1:].reshape(len(PARTS), -1, _WINDOW).mean(axis=2))


def _rises(run: Run) -> float:
    """Return the energy that the ball returns: only impacts can increase the energy of the structure."""
    late = run.ledger.structure[run.arrays.time >= LATE]
    return float(np.maximum(np.diff(late), 0).sum() / late[0])


def data(models: Sequence[str] = (STEEL, RIGID)) -> xr.Dataset:
    """Compute the energies of structure and ball, of one run and of an ensemble.

    Parameters
    ----------
    models
        Names of the contact models.
    """
    single = [simulate(_case(model)) for model in models]
    begun = [simulate(_begun(model)) for model in models]
    beginnings = [[_energies(run) for run in ensemble(partial(_begun, model))] for model in models]
    ensembles = {model: ensemble(partial(_case, model)) for model in {*models, CONSTANT_E}}
    time = single[0].arrays.time
    means = [[_means(_energies(run)) for run in ensembles[model]] for model in models]
    judged = sorted(ensembles, key=list(MODELS).index)
    return xr.Dataset(
        {
            "begin_energy": described(
                ("model", "part", "begin"), [_energies(run) for run in begun], "J", "energy at the beginning, one run"
            ),
            "begin_spread": described(
                ("quantile", "model", "part", "begin"),
                band(beginnings, axis=1),
                "J",
                "energy at the beginning, ensemble of start positions",
            ),
            "energy": described(("model", "part", "time"), [_energies(run) for run in single], "J", "energy, one run"),
            "mean": described(
                ("quantile", "model", "part", "window"),
                band(means, axis=1),
                "J",
                "energy, mean over 0.1 s, ensemble of start positions",
            ),
            "rises": described(
                ("quantile", "judged"),
                band([[_rises(run) for run in ensembles[model]] for model in judged], axis=1),
                "",
                "sum of the rises of the structure's energy after 2 s over its energy at 2 s, ensemble",
            ),
            "late_contacts": described(
                ("quantile", "judged"),
                band(
                    [[(run.arrays.impacts.time > LATE).sum() for run in ensembles[model]] for model in judged], axis=1
                ),
                "",
                "contacts after 2 s, ensemble",
            ),
        },
        {
            "begin": described("begin", begun[0].arrays.time, "s", "time, beginning"),
            "time": described("time", time, "s", "time"),
            "window": described("window", time[1:].reshape(-1, _WINDOW).mean(axis=1), "s", "middle of the mean"),
            "model": described("model", list(models), "", "contact model"),
            "judged": described("judged", judged, "", "contact model compared"),
            "part": described("part", list(PARTS.values()), "", "body"),
            "quantile": described("quantile", [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
        },
    )


def draw(data: xr.Dataset) -> Figure:
    """Draw one row per model: the beginning, and ten seconds on a logarithmic axis."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.1 + 0.26 * data.model.size)
        panels = figure.subplots(data.model.size, 2, sharex="col", sharey="col", squeeze=False, width_ratios=(1, 1.2))
        for row, model in zip(panels, data.model.values, strict=True):
            _begin(row[0], data.sel(model=model))
            _whole(row[1], data.sel(model=model))
            row[0].set_title(str(model))
        handles, names = panels[0, 1].get_legend_handles_labels()
        order = [0, 3, 1, 4, 2, 5]
        figure.legend([handles[k] for k in order], [names[k] for k in order], loc="outside lower center", ncols=3)
        for panel in panels[-1]:
            label(panel, "x", "Time", "s")
    return figure


def _begin(axes: Axes, data: xr.Dataset) -> None:
    """Draw the energies before most of them is dissipated."""
    scale = scaled(data.begin_energy, "J")
    for part, name in PARTS.items():
        colour = CHANNEL_COLOURS[part]
        energy = data.begin_energy.sel(part=name) / scale.divisor
        low, median, high = data.begin_spread.sel(part=name).transpose("quantile", "begin").values / scale.divisor
        axes.fill_between(data.begin, low, high, color=colour, alpha=0.35, lw=0)
        axes.plot(data.begin, median, color=INK, ls=":", lw=pen(0.7), zorder=1)
        axes.plot(data.begin, energy, color=colour, lw=pen(0.8))
        axes.text(0.4, float(energy.max()) * (0.95 if part == "structure" else 1.25), name, color=colour)
    axes.set_xlim(0, _BEGIN)
    axes.set_ylim(bottom=0)
    label(axes, "y", "Energy", scale.unit)


def _whole(axes: Axes, data: xr.Dataset) -> None:
    """Draw all ten seconds: the single run, and median and band of the ensemble's means."""
    for part, name in PARTS.items():
        colour = CHANNEL_COLOURS[part]
        low, median, high = data["mean"].sel(part=name).transpose("quantile", "window").values
        line = "-" if part == "structure" else ":"
        axes.plot(data.time, data.energy.sel(part=name), color=colour, lw=pen(0.4), alpha=0.6, label=f"{name}, one run")
        axes.fill_between(data.window, low, high, color=colour, alpha=0.35, lw=0, label=f"{name}, 10 to 90 %, means")
        axes.plot(data.window, median, color=INK, ls=line, zorder=3, label=f"{name}, median of means")
    highest = float(data.energy.max())
    axes.set_yscale("log")
    axes.set_ylim(highest * 1e-6, 2 * highest)
    axes.set_xlim(0, float(data.time[-1]))
    label(axes, "y", "Energy", "J")


def caption(data: xr.Dataset) -> str:
    """Return a caption on the decay of the energies and their distribution at the end."""
    said = [
        f"{model}: at 10 s the structure holds {left[0]:.2g} J and the ball {left[1]:.2g} J"
        for model, left in zip(data.model.values, data["mean"].sel(quantile=0.5).values[:, :, -1], strict=True)
    ]
    return (
        "Energies of structure and ball after a pulse of 5000 N on the centred ball: one run, and median and band of 64 "
        "runs that start within 1 µm; left, the beginning (medians dotted); right, the run instant by instant, the band of "
        f"means over one period, which the run therefore leaves. {_divergence(data)} Medians, {'; '.join(said)}."
    )


def _divergence(data: xr.Dataset) -> str:
    """Return a sentence on the time from which the band has a width."""
    low, _, high = data.begin_spread.transpose("quantile", ...)
    width = (high - low).max("part").coarsen(begin=125, boundary="trim").mean()
    said = []
    for model in data.model.values:
        times = width.begin.values[width.sel(model=model) > 0.01 * data.begin_energy.max()]
        said.append(
            f"with {model} from {times[0]:.2f} s on" if times.size else f"with {model} not in the first {_BEGIN:g} s"
        )
    return f"Starts part by more than 1 % of the energy: {'; '.join(said)}."


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the verdict on the smoother decay with the elasto-plastic model."""
    rises = data.rises.sel(quantile=0.5)
    bound = data.rises.sel(quantile=0.1, judged=CONSTANT_E)
    smoother = [model for model in (STEEL, RIGID) if rises.sel(judged=model) < bound]
    contacts = data.late_contacts.sel(quantile=0.5)
    given = {
        model: f"{float(rises.sel(judged=model)):.2g} in {float(contacts.sel(judged=model)):.0f} contacts"
        for model in data.judged.values
    }
    return (
        Claim(
            statement="After 2 s the structure's energy runs more smoothly with the elasto-plastic model than with "
            "constant restitution.",
            where="section 5.1, figures 7a and 7b",
            ours=f"energy that the ball gives back after 2 s, over the structure's at 2 s (medians): {by_model(given)}",
            interpretation=" or ".join(smoother) if smoother else "steel wall and rigid wall",
            verdict="reproduced" if smoother else "not reproducible",
        ),
    )


FIGURE = Reproduction(
    number="7a",
    title="Instantaneous energies, elasto-plastic impact model",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
