"""The branches that begin at flips and pitchforks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.progress import progress_bar
from rattlebox.model.errors import Hint
from rattlebox.model.units import whole_number
from rattlebox.studies.orbits.branch_data import LONGEST_STEP, MOST_POINTS, corrector_of, data_of
from rattlebox.studies.orbits.corrector import Corrector, Point
from rattlebox.studies.orbits.find import size_of
from rattlebox.studies.orbits.follow import Follower
from rattlebox.studies.orbits.shooting import ReturnMap

if TYPE_CHECKING:
    import xarray

    from rattlebox.studies.orbits.orbit import Orbit

_DISTANCES = (0.02, 0.1, 0.5, 0.004, 1.0)
"""Distances from the old branch, in longest steps, at which the new one is sought."""
_SAME = 0.2
"""Part of the distance from the old branch that the new motion must have in the direction of its multiplier."""


def switched(
    orbit: Orbit,
    kind: str,
    parameter: str,
    value: float,
    limits: Sequence[Any],
    *,
    points: int = MOST_POINTS,
    step: float = LONGEST_STEP,
    progress: bool | Callable[[int, int], object] = True,
) -> xarray.Dataset:
    """Return the dataset of the branch that begins at a flip or pitchfork; see `Branch.switch`."""
    corrector, unit = corrector_of(orbit.case, parameter, limits, step)
    old = ReturnMap(
        corrector.returns.forcing, orbit.cycles, (parameter,), phase=orbit.phase, mirrored=orbit.is_symmetric
    )
    modes = np.linalg.eig(old.shoot(orbit.state[None], [value]).monodromy())
    vector = np.real(modes.eigenvectors[:, np.argmin(np.abs(modes.eigenvalues + 1))])
    corrector.returns = old.with_(cycles=orbit.cycles * (2 if kind == "flip" else 1), mirrored=False)
    scale = size_of(corrector.returns, orbit.state)
    # No correction: the derivative of the new map is singular here.
    shot = corrector.returns.shoot(orbit.state[None], [value])
    start = None
    if scale is not None and shot.is_complete:
        start = corrector.finish(corrector.returns, orbit.state, value, shot, scale, 1.0)
    if start is None:
        raise Hint("the motion at the special point cannot be computed", "a branch with a shorter step")
    first = _first(corrector, start, vector)
    if first is None:
        raise Hint("the new branch was not found near this point", "a shorter step, such as step = 0.005")
    begin = replace(start, special=kind, located=value)
    most, follower = whole_number(points, "points", 1), Follower(corrector)
    with progress_bar(progress, "points") as report:
        count = iter(range(1, 2 * most + 2))
        row = list(follower.follow(first, most, lambda: report(next(count, most), most) is not False))
    return data_of([begin, first, *row], orbit.case, parameter, unit, follower)


def _first(corrector: Corrector, start: Point, vector: NDArray[np.float64]) -> Point | None:
    """Return the first point of the new branch, in the direction of the eigenvector of a multiplier."""
    n = start.scale.size
    tangent = np.append(vector / start.scale, 0.0)
    tangent /= np.sqrt(np.sum(corrector.weights(n) * tangent**2))
    aimed = replace(start, tangent=tangent)
    for share in _DISTANCES:
        length = share * corrector.longest
        taken = corrector.step(aimed, length)
        if taken is not None and abs(corrector.distance(aimed, taken[0]) - length) < _SAME * length:
            return taken[0]
    return None
