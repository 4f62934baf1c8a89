"""Modes of a file before mass normalisation, and helpers of all readers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import DataError, unreadable

FloatArray = NDArray[np.float64]
_LISTED = 12  # labels in a message
_ZERO = 1e-9  # squared frequency of a rigid-body mode, over the largest of the file
_LARGEST_ROUNDING = 1e-6  # largest negative eigenvalue that is rounding, over the largest of the file


@dataclass(frozen=True, eq=False)
class ModesInFile:
    """Modes of a structure in the units of a file."""

    frequencies: FloatArray  # Natural frequencies [Hz], (m,)
    shapes: dict[str, FloatArray]  # Mode shapes at points, by name or node number; three components at a node
    # Modal masses in the file's unit of mass; None for mass-normalised shapes, (m,)
    modal_masses: FloatArray | None = None
    damping_ratios: FloatArray | None = None  # Damping ratios, if the file states them, (m,)
    # Participation phi^T M r in the file's unit of mass, or in its root for mass-normalised shapes, (m,) or (m, 3)
    participation: FloatArray | None = None
    # Mass that a rigid motion of the base along x, y and z moves, in the file's unit of mass, if the file states it, (3,)
    total_mass: FloatArray | None = None
    mass_unit: float | None = None  # The file's unit of mass [kg]; None if the file does not state it
    # Numbers of modes that cannot be used, from 1 on, and why; they are an error unless others are chosen
    unfit: Mapping[int, str] = field(default_factory=dict)
    notes: tuple[str, ...] = field(default=())

    def chosen(self, numbers: Sequence[int]) -> ModesInFile:
        """Return the modes of these numbers, from 1 on, in this order."""
        rows = np.asarray(numbers, dtype=int) - 1

        def of(array: FloatArray | None) -> FloatArray | None:
            # Another number of values is an error of the file, or those of the chosen modes: the model checks it.
            return array if array is None or len(array) != self.frequencies.size else np.asarray(array)[rows]

        return replace(
            self,
            frequencies=self.frequencies[rows],
            shapes={point: shape[rows] for point, shape in self.shapes.items()},
            modal_masses=of(self.modal_masses),
            damping_ratios=of(self.damping_ratios),
            participation=of(self.participation),
            unfit={k: self.unfit[number] for k, number in enumerate(numbers, start=1) if number in self.unfit},
        )


def without_rounding(squares: FloatArray) -> FloatArray:
    """Return squared frequencies with those of rigid-body modes, which are rounding of either sign, as zero."""
    size = np.abs(squares)
    largest = size.max(initial=0.0)
    # Negative ones show the size of the rounding, unless the structure is unstable.
    negative = -squares.min(initial=0.0)
    limit = max(_ZERO * largest, 10 * negative if negative <= _LARGEST_ROUNDING * largest else 0.0)
    return np.where(size <= limit, 0.0, squares)


def listed(labels: Sequence[str]) -> str:
    """Return the first labels as text for a message."""
    more = f", ... ({len(labels)} in all)" if len(labels) > _LISTED else ""
    return ", ".join(labels[:_LISTED]) + more


def read_start(path: Path, size: int) -> bytes:
    """Return the first bytes of a file."""
    try:
        with path.open("rb") as file:
            start = file.read(size)
    except OSError as error:
        raise unreadable(path, error) from None
    if not start.strip():
        raise DataError(f"{path} is empty", "the complete file, as it was written")
    return start
