"""Location of grazing along a branch: a near miss becomes an impact, or the approach speed of an impact goes to zero.

References
----------
A. B. Nordmark (1991), Non-periodic motion caused by grazing incidence in an impact oscillator, Journal of Sound and
Vibration 145, 279-297, doi:10.1016/0022-460X(91)90592-8.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rattlebox.studies.orbits.shooting import solve

if TYPE_CHECKING:
    from rattlebox.studies.orbits.corrector import Corrector, Point

_APPROACHES = 40
_SHARE = 0.85
"""Part of the extrapolated distance to the grazing point that is gone in one step."""
_CLOSE = {"miss": 1e-7, "slow": 1e-3}
"""Gap or approach speed, over that at the beginning of the search, at which grazing is extrapolated."""
_FAR = 3.0
"""Largest extrapolated distance to a grazing point, in longest steps of the branch."""
_BEYOND = (1e-4, 1e-3, 5e-3)
"""Distances beyond a grazing point at which the motion on its other side is sought, over the range of the parameter."""
NAMES = {"miss": "grazing", "slow": "impact lost"}
"""Names of the special points."""


class Indicator(NamedTuple):
    """A quantity of a contact that is zero at grazing."""

    kind: str
    contact: int


def indicators(point: Point) -> dict[Indicator, float]:
    """Return the smallest gap of a near miss [m] and the smallest approach speed [m/s] of a point."""
    found = {}
    if (miss := point.orbit.nearest_miss) is not None:
        found[Indicator("miss", miss.contact)] = miss.gap
    if (slow := point.orbit.slowest_impact) is not None:
        found[Indicator("slow", slow.contact)] = slow.approach_speed
    return found


def approach(corrector: Corrector, before: Point, point: Point, length: float) -> tuple[list[Point], Indicator] | None:
    """Return the points up to the grazing that comes next, the last one being the grazing; None if there is none near."""
    chosen = _next(corrector, before, point, length)
    if chosen is None:
        return None
    reference = indicators(point)[chosen]
    row = [before, point]
    for _ in range(_APPROACHES):
        if indicators(row[-1])[chosen] < _CLOSE[chosen.kind] * reference:
            break
        distance = _distance(corrector, row[-2], row[-1], chosen)
        if not 0 < distance < _FAR * length:
            return None
        share = _SHARE
        while share > 1e-3:
            taken = corrector.step(row[-1], share * distance)
            if taken is not None and taken[0].contacts == point.contacts and chosen in indicators(taken[0]):
                row.append(taken[0])
                break
            share /= 2
        else:
            break
    if len(row) < 4 or indicators(row[-1])[chosen] > 0.05 * reference:
        return None
    sizes = np.array([indicators(each)[chosen] for each in row[-3:]])
    values = np.array([each.value for each in row[-3:]])
    # The parameter is a smooth function of the gap and of the approach speed, whose zero is the grazing.
    located = float(np.polynomial.polynomial.polyfit(sizes / sizes[0], values - values[-1], 2)[0] + values[-1])
    return [*row[2:-1], replace(row[-1], special=NAMES[chosen.kind], located=located)], chosen


def _next(corrector: Corrector, before: Point, point: Point, length: float) -> Indicator | None:
    """Return the quantity that reaches zero first along the branch; None if none does so near."""
    distances = {
        key: _distance(corrector, before, point, key) for key in indicators(point) if key in indicators(before)
    }
    near = {key: each for key, each in distances.items() if 0 < each < _FAR * length}
    return min(near, key=lambda key: near[key], default=None)


def _distance(corrector: Corrector, before: Point, point: Point, key: Indicator) -> float:
    """Return the distance along the branch to the zero of a quantity by extrapolation."""
    gone = corrector.distance(before, point)
    last, now = indicators(before).get(key, np.nan), indicators(point).get(key, np.nan)
    return float(now * gone / (last - now)) if last > now else np.inf


def beyond(corrector: Corrector, point: Point, indicator: Indicator) -> Point | None:
    """Return a point of the branch on the other side of a grazing; None if none is found."""
    expected = point.contacts.copy()
    expected[indicator.contact] += 1 if indicator.kind == "miss" else -1
    onward = 1.0 if point.tangent[-1] >= 0 else -1.0
    for direction in (onward, -onward):
        for share in _BEYOND:
            value = point.located + direction * share * corrector.width
            if not corrector.limits[0] < value < corrector.limits[1]:
                continue
            found = solve(point.returns, point.orbit.state[None], point.scale, [value])
            if found is None:
                continue
            there = corrector.finish(point.returns, found[0][0], value, found[1], point.scale, direction)
            if there is not None and +there.contacts == +expected:
                return there
    return None
