"""Choices of values that do not depend on a case: evenly spaced, random designs, replicas."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.errors import Hint, nearest
from rattlebox.model.units import Quantity, are_alike, as_written, whole_number

Vector = NDArray[np.float64]
Method = Literal["sobol", "halton", "lhs", "random"]
_SOBOL_DIMENSIONS = 21201


MOST_VARIANTS = 10**8
"""Most values of an axis and most variants of a study; the results of one measure then take 1 GB."""


def number_of_variants(value: object, name: str = "count") -> int:
    """Return a number of values or variants."""
    count = whole_number(value, name, 1)
    if count > MOST_VARIANTS:
        raise Hint(
            f"{name} = {count:.3g}: a study has at most {MOST_VARIANTS:.0e} variants",
            "fewer values, or several studies",
        )
    return count


@dataclass(frozen=True)
class Spaced:
    """Values between two quantities; see `linspace` and `geomspace`."""

    start: Any
    stop: Any
    count: int
    log: bool = False
    names: tuple[str, str] = ("start", "stop")  # names of the ends in messages

    def values(self, start: float, stop: float) -> Vector:
        """Return the values between two ends in SI units, (count,)."""
        count = number_of_variants(self.count)  # also of study files
        if not self.log:
            return np.linspace(start, stop, count)
        if not start * stop > 0:
            raise Hint("the ends of geometric spacing must not be zero and must have the same sign", "linear spacing")
        return np.geomspace(start, stop, count)


def numbers_in(given: Spaced | Iterable[Any], read: Callable[[Any], float]) -> Vector:
    """Return the numbers that `read` gives for values, or the numbers between those of the ends."""
    if isinstance(given, Spaced):
        return given.values(read(given.start), read(given.stop))
    return np.array([read(value) for value in given], dtype=np.float64)


def linspace(start: Quantity, stop: Quantity, count: int) -> Spaced:
    """Return evenly spaced values of a parameter, start + (stop - start) k / (count - 1), k = 0 ... count - 1.

    Parameters
    ----------
    start, stop
        Ends: numbers in SI units, or text with a unit.
    count
        Number of values.

    Returns
    -------
    Spaced
        Values for an axis of a study.

    Raises
    ------
    CaseError
        If `count` is not a whole number >= 1, or the dimensions of the ends differ.

    Examples
    --------
    >>> axes = {"damper.gap": linspace("0.1 mm", "2 mm", 200)}
    """
    return _spaced(start, stop, count)


def geomspace(start: Quantity, stop: Quantity, count: int) -> Spaced:
    """Return geometrically spaced values of a parameter, start (stop / start)^(k / (count - 1)), k = 0 ... count - 1.

    Parameters
    ----------
    start, stop
        Ends, not zero and of the same sign: numbers in SI units, or text with a unit.
    count
        Number of values.

    Returns
    -------
    Spaced
        Values for an axis of a study.

    Raises
    ------
    CaseError
        If `count` is not a whole number >= 1, or the ends differ in dimension or sign, or are zero.

    Examples
    --------
    >>> axes = {"load.amplitude": geomspace("10 N", "10 kN", 61)}
    """
    return _spaced(start, stop, count, log=True)


def _spaced(start: object, stop: object, count: object, *, log: bool = False) -> Spaced:
    """Return spaced values, after the checks that do not need the parameter."""
    low, high = as_written(start), as_written(stop)
    if low and high:
        (first, unit), (last, other) = low, high
        ends = f"start = {start!r}, stop = {stop!r}"
        if unit and other and not are_alike(unit, other):
            raise Hint(f"{ends}: the dimensions of the ends differ", "ends with the same unit")
        if log and not np.sign(first) * np.sign(last) > 0:
            raise Hint(
                f"{ends}: the ends of geometric spacing must not be zero and must have the same sign", "linear spacing"
            )
    return Spaced(start, stop, number_of_variants(count), log)


@dataclass(frozen=True)
class RandomDesign:
    """Points in the ranges of several parameters; see `random_design`."""

    ranges: Mapping[str, Any]
    count: int
    method: Method
    seed: int
    log: tuple[str, ...]

    def points(self) -> Vector:
        """Return the points in the unit cube, (count, parameters), each coordinate in [0, 1)."""
        from scipy.stats import qmc

        width = len(self.ranges)
        if self.method == "sobol":  # Sobol points are balanced for powers of two only
            return qmc.Sobol(width, rng=self.seed).random_base2((self.count - 1).bit_length())[: self.count]
        if self.method == "halton":
            return qmc.Halton(width, rng=self.seed).random(self.count)
        if self.method == "lhs":
            return _stratified(width, self.count, self.seed)
        return np.random.default_rng(self.seed).random((self.count, width))


def random_design(
    ranges: Mapping[str, object],
    count: int,
    *,
    method: Method = "sobol",
    seed: int = 0,
    log: Sequence[str] = (),
) -> RandomDesign:
    """Return points in the ranges of parameters that vary together, along the dimension "sample".

    Parameters
    ----------
    ranges
        By path: a pair (smallest, largest) of numbers in SI units or text with units; or a list to choose from if the
        parameter is not a number, such as a material.
    count
        Number of points; for "sobol" preferably a power of two.
    method
        "sobol" or "halton" (scrambled quasi-random points), "lhs" (Latin hypercube), "random" (independent points).
    seed
        Random seed.
    log
        Paths whose values are distributed uniformly in the logarithm.

    Returns
    -------
    RandomDesign
        Axis of a study.

    Raises
    ------
    CaseError
        If an argument is not valid. The study validates the ranges.

    References
    ----------
    I. M. Sobol' (1967), On the distribution of points in a cube and the approximate evaluation of integrals, USSR
    Computational Mathematics and Mathematical Physics 7(4), 86-112, doi:10.1016/0041-5553(67)90144-9.
    J. H. Halton (1960), On the efficiency of certain quasi-random sequences of points in evaluating multi-dimensional
    integrals, Numerische Mathematik 2, 84-90, doi:10.1007/BF01386213.
    M. D. McKay, R. J. Beckman, W. J. Conover (1979), A comparison of three methods for selecting values of input variables
    in the analysis of output from a computer code, Technometrics 21(2), 239-245, doi:10.2307/1268522.

    Examples
    --------
    >>> axes = random_design({"damper.gap": ("0.1 mm", "2 mm"), "load.amplitude": ("1 kN", "5 kN")}, 1024)
    """
    _by_path(ranges, "ranges", '{"damper.gap": ("0.1 mm", "2 mm")}')
    if method not in get_args(Method):
        raise Hint(f"method = {method!r} is not a method", nearest(str(method), get_args(Method)))
    if method == "sobol" and len(ranges) > _SOBOL_DIMENSIONS:
        raise Hint(
            f"{len(ranges)} parameters are too many for Sobol points, at most {_SOBOL_DIMENSIONS}", 'method = "lhs"'
        )
    paths = (log,) if isinstance(log, str) else tuple(log)
    for path in paths:
        if path not in ranges:
            raise Hint(f"log = {path!r} is not one of the ranges", nearest(path, ranges))
    return RandomDesign(dict(ranges), number_of_variants(count), method, whole_number(seed, "seed", 0), paths)


@dataclass(frozen=True)
class Replicas:
    """Repeated variants with small offsets; see `replicas`."""

    reach: Mapping[str, Any]
    count: int
    seed: int

    def offsets(self) -> Vector:
        """Return offsets over the reach, (count, parameters), each in [-1, 1)."""
        return 2 * _stratified(len(self.reach), self.count, self.seed) - 1


def replicas(reach: Mapping[str, object], count: int, *, seed: int = 0) -> Replicas:
    """Repeat each variant with small offsets, along the dimension "replica", to estimate the scatter of chaotic results.

    The offsets are a Latin hypercube sample (see `random_design`) between -reach and +reach, the same for every variant.
    They are added to the value of the case or of another axis. Start positions beyond a wall of the cavity are mirrored at
    the wall.

    Parameters
    ----------
    reach
        Largest offset by path: a number in SI units, or text with a unit.
    count
        Number of replicas.
    seed
        Random seed.

    Returns
    -------
    Replicas
        Axis of a study.

    Raises
    ------
    CaseError
        If an argument is not valid. The study validates the offsets.

    Examples
    --------
    >>> axes = [{"damper.gap": linspace("0.1 mm", "2 mm", 20)}, replicas({"damper.start": "1 um"}, 64)]
    """
    _by_path(reach, "reach", '{"damper.start": "1 um"}')
    return Replicas(dict(reach), number_of_variants(count), whole_number(seed, "seed", 0))


def _stratified(width: int, count: int, seed: int) -> Vector:
    from scipy.stats import qmc

    return qmc.LatinHypercube(width, rng=seed).random(count)


def _by_path(values: object, name: str, example: str) -> None:
    if not isinstance(values, Mapping) or not values:
        raise Hint(f"{name} is not a mapping of paths to values, or is empty", example)
