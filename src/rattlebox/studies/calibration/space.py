"""Ranges of the parameters of a calibration."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.model.errors import Hint, at, nearest
from rattlebox.studies.calibration.measurements import read_column
from rattlebox.studies.calibration.response_surface import Known
from rattlebox.studies.grid.axes import materials_in
from rattlebox.studies.grid.parameter import Parameter

if TYPE_CHECKING:
    from rattlebox.model.case import Case

FloatArray = NDArray[np.float64]

NORMAL = 1.959964
"""Half of the width of a 95 % interval over the standard deviation."""
_MOST = 3
"""Largest number of parameters."""


@dataclass(frozen=True, eq=False)
class Space:
    """Ranges of parameters. Points in it are in units of the ranges: 0 for the smallest, 1 for the largest value.

    Attributes
    ----------
    low, high : (d,) float
        Smallest and largest values.
    is_log : (d,) bool
        Whether a range is logarithmic.
    """

    paths: list[str]
    units: list[str]
    low: FloatArray
    high: FloatArray
    is_log: NDArray[np.bool_]
    known: dict[str, tuple[float, float]]

    @classmethod
    def of(cls, case: Case, parameters: Any, log: Any, known: Any) -> Space:
        """Return the ranges of a call."""
        if not isinstance(parameters, Mapping) or not parameters:
            example = '{"damper.contact.restitution": (0.5, 0.95)}'
            raise Hint("a mapping of paths to pairs (smallest, largest) is required", example, ["parameters"])
        if len(parameters) > _MOST:
            advice = "the others measured on their own, such as the restitution by rb.Drops"
            raise Hint(f"{len(parameters)} parameters are too many, at most {_MOST}", advice, ["parameters"])
        logs = [log] if isinstance(log, str) else list(log)
        paths, units, ends = [], [], []
        varied: list[Parameter] = []
        for path, given in parameters.items():
            parameter = Parameter(case, path, "parameters", materials_in(case))
            parameter.check_independent(varied)
            varied.append(parameter)
            if not isinstance(given, (tuple, list)) or len(given) != 2:
                raise parameter.wrong("a pair (smallest, largest) is needed", "(0.5, 0.95)", None, given)
            low, high, unit = parameter.ends(*given)
            if parameter.is_whole:
                raise parameter.wrong("a whole number cannot be calibrated", "one call for each value")
            if not low < high or (path in logs and low <= 0):
                least = " and above zero" if path in logs else ""
                raise parameter.wrong(f"the first value must be the smaller one{least}", "", None, given)
            paths.append(path)
            units.append(unit)
            ends.append((low, high))
        for path in logs:
            if path not in paths:
                raise Hint(f"log = {path!r} is not one of the parameters", nearest(str(path), paths))
        low_ends, high_ends = np.array(ends, float).T
        return cls(paths, units, low_ends, high_ends, np.isin(paths, logs), _known(known or {}, paths, units))

    @property
    def size(self) -> int:
        """Number of parameters."""
        return len(self.paths)

    @property
    def corners(self) -> tuple[FloatArray, FloatArray]:
        """The corners of the whole space, zeros and ones."""
        return np.zeros(self.size), np.ones(self.size)

    def values(self, points: FloatArray) -> FloatArray:
        """Return the parameters at points (..., d)."""
        linear = self.low + points * (self.high - self.low)
        if not self.is_log.any():
            return linear
        low, high = (np.where(self.is_log, end, 1.0) for end in (self.low, self.high))
        return np.where(self.is_log, low * (high / low) ** points, linear)

    def points(self, values: FloatArray) -> FloatArray:
        """Return the points (..., d) of parameters."""
        linear = (values - self.low) / (self.high - self.low)
        if not self.is_log.any():
            return linear
        low, high, each = (np.where(self.is_log, end, 2.0) for end in (self.low, self.high, values))
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(self.is_log, np.log(each / np.where(self.is_log, low, 1.0)) / np.log(high / low), linear)

    def value(self, axis: int, point: Any) -> FloatArray:
        """Return one parameter at its coordinates, of any shape."""
        each = np.asarray(point, dtype=float)
        return np.asarray(self.values(np.repeat(each[..., None], self.size, axis=-1))[..., axis])

    def priors(self, low: FloatArray, high: FloatArray) -> list[Known]:
        """Return the known parameters in units of the region between two corners."""
        found = []
        for path, (value, half) in self.known.items():
            axis = self.paths.index(path)
            ends = np.tile(self.low, (2, 1))
            ends[:, axis] = value - half, value + half
            if self.is_log[axis]:
                ends[0, axis] = max(ends[0, axis], 1e-3 * value)
            first, last = (self.points(ends)[:, axis] - low[axis]) / (high[axis] - low[axis])
            found.append(Known(axis, float(first + last) / 2, float(last - first) / (2 * NORMAL)))
        return found

    def ranges(self, low: FloatArray, high: FloatArray) -> dict[str, tuple[float, float]]:
        """Return the smallest and largest values of the region between two corners, by path."""
        ends = zip(self.paths, self.values(low).tolist(), self.values(high).tolist(), strict=True)
        return {path: (first, last) for path, first, last in ends}


def _known(given: Any, paths: list[str], units: list[str]) -> dict[str, tuple[float, float]]:
    """Return values and half widths of known parameters in SI units."""
    example = '{"damper.contact.restitution": (0.80, 0.02)}'
    if not isinstance(given, Mapping):
        raise Hint(
            "a mapping of paths to pairs (value, half of the width of the interval) is needed", example, ["known"]
        )
    found = {}
    for path, pair in given.items():
        with at("known"):
            if path not in paths:
                raise Hint(f"{path!r} is not one of the parameters", nearest(str(path), paths))
            if not isinstance(pair, (tuple, list)) or len(pair) != 2:
                raise Hint(
                    f"{path}: {pair!r:.60} is not a pair (value, half of the width of its 95 % interval)", example
                )
        unit = units[paths.index(path)]
        value, half = read_column(
            ("known", path), list(pair), () if unit == "1" else (unit,), -math.inf
        ).values.tolist()
        if not half > 0:
            raise Hint(f"half of the width, {half:g}, is not greater than zero", example, ["known", path])
        found[path] = value, half
    return found
