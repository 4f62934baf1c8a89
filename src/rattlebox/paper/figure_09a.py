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
from matplotlib.figure import Figure

from rattlebox.analysis import phase_portrait
from rattlebox.model.case import Case
from rattlebox.model.pairs import contact_pairs
from rattlebox.model.restitutions import JacksonGreen
from rattlebox.plots.style import FAINT, INK, PaperFigure, label, paper, pen, scaled

from .ensemble import band, ensemble, near
from .figure import Claim, Reproduction
from .models import described
from .runs import simulate_many
from .seed import CONSTANT, GAP, PLASTIC, START, seed_case

AMPLITUDE = 100.0
"""Of the pulse [N]."""
DURATION, RATE = 4.0, 1000.0
"""Of the portraits [s], and their samples a second [Hz]."""
MEMBERS = 24

_MODELS = {"constant": CONSTANT, "elasto-plastic": PLASTIC}
_PLACES = {1: "centred", 2: "at the trailing wall", 3: "at the leading wall"}


def _case(model: str, start: float) -> Case:
    return seed_case(_MODELS[model], start=start, amplitude=AMPLITUDE, duration=DURATION, rate=RATE)


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
        position [m] and velocity [m/s] (model, case, time); contacts, their band over starts within a micrometre, the
        greatest approach speed [m/s], and work and impact loss [J] (model, case); critical speeds [m/s] (wall).
    """
    shape = (len(_MODELS), len(START))
    runs = simulate_many(list(cases().values()))
    arrays = [run.arrays for run in runs]
    portrait = [phase_portrait(run, run.arrays.points[0] if of == "structure" else None) for run in runs]
    spread = np.array([_contacts(model, start) for model, start in product(_MODELS, START.values())])

    def each(values: object, units: str, text: str) -> tuple[Any, ...]:
        array = np.reshape(np.asarray(values), (*shape, -1))
        dims = ("model", "case", "time") if array.shape[-1] > 1 else ("model", "case")
        return described(dims, array.squeeze(), units, text)

    wall: tuple[Literal["rigid"] | None, ...] = (None, "rigid")
    pair = contact_pairs(_case("elasto-plastic", 0.0), 0)[0]
    return xr.Dataset(
        {
            "position": each([p.position for p in portrait], "m", portrait[0].position.long_name),
            "velocity": each([p.velocity for p in portrait], "m/s", portrait[0].velocity.long_name),
            "contacts": each([len(a.impacts) for a in arrays], "", "number of contacts"),
            "contacts_low": each(spread[:, 0], "", "number of contacts, 10 % of the ensemble"),
            "contacts_median": each(spread[:, 1], "", "number of contacts, median of the ensemble"),
            "contacts_high": each(spread[:, 2], "", "number of contacts, 90 % of the ensemble"),
            "approach_speed": each(
                [a.impacts.approach_speed.max(initial=0.0) for a in arrays], "m/s", "greatest approach speed"
            ),
            "work": each([run.ledger.work[-1] for run in runs], "J", "work of the pulse"),
            "impact_loss": each([run.ledger.impact_loss[-1] for run in runs], "J", "energy lost in impacts"),
            "critical_speed": described(
                "wall", [JacksonGreen(wall=w).critical_speed(pair) for w in wall], "m/s", "speed at which yield begins"
            ),
        },
        {
            "model": described("model", list(_MODELS), "", "model of restitution"),
            "case": described("case", list(START), "", "start position"),
            "wall": described("wall", ["steel", "rigid"], "", "wall in the critical speed"),
            "time": described("time", arrays[0].time, "s", "time"),
        },
    )


def _contacts(model: str, start: float) -> tuple[np.ndarray, ...]:
    """Band of the number of contacts."""
    runs = ensemble(lambda offset: _case(model, near(start, offset)), MEMBERS)
    return band([len(run.arrays.impacts) for run in runs])


def data() -> xr.Dataset:
    """Compute the portraits of the ball."""
    return portraits("ball")


def draw_portraits(data: xr.Dataset, texts: tuple[str, str], wall: float | None = None) -> Figure:
    """Draw six portraits, a row for each model and a column for each start.

    Parameters
    ----------
    data
        As `portraits` returns it.
    texts
        Labels of the axes.
    wall
        Half the clearance [m], where the walls are marked.
    """
    with paper("page"):
        figure = PaperFigure("page", 0.58)
        grid = figure.subplots(len(data.model), len(data.case), sharex=True, sharey=True)
        x, v = scaled(data.position, "m"), scaled(data.velocity, "m/s")
        reach = max(float(np.abs(data.position).max()), wall or 0.0) / x.divisor
        speed = float(np.abs(data.velocity).max()) / v.divisor
        for (i, model), (j, k) in product(enumerate(data.model.values), enumerate(data.case.values)):
            axes: Axes = grid[i, j]
            one = data.sel(model=model, case=k)
            points = np.column_stack((one.position / x.divisor, one.velocity / v.divisor))
            line = LineCollection(
                list(np.stack((points[:-1], points[1:]), axis=1)),
                array=data.time.values[:-1],
                cmap=LinearSegmentedColormap.from_list("dark", cm.batlow(np.linspace(0, 0.78, 256))),
                linewidths=pen(0.5),
                rasterized=True,
            )
            axes.add_collection(line)
            if wall is not None:
                for side in (-wall / x.divisor, wall / x.divisor):
                    axes.axvspan(side, 2 * side, facecolor=FAINT, alpha=0.45, linewidth=0, zorder=0)
                    axes.axvline(side, color=INK, linewidth=pen(0.7))
            axes.set_xlim(-1.1 * reach, 1.1 * reach)
            axes.set_ylim(-1.25 * speed, 1.25 * speed)
            count = int(one.contacts)
            axes.set_title(f"Case {k}, {_PLACES[int(k)]}" if i == 0 else "")
            axes.text(
                0.5,
                0.97,
                f"{model}, {count or 'no'} contact{'s' * (count != 1)}",
                transform=axes.transAxes,
                ha="center",
                va="top",
            )
            if i == len(data.model) - 1:
                label(axes, "x", texts[0], x.unit)
            if j == 0:
                label(axes, "y", texts[1], v.unit)
        bar = figure.colorbar(line, ax=grid, aspect=40, pad=0.02)
        bar.outline.set_visible(False)
        bar.set_label("Time (s)")
    return figure


def draw(data: xr.Dataset) -> Figure:
    """Draw the portraits of the ball between its walls."""
    return draw_portraits(data, ("Place in cavity", "Relative velocity"), GAP)


def _touching_pulse(data: xr.Dataset) -> float:
    """Amplitude of the pulse [N] from which the centred ball is touched: up to there everything is linear."""
    return AMPLITUDE * GAP / float(np.abs(data.position.sel(case=1)).max())


def _counted(data: xr.Dataset, k: int) -> str:
    """Contacts of one case by model, with their bands."""
    each = (data.sel(case=k, model=model) for model in data.model)
    return ", ".join(
        f"{int(one.contacts)} contacts with {one.model.item()} restitution "
        f"({one.contacts_low:.0f} to {one.contacts_high:.0f} from starts within 1 µm)"
        for one in each
    )


def caption(data: xr.Dataset) -> str:
    """Say what the portraits show."""
    lost = data.impact_loss.sel(model="elasto-plastic")
    speed = float(data.approach_speed.max())
    share = (data.impact_loss / data.work).sel(model="constant")
    critical = data.critical_speed
    return (
        f"The ball relative to its cavity in the first {data.time[-1]:g} s after a pulse of {AMPLITUDE:g} N. Centred, "
        f"it is never touched and the portrait is that of the structure alone; it would be touched from "
        f"{_touching_pulse(data):.0f} N on. From either wall the pulse or the first swing sets it flying: case 2 has "
        f"{_counted(data, 2)}; case 3 has {_counted(data, 3)}. No approach is faster than {1e3 * speed:.1f} mm/s, "
        f"below the critical speed of {1e3 * critical.sel(wall='steel'):.0f} mm/s (steel wall) and "
        f"{1e3 * critical.sel(wall='rigid'):.0f} mm/s (rigid wall), so that elasto-plastic impacts lose "
        f"{'nothing at all' if float(lost.max()) == 0 else f'{float(lost.max()):.2g} J'}, while constant restitution "
        f"takes {100 * share.sel(case=2):.1f} % (case 2) and {100 * share.sel(case=3):.1f} % (case 3) of the work."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Judge who touches a wall at this amplitude, and why the portraits shrink."""
    never = float(data.contacts_high.sel(case=1).max()) == 0 and int(data.contacts.sel(case=1).max()) == 0
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
            f"case 3 starts at a wall: {_counted(data, 3)}; what is said holds for case 1",
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
            ("reproduced in kind" if elastic else "reproduced") if slower else "not reproducible",
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
