"""Curves of special points in two parameters by pseudo-arclength continuation of a motion and one more equation."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.narrow import present
from rattlebox.model.errors import several
from rattlebox.studies.orbits.find import away_from_impacts, size_of
from rattlebox.studies.orbits.forcing import Forcing, number_at
from rattlebox.studies.orbits.orbit import Orbit, orbit_of
from rattlebox.studies.orbits.shooting import TOLERANCE, ReturnMap, Shot

if TYPE_CHECKING:
    from rattlebox.studies.orbits.branch import SpecialPoint

Vector = NDArray[np.float64]

_CHANGE = 1e-5
"""Step of the central differences of the test function in scaled coordinates."""
_CORRECTIONS = 8
SHORTEST = 1e-5
LOST = "no further motion was found"


def _minus_one(values: NDArray[np.complex128]) -> float:
    return float(np.prod(values - 1).real)


def _plus_one(values: NDArray[np.complex128]) -> float:
    return float(np.prod(values + 1).real)


def _pair(values: NDArray[np.complex128]) -> float:
    return float(np.prod([one * other - 1 for one, other in combinations(values, 2)]).real)


TESTS: dict[str, Callable[[NDArray[np.complex128]], float]] = {
    "fold": _minus_one,
    "flip": _plus_one,
    "pitchfork": _plus_one,
    "torus": _pair,
}
"""Test functions of the multipliers of the map; that of a symmetric motion covers half a period."""


Row = tuple[Orbit, Vector]
"""A motion and the values of both parameters."""


class Curve:
    """Curve of a special point in two parameters: motions with one more equation, `linear`."""

    zero = 1e-8
    """Largest value of the additional equation at a point."""

    def __init__(
        self, point: SpecialPoint, axes: tuple[str, ...], limits: Sequence[tuple[float, float]], step: float
    ) -> None:
        orbit = point.orbit
        self.limits = np.array(limits)
        self.width = self.limits[:, 1] - self.limits[:, 0]
        self.longest = step
        self.returns = ReturnMap(
            Forcing.of(orbit.case), orbit.cycles, axes, phase=orbit.phase, mirrored=orbit.is_symmetric
        )
        self.start: Row = orbit, np.array([present(number_at(orbit.case, axis)) for axis in axes])
        self.reasons: list[str] = []
        """Reason why the curve ends on each side that was followed; empty at a limit."""
        self._begin = orbit.state, self.start[1]

    def is_inside(self, values: Vector) -> bool:
        """Return whether values of both parameters are between their limits."""
        return bool((values >= self.limits[:, 0]).all() and (values <= self.limits[:, 1]).all())

    def follow(self, side: float, most: int) -> Iterator[Row]:
        """Yield the motions on one side of the start."""
        returns, (state, values) = self.returns, self._begin
        scale = present(size_of(returns, self.start[0].state))
        length, count = self.longest / 4, 0
        linear = self.linear(returns, state, values, scale)
        if linear is None:
            self.reasons.append(LOST)
            return
        tangent = side * _null(linear[1])
        while count < most:
            n = state.size
            guess = state + length * tangent[:n] * scale, values + length * tangent[n:] * self.width
            corrected = self.correct(returns, *guess, scale, tangent)
            row = None if corrected is None else self.row(returns, *corrected[:2], scale, tangent)
            if corrected is None or row is None:
                length /= 2
                if length < SHORTEST:
                    self.reasons.append(LOST)
                    return
                continue
            if not self.is_inside(row[1]):
                self.reasons.append("")
                return
            state, values, slopes, used = corrected
            new = _null(slopes)
            tangent = new if new @ tangent > 0 else -new
            yield row
            count += 1
            length = min(1.4 * length, self.longest) if used <= 3 else length / 2 if used >= 6 else length
            # The map begins in the longest flight when an impact comes near its beginning.
            here = ReturnMap(Forcing.of(row[0].case), returns.cycles, phase=returns.phase)
            moved, there = away_from_impacts(here, state)
            if moved.phase != returns.phase:
                returns, state = returns.with_(phase=moved.phase), there
                linear = self.linear(returns, state, values, scale)
                if linear is None:
                    self.reasons.append(LOST)
                    return
                new = _null(linear[1])
                tangent = new if new[n:] @ tangent[n:] > 0 else -new
        self.reasons.append(f"the limit of {several(count, 'point')} is reached")

    def row(self, returns: ReturnMap, state: Vector, values: Vector, scale: Vector, normal: Vector) -> Row | None:
        """Return the motion at a corrected point and the values of the parameters; None if it cannot be computed."""
        shot = returns.shoot(state[None], values.tolist())
        found = orbit_of(returns, shot, state, scale, values.tolist()) if shot.is_complete else None
        return None if found is None else (found, values)

    def linear(self, returns: ReturnMap, state: Vector, values: Vector, scale: Vector) -> tuple[Vector, Vector] | None:
        """Return residual and additional equation, (n + 1,), and their scaled derivatives, (n + 1, n + 2)."""
        raise NotImplementedError

    def scaled_slopes(self, shot: Shot, scale: Vector) -> Vector:
        """Return the scaled derivatives of the residual with respect to state and parameters, (n, n + 2)."""
        by_state = shot.jacobian() * scale / scale[:, None]
        return np.column_stack([by_state, shot.by_parameter[0] * self.width / scale[:, None]])

    def correct(
        self, returns: ReturnMap, state: Vector, values: Vector, scale: Vector, normal: Vector
    ) -> tuple[Vector, Vector, Vector, int] | None:
        """Return state, values, derivatives and number of corrections of the point in the plane through a guess."""
        n = state.size
        for count in range(1, _CORRECTIONS + 1):
            away = np.abs(values - self.limits.mean(axis=1)) > 1.5 * self.width
            if away.any() or (values <= 0)[self.limits[:, 0] > 0].any():
                return None
            linear = self.linear(returns, state, values, scale)
            if linear is None:
                return None
            right, slopes = linear
            change = np.linalg.lstsq(np.vstack([slopes, normal]), -np.append(right, 0.0), rcond=None)[0]
            if not np.isfinite(change).all() or np.abs(change).max() > 0.5:
                return None
            if np.abs(right[:-1]).max() < TOLERANCE and abs(right[-1]) < self.zero and np.abs(change).max() < 1e-6:
                return state, values, slopes, count
            state, values = state + change[:n] * scale, values + change[n:] * self.width
        return None


class StabilityCurve(Curve):
    """Curve on which multipliers are at a limit of stability."""

    def __init__(
        self, point: SpecialPoint, axes: tuple[str, ...], limits: Sequence[tuple[float, float]], step: float
    ) -> None:
        super().__init__(point, axes, limits, step)
        self.test = TESTS[point.kind]

    def _psi(self, returns: ReturnMap, state: Vector, values: Vector) -> float:
        """Return the test function; NaN if the motion cannot be computed."""
        shot = returns.shoot(state[None], values.tolist())
        if not shot.is_complete:
            return float("nan")
        return self.test(np.linalg.eigvals(shot.monodromy()).astype(complex))

    def linear(self, returns: ReturnMap, state: Vector, values: Vector, scale: Vector) -> tuple[Vector, Vector] | None:
        """Return residual and test function, (n + 1,), and their scaled derivatives, (n + 1, n + 2)."""
        n = state.size
        shot = returns.shoot(state[None], values.tolist())
        if not shot.is_complete:
            return None
        top = self.scaled_slopes(shot, scale)
        sizes = np.concatenate([scale, self.width]) * _CHANGE
        row = np.zeros(n + 2)
        for k, size in enumerate(sizes):
            change = np.zeros(n + 2)
            change[k] = size
            up = self._psi(returns, state + change[:n], values + change[n:])
            down = self._psi(returns, state - change[:n], values - change[n:])
            row[k] = (up - down) / (2 * _CHANGE)
        value = self.test(np.linalg.eigvals(shot.monodromy()).astype(complex))
        result = np.append(shot.residual[0] / scale, value), np.vstack([top, row])
        return result if np.isfinite(result[1]).all() else None


def _null(slopes: Vector) -> Vector:
    """Return the unit vector in which all derivatives vanish."""
    *_, rows = np.linalg.svd(slopes)
    return np.asarray(rows[-1])
