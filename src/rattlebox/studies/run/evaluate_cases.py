"""Runs of single cases on a backend, to each of which a function is applied."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.progress import progress_bar
from rattlebox.engines.simulate import simulate_many
from rattlebox.studies.run.backends import make_backend
from rattlebox.studies.work.work import Block, Cancelled, Chain, Values, proceed_unless

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.results.run import Run


def evaluate_cases(
    cases: Sequence[Case],
    evaluate: Callable[[Run], Any],
    *,
    simulate: Callable[..., Run] | None = None,
    backend: Any = "threads",
    workers: int | None = None,
    progress: bool | Callable[[int, int], object] = True,
) -> list[Any]:
    """Simulate cases and return the value of a function of each run, in the order of the cases."""
    work = _Cases(cases, evaluate, simulate or _simulate)
    chains = [Chain([Block(number, number, number + 1)]) for number in range(len(cases))]
    found: dict[int, Any] = {}
    # Work on cases has neither a grid nor outputs, which backends do not use.
    chosen = make_backend(backend, workers)
    with progress_bar(progress, "runs") as report, closing(chosen.run(work, chains)) as finished:  # type: ignore[arg-type]
        for block, values in finished:
            found[block.number] = values["found"][0]
            report.advance(len(found), len(cases))
    return [found[number] for number in range(len(cases))]


@dataclass(frozen=True)
class _Cases:
    cases: Sequence[Case]
    evaluate: Callable[[Run], Any]
    simulate: Callable[..., Run]

    def run(self, start: int, stop: int, *, threads: int, cancelled: Cancelled) -> Values | None:
        proceed = proceed_unless(cancelled)
        found = np.empty(stop - start, object)
        for number in range(start, stop):
            run = self.simulate(self.cases[number], threads=threads, progress=proceed)
            if not proceed():
                return None
            found[number - start] = self.evaluate(run)
        return {"found": found}


def _simulate(case: Case, *, threads: int, progress: Callable[..., bool]) -> Run:
    """Return the run of one case."""
    (run,) = simulate_many([case], threads=threads, progress=progress)
    return run
