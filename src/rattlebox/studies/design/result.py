"""Dataset of the trials of a design search and of its Pareto front."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.flags import flag_masks
from rattlebox.studies.design.ends import AT_END, end_note
from rattlebox.studies.design.evidence import (
    CYCLES_RUN,
    DROPPED,
    PACKINGS_RUN,
    deciding_note,
    order_note,
    with_curves,
    with_order,
)
from rattlebox.studies.design.search import FLAGS, PACKING, DesignSearch, Vector
from rattlebox.studies.design.space import ADDED_MASS, pareto_front
from rattlebox.studies.work.measures import INTERVAL

if TYPE_CHECKING:
    import xarray as xr

_REASONS = 3
"""Number of reasons that the warning about a search without a feasible trial lists."""


def result_of(search: DesignSearch, trials: Sequence[Any]) -> xr.Dataset:
    """Return the dataset of all trials and of the Pareto front."""
    import xarray as xr

    about = {name: value if isinstance(value, str) else json.dumps(value) for name, value in search.describe().items()}
    found = xr.Dataset(attrs={"title": "Rattlebox design", **about})
    # Coordinates of the trials: the values of the parameters.
    for variable in search.variables:
        columns = variable.coordinates([trial.params[variable.name] for trial in trials])
        found = found.assign_coords({path: ("trial", *column) for path, column in columns.items()})
    values = _rows([trial.values for trial in trials], len(search.objectives))
    halves = _rows([trial.user_attrs["intervals"] for trial in trials], len(search.computed))
    packings = padded([trial.user_attrs["packings"] for trial in trials], search.count, len(search.computed))
    # The added mass follows from the case, so that it has neither an interval nor packings.
    for number, each in enumerate(search.objectives):
        attrs = each.attributes
        found[each.name] = ("trial", values[:, number], each.attributes_with_goal)
        if each.name == ADDED_MASS:
            continue
        own = search.computed.index(each)
        text = attrs["long_name"]
        width = attrs | {"long_name": f"half of the 95 % interval, {text}"}
        found[each.name + INTERVAL] = ("trial", halves[:, own], width)
        if search.count > 1:
            single = attrs | {"long_name": f"{text}, each packing"}
            found[f"{each.name}_packings"] = (("trial", PACKING), packings[:, own], single)
    if search.count > 1:
        found = found.assign_coords({PACKING: np.arange(search.count)})
    # What limits, runs and their warnings say about each trial.
    mass = np.array([trial.user_attrs[ADDED_MASS] for trial in trials], dtype=float)
    attrs = {"units": "kg", "long_name": "added mass"}
    found[ADDED_MASS] = ("trial", mass, found[ADDED_MASS].attrs | attrs if ADDED_MASS in found else attrs)
    missing = np.array([trial.constraints["missing"] for trial in trials])
    found["missing"] = ("trial", missing, {"units": "1", "long_name": "share of the runs without a value"})
    feasible = np.array([trial.values is not None for trial in trials], bool)
    found["feasible"] = ("trial", feasible, {"long_name": "within the limits, with a value of each run"})
    flags = {"long_name": "exceeded validity limits", **flag_masks(FLAGS)}
    exceeded = np.array([trial.user_attrs["warnings"] for trial in trials], np.int8)
    found["warnings"] = ("trial", exceeded, flags)
    reasons = np.array([trial.user_attrs["reason"] for trial in trials], dtype=object)
    found["reason"] = ("trial", reasons, {"long_name": "why a trial is not feasible"})
    # Trials that may end early have run different numbers of packings and cycles.
    if search.drop or search.precision is not None:
        dropped = np.array([trial.user_attrs[DROPPED] for trial in trials], bool)
        found[DROPPED] = "trial", dropped, {"long_name": "ended early, because certainly worse than another trial"}
        ran = {"units": "1", "long_name": "number of packings that ran"}
        found[PACKINGS_RUN] = "trial", [trial.user_attrs["ran"] for trial in trials], ran
    if search.parts:
        cycles = {"units": "1", "long_name": "number of cycles of each run, before those until it is steady"}
        found[CYCLES_RUN] = "trial", [trial.user_attrs["cycles"] for trial in trials], cycles
    # The front last: it ignores trials that are not feasible.
    front = pareto_front(values * np.array([each.sign for each in search.objectives]), feasible)
    if notes := [_exceeded(number, exceeded[number]) for number in front if exceeded[number]]:
        found.attrs["flagged"] = "; ".join(notes)
    cases = np.array([search.case_file(trials[number].params) for number in front], dtype=object)
    found = found.assign_coords(trial=np.arange(len(trials))).assign(
        front=("front", front, {"long_name": "number of the trial"}),
        case=("front", cases, {"long_name": "case file"}),
    )
    return _with_evidence(search, found, trials)


def _with_evidence(search: DesignSearch, found: xr.Dataset, trials: Sequence[Any]) -> xr.Dataset:
    """Return a result with the damping curves, the trials that may be best, and notes about both."""
    found = with_order(found, [each.sign for each in search.objectives])
    if search.curve is not None:
        levels = search.curve_levels
        shape = len(levels), len(search.curve.amplitudes)
        stored = [trial.user_attrs["curves"] or (None, None, None) for trial in trials]
        ratios, halves, bare = zip(*stored, strict=True) if stored else ((), (), ())
        found = with_curves(
            found,
            padded(ratios, search.count, *shape),
            _rows(halves, *shape),
            _rows(bare, len(levels)),
            search.curve.amplitudes,
            levels,
            [np.shape(each)[-1] if each is not None else search.count for each in ratios],
        )
        if search.frequency is not None:
            found.attrs["frequency"] = search.frequency
    if not found.front.size:
        found.attrs["warnings"] = [_none_feasible([str(reason) for reason in found.reason.values])]
    elif note := deciding_note(found):
        found.attrs["warnings"] = [note]  # nothing is ranked, so that no parameter has a best value
    elif note := end_note(search, found, search.case_of(trials[int(found.front[0])].params)):
        found.attrs[AT_END] = note
    if note := order_note(found):
        found.attrs["order"] = note
    # xarray prints the first attributes only: remarks stand before the description of the search.
    remarks = {name: found.attrs[name] for name in ("title", "order", AT_END) if name in found.attrs}
    found.attrs = remarks | found.attrs
    return found


def _none_feasible(reasons: Sequence[str]) -> str:
    """Return a warning about a search without a feasible trial, with the most frequent reasons."""
    counts = Counter(reason.replace("\n", " ") for reason in reasons).most_common()
    shown = "; ".join(
        f"{count:,} of {len(reasons):,}: {' '.join(reason.split())}" for reason, count in counts[:_REASONS]
    )
    more = f"; and {len(counts) - _REASONS} more reasons" if len(counts) > _REASONS else ""
    return f"warning: no trial is feasible, and the result has no design ({shown}{more})"


def _exceeded(trial: int, warnings: int) -> str:
    """Return the validity limits that a trial exceeds."""
    return f"trial {trial}: {', '.join(text for bit, text in enumerate(FLAGS.values()) if warnings & 2**bit)}"


def _rows(rows: Sequence[object], *shape: int) -> Vector:
    """Return lists of numbers as an array; NaN for None."""
    nothing = np.full(shape, np.nan)
    return np.array([nothing if row is None else np.asarray(row, float).reshape(shape) for row in rows]).reshape(
        len(rows), *shape
    )


def padded(rows: Sequence[Any], count: int, *shape: int) -> Vector:
    """Return lists of numbers of some packings, (*shape, P), as an array of all `count` packings; NaN for the others."""
    array = np.full((len(rows), *shape, count), np.nan)
    for values, row in zip(array, rows, strict=True):
        if row is not None and np.size(row):
            known = np.array(row, float)
            values[..., : known.shape[-1]] = known
    return array
