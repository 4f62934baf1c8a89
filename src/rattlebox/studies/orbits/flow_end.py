"""The end of a stretch of a motion with its derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from rattlebox.engines.transition import Transition

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class End:
    """End of a stretch of a motion from a state, and its derivatives.

    `ok` is whether it was computed. `matrix` (n, n) is the derivative with respect to the state at the start, `by_parameter`
    (n, p), `by_time` (n,) the rate of change at the end; all empty if they are not requested. `transition` is the
    stretch itself; None if its derivatives are means of two others.
    """

    state: Vector
    ok: bool
    matrix: Vector
    by_parameter: Vector
    by_time: Vector
    transition: Transition | None = None


def failed(size: int) -> End:
    """Return the end of a motion that was not computed."""
    empty = np.zeros((size, 0))
    return End(np.full(size, np.nan), False, empty, empty, empty)
