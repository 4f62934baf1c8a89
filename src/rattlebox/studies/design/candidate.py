"""A design of a search, and the results of its runs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from rattlebox.model.case import Case
from rattlebox.studies.damping_curve import Evaluate, Way
from rattlebox.studies.design.space import DAMPING_RATIO

if TYPE_CHECKING:
    from rattlebox.engines.dem import PausedRun

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Curve:
    """Settings of the damping curves of a search; see `rattlebox.studies.damping_curve.damping_curve`."""

    amplitudes: Sequence[Any]
    way: Way
    mode: int
    cycles: tuple[int, int] | None


class Curves(NamedTuple):
    """Damping curves of a trial, or of several ones, trials first."""

    ratios: Vector  # Damping ratios, (levels, amplitudes, packings)
    halves: Vector  # Half of the widths of the intervals of their means, (levels, amplitudes)
    bare: Vector  # Damping ratios of the structure alone, (levels,)


@dataclass
class Evaluation:
    """Result of the runs of a trial."""

    values: Vector  # Objectives that need runs, and half of the widths of their 95 % intervals, (objectives,)
    intervals: Vector
    packings: Vector  # Their values for each packing that ran, (objectives, P)
    missing: float = 0.0
    warnings: int = 0
    reason: str = ""
    curves: Curves | None = None
    dropped: bool = False
    cycles: int = 0  # Number of cycles of its runs if they are known
    # Rise of the objectives from the first to the second half of the cycles of shaken runs, (objectives,)
    drift: Vector = field(default_factory=lambda: np.zeros(1))

    def widened(self, scatter: Vector) -> Evaluation:
        """Return the result with intervals of its packings for at least a given scatter, (objectives,)."""
        count = np.isfinite(self.packings).sum(axis=1)
        return replace(self, intervals=np.fmax(self.intervals, scatter / np.sqrt(count)))


def pooled(found: Sequence[Evaluation]) -> Vector:
    """Return the scatter of the packings of some trials with which their intervals are widened, (objectives,).

    It is the root mean square of their standard deviations, times the quantile of Student's t. A few packings of one trial
    may agree by chance, as where each has one of two steady motions, and their own interval is then too narrow.
    """
    # Sorted, so that the order of the trials, which a stop may change, has no effect on the last digit.
    variances = np.mean(np.sort([np.nanvar(each.packings, axis=1, ddof=1) for each in found], axis=0), axis=0)
    freedom = sum(np.isfinite(each.packings).sum(axis=1) - 1 for each in found)
    return np.asarray(stdtrit(freedom, 0.975) * np.sqrt(variances))


@dataclass
class Candidate:
    """A design and the results of its packings so far."""

    case: Case | None  # None if it is refused
    mass: float = math.nan
    refused: str = ""
    ran: int = 0  # Number of packings in the tables
    short: list[Evaluation] = field(default_factory=list)  # Results after the parts of its first packings
    tables: dict[str, tuple[Vector, Vector | None]] = field(default_factory=dict)
    missing: float = 0.0
    warnings: int = 0
    reason: str = ""
    rows: dict[str, Any] = field(default_factory=dict)  # Results of the runs of damping curves, by case
    seconds: Vector = field(default_factory=lambda: np.zeros(2))  # Wall and processor time of its runs [s]

    paused: dict[str, PausedRun] = field(default_factory=dict)  # Runs after a part, by case
    room: int = 0  # Size of further paused runs that may be stored [bytes]

    @property
    def memory(self) -> int:
        """Size of its paused runs [bytes]."""
        return sum(each.memory for each in self.paused.values())

    def remember(self, evaluate: Evaluate, part: tuple[int, int] | None) -> Evaluate:
        """Return a function like `evaluate_cases` that runs each case once, from where an earlier part of it paused."""

        def run(cases: Sequence[Case], function: Any, **options: Any) -> list[Any]:
            texts = [case.to_toml() for case in cases]
            keys = [f"{part} {text}" for text in texts]
            new = [k for k, key in enumerate(keys) if key not in self.rows]
            if not new:
                return [self.rows[key] for key in keys]
            if simulate := options.get("simulate"):  # shaken
                before = {texts[k]: self.paused.pop(texts[k], None) for k in new}
                options["simulate"] = partial(_continued, partial(simulate, room=self.room / len(new)))
                found = evaluate([(cases[k], before[texts[k]]) for k in new], function, **options)
                self.paused |= {texts[k]: row.paused for k, row in zip(new, found, strict=True) if row.paused}
                found = [row._replace(paused=None) for row in found]
            else:
                found = evaluate([cases[k] for k in new], function, **options)
            self.rows |= {keys[k]: row for k, row in zip(new, found, strict=True)}
            return [self.rows[key] for key in keys]

        return run


def _continued(simulate: Callable[..., Any], item: tuple[Case, PausedRun | None], **options: Any) -> Any:
    """Return the run of a case from where an earlier part of it paused."""
    case, before = item
    return simulate(case, before=before, **options)


def added_mass(case: Case) -> float:
    """Return the mass of all balls and particles of a case [kg]."""
    balls = sum(ball.weight for damper in case.impact_dampers for ball in damper.balls)
    return balls + sum(float(damper.contents.mass.sum()) for damper in case.particle_dampers)


def reason_of(tables: dict[str, tuple[Vector, Vector | None]]) -> str:
    """Return which objectives lack a value."""
    names = [name for name, (values, _) in tables.items() if not np.isfinite(values).all()]
    if DAMPING_RATIO in names:
        return "some decays do not pass all amplitudes within the duration"
    return f"no {' and no '.join(names)} in some runs" if names else "some runs did not finish"
