"""Time step of a dense bed
========================

For everyone who sets a time step: the energy balance of a full box without any loss but friction, over the step.

The largest permitted step is stable, but not accurate. The automatic step keeps the balance to 0.1 %, and errors fall at
least with the square of the step.

:doc:`/tutorials/particle_dampers` explains it.
"""

# sphinx_gallery_tags = ["check"]

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb

BOUND = 6.39e-6  # largest step that is permitted here [s]; a fifth of the shortest contact, less with friction
STEPS = (BOUND, BOUND / 2, 1.6e-6, 0.9e-6, 0.45e-6)  # 0.9 us is the automatic step [s]


def residual(step):
    """Return the energy residual of a full box that is shaken for five cycles, with a step [s]."""
    balls = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="5 mm", bed_fill=1),
        cavity=rb.Box(size=("25 mm", "25 mm", "25 mm")),
        contact=rb.Tsuji(restitution=1.0),
        friction=0.5,
        gravity=(0, 0, 0),
        packing=rb.Compacted(seed=1),
        direction="z",
        softening=10,
    )
    shaker = rb.Shaker(motion=rb.Harmonic(amplitude="2 mm", frequency="50 Hz", direction="z"))
    case = rb.Case(structure=shaker, damper=balls, duration="0.1 s", method=rb.Dem(dt=step))
    return rb.simulate(case, progress=False).energy_residual


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    residuals = [residual(step) for step in STEPS]
    for step, each in zip(STEPS, residuals, strict=True):
        print(f"step {1e6 * step:.2f} us: energy residual {each:.2%}")
    figure, axes = plt.subplots(figsize=(5, 3.2), layout="constrained")
    steps = 1e6 * np.array(STEPS)
    axes.loglog(steps, residuals, "o-", label="computed")
    axes.loglog(steps, residuals[1] * (steps / steps[1]) ** 2, "k:", label="square of the step")
    axes.axhline(0.01, color="0.7", lw=0.8, label="energy_error")
    axes.set(xlabel="Time step (µs)", ylabel="Energy residual")
    axes.set_xticks([0.5, 1, 2, 5], ["0.5", "1", "2", "5"], minor=False)
    axes.tick_params(axis="x", which="minor", labelbottom=False)
    axes.margins(x=0.03)
    axes.legend()
    figure.savefig("time_step.png", dpi=200)
    assert 0.2 < residuals[0] < 0.35 and 0.01 < residuals[1] < 0.04 and residuals[3] < 1.5e-3
    order = np.polyfit(np.log(STEPS[1:]), np.log(residuals[1:]), 1)[0]
    assert order > 1.7
    # A ball in a spherical cavity of four times its radius, computed as at a flat wall: stiffer by 15 %, shorter by 6 %.
    stiffer = np.sqrt(1 / (1 - 1 / 4))
    assert abs(stiffer - 1.15) < 0.01 and abs(stiffer ** (-2 / 5) - 0.94) < 0.005


if __name__ == "__main__":
    main()
