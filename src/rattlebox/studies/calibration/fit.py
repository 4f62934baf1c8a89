"""Ranges of calibrated parameters, their intervals, and statements about what the data do not determine."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc, fdtri

from rattlebox._util.quantities import amount
from rattlebox.model.errors import Hint, at, nearest
from rattlebox.studies.calibration.measurements import read_column
from rattlebox.studies.calibration.response_surface import Agreement, Known, Region, Surfaces
from rattlebox.studies.grid.axes import materials_in
from rattlebox.studies.grid.grid import Parameter

if TYPE_CHECKING:
    from rattlebox.model.case import Case


# ---- ranges


FloatArray = NDArray[np.float64]

NORMAL = 1.959964
"""Half of the width of a 95 % interval over the standard deviation."""
_MOST = 3
"""Largest number of parameters."""


@dataclass(frozen=True, eq=False)
class Space:
    """Ranges of parameters. Points in it are in units of the ranges: 0 for the smallest, 1 for the largest value."""

    paths: list[str]
    units: list[str]
    low: FloatArray  # Smallest and largest values, (d,)
    high: FloatArray
    is_log: NDArray[np.bool_]  # Whether a range is logarithmic, (d,)
    known: dict[str, tuple[float, float]]

    @classmethod
    def of(cls, case: Case, parameters: Any, log: Any, known: Any) -> Space:
        """Return the ranges of a call."""
        if not isinstance(parameters, Mapping) or not parameters:
            example = '{"damper.contact.restitution": (0.5, 0.95)}'
            raise Hint("a mapping of paths to pairs (smallest, largest) is required", example, ["parameters"])
        if len(parameters) > _MOST:
            advice = "the others measured on their own, such as the restitution by rb.Drops"
            raise Hint(f"{len(parameters)} parameters are too many, at most {_MOST}", advice, ["parameters"])
        logs = [log] if isinstance(log, str) else list(log)
        paths, units, ends = [], [], []
        varied: list[Parameter] = []
        for path, given in parameters.items():
            parameter = Parameter(case, path, "parameters", materials_in(case))
            parameter.check_independent(varied)
            varied.append(parameter)
            if not isinstance(given, (tuple, list)) or len(given) != 2:
                raise parameter.wrong("a pair (smallest, largest) is needed", "(0.5, 0.95)", None, given)
            low, high, unit = parameter.ends(*given)
            if parameter.is_whole:
                raise parameter.wrong("a whole number cannot be calibrated", "one call for each value")
            if not low < high or (path in logs and low <= 0):
                least = " and above zero" if path in logs else ""
                raise parameter.wrong(f"the first value must be the smaller one{least}", "", None, given)
            paths.append(path)
            units.append(unit)
            ends.append((low, high))
        for path in logs:
            if path not in paths:
                raise Hint(f"log = {path!r} is not one of the parameters", nearest(str(path), paths))
        low_ends, high_ends = np.array(ends, float).T
        return cls(paths, units, low_ends, high_ends, np.isin(paths, logs), _known(known or {}, paths, units))

    @property
    def size(self) -> int:
        """Number of parameters."""
        return len(self.paths)

    @property
    def corners(self) -> tuple[FloatArray, FloatArray]:
        """The corners of the whole space, zeros and ones."""
        return np.zeros(self.size), np.ones(self.size)

    def values(self, points: FloatArray) -> FloatArray:
        """Return the parameters at points (..., d)."""
        linear = self.low + points * (self.high - self.low)
        if not self.is_log.any():
            return linear
        low, high = (np.where(self.is_log, end, 1.0) for end in (self.low, self.high))
        return np.where(self.is_log, low * (high / low) ** points, linear)

    def points(self, values: FloatArray) -> FloatArray:
        """Return the points (..., d) of parameters."""
        linear = (values - self.low) / (self.high - self.low)
        if not self.is_log.any():
            return linear
        low, high, each = (np.where(self.is_log, end, 2.0) for end in (self.low, self.high, values))
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(self.is_log, np.log(each / np.where(self.is_log, low, 1.0)) / np.log(high / low), linear)

    def value(self, axis: int, point: object) -> FloatArray:
        """Return one parameter at its coordinates, of any shape."""
        each = np.asarray(point, dtype=float)
        return np.asarray(self.values(np.repeat(each[..., None], self.size, axis=-1))[..., axis])

    def priors(self, low: FloatArray, high: FloatArray) -> list[Known]:
        """Return the known parameters in units of the region between two corners."""
        found = []
        for path, (value, half) in self.known.items():
            axis = self.paths.index(path)
            ends = np.tile(self.low, (2, 1))
            ends[:, axis] = value - half, value + half
            if self.is_log[axis]:
                ends[0, axis] = max(ends[0, axis], 1e-3 * value)
            first, last = (self.points(ends)[:, axis] - low[axis]) / (high[axis] - low[axis])
            found.append(Known(axis, float(first + last) / 2, float(last - first) / (2 * NORMAL)))
        return found

    def ranges(self, low: FloatArray, high: FloatArray) -> dict[str, tuple[float, float]]:
        """Return the smallest and largest values of the region between two corners, by path."""
        ends = zip(self.paths, self.values(low).tolist(), self.values(high).tolist(), strict=True)
        return {path: (first, last) for path, first, last in ends}


def _known(given: object, paths: list[str], units: list[str]) -> dict[str, tuple[float, float]]:
    """Return values and half widths of known parameters in SI units."""
    example = '{"damper.contact.restitution": (0.80, 0.02)}'
    if not isinstance(given, Mapping):
        raise Hint(
            "a mapping of paths to pairs (value, half of the width of the interval) is needed", example, ["known"]
        )
    found = {}
    for path, pair in given.items():
        with at("known"):
            if path not in paths:
                raise Hint(f"{path!r} is not one of the parameters", nearest(str(path), paths))
            if not isinstance(pair, (tuple, list)) or len(pair) != 2:
                raise Hint(
                    f"{path}: {pair!r:.60} is not a pair (value, half of the width of its 95 % interval)", example
                )
        unit = units[paths.index(path)]
        value, half = read_column(
            ("known", path), list(pair), () if unit == "1" else (unit,), -math.inf
        ).values.tolist()
        if not half > 0:
            raise Hint(f"half of the width, {half:g}, is not greater than zero", example, ["known", path])
        found[path] = value, half
    return found


# ---- fit


_CORRELATED = 0.8
"""Correlation of two parameters above which the data do not separate them, if both are wide."""
_WIDE = 0.2
"""Share of its range above which the interval of a parameter is wide."""
_FLAT = 0.25
"""Share of the threshold below which the data do not depend on a parameter."""
_UNLIKELY = 0.01
"""Probability of the data below which the model does not explain them."""
_KEPT = 20.0
"""chi^2 above its minimum up to which parameters stay in the next round."""
_MARGIN = 0.15
"""Share of its width by which the region of the next round is enlarged at each end."""
_WORTHWHILE = 0.7
"""Share of the region that the next round must leave; otherwise it has the same region."""


@dataclass(frozen=True, eq=False)
class Fit:
    """Fit of simulated to measured values in a region of the space."""

    space: Space
    low: FloatArray  # Corners of the region, as points of the space, (d,)
    high: FloatArray
    agreement: Agreement

    @classmethod
    def of(
        cls,
        space: Space,
        corners: tuple[FloatArray, FloatArray],
        points: FloatArray,
        simulated: FloatArray,
        measured: FloatArray,
        error: FloatArray,
        sets: NDArray[np.int64],
    ) -> Fit:
        """Return the fit to simulated values.

        `points`: points of the space in the region, (N, d). `simulated`: values at these points, (N, M).
        """
        low, high = corners
        surfaces = Surfaces.fit((points - low) / (high - low), simulated)
        return cls(space, low, high, Agreement(surfaces, measured, error, sets, space.priors(low, high)))

    @cached_property
    def region(self) -> Region:
        """chi^2 on a grid over the plausible part of the region."""
        return self.agreement.explore()

    @cached_property
    def threshold(self) -> float:
        """chi^2 above its minimum at the limits of the 95 % intervals."""
        return float(fdtri(1, self.agreement.surfaces.freedom, 0.95))

    @cached_property
    def scatter(self) -> FloatArray:
        """Standard deviation of a simulated value about its surface, (M,)."""
        return np.asarray(np.sqrt((self.agreement.surfaces.errors**2).mean(axis=0)))

    @property
    def best(self) -> FloatArray:
        """Parameters of the smallest chi^2, (d,)."""
        return np.asarray(self.space.values(self.low + (self.high - self.low) * self.region.best))

    @cached_property
    def fitted(self) -> FloatArray:
        """Values of the surfaces at the best parameters, (M,)."""
        return np.asarray(self.agreement.surfaces.evaluate(self.region.best[None])[0])

    @cached_property
    def limits(self) -> FloatArray:
        """Limits of the 95 % intervals as points of the space, (d, 2)."""
        ends = np.array([self.region.limits(axis, self.threshold) for axis in range(self.space.size)])
        return np.asarray(self.low[:, None] + (self.high - self.low)[:, None] * ends)

    @property
    def intervals(self) -> FloatArray:
        """Limits of the 95 % intervals of the parameters, (d, 2)."""
        return np.stack([self.space.value(axis, ends) for axis, ends in enumerate(self.limits)])

    @cached_property
    def bounded(self) -> NDArray[np.bool_]:
        """Whether the data bound each parameter below and above within its range, (d, 2)."""
        return np.stack([self.limits[:, 0] > 1e-6, self.limits[:, 1] < 1 - 1e-6], axis=1)

    @cached_property
    def chi2(self) -> float:
        """Smallest chi^2."""
        return float(self.region.chi2.min())

    @property
    def freedom(self) -> int:
        """Degrees of freedom of chi^2."""
        return self.agreement.measured.size + len(self.space.known) - self.space.size

    @property
    def probability(self) -> float:
        """Probability of a larger chi^2 if the model is right; NaN without degrees of freedom."""
        return float(chdtrc(self.freedom, self.chi2)) if self.freedom > 0 else math.nan

    def along(self, axis: int, places: FloatArray) -> FloatArray:
        """Return values of a parameter from coordinates in the region."""
        return self.space.value(axis, self.low[axis] + (self.high - self.low)[axis] * places)

    def narrowed(self) -> tuple[FloatArray, FloatArray]:
        """Return the corners of the region of the next round."""
        low, high = self.low.copy(), self.high.copy()
        width = high - low
        for axis in range(self.space.size):
            inside = np.flatnonzero(self.region.profile(axis) <= _KEPT)
            first, last = self.region.axes[axis][inside[0]], self.region.axes[axis][inside[-1]]
            margin = max(_MARGIN * (last - first), 0.02)
            low[axis] = self.low[axis] + width[axis] * max(first - margin, 0.0)
            high[axis] = self.low[axis] + width[axis] * min(last + margin, 1.0)
        if np.prod(high - low) > _WORTHWHILE * np.prod(width):
            return self.low, self.high
        return low, high

    # ---- statements

    def undetermined(self) -> Iterator[str]:
        """Yield statements about parameters that the data do not determine or separate."""
        for axis, path in enumerate(self.space.paths):
            below, above = self.bounded[axis]
            if below and above:
                continue
            if below or above:
                side, end = ("above", self.space.high) if below else ("below", self.space.low)
                yield (
                    f"warning: the data do not bound {path} {side}: its interval ends at the end of the range, "
                    f"{amount(float(end[axis]), self.space.units[axis])}"
                )
            elif float(self.region.profile(axis).max()) < _FLAT * self.threshold:
                yield f"warning: the data do not depend on {path}: any value in its range fits"
            else:
                yield f"warning: the data do not bound {path} within its range; try: further data, or a wider range"
        widths = self.limits[:, 1] - self.limits[:, 0]
        for i, j in itertools.combinations(range(self.space.size), 2):
            if abs(self.region.correlation[i, j]) > _CORRELATED and min(widths[i], widths[j]) > _WIDE:
                yield self._not_separate(i, j)

    def _not_separate(self, i: int, j: int) -> str:
        """Return a statement about two parameters that the data do not separate."""
        one, other = self.space.paths[i], self.space.paths[j]
        correlation = float(self.region.correlation[i, j])
        line = (
            f"warning: the data cannot separate {one} and {other}: a larger {one} with a "
            f"{'larger' if correlation > 0 else 'smaller'} {other} gives the same losses (correlation {correlation:.2f})"
        )
        if not (self.space.is_log[i] or self.space.is_log[j]):
            factor, value, half = self.combination(i, j)
            unit = self.space.units[i].removeprefix("1")
            sign = "+" if factor > 0 else "-"
            line += f"; determined is {one} {sign} {abs(factor):.2g} {other} = {value:.3g} ± {half:.2g} {unit}".rstrip()
        return line + "; try: one of them from another measurement, such as rb.Drops, as known"

    def combination(self, i: int, j: int) -> tuple[float, float, float]:
        """Return the best-known sum of two parameters p_i + k p_j: k, its value and half of the width of its interval."""
        factor, mean, deviation = self.region.combination(i, j)
        scale = (self.high - self.low) * (self.space.high - self.space.low)
        origin = self.space.low + self.low * (self.space.high - self.space.low)
        ratio = factor * scale[i] / scale[j]
        value = origin[i] + ratio * origin[j] + mean * scale[i]
        return float(ratio), float(value), float(NORMAL * deviation * scale[i])

    def cut(self) -> Iterator[str]:
        """Yield a warning for each parameter whose interval ends where the samples end, within its range."""
        for axis, path in enumerate(self.space.paths):
            edges = ((self.limits[axis, 0], self.low[axis], 0.0), (self.limits[axis, 1], self.high[axis], 1.0))
            if any(abs(limit - edge) < 1e-6 and abs(edge - end) > 1e-6 for limit, edge, end in edges):
                yield (
                    f"warning: the interval of {path} ends at the region of the last samples, and may be too narrow; "
                    "try: more runs"
                )

    def disagreement(self) -> Iterator[str]:
        """Yield a warning if the model does not explain the data, or nothing shows whether it does."""
        if self.freedom < 1:
            yield (
                "warning: as many parameters as data, so that nothing shows whether the model explains them; try: losses at "
                "more amplitudes"
            )
        elif self.probability < _UNLIKELY:
            yield (
                f"warning: no parameters in these ranges explain the data: chi^2 is {self.chi2:.3g} with {self.freedom} "
                "degrees of freedom, and the intervals are not valid; try: wider ranges, larger uncertainties, or a case "
                "that is closer to the experiment (damping without particles, fill, direction, softening)"
            )
