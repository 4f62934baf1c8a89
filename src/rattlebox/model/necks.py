"""The room for spheres in cavities with bodies or surfaces of triangles: the widest place, and separate parts."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from rattlebox._util.phrases import counted, joined
from rattlebox._util.quantities import amount

from .cavities import Cavity
from .space import to_global

_CELLS = 64  # of the grid along the longest edge
_SEEDS = 2**14
_UNREACHED = 0.1  # share of the volume that no particle reaches, from which a run has a warning
_SMALLEST = 0.01  # share of a part that is mentioned


@lru_cache(maxsize=16)
def widest_sphere(cavity: Cavity) -> float:
    """Return the radius of the largest sphere that fits into a cavity, to about 1 % [m]."""
    points = cavity.spread(_SEEDS)
    if not len(points):
        return 0.0
    depth = cavity.depth(points)
    best = points[np.argsort(depth)[-20:]]
    generator = np.random.default_rng(1)
    step = float(cavity.lengths.max()) / 20
    deepest = cavity.depth(best)
    while step > 1e-3 * float(depth.max()):
        tries = best[:, None] + step * generator.standard_normal((len(best), 20, 3))
        depths = cavity.depth(tries.reshape(-1, 3)).reshape(len(best), 20)
        k = depths.argmax(axis=1)
        better = depths.max(axis=1) > deepest
        best[better] = tries[np.arange(len(best)), k][better]
        deepest = np.maximum(deepest, depths.max(axis=1))
        step *= 0.7
    return float(deepest.max())


@lru_cache(maxsize=16)
def _parts(cavity: Cavity, radius: float) -> tuple[float, tuple[float, ...]]:
    """Return the share of the volume that spheres do not reach, and the shares of separate parts for their centres."""
    from scipy import ndimage

    step = float(cavity.lengths.max()) / _CELLS
    if radius < step:  # passages of this width are narrower than the grid
        return 0.0, (1.0,)
    axes = [np.arange(-length / 2 - step, length / 2 + 1.5 * step, step) for length in cavity.lengths]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    depth = cavity.depth(to_global(grid.reshape(-1, 3), cavity.frame)).reshape(grid.shape[:3])
    centres = depth >= radius
    if not centres.any():
        return 1.0, ()
    apart = ndimage.distance_transform_edt(~centres, sampling=step)
    label, _ = ndimage.label(centres, structure=np.ones((3, 3, 3)))
    sizes = np.sort(np.bincount(label[centres])[1:])[::-1] / centres.sum()
    space = depth > 0
    return float((apart[space] > radius + step).mean()), tuple(sizes.tolist())


def neck_notes(cavity: Cavity, radius: float) -> Iterator[str]:
    """Yield what spheres of this radius cannot reach, and the parts between which they cannot pass."""
    unreached, parts = _parts(cavity, radius)
    size = f"particles of {amount(2 * radius, 'm')}"
    large = [share for share in parts if share > _SMALLEST]
    if len(large) > 1:
        shares = joined([f"{100 * share:.0f} %" for share in large[:5]]) + (", ..." if len(large) > 5 else "")
        yield (
            f"the space has {counted(len(large), 'part')} between which {size} cannot pass: the necks between them are "
            f"narrower, or there are none ({shares} of the room for their centres)"
        )
    if unreached > _UNREACHED:
        yield (
            f"warning: {size} do not reach {100 * unreached:.0f} % of the volume, which is too narrow for them but counts "
            "in fill_ratio and bed_fill; try: smaller particles, count, or a surface without these parts"
        )
