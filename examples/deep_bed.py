"""Walls that carry a bed, and a slice of a wide one
=================================================

For engineers with a deep or a wide bed: side walls with friction carry much of a deep bed, and a slice between periodic
faces has the loss of a bed that is much wider.

Columns of glass balls are slowly pressed down, and the load on the floor is compared with Janssen's law. Beds of steel balls
of several widths are shaken, with frictionless sides or between periodic faces.

:doc:`/how-to/walls` explains both.
"""

# sphinx_gallery_tags = ["machine tool", "comparison"]

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb

BALL = 4e-3
COUNTS = (50, 100, 200, 300, 400)
PRESS = 100.0  # acceleration of the base that presses the bed down [m/s^2]
WIDTHS = (4, 8, 16, 24)  # of beds, in diameters


# %%
# A column of five diameters. The base accelerates upwards, slowly enough that the bed stays at rest in its can: balls at the
# side sink by micrometres, and their friction points upwards everywhere.


def load_on_floor(count, side):
    """Return the load on the floor over the force on the bed."""
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="glass", diameter=BALL, count=count),
        cavity=rb.Cylinder(diameter=5 * BALL, length=max(8, count / 12) * BALL),
        contact=rb.Tsuji(restitution=0.3),
        friction=0.3,
        walls={"side": side},
        packing=rb.Settled(seed=1),
        softening=3e4,
    )
    ramp = rb.Record(times=[0, 0.08, 1], values=[0, PRESS, PRESS], unit="m/s^2", direction="z")
    output = rb.Output(rate="400 Hz", walls=True)
    run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, base=ramp, duration="0.12 s", output=output))
    # Mean forces over the last 30 ms, from impulses, which contain all time steps.
    impulse = run.motion.wall_impulse.sel(axis="z")
    force = (impulse[-1] - impulse[-13]) / float(impulse.time[-1] - impulse.time[-13])
    return -float(force.sel(wall="first end")) / (run.arrays.particle_mass[0] * (9.81 + PRESS))


# %%
# The law has one number, the count N at which the load saturates.


def janssen(count, saturation):
    """Return the load on the floor over the weight of a column."""
    return (1 - np.exp(-np.asarray(count) / saturation)) * saturation / count


def loss(width, periodic):
    """Return the reduced loss of a shaken bed of four layers, six diameters deep along y."""
    walls = {} if "x" in periodic else {"-x": "frictionless", "+x": "frictionless"}
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter=BALL, count=20 * width),
        cavity=rb.Box(size=(width * BALL, 6 * BALL, 10 * BALL), periodic=periodic),
        contact=rb.Tsuji(restitution=0.7),
        friction=0.3,
        walls=walls,
        packing=rb.Settled(seed=1),
        softening=100,
    )
    shaker = rb.Shaker(motion=rb.Harmonic(amplitude="40 m/s^2", frequency="40 Hz", direction="z"))
    case = rb.Case(structure=shaker, damper=damper, duration="1 s")
    study = rb.sweep(case, {"seed": [0]}, ["reduced_loss"], cycles=(4, 12), progress=False)
    return study.reduced_loss.values.item()


@rb.plots.figure_style("page")
def main():
    """Compute both, draw the figure and check the numbers."""
    loads = np.array([load_on_floor(count, rb.Wall(friction=0.2, rolling=0.5)) for count in COUNTS])
    smooth = np.array([load_on_floor(count, "frictionless") for count in COUNTS])
    choices = np.linspace(100, 1000, 9001)
    saturation = choices[np.argmin([np.sum((janssen(COUNTS, each) - loads) ** 2) for each in choices])]
    print(f"the floor carries {100 * loads[-1]:.0f} % of {COUNTS[-1]} balls; N = {saturation:.0f}")
    walled, periodic = ([loss(width, axes) for width in WIDTHS] for axes in ("y", "xy"))
    print(f"loss of a slice of 8 diameters: {periodic[1]:.2f} m V^2; of a box of 24: {walled[-1]:.2f} m V^2")
    draw(loads, smooth, saturation, walled, periodic)
    check(loads, smooth, saturation, walled, periodic)


# %%
# Left, the load on the floor; right, the loss over the width of the bed.


def draw(loads, smooth, saturation, walled, periodic):
    """Draw loads on the floor and losses."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.5, 3), layout="constrained")
    line = np.linspace(10, 420, 100)
    left.plot(line, 100 * janssen(line, saturation), color="0.6", label=f"Janssen, N = {saturation:.0f}")
    left.plot(COUNTS, 100 * smooth, "s", ms=4, label="frictionless side")
    left.plot(COUNTS, 100 * loads, "o", ms=4, label="friction 0.2 at the side")
    left.set(xlabel="Balls in the column", ylabel="Load on the floor (% of weight)", ylim=(0, 110))
    left.legend(loc="lower left")
    right.plot(WIDTHS, walled, "s-", ms=4, label="frictionless sides")
    right.plot(WIDTHS, periodic, "o-", ms=4, label="periodic")
    right.set(xlabel="Width of the bed (diameters)", ylabel="Loss per cycle (mV²)", xlim=(0, 26), ylim=(0, 1.7))
    right.legend(loc="lower right")
    figure.savefig("deep_bed.png", dpi=200)


# %%
# The numbers of the page.


def check(loads, smooth, saturation, walled, periodic):
    """Raise if a number has changed."""
    assert np.abs(smooth - 1).max() < 0.02
    assert np.abs(janssen(COUNTS, saturation) - loads).max() < 0.03 and 250 < saturation < 350
    assert abs(periodic[1] / walled[-1] - 1) < 0.03
    assert abs(periodic[-1] / periodic[1] - 1) < 0.03


if __name__ == "__main__":
    main()
