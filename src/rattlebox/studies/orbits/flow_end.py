"""The end of a stretch of a motion with its derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class End:
    """End of a stretch of a motion from a state, and its derivatives.

    `ok` is whether it was computed. `matrix` (n, n) is the derivative with respect to the state at the start, `by_parameter`
    (n, p), `by_time` (n,) the rate of change at the end; all empty if they are not requested.
    """

    state: Vector
    ok: bool
    matrix: Vector
    by_parameter: Vector
    by_time: Vector


def failed(size: int) -> End:
    """Return the end of a motion that was not computed."""
    empty = np.zeros((size, 0))
    return End(np.full(size, np.nan), False, empty, empty, empty)
