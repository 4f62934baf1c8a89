"""Period doubling of a ball in a shaken cavity
============================================

For users who look for period doubling and jumps: bifurcation diagram of a ball in a shaken cavity.

The motion is followed over the amplitude of the shaker, up and down again.

:doc:`/how-to/bifurcation` explains it.
"""

# sphinx_gallery_tags = ["lecture", "sweep"]

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
