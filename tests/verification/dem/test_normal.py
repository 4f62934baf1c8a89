"""Head-on impacts in the 3-D engine: restitution and its order of convergence."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from support import dem_cases
from support.dem_cases import Ball
from support.exact import restitution_laws

import rattlebox as rb

# Largest error of the restitution, over that power of the step in parts of an elastic contact: what was measured, a quarter
# above the worst of eight phases of the first touch and all e, with steps from 1/20 to 1/320. Forces that pull until the
# overlap is zero end in the midst of a step, that of a Hertz contact like the fourth root of time (order 5/4), a linear
# one's with a jump (order 1). Without dashpots forces begin and end like d^(3/2) or d.
ERRORS = {
    ("hertz", "zero_force"): (2.4, 2.0),
    ("hertz", "zero_overlap"): (0.38, 1.25),
    ("linear", "zero_force"): (2.9, 2.0),
    ("linear", "zero_overlap"): (0.5, 1.0),
}
ELASTIC = {"hertz": 2.5, "linear": 3.0}
PHASES = (0.02, 0.3, 0.55, 0.8)
SMALL, LARGE = Ball(1e-3), Ball(15e-3)
LEAD, GLASS = Ball(6e-3, material="lead"), Ball(4e-3, material="glass")
PAIRS: dict[str, tuple[Ball, Ball | None]] = {
    "wall": (SMALL, None),
    "large ball and wall": (LARGE, None),
    "equal": (SMALL, SMALL),
    "large and small": (LARGE, SMALL),
    "lead and glass": (LEAD, GLASS),
}


def hertz(e: float, ending: str, *_: Any) -> Any:
    """Return a Hertz contact."""
    return rb.Tsuji(restitution=e, ending=ending)


def linear(e: float, ending: str, time: float, mass: float) -> Any:
    """Return a linear contact of the same duration."""
    return rb.Linear(stiffness=mass * (math.pi / time) ** 2, restitution=e, ending=ending)


def worst(
    make: Callable[..., Any], e: float, ending: str, pair: tuple[Ball, Ball | None], speed: float, per_contact: int
) -> float:
    """Return the largest error of the restitution over several times of first touch within a step."""
    first, second = pair
    time = dem_cases.contact_time(first, second, speed)
    mass = first.mass if second is None else dem_cases.reduced(first.mass, second.mass)
    errors = []
    for phase in PHASES:
        case = dem_cases.head_on(
            first,
            second,
            speed,
            dt=time / per_contact,
            phase=phase,
            lasts=4 * time,
            contact=make(e, ending, time, mass),
        )
        errors.append(dem_cases.rebound(dem_cases.run(case, closes=False)) / speed - e)
    return float(np.abs(errors).max())


@pytest.mark.parametrize("ending", ["zero_force", "zero_overlap"])
@pytest.mark.parametrize("e", [0.1, 0.25, 0.5, 0.75, 0.9, 1.0])
def test_prescribed_restitution(e: float, ending: str) -> None:
    """The restitution of steel and glass, small and large, slow and fast balls is the prescribed one within the order."""
    for number, pair in enumerate(PAIRS.values()):
        speed = (0.01, 0.2, 5.0)[number % 3]
        for make, per_contact in ((hertz, 40), (hertz, 160), (linear, 80)):
            factor, order = ERRORS[make.__name__, ending]
            assert worst(make, e, ending, pair, speed, per_contact) < factor * per_contact**-order


@pytest.mark.parametrize("ending", ["zero_force", "zero_overlap"])
@pytest.mark.parametrize("make", [hertz, linear])
def test_restitution_converges_at_the_stated_order(make: Callable[..., Any], ending: str) -> None:
    """With sixteen times shorter steps the largest error decreases at the stated order; at 5/2 or 3 without loss."""
    for e, order in ((0.5, ERRORS[make.__name__, ending][1]), (1.0, ELASTIC[make.__name__])):
        coarse, fine = (worst(make, e, ending, PAIRS["wall"], 1.0, n) for n in (40, 640))
        assert math.log2(coarse / fine) / 4 == pytest.approx(order, abs=0.25)


@pytest.mark.parametrize("share", [0.2, 1.0, 5.0])
@pytest.mark.parametrize("e", [0.3, 0.9])
def test_wall_counts_with_the_mass_behind_it(e: float, share: float) -> None:
    """At a free cavity of a fifth to five times the mass of the ball the effective mass includes the structure."""
    ball, speed, per_contact = Ball(5e-3), 1.0, 160
    together = ball.mass * share / (1 + share)
    time = dem_cases.HERTZ_TIME * (together / dem_cases.stiffness(ball)) ** 0.4 * speed**-0.2
    for contact in (hertz(e, "zero_force"), linear(e, "zero_force", time, together)):
        case = dem_cases.head_on(
            ball,
            None,
            speed,
            dt=time / per_contact,
            phase=0.6,
            lasts=4 * time,
            contact=contact,
            structure=rb.SDOF(mass=share * ball.mass, stiffness=0),
        )
        arrays = dem_cases.run(case).arrays
        after = arrays.velocity[-1, 0] - arrays.particles.velocity[0, 0]
        assert after == pytest.approx(e * speed, abs=2.9 / per_contact**2)
        assert ball.mass * (arrays.particles.velocity[0, 0] + share * arrays.velocity[-1, 0]) == pytest.approx(
            ball.mass * speed, rel=1e-12
        )


STEEL = rb.materials()["steel"]


def modulus(wall: bool) -> float:
    """Return E* of steel on steel, or on a rigid wall [Pa]."""
    return STEEL.young / (1 - STEEL.poisson**2) / (1 if wall else 2)


def jackson_green(radius: float, mass: float, speed: float, wall: bool) -> float:
    """Return the exact restitution after Jackson and Green."""
    scale = restitution_laws.jackson_green_speed(radius, mass, modulus(wall), STEEL.yield_stress, STEEL.poisson)
    return restitution_laws.jackson_green(speed / scale, STEEL.yield_stress / STEEL.young)


def thornton(radius: float, mass: float, speed: float, wall: bool) -> float:
    """Return the exact restitution after Thornton."""
    scale = restitution_laws.thornton_speed(radius, mass, modulus(wall), 1.6 * STEEL.yield_stress)
    return restitution_laws.thornton(speed / scale)


def johnson(radius: float, mass: float, speed: float, wall: bool) -> float:
    """Return the exact restitution after Johnson."""
    strength = STEEL.yield_stress
    scale = 3.8**4 * (strength / modulus(wall)) ** 2 * math.sqrt(2 * strength * radius**3 / mass)
    return min(1.0, (speed / scale) ** -0.25)


def table(radius: float, mass: float, speed: float, wall: bool) -> float:
    """Return the restitution of a table of speeds."""
    return float(np.interp(speed, [0.1, 1.0, 10.0], [0.95, 0.8, 0.3]))


LAWS: dict[str, tuple[Any, Callable[..., float]]] = {
    "Jackson-Green": (rb.JacksonGreen(), jackson_green),
    "Thornton": (rb.ThorntonRestitution(), thornton),
    "Johnson": (rb.Johnson(), johnson),
    "table": (rb.Tabulated(speeds=[0.1, 1.0, 10.0], values=[0.95, 0.8, 0.3]), table),
}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("speed", [0.05, 0.5, 8.0])
@pytest.mark.parametrize("ending", ["zero_force", "zero_overlap"])
def test_laws_of_restitution_use_the_sizes_of_the_pair(law: str, speed: float, ending: str) -> None:
    """In one species of many sizes each pair has the restitution of its own radii and masses, at its own speed."""
    contact = rb.Tsuji(restitution=LAWS[law][0], ending=ending)
    factor, order = ERRORS["hertz", ending]
    small, large = Ball(2e-3), Ball(9e-3)
    for first, second in ((small, large), (small, small), (large, large), (small, None), (large, None)):
        mass = first.mass if second is None else dem_cases.reduced(first.mass, second.mass)
        radius = first.radius if second is None else dem_cases.reduced(first.radius, second.radius)
        exact = LAWS[law][1](radius, mass, speed, second is None)
        time = dem_cases.contact_time(first, second, speed, "rigid")
        case = dem_cases.head_on(
            first, second, speed, dt=time / 80, phase=0.5, lasts=4 * time, contact=contact, wall="rigid"
        )
        assert dem_cases.rebound(dem_cases.run(case)) / speed == pytest.approx(exact, abs=factor * 80**-order)
        # The same pair with another ball of another size, which changes only the reference pair.
        many = with_bystander(case, 0.5 * small.radius)
        assert dem_cases.rebound(dem_cases.run(many)) == pytest.approx(dem_cases.rebound(dem_cases.run(case)), rel=1e-9)


def with_bystander(case: Any, radius: float) -> Any:
    """Return the case with its balls as one species, and one more of another size in a corner."""
    given = case.dampers[0]
    packing = given.packing
    corner = tuple(0.5 * length - 1.5 * radius for length in given.cavity.size)
    radii = [*(species.radius for species in given.particles), radius]
    positions = rb.Positions(
        positions=[*packing.positions, corner], velocities=[*packing.velocities, (0, 0, 0)], radii=radii
    )
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel"),
        cavity=given.cavity,
        wall=given.wall,
        contact=given.contact,
        gravity=(0, 0, 0),
        packing=positions,
    )
    return rb.Case(
        structure=case.structure, damper=damper, duration=case.duration, output=case.output, method=case.method
    )
