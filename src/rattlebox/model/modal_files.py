"""Modes from files: selection of points, mass normalisation, units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from rattlebox._util.exceptions import CaseError, DataError
from rattlebox._util.text import has_controls
from rattlebox.exchange.read import ansys, modal_table, nastran_hdf5, text_results, universal  # noqa: F401  (they register their readers)
from rattlebox.exchange.read.formats import ModesRequest, modes_reader
from rattlebox.exchange.read.guarded import errors_of
from rattlebox.exchange.read.modes_in_file import ModesInFile, listed

from .elementwise import Vector
from .errors import Hint, at, nearest, several
from .files import check_finite, existing, read_text, read_toml
from .space import AXES
from .units import numbers, parse, whole_number

_TOML_FIELDS = ("frequencies", "damping_ratios", "modal_masses", "shapes", "participation")
_EXPORTS = {
    (
        ".med",
        ".rmed",
    ): "IMPR_RESU(FORMAT='IDEAS', ...) of DEPL in Code_Aster, which writes a universal file (.unv), and "
    "modal_masses: a .med file has no modal masses",
    (".op2", ".xdb"): "the .f06 or .pch file of Nastran with VECTOR = ALL, or its HDF5 file (MDLPRM, HDF5)",
    (".odb", ".fil", ".sim"): "a table of modes (.csv), written by a script of Abaqus/CAE from the frames of the step",
}
"""Files that are not read, and what to export instead."""
MOST_POINTS = 8  # largest number of points that are all read if none is named
_SHOWN = 200  # characters of a name or a value in a message
_SAME_UNIT = 1e-2  # relative difference of units that are the same
_SMALLEST_SHAPE = 1e-12  # kg^-1/2


def export_instead(file: Path) -> str:
    """Return what to export in place of a file of another program that is not read; "" if nothing is known of it."""
    return next((text for endings, text in _EXPORTS.items() if file.suffix.lower() in endings), "")


def read_modes(path: str, count: int | None, *, has_mass_unit: bool = False) -> ModesInFile | dict[str, Any]:
    """Read modes from a file of any supported kind; from a TOML file as fields of Modal."""
    file = existing(path)
    form = modes_reader.of(file)
    if form is None:
        raise DataError(
            f"{path}: modes cannot be read from files with the ending {file.suffix.lower()!r}",
            export_instead(file) or ", ".join(sorted(modes_reader.endings)),
        )
    with errors_of(path, "modes"):
        modes = form.read(file, ModesRequest(count, has_mass_unit))
    return modes if isinstance(modes, ModesInFile) else dict(modes)


@modes_reader(".toml")
def _from_toml(file: Path, _: ModesRequest) -> dict[str, Any]:
    try:
        table = read_toml(read_text(file), str(file))
    except CaseError as error:
        advice = error.suggestion or 'frequencies = ["10 Hz"] and [shapes] tip = [0.7]'
        raise error.restated(DataError, suggestion=advice) from None
    if not table:
        raise DataError(f"{file} is empty", "frequencies, damping_ratios and shapes")
    for name in table:
        if name not in _TOML_FIELDS:
            raise DataError(f"{file}: a table of modes has no field {name!r}", nearest(name, _TOML_FIELDS))
    for name in ("frequencies", "shapes"):
        if name not in table:
            raise DataError(f"{file}: {name} are needed", 'frequencies = ["10 Hz"] and [shapes] tip = [0.7]')
    return table


def _modes_with_masses(given: Mapping[str, object], path: str, count: int | None) -> ModesInFile:
    """Return the modes of a file with the modal masses that the user states, or else its own."""
    with at("file"):
        modes = read_modes(path, count, has_mass_unit=given.get("mass_unit") is not None)
    # Modal masses of the user replace those of the file.
    masses = None
    if given.get("modal_masses") is not None:
        with at("modal_masses"):
            masses = _modal_masses(given["modal_masses"], given, in_kg=True)
    if isinstance(modes, dict):
        if masses is None and "modal_masses" in modes:
            with at("file"), errors_of(path, "a table of modes"):
                try:
                    masses = _modal_masses(modes["modal_masses"], given, in_kg=False)
                except Hint as hint:
                    raise Hint(f"{path}: {hint.complaint}", hint.suggestion or 'modal_masses = ["1 kg", ...]') from None
        return _modes_of_toml(modes, path, masses, has_mass_unit=given.get("mass_unit") is not None)
    return modes if masses is None else replace(modes, modal_masses=masses, mass_unit=1.0)


def _check_fit(modes: ModesInFile, path: str, count: int) -> None:
    """Raise if one of the first modes cannot be read as a real one."""
    total = modes.frequencies.size
    bad = min(modes.unfit, default=total + 1)
    if bad <= count:
        fit = [number for number in range(1, total + 1) if number not in modes.unfit]
        advice = (
            f"mode_numbers = {fit}, which leaves out those that do not fit" if fit else "an export of real normal modes"
        )
        raise DataError(
            f"{path}: mode {bad} at {modes.frequencies[bad - 1]:.4g} Hz: {modes.unfit[bad]}", advice, ["file"]
        )


def fields_of_modes(given: Mapping[str, object], path: str) -> tuple[dict[str, Any], list[str]]:
    """Return the fields of Modal with the modes of a file, and notes of assumptions."""
    count = given.get("mode_count")
    if count is not None:
        with at("mode_count"):
            count = whole_number(count, "mode_count", 1)
    name = Path(path).name
    modes = _chosen(_modes_with_masses(given, path, count), given, name)
    with at("file"):
        _check_numbers(modes, path)
    # The first modes only, mass-normalised and in SI units.
    first = slice(None, count)
    total = modes.frequencies.size
    if count is not None and count > total:
        raise Hint(f"{name} has {total} modes", f"mode_count = {total}", ["mode_count"])
    _check_fit(modes, path, count or total)
    scale, notes = _scale(modes, given, name, path)
    points = _select_points(modes, given, name)
    with at("file"):
        for point, shape in points.items():
            check_finite((shape.T * scale).T, f"{path}: the mass-normalised shape at {point}")
    fields: dict[str, Any] = {
        "frequencies": modes.frequencies[first].tolist(),
        "shapes": {point: (shape[first].T * scale[first]).T.tolist() for point, shape in points.items()},
    }
    # What the user states has priority over the file; only damping must come from one of them.
    if all(given.get(name) is None for name in ("damping_ratios", "damping_ratio", "damping_matrix")):
        if modes.damping_ratios is None:
            raise Hint(f"{name} states no damping", "damping_ratio = 0.01, or 0", ["damping_ratio"])
        fields["damping_ratios"] = modes.damping_ratios[first].tolist()
    if given.get("participation") is None and modes.participation is not None:
        participation = _participation(modes, given, fields["shapes"], scale)
        if participation is not None:
            fields["participation"] = participation[first].tolist()
            if given.get("total_mass") is None and modes.total_mass is not None:
                fields["total_mass"] = _total_mass(modes, given, participation.ndim == 2)
    # An unknown unit of mass shows in the size of the shapes: the notes state it.
    largest, point = max((float(np.abs(row).max()), point) for point, row in fields["shapes"].items())
    if not largest > _SMALLEST_SHAPE:
        raise DataError(
            f"{path}: no mode moves any of the points {listed(list(fields['shapes']))}", "other points", ["file"]
        )
    size = f"the largest mass-normalised shape is {largest:.4g} kg^-0.5, at {point}"
    rigid = int((modes.frequencies[first] == 0).sum())
    rest = [f"{name} has {several(rigid, 'rigid-body mode')}, without stiffness and damping"] if rigid else []
    return fields, [*(f"{note}; {size}" for note in notes), *modes.notes, *rest]


def _chosen(modes: ModesInFile, given: Mapping[str, object], name: str) -> ModesInFile:
    """Return the modes that `mode_numbers` names by their numbers in the file; all if it names none."""
    chosen, total = given.get("mode_numbers"), modes.frequencies.size
    if chosen is None:
        return modes
    if not isinstance(chosen, (list, tuple)) or not chosen:
        raise Hint("mode_numbers are a list of numbers of modes in the file", "mode_numbers = [1, 3]", ["mode_numbers"])
    with at("mode_numbers"):
        numbers = [whole_number(number, "mode_numbers", 1) for number in chosen]
    if max(numbers) > total or len(set(numbers)) < len(numbers):
        raise Hint(
            f"mode_numbers must name each mode once, by numbers from 1 to {total}, which {name} has; got {numbers}",
            f"mode_numbers = {sorted({min(number, total) for number in numbers})}",
            ["mode_numbers"],
        )
    return modes.chosen(numbers)


def _check_numbers(modes: ModesInFile, path: str) -> None:
    """Raise if a number of the modes is not finite or absurd, whatever the format of the file."""
    arrays: dict[str, Any] = {
        "frequencies": modes.frequencies,
        **{f"the shape at {name}": row for name, row in modes.shapes.items()},
    }
    arrays |= {"damping_ratios": modes.damping_ratios, "modal_masses": modes.modal_masses}
    arrays |= {"participation": modes.participation, "total_mass": modes.total_mass}
    for what, array in arrays.items():
        if array is None:
            continue
        array = check_finite(np.asarray(array, dtype=float), f"{path}: {what}")
        if what in ("frequencies", "damping_ratios") and np.any(array < 0):
            raise DataError(f"{path}: {what} contains {array.min():g}, which is negative", "numbers of zero and more")


def _modes_of_toml(table: dict[str, Any], path: str, masses: Vector | None, *, has_mass_unit: bool) -> ModesInFile:
    """Return the modes of a TOML table."""
    with at("file"), errors_of(path, "a table of modes"):
        for name in table:
            if not isinstance(table[name], dict if name == "shapes" else list) or not table[name]:
                raise DataError(f"{path}: {name} is not a list of values, or a table of lists", "[shapes] tip = [0.7]")
        try:
            modes = ModesInFile(
                frequencies=np.array([parse(f, ("Hz",))[0] for f in table["frequencies"]]),
                shapes={point: numbers(row) for point, row in table["shapes"].items()},
                modal_masses=masses,
                damping_ratios=numbers(table["damping_ratios"]) if "damping_ratios" in table else None,
                participation=numbers(table["participation"]) if "participation" in table else None,
                mass_unit=None if has_mass_unit else 1.0,
            )
        except Hint as hint:
            raise DataError(
                f"{path}: {hint.complaint[:_SHOWN]}", hint.suggestion or "numbers, or text with a unit"
            ) from None
        for name, row in modes.shapes.items():
            if has_controls(name):
                raise DataError(f"{path}: the name {name[:_SHOWN]!r} contains a control character", "printable names")
            if row.ndim not in (1, 2) or len(row) != modes.frequencies.size or (row.ndim == 2 and row.shape[1] != 3):
                raise DataError(
                    f"{path}: the shape at {name[:_SHOWN]!r} has the size {row.shape}, but there are"
                    f" {modes.frequencies.size} frequencies",
                    "one number, or three along x, y and z, for each mode",
                )
        for name, values in (("damping_ratios", modes.damping_ratios), ("modal_masses", masses)):
            if values is not None and values.shape != modes.frequencies.shape and name in table:
                raise DataError(
                    f"{path}: {values.size} {name}, but {modes.frequencies.size} frequencies", "one for each mode"
                )
    return modes


def _modal_masses(values: Any, given: Mapping[str, Any], *, in_kg: bool) -> Vector:
    """Read modal masses [kg]; numbers without unit are in kg, or, unless `in_kg`, in the unit of mass of the file."""
    masses, own = zip(*(parse(mass, ("kg",)) for mass in values), strict=True) if len(values) else ((), ())
    if given.get("mass_unit") not in (None, "kg") and (in_kg or any(own)):
        raise Hint(
            f"modal masses have their own unit, or are in kg, and mass_unit = {given['mass_unit']!r} contradicts that",
            f'modal_masses = ["1 {given["mass_unit"]}", ...] for mass-normalised shapes in that unit, without mass_unit',
        )
    return np.array(masses)


def _scale(modes: ModesInFile, given: Mapping[str, object], name: str, path: str) -> tuple[Vector, list[str]]:
    """Return the factor of each mode that makes its shape mass-normalised in SI, and notes of assumptions."""
    unit, notes = modes.mass_unit, []
    if given.get("mass_unit") is not None:
        with at("mass_unit"):
            own = parse(f"1 {given['mass_unit']}", ("kg",))[0]
            if unit is not None and abs(own / unit - 1) > _SAME_UNIT:
                raise Hint(
                    f"{name} states that its unit of mass is {unit:.6g} kg, and mass_unit is {own:.6g} kg",
                    "mass_unit left out; or a modal table in CSV, with units, if the file is wrong",
                )
            unit = own
    elif unit is None:
        unit = 1.0
        notes.append(f"{name} states no unit of mass; kg is assumed (mass_unit sets another)")
    total = modes.frequencies.size
    if modes.modal_masses is None:
        return np.full(total, unit**-0.5), notes
    masses = np.asarray(modes.modal_masses, dtype=float)
    if masses.shape != (total,):
        raise Hint(
            f"{masses.size} modal masses, but {name} has {several(total, 'mode')}", "one for each", ["modal_masses"]
        )
    wrong = np.flatnonzero(~(masses > 0))
    if wrong.size:
        raise DataError(
            f"{path}: mode {wrong[0] + 1} has a modal mass of {masses[wrong[0]]:g}; it must be greater than zero",
            'modal_masses = ["1 kg", ...], one for each mode; "1 kg" for shapes that are mass-normalised',
            ["file"],
        )
    return (masses * unit) ** -0.5, notes


def _select_points(modes: ModesInFile, given: Mapping[str, object], name: str) -> dict[str, Vector]:
    """Return the mode shapes at the requested points."""
    requested = given.get("points")
    labels = list(modes.shapes)
    if requested is None:
        if len(labels) > MOST_POINTS:
            raise Hint(
                f"{name} has {len(labels)} points; a selection is needed of more than {MOST_POINTS}",
                f'points = {{ tip = "{labels[0]}" }}, or "{labels[0]} z" for one direction',
                ["points"],
            )
        return modes.shapes
    if not isinstance(requested, Mapping) or not requested:
        raise Hint("points are a table of names and labels in the file", f'{{ tip = "{labels[0]}" }}', ["points"])
    points = {}
    for point, value in requested.items():
        with at("points", point):
            text = str(value) if isinstance(value, (int, str)) and not isinstance(value, bool) else ""
            label, axis = text, None
            stem, _, last = text.strip().rpartition(" ")
            if text not in modes.shapes:
                is_axis = bool(stem) and last.removeprefix("-") in AXES
                label, axis = (stem.rstrip(), last) if is_axis else (text.strip(), None)
            if label not in modes.shapes:
                raise Hint(f"{name} has no point {label!r}; it has {listed(labels)}", nearest(label, labels[:200]))
            shape = modes.shapes[label]
            if axis is not None:
                if shape.ndim == 1:
                    raise Hint(f"the shape at {label!r} has no components", f'"{label}"')
                shape = shape[:, AXES.index(axis[-1])] * (-1.0 if axis[0] == "-" else 1.0)
            points[str(point)] = shape
    return points


def _total_mass(modes: ModesInFile, given: Mapping[str, Any], spatial: bool) -> Any:
    """Return the total mass [kg]; three numbers if shapes have three components."""
    unit = modes.mass_unit or 1.0
    if given.get("mass_unit") is not None:
        unit = parse(f"1 {given['mass_unit']}", ("kg",))[0]
    masses = np.asarray(modes.total_mass) * unit
    if spatial:
        return masses.tolist() if (masses > 0).all() else None
    axis = str(next(iter((given.get("points") or {}).values()))).rpartition(" ")[2]
    return float(masses[AXES.index(axis[-1])])


def _participation(modes: ModesInFile, given: Mapping[str, Any], shapes: Mapping[str, Any], scale: Vector) -> Any:
    """Return the participation in SI, per axis if shapes have three components; None if the axis is unknown."""
    rows = np.asarray(modes.participation, dtype=float)
    spatial = any(np.ndim(row) == 2 for row in shapes.values())
    if rows.ndim == 2 and not spatial:
        axes = {str(place).rpartition(" ")[2] for place in (given.get("points") or {}).values()}
        axis = axes.pop() if len(axes) == 1 else ""
        if axis.removeprefix("-") not in AXES or not axis:
            return None
        rows = rows[:, AXES.index(axis[-1])] * (-1.0 if axis[0] == "-" else 1.0)
    elif rows.ndim == 1 and spatial:
        raise Hint(
            "the file has one participation factor for each mode, but shapes with three components need three",
            "columns participation x, participation y and participation z",
            ["file"],
        )
    # phi^T M r has the unit of mass for shapes with modal masses, and of its root for mass-normalised shapes.
    factor = 1 / scale
    if modes.modal_masses is not None:
        factor = factor / np.asarray(modes.modal_masses, dtype=float)
    return (rows.T * factor).T
