"""Power spectral densities in files: tables of frequency and density, and functions of universal files."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox.exchange.read.formats import DensityInFile, density_reader
from rattlebox.exchange.read.guarded import errors_of

from .errors import Hint, several
from .files import Array, check_finite, existing
from .records import Column, read_pairs
from .signals import UNITS
from .units import density_factor, factor_of
from .units_in_text import unit_above

_UNIT = 'unit = "g", if the densities are in g^2/Hz'
_SHOWN = 60  # characters of a text of a file in a message
_LARGEST_TEXT = 300  # characters of a line that are searched for a unit
_PER_HERTZ = re.compile(r"/\s*k?(?:hz|hertz)\b\)?|[m²2]\s*/\s*s\s*(?:\^?3\b|³)", re.I)
_ROOT = re.compile(r"(?:/\s*|per\s+)(?:sqrt|√|root|rt)\s*\(?\s*hz|hz\s*\^?\s*\(?\s*(?:1/2|0?\.5)", re.I)
_DECIBEL = re.compile(r"(?<![a-z])dB(?![a-z])", re.I)
_OTHER_MEASURE = re.compile(
    r"/\s*oct|[\s·*.-]s(?:ec)?\s*/\s*hz|hz\)?\s*[\s·*.]\s*s(?:ec)?\b|\bESD\b|energy spectral", re.I
)
_TWO_SIDED = re.compile(r"\b(?:two|double|2)[- ]?sided\b|\bzweiseitig|\bbilat[eé]ral", re.I)
_PEAK = re.compile(r"\bpeak(?:[- ]hold|[- ]to[- ]peak)?\b|\bmax(?:imum)?[- ]hold\b", re.I)
_ANGULAR = re.compile(r"rad\s*/\s*s|\bomega\b|ω", re.I)


def read_density(path: str, columns: Sequence[Column] | None, unit: str | None) -> tuple[Array, str, tuple[str, ...]]:
    """Read a one-sided power spectral density.

    `unit`: unit of the signal, whose square per Hz is that of the density, as the user states it. Returns frequencies [Hz]
    and densities in SI units, (n, 2); and SI unit of the signal; and notes on assumptions.
    """
    file = existing(path)
    found = _density(file, columns)
    name = " ".join(file.name.split())
    try:
        to_hertz = _hertz(found)
        (factor, si), notes = _unit_of(found, unit, name)
    except Hint as hint:
        raise DataError(f"{name}: {hint.complaint}", hint.suggestion, hint.place) from None
    f, S = (check_finite(np.asarray(each, dtype=float), path) for each in (found.frequencies, found.densities))
    _check(f, S, name)
    texts = [found.name, *(text for _, text in found.lines)]
    if peak := next((text for text in texts if _PEAK.search(text)), ""):
        raise DataError(
            f"{name} states a peak, {peak.strip()[:_SHOWN]!r}; a density is a mean square per Hz",
            "a linear average, exported as power spectral density",
        )
    two_sided = next((text for text in texts if _TWO_SIDED.search(text)), "")
    # A density of zero has no logarithm: outside of the band it is none, inside of it the file is at fault.
    used = np.flatnonzero((f > 0) & (S > 0))
    if used.size < 2:
        raise DataError(f"{name} has {several(int(used.size), 'line')} with a density greater than zero", "two or more")
    if used.size <= used[-1] - used[0]:
        k = int(np.setdiff1d(np.arange(used[0], used[-1]), used)[0])
        raise DataError(
            f"{name}: the density at {f[k]:.6g} Hz, between others, is 0, which no line in log-log scales has",
            "the line left out, or a small density",
        )
    if used.size < f.size:
        notes.append(f"the density of {name} is 0 outside of {f[used[0]]:.6g} to {f[used[-1]]:.6g} Hz")
    if two_sided:
        notes.append(f"the density of {name} is two-sided, as {two_sided.strip()[:_SHOWN]!r} states, and is doubled")
    else:
        notes.append(f"the density of {name} is read as one-sided, a mean square per Hz of positive frequencies")
    corners = np.column_stack((f, S * factor * (2 if two_sided else 1)))[used]
    corners[:, 0] *= to_hertz
    return corners, si, tuple(notes)


def states_density(path: Path) -> bool:
    """Return whether the second column of a table states the unit of a density above it."""
    try:
        found = read_pairs(str(path), None)
    except DataError:
        return False
    return any(density_factor(part, UNITS) for head in found.headings[1] for part in _parts(head))


def density_names(path: Path) -> list[str]:
    """Return the names of the densities in a file of a program; an empty list for a table."""
    form = density_reader.of(path)
    if form is None:
        return []
    try:
        return [each.name or f"number {number}" for number, each in enumerate(form.read(path), start=1)]
    except DataError:  # the reader of records has the message
        return []


def _density(file: Path, columns: Sequence[Column] | None) -> DensityInFile:
    """Return a density of a file: two columns of a table, or a function by its name or number."""
    form = density_reader.of(file)
    if form is None:
        table = read_pairs(str(file), columns)
        over, above = (" ".join(head) for head in table.headings)
        return DensityInFile(table.times, table.values, above, above, over, table.lines)
    with errors_of(file, "a power spectral density"):
        every = list(form.read(file))
    if columns is not None and len(columns) == 2:
        raise DataError(f"{file} has functions, not columns", "columns = [1], the number or name of one")
    names = [each.name for each in every]
    if columns is None and len(every) > 1:
        raise DataError(f"{file} contains {len(every)} densities ({', '.join(names)})", "columns = [1]")
    wanted: Column = columns[0] if columns else 1
    if names.count(str(wanted)) > 1:
        raise DataError(f"{file} contains {names.count(str(wanted))} densities {wanted!r}", "its number, from 1 on")
    index = names.index(str(wanted)) if wanted in names else wanted - 1 if isinstance(wanted, int) else -1
    if not 0 <= index < len(every):
        raise DataError(f"{file} contains no density {wanted!r}, but {', '.join(names)}", "columns = [1]")
    return every[index]


def _unit_of(found: DensityInFile, wanted: str | None, name: str) -> tuple[tuple[float, str], list[str]]:
    """Return the factor of a density to SI, the SI unit of the signal, and notes."""
    above = found.unit
    if text := next((each for each in (above, found.name) if _ROOT.search(each)), ""):
        raise Hint(f"{text.strip()[:_SHOWN]!r} is the root of a density", "its square, in g^2/Hz or (m/s^2)^2/Hz")
    if _OTHER_MEASURE.search(above):
        raise Hint(f"{above.strip()[:_SHOWN]!r} is no mean square per Hz", "densities such as g^2/Hz")
    if _DECIBEL.search(above):
        raise Hint(f"{above.strip()[:_SHOWN]!r} are decibels of an unknown reference", "densities such as g^2/Hz")
    own = None
    if wanted is not None:
        known = factor_of(wanted, UNITS)
        if known is None:
            raise Hint(f"{wanted!r} is not a unit of force, acceleration or displacement", 'unit = "g"', ["unit"])
        own = known[0] ** 2, known[1]
    stated = next((known for part in _parts(above) if (known := density_factor(part, UNITS))), None)
    if stated is not None:
        if own is not None and not (own[1] == stated[1] and np.isclose(own[0], stated[0])):
            raise Hint(
                f"the file states another unit of the density: {above.strip()[:_SHOWN]!r}", "unit left out", ["unit"]
            )
        return stated, []
    if own is not None:
        return own, []
    if unknown := next((part for part in _parts(above)), ""):
        raise Hint(f"{unknown[:_SHOWN]!r} is no unit of a density of force, acceleration or displacement", _UNIT)
    if known := factor_of(above, UNITS) or _plain_unit(above):
        raise Hint(
            f"{above.strip()[:_SHOWN]!r} states the unit of {known[1]}, not that of a density",
            f"{_UNIT}; the square of the values, if they are the root of a density",
        )
    # In the lines above the table, of which only one unit is clear.
    lines = {
        factor: (number, text)
        for number, text in found.lines
        for part in _parts(text)
        if (factor := density_factor(part, UNITS))
    }
    if len(lines) == 1:
        ((factor, (number, text)),) = lines.items()
        return factor, [f"the unit of {name} is taken from line {number}, {text.strip()[:_SHOWN]!r}"]
    if lines:
        raise Hint(f"its lines state {len(lines)} units of a density", _UNIT)
    raise Hint("no unit of the density is stated", _UNIT)


def _plain_unit(heading: str) -> tuple[float, str] | None:
    """Return the unit of a signal above a column; None if it has none."""
    try:
        return unit_above([heading], UNITS)
    except Hint:
        return None


def _parts(text: str) -> Iterator[str]:
    """Yield the parts of a text that end with a unit per Hz, the longest ones first."""
    text = text[:_LARGEST_TEXT]
    for match in _PER_HERTZ.finditer(text):
        end = match.end() - (match[0].endswith(")") and text.count("(") != text.count(")"))
        starts = [0, *(k + 1 for k in range(match.start()) if text[k] in " ([=:,;\t")]
        known = [text[start:end].strip() for start in starts]
        for part in known:
            yield part
            yield part.removesuffix(")")


def _hertz(found: DensityInFile) -> float:
    """Return the factor of the frequencies to Hz."""
    text = found.frequency_unit
    if _ANGULAR.search(text):
        raise Hint(
            f"{text.strip()[:_SHOWN]!r} is an angular frequency, and a density is per Hz",
            "frequencies in Hz and densities per Hz",
        )
    if known := factor_of(text, ("Hz",)):
        return known[0]
    try:
        return (unit_above([text], ("Hz",)) or (1.0, "Hz"))[0] if text else 1.0
    except Hint as hint:
        raise Hint(
            hint.complaint, "frequencies in Hz, with columns = [2, 1] if they are not the first column"
        ) from None


def _check(frequencies: Array, densities: Array, name: str) -> None:
    """Raise if the numbers are not those of a density."""
    if frequencies.size != densities.size or frequencies.size < 2:
        raise DataError(f"{name} has {several(int(frequencies.size), 'line')} of a density", "two or more")
    steps = np.flatnonzero(np.diff(frequencies) <= 0)
    if steps.size:
        k = int(steps[0])
        raise DataError(
            f"{name}: frequencies must rise, but {frequencies[k + 1]:.6g} follows {frequencies[k]:.6g}",
            "columns = [2, 1], if frequencies and densities are swapped",
        )
    if frequencies[0] < 0:
        raise DataError(
            f"{name} has negative frequencies, from {frequencies[0]:.6g} on: the density is two-sided",
            "the lines of positive frequencies, with doubled densities",
        )
    bad = np.flatnonzero(densities < 0)
    if bad.size:
        k = int(bad[0])
        raise DataError(
            f"{name}: the density {densities[k]:.6g} at {frequencies[k]:.6g} Hz is negative",
            "densities rather than decibels or values of a spectrum",
        )
