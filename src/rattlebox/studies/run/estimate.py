"""Predicted processor time of studies, from a few short runs before the start."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.special import stdtrit

from rattlebox._util.exceptions import RattleboxError
from rattlebox.engines.dem import simulate_dem
from rattlebox.prepare.particles import count_steps, settle_all
from rattlebox.prepare.settle import bed_key
from rattlebox.studies.run.backends import workers_of
from rattlebox.studies.work.work import Block, Blocks, Work

if TYPE_CHECKING:
    from rattlebox.model.case import Case

_PROBES = 8
"""Number of blocks of variants that are timed."""
_PROBE_TIME = 0.1
"""Processor time of such a block, about [s]."""
_WHOLE_TIME = 5.0
"""Longest predicted processor time of two particle runs that are timed as a whole [s]."""
_SAMPLED = 32
"""Number of variants from which the cost of all particle runs is predicted."""
_LEAST_FACTOR = 1.3
"""Smallest factor within which a processor time is expected; the clock of a shared machine scatters as much."""

TIMED = 1.0
"""Processor time for which a run is timed [s]."""
TRIAL = 0.03
"""Time of a trial of a design besides its runs [s]."""
START = 0.07
"""Time of a design before its first and after its last trial [s]."""
SEARCH = 0.003
"""Time in which the search chooses and stores a trial [s]."""
SETTLING = 10.0
"""Longest time for which the settling of a bed is timed, except that of the smallest one [s]."""


@dataclass(frozen=True)
class Estimate:
    """Predicted cost of a study.

    Parameters
    ----------
    trials
        Number of trials of a design; 0 for other studies.
    runs
        Number of runs.
    cpu_time
        Processor time of all runs [s].
    wall_time
        Wall time on the workers of the study [s].
    workers
        Number of workers.
    factor
        Factor within which the processor time is expected.
    unit
        Word for a run: "run", or "point" of a branch.
    least
        Processor time if all trials of a design end as early as they can [s]; default none.
    """

    trials: int
    runs: int
    cpu_time: float
    wall_time: float
    workers: int
    factor: float = 1.5
    unit: str = "run"
    least: float | None = None

    def __str__(self) -> str:
        trials = f"{self.trials:,} trials, " if self.trials else ""
        early = ""
        if self.least is not None and self.least < self.cpu_time:
            early = f"; {duration(self.least)} of processor time if trials end as early as they can"
        return (
            f"{trials}{self.runs:,} {self.unit}{'s' * (self.runs != 1)}: about {duration(self.cpu_time)} of processor time "
            f"(within a factor of {self.factor:.1f}), {duration(self.wall_time)} with {self.workers} "
            f"worker{'s' * (self.workers != 1)}{early}"
        )


class RunGroup(NamedTuple):
    """Runs that cost about as much as each other."""

    case: Case
    runs: float
    settlings: float
    particles: int
    steps: int

    @classmethod
    def of(cls, case: Case, runs: float, settlings: float) -> RunGroup | None:
        """Return a group; None if the case cannot run."""
        particles = sum(int(damper.contents.radius.size) for damper in case.particle_dampers)
        try:
            return cls(case, runs, min(runs, settlings), particles, count_steps(case))
        except RattleboxError:  # such a run has the status "refused"
            return None


class _Timed(NamedTuple):
    """Cost of a run."""

    particles: int
    steps: int
    settling: float  # Processor time in which the beds settle [s]
    setup: float  # Other processor time before the first step and after the last [s]
    stepping: float  # Processor time of all steps [s]
    share: float


def duration(seconds: float) -> str:
    """Return a time with a unit from seconds to hours, with two digits."""
    for unit, size in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 1.95 * size:
            return f"{_two_digits(seconds / size)} {unit}"
    return f"{_two_digits(seconds)} s"


def _two_digits(value: float) -> str:
    return f"{value:,.0f}" if value >= 9.5 else f"{value:.2g}"


def time_of_particle_runs(groups: Sequence[RunGroup]) -> tuple[list[float], float]:
    """Predict the processor time of groups of particle runs.

    Returns processor time of all runs of each group [s].

    Notes
    -----
    The runs with the fewest and with the most particles are timed: the settling of their beds, and up to a second of
    their steps, whose latest rate is extrapolated. The time of a step of another run is interpolated over the number of
    particles, and the number of its steps is computed exactly. The prediction is accurate to a factor of about 1.5.
    """
    settling, running, share = _costs(groups)
    return [bed + run for bed, run in zip(settling, running, strict=True)], share


def _costs(groups: Sequence[RunGroup]) -> tuple[list[float], list[float], float]:
    """Return the processor time of the beds and of the runs of each group [s], and its share of the wall time."""
    # Two timed runs suffice: the time of a step depends on the number of particles, the number of steps is known.
    order = sorted(groups, key=lambda group: group.particles)
    smallest = next((timed for group in order if (timed := _time_run(group, math.inf))), None)
    if smallest is None:
        return [0.0] * len(groups), [0.0] * len(groups), 1.0
    largest = _time_run(order[-1], SETTLING) if order[-1].particles > smallest.particles else None
    known = [smallest, largest] if largest else [smallest]
    particles = [each.particles for each in known]
    beds, runs = [], []
    for group in groups:
        beyond = max(
            1.0, group.particles / particles[-1]
        )  # if the settling of the largest bed was too long to be timed
        settling, setup, step = (
            float(np.interp(group.particles, particles, costs)) * beyond
            for costs in zip(*((each.settling, each.setup, each.stepping / each.steps) for each in known), strict=True)
        )
        beds.append(group.settlings * settling)
        runs.append(group.runs * (setup + step * group.steps))
    return beds, runs, min(each.share for each in known)


def _time_run(group: RunGroup, limit: float) -> _Timed | None:
    """Return the cost of a run of a group; None if its bed does not settle, or not within a limit [s]."""
    begun = time.monotonic()
    before = time.process_time()
    try:
        if not settle_all(group.case, lambda: time.monotonic() < begun + limit):
            return None
    except RattleboxError:
        return None
    settling = time.process_time() - before
    done: list[tuple[float, int]] = []  # processor time and number of steps

    def proceed(steps: int, total: int) -> bool:
        done.append((time.process_time(), steps))
        return done[-1][0] < done[0][0] + TIMED

    run = simulate_dem(group.case, threads=1, progress=proceed)
    used, passed = time.process_time() - before, time.monotonic() - begun
    reached = max(1, int(run.counts["steps"]))
    stepping = min(used - settling, run.wall_time)
    # The first steps of a bed are faster or slower than the later ones: extrapolate the second half.
    rate = stepping / reached
    if len(done) > 1 and done[-1][1] > (half := min(done, key=lambda each: abs(each[1] - reached / 2)))[1]:
        rate = (done[-1][0] - half[0]) / (done[-1][1] - half[1])
    rest = rate * max(0, group.steps - reached)
    setup = max(0.0, used - settling - stepping)
    return _Timed(group.particles, group.steps, settling, setup, stepping + rest, min(1.0, used / passed))


def estimate_works(works: Sequence[Work], *, backend: Any, workers: int | None) -> Estimate:
    """Predict the cost of all variants of works, stored ones included, from a few short runs."""
    parts = [_processor_time(work) for work in works]
    sizes = [work.size for work in works]
    cpu_time, count = sum(part.seconds for part in parts), workers_of(backend, workers)
    factor = max((part.factor for part in parts), default=1.0)
    share = min((part.share for part in parts), default=1.0)
    # Chains do not run in parallel with themselves.
    chains = sum(_parallel(work) for work in works)
    wall_time = cpu_time / share / max(1, min(count, chains))
    return Estimate(0, sum(sizes), cpu_time, wall_time, count, factor)


def _parallel(work: Work) -> int:
    """Return the number of chains of a work, which run in parallel."""
    size = work.grid.shape[-1] if work.order.is_chain else work.engine.block
    return len(work.order.chains(Blocks.of(work.grid.shape, size)))


class _Prediction(NamedTuple):
    """Predicted processor time."""

    seconds: float
    factor: float
    share: float  # Processor time over wall time of the timed runs


def _processor_time(work: Work) -> _Prediction:
    """Predict the processor time of all variants of a work."""
    numbers = np.unique(np.linspace(0, work.size - 1, _SAMPLED).astype(int)).tolist()
    cases = [case for number in numbers if (case := work.engine.timed_case(number)) is not None]
    if not cases:
        return _time_of_blocks(work)
    keys = {bed_key(damper) for case in cases for damper in case.particle_dampers}
    dampers, per_sample = sum(len(case.particle_dampers) for case in cases), work.size / len(numbers)
    # Each bed settles once: beds that all differ in the sample are taken to differ in all variants.
    each = len(keys) / len(cases) * (per_sample if len(keys) == dampers else 1.0)
    groups = [group for case in cases if (group := RunGroup.of(case, per_sample, each / len(case.particle_dampers)))]
    beds, runs, share = _costs(groups) if groups else ([], [], 1.0)
    # Whole runs show how long they continue until their motion is steady, and what measures cost.
    if len(groups) == len(numbers) and 0 < runs[0] + runs[-1] < _WHOLE_TIME * per_sample:
        seconds = 0.0
        for number, case in ((numbers[0], cases[0]), (numbers[-1], cases[-1])):
            settle_all(case, lambda: True)
            seconds += _timed_block(work, number, number + 1)[0]
        return _Prediction(sum(beds) + sum(runs) * seconds * per_sample / (runs[0] + runs[-1]), 1.5, share)
    # Otherwise the middle between none and all continuations.
    longer = math.sqrt(work.engine.longest)
    return _Prediction(sum(beds) + sum(runs) * longer, 1.5 * longer, share)


def _time_of_blocks(work: Work) -> _Prediction:
    """Predict the processor time from a few blocks, of which the first variant determines the size."""
    _timed_block(work, 0, 1)  # what is computed once, such as the input of the core, is not a cost of each variant
    first, _ = _timed_block(work, 0, 1)
    row = work.grid.shape[-1] if work.order.is_chain else work.size
    size = max(1, min(work.engine.block, row, int(_PROBE_TIME / max(first, 1e-6))))
    starts = np.unique(np.linspace(0, work.size - size, _PROBES).astype(int)).tolist()
    timed = [_timed_block(work, start, start + size) for start in starts]
    each = np.array([seconds / size for seconds, _ in timed])
    factor = _LEAST_FACTOR
    if each.size > 1 and size * each.size < work.size:
        half = float(stdtrit(each.size - 1, 0.975)) * each.std(ddof=1) / math.sqrt(each.size)
        factor = max(factor, 1 + half / each.mean())
    return _Prediction(each.mean() * work.size, factor, min(1.0, *(share for _, share in timed)))


def _timed_block(work: Work, start: int, stop: int) -> tuple[float, float]:
    """Return the processor time of some variants [s], and its share of the wall time."""
    before, begun = time.process_time(), time.monotonic()
    work.run(Block(0, start, stop), None, threads=1, cancelled=None)
    used = time.process_time() - before
    return used, min(1.0, used / max(time.monotonic() - begun, 1e-9)) if used > 0.01 else 1.0
