"""Frequency responses: steady motion under a harmonic load over its frequency and level."""

from __future__ import annotations

from dataclasses import KW_ONLY
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from pydantic.dataclasses import dataclass

from rattlebox.core import _core
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint
from rattlebox.model.harmonics import Harmonic
from rattlebox.model.units import Whole
from rattlebox.studies.axes import read_axes
from rattlebox.studies.continuation import ContinuationWork, without_states
from rattlebox.studies.grid import Grid
from rattlebox.studies.impact_work import ImpactWork
from rattlebox.studies.measures import interval_warning, with_required
from rattlebox.studies.orbits import period_of
from rattlebox.studies.store import save_result
from rattlebox.studies.study import (
    CONFIG,
    Cycles,
    Fraction,
    Measures,
    Study,
    Values,
    study_function,
)

if TYPE_CHECKING:
    import xarray

_MEASURES = "peak", "rms", "impacts_per_cycle"


@dataclass(frozen=True, config=CONFIG)
class FrequencyResponse(Study):
    """Compute the steady motion under a harmonic load over frequency, at one or several levels of the load.

    If two steady motions coexist at a frequency, an upward and a downward sweep often reach both: each sweep starts from the
    initial state of the case, and each further frequency from the final state of the one before. A sweep stays on its
    motion until this disappears, and then jumps to the other one.

    Parameters
    ----------
    case
        Case with one harmonic load or base motion.
    frequencies
        Rising frequencies: numbers [Hz], text with units, `linspace` or `geomspace`.
    levels
        Amplitudes of the load or motion in the same forms; default that of the case.
    direction
        "up", "down" or "both"; "fresh" starts each frequency from the initial state of the case.
    cycles
        Numbers of cycles of each frequency to skip until the motion is steady, and to evaluate.
    measure
        Names of further measures (`rb.MEASURES`).
    point
        Observed point of the structure, "storey 2 - storey 1" for a drift, or "mode 2"; default that of the first damper.
    samples
        Number of samples per cycle. The relative error of `peak` is (pi/samples)^2/2, 0.12 % for 64.
    tolerance
        Largest difference between positions of structure and balls one period apart, over their range.
    workers, backend, store, progress
        Execution and storage; see `rattlebox.studies.study.Study`.

    Returns
    -------
    xarray.Dataset
        Over `direction`, `level` and `frequency` [Hz]: `status`; `peak` and `rms` [m]; `amplitude` [m] and `phase` [rad] of
        the first harmonic, amplitude sin(2 pi f t + phase of the load + phase); `impacts_per_cycle`; `spread`, the largest
        difference of positions one cycle apart, over their range; `period` in cycles, 0 if it exceeds half of the
        evaluated cycles or does not exist; the requested measures. Over level and frequency: `bare_amplitude` [m] of the
        structure without dampers.

    Raises
    ------
    CaseError
        If the case has not exactly one harmonic load or base motion, its structure has no modes, or an argument is not
        valid for it.

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
    >>> response = rb.frequency_response(case, rb.linspace("28 Hz", "36 Hz", 9), cycles=(50, 10))
    >>> response.amplitude.dims
    ('direction', 'level', 'frequency')
    """

    kind: ClassVar[str] = "frequency_response"

    frequencies: Annotated[Values, Field(examples=[{"from": "9 Hz", "to": "11 Hz", "count": 50}])]
    _: KW_ONLY
    levels: Values | None = None
    direction: Literal["up", "down", "both", "fresh"] = "both"
    cycles: Cycles = (200, 32)
    measure: Measures = ()
    point: str | None = None
    samples: Annotated[Whole, Field(ge=8)] = 64
    tolerance: Fraction = 1e-3

    @cached_property
    def _driver(self) -> tuple[str, Harmonic]:
        """Path and signal of the harmonic load or base motion."""
        return _driver(self.case)

    @cached_property
    def grid(self) -> Grid:
        """Grid of levels and frequencies."""
        place, driver = self._driver
        levels = [f"{driver.amplitude!r} {driver.unit}"] if self.levels is None else self.levels
        axes = [{f"{place}.amplitude": levels}, {f"{place}.frequency": self.frequencies}]
        return read_axes(self.case, axes, source="frequency_response")

    @cached_property
    def work(self) -> ImpactWork:
        """Runs of all frequencies and levels, with samples of their motion."""
        options: dict[str, Any] = {
            "measures": with_required(_MEASURES, self.measure),
            "cycles": self.cycles,
            "samples": self.samples * self.cycles[1] + 1,
            "point": self.point,
            "motion": True,
            "intervals": True,
        }
        if self.direction == "fresh":
            return ImpactWork(self.case, self.grid, **options)
        directions = ("up", "down") if self.direction == "both" else (self.direction,)
        return ContinuationWork.along(self.case, self.grid, directions=directions, **options)

    def validate(self) -> None:
        """Raise if the fields are not valid; see `Study.validate`."""
        hertz = self.grid.coords()[f"{self._driver[0]}.frequency"][1]
        if np.any(np.diff(hertz) <= 0):
            raise Hint("the frequencies must be strictly rising", "each frequency once, in order")
        self.work.validate()

    def compute(self) -> xarray.Dataset:
        """Run all frequencies and evaluate their steady motion; see `Study.compute`."""
        place, driver = self._driver
        bare = _bare(ImpactWork(self.case, self.grid, cycles=(0, 1), point=self.point))
        runs = self.run_work(self.work)
        runs = runs.expand_dims(direction=["fresh"]) if self.direction == "fresh" else without_states(runs)
        runs = runs.rename({f"{place}.frequency": "frequency", f"{place}.amplitude": "level"}).load()
        found = _steady(runs, driver.phase, self.samples, self.tolerance)
        units = found.amplitude.attrs["units"]
        found["bare_amplitude"] = (
            ("level", "frequency"),
            bare,
            {"units": units, "long_name": "amplitude without dampers"},
        )
        found.frequency.attrs["long_name"] = "frequency"
        load = "load" if place.startswith("load") else "base"
        found.level.attrs["long_name"] = f"amplitude of the {load}"
        about = {"title": "Frequency response", "case": self.case.to_toml(), "cycles": list(self.cycles)}
        found.attrs = about | interval_warning(found)
        return save_result(found, self.kind, self.store)


frequency_response = study_function(FrequencyResponse)
"""Run a study of this kind: see `FrequencyResponse`."""


def _driver(case: Case) -> tuple[str, Harmonic]:
    """Return path and signal of the harmonic load or base motion."""
    if not case.modes.decay.size:
        raise Hint(f"a {case.structure.kind} structure has no modes", "a structure of kind sdof, modal or matrices")
    signals = [(f"{name}[{i}]", s) for name in ("loads", "base") for i, s in enumerate(getattr(case, name))]
    harmonics = [(place, signal) for place, signal in signals if isinstance(signal, Harmonic)]
    if len(harmonics) != 1:
        names = f" ({', '.join(place for place, _ in harmonics)})" if harmonics else ""
        raise Hint(
            f"the case has {len(harmonics)} harmonic loads or base motions{names}; a frequency response requires one",
            'kind = "harmonic"',
        )
    return harmonics[0]


def _bare(task: ImpactWork) -> NDArray[np.float64]:
    """Return the amplitude of the structure without dampers, (levels, frequencies) [m]."""
    packed = task.packed
    load, signal = next((load, load.signal) for load in packed.loads if isinstance(load.signal, _core.Harmonic))
    omega = signal.frequency
    dynamic: NDArray[np.complex128] = packed.mode_stiffness - omega**2 + 2j * packed.mode_decay * omega
    coupling = task.case.modes.coupling
    if coupling is None:
        motion = load.shape / dynamic
    else:
        matrix = np.moveaxis(1j * np.asarray(omega) * coupling[..., None, None], (0, 1), (-2, -1))
        matrix = matrix + np.moveaxis(dynamic, 0, -1)[..., None] * np.eye(len(coupling))
        force = np.broadcast_to(np.moveaxis(load.shape, 0, -1), matrix.shape[:-1])
        solution = np.linalg.solve(matrix, force[..., None])[..., 0]
        motion = np.moveaxis(np.asarray(solution, np.complex128), -1, 0)
    response = np.sum(task.output.shape * motion, axis=0)
    return np.asarray(np.broadcast_to(np.abs(signal.amplitude * response), task.grid.shape))


def _steady(maps: xarray.Dataset, phase: float, samples: int, tolerance: float) -> xarray.Dataset:
    """Return the first harmonic and the period of sampled motions."""
    z, place = maps.displacement.values, maps.relative_position.values
    turns = np.exp(-2j * np.pi * np.arange(z.shape[-1] - 1) / samples)
    harmonic = 2j / turns.size * (z[..., :-1] @ turns) * np.exp(-1j * phase)
    place = np.where(maps.impacts_per_cycle.values[..., None, None] > 0, place, 0.0)  # without impacts a ball drifts
    parts = np.concatenate([z[..., None], place], axis=-1)
    with np.errstate(invalid="ignore"):  # of runs that failed
        strobes = parts[..., ::samples, :] / np.ptp(parts, axis=-2).max(axis=-1)[..., None, None]
        period, _ = period_of(strobes, tolerance)
        spread = np.abs(np.diff(strobes, axis=-2)).max(axis=(-2, -1))
    over, units = maps.status.dims, maps.displacement.attrs["units"]
    return maps.drop_dims(["instant", "ball"]).assign(
        amplitude=(over, np.abs(harmonic), {"units": units, "long_name": "amplitude of the first harmonic"}),
        phase=(over, np.angle(harmonic), {"units": "rad", "long_name": "phase to the load"}),
        spread=(over, spread, {"units": "1", "long_name": "spread of strobes over the range of motion"}),
        period=(over, period, {"units": "1", "long_name": "cycles after which the motion repeats"}),
    )
