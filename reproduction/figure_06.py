"""Figure 6: phase portrait of the ball in a fixed cavity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from numpy.typing import NDArray

from rattlebox import Body, Case, Fixed, ImpactDamper, JacksonGreen, Output, Pair, Run, Sphere, restitution_curve
from rattlebox.plots import FAINT, INK, StyledFigure, pen

from .figure import Reproduction
from .files import simulate_many
from .models import COLOURS, RIGID, STEEL
from .system import GAP, PLASTIC, RADIUS, ensemble, near

_BALL = Sphere(radius=RADIUS, material="steel")
PAIR = Pair(Body(_BALL.material, RADIUS, _BALL.weight), Body(_BALL.material))  # the ball and a wall that cannot move
_LAW = JacksonGreen()
_STARTS = {"plastic": 10.0, "elastic": 0.8}  # speeds at the start over the elastic limit
_HITS = 2000
_TIMES = 0.2 * np.linspace(0, 1, 6001) ** 2  # of the portrait [s]: closer at the beginning, when the ball is fast
_MEMBERS = 8
_YIELD = [1e6, 1e7, 1e8, 1.03e9]


def _case(zone: str, portrait: bool, offset: float = 0.0) -> Case:
    """Return a case of a ball that starts at the centre."""
    speed = _STARTS[zone] * _LAW.critical_speed(PAIR)
    damper = ImpactDamper(balls=(_BALL,), gap=GAP, start=near(0.0, offset), velocity=(speed,), contact=PLASTIC)
    # At the elastic limit a flight and a hit last 5.3 ms.
    times, duration = (tuple(_TIMES.tolist()), _TIMES[-1]) if portrait else ((0.0,), 5.5e-3 * _HITS)
    return Case(structure=Fixed(), dampers=(damper,), duration=duration, output=Output(times=times))


def cases() -> Mapping[str, Case]:
    """Return the cases of the phase portrait and of the long runs, by the zone of their start."""
    kinds = (("portrait", True), ("many hits", False))
    return {f"{zone} zone, {what}": _case(zone, portrait) for zone in _STARTS for what, portrait in kinds}


def data() -> xr.Dataset:
    """Compute the phase portrait and the speed after each impact."""
    limit = _LAW.critical_speed(PAIR)
    plastic, elastic = simulate_many([_case(zone, portrait=False) for zone in _STARTS])
    portraits = [run.arrays for run in simulate_many([_case(zone, portrait=True) for zone in _STARTS])]
    others = [_speeds(ensemble(partial(_case, zone, False), _MEMBERS)) / limit for zone in _STARTS]
    after = _speeds([plastic])[0] / limit
    kept = elastic.impacts.separation_speed.values / limit
    hits = np.arange(1, after.size + 1)
    return xr.Dataset(
        {
            "place": (("zone", "time"), [arrays.relative_position[:, 0] / GAP for arrays in portraits]),
            "speed": (("zone", "time"), [arrays.relative_velocity[:, 0] / limit for arrays in portraits]),
            "simulated": ("hit", after),
            "above": ("hit", after - 1),
            "predicted_above": ("hit", _predicted(hits.size) - 1),
            "asymptote": ("hit", _asymptote(hits)),
            "spread": ("zone", [np.ptp(speeds, axis=0).max() for speeds in others]),
            "limit": ("side", [-1.0, 1.0]),
            "elastic_hits": ((), kept.size),
            "elastic_drift": ((), np.abs(kept / _STARTS["elastic"] - 1).max()),
            "critical_speed": ("yield_stress", [JacksonGreen(yield_stress=s).critical_speed(PAIR) for s in _YIELD]),
        },
        {"zone": list(_STARTS), "time": portraits[0].time, "side": [-1, 1], "hit": hits, "yield_stress": _YIELD},
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


def draw(figure: StyledFigure, data: xr.Dataset) -> None:
    """Draw the portrait and the approach to the elastic limit."""
    left, right = figure.subplots(1, 2, width_ratios=(1.25, 1))
    _portrait(left, data)
    late, last = data.asymptote.where(data.hit >= 200), data.sizes["hit"]
    shown = np.unique(np.geomspace(1, last, 28).astype(int))
    right.plot(shown, data.above.sel(hit=shown), "o", color=COLOURS[STEEL], mfc="white", ms=3.5, label="simulated")
    right.plot(data.hit, data.predicted_above, color=INK, zorder=1, label="from the law alone")
    right.plot(data.hit, late, color=FAINT, lw=pen(2), zorder=0, label="power law for many hits")
    right.set(xscale="log", yscale="log", xlim=(0.8, 1.3 * last), title="Approach to the elastic limit")
    right.set(xlabel="Number of hits", ylabel="V* - 1 after the hit")
    right.legend(loc="lower left")


def _portrait(axes: Axes, data: xr.Dataset) -> None:
    """Draw velocity against position, with zones and walls."""
    reach, top = 1.05 * float(np.abs(data.place).max()), 1.08 * float(np.abs(data.speed).max())
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
    axes.set(xlim=(-reach, reach), ylim=(-top, top), title="Phase portrait")
    axes.set(xlabel="Position in the cavity over $d_0$", ylabel="Velocity V* = $V/V_c$")


def values(data: xr.Dataset) -> dict[str, Any]:
    """Return V* after some hits, the losses of the zones, and the smallest limit; a rigid wall divides V_c by 4."""
    falls, smallest = -data.simulated.diff("hit").max(), data.critical_speed.min()
    return {
        "start": data.speed[0, 0],
        "after": [float(data.simulated.sel(hit=n)) for n in (1, 10, 100)],
        "hits": data.sizes["hit"],
        "power": np.polyfit(np.log(data.yield_stress), np.log(data.critical_speed), 1)[0],
        "zones": {STEEL: falls, RIGID: falls},
        "elastic": (data.elastic_drift, 1 - data.simulated[0] / data.speed[0, 0]),
        "exist": {STEEL: smallest, RIGID: smallest / 4},
    }


FIGURE = Reproduction("figure_06", data, draw, 0.52, cases, values)
