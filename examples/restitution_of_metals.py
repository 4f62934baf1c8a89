"""Restitution of metals over speed
================================

For users who have no measurement: restitution of pairs of balls from the yield stress, over speed, by two laws.

The law of Jackson and Green is compared with rebounds of an alumina ball from two steel blocks of known hardness at 10 m/s,
0.63 at 300 HV and 0.86 at 700 HV (Journal of the Material Testing Research Association of Japan 69, no. 1, abstract).
The law has no value for impacts faster than those to which it was fitted.

:doc:`/guide/restitution_and_friction` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "inputs"]

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb

LAWS = {"Thornton": rb.ThorntonRestitution(), "Jackson and Green": rb.JacksonGreen()}
BLOCKS = {300: 0.63, 700: 0.86}  # measured restitution over the Vickers hardness
COMPUTED = {300: (0.40, 0.57), 700: (0.68, 0.84)}  # by both laws
BEADS = 0.75  # of steel beads at up to 1 m/s, in the simulation of a flight experiment by Bannerman et al.
RANGES = {  # restitution of balls of 5 mm by both laws, at 0.1, 1 and 5 m/s
    "steel": ((0.99, 0.99), (0.63, 0.81), (0.42, 0.59)),
    "aluminium": ((0.90, 0.96), (0.53, 0.73), (0.36, 0.52)),
    "brass": ((0.75, 0.89), (0.43, 0.61), (0.29, 0.42)),
    "copper": ((0.62, 0.82), (0.35, 0.52), (0.24, 0.33)),
    "tungsten_alloy": ((0.50, 0.69), (0.28, 0.41), (0.19,)),
    "stainless_steel": ((0.43, 0.60), (0.24, 0.34), (0.16,)),
    "lead": ((0.17,), (0.10,), (0.06,)),
}


def restitution(law, speeds, first, second, diameter=5e-3):
    """Return the restitution of two balls, or of a ball and a wall if there is only one, at these speeds [m/s]."""
    spheres = [rb.Sphere(diameter=diameter, material=each) for each in first]
    damper = rb.ImpactDamper(balls=spheres, gap="5 mm", wall=second, contact=rb.Tsuji(restitution=0.5))
    case = rb.Case(structure=rb.Fixed(), damper=damper, duration="1 s")
    return rb.restitution_curve(law, rb.contact_pairs(case, 0)[len(spheres) - 1], speeds)


def block(hardness):
    """Return a steel of this Vickers hardness, with the yield stress of Tabor: hardness over 2.8."""
    return rb.materials()["steel"].model_copy(update={"yield_stress": hardness * 9.80665e6 / 2.8})


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    speeds = np.array([0.1, 1.0, 5.0])
    for name, ranges in RANGES.items():
        pairs = np.transpose([restitution(law, speeds, [name, name], name) for law in LAWS.values()])
        words = [" to ".join(f"{value:.2f}" for value in pair if np.isfinite(value)) for pair in pairs]
        print(f"{name:16}", *(f"{each:13}" for each in words), "at 0.1, 1 and 5 m/s")
        for pair, known in zip(pairs, ranges, strict=True):
            assert np.allclose(pair[np.isfinite(pair)], known, atol=0.006)
    for hardness, measured in BLOCKS.items():
        low, high = (float(restitution(law, 10.0, ["alumina"], block(hardness), 3e-3)) for law in LAWS.values())
        print(f"block of {hardness} HV: measured {measured}, Thornton {low:.2f}, Jackson and Green {high:.2f}")
        assert low < high < measured and measured - high < 0.07
        assert np.allclose([low, high], COMPUTED[hardness], atol=0.006)
    low, high = RANGES["steel"][1]
    assert low < BEADS < high

    figure, axes = plt.subplots(figsize=(6.5, 3.5), layout="constrained")
    curve = np.geomspace(0.01, 10, 50)
    metals = ("steel", "brass", "copper", "tungsten_alloy", "lead")
    for name, colour, mark in zip(metals, rb.plots.SERIES_COLOURS, rb.plots.SERIES_MARKERS, strict=False):
        for law, style in zip(LAWS.values(), ("--", "-"), strict=True):
            label = name.replace("_", " ") if style == "-" else None
            axes.plot(
                curve, restitution(law, curve, [name, name], name), mark + style, color=colour, label=label, markevery=8
            )
    axes.plot([10, 10], list(BLOCKS.values()), "kx", label="alumina on steel,\nmeasured")
    axes.set(xlabel="Approach speed (m/s)", ylabel="Restitution", xscale="log", xlim=(0.009, 12), ylim=(0, 1.02))
    for style, name in (("k-", "Jackson and Green"), ("k--", "Thornton")):
        axes.plot([], [], style, label=name)
    figure.legend(loc="outside right center")
    figure.savefig("restitution_of_metals.png", dpi=200)


if __name__ == "__main__":
    main()
