"""Curves in two parameters across which bodies begin to stick together, or a contact begins, by bisection."""

from __future__ import annotations

from abc import abstractmethod
from collections import Counter
from collections.abc import Hashable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox.studies.orbits.curve import Curve, Row
from rattlebox.studies.orbits.find import away_from_impacts, size_of
from rattlebox.studies.orbits.forcing import Forcing
from rattlebox.studies.orbits.orbit import Orbit, orbit_of
from rattlebox.studies.orbits.shooting import ReturnMap, Shot, solve

if TYPE_CHECKING:
    from rattlebox.engines.transition import Transition

Vector = NDArray[np.float64]

_ACCURATE = 1e-10
"""Accuracy of the curve across its direction, over the ranges of the parameters."""
_DISTANCES = (1e-4, 4e-4, 1.6e-3, 6.4e-3, 2.5e-2)
"""Distances from a guess at which the other side is sought, over the ranges of the parameters."""
_NEAR = 0.1
"""Largest change of the state between both sides over the size of the motion."""


class _Side(NamedTuple):
    """A motion near the curve: its state, the values of the parameters, its side of the curve, and its map over a period."""

    state: Vector
    values: Vector
    label: Hashable
    shot: Shot


class BisectedCurve(Curve):
    """Curve that separates motions that differ in kind, and next to which motions have no smooth derivatives."""

    @abstractmethod
    def label(self, stretch: Transition) -> Hashable:
        """Return what differs between the motions on both sides."""

    def begin(self, side: float) -> None:
        """Return to the start, to follow one side of it."""
        self._near, self._place = self.start[0], self.start[1] / self.width
        # The first step goes along the second parameter; the limit is sought along the first one.
        self._tangent = np.array([0.0, side])

    def has_sides(self) -> bool:
        """Return whether motions of both kinds are found next to the start, which is moved onto the limit between them."""
        for across in (np.array([1.0, 0.0]), np.array([0.0, 1.0])):
            row = self._across(self.start[0], self.start[1] / self.width, across)
            if row is not None and np.abs((row[1] - self.start[1]) / self.width).max() < _DISTANCES[0]:
                self.start = row
                return True
        return False

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
        forcing = Forcing.of(near.case, self.returns.parameters)
        here = ReturnMap(forcing, self.returns.cycles, phase=near.phase, mirrored=self.returns.mirrored)
        moved, state = away_from_impacts(here, near.state)
        returns, scale = self.returns.with_(phase=moved.phase), size_of(moved, state)
        if scale is None:
            return None

        def motion(state: Vector, place: Vector) -> _Side | None:
            return self._motion(returns, state, scale, place * self.width)

        first = motion(state, place)
        if first is None:
            return None
        for distance in _DISTANCES:
            for way in (1.0, -1.0):
                other = motion(first.state, place + way * distance * across)
                if other is None or other.label == first.label:
                    continue
                low, high = first, other
                while np.abs((high.values - low.values) / self.width).max() > _ACCURATE:
                    middle = motion(low.state, 0.5 * (low.values + high.values) / self.width)
                    if middle is None:
                        return None
                    low, high = (middle, high) if middle.label == low.label else (low, middle)
                orbit = orbit_of(returns, low.shot, low.state, scale, low.values.tolist())
                return None if orbit is None else (orbit, 0.5 * (low.values + high.values))
        return None

    def _motion(self, returns: ReturnMap, state: Vector, scale: Vector, values: Vector) -> _Side | None:
        """Return the motion next to a state at some values of the parameters; None if there is none."""
        found = solve(returns, state[None], scale, values.tolist())
        if found is None or np.abs((found[0][0] - state) / scale).max() > _NEAR:
            return None
        stretch = found[1].ends[0].transition
        return None if stretch is None else _Side(found[0][0], values, self.label(stretch), found[1])


class StickingCurve(BisectedCurve):
    """Curve that separates motions in which bodies rest on each other from those in which they do not.

    On the curve, the force that presses the bodies together is zero at the instant at which the rest would begin. After
    incomplete chatter, motions near the curve have many slow impacts and no smooth derivatives.
    """

    def label(self, stretch: Transition) -> Hashable:
        """Return whether bodies stick together."""
        return bool(stretch.raw.counts.sticks > 0)


class ContactCurve(BisectedCurve):
    """Curve that separates motions with different numbers of contacts, where bodies are pressed together.

    A soft contact that lasts divides into two on the curve, where its force reaches zero; no near miss becomes an impact.
    """

    def label(self, stretch: Transition) -> Hashable:
        """Return the number of contacts of each pair of bodies."""
        return frozenset(Counter((touch.damper, touch.contact) for touch in stretch.contacts).items())
