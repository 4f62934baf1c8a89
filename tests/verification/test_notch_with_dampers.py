"""A level that is notched for a structure with dampers keeps its limit when it is run, and no more than the limit asks for.

Earlier tests notched linear structures only, whose apparent mass does not change with the level.
"""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
import pytest
from support import particle_dampers

import rattlebox as rb
from rattlebox.analysis import notch
from rattlebox.analysis.signals import first_harmonic, trapezoid_weights

LIMIT = 260.0
PROFILE = [("45 Hz", "1.2 g"), ("150 Hz", "1.2 g")]


def case(**changes: Any) -> rb.Case:
    """Return a box with a ball on a shaker."""
    parts: dict[str, Any] = {
        "structure": rb.SDOF(mass="4 kg", frequency="80 Hz", damping_ratio=0.025),
        "damper": rb.ImpactDamper(
            ball=rb.Sphere(diameter="36 mm", material="steel"), gap="0.4 mm", contact=rb.Tsuji(restitution=0.45)
        ),
        "duration": "1 s",
    }
    return rb.Case(**(parts | changes))


def force_at(damped: rb.Case, frequency: float, amplitude: float) -> float:
    """Return the amplitude of the force on the base in steady vibration."""
    base = rb.Harmonic(amplitude=amplitude, frequency=frequency)
    run = rb.simulate(
        damped.replaced({"base": base, "duration": 90 / frequency, "output": rb.Output(rate=80 * frequency)})
    )
    assert run.ok
    weights = trapezoid_weights(run.arrays.time, run.arrays.time[-1] - 30 / frequency)
    return abs(first_harmonic(run.arrays.time, run.arrays.interface_force, weights, frequency))


def test_the_notched_sine_level_keeps_the_limit() -> None:
    """Run at the new level, the force is within 0.5 dB of the limit in the notch and below it elsewhere."""
    damped = case()
    found = rb.notch_with_dampers(PROFILE, damped, force=LIMIT, tolerance=0.3, progress=False)
    bare = notch(PROFILE, damped.replaced({"dampers": ()}), force=LIMIT)
    assert found.levels.attrs["difference"] <= 0.3
    assert 0 < found.depth < bare.depth - 1  # the ball needs a shallower notch
    levels = found.levels
    inside = np.flatnonzero(levels.notch.values < -1.0)
    for index in (inside[inside.size // 4], inside[inside.size // 2], inside[3 * inside.size // 4], 0, -1):
        reached = force_at(damped, float(levels.frequency[index]), float(levels.after[index]))
        if index in inside:
            assert 20 * abs(math.log10(reached / LIMIT)) < 0.6
        assert reached < LIMIT * 10 ** (0.6 / 20)
    assert force_at(damped, float(levels.frequency[inside[0]]), 1.2 * 9.80665) > LIMIT


@pytest.mark.parametrize("damped", [False, True])
def test_without_nonlinearity_it_is_the_linear_notch(damped: bool) -> None:
    """Without a damper, or with a ball that touches nothing, the notch is that of the apparent mass."""
    far = rb.ImpactDamper(
        ball=rb.Sphere(diameter="6 mm", material="steel"), gap="90 mm", contact=rb.Tsuji(restitution=0.5)
    )
    linear = case(damper=far) if damped else case().replaced({"dampers": ()})
    found = rb.notch_with_dampers(PROFILE, linear, force=LIMIT, progress=False)
    exact = notch(PROFILE, linear.replaced({"dampers": ()}), force=LIMIT)
    assert found.depth == pytest.approx(exact.depth, abs=0.1)
    assert found.frequency == pytest.approx(exact.frequency, rel=0.01)


def bed(**changes: Any) -> rb.ParticleDamper:
    """Return a box with spheres that rest on its floor."""
    usual: dict[str, Any] = {
        "particles": particle_dampers.balls(8, diameter="8 mm"),
        "cavity": rb.Box(size=("40 mm", "30 mm", "20 mm")),
        "contact": rb.Tsuji(restitution=0.5),
        "packing": rb.Settled(seed=2),
        "softening": 1000,
    }
    return particle_dampers.damper(**(usual | changes))


def test_particles_that_touch_nothing() -> None:
    """A sphere that floats in its box changes nothing.

    The tests had impact dampers alone: none saw that a case of particles kept its method without them and was refused.
    """
    floating = bed(
        particles=rb.Particles(material="steel", diameter="1 mm", count=1),
        packing=rb.Positions(positions=[[0.0, 0.0, 0.0]]),
        gravity=(0, 0, 0),
    )
    structure = rb.SDOF(mass="3 kg", frequency="70 Hz", damping_ratio=0.08)
    damped = rb.Case(structure=structure, damper=floating, duration="1 s")
    profile = [("60 Hz", "0.5 g"), ("80 Hz", "0.5 g")]
    found = rb.notch_with_dampers(profile, damped, force="60 N", cycles=(30, 5), progress=False)
    exact = notch(profile, damped.without_dampers(), force="60 N")
    assert found.levels.attrs["difference"] < 0.1
    assert found.depth == pytest.approx(exact.depth, abs=0.1) and exact.depth > 2


def test_particles_keep_the_limit() -> None:
    """With a bed that slides, the level is notched less than without it, and its force is at the limit at the resonance."""
    structure = rb.SDOF(mass="0.2 kg", frequency="50 Hz", damping_ratio=0.02)
    damped = rb.Case(structure=structure, damper=bed(), duration="1 s")
    profile = [("44 Hz", "1 g"), ("54 Hz", "1 g")]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # few rounds
        found = rb.notch_with_dampers(profile, damped, force="8 N", cycles=(25, 15), rounds=4, progress=False)
    bare = notch(profile, damped.without_dampers(), force="8 N")
    assert 0 < found.depth < bare.depth - 1
    levels = found.levels
    worst = int(np.argmin(levels.notch.values))
    frequency = float(levels.frequency[worst])
    base = rb.Harmonic(amplitude=float(levels.after[worst]), frequency=frequency)
    run = rb.simulate(
        damped.replaced({"base": base, "duration": 40 / frequency, "output": rb.Output(rate=64 * frequency)})
    )
    weights = trapezoid_weights(run.arrays.time, run.arrays.time[-1] - 15 / frequency)
    force = abs(first_harmonic(run.arrays.time, run.along("x").interface_force.values, weights, frequency))
    assert force == pytest.approx(8, rel=0.1)


def test_particles_under_random_vibration() -> None:
    """The rounds run and reach the limit of the RMS force, since a level is chosen by the force that a bed has at it."""
    structure = rb.SDOF(mass="0.2 kg", frequency="50 Hz", damping_ratio=0.02)
    damped = rb.Case(structure=structure, damper=bed(), duration="1 s")
    shaking = rb.Random([("20 Hz", "0.01 g^2/Hz"), ("100 Hz", "0.01 g^2/Hz")], "4 s", seed=5)
    found = rb.notch_with_dampers(shaking, damped, force_rms="4 N", tolerance=20, rounds=3, progress=False)
    assert found.levels.attrs["reached"] == pytest.approx(1.0, abs=0.3)


def test_random_vibration() -> None:
    """Under random vibration the RMS force of a run at the new level is near its limit, with a sweep of the same seed."""
    damped = case()
    shaking = rb.Random([("20 Hz", "0.02 g^2/Hz"), ("400 Hz", "0.02 g^2/Hz")], "12 s", seed=5)
    found = rb.notch_with_dampers(shaking, damped, force_rms="120 N", tolerance=2.0, progress=False)
    assert found.levels.attrs["reached"] == pytest.approx(1.0, abs=0.15)
    output = rb.Output(rate="8 kHz")
    run = rb.simulate(damped.replaced({"base": found.profile, "duration": "12 s", "output": output}))
    assert run.arrays.interface_force.std() == pytest.approx(120, rel=0.15)


def test_levels_that_do_not_settle_warn() -> None:
    """After the last round a difference above the tolerance is stated, not hidden."""
    with pytest.warns(UserWarning, match="the notch has not settled: after 1 rounds"):
        found = rb.notch_with_dampers(PROFILE, case(), force=LIMIT, tolerance=0.01, rounds=1, progress=False)
    assert found.levels.attrs["difference"] > 0.01


@pytest.mark.parametrize(
    ("changes", "options", "words"),
    [
        ({"load": rb.Harmonic(amplitude="1 N", frequency="50 Hz")}, {"force": LIMIT}, "has loads"),
        ({}, {"force": LIMIT, "tolerance": 0}, "tolerance"),
        ({}, {"force_rms": LIMIT}, "a sine profile needs one limit"),
        ({}, {"force": LIMIT, "rounds": 0}, "rounds"),
    ],
)
def test_wrong_arguments(changes: dict[str, Any], options: dict[str, Any], words: str) -> None:
    """Arguments that do not fit are refused before anything runs."""
    with pytest.raises(rb.CaseError, match=words):
        rb.notch_with_dampers(PROFILE, case(**changes), progress=False, **options)
