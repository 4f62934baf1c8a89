"""Run packed variants of a case and return measures of each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rattlebox.core import _core


@dataclass(frozen=True)
class BlockOutput:
    """Quantities that `run_block` returns for each variant."""

    measures: Sequence[str] = ()
    # Mode shapes at the observed point [kg^-1/2]: (m,), or (m, ...) over the grid
    shape: ArrayLike = field(default_factory=lambda: np.zeros(0))
    base: float = 1.0
    # Participation of the modes (m, ...) [kg^1/2] and residual mass [kg], for the force on the base; empty if unknown
    participation: ArrayLike = field(default_factory=lambda: np.zeros(0))
    residual_mass: ArrayLike = 0.0
    # Time from which measures are evaluated [s] and length of a cycle [s]; numbers, or arrays that broadcast over the grid
    start: ArrayLike = 0.0
    period: ArrayLike = float("nan")
    samples: int = 2
    motion: bool = False
    last: int = 0
    state: bool = False
    batched: Sequence[str] = ()
    # Times of further samples [s], with which each variant is also returned as a run
    times: NDArray[np.float64] | None = None


def run_block(
    packed: _core.Problem,
    shape: Sequence[int],
    start: int,
    stop: int,
    output: BlockOutput,
    *,
    threads: int = 1,
    progress: Callable[[int], bool | None] | None = None,
) -> dict[str, NDArray[Any]] | None:
    """Run a range of the variants of a batch.

    Returns arrays by name, variants along the first axis: `status` and each measure (n,); `displacement` and `velocity` (n,
    samples), `relative_position` and `relative_velocity` (n, samples, balls) of the motion; `last_time`,
    `last_approach_speed`, `last_contact` (n, last); `state` (n, 2 (modes + balls)); `batches` (measures, n, 64) and
    `batch_length` (n, 64) [s] of the parts, NaN for parts that there are not. Everything but the status is NaN for runs
    that did not finish. `runs`, a list, with `times`. None if `progress` stopped the block.
    """
    grid = list(shape) or [1]
    window = _core.Window(
        start=_number(output.start, grid),
        period=_number(output.period, grid),
        shape=np.asarray(output.shape, dtype=float),
        base=output.base,
        participation=np.asarray(output.participation, dtype=float),
        residual_mass=_number(output.residual_mass, grid),
        samples=output.samples,
    )
    block = _core.sweep(
        packed,
        grid,
        start,
        stop,
        window,
        list(output.measures),
        list(output.batched),
        motion=output.motion,
        state=output.state,
        last=output.last,
        threads=max(1, min(threads, stop - start)),
        progress=progress,
        times=None if output.times is None else output.times.tolist(),
    )
    if block is None:
        return None
    arrays = {name: getattr(block, name) for name in block.fields() if name not in ("measures", "batches", "runs")}
    measures = dict(zip(output.measures, block.measures, strict=True))
    if output.batched:
        arrays["batches"] = np.array(block.batches)
    if output.times is not None:
        arrays["runs"] = block.runs
    return {name: values for name, values in arrays.items() if values is not None} | measures


def _number(value: ArrayLike, grid: list[int]) -> float | NDArray[np.float64]:
    array = np.asarray(value, dtype=float)
    return float(array) if array.ndim == 0 else array.reshape((1,) * (len(grid) - array.ndim) + array.shape)
