"""The plain arrays of a run, as an engine fills them.

Frames and signs: everything moves on one line, and all motion is relative to the base. Balls of a damper are
numbered along the positive direction, and so are its contacts: 0 is the trailing wall, `k` lies between balls
`k` and `k + 1` (counted from 1), and the last is the leading wall.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from .schema import CHANNELS, IMPACT, IMPACT_VARIABLES, RUN_VARIABLES, Form, Kind, Variable

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_DTYPES: dict[Kind, Any] = {"float": np.float64, "int": np.int64, "bool": np.bool_}
_ABSENT = np.zeros(0)
_INCIDENTAL = {"wall_time", "memory_bytes"}
"""Fields and counts that tell how a run was computed, not what came out: they differ when the same case is run again."""


def _absent() -> Any:
    return _ABSENT


def _checked(variable: Variable, value: Any, sizes: Mapping[str, int]) -> NDArray[Any]:
    """Return `value` as a read-only array of the variable's type, zeros where it was left out."""
    shape = tuple(sizes[dim] for dim in variable.dims)
    dtype = np.dtype(_DTYPES[variable.kind])
    if value is _ABSENT:
        array: NDArray[Any] = np.zeros(shape, dtype)
    else:
        given = np.asarray(value)
        if not np.can_cast(given.dtype, dtype, "same_kind") and given.size:
            raise TypeError(f"{variable.name} holds {given.dtype}, but {dtype} is needed")
        array = np.ascontiguousarray(given, dtype).view()
    if array.shape != shape:
        names = ", ".join(variable.dims)
        raise ValueError(f"{variable.name} has shape {array.shape}, but ({names}) is {shape}")
    array.flags.writeable = False
    return array


def checked_arrays(holder: Any, variables: Sequence[Variable], sizes: Mapping[str, int]) -> dict[str, NDArray[Any]]:
    """Read-only arrays of the variables' types and shapes, by name; zeros where one was left out."""
    return {v.name: _checked(v, getattr(holder, v.name), sizes) for v in variables}


def checked_time(times: Any) -> FloatArray:
    """Output times as a read-only array; they must increase."""
    time = np.ascontiguousarray(times, np.float64).view()
    if time.ndim != 1 or time.size == 0:
        raise ValueError(f"time has shape {time.shape}, but (T,) with at least one time is needed")
    if not np.all(np.isfinite(time)) or np.any(np.diff(time) <= 0):
        raise ValueError("output times must be finite and strictly increasing")
    time.flags.writeable = False
    return time


def checked_labels(name: str, given: Any) -> tuple[str, ...]:
    """Labels as texts; they must differ."""
    labels = tuple(str(label) for label in given)
    if len(set(labels)) != len(labels) or "" in labels or any("\0" in label for label in labels):
        raise ValueError(f"{name} {labels} must be different and not empty")
    return labels


def checked_counts(given: Mapping[str, int]) -> Mapping[str, int]:
    """Counts by identifiers, read-only."""
    counts = {str(name): int(number) for name, number in given.items()}
    for name in counts:
        if not name.isidentifier():
            raise ValueError(f"count {name!r} is not an identifier")
    return MappingProxyType(counts)


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        names = a.keys() - _INCIDENTAL
        return names == b.keys() - _INCIDENTAL and all(_same(a[name], b[name]) for name in names)
    if isinstance(a, (np.ndarray, float)) and isinstance(b, (np.ndarray, float)):
        return np.array_equal(a, b, equal_nan=np.asarray(a).dtype.kind == "f")
    return bool(a == b)


class _Comparable:
    """Equality by value of every field but the incidental ones; NaN equals NaN."""

    def __eq__(self, other: object) -> bool:
        return _same(vars(self), vars(other)) if type(other) is type(self) else NotImplemented

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, kw_only=True, eq=False)
class ImpactArrays(_Comparable):
    """The impact log: one entry for each contact that closed, in the order of first touch.

    Attributes
    ----------
    damper : (I,) int
        Damper, counted from 0.
    contact : (I,) int
        Contact in the row of that damper: 0 is the trailing wall, `n` (number of its balls) the leading
        wall, `k` between them the contact of balls `k` and `k + 1`, counted from 1.
    time : (I,) float
        Time of first touch [s].
    approach_speed : (I,) float
        Approach speed at first touch [m/s].
    restitution : (I,) float
        Coefficient of restitution that the law returned; NaN where the law has none.
    separation_speed : (I,) float
        Speed of separation at the end of the contact [m/s].
    duration : (I,) float
        Duration of the contact [s].
    peak_overlap : (I,) float
        Largest overlap [m].
    peak_force : (I,) float
        Largest contact force [N].
    energy_lost : (I,) float
        Energy lost in the contact [J].
    complete : (I,) bool
        True where the contact opened before the run ended.

    Raises
    ------
    ValueError
        When the arrays differ in length.
    TypeError
        When an array holds the wrong kind of numbers.
    """

    damper: IntArray = field(default_factory=_absent)
    contact: IntArray = field(default_factory=_absent)
    time: FloatArray = field(default_factory=_absent)
    approach_speed: FloatArray = field(default_factory=_absent)
    restitution: FloatArray = field(default_factory=_absent)
    separation_speed: FloatArray = field(default_factory=_absent)
    duration: FloatArray = field(default_factory=_absent)
    peak_overlap: FloatArray = field(default_factory=_absent)
    peak_force: FloatArray = field(default_factory=_absent)
    energy_lost: FloatArray = field(default_factory=_absent)
    complete: BoolArray = field(default_factory=_absent)

    def __post_init__(self) -> None:
        sizes = {"impact": np.asarray(self.time).size}
        for variable in IMPACT_VARIABLES:
            value = getattr(self, variable.name)
            if value is _ABSENT and sizes["impact"]:
                raise ValueError(f"{variable.name} of the impacts is missing")
            object.__setattr__(self, variable.name, _checked(variable, value, sizes))

    def __len__(self) -> int:
        return int(self.time.size)

    def __reduce__(self) -> tuple[Any, ...]:
        return (_rebuild_impacts, ({f.name: getattr(self, f.name) for f in fields(self)},))


@dataclass(frozen=True, kw_only=True, eq=False)
class RunArrays(_Comparable):
    """Everything an engine computed in one run, in SI units.

    Sizes: T times, P points, B balls (of all dampers, damper after damper), D dampers, L loads, m modes.
    Fields left out are zero. Arrays become read-only; equality compares every value but the computing time, NaN equals NaN.

    Attributes
    ----------
    time : (T,) float
        Output times, strictly increasing [s].
    points, balls, dampers, loads : tuple of str
        Names; a ball is named "damper/number".
    displacement, velocity : (T, P) float
        Motion of the structure's points relative to the base [m], [m/s].
    ball_damper : (B,) int
        Damper of each ball, counted from 0.
    ball_centre : (B,) float
        Place of the ball's centre from the cavity's centre in the packed, centred row [m].
    clearance : (D,) float
        Total clearance of each cavity [m]; ball positions span `ball_centre` plus or minus half of it.
    ball_position, ball_velocity : (T, B) float
        Ball centre from the cavity centre's place at rest [m], and its velocity [m/s], relative to the base.
    relative_position, relative_velocity : (T, B) float
        The same relative to the moving cavity's centre [m], [m/s].
    base_displacement, base_velocity, base_acceleration : (T,) float
        Motion of the base [m], [m/s], [m/s^2].
    cavity_force : (T, D) float
        Force of the balls on the cavity [N].
    load : (T, L) float
        Load forces [N].
    mode_frequency : (m,) float
        Natural frequencies [Hz].
    mode_energy : (T, m) float
        Kinetic and elastic energy of each mode [J].
    ball_energy : (T, B) float
        Kinetic energy of each ball relative to the base [J].
    contact_energy, gravity_energy : (T, D) float
        Elastic energy of the contacts and gravity potential of the balls [J].
    load_work, base_work : (T,) float
        Work done since the start by the loads and by the inertial forces of the base motion [J].
    viscous_loss : (T,) float
        Energy lost since the start in the structure's damping [J].
    normal_loss, plastic_loss : (T, D) float
        Energy lost since the start in impacts: by damping, clipping or hard impacts; by plastic flow [J].
    impacts : ImpactArrays
        The impact log.
    status : str
        "finished", or the reason why the run ended early.
    message : str
        One sentence that explains the status and says what to try.
    counts : mapping of str to int
        Numbers of events and steps, by name (an identifier).
    notes : tuple of str
        Warnings.
    wall_time : float
        Computing time [s].

    Raises
    ------
    ValueError
        When a shape does not fit, times do not increase, or a label is not what it should be.
    TypeError
        When an array holds the wrong kind of numbers.
    """

    form: ClassVar[Form] = IMPACT
    channels: ClassVar[tuple[str, ...]] = CHANNELS

    time: FloatArray
    points: tuple[str, ...] = ()
    balls: tuple[str, ...] = ()
    dampers: tuple[str, ...] = ()
    loads: tuple[str, ...] = ()
    displacement: FloatArray = field(default_factory=_absent)
    velocity: FloatArray = field(default_factory=_absent)
    ball_damper: IntArray = field(default_factory=_absent)
    ball_centre: FloatArray = field(default_factory=_absent)
    clearance: FloatArray = field(default_factory=_absent)
    ball_position: FloatArray = field(default_factory=_absent)
    ball_velocity: FloatArray = field(default_factory=_absent)
    relative_position: FloatArray = field(default_factory=_absent)
    relative_velocity: FloatArray = field(default_factory=_absent)
    base_displacement: FloatArray = field(default_factory=_absent)
    base_velocity: FloatArray = field(default_factory=_absent)
    base_acceleration: FloatArray = field(default_factory=_absent)
    cavity_force: FloatArray = field(default_factory=_absent)
    load: FloatArray = field(default_factory=_absent)
    mode_frequency: FloatArray = field(default_factory=_absent)
    mode_energy: FloatArray = field(default_factory=_absent)
    ball_energy: FloatArray = field(default_factory=_absent)
    contact_energy: FloatArray = field(default_factory=_absent)
    gravity_energy: FloatArray = field(default_factory=_absent)
    load_work: FloatArray = field(default_factory=_absent)
    base_work: FloatArray = field(default_factory=_absent)
    viscous_loss: FloatArray = field(default_factory=_absent)
    normal_loss: FloatArray = field(default_factory=_absent)
    plastic_loss: FloatArray = field(default_factory=_absent)
    impacts: ImpactArrays = field(default_factory=ImpactArrays)
    status: str = "finished"
    message: str = ""
    counts: Mapping[str, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    wall_time: float = 0.0

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "time", checked_time(self.time))
        for name in ("points", "balls", "dampers", "loads"):
            put(self, name, checked_labels(name, getattr(self, name)))
        modes = np.size(self.mode_frequency)
        sizes = {
            "time": self.time.size,
            "point": len(self.points),
            "ball": len(self.balls),
            "damper": len(self.dampers),
            "source": len(self.loads),
            "mode": modes,
        }
        for name, array in checked_arrays(self, RUN_VARIABLES, sizes).items():
            put(self, name, array)
        self._check_references(sizes["damper"])
        put(self, "counts", checked_counts(self.counts))
        put(self, "notes", tuple(self.notes))
        put(self, "wall_time", float(self.wall_time))

    def _check_references(self, dampers: int) -> None:
        for name, index in (
            ("ball_damper", self.ball_damper),
            ("damper of the impacts", self.impacts.damper),
        ):
            if index.size and (index.min() < 0 or index.max() >= dampers):
                raise ValueError(f"{name} names a damper outside 0..{dampers - 1}")
        if np.any(np.diff(self.ball_damper) < 0):
            raise ValueError("ball_damper must not decrease: balls come damper after damper")
        last = np.bincount(self.ball_damper, minlength=max(dampers, 1))[self.impacts.damper]
        contact = self.impacts.contact
        if np.any(contact < 0) or np.any(contact > last):
            raise ValueError("a contact of the impacts lies outside its row")

    @property
    def modes(self) -> IntArray:
        """Numbers of the modes, from 1."""
        return np.arange(1, self.mode_frequency.size + 1)

    def contact_names(self, damper: int) -> tuple[str, ...]:
        """Names of the contacts of a damper, in the order of the impact log's `contact`.

        Parameters
        ----------
        damper
            Damper, counted from 0.
        """
        balls = int(np.count_nonzero(self.ball_damper == damper))
        between = (f"ball {k} - ball {k + 1}" for k in range(1, balls))
        return ("trailing wall", *between, "leading wall") if balls else ()

    def __reduce__(self) -> tuple[Any, ...]:
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        values["counts"] = dict(self.counts)
        return (_rebuild, (values,))


def _rebuild(values: dict[str, Any]) -> RunArrays:
    return RunArrays(**values)


def _rebuild_impacts(values: dict[str, Any]) -> ImpactArrays:
    return ImpactArrays(**values)
