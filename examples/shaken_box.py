"""Shake a box of steel balls at several amplitudes and frequencies, and draw how much it takes up and how heavy it seems."""

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
