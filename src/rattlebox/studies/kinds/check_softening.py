"""Compare the measures of a case with those at smaller softening."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rattlebox.model.errors import Hint
from rattlebox.model.particle_damper import ParticleDamper
from rattlebox.studies.kinds.compare_variants import compared

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case


def check_softening(
    case: Case,
    measures: str | Sequence[str] = "impact_loss",
    *,
    softenings: Sequence[float] | None = None,
    packings: int = 4,
    tolerance: float = 0.1,
    skip: Any = 0.0,
    cycles: tuple[int, int] | None = None,
    workers: int | None = None,
    progress: bool | Callable[[int, int], object] = True,
) -> xarray.Dataset:
    """Compare measures of a case at smaller softening, with the statistical error of their change.

    Motions of particles are chaotic, so that one run does not resolve a small change. Each softening runs from several
    random packings; the function compares their means and estimates the error from their scatter.

    Parameters
    ----------
    case
        Case with one or more particle dampers whose packing has a random seed.
    measures
        Names of measures (`rb.MEASURES`), such as "reduced_loss" with a harmonic motion. On a shaker, which supplies all
        energy lost, shares of the energy are not informative.
    softenings
        Values of the softening, of which the last is the reference; default that of the case, a quarter and a sixteenth
        of it, but not below 1.
    packings
        Number of random packings for each softening.
    tolerance
        Accepted relative change.
    skip, cycles, workers, progress
        See `rb.sweep`. With a harmonic motion a few dozen `cycles` are enough.

    Returns
    -------
    xarray.Dataset
        Over `softening`, for each measure: its mean over the packings, `..._error` (standard error of the mean),
        `..._change` from the reference, `..._change_error`, and `..._changed`: whether the change exceeds the tolerance
        and twice its error. If the measure of a packing is NaN, all are NaN and `..._changed` is False.
        Attributes: packings, tolerance, and `exceeded`, the names of the validity limits that runs exceeded.

    Raises
    ------
    CaseError
        If the softening is 1, the packing has no random seed, or an argument is not valid.

    Notes
    -----
    With Hertz contacts a run at softening s has s^0.4 times fewer steps than one at 1. The default study therefore takes
    about (1 + 1.7 + 3) times `packings` times as long as the case.

    With the mean m_s over n packings and their standard deviation s_s, the standard error is e_s = s_s / sqrt(n), the change
    m_s - m_r from the reference r, and its error sqrt(e_s^2 + e_r^2).

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
    >>> result = rb.check_softening(case, "reduced_loss", softenings=(1000, 100), packings=2, cycles=(3, 5), progress=False)
    >>> sorted(result)[:2]
    ['reduced_loss', 'reduced_loss_change']
    """

    def variants(case: Case, _: Mapping[str, Any]) -> dict[float, Case]:
        largest = max(damper.softening_factor for damper in case.particle_dampers)
        return {value: _softened(case, value, largest) for value in _values(largest, softenings)}

    options = {"skip": skip, "cycles": cycles, "workers": workers, "progress": progress}
    return compared(case, ("softening", "1", "softening"), variants, measures, packings, tolerance, options)


def _softened(case: Case, value: float, largest: float) -> Case:
    """Return the case with a value of its largest softening; others keep their ratio to it, but are at least 1."""
    dampers = [
        damper.model_copy(update={"softening": max(1.0, damper.softening_factor * value / largest)})
        if isinstance(damper, ParticleDamper)
        else damper
        for damper in case.dampers
    ]
    return case.model_copy(update={"dampers": tuple(dampers)})


def _values(largest: float, softenings: Sequence[float] | None) -> list[float]:
    """Return the softenings to compare, the largest first."""
    if softenings is None:
        if largest == 1:
            raise Hint("the softening is 1, so that no contact is softened", "softenings = (10, 1)", ["softening"])
        return list(dict.fromkeys(max(1.0, largest / part) for part in (1, 4, 16)))
    values = [float(value) for value in softenings]
    if len(set(values)) < 2 or not all(1 <= value <= 1e6 for value in values):
        raise Hint("two softenings or more are needed, each from 1 to 1e6", "softenings = (100, 10, 1)", ["softenings"])
    return values
