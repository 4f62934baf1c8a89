"""The return map near a grazing of a hard contact: the motions without and with the impact that begin there.

References
----------
A. B. Nordmark (1991), Non-periodic motion caused by grazing incidence in an impact oscillator, Journal of Sound and
Vibration 145, 279-297, doi:10.1016/0022-460X(91)90592-8.
M. di Bernardo, C. J. Budd, A. R. Champneys, P. Kowalczyk (2008), Piecewise-smooth Dynamical Systems, Springer, chapter 6,
doi:10.1007/978-1-84628-708-4.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rattlebox.core import _core
from rattlebox.prepare.pack import pack
from rattlebox.studies.orbits.flow import End
from rattlebox.studies.orbits.motion import GapLines, motion_of
from rattlebox.studies.orbits.shooting import ReturnMap

if TYPE_CHECKING:
    from rattlebox.engines.transition import Transition

Vector = NDArray[np.float64]

_SKIPPED = (1e-7, 1e-5, 1e-4)
"""Times before and after a slow impact, over that of the map, that are left out to compute the motion without it."""
_SAME_TIME = 0.02
"""Largest change of the time of a contact over that of the map, at which it is the same one."""
_SINGULAR = 1e12
"""Condition of I - A above which the motion without the impact is not isolated."""
_GUESSED = 0.7
"""Restitution of a slow impact from which a search begins, if that of the law is not constant."""


@dataclass(frozen=True)
class Touch:
    """A near miss or a slow impact of a contact in a return, at a share of its time: gap [m] or approach speed [m/s].

    `duration` is that of a soft contact over the time of the return.
    """

    contact: int
    share: float
    gap: float
    speed: float
    impacts: int  # number of impacts in the return
    duration: float = 0.0


@dataclass(frozen=True)
class Unfolding:
    r"""The return map to first order about a motion without the contact, and the kick of the contact.

    .. math:: x \to A x + b p + B y, \qquad \frac{y^2}{2 \kappa} = -(c x + d p), \quad y \ge 0

    with the approach speed y of an impact, zero if the gap c x + d p of the motion without it stays positive.
    """

    matrix: Vector  # A (n, n)
    by_value: Vector  # b (n,)
    kick: Vector  # B (n,)
    gap_by_state: Vector  # c (n,)
    gap_by_value: float  # d
    curvature: float  # kappa [m/s^2]

    def _moves(self) -> tuple[Vector, Vector]:
        """Return the changes of the fixed point with the parameter and with the speed of the impact."""
        both = np.linalg.solve(np.eye(len(self.matrix)) - self.matrix, np.column_stack([self.by_value, self.kick]))
        return np.asarray(both[:, 0], dtype=float), np.asarray(both[:, 1], dtype=float)

    def gap_slope(self) -> float:
        """Return the derivative of the smallest gap of the motion without the impact in the parameter."""
        return float(self.gap_by_state @ self._moves()[0] + self.gap_by_value)

    def without(self, gap: float) -> tuple[Vector, float]:
        """Return the motion without the impact whose smallest gap is positive, relative to the grazing."""
        value = gap / self.gap_slope()
        return self._moves()[0] * value, value

    def with_impact(self, speed: float) -> tuple[Vector, float]:
        """Return the motion with an impact of some approach speed, relative to the grazing."""
        by_value, by_speed = self._moves()
        value = -(self.depth(speed) + self.gap_by_state @ by_speed * speed) / self.gap_slope()
        return by_value * value + by_speed * speed, float(value)

    def depth(self, speed: float) -> float:
        """Return how far bodies would pass through each other without the impact of some approach speed [m]."""
        return speed**2 / (2 * self.curvature)


def touches(returns: ReturnMap, state: Vector, values: Sequence[float], *, impact: bool) -> list[Touch]:
    """Return the near misses of a return, the nearest first, or its impacts, the slowest first."""
    period = returns.forcing.period_of(returns.parameters, values)[0]
    length = returns.length(period) * returns.segments
    motion = motion_of(returns.forcing_at(values).shifted(returns.phase), state, length)
    if motion is None:
        return []
    log = motion.impacts
    if not impact:
        count = log.time.size
        return [Touch(miss.contact, miss.time / length, miss.gap, 0.0, count) for miss in motion.near_misses()]
    contacts, shares = motion.impact_contacts(), log.time / length
    spans = np.nan_to_num(log.duration) / length
    return [
        Touch(int(contacts[k]), float(shares[k]), 0.0, float(log.approach_speed[k]), shares.size, float(spans[k]))
        for k in np.argsort(log.approach_speed)
    ]


def stretch_misses(stretch: Transition) -> list[Touch]:
    """Return the nearest miss of each contact in a stretch with derivatives."""
    length, first = float(stretch.time[-1]), stretch.first_contacts
    return [
        Touch(first[miss.damper] + miss.contact, miss.time / length, miss.gap, 0.0, len(stretch.contacts))
        for miss in stretch.closest_approach
    ]


def touch_at(returns: ReturnMap, state: Vector, values: Sequence[float], *, impact: bool) -> Touch | None:
    """Return the nearest miss or the slowest impact of a return; None if there is none."""
    return next(iter(touches(returns, state, values, impact=impact)), None)


def aimed(
    returns: ReturnMap,
    near: Unfolding,
    touch: Touch,
    state: Vector,
    values: Sequence[float],
    scale: Vector,
    speed: float,
) -> Vector:
    """Return a state, moved so that the contact that nearly grazed has an impact of some approach speed.

    The overlap of an impact is of second order in its speed, as are the errors of a state to first order.
    """
    for impact in (False, True):
        found = touch_at(returns, state, values, impact=impact)
        if found is not None and found.contact == touch.contact and abs(found.share - touch.share) < _SAME_TIME:
            gap = found.gap - near.depth(found.speed)
            direction = scale**2 * near.gap_by_state
            return np.asarray(state - direction * (gap + near.depth(speed)) / float(near.gap_by_state @ direction))
    return state


def gap_slopes(
    returns: ReturnMap, values: Sequence[float], contact: int, before: End
) -> tuple[float, Vector, Vector, float]:
    """Return the smallest gap near the end of a stretch, its derivatives by state and parameters, and its curvature.

    The derivatives are those where the gap is smallest, at which its time does not matter.
    """
    lines, moved = returns.gap_lines(values)
    line = lines.by_state[contact]
    by_value = line @ before.by_parameter
    by_value += [float(each.by_state[contact] @ before.state + each.offset[contact]) for each in moved]
    gap = float(line @ before.state + lines.offset[contact])
    return gap, line @ before.matrix, by_value, float(lines.rate_by_state[contact] @ before.by_time)


def unfolding_at(
    returns: ReturnMap, state: Vector, values: Sequence[float], touch: Touch, index: int = 0
) -> Unfolding | None:
    """Return the map near a motion that grazes, or nearly so, over one of the parameters; None if there is none."""
    n, contact = state.size, touch.contact
    before = returns.stretch(state, values, 0.0, touch.share - (_SKIPPED[0] if touch.speed > 0 else 0.0))
    if not before.ok:
        return None
    # At the end of a soft contact bodies may still overlap, without force, for a short time.
    for skipped in _SKIPPED if touch.speed > 0 else (0.0,):
        again = touch.share + touch.duration + skipped
        restarted = returns.stretch(state, values, 0.0, again) if skipped else before
        after = returns.stretch(restarted.state, values, again, 1.0) if restarted.ok else restarted
        if after.ok:
            break
    else:
        return None
    _, gap_by_state, gap_by_value, curvature = gap_slopes(returns, values, contact, before)
    if not curvature > 0:
        return None
    period_slope = returns.forcing.period_of(returns.parameters, values)[1][index]
    by_value = after.by_parameter[:, index] + after.matrix @ before.by_parameter[:, index]
    by_value = by_value + after.by_time * returns.length(1.0) * period_slope
    turn = returns.reflection
    matrix = turn @ after.matrix @ before.matrix
    # A ball without impacts flies on and returns to its place with any velocity, so that no single motion begins here.
    if np.linalg.cond(np.eye(n) - matrix) > _SINGULAR:
        return None
    return Unfolding(
        matrix,
        turn @ by_value,
        turn @ after.matrix @ _jump(returns, values, contact),
        gap_by_state,
        float(gap_by_value[index]),
        curvature,
    )


def _jump(returns: ReturnMap, values: Sequence[float], contact: int) -> Vector:
    """Return the jump of the state at a slow hard impact over its approach speed, (n,); zero for a soft one."""
    problem = pack(returns.forcing_at(values).case)
    if problem.settings.method is not _core.Method.newton:
        return np.zeros(returns.size)
    masses = np.concatenate([np.ravel(damper.mass) for damper in problem.dampers])
    mobility = np.ones(returns.size)
    mobility[returns.size - masses.size :] = 1 / masses
    line = GapLines.of(problem.dampers, returns.modes).rate_by_state[contact]
    law = problem.contacts[contact].restitution
    restitution = float(law.e) if isinstance(law, _core.ConstantRestitution) else _GUESSED
    return np.asarray((1 + restitution) * mobility * line / float(line @ (mobility * line)))
