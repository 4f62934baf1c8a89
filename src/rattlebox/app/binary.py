"""Numbers for the browser: a JSON header and arrays of float32 in one body.

Layout: the length of the header in bytes as a little-endian uint32, the header in UTF-8, padded with spaces to a multiple
of 4, and the arrays. The header lists each array by name with its offset in numbers and its shape.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike


def encode(arrays: Mapping[str, ArrayLike], **about: Any) -> bytes:
    """Return arrays and further entries of the header as one body; values beyond float32 become NaN."""
    listed, parts, offset = {}, [], 0
    for name, values in arrays.items():
        with np.errstate(over="ignore"):
            array = np.asarray(values, dtype=np.float64).astype("<f4")
        array[np.isinf(array)] = np.nan
        listed[name] = {"offset": offset, "shape": array.shape}
        parts.append(array.tobytes())
        offset += array.size
    header = json.dumps({"arrays": listed, **about}).encode()
    header += b" " * (-len(header) % 4)
    return b"".join([len(header).to_bytes(4, "little"), header, *parts])


def decode(body: bytes) -> tuple[dict[str, np.ndarray[Any, Any]], dict[str, Any]]:
    """Return the arrays by name and the rest of the header of a body that `encode` made."""
    size = int.from_bytes(body[:4], "little")
    about = json.loads(body[4 : 4 + size])
    data = np.frombuffer(body, "<f4", offset=4 + size)
    arrays = {}
    for name, entry in about.pop("arrays").items():
        count = int(np.prod(entry["shape"]))
        arrays[name] = data[entry["offset"] : entry["offset"] + count].reshape(entry["shape"])
    return arrays, about
