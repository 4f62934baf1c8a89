"""Response of a structure with dampers in the first harmonic, from the loss map of one damper."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.flags import flag_masks
from rattlebox.analysis.chatter import minimum_real_part
from rattlebox.analysis.describing_function import MassTable
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint, at
from rattlebox.model.modes import ModalModel, main_axis
from rattlebox.model.space import Triple, unit_vector
from rattlebox.model.structures import StructurePart
from rattlebox.model.units import parse, whole_number
from rattlebox.studies.grid.sampling import Spaced
from rattlebox.studies.maps.map_response import FLAGS, LossTable, MapResponse, Transfer

if TYPE_CHECKING:
    import xarray

FloatArray = NDArray[np.float64]

_AT_MODES = 201
_BETWEEN = 200
"""Default numbers of frequencies around each natural frequency, and over the range of the map."""

_SOFTENED = 0.05
"""Relative change of a peak by softening above which there is a warning."""


def response_from_map(
    structure: StructurePart,
    loss_map: xarray.Dataset | str | os.PathLike[str],
    *,
    level: object,
    number: int | Sequence[int] = 1,
    at: str | tuple[str, ...] | list[str | tuple[str, ...]] | None = None,
    frequencies: object = None,
    point: str | None = None,
    load_point: str | None = None,
    load_direction: str | Triple | None = None,
    direction: str | Triple | None = None,
) -> xarray.Dataset:
    """Compute the steady response of a structure with dampers, from the loss map of one damper, in milliseconds.

    In the first harmonic, a damper acts on the structure like its apparent mass m' - i m'', which depends on amplitude and
    frequency. The function finds all steady motions at each frequency and level, and the damping ratio of each mode.

    Parameters
    ----------
    structure
        Structure with modes: `SDOF`, `Modal`, `Matrices`, `Beam`, `Plate` or `ShearBuilding`.
    loss_map
        Dataset from `rb.loss_map`; or its file, written by `to_netcdf`, or its store. A dataset with `effective_mass` m'
        and `damping_mass` m'' [kg] over the same axes may also come from a measurement.
    level
        Amplitudes of the harmonic load, as text with a unit ("5 N"), a list, `linspace` or `geomspace`. A force acts at
        `load_point`; an acceleration ("2 m/s^2") moves the base.
    number
        Number of identical dampers at each point, or a list of numbers to compare.
    at
        Point of the dampers. A tuple of points has dampers at all of them at the same time; a list compares its items.
        Default: the only point of the structure.
    frequencies
        Rising frequencies: numbers [Hz], text with units, `linspace` or `geomspace`. Default: the range of the map, with
        more frequencies around each natural frequency.
    point
        Observed point; default the first point of `at`. Points in 3-D are named with their axis, "tip z".
    load_point
        Point at which the force acts; default the only point of the structure.
    load_direction
        Direction of a force at a point in 3-D, or of the motion of the base of such a structure.
    direction
        Direction in which the dampers move, for points in 3-D; default that of the map. The motion across it is ignored.

    Returns
    -------
    xarray.Dataset
        Over `at`, `number`, `level` and `frequency` [Hz]: `flags` (`flag_meanings` has the names), the number of
        `solutions`, and `interpolation_error`, the relative change of the largest amplitude if every second amplitude or
        frequency of the map is omitted. Also over `solution`, the largest motion of the dampers first: `amplitude` [m] and
        `phase` [rad] of the observed point relative to the base, amplitude sin(2 pi f t + phase of the load + phase);
        `cavity_amplitude`, the largest of the dampers, in the unit of the map; `first_harmonic_share` of the mean square
        velocity of the dampers, an estimate, flagged below 0.95; `is_unstable` between two folds. Over
        level and frequency: `bare_amplitude` without dampers. Over `at`, `number` and `level`: `peak` [m], the largest
        amplitude, and `peak_frequency`; NaN if the response may be larger where the map does not cover it. Over `at`,
        `number`, `mode` and `map_amplitude`, that of the damper with the largest motion: `damping_ratio` and
        `mode_frequency`. `amplitude_interval` (of the largest motion), `peak_interval` and `damping_ratio_interval` are half
        of the 95 % intervals that follow from those of the map, from the scatter of its cycles; NaN where it has none.
        `peak_softening_error` is the relative change of the peak without the estimated effect of the softening of the map;
        NaN where that is unknown. The attribute `softening` has the values of the softening. Over `at` and `number`:
        `mass_ratio` of the particles to the effective mass of the structure for an impact at their point, 1 / sum of
        squared mode shapes. What the map does not cover is NaN. The attribute `warnings` counts it. With a force, over
        `at`, `number` and `level`: `minimum_real_part` [m/N] of the displacement over the force, on which chatter depends
        (`rb.stability_lobes`), and `dynamic_stiffness` [N/m], the smallest force over displacement, both of the largest
        motion; NaN like `peak`. With a motion of the base, over `solution`, too:
        `transmissibility`, the absolute acceleration of the observed point over that of the base.

    Raises
    ------
    CaseError
        If an argument is not valid, or the map covers no motion at a level.
    DataError
        If the file of the map cannot be read.

    Notes
    -----
    See `rattlebox.analysis.describing_function` for the method. It holds for light dampers whose cavity moves almost
    harmonically. An impact on a light structure is weaker than one on the shaker of the map: with one to four balls on beams
    of up to 8 modes, peaks differed by up to 5 % from simulations at mass ratios below 0.15, which are not flagged, by 14 %
    at 0.23 and by 60 % at 0.46. Amplitudes that change from cycle to cycle, which a heavy ball can cause, are not computed.

    A map holds one motion of the damper at each amplitude, the one that follows from the initial state of its case. Others
    may exist. One of them is included: balls at rest without gravity, where the amplitude without dampers is below the gap.

    References
    ----------
    A. Gelb, W. E. Vander Velde (1968), Multiple-Input Describing Functions and Nonlinear System Design, McGraw-Hill.
    N. Meyer, R. Seifried (2021), Granular Matter 23, 64, doi:10.1007/s10035-021-01128-z.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.Case(
    ...     structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="30 Hz")),
    ...     damper=rb.ImpactDamper(
    ...         ball=rb.Sphere(diameter="20 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.5)
    ...     ),
    ...     duration="1 s",
    ...     method=rb.Newton(),
    ... )
    >>> loss_map = rb.loss_map(case, rb.geomspace("0.3 mm", "10 mm", 31), ["25 Hz", "40 Hz"], progress=False)
    >>> structure = rb.SDOF(mass="3 kg", frequency="32 Hz", damping_ratio=0.005)
    >>> response = rb.response_from_map(structure, loss_map, level=["10 N", "20 N"], number=[1, 2])
    >>> response.peak.dims
    ('at', 'number', 'level')
    """
    table = LossTable.read(loss_map)
    model = modes_of(structure)
    levels, unit = _levels(level)
    numbers = [whole_number(each, "number", 1) for each in listed(number)]
    places = points_of_dampers(at, model)
    dampers = DamperPoints(model, tuple(dict.fromkeys(name for place in places for name in place)), table, direction)
    load = _Load.of(model, unit, load_point, load_direction, dampers)
    hertz = default_frequencies(frequencies, table.masses, model, dampers.shapes, max(numbers))
    name, shape = _observed(model, point or places[0][0], dampers.direction, point)
    transfer = Transfer(model, hertz, dampers.shapes, load.force, load.base, shape)
    each = [transfer.at([dampers.points.index(name) for name in place]) for place in places]
    parts = [[MapResponse.of(one, table, count, levels) for count in numbers] for one in each]
    about = {
        "title": "Response from a loss map",
        "study": "response_from_map",
        "point": name,
        "load": load.name,
        "map_case": table.case,
    }
    if table.softening is not None and np.isfinite(table.softening).any():
        about["softening"] = " to ".join(dict.fromkeys(f"{end(table.softening):.3g}" for end in (np.nanmin, np.nanmax)))
    axes = {
        "at": ("at", [" + ".join(place) for place in places], {"long_name": "points of the dampers"}),
        "number": ("number", numbers, _described("1", "number of dampers at each point")),
        "level": ("level", levels, _described(unit, f"amplitude of the {load.name}")),
    }
    result = _dataset(parts, transfer, table, axes, about)
    _check_coverage(result, table)
    if unit == "N":
        return result.assign(force_measures(result, result.amplitude.isel(solution=0, drop=True)))
    return result.assign(transmissibility=_transmissibility(result, load.along(model, name, dampers.direction, point)))


# ---- arguments


def listed(value: object) -> list[Any]:
    """Return a value as a list; a tuple, which stands for several points at once, is one value."""
    return list(value) if isinstance(value, (list, np.ndarray, range)) else [value]


def modes_of(structure: object) -> ModalModel:
    """Return the modes of a structure; raise if it has none."""
    if isinstance(structure, Case):
        raise Hint("a case is not a structure", "case.structure", ["structure"])
    if not isinstance(structure, StructurePart):
        raise Hint(f"{structure!r:.60} is not a structure", 'rb.SDOF(mass="20 kg", frequency="10 Hz")', ["structure"])
    model = structure.modes()
    if not model.stiffness.size:
        raise Hint(
            f"a {structure.kind} structure has no modes", "SDOF, Modal, Matrices or a built-in structure", ["structure"]
        )
    return model


def _quantities(value: object, units: tuple[str, ...], name: str) -> tuple[FloatArray, str | None]:
    """Return values in SI and their unit, None if they are bare numbers."""
    if isinstance(value, Spaced):
        first, last = parse(value.start, units), parse(value.stop, units)
        found, units_found = list(value.values(first[0], last[0])), {first[1], last[1]}
    else:
        pairs = [parse(each, units) for each in listed(value if not isinstance(value, tuple) else list(value))]
        found, units_found = [number for number, _ in pairs], {unit for _, unit in pairs}
    if len(units_found) > 1:
        raise Hint(f"{value!r:.80} has values of different dimensions", "one unit for all", [name])
    if not found or min(found) <= 0:
        raise Hint(f"{value!r:.80}: values must be greater than zero", "omit the others", [name])
    return np.array(found), units_found.pop()


def _levels(level: object) -> tuple[FloatArray, str]:
    levels, unit = _quantities(level, ("N", "m/s^2"), "level")
    if unit is None:
        raise Hint(
            f"{level!r:.60} has no unit, which distinguishes a force from an acceleration of the base",
            '"5 N" or "5 m/s^2"',
            ["level"],
        )
    return levels, unit


def points_of_dampers(at: object, model: ModalModel) -> list[tuple[str, ...]]:
    """Return the points of each arrangement of dampers."""
    places = []
    for item in listed(at):
        names = item if isinstance(item, tuple) else (item,)
        place = tuple(model.point(name) for name in names)
        if not place or len(set(place)) < len(place):
            raise Hint(f"{item!r} names a point twice, or none", "number = 2 for two dampers at each point", ["at"])
        places.append(place)
    if not places or len(set(places)) < len(places):
        raise Hint(f"{at!r} has no item, or the same twice", 'at = "tip"', ["at"])
    return places


class DamperPoints:
    """Points of dampers, and mode shapes there along the direction of the dampers, (P, m)."""

    def __init__(self, model: ModalModel, points: tuple[str, ...], table: LossTable, direction: Any) -> None:
        self.points = points
        given = None if direction is None else unit_vector(direction)
        if given is not None and table.axis is not None and abs(abs(given @ table.axis) - 1) > 1e-6:
            raise Hint(
                f"the dampers move along {direction!r}, but the map was computed for motion along {_axis_name(table.axis)}",
                "a map of the case with that direction",
                ["direction"],
            )
        axis = table.axis if given is None else given
        self.direction = axis
        spatial = [name for name in points if name in model.spatial]
        if spatial and axis is None:
            advice = f'direction = "{main_axis(model.shapes[spatial[0]])}"'
            raise Hint(f"the point {spatial[0]!r} moves in 3-D and needs a direction", advice, ["direction"])
        self.shapes = np.array(
            [
                model.shapes[name] if axis is None or name not in model.spatial else model.shapes[name] @ axis
                for name in points
            ]
        ).reshape(len(points), model.stiffness.size)
        # Projection of the motion of the base along an axis, or along the line on which the points move.
        self.axes = [axis if name in model.spatial else None for name in points]


def _axis_name(axis: FloatArray) -> str:
    names = [name for k, name in enumerate("xyz") if abs(axis[k]) > 1 - 1e-9]
    return names[0] if names else str([round(float(part), 4) for part in axis])


class _Load(NamedTuple):
    """Modal force of a unit level, (m,), and acceleration of the base along the direction of each damper, (P,)."""

    force: FloatArray
    base: FloatArray
    name: str
    axis: FloatArray | None = None  # direction of the motion of the base of a structure in 3-D

    def along(self, model: ModalModel, observed: str, axis: FloatArray | None, given: str | None) -> float:
        """Return the part of the motion of the base along that of the observed point."""
        if self.axis is None or (observed in model.shapes and observed not in model.spatial):
            return 1.0
        if given is None and axis is not None:
            return float(axis @ self.axis)
        return float(self.axis["xyz".index(observed[-1])])

    @classmethod
    def of(cls, model: ModalModel, unit: str, point: Any, direction: Any, dampers: DamperPoints) -> _Load:
        still = np.zeros(len(dampers.points))
        if unit == "N":
            with at("load_point"):
                name = model.point(point, "load_point")
            return cls(model.shape(name, direction), still, f"force at {name}")
        if point is not None:
            raise Hint("the base moves as a whole and has no point", "leave load_point out", ["load_point"])
        if model.participation is None:
            raise Hint("base motion needs the participation of each mode", "Modal(participation=...)", ["structure"])
        if not model.spatial:
            if direction is not None:
                raise Hint("the points of the structure move along one line only", "leave it out", ["load_direction"])
            return cls(-model.participation, still + 1, "acceleration of the base")
        axis = dampers.direction if direction is None else unit_vector(direction)
        if axis is None:
            advice = f'load_direction = "{main_axis(model.participation)}"'
            raise Hint("the base of this structure moves in 3-D", advice, ["load_direction"])
        base = [1.0 if own is None else float(own @ axis) for own in dampers.axes]
        return cls(-(model.participation @ axis), np.array(base), "acceleration of the base", np.asarray(axis))


def _observed(model: ModalModel, name: str, axis: FloatArray | None, given: str | None) -> tuple[str, FloatArray]:
    """Return name and mode shapes of the observed point."""
    if given is None and name in model.spatial and axis is not None:
        return name, np.asarray(model.shapes[name] @ axis)
    lines = model.lines()
    if name not in lines:
        known = " or ".join(lines)
        raise Hint(f"there is no point {name!r}", known, ["point"])
    return name, lines[name]


def default_frequencies(
    given: object, table: MassTable, model: ModalModel, shapes: FloatArray, number: int
) -> FloatArray:
    """Return the frequencies [Hz]: the given ones, or a grid that is finer where resonances are."""
    low, high = table.frequency[0], table.frequency[-1]
    if given is not None:
        hertz, _ = _quantities(given, ("Hz",), "frequencies")
        if np.any(np.diff(hertz) <= 0):
            raise Hint("the frequencies must be strictly rising", "each frequency once, in order", ["frequencies"])
        if not table.covers(hertz).any():
            raise Hint(
                f"all frequencies are outside of the map, which covers {low:g} to {high:g} Hz",
                "frequencies in the map, or a larger map",
                ["frequencies"],
            )
        return hertz
    if low == high:
        return np.array([low])
    parts = [np.geomspace(low, high, _BETWEEN)]
    masses = np.nan_to_num(table.mass.real)
    load = number * (shapes**2).sum(axis=0)
    for squared, decay, each in zip(model.stiffness, model.decay, load, strict=True):
        if squared <= 0:
            continue
        own = np.sqrt(squared) / (2 * np.pi)
        margin = 1 + 0.02 + 6 * decay / np.sqrt(squared)
        lightest = max(1 + each * masses.min(), 0.25)
        ends = own / np.sqrt(1 + each * masses.max()) / margin, own / np.sqrt(min(lightest, 1.0)) * margin
        parts.append(np.geomspace(*ends, _AT_MODES))
    hertz = np.unique(np.concatenate(parts))
    return np.asarray(hertz[(hertz >= low) & (hertz <= high)])


# ---- result


_OVER = ("at", "number", "level", "frequency")
_MOTION, _PEAK, _MODAL = (*_OVER, "solution"), _OVER[:3], (*_OVER[:2], "mode", "map_amplitude")

_VARIABLES: list[tuple[str, tuple[str, ...], str, str]] = [
    ("cavity_amplitude", _MOTION, "map", "largest amplitude of a damper"),
    ("first_harmonic_share", _MOTION, "1", "share of the motion of the dampers in the first harmonic"),
    ("is_unstable", _MOTION, "", "whether the motion is unstable"),
    ("solutions", _OVER, "1", "number of steady motions in the map"),
    ("flags", _OVER, "", "limits of the response"),
    ("interpolation_error", _OVER, "1", "relative change of the largest amplitude with half of the map"),
    ("amplitude_interval", _OVER, "m", "half of the 95 % interval of the largest amplitude, from the map"),
    ("bare_amplitude", _OVER[2:], "m", "amplitude without dampers"),
    ("peak", _PEAK, "m", "largest amplitude over the frequency"),
    ("peak_frequency", _PEAK, "Hz", "frequency of the largest amplitude"),
    ("peak_interpolation_error", _PEAK, "1", "relative change of the peak with half of the map"),
    ("peak_interval", _PEAK, "m", "half of the 95 % interval of the peak, from the map"),
    ("peak_softening_error", _PEAK, "1", "relative change of the peak without the estimated effect of softening"),
    ("mass_ratio", _OVER[:2], "1", "mass of the dampers over the effective mass for an impact"),
    ("damping_ratio", _MODAL, "1", "damping ratio of the mode"),
    ("damping_ratio_interval", _MODAL, "1", "half of the 95 % interval of the damping ratio, from the map"),
    ("mode_frequency", _MODAL, "Hz", "natural frequency of the mode"),
]
"""Name, dimensions, unit ("map": that of the amplitudes of the map) and meaning of variables."""


def _described(units: str, long_name: str) -> dict[str, str]:
    return {"units": units, "long_name": long_name}


def _dataset(
    parts: list[list[MapResponse]], transfer: Transfer, table: LossTable, axes: dict[str, Any], about: dict[str, str]
) -> xarray.Dataset:
    """Return the responses of all arrangements and numbers of dampers."""
    import xarray

    masses = table.masses
    count = max(part.amplitude.shape[-1] for row in parts for part in row)

    def gather(name: str, *, motions: bool = False) -> Any:
        """Return a field of all responses; those of motions padded to the largest number of motions."""
        arrays = [[getattr(part, name) for part in row] for row in parts]
        return np.array([[_padded(array, count) for array in row] for row in arrays] if motions else arrays)

    # Arrangements, numbers and levels have different numbers of coexisting motions.
    amplitude, flags = gather("amplitude", motions=True), gather("flags")
    computed = {
        "solutions": np.isfinite(amplitude).sum(axis=-1),
        "bare_amplitude": np.abs(transfer.bare) * np.array(axes["level"][1])[:, None],
    }
    units = {"map": "m/s^2" if masses.is_acceleration else "m"}
    data: dict[str, Any] = {
        "amplitude": (_MOTION, np.abs(amplitude), _described("m", f"amplitude, {about['point']}")),
        "phase": (_MOTION, np.angle(amplitude), _described("rad", "phase to the load")),
    }
    for name, dims, unit, text in _VARIABLES:
        values = computed[name] if name in computed else gather(name, motions=dims == _MOTION)
        data[name] = dims, values, _described(units.get(unit, unit), text) if unit else {"long_name": text}
    # Warnings of all responses, once each.
    data["flags"][2].update(flag_masks(FLAGS))
    notes = [*_warnings(flags), *_softening_warnings(data["peak_softening_error"][1], about)]
    if table.interval is not None:
        notes += _interval_warnings(data["peak"][1], data["peak_interval"][1])
    modes, motions = transfer.model.stiffness.size, np.arange(1, count + 1)
    axes = axes | {
        "frequency": ("frequency", transfer.frequency, _described("Hz", "frequency")),
        "solution": ("solution", motions, _described("1", "number of the motion, the largest first")),
        "mode": ("mode", np.arange(1, modes + 1), _described("1", "number of the mode")),
        "map_amplitude": (
            "map_amplitude",
            masses.amplitude,
            _described(units["map"], "amplitude of the damper with the largest motion"),
        ),
    }
    return xarray.Dataset(data, axes, about | {"warnings": "\n".join(notes)})


def _padded(array: Any, count: int) -> Any:
    missing = False if array.dtype == bool else np.nan
    shape = (*array.shape[:-1], count - array.shape[-1])
    return np.concatenate([array, np.full(shape, missing, array.dtype)], axis=-1)


def _warnings(flags: NDArray[np.int16]) -> list[str]:
    """Return how many points have each flag."""
    found = []
    for bit, text in enumerate(FLAGS.values()):
        if count := int(np.count_nonzero(flags & (1 << bit))):
            found.append(f"{count} of {flags.size} points: {text}")
    return found


def _interval_warnings(peak: FloatArray, half: FloatArray) -> list[str]:
    """Return a warning if peaks have no interval, although the map has some."""
    lacking = np.isfinite(peak) & np.isnan(half)
    if not lacking.any():
        return []
    return [
        f"{np.count_nonzero(lacking)} of {peak.size} peaks have no 95 % interval: runs of the map are not steady there, or "
        "have too few cycles"
    ]


def _softening_warnings(error: FloatArray, about: dict[str, str]) -> list[str]:
    """Return a warning if the softening of the map may change peaks, or its effect is unknown."""
    softening = about.get("softening", "1")
    if softening == "1":
        return []
    if not np.isfinite(error).any():
        return [f"the effect of softening {softening} in the map is unknown: compare its runs with rb.check_softening"]
    largest = float(np.nanmax(error))
    if largest < _SOFTENED:
        return []
    return [f"softening {softening} in the map may change a peak by {100 * largest:.2g} %, see peak_softening_error"]


def force_measures(result: xarray.Dataset, amplitude: xarray.DataArray) -> dict[str, xarray.DataArray]:
    """Return the smallest real part of the response to a force, and the smallest force over displacement.

    Parameters
    ----------
    result
        Dataset over level and frequency with `phase` and `bare_amplitude`.
    amplitude
        Amplitude of the displacement [m]; NaN where it is unknown.
    """
    phase = result.phase.isel(solution=0) if "solution" in result.phase.dims else result.phase
    response = amplitude / result.level * np.exp(1j * phase)
    real = response.reduce(
        lambda values, axis: np.apply_along_axis(
            lambda one: minimum_real_part(result.frequency.values, one), axis, values
        ),
        "frequency",
    )
    compliance = abs(response).max("frequency")
    # The response without dampers stands for the largest possible one where it is unknown, as for `peak`.
    possible = (result.bare_amplitude / result.level).where(np.isnan(response)).max("frequency").fillna(0.0)
    known = {
        "minimum_real_part": (real.where(possible <= -real), "m/N", "smallest real part of displacement over force"),
        "dynamic_stiffness": (1 / compliance.where(possible <= compliance), "N/m", "smallest force over displacement"),
    }
    return {name: values.assign_attrs(_described(unit, text)) for name, (values, unit, text) in known.items()}


def _transmissibility(result: xarray.Dataset, along: float) -> xarray.DataArray:
    """Return the absolute acceleration of the observed point over that of the base."""
    relative = result.amplitude * np.exp(1j * result.phase) / result.level
    absolute: xarray.DataArray = abs(along - (2 * np.pi * result.frequency) ** 2 * relative)
    return absolute.transpose(*result.amplitude.dims).assign_attrs(
        _described("1", "absolute acceleration of the point over that of the base")
    )


def _check_coverage(result: xarray.Dataset, table: LossTable) -> None:
    """Raise if the map covers no motion at a level; warn if runs of the map exceeded a limit."""
    masses = table.masses
    covered = masses.covers(result.frequency.values)
    ends = f"{masses.amplitude[0]:.4g} to {masses.amplitude[-1]:.4g} {'m/s^2' if masses.is_acceleration else 'm'}"
    for level in result.level.values:
        one = result.sel(level=level)
        below, above = (one.flags.values & (1 << list(FLAGS).index(name)) > 0 for name in ("below_map", "above_map"))
        if not np.isfinite(one.amplitude).any() and (below | above)[..., covered].all():
            size = "larger" if above.any() else "smaller"
            raise Hint(
                f"at {level:g} {result.level.attrs['units']} the motions of the dampers are {size} than the amplitudes of "
                f"the map, {ends}, at all frequencies",
                f"a map with {size} amplitudes, or another level",
                ["level"],
            )
    flag = 1 << list(FLAGS).index("map_warning")
    if count := int(np.count_nonzero(result.flags.values & flag)):
        warnings.warn(
            f"{count} of {result.flags.size} points of the response use runs of the map that exceeded a validity limit "
            f"({table.limits.replace(' ', ', ')}); see loss_map.warnings; try: a smaller softening in the case of the map",
            stacklevel=3,
        )
