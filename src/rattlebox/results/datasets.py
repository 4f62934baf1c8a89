"""The arrays of a run as labelled xarray datasets."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .schema import ANY, DIMENSIONS, Dimension, Variable, dimensions, full_dims, groups, variables

if TYPE_CHECKING:
    import xarray

    from .record import Record

Labels = tuple[str, ...] | NDArray[Any]
"""Labels along a dimension: names, or numbers."""


_DIMENSIONS = {dim.name: dim for dim in DIMENSIONS}


class Part(NamedTuple):
    """A variable of a run with its values, and those of its dimensions that no earlier variable has, with their labels.

    Dimensions without labels, such as the number of an impact, are not listed.
    """

    variable: Variable
    values: NDArray[Any]
    labels: list[tuple[Dimension, Labels]]


def parts(run: Record, group: str, *, empty: bool = True) -> Iterator[Part]:
    """Yield the variables of a group, stored and derived; `empty` also those along a dimension without labels."""
    engine, labels = run.arrays.engine, run.arrays.labels
    stored = run.arrays if groups(engine)[group].along == "time" else getattr(run.arrays, group)
    seen: set[str] = set()
    for v in variables(engine, group):
        if "wall" in v.dims and not labels["wall"]:  # recorded on request only
            continue
        if empty or all(len(labels.get(dim, "-")) for dim in v.dims):
            new = [dim for dim in v.dims if dim in labels and dim not in seen]
            seen.update(new)
            values = getattr(run.ledger if v.derived else stored, v.name)
            yield Part(v, values, [(dimensions(engine)[dim], labels[dim]) for dim in new])


def labelled_parts(run: Record, group: str, *, empty: bool = True) -> Iterator[Part]:
    """Yield the variables of a group with the dimensions that they have in all runs.

    In a 1-D run `axis` and `partner` have one entry.
    """
    single = {"axis": (run.arrays.line,), "partner": (ANY,)}
    seen: set[str] = set()
    for v, values, labels in parts(run, group, empty=empty):
        dims = full_dims(group)[v.name]
        missing = [dim for dim in dims if dim not in v.dims]
        places = tuple(dims.index(dim) for dim in missing)
        new: list[tuple[Dimension, Labels]] = [(_DIMENSIONS[dim], single[dim]) for dim in missing if dim not in seen]
        seen.update(missing)
        yield Part(replace(v, dims=dims), np.expand_dims(values, places), labels + new)


def dataset(run: Record, group: str) -> xarray.Dataset:
    """Return the labelled dataset of a group; every variable has `units` and `long_name`."""
    import xarray

    data: dict[str, Any] = {}
    coords: dict[str, Any] = {}
    for v, values, labels in labelled_parts(run, group):
        for dim, names in labels:
            meaning = {"long_name": dim.long_name} | ({"units": dim.units} if dim.units else {})
            # NumPy would convert an empty tuple to an array of floats.
            coords[dim.name] = (dim.name, np.array(names, str) if isinstance(names, tuple) else names, meaning)
        target = coords if v.coordinate else data
        target[v.name] = (v.dims, values, {"units": v.units, "long_name": v.long_name})
    attrs = {"title": groups(run.arrays.engine)[group].title, "status": run.status, "message": run.message}
    return xarray.Dataset(data, coords, attrs | asdict(run.provenance) | {"case": run.case_toml})
