"""The arrays of a run as labelled xarray datasets."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from .arrays import RunArrays
from .ledger import Ledger
from .schema import CHANNELS, COORDINATES, GROUP_TITLES, Group, variables

if TYPE_CHECKING:
    import xarray

    from .provenance import Provenance


def columns(arrays: RunArrays, ledger: Ledger, group: Group) -> dict[str, Any]:
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
    if group == "impacts":
        return {v.name: getattr(arrays.impacts, v.name) for v in variables(group)}
    derived: dict[str, Callable[[], Any]] = {
        "structure": lambda: ledger.structure,
        "particles": lambda: ledger.particles,
        "total": lambda: ledger.total,
        "work": lambda: ledger.work,
        "losses": lambda: ledger.losses,
        "residual": lambda: ledger.residual,
        "share": lambda: np.array(list(ledger.shares.values())),
    }
    return {v.name: derived[v.name]() if v.name in derived else getattr(arrays, v.name) for v in variables(group)}


def labels(arrays: RunArrays) -> dict[str, Any]:
    """Values of the coordinates, by dimension: times, names, and mode numbers from 1.

    Parameters
    ----------
    arrays
        Arrays of the run.
    """
    return {
        "time": arrays.time,
        "point": arrays.points,
        "ball": arrays.balls,
        "damper": arrays.dampers,
        "source": arrays.loads,
        "mode": np.arange(1, arrays.mode_frequency.size + 1),
        "channel": CHANNELS,
    }


def dataset(arrays: RunArrays, ledger: Ledger, group: Group, provenance: Provenance, case: str) -> xarray.Dataset:
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

    data: dict[str, Any] = {}
    coords: dict[str, Any] = {}
    values = columns(arrays, ledger, group)
    names = labels(arrays)
    for v in variables(group):
        attrs = {"units": v.units, "long_name": v.long_name}
        target = coords if v.name in ("time", "mode_frequency", "ball_damper") else data
        target[v.name] = (v.dims, values[v.name], attrs)
        for dim in v.dims:
            if dim == "impact" or dim in coords:
                continue
            units, long_name = COORDINATES[dim]
            described = {"long_name": long_name} | ({"units": units} if units else {})
            label = names[dim]
            # An empty tuple would become an array of floats.
            label = np.array(label, dtype=str) if isinstance(label, tuple) else label
            coords[dim] = (dim, label, described)
    attrs = {"title": GROUP_TITLES[group], "status": arrays.status, "message": arrays.message}
    return xarray.Dataset(data, coords, attrs | asdict(provenance) | {"case": case})
