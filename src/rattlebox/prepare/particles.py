"""Preparation of particle runs: softening, time step, initial positions; packing into the problem of the 3-D engine."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.exceptions import RattleboxError
from rattlebox._util.quantities import amount
from rattlebox.core import _core
from rattlebox.model.errors import at
from rattlebox.model.methods import EventDriven, Output
from rattlebox.model.particle_case import direction_of_base, inertia_along
from rattlebox.model.space import unit_vector
from rattlebox.prepare.bed import bed_level, bed_note, loose_note
from rattlebox.prepare.laws import pack_restitution
from rattlebox.prepare.pack import mode_coupling, pack, pack_signal
from rattlebox.prepare.periodic import periodic_notes
from rattlebox.prepare.pressed import pressed_notes
from rattlebox.prepare.settle import pack_solids, pack_walls, settle, start_positions
from rattlebox.prepare.softening import ENDURING, cavity_motion, choose_softening
from rattlebox.prepare.time_step import (
    Step,
    choose_step,
    evaluation_times,
    expected_speeds,
    largest_softening,
    pack_friction,
    pack_normal,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.case import Case
    from rattlebox.model.contact_table import ContactTable, Entry
    from rattlebox.model.particle_damper import ParticleDamper
    from rattlebox.model.rotation import Rotation

    Array = NDArray[np.float64]


@dataclass(frozen=True)
class Prepared:
    """A case with particle dampers, and the results of its preparation."""

    case: Case
    notes: tuple[str, ...]
    step: Step
    tables: tuple[ContactTable, ...]
    positions: tuple[Array, ...]  # Initial positions of the particles of each damper, (n, 3) [m]
    fills: Mapping[str, float]


def prepare(case: Case, positions: Sequence[Array] | None = None) -> Prepared:
    """Choose the softening and the time step of a case, and compute its settled packings.

    `positions`: initial positions of the particles of each damper, (n, 3) [m], from a checkpoint. By default, settled
    packings are computed.
    """
    case, notes = resolve_softening(case)
    tables, step = _step(case)
    shapes = _shapes(case)
    starts = tuple(_positions(case, shapes, positions))
    pressed: list[str] = []
    for index, (damper, table, speed) in enumerate(zip(case.particle_dampers, tables, step.speeds, strict=True)):
        with at(*(("dampers", index) if len(tables) > 1 else ("damper",))):
            pressed += pressed_notes(damper, table, speed, damper.label(index))
    inside = [
        start - _displacement(case, damper, shape)
        for start, damper, shape in zip(starts, case.particle_dampers, shapes, strict=True)
    ]
    fills, more = _fills(case, inside, [motion.acceleration for motion in step.motions])
    periodic = [
        note
        for index, (damper, shape) in enumerate(zip(case.particle_dampers, shapes, strict=True))
        for note in periodic_notes(case, damper, shape, damper.label(index))
    ]
    return Prepared(case, (*notes, *more, *pressed, *periodic, *_turning_notes(case)), step, tables, starts, fills)


def _turning_notes(case: Case) -> list[str]:
    """Return a note on the energy of particles that turn with their cavities at the start."""
    energy = sum(
        0.5 * damper.mass * float(damper.rotation.at(0.0).speed) ** 2 * float(np.sum(damper.rotation.radial**2))
        for damper in case.particle_dampers
        if damper.rotation is not None
    )
    note = (
        f"the energy supplied contains {amount(energy, 'J')} of particles that turn with their cavities at the start, "
    )
    return [note + "so that shares of it are small: compare losses in joules or in a cycle"] if energy > 0 else []


def count_steps(case: Case) -> int:
    """Return the number of time steps of a run, without its preparation."""
    return _step(resolve_softening(case)[0])[1].count


def _step(case: Case) -> tuple[tuple[ContactTable, ...], Step]:
    """Return the contact laws of the pairs in each damper, and the time step."""
    shapes = _shapes(case)
    tables = tuple(damper.contact_table for damper in case.particle_dampers)
    state = _without_particles(case)
    speeds = expected_speeds(case, [state[..., 1] @ shape for shape in shapes])
    with at("method", "dt"):
        step = choose_step(case, list(tables), speeds)
    return tables, replace(step, motions=tuple(cavity_motion(case, shape, state) for shape in shapes))


def pack_particles(prepared: Prepared) -> _core.DemProblem:
    """Pack a prepared case for the core."""
    case, step = prepared.case, prepared.step
    modes = case.modes
    slowest = min((motion.main for motion in step.motions if motion.main), default=0.0)
    loads, directions = _loads(case)
    pairs: list[_core.PairLaws] = []
    cavities = []
    parts = zip(case.particle_dampers, _shapes(case), prepared.tables, prepared.positions, strict=True)
    for damper, shape, table, position in parts:
        cavities.append(_cavity(case, damper, shape, table, len(pairs), position))
        pairs += [_pair_laws(damper, entry) for entry in table.entries]
    return _core.DemProblem(
        dt=step.dt,
        enduring=ENDURING / slowest if slowest else math.inf,
        steps=step.count,
        every=step.every,
        each_wall=case.output.walls,
        gravity=_array(case.particle_dampers[0].gravity),
        mode_decay=_array(modes.decay),
        mode_stiffness=_array(modes.stiffness),
        mode_coupling=mode_coupling(modes),
        mode_displacement=_array(modes.q0),
        mode_velocity=_array(modes.p0),
        loads=loads,
        load_directions=directions,
        cavities=cavities,
        pairs=pairs,
    )


def settle_all(case: Case, proceed: Callable[[], bool]) -> bool:
    """Compute the settled packings of a case in advance; `prepare` reads them from the cache of `settle`."""
    return all(
        not damper.packing.is_computed or settle(damper, proceed) is not None for damper in case.particle_dampers
    )


def refusal_reason(case: Case) -> str:
    """Return the reason why a case cannot be run; empty if it can."""
    try:
        settle_all(case, lambda: True)
        prepare(case)
    except RattleboxError as error:
        return str(error)
    return ""


def resolve_softening(case: Case) -> tuple[Case, tuple[str, ...]]:
    """Return a case with a number in place of each softening "auto", and the reasons for these numbers."""
    dampers = case.particle_dampers
    if all(damper.softening != "auto" for damper in dampers):
        return case, ()
    shapes = _shapes(case)
    state = _without_particles(case)
    speeds = expected_speeds(case, [state[..., 1] @ shape for shape in shapes])
    new_dampers = list(dampers)
    notes = []
    for index, (damper, shape, speed) in enumerate(zip(dampers, shapes, speeds, strict=True)):
        if damper.softening == "auto":
            choice = choose_softening(damper, cavity_motion(case, shape, state), largest_softening(case, damper, speed))
            new_dampers[index] = damper.model_copy(update={"softening": choice.softening})
            notes.append((f"{damper.label(index)}: " if len(dampers) > 1 else "") + choice.note)
    return case.model_copy(update={"dampers": tuple(new_dampers)}), tuple(notes)


def _array(values: object) -> Array:
    return np.ascontiguousarray(values, dtype=np.float64)


def _shapes(case: Case) -> list[Array]:
    return [case.modes.space_shape(damper.point, damper.direction) for damper in case.particle_dampers]


def _displacement(case: Case, damper: ParticleDamper, shape: Array) -> Array:
    """Return the displacement of a cavity at the start, along its axes, (3,) [m]."""
    displacement = np.asarray(case.modes.q0 @ shape)
    turning = damper.rotation
    if turning is None or turning.vibration == "cavity":
        return displacement
    return turning.to_cavity(displacement, turning.at(0.0).angle)


def _rotation(rotation: Rotation | None) -> _core.Rotation | None:
    """Pack the rotation of a cavity."""
    if rotation is None:
        return None
    knots, coefficients = rotation.polynomials
    return _core.Rotation(
        axis=unit_vector(rotation.axis),
        arm=_array(rotation.arm),
        carries_structure=rotation.vibration == "cavity",
        knots=_array(knots),
        coefficients=_array(coefficients),
        amplitude=rotation.amplitude,
        frequency=rotation.rocking,
        phase=0.0,
    )


def _positions(case: Case, shapes: Sequence[Array], known: Sequence[Array] | None) -> list[Array]:
    """Return the initial positions of the particles of each damper; settled ones are taken from `known` if it is given."""
    positions = []
    beds = {} if known is not None else _beds(case)
    for index, (damper, shape) in enumerate(zip(case.particle_dampers, shapes, strict=True)):
        if known is not None and damper.packing.is_computed:
            position = known[index]
        else:
            with at(*(("dampers", index) if len(shapes) > 1 else ("damper",)), "packing"):
                start = beds[index].result() if index in beds else start_positions(damper)
                position = start + _displacement(case, damper, shape)
        positions.append(_array(position))
    return positions


def _beds(case: Case) -> dict[int, Future[Array]]:
    """Compute the beds of several dampers in parallel, by the index of the damper; each has its own random numbers."""
    computed = {index: damper for index, damper in enumerate(case.particle_dampers) if damper.packing.is_computed}
    if len(computed) < 2:
        return {}
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        return {index: pool.submit(start_positions, damper) for index, damper in computed.items()}


def _fills(
    case: Case, positions: Sequence[Array], accelerations: Sequence[float]
) -> tuple[dict[str, float], list[str]]:
    """Return the fills of all cavities together, and notes on beds; positions are relative to the cavities."""
    dampers = case.particle_dampers
    volume = sum(damper.interior.volume for damper in dampers)
    solid = sum(4 / 3 * math.pi * float(np.sum(damper.contents.radius**3)) for damper in dampers)
    fills = {"fill_ratio": solid / volume}
    notes: list[str] = []
    beds = [math.nan for _ in dampers]
    if all(damper.packing.is_computed and damper.up is not None for damper in dampers):
        beds = [bed_level(damper, centres)[0] for damper, centres in zip(dampers, positions, strict=True)]
        fills["bed_fill"] = (
            sum(bed * damper.interior.volume for bed, damper in zip(beds, dampers, strict=True)) / volume
        )
        for index, (damper, bed) in enumerate(zip(dampers, beds, strict=True)):
            notes += bed_note(damper, damper.label(index), bed)
    for index, (damper, bed, acceleration) in enumerate(zip(dampers, beds, accelerations, strict=True)):
        notes += loose_note(damper, damper.label(index), bed, acceleration)
    return fills, notes


def _loads(case: Case) -> tuple[list[_core.Load], Array]:
    """Return the loads and accelerations of the base, and the direction of each acceleration; zero for a load."""
    loads = [
        _core.Load(
            signal=pack_signal(signal),
            shape=_array(case.modes.shape(signal.point, signal.direction)),
            base=False,
        )
        for signal in case.loads
    ]
    directions = [np.zeros(3) for _ in loads]
    for signal, acceleration in zip((*case.base, *case.shaker_motion), case.base_acceleration(), strict=True):
        direction = direction_of_base(case.particle_dampers, signal)
        shape = _array(-inertia_along(case.modes, case.particle_dampers, direction))
        loads.append(_core.Load(signal=pack_signal(acceleration), shape=shape, base=True))
        directions.append(direction)
    return loads, _array(directions).reshape(-1, 3)


def _without_particles(case: Case) -> Array:
    """Return modal displacements and velocities of the structure without particles, (T, m, 2) at `evaluation_times`."""
    if not case.modes.decay.size:
        return np.zeros((0, 0, 2))
    alone = case.model_copy(
        update={"dampers": (), "base": (), "loads": (), "method": EventDriven(), "output": Output()}
    )
    (raw,) = _core.simulate(
        [pack(alone).replace(loads=_loads(case)[0], sample_times=_array(evaluation_times(case)))], 1
    )
    return raw.state.reshape(raw.time.size, -1, 2)


def _cavity(
    case: Case, damper: ParticleDamper, shape: Array, table: ContactTable, first: int, position: Array
) -> _core.Cavity:
    """Pack a cavity and its particles; `first` is the index of its first pair law in the list of the problem."""
    contents, start, walls = damper.contents, damper.start, damper.interior.walls()
    velocity = start.velocity
    if (turning := damper.rotation) is not None:
        # Particles start relative to the cavity, which turns about an axis that the structure may have displaced.
        velocity = velocity + turning.lever_velocity(_displacement(case, damper, shape), float(turning.at(0.0).speed))
    return _core.Cavity(
        shape=_array(shape),
        walls=pack_walls(walls, table.wall_kind),
        solids=pack_solids(walls, table.wall_kind),
        period=damper.interior.period,
        position=position,
        velocity=_array(velocity),
        spin=_array(start.spin),
        radius=_array(contents.radius),
        mass=_array(contents.mass),
        inertia=_array(contents.inertia),
        species=np.asarray(contents.species, dtype=np.int64),
        particle_pair=np.asarray(table.particle_entry + first, dtype=np.int64),
        wall_pair=np.asarray(table.wall_entry + first, dtype=np.int64),
        rotation=_rotation(damper.rotation),
    )


def _pair_laws(damper: ParticleDamper, entry: Entry) -> _core.PairLaws:
    return _core.PairLaws(
        normal=pack_normal(damper, entry),
        restitution=pack_restitution(entry.contact.impact_restitution, entry.pair),
        tangential=pack_friction(damper, entry),
        rolling=_core.RollingResistance(**damper.rolling_of(entry).coefficients()),
        radius=float(entry.pair.radius),
        mass=float(entry.pair.mass),
    )
