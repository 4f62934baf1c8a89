"""How a motion under a harmonic load changes with a parameter, and where its period doubles, breaks or jumps."""

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
from rattlebox.studies.axes import read_axes
from rattlebox.studies.continuation import ContinuationWork, without_states
from rattlebox.studies.grid import Grid
from rattlebox.studies.impact_work import ImpactWork
from rattlebox.studies.measures import with_required
from rattlebox.studies.orbits import period_of, reduced_strobes
from rattlebox.studies.store import keep_map
from rattlebox.studies.study import (
    CONFIG,
    CyclesToCompare,
    Fraction,
    Measures,
    Study,
    Values,
    study_function,
)

if TYPE_CHECKING:
    import xarray

    Path = str | tuple[str, ...]
else:
    Path = Annotated[
        Any, BeforeValidator(lambda path: tuple(map(str, path)) if isinstance(path, (list, tuple)) else str(path))
    ]


_IMPACTS = 8  # kept, for each cycle looked at


@dataclass(frozen=True, config=CONFIG)
class Bifurcation(Study):
    """Follow the motion under a harmonic load over a parameter, and output at it once a cycle or at each impact.

    Parameters
    ----------
    case
        The case, with dampers, under a harmonic load or motion. The cycle is that of the first one.
    path
        What varies, or a tuple of paths that vary together.
    values
        Rising: a list, an array, linspace or geomspace; with several paths, one such for each.
    cycles
        How many cycles of each value to skip until the motion is steady, and how many to output at.
    show
        "strobe" for the state once a cycle, "impacts" for phase and speed of each impact, too.
    direction
        "up" or "down", each value from the state in which the one before ended; "both", first up and then back down;
        or "fresh", each value from the start that the case says.
    measure
        Names of further measures (rb.MEASURES).
    tolerance
        A motion is held to repeat when its strobes differ by less than this part of the gap, and of gap times
        angular frequency.
    point
        Of the structure, that is watched; default the first damper's.
    workers, backend, store, progress
        Where the study runs, and where its results are stored; see `rattlebox.studies.study.Study`.

    Returns
    -------
    xarray.Dataset
        Over `direction` and the parameter: `status`; `period`, the number of cycles after which the motion repeats, 0
        where it does not within half the cycles looked at; `impacts_per_cycle` and the measures asked for. Further over
        `cycle`: `displacement` and `velocity` of the point, and over `ball`: `ball_place` and
        `ball_speed` in the cavity. With show="impacts", over `impact`, at most 8 a cycle looked at, NaN before the first:
        `impact_phase` of the load [rad], `approach_speed` and `contact`.

    Raises
    ------
    CaseError
        When an argument does not fit the case.

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
    >>> maps.ball_place.dims
    ('direction', 'structure.motion.amplitude', 'cycle', 'ball')
    """

    kind: ClassVar[str] = "bifurcation"

    path: Path
    values: Values
    _: KW_ONLY
    cycles: CyclesToCompare = (400, 48)
    show: Literal["strobe", "impacts"] = "strobe"
    direction: Literal["up", "down", "both", "fresh"] = "both"
    measure: Measures = ()
    tolerance: Fraction = 1e-4
    point: str | None = None

    @cached_property
    def grid(self) -> Grid:
        """Values of the parameter."""
        return read_axes(self.case, {self.path: self.values}, source="bifurcation")

    @cached_property
    def work(self) -> ImpactWork:
        """Runs of all values."""
        output = self.cycles[1]
        options: dict[str, Any] = {
            "measures": with_required(("impacts", "impacts_per_cycle"), self.measure),
            "cycles": self.cycles,
            "samples": output + 1,
            "motion": True,
            "last": _IMPACTS * output if self.show == "impacts" else 0,
            "point": self.point,
        }
        if self.direction == "fresh":
            return ImpactWork(self.case, self.grid, **options)
        both = self.direction == "both"
        return ContinuationWork.along(
            self.case, self.grid, ways=("up", "down") if both else (self.direction,), turning=both, **options
        )

    def validate(self) -> None:
        """Raise if the fields do not fit the case or each other; see `Study.validate`."""
        if not self.case.dampers:
            raise CaseError("without a damper the motion is linear, and nothing bifurcates")
        self._values.require_alike()
        _check_order(self.grid, self.direction)
        self.work.validate()

    @property
    def _values(self) -> ImpactWork:
        """The values, packed once, for the evaluation."""
        return ImpactWork(self.case, self.grid, cycles=self.cycles, point=self.point)

    def compute(self) -> xarray.Dataset:
        """Run all values and find the periods; see `Study.compute`."""
        runs = self.run_work(self.work)
        runs = runs.expand_dims(direction=["fresh"]) if self.direction == "fresh" else without_states(runs)
        about = {
            "title": "Bifurcation diagram",
            "case": self.case.to_toml(),
            "cycles": list(self.cycles),
            "tolerance": self.tolerance,
        }
        found = _looked_at(runs.load(), self._values, self.tolerance).assign_attrs(about)
        return keep_map(found, self.kind, self.store)


bifurcation = study_function(Bifurcation)
"""Run a study of this kind: see `Bifurcation`."""


def _check_order(design: Grid, direction: str) -> None:
    """Refuse values that do not rise."""
    path, values = next(iter(design.columns.items()))
    if values.dtype.kind == "f":
        if np.any(np.diff(values) <= 0):
            raise Hint(f"{path}: values must rise from each to the next", "numpy.unique")
    elif direction != "fresh":
        raise Hint(f"{path}: its values are no numbers that rise or fall", 'direction = "fresh"')


def _looked_at(maps: xarray.Dataset, task: ImpactWork, tolerance: float) -> xarray.Dataset:
    """Take the strobes and the impacts of the cycles looked at, and find the periods."""
    over, period = maps.status.dims, np.asarray(task.output.period)
    maps = maps.isel(instant=slice(1, None)).rename(instant="cycle")
    repeats, _ = period_of(reduced_strobes(maps, task.packed, period), tolerance)
    maps["period"] = over, repeats, {"units": "1", "long_name": "cycles after which the motion repeats"}
    if "last_time" in maps:
        load = next(load.signal for load in task.packed.loads if isinstance(load.signal, _core.Harmonic))
        time = maps.last_time.where(maps.last_time >= _column(task.output.start))
        phase = (_column(load.frequency) * time + _column(load.phase)) % (2 * np.pi)
        maps = maps.rename(last="impact", last_approach_speed="approach_speed", last_contact="contact")
        maps["impact_phase"] = (*over, "impact"), phase.values, {"units": "rad", "long_name": "phase of the load"}
        for name in ("approach_speed", "contact"):
            maps[name] = maps[name].where(np.isfinite(maps.impact_phase))
    return maps.drop_vars(["impacts", "last_time"], errors="ignore")


def _column(number: Any) -> Any:
    return np.asarray(number)[..., None] if np.ndim(number) else number
