"""A ball in a box that turns about any axis, vibrates and falls, against hard impacts computed in the machine frame.

Turning cavities were tested about axes along a coordinate, with one of turning, vibration and gravity at a time, and from
structures at rest, so that a ball in a displaced cavity started with the velocity of the cavity's rest position unseen.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.optimize import brentq

import rattlebox as rb

RADIUS, DENSITY = 1.5e-3, 4500.0
MASS = 4 / 3 * math.pi * RADIUS**3 * DENSITY
HALF = np.array([0.011, 0.009, 0.013])
DURATION = 0.04


class Motion(NamedTuple):
    """A rotation about a random axis, a vibration along a random direction, gravity, and a ball."""

    axis: Any
    arm: Any
    angle: float
    speeds: Any  # at 0 s, 0.02 s and 0.04 s
    swing: float
    direction: Any
    amplitude: float
    frequency: float
    gravity: Any
    position: Any
    velocity: Any
    restitution: float
    carried: bool

    def turned(self, t: float) -> Any:
        """Return the matrix from the cavity to the machine."""
        first, second = np.diff(self.speeds) / 0.02
        early, late = min(t, 0.02), max(t - 0.02, 0.0)
        angle = (
            self.angle
            + self.speeds[0] * early
            + 0.5 * first * early**2
            + self.speeds[1] * late
            + 0.5 * second * late**2
        )
        angle += self.swing * math.sin(2 * math.pi * 31 * t)
        x, y, z = self.axis
        spin = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        return np.eye(3) + math.sin(angle) * spin + (1 - math.cos(angle)) * spin @ spin

    def vibration(self, t: float) -> Any:
        """Return the displacement of the structure."""
        return self.amplitude * math.cos(2 * math.pi * self.frequency * t) * self.direction

    def to_machine(self, place: Any, t: float) -> Any:
        """Return the place in the machine of a point relative to the centre of the cavity."""
        inside, outside = (self.vibration(t), 0.0) if self.carried else (0.0, self.vibration(t))
        return outside + self.turned(t) @ (self.arm + place + inside)

    def to_cavity(self, place: Any, t: float) -> Any:
        """Return the place relative to the centre of the cavity of a point in the machine."""
        inside, outside = (self.vibration(t), 0.0) if self.carried else (0.0, self.vibration(t))
        return self.turned(t).T @ (place - outside) - self.arm - inside

    def carry(self, place: Any, t: float, step: float = 1e-6) -> Any:
        """Return the velocity in the machine of a point that is fixed in the cavity."""
        return (self.to_machine(place, t + step) - self.to_machine(place, t - step)) / (2 * step)


def drawn(seed: int, carried: bool) -> Motion:
    """Return a random motion."""
    random = np.random.default_rng(seed)
    axis, direction = random.normal(size=(2, 3))
    return Motion(
        axis / np.linalg.norm(axis),
        random.normal(size=3) * (0.0, 0.01, 0.2)[seed % 3],
        random.uniform(-3, 3),
        random.normal(0, 40, 3),
        (0.0, 0.1)[seed % 2],
        direction / np.linalg.norm(direction),
        1.2e-3,
        random.uniform(15, 35),
        random.normal(0, 9, 3),
        random.uniform(-0.6, 0.6, 3) * HALF,
        random.normal(0, 0.4, 3),
        random.uniform(0.7, 1),
        carried,
    )


def by_impacts(motion: Motion) -> tuple[Any, Any, int, Any, float]:
    """Return position in the cavity, velocity and number of impacts, impulse on the walls and work of the drive."""
    t, impacts, impulse, work = 0.0, 0, np.zeros(3), 0.0
    place = motion.to_machine(motion.position, 0.0)
    # The ball starts relative to the turning cavity; the structure starts at rest.
    speed = motion.carry(motion.position, 0.0) + motion.turned(0.0) @ motion.velocity

    def gap(at: float, side: int, sign: int) -> float:
        flown = place + speed * (at - t) + 0.5 * motion.gravity * (at - t) ** 2
        return float(HALF[side] - RADIUS - sign * motion.to_cavity(flown, at)[side])

    while True:
        hits = []
        grid = np.linspace(t + 1e-7, DURATION, 400)
        for side in range(3):
            for sign in (-1, 1):
                crossed = [n for n in range(1, 400) if gap(grid[n], side, sign) < 0 <= gap(grid[n - 1], side, sign)][:1]
                hits += [
                    (brentq(gap, grid[n - 1], grid[n], args=(side, sign), xtol=1e-14), side, sign) for n in crossed
                ]
        now, side, sign = min(hits, default=(DURATION, 0, 0))
        place, speed, t = (
            place + speed * (now - t) + 0.5 * motion.gravity * (now - t) ** 2,
            speed + motion.gravity * (now - t),
            now,
        )
        inside, turned = motion.to_cavity(place, t), motion.turned(t)
        if not hits:
            return inside, turned.T @ (speed - motion.carry(inside, t)), impacts, impulse, work
        outward = sign * np.eye(3)[side]
        approach = turned.T @ (speed - motion.carry(inside + RADIUS * outward, t)) @ outward
        push = MASS * (1 + motion.restitution) * approach * outward  # on the wall, along the axes of the cavity
        lever = motion.arm + inside + RADIUS * outward + motion.carried * motion.vibration(t)
        rate = (motion.turned(t + 1e-6) @ turned.T - motion.turned(t - 1e-6) @ turned.T) / 2e-6
        spin = turned.T @ np.array([rate[2, 1], rate[0, 2], rate[1, 0]])
        work -= spin @ np.cross(lever, push)
        speed = speed - turned @ push / MASS
        impacts, impulse = impacts + 1, impulse + push


@pytest.mark.parametrize("carried", [False, True])
@pytest.mark.parametrize("seed", [2, 3, 4, 6, 10, 13])  # one to five impacts, each of which magnifies the error
def test_ball_in_turning_vibrating_box_as_by_hard_impacts(seed: int, carried: bool) -> None:
    """Path, velocity, impulses on walls and work of the drive are those of hard impacts, up to the time of a contact."""
    motion = drawn(seed, carried)
    place, velocity, impacts, impulse, work = by_impacts(motion)
    damper = rb.ParticleDamper(
        particles=rb.Particles(
            material=rb.Material(name="ball", density=DENSITY, young=2e9, poisson=0.3), radius=RADIUS
        ),
        cavity=rb.Box(size=tuple(2 * HALF)),
        contact=rb.Linear(contact_time="5 us", restitution=motion.restitution),
        packing=rb.Positions(positions=[motion.position], velocities=[motion.velocity]),
        gravity=tuple(motion.gravity),
        direction=tuple(motion.direction),
        rotation=rb.Rotation(
            arm=tuple(motion.arm),
            axis=tuple(motion.axis),
            angle=motion.angle,
            times=[0, 0.02, 0.04],
            speeds=motion.speeds.tolist(),
            amplitude=motion.swing,
            frequency=31.0 if motion.swing else None,
            vibration="cavity" if carried else "machine",
        ),
    )
    heavy = rb.SDOF(mass=1e6, frequency=motion.frequency, damping_ratio=0, displacement=motion.amplitude)
    output = rb.Output(rate="2 kHz", walls=True)
    run = rb.simulate(
        rb.Case(structure=heavy, damper=damper, duration=DURATION, output=output, method=rb.Dem(dt=1e-7, threads=1))
    )
    arrays = run.arrays
    assert run.ok and run.counts["first_touches_wall"] == impacts >= 1
    assert np.abs(arrays.particles.position[0] - place).max() < 1e-4
    # Relative to axes that turn about the axis where it is; they do not vibrate.
    t, step = DURATION, 1e-6
    vibrating = (motion.vibration(t + step) - motion.vibration(t - step)) / (2 * step)
    expected = velocity + (vibrating if carried else motion.turned(t).T @ vibrating)
    assert np.abs(arrays.particles.velocity[0] - expected).max() < 0.01
    assert np.allclose(
        arrays.wall_impulse[-1].sum(axis=0), impulse, rtol=0, atol=4e-3 * np.abs(arrays.wall_impulse).max()
    )
    energy = np.abs(run.ledger.particles).max()
    assert arrays.drive_work[-1, 0] == pytest.approx(work, abs=4e-3 * energy)
