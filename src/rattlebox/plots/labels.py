"""Variables of a dataset as a figure shows them: in a fitting unit, named by their attributes."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from matplotlib.ticker import Formatter
from numpy.typing import NDArray

from ..results.quantities import quantity
from .style import label, scaled, shorten

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis

Vector = NDArray[np.float64]

_LETTERS = 16  # of names beside ticks
_EXACT = 2**53  # whole numbers below are written with all their digits


class LabelledValues(NamedTuple):
    """Numbers in a unit with prefix; or places in a list of names.

    Attributes
    ----------
    numbers
        Values over the divisor, or numbers of names.
    divisor, unit
        Of the values; no unit for pure numbers and names.
    text
        What the variable is.
    names
        None for numbers.
    """

    numbers: Vector
    divisor: float
    unit: str
    text: str
    names: list[str] | None

    @classmethod
    def of(cls, values: xr.DataArray) -> LabelledValues:
        """Read values, their `units` and `long_name`."""
        spoken = name_of(values).replace(" V^2", "\N{NO-BREAK SPACE}V²").replace("^2", "²")
        text = spoken[:1].upper() + spoken[1:]
        if values.dtype.kind not in "fiu":
            names = list(dict.fromkeys(map(str, values.values.ravel())))
            places = {name: float(place) for place, name in enumerate(names)}
            numbers = np.array([places[str(value)] for value in values.values.ravel()])
            return cls(numbers.reshape(values.shape), 1.0, "", text, names)
        own = unit_of(values)
        divisor, unit = scaled(values.values, own) if own else (1.0, "")
        return cls(np.asarray(values.values / divisor, dtype=float), divisor, unit.replace("^2", "²"), text, None)

    @property
    def with_unit(self) -> str:
        """The text with its unit, on one line."""
        return f"{self.text} ({self.unit})" if self.unit else self.text

    def along(self, axes: Axes, which: Literal["x", "y"], *, log: bool = False) -> None:
        """Label an axis of a figure, name its ticks, make it logarithmic."""
        axis = axes.xaxis if which == "x" else axes.yaxis
        if log:
            (axes.set_xscale if which == "x" else axes.set_yscale)("log")
            log_ticks(axis)
        if self.names is not None:
            axis.set_ticks(range(len(self.names)), [shorten(name, _LETTERS) for name in self.names])
        label(axes, which, self.text, self.unit)


def log_ticks(axis: Axis) -> None:
    """Write the numbers of a logarithmic axis as one does."""
    axis.set_major_formatter(plain)
    axis.set_minor_formatter(_Between())


class _Between(Formatter):
    """Labels between the powers of ten, the more, the shorter the axis."""

    def __call__(self, value: float, pos: int | None = None) -> str:
        low, high = self.axis.get_view_interval()  # type: ignore[union-attr]
        digit = f"{value:e}"[0]
        return plain(value) if high < 3 * low or (high < 100 * low and digit in "25") else ""


def plain(value: float, _: Any = None) -> str:
    """Write a number of a logarithmic axis as one does: 0.1, 10."""
    return f"{value:g}"


def name_of(values: xr.DataArray) -> str:
    """Return what a variable is called."""
    return str(values.attrs.get("long_name", values.name)).replace("_", " ")


def unit_of(values: xr.DataArray) -> str:
    """Return the SI unit of a variable, "" for pure numbers."""
    unit = str(values.attrs.get("units", ""))
    return "" if unit == "1" else unit


def value_of(coord: xr.DataArray, value: Any) -> str:
    """Write one value of a coordinate with its unit, without zeros behind the last decimal."""
    if coord.dtype.kind not in "fiu":
        return str(value)
    unit = unit_of(coord)
    number = float(value) + 0.0  # no minus before a zero
    if not unit and number.is_integer() and abs(number) < _EXACT:
        return f"{number:.0f}"
    return re.sub(r"\.0+(?!\d)|(\.\d*[1-9])0+(?!\d)", r"\1", quantity(number, unit))
