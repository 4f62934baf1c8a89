"""Particle runs that continue another run from its end: time step, packing, and what may change."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox._util.narrow import instance
from rattlebox.core import _core
from rattlebox.core.choose import instructions
from rattlebox.engines.continued import modal_start
from rattlebox.engines.end_state import EndState
from rattlebox.engines.fingerprint import fingerprint
from rattlebox.model.errors import Hint, several
from rattlebox.model.methods import Dem
from rattlebox.prepare.particles import Prepared, pack_particles, prepare
from rattlebox.results.provenance import Provenance
from rattlebox.results.run_end import LARGEST, RunEnd

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.prepare.time_step import Step

_SAME = 1e-6
"""Part of a time step, or of an interval between samples, to which times must agree."""
_PARTICLES = ("radius", "mass", "inertia", "species")
_LIMITS = {"tangential": "friction", "rolling": "coefficient"}
"""Number of a law of friction or rolling that may change, but not from or to zero."""


class Continuation(NamedTuple):
    """A prepared and packed case that continues a run; `is_same` if nothing but its end differs from that of the run."""

    prepared: Prepared
    packed: _core.DemProblem
    state: EndState
    is_same: bool


def end_of(case: Case, packed: _core.DemProblem, dem: _core.Dem, records: _core.Records) -> RunEnd:
    """Return the state at the end of a run that has not failed; `case` has numbers for softenings."""
    step, time = dem.step - 1, float(records.time[-1])
    if abs(packed.origin + step * packed.dt - time) > _SAME * packed.dt:
        return RunEnd(time, obstacle="it was stopped between two samples")
    if (size := dem.counts().memory_bytes) > LARGEST:
        return RunEnd(
            time, obstacle=f"its state of {1e-6 * size:.0f} MB is larger than the {1e-6 * LARGEST:.0f} MB kept"
        )
    softening = np.array([damper.softening_factor for damper in case.particle_dampers])
    more = {"step": np.array(step), "origin": np.array(packed.origin), "softening": softening}
    arrays = EndState.of(dem, packed, records).arrays() | more
    return RunEnd(time, _numbers(packed), Provenance.now().version, instructions(), arrays)


def _numbers(packed: _core.DemProblem) -> str:
    """Return the digest of a packed case, without its time and its samples."""
    return fingerprint(packed.replace(steps=0, every=0, first_step=0, origin=0.0, enduring=0.0, each_wall=False))


def pack_continued(case: Case, before: Case, end: RunEnd) -> Continuation:
    """Prepare and pack a case that continues a run of the case `before`."""
    arrays = dict(end.arrays or {})
    softening, step, origin = (arrays.pop(name) for name in ("softening", "step", "origin"))
    state = EndState.from_arrays(arrays)
    if state is None:
        raise DataError("the run has the state of another kind of run", "run the case again with rb.simulate")
    first = int(step)
    case = _softened(case, softening)
    for index, (damper, positions) in enumerate(zip(case.particle_dampers, state.positions, strict=True)):
        count = damper.contents.radius.size
        if count != len(positions):
            raise Hint(
                f"the bed has {several(count, 'particle')}, that of the run {len(positions)}; both must be the same",
                "the same particles and cavity",
                ["dampers", index, "particles"],
            )
    prepared = prepare(case, state.positions)
    # The step of the run, if samples fall on it; a case that is the same continues bit by bit then.
    own = _with_step(prepared, state.dt, end.time)
    chosen = instance(case.method, Dem).dt
    if own is not None and chosen in ("auto", instance(before.method, Dem).dt):
        packed = pack_particles(own)
        if _numbers(packed) == end.numbers:
            packed = packed.replace(steps=first + packed.steps, first_step=first, origin=float(origin))
            return Continuation(own, packed, state, is_same=True)
    longest = min(state.dt, prepared.step.limit.step) if chosen == "auto" else float(chosen)
    if own is None or longest < state.dt * (1 - _SAME) or longest > state.dt * (1 + _SAME):
        own = replace(prepared, step=_divided(prepared, longest, end.time))
    packed = pack_particles(own)
    old = prepare(_softened(before, softening), state.positions)
    _check_changes(case, before, packed, pack_particles(old))
    return Continuation(own, packed.replace(origin=end.time), state.in_gravity(packed), is_same=False)


def _softened(case: Case, softening: object) -> Case:
    """Return a case with the softenings of the run in place of "auto"."""
    numbers = np.atleast_1d(np.asarray(softening, float))
    if len(case.particle_dampers) != numbers.size:
        have, had = (several(count, "particle damper") for count in (len(case.particle_dampers), numbers.size))
        raise Hint(f"the case has {have}, the run {had}; both must be the same", "the same dampers", ["dampers"])
    dampers = [
        damper.model_copy(update={"softening": float(number)}) if damper.softening == "auto" else damper
        for damper, number in zip(case.particle_dampers, numbers, strict=True)
    ]
    return case.model_copy(update={"dampers": tuple(dampers)})


def _with_step(prepared: Prepared, dt: float, start: float) -> Prepared | None:
    """Return a prepared case with a time step; None if end or samples do not fall on steps."""
    case = prepared.case
    left = case.duration - start
    steps, every = left / dt, left / case.even_samples(start) / dt
    count = round(steps)
    if count < 1 or abs(steps - count) > _SAME * count:
        return None
    if not case.output.is_chosen:  # any samples that are dense enough
        dense = max(1, math.floor(every * (1 + _SAME)))
        every = next((n for n in range(dense, dense // 2, -1) if count % n == 0), dense)
    elif abs(every - round(every)) > _SAME * every or every < 1 - _SAME:
        return None
    return replace(prepared, step=replace(prepared.step, dt=dt, every=round(every), count=count))


def _divided(prepared: Prepared, longest: float, start: float) -> Step:
    """Return the longest step with samples on steps."""
    samples = prepared.case.even_samples(start)
    interval = (prepared.case.duration - start) / samples
    every = max(1, math.ceil(interval / longest * (1 - 1e-12)))
    return replace(prepared.step, dt=interval / every, every=every, count=every * samples)


def _check_changes(case: Case, before: Case, new: _core.DemProblem, old: _core.DemProblem) -> None:
    """Raise if a case differs from that of the run in what a bed cannot follow."""
    start = np.ones(np.shape(old.mode_displacement))  # of all modes, so that any other shape changes it
    q, _ = modal_start(before.modes, case.modes, start, start)
    if not np.array_equal(q, start):
        raise Hint(
            "the mode shapes of the structure differ from those of the run, as with other masses",
            "changes that leave them as they are: frequencies, damping, loads",
            ["structure"],
        )
    dampers = zip(new.cavities, old.cavities, case.particle_dampers, before.particle_dampers, strict=True)
    for index, (cavity, other, damper, earlier) in enumerate(dampers):
        differences = list(_differences(cavity, other))
        # The packed velocity contains that of the rotation, which may change.
        if not np.array_equal(damper.start.velocity, earlier.start.velocity):
            differences.append(("velocity", "the particles and their start"))
        for name, what in differences:
            raise Hint(f"{what} of the run cannot change ({name})", "the same particles and cavity", ["dampers", index])
    if len(new.pairs) != len(old.pairs):
        raise Hint("the species of the run cannot change", "the same particles", ["dampers"])
    for pair, other_pair in zip(new.pairs, old.pairs, strict=True):
        if _elastic(pair) != _elastic(other_pair):
            raise Hint(
                "the stiffness of contacts of particles cannot change in a run: the energy of closed contacts would jump",
                "changes of restitution, of coefficients of friction or rolling above zero, of loads or the structure",
                ["dampers"],
            )


def _differences(cavity: _core.Cavity, other: _core.Cavity) -> Iterator[tuple[str, str]]:
    """Yield the fields of a cavity that differ, and what they are."""
    for name in _PARTICLES:
        if not np.array_equal(getattr(cavity, name), getattr(other, name)):
            yield name, "the particles"
    own, others = ({"": [each.walls, each.solids, each.period]} for each in (cavity, other))
    if fingerprint(own) != fingerprint(others):
        yield "walls", "the cavity"
    turning, turned = cavity.rotation, other.rotation
    if (turning is None) != (turned is None):
        yield "rotation", "whether the cavity turns"
    elif turning is not None and turned is not None:
        for name in ("axis", "arm", "carries_structure"):
            if not np.array_equal(getattr(turning, name), getattr(turned, name)):
                yield f"rotation: {name}", "the axis of the rotation"
    if not np.array_equal(cavity.shape, other.shape):
        yield "point and direction", "the place of the damper"


def _elastic(pair: _core.PairLaws) -> str:
    """Return a digest of the laws of a pair that decide the energy stored in a contact."""
    parts: dict[str, Any] = {"normal": {k: v for k, v in _values(pair.normal).items() if k not in ("damping", "alpha")}}
    for name, limit in _LIMITS.items():
        values = _values(getattr(pair, name))
        parts[name] = values | {limit: float(values[limit]) > 0}
    parts["kinds"] = [type(part).__name__ for part in (pair.normal, pair.tangential, pair.rolling)]
    return fingerprint(parts)


def _values(node: _core.Node) -> dict[str, Any]:
    return {name: getattr(node, name) for name in node.fields()}
