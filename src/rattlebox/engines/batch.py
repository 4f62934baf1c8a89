"""Run packed variants of a case and return measures of each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.core import _core


@dataclass(frozen=True)
class Look:
    """What is kept of each run.

    Attributes
    ----------
    measures
        Names of measures, see rattlebox.studies.measures.
    shape
        Mode shapes at the point that is watched: (m,), or (m, ...) over the grid.
    start, period
        Begin of the window [s] and length of a cycle [s], numbers or arrays that broadcast over the grid.
    samples
        Equally spaced samples of the motion from `start` to the end of the run, both included.
    motion
        Keep those samples.
    last
        Keep that many impacts from the end.
    state
        Keep the state at the end.
    """

    measures: Sequence[str] = ()
    shape: Any = field(default_factory=lambda: np.zeros(0))
    start: Any = 0.0
    period: Any = float("nan")
    samples: int = 2
    motion: bool = False
    last: int = 0
    state: bool = False


def run_block(
    packed: _core.Problem,
    shape: Sequence[int],
    start: int,
    stop: int,
    look: Look,
    *,
    threads: int = 1,
    progress: Callable[[int], bool | None] | None = None,
) -> dict[str, NDArray[Any]] | None:
    """Run some variants of a batch.

    Parameters
    ----------
    packed
        The batch, from `pack_batch`.
    shape
        Shape of the grid.
    start, stop
        Variants, counted along the grid with its last axis fastest.
    look
        What is kept.
    threads
        Number of threads. The results do not depend on it, to the last bit.
    progress
        Called some fifty times a second with the number of variants done; False stops.

    Returns
    -------
    dict of str to array, or None
        By name, variants first: `status`, the measures; `displacement` and `velocity` (n, samples), `ball_place` and
        `ball_speed` (n, samples, balls) of the motion; `last_time`, `last_approach_speed`, `last_contact` (n, last);
        `state` (n, 2 (modes + balls)). All but the status is NaN where a run did not finish. None when it was stopped.
    """
    grid = list(shape) or [1]
    window = _core.Window(
        start=_number(look.start, grid),
        period=_number(look.period, grid),
        shape=np.asarray(look.shape, dtype=float),
        samples=look.samples,
    )
    block = _core.sweep(
        packed,
        grid,
        start,
        stop,
        window,
        list(look.measures),
        motion=look.motion,
        state=look.state,
        last=look.last,
        threads=max(1, min(threads, stop - start)),
        progress=progress,
    )
    if block is None:
        return None
    arrays = {name: getattr(block, name) for name in block.fields() if name != "measures"}
    measures = dict(zip(look.measures, block.measures, strict=True))
    return {name: values for name, values in arrays.items() if values is not None} | measures


def _number(value: Any, grid: list[int]) -> float | NDArray[np.float64]:
    array = np.asarray(value, dtype=float)
    return float(array) if array.ndim == 0 else array.reshape((1,) * (len(grid) - array.ndim) + array.shape)
