"""Description of the case of a study, with digests of the files that it names."""

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

_LENGTH = 12
"""Number of characters of a digest."""


def describe_case(case: Case, columns: Mapping[str, Any]) -> dict[str, Any]:
    """Return a case in JSON types, with digests of the files that it or its variants name."""
    files = {path: _digest_of_numbers(part) for path, part in _parts_from_files(case)}
    for path, values in columns.items():
        holder, _, name = path.rpartition(".")
        if name == "file":
            files |= {f"{path} = {file}": _digest_of_file(file) for file in sorted(set(np.ravel(values).tolist()))}
        elif name == "columns" and (file := getattr(get(case, holder), "file", None)):
            files[f"{holder}.file"] = _digest_of_file(file)
    return {"case": case.to_toml(), **({"files": files} if files else {})}


def _parts_from_files(case: Case) -> Iterator[tuple[str, Part]]:
    """Yield the parts whose numbers come from files, with the path of the file."""
    for path in all_paths(case):
        value = get(case, path)
        for number, part in enumerate(value if isinstance(value, tuple) else (value,)):
            if isinstance(part, Part) and part.file_fields and getattr(part, "file", None) is not None:
                yield (f"{path}[{number}].file" if isinstance(value, tuple) else f"{path}.file"), part


def _digest_of_numbers(part: Part) -> str:
    digest = sha256()
    for name in part.file_fields:
        value = getattr(part, name)
        if isinstance(value, dict):
            value = [row for point in sorted(value) for row in np.ravel(value[point])]
        if value is not None:
            numbers = np.ascontiguousarray(np.asarray(value, dtype=float))
            digest.update(f"{name} {numbers.shape}".encode() + numbers.tobytes())
    return digest.hexdigest()[:_LENGTH]


def _digest_of_file(file: str) -> str:
    return sha256(Path(file).read_bytes()).hexdigest()[:_LENGTH]
