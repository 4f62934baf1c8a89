"""Records: signals that were measured, or made by other programs."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BaseModel, BeforeValidator, PrivateAttr, model_serializer, model_validator

from rattlebox._util.exceptions import DataError

from .elementwise import Vector
from .errors import Hint, at
from .files import absolute
from .records import Column, Columns, as_columns, read_columns
from .signals import UNIT_NAMES, UNITS, Sampled
from .units import Number, numbers, unit_above


def _in_si(found: Columns, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return times and values of a file, with unit and scale as given, or else as stated above the columns.

    Raises
    ------
    DataError
        If the file states a unit that is unknown.
    Hint
        If the unit is of another kind than the one given.
    """
    times, values, (above_times, above_values) = found
    try:
        slower, _ = unit_above(above_times, ("s",)) or (1.0, "s")
    except Hint as hint:
        raise DataError(hint.complaint, 'times in seconds below the heading "time (s)"', ["file"]) from None
    read = {"times": times * slower if slower != 1 else times, "values": values}
    if given.get("scale") is not None:
        return read
    wanted = given.get("unit")
    try:
        written = unit_above(above_values, UNITS)
    except Hint as hint:
        if wanted in UNITS:
            return read  # the numbers are in the unit that is given
        advice = 'unit = "m/s^2", and scale = ..., the factor from the numbers to that unit'
        raise DataError(hint.complaint, advice, ["file"]) from None
    if written is None:
        return read
    scale, unit = written
    if wanted in UNITS and wanted != unit:
        raise Hint(
            f"the file has {UNIT_NAMES[unit]} in this column, not {UNIT_NAMES[wanted]}",
            f"another column, or scale = ..., what its numbers are multiplied by to be in {wanted}",
            ["unit"],
        )
    return {**read, "unit": wanted or unit, "scale": scale}


def _column(value: Any) -> tuple[float, ...]:
    try:
        array = numbers(value)
    except Hint as hint:
        advice = 'numbers alone: times in s, values in `unit` ("N"), which are multiplied by `scale`'
        raise Hint(hint.complaint, hint.suggestion or advice, hint.place) from None
    if array.ndim != 1:
        raise Hint(f"one row of numbers is needed, not shape {array.shape}")
    return tuple(array.tolist())


class Record(Sampled):
    """A record, straight lines between points; it must cover the whole run.

    Samples of a signal lose high frequencies: the straight lines between samples at a rate R multiply the amplitude at
    frequency f by sinc^2(f / R) = (sin(pi f / R) / (pi f / R))^2, and add images at k R +- f, of amplitude
    sinc^2(k +- f / R). It is 1 % at 18 samples a period, 3 % at 10 and 19 % at 4. A run warns where this changes the
    response of a mode by more than 2 %.

    Parameters
    ----------
    times
        Strictly increasing [s].
    values, scale
        As many, in `unit`, and what they are multiplied by. Left out, `scale` is 1, or follows from the unit in the file.
    file, columns
        Instead of both: a CSV, NPY, NPZ or MAT file, and its columns of times and values, by number counted from 1 or by
        name: `columns=(1, 3)`, `columns=("t", "a")`. Variables count in the order of the file. They may be left out where
        there are only two, or variables called time and value. Units above the columns of a text file, as in "time (ms),
        acceleration (g)", are converted; unknown ones are refused. Without them times are in s, and values in `unit`; if
        neither states a unit, the run notes the unit that is assumed, and the peak.
    """

    in_file: ClassVar[tuple[str, ...]] = ("times", "values")
    kind: Literal["record"] = "record"
    times: Annotated[tuple[float, ...], BeforeValidator(_column)] = ()
    values: Annotated[tuple[float, ...], BeforeValidator(_column)] = ()
    file: str | None = None
    columns: tuple[Column, Column] | None = None
    scale: Number = 1.0
    _unit_is_assumed: bool = PrivateAttr(default=False)

    @model_validator(mode="before")
    @classmethod
    def _from_file(cls, values: Any) -> Any:
        if not isinstance(values, dict):
            return values
        if values.get("file") is None:
            if values.get("columns") is not None:
                raise Hint("columns are those of a file", 'file = "push.csv"', ["columns"])
            return values
        if "times" in values or "values" in values:
            raise Hint(
                "give times and values, or a file, not both", 'columns = ["time", "force"] names those of the file'
            )
        with at("columns"):
            columns = as_columns(values.get("columns"))
        with at("file"):
            path = absolute(values["file"])
            found = read_columns(path, columns)
        return {**values, **_in_si(found, values), "file": path}

    @model_validator(mode="after")
    def _sound(self) -> Record:
        if len(self.times) != len(self.values):
            raise Hint(f"{len(self.times)} times, but {len(self.values)} values", "as many of both")
        if len(self.times) < 2:
            raise Hint("a record needs at least two points", place=self.where)
        steps = np.flatnonzero(np.diff(self.times) <= 0)
        if steps.size:
            raise Hint(
                f"times must increase, but point {int(steps[0]) + 2} is not later than the one before",
                "columns = [2, 1], if times and values are swapped" if self.file else "",
                self.where,
            )
        BaseModel.__setattr__(self, "_unit_is_assumed", self.file is not None and self.unit is None)
        return self

    @property
    def unit_is_assumed(self) -> bool:
        """Whether neither the file nor the user states the unit of the values."""
        return self._unit_is_assumed

    @property
    def where(self) -> tuple[str, ...]:
        """The field that gives the numbers, for messages."""
        return ("file",) if self.file else ("times",)

    @model_serializer(mode="wrap")
    def _file_stands_for_numbers(self, handler: Any) -> Any:
        data = handler(self)
        if self.file is not None:
            for name in self.in_file:
                data.pop(name, None)
        if self._unit_is_assumed:
            data.pop("unit", None)
        return data

    @classmethod
    def from_file(cls, path: str | os.PathLike[str], **options: Any) -> Record:
        """Read a record from a CSV, NPY, NPZ or MAT file.

        Parameters
        ----------
        path
            The file; times in seconds, unless it says otherwise above them.
        **options
            columns, unit, scale, point.

        Raises
        ------
        CaseError
            When the file cannot be read, naming the line that is wrong or the columns that there are.
        """
        return cls(file=os.fspath(path), **options)

    def polyline(self) -> tuple[Vector, Vector]:
        """Return times [s] and values of its points."""
        return np.array(self.times), self.scale * np.array(self.values)
