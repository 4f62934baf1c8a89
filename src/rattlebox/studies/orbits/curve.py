"""Curves of special points in two parameters by pseudo-arclength continuation of a motion and one more equation."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import CaseError
from rattlebox._util.narrow import present
from rattlebox.model.errors import Hint
from rattlebox.studies.orbits.branch_words import stopped_words
from rattlebox.studies.orbits.find import away_from_impacts, size_of
from rattlebox.studies.orbits.forcing import Forcing, number_at
from rattlebox.studies.orbits.orbit import Orbit, orbit_of
from rattlebox.studies.orbits.shooting import TOLERANCE, ReturnMap, Shot
from rattlebox.studies.orbits.stability import flip_test, fold_test, torus_test
from rattlebox.studies.orbits.symmetry import stays_mirrored

if TYPE_CHECKING:
    from rattlebox.studies.orbits.branch import SpecialPoint

Vector = NDArray[np.float64]

_CHANGES = (1e-5, 1e-6, 1e-7)
"""Steps of the central differences of the test function in scaled coordinates; next to grazing only short ones are valid."""
_SAME_SLOPE = 1e-2
"""Largest difference of the derivatives with two steps, over their size."""
_CORRECTIONS = 8
_FEW, _MANY = 3, 6
"""Numbers of corrections at which a step becomes longer or shorter."""
_ON_CIRCLE = 1e-3
"""Largest distance of a critical pair of multipliers from the unit circle."""
_SHORTEST = 1e-5
"""Shortest step, where the size of the motion and the ranges of the parameters are 1."""

TESTS: dict[str, Callable[[NDArray[np.complex128]], float]] = {
    "fold": fold_test,
    "flip": flip_test,
    "pitchfork": flip_test,
    "torus": torus_test,
}
"""Test functions of the multipliers of the map; that of a symmetric motion covers half a period."""

Row = tuple[Orbit, Vector]
"""A motion and the values of both parameters."""


class Curve(ABC):
    """Curve of a special point in two parameters, followed in steps on both sides of its start."""

    def __init__(
        self, point: SpecialPoint, axes: tuple[str, ...], limits: Sequence[tuple[float, float]], step: float
    ) -> None:
        orbit = point.orbit
        self.limits = np.array(limits)
        self.width = self.limits[:, 1] - self.limits[:, 0]
        self.longest = step
        forcing = Forcing.of(orbit.case, axes)
        mirrored = orbit.is_symmetric and stays_mirrored(forcing, axes, limits)
        if point.kind == "pitchfork" and not mirrored:
            raise Hint(
                f"the case is not symmetric at other values of {axes[0]} and {axes[1]}, and a pitchfork exists only in "
                "symmetric cases",
                "parameters that keep the symmetry, such as a frequency, an amplitude or the gap of a damper",
            )
        self.returns = ReturnMap(forcing, orbit.cycles, axes, phase=orbit.phase, mirrored=mirrored)
        self.start: Row = orbit, np.array([present(number_at(orbit.case, axis)) for axis in axes])
        self.reasons: list[str] = []
        """Reason why the curve ends on each side that was followed; empty at a limit."""

    def is_inside(self, values: Vector) -> bool:
        """Return whether values of both parameters are between their limits."""
        return bool((values >= self.limits[:, 0]).all() and (values <= self.limits[:, 1]).all())

    def follow(self, side: float, most: int, proceed: Callable[[], bool]) -> Iterator[Row]:
        """Yield the motions on one side of the start."""
        self.begin(side)
        length, count, is_valid = self.longest / 4, 0, True
        while count < most and proceed():
            try:
                taken, is_valid = self.step(length), True
            except CaseError:  # beyond a limit there may be no case, as with a negative gap
                taken, is_valid = None, False
            if taken is None:
                length /= 2
                if length < _SHORTEST:
                    self.reasons.append("no further motion was found" if is_valid else "")
                    return
                continue
            row, corrections = taken
            if (reason := self.end(row)) is not None:
                self.reasons.append(reason)
                return
            yield row
            count += 1
            if corrections <= _FEW:
                length = min(1.4 * length, self.longest)
            elif corrections >= _MANY:
                length /= 2
        self.reasons.append(stopped_words(count, most))

    def end(self, row: Row) -> str | None:
        """Return the reason if the curve ends before a motion, "" at a limit; None if it continues."""
        return None if self.is_inside(row[1]) else ""

    @abstractmethod
    def begin(self, side: float) -> None:
        """Return to the start, to follow one side of it."""

    @abstractmethod
    def step(self, length: float) -> tuple[Row, int] | None:
        """Move to the next motion; return it and the number of corrections, or None if there is none."""


class SmoothCurve(Curve):
    """Curve of motions that depend smoothly on both parameters, with one more equation (`linear`)."""

    zero = 1e-8
    """Largest value of the additional equation at a point."""

    def __init__(
        self, point: SpecialPoint, axes: tuple[str, ...], limits: Sequence[tuple[float, float]], step: float
    ) -> None:
        super().__init__(point, axes, limits, step)
        self._begin = point.orbit.state, self.start[1]

    def begin(self, side: float) -> None:
        """Return to the start, to follow one side of it."""
        self._at, (self._state, self._values) = self.returns, self._begin
        self._scale = present(size_of(self._at, self.start[0].state))
        first = self._null_vector()
        self._tangent = None if first is None else side * first

    def step(self, length: float) -> tuple[Row, int] | None:
        """Move along the tangent; return the motion and the number of corrections, or None if there is none."""
        returns, scale, tangent, n = self._at, self._scale, self._tangent, self._state.size
        if tangent is None:
            return None
        guess = self._state + length * tangent[:n] * scale, self._values + length * tangent[n:] * self.width
        corrected = self.correct(returns, *guess, scale, tangent)
        row = None if corrected is None else self.row(returns, *corrected[:2], scale, tangent)
        if corrected is None or row is None:
            return None
        self._state, self._values, slopes, count = corrected
        new = _null(slopes)
        self._tangent = new if new @ tangent > 0 else -new
        self._move_section(row[0])
        return row, count

    def _move_section(self, orbit: Orbit) -> None:
        """Let the map begin in the longest flight if an impact has come near its beginning."""
        here = ReturnMap(Forcing.of(orbit.case, self._at.parameters), self._at.cycles, phase=self._at.phase)
        moved, there = away_from_impacts(here, self._state)
        if moved.phase == self._at.phase:
            return
        self._at, self._state, old = self._at.with_(phase=moved.phase), there, present(self._tangent)
        new, n = self._null_vector(), there.size
        self._tangent = new if new is None or new[n:] @ old[n:] > 0 else -new

    def _null_vector(self) -> Vector | None:
        """Return the direction of the curve, on either side; None if the motion cannot be computed."""
        linear = self.linear(self._at, self._state, self._values, self._scale)
        return None if linear is None else _null(linear[1])

    def row(self, returns: ReturnMap, state: Vector, values: Vector, scale: Vector, normal: Vector) -> Row | None:
        """Return the motion at a corrected point and the values of the parameters; None if it cannot be computed."""
        shot = returns.shoot(state[None], values.tolist())
        found = orbit_of(returns, shot, state, scale, values.tolist()) if shot.is_complete else None
        return None if found is None else (found, values)

    @abstractmethod
    def linear(self, returns: ReturnMap, state: Vector, values: Vector, scale: Vector) -> tuple[Vector, Vector] | None:
        """Return residual and additional equation, (n + 1,), and their scaled derivatives, (n + 1, n + 2)."""

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


class StabilityCurve(SmoothCurve):
    """Curve on which multipliers are at a limit of stability."""

    def __init__(
        self, point: SpecialPoint, axes: tuple[str, ...], limits: Sequence[tuple[float, float]], step: float
    ) -> None:
        super().__init__(point, axes, limits, step)
        self.test = TESTS[point.kind]
        self._change = _CHANGES[-1]
        state, values = self._begin
        scale = present(size_of(self.returns, state))
        for change, shorter in pairwise(_CHANGES):
            one, other = (self._slopes(self.returns, state, values, scale, each) for each in (change, shorter))
            if np.abs(one - other).max() < _SAME_SLOPE * np.abs(other).max():
                self._change = change
                break

    def _psi(self, returns: ReturnMap, state: Vector, values: Vector) -> float:
        """Return the test function; NaN if the motion cannot be computed."""
        shot = returns.shoot(state[None], values.tolist())
        if not shot.is_complete:
            return float("nan")
        return self.test(np.linalg.eigvals(shot.monodromy()).astype(complex))

    def _slopes(self, returns: ReturnMap, state: Vector, values: Vector, scale: Vector, change: float) -> Vector:
        """Return the scaled derivatives of the test function by central differences, (n + 2,)."""
        n = state.size
        steps = np.diag(np.concatenate([scale, self.width]) * change)
        sides = [
            [self._psi(returns, state + side * step[:n], values + side * step[n:]) for step in steps]
            for side in (1.0, -1.0)
        ]
        return np.asarray((np.array(sides[0]) - np.array(sides[1])) / (2 * change))

    def linear(self, returns: ReturnMap, state: Vector, values: Vector, scale: Vector) -> tuple[Vector, Vector] | None:
        """Return residual and test function, (n + 1,), and their scaled derivatives, (n + 1, n + 2)."""
        shot = returns.shoot(state[None], values.tolist())
        if not shot.is_complete:
            return None
        row = self._slopes(returns, state, values, scale, self._change)
        value = self.test(np.linalg.eigvals(shot.monodromy()).astype(complex))
        result = np.append(shot.residual[0] / scale, value), np.vstack([self.scaled_slopes(shot, scale), row])
        return result if np.isfinite(result[1]).all() else None


class TorusCurve(StabilityCurve):
    """Curve on which a complex pair of multipliers is on the unit circle."""

    def end(self, row: Row) -> str | None:
        """Return the reason if the curve ends before a motion, also where the pair becomes real; see `Curve.end`."""
        # The product of the pair stays 1 beyond a double multiplier, as a curve of saddles without a change of stability.
        second = np.sort(np.abs(np.abs(row[0].multipliers) - 1))[1]
        return (
            super().end(row) if second < _ON_CIRCLE else "the pair of multipliers becomes real (1:1 or 1:2 resonance)"
        )


def _null(slopes: Vector) -> Vector:
    """Return the unit vector in which all derivatives vanish."""
    *_, rows = np.linalg.svd(slopes)
    return np.asarray(rows[-1])
