"""Exact motion with two impacts per cycle."""

from math import pi

import pytest

import rattlebox as rb
from reproduction.harmonic import two_impacts

TABLE = {
    (0.05, 0.25, 30): (13.02694, 0.923),
    (0.05, 0.50, 40): (14.13384, 0.917),
    (0.10, 0.25, 20): (7.11275, 0.858),
    (0.10, 0.50, 20): (7.42018991, 0.903),
    (0.10, 0.75, 20): (7.65608, 0.944),
    (0.10, 0.75, 30): (None, 1.526),
    (0.10, 0.25, 10): (None, 1.791),
}
"""Ball speed and multiplier by mass ratio, restitution and clearance; other parameters 1, damping ratio 1 %."""


@pytest.mark.parametrize("key", TABLE)
def test_speed_and_stability_are_those_of_theory(key):
    """Speeds and multipliers of stable and unstable motions are the published ones."""
    ball, restitution, clearance = key
    speed, multiplier = TABLE[key]
    result = two_impacts(
        mass=1.0,
        stiffness=1.0,
        damping=0.02,
        ball=ball,
        clearance=clearance,
        restitution=restitution,
        amplitude=1.0,
        frequency=0.5 / pi,
    )
    assert len(result) == 1
    assert result[0].multiplier == pytest.approx(multiplier, abs=6e-4)
    if speed is not None:
        assert result[0].ball_speed == pytest.approx(speed, abs=6e-6)


def test_multiplier_of_the_lyapunov_example():
    """The multiplier that the test of examples/lyapunov.py expects is that of the exact motion."""
    ball = rb.Sphere(radius="14 mm", material="steel").weight
    result = two_impacts(
        mass=1.0, stiffness=40e3, damping=4.0, ball=ball, clearance=2e-3, restitution=0.6, amplitude=5.0, frequency=33.0
    )
    assert result[0].multiplier == pytest.approx(0.9349517810953712, rel=1e-12)


def test_weak_load_has_no_such_motion():
    """There is no such motion if the structure moves too little."""
    assert not two_impacts(
        mass=1.0,
        stiffness=1.0,
        damping=0.02,
        ball=0.1,
        clearance=20.0,
        restitution=0.5,
        amplitude=0.01,
        frequency=0.5 / pi,
    )
