"""The runs that judge one design together: load levels and start positions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.model.errors import Hint
from rattlebox.model.units import whole_number

if TYPE_CHECKING:
    from rattlebox.model.case import Case


def robust_axes(case: Case, levels: Any = None, starts: int | Sequence[Any] | None = None) -> list[Any]:
    """Return the axes of the runs that judge one design together; none where it is judged by one run.

    Parameters
    ----------
    case
        The case.
    levels
        Any axes, as for `rb.sweep`.
    starts
        Start positions of the only ball; a number spreads so many evenly from wall to wall.

    Raises
    ------
    CaseError
        When there are several balls, or less than two start positions are to be spread.
    """
    axes = list(levels) if isinstance(levels, (list, tuple)) else [] if levels is None else [levels]
    if starts is not None:
        if [len(damper.balls) for damper in case.impact_dampers] != [1]:
            raise Hint("starts are of one ball, and the case has not exactly one", 'levels={"dampers[0].start": [...]}')
        one_by_one = hasattr(starts, "__len__")
        axes.append({"damper.start": starts if one_by_one else np.linspace(-1, 1, whole_number(starts, "starts", 2))})
    return axes
