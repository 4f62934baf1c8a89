"""Let a steel ball rebound from a rubber pad whose force was measured while loading and unloading."""

import numpy as np

import rattlebox as rb

PAD = rb.TabulatedNormal(
    overlap=("0 um", "25 um", "50 um", "75 um", "100 um"),
    force=("0 N", "8 N", "24 N", "46 N", "74 N"),
    unloading=rb.Curve(overlap=("40 um", "60 um", "80 um", "100 um"), force=("0 N", "13 N", "38 N", "74 N")),
)


def impact(speed: float) -> rb.Run:
    """Return a run in which the ball flies to the pad once."""
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
    # The areas below straight lines through the points give nearly the same for an impact as deep as the measurement.
    loading = np.trapezoid(PAD.force, PAD.overlap)
    unloading = np.trapezoid(PAD.unloading.force, PAD.unloading.overlap)
    print(f"from the areas below the measured points: {np.sqrt(unloading / loading):.3f}")
