"""Formulas of contact and restitution against exact and published numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest

import rattlebox as rb

ZETA = np.array([0.1, 0.3, 0.5, 0.9])
YIELD_STRAIN = 0.00515


def steel_case(wall: str | None, structure: object) -> rb.Case:
    """Return the steel ball of 33.17 mm on a structure."""
    return rb.Case(
        structure=structure,
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="33.17 mm", material="steel"),
            gap="0.4 mm",
            wall=wall,
            contact=rb.Tsuji(restitution=0.9),
        ),
        duration=1.0,
    )


def wall_pair(wall: str | None = None, structure: object = None) -> rb.Pair:
    """Return the contact of that ball with the left wall."""
    return rb.contact_pairs(steel_case(wall, structure or rb.Fixed()), 0)[0]


@pytest.mark.parametrize(
    ("ending", "exact"),
    [
        ("zero_overlap", [0.7292476, 0.3723261, 0.1630335, 0.0015238]),
        ("zero_force", [0.7440794, 0.4509755, 0.2984361, 0.1552827]),
    ],
)
def test_restitution_of_tsuji_damping(ending: str, exact: list[float]) -> None:
    """Restitution at four damping ratios is the exact one, for both endings."""
    np.testing.assert_allclose(rb.restitution_of_alpha(math.sqrt(5) * ZETA, ending), exact, atol=6e-8)


def test_critical_tsuji_damping() -> None:
    """At critical damping a contact that ends without force gives back exp(-2) of the speed, and is smooth there."""
    near = rb.restitution_of_alpha(math.sqrt(5) * np.array([1 - 1e-7, 1.0, 1 + 1e-7]))
    np.testing.assert_allclose(near, math.exp(-2), rtol=2e-7)


@pytest.mark.parametrize("ending", ["zero_overlap", "zero_force"])
def test_alpha_of_restitution_is_the_inverse(ending: str) -> None:
    """The damping found for a restitution gives back exactly that restitution."""
    e = np.array([1e-3, 0.05, math.exp(-2), 0.2, 0.5, 0.9, 0.99, 0.999999])
    np.testing.assert_allclose(rb.restitution_of_alpha(rb.alpha_of_restitution(e, ending), ending), e, rtol=1e-12)
    assert rb.alpha_of_restitution(1.0, ending) == 0.0


def test_alpha_of_the_published_ball() -> None:
    """Alpha 0.006313 means restitution 0.991170, and restitution 0.99 would need 0.00715342."""
    assert rb.restitution_of_alpha(0.006313, "zero_overlap") == pytest.approx(0.991170, abs=5e-7)
    assert rb.alpha_of_restitution(0.99, "zero_overlap") == pytest.approx(0.00715342, abs=5e-9)


def test_hertz_stiffness_of_the_published_ball() -> None:
    """A = (4/3) E* sqrt(R*) against an elastic and against a rigid wall."""
    assert wall_pair().hertz_stiffness == pytest.approx(2.668518e10, rel=3e-7)
    assert wall_pair("rigid").hertz_stiffness == pytest.approx(5.337035e10, rel=3e-7)


@pytest.mark.parametrize(
    ("wall", "free", "speed"),
    [(None, False, 0.1645947), (None, True, 0.1694607), ("rigid", False, 0.0411487), ("rigid", True, 0.0423652)],
)
def test_critical_speed_of_the_published_ball(wall: str | None, free: bool, speed: float) -> None:
    """V_c against a fixed wall and against 20 kg, elastic and rigid."""
    structure = rb.SDOF(mass=20.0, stiffness=80e3) if free else rb.Fixed()
    assert rb.JacksonGreen().critical_speed(wall_pair(wall, structure)) == pytest.approx(speed, abs=6e-8)


def test_wall_of_the_law_replaces_that_of_the_damper() -> None:
    """A rigid wall in the law has the critical speed of a rigid wall of the damper."""
    law = rb.JacksonGreen(wall="rigid").critical_speed(wall_pair())
    assert law == pytest.approx(rb.JacksonGreen().critical_speed(wall_pair("rigid")), rel=1e-14)


@pytest.mark.parametrize("law", [rb.JacksonGreen(), rb.JacksonGreen(yield_stress=1e9)])
def test_both_walls_are_alike(law: rb.JacksonGreen) -> None:
    """A wall that yields with the ball, but is stiffer, is the same wall on both sides."""
    pair = wall_pair()
    assert pair.below.material is not None
    wall = rb.Body(pair.below.material.model_copy(update={"young": 1e13}))
    ball = pair.above if pair.below.is_flat else pair.below
    assert law.coefficients(rb.Pair(wall, ball)) == law.coefficients(rb.Pair(ball, wall))
    assert ball.material is not None
    strength = law.yield_stress or ball.material.yield_stress
    assert strength is not None
    assert law.coefficients(rb.Pair(wall, ball))[1]["yield_strain"] == strength / ball.material.young


def test_yield_strain_of_steel() -> None:
    """eps_y = S_y / E of the body that yields first."""
    name, values = rb.JacksonGreen().coefficients(wall_pair())
    assert name == "jackson_green"
    assert values["yield_strain"] == pytest.approx(YIELD_STRAIN, rel=1e-14)


@pytest.mark.parametrize(
    ("ratio", "exact"),
    [
        (0.5, 1.0),
        (1.01, 0.9997432),
        (1.5, 0.9807363),
        (2, 0.9633079),
        (5, 0.8942348),
        (10, 0.8282785),
        (30, 0.6955521),
        (60, 0.5905655),
        (100, 0.5317981),
        (300, 0.4013329),
        (1000, 0.2542389),
    ],
)
def test_jackson_green(ratio: float, exact: float) -> None:
    """The law at multiples of the critical speed, on both branches."""
    pair = wall_pair()
    law = rb.JacksonGreen()
    e = rb.restitution_curve(law, pair, ratio * law.critical_speed(pair) * (1 - 1e-15))
    assert e == pytest.approx(exact, abs=6e-8)


def test_jackson_green_beyond_its_range() -> None:
    """Above 1000 critical speeds there is no value, unless extrapolation is asked for."""
    pair = wall_pair()
    speed = 1001 * rb.JacksonGreen().critical_speed(pair)
    assert np.isnan(rb.restitution_curve(rb.JacksonGreen(), pair, speed))
    assert 0.2 < rb.restitution_curve(rb.JacksonGreen(extrapolate=True), pair, speed) < 0.2543


@pytest.mark.parametrize(
    ("ratio", "exact"),
    [
        (0.9, 1.0),
        (1.1, 0.9979882),
        (1.5, 0.9712394),
        (2, 0.9306259),
        (5, 0.7733369),
        (10, 0.6585583),
        (100, 0.3742990),
    ],
)
def test_thornton(ratio: float, exact: float) -> None:
    """Thornton's closed form at multiples of the yield speed."""
    pair = wall_pair()
    law = rb.ThorntonRestitution()
    assert rb.restitution_curve(law, pair, ratio * law.yield_speed(pair)) == pytest.approx(exact, abs=6e-8)


def test_johnson_falls_with_the_fourth_root() -> None:
    """Sixteen times the speed halves the restitution, and slow impacts lose nothing."""
    e = rb.restitution_curve(rb.Johnson(speed_scale=0.1), wall_pair(), [0.05, 1.6, 25.6])
    np.testing.assert_allclose(e, [1.0, 0.5, 0.25], rtol=1e-14)


def test_table_between_and_outside_its_points() -> None:
    """A table is linear between its points, constant outside, and obeys the cap."""
    law = rb.Tabulated(speeds=[1.0, 2.0], values=[0.9, 0.5], maximum=0.8)
    np.testing.assert_allclose(
        rb.restitution_curve(law, wall_pair(), [0.1, 1.5, 1.75, 9.0]), [0.8, 0.7, 0.6, 0.5], rtol=1e-14
    )


def test_softer_body_yields_first() -> None:
    """Steel against lead takes the yield strain of lead."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="5 mm", material="steel"), gap="1 mm", wall="lead", contact=rb.Tsuji(restitution=0.9)
    )
    pair = rb.contact_pairs(rb.Case(structure=rb.Fixed(), damper=damper, duration=1.0), 0)[0]
    lead = rb.materials()["lead"]
    assert lead.yield_stress is not None
    _, values = rb.JacksonGreen().coefficients(pair)
    assert values["yield_strain"] == lead.yield_stress / lead.young


def test_stiffness_of_a_contact_time() -> None:
    """A linear contact of a given duration has the spring of that half period."""
    pair = wall_pair()
    _, values = rb.Linear(contact_time="1 ms", restitution=0.9).coefficients(pair)
    assert math.pi * math.sqrt(pair.mass / values["stiffness"]) == pytest.approx(1e-3, rel=1e-14)


@pytest.mark.parametrize("exponent", [0.5, 1.5, 4.3, 6.7, 8.0, 10.0])
def test_a_power_law_of_any_documented_exponent(exponent: float) -> None:
    """An ordinary contact, of 90 N at 40 um, is accepted at each exponent; tests had stopped at 3, below the limit."""
    stiffness, mass, speed = 90 / 40e-6**exponent, 0.02, 0.7
    law = rb.PowerLaw(stiffness=stiffness, exponent=exponent, damping=0.0)
    ball = rb.Sphere(radius="6 mm", material="steel", mass=mass)
    damper = rb.ImpactDamper(ball=ball, gap="0.2 mm", velocity=speed, contact=law, wall="rigid")
    run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, duration=1e-3))
    q = 1 / (exponent + 1)
    overlap = (mass * speed**2 / (2 * q * stiffness)) ** q
    time = 2 * math.sqrt(math.pi) * math.gamma(1 + q) / math.gamma(0.5 + q) * overlap / speed
    assert float(run.impacts.peak_overlap[0]) == pytest.approx(overlap, rel=1e-11)
    assert float(run.impacts.duration[0]) == pytest.approx(time, rel=1e-11)
    assert rb.Case.from_toml(run.case.to_toml()) == run.case


def test_limits_of_a_power_law_are_those_of_its_force() -> None:
    """Coefficients are limited by the force at 1 um; the number that the message advises is accepted."""
    largest = rb.PowerLaw(stiffness=1e48, exponent=3, damping=0.0)
    with pytest.raises(
        rb.CaseError, match=r"more than 1e\+30 N at an overlap of 1 um\n  try: stiffness = 1e\+48 or less"
    ):
        rb.PowerLaw(stiffness=1.01 * largest.stiffness, exponent=3, damping=0.0)
    assert rb.PowerLaw(damping=1e42, damping_exponent=2).damping == 1e42
    with pytest.raises(
        rb.CaseError, match=r"damping = 1\.1e\+42\n  with the exponent 2 this is more than 1e\+30 N s/m"
    ):
        rb.PowerLaw(damping=1.1e42, damping_exponent=2)
    with pytest.raises(rb.CaseError, match="finite"):
        rb.PowerLaw(stiffness=math.inf, exponent=3, damping=0.0)
