"""The arrays of a run as labelled xarray datasets."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from .schema import dimensions, groups, variables

if TYPE_CHECKING:
    import xarray

    from .record import Record


def columns(run: Record, group: str) -> dict[str, Any]:
    """Return the values of all variables of a group, stored and derived, by name."""
    engine = run.arrays.engine
    stored = run.arrays if groups(engine)[group].along == "time" else getattr(run.arrays, group)
    return {v.name: getattr(run.ledger if v.derived else stored, v.name) for v in variables(engine, group)}


def dataset(run: Record, group: str) -> xarray.Dataset:
    """Return the labelled dataset of a group; every variable has `units` and `long_name`."""
    import xarray

    engine = run.arrays.engine
    data: dict[str, Any] = {}
    coords: dict[str, Any] = {}
    values, labels = columns(run, group), run.arrays.labels
    for v in variables(engine, group):
        attrs = {"units": v.units, "long_name": v.long_name}
        target = coords if v.coordinate else data
        target[v.name] = (v.dims, values[v.name], attrs)
        for dim in v.dims:
            if dim not in labels or dim in coords:
                continue
            described = dimensions(engine)[dim]
            meaning = {"long_name": described.long_name} | ({"units": described.units} if described.units else {})
            label = labels[dim]
            # NumPy would convert an empty tuple to an array of floats.
            label = np.array(label, dtype=str) if isinstance(label, tuple) else label
            coords[dim] = (dim, label, meaning)
    attrs = {"title": groups(engine)[group].title, "status": run.status, "message": run.message}
    return xarray.Dataset(data, coords, attrs | asdict(run.provenance) | {"case": run.case_toml})
