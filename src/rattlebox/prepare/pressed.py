"""Given positions whose contacts overlap: comparison with the overlaps that the contact law makes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from rattlebox.model.errors import Hint
from rattlebox.model.overlaps import TOUCHING, overlapping
from rattlebox.prepare.time_step import pack_normal

if TYPE_CHECKING:
    from rattlebox.core._core import NormalForce
    from rattlebox.model.contact_table import ContactTable, Entry
    from rattlebox.model.particle_damper import ParticleDamper

DEEPER = 3.0
"""Accepted overlap over that of an impact of two particles at the largest expected speed. Particles that others press
together overlap more than two alone, but not by more than this factor in computed runs."""


def pressed_notes(damper: ParticleDamper, table: ContactTable, speed: float, name: str) -> Iterator[str]:
    """Yield a note if given positions overlap; raise if they overlap more than impacts at the expected speed make them.

    `speed`: largest expected approach speed [m/s].
    """
    if damper.packing.stated_count is None:
        return
    contents, centres = damper.contents, damper.start.position
    radii, masses, species = contents.radius, contents.mass, contents.species
    first, second, apart = overlapping(centres, radii, period=damper.interior.period)
    # One contact for each kind of pair decides, since the law and its usual overlap depend on the kind only.
    room = damper.interior.room(centres, radii)
    pairs = [
        (float(-apart[k]), int(first[k]), int(second[k]))
        for k in _deepest(
            apart, np.minimum(radii[first], radii[second]), table.particle_entry[species[first], species[second]]
        )
    ]
    wall_entry = table.wall_entry[species, table.wall_kind[damper.interior.nearest_wall(centres)]]
    walls = [(float(-room[k]), int(k), -1) for k in _deepest(room, radii, wall_entry)]
    deepest = 0.0
    for depth, one, other in pairs + walls:
        if other >= 0:
            entry = table.entries[table.particle_entry[species[one], species[other]]]
            law = _law(
                damper, entry, 1 / (1 / radii[one] + 1 / radii[other]), 1 / (1 / masses[one] + 1 / masses[other])
            )
            size = min(radii[one], radii[other])
        else:
            entry = table.entries[wall_entry[one]]
            law, size = _law(damper, entry, radii[one], masses[one]), radii[one]
        # Overlaps as deep as impacts make them are those of a run that is continued; much deeper ones would throw the
        # particles apart.
        usual = law.largest_overlap(speed)
        if depth > TOUCHING * size and depth > DEEPER * usual:
            raise _too_deep(damper, depth, usual, speed, one, other)
        deepest = max(deepest, depth / size)
    if deepest > TOUCHING:
        yield (
            f"the given positions of {name} overlap by up to {100 * deepest:.2g} % of the radius, as at the end of a run; "
            "the elastic energy of these contacts is part of the energy at the start"
        )


def _deepest(distance: np.ndarray, size: np.ndarray, entry: np.ndarray) -> list[int]:
    """Return the contact with the deepest overlap over its size for each kind of pair."""
    ratio = distance / size
    deepest = []
    for kind in np.unique(entry):
        of_kind = np.flatnonzero(entry == kind)
        deepest.append(int(of_kind[ratio[of_kind].argmin()]))
    return [k for k in deepest if distance[k] < 0]


def _law(damper: ParticleDamper, entry: Entry, radius: float, mass: float) -> NormalForce:
    """Return the softened normal law of two bodies."""
    return pack_normal(damper, entry).resized(entry.pair.radius, entry.pair.mass, radius, mass)


def _too_deep(damper: ParticleDamper, depth: float, usual: float, speed: float, one: int, other: int) -> Hint:
    """Return the error for an overlap that no impact makes."""
    bodies = (
        f"particles {min(one, other)} and {max(one, other)} overlap" if other >= 0 else f"particle {one} is in a wall"
    )
    softer = f", which has softening {damper.softening_factor:g}" if damper.softening_factor > 1 else ""
    return Hint(
        f"{bodies} by {1e3 * depth:.4g} mm, but an impact at {speed:.3g} m/s, the largest expected speed, makes "
        f"{1e3 * usual:.3g} mm{softer}; the contact would throw them apart",
        "positions of spheres that do not overlap; or, for the end of a run, its velocities and the softening of its "
        "contacts",
        ["packing", damper.packing.where],
    )
