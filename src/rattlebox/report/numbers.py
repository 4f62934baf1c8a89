"""Numbers with their 95 % intervals, as the sentences of a report write them."""

from __future__ import annotations

import math

from rattlebox._util.quantities import PREFIXED_UNITS, amount, digits, in_unit, span

_ROUNDING = 1e-6
"""Half width of an interval over its value, below which the motion repeats and the interval is rounding."""


def with_interval(value: float, half: float, unit: str = "") -> str:
    """Return a value with half of the width of its 95 % interval: "0.41 ± 0.02 mm"."""
    if not (math.isfinite(value) and math.isfinite(half)) or abs(half) < _ROUNDING * abs(value):
        return amount(value, unit)
    divisor, written = (0.01, "%") if unit == "%" else (1.0, "" if unit == "1" else unit)
    if unit in PREFIXED_UNITS:
        divisor, written = in_unit(value, unit)
    value, half = value / divisor, abs(half) / divisor
    # Two digits of the interval, and as many decimals of the value.
    decimals = max(0, 1 - math.floor(math.log10(half))) if half > 0 else 4
    if decimals > 6 or half >= 1e6:
        return f"{digits(value)} ± {digits(half, 2)} {written}".rstrip()
    return f"{value:.{decimals}f} ± {half:.{decimals}f} {written}".rstrip()


def between(lower: float, upper: float, unit: str = "") -> str:
    """Return the limits of an interval in one unit: "3.1 to 3.6 %"."""
    return span(lower, upper, unit, 3)
