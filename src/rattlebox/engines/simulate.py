"""Run cases: the impact engine and the choice of the engine."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.interrupts import raise_if_pressed
from rattlebox._util.progress import Report, progress_bar
from rattlebox.core import _core
from rattlebox.core._core import Status
from rattlebox.engines.continued import (
    Start,
    checked_end,
    continues,
    end_of,
    from_start,
    pack_continued,
    read_start,
    reading_state,
)
from rattlebox.engines.responses import structure_arrays
from rattlebox.engines.run_notes import extrapolation_notes, impact_notes, simultaneous_notes, vibration_notes
from rattlebox.engines.status import describe, final_status
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint
from rattlebox.model.methods import Output
from rattlebox.model.plausibility import plausibility_notes
from rattlebox.model.space import axis_of
from rattlebox.model.units import whole_number
from rattlebox.prepare.pack import MAX_EVENTS, pack
from rattlebox.results.arrays import RunArrays
from rattlebox.results.ledger import Ledger
from rattlebox.results.provenance import Provenance
from rattlebox.results.run import Run
from rattlebox.results.schema import LINE

if TYPE_CHECKING:
    from numpy.typing import NDArray

_ENERGIES = ("contact_energy", "load_work", "base_work", "viscous_loss", "normal_loss", "plastic_loss")
"""Energies of a sample that the core returns under the names of the arrays of a run."""


def simulate(
    case: Case,
    *,
    start: Start | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    snapshots: str | os.PathLike[str] | None = None,
    progress: bool | Callable[[int, int], object] = True,
) -> Run:
    """Run a case.

    Parameters
    ----------
    case
        Case to run, including the method.
    start
        Run to continue from its end, or the file of a saved one; or a pair of a run and a time of it, up to which the run is
        repeated first. Bodies, contacts and their history continue, and so does time: `duration` of the case is the time at
        which it ends, and its loads act at the times from the end of the earlier run on. Work, losses and measures count
        from there. Without other changes the results are bitwise those of one longer run. Parts of the case that differ
        from those of the run act from its end on.
    checkpoint
        Checkpoint file, written every ten minutes (`Dem(checkpoint=...)`, or `checkpoint_every=...` in simulated time),
        on Ctrl-C and at the end. If it exists, the run resumes from it with bitwise the same results. Particle runs
        only.
    snapshots
        File (.vtkhdf) for the particles at the times of `Output(snapshots=...)`, for ParaView. Particle runs only.
    progress
        True for a progress bar after 2 s, False for none, or a function of the numbers of steps (1-D: of runs) done and of
        all; the run stops if it returns False.

    Returns
    -------
    Run
        Motion, energy ledger, impacts or particles, and a status. A run that cannot be finished raises no exception: it
        has a status, a message and the results up to that time.

    Raises
    ------
    CaseError
        If a checkpoint or snapshots are given for a 1-D run, or the case requests snapshots without a file; if the case
        cannot continue `start`, because it has other bodies, another law for a closed contact, or a smaller gap than the
        balls need.
    DataError
        If the checkpoint belongs to another case, version or core (the message lists the differences), is damaged, or
        is in use by another process; if a file is a folder, both files are the same, or a file cannot be written.
    ResourceError
        If no space is left on the disk, or RATTLEBOX_SIMD names instructions that the processor lacks.

    Examples
    --------
    >>> import rattlebox as rb
    >>> run = rb.simulate(rb.reference_case(duration="0.1 s"))
    >>> run.status
    'finished'
    """
    require_case(case)
    if start is not None:
        return _continue(case, start, checkpoint, snapshots, progress)
    if case.particle_dampers:
        from rattlebox.engines.dem import simulate_dem

        if snapshots is None and case.output.snapshots:
            raise Hint("output.snapshots requests snapshots, but no file is given", 'snapshots="run.vtkhdf"')
        with progress_bar(progress, "steps") as report:
            return simulate_dem(
                case, progress=report, checkpoint=_path(checkpoint), snapshots=_path(snapshots), keeps_end=True
            )
    if checkpoint is not None or snapshots is not None:
        raise Hint(
            "the case has no particles; checkpoints and snapshots are for particle dampers only", "leave them out"
        )
    return simulate_many([case], progress=progress)[0]


def _continue(
    case: Case,
    start: Start,
    checkpoint: str | os.PathLike[str] | None,
    snapshots: str | os.PathLike[str] | None,
    progress: bool | Callable[[int, int], object],
) -> Run:
    """Run a case from the end of another run, or from a time of it."""
    if checkpoint is not None or snapshots is not None or case.output.snapshots:
        raise Hint("a run that continues another one writes no checkpoints and no snapshots", "leave them out")
    run, time = read_start(start)
    if time is not None:
        run = repeat_up_to(run.case, time, progress)
        if not run.ok:  # stopped by the user
            return run
    return continue_run(case, run, progress=progress)


def continue_run(
    case: Case, run: Run, *, threads: int | None = None, progress: bool | Callable[[int, int], object] = False
) -> Run:
    """Run a case from the end of another run; `threads` is for particles."""
    end = checked_end(case, run)
    origin = continues(run, end)
    if case.particle_dampers:
        from rattlebox.engines.dem import simulate_from

        with progress_bar(progress, "steps") as report, reading_state():
            return simulate_from(case, run.case, end, origin, report, threads=threads)
    packed = pack_continued(case, run, end)
    with progress_bar(progress, "runs") as report, reading_state():
        (raw,) = _core.simulate([packed], 1, lambda done: report(done, 1))
    return run_from_core(case, from_start(raw, end.time, len(case.each_stop)), packed, origin)


def repeat_up_to(case: Case, time: float, progress: bool | Callable[[int, int], object]) -> Run:
    """Run a case up to a time of it [s]."""
    if case.particle_dampers:
        from rattlebox.engines.dem import repeat_until

        with progress_bar(progress, "steps") as report:
            return repeat_until(case, time, report)
    return simulate(case.replaced({"duration": time, "output": Output(times=(time,))}), progress=progress)


def _path(path: str | os.PathLike[str] | None) -> Path | None:
    return None if path is None else Path(path)


def simulate_many(
    cases: Iterable[Case], *, threads: int | None = None, progress: bool | Callable[[int, int], object] = True
) -> list[Run]:
    """Run several cases at the same time, each 1-D case on one thread.

    Parameters
    ----------
    cases
        Cases to run.
    threads
        Number of threads; default one per core. The results are bitwise independent of it.
    progress
        True for a progress bar after 2 s, False for none, or a function of the numbers of runs done and of all; the runs
        stop if it returns False.

    Returns
    -------
    list of Run
        Results in the order of the cases. Ctrl-C ends the runs in progress with the status "interrupted".

    Raises
    ------
    CaseError
        If an element is not a case, or `threads` is not a positive whole number.
    """
    if isinstance(cases, Case):
        raise Hint("a list of cases is needed, not one case", "simulate(case)")
    cases = list(cases)
    for case in cases:
        require_case(case)
    if threads is not None:
        threads = whole_number(threads, "threads", 1)
    if any(case.particle_dampers for case in cases):
        # Particle cases run one after the other, each on all threads.
        from rattlebox.engines.dem import simulate_dem

        # All 1-D cases run first, together on all threads; their results are merged in the order of the cases.
        plain = [case for case in cases if not case.particle_dampers]
        with progress_bar(progress, "runs") as report:
            finished = iter(simulate_many(plain, threads=threads, progress=lambda done, _: report(done, len(cases))))
            done = len(plain)
            runs: list[Run] = []
            for case in cases:
                if case.particle_dampers:
                    # Ctrl-C ends all runs.
                    stopped = any(run.status == "interrupted" for run in runs)
                    proceed = _stop if stopped else partial(_report_done, report, done, len(cases))
                    runs.append(simulate_dem(case, threads=threads, progress=proceed, keeps_end=True))
                    done += 1
                else:
                    runs.append(next(finished))
            report(done, len(cases))
            return runs
    packed = [pack(case) for case in cases]
    count = max(1, min(len(packed), threads or os.cpu_count() or 1))
    with progress_bar(progress, "runs") as report:
        results = _core.simulate(packed, count, lambda done: report(done, len(packed))) if packed else []
        report(len(packed), len(packed))
    raise_if_pressed()  # of a study, of which these runs are a part
    return [run_from_core(*each) for each in zip(cases, results, packed, strict=True)]


def _report_done(report: Report, done: int, total: int, *_steps: int) -> object:
    """Report finished runs, whatever the steps of the present one."""
    return report(done, total)


def _stop(*_: int) -> bool:
    return False


def require_case(case: object) -> None:
    """Raise if an argument is not a case."""
    if not isinstance(case, Case):
        raise Hint(f"a Case is needed, not {case!r:.60}", 'rb.Case.from_file("case.toml")')


def _limit_samples(raw: _core.Result) -> _core.Result:
    """Remove the samples at contacts if the run has more than `MAX_EVENTS` events."""
    many = max(raw.counts.events, raw.impacts.time.size) > MAX_EVENTS
    chosen = raw.chosen
    if not many or chosen.all():
        return raw
    sampled = ("time", "state", "chosen", "cavity_force", *_ENERGIES)
    return raw.replace(**{name: getattr(raw, name)[chosen] for name in sampled})


def run_from_core(case: Case, raw: _core.Result, packed: _core.Problem | None = None, origin: str = "") -> Run:
    """Return the run of a case from the result of the core; with its packed case, the run can be continued."""
    raw = _limit_samples(raw)
    with np.errstate(over="ignore", invalid="ignore"):  # a solution that became non-finite has a status
        arrays = _arrays(case, raw)
    status, message = _status_and_message(case, arrays, raw)
    notes = plausibility_notes(case)
    if raw.status == Status.finished:
        notes += impact_notes(case, arrays.relative_position - arrays.ball_centre, arrays.stop_gap, arrays.impacts)
        notes += tuple(extrapolation_notes(raw.counts.extrapolated))
        notes += tuple(simultaneous_notes(raw.counts.simultaneous_impacts))
        notes += tuple(vibration_notes(raw.counts.contact_steps))
    return Run(
        arrays,
        case,
        Provenance.now(method=case.method.kind, seed=case.seed, continues=origin),
        status=status,
        message=message,
        notes=notes,
        counts={name: getattr(raw.counts, name) for name in raw.counts.fields()} | {"impacts": raw.impacts.time.size},
        wall_time=raw.seconds,
        end=None if packed is None else end_of(packed, raw),
    )


def _status_and_message(case: Case, arrays: RunArrays, raw: _core.Result) -> tuple[str, str]:
    """Return the status and the message of a run."""
    if raw.status in (Status.finished, Status.law_domain, Status.no_rebound):
        ledger = Ledger(arrays)
        mass = sum(float(damper.masses.sum()) for damper in case.impact_dampers)
        mass += sum(float(stop.pair(case.modes).mass) for stop in case.each_stop)
        held = raw.permitted_error if case.method.is_exact else 0.0
        end = final_status(
            ledger,
            raw.energy_residual_limit,
            mass,
            permitted=raw.permitted_error,
            rounding=raw.energy_rounding,
            held=held,
        )
        # A speed at which a law ends, of a motion that has gained energy, says nothing about the law.
        if raw.status == Status.finished or end != Status.finished:
            time = case.duration if raw.status == Status.finished else raw.stopped_at
            return describe(end, time, "", ledger.energy_residual if end else 0.0, case.method.kind)
    contact = case.contact_names[raw.stopped_contact] if raw.stopped_contact >= 0 else ""
    return describe(raw.status, raw.stopped_at, contact, raw.stopped_value, case.method.kind)


def _arrays(case: Case, raw: _core.Result) -> RunArrays:
    """Return the arrays of a run: those of the structure, and positions and energies of the balls."""
    dampers, stops = case.impact_dampers, case.each_stop
    m, d = len(case.modes.decay), len(dampers)
    names = [damper.label(index) for index, damper in enumerate(dampers)]
    counts = [len(damper.balls) for damper in dampers]
    ball_damper = np.repeat(np.arange(d), counts)
    b = ball_damper.size
    # The state has displacement and velocity of each mode by turns, then the positions and the velocities of all balls,
    # then the impulses on all stops.
    q, p = raw.state[:, 0 : 2 * m : 2], raw.state[:, 1 : 2 * m : 2]
    position, velocity, impulse = np.split(raw.state[:, 2 * m :], [b, 2 * b], axis=1)
    shapes = np.array([case.modes.shape(damper.point) for damper in dampers]).reshape(d, m)
    stop_shapes = np.array([stop.shape(case.modes) for stop in stops]).reshape(len(stops), m)
    # The core counts the motion of a point and the force on it positive towards the stop.
    signs = np.array([stop.sign for stop in stops])
    force = raw.cavity_force * np.concatenate([np.ones(d), signs])
    on_base = np.array([stop.other is None for stop in stops], dtype=bool)
    centre = np.concatenate([np.zeros(0), *(damper.centres for damper in dampers)])
    mass = np.concatenate([np.zeros(0), *(damper.masses for damper in dampers)])
    gravity = np.array([damper.gravity for damper in dampers])
    potential = np.zeros((raw.time.size, d + len(stops)))
    np.add.at(potential.T, ball_damper, -(mass * gravity[ball_damper])[:, None] * position.T)
    structure = structure_arrays(
        case, raw.time, q, p, _base_motion(case, raw.time), force, np.concatenate([shapes, stop_shapes])
    )
    # The other side of a stop on the ground pushes the base.
    structure["interface_force"] = structure["interface_force"] - force[:, d:][:, on_base].sum(axis=1)
    return RunArrays(
        **structure,
        balls=tuple(f"{name}/{k + 1}" for name, count in zip(names, counts, strict=True) for k in range(count)),
        dampers=(*names, *(stop.name for stop in stops)),
        stops=tuple(stop.name for stop in stops),
        line=_line_of(case),
        stop_gap=np.array([stop.gap for stop in stops]) - signs * (q @ stop_shapes.T),
        stop_impulse=-signs * impulse,
        ball_damper=ball_damper,
        ball_centre=centre,
        clearance=np.array([*(damper.clearance for damper in dampers), *(2 * stop.gap for stop in stops)]),
        ball_position=position + centre,
        ball_velocity=velocity,
        relative_position=position + centre - (q @ shapes.T)[:, ball_damper],
        relative_velocity=velocity - (p @ shapes.T)[:, ball_damper],
        ball_energy=0.5 * mass * velocity**2,
        gravity_energy=potential,
        impacts={name: getattr(raw.impacts, name) for name in raw.impacts.fields()},
        **{name: getattr(raw, name) for name in _ENERGIES},
    )


def _base_motion(case: Case, time: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return displacement, velocity and acceleration of the base, (3, T); only a harmonic starts in motion."""
    return sum((signal.motion(time) for signal in case.base_acceleration()), np.zeros((3, time.size)))


def _line_of(case: Case) -> str:
    """Return the name of the axis of a 1-D run: the direction of the base motion, which is the same for all signals."""
    for signal in (*case.base, *case.shaker_motion):
        if isinstance(signal.direction, str):
            return signal.direction
        if signal.direction is not None and (axis := axis_of(signal.direction)):
            return axis
    return LINE
