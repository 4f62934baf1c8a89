"""Work for the variants of a case, by the kind of its dampers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.core._core import Status
from rattlebox.studies.work.impact_work import ImpactWork
from rattlebox.studies.work.particle_work import ParticleWork

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case
    from rattlebox.studies.grid.grid import Grid


def work_of_case(case: Case, grid: Grid, **options: Any) -> ImpactWork | ParticleWork:
    """Return the work for the variants of a case."""
    return ParticleWork(case, grid, **options) if case.particle_dampers else ImpactWork(case, grid, **options)


def first_refused(work: ImpactWork | ParticleWork, result: xarray.Dataset) -> str:
    """Return the values of the first refused variant and the reason; "" if none is refused."""
    refused = np.flatnonzero(result.status.values == Status.refused)
    if isinstance(work, ImpactWork) or not refused.size or not (why := work.refusal_reason(int(refused[0]))):
        return ""
    reason = why.replace("\n", "\n  ")
    return f"{work.grid.describe_variant(work.case, int(refused[0]))}\n  {reason}"
