"""The ledger of the 3-D engine closes at second order of the step, and no loss is negative."""

from typing import Any

import numpy as np
import pytest
from support import dem_cases
from support.dem_cases import Ball

import rattlebox as rb

from .test_conservation import LAWS, cloud

CHANNELS = ("normal_loss", "plastic_loss", "sliding_loss", "rolling_loss", "viscous_loss")
LIGHT = rb.SDOF(mass=0.3, stiffness=2e4, damping=3.0, velocity=1.0)
AT_REST = rb.SDOF(mass=0.3, stiffness=2e4, damping=3.0)
SWING = rb.Harmonic(amplitude="300 m/s^2", frequency=150, direction="z")
SWAY = rb.Harmonic(amplitude="200 m/s^2", frequency=90, direction="x", phase=1.0)
JERK = rb.Harmonic(amplitude="150 m/s^2", frequency=120, direction="y", phase=0.4)
DRIVES: dict[str, dict[str, Any]] = {
    "a start": {"structure": LIGHT},
    "a shaker": {"structure": rb.Shaker(motion=[SWING, SWAY, JERK])},
    "a base": {"structure": AT_REST, "base": [SWAY]},
    "loads": {
        "structure": AT_REST,
        "loads": [
            rb.HalfSine(amplitude=200, duration="2 ms", start="0.32 ms"),
            rb.Record(times=[0, 0.0016, 0.0032, 0.0048], values=[0, 50, -50, 10]),
        ],
    },
}


def run_spheres(law: str, dt: float, drive: str = "a start") -> Any:
    """Return the run of a hundred and twenty spheres with gravity and a type of excitation."""
    case = cloud(
        law, random=1.0, gravity=(1.0, 0, -9.81), duration=0.0048, rate=6250.0, method=rb.Dem(dt=dt * (1 + 1e-9))
    )
    parts = {"dampers": case.dampers, "duration": case.duration, "output": case.output, "method": case.method}
    return dem_cases.run(rb.Case(**parts, **DRIVES[drive]), closes=False)


@pytest.mark.parametrize(
    ("law", "drive"), [*((law, "a start") for law in LAWS), *(("rough", drive) for drive in list(DRIVES)[1:])]
)
def test_ledger_closes_at_second_order(law: str, drive: str) -> None:
    """At all samples supplied, lost and stored energy balance; the residual is four times smaller with half the step."""
    coarse, fine = (run_spheres(law, dt, drive).energy_residual for dt in (4e-6, 5e-7))
    assert coarse < 2e-3
    # Without dashpots the order is 5/2 to 3, that of the energy of Verlet's method.
    order = np.log2(coarse / fine) / 3
    assert order == pytest.approx(2.7 if law == "yielding" else 2, abs=0.35)


@pytest.mark.parametrize("law", LAWS)
def test_no_loss_decreases(law: str) -> None:
    """Each loss, between particles and at walls, is never negative and never decreases."""
    arrays = run_spheres(law, 4e-6).arrays
    for name in CHANNELS:
        lost = getattr(arrays, name)
        assert lost.min() >= 0, name
        assert np.diff(lost, axis=0).min(initial=0) >= 0, name
    assert (arrays.normal_loss[-1].min() > 0) == (law != "yielding")
    assert (arrays.sliding_loss[-1].min() > 0) == (law != "smooth")
    assert (arrays.rolling_loss[-1].min() > 0) == (law not in ("smooth", "rough"))


@pytest.mark.parametrize("law", ["Hertz", "linear"])
@pytest.mark.parametrize("e", [0.1, 0.3, 0.6, 0.9])
def test_ledger_of_one_impact_closes(law: str, e: float) -> None:
    """With the automatic step a single impact closes to a hundredth of its energy, whatever its loss."""
    ball = Ball(2e-3)
    contact = rb.Tsuji(restitution=e) if law == "Hertz" else rb.Linear(contact_time="10 us", restitution=e)
    for gap in np.linspace(1.00, 1.05, 7):
        damper = dem_cases.damper(
            [Ball(ball.radius, (0, 0, 0), (1, 0, 0))],
            cavity=rb.Box(size=(6e-3 + 2e-3 * gap, 0.1, 0.1)),
            contact=contact,
        )
        run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, duration=4e-3, output=rb.Output(times=[4e-3])))
        assert run.ok and run.energy_residual < 0.01


@pytest.mark.parametrize("law", ["rough", "rolling"])
def test_work_on_moving_balls_begins_at_zero(law: str) -> None:
    """The work on balls that move at the start on a shaken base begins at zero, and the ledger closes."""
    residuals = []
    for dt in (2e-6, 2.5e-7):
        case = cloud(law, random=1.0, duration=0.0048, rate=6250.0, method=rb.Dem(dt=dt * (1 + 1e-9)))
        parts = {"dampers": case.dampers, "duration": case.duration, "output": case.output, "method": case.method}
        swing = rb.Harmonic(amplitude="300 m/s^2", frequency=150, direction="x", phase=np.pi / 2)
        run = dem_cases.run(rb.Case(**parts, structure=AT_REST, base=swing), closes=False)
        assert run.arrays.base_work[0] == 0
        residuals.append(run.energy_residual)
    assert np.log2(residuals[0] / residuals[1]) / 3 == pytest.approx(2, abs=0.35)


@pytest.mark.parametrize("law", ["sliding", "rolling"])
def test_springs_of_sliding_contacts_hold_what_friction_allows(law: str) -> None:
    """The springs of a sliding ball, or of one with rolling resistance, store (mu N)^2 / (2 k_t) to second order."""
    rolls = law == "rolling"
    radius, pull, stiffness, ratio, half = 5e-3, 1000.0, 1e6, 0.3, 0.05
    friction, resistance = (0.5, 0.02) if rolls else (0.05, 0.0)
    ball = Ball(radius, (-half / 2, 0, radius - half), (1, 0, 0), (0, 1 / radius if rolls else 0, 0))
    weight = ball.mass * pull
    rubbing = 5 / 7 * resistance * weight if rolls else friction * weight
    pressed = weight**2 / (2 * stiffness)
    held = (rubbing**2 + (resistance * weight) ** 2) / (2 * ratio * stiffness)
    excess = []
    for dt in (4e-7, 1e-7):
        case = dem_cases.case(
            [ball],
            dt=dt,
            steps=round(0.005 / dt),
            samples=5,
            cavity=rb.Box(size=(2 * half,) * 3),
            contact=rb.Linear(stiffness=stiffness, restitution=0.5),
            friction=rb.LinearSpring(friction, ratio=ratio),
            rolling=rb.Rolling(resistance, damping=0.3) if rolls else None,
            gravity=(0, 0, -pull),
        )
        excess.append((dem_cases.run(case).arrays.contact_energy[3:, 0] - pressed) / held - 1)
    assert np.all(np.abs(excess[0]) < (0.35 if rolls else 0.025))
    assert np.all(np.abs(excess[1]) < np.abs(excess[0]) / 12)
