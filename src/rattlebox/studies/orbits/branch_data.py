"""Arguments and dataset of a branch of periodic motions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox._util.exceptions import CaseError
from rattlebox._util.narrow import present
from rattlebox._util.quantities import quantity
from rattlebox.model.errors import Hint
from rattlebox.model.paths import place_of
from rattlebox.studies.grid.axes import materials_in
from rattlebox.studies.grid.grid import Parameter
from rattlebox.studies.orbits.branch_words import sentences
from rattlebox.studies.orbits.corrector import Corrector, Point
from rattlebox.studies.orbits.follow import Follower
from rattlebox.studies.orbits.forcing import Forcing, number_at
from rattlebox.studies.orbits.shooting import ReturnMap

if TYPE_CHECKING:
    import xarray

    from rattlebox.model.case import Case

LONGEST_STEP = 0.02
"""Default of the longest step, as part of the range of the parameter or of the size of the motion."""
MOST_POINTS = 500
"""Default of the largest number of points in each direction."""
_SAME_PERIOD = 1e-9
"""Relative difference below which two periods are the same."""
STUDY = "continue_orbit"
"""Attribute of the dataset of a branch."""
KINDS = {
    "fold": "fold",
    "flip": "flip (period doubling)",
    "pitchfork": "pitchfork (loss of symmetry)",
    "torus": "Neimark-Sacker (torus)",
    "branch point": "branch point",
    "grazing": "grazing: a near miss becomes an impact",
    "impact lost": "grazing: an impact vanishes",
    "sticking": "beginning or end of sticking",
}
"""Special points and their words."""


def corrector_of(case: Case, axis: str, limits: Sequence[Any], step: float) -> tuple[Corrector, str]:
    """Return the continuation of a case along a parameter, and the unit of the parameter; raise if it is not valid."""
    if not isinstance(axis, str):
        raise Hint(f"axis = {axis!r:.60} is not a path", 'axis = "load.frequency"')
    Forcing.of(case).check_parameter(axis)
    forcing = Forcing.of(case, (axis,))
    if isinstance(limits, str) or not isinstance(limits, Sequence) or len(limits) != 2:
        raise Hint(f"limits = {limits!r:.60} must be the smallest and the largest value", '("20 Hz", "40 Hz")')
    parameter = Parameter(case, axis, "limits", materials_in(case))
    low, high, unit = parameter.ends(*limits)
    if not low < high:
        raise Hint(f"limits = {limits!r:.60}: the first value must be the smaller one", "the values in rising order")
    if not 1e-5 <= float(step) <= 0.5:
        raise Hint(f"step = {step} is a part of the range and must be between 1e-5 and 0.5", "step = 0.02")
    vanishes = low <= 0 <= high and len(forcing.cycles) > 1 and place_of(case, axis)[-1] == "amplitude"
    if vanishes and Forcing.of(case.replaced({axis: 0.0})).period < (1 - _SAME_PERIOD) * forcing.period:
        raise Hint(
            f"limits: with {axis} = 0 the common period of the other loads is shorter, and motions have another number of "
            "cycles",
            "limits without 0",
        )
    for end in (low, high):
        try:
            case.replaced({axis: end})
        except CaseError as error:
            raise error.restated(source=f"limits: {axis} = {quantity(end, unit, 6)}") from None
    return Corrector(ReturnMap(forcing, 1, (axis,)), (low, high), float(step)), unit


def start_value(case: Case, axis: str, corrector: Corrector, unit: str) -> float:
    """Return the value of the parameter at the motion of a case; raise if it is not between the limits."""
    value = present(number_at(case, axis))
    low, high = corrector.limits
    if not low <= value <= high:
        raise Hint(
            f"the motion has {axis} = {quantity(value, unit, 6)}, which is not between the limits "
            f"{quantity(low, unit, 6)} and {quantity(high, unit, 6)}",
            "limits around it, or a motion between the limits",
        )
    return value


def data_of(row: Sequence[Point], case: Case, axis: str, unit: str, follower: Follower) -> xarray.Dataset:
    """Return the dataset of the branch of a row of points."""
    limits = follower.corrector.limits
    # The side of rising values is followed first; the branch that begins at a special point has this side only.
    ends = (row[-1], row[0])
    ended = "; ".join(
        f"at {axis} = {quantity(point.located if point.special else point.value, unit, 6)}, {reason}"
        for point, reason in zip(ends, follower.reasons, strict=False)
        if reason
    )
    data = _dataset(row, case, axis, unit, limits, closed=int(follower.is_closed), ended=ended)
    return data.assign_attrs(answer="\n".join(sentences(data)))


def _dataset(
    points: Sequence[Point], case: Case, parameter: str, unit: str, limits: tuple[float, float], **attrs: Any
) -> xarray.Dataset:
    """Return the dataset of a branch."""
    import xarray

    orbits = [point.orbit for point in points]
    places = list(orbits[0].amplitudes)
    multipliers = np.array([orbit.multipliers for orbit in orbits])
    slowest = [np.nan if o.slowest_impact is None else o.slowest_impact.approach_speed for o in orbits]
    nearest_miss = [np.nan if o.nearest_miss is None else o.nearest_miss.gap for o in orbits]

    def along(values: Any, name: str, units: str = "1", *dims: str) -> tuple[Any, ...]:
        return ("point", *dims), np.asarray(values), {"units": units, "long_name": name}

    data = {
        "value": along([point.value for point in points], parameter, unit),
        "amplitude": along([[o.amplitudes[p] for p in places] for o in orbits], "amplitude", "m", "place"),
        "multiplier_real": along(multipliers.real, "real part of the multipliers", "1", "multiplier"),
        "multiplier_imaginary": along(multipliers.imag, "imaginary part of the multipliers", "1", "multiplier"),
        "stable": along([o.is_stable for o in orbits], "whether the motion is stable"),
        "impacts": along([len(o.impacts) for o in orbits], "number of impacts in a period"),
        "slowest_impact": along(slowest, "smallest approach speed", "m/s"),
        "nearest_miss": along(nearest_miss, "smallest gap without a contact", "m"),
        "symmetric": along([o.is_symmetric for o in orbits], "whether the motion is symmetric"),
        "sticks": along([o.sticks for o in orbits], "whether bodies stick together"),
        "special": along([point.special for point in points], "name of a special point"),
        "located": along([point.located for point in points], f"{parameter} at a special point", unit),
        "passage": along([point.passage for point in points], "how the branch continues at a grazing point"),
        "state": along([o.state for o in orbits], "state at the beginning", "SI", "component"),
        "phase": along([o.phase for o in orbits], "part of the period of the loads at the beginning"),
        "determinant_error": along([o.determinant_error for o in orbits], "error of the determinant"),
    }
    about = {
        "title": "Branch of periodic motions",
        "study": STUDY,
        "case": case.to_toml(),
        "parameter": parameter,
        "unit": unit,
        "limits": list(limits),
        "cycles": orbits[0].cycles,
    }
    return xarray.Dataset(data, coords={"place": places}, attrs=about | attrs)
