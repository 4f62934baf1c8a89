"""Friction of balls from a drop test and a shaker
===============================================

For experimenters who need restitution and friction of the balls in a filled box: a drop test and a shaker give both.

A box of 48 steel balls is shaken sideways at four levels. Its losses alone do not separate restitution and friction:
livelier balls with more friction lose as much. With the restitution of a drop test the friction follows. The measurements
are simulated with known values, another random packing and random errors of 2 %; all intervals hold these values.

:doc:`/how-to/calibration` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "space", "calibration"]

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb

RESTITUTION, FRICTION = 0.9, 0.25
LEVELS, HERTZ = ["8 g_0", "10 g_0", "12 g_0", "14 g_0"], "30 Hz"
CYCLES = (6, 18)
RANGES = {"damper.contact.restitution": (0.8, 0.97), "damper.friction": (0.0, 0.6)}


# %%
# The same box serves as the experiment, with the true values, and as the model, with unknown ones.


def box(restitution=0.8, friction=0.3, seed=0):
    """Return the box on a shaker with the parameters and the random packing of a seed."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude=LEVELS[0], frequency=HERTZ, direction="x")),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="5 mm", count=48),
            cavity=rb.Box(size=("30 mm", "20 mm", "20 mm")),
            contact=rb.Tsuji(restitution=restitution),
            friction=friction,
            softening=1000,  # for speed, in the experiment as in its model; rb.check_softening for a real one
            packing=rb.Settled(seed=seed),
        ),
        duration="1 s",
    )


# %%
# The experiment: heights of rebounds, and losses at four levels, both with random errors.


def measurements():
    """Return a drop test, and losses of the box of the experiment."""
    rng = np.random.default_rng(1)
    rebounds = 300 * (RESTITUTION * (1 + 0.005 * rng.standard_normal(6))) ** 2
    losses = rb.loss_map(box(RESTITUTION, FRICTION, seed=5000), LEVELS, [HERTZ], cycles=CYCLES, progress=False)
    measured = losses.reduced_loss.values[:, 0] * (1 + 0.02 * rng.standard_normal(len(LEVELS)))
    return rb.Drops("300 mm", (rebounds, "mm")), rb.ShakerLoss(
        LEVELS, HERTZ, reduced_loss=measured, error="2 %", cycles=CYCLES
    )


# %%
# The drop test gives the restitution with its interval, which narrows the fit of the losses.


def calibrations(drops, losses, **options):
    """Return the calibration by losses alone, and that with the restitution of the drops."""
    tested = rb.calibrate(drops)
    half = (tested.upper - tested.lower).item() / 2
    known = {"damper.contact.restitution": (tested.value.item(), half)}
    return [
        rb.calibrate(losses, box(), RANGES, known=each, runs=30, checks=4, progress=False, **options)
        for each in (None, known)
    ]


# %%
# Both fits side by side: values with intervals, and regions in which restitution and friction agree with the data.


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, draw the figure and check them."""
    drops, losses = measurements()
    results = calibrations(drops, losses)
    for name, result in zip(("losses alone", "with the drop test"), results, strict=True):
        for path in RANGES:
            one = result.sel(parameter=path)
            print(f"{name}, {path}: {float(one.value):.3f} ({float(one.lower):.3f} to {float(one.upper):.3f})")
    draw(losses, results)
    check(results)


def draw(losses, results):
    """Draw losses and regions."""
    figure, panels = plt.subplots(1, 2, figsize=(7.5, 3.2), layout="constrained")
    places = [float(level.split()[0]) for level in LEVELS]
    panels[0].errorbar(places, losses.loss, 1.96 * losses.error, fmt="ok", ms=4, label="measured")
    result = results[1]
    panels[0].errorbar(
        places, result.check, 1.96 * result.check_deviation, fmt="D-", ms=4, color=rb.plots.SERIES_COLOURS[1],
        label="simulated at the result",
    )  # fmt: skip
    panels[0].set(xlabel="Amplitude (g)", ylabel="Loss a cycle / mV²", ylim=(0, None))
    panels[0].margins(x=0.05)
    panels[0].legend()
    for result, colour, name in zip(
        results, rb.plots.SERIES_COLOURS, ("losses alone", "with the drop test"), strict=False
    ):
        x, y = result.first_value, result.second_value
        panels[1].contourf(x, y, result.region.T, levels=[0, float(result.threshold)], colors=[colour], alpha=0.3)
        panels[1].contour(x, y, result.region.T, levels=[float(result.threshold)], colors=[colour])
        panels[1].plot([], [], color=colour, label=name)
    panels[1].plot(RESTITUTION, FRICTION, "k+", ms=9, mew=2, label="true values")
    panels[1].set(xlabel="Restitution", ylabel="Friction", xlim=RANGES["damper.contact.restitution"], ylim=(0, 0.6))
    panels[1].legend(loc="upper left")
    figure.savefig("calibration.png", dpi=150)


# %%
# All intervals hold the true values, and the drop test narrows that of the friction.


def check(results):
    """Raise if an interval misses a true value."""
    for result in results:
        for value, path in zip((RESTITUTION, FRICTION), RANGES, strict=True):
            one = result.sel(parameter=path)
            assert one.lower <= value <= one.upper
    alone, both = ((result.upper - result.lower).sel(parameter="damper.friction") for result in results)
    assert both < 0.6 * alone
    assert "the data cannot separate" in results[0].undetermined[0] and not results[1].undetermined


if __name__ == "__main__":
    main()
