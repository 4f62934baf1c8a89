"""For users with a measured contact force: restitution of a steel ball on a rubber pad.

The force of the pad is given as tables over the overlap, one for loading and one for unloading. A warning reports overlaps
beyond the measured range.
"""

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


if __name__ == "__main__":
    for speed in (0.1, 0.2, 0.3, 0.6):
        run = impact(speed)
        hit = run.impacts.isel(impact=0)
        restitution = float(hit.separation_speed / hit.approach_speed)
        print(f"{speed} m/s: overlap {1e6 * float(hit.peak_overlap):.0f} um, restitution {restitution:.3f}")
        for note in run.notes:
            print(f"  {note}")
    # For an impact as deep as the measurement, the areas below both curves give nearly the same restitution.
    loading = np.trapezoid(PAD.force, PAD.overlap)
    unloading = np.trapezoid(PAD.unloading.force, PAD.unloading.overlap)
    by_areas = np.sqrt(unloading / loading)
    print(f"from the areas below the measured points: {by_areas:.3f}")
    assert abs(by_areas - restitution) < 0.02
