"""TDMS files of LabVIEW and DIAdem, read by npTDMS."""

from __future__ import annotations

import logging
import re
import struct
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import DataError
from rattlebox._util.optional_imports import optional_import

from .formats import SignalInFile, record_reader
from .guarded import errors_of

_WHOLE = "the complete file, as LabVIEW wrote it"
_LEAD_IN = 28  # bytes before the content of a segment
_BIG_ENDIAN = 1 << 6  # flag of a segment
_UNFINISHED = 2**64 - 1  # length of a segment whose writer was stopped
_TIMES = re.compile(r"(?:time|zeit|temps|tiempo|tempo|t)(?:[ _]?[(\[]?(?:s|sec|seconds)[)\]]?)?", re.I)
_OTHER_AXIS = re.compile(r"freq|hz|order|rpm", re.I)
_LISTED = 12  # channels in a message
_SHOWN = 200  # characters of a message of the library
_MODULES = ("types", "reader", "tdms", "tdms_segment", "base_segment", "channel_data", "daqmx", "scaling")
_NAMES_OF_UNIT = ("unit_string", "NI_UnitDescription", "unit")


@record_reader(".tdms", starts=(b"TDSm",), starts_at_first=True, needs_unit=True)
def tdms_signals(path: Path) -> list[SignalInFile]:
    """Return the channels of numbers over time; those without a sampling interval have times of NaN.

    References
    ----------
    National Instruments: TDMS file format internal structure.
    """
    nptdms = optional_import("nptdms", "tdms", "export the channels as CSV")
    with errors_of(path, "a TDMS file"):
        notes = _check_segments(path)
        try:
            with _messages_of_library() as messages:
                file = nptdms.TdmsFile.read(str(path))
        except NotImplementedError as error:  # a damaged type of data
            raise DataError(f"{path} cannot be read as a TDMS file: {error}", _WHOLE) from None
        if messages and not notes:
            raise DataError(f"{path} is damaged, or of a newer version: {messages[0]}", _WHOLE)
        channels = [(group, channel) for group in file.groups() for channel in group.channels()]
        names = Counter(channel.name for _, channel in channels)
        signals: list[SignalInFile] = []
        others: list[str] = []
        for group, channel in channels:
            name = channel.name if names[channel.name] == 1 else f"{group.name}/{channel.name}"
            values = np.asarray(channel[:])
            reason = _reason_against(channel, values)
            if reason:
                others.append(f"{name} ({reason})")
                continue
            properties = channel.properties
            times, time_unit = _times(path, name, group, channel)
            signals.append(
                SignalInFile(
                    times,
                    values.astype(np.float64),
                    name,
                    _unit(properties),
                    time_unit,
                    notes=notes,
                )
            )
        if not signals:
            found = ", ".join(others[:_LISTED]) or "no channel"
            raise DataError(f"{path} contains no time history, but {found}", "a file with channels of numbers")
        return signals


@contextmanager
def _messages_of_library() -> Iterator[list[str]]:
    """Collect the warnings that the library prints, such as those of values that it cannot place."""
    messages: list[str] = []

    def keep(record: logging.LogRecord) -> bool:
        messages.append(" ".join(record.getMessage().split())[:_SHOWN])
        return False

    loggers = [logging.getLogger(f"nptdms.{module}") for module in _MODULES]
    for logger in loggers:
        logger.addFilter(keep)
    try:
        yield messages
    finally:
        for logger in loggers:
            logger.removeFilter(keep)


def _check_segments(path: Path) -> tuple[str, ...]:
    """Return a note if the writer of the last segment was stopped; raise if the file is cut short or no TDMS file."""
    size = path.stat().st_size
    position = 0
    with path.open("rb") as stream:
        while position < size:
            stream.seek(position)
            head = stream.read(_LEAD_IN)
            if not head.startswith(b"TDSm"):
                raise DataError(f"{path}, byte {position}: no segment of a TDMS file begins here", _WHOLE)
            if len(head) < _LEAD_IN:
                break
            flags = struct.unpack("<I", head[4:8])[0]
            length, _ = struct.unpack(">QQ" if flags & _BIG_ENDIAN else "<QQ", head[12:28])
            if length == _UNFINISHED:
                return ("the program that wrote the file was stopped; the samples up to then are read",)
            position += _LEAD_IN + length
    if position != size or size == 0:
        raise DataError(f"{path} is cut short: its last segment is not complete", _WHOLE)
    return ()


def _reason_against(channel: Any, values: NDArray[Any]) -> str:
    """Return why a channel is no time history; "" if it is."""
    if values.dtype.kind not in "fiu" or values.ndim != 1:
        return "no numbers"
    if values.size < 2:
        return f"{values.size} samples"
    axis = " ".join(str(channel.properties.get(key, "")) for key in ("wf_xname", "wf_xunit_string"))
    if _OTHER_AXIS.search(axis):
        return f"over {axis.strip()[:40]}"
    return "times" if _TIMES.fullmatch(channel.name.strip()) and bool(np.all(np.diff(values) > 0)) else ""


def _unit(properties: Any) -> str:
    """Return the unit of a channel; "" if it states none."""
    return next((str(properties[key]).strip() for key in _NAMES_OF_UNIT if properties.get(key)), "")


def _times(path: Path, name: str, group: Any, channel: Any) -> tuple[NDArray[np.float64], str]:
    """Return times and their unit, of the waveform or of the channel of times of the group; NaN if there are none."""
    count = len(channel)
    step = channel.properties.get("wf_increment")
    if step:
        step, start = float(step), float(channel.properties.get("wf_start_offset", 0.0))
        if not (step > 0 and np.isfinite(start + step * count)):
            raise DataError(
                f"{path}: {name} has the increment {step:g} and the offset {start:g}", "an increment greater than zero"
            )
        unit = str(channel.properties.get("wf_xunit_string", "")).strip()
        return start + step * np.arange(count, dtype=np.float64), unit
    for other in group.channels():
        if other is channel or len(other) != count:
            continue
        values = np.asarray(other[:])
        if values.dtype.kind == "M":  # time stamps
            return np.asarray((values - values[0]) / np.timedelta64(1, "ns") * 1e-9, dtype=np.float64), "s"
        if values.dtype.kind in "fiu" and _TIMES.fullmatch(other.name.strip()) and bool(np.all(np.diff(values) > 0)):
            return values.astype(np.float64), _unit(other.properties)
    return np.full(count, np.nan), ""
