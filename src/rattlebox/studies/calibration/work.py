"""Simulations of measured losses: each sample of the parameters with a random start of its own."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import RattleboxError
from rattlebox._util.quantities import amount
from rattlebox.engines.simulate import simulate_many
from rattlebox.model.harmonics import Harmonic
from rattlebox.model.space import unit_vector
from rattlebox.model.structures import Shaker
from rattlebox.prepare.time_step import WARNINGS
from rattlebox.studies.calibration.measurements import Losses, RingDown, ShakerLoss
from rattlebox.studies.damping_curve import Remarks, damping_curve_cases, mode_of, random_starts, ratios_of_decays
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.run.estimate import RunGroup, time_of_particle_runs
from rattlebox.studies.work.particles import FLAGS, engine_of
from rattlebox.studies.work.variants import AMPLITUDE, FREQUENCY, Variants, describe_case
from rattlebox.studies.work.work import Cancelled, Outputs, Values, proceed_unless

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.studies.grid.grid import Grid

FloatArray = NDArray[np.float64]

Proceed = Callable[..., bool]
"""Function that returns False when the runs must stop."""


class Point(NamedTuple):
    """Place of a measured value: its measure, the amplitude with its SI unit, and the frequency, NaN for a decay [Hz]."""

    measure: str
    amplitude: float
    unit: str
    frequency: float

    def __str__(self) -> str:
        hertz = "" if math.isnan(self.frequency) else f" and {amount(self.frequency, 'Hz')}"
        return f"the {self.measure.replace('_', ' ')} at {amount(self.amplitude, self.unit)}{hertz}"


@dataclass(frozen=True, eq=False)
class Decay:
    """Simulation of a ring-down."""

    data: RingDown
    levels: FloatArray  # Amplitudes as displacements [m], (M,)

    @classmethod
    def of(cls, data: RingDown, case: Case) -> Decay:
        """Return the simulation of a measurement; raise if the case has no such mode or point."""
        mode = mode_of(case, data.mode, data.point)
        return cls(data, data.amplitude / mode.omega**2 if data.unit == "m/s^2" else data.amplitude)

    @property
    def measured(self) -> FloatArray:
        """Measured values, (M,)."""
        values: FloatArray = self.data.damping_ratio
        return values

    def simulate(self, case: Case, threads: int, proceed: Proceed) -> tuple[FloatArray, int]:
        """Return the simulated values of a start, (M,), and exceeded limits as bits in the order of `WARNINGS`."""

        def evaluate(cases: Sequence[Case], row_of: Callable[..., object]) -> list[Any]:
            return [row_of(simulate_many([each], threads=threads, progress=proceed)[0]) for each in cases]

        mode, remarks = mode_of(case, self.data.mode, self.data.point), Remarks()
        ratios = ratios_of_decays([case], mode, self.levels, "decay", evaluate, remarks)
        return ratios[0], sum(2**bit for bit, name in enumerate(WARNINGS) if name in remarks.exceeded)

    def runs(self, case: Case) -> list[Case]:
        """Return the cases of the runs of a start."""
        return damping_curve_cases(case, self.levels.tolist(), mode=self.data.mode, point=self.data.point, packings=1)

    def check(self, case: Case) -> None:
        """Raise if the case cannot be simulated."""

    def points(self) -> list[Point]:
        """Return the place of each value."""
        return [Point("damping_ratio", level, "m", math.nan) for level in self.levels.tolist()]

    def describe(self) -> dict[str, Any]:
        """Return a description of the simulations, in JSON types."""
        return {"kind": "ring-down", "levels": self.levels.tolist(), "mode": self.data.mode, "point": self.data.point}


@dataclass(frozen=True, eq=False)
class Shaken:
    """Simulation of losses on a shaker."""

    data: ShakerLoss
    grid: Grid
    direction: Any

    @classmethod
    def of(cls, data: ShakerLoss, case: Case) -> Shaken:
        """Return the simulation of a measurement; raise if the damper cannot be shaken."""
        direction: Any = None
        if case.particle_dampers:
            direction = tuple(unit_vector(case.particle_dampers[0].direction).tolist())
            (*_, motion) = (None, *case.shaker_motion)
            if motion is not None and getattr(motion, "direction", None) is not None:
                direction = motion.direction
        on_shaker = _on_shaker(case, data, direction)
        points = {"datum": {AMPLITUDE: data.amplitude.tolist(), FREQUENCY: data.frequency.tolist()}}
        return cls(data, read_axes(on_shaker, points, source="data"), direction)

    @property
    def measured(self) -> FloatArray:
        """Measured values, (M,)."""
        values: FloatArray = self.data.loss
        return values

    def _engine(self, case: Case) -> Any:
        shaken = _on_shaker(case, self.data, self.direction)
        return engine_of(Variants(shaken, self.grid, [self.data.measure], cycles=self.data.cycles))

    def check(self, case: Case) -> None:
        """Raise if the case cannot be simulated."""
        self._engine(case).validate()

    def simulate(self, case: Case, threads: int, proceed: Proceed) -> tuple[FloatArray, int]:
        """Return the simulated values of a start, (M,), and exceeded limits as bits in the order of `WARNINGS`."""
        size = self.grid.size
        found = self._engine(case).run(range(size), threads=threads, cancelled=lambda: not proceed())
        if found is None:
            return np.full(size, np.nan), 0
        warnings = found.get("warnings")
        return found[self.data.measure], 0 if warnings is None else int(np.bitwise_or.reduce(warnings))

    def runs(self, case: Case) -> list[Case]:
        """Return the cases of the runs of a start."""
        engine = self._engine(case)
        return [engine.variant(index) for index in range(self.grid.size)]

    def points(self) -> list[Point]:
        """Return the place of each value."""
        data = self.data
        pairs = zip(data.amplitude.tolist(), data.frequency.tolist(), strict=True)
        return [Point(data.measure, amplitude, data.unit, frequency) for amplitude, frequency in pairs]

    def describe(self) -> dict[str, Any]:
        """Return a description of the simulations, in JSON types."""
        data = self.data
        return {
            "kind": "shaker",
            "measure": data.measure,
            "amplitude": [f"{value!r} {data.unit}" for value in data.amplitude.tolist()],
            "frequency": data.frequency.tolist(),
            "cycles": list(data.cycles),
            "direction": None if self.direction is None else list(self.direction),
        }


def _on_shaker(case: Case, data: ShakerLoss, direction: object) -> Case:
    """Return a case with its dampers on a shaker at the first point of the data."""
    motion: dict[str, Any] = {
        "amplitude": f"{float(data.amplitude[0])!r} {data.unit}",
        "frequency": float(data.frequency[0]),
    }
    if direction is not None:
        motion["direction"] = direction
    for damper in case.particle_dampers:
        damper.check_base("rb.RingDown, free decays, as data")
    dampers = tuple(damper.model_copy(update={"point": None}) for damper in case.dampers)
    parts = {
        "structure": Shaker(motion=Harmonic(**motion)),
        "dampers": dampers,
        "tuned_masses": (),
        "loads": (),
        "base": (),
    }
    return case.model_copy(update=parts)


Simulation = Decay | Shaken


def simulation_of(data: Losses, case: Case) -> Simulation:
    """Return the simulation of a measurement."""
    if isinstance(data, RingDown):
        return Decay.of(data, case)
    return Shaken.of(data, case)


@dataclass(eq=False)
class CalibrationEngine:
    """Simulations of all measurements over samples of the parameters."""

    case: Case
    grid: Grid
    simulations: Sequence[Simulation]
    first: int = 0

    @property
    def block(self) -> int:
        """Preferred number of samples in a block."""
        return 1 if self.case.particle_dampers else 4

    @property
    def count(self) -> int:
        """Number of measured values."""
        return sum(each.measured.size for each in self.simulations)

    @cached_property
    def outputs(self) -> Outputs:
        """Further dimensions, number type and attributes of each output."""
        return {
            "simulated": ((("datum", self.count),), "float64", {"long_name": "simulated value"}),
            "warnings": ((), "int16", FLAGS),
        }

    def coords(self) -> dict[str, Any]:
        """Return the coordinates of the dimensions beyond the grid: none."""
        return {}

    def describe(self) -> dict[str, Any]:
        """Return a description of everything except the grid, in JSON types."""
        simulations = [each.describe() for each in self.simulations]
        return {**describe_case(self.case, self.grid.columns), "simulations": simulations, "first": self.first}

    @cached_property
    def _starts(self) -> list[Case]:
        return random_starts(self.case, self.first + self.grid.size)[self.first :]

    def variant(self, index: int) -> Case:
        """Return the case of a sample."""
        return self.grid.case_at(self._starts[index], index)

    def run(
        self, numbers: range, *, threads: int = 1, cancelled: Cancelled = None, reduction: None = None
    ) -> Values | None:
        """Return the outputs of samples; see `Engine.run`."""
        proceed = proceed_unless(cancelled)
        simulated, warnings = np.full((len(numbers), self.count), np.nan), np.zeros(len(numbers), np.int16)
        for row, index in enumerate(numbers):
            first = 0
            for each in self.simulations:
                own = slice(first, first + each.measured.size)
                first = own.stop
                try:
                    simulated[row, own], exceeded = each.simulate(self.variant(index), threads, proceed)
                except RattleboxError:  # see `reason`
                    continue
                warnings[row] |= exceeded
                if not proceed():
                    return None
        return {"simulated": simulated, "warnings": warnings}

    def reason(self, index: int) -> str:
        """Return why a sample has no result, or ""."""
        for each in self.simulations:
            try:
                each.simulate(self.variant(index), 1, lambda *_: True)
            except RattleboxError as error:
                return error.without_suggestion
        return ""

    def predict(self) -> tuple[float, float]:
        """Return the processor time of all samples [s], and the share of a processor that the timed runs had."""
        if not self.case.particle_dampers:
            before = time.process_time()
            for each in self.simulations:
                each.simulate(self.variant(0), 1, lambda *_: True)
            return (time.process_time() - before) * self.grid.size, 1.0
        cases = [run for each in self.simulations for run in each.runs(self.variant(0))]
        groups = (RunGroup.of(each, self.grid.size, self.grid.size) for each in cases)
        times, share = time_of_particle_runs([group for group in groups if group])
        return sum(times), share
