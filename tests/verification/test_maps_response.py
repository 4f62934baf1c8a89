"""Frequency responses and Lyapunov exponents against exact motions with two impacts a cycle, and free oscillators."""

import math

import numpy as np
import pytest
from support import impact_cases
from support.exact import oscillator
from support.known_maps import PEAK, SAMPLES, UNSTABLE, followed, growth, orbit

import rattlebox as rb


def test_levels_scale_with_the_clearance() -> None:
    """At another level of the load the response is that of another clearance over the load."""
    mu, e, clearance = 0.1, 0.5, 20.0
    case = impact_cases.impact_damper(orbit((mu, e, clearance), 1.0), 1.0)
    levels = [0.8, 1.0, 1.25]
    response = rb.frequency_response(
        case, [1 / (2 * math.pi)], levels=levels, direction="fresh", cycles=(300, 16), samples=SAMPLES, progress=False
    )
    exact = [level * orbit((mu, e, clearance / level), 1.0).largest() for level in levels]
    assert response.peak.values[0, :, 0] == pytest.approx(exact, rel=PEAK)
    assert response.impacts_per_cycle.values[0, :, 0] == pytest.approx(2.0)
    assert (response.period == 1).all()


@pytest.mark.parametrize("key", UNSTABLE)
def test_unstable_motions_are_left(key: tuple[float, float, float]) -> None:
    """A response that starts on an unstable orbit is another motion."""
    ours, exact = followed(key, np.array([1.0]), "up", 200)
    assert abs(ours[0] / exact[0] - 1) > 0.01


@pytest.mark.parametrize("key", UNSTABLE)
def test_exponent_of_an_unstable_orbit(key: tuple[float, float, float]) -> None:
    """Before rounding errors grow, the exponent is that of the unstable orbit."""
    result = rb.lyapunov(impact_cases.impact_damper(orbit(key, 1.0), 1.0), cycles=(0, 24), reach=0.0, progress=False)
    assert float(result.growth_per_cycle) == pytest.approx(2 * growth(key, 1.0), rel=2e-3)


def test_exponent_of_free_oscillators() -> None:
    """A free oscillator has the exponent of its decay."""
    case = rb.Case(structure=rb.SDOF(mass=2.0, stiffness=800.0, damping_ratio=0.0, displacement=0.01), duration=60.0)
    ratios = [0.0, 0.01, 0.3]
    result = rb.lyapunov(case, {"structure.damping_ratio": ratios}, steps=400, progress=False)
    # Rounding of the state is 1e-9 of the distance of neighbours, in each of 400 steps of 0.15 s.
    assert result.exponent.values == pytest.approx([-20.0 * ratio for ratio in ratios], abs=1e-8 / 0.15)


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
