"""Largest drift over the storeys of a building, and largest acceleration over the points of a structure."""

from __future__ import annotations

import re
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import RattleboxError
from rattlebox.model.errors import Hint

from .acceleration import accelerations_of_steps, base_at_points
from .damper_force import has_hard_impacts

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rattlebox.model.case import Case

    from .arrays import RunArrays
    from .record import Record

FloatArray = NDArray[np.float64]
_FLOOR = re.compile(r"storey [1-9]\d*")


def storeys_in(points: Iterable[str]) -> list[str]:
    """Return the points of a building that are floors, from the ground up; none if a floor between them is missing."""
    floors = {int(name.removeprefix("storey ")): name for name in points if _FLOOR.fullmatch(name)}
    return [floors[k] for k in sorted(floors)] if sorted(floors) == list(range(1, len(floors) + 1)) else []


def peak_drifts(arrays: RunArrays) -> dict[str, float]:
    """Return the peak drift of each storey: the displacement of its floor over that of the floor below [m]."""
    storeys = storeys_in(arrays.points)
    floors = arrays.displacement[:, [arrays.points.index(storey) for storey in storeys]]
    drifts = np.abs(np.diff(floors, axis=1, prepend=0.0))
    return dict(zip(storeys, drifts.max(axis=0).tolist(), strict=True))


def accelerations(run: Record) -> tuple[FloatArray | None, FloatArray | None]:
    """Return the accelerations of the points in each output step, relative to the base and absolute, (2, T - 1, P).

    They are the same array if the base does not move, and None without the case, which knows the shapes of the modes.
    They are NaN with hard impacts, before and after which the run has samples at the same time.
    """
    arrays = run.arrays
    if not run.source or arrays.time.size < 2:
        return None, None
    with suppress(RattleboxError), np.errstate(over="ignore", invalid="ignore"):
        case = run.case
        shapes = np.array(list(case.modes.lines().values())).reshape(len(arrays.points), -1)
        relative = accelerations_of_steps(arrays, case, shapes.T)
        if has_hard_impacts(arrays):
            relative = np.full_like(relative, np.nan)
        if not arrays.base_acceleration.any():
            return relative, relative
        base = base_at_points(case, arrays.base_acceleration)
        return relative, relative + np.stack([base[:-1], base[1:]])
    return None, None


def own_points(case: Case) -> list[str]:
    """Return the points of a structure with their directions, without those of its tuned masses."""
    masses = case.tuned_masses
    labels = {mass.label(index, len(masses)) for index, mass in enumerate(masses)}
    return [name for name in case.modes.lines() if name not in labels and name[:-2] not in labels]


def require_storeys(points: Iterable[str]) -> None:
    """Raise if a structure has no floors, between which there could be a drift, or not all of them."""
    if not storeys_in(points):
        raise Hint(
            'largest_drift needs all floors of a building, points "storey 1", "storey 2", ...',
            'ShearBuilding, or these names for its floors in the points of other structures; or point = "a - b", whose peak '
            "is the drift between two points",
        )


def largest_drift(run: Record) -> float:
    """Compute the largest drift over the storeys of a building.

    Parameters
    ----------
    run
        Run of a structure with the points "storey 1", "storey 2", ..., such as a `rb.ShearBuilding`.

    Returns
    -------
    float
        Largest drift [m].

    Raises
    ------
    CaseError
        If the structure has no storeys.

    Notes
    -----
    max abs(x_k(t) - x_(k - 1)(t)) over the storeys k and the output times t, with x_0 = 0, the base. It is the measure of
    the same name in studies.

    Examples
    --------
    >>> import rattlebox as rb
    >>> tower = rb.ShearBuilding(masses=["50 t"] * 2, stiffnesses=["60 MN/m"] * 2, damping_ratio=0.02)
    >>> push = rb.HalfSine(amplitude="0.2 g", duration="0.2 s")
    >>> run = rb.simulate(rb.Case(structure=tower, base=push, duration="2 s"))
    >>> largest_drift(run) == run.summary().values["peak_drift[storey 1]"]
    True
    """
    require_storeys(run.arrays.points)
    return max(peak_drifts(run.arrays).values())


def largest_acceleration(run: Record) -> float:
    """Compute the largest absolute acceleration over the points of a structure.

    Parameters
    ----------
    run
        Run with its case.

    Returns
    -------
    float
        Largest acceleration [m/s^2]. Points in 3-D count by each of their directions; tuned masses do not count. NaN for
        a structure without points.

    Raises
    ------
    CaseError
        If the case of a run from a file cannot be read.

    Notes
    -----
    The largest `peak_acceleration` of the points, in which contacts act with their mean over an output step. It is the
    measure of the same name in studies.

    Examples
    --------
    The run of the example of `rattlebox.analysis.largest_drift`:

    >>> largest_acceleration(run) == run.summary().values["peak_acceleration[storey 2]"]
    True
    """
    _, absolute = accelerations(run)
    places = [run.arrays.points.index(name) for name in own_points(run.case)]
    return float("nan") if absolute is None or not places else float(np.abs(absolute[:, :, places]).max())
