"""Hard contacts at rest: they follow the wall exactly, for an hour, lift off when they must, and never overlap."""

from typing import Any

import numpy as np
import pytest
from support import impact_cases

import rattlebox as rb

G = 9.79
"""Gravity [m/s^2]."""
RATE = 2 * np.pi * 17
"""Angular frequency of the table [rad/s]."""


def table(amplitude: float, e: float, duration: float, **output: Any) -> Any:
    """Run a ball that starts at rest on the floor of a cavity on a table shaken with this acceleration [m/s^2]."""
    return rb.simulate(
        rb.Case(
            structure=rb.Shaker(motion=rb.Harmonic(amplitude=amplitude, frequency=17.0, unit="m/s^2")),
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius=7e-3, material="brass"),
                gap=6e-3,
                start=-1,
                gravity=-G,
                contact=rb.Tsuji(restitution=0.5),
            ),
            duration=duration,
            method=rb.Newton(restitution=e),
            output=rb.Output(**(output or {"rate": 2.0})),
        )
    )


@pytest.mark.parametrize("share", [0.5, 0.999, 1.0])
def test_ball_at_rest_on_a_table_for_an_hour_does_not_move(share: float) -> None:
    """A ball on a table that is shaken with at most 1 g stays on the floor for an hour, to the last bit, and finishes.

    No test of a stuck contact was longer than 5 s: each step added its rounding to the speed of the ball, and after an hour
    the sum was all the energy there was.
    """
    run = table(share * G, 0.5, 3600.0)
    assert run.ok, run.message
    assert len(run.arrays.impacts) == 0
    assert np.ptp(run.arrays.relative_position) == 0
    assert not run.arrays.relative_velocity.any()


def flight_of_a_lifted_ball(amplitude: float) -> tuple[float, float]:
    """Return the times in a cycle at which the floor lets the ball go and meets it again, and the phase of the load is 0.

    The relative acceleration is -G - amplitude sin(RATE t), where the frame of the table is accelerated by the sine.
    """
    from scipy.optimize import brentq

    start = (np.pi + np.arcsin(G / amplitude)) / RATE  # sin = -G / amplitude, decreasing

    def gap(t: float) -> float:
        s = t - start
        slope = amplitude / RATE * np.cos(RATE * start)
        return float(-0.5 * G * s**2 + amplitude / RATE**2 * (np.sin(RATE * t) - np.sin(RATE * start)) - slope * s)

    return start, float(brentq(gap, start + 2.5 * (1.5 * np.pi / RATE - start), start + np.pi / RATE, xtol=1e-15))


@pytest.mark.parametrize("share", [1.0002, 1.003, 1.1])
def test_ball_lifts_off_in_every_cycle_above_one_g(share: float) -> None:
    """Just above 1 g the floor lets the ball go in every cycle for ten minutes, and meets it at the time of the equation.

    The sign of the force of a stuck contact was looked at at the ends of steps of a quarter radian: it could be attractive
    within one. The tests of the table lifted the ball for longer.
    """
    amplitude = share * G
    run = table(amplitude, 0.0, 600.0)
    assert run.ok, run.message
    log = run.arrays.impacts
    cycles = 600 * 17
    _, landing = flight_of_a_lifted_ball(amplitude)
    expected = landing + np.arange(cycles) / 17
    expected = expected[expected < 600]
    assert len(log) == len(expected)
    # The speed grows like the square of the time in flight, so that the equation has a double root.
    assert np.abs(log.time - expected).max() < 1e-6 / 17


def overlap(run: Any) -> float:
    """Return the largest overlap of walls and balls in the samples of a run [m]."""
    a = run.arrays
    place, deepest = a.relative_position - a.ball_centre, 0.0
    for d, clearance in enumerate(a.clearance):
        own = place[:, a.ball_damper == d]
        gaps = np.hstack([own[:, :1] + clearance / 2, np.diff(own, axis=1), clearance / 2 - own[:, -1:]])
        deepest = max(deepest, -float(gaps.min()))
    return deepest


def check_overlaps(seeds: range) -> None:
    """Check that hard bodies overlap by no more than the rounding of their positions and of the time of a touch."""
    cases = [impact_cases.hard_dampers(np.random.default_rng(seed)) for seed in seeds]
    cases += [impact_cases.hard_row(np.random.default_rng(seed), 2 + seed % 4) for seed in seeds]
    for number, run in enumerate(rb.simulate_many(cases, threads=2)):
        assert run.ok, f"{number}: {run.message}"
        length = np.abs(run.arrays.ball_position).max() + run.arrays.clearance.max()
        length += np.abs(run.arrays.ball_velocity).max() * run.case.duration
        assert overlap(run) <= 8 * np.finfo(float).eps * length, f"{number}: {overlap(run)}"


def test_hard_bodies_never_overlap() -> None:
    """Hard balls that stick, are released and chatter in several cavities never overlap by more than rounding.

    Overlaps were compared with the drift of speeds over the whole run, in rows only; contacts that touch while others are
    stuck were followed by steps that looked at their ends, and overlapped by a micrometre within one.
    """
    check_overlaps(range(70, 110))


@pytest.mark.slow
def test_hard_bodies_of_two_thousand_runs_never_overlap() -> None:
    """The same for 2000 runs."""
    for first in range(1000, 2000, 100):
        check_overlaps(range(first, first + 100))


@pytest.mark.parametrize("offset", [0.0, 1e-12])
def test_a_graze_grows_like_a_square_root(offset: float) -> None:
    """Impacts of a ball that the walls of a vibrating cavity just graze grow as the law of the square root says.

    Nobody had looked at an exact graze: its growth from rounding is that of the model, and stated as a limit.
    """
    amplitude, e, rate = 0.8e-3, 0.4, 2 * np.pi * 15
    run = rb.simulate(
        rb.Case(
            structure=rb.Shaker(motion=rb.Harmonic(amplitude=amplitude, frequency=15.0, phase="90 deg", unit="m")),
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius=8e-3, material="steel"),
                gap=amplitude * (1 - offset),
                start=-1,
                contact=rb.Tsuji(restitution=0.5),
            ),
            duration=0.3,
            method=rb.Newton(restitution=e),
        )
    )
    assert run.ok
    speed = run.arrays.impacts.approach_speed
    grown = speed[(speed > 0) & (speed < 2e-3)]
    assert 1 <= len(grown) <= 4
    scale = (1 + e) * amplitude * rate**2 * 2 * np.pi / rate
    first = int(np.flatnonzero(speed == grown[0])[0])
    for k in range(first, first + len(grown)):
        assert speed[k + 1] == pytest.approx(np.sqrt(scale * speed[k]), rel=0.2)
