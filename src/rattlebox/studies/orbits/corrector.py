"""Points of a branch of fixed points of the return map: steps along the tangent, and zeros of test functions.

References
----------
H. B. Keller (1977), Numerical solution of bifurcation and nonlinear eigenvalue problems, in: P. H. Rabinowitz (ed.),
Applications of Bifurcation Theory, Academic Press, 359-384.
Yu. A. Kuznetsov (2004), Elements of Applied Bifurcation Theory, 3rd ed., Springer, chapter 10,
doi:10.1007/978-1-4757-3978-7 (test functions).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import CaseError
from rattlebox.studies.orbits.find import away_from_impacts, sizes_in
from rattlebox.studies.orbits.orbit import Orbit, orbit_and_motion
from rattlebox.studies.orbits.shooting import TOLERANCE, ReturnMap, Shot
from rattlebox.studies.orbits.stability import flip_test, fold_test, torus_test

Vector = NDArray[np.float64]

_CORRECTIONS = 8
_TURN = 0.97
"""Smallest cosine of the angle between the tangents of two points."""
_ACCURATE = 1e-10
"""Accuracy of the distance of a special point from the last point, over the longest step."""
_LOCATED = 60
"""Largest number of steps in which a special point is located."""
_NEAR_SECTION = 0.03
"""Time from the beginning of the map to an impact over the period of the loads, at which the beginning is moved."""


@dataclass(frozen=True)
class Point:
    """A periodic motion on a branch, with the tangent of the branch in scaled coordinates and what is special there."""

    orbit: Orbit
    value: float
    returns: ReturnMap
    shot: Shot
    scale: Vector
    tangent: Vector  # (n + 1,), the parameter last
    special: str = ""
    located: float = field(
        default=np.nan
    )  # value of the parameter at a special point, by extrapolation if it is singular
    passage: str = ""  # how the branch continues at a grazing point

    @property
    def contacts(self) -> Counter[int]:
        """Number of impacts of each contact."""
        return Counter(impact.contact for impact in self.orbit.impacts)

    def multipliers(self) -> NDArray[np.complex128]:
        """Return the multipliers of the map, which covers half a period of a symmetric motion."""
        return np.linalg.eigvals(self.shot.monodromy()).astype(complex)


def _turning(point: Point) -> float:
    """Test function of a fold: the share of the parameter in the tangent."""
    return float(point.tangent[-1])


def _branching(point: Point) -> float:
    """Test function of a branch point: the determinant of M - 1 over the share of the parameter in the tangent."""
    return fold_test(point.multipliers()) / point.tangent[-1] if point.tangent[-1] else 0.0


TESTS: dict[str, Callable[[Point], float]] = {
    "fold": _turning,
    "branch point": _branching,
    "flip": lambda point: flip_test(point.multipliers()),  # a pitchfork if the map is mirrored
    "torus": lambda point: torus_test(point.multipliers()),
}
"""Test functions by the special point at which they change sign."""


class Corrector:
    """Points of a branch of periodic motions along one parameter between limits."""

    def __init__(self, returns: ReturnMap, limits: tuple[float, float], longest: float) -> None:
        self.returns, self.limits, self.longest = returns, limits, longest
        self.width = limits[1] - limits[0]

    def point(self, state: Vector, value: float, scale: Vector, toward: Vector | float) -> Point | None:
        """Return the fixed point near a state at a value of the parameter, with the tangent nearest to `toward`."""
        corrected = self.correct(self.returns, state, value, scale)
        return None if corrected is None else self.finish(self.returns, *corrected[:3], scale, toward)

    def distance(self, point: Point, after: Point) -> float:
        """Return the distance between two points along the tangent of the first one."""
        change = (after.orbit.state - point.orbit.state) / point.scale
        whole = np.append(change, (after.value - point.value) / self.width)
        return float(np.sum(self.weights(point.scale.size) * whole * point.tangent))

    def step(self, point: Point, length: float) -> tuple[Point, int] | None:
        """Return the point at a distance along the tangent, and the number of corrections; None if there is none."""
        n = point.scale.size
        state = point.orbit.state + length * point.tangent[:n] * point.scale
        value = point.value + length * point.tangent[n] * self.width
        corrected = self.correct(point.returns, state, value, point.scale, point.tangent)
        if corrected is None:
            return None
        state, value, shot, count = corrected
        try:
            after = self.finish(point.returns, state, value, shot, point.scale, point.tangent)
        except CaseError:
            # Beyond a limit there may be no case, as with a negative gap: the step ends at the limit.
            low, high = self.limits
            if low <= value <= high:
                raise
            after = self._at_value(point, state, value, low if value < low else high)
        return None if after is None else (after, count)

    def correct(
        self, returns: ReturnMap, state: Vector, value: float, scale: Vector, normal: Vector | None = None
    ) -> tuple[Vector, float, Shot, int] | None:
        """Return the fixed point in the plane through a guess that is normal to a direction; default at the same value."""
        n = state.size
        border = (np.append(np.zeros(n), 1.0) if normal is None else normal) * self.weights(n)
        for count in range(1, _CORRECTIONS + 1):
            if not self.limits[0] - self.width < value < self.limits[1] + self.width or value <= 0 < self.limits[0]:
                return None
            shot = returns.shoot(state[None], [value])
            if not shot.is_complete:
                return None
            matrix = np.vstack([self._slopes(shot, scale), border])
            right = np.append(-shot.residual[0] / scale, 0.0)
            try:
                change = np.linalg.solve(matrix, right)
            except np.linalg.LinAlgError:
                return None
            if not np.isfinite(change).all() or np.abs(change).max() > 0.5:
                return None
            if np.abs(right).max() < TOLERANCE and np.abs(change).max() < 1e-7:
                return state, value, shot, count
            state = state + change[:n] * scale
            value = value + float(change[n]) * self.width
        return None

    def _slopes(self, shot: Shot, scale: Vector) -> Vector:
        """Return the scaled derivative of the residual with respect to state and parameter, (n, n + 1)."""
        by_state = shot.jacobian() * scale / scale[:, None]
        by_parameter = shot.by_parameter[0, :, 0] * self.width / scale
        return np.column_stack([by_state, by_parameter])

    @staticmethod
    def weights(n: int) -> Vector:
        """Return the weights of the squares of scaled components in a distance."""
        return np.append(np.full(n, 1.0 / n), 1.0)

    def finish(
        self, returns: ReturnMap, state: Vector, value: float, shot: Shot, scale: Vector, toward: Vector | float
    ) -> Point | None:
        """Return the point of a corrected state, with the tangent nearest to a direction or a sign of the parameter."""
        guide = np.append(np.zeros(state.size), toward) if isinstance(toward, float) else toward
        if not np.isfinite(value) or value <= 0 < self.limits[0]:
            return None
        found = orbit_and_motion(returns, shot, state, scale, [value])
        if found is None:
            return None
        orbit, motion = found
        new_scale = np.maximum(sizes_in(motion), 1e-3 * scale)
        guide = guide * np.append(scale / new_scale, 1.0)
        tangent = self._tangent(shot, new_scale, guide)
        return None if tangent is None else Point(orbit, value, returns, shot, new_scale, tangent)

    def _tangent(self, shot: Shot, scale: Vector, guide: Vector) -> Vector | None:
        """Return the unit tangent of the branch, on the side of a guide."""
        n = scale.size
        # The null vector of the derivative; the border of the linear system would be singular at a bad guide.
        *_, rows = np.linalg.svd(self._slopes(shot, scale))
        tangent = rows[-1]
        weights = self.weights(n)
        size = float(np.sqrt(np.sum(weights * tangent**2)))
        if not np.isfinite(size) or size == 0:
            return None
        side = float(np.sum(weights * tangent * guide))
        return np.asarray(tangent / (size if side >= 0 else -size))

    def resection(self, point: Point) -> Point:
        """Return a point whose map begins far from impacts; the same one if it does so already."""
        returns, orbit = point.returns, point.orbit
        period = orbit.period / orbit.cycles
        begins = [(impact.phase * orbit.cycles - returns.phase) % orbit.cycles for impact in orbit.impacts]
        if all(min(time, orbit.cycles - time) > _NEAR_SECTION for time in begins):
            return point
        here = ReturnMap(type(returns.forcing).of(orbit.case, returns.parameters), returns.cycles, phase=returns.phase)
        moved, _ = away_from_impacts(here, orbit.state)
        shift = (moved.phase - returns.phase) % 1.0
        if shift == 0:
            return point
        # Derivatives of the state at the new beginning carry the tangent there.
        ahead = returns.part(shift * period, orbit.state, point.value, shift)
        if ahead is None:
            return point
        end_state, by_state, by_value = ahead
        n = point.scale.size
        dx = by_state @ (point.tangent[:n] * point.scale) + by_value * point.tangent[n] * self.width
        guide = np.append(dx / point.scale, point.tangent[n])
        new = returns.with_(phase=moved.phase)
        # At a fold the value of the parameter does not hold a point.
        corrected = self.correct(new, end_state, point.value, point.scale)
        corrected = corrected or self.correct(new, end_state, point.value, point.scale, guide)
        return point if corrected is None else self.finish(new, *corrected[:3], point.scale, guide) or point

    def is_near(self, point: Point, after: Point) -> bool:
        """Return whether the branch has turned little between two points, and does not jump to another one."""
        weights = self.weights(point.scale.size)

        def is_along(direction: Vector) -> bool:
            size = np.sqrt(np.sum(weights * direction**2) * np.sum(weights * point.tangent**2))
            return bool(np.sum(weights * direction * point.tangent) > _TURN * size)

        # The chord leaves the tangent where the branch jumps, though both tangents may be parallel.
        chord = np.append(
            (after.orbit.state - point.orbit.state) / point.scale, (after.value - point.value) / self.width
        )
        return is_along(after.tangent * np.append(after.scale / point.scale, 1.0)) and is_along(chord)

    def at_limit(self, point: Point, after: Point) -> Point | None:
        """Return the point at the limit that lies between two points, or at the second one."""
        low, high = self.limits
        limit = low if abs(after.value - low) < abs(after.value - high) else high
        return self._at_value(point, after.orbit.state, after.value, limit)

    def _at_value(self, point: Point, state: Vector, value: float, between: float) -> Point | None:
        """Return the point at a value of the parameter between a point and a fixed point beyond it."""
        share = (between - point.value) / (value - point.value) if value != point.value else 0.0
        state = point.orbit.state + share * (state - point.orbit.state)
        corrected = self.correct(point.returns, state, between, point.scale)
        if corrected is None:
            return None
        return self.finish(point.returns, corrected[0], between, corrected[2], point.scale, point.tangent)

    def locate(self, point: Point, after: Point, test: Callable[[Point], float]) -> Point | None:
        """Return the point between two points at which a test function is zero, by the Illinois method."""
        low, high = 0.0, self.distance(point, after)
        at_low, at_high = test(point), test(after)
        best: Point | None = None
        side, previous = 0, np.inf
        for _ in range(_LOCATED):
            middle = (low * at_high - high * at_low) / (at_high - at_low) if at_high != at_low else 0.5 * (low + high)
            taken = self.step(point, middle)
            if taken is None:
                return best
            best = taken[0]
            value = test(best)
            if value * at_high > 0:
                high, at_high = middle, value
                at_low = 0.5 * at_low if side == -1 else at_low
                side = -1
            else:
                low, at_low = middle, value
                at_high = 0.5 * at_high if side == 1 else at_high
                side = 1
            moved = abs(middle - previous)
            previous = middle
            if abs(high - low) < _ACCURATE * self.longest or moved < _ACCURATE * self.longest:
                break
        return best

    def change(self, point: Point, after: Point, what: Callable[[Point], object]) -> tuple[Point, Point]:
        """Return the points on both sides of the place between two points at which something changes.

        The distance along the branch is bisected; where no motion can be computed, it counts as changed.
        """
        low, high = 0.0, self.distance(point, after)
        here, last, next_one = what(point), point, after
        while high - low > _ACCURATE * self.longest:
            middle = 0.5 * (low + high)
            taken = self.step(point, middle)
            if taken is not None and what(taken[0]) == here:
                low, last = middle, taken[0]
            else:
                high, next_one = middle, next_one if taken is None else taken[0]
        return last, next_one
