"""Response surfaces through scattered results of simulations, and the parameters at which they agree with measurements."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

HIGHEST_DEGREE = 3
"""Highest degree of a surface."""
_POINTS_PER_TERM = 4
"""Smallest number of points for each coefficient of a surface."""
_GRID = {1: 2001, 2: 201, 3: 61}
"""Number of grid points along each parameter, by the number of parameters."""
_ZOOMS = 6
"""Largest number of times that the grid is narrowed to the plausible region."""
_TAIL = 16.0
"""Difference of chi^2 from its minimum up to which the grid is kept."""


def least_points(parameters: int) -> int:
    """Return the smallest number of points for a quadratic surface with a useful estimate of its errors."""
    return _POINTS_PER_TERM * math.comb(parameters + 2, 2)


@dataclass(frozen=True, eq=False)
class Surfaces:
    """Polynomials in the parameters, one for each of M results."""

    powers: NDArray[np.int64]  # Powers of the parameters in each term, (T, d)
    coefficients: FloatArray  # Coefficients; those of terms above the degree of a polynomial are zero, (T, M)
    errors: FloatArray  # Differences of the results from the polynomials through all other points, (N, M)
    freedom: int

    @classmethod
    def fit(cls, points: FloatArray, values: FloatArray) -> Surfaces:
        """Return the polynomials of the degree, 1 to 3, with the smallest leave-one-out errors, by least squares.

        `points`: parameters over their ranges, 0 to 1, (N, d). `values`: results, (N, M).

        Notes
        -----
        The polynomial through all other points differs from a result by e_i / (1 - h_i), with the residual e_i and the
        leverage h_i of its point.

        References
        ----------
        D. M. Allen (1974), The relationship between variable selection and data augmentation and a method for prediction,
        Technometrics 16, 125-127, doi:10.1080/00401706.1974.10489157.
        """
        count, width = points.shape
        powers = _powers(width)
        coefficients, errors = np.zeros((len(powers), values.shape[1])), np.full(values.shape, np.inf)
        terms = np.zeros(values.shape[1], int)
        degrees = powers.sum(axis=1)
        for degree in range(1, HIGHEST_DEGREE + 1):
            used = np.flatnonzero(degrees <= degree)
            if count < _POINTS_PER_TERM * used.size and degree > 1:
                break
            basis = _basis(points, powers[used])
            q, r = np.linalg.qr(basis)
            leverage = (q**2).sum(axis=1)
            rest = (values - q @ (q.T @ values)) / (1 - np.minimum(leverage, 0.999))[:, None]
            better = (rest**2).sum(axis=0) < (errors**2).sum(axis=0)
            solved = np.linalg.solve(r, q.T @ values)
            coefficients[:, better] = 0.0
            coefficients[np.ix_(used, better)] = solved[:, better]
            errors[:, better] = rest[:, better]
            terms[better] = used.size
        return cls(powers, coefficients, errors, count - int(terms.max()))

    def evaluate(self, points: FloatArray) -> FloatArray:
        """Return the polynomials at points (G, d), as an array (G, M)."""
        return np.asarray(_basis(points, self.powers) @ self.coefficients)


def _powers(width: int) -> NDArray[np.int64]:
    every = itertools.product(range(HIGHEST_DEGREE + 1), repeat=width)
    return np.array(sorted((each for each in every if sum(each) <= HIGHEST_DEGREE), key=lambda each: (sum(each), each)))


def _basis(points: FloatArray, powers: NDArray[np.int64]) -> FloatArray:
    centred = 2 * points - 1
    return np.asarray(np.prod(centred[:, None, :] ** powers[None], axis=2))


class Known(NamedTuple):
    """Number of a parameter that is known from elsewhere, its value in units of its range, and its standard deviation."""

    parameter: int
    value: float
    deviation: float


@dataclass(frozen=True, eq=False)
class Agreement:
    """Agreement of surfaces with measurements, chi^2 over the parameters."""

    surfaces: Surfaces
    measured: FloatArray  # Measured values, and their standard uncertainties, (M,)
    error: FloatArray
    # Number of the measurement to which each value belongs. Simulated values of a measurement scatter together, (M,)
    sets: NDArray[np.int64]
    known: Sequence[Known] = ()

    @cached_property
    def covariance(self) -> FloatArray:
        """Covariance of measured minus simulated values, (M, M).

        The measured damper and each simulated one have random packings of their own: the leave-one-out errors of the
        surfaces contain this scatter, and also the error of the surfaces. The covariance of n errors of m values is enlarged
        by n / (n - m - 1), the factor by which the mean of its inverse is too large.

        References
        ----------
        J. Hartlap, P. Simon, P. Schneider (2007), Astronomy & Astrophysics 464, 399-404, doi:10.1051/0004-6361:20066170.
        """
        errors, freedom = self.surfaces.errors, self.surfaces.freedom
        result = np.diag(self.error**2)
        for number in np.unique(self.sets):
            own = np.flatnonzero(self.sets == number)
            scatter = errors[:, own].T @ errors[:, own] / len(errors)
            result[np.ix_(own, own)] += scatter * freedom / (freedom - own.size - 1)
        return result

    @cached_property
    def _whitening(self) -> FloatArray:
        inverse: FloatArray = np.linalg.inv(np.linalg.cholesky(self.covariance))
        return inverse

    def data_term(self, points: FloatArray) -> FloatArray:
        """Return chi^2 of the measurements at points (G, d)."""
        rest = (self.surfaces.evaluate(points) - self.measured) @ self._whitening.T
        return np.asarray((rest**2).sum(axis=1))

    def evaluate(self, points: FloatArray) -> FloatArray:
        """Return chi^2 of the measurements and of the known parameters at points (G, d)."""
        total = self.data_term(points)
        for each in self.known:
            total = total + ((points[:, each.parameter] - each.value) / each.deviation) ** 2
        return total

    def explore(self) -> Region:
        """Return chi^2 on a grid over all plausible parameters."""
        width = self.surfaces.powers.shape[1]
        # A grid over the whole range would miss a narrow valley: zoom to where chi^2 is small until that no longer helps.
        low, high = np.zeros(width), np.ones(width)
        for _ in range(_ZOOMS):
            region = Region.of(self, low, high)
            inside = region.chi2 <= region.chi2.min() + _TAIL
            new_low, new_high = low.copy(), high.copy()
            for axis in range(width):
                used = np.flatnonzero(inside.any(axis=tuple(each for each in range(width) if each != axis)))
                axes = region.axes[axis]
                new_low[axis] = axes[max(used[0] - 1, 0)]
                new_high[axis] = axes[min(used[-1] + 1, axes.size - 1)]
            if ((new_high - new_low) > 0.8 * (high - low)).all():
                return region
            low, high = new_low, new_high
        return region


@dataclass(frozen=True, eq=False)
class Region:
    """chi^2 on a grid."""

    axes: list[FloatArray]  # Grid along each parameter, in units of its range
    chi2: FloatArray  # chi^2, (K, ...)

    @classmethod
    def of(cls, agreement: Agreement, low: FloatArray, high: FloatArray) -> Region:
        """Return chi^2 on a grid between two corners."""
        count = _GRID[low.size]
        axes = [np.linspace(a, b, count) for a, b in zip(low, high, strict=True)]
        points = np.stack([each.ravel() for each in np.meshgrid(*axes, indexing="ij")], axis=1)
        return cls(axes, agreement.evaluate(points).reshape((count,) * low.size))

    @cached_property
    def best(self) -> FloatArray:
        """Parameters of the smallest chi^2, (d,)."""
        place = np.unravel_index(int(np.argmin(self.chi2)), self.chi2.shape)
        return np.array([axis[k] for axis, k in zip(self.axes, place, strict=True)])

    def profile(self, index: int) -> FloatArray:
        """Return the smallest chi^2 over all other parameters, minus the minimum, (K,)."""
        others = tuple(each for each in range(self.chi2.ndim) if each != index)
        return np.asarray(self.chi2.min(axis=others) - self.chi2.min())

    def limits(self, index: int, threshold: float) -> tuple[float, float]:
        """Return the limits of the interval in which the profile of a parameter is below a threshold.

        References
        ----------
        D. J. Venzon, S. H. Moolgavkar (1988), Journal of the Royal Statistical Society C 37, 87-94, doi:10.2307/2347496.
        """
        profile, axis = self.profile(index), self.axes[index]
        inside = np.flatnonzero(profile <= threshold)
        ends = []
        for edge, beyond in ((int(inside[0]), int(inside[0]) - 1), (int(inside[-1]), int(inside[-1]) + 1)):
            if 0 <= beyond < axis.size:
                share = (threshold - profile[edge]) / (profile[beyond] - profile[edge])
                ends.append(float(axis[edge] + share * (axis[beyond] - axis[edge])))
            else:
                ends.append(float(axis[edge]))
        return ends[0], ends[1]

    @cached_property
    def moments(self) -> tuple[FloatArray, FloatArray]:
        """Mean (d,) and covariance (d, d) of the parameters, weighted with exp(-chi^2 / 2)."""
        weights = np.exp(-(self.chi2 - self.chi2.min()) / 2)
        weights /= weights.sum()
        width = self.chi2.ndim
        mean, covariance = np.zeros(width), np.zeros((width, width))
        for i in range(width):
            one = weights.sum(axis=tuple(each for each in range(width) if each != i))
            mean[i] = one @ self.axes[i]
            covariance[i, i] = one @ (self.axes[i] - mean[i]) ** 2
        for i, j in itertools.combinations(range(width), 2):
            both = weights.sum(axis=tuple(each for each in range(width) if each not in (i, j)))
            product = (self.axes[i] - mean[i]) @ both @ (self.axes[j] - mean[j])
            covariance[i, j] = covariance[j, i] = product
        return mean, covariance

    @property
    def correlation(self) -> FloatArray:
        """Correlation of the parameters, (d, d)."""
        covariance = self.moments[1]
        deviation = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
        return np.asarray(covariance / np.outer(deviation, deviation))

    def combination(self, i: int, j: int) -> tuple[float, float, float]:
        """Return the best-known sum of two parameters, u_i + k u_j."""
        mean, covariance = self.moments
        pair = covariance[np.ix_((i, j), (i, j))]
        first, second = np.linalg.eigh(pair)[1][:, 0]
        factor = float(second / first) if first else math.inf
        direction = np.array([1.0, factor])
        return factor, float(direction @ mean[[i, j]]), math.sqrt(max(0.0, float(direction @ pair @ direction)))
