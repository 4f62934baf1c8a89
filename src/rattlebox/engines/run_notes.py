"""Warnings about a finished run: overlaps and speeds beyond the range of a law, and dampers without contacts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.quantities import quantity
from rattlebox.core import _core
from rattlebox.model.contact_pairs import contact_pairs
from rattlebox.model.contacts import MAX_OVERLAP, Contact
from rattlebox.prepare.time_step import MIN_STEPS_PER_CONTACT, contact_limits

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.model.contact_table import ContactTable
    from rattlebox.model.dampers import ImpactDamper
    from rattlebox.model.particle_damper import ParticleDamper
    from rattlebox.model.stops import Stop
    from rattlebox.prepare.particles import Prepared
    from rattlebox.results.arrays import Table


Damper = TypeVar("Damper", "ImpactDamper", "ParticleDamper")

_MANY_CONTACT_STEPS = 20_000_000
"""Steps in closed contacts, about ten seconds of processor time, from which a run has a note about them."""
_CLOSED = 1e-15
"""Gap of a hard contact at rest that is closed to rounding [m]."""
_CONTACT_GAP = 1e-9
"""Gap over the clearance below which a ball counts as touching."""


def _named(dampers: Sequence[Damper]) -> Iterator[tuple[str, Damper]]:
    """Yield dampers with their names, in which line breaks are spaces."""
    for index, damper in enumerate(dampers):
        yield " ".join(damper.label(index).split()), damper


def impact_notes(
    case: Case, offsets: NDArray[np.float64], stop_gaps: NDArray[np.float64], impacts: Table
) -> tuple[str, ...]:
    """Return the warnings about a finished 1-D run.

    `offsets` are those of balls from the packed row, (T, balls) [m], `stop_gaps` those of the stops, (T, stops) [m].
    """
    notes: list[str] = []
    first = 0
    for index, (name, damper) in enumerate(_named(case.impact_dampers)):
        count = len(damper.balls)
        here = impacts.damper == index
        if here.any():
            notes += _deep_overlaps(damper, name, impacts.contact[here], impacts.peak_overlap[here])
            notes += _fast_impacts(damper, name, impacts.contact[here], impacts.approach_speed[here])
            notes += _beyond_measured_impacts(case, index, name, impacts, here)
        else:
            notes += _no_impacts(damper, name, offsets[:, first : first + count])
        first += count
    for index, stop in enumerate(case.each_stop, len(case.impact_dampers)):
        here = impacts.damper == index
        if here.any():
            notes += _stop_notes(case, stop, impacts, here)
        else:
            smallest = float(stop_gaps[:, index - len(case.impact_dampers)].min())
            name, gap = " ".join(stop.name.split()), _length(stop.gap)
            if smallest > _CLOSED:  # otherwise the stop may carry a force from the start
                notes.append(f"note: no impact at {name} (smallest gap {_length(smallest)}, at rest {gap})")
    return tuple(notes)


def _stop_notes(case: Case, stop: Stop, impacts: Table, here: NDArray[np.bool_]) -> Iterator[str]:
    """Yield the warnings about the contacts of a stop: the limits of its law, and modes that it excites."""
    name = " ".join(stop.name.split())
    overlap, law = float(np.nanmax(impacts.peak_overlap[here])), stop.contact
    if stop.radius is not None and overlap > law.overlap_limit * stop.radius:
        yield (
            f"warning: overlaps in {name} reach {100 * overlap / stop.radius:.3g} % of the radius; the contact law holds "
            f"below {100 * law.overlap_limit:g} %: use a stiffer contact or slower impacts"
        )
    speed = float(np.nanmax(impacts.approach_speed[here]))
    yield from _fast_impact(law, name, speed)
    if law.measured_overlap is not None:
        if overlap == 0:  # a hard impact has none; use the overlap that the curve gives for its speed
            overlap = _core.normal_law(*law.coefficients(stop.pair(case.modes))).largest_overlap(speed)
        yield from _beyond_measurement(name, [(overlap, law.measured_overlap)])
    # An impact excites the modes up to about the inverse of twice its duration; further ones would change its force.
    stiffness = case.modes.stiffness
    frequencies = np.sqrt(stiffness) / (2 * np.pi)
    lasted = impacts.duration[here & impacts.complete]
    shortest = float(lasted.min()) if lasted.size else 0.0
    if case.structure.is_truncated and 2 * shortest * float(frequencies.max(initial=0.0)) < 1:
        length = f"{quantity(shortest, 's', 3)} long" if shortest else "hard"
        yield (
            f"note: impacts at {name} are {length}, shorter than half a period of the highest mode, at "
            f"{quantity(float(frequencies.max()), 'Hz', 3)}: force and loss depend on the number of modes; compare with "
            "twice as many modes, or use a softer contact"
        )


def component_notes(case: Case, overlaps: NDArray[np.float64], speeds: NDArray[np.float64]) -> Iterator[str]:
    """Yield the warnings about the contacts of impact dampers that are advanced step by step.

    Overlaps [m] and approach speeds [m/s] are the largest of each contact, damper after damper; 0 without contact.
    """
    first = 0
    for name, damper in _named(case.impact_dampers):
        count = len(damper.balls) + 1
        contacts = slice(first, first + count)
        touched = np.flatnonzero(speeds[contacts])
        if touched.size:
            yield from _deep_overlaps(damper, name, touched, overlaps[contacts][touched])
            yield from _fast_impacts(damper, name, touched, speeds[contacts][touched])
        first += count


@dataclass(frozen=True)
class ContactLimit:
    """A value that contacts of a component should not exceed."""

    # "overlap" or "speed": of approach [m/s]. Overlaps are in m in impact dampers, over the radius in particle dampers.
    quantity: Literal["overlap", "speed"]
    index: int
    value: float
    text: str


def validity_limits(case: Case, prepared: Prepared | None) -> Iterator[ContactLimit]:
    """Yield the limits within which the contacts of a component are valid."""
    if prepared is not None:
        yield from _limits_of_particles(prepared)
        return
    first = 0
    for name, damper in _named(case.impact_dampers):
        radii, shares = _overlap_limits(damper)
        for k, law in enumerate(_contact_laws(damper)):
            if np.isfinite(radii[k]):
                yield ContactLimit("overlap", first + k, radii[k] * shares[k], _deep(name, shares[k]))
            if law.measured_overlap is not None:
                text = f"overlaps in {name} exceed the measured force curve, which is extrapolated: extend the curve"
                yield ContactLimit("overlap", first + k, law.measured_overlap, text)
            yield from _limit_of_table(law, name, first + k)
        first += len(radii)


def _limits_of_particles(prepared: Prepared) -> Iterator[ContactLimit]:
    """Yield the limits of each particle damper: overlap, speed for the time step, and tables of restitution."""
    from scipy.optimize import brentq  # takes as long to import as a short run

    case, step = prepared.case, prepared.step
    dampers = zip(_named(case.particle_dampers), prepared.tables, strict=True)
    for index, ((name, damper), table) in enumerate(dampers):
        yield ContactLimit("overlap", index, MAX_OVERLAP, _deep(name, MAX_OVERLAP))

        def steps(log_speed: float, damper: ParticleDamper = damper, table: ContactTable = table) -> float:
            limits = contact_limits(case, damper, table, 10**log_speed, 1.0)
            return min(limit.duration for limit in limits) / step.dt - MIN_STEPS_PER_CONTACT

        # The shortest contact shortens with the speed: find the speed at which it has the fewest allowed steps.
        slowest, fastest = -6.0, 6.0
        if steps(slowest) > 0 > steps(fastest):
            speed = 10 ** float(brentq(steps, slowest, fastest, xtol=1e-6))
            text = (
                f"approach speeds in {name} leave fewer than {MIN_STEPS_PER_CONTACT:g} steps in a contact: export the "
                "damper with a motion that is as fast, or with a shorter step"
            )
            yield ContactLimit("speed", index, speed, text)
        for contact in dict.fromkeys(entry.contact for entry in table.entries):
            yield from _limit_of_table(contact, name, index)


def _deep(name: str, share: float) -> str:
    """Return the text of the limit of overlaps."""
    return (
        f"overlaps in {name} exceed {100 * share:g} % of the radius, above which the contact law does not hold: use a "
        "stiffer contact or slower impacts"
    )


def _limit_of_table(contact: Contact, name: str, index: int) -> Iterator[ContactLimit]:
    """Yield the last speed of a table of restitution."""
    last = contact.last_tabulated_speed
    if last is not None:
        text = f"approach speeds in {name} exceed the table of restitution, whose last value is used: extend the table"
        yield ContactLimit("speed", index, last, text)


class Overlap(NamedTuple):
    """An overlap over the smaller radius, and its limit for the contact law."""

    ratio: float
    limit: float


def worst_overlap(damper: ImpactDamper, contacts: NDArray[np.int_], overlaps: NDArray[np.float64]) -> Overlap:
    """Return the overlap [m] of some contacts of a damper that is largest against the limit of its contact law."""
    radii, limits = _overlap_limits(damper)
    ratios = overlaps / radii[contacts]
    known = ratios / limits[contacts]
    if np.isnan(known).all():
        return Overlap(0.0, float(limits[contacts[0]]))
    worst = int(np.nanargmax(known))
    return Overlap(float(ratios[worst]), float(limits[contacts[worst]]))


def _deep_overlaps(
    damper: ImpactDamper, name: str, contacts: NDArray[np.int_], overlaps: NDArray[np.float64]
) -> Iterator[str]:
    """Yield a warning if an overlap exceeds the limit for its contact law."""
    if np.isnan(overlaps).all():
        return
    ratio, limit = worst_overlap(damper, contacts, overlaps)
    if ratio > limit:
        yield (
            f"warning: overlaps in {name} reach {100 * ratio:.3g} % of the radius; the contact law holds below "
            f"{100 * limit:g} %: use a stiffer contact or slower impacts"
        )


def _contact_laws(damper: ImpactDamper) -> list[Contact]:
    """Return the contact law of each contact of a damper, from wall to wall."""
    return [damper.contact, *[damper.ball_contact or damper.contact] * (len(damper.balls) - 1), damper.contact]


def _overlap_limits(damper: ImpactDamper) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the smaller radius [m] of each contact of a damper, and the largest allowed overlap over it."""
    radii = [ball.curvature for ball in damper.balls]  # not a number for strikers without one, which have no limit
    limits = [law.overlap_limit for law in _contact_laws(damper)]
    return np.array([radii[0], *np.minimum(radii[:-1], radii[1:]), radii[-1]]), np.array(limits)


def _fast_impacts(
    damper: ImpactDamper, name: str, contacts: NDArray[np.int_], speeds: NDArray[np.float64]
) -> Iterator[str]:
    """Yield warnings if approach speeds exceed the restitution tables of a damper."""
    at_walls = (contacts == 0) | (contacts == len(damper.balls))
    for contact, touched in ((damper.contact, at_walls), (damper.ball_contact or damper.contact, ~at_walls)):
        if touched.any():
            yield from _fast_impact(contact, name, float(np.nanmax(speeds[touched])))


def _fast_impact(contact: Contact, where: str, speed: float) -> Iterator[str]:
    """Yield a warning if an approach speed [m/s] exceeds the restitution table of a contact."""
    last = contact.last_tabulated_speed
    if last is not None and speed > last:
        yield (
            f"warning: approach speeds in {where} reach {quantity(speed, 'm/s', 3)}; the table of restitution ends at "
            f"{quantity(last, 'm/s', 3)}, above which its last value is used: extend the table"
        )


def table_notes(case: Case, speeds: Sequence[float]) -> Iterator[str]:
    """Yield warnings if the largest approach speed in a particle damper [m/s] exceeds a restitution table."""
    for (name, damper), speed in zip(_named(case.particle_dampers), speeds, strict=True):
        yield from dict.fromkeys(
            note for entry in damper.contact_table.entries for note in _fast_impact(entry.contact, name, speed)
        )


def extrapolation_notes(count: int) -> Iterator[str]:
    """Yield a warning about impacts outside the range of a fitted restitution law."""
    if count:
        yield (
            f"warning: {count} impacts are faster than the range for which the restitution law was fitted; the law was "
            "extrapolated: compare with Thornton contacts"
        )


def simultaneous_notes(count: int) -> Iterator[str]:
    """Yield a note about hard impacts at the same time."""
    if count:
        yield (
            f"note: at {count} instant{'s' * (count > 1)} several hard impacts began at the same time and were resolved "
            "together; a small difference of their times would change the result: compare with EventDriven"
        )


def vibration_notes(steps: int) -> Iterator[str]:
    """Yield a note about a run most of whose time was spent on vibrations of closed contacts."""
    if steps > _MANY_CONTACT_STEPS:
        yield (
            f"note: {steps / 1e6:.0f} million steps were made in closed contacts; a contact without damping vibrates for "
            "ever, and each of its vibrations is computed: give it a restitution below 1, or use Newton, whose balls at "
            "rest cost nothing"
        )


def _beyond_measured_impacts(
    case: Case, index: int, name: str, impacts: Table, in_damper: NDArray[np.bool_]
) -> Iterator[str]:
    """Yield a warning if an impact exceeds the last point of a measured force curve."""
    damper, pairs = case.impact_dampers[index], contact_pairs(case, index)
    deepest: list[tuple[float, float]] = []
    for contact, pair in enumerate(pairs):
        at_wall = contact in (0, len(pairs) - 1)
        law = damper.contact if at_wall else damper.ball_contact or damper.contact
        here = in_damper & (impacts.contact == contact)
        if law.measured_overlap is None or not here.any():
            continue
        overlap = float(np.nanmax(impacts.peak_overlap[here]))
        if overlap == 0:  # a hard impact has none; use the overlap that the curve gives for its speed
            force = _core.normal_law(*law.coefficients(pair))
            overlap = force.largest_overlap(float(impacts.approach_speed[here].max()))
        deepest.append((overlap, law.measured_overlap))
    yield from _beyond_measurement(name, deepest)


def _beyond_measurement(name: str, deepest: Iterable[tuple[float, float]]) -> Iterator[str]:
    """Yield a warning about the contact with the largest ratio of overlap to last measured overlap [m]."""
    overlap, measured = max(deepest, key=lambda pair: pair[0] / pair[1], default=(0.0, math.inf))
    if overlap > measured:
        yield (
            f"warning: overlaps in {name} reach {_length(overlap)}, but the contact force is measured only up to "
            f"{_length(measured)} and extrapolated with its last slope: extend the curve, or use slower impacts"
        )


def _no_impacts(damper: ImpactDamper, name: str, offsets: NDArray[np.float64]) -> Iterator[str]:
    """Yield a warning unless a ball touches a wall or a neighbour."""
    half = 0.5 * damper.clearance
    gaps = np.column_stack([half + offsets[:, 0], np.diff(offsets, axis=1), half - offsets[:, -1]])
    if gaps.min() > _CONTACT_GAP * damper.clearance:
        yield _no_contact_note(
            f"no ball of {name}",
            f"smallest distance between surfaces {_length(float(gaps.min()))}, gap {_length(half)}",
        )


def particle_notes(
    case: Case,
    first_touches: NDArray[np.int_],
    contacts: NDArray[np.int_],
    centre_of_mass: NDArray[np.float64],
    overlaps: Sequence[float],
) -> Iterator[str]:
    """Yield warnings about particle dampers without contacts, and about extrapolated force curves.

    `first_touches`: number of contacts that began, (dampers, partners). `contacts`: number of contacts at the samples, (T,
    dampers, partners). `centre_of_mass`: centre of mass of the particles in each cavity, (T, dampers, 3) [m].
    """
    for index, (name, damper) in enumerate(_named(case.particle_dampers)):
        yield from _beyond_measurement(name, _deepest_measured(damper, overlaps[index]))
        if not first_touches[index].any() and not contacts[:, index].any():
            room = float(damper.interior.room(damper.start.position, damper.contents.radius).min())
            centre = centre_of_mass[:, index]
            moved = float(np.linalg.norm(centre - centre[0], axis=1).max())
            distances = f"smallest distance to a wall at the start {_length(room)}, largest displacement from there"
            yield _no_contact_note(f"no particle of {name}", f"{distances} {_length(moved)}")


def _deepest_measured(damper: ParticleDamper, ratio: float) -> Iterator[tuple[float, float]]:
    """Yield an upper bound of the overlap of each measured contact, and its last measured overlap [m].

    The bound is exact where all particles have one size and law.
    """
    species = damper.contents.species
    radii = {each.label: damper.contents.radius[species == k].max() for k, each in enumerate(damper.particles)}
    for entry in damper.contact_table.entries:
        measured = entry.contact.measured_overlap
        if measured is not None:
            yield ratio * float(min(radii.get(name, np.inf) for name in entry.names)), measured


def _no_contact_note(what: str, distances: str) -> str:
    return f"warning: {what} touched anything ({distances}): check the units of lengths, the load and the duration"


def _length(value: float) -> str:
    return quantity(value, "m", 3) if value > 1e-15 else "0 m"
