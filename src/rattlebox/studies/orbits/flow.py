"""Stretches of a motion with the derivatives of their ends with respect to the start and to parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rattlebox.core import _core
from rattlebox.engines.transition import Flow as Stretches
from rattlebox.engines.transition import Transition
from rattlebox.model.paths import get
from rattlebox.prepare.pack import pack
from rattlebox.studies.orbits.motion import MOST_EVENTS, GapLines

if TYPE_CHECKING:
    from rattlebox.model.case import Case

Vector = NDArray[np.float64]

_BESIDE = 1e-6
"""Distance of the motions beside one whose impacts coincide, over the sizes of the components of the state."""
_CONTINUOUS = 1e-2
"""Largest part of the difference of both that their derivatives may leave if the motion is continuous in its start."""


@dataclass(frozen=True)
class End:
    """End of a stretch of a motion from a state, and its derivatives.

    `ok` is whether it was computed. `matrix` (n, n) is the derivative with respect to the state at the start, `by_parameter`
    (n, p), `by_time` (n,) the rate of change at the end; all empty if they are not requested. `transition` is the
    stretch itself; None if its derivatives are means of two others.
    """

    state: Vector
    ok: bool
    matrix: Vector
    by_parameter: Vector
    by_time: Vector
    transition: Transition | None = None


def _failed(size: int) -> End:
    """Return the end of a motion that was not computed."""
    empty = np.zeros((size, 0))
    return End(np.full(size, np.nan), False, empty, empty, empty)


class Flow:
    """Motions of a case from any state, at values of some parameters."""

    def __init__(self, case: Case, parameters: Sequence[str] = ()) -> None:
        most = min(get(case, "method.max_events"), MOST_EVENTS)
        self._case, self._parameters = case, tuple(parameters)
        self._exact = Stretches.of(case.replaced({"method.max_events": most}), self._parameters)

    def over(
        self,
        state: Vector,
        duration: float,
        values: Sequence[float] | None = None,
        *,
        start: float = 0.0,
        derivatives: bool = True,
    ) -> End:
        """Return the end of the motion after some time [s]; the state is NaN if it cannot be computed.

        Where hard impacts coincide, or the speed of one is at a kink of its law, derivatives are the means of those on both
        sides. They do not exist, and the motion counts as not computed, if it jumps there: if one impact changes the
        approach speed of the other, another order of both leads to another motion.
        """
        chosen = values if self._parameters else None
        end = self._exact.over(state, start, duration, chosen, derivatives)
        if derivatives and end.status in ("simultaneous", "kink"):
            return self._mean(state, duration, chosen, start)
        if end.status != "finished":
            return _failed(state.size)
        empty = np.zeros((state.size, 0))
        if not derivatives:
            return End(end.state, True, empty, empty, empty, end)
        return End(end.state, True, end.matrix, end.by_parameter, end.by_time, end)

    def _mean(self, state: Vector, duration: float, values: Sequence[float] | None, start: float) -> End:
        """Return the end with the means of the derivatives of motions on both sides."""
        # Another direction for each component, so that no impacts coincide.
        step = _BESIDE * self._sizes * np.cos(1.0 + np.arange(state.size))
        sides = [self._exact.over(state + side * step, start, duration, values, True) for side in (1.0, -1.0)]
        here = self._exact.over(state, start, duration, values, False)
        if any(end.status != "finished" for end in (*sides, here)):
            return _failed(state.size)
        one, other = sides
        matrix = 0.5 * (one.matrix + other.matrix)
        change, rest = 2 * matrix @ step / self._sizes, (one.state - other.state) / self._sizes
        if np.abs(rest - change).max() > _CONTINUOUS * np.abs(change).max():
            return _failed(state.size)
        by_parameter = 0.5 * (one.by_parameter + other.by_parameter)
        return End(here.state, True, matrix, by_parameter, 0.5 * (one.by_time + other.by_time))

    def coincides(self, state: Vector, duration: float) -> bool:
        """Return whether hard impacts of a motion coincide."""
        return self._exact.over(state, 0.0, duration).status == "simultaneous"

    @cached_property
    def _sizes(self) -> Vector:
        return _sizes(pack(self._case))

    def gap_lines(self, values: Sequence[float]) -> tuple[GapLines, list[GapLines]]:
        """Return the gaps as functions of the state at values of the parameters, and their derivatives in each of these."""
        problem = self._exact.variants(values)
        shapes = [np.asarray(damper.shape) for damper in problem.dampers]
        widths = [np.atleast_1d(np.asarray(damper.clearance, dtype=float)) for damper in problem.dampers]
        modes = int(problem.mode_decay.shape[0])

        def lines(shape: Sequence[Vector], width: Sequence[Vector], k: int) -> GapLines:
            dampers = [
                damper.replace(
                    shape=np.ascontiguousarray(one[:, k]),
                    clearance=float(two[k]),
                    mass=np.ascontiguousarray(np.asarray(damper.mass)[:, 0]),
                )
                for damper, one, two in zip(problem.dampers, shape, width, strict=True)
            ]
            return GapLines.of(dampers, modes)

        # Gaps are linear in shapes and clearances; the positions of balls in them depend on no parameter.
        by_shape = [self._exact.slopes(each, values) for each in shapes]
        by_width = [self._exact.slopes(each, values) for each in widths]
        slopes = [lines(by_shape, by_width, k) for k in range(len(self._parameters))]
        for each in slopes:
            each.by_state[:, 2 * modes :] = 0
        return lines(shapes, widths, 0), slopes


def _sizes(problem: _core.Problem) -> Vector:
    """Return lengths and speeds that suit the components of a state, (n,)."""
    rates = [float(load.signal.frequency) for load in problem.loads if isinstance(load.signal, _core.Harmonic)]
    omega = max(rates, default=1.0)
    half = np.array([0.5 * float(damper.clearance) for damper in problem.dampers for _ in range(np.size(damper.mass))])
    lengths = [0.5 * float(damper.clearance) for damper in problem.dampers if damper.clearance > 0]
    reach = np.zeros(problem.mode_decay.size)
    for damper in problem.dampers:
        reach = np.maximum(reach, np.abs(damper.shape))
    modal = min(lengths, default=1.0) / np.where(reach > 0, reach, 1.0)
    return np.concatenate([np.stack([modal, modal * omega], axis=1).ravel(), half, half * omega])
