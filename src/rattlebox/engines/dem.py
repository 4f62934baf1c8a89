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
from rattlebox.engines.base_motion import base_motion
from rattlebox.engines.checkpoint import Checkpoint
from rattlebox.engines.core import core
from rattlebox.engines.dem_follow import Journey
from rattlebox.engines.dem_settle import settle
from rattlebox.engines.dem_snapshots import snapshots_of
from rattlebox.engines.dem_step import (
    Step,
    choose_step,
    expected_speeds,
    instants,
    largest_softening,
    outcome,
    packed_normal,
)
from rattlebox.engines.pack import pack, restitution
from rattlebox.engines.responses import responses
from rattlebox.engines.run_notes import extrapolated, particle_notes, table_notes
from rattlebox.engines.softening import ENDURING, choose_softening, effects, shaking
from rattlebox.engines.status import FINISHED, INTERRUPTED, describe, end_of
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

Packed = dict[str, Any]
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
    dem = core().Dem(packed)
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


def useful_threads(packed: Packed) -> int:
    """Return how many threads have enough to do, at most as many as there are cores."""
    particles: int = sum(cavity["radius"].size for cavity in packed["cavities"])
    return max(1, min(os.cpu_count() or 1, particles // PARTICLES_EACH))


# ---- packing


def pack_dem(case: Case, starts: Sequence[Array] | None = None) -> tuple[Packed, Step, list[ContactTable]]:
    """Pack a case with particle dampers for the core.

    Parameters
    ----------
    case
        What the user describes.
    starts
        Where particles that settle start, as packed before for each damper, (n, 3) [m]; default they are let fall.

    Returns
    -------
    dict
        Modes, loads, cavities with their particles, and contacts, as core/python/dem.hpp reads them.
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
    loads = _loads(case)
    state = _without_particles(case, loads)
    speeds = expected_speeds(case, [state[..., 1] @ shape for shape in shapes])
    with at("method", "dt"):
        step = choose_step(case, tables, speeds)
    step = replace(step, motions=tuple(shaking(case, shape, state) for shape in shapes))
    slowest = min((motion.main for motion in step.motions if motion.main), default=0.0)
    contacts: list[Packed] = []
    cavities = []
    for index, (damper, shape, table) in enumerate(zip(case.particle_dampers, shapes, tables, strict=True)):
        with at(*(("dampers", index) if len(shapes) > 1 else ("damper",))):
            start = None if starts is None else starts[index]
            cavities.append(_cavity(damper, shape, modes.q0 @ shape, table, len(contacts), start))
        contacts += [_contact(damper, entry) for entry in table.entries]
    packed = {
        "dt": step.dt,
        "enduring": ENDURING / slowest if slowest else math.inf,
        "steps": step.count,
        "every": step.every,
        "gravity": np.array(case.particle_dampers[0].gravity),
        "mode_decay": _array(modes.decay),
        "mode_stiffness": _array(modes.stiffness),
        **({} if modes.coupling is None else {"mode_coupling": _array(modes.coupling.ravel())}),
        "mode_displacement": _array(modes.q0),
        "mode_velocity": _array(modes.p0),
        "loads": loads,
        "cavities": cavities,
        "contacts": contacts,
    }
    return packed, step, tables


def resolved(case: Case) -> tuple[Case, tuple[str, ...]]:
    """Return a case with a number for each softening that is "auto", and notes on these numbers."""
    dampers = case.particle_dampers
    if all(damper.softening != "auto" for damper in dampers):
        return case, ()
    shapes = [case.modes.space_shape(damper.point, damper.direction) for damper in dampers]
    state = _without_particles(case, _loads(case))
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


def _loads(case: Case) -> list[Packed]:
    loads = [
        {
            **signal.coefficients(),
            "shape": _array(case.modes.shape(signal.point, signal.direction)),
            "base": False,
            "direction": np.zeros(3),
        }
        for signal in case.loads
    ]
    for signal, acceleration in zip((*case.base, *case.shaker_motion), case.base_acceleration(), strict=True):
        direction = direction_of_base(case, signal)
        shape = _array(-inertia_along(case, direction))
        loads.append({**acceleration.coefficients(), "shape": shape, "base": True, "direction": direction})
    return loads


def _without_particles(case: Case, loads: list[Packed]) -> Array:
    """Modal displacements and velocities of the structure alone at the instants, (T, m, 2)."""
    if not case.modes.decay.size:
        return np.zeros((0, 0, 2))
    alone = case.model_copy(
        update={"dampers": (), "base": (), "loads": (), "method": EventDriven(), "output": Output()}
    )
    plain = [{key: value for key, value in load.items() if key != "direction"} for load in loads]
    (raw,) = core().simulate([{**pack(alone), "loads": plain, "sample_times": _array(instants(case))}], 1)
    return _array(raw["state"].reshape(raw["time"].size, -1, 2))


def _cavity(
    damper: ParticleDamper, shape: Array, displacement: Array, table: ContactTable, first: int, settled: Array | None
) -> Packed:
    """A cavity and what is in it; its entries begin at a number in the list of contacts."""
    walls, contents, start = damper.cavity.walls(), damper.contents, damper.start
    position = start.position + displacement
    if isinstance(damper.packing, Settled):
        with at("packing"):
            position = settle(damper) + displacement if settled is None else settled
    return {
        "shape": _array(shape),
        "wall_axis": _array(walls.axis),
        "wall_offset": _array(walls.offset),
        "wall_curved": _array(walls.curved),
        "wall_kind": np.ascontiguousarray(table.wall_kind, dtype=np.int64),
        "position": _array(position),
        "velocity": _array(start.velocity),
        "spin": _array(start.spin),
        "radius": _array(contents.radius),
        "mass": _array(contents.mass),
        "inertia": _array(contents.inertia),
        "kind": np.ascontiguousarray(contents.species, dtype=np.int64),
        "particle_entry": np.ascontiguousarray(table.particle_entry + first, dtype=np.int64),
        "wall_entry": np.ascontiguousarray(table.wall_entry + first, dtype=np.int64),
    }


def _contact(damper: ParticleDamper, entry: Entry) -> Packed:
    friction, rolling = damper.softened_friction(entry)
    return {
        "normal": packed_normal(damper, entry),
        "restitution": restitution(entry.contact.impact_restitution, entry.pair),
        "tangential": friction,
        "rolling": rolling,
        "radius": float(entry.pair.radius),
        "mass": float(entry.pair.mass),
    }


# ---- results


def _run(
    case: Case, packed: Packed, dem: Any, status: int, step: Step, tables: list[ContactTable], journey: Journey
) -> Run:
    resolved_case, chosen = resolved(case)
    raw, counters = journey.records(), dem.counters()
    arrays = _arrays(resolved_case, packed, raw, dem)
    overlaps, speeds = (counters[name].tolist() for name in ("largest_overlap", "largest_approach_speed"))
    lost = sum(raw[f"{channel}_loss"][-1].sum(axis=1) for channel in ("normal", "plastic", "sliding", "rolling"))
    moves = arrays.base_velocity[:, None] + arrays.cavity_velocity
    softened = effects(resolved_case, step.motions, moves, lost, counters["enduring_loss"])
    diagnostics, notes = outcome(resolved_case, tables, step, overlaps, speeds, softened)
    touches = np.asarray(counters["first_touches"])
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
                if status == FINISHED
                else ()
            ),
            *table_notes(resolved_case, speeds),
            *extrapolated(counters["extrapolated"]),
        ),
        counts={
            "steps": counters["steps"],
            "rebuilds": counters["rebuilds"],
            "refreshes": counters["refreshes"],
            "first_touches_particle": int(touches[:, 0].sum()),
            "first_touches_wall": int(touches[:, 1].sum()),
            "extrapolated": counters["extrapolated"],
            "memory_bytes": counters["memory_bytes"],
        },
        diagnostics=diagnostics,
        wall_time=journey.seconds,
    )


def _arrays(case: Case, packed: Packed, raw: dict[str, Any], dem: Any) -> RunArrays:
    modes, dampers = case.modes, case.particle_dampers
    times, q, p = raw["time"], raw["q"], raw["p"]
    lines = modes.lines()
    at_points = np.array(list(lines.values())).reshape(len(lines), modes.decay.size)
    shapes = [cavity["shape"] for cavity in packed["cavities"]]
    displacement = np.stack([q @ shape for shape in shapes], axis=1)
    base = np.zeros((3, times.size, 3))
    for signal, acceleration in zip((*case.base, *case.shaker_motion), case.base_acceleration(), strict=True):
        base += np.multiply.outer(base_motion(acceleration, times), direction_of_base(case, signal))
    load = np.array([signal.evaluate(times) for signal in case.loads]).reshape(len(case.loads), times.size).T
    ends = dem.state()["cavities"]
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
        cavity_force=raw["force"],
        cavity_moment=raw["moment"],
        centre_of_mass=raw["centre"] - displacement,
        momentum=raw["momentum"],
        contacts=raw["contacts"],
        base_displacement=base[0],
        base_velocity=base[1],
        base_acceleration=base[2],
        load=load,
        **responses(case, q, p, load, base[2], raw["force"], shapes),
        particle_mass=np.array([each.mass.sum() for each in contents]),
        mode_frequency=np.sqrt(modes.stiffness) / (2 * np.pi),
        mode_energy=0.5 * (p**2 + modes.stiffness * q**2),
        kinetic_energy=raw["kinetic"],
        rotation_energy=raw["rotation"],
        contact_energy=raw["elastic"],
        gravity_energy=raw["potential"],
        load_work=raw["load_work"].sum(axis=1),
        base_work=raw["base_work"].sum(axis=1),
        viscous_loss=raw["viscous_loss"].sum(axis=1),
        normal_loss=raw["normal_loss"],
        plastic_loss=raw["plastic_loss"],
        sliding_loss=raw["sliding_loss"],
        rolling_loss=raw["rolling_loss"],
        particles={
            "position": np.concatenate([end["position"] - end["displacement"] for end in ends]),
            "velocity": np.concatenate([end["velocity"] for end in ends]),
            "spin": np.concatenate([end["spin"] for end in ends]),
            "radius": np.concatenate([each.radius for each in contents]),
            "mass": np.concatenate([each.mass for each in contents]),
            "damper": np.repeat(np.arange(len(dampers)), [each.radius.size for each in contents]),
            "species": np.concatenate([each.species for each in contents]),
        },
    )


def _ended(
    case: Case, arrays: RunArrays, dem: Any, status: int, step: Step, checkpoint: Checkpoint | None
) -> tuple[str, str]:
    """Return the status and the message of a run."""
    if status == FINISHED:
        ledger = Ledger(arrays)
        end = end_of(ledger, core().worst_closure, arrays.particle_mass.sum())
        return describe(end, case.duration, "", ledger.energy_residual if end else 0.0, case.method.kind)
    stopped = dem.stopped()
    cavity = stopped["cavity"]
    number = stopped["particle"] + sum(damper.contents.radius.size for damper in case.particle_dampers[:cavity])
    where = f"Particle {number}, in {arrays.dampers[cavity]!r},"
    softened = case.particle_dampers[cavity].softening_factor > 1
    name, message = describe(status, stopped["time"], where, stopped["speed"], case.method.kind, softened=softened)
    if status == INTERRUPTED:
        return name, message if checkpoint is None else f"{message} Run again, it goes on from {checkpoint.path}."
    message += f" The step was {step.dt:.4g} s."
    if checkpoint is not None and checkpoint.time is not None:
        message += f" The last checkpoint is of t = {checkpoint.time:.6g} s, in {checkpoint.path.name}."
    return name, message
