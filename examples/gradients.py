"""Derivatives through impacts
===========================

For users who ask what a small change of the gap does: RMS displacement over the gap, with its derivatives.

Each tangent is computed from one periodic motion, through its impacts; the RMS displacement of the other gaps follows it.

:doc:`/how-to/gradients` explains it.
"""

# sphinx_gallery_tags = ["lecture", "design"]

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb

case = rb.Case(
    structure=rb.SDOF(mass="1 kg", stiffness="38 kN/m", damping_ratio=0.01),
    damper=rb.ImpactDamper(
        ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    ),
    load=rb.Harmonic(amplitude="5 N", frequency="32 Hz"),
    duration="3 s",
    method=rb.Newton(),
)
gaps = np.linspace(0.7e-3, 1.3e-3, 13)
values, slopes = [], []
for gap in gaps:
    orbit = rb.find_orbit(case.replaced({"damper.gap": float(gap)}), period=1)
    result = rb.gradient(orbit, "rms", "damper.gap")
    values.append(float(result.value))
    slopes.append(float(result.derivative[0]))

if __name__ == "__main__":
    middle = gaps.size // 2
    measured = (values[middle + 1] - values[middle - 1]) / (gaps[middle + 1] - gaps[middle - 1])
    print(f"derivative at 1 mm: {slopes[middle]:.4f}, secant of the neighbours: {measured:.4f}")
    assert abs(slopes[middle] - measured) < 0.01 * abs(measured)
    figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
    axes.plot(1e3 * gaps, 1e3 * np.array(values), "o")
    for gap, value, slope in zip(gaps, values, slopes, strict=True):
        near = np.array([-0.02e-3, 0.02e-3])
        axes.plot(1e3 * (gap + near), 1e3 * (value + slope * near), color="C1")
    axes.set(xlabel="gap [mm]", ylabel="RMS displacement [mm]")
    figure.savefig("gradients.png", dpi=150)
