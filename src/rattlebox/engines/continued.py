"""Runs that continue another run from its end: what may change, and packing for the 1-D engine."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.exceptions import DataError, RattleboxError
from rattlebox._util.quantities import amount
from rattlebox.core import _core
from rattlebox.core.choose import instructions
from rattlebox.engines.fingerprint import fingerprint
from rattlebox.model.errors import Hint, several
from rattlebox.model.units import in_si
from rattlebox.prepare.pack import pack
from rattlebox.results.provenance import Provenance
from rattlebox.results.run import Run, load
from rattlebox.results.run_end import RunEnd

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.case import Case
    from rattlebox.model.modes import ModalModel

Start = Run | str | os.PathLike[str] | tuple[Run | str | os.PathLike[str], Any]
"""A run, the file of a saved one, or a pair of a run and a time of it."""

_WITHOUT_HISTORY = (_core.HertzTsujiForce, _core.LinearForce, _core.PowerForce)
"""Laws whose coefficients may change while a contact is closed."""
_SAME_MOTION = 1e-9
"""Largest error of the motion of a point with other modes, over its largest displacement or velocity."""
_NAMED = 4
"""Number of points that a message names."""
_PHASES = {1: "touching", 2: "closed", 3: "recovering from a contact"}
_SUMS = ("load_work", "base_work", "viscous_loss", "normal_loss", "plastic_loss")
_AGAIN = "run the case again with rb.simulate, and continue that run"


def read_start(start: Start) -> tuple[Run, float | None]:
    """Return the run that `start` names, and the time in it; None for its end."""
    time = None
    if isinstance(start, tuple):
        if len(start) != 2:
            raise Hint(f"start has {several(len(start), 'part')}; a run and a time are needed", 'start=(run, "0.5 s")')
        start, given = start
        time = float(in_si(given, "s"))
    run = load(start) if isinstance(start, (str, os.PathLike)) else start
    if not isinstance(run, Run):
        raise Hint(f"start must be a run, not {run!r:.60}", "start=rb.simulate(case), or the file of a saved run")
    first, last = float(run.arrays.time[0]), float(run.arrays.time[-1])
    if time is not None and not first < time <= last:
        allowed = f"after {amount(first, 's')} and up to {amount(last, 's')}"
        raise Hint(
            f"the run has no state at {amount(time, 's', 9)}; the time must be {allowed}", "start=run for its end"
        )
    if time is not None and time < last and run.provenance.continues:
        raise Hint(
            "the run continues another one, and the time lies inside it",
            f'rb.simulate(run.case.replaced({{"duration": {time!r}}}), start=...) with the run that it continues',
        )
    return run, None if time == last else time


def checked_end(case: Case, run: Run) -> RunEnd:
    """Return the state at the end of a run; raise if the case cannot continue from it."""
    before = run.case
    for method in (before.method, case.method):
        if not method.has_stepper:
            name = type(method).__name__
            raise Hint(f"runs of the method {name} cannot be continued", "another method from the start", ["method"])
    # The run has a state at its end, of the program that would continue it.
    end = run.end
    if run.status not in ("finished", "interrupted"):
        raise Hint(f"the run has the status {run.status} and cannot be continued", "a run that reached its end")
    if end is None:
        raise Hint(
            "the run has no state from which another run could continue: it comes from a study, or from a file of an "
            "earlier version",
            _AGAIN,
        )
    if end.obstacle:
        raise Hint(f"the run cannot be continued: {end.obstacle}", "a checkpoint, from which a run resumes")
    here = Provenance.now().version, instructions()
    if (end.version, end.core) != here:
        raise Hint(
            f"the state of the run was written by Rattlebox {end.version} with the core {end.core}; this is Rattlebox "
            f"{here[0]} with the core {here[1]}",
            _AGAIN,
        )
    # The case is one that the same engine computes further.
    if bool(case.particle_dampers) != bool(before.particle_dampers):
        raise Hint("the run and the case must both have particle dampers, or none", "the same kind of dampers")
    if case.method.kind != before.method.kind:
        raise Hint(
            f"the method is {case.method.kind}, that of the run {before.method.kind}; both must be the same",
            f'kind = "{before.method.kind}"',
            ["method"],
        )
    if not case.duration > end.time * (1 + 1e-12):
        raise Hint(
            f"the run has reached {amount(end.time, 's', 9)}, and the case ends at {amount(case.duration, 's', 9)}; time is "
            "counted from the start of the first run, so the case must end later",
            f'duration = "{1.5 * end.time:.6g} s"',
            ["duration"],
        )
    return end


def continues(run: Run, end: RunEnd) -> str:
    """Return words about the run that is continued, for the provenance of the new one."""
    digest = hashlib.sha256((run.case_toml + run.provenance.continues).encode()).hexdigest()[:12]
    name = f"{run.case.name!r}" if run.case.name else "a run"
    earlier = f", which continues {run.provenance.continues}" if run.provenance.continues else ""
    return f"{name} from {amount(end.time, 's', 9)}, of {run.provenance.created}, case {digest}{earlier}"


@contextmanager
def reading_state() -> Iterator[None]:
    """Turn the error of the core about a state that is not one of the case into one with advice."""
    try:
        yield
    except ValueError as error:
        if isinstance(error, RattleboxError) or not str(error).startswith("the state"):
            raise
        raise DataError(f"the run cannot be continued: {error}", _AGAIN) from None


def numbers_of(packed: _core.Problem) -> str:
    """Return the digest of a packed case, without its end, its samples and its start."""
    settings = packed.settings.replace(duration=0.0, contact_samples=0, keep_end=False)
    bare = packed.replace(settings=settings, sample_times=np.zeros(0), start_state=None, changed=False)
    return fingerprint(bare)


def end_of(packed: _core.Problem, raw: _core.Result) -> RunEnd | None:
    """Return the state at the end of a 1-D run."""
    states = raw.states
    if not states.end.size:
        return None
    arrays = {name: getattr(states, name) for name in states.fields()}
    return RunEnd(raw.stopped_at, numbers_of(packed), Provenance.now().version, instructions(), arrays)


def pack_continued(case: Case, run: Run, end: RunEnd) -> _core.Problem:
    """Pack a 1-D case that continues a run."""
    packed = pack(case, end.time)
    arrays = end.arrays or {}
    if numbers_of(packed) == end.numbers:
        # The state before the run was cut off: from there on, the bits are those of a run in one go.
        return packed.replace(start_state=arrays["whole"])
    q, p = _check_changes(case, run, pack(run.case), packed, arrays)
    return packed.replace(start_state=arrays["end"], changed=True, mode_displacement=q, mode_velocity=p)


def _check_changes(
    case: Case, run: Run, old: _core.Problem, new: _core.Problem, arrays: Any
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the modal displacements and velocities in the modes of the new case; raise if it does not fit the run."""
    m, stops = old.mode_decay.size, len(case.each_stop)
    places: list[tuple[str | int, ...]] = [("dampers", index) for index in range(len(case.impact_dampers))]
    places += [("stops", index) for index in range(stops)]
    # The same number of balls in each damper.
    counts, before_counts = ([damper.mass.size for damper in packed.dampers] for packed in (new, old))
    if counts != before_counts:
        have, had = (_row_words(each) for each in (counts, before_counts))
        raise Hint(
            f"the case has {have}, the run {had}; both must be the same", "the same dampers and stops", ["dampers"]
        )
    motion, phases = arrays["motion"], arrays["phases"]
    before_q = motion[: 2 * m : 2]
    q, p = modal_start(run.case.modes, case.modes, before_q, motion[1 : 2 * m : 2])
    position = motion[2 * m :]
    names, contact, first = case.contact_names, 0, 0
    for damper, earlier, place in zip(new.dampers, old.dampers, places, strict=True):
        row = position[first : first + damper.mass.size]
        gaps, before_gaps = _gaps(damper, row, q), _gaps(earlier, row, before_q)
        size = float(damper.clearance) + float(np.abs(damper.shape * q).sum())
        for gap, before_gap in zip(gaps, before_gaps, strict=True):
            where, phase = names[contact], _PHASES.get(int(phases[contact]), "")
            # Bodies that touch keep their overlap; those that do not must have room in the new case.
            if phase and abs(gap - before_gap) > _SAME_MOTION * size:
                raise Hint(
                    f"{where} is {phase} at the end of the run, and with the gap of the case its overlap would change "
                    f"suddenly by {amount(abs(gap - before_gap), 'm')}",
                    "the same gap, or a time of the run at which nothing touches: start=(run, time)",
                    [*place, "gap"],
                )
            if phase:
                _check_law(old.contacts[contact], new.contacts[contact], where, phase, place)
            elif gap < -1e-12 * size:
                raise Hint(
                    f"{where} would overlap by {amount(-gap, 'm')} at the end of the run",
                    f"a gap that is larger by {amount(-gap, 'm')}, or another time of the run: start=(run, time)",
                    [*place, "gap"],
                )
            contact += 1
        first += row.size
    return q, p


def _row_words(counts: list[int]) -> str:
    """Return a phrase about the numbers of balls of dampers and stops; a stop has none."""
    dampers, stops = [count for count in counts if count], counts.count(0)
    words = [several(len(dampers), "impact damper")] if dampers else ["no impact damper"]
    words += [f"with {several(sum(dampers), 'ball')}"] if dampers else []
    return " ".join([*words, *([f"and {several(stops, 'stop')}"] if stops else [])])


def _gaps(damper: _core.Damper, row: NDArray[np.float64], q: NDArray[np.float64]) -> list[float]:
    """Return the gaps of a row of balls in its cavity, or of a stop, which has no balls [m]."""
    half, moved = 0.5 * float(damper.clearance), float(damper.shape @ q)
    if not row.size:
        return [half - moved]
    return [float(gap) for gap in np.diff([-half, *(row - moved), half])]


def _check_law(
    before: _core.Contact, after: _core.Contact, where: str, phase: str, place: tuple[str | int, ...]
) -> None:
    """Raise if the law of a contact in progress has changed in a way that it cannot follow."""
    if fingerprint(before) == fingerprint(after):
        return
    if type(before.normal) is not type(after.normal):
        what = "another kind of law"
    elif not isinstance(after.normal, _WITHOUT_HISTORY):
        what = "other numbers of a law with a history"
    else:
        return
    raise Hint(
        f"{where} is {phase} at the end of the run, and the case has {what} for it",
        "the same contact law, or a time of the run at which nothing touches: start=(run, time)",
        [*place, "contact"],
    )


def modal_start(
    before: ModalModel, after: ModalModel, q: NDArray[np.float64], p: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return modal displacements and velocities with which all points continue to move as in the modes before."""
    old, new = before.lines(), after.lines()
    if old.keys() != new.keys() or before.decay.size != after.decay.size:
        had, have = (
            f"{several(model.decay.size, 'mode')} and {several(len(lines), 'point')} ({_names(list(lines))})"
            for model, lines in ((before, old), (after, new))
        )
        raise Hint(
            f"the structure has {have}, that of the run {had}; modes and points must be the same in number and name",
            "the same structure with other masses, stiffnesses or damping",
            ["structure"],
        )
    q, p = np.ascontiguousarray(q), np.ascontiguousarray(p)
    shapes, others = (np.array(list(each.values())).reshape(len(each), -1) for each in (old, new))
    if np.array_equal(shapes, others):
        return q, p
    starts = []
    for modal in (q, p):
        motion = shapes @ modal
        start = np.linalg.lstsq(others, motion, rcond=None)[0]
        if np.abs(others @ start - motion).max(initial=0.0) > _SAME_MOTION * np.abs(motion).max(initial=0.0):
            raise Hint(
                "the modes of the case cannot take over the motion of the points at the end of the run",
                "changes that leave the mode shapes as they are (frequencies, damping), or a structure with all its modes",
                ["structure"],
            )
        starts.append(np.ascontiguousarray(start))
    return starts[0], starts[1]


def _names(points: list[str]) -> str:
    """Return the first names of points."""
    return ", ".join(points[:_NAMED]) + (", ..." if len(points) > _NAMED else "")


def from_start(raw: _core.Result, start: float, stops: int) -> _core.Result:
    """Return the result of a continued run from its start on: later samples and impacts, sums that begin with zero.

    The state ends with the impulses on the stops, which are sums, too.
    """
    # The state from which it continues may be a little earlier.
    later = raw.time >= start
    names = ("time", "state", "chosen", "cavity_force", "contact_energy", *_SUMS)
    samples = {name: getattr(raw, name)[later] for name in names}
    samples |= {name: samples[name] - samples[name][:1] for name in _SUMS}
    if stops:
        samples["state"][:, -stops:] -= samples["state"][:1, -stops:].copy()
    log = raw.impacts
    over = log.complete & (log.time + log.duration <= start) & (log.time < start)
    impacts = log.replace(**{name: getattr(log, name)[~over] for name in log.fields()})
    return raw.replace(impacts=impacts, **samples)
