"""`rattlebox show` of a study on disk: its progress, axes and results."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.table import Column, Table
from rich.text import Text

from rattlebox.cli.terminal import terminal
from rattlebox.prepare.time_step import WARNINGS
from rattlebox.results.quantities import MISSING, quantity
from rattlebox.results.schema import OUTCOMES
from rattlebox.studies.stored import Progress, has_map, open_study, progress_of, report_damage
from rattlebox.studies.trial_store import count_trials

if TYPE_CHECKING:
    import xarray as xr

_CHUNK_BYTES = 2**26
_MAX_TRIALS = 12
_PREFIXED_UNITS = ("m", "s", "kg", "m/s", "m/s^2", "N", "N/m", "J", "W", "Pa", "Hz")


def show_study(path: Path) -> None:
    """Print the progress of a study, its axes, the range of each result, and the status of its runs.

    Parameters
    ----------
    path
        Folder of the study.
    """
    console = terminal()
    trials = count_trials(path)
    if trials is None:
        state = progress_of(path)
        progress, has_results, complete = _progress_text(state), state.done > 0, state.done == state.total
    else:
        progress, has_results, complete = f"{trials:,} trials", has_map(path), has_map(path)
    study = open_study(path) if has_results or trials is None else None
    kind = "design" if study is None else str(study.attrs.get("study", "sweep"))
    prefix = "" if kind == "sweep" else f"{kind.replace('_', ' ')}, "
    console.print(Text.assemble((str(path), "bold"), f": {prefix}{progress}"), soft_wrap=True)
    with report_damage(path):
        if study is not None:
            console.print(_axis_table(study))
        if study is not None and has_results:
            console.print(_result_table(study))
            if "front" in study.coords and study.front.size:
                console.print(_trial_table(study))
            for line in status_lines(study):
                console.print(Text(f"  {line}"), soft_wrap=True)
    if not complete:
        console.print("  The study is not finished; repeat the command that started it to resume.", soft_wrap=True)


def status_lines(study: xr.Dataset) -> list[str]:
    """Return lines with the statuses of the runs of a study, the reason of a refusal, and the warnings.

    Parameters
    ----------
    study
        Dataset from `open_study` or `sweep`.

    Returns
    -------
    list of str
        Empty for a study without statuses and warnings.
    """
    lines = []
    if counts := status_counts(study):
        statuses = ", ".join(f"{count:,} {name}" for name, count in counts.items())
        lines.append(f"{sum(counts.values()):,} variants: {statuses}")
    if "refused" in study.attrs:
        lines.append(f"refused, for example with {study.attrs['refused']}")
    return [*lines, *warning_lines(study)]


def status_counts(study: xr.Dataset) -> dict[str, int]:
    """Count the runs of a study by their status.

    Parameters
    ----------
    study
        Dataset from `open_study` or `sweep`.

    Returns
    -------
    dict of str to int
        Number of runs by the name of the status, in the order of the status codes.
    """
    if "status" not in study:
        return {}
    names = study.status.attrs.get("flag_meanings", "").split()
    numbers, counts = np.unique(np.concatenate([_finite(chunk) for chunk in _chunks(study.status)]), return_counts=True)
    return {
        names[number] if number < len(names) else f"status {number}": int(count)
        for number, count in zip(numbers, counts, strict=True)
    }


def warning_lines(study: xr.Dataset) -> list[str]:
    """Return the warnings of a study: measures without an interval, and runs that exceeded validity limits.

    Parameters
    ----------
    study
        Dataset from `open_study` or `sweep`.

    Returns
    -------
    list of str
        One line for each validity limit that at least one run exceeded, after a line about short runs.
    """
    lines = [f"warning: {study.attrs['too_short']}"] if "too_short" in study.attrs else []
    if "warnings" not in study or "flag_masks" not in study.warnings.attrs:
        return lines
    attrs = study.warnings.attrs
    flags = np.concatenate([_finite(chunk) for chunk in _chunks(study.warnings)])
    counts = [np.count_nonzero(flags & mask) for mask in attrs["flag_masks"]]
    names = [WARNINGS.get(name, name) for name in attrs["flag_meanings"].split()]
    return lines + [f"warning: {count:,} with {name}" for count, name in zip(counts, names, strict=True) if count]


def _progress_text(progress: Progress) -> str:
    if progress.done == progress.total:
        return f"{progress.total:,} variants, complete"
    if not progress.done:
        return f"0 of {progress.total:,} variants"
    age = time.time() - progress.last
    since = f"{age:.0f} s" if age < 120 else f"{age / 60:.0f} min" if age < 7200 else f"{age / 3600:.0f} h"
    share = 100 * progress.done / progress.total
    return f"{progress.done:,} of {progress.total:,} variants ({share:.0f} %), the last one {since} ago"


def _axis_table(study: xr.Dataset) -> Table:
    table = Table("axis", "along", Column("values", justify="right"), "from", "to", box=SIMPLE_HEAD)
    dims = list(study.sizes)
    axes = [(name, values) for name, values in study.coords.items() if name != "front"]
    for name, values in sorted(axes, key=lambda item: ([dims.index(dim) for dim in item[1].dims], item[0] not in dims)):
        ends = [_format(value, values) for value in _ends(values.values.ravel())]
        along = ", ".join(map(str, values.dims))
        table.add_row(str(name), "" if along == name else along, f"{values.size:,}", *ends)
    return table


def _ends(values: np.ndarray[Any, Any]) -> tuple[Any, Any]:
    """Return the first and last value of a monotonic axis or of names, the smallest and largest of other numbers."""
    if values.dtype.kind in "fi" and not (np.all(np.diff(values) >= 0) or np.all(np.diff(values) <= 0)):
        return values.min(), values.max()
    return values[0], values[-1]


def _trial_table(study: xr.Dataset) -> Table:
    """Return the Pareto-optimal trials of a design with their parameters and objectives."""
    names = [str(name) for name, values in study.coords.items() if values.dims == ("trial",) and name != "trial"]
    names += [str(name) for name, values in study.data_vars.items() if "goal" in values.attrs]
    right: Any = {"justify": "right"}
    table = Table(Column("best trial", **right), *(Column(name, **right) for name in names), box=SIMPLE_HEAD)
    for trial in study.front.values[:_MAX_TRIALS]:
        row = study.sel(trial=trial)
        table.add_row(f"{trial}", *(_format(row[name].values[()], study[name]) for name in names))
    if study.front.size > _MAX_TRIALS:
        table.caption = f"and {study.front.size - _MAX_TRIALS} more"
    return table


def _result_table(study: xr.Dataset) -> Table:
    right: Any = {"justify": "right"}
    numbers = ("smallest", "largest", "values")
    table = Table("result", "meaning", *(Column(name, **right) for name in numbers), box=SIMPLE_HEAD)
    for name, values in study.data_vars.items():
        if name not in OUTCOMES and values.dtype.kind in "fiub" and values.size:
            chunks = [chunk for chunk in map(_finite, _chunks(values)) if chunk.size]
            ends = [end for chunk in chunks for end in (chunk.min(), chunk.max())]
            cells = [_format(end, values) for end in (min(ends), max(ends))] if ends else [MISSING, MISSING]
            count = sum(chunk.size for chunk in chunks)
            table.add_row(str(name), values.attrs.get("long_name", ""), *cells, f"{count:,}")
    return table


def _chunks(values: xr.DataArray) -> Iterator[np.ndarray[Any, Any]]:
    """Read a variable in chunks that fit in memory."""
    if not values.ndim:
        yield values.values.reshape(1)
        return
    rows = max(1, _CHUNK_BYTES * len(values) // max(1, values.nbytes))
    for start in range(0, len(values), rows):
        yield values[start : start + rows].values


def _finite(values: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return the values that are computed and finite, (n,)."""
    if values.dtype.kind == "f":
        valid = np.isfinite(values)
    else:
        valid = values != (np.iinfo(values.dtype).min if values.dtype.kind == "i" else None)
    return values[valid]  # type: ignore[no-any-return]


def _format(value: Any, variable: xr.DataArray) -> str:
    """Return a value of a variable as text with its unit."""
    if not isinstance(value, np.number):
        return str(value)
    unit = str(variable.attrs.get("units", ""))
    if unit in _PREFIXED_UNITS:
        return quantity(float(value), unit)
    return f"{value:,.5g}" if unit in ("", "1") else f"{value:,.5g} {unit}"
