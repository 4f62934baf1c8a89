"""Curves of a special point in two parameters: limits of stability in a plane."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.narrow import present
from rattlebox._util.progress import progress_bar
from rattlebox.model.errors import Hint
from rattlebox.model.units import whole_number
from rattlebox.studies.orbits.branch import SpecialPoint
from rattlebox.studies.orbits.branch_data import LONGEST_STEP, corrector_of
from rattlebox.studies.orbits.find import away_from_impacts, size_of
from rattlebox.studies.orbits.forcing import Forcing, number_at
from rattlebox.studies.orbits.orbit import Orbit, orbit_of
from rattlebox.studies.orbits.shooting import TOLERANCE, ReturnMap

if TYPE_CHECKING:
    import xarray

Vector = NDArray[np.float64]

_CHANGE = 1e-5
"""Step of the central differences of the test function in scaled coordinates."""
_ZERO = 1e-8
"""Largest value of the test function of a point."""
_CORRECTIONS = 8
_SHORTEST = 1e-5


def _minus_one(values: NDArray[np.complex128]) -> float:
    return float(np.prod(values - 1).real)


def _plus_one(values: NDArray[np.complex128]) -> float:
    return float(np.prod(values + 1).real)


def _pair(values: NDArray[np.complex128]) -> float:
    return float(np.prod([one * other - 1 for one, other in combinations(values, 2)]).real)


TESTS: dict[str, Callable[[NDArray[np.complex128]], float]] = {
    "fold": _minus_one,
    "flip": _plus_one,
    "pitchfork": _plus_one,
    "torus": _pair,
}
"""Test functions of the multipliers of the map; that of a symmetric motion covers half a period."""


def continue_point(
    point: SpecialPoint,
    axes: Sequence[str],
    limits: Sequence[Sequence[Any]],
    *,
    points: int = 200,
    step: float = LONGEST_STEP,
    progress: bool | Callable[[int, int], object] = True,
) -> xarray.Dataset:
    r"""Follow a fold, flip, pitchfork or Neimark-Sacker bifurcation in two parameters: a limit of stability in their plane.

    Parameters
    ----------
    point
        Special point of a branch.
    axes
        Paths of two parameters.
    limits
        Smallest and largest value of each, a pair for each path.
    points
        Largest number of points in each of both directions.
    step
        Longest step, as part of the ranges of the parameters and of the size of the motion.
    progress
        As for `rattlebox.continue_orbit`.

    Returns
    -------
    xarray.Dataset
        Over `point`: the values of both parameters, under their paths, the `amplitude` of the first point of the structure
        [m], and `angle`, the angle of the critical multiplier [rad].

    Raises
    ------
    CaseError
        If the point is of another kind, the paths or limits are not valid, or the point is not between the limits.

    Notes
    -----
    The equations :math:`P(x, p, q) = x` and :math:`\psi(M) = 0`, with the test function :math:`\psi` of the special point,
    are followed by pseudo-arclength continuation. The derivatives of :math:`\psi` are central differences of the exact
    :math:`M`.

    Examples
    --------
    With the branch of the example of `rattlebox.continue_orbit`:

    >>> import rattlebox as rb
    >>> axes, limits = ("load.frequency", "damper.gap"), [("31 Hz", "34 Hz"), ("0.8 mm", "1.2 mm")]
    >>> curve = rb.continue_point(branch.specials[0], axes, limits, points=10, progress=False)
    >>> curve.attrs["kind"]
    'pitchfork'
    """
    if not isinstance(point, SpecialPoint) or point.kind not in TESTS:
        kind = getattr(point, "kind", point)
        raise Hint(
            f"a point of kind {kind!r:.40} is not followed in two parameters; it must be one of {', '.join(TESTS)}",
            "a point of branch.specials of these kinds; branches at several values of the second parameter for others",
        )
    if isinstance(axes, str) or len(axes) != 2 or len(limits) != 2:
        raise Hint("axes must be two paths, and limits a pair for each", '("load.frequency", "damper.gap")')
    if axes[0] == axes[1]:
        raise Hint(f"axes: {axes[0]} is given twice", "two different paths")
    both = [corrector_of(point.orbit.case, axis, pair, step) for axis, pair in zip(axes, limits, strict=True)]
    curve = _Curve(point, tuple(axes), [corrector.limits for corrector, _ in both], float(step))
    if not curve.is_inside(curve.start[1]):
        raise Hint("the point is not between the limits", "limits around it")
    most = whole_number(points, "points", 1)
    with progress_bar(progress, "points") as report:
        rows = list[list[Row]]()
        for side in (-1.0, 1.0):
            row = []
            for each in curve.follow(side, most):
                row.append(each)
                if report(len(rows) + len(row), 2 * most) is False:
                    break
            rows.append(row)
    row = [*rows[0][::-1], curve.start, *rows[1]]
    return _dataset(curve, row, axes, [unit for _, unit in both], point.kind)


Row = tuple[Orbit, Vector]
"""A motion and the values of both parameters."""


class _Curve:
    """Curve of a special point in two parameters."""

    def __init__(
        self, point: SpecialPoint, axes: tuple[str, ...], limits: Sequence[tuple[float, float]], step: float
    ) -> None:
        orbit = point.orbit
        self.test = TESTS[point.kind]
        self.limits = np.array(limits)
        self.width = self.limits[:, 1] - self.limits[:, 0]
        self.longest = step
        self.returns = ReturnMap(
            Forcing.of(orbit.case), orbit.cycles, axes, phase=orbit.phase, mirrored=orbit.is_symmetric
        )
        self.start: Row = orbit, np.array([present(number_at(orbit.case, axis)) for axis in axes])

    def is_inside(self, values: Vector) -> bool:
        """Return whether values of both parameters are between their limits."""
        return bool((values >= self.limits[:, 0]).all() and (values <= self.limits[:, 1]).all())

    def follow(self, side: float, most: int) -> Iterator[Row]:
        """Yield the motions on one side of the start."""
        orbit, values = self.start
        returns = self.returns
        scale = present(size_of(returns, orbit.state))
        state, tangent = orbit.state, None
        length, count = self.longest / 4, 0
        linear = self._linear(returns, state, values, scale)
        if linear is None:
            return
        tangent = side * _null(linear[1])
        while count < most:
            n = state.size
            guess = state + length * tangent[:n] * scale, values + length * tangent[n:] * self.width
            corrected = self._correct(returns, *guess, scale, tangent)
            if corrected is None:
                length /= 2
                if length < _SHORTEST:
                    return
                continue
            state, values, slopes, used = corrected
            if not self.is_inside(values):
                return
            new = _null(slopes)
            tangent = new if new @ tangent > 0 else -new
            shot = returns.shoot(state[None], values.tolist())
            found = orbit_of(returns, shot, state, scale, values.tolist())
            if found is None:
                return
            yield found, values
            count += 1
            length = min(1.4 * length, self.longest) if used <= 3 else length / 2 if used >= 6 else length
            # The map begins in the longest flight when an impact comes near its beginning.
            here = ReturnMap(Forcing.of(found.case), returns.cycles, phase=returns.phase)
            moved, there = away_from_impacts(here, state)
            if moved.phase != returns.phase:
                returns, state = returns.with_(phase=moved.phase), there
                linear = self._linear(returns, state, values, scale)
                if linear is None:
                    return
                new = _null(linear[1])
                tangent = new if new[n:] @ tangent[n:] > 0 else -new

    def _psi(self, returns: ReturnMap, state: Vector, values: Vector) -> float:
        """Return the test function; NaN if the motion cannot be computed."""
        shot = returns.shoot(state[None], values.tolist())
        if not shot.is_complete:
            return float("nan")
        return self.test(np.linalg.eigvals(shot.monodromy()).astype(complex))

    def _linear(self, returns: ReturnMap, state: Vector, values: Vector, scale: Vector) -> tuple[Vector, Vector] | None:
        """Return residual and test function, (n + 1,), and their scaled derivatives, (n + 1, n + 2)."""
        n = state.size
        shot = returns.shoot(state[None], values.tolist())
        if not shot.is_complete:
            return None
        by_state = shot.jacobian() * scale / scale[:, None]
        top = np.column_stack([by_state, shot.by_parameter[0] * self.width / scale[:, None]])
        sizes = np.concatenate([scale, self.width]) * _CHANGE
        row = np.zeros(n + 2)
        for k, size in enumerate(sizes):
            change = np.zeros(n + 2)
            change[k] = size
            up = self._psi(returns, state + change[:n], values + change[n:])
            down = self._psi(returns, state - change[:n], values - change[n:])
            row[k] = (up - down) / (2 * _CHANGE)
        value = self.test(np.linalg.eigvals(shot.monodromy()).astype(complex))
        result = np.append(shot.residual[0] / scale, value), np.vstack([top, row])
        return result if np.isfinite(result[1]).all() else None

    def _correct(
        self, returns: ReturnMap, state: Vector, values: Vector, scale: Vector, normal: Vector
    ) -> tuple[Vector, Vector, Vector, int] | None:
        """Return state, values, derivatives and number of corrections of the point in the plane through a guess."""
        n = state.size
        for count in range(1, _CORRECTIONS + 1):
            linear = self._linear(returns, state, values, scale)
            if linear is None:
                return None
            right, slopes = linear
            change = np.linalg.lstsq(np.vstack([slopes, normal]), -np.append(right, 0.0), rcond=None)[0]
            if not np.isfinite(change).all() or np.abs(change).max() > 0.5:
                return None
            if np.abs(right[:-1]).max() < TOLERANCE and abs(right[-1]) < _ZERO and np.abs(change).max() < 1e-6:
                return state, values, slopes, count
            state, values = state + change[:n] * scale, values + change[n:] * self.width
        return None


def _null(slopes: Vector) -> Vector:
    """Return the unit vector in which all derivatives vanish."""
    *_, rows = np.linalg.svd(slopes)
    return np.asarray(rows[-1])


def _dataset(curve: _Curve, row: Sequence[Row], axes: Sequence[str], units: Sequence[str], kind: str) -> xarray.Dataset:
    """Return the dataset of a curve."""
    import xarray

    values = np.array([value for _, value in row])
    data: dict[str, Any] = {
        axis: ("point", values[:, k], {"units": units[k], "long_name": axis}) for k, axis in enumerate(axes)
    }
    sizes = [next(iter(orbit.amplitudes.values()), np.nan) for orbit, _ in row]
    critical = [orbit.multipliers[np.argmin(np.abs(np.abs(orbit.multipliers) - 1))] for orbit, _ in row]
    data["amplitude"] = "point", np.array(sizes), {"units": "m", "long_name": "amplitude"}
    data["angle"] = (
        "point",
        np.abs(np.angle(critical)),
        {"units": "rad", "long_name": "angle of the critical multiplier"},
    )
    about = {"study": "continue_point", "kind": kind, "case": curve.start[0].case.to_toml(), "axes": list(axes)}
    return xarray.Dataset(data, attrs=about)
