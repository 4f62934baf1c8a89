"""The file of computed runs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .runs import Run

DATA = Path(__file__).with_name("runs.npz")
STOPS_DATA = DATA.with_name("stops.npz")
CLOSED = DATA.with_name("closed_forms.npz")
KEPT_BITS = 40
"""Bits of the fraction of a derivative that are stored: a relative error of 5e-13."""


class Stored(NamedTuple):
    """A run, the paths of its parameters, and what the program computed."""

    run: Run
    paths: list[str]
    state: NDArray[np.float64]
    derivatives: NDArray[np.float64]
    touches: list[tuple[int, int, float, float, float]]


def rounded(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return numbers without the last bits of their fraction."""
    spare = 52 - KEPT_BITS
    bits = values.view(np.uint64) + np.uint64(1 << (spare - 1))
    return (bits & ~np.uint64((1 << spare) - 1)).view(np.float64)


def _by_bytes(values: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return the bytes of numbers, all first bytes first: exponents compress, fractions do not."""
    return np.ascontiguousarray(values.astype("<f8").view(np.uint8).reshape(-1, 8).T)


def _numbers(raw: NDArray[np.uint8]) -> NDArray[np.float64]:
    return np.ascontiguousarray(raw.T).view("<f8").ravel().astype(float)


def write(path: Path, about: dict[str, Any], runs: list[Stored]) -> None:
    """Write runs to a file."""
    text = json.dumps({"about": about, "runs": [{"run": each.run, "paths": each.paths} for each in runs]})
    np.savez_compressed(
        path,
        text=np.frombuffer(text.encode(), np.uint8),
        states=_by_bytes(np.concatenate([each.state for each in runs])),
        derivatives=_by_bytes(rounded(np.concatenate([each.derivatives.ravel() for each in runs]))),
        touches=_by_bytes(np.concatenate([np.ravel(each.touches) for each in runs])),
        counts=np.array([[e.state.size, e.derivatives.shape[1], len(e.touches)] for e in runs], np.int16),
    )


def read(path: Path = DATA) -> tuple[dict[str, Any], list[Stored]]:
    """Return what is known about the file, and its runs."""
    with np.load(path) as file:
        text = json.loads(file["text"].tobytes().decode())
        states, derivatives, touches = (_numbers(file[name]) for name in ("states", "derivatives", "touches"))
        counts = file["counts"].astype(int)
    runs = []
    for entry, (n, columns, contacts) in zip(text["runs"], counts, strict=True):
        state, states = states[:n], states[n:]
        matrix, derivatives = derivatives[: n * columns].reshape(n, columns), derivatives[n * columns :]
        rows, touches = touches[: 5 * contacts].reshape(-1, 5).tolist(), touches[5 * contacts :]
        log = [(int(row[0]), int(row[1]), row[2], row[3], row[4]) for row in rows]
        runs.append(Stored(entry["run"], entry["paths"], state, matrix, log))
    return text["about"], runs
