"""Growth of the distance between pairs of neighbouring motions, which is rescaled repeatedly (Benettin's method).

References
----------
G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn (1980), Lyapunov characteristic exponents for smooth dynamical systems
and for Hamiltonian systems, Meccanica 15, 9-20 and 21-30, doi:10.1007/BF02128236 and doi:10.1007/BF02128237.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from rattlebox.core import _core
from rattlebox.core._core import Status
from rattlebox.engines.batch import BlockOutput, run_block
from rattlebox.studies.grid.grid import Grid
from rattlebox.studies.work.gather_variants import gather_values, gather_variants
from rattlebox.studies.work.impact_work import ImpactWork
from rattlebox.studies.work.work import Cancelled

Array = NDArray[np.float64]

_ALIGNMENT_STEPS = 20  # steps in which a neighbour turns into the direction of the largest growth
_GOLDEN_RATIO = 0.6180339887498949  # of a step, added to find a time at which all contacts are open
_MAX_ATTEMPTS = 8
_SATURATED = 1e-3  # distance over the scale of distances
_MERGED = 2e-15  # distance over the size of the state
_CLOSED = 1e-12  # gap over the clearance


class Task(Protocol):
    """The variants and how their pairs are computed; see `Lyapunov` for the fields."""

    grid: Grid
    cycles: tuple[int, int] | None
    skip: float
    pairs: int
    distance: float
    reach: float
    seed: int

    @property
    def count(self) -> int:
        """Number of steps."""

    @property
    def sweep(self) -> ImpactWork:
        """The variants as a sweep."""


class _Stopped(Exception):
    """The work was cancelled."""


class Pairs:
    """Pairs of neighbouring motions for a range of variants.

    Arrays have the axes (variant, pair, member of the pair, component of the state).
    """

    def __init__(self, task: Task, start: int, stop: int, threads: int, cancelled: Cancelled) -> None:
        self._task, self._threads, self._cancelled = task, threads, cancelled
        self._count = stop - start
        shape = task.grid.shape
        members = np.arange(start, stop)
        self._packed = gather_variants(task.sweep.packed, shape, members, 2)
        self._modes = len(self._packed.mode_decay)
        self.status = np.full((self._count, task.pairs), Status.finished)
        self.period = self._each(gather_values(task.sweep.output.period, shape, members, 2))
        duration = self._each(self._packed.settings.duration)
        length = duration - task.skip if task.cycles is None else task.cycles[1] * self.period
        self.leg = length / task.count
        self._skip = duration - length
        self._end = duration
        stiffness = self._each(np.max(self._packed.mode_stiffness, axis=0, initial=0.0))
        slowest = np.where(stiffness > 0, np.sqrt(stiffness), 2 * np.pi / length)
        rate = 2 * np.pi / self.period if task.cycles else slowest
        self._rng = np.random.default_rng(task.seed)
        self._begin(rate)

    def _is_cancelled(self) -> bool:
        return self._cancelled is not None and self._cancelled()

    def _each(self, number: Any) -> Array:
        """Return a packed number of each variant, (variants, 1)."""
        return np.array(np.broadcast_to(np.reshape(number, (-1, 1)), (self._count, 1)))

    def _begin(self, rate: Array) -> None:
        """Set the initial states, the weights of components in a distance, and the scale of distances."""
        packed, pairs = self._packed, self._task.pairs

        def rows(parts: Sequence[Array]) -> Array:
            found = [np.broadcast_to(part, (len(part), self._count, 1, 1)) for part in parts]
            return np.concatenate([np.zeros((0, self._count, 1, 1)), *found])

        q, p = rows([packed.mode_displacement]), rows([packed.mode_velocity])
        dampers = packed.dampers
        mass = rows([damper.mass for damper in dampers])
        place, speed = rows([damper.position for damper in dampers]), rows([damper.velocity for damper in dampers])
        clearance = [np.broadcast_to(d.clearance, (len(d.mass), self._count, 1, 1)) for d in dampers]
        reach = 0.5 * np.concatenate([np.zeros((0, self._count, 1, 1)), *clearance])
        slow = 1 / rate[None, :, :, None]
        offsets = self._task.reach * self._rng.uniform(-1, 1, pairs)[:, None] * (pairs > 1)
        parts = np.stack([q, p], axis=1).reshape(-1, self._count, 1, 1), place, speed + offsets * reach / slow
        self._start = np.moveaxis(
            np.concatenate([np.broadcast_to(part, (len(part), self._count, pairs, 1)) for part in parts]), 0, -1
        )
        root = np.sqrt(mass)
        modes = np.stack([np.ones_like(q), slow + 0 * q], axis=1).reshape(-1, self._count, 1, 1)
        self._weights = np.moveaxis(np.concatenate([modes, root, root * slow]), 0, -1)
        norm = np.linalg.norm(self._start * self._weights, axis=-1)[..., 0]
        balls = (root * reach)[0, ..., 0] if len(root) else np.where(norm > 0, norm, 1.0)
        self._scale = np.broadcast_to(balls, norm.shape)

    def growth(self) -> Array | None:
        """Return the logarithmic growth in each evaluated step, (variants, pairs, steps).

        It is NaN where a run did not finish. Return None if the work was cancelled.
        """
        try:
            return self._per_step(*self._rescale())
        except _Stopped:
            return None

    @property
    def _intact(self) -> NDArray[np.bool_]:
        """Pairs without a failed run."""
        return np.isin(self.status, (Status.finished, Status.energy_error))

    def _rescale(self) -> tuple[Array, Array]:
        """Return the times of rescaling, and the growth until then, (times, variants, pairs)."""
        state, time = self._settle(self._skip - np.minimum(0.5 * self._skip, _ALIGNMENT_STEPS * self.leg))
        state = self._add_neighbours(state)
        grown = np.zeros(time.shape)
        closed, halved = np.zeros(time.shape, int), np.zeros(time.shape, int)
        alive = self._intact
        times, sums = [time], [grown]
        distance = self._task.distance * self._scale
        while (going := alive & (self._end - time > 1e-9 * self.leg)).any():
            to_next = (np.floor(time / self.leg + 1e-6) + 1) * self.leg - time
            length = (to_next + self.leg * (2.0**closed - 1 + closed * _GOLDEN_RATIO % 1)) * 0.5**halved
            length = np.where(going, np.minimum(length, self._end - time), 1e-3 * self.leg)
            ended, alive = self._run(state, time, length, alive, going)
            difference = (ended[:, :, 1] - ended[:, :, 0]) * self._weights[:, :, 0]
            size = np.linalg.norm(difference, axis=-1)
            largest = np.maximum(np.linalg.norm(ended[:, :, 0] * self._weights[:, :, 0], axis=-1), self._scale)
            merged = going & alive & (size < _MERGED * largest)
            size = np.where(size > 0, size, 1.0)
            ended[:, :, 1] = ended[:, :, 0] + difference * (distance / size)[..., None] / self._weights[:, :, 0]
            last = time + length >= self._end - 1e-9 * self.leg
            # Rescale only when all contacts are open and the distance is still small; else try another step length.
            opened = last | (self._smallest_gap(ended) > _CLOSED).all(axis=-1)
            far = (size > _SATURATED * self._scale) & (halved < _MAX_ATTEMPTS)
            accepted = going & alive & opened & ~far
            closed = np.where(accepted, 0, closed + (going & ~opened & ~far))
            halved = np.where(accepted, 0, halved + (going & far))
            time = np.where(accepted, time + length, time)
            grown = np.where(merged, -np.inf, np.where(accepted, grown + np.log(size / distance), grown))
            state = np.where(accepted[..., None, None], ended, state)
            alive &= ~merged
            times.append(time)
            sums.append(grown)
        return np.array(times), np.array(sums)

    def _per_step(self, times: Array, sums: Array) -> Array:
        """Return the growth in each step, interpolated between the times of rescaling."""
        steps = np.arange(self._task.count + 1)
        curves = np.full((*self.status.shape, steps.size - 1), np.nan)
        for variant, pair in np.argwhere(self._intact):
            at = self._skip[variant, 0] + steps * self.leg[variant, 0]
            if np.isinf(sums[-1, variant, pair]):
                curves[variant, pair] = -np.inf
            else:
                curves[variant, pair] = np.diff(np.interp(at, times[:, variant, pair], sums[:, variant, pair]))
        return curves

    # ---- runs

    def _settle(self, until: Array) -> tuple[Array, Array]:
        """Return states with all contacts open at a time or soon after it, and their times."""
        state, time = self._start, np.zeros(self.status.shape)
        if not until.any():
            return state, time
        found, waiting = state.copy(), np.ones(time.shape, bool)
        for attempt in range(_MAX_ATTEMPTS):
            length = np.where(waiting, until + self.leg * (attempt * _GOLDEN_RATIO % 1), 1e-3 * self.leg)
            ended, alive = self._run(state, np.zeros(time.shape), length, waiting, waiting)
            accepted = waiting & alive
            time, found = np.where(accepted, length, time), np.where(accepted[..., None, None], ended, found)
            waiting = accepted & ~(self._smallest_gap(ended) > _CLOSED).all(axis=-1)
            if not waiting.any():
                break
        return found, time

    def _run(
        self, state: Array, time: Array, length: Array, alive: NDArray[np.bool_], going: NDArray[np.bool_]
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Run all motions from states at given times; set the status of those that fail, and mark them in `alive`."""
        rows = np.moveaxis(state, -1, 0)
        first, dampers, wait = 2 * self._modes, [], time[..., None]
        balls = (len(rows) - first) // 2
        for damper in self._packed.dampers:
            own = slice(first, first := first + len(damper.mass))
            speeds = slice(own.start + balls, own.stop + balls)
            dampers.append(damper.replace(position=rows[own], velocity=rows[speeds]))
        packed = self._packed.replace(
            mode_displacement=rows[0 : 2 * self._modes : 2],
            mode_velocity=rows[1 : 2 * self._modes : 2],
            dampers=dampers,
            loads=[_start_later(load, wait) for load in self._packed.loads],
            settings=self._packed.settings.replace(duration=length[..., None]),
        )
        shape = state.shape[:-1]
        output, size = BlockOutput(state=True), int(np.prod(shape))
        result = run_block(
            packed,
            shape,
            0,
            size,
            output,
            threads=self._threads,
            progress=lambda _: not self._is_cancelled(),
        )
        if result is None or self._is_cancelled():
            raise _Stopped
        status = result["status"].reshape(shape).max(axis=-1)
        self.status = np.where(going & (status != Status.finished), status, self.status)
        alive = alive & ~(going & ~np.isin(status, (Status.finished, Status.energy_error)))
        return result["state"].reshape(state.shape), alive

    # ---- states

    def _add_neighbours(self, state: Array) -> Array:
        """Return states with a neighbour of each, in a random direction that does not lead into a wall."""
        pairs, size = self._task.pairs, state.shape[-1]
        direction = self._rng.normal(size=(1, pairs, 1, size))
        direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
        toward = (self._task.distance * self._scale)[..., None, None] * direction / self._weights
        inside = [self._smallest_gap(state + sign * toward).min(axis=-1, keepdims=True) >= 0 for sign in (1, -1)]
        still = toward.copy()
        still[..., 0 : 2 * self._modes : 2] = 0
        still[..., 2 * self._modes : self._modes + size // 2] = 0
        step = np.where(inside[0][..., None], toward, np.where(inside[1][..., None], -toward, still))
        return np.concatenate([state, state + step], axis=2)

    def _smallest_gap(self, state: Array) -> Array:
        """Return the smallest gap of each state over the clearance."""
        found = np.full(state.shape[:-1], np.inf)
        first = 2 * self._modes
        for damper in self._packed.dampers:
            places = state[..., first : (first := first + len(damper.mass))]
            centre = np.sum(np.moveaxis(damper.shape, 0, -1) * state[..., 0 : 2 * self._modes : 2], axis=-1)
            clearance = np.asarray(damper.clearance)
            ends = [places[..., 0] - centre + clearance / 2, centre + clearance / 2 - places[..., -1]]
            found = np.minimum(found, np.minimum(*ends) / clearance)
            if places.shape[-1] > 1:
                found = np.minimum(found, np.diff(places, axis=-1).min(axis=-1) / clearance)
        return found


def _start_later(load: _core.Load, wait: Array) -> _core.Load:
    """Return a load in a time that starts later [s]."""
    signal = load.signal
    if isinstance(signal, _core.Record):
        raise TypeError("a record cannot start later")
    if isinstance(signal, _core.Harmonic):
        signal = signal.replace(phase=signal.phase + np.asarray(signal.frequency) * wait)
    return load.replace(signal=signal.replace(start=signal.start - wait, stop=signal.stop - wait))
