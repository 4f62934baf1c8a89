"""Period doubling of a ball in a shaken cavity
============================================

For users who look for period doubling and jumps: bifurcation diagram of a ball in a shaken cavity.

The motion is followed over the amplitude of the shaker, up and down again.

:doc:`/how-to/bifurcation` explains it.
"""

# sphinx_gallery_tags = ["lecture", "sweep"]

import numpy as np

import rattlebox as rb

AMPLITUDE = "structure.motion.amplitude"

case = rb.Case(
    structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz")),
    damper=rb.ImpactDamper(
        ball=rb.Sphere(radius="10 mm", material="steel"),
        gap="1 mm",
        velocity="0.1 m/s",
        contact=rb.Tsuji(restitution=0.6),
    ),
    duration="1 s",
    method=rb.Newton(),
)
maps = rb.bifurcation(
    case,
    AMPLITUDE,
    rb.linspace("0.1 mm", "3 mm", 201),
    cycles=(150, 32),
    show="impacts",
)
rb.plot_bifurcation(maps).savefig("bifurcation.png")
down = maps.sel(direction="down")
doubled = down[AMPLITUDE].where(down.period == 2, drop=True)
print(f"the period doubles at {1e3 * float(doubled.min()):.2f} mm")
assert abs(float(doubled.min()) - 1.10e-3) < 0.03e-3

impacts = maps.impacts_per_cycle
two = down[AMPLITUDE].where((down.period == 1) & np.isclose(down.impacts_per_cycle, 2), drop=True)
two_up, three_down = np.isclose(impacts.sel(direction="up"), 2), np.isclose(impacts.sel(direction="down"), 3)
coexisting = down[AMPLITUDE].values[two_up & three_down]
four = down[AMPLITUDE].where((down.period == 1) & np.isclose(down.impacts_per_cycle, 4), drop=True)
print(f"two impacts a cycle from {1e3 * float(two.min()):.2f} mm, four from {1e3 * float(four.min()):.2f} mm")
print(f"two motions coexist from {1e3 * coexisting.min():.2f} to {1e3 * coexisting.max():.2f} mm")
theory = 2e-3 / np.hypot(np.pi * (1 + 0.6) / (1 - 0.6), 2)  # smallest amplitude with two impacts a cycle, gap of 1 mm
assert abs(theory - 0.157e-3) < 0.0005e-3 and theory < two.min() < theory + 0.015e-3
assert abs(four.min() - 2.35e-3) < 0.02e-3
assert np.allclose([coexisting.min(), coexisting.max()], [0.98e-3, 1.07e-3], atol=0.02e-3)
