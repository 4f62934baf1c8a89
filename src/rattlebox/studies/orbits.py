"""Motions under a periodic load, told apart by their strobes: the state once a cycle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import xarray

    from rattlebox.core import _core

Vector = NDArray[np.float64]
Whole = NDArray[np.int64]

_MOST = 256


def reduced_strobes(maps: xarray.Dataset, packed: _core.Problem, period: Any) -> Vector:
    """Put strobes in numbers of order one.

    Lengths are divided by the gap of the damper (of the first one for the structure), speeds by gap times angular
    frequency. Where nothing was hit, balls count as still: they drift freely, wherever they are.

    Parameters
    ----------
    maps
        Strobes over a grid: `displacement`, `velocity` (..., sample), `ball_place`, `ball_speed` (..., sample, ball), and
        `impacts`.
    packed
        The variants of the grid.
    period
        Length of a cycle [s], broadcastable to the grid.

    Returns
    -------
    array
        (..., sample, 2 + 2 balls)
    """
    shape = maps.status.shape
    gaps = [np.broadcast_to(0.5 * np.asarray(d.clearance), shape) for d in packed.dampers for _ in d.mass]
    omega = np.broadcast_to(2 * np.pi / np.asarray(period), shape)
    hit = (maps.impacts.values > 0)[..., None]
    parts = [maps.displacement.values / gaps[0][..., None], maps.velocity.values / (gaps[0] * omega)[..., None]]
    for ball, gap in enumerate(gaps):
        place, speed = maps.ball_place.values[..., ball], maps.ball_speed.values[..., ball]
        parts += [np.where(hit, place / gap[..., None], 0.0), np.where(hit, speed / (gap * omega)[..., None], 0.0)]
    return np.stack(parts, axis=-1)


def period_of(strobes: Vector, tolerance: float) -> tuple[Whole, Vector]:
    """Find after how many cycles motions repeat.

    Parameters
    ----------
    strobes
        (..., sample, component)
    tolerance
        Largest difference between strobes of a motion that repeats.

    Returns
    -------
    tuple of array
        Number of cycles, up to half the samples, 0 where there is none such; and the largest difference after so
        many cycles, or the least one of all.
    """
    count = strobes.shape[-2]
    apart = np.stack(
        [
            np.abs(strobes[..., n:, :] - strobes[..., : count - n, :]).max(axis=(-2, -1))
            for n in range(1, max(count // 2, 1) + 1)
        ]
    )
    close = apart <= tolerance
    found = np.where(close.any(axis=0), close.argmax(axis=0) + 1, 0)
    residual = np.where(
        found > 0, np.take_along_axis(apart, np.maximum(found - 1, 0)[None], axis=0)[0], apart.min(axis=0)
    )
    return found, residual


def attractors(strobes: Vector, period: Whole, residual: Vector, apart: float) -> tuple[Whole, Whole]:
    """Tell motions apart that repeat, wherever in their period they are.

    Parameters
    ----------
    strobes
        (n, sample, component)
    period, residual
        From `period_of`, (n,).
    apart
        Largest difference between strobes of one motion.

    Returns
    -------
    tuple of array
        Number of its attractor for each motion, (n,), counted from 1 for that with the most members, 0 for motions
        that do not repeat and for all beyond 256 attractors; and for each attractor the member that has
        settled best.
    """
    label = np.zeros(len(strobes), dtype=np.int64)
    best: list[int] = []
    left = np.flatnonzero(period > 0)
    left = left[np.argsort(residual[left], kind="stable")]
    while left.size and len(best) < _MOST:
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
