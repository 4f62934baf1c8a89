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
from rattlebox.studies.orbits.motion import MOST_EVENTS

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
        self, state: Vector, duration: float, values: Sequence[float] | None = None, *, derivatives: bool = True
    ) -> End:
        """Return the end of the motion after some time [s]; the state is NaN if it cannot be computed."""
        chosen = values if self._parameters else None
        end = self._exact.over(state, 0.0, duration, chosen, derivatives)
        if derivatives and end.status in _BY_DIFFERENCES:
            return self._differences.over(state, duration, chosen)
        if end.status != "finished":
            return failed(state.size)
        empty = np.zeros((state.size, 0))
        if not derivatives:
            return End(end.state, True, empty, empty, empty)
        return End(end.state, True, end.matrix, end.by_parameter, end.by_time)
