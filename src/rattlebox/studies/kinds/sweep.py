"""Variants of a case over axes, and measures of each."""

from __future__ import annotations

from dataclasses import KW_ONLY
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from rattlebox.core._core import Status
from rattlebox.model.errors import Hint
from rattlebox.model.units import Whole
from rattlebox.studies.axes import read_axes
from rattlebox.studies.impact_work import ImpactWork
from rattlebox.studies.measures import MEASURES, interval_warning
from rattlebox.studies.particle_work import ParticleWork
from rattlebox.studies.store import add_attributes
from rattlebox.studies.study import (
    CONFIG,
    Axes,
    Cycles,
    Measures,
    Samples,
    Seconds,
    Study,
    study_function,
)

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True, config=CONFIG)
class Sweep(Study):
    """Run a case for every combination of values along some axes.

    Parameters
    ----------
    case
        The case, with the values that do not vary. Its output is not used, but for particles in space: they are run as by
        `rb.simulate`, as many variants at once as there are threads.
    axes
        Values by path, {"damper.gap": rb.linspace("0.1 mm", "2 mm", 200), "load.amplitude": ["1 kN", "5 kN"]}: a grid;
        a tuple of paths as a key links them; or `rb.random_design`, `rb.replicas`.
    measure
        Names of measures (rb.MEASURES), computed in the core without keeping trajectories, and functions of a Run,
        for which each variant is run as by `rb.simulate`. Of particles in space those that look at single impacts are not
        known.
    skip
        Time before what is looked at, with a unit or in seconds: measures leave it out.
    cycles
        Instead of the case's duration and `skip`, with a harmonic load: how many cycles to skip and to look at.
    samples
        Equally spaced samples of the motion, both ends included, for measures that need them and for `motion`;
        default 2001, or 20 a cycle where that is more and the first harmonic is asked for (of particles in space those of
        the case's output), or 64 a cycle with `cycles` (there rounded up to a whole number a cycle).
    point
        Of the structure, that is watched; default the first damper's.
    motion
        Keep the samples of each variant.
    last
        Keep the last so many impacts of each variant.
    workers, backend, store, progress
        Where the study runs, and where its results are stored; see `rattlebox.studies.study.Study`.

    Returns
    -------
    xarray.Dataset
        Over the axes: `status` and each measure with its unit; NaN where a run did not finish, or ended
        with the status "energy_error" (except `energy_residual`). A variant with particles in
        space whose particles do not fit or settle, or whose step is too long, has the status "refused"; `attrs["refused"]`
        says why the first of them was. Averages over a motion that is driven to the end have a companion such as
        `rms_interval`, half of their 95 % interval; NaN if the window is too short, and then `attrs["too_short"]` names the
        measures. There `warnings` tells of each run in what it left its bounds (`flag_meanings`).

    Raises
    ------
    CaseError
        When an argument does not fit, alone or to the case, before anything runs; when a function of a Run gives no number.

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
    def work(self) -> ImpactWork:
        """Runs of all variants."""
        kind = ParticleWork if self.case.particle_dampers else ImpactWork
        return kind(
            self.case,
            read_axes(self.case, self.axes),
            measures=list(self.measure),  # type: ignore[arg-type]
            skip=float(self.skip),
            cycles=self.cycles,
            samples=self.samples,
            point=self.point,
            motion=self.motion,
            last=self.last,
            intervals=True,
        )

    def validate(self) -> None:
        """Raise if the fields do not fit the case or each other; see `Study.validate`."""
        if not (self.measure or self.motion or self.last):
            raise Hint("there is no measure", ", ".join(MEASURES))
        self.work.validate()

    def compute(self) -> xarray.Dataset:
        """Run the variants; see `Study.compute`."""
        result = self.run_work(self.work)
        added = interval_warning(result)
        if isinstance(self.work, ParticleWork):
            added |= _first_refused(self.work, result)
        if self.store is not None:
            add_attributes(self.store, added)
        return result.assign_attrs(added)


sweep = study_function(Sweep)
"""Run a study of this kind: see `Sweep`."""


def _first_refused(work: ParticleWork, result: xarray.Dataset) -> dict[str, str]:
    """Return the first variant that could not run, and the reason, as an attribute."""
    refused = np.flatnonzero(result.status.values == Status.refused)
    if not refused.size or not (why := work.why_refused(int(refused[0]))):
        return {}
    reason = why.replace("\n", "\n  ")
    return {"refused": f"{work.grid.told(work.case, int(refused[0]))}\n  {reason}"}
