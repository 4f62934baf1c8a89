"""Mixing rules: laws between two species from the laws within each species."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Literal

from .base import Part
from .friction import Friction, Rolling

Mixing = Literal["arithmetic", "geometric", "harmonic", "smaller", "larger"]

_MEANS: dict[Mixing, Callable[[float, float], float]] = {
    "arithmetic": lambda a, b: (a + b) / 2,
    "geometric": lambda a, b: math.sqrt(a) * math.sqrt(b),
    "harmonic": lambda a, b: 2 * a * b / (a + b) if a + b else 0.0,
    "smaller": min,
    "larger": max,
}


def mixed(one: object, other: object, rule: Mixing) -> Any:
    """Return the law with the means of the numbers of two laws of the same kind.

    Notes
    -----
    For two numbers a and b: "arithmetic" (a + b)/2, "geometric" (a b)^(1/2), "harmonic" 2 a b/(a + b), "smaller" min(a, b),
    "larger" max(a, b).
    """
    if one is None or other is None:
        law = other if one is None else one
        if law is None:
            return None
        if not isinstance(law, (Friction, Rolling)):
            raise TypeError("only laws of friction and rolling resistance can be missing")
        one, other = law, law.model_copy(update={"coefficient": 0.0})
    if one == other:
        return one
    if isinstance(one, float) and isinstance(other, float):
        return _MEANS[rule](one, other)
    if isinstance(one, Part) and type(one) is type(other):
        return one.model_copy(
            update={name: mixed(getattr(one, name), getattr(other, name), rule) for name in type(one).model_fields}
        )
    raise TypeError(f"{one!r} and {other!r} differ in more than numbers")
