"""The observed motion of a study: of a point, of a point relative to another one, or of a mode."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.errors import Hint, nearest

if TYPE_CHECKING:
    from rattlebox.model.modes import ModalModel

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Observed:
    """A point of the structure, the difference of two points, or a mode."""

    name: str
    lower: str = ""
    mode: int | None = None

    @classmethod
    def of(cls, modes: ModalModel, text: str) -> Observed:
        """Return the quantity that a text names."""
        lines = modes.lines()
        if text in lines:
            return cls(text)
        if number := re.fullmatch(r"mode (\d+)", text):
            mode = int(number[1])
            if not 1 <= mode <= modes.decay.size:
                count = modes.decay.size
                raise Hint(f"there is no {text}", f'"mode 1" to "mode {count}"' if count else "a point", ["point"])
            return cls(text, mode=mode - 1)
        for upper in lines:
            if text.startswith(f"{upper} - ") and (lower := text.removeprefix(f"{upper} - ")) in lines:
                return cls(upper, lower)
        spatial = next((f"{text} {axis}" for axis in "xyz" if f"{text} {axis}" in lines), None)
        advice = nearest(text, lines) if spatial is None else f'point = "{spatial}", since it moves in 3-D'
        raise Hint(f"there is no point {text!r}", f'{advice}; "a - b" for a drift, "mode 1"', ["point"])

    @property
    def moves_with_base(self) -> bool:
        """Whether the absolute motion contains that of the base."""
        return not self.lower and self.mode is None

    def shape(self, points: Mapping[str, FloatArray], modes: int) -> FloatArray:
        """Return the mode shapes, (m, ...), from those of the points."""
        if self.mode is not None:
            unit = np.asarray(np.eye(modes)[self.mode])
            axes = next((shape.ndim for shape in points.values()), 1) - 1
            return np.asarray(unit.reshape(-1, *(1,) * axes))
        return points[self.name] - points[self.lower] if self.lower else points[self.name]

    def column(self, points: Sequence[str], of_points: FloatArray, of_modes: FloatArray) -> FloatArray:
        """Return the motion, (T,), from that of all points (T, P) and modes (T, M)."""
        if self.mode is not None:
            return np.asarray(of_modes[:, self.mode])
        own = of_points[:, points.index(self.name)]
        return np.asarray(own - of_points[:, points.index(self.lower)] if self.lower else own)

    def units(self, units: str) -> str:
        """Return the unit of a measure of this motion."""
        return f"kg^0.5 {units}" if self.mode is not None and units in ("m", "m/s", "m/s^2") else units
