"""Pseudo-arclength continuation of a periodic motion in one parameter.

References
----------
H. B. Keller (1977), Numerical solution of bifurcation and nonlinear eigenvalue problems, in: P. H. Rabinowitz (ed.),
Applications of Bifurcation Theory, Academic Press, 359-384.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from rattlebox.studies.orbits.branch_words import stopped_words
from rattlebox.studies.orbits.corrector import TESTS, Corrector, Point
from rattlebox.studies.orbits.grazing import (
    NAMES,
    NOT_FOUND,
    Indicator,
    Passage,
    approach,
    begins,
    beyond,
    is_pressed,
    passage_words,
    with_passage,
)
from rattlebox.studies.orbits.shooting import ReturnMap, solve
from rattlebox.studies.orbits.stability import ON_CIRCLE, flip_test
from rattlebox.studies.orbits.symmetry import stays_mirrored

_FEW, _MANY = 3, 5
"""Numbers of corrections at which a step becomes longer or shorter."""
_SHORTEST = 1e-7
"""Shortest step along the branch, where the size of the motion and the range of the parameter are 1."""
_TINY = 1e-3
"""Length of a step over the longest one, that counts as tiny."""
_MOST_TINY = 40
"""Largest number of tiny steps one after the other, after which the branch ends."""
_SECANT, _SECANTS = 1e-4, 12
"""First step, over the range of the parameter, and largest number of steps to the end of a branch in its image."""
_NEAR_FOLD = 0.05
"""Largest change of the state on the way, over the size of the motion."""
_REPEATED = 1e-7
"""Largest change of the state after half of the period of a motion that repeats then."""
_ON_CIRCLE = 1e-6
"""Largest distance of a multiplier from -1 there."""
_ACCURATE = 1e-12
"""Accuracy of the value of the parameter there, over its range."""
_IMAGES = {
    "pitchfork": "the mirror images of these motions follow",
    "flip": "the same motions follow, half of their period later",
}
"""Reasons why a branch ends where it turns back into its image, by the special point there."""
_JUMP = 1e-3
"""Change of the state over the size of the motion, between neighbouring points, that no single branch has."""
_SAME_PHASE = 9
"""Number of decimal places to which the phases of impacts at the same time agree."""
_COINCIDES = 1e-4
"""Time between two impacts over the period of the loads, at which a branch ends because they coincide."""
_LOOP = 10
"""Number of points after which a branch may be closed."""


@dataclass(frozen=True)
class Restart:
    """State of the loop of a continuation after a point: a restart from it yields the same bits as no stop."""

    point: Point
    before: Point | None
    length: float
    count: int
    tiny: int


class Follower:
    """Continuation of a periodic motion along one parameter between limits."""

    def __init__(self, corrector: Corrector) -> None:
        self.corrector = corrector
        self.is_closed = False
        returns = corrector.returns
        self._is_mirrored = stays_mirrored(returns.forcing, returns.parameters, [corrector.limits])
        self.reasons: list[str] = []
        """Reason why the branch ends on each side that was followed; empty at a limit."""
        self.loop: tuple[float, int, int, bool] = 0.0, 0, 0, False
        """Length, count and tiny steps of the loop when `proceed` is called, and whether the point before is known."""

    def follow(
        self,
        start: Point,
        most: int,
        proceed: Callable[[], bool],
        restart: Restart | None = None,
        other_end: Point | None = None,
    ) -> Iterator[Point]:
        """Yield the points after a start, with special points, up to the limits or the end of the branch.

        A branch that comes to `other_end`, the last point of the side that was followed before, is a closed curve.
        """
        corrector = self.corrector
        longest = corrector.longest
        point, length, count, tiny = corrector.resection(start), longest / 4, 0, 0
        before: Point | None = None
        if restart is not None:
            point, length, count, tiny = corrector.resection(restart.point), restart.length, restart.count, restart.tiny
            before = None if restart.before is None else corrector.resection(restart.before)
        while count < most and self._proceeds(proceed, (length, count, tiny, before is not None)):
            tiny = tiny + 1 if length < _TINY * longest else 0
            taken = corrector.step(point, length)
            is_near = taken is not None and corrector.is_near(point, taken[0])
            changes = taken is None or not is_near or taken[0].contacts != point.contacts
            # Near grazing the map is a square root, which no step crosses.
            if changes and before is not None and (event := approach(corrector, before, point, longest)) is not None:
                passage = yield from self._graze(point, *event)
                if passage is None:
                    return
                count += len(event[0]) + 1
                before, point, length = None, corrector.resection(passage.point), longest / 64
                continue
            # The branch turns too much, a step leads to another branch, or Newton's method fails: a shorter step.
            if taken is None or not is_near or self._jumps(point, taken[0]):
                length /= 2
                if length < _SHORTEST or tiny > _MOST_TINY:
                    self.reasons.append(_end_words(point))
                    return
                continue
            after, corrections = taken
            found, image = self._special(point, after)
            # The last point is at the limit, not beyond it; the branch may also turn back beyond it.
            if not all(map(self._is_inside, both := (*found, after))):
                self.reasons.append("")
                yield from self._up_to_limit(point, next(each for each in both if not self._is_inside(each)))
                return
            if not image and self._repeats_sooner(after):
                found, image = self._turned_back(after)
            yield from found
            if image:
                self.reasons.append(image)
                return
            yield after
            count += 1
            if corrections <= _FEW:
                length = min(1.4 * length, longest)
            elif corrections >= _MANY:
                length /= 2
            if (count > _LOOP and self._has_returned(start, point, after)) or self._meets(other_end, point, after):
                self.is_closed = True
                return
            moved = corrector.resection(after)
            # Distances are between points whose maps begin at the same phase.
            before, point = (point if moved is after else None), moved
        self.reasons.append(stopped_words(count, most))

    def _is_inside(self, point: Point) -> bool:
        """Return whether the parameter of a point is between its limits, not at one of them."""
        low, high = self.corrector.limits
        return low < point.value < high

    def _jumps(self, point: Point, after: Point) -> bool:
        """Return whether the sequence of impacts changes between two points at a jump, from one branch to another."""
        if _sequence(point) == _sequence(after):
            return False
        low, high = self.corrector.change(point, after, _sequence)
        if point.contacts != after.contacts and not any(map(begins, (low, high))):
            return True  # no impact begins or ends here
        return bool(np.abs((high.orbit.state - low.orbit.state) / point.scale).max() > _JUMP)

    def _proceeds(self, proceed: Callable[[], bool], loop: tuple[float, int, int, bool]) -> bool:
        """Return whether to proceed, while the state of the loop is known."""
        self.loop = loop
        return proceed()

    def _graze(self, point: Point, points: list[Point], indicator: Indicator) -> Generator[Point, None, Passage | None]:
        """Yield points up to a grazing and the first one past it; return how the branch continues, None if it ends."""
        row, passage = [point, *points], None
        outside = next((k for k, each in enumerate(row) if not self._is_inside(each)), len(row))
        if outside == len(row):
            passage = beyond(self.corrector, row[-2], row[-1], indicator)
            row[-1] = with_passage(row[-1], passage)
        for last, each in pairwise(row[:outside]):
            found, image = self._special(last, each)
            yield from found
            if image:
                self.reasons.append(image)
                return None
            yield each
        if outside < len(row):  # the branch reaches its limit before it grazes
            self.reasons.append("")
            yield from self._up_to_limit(row[outside - 1], row[outside])
        elif passage is None:
            self.reasons.append(f"grazing, {NOT_FOUND}")
        else:
            yield passage.point
        return passage

    def _up_to_limit(self, point: Point, after: Point) -> list[Point]:
        """Return the special points between the last point and the limit, and the point at the limit."""
        last = self.corrector.at_limit(point, after)
        return [] if last is None else [*self._special(point, last)[0], last]

    def _has_returned(self, start: Point, point: Point, after: Point, direction: float = 1.0) -> bool:
        """Return whether the branch passes its start between two points, in the same direction or, with -1, in the other."""
        low, high = sorted((point.value, after.value))
        if not low <= start.value <= high or direction * after.tangent[-1] * start.tangent[-1] <= 0:
            return False
        share = (start.value - point.value) / (after.value - point.value) if high > low else 0.5
        sizes = start.orbit.amplitudes
        for name, size in sizes.items():
            one, other = point.orbit.amplitudes[name], after.orbit.amplitudes[name]
            if abs(one + share * (other - one) - size) > 0.01 * max(sizes.values()):
                return False
        old, new = (np.sort([impact.approach_speed for impact in each.orbit.impacts]) for each in (start, after))
        return old.size == new.size and bool(np.allclose(old, new, rtol=0.1))

    def _meets(self, other_end: Point | None, point: Point, after: Point) -> bool:
        """Return whether the branch comes to the end of its other side, which then ended within a closed curve."""
        meets = other_end is not None and self._has_returned(other_end, point, after, -1.0)
        if meets:
            self.reasons.clear()
        return meets

    def _special(self, point: Point, after: Point) -> tuple[list[Point], str]:
        """Return the special points between two points in their order, and the reason if the branch ends there, or ""."""
        found, image = [], ""
        for name, test in TESTS.items():
            low, high = test(point), test(after)
            if low * high < 0 and (located := self.corrector.locate(point, after, test)) is not None:
                kind = _kind(name, located)
                if kind and (kind != "torus" or _leaves_circle(located, point, after)):
                    found.append(_named(located, kind))
        found += self._changes(point, after)
        names = [each.special for each in found]
        if "fold" in names:
            fold = names.index("fold")
            found[fold] = self._halved(found[fold])
            if found[fold].special != "fold":
                image = _IMAGES[found[fold].special]
                found = [each for each in found if each.special != "branch point"]
        return sorted(found, key=lambda each: self.corrector.distance(point, each)), image

    def _turned_back(self, after: Point) -> tuple[list[Point], str]:
        """Return the special point and the reason of the end if a step has led to the motions that the branch ends in."""
        end = self._halved(after)
        if end.special not in _IMAGES:
            return [], "a motion of half of the period follows"
        return [end], _IMAGES[end.special]

    def _half(self, point: Point) -> ReturnMap | None:
        """Return the map over half of the period, mirrored if the period is odd; None if the case has no mirror image."""
        returns = point.returns
        if returns.cycles % 2 == 0:
            return returns.with_(cycles=returns.cycles // 2)
        return None if returns.mirrored or not self._is_mirrored else returns.with_(mirrored=True)

    def _repeats_sooner(self, point: Point) -> bool:
        """Return whether a motion is one of half of the period, or symmetric, though the branch is not."""
        half = self._half(point)
        if half is None:
            return False
        shot = half.shoot(point.orbit.state[None], [point.value], derivatives=False)
        return shot.is_complete and bool(np.abs(shot.residual / point.scale).max() < _REPEATED)

    def _halved(self, point: Point) -> Point:
        """Return the flip or pitchfork at which a branch turns back into its image; the same point if there is none."""
        # The motion there repeats after half of its period, or with the opposite sign if the branch lost the symmetry, and
        # the map over this half has a multiplier -1. That over the whole period is singular in two directions, and its
        # fixed points are inaccurate.
        returns, state = self._half(point), point.orbit.state
        if returns is None:
            return point
        values, tests = [point.value, point.value + _SECANT * self.corrector.width], list[float]()
        while len(tests) < _SECANTS:
            found = solve(returns, state[None], point.scale, [values[len(tests)]])
            if found is None or np.abs((found[0][0] - point.orbit.state) / point.scale).max() > _NEAR_FOLD:
                return point
            state = found[0][0]
            multipliers = np.linalg.eigvals(found[1].monodromy())
            tests.append(flip_test(multipliers.astype(complex)))
            if len(tests) < 2:
                continue
            step = tests[-1] * (values[-1] - values[-2]) / (tests[-1] - tests[-2]) if tests[-1] != tests[-2] else 0.0
            if abs(step) < _ACCURATE * self.corrector.width:
                break
            values.append(values[-1] - step)
        if np.abs(multipliers + 1).min() > _ON_CIRCLE:
            return point
        value = values[len(tests) - 1]
        shot = point.returns.shoot(state[None], [value])
        there = self.corrector.finish(point.returns, state, value, shot, point.scale, point.tangent)
        return _named(there or point, "pitchfork" if returns.mirrored else "flip")

    def _changes(self, point: Point, after: Point) -> list[Point]:
        """Return the point between two points at which sticking begins or ends, or else the sequence of impacts changes."""
        if point.orbit.sticks != after.orbit.sticks:
            low, high = self.corrector.change(point, after, lambda each: each.orbit.sticks)
            return [replace(low, special="sticking", located=0.5 * (low.value + high.value))]
        if point.contacts != after.contacts:
            low, high = self.corrector.change(point, after, lambda each: each.contacts)
            gains = high.contacts.total() > low.contacts.total()
            # The number of impacts of complete chatter depends on the threshold of sticking, but not whether there is one:
            # a ball that rests at all times leaves its wall where the force between them reaches zero.
            chatters = low.orbit.sticks and high.orbit.sticks and low.contacts.keys() == high.contacts.keys()
            if chatters and is_pressed(high if gains else low):
                return []
            located = 0.5 * (low.value + high.value)
            passage = passage_words(high, (point.value - located) * (after.value - located) > 0)
            kind = NAMES["miss" if gains else "slow"]
            return [replace(low, special=kind, located=located, passage=passage)]
        return []


def _sequence(point: Point) -> tuple[bool, tuple[int, ...]]:
    """Return whether bodies stick in the motion of a point, and the contacts of its impacts in their order."""
    # Impacts at the same time to rounding, as in equal dampers, are in the order of their contacts.
    impacts = sorted(point.orbit.impacts, key=lambda impact: (round(impact.phase, _SAME_PHASE), impact.contact))
    row = tuple(impact.contact for impact in impacts)
    # The order is that around the period, wherever an impact passes its beginning.
    return point.orbit.sticks, min((row[k:] + row[:k] for k in range(len(row))), default=row)


def _end_words(point: Point) -> str:
    """Return the reason why no further motion was found after a point."""
    impacts, cycles = point.orbit.impacts, point.orbit.cycles
    for one, other in pairwise((*impacts, *impacts[:1])):
        if one.contact != other.contact and (other.phase - one.phase) % 1.0 * cycles < _COINCIDES:
            return (
                f"impacts of {one.place} and {other.place} coincide, and the motion jumps where their order changes; no "
                "further motion was found"
            )
    return "no further motion was found"


def _kind(name: str, point: Point) -> str:
    """Return the name of a special point; empty if it is none."""
    values = point.multipliers()
    if name == "flip":
        # The test function jumps, too, where the sequence of impacts changes.
        near = np.abs(values + 1).min() < 1e-3
        return "" if not near else "pitchfork" if point.returns.mirrored else "flip"
    if name == "torus":
        angles = np.abs(np.angle(values[np.abs(np.abs(values) - 1) < 1e-4]))
        # Two real multipliers with the product 1 change no stability.
        return "torus" if angles.size >= 2 and (np.sin(angles) > 1e-3).any() else ""
    if name in ("fold", "branch point"):
        # The tangent may turn in chatter, too, where the branch has corners.
        return name if np.abs(values - 1).min() < 1e-3 else ""
    return name


def _leaves_circle(located: Point, *ends: Point) -> bool:
    """Return whether the product of the pair on the circle at a point differs from 1 at a neighbour, beyond rounding."""
    # The product is 1 along a whole branch of motions without losses, such as impacts below the speed of yield; it stays 1
    # where the pair meets and becomes real.
    values = located.multipliers()
    pair = min(values[values.imag > 0], key=lambda value: abs(abs(value) - 1))
    products = []
    for each in ends:
        both = sorted(each.multipliers(), key=lambda value: min(abs(value - pair), abs(value - pair.conjugate())))[:2]
        products.append(abs(both[0] * both[1]))
    return bool(np.abs(np.array(products) - 1).max() > ON_CIRCLE)


def _named(point: Point, kind: str) -> Point:
    """Return a special point with its name."""
    return replace(point, special=kind, located=point.value)
