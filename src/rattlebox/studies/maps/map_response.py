"""Loss maps as tables, and the response of a structure with dampers in the first harmonic, over level and frequency."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import DataError, RattleboxError
from rattlebox.analysis.describing_function import MassTable, Solutions, damping_of_modes, solve, solve_near
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint
from rattlebox.model.modes import ModalModel
from rattlebox.model.particle_case import direction_of_base
from rattlebox.model.space import unit_vector
from rattlebox.studies.run.stored import open_study
from rattlebox.studies.work.measures import INTERVAL
from rattlebox.studies.work.variants import AMPLITUDE, FREQUENCY

if TYPE_CHECKING:
    import xarray


# ---- loss map


FloatArray = NDArray[np.float64]

_REQUIRED = {"effective_mass", "damping_mass", AMPLITUDE, FREQUENCY}
_SOURCE = "a file of rb.loss_map(...).to_netcdf"


@dataclass(frozen=True, eq=False)
class LossTable:
    """A loss map over K amplitudes and J frequencies."""

    masses: MassTable
    mass: float  # Mass of the particles [kg]; NaN if it is unknown
    interval: FloatArray | None  # Half of the 95 % intervals of m' and m'' [kg], (K, J, 2)
    # Harmonics 2 to N + 1 of the force over the acceleration of the cavity [kg], (K, J, N)
    harmonics: FloatArray | None
    # Variation of the first harmonic of the force from cycle to cycle over the acceleration of the cavity [kg], (K, J)
    variation: FloatArray | None
    # Softening of each run, and its estimated effect on the loss in a cycle over m V^2; NaN where it is unknown, (K, J)
    softening: FloatArray | None
    softening_change: FloatArray | None
    is_doubtful: NDArray[np.bool_]  # Whether the run exceeded a validity limit, (K, J)
    axis: FloatArray | None  # Direction of the motion; None if it has none, as for impact dampers, (3,)
    clearance: float  # Smallest clearance of impact dampers without gravity, whose balls may stay at rest [m]; else 0
    case: str
    limits: str

    @classmethod
    def read(cls, source: object) -> LossTable:
        """Read a map."""
        import xarray

        data = source
        if isinstance(source, (str, os.PathLike)):
            data = open_study(source) if Path(source).is_dir() else _open_file(source)
        if not isinstance(data, xarray.Dataset) or not set(data.variables) >= _REQUIRED:
            what = "the dataset" if isinstance(data, xarray.Dataset) else f"{source!r:.60}"
            raise Hint(f"{what} is not a loss map", "rb.loss_map(case, amplitudes, frequencies)", ["loss_map"])
        data = data.transpose(AMPLITUDE, FREQUENCY, ...).sortby([AMPLITUDE, FREQUENCY])
        unit = data[AMPLITUDE].attrs.get("units")
        if unit not in ("m", "m/s^2"):
            advice = '"m" or "m/s^2" in their attributes'
            raise Hint(f"the amplitudes of the map have the unit {unit!r}", advice, ["loss_map"])
        if data.sizes[AMPLITUDE] < 2:
            raise Hint("a map with one amplitude cannot be interpolated", "two amplitudes or more", ["loss_map"])
        mass = (data.effective_mass - 1j * data.damping_mass).values
        if "status" in data:
            mass = np.where(data.status.values == 0, mass, np.nan)
        amplitude, frequency = data[AMPLITUDE].values, data[FREQUENCY].values
        squared = 1.0 if unit == "m/s^2" else (2 * np.pi * frequency) ** 2
        acceleration = amplitude[:, None] * squared
        intervals = [name + INTERVAL for name in ("effective_mass", "damping_mass")]
        text = str(data.attrs.get("case", ""))
        return cls(
            MassTable(frequency, amplitude, mass, unit == "m/s^2"),
            float(data.get("particle_mass", np.nan)),
            np.stack([data[name].values for name in intervals], axis=2) if set(intervals) <= set(data) else None,
            data.force_harmonics.values / acceleration[..., None] if "force_harmonics" in data else None,
            data.force_variation.values / acceleration if "force_variation" in data else None,
            data.softening.values if "softening" in data else None,
            data.softening_change.values if "softening_change" in data else None,
            data.warnings.values > 0 if "warnings" in data else np.zeros(mass.shape, bool),
            *_axis_and_clearance(text),
            text,
            _exceeded(data.warnings) if "warnings" in data else "",
        )

    @cached_property
    def thinned(self) -> list[MassTable]:
        """Apparent masses without every second amplitude, and without every second frequency, where these are enough."""
        return [each for each in (self.masses.thinned(True), self.masses.thinned(False)) if each is not None]

    @cached_property
    def shifted(self) -> list[MassTable]:
        """Apparent masses with m' and with m'' larger by half of their intervals; empty if the map has none."""
        if self.interval is None or not np.isfinite(self.interval).any():
            return []
        half = np.nan_to_num(self.interval)
        return [replace(self.masses, mass=self.masses.mass + step) for step in (half[..., 0], -1j * half[..., 1])]

    @cached_property
    def unsoftened(self) -> MassTable | None:
        """Apparent masses whose m'' is smaller by the estimated effect of softening; None if it is unknown somewhere."""
        if self.softening_change is None or not np.isfinite(self.mass):
            return None
        change = np.where(np.isnan(self.masses.mass), 0.0, self.softening_change)
        shift = 1j * change * self.mass / np.pi
        return replace(self.masses, mass=self.masses.mass + shift) if np.isfinite(change).all() else None

    def has_interval(self, frequency: FloatArray, amplitude: FloatArray) -> NDArray[np.bool_]:
        """Return whether the map has intervals around each amplitude; the arguments are those of `interpolate`."""
        if self.interval is None:
            return np.zeros(amplitude.shape, bool)
        missing = ~np.isfinite(self.interval).all(axis=-1)
        return np.asarray(self.interpolate(missing.astype(float), frequency, amplitude) == 0)

    def interpolate(self, values: FloatArray, frequency: FloatArray, amplitude: FloatArray) -> FloatArray:
        """Interpolate values of the map linearly in the logarithms of amplitude and frequency.

        `values`: values over the map, (K, J, ...). `frequency`: frequencies [Hz]; those outside of the map are moved to its
        edge, (F,). `amplitude`: amplitudes of the cavity; the same holds for them, (F, ...). Returns values at each
        amplitude, (F, ..., ...).
        """
        x = np.log(np.nan_to_num(amplitude, nan=self.masses.amplitude[0]))
        k, along = _place(np.log(self.masses.amplitude), x)
        j, across = _place(np.log(self.masses.frequency), np.log(frequency).reshape(-1, *[1] * (amplitude.ndim - 1)))
        right = np.minimum(j + 1, self.masses.frequency.size - 1)
        more = (..., *[None] * (values.ndim - 2))
        along, across = np.broadcast_arrays(along, across)
        low = (1 - along[more]) * values[k, j] + along[more] * values[k + 1, j]
        high = (1 - along[more]) * values[k, right] + along[more] * values[k + 1, right]
        return np.asarray(np.where(across[more] > 0, (1 - across[more]) * low + across[more] * high, low))


def _place(nodes: FloatArray, x: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
    """Return the interval of nodes in which each value lies and the position in it, 0 to 1."""
    if nodes.size == 1:
        return np.zeros(x.shape, np.intp), np.zeros(x.shape)
    k = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, nodes.size - 2)
    return k, np.clip((x - nodes[k]) / (nodes[k + 1] - nodes[k]), 0.0, 1.0)


def _exceeded(warnings: xarray.DataArray) -> str:
    """Return the names of the validity limits that runs of a map exceeded."""
    names = str(warnings.attrs.get("flag_meanings", "")).split()
    return " ".join(name for bit, name in enumerate(names) if (warnings.values.astype(int) & 1 << bit).any())


def _open_file(path: Any) -> xarray.Dataset:
    import xarray

    if not Path(path).exists():
        raise DataError(f"{path} does not exist", _SOURCE)
    try:
        return xarray.load_dataset(path)
    except Exception as error:  # the libraries that read netCDF raise nearly any exception for damaged files
        raise DataError(f"{path} cannot be read as netCDF: {str(error).splitlines()[0]:.200}", _SOURCE) from None


def _axis_and_clearance(text: str) -> tuple[FloatArray | None, float]:
    """Return the direction of the motion of the case of a map, and the clearance of balls without gravity, else 0."""
    if not text:
        return None, 0.0
    try:
        case = Case.from_toml(text)
    except RattleboxError:  # it names a file of another computer, such as a measured law
        return None, 0.0
    (motion,) = case.shaker_motion
    if case.particle_dampers:
        return np.asarray(direction_of_base(case.particle_dampers, motion)), 0.0
    axis = None if motion.direction is None else unit_vector(motion.direction)
    weightless = all(damper.gravity == 0 for damper in case.impact_dampers)
    return axis, min(damper.clearance for damper in case.impact_dampers) if weightless else 0.0


# ---- response


ComplexArray = NDArray[np.complex128]

FLAGS = {
    "several_solutions": "several steady motions coexist",
    "below_map": "a motion of a damper is below the amplitudes of the map",
    "above_map": "a motion of a damper is above the amplitudes of the map",
    "outside_frequencies": "the frequency is outside of the map",
    "not_found": "a motion was not found, because runs of the map failed or the search did",
    "higher_harmonics": "less than 95 % of the motion of the dampers is in the first harmonic",
    "heavy_damper": "the mass of the dampers is over 15 % of the effective mass for an impact, so that impacts are weaker",
    "map_warning": "runs of the map next to the motion exceeded a validity limit",
}
"""Names of flags and their meaning."""

_SAME = 0.01
"""Relative difference of motions below which they count as one."""

HEAVY = 0.15
"""Mass of the dampers at a point over the effective mass for an impact there, above which motions are flagged."""

LEAST_SHARE = 0.95
"""Share of the mean square velocity in the first harmonic below which a motion is flagged."""


@dataclass(frozen=True, eq=False)
class Transfer:
    """Responses of a structure without dampers to a unit level, and to unit forces of P dampers, at F frequencies."""

    model: ModalModel
    frequency: FloatArray  # Frequencies [Hz], (F,)
    shapes: FloatArray  # Mode shapes at the dampers, (P, m)
    force: FloatArray  # Modal force of a unit level, (m,)
    base: FloatArray  # Acceleration of the base along each damper at a unit level, (P,)
    observed: FloatArray  # Mode shapes at the observed point, (m,)

    @cached_property
    def _modal(self) -> ComplexArray:
        """Modal displacements per level, and per force of each damper, (F, m, 1 + P)."""
        with np.errstate(divide="ignore", invalid="ignore"):  # an undamped structure at a natural frequency
            return self.model.harmonic_response(
                2 * np.pi * self.frequency, np.column_stack([self.force, self.shapes.T])
            )

    def _accelerations(self, modal: ComplexArray, frequency: FloatArray) -> ComplexArray:
        return np.asarray(-((2 * np.pi * frequency[:, None, None]) ** 2) * (self.shapes @ modal), np.complex128)

    @cached_property
    def gain(self) -> ComplexArray:
        """Accelerations at the dampers per force on the structure, (F, P, P) [1/kg]."""
        return self._accelerations(self._modal[:, :, 1:], self.frequency)

    @cached_property
    def drive(self) -> ComplexArray:
        """Accelerations at the dampers per level, (F, P)."""
        return np.asarray(self._accelerations(self._modal[:, :, :1], self.frequency)[:, :, 0] + self.base)

    @cached_property
    def to_point(self) -> ComplexArray:
        """Displacement of the observed point per force of each damper, (F, P) [m/N]."""
        return np.asarray(self.observed @ self._modal[:, :, 1:])

    @cached_property
    def bare(self) -> ComplexArray:
        """Displacement of the observed point per level, (F,)."""
        return np.asarray(self._modal[:, :, 0] @ self.observed)

    def harmonic_gain(self, harmonic: int) -> FloatArray:
        """Return the magnitude of velocities at the dampers per force at a multiple of the frequency, (F, P, P) [s/kg]."""
        frequency = harmonic * self.frequency
        with np.errstate(divide="ignore", invalid="ignore"):
            modal = self.model.harmonic_response(2 * np.pi * frequency, self.shapes.T)
        return np.abs(self._accelerations(modal, frequency)) / (2 * np.pi * frequency[:, None, None])

    def at(self, dampers: list[int]) -> Transfer:
        """Return the responses for some of the dampers."""
        return Transfer(self.model, self.frequency, self.shapes[dampers], self.force, self.base[dampers], self.observed)


@dataclass(frozen=True, eq=False)
class MapResponse:
    """Response with a number of dampers at some points: arrays over (L, F) and (L, F, S), of modes over (m, K)."""

    amplitude: ComplexArray  # Displacement of the observed point [m], (L, F, S)
    cavity_amplitude: FloatArray  # Largest amplitude of a damper in the unit of the map, (L, F, S)
    mass_ratio: float
    first_harmonic_share: (
        FloatArray  # Share of the mean square velocity of the dampers in the first harmonic, (L, F, S)
    )
    is_unstable: NDArray[np.bool_]  # Whether the motion lies between two folds, (L, F, S)
    flags: NDArray[np.int16]  # Bits of `FLAGS`, (L, F)
    interpolation_error: FloatArray  # Relative change of the largest amplitude with half of the map, (L, F)
    # Half of the 95 % interval of the largest amplitude that follows from those of the map [m], (L, F)
    amplitude_interval: FloatArray
    peak: FloatArray  # Largest amplitude [m], its frequency [Hz], and its relative change with half of the map, (L,)
    peak_frequency: FloatArray
    peak_interpolation_error: FloatArray
    peak_interval: FloatArray  # Half of the 95 % interval of the peak that follows from those of the map [m], (L,)
    peak_softening_error: FloatArray  # Relative change of the peak without the estimated effect of softening, (L,)
    # Natural frequency [Hz] and damping ratio of the modes, and half of the 95 % interval of the latter, (m, K)
    mode_frequency: FloatArray
    damping_ratio: FloatArray
    damping_ratio_interval: FloatArray

    @classmethod
    def of(cls, transfer: Transfer, table: LossTable, number: int, levels: FloatArray) -> MapResponse:
        """Compute the response.

        `levels`: levels, (L,).
        """
        masses, model = table.masses, transfer.model
        system = transfer.frequency, number * transfer.gain, transfer.drive, levels
        # All steady motions in the first harmonic, and those with balls at rest, which no map contains.
        from_map = solve(masses, *system)
        solutions, amplitude, rests = _motions(transfer, table, masses, number, levels, from_map)
        squared = 1.0 if masses.is_acceleration else (2 * np.pi * transfer.frequency[:, None, None]) ** 2
        each = np.abs(solutions.acceleration) / squared
        largest = np.abs(amplitude[..., 0])
        peak, where = _peaks(transfer, solutions, np.abs(amplitude), levels)
        damping = np.diag(2 * model.decay) + (0.0 if model.coupling is None else model.coupling)
        modes = model.stiffness, damping, transfer.shapes, number
        frequency, ratio = damping_of_modes(masses, *modes)
        share = np.where(rests, 1.0, first_harmonic_share(transfer, table, number, each, ratio))
        heavy = number * table.mass * float((transfer.shapes**2).sum(axis=1).max())

        def changed(other: MassTable) -> tuple[FloatArray, FloatArray]:
            """Return the largest amplitude, (L, F), and the peak with another table."""
            near = solve_near(other, *system, from_map)
            others, found, _ = _motions(transfer, table, other, number, levels, near)
            return np.abs(found[..., 0]), _peaks(transfer, others, np.abs(found), levels)[0]

        error, peak_error = _interpolation_errors(map(changed, table.thinned), largest, peak)
        at_peak = (transfer.frequency == where[:, None]).argmax(axis=1)  # 0 where the peak is NaN
        has_interval = _all_covered(table, transfer.frequency, np.moveaxis(each, 1, 0))
        amplitude_interval, peak_interval = _intervals(
            [changed(other) for other in table.shifted], largest, peak, has_interval, at_peak
        )
        ratios = [damping_of_modes(other, *modes)[1] for other in table.shifted]
        softening_error = np.full(peak.shape, np.nan)
        if table.unsoftened is not None:
            softening_error = np.abs(changed(table.unsoftened)[1] / peak - 1)
        masks = {
            "several_solutions": np.isfinite(amplitude).sum(axis=-1) > 1,
            "below_map": solutions.is_below,
            "above_map": solutions.is_above,
            "outside_frequencies": np.broadcast_to(~masses.covers(transfer.frequency), solutions.is_below.shape),
            "not_found": solutions.is_lost,
            "higher_harmonics": (share < LEAST_SHARE).any(axis=-1),
            "heavy_damper": (np.isfinite(amplitude) & ~rests).any(axis=-1) & (heavy > HEAVY),
            "map_warning": _next_to_doubtful(table, transfer.frequency, np.moveaxis(each, 1, 0)),
        }
        return cls(
            amplitude,
            each.max(axis=-1),
            heavy,
            share,
            solutions.is_unstable,
            np.asarray(sum(masks[name].astype(np.int16) << bit for bit, name in enumerate(FLAGS)), np.int16),
            error,
            amplitude_interval,
            peak,
            where,
            peak_error,
            peak_interval,
            softening_error,
            frequency,
            ratio,
            _ratio_interval(table, frequency, ratio, ratios),
        )


def _interpolation_errors(
    changes: Iterable[tuple[FloatArray, FloatArray]], largest: FloatArray, peak: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the largest relative changes of amplitudes and peaks with half of the amplitudes or frequencies of a map."""
    errors, peak_errors = [np.zeros(largest.shape)], [np.zeros(peak.shape)]
    for size, highest in changes:
        with np.errstate(invalid="ignore"):
            errors.append(np.abs(size / largest - 1))
        peak_errors.append(np.abs(highest / peak - 1))
    return (
        np.where(np.isfinite(largest), np.max(errors, axis=0), np.nan),
        np.where(np.isfinite(peak), np.max(peak_errors, axis=0), np.nan),
    )


def _intervals(
    changes: list[tuple[FloatArray, FloatArray]],
    largest: FloatArray,
    peak: FloatArray,
    has_interval: NDArray[np.bool_],
    at_peak: NDArray[np.intp],
) -> tuple[FloatArray, FloatArray]:
    """Return half of the intervals of amplitudes and peaks, from maps that are shifted by half of theirs."""
    if not changes:
        return np.full(largest.shape, np.nan), np.full(peak.shape, np.nan)
    half = np.hypot(*(size - largest for size, _ in changes))
    half_of_peak = np.hypot(*(highest - peak for _, highest in changes))
    covered = has_interval[np.arange(peak.size), at_peak]
    return np.where(has_interval, half, np.nan), np.where(covered, half_of_peak, np.nan)


def _ratio_interval(
    table: LossTable, frequency: FloatArray, ratio: FloatArray, shifted: list[FloatArray]
) -> FloatArray:
    """Return half of the intervals of damping ratios from those with shifted maps; NaN where the map has none."""
    if not shifted:
        return np.full(ratio.shape, np.nan)
    own = np.nan_to_num(frequency, nan=table.masses.frequency[0]).ravel()
    has = table.has_interval(own, np.broadcast_to(table.masses.amplitude, ratio.shape).ravel())
    return np.where(has.reshape(ratio.shape), np.hypot(*(other - ratio for other in shifted)), np.nan)


def _all_covered(table: LossTable, frequency: FloatArray, amplitude: FloatArray) -> NDArray[np.bool_]:
    """Return whether a map has intervals at all motions of the dampers, (L, F), of amplitudes (F, L, S, P)."""
    return np.asarray((table.has_interval(frequency, amplitude) | np.isnan(amplitude)).all(axis=(-2, -1))).T


def _next_to_doubtful(table: LossTable, frequency: FloatArray, amplitude: FloatArray) -> NDArray[np.bool_]:
    """Return whether a run of the map next to a motion is doubtful, (L, F), for amplitudes (F, L, S, P)."""
    doubtful = table.interpolate(table.is_doubtful.astype(float), frequency, amplitude)
    return np.asarray(((doubtful > 0) & np.isfinite(amplitude)).any(axis=(-2, -1))).T


def _motions(
    transfer: Transfer,
    table: LossTable,
    masses: MassTable,
    number: int,
    levels: FloatArray,
    solutions: Solutions,
) -> tuple[Solutions, ComplexArray, NDArray[np.bool_]]:
    """Return the motions with balls at rest added, the observed displacement, and whether balls are at rest, (L, F, S)."""
    at_rest = levels[:, None, None] * transfer.drive
    omega = 2 * np.pi * transfer.frequency
    reach = 2 * np.abs(at_rest).max(axis=-1) / omega**2
    can_rest = (reach < table.clearance) & masses.covers(transfer.frequency)
    solutions, rests = _with_rest(solutions, np.where(can_rest[..., None], at_rest, np.nan))
    moved = np.moveaxis(solutions.acceleration, 1, 0)  # (F, L, S, P)
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.log(np.abs(moved)) - masses.log_acceleration(omega.reshape(-1, 1, 1, 1))
        curves = masses.curves(transfer.frequency)
        mass, _ = curves.evaluate(np.arange(omega.size), np.nan_to_num(logs, nan=masses.limits[0]))
    mass = np.where(np.moveaxis(rests, 1, 0)[..., None], 0.0, mass)
    force = -number * mass * moved
    bare = transfer.bare[:, None] * levels
    displacement = bare[:, :, None] + np.einsum("flsp,fp->fls", force, transfer.to_point)
    return solutions, np.moveaxis(displacement, 0, 1), rests


def _with_rest(solutions: Solutions, at_rest: ComplexArray) -> tuple[Solutions, NDArray[np.bool_]]:
    """Return solutions with the motions of cavities whose balls are at rest, and which these are, (L, F, S).

    `at_rest`: acceleration of the cavities with balls at rest [m/s^2]; NaN where balls cannot be at rest, (L, F, P).
    """
    with np.errstate(invalid="ignore"):
        apart = np.abs(solutions.acceleration / at_rest[:, :, None, :] - 1).max(axis=-1)
    known = (apart < _SAME).any(axis=-1)
    added = np.where(known[..., None], np.nan, at_rest)
    if not np.isfinite(added).any():
        return solutions, np.zeros(solutions.is_unstable.shape, bool)
    motions = np.concatenate([solutions.acceleration, added[:, :, None, :]], axis=2)
    unstable = np.concatenate([solutions.is_unstable, np.zeros((*known.shape, 1), bool)], axis=2)
    rests = np.zeros(unstable.shape, bool)
    rests[..., -1] = np.isfinite(added).all(axis=-1)
    size = np.nan_to_num(np.abs(motions).max(axis=-1), nan=-1.0)
    order = np.argsort(-size, axis=-1, kind="stable")
    return (
        replace(
            solutions,
            acceleration=np.take_along_axis(motions, order[..., None], axis=2),
            is_unstable=np.take_along_axis(unstable, order, axis=2),
        ),
        np.take_along_axis(rests, order, axis=2),
    )


def _peaks(
    transfer: Transfer, solutions: Solutions, amplitude: FloatArray, levels: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the largest amplitude at each level and its frequency; NaN if it may be where the map does not cover it."""
    most = np.where(np.isfinite(amplitude), amplitude, -np.inf).max(axis=-1)
    peak, where = most.max(axis=1), transfer.frequency[most.argmax(axis=1)]
    # Below the map the damper has no known effect: the bare amplitude stands for the largest possible response there.
    bare = np.abs(transfer.bare) * levels[:, None]
    unknown = solutions.is_above | solutions.is_lost | (solutions.is_below & (bare > peak[:, None]))
    known = np.isfinite(peak) & ~unknown.any(axis=1)
    return np.where(known, peak, np.nan), np.where(known, where, np.nan)


def first_harmonic_share(
    transfer: Transfer, table: LossTable, number: int, amplitude: FloatArray, ratio: FloatArray
) -> FloatArray:
    """Return the share of the mean square velocity of the dampers in the first harmonic, (L, F, S); NaN if it is unknown.

    Higher harmonics of the force act on the structure alone, those of several dampers in phase. The variation of the first
    harmonic acts like white noise with the density sigma^2 / (2 f) around the frequency, which causes the mean square
    velocity s^2 S / (8 zeta omega) of a mode with the shape s at the damper. Modes within a factor of 1.5 of the frequency
    count.
    """
    if table.harmonics is None or table.variation is None:
        return np.full(amplitude.shape[:-1], np.nan)
    each = np.moveaxis(amplitude, 1, 0)  # (F, L, S, P)
    omega = 2 * np.pi * transfer.frequency.reshape(-1, 1, 1)
    acceleration = each * (1.0 if table.masses.is_acceleration else omega[..., None] ** 2)
    first = ((acceleration / omega[..., None]) ** 2).sum(axis=-1) / 2
    forces = table.interpolate(table.harmonics, transfer.frequency, each) * acceleration[..., None] * number
    rest = np.zeros(first.shape)
    for k in range(forces.shape[-1]):
        velocity = np.einsum("fij,flsj->flsi", transfer.harmonic_gain(k + 2), forces[..., k])
        rest += (velocity**2).sum(axis=-1) / 2
    sigma = table.interpolate(table.variation, transfer.frequency, each) * acceleration
    own = np.sqrt(transfer.model.stiffness)
    bare = transfer.model.decay / np.where(own > 0, own, 1.0)
    logs, logs_of_map = np.log(each.max(axis=-1)), np.log(table.masses.amplitude)
    for mode in np.flatnonzero(own > 0):
        known = np.isfinite(ratio[mode])
        zeta = np.interp(logs, logs_of_map[known], ratio[mode, known]) if known.any() else bare[mode]
        near = (omega < 1.5 * own[mode]) & (omega > own[mode] / 1.5)
        shape = transfer.shapes[:, mode] ** 2
        noise = shape.sum() * number * (shape * sigma**2).sum(axis=-1) * np.pi / omega
        with np.errstate(divide="ignore", invalid="ignore"):
            rest += np.where(near, noise / (8 * np.maximum(zeta, 0) * own[mode]), 0.0)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.moveaxis(first / (first + rest), 0, 1))
