"""Derivatives of measures of a motion with respect to parameters of the case."""

from __future__ import annotations

import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import CaseError
from rattlebox._util.quantities import quantity
from rattlebox.engines.transition import Flow, Transition
from rattlebox.model.case import Case, first_contacts
from rattlebox.model.errors import Hint, nearest
from rattlebox.model.paths import unit_of
from rattlebox.studies.orbits.forcing import Forcing
from rattlebox.studies.orbits.orbit import Orbit

if TYPE_CHECKING:
    import xarray

Vector = NDArray[np.float64]

MOST_GROWTH = 1e6
"""Largest growth of a small change of the state, beyond which a derivative holds for no change of practical size."""
SLOWEST = 1e-3
"""Approach speed of a hard impact, over the largest one, below which the motion counts as grazing: derivatives grow with its
inverse, and end where the impact does not happen."""
NEAREST_MULTIPLIER = 1e-6
"""Distance of a multiplier from 1 below which a periodic motion is at a fold or a pitchfork and has no derivative."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_PANELS = 4  # per contact, and per period of the fastest mode or load, for quadrature
_MOST_NODES = 200_000
_SAMPLES = 16  # per the same period, for the search of the peak
_BESIDE = 1e-4  # of that period: distance of the states from which those at an impact are extrapolated


def gradient(
    case: Case | Orbit,
    measure: str,
    parameters: str | Sequence[str],
    *,
    point: str | None = None,
    time: float | None = None,
) -> xarray.Dataset:
    r"""Compute a measure of a motion and its derivatives with respect to parameters of the case.

    The derivatives are those of the computed motion, through all of its contacts, not differences of runs.

    Parameters
    ----------
    case
        Case of a transient with impact dampers or stops; or a periodic motion from `find_orbit`, whose derivatives are those
        of the periodic motion that the case has for the changed parameters.
    measure
        "displacement" or "velocity" of a point relative to the base at a time; "energy" of structure and balls at a time;
        "peak" or "rms" of the displacement of a point over the whole motion, for a periodic motion over its period.
    parameters
        Paths of numbers of the case, such as "damper.gap" or "load.frequency".
    point
        Point of the structure, needed if there are several; or a ball by its name in the results, such as "damper/1", whose
        displacement counts from its place in the closely packed row at the centre of its cavity.
    time
        Time at which "displacement", "velocity" or "energy" is evaluated [s], for a periodic motion from its state on;
        default the end.

    Returns
    -------
    xarray.Dataset
        `value`, the measure; `derivative` over `parameter`, in the unit of the measure over that of the parameter (SI);
        `growth`, the largest growth of a small change of the state, in units of the largest values of its components;
        `slowest_impact`, the smallest approach speed [m/s] of the impacts, NaN without impacts.

    Raises
    ------
    CaseError
        If the derivative is not defined or useless: several hard impacts at one instant, an impact or a near miss close to
        grazing, growth of small changes by more than 1e6 (chaos), a periodic motion at a fold; if a law or a parameter is at
        a kink, such as a restitution of exactly 1; if the run does not finish; if a path is not that of a number, or the
        case has particles.

    See Also
    --------
    find_orbit : Periodic motions and their stability.
    sensitivity : Influence of parameters over a whole range.

    Notes
    -----
    The derivative :math:`D` of the state :math:`x` follows the linear equations of flights and contacts. At a hard impact
    with the rates :math:`f^-` and :math:`f^+` of the state before and after, and the map :math:`r` of the velocities,

    .. math:: D^+ = r_x (D^- + f^- t_p) + r_p - f^+ t_p, \qquad t_p = -\frac{g_x D^- + g_p}{\dot g^-}

    where :math:`t_p` is the change of the time at which the gap :math:`g` closes. A periodic motion of period :math:`T`
    with the monodromy matrix :math:`M` changes by :math:`(I - M)^{-1} (x_p + f T_p)`. A peak is at a time at which the
    velocity vanishes, or at an impact, which moves with the parameters. Where two maxima are equal, the derivative is that
    of the first one.

    References
    ----------
    M. di Bernardo, C. J. Budd, A. R. Champneys, P. Kowalczyk (2008), Piecewise-smooth Dynamical Systems, Springer, section
    2.5, doi:10.1007/978-1-84628-708-4.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.Case(
    ...     structure=rb.SDOF(mass="1 kg", frequency="20 Hz", damping_ratio=0.01, velocity="0.5 m/s"),
    ...     damper=rb.ImpactDamper(
    ...         ball=rb.Sphere(radius="14 mm", material="steel"), gap="2 mm", contact=rb.Tsuji(restitution=0.6)
    ...     ),
    ...     method=rb.Newton(),
    ...     duration="0.1 s",
    ... )
    >>> result = rb.gradient(case, "displacement", ["damper.gap", "structure.mass"])
    >>> round(float(result.derivative.sel(parameter="damper.gap")), 3)
    -0.36
    """
    import xarray

    paths = [parameters] if isinstance(parameters, str) else list(parameters)
    if not paths or len(set(paths)) < len(paths):
        raise Hint("parameters must list at least one path, each only once", 'parameters = ["damper.gap"]')
    kind = _MEASURES.get(measure) if isinstance(measure, str) else None
    if kind is None:
        raise Hint(f"there is no derivative of the measure {measure!r:.60}", nearest(str(measure), _MEASURES))
    if not isinstance(case, (Case, Orbit)):
        raise Hint(
            f"a case or a periodic motion is needed, not {case!r:.60}",
            "rb.find_orbit(case), branch.orbit(k), or the orbit of a special point",
        )
    motion = _Periodic.of(case, paths) if isinstance(case, Orbit) else _Transient.of(case, paths)
    task = kind(motion, _Observed.of(motion.flow, point), time)
    value, slopes = task.compute()
    motion.check(task.last)
    speeds = [touch.approach_speed for touch in motion.whole(task.last).contacts]
    return xarray.Dataset(
        {
            "value": ((), value, {"units": kind.unit, "long_name": kind.long_name}),
            "derivative": ("parameter", slopes, {"long_name": f"derivative of the {kind.long_name}"}),
            "growth": ((), motion.growth(task.last), {"units": "1", "long_name": "growth of a small change"}),
            "slowest_impact": (
                (),
                min(speeds, default=math.nan),
                {"units": "m/s", "long_name": "smallest approach speed"},
            ),
        },
        coords={
            "parameter": paths,
            "unit": ("parameter", [f"{kind.unit}/({unit_of(motion.flow.case, path) or '1'})" for path in paths]),
        },
    )


@dataclass(frozen=True)
class _Observed:
    """A displacement as a sum over the state, its velocity likewise, and their derivatives in the parameters."""

    position: Vector
    velocity: Vector
    position_slopes: Vector  # (n, p)
    velocity_slopes: Vector

    @classmethod
    def of(cls, flow: Flow, point: str | None) -> _Observed:
        """Return that of a point of the structure or of a ball."""
        n, p = len(flow.names), len(flow.parameters)
        rows = [np.zeros(n), np.zeros(n), np.zeros((n, p)), np.zeros((n, p))]
        if f"position of {point}" in flow.names:
            for row, what in zip(rows, ("position", "velocity"), strict=False):
                row[flow.names.index(f"{what} of {point}")] = 1
            return cls(*rows)
        name = flow.case.modes.point(point)
        if name in flow.case.modes.spatial:
            raise Hint(
                f"the point {name!r} moves in 3-D; a derivative is that of a motion along one line", "another point"
            )
        shape, slopes = flow.shape(name)
        for first, row in enumerate(rows):
            row[first % 2 : 2 * shape.size : 2] = slopes if first >= 2 else shape
        return cls(*rows)


# ---- motions


@dataclass(frozen=True)
class _Motion(ABC):
    """A motion from a start, with the derivatives of its state in the parameters at fixed times."""

    flow: Flow
    start: Vector | None
    duration: float
    what: ClassVar[str]

    @abstractmethod
    def by_parameter(self) -> Vector:
        """Return the derivative of the state at the start, beside that of the transition."""

    @abstractmethod
    def duration_slopes(self) -> Vector:
        """Return the derivatives of the duration."""

    def along(self, times: Sequence[float] | Vector, *, derivatives: bool = True) -> tuple[Transition, Vector]:
        """Return the motion at some times, and the derivatives of its states in the parameters, (times, n, p)."""
        end = self.flow.along(self.start, 0.0, times, derivatives=derivatives)
        if not end.ok:
            raise self._refusal(end)
        n = len(self.flow.names)
        slopes = end.derivatives
        return end, slopes[:, :, :n] @ self.by_parameter() + slopes[:, :, n:] if derivatives else slopes

    def whole(self, last: float) -> Transition:
        """Return the motion up to a time, with derivatives."""
        return self.along([last])[0]

    def growth(self, last: float) -> float:
        """Return the largest growth of a change of the state, in units of the largest values of its components."""
        sizes = self._sizes
        return float(np.linalg.norm(self.whole(last).matrix * sizes / sizes[:, None], 2))

    @cached_property
    def fastest(self) -> float:
        """Shortest period of modes and loads [s]."""
        rates = [*np.sqrt(self.flow.case.modes.stiffness), *self.flow.case.modes.decay]
        rates += [2 * math.pi * signal.frequency for signal in self.flow.case.harmonics.values()]
        return min(2 * math.pi / max([*map(float, rates), 1e-300]), self.duration)

    @cached_property
    def _sizes(self) -> Vector:
        """Largest values of the components of the state, at least a millionth of the others of their kind."""
        states, _ = self.along(np.linspace(0, self.duration, 200), derivatives=False)
        sizes = np.abs(states.states).max(axis=0)
        balls = sum(len(damper.balls) for damper in self.flow.case.impact_dampers)
        modes = sizes.size - 2 * balls
        for kind in (np.r_[0:modes:2, modes : modes + balls], np.r_[1:modes:2, modes + balls : sizes.size]):
            sizes[kind] = np.maximum(sizes[kind], max(1e-6 * sizes[kind].max(initial=0.0), 1e-12))
        largest: Vector = sizes
        return largest

    def check(self, last: float) -> None:
        """Raise if the derivatives are useless: near grazing, or where small changes grow too much."""
        end = self.whole(last)
        hard = [touch for touch in end.contacts if touch.is_hard]
        largest = max((touch.approach_speed for touch in hard), default=0.0)
        for touch in hard:
            if touch.approach_speed < SLOWEST * largest:
                raise Hint(
                    f"{self._place(touch.damper, touch.contact)} is hit at only "
                    f"{quantity(touch.approach_speed, 'm/s', 3)} at t = {quantity(touch.time, 's', 4)}; below "
                    f"{SLOWEST:g} of the largest approach speed, {quantity(largest, 'm/s', 3)}, the motion is close to "
                    "grazing, where it has no derivative",
                    "an earlier end, or differences of runs over the change of interest",
                )
        for miss in end.closest_approach:
            speed = math.sqrt(max(2 * miss.gap * miss.curvature, 0.0))
            if hard and speed < SLOWEST * largest:
                raise Hint(
                    f"{self._place(miss.damper, miss.contact)} is missed by only {quantity(miss.gap, 'm', 3)} at t = "
                    f"{quantity(miss.time, 's', 4)}; a change that closes this gap adds a grazing impact, where the motion "
                    "has no derivative",
                    "an earlier end, or differences of runs over the change of interest",
                )
        growth = self.growth(last)
        if not growth <= MOST_GROWTH:
            raise Hint(
                f"a small change of the state grows {growth:.1e} times up to t = {quantity(last, 's', 4)}; beyond "
                f"{MOST_GROWTH:g} the motion is practically chaotic, and a derivative holds for no change of practical size",
                "a shorter duration; or rb.sensitivity, which takes whole runs over a range",
            )

    def _place(self, damper: int, contact: int) -> str:
        case = self.flow.case
        return case.contact_names[first_contacts(case)[damper] + contact]

    def _refusal(self, end: Transition) -> CaseError:
        """Return the error of a motion without derivatives."""
        at = quantity(end.raw.refused_at if end.status in _REFUSED else end.raw.stopped_at, "s", 4)
        reason, advice = _REFUSED.get(
            end.status, ("the run ends with the status " + repr(end.status), "rb.simulate, which says why")
        )
        return Hint(f"{self.what} has no derivative: {reason}, at t = {at}", advice)


_REFUSED = {
    "simultaneous": (
        "several hard impacts happen at one instant, so that a small change decides on their order",
        "starts of the balls that differ, or contacts with a duration (rb.EventDriven)",
    ),
    "grazing": ("a hard contact touches without speed", "another gap, or an earlier end"),
    "kink": (
        "a law or the case has a kink at the value of a parameter or the speed of an impact, such as a restitution of 1, or"
        " a parameter changes one of two modes with nearly the same frequency",
        "a value a little smaller or larger",
    ),
    "starts_closed": ("it starts within a contact", "a start at which bodies do not overlap"),
}


@dataclass(frozen=True)
class _Transient(_Motion):
    """The motion of a case from its start on."""

    what = "this motion"

    @classmethod
    def of(cls, case: Case, paths: Sequence[str]) -> _Transient:
        """Return the motion of a case."""
        return cls(Flow.of(case, paths), None, case.duration)

    def by_parameter(self) -> Vector:
        """Return zeros: the transition contains the derivative of the start."""
        return np.zeros((len(self.flow.names), len(self.flow.parameters)))

    def duration_slopes(self) -> Vector:
        """Return zeros."""
        return np.zeros(len(self.flow.parameters))


@dataclass(frozen=True)
class _Periodic(_Motion):
    """A period of a periodic motion, which remains one when the parameters change."""

    slopes: Vector
    period_slopes: Vector
    what = "this periodic motion"

    @classmethod
    def of(cls, orbit: Orbit, paths: Sequence[str]) -> _Periodic:
        """Return the motion of a case that stays periodic."""
        forcing = Forcing.of(orbit.case)
        flow = Flow.of(forcing.shifted(orbit.phase), paths)
        _, period_slopes = forcing.period_of(paths, flow.values.tolist())
        by_period = orbit.cycles * np.array(period_slopes)
        n = len(flow.names)
        motion = cls(flow, orbit.state, orbit.period, np.zeros((n, len(paths))), by_period)
        end = motion.whole(orbit.period)
        distance = float(np.min(np.abs(np.linalg.eigvals(end.matrix) - 1)))
        if distance < NEAREST_MULTIPLIER:
            raise Hint(
                f"this periodic motion has a multiplier at a distance of {distance:.1e} from 1: it is at a fold or a "
                "pitchfork, where it ends or divides",
                "another value of the parameter, away from the fold",
            )
        change = end.by_parameter + np.outer(end.by_time, by_period)
        slopes: Vector = np.linalg.solve(np.eye(n) - end.matrix, change).astype(np.float64)
        return cls(flow, orbit.state, orbit.period, slopes, by_period)

    def by_parameter(self) -> Vector:
        """Return the derivative of the state at the start, which stays on the periodic motion."""
        return self.slopes

    def duration_slopes(self) -> Vector:
        """Return the derivatives of the period."""
        return self.period_slopes


# ---- measures


class _Measure(ABC):
    """A measure of a motion and its derivatives."""

    unit: ClassVar[str]
    long_name: ClassVar[str]
    at_a_time: ClassVar[bool] = False

    def __init__(self, motion: _Motion, observed: _Observed, time: float | None) -> None:
        self.motion, self.observed = motion, observed
        if time is not None and not self.at_a_time:
            raise Hint(f"the {self.long_name} is that of the whole motion; it has no time", "leave out time")
        last = motion.duration if time is None else time
        if (
            isinstance(last, bool)
            or not isinstance(last, (int, float))
            or not 0 < last <= motion.duration * (1 + 1e-12)
        ):
            raise Hint(
                f"time = {last!r:.40} is not within the motion, which lasts {quantity(motion.duration, 's', 4)}",
                "a time in seconds after its start, up to its end",
            )
        self.last, self.moves = float(last), time is None

    @abstractmethod
    def compute(self) -> tuple[float, Vector]:
        """Return the value and its derivatives in the parameters."""

    def end(self) -> tuple[Transition, Vector]:
        """Return the motion up to the time of the measure, and the derivatives of its end, which may move."""
        end, slopes = self.motion.along([self.last])
        later = np.outer(end.by_time, self.motion.duration_slopes()) if self.moves else 0.0
        return end, slopes[-1] + later

    def position(self, states: Vector) -> Vector:
        """Return displacements of the point for states in rows."""
        return states @ self.observed.position

    def speed(self, states: Vector) -> Vector:
        """Return velocities of the point for states in rows."""
        return states @ self.observed.velocity

    def position_slopes(self, states: Vector, slopes: Vector) -> Vector:
        """Return derivatives of the displacements in the parameters, (..., p)."""
        own: Vector = (
            np.einsum("...np,n->...p", slopes, self.observed.position) + states @ self.observed.position_slopes
        )
        return own


class _Displacement(_Measure):
    unit, long_name, at_a_time = "m", "displacement", True

    def compute(self) -> tuple[float, Vector]:
        end, slopes = self.end()
        return float(self.position(end.state)), self.position_slopes(end.state, slopes)


class _Velocity(_Measure):
    unit, long_name, at_a_time = "m/s", "velocity", True

    def compute(self) -> tuple[float, Vector]:
        end, slopes = self.end()
        observed = self.observed
        return float(self.speed(end.state)), observed.velocity @ slopes + end.state @ observed.velocity_slopes


class _Energy(_Measure):
    unit, long_name, at_a_time = "J", "energy", True

    def compute(self) -> tuple[float, Vector]:
        end, slopes = self.end()
        if end.is_closed:
            raise Hint(
                f"a contact is closed at t = {quantity(self.last, 's', 4)}; its energy is not part of that of the bodies",
                "another time",
            )
        packed = self.motion.flow.variants()
        stiffness, state = np.asarray(packed.mode_stiffness), end.state
        m = 2 * stiffness.shape[0]
        mass = [np.asarray(damper.mass) for damper in packed.dampers]
        gravity = [np.asarray(damper.gravity) for damper in packed.dampers]
        energy = 0.5 * (np.square(state[1:m:2]).sum() + np.square(state[:m:2]) @ stiffness)
        by_state = np.zeros(state.size)
        by_state[:m:2], by_state[1:m:2] = stiffness[:, 0] * state[:m:2], state[1:m:2]
        balls = (state.size - m) // 2
        ball = 0
        for own, g in zip(mass, gravity, strict=True):
            for each in own:
                x, v = state[m + ball], state[m + balls + ball]
                energy = energy + each * (0.5 * v * v - g * x)
                by_state[m + ball], by_state[m + balls + ball] = -(each * g).flat[0], each.flat[0] * v
                ball += 1
        variants = np.atleast_1d(energy)
        return float(variants[0]), by_state @ slopes + self.motion.flow.slopes(variants)


class _Rms(_Measure):
    unit, long_name = "m", "RMS displacement"

    def compute(self) -> tuple[float, Vector]:
        """Integrate the square of the displacement by Gauss quadrature between the events."""
        motion, last = self.motion, self.last
        log = motion.whole(last).raw.impacts
        ends = np.where(np.isfinite(log.duration), log.time + log.duration, log.time)
        inner = np.concatenate([log.time, ends])
        knots = np.unique(np.concatenate([[0.0, last], inner[(inner > 0) & (inner < last)]]))
        knots = knots[np.concatenate([[True], np.diff(knots) > 1e-12 * last])]
        pieces = [
            np.linspace(a, b, 1 + max(_PANELS, math.ceil(_PANELS * (b - a) / motion.fastest)))
            for a, b in itertools.pairwise(knots)
        ]
        edges = np.unique(np.concatenate(pieces))
        half = 0.5 * np.diff(edges)[:, None]
        if half.size * _NODES.size > _MOST_NODES:
            raise Hint("the motion is too long for a derivative of its RMS", "a shorter duration, or a periodic motion")
        times = (0.5 * (edges[1:] + edges[:-1])[:, None] + half * _NODES).ravel()
        weights = (half * _WEIGHTS).ravel()
        end, slopes = motion.along(np.append(times, last))
        x = self.position(end.states)
        x_slopes = self.position_slopes(end.states, slopes)
        square = float(weights @ x[:-1] ** 2) / last
        by_duration = (x[-1] ** 2 - square) / last
        by_parameter = 2 * (weights * x[:-1]) @ x_slopes[:-1] / last + by_duration * motion.duration_slopes()
        rms = math.sqrt(square)
        return rms, by_parameter / (2 * rms) if rms > 0 else np.zeros(by_parameter.shape)


class _Peak(_Measure):
    unit, long_name = "m", "peak displacement"

    def compute(self) -> tuple[float, Vector]:
        """Find the largest displacement and follow it: at rest, at an impact, or at an end of the motion."""
        motion, last = self.motion, self.last
        log = motion.whole(last).raw.impacts
        count = max(200, math.ceil(_SAMPLES * last / motion.fastest))
        times = np.unique(np.concatenate([np.linspace(0, last, count), log.time[log.time < last]]))
        states, _ = motion.along(times, derivatives=False)
        x = self.position(states.states)
        best = int(np.argmax(np.abs(x)))
        candidates = [self._at(times[best])]
        for low, high in zip(times[max(best - 1, 0) : best + 1], times[best : best + 2], strict=False):
            if (turn := self._turn(low, high)) is not None:
                candidates.append(self._at(turn))
        value, slopes = max(candidates, key=lambda each: abs(each[0]))
        sign = math.copysign(1.0, value)
        hits = log.time[np.abs(log.time - times[best]) <= 1e-12 * last]
        if hits.size and self.motion.flow.case.method.kind == "newton" and abs(value) <= abs(x[best]) * (1 + 1e-13):
            value, slopes = self._at_impact(float(hits[0]))
        return abs(value), sign * slopes

    def _at(self, t: float) -> tuple[float, Vector]:
        """Return the displacement at a time and its derivatives at a fixed time."""
        if t == 0:
            start = self.motion.flow.along(self.motion.start, 0.0, [0.0])
            slopes = start.by_parameter if self.motion.start is None else self.motion.by_parameter()
            return float(self.position(start.state)), self.position_slopes(start.state, slopes)
        end, slopes_along = self.motion.along([t])
        return float(self.position(end.state)), self.position_slopes(end.state, slopes_along[-1])

    def _turn(self, low: float, high: float) -> float | None:
        """Return the time between two samples at which the velocity vanishes; None without one."""

        def speed(t: float) -> float:
            return float(self.speed(self.motion.along([t], derivatives=False)[0].states)[-1])

        inside = 1e-9 * (high - low)
        low, high = low + inside, high - inside
        if not low < high or not speed(low) * speed(high) < 0:
            return None
        from scipy.optimize import brentq

        return float(brentq(speed, low, high, xtol=1e-14 * high))

    def _at_impact(self, t: float) -> tuple[float, Vector]:
        """Return the displacement at an impact, which moves with the parameters, from states just before it."""
        step = _BESIDE * self.motion.fastest
        times = t - step * np.array([4.0, 3.0, 2.0, 1.0])
        end, slopes = self.motion.along(times)
        x, x_slopes = self.position(end.states), self.position_slopes(end.states, slopes)
        # The gap that closes, and its derivatives, extrapolated to the impact.
        gap_slopes, rates = self._gap(t, end, slopes)
        to_end = np.array([-1.0, 4.0, -6.0, 4.0])
        speed = to_end @ self.speed(end.states)
        late = -(to_end @ gap_slopes) / (to_end @ rates)
        return float(to_end @ x), to_end @ x_slopes + speed * late

    def _gap(self, t: float, end: Transition, slopes: Vector) -> tuple[Vector, Vector]:
        """Return derivatives and rates of the gap that closes at a time, along some states."""
        whole = self.motion.whole(min(t * (1 + 1e-9) + 1e-12, self.last))
        touch = min(whole.contacts, key=lambda each: abs(each.time - t))
        flow, packed = self.motion.flow, self.motion.flow.variants()
        damper = packed.dampers[touch.damper]
        shape = np.asarray(damper.shape)
        shape_slopes = flow.slopes(shape)
        shape = shape[:, 0]
        m = 2 * shape.size
        first = sum(len(each.balls) for each in flow.case.impact_dampers[: touch.damper])
        count = np.asarray(damper.mass).shape[0]
        row = np.zeros(end.states.shape[1])
        if touch.contact > 0:
            row[m + first + touch.contact - 1] = -1
        if touch.contact < count:
            row[m + first + touch.contact] = 1
        side = 1.0 if touch.contact == count and count else -1.0 if touch.contact == 0 else 0.0
        row[:m:2] = side * shape
        clearance = np.atleast_1d(np.asarray(damper.clearance, dtype=float))
        half = 0.5 * abs(side)
        gap_slopes = np.einsum("i,tip->tp", row, slopes) + half * flow.slopes(clearance)
        gap_slopes = gap_slopes + side * end.states[:, :m:2] @ shape_slopes
        return gap_slopes, end.rates @ row


_MEASURES: dict[str, type[_Measure]] = {
    "displacement": _Displacement,
    "velocity": _Velocity,
    "energy": _Energy,
    "peak": _Peak,
    "rms": _Rms,
}
