"""Ground motions of the PEER database: accelerations (.AT2), displacements (.DT2); velocities (.VT2) are refused."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import DataError, unreadable

from .formats import SignalInFile, record_reader
from .guarded import errors_of

_COUNT = re.compile(r"NPTS\s*=\s*(\d+)", re.I)
_STEP = re.compile(r"DT\s*=\s*(\d*\.?\d*(?:E[-+]?\d+)?)", re.I)
_MILLISECONDS = re.compile(r"DT\s*=\s*[\d.E+-]+\s*(?:ms|milli)", re.I)
_OLD_HEADER = re.compile(r"^\s*(\d+)\s+(\d*\.?\d*(?:E[-+]?\d+)?)\s+NPTS\s*,\s*DT", re.I)
_UNIT = re.compile(r"UNITS?\s+OF\s+(\S+)", re.I)
_QUANTITY = re.compile(r"\b(accel|velocity|displacement)", re.I)
_QUANTITIES = {".at2": "accel", ".vt2": "velocity", ".dt2": "displacement"}
_JOINED = re.compile(r"(?<=\d)(?=-)")
_WHOLE = "the file as it was downloaded"
_HEADER = 12  # most lines of the header
_DIGITS = 12  # from which a number of samples is absurd


@dataclass(frozen=True, eq=False)
class GroundMotion:
    """Evenly spaced samples of a ground acceleration, or of a ground displacement."""

    step: float  # Time between samples [s]
    values: NDArray[np.float64]  # Samples, in `unit`, (n,)
    unit: str
    lines: tuple[tuple[int, str], ...] = ()


def read_ground_motion(path: Path) -> GroundMotion:
    """Read an AT2 file.

    Notes
    -----
    The sample with index k = 0, 1, ... is the acceleration at the time k DT. The values are used as they are, without a
    correction of the baseline; those of the database are filtered and corrected.

    References
    ----------
    T. D. Ancheta et al., NGA-West2 database, Earthquake Spectra 30 (2014) 989-1005, doi:10.1193/070913EQS197M.
    """
    with errors_of(path, "an AT2 file"):
        try:
            lines = path.read_text(encoding="latin-1").splitlines()
        except OSError as error:
            raise unreadable(path, error) from None
        above, count, step = _header(path, lines)
        header = "\n".join(lines[:above])
        _check_quantity(path, header)
        values = _values(path, lines, above, count)
        samples = np.array(values)
        if not np.isfinite(samples).all():
            raise DataError(f"{path}: sample {int(np.argmin(np.isfinite(samples))) + 1} is not finite", _WHOLE)
        unit = _UNIT.search(header)
        return GroundMotion(
            float(step), samples, unit[1].strip(".,()") if unit else "", tuple(enumerate(lines[:above], start=1))
        )


def _header(path: Path, lines: list[str]) -> tuple[int, int, str]:
    """Return how many lines the header has, the number of samples and the time step that its last line states."""
    # The number of header lines differs between editions of the format: the last one is that with count and step.
    above, count, step = 0, "", ""
    for line in lines[:_HEADER]:
        above += 1
        old = _OLD_HEADER.match(line)
        count, step = (old[1], old[2]) if old else (_first_group(_COUNT, line), _first_group(_STEP, line))
        if count and step:
            break
    else:
        raise DataError(
            f"{path}: none of the first {min(_HEADER, len(lines))} lines states NPTS and DT; an AT2 file needs both",
            'the ending .csv or .txt, and dt = "0.01 s" for one column of numbers',
        )
    if not (_is_positive(step) and len(count) < _DIGITS):
        raise DataError(
            f"{path}, line {above}: the time step is {step} s and the number of samples {count[:_DIGITS]}; both must be"
            " positive and finite",
            _WHOLE,
        )
    if _MILLISECONDS.search(lines[above - 1]):
        step = repr(float(step) / 1000)
    return above, int(count), step


def _check_quantity(path: Path, header: str) -> None:
    """Raise if a file contains velocities, or another quantity than its ending says."""
    # The three quantities have the same layout: the header decides, and the ending if it does not say.
    named = {match.lower() for match in _QUANTITY.findall(header)}
    kind = path.suffix.lower()
    quantity = "accel" if "accel" in named else next(iter(sorted(named)), _QUANTITIES.get(kind, "accel"))
    if quantity == "velocity" or (kind == ".vt2" and quantity == "accel"):
        raise DataError(
            f"{path} contains a velocity, not an acceleration",
            "the file with the ending .AT2, or .DT2 for a motion",
        )
    if quantity != _QUANTITIES.get(kind, quantity):
        raise DataError(
            f"{path} contains {'a displacement' if quantity == 'displacement' else 'an acceleration'} by its header, "
            f"but not by its ending {path.suffix}",
            "the ending .DT2 for displacements, .AT2 for accelerations",
        )


def _values(path: Path, lines: list[str], above: int, count: int) -> list[float]:
    """Return the samples below the header."""
    values: list[float] = []
    for number, line in enumerate(lines[above:], start=above + 1):
        try:
            values += _row(line)
        except ValueError:
            if len(values) == count:
                continue  # such as "*** End Data ***"
            raise DataError(f"{path}, line {number}: {line.strip()[:40]!r} is not a row of numbers", _WHOLE) from None
    # The stated number is the only sign of a truncated file.
    if len(values) != count:
        raise DataError(
            f"{path} states {count} samples, but contains {len(values)}",
            "the complete file: it may be cut short" if len(values) < count else _WHOLE,
        )
    return values


@record_reader(".at2", ".vt2", ".dt2", needs_unit=True)
def ground_motion_signals(path: Path) -> list[SignalInFile]:
    """Return the record of an AT2 or DT2 file."""
    motion = read_ground_motion(path)
    times = np.arange(motion.values.size, dtype=float) * motion.step
    return [SignalInFile(times, motion.values, unit=motion.unit, lines=motion.lines)]


def _row(line: str) -> list[float]:
    """Return the numbers of a line, also with exponents of Fortran, or without blanks before minus signs."""
    try:
        return [float(word) for word in line.split()]
    except ValueError:
        return [float(word) for word in _JOINED.sub(" ", line.upper().replace("D", "E")).split()]


def _is_positive(text: str) -> bool:
    try:
        return 0 < float(text) < float("inf")
    except ValueError:
        return False


def _first_group(pattern: re.Pattern[str], line: str) -> str:
    match = pattern.search(line)
    return match[1] if match else ""
