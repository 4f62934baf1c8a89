"""Follow a ball in a shaken cavity over the amplitude, up and back down, and draw what it does."""

import rattlebox as rb

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
    "structure.motion.amplitude",
    rb.linspace("0.1 mm", "3 mm", 201),
    cycles=(150, 32),
    show="impacts",
)
rb.plot_bifurcation(maps).savefig("bifurcation.png")
