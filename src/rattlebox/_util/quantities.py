"""Formatting of numbers with units: SI prefixes and four significant digits."""

from __future__ import annotations

import math
import re

PREFIXES: dict[int, str] = {
    -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T",
}  # fmt: skip
"""Prefix of each power of ten."""

MISSING = "-"
"""Text for NaN."""

PREFIXED_UNITS = ("m", "s", "kg", "m/s", "m/s^2", "N", "N/m", "J", "W", "Pa", "Hz")
"""Units that take an SI prefix in tables; others, such as kg/m^3 and rad, are written as they are."""


def _exponent(value: float, significant: int) -> int:
    """Return the power of ten of the first digit of the rounded number."""
    return int(f"{value:.{significant - 1}e}".partition("e")[2])


def prefix(value: float, least: float = 1.0) -> tuple[float, str]:
    """Return the SI prefix in which `value` is at least `least` and less than 1000 `least`."""
    if value == 0.0 or not math.isfinite(value):
        return 1.0, ""
    power = min(max(3 * (_exponent(value / least, 4) // 3), min(PREFIXES)), max(PREFIXES))
    return 10.0**power, PREFIXES[power]


def in_unit(value: float, unit: str, least: float = 1.0) -> tuple[float, str]:
    """Return the divisor and the prefixed unit for a number.

    Masses are written in grams, kilograms and tonnes: kkg and Mg are not used.
    """
    base = 1.0
    if unit == "m/s^2":
        return base, unit
    if unit == "kg":
        heavy = math.isfinite(value) and value != 0.0 and _exponent(value, 4) >= 3
        base, unit = (1e3, "t") if heavy else (1e-3, "g")
    scale, name = prefix(value / base, least)
    return base * scale, name + unit


def digits(value: float, significant: int = 4) -> str:
    """Format a number with a fixed number of significant digits; with an exponent only below 1e-4 and from 1e7."""
    if not math.isfinite(value):
        return MISSING if math.isnan(value) else str(value)
    if value == 0.0:
        return "0"
    exponent = _exponent(value, significant)
    if -4 <= exponent < 7:
        return f"{value:.{max(significant - 1 - exponent, 0)}f}"
    return f"{value:.{significant - 1}e}"


def quantity(value: float, unit: str, significant: int = 4) -> str:
    """Format a number with its unit and an SI prefix.

    Examples
    --------
    >>> quantity(0.00041234, "m")
    '412.3 µm'
    """
    if math.isnan(value):
        return MISSING
    if unit == "%":
        return f"{digits(100.0 * value if abs(value) >= 1e-12 else 0.0, significant)} %"
    if unit in ("", "1"):
        return digits(value, significant)
    divisor, written = in_unit(value, unit)
    return f"{digits(value / divisor, significant)} {written}"


def amount(value: float, unit: str = "", significant: int = 4) -> str:
    """Format a number with its unit, without trailing zeros, as inputs are written: 20 kg, 0.4 mm.

    Examples
    --------
    >>> amount(0.0004, "m"), amount(20.0, "kg"), amount(7850.0, "kg/m^3")
    ('0.4 mm', '20 kg', '7850 kg/m^3')
    """
    if math.isnan(value):
        return MISSING
    value += 0.0  # turns -0.0 into 0.0
    if unit in PREFIXED_UNITS and not (unit == "s" and abs(value) >= 1):
        divisor, written = in_unit(value, unit, 0.1 if unit in ("m", "s") else 1.0)
        return f"{without_zeros(digits(value / divisor, significant))} {written}"
    if unit == "%":
        return f"{without_zeros(digits(100.0 * value, significant))} %"
    number = without_zeros(digits(value, significant))
    return number if unit in ("", "1") else f"{number} {unit}"


def without_zeros(text: str) -> str:
    """Return a text without zeros at the end of the decimals of its numbers."""
    return re.sub(r"\.0+(?!\d)|(\.\d*[1-9])0+(?!\d)", r"\1", text)
