"""Comparison of the measures of a few variants of a case with those of the last one, over random packings."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.prepare.time_step import WARNINGS
from rattlebox.studies.kinds.sweep import sweep

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case


def compared(
    variants: Sequence[Case],
    measures: str | Sequence[str],
    seeds: Mapping[str, Any],
    coordinate: tuple[str, Sequence[float], str],
    tolerance: float,
    options: Mapping[str, Any],
) -> xarray.Dataset:
    """Return the measures of variants, and their changes from the last one."""
    import xarray

    along, values, unit = coordinate
    names = [measures] if isinstance(measures, str) else list(measures)
    studies = [sweep(variant, dict(seeds), names, **options) for variant in variants]
    count = math.prod(studies[0].sizes.values())
    data: dict[str, Any] = {}
    for name in names:
        rows = [study[name] for study in studies]
        about = rows[0].attrs
        numbers = np.array([row.values for row in rows])
        mean, error = numbers.mean(axis=1), numbers.std(axis=1, ddof=1) / math.sqrt(count)
        change, change_error = mean - mean[-1], np.hypot(error, error[-1])
        change_error[-1] = 0.0
        data[name] = along, mean, about
        long_name, units = about.get("long_name", name), about.get("units", "1")
        for suffix, part, words in (
            ("error", error, "standard error of the {}"),
            ("change", change, f"change of the {{}} from the last {along}"),
            ("change_error", change_error, "standard error of the change of the {}"),
        ):
            data[f"{name}_{suffix}"] = along, part, {"units": units, "long_name": words.format(long_name)}
        allowed = tolerance * abs(mean[-1])
        changed = np.abs(change) > np.maximum(2 * change_error, allowed)
        kept = np.abs(change) + 2 * change_error <= allowed
        data[f"{name}_changed"] = along, changed, {"long_name": f"whether the {long_name} changes"}
        data[f"{name}_kept"] = along, kept, {"long_name": f"whether the {long_name} is kept"}
    about_values = (along, list(values), {"units": unit, "long_name": "time step" if along == "step" else along})
    exceeded = [name for name in WARNINGS if any(_exceeds(study, name) for study in studies)]
    attributes = {"packings": count, "tolerance": tolerance, "exceeded": exceeded}
    return xarray.Dataset(data, {along: about_values}, attributes)


def _exceeds(study: xarray.Dataset, name: str) -> bool:
    """Return whether a run of a study exceeds a validity limit."""
    bit = 2 ** study.warnings.attrs["flag_meanings"].split().index(name)
    return bool((study.warnings.values.astype(int) & bit).any())
