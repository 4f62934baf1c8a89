"""Classification of motions under a periodic load by their stroboscopic states, one state per cycle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import xarray

    from rattlebox.core import _core

Vector = NDArray[np.float64]
Whole = NDArray[np.int64]

_MAX_ATTRACTORS = 256


def reduced_strobes(maps: xarray.Dataset, packed: _core.Problem, period: Any) -> Vector:
    """Return stroboscopic states in dimensionless numbers of order one.

    Lengths are divided by the gap of the damper (of the first one for the structure), velocities by gap times angular
    frequency. In motions without impacts, in which balls drift freely, positions and velocities of balls are zero.

    Parameters
    ----------
    maps
        Strobes over a grid: `displacement`, `velocity` (..., sample), `relative_position`, `relative_velocity`
        (..., sample, ball), and `impacts`.
    packed
        The variants of the grid.
    period
        Length of a cycle [s], broadcastable to the grid.

    Returns
    -------
    (..., sample, 2 + 2 balls) float
        Dimensionless states.
    """
    shape = maps.status.shape
    gaps = [np.broadcast_to(0.5 * np.asarray(d.clearance), shape) for d in packed.dampers for _ in d.mass]
    omega = np.broadcast_to(2 * np.pi / np.asarray(period), shape)
    hit = (maps.impacts.values > 0)[..., None]
    parts = [maps.displacement.values / gaps[0][..., None], maps.velocity.values / (gaps[0] * omega)[..., None]]
    for ball, gap in enumerate(gaps):
        place, speed = maps.relative_position.values[..., ball], maps.relative_velocity.values[..., ball]
        parts += [np.where(hit, place / gap[..., None], 0.0), np.where(hit, speed / (gap * omega)[..., None], 0.0)]
    return np.stack(parts, axis=-1)


def period_of(strobes: Vector, tolerance: float) -> tuple[Whole, Vector]:
    """Determine the period of motions in cycles.

    Parameters
    ----------
    strobes : (..., sample, component) float
        Dimensionless states.
    tolerance
        Largest difference between states one period apart.

    Returns
    -------
    tuple of array
        Period, up to half the number of samples, and 0 if there is none; largest difference between states one period
        apart, or the smallest such difference of all numbers of cycles if there is no period. `rb.basins` states the rule.
    """
    count = strobes.shape[-2]
    difference = np.stack(
        [
            np.abs(strobes[..., n:, :] - strobes[..., : count - n, :]).max(axis=(-2, -1))
            for n in range(1, max(count // 2, 1) + 1)
        ]
    )
    close = difference <= tolerance
    period = np.where(close.any(axis=0), close.argmax(axis=0) + 1, 0)
    residual = np.where(
        period > 0,
        np.take_along_axis(difference, np.maximum(period - 1, 0)[None], axis=0)[0],
        difference.min(axis=0),
    )
    return period, residual


def attractors(strobes: Vector, period: Whole, residual: Vector, apart: float) -> tuple[Whole, Whole]:
    """Group periodic motions by attractor, independent of their phase.

    Parameters
    ----------
    strobes : (n, sample, component) float
        Dimensionless states.
    period, residual : (n,)
        Results of `period_of`.
    apart
        Largest difference between states of one attractor.

    Returns
    -------
    tuple of array
        Number of the attractor of each motion, (n,): 1 for the one with the most members, 0 for motions without a period
        and beyond 256 attractors; and for each attractor the member with the smallest residual.
    """
    label = np.zeros(len(strobes), dtype=np.int64)
    best: list[int] = []
    left = np.flatnonzero(period > 0)
    left = left[np.argsort(residual[left], kind="stable")]
    while left.size and len(best) < _MAX_ATTRACTORS:
        first = left[0]
        best.append(int(first))
        n = int(period[first])
        orbit = strobes[first, -n:]
        alike = left[period[left] == n]
        ends = strobes[alike, -n:]
        distance = np.min([np.abs(ends - np.roll(orbit, k, axis=0)).max(axis=(-2, -1)) for k in range(n)], axis=0)
        members = alike[distance <= apart]
        label[members] = len(best)
        left = left[label[left] == 0]
    order = np.argsort(-np.bincount(label, minlength=len(best) + 1)[1:], kind="stable")
    rank = np.zeros(len(best) + 1, dtype=np.int64)
    rank[order + 1] = np.arange(1, len(best) + 1)
    return rank[label], np.array(best, dtype=np.int64)[order]
