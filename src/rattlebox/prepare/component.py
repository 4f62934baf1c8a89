"""Packed cases for steppers: dampers as components in the time loop of another program."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rattlebox._util.own_files import register_format
from rattlebox._util.quantities import quantity
from rattlebox.core import _core
from rattlebox.model.case import Case
from rattlebox.model.contact_pairs import contact_pairs
from rattlebox.model.damper_base import Damper
from rattlebox.model.dampers import ImpactDamper
from rattlebox.model.errors import Hint, at
from rattlebox.model.methods import Method
from rattlebox.model.particle_damper import ParticleDamper
from rattlebox.model.signals import Signal
from rattlebox.model.stops import refuse_stops
from rattlebox.model.structures import SDOF, Fixed, Shaker
from rattlebox.model.units import Quantity

from .pack import pack
from .particles import Prepared, pack_particles, prepare

IDLE = _core.Harmonic(amplitude=0.0, frequency=0.0, phase=0.0, start=0.0, stop=0.0)
"""Signal of an input, whose values are arguments of the steps."""

_EMPTY = np.zeros(0)
_NO_MODES = dict.fromkeys(
    ("mode_decay", "mode_stiffness", "mode_coupling", "mode_displacement", "mode_velocity"), _EMPTY
)
"""Fields of a problem of the core without a structure."""

_MAGIC = b"RATTLEBX"  # as in core/stepper/packed_case.hpp


def _is_packed_case(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(len(_MAGIC)) == _MAGIC


register_format(".bin", _is_packed_case)

LIGHT, HEAVY = 0.03, 0.3
"""Mass in a damper over the effective mass of its structure. Up to `LIGHT`, the reaction of the structure within a step does
not matter; above `HEAVY`, an exchange once in each step may diverge (tests/verification/test_stepper.py)."""


@dataclass(frozen=True)
class PackedComponent:
    """A case as a component."""

    data: bytes
    alone: bool
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    dampers: tuple[str, ...]  # and behind them the stops
    axes: int
    notes: tuple[str, ...]
    prepared: Prepared | None = None


def damper_case(
    damper: ImpactDamper | ParticleDamper,
    method: Method | None,
    motion: Signal | None,
    structure_mass: Quantity | None,
    duration: Quantity,
) -> Case:
    """Return the case of a damper alone.

    `structure_mass`: effective mass of the structure at the attachment [kg], or None for a rigid one. The dashpots of
    impact dampers are adjusted to it. `duration`: duration that the step must suit [s].
    """
    structure: SDOF | Shaker | Fixed = Fixed() if motion is None else Shaker(motion=motion)
    if structure_mass is not None:
        if not damper.has_adjusted_dashpots:
            raise Hint(
                "structure_mass adjusts the contacts of impact dampers only: a particle is much lighter than the structure",
                "no structure_mass",
            )
        structure = SDOF(mass=structure_mass, stiffness=0)
    return Case(
        structure=structure, dampers=(damper,), duration=duration, **({} if method is None else {"method": method})
    )


def pack_component(case: Case, *, alone: bool, velocity: Any = 0.0) -> PackedComponent:
    """Pack a case for a stepper.

    `velocity`: initial velocity of the attachment of a damper alone [m/s]: a number, or three components for particles.
    """
    if not case.method.has_stepper:
        raise Hint(f"the method {case.method.kind} has no stepper", "method = EventDriven(), or Newton()")
    for index, damper in enumerate(case.dampers):
        with at(*(("dampers", index) if len(case.dampers) > 1 else ("damper",))):
            damper.check_packable()
    if alone:
        refuse_stops(
            case.stops,
            "a damper alone has no structure that could meet a stop",
            "alone=False, for the structure with them",
        )
    if alone and len(_dampers(case)) != 1:
        raise Hint(f"a damper alone is needed, but the case has {len(_dampers(case))}", "a stepper for each of them")
    return _particles(case, alone, velocity) if case.particle_dampers else _impact(case, alone, velocity)


def _impact(case: Case, alone: bool, velocity: float) -> PackedComponent:
    problem = pack(case)
    if alone:
        (damper,) = problem.dampers
        problem = problem.replace(
            **_NO_MODES,
            dampers=[
                damper.replace(
                    shape=_EMPTY,
                    position=np.asarray(damper.position) - case.modes.q0 @ np.asarray(damper.shape),
                    velocity=np.asarray(damper.velocity) - velocity,
                )
            ],
            loads=[_core.Load(signal=IDLE, shape=_EMPTY, base=True)],
        )
    points = () if alone else tuple(name for name in case.modes.shapes if name not in case.modes.spatial)
    rows = [list(map(float, case.modes.shape(name))) for name in points]
    data = _packed(_idle(problem), alone, (float(velocity), 0.0, 0.0), rows)
    return PackedComponent(
        data,
        alone,
        _inputs(case, alone, 1),
        points,
        _names(case),
        1,
        _exchange_notes(case, _steps_of_impacts(case), LIGHT) if alone else (),
    )


def _particles(case: Case, alone: bool, velocity: Any) -> PackedComponent:
    prepared = prepare(case)
    problem = pack_particles(prepared)
    start = np.zeros(3)
    if alone:
        start[:] = velocity
        (cavity,) = problem.cavities
        problem = problem.replace(
            **_NO_MODES,
            cavities=[
                cavity.replace(
                    shape=np.zeros((0, 3)),
                    position=np.asarray(cavity.position) - case.modes.q0 @ np.asarray(cavity.shape),
                    velocity=np.asarray(cavity.velocity) - start,
                )
            ],
            loads=[_core.Load(signal=IDLE, shape=_EMPTY, base=True)] * 3,
            load_directions=np.eye(3),
        )
    points = () if alone else tuple(case.modes.shapes)
    line = case.particle_dampers[0].direction  # of points that move along a line
    rows = [list(map(float, row)) for name in points for row in case.modes.space_shape(name, line).T]
    data = _packed(_idle(problem), alone, tuple(start), rows)
    # Particles do not act on the structure at once, so that only a mass that may diverge needs a note.
    notes = _exchange_notes(case, "steps much shorter than a contact", HEAVY) if alone else ()
    return PackedComponent(
        data,
        alone,
        _inputs(case, alone, 3),
        points,
        _names(case),
        3,
        (*prepared.notes, *notes),
        prepared,
    )


def _packed(problem: Any, *arguments: Any) -> bytes:
    """Return the bytes of a problem; raise if it has a law whose code is in another library."""
    try:
        return _core.pack_case(problem, *arguments)
    except ValueError as error:
        raise Hint(str(error), "a law of Rattlebox, such as rb.PowerLaw or rb.TabulatedNormal") from None


def _exchange_notes(case: Case, steps: str, share: float) -> tuple[str, ...]:
    """Return a note on the exchanges that a damper alone needs, if the mass of its structure is known.

    `steps`: words for the steps that the contacts of the damper need. `share`: smallest mass in the damper over the
    effective mass of the structure that is worth a note.
    """
    (damper,) = case.dampers
    ratio = damper.mass * case.modes.mobility(damper.point)
    if ratio > HEAVY:
        return (
            f"warning: {ratio:.2g} times the effective mass of the structure is in {damper.label(0)}, and one exchange in "
            f"each step may diverge; try: {steps}, or repeated steps with a relaxation of {1 / (1 + ratio):.2g}",
        )
    if ratio > share:
        return (
            f"{100 * ratio:.2g} % of the effective mass of the structure is in {damper.label(0)}: with one exchange in each "
            f"step, impulses are too large by up to this share; try: {steps}",
        )
    return ()


def _steps_of_impacts(case: Case) -> str:
    """Return words for the steps that the contacts of a ball need."""
    contact, pair = case.impact_dampers[0].contact, contact_pairs(case, 0)[0]
    if case.method.hard_restitution(contact, pair) is not None:
        return "contacts with a duration, method = EventDriven(), and steps much shorter than it"
    law = _core.normal_law(*contact.coefficients(pair))
    return f"steps much shorter than a contact, which lasts {quantity(law.contact_time(1.0), 's', 2)} at 1 m/s"


def _idle(problem: Any) -> Any:
    return problem.replace(loads=[load.replace(signal=IDLE) for load in problem.loads])


def _names(case: Case) -> tuple[str, ...]:
    names = [damper.label(index) for index, damper in enumerate(_dampers(case))]
    return (*names, *(stop.name for stop in case.each_stop))


def _dampers(case: Case) -> Sequence[Damper]:
    return case.particle_dampers or case.impact_dampers


def _inputs(case: Case, alone: bool, axes: int) -> tuple[str, ...]:
    if alone:
        return ("acceleration",) if axes == 1 else ("acceleration_x", "acceleration_y", "acceleration_z")
    base = [f"base_{number}" for number, _ in enumerate(case.base_acceleration(), 1)]
    return (*(f"load_{number}" for number, _ in enumerate(case.loads, 1)), *base)
