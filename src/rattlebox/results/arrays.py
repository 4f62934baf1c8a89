"""The plain arrays of a run, as an engine fills them; `schema.py` declares them.

Frames and signs: all motion is relative to the base. Balls of a damper move on one line and are numbered along the
positive direction, and so are their contacts: 0 is the trailing wall, `k` lies between balls `k` and `k + 1` (counted
from 1), and the last is the leading wall.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, NoReturn, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rattlebox._util.exceptions import message

from .schema import (
    AXES,
    BOTH,
    LINE,
    PARTNERS,
    Engine,
    Kind,
    Variable,
    channels,
    dimensions,
    explain_absence,
    groups,
    variables,
)

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_DTYPES: dict[Kind, Any] = {"float": np.float64, "int": np.int64, "bool": np.bool_}


def same(a: object, b: object) -> bool:
    """Return whether two values are equal to the last bit, where NaN equals NaN."""
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(same(a[name], b[name]) for name in a)
    if isinstance(a, (np.ndarray, float)) and isinstance(b, (np.ndarray, float)):
        return np.array_equal(a, b, equal_nan=np.asarray(a).dtype.kind == "f")
    return bool(a == b)


def _as_array(variable: Variable, values: ArrayLike | None, sizes: Mapping[str, int]) -> NDArray[Any]:
    """Return values as a read-only array of the variable's type; zeros if they are None."""
    shape = tuple(sizes[dim] for dim in variable.dims)
    dtype = np.dtype(_DTYPES[variable.kind])
    if values is None:
        array: NDArray[Any] = np.zeros(shape, dtype)
    else:
        source = np.asarray(values)
        flags = variable.kind == "bool" and source.dtype.kind in "iu"
        if not flags and not np.can_cast(source.dtype, dtype, "same_kind") and source.size:
            raise TypeError(f"{variable.name} holds {source.dtype}, but {dtype} is needed")
        array = np.ascontiguousarray(source, dtype).view()
    if array.shape != shape:
        names = ", ".join(variable.dims)
        raise ValueError(f"{variable.name} has shape {array.shape}, but ({names}) is {shape}")
    array.flags.writeable = False
    return array


def _as_time(times: ArrayLike) -> FloatArray:
    """Return output times as a read-only array; they must increase."""
    time = np.ascontiguousarray(times, np.float64).view()
    if time.ndim != 1 or time.size == 0:
        raise ValueError(f"time has shape {time.shape}, but (T,) with at least one time is needed")
    if not np.all(np.isfinite(time)) or np.any(np.diff(time) <= 0):
        raise ValueError("output times must be finite and strictly increasing")
    time.flags.writeable = False
    return time


def _as_labels(name: str, values: Iterable[object]) -> tuple[str, ...]:
    """Return labels as strings; raise unless they are different and not empty."""
    labels = tuple(str(label) for label in values)
    if len(set(labels)) != len(labels) or "" in labels or any("\0" in label for label in labels):
        raise ValueError(f"{name} {labels} must be different and not empty")
    return labels


class _Frozen:
    """Base class of read-only collections of arrays, which compare by value."""

    def __setattr__(self, name: str, value: object) -> None:
        complaint = f"{name} cannot be set because results are read-only"
        raise AttributeError(message(complaint, f"replaced({name}=...), which returns a copy"))

    def __eq__(self, other: object) -> bool:
        return same(vars(self), vars(other)) if type(other) is type(self) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuild, (type(self), dict(vars(self)))

    def replaced(self, **changes: Any) -> Self:
        """Return a copy with some values replaced."""
        return type(self)(**{**vars(self), **changes})


def _rebuild(cls: type[Any], values: dict[str, Any]) -> Any:
    return cls(**values)


class Table(_Frozen):
    """Read-only columns of equal length, one row for each impact or particle.

    `schema.VARIABLES` lists the columns of each group.

    Parameters
    ----------
    **columns : (N,) or (N, 3)
        All columns of the group; none for a table without rows.
    """

    group: str
    engine: Engine
    # For editors and type checkers; a table has the columns of its group.
    damper: IntArray
    contact: IntArray
    time: FloatArray
    approach_speed: FloatArray
    restitution: FloatArray
    separation_speed: FloatArray
    duration: FloatArray
    peak_overlap: FloatArray
    peak_force: FloatArray
    energy_lost: FloatArray
    complete: BoolArray
    position: FloatArray
    velocity: FloatArray
    spin: FloatArray
    radius: FloatArray
    mass: FloatArray
    species: IntArray

    def __init__(self, group: str, engine: Engine, **columns: ArrayLike) -> None:
        along = groups(engine)[group].along
        rows = len(np.asarray(next(iter(columns.values())))) if columns else 0
        sizes = {along: rows, "axis": len(AXES)}
        vars(self).update(group=group, engine=engine)
        for variable in variables(engine, group):
            values = columns.pop(variable.name, None)
            if values is None and rows:
                raise ValueError(f"{variable.name} of the {group} is missing")
            vars(self)[variable.name] = _as_array(variable, values, sizes)
        if columns:
            raise TypeError(f"{group} have no {', '.join(columns)}")

    def __len__(self) -> int:
        first = variables(self.engine, self.group)[0]
        return len(vars(self)[first.name])

    if not TYPE_CHECKING:  # with it any name would be an attribute

        def __getattr__(self, name: str) -> NoReturn:
            known = [key for key in vars(self) if key not in ("group", "engine")]
            raise AttributeError(f"there is no column {name!r}; there are {', '.join(known)}")


class RunArrays(_Frozen):
    """All arrays of one run, in SI units, as attributes; `schema.VARIABLES` lists their names, dimensions and units.

    Dimensions: T times, P points, B balls (of all dampers, damper after damper), D dampers and behind them S stops, L loads,
    M modes, three axes, two contact partners (another particle, the wall), W walls of all cavities if they are recorded.
    Variables that are left out are zero. Arrays are read-only; equality compares every value, NaN equals NaN.

    Parameters
    ----------
    time : (T,) array_like
        Output times, strictly increasing [s].
    line : str
        Name of the axis of a 1-D run: the direction of the base motion, or "line".
    """

    engine: Engine
    time: FloatArray
    points: tuple[str, ...]
    balls: tuple[str, ...]
    dampers: tuple[str, ...]
    loads: tuple[str, ...]
    stops: tuple[str, ...]
    line: str
    walls: tuple[str, ...]
    impacts: Table
    particles: Table
    # For editors and type checkers; a run has the variables of its engine.
    displacement: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    absolute_acceleration: FloatArray
    modal_displacement: FloatArray
    modal_velocity: FloatArray
    interface_force: FloatArray
    ball_position: FloatArray
    ball_velocity: FloatArray
    relative_position: FloatArray
    relative_velocity: FloatArray
    cavity_force: FloatArray
    stop_gap: FloatArray
    stop_impulse: FloatArray
    base_displacement: FloatArray
    base_velocity: FloatArray
    base_acceleration: FloatArray
    load: FloatArray
    ball_damper: IntArray
    ball_centre: FloatArray
    clearance: FloatArray
    mode_frequency: FloatArray
    mode_energy: FloatArray
    ball_energy: FloatArray
    contact_energy: FloatArray
    gravity_energy: FloatArray
    load_work: FloatArray
    base_work: FloatArray
    viscous_loss: FloatArray
    normal_loss: FloatArray
    plastic_loss: FloatArray
    cavity_displacement: FloatArray
    cavity_velocity: FloatArray
    cavity_moment: FloatArray
    centre_of_mass: FloatArray
    momentum: FloatArray
    cavity_angle: FloatArray
    cavity_speed: FloatArray
    drive_torque: FloatArray
    drive_work: FloatArray
    turning_force: FloatArray
    contacts: IntArray
    particle_mass: FloatArray
    kinetic_energy: FloatArray
    rotation_energy: FloatArray
    sliding_loss: FloatArray
    rolling_loss: FloatArray
    wall_force: FloatArray
    wall_moment: FloatArray
    wall_normal_force: FloatArray
    wall_impulse: FloatArray
    wall_normal_impulse: FloatArray
    wall_impacts: IntArray
    wall_damper: IntArray
    wall_area: FloatArray
    wall_normal_loss: FloatArray
    wall_plastic_loss: FloatArray
    wall_sliding_loss: FloatArray
    wall_rolling_loss: FloatArray

    def __init__(
        self,
        *,
        time: ArrayLike,
        engine: Engine = "impact",
        points: tuple[str, ...] = (),
        balls: tuple[str, ...] = (),
        dampers: tuple[str, ...] = (),
        loads: tuple[str, ...] = (),
        stops: tuple[str, ...] = (),
        line: str = LINE,
        walls: tuple[str, ...] = (),
        **values: Any,
    ) -> None:
        if engine not in BOTH:
            raise ValueError(f"there is no engine {engine!r}; there are {', '.join(BOTH)}")
        fields = vars(self)
        fields.update(engine=engine, time=_as_time(time), line=line)
        names = {"points": points, "balls": balls, "dampers": dampers, "loads": loads, "stops": stops, "walls": walls}
        for name, labels in names.items():
            fields[name] = _as_labels(name, labels)
        sizes = {
            "time": self.time.size,
            "point": len(self.points),
            "ball": len(self.balls),
            "damper": len(self.dampers),
            "source": len(self.loads),
            "stop": len(self.stops),
            "wall": len(self.walls),
            "mode": np.size(values.get("mode_frequency", ())),
            "axis": len(AXES),
            "partner": len(PARTNERS),
        }
        for group in groups(engine).values():
            if group.along == "time":
                for v in variables(engine, group.name):
                    if not v.derived and ("wall" not in v.dims or self.walls):
                        fields[v.name] = _as_array(v, values.pop(v.name, None), sizes)
            else:
                table = values.pop(group.name, {})
                fields[group.name] = table if isinstance(table, Table) else Table(group.name, engine, **table)
        # What is left has a name that runs of this engine do not have.
        for name in values:
            raise TypeError(explain_absence(name, engine))
        self._check_references()

    def _check_references(self) -> None:
        """Raise if an index names a damper or a contact that does not exist."""
        dampers = len(self.dampers)
        indices = {name: vars(self).get(name) for name in ("ball_damper", "wall_damper")}
        for name in ("impacts", "particles"):
            if name in self:
                indices[f"damper of the {name}"] = vars(self)[name].damper
        for name, index in indices.items():
            if index is not None and index.size and (index.min() < 0 or index.max() >= dampers):
                raise ValueError(f"{name} names a damper outside 0..{dampers - 1}")
        if "impacts" not in self:
            return
        if np.any(np.diff(self.ball_damper) < 0):
            raise ValueError("ball_damper must not decrease: balls come damper after damper")
        # A row of n balls has n + 1 contacts, from wall to wall, and a stop has one.
        last = np.bincount(self.ball_damper, minlength=max(dampers, 1))[self.impacts.damper]
        contact = self.impacts.contact
        if np.any(contact < 0) or np.any(contact > last):
            raise ValueError("a contact of the impacts lies outside its row")

    def __contains__(self, name: object) -> bool:
        """Return whether the run has a variable or a table of that name."""
        return name in vars(self)

    if not TYPE_CHECKING:  # with it any name would be an attribute

        def __getattr__(self, name: str) -> NoReturn:
            raise AttributeError(explain_absence(name, vars(self).get("engine", "impact")))

    @property
    def labels(self) -> dict[str, tuple[str, ...] | NDArray[Any]]:
        """Coordinates by dimension: times, labels, and numbers of modes (from 1) and particles (from 0)."""
        known: dict[str, tuple[str, ...] | NDArray[Any]] = {
            "time": self.time,
            "point": self.points,
            "ball": self.balls,
            "damper": self.dampers,
            "source": self.loads,
            "stop": self.stops,
            "wall": self.walls,
            "mode": np.arange(1, self.mode_frequency.size + 1),
            "axis": AXES,
            "partner": PARTNERS,
            "channel": channels(self.engine),
        }
        if "particles" in self:
            known["particle"] = np.arange(len(self.particles))
        return {dim: values for dim, values in known.items() if dim in dimensions(self.engine)}

    def contact_names(self, damper: int) -> tuple[str, ...]:
        """Return the names of the contacts of a damper, in the order of the impact log's `contact`."""
        balls = int(np.count_nonzero(self.ball_damper == damper))
        between = (f"ball {k} - ball {k + 1}" for k in range(1, balls))
        if self.dampers[damper] in self.stops:
            return ("stop",)
        return ("trailing wall", *between, "leading wall") if balls else ()


def raise_absent(name: str, engine: Engine) -> NoReturn:
    """Raise AttributeError for a group or variable that runs of an engine lack."""
    raise AttributeError(explain_absence(name, engine))
