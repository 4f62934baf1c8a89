"""Report about a design search."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.model.case import Case
from rattlebox.plots.design import plot_design
from rattlebox.plots.labels import name_of, unit_of
from rattlebox.report import study_words as words
from rattlebox.report.kinds.sweep import KIND as SWEEP
from rattlebox.report.kinds.sweep import system_words
from rattlebox.report.parts import Call, Kind, Limit, Picture, Table
from rattlebox.results.case_words import counted, joined
from rattlebox.results.quantities import amount

if TYPE_CHECKING:
    import xarray as xr

_MAX_ROWS = 12


def _goals(study: xr.Dataset) -> list[str]:
    return [str(name) for name, values in study.data_vars.items() if "goal" in values.attrs]


def _parameters(study: xr.Dataset) -> list[str]:
    return [str(name) for name, values in study.coords.items() if values.dims == ("trial",) and name != "trial"]


def _cases(study: xr.Dataset) -> Mapping[str, Case]:
    """Return the best cases: that of the only objective, or the ends of the Pareto front; the base case if there is none."""
    fronts = study.case.values.tolist() if "case" in study else []
    if not fronts:
        return words.cases_of(study)
    if len(fronts) == 1:
        return {f"best design, trial {int(study.front[0])}": Case.from_toml(fronts[0])}
    return {f"trial {int(study.front[k])}": Case.from_toml(fronts[k]) for k in (0, len(fronts) - 1)}


def _question(study: xr.Dataset) -> str:
    goals = [
        f"{'largest' if study[name].attrs['goal'] == 'max' else 'smallest'} {name_of(study[name])}"
        for name in _goals(study)
    ]
    paths = joined([name_of(study[path]) for path in _parameters(study)])
    return f"Which {paths} give the {joined(goals)} of {system_words(study)}?"


def _answer(study: xr.Dataset) -> Iterator[str]:
    goals, paths = _goals(study), _parameters(study)
    usable = int(study.feasible.sum())
    if not study.front.size:
        yield f"None of {counted(study.trial.size, 'trial')} is feasible: each lacks a value or exceeds a limit."
        return
    if len(goals) == 1:
        best = study.sel(trial=int(study.front[0]))
        choice = joined(
            [f"{name_of(study[path])} {words.axis_value(study[path], best[path].values[()])}" for path in paths]
        )
        value = amount(float(best[goals[0]]), unit_of(study[goals[0]]))
        yield f"The best of {counted(usable, 'feasible trial')} has {choice}, with a {name_of(study[goals[0]])} of {value}."
    else:
        yield f"{counted(study.front.size, 'design')} of {counted(usable, 'feasible trial')} are Pareto-optimal."
        for name in goals:
            values = study[name].sel(trial=study.front.values)
            pick = values.argmax() if study[name].attrs["goal"] == "max" else values.argmin()
            best = study.sel(trial=int(study.front[int(np.asarray(pick))]))
            choice = joined(
                [f"{name_of(study[path])} {words.axis_value(study[path], best[path].values[()])}" for path in paths]
            )
            results = joined(
                [f"{name_of(study[each])} {amount(float(best[each]), unit_of(study[each]))}" for each in goals]
            )
            yield f"The best {name_of(study[name])} has {choice}: {results}."
    robust = str(study.attrs.get("robust", ""))
    if robust:
        yield f"Values are the {robust} over all levels and starts of a trial."


def _pictures(study: xr.Dataset) -> Iterator[Picture]:
    several = len(_goals(study)) > 1
    caption = (
        "Trials over the first two objectives with the Pareto front, and the parameters along the front."
        if several
        else "Objective of each trial with the best value so far, and the objective over each parameter."
    )
    yield Picture(caption, partial(plot_design, study, size="page"))


def _tables(study: xr.Dataset) -> Iterator[Table]:
    names = [*_parameters(study), *_goals(study)]
    rows = []
    for trial in study.front.values[:_MAX_ROWS]:
        one = study.sel(trial=int(trial))
        rows.append((str(int(trial)), *(_cell(study[name], one[name].values[()]) for name in names)))
    note = f"{study.front.size - _MAX_ROWS} more are in the dataset." if study.front.size > _MAX_ROWS else ""
    if rows:
        yield Table("Best trials", ("trial", *(name_of(study[name]) for name in names)), rows, note, numbers=True)


def _cell(variable: xr.DataArray, value: Any) -> str:
    if variable.dtype.kind not in "fiu":
        return str(value)
    return amount(float(value), unit_of(variable)) if np.isfinite(value) else "-"


def _limits(study: xr.Dataset) -> Iterator[Limit]:
    yield Limit(
        "search",
        counted(study.trial.size, "trial"),
        "",
        "The search is random. Better designs may lie between the trials: compare with more trials, or another seed.",
    )
    yield from words.study_limits(study)


def _call(study: xr.Dataset) -> Call | None:
    try:
        parameters, objective = (json.loads(study.attrs[name]) for name in ("parameters", "objective"))
        trial = json.loads(study.attrs["trial"])
    except (KeyError, TypeError, ValueError):
        return None
    # A pair in a list would be a choice of two values: bounds have a table of their own in study files.
    bounds = {
        path: {"from": each["bounds"][0], "to": each["bounds"][1], **({"spacing": "log"} if each["log"] else {})}
        if each["bounds"]
        else each["choices"]
        for path, each in parameters.items()
    }
    varied = [path for path, column in trial["columns"].items() if column["varies_along"]]
    remarks = (f"levels and starts: add those of {joined(varied)}",) if varied else ()
    goals = [name if goal == "min" else {name: goal} for name, goal in objective.items()]
    given = {"parameters": bounds, "objective": goals, "trials": int(study.trial.size)}
    return Call("design", given, "design", remarks) if all(isinstance(goal, str) for goal in goals) else None


KIND = Kind(
    name="Design",
    cases=_cases,
    question=_question,
    answer=_answer,
    call=_call,
    pictures=_pictures,
    tables=_tables,
    warnings=SWEEP.warnings,
    limits=_limits,
    about=SWEEP.about,
)
