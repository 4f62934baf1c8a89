"""Figure 9a: phase portraits of the ball in its cavity after a weak pulse."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any, Literal

import numpy as np
import xarray as xr
from cmcrameri import cm  # type: ignore[import-untyped]
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure, SubFigure
from numpy.typing import ArrayLike

from rattlebox import Case, JacksonGreen, Run, contact_pairs
from rattlebox.analysis import phase_portrait
from rattlebox.plots import (
    FAINT,
    INK,
    SERIES_COLOURS,
    SERIES_STYLES,
    StyledFigure,
    figure_style,
    label,
    pen,
    scaled,
)

from .ensemble import band, ensemble, near
from .figure import Claim, Reproduction
from .models import described
from .reference import CONSTANT, GAP, PLASTIC, START, paper_case
from .runs import simulate_many

AMPLITUDE = 100.0
"""Of the pulse [N]."""
DURATION, RATE = 4.0, 1000.0
"""Of the portraits [s], and their samples a second [Hz]."""
MEMBERS = 24
WINDOW = 0.1
"""Length of the windows in which the largest value counts [s]: about a period of the structure."""

_MODELS = {"constant": CONSTANT, "elasto-plastic": PLASTIC}
_PLACES = {1: "centred", 2: "at the trailing wall", 3: "at the leading wall"}


def _case(model: str, start: float) -> Case:
    return paper_case(_MODELS[model], start=start, amplitude=AMPLITUDE, duration=DURATION, rate=RATE)


def cases() -> Mapping[str, Case]:
    """Return the six runs: both models of restitution, from the three start positions."""
    return {f"{model}, case {k}": _case(model, START[k]) for model, k in product(_MODELS, START)}


def portraits(of: Literal["ball", "structure"]) -> xr.Dataset:
    """Compute the six phase portraits, and the contacts and impact losses behind them.

    Parameters
    ----------
    of
        "ball": relative to its cavity; "structure": the mass.

    Returns
    -------
    xarray.Dataset
        position [m] and velocity [m/s] (model, case, time); the largest relative velocity of the ball [m/s] or
        displacement of the structure [m] in each window (model, case, window); contacts, greatest approach speed [m/s],
        and work and impact loss [J] (model, case); the first two also for an ensemble (quantile, ...); critical speeds
        [m/s] (wall).
    """
    shape = (len(_MODELS), len(START))
    runs = simulate_many(list(cases().values()))
    many = [_ensemble(model, start) for model, start in product(_MODELS, START.values())]
    arrays = [run.arrays for run in runs]
    portrait = [_portrait(run, of) for run in runs]
    largest = [[_largest(run, of) for run in each] for each in many]
    counts = [[len(run.arrays.impacts) for run in each] for each in many]
    name, unit, text = _LARGEST[of]

    def each(values: ArrayLike, units: str, text: str, *dims: str) -> tuple[Any, ...]:
        array = np.asarray(values)
        return described(("model", "case", *dims), array.reshape(*shape, *array.shape[1:]), units, text)

    def spread(values: ArrayLike, units: str, text: str, *dims: str) -> tuple[Any, ...]:
        quantiles = np.array(band(values, axis=1))
        return described(
            ("quantile", "model", "case", *dims), quantiles.reshape(3, *shape, *quantiles.shape[2:]), units, text
        )

    wall: tuple[Literal["rigid"] | None, ...] = (None, "rigid")
    pair = contact_pairs(_case("elasto-plastic", 0.0), 0)[0]
    return xr.Dataset(
        {
            "position": each([p.position for p in portrait], "m", portrait[0].position.long_name, "time"),
            "velocity": each([p.velocity for p in portrait], "m/s", portrait[0].velocity.long_name, "time"),
            "largest": each([_largest(run, of) for run in runs], unit, f"{text}, one run", "window"),
            "largest_spread": spread(largest, unit, f"{text}, ensemble of start positions", "window"),
            "contacts": each([len(a.impacts) for a in arrays], "", "number of contacts"),
            "contacts_spread": spread(counts, "", "number of contacts, ensemble of start positions"),
            "wall_place": described("side", [-GAP, GAP], "m", "place of the walls"),
            "approach_speed": each(
                [a.impacts.approach_speed.max(initial=0.0) for a in arrays], "m/s", "greatest approach speed"
            ),
            "work": each([run.ledger.work[-1] for run in runs], "J", "work of the pulse"),
            "impact_loss": each([run.ledger.channels["normal"][-1] for run in runs], "J", "energy lost in impacts"),
            "critical_speed": described(
                "wall", [JacksonGreen(wall=w).critical_speed(pair) for w in wall], "m/s", "speed at which yield begins"
            ),
        },
        {
            "model": described("model", list(_MODELS), "", "model of restitution"),
            "case": described("case", list(START), "", "start position"),
            "wall": described("wall", ["steel", "rigid"], "", "wall in the critical speed"),
            "time": described("time", arrays[0].time, "s", "time"),
            "window": described("window", WINDOW * (np.arange(DURATION / WINDOW) + 0.5), "s", "middle of a window"),
            "side": described("side", [-1, 1], "", "side of the cavity"),
            "quantile": described("quantile", [0.1, 0.5, 0.9], "", "quantile of the ensemble"),
        },
        {"largest": name},
    )


_LARGEST = {
    "ball": ("Largest relative velocity", "m/s", "largest relative velocity in a window of 0.1 s"),
    "structure": ("Largest displacement", "m", "largest displacement in a window of 0.1 s"),
}


def _ensemble(model: str, start: float) -> list[Run]:
    return ensemble(lambda offset: _case(model, near(start, offset)), MEMBERS)


def _portrait(run: Run, of: Literal["ball", "structure"]) -> xr.Dataset:
    return phase_portrait(run, run.arrays.points[0] if of == "structure" else None)


def _largest(run: Run, of: Literal["ball", "structure"]) -> np.ndarray:
    values = _portrait(run, of)["velocity" if of == "ball" else "position"].values
    return np.asarray(np.abs(values[1:]).reshape(-1, round(WINDOW * RATE)).max(axis=1))


def data() -> xr.Dataset:
    """Compute the portraits of the ball."""
    return portraits("ball")


def draw_portraits(data: xr.Dataset, texts: tuple[str, str], walls: bool) -> Figure:
    """Draw six portraits, one row per model and one column per start, and below them the ensembles.

    Parameters
    ----------
    data
        Dataset from `portraits`.
    texts
        Labels of the axes.
    walls
        Whether to draw the walls of the cavity.
    """
    with figure_style("page"):
        figure = StyledFigure("page", 0.86)
        upper, lower = np.asarray(figure.subfigures(2, 1, height_ratios=(2, 1)))
        grid = upper.subplots(len(data.model), len(data.case), sharex=True, sharey=True)
        x, v = scaled(data.position, "m"), scaled(data.velocity, "m/s")
        line = None
        for (i, model), (j, k) in product(enumerate(data.model.values), enumerate(data.case.values)):
            axes: Axes = grid[i, j]
            one = data.sel(model=model, case=k)
            line = _draw_portrait(axes, one, x.divisor, v.divisor)
            if walls:
                _draw_walls(axes, data.wall_place.values / x.divisor)
            axes.set_title(f"Case {k}, {_PLACES[int(k)]}" if i == 0 else "")
            count = int(one.contacts)
            axes.text(
                0.5,
                0.97,
                f"{model}, {count or 'no'} contact{'s' * (count != 1)}",
                transform=axes.transAxes,
                ha="center",
                va="top",
            )
        reach = max(float(np.abs(data.position).max()), walls * float(data.wall_place.max())) / x.divisor
        speed = float(np.abs(data.velocity).max()) / v.divisor
        grid[0, 0].set_xlim(-1.1 * reach, 1.1 * reach)
        grid[0, 0].set_ylim(-1.25 * speed, 1.25 * speed)
        for axes in grid[-1]:
            label(axes, "x", texts[0], x.unit)
        for axes in grid[:, 0]:
            label(axes, "y", texts[1], v.unit)
        assert line is not None
        bar = upper.colorbar(line, ax=grid, aspect=40, pad=0.02)
        bar.outline.set_visible(False)
        bar.set_label("Time (s)")
        _draw_largest(lower, data)
    return figure


def _draw_portrait(axes: Axes, one: xr.Dataset, length: float, speed: float) -> LineCollection:
    """Draw a line coloured by time."""
    points = np.column_stack((one.position / length, one.velocity / speed))
    line = LineCollection(
        list(np.stack((points[:-1], points[1:]), axis=1)),
        array=one.time.values[:-1],
        cmap=LinearSegmentedColormap.from_list("dark", cm.batlow(np.linspace(0, 0.78, 256))),
        linewidths=pen(0.5),
        rasterized=True,
    )
    axes.add_collection(line)
    return line


def _draw_walls(axes: Axes, places: np.ndarray) -> None:
    for side in places:
        axes.axvspan(side, 2 * side, facecolor=FAINT, alpha=0.45, linewidth=0, zorder=0)
        axes.axvline(side, color=INK, linewidth=pen(0.7))


def _draw_largest(figure: SubFigure, data: xr.Dataset) -> None:
    """Draw median and band of the ensembles over time, and the single runs."""
    scale = scaled(data.largest, data.largest.units)
    panels = figure.subplots(1, len(data.case), sharey=True)
    for axes, k in zip(panels, data.case.values, strict=True):
        for model, colour, style in zip(data.model.values, SERIES_COLOURS, SERIES_STYLES, strict=False):
            one = data.sel(model=model, case=k)
            low, median, high = one.largest_spread.transpose("quantile", "window").values / scale.divisor
            axes.fill_between(data.window, low, high, color=colour, alpha=0.25, lw=0)
            axes.plot(data.window, median, color=colour, ls=style, label=f"{model}: median, 10 to 90 %")
            single = one.largest / scale.divisor
            axes.plot(data.window, single, color=colour, ls=style, lw=pen(0.4), label=f"{model}: one run")
        axes.set_xlim(0, float(data.time[-1]))
        label(axes, "x", "Time", "s")
    panels[0].set_ylim(bottom=0)
    first, last = data.attrs["largest"].rsplit(" ", 1)
    panels[0].set_ylabel(f"{first}\n{last} ({scale.unit})")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper left", ncols=4)


def draw(data: xr.Dataset) -> Figure:
    """Draw the portraits of the ball between its walls."""
    return draw_portraits(data, ("Place in cavity", "Relative velocity"), walls=True)


def _touching_pulse(data: xr.Dataset) -> float:
    """Return the amplitude of the pulse [N] above which the centred ball has contacts; below, the system is linear."""
    return AMPLITUDE * GAP / float(np.abs(data.position.sel(case=1)).max())


def _counted(data: xr.Dataset, k: int) -> str:
    """Return the contacts of one case by model, with their bands, as text."""
    each = (data.sel(case=k, model=model) for model in data.model)
    return ", ".join(
        f"{int(one.contacts)} with {one.model.item()} restitution "
        f"({one.contacts_spread.sel(quantile=0.1):.0f} to {one.contacts_spread.sel(quantile=0.9):.0f})"
        for one in each
    )


def outside(data: xr.Dataset) -> str:
    """Return a sentence on single runs outside the bands of their ensembles, or an empty text."""
    low, high = (data.contacts_spread.sel(quantile=q) for q in (0.1, 0.9))
    apart = ((data.contacts < low) | (data.contacts > high)).any("model")
    found = [str(k) for k in data.case.values[apart]]
    if not found:
        return ""
    return (
        f"The single runs of case {' and '.join(found)} lie outside: there the ball touches its wall exactly and has no "
        "approach speed when the pulse comes, while the balls of the band are up to 1 µm away and are hit. "
    )


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    lost = data.impact_loss.sel(model="elasto-plastic")
    speed = float(data.approach_speed.max())
    share = (data.impact_loss / data.work).sel(model="constant")
    critical = data.critical_speed
    return (
        f"The ball relative to its cavity in the first {data.time[-1]:g} s after a pulse of {AMPLITUDE:g} N: single runs "
        f"above, below them median and band of {MEMBERS} starts within 1 µm (largest speed in windows of {WINDOW:g} s). "
        f"Centred, it is never touched, its portrait is that of the structure alone and its band has no width; it would be "
        f"touched from {_touching_pulse(data):.0f} N on. From either wall the pulse or the first swing sets it flying. Its "
        f"contacts (in the band): {_counted(data, 2)} in case 2; {_counted(data, 3)} in case 3. {outside(data)}"
        f"No approach is faster than {1e3 * speed:.1f} mm/s, "
        f"below the critical speed of {1e3 * critical.sel(wall='steel'):.0f} mm/s (steel wall) and "
        f"{1e3 * critical.sel(wall='rigid'):.0f} mm/s (rigid wall), so that elasto-plastic impacts lose "
        f"{'nothing at all' if float(lost.max()) == 0 else f'{float(lost.max()):.2g} J'}, while constant restitution "
        f"takes {100 * share.sel(case=2):.1f} % (case 2) and {100 * share.sel(case=3):.1f} % (case 3) of the work."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the verdicts on contacts at this amplitude, and on the decay of the portraits."""
    never = float(data.contacts_spread.sel(case=1).max()) == 0 and int(data.contacts.sel(case=1).max()) == 0
    third = int(data.contacts.sel(case=3).min())
    peak = float(np.abs(data.position.sel(case=1)).max())
    share = 100 * (data.impact_loss / data.work).sel(case=[2, 3])
    elastic = float(share.sel(model="elasto-plastic").max()) == 0
    early = np.abs(data.velocity).where(data.time < 1).max("time").sel(case=[2, 3])
    late = np.abs(data.velocity).where(data.time > data.time[-1] - 1).max("time").sel(case=[2, 3])
    slower = bool((late < early).all())
    return (
        Claim(
            f"After a pulse of {AMPLITUDE:g} N the ball of case 1 never touches a wall.",
            "section 5.1, figure 9",
            f"relative amplitude {1e3 * peak:.4f} mm in a clearance of {1e3 * GAP:.1f} mm; no contact below "
            f"{_touching_pulse(data):.0f} N",
            "case 1 centred; both models",
            "reproduced" if never else "not reproducible",
        ),
        Claim(
            f"After a pulse of {AMPLITUDE:g} N the ball of case 3 dissipates nothing, because it never reaches a wall.",
            "section 5.1",
            f"contacts of case 3 (in an ensemble): {_counted(data, 3)}; the statement holds for case 1",
            "case 3 touching either wall",
            "misprint" if never and third else "reproduced" if not third else "not reproducible",
        ),
        Claim(
            "In cases 2 and 3 the relative velocity falls because impacts lose energy.",
            "section 5.1, figure 9a",
            f"impacts take {float(share.sel(model='constant').min()):.1f} to "
            f"{float(share.sel(model='constant').max()):.1f} % of the work with constant restitution and "
            f"{float(share.sel(model='elasto-plastic').max()):.2g} % with the elasto-plastic model"
            + ("; it leaves all of the loss to the viscous damper" if elastic else ""),
            "both models, steel or rigid wall",
            ("reproduced qualitatively" if elastic else "reproduced") if slower else "not reproducible",
        ),
    )


FIGURE = Reproduction(
    number="9a",
    title="Phase portraits of the ball after a weak pulse",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
