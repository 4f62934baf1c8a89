"""Find which start of a ball in a shaken cavity leads to which of its four steady motions, and draw the map."""

import rattlebox as rb

case = rb.Case(
    structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz")),
    damper=rb.ImpactDamper(
        ball=rb.Sphere(radius="10 mm", material="steel"),
        gap="1 mm",
        contact=rb.Tsuji(restitution=0.6),
    ),
    duration="1 s",
    method=rb.Newton(),
)
starts = {
    "damper.start": rb.linspace(-1, 1, 41),
    "damper.velocity": rb.linspace("-0.2 m/s", "0.2 m/s", 41),
}
maps = rb.basins(case, starts, cycles=(200, 16))
rb.plot_basins(maps).savefig("basins.png")
