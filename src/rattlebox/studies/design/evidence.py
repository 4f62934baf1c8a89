"""Evidence for the order of the trials of a design: damping curves, intervals that overlap, amplitudes that decide."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.phrases import counted, joined
from rattlebox._util.quantities import STANDARD_GRAVITY, amount
from rattlebox.studies.design.space import ADDED_MASS, DAMPING_RATIO
from rattlebox.studies.work.measures import INTERVAL

if TYPE_CHECKING:
    import xarray as xr

Vector = NDArray[np.float64]

CURVE = "damping_curve"
"""Variable of the damping ratio of each trial over the amplitude."""
BARE = "bare"
"""Variable of the damping ratio of the structure alone."""
MAY_BE_BEST = "may_be_best"
"""Variable of the trials that are on the front or cannot be excluded from it within their intervals."""
BARE_DECIDES = "bare_decides"
"""Variable of the trials whose damper adds nothing at the amplitude that decides."""
DROPPED = "dropped"
"""Variable of the trials that ended early because they are certainly worse than another one."""
PACKINGS_RUN, CYCLES_RUN = "packings_run", "cycles_run"
"""Variables of the numbers of packings that ran, and of the cycles of each run."""
LEVEL = "level"
"""Dimension of the levels of damping curves."""

_LEAST_ADDED = 0.1
"""Damping that a damper must add at the deciding amplitude, over that of the structure alone."""
_LISTED = 8
"""Largest number of trials that a note names."""


def certainly_worse(low: Vector, high: Vector) -> NDArray[np.bool_]:
    """Return which trials are dominated by which rivals even within their intervals, (trials, rivals).

    `low`: optimistic limits of the trials, (trials, objectives). `high`: pessimistic limits of the rivals, (rivals,
    objectives). Both are of objectives to minimise.
    """
    return np.asarray((high <= low[:, None]).all(axis=2) & (high < low[:, None]).any(axis=2))


def with_curves(
    found: xr.Dataset, ratios: Vector, half: Vector, bare: Vector, amplitudes: Any, levels: list[str], ran: list[int]
) -> xr.Dataset:
    """Return a result with the damping curves of its trials.

    `ratios`: damping ratios, (trials, levels, amplitudes, packings). `half`: half of the widths of the intervals of their
    means, (trials, levels, amplitudes). `bare`: ratios of the structures alone, (trials, levels). `levels`: texts of the
    levels; only one without levels. `ran`: number of packings of each trial that ran.
    """
    attrs = {"units": "1", "long_name": "damping ratio"}
    over: tuple[str, ...] = ("trial", LEVEL, "amplitude")
    if len(levels) == 1:
        ratios, half, bare, over = ratios[:, 0], half[:, 0], bare[:, 0], ("trial", "amplitude")
    else:
        found = found.assign_coords({LEVEL: levels})
    found = found.assign_coords(amplitude=("amplitude", np.array(amplitudes), {"units": "m", "long_name": "amplitude"}))
    means = [of_one[..., :count].mean(axis=-1) for of_one, count in zip(ratios, ran, strict=True)]
    found[CURVE] = over, np.reshape(means, half.shape), attrs
    width = attrs | {"long_name": "half of the 95 % interval, damping ratio"}
    found[CURVE + INTERVAL] = over, half, width
    if "packing" in found.dims:
        single = attrs | {"long_name": "damping ratio, each packing"}
        found[f"{CURVE}_packings"] = (*over, "packing"), ratios, single
    found[BARE] = over[:-1], bare, attrs | {"long_name": "damping ratio of the structure alone"}
    if found.attrs["robust"] == "worst":
        about = {"long_name": "the damper adds nothing at the worst amplitude"}
        found[BARE_DECIDES] = "trial", found.feasible.values & _bare_decides(found), about
    return found


def _bare_decides(found: xr.Dataset) -> NDArray[np.bool_]:
    """Return for which trials the damper adds less at the worst amplitude than a share of the damping without it."""
    trials = found.sizes["trial"]
    mean, half, bare = np.broadcast_arrays(
        found[CURVE].values, found[CURVE + INTERVAL].values, found[BARE].values[..., None]
    )
    mean, half, bare = (each.reshape(trials, -1) for each in (mean, half, bare))
    worst = np.argmin(np.where(np.isfinite(mean), mean, np.inf), axis=1)
    at = np.arange(trials), worst
    added = mean[at] - bare[at]
    # Scatter of locked beds may be larger than what they add: then the interval of the mean holds the bare structure.
    return np.asarray(added <= np.maximum(_LEAST_ADDED * bare[at], np.nan_to_num(half[at])))


def with_order(found: xr.Dataset, signs: list[float]) -> xr.Dataset:
    """Return a result with the trials that may be best within their intervals.

    `signs`: factors with which the objectives are minimised.
    """
    names = [str(name) for name in found.data_vars if "goal" in found[name].attrs]
    values = np.stack([sign * found[name].values for name, sign in zip(names, signs, strict=True)], axis=1)
    half = np.stack([_half(found, name) for name in names], axis=1)
    usable, front = found.feasible.values, found.front.values
    low, high = values - half, values[front] + half[front]
    excluded: NDArray[np.bool_] = np.array(certainly_worse(low, high).any(axis=1))
    excluded[front] = False
    if DROPPED in found:  # each is certainly worse than a trial that may since have left the front
        excluded |= found[DROPPED].values
    about = {"long_name": "on the front, or not certainly worse"}
    found[MAY_BE_BEST] = "trial", usable & ~excluded, about
    return found


def _half(found: xr.Dataset, name: str) -> Vector:
    """Return half of the widths of the intervals of an objective; zero where it has none."""
    return np.nan_to_num(found[name + INTERVAL].values) if name + INTERVAL in found else np.zeros(found.sizes["trial"])


def deciding_note(found: xr.Dataset) -> str:
    """Return a warning if the best damping ratio is that of the structure alone; "" if it is not."""
    if BARE_DECIDES not in found or not found[BARE_DECIDES].any():
        return ""
    ratios = found[DAMPING_RATIO].where(found.feasible)
    best = found.isel(trial=int(ratios.argmax("trial")))
    if not bool(best[BARE_DECIDES]):
        return ""
    curve = best[CURVE].min(LEVEL) if LEVEL in best[CURVE].dims else best[CURVE]
    where = amplitude_text(found, float(curve.amplitude[int(np.nanargmin(curve.values))]))
    count, usable = int(found[BARE_DECIDES].sum()), int(found.feasible.sum())
    which = "the only trial" if usable == 1 else f"{count} of {usable} trials, the best one included,"
    alone = amount(float(best[BARE].min()), "%", 3)
    return (
        f"warning: at {where}, which decides as the worst amplitude, the dampers of {which} add nothing beyond the scatter "
        f"and {100 * _LEAST_ADDED:g} % of the damping of the structure alone ({alone}), so that the damping ratio does not "
        "rank them; see damping_curve; try: larger amplitudes, or robust = 'mean'"
    )


def order_note(found: xr.Dataset) -> str:
    """Return which trials cannot be told apart; "" if the order of the best ones is certain."""
    if MAY_BE_BEST not in found or not found.front.size:
        return ""
    goals = [str(name) for name in found.data_vars if "goal" in found[name].attrs]
    measured = [name for name in goals if name != ADDED_MASS]
    if found.sizes.get("packing", 1) == 1 and not any(_half(found, name).any() for name in measured):
        return ""
    front = found.front.values.tolist()
    others = [int(trial) for trial in np.flatnonzero(found[MAY_BE_BEST].values) if trial not in front]
    if not others:
        return ""
    more = "try: more packings"
    if len(goals) == 1:
        sign = -1 if found[goals[0]].attrs["goal"] == "max" else 1
        others.sort(key=lambda trial: sign * float(found[goals[0]][trial]))
        return (
            f"the best {len(others) + 1} of {counted(int(found.feasible.sum()), 'trial')} cannot be told apart: the 95 % "
            f"intervals of {_numbers(others)} overlap that of {_numbers(front)}; {more}"
        )
    verb = "is" if len(others) == 1 else "are"
    return f"{_numbers(others)} {verb} not certainly worse than the Pareto front: the 95 % intervals overlap; {more}"


def _numbers(trials: list[int]) -> str:
    """Return the numbers of trials as words."""
    listed = [str(trial) for trial in trials[:_LISTED]]
    listed += [f"{len(trials) - _LISTED} more"] if len(trials) > _LISTED else []
    return f"trial{'s' * (len(trials) > 1)} {joined(listed)}"


def curves_of(found: xr.Dataset, trials: list[int]) -> dict[str, xr.Dataset]:
    """Return the damping curves of some trials by name, as `rb.plot_damping_curve` draws them."""
    curves = {}
    for trial in trials:
        one = found.sel(trial=trial)
        for number in range(found.sizes.get(LEVEL, 1)):
            each = one.isel({LEVEL: number}) if LEVEL in found.dims else one
            name = f"trial {trial}" + (f", {each[LEVEL].item()}" if LEVEL in found.dims else "")
            name += ", dropped" if DROPPED in found and bool(one[DROPPED]) else ""
            mean, half = each[CURVE].reset_coords(drop=True), each[CURVE + INTERVAL].reset_coords(drop=True)
            parts = {"damping_ratio": mean, "lower": mean - half, "upper": mean + half}
            bare = each[BARE].reset_coords(drop=True).broadcast_like(mean)
            curve = mean.to_dataset(name="damping_ratio").assign({**parts, "bare": bare})
            curves[name] = curve.assign_attrs({"frequency": found.attrs.get("frequency", math.nan)})
    return curves


def amplitude_text(found: xr.Dataset, amplitude: float) -> str:
    """Return an amplitude as length and, at the frequency of the mode, in g."""
    frequency, text = found.attrs.get("frequency"), amount(amplitude, "m")
    if frequency is None:
        return text
    return f"{text} ({amount(amplitude * (2 * math.pi * frequency) ** 2 / STANDARD_GRAVITY, 'g', 3)})"
