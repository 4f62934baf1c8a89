"""A stretch of a motion with its derivatives with respect to its start and to parameters."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rattlebox.engines import transition
from rattlebox.model.paths import get
from rattlebox.studies.orbits.differences import Differences
from rattlebox.studies.orbits.flow_end import End, failed
from rattlebox.studies.orbits.motion import MOST_EVENTS, GapLines

if TYPE_CHECKING:
    from rattlebox.model.case import Case

Vector = NDArray[np.float64]

_BY_DIFFERENCES = ("simultaneous", "kink")
"""Statuses of motions whose derivatives are not defined in all directions; differences are their means."""


class Flow:
    """Motions of a case from any state, at values of some parameters."""

    def __init__(self, case: Case, parameters: Sequence[str] = ()) -> None:
        most = min(get(case, "method.max_events"), MOST_EVENTS)
        self._case, self._parameters = case, tuple(parameters)
        self._exact = transition.Flow.of(case.replaced({"method.max_events": most}), self._parameters)

    @cached_property
    def _differences(self) -> Differences:
        return Differences(self._case, self._parameters)

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

        Differences, in place of exact derivatives, are available from the start of the loads only.
        """
        chosen = values if self._parameters else None
        end = self._exact.over(state, start, duration, chosen, derivatives)
        if derivatives and end.status in _BY_DIFFERENCES and start == 0:
            return self._differences.over(state, duration, chosen)
        if end.status != "finished":
            return failed(state.size)
        empty = np.zeros((state.size, 0))
        if not derivatives:
            return End(end.state, True, empty, empty, empty, end)
        return End(end.state, True, end.matrix, end.by_parameter, end.by_time, end)

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
