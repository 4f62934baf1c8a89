"""Formatting of numbers with units: SI prefixes and four significant digits."""

from __future__ import annotations

import math

PREFIXES: dict[int, str] = {
    -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T",
}  # fmt: skip
"""Prefix of each power of ten."""

MISSING = "-"
"""Text for NaN."""


def _exponent(value: float, significant: int) -> int:
    """Return the power of ten of the first digit of the rounded number."""
    return int(f"{value:.{significant - 1}e}".partition("e")[2])


def prefix(value: float, least: float = 1.0) -> tuple[float, str]:
    """Return the SI prefix in which `value` is at least `least` and less than 1000 `least`.

    Parameters
    ----------
    value
        Number in the unit without prefix; zero and non-finite numbers get no prefix.
    least
        Power of ten.

    Returns
    -------
    scale : float
        Divisor of the value.
    name : str
        Prefix of the unit.
    """
    if value == 0.0 or not math.isfinite(value):
        return 1.0, ""
    power = min(max(3 * (_exponent(value / least, 4) // 3), min(PREFIXES)), max(PREFIXES))
    return 10.0**power, PREFIXES[power]


def in_unit(value: float, unit: str, least: float = 1.0) -> tuple[float, str]:
    """Return the divisor and the prefixed unit for a number.

    Masses are written in grams, kilograms and tonnes: kkg and Mg are not used.

    Parameters
    ----------
    value
        Number in SI units.
    unit
        SI unit.
    least
        Smallest number to be written in the unit, a power of ten.
    """
    base = 1.0
    if unit == "kg":
        heavy = math.isfinite(value) and value != 0.0 and _exponent(value, 4) >= 3
        base, unit = (1e3, "t") if heavy else (1e-3, "g")
    scale, name = prefix(value / base, least)
    return base * scale, name + unit


def digits(value: float, significant: int = 4) -> str:
    """Format a number with a fixed number of significant digits; with an exponent only below 1e-4 and from 1e7.

    Parameters
    ----------
    value
        Number.
    significant
        Count of significant digits.
    """
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

    Parameters
    ----------
    value
        Number in SI units.
    unit
        Unit, such as "m" or "m/s"; "" or "1" for a pure number, "%" for a share in per cent, of which less than 1e-12 is
        written as 0.
    significant
        Count of significant digits.

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
