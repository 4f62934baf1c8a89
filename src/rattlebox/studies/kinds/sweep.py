"""Variants of a case over axes, and measures of each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.engines.status import REFUSED
from rattlebox.model.errors import Hint, nearest
from rattlebox.studies.axes import read_axes
from rattlebox.studies.impact_work import ImpactWork
from rattlebox.studies.measures import MEASURES, check_names
from rattlebox.studies.particle_work import ParticleWork
from rattlebox.studies.runner import run_work
from rattlebox.studies.store import add_attributes
from rattlebox.studies.studytables import checked

if TYPE_CHECKING:
    import os

    import xarray

    from rattlebox.model.case import Case
    from rattlebox.results import Run


def sweep(
    case: Case,
    axes: Any,
    measure: Sequence[str | Callable[[Run], float]] = ("impact_share",),
    *,
    skip: float | str = 0.0,
    cycles: tuple[int, int] | None = None,
    samples: int | None = None,
    point: str | None = None,
    motion: bool = False,
    last: int = 0,
    workers: int | None = None,
    backend: Any = "threads",
    store: str | os.PathLike[str] | None = None,
    progress: bool | Callable[[int, int], object] | None = None,
) -> xarray.Dataset:
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
    workers
        Number of threads or processes; default as many as there are cores. Results do not depend on it, to the last bit.
    backend
        "threads" of this process; "processes", for measures in Python, which run one at a time in threads; or the client of
        a Dask cluster (`dask.distributed.Client`).
    store
        Folder of a Zarr store for results: what is finished is on disk, and the same call goes on after a stop.
    progress
        True or False for a bar, or a function of the numbers done and in all; default a bar on a terminal.

    Returns
    -------
    xarray.Dataset
        Over the axes: `status` and each measure with its unit; NaN where a run did not finish, or ended
        with the status "energy_error" (but `closure`). A variant with particles in
        space whose particles do not fit or settle, or whose step is too long, has the status "refused"; `attrs["refused"]`
        says why the first of them was. There `warnings` tells of each run in what it left its bounds (`flag_meanings`).

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
    given = checked("sweep", skip=skip, cycles=cycles, samples=samples, last=last, workers=workers)
    workers = given.pop("workers")
    measures = known(measure)
    if not (measures or motion or given["last"]):
        raise Hint("there is no measure", ", ".join(MEASURES))
    design = read_axes(case, axes)
    kind = ParticleWork if case.particle_dampers else ImpactWork
    task = kind(
        case,
        design,
        measures=measures,
        point=point,
        motion=motion,
        **given,
    )
    task.validate()
    found = run_work(task, store=store, backend=backend, workers=workers, progress=progress)
    if not isinstance(task, ParticleWork):
        return found
    refused = _refused(task, found)
    if store is not None:
        add_attributes(store, refused)
    return found.assign_attrs(refused)


def _refused(task: ParticleWork, found: xarray.Dataset) -> dict[str, str]:
    """Tell of the first variant that cannot be run why."""
    refused = np.flatnonzero(found.status.values == REFUSED)
    if not refused.size or not (why := task.why_refused(int(refused[0]))):
        return {}
    said = why.replace("\n", "\n  ")
    return {"refused": f"{task.grid.told(task.case, int(refused[0]))}\n  {said}"}


def beside(needed: Sequence[str], measure: str | Sequence[str]) -> list[str]:
    """Return the measures that a map needs, and those that it is asked for besides.

    Parameters
    ----------
    needed
        Names.
    measure
        One name or several.
    """
    return [*needed, *(name for name in _several(measure) if name not in needed)]


def _several(measure: Any) -> list[Any]:
    return list(measure) if hasattr(measure, "__iter__") and not isinstance(measure, str) else [measure]


def known(measure: Any) -> list[Any]:
    """Return measures as a list.

    Parameters
    ----------
    measure
        One or several: names, functions of a Run.

    Raises
    ------
    CaseError
        When there is no such measure, with the nearest name, or two have one name.
    """
    asked = _several(measure)
    check_names(asked)
    for name in asked:
        if isinstance(name, str) and name not in MEASURES:
            raise Hint(f"there is no measure {name!r}", nearest(name, MEASURES))
        if not isinstance(name, str) and not callable(name):
            raise Hint(f"{name!r} is neither the name of a measure nor a function of a Run", '"impact_share"')
    return asked
