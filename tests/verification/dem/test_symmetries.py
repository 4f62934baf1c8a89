"""Invariance under rotations, reflections, order of the particles and units."""

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support import dem_cases
from support.dem_cases import Ball

import rattlebox as rb

from .test_conservation import LAWS

SOFT = rb.Material(name="soft", density=2500, young=5e7, poisson=0.25, yield_stress=5e6)
OTHER = rb.Material(name="other", density=4000, young=9e7, poisson=0.3, yield_stress=8e6)
GRAVITY = np.array([3.0, -2.0, -9.0])
BOX = np.array([0.04, 0.03, 0.05])
DT = 4e-6


def balls(count: int = 60) -> list[Ball]:
    """Return moving, spinning spheres of two materials and many sizes."""
    rng = np.random.default_rng(5)
    radii = rng.uniform(1e-3, 2.5e-3, count)
    places = rb.Lattice(noise=1.0, seed=2).place(rb.SphericalCavity(diameter=0.03), radii)
    return [
        Ball(r, x, v, w, (SOFT, OTHER)[k % 2])
        for k, (r, x, v, w) in enumerate(
            zip(radii, places, rng.standard_normal((count, 3)), 300 * rng.standard_normal((count, 3)), strict=True)
        )
    ]


def run_spheres(
    group: list[Ball], law: str, cavity: Any, gravity: Any = GRAVITY, structure: Any = None, steps: int = 3000
) -> Any:
    """Return the run of two species of spheres in a cavity that is shaken or free."""
    kinds = [[ball for ball in group if ball.material is material] for material in (SOFT, OTHER)]
    ordered = [ball for kind in kinds for ball in kind]
    start = rb.Positions(
        positions=[ball.position for ball in ordered],
        radii=[ball.radius for ball in ordered],
        velocities=[ball.velocity for ball in ordered],
        spins=[ball.spin for ball in ordered],
    )
    particles = [
        rb.Particles(name=material.name, material=material, count=len(kind))
        for material, kind in zip((SOFT, OTHER), kinds, strict=True)
    ]
    damper = rb.ParticleDamper(particles=particles, cavity=cavity, packing=start, gravity=tuple(gravity), **LAWS[law])
    case = rb.Case(
        structure=structure or rb.Fixed(),
        damper=damper,
        duration=steps * DT,
        output=rb.Output(times=[steps * DT]),
        method=rb.Dem(dt=DT * (1 + 1e-9)),
    )
    return dem_cases.run(case)


def shaking(turn: Any) -> Any:
    """Return a light cavity on springs in three directions, rotated, which the particles move."""
    return rb.Modal(
        frequencies=[30.0, 40.0, 50.0],
        damping_ratios=[0.01, 0.02, 0.03],
        shapes={"cavity": [list(row) for row in 3.0 * turn]},
        velocity=[0.2, -0.1, 0.1],
    )


def turned(group: list[Ball], turn: Any) -> list[Ball]:
    """Return the spheres rotated, or mirrored with reversed spins."""
    sign = np.linalg.det(turn)
    return [Ball(b.radius, turn @ b.position, turn @ b.velocity, sign * (turn @ b.spin), b.material) for b in group]


def compare(one: Any, other: Any, turn: Any, rtol: float) -> None:
    """Assert that the end of the second run is that of the first one, rotated or mirrored."""
    sign = np.linalg.det(turn)
    for name, factor in (("position", 1.0), ("velocity", 1.0), ("spin", sign)):
        a, b = getattr(one.arrays.particles, name) @ turn.T * factor, getattr(other.arrays.particles, name)
        assert np.abs(a - b).max() < rtol * np.abs(a).max(), name
    a, b = one.arrays.cavity_velocity[-1] @ turn.T, other.arrays.cavity_velocity[-1]
    assert np.abs(a - b).max() <= rtol * np.abs(a).max()
    for name in ("kinetic_energy", "normal_loss", "plastic_loss", "sliding_loss", "rolling_loss"):
        a, b = getattr(one.arrays, name)[-1], getattr(other.arrays, name)[-1]
        assert np.abs(a - b).max() <= rtol * one.arrays.kinetic_energy[0].sum(), name
    assert one.counts["first_touches_particle"] == other.counts["first_touches_particle"] > 50
    assert one.counts["first_touches_wall"] == other.counts["first_touches_wall"] > 20


QUARTERS = {
    "about x": np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float),
    "round": np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], float),
    "mirror in x": np.diag([-1.0, 1, 1]),
    "mirror and quarter": np.array([[0, 1, 0], [1, 0, 0], [0, 0, 1]], float),
}

# The order of sums differs and the motion is chaotic: rounding grows about tenfold with each collision of a particle,
# and each has some four of them.
CHAOS = 1e-8


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", QUARTERS)
def test_quarter_turns_and_mirrors(name: str, law: str) -> None:
    """A box and its contents, rotated by 90 degrees or mirrored, have the rotated or mirrored result."""
    turn = QUARTERS[name]
    one = run_spheres(balls(), law, rb.Box(size=BOX), structure=shaking(np.eye(3)))
    size = np.abs(turn @ BOX)
    other = run_spheres(turned(balls(), turn), law, rb.Box(size=size), turn @ GRAVITY, shaking(turn.T))
    compare(one, other, turn, CHAOS)


ASKEW = Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", ["sphere", "can"])
def test_any_turn(name: str, law: str) -> None:
    """A sphere or cylinder and its contents in any orientation have the rotated result."""

    def cavity(turn: Any) -> Any:
        if name == "sphere":
            return rb.SphericalCavity(diameter=0.04)
        return rb.Cylinder(diameter=0.035, length=0.04, axis=tuple(turn @ [0, 0, 1.0]))

    one = run_spheres(balls(), law, cavity(np.eye(3)), structure=shaking(np.eye(3)))
    other = run_spheres(turned(balls(), ASKEW), law, cavity(ASKEW), ASKEW @ GRAVITY, shaking(ASKEW.T))
    compare(one, other, ASKEW, CHAOS)


@pytest.mark.parametrize("law", LAWS)
def test_order_of_the_particles(law: str) -> None:
    """The order of the particles does not change their motion."""
    group = balls()
    order = np.random.default_rng(8).permutation(len(group) // 2)
    mixed = [group[2 * k] for k in order] + [group[2 * k + 1] for k in order]
    plain = [group[2 * k] for k in range(len(order))] + [group[2 * k + 1] for k in range(len(order))]
    one, other = (run_spheres(g, law, rb.Box(size=BOX), structure=shaking(np.eye(3))) for g in (plain, mixed))
    places = np.concatenate([order, len(order) + order])
    assert np.array_equal(one.arrays.particles.radius[places], other.arrays.particles.radius)
    for name in ("position", "velocity", "spin"):
        a, b = getattr(one.arrays.particles, name)[places], getattr(other.arrays.particles, name)
        assert np.abs(a - b).max() < CHAOS * np.abs(a).max(), name
    assert one.counts["first_touches_particle"] == other.counts["first_touches_particle"]


@pytest.mark.parametrize("exact", [True, False], ids=["powers of two", "any factor"])
@pytest.mark.parametrize("law", LAWS)
def test_other_units_give_the_same_run(law: str, exact: bool) -> None:
    """Length, mass and time in other units give the same run: no dimensional constant is hidden."""
    length, mass, time = (2.0**3, 2.0**-5, 2.0**2) if exact else (3.7, 0.21, 1.9)
    speed, density, pressure = length / time, mass / length**3, mass / length / time**2

    def stuff(material: Any) -> Any:
        return rb.Material(
            name=material.name,
            density=material.density * density,
            young=material.young * pressure,
            poisson=material.poisson,
            yield_stress=material.yield_stress * pressure,
        )

    def run(length: float, time: float, speed: float, mass: float, materials: dict[str, Any]) -> Any:
        group = balls()
        options = dict(LAWS[law])
        if law == "linear":
            contact = rb.Linear(contact_time=2e-4 * time, restitution=0.8, ending="zero_overlap")
            options["contact"] = contact
        kinds = [group[::2], group[1::2]]
        ordered = [ball for kind in kinds for ball in kind]
        start = rb.Positions(
            positions=[length * np.array(b.position) for b in ordered],
            radii=[length * b.radius for b in ordered],
            velocities=[speed * np.array(b.velocity) for b in ordered],
            spins=[np.array(b.spin) / time for b in ordered],
        )
        particles = [
            rb.Particles(name=name, material=material, count=len(kind))
            for (name, material), kind in zip(materials.items(), kinds, strict=True)
        ]
        cavity = rb.Box(size=length * BOX)
        gravity = tuple(GRAVITY * speed / time)
        damper = rb.ParticleDamper(particles=particles, cavity=cavity, packing=start, gravity=gravity, **options)
        dt, steps = DT * time, 2000
        return dem_cases.run(
            rb.Case(
                structure=rb.SDOF(mass=0.1 * mass, stiffness=4e3 * mass / time**2, damping=0.3 * mass / time),
                damper=damper,
                duration=steps * dt,
                output=rb.Output(times=[steps * dt]),
                method=rb.Dem(dt=dt * (1 + 1e-9)),
            )
        )

    one = run(1.0, 1.0, 1.0, 1.0, {"soft": SOFT, "other": OTHER})
    other = run(length, time, speed, mass, {"soft": stuff(SOFT), "other": stuff(OTHER)})
    for name, unit in (("position", length), ("velocity", speed), ("spin", 1 / time)):
        a, b = getattr(one.arrays.particles, name), getattr(other.arrays.particles, name) / unit
        assert np.abs(a - b).max() < CHAOS * np.abs(a).max(), name
    a, b = one.arrays, other.arrays
    lost = b.sliding_loss[-1].sum() + b.normal_loss[-1].sum() + b.plastic_loss[-1].sum()
    expected = a.sliding_loss[-1].sum() + a.normal_loss[-1].sum() + a.plastic_loss[-1].sum()
    assert lost / (mass * speed**2) == pytest.approx(expected, rel=1e-6)
    assert one.counts["first_touches_particle"] == other.counts["first_touches_particle"] > 40
