"""Shake a box of steel balls at several amplitudes and frequencies, and draw how much it takes up and how heavy it seems."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

import rattlebox as rb

CYCLES = 30  # of which the first third is left out


def shaken(acceleration: float, frequency: float) -> rb.Case:
    """Return a box of a hundred balls on a shaker along z, with an amplitude of acceleration [m/s^2] at a frequency [Hz]."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude=(acceleration, "m/s^2"), frequency=frequency, direction="z")),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="5 mm", count=100),
            cavity=rb.Box(size=("30 mm", "30 mm", "25 mm")),
            contact=rb.Tsuji(restitution=0.8),
            friction=0.2,
            packing=rb.Settled(seed=1),
            softening=300,
        ),
        duration=CYCLES / frequency,
        output=rb.Output(rate=200 * frequency),
    )


def loss_map(accelerations: Sequence[float], frequencies: Sequence[float]) -> xr.Dataset:
    """Return loss and effective mass over amplitude and frequency, as `rb.loss_map` does for impact dampers."""
    rows = []
    for acceleration in accelerations:
        row = []
        for frequency in frequencies:
            run = rb.simulate(shaken(acceleration, frequency))
            assert run.ok, run.message
            found = rb.analysis.shaken_cavity(run, frequency=frequency, after=CYCLES / 3 / frequency)
            row.append(found.assign(closure=((), run.closure)))
        rows.append(xr.concat(row, "structure.motion.frequency"))
    found = xr.concat(rows, "structure.motion.amplitude").assign(particle_mass=((), float(run.arrays.particle_mass[0])))
    axes = {"amplitude": (accelerations, "m/s^2"), "frequency": (frequencies, "Hz")}
    return found.assign_coords(
        {
            f"structure.motion.{name}": (f"structure.motion.{name}", list(values), {"units": unit, "long_name": name})
            for name, (values, unit) in axes.items()
        }
    )


if __name__ == "__main__":
    study = loss_map(np.geomspace(15, 200, 8), np.geomspace(20, 160, 7))
    rb.plot_loss_map(study.sel(way="energy")).savefig("shaken_box.png")
