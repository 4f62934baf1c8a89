"""Predicted cost of a design search."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from rattlebox._util.exceptions import CaseError
from rattlebox._util.narrow import instance
from rattlebox.engines.simulate import simulate_many
from rattlebox.model.case import Case
from rattlebox.studies.design.search import DesignSearch, Values
from rattlebox.studies.run.backends import workers_of
from rattlebox.studies.run.estimate import SEARCH, START, TRIAL, Estimate, RunGroup, time_of_particle_runs
from rattlebox.studies.work.particles import ParticleEngine
from rattlebox.studies.work.work import Block

_SAMPLED = 16
"""Number of designs from which the cost of all trials is predicted."""
_TINY = 0.3
"""Predicted time of a trial below which whole trials are timed [s]."""
_WHOLE_TRIALS = 5
"""Number of whole trials that are timed."""


class _Costs(NamedTuple):
    """Runs of a trial."""

    runs: float  # Number of runs
    groups: list[RunGroup]  # Particle runs of some designs
    others: float  # Processor time of the 1-D runs of these designs [s]


def predict(search: DesignSearch, trials: int) -> Estimate:
    """Return the predicted cost of a number of trials: of all packings and cycles, and the least if trials end early."""
    designs = search.sample(_SAMPLED)
    costs = _costs(search, designs)
    times, share = time_of_particle_runs(costs.groups) if costs.groups else ([], 1.0)
    trial, runs = _time_of(search, costs, times, designs), costs.runs
    first = search.stages[0] / search.count
    early = trial * first
    if search.parts:
        early *= search.parts[0].cycles / search.cycles
        if not search.case.particle_dampers:  # the parts start anew
            trial, runs = trial + early, runs * (1 + first)
    cpu_time = START + trials * trial
    # At least one trial is complete, unless it is precise enough before.
    least = START + trials * early + (trial - early if search.precision is None else 0.0)
    workers = workers_of(search.where.get("backend", "threads"), search.where.get("workers"))
    wall_time = cpu_time / share / max(1, min(workers, runs))
    return Estimate(trials, round(trials * runs), cpu_time, wall_time, workers, least=min(least, cpu_time))


def _costs(search: DesignSearch, designs: Sequence[Values]) -> _Costs:
    """Return the runs of a trial, whose time is predicted, from some designs."""
    runs, others = 0, 0.0
    groups: list[RunGroup] = []
    for case in _valid(search, designs):
        curves = search.curve_runs(case)
        sweep = search.grid.size if search.measured else 0
        runs += sweep + len(curves)
        if case.particle_dampers:
            groups += _groups(search, case, sweep, curves)
        elif not others:  # 1-D designs cost about the same
            others = len(designs) * _time_of_impact_runs(search, case, curves)
    return _Costs(runs / max(1, len(designs)), groups, others)


def _time_of(search: DesignSearch, costs: _Costs, times: Sequence[float], designs: Sequence[Values]) -> float:
    """Return the processor time of a trial [s]; `times`: those of the groups of particle runs [s]."""
    each = TRIAL + (sum(times) if costs.groups else costs.others) / max(1, len(designs))
    # In a short trial the work between the runs counts, too.
    return (_time_of_trial(search, designs) or each) if each < _TINY else each


def _time_of_trial(search: DesignSearch, designs: Sequence[Values]) -> float:
    """Return the processor time of a trial [s], from the first packings of a few; 0 if there is no valid design."""
    times = []
    for values in designs:
        before = time.process_time()
        candidate = search.candidate(values)
        if candidate.case is not None:
            search.evaluate(candidate, search.stages[0])
            times.append(time.process_time() - before)
        if len(times) == _WHOLE_TRIALS:
            break
    # The first one also reads modules.
    return SEARCH + search.count / search.stages[0] * float(np.mean(times[1:] or times)) if times else 0.0


def _valid(search: DesignSearch, designs: Sequence[Values]) -> Iterator[Case]:
    """Yield the cases of the designs that a trial would run."""
    for values in designs:
        try:
            case = search.case_of(values)
        except CaseError:
            continue
        if not search.is_too_heavy(case):
            yield case


def _groups(search: DesignSearch, case: Case, sweep: int, curves: Sequence[Case]) -> list[RunGroup]:
    """Return the first and the last run of the sweep and of the curves of a trial for their halves."""
    ends = [(curves[index], len(curves) / 2) for index in ((0, -1) if curves else ())]
    if sweep:
        engine = instance(search.work_of(case).engine, ParticleEngine)
        ends += [(engine.variant(index), sweep / 2) for index in (0, sweep - 1)]
    # Each packing of each damper settles once. A shaken damper is alone in its run.
    beds = search.count * len(case.particle_dampers) / len(ends)
    groups = (RunGroup.of(each, runs, beds / len(each.particle_dampers)) for each, runs in ends)
    return [group for group in groups if group]


def _time_of_impact_runs(search: DesignSearch, case: Case, curves: Sequence[Case]) -> float:
    """Return the time of all runs of a trial with impact dampers, from a few of them [s]."""
    total = 0.0
    if search.measured:
        work = search.work_of(case)
        some = min(work.size, 4)
        before = time.process_time()
        work.run(Block(0, 0, some), None, threads=1, cancelled=None)
        total += (time.process_time() - before) * work.size / some
    if curves:
        before = time.process_time()
        simulate_many(curves[:1], progress=False)
        total += (time.process_time() - before) * len(curves)
    return total
