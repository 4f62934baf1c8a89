"""Contacts and forces of elastic, frictionless spheres, by a search through all pairs and walls."""

from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Contacts:
    """Contacts and forces at one time.

    `pairs` holds (first, second), with walls numbered after the particles; `doubtful` those that overlap by less than the
    tolerance; `force` acts on the particles (n, 3), `on_cavity` and `moment` on the cavity (3,).
    """

    pairs: set[tuple[int, int]]
    doubtful: set[tuple[int, int]]
    force: Array
    on_cavity: Array
    moment: Array


def find_contacts(
    positions: Array, radii: Array, walls: Any, inside: Array, wall: Array, tolerance: float, period: Any = (0, 0, 0)
) -> Contacts:
    """Return contacts and forces at a moment.

    Parameters
    ----------
    positions, radii
        Positions from the centre of the cavity and radii, (n, 3) and (n,) [m].
    walls
        Walls of the cavity, with `axis`, `offset` and `form`.
    inside, wall
        Factor of sqrt(R*) in the Hertz stiffness, (n, n) among particles and (n,) at walls.
    tolerance
        Size of the overlap below which rounding may decide on a contact [m].
    period
        Distance of the images of a sphere along each axis [m], 0 for none; a pair touches through any of its images.
    """
    n = len(radii)
    force, on_cavity, moment = np.zeros((n, 3)), np.zeros(3), np.zeros(3)
    pairs, doubtful = set(), set()
    length = np.asarray(period, float)
    positions = positions - length * np.floor(positions / np.where(length > 0, length, np.inf) + 0.5)
    for image in product(*((-1, 0, 1) if each else (0,) for each in length)):
        apart = positions[:, None] - positions[None] + np.array(image) * length
        distance = np.sqrt((apart**2).sum(axis=2))
        overlap = radii[:, None] + radii[None] - distance
        for i, j in zip(*np.nonzero(np.triu(overlap > -tolerance, 1)), strict=True):
            assert (int(i), int(j)) not in pairs  # no pair touches through two images
            (doubtful if overlap[i, j] < tolerance else pairs).add((int(i), int(j)))
            stiff = inside[i, j] * np.sqrt(radii[i] * radii[j] / (radii[i] + radii[j]))
            push = stiff * max(overlap[i, j], 0.0) ** 1.5 * apart[i, j] / distance[i, j]
            force[i] += push
            force[j] -= push
    for k, (axis, offset, form) in enumerate(zip(walls.axis, walls.offset, walls.form, strict=True)):
        across = positions - np.outer(positions @ axis, axis) if form == "cylinder" else positions
        reach = np.linalg.norm(across, axis=1) if form != "plane" else positions @ axis
        for i in np.nonzero(reach + radii > offset - tolerance)[0]:
            deep = reach[i] + radii[i] - offset
            (doubtful if deep < tolerance else pairs).add((int(i), n + k))
            normal = across[i] / reach[i] if form != "plane" else axis
            push = wall[i] * np.sqrt(radii[i]) * max(deep, 0.0) ** 1.5 * normal
            force[i] -= push
            on_cavity += push
            moment += np.cross(positions[i] + (offset - reach[i]) * normal, push)
    return Contacts(pairs, doubtful, force, on_cavity, moment)
