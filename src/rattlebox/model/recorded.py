"""Records: signals that were measured or computed by other programs."""

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

from .base import FilePart
from .elementwise import Vector
from .errors import Hint, at
from .files import absolute, existing
from .records import Column, Columns, as_columns, read_columns, read_samples
from .signals import UNIT_NAMES, UNITS, Sampled
from .units import Number, PositiveTime, factor_of, numbers, parse, plain, unit_above


def _apply_stated_units(columns: Columns, fields: Mapping[str, Any]) -> dict[str, Any]:
    """Return times, values, unit and scale of a file; units of the fields take precedence over those above the columns.

    Raises
    ------
    DataError
        If the file states a unit that is unknown.
    Hint
        If the file and the field `unit` state different dimensions.
    """
    times, values, (time_headings, value_headings) = columns
    try:
        time_scale, _ = unit_above(time_headings, ("s",)) or (1.0, "s")
    except Hint as hint:
        raise DataError(hint.complaint, 'times in seconds below the heading "time (s)"', ["file"]) from None
    record = {"times": times * time_scale if time_scale != 1 else times, "values": values}
    if fields.get("scale") is not None:
        return record
    wanted = fields.get("unit")
    try:
        stated = unit_above(value_headings, UNITS)
    except Hint as hint:
        if wanted in UNITS:
            return record
        advice = 'unit = "m/s^2", and scale = ..., the factor from the numbers to that unit'
        raise DataError(hint.complaint, advice, ["file"]) from None
    if stated is None:
        return record
    scale, unit = stated
    if wanted in UNITS and wanted != unit:
        raise Hint(
            f"the file has {UNIT_NAMES[unit]} in this column, not {UNIT_NAMES[wanted]}",
            f"another column, or scale = ..., the factor from its numbers to {wanted}",
            ["unit"],
        )
    return {**record, "unit": wanted or unit, "scale": scale}


def _with_si_unit(values: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of a record with another unit of the same dimension turned into the SI unit and a scale."""
    unit = values.get("unit")
    conversion = factor_of(unit, UNITS) if isinstance(unit, str) and unit not in UNITS else None
    if conversion is None:
        return values
    factor, si_unit = conversion
    if factor == 1:
        return {**values, "unit": si_unit}
    with at("scale"):
        scale = 1.0 if values.get("scale") is None else plain(values["scale"])
    if not isinstance(scale, (int, float)):
        return values
    return {**values, "unit": si_unit, "scale": scale * factor}


def _time_history(path: Path, columns: Any) -> Columns:
    """Read a time history of a universal file, by its name or number in `columns`; None stands for the only one.

    Raises
    ------
    DataError
        If there is no such time history, or several and `columns` is None.
    """
    functions = [each for each in read_functions(path) if each.kind in (0, 1) and not np.iscomplexobj(each.values)]
    names = [each.name for each in functions]
    if not functions:
        raise DataError(f"{path} contains no time history", "a function of type 1 in a set 58")
    if columns is None and len(functions) > 1:
        raise DataError(f"{path} contains {len(functions)} time histories ({', '.join(names)})", "columns = [1]")
    wanted = columns[0] if columns else 1
    index = names.index(wanted) if wanted in names else wanted - 1 if isinstance(wanted, int) else -1
    if not 0 <= index < len(functions):
        raise DataError(f"{path} contains no time history {wanted!r}, but {', '.join(names)}", "columns = [1]")
    history = functions[index]
    times = history.abscissa - history.abscissa[0]
    headings = [f"a ({history.unit})"] if history.unit else []
    return Columns(times, np.asarray(history.values, dtype=float), ([], headings))


def _check_unit(columns: Columns, wanted: Any) -> None:
    """Raise if a file states another unit of acceleration, force or displacement than the field `unit`."""
    conversion = factor_of(wanted, UNITS) if isinstance(wanted, str) and wanted not in UNITS else None
    if conversion is None or conversion[0] == 1:
        return
    headings = columns.headings[1]
    try:
        stated = unit_above(headings, UNITS)
    except Hint:
        return  # an unknown heading does not contradict the field
    if stated is not None and stated != conversion:
        raise Hint(f"the file states another unit above the column: {headings[-1]!r}", "leave unit out", ["unit"])


def _column(value: Any) -> tuple[float, ...]:
    try:
        array = numbers(value)
    except Hint as hint:
        advice = "numbers without units: times in s, values in `unit` times `scale`"
        raise Hint(hint.complaint, hint.suggestion or advice, hint.place) from None
    if array.ndim != 1:
        raise Hint(f"one row of numbers is needed, not shape {array.shape}")
    return tuple(array.tolist())


class Record(FilePart, Sampled):
    """A record with linear interpolation between its points; it must cover the whole run.

    Parameters
    ----------
    times
        Strictly increasing [s].
    values
        As many values, in `unit`.
    scale
        Factor of the values; default 1, or the factor from the unit in the file.
    dt
        Time between evenly spaced samples [s], the first at 0 s; instead of `times`.
    unit
        Unit of the values: "N", "m/s^2", "m", or another of these dimensions, such as "g", "gal", "mg", "cm/s^2" or "kN".
    file
        CSV, NPY, NPZ, MAT, AT2 (PEER) or universal file (.uff, .unv), instead of times and values. Units above the columns
        of a text file, as in "time (ms), acceleration (g)", are converted; unknown ones raise. Without them times are in s
        and values in `unit`; if neither states a unit, the run notes the assumed unit and the peak.
    columns
        Columns or variables with times and values, by number in the order of the file from 1, or by name: `columns=(1, 3)`,
        `columns=("t", "a")`. With `dt` only that of the values; in a universal file the number of the time history. Optional
        if the file has only two columns (with `dt` one), or variables called time and value.

    Notes
    -----
    Linear interpolation between samples at a rate R multiplies the amplitude at frequency f by
    sinc^2(f / R) = (sin(pi f / R) / (pi f / R))^2, and adds images at k R +- f of amplitude sinc^2(k +- f / R). The
    amplitude falls by 1 % at 18 samples per period, by 3 % at 10 and by 19 % at 4. A run has a warning if this changes the
    response of a mode by more than 2 %.

    The acceleration of the base is used as it is, without a correction of the baseline: its mean and drift remain.
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
                raise Hint("columns need a file", 'file = "push.csv"', ["columns"])
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
                headings = [f"a ({motion.unit})"] if motion.unit else []
                times = np.arange(motion.values.size, dtype=float) * motion.step
                record = Columns(times, motion.values, ([], headings))
                if not motion.unit and values.get("unit") is None:
                    raise DataError(f"{path} states no unit", 'unit = "g"')
            elif path.lower().endswith((".uff", ".unv", ".uf")):
                record = _time_history(existing(path), values.get("columns"))
            elif step is not None:
                samples, headings = read_samples(path, columns[0] if columns else None)
                record = Columns(np.arange(samples.size, dtype=float) * step, samples, ([], headings))
            else:
                record = read_columns(path, columns)
        _check_unit(record, wanted)
        return {**values, **_apply_stated_units(record, values), "file": path}

    @model_validator(mode="after")
    def _validate(self) -> Record:
        if len(self.times) != len(self.values):
            raise Hint(f"{len(self.times)} times, but {len(self.values)} values", "as many of both")
        if len(self.times) < 2:
            raise Hint("a record needs at least two points", "the points of a whole record", self.where)
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
        """Field with the numbers, for messages."""
        return ("file",) if self.file else ("times",)

    @model_serializer(mode="wrap")
    def _without_file_fields(self, handler: Any) -> Any:
        data = handler(self)
        for name in self.fields_from_file():
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
            The file; times in seconds, unless their column states another unit.
        **options
            Other fields: columns, dt, unit, scale, point, direction.

        Returns
        -------
        Record
            The record.

        Raises
        ------
        CaseError
            If the file cannot be read; with the line at fault, or the available columns.
        """
        return cls(file=os.fspath(path), **options)

    def polyline(self) -> tuple[Vector, Vector]:
        """Return times [s] and values of the points."""
        return np.array(self.times), self.scale * np.array(self.values)
