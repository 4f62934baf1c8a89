"""Notes on a finished run: overlaps beyond the range of the contact law, and dampers in which nothing touched."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rattlebox.core import _core
from rattlebox.model.contacts import Contact, Linear, TabulatedNormal
from rattlebox.model.pairs import contact_pairs
from rattlebox.model.restitutions import Tabulated
from rattlebox.prepare.time_step import MOST_OVERLAP
from rattlebox.results.quantities import quantity

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.model.dampers import ImpactDamper
    from rattlebox.model.particle_damper import ParticleDamper
    from rattlebox.results.arrays import Table

MOST_LINEAR_OVERLAP = 0.1
"""Largest overlap over the radius of a linear spring, which stands for a body softer than the ball, such as a pad."""

_TOUCHING = 1e-9  # gap over the clearance


def impact_notes(case: Case, places: NDArray[np.float64], impacts: Table) -> tuple[str, ...]:
    """Return the notes on a run that finished.

    Parameters
    ----------
    case
        The case.
    places
        Reduced positions of all balls in their cavities at the samples, (T, balls) [m].
    impacts
        The impact log.
    """
    notes: list[str] = []
    first = 0
    for index, damper in enumerate(case.impact_dampers):
        count = len(damper.balls)
        name = " ".join(damper.label(index).split())
        own = impacts.damper == index
        if own.any():
            notes += _deep_overlaps(damper, name, impacts.contact[own], impacts.peak_overlap[own])
            notes += _beyond_tables(damper, name, impacts.contact[own], impacts.approach_speed[own])
            notes += _measured_impacts(case, index, name, impacts, own)
        else:
            notes += _never_touched(damper, name, places[:, first : first + count])
        first += count
    return tuple(notes)


def _deep_overlaps(
    damper: ImpactDamper, name: str, contacts: NDArray[np.int_], overlaps: NDArray[np.float64]
) -> Iterator[str]:
    radii = [ball.half for ball in damper.balls]
    at_walls, among_balls = damper.contact, damper.ball_contact or damper.contact
    laws = [at_walls, *[among_balls] * (len(radii) - 1), at_walls]
    smaller = [radii[0], *np.minimum(radii[:-1], radii[1:]), radii[-1]]
    bounds = np.array([MOST_LINEAR_OVERLAP if isinstance(law, Linear) else MOST_OVERLAP for law in laws])
    depths = overlaps / np.asarray(smaller)[contacts]
    beyond = depths / bounds[contacts]
    if np.any(beyond > 1):
        worst = int(np.nanargmax(beyond))
        yield (
            f"warning: overlaps in {name} reach {100 * depths[worst]:.3g} % of the radius, and should stay below "
            f"{100 * bounds[contacts[worst]]:g} %: a stiffer contact, or slower impacts"
        )


def _beyond_tables(
    damper: ImpactDamper, name: str, contacts: NDArray[np.int_], speeds: NDArray[np.float64]
) -> Iterator[str]:
    at_walls = (contacts == 0) | (contacts == len(damper.balls))
    for contact, own in ((damper.contact, at_walls), (damper.ball_contact or damper.contact, ~at_walls)):
        if own.any():
            yield from _beyond_table(contact, name, float(np.nanmax(speeds[own])))


def _beyond_table(contact: Contact, where: str, speed: float) -> Iterator[str]:
    """Return a note if the largest approach speed [m/s] is above the table of the contact's restitution."""
    law = contact.impact_restitution
    if isinstance(law, Tabulated) and len(law.speeds) > 1 and speed > law.speeds[-1]:
        yield (
            f"warning: approach speeds in {where} reach {quantity(speed, 'm/s', 3)}; the table of restitution ends at "
            f"{quantity(law.speeds[-1], 'm/s', 3)}, above which its last value is used: extend the table"
        )


def table_notes(case: Case, speeds: Sequence[float]) -> Iterator[str]:
    """Return the same notes on particle dampers with these largest approach speeds [m/s]."""
    for index, (damper, speed) in enumerate(zip(case.particle_dampers, speeds, strict=True)):
        name = " ".join(damper.label(index).split())
        yield from dict.fromkeys(
            note for entry in damper.contact_table.entries for note in _beyond_table(entry.contact, name, speed)
        )


def extrapolated(count: int) -> Iterator[str]:
    """Return a note on impacts outside of the speeds for which a restitution law was fitted."""
    if count:
        yield (
            f"warning: {count} impacts are faster than the restitution law was fitted for, and extrapolated: "
            "compare with Thornton contacts"
        )


def _measured_impacts(case: Case, index: int, name: str, impacts: Table, own: NDArray[np.bool_]) -> Iterator[str]:
    """Yield a note if an impact went beyond the last point of a measured curve."""
    damper, pairs = case.impact_dampers[index], contact_pairs(case, index)
    deepest: list[tuple[float, TabulatedNormal]] = []
    for contact, pair in enumerate(pairs):
        at_wall = contact in (0, len(pairs) - 1)
        law = damper.contact if at_wall else damper.ball_contact or damper.contact
        mine = own & (impacts.contact == contact)
        if not isinstance(law, TabulatedNormal) or not mine.any():
            continue
        overlap = float(np.nanmax(impacts.peak_overlap[mine]))
        if overlap == 0:  # hard impacts: the overlap that the measured curve would have
            force = _core.normal_law(*law.coefficients(pair))
            overlap = force.largest_overlap(float(impacts.approach_speed[mine].max()))
        deepest.append((overlap, law))
    yield from _beyond_measurement(name, deepest)


def _beyond_measurement(name: str, deepest: Iterable[tuple[float, TabulatedNormal]]) -> Iterator[str]:
    """Yield a note on the measured curve that was used furthest beyond its last point."""
    overlap, law = max(deepest, key=lambda each: each[0] / each[1].overlap[-1], default=(0.0, None))
    if law is not None and overlap > law.overlap[-1]:
        yield (
            f"warning: overlaps in {name} reach {_length(overlap)}, but the contact force is measured up to "
            f"{_length(law.overlap[-1])} only and goes on with its last slope: measure further, or choose slower impacts"
        )


def _never_touched(damper: ImpactDamper, name: str, places: NDArray[np.float64]) -> Iterator[str]:
    half = 0.5 * damper.clearance
    gaps = np.column_stack([half + places[:, 0], np.diff(places, axis=1), half - places[:, -1]])
    if gaps.min() > _TOUCHING * damper.clearance:
        moved = float(np.ptp(places, axis=0).max())
        yield _nothing_touched(f"no ball of {name}", f"gap {_length(half)}", moved)


def particle_notes(
    case: Case,
    touches: NDArray[np.int_],
    contacts: NDArray[np.int_],
    places: NDArray[np.float64],
    overlaps: Sequence[float],
) -> Iterator[str]:
    """Yield notes on each particle damper in which nothing touched, or whose measured contacts were extrapolated.

    Parameters
    ----------
    case
        The case.
    touches
        Number of contacts that began, (dampers, partners).
    contacts
        Number of contacts at the samples, (T, dampers, partners).
    places
        Centre of mass of the particles in each cavity, (T, dampers, 3) [m].
    overlaps
        Largest overlap over the smaller radius, in each damper.
    """
    for index, damper in enumerate(case.particle_dampers):
        yield from _beyond_measurement(
            " ".join(damper.label(index).split()), _deepest_measured(damper, overlaps[index])
        )
        if not touches[index].any() and not contacts[:, index].any():
            room = float(damper.cavity.room(damper.start.position, damper.contents.radius).min())
            name = " ".join(damper.label(index).split())
            moved = float(np.ptp(places[:, index], axis=0).max())
            yield _nothing_touched(f"no particle of {name}", f"smallest distance to a wall {_length(room)}", moved)


def _deepest_measured(damper: ParticleDamper, ratio: float) -> Iterator[tuple[float, TabulatedNormal]]:
    """Yield an upper bound of the overlap of each measured contact; exact where all particles have one size and law."""
    species = damper.contents.species
    radii = {each.label: damper.contents.radius[species == k].max() for k, each in enumerate(damper.particles)}
    for entry in damper.contact_table.entries:
        if isinstance(entry.contact, TabulatedNormal):
            yield ratio * float(min(radii.get(name, np.inf) for name in entry.names)), entry.contact


def _nothing_touched(what: str, gap: str, moved: float) -> str:
    return (
        f"warning: {what} touched anything: {gap}, relative motion {_length(moved)}; check the units of lengths, "
        "the load and the duration"
    )


def _length(value: float) -> str:
    return quantity(value, "m", 3) if value > 1e-15 else "0 m"
