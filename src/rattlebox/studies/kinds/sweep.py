"""Sweeps: measures of a case over a grid of parameters; and comparisons of cases, or of a case with finer numerics."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import KW_ONLY
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from rattlebox._util.flags import has_flag
from rattlebox.engines.simulate import simulate_many
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint
from rattlebox.model.units import Whole, whole_number
from rattlebox.prepare.particles import count_steps, resolve_softening
from rattlebox.prepare.time_step import WARNINGS
from rattlebox.results.run import Run
from rattlebox.results.summary import Comparison
from rattlebox.studies.grid.axes import packing_axis, read_axes
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
from rattlebox.studies.work.particles import ParticleEngine, engine_of
from rattlebox.studies.work.variants import Variants
from rattlebox.studies.work.work import Work

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case


@dataclass(frozen=True, config=CONFIG)
class Sweep(Study):
    """Run a case for every combination of values along some axes.

    Parameters
    ----------
    case
        Case with the values that do not vary. Its output is used for particle dampers and for functions of a Run. Particle
        variants run as with `rb.simulate`, one per thread.
    axes
        Values by path, {"damper.gap": rb.linspace("0.1 mm", "2 mm", 200), "load.amplitude": ["1 kN", "5 kN"]}, which form
        a grid; a tuple of paths as key for parameters that vary together; `rb.random_design` or `rb.replicas`. The values of
        "start" are runs, files of runs, or pairs of one of these and a time, from which variants continue as with
        `rb.simulate(case, start=...)`.
    measure
        Names of measures (`rb.MEASURES`) and functions of a Run. A function gets the run of which the named measures are
        evaluated, with its transient; each variant runs once. Measures of single impacts do not exist for particle dampers.
    skip
        Time from which measures are evaluated [s]; default the start of the run.
    cycles
        Numbers of cycles of the harmonic load to skip and to evaluate, in place of `skip` and the duration of the case. With
        an axis of starts they count from each start, but `skip` and the duration from the start of the first run.
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
    def work(self) -> Work:
        """Runs of all variants."""
        variants = Variants(
            self.case,
            read_axes(self.case, self.axes, allow_starts=True),
            list(self.measure),  # type: ignore[arg-type]
            skip=float(self.skip),
            cycles=self.cycles,
            samples=self.samples,
            point=self.point,
            intervals=True,
        )
        options: dict[str, Any] = {} if self.case.particle_dampers else {"motion": self.motion, "last": self.last}
        return Work(engine_of(variants, **options))

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


def result_notes(work: Work, result: xarray.Dataset) -> dict[str, str]:
    """Return the attributes `too_short` (measures without an interval) and `refused` (the first one), if needed."""
    refused = work.first_refused(result.status.values)
    return interval_warning(result, work.engine.case) | ({"refused": refused} if refused else {})


# ---- comparisons


def compare(
    cases: Mapping[str, Case | Run],
    *,
    point: str | None = None,
    of: Literal["displacement", "acceleration", "drift", "force"] = "displacement",
    threads: int | None = None,
    progress: bool | Callable[[int, int], object] = True,
) -> Comparison:
    """Simulate several cases and compare their results in one table.

    Parameters
    ----------
    cases
        Cases, or runs of them, by the name of their column, such as "bare", "tuned mass" and "particles". The first one is
        the reference.
    point
        Point that is compared in the sentences and figures of the report, with all its lines in the table; by default the
        point of the structure with the largest displacement in the first case.
    of
        Quantity that the sentences of the report compare: the displacement or absolute acceleration of the point, the
        largest drift of all storeys, or the force on the base.
    threads
        Number of threads; default all cores.
    progress
        See `rb.simulate_many`.

    Returns
    -------
    Comparison
        Table with `values` in SI units, including the reduction of peak and RMS values against the first case, and with
        `runs`, which `rb.plot_comparison` draws.

    Raises
    ------
    CaseError
        If `cases` is not a mapping of names to cases and runs, or is empty, or a case lacks the point or the quantity.

    Examples
    --------
    >>> import rattlebox as rb
    >>> structure = rb.SDOF(mass="20 kg", stiffness="80 kN/m", damping_ratio=0.01)
    >>> common = {"structure": structure, "load": rb.HalfSine(amplitude="5 kN", duration="1 ms"), "duration": "3 s"}
    >>> result = rb.compare(
    ...     {
    ...         "bare": rb.Case(**common),
    ...         "tuned mass": rb.Case(**common, tuned_mass=rb.TunedMass.den_hartog(structure, mass="1 kg")),
    ...     }
    ... )
    >>> result.values["tuned mass"]["rms_reduction[mass]"] > 0.5
    True
    """
    if not isinstance(cases, Mapping) or not cases:
        raise Hint("cases is not a mapping of names to cases, or is empty", 'compare({"bare": case, "damped": other})')
    for name, each in cases.items():
        if not isinstance(each, (Case, Run)):
            raise Hint(f"{name!r} is {each!r:.60}, but a Case or a Run is needed", "rb.Case(...)")
    new = [each for each in cases.values() if isinstance(each, Case)]
    simulated = iter(simulate_many(new, threads=threads, progress=progress))
    runs: dict[str, Any] = {
        str(name): next(simulated) if isinstance(each, Case) else each for name, each in cases.items()
    }
    return Comparison(runs, point=point, of=of)


# ---- variants over random packings


def compared(
    case: Case,
    coordinate: tuple[str, str, str],
    variants_of: Callable[[Case, Mapping[str, Any]], Mapping[float, Case]],
    measures: str | Sequence[str],
    packings: int,
    tolerance: float,
    options: Mapping[str, Any],
) -> xarray.Dataset:
    """Return the measures of variants by a value, and their changes from the last one.

    The coordinate has name, unit and long name; `variants_of` returns the variants of a case with its axis of packings.
    """
    import xarray

    along, unit, long_name = coordinate
    whole_number(packings, "packings", 2)
    if not case.particle_dampers:
        raise Hint(
            f"the case has no particle damper, and only these have a {long_name}", "a case with rb.ParticleDamper"
        )
    case, _ = resolve_softening(case)
    # The same packings for each value, so that their scatter cancels in part.
    seeds = packing_axis(case, packings)
    variants = variants_of(case, seeds)
    names = [measures] if isinstance(measures, str) else list(measures)
    studies = [sweep(variant, dict(seeds), names, **options) for variant in variants.values()]
    count = math.prod(studies[0].sizes.values())
    data: dict[str, Any] = {}
    for name in names:
        rows = [study[name] for study in studies]
        about = rows[0].attrs
        numbers = np.array([row.values for row in rows])
        mean, error = numbers.mean(axis=1), numbers.std(axis=1, ddof=1) / math.sqrt(count)
        change, change_error = mean - mean[-1], np.hypot(error, error[-1])
        change_error[-1] = 0.0
        data[name] = along, mean, about
        quantity, units = about.get("long_name", name), about.get("units", "1")
        for suffix, part, words in (
            ("error", error, "standard error of the {}"),
            ("change", change, f"change of the {{}} from the last {along}"),
            ("change_error", change_error, "standard error of the change of the {}"),
        ):
            data[f"{name}_{suffix}"] = along, part, {"units": units, "long_name": words.format(quantity)}
        # A change counts beyond its scatter and beyond the tolerance; it is small if it is within this with certainty.
        allowed = tolerance * abs(mean[-1])
        changed = np.abs(change) > np.maximum(2 * change_error, allowed)
        kept = np.abs(change) + 2 * change_error <= allowed
        data[f"{name}_changed"] = along, changed, {"long_name": f"whether the {quantity} changes"}
        data[f"{name}_kept"] = along, kept, {"long_name": f"whether the {quantity} is kept"}
    about_values = (along, list(variants), {"units": unit, "long_name": long_name})
    exceeded = [name for name in WARNINGS if any(has_flag(study.warnings, name).any() for study in studies)]
    attributes = {"packings": count, "tolerance": tolerance, "exceeded": exceeded}
    return xarray.Dataset(data, {along: about_values}, attributes)


# ---- softening


def check_softening(
    case: Case,
    measures: str | Sequence[str] = "impact_loss",
    *,
    softenings: Sequence[float] | None = None,
    packings: int = 4,
    tolerance: float = 0.1,
    skip: object = 0.0,
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

    def variants(case: Case, _: Mapping[str, object]) -> dict[float, Case]:
        largest = max(damper.softening_factor for damper in case.particle_dampers)
        return {value: _softened(case, value, largest) for value in _values(largest, softenings)}

    options = {"skip": skip, "cycles": cycles, "workers": workers, "progress": progress}
    return compared(case, ("softening", "1", "softening"), variants, measures, packings, tolerance, options)


def _softened(case: Case, value: float, largest: float) -> Case:
    """Return the case with a value of its largest softening; others keep their ratio to it, but are at least 1."""
    given: Any = case.dampers  # all of one kind
    dampers = [
        damper.model_copy(update={"softening": max(1.0, damper.softening_factor * value / largest)}) for damper in given
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


# ---- time step


def check_step(
    case: Case,
    measures: str | Sequence[str] = "impact_loss",
    *,
    parts: Sequence[int] = (1, 2),
    packings: int = 4,
    tolerance: float = 0.1,
    skip: object = 0.0,
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
    The case of the example of `rattlebox.check_softening`:

    >>> result = rb.check_step(case, "reduced_loss", packings=2, cycles=(3, 5), progress=False)
    >>> float((result.step[0] / result.step[1]).round(12))
    2.0
    """
    divisors = [whole_number(part, f"parts[{index}]", 1) for index, part in enumerate(parts)]
    if len(divisors) < 2 or np.any(np.diff(divisors) <= 0):
        raise Hint("two parts or more are needed, ascending", "parts = (1, 2)", ["parts"])

    def variants(case: Case, seeds: Mapping[str, object]) -> dict[float, Case]:
        # The duration of a run over cycles, and with it the step that fits into it, is known to the work of a study only.
        runs = Variants(case, read_axes(case, seeds, source="packings"), cycles=cycles)
        prepared = ParticleEngine(runs).variant(0)
        step = prepared.duration / count_steps(prepared)
        return {step / part: _with_step(case, step / part) for part in divisors}

    options = {"skip": skip, "cycles": cycles, "workers": workers, "progress": progress}
    return compared(case, ("step", "s", "time step"), variants, measures, packings, tolerance, options)


def _with_step(case: Case, step: float) -> Case:
    return case.model_copy(update={"method": case.method.model_copy(update={"dt": step})})
