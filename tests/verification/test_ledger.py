"""The energy ledger closes: the work of the loads equals losses and stored energy."""

import math
from typing import Any

import numpy as np
import pytest
from support import impact_cases, known_impacts

import rattlebox as rb

LAWS: dict[str, tuple[Any, str | None]] = {
    "constant alpha, zero overlap": (lambda: rb.Tsuji(alpha=0.006313, ending="zero_overlap"), None),
    "constant alpha, zero force": (lambda: rb.Tsuji(alpha=0.006313, ending="zero_force"), None),
    "Jackson-Green, steel wall": (lambda: rb.Tsuji(restitution=rb.JacksonGreen()), None),
    "Jackson-Green, rigid wall": (lambda: rb.Tsuji(restitution=rb.JacksonGreen(wall="rigid")), "rigid"),
    "hysteretic": (lambda: rb.Thornton(), None),
    "linear": (lambda: rb.Linear(contact_time="0.4 ms", restitution=0.9), None),
}
STARTS = (0.0, -1.0, 1.0)


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("force", [100.0, 5000.0])
@pytest.mark.parametrize("law", LAWS)
def test_ledger_of_the_reference_case_closes(law: str, force: float, start: float) -> None:
    """Work, losses and energy balance to 1e-10 of the work at every output time of five seconds."""
    contact, wall = LAWS[law]
    run = known_impacts.simulate(impact_cases.reference_case(start=start, force=force, contact=contact(), wall=wall))
    assert run.arrays.load_work[-1] > 0
    assert run.energy_residual <= 1e-10


@pytest.mark.parametrize("law", LAWS)
def test_impact_log_adds_up_to_the_loss(law: str) -> None:
    """The losses of the single impacts sum to the impact loss of the ledger."""
    contact, wall = LAWS[law]
    a = known_impacts.simulate(impact_cases.reference_case(contact=contact(), wall=wall, duration=2.0)).arrays
    lost = a.normal_loss[-1, 0] + a.plastic_loss[-1, 0]
    assert a.impacts.energy_lost.sum() == pytest.approx(lost, abs=1e-11 * a.load_work[-1])


def test_small_pulse_never_moves_the_ball() -> None:
    """At 100 N the structure of the centred case never reaches the ball, which does not move."""
    a = known_impacts.simulate(impact_cases.reference_case(force=100.0, duration=0.1)).arrays
    assert len(a.impacts) == 0
    # The impulse without damping would give 0.0503 mm; the pulse lasts a hundredth of a period.
    rate, zeta = math.sqrt(80e3 / 20), 25.3 / (2 * math.sqrt(20 * 80e3))
    undamped = 100 * 2e-3 / math.pi / 20 / rate
    assert undamped == pytest.approx(0.0503e-3, abs=0.5e-7)
    damped = undamped * math.exp(-zeta * math.acos(zeta) / math.sqrt(1 - zeta**2))
    assert abs(a.displacement).max() == pytest.approx(damped, rel=1e-3)
    assert abs(a.ball_position).max() == 0


def test_ledger_of_a_row_of_balls_closes() -> None:
    """Five unequal balls in a row on three modes balance to 1e-8 of the work."""
    run = known_impacts.simulate(impact_cases.five_balls())
    assert len(run.arrays.impacts) > 100
    assert set(run.arrays.impacts.contact) == set(range(6))
    assert run.energy_residual <= 1e-8


def test_row_of_balls_stays_in_order() -> None:
    """Balls of a crowded row never pass through each other or a wall: no overlap exceeds the largest one of the log."""
    run = known_impacts.simulate(impact_cases.five_balls())
    a = run.arrays
    place = a.relative_position - a.ball_centre
    half = 0.5 * a.clearance[0]
    gaps = np.hstack([place[:, :1] + half, np.diff(place, axis=1), half - place[:, -1:]])
    assert gaps.min() >= -a.impacts.peak_overlap.max() * (1 + 1e-9)
    assert abs(a.contact_energy).max() < a.load_work.max()


@pytest.mark.parametrize("balls", [2, 3, 4])
def test_hard_rows_collapse_and_stick(balls: int) -> None:
    """Random rows of hard balls, collapses included, stay in order, finish and balance to 1e-10 of the work."""
    rng = np.random.default_rng(balls)
    for _ in range(8):
        case = impact_cases.hard_row(rng, balls)
        run = known_impacts.simulate(case)
        assert run.status == "finished"
        assert run.energy_residual <= 1e-10
        place = run.arrays.relative_position - run.arrays.ball_centre
        half = 0.5 * run.arrays.clearance[0]
        gaps = np.hstack([place[:, :1] + half, np.diff(place, axis=1), half - place[:, -1:]])
        # Touching balls drift by the rounding error of their relative speed; the detection has an error of that size.
        fastest = max(np.abs(run.arrays.ball_velocity).max(), run.arrays.impacts.approach_speed.max())
        drift = 2 * 16 * np.finfo(float).eps * fastest * case.duration
        assert gaps.min() >= -drift


def test_hard_balls_in_several_cavities_come_to_rest_on_each_other() -> None:
    """Random hard dampers on one structure, with and without gravity, stick and finish, and balance to 1e-10."""
    rng = np.random.default_rng(1)
    for _ in range(24):
        run = known_impacts.simulate(impact_cases.hard_dampers(rng))
        assert run.status == "finished"
        assert run.energy_residual <= 1e-10


@pytest.mark.parametrize("balls", [2, 3, 4, 5])
@pytest.mark.parametrize("e", [0.0, 0.3, 0.5, 0.8])
def test_a_pile_of_hard_balls_comes_to_rest(balls: int, e: float) -> None:
    """Balls that fall on each other on the floor of a fixed cavity all end at rest on it."""
    run = known_impacts.simulate(impact_cases.pile(balls, e))
    assert run.status == "finished"
    assert np.abs(run.arrays.ball_velocity[-1]).max() < 1e-9


@pytest.mark.parametrize("method", ["newton", "event_driven"])
def test_momentum_of_a_free_system_is_conserved(method: str) -> None:
    """A free cavity with a ball keeps its momentum to rounding, and hard impacts keep it too."""
    case = rb.Case(
        structure=rb.SDOF(mass=2.0, stiffness=0.0, velocity=0.3),
        damper=rb.ImpactDamper(ball=impact_cases.ball(0.7), gap=1e-2, contact=rb.Tsuji(restitution=0.95)),
        duration=2.0,
        method=rb.Newton(restitution=0.95) if method == "newton" else rb.EventDriven(),
    )
    a = known_impacts.simulate(case).arrays
    momentum = 2.0 * a.velocity[:, 0] + 0.7 * a.ball_velocity[:, 0]
    assert len(a.impacts) > 10
    assert momentum == pytest.approx(0.6, rel=1e-13)


def test_base_work_closes() -> None:
    """With a shaken base, in the base's frame, the work of inertia balances as the work of a load does."""
    case = rb.Case(
        structure=rb.SDOF(mass=20.0, stiffness=80e3, damping=25.3),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius=0.03317, material="steel"),
            gap=0.4e-3,
            contact=rb.Tsuji(restitution=0.9),
            gravity=-9.81,
        ),
        base=rb.Harmonic(amplitude=2.0, frequency=10.0),
        duration=2.0,
    )
    run = known_impacts.simulate(case)
    assert len(run.arrays.impacts) > 10
    assert run.energy_residual <= 1e-10
