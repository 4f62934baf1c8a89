"""Report about a sweep, and about every study whose kind has no report of its own."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.phrases import joined
from rattlebox.plots.labels import capitalised, name_of
from rattlebox.plots.maps import plot_map
from rattlebox.report import study_words as words
from rattlebox.report.arguments import axes_argument, measures_argument, options_of
from rattlebox.report.parts import Call, Picture, Table

if TYPE_CHECKING:
    import xarray as xr

_MAX_PICTURES = 6


def _question(study: xr.Dataset) -> str:
    names = [name_of(study[name]) for name in words.measures_of(study)[:3]] or ["the result"]
    do = "does" if len(names) == 1 else "do"
    return f"How {do} the {joined(names)} of {words.system_words(study)} depend on {words.axes_words(study)}?"


def _answer(study: xr.Dataset) -> Iterator[str]:
    for name in words.measures_of(study)[:_MAX_PICTURES]:
        if sentence := words.extremes(study, name):
            yield sentence
    if words.replica_dims(study):
        yield "Intervals (±) are 95 % intervals of the mean over the random starts."
    elif any(str(name).endswith("_interval") for name in study.data_vars):
        yield "Intervals (±) are 95 % intervals of the time average in one run."


def _pictures(study: xr.Dataset) -> Iterator[Picture]:
    for name in words.measures_of(study)[:_MAX_PICTURES]:
        dims = [str(dim) for dim in study[name].dims if study.sizes[dim] > 1]
        if dims and "sample" not in dims and np.isfinite(study[name].values).any():
            yield _picture(study, name, dims)


def _picture(study: xr.Dataset, name: str, dims: list[str]) -> Picture:
    """Return the figure of a measure over its two longest axes, at the best place of any further axes."""
    repeated = words.replica_dims(study[name])
    # Two axes fit in a figure. The others are held where the measure is largest, which the caption states.
    free = sorted((dim for dim in dims if dim not in repeated), key=lambda dim: -study.sizes[dim])
    shown, fixed = free[:2], free[2:]
    caption = f"{capitalised(name_of(study[name]))} over {joined([name_of(study[dim]) for dim in shown])}"
    at: dict[str, Any] = {}
    if fixed:
        values = words.estimate(study, name).value
        index = np.unravel_index(int(np.nanargmax(values.values)), values.shape)
        at = {dim: study[dim].values[index[values.dims.index(dim)]] for dim in fixed}
        caption += ", at " + joined([f"{name_of(study[dim])} {words.axis_value(study[dim], at[dim])}" for dim in fixed])
    scatter = "bands show the scatter" if len(shown) == 1 else "median"
    caption += f"; {scatter} of the random starts." if repeated else "."
    return Picture(caption, partial(plot_map, study, name, at=at, size="page"))


def _tables(study: xr.Dataset) -> Iterator[Table]:
    yield words.axis_table(study)
    yield words.measure_table(study, words.measures_of(study))


def _call(study: xr.Dataset) -> Call | None:
    axes = axes_argument(study)
    if axes is None or study.attrs.get("study", "sweep") != "sweep":
        return None
    measures, remarks = measures_argument(study)
    options = options_of(study, "skip", "cycles", "samples", "point", "motion", "last")
    return Call("sweep", {"axes": axes, "measure": measures, **options}, "" if remarks else "sweep", remarks)


KIND = words.study_kind("Study", _question, _answer, _call, _pictures, tables=_tables)
