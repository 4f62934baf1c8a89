"""Digest of the input of the core."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from rattlebox.core import _core


def fingerprint(packed: _core.Node | Mapping[str, Any]) -> str:
    """Return a digest of every number in the input of the core."""
    digest = hashlib.sha256()

    def add(value: object) -> None:
        if isinstance(value, _core.Node):
            for name in sorted(value.fields()):
                digest.update(name.encode())
                add(getattr(value, name))
        elif isinstance(value, Mapping):
            for name in sorted(value):
                digest.update(name.encode())
                add(value[name])
        elif isinstance(value, (list, tuple)):
            digest.update(b"%d" % len(value))
            for item in value:
                add(item)
        elif isinstance(value, np.ndarray):
            digest.update(f"{value.dtype}{value.shape}".encode())
            digest.update(np.ascontiguousarray(value).tobytes())
        else:
            digest.update(repr(value).encode())

    add(packed)
    return digest.hexdigest()
