"""Numbers that sum up a run, computed in the core (core/impact/measures.hpp) without keeping its trajectory."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.batch_means import half_widths
from rattlebox._util.html import Catalogue
from rattlebox.model.errors import Hint
from rattlebox.results.schema import OUTCOMES

if TYPE_CHECKING:
    import xarray as xr


class Measure(NamedTuple):
    """What a measure is.

    Attributes
    ----------
    units
        SI unit, "1" for pure numbers.
    long_name
        Meaning in a few words, fit for an axis label.
    samples
        It is found from samples of the motion, and is as good as they are dense.
    cyclic
        It needs a cycle: a harmonic load or motion.
    average
        How the measure of a steady motion follows from those of parts of the window: their mean, the root of their mean
        square, or their total; empty for peaks, shares and times, which carry no interval.
    """

    units: str
    long_name: str
    samples: bool = False
    cyclic: bool = False
    average: Literal["", "mean", "root mean square", "total"] = ""


class Measures(Catalogue[Measure]):
    """Descriptions of measures by name."""

    plural = "measures"
    columns = ("name", "unit", "meaning", "needs")

    def row(self, name: str, entry: Measure) -> tuple[str, ...]:
        """Return name, unit, meaning and what the measure needs."""
        needs = ["samples of the motion"] * entry.samples + ["a harmonic load or motion"] * entry.cyclic
        return name, "" if entry.units == "1" else entry.units, entry.long_name, " and ".join(needs)


_MEASURES: dict[str, Measure] = {
    "impacts": Measure("1", "impacts", average="total"),
    "impacts_per_cycle": Measure("1", "impacts a cycle", cyclic=True, average="mean"),
    "peak_contact_force": Measure("N", "peak contact force"),
    "peak_overlap": Measure("m", "largest overlap"),
    "largest_approach_speed": Measure("m/s", "largest approach speed"),
    "mean_approach_speed": Measure("m/s", "mean approach speed", average="mean"),
    "longest_contact": Measure("s", "longest contact"),
    "work": Measure("J", "work of load and base", average="total"),
    "viscous_loss": Measure("J", "loss in the structure", average="total"),
    "impact_loss": Measure("J", "loss in the damper", average="total"),
    "viscous_share": Measure("1", "share lost in the structure"),
    "impact_share": Measure("1", "share lost in the damper"),
    "motion_share": Measure("1", "share left in the motion"),
    "energy_residual": Measure("1", "energy residual over the energy put in"),
    "peak": Measure("m", "peak displacement", samples=True),
    "rms": Measure("m", "RMS displacement", samples=True, average="root mean square"),
    "peak_velocity": Measure("m/s", "peak velocity", samples=True),
    "rms_velocity": Measure("m/s", "RMS velocity", samples=True, average="root mean square"),
    "peak_acceleration": Measure("m/s^2", "peak absolute acceleration, mean over a sample step", samples=True),
    "rms_acceleration": Measure(
        "m/s^2", "RMS absolute acceleration, mean over a sample step", samples=True, average="root mean square"
    ),
    "settling_time": Measure("s", "settling time to 5 % of the peak", samples=True),
    "loss_per_cycle": Measure("J", "loss in the damper a cycle", cyclic=True, average="mean"),
    "reduced_loss": Measure("1", "loss a cycle over m V^2", samples=True, cyclic=True, average="mean"),
    "effective_mass": Measure("kg", "effective mass", samples=True, cyclic=True, average="mean"),
    "damping_mass": Measure("kg", "imaginary part of the apparent mass", samples=True, cyclic=True, average="mean"),
    "loss_factor": Measure("1", "loss factor", samples=True, cyclic=True, average="mean"),
}
MEASURES = Measures(_MEASURES)


MOST_BATCHES = 64
"""Largest number of parts of a window of which the interval of a measure is computed, as in the core."""
INTERVAL = "_interval"
"""End of the name of the half width of the interval of a measure."""


def interval_of(name: str, value: Any, batches: NDArray[np.float64], lengths: NDArray[np.float64]) -> Any:
    """Return half of the width of the 95 % interval of a measure of steady motion.

    Parameters
    ----------
    name
        Name of the measure.
    value : (K,) float
        The measure over the whole window, of each of some runs.
    batches : (K, N) float
        The measure over consecutive parts of the window; NaN of those that there are not.
    lengths : (K, N) float
        Lengths of the parts [s].

    Returns
    -------
    (K,) float
        In the unit of the measure; NaN if the window is too short or the motion is not steady.

    Notes
    -----
    Batch means of the measure, of its square ("root mean square", the half width of which is divided by twice the value) or
    of its rate ("total"); see `rattlebox.analysis.mean_interval`.
    """
    average = MEASURES[name].average
    value = np.asarray(value, dtype=float)
    if average == "root mean square":
        batches = batches**2
    elif average == "total":
        batches = batches / lengths
    half = np.full(len(batches), np.nan)
    known = np.isfinite(lengths).sum(axis=1)
    for count in np.unique(known):
        rows = known == count
        half[rows] = half_widths(batches[rows, :count])[0]
    with np.errstate(invalid="ignore", divide="ignore"):
        if average == "root mean square":
            half = np.where(half > 0, half / (2 * value), half)
        elif average == "total":
            half = half * np.nansum(lengths, axis=1)
    return half


def interval_warning(found: xr.Dataset) -> dict[str, str]:
    """Return the attribute `too_short` of a study in which measures of finished runs lack an interval; else nothing."""
    lacking = {}
    for name in map(str, found.data_vars):
        if name + INTERVAL in found:
            missing = np.isfinite(found[name].values) & ~np.isfinite(found[name + INTERVAL].values)
            if missing.any():
                lacking[name] = int(np.count_nonzero(missing)), missing.size
    if not lacking:
        return {}
    which = ", ".join(f"{name} ({count} of {size} variants)" for name, (count, size) in lacking.items())
    return {
        "too_short": f"no 95 % interval of {which}: the window holds fewer than ten independent parts, or the motion is not "
        "steady; try: more cycles to skip and to evaluate, or a longer duration"
    }


_OF_VARIANTS = {*OUTCOMES, "state", "displacement", "velocity", "ball_place", "ball_speed"}
_OF_IMPACTS = {"last_time", "last_approach_speed", "last_contact"}
_OF_DESIGNS = {"trial", "front", "case", "missing", "feasible", "added_mass"}
TAKEN = _OF_VARIANTS | _OF_IMPACTS | _OF_DESIGNS
"""Names in studies that are no measure's."""


def name_of(measure: Any) -> str:
    """Return what a measure is called, which may be a function of a Run."""
    if isinstance(measure, partial):
        measure = measure.func
    return measure if isinstance(measure, str) else getattr(measure, "__name__", type(measure).__name__)


def check_names(measures: Iterable[Any]) -> None:
    """Refuse measures of which two have one name, and functions that are called like another part of a study.

    Raises
    ------
    Hint
        With the name.
    """
    measures = list(measures)
    for measure in measures:
        if not isinstance(measure, str) and name_of(measure) in TAKEN:
            raise Hint(
                f"a function cannot be called {name_of(measure)}: studies hold something else by that name",
                "another name",
            )
    names = [name_of(measure) for measure in measures]
    for name in names:
        if names.count(name) > 1:
            raise Hint(f"two measures are called {name}", "each once, functions with names of their own")


def with_required(required: Sequence[str], measures: Any) -> list[Any]:
    """Return the measures that a study needs, and those that are asked for besides."""
    return [*required, *(name for name in measures if name not in required)]
