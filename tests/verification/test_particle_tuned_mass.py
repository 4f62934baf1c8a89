"""Particle tuned mass dampers: balls and beds in the box of a tuned mass, glued, untouched and at work."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import rattlebox as rb

TOP = "storey 4"
BUILDING = rb.ShearBuilding(masses=["60 t"] * 4, stiffnesses=["85 MN/m"] * 4, damping_ratio=0.015)
FULL = rb.TunedMass.warburton(BUILDING, mass="8 t", point=TOP)
BOX = FULL.with_content("6 t")
LOAD = rb.Harmonic(amplitude="40 kN", frequency="1.7 Hz", point=TOP)


def displacement(**fields: Any) -> Any:
    """Return the displacements of the storeys along x."""
    case = rb.Case(structure=BUILDING, load=LOAD, duration="2 s", output=rb.Output(rate="100 Hz"), **fields)
    run = rb.simulate(case)
    assert run.ok
    return run.along().displacement.values


def deviation(one: Any, other: Any) -> float:
    """Return the largest difference over the largest displacement."""
    return float(np.abs(one - other).max() / np.abs(other).max())


def one_ball(gap: Any, contact_time: float) -> rb.ImpactDamper:
    """Return a ball of 6 t in the box."""
    return rb.ImpactDamper(
        ball=rb.Sphere(diameter="0.9 m", mass="6 t", material="steel"),
        gap=gap,
        contact=rb.Linear(contact_time=contact_time, restitution=0.5),
        point="tuned mass",
    )


def bed(contact_time: float, clearance: float) -> rb.ParticleDamper:
    """Return three balls of 6 t in all in the box, side by side, without gravity."""
    size = (6 * 2000 / (math.pi * 7850)) ** (1 / 3)
    return rb.ParticleDamper(
        particles=rb.Particles(material=steel(), diameter=size, count=3),
        cavity=rb.Box(size=(3 * size + clearance, size + clearance, size + clearance)),
        contact=rb.Linear(contact_time=contact_time, restitution=0.5),
        packing=rb.Positions(positions=[[(k - 1) * size, 0.0, 0.0] for k in range(3)]),
        gravity=(0, 0, 0),
        point="tuned mass",
        direction="x",
    )


def steel() -> rb.Material:
    """Return a material of 7850 kg/m^3."""
    return rb.materials()["steel"].model_copy(update={"density": 7850.0})


def test_box_and_content_are_the_tuned_mass() -> None:
    """The box has the spring and the dashpot of the tuned mass, to rounding."""
    assert BOX.mass == pytest.approx(2000, rel=1e-15)
    for power in (1, 2):
        assert BOX.mass * BOX.frequency**power * BOX.damping_ratio ** (2 - power) == pytest.approx(
            FULL.mass * FULL.frequency**power * FULL.damping_ratio ** (2 - power), rel=1e-14
        )
    with pytest.raises(rb.CaseError, match="box and content together have 8000 kg"):
        FULL.with_content("8 t")


def test_a_glued_ball_is_a_tuned_mass_of_the_total_mass() -> None:
    """A ball without clearance differs from a tuned mass of both by the square of the contact time, down to 1e-8."""
    exact = displacement(tuned_mass=FULL)
    times = [1e-3, 1e-4, 2e-5]
    found = [deviation(displacement(tuned_mass=BOX, damper=one_ball(0.0, time)), exact) for time in times]
    scaled = np.array(found) / np.array(times) ** 2
    np.testing.assert_allclose(scaled, scaled[0], rtol=1e-3)
    assert found[-1] < 1e-7


@pytest.mark.parametrize("load", ["storey 1", "storey 4", "base"])
def test_a_ball_that_fills_a_box_at_rest_ends(load: str) -> None:
    """A heavy ball without a gap ends within seconds, with a status whose advice leads to the motion.

    The motion of the box begins below the rounding of the numbers, and a run made 2e9 steps of 1e-15 s: the ball of the
    other tests is light, and its load acts for the whole run.
    """
    acts = {"load": rb.HalfSine(amplitude="300 kN", duration="0.2 s", point=load)}
    if load == "base":
        acts = {"base": rb.HalfSine(amplitude="0.1 g", duration="0.2 s")}
    box = rb.TunedMass(mass="2 t", frequency="2.5 Hz", damping_ratio=0.0, point=TOP)

    def ran(gap: Any) -> rb.Run:
        ball = rb.ImpactDamper(
            ball=rb.Striker(mass="8 t"),
            gap=gap,
            contact=rb.Linear(contact_time="8 ms", restitution=0.5),
            point="tuned mass",
        )
        output = rb.Output(rate="200 Hz")
        return rb.simulate(
            rb.Case(structure=BUILDING, tuned_mass=box, damper=ball, duration="2 s", output=output, **acts)
        )

    filled, loose = ran(0.0), ran("1 pm")
    assert loose.ok
    if filled.ok:
        assert deviation(filled.arrays.displacement, loose.arrays.displacement) < 1e-6
    else:
        assert filled.status == "too_many_events" and 'a gap, such as "1 pm"' in filled.message
        assert filled.counts["contact_steps"] + filled.counts["rejected_steps"] < 1e7


def test_in_the_limit_of_short_contacts_a_glued_ball_is_exact() -> None:
    """The limit of rigid contacts is the tuned mass of both to rounding: the deviation of single runs is that of contacts.

    The limit follows from three contact times by Richardson extrapolation of the terms of second and third order. The tests
    above could not see an error below 1e-8, because a contact that lasts is softer than glue.
    """
    exact = displacement(tuned_mass=FULL)
    found = [displacement(tuned_mass=BOX, damper=one_ball(0.0, time)) for time in (2e-4, 1e-4, 5e-5)]
    for order in (2, 3):
        found = [(2**order * short - long) / (2**order - 1) for long, short in pairwise(found)]
    assert deviation(found[0], exact) < 2e-12


def test_a_glued_bed_is_a_tuned_mass_of_the_total_mass() -> None:
    """A bed without clearance differs from a tuned mass of both by the square of the contact time."""
    exact = displacement(tuned_mass=FULL)
    found = [deviation(displacement(tuned_mass=BOX, damper=bed(time, 0.0)), exact) for time in (8e-3, 4e-3, 2e-3)]
    assert found[-1] < 2e-3
    np.testing.assert_allclose(np.array(found[:-1]) / found[1:], 4, rtol=0.1)


def test_untouched_content_leaves_the_empty_box() -> None:
    """A ball that no wall reaches changes nothing, and a bed in three dimensions no more than its time step does."""
    exact = displacement(tuned_mass=BOX)
    assert deviation(displacement(tuned_mass=BOX, damper=one_ball("4 m", 1e-3)), exact) < 1e-14
    assert deviation(displacement(tuned_mass=BOX, damper=bed(2e-3, 6.0)), exact) < 1e-7
