"""The dem engine: prepare and run a case with particle dampers in the core, and return a Run."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rattlebox._util.atomic_io import check_suffix
from rattlebox._util.exceptions import DataError
from rattlebox._util.narrow import instance
from rattlebox.core import _core
from rattlebox.core._core import Partner, Status
from rattlebox.engines.checkpoint import Checkpoint
from rattlebox.engines.dem_continued import end_of, pack_continued
from rattlebox.engines.dem_run import DemRun
from rattlebox.engines.dem_snapshots import plan_snapshots
from rattlebox.engines.end_state import LOSSES, WALL_SUMS, EndState, sums_from_zero
from rattlebox.engines.responses import structure_arrays
from rattlebox.engines.run_notes import extrapolation_notes, particle_notes, table_notes
from rattlebox.engines.status import describe, final_status
from rattlebox.model.methods import Dem
from rattlebox.model.particle_case import direction_of_base
from rattlebox.model.plausibility import plausibility_notes
from rattlebox.model.space import unit_vector
from rattlebox.prepare.particles import Prepared, pack_particles, prepare
from rattlebox.prepare.softening import effects
from rattlebox.prepare.time_step import Step, step_diagnostics
from rattlebox.results.arrays import RunArrays
from rattlebox.results.ledger import Ledger
from rattlebox.results.provenance import Provenance
from rattlebox.results.run import Run
from rattlebox.results.schema import PARTNERS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.case import Case
    from rattlebox.model.particle_damper import ParticleDamper
    from rattlebox.results.run_end import RunEnd

    Array = NDArray[np.float64]

Progress = Callable[[int, int], object]

PARTICLES_PER_THREAD = 1000
"""Smallest number of particles per thread: with fewer, synchronisation takes longer than the work."""


def simulate_dem(
    case: Case,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
    checkpoint: Path | None = None,
    snapshots: Path | None = None,
    keeps_end: bool = False,
) -> Run:
    """Run a case with particle dampers."""
    _check_files(checkpoint, snapshots)
    if case.output.snapshots == ():
        snapshots = None
    if checkpoint is None:
        return _simulate(case, threads, progress, None, snapshots, keeps_end=keeps_end)
    file = Checkpoint(checkpoint, case)
    with file.lock():
        return _simulate(case, threads, progress, file, snapshots, keeps_end=keeps_end)


def simulate_from(
    case: Case, before: Case, end: RunEnd, origin: str, progress: Progress | None = None, threads: int | None = None
) -> Run:
    """Run a case from the end of a run of the case `before`; `origin` names that run."""
    prepared, packed, state, is_same = pack_continued(case, before, end)
    active = _begin(case, packed, threads)
    active.continue_from(state, end.time, is_same=is_same)
    status = active.run(progress)
    return _result(case, prepared, active, status, origin=origin, keeps_end=True)


def repeat_until(case: Case, time: float, progress: Progress | None = None) -> Run:
    """Run a case up to the step that is next to a time [s], with the time step of the whole run."""
    prepared = prepare(case)
    packed = pack_particles(prepared)
    active = _begin(case, packed.replace(steps=max(1, round(time / packed.dt))), None)
    status = active.run(progress)
    return _result(case, prepared, active, status, keeps_end=True)


def continue_dem(
    case: Case, before: EndState | None, *, threads: int | None = None, progress: Progress | None = None
) -> tuple[Run, EndState]:
    """Run a case with particle dampers from the end of another run.

    Particles, contacts with their history and the structure continue, and so does a harmonic load if the run before lasted
    whole cycles. Time, work and losses count from the beginning.
    """
    prepared = prepare(case, None if before is None else before.positions)
    active = _begin(case, pack_particles(prepared), threads)
    if before is not None:
        active.continue_from(before, 0.0)
    status = active.run(progress)
    return _result(case, prepared, active, status), active.end()


class PausedRun(NamedTuple):
    """A particle run that has reached a sample: the state there, and the samples so far."""

    state: EndState
    records: dict[str, NDArray[Any]]
    seconds: float  # Computing time so far [s]

    @property
    def memory(self) -> int:
        """Size [bytes]."""
        return self.state.state.nbytes + sum(array.nbytes for array in (*self.state.positions, *self.records.values()))


def run_part(
    case: Case,
    share: float,
    before: PausedRun | None,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
) -> tuple[Run, PausedRun]:
    """Run a case up to a share of its duration, where a sample is taken, from where an earlier part paused.

    The run includes all parts so far. It has the bits of a run in one go, whose time step it has.
    """
    prepared = prepare(case, None if before is None else before.state.positions)
    active = _begin(case, pack_particles(prepared), threads)
    if before is not None:
        active.resume(before.state.state, _core.Records(**before.records), before.seconds)
    status = active.run(progress, round(share * active.packed.steps))
    records = active.records()
    samples = {name: getattr(records, name) for name in records.fields()}
    return _result(case, prepared, active, status), PausedRun(active.end(), samples, active.seconds)


def _begin(case: Case, packed: _core.DemProblem, threads: int | None, file: Checkpoint | None = None) -> DemRun:
    """Return a run before its first step."""
    method = instance(case.method, Dem)
    dem = _core.Dem(packed)
    dem.threads = threads or method.threads or default_threads(packed)
    return DemRun(dem, packed, file, method)


def _check_files(checkpoint: Path | None, snapshots: Path | None) -> None:
    """Raise if a file cannot be written, or both are the same."""
    for file, kind, name in ((checkpoint, "a checkpoint", "run.checkpoint"), (snapshots, "snapshots", "run.vtkhdf")):
        if file is not None and file.is_dir():
            raise DataError(f"{file} is a folder; {kind} must be a file", str(file / name))
    if snapshots is not None:
        check_suffix(snapshots, ".vtkhdf")
    if checkpoint is not None and snapshots is not None and checkpoint.resolve() == snapshots.resolve():
        raise DataError(
            f"{checkpoint} is both the checkpoint and the snapshots; they must be two files",
            "run.checkpoint and run.vtkhdf",
        )


def _simulate(
    case: Case,
    threads: int | None,
    progress: Progress | None,
    file: Checkpoint | None,
    snapshots: Path | None,
    *,
    keeps_end: bool,
) -> Run:
    data = None if file is None else file.read()
    prepared = prepare(case, None if data is None else data.positions)
    packed = pack_particles(prepared)
    active = _begin(case, packed, threads, file)
    if file is not None and data is not None:
        file.check(data, packed)
        active.resume_from(data)
    if snapshots is not None:
        active.add_snapshots(*plan_snapshots(case, packed, snapshots))
    status = active.run(progress)
    return _result(case, prepared, active, status, keeps_end=keeps_end)


def default_threads(packed: _core.DemProblem) -> int:
    """Return the number of threads with at least `PARTICLES_PER_THREAD` particles each, at most one per core."""
    particles = sum(cavity.radius.size for cavity in packed.cavities)
    return max(1, min(os.cpu_count() or 1, particles // PARTICLES_PER_THREAD))


def _result(
    case: Case,
    prepared: Prepared,
    active: DemRun,
    status: Status,
    *,
    origin: str = "",
    keeps_end: bool = False,
) -> Run:
    resolved_case, step = prepared.case, prepared.step
    dem, packed = active.dem, active.packed
    records, totals = active.records(), dem.counts()
    raw = sums_from_zero(records) if active.is_continued else records
    arrays = _arrays(resolved_case, packed, raw, dem)
    # What is known only now, at the end: how deep and fast contacts were, and how much softening changed the loss.
    overlaps, speeds = totals.largest_overlap.tolist(), totals.largest_approach_speed.tolist()
    lost = sum((getattr(raw, name)[-1].sum(axis=1) for name in LOSSES), np.zeros(len(arrays.dampers)))
    moves = arrays.base_velocity[:, None] + arrays.cavity_velocity
    rolled = raw.rolling_loss[-1].sum(axis=1)
    speeds_inside = _relative_speeds(arrays)
    softened = effects(resolved_case, step.motions, moves, lost, totals.enduring_loss, rolled, speeds_inside)
    diagnostics, notes = step_diagnostics(resolved_case, prepared.tables, step, overlaps, speeds, softened)
    touches = totals.first_touches
    name, message = _status_and_message(resolved_case, arrays, dem, status, step, active.checkpoint)
    notes = [*notes, *prepared.notes, *plausibility_notes(resolved_case)]
    if status == Status.finished:
        notes += particle_notes(resolved_case, touches, arrays.contacts, arrays.centre_of_mass, overlaps)
    notes += [*table_notes(resolved_case, speeds), *extrapolation_notes(totals.extrapolated)]
    counts = {"steps": totals.steps - packed.first_step, "rebuilds": totals.rebuilds, "refreshes": totals.refreshes}
    counts |= {f"first_touches_{partner}": int(touches[:, Partner[partner]].sum()) for partner in PARTNERS}
    return Run(
        arrays,
        case,
        Provenance.now(method=case.method.kind, seed=case.seed, continues=origin),
        status=name,
        message=message,
        notes=tuple(notes),
        counts=counts | {"extrapolated": totals.extrapolated, "memory_bytes": totals.memory_bytes},
        diagnostics={**diagnostics, **prepared.fills},
        wall_time=active.seconds,
        end=end_of(resolved_case, packed, dem, records) if keeps_end and not dem.status else None,
    )


def _relative_speeds(arrays: RunArrays) -> Array:
    """Return the root mean square speed of particles relative to their cavity, times the square root of two, (D,) [m/s]."""
    mass, cavity = arrays.particle_mass, arrays.cavity_velocity
    carried = np.sum(arrays.momentum * cavity, axis=2) - 0.5 * mass * np.sum(cavity**2, axis=2)
    energy = np.maximum(arrays.kinetic_energy - carried, 0.0).mean(axis=0)
    # Most of the energy is that of the rotation in a cavity that turns; whether balls roll through it is unknown.
    energy[np.any(arrays.cavity_speed, axis=0)] = 0.0
    return np.asarray(2 * np.sqrt(energy / mass))


def _arrays(case: Case, packed: _core.DemProblem, raw: _core.Records, dem: _core.Dem) -> RunArrays:
    """Return the arrays of a run: those of the structure, and motion and energies of cavities and particles."""
    dampers, time = case.particle_dampers, raw.time
    shapes = [cavity.shape for cavity in packed.cavities]
    displacement = np.stack([raw.q @ shape for shape in shapes], axis=1)
    # Positions and forces in a cavity that turns are those in its axes; the structure feels them in those of the machine.
    inside, turning_force, on_structure, torque = _in_turning_cavities(case, raw, displacement)
    base = np.zeros((3, time.size, 3))
    for signal, acceleration in zip((*case.base, *case.shaker_motion), case.base_acceleration(), strict=True):
        base += np.multiply.outer(acceleration.motion(time), direction_of_base(dampers, signal))
    # Particles at the end, from which another run can continue.
    ends = dem.state().cavities
    contents = [damper.contents for damper in dampers]
    fixed = {name: np.concatenate([getattr(part, name) for part in contents]) for name in ("radius", "mass", "species")}
    return RunArrays(
        **structure_arrays(case, time, raw.q, raw.p, base, on_structure, shapes) | {"cavity_force": raw.force},
        engine="dem",
        dampers=tuple(damper.label(index) for index, damper in enumerate(dampers)),
        cavity_displacement=displacement,
        cavity_velocity=np.stack([raw.p @ shape for shape in shapes], axis=1),
        cavity_moment=raw.moment,
        centre_of_mass=raw.centre - inside,
        cavity_angle=raw.angle,
        cavity_speed=raw.speed,
        turning_force=turning_force,
        drive_torque=torque,
        drive_work=raw.drive_work,
        momentum=raw.momentum,
        contacts=raw.contacts,
        particle_mass=np.array([part.mass.sum() for part in contents]),
        kinetic_energy=raw.kinetic,
        rotation_energy=raw.rotation,
        contact_energy=raw.elastic,
        gravity_energy=raw.potential,
        load_work=raw.load_work.sum(axis=1),
        base_work=raw.base_work.sum(axis=1),
        viscous_loss=raw.viscous_loss.sum(axis=1),
        **{name: getattr(raw, name) for name in LOSSES},
        **(_wall_arrays(dampers, raw) if case.output.walls else {}),
        particles={
            "position": np.concatenate(
                [
                    damper.interior.wrapped(end.position - end.displacement)
                    for damper, end in zip(dampers, ends, strict=True)
                ]
            ),
            "velocity": np.concatenate([_velocity(*of) for of in zip(dampers, ends, raw.speed[-1], strict=True)]),
            "spin": np.concatenate([end.spin for end in ends]),
            "damper": np.repeat(np.arange(len(dampers)), [part.radius.size for part in contents]),
            **fixed,
        },
    )


def _velocity(damper: ParticleDamper, end: Any, speed: float) -> Array:
    """Return velocities relative to the base, or to axes that turn with the cavity about the displaced axis, (n, 3)."""
    if (rotation := damper.rotation) is None:
        return np.asarray(end.velocity)
    return np.asarray(end.velocity) - rotation.lever_velocity(np.asarray(end.displacement), speed)


def _in_turning_cavities(case: Case, raw: _core.Records, displacement: Array) -> tuple[Array, Array, Array, Array]:
    """Return displacements along the axes of the cavities, forces along them and on the structure, and torques of drives.

    `displacement`: those of the cavities along the axes of the machine, (T, D, 3) [m].
    """
    # In a cavity that turns, the core measures positions along its axes and forces along those of the machine.
    inside, turning_force, on_structure = displacement.copy(), raw.force.copy(), raw.force.copy()
    torque = np.zeros(raw.angle.shape)
    for index, damper in enumerate(case.particle_dampers):
        if (rotation := damper.rotation) is None:
            continue
        angle, carries = raw.angle[:, index], rotation.vibration == "cavity"
        turning_force[:, index] = rotation.to_cavity(raw.force[:, index], angle)
        arm = np.asarray(rotation.arm) + carries * displacement[:, index]
        if not carries:
            inside[:, index] = rotation.to_cavity(displacement[:, index], angle)
        elif case.modes.decay.size:
            on_structure[:, index] = turning_force[:, index]
        moment = rotation.to_cavity(raw.moment[:, index], angle) + np.cross(arm, turning_force[:, index])
        torque[:, index] = -moment @ unit_vector(rotation.axis)
    return inside, turning_force, on_structure, torque


def _wall_arrays(dampers: Sequence[ParticleDamper], raw: _core.Records) -> dict[str, Any]:
    """Return the arrays of the walls of all cavities; impulses, losses and impacts count from the first sample."""
    labels = [damper.interior.walls().labels for damper in dampers]
    names = [damper.label(index) for index, damper in enumerate(dampers)]
    alone = len(dampers) == 1
    arrays = {name: getattr(raw, name) for name in raw.fields() if name.startswith("wall_")}
    arrays |= {name: arrays[name] - arrays[name][:1] for name in WALL_SUMS}
    return arrays | {
        "walls": tuple(
            face if alone else f"{name} {face}" for name, faces in zip(names, labels, strict=True) for face in faces
        ),
        "wall_damper": np.repeat(np.arange(len(dampers)), [len(faces) for faces in labels]),
        "wall_area": np.concatenate([damper.interior.face_areas for damper in dampers]),
    }


def _status_and_message(
    case: Case, arrays: RunArrays, dem: _core.Dem, status: Status, step: Step, checkpoint: Checkpoint | None
) -> tuple[str, str]:
    """Return the status and the message of a run."""
    if status == Status.finished:
        ledger = Ledger(arrays)
        end = final_status(ledger, _core.worst_energy_residual, arrays.particle_mass.sum())
        residual = ledger.energy_residual if end else 0.0
        return describe(end, case.duration, "", residual, case.method.kind, step=step.dt)
    stopped = dem.stopped()
    cavity = stopped.cavity
    number = stopped.particle + sum(damper.contents.radius.size for damper in case.particle_dampers[:cavity])
    where = f"Particle {number}, in {arrays.dampers[cavity]!r},"
    softened = case.particle_dampers[cavity].softening_factor > 1
    name, message = describe(status, stopped.time, where, stopped.speed, case.method.kind, softened=softened)
    if status == Status.interrupted:
        again = "" if checkpoint is None else f" Run the case again to resume from {checkpoint.path}."
        return name, message + again
    message += f" The step was {step.dt:.4g} s."
    if checkpoint is not None and checkpoint.time is not None:
        message += f" The last checkpoint, at t = {checkpoint.time:.6g} s, is in {checkpoint.path.name}."
    return name, message
