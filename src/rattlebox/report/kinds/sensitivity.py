"""Report about a sensitivity analysis."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.phrases import joined
from rattlebox._util.quantities import amount
from rattlebox.plots.sensitivity import plot_sensitivity
from rattlebox.report import study_words as words
from rattlebox.report.arguments import measures_argument, options_of
from rattlebox.report.limits import limit
from rattlebox.report.parts import Call, Limit, Table
from rattlebox.studies.work.measures import MEASURES

if TYPE_CHECKING:
    import xarray as xr


def _question(study: xr.Dataset) -> str:
    measures = joined([str(name).replace("_", " ") for name in study.measure.values])
    return (
        f"Which of {joined([str(path) for path in study.parameter.values])} cause the variation of {measures} of "
        f"{words.system_words(study)}?"
    )


def _answer(study: xr.Dataset) -> Iterator[str]:
    level = amount(float(study.attrs.get("confidence", 0.95)), "%")
    for name in study.measure.values:
        row = study.sel(measure=name)
        order = np.argsort(-row.total.values)
        parts = [
            f"{row.parameter.values[k]} {row.total.values[k]:.2f} ± {row.total_confidence.values[k]:.2f}"
            for k in order[:3]
        ]
        yield (
            f"Of the variance of {str(name).replace('_', ' ')}, the total shares are {joined(parts)} ({level} intervals); "
            f"its mean is {amount(float(row['mean']), _unit(str(name)))}."
        )


def _unit(name: str) -> str:
    """Return the unit of a measure, "" for pure numbers and for functions of the user."""
    unit = MEASURES[name].units if name in MEASURES else ""
    return "" if unit == "1" else unit


def _tables(study: xr.Dataset) -> Iterator[Table]:
    rows = []
    for name in study.measure.values:
        for path in study.parameter.values:
            cell = study.sel(measure=name, parameter=path)
            first = f"{float(cell['first']):.3f} ± {float(cell.first_confidence):.3f}"
            rows.append((str(name), str(path), first, f"{float(cell.total):.3f} ± {float(cell.total_confidence):.3f}"))
    yield Table("Sobol indices", ("measure", "parameter", "alone", "with interactions"), rows, numbers=True)


def _limits(study: xr.Dataset) -> Iterator[Limit]:
    left = int(study.left_out.max()) if "left_out" in study else 0
    yield limit("sensitivity", "sampling", f"{study.attrs.get('n', '?')} base points, {left} left out")
    yield from words.study_limits(study)


def _call(study: xr.Dataset) -> Call | None:
    bounds, grid = (words.option_of(study, name) for name in ("bounds", "design"))
    if bounds is None or grid is None:
        return None
    measures, remarks = measures_argument(study)
    averaged = [path for path, column in grid["columns"].items() if column["varies_along"] != ["sample"]]
    if averaged:
        remarks += (f"levels and starts: add those of {joined(averaged)}",)
    options = options_of(study, "log", "confidence", "seed", "skip", "cycles", "samples", "point")
    arguments = {"bounds": bounds, "measure": measures, "n": int(study.attrs["n"]), **options}
    return Call("sensitivity", arguments, "" if remarks else "sensitivity", remarks)


KIND = words.study_kind(
    "Sensitivity",
    _question,
    _answer,
    _call,
    words.picture(
        plot_sensitivity, "Share of the variance that each parameter causes alone, and with its interactions."
    ),
    tables=_tables,
    limits=_limits,
)
