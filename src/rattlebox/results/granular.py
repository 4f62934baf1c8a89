"""A finished run with particles in space: data, ledger, summary, figures and files."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from .arrays import (
    FloatArray,
    IntArray,
    _absent,
    _Comparable,
    checked_arrays,
    checked_counts,
    checked_labels,
    checked_time,
)
from .ledger import Ledger
from .provenance import Provenance
from .run import Run, RunPlots
from .schema import GRANULAR, GRANULAR_CHANNELS, PARTNERS, Form

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure


@dataclass(frozen=True, kw_only=True, eq=False)
class GranularArrays(_Comparable):
    """Everything the engine of particles computed in one run, in SI units and the frame of the base.

    Sizes: T times, P points, D dampers, L loads, m modes, N particles of all dampers, three axes x, y, z, two partners
    (another particle, the wall). Fields left out are zero. Arrays become read-only; equality compares every value
    but the computing time and the memory taken, NaN equals NaN.

    Attributes
    ----------
    time : (T,) float
        Output times [s].
    points, dampers, loads : tuple of str
        Names; a point that moves in space is three, "tip x", "tip y" and "tip z".
    displacement, velocity : (T, P) float
        Motion of the structure's points [m], [m/s].
    cavity_displacement, cavity_velocity : (T, D, 3) float
        Motion of the cavities [m], [m/s].
    cavity_force, cavity_moment : (T, D, 3) float
        Force of the particles on the cavity [N], and moment about its centre [N m], at the output times.
    centre_of_mass : (T, D, 3) float
        Of the particles, from the centre of the moving cavity [m].
    momentum : (T, D, 3) float
        Of the particles [kg m/s].
    contacts : (T, D, 2) int
        Number of contacts, by partner.
    base_displacement, base_velocity, base_acceleration : (T, 3) float
        Motion of the base [m], [m/s], [m/s^2].
    load : (T, L) float
        Load forces [N].
    particle_mass : (D,) float
        Mass of all particles of a damper [kg].
    mode_frequency : (m,) float
        Natural frequencies [Hz].
    mode_energy : (T, m) float
        Kinetic and elastic energy of each mode [J].
    kinetic_energy, rotation_energy, contact_energy, gravity_energy : (T, D) float
        Translation, spin, elastic energy of contacts, and gravity potential of the particles [J].
    load_work, base_work : (T,) float
        Work done since the start by the loads and by the inertial forces of the base motion [J].
    viscous_loss : (T,) float
        Energy lost since the start in the structure's damping [J].
    normal_loss, plastic_loss, sliding_loss, rolling_loss : (T, D, 2) float
        Energy lost since the start in contacts, by partner [J].
    position, particle_velocity, spin : (N, 3) float
        At the end: from the cavity's centre [m], relative to the base [m/s], [rad/s].
    radius, mass : (N,) float
        [m], [kg].
    particle_damper, particle_species : (N,) int
        Damper and species of each particle, counted from 0.
    status, message : str
        "finished", or the reason why the run ended early; one sentence that explains it and says what to try.
    counts : mapping of str to int
        Numbers of steps, rebuilt lists and so on.
    figures : mapping of str to float
        Step [s], what limits it, largest overlap and so on, by name.
    notes : tuple of str
        What limits the step, what softening does, and warnings.
    wall_time : float
        Computing time [s].

    Raises
    ------
    ValueError
        When a shape does not fit, times do not increase, or a label is not what it should be.
    TypeError
        When an array holds the wrong kind of numbers.
    """

    form: ClassVar[Form] = GRANULAR
    channels: ClassVar[tuple[str, ...]] = GRANULAR_CHANNELS
    partners: ClassVar[tuple[str, ...]] = PARTNERS
    axes: ClassVar[tuple[str, ...]] = ("x", "y", "z")
    balls: ClassVar[tuple[str, ...]] = ()  # particles have no names

    time: FloatArray
    points: tuple[str, ...] = ()
    dampers: tuple[str, ...] = ()
    loads: tuple[str, ...] = ()
    displacement: FloatArray = field(default_factory=_absent)
    velocity: FloatArray = field(default_factory=_absent)
    cavity_displacement: FloatArray = field(default_factory=_absent)
    cavity_velocity: FloatArray = field(default_factory=_absent)
    cavity_force: FloatArray = field(default_factory=_absent)
    cavity_moment: FloatArray = field(default_factory=_absent)
    centre_of_mass: FloatArray = field(default_factory=_absent)
    momentum: FloatArray = field(default_factory=_absent)
    contacts: IntArray = field(default_factory=_absent)
    base_displacement: FloatArray = field(default_factory=_absent)
    base_velocity: FloatArray = field(default_factory=_absent)
    base_acceleration: FloatArray = field(default_factory=_absent)
    load: FloatArray = field(default_factory=_absent)
    particle_mass: FloatArray = field(default_factory=_absent)
    mode_frequency: FloatArray = field(default_factory=_absent)
    mode_energy: FloatArray = field(default_factory=_absent)
    kinetic_energy: FloatArray = field(default_factory=_absent)
    rotation_energy: FloatArray = field(default_factory=_absent)
    contact_energy: FloatArray = field(default_factory=_absent)
    gravity_energy: FloatArray = field(default_factory=_absent)
    load_work: FloatArray = field(default_factory=_absent)
    base_work: FloatArray = field(default_factory=_absent)
    viscous_loss: FloatArray = field(default_factory=_absent)
    normal_loss: FloatArray = field(default_factory=_absent)
    plastic_loss: FloatArray = field(default_factory=_absent)
    sliding_loss: FloatArray = field(default_factory=_absent)
    rolling_loss: FloatArray = field(default_factory=_absent)
    position: FloatArray = field(default_factory=_absent)
    particle_velocity: FloatArray = field(default_factory=_absent)
    spin: FloatArray = field(default_factory=_absent)
    radius: FloatArray = field(default_factory=_absent)
    mass: FloatArray = field(default_factory=_absent)
    particle_damper: IntArray = field(default_factory=_absent)
    particle_species: IntArray = field(default_factory=_absent)
    status: str = "finished"
    message: str = ""
    counts: Mapping[str, int] = field(default_factory=dict)
    figures: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    wall_time: float = 0.0

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "time", checked_time(self.time))
        for name in ("points", "dampers", "loads"):
            put(self, name, checked_labels(name, getattr(self, name)))
        sizes = {
            "time": self.time.size,
            "point": len(self.points),
            "damper": len(self.dampers),
            "source": len(self.loads),
            "mode": np.size(self.mode_frequency),
            "axis": 3,
            "partner": 2,
            "particle": np.size(self.radius),
        }
        for name, array in checked_arrays(self, GRANULAR.stored, sizes).items():
            put(self, name, array)
        put(self, "counts", checked_counts(self.counts))
        put(self, "figures", MappingProxyType({name: float(value) for name, value in self.figures.items()}))
        put(self, "notes", tuple(self.notes))
        put(self, "wall_time", float(self.wall_time))

    @property
    def modes(self) -> IntArray:
        """Numbers of the modes, from 1."""
        return np.arange(1, self.mode_frequency.size + 1)

    @property
    def numbers(self) -> IntArray:
        """Numbers of the particles, from 0, over all dampers."""
        return np.arange(self.radius.size)

    def __reduce__(self) -> tuple[Any, ...]:
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        return (_rebuild, ({**values, "counts": dict(self.counts), "figures": dict(self.figures)},))


def _rebuild(values: dict[str, Any]) -> GranularArrays:
    return GranularArrays(**values)


@dataclass(frozen=True, eq=False, repr=False)
class GranularLedger(Ledger):
    """Sums over the energies of a run with particles; every array is (T,) in J.

    The balance is  E(t) - E(0) = W(t) - losses(t)  with the total energy E (structure, particles, elastic
    contacts, gravity), the work W of load and base, and the losses (viscous, normal, plastic, sliding, rolling).
    """

    arrays: GranularArrays  # type: ignore[assignment]

    @cached_property
    def particles(self) -> FloatArray:
        """Kinetic energy of all particles."""
        return np.asarray((self.arrays.kinetic_energy + self.arrays.rotation_energy).sum(axis=1))

    @cached_property
    def impact_loss(self) -> FloatArray:
        """Loss in all contacts."""
        return np.asarray(sum(part for channel, part in self.channels.items() if channel not in ("viscous", "motion")))

    @cached_property
    def plastic_loss(self) -> FloatArray:
        """Loss by plastic flow in all contacts."""
        return self.channels["plastic"]

    @cached_property
    def channels(self) -> dict[str, FloatArray]:
        """Where the energy supplied is: what was lost since the start, by channel, and what is left in the motion."""
        arrays = self.arrays
        parts = (arrays.normal_loss, arrays.plastic_loss, arrays.sliding_loss, arrays.rolling_loss)
        contacts = (np.asarray(part.sum(axis=(1, 2))) for part in parts)
        return dict(zip(GRANULAR_CHANNELS, (arrays.viscous_loss, *contacts, self.motion), strict=True))

    @property
    def partner_share(self) -> FloatArray:
        """Shares of the energy supplied that are lost among particles, and at walls."""
        supplied = float(self.supplied[-1])
        lost = self._lost_at_the_end.sum(axis=0)
        return np.asarray(lost / supplied if supplied > 0 else np.full(2, np.nan))

    @property
    def _lost_in_dampers(self) -> FloatArray:
        return np.asarray(self._lost_at_the_end.sum(axis=1))

    @property
    def _lost_at_the_end(self) -> FloatArray:
        arrays = self.arrays
        parts = (arrays.normal_loss, arrays.plastic_loss, arrays.sliding_loss, arrays.rolling_loss)
        return np.asarray(sum(part[-1] for part in parts))

    @property
    def coordination(self) -> FloatArray:
        """Contacts of a particle in the mean, (T, D)."""
        arrays = self.arrays
        count = np.bincount(arrays.particle_damper, minlength=len(arrays.dampers))
        return np.asarray(arrays.contacts @ np.array([2, 1]) / np.maximum(count, 1))


class GranularRun(Run):
    """What a simulation of particle dampers returns.

    Parameters
    ----------
    arrays
        What the engine computed.
    case_toml
        The case, as the text of a case file, or what returns it.
    provenance
        Where the run comes from; made on the spot when left out.
    """

    def __init__(
        self, arrays: GranularArrays, case_toml: str | Callable[[], str] = "", provenance: Provenance | None = None
    ) -> None:
        super().__init__(arrays, case_toml, provenance)  # type: ignore[arg-type]

    @property
    def arrays(self) -> GranularArrays:  # type: ignore[override]
        """The plain arrays, SI units, read-only."""
        return self._arrays  # type: ignore[return-value]

    @cached_property
    def ledger(self) -> GranularLedger:
        """Sums over all energies, in J, each (T,)."""
        return GranularLedger(self.arrays)

    @cached_property
    def particles(self) -> xarray.Dataset:
        """The particles at the end of the run, in their moving cavities; SI units."""
        return self._dataset("particles")

    @property
    def impacts(self) -> xarray.Dataset:
        """Not kept: contacts among many particles are counted, not listed.

        Raises
        ------
        AttributeError
            Always.
        """
        raise AttributeError("a run with particles in space keeps no list of impacts; see motion.contacts and counts")

    @property
    def plot(self) -> GranularPlots:  # type: ignore[override]
        """Figures of this run: `motion`, `energy`, `particles`."""
        return GranularPlots(self)

    def __repr__(self) -> str:
        arrays = self.arrays
        return (
            f"<Run {arrays.status}: {arrays.time[0]:g} to {arrays.time[-1]:g} s, "
            f"{len(arrays.points)} points, {arrays.radius.size} particles in {len(arrays.dampers)} dampers>"
        )


class GranularPlots(RunPlots):
    """Figures of one run with particles in space."""

    _run: GranularRun

    def motion(self, **options: Any) -> Figure:
        """Displacement of the structure, shift of the centre of mass in each cavity, and contacts, against time.

        Parameters
        ----------
        **options
            Passed on to `rattlebox.plots.plot_granular_motion`.
        """
        from ..plots import plot_granular_motion

        return plot_granular_motion(self._run, **options)

    def particles(self, **options: Any) -> Figure:
        """The particles in their cavities at the end of the run.

        Parameters
        ----------
        **options
            Passed on to `rattlebox.plots.plot_particles`.
        """
        from ..plots import plot_particles

        return plot_particles(self._run, **options)
