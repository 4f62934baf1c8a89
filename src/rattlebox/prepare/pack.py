"""Case -> the problem that the 1-D engine runs, in SI units.

Many variants of a case are packed at once: arrays that broadcast against each other stand in place of numbers in a copy of
the case, which the same formulas pack. Values that are no numbers, and entries of tables, cannot be arrays: each of them
makes a case of its own. The problems are merged into one batch, or stay apart where they differ in more than numbers.
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
from rattlebox.model.contacts import FixedDamping
from rattlebox.model.errors import Hint
from rattlebox.model.methods import EventDriven, Newton, TwoStep
from rattlebox.model.pairs import Pair, contact_pairs
from rattlebox.model.paths import Place, part_at, place_of, replaced
from rattlebox.model.restitutions import Constant
from rattlebox.prepare.laws import packed_restitution, restitution_of_alpha
from rattlebox.prepare.variants import (
    Columns,
    Index,
    Joint,
    Unlike,
    alike,
    column,
    compare,
    examples,
    is_number,
    misplaced,
    variant,
    with_value,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rattlebox.model.case import Case
    from rattlebox.model.modes import ModalModel
    from rattlebox.model.restitutions import Restitution
    from rattlebox.model.signals import Signal

MOST_EVENTS = 200_000
"""Most events of a run that is sampled at its contacts, too, unless the output times are chosen."""


def pack(case: Case) -> _core.Problem:
    """Pack a case for the core.

    Parameters
    ----------
    case
        The case.

    Returns
    -------
    Problem
        Modes, loads, dampers, contacts, sample times and settings.
    """
    problem = _problem(case)
    settings = problem.settings.replace(contact_samples=0 if case.output.is_chosen else MOST_EVENTS)
    return problem.replace(settings=settings, sample_times=_array(case.sample_times()))


@dataclass(frozen=True)
class Batch:
    """Variants of a grid that differ in numbers only, packed.

    Attributes
    ----------
    packed
        The problem, with arrays over the grid of these variants.
    places
        Indices along each dimension of the whole grid, rising.
    points
        Mode shapes at each point of the structure, (m, ...) over the grid.
    unlike
        Why it is not all of the grid, if it is not.
    """

    packed: _core.Problem
    places: tuple[NDArray[np.intp], ...]
    points: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    unlike: Unlike | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of its grid."""
        return tuple(len(place) for place in self.places)

    def index(self, inside: Index) -> Index:
        """Return where a variant of the batch is in the whole grid."""
        return tuple(int(place[i]) for place, i in zip(self.places, inside, strict=True))

    def inside(self, index: Index) -> Index | None:
        """Return where a variant of the whole grid is in the batch, if it is there."""
        found = tuple(int(np.searchsorted(place, i)) for place, i in zip(self.places, index, strict=True))
        there = all(k < len(place) and place[k] == i for place, i, k in zip(self.places, index, found, strict=True))
        return found if there else None

    def numbers(self, shape: Sequence[int]) -> NDArray[np.intp]:
        """Return the numbers of its variants in a whole grid of some shape, rising."""
        return np.ravel_multi_index(np.ix_(*self.places), tuple(shape)).ravel()


def pack_batch(case: Case, columns: Mapping[str, Any], shape: Sequence[int]) -> _core.Problem:
    """Pack many variants of a case for the core.

    Parameters
    ----------
    case
        The case that the variants are made from.
    columns
        By path, "damper.gap": the values, an array with as many axes as `shape` and broadcastable to it. Numbers in SI;
        anything else, such as names of materials, laws or lists, as objects.
    shape
        Shape of the grid of variants.

    Returns
    -------
    Problem
        As `pack` returns it, but each number may be an array that broadcasts to `shape`, and each vector has these axes
        after its own, (n, ...). There are no sample times.

    Raises
    ------
    CaseError
        When a variant does not fit, or variants differ in more than numbers: in kinds of laws, in how many balls there are.
    """
    first, *others = pack_parts(case, columns, shape)
    if others and first.unlike:
        raise first.unlike
    return first.packed


def pack_parts(case: Case, columns: Mapping[str, Any], shape: Sequence[int]) -> list[Batch]:
    """Pack many variants of a case for the core, in parts that differ in numbers only.

    Some of them, the extreme ones among them, are packed one by one as well and compared.

    Parameters
    ----------
    case, columns, shape
        As of `pack_batch`.

    Raises
    ------
    CaseError
        When a variant does not fit.
    """
    given = {path: column(path, values, shape) for path, values in columns.items()}
    parts = _variants(case, given, tuple(shape), {})
    tried = examples(given, shape)
    for part in parts:
        wrong = [part.index(inside) for inside in misplaced(part.packed, part.shape)]
        for index in (*wrong, *tried):
            if (inside := part.inside(index)) is not None:
                one = variant(case, given, index)
                compare(_problem(one), part.packed, inside)
                compare(_points(one), part.points, inside)
    return parts


def _variants(case: Case, columns: Columns, shape: tuple[int, ...], fixed: Mapping[str, Any]) -> list[Batch]:
    """The variants over columns, with fixed values besides."""
    whole = tuple(np.arange(n) for n in shape)
    path = next((path for path, values in columns.items() if not is_number(case, path, values)), None)
    if path is None:
        problem, points = _broadcast(case, columns, len(shape), fixed)
        return [Batch(problem, whole, points)]
    values = columns[path]
    rest = {other: column for other, column in columns.items() if other != path}
    axis = next((k for k, n in enumerate(values.shape) if n > 1), None)
    if axis is None:
        return _variants(case, rest, shape, {**fixed, path: values.item()})
    groups = alike(values, axis)
    found = []
    for group in groups:
        inside = {other: np.take(c, group, axis) if c.shape[axis] > 1 else c for other, c in rest.items()}
        inside[path] = np.take(values, group[:1], axis)
        found.append(_variants(case, inside, (*shape[:axis], len(group), *shape[axis + 1 :]), fixed))
    if len(groups) == 1:
        return found[0]
    unlike = next((part.unlike for parts in found for part in parts if part.unlike), None)
    if all(len(parts) == 1 for parts in found):
        try:
            joint = Joint(path, groups, axis, shape)
            problem = joint.of([part.packed for (part,) in found])
            return [Batch(problem, whole, joint.points([part.points for (part,) in found]))]
        except Unlike as told:
            unlike = told
    return [
        Batch(
            part.packed, (*part.places[:axis], group[part.places[axis]], *part.places[axis + 1 :]), part.points, unlike
        )
        for group, parts in zip(groups, found, strict=True)
        for part in parts
    ]


def _broadcast(
    case: Case, columns: Columns, axes: int, fixed: Mapping[str, Any]
) -> tuple[_core.Problem, dict[str, NDArray[np.float64]]]:
    """The variants over columns of numbers, and the mode shapes at their points."""
    first = {path: values.flat[0].item() for path, values in columns.items()}
    batch = replaced(case, {**fixed, **first})  # where each number has its place
    cavities: dict[Place, NDArray[Any]] = {}
    for path, values in columns.items():
        place = place_of(batch, path)
        held = part_at(batch, place)
        if place[-1] == "cavity_length":
            cavities[place[:-1]] = values
        elif place[-1] == "diameter":
            batch = with_value(batch, (*place[:-1], "radius"), values / 2)
        elif isinstance(held, Part):  # a number for a law: its only coefficient
            batch = with_value(batch, (*place, "e"), values)
        else:
            batch = with_value(batch, place, (values,) if isinstance(held, tuple) else values)
    for place, length in cavities.items():
        batch = with_value(batch, (*place, "gap"), (length - part_at(batch, place).row) / 2)
    try:
        return _problem(batch, axes), _points(batch, axes)
    except (TypeError, ValueError) as error:
        if not isinstance(error, CaseError):
            error.add_note("A formula does not take arrays: see rattlebox.model.elementwise.")
        raise


def _points(case: Case, axes: int = 0) -> dict[str, NDArray[np.float64]]:
    return {name: _vector(shape, axes) for name, shape in case.modes.lines().items()}


def _problem(case: Case, axes: int = 0) -> _core.Problem:
    """The problem without sample times; vectors of a batch over some axes have these after their own."""
    if case.particle_dampers:
        raise Hint(
            "this study computes impact dampers, not particles in space",
            "a sweep, a loss map or a sensitivity, or one run after the other",
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
                position=_vector(damper.positions0, axes),
                velocity=_vector(damper.velocities0, axes),
            )
            for damper in case.impact_dampers
        ],
        contacts=[
            _contact(case, index, pair, place)
            for index in range(len(case.dampers))
            for place, pair in enumerate(contact_pairs(case, index))
        ],
        sample_times=np.zeros(0),
    )


def mode_coupling(modes: ModalModel, axes: int = 0) -> NDArray[np.float64]:
    """Return the damping between modes, row by row; empty for proportional damping."""
    matrix = modes.coupling
    return _vector(np.zeros(0) if matrix is None else matrix.reshape(-1, *matrix.shape[2:]), axes)


def _array(values: Any) -> NDArray[np.float64]:
    return np.ascontiguousarray(values, dtype=np.float64)


def _vector(values: Any, axes: int) -> NDArray[np.float64]:
    array = _array(values)
    return array.reshape(-1, *(1,) * axes) if axes and array.ndim == 1 else array


def _loads(case: Case, modes: ModalModel, axes: int) -> list[_core.Load]:
    loads = [
        _core.Load(
            signal=packed_signal(signal), shape=_vector(modes.shape(signal.point, signal.direction), axes), base=False
        )
        for signal in case.loads
    ]
    base = [
        _core.Load(signal=packed_signal(signal), shape=_vector(-_participation(modes), axes), base=True)
        for signal in case.base_acceleration()
    ]
    return loads + base


def packed_signal(signal: Signal) -> _core.HalfSine | _core.Harmonic | _core.Record:
    """Return a load or an acceleration as the core reads it."""
    values = signal.coefficients()
    kind: type[_core.HalfSine | _core.Harmonic | _core.Record] = {
        "half_sine": _core.HalfSine,
        "harmonic": _core.Harmonic,
        "record": _core.Record,
    }[values.pop("kind")]
    return kind(**values)


def _participation(modes: ModalModel) -> NDArray[np.float64]:
    return _array(np.zeros(modes.decay.size) if modes.participation is None else modes.participation)


def _contact(case: Case, damper_index: int, pair: Pair, place: int) -> _core.Contact:
    damper = case.impact_dampers[damper_index]
    between_balls = 0 < place < len(damper.balls)
    law = damper.ball_contact if between_balls and damper.ball_contact is not None else damper.contact
    if isinstance(case.method, Newton):
        rebound: Restitution | None = case.method.restitution or _hard(law.equivalent_restitution(pair))
        normal: _core.NormalForce = _core.LinearForce(
            stiffness=1.0, mass=pair.mass, damping=0.0, zero_overlap=0.0, fixed_contact_time=0.0
        )
    else:
        rebound = law.impact_restitution
        normal = _core.normal_law(*law.coefficients(pair))
    return _core.Contact(mass=pair.mass, normal=normal, restitution=packed_restitution(rebound, pair))


def _hard(equivalent: Restitution | FixedDamping) -> Restitution:
    """Return the restitution law of hard impacts."""
    if not isinstance(equivalent, FixedDamping):
        return equivalent
    e: Any = restitution_of_alpha(math.sqrt(5) * equivalent.ratio, equivalent.ending)
    return Constant(float(e)) if e.ndim == 0 else Constant.model_construct(e=e)


def _settings(case: Case) -> _core.Settings:
    method = case.method
    if isinstance(method, TwoStep):
        return _core.Settings(
            method=_core.Method.two_step,
            duration=case.duration,
            dt_flight=method.dt_flight,
            dt_contact=method.dt_contact,
            adaptive_inner=method.inner == "dopri5",
        )
    if isinstance(method, Newton):
        return _core.Settings(
            method=_core.Method.newton, duration=case.duration, stick=method.stick, max_events=method.max_events
        )
    method = instance(method, EventDriven)
    return _core.Settings(
        method=_core.Method.event_driven,
        duration=case.duration,
        tolerance=method.tolerance,
        max_events=method.max_events,
        collocation=method.collocation,
    )
