"""Previews of files: what a record, modes or a cavity in a file would be, with lines of TOML and Python that read it."""

from __future__ import annotations

import json
import os
import tomllib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rattlebox._util.exceptions import CaseError, DataError, RattleboxError
from rattlebox._util.quantities import amount
from rattlebox.exchange.read.formats import density_reader, modes_reader, record_reader, signals_in
from rattlebox.exchange.read.guarded import errors_of
from rattlebox.exchange.read.modes_in_file import ModesInFile
from rattlebox.exchange.read.surfaces import ENDINGS, STEP
from rattlebox.exchange.read.universal import frequency_responses

from .density_files import density_names, states_density
from .effective_masses import effective_masses
from .elementwise import Vector
from .errors import several
from .face_groups import FROM_FILE
from .files import BINARY, existing, read_arrays, read_text
from .matrices import Matrices
from .mesh_cavity import Mesh
from .modal_files import MOST_POINTS, export_instead, read_modes
from .random_vibration import Random
from .recorded import Record, is_table
from .records import columns_of_arrays, columns_of_text
from .structures import Modal, StructurePart
from .triangle_surface import surface_notes
from .units import STANDARD_GRAVITY

_ASSUMED_DURATION = "1 s"
_ASSUMED_LENGTH = "mm"
_ASSUMED_STEP, _ASSUMED_UNIT, _ASSUMED_DAMPING = "0.01 s", "m/s^2", 0.01
_LISTED = 12
_HEAD = 1000  # bytes of a table that contain its headings
_EVEN = 1e-3  # relative difference of time steps that count as the same


@dataclass(frozen=True)
class FileContents:
    """What is in a file; its text is the preview.

    Attributes
    ----------
    file
        Path of the file.
    content
        What the file is, such as "a record".
    lines
        Channels with unit, samples, sampling and peak, modes with their frequencies, or size and groups of a surface.
    notes
        What is assumed.
    toml, python
        Lines that read the first channel, the modes or the surface; "" if there is none, and `toml` for frequency responses.
    """

    file: str
    content: str
    lines: tuple[str, ...]
    notes: tuple[str, ...]
    toml: str
    python: str

    def __str__(self) -> str:
        parts = [f"{self.file}: {self.content}", *(f"  {line}" for line in self.lines)]
        parts += [f"  note: {note}" for note in self.notes]
        if self.toml:
            parts += ["", "In a case file:", "", self.toml]
        if self.python:
            parts += ["", "In Python:", "", self.python]
        return "\n".join(parts)


def inspect(file: str | os.PathLike[str]) -> FileContents:
    r"""Return a preview of a file of another program: channels or modes, what is assumed, and how to use it.

    Parameters
    ----------
    file
        A file with records (see `file` of `rb.Record`), power spectral densities (`rb.Random`), modes (`rb.Modal`),
        frequency responses of a universal file, or a closed surface (`rb.Mesh`).

    Returns
    -------
    FileContents
        The content; `print` shows it.

    Raises
    ------
    DataError
        If the file cannot be read.

    Examples
    --------
    >>> import rattlebox as rb
    >>> with open("push.csv", "w") as file:
    ...     _ = file.write("time (ms),force (kN)\n0,0\n1,1.5\n2,0.5\n")
    >>> print(rb.inspect("push.csv").python)
    rb.Record.from_file("push.csv", columns="force (kN)")
    """
    path, given = existing(file), os.fspath(file)
    if instead := export_instead(path):
        raise DataError(f"{path}: files with the ending {path.suffix.lower()!r} are not read", instead)
    _refuse_own_files(path)
    if found := _surface(path, given) or _matrices(path, given):
        return found
    problem: RattleboxError | None = None
    # Universal files and tables may have records or modes: the first that can be read.
    with errors_of(path, "a file"), path.open("rb") as stream:
        is_table_of_modes = b"frequenc" in stream.read(_HEAD).lower() and path.suffix.lower() in (
            ".csv",
            ".txt",
            ".tsv",
        )
    for view in (_modes, _records) if is_table_of_modes else (_densities, _records, _modes, _responses):
        try:
            if found := view(path, given):
                return found
        except RattleboxError as error:
            is_other = problem is not None and "contains no set 58" in str(problem)  # the modes have the better reason
            problem = error if is_other or is_table_of_modes else problem or error
    raise problem or DataError(
        f"{path}: files with the ending {path.suffix.lower()!r} have neither records nor modes that are read",
        ", ".join(sorted({*record_reader.endings, *modes_reader.endings})),
    )


def _refuse_own_files(path: Path) -> None:
    """Raise if a file is a case, a study or a result."""
    if path.suffix.lower() == ".nc":
        raise DataError(f"{path} is a result, not a file of another program", f"rattlebox show {path}")
    if path.suffix.lower() != ".toml":
        return
    try:
        fields = tomllib.loads(read_text(path))
    except tomllib.TOMLDecodeError:
        return  # the reader of modes has the place
    for field, what, command in (("structure", "case", "run"), ("kind", "study", "sweep")):
        if field in fields:
            raise DataError(
                f"{path} is a {what} file of Rattlebox, not a file of another program", f"rattlebox {command} {path}"
            )


def _records(path: Path, given: str) -> FileContents | None:
    if path.suffix.lower() == ".toml":
        return None
    form = record_reader.of(path)
    if form is None and modes_reader.of(path) is not None:
        return None
    if form is None or is_table(form):
        kind = "a file of arrays" if path.suffix.lower() in BINARY else "a table of text"
        with errors_of(path, "columns of numbers"):
            ways = list(
                columns_of_arrays(path, read_arrays(path)) if path.suffix.lower() in BINARY else columns_of_text(path)
            )
    else:
        kind = "a file of time histories"
        signals = signals_in(path, form)
        ways = [(signal.name or f"number {k}", {"columns": (k,)}) for k, signal in enumerate(signals, start=1)]
        ways = [(ways[0][0], {})] if len(ways) == 1 else ways
    # Each way to read a channel is tried: what is shown is what a case would use.
    lines: list[str] = []
    first: tuple[Record, dict[str, Any], list[str]] | None = None
    problem: RattleboxError | None = None
    for name, options in ways[:_LISTED]:
        assumed: list[str] = []
        try:
            record = Record(file=str(path), **_with_step(options, assumed))
            options = _with_step(options, [])
            if record.unit is None:
                options = {**options, "unit": _ASSUMED_UNIT}
                assumed.append(
                    f"unit = {_ASSUMED_UNIT!r}, since the file states none that is known: set that of the values"
                )
                record = Record(file=str(path), **options)
        except RattleboxError as error:
            problem = problem or error
            lines.append(f"{name}: cannot be read: {' '.join(error.complaint.split())[:200]}")
            continue
        lines.append(f"{name}: {_described(record)}")
        first = first or (record, options, assumed)
    if len(ways) > _LISTED:
        lines.append(f"... and {len(ways) - _LISTED} more")
    if first is None:
        if problem is not None:
            raise problem
        return None
    record, options, assumed = first
    table = {"m/s^2": "base", "m": "motion"}.get(record.unit or "", "load")
    fields = {"file": given, **options}
    toml = [f"[{table}]", 'kind = "record"', *(f"{key} = {_toml(value)}" for key, value in fields.items())]
    python = "".join(f", {key}={_python(value)}" for key, value in options.items())
    return FileContents(
        given,
        f"{kind} with {len(ways)} {'channel' if len(ways) == 1 else 'channels'}",
        tuple(lines),
        (*(f"assumed: {text}" for text in assumed), *record.notes()),
        "\n".join(toml),
        f"rb.Record.from_file({json.dumps(given, ensure_ascii=False)}{python})",
    )


def _densities(path: Path, given: str) -> FileContents | None:
    """Return the preview of a table with a unit of a density above it, or of a file with densities and no time histories."""
    form = record_reader.of(path)
    if form is None or is_table(form):
        names = ["values"] if path.suffix.lower() != ".toml" and states_density(path) else []
    else:
        try:
            signals_in(path, form)
            names = []
        except DataError:
            names = density_names(path)
    if not names:
        return None
    # The first density that can be read is the one of the example.
    lines = []
    fields: dict[str, Any] = {}
    notes: tuple[str, ...] = ()
    for number, name in enumerate(names[:_LISTED], start=1):
        options: dict[str, Any] = {} if len(names) == 1 else {"columns": (number,)}
        try:
            random = Random(file=str(path), duration=_ASSUMED_DURATION, **options)
        except RattleboxError as error:
            lines.append(f"{name}: cannot be read: {' '.join(error.complaint.split())[:200]}")
            continue
        (first, _), (last, _) = random.corners[0], random.corners[-1]
        in_g = f" = {random.rms / STANDARD_GRAVITY:.4g} g" if random.unit == "m/s^2" else ""
        lines.append(
            f"{name}: {several(len(random.corners), 'line')} from {first:.6g} to {last:.6g} Hz, {random.rms:.4g} "
            f"{random.unit}{in_g} RMS"
        )
        if not fields:
            fields, notes = {"duration": _ASSUMED_DURATION, **options}, tuple(random.notes())
            table = "load" if random.unit == "N" else "base" if random.unit == "m/s^2" else "motion"
    if len(names) > _LISTED:
        lines.append(f"... and {len(names) - _LISTED} more")
    # None can be read as it is, mostly for want of a unit: the example shows where it stands.
    if not fields:
        fields, table = {"duration": _ASSUMED_DURATION, "unit": "g"}, "base"
        fields.update({} if len(names) == 1 else {"columns": (1,)})
        notes = ("assumed: unit = 'g', since the file states none that is known: set that of the signal",)
    toml = [
        f"[{table}]",
        'kind = "random"',
        *(f"{key} = {_toml(value)}" for key, value in {"file": given, **fields}.items()),
    ]
    python = "".join(f", {key}={_python(value)}" for key, value in fields.items())
    return FileContents(
        given,
        f"power spectral {'density' if len(names) == 1 else 'densities'}",
        tuple(lines),
        (f"assumed: duration = {_ASSUMED_DURATION!r}: set that of the run, or more", *notes),
        "\n".join(toml),
        f"rb.Random.from_file({json.dumps(given, ensure_ascii=False)}{python})",
    )


def _responses(path: Path, given: str) -> FileContents | None:
    """Return the preview of a universal file with frequency responses."""
    if density_reader.of(path) is None:
        return None
    functions = frequency_responses(path)
    lines = []
    for number, each in enumerate(functions[:_LISTED], start=1):
        is_plain = "/" not in f"{each.unit}{each.source_unit}"
        ratio = f"{each.unit}/{each.source_unit}" if is_plain else f"({each.unit})/({each.source_unit})"
        unit = ratio if each.unit and each.source_unit else each.unit
        lines.append(
            f"{each.name or f'number {number}'}: {several(each.abscissa.size, 'line')} from {each.abscissa[0]:.6g} to "
            f"{each.abscissa[-1]:.6g} {each.abscissa_unit or 'Hz'}, largest magnitude {np.abs(each.values).max():.4g} "
            f"{unit or '(the file states no unit)'}"
        )
    if len(functions) > _LISTED:
        lines.append(f"... and {len(functions) - _LISTED} more")
    choice = ", function=1" if len(functions) > 1 else ""
    return FileContents(
        given,
        several(len(functions), "frequency response"),
        tuple(lines),
        (),
        "",
        f"rb.analysis.read_frequency_response({json.dumps(given, ensure_ascii=False)}{choice})",
    )


def _with_step(options: dict[str, Any], assumed: list[str]) -> dict[str, Any]:
    """Return options with a time step in place of an unknown one."""
    if options.get("dt", "") is not None:
        return options
    assumed.append(f"dt = {_ASSUMED_STEP!r}, since the file states no time between samples: set it")
    return {**options, "dt": _ASSUMED_STEP}


def _described(record: Record) -> str:
    """Return samples, sampling and peak of a record."""
    steps = np.diff(record.times)
    step = float(steps.mean())
    is_even = float(np.ptp(steps)) <= _EVEN * step
    sampling = f"every {step:.6g} s ({1 / step:.6g} Hz)" if is_even else f"at uneven steps of {step:.4g} s on average"
    peak = f"{record.peak:.4g} {record.unit}"
    if record.unit == "m/s^2":
        peak += f" = {record.peak / STANDARD_GRAVITY:.4g} g"
    if record.unit == "m":
        peak += f" = {1e3 * record.peak:.4g} mm"
    return f"{record.times.size} samples {sampling}, {record.times[0]:.6g} s to {record.times[-1]:.6g} s, peak {peak}"


def _modes(path: Path, given: str) -> FileContents | None:
    if modes_reader.of(path) is None:
        return None
    options, assumed = _options_of_modes(read_modes(str(path), None))
    modal = Modal.from_file(str(path), **options)
    lines = _lines_of_structure(modal.frequencies, list(modal.shapes))
    if modal.participation is None:
        lines.append("effective masses: unknown, since the file states no participation, which a moving base needs")
    else:
        lines += _table_of_masses(modal)
    return _structure(given, "modes of a structure", modal, lines, assumed, options)


def _surface(path: Path, given: str) -> FileContents | None:
    """Return the preview of a file with a surface of triangles; None for other files."""
    if path.suffix.lower() not in ENDINGS:
        return None
    states_unit = path.suffix.lower() in STEP
    options: dict[str, Any] = {} if states_unit else {"unit": _ASSUMED_LENGTH}
    try:
        cavity = Mesh(file=str(path), **options)
    except CaseError as error:
        raise error.restated(DataError, head="", place=(), complaint=f"{path}: {error.complaint}") from None
    size = f"volume {1e6 * cavity.volume:.4g} cm^3, the largest sphere inside has {amount(cavity.widest, 'm')}"
    lines = [cavity.words(), size]
    with suppress(DataError):  # without groups
        lines.append(f"groups: {', '.join(Mesh(file=str(path), groups=FROM_FILE, **options).walls().labels)}")
        options["groups"] = FROM_FILE
    notes = (
        [] if states_unit else [f"assumed: unit = {_ASSUMED_LENGTH!r}, since the file states none: set the right one"]
    )
    fields = {"kind": "mesh", "file": given, **options}
    python = "".join(f", {key}={_python(value)}" for key, value in options.items())
    return FileContents(
        given,
        "a closed surface, as a cavity",
        tuple(lines),
        (*notes, *surface_notes(cavity)),
        "\n".join(["[damper.cavity]", *(f"{key} = {_toml(value)}" for key, value in fields.items())]),
        f"rb.Mesh(file={json.dumps(given, ensure_ascii=False)}{python})",
    )


def _matrices(path: Path, given: str) -> FileContents | None:
    """Return the preview of a file with M and K; None for other files."""
    if path.suffix.lower() == ".mtx":
        raise DataError(
            f"{path} is one matrix; M and K are needed", 'rb.Matrices.from_file({"M": "M.mtx", "K": "K.mtx"})'
        )
    if path.suffix.lower() not in (".npz", ".mat"):
        return None
    arrays = read_arrays(path)
    if not {"M", "K"} <= arrays.keys():
        return None
    size = arrays["M"].shape
    if arrays["K"].shape != size or len(size) != 2 or size[0] != size[1] or size[0] < 2:
        return None
    options: dict[str, Any] = {}
    assumed = []
    if not any(name.startswith(("point_", "points.")) for name in arrays):
        options["points"] = {"first": 0}
        assumed.append("assumed: a point at the first degree of freedom; set those you need")
    structure = Matrices.from_file(str(path), **options)
    modes = structure.modes()
    lines = _lines_of_structure(np.sqrt(modes.stiffness) / (2 * np.pi), list(modes.shapes))
    if modes.participation is not None:
        assumed.append("assumed: a moving base moves all degrees of freedom by the same; influence sets another")
        lines += _table_of_masses(structure)
    return _structure(given, "matrices of a structure", structure, lines, assumed, options)


def _lines_of_structure(frequencies: Sequence[float] | Vector, points: list[str]) -> list[str]:
    shown = ", ".join(f"{frequency:.5g}" for frequency in frequencies[:_LISTED])
    return [
        f"{several(len(frequencies), 'mode')}: {shown}{', ...' if len(frequencies) > _LISTED else ''} Hz",
        f"{several(len(points), 'point')}: {', '.join(points[:_LISTED])}{', ...' if len(points) > _LISTED else ''}",
    ]


def _table_of_masses(structure: StructurePart) -> list[str]:
    return ["effective masses:", *(f"  {line}" for line in str(effective_masses(structure)).splitlines())]


def _structure(
    given: str, content: str, structure: Modal | Matrices, lines: list[str], assumed: list[str], options: dict[str, Any]
) -> FileContents:
    fields = {"file": given, **options}
    toml = ["[structure]", f'kind = "{structure.kind}"', *(f"{key} = {_toml(value)}" for key, value in fields.items())]
    python = "".join(f", {key}={_python(value)}" for key, value in options.items())
    return FileContents(
        given,
        content,
        tuple(lines),
        (*assumed, *structure.notes()),
        "\n".join(toml),
        f"rb.{type(structure).__name__}.from_file({json.dumps(given, ensure_ascii=False)}{python})",
    )


def _options_of_modes(modes: ModesInFile | Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Return what a user must state beside the file, and notes of what is assumed in its place."""
    options: dict[str, Any] = {}
    assumed: list[str] = []
    table = modes if isinstance(modes, Mapping) else vars(modes)  # a TOML file has names of the same meaning
    if table.get("damping_ratios") is None:
        options["damping_ratio"] = _ASSUMED_DAMPING
        assumed.append(f"assumed: damping_ratio = {_ASSUMED_DAMPING}, since the file states no damping")
    if unfit := table.get("unfit"):
        count = len(table["frequencies"])
        options["mode_numbers"] = tuple(number for number in range(1, count + 1) if number not in unfit)
        assumed.append(f"modes are left out: {'; '.join(f'{number}: {reason}' for number, reason in unfit.items())}")
    shapes = table["shapes"]
    if len(shapes) > MOST_POINTS and not isinstance(modes, Mapping):
        point = max(shapes, key=lambda label: float(np.abs(shapes[label][0]).max()))
        options["points"] = {f"point {point}": point}
        assumed.append(
            f"assumed: the one of {len(shapes)} points that moves most in the first mode; set those you need"
        )
    return options, assumed


def _toml(value: object) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(key)} = {_toml(item)}" for key, item in value.items()) + " }"
    return json.dumps(list(value) if isinstance(value, tuple) else value, ensure_ascii=False)


def _python(value: object) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(_toml(item) for item in value)}{',' if len(value) == 1 else ''})"
    return repr(value) if isinstance(value, dict) else _toml(value)
