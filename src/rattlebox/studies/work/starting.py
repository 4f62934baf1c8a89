"""Variants that continue runs: checks before the work, the start of their window, and outputs of those that cannot."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.exceptions import RattleboxError
from rattlebox._util.quantities import amount
from rattlebox.core._core import Status
from rattlebox.model.errors import Hint
from rattlebox.studies.work.work import Output

if TYPE_CHECKING:
    from rattlebox.results.run import Run
    from rattlebox.studies.grid.grid import Grid


def check_starts(grid: Grid, check: Callable[[int, Run], object]) -> None:
    """Raise if neither the first nor the last variant can continue its start, unless a run must be repeated to know it."""
    for index in (0, grid.size - 1):
        start = grid.start_at(index)
        if start is None or not start.is_known:
            return
        try:
            check(index, start.run)
            return
        except RattleboxError as error:
            refused = error
    raise refused


def window_start(skip: float, begin: float) -> float:
    """Return the time from which the measures of a variant are evaluated: its start, or a later time [s]."""
    if not skip:
        return begin
    if skip < begin:
        raise Hint(
            f"skip = {amount(skip, 's')} is before the start at {amount(begin, 's', 9)}; it counts from the start of the "
            "first run, as the duration does",
            "skip = 0 for the start of each variant, or cycles, which count from there",
        )
    return skip


def missing_value(output: Output, name: str) -> Any:
    """Return an output of a variant that cannot run."""
    extra, kind, _ = output
    missing = Status.refused if name == "status" else 0 if np.dtype(kind).kind == "i" else np.nan
    return np.full([length for _, length in extra], missing)


def refused_row(outputs: Mapping[str, Output]) -> dict[str, Any]:
    """Return the outputs of a variant that cannot run, each with a first dimension of length one."""
    return {name: np.array([missing_value(output, name)], output[1]) for name, output in outputs.items()}
