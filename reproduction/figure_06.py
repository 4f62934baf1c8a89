"""Figure 6: phase portrait of the ball in a fixed cavity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from math import inf

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rattlebox import Body, Case, Fixed, ImpactDamper, JacksonGreen, Output, Pair, Run, Sphere, restitution_curve
from rattlebox.plots import FAINT, INK, StyledFigure, figure_style, pen

from .ensemble import ensemble, near
from .figure import Reproduction, letters
from .judge import CORRECTED, PRINTED, Claim, by_wall, exact
from .models import COLOURS, RIGID, STEEL, described
from .reference import GAP, PLASTIC, RADIUS
from .runs import simulate_many

_BALL = Sphere(radius=RADIUS, material="steel")
PAIR = Pair(Body(_BALL.material, RADIUS, _BALL.weight), Body(_BALL.material))  # The ball and a wall that cannot move
_LAW = JacksonGreen()
_STARTS = {"plastic": 10.0, "elastic": 0.8}  # Speeds at the start over the elastic limit
_HITS = 2000
_TIMES = 0.2 * np.linspace(0, 1, 6001) ** 2  # Of the portrait [s]: closer at the beginning, when the ball is fast
_MEMBERS = 8
_YIELD = (1e6, 1e7, 1e8, 1.03e9)


def _case(zone: str, portrait: bool, offset: float = 0.0) -> Case:
    """Return a case of a ball that starts at the centre."""
    speed = _STARTS[zone] * _LAW.critical_speed(PAIR)
    damper = ImpactDamper(balls=(_BALL,), gap=GAP, start=near(0.0, offset), velocity=(speed,), contact=PLASTIC)
    # At the elastic limit a flight and a hit last 5.3 ms.
    times, duration = (tuple(_TIMES.tolist()), _TIMES[-1]) if portrait else ((0.0,), 5.5e-3 * _HITS)
    return Case(structure=Fixed(), dampers=(damper,), duration=duration, output=Output(times=times))


def cases() -> Mapping[str, Case]:
    """Return the cases of the phase portrait and of the long runs, by the zone of their start."""
    return {
        f"{zone} zone, {what}": _case(zone, portrait)
        for zone in _STARTS
        for what, portrait in (("portrait", True), ("many hits", False))
    }


def data() -> xr.Dataset:
    """Compute the phase portrait and the speed after each impact."""
    limit = _LAW.critical_speed(PAIR)
    plastic, elastic = simulate_many([_case(zone, portrait=False) for zone in _STARTS])
    portraits = [run.arrays for run in simulate_many([_case(zone, portrait=True) for zone in _STARTS])]
    others = [ensemble(partial(_case, zone, False), _MEMBERS) for zone in _STARTS]
    spread = [_speeds(runs) / limit for runs in others]
    place = [arrays.relative_position[:, 0] / GAP for arrays in portraits]
    speed = [arrays.relative_velocity[:, 0] / limit for arrays in portraits]
    after = _speeds([plastic])[0] / limit
    kept = elastic.impacts.separation_speed.values / limit
    hits = np.arange(1, after.size + 1)

    return xr.Dataset(
        {
            "place": described(("zone", "time"), place, "", "place of the ball in the cavity over d0"),
            "speed": described(("zone", "time"), speed, "", "velocity of the ball over V_c"),
            "simulated": described("hit", after, "", "V* after the hit"),
            "above": described("hit", after - 1, "", "V* - 1 after the hit"),
            "predicted_above": described(
                "hit", _predicted(hits.size) - 1, "", "V* - 1 after the hit, from the law alone"
            ),
            "asymptote": described("hit", _asymptote(hits), "", "V* - 1 after the hit, for many hits"),
            "spread": described(
                "zone",
                [np.ptp(speeds, axis=0).max() for speeds in spread],
                "",
                "largest difference of V* after the same hit, ensemble of start positions",
            ),
            "limit": described(
                "side", [-1.0, 1.0], "", "limits of the cavity over d0 and of the elastic zone over V_c"
            ),
            "elastic_hits": described((), kept.size, "", "hits of the ball that starts in the elastic zone"),
            "elastic_drift": described(
                (), np.abs(kept / _STARTS["elastic"] - 1).max(), "", "largest change of its speed"
            ),
            "critical_speed": described(
                "yield_stress",
                np.array([JacksonGreen(yield_stress=strength).critical_speed(PAIR) for strength in _YIELD]),
                "m/s",
                "elastic limit V_c",
            ),
        },
        {
            "zone": described("zone", list(_STARTS), "", "zone of the start"),
            "time": described("time", portraits[0].time, "s", "time"),
            "side": described("side", [-1, 1], "", "side"),
            "hit": described("hit", hits, "", "number of the hit"),
            "yield_stress": described("yield_stress", _YIELD, "Pa", "yield stress"),
        },
    )


def _speeds(runs: Sequence[Run]) -> NDArray[np.float64]:
    """Return the speed after each of the first impacts [m/s], (run, hit)."""
    hits = min(_HITS, *(len(run.arrays.impacts) for run in runs))
    return np.array([run.arrays.impacts.separation_speed[:hits] for run in runs])


def _predicted(hits: int) -> NDArray[np.float64]:
    """Return V* after each impact by repeated application of the law."""
    limit = _LAW.critical_speed(PAIR)
    speeds = [_STARTS["plastic"]]
    for _ in range(hits):
        speeds.append(speeds[-1] * float(restitution_curve(_LAW, PAIR, speeds[-1] * limit)))
    return np.array(speeds[1:])


def _asymptote(hits: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return V* - 1 after many impacts; near 1, each impact subtracts 0.1 (V* - 1)^1.156 / 59^0.156."""
    taken: NDArray[np.float64] = 0.156 * 0.1 / 59.0**0.156 * hits
    return taken ** (-1 / 0.156)


def draw(data: xr.Dataset) -> Figure:
    """Draw the portrait and the approach to the elastic limit."""
    with figure_style("page"):
        figure = StyledFigure("page", 0.52)
        left, right = figure.subplots(1, 2, width_ratios=(1.25, 1))
        _portrait(left, data)
        late = data.asymptote.where(data.hit >= 200)
        shown = np.unique(np.geomspace(1, data.sizes["hit"], 28).astype(int))
        right.plot(shown, data.above.sel(hit=shown), "o", color=COLOURS[STEEL], mfc="white", ms=3.5, label="simulated")
        right.plot(data.hit, data.predicted_above, color=INK, zorder=1, label="from the law alone")
        right.plot(data.hit, late, color=FAINT, lw=pen(2), zorder=0, label="power law for many hits")
        right.set(xscale="log", yscale="log", xlim=(0.8, 1.3 * data.sizes["hit"]))
        right.set(xlabel="Number of hits", ylabel="V* - 1 after the hit")
        right.set_title("Approach to the elastic limit")
        right.legend(loc="lower left")
        letters(figure)
    return figure


def _portrait(axes: Axes, data: xr.Dataset) -> None:
    """Draw velocity against position, with zones and walls."""
    reach = 1.05 * float(np.abs(data.place).max())
    top = 1.08 * float(np.abs(data.speed).max())
    for side in data.limit.values:
        axes.axvspan(side, side * reach, facecolor=FAINT, alpha=0.45, lw=0, zorder=0)
        axes.axvline(side, color=INK, lw=pen(0.7), zorder=0)
        axes.axhline(side, color=INK, lw=pen(0.7), linestyle=(0, (1, 1.2)))
    axes.axhspan(*data.limit.values, facecolor=COLOURS[STEEL], alpha=0.12, lw=0, zorder=0)
    for zone, width in zip(data.zone.values, (0.5, 1.6), strict=True):
        one = data.sel(zone=zone)
        axes.plot(one.place, one.speed, color=COLOURS[STEEL], lw=pen(width), label=f"starts in the {zone} zone")
    axes.text(0, 0, "elastic zone", ha="center", va="center")
    axes.text(-0.5, 0.88 * top, "plastic zone", ha="center", va="center")
    axes.set(xlim=(-reach, reach), ylim=(-top, top))
    axes.set(xlabel="Position in the cavity over $d_0$", ylabel="Velocity V* = $V/V_c$")
    axes.set_title("Phase portrait")


def caption(data: xr.Dataset) -> str:
    """Return the caption."""
    reduced = {n: float(data.simulated.sel(hit=n)) for n in (1, 10, 100)}
    return (
        f"In the plastic zone every hit takes speed away: from V* = {float(data.speed[0, 0]):g} to {reduced[1]:.3f} "
        "after 1 hit, "
        f"{reduced[10]:.3f} after 10 and {reduced[100]:.4f} after 100; in the elastic zone none does. (b) The "
        "approach to V* = 1 never "
        "ends. The motion is regular: starts within 1 µm have the same speeds."
    )


def claims(data: xr.Dataset) -> Sequence[Claim]:
    """Return the claims on the two zones."""
    drift = float(data.elastic_drift)
    falls = -float(data.simulated.diff("hit").max())
    limits = data.critical_speed
    order = float(np.polyfit(np.log(data.yield_stress), np.log(limits), 1)[0])
    return (
        Claim(
            "In a fixed cavity the ball loses energy with every hit in the plastic zone and none in the elastic zone.",
            "section 5, figure 6",
            f"least reduction of V* in {data.sizes['hit']} hits",
            by_wall({STEEL: exact(falls), RIGID: exact(falls)}),
            accept=(1e-15, inf),
            kind="construction",
            note=f"in the elastic zone the speed changes by {drift:.1g} in {int(data.elastic_hits)} hits; in units of "
            "V_c both walls agree",
        ),
        Claim(
            "There is dissipation in the elastic phase.",
            "conclusion 1",
            "relative loss of speed in the elastic zone, and with “plastic” instead",
            {PRINTED: exact(drift), CORRECTED: exact(1 - data.simulated[0] / data.speed[0, 0])},
            accept=(1e-3, inf),
            kind="misprint",
            note="section 5 says the opposite",
        ),
        Claim(
            "Both zones exist for any positive yield stress.",
            "section 5",
            "smallest V_c for yield stresses from 1 to 1030 MPa (m/s)",
            by_wall({STEEL: exact(limits.min()), RIGID: exact(limits.min() / 4)}),
            accept=(1e-12, inf),
            kind="construction",
            note=f"V_c grows as the yield stress to the power {order:.1f}",
        ),
    )


FIGURE = Reproduction(
    number="6",
    title="Phase portrait in a fixed cavity",
    data=data,
    draw=draw,
    caption=caption,
    cases=cases,
    claims=claims,
)
