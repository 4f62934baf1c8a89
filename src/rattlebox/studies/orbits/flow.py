"""A stretch of a motion with its derivatives, by central differences of fourth order of runs in one batch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rattlebox.core import _core
from rattlebox.core._core import Status
from rattlebox.model.paths import get
from rattlebox.prepare.pack import pack
from rattlebox.studies.orbits.motion import MOST_EVENTS, start_at

if TYPE_CHECKING:
    from rattlebox.model.case import Case

Vector = NDArray[np.float64]

_STEP = 2e-4
"""Step of the differences over the size of a component."""
_KNOWN = 64
"""Number of packed cases that are stored."""


@dataclass(frozen=True)
class End:
    """End of a stretch of a motion from a state, and its derivatives.

    `matrix` (n, n) is the derivative with respect to the state at the start, `by_parameter` (n, p), `by_time` (n,) the rate
    of change at the end; all empty if they are not requested.
    """

    state: Vector
    status: Status
    has_rest: bool
    matrix: Vector
    by_parameter: Vector
    by_time: Vector


class Flow:
    """Motions of a case from any state, at values of some parameters."""

    def __init__(self, case: Case, parameters: Sequence[str] = ()) -> None:
        self._case, self._parameters = case, tuple(parameters)
        self._known: dict[tuple[float, ...], _core.Problem] = {}
        self._values = tuple(float(get(case, path)) for path in self._parameters)
        problem = self._problem(self._values)
        self._sizes = _sizes(problem)

    def over(
        self, state: Vector, duration: float, values: Sequence[float] | None = None, *, derivatives: bool = True
    ) -> End:
        """Return the end of the motion after some time [s]; the state is NaN if it cannot be computed."""
        chosen = self._values if values is None else tuple(float(value) for value in values)
        jobs = [(chosen, state, duration)]
        steps = []
        if derivatives:
            n = state.size
            for k in range(n):
                steps.append(_STEP * self._sizes[k])
                jobs += [(chosen, _moved(state, k, factor * steps[-1]), duration) for factor in _FACTORS]
            for k, value in enumerate(chosen):
                steps.append(_STEP * (abs(value) or 1.0))
                jobs += [
                    (tuple(_moved(np.array(chosen), k, factor * steps[-1]).tolist()), state, duration)
                    for factor in _FACTORS
                ]
            steps.append(_STEP * duration)
            jobs += [(chosen, state, duration + factor * steps[-1]) for factor in _FACTORS]
        times = [np.array([0.0, length]) for _, _, length in jobs]
        problems = [
            start_at(self._problem(at), x, length, time) for (at, x, length), time in zip(jobs, times, strict=True)
        ]
        results = _core.simulate(problems, 1)
        failed = [result.status for result in results if result.status != Status.finished]
        empty = np.zeros((state.size, 0))
        if failed:
            return End(np.full(state.size, np.nan), failed[0], False, empty, empty, empty)
        ends = np.array([result.state[-1, : state.size] for result in results])
        rest = results[0].counts.sticks > 0
        if not derivatives:
            return End(ends[0], Status.finished, rest, empty, empty, empty)
        near, back, far, far_back = ends[1:].reshape(-1, 4, state.size).transpose(1, 2, 0)
        slopes = (8 * (near - back) - (far - far_back)) / (12 * np.array(steps))
        n = state.size
        return End(ends[0], Status.finished, rest, slopes[:, :n], slopes[:, n:-1], slopes[:, -1])

    def _problem(self, values: tuple[float, ...]) -> _core.Problem:
        """Return the packed case at values of the parameters."""
        if values not in self._known:
            if len(self._known) >= _KNOWN:
                self._known.clear()
            case = self._case.replaced(dict(zip(self._parameters, values, strict=True))) if values else self._case
            problem = pack(case)
            settings = problem.settings
            most = min(settings.max_events, MOST_EVENTS)
            settings = settings.replace(contact_samples=0, keep_end=False, max_events=most)
            self._known[values] = problem.replace(settings=settings)
        return self._known[values]


_FACTORS = (1.0, -1.0, 2.0, -2.0)


def _moved(x: Vector, k: int, step: float) -> Vector:
    """Return a copy with one component moved."""
    moved = x.copy()
    moved[k] += step
    return moved


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
