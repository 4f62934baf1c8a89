"""Dampers in a gear: the loss collapses with the speed
====================================================

For designers of gears, rotors and spindles: balls in the holes of a wheel are pressed to the outer wall of their hole, and
above some speed the bed is locked.

A hole with steel balls, 60 mm from the axis of a gear that vibrates with 60 g at 300 Hz, is computed at several speeds. The
centrifugal acceleration exceeds that of the vibration from 946 rpm on: the loss in a cycle collapses between 700 and
1000 rpm. Without rotation the balls lie on the floor of the hole, across the vibration, and lose little, too.

Particle dampers in gears were computed and tested by W. Xiao, J. Li, S. Wang, X. Fang, Journal of Sound and Vibration 366
(2016) 62, doi:10.1016/j.jsv.2015.12.014.

:doc:`/how-to/turning` explains it.
"""

# sphinx_gallery_tags = ["space", "study"]

import matplotlib.pyplot as plt
import numpy as np
from scipy.stats import t

import rattlebox as rb

SPEEDS = np.array([0, 300, 500, 700, 850, 1000, 1300])  # rpm
PACKINGS = 3
FREQUENCY, SKIPPED, CYCLES = 300.0, 30, 60

# %%
# The axis of the gear is horizontal, along y, and the gear vibrates along x.

GEAR = rb.Case(
    structure=rb.Shaker(motion=rb.Harmonic(amplitude="60 g", frequency=FREQUENCY)),
    damper=rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="3 mm", count=60),
        cavity=rb.Cylinder(diameter="16 mm", length="16 mm", axis="y"),
        contact=rb.Linear(contact_time="50 us", restitution=0.6),
        friction=rb.LinearSpring(0.3, ratio=2 / 7),
        packing=rb.Settled(seed=1),
        rotation=rb.Rotation(arm=("60 mm", "0 mm", "0 mm"), axis="y", speed="0 rpm"),
    ),
    duration=(SKIPPED + CYCLES) / FREQUENCY,
    output=rb.Output(rate=64 * FREQUENCY),
)


def loss(speed: float, seed: int) -> float:
    """Return the work of the vibration in a cycle over m V^2 at a speed in rpm, of a bed with a random packing."""
    run = rb.simulate(GEAR.replaced({"damper.rotation.speed": f"{speed} rpm", "damper.packing.seed": seed}))
    assert run.status == "finished"
    shaken = rb.analysis.shaken_cavity(run, frequency=FREQUENCY, after=SKIPPED / FREQUENCY)
    by_energy, by_force = shaken.reduced_loss.values
    assert abs(by_energy / by_force - 1) < 0.02  # two ways to the same loss: the work of the drive is in neither
    return float(by_energy)


# %%
# Each speed is computed with several random packings; the bars are 95 % intervals of their mean.


@rb.plots.figure_style("page")
def main() -> None:
    """Compute the losses, draw them, and check the collapse."""
    losses = np.array([[loss(speed, seed) for seed in range(1, PACKINGS + 1)] for speed in SPEEDS])
    mean = losses.mean(axis=1)
    half = t.ppf(0.975, PACKINGS - 1) * losses.std(axis=1, ddof=1) / np.sqrt(PACKINGS)
    critical = np.sqrt(60 * 9.80665 / 0.06) * 30 / np.pi
    for speed, value, bar in zip(SPEEDS, mean, half, strict=True):
        print(f"{speed:5.0f} rpm: {value:.2f} +- {bar:.2f} m V^2 a cycle")
    figure, axes = plt.subplots(figsize=(5, 3.2), layout="constrained")
    axes.errorbar(SPEEDS, mean, half, marker="o", ms=4, capsize=3, label="mean of the packings, 95 %")
    axes.axvline(critical, linestyle="--", color="0.5", label="centrifugal acceleration = 60 g")
    axes.set(xlabel="Speed of the gear (rpm)", ylabel="Loss in a cycle over m V$^2$", ylim=(0, None), xlim=(-40, 1340))
    axes.legend()
    figure.savefig("gear.png", dpi=200)

    # The collapse, with its interval: the loss at 1000 rpm is well below that at 700 rpm.
    ratio = mean[SPEEDS == 1000][0] / mean[SPEEDS == 700][0]
    print(f"loss at 1000 rpm over that at 700 rpm: {ratio:.2f}")
    assert (mean + half)[SPEEDS == 1000][0] < 0.5 * (mean - half)[SPEEDS == 700][0]


if __name__ == "__main__":
    main()
