"""The return map of a case, with derivatives, and its fixed points by Newton's method.

References
----------
R. Seydel (2010), Practical Bifurcation and Stability Analysis, 3rd ed., Springer, chapter 7, doi:10.1007/978-1-4419-1740-9.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.paths import replaced
from rattlebox.prepare.pack import pack
from rattlebox.studies.orbits.flow import End, Flow
from rattlebox.studies.orbits.motion import GapLines

if TYPE_CHECKING:
    from rattlebox.studies.orbits.forcing import Forcing

Vector = NDArray[np.float64]

TOLERANCE = 1e-11
"""Largest residual of a periodic motion, over the size of each component of the state."""
_STEPS = 25
_HALVINGS = 6
_LONGEST_STEP = 1.0
"""Largest step, over the size of each component of the state."""


@dataclass(frozen=True)
class Shot:
    """Motion over one return from states at the beginnings of its segments.

    `residual` (m, n) is the jump at the end of each segment, `blocks` (m, n, n) the derivative of its end with respect to
    its start, `by_parameter` (m, n, p).
    """

    residual: Vector
    ends: tuple[Any, ...]
    blocks: Vector
    by_parameter: Vector

    @property
    def is_complete(self) -> bool:
        """Whether all segments have been computed to their end."""
        return all(end.ok for end in self.ends) and bool(np.isfinite(self.residual).all())

    def jacobian(self) -> Vector:
        """Return the derivative of the residual with respect to all states, (m n, m n)."""
        m, n = self.residual.shape
        out = np.zeros((m, n, m, n))
        for k in range(m):
            out[k, :, k, :] += self.blocks[k]
            out[k, :, (k + 1) % m, :] -= np.eye(n)
        return out.reshape(m * n, m * n)

    def monodromy(self) -> Vector:
        """Return the derivative of the return map, (n, n)."""
        total: Vector = np.eye(self.residual.shape[1])
        for block in self.blocks:
            total = block @ total
        return total


class ReturnMap:
    """Map of the state over some periods of the forcing, or over half of them with the opposite sign.

    `phase` is the part of the period of the forcing at which it begins. A mirrored map reflects the state at its end: its
    fixed points are the symmetric motions.
    """

    def __init__(
        self,
        forcing: Forcing,
        cycles: int,
        parameters: Sequence[str] = (),
        *,
        phase: float = 0.0,
        mirrored: bool = False,
        segments: int = 1,
    ) -> None:
        self.forcing, self.cycles, self.parameters = forcing, cycles, tuple(parameters)
        self.phase, self.mirrored, self.segments = phase % 1.0, mirrored, segments
        step = self.length(1.0)
        self.phases = [self.phase + k * step for k in range(segments)]
        self._flows = [Flow(forcing.shifted(each % 1.0), self.parameters) for each in self.phases]
        self.problem = pack(forcing.case)
        self.modes = int(self.problem.mode_decay.size)
        self.rows = [int(np.size(damper.mass)) for damper in self.problem.dampers]
        self.reflection = _reflection(self.modes, self.rows) if mirrored else np.eye(self.size)

    @property
    def size(self) -> int:
        """Number of components of the state."""
        return 2 * (self.modes + sum(self.rows))

    @property
    def lines(self) -> GapLines:
        """Gaps as functions of the state."""
        return GapLines.of(self.problem.dampers, self.modes)

    def length(self, period: float) -> float:
        """Return the duration of one segment for a period of the forcing."""
        return self.cycles * period / (2 if self.mirrored else 1) / self.segments

    def with_(self, **changes: Any) -> ReturnMap:
        """Return a map with other settings."""
        settings = {"phase": self.phase, "mirrored": self.mirrored, "segments": self.segments} | changes
        cycles, parameters = settings.pop("cycles", self.cycles), settings.pop("parameters", self.parameters)
        return ReturnMap(self.forcing, cycles, parameters, **settings)

    def shoot(self, states: Vector, values: Sequence[float] = (), *, derivatives: bool = True) -> Shot:
        """Return the motion from states (m, n) at values of the parameters."""
        period, slopes = self.forcing.period_of(self.parameters, values)
        length, n = self.length(period), self.size
        chosen = tuple(map(float, values)) if self.parameters else None
        ends, blocks, by = [], [], []
        residual = np.empty_like(states)
        for k, flow in enumerate(self._flows):
            end = flow.over(states[k], length, chosen, derivatives=derivatives)
            ends.append(end)
            if not end.ok:
                residual[k:] = np.nan
                return Shot(residual, tuple(ends), np.zeros((0, n, n)), np.zeros((0, n, 0)))
            last = k == self.segments - 1
            turn = self.reflection if last else np.eye(n)
            residual[k] = turn @ end.state - states[(k + 1) % self.segments]
            if derivatives:
                blocks.append(turn @ end.matrix)
                stretch = np.outer(end.by_time, self.length(1.0) * np.array(slopes)) if self.parameters else 0.0
                by.append(turn @ (end.by_parameter + stretch) if self.parameters else np.zeros((n, 0)))
        return Shot(residual, tuple(ends), np.array(blocks), np.array(by))

    def forcing_at(self, values: Sequence[float]) -> Forcing:
        """Return the forcing of the case at values of the parameters."""
        case = replaced(self.forcing.case, dict(zip(self.parameters, map(float, values), strict=True)))
        return type(self.forcing).of(case, self.parameters)

    def stretch(self, state: Vector, values: Sequence[float], begin: float, end: float) -> End:
        """Return the motion between two shares of the time of the map, from a state at the first one."""
        whole = self.length(self.forcing.period_of(self.parameters, values)[0]) * self.segments
        return self._flows[0].over(state, (end - begin) * whole, tuple(map(float, values)), start=begin * whole)

    def gap_lines(self, values: Sequence[float]) -> tuple[GapLines, list[GapLines]]:
        """Return the gaps as functions of the state at values of the parameters, and their derivatives in each of these."""
        return self._flows[0].gap_lines(tuple(map(float, values)))

    def coincides(self, state: Vector) -> bool:
        """Return whether hard impacts coincide in the motion from a state."""
        return self._flows[0].coincides(state, self.length(self.forcing.period) * self.segments)

    def part(self, duration: float, state: Vector, value: float, share: float) -> tuple[Vector, Vector, Vector] | None:
        """Return the state after a share of the period of the loads, and its derivatives by state and parameter."""
        end = self._flows[0].over(state, duration, (value,))
        if not end.ok:
            return None
        slope = self.forcing.period_of(self.parameters, (value,))[1][0]
        return end.state, end.matrix, end.by_parameter[:, 0] + end.by_time * share * slope

    def states_from(self, state: Vector) -> Vector:
        """Return the states at the beginnings of the segments of the motion from one state."""
        length = self.length(self.forcing.period)
        states = [state]
        for flow in self._flows[:-1]:
            states.append(flow.over(states[-1], length, derivatives=False).state)
        return np.array(states)


def _reflection(modes: int, rows: Sequence[int]) -> Vector:
    """Return the matrix that mirrors a state: all signs change, and so does the order of the balls in a cavity."""
    order = list(range(2 * modes))
    first, balls = 2 * modes, sum(rows)
    for half in (0, balls):
        start = first + half
        for count in rows:
            order += range(start + count - 1, start - 1, -1)
            start += count
    return -np.eye(len(order))[order]


def solve(
    returns: ReturnMap, states: Vector, scale: Vector, values: Sequence[float] = ()
) -> tuple[Vector, Shot] | None:
    """Return the fixed point near the given states and the motion there; None if Newton's method does not converge."""
    shot = returns.shoot(states, values)
    for _ in range(_STEPS):
        if not shot.is_complete:
            return None
        error = _size(shot, scale)
        step = _newton_step(shot)
        if step is None:
            return None
        if error < TOLERANCE and np.abs(step / scale).max() < 1e-3:
            # The last step costs nothing more and removes most of the remaining error.
            last = returns.shoot(states + step, values)
            return (states + step, last) if last.is_complete and _size(last, scale) <= error else (states, shot)
        damping = min(1.0, _LONGEST_STEP / float(np.abs(step / scale).max()))
        for _ in range(_HALVINGS):
            trial = returns.shoot(states + damping * step, values)
            if trial.is_complete and _size(trial, scale) < (1 - 0.1 * damping) * error:
                break
            damping /= 2
        else:
            return None
        states, shot = states + damping * step, trial
    return None


def _size(shot: Shot, scale: Vector) -> float:
    """Return the largest residual over the sizes of the components."""
    return float(np.abs(shot.residual / scale).max())


def _newton_step(shot: Shot) -> Vector | None:
    """Return the step to the zero of the linearised residual; None if there is none."""
    try:
        step = np.linalg.solve(shot.jacobian(), -shot.residual.ravel())
    except np.linalg.LinAlgError:
        return None
    return np.asarray(step).reshape(shot.residual.shape) if np.isfinite(step).all() else None
