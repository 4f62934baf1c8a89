"""Report about a run of particles that is not finished, from its checkpoint and its snapshots."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING

from rattlebox._util.quantities import amount
from rattlebox.model.case import Case
from rattlebox.plots.particles import plot_particles
from rattlebox.report.kinds.run import case_question
from rattlebox.report.parts import Call, Kind, Picture

if TYPE_CHECKING:
    from rattlebox.results.snapshots import Snapshots


@dataclass(frozen=True)
class UnfinishedRun:
    """A run that was stopped before its end."""

    case_toml: str
    time: float  # Simulated time and computing time so far [s]
    seconds: float
    snapshots: Snapshots | None = None

    @cached_property
    def case(self) -> Case:
        """The case."""
        return Case.from_toml(self.case_toml)


def _answer(run: UnfinishedRun) -> Iterator[str]:
    reached, end = amount(run.time, "s"), amount(run.case.duration, "s")
    yield (
        f"The run is not finished: it has reached {reached} of {end} ({amount(run.time / run.case.duration, '%', 2)}), in "
        f"{amount(run.seconds, 's', 3)} of computing. There are no results yet; the command that started the run resumes it."
    )


def _pictures(run: UnfinishedRun) -> Iterator[Picture]:
    if run.snapshots is not None and len(run.snapshots):
        yield Picture(
            "The particles in the last snapshot so far.",
            partial(plot_particles, run.snapshots, size="column", renderer="plain"),
        )


KIND: Kind[UnfinishedRun] = Kind(
    name="Unfinished run",
    cases=lambda run: {"": run.case},
    question=lambda run: case_question(run.case),
    answer=_answer,
    call=lambda run: Call("simulate"),
    pictures=_pictures,
)
