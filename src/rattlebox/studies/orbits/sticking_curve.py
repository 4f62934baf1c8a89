"""Curve in two parameters on which bodies begin to stick together in a periodic motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox.studies.orbits.curve import Curve, Row
from rattlebox.studies.orbits.find import away_from_impacts, size_of
from rattlebox.studies.orbits.forcing import Forcing
from rattlebox.studies.orbits.orbit import Orbit, orbit_of
from rattlebox.studies.orbits.shooting import ReturnMap, Shot, solve

Vector = NDArray[np.float64]

_ACCURATE = 1e-10
"""Accuracy of the curve across its direction, over the ranges of the parameters."""
_DISTANCES = (1e-4, 4e-4, 1.6e-3, 6.4e-3, 2.5e-2)
"""Distances from a guess at which the other side is sought, over the ranges of the parameters."""
_NEAR = 0.1
"""Largest change of the state between both sides over the size of the motion."""


class _Side(NamedTuple):
    """A motion near the curve: its state, the values of the parameters, whether bodies stick, and its map over a period."""

    state: Vector
    values: Vector
    sticks: bool
    shot: Shot


class StickingCurve(Curve):
    """Curve that separates motions in which bodies rest on each other from those in which they do not.

    On the curve, the force that presses the bodies together is zero at the instant at which the rest would begin. After
    incomplete chatter, motions near the curve have many slow impacts and no smooth derivatives, so that the limit is
    bisected across it.
    """

    def begin(self, side: float) -> None:
        """Return to the start, to follow one side of it."""
        self._near, self._place = self.start[0], self.start[1] / self.width
        # The first step goes along the second parameter; the limit is sought along the first one.
        self._tangent = np.array([0.0, side])

    def step(self, length: float) -> tuple[Row, int] | None:
        """Move along the last chord; return the motion at the limit there and no correction, or None if there is none."""
        tangent = self._tangent
        row = self._across(self._near, self._place + length * tangent, np.array([tangent[1], -tangent[0]]))
        if row is None:
            return None
        self._near, place = row[0], row[1] / self.width
        moved, self._place = place - self._place, place
        self._tangent = moved / np.linalg.norm(moved)
        return row, 0

    def _across(self, near: Orbit, place: Vector, across: Vector) -> Row | None:
        """Return the motion at the limit on the line through a guess across the curve; None if there is none near."""
        here = ReturnMap(Forcing.of(near.case), self.returns.cycles, phase=near.phase, mirrored=near.is_symmetric)
        moved, state = away_from_impacts(here, near.state)
        returns, scale = self.returns.with_(phase=moved.phase), size_of(moved, state)
        if scale is None:
            return None

        def motion(state: Vector, place: Vector) -> _Side | None:
            return _motion(returns, state, scale, place * self.width)

        first = motion(state, place)
        if first is None:
            return None
        for distance in _DISTANCES:
            for way in (1.0, -1.0):
                other = motion(first.state, place + way * distance * across)
                if other is None or other.sticks == first.sticks:
                    continue
                low, high = first, other
                while np.abs((high.values - low.values) / self.width).max() > _ACCURATE:
                    middle = motion(low.state, 0.5 * (low.values + high.values) / self.width)
                    if middle is None:
                        return None
                    low, high = (middle, high) if middle.sticks == low.sticks else (low, middle)
                orbit = orbit_of(returns, low.shot, low.state, scale, low.values.tolist())
                return None if orbit is None else (orbit, 0.5 * (low.values + high.values))
        return None


def _motion(returns: ReturnMap, state: Vector, scale: Vector, values: Vector) -> _Side | None:
    """Return the motion next to a state at some values of the parameters; None if there is none."""
    found = solve(returns, state[None], scale, values.tolist())
    if found is None or np.abs((found[0][0] - state) / scale).max() > _NEAR:
        return None
    stretch = found[1].ends[0].transition
    return None if stretch is None else _Side(found[0][0], values, stretch.raw.counts.sticks > 0, found[1])
