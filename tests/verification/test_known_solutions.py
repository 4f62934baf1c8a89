"""Runs against exact solutions: the lines of the verification table."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from support import impact_cases, known_impacts
from support.exact import printed, restitution_laws, shaken

import rattlebox as rb


@pytest.mark.parametrize("lines", known_impacts.ALL, ids=lambda f: f.__name__)
def test_run_has_the_exact_value(lines: Callable[[], Iterator[known_impacts.Comparison]]) -> None:
    """Every line of the verification table is within its tolerance."""
    result = list(lines())
    assert result
    failed = [f"{line.case}: {line.ours!r}, exact {line.exact!r}" for line in result if not line.within_tolerance]
    assert not failed, "\n".join(failed)


@pytest.mark.parametrize("law", known_impacts.SOFT_DAMPERS)
def test_soft_impacts_become_hard_ones_at_first_order(law: str) -> None:
    """The error of the approach speed of a soft impact damper is proportional to the contact time."""
    times, error = known_impacts.soft_errors(law)
    orders = np.diff(np.log(np.abs(error))) / np.diff(np.log(times))
    assert orders[-1] == pytest.approx(1.0, abs=0.05)
    assert abs(orders[-1] - 1) < abs(orders[0] - 1)


@pytest.mark.parametrize("key", printed.MASRI_CAUGHEY)
def test_impact_damper_keeps_or_leaves_its_orbit(key: tuple[float, float, float]) -> None:
    """A small perturbation decays if the multiplier is below one, and grows above one."""
    orbit = known_impacts.stable(key)
    size = 1e-5 * orbit.clearance
    log = known_impacts.simulate(impact_cases.impact_damper(orbit, 24.0, shift=(size, 0, 0, 0))).arrays.impacts
    off = np.abs(log.approach_speed / orbit.approach - 1)
    early, late = off[:4].max(), off[-4:].max()
    if max(abs(orbit.multipliers())) < 1:
        assert late < early
    else:
        assert late > 30 * early


@pytest.mark.parametrize("e", printed.SLOW_MANIFOLD_THRESHOLD)
def test_two_impacts_a_cycle_end_at_the_threshold(e: float) -> None:
    """Just above the threshold the ball has two impacts per cycle; just below it does not."""
    cycles = 400
    above = shaken.two_impacts(e, 1.0005 * shaken.threshold(e))
    below = shaken.TwoImpacts(e, 0.9995 * shaken.threshold(e), above.reach, above.phase)
    keeps = known_impacts.simulate(impact_cases.shaken_cavity(above, cycles)).arrays.impacts
    loses = known_impacts.simulate(impact_cases.shaken_cavity(below, cycles)).arrays.impacts
    assert np.diff(keeps.time) == pytest.approx(np.pi, rel=1e-8)
    assert np.abs(np.diff(loses.time) - np.pi).max() > 0.3


@pytest.mark.parametrize("ratio", printed.COLLECT_AND_COLLIDE)
def test_sticky_load_hits_at_the_known_phase(ratio: float) -> None:
    """A ball that sticks leaves the wall at maximum speed and hits the other one at the exact phase."""
    log = known_impacts.simulate(impact_cases.sticky_load(ratio, 3.0)).arrays.impacts
    landed = log.time[log.energy_lost > 1e-6 * log.energy_lost.max()]
    exact = shaken.collide_phase(ratio) + np.pi * np.arange(landed.size)
    assert landed.size >= 5
    assert landed == pytest.approx(exact, rel=1e-9)


def test_chatter_has_the_exact_times() -> None:
    """Times and speeds of the first forty impacts of a dropped ball are exact."""
    log = known_impacts.simulate(impact_cases.dropped(0.5, 0.8, 9.81, 4.0)).arrays.impacts
    exact = [shaken.chatter_time(0.5, 0.8, 9.81, k + 1) for k in range(40)]
    assert log.time[:40] == pytest.approx(exact, rel=1e-11)
    speed = np.sqrt(2 * 9.81 * 0.5) * 0.8 ** np.arange(40)
    # An error of 1e-12 of each flight time is multiplied by g in the speed.
    assert log.approach_speed[:40] == pytest.approx(speed, rel=1e-9, abs=1e-11)


@pytest.mark.parametrize("clock", [1e5, 1e7])
def test_chatter_costs_the_same_late_in_a_long_run(clock: float) -> None:
    """A ball that comes to rest in each cycle needs as few flights at large times as at first, with few digits of time."""

    def flights(start: float) -> int:
        run = rb.simulate(
            rb.Case(
                structure=rb.Shaker(motion=rb.Harmonic(amplitude="1.0467 m", frequency="1 rad/s", start=start)),
                damper=rb.ImpactDamper(
                    ball=rb.Sphere(radius=0.01, material="steel", mass=1.0),
                    gap=50.0,
                    start=-1.0,
                    gravity=-1.0,
                    contact=rb.Tsuji(restitution=0.5),
                ),
                duration=start + 100 * np.pi,
                method=rb.Newton(restitution=0.5, max_events=20_000),
                output=rb.Output(times=[0.0]),
            )
        )
        assert run.ok
        return run.counts["flights"]

    assert flights(clock) <= 1.1 * flights(0.0)


def test_chatter_ends_at_rest() -> None:
    """After the time to rest the ball is at rest on the floor, and the force on the floor is its weight."""
    case = impact_cases.dropped(0.5, 0.8, 9.81, 4.0)
    run = known_impacts.simulate(case.model_copy(update={"output": rb.Output(times=[3.0, 3.5])}))
    a = run.arrays
    assert np.all(np.abs(a.ball_velocity[1:, 0]) == 0)
    assert a.cavity_force[-2, 0] == pytest.approx(-9.81, rel=1e-12)


def test_soft_ball_chatters_to_rest() -> None:
    """With a soft contact the ball comes to rest in its static indentation."""
    case = rb.Case(
        structure=rb.Fixed(),
        damper=rb.ImpactDamper(
            ball=impact_cases.ball(),
            gap=1e-3,
            start=0.0,
            gravity=-9.81,
            contact=rb.Tsuji(restitution=0.5, ending="zero_force"),
        ),
        duration=0.3,
    )
    run = known_impacts.simulate(case)
    weight = 9.81 * impact_cases.MASS
    assert run.arrays.cavity_force[-1, 0] == pytest.approx(-weight, rel=1e-6)
    depth = -run.arrays.ball_position[-1, 0] - 1e-3
    assert depth == pytest.approx((weight / impact_cases.STIFFNESS) ** (2 / 3), rel=1e-4)
    assert run.energy_residual <= 1e-10


@pytest.mark.parametrize("excess", [1e-6, 1e-5, 1e-4, 1e-3, 1e-2])
def test_the_least_yielding_is_detected(excess: float) -> None:
    """A ball just fast enough to yield, which turns within one step of the yield point, has the exact loss."""
    pressure = 1.6 * impact_cases.YIELD
    yielding = restitution_laws.thornton_speed(impact_cases.RADIUS, impact_cases.MASS, impact_cases.MODULUS, pressure)
    case = impact_cases.single_impact(rb.Thornton(yield_pressure=pressure), (1 + excess) * yielding, 3e-4)
    lost = rb.simulate(case).arrays.impacts.energy_lost[0] / (0.5 * impact_cases.MASS * ((1 + excess) * yielding) ** 2)
    assert lost == pytest.approx(1 - restitution_laws.thornton(1 + excess) ** 2, rel=1e-6, abs=4e-15)
    assert lost > 0.4 * excess**2
