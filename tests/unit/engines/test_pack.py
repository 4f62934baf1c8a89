"""Hard impacts take the restitution that the contact law amounts to."""

import numpy as np
import pytest

import rattlebox as rb


def rebound(contact: object) -> float:
    """Return the restitution of the first hard impact of a ball thrown at a fixed wall at 0.5 m/s."""
    case = rb.Case(
        structure=rb.Fixed(),
        damper=rb.ImpactDamper(ball=rb.Sphere(radius=0.01, material="steel"), gap=1e-3, velocity=0.5, contact=contact),
        duration=3e-3,
        method=rb.Newton(),
    )
    impacts = rb.simulate(case).arrays.impacts
    return float(impacts.separation_speed[0] / impacts.approach_speed[0])


@pytest.mark.parametrize("ending", ["zero_force", "zero_overlap"])
def test_alpha_becomes_its_restitution(ending: str) -> None:
    """A fixed alpha rebounds as hard impact with the restitution of the soft contact."""
    expected = float(rb.restitution_of_alpha(0.5, ending))
    assert rebound(rb.Tsuji(alpha=0.5, ending=ending)) == pytest.approx(expected, rel=1e-14)


def test_dashpot_becomes_its_restitution() -> None:
    """A fixed linear dashpot rebounds as hard impact with the restitution of the soft contact."""
    mass = rb.Sphere(radius=0.01, material="steel").weight
    damping = 2 * 0.3 * np.sqrt(1e6 * mass)
    assert rebound(rb.Linear(stiffness=1e6, damping=damping)) == pytest.approx(0.4509755, abs=1e-7)


def test_yielding_becomes_its_restitution() -> None:
    """A hysteretic contact rebounds as hard impact with the closed form of its restitution."""
    assert 0.2 < rebound(rb.Thornton()) < 0.9
