"""Damping and frequency over amplitude, by phase resonance
========================================================

For test engineers: frequency and damping ratio of a plate with a box of balls over amplitude, as in a test with a
phase-locked loop.

At small amplitudes the bed rests, and its whole mass lowers the frequency. Where it begins to fly the damping is largest,
and above that the frequency returns to that of the structure alone. The same damping follows from cavities that are shaken
at the frequency of the mode, at a fifth of the cost.

:doc:`/how-to/backbone` explains it.
"""

# sphinx_gallery_tags = ["space", "response"]

import numpy as np

import rattlebox as rb

PLATE = rb.Case(
    structure=rb.SDOF(mass="1 kg", frequency="80 Hz", damping_ratio=0.003),
    damper=rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="4 mm", count=40),
        cavity=rb.Box(size=("18 mm", "18 mm", "18 mm")),
        contact=rb.Tsuji(restitution=0.7),
        friction=0.3,
        packing=rb.Settled(seed=1),
        softening=100,
        direction="z",
    ),
    load=rb.Harmonic(amplitude="1 N", frequency="80 Hz"),
    duration="1 s",
)
AMPLITUDES = rb.geomspace("0.02 mm", "1 mm", 7)

if __name__ == "__main__":
    curve = rb.backbone(PLATE, AMPLITUDES, starts=3, cycles=(60, 64))
    rb.plot_backbone(curve).savefig("backbone.png")
    shaken = rb.damping_curve(PLATE, AMPLITUDES, way="shaking", packings=3)
    best = int(np.argmax(curve.damping_ratio.values))
    print(f"largest damping ratio {100 * curve.damping_ratio[best]:.2f} % at {1e3 * curve.amplitude[best]:.2f} mm")
    print(
        f"frequency {curve.frequency[0]:.2f} Hz at {1e3 * curve.amplitude[0]:.2f} mm, {curve.frequency[-1]:.2f} Hz at 1 mm"
    )
    resting = 80 / np.sqrt(1 + PLATE.particle_dampers[0].contents.mass.sum())
    assert abs(curve.frequency[0] / resting - 1) < 1e-3
    assert abs(curve.frequency[-1] / 80 - 1) < 1e-3
    np.testing.assert_allclose(curve.damping_ratio, shaken.damping_ratio, rtol=0.1)
