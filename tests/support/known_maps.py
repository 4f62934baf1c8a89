"""Results of maps for which an exact value is known, for the tests and the verification table."""

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

import rattlebox as rb

from . import impact_cases
from .exact import masri_caughey, printed, shaken
from .known_impacts import Comparison

Array = NDArray[np.float64]
Key = tuple[float, float, float]

AMPLITUDE = "structure.motion.amplitude"
STEP = 5e-4
"""Step between two values of a bifurcation diagram."""
SAMPLES = 512
PEAK = (math.pi / SAMPLES) ** 2
"""Relative error of the peak of samples: twice that of a sine, because of harmonics."""
STABLE = [key for key, (*_, multiplier) in printed.MASRI_CAUGHEY.items() if multiplier < 1]
UNSTABLE = [key for key in printed.MASRI_CAUGHEY if key not in STABLE]
LIMITS = (
    ((0.10, 0.75, 20.0), 0.97, 2e-4, 4000),  # symmetry breaks, and the motion jumps
    ((0.05, 0.25, 30.0), 0.98, 2e-4, 4000),  # symmetry breaks
    ((0.10, 0.25, 20.0), 0.95, 2e-4, 8000),
    ((0.10, 0.75, 20.0), 1.10, 5e-4, 8000),  # a torus
    ((0.05, 0.25, 30.0), 1.09, 5e-4, 8000),
)
"""Orbit, a frequency beyond its limit of stability, step of the frequency, cycles to skip."""


def around(threshold: float, below: int, above: int, step: float = STEP) -> Array:
    """Return multiples of a step to both sides of a threshold."""
    return step * (math.ceil(threshold / step) + np.arange(-below, above))


def lost(values: Array, held: Any) -> float:
    """Return the mean of the last value at which a motion is stable and the next value, in the order of the runs."""
    held = np.asarray(held)
    last = int(np.argmin(held)) - 1
    assert held[: last + 1].all() and not held[last + 1 :].any()
    return float(0.5 * (values[last] + values[last + 1]))


# ---- bifurcation diagrams


def table_thresholds(restitution: float, cycles: int) -> tuple[float, float]:
    """Return the values at which an orbit of the bouncing ball ends (descending), and doubles (ascending)."""
    begin, double = shaken.table_bounds(restitution, cycles)

    def diagram(gamma: float, values: Array, skip: int, direction: Any) -> Any:
        case = impact_cases.table(shaken.table_orbit(restitution, gamma, cycles), 1)  # gamma is none of the values
        maps = rb.bifurcation(case, AMPLITUDE, values, cycles=(skip, 48), direction=direction, progress=False)
        assert (maps.status == 0).all()
        return maps.isel(direction=0)

    up, down = around(double, 8, 8), around(begin, 8, 8)
    maps = diagram(float(up[0]) - STEP, up, 4000, "up")  # near a threshold motions settle slowly
    doubles = lost(up, maps.period == cycles)
    assert (maps.period[-4:] == 2 * cycles).all()
    maps = diagram(float(down[-1]) + STEP, down, 300, "down")
    bounces = (maps.period == cycles) & np.isclose(maps.impacts_per_cycle, 1 / cycles)
    return lost(down[::-1], bounces[::-1]), doubles


def two_impacts_threshold(restitution: float) -> float:
    """Return the least amplitude with two impacts per cycle in a shaken cavity; above it their speed is exact."""
    down = around(shaken.threshold(restitution), 10, 20)
    case = impact_cases.shaken_cavity(shaken.two_impacts(restitution, float(down[-1])), 1)
    maps = rb.bifurcation(
        case, AMPLITUDE, down, cycles=(500, 48), direction="down", show="impacts", progress=False
    ).isel(direction=0)
    two = (maps.period == 1) & np.isclose(maps.impacts_per_cycle, 2)
    for index in np.flatnonzero(two):
        orbit = shaken.two_impacts(restitution, float(down[index]))
        speeds = maps.approach_speed[index].dropna("impact")
        assert speeds.size == 96
        np.testing.assert_allclose(speeds, orbit.approach, rtol=1e-5)
    return lost(down[::-1], two[::-1])


def thresholds() -> Iterator[Comparison]:
    """Yield thresholds found by bifurcation diagrams, to 1e-3."""
    for e, n in printed.VIBRATING_TABLE:
        begin, double = shaken.table_bounds(e, n)
        result = table_thresholds(e, n)
        name = f"bifurcation: vibrating table, e {e}, {n} cycle{'s' * (n > 1)}"
        yield Comparison("maps", f"{name}: begins", begin, result[0], 1e-3 / begin)
        yield Comparison("maps", f"{name}: doubles", double, result[1], 1e-3 / double)
    for e in printed.SLOW_MANIFOLD_THRESHOLD:
        exact = shaken.threshold(e)
        name = f"bifurcation: shaken cavity, e {e}: two impacts a cycle begin"
        yield Comparison("maps", name, exact, two_impacts_threshold(e), 1e-3 / exact)


# ---- frequency responses


def orbit(key: Key, omega: float) -> masri_caughey.Orbit:
    """Return the less unstable of the orbits at a frequency."""
    return min(masri_caughey.orbits(*key, omega=omega), key=lambda result: max(abs(result.multipliers())))


def growth(key: Key, omega: float) -> float:
    """Return the logarithm of the largest multiplier of half a cycle."""
    return math.log(max(abs(orbit(key, omega).multipliers())))


def followed(key: Key, omegas: Array, direction: Any, skip: int) -> tuple[Array, Array]:
    """Return the peaks of a response that begins on the orbit, and the orbit's own."""
    first = float(omegas[0] if direction == "up" else omegas[-1])
    case = impact_cases.impact_damper(orbit(key, first), 1.0)
    response = rb.frequency_response(
        case, omegas / (2 * math.pi), direction=direction, cycles=(skip, 16), samples=SAMPLES, progress=False
    )
    assert (response.status == 0).all()
    return response.peak.values[0, 0], np.array([orbit(key, float(omega)).largest() for omega in omegas])


def stability_limit(key: Key, end: float, step: float, skip: int) -> tuple[float, float]:
    """Return the frequency at which an orbit's multiplier passes one, and where the response leaves the orbit."""
    limit = float(brentq(lambda omega: growth(key, omega), 1.0, end, xtol=1e-12))
    upward = end > 1
    omegas = around(limit, 4, 4, step)
    ours, exact = followed(key, omegas, "up" if upward else "down", skip)
    off = np.abs(ours / exact - 1)[:: 1 if upward else -1]
    held = off < PEAK
    assert (off[~held] > 10 * PEAK).all()
    return limit, lost(omegas[:: 1 if upward else -1], held)


def _named(key: Key) -> str:
    return "Masri-Caughey, mass ratio {}, e {}, clearance {:g}".format(*key)


def responses() -> Iterator[Comparison]:
    """Yield amplitudes of impact dampers, found by frequency responses."""
    for key in STABLE:
        ours, exact = followed(key, np.linspace(1.0, 1.04, 9), "up", 200)
        worst = int(np.argmax(np.abs(ours / exact - 1)))
        for number in sorted({0, worst}):
            name = f"frequency_response: {_named(key)}, frequency {1 + 0.005 * number:g}: peak"
            yield Comparison("maps", name, float(exact[number]), float(ours[number]), PEAK)


def limits() -> Iterator[Comparison]:
    """Yield limits of the stability of impact dampers, found by frequency responses."""
    for key, end, step, skip in LIMITS:
        limit, result = stability_limit(key, end, step, skip)
        side = "upper" if end > 1 else "lower"
        yield Comparison(
            "maps", f"frequency_response: {_named(key)}: {side} limit of stability", limit, result, 1.5 * step
        )


# ---- exponents and designs


def exponents() -> Iterator[Comparison]:
    """Yield multipliers of periodic motions, and that of an undamped free oscillator, from Lyapunov exponents."""
    for key in STABLE:
        exact = orbit(key, 1.0)
        result = rb.lyapunov(impact_cases.impact_damper(exact, 1.0), cycles=(40, 400), progress=False)
        # The distance of neighbours, 1e-7, is not zero, and rounding is 1e-9 of it.
        multiplier = math.exp(float(result.exponent) * exact.half_period)
        yield Comparison("maps", f"lyapunov: {_named(key)}: multiplier", math.exp(growth(key, 1.0)), multiplier, 1e-7)
    case = rb.Case(structure=rb.SDOF(mass=2.0, stiffness=800.0, damping_ratio=0.0, displacement=0.01), duration=60.0)
    result = rb.lyapunov(case, steps=400, progress=False)
    # Rounding of the state is 1e-9 of the distance of neighbours, in each of 400 steps of 0.15 s.
    multiplier = math.exp(float(result.exponent) * 2 * math.pi / 20)
    yield Comparison("maps", "lyapunov: undamped free oscillator: multiplier of a period", 1.0, multiplier, 1e-8 / 0.15)


def designs() -> Iterator[Comparison]:
    """Yield the best clearance of collect-and-collide, pi times the amplitude, and its loss, found by a search."""
    for seed in (0, 1):
        result = rb.design(
            impact_cases.sticky_load(1.0, 1.0),
            {"damper.gap": ("0.2 m", "4 m")},
            {"reduced_loss": "max"},
            cycles=(10, 20),
            trials=80,
            seed=seed,
            progress=False,
        )
        best = rb.Case.from_toml(result.case.item()).dampers[0]
        # The loss is flat at its top: 1e-5 of it is some 4e-3 of the clearance.
        name = f"design: collect and collide, seed {seed}"
        yield Comparison("maps", f"{name}: best clearance over amplitude", math.pi, 2 * best.gap, 5e-3)
        yield Comparison("maps", f"{name}: energy a cycle", 4.0, float(result.reduced_loss.max()), 1e-5)


ALL: tuple[Callable[[], Iterator[Comparison]], ...] = (thresholds, responses, limits, exponents, designs)
