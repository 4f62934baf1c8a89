"""Tests that figures show exactly the values of their datasets."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import permutations, product
from typing import Any, NamedTuple

import numpy as np
import pytest
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.collections import LineCollection, PathCollection, PolyCollection, QuadMesh
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.ticker import FixedLocator

PREFIXES = {"": 1.0, "p": 1e-12, "n": 1e-9, "µ": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}
EQUAL = 1e-9
"""Relative rounding error of a change of unit."""


class Scale(NamedTuple):
    """SI unit of an axis, and factor from its numbers to that unit."""

    unit: str
    factor: float


class Mark(NamedTuple):
    """Artist with its points (n, 2) in the units of the axes, NaN for coordinates without data."""

    name: str
    points: np.ndarray
    area: bool = False
    """Whether its edges may come from several columns."""
    values: np.ndarray | None = None
    """Numbers shown by colour."""
    map: bool = False
    """Whether each colour belongs to one point."""


def marks(axes: Axes) -> Iterator[Mark]:
    """Yield all artists of an axes that represent data."""
    for artist in axes.get_children():
        name = f"{type(artist).__name__} {artist.get_label()}"
        if isinstance(artist, Line2D):
            yield Mark(name, _in_data(axes, artist, np.array(artist.get_xydata(), dtype=float)))
        elif isinstance(artist, LineCollection):
            bars = artist.get_array() is None
            yield Mark(name, np.concatenate(artist.get_segments() or [np.empty((0, 2))]), bars, artist.get_array())
        elif isinstance(artist, PathCollection):
            yield Mark(name, np.asarray(artist.get_offsets(), dtype=float), False, artist.get_array())
        elif isinstance(artist, QuadMesh):
            corners = artist.get_coordinates()
            centres = (corners[1:, 1:] + corners[:-1, :-1]) / 2
            shown = np.ma.filled(artist.get_array().astype(float), np.nan).ravel()
            yield Mark(name, centres.reshape(-1, 2)[np.isfinite(shown)], False, shown[np.isfinite(shown)], True)
        elif isinstance(artist, PolyCollection):
            yield Mark(name, np.concatenate([path.vertices for path in artist.get_paths()] or [np.empty((0, 2))]), True)
        elif isinstance(artist, Rectangle) and artist is not axes.patch:
            yield Mark(name, _seen(axes, _in_data(axes, artist, artist.get_bbox().get_points())), True)
        else:
            assert type(artist).__module__.rpartition(".")[2] in {"text", "spines", "axis", "legend", "patches"}, name


def _in_data(axes: Axes, artist: Any, points: np.ndarray) -> np.ndarray:
    """Return points with NaN for coordinates relative to the axes, such as one of `axhline`."""
    own = artist.get_transform().contains_branch_seperately(axes.transData)
    return np.where(own, points, np.nan)


def _seen(axes: Axes, points: np.ndarray) -> np.ndarray:
    """Return points with NaN for edges outside the axes."""
    low, high = np.sort([axes.get_xlim(), axes.get_ylim()], axis=1).T
    return np.where((points > low) & (points < high), points, np.nan)


def scale(axes: Axes, which: str, units: set[str]) -> Scale | None:
    """Return the scale in the label of an axis, or of one that shares it; None for named rows."""
    own: Axis = getattr(axes, f"{which}axis")
    words = [text.get_text() for text in own.get_majorticklabels()]
    if isinstance(own.get_major_locator(), FixedLocator) and any(re.search("[a-z]", word) for word in words):
        return None
    shared = getattr(axes, f"get_shared_{which}_axes")().get_siblings(axes)
    labels = [getattr(one, f"{which}axis").get_label_text() for one in (axes, *shared)]
    units_in_label = re.findall(r"\(([^()]*)\)", next(filter(None, labels), ""))
    for unit, (prefix, factor) in product(units - {""}, PREFIXES.items()):
        if prefix + unit in units_in_label:
            return Scale(unit, factor)
    return Scale("", 0.01 if "%" in units_in_label else 1.0)


def same(*groups: np.ndarray) -> list[np.ndarray]:
    """Return numbers for the values of arrays, equal for values that differ by rounding only."""
    every = np.concatenate([np.ravel(group) for group in groups])
    order = np.argsort(every, kind="stable")
    ranked = every[order]
    apart = np.diff(ranked) > EQUAL * np.maximum(np.abs(ranked[1:]), np.abs(ranked[:-1]))
    ids = np.empty(every.size, dtype=np.int64)
    ids[order] = np.concatenate([[0], np.cumsum(apart)])
    return np.split(ids, np.cumsum([np.size(group) for group in groups])[:-1])


def may_hold(variable: xr.DataArray, drawn: np.ndarray) -> np.ndarray:
    """Return whether each number is near a value of a variable: a cheap test before those of `same`."""
    known = np.sort(variable.values[np.isfinite(variable.values)])
    if not known.size:
        return np.full(drawn.shape, False)
    place = np.searchsorted(known, drawn)
    near = [np.abs(known[np.clip(place - step, 0, known.size - 1)] - drawn) for step in (0, 1)]
    return np.minimum(*near) <= 10 * EQUAL * np.abs(drawn)


def rows(first: xr.DataArray, second: xr.DataArray) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the values of two variables as columns of their table; None if they have no common table."""
    if first.size > 1 and second.size > 1 and not set(first.dims) & set(second.dims):
        return None
    one, other = xr.broadcast(first, second)
    return one.values.ravel(), other.transpose(*one.dims).values.ravel()


def unknown_marks(figure: Figure, data: xr.Dataset) -> list[str]:
    """Return the artists of a figure whose points are not rows of the tables of its dataset.

    The label of an axis must contain its unit, and rows must have names. Lines across the axes may also be at zero or one,
    and areas may begin at zero.
    """
    # Without coordinates, which `rows` would copy for each pair.
    numbers = [
        data[name].drop_vars(data.coords, errors="ignore") for name in data.variables if data[name].dtype.kind in "iuf"
    ]
    units = {variable.units for variable in numbers}
    result = []
    for place, axes in enumerate(figure.axes):
        if axes.get_label() == "<colorbar>":
            continue
        scales = [scale(axes, which, units) for which in "xy"]
        for mark in marks(axes):
            if not _known(mark, scales, numbers, data):
                result.append(f"axes {place}: {mark.name}")
    return result


def _known(mark: Mark, scales: list[Scale | None], numbers: list[xr.DataArray], data: xr.Dataset) -> bool:
    def column(which: int, points: np.ndarray) -> tuple[np.ndarray, list[xr.DataArray]] | None:
        axis = scales[which]
        if axis is None or not np.isfinite(points[:, which]).any():
            return None
        return points[:, which] * axis.factor, [variable for variable in numbers if variable.units == axis.unit]

    if mark.values is not None and not any(_within(mark.values, variable) for variable in numbers):
        return False
    complete = np.isfinite(mark.points).all(axis=1)
    if complete.any():  # points with NaN are not drawn
        points = mark.points[complete]
        x, y = column(0, points), column(1, points)
        if mark.map and x is not None and y is not None:
            return any(_mapped(x[0], y[0], mark.values, data[variable.name]) for variable in numbers)
        if x is not None and y is not None:
            return _paired(mark, *x, *y)
        only = x or y
        parts = only[0] if only is not None and mark.area else [only[0] if only is not None else ()]
        return only is None or all(any(_within(part, variable) for variable in only[1]) for part in parts)
    for which in range(2):
        found = column(which, mark.points)
        for value in np.unique(found[0][np.isfinite(found[0])]) if found else ():
            if value not in (0.0, 1.0) and not any(_within(value, variable) for variable in found[1]):
                return False
    return True


def _within(values: Any, variable: xr.DataArray) -> bool:
    drawn, expected = same(np.asarray(values, dtype=float), variable.values[np.isfinite(variable.values)])
    return bool(np.isin(drawn, expected).all())


def _mapped(x: np.ndarray, y: np.ndarray, values: Any, variable: xr.DataArray) -> bool:
    """Return whether each point has the value of the table of a variable at its coordinates."""
    result = []
    for first, second in permutations([variable[dim] for dim in variable.dims if variable[dim].dtype.kind in "if"], 2):
        table = xr.broadcast(first, second, variable)
        ids = [same(drawn, one.values) for drawn, one in zip((x, y, values), table, strict=True)]
        key = [sum(i.astype(object) * 10 ** (12 * k) for k, i in enumerate(part)) for part in zip(*ids, strict=True)]
        result.append(set(key[0]) <= set(key[1]))
    return any(result)


def _paired(mark: Mark, x: np.ndarray, first: list[xr.DataArray], y: np.ndarray, second: list[xr.DataArray]) -> bool:
    """Return whether each point is a row of a table: all points of a line of one table, those of an area of any."""
    left = np.full(x.size, True)
    for one in first:
        if not may_hold(one, x).any():
            continue
        if mark.area:
            left &= ~((y == 0) & np.isin(*same(x, one.values[np.isfinite(one.values)])))
        for other in second:
            if not mark.area and not may_hold(other, y).all():
                continue
            table = rows(one, other)
            if table is None:
                continue
            full = np.isfinite(table[0]) & np.isfinite(table[1])
            x_drawn, x_known = same(x, table[0][full])
            y_drawn, y_known = same(y, table[1][full])
            width = int(max(y_drawn.max(), y_known.max(initial=0))) + 1
            met = np.isin(x_drawn * width + y_drawn, x_known * width + y_known)
            if met.all():
                return True
            if mark.area:
                left &= ~met
    return not left.any()


def test_all_drawn_numbers_are_in_the_dataset(every):
    """Each point of each line, bar, area and map is a row of the figure's tables, apart from the unit of the axis."""
    if every.module == "figure_01":
        pytest.skip("a schematic shows no numbers")
    assert unknown_marks(every.figure.draw(every.data), every.data) == []


def test_wrong_number_is_detected(computed):
    """All artists of a figure drawn from data with a relative error of 1e-6 are detected."""
    _, figure, data, _ = computed("figure_07c")
    off = data.map(lambda variable: variable * (1 + 1e-6), keep_attrs=True)
    drawn = figure.draw(off)
    telling = [mark for axes in drawn.axes for mark in marks(axes) if np.any(np.nan_to_num(mark.points) % 1)]
    assert len(unknown_marks(drawn, data)) == len(telling) > 10


def test_wrong_unit_is_detected(computed):
    """Numbers in millijoules on an axis in joules are detected."""
    _, figure, data, _ = computed("figure_07c")
    drawn = figure.draw(data)
    assert drawn.axes[0].get_ylabel().endswith("(mJ)")
    drawn.axes[0].set_ylabel("Energy lost in impacts (J)")
    assert {place.partition(":")[0] for place in unknown_marks(drawn, data)} == {"axes 0"}
