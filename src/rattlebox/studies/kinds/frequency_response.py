"""Frequency responses: steady motion under a harmonic load over its frequency and level."""

from __future__ import annotations

from dataclasses import KW_ONLY
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from pydantic.dataclasses import dataclass

from rattlebox.model.case import Case
from rattlebox.model.errors import Hint
from rattlebox.model.particle_case import direction_of_base, inertia_along
from rattlebox.model.space import unit_vector
from rattlebox.model.units import Whole
from rattlebox.prepare.particles import resolve_softening
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.grid.grid import Grid
from rattlebox.studies.kinds.sweep import result_notes
from rattlebox.studies.maps.response_from_map import force_measures
from rattlebox.studies.run.store import save_result
from rattlebox.studies.run.study import (
    CONFIG,
    Cycles,
    Fraction,
    Measures,
    Study,
    Values,
    study_function,
)
from rattlebox.studies.work.impact import ImpactEngine
from rattlebox.studies.work.measures import interval_warning, with_required
from rattlebox.studies.work.particles import ParticleEngine
from rattlebox.studies.work.reductions import QUANTITIES, Orbits, SteadyMotion, attributes_of, steady_motion, unsettled
from rattlebox.studies.work.variants import Observed, Variants, order_along, with_direction
from rattlebox.studies.work.work import Work

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.harmonics import Harmonic

_MEASURES = "peak", "rms"


@dataclass(frozen=True, config=CONFIG)
class FrequencyResponse(Study):
    r"""Compute the steady motion under a harmonic load over frequency, at one or several levels of the load.

    If two steady motions coexist at a frequency, an upward and a downward sweep often reach both: each sweep starts from the
    initial state of the case, and each further frequency from the final state of the one before, with all particles and
    contacts. A sweep stays on its motion until this disappears, and then jumps to the other one.

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
        Names of further measures (`rb.MEASURES`). Measures of single impacts do not exist for particle dampers.
    point
        Observed point of the structure, "storey 2 - storey 1" for a drift, or "mode 2"; default that of the first damper,
        for particle dampers in its direction.
    samples
        Number of samples per cycle. The relative error of `peak` is (pi/samples)^2/2, 0.12 % for 64.
    tolerance
        Largest difference between positions of the structure and of the balls of impact dampers one period apart, over
        their range.
    workers, backend, store, progress
        Execution and storage; see `rattlebox.studies.run.study.Study`.

    Returns
    -------
    xarray.Dataset
        Over `direction`, `level` and `frequency` [Hz]: `status`; `peak` and `rms` [m]; `amplitude` [m] and `phase` [rad] of
        the first harmonic, amplitude sin(2 pi f t + phase of the load + phase); `impacts_per_cycle` (impact dampers only);
        `spread`, the largest difference of positions one cycle apart, over their range; `period` in cycles, 0 if it exceeds
        half of the evaluated cycles or does not exist; `motion` (1: periodic, 2: transient, which still comes closer to a
        periodic motion, by the factor `multiplier` in each cycle, 3: neither); the requested measures. Averages have a
        companion such as `amplitude_interval`, half of the width of their 95 % interval; if the cycles are too few it is
        NaN, and `attrs["too_short"]` names them; `attrs["unsettled"]` counts motions of impact dampers that are not
        periodic. With particle dampers also `warnings`, the exceeded validity limits of each run (`flag_meanings`); see
        `rb.sweep` for frequencies that cannot run. Over level and frequency: `bare_amplitude` [m] of the structure without
        dampers. With a force, over `direction` and `level`: `minimum_real_part` [m/N] of the displacement over the force, on
        which chatter depends, and `dynamic_stiffness` [N/m], the smallest force over displacement.

    Raises
    ------
    CaseError
        If the case has not exactly one harmonic load or base motion, its structure has no modes, or an argument is not
        valid for it.

    Notes
    -----
    The first harmonic of the displacement x over the evaluated cycles, of the length t, is

    .. math:: A = \frac{2}{t} \left|\int x\, e^{-2 \pi i f \tau} d\tau\right|

    with whose phase that of the load is subtracted. `rattlebox.analysis.mean_interval` describes the intervals.

    References
    ----------
    A. H. Nayfeh, D. T. Mook (1979), Nonlinear Oscillations, Wiley, doi:10.1002/9783527617586 (coexisting steady motions and
    jumps between them).

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
    figure: ClassVar[str] = "rattlebox.plots.response:plot_frequency_response"
    report: ClassVar[str] = "rattlebox.report.kinds.frequency_response:KIND"

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
    def work(self) -> Work:
        """Runs of all frequencies and levels."""
        particles = bool(self.case.particle_dampers)
        grid, order = order_along(self.grid, self.direction)
        variants = Variants(
            _same_softening(self.case, self.grid) if particles and order.is_chain else self.case,
            grid,
            with_required((*_MEASURES, *["impacts_per_cycle"] * (not particles)), self.measure),
            cycles=self.cycles,
            samples=self.samples * self.cycles[1] + 1,
            point=self.point,
            intervals=True,
        )
        if particles:
            steady = SteadyMotion(self._driver[1].phase, self.tolerance, self.cycles[1])
            return Work(ParticleEngine(variants), order, steady)
        return Work(ImpactEngine(variants, motion=True, state=order.is_chain), order)

    def validate(self) -> None:
        """Raise if the fields are not valid; see `Study.validate`."""
        hertz = self.grid.coords()[f"{self._driver[0]}.frequency"][1]
        if np.any(np.diff(hertz) <= 0):
            raise Hint("the frequencies must be strictly rising", "each frequency once, in order")
        self.work.validate()

    def compute(self) -> xarray.Dataset:
        """Run all frequencies and evaluate their steady motion; see `Study.compute`."""
        place, driver = self._driver
        runs = self.run_work(self.work)
        notes = result_notes(self.work, runs)
        units = self.work.engine.variants.units_of("m")
        found = with_direction(runs).rename({f"{place}.frequency": "frequency", f"{place}.amplitude": "level"}).load()
        if not self.case.particle_dampers:
            found = _steady(found, driver.phase, self.samples, self.tolerance, units)
        bare = _bare(self.case, driver, found.frequency.values, found.level.values, self.point)
        found["bare_amplitude"] = (
            ("level", "frequency"),
            bare,
            {"units": units, "long_name": "amplitude without dampers"},
        )
        if place.startswith("load") and units == "m":
            found = found.assign(force_measures(found, found.amplitude))
        found.frequency.attrs["long_name"] = "frequency"
        load = "load" if place.startswith("load") else "base"
        found.level.attrs["long_name"] = f"amplitude of the {load}"
        about = {
            "title": "Frequency response",
            "case": self.case.to_toml(),
            "cycles": list(self.cycles),
            "samples": self.samples,
            "tolerance": self.tolerance,
        }
        about |= {name: runs.attrs[name] for name in ("measures", "point") if name in runs.attrs}
        if len(self.case.modes.lines()) > 1:
            about["observed"] = self.point or (self.case.dampers[0].point if self.case.dampers else "")
        if not self.case.particle_dampers:
            orbits = Orbits(found.period.values, found.motion.values, found.multiplier.values, found.spread.values)
            notes |= unsettled(orbits, self.cycles, self.tolerance)
        found.attrs = about | notes | interval_warning(found, self.case)
        return save_result(found, self.kind, self.store)


frequency_response = study_function(FrequencyResponse)


def _driver(case: Case) -> tuple[str, Harmonic]:
    """Return path and signal of the harmonic load or base motion."""
    if not case.modes.decay.size:
        raise Hint(f"a {case.structure.kind} structure has no modes", "a structure of kind sdof, modal or matrices")
    harmonics = list(case.harmonics.items())
    if len(harmonics) != 1:
        names = f" ({', '.join(case.harmonics)})" if harmonics else ""
        raise Hint(
            f"the case has {len(harmonics)} harmonic loads or base motions{names}; a frequency response requires one",
            'kind = "harmonic"',
        )
    return harmonics[0]


def _same_softening(case: Case, grid: Grid) -> Case:
    """Return a case with the smallest value of each softening "auto" at all levels and frequencies.

    Contacts would otherwise change their stiffness between two frequencies.
    """
    if all(damper.softening != "auto" for damper in case.particle_dampers):
        return case
    values = []
    for index in range(grid.size):
        resolved, _ = resolve_softening(grid.case_at(case, index))
        values.append([damper.softening_factor for damper in resolved.particle_dampers])
    dampers = [
        damper.model_copy(update={"softening": float(value)})
        for damper, value in zip(case.particle_dampers, np.min(values, axis=0), strict=True)
    ]
    return case.model_copy(update={"dampers": tuple(dampers)})


def _bare(
    case: Case, driver: Harmonic, frequency: NDArray[np.float64], level: NDArray[np.float64], point: str | None
) -> NDArray[np.float64]:
    """Return the amplitude of the structure without dampers, (levels, frequencies) [m]."""
    modes = case.modes
    if driver in case.loads:
        force = modes.shape(driver.point, driver.direction)
    elif case.particle_dampers:
        force = -inertia_along(case.modes, case.particle_dampers, direction_of_base(case.particle_dampers, driver))
    else:
        force = -np.asarray(modes.participation)
    if point is not None or not case.dampers:
        named = Observed.of(modes, modes.point(None) if point is None else point)
        observed = named.shape(modes.lines(), modes.decay.size)
    elif case.particle_dampers:
        first = case.particle_dampers[0]
        observed = modes.space_shape(first.point, first.direction) @ unit_vector(first.direction)
    else:
        observed = modes.shape(case.dampers[0].point)
    response = modes.harmonic_response(2 * np.pi * frequency, force[:, None])[:, :, 0] @ observed
    return np.abs(response) * np.abs(level[:, None])


def _steady(maps: xarray.Dataset, phase: float, samples: int, tolerance: float, units: str) -> xarray.Dataset:
    """Return the quantities of sampled steady motions in place of the samples."""
    place = maps.relative_position.values
    place = np.where(maps.impacts_per_cycle.values[..., None, None] > 0, place, 0.0)  # without impacts a ball drifts
    values = steady_motion(maps.displacement.values, place, phase, samples, tolerance)
    found = {
        name: (maps.status.dims, values[name], attributes_of(name, units if unit == "m" else unit))
        for name, (_, unit, _) in QUANTITIES.items()
    }
    return maps.drop_dims(["instant", "ball"]).assign(found)
