"""Runs in netCDF-4 files, restricted to what every netCDF reader knows.

Numbers are double, 32-bit integer or byte; texts are arrays of characters (UTF-8), not variable-length
strings; attributes are plain characters. Groups: `motion`, `energy` and `impacts` hold the datasets of a run,
`counts` the counters, `figures` the numbers of the step, and the root the case, the message and the provenance.
Dimensions of length zero are left out together with the variables that need them, except `impact`, which is unlimited.
"""

from __future__ import annotations

import io
import os
from collections.abc import Callable
from dataclasses import asdict, fields
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, TypeVar

import numpy as np

from rattlebox._util.atomic_io import HDF5_ERRORS, atomic_write, check_suffix, require_folder, require_readable
from rattlebox._util.exceptions import DataError

from .arrays import ImpactArrays, RunArrays
from .datasets import columns, labels
from .granular import GranularArrays, GranularRun
from .provenance import Provenance
from .schema import COUNTS, FIGURES, GRANULAR, IMPACT, IMPACT_VARIABLES, Form, Kind
from .snapshots import ROOT as SNAPSHOTS

if TYPE_CHECKING:
    from .run import Run

Read = TypeVar("Read")

FORMAT = 1
"""Number of the layout; files with a higher one are refused."""

_LOST = "make room and write the run again"

_STORED: dict[Kind, str] = {"float": "f8", "int": "i4", "bool": "i1"}
_LABELS = ("point", "ball", "damper", "source", "species")
_LARGE: dict[str, Any] = {"compression": "gzip", "compression_opts": 4, "shuffle": True, "fletcher32": True}
"""Of arrays of more than 64 numbers; the last is a checksum, so that damage is told when they are read."""


def _characters(texts: tuple[str, ...]) -> Any:
    """Array of single UTF-8 bytes, one row a text, padded with zeros."""
    encoded = np.array([text.encode() for text in texts])
    return encoded.view("S1").reshape(len(texts), -1)


def _texts(characters: Any) -> tuple[str, ...]:
    rows = np.ascontiguousarray(characters)
    return tuple(row.tobytes().rstrip(b"\0").decode() for row in rows)


def _attribute(text: str) -> np.bytes_:
    """Fixed-length characters: older readers do not know variable-length strings."""
    return np.bytes_(text.encode() or b" ")


def _describe(target: Any, **attributes: str) -> None:
    for name, text in attributes.items():
        target.attrs[name] = _attribute(text)


def _filters(data: Any) -> dict[str, Any]:
    return _LARGE if data.size > 64 else {}


def _write_text(group: Any, name: str, text: str, long_name: str) -> None:
    if not text:
        return
    characters = np.frombuffer(text.encode(), "S1")
    group.dimensions[f"{name}_length"] = characters.size
    variable = group.create_variable(name, (f"{name}_length",), "S1", data=characters, **_filters(characters))
    _describe(variable, long_name=long_name, _Encoding="utf-8")


def _write_coordinate(group: Any, dim: str, values: Any, units: str, long_name: str) -> None:
    group.dimensions[dim] = len(values)
    if isinstance(values, tuple):
        characters = _characters(values)
        group.dimensions[f"{dim}_length"] = characters.shape[1]
        variable = group.create_variable(dim, (dim, f"{dim}_length"), "S1", data=characters)
        _describe(variable, long_name=long_name, _Encoding="utf-8")
        return
    array = np.asarray(values)
    stored = array.astype("i4") if array.dtype.kind == "i" else array
    variable = group.create_variable(dim, (dim,), stored.dtype, data=stored, **_filters(stored))
    _describe(variable, long_name=long_name, units=units)


def _write(run: Run, target: IO[bytes]) -> None:
    import h5netcdf  # type: ignore[import-untyped]

    arrays = run.arrays
    names = labels(arrays)
    # From version 1.10 on HDF5 has checksums of its own entries, too, and takes less room.
    with h5netcdf.File(target, "w", invalid_netcdf=False, libver="v110") as file:
        _describe(file, title="Rattlebox run", status=arrays.status)
        file.attrs["rattlebox_format"] = np.int32(FORMAT)
        for name, value in asdict(run.provenance).items():
            file.attrs[name] = np.int64(value) if isinstance(value, int) else _attribute(value)
        file.attrs["wall_time"] = np.float64(arrays.wall_time)
        _write_text(file, "case", run.case_toml, "case that was run, as the text of a case file")
        _write_text(file, "message", arrays.message, "what the status means and what to try")
        _write_text(file, "notes", "\n".join(arrays.notes), "warnings, and what limits the step where there is one")
        if arrays.counts:
            counts = file.create_group("counts")
            for name, number in arrays.counts.items():
                variable = counts.create_variable(name, (), "i8", data=np.int64(number))
                _describe(variable, long_name=COUNTS.get(name, name), units="byte" if name == "memory_bytes" else "1")
        if isinstance(run, GranularRun):
            file.attrs["rattlebox_kind"] = _attribute(arrays.form.name)
            figures = file.create_group("figures")
            for name, value in run.arrays.figures.items():
                variable = figures.create_variable(name, (), "f8", data=np.float64(value))
                units, long_name = FIGURES.get(name, ("1", name))
                _describe(variable, long_name=long_name, units=units)
        for title in arrays.form.titles:
            group = file.create_group(title)
            _describe(group, title=arrays.form.titles[title])
            values = columns(arrays, run.ledger, title)
            for v in arrays.form.variables(title):
                if any(dim in names and len(names[dim]) == 0 for dim in v.dims):
                    continue
                for dim in v.dims:
                    if dim in group.dimensions:
                        continue
                    if dim == "impact":
                        group.dimensions[dim] = None
                        group.resize_dimension(dim, len(arrays.impacts))
                    else:
                        _write_coordinate(group, dim, names[dim], *arrays.form.coordinates[dim])
                data = values[v.name]
                chunks = {"chunks": (max(data.size, 1),)} if v.dims == ("impact",) else {}
                variable = group.create_variable(v.name, v.dims, _STORED[v.kind], **chunks, **_filters(data))
                if data.size:
                    variable[...] = data
                _describe(variable, units=v.units, long_name=v.long_name)


def save(run: Run, path: Path) -> Path:
    """Write a run to one netCDF-4 file; an existing file is replaced once the new one is complete.

    Parameters
    ----------
    run
        Run to write.
    path
        File to write.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    DataError
        When the file cannot be written, or its name is that of another kind of file.
    ResourceError
        When no space is left on the disk.
    """
    check_suffix(path, ".nc")
    require_folder(path)
    content = io.BytesIO()  # HDF5 cannot be rid of what a full disk does not take, and takes the process with it
    _write(run, content)
    with atomic_write(path, _LOST) as name:
        name.write_bytes(content.getbuffer())
    return path


def _text_attribute(value: Any) -> str:
    # Fixed-length characters carry no encoding, so other bytes than ASCII arrive escaped.
    raw = value if isinstance(value, bytes) else str(value).encode("ascii", "surrogateescape")
    return "" if raw == b" " else raw.decode()


def load(path: str | os.PathLike[str]) -> Run:
    """Read a run from a file that `Run.save` wrote.

    Parameters
    ----------
    path
        netCDF-4 file.

    Returns
    -------
    Run
        Equal to the run that was saved, bit by bit.

    Raises
    ------
    DataError
        When there is no such file, or it cannot be read, is not a run of Rattlebox, is damaged, or has another format.
    """
    return _from(Path(path), _read_run)


def read_case(path: str | os.PathLike[str]) -> str:
    """Read from a file that `Run.save` wrote which case was run, and leave the results where they are.

    Parameters
    ----------
    path
        netCDF-4 file.

    Returns
    -------
    str
        The case, as the text of a case file.

    Raises
    ------
    DataError
        As `load` does.
    """
    return _from(Path(path), lambda file: _read_text(file, "case"))


def _from(path: Path, read: Callable[[Any], Read]) -> Read:
    """What is read from the file of a run; anything else is refused."""
    import h5netcdf

    require_readable(path)
    try:
        with h5netcdf.File(path, "r") as file:
            refused = _refused(file, path)
            if not refused:
                return read(file)
    except HDF5_ERRORS as error:
        raise DataError(f"{path} is not a netCDF-4 file that is whole") from error
    raise DataError(refused)


def _refused(file: Any, path: Path) -> str:
    """Why a netCDF-4 file holds no run that can be read; "" where it does."""
    layout = file.attrs.get("rattlebox_format")
    if layout is None:
        return f"{path} is a netCDF-4 file, but not a run written by Rattlebox"
    if SNAPSHOTS in file.groups:
        return f"{path} holds snapshots of particles, not a run; rattlebox.Snapshots reads them"
    if int(layout) > FORMAT:
        version = _text_attribute(file.attrs.get("version", "?"))
        return f"{path} was written by a later Rattlebox ({version}); update to read it"
    return ""


def _read_run(file: Any) -> Run:
    from .run import Run

    texts: dict[str, Any] = {
        f.name: _text_attribute(file.attrs[f.name]) for f in fields(Provenance) if f.name in file.attrs
    }
    provenance = Provenance(**texts | {"seed": int(file.attrs["seed"])})
    if _text_attribute(file.attrs.get("rattlebox_kind", b" ")) == GRANULAR.name:
        return GranularRun(_read_granular(file), _read_text(file, "case"), provenance)
    return Run(_read(file), _read_text(file, "case"), provenance)


def _read_text(file: Any, name: str) -> str:
    return file.variables[name][...].tobytes().decode() if name in file.variables else ""


def _read_variables(file: Any, form: Form) -> dict[str, Any]:
    """Stored variables but the impacts', names of what they are of, and what is told of the run as a whole."""
    found: dict[str, Any] = {}
    for v in form.stored:
        group = file.groups[v.group]
        if v in IMPACT_VARIABLES:
            continue
        if v.name in group.variables:
            found[v.name] = group.variables[v.name][...]
        for dim in v.dims:
            if dim in _LABELS and dim in group.variables:
                found[form.labels[dim]] = _texts(group.variables[dim][...])
    counts = file.groups["counts"].variables if "counts" in file.groups else {}
    return found | {
        "time": file.groups["motion"].variables["time"][...],
        "status": _text_attribute(file.attrs["status"]),
        "message": _read_text(file, "message"),
        "notes": tuple(_read_text(file, "notes").split("\n")) if "notes" in file.variables else (),
        "counts": {name: int(variable[...]) for name, variable in counts.items()},
        "wall_time": float(file.attrs["wall_time"]),
    }


def _read_granular(file: Any) -> GranularArrays:
    return GranularArrays(
        **_read_variables(file, GRANULAR),
        figures={name: float(variable[...]) for name, variable in file.groups["figures"].variables.items()},
    )


def _read(file: Any) -> RunArrays:
    log = file.groups["impacts"].variables
    impacts = ImpactArrays(
        **{v.name: log[v.name][...].astype(bool) if v.kind == "bool" else log[v.name][...] for v in IMPACT_VARIABLES}
    )
    return RunArrays(**_read_variables(file, IMPACT), impacts=impacts)
