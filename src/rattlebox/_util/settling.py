"""Time after which a signal remains within a band around zero."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def settled_after(t: NDArray[np.float64], x: NDArray[np.float64], limit: float) -> float:
    """Return the time after which the magnitude of a signal is at most a limit; see `rattlebox.analysis.settling_time`.

    Parameters
    ----------
    t : (N,) float
        Increasing times [s].
    x : (N,) float
        Signal about its rest position.
    """
    side = np.where(np.abs(x) > limit, np.sign(x), 0.0)
    starts = np.flatnonzero(np.diff(side, prepend=np.nan))  # of intervals on one side, or within the band
    if side[-1]:
        return float("nan")
    if starts.size == 1:
        return float(t[0])
    k = int(starts[-1]) - 1
    # A fast oscillation may cross zero between two samples; signed values give the time at the edge of the band.
    out = np.copysign(limit, x[k])
    passed = float(t[k] + (t[k + 1] - t[k]) * (out - x[k]) / (x[k + 1] - x[k]))
    swings = [start for start in starts[:-1] if side[start]][-2:]
    if len(swings) < 2 or side[swings[0]] == side[swings[1]]:
        return passed
    return float("nan") if t[-1] - passed < t[swings[1]] - t[swings[0]] else passed
