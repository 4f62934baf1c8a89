"""The motion of a run along one direction, with the same names and dimensions for 1-D and 3-D runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from rattlebox.model.errors import Hint
from rattlebox.model.space import AXES, Direction, Triple, axis_of, unit_vector

from . import datasets
from .schema import LINE

if TYPE_CHECKING:
    import xarray

    from .record import Record


def motion_along(run: Record, direction: str | Sequence[float] | None) -> xarray.Dataset:
    """Return the dataset `motion` without the dimension `axis`; see `Run.along`."""
    motion = datasets.dataset(run, "motion")
    wanted = None if direction is None else _read(direction)
    if run.arrays.engine == "impact":
        line = run.arrays.line
        if wanted is not None and line not in (LINE, axis_of(wanted)):
            raise Hint(f"the base of this 1-D run moves along {line}, not along {direction}", f'along("{line}")')
        return motion.isel(axis=0, drop=True)
    along = unit_vector(_direction_of(run) if wanted is None else wanted)
    return _one_point_for_three_lines(_dot(motion, along), along)


def _read(direction: str | Sequence[float]) -> str | Triple:
    try:
        return TypeAdapter(Direction).validate_python(direction)
    except ValidationError:
        raise Hint(
            f"{direction!r:.60} is no direction; it must be x, y, z, one of them with a minus, or three numbers", '"z"'
        ) from None


def _direction_of(run: Record) -> str | Triple:
    """Return the direction of all dampers of a 3-D run."""
    different = {damper.direction for damper in run.case.particle_dampers}
    if len(different) > 1:
        raise Hint("the dampers of this run have different directions; one must be given", 'along("z")')
    return different.pop()


def _dot(data: xarray.Dataset, along: Any) -> xarray.Dataset:
    """Return a dataset whose vectors are replaced by their components along a unit vector."""
    changed = {
        name: (
            tuple(dim for dim in values.dims if dim != "axis"),
            np.tensordot(values.values, along, (-1, 0)),
            values.attrs,
        )
        for name, values in data.data_vars.items()
        if "axis" in values.dims
    }
    return data.drop_dims("axis").assign(changed)[list(data.data_vars)]


def _one_point_for_three_lines(data: xarray.Dataset, along: Any) -> xarray.Dataset:
    """Return a dataset in which points that move in 3-D have one entry, with the component along a unit vector."""
    names = [str(point) for point in data.point.values]
    weights: dict[str, dict[int, float]] = {}
    for number, name in enumerate(names):
        point, _, axis = name.rpartition(" ")
        lines = [f"{point} {other}" for other in AXES]
        if axis in AXES and point and set(lines) <= set(names):
            weights.setdefault(point, {})[number] = float(along[AXES.index(axis)])
        else:
            weights[name] = {number: 1.0}
    if list(weights) == names:
        return data
    matrix = np.zeros((len(names), len(weights)))
    for column, entries in enumerate(weights.values()):
        for row, weight in entries.items():
            matrix[row, column] = weight
    changed = {
        name: (values.dims, values.values @ matrix, values.attrs)
        for name, values in data.data_vars.items()
        if values.dims[-1:] == ("point",)
    }
    others = data.drop_dims("point").assign_coords(point=("point", list(weights), data.point.attrs))
    return others.assign(changed)[list(data.data_vars)]
