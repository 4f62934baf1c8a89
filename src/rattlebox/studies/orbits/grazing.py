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

from rattlebox.model.errors import several
from rattlebox.studies.orbits.shooting import solve
from rattlebox.studies.orbits.unfolding import aimed, touch_at, touches, unfolding_at

if TYPE_CHECKING:
    from rattlebox.studies.orbits.corrector import Corrector, Point

_APPROACHES = 40
_SHARE = 0.85
"""Part of the extrapolated distance to the grazing point that is gone in one step."""
_CLOSE = {"miss": 1e-8, "slow": 1e-5}
"""Gap or approach speed, over the sizes of gaps and of speeds in the motion, at which grazing is extrapolated."""
_ENOUGH = {"miss": 1e-5, "slow": 1e-3}
"""The same, at which it is extrapolated if no closer motion can be computed."""
_REMAINS = 0.01
"""Largest extrapolated distance from there, in longest steps of the branch."""
_FAR = 3.0
"""Largest extrapolated distance to a grazing point, in longest steps of the branch."""
_BEYOND = (0.03, 0.3, 3e-3, 1.0)
"""Distances from a grazing at which the motion that begins there is sought, in longest steps of the branch."""
NAMES = {"miss": "grazing", "slow": "impact lost"}
"""Names of the special points."""
NOT_FOUND = "no motion with one contact more or less was found beyond it"


_SEARCHED = (1e-4, 1e-3, 5e-3)
"""Distances from a grazing over the range of the parameter, at which a motion is sought that the map does not predict."""
_NEAR = 0.05
"""Largest change of its state, over the size of the motion."""
_REFINED, _SMALLER = 4, 0.01
"""Number of motions without the impact that approach a grazing, and ratio of their gaps."""
_AGREES = 1e-3
"""Largest difference of the values of a grazing from both sides, over the range of the parameter."""
_APART = 1.1
"""Smallest ratio of the quantities of two points from which a grazing is extrapolated."""


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
    size, row = _size(point, chosen), [before, point]
    for _ in range(_APPROACHES):
        if indicators(row[-1])[chosen] < _CLOSE[chosen.kind] * size:
            break
        distance = _distance(corrector, row[-2], row[-1], chosen)
        if not 0 < distance < _FAR * length:
            break
        share = _SHARE
        while share > 1e-3:
            taken = corrector.step(row[-1], share * distance)
            smallest = indicators(row[-1])[chosen]
            # A larger gap is that of another near miss of the contact.
            if (
                taken is not None
                and corrector.is_near(row[-1], taken[0])
                and taken[0].contacts == point.contacts
                and indicators(taken[0]).get(chosen, np.inf) < smallest
            ):
                row.append(taken[0])
                break
            share /= 2
        else:
            break
    last_one, remaining = indicators(row[-1])[chosen], _distance(corrector, row[-2], row[-1], chosen)
    # A soft contact may be slow along a branch, also at a fold, that no grazing follows.
    is_close = last_one < _CLOSE[chosen.kind] * size or 0 < remaining < _REMAINS * length
    if last_one > _ENOUGH[chosen.kind] * size or not is_close:
        return None
    # Points whose quantities differ by less than their rounding errors cannot be extrapolated.
    last = [row[-1]]
    for each in row[-2::-1]:
        if len(last) < 3 and indicators(each)[chosen] > _APART * indicators(last[0])[chosen]:
            last.insert(0, each)
    sizes = np.array([indicators(each)[chosen] for each in last])
    values = np.array([each.value for each in last])
    # The parameter is a smooth function of the gap and of the approach speed, whose zero is the grazing.
    smooth = np.polynomial.polynomial.polyfit(sizes / sizes[0], values - values[-1], len(last) - 1)
    grazing = replace(row[-1], special=NAMES[chosen.kind], located=float(smooth[0] + values[-1]))
    return [*row[2:-1], grazing], chosen


def _size(point: Point, key: Indicator) -> float:
    """Return the size of the gaps [m] or of their rates [m/s] of a contact in a motion."""
    lines = point.returns.lines
    row = lines.by_state if key.kind == "miss" else lines.rate_by_state
    return float(np.abs(row[key.contact]) @ point.scale)


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


class Passage(NamedTuple):
    """The motion that begins at a grazing, and whether the branch turns back there (a nonsmooth fold)."""

    point: Point
    folds: bool
    located: float = np.nan  # value of the parameter at the grazing, from the side without the impact

    def __str__(self) -> str:
        return passage_words(self.point, self.folds)


def passage_words(point: Point, folds: bool) -> str:
    """Return the words for how a branch continues past a grazing with the motion of a point."""
    count = several(len(point.orbit.impacts), "impact") + " and sticking" * point.orbit.sticks
    return f"nonsmooth fold, turns back with {count}" if folds else f"continues with {count}"


def beyond(corrector: Corrector, before: Point, point: Point, indicator: Indicator) -> Passage | None:
    """Return the motion with one contact more or less that begins at a grazing, on either side; None if none is found.

    `before` is the point before the grazing, which shows the side from which the branch comes.
    """
    # The side on which it exists, and a guess of it, follow from the map without the contact and the jump of the state
    # at the impact, which is proportional to the approach speed.
    is_lost = indicator.kind == "slow"
    touch = touch_at(point.returns, point.orbit.state, [point.value], impact=is_lost)
    near = None if touch is None else unfolding_at(point.returns, point.orbit.state, [point.value], touch)
    if touch is None or near is None:
        return _search(corrector, point)
    here = near.with_impact(touch.speed) if is_lost else near.without(touch.gap)
    state, value = point.orbit.state - here[0], point.value - here[1]
    ahead = near.without if is_lost else near.with_impact
    n, change = state.size, -1 if is_lost else 1
    expected = len(point.orbit.impacts) + change * (2 if point.returns.mirrored else 1)
    unit = 1e-9 * float(point.scale.max())  # where the motion changes in proportion to it
    for share in _BEYOND:
        dx, dp = ahead(unit)
        normal = np.append(dx / point.scale, dp / corrector.width)
        size = float(np.sqrt(np.sum(corrector.weights(n) * normal**2)))
        dx, dp = ahead(unit * share * corrector.longest / size)
        normal = np.append(dx / point.scale, dp / corrector.width)
        normal /= float(np.sqrt(np.sum(corrector.weights(n) * normal**2)))
        guess, at = state + dx, value + dp
        if not corrector.limits[0] < at < corrector.limits[1]:
            continue
        if not is_lost:
            speed = unit * share * corrector.longest / size
            guess = aimed(point.returns, near, touch, guess, [at], point.scale, speed)
        found = corrector.correct(point.returns, guess, at, point.scale, normal)
        if found is None or not corrector.limits[0] < found[1] < corrector.limits[1]:
            continue
        there = corrector.finish(point.returns, *found[:3], point.scale, normal)
        if there is not None and len(there.orbit.impacts) == expected:
            located = _limit(corrector, there, touch.contact) if is_lost else np.nan
            if abs(located - point.located) > _AGREES * corrector.width:  # of another near miss
                located = np.nan
            return Passage(there, (there.value > point.located) == (before.value > point.located), located)
    return _search(corrector, point)


def with_passage(point: Point, passage: Passage | None) -> Point:
    """Return a point at a grazing with the words for the passage and the more accurate value of the parameter."""
    if passage is None:
        return replace(point, passage=NOT_FOUND)
    located = passage.located if np.isfinite(passage.located) else point.located
    return replace(point, passage=str(passage), located=located)


def _limit(corrector: Corrector, point: Point, contact: int) -> float:
    """Return the value of the parameter at which the smallest gap of a contact vanishes; NaN if it is not found."""
    # Rounding errors of the motion with the impact grow as one over its approach speed, those without it do not.
    returns, scale, state, value = point.returns, point.scale, point.orbit.state, point.value
    located = np.nan
    for _ in range(_REFINED):
        misses = touches(returns, state, [value], impact=False)
        touch = next((miss for miss in misses if miss.contact == contact), None)
        near = None if touch is None else unfolding_at(returns, state, [value], touch)
        if touch is None or near is None:
            return located
        here, ahead = near.without(touch.gap), near.without(_SMALLER * touch.gap)
        located = value - here[1]
        found = corrector.correct(returns, state + ahead[0] - here[0], located + ahead[1], scale)
        if found is None:
            return located
        state, value = found[:2]
    return located


def begins(point: Point) -> bool:
    """Return whether the slowest impact of a motion is so slow that it has just begun."""
    slow = point.orbit.slowest_impact
    return slow is not None and slow.approach_speed < _ENOUGH["slow"] * _size(point, Indicator("slow", slow.contact))


def is_pressed(point: Point) -> bool:
    """Return whether bodies are pressed together at the slowest impact of a motion, as in chatter."""
    touch = touch_at(point.returns, point.orbit.state, [point.value], impact=True)
    return touch is not None and unfolding_at(point.returns, point.orbit.state, [point.value], touch) is None


def _search(corrector: Corrector, point: Point) -> Passage | None:
    """Return a motion with another sequence of impacts near a grazing, past it or before it; None if none is found."""
    # Where bodies are pressed together at the slow impact, as in chatter, many contacts change at once.
    onward = 1.0 if point.tangent[-1] >= 0 else -1.0
    for direction in (onward, -onward):
        for share in _SEARCHED:
            value = point.located + direction * share * corrector.width
            if not corrector.limits[0] < value < corrector.limits[1]:
                continue
            found = solve(point.returns, point.orbit.state[None], point.scale, [value])
            if found is None or np.abs((found[0][0] - point.orbit.state) / point.scale).max() > _NEAR:
                continue
            there = corrector.finish(point.returns, found[0][0], value, found[1], point.scale, direction)
            if there is not None and there.contacts != point.contacts:
                return Passage(there, direction != onward)
    return None
