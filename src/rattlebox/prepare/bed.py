"""Volume, height and density of the bed of particles in a cavity."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from rattlebox.model.crowds import Crowd
from rattlebox.model.errors import at
from rattlebox.model.overlaps import tree_of
from rattlebox.prepare.settle import VOLUME_POINTS, start_positions

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.any_cavity import AnyCavity
    from rattlebox.model.particle_damper import ParticleDamper

    Array = NDArray[np.float64]

MARGIN = 2.0
"""Distance of the bulk from the walls and from the surface of the bed, over the largest diameter."""
TOLERANCE = 0.05
"""Difference between the measured and the stated bed fill above which a run has a note."""
MIN_FRICTION = 0.2
"""Coefficient of friction below which a full cavity does not stay full: its bed sinks under gravity."""
FULL = 0.97
"""Volume of a bed over that of its cavity from which the bed counts as full; balls in the last layer touch the lid."""
BULK_POINTS = 2**19
BULK_DEPTH = 1.0
"""Distance of a point from the limits of the bulk, over the largest diameter, without which there is no bulk."""


@dataclass(frozen=True)
class BedMeasures:
    """Fill of a cavity, by the volume of its particles and by the volume of their bed."""

    count: int
    fill_ratio: float
    bed_fill: float
    height: float  # Height of the bed above the lowest point of the cavity [m]; NaN without gravity
    density: float
    bulk_density: float
    bulk_error: float
    full_count: int


def bed_level(damper: ParticleDamper, positions: Array) -> tuple[float, float]:
    """Compute volume and height of a bed.

    `positions`: positions of the particles relative to the centre of the cavity, (n, 3) [m]. Returns volume of the bed over
    that of the cavity, and its height [m].

    Notes
    -----
    The surface is that of a liquid in the cavity with the same centre of mass: the level z at which the mean height of all
    points of the cavity below z is sum(R^3 z_i) / sum(R^3) over the particles. For level layers of equal spheres this is the
    top of the highest layer.
    """
    up, volume = np.asarray(damper.up), damper.contents.radius**3
    heights, centroids = _levels(damper.interior, tuple(up.tolist()))
    centre = float(volume @ (positions @ up) / volume.sum())
    below = int(np.searchsorted(centroids, centre))
    top = heights[min(below, heights.size - 1)]
    return below / heights.size, float(top - heights[0])


@lru_cache(maxsize=16)
def _levels(cavity: AnyCavity, up: tuple[float, float, float]) -> tuple[Array, Array]:
    """Return heights of points in a cavity, ascending, and the mean height of all points up to each."""
    heights = np.sort(cavity.spread(VOLUME_POINTS) @ np.array(up))
    return heights, np.cumsum(heights) / np.arange(1, heights.size + 1)


def bed_note(damper: ParticleDamper, name: str, fill: float) -> Iterator[str]:
    """Yield a note if a bed does not fill its cavity as `bed_fill` states, and a warning if a full one has sunk."""
    asked = damper.particles[0].bed_fill
    friction = damper.largest_friction
    is_computed, is_dense = damper.packing.is_computed, damper.packing.is_dense
    if asked == 1 and is_dense and damper.up is not None and friction < MIN_FRICTION:
        yield (
            f"warning: the bed of {name} fills {100 * fill:.3g} % of the cavity, not 100 %: with a coefficient of friction "
            f"of {friction:g}, below {MIN_FRICTION:g}, it sinks under gravity and leaves a gap at the top, in which "
            "particles move; try: count with more of them, or the friction of the real particles"
        )
    elif asked is not None and is_computed and abs(fill - asked) > TOLERANCE:
        count = damper.contents.radius.size
        more = "more" if fill < asked else "fewer"
        yield (
            f"the bed of {name} fills {100 * fill:.3g} % of the cavity, not {100 * asked:.3g} %, because the number of "
            f"particles, {count}, follows from the usual density of such a bed: use count with {more} of them"
        )


def loose_note(damper: ParticleDamper, name: str, fill: float, acceleration: float) -> Iterator[str]:
    """Yield a warning if a bed fills its cavity without being locked in it.

    Randomly packed particles touch only some of their neighbours and walls, so that a full bed has room to move.
    """
    is_full = damper.particles[0].bed_fill == 1 or fill > FULL
    weight = float(np.linalg.norm(damper.field))
    if is_full and damper.packing.is_computed and acceleration > weight:
        level = f"at {acceleration / weight:.2g} times gravity" if weight else "without gravity"
        yield (
            f"warning: the full bed of {name} is loose: randomly packed particles have room to move, and {level} they do so "
            "like a dense fluid, which loses up to about 2 m V^2 in a cycle; only particles that touch each other and all "
            "walls are locked; try: packing = rb.Positions with a block of them, if those of the real damper are pressed "
            "together"
        )


def measure_bed(damper: ParticleDamper) -> BedMeasures:
    r"""Measure the fill of a damper, by the volume of its particles and by the volume of their bed.

    Parameters
    ----------
    damper
        Damper with any packing; a settled or compacted bed is computed, as before a run.

    Returns
    -------
    BedMeasures
        Fill ratio, volume, height and density of the bed, and the number in a full cavity.

    Raises
    ------
    CaseError
        If particles cannot be inserted, or do not come to rest.

    Notes
    -----
    The surface of the bed is that of a liquid in the cavity with the same centre of mass,
    :math:`\sum R^3 z / \sum R^3` over the particles; for level layers of equal spheres this is the top of the highest
    layer. The density is the fill ratio over the bed fill. The density of the bulk is the share of points in spheres, of
    the points of the bed that are two diameters away from walls and surface; its standard error is estimated from eight
    parts of equal volume. It is NaN if no point is three diameters away from them: a thinner bulk is a layer
    or a gap. Volumes are counted on at least 65 000 evenly spread points, with a relative error below 0.3 %.

    Examples
    --------
    >>> import rattlebox as rb
    >>> damper = rb.ParticleDamper(
    ...     particles=rb.Particles(material="steel", diameter="4 mm", bed_fill=0.9),
    ...     cavity=rb.Box(size=("30 mm", "30 mm", "30 mm")),
    ...     contact=rb.Tsuji(restitution=0.7),
    ...     friction=0.3,
    ...     packing=rb.Compacted(seed=1),
    ... )
    >>> bed = rb.measure_bed(damper)
    >>> bed.count, round(bed.fill_ratio, 2), abs(bed.bed_fill - 0.9) < 0.03
    (394, 0.49, True)
    """
    with at("packing"):
        positions = start_positions(damper)
    cavity, contents = damper.interior, damper.contents
    fill_ratio = 4 / 3 * math.pi * float(np.sum(contents.radius**3)) / cavity.volume
    fill, height = (math.nan, math.nan) if damper.up is None else bed_level(damper, positions)
    bulk, error = _bulk_density(damper, positions, height)
    return BedMeasures(
        count=contents.radius.size,
        fill_ratio=fill_ratio,
        bed_fill=fill,
        height=height,
        density=fill_ratio / fill if fill else math.nan,
        bulk_density=bulk,
        bulk_error=error,
        full_count=Crowd.of(contents.radius).at_random(cavity),
    )


def _bulk_density(damper: ParticleDamper, positions: Array, height: float) -> tuple[float, float]:
    """Return the density in the bulk and its standard error; NaN if there is no bulk."""
    cavity, radii = damper.interior, damper.contents.radius
    diameter = 2 * float(radii.max())
    points = cavity.spread(BULK_POINTS)
    depth = cavity.depth(points) - MARGIN * diameter
    if damper.up is not None:
        heights = points @ damper.up
        depth = np.minimum(depth, heights.min() + height - MARGIN * diameter - heights)
    # A bulk that is thinner than two diameters is a plane through or between the centres of a layer.
    if depth.max() < BULK_DEPTH * diameter:
        return math.nan, math.nan
    points = points[depth > 0]
    filled = _in_spheres(points, positions, radii, cavity.period)
    # Points in eight octants about the median are eight parts of similar volume.
    octant = (points > np.median(points, axis=0)) @ np.array([1, 2, 4])
    parts = np.array([filled[octant == k].mean() for k in np.unique(octant)])
    return float(filled.mean()), float(parts.std(ddof=1) / math.sqrt(parts.size))


def _in_spheres(points: Array, positions: Array, radii: Array, period: Array) -> NDArray[np.bool_]:
    """Return whether each point is in one of the spheres, (n,)."""
    filled = np.zeros(len(points), bool)
    sizes = np.log2(radii / radii.min()).astype(int)
    for size in np.unique(sizes):  # The search radius is that of similar spheres.
        similar = np.flatnonzero(sizes == size)
        near = tree_of(points, period).sparse_distance_matrix(
            tree_of(positions[similar], period), float(radii[similar].max()), output_type="ndarray"
        )
        filled[near["i"][near["v"] < radii[similar][near["j"]]]] = True
    return filled
