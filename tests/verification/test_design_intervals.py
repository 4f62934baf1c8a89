"""Intervals of the objectives of a design hold the mean of many packings as often as they state."""

from typing import Any

import numpy as np
import pytest
from scipy.stats import t

import rattlebox as rb

DRAWS = 200


def ball() -> tuple[rb.Case, dict[str, Any], dict[str, Any]]:
    """Return a ball in free decays, with two gaps."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="10 mm", material="steel", mass=0.08), gap="2 mm", contact=rb.Tsuji(restitution=0.8)
    )
    structure = rb.SDOF(mass="1 kg", frequency="20 Hz", damping_ratio=0.003)
    case = rb.Case(structure=structure, damper=damper, duration="3 s", method=rb.EventDriven())
    return case, {"damper.gap": ["1.5 mm", "2 mm"]}, {"amplitudes": ["3 mm", "4 mm", "5 mm"]}


def bed() -> tuple[rb.Case, dict[str, Any], dict[str, Any]]:
    """Return a thrown bed in steady vibration."""
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="5 mm", count=20),
        cavity=rb.Box(size=("16 mm", "16 mm", "22 mm")),
        contact=rb.Tsuji(restitution=0.6),
        friction=0.3,
        direction="z",
        packing=rb.Settled(seed=1),
        softening=100,
    )
    structure = rb.SDOF(mass="0.05 kg", frequency="100 Hz", damping_ratio=0.02)
    case = rb.Case(structure=structure, damper=damper, duration="0.1 s")
    options = {"amplitudes": ["1 mm", "2 mm"], "way": "shaking", "cycles": (40, 20)}
    return case, {"damper.particles.count": [20]}, options


@pytest.mark.slow
@pytest.mark.parametrize("problem", [ball, bed])
def test_intervals_hold_the_mean_of_many_packings(problem: Any) -> None:
    """Intervals of the worst damping ratio from three or four packings hold that of 120 ones in 90 to 99 % of 200 draws."""
    case, parameters, options = problem()
    many = rb.design(case, parameters, "damping_ratio", packings=120, progress=False, **options)
    rng = np.random.default_rng(1)
    for each in many.damping_ratio_packings.values:
        assert np.isfinite(each).all()
        for count in (3, 4):
            some = np.array([rng.choice(each, count, replace=False) for _ in range(DRAWS)])
            half = t.ppf(0.975, count - 1) * some.std(axis=1, ddof=1) / np.sqrt(count)
            assert 0.9 * DRAWS <= np.count_nonzero(abs(some.mean(axis=1) - each.mean()) < half) <= 0.99 * DRAWS
    few = rb.design(case, parameters, "damping_ratio", packings=4, progress=False, **options)
    scatter = few.damping_ratio_packings.std("packing", ddof=1).values
    np.testing.assert_allclose(few.damping_ratio_interval.values, t.ppf(0.975, 3) * scatter / 2, rtol=1e-9)
