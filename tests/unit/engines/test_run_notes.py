"""Notes on what a run shows: overlaps beyond the range of a law, and dampers in which nothing touched."""

from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.engines.run_notes import vibration_notes

PULSE = rb.HalfSine(amplitude="5 kN", duration="1 ms")


def notes(structure: Any = None, load: Any = PULSE, method: Any = None, **changes: Any) -> tuple[str, ...]:
    """Return the notes on a run with a ball of 10 mm radius."""
    usual = {
        "ball": rb.Sphere(radius="10 mm", material="steel"),
        "gap": "0.4 mm",
        "contact": rb.Tsuji(restitution=0.9),
    }
    case = rb.Case(
        structure=structure or rb.SDOF(mass="20 kg", stiffness="80 kN/m"),
        loads=[load] if load else [],
        damper=rb.ImpactDamper(**{**usual, **changes}),
        duration="0.1 s",
        method=method or rb.EventDriven(),
    )
    return rb.simulate(case).notes


@pytest.mark.parametrize("method", [rb.EventDriven(), rb.Newton(), rb.TwoStep()], ids=lambda method: method.kind)
def test_balls_that_never_touch_are_noted(method: Any) -> None:
    """A gap of 0.4 m, meant as 0.4 mm, is noted with the distance that remains; a gap that is crossed is not."""
    (note,) = notes(gap=0.4, method=method)
    assert "distance between surfaces 397 mm, gap 400 mm" in note
    assert notes(method=method) == ()


@pytest.mark.parametrize("method", [rb.EventDriven(), rb.Newton()], ids=lambda method: method.kind)
@pytest.mark.parametrize("gravity", [0, "-9.81 m/s^2"])
def test_balls_that_rest_on_a_wall_touch_it(method: Any, gravity: Any) -> None:
    """A ball that lies on a wall all the time logs no impact with hard contacts, and touches nevertheless."""
    assert notes(rb.Fixed(), None, method, start=-1, gravity=gravity) == ()


def test_each_damper_is_judged_by_itself() -> None:
    """The note names the one of two dampers in which no impact happens."""
    near, far = (
        rb.ImpactDamper(
            name=name,
            ball=rb.Sphere(radius="10 mm", material="steel"),
            gap=gap,
            contact=rb.Tsuji(restitution=0.9),
        )
        for name, gap in (("near", "0.4 mm"), ("far", "40 mm"))
    )
    structure = rb.SDOF(mass="20 kg", stiffness="80 kN/m")
    run = rb.simulate(rb.Case(structure=structure, load=PULSE, dampers=[near, far], duration="0.1 s"))
    (note,) = run.notes
    assert "far" in note and "near" not in note


@pytest.mark.parametrize(
    ("contact", "speed", "noted"),
    [
        (rb.Tsuji(restitution=0.9), 1, 0),
        (rb.Tsuji(restitution=0.9), 100, 1),
        (rb.Thornton(yield_pressure="1 GPa"), 1, 0),
        (rb.Thornton(yield_pressure="1 GPa"), 30, 1),
        (rb.Linear(stiffness="1 kN/mm", restitution=0.9), 4, 0),
        (rb.Linear(stiffness="1 kN/mm", restitution=0.9), 12, 1),
    ],
)
def test_overlaps_beyond_the_range_of_the_law_are_noted(contact: Any, speed: float, noted: int) -> None:
    """Overlaps above 1 % of the radius, 10 % with a linear spring, are noted with their size."""
    result = notes(rb.Fixed(), None, velocity=speed, contact=contact)
    assert len(result) == noted
    assert all("of the radius" in note for note in result)


def test_overlaps_are_measured_by_the_smaller_ball() -> None:
    """Between balls of two sizes the radius is that of the smaller one."""
    small, large = (rb.Sphere(radius=radius, material="steel") for radius in ("1 mm", "10 mm"))
    damper = rb.ImpactDamper(
        balls=[small, large], start=[-0.5, 0.5], velocity=[7, -7], gap="10 mm", contact=rb.Tsuji(restitution=0.9)
    )
    run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, duration="1 ms"))
    assert run.arrays.impacts.contact.tolist() == [1]
    (note,) = run.notes
    assert f"reach {100 * run.arrays.impacts.peak_overlap[0] / 1e-3:.3g} % of the radius" in note


@pytest.mark.parametrize(("size", "noted"), [("20 mm", 0), (20, 1)])
def test_particles_that_never_touch_are_noted(size: Any, noted: int) -> None:
    """Particles in a cavity of 20 m, meant as 20 mm, are noted; those that reach a wall are not."""
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="5 mm", count=2),
        cavity=rb.Box(size=(size, size, size)),
        contact=rb.Tsuji(restitution=0.7),
        gravity=(0, 0, 0),
        velocity=("1 m/s", 0, 0),
        packing=rb.Lattice(),
        softening=1000,
    )
    run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, duration="10 ms"))
    result = [note for note in run.notes if "touched anything" in note]
    assert len(result) == noted
    assert all("to a wall at the start 4.04 m, largest displacement from there 10.0 mm" in note for note in result)


def test_a_ball_that_nearly_touches_is_noted_with_its_distance() -> None:
    """The note compares distances with distances: it had a motion from peak to peak above a gap that no ball crossed."""
    structure = rb.SDOF(mass="2 kg", frequency="5 Hz", velocity="0.3 m/s")
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="4 mm", material="steel"), gap="10 mm", contact=rb.Tsuji(restitution=0.7)
    )
    run = rb.simulate(rb.Case(structure=structure, damper=damper, duration="1 s", output=rb.Output(rate="2 kHz")))
    (note,) = [note for note in run.notes if "touched anything" in note]
    nearest = 10e-3 - 0.3 / (10 * np.pi)
    assert f"smallest distance between surfaces {1e3 * nearest:.3f} mm, gap 10.0 mm" in note


@pytest.mark.parametrize(("last", "noted"), [("50 m/s", 0), ("0.5 m/s", 1)])
def test_impacts_faster_than_a_table_of_restitution_are_noted(last: str, noted: int) -> None:
    """Impacts faster than a table of restitution are noted in both engines, once for a damper."""
    contact = rb.Tsuji(restitution=rb.Tabulated(speeds=("0.1 m/s", last), values=(0.9, 0.8)))
    result = [*notes(contact=contact, velocity=1.0), *particles_at("1 m/s", contact)]
    assert len([note for note in result if "table of restitution" in note]) == 2 * noted


@pytest.mark.parametrize("speed", [1.0, 100.0])
def test_extrapolated_impacts_are_noted(speed: float) -> None:
    """Jackson and Green's law was fitted up to 1000 critical speeds."""
    contact = rb.Tsuji(restitution=rb.JacksonGreen(wall="rigid", extrapolate=True))
    result = [*notes(contact=contact, velocity=speed), *particles_at(speed, contact)]
    assert len([note for note in result if "extrapolated" in note]) == 2 * (speed > 50)


def particles_at(speed: Any, contact: Any) -> tuple[str, ...]:
    """Return the notes on three particles that hit a wall."""
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="5 mm", count=3),
        cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
        contact=contact,
        wall="steel",
        velocity=(speed, 0, 0),
    )
    return rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, duration="20 ms")).notes


MEASURED = rb.TabulatedNormal(overlap=("0 um", "5 um", "10 um"), force=("0 N", "50 N", "140 N"))


@pytest.mark.parametrize("method", [rb.EventDriven(), rb.Newton(), rb.TwoStep()], ids=lambda method: method.kind)
def test_no_silent_extrapolation_of_a_measured_contact(method: Any) -> None:
    """Impacts deeper than the last measured overlap are noted; those within the measurement are not."""
    (note,) = notes(rb.Fixed(), None, method, contact=MEASURED, velocity="1 m/s")
    assert "10.0 µm" in note and "extrapolated" in note
    assert notes(rb.Fixed(), None, method, contact=MEASURED, velocity="0.05 m/s") == ()


def test_no_silent_extrapolation_in_three_dimensions() -> None:
    """Particles deeper than a measured curve are noted, also if only the walls have a measured contact."""
    for speed, count in ((1.0, 1), (0.02, 0)):
        damper = rb.ParticleDamper(
            particles=rb.Particles(material="steel", radius="10 mm", count=1),
            cavity=rb.Box(size=("22 mm",) * 3),
            packing=rb.Positions(positions=[(0.0, 0.0, 0.0)]),
            contact=rb.Tsuji(restitution=0.9),
            pairs=[rb.PairLaws(between=("steel", "wall"), contact=MEASURED)],
            velocity=(speed, 0, 0),
            gravity=(0, 0, 0),
        )
        run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, duration=1.5e-3 / speed))
        assert run.ok
        result = [note for note in run.notes if "10.0 µm" in note and "extrapolated" in note]
        assert len(result) == count, run.notes


def test_many_steps_of_vibrations_are_noted() -> None:
    """A run of very many steps in closed contacts notes that contacts without damping vibrate for ever.

    Nothing told a user why a ball at rest took a quarter of an hour: all tests of long runs had damping.
    """
    (note,) = vibration_notes(300_000_000)
    assert note.startswith("note: 300 million steps were made in closed contacts; a contact without damping vibrates")
    assert not list(vibration_notes(1_000_000))
