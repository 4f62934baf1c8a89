"""Time step of 3-D runs: contact durations, limits of the step, refusal of too long a step."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid, solve_ivp

import rattlebox as rb
from rattlebox.core import _core
from rattlebox.model.overlaps import check_packing
from rattlebox.prepare.particles import prepare
from rattlebox.prepare.settle import insert, push_apart
from rattlebox.prepare.time_step import choose_step, expected_speeds, limits, step_diagnostics

STEEL = rb.materials()["steel"]


def contact_time(law: str, values: dict[str, float], speed: float) -> float:
    """Return the duration of an undamped contact, from the core."""
    flags = {"hertz_tsuji": ["zero_overlap"], "linear": ["zero_overlap", "fixed_contact_time"]}.get(law, [])
    return _core.normal_law(law, {**values, **dict.fromkeys(flags, 0.0)}).contact_time(speed)


CUBE = rb.Box(size=("40 mm",) * 3)


def case(damper: dict[str, Any] | None = None, **options: Any) -> rb.Case:
    """Return a case with two kinds of steel balls in a fixed cube without gravity."""
    usual: dict[str, Any] = {
        "particles": [
            rb.Particles(material="steel", diameter="4 mm", count=20),
            rb.Particles(name="fine", material="steel", diameter="2 mm", count=20),
        ],
        "cavity": CUBE,
        "contact": rb.Tsuji(restitution=0.9),
        "gravity": (0, 0, 0),
        "velocity": ("0.5 m/s", 0, 0),
    }
    made = rb.ParticleDamper(**{**usual, **(damper or {})})
    return rb.Case(**{"structure": rb.Fixed(), "damper": made, "duration": 1.0, **options})


def tables(of: rb.Case) -> list[Any]:
    """Return the contact table of each damper of a case."""
    return [damper.contact_table for damper in of.particle_dampers]


def integrated(force: Any, mass: float, speed: float) -> float:
    """Return the contact duration of a body that hits a spring, from its equation of motion."""

    def leaves(_: float, y: Any) -> float:
        return float(y[0])

    leaves.terminal, leaves.direction = True, -1.0  # type: ignore[attr-defined]
    tries = solve_ivp(
        lambda _, y: [y[1], -force(max(y[0], 0.0)) / mass], (0, 1.0), [0.0, speed], events=leaves, rtol=1e-9, atol=1e-15
    )
    return float(tries.t_events[0][-1])


def test_contact_durations_are_exact() -> None:
    """The durations of Hertz and linear contacts agree with the integrated equation of motion."""
    hertz = {"stiffness": 5e9, "mass": 1e-4}
    for speed in (0.01, 1.0, 20.0):
        expected = integrated(lambda d: 5e9 * d**1.5, 1e-4, speed)
        assert contact_time("hertz_tsuji", hertz, speed) == pytest.approx(expected, rel=1e-5)
    linear = {"stiffness": 1e6, "mass": 1e-4}
    assert contact_time("linear", linear, 3.0) == pytest.approx(integrated(lambda d: 1e6 * d, 1e-4, 3.0), rel=1e-5)


@pytest.mark.parametrize("speed", [0.001, 0.1, 1.0, 10.0, 100.0])
def test_the_duration_of_a_yielding_contact_is_that_of_its_largest_stiffness(speed: float) -> None:
    """The duration of a yielding contact follows from its largest stiffness, at the start of unloading."""
    radius, modulus, pressure, mass = 1e-3, 1.1e11, 1.6e9, 1e-4
    stiffness = 4 / 3 * modulus * math.sqrt(radius)
    law = {"stiffness": stiffness, "mass": mass, "radius": radius, "modulus": modulus, "yield_pressure": pressure}
    lasts = contact_time("thornton", law, speed)
    depth = radius * (math.pi * pressure / (2 * modulus)) ** 2
    yielding = stiffness * depth**1.5
    slope = math.pi * pressure * radius

    d = np.linspace(0, 1e-3, 1_000_001)
    along = np.where(d <= depth, stiffness * d**1.5, yielding + slope * (d - depth))
    energy = cumulative_trapezoid(along, d, initial=0.0)
    largest = float(np.interp(0.5 * mass * speed**2, energy, along))
    if largest <= yielding:
        assert lasts == pytest.approx(contact_time("hertz_tsuji", {"stiffness": stiffness, "mass": mass}, speed))
        return
    wide = 4 * modulus / (3 * largest) * ((2 * largest + yielding) / (2 * math.pi * pressure)) ** 1.5
    steepest = 2 * modulus * math.sqrt(wide) * (3 * largest / (4 * modulus * math.sqrt(wide))) ** (1 / 3)
    assert 4.03 / lasts == pytest.approx(math.sqrt(steepest / mass), rel=0.02)


def test_the_smallest_pair_limits_the_step() -> None:
    """Among several sizes the contact of the smallest particles is the shortest and limits the step."""
    made = case()
    speeds = expected_speeds(made, [np.zeros((0, 3))])
    assert speeds == (1.0,)
    step = choose_step(made, tables(made), speeds)
    radius, mass = 0.5e-3, 0.5 * 4 / 3 * math.pi * 1e-9 * STEEL.density
    modulus = STEEL.young / (2 * (1 - STEEL.poisson**2))
    lasts = contact_time("hertz_tsuji", {"stiffness": 4 / 3 * modulus * math.sqrt(radius), "mass": mass}, 1.0)
    assert step.shortest.duration == pytest.approx(lasts)
    assert "fine and fine (diameter 2 mm) at 1 m/s" in step.shortest.what
    assert step.dt <= 0.025 * lasts
    assert step.dt * step.every * made.even_samples() == pytest.approx(made.duration, rel=1e-14)


def test_slow_contacts_are_limited_by_waves() -> None:
    """With slow contacts the travel time of a Rayleigh wave along the smallest particle limits the step."""
    made = case({"velocity": (1e-6, 0, 0)})
    step = choose_step(made, tables(made), expected_speeds(made, [np.zeros((0, 3))]))
    assert step.limit.what.startswith("Rayleigh wave along fine (diameter 2 mm)")
    shear = STEEL.young / (2 * (1 + STEEL.poisson))
    wave = math.pi * 1e-3 * math.sqrt(STEEL.density / shear) / (0.1631 * STEEL.poisson + 0.8766)
    assert step.dt == pytest.approx(0.2 * wave, rel=1e-3)


def test_a_fast_mode_limits_the_step() -> None:
    """A mode with a period shorter than any contact limits the step."""
    made = case({"softening": 1e6}, structure=rb.SDOF(mass=1e-3, stiffness=1e9), duration=1e-3)
    result = limits(made, tables(made), (1.0,))
    assert min(result, key=lambda limit: limit.step).what.startswith("period of mode 1")


def test_too_long_a_step_is_refused_with_its_bound() -> None:
    """A step above the bound is refused with the bound; a step just below it is accepted."""
    made = case()
    shortest = choose_step(made, tables(made), (1.0,)).shortest
    for dt, good in [(1.001 * shortest.bound, False), (0.999 * shortest.bound, True)]:
        tried = case(method=rb.Dem(dt=dt))
        if good:
            assert choose_step(tried, tables(tried), (1.0,)).dt <= dt
        else:
            with pytest.raises(rb.CaseError, match=r"too long: the bound is 1\.23 µs, for the contact of fine"):
                choose_step(tried, tables(tried), (1.0,))


def test_strong_dashpots_lower_the_bound() -> None:
    """A dashpot with a time constant shorter than the contact lowers the bound."""
    bounds = []
    for e in (0.9, 1e-3):
        made = case({"contact": rb.Tsuji(restitution=e)})
        bounds.append(choose_step(made, tables(made), (1.0,)).shortest.bound)
    assert bounds[1] < 0.5 * bounds[0]


def test_expected_speeds_add_what_moves() -> None:
    """The velocity range of a shaker and the speed of a fall through the cavity add up."""
    shaken = case(
        {"velocity": (0, 0, 0), "gravity": (0, 0, -9.81)},
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="50 Hz", direction="z")),
    )
    expected = 2 * 1e-3 * 100 * math.pi + math.sqrt(2 * 9.81 * 0.04)
    assert expected_speeds(shaken, [np.zeros((0, 3))])[0] == pytest.approx(expected, rel=1e-4)


def test_the_expected_speed_of_a_cavity_at_constant_velocity() -> None:
    """The expected speed of particles at rest in a cavity with a nearly constant velocity is that velocity."""
    for stiffness in (0.0, 100.0):
        moving = case(
            {"velocity": (0, 0, 0)}, structure=rb.SDOF(mass=10, stiffness=stiffness, velocity=5), duration=0.01
        )
        assert prepare(moving).step.speeds[0] == pytest.approx(5, rel=1e-3)


@pytest.mark.parametrize(
    "load",
    [rb.Harmonic(amplitude="10 N", frequency="1 kHz"), rb.HalfSine(amplitude="10 N", duration="1 ms")],
    ids=lambda load: load.kind,
)
def test_too_long_a_step_for_a_load_is_refused(load: Any) -> None:
    """A step too long for the time scale of a load is refused, with the bound and the load."""
    made = case({"softening": 1e6}, structure=rb.SDOF(mass=1, stiffness=0), load=load, method=rb.Dem(dt="0.3 ms"))
    with pytest.raises(rb.CaseError, match=r"too long: the bound is 0.200 ms, for the p"):
        choose_step(made, tables(made), (0.01,))


@pytest.mark.parametrize("on", ["shaker", "structure"])
def test_the_expected_speed_does_not_depend_on_the_sampling(on: str) -> None:
    """Samples one period apart give the same expected speed as a high output rate."""
    swing = {"amplitude": (1000, "m/s^2"), "frequency": "50 Hz"}
    where: dict[str, Any] = {
        "shaker": {"structure": rb.Shaker(motion=rb.Harmonic(**swing))},
        "structure": {
            "structure": rb.SDOF(mass="2 kg", stiffness=2 * (100 * math.pi) ** 2),
            "load": rb.Harmonic(amplitude="60 N", frequency="50 Hz"),
        },
    }
    rare, frequent = (
        prepare(case({"velocity": (0, 0, 0)}, output=rb.Output(rate=rate), duration=0.2, **where[on])).step
        for rate in ("50 Hz", "5 kHz")
    )
    assert frequent.speeds[0] > 5
    assert rare.speeds == pytest.approx(frequent.speeds, rel=1e-3)


def test_each_softening_is_reported_once() -> None:
    """Dampers with the same softening share a note, others are named; without softening the advice differs."""

    def notes(*softening: float, **laws: Any) -> list[str]:
        parts = [case({"softening": factor, "name": f"d{k}", **laws}).dampers[0] for k, factor in enumerate(softening)]
        made = rb.Case(structure=rb.Fixed(), dampers=parts, duration=0.1)
        step = choose_step(made, tables(made), (1.0,) * len(parts))
        return step_diagnostics(made, tables(made), step, (0.05,) * len(parts), (1.0,) * len(parts))[1][1:]

    hertz = "moduli are divided by {0:g}: contacts last {1} times as long, and overlap {1} times as much"
    assert notes(100, 100)[:-2] == [hertz.format(100, 6.31)]
    assert notes(100, 1, 10)[:-3] == ["d0: " + hertz.format(100, 6.31), "d2: " + hertz.format(10, 2.51)]
    linear = rb.Linear(contact_time="0.1 ms", restitution=0.9)
    assert notes(100, contact=linear)[:-1] == [hertz.format(100, 10)]
    assert notes(100, wall_contact=linear)[:-1] == [hertz.format(100, "6.31 and 10")]
    assert notes(100)[-1].endswith("less softening or a stiffer contact")
    assert notes(1)[-1].endswith("a stiffer contact")


def test_warnings_of_short_contacts_and_large_overlaps() -> None:
    """Too few steps in the shortest contact and too large overlaps are warnings; softening is a note with its effect."""
    made = case({"softening": 100})
    step = choose_step(made, tables(made), (1.0,))
    _, quiet = step_diagnostics(made, tables(made), step, (1e-3,), (1.0,))
    assert not any("warning" in note for note in quiet)
    assert any("contacts last 6.31 times as long" in note for note in quiet)
    figures, loud = step_diagnostics(made, tables(made), step, (0.05,), (100.0,))
    assert sum("warning" in note for note in loud) == 2
    assert figures["steps_per_contact"] == pytest.approx(step.shortest.duration / step.dt * 100**-0.2, rel=1e-6)


def test_a_step_limited_by_samples_is_reported() -> None:
    """The note names the limit of the step; if the samples limit it, also the limit without them."""

    def note(rate: float, dt: str = "auto") -> tuple[float, float, str]:
        made = case(duration=0.01, output=rb.Output(rate=rate), method=rb.Dem(dt=dt))
        step = choose_step(made, tables(made), (1.0,))
        _, (text,) = step_diagnostics(made, tables(made), step, (1e-3,), (1.0,))
        return step.dt, step.limit.step, text

    _, longest, alone = note(1e4)
    contact = alone.partition(", limited by the ")[2]
    assert contact.startswith("contact of fine and fine (diameter 2 mm) at 1 m/s, ")
    assert longest > 1.1e-7
    without = f"without them {1e9 * longest:.0f} ns, for the {contact}"
    assert note(1e7)[::2] == (pytest.approx(1e-7), f"step 100 ns, limited by the samples; {without}")
    assert note(1.001 / longest)[2] == f"step {1e9 * longest:.0f} ns, limited by the samples; {without}"
    assert note(0.999 / longest)[2].endswith(f" ns, limited by the {contact}")
    given = f"as given; an automatic one would be limited by the {contact}"
    for rate in (1e4, 1.25e7):
        assert note(rate, "80 ns")[2] == f"step 80.0 ns, {given}"
    assert note(2e7, "80 ns")[2] == f"step 50.0 ns, limited by the samples; without them 80.0 ns, {given}"


def test_the_damper_that_overlaps_too_much_is_named() -> None:
    """The warnings of several dampers depend on the overlap, speed and softening of each and name it."""
    parts = [case({"name": name, "softening": factor}).dampers[0] for name, factor in (("box", 1), ("can", 100))]
    made = rb.Case(structure=rb.Fixed(), dampers=parts, duration=0.1)
    step = choose_step(made, tables(made), (1.0, 1.0))

    def warnings(*overlaps: float) -> list[str]:
        return [
            note for note in step_diagnostics(made, tables(made), step, overlaps, (1.0, 1.0))[1] if "overlaps" in note
        ]

    assert warnings(1e-3, 1e-3) == []
    (box,) = warnings(0.02, 1e-3)
    assert box.startswith("warning: overlaps in box reach 2 % of the radius") and "a stiffer contact" in box
    assert [note.split(" reach")[0] for note in warnings(0.02, 0.03)] == [
        "warning: overlaps in box",
        "warning: overlaps in can",
    ]
    assert warnings(1e-3, 0.03)[0].endswith("less softening or a stiffer contact")
    stiff, soft = (
        step_diagnostics(made, tables(made), step, (0, 0), speeds)[0] for speeds in ((10.0, 1.0), (1.0, 10.0))
    )
    assert stiff["steps_per_contact"] < soft["steps_per_contact"]
    assert stiff["largest_approach_speed"] == soft["largest_approach_speed"] == 10.0


@pytest.mark.parametrize("filled", [0.2, 0.55])
def test_particles_inserted_at_random_do_not_overlap(filled: float) -> None:
    """Random positions are pushed apart until no particles overlap; a seed fixes the result."""
    cavity = rb.Cylinder(diameter="40 mm", length="30 mm", axis=(0, 1, 1))
    radii = (
        rb.LogNormal(median="4 mm", geometric_standard_deviation=1.2, smallest="3 mm", largest="6 mm").diameters(
            np.linspace(0.001, 0.999, 500)
        )
        / 2
    )
    radii *= (filled * cavity.volume / np.sum(4 / 3 * math.pi * radii**3)) ** (1 / 3)
    places = insert(cavity, radii, seed=1)
    check_packing(cavity, places, radii)
    assert np.array_equal(places, insert(cavity, radii, seed=1))
    assert not np.allclose(places, insert(cavity, radii, seed=2))
    assert np.abs(places.mean(axis=0)).max() < 1e-3


def test_an_overfull_cavity_is_refused() -> None:
    """Insertion into a full cavity raises an error."""
    with pytest.raises(rb.CaseError, match="would fill 71 % of the cavity, cannot be inserted at random"):
        push_apart(CUBE, np.zeros((100, 3)) + np.linspace(0, 1e-3, 300).reshape(100, 3), np.full(100, 4.77e-3), 2e-3)


def test_a_wall_has_the_mass_of_the_structure() -> None:
    """The contact duration at the wall of a light structure follows from the reduced mass of both."""
    weight = 4 / 3 * math.pi * 2e-3**3 * STEEL.density
    for structure in (0.2 * weight, 5 * weight):
        made = case(
            {"particles": rb.Particles(material="steel", diameter="4 mm", count=1)},
            structure=rb.SDOF(mass=structure, stiffness=0),
        )
        modulus = STEEL.young / (2 * (1 - STEEL.poisson**2))
        pair = {
            "stiffness": 4 / 3 * modulus * math.sqrt(2e-3),
            "mass": weight * structure / (weight + structure),
        }
        step = choose_step(made, tables(made), (1.0,))
        assert step.shortest.duration == pytest.approx(contact_time("hertz_tsuji", pair, 1.0))


@pytest.mark.parametrize("speed", [0.1, 2.0])
def test_friction_springs_lower_the_bound(speed: float) -> None:
    """The oscillation of a free sphere on its Mindlin spring is shorter than the contact and lowers the bound."""
    made = case(
        {"particles": rb.Particles(material="steel", diameter="4 mm", count=2), "friction": rb.Mindlin(coefficient=0.3)}
    )
    modulus = STEEL.young / (2 * (1 - STEEL.poisson**2))
    shear = STEEL.young / (2 * (1 + STEEL.poisson)) / (2 * (2 - STEEL.poisson))
    radius, mass = 1e-3, 0.5 * 4 / 3 * math.pi * 2e-3**3 * STEEL.density
    stiffness = 4 / 3 * modulus * math.sqrt(radius)
    deepest = (5 * mass * speed**2 / (4 * stiffness)) ** 0.4
    frequency = math.sqrt(7 / 2 * 8 * shear * math.sqrt(radius * deepest) / mass)
    step = choose_step(made, tables(made), (speed,))
    assert step.shortest.bound == pytest.approx(1.2 / frequency, rel=1e-6)
    assert step.shortest.bound < 0.2 * step.shortest.duration


def test_a_sweep_needs_the_step_of_its_highest_frequency() -> None:
    """Up or down, a sine sweep to 300 Hz has the step of a harmonic load of 300 Hz."""
    ends = {"amplitude": "1 N", "duration": "1 s"}
    loads = [
        rb.Harmonic(amplitude="1 N", frequency="300 Hz"),
        rb.SineSweep(**ends, first_frequency="10 Hz", last_frequency="300 Hz"),
        rb.SineSweep(**ends, first_frequency="300 Hz", last_frequency="10 Hz"),
    ]
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="4 mm", count=1),
        cavity=rb.Box(size=("20 mm",) * 3),
        contact=rb.Tsuji(restitution=0.5),
        softening=1e6,
    )
    structure = rb.SDOF(mass="1 kg", frequency="5 Hz", damping_ratio=0.01)
    cases = [
        rb.Case(structure=structure, damper=damper, load=load, duration="20 ms", output=rb.Output(rate="50 Hz"))
        for load in loads
    ]
    steps = [rb.simulate(case).diagnostics["longest_automatic_step"] for case in cases]
    assert steps[0] == pytest.approx(1 / 300 / 40, rel=0.01)
    assert steps[1:] == [steps[0]] * 2
