"""Files that a case names: paths, TOML, and arrays in NPY, NPZ and MAT files."""

from __future__ import annotations

import io
import os
import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.atomic_io import existing as existing
from rattlebox._util.exceptions import CaseError, DataError, unreadable
from rattlebox._util.mat_check import check_mat
from rattlebox.exchange.read.guarded import arrays_from_child, errors_of

from .errors import Hint
from .units import LARGEST

Array = NDArray[np.float64]
BINARY = (".npy", ".npz", ".mat")
MOST_PARTS = 100
"""Most parts of a key with dots, such as damper.gap; a case needs less than ten."""
_QUOTED = re.compile(r"""\"[^"]*"|'[^']*'""")
_BETWEEN = re.compile(r"[,=\[\]{}]")
_SEVERAL = {"damper": "dampers", "load": "loads", "ball": "balls", "particles": "particles", "base": "base"}
"""Keys of tables that may occur several times, and the keys of the lists."""


def absolute(path: object) -> str:
    """Return an absolute path."""
    if not isinstance(path, (str, os.PathLike)):
        raise Hint("a path must be text", 'file = "push.csv"')
    return os.path.abspath(os.fspath(path))


def read_text(path: str | os.PathLike[str]) -> str:
    """Return the text of a file in TOML."""
    file = existing(path)
    try:
        return file.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise DataError(f"{file}: not text in UTF-8", "a TOML file, saved as UTF-8") from None
    except OSError as error:
        raise unreadable(file, error) from None


def read_toml(content: str, source: str) -> dict[str, Any]:
    """Parse the text of a case file."""
    if _has_long_key(content):  # for which tomllib needs a time that grows with the square of its length
        raise CaseError(f"{source}: a key has more than {MOST_PARTS} parts", "fewer dots in one key")
    try:
        return tomllib.loads(content)
    except (ValueError, RecursionError) as error:  # ValueError: also an integer of thousands of digits
        advice: list[str] = []
        complaint = [f"{source}: not TOML: {error or 'nested too deep'}"]
        place = re.search(r"at line (\d+), column (\d+)", str(error))
        lines = content.rstrip().splitlines()
        is_cut = str(error).endswith("(at end of document)")
        number = len(lines) if is_cut else int(place[1]) if place else 0
        line = lines[number - 1] if 0 < number <= len(lines) else ""
        if line.strip():
            complaint.append("  " + "".join(mark if mark.isprintable() else " " for mark in line[:100]))
        bare = re.match(r"\s*([\w.-]+)\s*=\s*([-+\d.eE_]+\s*[A-Za-z%µ°][^#,\"']*)", line)
        if bare:
            advice.append(f'quotes around a number with a unit: {bare[1]} = "{bare[2].strip()}"')
        comma = re.match(r"\s*([\w.-]+)\s*=\s*([-+]?\d+),(\d+)\s*(?:#|$)", line)
        if comma:
            advice.append(f"a point before decimals: {comma[1]} = {comma[2]}.{comma[3]}")
        if is_cut:
            advice.append(f"the whole file, which seems cut off at line {number}")
        twice = re.search(r"Cannot declare \((.*)\) twice", str(error))
        names = re.findall(r"'([\w-]+)'", twice[1]) if twice else []
        if names and names[0] == "materials":
            advice.append("another name for one of the two materials")
        elif names and names[-1] in _SEVERAL:
            table = ".".join([*names[:-1], _SEVERAL[names[-1]]])
            advice.append(f"double brackets for each of them, [[{table}]]")
        raise CaseError("\n".join(complaint), "; or ".join(advice) or _advice_on_toml(str(error))) from None


def _advice_on_toml(error: str) -> str:
    """Return what to try after an error of the TOML parser without a better known cause."""
    causes = (
        ("overwrite", "one of the two lines"),
        ("twice", "one table with all of these fields"),
        ("nested", "fewer brackets within each other"),
        ("Unclosed", "the bracket that closes the list or table"),
        ("string", "quotes at both ends of the text"),
    )
    return next((advice for word, advice in causes if word in error), 'lines such as name = 1.5 or name = "text"')


def _has_long_key(content: str) -> bool:
    for line in content.split("\n"):
        if line.count(".") > MOST_PARTS:
            bare = _QUOTED.sub("q", line).partition("#")[0]
            if any(part.count(".") > MOST_PARTS for part in _BETWEEN.split(bare)):
                return True
    return False


def read_arrays(file: Path) -> dict[str, Array]:
    """Read all numeric arrays of a NPY, NPZ or MAT file."""
    try:
        with errors_of(file, file.suffix[1:].upper()):
            file.open("rb").close()  # SciPy would hide the reason if this fails
            content = dict(_flatten(_load_mat(file) if file.suffix.lower() == ".mat" else _load_numpy(file)))
    except NotImplementedError:  # version 7.3
        content = arrays_from_child(file, "mat")
        names = content.pop("names").tolist()
        content = dict(zip(names, (content[f"array_{k}"] for k in range(len(names))), strict=True))
    return {name: np.asarray(value, dtype=float) for name, value in content.items() if _is_real(value)}


def _load_numpy(file: Path) -> Mapping[str, Any]:
    with file.open("rb") as stream:  # NumPy leaves a damaged NPZ file open
        loaded = np.load(stream, allow_pickle=False)
        if not isinstance(loaded, np.ndarray):
            with loaded:
                return dict(_without_pickles(loaded))
    return {"": loaded} if loaded.dtype.names is None else {name: loaded[name] for name in loaded.dtype.names}


def _without_pickles(loaded: Any) -> Iterator[tuple[str, Any]]:
    """Yield the arrays of an NPZ file except those of Python objects, which only pickle could read."""
    for name in loaded:
        try:
            yield name, loaded[name]
        except ValueError as error:
            if "Object arrays" not in str(error):
                raise


def _load_mat(file: Path) -> Mapping[str, Any]:
    from scipy.io import loadmat

    content = file.read_bytes()
    check_mat(content)
    stream: Any = io.BytesIO(content)
    variables: Mapping[str, Any] = loadmat(stream, simplify_cells=True)
    return variables


def _flatten(content: Mapping[str, object], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the arrays of nested structs, with their path as name."""
    for name, value in content.items():
        if isinstance(value, Mapping):
            yield from _flatten(value, f"{prefix}{name}.")
        elif not name.startswith("__"):
            yield prefix + name, value.toarray() if hasattr(value, "toarray") else np.asarray(value)


def _is_real(value: NDArray[Any]) -> bool:
    return value.dtype.kind in "fiub"


def check_finite(array: Array, where: str) -> Array:
    """Return the array if all of its numbers are finite and at most `LARGEST`."""
    bad = np.argwhere(~(np.abs(array) <= LARGEST))
    if len(bad):
        place = ", ".join(f"{word} {i + 1}" for word, i in zip(("row", "column"), bad[0], strict=False))
        number = array[tuple(bad[0])]
        raise DataError(
            f"{where} contains {number}{f' in {place}' if place else ''}", f"finite numbers up to {LARGEST:g}"
        )
    return array
