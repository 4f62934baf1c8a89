"""Hard impacts of balls in cavities on modes in free vibration, by a dense search that shares no code with the engine."""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DURATION = 0.2
GRID = 1601
"""Points of the grid: 260 in the shortest period of 30 Hz."""
TIE = 5e-14
"""Gap over the sum of its terms below which a contact touches at the same time as the first one."""
DOUBT = 1e-9
"""Smallest gap over the clearance of a near miss that counts: graze and miss cannot be distinguished below it."""


@dataclass(frozen=True)
class Touch:
    """First touch: time, all contacts that touch then, their approach speeds, and whether rounding decides."""

    time: float
    contacts: tuple[int, ...]
    speed: dict[int, float]
    is_doubtful: bool


def cavity(tie: Any, damper: int, t: Any) -> tuple[Any, Any, Any]:
    """Return displacement, velocity and acceleration of a cavity, of modes in free vibration."""
    total: list[Any] = [0.0, 0.0, 0.0]
    columns = zip(tie.frequency, tie.damping_ratio, tie.shape[damper], tie.displacement, tie.velocity, strict=True)
    for frequency, ratio, shape, q, p in columns:
        w = 2 * np.pi * frequency
        # The real part of a complex exponential; its derivatives are products with the root.
        root = w * (-ratio + 1j * np.sqrt(1 - ratio * ratio))
        amplitude = q + 1j * (q * root.real - p) / root.imag
        wave = amplitude * np.exp(root * t)
        for order in range(3):
            total[order] = total[order] + shape * (wave * root**order).real
    return total[0], total[1], total[2]


def contact_number(tie: Any, damper: int, place: int) -> int:
    """Return the number of a contact among those of all dampers."""
    return sum(len(row) + 1 for row in tie.mass[:damper]) + place


def _gaps(tie: Any, t: Any) -> tuple[list[Any], list[Any], list[float]]:
    """Return all gaps, their rates, and their scales, at times t."""
    values, rates, scales = [], [], []
    for d, gap in enumerate(tie.gap):
        z, p, _ = cavity(tie, d, t)
        places = [s + v * t for s, v in zip(tie.start[d], tie.speed[d], strict=True)]
        edges = [z - gap, *places, z + gap]
        speeds = [p, *tie.speed[d], p]
        for k in range(len(places) + 1):
            values.append(edges[k + 1] - edges[k])
            rates.append(speeds[k + 1] - speeds[k] + 0 * t)
            scales.append(2 * gap + abs(tie.start[d][min(k, len(places) - 1)]))
    return values, rates, scales


def _first_root(value: Any, grid: Array, gap: Array, scale: float) -> tuple[float, float]:
    """Return the first time at which a gap is below zero, and the smallest gap over its scale of minima before."""
    smallest = np.inf
    below = np.flatnonzero(gap < 0)
    last = int(below[0]) if below.size else len(grid)
    bracket = (grid[last - 1], grid[last]) if 0 < last < len(grid) else None
    dips = np.flatnonzero((gap[1:-1] <= gap[:-2]) & (gap[1:-1] <= gap[2:])) + 1
    for k in dips[dips <= last]:
        bend = gap[k + 1] - 2 * gap[k] + gap[k - 1]
        if gap[k] > bend + 1e-6 * scale:
            continue
        low, high = grid[k - 1], grid[k + 1]
        ratio = 0.5 * (np.sqrt(5) - 1)
        for _ in range(60):
            a, b = high - ratio * (high - low), low + ratio * (high - low)
            low, high = (low, b) if value(a) < value(b) else (a, high)
        bottom = 0.5 * (low + high)
        depth = value(bottom)
        smallest = min(smallest, abs(depth) / scale)
        if depth < 0 and (bracket is None or bottom < bracket[1]):
            bracket = (grid[k - 1], bottom)
            break
    if bracket is None:
        return np.inf, smallest
    low, high = bracket
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return high, smallest
        low, high = (middle, high) if value(middle) > 0 else (low, middle)


def first_touch(tie: Any) -> Touch:
    """Return the first touch of a case."""
    grid = np.linspace(0, DURATION, GRID)
    gaps, _, scales = _gaps(tie, grid)
    time, doubtful = np.inf, False
    for c, (gap, scale) in enumerate(zip(gaps, scales, strict=True)):
        gap[0] = max(gap[0], 1e-300)  # after an impact it is zero to rounding, and opens
        root, margin = _first_root(lambda t, c=c: _gaps(tie, t)[0][c], grid, gap, scale)
        doubtful = doubtful or margin < DOUBT
        time = min(time, root)
    if not np.isfinite(time):
        return Touch(time, (), {}, doubtful)
    values, rates, _ = _gaps(tie, time)
    closed = [
        c
        for c, (value, rate, scale) in enumerate(zip(values, rates, scales, strict=True))
        if value <= TIE * scale + 4e-16 * time * abs(rate) and rate <= 0
    ]
    return Touch(float(time), tuple(closed), {c: -float(rates[c]) for c in closed}, doubtful)


def resolve(matrix: Array, before: Array, e: Array) -> Array:
    """Return the impulses of simultaneous impacts, by trying each set of contacts that may have one.

    Parameters
    ----------
    matrix
        Change of the rate of each gap per impulse, (n, n) [1/kg].
    before, e
        Rates of the gaps before the impact, negative [m/s], and restitutions, (n,).
    """
    n, solutions = len(e), []
    need = -(1 + e) * before
    for count in range(n + 1):
        for active in itertools.combinations(range(n), count):
            impulse = np.zeros(n)
            rows = list(active)
            if rows:
                impulse[rows] = np.linalg.solve(matrix[np.ix_(rows, rows)], need[rows])
            if impulse.min() >= 0 and (matrix @ impulse - need).min() >= -1e-12 * abs(need).max():
                solutions.append(impulse)
    if not solutions or not all(np.allclose(each, solutions[0], rtol=1e-9, atol=1e-12) for each in solutions):
        raise ArithmeticError(f"{len(solutions)} solutions")
    return solutions[0]


def _after(tie: Any, touch: Touch) -> Any:
    """Return the case that begins after the impacts of a touch."""
    modes, balls = len(tie.frequency), sum(len(row) for row in tie.mass)
    rows, e = np.zeros((len(touch.contacts), modes + balls)), np.zeros(len(touch.contacts))
    number = first = 0
    for d, masses in enumerate(tie.mass):
        for place in range(len(masses) + 1):
            if number in touch.contacts:
                row, shape = rows[touch.contacts.index(number)], np.array(tie.shape[d])
                e[touch.contacts.index(number)] = tie.restitution[d]
                for ball, sign in ((place, 1.0), (place - 1, -1.0)):
                    if 0 <= ball < len(masses):
                        row[modes + first + ball] = sign
                    else:
                        row[:modes] += sign * shape
            number += 1
        first += len(masses)
    inverse = np.concatenate([np.ones(modes), 1 / np.concatenate([np.array(row) for row in tie.mass])])
    before = np.array([-touch.speed[c] for c in touch.contacts])
    change = inverse * (resolve(rows * inverse @ rows.T, before, e) @ rows)
    velocity, displacement, first = [], [], modes
    for j in range(modes):
        unit = replace(tie, shape=[[float(k == j) for k in range(modes)]])
        q, p, _ = cavity(unit, 0, touch.time)
        displacement.append(float(q))
        velocity.append(float(p + change[j]))
    start, speed = [], []
    for places, speeds in zip(tie.start, tie.speed, strict=True):
        start.append([s + v * touch.time for s, v in zip(places, speeds, strict=True)])
        speed.append([v + float(change[first + k]) for k, v in enumerate(speeds)])
        first += len(places)
    return replace(tie, velocity=velocity, displacement=displacement, start=start, speed=speed)


def replay(tie: Any, instants: int) -> Iterator[Touch]:
    """Yield the first instants with impacts, with times from the start, up to one that rounding decides or to chatter."""
    since = 0.0
    for _ in range(instants):
        touch = first_touch(tie)
        values, rates, scales = _gaps(tie, touch.time) if touch.contacts else ([], [], [])
        near = any(
            c not in touch.contacts and rate < 0 and value < 20 * TIE * scale and value > TIE / 30 * scale
            for c, (value, rate, scale) in enumerate(zip(values, rates, scales, strict=True))
        )
        unsure = any(values[c] > TIE / 30 * scales[c] for c in touch.contacts)
        slow = any(v < 1e-4 for v in touch.speed.values())
        if touch.is_doubtful or not touch.contacts or near or unsure or slow or since + touch.time > DURATION:
            return
        tie = _after(tie, touch)
        since += touch.time
        yield replace(touch, time=since)
