"""Window of a particle run, in which its measures are evaluated, and its parts for their intervals."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.batch_means import FEWEST_VALUES, shortest_window
from rattlebox.analysis.cycle_loss import CycleLoss, cycle_loss
from rattlebox.analysis.shaken import StillCavity, harmonic_loss
from rattlebox.core import _core
from rattlebox.model.space import unit_vector
from rattlebox.results import Run
from rattlebox.results.acceleration import accelerations_of_steps, base_at_points
from rattlebox.results.damper_force import mean_damper_force
from rattlebox.results.schema import variables
from rattlebox.studies.work.measures import INTERVAL, MEASURES, interval_of, parts_needed
from rattlebox.studies.work.variants import Observed

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case

FloatArray = NDArray[np.float64]

_NOTHING = np.zeros(0)
"""Array in place of one that no requested measure needs."""


@dataclass(frozen=True)
class Window:
    """Part of a run over which measures are evaluated."""

    run: Run
    full_run: Run
    start: float  # Start of the window [s]
    # Displacement [m] and velocity [m/s] of the observed point, and acceleration of the base in its direction [m/s^2], (T,)
    displacement: FloatArray
    velocity: FloatArray
    base_acceleration: FloatArray
    shape: FloatArray  # Mode shape of the observed point [kg^-1/2], (M,)
    # Frequency of the first harmonic load or motion [Hz]; NaN if there is none or its amplitude is zero
    frequency: float

    @classmethod
    def of(cls, run: Run, case: Case, start: float, observed: Observed | None) -> Window:
        """Return the part of a run from a time on; without an observed point that of the first damper."""
        part = cut_before(run, start)
        arrays = part.arrays
        (driver, *_) = [*case.harmonics.values(), None]
        frequency = driver.frequency if driver and driver.amplitude != 0 else math.nan
        if observed is None:
            first = case.particle_dampers[0]
            along = unit_vector(first.direction)
            displacement, velocity = arrays.cavity_displacement[:, 0] @ along, arrays.cavity_velocity[:, 0] @ along
            shape = case.modes.space_shape(first.point, first.direction) @ along
            return cls(part, run, start, displacement, velocity, arrays.base_acceleration @ along, shape, frequency)
        modes = arrays.modal_displacement, arrays.modal_velocity
        displacement, velocity = (
            observed.column(arrays.points, own, mode)
            for own, mode in zip((arrays.displacement, arrays.velocity), modes, strict=True)
        )
        base = observed.column(arrays.points, base_at_points(case, arrays.base_acceleration), np.zeros_like(modes[0]))
        lines = np.array(list(case.modes.lines().values()))
        shape = observed.column(arrays.points, lines.T, np.eye(lines.shape[1]))
        return cls(part, run, start, displacement, velocity, base, shape, frequency)

    @property
    def length(self) -> float:
        """Length of the window [s]."""
        times = self.run.arrays.time
        return float(times[-1] - times[0])

    def values(self, names: Sequence[str]) -> dict[str, float]:
        """Return measures; NaN if one requires a cycle or a moving cavity and there is none."""
        has_cycle = self.length * self.frequency >= 1 - 1e-9
        known = [name for name in names if has_cycle or not MEASURES[name].cyclic]
        try:
            recorded = self._recorded(known)
        except StillCavity:
            known = [name for name in known if not MEASURES[name].of_first_harmonic]
            recorded = self._recorded(known)
        return dict.fromkeys(names, math.nan) | dict(zip(known, _core.measure(recorded, known), strict=True))

    def _recorded(self, names: Sequence[str]) -> _core.RecordedRun:
        """Return the window as the core needs it for some measures."""
        arrays, ledger = self.run.arrays, self.run.ledger
        measures = [MEASURES[name] for name in names]
        numbers: dict[str, float] = {}
        if any(measure.of_loss_in_cycle for measure in measures):
            numbers["loss_per_cycle"] = math.nan if self.cycle is None else self.cycle.work
        if any(measure.of_first_harmonic for measure in measures):
            mass = self.apparent_mass
            numbers |= {"effective_mass": mass.real, "damping_mass": -mass.imag, "cavity_speed": self.cavity_speed}
        damper_force = base_force = _NOTHING
        ends: FloatArray = np.zeros((2, 0))
        if any(measure.of_acceleration for measure in measures):
            ends = accelerations_of_steps(arrays, self.run.case, self.shape[:, None])[:, :, 0]
        if any(measure.samples for measure in measures):
            # The mean between samples follows from the change of the momentum.
            damper_force = np.linalg.norm(mean_damper_force(arrays, self.run.case).sum(axis=1), axis=1)
        if any(measure.of_base_force for measure in measures):
            base_force = np.linalg.norm(arrays.interface_force, axis=1)
        return _core.RecordedRun(
            time=arrays.time,
            displacement=np.ascontiguousarray(self.displacement),
            velocity=np.ascontiguousarray(self.velocity),
            start_acceleration=np.ascontiguousarray(ends[0]),
            end_acceleration=np.ascontiguousarray(ends[1]),
            base_acceleration=np.ascontiguousarray(self.base_acceleration),
            damper_force=damper_force,
            base_force=base_force,
            motion=ledger.motion,
            gravity=ledger.gravity,
            load_work=ledger.driven,
            base_work=arrays.base_work,
            viscous_loss=arrays.viscous_loss,
            contact_loss=ledger.contact_loss,
            period=1 / self.frequency,
            mass=float(arrays.particle_mass.sum()),
            **numbers,
        )

    # ---- cycles

    def first_harmonic(self, damper: str) -> xarray.Dataset:
        """Return loss and effective mass of a damper at the frequency of the load."""
        after = self.start - 1e-9 / self.frequency  # rounding must not remove a cycle
        return harmonic_loss(self.full_run, frequency=self.frequency, damper=damper, after=after)

    @cached_property
    def cycle(self) -> CycleLoss | None:
        """Energies of all dampers in a cycle; None without a whole cycle."""
        cycles = 0 if math.isnan(self.frequency) else math.floor(self.length * self.frequency + 1e-9)
        return cycle_loss(self.run, self.frequency, cycles) if cycles else None

    @cached_property
    def cavity_speed(self) -> float:
        """Amplitude of the velocity of the first cavity [m/s]."""
        return float(self.first_harmonic(self.run.arrays.dampers[0]).attrs["velocity_amplitude"])

    @cached_property
    def apparent_mass(self) -> complex:
        """Force of all cavities on their particles over the acceleration of the first cavity, m' - i m'' [kg]."""
        total = 0j
        for name in self.run.arrays.dampers:
            harmonic = self.first_harmonic(name).sel(way="complex power")
            damping = float(harmonic.active_power) / (math.pi * self.frequency)
            total += float(harmonic.effective_mass) * harmonic.attrs["velocity_amplitude"] ** 2 - 1j * damping
        return total / self.cavity_speed**2

    # ---- intervals

    def intervals(
        self, names: Sequence[str], values: Mapping[str, float], observed: Observed | None
    ) -> dict[str, float]:
        """Return half of the width of the 95 % intervals of measures of steady motion."""
        case, run = self.run.case, self.full_run
        frequency = next((signal.frequency for signal in case.harmonics.values()), math.nan)
        limits = _batch_limits(self.start, float(run.arrays.time[-1]), frequency, run.arrays.time)
        lengths, needed = np.diff(limits)[None], parts_needed(names)
        parts = [Window.of(cut_after(run, end), case, start, observed)._part(needed) for start, end in pairwise(limits)]
        found = {name: np.array([[part[name] for part in parts]]) for name in needed}
        shortest = 0.0 if run.arrays.contacts.any() else shortest_window(case.modes.decay)
        return {
            name + INTERVAL: float(interval_of(name, [values[name]], found, lengths, shortest)[0]) for name in names
        }

    def _part(self, names: Sequence[str]) -> dict[str, float]:
        """Return the measures of a part of a steady motion.

        Losses are those in contacts, whose mean is that of the work: particles store and return much of the work of a part.
        """
        values = self.values(names)
        for name in names:
            if MEASURES[name].of_loss_in_cycle:
                work = math.nan if self.cycle is None else self.cycle.work
                lost = float(self.run.ledger.contact_loss[-1]) / (self.length * self.frequency)
                values[name] = values[name] * lost / work if work else math.nan
        return values


def cut_before(run: Run, start: float) -> Run:
    """Return a run without the samples before a time.

    Work and losses of the result count from its start.

    `start`: first time of the result [s]; interpolated linearly between samples.
    """
    arrays = run.arrays
    times = arrays.time
    first = int(np.searchsorted(times, start * (1 - 1e-9)))
    between = 0 < first < len(times) and times[first] > start * (1 + 1e-9)
    part = (start - times[first - 1]) / (times[first] - times[first - 1]) if between else 0.0
    cut: dict[str, Any] = {"time": np.concatenate([[start], times[first:]]) if between else times[first:]}
    for variable in variables(arrays.engine):
        if variable.dims[0] == "time" and not variable.derived and variable.name in arrays:
            values = getattr(arrays, variable.name)
            if between:
                entry = values[first - 1] + part * (values[first] - values[first - 1])
                values = np.concatenate([entry[None].astype(values.dtype), values[first:]])
            else:
                values = values[first:]
            cut[variable.name] = values - values[0] if variable.cumulative else values
    return replace(run, arrays=arrays.replaced(**cut)) if first else run


def cut_after(run: Run, end: float) -> Run:
    """Return a run without the samples after the first one at or after a time.

    `end`: the time [s].
    """
    arrays = run.arrays
    count = min(int(np.searchsorted(arrays.time, end * (1 - 1e-9))) + 1, arrays.time.size)
    names = (v.name for v in variables(arrays.engine) if v.dims[0] == "time" and not v.derived and v.name in arrays)
    cut = {name: getattr(arrays, name)[:count] for name in names}
    return replace(run, arrays=arrays.replaced(time=arrays.time[:count], **cut))


def _batch_limits(start: float, end: float, frequency: float, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the limits of up to 64 equal parts of a window, each of whole cycles; one number if samples are too few."""
    if math.isnan(frequency):
        limits = np.linspace(start, end, _core.most_batches + 1)
    else:
        whole = math.floor((end - start) * frequency + 1e-9)
        if whole < 1:
            return np.zeros(1)
        # Beds often repeat after two cycles, whose losses alternate: batches of two cycles do not count that as scatter.
        least = 2 if whole >= 2 * FEWEST_VALUES else 1
        each = max(least, math.ceil(whole / _core.most_batches))
        limits = end - np.arange(whole // each, -1, -1) * each / frequency
    return limits if np.count_nonzero(times >= start) > limits.size else np.zeros(1)
