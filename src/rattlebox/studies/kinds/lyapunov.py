"""The largest Lyapunov exponent over the axes of a sweep, from the growth of the distance between neighbouring motions.

References
----------
G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn (1980), Lyapunov characteristic exponents for smooth dynamical systems
and for Hamiltonian systems, Meccanica 15, 9-20 and 21-30, doi:10.1007/BF02128236 and doi:10.1007/BF02128237.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import KW_ONLY
from dataclasses import dataclass as plain_dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from pydantic.dataclasses import dataclass

from rattlebox._util.batch_means import smooth_weights
from rattlebox._util.exceptions import CaseError
from rattlebox.core import _core
from rattlebox.core._core import Status
from rattlebox.engines.batch import BlockOutput, run_block
from rattlebox.model.units import Number, Whole
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.grid.grid import Grid
from rattlebox.studies.run.study import (
    CONFIG,
    Axes,
    Count,
    Cycles,
    Seconds,
    Seed,
    Study,
    study_function,
)
from rattlebox.studies.work.impact import ImpactEngine
from rattlebox.studies.work.variants import Variants, describe_case, gather_values, gather_variants
from rattlebox.studies.work.work import Cancelled, Extra, Outputs, Values, Work

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case


# ---- engine


Array = NDArray[np.float64]

_ALIGNMENT_STEPS = 20  # steps in which a neighbour turns into the direction of the largest growth
_GOLDEN_RATIO = 0.6180339887498949  # of a step, added to find a time at which all contacts are open
_MAX_ATTEMPTS = 8
_SATURATED = 1e-3  # distance over the scale of distances
_MERGED = 2e-15  # distance over the size of the state
_CLOSED = 1e-12  # gap over the clearance


@plain_dataclass
class PairEngine:
    """Variants of a case and their pairs of neighbouring motions; see `rb.lyapunov` for the attributes."""

    case: Case
    grid: Grid
    cycles: tuple[int, int] | None = None
    skip: float = 0.0
    steps: int | None = None
    pairs: int = 8
    distance: float = 1e-7
    reach: float = 1e-3
    seed: int = 0

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "sweep"}

    def validate(self) -> None:
        """Raise if the arguments are not valid for the case."""
        packed = self.sweep.packed
        if self.count < 2:
            raise CaseError("one evaluated cycle is one step; at least two steps are required", "steps = 100")
        if np.ndim(packed.settings.duration) and self.cycles is None:
            raise CaseError("the duration differs between variants", "cycles, or one duration for all")
        if any(isinstance(load.signal, _core.Record) for load in packed.loads):
            raise CaseError(
                "the case has a load from a record, in the middle of which a run cannot start",
                "rattlebox.analysis.lyapunov_exponent with pairs of runs",
            )

    block = 1

    @property
    def count(self) -> int:
        """Number of steps."""
        return self.steps or (int(np.ceil(self.cycles[1])) if self.cycles else 100)

    @property
    def outputs(self) -> Outputs:
        """Further dimensions, number type and attributes of each output."""
        along: Extra = (("cycle" if self.cycles else "time", self.count),)
        error = {"units": "1/s", "long_name": "standard error of the exponent"}
        found: Outputs = {
            "status": self.sweep.outputs["status"],
            "exponent": ((), "float64", {"units": "1/s", "long_name": "largest Lyapunov exponent"}),
            "standard_error": ((), "float64", error),
        }
        if self.cycles:
            found["growth_per_cycle"] = ((), "float64", {"units": "1", "long_name": "logarithmic growth in a cycle"})
        found["running_exponent"] = (along, "float64", {"units": "1/s", "long_name": "Lyapunov exponent until then"})
        return found

    def coords(self) -> dict[str, Any]:
        """Return the coordinate of the running exponent."""
        part = np.arange(1, self.count + 1) / self.count
        if self.cycles:
            return {"cycle": ("cycle", self.cycles[1] * part, {"units": "1", "long_name": "evaluated cycles"})}
        seconds = (float(self.sweep.packed.settings.duration) - self.skip) * part
        return {"time": ("time", seconds, {"units": "s", "long_name": "evaluated time"})}

    def describe(self) -> dict[str, Any]:
        """Return a description of everything except the grid, in JSON types."""
        names = "skip", "steps", "pairs", "distance", "reach", "seed"
        cycles = None if self.cycles is None else list(self.cycles)
        about = {"study": "lyapunov", **describe_case(self.case, self.grid.columns), "cycles": cycles}
        return about | {name: getattr(self, name) for name in names}

    @cached_property
    def sweep(self) -> ImpactEngine:
        """The variants as a sweep."""
        return ImpactEngine(Variants(self.case, self.grid, skip=self.skip, cycles=self.cycles))

    def timed_case(self, number: int) -> Case | None:
        """Return None: variants are timed in blocks; see `Engine.timed_case`."""
        return None

    def run(
        self, numbers: range, *, threads: int = 1, cancelled: Cancelled = None, reduction: None = None
    ) -> Values | None:
        """Run variants; see `Engine.run`."""
        pairs = _Pairs(self, numbers, threads, cancelled)
        growth = pairs.growth()
        if growth is None:
            return None
        with np.errstate(invalid="ignore"):  # growth may be infinite
            rates = np.where(np.isinf(growth).any(axis=-1, keepdims=True), -np.inf, growth @ _weights(self.count).T)
            rates = rates / pairs.leg[..., None]
            mean, spread = rates[..., -1].mean(axis=1), rates[..., -1].std(axis=1, ddof=min(1, self.pairs - 1))
            found = {
                "status": pairs.status.max(axis=1).astype(np.int8),
                "exponent": mean,
                "standard_error": spread / self.pairs**0.5 if self.pairs > 1 else np.full(mean.shape, np.nan),
                "running_exponent": rates.mean(axis=1),
            }
        if self.cycles:
            found["growth_per_cycle"] = mean * pairs.period[:, 0]
        return found


class _Stopped(Exception):
    """The work was cancelled."""


class _Pairs:
    """Pairs of neighbouring motions for a range of variants.

    Arrays have the axes (variant, pair, member of the pair, component of the state).
    """

    def __init__(self, task: PairEngine, numbers: range, threads: int, cancelled: Cancelled) -> None:
        self._task, self._threads, self._cancelled = task, threads, cancelled
        self._count = len(numbers)
        shape = task.grid.shape
        members = np.array(numbers)
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
        # Distances are measured by the first gap: that of a ball, or of a stop with the effective mass of its contact.
        size = (root * reach)[0, ..., 0] if len(root) else self._stop_size()
        self._scale = np.broadcast_to(np.where(size > 0, size, np.where(norm > 0, norm, 1.0)), norm.shape)

    def _stop_size(self) -> Array:
        """Return the gap of the first stop times the root of its effective mass, (variants, 1); 0 without a stop."""
        for damper, contact in zip(
            self._packed.dampers, self._packed.contacts, strict=False
        ):  # no balls: one contact each
            mass = np.reshape(np.asarray(contact.mass), (-1, 1))
            return np.asarray(np.sqrt(mass) * 0.5 * np.reshape(np.asarray(damper.clearance), (-1, 1)))
        return np.zeros((1, 1))

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
        # Neighbours start before the evaluated window and turn into the direction of the largest growth until then.
        state, time = self._settle(self._skip - np.minimum(0.5 * self._skip, _ALIGNMENT_STEPS * self.leg))
        state = self._add_neighbours(state)
        grown = np.zeros(time.shape)
        closed, halved = np.zeros(time.shape, int), np.zeros(time.shape, int)
        alive = self._intact
        times, sums = [time], [grown]
        distance = self._task.distance * self._scale
        while (going := alive & (self._end - time > 1e-9 * self.leg)).any():
            # Aim at the end of the step; after a closed contact try later times, after a large distance shorter ones. The
            # golden ratio visits a periodic motion at ever new phases.
            to_next = (np.floor(time / self.leg + 1e-6) + 1) * self.leg - time
            length = (to_next + self.leg * (2.0**closed - 1 + closed * _GOLDEN_RATIO % 1)) * 0.5**halved
            length = np.where(going, np.minimum(length, self._end - time), 1e-3 * self.leg)
            ended, alive = self._run(state, time, length, alive, going)
            # Bring the neighbour back to the initial distance along the line between both, as Benettin does.
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
            if not len(damper.mass):  # a stop
                dampers.append(damper)
                continue
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
            if not places.shape[-1]:  # a stop, whose gap may be zero
                found = np.minimum(found, (0.5 * clearance - centre) / np.where(clearance > 0, clearance, 1.0))
                continue
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


def _weights(steps: int) -> NDArray[np.float64]:
    """Return the weights of the steps in the averages over the first 1, 2, ... steps, (steps, steps)."""
    count, step = np.arange(1, steps + 1)[:, None], np.arange(steps)
    weights = smooth_weights((step + 0.5) / count)
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))


# ---- kind of study


@dataclass(frozen=True, config=CONFIG)
class Lyapunov(Study):
    r"""Compute the largest finite-time Lyapunov exponent of a case, or of each variant along some axes.

    Parameters
    ----------
    case
        Case with the values that do not vary. Its output is not used. It must have no load from a record.
    axes
        Axes as for `rb.sweep`; none for the case alone.
    cycles
        Numbers of cycles of the harmonic load to skip until the motion is steady, and to evaluate.
    skip
        Without `cycles`: time from which the motion is evaluated, until the duration of the case [s].
    steps
        Number of rescalings of the distance; default one per cycle, or 100.
    pairs
        Number of motions with a neighbour. Their initial ball velocities differ slightly, so that chaotic motions are
        independent and their scatter estimates the error.
    distance
        Distance between neighbours over half the clearance.
    reach
        Largest difference between the initial states of the pairs, over half the clearance.
    seed
        Random seed of the directions of the neighbours and of the differences of the initial states.
    workers, backend, store, progress
        Execution and storage; see `rattlebox.studies.run.study.Study`.

    Returns
    -------
    xarray.Dataset
        Over the axes: `status`; `exponent` [1/s], the mean over the pairs, and its `standard_error` [1/s]; with cycles
        `growth_per_cycle`, the exponent times the period; for a periodic motion this is the logarithm of its largest
        Floquet multiplier. Over the axes and `cycle` or `time`: `running_exponent` [1/s], the exponent until then. It is
        -inf if neighbours merge within rounding, such as those of a ball that comes to rest on a shaker.

    Raises
    ------
    CaseError
        If an axis or argument is not valid for the case (raised before anything runs).

    Notes
    -----
    With impacts a motion is only piecewise smooth. The variational equation, which `lyapunov_spectrum` uses, is not valid
    for grazing impacts. This method runs a second motion at a small, finite distance, and rescales the distance repeatedly
    along the line between both states, so that impacts, sticking and grazing are included. The distance is measured at
    times at which all contacts of both motions are open and both have had the same impacts; if this is not so at the end of
    a step, another time is used. Pairs without rescaling, which `rattlebox.analysis.lyapunov_exponent` evaluates, cover
    only the few decades between rounding and clearance; they suit a single transient, such as the time after a pulse of a
    record.

    The distance is the norm of positions times the square root of the mass, and of velocities times the same factor over
    the angular frequency of the cycle or of the fastest mode. With the distance d_k to which d_0 grows in step k of the
    length t, the exponent is the weighted average

    .. math::

        \lambda = \frac{\sum_k w_k \ln(d_k / d_0)}{t \sum_k w_k}, \qquad
        w_k \sim \exp\left(-\frac{1}{s (1 - s)}\right), \quad 0 < s < 1

    where s is the place of the step in the motion. This weight converges much faster for regular motion than an even one.

    References
    ----------
    G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn (1980), Lyapunov characteristic exponents for smooth dynamical
    systems and for Hamiltonian systems, Meccanica 15, 9-20 and 21-30, doi:10.1007/BF02128236 and doi:10.1007/BF02128237.
    P. C. Müller (1995), Calculation of Lyapunov exponents for dynamic systems with discontinuities, Chaos, Solitons &
    Fractals 5, 1671-1681 (jump conditions of the variational equation).
    S. Das, Y. Saiki, E. Sander, J. A. Yorke (2017), Quantitative quasiperiodicity, Nonlinearity 30, 4111-4140,
    doi:10.1088/1361-6544/aa84c2 (weight).
    E. Sander, J. D. Meiss (2024), doi:10.48550/arXiv.2409.08496.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.Case(
    ...     structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
    ...     damper=rb.ImpactDamper(
    ...         ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    ...     ),
    ...     load=rb.Harmonic(amplitude="10 N", frequency="30 Hz"),
    ...     duration="1 s",
    ... )
    >>> rb.lyapunov(case, cycles=(50, 20), pairs=4).running_exponent.dims
    ('cycle',)
    """

    kind: ClassVar[str] = "lyapunov"
    figure: ClassVar[str] = "rattlebox.plots.lyapunov:plot_lyapunov"
    report: ClassVar[str] = "rattlebox.report.kinds.steady_motions:LYAPUNOV"

    axes: Axes | None = None
    _: KW_ONLY
    cycles: Cycles | None = None
    skip: Seconds = 0.0
    steps: Annotated[Whole, Field(ge=2)] | None = None
    pairs: Count = 8
    distance: Annotated[Number, Field(ge=1e-12, le=1e-4)] = 1e-7
    reach: Annotated[Number, Field(ge=0, le=1)] = 1e-3
    seed: Seed = 0

    @cached_property
    def work(self) -> Work:
        """Pairs of neighbouring motions of all variants."""
        engine = PairEngine(
            self.case,
            Grid((), (), {}, {}) if self.axes is None else read_axes(self.case, self.axes),
            cycles=self.cycles,
            skip=float(self.skip),
            steps=self.steps,
            pairs=self.pairs,
            distance=self.distance,
            reach=self.reach,
            seed=self.seed,
        )
        return Work(engine)

    def validate(self) -> None:
        """Raise if the fields are not valid; see `Study.validate`."""
        self.work.validate()

    def compute(self) -> xarray.Dataset:
        """Run the pairs of all variants; see `Study.compute`."""
        return self.run_work(self.work)


lyapunov = study_function(Lyapunov)
