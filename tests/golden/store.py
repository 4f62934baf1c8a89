"""Stored golden results: how they are written, read and compared.

Each case has one file in `data`. Its `values` are physical quantities up to the tenth impact or step 200; its `bits` are
digests of all quantities, for each instruction set, with the compiler and the libraries that they depend on. The folder
`data/statistics` holds means over ensembles.
"""

from __future__ import annotations

import hashlib
import json
import platform
import re
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .quantities import KINDS, Quantities, core_file, predictable

DATA = Path(__file__).parent / "data"
TOLERANCE = 1e-11
"""Largest difference of values, relative to the largest of their kind in the run; KINDS says what is of one kind."""

Stored = dict[str, Any]


def path_of(name: str, folder: Path = DATA) -> Path:
    """Return the file in which the results of a case or of an ensemble are stored."""
    return folder / (re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_") + ".json")


def read(name: str, folder: Path = DATA) -> Stored:
    """Return the stored results of a case or of an ensemble; empty when there are none."""
    path = path_of(name, folder)
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def write(name: str, stored: Mapping[str, Mapping[str, Any]], folder: Path = DATA) -> None:
    """Write the results of a case or of an ensemble, one line for each quantity."""
    parts = []
    for part in stored:
        lines = [f"  {json.dumps(key)}: {json.dumps(value)}" for key, value in stored[part].items()]
        parts.append(f"{json.dumps(part)}: {{\n" + ",\n".join(lines) + "\n}")
    path = path_of(name, folder)
    path.parent.mkdir(exist_ok=True)
    path.write_text("{" + ",\n".join(parts) + "}\n", encoding="utf-8")


# ---- bits


def digests(found: Mapping[str, NDArray[Any]]) -> dict[str, str]:
    """Return a digest of all bits of each quantity, whatever the width of integers."""
    return {name: _digest(array) for name, array in found.items()}


def _digest(array: NDArray[Any]) -> str:
    kind = {"f": "<f8", "i": "<i8", "u": "<i8", "b": "<i8"}.get(array.dtype.kind)
    content = str(array).encode() if kind is None else np.ascontiguousarray(array, kind).tobytes()
    return hashlib.sha256(f"{array.shape}".encode() + content).hexdigest()[:12]


def made_with(level: str) -> str:
    """Return the compiler of an instruction set's core, and the versions of the libraries on which last bits depend."""
    compiler = re.search(rb"GCC: \([^)]*\) [\d.]+|clang version [\d.]+", Path(core_file(level)).read_bytes())
    name = compiler.group().decode() if compiler else "unknown compiler"
    return f"{name}, {' '.join(platform.libc_ver())}, numpy {version('numpy')}"


# ---- values


def values(found: Mapping[str, NDArray[Any]], impacts: int) -> dict[str, Any]:
    """Return the quantities up to some number of impacts as lists."""
    return {name: array.tolist() for name, array in predictable(found, impacts).items()}


class Deviation(NamedTuple):
    """How far the values of one quantity are from the stored ones.

    Attributes
    ----------
    quantity
        Name.
    size
        Largest difference, relative to the largest of its kind; infinite when they cannot be compared.
    text
        The same in words.
    """

    quantity: str
    size: float
    text: str


def deviations(wanted: Mapping[str, Any], found: Mapping[str, NDArray[Any]], impacts: int) -> list[Deviation]:
    """Return how far values are from stored ones, for each quantity that is not the same to the last bit."""
    now = predictable(found, impacts)
    scales = {name: _largest(wanted[name]) for name in wanted if name != "status"}
    results = [
        Deviation(name, np.inf, f"{name} is {'no longer computed' if name in wanted else 'not stored'}")
        for name in wanted.keys() ^ now.keys()
    ]
    for name in wanted.keys() & now.keys():
        alike = next((names for names in KINDS if name in names), (name,))
        scale = max((scales[other] for other in alike if other in scales), default=0.0)
        size = _deviation(np.asarray(wanted[name]), now[name], scale)
        if size > 0:
            results.append(Deviation(name, size, _text(name, size, wanted[name], now[name])))
    return sorted(results, key=lambda deviation: -deviation.size)


def _largest(wanted: Any) -> float:
    array = np.asarray(wanted, dtype=float)
    return float(np.max(np.abs(array[np.isfinite(array)]), initial=0.0))


def _deviation(wanted: NDArray[Any], found: NDArray[Any], scale: float) -> float:
    if wanted.size == found.size == 0:
        return 0.0
    if wanted.shape != found.shape:
        return np.inf
    if found.dtype.kind != "f":
        return 0.0 if np.array_equal(wanted, found) else np.inf
    both = np.isfinite(wanted) & np.isfinite(found)
    if not np.array_equal(wanted[~both], found[~both], equal_nan=True):
        return np.inf
    difference = np.max(np.abs(wanted[both] - found[both]), initial=0.0)
    return float(difference / scale) if scale else (0.0 if difference == 0 else np.inf)


def _text(name: str, size: float, wanted: Any, found: NDArray[Any]) -> str:
    if np.isfinite(size):
        return f"{name} differs by {size:.1e}"
    if np.shape(wanted) != found.shape:
        return f"{name} has shape {found.shape} instead of {np.shape(wanted)}"
    return f"{name} differs: {str(found.tolist())[:60]} instead of {str(wanted)[:60]}"


# ---- statistics


def statistics(members: Sequence[Mapping[str, float]]) -> dict[str, dict[str, float]]:
    """Return the mean of each measure over an ensemble, with half of its 95 % interval."""
    from scipy.stats import t

    results = {}
    for name in members[0]:
        sample = np.array([member[name] for member in members])
        half = float(t.ppf(0.975, sample.size - 1) * sample.std(ddof=1) / np.sqrt(sample.size))
        results[name] = {"mean": float(sample.mean()), "half_width": half, "runs": sample.size}
    return results


def apart(wanted: Mapping[str, Any], found: Mapping[str, Any]) -> list[str]:
    """Return in words which measures have 95 % intervals that do not overlap."""
    texts = [f"{name} is stored or computed, not both" for name in sorted(wanted.keys() ^ found.keys())]
    for name in sorted(wanted.keys() & found.keys()):
        old, new = wanted[name], found[name]
        if abs(new["mean"] - old["mean"]) > old["half_width"] + new["half_width"]:
            texts.append(f"{name}: {_interval(new)} instead of {_interval(old)}")
    return texts


def _interval(statistic: Mapping[str, float]) -> str:
    return f"{statistic['mean']:.6g} ± {statistic['half_width']:.2g}"


def complete(found: Mapping[str, Quantities]) -> Mapping[str, Quantities]:
    """Raise if a run did not reach its end; return the runs."""
    for name, each in found.items():
        if str(each["status"]) != "finished":
            raise RuntimeError(f"{name} ended with the status {each['status']}")
    return found
