"""Contacts that stay closed: a ball at rest, pressed on a wall or lying on a shaken table."""

import math
from typing import Any

import numpy as np
import pytest

import rattlebox as rb

GRAVITY = 9.81
BALL = rb.Sphere(diameter="18 mm", material="steel")
MASS = 7850 * 4 / 3 * math.pi * 0.009**3
MEASURED: dict[str, Any] = {
    "overlap": ("0 um", "20 um", "45 um", "70 um", "90 um"),
    "force": ("0 N", "6 N", "21 N", "42 N", "66 N"),
}
CURVE = rb.TabulatedNormal(
    **MEASURED, unloading=rb.Curve(overlap=("35 um", "55 um", "72 um", "90 um"), force=("0 N", "12 N", "33 N", "66 N"))
)
LAWS: dict[str, Any] = {
    "tsuji": rb.Tsuji(restitution=0.6),
    "tsuji overcritical": rb.Tsuji(alpha=2.5),
    "linear": rb.Linear(stiffness="80 kN/m", restitution=0.5),
    "power": rb.PowerLaw(damping_exponent=0.5, restitution=0.5, impact_speed=0.1),
}
ELASTIC: dict[str, Any] = {
    "thornton": rb.Thornton(yield_pressure="20 MPa"),
    "measured": CURVE,
    "measured, elastic": rb.TabulatedNormal(**MEASURED),
    "tsuji, elastic": rb.Tsuji(restitution=1.0),
    "linear, elastic": rb.Linear(stiffness="80 kN/m", restitution=1.0),
}
SHAKEN = rb.Shaker(motion=rb.Harmonic(amplitude="4 m/s^2", frequency="40 Hz"))


def lying(contact: Any, duration: float, structure: Any = None, rate: str = "100 Hz", **options: Any) -> rb.Run:
    """Return the run of a ball that lies on the floor of a cavity from the start."""
    gap = options.pop("gap", 1e-3)
    start = options.pop("start", -1.0)
    damper = rb.ImpactDamper(ball=BALL, gap=gap, start=start, gravity=-GRAVITY, contact=contact)
    case = rb.Case(
        structure=structure or rb.Fixed(),
        damper=damper,
        duration=duration,
        output=rb.Output(rate=rate),
        **options,
    )
    return rb.simulate(case)


@pytest.mark.parametrize("law", LAWS)
def test_a_ball_at_rest_costs_nothing(law: str) -> None:
    """An hour at rest takes as many steps as a minute; no earlier test ran a resting ball for longer than a second."""
    minute, hour = (lying(LAWS[law], duration, rate="0.1 Hz") for duration in (60.0, 3600.0))
    assert minute.ok and hour.ok
    assert hour.counts["contact_steps"] == minute.counts["contact_steps"] < 30_000
    assert hour.energy_residual < 1e-9
    force = hour.motion.cavity_force.values.ravel()
    assert force[-1] == pytest.approx(-MASS * GRAVITY, rel=1e-9)
    lost = float(hour.energy.losses.values[-1])
    assert lost == pytest.approx(float(minute.energy.losses.values[-1]), rel=1e-12)


def test_the_overlap_at_rest_is_the_static_one() -> None:
    """A ball that has come to rest overlaps the floor by weight over stiffness."""
    run = lying(LAWS["linear"], 100.0)
    overlap = -1e-3 - run.motion.ball_position.values.ravel()[-1]
    assert overlap == pytest.approx(MASS * GRAVITY / 80e3, rel=1e-9)


def test_a_ball_on_a_shaken_table_follows_in_long_steps() -> None:
    """The vibration on a linear contact is that of an oscillator, and takes a few steps for each period of the shaker."""
    run = lying(LAWS["linear"], 60.0, SHAKEN, rate="1 kHz")
    assert run.ok
    assert run.counts["contact_steps"] < 60.0 * 40.0 * 10
    # m u'' + c u' + k u = -m (g + a sin w t) for the rise u of the ball above the undeformed contact.
    rate, stiffness, a = 2 * math.pi * 40.0, 80e3, 4.0
    loss = -math.log(0.5)
    # The contact ends at zero force: e = exp(-zeta/s atan2(2 zeta s, 2 zeta^2 - 1)).
    low, high = 0.0, 0.999
    for _ in range(80):
        zeta = 0.5 * (low + high)
        s = math.sqrt(1 - zeta**2)
        low, high = (zeta, high) if zeta / s * math.atan2(2 * zeta * s, 2 * zeta**2 - 1) < loss else (low, zeta)
    dashpot = 2 * zeta * math.sqrt(MASS * stiffness)
    response = -MASS * a / (stiffness - MASS * rate**2 + 1j * rate * dashpot)
    late = run.motion.time.values > 50.0
    t = run.motion.time.values[late]
    expected = -1e-3 - MASS * GRAVITY / stiffness + (response * np.exp(1j * rate * t)).imag
    np.testing.assert_allclose(run.motion.ball_position.values.ravel()[late], expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("law", LAWS)
def test_long_steps_do_not_change_the_motion(law: str) -> None:
    """A pulse that throws a resting ball has the same effect early, before long steps begin, and late."""

    def thrown(at: float) -> rb.Run:
        return lying(
            LAWS[law],
            at + 0.3,
            rb.SDOF(mass=3, frequency="25 Hz", damping_ratio=0.2),
            load=rb.HalfSine(amplitude="900 N", duration="3 ms", start=at),
        )

    early, late = thrown(0.5), thrown(8.0)
    assert early.ok and late.ok
    first = early.impacts.time.values > 0.5
    second = late.impacts.time.values > 8.0
    assert first.sum() == second.sum() > 1
    np.testing.assert_allclose(
        late.impacts.time.values[second][:3] - 8.0, early.impacts.time.values[first][:3] - 0.5, rtol=0, atol=1e-10
    )
    np.testing.assert_allclose(
        late.impacts.approach_speed.values[second][:3], early.impacts.approach_speed.values[first][:3], rtol=1e-7
    )


def test_no_step_passes_a_knot_of_a_measured_curve() -> None:
    """A ball that vibrates on a measured curve yields no further; runs of a second hid that each cycle lost 1e-9 of it."""
    run = lying(CURVE, 5.0, start="-46 mm", gap="50 mm", rate="200 Hz")
    assert run.ok
    plastic = run.energy.plastic_loss.values.ravel()
    assert plastic[-1] == pytest.approx(plastic[200], rel=1e-13)
    assert run.energy_residual < 2e-10


@pytest.mark.parametrize("gap", [0.008, 0.06, 0.4, 6.0])
def test_the_verdict_does_not_depend_on_a_lid_out_of_reach(gap: float) -> None:
    """The same drop ends the same at each distance of the lid; the bound had a part of the height above the centre."""
    run = lying(CURVE, 3.0, gap=gap, start=f"{0.004 - gap} m")
    assert run.status == "finished"
    assert run.energy_residual < 1e-9


@pytest.mark.parametrize("law", [*LAWS, *ELASTIC])
@pytest.mark.parametrize("structure", [None, SHAKEN], ids=["fixed", "shaken"])
def test_lasting_contacts_finish(law: str, structure: Any) -> None:
    """Each law finishes at rest and on a shaken table, at the default tolerance and at looser and tighter ones."""
    contact = (LAWS | ELASTIC)[law]
    for tolerance in (1e-13, 1e-12, 1e-9):
        run = lying(contact, 2.0, structure, method=rb.EventDriven(tolerance=tolerance))
        assert run.ok, (law, tolerance, run.energy_residual)


@pytest.mark.slow
@pytest.mark.parametrize("law", [*LAWS, *ELASTIC])
@pytest.mark.parametrize("structure", [None, SHAKEN], ids=["fixed", "shaken"])
def test_lasting_contacts_finish_after_a_minute(law: str, structure: Any) -> None:
    """Each law finishes after a minute at rest and on a shaken table."""
    assert lying((LAWS | ELASTIC)[law], 60.0, structure).ok


@pytest.mark.parametrize("law", ["measured", "linear, elastic"])
def test_a_coarse_tolerance_does_not_finish(law: str) -> None:
    """A vibration whose energy is wrong by more than 1 % is an energy error, and the advice of its message helps."""
    coarse = lying(ELASTIC[law], 5.0, SHAKEN, method=rb.EventDriven(tolerance=1e-3))
    assert coarse.status == "energy_error"
    assert "Lower the tolerance" in coarse.message
    assert lying(ELASTIC[law], 5.0, SHAKEN).ok


@pytest.mark.parametrize("law", [*LAWS, *ELASTIC])
def test_a_wrong_ledger_of_a_lasting_contact_is_an_energy_error(law: str) -> None:
    """An error of 1e-4 of the energy put in exceeds the bound also after many steps."""
    from rattlebox.core._core import Status
    from rattlebox.engines.status import final_status

    run = lying((LAWS | ELASTIC)[law], 2.0, SHAKEN)
    arrays = run.arrays
    put_in = float(abs(run.ledger.gravity - run.ledger.gravity[0]).max() + abs(arrays.base_work).max())
    wrong = rb.Run(arrays.replaced(viscous_loss=arrays.viscous_loss + 1e-4 * put_in * (arrays.time > 1)))
    steps = run.counts["contact_steps"]
    # The permitted error of a run of this length, from its number of steps.
    permitted = 1e-12 * 12 * put_in * steps
    assert final_status(run.ledger, 1e-8, MASS, permitted=permitted, rounding=1e-13) == Status.finished
    assert final_status(wrong.ledger, 1e-8, MASS, permitted=permitted, rounding=1e-13) == Status.energy_error


@pytest.mark.parametrize("balls", [1, 3])
@pytest.mark.parametrize("gap", ["2 mm", "1.7 m"])
def test_the_residual_of_a_stack_at_rest_is_rounding(balls: int, gap: str) -> None:
    """Hard balls that rest on each other have no residual; it was one, rounding over rounding."""
    damper = rb.ImpactDamper(
        balls=[BALL] * balls,
        gap=gap,
        start=-1.0,
        gravity=-GRAVITY,
        contact=rb.Tsuji(restitution=0.5),
    )
    method = rb.Newton(restitution=0.5)
    run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, duration=5.0, method=method))
    assert run.ok
    assert run.energy_residual < 1e-8
