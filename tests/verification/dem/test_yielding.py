"""Plastic contacts in the 3-D engine: restitution, plastic loss and reloading against closed forms."""

import math
from typing import Any

import numpy as np
import pytest
from support import dem_cases
from support.dem_cases import Ball
from support.exact import printed, restitution_laws

import rattlebox as rb

STEEL = rb.materials()["steel"]
PRESSURE = 1.6 * STEEL.yield_stress
SMALL, LARGE = Ball(2e-3), Ball(7e-3)

# The deepest overlap falls between two steps: order 2, like Verlet itself. The factor is what was measured, a fifth above
# the worst of four phases, with 40 to 640 steps in an elastic contact and speeds from the yield speed to a hundred times.
FACTOR, ORDER = 0.8, 2


def modulus(wall: Any = None) -> float:
    """Return E* of steel against steel, or a rigid wall [Pa]."""
    return STEEL.young / (1 - STEEL.poisson**2) / (1 if wall == "rigid" else 2)


def yield_speed(first: Ball, second: Ball | None) -> float:
    """Return V_y of a pair, or of a ball at a wall of steel [m/s]."""
    radius = first.radius if second is None else dem_cases.reduced(first.radius, second.radius)
    mass = first.mass if second is None else dem_cases.reduced(first.mass, second.mass)
    return restitution_laws.thornton_speed(radius, mass, modulus(), PRESSURE)


def impact(
    first: Ball, second: Ball | None, ratio: float, per_contact: int, phase: float
) -> tuple[float, float, float]:
    """Return restitution, and plastic loss and all other loss over the energy of the relative motion."""
    speed = ratio * yield_speed(first, second)
    time = dem_cases.contact_time(first, second, speed)
    case = dem_cases.head_on(
        first, second, speed, dt=time / per_contact, phase=phase, lasts=4 * time, contact=rb.Thornton(), one_kind=True
    )
    result = dem_cases.run(case)
    mass = first.mass if second is None else dem_cases.reduced(first.mass, second.mass)
    arrays = result.arrays
    others = arrays.normal_loss[-1].sum() + arrays.sliding_loss[-1].sum() + arrays.rolling_loss[-1].sum()
    energy = 0.5 * mass * speed**2
    return dem_cases.rebound(result) / speed, arrays.plastic_loss[-1].sum() / energy, others / energy


@pytest.mark.parametrize("pair", [(SMALL, None), (SMALL, LARGE), (LARGE, LARGE)], ids=["wall", "unequal", "equal"])
@pytest.mark.parametrize("ratio", [0.9, *printed.THORNTON])
def test_restitution_and_plastic_loss_have_the_closed_form(ratio: float, pair: tuple[Ball, Ball | None]) -> None:
    """A plastic contact has the exact restitution, and only the plastic loss m V^2/2 (1 - e^2)."""
    exact = restitution_laws.thornton(ratio)
    for per_contact, phase in ((80, 0.3), (80, 0.8), (320, 0.55)):
        e, plastic, others = impact(*pair, ratio, per_contact, phase)
        assert e == pytest.approx(exact, abs=FACTOR * per_contact**-ORDER)
        assert plastic == pytest.approx(1 - exact**2, abs=FACTOR * per_contact**-ORDER)
        assert others == 0
        if ratio < 1:
            assert plastic == 0


def test_errors_fall_at_the_stated_order() -> None:
    """With sixteen times shorter steps the largest error of the restitution over a range of speeds is 2^8 times smaller."""

    def worst(per_contact: int) -> float:
        errors = [
            impact(SMALL, None, ratio, per_contact, phase)[0] - restitution_laws.thornton(ratio)
            for ratio in (1.5, 2, 5, 10)
            for phase in (0.02, 0.3, 0.55, 0.8)
        ]
        return float(np.abs(errors).max())

    assert math.log2(worst(40) / worst(640)) / 4 == pytest.approx(ORDER, abs=0.3)


GRAVITY = 2e5  # presses the ball into the floor about as far as yielding begins


def pressed(swing: float) -> tuple[Any, Any]:
    """Return run and overlap of a ball that settles on a steel floor, which shakes in the second half of the run."""
    depth = (SMALL.mass * GRAVITY / dem_cases.stiffness(SMALL)) ** (2 / 3)
    time = 2 * math.pi * math.sqrt(depth / GRAVITY)
    dt, steps = time / 200, 8000
    motion = rb.Harmonic(
        amplitude=f"{swing * GRAVITY} m/s^2", frequency=1 / (3.3 * time), start=0.5 * steps * dt, direction="z"
    )
    half = 5 * SMALL.radius
    case = dem_cases.case(
        [Ball(SMALL.radius, (0, 0, SMALL.radius - half))],
        dt=dt,
        steps=steps,
        samples=steps,
        cavity=rb.Box(size=(2 * half,) * 3),
        contact=rb.Thornton(),
        gravity=(0, 0, -GRAVITY),
        structure=rb.Shaker(motion=motion),
    )
    arrays = dem_cases.run(case).arrays
    return arrays, SMALL.radius - half - arrays.centre_of_mass[:, 0, 2]


def forces(overlap: Any) -> tuple[Any, Any]:
    """Return force and plastic loss along a history of overlaps, from the closed forms."""
    stiff, hard, radius = dem_cases.stiffness(SMALL), PRESSURE, SMALL.radius
    first = radius * (math.pi * hard / (2 * modulus())) ** 2
    deepest = np.maximum.accumulate(overlap)
    past = np.maximum(deepest - first, 0.0)
    top = stiff * first**1.5 + math.pi * hard * radius * past
    curve = 4 * modulus() / (3 * top) * ((2 * top + stiff * first**1.5) / (2 * math.pi * hard)) ** 1.5
    slope = 4 / 3 * modulus() * np.sqrt(curve)
    dent = deepest - (top / slope) ** (2 / 3)
    yielded = slope * np.maximum(overlap - dent, 0.0) ** 1.5
    spent = 0.4 * stiff * first**2.5 + past * (stiff * first**1.5 + 0.5 * math.pi * hard * radius * past)
    force = np.where(past > 0, yielded, stiff * np.maximum(overlap, 0) ** 1.5)
    return force, np.where(past > 0, spent - 0.4 * slope * (deepest - dent) ** 2.5, 0.0)


def test_reloading_is_elastic_up_to_the_deepest_overlap() -> None:
    """A loaded ball on a shaken floor follows the unloading curve of its deepest overlap, and yields beyond it."""
    arrays, overlap = pressed(0.5)
    half = overlap.size // 2
    force, plastic = forces(overlap)
    assert overlap[1:].min() > 0
    assert np.abs(-arrays.cavity_force[:, 0, 2] - force).max() < 1e-9 * force.max()
    loss = arrays.plastic_loss[:, 0, 1]
    assert loss == pytest.approx(plastic, rel=1e-9, abs=1e-12 * plastic[-1])
    # Twenty cycles without loss, except for the difference between the deepest step and the peak: (pi/200)^2/2 of a cycle.
    assert loss[half] == pytest.approx(loss[200], rel=2e-4)
    assert np.ptp(overlap[half - 400 : half]) == pytest.approx(np.ptp(overlap[400:800]), rel=1e-4)
    assert loss[-1] > 1.3 * loss[half]
