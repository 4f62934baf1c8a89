"""`rattlebox show`: what is in a study on disk, and how far it is."""

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

_BYTES_AT_ONCE = 2**26
_MOST_TRIALS = 12
_PREFIXED = ("m", "s", "kg", "m/s", "m/s^2", "N", "N/m", "J", "W", "Pa", "Hz")


def show_study(path: Path) -> None:
    """Print how far a study is, its axes, the range of each result, and how its runs ended.

    Parameters
    ----------
    path
        Folder of the study.
    """
    console = terminal()
    trials = count_trials(path)
    if trials is None:
        progress = progress_of(path)
        far, some, whole = _how_far(progress), progress.done > 0, progress.done == progress.total
    else:
        far, some, whole = f"{trials:,} trials", has_map(path), has_map(path)
    study = open_study(path) if some or trials is None else None
    kind = "design" if study is None else str(study.attrs.get("study", "sweep"))
    said = "" if kind == "sweep" else f"{kind.replace('_', ' ')}, "
    console.print(Text.assemble((str(path), "bold"), f": {said}{far}"), soft_wrap=True)
    with report_damage(path):
        if study is not None:
            console.print(_axes(study))
        if study is not None and some:
            console.print(_results(study))
            if "front" in study.coords and study.front.size:
                console.print(_best(study))
            if counts := statuses(study):
                told = ", ".join(f"{count:,} {name}" for name, count in counts.items())
                console.print(f"  ended: {told}", soft_wrap=True)
            if "refused" in study.attrs:
                console.print(Text(f"  refused, as with {study.attrs['refused']}"), soft_wrap=True)
            for told in warned(study):
                console.print(f"  {told}", soft_wrap=True)
    if not whole:
        console.print("  The command that began it goes on.")


def statuses(study: xr.Dataset) -> dict[str, int]:
    """Count how the runs of a study ended.

    Parameters
    ----------
    study
        From `open_study` or `sweep`.

    Returns
    -------
    dict of str to int
        By the status's name, those that occur, in the order of their numbers.
    """
    if "status" not in study:
        return {}
    names = study.status.attrs.get("flag_meanings", "").split()
    numbers, counts = np.unique(np.concatenate([_there(part) for part in _parts(study.status)]), return_counts=True)
    return {
        names[number] if number < len(names) else f"status {number}": int(count)
        for number, count in zip(numbers, counts, strict=True)
    }


def warned(study: xr.Dataset) -> list[str]:
    """Return the warnings of a study: how many runs exceeded validity limits, and which measures lack an interval.

    Parameters
    ----------
    study
        From `open_study` or `sweep`.
    """
    short = [f"warning: {study.attrs['too_short']}"] if "too_short" in study.attrs else []
    if "warnings" not in study or "flag_masks" not in study.warnings.attrs:
        return short
    about = study.warnings.attrs
    flags = np.concatenate([_there(part) for part in _parts(study.warnings)])
    counts = [np.count_nonzero(flags & mask) for mask in about["flag_masks"]]
    names = [WARNINGS.get(name, name) for name in about["flag_meanings"].split()]
    return short + [f"warning: {count:,} with {name}" for count, name in zip(counts, names, strict=True) if count]


def _how_far(progress: Progress) -> str:
    if progress.done == progress.total:
        return f"{progress.total:,} variants, complete"
    if not progress.done:
        return f"0 of {progress.total:,} variants"
    ago = time.time() - progress.last
    since = f"{ago:.0f} s" if ago < 120 else f"{ago / 60:.0f} min" if ago < 7200 else f"{ago / 3600:.0f} h"
    share = 100 * progress.done / progress.total
    return f"{progress.done:,} of {progress.total:,} variants ({share:.0f} %), the last of them {since} ago"


def _axes(study: xr.Dataset) -> Table:
    table = Table("axis", "along", Column("values", justify="right"), "from", "to", box=SIMPLE_HEAD)
    dims = list(study.sizes)
    axes = [(name, values) for name, values in study.coords.items() if name != "front"]
    for name, values in sorted(axes, key=lambda item: ([dims.index(dim) for dim in item[1].dims], item[0] not in dims)):
        ends = [_number(value, values) for value in _ends(values.values.ravel())]
        along = ", ".join(map(str, values.dims))
        table.add_row(str(name), "" if along == name else along, f"{values.size:,}", *ends)
    return table


def _ends(values: np.ndarray[Any, Any]) -> tuple[Any, Any]:
    """The first and the last of what rises or falls, the smallest and the largest of other numbers."""
    if values.dtype.kind in "fi" and not (np.all(np.diff(values) >= 0) or np.all(np.diff(values) <= 0)):
        return values.min(), values.max()
    return values[0], values[-1]


def _best(study: xr.Dataset) -> Table:
    """The trials of a design that none beats, with their parameters and objectives."""
    names = [str(name) for name, values in study.coords.items() if values.dims == ("trial",) and name != "trial"]
    names += [str(name) for name, values in study.data_vars.items() if "goal" in values.attrs]
    right: Any = {"justify": "right"}
    table = Table(Column("best trial", **right), *(Column(name, **right) for name in names), box=SIMPLE_HEAD)
    for trial in study.front.values[:_MOST_TRIALS]:
        row = study.sel(trial=trial)
        table.add_row(f"{trial}", *(_number(row[name].values[()], study[name]) for name in names))
    if study.front.size > _MOST_TRIALS:
        table.caption = f"and {study.front.size - _MOST_TRIALS} more"
    return table


def _results(study: xr.Dataset) -> Table:
    right: Any = {"justify": "right"}
    numbers = ("smallest", "largest", "values")
    table = Table("result", "meaning", *(Column(name, **right) for name in numbers), box=SIMPLE_HEAD)
    for name, values in study.data_vars.items():
        if name not in OUTCOMES and values.dtype.kind in "fiub" and values.size:
            parts = [part for part in map(_there, _parts(values)) if part.size]
            ends = [end for part in parts for end in (part.min(), part.max())]
            shown = [_number(end, values) for end in (min(ends), max(ends))] if ends else [MISSING, MISSING]
            count = sum(part.size for part in parts)
            table.add_row(str(name), values.attrs.get("long_name", ""), *shown, f"{count:,}")
    return table


def _parts(values: xr.DataArray) -> Iterator[np.ndarray[Any, Any]]:
    """Read a variable piece by piece, so that any size fits."""
    if not values.ndim:
        yield values.values.reshape(1)
        return
    rows = max(1, _BYTES_AT_ONCE * len(values) // max(1, values.nbytes))
    for start in range(0, len(values), rows):
        yield values[start : start + rows].values


def _there(values: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """What is finished and a number, (n,)."""
    if values.dtype.kind == "f":
        there = np.isfinite(values)
    else:
        there = values != (np.iinfo(values.dtype).min if values.dtype.kind == "i" else None)
    found: np.ndarray[Any, Any] = values[there]
    return found


def _number(value: Any, of: xr.DataArray) -> str:
    if not isinstance(value, np.number):
        return str(value)
    unit = str(of.attrs.get("units", ""))
    if unit in _PREFIXED:
        return quantity(float(value), unit)
    return f"{value:,.5g}" if unit in ("", "1") else f"{value:,.5g} {unit}"
