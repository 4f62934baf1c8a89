"""Curve of a grazing in two parameters, followed on the side of the motions without the contact."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.narrow import present
from rattlebox.model.errors import Hint
from rattlebox.studies.orbits.curve import Row, SmoothCurve
from rattlebox.studies.orbits.find import size_of
from rattlebox.studies.orbits.shooting import ReturnMap, Shot
from rattlebox.studies.orbits.unfolding import (
    Touch,
    Unfolding,
    gap_slopes,
    stretch_misses,
    touch_at,
    touches,
    unfolding_at,
)

if TYPE_CHECKING:
    from rattlebox.studies.orbits.branch import SpecialPoint

Vector = NDArray[np.float64]

_FOLLOWED = (1e-3, 1e-4, 1e-5, 1e-6)
"""Smallest gaps over the size of the gaps, at which a curve may be followed: the largest one, with which steps meet no
impact, at which there is a motion without the impact."""
_LEVELS = ((2e-5, 1e-8), (3e-4, 5e-5, 8e-6, 8e-7, 1e-8))
"""Smallest gaps that lead from there to the grazing; the last one is extrapolated to zero."""
_ALONG = 1e-3
"""Smallest part of a parameter in the direction of the curve with which the plane normal to it is used."""
_SAME_TIME = 0.1
"""Largest change of the time of the near miss between two points, over that of the map."""


class GrazingCurve(SmoothCurve):
    """Curve on which the smallest gap of a near miss is zero.

    The motion without the contact depends smoothly on all parameters up to the grazing, where the one with the impact has a
    singular derivative. Both have the same limit.
    """

    zero = 1e-13

    def __init__(
        self, point: SpecialPoint, axes: tuple[str, ...], limits: Sequence[tuple[float, float]], step: float
    ) -> None:
        super().__init__(point, axes, limits, step)
        orbit, values = self.start
        self._size, scale = 1.0, present(size_of(self.returns, orbit.state))
        lost = point.kind == "impact lost"
        touch = touch_at(self.returns, orbit.state, values.tolist(), impact=lost)
        near, index = self._unfolding(orbit.state, values, touch)
        if touch is None or near is None:
            raise Hint(
                "there is no motion without the impact next to this point: bodies are pressed together there, as in "
                "chatter, or a ball has no other impact",
                "a point of kind 'grazing' or 'sticking'",
            )
        lines = self.returns.lines
        size = float(np.abs(lines.by_state[touch.contact]) @ scale)
        self._size = max(size, 2 * float(lines.offset[touch.contact]))
        self._share = self._started = self._absolute(self.returns, touch)
        self._impacts = touch.impacts - lost
        here = near.with_impact(touch.speed) if lost else near.without(touch.gap)
        fixed = np.zeros(orbit.state.size + 2)
        fixed[orbit.state.size + 1 - index] = 1.0
        for self._followed in _FOLLOWED:
            self._level = self._followed
            ahead = near.without(self._level * self._size)
            at = values.copy()
            at[index] += ahead[1] - here[1]
            found = self.correct(self.returns, orbit.state + ahead[0] - here[0], at, scale, fixed)
            row = None if found is None else self.row(self.returns, *found[:2], scale, fixed)
            if found is not None and row is not None:
                self._begin, self.start = found[:2], row
                return
        raise Hint(
            f"no motion without the impact was found next to this point, with gaps from {_FOLLOWED[-1]:g} to "
            f"{_FOLLOWED[0]:g} of the size of the motion, as where other impacts begin or end very near to it",
            "a special point next to it; or rb.continue_orbit on each side of the point",
        )

    def _unfolding(self, state: Vector, values: Vector, touch: Touch | None) -> tuple[Unfolding | None, int]:
        """Return the map near the grazing over the parameter that changes the gap more, and its index."""
        found = [] if touch is None else [unfolding_at(self.returns, state, values.tolist(), touch, k) for k in (0, 1)]
        slopes = [
            0.0 if each is None else abs(each.gap_slope() * w) for each, w in zip(found, self.width, strict=False)
        ]
        index = int(np.argmax(slopes)) if slopes else 0
        return (found[index] if found else None), index

    @staticmethod
    def _absolute(returns: ReturnMap, touch: Touch) -> float:
        """Return the time of a near miss over that of the map, counted from a fixed phase of the loads."""
        return (returns.phase / returns.length(1.0) + touch.share) % 1.0

    def begin(self, side: float) -> None:
        """Return to the start, to follow one side of it."""
        self._share = self._started
        super().begin(side)

    def linear(self, returns: ReturnMap, state: Vector, values: Vector, scale: Vector) -> tuple[Vector, Vector] | None:
        """Return residual and gap, (n + 1,), and their scaled derivatives, (n + 1, n + 2); None beyond the grazing."""
        numbers = values.tolist()
        shot = returns.shoot(state[None], numbers)
        if not shot.is_complete:
            return None
        miss = self._miss(returns, shot, state, numbers)
        if miss is None:
            return None
        before = returns.stretch(state, numbers, 0.0, miss.share)
        if not before.ok:
            return None
        gap, by_state, by_value, _ = gap_slopes(returns, numbers, miss.contact, before)
        row = np.concatenate([by_state * scale, by_value * self.width]) / self._size
        right = np.append(shot.residual[0] / scale, gap / self._size - self._level)
        return right, np.vstack([self.scaled_slopes(shot, scale), row])

    def _miss(self, returns: ReturnMap, shot: Shot, state: Vector, values: Sequence[float]) -> Touch | None:
        """Return the near miss that grazes on the curve; None if there is an impact in its place."""
        stretch = shot.ends[0].transition
        if stretch is None or len(stretch.contacts) != self._impacts:
            return None
        # A stretch may pass over a near miss between two impacts, which samples of the motion show.
        for sampled in (False, True):
            misses = touches(returns, state, values, impact=False) if sampled else stretch_misses(stretch)
            away = [abs((self._absolute(returns, miss) - self._share + 0.5) % 1.0 - 0.5) for miss in misses]
            if misses and min(away) < _SAME_TIME:
                return misses[int(np.argmin(away))]
        return None

    def row(self, returns: ReturnMap, state: Vector, values: Vector, scale: Vector, normal: Vector) -> Row | None:
        """Return the motion that grazes, reached from one with a small gap, and the values of the parameters there."""
        n = state.size
        if np.abs(normal[n:]).max() > _ALONG:  # across the curve in the plane of the parameters
            normal = np.concatenate([np.zeros(n), normal[n:]])
        try:
            for levels in _LEVELS:
                at = state, values
                for self._level in (level for level in levels if level < self._followed):
                    found = self.correct(returns, *at, scale, normal)
                    if found is None:
                        break
                    at = found[:2]
                if found is not None:
                    break
        finally:
            self._level = self._followed
        if found is None:
            return None
        state, values, slopes, _ = found
        row = super().row(returns, state, values, scale, normal)
        matrix, right = np.vstack([slopes, normal]), np.zeros(n + 2)
        right[n] = -_LEVELS[0][-1]
        change = np.linalg.solve(matrix, right)
        shot = returns.shoot(state[None], values.tolist())
        if row is not None and (miss := self._miss(returns, shot, state, values.tolist())) is not None:
            self._share = self._absolute(returns, miss)
        return None if row is None else (row[0], values + change[n:] * self.width)
