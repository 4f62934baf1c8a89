"""Arguments of the call that computes a study again, from the attributes of its dataset."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from .parts import Call
from .study_words import option_of

if TYPE_CHECKING:
    import xarray as xr


def axes_argument(study: xr.Dataset) -> dict[str, Any] | None:
    """Return the axes of a study as its function takes them; None if the dataset does not hold them."""
    try:
        design = json.loads(study.attrs["design"])
    except (KeyError, TypeError, ValueError):
        return None
    axes: dict[str, Any] = {}
    for path, column in design["columns"].items():
        # A parameter may vary along another one's axis (linked); along several axes it cannot be written as values.
        along = column["varies_along"] or [dim for dim, _ in design["dims"] if dim == path]
        if len(along) != 1:
            return None
        if "values" in column:
            values = column["values"]
        elif path in study.coords and study[path].dtype.kind in "fiu":
            values = study[path].values.tolist()
        else:
            return None
        axes.setdefault(along[0], {})[path] = values
    order = [dim for dim, _ in design["dims"] if dim in axes]
    return {dim: next(iter(axes[dim].values())) if list(axes[dim]) == [dim] else axes[dim] for dim in order}


def options_of(study: xr.Dataset, *names: str) -> dict[str, Any]:
    """Return the options of a study in its attributes that are not at their defaults."""
    options = {}
    for name in names:
        value = option_of(study, name)
        if value not in (None, False, 0, 0.0, "null", []):
            options[name] = value
    return options


def measures_argument(study: xr.Dataset, usual: Sequence[str] = ()) -> tuple[list[str], tuple[str, ...]]:
    """Return the measures of a study as its function takes them, and a remark for each function of the user."""
    measures = [name for name in options_of(study, "measures").get("measures", []) if name not in usual]
    # A function of the user is stored as its name and its fingerprint.
    functions = [name.partition(" ")[0] for name in measures if " " in name]
    remarks = tuple(f"{name} is a function of yours: add it to measure" for name in functions)
    return [name for name in measures if " " not in name], remarks


def call_with_measures(
    function: str, study: xr.Dataset, arguments: Mapping[str, object], usual: Sequence[str] = ()
) -> Call:
    """Return a call with the measures that were asked for, besides the usual ones, which the study always has."""
    measures, remarks = measures_argument(study, usual)
    # A study file cannot name a function of the user.
    kind = "" if remarks else function
    return Call(function, {**arguments, **({"measure": measures} if measures else {})}, kind, remarks)
