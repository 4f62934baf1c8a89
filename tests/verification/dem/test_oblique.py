"""Oblique impacts and impacts of spinning balls: friction against closed forms and an accurate integration."""

import dataclasses
import itertools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support import dem_cases
from support.dem_cases import Ball
from support.exact import oblique, printed
from support.known_particles import ALUMINA, OBLIQUE_E, OBLIQUE_FRICTION, OBLIQUE_SPEED, oblique_impact, oblique_law

import rattlebox as rb
from rattlebox import alpha_of_restitution

VERIFICATION = Path(__file__).parents[3] / "docs" / "validation" / "verification.md"

BALL, SPEED, FRICTION, E = ALUMINA, OBLIQUE_SPEED, OBLIQUE_FRICTION, OBLIQUE_E
RADIUS = BALL.radius


def impact(angle: float, *, per_contact: int = 200, **options: Any) -> tuple[float, float, float, Any]:
    """Return tangential and normal velocity, spin, and the run, of a sphere that hits the floor."""
    return oblique_impact(angle, per_contact, **options)


@pytest.mark.parametrize("damping", [0.0, 1.0])
@pytest.mark.parametrize("e", [0.5, 0.98])
@pytest.mark.parametrize("degrees", [2, 5, 10, 15, 20, 25, 30, 40, 60, 80])
def test_oblique_impacts_follow_the_law(degrees: float, e: float, damping: float) -> None:
    """Velocities and spin agree with an accurate integration of Mindlin's law with history at every angle."""
    angle = math.radians(degrees)
    friction = rb.Mindlin(FRICTION, damping=damping)
    along, up, spin, _ = impact(angle, contact=rb.Tsuji(restitution=e), friction=friction)
    expected = oblique_law(angle, e, damping)
    # Measured: 4.4e-5 of the speed with 200 steps at e 0.5, about a quarter of it with 400.
    assert (along, up) == pytest.approx(expected[:2], abs=6e-5 * SPEED)
    assert spin == pytest.approx(expected[2], abs=2.5 * 6e-5 * SPEED / RADIUS)


@pytest.mark.parametrize("e", [0.5, 0.98])
@pytest.mark.parametrize("degrees", [5, 10, 20, 30, 60])
def test_oblique_impacts_of_unlike_balls_follow_the_law(degrees: float, e: float) -> None:
    """Oblique impacts of balls of two sizes and materials agree with an accurate integration."""
    first, second = Ball(2e-3, material="steel"), Ball(5e-3, material="glass")
    speed, angle, both = 1.0, math.radians(degrees), first.radius + second.radius
    down, per_contact = speed * math.cos(angle), 200
    dt = dem_cases.contact_time(first, second, down) / per_contact
    apart = both + 5.5 * dt * down
    along = -speed * math.sin(angle)
    balls = [
        dataclasses.replace(first, velocity=(0.7 * down, 0.7 * along, 0)),
        dataclasses.replace(second, position=(apart, 0, 0), velocity=(-0.3 * down, -0.3 * along, 0)),
    ]
    friction = 0.3
    case = dem_cases.case(
        balls,
        dt=dt,
        steps=4 * per_contact,
        cavity=rb.Box(size=(0.1,) * 3),
        contact=rb.Tsuji(restitution=e),
        friction=friction,
    )
    arrays = dem_cases.run(case).arrays
    mass = dem_cases.reduced(first.mass, second.mass)
    shear = 1 / sum((2 - m.poisson) * 2 * (1 + m.poisson) / m.young for m in (first.stuff, second.stuff))
    stiffness = dem_cases.stiffness(first, second)
    law = oblique.Impact(  # of the relative motion; the unit of length is the distance of the centres at first touch
        alpha=float(alpha_of_restitution(e)),
        ratio=8 * shear * math.sqrt(dem_cases.reduced(first.radius, second.radius)) / stiffness,
        friction=friction,
        damping=1.0,
        stiffness=stiffness * both**2.5 / (mass * down**2),
    )
    slip, spin, up = law.follow(math.tan(angle))
    relative = arrays.particles.velocity[0] - arrays.particles.velocity[1]
    turned = first.radius * arrays.particles.spin[0, 2] + second.radius * arrays.particles.spin[1, 2]
    # The normal rotates during the contact by about 1e-3.
    assert relative == pytest.approx((-up * down, -slip * down, 0), abs=3e-3)
    assert turned == pytest.approx(-spin * down, abs=3e-3)


def test_friction_converges_at_second_order() -> None:
    """At 20 degrees, where the contact alternates between sticking and sliding, the error is of second order."""
    angle = math.radians(20)
    exact = 2 * oblique_law(angle, E, 1.0)[0] - impact(angle, per_contact=6400)[0]
    assert exact == pytest.approx(oblique_law(angle, E, 1.0)[0], rel=1e-6)
    errors = [abs(impact(angle, per_contact=n)[0] - exact) for n in (50, 400)]
    assert math.log2(errors[0] / errors[1]) / 3 == pytest.approx(2, abs=0.3)


@pytest.mark.parametrize("degrees", [40, 50, 60, 70, 80, 85])
@pytest.mark.parametrize("e", [0.3, 0.98])
def test_gross_sliding_has_the_closed_form(degrees: float, e: float) -> None:
    """At large angles the tangential impulse is mu times the normal one, and it determines the spin."""
    angle = math.radians(degrees)
    along, up, spin, result = impact(angle, contact=rb.Tsuji(restitution=e))
    before = SPEED * math.sin(angle), SPEED * math.cos(angle)
    assert along == pytest.approx(before[0] - FRICTION * (before[1] + up), rel=1e-12)
    # The lever is shorter than the radius by the overlap.
    turned = 2.5 * (before[0] - along) / RADIUS
    assert turned * (1 - result.diagnostics["largest_overlap"]) < spin < turned
    tangential, rolled = oblique.sliding(angle, e, FRICTION)
    assert along / before[0] == pytest.approx(tangential, abs=2e-4)
    assert spin * RADIUS / before[1] == pytest.approx(rolled, rel=6e-3)


@pytest.mark.parametrize("degrees", [degrees for degrees in printed.OBLIQUE if degrees >= 30])
def test_sliding_impacts_are_the_printed_ones(degrees: int) -> None:
    """Test 4 of Chung and Ooi from 30 degrees on, where contacts slide: as printed, to what can be read off a figure."""
    along, _, spin, _ = impact(math.radians(degrees))
    shown, turning = printed.OBLIQUE[degrees]
    assert along / (SPEED * math.sin(math.radians(degrees))) == pytest.approx(shown, abs=READ)
    assert spin == pytest.approx(turning, abs=SPIN_READ)


READ, SPIN_READ, ANGLE_READ = 0.003, 4.0, 0.2
"""Reading accuracy of a figure: restitution, spin [rad/s], angles [degrees]. In gross sliding: 0.002 and 3.5."""


def is_printed(degrees: int, damping: float, keeps: str) -> bool:
    """Return whether a tangential spring gives the printed values within the reading accuracy."""
    shown, turning = printed.OBLIQUE[degrees]
    near = np.radians(degrees + np.linspace(-ANGLE_READ, ANGLE_READ, 5))
    laws = [(angle, *oblique_law(angle, E, damping, 4000, keeps)) for angle in near]
    e = [along / (SPEED * math.sin(angle)) for angle, along, _, _ in laws]
    spins = [spin for *_, spin in laws]
    fits = min(e) - READ < shown < max(e) + READ
    return fits and min(spins) - SPIN_READ < turning < max(spins) + SPIN_READ


def test_the_printed_springs_have_constant_displacement() -> None:
    """Test 4 of Chung and Ooi below 30 degrees: of six springs only the undamped one with constant displacement agrees."""
    sticking = [degrees for degrees in printed.OBLIQUE if degrees < 30]
    springs = itertools.product(("eased", "force", "stretch"), (0.0, 1.0))
    fits = {(keeps, damping) for keeps, damping in springs if all(is_printed(d, damping, keeps) for d in sticking)}
    assert fits == {("stretch", 0.0)}


def test_springs_with_constant_displacement_generate_energy() -> None:
    """During loading such a spring gains energy without work; one with constant force does not."""

    def most(keeps: str) -> float:
        """Energy after an elastic impact without dashpots over that before, less one: at most, over angle and friction."""
        gains = []
        for friction in (0.1, 1.0, 100.0):
            law = oblique.Impact(0.0, oblique.mindlin_ratio(0.23), friction, 0.0, 1e6, keeps)
            for slip in np.tan(np.radians([5, 30, 60, 80, 85, 88])):
                along, spin, up = law.follow(slip, 2000)
                gains.append((along**2 + up**2 + 0.4 * spin**2) / (slip**2 + 1) - 1)
        return max(gains)

    assert 0.005 < most("stretch") < 0.01
    assert most("eased") < 1e-4


@pytest.mark.parametrize("degrees", printed.OBLIQUE_MEASURED)
def test_oblique_impacts_are_near_measured_ones(degrees: float) -> None:
    """The rebound of alumina spheres agrees with the table of the documentation, which lists it with measurements."""
    along, *_ = impact(math.radians(degrees))
    got, measured = along / (SPEED * math.sin(math.radians(degrees))), printed.OBLIQUE_MEASURED[degrees]
    rows = (line.strip(" |").split(" | ") for line in VERIFICATION.read_text(encoding="utf-8").splitlines())
    (row,) = (row for row in rows if row[0] == f"{degrees:g}")
    assert row[1:] == [f"{measured:.3f}", f"{got:.3f}", f"{100 * (got / measured - 1):+.1f} %"]


@pytest.mark.parametrize("ratio", [0.1, 2 / 7, 0.6, 1.0])
def test_sticking_springs_have_the_closed_form(ratio: float) -> None:
    """The tangential velocity with linear springs that never slide has the phase of the ratio of the stiffnesses."""
    per_contact, speed = 400, 0.1
    stiffness = BALL.mass * (math.pi / (time := 1e-4)) ** 2
    half, dt = 20 * RADIUS, time / per_contact
    gap = 5.5 * dt * speed
    ball = Ball(RADIUS, (0, 0, -half + RADIUS + gap), (0.03, -0.04, -speed), (0, 0, 0), BALL.material)
    contact = rb.Linear(stiffness=stiffness, restitution=1.0)
    friction = rb.LinearSpring(1e6, ratio=ratio)
    case = dem_cases.case(
        [ball], dt=dt, steps=per_contact + 20, cavity=rb.Box(size=(2 * half,) * 3), contact=contact, friction=friction
    )
    arrays = dem_cases.run(case).arrays
    e = oblique.sticking(ratio)
    # The lever arm is shorter than the radius by the overlap, 0.13 %, which shifts the phase by the same part of 2 pi.
    assert arrays.particles.velocity[0] == pytest.approx((0.03 * e, -0.04 * e, speed), abs=0.05 * 3e-3)
    turn = 2.5 * (1 - e) / RADIUS
    assert arrays.particles.spin[0] == pytest.approx((0.04 * turn, 0.03 * turn, 0), abs=2.5 * 0.05 * 3e-3 / RADIUS)


@pytest.mark.parametrize("spin", [400.0, 1000.0, 5000.0, -5000.0])
def test_spinning_ball_slides_on_a_plane(spin: float) -> None:
    """Test 6 of Chung and Ooi: a spinning ball on a plane gains mu (1 + e) V along it and loses 5/2 of that in spin."""
    friction = 0.02
    along, up, after, result = impact(0.0, spin=spin, friction=friction)
    sign = math.copysign(1.0, spin)
    assert abs(spin) * RADIUS > 3.5 * friction * (SPEED + up)
    assert sign * along == pytest.approx(friction * (SPEED + up), rel=1e-3 if abs(spin) > 500 else 5e-3)
    lost = 2.5 * abs(along) / RADIUS
    assert lost * (1 - result.diagnostics["largest_overlap"]) < sign * (spin - after) < lost


def test_balls_that_spin_together_do_not_slide() -> None:
    """Test 7 of Chung and Ooi: of two balls that turn like wheels on each other only the speeds along the line change."""
    ball = Ball(RADIUS, spin=(0, 0, 300), material=BALL.material)
    other = Ball(RADIUS, spin=(0, 0, -300), material=BALL.material)
    time = dem_cases.contact_time(ball, other, 0.4)
    case = dem_cases.head_on(
        ball, other, 0.4, dt=time / 100, phase=0.5, lasts=2 * time, contact=rb.Tsuji(restitution=1.0), friction=0.4
    )
    arrays = dem_cases.run(case).arrays
    assert arrays.particles.velocity == pytest.approx(np.array([[-0.2, 0, 0], [0.2, 0, 0]]), abs=0.4e-5)
    assert arrays.particles.spin == pytest.approx(np.array([[0, 0, 300], [0, 0, -300]]), rel=1e-9)
    assert np.abs(arrays.sliding_loss).max() < 1e-12 * 0.5 * ball.mass * 0.2**2


@pytest.mark.parametrize("factor", [1.0, 3.0])
def test_spinning_balls_slide_on_each_other(factor: float) -> None:
    """Test 8 of Chung and Ooi: like spins of balls alike and unlike; impulse mu (1 + e) m* V, spins by 5/2 of it."""
    e, friction, speed = 0.9, 0.1, 0.4
    ball = Ball(RADIUS, spin=(0, 0, 900), material=BALL.material)
    other = Ball(factor * RADIUS, spin=(0, 0, 900), material=BALL.material)
    time = dem_cases.contact_time(ball, other, speed)
    case = dem_cases.head_on(
        ball, other, speed, dt=time / 200, phase=0.5, lasts=3 * time, contact=rb.Tsuji(restitution=e), friction=friction
    )
    arrays = dem_cases.run(case).arrays
    mass = dem_cases.reduced(ball.mass, other.mass)
    change = (arrays.particles.velocity - [[speed / 2, 0, 0], [-speed / 2, 0, 0]]) * arrays.particles.mass[:, None]
    impulse = -change[0, 0]
    assert impulse == pytest.approx((1 + e) * mass * speed, rel=3e-4)
    # The surfaces of both balls move in opposite directions at the contact, so they slide with the sum of the speeds.
    # The normal rotates slightly.
    assert change[0, 1] == pytest.approx(-friction * impulse, rel=1e-3)
    assert change[1, :2] == pytest.approx(-change[0, :2], rel=1e-12)
    for number, one in enumerate((ball, other)):
        turned = arrays.particles.spin[number, 2] - 900
        assert turned == pytest.approx(-2.5 * friction * impulse / (one.mass * one.radius), rel=3e-3)
