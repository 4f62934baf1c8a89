"""Measures of a run, computed in the core (core/impact/measures.hpp) without storing its trajectory."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rattlebox._util.batch_means import ENOUGH_DECAY, FEWEST_VALUES, half_widths
from rattlebox._util.html import Catalogue
from rattlebox._util.plugins import Registry, load_plugins, owner_of
from rattlebox.model.errors import Hint
from rattlebox.results.schema import OUTCOMES

if TYPE_CHECKING:
    import xarray as xr

    from rattlebox.model.case import Case


class Measure(NamedTuple):
    """Declaration of a measure.

    Attributes
    ----------
    units
        SI unit, "1" for pure numbers.
    long_name
        Meaning in a few words, fit for an axis label.
    samples
        Whether it is computed from samples of the motion, whose spacing limits its accuracy.
    cyclic
        Whether it is defined per cycle and requires a harmonic load or motion.
    average
        Relation between the measure of a steady motion and its values in parts of the window: "mean", "root mean square"
        or "total"; "" for peaks, shares and times, which have no interval.
    """

    units: str
    long_name: str
    samples: bool = False
    cyclic: bool = False
    average: Literal["", "mean", "root mean square", "total"] = ""


class Measures(Catalogue[Measure]):
    """Descriptions of measures by name.

    Notes
    -----
    Over a window of the length t, which holds n cycles, with the sample step h:

        rms                  sqrt(1 / t integral of x^2 dt), by the trapezoidal rule
        mean over a step     of the force of a damper, from the change of the momentum of its balls
        acceleration         a_k + c_k, that of springs, dashpots, base and harmonic loads at both ends of a step, with the
                             mean c_k of contacts and other loads over the step, whose pulses may be shorter
        settling_time        see `rattlebox.analysis.settling_time`
        loss_per_cycle       W = loss in the damper / n
        reduced_loss         W / (m V^2); m is the mass of all balls or particles, V the velocity amplitude of the cavity
        effective_mass       m' of the apparent mass m' - i m'', see `rb.loss_map`
        damping_mass         m''
        loss_factor          m'' / abs(m')
        energy_residual      see `rattlebox.results.ledger.Ledger`

    With several dampers, the power of all of them is referred to the motion of the first cavity.

    References
    ----------
    N. Meyer, R. Seifried (2021), Computational Particle Mechanics 8, 681-699, doi:10.1007/s40571-020-00363-0 (reduced loss,
    effective mass, loss factor).
    """

    plural = "measures"
    columns = ("name", "unit", "meaning", "needs")

    def row(self, name: str, entry: Measure) -> tuple[str, ...]:
        """Return name, unit, meaning and requirements of a measure."""
        needs = ["samples of the motion"] * entry.samples + ["a harmonic load or motion"] * entry.cyclic
        return name, "" if entry.units == "1" else entry.units, entry.long_name, " and ".join(needs)


_MEASURES: dict[str, Measure] = {
    "impacts": Measure("1", "impacts", average="total"),
    "impacts_per_cycle": Measure("1", "impacts per cycle", cyclic=True, average="mean"),
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
    "peak_acceleration": Measure("m/s^2", "peak absolute acceleration, without peaks of contacts", samples=True),
    "rms_acceleration": Measure(
        "m/s^2", "RMS absolute acceleration, without peaks of contacts", samples=True, average="root mean square"
    ),
    "peak_relative_acceleration": Measure(
        "m/s^2", "peak acceleration relative to the base, without peaks of contacts", samples=True
    ),
    "rms_relative_acceleration": Measure(
        "m/s^2",
        "RMS acceleration relative to the base, without peaks of contacts",
        samples=True,
        average="root mean square",
    ),
    "peak_damper_force": Measure("N", "peak force of all dampers, mean over a sample step", samples=True),
    "rms_damper_force": Measure(
        "N", "RMS force of all dampers, mean over a sample step", samples=True, average="root mean square"
    ),
    "peak_interface_force": Measure("N", "peak force on the base", samples=True),
    "rms_interface_force": Measure("N", "RMS force on the base", samples=True, average="root mean square"),
    "settling_time": Measure("s", "settling time to 5 % of the peak", samples=True),
    "loss_per_cycle": Measure("J", "loss in the damper per cycle", cyclic=True, average="mean"),
    "reduced_loss": Measure("1", "loss a cycle over m V^2", samples=True, cyclic=True, average="mean"),
    "effective_mass": Measure("kg", "effective mass", samples=True, cyclic=True, average="mean"),
    "damping_mass": Measure("kg", "imaginary part of the apparent mass", samples=True, cyclic=True, average="mean"),
    "loss_factor": Measure("1", "loss factor", samples=True, cyclic=True, average="mean"),
}
MEASURES = Measures(_MEASURES)


_FUNCTIONS: Registry[tuple[Callable[..., Any], Measure]] = Registry("measure")
for _name in _MEASURES:
    _FUNCTIONS.reserve(_name, "rattlebox")

Function = TypeVar("Function", bound="Callable[..., Any]")


def measure_function(units: str, long_name: str) -> Callable[[Function], Function]:
    """Register a function of a Run as a measure that study files name by the name of the function."""

    def register(function: Function) -> Function:
        check_names([function])
        _FUNCTIONS.add(function.__name__, (function, Measure(units, long_name)), owner_of(function))
        return function

    return register


def named_functions() -> dict[str, Callable[..., Any]]:
    """Return the functions of a Run that study files can name, also those of other packages."""
    load_plugins()
    return {name: function for name, (function, _) in _FUNCTIONS.items()}


def about(measure: Any) -> Measure:
    """Return the declaration of a measure; that of a function which is not registered has no unit."""
    name = name_of(measure)
    if name in MEASURES:
        return MEASURES[name]
    function, declared = _FUNCTIONS.get(name, (None, None))
    return declared if declared and function is measure else Measure("", name.replace("_", " "))


MOST_BATCHES = 64
"""Largest number of parts of a window for the interval of a measure; the same as in the core."""
INTERVAL = "_interval"
"""Suffix of the name of the half width of an interval."""


_RATIOS = {"loss_factor": ("damping_mass", "effective_mass")}
"""Numerators and denominators of measures that are ratios of averages."""


def parts_needed(names: Iterable[str]) -> list[str]:
    """Return the measures whose parts the intervals of measures require.

    Parameters
    ----------
    names
        Names of measures with intervals.
    """
    return list(dict.fromkeys(part for name in names for part in _RATIOS.get(name, (name,))))


def interval_of(
    name: str,
    value: Any,
    parts: Mapping[str, NDArray[np.float64]],
    lengths: NDArray[np.float64],
    shortest: ArrayLike = 0.0,
) -> Any:
    """Return half of the width of the 95 % interval of a measure of steady motion.

    Parameters
    ----------
    name
        Name of the measure.
    value : (K,) float
        Measure over the whole window, for each run.
    parts : dict of str to (K, N) float
        Measures over consecutive parts of the window, padded with NaN; see `parts_needed`.
    lengths : (K, N) float
        Lengths of the parts [s].
    shortest
        Shortest window for an interval of each run [s], see `rattlebox._util.batch_means.shortest_window`.

    Returns
    -------
    (K,) float
        Half width in the unit of the measure; NaN if the window is too short or the motion is not steady.

    Notes
    -----
    The method is that of `rattlebox.analysis.mean_interval`, for the measure in the parts, of its square for "root mean
    square", with the half width divided by twice the value, or of its rate for "total".

    A ratio r = a / b of averages, such as the loss factor, is linearised: the series is r + (a_k - r b_k) / b. If the
    interval of b comes closer to zero than half of b, that of r has no limits (Fieller), and there is none.
    """
    average = MEASURES[name].average
    value = np.asarray(value, dtype=float)
    if name in _RATIOS:
        above, below = _RATIOS[name]
        return _interval_of_ratio(value, parts[above], parts[below], lengths, shortest)
    batches = parts[name]
    if average == "root mean square":
        batches = batches**2
    elif average == "total":
        batches = batches / lengths
    half = _half_widths(batches, lengths, shortest)
    with np.errstate(invalid="ignore", divide="ignore"):
        if average == "root mean square":
            half = np.where(half > 0, half / (2 * value), half)
        elif average == "total":
            half = half * np.nansum(lengths, axis=1)
    return half


def _half_widths(batches: NDArray[np.float64], lengths: NDArray[np.float64], shortest: ArrayLike) -> Any:
    """Return half widths of the intervals of means of parts, whose number differs between the runs."""
    half = np.full(len(batches), np.nan)
    known = np.isfinite(lengths).sum(axis=1)
    least = np.zeros(len(batches))
    with np.errstate(invalid="ignore", divide="ignore"):
        # Rounding must not refuse a window of just that length.
        least[:] = np.asarray(shortest) * (1 - 1e-9) * known / np.nansum(lengths, axis=1)
    for count in np.unique(known):
        rows = known == count
        half[rows] = half_widths(batches[rows, :count], least[rows])[0]
    return half


_NEAREST = 0.5
"""Largest half width of the interval of a denominator over its value, for an interval of the ratio."""


def _interval_of_ratio(
    value: NDArray[np.float64],
    above: NDArray[np.float64],
    below: NDArray[np.float64],
    lengths: NDArray[np.float64],
    shortest: ArrayLike,
) -> Any:
    """Return half widths of the interval of a ratio `above` over the magnitude of `below`, of averages."""
    known = np.isfinite(lengths)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.sum(below, axis=1, where=known) / known.sum(axis=1)
        ratio = value[:, None]
        linear = ratio + (above - ratio * np.sign(mean)[:, None] * below) / np.abs(mean)[:, None]
        half = _half_widths(linear, lengths, shortest)
        return np.where(_half_widths(below, lengths, shortest) <= _NEAREST * np.abs(mean), half, np.nan)


def interval_warning(found: xr.Dataset, case: Case) -> dict[str, str]:
    """Return the attribute `too_short` if measures of finished runs lack an interval; otherwise an empty dictionary.

    Parameters
    ----------
    found
        Result of a study.
    case
        Its case, whose least damped mode determines how long a motion is correlated at most.
    """
    lacking = {}
    for name in map(str, found.data_vars):
        if name + INTERVAL in found:
            missing = np.isfinite(found[name].values) & ~np.isfinite(found[name + INTERVAL].values)
            if missing.any():
                lacking[name] = int(np.count_nonzero(missing)), missing.size
    if not lacking:
        return {}
    which = ", ".join(f"{name} ({count} of {size} variants)" for name, (count, size) in lacking.items())
    decay = np.asarray(case.modes.decay)
    decay = decay[decay > 0]
    length = f" of {ENOUGH_DECAY / decay.min():.3g} s after the transient" if decay.size else ""
    return {
        "too_short": f"no 95 % interval of {which}: the window must have {FEWEST_VALUES} parts and be much longer than the "
        "correlation of the motion, which must be steady; try: more cycles to skip and to evaluate, or a window"
        f"{length or ' that is ten times as long'}"
    }


_VARIANT_NAMES = {*OUTCOMES, "state", "displacement", "velocity", "relative_position", "relative_velocity"}
_IMPACT_NAMES = {"last_time", "last_approach_speed", "last_contact"}
_DESIGN_NAMES = {"trial", "front", "case", "missing", "feasible", "added_mass", "damping_ratio", "reason", "warnings"}
RESERVED_NAMES = _VARIANT_NAMES | _IMPACT_NAMES | _DESIGN_NAMES
"""Names of variables of studies that a function of a Run must not have."""


def name_of(measure: Any) -> str:
    """Return the name of a measure, or of a function of a Run.

    Parameters
    ----------
    measure
        Name, function, partial or callable object.
    """
    if isinstance(measure, partial):
        measure = measure.func
    return measure if isinstance(measure, str) else getattr(measure, "__name__", type(measure).__name__)


def check_names(measures: Iterable[Any]) -> None:
    """Raise if two measures have the same name, or a function has a reserved name.

    Parameters
    ----------
    measures
        Names and functions.

    Raises
    ------
    CaseError
        If a name is not allowed.
    """
    measures = list(measures)
    for measure in measures:
        if not isinstance(measure, str) and name_of(measure) in RESERVED_NAMES:
            raise Hint(
                f"{name_of(measure)} is the name of another variable of studies and cannot name a function",
                "another name",
            )
    names = [name_of(measure) for measure in measures]
    for name in names:
        if names.count(name) > 1:
            raise Hint(f"two measures have the name {name}", "each measure once, and functions with different names")


def with_required(required: Sequence[str], measures: Any) -> list[Any]:
    """Return the measures that a study requires, and the further requested ones.

    Parameters
    ----------
    required
        Names of the required measures.
    measures
        Requested measures.
    """
    return [*required, *(name for name in measures if name not in required)]
