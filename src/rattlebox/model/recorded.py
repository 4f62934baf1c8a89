"""Records: signals that were measured, or made by other programs."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BaseModel, BeforeValidator, PrivateAttr, model_serializer, model_validator

from rattlebox._util.exceptions import DataError
from rattlebox.exchange.read.ground_motion import read_ground_motion
from rattlebox.exchange.read.universal import read_functions

from .elementwise import Vector
from .errors import Hint, at
from .files import absolute, existing
from .records import Column, Columns, as_columns, read_columns, read_samples
from .signals import UNIT_NAMES, UNITS, Sampled
from .units import Number, PositiveTime, factor_of, numbers, parse, plain, unit_above


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


def _with_si_unit(values: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of a record with another unit of the same dimension turned into the SI unit and a scale."""
    unit = values.get("unit")
    known = factor_of(unit, UNITS) if isinstance(unit, str) and unit not in UNITS else None
    if known is None:
        return values
    if known[0] == 1:
        return {**values, "unit": known[1]}
    with at("scale"):
        scale = 1.0 if values.get("scale") is None else plain(values["scale"])
    if not isinstance(scale, (int, float)):
        return values
    return {**values, "unit": known[1], "scale": scale * known[0]}


def _time_history(path: Path, columns: Any) -> Columns:
    """Read a time history of a universal file: the only one, or the one that is called so or has this number.

    Raises
    ------
    DataError
        If there is none, or more than one and none is chosen.
    """
    functions = [each for each in read_functions(path) if each.kind in (0, 1) and not np.iscomplexobj(each.values)]
    names = [each.name for each in functions]
    if not functions:
        raise DataError(f"{path} holds no time history", "a function of type 1 in a set 58")
    if columns is None and len(functions) > 1:
        raise DataError(f"{path} holds {len(functions)} time histories ({', '.join(names)})", "columns = [1]")
    wanted = columns[0] if columns else 1
    place = names.index(wanted) if wanted in names else wanted - 1 if isinstance(wanted, int) else -1
    if not 0 <= place < len(functions):
        raise DataError(f"{path} holds no time history {wanted!r}, but {', '.join(names)}", "columns = [1]")
    found = functions[place]
    times = found.abscissa - found.abscissa[0]
    return Columns(times, np.asarray(found.values, dtype=float), ([], [f"a ({found.unit})"] if found.unit else []))


def _check_unit(found: Columns, wanted: Any) -> None:
    """Raise if a file states another unit of acceleration, force or displacement than the one that is given."""
    given = factor_of(wanted, UNITS) if isinstance(wanted, str) and wanted not in UNITS else None
    if given is None or given[0] == 1:
        return
    try:
        stated = unit_above(found.above[1], UNITS)
    except Hint:
        return  # the numbers are in the unit that is given
    if stated is not None and stated != given:
        raise Hint(f"the file states another unit above the column: {found.above[1][-1]!r}", "leave unit out", ["unit"])


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
    dt
        Time between samples [s] that are evenly spaced from 0 s on, instead of times.
    unit
        Unit of the values: "N", "m/s^2", "m", or another of these dimensions, such as "g", "gal", "mg", "cm/s^2" or "kN".
    file, columns
        Instead of times and values: a CSV, NPY, NPZ, MAT or AT2 file, and its columns of times and values, by number counted
        from 1 or by name: `columns=(1, 3)`, `columns=("t", "a")`; with `dt` that of the values alone. Variables count in the
        order of the file. Columns may be left out where there are only two (with `dt` one), or variables called time and
        value; an AT2 file of the PEER data base has one record, and of a universal file (.uff, .unv) `columns=(2,)` is the
        second time history. Units above the columns of a text file, as in "time (ms),
        acceleration (g)", are converted; unknown ones are refused. Without them times are in s, and values in `unit`; if
        neither states a unit, the run notes the unit that is assumed, and the peak.
    """

    file_fields: ClassVar[tuple[str, ...]] = ("times", "values")
    kind: Literal["record"] = "record"
    times: Annotated[tuple[float, ...], BeforeValidator(_column)] = ()
    values: Annotated[tuple[float, ...], BeforeValidator(_column)] = ()
    file: str | None = None
    columns: tuple[Column, Column] | tuple[Column] | None = None
    dt: PositiveTime | None = None
    scale: Number = 1.0
    _unit_is_assumed: bool = PrivateAttr(default=False)

    @model_validator(mode="before")
    @classmethod
    def _from_file(cls, values: Any) -> Any:
        if not isinstance(values, dict):
            return values
        wanted = values.get("unit")
        values = _with_si_unit(values)
        step = None
        if values.get("dt") is not None:
            with at("dt"):
                step = parse(values["dt"], ("s",))[0]
                if not step > 0:
                    raise Hint("must be greater than zero")
        if values.get("file") is None:
            if values.get("columns") is not None:
                raise Hint("columns are those of a file", 'file = "push.csv"', ["columns"])
            if step is not None and "values" in values:
                if "times" in values:
                    raise Hint("give times or dt, not both", "leave dt out", ["dt"])
                return {**values, "times": step * np.arange(np.size(values["values"])), "dt": None}
            return values
        if "times" in values or "values" in values:
            raise Hint(
                "give times and values, or a file, not both", 'columns = ["time", "force"] names those of the file'
            )
        with at("columns"):
            one = step is not None or str(values["file"]).lower().endswith((".uff", ".unv", ".uf"))
            columns = as_columns(values.get("columns"), 1 if one else 2)
        with at("file"):
            path = absolute(values["file"])
            if path.lower().endswith(".at2"):
                if step is not None or columns is not None:
                    raise Hint(f"{path} states its time step and has one record", "leave dt and columns out")
                motion = read_ground_motion(existing(path))
                heads = [f"a ({motion.unit})"] if motion.unit else []
                found = Columns(np.arange(motion.values.size, dtype=float) * motion.step, motion.values, ([], heads))
                if not motion.unit and values.get("unit") is None:
                    raise DataError(f"{path} states no unit", 'unit = "g"')
            elif path.lower().endswith((".uff", ".unv", ".uf")):
                found = _time_history(existing(path), values.get("columns"))
            elif step is not None:
                samples, heads = read_samples(path, columns[0] if columns else None)
                found = Columns(np.arange(samples.size, dtype=float) * step, samples, ([], heads))
            else:
                found = read_columns(path, columns)
        _check_unit(found, wanted)
        return {**values, **_in_si(found, values), "file": path}

    @model_validator(mode="after")
    def _validate(self) -> Record:
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
            for name in self.file_fields:
                data.pop(name, None)
        if self._unit_is_assumed:
            data.pop("unit", None)
        return data

    @classmethod
    def from_file(cls, path: str | os.PathLike[str], **options: Any) -> Record:
        """Read a record from a CSV, NPY, NPZ, MAT or AT2 file.

        Parameters
        ----------
        path
            The file; times in seconds, unless it says otherwise above them.
        **options
            columns, dt, unit, scale, point, direction.

        Raises
        ------
        CaseError
            When the file cannot be read, naming the line that is wrong or the columns that there are.
        """
        return cls(file=os.fspath(path), **options)

    def polyline(self) -> tuple[Vector, Vector]:
        """Return times [s] and values of its points."""
        return np.array(self.times), self.scale * np.array(self.values)
