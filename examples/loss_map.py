"""Loss map of one ball
====================

For users who choose a damper for a frequency range: loss and effective mass of a ball over amplitude and frequency.

A ball in a cavity on a shaker is computed for 25 amplitudes and 21 frequencies. At small accelerations the ball moves with
the cavity and its effective mass is its mass; the largest loss per cycle is 12 m V^2.

:doc:`/how-to/loss_map` explains it.
"""

# sphinx_gallery_tags = ["lecture", "map"]

import numpy as np
from scipy.optimize import brentq

import rattlebox as rb

# %%
# A ball lies on the floor of a cavity that is shaken vertically. Hard impacts suffice: contacts have no duration.

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

# %%
# Each point of the map is a steady motion: 400 cycles to get there, 20 to measure.

result = rb.loss_map(
    case,
    rb.geomspace("15 m/s^2", "500 m/s^2", 25),
    rb.geomspace("10 Hz", "200 Hz", 21),
    cycles=(400, 20),
)
rb.plot_loss_map(result).savefig("loss_map.png")
print(f"largest loss per cycle: {float(result.reduced_loss.max()):.1f} m V^2")

# %%
# The largest loss at 95 Hz against theory: a ball that hits floor and lid once a cycle, without gravity.

at_95_hz = result.reduced_loss.sel({"structure.motion.frequency": 95}, method="nearest")
level = float(at_95_hz.idxmax())
ratio, gap = 1.6 / 0.4, 1e-3  # (1 + e) / (1 - e), gap to either side [m]
amplitude = level / (2 * np.pi * float(at_95_hz["structure.motion.frequency"])) ** 2
phase = brentq(lambda phi: amplitude * (ratio * np.pi * np.cos(phi) + 2 * np.sin(phi)) - 2 * gap, -1.5, 0.1)
theory = 4 * ratio * np.cos(phase) ** 2
print(f"at 95 Hz and {amplitude / gap:.2f} gaps: {float(at_95_hz.max()):.1f} m V^2, in theory {theory:.1f} m V^2")

# %%
# The numbers of the page.

assert 11 < result.reduced_loss.max() < 12.5
assert abs(at_95_hz.max() / theory - 1) < 0.02 and abs(amplitude / gap - 0.21) < 0.01
