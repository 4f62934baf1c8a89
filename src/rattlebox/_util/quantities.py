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


STANDARD_GRAVITY = 9.80665
"""Acceleration of 1 g [m/s^2]."""
ACCELERATION = "m/s^2"
"""Unit of accelerations, which engineers also read in g."""
_LEAST_IN_G = 0.01
"""Smallest acceleration that is also written in g [g]."""
_REPEATS = 1e-4
"""Half width of an interval over its value, below which it does not change the four digits that are written."""


def _exponent(value: float, significant: int) -> int:
    """Return the power of ten of the first digit of the rounded number."""
    return int(f"{value:.{significant - 1}e}".partition("e")[2])


def prefix(value: float, powers: tuple[int, int] = (-12, 12)) -> tuple[float, str]:
    """Return the SI prefix in which `value` is at least 1 and less than 1000, between two powers of ten."""
    if value == 0.0 or not math.isfinite(value):
        return 1.0, ""
    power = min(max(3 * (_exponent(value, 4) // 3), powers[0]), powers[1])
    return 10.0**power, PREFIXES[power]


_POWERS = {"m": (-12, 3), "s": (-12, 0), "m/s": (-12, 0), "Hz": (0, 9)}
"""Lowest and highest power of ten of the prefix of a unit: nobody writes mHz, ks, km/s or km/s^2."""
_MILLI = {"m": range(-4, 0), "s": range(-4, -1)}
"""Powers of ten of the first digit of lengths and times in mm and ms: 0.4 mm, 397 mm and 0.5 s are easier to read than
400 µm, 0.397 m and 500 ms."""
_POWERS_OF_OTHERS = (-12, 12)
_SYMBOL = re.compile(r"(?:m|s|N|J|W|Pa|Hz)(?![\w^])")
"""First symbol of a unit that can have a prefix; of m^2 and (m/s^2)^2/Hz a prefix would be squared, too."""


def in_unit(value: float, unit: str) -> tuple[float, str]:
    """Return the divisor and the prefixed unit for a number: the only place that decides on prefixes.

    Masses are written in grams, kilograms and tonnes: kkg, Mg and kt are not used.
    """
    if unit == "kg":
        power = _exponent(value, 4) if math.isfinite(value) and value != 0.0 else 0
        if power >= 3:
            return 1e3, "t"
        scale, name = prefix(value / 1e-3, powers=(-12, 3))
        return 1e-3 * scale, name + "g"
    if not _SYMBOL.match(unit) or unit.startswith("m/s^2"):
        return 1.0, unit
    if unit in _MILLI and math.isfinite(value) and value != 0.0:
        first = _exponent(value, 4)
        if first in _MILLI[unit]:
            return 1e-3, f"m{unit}"
        if unit == "s" and first == -1:
            return 1.0, unit
    scale, name = prefix(value, _POWERS.get(unit, _POWERS_OF_OTHERS))
    return scale, name + unit


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
    >>> quantity(0.00041234, "m"), quantity(0.93, "Hz"), quantity(1.2e6, "kg"), quantity(25.0, "m/s^2")
    ('0.4123 mm', '0.9300 Hz', '1200 t', '25.00 m/s^2 (2.549 g)')
    """
    if math.isnan(value):
        return MISSING
    if unit == "%":
        return f"{digits(100.0 * value if abs(value) >= 1e-12 else 0.0, significant)} %"
    if unit in ("", "1"):
        return digits(value, significant)
    divisor, written = in_unit(value, unit)
    text = f"{digits(value / divisor, significant)} {written}"
    if unit == ACCELERATION and abs(value) >= _LEAST_IN_G * STANDARD_GRAVITY:
        return f"{text} ({digits(value / STANDARD_GRAVITY, significant)} g)"
    return text


def acceleration(value: float, significant: int = 4) -> str:
    """Format an acceleration [m/s^2] as it was given: in g if that number has few digits, else in m/s^2.

    Examples
    --------
    >>> acceleration(4.903325), acceleration(5.0)
    ('0.5 g', '5 m/s^2')
    """
    in_si, in_g = (without_zeros(digits(each, significant)) for each in (value, value / STANDARD_GRAVITY))
    # A number that was given has few digits; one that was converted has all of them.
    is_si, is_g = (
        abs(float(text) * unit - value) <= 1e-9 * abs(value) for text, unit in ((in_si, 1.0), (in_g, STANDARD_GRAVITY))
    )
    return f"{in_g} g" if is_g and not is_si else f"{in_si} {ACCELERATION}"


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
    if unit == ACCELERATION:
        return acceleration(value, significant)
    if unit in PREFIXED_UNITS and not (unit == "s" and abs(value) >= 1):
        divisor, written = in_unit(value, unit)
        return f"{without_zeros(digits(value / divisor, significant))} {written}"
    if unit == "%":
        return f"{without_zeros(digits(100.0 * value, significant))} %"
    number = without_zeros(digits(value, significant))
    return number if unit in ("", "1") else f"{number} {unit}"


def span(lower: float, upper: float, unit: str = "", significant: int = 4) -> str:
    """Format a range in one unit, without trailing zeros: 3.1 to 3.6 %, 24 to 42 Hz.

    Examples
    --------
    >>> span(0.0002, 0.0012, "m"), span(24.0, 42.0, "Hz"), span(0.031, 0.036, "%")
    ('0.2 to 1.2 mm', '24 to 42 Hz', '3.1 to 3.6 %')
    """
    if not (math.isfinite(lower) and math.isfinite(upper)):
        return MISSING
    divisor, written = (0.01, "%") if unit == "%" else (1.0, "" if unit == "1" else unit)
    if unit in PREFIXED_UNITS:
        divisor, written = in_unit(max(abs(lower), abs(upper)), unit)
    ends = (amount(end / divisor, significant=significant) for end in (lower, upper))
    return f"{' to '.join(ends)} {written}".rstrip()


def with_interval(value: float, half: float, unit: str = "") -> str:
    """Return a value with half of the width of its 95 % interval, in one unit: "0.41 ± 0.02 mm"."""
    if not (math.isfinite(value) and math.isfinite(half)) or abs(half) < _REPEATS * abs(value):
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


def without_zeros(text: str) -> str:
    """Return a text without zeros at the end of the decimals of its numbers."""
    return re.sub(r"\.0+(?!\d)|(\.\d*[1-9])0+(?!\d)", r"\1", text)
