"""Variants of cases with particles in space: whole runs, each on a thread of its own, summed up by measures."""

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

from rattlebox._util.exceptions import RattleboxError
from rattlebox.analysis import settling_time, shaken_cavity
from rattlebox.analysis.shaken import MIN_SAMPLES, StillCavity
from rattlebox.core._core import Status
from rattlebox.engines.dem import simulate_dem
from rattlebox.engines.responses import base_at_points
from rattlebox.model.errors import Hint
from rattlebox.model.harmonics import Harmonic
from rattlebox.model.methods import Output
from rattlebox.model.space import unit_vector
from rattlebox.prepare.particles import refusal_reason, settle_all
from rattlebox.prepare.time_step import WARNINGS, exceeded_limits
from rattlebox.results import Run
from rattlebox.results.schema import variables

from .impact_work import Extra, ImpactWork
from .measures import INTERVAL, MEASURES, MOST_BATCHES, interval_of
from .work import Values

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case


@dataclass(frozen=True)
class Seen:
    """What measures look at.

    Attributes
    ----------
    run
        From the begin of the window on; work and losses count from there.
    whole, start
        The whole run, and the begin of the window [s].
    motion, speed, base_speed : (T,) float
        Displacement and velocity of the point that is watched, and velocity of the base along it [m], [m/s].
    frequency
        Of the first harmonic load or motion [Hz], NaN without one that acts.
    """

    run: Run
    whole: Run
    start: float
    motion: NDArray[np.float64]
    speed: NDArray[np.float64]
    base_speed: NDArray[np.float64]
    frequency: float

    def value(self, name: str) -> float:
        """Return a measure; NaN of one that refers to cycles where there is no whole one, or the cavity stands still."""
        if MEASURES[name].cyclic and not self.length * self.frequency >= 1 - 1e-9:
            return math.nan
        try:
            return _FOUND[name](self)
        except StillCavity:
            return math.nan

    @property
    def length(self) -> float:
        """Of the window [s]."""
        times = self.run.arrays.time
        return float(times[-1] - times[0])

    @property
    def loss(self) -> float:
        """In all contacts [J]."""
        return float(self.run.ledger.contact_loss[-1])

    def rms(self, values: NDArray[np.float64]) -> float:
        """Return the root of the mean square over the window."""
        return math.sqrt(float(trapezoid(values**2, self.run.arrays.time)) / self.length)

    @property
    def acceleration(self) -> NDArray[np.float64]:
        """Absolute acceleration of the point, mean over each step between samples [m/s^2]."""
        return np.diff(self.speed + self.base_speed) / np.diff(self.run.arrays.time)

    @property
    def settled(self) -> float:
        """Time after which the point stays within a twentieth of its peak [s]."""
        times = self.run.arrays.time
        return settling_time(times, self.motion) if self.motion.any() else float(times[0])

    def shaken(self, damper: str) -> xarray.Dataset:
        """Return loss and mass of a damper in the first harmonic, from the samples of the run alone."""
        after = self.start - 1e-9 / self.frequency  # so that rounding takes no cycle away
        return shaken_cavity(self.whole, frequency=self.frequency, damper=damper, after=after)

    @property
    def speed_of_cavity(self) -> float:
        """Amplitude of the velocity of the first cavity [m/s]."""
        return float(self.shaken(self.run.arrays.dampers[0]).attrs["velocity_amplitude"])

    @cached_property
    def apparent_mass(self) -> complex:
        """Force of all cavities on their particles over the acceleration of the first one, m' - i m'' [kg]."""
        total = 0j
        for name in self.run.arrays.dampers:
            one = self.shaken(name).sel(way="complex power")
            lost = float(one.active_power) / (math.pi * self.frequency)
            total += float(one.effective_mass) * one.attrs["velocity_amplitude"] ** 2 - 1j * lost
        return total / self.speed_of_cavity**2


_FOUND: dict[str, Callable[[Seen], float]] = {
    "work": lambda s: s.run.ledger.work[-1],
    "viscous_loss": lambda s: s.run.arrays.viscous_loss[-1],
    "impact_loss": lambda s: s.loss,
    "viscous_share": lambda s: s.run.ledger.shares["viscous"],
    "impact_share": lambda s: s.run.ledger.contact_share,
    "motion_share": lambda s: s.run.ledger.shares["motion"],
    "energy_residual": lambda s: s.run.energy_residual,
    "peak": lambda s: np.abs(s.motion).max(),
    "rms": lambda s: s.rms(s.motion),
    "peak_velocity": lambda s: np.abs(s.speed).max(),
    "rms_velocity": lambda s: s.rms(s.speed),
    "peak_acceleration": lambda s: np.abs(s.acceleration).max(),
    "rms_acceleration": lambda s: math.sqrt(np.mean(s.acceleration**2)),
    "settling_time": lambda s: s.settled,
    "loss_per_cycle": lambda s: s.loss / (s.length * s.frequency),
    "reduced_loss": lambda s: (
        s.loss / (s.length * s.frequency * s.run.arrays.particle_mass.sum() * s.speed_of_cavity**2)
    ),
    "effective_mass": lambda s: s.apparent_mass.real,
    "damping_mass": lambda s: -s.apparent_mass.imag,
    "loss_factor": lambda s: -s.apparent_mass.imag / abs(s.apparent_mass.real),
}
"""Those of rattlebox.MEASURES that do not look at single impacts; they mean the same."""

_OF_THE_FIRST_HARMONIC = ("reduced_loss", "effective_mass", "damping_mass", "loss_factor")


@dataclass
class ParticleWork(ImpactWork):
    """A case with particles in space, its variants, and what is kept of each; attributes as those of ImpactWork.

    Functions of a run are given the run that the measures are found from, whose samples are those of the case's output, or
    what `samples` or `cycles` ask for. Motions, impacts and states are not kept.
    """

    @cached_property
    def outputs(self) -> dict[str, tuple[Extra, str, dict[str, Any]]]:
        """Those of a ImpactWork, and in what each run left its bounds."""
        found = dict(super().outputs)
        masks, names = [2**bit for bit in range(len(WARNINGS))], " ".join(WARNINGS)
        about = {"long_name": "in what the run left its bounds", "flag_masks": masks, "flag_meanings": names}
        return {"status": found.pop("status"), "warnings": ((), "int8", about), **found}

    def validate(self) -> None:
        """Raise if the arguments do not fit the case or each other.

        Raises
        ------
        CaseError
            With what to try.
        """
        for name in self.named:
            if name not in _FOUND:
                raise Hint(f"{name} looks at single impacts, of which particles in space keep none", ", ".join(_FOUND))
            if MEASURES[name].cyclic and math.isnan(_frequency(self.case)):
                raise Hint(f"{name} needs a harmonic load or motion, whose cycle it refers to", "kind harmonic")
        if self.motion or self.last or self.state:
            raise Hint(
                "of particles in space neither motion nor last impacts are kept", "a function of a Run as measure"
            )
        if self.cycles is not None and math.isnan(_frequency(self.case)):
            raise Hint("cycles need a harmonic load or motion", 'duration and skip in seconds: skip = "2 s"')
        self._check_ends()
        if self.cycles is None and self.skip >= self.case.duration:
            raise Hint(f"skip = {self.skip:.6g} s leaves nothing of the run to look at", "a longer duration")
        window = self.case.duration - self.skip
        cyclic = [name for name in self.named if MEASURES[name].cyclic]
        if self.cycles is None and cyclic and window * _frequency(self.case) < 1 - 1e-9:
            raise Hint(
                f"skip = {self.skip:.6g} s leaves no whole cycle for {cyclic[0]} to look at", "a longer duration"
            )
        points = self.case.modes.lines()
        if self.point is not None and self.point not in points:
            raise Hint(f"there is no point {self.point!r}", " or ".join(points) or "leave it out", ["point"])

    def coords(self) -> dict[str, Any]:
        """Return the coordinates of the dimensions beyond the grid, of which there are none."""
        return {}

    @property
    def block(self) -> int:
        """Preferred number of variants in a block."""
        return 1

    def run(
        self,
        start: int,
        stop: int,
        *,
        threads: int = 1,
        cancelled: Callable[[], bool] | None = None,
    ) -> Values | None:
        """Run variants start to stop.

        Parameters
        ----------
        start, stop
            Variants, counted along the grid with its last axis fastest.
        threads
            Of each run.
        cancelled
            Asked some fifty times a second; True stops.

        Returns
        -------
        dict of str to array, or None
            Each output, (stop - start,); None when it was stopped.
        """

        def go_on(*_: int) -> bool:
            return not (cancelled and cancelled())

        rows = {}
        for index in range(start, stop):
            try:
                case = self.variant(index)
                run = simulate_dem(case, threads=threads, progress=go_on) if settle_all(case, go_on) else None
            except RattleboxError:  # one corner of many; run alone it says why
                continue
            if run is None or run.status == "interrupted":
                return None
            rows[index] = self.row(case, run, index)
        return self.columns(rows, start, stop)

    def row(self, case: Case, run: Run, index: int) -> dict[str, float]:
        """Return what is kept of a run, and of what was run, by name."""
        warned = exceeded_limits(run.diagnostics)
        row: dict[str, float] = {
            "status": Status[run.status],
            "warnings": sum(2**bit for bit, name in enumerate(WARNINGS) if name in warned),
        }
        if run.status == "energy_error" and "energy_residual" in self.named:
            row["energy_residual"] = self._seen_in(run, case).value("energy_residual")
        if run.ok:
            seen = self._seen_in(run, case)
            row |= {name: seen.value(name) for name in self.named}
            row |= self._intervals(run, case, row)
            row |= self.own_of(run, index)
        return row

    def columns(self, rows: Mapping[int, Mapping[str, float]], start: int, stop: int) -> Values:
        """Return each output of variants start to stop, of which those without a row were refused."""

        def column(name: str, missing: float, kind: str) -> NDArray[Any]:
            return np.array([rows.get(index, {}).get(name, missing) for index in range(start, stop)], kind)

        names = (*self.named, *(name + INTERVAL for name in self.steady), *self.own)
        values = {name: column(name, np.nan, "float64") for name in names}
        return {"status": column("status", Status.refused, "int8"), "warnings": column("warnings", 0, "int8"), **values}

    def why_refused(self, index: int) -> str:
        """Return why a variant is refused; nothing where it is not."""
        try:
            return refusal_reason(self.variant(index))
        except RattleboxError as error:
            return str(error)

    def variant(self, index: int) -> Case:
        """Return a variant as it is run.

        Raises
        ------
        CaseError
            When it cannot be.
        """
        case = self.grid.case_at(self.case, index)
        if not case.particle_dampers:
            raise Hint("a variant without particles in space", "one sweep for each kind of damper")
        return self._windowed(case)

    def _check_ends(self) -> None:
        """Refuse what fits neither the first variant nor the last one."""
        for index in (0, self.size - 1):
            try:
                self.variant(index)
                return
            except RattleboxError as error:
                refused = error
        raise refused

    def _windowed(self, case: Case) -> Case:
        """A case with the duration and the samples that are asked for."""
        duration, skip, samples = case.duration, self.skip, self.samples
        if self.cycles is not None:
            period = 1 / _frequency(case)
            duration, skip = sum(self.cycles) * period, self.cycles[0] * period
            _check_begun(case, skip)
            each = 64 if samples is None else max(1, math.ceil((samples - 1) / self.cycles[1]))
            samples = 1 + each * self.cycles[1]  # of which one is where they begin
        if samples is not None and duration > skip:
            output = Output(rate=(samples - 1) / (duration - skip))
            case = case.model_copy(update={"duration": duration, "output": output})
        for name in self.named:
            if name in _OF_THE_FIRST_HARMONIC:
                _check_dense(case, name)
        return case

    def _intervals(self, run: Run, case: Case, row: Mapping[str, float]) -> dict[str, float]:
        """Return half of the 95 % intervals of the measures of steady motion."""
        limits = _batch_limits(self._begin(case), float(run.arrays.time[-1]), _frequency(case), run.arrays.time)
        lengths = np.diff(limits)[None]
        parts = [self._seen_in(until(run, end), case, begin) for begin, end in pairwise(limits)] if self.steady else []
        return {
            name + INTERVAL: float(
                interval_of(name, [row[name]], np.array([[p.value(name) for p in parts]]), lengths)[0]
            )
            for name in self.steady
        }

    def _begin(self, case: Case) -> float:
        """Begin of the window [s]."""
        return self.skip if self.cycles is None else self.cycles[0] / _frequency(case)

    def _seen_in(self, run: Run, case: Case, start: float | None = None) -> Seen:
        frequency = _frequency(case)
        start = self._begin(case) if start is None else start
        window = since(run, start)
        if (driver := _driver(case)) and driver.amplitude == 0:
            frequency = math.nan  # nothing has cycles
        arrays = window.arrays
        if self.point is None:
            along = unit_vector(case.particle_dampers[0].direction)
            return Seen(
                window,
                run,
                start,
                arrays.cavity_displacement[:, 0] @ along,
                arrays.cavity_velocity[:, 0] @ along,
                arrays.base_velocity @ along,
                frequency,
            )
        column = arrays.points.index(self.point)
        base = base_at_points(case, arrays.base_velocity)[:, column]
        return Seen(window, run, start, arrays.displacement[:, column], arrays.velocity[:, column], base, frequency)


def since(run: Run, start: float) -> Run:
    """Return a run from a time on [s], between two samples on the line; work and losses count from there."""
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


def until(run: Run, end: float) -> Run:
    """Return a run up to the first sample at or after a time [s]."""
    arrays = run.arrays
    count = min(int(np.searchsorted(arrays.time, end * (1 - 1e-9))) + 1, arrays.time.size)
    names = (v.name for v in variables(arrays.engine) if v.dims[0] == "time" and not v.derived)
    cut = {name: getattr(arrays, name)[:count] for name in names}
    return replace(run, arrays=arrays.replaced(time=arrays.time[:count], **cut))


def _batch_limits(start: float, end: float, frequency: float, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return limits of up to 64 equal parts of a window, of whole cycles up to its end; none if samples are too few."""
    if math.isnan(frequency):
        limits = np.linspace(start, end, MOST_BATCHES + 1)
    else:
        whole = math.floor((end - start) * frequency + 1e-9)
        if whole < 1:
            return np.zeros(1)
        each = math.ceil(whole / MOST_BATCHES)
        limits = end - np.arange(whole // each, -1, -1) * each / frequency
    return limits if np.count_nonzero(times >= start) > limits.size else np.zeros(1)


def _driver(case: Case) -> Harmonic | None:
    """The first harmonic load or motion, whose cycles are counted."""
    signals = (*case.loads, *case.base, *case.shaker_motion)
    return next((signal for signal in signals if isinstance(signal, Harmonic)), None)


def _frequency(case: Case) -> float:
    """Of the first harmonic load or motion [Hz], NaN without one."""
    driver = _driver(case)
    return driver.frequency if driver else math.nan


def _check_begun(case: Case, skip: float) -> None:
    """Refuse cycles to look at of what has not begun when they do."""
    driver = _driver(case)
    if driver and driver.start > skip * (1 + 1e-9):
        raise Hint(
            f"the cycles that are looked at begin at {skip:.4g} s, and what shakes at {driver.start:.4g} s",
            "start = 0, or more cycles to skip",
        )


def _check_dense(case: Case, name: str) -> None:
    """Refuse a measure of the first harmonic where samples are too few to know it."""
    each = (case.sample_times().size - 1) / (case.duration * _frequency(case))
    if each < MIN_SAMPLES * (1 - 1e-6):
        raise Hint(
            f"{name} needs {MIN_SAMPLES} samples in a cycle, and there are {each:.3g}",
            "more samples; without a number there are enough",
        )
