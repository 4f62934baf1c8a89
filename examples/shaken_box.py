"""Loss map of a box of balls
==========================

For users of particle dampers: loss and effective mass of a box of steel balls over amplitude and frequency.

The map of eight amplitudes and seven frequencies takes 40 s of processor time. At 15 m/s^2 the balls are an added mass.

:doc:`/how-to/particle_output` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "map"]

import rattlebox as rb

BOX = rb.Case(
    structure=rb.Shaker(motion=rb.Harmonic(amplitude=(100, "m/s^2"), frequency="50 Hz", direction="z")),
    damper=rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="5 mm", count=100),
        cavity=rb.Box(size=("30 mm", "30 mm", "25 mm")),
        contact=rb.Tsuji(restitution=0.8),
        friction=0.2,
        packing=rb.Settled(seed=1),
        softening="auto",
    ),
    duration="1 s",
)
CYCLES = {"cycles": (10, 20), "samples": 1 + 20 * 200}

if __name__ == "__main__":
    study = rb.loss_map(BOX, rb.geomspace(15, 200, 8), rb.geomspace(20, 160, 7), **CYCLES)
    rb.plot_loss_map(study).savefig("shaken_box.png")
    added = (study.effective_mass / study.particle_mass).values[0]
    print(f"effective mass at 15 m/s^2: {added.min():.2f} to {added.max():.2f} of the mass of the balls")
    assert 0.95 < added.min() <= added.max() < 1.05
