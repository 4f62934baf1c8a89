"""netCDF files with the result of a study, such as branches of periodic motions."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.atomic_io import HDF5_ERRORS, atomic_write, check_suffix, require_folder, require_readable
from rattlebox._util.digests import group_digest
from rattlebox._util.exceptions import DataError
from rattlebox._util.flags import type_flags

if TYPE_CHECKING:
    import xarray

_DIGEST = "digest"
"""Attribute with the digest of a file; files that xarray itself wrote have none."""


def write_file(data: xarray.Dataset, path: str | os.PathLike[str], *, replace: bool | None = None) -> Path:
    """Write the result of a study; with `replace`, also over a file that this process has not read."""
    import h5py  # type: ignore[import-untyped]

    file = Path(path)
    check_suffix(file, ".nc")
    require_folder(file)
    # HDF5 crashes the process if it cannot flush its buffers to a full disk, so it writes to memory.
    content = io.BytesIO()
    data.to_netcdf(content, engine="h5netcdf")
    with h5py.File(content, "r+", libver="v110") as stored:
        stored.attrs[_DIGEST] = np.bytes_(group_digest(stored))
    with atomic_write(file, "make room and save the result again", replace=replace) as name:
        name.write_bytes(content.getbuffer())
    return file


def is_result_file(path: str | os.PathLike[str]) -> bool:
    """Return whether a path is a netCDF file with the result of a study."""
    import h5py

    file = Path(path)
    if file.suffix != ".nc" or not file.is_file():
        return False
    try:
        with h5py.File(file, "r") as content:
            return "study" in content.attrs
    except HDF5_ERRORS:
        return False


def read_file(path: str | os.PathLike[str]) -> xarray.Dataset:
    """Read the result of a study."""
    import h5py
    import xarray

    file, advice = Path(path), "another copy of the file, or compute the result again"
    require_readable(file)
    try:
        with h5py.File(file, "r") as stored:
            digest = stored.attrs.get(_DIGEST)
            is_intact = digest is None or digest == np.bytes_(group_digest(stored))
        found: xarray.Dataset = type_flags(xarray.load_dataset(file, engine="h5netcdf"))
    except HDF5_ERRORS as error:
        raise DataError(f"{file} cannot be read: {error!s:.80}", advice) from None
    if not is_intact:
        raise DataError(f"{file} is damaged: its content has changed", advice)
    if "study" not in found.attrs:
        raise DataError(f"{file} is not the result of a study", "a file of Branch.save, or the folder of a study")
    found.attrs.pop(_DIGEST, None)
    return found
