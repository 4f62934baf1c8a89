"""Functions of numbers or arrays, with bitwise equal results.

Parts of a case contain numbers. In a batch (see rattlebox.prepare.pack) some of them are arrays that broadcast against each
other, so that the same formulas compute one case or a million; a `float` may then be an array. Vectors have their
components along the first axis.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from itertools import repeat
from typing import Any

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


def _one_by_one(function: Callable[..., float], x: NDArray[Any], *others: Iterable[Any]) -> Any:
    """Apply a function to each number: exponentials and powers of NumPy arrays can differ in the last bit."""
    return np.fromiter(map(function, x.ravel().data, *others), float, x.size).reshape(x.shape)


def power(x: Any, exponent: float) -> Any:
    """Return x ** exponent."""
    return _one_by_one(pow, x, repeat(float(exponent))) if isinstance(x, np.ndarray) else x**exponent


def powers(x: Any, exponents: Any) -> Any:
    """Return x ** exponents; both may be arrays."""
    if not isinstance(exponents, np.ndarray):
        return power(x, exponents)
    x, exponents = np.broadcast_arrays(np.asarray(x, dtype=float), exponents)
    return _one_by_one(pow, x, exponents.ravel().data)


def mapped(function: Callable[..., float], *arguments: Any) -> Any:
    """Return function(*arguments); element by element for arrays, with each combination computed once."""
    if not any(isinstance(argument, np.ndarray) for argument in arguments):
        return function(*arguments)
    given = np.broadcast_arrays(*arguments)
    rows, place = np.unique(np.stack([np.asarray(each).ravel() for each in given]), axis=1, return_inverse=True)
    values = np.array([function(*(row.item() for row in column)) for column in rows.T])
    return values[place.ravel()].reshape(given[0].shape)


def exp(x: Any) -> Any:
    """Return e ** x."""
    return _one_by_one(math.exp, x) if isinstance(x, np.ndarray) else math.exp(x)


def sqrt(x: Any) -> Any:
    """Return the square root, which is correctly rounded on every platform."""
    return np.sqrt(x) if isinstance(x, np.ndarray) else math.sqrt(x)


def inverse(x: Any) -> Any:
    """Return 1 / x, infinity for zero."""
    if isinstance(x, np.ndarray):
        return np.divide(1.0, x, out=np.full_like(x, np.inf), where=x != 0)
    return 1 / x if x else math.inf


def pick(condition: Any, one: Any, other: Any) -> Any:
    """Return one where the condition holds, else the other."""
    if isinstance(condition, np.ndarray):
        return np.where(condition, one, other)
    return one if condition else other


def less(one: Any, other: Any, if_equal_one: Any, if_equal_other: Any) -> Any:
    """Return whether one < other; for equal numbers, whether if_equal_one < if_equal_other."""
    return (one < other) | ((one == other) & (if_equal_one < if_equal_other))


def stacked(components: Sequence[Any]) -> Vector:
    """Return a vector of components, (n,) or (n, ...)."""
    for component in components:
        if isinstance(component, np.ndarray):
            return np.stack(np.broadcast_arrays(*components))
    return np.array(components, dtype=float)


def total(vector: Vector) -> Any:
    """Return the sum of the components, in the same order for one vector and for many."""
    if vector.ndim == 1:
        return float(vector.sum())
    return np.ascontiguousarray(np.moveaxis(vector, 0, -1)).sum(axis=-1)
