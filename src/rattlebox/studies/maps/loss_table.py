"""A loss map as a table of apparent masses and harmonics of the force, read from a dataset, a file or a store."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import DataError, RattleboxError
from rattlebox.analysis.describing_function import MassTable
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint
from rattlebox.model.particle_case import direction_of_base
from rattlebox.model.space import unit_vector
from rattlebox.studies.run.stored import open_study
from rattlebox.studies.work.map_work import AMPLITUDE, FREQUENCY
from rattlebox.studies.work.measures import INTERVAL

if TYPE_CHECKING:
    import xarray

FloatArray = NDArray[np.float64]

_REQUIRED = {"effective_mass", "damping_mass", AMPLITUDE, FREQUENCY}
_SOURCE = "a file of rb.loss_map(...).to_netcdf"


@dataclass(frozen=True, eq=False)
class LossTable:
    """A loss map over K amplitudes and J frequencies.

    Attributes
    ----------
    mass
        Mass of the particles [kg]; NaN if it is unknown.
    interval : (K, J, 2) float or None
        Half of the 95 % intervals of m' and m'' [kg].
    harmonics : (K, J, N) float or None
        Harmonics 2 to N + 1 of the force over the acceleration of the cavity [kg].
    variation : (K, J) float or None
        Variation of the first harmonic of the force from cycle to cycle over the acceleration of the cavity [kg].
    softening, softening_change : (K, J) float or None
        Softening of each run, and its estimated effect on the loss in a cycle over m V^2; NaN where it is unknown.
    is_doubtful : (K, J) bool
        Whether the run exceeded a validity limit.
    axis : (3,) float or None
        Direction of the motion; None if it has none, as for impact dampers.
    clearance
        Smallest clearance of impact dampers without gravity, whose balls may stay at rest [m]; else 0.
    """

    masses: MassTable
    mass: float
    interval: FloatArray | None
    harmonics: FloatArray | None
    variation: FloatArray | None
    softening: FloatArray | None
    softening_change: FloatArray | None
    is_doubtful: NDArray[np.bool_]
    axis: FloatArray | None
    clearance: float
    case: str
    limits: str

    @classmethod
    def read(cls, source: Any) -> LossTable:
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

        Parameters
        ----------
        values : (K, J, ...) float
            Values over the map.
        frequency : (F,) float
            Frequencies [Hz]; those outside of the map are moved to its edge.
        amplitude : (F, ...) float
            Amplitudes of the cavity; the same holds for them.

        Returns
        -------
        (F, ..., ...) float
            Values at each amplitude.
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
