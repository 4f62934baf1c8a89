"""Free decay in weightlessness
============================

For critical readers: free decay of a box of beads on a leaf spring in weightlessness.

Bannerman et al. measured in parabolic flight, and found with event-driven hard spheres, that the amplitude falls
linearly while the bed is collected and thrown once per half-cycle, and then leaves this regime. Mass ratio, size of
the box, restitution, frequency and start are theirs. Friction is not published and is swept from 0 to 0.3; packings
are random.

Reference: M. N. Bannerman, J. E. Kollmer, A. Sack, M. Heckel, P. Mueller, T. Poeschel (2011), Movers and shakers:
granular damping in microgravity, Physical Review E 84, 011301, doi:10.1103/PhysRevE.84.011301.

:doc:`/validation/experiments` explains it.
"""

# sphinx_gallery_tags = ["space", "damping curve", "validation"]

import matplotlib.pyplot as plt
import numpy as np
from scipy.signal import find_peaks

import rattlebox as rb

DIAMETER = 10e-3  # of a steel bead [m]
COUNT = 37
MASS_RATIO = 2.93  # of box and beads
SIZE = (4 * DIAMETER, 5.2 * DIAMETER, 5.2 * DIAMETER)
FREQUENCY, START = 1.23, 10.7 * DIAMETER  # of the box with its spring [Hz], released at [m]


def case(friction=0.1, seed=1, softening=1000, duration=12.0, fraction=0.025):
    """Return the case of a coefficient of friction and a random packing; the step is a fraction of the shortest contact."""
    beads = rb.Particles(material="steel", diameter=DIAMETER, count=COUNT)
    mass = MASS_RATIO * COUNT * np.pi / 6 * DIAMETER**3 * rb.materials()["steel"].density
    return rb.Case(
        structure=rb.SDOF(mass=mass, frequency=FREQUENCY, displacement=START),
        damper=rb.ParticleDamper(
            particles=beads,
            cavity=rb.Box(size=SIZE),
            contact=rb.Tsuji(restitution=0.75),
            wall_contact=rb.Tsuji(restitution=0.76),
            friction=friction,
            gravity=(0, 0, 0),
            direction="x",
            packing=rb.Lattice(noise=1.0, seed=seed),
            softening=softening,
        ),
        duration=duration,
        method=rb.Dem(fraction=fraction),
        output=rb.Output(rate="500 Hz"),
    )


def peaks(run):
    """Return times [s] and values [m] of the maxima of the displacement on the side of the start."""
    time, x = run.motion.time.values, run.motion.displacement.sel(point="mass").values
    half_cycle = 0.5 / FREQUENCY / (time[1] - time[0])  # a collision near a maximum makes two of it
    top, _ = find_peaks(x, height=0.0, distance=half_cycle)
    return np.concatenate([[0.0], time[top]]), np.concatenate([[x[0]], x[top]])


def linear_part(values):
    """Return the decrement per cycle down to a quarter of the start, and the largest deviation from a line."""
    part = values[1:][values[1:] > 0.25 * values[0]]
    number = np.arange(part.size)
    slope, start = np.polyfit(number, part, 1)
    return -slope, float(np.abs(part - start - slope * number).max() / values[0])


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    rows = []
    figure, axes = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
    for friction, colour, mark in zip((0.0, 0.1, 0.3), rb.plots.SERIES_COLOURS, "o^s", strict=False):
        for seed in (1, 2, 3):
            times, tops = peaks(rb.simulate(case(friction, seed)))
            rows.append((friction, *linear_part(tops)))
            name = f"friction {friction}" if seed == 1 else None
            axes.plot(FREQUENCY * times, 1e3 * tops, f"{mark}-", ms=3, lw=0.8, color=colour, label=name)
    axes.set(xlabel="Time (cycles)", ylabel="Amplitude of the box (mm)", ylim=0)
    axes.margins(x=0.03)
    axes.legend()
    figure.savefig("microgravity_decay.png", dpi=200)
    table = np.array(rows)
    print("friction, decrement per cycle (mm), deviation from a line")
    print(np.round(table * [1, 1e3, 1], 4))
    slopes, deviations = table[:, 1] / DIAMETER, table[:, 2]
    interval = f"{slopes.mean():.2f} +- {2 * slopes.std():.2f}"
    print(f"decrement {interval} diameters per cycle; off the line by {deviations.max():.1%}")
    assert deviations.max() < 0.03  # linear
    assert 0.7 < slopes.min() <= slopes.max() < 1.0


if __name__ == "__main__":
    main()
