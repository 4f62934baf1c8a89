"""Chaos or periodic motion
========================

For users who must know whether a motion is chaotic: Lyapunov exponent over the frequency of the load.

The growth of small differences per cycle is positive at 30.8 Hz (chaos) and negative at 33 Hz (a periodic motion).

:doc:`/how-to/lyapunov` explains it.
"""

# sphinx_gallery_tags = ["lecture", "sweep"]

import rattlebox as rb

case = rb.Case(
    structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
    damper=rb.ImpactDamper(
        ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    ),
    load=rb.Harmonic(amplitude="5 N", frequency="31 Hz"),
    duration="1 s",
    method=rb.Newton(),
)
study = rb.lyapunov(case, {"load.frequency": rb.linspace("30.8 Hz", "33 Hz", 12)}, cycles=(200, 200), pairs=4)

if __name__ == "__main__":
    first, last = study.growth_per_cycle.values[[0, -1]]
    print(f"growth per cycle: {first:.2f} at 30.8 Hz, {last:.2f} at 33 Hz")
    assert first > 0.5 and abs(last + 0.1345) < 1e-3
    rb.plot_lyapunov(study).savefig("lyapunov.png")
