"""`rattlebox show`: what is in a study on disk, and how far it is."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Column, Table

from rattlebox.results.quantities import quantity
from rattlebox.studies.design import trials_in
from rattlebox.studies.store import Progress, has_map, open_study, progress_of, readable

if TYPE_CHECKING:
    import xarray as xr

_BYTES_AT_ONCE = 2**26
_PREFIXED = ("m", "s", "m/s", "m/s^2", "N", "N/m", "J", "W", "Pa", "Hz")


def show_study(path: Path) -> None:
    """Print how far a study is, its axes, the range of each result, and how its runs ended.

    Parameters
    ----------
    path
        Folder of the study.
    """
    console = Console(highlight=False)
    trials = trials_in(path)
    if trials is None:
        progress = progress_of(path)
        far, some, whole = _how_far(progress), progress.done > 0, progress.done == progress.total
    else:
        far, some, whole = f"{trials:,} trials", has_map(path), has_map(path)
    study = open_study(path) if some or trials is None else None
    kind = "design" if study is None else str(study.attrs.get("study", "sweep"))
    said = "" if kind == "sweep" else f"{kind.replace('_', ' ')}, "
    console.print(f"[bold]{path}[/bold]: {said}{far}", soft_wrap=True)
    with readable(path):
        if study is not None:
            console.print(_axes(study))
        if study is not None and some:
            console.print(_results(study))
            if counts := statuses(study):
                told = ", ".join(f"{count:,} {name}" for name, count in counts.items())
                console.print(f"  ended: {told}", soft_wrap=True)
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
    for name, values in sorted(study.coords.items(), key=lambda item: [dims.index(dim) for dim in item[1].dims]):
        ends = [_number(values.values.flat[i], values) for i in (0, -1)]
        along = ", ".join(map(str, values.dims))
        table.add_row(str(name), "" if along == name else along, f"{values.size:,}", *ends)
    return table


def _results(study: xr.Dataset) -> Table:
    right: Any = {"justify": "right"}
    table = Table("result", "meaning", Column("smallest", **right), Column("largest", **right), box=SIMPLE_HEAD)
    for name, values in study.data_vars.items():
        if name != "status" and values.dtype.kind in "fiub":
            ends = [end for part in map(_there, _parts(values)) if part.size for end in (part.min(), part.max())]
            shown = [_number(end, values) for end in (min(ends), max(ends))] if ends else []
            table.add_row(str(name), values.attrs.get("long_name", ""), *shown)
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
