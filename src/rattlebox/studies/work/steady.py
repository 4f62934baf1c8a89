"""Runs that are repeated from their end until the motion is steady."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rattlebox.analysis.cycle_loss import cycle_loss
from rattlebox.engines.dem import continue_dem
from rattlebox.engines.simulate import simulate_many

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.results.run import Run

EXTENSIONS = 4
"""How often the default evaluated cycles are repeated, at most."""


def steady_run(
    case: Case,
    *,
    frequency: float,
    kept: int,
    extensions: int,
    threads: int | None = None,
    progress: Callable[..., bool] | None = None,
) -> Run:
    """Run a shaken case until the motion in its last cycles is steady.

    Parameters
    ----------
    frequency
        Frequency of the motion [Hz].
    """
    more = case.model_copy(update={"duration": kept / frequency})
    end = None
    for number in range(extensions + 1):
        if case.particle_dampers:
            run, end = continue_dem(more if number else case, end, threads=threads, progress=progress)
        else:
            longer = case.model_copy(update={"duration": case.duration + number * kept / frequency})
            (run,) = simulate_many([longer], threads=threads, progress=progress or False)
        if not run.ok or cycle_loss(run, frequency, kept).is_steady:
            break
    return run
