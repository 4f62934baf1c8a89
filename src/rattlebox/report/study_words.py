"""Sentences, tables and limits that the reports about all kinds of studies share."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rattlebox._util.exceptions import RattleboxError
from rattlebox._util.phrases import counted, joined
from rattlebox._util.quantities import MISSING, amount, with_interval
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint
from rattlebox.plots.labels import REPLICA, capitalised, name_of, unit_of
from rattlebox.prepare.softening import MAX_CHANGE
from rattlebox.report.limits import ENERGY_BOUNDS, limit, mode_limits
from rattlebox.report.parts import Call, Kind, Limit, Picture, Table
from rattlebox.results.case_words import dampers_words
from rattlebox.results.schema import OUTCOMES
from rattlebox.studies.run.stored import status_counts, status_lines
from rattlebox.studies.work.measures import INTERVAL

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_MAX_AXIS_WORDS = 4
"""Most axes that a sentence lists with their ranges."""


def cases_of(study: xr.Dataset) -> Mapping[str, Case]:
    """Return the base case of a study."""
    if not isinstance(study.attrs.get("case"), str):
        raise Hint("the dataset does not hold its case", "the argument case")
    return {"": Case.from_toml(study.attrs["case"])}


def known_case(study: xr.Dataset) -> Case | None:
    """Return the base case of a study; None if the dataset does not hold it, or it cannot be read."""
    try:
        return cases_of(study)[""]
    except RattleboxError:
        return None


def system_words(study: xr.Dataset) -> str:
    """Return a phrase about the case of a study; "the system" if it is unknown."""
    case = known_case(study)
    if case is None:
        return "the system"
    dampers = dampers_words(case)
    return case.structure.words() + (f" with {dampers}" if dampers else "")


def damper_words(study: xr.Dataset) -> str:
    """Return a phrase about the dampers of a study; "the damper" if its case is unknown."""
    case = known_case(study)
    return "the damper" if case is None else dampers_words(case)


def axes_of(study: xr.Dataset) -> list[xr.DataArray]:
    """Return the coordinates that vary, without those of repeated runs."""
    repeated = replica_dims(study)
    return [
        coord
        for name, coord in study.coords.items()
        if coord.ndim == 1 and coord.size > 1 and coord.dims[0] not in repeated and str(name) not in ("front", "trial")
    ]


def replica_dims(study: xr.Dataset | xr.DataArray) -> list[str]:
    """Return the dimensions along which only the random start of the runs varies."""
    return [str(dim) for dim in study.dims if str(dim) in (REPLICA, "packing") or str(dim).rpartition(".")[2] == "seed"]


def axis_value(coord: xr.DataArray, value: Any) -> str:
    """Return a value of an axis as text with its unit."""
    return amount(float(value), unit_of(coord)) if coord.dtype.kind in "fiu" else str(value)


def axis_words(coord: xr.DataArray) -> str:
    """Return a phrase about an axis: "damper gap (5 values from 0.2 mm to 1 mm)"."""
    values = coord.values
    if values.dtype.kind not in "fiu":
        names = [str(each) for each in values]
        return f"{name_of(coord)} ({', '.join(names) if len(names) <= 4 else f'{len(names)} values'})"
    ends = f"{axis_value(coord, values.min())} to {axis_value(coord, values.max())}"
    return f"{name_of(coord)} ({coord.size} values from {ends})"


def axes_words(study: xr.Dataset) -> str:
    """Return a phrase about all axes."""
    axes = axes_of(study)
    words = [axis_words(coord) for coord in axes[:_MAX_AXIS_WORDS]]
    if len(axes) > _MAX_AXIS_WORDS:
        words.append(f"{len(axes) - _MAX_AXIS_WORDS} further parameters")
    return joined(words) if words else "its parameters"


def measures_of(study: xr.Dataset) -> list[str]:
    """Return the measures of a study: numbers over its axes, without intervals and statuses."""
    # Values over more than the axes of the study are series of a run, which have no smallest and largest variant.
    over = set(study["status"].dims) if "status" in study else None
    return [
        str(name)
        for name, values in study.data_vars.items()
        if name not in OUTCOMES
        and not str(name).endswith((INTERVAL, "_error"))
        and values.dtype.kind in "fiu"
        and values.ndim
        and (over is None or set(values.dims) <= over)
    ]


class Estimate(NamedTuple):
    """A measure and half of the width of its 95 % interval (NaN where it is unknown), over the axes of a study."""

    value: xr.DataArray
    half: xr.DataArray


def estimate(study: xr.Dataset, name: str) -> Estimate:
    """Return a measure with its 95 % interval.

    Repeated runs are averaged; the interval of their mean is that of Student. Otherwise it is the one of the time average in
    the run.
    """
    values = study[name].astype(float)
    # Infinite values, such as a loss factor at a zero of the effective mass, have neither mean nor extreme.
    values = values.where(np.isfinite(values))
    if repeated := replica_dims(values):
        from scipy.special import stdtrit

        # Half of Student's interval is t s / sqrt(n), with s^2 = n / (n - 1) times the variance that xarray returns.
        known: Any = values.count(repeated)
        freedom = np.maximum(known - 1, 1)
        half: Any = stdtrit(freedom, 0.975) * values.std(repeated, ddof=0) * np.sqrt(1 / freedom)
        return Estimate(values.mean(repeated), half.where(known > 1))
    half = study.get(f"{name}{INTERVAL}")
    return Estimate(values, values * math.nan if half is None else half)


def place_words(study: xr.Dataset, values: xr.DataArray, index: int) -> str:
    """Return the values of the axes at one place of a variable: "damper gap 0.4 mm, load amplitude 1 kN"."""
    indices = dict(zip(values.dims, np.unravel_index(index, values.shape), strict=True)) if values.ndim else {}
    words = []
    for coord in axes_of(study):
        if coord.dims[0] in indices:
            words.append(f"{name_of(coord)} {axis_value(coord, coord.values[indices[coord.dims[0]]])}")
    return ", ".join(words)


def extremes(study: xr.Dataset, name: str) -> str:
    """Return a sentence about the largest and the smallest value of a measure; empty if it has none."""
    values, half = estimate(study, name)
    numbers, halves = values.values.ravel(), np.broadcast_to(half.values, values.shape).ravel()
    if not np.isfinite(numbers).any():
        return ""
    unit, words = unit_of(study[name]), capitalised(name_of(study[name]))
    high, low = int(np.nanargmax(numbers)), int(np.nanargmin(numbers))
    if numbers[high] == numbers[low]:
        return f"{words}: {amount(float(numbers[high]), unit)} everywhere."

    def at(index: int) -> str:
        where = place_words(study, values, index)
        return with_interval(float(numbers[index]), float(halves[index]), unit) + (f" at {where}" if where else "")

    return f"{words}: at most {at(high)}; at least {at(low)}."


def progress_sentence(study: xr.Dataset) -> str:
    """Return a sentence about the variants that are not computed; empty if the study is complete."""
    if "status" not in study:
        return ""
    total = study["status"].size
    done = sum(status_counts(study).values())
    if done == total:
        return ""
    share = amount(done / total, "%", 2)
    return (
        f"The study is not finished: {done:,} of {total:,} variants ({share}) are computed, and this report is about "
        "these. The command that started it resumes it."
    )


def study_warnings(study: xr.Dataset) -> list[str]:
    """Return the warnings of a study in full: statuses other than finished, refusals, exceeded limits."""
    counts = status_counts(study)
    lines = [line for line in status_lines(study) if line.startswith(("warning", "refused"))]
    failed = {name: count for name, count in counts.items() if name != "finished"}
    if failed:
        what = ", ".join(f"{count:,} {name.replace('_', ' ')}" for name, count in failed.items())
        lines.insert(0, f"{sum(failed.values()):,} of {sum(counts.values()):,} runs have no result: {what}")
    noted = study.attrs.get("warnings", [])
    lines += [noted] if isinstance(noted, str) and noted else [str(each) for each in noted]
    return list(dict.fromkeys(lines))


def study_limits(study: xr.Dataset) -> Iterator[Limit]:
    """Yield the limits that all studies share."""
    case = known_case(study)
    if "energy_residual" in study:
        residuals = study.energy_residual.values[np.isfinite(study.energy_residual.values)]
        largest = f"{residuals.max():.1e}, largest of all runs" if residuals.size else MISSING
        yield limit("study", "energy balance", largest, "" if case is None else ENERGY_BOUNDS[case.method.kind])
    if case is not None:
        yield from mode_limits(case)
        softenings = [damper.softening for damper in case.particle_dampers if damper.softening != 1]
        if softenings:
            factors = ", ".join(factor if isinstance(factor, str) else f"{factor:g}" for factor in softenings)
            yield limit("study", "softening of contacts", factors, f"a change of the loss of {MAX_CHANGE:g} m V²")
    cycles = option_of(study, "cycles")
    if isinstance(cycles, list) and len(cycles) == 2:
        yield limit("study", "steady motion", f"{cycles[1]} cycles after {cycles[0]}")
    if repeated := replica_dims(study):
        count = math.prod(study.sizes[dim] for dim in repeated)
        yield limit("replicas", "statistical error", f"{count} random starts")
    elif case is None or case.dampers or case.stops:
        has_intervals = any(str(name).endswith(INTERVAL) for name in study.data_vars)
        intervals = "Intervals are those of time averages in one run (95 %); o" if has_intervals else "O"
        yield limit("study", "statistical error", "1 run of each variant", intervals=intervals)


def option_of(study: xr.Dataset, name: str) -> Any:
    """Return an option of a study from the attributes of its dataset, None if it is not there."""
    value = study.attrs.get(name)
    if isinstance(value, str):
        with suppress(ValueError):  # a name, not JSON
            value = json.loads(value)
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def measure_table(study: xr.Dataset, names: Sequence[str]) -> Table:
    """Return a table of the smallest and largest value of each measure."""
    rows = []
    for name in names:
        values, _ = estimate(study, name)
        numbers, unit = values.values, unit_of(study[name])
        known = numbers[np.isfinite(numbers)]
        ends = [amount(float(end), unit) for end in (known.min(), known.max())] if known.size else [MISSING, MISSING]
        rows.append((name_of(study[name]), *ends, f"{known.size:,}"))
    return Table("Results", ("measure", "smallest", "largest", "values"), rows, numbers=True)


def axis_table(study: xr.Dataset) -> Table:
    """Return a table of the axes of a study."""
    rows = []
    repeated = replica_dims(study)
    for name, coord in study.coords.items():
        if coord.ndim != 1 or str(name) in ("front", "trial"):
            continue
        values = coord.values
        if values.dtype.kind in "fiu":
            text = f"{axis_value(coord, values.min())} to {axis_value(coord, values.max())}" if values.size else MISSING
        else:
            text = ", ".join(map(str, values[:6])) + (" ..." if values.size > 6 else "")
        kind = "random start" if coord.dims[0] in repeated else name_of(coord)
        rows.append((str(name), kind, text, counted(coord.size, "value")))
    return Table("What varies", ("axis", "meaning", "range", "number"), rows)


def study_about(study: xr.Dataset) -> Iterator[str]:
    """Yield the version that computed a study, and when."""
    attrs = study.attrs
    if "version" in attrs:
        created = f", started on {str(attrs['created'])[:16].replace('T', ' ')} UTC" if "created" in attrs else ""
        yield f"Computed by Rattlebox {attrs['version']}{created}."


def picture(draw: Callable[..., Figure], caption: str) -> Callable[[xr.Dataset], list[Picture]]:
    """Return a function that gives a study its only figure."""
    return lambda study: [Picture(caption, partial(draw, study, size="page"))]


def study_kind(
    name: str,
    question: Callable[[xr.Dataset], str],
    answer: Callable[[xr.Dataset], Iterable[str]],
    call: Callable[[xr.Dataset], Call | None],
    pictures: Callable[[xr.Dataset], Iterable[Picture]],
    **others: Callable[[xr.Dataset], Any],
) -> Kind[xr.Dataset]:
    """Return the content of the report about a kind of study; parts that are left out are those of all studies."""
    shared: dict[str, Callable[[xr.Dataset], Any]] = {
        "cases": cases_of,
        "tables": lambda study: [axis_table(study)],
        "warnings": study_warnings,
        "limits": study_limits,
        "about": study_about,
    }

    def full_answer(study: xr.Dataset) -> Iterator[str]:
        if unfinished := progress_sentence(study):
            yield unfinished
        yield from answer(study)

    return Kind(name=name, question=question, answer=full_answer, call=call, pictures=pictures, **(shared | others))
