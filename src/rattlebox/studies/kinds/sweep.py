"""Sweeps: measures of a case over a grid of parameters."""

from __future__ import annotations

from dataclasses import KW_ONLY
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field
from pydantic.dataclasses import dataclass

from rattlebox.model.errors import Hint
from rattlebox.model.units import Whole
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.run.store import add_attributes
from rattlebox.studies.run.study import (
    CONFIG,
    Axes,
    Cycles,
    Measures,
    Samples,
    Seconds,
    Study,
    study_function,
)
from rattlebox.studies.work.measures import MEASURES, interval_warning
from rattlebox.studies.work.work_of_case import first_refused, work_of_case

if TYPE_CHECKING:
    import xarray

    from rattlebox.studies.work.impact_work import ImpactWork
    from rattlebox.studies.work.particle_work import ParticleWork


@dataclass(frozen=True, config=CONFIG)
class Sweep(Study):
    """Run a case for every combination of values along some axes.

    Parameters
    ----------
    case
        Case with the values that do not vary. Its output is used for particle dampers only. Particle variants run as with
        `rb.simulate`, one per thread.
    axes
        Values by path, {"damper.gap": rb.linspace("0.1 mm", "2 mm", 200), "load.amplitude": ["1 kN", "5 kN"]}, which form
        a grid; a tuple of paths as key for parameters that vary together; `rb.random_design` or `rb.replicas`.
    measure
        Names of measures (`rb.MEASURES`) and functions of a Run. For a function, each variant runs as with `rb.simulate`.
        Measures of single impacts do not exist for particle dampers.
    skip
        Time from which measures are evaluated [s].
    cycles
        Numbers of cycles of the harmonic load to skip and to evaluate, in place of `skip` and the duration of the case.
    samples
        Number of equally spaced samples of the evaluated motion, both ends included. Default: 64 per cycle with `cycles`;
        else those of the case's output for particle dampers, and 2001 for impact dampers, or 20 per cycle if that is more
        and a measure of the first harmonic is requested. For particle dampers with `cycles` the number per cycle is
        rounded up.
    point
        Observed point of the structure, "storey 2 - storey 1" for a drift, or "mode 2"; default that of the first damper.
    motion
        Whether to return the samples of the motion of each variant; impact dampers only.
    last
        Number of impacts to return from the end of each variant; impact dampers only.
    workers, backend, store, progress
        Execution and storage; see `rattlebox.studies.run.study.Study`.

    Returns
    -------
    xarray.Dataset
        Over the axes: `status` and each measure with its unit; NaN for runs that did not finish or have the status
        "energy_error" (except `energy_residual`). Averages over a motion that is driven to the end have a companion such as
        `rms_interval`, half of the width of their 95 % interval (see `rattlebox.analysis.mean_interval`); if the window is
        too short it is NaN, and `attrs["too_short"]` names the measures. With particle dampers also `warnings`, the exceeded
        validity limits of each run (`flag_meanings`); variants that cannot run, because particles do not fit or settle or
        the time step is too long, have the status "refused", and `attrs["refused"]` is the reason for the first of them.

    Raises
    ------
    CaseError
        If an argument is not valid for the case (raised before anything runs), or a function does not return a number.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.reference_case(duration=1.0)
    >>> maps = rb.sweep(case, {"damper.gap": rb.linspace("0.2 mm", "1 mm", 5)}, ["impacts", "impact_share"])
    >>> maps.impacts.dims
    ('damper.gap',)
    """

    kind: ClassVar[str] = "sweep"

    axes: Axes
    measure: Measures = ("impact_share",)
    _: KW_ONLY
    skip: Seconds = 0.0
    cycles: Cycles | None = None
    samples: Samples | None = None
    point: str | None = None
    motion: bool = False
    last: Annotated[Whole, Field(ge=0)] = 0

    @cached_property
    def work(self) -> ImpactWork | ParticleWork:
        """Runs of all variants."""
        options: dict[str, Any] = {
            "measures": list(self.measure),  # type: ignore[arg-type]
            "skip": float(self.skip),
            "cycles": self.cycles,
            "samples": self.samples,
            "point": self.point,
            "intervals": True,
        }
        grid = read_axes(self.case, self.axes)
        if not self.case.particle_dampers:
            options |= {"motion": self.motion, "last": self.last}
        return work_of_case(self.case, grid, **options)

    def validate(self) -> None:
        """Raise if the fields are not valid; see `Study.validate`."""
        if not (self.measure or self.motion or self.last):
            raise Hint("no measure is given", ", ".join(MEASURES))
        if self.case.particle_dampers and (self.motion or self.last):
            raise Hint("motion and last are for impact dampers only", "a function of a Run as measure")
        self.work.validate()

    def compute(self) -> xarray.Dataset:
        """Run the variants; see `Study.compute`."""
        result = self.run_work(self.work)
        added = result_notes(self.work, result)
        if self.store is not None:
            add_attributes(self.store, added)
        return result.assign_attrs(added)


sweep = study_function(Sweep)


def result_notes(work: ImpactWork | ParticleWork, result: xarray.Dataset) -> dict[str, str]:
    """Return the attributes `too_short` (measures without an interval) and `refused` (the first one), if needed."""
    refused = first_refused(work, result)
    return interval_warning(result, work.case) | ({"refused": refused} if refused else {})
