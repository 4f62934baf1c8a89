"""Modes in files: which points are taken, mass normalisation, units."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from rattlebox._util.exceptions import DataError
from rattlebox.exchange.read.ansys import read_full, read_result
from rattlebox.exchange.read.modal_table import read_modal_table
from rattlebox.exchange.read.modes_in_file import ModesInFile, listed
from rattlebox.exchange.read.universal import read_universal_modes

from .elementwise import Vector
from .errors import Hint, at, nearest
from .files import existing, read_toml
from .space import AXES
from .units import numbers, parse, whole_number

_TABLES = (".csv", ".txt", ".tsv")
_UNIVERSAL = (".uff", ".unv", ".uf")
_KNOWN = ".csv, .toml, .uff, .unv, .rst or .full"
_IN_TOML = ("frequencies", "damping_ratios", "modal_masses", "shapes", "participation")
_COMPUTED = 10  # modes of a .full file, unless another number is asked for
_ALL = 8  # points of a file that are taken if none is named
_HEAVIEST = 1e-12  # kg^-1/2

_PLACE = re.compile(r"^\s*(.+?)(?:\s+(-?[xyz]))?\s*$")


def read_modes(path: str, count: int | None) -> ModesInFile | dict[str, Any]:
    """Read modes from a file of any known kind; a TOML file gives fields of Modal.

    Raises
    ------
    DataError
        If the file cannot be read.
    """
    file = existing(path)
    ending = file.suffix.lower()
    if ending == ".toml":
        return _from_toml(file)
    if ending in _TABLES:
        return read_modal_table(file)
    if ending in _UNIVERSAL:
        return read_universal_modes(file)
    if ending == ".rst":
        return read_result(file)
    if ending == ".full":
        return read_full(file, count or _COMPUTED)
    raise DataError(f"{path}: files with the ending {ending!r} hold no modes that are read here", _KNOWN)


def _from_toml(file: Path) -> dict[str, Any]:
    try:
        content = file.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise DataError(f"{file} cannot be read: {error}") from None
    given = read_toml(content, str(file))
    if not given:
        raise DataError(f"{file} is empty", "frequencies, damping_ratios and shapes")
    for name in given:
        if name not in _IN_TOML:
            raise DataError(f"{file}: there is no field {name!r} in a table of modes", nearest(name, _IN_TOML))
    for name in ("frequencies", "shapes"):
        if name not in given:
            raise DataError(f"{file}: {name} are needed", 'frequencies = ["10 Hz"] and [shapes] tip = [0.7]')
    return given


def fields_of_modes(given: Mapping[str, Any], path: str) -> tuple[dict[str, Any], list[str]]:
    """Return the fields of Modal that a file stands for, and notes of what was assumed.

    Parameters
    ----------
    given
        Fields beside the file: points, mode_count, mass_unit, modal_masses, damping_ratios, damping_ratio, participation.
    path
        The file.

    Raises
    ------
    DataError, Hint
        If the file cannot be read, or does not fit the fields.
    """
    count = given.get("mode_count")
    if count is not None:
        with at("mode_count"):
            count = whole_number(count, "mode_count", 1)
    with at("file"):
        found = read_modes(path, count)
    name = Path(path).name
    if isinstance(found, dict):
        masses = given.get("modal_masses", found.pop("modal_masses", None))
        if masses is not None:
            with at("modal_masses"):
                masses = np.array([parse(mass, ("kg",))[0] for mass in masses])
        shapes = {point: numbers(row) for point, row in found["shapes"].items()}
        found = ModesInFile(
            frequencies=np.array([parse(f, ("Hz",))[0] for f in found["frequencies"]]),
            shapes=shapes,
            modal_masses=masses,
            damping_ratios=numbers(found["damping_ratios"]) if "damping_ratios" in found else None,
            participation=numbers(found["participation"]) if "participation" in found else None,
            mass_unit=1.0,
        )
    elif given.get("modal_masses") is not None:
        with at("modal_masses"):
            found = replace(
                found, modal_masses=np.array([parse(m, ("kg",))[0] for m in given["modal_masses"]]), mass_unit=1.0
            )
    kept = slice(None, count)
    total = found.frequencies.size
    if count is not None and count > total:
        raise Hint(f"{name} has {total} modes", f"mode_count = {total}", ["mode_count"])
    scale, notes = _scale(found, given, name, path)
    fields: dict[str, Any] = {
        "frequencies": found.frequencies[kept].tolist(),
        "shapes": {
            point: (shape[kept].T * scale[kept]).T.tolist() for point, shape in _points(found, given, name).items()
        },
    }
    if all(given.get(name) is None for name in ("damping_ratios", "damping_ratio", "damping_matrix")):
        if found.damping_ratios is None:
            raise Hint(f"{name} states no damping", "damping_ratio = 0.01, or 0", ["damping_ratio"])
        fields["damping_ratios"] = found.damping_ratios[kept].tolist()
    if given.get("participation") is None and found.participation is not None:
        participation = _participation(found, given, fields["shapes"], scale)
        if participation is not None:
            fields["participation"] = participation[kept].tolist()
            if given.get("total_mass") is None and found.total_mass is not None:
                fields["total_mass"] = _total_mass(found, given, participation.ndim == 2)
    largest = max((float(np.abs(row).max()), point) for point, row in fields["shapes"].items())
    if not largest[0] > _HEAVIEST:
        raise DataError(
            f"{path}: no point of {listed(list(fields['shapes']))} moves in any mode", "other points", ["file"]
        )
    told = f"the largest mass-normalised shape is {largest[0]:.4g} kg^-0.5, at {largest[1]}"
    return fields, [f"{note}; {told}" for note in (*notes, *(found.notes))]


def _scale(found: ModesInFile, given: Mapping[str, Any], name: str, path: str) -> tuple[Vector, list[str]]:
    """Factor of each mode that makes its shape mass-normalised in SI, and what was assumed."""
    unit, notes = found.mass_unit, []
    if given.get("mass_unit") is not None:
        with at("mass_unit"):
            unit = parse(f"1 {given['mass_unit']}", ("kg",))[0]
    elif unit is None:
        unit = 1.0
        notes.append(f"{name} states no unit of mass; kg is assumed (mass_unit sets another)")
    total = found.frequencies.size
    if found.modal_masses is None:
        return np.full(total, unit**-0.5), notes
    masses = np.asarray(found.modal_masses, dtype=float)
    if masses.shape != (total,):
        raise Hint(f"{masses.size} modal masses for {total} modes", "one for each mode", ["modal_masses"])
    wrong = np.flatnonzero(~(masses > 0))
    if wrong.size:
        raise DataError(
            f"{path}: mode {wrong[0] + 1} has a modal mass of {masses[wrong[0]]:g}, so that its shape has no scale",
            'modal_masses = ["1 kg", ...], one for each mode; "1 kg" for shapes that are mass-normalised',
            ["file"],
        )
    return (masses * unit) ** -0.5, notes


def _points(found: ModesInFile, given: Mapping[str, Any], name: str) -> dict[str, Vector]:
    """Mode shapes at the points that are asked for."""
    asked = given.get("points")
    labels = list(found.shapes)
    if asked is None:
        if len(labels) > _ALL:
            raise Hint(
                f"{name} has {len(labels)} points; which of them are needed?",
                f'points = {{ tip = "{labels[0]}" }}, or "{labels[0]} z" for one direction',
                ["points"],
            )
        return found.shapes
    if not isinstance(asked, Mapping) or not asked:
        raise Hint("points are a table of names and labels in the file", f'{{ tip = "{labels[0]}" }}', ["points"])
    points = {}
    for point, place in asked.items():
        with at("points", point):
            text = str(place) if isinstance(place, (int, str)) and not isinstance(place, bool) else ""
            label, axis = (text, None) if text in found.shapes else _split(text)
            if label not in found.shapes:
                raise Hint(f"{name} has no point {label!r}; it has {listed(labels)}", nearest(label, labels[:200]))
            shape = found.shapes[label]
            if axis is not None:
                if shape.ndim == 1:
                    raise Hint(f"the point {label!r} moves along one line only", f'"{label}"')
                shape = shape[:, AXES.index(axis[-1])] * (-1.0 if axis[0] == "-" else 1.0)
            points[str(point)] = shape
    return points


def _total_mass(found: ModesInFile, given: Mapping[str, Any], spatial: bool) -> Any:
    """Return the total mass in SI; three numbers if points move in space."""
    unit = found.mass_unit or 1.0
    if given.get("mass_unit") is not None:
        unit = parse(f"1 {given['mass_unit']}", ("kg",))[0]
    masses = np.asarray(found.total_mass) * unit
    if spatial:
        return masses.tolist() if (masses > 0).all() else None
    axis = str(next(iter((given.get("points") or {}).values()))).rpartition(" ")[2]
    return float(masses[AXES.index(axis[-1])])


def _split(text: str) -> tuple[str, str | None]:
    match = _PLACE.match(text)
    return (match[1], match[2]) if match else (text, None)


def _participation(found: ModesInFile, given: Mapping[str, Any], shapes: Mapping[str, Any], scale: Vector) -> Any:
    """Participation in SI, with three numbers for each mode if a point moves in space; None if its direction is open."""
    rows = np.asarray(found.participation, dtype=float)
    spatial = any(np.ndim(row) == 2 for row in shapes.values())
    if rows.ndim == 2 and not spatial:
        axes = {str(place).rpartition(" ")[2] for place in (given.get("points") or {}).values()}
        axis = axes.pop() if len(axes) == 1 else ""
        if axis.removeprefix("-") not in AXES or not axis:
            return None
        rows = rows[:, AXES.index(axis[-1])] * (-1.0 if axis[0] == "-" else 1.0)
    elif rows.ndim == 1 and spatial:
        raise Hint(
            "the file has one participation for each mode, but points move in space",
            "columns participation x, participation y and participation z",
            ["file"],
        )
    # phi^T M r is in units of mass for shapes with modal masses, and in their root for mass-normalised ones.
    factor = 1 / scale
    if found.modal_masses is not None:
        factor = factor / np.asarray(found.modal_masses, dtype=float)
    return (rows.T * factor).T
