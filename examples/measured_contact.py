"""Contact with a measured force
=============================

For users with a measured contact force: restitution of a steel ball on a rubber pad.

The force of the pad is given as tables over the overlap, one for loading and one for unloading. A warning reports overlaps
beyond the measured range.

:doc:`/theory/laws` explains it.
"""

# sphinx_gallery_tags = ["machine tool", "inputs"]

import matplotlib.pyplot as plt
import numpy as np

import rattlebox as rb

PAD = rb.TabulatedNormal(
    overlap=("0 um", "25 um", "50 um", "75 um", "100 um"),
    force=("0 N", "8 N", "24 N", "46 N", "74 N"),
    unloading=rb.Curve(overlap=("40 um", "60 um", "80 um", "100 um"), force=("0 N", "13 N", "38 N", "74 N")),
)


def impact(speed: float) -> rb.Run:
    """Return a run in which the ball hits the pad once, at this speed [m/s]."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="10 mm", material="steel"), gap="1 mm", velocity=speed, contact=PAD, wall="rigid"
    )
    return rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, duration=2.5e-3 / speed))


@rb.plots.figure_style("page")
def main():
    """Compute the numbers, check them and draw the figure."""
    for speed in (0.1, 0.2, 0.3, 0.6):
        run = impact(speed)
        hit = run.impacts.isel(impact=0)
        restitution = float(hit.separation_speed / hit.approach_speed)
        print(f"{speed} m/s: overlap {1e6 * float(hit.peak_overlap):.0f} um, restitution {restitution:.3f}")
        for note in run.notes:
            print(f"  {note}")
    figure, panels = plt.subplots(1, 2, figsize=(7, 3), layout="constrained")
    for curve, style, name in ((PAD, "o-", "loading"), (PAD.unloading, "s--", "unloading")):
        panels[0].plot(1e6 * np.array(curve.overlap), curve.force, style, label=name)
    panels[0].set(xlabel="Overlap (µm)", ylabel="Force (N)")
    panels[0].margins(0.03)
    panels[0].legend()
    speeds = np.linspace(0.05, 0.6, 23)
    hits = [impact(float(speed)).impacts.isel(impact=0) for speed in speeds]
    panels[1].plot(speeds, [float(hit.separation_speed / hit.approach_speed) for hit in hits], "k")
    beyond = [speed for speed, hit in zip(speeds, hits, strict=True) if hit.peak_overlap > PAD.overlap[-1]]
    panels[1].axvspan(beyond[0], speeds[-1], color="0.9", label="beyond the measurement")
    panels[1].set(xlabel="Approach speed (m/s)", ylabel="Restitution", xlim=(0, speeds[-1]), ylim=(0, 1))
    panels[1].legend(loc="lower right")
    figure.savefig("measured_contact.png", dpi=200)
    # For an impact as deep as the measurement, the areas below both curves give nearly the same restitution.
    loading = np.trapezoid(PAD.force, PAD.overlap)
    unloading = np.trapezoid(PAD.unloading.force, PAD.unloading.overlap)
    by_areas = np.sqrt(unloading / loading)
    print(f"from the areas below the measured points: {by_areas:.3f}")
    assert abs(by_areas - restitution) < 0.02


if __name__ == "__main__":
    main()
