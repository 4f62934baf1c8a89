"""Particles or a tuned mass
=========================

For designers who compare: a bed of particles against a tuned mass of the same mass, over the level of the load.

Both have 5 % of the mass of a structure with a damping ratio of 0.5 %, which then changes its frequency by up to 20 %. The
responses with particles follow from one loss map, without gravity.

:doc:`/guide/when_not` explains it.
"""

# sphinx_gallery_tags = ["building", "space", "comparison", "map", "response"]

import math

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import rattlebox as rb

FREE, BALL, LAYERS, HERTZ, SHARE = 0.010, 0.005, 3, 10.0, 0.05  # m, m, 1, Hz, 1
BEST = FREE / math.pi  # amplitude at which the bed loses most [m]
FREQUENCY = "structure.motion.frequency"


def loss_map(ratios=(0.15, 0.22, 0.31, 0.45, 0.65, 0.93, 1.34, 1.93, 2.78, 4.0), cycles=(8, 10)):
    """Return the loss map of 48 steel balls in a box, for 6 to 14 Hz: without gravity it is the same at each frequency."""
    balls = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter=BALL, count=16 * LAYERS),
        cavity=rb.Box(size=("20.2 mm", "20.2 mm", FREE + (1 + 0.9 * (LAYERS - 1)) * BALL)),
        contact=rb.Tsuji(restitution=0.8),
        friction=0.2,
        gravity=(0, 0, 0),
        packing=rb.Lattice(seed=1),
        softening=5,
        direction="z",
    )
    motion = rb.Harmonic(amplitude=(BEST, "m"), frequency=HERTZ, direction="z")
    case = rb.Case(structure=rb.Shaker(motion=motion), damper=balls, duration="1 s")
    study = rb.loss_map(case, [BEST * ratio for ratio in ratios], [HERTZ], cycles=cycles, samples=1 + 64 * cycles[1])
    return xr.concat(
        [study.assign_coords({FREQUENCY: [hertz]}) for hertz in (6.0, 14.0)], FREQUENCY, data_vars="minimal"
    )


def structure(mass, change=1.0, damping_ratio=0.005):
    """Return a structure of this mass [kg], whose frequency has changed by a factor, and its stiffness [N/m]."""
    part = rb.SDOF(mass=mass, frequency=HERTZ * change, damping_ratio=damping_ratio)
    return part, mass * (2 * math.pi * HERTZ * change) ** 2


def with_particles(study, levels, **options):
    """Return the largest displacement over the static one, at each level of the force over stiffness [m]."""
    part, stiffness = structure(float(study.particle_mass) / SHARE, **options)
    forces = [(float(stiffness * level), "N") for level in levels]
    return rb.response_from_map(part, study, level=forces).peak.values[0, 0] / levels


def with_tuned_mass(change=1.0, damping_ratio=0.005):
    """Return the largest displacement over the static one with a tuned mass, which was tuned before the change."""
    part, stiffness = structure(1.0, change, damping_ratio)
    tuned = rb.TunedMass.den_hartog(structure(1.0)[0], mass=SHARE)
    load = rb.Harmonic(amplitude="1 N", frequency=HERTZ)
    case = rb.Case(structure=part, tuned_mass=tuned, load=load, duration="1 s")
    response = rb.frequency_response(case, rb.linspace(0.6 * HERTZ, 1.4 * HERTZ, 401), cycles=(100, 5))
    return float(response.amplitude.max()) * stiffness


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    study, levels = loss_map(), BEST * np.geomspace(0.012, 0.15, 16)
    lines = {"unchanged": (1.0, 0.005), "20 % lower": (0.8, 0.005), "3 % of damping": (1.0, 0.03)}
    figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
    gains = {}
    marks = zip(rb.plots.SERIES_COLOURS, ("o", "^", "s"), (8, 4, 4), ("--", "-.", ":"), strict=False)
    for (name, (change, ratio)), (colour, mark, size, dashes) in zip(lines.items(), marks, strict=True):
        particles = with_particles(study, levels, change=change, damping_ratio=ratio)
        tuned, bare = with_tuned_mass(change, ratio), 1 / (2 * ratio)
        least, most = np.nanmin(particles), np.nanmax(particles)
        gains[name] = bare, tuned, least, most
        print(f"{name:15} bare {bare:3.0f}, tuned mass {tuned:4.1f}, particles {least:4.1f} to {most:4.1f}")
        axes.plot(levels / BEST, particles, f"{mark}-", ms=size, color=colour, label=f"particles, {name}")
        axes.axhline(tuned, color=colour, ls=dashes, label=f"tuned mass, {name}")
    axes.set(xlabel="Static displacement (best amplitude)", ylabel="Largest over static displacement", yscale="log")
    axes.set_yticks([5, 10, 20, 40], ["5", "10", "20", "40"])
    axes.minorticks_off()
    axes.margins(x=0.03)
    figure.legend(ncols=2, loc="outside upper left")
    figure.savefig("particles_or_tuned_mass.png", dpi=200)
    detuned = [with_tuned_mass(1 - lower) for lower in (0.0, 0.05, 0.1, 0.15, 0.2)]
    print("tuned mass, 0, 5, 10, 15 and 20 % lower:", ", ".join(f"{each:.1f}" for each in detuned))
    assert np.allclose(detuned, [6.1, 8.4, 11.8, 16.8, 23.5], atol=0.06)
    assert all(np.allclose(gains[name][2:], [16.5, 39.9], rtol=0.08) for name in ("unchanged", "20 % lower"))
    assert abs(gains["3 % of damping"][1] - 5.0) < 0.1 and abs(gains["3 % of damping"][2] - 9.1) < 0.7


if __name__ == "__main__":
    main()
