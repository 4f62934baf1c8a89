"""Comparison of the measures of a few variants of a case with those of the last one, over random packings."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.model.errors import Hint
from rattlebox.model.units import whole_number
from rattlebox.prepare.particles import resolve_softening
from rattlebox.prepare.time_step import WARNINGS
from rattlebox.studies.grid.robust import packing_axis
from rattlebox.studies.kinds.sweep import sweep

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case


def compared(
    case: Case,
    coordinate: tuple[str, str, str],
    variants_of: Callable[[Case, Mapping[str, Any]], Mapping[float, Case]],
    measures: str | Sequence[str],
    packings: int,
    tolerance: float,
    options: Mapping[str, Any],
) -> xarray.Dataset:
    """Return the measures of variants by a value, and their changes from the last one.

    The coordinate has name, unit and long name; `variants_of` returns the variants of a case with its axis of packings.
    """
    import xarray

    along, unit, long_name = coordinate
    whole_number(packings, "packings", 2)
    if not case.particle_dampers:
        raise Hint(
            f"the case has no particle damper, and only these have a {long_name}", "a case with rb.ParticleDamper"
        )
    case, _ = resolve_softening(case)
    seeds = packing_axis(case, packings)
    variants = variants_of(case, seeds)
    names = [measures] if isinstance(measures, str) else list(measures)
    studies = [sweep(variant, dict(seeds), names, **options) for variant in variants.values()]
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
        quantity, units = about.get("long_name", name), about.get("units", "1")
        for suffix, part, words in (
            ("error", error, "standard error of the {}"),
            ("change", change, f"change of the {{}} from the last {along}"),
            ("change_error", change_error, "standard error of the change of the {}"),
        ):
            data[f"{name}_{suffix}"] = along, part, {"units": units, "long_name": words.format(quantity)}
        allowed = tolerance * abs(mean[-1])
        changed = np.abs(change) > np.maximum(2 * change_error, allowed)
        kept = np.abs(change) + 2 * change_error <= allowed
        data[f"{name}_changed"] = along, changed, {"long_name": f"whether the {quantity} changes"}
        data[f"{name}_kept"] = along, kept, {"long_name": f"whether the {quantity} is kept"}
    about_values = (along, list(variants), {"units": unit, "long_name": long_name})
    exceeded = [name for name in WARNINGS if any(_exceeds(study, name) for study in studies)]
    attributes = {"packings": count, "tolerance": tolerance, "exceeded": exceeded}
    return xarray.Dataset(data, {along: about_values}, attributes)


def _exceeds(study: xarray.Dataset, name: str) -> bool:
    """Return whether a run of a study exceeds a validity limit."""
    bit = 2 ** study.warnings.attrs["flag_meanings"].split().index(name)
    return bool((study.warnings.values.astype(int) & bit).any())
