"""Measured frequency response functions, read from files."""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox.exchange.read.universal import Function, frequency_responses
from rattlebox.model.errors import Hint
from rattlebox.model.files import existing
from rattlebox.model.records import Column, as_columns, read_numbers
from rattlebox.model.units import factor_of, unit_name
from rattlebox.model.units_in_text import unit_above

from .signals import FloatArray, labelled

if TYPE_CHECKING:
    import xarray

_SI = ("m", "m/s", "m/s^2", "N")
_QUANTITIES = {8: "m", 9: "N", 11: "m/s", 12: "m/s^2", 13: "N"}
_INVERSE = re.compile(r"^\(?\s*1\s*/\s*([^()*]+?)\s*\)?\s*\*\s*\(?([^()]+)\)?$")  # (1/N)*(m/s^2)
_QUOTIENT = re.compile(r"^\(?([^()]+?)\)?\s*/\s*\(?([^/()]+)\)?$")  # m/s^2/N, (m/s^2)/N
_PARTS = {
    "imaginary": re.compile(r"imag|\bim\b", re.I),
    "phase": re.compile(r"phase|angle|arg", re.I),
}
_BRACKETS = re.compile(r"[(\[]([^)\]]*)[)\]]")


def read_frequency_response(
    path: str | os.PathLike[str],
    *,
    function: str | int | None = None,
    columns: Sequence[Column] | None = None,
    unit: str | None = None,
) -> xarray.Dataset:
    r"""Read a measured frequency response function, in the form that `transfer_function` returns.

    Parameters
    ----------
    path
        Universal file (.uff, .unv, .uf) with functions of type 4 or 5 in sets 58 or 58b; or a text file (CSV and the like)
        with three columns: frequency, real and imaginary part, or frequency, magnitude and phase. The headings say which:
        "imag" or "phase" above the third column, "dB" for decibels, "rad" or "deg" for the phase, Hz or kHz.
    function
        Name or number (from 1) of the function of a universal file; needed if there are several.
    columns
        Numbers (from 1) or names of the three columns of a text file; needed if there are more.
    unit
        Unit of the values, response over source such as "m/s^2/N", "g/N" or "mm/N", in place of the one in the file.

    Returns
    -------
    xarray.Dataset
        Complex `transfer` over `frequency` [Hz], in the SI unit. `attrs["warnings"]` lists what is assumed.

    Warns
    -----
    UserWarning
        If the file does not state a unit of values or phase: the unit that is assumed, and the peak in it.

    Raises
    ------
    DataError
        If the file cannot be read, is damaged, holds no such function, states a unit that is unknown, or its frequencies do
        not rise.

    Notes
    -----
    Compare it with a run by `transfer_function` of force and response, at the same amplitude: the response function of a
    structure with a particle damper depends on amplitude. Phases follow exp(+i omega t): a response behind the force has a
    negative one.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "frf.csv"
    >>> _ = path.write_text("frequency (Hz), magnitude (mm/N), phase (deg)\n10, 0.2, -5\n20, 1.5, -90\n30, 0.3, -175\n")
    >>> measured = read_frequency_response(path)
    >>> measured.transfer.attrs["units"], round(float(abs(measured.transfer).max()), 6)
    ('m/N', 0.0015)
    """
    import xarray

    file = existing(path)
    if file.suffix.lower() in (".uff", ".unv", ".uf"):
        frequency, values, stated, implied = _from_universal(file, function)
        notes: list[str] = []
    else:
        frequency, values, stated, notes = _from_text(file, columns)
        implied = None
    if frequency.size < 2 or np.any(np.diff(frequency) <= 0) or frequency[0] < 0:
        raise DataError(f"{file}: the frequencies do not rise", "two or more points in the order of their frequencies")
    # The unit of the argument wins over that of the file; an assumed one is noted with the peak, which shows a wrong guess.
    where = "unit" if unit is not None else str(file)
    factor, si = _ratio_in_si(unit or stated, where) if unit or stated else (1.0, implied or "")
    values = factor * values
    if not (unit or stated):
        peak = int(np.argmax(np.abs(values)))
        largest = f"{abs(values[peak]):.4g} {si}".rstrip()
        notes.insert(
            0,
            f"{file} states no unit; {si or 'SI'} is assumed: the largest magnitude is {largest} "
            f'at {frequency[peak]:.4g} Hz; if not, try: unit = "g/N"',
        )
    for note in notes:
        warnings.warn(note, stacklevel=2)
    axis = ("frequency", frequency, {"units": "Hz", "long_name": "frequency"})
    return xarray.Dataset(
        {"transfer": labelled("transfer", values, si, "measured transfer function", frequency=axis)},
        attrs={"file": file.name, "warnings": notes},
    )


def _from_universal(file: Path, wanted: str | int | None) -> tuple[FloatArray, Any, str, str | None]:
    """Return frequencies, values, the stated unit, and the SI unit of the stated quantities."""
    functions = frequency_responses(file)
    names = [function.name for function in functions]
    if wanted is None and len(functions) > 1:
        raise DataError(
            f"{file} holds {len(functions)} frequency response functions ({', '.join(names)})", "function = 1"
        )
    if isinstance(wanted, str) and names.count(wanted) > 1:
        raise DataError(f"{file} holds {names.count(wanted)} functions {wanted!r}", "its number, counted from 1")
    if isinstance(wanted, str):
        number = names.index(wanted) if wanted in names else -1
    else:
        number = 0 if wanted is None else wanted - 1
    if not 0 <= number < len(functions):
        raise DataError(f"{file} holds no function {wanted!r}, but {', '.join(names)}", "function = 1")
    chosen = functions[number]
    known = factor_of(chosen.abscissa_unit, ("Hz",))
    if known is None and unit_name(chosen.abscissa_unit):
        raise DataError(
            f"{file}: the function {chosen.name!r} is over {chosen.abscissa_unit[:20]!r}, which is no unit of frequency",
            "a function over Hz",
        )
    frequency = chosen.abscissa * (known[0] if known else 1.0)
    return frequency, np.asarray(chosen.values, complex), _stated_unit(chosen), _unit_of_quantities(chosen)


def _stated_unit(function: Function) -> str:
    """Return the unit that a function of a universal file states, "" if none."""
    if function.unit and function.source_unit:
        return f"({function.unit})/({function.source_unit})"
    return function.unit


def _unit_of_quantities(function: Function) -> str | None:
    """Return the SI unit of the quantities that a function states by number; None if one is unknown."""
    response, source = (_QUANTITIES.get(code) for code in function.quantities)
    return f"{response}/{source}" if response and source else None


def _from_text(file: Path, columns: Sequence[Column] | None) -> tuple[FloatArray, Any, str, list[str]]:
    """Return frequencies, values, the stated unit, and notes about assumed units."""
    try:
        chosen = None if columns is None else tuple(columns)
        if chosen is not None and len(chosen) != 3:
            as_columns(chosen, 3)
        table, heads = read_numbers(str(file), chosen, 3)
        to_hertz, _ = unit_above(heads[0], ("Hz",)) or (1.0, "Hz")
    except Hint as hint:
        raise DataError(f"{file}: {hint.complaint}", hint.suggestion) from None
    # What the columns are is in their headings only: real and imaginary part, or magnitude and phase.
    above = [" ".join(head) for head in heads]
    kind = next((kind for kind, pattern in _PARTS.items() if pattern.search(above[2])), None)
    if kind is None:
        raise DataError(
            f"{file}: the heading of the third column, {above[2]!r}, is neither an imaginary part nor a phase",
            "the line frequency (Hz), real (m/s^2/N), imag (m/s^2/N) above the numbers",
        )
    unit = _bracketed(above[1])
    if kind == "imaginary":
        other = _bracketed(above[2])
        if unit and other and unit != other:
            raise DataError(f"{file}: the real part is in {unit}, the imaginary part in {other}", "one unit for both")
        return to_hertz * table[:, 0], table[:, 1] + 1j * table[:, 2], unit or other, []
    magnitude = table[:, 1]
    # Decibels of a response function are of amplitudes, hence 20; the unit is their reference.
    if "db" in above[1].lower():
        magnitude, unit = 10 ** (magnitude / 20), re.sub(r"(?i)\s*(re\.?\s*1?|db)\s*", "", unit)
    elif (magnitude < 0).any():
        raise DataError(f"{file}: a magnitude is negative", "dB in the heading, if these are decibels")
    phase, angle = table[:, 2], _bracketed(above[2]).lower()
    if angle.startswith("rad"):
        return to_hertz * table[:, 0], magnitude * np.exp(1j * phase), unit, []
    notes: list[str] = []
    if not (angle.startswith("deg") or angle == "°"):
        notes.append(
            f"{file} states no unit of the phase; degrees are assumed: the largest is {np.abs(phase).max():.4g} deg"
        )
    return to_hertz * table[:, 0], magnitude * np.exp(1j * np.radians(phase)), unit, notes


def _bracketed(head: str) -> str:
    """Return the text in the outermost brackets of a heading."""
    start = min((k for k in (head.find("("), head.find("[")) if k >= 0), default=-1)
    return head[start + 1 : max(head.rfind(")"), head.rfind("]"))].strip() if start >= 0 else ""


def ratio_of_units(unit: str) -> tuple[str, str] | None:
    """Return the units of response and source of a ratio such as "(m/s^2)/(N)"; None if it is no ratio."""
    inverse, quotient = _INVERSE.match(unit.strip()), _QUOTIENT.match(unit.strip())
    return (inverse[2], inverse[1]) if inverse else (quotient[1], quotient[2]) if quotient else None


def _ratio_in_si(unit: str, where: str) -> tuple[float, str]:
    """Return the factor to SI and the SI unit of a response over a source."""
    parts = ratio_of_units(unit)
    if parts is not None:
        known = [factor_of(part.strip(), _SI) for part in parts]
        if known[0] and known[1]:
            response, source = known[0][1], known[1][1]
            return known[0][0] / known[1][0], "1" if response == source else f"{response}/{source}"
    if unit.strip() in ("1", "-", "g/g", "dimensionless"):
        return 1.0, "1"
    raise DataError(
        f"{where}: {unit!r} is not a unit of a response over a source", 'unit = "m/s^2/N", "g/N", "mm/N" or "1"'
    )
