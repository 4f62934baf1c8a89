"""Report about a sweep, and about every study whose kind has no report of its own."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.phrases import joined
from rattlebox.plots.labels import name_of
from rattlebox.plots.maps import plot_map
from rattlebox.report import study_words as words
from rattlebox.report.parts import Call, Kind, Picture, Table
from rattlebox.results.case_words import dampers_words

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_MAX_PICTURES = 6


def system_words(study: xr.Dataset) -> str:
    """Return a phrase about the case of a study; "the system" if it is unknown."""
    try:
        case = next(iter(words.cases_of(study).values()))
    except ValueError:  # CaseError
        return "the system"
    dampers = dampers_words(case)
    return case.structure.words() + (f" with {dampers}" if dampers else "")


def _question(study: xr.Dataset) -> str:
    names = [name_of(study[name]) for name in words.measures_of(study)[:3]] or ["the result"]
    do = "does" if len(names) == 1 else "do"
    return f"How {do} the {joined(names)} of {system_words(study)} depend on {words.axes_words(study)}?"


def _answer(study: xr.Dataset) -> Iterator[str]:
    if unfinished := words.progress_sentence(study):
        yield unfinished
    for name in words.measures_of(study)[:_MAX_PICTURES]:
        if sentence := words.extremes(study, name):
            yield sentence
    if words.replica_dims(study):
        yield "Intervals (±) are 95 % intervals of the mean over the random starts."
    elif any(str(name).endswith("_interval") for name in study.data_vars):
        yield "Intervals (±) are 95 % intervals of the time average in one run."


def _pictures(study: xr.Dataset) -> Iterator[Picture]:
    for name in words.measures_of(study)[:_MAX_PICTURES]:
        values = study[name]
        long = [str(dim) for dim in values.dims if study.sizes[dim] > 1]
        if not long or "sample" in long or not np.isfinite(values.values).any():
            continue
        yield Picture(*_map(study, name, long))


def _map(study: xr.Dataset, name: str, dims: list[str]) -> tuple[str, Any]:
    """Return the caption and the function that draws a measure, at the best place of any further axes."""
    repeated = words.replica_dims(study[name])
    free = sorted((dim for dim in dims if dim not in repeated), key=lambda dim: -study.sizes[dim])
    shown, fixed = free[:2], free[2:]
    caption = f"{words.capitalised(name_of(study[name]))} over {joined([name_of(study[dim]) for dim in shown])}"
    values, _ = words.estimate(study, name)
    at: dict[str, Any] = {}
    if fixed:
        index = np.unravel_index(int(np.nanargmax(values.values)), values.shape)
        at = {dim: study[dim].values[index[values.dims.index(dim)]] for dim in fixed}
        caption += ", at " + joined([f"{name_of(study[dim])} {words.axis_value(study[dim], at[dim])}" for dim in fixed])
    caption += "; bands show the scatter of the random starts." if repeated and len(shown) == 1 else "."
    if len(shown) > 1 and repeated:
        caption = caption.removesuffix(".") + "; median of the random starts."
    return caption, partial(_draw, study, name, at)


def _draw(study: xr.Dataset, name: str, at: dict[str, Any]) -> Figure:
    return plot_map(study, name, at=at, size="page")


def _tables(study: xr.Dataset) -> Iterator[Table]:
    yield words.axis_table(study)
    yield words.measure_table(study, words.measures_of(study))


def axes_argument(study: xr.Dataset) -> dict[str, Any] | None:
    """Return the axes of a study as its function takes them; None if the dataset does not hold them."""
    try:
        design = json.loads(study.attrs["design"])
    except (KeyError, TypeError, ValueError):
        return None
    axes: dict[str, Any] = {}
    for path, column in design["columns"].items():
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
        value = words.option_of(study, name)
        if value not in (None, False, 0, 0.0, "null", []):
            options[name] = value
    return options


def measures_argument(study: xr.Dataset, usual: Sequence[str] = ()) -> tuple[list[str], tuple[str, ...]]:
    """Return the measures of a study as its function takes them, and a remark for each function of the user."""
    given = [each for each in options_of(study, "measures").get("measures", []) if each not in usual]
    functions = [each.partition(" ")[0] for each in given if " " in each]
    remarks = tuple(f"{name} is a function of yours: add it to measure" for name in functions)
    return [each for each in given if " " not in each], remarks


def _call(study: xr.Dataset) -> Call | None:
    axes = axes_argument(study)
    if axes is None or study.attrs.get("study", "sweep") != "sweep":
        return None
    measures, remarks = measures_argument(study)
    options = options_of(study, "skip", "cycles", "samples", "point", "motion", "last")
    return Call("sweep", {"axes": axes, "measure": measures, **options}, "" if remarks else "sweep", remarks)


KIND = Kind(
    name="Study",
    cases=words.cases_of,
    question=_question,
    answer=_answer,
    call=_call,
    pictures=_pictures,
    tables=_tables,
    warnings=words.study_warnings,
    limits=words.study_limits,
    about=words.study_about,
)
