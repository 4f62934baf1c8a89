"""Report about a design search."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.phrases import counted, joined
from rattlebox._util.quantities import amount, with_interval
from rattlebox.model.case import Case
from rattlebox.plots.damping_curve import plot_damping_curve
from rattlebox.plots.design import goals_of, parameters_of, plot_design
from rattlebox.plots.labels import name_of, unit_of
from rattlebox.report import study_words as words
from rattlebox.report.limits import limit
from rattlebox.report.parts import Call, Limit, Picture, Table
from rattlebox.studies.design.ends import AT_END
from rattlebox.studies.design.evidence import CURVE, CYCLES_RUN, DROPPED, LEVEL, PACKINGS_RUN, amplitude_text, curves_of
from rattlebox.studies.design.space import ADDED_MASS, DAMPING_RATIO
from rattlebox.studies.run.estimate import duration
from rattlebox.studies.work.measures import INTERVAL, MEASURES

if TYPE_CHECKING:
    import xarray as xr

_MAX_ROWS = 12
_MAX_CURVES = 6
_EXTREME = {"max": "largest", "min": "smallest"}


def _cases(study: xr.Dataset) -> Mapping[str, Case]:
    """Return the best cases: that of the only objective, or the ends of the Pareto front; the base case if there is none."""
    fronts = study.case.values.tolist() if "case" in study else []
    if not fronts:
        return words.cases_of(study)
    if len(fronts) == 1:
        return {f"best design, trial {int(study.front[0])}": Case.from_toml(fronts[0])}
    return {f"trial {int(study.front[k])}": Case.from_toml(fronts[k]) for k in (0, len(fronts) - 1)}


def _question(study: xr.Dataset) -> str:
    goals = [f"{_EXTREME[study[name].attrs['goal']]} {name_of(study[name])}" for name in goals_of(study)]
    parameters = [name_of(study[path]) for path in parameters_of(study)]
    give = "gives" if len(parameters) == 1 else "give"
    return f"Which {joined(parameters)} {give} the {joined(goals)} of {words.system_words(study)}?"


def _answer(study: xr.Dataset) -> Iterator[str]:
    goals = goals_of(study)
    usable = int(study.feasible.sum())
    if "stopped" in study.attrs:
        yield f"The search {study.attrs['stopped']}."
    if not study.front.size:
        yield f"None of {counted(study.trial.size, 'trial')} is feasible: each lacks a value or exceeds a limit."
        return
    if len(goals) == 1:
        best = study.sel(trial=int(study.front[0]))
        yield (
            f"The best of {counted(usable, 'feasible trial')} has {_choice(study, best)}, with a {name_of(study[goals[0]])} "
            f"of {_value(study, best, goals[0])}."
        )
    else:
        optimal = counted(study.front.size, "Pareto-optimal design")
        yield f"There {'is' if study.front.size == 1 else 'are'} {optimal} among {counted(usable, 'feasible trial')}."
        for name in goals:
            values = study[name].sel(trial=study.front.values).values
            pick = values.argmax() if study[name].attrs["goal"] == "max" else values.argmin()
            best = study.sel(trial=int(study.front[int(np.asarray(pick))]))
            results = joined([f"{name_of(study[goal])} {_value(study, best, goal)}" for goal in goals])
            yield f"The best {name_of(study[name])} has {_choice(study, best)}: {results}."
    robust, packings = str(study.attrs.get("robust", "")), study.sizes.get("packing", 1)
    if robust and packings > 1:
        yield (
            f"Values are means over {packings} random initial states of the {robust} over all levels, starts and "
            "amplitudes; intervals (±) are their 95 % intervals."
        )
    elif robust:
        yield f"Values are the {robust} over all levels, starts and amplitudes of a trial."
    if DROPPED in study and (count := int(study[DROPPED].sum())):
        verb = "was" if count == 1 else "were"
        yield f"{counted(count, 'trial')} {verb} dropped early, as certainly not the best: {_stages(study)}."
    if order := str(study.attrs.get("order", "")):
        yield f"{order[0].upper()}{order[1:].partition('; try: ')[0]}."
    if note := str(study.attrs.get(AT_END, "")):
        yield f"{note[0].upper()}{note[1:]}."


def _stages(study: xr.Dataset) -> str:
    """Return after how many random initial states and cycles trials were dropped."""
    rows = zip(*(study[name].values[study[DROPPED].values].tolist() for name in _ran(study)), strict=True)
    parts = []
    for row, count in sorted(Counter(rows).items()):
        cycles = f" of {row[1]} cycles" if len(row) > 1 else ""
        parts.append(f"{count} after {row[0]} random initial states{cycles}")
    return joined(parts)


def _ran(study: xr.Dataset) -> dict[str, str]:
    """Return the variables of what ran of each trial, with the headings of their columns."""
    headings = {PACKINGS_RUN: "random initial states", CYCLES_RUN: "cycles of each"}
    return {name: text for name, text in headings.items() if name in study}


def _choice(study: xr.Dataset, trial: xr.Dataset) -> str:
    """Return the parameters of a trial as text."""
    values = ((study[path], trial[path].values[()]) for path in parameters_of(study))
    return joined([f"{name_of(parameter)} {words.axis_value(parameter, value)}" for parameter, value in values])


def _value(study: xr.Dataset, trial: xr.Dataset, name: str) -> str:
    """Return an objective of a trial with its interval."""
    half = float(trial[name + INTERVAL]) if name + INTERVAL in trial else np.nan
    return with_interval(float(trial[name]), half, _unit(study, name))


def _unit(study: xr.Dataset, name: str) -> str:
    return "%" if name == DAMPING_RATIO else unit_of(study[name])


def _pictures(study: xr.Dataset) -> Iterator[Picture]:
    if len(goals_of(study)) > 1:
        caption = "Trials over the first two objectives with the Pareto front, and the parameters along the front."
    else:
        caption = "Objective of each trial with the best value so far, and the objective over each parameter."
    yield Picture(caption, partial(plot_design, study, size="page"))
    if CURVE in study and (shown := _ranked(study, _MAX_CURVES)):
        yield Picture(
            "Damping ratio over the amplitude for the best trials. Bands are 95 % intervals of the mean over the random "
            "initial states; the grey line is the structure alone.",
            partial(plot_damping_curve, curves_of(study, shown), size="page"),
        )


def _ranked(study: xr.Dataset, count: int) -> list[int]:
    """Return the trials of the front, and then the others with the largest damping ratio."""
    front = [int(trial) for trial in study.front.values]
    rest = study[DAMPING_RATIO].where(study.feasible, -np.inf).values
    order = [int(trial) for trial in np.argsort(-rest, kind="stable") if study.feasible.values[trial]]
    return list(dict.fromkeys([*front, *order]))[: max(1, count // study.sizes.get(LEVEL, 1))]


def _tables(study: xr.Dataset) -> Iterator[Table]:
    paths, goals = parameters_of(study), goals_of(study)
    rows = []
    for trial in study.front.values[:_MAX_ROWS]:
        one = study.sel(trial=int(trial))
        cells = [_cell(study[path], one[path].values[()]) for path in paths]
        rows.append((str(int(trial)), *cells, *(_value(study, one, name) for name in goals)))
    note = f"{study.front.size - _MAX_ROWS} more are in the dataset." if study.front.size > _MAX_ROWS else ""
    header = ("trial", *(name_of(study[name]) for name in (*paths, *goals)))
    yield Table("Best trials", header, rows, note, numbers=True)
    if CURVE in study:
        yield _curve_table(study)


def _curve_table(study: xr.Dataset) -> Table:
    """Return the damping ratio of the trials at each amplitude, with its interval."""
    trials = _ranked(study, _MAX_ROWS)
    curves, ran = curves_of(study, trials), _ran(study)
    rows = []
    for number, (name, curve) in enumerate(curves.items()):
        trial = trials[number // study.sizes.get(LEVEL, 1)]
        runs = (str(int(study[each][trial])) for each in ran)
        mean = curve.damping_ratio.values
        half = curve.upper.values - mean
        cells = (with_interval(float(one), float(width), "%") for one, width in zip(mean, half, strict=True))
        rows.append((name.removeprefix("trial "), *runs, *cells, amount(float(curve.bare[0]), "%", 3)))
    header = (
        "trial",
        *ran.values(),
        *(amplitude_text(study, each) for each in study.amplitude.values.tolist()),
        "structure alone",
    )
    left = int(study.feasible.sum()) - len(trials)
    note = f"{left} more are in the dataset." if left > 0 else ""
    return Table("Damping ratio over the amplitude", header, rows, note, numbers=True)


def _cell(variable: xr.DataArray, value: Any) -> str:
    if variable.dtype.kind not in "fiu":
        return str(value)
    return amount(float(value), unit_of(variable)) if np.isfinite(value) else "-"


def _limits(study: xr.Dataset) -> Iterator[Limit]:
    parameters = words.option_of(study, "parameters") or {}
    only_choices = parameters and not any(parameter["bounds"] for parameter in parameters.values())
    yield limit("choices" if only_choices else "design", "search", counted(study.trial.size, "trial"))
    yield from words.study_limits(study)


def _about(study: xr.Dataset) -> Iterator[str]:
    predicted, cpu, wall = (study.attrs.get(name) for name in ("predicted_cpu_time", "cpu_time", "wall_time"))
    if wall is not None:
        used = "" if cpu is None else f"{duration(cpu)} of processor time in "
        before = (
            f"; {duration(predicted)} of processor time were predicted before the start"
            if predicted is not None
            else ""
        )
        yield f"The trials took {used}{duration(wall)}{before}."
    yield from words.study_about(study)


def _call(study: xr.Dataset) -> Call | None:
    try:
        parameters, objective = (json.loads(study.attrs[name]) for name in ("parameters", "objective"))
        trial = json.loads(study.attrs["trial"])
    except (KeyError, TypeError, ValueError):
        return None
    # A pair in a list would be a choice of two values: bounds have a table of their own in study files.
    space: dict[str, Any] = {}
    for path, parameter in parameters.items():
        if parameter["bounds"]:
            low, high = parameter["bounds"]
            space[path] = {"from": low, "to": high, **({"spacing": "log"} if parameter["log"] else {})}
        elif "together" in parameter:
            # A path is no name of parameters that vary together in a study file.
            space.setdefault(parameter["together"].replace(".", "_"), {})[path] = parameter["choices"]
        else:
            space[path] = parameter["choices"]
    varied = [path for path, column in trial["columns"].items() if column["varies_along"] not in ([], ["packing"])]
    remarks = (f"levels and starts: add those of {joined(varied)}",) if varied else ()
    if not all(name in MEASURES or name in (ADDED_MASS, DAMPING_RATIO) for name in objective):
        return None
    arguments = {"parameters": space, "objective": objective, "trials": int(study.trial.size)}
    arguments |= {name: value for name, value in (words.option_of(study, "curve") or {}).items() if value is not None}
    arguments |= {name: value for name, value in (words.option_of(study, "options") or {}).items() if value}
    usual_values = {
        "packings": 1,
        "drop": False,
        "precision": None,
        "robust": "worst",
        "max_added_mass": None,
        "seed": 0,
    }
    for name, usual in usual_values.items():
        value = words.option_of(study, name)
        if value not in (None, usual) or name == "packings":
            arguments[name] = value
    return Call("design", arguments, "design", remarks)


KIND = words.study_kind(
    "Design", _question, _answer, _call, _pictures, cases=_cases, tables=_tables, limits=_limits, about=_about
)
