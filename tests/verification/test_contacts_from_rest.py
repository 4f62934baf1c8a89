"""Contacts that close from rest at speeds below rounding errors do not stall the integration."""

from typing import Any

import pytest

import rattlebox as rb

STEEL = rb.Sphere(radius="5 mm", material="steel")
GLASS = rb.Sphere(radius="5 mm", material="glass")
LARGE = rb.Sphere(radius="10 mm", material="glass")
PULSE = rb.HalfSine(amplitude="50 N", duration="2 ms")


def packed(balls: list[Any], contact: Any, duration: str, gravity: str = "0 m/s^2", **case: Any) -> Any:
    """Run balls packed in a cavity without clearance, with a low limit of events."""
    return rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass="1 kg", stiffness="1e4 N/m"),
            damper=rb.ImpactDamper(balls=balls, gap=0, gravity=gravity, contact=contact),
            duration=duration,
            method=rb.EventDriven(max_events=300),
            output=rb.Output(rate="1 kHz"),
            **case,
        )
    )


@pytest.mark.parametrize(
    "base",
    [
        rb.Harmonic(amplitude="5 m/s^2", frequency="20 Hz"),
        rb.Record(times=[0, 0.1], values=[0, 30], unit="m/s^2"),
    ],
    ids=lambda base: base.kind,
)
def test_a_ball_without_play_follows_a_base_that_moves_off_gently(base: Any) -> None:
    """A contact without closing force at first is integrated in a few thousand steps, whichever motion follows."""
    run = packed([STEEL], rb.Tsuji(restitution=0.9), "50 ms", base=base)
    assert run.ok, run.message
    assert run.counts["contact_steps"] < 10_000


@pytest.mark.parametrize(
    ("balls", "restitution", "load"),
    [
        ([STEEL] * 3, 0.05, PULSE),
        ([STEEL, GLASS, LARGE], 0.5, PULSE),
        ([STEEL, GLASS, LARGE], 0.05, None),
    ],
)
def test_packed_rows_close_once(balls: list[Any], restitution: float, load: Any) -> None:
    """Rounding errors of neighbours in a row cause no events."""
    run = packed(balls, rb.Tsuji(restitution=restitution), "3 ms", gravity="-9.81 m/s^2", load=load)
    assert run.ok, run.message
    assert run.counts["events"] < 20


@pytest.mark.parametrize("other", [rb.Tsuji(restitution=1), rb.Linear(stiffness="1e6 N/m", restitution=1)])
def test_residual_overlaps_are_reached_again_in_a_few_steps(other: Any) -> None:
    """Balls that return to a residual overlap use steps of the size of the remaining distance, however small it is."""
    damper = rb.ImpactDamper(balls=[STEEL] * 2, gap="10 um", start=1, contact=rb.Thornton(yield_pressure="1 GPa"))
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass="0.5 kg", stiffness=0, velocity="1.5 m/s"),
            dampers=[damper, rb.ImpactDamper(ball=GLASS, gap="10 um", start=0.3, contact=other)],
            duration="20 ms",
            method=rb.EventDriven(max_events=400),
            output=rb.Output(rate="1 kHz"),
        )
    )
    counts = run.counts
    assert counts["contact_steps"] < 100 * counts["events"]


def test_balls_that_lie_on_a_wall_at_a_distance_are_pressed_at_once() -> None:
    """A contact that closes from rest begins also if its overlap is below the rounding error of the positions."""
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass="1 kg", stiffness="1e3 N/m"),
            damper=rb.ImpactDamper(
                balls=[STEEL, GLASS, STEEL], gap="10 mm", start=-1, contact=rb.Tsuji(restitution=0.05)
            ),
            base=rb.Record(times=[0, 0.1], values=[0, 30], unit="m/s^2"),
            duration="50 ms",
            method=rb.EventDriven(max_events=1000),
        )
    )
    assert run.ok, run.message
    assert run.counts["flights"] < 20


def test_a_row_that_is_struck_does_not_stop_the_clock() -> None:
    """A row without clearance that a moving wall hits has overlaps and speeds that underflow at first."""
    steel, alike = rb.Sphere(radius="10 mm", material="steel"), rb.Tsuji(alpha=0, ending="zero_force")
    run = rb.simulate(
        rb.Case(
            structure=rb.Modal(frequencies=[20], damping_ratios=[0], shapes={"b": [-0.5]}, velocity=[0.19]),
            dampers=[
                rb.ImpactDamper(balls=[steel] * 2, gap="10 mm", start=1, gravity=9.81, contact=alike, point="b"),
                rb.ImpactDamper(
                    balls=[steel, GLASS, LARGE], gap=0, start=-1, contact=rb.Thornton(yield_pressure="1 GPa"), point="b"
                ),
            ],
            load=rb.Harmonic(amplitude=1.0, frequency=50.0, point="b"),
            duration="1 ms",
            method=rb.EventDriven(max_events=1000),
        )
    )
    assert run.ok, run.message
    assert abs(run.energy_residual) < 1e-11


def test_a_slow_contact_of_fast_bodies_takes_few_steps() -> None:
    """The error tolerance is not below the rounding errors of velocities: 1 m/s each, 0.1 nm/s relative."""
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass="1 kg", stiffness=0, velocity=1.0),
            damper=rb.ImpactDamper(
                ball=GLASS, gap="1 pm", velocity=1.0 + 1e-10, contact=rb.Linear(stiffness="1e6 N/m", restitution=0.5)
            ),
            duration="20 ms",
            output=rb.Output(rate="1 kHz"),
        )
    )
    assert run.ok, run.message
    assert run.arrays.impacts.time.size > 0
    assert run.counts["contact_steps"] < 1000


def test_a_released_contact_closes_again_only_where_rounding_can_tell() -> None:
    """A force near zero in a row without clearance does not close and release a contact repeatedly at the same time."""
    steel = rb.Sphere(radius="10 mm", material="steel")
    run = rb.simulate(
        rb.Case(
            structure=rb.Modal(
                frequencies=[800],
                damping_ratios=[1.0000001],
                shapes={"a": [0.284225183454787], "b": [-1.1945206106624247]},
                velocity=[0.9883219647988619],
            ),
            dampers=[
                rb.ImpactDamper(
                    balls=[STEEL] * 2,
                    gap=0,
                    start=-1,
                    contact=rb.Linear(stiffness="1e6 N/m", restitution=0.5, ending="zero_force"),
                    point="b",
                ),
                rb.ImpactDamper(
                    ball=steel,
                    gap="10 mm",
                    gravity=-9.81,
                    contact=rb.Tsuji(restitution=0.05, ending="zero_force"),
                    point="a",
                ),
            ],
            load=rb.Harmonic(amplitude="1 N", frequency="5 Hz", stop="0.1 s", point="b"),
            duration="0.3 s",
            method=rb.EventDriven(max_events=5000),
        )
    )
    assert run.ok, run.message
    assert run.counts["events"] < 2000
    assert abs(run.energy_residual) < 1e-11


def test_a_contact_that_recovers_is_not_taken_for_one_that_closes() -> None:
    """A ball that leaves one wall and touches the other within the resolution of time has both contacts."""
    steel, plastic = rb.Sphere(radius="10 mm", material="steel"), rb.Thornton(yield_pressure="1 GPa")
    run = rb.simulate(
        rb.Case(
            structure=rb.Modal(
                frequencies=[20, 20, 800],
                damping_ratios=[0.01, 0.5, 0.5],
                shapes={"a": [0.3083576460840023, 0.15771052533551524, 1.8039522371176606]},
                participation=[0.17372190802429174, -0.9792207201295954, -0.5984246849184236],
            ),
            dampers=[
                rb.ImpactDamper(ball=GLASS, gap=0, start=1, contact=plastic, point="a"),
                rb.ImpactDamper(balls=[steel] * 2, gap="1 mm", start=0.3, gravity=9.81, contact=plastic, point="a"),
            ],
            load=rb.HalfSine(amplitude="50 N", duration="2 ms", point="a"),
            base=rb.Harmonic(amplitude="5 m/s^2", frequency="20 Hz"),
            duration="40 ms",
            method=rb.EventDriven(max_events=2000),
        )
    )
    assert run.ok, run.message
    assert abs(run.energy_residual) < 1e-11


@pytest.mark.parametrize("start", ["0 ms", "3 ms"])
@pytest.mark.parametrize(
    "contact",
    [
        rb.Tsuji(restitution=0.9),
        rb.Tsuji(restitution=rb.JacksonGreen(wall="rigid"), ending="zero_overlap"),
        rb.Thornton(yield_pressure="1 GPa"),
        rb.Linear(stiffness="1e7 N/m", restitution=0.8),
    ],
    ids=lambda law: law.kind,
)
def test_a_contact_begins_when_the_load_begins_to_rise(contact: Any, start: str) -> None:
    """The contact of a ball at rest on a wall begins when the load begins, not when its force is significant."""
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass="20 kg", stiffness="80 kN/m"),
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius="33 mm", material="steel"), gap="0.4 mm", start=-1, contact=contact
            ),
            load=rb.HalfSine(amplitude="5 kN", duration="1 ms", start=start),
            duration="20 ms",
        )
    )
    impacts = run.arrays.impacts
    assert impacts.time[0] == {"0 ms": 0.0, "3 ms": 0.003}[start]
    assert impacts.approach_speed[0] == 0
    assert run.energy_residual < 1e-11


def test_a_packed_row_is_pressed_at_once_from_end_to_end() -> None:
    """In a row without clearance every contact begins with the load, each with a higher power of time."""
    run = packed([STEEL] * 3, rb.Tsuji(restitution=0.9), "3 ms", load=rb.HalfSine(amplitude="5 kN", duration="1 ms"))
    impacts = run.arrays.impacts
    assert impacts.contact[:3].tolist() == [0, 1, 2]
    assert impacts.time[:3].tolist() == [0, 0, 0]


def test_a_contact_that_is_pressed_late_begins_late() -> None:
    """A ball at rest on a wall, while another one bounces, is loaded when a pulse acts on the structure."""
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass="1 kg", stiffness=0),
            dampers=[
                rb.ImpactDamper(ball=STEEL, gap="1 mm", start=-1, contact=rb.Tsuji(restitution=0.9)),
                rb.ImpactDamper(ball=STEEL, gap="1 mm", velocity="1 m/s", contact=rb.Tsuji(restitution=0.9)),
            ],
            duration="1.5 ms",
        )
    )
    struck, pressed = run.arrays.impacts.time[:2]
    assert struck == pytest.approx(1e-3)
    assert struck <= pressed < struck + 1e-6
