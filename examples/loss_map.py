"""Loss map of one ball
====================

For users who choose a damper for a frequency range: loss and effective mass of a ball over amplitude and frequency.

A ball in a cavity on a shaker is computed for 25 amplitudes and 21 frequencies. At small accelerations the ball moves with
the cavity and its effective mass is its mass; the largest loss per cycle is 12 m V^2.

:doc:`/how-to/loss_map` explains it.
"""

# sphinx_gallery_tags = ["lecture", "map"]

import rattlebox as rb

case = rb.Case(
    structure=rb.Shaker(motion=rb.Harmonic(amplitude="100 m/s^2", frequency="50 Hz")),
    damper=rb.ImpactDamper(
        ball=rb.Sphere(diameter="20 mm", material="steel"),
        gap="1 mm",
        start=-1.0,
        gravity="-9.81 m/s^2",
        contact=rb.Tsuji(restitution=0.6),
    ),
    duration="1 s",
    method=rb.Newton(),
)
result = rb.loss_map(
    case,
    rb.geomspace("15 m/s^2", "500 m/s^2", 25),
    rb.geomspace("10 Hz", "200 Hz", 21),
    cycles=(400, 20),
)
rb.plot_loss_map(result).savefig("loss_map.png")
print(f"largest loss per cycle: {float(result.reduced_loss.max()):.1f} m V^2")
assert 11 < result.reduced_loss.max() < 12.5
