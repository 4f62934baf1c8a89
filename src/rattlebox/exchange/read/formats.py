"""Registries of the formats of files: each reader registers the endings, or the first bytes, of its files.

A file of modes is read to `ModesInFile`, a file of time histories to a list of `SignalInFile`: arrays with their names and
units. The model converts units and selects points and signals, the same for all formats.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import DataError
from rattlebox._util.plugins import Registry, load_plugins, owner_of

from .guarded import errors_of
from .modes_in_file import ModesInFile

BINARY_TABLES = (".npy", ".npz", ".mat")
"""Endings of tables of numbers that are not text."""

_START = 4096  # bytes that show the format of a file

Read = TypeVar("Read", bound=Callable[..., Any])


@dataclass(frozen=True, eq=False)
class SignalInFile:
    """A time history in a file."""

    # Times [s] or in `time_unit`, NaN if the file does not state them, and values in `unit`, (n,)
    times: NDArray[np.float64]
    values: NDArray[np.float64]
    name: str = ""  # Name by which `columns` of a record selects it
    unit: str = ""  # Unit as the file writes it, such as "g" or "m/s^2"; "" if the file states none
    time_unit: str = ""  # Unit of the times as the file writes it, if they may be in another one than s
    lines: tuple[tuple[int, str], ...] = ()  # Numbers and texts of the lines above the values, in which a unit may be
    notes: tuple[str, ...] = ()  # Notes on assumptions, which a run reports
    # Whether it is computed from another one of the file, and therefore not read unless `columns` selects it
    is_derived: bool = False


@dataclass(frozen=True, eq=False)
class DensityInFile:
    """A power spectral density in a file."""

    frequencies: NDArray[np.float64]  # Frequencies in `frequency_unit`, and mean squares per frequency in `unit`, (n,)
    densities: NDArray[np.float64]
    name: str = ""  # Name by which `columns` of a random vibration selects it
    unit: str = ""  # Unit as the file writes it, such as "g^2/Hz"; "" if the file states none
    frequency_unit: str = ""  # Unit of the frequencies as the file writes it; "" stands for Hz
    # Numbers and texts of the lines above the values, in which conventions may be
    lines: tuple[tuple[int, str], ...] = ()


@dataclass(frozen=True)
class ModesRequest:
    """What a case asks of a file of modes."""

    count: int | None = None
    """Number of modes; None for those that the file has."""
    has_mass_unit: bool = False
    """Whether the user states the unit of mass, so that contradicting units of the file are no error."""


class Format(NamedTuple, Generic[Read]):
    """A reader, and what is known about its files."""

    read: Read
    starts_at_first: bool = False
    """Whether the first point of a record is 0 s of a run, unless `time_zero` sets another."""
    needs_unit: bool = False
    """Whether a record without a unit is refused, because its values are rarely in SI units."""
    needs_scale: bool = False
    """Whether a record without a scale is refused, because its values are fractions of full scale."""


class Formats(Generic[Read]):
    """Readers by the ending of a file, or by its first bytes for files without a known ending."""

    def __init__(self, content: str) -> None:
        self._endings: Registry[Format[Read]] = Registry(f"ending of a file of {content},")
        self._starts: Registry[Format[Read]] = Registry(f"start of a file of {content},")
        self._contents: Registry[Format[Read]] = Registry(f"content of a file of {content},")

    def __call__(
        self,
        *endings: str,
        starts: Sequence[bytes] = (),
        contents: bytes = b"",
        starts_at_first: bool = False,
        needs_unit: bool = False,
        needs_scale: bool = False,
    ) -> Callable[[Read], Read]:
        """Register a function as the reader of files with an ending, such as ".uff", or with some first bytes.

        `contents` is a regular expression that is found in the first bytes of files without an ending of their own.
        """

        def register(read: Read) -> Read:
            form = Format(read, starts_at_first, needs_unit, needs_scale)
            if contents:
                self._contents.add(contents.hex(), form, owner_of(read))
            for ending in endings:
                self._endings.add(ending.lower(), form, owner_of(read))
            for start in starts:
                self._starts.add(start.hex(), form, owner_of(read))
            return read

        return register

    def of(self, path: str | Path, *, has_content: bool = True) -> Format[Read] | None:
        """Return the format of a file; None if neither its ending nor its start is known.

        Without `has_content` the expressions of `contents` are not tried.
        """
        load_plugins()
        path = Path(path)
        known = self._endings.get(path.suffix.lower())
        is_of_tables = known is not None and known.read is no_signals
        if known is not None and (path.suffix.lower() in BINARY_TABLES or not is_of_tables):
            return known
        if not self._starts and not self._contents:
            return known
        if not path.is_file():  # a pipe would wait for a writer; the reader of tables of numbers has the message
            return known
        try:
            with path.open("rb") as file:
                start = file.read(_START)
        except OSError:  # the reader of tables of numbers has the message
            return known
        of_start = (form for key, form in self._starts.items() if start.startswith(bytes.fromhex(key)))
        of_content = (
            form for key, form in self._contents.items() if has_content and re.search(bytes.fromhex(key), start)
        )
        return next(chain(of_start, of_content), known)

    @property
    def endings(self) -> Sequence[str]:
        """Endings of all readers, also of other packages."""
        load_plugins()
        return tuple(self._endings)


modes_reader: Formats[Callable[[Path, ModesRequest], ModesInFile | Mapping[str, Any]]] = Formats("modes")
"""Decorator of functions of a path and a `ModesRequest` that return the modes in a file."""

record_reader: Formats[Callable[[Path], Iterable[SignalInFile]]] = Formats("records")
"""Decorator of functions of a path that return the time histories in a file."""

density_reader: Formats[Callable[[Path], Iterable[DensityInFile]]] = Formats("power spectral densities")
"""Decorator of functions of a path that return the power spectral densities in a file; tables need none."""


@record_reader(".csv", ".txt", ".tsv", *BINARY_TABLES)
def no_signals(path: Path) -> list[SignalInFile]:
    """Return nothing: tables of numbers have columns, which the model reads (`rattlebox.model.records`)."""
    return []


def signals_in(path: Path, form: Format[Callable[[Path], Iterable[SignalInFile]]]) -> list[SignalInFile]:
    """Return the time histories in a file; raise if there is none, or one is no series of numbers."""
    with errors_of(path, "a record"):
        signals = list(form.read(path))
        for number, signal in enumerate(signals, start=1):
            times, values = np.shape(signal.times), np.shape(signal.values)
            if times != values or len(times) != 1:
                raise DataError(
                    f"{path}: the time history {number} has times of the shape {times} and values of the shape {values}",
                    "a reader that returns as many times as values",
                )
    if not signals:
        raise DataError(f"{path} contains no time history", "a file with a time history")
    return signals
