"""How values are chosen, told without a case: evenly spaced, at random, nearly the same."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.errors import Hint, nearest
from rattlebox.model.units import are_alike, as_written, whole_number

Vector = NDArray[np.float64]
Method = Literal["sobol", "halton", "lhs", "random"]
_SOBOL_DIMENSIONS = 21201


@dataclass(frozen=True)
class Spaced:
    """Values from one quantity to another; see linspace and geomspace."""

    start: Any
    stop: Any
    count: int
    log: bool = False
    names: tuple[str, str] = ("start", "stop")  # of the ends, for messages

    def values(self, start: float, stop: float) -> Vector:
        """Return the values between the ends in SI, (count,).

        Raises
        ------
        Hint
            When they grow by a factor, but an end is zero or the signs differ.
        """
        if not self.log:
            return np.linspace(start, stop, self.count)
        if not start * stop > 0:
            raise Hint("values that grow by a factor need two ends other than zero, of one sign", "equal steps")
        return np.geomspace(start, stop, self.count)


def linspace(start: Any, stop: Any, count: int) -> Spaced:
    """Evenly spaced values of a parameter, ends included.

    Parameters
    ----------
    start, stop
        Ends: numbers in SI or text with a unit.
    count
        How many.

    Raises
    ------
    CaseError
        When count is no whole number of at least 1, or the ends are not of one dimension.

    Examples
    --------
    >>> axes = {"damper.gap": linspace("0.1 mm", "2 mm", 200)}
    """
    return _spaced(start, stop, count)


def geomspace(start: Any, stop: Any, count: int) -> Spaced:
    """Values of a parameter that grow by the same factor from each to the next, ends included.

    Parameters
    ----------
    start, stop
        Ends, other than zero and of one sign: numbers in SI or text with a unit.
    count
        How many.

    Raises
    ------
    CaseError
        When count is no whole number of at least 1, or the ends are not of one dimension, of one sign and other than zero.

    Examples
    --------
    >>> axes = {"load.amplitude": geomspace("10 N", "10 kN", 61)}
    """
    return _spaced(start, stop, count, log=True)


def _spaced(start: Any, stop: Any, count: Any, *, log: bool = False) -> Spaced:
    """Values of which all is told that can be known without a parameter."""
    low, high = as_written(start), as_written(stop)
    if low and high:
        (first, unit), (last, other) = low, high
        told = f"start = {start!r}, stop = {stop!r}"
        if unit and other and not are_alike(unit, other):
            raise Hint(f"{told}: ends of one dimension are needed")
        if log and not np.sign(first) * np.sign(last) > 0:
            raise Hint(f"{told}: values that grow by a factor need ends other than zero, of one sign", "equal steps")
    return Spaced(start, stop, whole_number(count, "count", 1), log)


@dataclass(frozen=True)
class RandomDesign:
    """Points spread over ranges of several parameters; see random_design."""

    ranges: Mapping[str, Any]
    count: int
    method: Method
    seed: int
    log: tuple[str, ...]

    def points(self) -> Vector:
        """Return the points in the unit cube, (count, parameters), each coordinate in [0, 1)."""
        from scipy.stats import qmc

        width = len(self.ranges)
        if self.method == "sobol":  # a power of two keeps them balanced, and leaves the first ones as they are
            return qmc.Sobol(width, rng=self.seed).random_base2((self.count - 1).bit_length())[: self.count]
        if self.method == "halton":
            return qmc.Halton(width, rng=self.seed).random(self.count)
        if self.method == "lhs":
            return _stratified(width, self.count, self.seed)
        return np.random.default_rng(self.seed).random((self.count, width))


def random_design(
    ranges: Mapping[str, Any],
    count: int,
    *,
    method: Method = "sobol",
    seed: int = 0,
    log: Sequence[str] = (),
) -> RandomDesign:
    """Spread points over ranges of parameters that vary together, along one dimension "sample".

    Parameters
    ----------
    ranges
        By path: a pair (smallest, largest) of numbers in SI or text with units; a list to choose from where the
        parameter is no number, such as materials.
    count
        Number of points; with "sobol" best a power of two.
    method
        "sobol" or "halton" (scrambled quasi-random points), "lhs" (Latin hypercube), "random" (independent points).
    seed
        The same seed gives the same points.
    log
        Paths whose values are spread evenly in their logarithm.

    Raises
    ------
    CaseError
        When an argument does not fit. Ranges are read when the case is known.

    Examples
    --------
    >>> axes = random_design({"damper.gap": ("0.1 mm", "2 mm"), "load.amplitude": ("1 kN", "5 kN")}, 1024)
    """
    _by_path(ranges, "ranges", '{"damper.gap": ("0.1 mm", "2 mm")}')
    if method not in get_args(Method):
        raise Hint(f"method = {method!r}: there is no such method", nearest(str(method), get_args(Method)))
    if method == "sobol" and len(ranges) > _SOBOL_DIMENSIONS:
        raise Hint(f"Sobol points vary at most {_SOBOL_DIMENSIONS} parameters, not {len(ranges)}", 'method = "lhs"')
    paths = (log,) if isinstance(log, str) else tuple(log)
    for path in paths:
        if path not in ranges:
            raise Hint(f"log = {path!r}: there is no range of that name", nearest(path, ranges))
    return RandomDesign(dict(ranges), whole_number(count, "count", 1), method, whole_number(seed, "seed", 0), paths)


@dataclass(frozen=True)
class Replicas:
    """Members that differ a little; see replicas."""

    reach: Mapping[str, Any]
    count: int
    seed: int

    def offsets(self) -> Vector:
        """Return offsets as parts of the reach, (count, parameters), each in [-1, 1)."""
        return 2 * _stratified(len(self.reach), self.count, self.seed) - 1


def replicas(reach: Mapping[str, Any], count: int, *, seed: int = 0) -> Replicas:
    """Repeat each variant with small offsets, along a dimension "replica": the band of a chaotic result.

    Offsets are spread evenly over the reach to both sides, the same for every variant. They are added to the value that the
    case or another axis gives. Start positions beyond a wall of the cavity are mirrored at it.

    Parameters
    ----------
    reach
        By path: the largest offset, a number in SI or text with a unit.
    count
        Number of replicas.
    seed
        The same seed gives the same offsets.

    Raises
    ------
    CaseError
        When an argument does not fit. Offsets are read when the case is known.

    Examples
    --------
    >>> axes = [{"damper.gap": linspace("0.1 mm", "2 mm", 20)}, replicas({"damper.start": "1 um"}, 64)]
    """
    _by_path(reach, "reach", '{"damper.start": "1 um"}')
    return Replicas(dict(reach), whole_number(count, "count", 1), whole_number(seed, "seed", 0))


def _stratified(width: int, count: int, seed: int) -> Vector:
    from scipy.stats import qmc

    return qmc.LatinHypercube(width, rng=seed).random(count)


def _by_path(values: Any, name: str, example: str) -> None:
    if not isinstance(values, Mapping) or not values:
        raise Hint(f"{name}: paths with values are needed", example)
