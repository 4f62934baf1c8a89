"""`rattlebox show` of a study on disk: its progress, axes and results."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from rich.box import SIMPLE_HEAD
from rich.table import Column, Table
from rich.text import Text

from rattlebox._util.quantities import MISSING, PREFIXED_UNITS, quantity
from rattlebox.cli.terminal import terminal
from rattlebox.results.schema import OUTCOMES
from rattlebox.studies.design.trials import count_trials, open_trials
from rattlebox.studies.run.stored import (
    Progress,
    chunks,
    computed,
    has_map,
    open_study,
    partial_file,
    progress_of,
    report_damage,
    started_with,
    status_lines,
)
from rattlebox.studies.work.measures import INTERVAL

if TYPE_CHECKING:
    import xarray as xr

_MAX_TRIALS = 12


def show_study(path: Path) -> None:
    """Print the progress of a study, its axes, the range of each result, and the status of its runs."""
    console = terminal()
    # A design has trials, whose number is not known before; other studies have variants, whose number is.
    trials = count_trials(path)
    if trials is None:
        progress, has_results, complete = _state_of(path)
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
                console.print(_trial_table(study, "best trial", study.front.values[:_MAX_TRIALS], study.front.size))
            for line in status_lines(study):
                console.print(Text(f"  {line}"), soft_wrap=True)
        if trials and not complete and (so_far := open_trials(path)) is not None:
            latest = so_far.trial.values[-_MAX_TRIALS:]
            console.print(_trial_table(so_far, "trial", latest, so_far.trial.size))
    if not complete:
        line = f"  The study is not finished; repeat the command that started it{started_with(path)} to resume."
        console.print(line, soft_wrap=True)


def _state_of(path: Path) -> tuple[str, bool, bool]:
    """Return the progress of a study in words, whether it has results, and whether it is complete."""
    if path.is_file():  # the file of a result
        return "complete", True, True
    state = progress_of(path)
    complete = state.done == state.total
    if state.is_whole:
        return ("complete" if complete else "in progress"), complete or partial_file(path).is_file(), complete
    return _progress_text(state), state.done > 0, complete


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


def _ends(values: NDArray[Any]) -> tuple[Any, Any]:
    """Return the first and last value of a monotonic axis or of names, the smallest and largest of other numbers."""
    if values.dtype.kind in "fi" and not (np.all(np.diff(values) >= 0) or np.all(np.diff(values) <= 0)):
        return values.min(), values.max()
    return values[0], values[-1]


def _trial_table(study: xr.Dataset, heading: str, trials: NDArray[Any], total: int) -> Table:
    """Return some trials of a design with their parameters and objectives, and the reasons of those without."""
    names = [str(name) for name, values in study.coords.items() if values.dims == ("trial",) and name != "trial"]
    names += [str(name) for name, values in study.data_vars.items() if "goal" in values.attrs]
    names += ["reason"] if study.reason.sel(trial=trials).values.astype(bool).any() else []
    right: Any = {"justify": "right"}
    table = Table(Column(heading, **right), *(Column(name, **right) for name in names), box=SIMPLE_HEAD)
    for trial in trials:
        row = study.sel(trial=trial)
        table.add_row(f"{trial}", *(_with_interval(row, name) for name in names))
    if total > trials.size:
        table.caption = f"and {total - trials.size} more"
    return table


def _with_interval(row: xr.Dataset, name: str) -> str:
    """Return a parameter or an objective of a trial as text, with its interval if there is one."""
    half = row.get(name + INTERVAL)
    text = _format(row[name].values[()], row[name])
    return text if half is None or not np.isfinite(half) else f"{text} ± {_format(half.values[()], half)}"


def _result_table(study: xr.Dataset) -> Table:
    right: Any = {"justify": "right"}
    numbers = ("smallest", "largest", "values")
    table = Table("result", "meaning", *(Column(name, **right) for name in numbers), box=SIMPLE_HEAD)
    for name, values in study.data_vars.items():
        if name not in OUTCOMES and values.dtype.kind in "fiub" and values.size:
            parts = [chunk for chunk in map(computed, chunks(values)) if chunk.size]
            ends = [end for part in parts for end in (part.min(), part.max())]
            cells = [_format(end, values) for end in (min(ends), max(ends))] if ends else [MISSING, MISSING]
            count = sum(part.size for part in parts)
            table.add_row(str(name), values.attrs.get("long_name", ""), *cells, f"{count:,}")
    return table


def _format(value: object, variable: xr.DataArray) -> str:
    """Return a value of a variable as text with its unit."""
    if not isinstance(value, np.number):
        return " ".join(str(value).split())
    if np.isnan(value):
        return MISSING
    unit = str(variable.attrs.get("units", ""))
    if unit in PREFIXED_UNITS:
        return quantity(float(value), unit)
    return f"{value:,.5g}" if unit in ("", "1") else f"{value:,.5g} {unit}"
