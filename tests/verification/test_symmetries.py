"""Invariance under reflections, units, order of balls, restarts, threads and processes."""

import hashlib
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support import impact_cases, known_impacts

import rattlebox as rb

TIMES = np.linspace(0, 0.5, 101)


def short(sign: float = 1.0) -> Any:
    """Return the reference case with the ball off centre, or its mirror image."""
    return impact_cases.reference_case(start=0.3 * sign, force=5000.0 * sign, duration=0.5, times=TIMES)


def row(sign: float = 1.0, order: int = 1) -> Any:
    """Return two unequal balls in a row, or their mirror image."""
    balls = [rb.Sphere(radius=6e-3, material="steel"), rb.Sphere(radius=4e-3, material="brass")]
    start = [-0.4, 0.5]
    if order < 0:
        balls, start = balls[::-1], [-s for s in start[::-1]]
    return rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=4e3, damping=0.3),
        damper=rb.ImpactDamper(balls=balls, gap=0.4e-3, start=start, contact=rb.Tsuji(restitution=0.8)),
        load=rb.HalfSine(amplitude=200.0 * sign, duration=1e-3),
        duration=0.3,
        output=rb.Output(times=list(np.linspace(0, 0.3, 61))),
    )


def test_mirrored_case_is_the_mirrored_run() -> None:
    """With reversed start and pulse the motion changes its sign bit for bit."""
    a, b = known_impacts.simulate(short()).arrays, known_impacts.simulate(short(-1.0)).arrays
    assert np.array_equal(a.displacement, -b.displacement)
    assert np.array_equal(a.ball_position, -b.ball_position)
    assert np.array_equal(a.impacts.time, b.impacts.time)
    assert np.array_equal(a.impacts.contact, 1 - b.impacts.contact)


def test_row_counted_from_the_other_end_is_the_mirrored_run() -> None:
    """A row in reverse order under the reverse pulse moves as the mirror image, up to rounding."""
    a, b = known_impacts.simulate(row()).arrays, known_impacts.simulate(row(-1.0, -1)).arrays
    assert len(a.impacts) > 5
    early = a.impacts.time < 0.1
    assert a.impacts.time[early] == pytest.approx(b.impacts.time[early], rel=1e-8)
    assert np.array_equal(a.impacts.contact[early], 2 - b.impacts.contact[early])
    k = int(np.searchsorted(a.time, 0.1))
    assert np.abs(a.displacement[:k] + b.displacement[:k]).max() <= 1e-9 * np.abs(a.displacement).max()
    centred = a.relative_position[:k, ::-1] + b.relative_position[:k]
    assert np.abs(centred).max() <= 1e-8 * np.abs(a.relative_position).max()


@pytest.mark.parametrize("exact", [True, False], ids=["powers of two", "any factor"])
def test_rescaled_units_give_the_rescaled_run(exact: bool) -> None:
    """Length, mass and time in other units give the same run: no dimensional constant is hidden."""
    length, mass, time = (2.0**4, 2.0**-6, 2.0**2) if exact else (3.7, 0.21, 1.9)
    force = mass * length / time**2

    def scaled(length: float, mass: float, time: float, force: float) -> Any:
        return rb.Case(
            structure=rb.SDOF(mass=20.0 * mass, stiffness=80e3 * mass / time**2, damping=25.3 * mass / time),
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius=0.03317 * length, material="steel", mass=1.2 * mass),
                gap=0.4e-3 * length,
                contact=rb.Linear(stiffness=1e8 * mass / time**2, restitution=0.9),
            ),
            load=rb.HalfSine(amplitude=5000.0 * force, duration=1e-3 * time),
            duration=0.4 * time,
            output=rb.Output(times=list(np.linspace(0, 0.4, 41) * time)),
        )

    a = known_impacts.simulate(scaled(1, 1, 1, 1)).arrays
    b = known_impacts.simulate(scaled(length, mass, time, force)).arrays
    assert len(a.impacts) == len(b.impacts) > 10
    assert b.impacts.time[:30] / time == pytest.approx(a.impacts.time[:30], rel=1e-9)
    assert np.abs(b.displacement / length - a.displacement).max() <= 1e-8 * np.abs(a.displacement).max()


def test_run_split_in_a_flight_is_the_whole_run() -> None:
    """A run ended in a flight and continued from its last state agrees with the uninterrupted one."""
    log = known_impacts.simulate(impact_cases.reference_case(duration=0.3, times=[0.0])).arrays.impacts
    middles = 0.5 * (log.time[:-1] + log.duration[:-1] + log.time[1:])
    whole = known_impacts.simulate(impact_cases.reference_case(duration=0.3, times=middles)).arrays
    # A flight that has the ball near the place where the cavity is at rest, as a start asks for.
    near = np.abs(whole.ball_position[1:-1, 0]) < 0.39e-3
    number = int(np.nonzero(near[4:])[0][0]) + 4
    split = float(middles[number])
    first = known_impacts.simulate(impact_cases.reference_case(duration=split, times=[0.0])).arrays
    second = known_impacts.simulate(
        rb.Case(
            structure=rb.SDOF(
                mass=20.0,
                stiffness=80e3,
                damping=25.3,
                displacement=float(first.displacement[-1, 0]),
                velocity=float(first.velocity[-1, 0]),
            ),
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius=0.03317, material="steel"),
                gap=0.4e-3,
                start=float(first.ball_position[-1, 0] - first.displacement[-1, 0]) / 0.4e-3,
                velocity=float(first.ball_velocity[-1, 0]),
                contact=rb.Tsuji(alpha=0.006313, ending="zero_overlap"),
            ),
            duration=0.3 - split,
        )
    ).arrays
    assert len(first.impacts) == number + 1
    assert second.impacts.time + split == pytest.approx(log.time[number + 1 :], rel=1e-11)
    assert second.impacts.approach_speed == pytest.approx(log.approach_speed[number + 1 :], rel=1e-8)
    assert second.displacement[-1, 0] == pytest.approx(whole.displacement[-1, 0], abs=1e-12)


def test_output_times_do_not_change_the_run() -> None:
    """The bits of the impacts do not depend on the output."""
    few = known_impacts.simulate(impact_cases.reference_case(duration=1.0, times=[0.0])).arrays.impacts
    many = known_impacts.simulate(
        impact_cases.reference_case(duration=1.0, times=np.linspace(0, 1, 5001))
    ).arrays.impacts
    assert few == many


def fingerprint() -> str:
    """Return a digest of the bits of some runs."""
    digest = hashlib.sha256()
    for case in (impact_cases.reference_case(duration=1.0), row(), impact_cases.five_balls(0.3)):
        a = rb.simulate(case).arrays
        for values in (a.displacement, a.ball_position, a.impacts.time, a.normal_loss):
            digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


def test_other_process_gives_the_same_bits() -> None:
    """Another process computes the same bits."""
    folder = Path(__file__).resolve().parents[1]
    code = (
        "import sys, importlib; sys.path.insert(0, sys.argv[1]);"
        "print(importlib.import_module('verification.test_symmetries').fingerprint())"
    )
    done = subprocess.run([sys.executable, "-c", code, str(folder)], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == fingerprint()


def test_threads_give_the_same_bits() -> None:
    """Many runs have the same bits on one thread, on two threads and one by one, in the order of the cases."""
    group = [impact_cases.reference_case(start=s, duration=0.5, times=TIMES) for s in np.linspace(-0.9, 0.9, 16)]
    one, two = rb.simulate_many(group, threads=1), rb.simulate_many(group, threads=2)
    for case, a, b in zip(group, one, two, strict=True):
        alone = rb.simulate(case).arrays
        for run in (a, b):
            assert np.array_equal(run.arrays.displacement, alone.displacement)
            assert run.arrays.impacts == alone.impacts
