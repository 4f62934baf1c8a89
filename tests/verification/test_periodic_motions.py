"""Periodic motions against closed forms: states, multipliers and stability.

Studies found stable motions only, by running into them, so that no test could compare an unstable motion or the angle of a
multiplier with theory.
"""

import itertools
import math

import numpy as np
import pytest
from tests.support import impact_cases
from tests.support.exact import impact_oscillator, masri_caughey, shaken

import rattlebox as rb

GRID = list(itertools.product((0.05, 0.1), (0.3, 0.5, 0.75), (12.0, 20.0, 30.0)))
"""Mass ratio, restitution and clearance."""


def masri_caughey_motions():
    """Return all symmetric motions with two impacts a cycle over the grid."""
    return [(key, orbit) for key in GRID for orbit in masri_caughey.orbits(*key)]


@pytest.mark.parametrize(("key", "exact"), masri_caughey_motions())
def test_two_impacts_a_cycle(key, exact):
    """Amplitude, phases, approach speeds and all multipliers of two impacts a cycle are those of the closed form."""
    case = impact_cases.impact_damper(exact, 2.0)
    begin = exact.zero_crossing()
    start = np.array([*exact.structure(begin), *exact.ball(begin)])
    orbit = rb.find_orbit(case, near=start * (1 + 1e-3 * np.array([1, -1, 1, 1])), period=1)
    assert orbit.is_symmetric
    assert orbit.amplitudes["mass"] == pytest.approx(largest(exact), rel=1e-9)
    left = (exact.half_period - begin) / (2 * exact.half_period)
    assert [impact.phase for impact in orbit.impacts] == pytest.approx([left, left + 0.5], abs=1e-9)
    assert [impact.approach_speed for impact in orbit.impacts] == pytest.approx([exact.approach] * 2, rel=1e-9)
    expected = exact.multipliers().astype(complex) ** 2
    for value in orbit.multipliers:
        assert np.abs(expected - value).min() < 1e-9 * max(1.0, abs(value))
    assert orbit.is_stable == (abs(expected).max() < 1)
    assert orbit.determinant_error < 1e-8


def largest(orbit):
    """Return the largest displacement of the structure on a fine grid, corrected by a parabola."""
    times = np.linspace(0, orbit.half_period, 4001)
    values = np.array([orbit.structure(float(t)) for t in times])
    k = int(np.abs(values[:, 0]).argmax())
    if k in (0, times.size - 1):
        return abs(values[k, 0])
    sign, low, high = math.copysign(1.0, values[k, 0]), times[k - 1], times[k + 1]
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if sign * orbit.structure(middle)[1] > 0 else (low, middle)
    return abs(orbit.structure(low)[0])


@pytest.mark.parametrize("restitution", [0.5, 0.8])
def test_bouncing_ball(restitution):
    """The ball on a table has its stable and its unstable motion with the exact trace and determinant of the map."""
    exact = shaken.table_orbit(restitution, 1.02 * shaken.table_bounds(restitution, 1)[0], 1)
    case = impact_cases.table(exact, 1.0)
    stable = rb.find_orbit(case, near=[height(case), ball_speed(case)], period=1)
    assert stable.is_stable
    assert len(stable.impacts) == 1
    assert stable.impacts[0].approach_speed == pytest.approx(exact.approach, rel=1e-10)
    # The map of phase and launch speed has the determinant e^2, and with the table's acceleration at the impact the trace
    # 1 + e^2 - (1 + e)^2 gamma sin(phase), in these units.
    trace = 1 + restitution**2 - (1 + restitution) ** 2 * exact.gamma * math.sin(exact.phase)
    assert np.prod(stable.multipliers).real == pytest.approx(restitution**2, rel=1e-8)
    assert np.sum(stable.multipliers).real == pytest.approx(trace, rel=1e-8)


def height(case):
    """Return the position of the only ball at the start."""
    return float(case.impact_dampers[0].positions0[0])


def ball_speed(case):
    """Return the velocity of the only ball at the start."""
    return float(case.impact_dampers[0].velocities0[0])


@pytest.mark.parametrize(("stop", "restitution"), [(0.0, 0.8), (0.3, 0.5)])
def test_impact_oscillator(stop, restitution):
    """An oscillator against a stop has the exact approach speed and determinant with one impact a cycle."""
    (exact, *_) = impact_oscillator.orbits(0.05, 2.0, stop, restitution)
    x, v = exact.state(1.0)
    case = rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=1.0, damping_ratio=0.05, displacement=x, velocity=v),
        stop=rb.Stop(gap=stop, contact=rb.Linear(stiffness=1.0, restitution=restitution)),
        load=rb.Harmonic(amplitude=1.0, frequency="2 rad/s", phase=2.0 + exact.load_phase + math.pi / 2),
        duration=30.0,
        method=rb.Newton(restitution=restitution),
    )
    orbit = rb.find_orbit(case, near=[x, v], period=1)
    assert len(orbit.impacts) == 1
    assert orbit.impacts[0].approach_speed == pytest.approx(exact.speed, rel=1e-10)
    assert orbit.determinant_error < 1e-8
    assert not orbit.is_symmetric


@pytest.mark.parametrize("size", [0.2, 0.5, 2.0])
def test_slow_manifold(size):
    """A ball in a cavity with a prescribed motion has the reach of the slow manifold at each amplitude."""
    exact = shaken.two_impacts(0.6, size)
    case = impact_cases.shaken_cavity(exact, 1.0)
    orbit = rb.find_orbit(case, near=[height(case) + 1e-3, ball_speed(case)], period=1)
    assert orbit.is_symmetric
    assert [impact.approach_speed for impact in orbit.impacts] == pytest.approx([exact.approach] * 2, rel=1e-10)


def two_dampers(**changes):
    """Return a symmetric case with two dampers on two modes."""
    ball = rb.Sphere(radius="9 mm", material="steel")
    law = rb.Tsuji(restitution=0.7)
    structure = rb.ShearBuilding(masses=["2 kg", "1.5 kg"], stiffnesses=["30 kN/m", "25 kN/m"], damping_ratio=0.01)
    case = rb.Case(
        structure=structure,
        dampers=[
            rb.ImpactDamper(ball=ball, gap="1 mm", contact=law, point="storey 2", velocity="0.1 m/s"),
            rb.ImpactDamper(ball=ball, gap="1.2 mm", contact=law, point="storey 1", velocity="-0.1 m/s"),
        ],
        load=rb.Harmonic(amplitude="8 N", frequency="9.5 Hz", point="storey 2"),
        method=rb.Newton(),
        duration="12 s",
    )
    return case.replaced(changes) if changes else case


def test_two_dampers_on_two_modes():
    """A motion of two dampers on two modes repeats, and its determinant is that of its losses."""
    orbit = rb.find_orbit(two_dampers())
    assert orbit.residual < 1e-11
    assert orbit.determinant_error < 1e-7
    run = orbit.run(3)
    speeds = run.arrays.impacts.approach_speed.reshape(3, -1)
    np.testing.assert_allclose(speeds, np.broadcast_to(speeds[0], speeds.shape), rtol=1e-6)


def test_soft_contacts():
    """With soft contacts the multipliers describe the decay of a disturbance of a run."""
    case = rb.Case(
        structure=rb.SDOF(mass="1.2 kg", stiffness="50 kN/m", damping_ratio=0.01),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="13 mm", material="steel"), gap="1.1 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        load=rb.Harmonic(amplitude="5 N", frequency="33.5 Hz"),
        duration="6 s",
    )
    orbit = rb.find_orbit(case)
    assert orbit.is_stable
    assert orbit.is_symmetric
    assert math.isnan(orbit.determinant_error)
    arrays = orbit.run(2).arrays
    assert arrays.displacement[-1, 0] == pytest.approx(arrays.displacement[0, 0], rel=1e-9)


def equal_dampers(points, shapes):
    """Return a structure with two equal modes and loads, and an equal damper at each of two points."""
    return rb.Case(
        structure=rb.Modal(frequencies=[31.0, 31.0], damping_ratios=[0.01, 0.01], shapes=shapes),
        dampers=[
            rb.ImpactDamper(
                name=f"damper at {point}",
                ball=rb.Sphere(radius=9e-3, material="steel"),
                gap=1e-3,
                contact=rb.Tsuji(restitution=0.6),
                point=point,
            )
            for point in points
        ],
        loads=[rb.Harmonic(amplitude=5.0, frequency=32.5, point=point) for point in points],
        method=rb.Newton(),
        duration=3.0,
    )


def test_coinciding_impacts_that_do_not_act_on_each_other():
    """Equal dampers on two separate oscillators have twice the multipliers of one.

    Differences of the motion had an error of 2e-4 in the determinant, which no test stated as a limit.
    """
    both = rb.find_orbit(equal_dampers("ab", {"a": [1.0, 0.0], "b": [0.0, 1.0]}))
    one = equal_dampers("a", {"a": [1.0, 0.0]}).model_copy(
        update={"structure": rb.Modal(frequencies=[31.0], damping_ratios=[0.01], shapes={"a": [1.0]})}
    )
    single = rb.find_orbit(one)
    assert len(both.impacts) == 2 * len(single.impacts)
    for value in single.multipliers:
        assert (np.abs(both.multipliers - value) < 1e-6).sum() == 2
    assert both.determinant_error < 1e-8


def test_coinciding_impacts_that_act_on_each_other():
    """Equal dampers whose impacts change each other's approach speed are refused; their advice leads to a motion.

    The map jumps there, and its differences were given as multipliers of any size, up to 1e5 with a step of 1e-7.
    """
    case = equal_dampers("ab", {"a": [1.0, 0.3], "b": [0.3, 1.0]})
    with pytest.raises(rb.CaseError, match="depends on their order") as raised:
        rb.find_orbit(case)
    assert "mass of all" in raised.value.suggestion
    assert rb.find_orbit(case.model_copy(update={"dampers": case.dampers[:1]})).is_stable is not None
