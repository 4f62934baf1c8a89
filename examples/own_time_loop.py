"""A damper in your own time integration
=====================================

For engineers with a time integration of their own: a ball in the Newmark loop of a frame with two masses.

The loop exchanges motion and force with the ball once in each step, or four times, by going back to the state of the
start of the step. Both approach the run of `rb.simulate` as the step goes to zero, the second one faster.

:doc:`/how-to/stepper` explains it.
"""

# sphinx_gallery_tags = ["building", "coupling"]

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb

M = np.diag([2.0, 1.0])  # kg
K = 1e4 * np.array([[3.0, -1.0], [-1.0, 1.0]])  # N/m
TOP = np.array([0.0, 1.0])  # the ball is at the second mass
START = np.array([2e-3, 5e-3])  # displacements, m
DURATION = 0.1  # s, with seven impacts
STEPS = (500, 1000, 2000, 4000, 8000, 16000)


def ball():
    """Return a steel ball in a rigid cavity."""
    sphere = rb.Sphere(radius="10 mm", material="steel")
    return rb.ImpactDamper(ball=sphere, gap="1 mm", contact=rb.Tsuji(restitution=0.6), point="top")


def newmark(steps, exchanges=1):
    """Return the displacements after the free decay, by Newmark's method with constant average acceleration [m]."""
    x, v, force = START, np.zeros(2), 0.0
    alone = ball().model_copy(update={"point": None})
    h, damper = DURATION / steps, rb.Stepper(alone, structure_mass=M[1, 1], velocity=TOP @ v)
    inverse = np.linalg.inv(M + h**2 / 4 * K)
    for k in range(1, steps + 1):
        before = damper.save() if exchanges > 1 else b""
        for exchange in range(exchanges):
            if exchange > 0:
                damper.restore(before)
            new = inverse @ (M @ v + h * (force * TOP - K @ (x + h / 4 * v)))
            force = damper.advance(k * h, velocity=TOP @ new).force
        x, v = x + h / 2 * (v + new), new
    return x


def whole_run():
    """Return the displacements of the same decay by `simulate`, which is exact to rounding [m]."""
    frame = rb.Matrices(M=M, K=K, points={"bottom": 0, "top": 1}, displacement=START)
    run = rb.simulate(rb.Case(structure=frame, damper=ball(), duration=DURATION), progress=False)
    assert run.impacts.sizes["impact"] == 7
    return run.motion.displacement.values[-1]


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    exact = whole_run()
    errors = {n: np.array([np.abs(newmark(steps, n) - exact).max() for steps in STEPS]) for n in (1, 4)}
    for exchanges, each in errors.items():
        order = np.log2(each[-2] / each[-1])
        print(f"exchanges in each step: {exchanges}; error {1e6 * each[-1]:.3f} um, order {order:.1f}")
    assert errors[1][-1] < 2e-6 and 0.8 < np.log2(errors[1][-2] / errors[1][-1]) < 1.2
    assert errors[4][-1] < 2e-8 and 1.8 < np.log2(errors[4][-2] / errors[4][-1]) < 2.2
    figure, axes = plt.subplots(figsize=(5, 3.5), layout="constrained")
    for (exchanges, each), line in zip(errors.items(), ("o-", "s--"), strict=True):
        axes.loglog(1e6 * DURATION / np.array(STEPS), 1e6 * each, line, label=f"{exchanges} in each step")
    axes.set(xlabel="Step (µs)", ylabel="Largest error of displacement (µm)")
    axes.margins(x=0.03)
    axes.legend(title="Exchanges")
    figure.savefig("own_time_loop.png", dpi=200)


if __name__ == "__main__":
    main()
