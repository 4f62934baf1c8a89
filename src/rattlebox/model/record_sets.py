"""Sets of records by name, such as the ground motions of a study."""

from __future__ import annotations

import glob
import math
import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox._util.oscillator import MIN_SAMPLES_PER_PERIOD, peaks

from .errors import Hint, at, several
from .recorded import Record
from .units import parse

Source = str | os.PathLike[str]
_GLOB = frozenset("*?[")  # characters of a pattern
_EVEN = 0.02  # differences of equal steps over a step
_LISTED = 12  # records in a message or a representation


class RecordSet(Mapping[str, Record]):
    """Records by name; as values of an axis of a study, their names are its coordinate.

    Parameters
    ----------
    records
        Records by name; `rb.record_set` reads them from files.

    Examples
    --------
    >>> import rattlebox as rb
    >>> pulses = rb.RecordSet({k: rb.Record(dt="0.1 s", values=[0, 1, 0], scale=k) for k in (1, 2)})
    >>> list(pulses), pulses.durations
    (['1', '2'], (0.2, 0.2))
    """

    def __init__(self, records: Mapping[Any, Record]) -> None:
        if not records:
            raise Hint("a set of records needs at least one record", 'rb.record_set("quakes/*.at2")')
        for name, record in records.items():
            if not isinstance(record, Record):
                raise Hint(f"{name!r} is {record!r:.60}, not a record", 'rb.Record.from_file("quake.at2")')
        self._records = {str(name): _named(record, str(name)) for name, record in records.items()}
        if len(self._records) < len(records):
            raise Hint("two records have the same name", "another name for one of them")

    def __getitem__(self, name: str) -> Record:
        if name not in self._records:
            raise KeyError(f"{name!r}; the records are {_listed(self._records)}")
        return self._records[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._records)

    def __len__(self) -> int:
        return len(self._records)

    def __repr__(self) -> str:
        return f"RecordSet of {several(len(self), 'record')}: {_listed(self._records)}"

    @property
    def durations(self) -> tuple[float, ...]:
        """Longest run that each record covers [s]."""
        return tuple(float(record.polyline()[0][-1]) for record in self.values())

    def spectral_accelerations(self, period: float | str, damping_ratio: float = 0.05) -> dict[str, float]:
        r"""Compute the spectral acceleration of each record at a period.

        Parameters
        ----------
        period
            Period T of the oscillator [s]; 0 for the peak of the record.
        damping_ratio
            Damping ratio of the oscillator.

        Returns
        -------
        dict of str to float
            Pseudo-acceleration by the name of the record [m/s^2].

        Raises
        ------
        CaseError
            If a record is no acceleration in equal time steps, or its steps are longer than half of the period.

        Notes
        -----
        .. math:: S_a(T) = \left(\frac{2 \pi}{T}\right)^2 \max |z(t)|

        with the displacement :math:`z` relative to the base of an oscillator that starts at rest, during the record and
        after it. This pseudo-acceleration is what codes mean by the spectral acceleration.

        Examples
        --------
        >>> import numpy as np
        >>> import rattlebox as rb
        >>> time = np.arange(3001) * 0.01
        >>> waves = rb.RecordSet({"wave": rb.Record(dt="0.01 s", values=np.sin(2 * np.pi * time), unit="m/s^2")})
        >>> round(waves.spectral_accelerations("1 s")["wave"], 2)  # 1 / (2 x 0.05) at resonance
        10.0
        """
        seconds = _seconds(period)
        return {name: _spectral_acceleration(record, seconds, damping_ratio) for name, record in self.items()}

    def scaled_to(self, acceleration: float | str, period: float | str, damping_ratio: float = 0.05) -> RecordSet:
        """Scale each record to the same spectral acceleration at a period.

        Parameters
        ----------
        acceleration
            Spectral acceleration of the scaled records [m/s^2]. With "1 g", values of an axis "base.scale" are spectral
            accelerations in g.
        period, damping_ratio
            As for `spectral_accelerations`; a period of 0 scales to the peak acceleration.

        Returns
        -------
        RecordSet
            Records with the same names and the numbers of the scaled signal, without files; their `scale` is 1.

        Raises
        ------
        CaseError
            If a record is zero throughout, or has no spectral acceleration (see `spectral_accelerations`).

        Examples
        --------
        >>> import rattlebox as rb
        >>> pulses = rb.RecordSet({k: rb.Record(dt="0.1 s", values=[0, k, 0, 0], unit="g") for k in (1, 2)})
        >>> stronger = pulses.scaled_to("0.5 g", period="0.4 s")
        >>> {name: round(value / 9.80665, 6) for name, value in stronger.spectral_accelerations("0.4 s").items()}
        {'1': 0.5, '2': 0.5}
        """
        with at("acceleration"):
            wanted = parse(acceleration, ("m/s^2",))[0]
            if not wanted > 0:
                raise Hint("must be greater than zero", '"1 g"')
        scaled = {}
        for name, now in self.spectral_accelerations(period, damping_ratio).items():
            if not now > 0:
                raise Hint(f"the record {name!r} has no acceleration, so that it cannot be scaled", "a set without it")
            scaled[name] = _multiplied(self[name], wanted / now)
        return RecordSet(scaled)


def record_set(
    files: Source | Sequence[Source] | Mapping[str, Source | Record],
    *,
    names: Sequence[str] | None = None,
    intensity: tuple[float | str, float | str] | None = None,
    **fields: Any,
) -> RecordSet:
    r"""Read several records, each by the unit and the time step of its file.

    Parameters
    ----------
    files
        A folder, of which all files are read except hidden ones; a pattern such as `quakes/*.at2`; a list of files; or a
        mapping of names to files or records. Folders and patterns are read in the order of the names of their files.
    names
        Names of the records, one for each file; default the names of the files without their ending, or with it if several
        differ only in the ending.
    intensity
        Spectral acceleration and period to which each record is scaled, such as ("1 g", "0.8 s"), with a damping ratio of
        5 %; a period of 0 means the peak. See `RecordSet.scaled_to`.
    **fields
        Fields of all records (see `rb.Record`), such as unit, dt, direction.

    Returns
    -------
    RecordSet
        The records by name.

    Raises
    ------
    DataError
        If there is no file, or one of them cannot be read.
    CaseError
        If two records have the same name, or the fields do not fit a file.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> for name, unit, peak in [("north", "g", 0.1), ("south", "gal", 200)]:
    ...     text = f"time (s), acceleration ({unit})\n0, 0\n1, {peak}\n2, 0\n"
    ...     _ = (folder / f"{name}.csv").write_text(text)
    >>> quakes = record_set(folder)
    >>> {name: round(quake.peak, 6) for name, quake in quakes.items()}
    {'north': 0.980665, 'south': 2.0}
    """
    if isinstance(files, RecordSet) and not fields and names is None and intensity is None:
        return files
    if isinstance(files, Mapping):
        if names is not None:
            raise Hint("a mapping of files has names already", "leave names out")
        named = {str(name): each for name, each in files.items()}
    else:
        paths = _paths(files)
        named = dict(zip(_names(paths, names), paths, strict=True))
    records = {}
    for name, each in named.items():
        if isinstance(each, Record):
            if fields:
                raise Hint(f"{name!r} is a record already, which has its own {', '.join(fields)}", "the name of a file")
            records[name] = each
        else:
            records[name] = Record(file=os.fspath(each), name=name, **fields)
    found = RecordSet(records)
    if intensity is None:
        return found
    with at("intensity"):
        if isinstance(intensity, str) or np.shape(intensity) != (2,):
            raise Hint(f"{intensity!r:.60} is not a spectral acceleration and a period", 'intensity = ["1 g", "0.8 s"]')
        return found.scaled_to(*intensity)


def _seconds(period: Any) -> float:
    """Return a period [s]; raise if it is negative."""
    with at("period"):
        seconds = parse(period, ("s",))[0]
        if not seconds >= 0:
            raise Hint("must be at least 0", '"0.8 s", or 0 for the peak acceleration')
    return seconds


def _spectral_acceleration(record: Record, period: float, damping_ratio: float) -> float:
    """Return the pseudo-acceleration of a record [m/s^2]."""
    if record.unit not in ("m/s^2", None):
        raise Hint(
            f"the record {record.name!r} is in {record.unit}, not an acceleration", "records of the acceleration"
        )
    if not 0 <= damping_ratio < 1:
        raise Hint(f"damping_ratio is {damping_ratio}, but it must be at least 0 and below 1", "0.05")
    times, values = record.polyline()
    if period == 0:
        return float(np.abs(values).max())
    steps = np.diff(times)
    step = float(times[-1] - times[0]) / steps.size
    # Times of text files are rounded, often to a few digits.
    if np.ptp(steps) > _EVEN * step:
        raise Hint(
            f"the steps of the record {record.name!r} must be equal, but are {steps.min():.4g} to {steps.max():.4g} s",
            "rb.Record(dt=step, values=numpy.interp(even_times, times, values))",
        )
    if step * MIN_SAMPLES_PER_PERIOD > period:
        raise Hint(
            f"a period of {period:.4g} s is too short for the record {record.name!r}, sampled every {step:.4g} s",
            f"a period of at least {MIN_SAMPLES_PER_PERIOD * step:.4g} s",
        )
    omega = 2 * math.pi / period
    return omega**2 * peaks(values, step, omega, damping_ratio)[2]


def _multiplied(record: Record, factor: float) -> Record:
    """Return a record with other values and without its file."""
    times, values = record.polyline()
    own = {*record.file_fields, "kind", "file", "columns", "dt", "scale", "time_zero", "unit"}
    others = {name: value for name in type(record).model_fields if name not in own and (value := getattr(record, name))}
    return Record(times=times, values=factor * values, unit="m/s^2", **others)


def _paths(files: Source | Sequence[Source]) -> list[str]:
    """Return the files in a folder, of a pattern, or of a list."""
    if not isinstance(files, (str, os.PathLike)):
        if not isinstance(files, Sequence) or not all(isinstance(each, (str, os.PathLike)) for each in files):
            raise Hint(f"{files!r:.60} is neither a folder, a pattern nor a list of files", '"quakes/*.at2"')
        paths = [os.fspath(each) for each in files]
        if not paths:
            raise DataError("the list has no files", '["first.at2", "second.at2"]')
        return paths
    text = os.fspath(files)
    if Path(text).is_dir():
        paths = sorted(str(each) for each in Path(text).iterdir() if each.is_file() and not each.name.startswith("."))
        if not paths:
            raise DataError(f"the folder {text} contains no files", "the folder of the records")
        return paths
    if Path(text).is_file():
        return [text]
    if not _GLOB & set(text):
        raise DataError(f"there is no folder and no file {text}", 'a pattern such as "quakes/*.at2"')
    paths = sorted(each for each in glob.glob(text, recursive=True) if Path(each).is_file())
    if not paths:
        raise DataError(f"no file matches {text}", "the pattern of existing files, with * for any text")
    return paths


def _names(paths: Sequence[str], names: object) -> list[str]:
    """Return the names of the records in these files."""
    if names is not None:
        if isinstance(names, str) or not isinstance(names, Sequence) or len(names) != len(paths):
            count = len(names) if isinstance(names, Sequence) and not isinstance(names, str) else 1
            raise Hint(
                f"{several(count, 'name')} for {several(len(paths), 'file')}: {_listed(Path(p).name for p in paths)}",
                "one name for each file, in this order",
                ["names"],
            )
        found = [str(name) for name in names]
    else:
        files = [Path(path) for path in paths]
        found = [file.stem for file in files]
        if len(set(found)) < len(found):
            found = [file.name for file in files]
    twice = [name for name, count in Counter(found).items() if count > 1]
    if twice:
        raise Hint(f"{twice[0]!r} is the name of two records", "names, one for each file", ["names"])
    return found


def _named(record: Record, name: str) -> Record:
    return record if record.name == name else record.model_copy(update={"name": name})


def _listed(names: Any) -> str:
    names = [" ".join(str(name).split()) for name in names]
    return ", ".join(names[:_LISTED]) + (f" and {len(names) - _LISTED} more" if len(names) > _LISTED else "")
