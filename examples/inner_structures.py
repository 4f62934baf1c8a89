"""Rings, wedges and honeycombs
============================

For designers of particle dampers: what the shape of a cavity does to the loss of the same balls.

The same mass of steel balls is shaken in four cavities of about the same volume: a can, a ring around a rod, a wedge of
triangles, and a can with the walls of a honeycomb. The loss in a cycle, over m V^2, is drawn over the acceleration.

:doc:`/how-to/cad_cavities` explains the fields.
"""

# sphinx_gallery_tags = ["machine tool", "map"]

import math

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb

VOLUME, LENGTH = 12e-6, 20e-3
COUNT, FREQUENCY = 120, 50.0
ACCELERATIONS = (15.0, 40.0, 100.0)


# %%
# All cavities have the same volume for the balls. The rod takes a quarter of a wider can, and the walls of the honeycomb
# their own volume. The wedge is a triangular prism, in metres.


def shapes():
    """Return the cavity and the bodies of each shape."""
    area = VOLUME / LENGTH
    across = math.sqrt(area / math.pi)
    ring = across / math.sqrt(0.75)
    comb = rb.Honeycomb(cell=0.8 * across, thickness=1e-3, rings=1)
    side = math.sqrt(2 * area)
    wedge = rb.Mesh(
        vertices=[[x, y, z] for z in (0, LENGTH) for x, y in ((0, 0), (side, 0), (0, side))],
        faces=[[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]],
        unit="m",
    )
    return {
        "can": (rb.Cylinder(radius=across, length=LENGTH), []),
        "ring": (rb.Cylinder(radius=ring, length=LENGTH), [rb.RodBody(radius=0.5 * ring)]),
        "wedge": (wedge, []),
        "honeycomb": (rb.Cylinder(radius=1.12 * across, length=LENGTH), [comb]),
    }


def case(cavity, bodies, acceleration):
    """Return a case with balls in a cavity that a shaker moves along x."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude=f"{acceleration} m/s^2", frequency=FREQUENCY)),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="3 mm", count=COUNT),
            cavity=cavity,
            bodies=bodies,
            contact=rb.Tsuji(restitution=0.7),
            friction=0.3,
            packing=rb.Settled(seed=1),
            softening=60,
        ),
        duration=24 / FREQUENCY,
        output=rb.Output(rate=40 * FREQUENCY),
    )


# %%
# Twenty-four cycles of each; the first fourteen are left out.


def losses():
    """Return the loss in a cycle over m V^2, by shape and acceleration."""
    result = {}
    for name, (cavity, bodies) in shapes().items():
        values = []
        for acceleration in ACCELERATIONS:
            run = rb.simulate(case(cavity, bodies, acceleration))
            assert run.ok, run.message
            loss = rb.analysis.shaken_cavity(run, frequency=FREQUENCY, after=14 / FREQUENCY).reduced_loss
            values.append(float(loss.sel(way="complex power")))
        result[name] = np.array(values)
        print(f"{name}: {', '.join(f'{value:.2f}' for value in values)} m V^2")
    return result


@rb.plots.figure_style("page")
def main():
    """Compute the losses, draw them, and check the numbers."""
    result = losses()
    figure, axes = plt.subplots(figsize=(5, 3.2), layout="constrained")
    for (name, values), colour in zip(result.items(), rb.plots.SERIES_COLOURS, strict=False):
        axes.plot(np.array(ACCELERATIONS) / 9.81, values, "o-", ms=4, label=name, color=colour)
    axes.set(xlabel="Acceleration (g)", ylabel="Loss in a cycle over m V$^2$", ylim=(0, 2.9))
    axes.margins(x=0.03)
    axes.legend()
    figure.savefig("inner_structures.png", dpi=200)
    check(result)


# %%
# The numbers of the page.


def check(result):
    """Raise if a number has changed."""
    volumes = [case(*shape, ACCELERATIONS[0]).dampers[0].interior.volume for shape in shapes().values()]
    assert all(abs(volume / VOLUME - 1) < 0.06 for volume in volumes), volumes
    # At ten times gravity the walls of the cells keep hitting the balls, which a can carries along as a lump.
    assert result["honeycomb"][2] > 4 * result["can"][2] and result["ring"][2] > 2 * result["can"][2]


if __name__ == "__main__":
    main()
