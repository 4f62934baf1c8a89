"""Frequency responses and Lyapunov exponents against exact motions with two impacts a cycle, and free oscillators."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import rattlebox as rb

from . import cases
from .exact import masri_caughey, oscillator, printed

STABLE = [key for key, (*_, multiplier) in printed.MASRI_CAUGHEY.items() if multiplier < 1]
UNSTABLE = [key for key in printed.MASRI_CAUGHEY if key not in STABLE]
SAMPLES = 512
PEAK = (math.pi / SAMPLES) ** 2
"""What samples may miss of the peak, relative: twice that of a sine, as its harmonics make the motion more curved."""


def orbit(key: tuple[float, float, float], omega: float) -> masri_caughey.Orbit:
    """Return the less unstable of the orbits at a frequency."""
    return min(masri_caughey.orbits(*key, omega=omega), key=lambda found: max(abs(found.multipliers())))


def growth(key: tuple[float, float, float], omega: float) -> float:
    """Return the logarithm of the largest multiplier of half a cycle."""
    return math.log(max(abs(orbit(key, omega).multipliers())))


def followed(key: tuple[float, float, float], omegas: np.ndarray, direction: str, skip: int) -> np.ndarray:
    """Return by how much the peaks of a response that begins on the orbit differ from the orbit's own, relative."""
    first = float(omegas[0] if direction == "up" else omegas[-1])
    case = cases.impact_damper(orbit(key, first), 1.0)
    response = rb.frequency_response(
        case, omegas / (2 * math.pi), direction=direction, cycles=(skip, 16), samples=SAMPLES, progress=False
    )
    assert (response.status == 0).all()
    exact = np.array([orbit(key, float(omega)).largest() for omega in omegas])
    return np.asarray(response.peak.values[0, 0] / exact - 1)


@pytest.mark.parametrize("key", STABLE)
def test_response_has_the_exact_amplitude(key: tuple[float, float, float]) -> None:
    """Followed over frequency from the printed orbit, the peak displacement stays that of the exact motion."""
    off = followed(key, np.linspace(1.0, 1.04, 9), "up", 200)
    assert np.abs(off).max() < PEAK
    assert orbit(key, 1.0).largest() / 50 == pytest.approx(printed.MASRI_CAUGHEY[key][0], rel=1e-4)


def test_levels_scale_with_the_clearance() -> None:
    """At another level of the load the response is that of another clearance over the load."""
    mu, e, clearance = 0.1, 0.5, 20.0
    case = cases.impact_damper(orbit((mu, e, clearance), 1.0), 1.0)
    levels = [0.8, 1.0, 1.25]
    response = rb.frequency_response(
        case, [1 / (2 * math.pi)], levels=levels, direction="fresh", cycles=(300, 16), samples=SAMPLES, progress=False
    )
    exact = [level * orbit((mu, e, clearance / level), 1.0).largest() for level in levels]
    assert response.peak.values[0, :, 0] == pytest.approx(exact, rel=PEAK)
    assert response.impacts_per_cycle.values[0, :, 0] == pytest.approx(2.0)
    assert (response.period == 1).all()


@pytest.mark.parametrize(
    ("key", "end", "step", "skip"),
    [
        ((0.10, 0.75, 20), 0.97, 2e-4, 4000),  # symmetry breaks, and the motion jumps
        ((0.05, 0.25, 30), 0.98, 2e-4, 4000),  # symmetry breaks
        ((0.10, 0.25, 20), 0.95, 2e-4, 8000),
        ((0.10, 0.75, 20), 1.10, 5e-4, 8000),  # a torus
        ((0.05, 0.25, 30), 1.09, 5e-4, 8000),
    ],
)
def test_limits_of_stability(key: tuple[float, float, float], end: float, step: float, skip: int) -> None:
    """The response leaves the exact orbit between the two frequencies between which its multiplier passes one."""
    limit = brentq(lambda omega: growth(key, omega), 1.0, end, xtol=1e-12)
    assert isinstance(limit, float)
    beyond = step * (np.arange(-4, 4) + 0.5)
    upward = end > 1
    omegas = limit + beyond if upward else limit - beyond[::-1]
    off = followed(key, omegas, "up" if upward else "down", skip)[:: 1 if upward else -1]
    assert np.abs(off[:4]).max() < PEAK
    assert np.abs(off[4:]).min() > 10 * PEAK


@pytest.mark.parametrize("key", UNSTABLE)
def test_unstable_motions_are_left(key: tuple[float, float, float]) -> None:
    """Begun on an orbit that is unstable, the response is another motion."""
    assert abs(followed(key, np.array([1.0]), "up", 200)[0]) > 0.01


@pytest.mark.parametrize("key", STABLE)
def test_exponent_is_the_logarithm_of_the_multiplier(key: tuple[float, float, float]) -> None:
    """A periodic motion has the exponent ln|multiplier| over the time in which that acts."""
    exact = orbit(key, 1.0)
    found = rb.lyapunov(cases.impact_damper(exact, 1.0), cycles=(40, 400), progress=False)
    # The distance of neighbours, 1e-7, is not zero, and rounding is 1e-9 of it.
    assert float(found.growth_per_cycle) == pytest.approx(2 * growth(key, 1.0), abs=1e-7)
    assert float(found.exponent) == pytest.approx(growth(key, 1.0) / exact.half_period, abs=1e-7)


@pytest.mark.parametrize("key", UNSTABLE)
def test_exponent_of_an_unstable_orbit(key: tuple[float, float, float]) -> None:
    """As long as rounding has not grown, the exponent is that of the unstable orbit."""
    found = rb.lyapunov(cases.impact_damper(orbit(key, 1.0), 1.0), cycles=(0, 24), reach=0.0, progress=False)
    assert float(found.growth_per_cycle) == pytest.approx(2 * growth(key, 1.0), rel=2e-3)


def test_exponent_of_free_oscillators() -> None:
    """A free oscillator has the exponent of its decay: zero when it is undamped."""
    case = rb.Case(structure=rb.SDOF(mass=2.0, stiffness=800.0, damping_ratio=0.0, displacement=0.01), duration=60.0)
    ratios = [0.0, 0.01, 0.3]
    found = rb.lyapunov(case, {"structure.damping_ratio": ratios}, steps=400, progress=False)
    # Rounding of the state is 1e-9 of the distance of neighbours, in each of 400 steps of 0.15 s.
    assert found.exponent.values == pytest.approx([-20.0 * ratio for ratio in ratios], abs=1e-8 / 0.15)


def test_bare_structure_has_its_transfer_function() -> None:
    """Without dampers, amplitude and phase of the response are those of the linear oscillator."""
    zeta, omegas = 0.05, np.linspace(0.5, 1.5, 5)
    case = rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=1.0, damping_ratio=zeta),
        load=rb.Harmonic(amplitude=2.0, frequency="1 rad/s", phase=0.7),
        duration=1.0,
    )
    response = rb.frequency_response(case, omegas / (2 * math.pi), cycles=(150, 8), progress=False)
    exact = [oscillator.amplitude(zeta, float(omega), 2.0) for omega in omegas]
    lags = [oscillator.lag(zeta, float(omega)) for omega in omegas]
    for direction in ("up", "down"):
        one = response.sel(direction=direction).isel(level=0)
        assert one.amplitude.values == pytest.approx(exact, rel=1e-9)
        assert one.phase.values == pytest.approx([-lag for lag in lags], abs=1e-9)
    assert response.bare_amplitude.values[0] == pytest.approx(exact, rel=1e-12)
