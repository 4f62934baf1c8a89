"""Strikers: rigid bodies by mass alone, whose contacts follow from a radius or from the law."""

from __future__ import annotations

import numpy as np
import pytest

import rattlebox as rb

PADS = rb.Linear(contact_time="10 ms", restitution=0.5)
STRUCTURE = rb.SDOF(mass="400 t", frequency="1 Hz", damping_ratio=0.02, velocity="0.5 m/s")


def case(ball: rb.Sphere, contact: object = PADS, **fields: object) -> rb.Case:
    """Return a structure with a damper."""
    damper = rb.ImpactDamper(ball=ball, gap="60 mm", contact=contact)  # type: ignore[arg-type]
    return rb.Case(structure=STRUCTURE, damper=damper, duration="3 s", **fields)  # type: ignore[arg-type]


def test_a_striker_moves_like_a_ball_of_its_mass() -> None:
    """With a law of its own contact time a striker has the bits of a ball of its mass, without a warning about its size."""
    ball = rb.simulate(case(rb.Sphere(diameter="1.43 m", mass="12 t", material="steel")))
    striker = rb.simulate(case(rb.Striker(mass="12 t")))
    assert striker.ok and len(striker.arrays.impacts) > 3
    np.testing.assert_array_equal(striker.arrays.displacement, ball.arrays.displacement)
    np.testing.assert_array_equal(striker.arrays.impacts.time, ball.arrays.impacts.time)
    assert any("wide" in note for note in ball.notes)
    assert not any("wide" in note or "warning" in note for note in striker.notes)


def test_the_radius_of_the_ends_gives_the_stiffness() -> None:
    """A striker with a radius has the contacts of a ball with this radius and its mass."""
    law = rb.Tsuji(restitution=0.6)
    ball = rb.simulate(case(rb.Sphere(radius="0.7 m", mass="12 t", material="aluminium"), law))
    striker = rb.simulate(case(rb.Striker(mass="12 t", radius="0.7 m", material="aluminium"), law))
    np.testing.assert_array_equal(striker.arrays.displacement, ball.arrays.displacement)
    np.testing.assert_array_equal(striker.arrays.impacts.peak_force, ball.arrays.impacts.peak_force)


def test_a_law_that_needs_a_radius_is_refused_without_one() -> None:
    """Laws of spheres are refused in words that help, and hard impacts and laws with a stiffness are not."""
    with pytest.raises(rb.CaseError, match=r"'tsuji' follows from the radius of the bodies, and the striker has none"):
        case(rb.Striker(mass="12 t"), rb.Tsuji(restitution=0.6))
    assert rb.simulate(case(rb.Striker(mass="12 t"), rb.Tsuji(restitution=0.6), method=rb.Newton())).ok
    assert rb.simulate(
        case(rb.Striker(mass="12 t"), rb.PowerLaw(exponent=1.5, stiffness=2e9, restitution=0.6, impact_speed="0.5 m/s"))
    ).ok
    with pytest.raises(rb.CaseError, match="restitution"):
        case(rb.Striker(mass="12 t"), rb.Tsuji(restitution=rb.JacksonGreen()), method=rb.Newton())
    with pytest.raises(rb.CaseError, match="mass"):
        rb.Striker()  # type: ignore[call-arg]


def test_words_and_files_of_a_striker() -> None:
    """Files hold a striker, its words name it, and its picture shows no invented size."""
    one = case(rb.Striker(mass="12 t"))
    assert rb.Case.from_toml(one.to_toml()) == one
    assert rb.Case.from_toml(one.to_toml().replace('radius = "', "")) == one
    assert one.dampers[0].words() == "a striker of 12 t with 120 mm of clearance"
    row = rb.ImpactDamper(
        balls=[rb.Sphere(diameter="20 mm", material="steel"), rb.Striker(mass="1 kg")], gap="1 mm", contact=PADS
    )
    assert row.row == 0.02 and row.words().startswith("a row of 2 steel balls and strikers of 1.033 kg")
    rb.plot_case(one)


def test_a_striker_varies_in_a_study() -> None:
    """Mass and gap of a striker are axes of a sweep, whose runs are those of single cases."""
    study = rb.sweep(
        case(rb.Striker(mass="12 t")), {"damper.ball.mass": ["6 t", "12 t"], "damper.gap": ["60 mm", "90 mm"]}, "peak"
    )
    one = rb.simulate(case(rb.Striker(mass="6 t")))
    assert float(study.peak[0, 0]) == pytest.approx(float(np.abs(one.arrays.displacement).max()), rel=1e-3)
