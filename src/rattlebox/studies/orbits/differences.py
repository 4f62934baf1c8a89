"""Derivatives of a motion by central differences of fourth order, for motions with impacts at equal times."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.narrow import present
from rattlebox.core import _core
from rattlebox.core._core import Status
from rattlebox.prepare.pack import pack
from rattlebox.studies.orbits.flow_end import End, failed
from rattlebox.studies.orbits.forcing import number_at
from rattlebox.studies.orbits.motion import MOST_EVENTS, start_at

if TYPE_CHECKING:
    from rattlebox.model.case import Case

Vector = NDArray[np.float64]

Values = tuple[float, ...]
Job = tuple[Values, Vector, float]
"""Values of the parameters, state, and duration [s]."""

_STEPS = (2e-4, 1e-5, 5e-7)
"""Steps of the differences over the size of a component, the first with which two differences agree."""
_AGREE = 1e-4
"""Largest difference of two differences, over the largest derivative."""
_KNOWN = 64
"""Number of packed cases that are stored."""


class Differences:
    """Derivatives of motions of a case from any state, at values of some parameters."""

    def __init__(self, case: Case, parameters: Sequence[str] = ()) -> None:
        self._case, self._parameters = case, tuple(parameters)
        self._known: dict[tuple[float, ...], _core.Problem] = {}
        self._values = tuple(present(number_at(case, path)) for path in self._parameters)
        problem = self._problem(self._values)
        self._sizes = _sizes(problem)

    def over(self, state: Vector, duration: float, values: Sequence[float] | None = None) -> End:
        """Return the end of the motion after some time [s]; the state is NaN if it cannot be computed."""
        chosen = self._values if values is None else tuple(float(value) for value in values)
        for step in _STEPS:
            ends, status = self._ends(self._neighbours(state, duration, chosen, step))
            if status != Status.finished:
                continue
            near, back, far, far_back = ends[1:].reshape(-1, 4, state.size).transpose(1, 2, 0)
            sizes = step * np.concatenate([self._sizes, [abs(value) or 1.0 for value in chosen], [duration]])
            one, two = (near - back) / (2 * sizes), (far - far_back) / (4 * sizes)
            # Near grazing the motion changes fast with its start, and the steps must be shorter.
            if np.abs(one - two).max() < _AGREE * np.abs(one).max():
                break
        if status != Status.finished:
            return failed(state.size)
        n, slopes = state.size, (4 * one - two) / 3
        return End(ends[0], True, slopes[:, :n], slopes[:, n:-1], slopes[:, -1])

    def _neighbours(self, state: Vector, duration: float, chosen: Values, step: float) -> list[Job]:
        """Return the motion and its neighbours in each component, each parameter, and the duration."""
        jobs: list[Job] = [(chosen, state, duration)]
        for k in range(state.size):
            jobs += [(chosen, _moved(state, k, factor * step * self._sizes[k]), duration) for factor in _FACTORS]
        for k, value in enumerate(chosen):
            change = step * (abs(value) or 1.0)
            jobs += [
                (tuple(_moved(np.array(chosen), k, factor * change).tolist()), state, duration) for factor in _FACTORS
            ]
        return [*jobs, *((chosen, state, duration * (1 + factor * step)) for factor in _FACTORS)]

    def _ends(self, jobs: Sequence[Job]) -> tuple[Vector, Status]:
        """Return the states at the ends of motions, (jobs, n), and the status of the first that was not finished."""
        problems = [start_at(self._problem(at), state, length, np.array([0.0, length])) for at, state, length in jobs]
        results = _core.simulate(problems, 1)
        n = jobs[0][1].size
        for result in results:
            if result.status != Status.finished:
                return np.full((len(jobs), n), np.nan), result.status
        return np.array([result.state[-1, :n] for result in results]), Status.finished

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
