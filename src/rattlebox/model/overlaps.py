"""Checks that spheres are in a cavity and apart from each other."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .any_cavity import AnyCavity
from .elementwise import Vector
from .errors import Hint
from .space import AXES, wrapped

if TYPE_CHECKING:
    from scipy.spatial import cKDTree


TOUCHING = 1e-9  # tolerance for overlaps by rounding, relative to the radius
NARROWEST = 2.02
"""Least width of a periodic box over the diameter of the largest particle. Up to 2, two particles touch through both faces
at once; the rest is for the overlaps while particles are pushed apart."""
_FAR = 100.0  # distance over the size of the cavity from which positions are probably in other units


def check_size(cavity: AnyCavity, radius: float) -> None:
    """Raise if a sphere is as large as the cavity or larger."""
    widest = cavity.widest * (1 + TOUCHING)  # A slot exactly as wide as the sphere may be narrower by rounding.
    if 2 * radius > widest or 4 / 3 * math.pi * radius**3 >= cavity.volume:
        large = "larger than" if 2 * radius > widest else "as large as"
        raise Hint(
            f"a particle of {2e3 * radius:.4g} mm is {large} the cavity, which is {1e3 * widest:.4g} mm wide",
            "smaller particles, or a larger cavity; check both and their units",
        )
    for axis, length in zip(AXES, cavity.period, strict=True):
        if 0 < length < NARROWEST * 2 * radius:
            least = 2e3 * NARROWEST * radius
            raise Hint(
                f"the box is {1e3 * length:.4g} mm wide along {axis}, in which it is periodic; a particle of "
                f"{2e3 * radius:.4g} mm needs at least {least:.4g} mm, since two of them could otherwise touch twice",
                f"a width of {1.01 * least:.4g} mm, or smaller particles; a slice of a wide bed has about ten diameters",
            )


def check_packing(cavity: AnyCavity, positions: Vector, radii: Vector, allowed: float = TOUCHING) -> None:
    """Raise if spheres overlap or extend beyond the cavity.

    `positions`: centres, (n, 3) [m]. `radii`: radii, (n,) [m].
    """
    room = cavity.room(positions, radii)
    # The centre of a particle is inside of periodic faces, too; the image of its other half is on the other side.
    period = cavity.period
    beyond = np.where(period > 0, np.abs(positions) - 0.5 * period * (1 + TOUCHING), -np.inf).max(axis=1)
    room = np.where(beyond > 0, np.minimum(room, -beyond), room)
    worst = int((room / radii).argmin())
    if room[worst] < -allowed * radii[worst]:
        place = ", ".join(f"{1e3 * x:.4g}" for x in positions[worst])
        far = float(np.abs(positions).max()) > _FAR * cavity.volume ** (1 / 3)
        raise Hint(
            f"particle {worst} at ({place}) mm sticks out of the cavity by {-1e3 * room[worst]:.4g} mm",
            "positions in metres, or with units" if far else _where_inside(cavity, positions, radii, worst),
        )
    first, second, apart = overlapping(positions, radii, period=period)
    if apart.size:
        smaller = np.minimum(radii[first], radii[second])
        k = int((apart / smaller).argmin())
        if apart[k] < -allowed * smaller[k]:
            one, other = sorted((int(first[k]), int(second[k])))
            raise Hint(
                f"particles {one} and {other} overlap by {-1e3 * apart[k]:.4g} mm",
                f"positions at least {1e3 * (radii[first[k]] + radii[second[k]]):.4g} mm apart, the sum of their radii",
            )


def _where_inside(cavity: AnyCavity, positions: Vector, radii: Vector, worst: int) -> str:
    """Return advice for a particle outside of a cavity: the shift that brings all inside, or the room for its centre."""
    middle = 0.5 * (positions.max(axis=0) + positions.min(axis=0))
    from_corner = bool((positions >= 0).all() and positions.any())
    if from_corner and cavity.room(positions - middle, radii).min() >= -TOUCHING * radii.min():
        shift = ", ".join(f"{1e3 * x:.4g}" for x in -middle)
        return f"positions relative to the centre of the cavity: with a shift by ({shift}) mm all are inside"
    return f"a distance of at least {1e3 * radii[worst]:.4g} mm between its centre and the walls, or a larger cavity"


def overlapping(
    positions: Vector, radii: Vector, within: float = 0.0, period: Vector | None = None
) -> tuple[NDArray[np.intp], NDArray[np.intp], Vector]:
    """Return the pairs of spheres that overlap.

    `positions`: centres, (n, 3) [m]. `radii`: radii, (n,) [m]. `within`: largest distance between the surfaces of a pair
    [m]. `period`: distances of the images of a particle along x, y and z, 0 for none, (3,) [m]. Returns indices of the
    pairs, (p,); and distance between the surfaces [m], negative for an overlap, (p,).
    """
    octave = np.log2(radii / radii.min()).astype(int)  # small spheres have a smaller search radius
    classes = [np.flatnonzero(octave == k) for k in np.unique(octave)]
    trees = [tree_of(positions[members], period) for members in classes]
    pairs = []
    for k, (members, tree) in enumerate(zip(classes, trees, strict=True)):
        for others, other in zip(classes[k:], trees[k:], strict=True):
            reach = float(radii[members].max() + radii[others].max()) + within
            near = tree.sparse_distance_matrix(other, reach, output_type="ndarray")
            i, j = members[near["i"]], others[near["j"]]
            apart = near["v"] - radii[i] - radii[j]
            mask = (apart < within) & ((i < j) if other is tree else True)
            pairs.append((i[mask], j[mask], apart[mask]))
    first, second, apart = (np.concatenate(parts) for parts in zip(*pairs, strict=True))
    return first, second, apart


def tree_of(positions: Vector, period: Vector | None = None) -> cKDTree:
    """Return a search tree of points, and of their images if there is a period, (3,) [m]."""
    from scipy.spatial import cKDTree

    if period is None or not np.any(period):
        return cKDTree(positions)
    # SciPy expects coordinates from 0 to the period; an axis with the period 0 is not periodic.
    return cKDTree(wrapped(positions, period) + 0.5 * period, boxsize=period)
