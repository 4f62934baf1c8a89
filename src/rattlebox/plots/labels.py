"""Texts, units and axes of variables of a dataset, as figures show them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from matplotlib.ticker import Formatter

from rattlebox._util.quantities import ACCELERATION, STANDARD_GRAVITY, acceleration, quantity, without_zeros

from .style import axis_in_g, label, letters, scaled, shorten
from .types import Style, Vector

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis

REPLICA = "replica"
"""Dimension of repeated runs that differ in their random seeds only."""

_TICK_LETTERS = 16  # of names at ticks
_LARGEST_EXACT = 2**53  # whole numbers below it are written with all their digits
_IN_PERCENT = ("damping_ratio", "equivalent_damping")  # engineers write them in per cent
_UNBOUNDED = ("loss_factor",)  # it is infinite where the effective mass passes through zero
_SIGNED = ("work", "effective_mass", "phase")
"""Quantities that may be negative; others are sizes, counts or losses, whose intervals end at zero."""
_PERCENTILE = 95.0  # of an unbounded measure, at which its scale ends


class LabelledValues(NamedTuple):
    """Values of a variable in a unit with prefix, or indices into a list of names."""

    numbers: Vector
    divisor: float
    unit: str
    text: str
    names: list[str] | None

    @classmethod
    def of(cls, values: xr.DataArray) -> LabelledValues:
        """Return the values of a variable with its `units` and `long_name`."""
        text = capitalised(name_of(values).replace(" V^2", "\N{NO-BREAK SPACE}V²").replace("^2", "²"))
        if values.dtype.kind not in "fiu":
            names = list(dict.fromkeys(map(str, values.values.ravel())))
            indices = {name: float(index) for index, name in enumerate(names)}
            numbers = np.array([indices[str(value)] for value in values.values.ravel()])
            return cls(numbers.reshape(values.shape), 1.0, "", text, names)
        if str(values.name).rpartition(".")[2] in _IN_PERCENT:
            return cls(np.asarray(100 * values.values, dtype=float), 0.01, "%", text, None)
        si_unit = unit_of(values)
        divisor, unit = scaled(values.values, si_unit) if si_unit else (1.0, "")
        return cls(np.asarray(values.values / divisor, dtype=float), divisor, unit.replace("^2", "²"), text, None)

    @property
    def with_unit(self) -> str:
        """Description with its unit, on one line."""
        return f"{self.text} ({self.unit})" if self.unit else self.text

    def label(self, axes: Axes, which: Literal["x", "y"], *, log: bool = False) -> None:
        """Label an axis of a figure and its ticks, and make it logarithmic if requested."""
        axis = axes.xaxis if which == "x" else axes.yaxis
        if log:
            (axes.set_xscale if which == "x" else axes.set_yscale)("log")
            log_ticks(axis)
        if self.names is not None:
            ticks = [shorten(name, _TICK_LETTERS) for name in self.names]
            crowded = which == "x" and sum(map(len, ticks)) + len(ticks) > letters(axes)
            slanted: Style = {"rotation": 30, "ha": "right", "rotation_mode": "anchor"} if crowded else {}
            axis.set_ticks(range(len(ticks)), ticks, **slanted)
        label(axes, which, self.text, self.unit)

    def axis_in_g(self, axes: Axes, which: Literal["x", "y"]) -> None:
        """Add a second axis in g to one of accelerations."""
        if self.names is None and self.unit == ACCELERATION.replace("^2", "²"):
            axis_in_g(axes, which, STANDARD_GRAVITY / self.divisor)


class StudyAxis(NamedTuple):
    """Axis of a study: values, (n,), and edges of the cells of a map, (n + 1,)."""

    values: LabelledValues
    edges: Vector
    log: bool

    @classmethod
    def of(cls, coord: xr.DataArray) -> StudyAxis:
        """Return the axis of a coordinate."""
        values = LabelledValues.of(coord)
        log = values.names is None and is_geometric(values.numbers)
        numbers = np.log(values.numbers) if log else values.numbers
        if numbers.size == 1:
            half = 0.5 * abs(numbers[0]) or 0.5
            return cls(values, np.array([numbers[0] - half, numbers[0] + half]), log)
        # Cells end halfway between values, on a logarithmic axis halfway between their logarithms.
        middle = 0.5 * (numbers[1:] + numbers[:-1])
        edges = np.concatenate(([2 * numbers[0] - middle[0]], middle, [2 * numbers[-1] - middle[-1]]))
        return cls(values, np.asarray(np.exp(edges) if log else edges, dtype=float), log)

    def label(self, axes: Axes, which: Literal["x", "y"], *, in_g: bool = True) -> None:
        """Label an axis of a figure and its ticks, with a second one in g if requested."""
        self.values.label(axes, which, log=self.log)
        if in_g:
            self.values.axis_in_g(axes, which)


def is_geometric(values: Vector) -> bool:
    """Return whether values have the same ratio from each to the next."""
    if values.size < 4 or np.any(values <= 0):
        return False
    ratios = values[1:] / values[:-1]
    return bool(np.allclose(ratios, ratios[0], rtol=1e-6) and abs(ratios[0] - 1) > 1e-6)


def upper_limit(name: str, values: Vector) -> float | None:
    """Return where the scale of an unbounded measure ends, None for a measure whose values all fit on one scale."""
    finite = values[np.isfinite(values)]
    if name not in _UNBOUNDED or not finite.size:
        return None
    limit = float(np.percentile(finite, _PERCENTILE))
    return limit if finite.max() > limit > 0 else None


def interval_ends(name: str, values: xr.DataArray, half: xr.DataArray) -> tuple[xr.DataArray, xr.DataArray]:
    """Return the ends of an interval, with a lower end that the quantity can have."""
    low = values - half
    # An interval of t statistics is symmetrical, and wider than the value itself if that scatters much.
    return (low if name in _SIGNED or (values < 0).any() else low.clip(min=0.0)), values + half


def log_ticks(axis: Axis) -> None:
    """Write the numbers of a logarithmic axis without powers of ten."""
    axis.set_major_formatter(plain)
    axis.set_minor_formatter(_MinorFormatter())


class _MinorFormatter(Formatter):
    """Labels between the powers of ten: all of them on short axes, 2 and 5 on longer ones, none on long ones."""

    def __call__(self, value: float, pos: int | None = None) -> str:
        low, high = self.axis.get_view_interval()  # type: ignore[union-attr]
        digit = f"{value:e}"[0]
        return plain(value) if high < 3 * low or (high < 100 * low and digit in "25") else ""


def plain(value: float, _: float = 0.0) -> str:
    """Return a number of a logarithmic axis as text without a power of ten: 0.1, 10."""
    return f"{value:g}"


def capitalised(text: str) -> str:
    """Return a text with a capital letter at its beginning."""
    return text[:1].upper() + text[1:]


def name_of(values: xr.DataArray) -> str:
    """Return the description of a variable, or its name if it has none."""
    return str(values.attrs.get("long_name", values.name)).replace("_", " ")


def unit_of(values: xr.DataArray) -> str:
    """Return the SI unit of a variable, "" for pure numbers."""
    unit = str(values.attrs.get("units", ""))
    return "" if unit == "1" else unit


def value_of(coord: xr.DataArray, value: Any) -> str:
    """Return one value of a coordinate as text with its unit, without trailing zeros."""
    if coord.dtype.kind not in "fiu":
        return str(value)
    unit = unit_of(coord)
    number = float(value) + 0.0  # turns -0.0 into 0.0
    if not unit and number.is_integer() and abs(number) < _LARGEST_EXACT:
        return f"{number:.0f}"
    return acceleration(number) if unit == ACCELERATION else without_zeros(quantity(number, unit))
