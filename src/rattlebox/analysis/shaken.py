"""Loss and effective mass of particles in a shaken cavity, from forces and from energies."""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.exceptions import CaseError, DataError

from .cycle_loss import CycleLoss, cycle_loss
from .signals import FloatArray, first_harmonic, positive, steps_inside, trapezoid_weights

if TYPE_CHECKING:
    import xarray

    from rattlebox.results import Run

WAYS = ("complex power", "energy")

MIN_SAMPLES = 8
"""Fewest samples in a cycle; with fewer, higher harmonics are aliased to the first."""

_LEAST_SHARE = 0.02  # smallest share of the harmonic in the mean square speed


class StillCavity(DataError):
    """The motion of a cavity has almost no component at a frequency."""


def shaken_cavity(run: Run, *, frequency: float, damper: str | None = None, after: float = 0.0) -> xarray.Dataset:
    """Compute the loss and the effective mass of the particles in a cavity that moves harmonically, in two ways.

    Both evaluate the last whole number of cycles. "complex power" uses the force that drives the particles and the
    velocity of the cavity. "energy" uses the work of the walls from the energy balance of the particles, and the momentum of
    the particles in phase with the cavity. Both are the loss of the structure: the weight of a bed that sinks dissipates
    energy, too, which is not in them.

    Parameters
    ----------
    run
        Run of a shaker, or of a structure that vibrates harmonically, with about twenty samples per cycle or more.
    frequency
        Frequency of the motion [Hz].
    damper
        Name of the damper; needed if there are several.
    after
        Time before which samples are ignored [s].

    Returns
    -------
    xarray.Dataset
        Over `way`: `active_power` [W], `loss_per_cycle` [J], `effective_mass` [kg], `loss_factor` (active power over the
        magnitude of the reactive power, which is the energy of a cycle over 2 pi times the largest kinetic energy of the
        effective mass) and `reduced_loss` (energy of a cycle over m V^2, with the mass m of all particles and the velocity
        amplitude V). Also `dissipated_power` [W], lost in contacts; `stored_power` [W], the mean rate of change of the
        energy of the particles, potential of gravity included; `raised_power` [W], that of the potential alone; and
        `steady`, whether these and the loss have no trend (see Notes). Attributes: frequency, cycles, velocity amplitude,
        damper, and `warnings`, empty for a steady motion.

    Raises
    ------
    AttributeError
        If the run has no particles.
    ValueError
        If less than one cycle is covered, there are fewer than eight samples in a cycle, the cavity does not move at this
        frequency, or there is no such damper.

    Warns
    -----
    UserWarning
        If the motion is not steady.

    Notes
    -----
    The energy balance is work of the walls = dissipated + stored. A motion is steady if the stored energy and the potential
    change by less than 5 % of the work or 2 % of m V^2 in a cycle, and the work by less than 20 % from the first to the
    second half of the cycles. Larger changes count if they are a trend (Mann-Kendall, 1 %) or ten times as large.

    With the complex amplitudes F of the force and V of the velocity, P = F* V / 2; the real part is the absorbed power, and
    the effective mass is -Im P / (pi f abs(V)^2). The samples give the mean force of each sampling step h, the change of the
    momentum over h. The mean over a step has the amplitude sinc(f h) = sin(pi f h) / (pi f h) of a harmonic, by which the
    amplitude F is divided. Both amplitudes are exact for harmonic motions at any number of samples. With N samples per
    cycle, the harmonics 1 + k N of a force of short impulses are aliased to F with the factor 1 / (1 + k N): increase N
    until P converges.

    References
    ----------
    N. Meyer, R. Seifried (2021), Toward a design methodology for particle dampers by analyzing their energy dissipation,
    Computational Particle Mechanics 8, 681-699, doi:10.1007/s40571-020-00363-0.
    """
    result = harmonic_loss(run, frequency=frequency, damper=damper, after=after)
    for text in result.attrs["warnings"]:
        warnings.warn(text.removeprefix("warning: "), stacklevel=2)
    return result


def harmonic_loss(run: Run, *, frequency: float, damper: str | None = None, after: float = 0.0) -> xarray.Dataset:
    """Return the result of `shaken_cavity`, without a Python warning."""
    arrays, particle_mass = run.arrays, run.arrays.particle_mass
    if damper is None and len(arrays.dampers) == 1:
        damper = arrays.dampers[0]
    if damper not in arrays.dampers:
        raise ValueError(f"damper is one of {', '.join(arrays.dampers)}, not {damper!r}")
    number = arrays.dampers.index(damper)
    frequency = positive("frequency", frequency, "Hz")
    times, mass = arrays.time, float(particle_mass[number])
    rotation = run.case.particle_dampers[number].rotation if run.case.particle_dampers else None
    if rotation is not None and rotation.vibration == "cavity":
        raise ValueError(
            f"{damper} vibrates along its turning axes; the loss of a cycle needs a rotation with vibration='machine'"
        )
    cycles = _whole_cycles(times, frequency, after)
    start = times[-1] - cycles / frequency
    # The ledger is relative to the base; the harmonic balance holds in the inertial frame.
    velocity = arrays.base_velocity + arrays.cavity_velocity[:, number]
    momentum = arrays.momentum[:, number] + mass * arrays.base_velocity
    weights = trapezoid_weights(times, start)
    v = _velocity_amplitude(times, velocity, weights, frequency, float(times[-1] - start))
    size = float(np.linalg.norm(v))
    # Forces in contacts last for less than a sampling step. The change of momentum has their whole impulse.
    step = np.diff(times)
    middle = 0.5 * (times[1:] + times[:-1])
    # The weight is constant, so the change of momentum gives the first harmonic of the force.
    mean_force = np.diff(momentum, axis=0) / step[:, None]
    inside = steps_inside(times, start)
    force = first_harmonic(middle, mean_force, inside, frequency, gain=np.sinc(frequency * step))
    power = complex(force.conjugate() @ v) / 2
    # The second way needs no forces: energy from the ledger, mass from the momentum in phase with the velocity.
    carried = first_harmonic(times, momentum, weights, frequency)
    balance = cycle_loss(run, frequency, cycles, [number])
    omega = 2 * np.pi * frequency
    masses = np.array([-2 * power.imag / (omega * size**2), float((carried @ v.conjugate()).real) / size**2])
    powers = np.array([power.real, balance.work * frequency])
    result = _losses(powers, masses, balance, frequency, particle_mass=mass, size=size)
    return result.assign_attrs(
        frequency=frequency,
        cycles=cycles,
        velocity_amplitude=size,
        damper=damper,
        warnings=[text] if (text := balance.warning()) else [],
    )


def _whole_cycles(times: FloatArray, frequency: float, after: float) -> int:
    """Return the number of whole cycles after a time that end with a run."""
    # The end is the most settled part, and means over parts of a cycle are biased.
    cycles = math.floor((float(times[-1]) - max(after, float(times[0]))) * frequency + 1e-9)
    if cycles < 1:
        raise ValueError(f"no whole cycle of {frequency:g} Hz lies after {after:g} s; the run ends at {times[-1]:g} s")
    # With fewer samples the harmonics of short impulses are aliased into the amplitude of the force.
    samples = np.count_nonzero(times > times[-1] - cycles / frequency + 1e-9 / frequency)
    if samples < MIN_SAMPLES * cycles:
        raise CaseError(
            f"the run has {samples / cycles:.3g} samples in a cycle of {frequency:g} Hz, and needs {MIN_SAMPLES}",
            f"rb.Output(rate={20 * frequency:g})",
        )
    return cycles


def _velocity_amplitude(
    times: FloatArray, velocity: FloatArray, weights: FloatArray, frequency: float, span: float
) -> NDArray[np.complex128]:
    """Return the complex amplitude of the velocity of a cavity, which must move mostly at this frequency."""
    v: NDArray[np.complex128] = first_harmonic(times, velocity, weights, frequency)
    size = float(np.linalg.norm(v))
    # A cavity that moves mostly at other frequencies has a small first harmonic, whose ratios would be noise. A drift
    # is not motion in this sense.
    about = velocity - weights @ velocity / span
    whole = float(weights @ np.sum(about**2, axis=1)) / span
    if not 0.5 * size**2 > _LEAST_SHARE * whole:
        share = 50 * size**2 / whole if whole else 0.0
        raise StillCavity(
            f"the motion of the cavity at {frequency:g} Hz is {share:.2g} % of its mean square speed, but at least "
            f"{100 * _LEAST_SHARE:g} % are needed",
            "the frequency of the motion",
        )
    return v


def _losses(
    powers: FloatArray, masses: FloatArray, balance: CycleLoss, frequency: float, *, particle_mass: float, size: float
) -> xarray.Dataset:
    """Return the losses and masses of both ways, and the balance of the particles, as a dataset."""
    import xarray

    reactive = np.pi * frequency * np.abs(masses) * size**2

    def over(values: Any, units: str, long_name: str) -> Any:
        return "way", values, {"units": units, "long_name": long_name}

    def scalar(value: Any, long_name: str, **units: str) -> Any:
        return (), value, {**units, "long_name": long_name}

    return xarray.Dataset(
        {
            "active_power": over(powers, "W", "absorbed power"),
            "loss_per_cycle": over(powers / frequency, "J", "energy absorbed in a cycle"),
            "effective_mass": over(masses, "kg", "effective mass"),
            "loss_factor": over(powers / reactive, "1", "loss factor"),
            "reduced_loss": over(powers / (frequency * particle_mass * size**2), "1", "energy of a cycle over m v^2"),
            "dissipated_power": scalar(balance.dissipated * frequency, "loss in contacts", units="W"),
            "stored_power": scalar(balance.stored * frequency, "rise of the particles' energy", units="W"),
            "raised_power": scalar(balance.raised * frequency, "rise of the gravity potential", units="W"),
            "steady": scalar(balance.is_steady, "whether the motion is steady"),
        },
        {"way": ("way", list(WAYS), {"long_name": "method"})},
    )


def force_harmonics(
    times: FloatArray, momentum: FloatArray, frequency: float, count: int
) -> tuple[FloatArray, FloatArray]:
    """Compute the harmonics of the force on the particles, and the variation of the first one from cycle to cycle.

    `times`: evenly spaced times that span whole cycles [s], (T,). `momentum`: momentum of the particles along the motion of
    the cavity [kg m/s], (..., T). `frequency`: frequency of the motion [Hz]. Returns amplitudes of the harmonics 2 to
    `count` [N]; NaN with fewer than three samples in a cycle of the harmonic, (..., count - 1); and root mean square of the
    difference between the complex amplitude of the first harmonic in one cycle and its mean [N], (...).

    Notes
    -----
    F_n = 2 f / sinc(n f h) times the mean over the cycles of the sum of dp exp(-2 pi i n f t) over a cycle, with the change
    dp of the momentum in each sampling step h around t; see `shaken_cavity` for sinc.
    """
    step = float(times[-1] - times[0]) / (times.size - 1)
    turns = frequency * (0.5 * (times[1:] + times[:-1]) - times[0])
    cycles = max(1, round(frequency * float(times[-1] - times[0])))
    change = 2 * frequency * np.diff(momentum, axis=-1)
    harmonics = np.full((*momentum.shape[:-1], count - 1), np.nan)
    for n in range(2, min(count, int(1 / (3 * frequency * step) + 1e-6)) + 1):
        part = change @ np.exp(-2j * np.pi * n * turns)
        harmonics[..., n - 2] = np.abs(part) / (cycles * np.sinc(n * frequency * step))
    cycle = np.minimum(turns.astype(int), cycles - 1)
    first = change * np.exp(-2j * np.pi * turns) / np.sinc(frequency * step)
    each = np.add.reduceat(first, np.flatnonzero(np.diff(cycle, prepend=-1)), axis=-1)
    variation = np.sqrt(np.mean(np.abs(each - each.mean(axis=-1, keepdims=True)) ** 2, axis=-1))
    return harmonics, np.asarray(variation)
