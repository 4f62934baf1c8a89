"""State at the end of a run, from which another run continues, as bytes and arrays."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

LARGEST = 200_000_000
"""Largest state that a run keeps [bytes]; longer particle runs have checkpoints."""


@dataclass(frozen=True, eq=False)
class RunEnd:
    """State at the end of a run, from which another run continues.

    Attributes
    ----------
    time
        Time of the state [s].
    numbers
        Digest of the input of the core, without the end and the samples of the run.
    version, core
        Version of Rattlebox and instructions of the core that wrote the state.
    arrays : dict of str to array
        State of the engine.
    obstacle
        Reason why no run can continue from here; empty if one can.
    """

    time: float
    numbers: str = ""
    version: str = ""
    core: str = ""
    arrays: Mapping[str, NDArray[Any]] | None = None
    obstacle: str = ""

    def to_bytes(self) -> NDArray[np.uint8]:
        """Return names and arrays one after the other, in the format of NumPy."""
        stream = io.BytesIO()
        arrays = {"names": np.array(list(self.arrays or {}), np.str_), **(self.arrays or {})}
        for array in arrays.values():
            np.lib.format.write_array(stream, np.asarray(array, order="C"), allow_pickle=False)
        return np.frombuffer(stream.getvalue(), np.uint8)


def arrays_from(content: NDArray[np.uint8]) -> dict[str, NDArray[Any]]:
    """Return the arrays that `RunEnd.to_bytes` wrote."""
    stream = io.BytesIO(content.tobytes())
    names = np.lib.format.read_array(stream, allow_pickle=False)
    return {str(name): np.lib.format.read_array(stream, allow_pickle=False) for name in names}
