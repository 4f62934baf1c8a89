"""Structures without dampers: every kind of mode under every kind of load against matrix exponentials."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import block_diag, expm

import rattlebox as rb

Array = NDArray[np.float64]
DURATION = 1.0
TIMES = np.linspace(0, DURATION, 81)
MASS, STIFFNESS = 2.0, 8e3
RATE = math.sqrt(STIFFNESS / MASS)
RECORD = (np.linspace(0, 1, 14), np.array([0, 3, -1, 2, 2, -4, 1, 0, 5, -2, 1, 1, -3, 2.0]))
PULSE = {"amplitude": 50.0, "start": 0.1, "duration": 0.05}
STEADY = {"amplitude": 10.0, "frequency": 9.0, "phase": 0.3}
RESONANT = {"amplitude": 10.0, "frequency": RATE / (2 * math.pi), "phase": 0.0}

DAMPINGS: dict[str, dict[str, float]] = {
    "undamped": {"damping_ratio": 0.0},
    "underdamped": {"damping_ratio": 0.05},
    "almost critical": {"damping_ratio": 1 - 1e-9},
    "critical": {"damping_ratio": 1.0},
    "slightly overdamped": {"damping_ratio": 1 + 1e-7},
    "overdamped": {"damping_ratio": 3.0},
    "far overdamped": {"damping_ratio": 50.0},
    "rigid body": {"stiffness": 0.0, "damping": 0.0},
    "rigid body with a dashpot": {"stiffness": 0.0, "damping": 5.0},
}
LOADS: dict[str, Any] = {
    "none": (),
    "half sine": rb.HalfSine(**PULSE),
    "harmonic": rb.Harmonic(**STEADY),
    "resonance": rb.Harmonic(**RESONANT),
    "record": rb.Record(times=RECORD[0], values=RECORD[1], unit="N"),
    "sum": (rb.HalfSine(**PULSE), rb.Harmonic(**STEADY)),
}


Piece = tuple[float, float, Array, Array]
SILENCE = np.zeros((2, 2)), np.zeros(2)


def wave(amplitude: float, omega: float, angle: float) -> tuple[Array, Array]:
    """Return generator and start of a sine and its cosine."""
    turning = np.array([[0.0, omega], [-omega, 0.0]])
    return turning, amplitude * np.array([math.sin(angle), math.cos(angle)])


def steady(start: float, *, amplitude: float, frequency: float, phase: float) -> tuple[Array, Array]:
    """Return a harmonic that begins at a time."""
    omega = 2 * math.pi * frequency
    return wave(amplitude, omega, omega * start + phase)


def added(one: tuple[Array, Array], other: tuple[Array, Array]) -> tuple[Array, Array]:
    """Return two pieces as one, in coordinates whose first is the sum of the forces."""
    turn = np.eye(4)
    turn[0, 2] = 1.0
    return turn @ block_diag(one[0], other[0]) @ np.linalg.inv(turn), turn @ np.concatenate([one[1], other[1]])


def pieces(load: str) -> list[Piece]:
    """Return the load as pieces: start, end, and the generator and start of states whose first one is the force."""
    if load == "record":
        t, f = RECORD
        slope = np.diff(f) / np.diff(t)
        ramp = np.array([[0.0, 1.0], [0.0, 0.0]])
        return [(t[k], t[k + 1], ramp, np.array([f[k], slope[k]])) for k in range(slope.size)]
    first, last = PULSE["start"], PULSE["start"] + PULSE["duration"]
    hit = wave(PULSE["amplitude"], math.pi / PULSE["duration"], 0.0)
    pulse: list[Piece] = [(0.0, first, *SILENCE), (first, last, *hit), (last, DURATION, *SILENCE)]
    return {
        "none": [(0.0, DURATION, *SILENCE)],
        "half sine": pulse,
        "harmonic": [(0.0, DURATION, *steady(0.0, **STEADY))],
        "resonance": [(0.0, DURATION, *steady(0.0, **RESONANT))],
        "sum": [(a, b, *added((generator, state), steady(a, **STEADY))) for a, b, generator, state in pulse],
    }[load]


def exact(stiffness: float, damping: float, load: str, x: float, v: float) -> Array:
    """Return displacement and velocity at TIMES, (T, 2)."""
    result = np.zeros((TIMES.size, 2))
    state = np.array([x, v])
    for start, end, generator, force in pieces(load):
        n = 2 + force.size
        system = np.zeros((n, n))
        system[0, 1] = 1.0
        system[1, :3] = -stiffness / MASS, -damping / MASS, 1 / MASS
        system[2:, 2:] = generator
        whole = np.concatenate([state, force])
        for k in np.flatnonzero((start <= TIMES) & (end >= TIMES)):
            result[k] = (expm(system * (TIMES[k] - start)) @ whole)[:2]
        state = (expm(system * (end - start)) @ whole)[:2]
    return result


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("kind", DAMPINGS)
def test_motion_is_exact(kind: str, load: str) -> None:
    """The response of a mode with any damping to any load, from an initial motion, is exact."""
    structure = {"mass": MASS, "stiffness": STIFFNESS, **DAMPINGS[kind]}
    case = rb.Case(
        structure=rb.SDOF(**structure, displacement=1e-3, velocity=0.2),
        load=LOADS[load],
        duration=DURATION,
        output=rb.Output(times=TIMES),
    )
    run = rb.simulate(case)
    damping = structure.get("damping", 2 * structure.get("damping_ratio", 0.0) * RATE * MASS)
    wanted = exact(structure["stiffness"], damping, load, 1e-3, 0.2)
    for ours, column in ((run.arrays.displacement, 0), (run.arrays.velocity, 1)):
        difference = np.abs(ours[:, 0] - wanted[:, column]).max() / np.abs(wanted[:, column]).max()
        assert difference < 2e-12
    assert run.energy_residual < 1e-11


def test_several_modes_add_up() -> None:
    """A rigid-body, an underdamped, a critical and an overdamped mode of one structure add up at each point."""
    frequencies, ratios = [0.0, 7.0, 12.0, 30.0], [0.0, 0.02, 1.0, 4.0]
    tip, root = np.array([0.4, 0.3, -0.5, 0.2]), np.array([0.1, -0.6, 0.2, 0.7])
    case = rb.Case(
        structure=rb.Modal(frequencies=frequencies, damping_ratios=ratios, shapes={"tip": tip, "root": root}),
        load=rb.Record(times=RECORD[0], values=RECORD[1], unit="N", point="root"),
        duration=DURATION,
        output=rb.Output(times=TIMES),
    )
    a = rb.simulate(case).arrays
    wanted = np.zeros(TIMES.size)
    for frequency, ratio, at_tip, at_root in zip(frequencies, ratios, tip, root, strict=True):
        omega = 2 * math.pi * frequency
        unit = exact(MASS * omega**2, 2 * ratio * omega * MASS, "record", 0.0, 0.0)[:, 0]
        wanted += at_tip * at_root * MASS * unit
    assert np.abs(a.displacement[:, a.points.index("tip")] - wanted).max() < 1e-12 * np.abs(wanted).max()


def test_the_clock_keeps_to_a_fast_mode_under_a_load() -> None:
    """The end of eight thousand periods under a slow load agrees with the closed form: time does not drift."""
    omega, slow, times = 1e5, 66 * math.pi, np.linspace(0, 0.5, 11)
    run = rb.simulate(
        rb.Case(
            structure=rb.SDOF(mass=1, stiffness=omega**2, displacement=1e-3),
            load=rb.Harmonic(amplitude=10, frequency=33),
            duration=0.5,
            output=rb.Output(times=times),
        )
    )
    forced = 10 / (omega**2 - slow**2) * (np.sin(slow * times) - slow / omega * np.sin(omega * times))
    off = run.motion.displacement.sel(point="mass").values - 1e-3 * np.cos(omega * times) - forced
    assert np.abs(off).max() < 1e-10 * 1e-3
