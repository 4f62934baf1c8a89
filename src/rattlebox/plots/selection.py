"""Selection of variants of a study by values of its axes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.exceptions import CaseError

from ..model.errors import Hint, nearest
from ..model.units import parse
from .labels import name_of, unit_of, value_of

if TYPE_CHECKING:
    import xarray as xr


def select(study: xr.Dataset, at: Mapping[str, Any]) -> tuple[xr.Dataset, str]:
    """Select the variants of a study at values of its axes."""
    texts = []
    for name, value in at.items():
        names = [str(other) for other, coord in study.coords.items() if coord.ndim == 1]
        if name not in names:
            raise CaseError(f"at = {name!r}: the study has no such axis", nearest(name, names))
        coord = study[name]
        index = _nearest_index(coord, name, value)
        texts.append(f"{name_of(coord)} {value_of(coord, coord.values[index])}")
        study = study.isel({coord.dims[0]: index})
    return study, ", ".join(texts)


def nearest_value_notes(study: xr.Dataset, at: Mapping[str, Any]) -> list[str]:
    """Return a note for each axis on which `select` replaces the requested value by the nearest one."""
    lines = []
    for name, value in at.items():
        coord = study[name]
        text = value_of(coord, coord.values[_nearest_index(coord, name, value)])
        if text != value_of(coord, _in_si(coord, name, value)):
            lines.append(f"{name} = {text}, the nearest value to {value} in the study")
    return lines


def _in_si(coord: xr.DataArray, name: str, value: Any) -> Any:
    """Return a value as a number in the unit of a coordinate, or unchanged for a coordinate of names."""
    if coord.dtype.kind not in "fiu":
        return value
    try:
        return parse(value, (unit_of(coord) or "1",))[0]
    except Hint as hint:
        raise hint.restated(CaseError, head=f"at: {name} = {value!r}") from None


def _nearest_index(coord: xr.DataArray, name: str, value: Any) -> int:
    """Return the index of the value of a coordinate that is nearest to a given one."""
    values = coord.values
    if values.dtype.kind not in "fiu":
        if value not in values.tolist():
            raise CaseError(f"at: {name} = {value!r} is not in the study", nearest(str(value), map(str, values)))
        return int(values.tolist().index(value))
    number = _in_si(coord, name, value)
    low, high = float(values.min()), float(values.max())
    if not low - 1e-6 * abs(low) <= number <= high + 1e-6 * abs(high):
        limits = f"{value_of(coord, low)} to {value_of(coord, high)}"
        raise CaseError(f"at: {name} = {value!r} is outside the range of the study", limits)
    return int(np.argmin(np.abs(values - number)))
