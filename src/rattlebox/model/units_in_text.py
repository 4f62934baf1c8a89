"""Units in the text of files: above a column, and in free lines above a table."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from .errors import Hint
from .units import factor_of, names_of_units, unit_name

Line = tuple[int, str]
"""Number and text of a line of a file."""

_SHOWN = 60  # characters of a text of a file in a message
_BRACKETED = re.compile(r"[\[(]([^\[\]()]*)[\])]")
_PRODUCT = re.compile(r"[/*·]\s*\(")
_LABELS = re.compile(r"[txyzTXYZ]|\d*")
"""Text in brackets at the end of a heading that is a label: a(t), a (X), force (1)."""

# A unit in running text: "g", "cm/s^2", "CM/SEC/SEC", "m s^-2", "cm / s2". Words and numbers next to it are not part of it.
_UNIT = r"(?:[^\W\d_]+(?:\s+s\^?-2|\s?/\s?\(?s(?:ec)?[\d^*²)]*(?:\s?/\s?s(?:ec)?)?)?|[^\s,;:()\[\]\"']+)"
_END = r"(?=$|[\s,;:.()\[\]\"'])"
_WORDS = (
    r"(?:unit[eéà]?s?|einheit(?:en)?|unidade?s?|eenheid|enhet|jednostka|jednotka|birim)(?![^\W\d_])|единица|单位|単位"
)
_WORD = rf"(?<![^\W_])(?:{_WORDS})(?:[ _-](?:label|[xyz\d])(?![^\W_]))?"
_OF = r"(?:\s+[^\W\d_]+){1,3}\s*[:=]"  # "units of acceleration:"
_TIME_FIRST = r"(?:(?:s|ms|secs?|seconds)\s*[,;]\s*)?"  # "units: s, g" of two columns
_MARKED = re.compile(
    rf"{_WORD}(?:{_OF}|\s*(?:of|is|are|in)?\s*[:=;,]?)\s*{_TIME_FIRST}[(\[\"']?\s*({_UNIT}){_END}", re.I
)
_IN = re.compile(rf"\b(?:in|en|em)\s+[(\[]?({_UNIT}){_END}", re.I)
_BARE = re.compile(r"(?<![\w/^.-])([^\W\d_]+\s?/\s?\(?s(?:ec)?[\d^*²)]*(?:\s?/\s?s(?:ec)?)?|m?gals?)(?![\w/^])", re.I)
_CLOSING = re.compile(r"[,;)\]]")
_AFTER_NUMBER = re.compile(r"[\d.]\s*[(\[]?$")
_SEPARATED = re.compile(r"[\s,_]+")
_QUANTITIES = {
    "m/s^2": re.compile(r"acc|beschl|aceler|acel|versnelling|przyspiesz|zrychl|ivme|ускор|加速度", re.I),
    "N": re.compile(r"force|load|kraft|forza|fuerza|força|kracht|siła|síla|kuvvet|сила|荷重", re.I),
    "m": re.compile(
        r"disp|deflection|weg\b|stroke|dépl|depl|desp|spost|desloc|verplaats|przemiesz|výchyl|перемещ|位移|変位", re.I
    ),
}
"""Words that show that a unit of free text is the unit of the values; also of "in cm" and "(N)", which are ambiguous."""


_BESIDE_THE_VALUES = ("", "time", "frequency", "mass", "angle", "stiffness", "damping coefficient")
"""Quantities that lines above a record state of other things, such as the sampling."""


@dataclass(frozen=True)
class Stated:
    """A unit that a text states."""

    factor: float
    unit: str
    number: int
    line: str


def unit_above(heads: Sequence[str], units: tuple[str, ...]) -> tuple[float, str] | None:
    """Return the factor to SI and the SI unit from the header lines of a column; None if they have no unit.

    `heads`: text above the column, from top to bottom: a name, a unit, or both, as in "a (g)", "t [ms]", "force in N" or
    "a/g".
    """
    for head in reversed(heads):
        brackets = _BRACKETED.findall(head)
        known = None if brackets else factor_of(head, units)
        words = _SEPARATED.split(head.strip())
        name, _, rest = head.partition("/")  # "a/g", "t / s": a quantity over its unit
        parts = [*brackets, *_IN.findall(head), *([rest] if name.strip().isalnum() else [])]
        is_amount = len(words) > 1 and words[-2][-1:].isdigit() and words[-2][:1].isdigit()  # "stroke 10 mm"
        if (
            len(words) > 1
            and not is_amount
            and "(" not in head
            and "[" not in head
            and words[-1] not in ("N", "m", "in", "t", "h")
        ):
            parts.append(words[-1])  # "Acc g", "acc_g"; N may be north, and in an input
        for part in reversed(parts):
            known = known or factor_of(part, units)
        if not known and _PRODUCT.search(head):  # "m/(s^2)", but not "a (cm/s)", which would be years times cm/s
            known = factor_of(head, units)
        if known:
            return known
        last = brackets[-1].strip() if brackets and head.rstrip()[-1] in ")]" else ""
        unknown = None if _LABELS.fullmatch(last) else last
        if unknown is None and "/" in head and unit_name(head):
            unknown = head.strip()  # a line of units, such as "s,mm/s"
        if unknown is not None:
            raise Hint(
                f"{unknown[:_SHOWN]!r}, written above the column as {head[:_SHOWN]!r}, is not a unit of "
                f"{' or '.join(unit_name(si) for si in units)}; known: {', '.join(names_of_units(units))}",
                f'unit = "{names_of_units(units)[0]}", if the numbers have this unit',
            )
    return None


def units_in_lines(lines: Sequence[Line], units: tuple[str, ...]) -> tuple[list[Stated], list[Stated]]:
    """Return the units that free lines above a table state for its values, and those that they only mention."""
    stated: dict[tuple[float, str], Stated] = {}
    mentioned: dict[tuple[float, str], Stated] = {}
    for number, line in lines:
        for text, is_stated in _units_in(line, units):
            known = factor_of(text, units)
            if known:
                (stated if is_stated else mentioned).setdefault(known, Stated(*known, number, line.strip()))
        other = next((match[1] for match in _MARKED.finditer(line) if not factor_of(match[1], units)), None)
        if other and unit_name(other) not in _BESIDE_THE_VALUES:
            kinds = " or ".join(unit_name(si) for si in units)
            raise Hint(
                f"line {number}, {line.strip()[:60]!r}, states {other!r}, which is not a unit of {kinds}",
                f'unit = "{names_of_units(units)[0]}", if the numbers have this unit',
            )
    return list(stated.values()), [each for key, each in mentioned.items() if key not in stated]


def _units_in(line: str, units: tuple[str, ...]) -> Iterator[tuple[str, bool]]:
    """Yield texts that may be units, and whether the line states them as the unit of the values."""
    yield line, True  # nothing but a unit
    end = 0
    for match in sorted((*_MARKED.finditer(line), *_IN.finditer(line), *_BRACKETED.finditer(line)), key=_place):
        whole = _CLOSING.split(line[match.start(1) :])[0]  # "meters per second squared", not "meters"
        text = whole if factor_of(whole, units) else match[1]
        known = factor_of(text, units)
        is_marked = match.re is _MARKED
        if match.start(1) >= end and known and (is_marked or known[1] == "m/s^2" or _QUANTITIES[known[1]].search(line)):
            yield text, True
            end = match.start(1) + len(text)
    for match in _BARE.finditer(line, end):
        yield match[1], not _AFTER_NUMBER.search(line[: match.start()])


def _place(match: re.Match[str]) -> int:
    return match.start(1)
