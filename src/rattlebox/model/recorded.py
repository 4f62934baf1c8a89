"""Records: signals that were measured or computed by other programs."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, cast

import numpy as np
from pydantic import (
    BeforeValidator,
    Field,
    PlainSerializer,
    PrivateAttr,
    WithJsonSchema,
    model_validator,
)

from rattlebox._util.exceptions import DataError
from rattlebox._util.frozen import complete
from rattlebox.exchange.read import ground_motion, measurement_files, strong_motion, tdms, universal  # noqa: F401  (they register)
from rattlebox.exchange.read.formats import Format, no_signals, record_reader, signals_in

from .as_written import MOST_ITEMS, Given
from .elementwise import Vector
from .errors import Hint, at, several
from .file_signals import FileSignal
from .files import absolute, check_finite, existing
from .records import Column, Columns, as_columns, read_columns
from .sep005 import fields_of_sep005
from .signals import UNIT_NAMES, UNITS, Unit
from .units import SI, STANDARD_GRAVITY, Number, PositiveTime, factor_of, numbers, parse
from .units_in_text import unit_above, units_in_lines

_SHOWN = 60  # characters of a line in a message
_NO_UNIT = "unit left out; scale is a factor of the record apart from its unit"
_UNIT_ADVICE = 'unit = "m/s^2", and scale = ..., the factor from the numbers to that unit'
_PER_FORCE = re.compile(r"/\s*\(?[mk]?(?:N|lbf|kgf)\)?\s*[)\]]?\s*$")
_RESPONSE_ADVICE = "rb.analysis.read_frequency_response, if the file has a frequency response"
_VELOCITY = re.compile(r"\bveloc|\bgeschw|\bvitesse|\bsnelheid|\bскорост|(?<!加)速度", re.I)
_DERIVATIVE = (
    'the acceleration, its derivative: rb.Record(times=t, values=numpy.gradient(v, t), unit="m/s^2"), with v in m/s'
)
_SCALE_FACTOR = re.compile(r"\bscale\s+factor\b\W*([\d.]+)(\s*\(?[a-z].*/)?", re.I)
"""A factor of the numbers; with a unit, as in "2000(gal)/8388608", they are readings of a converter."""


def _time_factor(columns: Columns) -> float:
    """Return the factor of the times to seconds."""
    try:
        factor, _ = unit_above(columns.headings[0], ("s",)) or (1.0, "s")
    except Hint as hint:
        raise DataError(hint.complaint, 'times in seconds below the heading "time (s)"', ["file"]) from None
    return factor


def _stated_unit(columns: Columns, wanted: str | None, name: str) -> tuple[tuple[float, str] | None, list[str]]:
    """Return the factor to SI and the SI unit of the values as the file states it, and notes; None if it states none."""
    # Directly above the column: the surest place, which the user must not contradict.
    own = None if wanted is None else factor_of(wanted, UNITS)
    try:
        stated = unit_above(columns.headings[1], UNITS)
    except Hint as hint:
        # No factor makes an acceleration of a velocity, whatever the user states.
        if _is_velocity(columns.headings[1]):
            raise DataError(hint.complaint, _DERIVATIVE, ["file"]) from None
        if own is not None:
            return None, []  # an unknown heading does not contradict the user
        is_response = any(_PER_FORCE.search(head) for head in columns.headings[1])
        raise DataError(hint.complaint, _RESPONSE_ADVICE if is_response else _UNIT_ADVICE, ["file"]) from None
    if stated is not None and own not in (None, stated):
        heading = columns.headings[1][-1]
        if own is not None and own[1] != stated[1]:
            kinds = f"{UNIT_NAMES[cast(Unit, stated[1])]} in this column, not {UNIT_NAMES[cast(Unit, own[1])]}"
            raise Hint(
                f"the file has {kinds}: {heading!r}", "another column, or values that are computed first", ["unit"]
            )
        raise Hint(f"the file states another unit above the column: {heading!r}", _NO_UNIT, ["unit"])
    if stated is not None:
        return stated, []
    if own is None and (heading := next((text for text in columns.headings[1] if _VELOCITY.search(text)), "")):
        raise DataError(f"{name}: the column {heading[:_SHOWN]!r} is a velocity", _DERIVATIVE, ["file"])
    # In the lines above: free text, in which a unit may also belong to something else.
    try:
        found, mentioned = units_in_lines(columns.lines, UNITS)
    except Hint as hint:
        if own is not None:
            return None, []
        advice = "a file of accelerations, forces or displacements; or unit, if the line is about something else"
        raise DataError(f"{name}: {hint.complaint}", advice, ["file"]) from None
    if own is not None:
        others = [each for each in found if (each.factor, each.unit) != own and each.unit == own[1]]
        return None, [
            f"{name}: unit = {wanted!r} is used, but line {each.number} states another one: {each.line[:_SHOWN]!r}"
            for each in others[:1]
        ]
    # Only one clear unit is used without the user; readings of a converter and several units need one.
    scale = next((line for _, line in columns.lines if (match := _SCALE_FACTOR.search(line)) and match[2]), "")
    if scale:
        raise DataError(
            f"{name}: its numbers are readings, to which the scale factor of its header is not applied: {scale.strip()!r}",
            'unit = "gal" and scale = 2000 / 8388608 for a factor of 2000(gal)/8388608',
            ["file"],
        )
    if len(found) == 1:
        (only,) = found
        note = f"the unit of {name} is taken from line {only.number}, {only.line[:_SHOWN]!r}"
        return (only.factor, only.unit), [note]
    if units := [*found, *mentioned]:
        lines = " and ".join(f"{each.number}, {each.line[:_SHOWN]!r}" for each in units[:2])
        raise DataError(
            f"{name} does not state clearly in which unit its values are; units are in line {lines}",
            'unit = "m/s^2", "g" or "gal", the unit of the values',
            ["file"],
        )
    return None, []


def _is_velocity(headings: Sequence[str]) -> bool:
    """Return whether the text above a column states the unit of a velocity."""
    try:
        return unit_above(headings, ("m/s",)) is not None
    except Hint:
        return False


def is_table(form: Format[Callable[..., Any]]) -> bool:
    """Return whether a format is a table of numbers, whose columns the model reads."""
    return form.read is no_signals


def _signal_format(path: str, *, is_table: bool = False) -> Format[Callable[..., Any]] | None:
    """Return the format of a file of time histories; None for tables of numbers.

    `is_table` says that the fields of a record are those of a table, so that the content of a text decides nothing.
    """
    form = record_reader.of(path, has_content=not is_table)
    return None if form is None or form.read is no_signals else form


def _signal(path: Path, form: Format[Callable[..., Any]], columns: Any, unit: Any, step: float | None) -> Columns:
    """Read a time history, by its name or number in `columns`; None stands for the only one.

    A step of the user is that of a time history without times.
    """
    signals = signals_in(path, form)
    names = [signal.name or f"number {number}" for number, signal in enumerate(signals, start=1)]
    measured = [number for number, signal in enumerate(signals, start=1) if not signal.is_derived]
    if columns is None and len(signals) > 1 and len(measured) != 1:
        raise DataError(f"{path} contains {len(signals)} time histories ({', '.join(names)})", "columns = [1]")
    wanted: Column = columns[0] if columns else next(iter(measured), 1)
    if isinstance(wanted, str) and names.count(wanted) > 1:
        numbers = " or ".join(str(number) for number, name in enumerate(names, start=1) if name == wanted)
        raise DataError(f"{path} contains {names.count(wanted)} time histories {wanted!r}", f"columns = [{numbers}]")
    index = names.index(wanted) if wanted in names else wanted - 1 if isinstance(wanted, int) else -1
    if not 0 <= index < len(signals):
        raise DataError(f"{path} contains no time history {wanted!r}, but {', '.join(names)}", "columns = [1]")
    signal = signals[index]
    if form.needs_unit and unit is None and not signal.unit and not any(units_in_lines(signal.lines, UNITS)):
        raise DataError(f"{path} states no unit", 'unit = "g"')
    headings = [f"values ({signal.unit[:_SHOWN]})"] if signal.unit else []
    over = [f"times ({signal.time_unit})"] if factor_of(signal.time_unit, ("s",)) else []
    times, values = np.asarray(signal.times, dtype=float), np.asarray(signal.values, dtype=float)
    has_times = not bool(np.isnan(times).all())
    if has_times and step is not None:
        raise Hint(f"{path} states its time step", "leave dt out")
    if not has_times and step is None:
        raise DataError(
            f"{path} does not state the time between the samples of {signal.name[:_SHOWN]!r}", 'dt = "0.01 s"'
        )
    times = times if step is None else step * np.arange(values.size, dtype=float)
    return Columns(times, check_finite(values, f"{path}: the values"), (over, headings), signal.lines, signal.notes)


def _words_on_text(columns: Columns) -> str:
    """Return what was found where the unit should be: the end of "FILE ... ; m/s^2 is assumed"."""
    above = [*columns.headings[1], *(line for _, line in columns.lines)]
    return "has no unit that is recognised above its numbers" if any(above) else "states no unit"


def _without_unit(options: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in options.items() if name != "unit"}


def _column(value: object) -> Vector:
    """Return a read-only array; that of another record itself."""
    if isinstance(value, np.ndarray) and value.base is None and not value.flags.writeable:
        return value
    try:
        array = numbers(value)
    except Hint as hint:
        advice = "numbers without units: times in s, values in `unit` times `scale`"
        raise Hint(hint.complaint, advice if hint.place else hint.suggestion, hint.place) from None
    if array.ndim != 1:
        raise Hint(f"one row of numbers is needed, not shape {array.shape}", "one column of them, such as table[:, 1]")
    array = np.array(array)  # what the user keeps may change
    array.flags.writeable = False
    return array


Column1D = Annotated[
    Vector,
    BeforeValidator(_column),
    PlainSerializer(np.ndarray.tolist, when_used="json"),
    WithJsonSchema({"type": "array", "items": {"type": "number"}}),
]


def _as_time_zero(value: object) -> Any:
    return value if value is None or value == "first" else parse(value, ("s",))[0]


class Record(FileSignal):
    r"""A record with linear interpolation between its points; it must cover the whole run.

    Parameters
    ----------
    times
        Strictly increasing [s].
    values
        As many values, in `unit`; they are stored in SI units.
    scale
        Factor of the record; default 1. It is independent of the unit: a record in g with `scale=2` is twice as strong.
    dt
        Time between evenly spaced samples [s], the first at 0 s; instead of `times`.
    unit
        Unit of the values: "N", "m/s^2", "m", or another of these dimensions, such as "g", "gal", "mg", "cm/s^2" or "kN";
        stored as the SI unit.
    file
        File with the record, instead of times and values: columns of text (.csv, .txt, ...), a spreadsheet (.xlsx, .ods,
        ...), NPY, NPZ, MAT (also 7.3), a universal file (.uff, .unv), LVM, TDMS, WAV, or strong motion of PEER (.at2, .dt2),
        K-NET, KiK-net, USGS (.smc), COSMOS (.v2), ESM, ITACA or CSMNC. Units above the columns of a text file, as in "time
        (ms), acceleration (g)", are converted, and so is the only unit in other lines above, as in "UNIT: CM/SEC/SEC";
        unknown and contradicting ones raise. Without them times are in s and values in `unit`; if neither states a unit, the
        run notes the assumed unit and the peak. A first line with the number of samples, or with number and time step, is no
        data.
    columns
        Columns or variables with times and values, by number in the order of the file from 1, or by name: `columns=(1, 3)`,
        `columns=("t", "a")`. A name alone, `columns="acc_z"`, is that of the values: their times are the column called time,
        or the first one, if it increases, and in a MAT file the first of two columns of that variable, or the variable
        called t or time. With `dt` only that of the values; in a file of time histories the name or number of one. Optional
        if the file has only two columns (with `dt` one), or variables called time and value. `columns="rows"`: samples that
        go on from row to row, five or eight a row; optional if the rows show it.
    time_zero
        Time of the record that is 0 s in the run [s], or "first" for its first point; default 0 s, in universal files
        "first". A run notes a shift, and points before 0 s, which are not used.
    name
        Label, such as the name of the earthquake; the coordinate of an axis of records.

    Notes
    -----
    Linear interpolation between samples at a rate :math:`R` multiplies the amplitude at frequency :math:`f` by

    .. math:: \text{sinc}^2\frac{f}{R} = \left(\frac{\sin(\pi f / R)}{\pi f / R}\right)^2

    and adds images at :math:`k R \pm f` of amplitude :math:`\text{sinc}^2(k \pm f / R)`. The amplitude falls by 1 % at 18
    samples per period, by 3 % at 10 and by 19 % at 4. A run has a warning if this changes the response of a mode by more
    than 2 %.

    The acceleration of the base is used as it is, without a correction of the baseline: its mean and drift remain.

    Examples
    --------
    >>> import rattlebox as rb
    >>> print(f"{max(rb.Record(times=[0, 0.1, 0.2], values=[0, 1, 0], unit='g').values):.5f} m/s^2")
    9.80665 m/s^2
    """

    file_fields: ClassVar[tuple[str, ...]] = ("times", "values")
    start_advice: ClassVar[str] = 'time_zero = "first", which shifts its first point to 0 s'
    kind: Literal["record"] = "record"
    times: Column1D = Field(default_factory=lambda: _column(()))
    values: Column1D = Field(default_factory=lambda: _column(()))
    file: str | None = None
    columns: tuple[Column, Column] | tuple[Column] | str | None = None
    dt: PositiveTime | None = None
    scale: Number = 1.0
    time_zero: Annotated[Literal["first"] | float | None, SI("s"), BeforeValidator(_as_time_zero)] = None
    name: str = ""
    _unit_is_assumed: bool = PrivateAttr(default=False)

    @model_validator(mode="wrap")
    @classmethod
    def _from_file(cls, values: object, handler: Any) -> Record:
        if not isinstance(values, dict):
            kept: Record = handler(values)
            return kept
        given = values.get("unit")
        notes: tuple[str, ...] = ()
        values = cls._with_step(values)
        has_file = values.get("file") is not None
        if has_file:
            values, notes = cls._read(values)
        elif (
            isinstance(given, str) and given not in UNITS and "values" in values and (known := factor_of(given, UNITS))
        ):
            with at("values"):
                plain = numbers(values["values"])
                values = Given.read_from(values, {**values, "unit": known[1], "values": known[0] * plain})
                if plain.size <= MOST_ITEMS:
                    values.texts = {**values.texts, "unit": given, "values": plain.tolist()}
        record: Record = handler(values)
        complete(
            record,
            _unit_as_given=given if has_file else None,
            _unit_is_assumed=has_file and values.get("unit") is None,
            _notes=tuple(notes),
        )
        return record

    @staticmethod
    def _with_step(values: dict[str, Any]) -> dict[str, Any]:
        """Return the fields with times in place of a step, if the values are not in a file."""
        step = None
        if values.get("dt") is not None:
            with at("dt"):
                step = parse(values["dt"], ("s",))[0]
                if not step > 0:
                    raise Hint("must be greater than zero", 'dt = "0.01 s"')
        if values.get("file") is not None:
            return {**values, "dt": step}
        if values.get("columns") is not None:
            raise Hint("columns need a file", 'file = "push.csv"', ["columns"])
        if step is None or "values" not in values:
            return values
        if "times" in values:
            raise Hint("give times or dt, not both", "leave dt out", ["dt"])
        times = step * np.arange(np.size(values["values"]))
        return Given.read_from(values, {**values, "times": times, "dt": None})

    @staticmethod
    def _read(values: dict[str, Any]) -> tuple[dict[str, Any], tuple[str, ...]]:
        """Return the fields with the content of the file in SI units, and notes."""
        if values.get("times") is not None or values.get("values") is not None:
            raise Hint(
                "give times and values, or a file, not both", 'columns = ["time", "force"] names those of the file'
            )
        # Each kind of file names its columns in its own way; the result is the same.
        step, wanted = values.get("dt"), values.get("unit")
        with at("file"):
            path = absolute(values["file"])
            chosen = values.get("columns")
            has_two = isinstance(chosen, (list, tuple)) and len(chosen) == 2
            is_table = step is not None or chosen == "rows" or has_two
            form = _signal_format(path, is_table=is_table)
        with at("columns"):
            columns = as_columns(values.get("columns"), 1 if step is not None or form else 2)
        with at("file"):
            if form and columns == "rows":
                raise Hint("a file of time histories has no rows", "columns = [1]", ["columns"])
            if form and form.needs_scale and (values.get("scale") is None or wanted is None):
                raise DataError(
                    f"{path} states no calibration: its numbers are fractions of full scale",
                    'unit = "g" and scale = 50, if full scale is 50 g',
                )
            record = _signal(existing(path), form, columns, wanted, step) if form else read_columns(path, columns, step)
        name = " ".join(Path(path).name.split())
        # The unit of the file has priority: that of the user must agree with it. A table without any unit has the unit
        # that the case needs, and the run notes it.
        stated, notes = _stated_unit(record, wanted if isinstance(wanted, str) else None, name)
        own = factor_of(wanted, UNITS) if isinstance(wanted, str) else None
        factor, unit = stated or own or (1.0, wanted)
        to_seconds = _time_factor(record)
        fields = {
            "times": record.times * to_seconds if to_seconds != 1 else record.times,
            "values": record.values * factor if factor != 1 else record.values,
            "unit": unit,
            "file": path,
        }
        for number, line in record.lines:
            if (match := _SCALE_FACTOR.search(line)) and not match[2] and match[1] not in ("1", "1.0"):
                notes.append(
                    f"{name}: line {number} states a scale factor, which is not applied: {line.strip()[:_SHOWN]!r}"
                )
        if unit is None:
            notes.append(_words_on_text(record))
        return {**values, **fields}, (*(f"{name}: {note}" for note in record.notes), *notes)

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
                "columns = [2, 1], if times and values are swapped"
                if self.file and np.all(np.diff(self.values) > 0)
                else "times in their order, each one once",
                self.where,
            )
        return self

    @property
    def unit_is_assumed(self) -> bool:
        """Whether neither the file nor the user states the unit of the values."""
        return self._unit_is_assumed

    @property
    def where(self) -> tuple[str, ...]:
        """Field with the numbers, for messages."""
        return ("file",) if self.file else ("times",)

    @property
    def peak(self) -> float:
        """Largest magnitude [SI]."""
        return abs(self.scale) * max(float(self.values.max()), -float(self.values.min()))

    @property
    def _start(self) -> float:
        """Time of the record that is 0 s in the run [s]."""
        if self.time_zero is not None and self.time_zero != "first":
            return self.time_zero
        form = _signal_format(self.file) if self.file and self.time_zero is None else None
        is_first = self.time_zero == "first" or (form is not None and form.starts_at_first)
        return float(self.times[0]) if is_first else 0.0

    def notes(self) -> Iterator[str]:
        """Yield notes on assumptions about the file, an assumed unit, a shift, and points that are not used."""
        yield from (note for note in self._notes[: len(self._notes) - self._unit_is_assumed])
        if self._unit_is_assumed:
            in_g = f" = {self.peak / STANDARD_GRAVITY:.4g} g" if self.unit == "m/s^2" else ""
            file = " ".join(Path(self.file or "").name.split())
            unit = f" {self.unit}" if self.unit else ""
            yield (
                f"{file} {self._notes[-1]}; {self.unit or 'SI'} is assumed, with a peak of {self.peak:.4g}{unit}{in_g}; "
                "set unit if that is wrong"
            )
        zero, first = self._start, self.times[0]
        before = int(np.searchsorted(self.times, zero))
        if before:
            unused = abs(self.scale) * float(np.abs(self.values[:before]).max())
            unit = f" {self.unit}" if self.unit else ""
            yield (
                f"the record begins at {first:.6g} s; its {several(before, 'point')} before {zero:.6g} s, with a peak of "
                f"{unused:.4g}{unit}, are not used (time_zero sets where the run begins)"
            )
        elif zero:
            yield f"the record begins at {first:.6g} s and is shifted: its time {zero:.6g} s is 0 s of the run (time_zero)"

    @classmethod
    def excluded_by(cls, name: str, value: object) -> list[str]:
        """Return the fields that a value of a field excludes; a step excludes times."""
        return [*super().excluded_by(name, value), *(["times"] if name == "dt" else [])]

    def unplaced(self, allowed: Sequence[Unit]) -> str:
        """Return advice for a record in another unit than a field of a case accepts."""
        if self.unit == "m" and "m/s^2" in allowed:
            return (
                "its second derivative, rb.Record(times=t, values=scipy.interpolate.CubicSpline(t, x)(t, 2), "
                'unit="m/s^2")'
            )
        return f"a record in {allowed[0]}"

    @classmethod
    def from_file(cls, path: str | os.PathLike[str], **options: Any) -> Record:
        """Read a record from a file of any format that `file` lists.

        Parameters
        ----------
        path
            The file; times in seconds, unless it states another unit.
        **options
            Other fields: columns, dt, unit, scale, time_zero, point, direction.

        Returns
        -------
        Record
            The record.

        Raises
        ------
        DataError
            If the file cannot be read; with the line at fault, or the available columns.
        CaseError
            If other fields do not fit the file.
        """
        return cls(file=os.fspath(path), **options)

    @classmethod
    def from_sep005(cls, channels: object, channel: str | None = None, **options: Any) -> Record:
        """Return the record of a dictionary of SEP005, the form of time histories of the packages of SDyPy.

        Parameters
        ----------
        channels
            A dictionary with `name`, `data`, `unit_str`, and `time` [s] or `fs` [Hz]; or a list of them.
        channel
            Name of the channel in a list; needed if there are several.
        **options
            Other fields: unit, scale, time_zero, point, direction; `unit` is needed if `unit_str` is no unit of a force, an
            acceleration or a displacement.

        Returns
        -------
        Record
            The record, with the name of the channel.

        Raises
        ------
        CaseError
            If the dictionary has no data, times or unit, or they contradict each other.

        Examples
        --------
        >>> import rattlebox as rb
        >>> tip = {"name": "tip", "data": [0, 1.5, -1, 0], "fs": 100.0, "unit_str": "g"}
        >>> record = rb.Record.from_sep005([tip])
        >>> record.name, round(record.peak, 5), record.times.tolist()
        ('tip', 14.70998, [0.0, 0.01, 0.02, 0.03])
        """
        return cls(**{**fields_of_sep005(channels, channel, options.get("unit")), **_without_unit(options)})

    def polyline(self) -> tuple[Vector, Vector]:
        """Return times in the run [s] and values of the points."""
        zero = self._start
        return self.times - zero if zero else self.times, self.values if self.scale == 1 else self.scale * self.values

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Record):
            return NotImplemented
        pairs = ((self.times, other.times), (self.values, other.values))
        return self._rest() == other._rest() and all(np.array_equal(*pair) for pair in pairs)

    def __hash__(self) -> int:
        return hash((self.kind, self.times.size, *self.values[:8].tolist()))

    def _rest(self) -> tuple[Any, ...]:
        """Return all that records compare but their arrays."""
        fields = {name: getattr(self, name) for name in type(self).model_fields if name not in self.file_fields}
        return type(self), fields, self.__pydantic_private__
