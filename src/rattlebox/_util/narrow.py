"""Narrowing of types that an earlier check guarantees."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np

Value = TypeVar("Value")


def present(value: Value | None) -> Value:
    """Return an optional value; raise if it is None."""
    if value is None:
        raise TypeError("a value is None, which an earlier check should have excluded")
    return value


def instance(value: object, kind: type[Value]) -> Value:
    """Return a value; raise if it is not of a class."""
    if not isinstance(value, kind):
        raise TypeError(f"{value!r:.60} is not a {kind.__name__}, which an earlier check should have excluded")
    return value


def unmasked(values: Any) -> Any:
    """Return the values with NaN in place of masked ones, which are invalid and would become numbers in an array."""
    if not isinstance(values, np.ma.MaskedArray):
        return values
    return np.ma.filled(values.astype(np.result_type(values, float)), np.nan)
