"""Attributes of numbers with meanings, as the CF conventions have them: of the type of their variable.

References
----------
B. Eaton et al., NetCDF Climate and Forecast (CF) Metadata Conventions, section 3.5, Flags, https://cfconventions.org.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np


def flag_values(names: Iterable[str]) -> dict[str, Any]:
    """Return the attributes of a variable that has the number of one of these names, from 0."""
    names = list(names)
    return {"flag_values": list(range(len(names))), "flag_meanings": " ".join(names)}


def flag_masks(names: Iterable[str]) -> dict[str, Any]:
    """Return the attributes of a variable whose bits have these names, from the lowest one."""
    names = list(names)
    return {"flag_masks": [1 << bit for bit in range(len(names))], "flag_meanings": " ".join(names)}


def has_flag(variable: Any, name: str) -> Any:
    """Return where a variable of xarray with `flag_masks` has the bit of a name; nowhere if it has no such bit or is NaN."""
    names = str(variable.attrs.get("flag_meanings", "")).split()
    mask = 1 << names.index(name) if name in names else 0
    return (variable.fillna(0).astype(np.int64) & mask) != 0


def type_flags(data: Any) -> Any:
    """Give the flags in a dataset of xarray the types of their variables, which files of Zarr do not keep; return it."""
    for variable in data.variables.values():
        for name in {"flag_values", "flag_masks"} & variable.attrs.keys():
            variable.attrs[name] = np.atleast_1d(np.asarray(variable.attrs[name])).astype(variable.dtype)
    return data
