"""Comparison of the derivatives of the package with those of stored runs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox.engines.transition import Flow

from .draw import scales
from .runs import Run, case_of, places, points, size
from .store import Stored


class Deviation(NamedTuple):
    """How far the package is from a stored run.

    Attributes
    ----------
    state
        Largest error of the state, over the largest gap and the largest approach speed, for each unit of growth: rounding
        grows with the motion.
    derivatives
        Largest error of a derivative, as a part of the largest term of its component of the state. Terms are derivatives
        in units of `draw.scales`.
    growth
        Largest term of all.
    agrees
        Whether the status is "finished", and contacts are the same, with their speeds and restitutions to 1e-9.
    status
        Status of the package.
    collocated
        Number of contacts that were solved as a whole.
    """

    state: float
    derivatives: float
    growth: float
    agrees: bool
    status: str
    collocated: int


def physical(run: Run, flow: Flow) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the matrix that makes positions and velocities of the state of a flow, (n, n), and its derivatives, (n, n, p).

    Rows are degrees of freedom and balls, positions first; columns are the state of the flow.
    """
    dofs, total = places(run), size(run)
    matrix, slopes = np.zeros((2 * total, 2 * total)), np.zeros((2 * total, 2 * total, len(flow.parameters)))
    for i, name in enumerate(points(run)):
        shape, slope = flow.shape(name)
        for half in (0, 1):
            matrix[i + half * total, half : 2 * dofs : 2] = shape
            slopes[i + half * total, half : 2 * dofs : 2] = slope
    balls = total - dofs
    for k in range(balls):
        for half in (0, 1):
            matrix[dofs + k + half * total, 2 * dofs + k + half * balls] = 1.0
    return matrix, slopes


def deviation(stored: Stored) -> Deviation:
    """Return how far the package is from a stored run."""
    run, touches = stored.run, stored.touches
    flow = Flow.of(case_of(run), stored.paths)
    end = flow.over(None, 0.0, run["end"])
    agrees = [(each.damper, each.contact) for each in end.contacts] == [touch[:2] for touch in touches]
    if not (end.ok and agrees):
        return Deviation(np.inf, np.inf, np.inf, False, end.status, 0)
    columns_of_log = 3 if run["hard"] else 2  # soft contacts have no restitution in the log of the program
    log = np.array([(each.time, each.approach_speed, each.restitution) for each in end.contacts])[:, :columns_of_log]
    agrees = np.allclose(log, np.array(touches)[:, 2 : 2 + columns_of_log], rtol=1e-9, atol=1e-12)
    matrix, slopes = physical(run, flow)
    state = matrix @ end.state
    by_state = matrix @ np.linalg.solve(matrix.T, end.matrix.T).T
    by_parameter = matrix @ end.by_parameter + np.einsum("ijp,j->ip", slopes, end.state)
    rows, columns = scales(run, touches, stored.paths)
    derivatives = np.hstack([by_state, by_parameter]) * columns / rows[:, None]
    exact = stored.derivatives * columns / rows[:, None]
    growth = max(1.0, float(np.abs(exact).max()))
    terms = np.maximum(np.abs(exact).max(axis=1, keepdims=True), 1e-3)
    return Deviation(
        float(np.abs((state - stored.state) / rows).max()) / growth,
        float((np.abs(derivatives - exact) / terms).max()),
        growth,
        agrees,
        end.status,
        end.raw.counts.collocated,
    )
