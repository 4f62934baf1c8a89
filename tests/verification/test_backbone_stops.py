"""Backbones of structures with stops against the exact free vibration between them.

Backbones refused stops before: at phase resonance the motion is next to a fold, and a search fell beside it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import rattlebox as rb

MASS, FIRST, GAP = 1.4, 2 * math.pi * 8.0, 2e-3
STIFFNESS = MASS * FIRST**2


def held(ratio: float, **changes: Any) -> rb.Case:
    """Return an oscillator between two linear, elastic stops, whose stiffness is a multiple of its own."""
    law = rb.Linear(stiffness=STIFFNESS * ratio, restitution=1.0)
    parts: dict[str, Any] = {
        "structure": rb.SDOF(mass=MASS, stiffness=STIFFNESS, damping_ratio=0.015),
        "stop": rb.Stop(gap=GAP, side="both", contact=law),
        "load": rb.Harmonic(amplitude="1 N", frequency="8 Hz"),
        "duration": "1 s",
    }
    return rb.Case(**(parts | changes))


def free_vibration(ratio: float, peak: float) -> tuple[float, float]:
    """Return frequency and amplitude of the first harmonic of the free undamped vibration with a peak [m]."""
    inner, outer = FIRST, FIRST * math.sqrt(1 + ratio)
    centre = ratio * GAP / (1 + ratio)
    swing = peak - centre
    speed = outer * math.sqrt(swing**2 - (GAP - centre) ** 2)  # at the stop
    fastest = math.hypot(speed, inner * GAP)
    before, after = math.atan2(inner * GAP, speed) / inner, math.acos((GAP - centre) / swing) / outer
    quarter = before + after
    time = np.linspace(0, quarter, 20001)
    motion = np.where(
        time < before, fastest / inner * np.sin(inner * time), centre + swing * np.cos(outer * (quarter - time))
    )
    first = 2 / quarter * np.trapezoid(motion * np.sin(math.pi / 2 * time / quarter), time)
    return 1 / (4 * quarter), float(first)


@pytest.mark.parametrize("ratio", [0.6, 2.0, 6.0])
def test_the_frequency_is_that_of_the_free_vibration(ratio: float) -> None:
    """The frequency of phase resonance is that of the free vibration with the same first harmonic."""
    peaks = np.array([1.3, 2.0, 4.0]) * GAP
    exact = [free_vibration(ratio, peak) for peak in peaks]
    amplitudes = [0.5 * GAP, *(amplitude for _, amplitude in exact)]
    found = rb.backbone(held(ratio), amplitudes, progress=False)
    assert found.found.all()
    np.testing.assert_allclose(found.frequency, [8.0, *(frequency for frequency, _ in exact)], rtol=3e-3)
    # The damping of the structure is all: it is divided by a frequency that rises.
    np.testing.assert_allclose(found.damping_ratio, 0.015 * 8.0 / found.frequency, rtol=0.02)


@pytest.mark.parametrize(
    "contact",
    [
        rb.Linear(stiffness=2 * STIFFNESS, restitution=0.6),
        rb.PowerLaw(stiffness=4e5, exponent=1.5, restitution=0.8, impact_speed="0.2 m/s"),
    ],
    ids=["linear", "power"],
)
def test_a_run_at_the_resonance_has_the_amplitude(contact: Any) -> None:
    """A run just below the resonance that is found has nearly the amplitude, with stops that lose energy."""
    case = held(1.0, stop=rb.Stop(gap=GAP, side="both", contact=contact))
    level = 1.6 * GAP
    found = rb.backbone(case, [0.8 * GAP, level], progress=False).isel(amplitude=1)
    assert found.found.all()
    frequency, force = 0.985 * float(found.frequency), float(found.force)
    start = rb.SDOF(mass=MASS, stiffness=STIFFNESS, damping_ratio=0.015, velocity=2 * math.pi * frequency * level)
    load = rb.Harmonic(amplitude=force, frequency=frequency, phase=math.pi / 2)
    run = rb.simulate(case.replaced({"structure": start, "load": load, "duration": 150 / frequency}))
    late = run.arrays.time > 120 / frequency
    assert 0.8 * level < np.abs(run.arrays.displacement[late]).max() < 1.15 * level
    assert float(found.damping_ratio) > 0.015 * 8.0 / float(found.frequency)  # the stops lose energy, too


def test_a_stop_beside_a_ball() -> None:
    """A stop and a ball act in one search: the frequency rises and the damping is that of both."""
    ball = rb.ImpactDamper(
        ball=rb.Sphere(diameter="24 mm", material="steel"), gap="0.5 mm", contact=rb.Tsuji(restitution=0.6)
    )
    found = rb.backbone(held(1.0, damper=ball), [0.7 * GAP, 1.8 * GAP], starts=2, cycles=(150, 60), progress=False)
    alone = rb.backbone(held(1.0), [0.7 * GAP, 1.8 * GAP], starts=1, progress=False)
    assert float(found.damping_ratio[1]) > 1.1 * float(alone.damping_ratio[1])
    assert float(found.frequency[1]) == pytest.approx(float(alone.frequency[1]), rel=0.05)


def test_searches_that_do_not_end_are_counted() -> None:
    """With stops far stiffer than the structure a search may not end, and says so."""
    found = rb.backbone(held(400.0), [0.5 * GAP, 1.4 * GAP], progress=False)
    if not found.found.all():
        assert "no phase resonance was found" in found.attrs["warnings"][0]
