"""Measures of a run, from the table of the core (core/util/measures.hpp), and half widths of their 95 % intervals."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rattlebox._util.batch_means import ENOUGH_DECAY, FEWEST_VALUES, half_widths, shortest_window
from rattlebox._util.html import Catalogue
from rattlebox._util.plugins import Registry, load_plugins, owner_of
from rattlebox.core import _core
from rattlebox.engines.batch import BlockOutput
from rattlebox.model.errors import Hint
from rattlebox.results.extremes import largest_acceleration, largest_drift
from rattlebox.results.schema import OUTCOMES
from rattlebox.results.wall_measures import wall_pressures, wall_wear
from rattlebox.studies.work.work import Values

if TYPE_CHECKING:
    import xarray as xr

    from rattlebox.model.case import Case
    from rattlebox.results import Run


class Measure(NamedTuple):
    """Declaration of a measure."""

    units: str  # SI unit, "1" for pure numbers
    long_name: str  # Meaning in a few words, fit for an axis label
    samples: bool = False  # Whether it is computed from samples of the motion, whose spacing limits its accuracy
    cyclic: bool = False  # Whether it is defined per cycle and requires a harmonic load or motion
    # Relation between the measure of a steady motion and its values in parts of the window: "mean", "root mean square" or
    # "total"; "" for peaks, shares and times, which have no interval
    average: str = ""
    # Whether it needs the impact log, which particle runs do not have; the force on the base; the energy that dampers take
    # in a cycle; the first harmonic of force and motion of the cavity; or accelerations at both ends of each step
    of_impacts: bool = False
    of_base_force: bool = False
    of_loss_in_cycle: bool = False
    of_first_harmonic: bool = False
    of_acceleration: bool = False
    # Whether it is computed from a Run, with the samples of its output, and not by the core
    of_run: bool = False
    # Whether it is one of the faces of cavities with particles
    of_walls: bool = False


class Measures(Catalogue[Measure]):
    """Descriptions of measures by name.

    Notes
    -----
    Over a window of the length t, which holds n cycles, with the sample step h:

        rms                  sqrt(1 / t integral of x^2 dt), by the trapezoidal rule
        mean over a step     of the force of a damper, from the change of the momentum of its balls
        acceleration         a_k + c_k, that of springs, dashpots, base and harmonic loads at both ends of a step, with the
                             mean c_k of contacts and other loads over the step, whose pulses may be shorter
        largest_drift        max abs(x_k - x_(k - 1)) over the storeys k, see `rattlebox.analysis.largest_drift`
        largest_acceleration largest peak_acceleration over the points, see `rattlebox.analysis.largest_acceleration`
        largest_wall_...     mean pressure, and power of friction over the area, of the wall where they are largest; see
                             `rattlebox.analysis.wall_pressures` and `rattlebox.analysis.wall_wear`
        settling_time        see `rattlebox.analysis.settling_time`
        loss_per_cycle       W = loss in the damper / n
        reduced_loss         W / (m V^2); m is the mass of all balls or particles, V the velocity amplitude of the cavity
        effective_mass       m' of the apparent mass m' - i m'', see `rb.loss_map`
        damping_mass         m''
        loss_factor          m'' / abs(m')
        energy_residual      see `rattlebox.results.ledger.Ledger`

    `largest_drift` and `largest_acceleration` are of all storeys or points, whatever point is observed. Their samples are
    those of the output of the case.

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


MEASURES = Measures(
    {
        row.name: Measure(
            row.unit,
            row.meaning,
            row.of_samples,
            row.cyclic,
            row.average,
            row.of_impacts,
            row.of_base_force,
            row.of_loss_in_cycle,
            row.of_first_harmonic,
            row.of_acceleration,
        )
        for row in _core.measures()
    }
    | {
        "largest_drift": Measure("m", "largest drift of all storeys", of_run=True),
        "largest_acceleration": Measure(
            "m/s^2", "largest absolute acceleration of all points, without peaks of contacts", of_run=True
        ),
        "largest_wall_pressure": Measure("Pa", "largest mean pressure on a wall", of_run=True, of_walls=True),
        "largest_wall_wear": Measure(
            "W/m^2", "largest friction loss at a wall over area and time", of_run=True, of_walls=True
        ),
    }
)

OF_RUN: dict[str, Callable[[Run], float]] = {
    "largest_drift": largest_drift,
    "largest_acceleration": largest_acceleration,
    "largest_wall_pressure": lambda run: max(wall_pressures(run).values()),
    "largest_wall_wear": lambda run: max(wall_wear(run).values()),
}
"""Functions of the measures that are computed from a Run."""


_FUNCTIONS: Registry[tuple[Callable[..., Any], Measure]] = Registry("measure")
for _name in MEASURES:
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


def about(measure: object) -> Measure:
    """Return the declaration of a measure; that of a function which is not registered has no unit."""
    name = name_of(measure)
    if name in MEASURES:
        return MEASURES[name]
    function, declared = _FUNCTIONS.get(name, (None, None))
    return declared if declared and function is measure else Measure("", name.replace("_", " "))


INTERVAL = "_interval"
"""Suffix of the name of the half width of an interval."""


RATIOS = {"loss_factor": ("damping_mass", "effective_mass")}
"""Numerators and denominators of measures that are ratios of averages."""


def parts_needed(names: Iterable[str]) -> list[str]:
    """Return the measures whose parts the intervals of measures require.

    `names`: names of measures with intervals.
    """
    return list(dict.fromkeys(part for name in names for part in RATIOS.get(name, (name,))))


_VARIANT_NAMES = {*OUTCOMES, "state", "displacement", "velocity", "relative_position", "relative_velocity"}
_IMPACT_NAMES = {"last_time", "last_approach_speed", "last_contact"}
_DESIGN_NAMES = {
    "trial",
    "front",
    "case",
    "missing",
    "feasible",
    "added_mass",
    "damping_ratio",
    "reason",
    "warnings",
} | {
    "damping_curve",
    "bare",
    "may_be_best",
    "bare_decides",
    "dropped",
    "packings_run",
    "cycles_run",
    "level",
    "amplitude",
}
RESERVED_NAMES = _VARIANT_NAMES | _IMPACT_NAMES | _DESIGN_NAMES
"""Names of variables of studies that a function of a Run must not have."""


def name_of(measure: object) -> str:
    """Return the name of a measure, or of a function of a Run.

    `measure`: name, function, partial or callable object.
    """
    if isinstance(measure, partial):
        measure = measure.func
    return measure if isinstance(measure, str) else getattr(measure, "__name__", type(measure).__name__)


def check_names(measures: Iterable[object]) -> None:
    """Raise if two measures have the same name, or a function has a reserved name.

    `measures`: names and functions. Raises CaseError if a name is not allowed.
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

    `required`: names of the required measures. `measures`: requested measures.
    """
    return [*required, *(name for name in measures if name not in required)]


# ---- intervals


CONTACTS = "impacts"
"""Batched in every window with intervals, last: without any, the motion is that of the linear structure."""


def with_intervals(values: Values, output: BlockOutput, shortest: NDArray[np.float64]) -> dict[str, NDArray[Any]]:
    """Return outputs in which the intervals of measures replace the batches.

    `values`: outputs of `run_block`. `output`: requested quantities. `shortest`: shortest window for an interval of each
    variant whose damper does not act [s], (n,).
    """
    found = dict(values)
    if output.batched:
        batches, lengths = found.pop("batches"), found.pop("batch_length")
        parts = dict(zip((*output.batched[:-1], ""), batches, strict=True))
        least = np.where(np.nansum(parts.pop(""), axis=1) > 0, 0.0, shortest)
        for name in output.measures:
            if set(parts_needed([name])) <= set(parts) and MEASURES[name].average:
                found[name + INTERVAL] = interval_of(name, found[name], parts, lengths, least)
    return found


def shortest_windows(packed: _core.Problem, shape: Sequence[int], output: BlockOutput) -> NDArray[np.float64]:
    """Return the shortest window for an interval of the linear motion of each variant, see `shortest_window`, flat [s].

    `packed`: variants. `shape`: shape of their grid. `output`: requested quantities, with the shapes of the modes at the
    observed point.
    """
    modes = len(packed.mode_decay)
    if not modes:  # a cavity with a given motion
        return np.zeros(math.prod(shape))

    def over_grid(values: object) -> Any:
        array = np.asarray(values, dtype=float)
        array = array.reshape(modes, *(1,) * (len(shape) + 1 - array.ndim), *array.shape[1:])
        return np.broadcast_to(array, (modes, *shape)).reshape(modes, -1)

    decay, motion = over_grid(packed.mode_decay), np.abs(over_grid(output.shape))
    seen = np.where(motion > 1e-9 * motion.max(axis=0, initial=0.0), decay, 0.0)
    # Few variants differ in their structure.
    different, inverse = np.unique(seen, axis=1, return_inverse=True)
    return np.array([shortest_window(column) for column in different.T])[inverse.ravel()]


def interval_of(
    name: str,
    value: object,
    parts: Mapping[str, NDArray[np.float64]],
    lengths: NDArray[np.float64],
    shortest: ArrayLike = 0.0,
) -> Any:
    """Return half of the width of the 95 % interval of a measure of steady motion.

    `name`: name of the measure. `value`: measure over the whole window, for each run, (K,). `parts`: measures over
    consecutive parts of the window, padded with NaN; see `parts_needed`. `lengths`: lengths of the parts [s], (K, N).
    `shortest`: shortest window for an interval of each run [s], see `rattlebox._util.batch_means.shortest_window`. Returns
    half width in the unit of the measure; NaN if the window is too short or the motion is not steady, (K,).

    Notes
    -----
    The method is that of `rattlebox.analysis.mean_interval`, for the measure in the parts, of its square for "root mean
    square", with the half width divided by twice the value, or of its rate for "total".

    A ratio r = a / b of averages, such as the loss factor, is linearised: the series is r + (a_k - r b_k) / b. If the
    interval of b comes closer to zero than half of b, that of r has no limits (Fieller), and there is none.
    """
    average = MEASURES[name].average
    value = np.asarray(value, dtype=float)
    if name in RATIOS:
        above, below = RATIOS[name]
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

    `found`: result of a study. `case`: its case, whose least damped mode determines how long a motion is correlated at
    most.
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
