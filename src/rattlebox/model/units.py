"""Quantities: numbers in SI, or text and pint quantities with units. Pint loads only when a unit must be read.

A table of common units precedes pint for two reasons: a case takes 0.55 s of CPU time with the table and 1.22 s with pint,
and pint reads g as gram and gal as gallon even if an acceleration is needed.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from numbers import Real
from typing import TYPE_CHECKING, Annotated, Any, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, PlainSerializer, WithJsonSchema

from rattlebox._util.narrow import unmasked
from rattlebox._util.quantities import STANDARD_GRAVITY as STANDARD_GRAVITY

from .errors import NEGATIVE, NOT_POSITIVE, Hint, at, nearest

if TYPE_CHECKING:
    import pint

MOST_MEMORY = 16e9
"""Largest size of the arrays of a signal or of the output of a run [bytes]."""

LARGEST = 1e30
"""Largest number in SI units; its inverse is the smallest positive one. Powers of other numbers would overflow."""

_NUMBER = re.compile(r"^\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*$")

_SUPERSCRIPTS = {ord("²"): "^2", ord("³"): "^3", ord("⁴"): "^4"}
_DENSITY = re.compile(r"^\s*\(?\s*([^()]+?)\s*\)?\s*\^2\s*/\s*Hz\s*$")

_POWER = re.compile(r"(?<=[A-Za-zµ])([234])\b")
"""Exponent that directly follows a unit, as in mm2."""
_TON = re.compile(r"(?<![a-z_])(k|kilo|mega)?tons?(?![a-z_])", re.I)

_COMMA = re.compile(r"^\s*([+-]?\d+),(\d+)(.*?)\s*$")

# Factors of common units by dimension, which have priority over pint: pint reads g as gram, mg as milligram and gal as
# gallon, also where an acceleration is needed, and loading it takes time. Exact powers of ten are applied as one correctly
# rounded operation: x / 1000 rather than x * 0.001.
_COMMON: dict[str, dict[str, tuple[float, float]]] = {
    "m": {"m": (1, 1), "cm": (1, 1e2), "mm": (1, 1e3), "um": (1, 1e6), "µm": (1, 1e6), "nm": (1, 1e9),
        "in": (0.0254, 1), "ft": (0.3048, 1), "mil": (0.0254, 1e3)},
    "s": {"s": (1, 1), "ms": (1, 1e3), "us": (1, 1e6), "µs": (1, 1e6), "ns": (1, 1e9), "sec": (1, 1),
        "seconds": (1, 1), "msec": (1, 1e3), "min": (60, 1), "h": (3600, 1)},
    "kg": {"kg": (1, 1), "g": (1, 1e3), "mg": (1, 1e6), "t": (1e3, 1)},
    "N": {"N": (1, 1), "mN": (1, 1e3), "kN": (1e3, 1), "MN": (1e6, 1), "kgf": (STANDARD_GRAVITY, 1),
        "lbf": (4.4482216152605, 1), "dyn": (1, 1e5)},
    "N/m": {"N/m": (1, 1), "kN/m": (1e3, 1), "MN/m": (1e6, 1), "N/mm": (1e3, 1)},
    "N s/m": {"N s/m": (1, 1), "N*s/m": (1, 1), "Ns/m": (1, 1), "kN s/m": (1e3, 1)},
    "m/s": {"m/s": (1, 1), "mm/s": (1, 1e3), "cm/s": (1, 1e2), "in/s": (0.0254, 1), "ft/s": (0.3048, 1)},
    "m/s^2": {"m/s^2": (1, 1), "m/s²": (1, 1), "cm/s^2": (1, 1e2), "mm/s^2": (1, 1e3), "gal": (1, 1e2),
        "Gal": (1, 1e2), "mGal": (1, 1e5), "in/s^2": (0.0254, 1), "ft/s^2": (0.3048, 1),
        "g_0": (STANDARD_GRAVITY, 1), "g": (STANDARD_GRAVITY, 1), "gn": (STANDARD_GRAVITY, 1),
        "mg": (STANDARD_GRAVITY, 1e3), "ug": (STANDARD_GRAVITY, 1e6), "µg": (STANDARD_GRAVITY, 1e6)},
    "Hz": {"Hz": (1, 1), "kHz": (1e3, 1)},
    "Pa": {"Pa": (1, 1), "kPa": (1e3, 1), "MPa": (1e6, 1), "GPa": (1e9, 1),
        "N/mm^2": (1e6, 1), "N/mm2": (1e6, 1), "N/m^2": (1, 1)},
    "kg/m^3": {"kg/m^3": (1, 1), "g/cm^3": (1e3, 1)},
    "rad": {"rad": (1, 1)},
    "rad/s": {"rad/s": (1, 1), "rpm": (math.pi, 30), "1/min": (math.pi, 30), "rev/min": (math.pi, 30),
        "r/min": (math.pi, 30), "rev/s": (2 * math.pi, 1)},
    "kg^-0.5": {"kg^-0.5": (1, 1)},
    "kg^0.5": {"kg^0.5": (1, 1), "t^0.5": (math.sqrt(1e3), 1), "g^0.5": (1, math.sqrt(1e3))},
    "N m^2": {"N m^2": (1, 1), "N*m^2": (1, 1), "Nm^2": (1, 1), "kN m^2": (1e3, 1), "N mm^2": (1, 1e6)},
    "N m": {"N m": (1, 1), "N*m": (1, 1), "Nm": (1, 1), "kN m": (1e3, 1), "N mm": (1, 1e3)},
    "kg/m": {"kg/m": (1, 1), "g/m": (1, 1e3), "t/m": (1e3, 1), "kg/mm": (1e3, 1)},
    "kg/m^2": {"kg/m^2": (1, 1), "g/m^2": (1, 1e3), "t/m^2": (1e3, 1)},
    "J": {"J": (1, 1), "mJ": (1, 1e3), "uJ": (1, 1e6), "µJ": (1, 1e6)},
}  # fmt: skip

_SINGLE_CASE = {
    name.lower(): name
    for known in _COMMON.values()
    for name in known
    if [other.lower() for every in _COMMON.values() for other in every].count(name.lower()) == 1
}
"""Units that are known in any case, since no two of them differ by it alone."""

_EXAMPLES_OF_DENSITIES = {"m/s^2": ("g^2/Hz", "(m/s^2)^2/Hz"), "N": ("N^2/Hz",), "m": ("mm^2/Hz",)}
_DENSITIES = {"m/s^2": ("m^2/s^3", "m^2/s^4/Hz", "(m/s^2)^2/Hz"), "N": ("N^2/Hz",), "m": ("m^2/Hz",)}

_LONGEST_UNIT, _LONGEST_QUANTITY = 60, 400  # characters
_OTHER_UNITS = {
    "v": "voltage", "volt": "voltage", "volts": "voltage", "mv": "voltage", "a": "current", "amps": "current",
    "bar": "pressure", "psi": "pressure", "strain": "strain", "um/m": "strain", "deg": "angle", "degc": "temperature",
    "counts": "reading of a converter", "count": "reading of a converter",
}  # fmt: skip
"""Units in headers of quantities that no case has."""

_NAMES = {
    "m": "length", "s": "time", "kg": "mass", "N": "force", "N/m": "stiffness", "N s/m": "damping coefficient",
    "m/s": "velocity", "m/s^2": "acceleration", "Hz": "frequency", "Pa": "pressure or modulus", "kg/m^3": "density",
    "rad": "angle", "kg^-0.5": "mass-normalised mode shape", "kg^0.5": "participation", "rad/s": "angular velocity",
    "N m^2": "bending stiffness", "N m": "bending stiffness per width", "kg/m": "mass per length", "kg/m^2": "mass per area",
    "J": "energy",
}  # fmt: skip

_EXAMPLES = {
    "m": "0.4 mm", "s": "1 ms", "kg": "20 kg", "N": "5 kN", "N/m": "80 kN/m", "N s/m": "25.3 N s/m", "m/s": "0.1 m/s",
    "m/s^2": "9.81 m/s^2", "Hz": "10 Hz", "Pa": "200 GPa", "kg/m^3": "7850 kg/m^3", "rad": "90 deg", "rad/s": "10 rad/s",
    "kg^0.5": "-2.3 kg^0.5",
    "N m^2": "350 N m^2", "N m": "1.2 kN m", "kg/m": "7.8 kg/m", "kg/m^2": "5 kg/m^2",
    "J": "2 mJ",
}  # fmt: skip


@cache
def registry() -> pint.UnitRegistry[Any]:
    """Return the unit registry, made at first use."""
    import pint

    return pint.UnitRegistry()


def _pint_unit(unit: str) -> str:
    return (
        unit.replace("N s/m", "N*s/m")
        .replace("kg^-0.5", "kg**-0.5")
        .replace("kg^0.5", "kg**0.5")
        .replace("N m", "N*m")
        .replace("^", "**")
    )


def _article(name: str) -> str:
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"


def _described(quantity: Any) -> str:
    if quantity.unitless:
        return "a ratio"
    for unit, name in _NAMES.items():
        if quantity.is_compatible_with(_pint_unit(unit)):
            return _article(name)
    return f"a quantity in {quantity.units:~}"


class UnitQuantity(Protocol):
    """A quantity of pint, or of a similar library."""

    @property
    def magnitude(self) -> object:
        """Its number."""

    @property
    def units(self) -> object:
        """Its unit."""


Quantity = float | str | tuple[float, str] | UnitQuantity
"""A number in SI units, a text with a unit, a pair of both, or a quantity of pint: what `parse` reads."""


def parse(value: Any, units: tuple[str, ...]) -> tuple[float, str | None]:
    """Read a quantity.

    `value`: a number in SI, text such as "0.4 mm", a pair (number, unit) or a pint Quantity.
    """
    # A plain number is in SI units; true would be 1.
    if isinstance(value, (bool, np.bool_, bytes)):
        raise Hint(_wanted(units), _example(units))
    if isinstance(value, (int, float)):
        try:
            return _finite(float(value)), None
        except OverflowError:
            raise Hint("a finite number is needed", _example(units)) from None
    if isinstance(value, (tuple, list)) and len(value) == 2 and isinstance(value[1], str) and _is_number(value[0]):
        value = f"{value[0]} {value[1]}"
    if isinstance(value, str):
        # Text: the table of common units first, which says that g is gravity where an acceleration is needed.
        match = _NUMBER.match(value) if len(value) <= _LONGEST_QUANTITY else None
        if match is None:
            raise Hint(_wanted(units), _example(units))
        number, text = float(match[1]), match[2]
        _check_comma(value)
        if not text:
            return _finite(number), None
        text = _spelt(text)
        for unit in units:
            if text in _COMMON.get(unit, {}):
                up, down = _COMMON[unit][text]
                return _finite(number * up / down), unit
        value = _with_pint(number, text, units)
    # A quantity of pint; it takes a frequency for an angular velocity, which differ by 2 pi.
    if hasattr(value, "is_compatible_with") and hasattr(value, "to"):
        for unit in units:
            if value.is_compatible_with(_pint_unit(unit)) and (_is_angle(value) or not value.dimensionless):
                angular = any(word in str(value.units) for word in ("radian", "rev", "turn", "degree"))
                if unit == "Hz" and angular:
                    return _finite(float(value.to("rad/s").magnitude) / (2 * math.pi)), unit
                if unit == "rad/s" and "hertz" in str(value.units):
                    return _finite(float(value.to("Hz").magnitude) * (2 * math.pi)), unit
                if unit == "rad/s" and not angular:  # machine makers write turns, mathematicians radians
                    raise Hint(
                        f"{value:~} may be turns or radians; {_wanted(units)}",
                        f'"{value.to("1/s").magnitude:.12g} rad/s" or "{value.to("1/s").magnitude:.12g} Hz"',
                    )
                return _finite(float(value.to(_pint_unit(unit)).magnitude)), unit
        grams = "m/s^2" in units and str(value.units) == "gram"  # g of gravity is meant
        meant = "g_0" if grams else _same_letters(f"{value.units:~}", units)
        advice = f'"{value.magnitude:.12g} {meant}"' if meant else _example(units)
        raise Hint(f"{_wanted(units)}, not {_described(value)}", advice)
    try:
        return _finite(float(value)), None
    except (TypeError, ValueError):
        raise Hint(_wanted(units), _example(units)) from None


def _same_letters(text: str, units: tuple[str, ...]) -> str:
    """Return the common unit with the same letters, capitals or not (MM for mm), or ""."""
    known = (name for unit in units for name in _COMMON.get(unit, {}))
    return next((name for name in known if name.lower() == text.lower()), "")


def _is_number(value: object) -> bool:
    """Return whether a value is a number, or a text without a unit."""
    match = _NUMBER.match(value) if isinstance(value, str) else None
    return not match[2] if match else not isinstance(value, str)


def parse_density(value: Any, units: tuple[str, ...]) -> tuple[float, str | None]:
    """Read a one-sided power spectral density."""
    match = _NUMBER.match(value) if isinstance(value, str) else None
    if match is None or not match[2]:
        return float(numbers(value)), None
    _check_comma(value)
    number, text = float(match[1]), _spelt(match[2])
    for unit in units:
        if text in _DENSITIES.get(unit, ()):
            return _finite(number), unit
    squared = _DENSITY.match(text)
    known = squared and factor_of(squared[1], units)
    if not known:
        raise Hint(
            f"{match[2]!r} is not the unit of a power spectral density, the square of a unit per Hz",
            " or ".join(f'"1 {name}"' for unit in units for name in _EXAMPLES_OF_DENSITIES[unit]),
        )
    factor, unit = known
    return _finite(number * factor**2), unit


def density_factor(unit: str, units: tuple[str, ...]) -> tuple[float, str] | None:
    """Return the factor of the unit of a density in a file to SI, and the SI unit of the signal; None if it is none."""
    text = unit.translate(_SUPERSCRIPTS).replace("**", "^").replace("[", "(").replace("]", ")")
    per_kilohertz = re.search(r"/\s*khz\)?\.?\s*$", text, re.I)
    text = re.sub(r"\s*/\s*k?(?:hz|hertz)\b\.?", "/Hz", text.strip(), flags=re.I)
    text = re.sub(r"[ _]*rms(?=[\d)^/ ])", "", text, flags=re.I)  # a density is a mean square
    text = re.sub(r"(?<=[A-Za-z)])2(?=[)/ ])", "^2", text)
    text = re.sub(r"(?<=[A-Za-z)])([34])(?=[)/ ]|$)", r"^\1", text)
    text = re.sub(r"^\((.*\^2)\)/Hz$", r"\1/Hz", text)
    text = re.sub(r"^([^()/^]+)\^2 ?/ ?s\^4/Hz$", r"(\1/s^2)^2/Hz", text)
    try:
        factor, si = parse_density(f"1 {text}", units) if text else (1.0, None)
    except Hint:
        return None
    return None if si is None else (factor / 1e3 if per_kilohertz else factor, si)


def factor_of(unit: str, units: tuple[str, ...]) -> tuple[float, str] | None:
    """Return the factor of a unit to SI, and the SI unit; None if it has none of these dimensions."""
    unit = _spelt(_in_words(unit.strip().strip(".\"'")))
    if "m/s^2" in units and unit.lower() in ("g", "g0", "g_0", "gn", "gal"):
        unit = unit.lower().replace("g0", "g_0")
    if "m/s^2" in units and unit.lower() in ("ms-2", "ms^-2"):  # pint reads milliseconds
        unit = "m/s^2"
    for spelling in (unit, *_other_case(unit)):
        is_known = any(spelling in _COMMON.get(si, {}) for si in units)
        if is_known or (spelling == unit and "/" in unit):  # pint would read a(t) and F (rod) as year and rod
            try:
                factor, si = parse(f"1 {spelling}", units)
            except Hint:
                continue
            return factor, str(si)
    return None


def _other_case(unit: str) -> tuple[str, ...]:
    """Return the usual spellings of a unit in capitals, such as CM/SEC/SEC, KN and MS; MN stays as it is written."""
    if not unit.isupper() and "/" not in unit:
        return ()
    lower = _spelt(unit.lower())
    return lower, _SINGLE_CASE.get(lower, lower)


def unit_name(text: str) -> str:
    """Return the quantity of a unit, such as "acceleration"; "" for text that is no common unit."""
    known = factor_of(text, tuple(_COMMON))
    return _NAMES[known[1]] if known else _OTHER_UNITS.get(text.strip().lower(), "")


def names_of_units(units: tuple[str, ...]) -> list[str]:
    """Return the spellings of the common units of some dimensions."""
    return list(dict.fromkeys(name for si in units for name in _COMMON[si]))


_WORDS = (
    (re.compile(r"\bmet(?:er|re)s?\b", re.I), "m"),
    (re.compile(r"\bcentimet(?:er|re)s?\b", re.I), "cm"),
    (re.compile(r"\bmillimet(?:er|re)s?\b", re.I), "mm"),
    (re.compile(r"\b(?:inch|inches)\b", re.I), "in"),
    (re.compile(r"\b(?:foot|feet)\b", re.I), "ft"),
    (re.compile(r"\bnewtons?\b", re.I), "N"),
    (re.compile(r"\bmilliseconds?\b", re.I), "ms"),
    (re.compile(r"\bmicroseconds?\b", re.I), "us"),
    (re.compile(r"\bseconds?\b|\bsecs\b", re.I), "s"),
    (re.compile(r"\bgals\b", re.I), "gal"),
    (re.compile(r"\bg'?s\b", re.I), "g"),
    (re.compile(r"\s*\bper\b\s*", re.I), "/"),
    (re.compile(r"(?<=/s)(?:ec)?\s+squared\b", re.I), "^2"),
    (re.compile(r"/\s*\(\s*([^()]*?)\s*\)"), r"/\1"),
)
"""Words and notations of units in headers, with their symbols."""


def _in_words(unit: str) -> str:
    """Return a unit with symbols in place of words: "meters per second squared" is m/s^2."""
    if len(unit) > _LONGEST_UNIT:
        return ""
    for pattern, symbol in _WORDS:
        unit = pattern.sub(symbol, unit)
    return unit.strip()


def _spelt(unit: str) -> str:
    """Return the normalised spelling of a unit: m/s², m/s2, m/s**2, m/s/s, m/sec^2 and m s^-2 are m/s^2."""
    unit = unit.replace("⁻²", "^-2").replace("^{2}", "^2").replace("^{-2}", "^-2")
    unit = unit.replace("**", "^").replace("²", "^2").replace("μ", "µ").replace("·", " ")
    unit = re.sub(r"/\s*sec\b|/\s*sec(?=[\d^])", "/s", unit)
    unit = re.sub(r"/s(?:2|/s)$", "/s^2", unit)
    unit = re.sub(r"^sqrt\((\w+)\)$|^(\w+)\^\(?1/2\)?$", r"\1\2^0.5", unit)
    return re.sub(r"(?<=[a-z])[ *.]s\^?-2$", "/s^2", unit)


def _check_comma(text: str) -> None:
    """Raise if a number contains a comma."""
    match = _COMMA.match(text)
    if match:
        before, after, rest = match.groups()
        readings = [f'"{before}.{after}{rest}"'] if "," not in rest else []
        if readings and len(after) == 3 and before.lstrip("+-") != "0":
            readings.append(f'"{before}{after}{rest}"')
        raise Hint("a number has a decimal point and no separator of thousands", " or ".join(readings))


def as_written(value: object) -> tuple[float, str] | None:
    """Return the number and the unit of a quantity as written, "" without unit; None for values of other types."""
    if isinstance(value, (tuple, list)) and len(value) == 2 and isinstance(value[1], str) and _is_number(value[0]):
        value = f"{value[0]} {value[1]}"
    if isinstance(value, (int, float)):
        return float(value), ""
    match = _NUMBER.match(value) if isinstance(value, str) else None
    return (float(match[1]), match[2]) if match else None


def are_alike(one: str, other: str) -> bool:
    """Return whether two units have the same dimension; frequencies and angular velocities count as the same."""
    if one == other or any(one in known and other in known for known in _COMMON.values()):
        return True
    one, other = (next((si for si, known in _COMMON.items() if unit in known), unit) for unit in (one, other))
    first, second = (_with_pint(1.0, _pint_unit(unit), ()) for unit in (one, other))
    return bool(first.is_compatible_with(second))


def _is_angle(value: Any) -> bool:
    """Return whether a dimensionless quantity is an angle or a ratio, not a percentage."""
    return str(value.units) == "dimensionless" or str(value.to_root_units().units) == "radian"


def _with_pint(number: float, text: str, units: tuple[str, ...]) -> Any:
    if prefixed := _TON.search(text):
        number *= {"": 1.0, "k": 1e3, "kilo": 1e3, "mega": 1e6}[(prefixed[1] or "").lower()]  # kt are knots
        raise Hint(
            f"{text!r}: ton is 1000 kg, 907.185 kg or 1016.05 kg in different countries",
            " or ".join(f'"{number:.12g} {_TON.sub(name, text)}"' for name in ("t", "short_ton", "long_ton")),
        )
    if len(text) > _LONGEST_UNIT:  # pint would take minutes
        raise Hint(f"unknown unit {text[:_LONGEST_UNIT]!r}...", _example(units))
    ureg = registry()
    try:
        plain = _POWER.sub(r"**\1", text)
        unit = ureg.parse_units(plain.replace("µ", "u").replace("^", "**").replace("²", "**2"))
        _ = unit.dimensionality  # pint computes it late, and fails for octaves and other logarithmic units
        return number * unit
    except Exception as error:
        known = {name for unit in units for name in _COMMON.get(unit, {})}
        # A similar spelling of one or two letters is often another unit: mn is closest to m, and may be mm.
        is_short = len(text) < 3 and text.lower() not in map(str.lower, known)
        suggestion = f"known: {', '.join(sorted(known))}" if is_short else nearest(text, known)
        raise Hint(f"unknown unit {text!r}", suggestion if known else _example(units)) from error


def _finite(value: float) -> float:
    """Return a number unchanged; raise if it is not finite or larger than `LARGEST`."""
    if not math.isfinite(value):
        raise Hint("a finite number is needed", "omit the field, or give the number that is meant")
    if abs(value) > LARGEST:
        raise Hint(f"no more than {LARGEST:g} in SI units is allowed", "check the exponent and the unit")
    return value


def _wanted(units: tuple[str, ...]) -> str:
    return " or ".join(f"{_article(_NAMES[unit])} ({unit})" for unit in units) + " is needed"


def _example(units: tuple[str, ...]) -> str:
    return " or ".join(f'"{_EXAMPLES[unit]}"' for unit in units if unit in _EXAMPLES)


def radius_of_diameter(values: object) -> Any:
    """Return the fields of a round part with a radius in place of a diameter."""
    if not isinstance(values, dict) or values.get("diameter") is None:
        return values
    if values.get("radius") is not None:
        raise Hint("radius and diameter exclude each other", "one of them", ["diameter"])
    with at("diameter"):
        radius = _positive(parse(values["diameter"], ("m",))[0]) / 2
    return {**{name: value for name, value in values.items() if name != "diameter"}, "radius": radius}


def numbers(value: object) -> NDArray[np.float64]:
    """Read an array of finite numbers."""
    try:
        array = np.asarray(unmasked(value), dtype=float)
    except (TypeError, ValueError, OverflowError):
        _raise_at_invalid_number(value)
        raise Hint("rows of numbers of one length are needed", "as many numbers in each row") from None
    bad = np.flatnonzero(~(np.abs(array) <= LARGEST))
    if bad.size:
        fault = f"more than {LARGEST:g}" if np.isfinite(array.flat[bad[0]]) else "not finite"
        raise Hint(f"number {int(bad[0]) + 1} of {array.size} is {fault}", "correct this number, or remove it")
    return array


def in_si(value: Any, unit: str) -> Any:
    """Return nested lists with numbers in an SI unit in place of quantities; arrays of numbers are returned unchanged."""
    if isinstance(value, np.ndarray):
        return value if value.dtype.kind in "iuf" else in_si(value.tolist(), unit)
    if not isinstance(value, (list, tuple)) and not np.ndim(getattr(value, "magnitude", 0)):
        return parse(value, (unit,))[0]
    plain = []
    for index, item in enumerate(value):
        if type(item) is not float:
            with at(index):
                item = in_si(item, unit)
        plain.append(item)
    return plain


def _raise_at_invalid_number(value: Any) -> None:
    """Raise with the place of the first item of nested lists that is not a number."""
    if isinstance(value, (list, tuple)):
        for index, item in enumerate(value):
            with at(index):
                _raise_at_invalid_number(item)
        return
    try:
        float(value)
    except (TypeError, ValueError, OverflowError):
        raise Hint("a finite number is needed", "numbers without quotes or units") from None


def text(value: float, unit: str) -> str:
    """Return the text of a quantity from which the same bits are read."""
    return f"{float(value)!r} {unit}"


@dataclass(frozen=True)
class SI:
    """Annotation with the SI unit of the numbers of a field."""

    unit: str


def quantity(unit: str, description: str = "") -> Any:
    """Return the annotations of a field with a quantity in this SI unit."""

    def read(value: object) -> float:
        return parse(value, (unit,))[0]

    example = _EXAMPLES.get(unit, f"1 {unit}")
    return (
        SI(unit),
        BeforeValidator(read),
        PlainSerializer(lambda value: text(value, unit), return_type=str, when_used="json"),
        WithJsonSchema(
            {
                "anyOf": [{"type": "number"}, {"type": "string"}],
                "description": description or f"{_NAMES[unit]} in {unit}, or text with a unit such as '{example}'",
                "examples": [example],
            }
        ),
    )


def _positive(value: float) -> float:
    if not value > 0:
        raise Hint(NOT_POSITIVE, "a positive number")
    if value < 1 / LARGEST:
        raise Hint(f"no less than {1 / LARGEST:g} in SI units is allowed", "check the exponent and the unit")
    return value


def _not_negative(value: float) -> float:
    if value < 0:
        raise Hint(NEGATIVE, "zero or a positive number")
    return value


def not_boolean(value: object) -> Any:
    """Return a value unchanged unless it is a boolean, which is an integer in Python."""
    if isinstance(value, (bool, np.bool_)):
        raise Hint("a number is needed", "1 or 0 in place of true or false")
    return value


def plain(value: object) -> Any:
    """Return a value for a number without unit; percentages such as "36 %" become fractions."""
    if isinstance(value, str):
        _check_comma(value)
    match = _NUMBER.match(value) if isinstance(value, str) else None
    return float(match[1]) / 100 if match and match[2] == "%" else not_boolean(value)


def whole_number(value: Any, name: str, least: int) -> int:
    """Return a value as a whole number."""
    try:
        number = operator.index(value)
    except TypeError:
        number = least - 1
    if number < least or isinstance(value, bool):
        raise Hint(f"{name} = {value!r}: a whole number of at least {least} is needed", f"{name} = {max(least, 1)}")
    return number


def bare_number(value: object, table: Callable[[float], dict[str, Any]], need: str, advice: str) -> Any:
    """Return the table for a bare number or percentage; return any other table unchanged."""
    if isinstance(value, bool):
        return value
    value = plain(value)
    if isinstance(value, Real):
        return table(value if isinstance(value, (int, float)) else float(value))
    if isinstance(value, (str, list, tuple)):
        raise Hint(need, advice)
    return value


def _make(unit: str, check: Any = None) -> Any:
    read, *rest = quantity(unit)
    checks = [] if check is None else [BeforeValidator(check)]
    return (*checks, read, *rest)  # before-validators run from right to left


Length = Annotated[float, *_make("m")]
PositiveLength = Annotated[float, *_make("m", _positive)]
NotNegativeLength = Annotated[float, *_make("m", _not_negative)]
PositiveMass = Annotated[float, *_make("kg", _positive)]
NotNegativeMass = Annotated[float, *_make("kg", _not_negative)]
Stiffness = Annotated[float, *_make("N/m", _not_negative)]
BendingStiffness = Annotated[float, *_make("N m^2", _positive)]
PlateStiffness = Annotated[float, *_make("N m", _positive)]
MassPerLength = Annotated[float, *_make("kg/m", _positive)]
MassPerArea = Annotated[float, *_make("kg/m^2", _positive)]
PositiveStiffness = Annotated[float, *_make("N/m", _positive)]
Damping = Annotated[float, *_make("N s/m", _not_negative)]
Force = Annotated[float, *_make("N")]
Velocity = Annotated[float, *_make("m/s")]
PositiveVelocity = Annotated[float, *_make("m/s", _positive)]
Acceleration = Annotated[float, *_make("m/s^2")]
Time = Annotated[float, *_make("s")]
PositiveTime = Annotated[float, *_make("s", _positive)]
NotNegativeTime = Annotated[float, *_make("s", _not_negative)]
Frequency = Annotated[float, *_make("Hz", _not_negative)]
PositiveFrequency = Annotated[float, *_make("Hz", _positive)]
Modulus = Annotated[float, *_make("Pa", _positive)]
Density = Annotated[float, *_make("kg/m^3", _positive)]
Angle = Annotated[float, *_make("rad")]
NotNegativeAngle = Annotated[float, *_make("rad", _not_negative)]
AngularVelocity = Annotated[float, *_make("rad/s")]
Number = Annotated[float, Field(allow_inf_nan=False), BeforeValidator(plain)]
Whole = Annotated[int, BeforeValidator(not_boolean)]
