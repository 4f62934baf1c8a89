"""The arrays of a run as labelled xarray datasets."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray

    from .arrays import RunArrays
    from .ledger import Ledger
    from .provenance import Provenance


def columns(arrays: RunArrays, ledger: Ledger, group: str) -> dict[str, Any]:
    """Values of all variables of a dataset, stored and derived, by name.

    Parameters
    ----------
    arrays
        Arrays of the run.
    ledger
        Energy ledger of the same arrays.
    group
        Dataset.
    """
    stored = arrays.impacts if group == "impacts" else arrays
    return {
        v.name: getattr(ledger if v in arrays.form.derived else stored, v.name) for v in arrays.form.variables(group)
    }


def labels(arrays: RunArrays) -> dict[str, Any]:
    """Values of the coordinates, by dimension: times, names, and mode numbers from 1.

    Parameters
    ----------
    arrays
        Arrays of the run.
    """
    return {dim: getattr(arrays, attribute) for dim, attribute in arrays.form.labels.items()}


def dataset(arrays: RunArrays, ledger: Ledger, group: str, provenance: Provenance, case: str) -> xarray.Dataset:
    """Labelled dataset of one group; every variable has `units` and `long_name`.

    Parameters
    ----------
    arrays
        Arrays of the run.
    ledger
        Energy ledger of the same arrays.
    group
        Dataset.
    provenance
        Origin of the run, written to the attributes.
    case
        Text of the case, written to the attributes.
    """
    import xarray

    form = arrays.form
    data: dict[str, Any] = {}
    coords: dict[str, Any] = {}
    values = columns(arrays, ledger, group)
    names = labels(arrays)
    for v in form.variables(group):
        attrs = {"units": v.units, "long_name": v.long_name}
        target = coords if v.name in ("time", "mode_frequency", "ball_damper") else data
        target[v.name] = (v.dims, values[v.name], attrs)
        for dim in v.dims:
            if dim not in names or dim in coords:
                continue
            units, long_name = form.coordinates[dim]
            described = {"long_name": long_name} | ({"units": units} if units else {})
            label = names[dim]
            # An empty tuple would become an array of floats.
            label = np.array(label, dtype=str) if isinstance(label, tuple) else label
            coords[dim] = (dim, label, described)
    attrs = {"title": form.titles[group], "status": arrays.status, "message": arrays.message}
    return xarray.Dataset(data, coords, attrs | asdict(provenance) | {"case": case})
