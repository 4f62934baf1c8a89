"""First harmonics are exact for harmonic motions: at few samples a cycle, and where cycles begin between two samples."""

from __future__ import annotations

import math

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.analysis import complex_power, shaken_cavity
from rattlebox.analysis.shaken import force_harmonics
from rattlebox.analysis.signals import trapezoid_weights

FREQUENCY = 20.0
SPEED = 0.5 * 9.81 / (2 * math.pi * FREQUENCY)


def resting_ball(rate: float = 400.0) -> rb.Case:
    """Return a ball that rests on the floor of a box shaken with half of gravity."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="4.905 m/s^2", frequency=FREQUENCY, direction="z")),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", radius="5 mm", count=1),
            cavity=rb.Box(size=(0.05, 0.05, 0.05)),
            contact=rb.Tsuji(restitution=0.3),
            packing=rb.Settled(seed=1),
        ),
        duration=0.5,
        output=rb.Output(rate=rate),
    )


def test_weights_integrate_straight_lines_from_between_two_samples() -> None:
    """The trapezoidal rule over uneven samples, from a time between two of them, is exact for a straight line there."""
    time = np.array([0.0, 0.3, 0.5, 1.1, 1.2])
    for begin in (0.0, 0.4, 0.5, 0.7):
        weights = trapezoid_weights(time, begin)
        assert weights.sum() == pytest.approx(1.2 - begin, rel=1e-13)
        assert weights @ (2 + 3 * time) == pytest.approx(2 * (1.2 - begin) + 1.5 * (1.2**2 - begin**2), rel=1e-13)


@pytest.mark.parametrize("samples", [8.0, 8.37, 20.0, 20.7])
def test_a_ball_at_rest_in_its_cavity_has_its_own_mass(samples: float) -> None:
    """The effective mass of a ball that rides along is its mass by both measures, for any number of samples a cycle."""
    run = rb.simulate(resting_ball(rate=samples * FREQUENCY))
    result = shaken_cavity(run, frequency=FREQUENCY, after=0.2)
    mass = run.arrays.particle_mass[0]
    np.testing.assert_allclose(
        result.effective_mass / mass, 1, rtol=4e-5
    )  # the contact gives way by (omega/omega_0)^2 = 2.7e-5
    assert result.attrs["velocity_amplitude"] == pytest.approx(SPEED, rel=1e-9)
    assert abs(float(result.active_power[0])) < 1e-5 * math.pi * FREQUENCY * mass * SPEED**2


@pytest.mark.parametrize(
    "window", [{"cycles": (4, 4), "samples": 33}, {"cycles": (4, 4)}, {"skip": "0.211 s", "samples": 60}]
)
def test_studies_of_particles_give_the_mass_of_a_ball_at_rest(window: dict[str, object]) -> None:
    """Measures of sweeps and maps are those of the exact motion, also where the window begins between samples."""
    result = rb.sweep(
        resting_ball(),
        {"structure.motion.frequency": [FREQUENCY]},
        ["effective_mass", "damping_mass"],
        progress=False,
        **window,
    )
    mass = 7850 * 4 / 3 * math.pi * 0.005**3
    assert result.effective_mass.item() == pytest.approx(mass, rel=4e-5)
    assert abs(result.damping_mass.item()) < 4e-5 * mass


@pytest.mark.parametrize("samples", [8.0, 8.3, 40.5])
def test_complex_power_of_a_mass_and_a_dashpot_is_exact(samples: float) -> None:
    """Power and mass of harmonic signals are exact wherever the cycles begin."""
    frequency, mass, damping, speed = 8.0, 1.2, 5.0, 0.2
    time = np.arange(0, 1.0, 1 / (frequency * samples))
    omega = 2 * np.pi * frequency
    velocity = speed * np.cos(omega * time + 0.7)
    force = 9.81 - mass * omega * speed * np.sin(omega * time + 0.7) + damping * velocity
    result = complex_power(time, force, velocity, frequency=frequency)
    assert float(result.active_power) == pytest.approx(damping * speed**2 / 2, rel=1e-9)
    assert float(result.effective_mass) == pytest.approx(mass, rel=1e-9)


def flying_ball(duration: float, gap: str = "500 mm") -> rb.Case:
    """Return a ball that flies freely in a wide shaken cavity."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz", phase="25 deg")),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="10 mm", material="steel"), gap=gap, velocity=0.1, contact=rb.Tsuji(restitution=0.6)
        ),
        duration=duration,
        method=rb.Newton(),
    )


@pytest.mark.parametrize("duration", [1.0, 0.93, 0.37])
def test_a_ball_in_free_flight_has_no_effective_mass(duration: float) -> None:
    """A ball that no wall pushes has no apparent mass, also where the window holds no whole number of cycles."""
    result = rb.sweep(
        flying_ball(duration),
        {"damper.velocity": [0.1]},
        ["effective_mass", "damping_mass"],
        skip=0.05,
        samples=201,
        progress=False,
    )
    mass = 7850 * 4 / 3 * math.pi * 0.01**3
    # The quadrature is of fourth order: 21 samples a cycle, and a flight over ten amplitudes.
    assert abs(result.effective_mass.item()) < 1e-4 * mass
    assert abs(result.damping_mass.item()) < 1e-4 * mass


@pytest.mark.parametrize("duration", [2.0, 1.93])
def test_reduced_loss_refers_to_the_speed_of_the_cavity(duration: float) -> None:
    """Loss a cycle over m V^2 has the exact V of the shaker, also where the window holds no whole number of cycles."""
    case = flying_ball(duration, gap="1 mm")
    result = rb.sweep(
        case, {"damper.velocity": [0.1]}, ["reduced_loss", "loss_per_cycle"], skip=0.55, samples=301, progress=False
    )
    mass = 7850 * 4 / 3 * math.pi * 0.01**3
    assert result.loss_per_cycle.item() > 0
    exact = result.loss_per_cycle.item() / (mass * (2 * math.pi * 10 * 1e-3) ** 2)
    assert result.reduced_loss.item() == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("samples", [40, 64])
def test_harmonics_of_a_force_and_their_variation_are_exact(samples: int) -> None:
    """The second and third harmonic have their amplitudes, and the first one the deviation of its cycles from their mean."""
    firsts = np.array([3.0, 5.0, 4.0, 8.0])  # amplitude of the first harmonic in each cycle [N]
    times = np.linspace(0, firsts.size / FREQUENCY, firsts.size * samples + 1)
    omega, cycle = 2 * math.pi * FREQUENCY, np.minimum((times * FREQUENCY + 1e-9).astype(int), firsts.size - 1)
    momentum = (firsts[cycle] * np.sin(omega * times) + 0.7 / 2 * np.sin(2 * omega * times)) / omega
    momentum += 0.2 / 3 * np.cos(3 * omega * times) / omega
    harmonics, variation = force_harmonics(times, momentum, FREQUENCY, 4)
    assert harmonics[:2] == pytest.approx([0.7, 0.2], abs=1e-9)
    assert variation == pytest.approx(firsts.std(), rel=1e-9)
