"""Predicted cost of studies: number of runs, processor time and wall time, from short timed runs."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rattlebox._util.exceptions import RattleboxError
from rattlebox.engines.dem import simulate_dem
from rattlebox.prepare.particles import count_steps, settle_all
from rattlebox.studies.run.backends import cores

if TYPE_CHECKING:
    from rattlebox.model.case import Case

TIMED = 1.0
"""Processor time for which a run is timed [s]."""
TRIAL = 0.03
"""Time of a trial of a design besides its runs [s]."""
SETTLING = 10.0
"""Longest time for which the settling of a bed is timed, except that of the smallest one [s]."""


@dataclass(frozen=True)
class Budget:
    """Predicted cost of a study.

    Attributes
    ----------
    cpu_time
        Processor time [s].
    wall_time
        Wall time on the workers of the study [s].
    """

    trials: int
    runs: int
    cpu_time: float
    wall_time: float
    workers: int

    def __str__(self) -> str:
        return (
            f"{self.trials:,} trials, {self.runs:,} runs: about {duration(self.cpu_time)} of processor time, "
            f"{duration(self.wall_time)} with {self.workers} worker{'s' * (self.workers != 1)}"
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
    """Cost of a run.

    Attributes
    ----------
    settling
        Processor time in which the beds settle [s].
    setup
        Other processor time before the first step and after the last [s].
    stepping
        Processor time of all steps [s].
    """

    particles: int
    steps: int
    settling: float
    setup: float
    stepping: float
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

    Returns
    -------
    times : list of float
        Processor time of all runs of each group [s].

    Notes
    -----
    The runs with the fewest and with the most particles are timed: the settling of their beds, and up to a second of
    their steps, whose latest rate is extrapolated. The time of a step of another run is interpolated over the number of
    particles, and the number of its steps is computed exactly. The prediction is accurate to a factor of about 1.5.
    """
    order = sorted(groups, key=lambda group: group.particles)
    smallest = next((timed for group in order if (timed := _time_run(group, math.inf))), None)
    if smallest is None:
        return [0.0] * len(groups), 1.0
    largest = _time_run(order[-1], SETTLING) if order[-1].particles > smallest.particles else None
    known = [smallest, largest] if largest else [smallest]
    particles = [each.particles for each in known]
    times = []
    for group in groups:
        beyond = max(
            1.0, group.particles / particles[-1]
        )  # if the settling of the largest bed was too long to be timed
        settling, setup, step = (
            float(np.interp(group.particles, particles, costs)) * beyond
            for costs in zip(*((each.settling, each.setup, each.stepping / each.steps) for each in known), strict=True)
        )
        times.append(group.settlings * settling + group.runs * (setup + step * group.steps))
    return times, min(each.share for each in known)


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
    rate = stepping / reached
    if len(done) > 1 and done[-1][1] > (half := min(done, key=lambda each: abs(each[1] - reached / 2)))[1]:
        rate = (done[-1][0] - half[0]) / (done[-1][1] - half[1])
    rest = rate * max(0, group.steps - reached)
    setup = max(0.0, used - settling - stepping)
    return _Timed(group.particles, group.steps, settling, setup, stepping + rest, min(1.0, used / passed))


def workers_of(backend: Any, workers: int | None) -> int:
    """Return the number of workers of a backend; see `make_backend`."""
    if isinstance(backend, str):
        return workers or cores()
    return sum(backend.nthreads().values())
