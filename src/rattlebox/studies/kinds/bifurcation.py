"""Bifurcation diagrams: steady motion under a harmonic load over a parameter."""

from __future__ import annotations

from dataclasses import KW_ONLY
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator
from pydantic.dataclasses import dataclass

from rattlebox._util.exceptions import CaseError
from rattlebox.core import _core
from rattlebox.model.errors import Hint
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.grid.grid import Grid
from rattlebox.studies.run.store import save_result
from rattlebox.studies.run.study import (
    CONFIG,
    CyclesToCompare,
    Fraction,
    Measures,
    Study,
    Values,
    study_function,
)
from rattlebox.studies.work.impact import ImpactEngine
from rattlebox.studies.work.measures import with_required
from rattlebox.studies.work.reductions import classify, labels, reduced_strobes, unsettled, without_speed
from rattlebox.studies.work.variants import Variants, order_along, with_direction
from rattlebox.studies.work.work import Work

if TYPE_CHECKING:
    import xarray

    Path = str | tuple[str, ...]
else:
    Path = Annotated[
        Any, BeforeValidator(lambda path: tuple(map(str, path)) if isinstance(path, (list, tuple)) else str(path))
    ]


_IMPACTS = 8
"""Largest number of impacts per evaluated cycle."""


@dataclass(frozen=True, config=CONFIG)
class Bifurcation(Study):
    """Compute a bifurcation diagram: the state once per cycle, or each impact, over a parameter.

    Parameters
    ----------
    case
        Case with impact dampers and a harmonic load or motion, the first of which defines the cycle.
    path
        Path of the parameter, or a tuple of paths that vary together.
    values
        Rising values: a list, an array, `linspace` or `geomspace`; for several paths a tuple of these.
    cycles
        Numbers of cycles of each value to skip until the motion is steady, and to evaluate.
    show
        "strobe" for the state once per cycle, "impacts" also for phase and speed of each impact.
    direction
        "up" or "down", where each value starts from the final state of the one before; "both" for up and then back
        down; "fresh", where each value starts from the initial state of the case.
    measure
        Names of further measures (`rb.MEASURES`).
    tolerance
        Largest difference between states one period apart, and largest distance to the periodic motion, over the range of
        the motion.
    apart
        Largest difference between states that count as the same, over the range of the motion.
    point
        Observed point of the structure, "storey 2 - storey 1" for a drift, or "mode 2"; default that of the first damper.
    workers, backend, store, progress
        Execution and storage; see `rattlebox.studies.run.study.Study`.

    Returns
    -------
    xarray.Dataset
        Over `direction` and the parameter: `status`; `period` in cycles, 0 if it exceeds half of the evaluated cycles or
        does not exist; `motion`, `multiplier` and `attrs["unsettled"]` as in `rb.basins`; `impacts_per_cycle` and the
        requested measures. Also over `cycle`: `displacement` and `velocity`
        of the point, and over `ball`: `relative_position` and `relative_velocity` in the cavity. With show="impacts" over
        `impact`, the last 8 per evaluated cycle, NaN if there are fewer: `impact_phase` of the load [rad],
        `approach_speed` and `contact`.

    Raises
    ------
    CaseError
        If an argument is not valid for the case.

    Notes
    -----
    The state once per cycle is a point of the Poincare section at a constant phase of the load, s_k = s(t_0 + k T). The
    period is determined as in `rb.basins`: a motion that still contracts is transient and has no period.

    References
    ----------
    S. W. Shaw, P. J. Holmes (1983), A periodically forced piecewise linear oscillator, Journal of Sound and Vibration 90,
    129-155, doi:10.1016/0022-460X(83)90407-8.
    A. B. Nordmark (1991), Non-periodic motion caused by grazing incidence in an impact oscillator, Journal of Sound and
    Vibration 145, 279-297, doi:10.1016/0022-460X(91)90592-8.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.Case(
    ...     structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz")),
    ...     damper=rb.ImpactDamper(
    ...         ball=rb.Sphere(radius="10 mm", material="steel"), gap="1 mm", velocity=0.1, contact=rb.Tsuji(restitution=0.6)
    ...     ),
    ...     duration="1 s",
    ... )
    >>> maps = rb.bifurcation(case, "structure.motion.amplitude", rb.linspace("0.5 mm", "2 mm", 5), cycles=(40, 8))
    >>> maps.relative_position.dims
    ('direction', 'structure.motion.amplitude', 'cycle', 'ball')
    """

    kind: ClassVar[str] = "bifurcation"
    figure: ClassVar[str] = "rattlebox.plots.bifurcation:plot_bifurcation"
    report: ClassVar[str] = "rattlebox.report.kinds.steady_motions:BIFURCATION"

    path: Path
    values: Values
    _: KW_ONLY
    cycles: CyclesToCompare = (400, 48)
    show: Literal["strobe", "impacts"] = "strobe"
    direction: Literal["up", "down", "both", "fresh"] = "both"
    measure: Measures = ()
    tolerance: Fraction = 1e-4
    apart: Fraction = 1e-2
    point: str | None = None

    @cached_property
    def grid(self) -> Grid:
        """Grid of the values of the parameter."""
        return read_axes(self.case, {self.path: self.values}, source="bifurcation")

    @cached_property
    def work(self) -> Work:
        """Runs of all values."""
        count = self.cycles[1]
        measures = with_required(("impacts", "impacts_per_cycle", "largest_approach_speed"), self.measure)
        grid, order = order_along(self.grid, self.direction, turn_back=True)
        variants = Variants(self.case, grid, measures, cycles=self.cycles, samples=count + 1, point=self.point)
        last = _IMPACTS * count if self.show == "impacts" else 0
        return Work(ImpactEngine(variants, motion=True, last=last, state=order.is_chain), order)

    def validate(self) -> None:
        """Raise if the fields are not valid; see `Study.validate`."""
        if not (self.case.dampers or self.case.stops):
            raise CaseError(
                "the case has no damper and no stop; its motion is linear and has no bifurcation",
                "a case with an impact damper, or a stop",
            )
        self._values.require_alike()
        _check_order(self.grid, self.direction)
        self.work.validate()

    @property
    def _values(self) -> ImpactEngine:
        """The values in their order, for the evaluation."""
        return ImpactEngine(Variants(self.case, self.grid, cycles=self.cycles, point=self.point))

    def compute(self) -> xarray.Dataset:
        """Run all values and determine the periods; see `Study.compute`."""
        runs = self.run_work(self.work)
        runs = with_direction(runs)
        about = {
            "title": "Bifurcation diagram",
            "case": self.case.to_toml(),
            "cycles": list(self.cycles),
            "tolerance": self.tolerance,
            "apart": self.apart,
        }
        found = self._evaluate(runs.load()).assign_attrs(about)
        return save_result(found, self.kind, self.store)

    def _evaluate(self, maps: xarray.Dataset) -> xarray.Dataset:
        """Return the states and impacts of the evaluated cycles with the periods of the motions."""
        task = self._values
        over, period = maps.status.dims, np.asarray(task.output.period)
        maps = maps.isel(instant=slice(1, None)).rename(instant="cycle")
        strobes, ranges = reduced_strobes(maps, task.packed, period)
        orbits = classify(strobes / ranges[..., None, :], self.tolerance, self.apart)
        maps = maps.assign(labels(over, orbits)).assign_attrs(unsettled(orbits, self.cycles, self.tolerance))
        if "last_time" in maps:
            load = next(load.signal for load in task.packed.loads if isinstance(load.signal, _core.Harmonic))
            time = maps.last_time.where(maps.last_time >= _column(task.output.start))
            phase = (_column(load.frequency) * time + _column(load.phase)) % (2 * np.pi)
            maps = maps.rename(last="impact", last_approach_speed="approach_speed", last_contact="contact")
            maps["impact_phase"] = (*over, "impact"), phase.values, {"units": "rad", "long_name": "phase of the load"}
            for name in ("approach_speed", "contact"):
                maps[name] = maps[name].where(np.isfinite(maps.impact_phase))
        return without_speed(maps, self.measure).drop_vars(["impacts", "last_time"], errors="ignore")


bifurcation = study_function(Bifurcation)


def _check_order(design: Grid, direction: str) -> None:
    """Raise if the values do not rise."""
    path, values = next(iter(design.columns.items()))
    if values.dtype.kind == "f":
        if np.any(np.diff(values) <= 0):
            raise Hint(f"{path}: the values must be strictly rising", "numpy.unique")
    elif direction != "fresh":
        raise Hint(f"{path}: its values are not numbers and have no order", 'direction = "fresh"')


def _column(number: Any) -> Any:
    return np.asarray(number)[..., None] if np.ndim(number) else number
