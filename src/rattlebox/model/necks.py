"""The room for spheres in cavities with bodies or surfaces of triangles: the widest place, and separate parts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from rattlebox._util.phrases import counted, joined
from rattlebox._util.quantities import amount

from .cavities import Cavity
from .space import to_global

_CELLS = 64  # of the grid along the longest edge
_FINER = (1, 2, 4)  # parts of a cell where surfaces are near, for particles smaller than a cell
_MOST = 4_000_000  # points in these parts, above which the coarser grid is used
_AT_ONCE = 500_000  # points whose distances are computed together
_SEEDS = 2**14
_UNREACHED = 0.1  # share of the volume that no particle reaches, from which a run has a warning
_SMALLEST = 0.01  # share of a part that is mentioned


@lru_cache(maxsize=16)
def widest_sphere(cavity: Cavity) -> float:
    """Return the radius of the largest sphere that fits into a cavity, to rounding if a local search finds it [m]."""
    points = cavity.spread(_SEEDS)
    if not len(points):
        return 0.0
    depth = cavity.depth(points)
    best = points[np.argsort(depth)[-20:]]
    generator = np.random.default_rng(1)
    step = float(cavity.lengths.max()) / 20
    deepest = cavity.depth(best)
    while step > 1e-10 * float(depth.max()):
        tries = best[:, None] + step * generator.standard_normal((len(best), 20, 3))
        depths = cavity.depth(tries.reshape(-1, 3)).reshape(len(best), 20)
        k = depths.argmax(axis=1)
        better = depths.max(axis=1) > deepest
        best[better] = tries[np.arange(len(best)), k][better]
        deepest = np.maximum(deepest, depths.max(axis=1))
        step *= 0.7
    return float(deepest.max())


@dataclass(frozen=True)
class _Room:
    """The room for centres of spheres in a cavity."""

    unreached: float  # Share of the volume that no sphere reaches
    parts: tuple[float, ...]  # Shares of separate parts, the largest first
    step: float  # Of the grid on which they are separate [m]


@lru_cache(maxsize=16)
def _room(cavity: Cavity, radius: float) -> _Room:
    """Return the room for the centres of spheres.

    Centres are on a grid, and neighbours on it are in one part, also across corners. With steps up to the radius two of them
    are never on two sides of a wall; a neck for which less than a step is to spare may lie between points of the grid.
    """
    from scipy import ndimage

    step = float(cavity.lengths.max()) / _CELLS
    axes = [np.arange(-length / 2 - step, length / 2 + 1.5 * step, step) for length in cavity.lengths]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    depth = cavity.depth(to_global(grid.reshape(-1, 3), cavity.frame)).reshape(grid.shape[:3])
    coarse = depth >= radius
    # A distance changes by at most the way, so that finer points are needed near the surfaces only.
    near = np.argwhere(np.abs(depth - radius) <= 0.5 * np.sqrt(3.0) * step)
    fine = next((k for k in _FINER if step <= k * radius), 1)
    while fine > 1 and len(near) * fine**3 > _MOST:
        fine //= 2
    centres = coarse
    if fine > 1:
        centres = coarse.repeat(fine, 0).repeat(fine, 1).repeat(fine, 2)
        inside = np.stack(np.meshgrid(*3 * [np.arange(fine)], indexing="ij"), axis=-1).reshape(-1, 3)
        for rows in np.array_split(near, 1 + len(near) * fine**3 // _AT_ONCE):
            index = (fine * rows[:, None] + inside).reshape(-1, 3)
            points = ((index + 0.5) / fine - 0.5) * step - cavity.lengths / 2 - step
            centres[tuple(index.T)] = cavity.depth(to_global(points, cavity.frame)) >= radius
    if not centres.any():
        return _Room(1.0, (), step / fine)
    label, count = ndimage.label(centres, structure=np.ones((3, 3, 3)))
    sizes = np.sort(np.bincount(label.ravel(), minlength=count + 1)[1:])[::-1] / centres.sum()
    space = depth > 0
    apart = ndimage.distance_transform_edt(~coarse, sampling=step) if coarse.any() else np.full(depth.shape, np.inf)
    return _Room(float((apart[space] > radius + step).mean()), tuple(sizes.tolist()), step / fine)


def neck_notes(cavity: Cavity, radius: float) -> Iterator[str]:
    """Yield what spheres of this radius cannot reach, and the parts between which they cannot pass."""
    room = _room(cavity, radius)
    size, spare = f"particles of {amount(2 * radius, 'm')}", amount(room.step, "m", 2)
    large = [share for share in room.parts if share > _SMALLEST]
    if len(large) > 1:
        shares = joined([f"{100 * share:.0f} %" for share in large[:5]]) + (", ..." if len(large) > 5 else "")
        yield (
            f"the space has {counted(len(large), 'part')} between which {size} cannot pass: the necks between them are "
            f"narrower or leave less than {spare} to spare, or there are none ({shares} of the room for their centres)"
        )
    if radius < room.step:
        yield (
            f"warning: necks and walls thinner than {spare} are not checked for {size}: whether they can pass into all "
            "parts of the space is unknown; try: larger particles, or a space without such necks"
        )
    if room.unreached > _UNREACHED:
        yield (
            f"warning: {size} do not reach {100 * room.unreached:.0f} % of the volume, which is too narrow for them but "
            "counts in fill_ratio and bed_fill; try: smaller particles, count, or a surface without these parts"
        )
