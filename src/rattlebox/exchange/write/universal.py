"""Universal files (UFF): functions in sets 58b, modes in sets 55, nodes in 2411, SI units in 164.

Set 58b stores the values of a function as doubles, so that they are read back to the last bit; the text of set 58 would
round them to twelve digits. Numbers of the other sets have columns of 13 characters and seven to eleven digits.

References
----------
University of Cincinnati, Structural Dynamics Research Laboratory (UC-SDRL), universal file datasets 55, 58, 58b, 151, 164
and 2411.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.atomic_io import atomic_write, check_suffix, require_folder
from rattlebox._util.exceptions import DataError
from rattlebox._util.own_files import check_replaceable, register_format

FloatArray = NDArray[np.float64]
Node = tuple[int, int]
"""Number of a node, and 1, 2 or 3 for its direction x, y or z; negative against the axis, 0 for a scalar."""

GENERAL, TIME_RESPONSE, RESPONSE_FUNCTION, TRANSMISSIBILITY, COHERENCE, DENSITY = 0, 1, 4, 5, 6, 9
"""Types of functions."""

QUANTITIES = {"m": 8, "N": 9, "m/s": 11, "m/s^2": 12, "Pa": 15, "kg": 16, "s": 17, "Hz": 18}
"""Types of data of an axis, by unit; 1 is general."""

EXCITATION_FORCE = 13
"""Type of data of a load; other forces are reactions."""

_WIDTH = 12  # characters of a number, after the blank that separates it from the last one
_EVEN = 1e-3  # largest deviation from an even abscissa that is stored as such, over the step
_DISPLACEMENT, _NORMAL_MODES, _REAL = 8, 2, 2
_SEAL = re.compile(rb"Rattlebox, BLAKE2b of the sets below: ([0-9a-f]{32})")
_HEAD = 400  # bytes that contain the seal


@dataclass(frozen=True, eq=False)
class Function:
    """A function for a set 58b."""

    name: str
    kind: int  # Type of the function, such as `RESPONSE_FUNCTION`
    x: FloatArray  # Times [s] or frequencies [Hz], (n,)
    x_unit: str
    values: NDArray[np.generic]  # Values in `unit`, or in `unit` over `source_unit`, (n,)
    unit: str
    source_unit: str = ""
    response: Node = (0, 0)  # Node and direction
    source: Node = (0, 0)
    note: str = ""
    quantity: int | None = None


def universal_nodes(nodes: Mapping[str, int | str] | None) -> dict[str, Node]:
    """Read the nodes of points: 21, "21" or "21 z" for node 21 along z, "21 -z" against it."""
    read: dict[str, Node] = {}
    for point, text in (nodes or {}).items():
        found = re.fullmatch(r"(\d+)(?: ([+-]?)([xyz]))?", str(text).strip())
        if not found or int(found[1]) < 1:
            raise DataError(f"nodes: {point} = {text!r} is not a node", 'a number from 1, or "21 z" with a direction')
        axis = "xyz".find(found[3]) + 1 if found[3] else 0
        read[point] = int(found[1]), -axis if found[2] == "-" else axis
    return read


def write_universal(path: Path, sets: Sequence[bytes]) -> Path:
    """Write a universal file; an existing one is replaced only if Rattlebox wrote it and nobody changed it."""
    check_suffix(path, path.suffix.lower() if path.suffix.lower() in (".unv", ".uf") else ".uff")
    require_folder(path)
    check_replaceable(path)
    if not sets:
        raise DataError(
            f"{path} would be empty: there is nothing that a universal file can hold", "a run with output of its motion"
        )
    content = b"".join(sets)
    with atomic_write(path, "free disk space and write the file again") as name:
        name.write_bytes(_header(content) + content)
    return path


def is_own(path: Path) -> bool:
    """Return whether Rattlebox wrote a universal file, and nobody has changed it since."""
    content = path.read_bytes()
    found = _SEAL.search(content, 0, _HEAD)
    if found is None:
        return False
    end = content.find(b"    -1\n", found.end()) + 7
    return _digest(content[end:]).encode() == found[1]


for _suffix in (".uff", ".unv", ".uf"):
    register_format(_suffix, is_own)


def _digest(content: bytes) -> str:
    return hashlib.blake2b(content, digest_size=16).hexdigest()


def _header(content: bytes) -> bytes:
    """Return the set 151, whose description has the digest of all that follows."""
    none = f"{'NONE':<80}"
    digest = f"Rattlebox, BLAKE2b of the sets below: {_digest(content)}"
    lines = [none, digest, none, f"{'':20}{0:10d}{0:10d}{0:10d}", "", f"{'Rattlebox':<80}", ""]
    return _set("   151", lines)


def _set(number: str, lines: Iterable[str], content: bytes = b"") -> bytes:
    """Return a set with its marks."""
    text = "\n".join(["    -1", f"{number:<80}", *(f"{line:<80}" for line in lines), ""])
    return text.encode("ascii", "replace") + content + b"    -1\n"


def _number(value: float) -> str:
    """Return a number in a column of 13 characters, with as many digits as fit."""
    value = float(value) + 0.0  # no -0
    for digits in range(17, 0, -1):
        for text in (f"{value:.{digits}g}", f"{value:.{digits - 1}e}"):
            mantissa, e, exponent = text.partition("e")
            mantissa += "" if "." in mantissa else "."  # without a point Fortran would read five decimals
            text = f"{mantissa}{e}{int(exponent)}" if e else mantissa
            if len(text) <= _WIDTH and (digits < 17 or float(text) == value):
                return f"{text:>{_WIDTH + 1}}"
    raise ValueError(f"{value!r} has no text of {_WIDTH} characters")


def function_set(function: Function) -> bytes:
    """Return the set 58b of a function."""
    x, values = np.asarray(function.x, float), np.asarray(function.values)
    if x.size < 2 or x.shape != values.shape:
        raise DataError(
            f"{function.name} has {values.size} points at {x.size} places; two or more are needed",
            "a longer run, or a higher output.rate",
        )
    is_complex = np.iscomplexobj(values)
    # Readers take the abscissa of even points from the header, as text.
    step = (x[-1] - x[0]) / (x.size - 1)
    first, step = float(_number(x[0])), float(_number(step))
    is_even = bool(np.abs(first + step * np.arange(x.size) - x).max() <= _EVEN * abs(step))
    columns = [values.real, values.imag] if is_complex else [values]
    data = np.column_stack(columns if is_even else [x, *columns]).astype("<f8").tobytes()
    head = f"    58b{1:6d}{2:6d}{11:12d}{len(data):12d}{0:6d}{0:6d}{0:12d}{0:12d}"
    even = (_number(first), _number(step)) if is_even else (_number(0.0), _number(0.0))
    x_name = {"s": "Time", "Hz": "Frequency"}.get(function.x_unit, "NONE")
    lines = [
        (function.name or "NONE")[:80],
        (function.note or "NONE")[:80],
        "NONE",
        "NONE",
        "NONE",
        f"{function.kind:5d}{0:10d}{0:5d}{0:10d} {'':10}{function.response[0]:10d}{function.response[1]:4d}"
        f" {'':10}{function.source[0]:10d}{function.source[1]:4d}",
        f"{6 if is_complex else 4:10d}{x.size:10d}{int(is_even):10d}{''.join(even)}{_number(0.0)}",
        _axis(function.x_unit, x_name),
        _axis(function.unit, "", function.quantity),
        _axis(function.source_unit, "", EXCITATION_FORCE if function.source_unit == "N" else None),
        _axis("", ""),
    ]
    return _set(head, lines, data)


def _axis(unit: str, name: str, kind: int | None = None) -> str:
    """Return the record of an axis; `kind` is the type of its data, by default that of its unit."""
    kind = QUANTITIES.get(unit, 1 if unit else 0) if kind is None else kind
    return f"{kind:10d}{0:5d}{0:5d}{0:5d} {(name or 'NONE')[:20]:<20} {(unit or 'NONE')[:20]:<20}"


def modes_sets(
    frequencies: FloatArray,
    damping_ratios: FloatArray,
    shapes: Mapping[int, FloatArray],
    positions: Mapping[int, Sequence[float]],
) -> list[bytes]:
    """Return the sets of mass-normalised normal modes in SI units.

    `shapes`: translations of each node, (m, 3) [kg^-1/2]; the modal masses are 1 kg. `positions`: coordinates of nodes [m];
    may be empty.
    """
    sets = [
        _set(
            "   164",
            [f"{1:10d}{'SI: m, N':>20}{2:10d}", f"{1:25.16e}{1:25.16e}{1:25.16e}".replace("e", "D"), "0.0D+00"],
        )
    ]
    if positions:
        lines = []
        for node, place in positions.items():
            lines += [f"{node:10d}{1:10d}{1:10d}{1:10d}", "".join(f"{x:25.16e}" for x in place)]
        sets.append(_set("  2411", lines))
    for k, (frequency, damping) in enumerate(zip(frequencies, damping_ratios, strict=True)):
        lines = [f"Mode {k + 1}, {frequency:.6g} Hz", "NONE", "NONE", "NONE", "NONE"]
        lines.append(f"{1:10d}{_NORMAL_MODES:10d}{3:10d}{_DISPLACEMENT:10d}{_REAL:10d}{3:10d}")
        lines.append(f"{2:10d}{4:10d}{0:10d}{k + 1:10d}")
        lines.append("".join(map(_number, (frequency, 1.0, damping, 0.0))))
        for node, shape in shapes.items():
            lines += [f"{node:10d}", "".join(map(_number, shape[k]))]
        sets.append(_unpadded("    55", lines))
    return sets


def _unpadded(number: str, lines: Sequence[str]) -> bytes:
    """Return a set whose lines of numbers have no blanks at their ends, which readers would take for numbers."""
    return "\n".join(["    -1", f"{number:<80}", *lines, "    -1", ""]).encode("ascii", "replace")
