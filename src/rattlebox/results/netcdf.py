"""Runs in netCDF-4 files, restricted to features that every netCDF reader supports.

Numbers are double, 32-bit integer or byte; texts are arrays of characters (UTF-8), not variable-length
strings; attributes are plain characters. The file has a group for each dataset of the run, and the groups `counts`,
`diagnostics` and `end`, the state from which another run continues. The root group holds the engine, the case, the
status, the message, the notes and the provenance.
Dimensions of length zero are omitted together with their variables, except `impact`, which is unlimited.

The groups are not written by xarray, which takes as long (0.27 s instead of 0.28 s for 10 s of the reference case), but
writes texts of variable length, and no digests, by which damage is found.
"""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Collection, Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.atomic_io import (
    HDF5_ERRORS,
    atomic_write,
    check_format,
    check_suffix,
    require_folder,
    require_readable,
)
from rattlebox._util.digests import group_digest
from rattlebox._util.exceptions import DataError
from rattlebox._util.own_files import register_format

from .arrays import RunArrays
from .datasets import Labels, labelled_parts
from .provenance import Provenance
from .run_end import RunEnd, arrays_from
from .schema import COUNTS, DIAGNOSTICS, Engine, Kind, groups, variables
from .snapshots import ROOT as SNAPSHOTS

if TYPE_CHECKING:
    from .record import Record

Read = TypeVar("Read")
Node = Any
"""File or group of h5netcdf or h5py, which have no types."""

FORMAT = 3
"""Version of the layout; files of other versions are rejected, but for the older ones that are read, too."""
OLDER = (2,)
"""Versions in which variables of 1-D runs lacked the dimensions `axis` and `partner`."""

_DAMAGE_HINT = "a copy of the file, or run the case again"
_DISK_HINT = "free disk space and save the run again"

_STORED: dict[Kind, str] = {"float": "f8", "int": "i4", "bool": "i1"}
_NAMES = {
    "point": "points",
    "ball": "balls",
    "damper": "dampers",
    "source": "loads",
    "stop": "stops",
    "wall": "walls",
}
"""Argument of `RunArrays` with the labels of a dimension."""
_LARGE: dict[str, Any] = {"compression": "gzip", "compression_opts": 4, "shuffle": True, "fletcher32": True}
"""Filters of arrays of more than 64 numbers; Fletcher-32 is a checksum, which HDF5 verifies when it reads them."""


def _characters(texts: tuple[str, ...]) -> NDArray[np.bytes_]:
    """Return an array of single UTF-8 bytes, one row per text, padded with zeros."""
    encoded = np.array([text.encode() for text in texts])
    return np.asarray(encoded.view("S1").reshape(len(texts), -1))


def _texts(characters: NDArray[np.bytes_]) -> tuple[str, ...]:
    rows = np.ascontiguousarray(characters)
    return tuple(row.tobytes().rstrip(b"\0").decode() for row in rows)


def _attribute(text: str) -> np.bytes_:
    """Return fixed-length characters: older readers do not support variable-length strings."""
    return np.bytes_(text.encode() or b" ")


def _describe(target: Node, **attributes: str) -> None:
    for name, text in attributes.items():
        target.attrs[name] = _attribute(text)


def _filters(data: NDArray[Any]) -> dict[str, Any]:
    return _LARGE if data.size > 64 else {}


def _write_text(group: Node, name: str, text: str, long_name: str) -> None:
    if not text:
        return
    characters = np.frombuffer(text.encode(), "S1")
    group.dimensions[f"{name}_length"] = characters.size
    variable = group.create_variable(name, (f"{name}_length",), "S1", data=characters, **_filters(characters))
    _describe(variable, long_name=long_name, _Encoding="utf-8")


def _write_coordinate(group: Node, dim: str, values: Labels, units: str, long_name: str) -> None:
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


def _write_numbers(
    file: Node, group: str, numbers: Mapping[str, float], meanings: Mapping[str, tuple[str, str]]
) -> None:
    """Write single numbers, integers or floats, with their units and long names."""
    if not numbers:
        return
    target = file.create_group(group)
    for name, number in numbers.items():
        whole = isinstance(number, int)
        variable = target.create_variable(name, (), "i8" if whole else "f8", data=np.asarray(number))
        units, long_name = meanings.get(name, ("1", name))
        _describe(variable, long_name=long_name, units=units)


def _write_group(file: Node, run: Record, name: str) -> None:
    """Write a dataset of the run with its coordinates."""
    group = groups(run.arrays.engine)[name]
    target = file.create_group(name)
    _describe(target, title=group.title)
    # A dimension of length zero would be an unlimited one in netCDF.
    for v, values, labels in labelled_parts(run, name, empty=False):
        for dim, names in labels:
            _write_coordinate(target, dim.name, names, dim.units, dim.long_name)
        grows = group.along not in run.arrays.labels
        if grows and group.along not in target.dimensions:
            target.dimensions[group.along] = None
            target.resize_dimension(group.along, len(values))
        # HDF5 needs chunks for a dimension that can grow, such as the number of impacts.
        chunks = {"chunks": (max(values.size, 1),)} if grows else {}
        variable = target.create_variable(v.name, v.dims, _STORED[v.kind], **chunks, **_filters(values))
        if values.size:
            variable[...] = values
        _describe(variable, units=v.units, long_name=v.long_name)


def _write_end(file: Node, end: RunEnd) -> None:
    """Write the state from which another run can continue."""
    group = file.create_group("end")
    texts = {name: getattr(end, name) for name in ("numbers", "version", "core", "obstacle")}
    _describe(group, title="State at the end, from which another run continues", **texts)
    group.attrs["time"] = np.float64(end.time)
    if end.arrays is None:
        return
    content = end.to_bytes().view(np.int8)
    group.dimensions["byte"] = content.size
    variable = group.create_variable("state", ("byte",), "i1", data=content, **_filters(content))
    _describe(variable, long_name="state of the engine", units="1")


def _write(run: Record, target: IO[bytes]) -> None:
    import h5netcdf  # type: ignore[import-untyped]

    # Since version 1.10 HDF5 also has checksums of its metadata, and smaller files.
    with h5netcdf.File(target, "w", invalid_netcdf=False, libver="v110") as file:
        _describe(file, title="Rattlebox run", engine=run.arrays.engine, status=run.status)
        file.attrs["rattlebox_format"] = np.int32(FORMAT)
        for name, value in asdict(run.provenance).items():
            file.attrs[name] = np.int64(value) if isinstance(value, int) else _attribute(value)
        file.attrs["wall_time"] = np.float64(run.wall_time)
        _write_text(file, "case", run.case_toml, "case that was run, as the text of a case file")
        _write_text(file, "message", run.message, "explanation of the status and advice")
        _write_text(file, "notes", "\n".join(run.notes), "warnings, and what limits the step where there is one")
        units = {name: ("byte" if name == "memory_bytes" else "1", meaning) for name, meaning in COUNTS.items()}
        _write_numbers(file, "counts", run.counts, units)
        _write_numbers(file, "diagnostics", run.diagnostics, DIAGNOSTICS)
        for group in run.groups:
            _write_group(file, run, group)
        if run.end is not None:
            _write_end(file, run.end)


def save(run: Record, path: Path, *, replace: bool = True) -> Path:
    """Write a run to a netCDF-4 file; the new file replaces an existing one when it is complete."""
    check_suffix(path, ".nc")
    require_folder(path)
    # HDF5 crashes the process if it cannot flush its buffers to a full disk, so it writes to memory.
    content = io.BytesIO()
    _write(run, content)
    _add_digests(content)
    with atomic_write(path, _DISK_HINT, replace=None if replace else False) as name:
        name.write_bytes(content.getbuffer())
    return path


def _text_attribute(value: object) -> str:
    # Fixed-length characters have no encoding, so h5netcdf returns non-ASCII bytes escaped.
    raw = value if isinstance(value, bytes) else str(value).encode("ascii", "surrogateescape")
    return "" if raw == b" " else raw.decode()


def read(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Read the data of a run from a file that `save` wrote."""
    return _read_file(Path(path), _read_run)


def read_case(path: str | os.PathLike[str]) -> str:
    """Read only the case from a file that `Run.save` wrote."""
    return _read_file(Path(path), lambda file: _read_text(file, "case"), blocks=("/",))


def _is_run(path: Path) -> bool:
    """Return whether a file is a run of Rattlebox, whose case can be read."""
    try:
        read_case(path)
    except DataError:
        return False
    return True


register_format(".nc", _is_run)


def _add_digests(content: IO[bytes]) -> None:
    """Add the digest of variables and attributes to each group of a file."""
    import h5py  # type: ignore[import-untyped]

    with h5py.File(content, "r+", libver="v110") as file:
        for group in _groups(file).values():
            group.attrs["digest"] = np.bytes_(group_digest(group, nested=False))


def _groups(file: Node) -> dict[str, Node]:
    """Return the root group and its subgroups by name."""
    return {"/": file} | {name: item for name, item in sorted(file.items()) if not hasattr(item, "shape")}


def _read_file(path: Path, read: Callable[[Node], Read], blocks: Collection[str] | None = None) -> Read:
    """Check format and digests of some groups (default all) of a file, and read from it."""
    import h5netcdf
    import h5py

    require_readable(path)
    try:
        with h5py.File(path, "r") as file:
            _check(file, path, blocks)
        with h5netcdf.File(path, "r") as file:
            return read(file)
    except DataError:
        raise
    except HDF5_ERRORS as error:
        raise DataError(f"{path} is not an intact netCDF-4 file", _DAMAGE_HINT) from error


def _check(file: Node, path: Path, blocks: Collection[str] | None) -> None:
    """Raise if a file holds no run, a run of another format, or a damaged group."""
    layout = file.attrs.get("rattlebox_format")
    if layout is None and "study" in file.attrs:
        raise DataError(f"{path} holds the result of a study, not a run", "rb.open_study, or 'rattlebox report'")
    if layout is None:
        raise DataError(
            f"{path} is a netCDF-4 file, but not a run written by Rattlebox", "run.nc, or xarray.open_dataset"
        )
    if SNAPSHOTS in file:
        raise DataError(f"{path} holds snapshots of particles, not a run", "rattlebox.Snapshots, which reads them")
    check_format(path, np.asarray(layout).item(), FORMAT, OLDER)
    for name, group in _groups(file).items():
        if blocks is not None and name not in blocks:
            continue
        if group.attrs.get("digest") != np.bytes_(group_digest(group, nested=False)):
            raise DataError(f"{path} is damaged: the group {name!r} has changed", _DAMAGE_HINT)


def _read_run(file: Node) -> dict[str, Any]:
    texts: dict[str, Any] = {
        f.name: _text_attribute(file.attrs[f.name]) for f in fields(Provenance) if f.name in file.attrs
    }
    return {
        "arrays": _read_arrays(file),
        "source": _read_text(file, "case"),
        "provenance": Provenance(**texts | {"seed": int(file.attrs["seed"])}),
        "status": _text_attribute(file.attrs["status"]),
        "message": _read_text(file, "message"),
        "notes": tuple(_read_text(file, "notes").split("\n")) if "notes" in file.variables else (),
        "counts": {name: int(number) for name, number in _read_numbers(file, "counts").items()},
        "diagnostics": _read_numbers(file, "diagnostics"),
        "wall_time": float(file.attrs["wall_time"]),
        "end": _read_end(file.groups["end"]) if "end" in file.groups else None,
    }


def _read_end(group: Node) -> RunEnd:
    texts = {name: _text_attribute(group.attrs[name]) for name in ("numbers", "version", "core", "obstacle")}
    arrays = arrays_from(group.variables["state"][...].view(np.uint8)) if "state" in group.variables else None
    return RunEnd(float(group.attrs["time"]), arrays=arrays, **texts)


def _read_text(file: Node, name: str) -> str:
    return file.variables[name][...].tobytes().decode() if name in file.variables else ""


def _read_numbers(file: Node, group: str) -> dict[str, Any]:
    variables = file.groups[group].variables if group in file.groups else {}
    return {name: variable[...].item() for name, variable in variables.items()}


def _read_arrays(file: Node) -> RunArrays:
    engine = cast("Engine", _text_attribute(file.attrs["engine"]))
    arguments: dict[str, Any] = {"engine": engine, "time": file.groups["motion"].variables["time"][...]}
    for name, group in groups(engine).items():
        stored = file.groups[name].variables
        read = [v for v in variables(engine, name) if v.name in stored and not v.derived]
        values = {v.name: _without(stored[v.name], v.dims) for v in read}
        if group.along == "time":
            arguments |= values
            if engine == "impact" and "axis" in stored:
                (arguments["line"],) = _texts(stored["axis"][...])
            arguments |= {names: _texts(stored[dim][...]) for dim, names in _NAMES.items() if dim in stored}
        else:
            arguments[name] = values
    return RunArrays(**arguments)


def _without(stored: Node, dims: Collection[str]) -> NDArray[Any]:
    """Return the values of a stored variable without the dimensions, of length one, that the arrays of a run lack."""
    single = tuple(place for place, dim in enumerate(stored.dimensions) if dim not in dims)
    return np.asarray(np.squeeze(stored[...], axis=single))
