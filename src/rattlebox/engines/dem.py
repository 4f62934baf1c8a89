"""Particle dampers: Case -> the plain numbers that the core reads -> core -> Run."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.atomic_io import check_suffix
from rattlebox._util.exceptions import DataError, RattleboxError
from rattlebox._util.narrow import instance
from rattlebox.engines import _core
from rattlebox.engines._core import Partner, Status
from rattlebox.engines.base_motion import base_motion
from rattlebox.engines.checkpoint import Checkpoint
from rattlebox.engines.dem_follow import Journey
from rattlebox.engines.dem_settle import packed_walls, settle
from rattlebox.engines.dem_snapshots import snapshots_of
from rattlebox.engines.dem_step import (
    Step,
    choose_step,
    expected_speeds,
    instants,
    largest_softening,
    outcome,
    packed_friction,
    packed_normal,
)
from rattlebox.engines.laws import packed_restitution
from rattlebox.engines.pack import mode_coupling, pack, packed_signal
from rattlebox.engines.responses import responses
from rattlebox.engines.run_notes import extrapolated, particle_notes, table_notes
from rattlebox.engines.softening import ENDURING, choose_softening, effects, shaking
from rattlebox.engines.status import describe, end_of
from rattlebox.model.doubts import doubts
from rattlebox.model.errors import at
from rattlebox.model.in_space import direction_of_base, inertia_along
from rattlebox.model.methods import Dem, EventDriven, Output
from rattlebox.model.packing import Settled
from rattlebox.results.arrays import RunArrays
from rattlebox.results.ledger import Ledger
from rattlebox.results.provenance import Provenance
from rattlebox.results.run import Run

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.case import Case
    from rattlebox.model.particle_damper import ContactTable, Entry, ParticleDamper

    Array = NDArray[np.float64]

Progress = Callable[[int, int], object]

PARTICLES_EACH = 1000
"""Of a thread, at least: with fewer they wait for each other."""


def simulate_dem(
    case: Case,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
    checkpoint: Path | None = None,
    snapshots: Path | None = None,
) -> Run:
    """Run a case with particle dampers.

    Parameters
    ----------
    case
        What to run.
    threads
        How many at once; default those of the method, or as many as there are cores and work for them.
    progress
        Called now and then with the number of steps done and of all; False stops the run, as Ctrl-C does.
    checkpoint
        File in which the state is kept, and from which the run goes on if it is there.
    snapshots
        File to which snapshots are written.

    Returns
    -------
    Run
        Its status is the reason why it ended.

    Raises
    ------
    CaseError
        When the step that is given is too long, particles do not settle, the checkpoint is of another run, or in use, or
        a file is a folder, or both are one.
    OSError
        When a file cannot be written.
    """
    _check_files(checkpoint, snapshots)
    if case.output.snapshots == ():
        snapshots = None
    if checkpoint is None:
        return _simulated(case, threads, progress, None, snapshots)
    file = Checkpoint(checkpoint, case)
    with file.held():
        return _simulated(case, threads, progress, file, snapshots)


def _check_files(checkpoint: Path | None, snapshots: Path | None) -> None:
    """Refuse files that cannot be written side by side."""
    if checkpoint is not None and checkpoint.is_dir():
        raise DataError(f"{checkpoint} is a folder; a run is kept in a file\n  try: {checkpoint / 'run.checkpoint'}")
    if snapshots is not None and snapshots.is_dir():
        raise DataError(f"{snapshots} is a folder; snapshots are written to a file\n  try: another name or place")
    if snapshots is not None:
        check_suffix(snapshots, ".vtkhdf")
    if checkpoint is not None and snapshots is not None and checkpoint.resolve() == snapshots.resolve():
        raise DataError(f"{checkpoint} cannot hold both a run and its snapshots\n  try: run.checkpoint and run.vtkhdf")


def _simulated(
    case: Case,
    threads: int | None,
    progress: Progress | None,
    file: Checkpoint | None,
    snapshots: Path | None,
) -> Run:
    method = instance(case.method, Dem)
    kept = None if file is None else file.read()
    packed, step, tables = pack_dem(case, None if kept is None else kept.positions)
    dem = _core.Dem(packed)
    dem.threads = threads or method.threads or useful_threads(packed)
    journey = Journey(dem, packed, file, method)
    if file is not None and kept is not None:
        file.check(kept, packed)
        journey.resume(kept)
    if snapshots is not None:
        journey.watch(*snapshots_of(case, packed, snapshots))
    status = journey.go(progress)
    return _run(case, packed, dem, status, step, tables, journey)


def settled(case: Case, go_on: Callable[[], bool]) -> bool:
    """Let all particles of a case settle that are to.

    Parameters
    ----------
    case
        What is to be run.
    go_on
        Asked now and then; False stops.

    Returns
    -------
    bool
        Whether they did before it was stopped. The engine remembers the beds.

    Raises
    ------
    CaseError
        When particles cannot be inserted, or do not come to rest.
    """
    return all(
        not isinstance(damper.packing, Settled) or settle(damper, go_on) is not None for damper in case.particle_dampers
    )


def objection(case: Case) -> str:
    """Return why a case is refused before its first step; nothing where it can be run."""
    try:
        settled(case, lambda: True)
        pack_dem(case)
    except RattleboxError as error:
        return str(error)
    return ""


def useful_threads(packed: _core.DemProblem) -> int:
    """Return how many threads have enough to do, at most as many as there are cores."""
    particles = sum(cavity.radius.size for cavity in packed.cavities)
    return max(1, min(os.cpu_count() or 1, particles // PARTICLES_EACH))


# ---- packing


def pack_dem(case: Case, starts: Sequence[Array] | None = None) -> tuple[_core.DemProblem, Step, list[ContactTable]]:
    """Pack a case with particle dampers for the core.

    Parameters
    ----------
    case
        What the user describes.
    starts
        Where particles that settle start, as packed before for each damper, (n, 3) [m]; default they are let fall.

    Returns
    -------
    DemProblem
        Modes, loads, cavities with their particles, and the laws of pairs.
    Step
        The time step, and what limits it.
    list of ContactTable
        Pairs in each damper.

    Raises
    ------
    CaseError
        When the step that is given is too long, or particles do not settle.
    """
    case, _ = resolved(case)
    modes = case.modes
    shapes = [modes.space_shape(damper.point, damper.direction) for damper in case.particle_dampers]
    tables = [damper.contact_table for damper in case.particle_dampers]
    loads, directions = _loads(case)
    state = _without_particles(case, loads)
    speeds = expected_speeds(case, [state[..., 1] @ shape for shape in shapes])
    with at("method", "dt"):
        step = choose_step(case, tables, speeds)
    step = replace(step, motions=tuple(shaking(case, shape, state) for shape in shapes))
    slowest = min((motion.main for motion in step.motions if motion.main), default=0.0)
    pairs: list[_core.PairLaws] = []
    cavities = []
    for index, (damper, shape, table) in enumerate(zip(case.particle_dampers, shapes, tables, strict=True)):
        with at(*(("dampers", index) if len(shapes) > 1 else ("damper",))):
            start = None if starts is None else starts[index]
            cavities.append(_cavity(damper, shape, modes.q0 @ shape, table, len(pairs), start))
        pairs += [_pair_laws(damper, entry) for entry in table.entries]
    packed = _core.DemProblem(
        dt=step.dt,
        enduring=ENDURING / slowest if slowest else math.inf,
        steps=step.count,
        every=step.every,
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
    return packed, step, tables


def resolved(case: Case) -> tuple[Case, tuple[str, ...]]:
    """Return a case with a number for each softening that is "auto", and notes on these numbers."""
    dampers = case.particle_dampers
    if all(damper.softening != "auto" for damper in dampers):
        return case, ()
    shapes = [case.modes.space_shape(damper.point, damper.direction) for damper in dampers]
    state = _without_particles(case, _loads(case)[0])
    speeds = expected_speeds(case, [state[..., 1] @ shape for shape in shapes])
    made: list[Any] = list(case.dampers)
    notes = []
    for index, (damper, shape, speed) in enumerate(zip(dampers, shapes, speeds, strict=True)):
        if damper.softening == "auto":
            choice = choose_softening(damper, shaking(case, shape, state), largest_softening(case, damper, speed))
            place = next(k for k, each in enumerate(made) if each is damper)
            made[place] = damper.model_copy(update={"softening": choice.softening})
            notes.append((f"{damper.label(index)}: " if len(dampers) > 1 else "") + choice.note)
    return case.model_copy(update={"dampers": tuple(made)}), tuple(notes)


def _array(values: Any) -> Array:
    return np.ascontiguousarray(values, dtype=np.float64)


def _loads(case: Case) -> tuple[list[_core.Load], Array]:
    """Loads and accelerations of the base, and the direction of each, zero for a load."""
    loads = [
        _core.Load(
            signal=packed_signal(signal),
            shape=_array(case.modes.shape(signal.point, signal.direction)),
            base=False,
        )
        for signal in case.loads
    ]
    directions = [np.zeros(3) for _ in loads]
    for signal, acceleration in zip((*case.base, *case.shaker_motion), case.base_acceleration(), strict=True):
        direction = direction_of_base(case, signal)
        shape = _array(-inertia_along(case, direction))
        loads.append(_core.Load(signal=packed_signal(acceleration), shape=shape, base=True))
        directions.append(direction)
    return loads, _array(directions).reshape(-1, 3)


def _without_particles(case: Case, loads: list[_core.Load]) -> Array:
    """Modal displacements and velocities of the structure alone at the instants, (T, m, 2)."""
    if not case.modes.decay.size:
        return np.zeros((0, 0, 2))
    alone = case.model_copy(
        update={"dampers": (), "base": (), "loads": (), "method": EventDriven(), "output": Output()}
    )
    (raw,) = _core.simulate([pack(alone).replace(loads=loads, sample_times=_array(instants(case)))], 1)
    return raw.state.reshape(raw.time.size, -1, 2)


def _cavity(
    damper: ParticleDamper, shape: Array, displacement: Array, table: ContactTable, first: int, settled: Array | None
) -> _core.Cavity:
    """A cavity and its particles; the laws of its pairs begin at a number in the list of all."""
    contents, start = damper.contents, damper.start
    position = start.position + displacement
    if isinstance(damper.packing, Settled):
        with at("packing"):
            position = settle(damper) + displacement if settled is None else settled
    return _core.Cavity(
        shape=_array(shape),
        walls=packed_walls(damper.cavity.walls(), table.wall_kind),
        position=_array(position),
        velocity=_array(start.velocity),
        spin=_array(start.spin),
        radius=_array(contents.radius),
        mass=_array(contents.mass),
        inertia=_array(contents.inertia),
        species=np.asarray(contents.species, dtype=np.int64),
        particle_pair=np.asarray(table.particle_entry + first, dtype=np.int64),
        wall_pair=np.asarray(table.wall_entry + first, dtype=np.int64),
    )


def _pair_laws(damper: ParticleDamper, entry: Entry) -> _core.PairLaws:
    return _core.PairLaws(
        normal=packed_normal(damper, entry),
        restitution=packed_restitution(entry.contact.impact_restitution, entry.pair),
        tangential=packed_friction(damper, entry),
        rolling=_core.RollingResistance(**damper.rolling_of(entry).coefficients()),
        radius=float(entry.pair.radius),
        mass=float(entry.pair.mass),
    )


# ---- results


def _run(
    case: Case,
    packed: _core.DemProblem,
    dem: _core.Dem,
    status: Status,
    step: Step,
    tables: list[ContactTable],
    journey: Journey,
) -> Run:
    resolved_case, chosen = resolved(case)
    raw, totals = journey.records(), dem.counts()
    arrays = _arrays(resolved_case, packed, raw, dem)
    overlaps, speeds = totals.largest_overlap.tolist(), totals.largest_approach_speed.tolist()
    losses = (raw.normal_loss, raw.plastic_loss, raw.sliding_loss, raw.rolling_loss)
    lost = sum((loss[-1].sum(axis=1) for loss in losses), np.zeros(len(arrays.dampers)))
    moves = arrays.base_velocity[:, None] + arrays.cavity_velocity
    softened = effects(resolved_case, step.motions, moves, lost, totals.enduring_loss)
    diagnostics, notes = outcome(resolved_case, tables, step, overlaps, speeds, softened)
    touches = totals.first_touches
    name, message = _ended(resolved_case, arrays, dem, status, step, journey.checkpoint)
    return Run(
        arrays,
        case,
        Provenance.now(method=case.method.kind, seed=case.seed),
        status=name,
        message=message,
        notes=(
            *notes,
            *chosen,
            *doubts(resolved_case),
            *(
                particle_notes(resolved_case, touches, arrays.contacts, arrays.centre_of_mass, overlaps)
                if status == Status.finished
                else ()
            ),
            *table_notes(resolved_case, speeds),
            *extrapolated(totals.extrapolated),
        ),
        counts={
            "steps": totals.steps,
            "rebuilds": totals.rebuilds,
            "refreshes": totals.refreshes,
            "first_touches_particle": int(touches[:, Partner.particle].sum()),
            "first_touches_wall": int(touches[:, Partner.wall].sum()),
            "extrapolated": totals.extrapolated,
            "memory_bytes": totals.memory_bytes,
        },
        diagnostics=diagnostics,
        wall_time=journey.seconds,
    )


def _arrays(case: Case, packed: _core.DemProblem, raw: _core.Records, dem: _core.Dem) -> RunArrays:
    modes, dampers = case.modes, case.particle_dampers
    times, q, p = raw.time, raw.q, raw.p
    lines = modes.lines()
    at_points = np.array(list(lines.values())).reshape(len(lines), modes.decay.size)
    shapes = [cavity.shape for cavity in packed.cavities]
    displacement = np.stack([q @ shape for shape in shapes], axis=1)
    base = np.zeros((3, times.size, 3))
    for signal, acceleration in zip((*case.base, *case.shaker_motion), case.base_acceleration(), strict=True):
        base += np.multiply.outer(base_motion(acceleration, times), direction_of_base(case, signal))
    load = np.array([signal.evaluate(times) for signal in case.loads]).reshape(len(case.loads), times.size).T
    ends = dem.state().cavities
    contents = [damper.contents for damper in dampers]
    return RunArrays(
        engine="dem",
        time=times,
        points=tuple(lines),
        dampers=tuple(damper.label(index) for index, damper in enumerate(dampers)),
        loads=tuple(f"{signal.kind} {index + 1}" for index, signal in enumerate(case.loads)),
        displacement=q @ at_points.T,
        velocity=p @ at_points.T,
        cavity_displacement=displacement,
        cavity_velocity=np.stack([p @ shape for shape in shapes], axis=1),
        cavity_force=raw.force,
        cavity_moment=raw.moment,
        centre_of_mass=raw.centre - displacement,
        momentum=raw.momentum,
        contacts=raw.contacts,
        base_displacement=base[0],
        base_velocity=base[1],
        base_acceleration=base[2],
        load=load,
        **responses(case, q, p, load, base[2], raw.force, shapes),
        particle_mass=np.array([each.mass.sum() for each in contents]),
        mode_frequency=np.sqrt(modes.stiffness) / (2 * np.pi),
        mode_energy=0.5 * (p**2 + modes.stiffness * q**2),
        kinetic_energy=raw.kinetic,
        rotation_energy=raw.rotation,
        contact_energy=raw.elastic,
        gravity_energy=raw.potential,
        load_work=raw.load_work.sum(axis=1),
        base_work=raw.base_work.sum(axis=1),
        viscous_loss=raw.viscous_loss.sum(axis=1),
        normal_loss=raw.normal_loss,
        plastic_loss=raw.plastic_loss,
        sliding_loss=raw.sliding_loss,
        rolling_loss=raw.rolling_loss,
        particles={
            "position": np.concatenate([end.position - end.displacement for end in ends]),
            "velocity": np.concatenate([end.velocity for end in ends]),
            "spin": np.concatenate([end.spin for end in ends]),
            "radius": np.concatenate([each.radius for each in contents]),
            "mass": np.concatenate([each.mass for each in contents]),
            "damper": np.repeat(np.arange(len(dampers)), [each.radius.size for each in contents]),
            "species": np.concatenate([each.species for each in contents]),
        },
    )


def _ended(
    case: Case, arrays: RunArrays, dem: _core.Dem, status: Status, step: Step, checkpoint: Checkpoint | None
) -> tuple[str, str]:
    """Return the status and the message of a run."""
    if status == Status.finished:
        ledger = Ledger(arrays)
        end = end_of(ledger, _core.worst_closure, arrays.particle_mass.sum())
        return describe(end, case.duration, "", ledger.energy_residual if end else 0.0, case.method.kind)
    stopped = dem.stopped()
    cavity = stopped.cavity
    number = stopped.particle + sum(damper.contents.radius.size for damper in case.particle_dampers[:cavity])
    where = f"Particle {number}, in {arrays.dampers[cavity]!r},"
    softened = case.particle_dampers[cavity].softening_factor > 1
    name, message = describe(status, stopped.time, where, stopped.speed, case.method.kind, softened=softened)
    if status == Status.interrupted:
        return name, message if checkpoint is None else f"{message} Run again, it goes on from {checkpoint.path}."
    message += f" The step was {step.dt:.4g} s."
    if checkpoint is not None and checkpoint.time is not None:
        message += f" The last checkpoint is of t = {checkpoint.time:.6g} s, in {checkpoint.path.name}."
    return name, message
