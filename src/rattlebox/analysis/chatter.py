"""Stability limit of cutting from a frequency response: depth of cut and lobes, with all branches.

Orthogonal cutting with the force Ks b (h + y(t - T) - y(t)) on a tool with the directional response G is stable as long as
all roots of 1 + Ks b (1 - exp(-s T)) G(s) = 0 have negative real parts. A root s = i w on the imaginary axis needs a real
depth b = -1 / (2 Ks Re G(i w)), hence Re G < 0, and the period T with exp(-i w T) = -conj(G) / G.

References
----------
J. Tlusty, M. Polacek (1963), The stability of machine tools against self-excited vibrations in machining, ASME International
Research in Production Engineering, 465-474.
Y. Altintas (2012), Manufacturing Automation, 2nd ed., Cambridge University Press, chapter 4, doi:10.1017/CBO9780511843723.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.narrow import unmasked

from .signals import FloatArray

ComplexArray = NDArray[np.complex128]
Response = Callable[[FloatArray], ComplexArray]
"""Function that returns a directional response [m/N] at angular frequencies [rad/s]; NaN where it is unknown."""

_TURN = 0.05  # largest change of the phase between two frequencies [rad]
_CHANGE = 0.2  # largest relative change of the response
_MOST = 200_000  # frequencies
_PASSES = 40
_ROOT_STEPS = 100
_NEAR = 0.01  # of the smallest sample: two resonances of a sampled response may change their order between the samples
_MARGIN = 1.3  # of the depths at the ends of an interval, when roots are chosen that may have the smallest depth


def minimum_real_part(frequency: FloatArray, response: ComplexArray) -> float:
    """Return the smallest real part of a sampled frequency response.

    A tool with this response is stable at all spindle speeds up to the depth of cut b = -1 / (2 Ks min Re G).

    Parameters
    ----------
    frequency : (F,) float
        Rising frequencies [Hz].
    response : (F,) complex
        Displacement over force [m/N], times the directional factor; NaN where it is unknown.

    Returns
    -------
    float
        Minimum of a parabola through the smallest real part and its neighbours [m/N]; NaN if nothing is known.

    Examples
    --------
    >>> import numpy as np
    >>> frequency = np.linspace(50, 150, 2001)
    >>> r = frequency / 100  # stiffness 1 MN/m, damping ratio 2 %
    >>> round(minimum_real_part(frequency, 1e-6 / (1 - r**2 + 0.04j * r)) * 1e6, 4)  # -1 / (4 zeta (1 + zeta))
    -12.2549
    """
    frequency, real = np.asarray(frequency, float), np.asarray(unmasked(response)).real
    if not np.isfinite(real).any():
        return math.nan
    return min(_bottom(frequency, real, int(k)) for k in _candidates(real))


def _candidates(values: FloatArray) -> NDArray[np.intp]:
    """Return the samples next to which the smallest value may be: local minima near the smallest, which is negative."""
    known = np.where(np.isfinite(values), values, np.inf)
    around = np.concatenate([[np.inf], known, [np.inf]])
    near = known <= known.min() + _NEAR * abs(known.min())
    return np.flatnonzero(near & (known <= around[:-2]) & (known <= around[2:]))


def _bottom(frequency: FloatArray, real: FloatArray, k: int) -> float:
    """Return the minimum of a parabola through a sample and its neighbours."""
    if not 0 < k < real.size - 1 or not np.isfinite(real[k - 1 : k + 2]).all():
        return float(real[k])
    x, y = frequency[k - 1 : k + 2] - frequency[k], real[k - 1 : k + 2]
    (left, right), below = (x[0], x[2]), y[1]
    slope, other = (y[0] - below) / left, (y[2] - below) / right
    curvature = (other - slope) / (right - left)
    first = slope - curvature * left
    return float(below - first**2 / (4 * curvature)) if curvature > 0 else float(below)


@dataclass(frozen=True, eq=False)
class SampledResponse:
    """A directional response, sampled so finely that its phase and size change little from one frequency to the next."""

    response: Response
    omega: FloatArray  # Rising angular frequencies [rad/s], (F,)
    values: ComplexArray  # Response there [m/N]; NaN where it is unknown, (F,)

    @classmethod
    def of(cls, response: Response, omega: FloatArray) -> SampledResponse:
        """Sample a response at the given frequencies, and between them where it is large or its real part is negative."""
        omega = np.unique(omega)
        values = response(omega)
        for _ in range(_PASSES):
            with np.errstate(invalid="ignore", divide="ignore"):
                turn = np.abs(np.angle(values[1:] / values[:-1]))
                change = np.abs(values[1:] - values[:-1]) / np.maximum(np.abs(values[1:]), np.abs(values[:-1]))
                used = (values.real[1:] < 0) | (values.real[:-1] < 0)
                size = np.nan_to_num(np.abs(values))
                used |= np.maximum(size[1:], size[:-1]) > 0.5 * size.max(initial=0.0)  # for `largest`
                coarse = used & ((turn > _TURN) | (change > _CHANGE))
                # Where the response ends or changes to another motion, halving stops at rounding.
                coarse &= np.diff(omega) > 1e-9 * omega[1:]
            places = np.flatnonzero(coarse)
            if not places.size or omega.size > _MOST:
                break
            middle = 0.5 * (omega[places] + omega[places + 1])
            omega = np.insert(omega, places + 1, middle)
            values = np.insert(values, places + 1, response(middle))
        return cls(response, omega, values)

    def smallest_real_part(self) -> tuple[float, float]:
        """Return the smallest real part [m/N] and its angular frequency [rad/s]; NaN if it is not negative anywhere."""
        real = self.values.real
        if not (np.isfinite(real) & (real < 0)).any():
            return math.nan, math.nan
        return self._smallest(np.real)

    def largest(self) -> float:
        """Return the largest absolute value [m/N]; 0 if nothing is known."""
        return -self._smallest(lambda values: -np.abs(values))[0] if np.isfinite(self.values).any() else 0.0

    def _smallest(self, measure: Callable[[ComplexArray], FloatArray]) -> tuple[float, float]:
        """Return the smallest value of a measure of the response, and its angular frequency [rad/s]."""
        from scipy.optimize import minimize_scalar

        def value(omega: float) -> float:
            found = float(measure(self.response(np.array([omega])))[0])
            return found if math.isfinite(found) else math.inf

        sampled, last = measure(self.values), self.omega.size - 1
        best = []
        for k in _candidates(sampled):
            low, high = self.omega[max(k - 1, 0)], self.omega[min(k + 1, last)]
            with np.errstate(invalid="ignore"):  # parabolas through infinite values, which the search then ignores
                found = minimize_scalar(value, bounds=(low, high), method="bounded", options={"xatol": 1e-10 * high})
            best += [(float(sampled[k]), float(self.omega[k])), (float(found.fun), float(found.x))]
        return min(best)


@dataclass(frozen=True, eq=False)
class Lobes:
    """Stability limit at N periods of the teeth."""

    # Smallest depth times cutting coefficient b Ks at which a vibration neither grows nor decays [N/m]; infinite if there is
    # none, (N,)
    depth: FloatArray
    omega: FloatArray  # Angular frequency of this vibration [rad/s], (N,)
    # Number of whole waves that it leaves on the surface between two teeth, the number of the lobe; -1 if there is none,
    # (N,)
    waves: NDArray[np.int64]


def stability_lobes(sampled: SampledResponse, period: FloatArray) -> Lobes:
    """Return the stability limit at periods of the teeth [s], (N,)."""
    result = Lobes(np.full(period.size, np.inf), np.full(period.size, np.nan), np.full(period.size, -1))
    omega, real = sampled.omega, sampled.values.real
    with np.errstate(invalid="ignore", divide="ignore"):
        stiffness = np.where(real < 0, -0.5 / real, np.inf)  # b Ks
        turned = np.angle(-sampled.values)  # continuous where the real part is negative
    known = np.isfinite(real)
    usable = known[1:] & known[:-1] & ((real[1:] < 0) | (real[:-1] < 0))
    least, most = np.minimum(stiffness[1:], stiffness[:-1]), np.maximum(stiffness[1:], stiffness[:-1])
    # exp(-i w T) = -conj(G) / G means w T - pi - 2 arg(-G) = 2 pi k: each multiple of 2 pi between the ends of an interval
    # is a root. Only those are computed whose depth may be the smallest one.
    owners, cells, targets = [], [], []
    for number, each in enumerate(period):
        count = np.floor((omega * each - math.pi - 2 * turned) / (2 * math.pi))
        changed = np.flatnonzero(usable & (count[1:] != count[:-1]))
        if not changed.size:
            continue
        near = changed[least[changed] <= _MARGIN * most[changed].min()]
        first = np.minimum(count[near], count[near + 1]).astype(int) + 1
        many = np.abs(count[near + 1] - count[near]).astype(int)
        within = np.arange(many.sum()) - np.repeat(np.cumsum(many) - many, many)
        owners.append(np.full(many.sum(), number))
        cells.append(np.repeat(near, many))
        targets.append(np.repeat(first, many) + within)
    if not owners:
        return result
    owner, cell = np.concatenate(owners), np.concatenate(cells)
    root = _roots(sampled, period[owner], cell, 2 * math.pi * np.concatenate(targets))
    values = sampled.response(root).real
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = np.where(values < 0, -0.5 / values, np.inf)
    order = np.lexsort((depth, owner))
    first = np.flatnonzero(np.diff(owner[order], prepend=-1))
    best = order[first][np.isfinite(depth[order[first]])]
    result.depth[owner[best]], result.omega[owner[best]] = depth[best], root[best]
    result.waves[owner[best]] = np.floor(root[best] * period[owner[best]] / (2 * math.pi)).astype(int)
    return result


def _roots(sampled: SampledResponse, period: FloatArray, cell: NDArray[np.intp], target: FloatArray) -> FloatArray:
    """Return the frequencies in intervals at which w T - pi - 2 arg(-G) has given values (Illinois method)."""

    def value(omega: FloatArray) -> FloatArray:
        return np.asarray(omega * period - math.pi - 2 * np.angle(-sampled.response(omega)) - target)

    low, high = sampled.omega[cell], sampled.omega[cell + 1]
    at_low, at_high = value(low), value(high)
    root, before = low, np.zeros(low.size)
    for step in range(_ROOT_STEPS):
        with np.errstate(divide="ignore", invalid="ignore"):
            root = high - at_high * (high - low) / (at_high - at_low)
        # A step of bisection now and then: false position alone can be slow at a bend of the response.
        inside = np.isfinite(root) & (root >= low) & (root <= high) & (step % 8 != 7)
        root = np.where(inside, root, 0.5 * (low + high))
        here = value(root)
        same = np.sign(here) == np.sign(at_high)
        # The end that stays twice is halved.
        at_low = np.where(same & (before > 0), 0.5 * at_low, at_low)
        at_high = np.where(~same & (before < 0), 0.5 * at_high, at_high)
        low, at_low = np.where(same, low, root), np.where(same, at_low, here)
        high, at_high = np.where(same, root, high), np.where(same, here, at_high)
        before = np.where(same, 1.0, -1.0)
        if np.all((np.abs(here) < 1e-13 * np.maximum(1.0, np.abs(target))) | (high - low < 4e-16 * high)):
            break
    return np.asarray(root)
