"""Reports about steady motions: bifurcation diagrams, basins of attraction and Lyapunov exponents."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from rattlebox._util.phrases import counted
from rattlebox._util.quantities import amount
from rattlebox.plots.basins import plot_basins
from rattlebox.plots.bifurcation import plot_bifurcation
from rattlebox.plots.lyapunov import plot_lyapunov
from rattlebox.report import study_words as words
from rattlebox.report.arguments import axes_argument, call_with_measures, options_of
from rattlebox.report.parts import Call
from rattlebox.studies.work.reductions import Motion

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

_TRANSIENT = -2
"""Stands for the period of a motion that is still transient."""
_ALWAYS = ("impacts", "impacts_per_cycle")
"""Measures that bifurcations and basins always have."""


def _bifurcation_question(study: xr.Dataset) -> str:
    return (
        f"Which steady motions does {words.system_words(study)} have over {words.axes_words(study.drop_dims('cycle'))}?"
    )


def _bifurcation_answer(study: xr.Dataset) -> Iterator[str]:
    if "period" not in study:
        return
    finished = study.status.values == 0
    shown = np.where(_transient(study), _TRANSIENT, study.period.values)[finished]
    periods, counts = np.unique(shown, return_counts=True)
    for k in np.argsort(-counts, kind="stable"):
        share, period = amount(counts[k] / counts.sum(), "%", 3), int(periods[k])
        if period == _TRANSIENT:
            yield f"{share} of the motions are still transient."
        elif period > 0:
            yield f"{share} of the motions have a period of {counted(period, 'cycle')}."
        else:
            yield f"{share} of the motions have no period, or a longer one than was examined."


def _transient(study: xr.Dataset) -> NDArray[np.bool_]:
    """Return where a motion still comes closer to a periodic one."""
    return (
        np.asarray(study.motion.values == Motion.TRANSIENT) if "motion" in study else np.zeros(study.status.shape, bool)
    )


def _bifurcation_call(study: xr.Dataset) -> Call | None:
    axes = axes_argument(study)
    if not axes or len(axes) != 1:
        return None
    (path, values), directions = next(iter(axes.items())), study.direction.values.tolist()
    if not isinstance(values, list):
        return None
    arguments = {"path": path, "values": values, "direction": "both" if len(directions) > 1 else directions[0]}
    arguments |= options_of(study, "cycles", "point", "tolerance", "apart")
    if "approach_speed" in study:
        arguments["show"] = "impacts"
    return call_with_measures("bifurcation", study, arguments, _ALWAYS)


def _basins_question(study: xr.Dataset) -> str:
    return f"To which steady motion of {words.system_words(study)} does each start lead, over {_plane_words(study)}?"


def _plane_words(study: xr.Dataset) -> str:
    over = study[[name for name in ("status", "attractor") if name in study]]
    return words.axes_words(over.assign_coords({str(dim): study[dim] for dim in over.dims}))


def _basins_answer(study: xr.Dataset) -> Iterator[str]:
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
    return f"Is the motion of {words.system_words(study)} chaotic{f', over {axes}' if axes else ''}?"


def _lyapunov_answer(study: xr.Dataset) -> Iterator[str]:
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


def _basins_call(study: xr.Dataset) -> Call | None:
    axes = axes_argument(study)
    if not axes:
        return None
    options = options_of(study, "cycles", "point", "tolerance", "apart")
    return call_with_measures("basins", study, {"starts": axes, **options}, _ALWAYS)


def _lyapunov_call(study: xr.Dataset) -> Call:
    options = options_of(study, "cycles", "skip", "steps", "pairs", "distance", "reach", "seed")
    return Call("lyapunov", {"axes": axes_argument(study) or {}, **options}, "lyapunov")


BIFURCATION = words.study_kind(
    "Bifurcation diagram",
    _bifurcation_question,
    _bifurcation_answer,
    _bifurcation_call,
    words.picture(
        plot_bifurcation,
        "State of the motion once per cycle over the parameter: one point is a motion that repeats every cycle.",
    ),
)
BASINS = words.study_kind(
    "Basins of attraction",
    _basins_question,
    _basins_answer,
    _basins_call,
    words.picture(plot_basins, "Starts in the colour of the motion to which each leads."),
)
LYAPUNOV = words.study_kind(
    "Lyapunov exponent",
    _lyapunov_question,
    _lyapunov_answer,
    _lyapunov_call,
    words.picture(plot_lyapunov, "Largest Lyapunov exponent: above zero, neighbouring motions separate."),
)
