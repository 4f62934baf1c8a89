"""Strong-motion files: K-NET and KiK-net, SMC of the USGS, V2 of COSMOS and CSMIP, ASCII of ESM and ITACA, CSMNC."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import DataError

from .formats import SignalInFile, record_reader
from .guarded import errors_of

# Possessive, and never from within a number: thousands of digits before a letter would take cubic time.
_NUMBER = re.compile(r"(?:[-+]|(?<![\d.]))(?:\d++\.?+\d*+|\.\d++)(?:[EeDd][-+]?\d{1,3}+)?+(?=[-+\s]|$)")
_FORMAT = re.compile(r"\(\s*\d*\(?(?:1p,?)?\s*\d*[fe](\d+)\.", re.I)
_WHOLE = "the complete file, as it was downloaded"
_SHOWN = 60  # characters of a line in a message
_SMC_TEXT, _SMC_INTEGERS, _SMC_REALS = 11, 48, 50  # lines of text and numbers in the header of an SMC file
_SMC_UNITS = {"accel": "cm/s^2", "veloc": "cm/s", "displ": "cm"}
_UNDEFINED = 1e37  # magnitude from which a real number of a header is a mark of absence
_OFFSET = 0.1  # mean over peak from which a note reports the mean of raw samples


class _File(NamedTuple):
    """The lines of a file, with its path for messages."""

    path: Path
    lines: list[str]

    def error(self, index: int, expected: str) -> DataError:
        """Return the error of a line: its number, what was found and what is expected."""
        found = self.lines[index].strip()[:_SHOWN] if index < len(self.lines) else "the end of the file"
        return DataError(f"{self.path}, line {index + 1}: {found!r} is found, but {expected} is expected", _WHOLE)

    def numbers(self, index: int, width: int | None = None) -> list[float]:
        """Return the numbers of a line, also if no blank is between them: then in columns of this width."""
        line = self.lines[index]
        try:
            return [float(word) for word in line.split()]
        except ValueError:
            pass
        cells = [line[k : k + width] for k in range(0, len(line.rstrip()), width)] if width else _NUMBER.findall(line)
        if width is None and _NUMBER.sub("", line).strip():
            raise self.error(index, "a row of numbers")
        try:
            return [float(cell.replace("D", "E").replace("d", "e")) for cell in cells]
        except ValueError:
            raise self.error(index, "a row of numbers") from None

    def samples(self, first: int, end: int, width: int | None = None) -> NDArray[np.float64]:
        """Return the finite samples of the lines from one up to another."""
        values: list[float] = []
        for index in range(first, end):
            row = self.numbers(index, width)
            if not np.isfinite(row).all():
                raise self.error(index, "a row of finite numbers")
            values += row
        if not values:
            raise self.error(first, "a row of samples")
        return np.array(values)

    def samples_until(self, first: int, count: int, width: int | None = None) -> tuple[NDArray[np.float64], int]:
        """Return a number of finite samples that begin in a line, and the index of the line after them."""
        values: list[float] = []
        index = first
        while len(values) < count and index < len(self.lines):
            row = self.numbers(index, width) if self.lines[index].strip() else []
            if not np.isfinite(row).all():
                raise self.error(index, "a row of finite numbers")
            values += row
            index += 1
        if len(values) != count:
            raise DataError(
                f"{self.path} states {count} samples below line {first}, but contains {len(values)}", _WHOLE
            )
        return np.array(values), index

    def check_count(self, stated: int, found: int) -> tuple[str, ...]:
        """Return a note if there are fewer samples than the header states; raise if there are more."""
        if found > stated:
            raise DataError(f"{self.path} states {stated} samples, but contains {found}", _WHOLE)
        short = f"its header states {stated} samples, but {found} are in the file, which may be cut short"
        return (short,) if found < stated else ()


def _read(path: Path) -> _File:
    """Return the lines of a file without blank ones at its end."""
    lines = path.read_text(encoding="latin-1").splitlines()
    while lines and not lines[-1].strip(" \x1a"):
        lines.pop()
    return _File(path, lines)


def _even(step: float, values: NDArray[np.float64], **fields: Any) -> SignalInFile:
    """Return a signal whose first sample is at 0 s."""
    return SignalInFile(np.arange(values.size, dtype=float) * step, values, **fields)


def _positive(file: _File, text: str, what: str) -> float:
    """Return a positive and finite number of a header."""
    try:
        number = float(text)
    except ValueError:
        number = np.nan
    if not 0 < number < _UNDEFINED:
        raise DataError(f"{file.path} states {text.strip()[:_SHOWN]!r} as {what}; a positive number is needed", _WHOLE)
    return number


@record_reader(".ew", ".ns", ".ud", ".ew1", ".ns1", ".ud1", ".ew2", ".ns2", ".ud2", starts=(b"Origin Time",))
def knet_signals(path: Path) -> list[SignalInFile]:
    """Return the record of a K-NET or KiK-net file, in gal.

    Notes
    -----
    The samples are readings of a converter times the scale factor of the header; their mean is not subtracted.

    References
    ----------
    National Research Institute for Earth Science and Disaster Resilience (NIED), K-NET, KiK-net,
    doi:10.17598/NIED.0004: the ASCII format.
    """
    with errors_of(path, "a K-NET file"):
        file = _read(path)
        memo = next((k for k, line in enumerate(file.lines[:40]) if line.startswith("Memo")), None)
        if memo is None:
            raise DataError(f"{path}: no line of its header begins with 'Memo.'; a K-NET file needs one", _WHOLE)
        header = {line[:17].strip(): line[17:].strip() for line in file.lines[: memo + 1]}
        for name in ("Sampling Freq(Hz)", "Scale Factor"):
            if name not in header:
                raise DataError(f"{path}: its header has no line {name!r}; a K-NET file needs it", _WHOLE)
        frequency = header["Sampling Freq(Hz)"]
        rate = _positive(file, re.sub(r"\s*hz$", "", frequency, flags=re.I), "sampling frequency [Hz]")
        factor = re.fullmatch(r"([\d.]+)\s*\(\s*gal\s*\)\s*/\s*([\d.]+)", header["Scale Factor"], re.I)
        if not factor:
            raise DataError(
                f"{path} states the scale factor {header['Scale Factor'][:_SHOWN]!r}, not one such as 2000(gal)/8388608",
                _WHOLE,
            )
        scale = _positive(file, factor[1], "scale factor") / _positive(file, factor[2], "divisor of the scale factor")
        values = scale * file.samples(memo + 1, len(file.lines))
        notes: tuple[str, ...] = ()
        if "Duration Time(s)" in header:
            duration = _positive(file, header["Duration Time(s)"], "duration [s]")
            if abs(values.size - duration * rate) > rate:
                notes = (f"its header states {duration:g} s, but it contains {values.size / rate:g} s",)
        mean = float(values.mean())
        if abs(mean) > _OFFSET * float(np.abs(values).max()):
            notes += (f"the samples have a mean of {mean:.4g} gal, which is not subtracted",)
        return [_even(1 / rate, values, name=header.get("Dir.", ""), unit="gal", notes=notes)]


@record_reader(".smc")
def smc_signals(path: Path) -> list[SignalInFile]:
    """Return the record of an SMC file of the US Geological Survey.

    References
    ----------
    US Geological Survey, National Strong Motion Project: the SMC format, documented with the program BAP.
    """
    with errors_of(path, "an SMC file"):
        file = _read(path)
        title = file.lines[0] if file.lines else ""
        quantity = re.search(r"accel|veloc|displ", title, re.I)
        if not quantity:
            raise DataError(
                f"{path}, line 1: {title.strip()[:_SHOWN]!r} is found, but a title with 'ACCELEROGRAM', 'VELOCITY' or "
                "'DISPLACEMENT' is expected",
                "a time history in the SMC format",
            )
        integers, index = file.samples_until(_SMC_TEXT, _SMC_INTEGERS, 10)
        reals, index = file.samples_until(index, _SMC_REALS, 15)
        comments, count = int(integers[15]), int(integers[16])
        rate = _positive(file, f"{reals[1]:g}", "sampling rate [Hz]")
        comments = max(comments, 0)
        if any(not line.startswith("|") for line in file.lines[index : index + comments]):
            raise file.error(index, f"{comments} lines of comment that begin with '|'")
        index += comments
        while index < len(file.lines) and file.lines[index].startswith("|"):
            raise file.error(index, "the first row of samples")
        values = file.samples(index, len(file.lines), 10)
        unit = _SMC_UNITS[quantity[0].lower()]
        return [_even(1 / rate, values, unit=unit, notes=file.check_count(count, values.size))]


_BLOCK = re.compile(r"^\s*(\d+)\s+(?:points\s+of\s+)?(accel|veloc|displ)\w*\s+(?:data|pts)\b(.*)$", re.I)
_SPACED = re.compile(r"equally\s+spaced\s+at\s+([\d.]+(?:E[-+]?\d+)?)\s*sec", re.I)
_BLOCK_UNIT = re.compile(r"(?:units?\s*[=:]|\bin\b)\s*([^\s,;()]+)", re.I)
_APPROX = re.compile(r"approx\s+([\d.]+)\s*secs?", re.I)
_REALS = re.compile(r"^\s*(\d+)\s+real-header\s+values.*?(?:format\s*=\s*(\(.*))?$", re.I)
_COSMOS_STEP = 62  # number of the real value of a COSMOS header with the time step [ms]
_NAMES = {"accel": "acceleration", "veloc": "velocity", "displ": "displacement"}


@record_reader(".v1", ".v2", ".v2c", ".v1c")
def cosmos_signals(path: Path) -> list[SignalInFile]:
    """Return the records of a V2 file of COSMOS or CSMIP: accelerations, and those that are integrated from them.

    References
    ----------
    COSMOS Strong Motion Programs Board (2001): COSMOS strong motion data format, version 1.20, Richmond, California.
    """
    with errors_of(path, "a V2 file"):
        file = _read(path)
        signals, step, channel, index = [], None, 1, 0
        while index < len(file.lines):
            line = file.lines[index]
            index += 1
            if (reals := _REALS.match(line)) and int(reals[1]) >= _COSMOS_STEP:
                numbers, index = file.samples_until(index, int(reals[1]), _width(reals[2] or ""))
                step = numbers[_COSMOS_STEP - 1] / 1000
                continue
            block = _BLOCK.match(line)
            spaced = _SPACED.search(line)
            if not block or not (spaced or "pts" in line.lower()):
                continue
            dt = _positive(file, spaced[1] if spaced else f"{step}", "time step")
            count = int(block[1])
            about = _APPROX.search(line)
            # Two statements of the length: a time step of other units, or of another channel, breaks one of them.
            if about and abs(float(about[1]) - count * dt) > 1.5 + 0.02 * count * dt:
                raise DataError(
                    f"{path}, line {index}: {count} samples of {dt:g} s are {count * dt:g} s, but {about[1]} s are stated",
                    _WHOLE,
                )
            unit = _BLOCK_UNIT.search(block[3])
            if not unit:
                raise file.error(index - 1, "a unit, such as 'in cm/sec2', in the line above samples")
            values, index = file.samples_until(index, count, _width(block[3]))
            kind = block[2].lower()
            name = f"{_NAMES[kind]} {channel}"
            # Without a second statement of the length nothing checks the time step of the header.
            from_header = f"the time step of {dt:g} s is real value {_COSMOS_STEP} of its header"
            notes = () if spaced or about else (from_header,)
            is_derived = kind != "accel"
            signals.append(_even(dt, values, name=name, unit=unit[1].strip("."), notes=notes, is_derived=is_derived))
            if kind == "displ" or _begins_channel(file.lines[index : index + 3]):
                channel += 1
        if not signals:
            raise DataError(
                f"{path}: no line states a number of points of acceleration, such as '2000 points of accel data equally "
                "spaced at .005 sec, in cm/sec2'",
                "a V2 file of COSMOS or CSMIP",
            )
        return signals


def _width(text: str) -> int | None:
    """Return the width of a column of a Fortran format, such as (8f10.3); None if there is none."""
    match = _FORMAT.search(text)
    return int(match[1]) or None if match else None


def _begins_channel(lines: Sequence[str]) -> bool:
    """Return whether lines below samples end a channel before its displacements."""
    text = " ".join(lines).lower()
    return "end" in text and "data" in text and not any(_BLOCK.match(line) for line in lines)


@record_reader(contents=rb"(?:^|\n)SAMPLING_INTERVAL_S\s*:")
def esm_signals(path: Path) -> list[SignalInFile]:
    """Return the record of an ASCII file of the Engineering Strong Motion database (ESM) or ITACA.

    References
    ----------
    L. Luzi et al. (2016): The engineering strong-motion database, Seismological Research Letters 87, 987-997,
    doi:10.1785/0220150278.
    """
    with errors_of(path, "an ESM file"):
        file = _read(path)
        header: dict[str, str] = {}
        first = next((k for k, line in enumerate(file.lines) if ":" not in line), len(file.lines))
        for line in file.lines[:first]:
            key, _, text = line.partition(":")
            header[key.strip().upper()] = text.strip()
        for name in ("SAMPLING_INTERVAL_S", "NDATA", "UNITS"):
            if not header.get(name):
                raise DataError(f"{path}: its header does not state {name}; an ESM file needs it", _WHOLE)
        step = _positive(file, header["SAMPLING_INTERVAL_S"], "time step [s]")
        count = _positive(file, header["NDATA"], "number of samples")
        values = file.samples(first, len(file.lines))
        notes = file.check_count(int(count), values.size)
        name = header.get("STREAM", "")
        return [_even(step, values, name=name, unit=header["UNITS"], notes=notes)]


_CSMNC = re.compile(
    r"NO\.?\s*OF\s*POINTS\s*:?\s*(\d+)\s+EQUALLY\s+SPACED\s+INTERVALS?\s+OF\s*:?\s*([\d.]+(?:E[-+]?\d+)?)\s*SEC", re.I
)
_CSMNC_UNIT = re.compile(r"\bUNITS?\s*:\s*(\S+)", re.I)


@record_reader(contents=rb"NO\.?\s*OF\s*POINTS\s*:?\s*\d+\s+EQUALLY\s+SPACED\s+INTERVALS?\s+OF")
def csmnc_signals(path: Path) -> list[SignalInFile]:
    """Return the record of a file of the China Strong Motion Networks Center (CSMNC)."""
    with errors_of(path, "a CSMNC file"):
        file = _read(path)
        stated = [(k, match) for k, line in enumerate(file.lines[:40]) if (match := _CSMNC.search(line))]
        if len(stated) != 1:
            raise DataError(f"{path} states the number of its points in {len(stated)} lines of its header", _WHOLE)
        (at, match) = stated[0]
        units = [found[1] for line in file.lines[: at + 1] if (found := _CSMNC_UNIT.search(line))]
        if len(units) != 1:
            raise DataError(f"{path} states the unit of its samples in {len(units)} lines, not in one", _WHOLE)
        # Free text is between the number of points and the samples, mostly four lines.
        first = next((k for k in range(at + 1, len(file.lines)) if _is_row(file.lines[k])), len(file.lines))
        values = file.samples(first, len(file.lines))
        return [
            _even(
                _positive(file, match[2], "time step [s]"),
                values,
                unit=units[0],
                notes=file.check_count(int(match[1]), values.size),
            )
        ]


def _is_row(line: str) -> bool:
    """Return whether a line has numbers, and nothing else."""
    return bool(line.strip()) and not _NUMBER.sub("", line).strip()
