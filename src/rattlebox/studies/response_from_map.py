"""Response of a structure with dampers in the first harmonic, from the loss map of one damper."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import DataError, RattleboxError
from rattlebox.analysis.describing_function import MassTable, Solutions, damping_of_modes, solve
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint
from rattlebox.model.modes import ModalModel
from rattlebox.model.particle_case import direction_of_base
from rattlebox.model.space import Triple, unit_vector
from rattlebox.model.structures import StructurePart
from rattlebox.model.units import parse, whole_number
from rattlebox.studies.sampling import Spaced
from rattlebox.studies.stored import open_study

if TYPE_CHECKING:
    import xarray

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

AMPLITUDE, FREQUENCY = "structure.motion.amplitude", "structure.motion.frequency"
"""Axes of a loss map."""

FLAGS = {
    "several_solutions": "several steady motions coexist",
    "below_map": "a motion of a damper is below the amplitudes of the map",
    "above_map": "a motion of a damper is above the amplitudes of the map",
    "outside_frequencies": "the frequency is outside of the map",
    "not_found": "a motion was not found, because runs of the map failed or the search did",
    "map_warning": "runs of the map next to the motion exceeded a validity limit",
}
"""Names of flags and their meaning."""

_AT_MODES = 201
_BETWEEN = 200
"""Default numbers of frequencies around each natural frequency, and over the range of the map."""


def response_from_map(
    structure: StructurePart,
    loss_map: xarray.Dataset | str | os.PathLike[str],
    *,
    level: Any,
    number: int | Sequence[int] = 1,
    at: str | tuple[str, ...] | list[str | tuple[str, ...]] | None = None,
    frequencies: Any = None,
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
        `cavity_amplitude`, the largest of the dampers, in the unit of the map; `is_unstable` between two folds. Over
        level and frequency: `bare_amplitude` without dampers. Over `at`, `number` and `level`: `peak` [m], the largest
        amplitude, and `peak_frequency`; NaN if the response may be larger where the map does not cover it. Over `at`,
        `number`, `mode` and `map_amplitude`, that of the damper with the largest motion: `damping_ratio` and
        `mode_frequency`. What the map does not cover is NaN. The attribute `warnings` counts it.

    Raises
    ------
    CaseError
        If an argument is not valid, or the map covers no motion at a level.
    DataError
        If the file of the map cannot be read.

    Notes
    -----
    See `rattlebox.analysis.describing_function` for the method. It holds where the cavity moves almost harmonically. It
    cannot compute amplitudes that change from cycle to cycle, which a heavy ball can cause, and a motion of the damper that
    the map, which starts from the initial state of its case, did not reach.

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
    table = _Map.read(loss_map)
    model = _modes(structure)
    levels, unit = _levels(level)
    numbers = [whole_number(each, "number", 1) for each in _listed(number)]
    places = _places(at, model)
    dampers = _Dampers(model, tuple(dict.fromkeys(name for place in places for name in place)), table, direction)
    load = _Load.of(model, unit, load_point, load_direction, dampers)
    hertz = _frequencies(frequencies, table.masses, model, dampers.shapes, max(numbers))
    transfer = _Transfer.of(
        model, hertz, load, dampers, _observed(model, point or places[0][0], dampers.direction, point)
    )
    parts = [[_Response.of(transfer, table, place, count, levels) for count in numbers] for place in places]
    result = _dataset(parts, transfer, table, levels, unit, numbers, places)
    _check_coverage(result, unit, table)
    return result


# ---- arguments


def _listed(value: Any) -> list[Any]:
    return list(value) if isinstance(value, (list, np.ndarray, range)) else [value]


def _modes(structure: Any) -> ModalModel:
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


def _quantities(value: Any, units: tuple[str, ...], name: str) -> tuple[FloatArray, str | None]:
    """Return values in SI and their unit, None if they are bare numbers."""
    if isinstance(value, Spaced):
        first, last = parse(value.start, units), parse(value.stop, units)
        found, units_found = list(value.values(first[0], last[0])), {first[1], last[1]}
    else:
        pairs = [parse(each, units) for each in _listed(value if not isinstance(value, tuple) else list(value))]
        found, units_found = [number for number, _ in pairs], {unit for _, unit in pairs}
    if len(units_found) > 1:
        raise Hint(f"{value!r:.80} has values of different dimensions", "one unit for all", [name])
    if not found or min(found) <= 0:
        raise Hint(f"{value!r:.80}: values must be greater than zero", place=[name])
    return np.array(found), units_found.pop()


def _levels(level: Any) -> tuple[FloatArray, str]:
    levels, unit = _quantities(level, ("N", "m/s^2"), "level")
    if unit is None:
        raise Hint(
            f"{level!r:.60} has no unit, which tells a force from an acceleration of the base",
            '"5 N" or "5 m/s^2"',
            ["level"],
        )
    return levels, unit


def _places(at: Any, model: ModalModel) -> list[tuple[str, ...]]:
    """Return the points of each arrangement of dampers."""
    places = []
    for item in _listed(at):
        names = item if isinstance(item, tuple) else (item,)
        place = tuple(model.point(name) for name in names)
        if not place or len(set(place)) < len(place):
            raise Hint(f"{item!r} names a point twice, or none", "number = 2 for two dampers at each point", ["at"])
        places.append(place)
    if not places or len(set(places)) < len(places):
        raise Hint(f"{at!r} has no item, or the same twice", 'at = "tip"', ["at"])
    return places


@dataclass(frozen=True, eq=False)
class _Map:
    """A loss map: apparent mass, direction of the motion, and points whose runs exceeded a validity limit, (K, J)."""

    masses: MassTable
    axis: FloatArray | None
    is_doubtful: NDArray[np.bool_]
    case: str
    limits: str

    @classmethod
    def read(cls, source: Any) -> _Map:
        import xarray

        data = source
        if isinstance(source, (str, os.PathLike)):
            data = open_study(source) if Path(source).is_dir() else _open_file(source)
        if not isinstance(data, xarray.Dataset) or not {"effective_mass", "damping_mass", AMPLITUDE, FREQUENCY} <= set(
            data.variables
        ):
            what = f"{source!r:.60}" if not isinstance(data, xarray.Dataset) else "the dataset"
            raise Hint(f"{what} is not a loss map", "rb.loss_map(case, amplitudes, frequencies)", ["loss_map"])
        data = data.transpose(AMPLITUDE, FREQUENCY, ...).sortby([AMPLITUDE, FREQUENCY])
        unit = data[AMPLITUDE].attrs.get("units")
        if unit not in ("m", "m/s^2"):
            raise Hint(
                f"the amplitudes of the map have the unit {unit!r}", '"m" or "m/s^2" in their attributes', ["loss_map"]
            )
        if data.sizes[AMPLITUDE] < 2:
            raise Hint("a map with one amplitude cannot be interpolated", "two amplitudes or more", ["loss_map"])
        mass = (data.effective_mass - 1j * data.damping_mass).values
        if "status" in data:
            mass = np.where(data.status.values == 0, mass, np.nan)
        doubtful = data.warnings.values > 0 if "warnings" in data else np.zeros(mass.shape, bool)
        names = str(data.warnings.attrs.get("flag_meanings", "")) if "warnings" in data else ""
        text = str(data.attrs.get("case", ""))
        return cls(
            MassTable(data[FREQUENCY].values, data[AMPLITUDE].values, mass, unit == "m/s^2"),
            _axis_of(text),
            doubtful,
            text,
            names,
        )

    def doubtful_at(self, frequency: FloatArray, amplitude: FloatArray) -> NDArray[np.bool_]:
        """Return whether a neighbouring point of the map exceeded a limit: (F,) and (F, ...) give (F, ...)."""
        x, nodes = self.masses.amplitude, self.masses.frequency
        k = np.clip(np.searchsorted(x, amplitude) - 1, 0, x.size - 2)
        j = np.clip(np.searchsorted(nodes, frequency) - 1, 0, max(nodes.size - 2, 0))
        j = j.reshape(-1, *[1] * (amplitude.ndim - 1))
        right = np.minimum(j + 1, nodes.size - 1)
        near = [self.is_doubtful[a, b] for a in (k, k + 1) for b in (j, right)]
        return np.asarray(np.any(near, axis=0) & np.isfinite(amplitude))


def _open_file(path: Any) -> xarray.Dataset:
    import xarray

    if not Path(path).exists():
        raise DataError(f"{path} does not exist", "a file of rb.loss_map(...).to_netcdf")
    try:
        return xarray.load_dataset(path)
    except Exception as error:
        raise DataError(
            f"{path} cannot be read as netCDF: {str(error).splitlines()[0]:.200}",
            "a file of rb.loss_map(...).to_netcdf",
        ) from None


def _axis_of(text: str) -> FloatArray | None:
    """Return the direction of the motion of a map; None if it has none, as for impact dampers."""
    if not text:
        return None
    try:
        case = Case.from_toml(text)
    except RattleboxError:  # it names a file of another computer, such as a measured law
        return None
    (motion,) = case.shaker_motion
    if not case.particle_dampers:
        return None if motion.direction is None else unit_vector(motion.direction)
    return np.asarray(direction_of_base(case, motion))


class _Dampers:
    """Points of dampers, and mode shapes there along the direction of the dampers, (P, m)."""

    def __init__(self, model: ModalModel, points: tuple[str, ...], table: _Map, direction: Any) -> None:
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
            raise Hint(f"the point {spatial[0]!r} moves in 3-D and needs a direction", 'direction = "z"', ["direction"])
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

    @classmethod
    def of(cls, model: ModalModel, unit: str, point: Any, direction: Any, dampers: _Dampers) -> _Load:
        still = np.zeros(len(dampers.points))
        if unit == "N":
            try:
                name = model.point(point)
            except Hint as error:
                raise Hint(
                    error.complaint, error.suggestion.replace("point =", "load_point ="), ["load_point"]
                ) from None
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
            raise Hint("the base of this structure moves in 3-D", 'load_direction = "z"', ["load_direction"])
        base = [1.0 if own is None else float(own @ axis) for own in dampers.axes]
        return cls(-(model.participation @ axis), np.array(base), "acceleration of the base")


def _observed(model: ModalModel, name: str, axis: FloatArray | None, given: str | None) -> tuple[str, FloatArray]:
    """Return name and mode shapes of the observed point."""
    if given is None and name in model.spatial and axis is not None:
        return name, np.asarray(model.shapes[name] @ axis)
    lines = model.lines()
    if name not in lines:
        known = " or ".join(lines)
        raise Hint(f"there is no point {name!r}", known, ["point"])
    return name, lines[name]


def _frequencies(given: Any, table: MassTable, model: ModalModel, shapes: FloatArray, number: int) -> FloatArray:
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


# ---- response


@dataclass(frozen=True, eq=False)
class _Transfer:
    """Responses of the structure without dampers to a unit level, and to unit forces of P dampers, at F frequencies.

    Attributes
    ----------
    frequency : (F,) float
        Frequencies [Hz].
    gain : (F, P, P) complex
        Accelerations at the dampers per force on the structure [1/kg].
    drive : (F, P) complex
        Accelerations at the dampers per level.
    to_point : (F, P) complex
        Displacement of the observed point per force of each damper [m/N].
    bare : (F,) complex
        Displacement of the observed point per level.
    points
        Names of the points of the dampers.
    """

    frequency: FloatArray
    gain: ComplexArray
    drive: ComplexArray
    to_point: ComplexArray
    bare: ComplexArray
    points: tuple[str, ...]
    observed: str
    load: str
    model: ModalModel
    shapes: FloatArray

    @classmethod
    def of(
        cls, model: ModalModel, hertz: FloatArray, load: _Load, dampers: _Dampers, observed: tuple[str, FloatArray]
    ) -> _Transfer:
        omega = 2 * np.pi * hertz
        with np.errstate(divide="ignore", invalid="ignore"):  # an undamped structure at a natural frequency
            q = model.harmonic_response(omega, np.column_stack([load.force, dampers.shapes.T]))
        at_dampers = np.asarray(-(omega[:, None, None] ** 2) * (dampers.shapes @ q), np.complex128)
        at_point = np.asarray(observed[1] @ q, np.complex128)
        return cls(
            hertz,
            at_dampers[:, :, 1:],
            at_dampers[:, :, 0] + load.base,
            at_point[:, 1:],
            at_point[:, 0],
            dampers.points,
            observed[0],
            load.name,
            model,
            dampers.shapes,
        )


@dataclass(frozen=True, eq=False)
class _Response:
    """Response with a number of dampers at some points: arrays over (L, F) and (L, F, S), modes over (m, K)."""

    amplitude: ComplexArray
    cavity_amplitude: FloatArray
    solutions: Solutions
    flags: NDArray[np.int8]
    interpolation_error: FloatArray
    peak: FloatArray
    peak_frequency: FloatArray
    peak_error: FloatArray
    mode_frequency: FloatArray
    damping_ratio: FloatArray

    @classmethod
    def of(cls, transfer: _Transfer, table: _Map, place: tuple[str, ...], number: int, levels: FloatArray) -> _Response:
        own = [transfer.points.index(name) for name in place]
        solutions, amplitude, largest = _motions(transfer, table.masses, own, number, levels)
        omega = 2 * np.pi * transfer.frequency
        cavity = largest if table.masses.is_acceleration else largest / omega[:, None] ** 2
        peak, where = _peaks(transfer, solutions, np.abs(amplitude), levels)
        errors, peak_errors = [], []
        for axis in (True, False):
            thinned = table.masses.thinned(axis)
            if thinned is None:
                continue
            others, changed, _ = _motions(transfer, thinned, own, number, levels)
            with np.errstate(invalid="ignore"):
                errors.append(np.abs(np.abs(changed[..., 0]) / np.abs(amplitude[..., 0]) - 1))
                peak_errors.append(np.abs(_peaks(transfer, others, np.abs(changed), levels)[0] / peak - 1))
        masks = (
            np.isfinite(cavity).sum(axis=-1) > 1,
            solutions.is_below,
            solutions.is_above,
            np.broadcast_to(~table.masses.covers(transfer.frequency), solutions.is_below.shape),
            solutions.is_lost,
            table.doubtful_at(transfer.frequency, np.moveaxis(cavity, 1, 0)).any(axis=-1).T,
        )
        model = transfer.model
        damping = np.diag(2 * model.decay) + (0.0 if model.coupling is None else model.coupling)
        frequency, ratio = damping_of_modes(table.masses, model.stiffness, damping, transfer.shapes[own], number)
        return cls(
            amplitude,
            cavity,
            solutions,
            np.asarray(sum(mask.astype(np.int8) << bit for bit, mask in enumerate(masks)), np.int8),
            np.max(errors, axis=0) if errors else np.full(solutions.is_below.shape, np.nan),
            peak,
            where,
            np.max(peak_errors, axis=0) if peak_errors else np.full(peak.shape, np.nan),
            frequency,
            ratio,
        )


def _motions(
    transfer: _Transfer, masses: MassTable, own: list[int], number: int, levels: FloatArray
) -> tuple[Solutions, ComplexArray, FloatArray]:
    """Return the motions of the dampers, the observed displacement, (L, F, S), and the largest acceleration of a damper."""
    gain = number * transfer.gain[:, own][:, :, own]
    solutions = solve(masses, transfer.frequency, gain, transfer.drive[:, own], levels)
    moved = np.moveaxis(solutions.acceleration, 1, 0)  # (F, L, S, P)
    omega = 2 * np.pi * transfer.frequency.reshape(-1, 1, 1, 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.log(np.abs(moved)) - masses.log_acceleration(omega)
        mass, _ = masses.evaluate(transfer.frequency, np.nan_to_num(logs, nan=masses.limits[0]))
    force = -number * mass * moved
    bare = transfer.bare[:, None] * levels
    displacement = bare[:, :, None] + np.einsum("flsp,fp->fls", force, transfer.to_point[:, own])
    return solutions, np.moveaxis(displacement, 0, 1), np.abs(solutions.acceleration).max(axis=-1)


def _peaks(
    transfer: _Transfer, solutions: Solutions, amplitude: FloatArray, levels: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the largest amplitude at each level and its frequency; NaN if it may be where the map does not cover it."""
    most = np.where(np.isfinite(amplitude), amplitude, -np.inf).max(axis=-1)
    peak, where = most.max(axis=1), transfer.frequency[most.argmax(axis=1)]
    # Below the map the damper has no known effect: the bare amplitude stands for the largest possible response there.
    bare = np.abs(transfer.bare) * levels[:, None]
    unknown = solutions.is_above | solutions.is_lost | (solutions.is_below & (bare > peak[:, None]))
    known = np.isfinite(peak) & ~unknown.any(axis=1)
    return np.where(known, peak, np.nan), np.where(known, where, np.nan)


# ---- result


def _dataset(
    parts: list[list[_Response]],
    transfer: _Transfer,
    table: _Map,
    levels: FloatArray,
    unit: str,
    numbers: list[int],
    places: list[tuple[str, ...]],
) -> xarray.Dataset:
    import xarray

    masses = table.masses
    count = max(part.amplitude.shape[-1] for row in parts for part in row)
    over = ("at", "number", "level", "frequency")

    def gather(name: str, missing: Any = None) -> Any:
        arrays = [[getattr(part, name) for part in row] for row in parts]
        if missing is None:
            return np.array(arrays)
        return np.array([[_padded(array, count, missing) for array in row] for row in arrays])

    def described(units: str, long_name: str) -> dict[str, str]:
        return {"units": units, "long_name": long_name}

    amplitude = gather("amplitude", np.nan)
    unstable = np.array([[_padded(part.solutions.is_unstable, count, False) for part in row] for row in parts])
    map_unit = "m/s^2" if masses.is_acceleration else "m"
    flags = gather("flags")
    flag_attributes = {
        "long_name": "limits of the response",
        "flag_masks": [1 << bit for bit in range(len(FLAGS))],
        "flag_meanings": " ".join(FLAGS),
    }
    motion, modal = (*over, "solution"), (*over[:2], "mode", "map_amplitude")
    return xarray.Dataset(
        {
            "amplitude": (motion, np.abs(amplitude), described("m", f"amplitude, {transfer.observed}")),
            "phase": (motion, np.angle(amplitude), described("rad", "phase to the load")),
            "cavity_amplitude": (
                motion,
                gather("cavity_amplitude", np.nan),
                described(map_unit, "largest amplitude of a damper"),
            ),
            "is_unstable": (motion, unstable, {"long_name": "whether the motion is unstable"}),
            "solutions": (
                over,
                np.isfinite(amplitude).sum(axis=-1),
                described("1", "number of steady motions in the map"),
            ),
            "flags": (over, flags, flag_attributes),
            "interpolation_error": (
                over,
                gather("interpolation_error"),
                described("1", "relative change of the largest amplitude with half of the map"),
            ),
            "bare_amplitude": (
                over[2:],
                np.abs(transfer.bare) * levels[:, None],
                described("m", "amplitude without dampers"),
            ),
            "peak": (over[:3], gather("peak"), described("m", "largest amplitude over the frequency")),
            "peak_frequency": (
                over[:3],
                gather("peak_frequency"),
                described("Hz", "frequency of the largest amplitude"),
            ),
            "peak_interpolation_error": (
                over[:3],
                gather("peak_error"),
                described("1", "relative change of the peak with half of the map"),
            ),
            "damping_ratio": (modal, gather("damping_ratio"), described("1", "damping ratio of the mode")),
            "mode_frequency": (modal, gather("mode_frequency"), described("Hz", "natural frequency of the mode")),
        },
        {
            "at": ("at", [" + ".join(place) for place in places], {"long_name": "points of the dampers"}),
            "number": ("number", numbers, described("1", "number of dampers at each point")),
            "level": ("level", levels, described(unit, f"amplitude of the {transfer.load}")),
            "frequency": ("frequency", transfer.frequency, described("Hz", "frequency")),
            "solution": (
                "solution",
                np.arange(1, count + 1),
                described("1", "number of the motion, the largest first"),
            ),
            "mode": ("mode", np.arange(1, transfer.model.stiffness.size + 1), described("1", "number of the mode")),
            "map_amplitude": (
                "map_amplitude",
                masses.amplitude,
                described(map_unit, "amplitude of the damper with the largest motion"),
            ),
        },
        {
            "title": "Response from a loss map",
            "point": transfer.observed,
            "load": transfer.load,
            "map_case": table.case,
            "warnings": "\n".join(_warnings(flags)),
        },
    )


def _padded(array: Any, count: int, missing: Any) -> Any:
    shape = (*array.shape[:-1], count - array.shape[-1])
    return np.concatenate([array, np.full(shape, missing, array.dtype)], axis=-1)


def _warnings(flags: NDArray[np.int8]) -> list[str]:
    """Return how many points have each flag."""
    found = []
    for bit, text in enumerate(FLAGS.values()):
        if count := int(np.count_nonzero(flags & (1 << bit))):
            found.append(f"{count} of {flags.size} points: {text}")
    return found


def _check_coverage(result: xarray.Dataset, unit: str, table: _Map) -> None:
    """Raise if the map covers no motion at a level; warn if runs of the map exceeded a limit."""
    masses = table.masses
    covered = masses.covers(result.frequency.values)
    ends = " to ".join(f"{value:.4g}" for value in (masses.amplitude[0], masses.amplitude[-1]))
    for level in result.level.values:
        one = result.sel(level=level)
        below, above = (one.flags.values & (1 << list(FLAGS).index(name)) > 0 for name in ("below_map", "above_map"))
        if not np.isfinite(one.amplitude).any() and (below | above)[..., covered].all():
            size = "larger" if above.any() else "smaller"
            raise Hint(
                f"at {level:g} {unit} the motions of the dampers are {size} than the amplitudes of the map, {ends}"
                f" {'m/s^2' if masses.is_acceleration else 'm'}, at all frequencies",
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
