"""Report about a branch of periodic motions."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.phrases import counted
from rattlebox._util.quantities import MISSING, amount, quantity, span
from rattlebox.plots.branches import plot_branches
from rattlebox.plots.labels import name_of, unit_of
from rattlebox.report import study_words as words
from rattlebox.report.limits import limit, mode_limits
from rattlebox.report.parts import Call, Limit, Table
from rattlebox.studies.orbits.branch import Branch
from rattlebox.studies.orbits.branch_data import KINDS, LONGEST_STEP, MOST_POINTS
from rattlebox.studies.orbits.branch_words import (
    critical_multiplier,
    impacts_words,
    noun,
    range_words,
    sentences,
    size_of_motion,
    special_kinds,
    stretches,
)
from rattlebox.studies.orbits.find import state_at_zero

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

_NAME = "branch"
_DETERMINANT = 1e-6
"""Error of the determinant above which multipliers are doubtful."""
_LARGE = 1e3
"""Size of the largest multiplier above which the determinant, a small product, is lost in rounding; such motions are
unstable, whatever their other multipliers are."""
_MOST_ROWS = 40
"""Most rows of a table."""


def _question(study: xr.Dataset) -> str:
    low, high = study.attrs["limits"]
    return (
        f"Which periodic motions does {words.system_words(study)} have over {study.attrs['parameter']} from "
        f"{range_words(float(low), float(high), _unit(study))}, and which of them are stable?"
    )


def _unit(study: xr.Dataset) -> str:
    return str(study.attrs["unit"])


def _answer(study: xr.Dataset) -> Iterator[str]:
    if int(study.attrs.get("finished_sides", 2)) < 2:
        yield (
            f"The branch is not finished: {counted(study.sizes['point'], 'point')} are computed, and this report is about "
            "these. The command that started it resumes it."
        )
    yield from sentences(study)


def _tables(study: xr.Dataset) -> Iterator[Table]:
    unit, cycles = _unit(study), int(study.attrs["cycles"])
    name, size = str(study.attrs["parameter"]), size_of_motion(study)
    rows = []
    for each in stretches(study)[:_MOST_ROWS]:
        ends = [noun(kind) or "end of the branch" for kind in each.limits]
        more = ", ".join(["symmetric" if each.symmetric else "not symmetric", *(["sticking"] if each.sticks else [])])
        rows.append(
            (
                range_words(each.low, each.high, unit),
                "stable" if each.stable else "unstable",
                impacts_words(each.impacts, cycles),
                _sizes(size.isel(point=each.rows)),
                more,
                " / ".join(ends),
            )
        )
    header = (name, "stability", "impacts", name_of(size), "motion", "begins / ends at")
    yield Table("Ranges of stability", header, rows)
    special = np.flatnonzero(special_kinds(study) != "")
    points = [
        (
            KINDS.get(str(study.special[k].item()), str(study.special[k].item())),
            quantity(float(study.located[k]), unit, 6),
            critical_multiplier(study, int(k)),
            impacts_words(int(study.impacts[k]), cycles),
            _sizes(size.isel(point=[int(k)])),
            str(study.passage[k].item()) or MISSING,
        )
        for k in special[:_MOST_ROWS]
    ]
    left = f"and {counted(special.size - _MOST_ROWS, 'further point')}" if special.size > _MOST_ROWS else ""
    yield Table("Special points", ("kind", name, "multiplier", "impacts", name_of(size), "continuation"), points, left)


def _sizes(part: xr.DataArray) -> str:
    """Return the range of the amplitude, or of the approach speed of the slowest impact."""
    values = part.values[np.isfinite(part.values)]
    if not values.size:
        return MISSING
    low, high = float(values.min()), float(values.max())
    return amount(low, unit_of(part)) if low == high else span(low, high, unit_of(part))


def _warnings(study: xr.Dataset) -> Iterator[str]:
    if ended := str(study.attrs.get("ended", "")):
        yield f"the branch ends before the limits: {ended}"
    errors = _determinant_errors(study)
    if (bad := int(np.count_nonzero(errors > _DETERMINANT))) > 0:
        yield (
            f"at {bad} of {counted(errors.size, 'point')} the product of the multipliers differs by more than "
            f"{_DETERMINANT:g} from the loss: their stability is doubtful"
        )


def _determinant_errors(study: xr.Dataset) -> NDArray[np.float64]:
    """Return the errors of the determinant where they are known and no multiplier is large."""
    errors = study.determinant_error.values
    largest = np.hypot(study.multiplier_real.values, study.multiplier_imaginary.values).max(axis=1)
    return np.asarray(errors[np.isfinite(errors) & (largest < _LARGE)])


def _limits(study: xr.Dataset) -> Iterator[Limit]:
    case = words.known_case(study)
    if case is not None:
        yield from mode_limits(case)
    yield limit(_NAME, "other motions", "one branch")
    step = float(study.attrs.get("step", np.nan))
    longest = f", steps up to {step:g}" if step > 0 else ""
    yield limit(_NAME, "steps", counted(study.sizes["point"], "point") + longest)
    if (errors := _determinant_errors(study)).size:
        yield limit(_NAME, "determinant", f"{errors.max():.1e}, largest", f"{_DETERMINANT:g}")


def _call(study: xr.Dataset) -> Call | None:
    """Return the call that follows the branch again from the motion at its start."""
    start = study.attrs.get("start")
    if start is None:  # it begins at a special point of another branch
        return None
    orbit = Branch(study).orbit(int(start))
    arguments: dict[str, Any] = {
        "axis": str(study.attrs["parameter"]),
        "limits": [float(end) for end in study.attrs["limits"]],
    }
    usual = {"points": MOST_POINTS, "step": LONGEST_STEP}
    for name, default in usual.items():
        if (value := study.attrs.get(name, default)) != default:
            arguments[name] = type(default)(value)
    near, period = state_at_zero(orbit).tolist(), int(study.attrs["cycles"])
    return Call(
        "continue_orbit",
        arguments,
        "continue_orbit",
        case=f"rb.find_orbit(case, near={json.dumps(near)}, period={period})",
        study={"near": near, "period": period},
    )


KIND = words.study_kind(
    "Branch of periodic motions",
    _question,
    _answer,
    _call,
    words.picture(
        plot_branches,
        "Periodic motions over the parameter: stable ones solid, unstable ones dashed, special points marked.",
    ),
    tables=_tables,
    warnings=_warnings,
    limits=_limits,
)
