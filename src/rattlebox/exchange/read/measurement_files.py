"""Files of measurement programs: LabVIEW measurement files (.lvm) and sound files (.wav)."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np

from rattlebox._util.exceptions import DataError

from .formats import SignalInFile, record_reader
from .guarded import errors_of

_END = "***End_of_Header***"
_WHOLE = "the complete file, as LabVIEW wrote it"
_SHOWN = 60  # characters of a line in a message
_SEPARATORS = {"tab": "\t", "comma": ",", "semicolon": ";"}


@record_reader(".lvm", starts=(b"LabVIEW Measurement",), starts_at_first=True, needs_unit=True)
def lvm_signals(path: Path) -> list[SignalInFile]:
    """Return the channels of a LabVIEW measurement file, each segment for itself.

    References
    ----------
    National Instruments: Specification for the LabVIEW measurement file (.lvm).
    """
    with errors_of(path, "an LVM file"):
        lines = path.read_text(encoding="latin-1").splitlines()
        if not lines or not lines[0].startswith("LabVIEW Measurement"):
            raise DataError(
                f"{path}, line 1: {''.join(lines[:1])[:_SHOWN]!r} is found, but 'LabVIEW Measurement' is expected",
                "the ending .txt for columns of numbers without that header",
            )
        words = [line.replace(",", "\t").replace(";", "\t").split("\t") for line in lines[:40]]
        head = {cells[0]: cells[1].strip() for cells in words if len(cells) > 1}
        mark = _SEPARATORS.get(head.get("Separator", "Tab").lower())
        comma = lines[:40] and any(
            line.rstrip() in ("Decimal_Separator\t,", "Decimal_Separator;,") for line in lines[:40]
        )
        if mark is None:
            raise DataError(f"{path} states the separator {head['Separator'][:_SHOWN]!r}", "Tab, Comma or Semicolon")
        ends = [k for k, line in enumerate(lines) if line.startswith(_END)]
        if len(ends) < 2:
            raise DataError(
                f"{path} has {len(ends)} lines {_END!r}; one of the file and one of a segment are needed", _WHOLE
            )
        signals: list[SignalInFile] = []
        for number, end in enumerate(ends[1:], start=1):
            stop = next((k for k in range(end + 1, len(lines)) if lines[k].startswith("Channels")), len(lines))
            start = max(
                k for k in range(ends[number - 1], end) if k == ends[number - 1] or lines[k].startswith("Channels")
            )
            suffix = f", segment {number}" if len(ends) > 2 else ""
            columns = head.get("X_Columns", "One").lower()
            signals += _segment(path, lines, (start, end, stop), mark, bool(comma), columns, suffix)
        return signals


def _segment(
    path: Path, lines: list[str], place: tuple[int, int, int], mark: str, comma: bool, columns: str, suffix: str
) -> list[SignalInFile]:
    """Return the channels between a line of Channels, the end of its header, and the next segment."""
    start, end, stop = place
    # The header of the segment: a word and a value for each channel.
    header = {
        cells[0].strip(): [cell.strip() for cell in cells[1:]]
        for k in range(start, end)
        if (cells := lines[k].split(mark))
    }
    names = [cell.strip() for cell in lines[end + 1].split(mark)] if end + 1 < stop else []
    count = int(header.get("Channels", ["0"])[0])
    width = 2 if columns == "multi" else 1
    if not count >= 1 or columns not in ("no", "one", "multi") or len(names) < (2 * count if width == 2 else count + 1):
        raise DataError(f"{path}, line {start + 1}: a number of channels with a name each below is expected", _WHOLE)

    def number(text: str, row: int) -> float:
        try:
            value = float(text.replace(",", ".") if comma else text)
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            raise DataError(f"{path}, line {row + 1}: {text[:_SHOWN]!r} is found, but a number is expected", _WHOLE)
        return value

    signals = []
    rows = [(k, [cell.strip() for cell in lines[k].split(mark)]) for k in range(end + 2, stop) if lines[k].strip()]
    for channel in range(count):
        # Each channel has its own times, or all have those of the first column; a shorter one ends in empty cells.
        of_x, of_y = (2 * channel, 2 * channel + 1) if width == 2 else (0, channel + 1)
        kept = [(k, cells) for k, cells in rows if len(cells) > of_y and cells[of_y]]
        dimension = header.get("X_Dimension", [])
        if channel < len(dimension) and dimension[channel] not in ("Time", ""):
            raise DataError(
                f"{path}: channel {channel + 1} is over {dimension[channel][:_SHOWN]!r}, not over time",
                "a time history",
            )
        stated = header.get("Samples", [])
        if channel < len(stated) and stated[channel] and number(stated[channel], start) != len(kept):
            raise DataError(
                f"{path} states {stated[channel][:_SHOWN]} samples of {names[of_y][:_SHOWN]!r}, but contains {len(kept)}",
                _WHOLE,
            )
        # Without times the header has the first one and the step.
        if columns == "no":
            first, step = (
                number(header.get(key, [])[channel] if channel < len(header.get(key, [])) else "", start)
                for key in ("X0", "Delta_X")
            )
            times = first + step * np.arange(len(kept), dtype=np.float64)
        else:
            times = np.array([number(cells[of_x], k) for k, cells in kept], dtype=np.float64)
        values = np.array([number(cells[of_y], k) for k, cells in kept])
        units = header.get("Y_Unit_Label", [])
        unit = units[channel] if channel < len(units) else ""
        signals.append(SignalInFile(times, values, name=names[of_y] + suffix, unit=unit))
    return signals


@record_reader(".wav", needs_unit=True, needs_scale=True)
def wav_signals(path: Path) -> list[SignalInFile]:
    """Return the channels of a sound file: whole numbers as fractions of full scale, others as they are."""
    from scipy.io import wavfile

    with errors_of(path, "a WAV file"), warnings.catch_warnings():
        warnings.simplefilter("ignore", wavfile.WavFileWarning)  # of chunks with other content
        warnings.filterwarnings("error", "Reached EOF", wavfile.WavFileWarning)
        rate, data = wavfile.read(path)
        if not rate > 0 or not data.size:
            raise DataError(f"{path} contains {data.size} samples at {rate} Hz", "a complete WAV file with samples")
        table = data.reshape(len(data), -1).astype(float)
        if data.dtype.kind == "u":
            table = (table - 128) / 128
        elif data.dtype.kind == "i":
            table = table / 2.0 ** (8 * data.dtype.itemsize - 1)
        if not np.isfinite(table).all():
            raise DataError(f"{path} contains a sample that is not finite", "a complete WAV file")
        times = np.arange(len(table), dtype=np.float64) / float(rate)
        return [SignalInFile(times, column, name=f"channel {k}") for k, column in enumerate(table.T, start=1)]
