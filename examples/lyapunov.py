"""Chaos between windows of order: the growth of small differences in a cycle, over the frequency of the load."""

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
    print(study)
    rb.plot_lyapunov(study).savefig("lyapunov.png")
