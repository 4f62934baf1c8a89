"""Packing of a case into the problem of the 1-D engine, in SI units.

Many variants of a case are packed at once: numbers in a copy of the case are replaced by arrays that broadcast against each
other, and the same formulas pack the copy. Values that are not numbers, and entries of tables, cannot be arrays: each of
them needs a separate case. The problems are merged into one batch, or stay separate if they differ in more than numbers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.exceptions import CaseError
from rattlebox._util.narrow import instance
from rattlebox.core import _core
from rattlebox.model.base import Part
from rattlebox.model.contact_pairs import contact_pairs
from rattlebox.model.contacts import Contact, FixedDamping
from rattlebox.model.elementwise import stacked
from rattlebox.model.errors import Hint
from rattlebox.model.methods import ImpactMethod
from rattlebox.model.pairs import Pair
from rattlebox.model.paths import Place, part_at, place_of, replaced
from rattlebox.model.restitutions import Constant
from rattlebox.model.stops import Stop
from rattlebox.prepare.laws import pack_restitution, restitution_of_alpha
from rattlebox.prepare.variants import (
    Columns,
    Index,
    Merger,
    NotMergeable,
    column,
    compare,
    examples,
    group_equal,
    invalid_starts,
    is_number,
    variant,
    with_value,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.case import Case
    from rattlebox.model.modes import ModalModel
    from rattlebox.model.restitutions import Restitution
    from rattlebox.model.signals import Signal

MAX_EVENTS = 200_000
"""Largest number of events of a run whose contacts are sampled by default."""


def pack(case: Case, start: float = 0.0) -> _core.Problem:
    """Pack a case for the core, with samples from a time on [s]."""
    problem = _problem(case)
    settings = problem.settings.replace(contact_samples=contact_samples(case), keep_end=True)
    return problem.replace(settings=settings, sample_times=_array(case.sample_times(start)))


def contact_samples(case: Case) -> int:
    """Return the number of events of a run up to which contacts are sampled; 0 for none."""
    return 0 if case.output.is_chosen else MAX_EVENTS


@dataclass(frozen=True)
class Batch:
    """Packed variants of a grid that differ in numbers only."""

    packed: _core.Problem
    indices: tuple[NDArray[np.intp], ...]
    # Mode shapes at each point of the structure, (m, ...) over the grid
    points: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    # Participation of the modes in the motion of the base, (m, ...) [kg^1/2], and "residual_mass" (1, ...) [kg] of the
    # truncated modes; empty if unknown
    inertia: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    obstacle: NotMergeable | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the grid of the batch."""
        return tuple(len(axis) for axis in self.indices)

    def grid_index(self, local: Index) -> Index:
        """Return the index in the whole grid of a variant of the batch."""
        return tuple(int(axis[i]) for axis, i in zip(self.indices, local, strict=True))

    def local_index(self, index: Index) -> Index | None:
        """Return the index in the batch of a variant of the whole grid; None if the batch does not contain it."""
        local = tuple(int(np.searchsorted(axis, i)) for axis, i in zip(self.indices, index, strict=True))
        is_member = all(k < len(axis) and axis[k] == i for axis, i, k in zip(self.indices, index, local, strict=True))
        return local if is_member else None

    def flat_indices(self, shape: Sequence[int]) -> NDArray[np.intp]:
        """Return the flat indices of the variants in the whole grid of this shape, ascending."""
        return np.ravel_multi_index(np.ix_(*self.indices), tuple(shape)).ravel()


def pack_parts(case: Case, columns: Mapping[str, object], shape: Sequence[int]) -> list[Batch]:
    """Pack many variants of a case for the core, in batches that differ in numbers only.

    As a check, some variants, the extreme ones included, are also packed one by one and compared with their batch.
    """
    arrays = {path: column(path, values, shape) for path, values in columns.items()}
    parts = _variants(case, arrays, tuple(shape), {})
    tried = examples(arrays, shape)
    for part in parts:
        wrong = [part.grid_index(local) for local in invalid_starts(part.packed, part.shape)]
        # Formulas of the model take arrays in fields that are declared as numbers. The comparison finds one that
        # silently does not, and repeats the message of a variant that is not valid.
        for index in (*wrong, *tried):
            if (local := part.local_index(index)) is not None:
                one = variant(case, arrays, index)
                compare(_problem(one), part.packed, local)
                compare(_points(one), part.points, local)
                compare(_inertia(one), part.inertia, local)
    return parts


def _variants(case: Case, columns: Columns, shape: tuple[int, ...], fixed: Mapping[str, object]) -> list[Batch]:
    """Return the batches of the variants over columns, with the fixed values in all of them."""
    whole = tuple(np.arange(n) for n in shape)
    # Numbers are broadcast; values of other kinds, such as a law, divide the grid into groups that are packed for
    # themselves, one path after the other.
    path = next((path for path, values in columns.items() if not is_number(case, path, values)), None)
    if path is None:
        problem, points, inertia = _broadcast(case, columns, len(shape), fixed)
        return [Batch(problem, whole, points, inertia)]
    values = columns[path]
    rest = {other: column for other, column in columns.items() if other != path}
    # A column that varies along no axis is the same in all variants, and is set in the case.
    axis = next((k for k, n in enumerate(values.shape) if n > 1), None)
    if axis is None:
        return _variants(case, rest, shape, {**fixed, path: values.item()})
    groups = group_equal(values, axis)
    batches = []
    for group in groups:
        inside = {other: np.take(c, group, axis) if c.shape[axis] > 1 else c for other, c in rest.items()}
        inside[path] = np.take(values, group[:1], axis)
        batches.append(_variants(case, inside, (*shape[:axis], len(group), *shape[axis + 1 :]), fixed))
    if len(groups) == 1:
        return batches[0]
    obstacle = next((part.obstacle for parts in batches for part in parts if part.obstacle), None)
    # Groups that differ in numbers only are merged again, so that the core gets one batch; laws of different kinds are
    # not.
    if all(len(parts) == 1 for parts in batches):
        try:
            merger = Merger(path, groups, axis, shape)
            problem = merger.merge([part.packed for (part,) in batches])
            points, inertia = (
                merger.merge_points([getattr(part, name) for (part,) in batches]) for name in ("points", "inertia")
            )
            return [Batch(problem, whole, points, inertia)]
        except NotMergeable as error:
            obstacle = error
    return [
        Batch(
            part.packed,
            (*part.indices[:axis], group[part.indices[axis]], *part.indices[axis + 1 :]),
            part.points,
            part.inertia,
            obstacle,
        )
        for group, parts in zip(groups, batches, strict=True)
        for part in parts
    ]


def _broadcast(
    case: Case, columns: Columns, axes: int, fixed: Mapping[str, object]
) -> tuple[_core.Problem, dict[str, NDArray[np.float64]], dict[str, NDArray[np.float64]]]:
    """Pack the variants over columns of numbers; return the problem, the mode shapes at the points and the inertia."""
    # The case with the first value of each column has a field for each array.
    first = {path: values.flat[0].item() for path, values in columns.items()}
    batch = with_columns(replaced(case, {**fixed, **first}), columns)
    try:
        return _problem(batch, axes), _points(batch, axes), _inertia(batch, axes)
    except (TypeError, ValueError) as error:
        if not isinstance(error, CaseError):
            error.add_note("A formula of the model does not accept arrays; see rattlebox.model.elementwise.")
        raise


def pack_columns(case: Case, columns: Columns) -> _core.Problem:
    """Pack the variants over columns of numbers along one axis; the case has a field for each of them."""
    return _problem(with_columns(case, columns), 1)


def shape_columns(case: Case, columns: Columns, point: str) -> NDArray[np.float64]:
    """Return the mode shapes at a point in the variants over columns of numbers, (m, variants)."""
    return _points(with_columns(case, columns), 1)[point]


def with_columns(batch: Case, columns: Columns) -> Case:
    """Return a copy of a case with arrays in place of numbers."""
    # Fields are replaced without validation, which would refuse arrays; lengths that are given in another way are
    # converted here, as validation does for one case.
    cavities: dict[Place, NDArray[Any]] = {}
    for path, values in columns.items():
        place = place_of(batch, path)
        current = part_at(batch, place)
        if place[-1] == "cavity_length":
            cavities[place[:-1]] = values
        elif place[-1] == "diameter":
            batch = with_value(batch, (*place[:-1], "radius"), values / 2)
        elif isinstance(current, Part):  # A number in place of a law is its only coefficient.
            batch = with_value(batch, (*place, "e"), values)
        else:
            batch = with_value(batch, place, (values,) if isinstance(current, tuple) else values)
    for place, length in cavities.items():
        batch = with_value(batch, (*place, "gap"), (length - part_at(batch, place).row) / 2)
    return batch


def _points(case: Case, axes: int = 0) -> dict[str, NDArray[np.float64]]:
    return {name: _vector(shape, axes) for name, shape in case.modes.lines().items()}


def _inertia(case: Case, axes: int = 0) -> dict[str, NDArray[np.float64]]:
    modes = case.modes
    if modes.participation is None or modes.spatial:
        return {}
    participation = _vector(modes.participation, axes)
    effective = np.square(participation).sum(axis=0)
    total = effective if modes.total_mass is None else modes.total_mass
    residual = np.where(np.abs(total - effective) > 1e-9 * np.abs(total), total - effective, 0.0)
    return {"participation": participation, "residual_mass": _vector(residual[None], axes)}


def _problem(case: Case, axes: int = 0) -> _core.Problem:
    """Return the problem without sample times; in a batch over some axes, vectors have these axes last."""
    if case.particle_dampers:
        raise Hint(
            "this study computes impact dampers, not particle dampers",
            "a sweep, a loss map or a sensitivity, or separate runs",
        )
    modes = case.modes
    return _core.Problem(
        settings=_settings(case),
        mode_decay=_vector(modes.decay, axes),
        mode_stiffness=_vector(modes.stiffness, axes),
        mode_coupling=mode_coupling(modes, axes),
        mode_displacement=_vector(modes.q0, axes),
        mode_velocity=_vector(modes.p0, axes),
        loads=_loads(case, modes, axes),
        dampers=[
            _core.Damper(
                clearance=damper.clearance,
                gravity=damper.gravity,
                shape=_vector(modes.shape(damper.point), axes),
                mass=_vector(damper.masses, axes),
                # The case states places in the cavity, the core places relative to the rest position of its centre.
                position=_vector(
                    stacked([place + case.cavity_displacement(damper) for place in damper.positions0]), axes
                ),
                velocity=_vector(damper.velocities0, axes),
            )
            for damper in case.impact_dampers
        ]
        + [_stop(stop, modes, axes) for stop in case.each_stop],
        contacts=[
            _contact_of_balls(case, index, pair, place)
            for index in range(len(case.impact_dampers))
            for place, pair in enumerate(contact_pairs(case, index))
        ]
        + [_contact(case, stop.contact, stop.pair(modes)) for stop in case.each_stop],
        sample_times=np.zeros(0),
    )


def _stop(stop: Stop, modes: ModalModel, axes: int) -> _core.Damper:
    """Pack a stop: a damper without balls, whose shape is positive in the direction that closes the gap."""
    nothing = np.zeros((0, *(1,) * axes))
    return _core.Damper(
        clearance=2 * stop.gap,
        gravity=0.0,
        shape=_vector(stop.sign * stop.shape(modes), axes),
        mass=nothing,
        position=nothing,
        velocity=nothing,
        base=stop.sign if stop.other is None else 0.0,
    )


def mode_coupling(modes: ModalModel, axes: int = 0) -> NDArray[np.float64]:
    """Return the coefficients of damping between modes, row by row; empty for proportional damping."""
    matrix = modes.coupling
    return _vector(np.zeros(0) if matrix is None else matrix.reshape(-1, *matrix.shape[2:]), axes)


def _array(values: object) -> NDArray[np.float64]:
    return np.ascontiguousarray(values, dtype=np.float64)


def _vector(values: object, axes: int) -> NDArray[np.float64]:
    array = _array(values)
    return array.reshape(-1, *(1,) * axes) if axes and array.ndim == 1 else array


def _loads(case: Case, modes: ModalModel, axes: int) -> list[_core.Load]:
    loads = [
        _core.Load(
            signal=pack_signal(signal), shape=_vector(modes.shape(signal.point, signal.direction), axes), base=False
        )
        for signal in case.loads
    ]
    base = [
        _core.Load(signal=pack_signal(signal), shape=_vector(-_participation(modes), axes), base=True)
        for signal in case.base_acceleration()
    ]
    return loads + base


def pack_signal(signal: Signal) -> _core.HalfSine | _core.Harmonic | _core.Record:
    """Pack a load or an acceleration for the core."""
    values = signal.coefficients()
    kind: type[_core.HalfSine | _core.Harmonic | _core.Record] = {
        "half_sine": _core.HalfSine,
        "harmonic": _core.Harmonic,
        "record": _core.Record,
    }[values.pop("kind")]
    return kind(**values)


def _participation(modes: ModalModel) -> NDArray[np.float64]:
    return _array(np.zeros(modes.decay.size) if modes.participation is None else modes.participation)


def _contact_of_balls(case: Case, damper_index: int, pair: Pair, place: int) -> _core.Contact:
    damper = case.impact_dampers[damper_index]
    between_balls = 0 < place < len(damper.balls)
    law = damper.ball_contact if between_balls and damper.ball_contact is not None else damper.contact
    return _contact(case, law, pair)


def _contact(case: Case, law: Contact, pair: Pair) -> _core.Contact:
    hard = case.method.hard_restitution(law, pair)
    if hard is None:
        rebound = law.impact_restitution
        normal = _core.normal_law(*law.coefficients(pair))
    else:  # the core does not read the force of impacts that take no time
        rebound = _hard(hard)
        normal = _core.LinearForce(stiffness=1.0, mass=pair.mass, damping=0.0, zero_overlap=0.0, fixed_contact_time=0.0)
    return _core.Contact(mass=pair.mass, normal=normal, restitution=pack_restitution(rebound, pair))


def _hard(equivalent: Restitution | FixedDamping) -> Restitution:
    """Return the restitution law of hard impacts that is equivalent to a contact."""
    if not isinstance(equivalent, FixedDamping):
        return equivalent
    e: Any = restitution_of_alpha(math.sqrt(5) * equivalent.ratio, equivalent.ending)
    return Constant(float(e)) if e.ndim == 0 else Constant.model_construct(e=e)


def _settings(case: Case) -> _core.Settings:
    name, values = instance(case.method, ImpactMethod).settings()
    return _core.Settings(method=_core.Method[name], duration=case.duration, **values)
