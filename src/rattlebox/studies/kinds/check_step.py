"""Compare the measures of a case with those at half of its time step."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.model.errors import Hint
from rattlebox.model.units import whole_number
from rattlebox.prepare.particles import count_steps
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.kinds.compare_variants import compared
from rattlebox.studies.work.particle_work import ParticleWork

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case


def check_step(
    case: Case,
    measures: str | Sequence[str] = "impact_loss",
    *,
    parts: Sequence[int] = (1, 2),
    packings: int = 4,
    tolerance: float = 0.1,
    skip: Any = 0.0,
    cycles: tuple[int, int] | None = None,
    workers: int | None = None,
    progress: bool | Callable[[int, int], object] = True,
) -> xarray.Dataset:
    """Compare measures of a case at half of its time step, with the statistical error of their change.

    The step that a run takes is halved, whichever limit sets it: a contact, a wave along a particle, a mode, a load or the
    samples. A smaller `rb.Dem(fraction=...)` changes only the first and the last but one of them.

    Parameters
    ----------
    case
        Case with one or more particle dampers whose packing has a random seed.
    measures
        Names of measures (`rb.MEASURES`), such as "reduced_loss" with a harmonic motion.
    parts
        Whole numbers by which the step of the case is divided, ascending; the last is the reference.
    packings
        Number of random packings for each step.
    tolerance
        Accepted relative change.
    skip, cycles, workers, progress
        See `rb.sweep`. With a harmonic motion a few dozen `cycles` are enough.

    Returns
    -------
    xarray.Dataset
        Over `step` [s], for each measure: its mean over the packings, `..._error` (standard error of the mean),
        `..._change` from the reference, `..._change_error`, `..._changed`: whether the change exceeds the tolerance and
        twice its error, and `..._kept`: whether the change plus twice its error is within the tolerance. If both are False,
        more packings or cycles are needed. If the measure of a packing is NaN, all are NaN and both are False.
        Attributes: packings, tolerance, and `exceeded`, the names of the validity limits that runs exceeded.

    Raises
    ------
    CaseError
        If the packing has no random seed, the parts do not ascend, or an argument is not valid.

    Notes
    -----
    A run at a step h / k takes k times as long as one at h: the default check takes three times `packings` times as long as
    the case. Errors of a step fall with its square (`rb.Dem`), so that the change from half of it is about three quarters of
    the error. The statistics are those of `rb.check_softening`.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.Case(
    ...     structure=rb.Shaker(motion=rb.Harmonic(amplitude="30 m/s^2", frequency="80 Hz", direction="z")),
    ...     damper=rb.ParticleDamper(
    ...         particles=rb.Particles(material="steel", diameter="5 mm", count=20),
    ...         cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
    ...         contact=rb.Tsuji(restitution=0.8),
    ...         direction="z",
    ...         packing=rb.Settled(seed=1),
    ...         softening=1000,
    ...     ),
    ...     duration="0.5 s",
    ... )
    >>> result = rb.check_step(case, "reduced_loss", packings=2, cycles=(3, 5), progress=False)
    >>> float((result.step[0] / result.step[1]).round(12))
    2.0
    """
    divisors = [whole_number(part, f"parts[{index}]", 1) for index, part in enumerate(parts)]
    if len(divisors) < 2 or np.any(np.diff(divisors) <= 0):
        raise Hint("two parts or more are needed, ascending", "parts = (1, 2)", ["parts"])

    def variants(case: Case, seeds: Mapping[str, Any]) -> dict[float, Case]:
        # The duration of a run over cycles, and with it the step that fits into it, is known to the work of a study only.
        prepared = ParticleWork(case, read_axes(case, seeds, source="packings"), cycles=cycles).variant(0)
        step = prepared.duration / count_steps(prepared)
        return {step / part: _with_step(case, step / part) for part in divisors}

    options = {"skip": skip, "cycles": cycles, "workers": workers, "progress": progress}
    return compared(case, ("step", "s", "time step"), variants, measures, packings, tolerance, options)


def _with_step(case: Case, step: float) -> Case:
    return case.model_copy(update={"method": case.method.model_copy(update={"dt": step})})
