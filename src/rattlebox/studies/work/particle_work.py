"""Variants of cases with particle dampers: complete 3-D runs, reduced to measures."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import trapezoid

from rattlebox._util.batch_means import FEWEST_VALUES, shortest_window
from rattlebox._util.exceptions import RattleboxError
from rattlebox.analysis import settling_time
from rattlebox.analysis.cycle_loss import UNSTEADY, CycleLoss, cycle_loss
from rattlebox.analysis.shaken import MIN_SAMPLES, StillCavity, harmonic_loss
from rattlebox.core._core import Status
from rattlebox.engines.dem import continue_dem, simulate_dem
from rattlebox.model.errors import Hint
from rattlebox.model.harmonics import Harmonic
from rattlebox.model.methods import Output
from rattlebox.model.space import unit_vector
from rattlebox.prepare.particles import refusal_reason, settle_all
from rattlebox.prepare.time_step import WARNINGS, exceeded_limits
from rattlebox.results import Run
from rattlebox.results.acceleration import accelerations_of_steps, base_at_points
from rattlebox.results.damper_force import mean_damper_force
from rattlebox.results.schema import variables
from rattlebox.studies.work.case_work import CaseWork, Extra
from rattlebox.studies.work.measures import INTERVAL, MEASURES, MOST_BATCHES, interval_of, parts_needed
from rattlebox.studies.work.work import Cancelled, Values, proceed_unless

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case


@dataclass(frozen=True)
class Window:
    """Part of a run over which measures are evaluated.

    Attributes
    ----------
    start
        Start of the window [s].
    displacement, velocity, base_acceleration : (T,) float
        Displacement [m] and velocity [m/s] of the observed point, and acceleration of the base in its direction [m/s^2].
    shape : (M,) float
        Mode shape of the observed point [kg^-1/2].
    frequency
        Frequency of the first harmonic load or motion [Hz]; NaN if there is none or its amplitude is zero.
    """

    run: Run
    full_run: Run
    start: float
    displacement: NDArray[np.float64]
    velocity: NDArray[np.float64]
    base_acceleration: NDArray[np.float64]
    shape: NDArray[np.float64]
    frequency: float

    def value(self, name: str) -> float:
        """Return a measure; NaN if it requires a cycle or a moving cavity and there is none."""
        if MEASURES[name].cyclic and not self.length * self.frequency >= 1 - 1e-9:
            return math.nan
        try:
            return _FORMULAS[name](self)
        except StillCavity:
            return math.nan

    def part(self, name: str) -> float:
        """Return the value of a part of a steady motion, for the interval of a measure.

        Losses are those in contacts, whose mean is that of the work: particles store and return much of the work of a part.
        """
        if name not in _STORED:
            return self.value(name)
        work, lost = self.work_per_cycle, self.loss / (self.length * self.frequency)
        return self.value(name) * lost / work if work else math.nan

    @property
    def length(self) -> float:
        """Length of the window [s]."""
        times = self.run.arrays.time
        return float(times[-1] - times[0])

    @property
    def loss(self) -> float:
        """Energy dissipated in all contacts [J]."""
        return float(self.run.ledger.contact_loss[-1])

    def rms(self, values: NDArray[np.float64]) -> float:
        """Return the root mean square over the window."""
        return math.sqrt(float(trapezoid(values**2, self.run.arrays.time)) / self.length)

    @cached_property
    def relative_acceleration(self) -> NDArray[np.float64]:
        """Acceleration of the point relative to the base at both ends of each output step, (2, T - 1) [m/s^2]."""
        return np.asarray(accelerations_of_steps(self.run.arrays, self.run.case, self.shape[:, None])[:, :, 0])

    @property
    def acceleration(self) -> NDArray[np.float64]:
        """Absolute acceleration of the point in the same form [m/s^2]."""
        return self.relative_acceleration + np.stack([self.base_acceleration[:-1], self.base_acceleration[1:]])

    def rms_of_steps(self, values: NDArray[np.float64]) -> float:
        """Return the root mean square of values at both ends of each output step."""
        steps = np.diff(self.run.arrays.time)
        return math.sqrt(float(np.sum(0.5 * (values**2).sum(axis=0) * steps)) / self.length)

    @property
    def damper_force(self) -> NDArray[np.float64]:
        """Force of all particles on their cavities, averaged between samples [N], from the change of their momentum."""
        force = mean_damper_force(self.run.arrays, self.run.case).sum(axis=1)
        return np.asarray(np.linalg.norm(force, axis=1))

    @property
    def interface_force(self) -> NDArray[np.float64]:
        """Magnitude of the force on the base [N]."""
        return np.asarray(np.linalg.norm(self.run.arrays.interface_force, axis=1))

    @property
    def settling_time(self) -> float:
        """Time after which the displacement stays within 5 % of its peak [s]."""
        times = self.run.arrays.time
        return settling_time(times, self.displacement) if self.displacement.any() else float(times[0])

    def first_harmonic(self, damper: str) -> xarray.Dataset:
        """Return loss and effective mass of a damper at the frequency of the load."""
        after = self.start - 1e-9 / self.frequency  # rounding must not remove a cycle
        return harmonic_loss(self.full_run, frequency=self.frequency, damper=damper, after=after)

    @cached_property
    def cycle(self) -> CycleLoss | None:
        """Energies of all dampers in a cycle; None without a whole cycle."""
        cycles = 0 if math.isnan(self.frequency) else math.floor(self.length * self.frequency + 1e-9)
        return cycle_loss(self.run, self.frequency, cycles) if cycles else None

    @property
    def work_per_cycle(self) -> float:
        """Work of the walls of all cavities on their particles in a cycle [J]."""
        return math.nan if self.cycle is None else self.cycle.work

    @property
    def cavity_velocity(self) -> float:
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
        return total / self.cavity_velocity**2


_FORMULAS: dict[str, Callable[[Window], float]] = {
    "work": lambda w: w.run.ledger.work[-1],
    "viscous_loss": lambda w: w.run.arrays.viscous_loss[-1],
    "impact_loss": lambda w: w.loss,
    "viscous_share": lambda w: w.run.ledger.shares["viscous"],
    "impact_share": lambda w: w.run.ledger.contact_share,
    "motion_share": lambda w: w.run.ledger.shares["motion"],
    "energy_residual": lambda w: w.run.energy_residual,
    "peak": lambda w: np.abs(w.displacement).max(),
    "rms": lambda w: w.rms(w.displacement),
    "peak_velocity": lambda w: np.abs(w.velocity).max(),
    "rms_velocity": lambda w: w.rms(w.velocity),
    "peak_acceleration": lambda w: np.abs(w.acceleration).max(),
    "rms_acceleration": lambda w: w.rms_of_steps(w.acceleration),
    "peak_relative_acceleration": lambda w: np.abs(w.relative_acceleration).max(),
    "rms_relative_acceleration": lambda w: w.rms_of_steps(w.relative_acceleration),
    "peak_damper_force": lambda w: w.damper_force.max(),
    "rms_damper_force": lambda w: math.sqrt(np.mean(w.damper_force**2)),
    "peak_interface_force": lambda w: w.interface_force.max(),
    "rms_interface_force": lambda w: w.rms(w.interface_force),
    "settling_time": lambda w: w.settling_time,
    "loss_per_cycle": lambda w: w.work_per_cycle,
    "reduced_loss": lambda w: w.work_per_cycle / (w.run.arrays.particle_mass.sum() * w.cavity_velocity**2),
    "effective_mass": lambda w: w.apparent_mass.real,
    "damping_mass": lambda w: -w.apparent_mass.imag,
    "loss_factor": lambda w: -w.apparent_mass.imag / abs(w.apparent_mass.real),
}
"""Measures of particle runs: those of `rattlebox.MEASURES` that do not refer to single impacts."""

_STORED = ("loss_per_cycle", "reduced_loss")
"""Measures of the work of the walls."""

_UNSTEADY = 2 ** list(WARNINGS).index(UNSTEADY)
"""Bit of a motion that is not steady in the `warnings` of a variant."""

_HARMONIC_MEASURES = ("reduced_loss", "effective_mass", "damping_mass", "loss_factor")


@dataclass
class ParticleWork(CaseWork):
    """Variants of a case with particle dampers; see `CaseWork` for the attributes.

    Functions of a Run get the run from which the measures are evaluated. Its samples are those of the output of the case,
    unless `samples` or `cycles` is given.
    """

    extensions: int = 0

    @cached_property
    def outputs(self) -> dict[str, tuple[Extra, str, dict[str, Any]]]:
        """Further dimensions, number type and attributes of each output, with the exceeded validity limits."""
        outputs = dict(super().outputs)
        masks, names = [2**bit for bit in range(len(WARNINGS))], " ".join(WARNINGS)
        attributes = {"long_name": "exceeded validity limits", "flag_masks": masks, "flag_meanings": names}
        flags = {"status": outputs.pop("status"), "warnings": ((), "int8", attributes)}
        if self.extensions:
            skipped = {"units": "1", "long_name": "cycles before the evaluated ones"}
            outputs["skipped_cycles"] = (), "int32", skipped
        return {**flags, **outputs}

    def describe(self) -> dict[str, Any]:
        """Return a description of everything except the grid, in JSON types."""
        return super().describe() | ({"extensions": self.extensions} if self.extensions else {})

    def validate(self) -> None:
        """Raise if the arguments do not fit the case or each other."""
        for name in self.measure_names:
            if name not in _FORMULAS:
                raise Hint(f"{name} refers to single impacts, which particle runs do not store", ", ".join(_FORMULAS))
            if MEASURES[name].cyclic and math.isnan(_frequency(self.case)):
                raise Hint(f"{name} is defined per cycle and requires a harmonic load or motion", 'kind = "harmonic"')
        if self.cycles is not None and math.isnan(_frequency(self.case)):
            raise Hint("cycles require a harmonic load or motion", 'duration and skip in seconds: skip = "2 s"')
        self._check_ends()
        if self.cycles is None and self.skip >= self.case.duration:
            raise Hint(
                f"skip = {self.skip:.6g} s is not before the end of the run", "a smaller skip or a longer duration"
            )
        window = self.case.duration - self.skip
        cyclic = [name for name in self.measure_names if MEASURES[name].cyclic]
        if self.cycles is None and cyclic and window * _frequency(self.case) < 1 - 1e-9:
            raise Hint(
                f"skip = {self.skip:.6g} s leaves less than the one cycle that {cyclic[0]} requires",
                "a longer duration",
            )
        self.require_interface_force()
        _ = self._observed  # raises if there is no such point

    def coords(self) -> dict[str, Any]:
        """Return the coordinates of the dimensions beyond the grid: none."""
        return {}

    @property
    def block(self) -> int:
        """Preferred number of variants in a block."""
        return 1

    def run(self, start: int, stop: int, *, threads: int = 1, cancelled: Cancelled = None) -> Values | None:
        """Run a range of variants; see `Work.run`."""
        proceed = proceed_unless(cancelled)
        rows = {}
        for index in range(start, stop):
            try:
                row = self._row_of(index, threads, proceed)
            except RattleboxError:  # the variant gets the status "refused"; see `refusal_reason`
                continue
            if row is None:
                return None
            rows[index] = row
        return self.columns(rows, start, stop)

    def _row_of(self, index: int, threads: int, proceed: Callable[..., bool]) -> dict[str, Any] | None:
        """Run a variant, repeatedly until its motion is steady if allowed; return its outputs, None if it was stopped."""
        case = self.variant(index)
        if not settle_all(case, proceed):
            return None
        if not self.extensions or self.cycles is None:
            run = simulate_dem(case, threads=threads, progress=proceed)
            return None if run.status == "interrupted" else self.row(case, run, index)
        skip, kept = self.cycles
        driver = _driver(case)
        repeats = self.extensions if driver and driver.start == 0 and driver.stop is None else 0
        run, end = continue_dem(case, None, threads=threads, progress=proceed)
        row, later = self.row(case, run, index), replace(self, cycles=(0, kept))
        for repeated in range(repeats):
            row["skipped_cycles"] = skip + repeated * kept
            if run.status == "interrupted":
                return None
            if not row["warnings"] & _UNSTEADY:
                break
            case = later.variant(index)
            run, end = continue_dem(case, end, threads=threads, progress=proceed)
            row = later.row(case, run, index) | {"skipped_cycles": skip + (repeated + 1) * kept}
        return None if run.status == "interrupted" else row

    def row(self, case: Case, run: Run, index: int) -> dict[str, Any]:
        """Return the outputs of one variant by name."""
        exceeded = exceeded_limits(run.diagnostics)
        row: dict[str, Any] = {
            "status": Status[run.status],
            "warnings": sum(2**bit for bit, name in enumerate(WARNINGS) if name in exceeded),
        }
        if run.status == "energy_error" and "energy_residual" in self.measure_names:
            row["energy_residual"] = self.window(run, case).value("energy_residual")
        if run.ok:
            window = self.window(run, case)
            if self._is_tested and window.cycle is not None and not window.cycle.is_steady:
                row["warnings"] |= _UNSTEADY
            row |= {name: window.value(name) for name in self.measure_names}
            row |= self._intervals(run, case, row)
            row |= self.call_functions(run, index)
        return row

    @property
    def _is_tested(self) -> bool:
        """Whether the motion should be steady: in whole cycles, or for measures of a cycle."""
        return self.cycles is not None or any(MEASURES[name].cyclic for name in self.measure_names)

    def columns(self, rows: Mapping[int, Mapping[str, Any]], start: int, stop: int) -> Values:
        """Return each output of a range of variants; those without a row have the status "refused"."""

        def column(name: str) -> NDArray[Any]:
            extra, kind, _ = self.outputs[name]
            missing = Status.refused if name == "status" else 0 if np.dtype(kind).kind == "i" else np.nan
            empty = np.full([length for _, length in extra], missing)
            return np.array([rows.get(index, {}).get(name, empty) for index in range(start, stop)], kind)

        return {name: column(name) for name in self.outputs}

    def refusal_reason(self, index: int) -> str:
        """Return the reason why a variant cannot run; "" if it can."""
        try:
            return refusal_reason(self.variant(index))
        except RattleboxError as error:
            return str(error)

    def variant(self, index: int) -> Case:
        """Return the case of a variant, with the duration and samples of its run."""
        case = self.grid.case_at(self.case, index)
        if not case.particle_dampers:
            raise Hint("a variant has no particle damper", "one sweep for each kind of damper")
        return self._set_window(case)

    def _check_ends(self) -> None:
        """Raise if neither the first nor the last variant is valid."""
        for index in (0, self.size - 1):
            try:
                self.variant(index)
                return
            except RattleboxError as error:
                refused = error
        raise refused

    def _set_window(self, case: Case) -> Case:
        """Return a case with the duration and the samples of the study."""
        duration, skip, samples = case.duration, self.skip, self.samples
        if self.cycles is not None:
            period = 1 / _frequency(case)
            duration, skip = sum(self.cycles) * period, self.cycles[0] * period
            _check_start(case, skip)
            each = 64 if samples is None else max(1, math.ceil((samples - 1) / self.cycles[1]))
            samples = 1 + each * self.cycles[1]
        if samples is not None and duration > skip:
            output = Output(rate=(samples - 1) / (duration - skip))
            case = case.model_copy(update={"duration": duration, "output": output})
        for name in self.measure_names:
            if name in _HARMONIC_MEASURES:
                _check_samples(case, name)
        return case

    def _intervals(self, run: Run, case: Case, row: Mapping[str, float]) -> dict[str, float]:
        """Return half of the width of the 95 % intervals of the measures of steady motion."""
        if not self.averages:
            return {}
        limits = _batch_limits(self._start(case), float(run.arrays.time[-1]), _frequency(case), run.arrays.time)
        lengths = np.diff(limits)[None]
        parts = [self.window(cut_after(run, end), case, start) for start, end in pairwise(limits)]
        found = {name: np.array([[part.part(name) for part in parts]]) for name in parts_needed(self.averages)}
        shortest = 0.0 if run.arrays.contacts.any() else shortest_window(case.modes.decay)
        return {
            name + INTERVAL: float(interval_of(name, [row[name]], found, lengths, shortest)[0])
            for name in self.averages
        }

    def _start(self, case: Case) -> float:
        """Return the start of the window [s]."""
        return self.skip if self.cycles is None else self.cycles[0] / _frequency(case)

    def window(self, run: Run, case: Case, start: float | None = None) -> Window:
        """Return the part of the run of a variant over which measures are evaluated, or the part from `start` [s] on."""
        frequency = _frequency(case)
        start = self._start(case) if start is None else start
        part = cut_before(run, start)
        if (driver := _driver(case)) and driver.amplitude == 0:
            frequency = math.nan
        arrays = part.arrays
        observed = self._observed
        if observed is None:
            first = case.particle_dampers[0]
            along = unit_vector(first.direction)
            return Window(
                part,
                run,
                start,
                arrays.cavity_displacement[:, 0] @ along,
                arrays.cavity_velocity[:, 0] @ along,
                arrays.base_acceleration @ along,
                case.modes.space_shape(first.point, first.direction) @ along,
                frequency,
            )
        base = base_at_points(case, arrays.base_acceleration)
        modes = arrays.modal_displacement, arrays.modal_velocity
        displacement, velocity = (
            observed.column(arrays.points, own, mode)
            for own, mode in zip((arrays.displacement, arrays.velocity), modes, strict=True)
        )
        own_base = observed.column(arrays.points, base, np.zeros_like(modes[0]))
        lines = np.array(list(case.modes.lines().values()))
        shape = observed.column(arrays.points, lines.T, np.eye(lines.shape[1]))
        return Window(part, run, start, displacement, velocity, own_base, shape, frequency)


def cut_before(run: Run, start: float) -> Run:
    """Return a run without the samples before a time.

    Work and losses of the result count from its start.

    Parameters
    ----------
    start
        First time of the result [s]; interpolated linearly between samples.
    """
    arrays = run.arrays
    times = arrays.time
    first = int(np.searchsorted(times, start * (1 - 1e-9)))
    between = 0 < first < len(times) and times[first] > start * (1 + 1e-9)
    part = (start - times[first - 1]) / (times[first] - times[first - 1]) if between else 0.0
    cut: dict[str, Any] = {"time": np.concatenate([[start], times[first:]]) if between else times[first:]}
    for variable in variables(arrays.engine):
        if variable.dims[0] == "time" and not variable.derived:
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

    Parameters
    ----------
    end
        The time [s].
    """
    arrays = run.arrays
    count = min(int(np.searchsorted(arrays.time, end * (1 - 1e-9))) + 1, arrays.time.size)
    names = (v.name for v in variables(arrays.engine) if v.dims[0] == "time" and not v.derived)
    cut = {name: getattr(arrays, name)[:count] for name in names}
    return replace(run, arrays=arrays.replaced(time=arrays.time[:count], **cut))


def _batch_limits(start: float, end: float, frequency: float, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the limits of up to 64 equal parts of a window, each of whole cycles; one number if samples are too few."""
    if math.isnan(frequency):
        limits = np.linspace(start, end, MOST_BATCHES + 1)
    else:
        whole = math.floor((end - start) * frequency + 1e-9)
        if whole < 1:
            return np.zeros(1)
        # Beds often repeat after two cycles, whose losses alternate: batches of two cycles do not count that as scatter.
        least = 2 if whole >= 2 * FEWEST_VALUES else 1
        each = max(least, math.ceil(whole / MOST_BATCHES))
        limits = end - np.arange(whole // each, -1, -1) * each / frequency
    return limits if np.count_nonzero(times >= start) > limits.size else np.zeros(1)


def _driver(case: Case) -> Harmonic | None:
    """Return the first harmonic load or motion, which defines the cycle."""
    signals = (*case.loads, *case.base, *case.shaker_motion)
    return next((signal for signal in signals if isinstance(signal, Harmonic)), None)


def _frequency(case: Case) -> float:
    """Return the frequency of the first harmonic load or motion [Hz]; NaN if there is none."""
    driver = _driver(case)
    return driver.frequency if driver else math.nan


def _check_start(case: Case, skip: float) -> None:
    """Raise if the harmonic starts after the evaluated cycles."""
    driver = _driver(case)
    if driver and driver.start > skip * (1 + 1e-9):
        raise Hint(
            f"the evaluated cycles start at {skip:.4g} s, before the harmonic at {driver.start:.4g} s",
            "start = 0, or more cycles to skip",
        )


def _check_samples(case: Case, name: str) -> None:
    """Raise if a cycle has too few samples for a measure of the first harmonic."""
    rate = (case.sample_times().size - 1) / (case.duration * _frequency(case))
    if rate < MIN_SAMPLES * (1 - 1e-6):
        raise Hint(
            f"{rate:.3g} samples per cycle are too few for {name}, which requires {MIN_SAMPLES}",
            "more samples, or leave out the number",
        )
