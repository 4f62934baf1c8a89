"""What a shaken cavity with particles takes up and how heavy it seems, from forces and from energies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import trapezoid

from .signals import FloatArray, positive

if TYPE_CHECKING:
    import xarray

    from rattlebox.results import GranularRun

WAYS = ("complex power", "energy")


LEAST_SAMPLES = 8
"""In a cycle, below which higher harmonics pass for the first."""

_LEAST_SHARE = 0.02  # of the mean square speed


class StillCavity(ValueError):
    """A cavity has hardly any motion at the frequency that is looked at."""


def shaken_cavity(
    run: GranularRun, *, frequency: float, damper: str | None = None, after: float = 0.0
) -> xarray.Dataset:
    """Loss and effective mass of the particles in a cavity that moves harmonically, in two ways.

    Both look at the last whole number of cycles. "Complex power" takes the force that drives the particles, whose mean
    between two samples is known exactly from their momentum, and the velocity of the cavity: P = F* v / 2. "Energy" takes
    what was lost in contacts, and the momentum of the particles in phase with the cavity.

    Parameters
    ----------
    run
        Run of a shaker, or of a structure that swings harmonically, with some twenty samples or more in a cycle.
    frequency
        Of the motion [Hz].
    damper
        Name; not needed where there is one only.
    after
        Leave out what is before this time [s].

    Returns
    -------
    xarray.Dataset
        Over `way`: `active_power` [W], `loss_per_cycle` in a cycle [J], `effective_mass` [kg], `loss_factor` (active
        over magnitude of reactive power, which is the energy of a cycle over 2 pi times the largest kinetic energy of the
        effective mass) and `reduced_loss`, energy of a cycle over m v^2 with all mass and the amplitude of the
        velocity. Besides, `stored_power` [W]: what the energy of the particles rose by; complex power counts it as taken up,
        the energy lost does not. Attributes tell frequency, cycles and amplitude.

    Raises
    ------
    TypeError
        When the run has no particles in space.
    ValueError
        When less than one cycle is covered, there are fewer than eight samples in a cycle, the cavity hardly moves at this
        frequency, or there is no such damper.
    """
    import xarray

    from rattlebox.results import GranularRun

    if not isinstance(run, GranularRun):
        raise TypeError(f"a run with particles in space is needed, not {run!r:.60}")
    arrays = run.arrays
    if damper is None and len(arrays.dampers) == 1:
        damper = arrays.dampers[0]
    if damper not in arrays.dampers:
        raise ValueError(f"damper is one of {', '.join(arrays.dampers)}, not {damper!r}")
    number = arrays.dampers.index(damper)
    frequency = positive("frequency", frequency, "Hz")
    times = arrays.time
    cycles = math.floor((times[-1] - max(after, times[0])) * frequency + 1e-9)
    if cycles < 1:
        raise ValueError(f"no whole cycle of {frequency:g} Hz lies after {after:g} s; the run ends at {times[-1]:g} s")
    begin = times[-1] - cycles / frequency
    kept = np.concatenate([[begin], times[times > begin + 1e-9 / frequency]])
    mass = float(arrays.particle_mass[number])
    if kept.size - 1 < LEAST_SAMPLES * cycles:
        raise ValueError(
            f"the run has {(kept.size - 1) / cycles:.3g} samples in a cycle of {frequency:g} Hz, and needs {LEAST_SAMPLES}"
            f"\n  try: rb.Output(rate={20 * frequency:g})"
        )

    def at(values: FloatArray) -> FloatArray:
        columns = values.reshape(times.size, -1).T
        return np.stack([np.interp(kept, times, column) for column in columns], axis=-1)

    velocity = at(arrays.base_velocity + arrays.cavity_velocity[:, number])
    momentum = at(arrays.momentum[:, number] + mass * arrays.base_velocity)
    omega = 2 * np.pi * frequency
    span, turn = kept[-1] - kept[0], np.exp(-1j * omega * kept)[:, None]
    v = 2 / span * trapezoid(velocity * turn, kept, axis=0)
    size = float(np.linalg.norm(v))
    about = velocity - trapezoid(velocity, kept, axis=0) / span
    whole = float(trapezoid(np.sum(about**2, axis=1), kept)) / span
    if not 0.5 * size**2 > _LEAST_SHARE * whole:
        share = 50 * size**2 / whole if whole else 0.0
        raise StillCavity(f"the cavity hardly moves at {frequency:g} Hz: {share:.2g} % of its mean square speed")
    step = np.diff(kept)
    middle = 0.5 * (kept[1:] + kept[:-1])
    # The weight has no part at the frequency over whole cycles, so the change of momentum is all that is needed.
    spread = np.sinc(frequency * step) * np.exp(-1j * omega * middle)
    force = 2 / span * (spread[:, None] * np.diff(momentum, axis=0)).sum(axis=0)
    power = complex(force.conjugate() @ v) / 2
    carried = 2 / span * trapezoid(momentum * turn, kept, axis=0)
    lost = float(_rise(kept, times, _losses(run, number))) / span
    stored = float(_rise(kept, times, _energy(run, number))) / span
    masses = np.array([-2 * power.imag / (omega * size**2), float((carried @ v.conjugate()).real) / size**2])
    powers = np.array([power.real, lost])
    reactive = 0.5 * omega * np.abs(masses) * size**2

    def over(values: Any, units: str, long_name: str) -> Any:
        return "way", values, {"units": units, "long_name": long_name}

    return xarray.Dataset(
        {
            "active_power": over(powers, "W", "power taken up"),
            "loss_per_cycle": over(powers / frequency, "J", "energy taken up in a cycle"),
            "effective_mass": over(masses, "kg", "effective mass"),
            "loss_factor": over(powers / reactive, "1", "loss factor"),
            "reduced_loss": over(powers / (frequency * mass * size**2), "1", "energy of a cycle over m v^2"),
            "stored_power": ((), stored, {"units": "W", "long_name": "rise of the particles' energy"}),
        },
        {"way": ("way", list(WAYS), {"long_name": "where it comes from"})},
        {"frequency": frequency, "cycles": cycles, "velocity_amplitude": size, "damper": damper},
    )


def _losses(run: GranularRun, damper: int) -> FloatArray:
    """Energy lost in the contacts of a damper, (T,)."""
    arrays = run.arrays
    parts = (arrays.normal_loss, arrays.plastic_loss, arrays.sliding_loss, arrays.rolling_loss)
    return np.asarray(sum(part[:, damper].sum(axis=1) for part in parts))


def _energy(run: GranularRun, damper: int) -> FloatArray:
    """Energy of the particles of a damper seen from outside, (T,); gravity's without that of the base's place."""
    arrays = run.arrays
    mass, base = arrays.particle_mass[damper], arrays.base_velocity
    own = arrays.kinetic_energy + arrays.rotation_energy + arrays.contact_energy + arrays.gravity_energy
    carried = np.einsum("ti,ti->t", arrays.momentum[:, damper] + 0.5 * mass * base, base)
    return np.asarray(own[:, damper] + carried)


def _rise(kept: FloatArray, times: FloatArray, values: FloatArray) -> float:
    first, last = np.interp(kept[[0, -1]], times, values)
    return float(last - first)
