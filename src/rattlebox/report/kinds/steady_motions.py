"""Reports about steady motions: bifurcation diagrams, basins of attraction and Lyapunov exponents."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.phrases import counted
from rattlebox._util.quantities import amount
from rattlebox.plots.basins import plot_basins
from rattlebox.plots.bifurcation import plot_bifurcation
from rattlebox.plots.lyapunov import plot_lyapunov
from rattlebox.report import study_words as words
from rattlebox.report.kinds.sweep import KIND as SWEEP
from rattlebox.report.kinds.sweep import axes_argument, measures_argument, options_of, system_words
from rattlebox.report.parts import Call, Kind, Picture
from rattlebox.studies.work.orbits import Motion

if TYPE_CHECKING:
    import xarray as xr


def _bifurcation_question(study: xr.Dataset) -> str:
    return f"Which steady motions does {system_words(study)} have over {words.axes_words(study.drop_dims('cycle'))}?"


def _bifurcation_answer(study: xr.Dataset) -> Iterator[str]:
    if unfinished := words.progress_sentence(study):
        yield unfinished
    if "period" not in study:
        return
    finished = study.status.values == 0
    shown = np.where(_transient(study), _TRANSIENT, study.period.values)[finished]
    periods, counts = np.unique(shown, return_counts=True)
    for period, count in sorted(zip(periods.tolist(), counts.tolist(), strict=True), key=lambda each: -each[1]):
        what = (
            f"a period of {counted(int(period), 'cycle')}"
            if period > 0
            else "no period, or a longer one than was examined"
        )
        if period == _TRANSIENT:
            yield f"{amount(count / counts.sum(), '%', 3)} of the motions are still transient."
            continue
        yield f"{amount(count / counts.sum(), '%', 3)} of the motions have {what}."


_TRANSIENT = -2


def _transient(study: xr.Dataset) -> Any:
    """Return where a motion still comes closer to a periodic one."""
    return study.motion.values == Motion.TRANSIENT if "motion" in study else np.zeros(study.status.shape, bool)


def _bifurcation_call(study: xr.Dataset) -> Call | None:
    axes = axes_argument(study)
    if not axes or len(axes) != 1:
        return None
    (path, values), directions = next(iter(axes.items())), [str(each) for each in study.direction.values]
    if not isinstance(values, list):
        return None
    given = {"path": path, "values": values, "direction": "both" if len(directions) > 1 else directions[0]}
    given |= options_of(study, "cycles", "point", "tolerance", "apart")
    if "approach_speed" in study:
        given["show"] = "impacts"
    return _with_measures("bifurcation", study, given)


def _with_measures(function: str, study: xr.Dataset, given: dict[str, Any]) -> Call:
    """Return a call with the measures that were asked for, besides those that the study always has."""
    measures, remarks = measures_argument(study, ("impacts", "impacts_per_cycle"))
    if measures:
        given["measure"] = measures
    return Call(function, given, "" if remarks else function, remarks)


def _basins_question(study: xr.Dataset) -> str:
    return f"To which steady motion of {system_words(study)} does each start lead, over {_plane_words(study)}?"


def _plane_words(study: xr.Dataset) -> str:
    over = study[[name for name in ("status", "attractor") if name in study]]
    return words.axes_words(over.assign_coords({str(dim): study[dim] for dim in over.dims}))


def _basins_answer(study: xr.Dataset) -> Iterator[str]:
    if unfinished := words.progress_sentence(study):
        yield unfinished
    if "share" not in study:
        return
    yield f"{counted(study.sizes['orbit'], 'periodic motion is', 'periodic motions are')} reached."
    for k in range(min(study.sizes["orbit"], 5)):
        one = study.isel(orbit=k)
        share, period = amount(float(one.share), "%", 3), counted(int(one.orbit_period), "cycle")
        hits = f"{float(one.orbit_impacts_per_cycle):.3g}"
        yield f"Motion {k + 1}: {share} of the starts, period {period}, {hits} impacts per cycle."
    rest = float((study.attractor == 0).mean())
    if rest:
        yield f"{amount(rest, '%', 3)} of the starts lead to motions without a detected period."
    if transient := float(_transient(study).mean()):
        yield f"{amount(transient, '%', 3)} of the starts lead to motions that are still transient."


def _lyapunov_question(study: xr.Dataset) -> str:
    over = study[[name for name in ("status", "exponent") if name in study]]
    axes = words.axes_words(over) if words.axes_of(over) else ""
    return f"Is the motion of {system_words(study)} chaotic{f', over {axes}' if axes else ''}?"


def _lyapunov_answer(study: xr.Dataset) -> Iterator[str]:
    if unfinished := words.progress_sentence(study):
        yield unfinished
    value, error = study.exponent.values.ravel(), study.standard_error.values.ravel()
    known = np.isfinite(value) | np.isneginf(value)
    if known.sum() == 1:
        yield (
            f"The largest Lyapunov exponent is {amount(float(value[known][0]), '1/s')}, with a standard error of "
            f"{amount(float(error[known][0]), '1/s', 2)}."
        )
        return
    chaotic = known & (value > 2 * np.nan_to_num(error))
    share = amount(chaotic.sum() / max(known.sum(), 1), "%", 3)
    yield f"{share} of the motions are chaotic: their exponent exceeds two standard errors."
    if sentence := words.extremes(study[["status", "exponent"]], "exponent"):
        yield sentence


def _picture(draw: Callable[..., Any], caption: str) -> Callable[[xr.Dataset], Iterator[Picture]]:
    def pictures(study: xr.Dataset) -> Iterator[Picture]:
        yield Picture(caption, partial(draw, study, size="page"))

    return pictures


def _kind(name: str, question: Any, answer: Any, call: Any, draw: Any, caption: str) -> Kind:
    return Kind(
        name=name,
        cases=words.cases_of,
        question=question,
        answer=answer,
        call=call,
        pictures=_picture(draw, caption),
        tables=lambda study: [words.axis_table(study)],
        warnings=SWEEP.warnings,
        limits=SWEEP.limits,
        about=SWEEP.about,
    )


BIFURCATION = _kind(
    "Bifurcation diagram",
    _bifurcation_question,
    _bifurcation_answer,
    _bifurcation_call,
    plot_bifurcation,
    "State of the motion once per cycle over the parameter: one point is a motion that repeats every cycle.",
)
BASINS = _kind(
    "Basins of attraction",
    _basins_question,
    _basins_answer,
    lambda study: (
        _with_measures("basins", study, {"starts": axes, **options_of(study, "cycles", "point", "tolerance", "apart")})
        if (axes := axes_argument(study))
        else None
    ),
    plot_basins,
    "Starts in the colour of the motion to which each leads.",
)
LYAPUNOV = _kind(
    "Lyapunov exponent",
    _lyapunov_question,
    _lyapunov_answer,
    lambda study: Call(
        "lyapunov",
        {
            "axes": axes_argument(study) or {},
            **options_of(study, "cycles", "skip", "steps", "pairs", "distance", "reach", "seed"),
        },
        "lyapunov",
    ),
    plot_lyapunov,
    "Largest Lyapunov exponent: above zero, neighbouring motions separate.",
)
