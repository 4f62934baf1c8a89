"""Digests of the content of HDF5 files, which detect a changed bit and do not depend on the layout of the file."""

from __future__ import annotations

import hashlib
from collections.abc import Container, Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

SIZE = 16
"""Length of a digest [bytes]."""

_SCALES = frozenset(
    ("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST", "DIMENSION_LABELS", "_Netcdf4Dimid", "_Netcdf4Coordinates")
)
"""Attributes that netCDF adds when it closes a file. They hold addresses in the file and are not part of the content."""


def array_digest(arrays: Iterable[NDArray[Any]]) -> bytes:
    """Return the digest of types, shapes and bytes of arrays."""
    digest = hashlib.blake2b(digest_size=SIZE)
    for array in arrays:
        _add(digest, array)
    return digest.digest()


def group_digest(group: Any, growing: Container[str] = (), *, nested: bool = True) -> str:
    """Return the digest of all names, attributes, types, shapes and values in a group of an HDF5 file."""
    digest = hashlib.blake2b(digest_size=SIZE)

    def add(path: str, item: Any) -> None:
        digest.update(f"\0{path}\0{type(item).__name__}\0".encode())
        for name in sorted(set(item.attrs) - _SCALES - {"digest"}):
            if f"{path}@{name}" not in growing:
                digest.update(name.encode() + b"\0")
                _add(digest, np.asarray(item.attrs[name]))
        if hasattr(item, "shape"):
            if path in growing:
                digest.update(f"{item.dtype.str}{item.shape}".encode())
            else:
                _add(digest, np.asarray(item[()]))

    add("", group)
    if nested:
        group.visititems(add)
    else:
        digest.update("\0".join(sorted(group)).encode())
        for name in sorted(group):
            if hasattr(group[name], "shape"):
                add(name, group[name])
    return digest.hexdigest()


def _add(digest: Any, array: NDArray[Any]) -> None:
    if array.dtype.kind in "OU":  # the bytes of texts in memory are addresses or padded
        texts = [text if isinstance(text, bytes) else str(text).encode() for text in array.ravel().tolist()]
        digest.update(f"text{array.shape}{[len(text) for text in texts]}".encode())
        for text in texts:
            digest.update(text)
        return
    digest.update(f"{array.dtype.str}{array.shape}".encode())
    digest.update(np.ascontiguousarray(array).tobytes())
