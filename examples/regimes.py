"""Four regimes of a shaken bed
============================

For everyone new to particle dampers: four regimes of a shaken bed of balls, with the loss and added mass of each.

A box with 48 steel balls is shaken at 20 Hz, without gravity and on earth. The pictures show the heights of all balls
between floor and lid over two cycles.

:doc:`/guide/regimes` explains it.
"""

# sphinx_gallery_tags = ["lecture", "space", "map"]

import math
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb

FREE, BALL, LAYERS = 0.010, 0.005, 3  # height over the bed at rest, diameter of the balls [m]
HEIGHT = FREE + (1 + 0.9 * (LAYERS - 1)) * BALL  # of the box [m]
BEST = FREE / math.pi  # amplitude of the shaker at which a ball without rebound loses most [m]
HERTZ, G = 20.0, 9.80665
ONE_G = G / (2 * math.pi * HERTZ) ** 2  # amplitude of the shaker with an acceleration of 1 g [m]
SPACE, EARTH = (0.0, 0.0, 0.0), (0.0, 0.0, -G)


# %%
# The box holds three layers of balls and is two balls higher than the bed.


def box(amplitude, gravity, **options):
    """Return the case of the box on a shaker that moves vertically with this amplitude [m]."""
    balls = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter=BALL, count=16 * LAYERS),
        cavity=rb.Box(size=("20.2 mm", "20.2 mm", HEIGHT)),
        contact=rb.Tsuji(restitution=0.8),
        friction=0.2,
        gravity=gravity,
        packing=rb.Settled(seed=1) if any(gravity) else rb.Lattice(seed=1),
        softening="auto" if any(gravity) else 5,
        direction="z",
    )
    motion = rb.Harmonic(amplitude=(amplitude, "m"), frequency=HERTZ, direction="z")
    return rb.Case(structure=rb.Shaker(motion=motion), damper=balls, **{"duration": "1 s", **options})


# %%
# A box without any free height, for comparison.


def full_box(packed):
    """Return the case of a cube that is full of balls: at random, or packed as a block that touches all walls."""
    places = BALL * np.stack(np.meshgrid(*3 * [np.arange(4) - 1.5]), -1).reshape(-1, 3)
    balls = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter=BALL, **({} if packed else {"bed_fill": 1})),
        cavity=rb.Box(size=3 * (4 * BALL,)),
        contact=rb.Tsuji(restitution=0.8),
        friction=0.2,
        packing=rb.Positions(positions=places) if packed else rb.Compacted(seed=1),
        softening=5,
        direction="z",
    )
    motion = rb.Harmonic(amplitude=(ONE_G, "m"), frequency=HERTZ, direction="z")
    return rb.Case(structure=rb.Shaker(motion=motion), damper=balls, duration="1 s")


# %%
# Loss and effective mass are measured over whole cycles of the steady motion.


def losses(amplitudes, gravity, cycles=(10, 10), case=None):
    """Return the loss map at these amplitudes [m]."""
    shaken = case or box(BEST, gravity)
    study = rb.loss_map(shaken, list(amplitudes), [HERTZ], cycles=cycles, samples=1 + 64 * cycles[1])
    return study.isel({"structure.motion.frequency": 0}).rename({"structure.motion.amplitude": "amplitude"})


# %%
# Snapshots of all balls over two cycles show the motion.


def heights(amplitude, gravity, skip=10, cycles=2, each=64):
    """Return times in cycles, and the heights of the box and of all balls relative to the base [m]."""
    count = (skip + cycles) * each + 1
    case = box(amplitude, gravity, duration=(skip + cycles) / HERTZ, output=rb.Output(snapshots=count))
    with TemporaryDirectory() as folder:
        rb.simulate(case, snapshots=f"{folder}/run.vtkhdf", progress=False)
        snapshots = rb.Snapshots(f"{folder}/run.vtkhdf")
        in_box = np.array([snapshots[k].position[:, 2] for k in range(skip * each, count)])
    time = np.arange(cycles * each + 1) / each
    moved = amplitude * np.sin(2 * np.pi * time)
    return time, moved, in_box + moved[:, None]


# %%
# Four motions, and the two maps to which they belong.


def draw(panel, time, moved, balls):
    """Draw paths of the centres of all balls between floor and lid."""
    floor, lid = (1e3 * (moved + end * HEIGHT / 2) for end in (-1, 1))
    panel.fill_between(time, floor, lid, color="0.93", lw=0)
    panel.plot(time, np.transpose([floor, lid]), "k", lw=1)
    panel.plot(time, 1e3 * balls, color=rb.plots.SERIES_COLOURS[0], lw=0.5)
    panel.set(xlabel="Time (cycles)", xlim=(0, 2))


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, draw the figure and check them."""
    regimes = {
        "locked\n0.7 g": (0.7 * ONE_G, EARTH),
        "bouncing\n2.2 g": (2.2 * ONE_G, EARTH),
        "gas\n0.3 $L$/π, no gravity": (0.3 * BEST, SPACE),
        "collect and collide\n$L$/π, no gravity": (BEST, SPACE),
    }
    maps = {
        "without gravity": losses(BEST * np.array([0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1.0, 1.3, 1.6, 2.0]), SPACE),
        "on earth": losses(ONE_G * np.array([0.7, 0.95, 1.3, 1.7, 2.2, 3.0, 4.0, 5.0, 6.5, 8.0, 10.0]), EARTH),
    }
    levels = (0.7, 2.0, 5.0, 10.0)
    full = {packed: losses(ONE_G * np.array(levels), EARTH, case=full_box(packed)) for packed in (True, False)}
    for packed, study in full.items():
        share, lost = (study.effective_mass / study.particle_mass).values, study.reduced_loss.values
        print("full of balls,", "a block" if packed else "at random")
        for row in zip(levels, share, lost, strict=True):
            print("  {:4.1f} g: effective mass {:.3f} m, loss {:.4f} m V^2".format(*row))
    figure = plt.figure(figsize=(7.5, 6), layout="constrained")
    upper, lower = figure.subfigures(2, 1, height_ratios=[3.2, 2.6])
    pictures, panels = upper.subplots(1, 4, sharey=True), lower.subplots(1, 2)
    for panel, (name, motion) in zip(pictures, regimes.items(), strict=True):
        draw(panel, *heights(*motion))
        panel.set_title(name)
    pictures[0].set_ylabel("Height (mm)")
    for (name, study), colour, mark in zip(maps.items(), rb.plots.SERIES_COLOURS, "os", strict=False):
        mass = study.effective_mass / study.particle_mass
        panels[0].plot(study.amplitude / BEST, study.reduced_loss, f"{mark}-", ms=4, color=colour, label=name)
        panels[1].plot(study.amplitude / BEST, mass, f"{mark}-", ms=4, color=colour)
        print(f"{name}: amplitude over L/pi, acceleration, loss, effective mass")
        for amplitude, loss, added in zip(study.amplitude.values, study.reduced_loss.values, mass.values, strict=True):
            print(f"{amplitude / BEST:5.2f} {amplitude / ONE_G:5.1f} g {loss:5.2f} m V^2 {added:5.2f} m")
    panels[0].set(ylabel="Loss a cycle ($m V^2$)", ylim=0)
    panels[1].set(ylabel="Effective mass ($m$)")
    for panel in panels:
        panel.axvline(1, color="0.8", lw=0.8, zorder=0)
        panel.set(xlabel="Amplitude of the box ($L$/π)", xlim=0)
    panels[0].legend(loc="lower right")
    figure.savefig("regimes.png", dpi=140)
    check(maps, full)


# %%
# The numbers of the guide.


def check(maps, full):
    """Raise if a number has changed."""
    space, earth = (study.assign(mass=study.effective_mass / study.particle_mass) for study in maps.values())
    assert not any(study.warnings.any() for study in maps.values())
    locked, bouncing = earth.isel(amplitude=slice(0, 2)), earth.isel(amplitude=slice(3, 6))
    assert abs(locked.mass - 1).max() < 0.01 and locked.reduced_loss.max() < 0.01
    assert bouncing.reduced_loss.min() > 1 and bouncing.reduced_loss.max() < 2.5
    gas, collected = space.isel(amplitude=slice(0, 3)), space.isel(amplitude=6)
    assert abs(gas.mass).max() < 0.1 and gas.reduced_loss.max() < 1
    assert abs(collected.reduced_loss - 3.4) < 0.3 and abs(collected.mass - 0.55) < 0.1
    assert abs(space.reduced_loss[0] - 0.4) < 0.1 and abs(space.reduced_loss[2] - 0.9) < 0.15
    assert all(abs(study.mass[-1] - 1) < 0.1 and abs(study.reduced_loss[-1] - 2.3) < 0.25 for study in (space, earth))
    assert abs(bouncing.reduced_loss[0] - 1.3) < 0.25 and abs(bouncing.reduced_loss[-1] - 2.1) < 0.25
    assert abs(bouncing.mass[0] - 0.9) < 0.1 and abs(bouncing.mass[-1] - 0.2) < 0.1
    assert abs(earth.reduced_loss[7] - 3.1) < 0.3
    block, loose = (study.assign(mass=study.effective_mass / study.particle_mass) for study in full.values())
    assert abs(block.mass - 1).max() < 0.005 and abs(block.reduced_loss).max() < 0.001
    assert abs(loose.reduced_loss[0]) < 0.001 and abs(loose.mass[0] - 1) < 0.005
    assert np.allclose(loose.reduced_loss[1:], [1.8, 1.4, 0.6], atol=0.35)
    assert np.allclose(loose.mass[1:], [0.76, 1.08, 1.12], atol=0.12)


if __name__ == "__main__":
    main()
