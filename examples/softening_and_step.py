"""Softening and time step
=======================

For everyone who sets a softening or a time step: the loss of a bed at rest and of one that is thrown, over both.

At 0.6 g the contacts make the bed a spring, whose loss grows with the softening; at 20 g the bed flies, and neither the
softening nor the step changes its loss.

:doc:`/guide/softening_and_step` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "check"]

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb

SOFTENINGS, FRACTIONS = [3, 10, 30, 100, 300], [0.05, 0.025, 0.0125]
SEED = "damper.packing.seed"


def losses(level, softenings, fraction=0.025, cycles=(15, 20), packings=6):
    """Return the loss in a cycle [m V^2] at this level [g], one row for each softening, one column for each packing."""
    balls = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="5 mm", count=30),
        cavity=rb.Box(size=("20 mm", "20 mm", "25 mm")),
        contact=rb.Tsuji(restitution=0.7),
        friction=0.2,
        direction="z",
        packing=rb.Settled(seed=1),
        softening=softenings[0],
    )
    motion = rb.Harmonic(amplitude=f"{level} g", frequency="160 Hz", direction="z")
    case = rb.Case(structure=rb.Shaker(motion=motion), damper=balls, duration="1 s", method=rb.Dem(fraction=fraction))
    axes = {"damper.softening": list(softenings), SEED: list(range(1, packings + 1))}
    return rb.sweep(case, axes, "reduced_loss", cycles=cycles).reduced_loss.values


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    figure, axes = plt.subplots(figsize=(5, 3.2), layout="constrained")
    found = {}
    for level, colour, mark in zip((0.6, 1.2, 20), rb.plots.SERIES_COLOURS, "o^s", strict=False):
        packings = losses(level, SOFTENINGS)
        found[level] = np.median(packings, axis=1)
        axes.plot(SOFTENINGS, packings, mark, ms=3, alpha=0.5, color=colour)
        axes.plot(SOFTENINGS, found[level], f"{mark}-", color=colour, label=f"{level} g")
        print(
            f"{level:4} g:",
            ", ".join(f"{each:.2f}" for each in found[level]),
            "in the median, with softening",
            SOFTENINGS,
        )
    steps = [np.median(losses(20, [30], fraction)) for fraction in FRACTIONS]
    print("20 g, with 20, 40 and 80 steps in the shortest contact:", ", ".join(f"{each:.2f}" for each in steps))
    axes.set(xlabel="Softening", ylabel="Loss a cycle ($m V^2$)", xscale="log", yscale="log")
    axes.margins(x=0.03)
    axes.legend()
    figure.savefig("softening_and_step.png", dpi=200)
    assert found[0.6][0] < 0.02 and found[0.6][-1] > 10 * found[0.6][0]  # medians and single packings scatter widely
    assert found[1.2][-1] > 3 * found[1.2][0]
    assert abs(found[20] - 0.25).max() < 0.02
    assert np.ptp(found[20]) < 0.1 * found[20].mean()
    assert np.ptp(steps) < 0.1 * found[20].mean()


if __name__ == "__main__":
    main()
