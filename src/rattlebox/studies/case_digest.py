"""What a study is given besides its design: the case, and what the files hold that it names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.model.base import Part
from rattlebox.model.paths import all_paths, get

if TYPE_CHECKING:
    from rattlebox.model.case import Case

_TOLD = 12
"""Letters of a digest, enough to tell one file from another."""


def describe_case(case: Case, columns: Mapping[str, Any]) -> dict[str, Any]:
    """Return a case in JSON's types, and digests of the files that it or its variants name, if there are any.

    Parameters
    ----------
    case
        The case.
    columns
        What varies, by path.
    """
    files = {path: _of_numbers(part) for path, part in _filed(case)}
    for path, values in columns.items():
        holder, _, name = path.rpartition(".")
        if name == "file":
            files |= {f"{path} = {file}": _of_file(file) for file in sorted(set(np.ravel(values).tolist()))}
        elif name == "columns" and (file := getattr(get(case, holder), "file", None)):
            files[f"{holder}.file"] = _of_file(file)
    return {"case": case.to_toml(), **({"files": files} if files else {})}


def _filed(case: Case) -> Iterator[tuple[str, Part]]:
    """Parts whose numbers come from files."""
    for path in all_paths(case):
        found = get(case, path)
        for number, part in enumerate(found if isinstance(found, tuple) else (found,)):
            if isinstance(part, Part) and part.file_fields and getattr(part, "file", None) is not None:
                yield (f"{path}[{number}].file" if isinstance(found, tuple) else f"{path}.file"), part


def _of_numbers(part: Part) -> str:
    digest = sha256()
    for name in part.file_fields:
        value = getattr(part, name)
        if isinstance(value, dict):
            value = [row for point in sorted(value) for row in np.ravel(value[point])]
        if value is not None:
            numbers = np.ascontiguousarray(np.asarray(value, dtype=float))
            digest.update(f"{name} {numbers.shape}".encode() + numbers.tobytes())
    return digest.hexdigest()[:_TOLD]


def _of_file(file: str) -> str:
    return sha256(Path(file).read_bytes()).hexdigest()[:_TOLD]
