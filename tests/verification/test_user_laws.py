"""The rebound with power laws and measured curves agrees with an independent integration in both engines."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import rattlebox as rb

RADIUS, MASS, SPEED = 5e-3, 4 / 3 * math.pi * 5e-3**3 * 7800.0, 1.3
STEEL = rb.Material(name="plain steel", density=7800.0, young=210e9, poisson=0.3)
HERTZ = 4 / 3 * (210e9 / (2 * (1 - 0.3**2))) * math.sqrt(RADIUS)  # ball on a wall of the same material


def rebound(force: Any, mass: float, speed: float, *, tension: bool = False) -> float:
    """Return the speed after an impact on a wall whose force is force(overlap, rate), integrated by SciPy."""

    def ends(_: float, y: Any) -> float:
        return float(y[0]) if tension or y[1] > 0 else float(min(y[0], force(max(y[0], 0.0), y[1])))

    ends.terminal, ends.direction = True, -1.0  # type: ignore[attr-defined]
    motion = solve_ivp(
        lambda _, y: [y[1], -force(max(y[0], 0.0), y[1]) / mass],
        (0.0, 1.0),
        [0.0, speed],
        method="DOP853",
        events=ends,
        rtol=1e-11,
        atol=1e-16,
        max_step=1e-5,
    )
    return -float(motion.y_events[0][-1][1])


def impact(contact: Any, speed: float = SPEED, method: Any = None) -> Any:
    """Return a run of a ball that hits the wall of a fixed cavity in the 1-D engine."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius=RADIUS, material=STEEL), gap="1 mm", velocity=speed, wall=STEEL, contact=contact
    )
    case = rb.Case(
        structure=rb.Fixed(),
        damper=damper,
        duration=2e-3 / speed,
        method=rb.EventDriven() if method is None else method,
    )
    return rb.simulate(case)


def particle(contact: Any, speed: float = SPEED, **options: Any) -> Any:
    """Return a run of the same ball in the 3-D engine."""
    damper = rb.ParticleDamper(
        particles=rb.Particles(material=STEEL, radius=RADIUS, count=1),
        cavity=rb.Box(size=("12 mm",) * 3),
        packing=rb.Positions(positions=[(0.0, 0.0, 0.0)]),
        wall=STEEL,
        contact=contact,
        velocity=(speed, 0, 0),
        gravity=(0, 0, 0),
        **options,
    )
    return rb.simulate(
        rb.Case(structure=rb.Fixed(), damper=damper, duration=2e-3 / speed, method=rb.Dem(fraction=0.005))
    )


POWER = {
    "Hunt and Crossley": {"damping_exponent": 1.5, "damping": 1.5 * 0.3 * HERTZ},
    "Kuwabara and Kono": {"damping_exponent": 0.5, "damping": 2e4},
    "with tension": {"damping_exponent": 0.25, "damping": 1200.0, "ending": "zero_overlap"},
    "stiffening": {"stiffness": 5e15, "exponent": 2.5, "damping_exponent": 1.0, "damping": 3e6},
}


@pytest.mark.parametrize("name", POWER)
def test_power_laws_rebound_as_their_equation(name: str) -> None:
    """The 1-D engine agrees with SciPy to 1e-8, the 3-D engine to 1e-3 at a hundredth of the usual step."""
    law = rb.PowerLaw(**POWER[name])
    k, c = POWER[name].get("stiffness", HERTZ), POWER[name]["damping"]
    expected = rebound(
        lambda d, v: k * d**law.exponent + c * d**law.damping_exponent * v,
        MASS,
        SPEED,
        tension=law.ending == "zero_overlap",
    )
    assert expected < 0.97 * SPEED
    run = impact(law)
    assert run.ok
    assert float(run.impacts.separation_speed[0]) == pytest.approx(expected, rel=1e-8)
    run = particle(law)
    assert run.ok
    assert -run.arrays.particles.velocity[0, 0] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("ending", ["zero_force", "zero_overlap"])
@pytest.mark.parametrize("exponent", [0.25, 0.5, 1.5])
def test_restitution_asked_for_is_met(exponent: float, ending: str) -> None:
    """An impact at the stated speed has the stated restitution, also where sizes and softening differ."""
    law = rb.PowerLaw(damping_exponent=exponent, restitution=0.7, impact_speed=SPEED, ending=ending)
    run = impact(law)
    assert float(run.impacts.separation_speed[0]) / SPEED == pytest.approx(0.7, rel=1e-8)
    run = particle(law, softening=30.0)
    assert -run.arrays.particles.velocity[0, 0] / SPEED == pytest.approx(0.7, rel=1e-3)


def test_hunt_and_crossley_lose_in_proportion_to_the_speed() -> None:
    """Restitution is 1 - a V for slow impacts, with c = (3/2) a k, as in Hunt and Crossley."""
    a = 0.02
    law = rb.PowerLaw(damping_exponent=1.5, damping=1.5 * a * HERTZ)
    for speed in (0.5, 1.0):
        e = float(impact(law, speed).impacts.separation_speed[0]) / speed
        assert 1 - e == pytest.approx(a * speed, rel=3 * a * speed)


def test_lankarani_and_nikravesh_for_nearly_elastic_impacts() -> None:
    """Near e = 1 the dashpot is c = 3 k (1 - e^2) / (4 V), the formula of Lankarani and Nikravesh."""
    pair = rb.contact_pairs(
        rb.Case(
            structure=rb.Fixed(),
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius=RADIUS, material=STEEL), gap="1 mm", contact=rb.Tsuji(restitution=0.9)
            ),
            duration=1.0,
        ),
        0,
    )[0]
    for e in (0.999, 0.99):
        law = rb.PowerLaw(damping_exponent=1.5, restitution=e, impact_speed=2.0)
        _, values = law.coefficients(pair)
        assert values["damping"] == pytest.approx(3 * values["stiffness"] * (1 - e**2) / (4 * 2.0), rel=2 * (1 - e))


# A curve that is no simple power, and one measured while unloading from 100 um with a residual overlap of 40 um.
OVERLAP = np.linspace(0, 1e-4, 21)
FORCE = 4e9 * OVERLAP**1.5 + 3e5 * OVERLAP
BACK = np.linspace(0.4e-4, 1e-4, 13)
MEASURED = rb.TabulatedNormal(
    overlap=tuple(OVERLAP),
    force=tuple(FORCE),
    unloading=rb.Curve(overlap=tuple(BACK), force=tuple(FORCE[-1] * ((BACK - BACK[0]) / (BACK[-1] - BACK[0])) ** 1.5)),
)


def energy_left(speed: float) -> float:
    """Return the restitution of the two measured curves, by quadrature of SciPy's interpolation."""
    from scipy.interpolate import PchipInterpolator
    from scipy.optimize import brentq

    load = PchipInterpolator(OVERLAP, FORCE)
    work = load.antiderivative()
    deepest = brentq(lambda d: work(d) - 0.5 * MASS * speed**2, 1e-9, 1e-4)
    shape = PchipInterpolator(BACK / BACK[-1], MEASURED.unloading.force / FORCE[-1])  # type: ignore[union-attr]
    back = load(deepest) * deepest * shape.integrate(0.4, 1.0)
    return math.sqrt(back / (0.5 * MASS * speed**2))


@pytest.mark.parametrize("speed", [0.2, 1.0])
def test_measured_curves_give_back_what_unloading_holds(speed: float) -> None:
    """Restitution is the root of the ratio of the areas under both curves, in both engines; the ledger contains the loss."""
    expected = energy_left(speed)
    assert expected < 0.95
    run = impact(MEASURED, speed)
    assert run.ok
    assert float(run.impacts.separation_speed[0]) / speed == pytest.approx(expected, rel=1e-8)
    assert float(run.impacts.energy_lost[0]) == pytest.approx(0.5 * MASS * speed**2 * (1 - expected**2), rel=1e-8)
    run = particle(MEASURED, speed)
    assert run.ok
    assert -run.arrays.particles.velocity[0, 0] / speed == pytest.approx(expected, rel=2e-3)
    assert float(run.arrays.plastic_loss.sum(axis=(1, 2))[-1]) == pytest.approx(
        0.5 * MASS * speed**2 * (1 - expected**2), rel=5e-3
    )


@pytest.mark.parametrize("speed", [2.0, 12.0, 40.0])
def test_hard_impacts_of_a_measured_curve_lose_as_much_as_its_contact(speed: float) -> None:
    """Below and beyond the last point of the curve, the method Newton has the rebound of the contact with a duration."""
    soft, hard = (impact(MEASURED, speed, method).impacts for method in (rb.EventDriven(), rb.Newton()))
    assert (float(soft.peak_overlap[0]) > OVERLAP[-1]) == (speed > 10)
    assert float(hard.separation_speed[0]) == pytest.approx(float(soft.separation_speed[0]), rel=1e-4)


def test_a_measured_curve_without_unloading_is_elastic() -> None:
    """There is no loss; at the largest overlap the work of loading equals the kinetic energy."""
    law = rb.TabulatedNormal(overlap=tuple(OVERLAP), force=tuple(FORCE))
    run = impact(law)
    assert float(run.impacts.separation_speed[0]) == pytest.approx(SPEED, rel=1e-9)
    assert float(run.impacts.peak_force[0]) < FORCE[-1]
    run = particle(law)
    assert -run.arrays.particles.velocity[0, 0] == pytest.approx(SPEED, rel=1e-3)


def test_user_laws_work_with_friction_in_tables_and_sweeps(tmp_path: Any) -> None:
    """The laws work in case files, in sweeps of their coefficients, and with friction."""
    for law in (rb.PowerLaw(restitution=0.8, impact_speed=1.0), MEASURED):
        run = particle(law, friction=0.3, rolling=0.01)
        case = rb.Case.from_toml(run.case_toml)
        again = rb.simulate(case)
        np.testing.assert_array_equal(again.arrays.particles.velocity, run.arrays.particles.velocity)
    base = rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness="10 kN/m"),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius=RADIUS, material=STEEL),
            gap="0.1 mm",
            velocity="0.3 m/s",
            contact=rb.PowerLaw(restitution=0.8, impact_speed=1.0),
        ),
        duration="50 ms",
    )
    study = rb.sweep(base, {"damper.contact.restitution": [0.6, 0.8, 0.95]}, ["impact_share"])
    for k, e in enumerate((0.6, 0.8, 0.95)):
        alone = rb.sweep(base, {"damper.contact.restitution": [e]}, ["impact_share"])
        assert 0 < float(study.impact_share[k]) == float(alone.impact_share[0])


@pytest.mark.parametrize(
    ("values", "field"),
    [
        ({"damping_exponent": 1.5, "restitution": 0.8}, "impact_speed"),
        ({"exponent": 2.0, "restitution": 0.8, "impact_speed": 1.0}, "stiffness"),
        ({"restitution": 0.8, "damping": 1.0, "impact_speed": 1.0}, "damping"),
        ({}, "restitution"),
    ],
)
def test_power_laws_that_are_not_determined_are_refused(values: dict[str, Any], field: str) -> None:
    """Too few or too many numbers end in an error that names the field."""
    with pytest.raises(rb.CaseError, match=field):
        rb.PowerLaw(**values)


@pytest.mark.parametrize(
    "values",
    [
        {"overlap": (0.0, 1e-5), "force": (0.0,)},
        {"overlap": (0.0, 1e-5, 1e-5), "force": (0.0, 1.0, 2.0)},
        {"overlap": (0.0, 1e-5), "force": (1.0, 2.0)},
        {"overlap": (0.0, 1e-5), "force": (0.0, 2.0), "unloading": {"overlap": (5e-6, 1e-5), "force": (0.0, 3.0)}},
        {
            "overlap": (0.0, 1e-5, 2e-5),
            "force": (0.0, 1.0, 4.0),
            "unloading": {"overlap": (0.0, 2e-5), "force": (0.0, 4.0)},
        },
    ],
)
def test_curves_that_make_no_sense_are_refused(values: dict[str, Any]) -> None:
    """Lengths, order, start, common end of both curves, and generation of energy are checked."""
    with pytest.raises(rb.CaseError):
        rb.TabulatedNormal(**values)
