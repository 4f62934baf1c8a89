"""Outcomes of the runs of a study: statuses, refusals and warnings, in lines of text."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.prepare.time_step import WARNINGS

if TYPE_CHECKING:
    import xarray as xr

_CHUNK_BYTES = 2**26


def status_lines(study: xr.Dataset) -> list[str]:
    """Return lines with the statuses of the runs of a study, the reason of a refusal, and the warnings."""
    lines = []
    if counts := status_counts(study):
        statuses = ", ".join(f"{count:,} {name}" for name, count in counts.items())
        lines.append(f"{sum(counts.values()):,} variants: {statuses}")
    if "refused" in study.attrs:
        lines.append(f"refused, for example with {study.attrs['refused']}")
    given = study.attrs.get("warnings", [])  # of a design without a feasible trial; a single one is read as a text
    if "reason" in study and given:
        lines += [given] if isinstance(given, str) else list(given)
    elif "reason" in study and (refused := [str(reason) for reason in study.reason.values if reason]):
        first = refused[0].replace("\n", "\n  ")
        lines.append(f"{len(refused):,} of {study.sizes['trial']:,} trials are not feasible, for example: {first}")
    return [*lines, *warning_lines(study)]


def study_remarks(study: xr.Dataset) -> xr.DataArray:
    """Return in words what limits the result of each run of a study: exceeded validity limits, or why it did not finish.

    Parameters
    ----------
    study
        Dataset from `rb.sweep`, `rb.open_study` or another study with `status` or `warnings`.

    Returns
    -------
    xarray.DataArray
        Text for each run, parts separated by "; "; "" for a run without remarks. Over the axes of `status` and `warnings`;
        a single "" for a study without them.

    Examples
    --------
    >>> import rattlebox as rb
    >>> study = rb.sweep(rb.reference_case(duration=0.1), {"damper.gap": ["0.2 mm", "0.4 mm"]}, "peak")
    >>> rb.study_remarks(study).values.tolist()
    ['', '']
    """
    import xarray

    found = xarray.DataArray("").astype(object)
    if "status" in study and "flag_meanings" in study.status.attrs:
        names = dict(enumerate(study.status.attrs["flag_meanings"].split()))
        words = {number: name.replace("_", " ") for number, name in names.items() if name != "finished"}
        found = _joined(found, study.status, lambda value: [words[value]] if value in words else [])
    if "warnings" in study and "flag_masks" in study.warnings.attrs:
        attrs = study.warnings.attrs
        masks = [int(mask) for mask in np.atleast_1d(attrs["flag_masks"])]
        flags = dict(zip(masks, attrs["flag_meanings"].split(), strict=True))
        found = _joined(
            found,
            study.warnings,
            lambda value: [WARNINGS.get(name, name) for mask, name in flags.items() if value > 0 and value & mask],
        )
    return found


def _joined(found: xr.DataArray, codes: xr.DataArray, words: Callable[[int], list[str]]) -> xr.DataArray:
    """Add the words of codes to texts, over the dimensions of both; codes of missing variants have none."""
    import xarray

    numbers = np.where(np.isfinite(codes.values), codes.values, -1).astype(int)
    texts = {value: "; ".join(words(value)) for value in np.unique(numbers).tolist()}
    added = codes.copy(data=np.array([texts[value] for value in numbers.ravel().tolist()], object).reshape(codes.shape))
    first, second = xarray.broadcast(found, added)
    joined = ["; ".join(filter(None, pair)) for pair in zip(first.values.ravel(), second.values.ravel(), strict=True)]
    result = second.copy(data=np.array(joined, object).reshape(second.shape))
    result.attrs = {"long_name": "remarks on the runs"}
    return result


def status_counts(study: xr.Dataset) -> dict[str, int]:
    """Count the runs of a study by their status."""
    if "status" not in study:
        return {}
    names = study.status.attrs.get("flag_meanings", "").split()
    numbers, counts = np.unique(np.concatenate([computed(chunk) for chunk in chunks(study.status)]), return_counts=True)
    return {
        names[number] if number < len(names) else f"status {number}": int(count)
        for number, count in zip(numbers, counts, strict=True)
    }


def warning_lines(study: xr.Dataset) -> list[str]:
    """Return the warnings of a study: a stop by the budget, measures without an interval, exceeded validity limits."""
    lines = [f"warning: {study.attrs['stopped']}"] if "stopped" in study.attrs else []
    lines += [f"warning: {study.attrs[name]}" for name in ("too_short", "unsettled") if name in study.attrs]
    if "flagged" in study.attrs:
        lines.append(f"warning: the best designs exceed validity limits: {study.attrs['flagged']}")
    if "warnings" not in study or "flag_masks" not in study.warnings.attrs:
        return lines
    attrs = study.warnings.attrs
    flags = np.concatenate([computed(chunk) for chunk in chunks(study.warnings)])
    counts = [np.count_nonzero(flags & mask) for mask in attrs["flag_masks"]]
    names = [WARNINGS.get(name, name) for name in attrs["flag_meanings"].split()]
    return lines + [f"warning: {count:,} with {name}" for count, name in zip(counts, names, strict=True) if count]


def chunks(values: xr.DataArray) -> Iterator[np.ndarray[Any, Any]]:
    """Read a variable in chunks that fit in memory."""
    if not values.ndim:
        yield values.values.reshape(1)
        return
    rows = max(1, _CHUNK_BYTES * len(values) // max(1, values.nbytes))
    for start in range(0, len(values), rows):
        yield values[start : start + rows].values


def computed(values: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return the values that are computed and finite, (n,)."""
    if values.dtype.kind == "f":
        valid = np.isfinite(values)
    else:
        valid = values != (np.iinfo(values.dtype).min if values.dtype.kind == "i" else None)
    return values[valid]  # type: ignore[no-any-return]
