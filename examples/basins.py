"""Which start leads to which motion
=================================

For users whose damper behaves differently from start to start: basins of attraction of a ball in a shaken cavity.

The map shows which initial position and velocity leads to which of four steady motions.

:doc:`/how-to/basins` explains it.
"""

# sphinx_gallery_tags = ["lecture", "map"]

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
    "damper.start": rb.linspace(-1, 1, 61),
    "damper.velocity": rb.linspace("-0.2 m/s", "0.2 m/s", 61),
}
maps = rb.basins(case, starts, cycles=(200, 16))
rb.plot_basins(maps).savefig("basins.png")
print(f"{maps.sizes['orbit']} motions; the first one from {float(maps.share[0]):.0%} of the starts")
assert maps.sizes["orbit"] == 4 and abs(float(maps.share[0]) - 0.33) < 0.02
