"""Branches of periodic motions: limits of stability, branches that begin there, and grazing, against closed forms.

A slow sweep shows the stable part of a branch only, so that no test compared a bifurcation with theory.
"""

import math
import time

import numpy as np
import pytest
from scipy.optimize import brentq
from tests.support import impact_cases
from tests.support.exact import impact_oscillator, masri_caughey, riding_ball, shaken

import rattlebox as rb

AMPLITUDE = "structure.motion[0].amplitude"


def table_branch(restitution, limits):
    """Return the branch of a ball that bounces on a table, one impact a cycle, over the amplitude."""
    exact = shaken.table_orbit(restitution, 1.02 * shaken.table_bounds(restitution, 1)[0], 1)
    case = impact_cases.table(exact, 1.0)
    damper = case.impact_dampers[0]
    start = [float(damper.positions0[0]), float(damper.velocities0[0])]
    return rb.continue_orbit(rb.find_orbit(case, near=start, period=1), AMPLITUDE, limits, progress=False)


@pytest.mark.parametrize("restitution", [0.5, 0.8])
def test_bouncing_ball(restitution):
    """The ball on a table appears in a fold and doubles its period at the values of the textbook."""
    fold, flip = shaken.table_bounds(restitution, 1)
    branch = table_branch(restitution, (0.9 * fold, 1.3 * flip))
    located = {point.kind: point.value for point in branch.specials}
    assert located["fold"] == pytest.approx(fold, abs=1e-8)
    assert located["flip"] == pytest.approx(flip, abs=1e-8)
    assert not branch.is_closed
    # Past the flip the motion exists, but is unstable, with the same approach speed.
    beyond = branch.data.where(branch.data.value > 1.1 * flip, drop=True)
    speed = 2 * math.pi / (1 + restitution)
    assert beyond.point.size > 5
    assert not beyond.stable.values.astype(bool).any()
    np.testing.assert_allclose(beyond.slowest_impact.values, speed, rtol=1e-9)
    # Multipliers have the sum and the product of the exact map.
    one = beyond.isel(point=-1)
    gamma = float(one.value)
    phase = -math.acos(fold / gamma) if float(one.multiplier_real.max()) > 1 else math.acos(fold / gamma)
    trace = 1 + restitution**2 - (1 + restitution) ** 2 * gamma * math.sin(phase)
    assert float(one.multiplier_real.sum()) == pytest.approx(trace, rel=1e-7)


def test_doubled_period_of_the_ball():
    """The branch that begins at the flip has twice the period and is stable at first."""
    flip = shaken.table_bounds(0.5, 1)[1]
    branch = table_branch(0.5, (1.0, 2.0))
    point = next(each for each in branch.specials if each.kind == "flip")
    doubled = branch.switch(point, (1.0, 1.6), progress=False)
    assert doubled.data.attrs["cycles"] == 2
    assert doubled.data.special.values[0] == "flip"
    assert doubled.data.stable.values[2]
    near = doubled.orbit(3)
    assert near.period == pytest.approx(4 * math.pi)
    speeds = [impact.approach_speed for impact in near.impacts]
    assert len(speeds) == 2
    assert abs(speeds[0] - speeds[1]) > 1e-3
    assert float(doubled.data.value.values[1:].min()) > flip


def largest_multiplier(clearance):
    """Return the largest multiplier of two impacts a cycle, less 1."""
    (exact,) = masri_caughey.orbits(0.1, 0.5, clearance)
    return float(np.abs(exact.multipliers()).max()) ** 2 - 1


def test_limits_of_stability_of_two_impacts():
    """Both limits of stability of two impacts a cycle over the gap are those of the closed form."""
    (exact,) = masri_caughey.orbits(0.1, 0.5, 20.0)
    case = impact_cases.impact_damper(exact, 2.0)
    branch = rb.continue_orbit(rb.find_orbit(case, period=1), "damper.gap", (4.0, 18.0), progress=False)
    assert branch.data.symmetric.values.astype(bool).all()
    values = branch.data.value.values
    changes = [p for p in branch.specials if p.kind in ("pitchfork", "torus", "fold")]
    assert changes
    for point in changes:
        near = 2 * point.value
        limit = brentq(largest_multiplier, near * 0.99, near * 1.01, xtol=1e-13)
        assert point.value == pytest.approx(limit / 2, rel=1e-8)
    # Amplitudes of all points, stable or not, are those of the closed form.
    for k in range(0, values.size, 7):
        (exact,) = masri_caughey.orbits(0.1, 0.5, 2 * float(values[k]))
        assert float(branch.data.slowest_impact[k]) == pytest.approx(exact.approach, rel=1e-9)
    assert float(branch.data.determinant_error.max()) < 1e-7


def test_limit_of_stability_over_gap_and_restitution():
    """The curve on which two impacts a cycle lose stability is that of the closed form over gap and restitution."""
    (exact,) = masri_caughey.orbits(0.1, 0.5, 20.0)
    orbit = rb.find_orbit(impact_cases.impact_damper(exact, 2.0), period=1)
    branch = rb.continue_orbit(orbit, "damper.gap", (4.0, 18.0), progress=False)
    axes = ("damper.gap", "method.restitution")
    for point in branch.specials:
        curve = rb.continue_point(point, axes, [(4.0, 18.0), (0.4, 0.6)], step=0.05, points=12, progress=False)
        assert curve.point.size > 8
        assert float(curve[axes[1]].max() - curve[axes[1]].min()) > 0.02
        for gap, restitution in zip(curve[axes[0]].values, curve[axes[1]].values, strict=True):
            (exact,) = masri_caughey.orbits(0.1, float(restitution), 2 * float(gap))
            values = exact.multipliers()
            nearest = values[np.argmin(np.abs(np.abs(values) - 1))]
            assert abs(nearest) == pytest.approx(1, abs=1e-8)


def test_curve_of_a_torus_ends_at_a_resonance():
    """A Neimark-Sacker curve ends where the pair of multipliers becomes real, and its points are limits of stability.

    It continued as a curve of saddles with multipliers r and 1/r; the curves of tests kept their pairs.
    """
    case = rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        load=rb.Harmonic(amplitude="5 N", frequency="33 Hz"),
        method=rb.Newton(),
        duration="3 s",
    )
    branch = rb.continue_orbit(rb.find_orbit(case), "load.frequency", ("33 Hz", "38 Hz"), progress=False)
    (point,) = branch.specials
    limits = [("25 Hz", "45 Hz"), ("2 N", "6 N")]
    curve = rb.continue_point(point, ("load.frequency", "load.amplitude"), limits, points=100, step=0.1, progress=False)
    assert "becomes real" in curve.attrs["ended"]
    angles = curve["angle"].values
    assert angles.size > 15
    assert 0 < angles.min() < 0.3
    # Strong resonances are named where the angle passes 90 and 120 degrees.
    passes = [(angles[:-1] - angle) * (angles[1:] - angle) < 0 for angle in (math.pi / 2, 2 * math.pi / 3)]
    counts = [int((curve["special"].values == name).sum()) for name in ("1:4 resonance", "1:3 resonance")]
    assert counts == [int(each.sum()) for each in passes]
    assert sum(counts) > 0


def oscillator(amplitude=1.0, gap=0.3):
    """Return an oscillator with a stop, and a state of its motion with one impact a cycle."""
    (exact, *_) = impact_oscillator.orbits(0.05, 2.0, gap / amplitude, 0.5)
    x, v = (amplitude * value for value in exact.state(1.0))
    return rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=1.0, damping_ratio=0.05, displacement=x, velocity=v),
        stop=rb.Stop(gap=gap, contact=rb.Linear(stiffness=1.0, restitution=0.5)),
        load=rb.Harmonic(amplitude=amplitude, frequency="2 rad/s", phase=2.0 + exact.load_phase + math.pi / 2),
        duration=30.0,
        method=rb.Newton(restitution=0.5),
    ), [x, v]


def test_grazing():
    """An impact vanishes where the motion without a stop just reaches it, and a multiplier grows as one over its speed."""
    case, start = oscillator()
    branch = rb.continue_orbit(rb.find_orbit(case, near=start, period=1), "stop.gap", (0.2, 0.4), progress=False)
    lost = next(point for point in branch.specials if point.kind == "impact lost")
    assert lost.value == pytest.approx(reach(2.0), abs=1e-7)
    # The derivative of the map is singular as one over the approach speed: their product has a limit.
    data = branch.data.isel(point=np.argsort(branch.data.slowest_impact.values)[:6])
    product = np.hypot(data.multiplier_real, data.multiplier_imaginary).max("multiplier") * data.slowest_impact
    np.testing.assert_allclose(product, product[0], rtol=0.05)


def test_near_miss_becomes_an_impact():
    """Without impacts the motion is that of the structure alone, up to the grazing."""
    case, _ = oscillator()
    wide = case.replaced({"stop.gap": 0.5})
    rest = rb.find_orbit(wide, near=[0.1, 0.1], period=1)
    assert not rest.impacts
    branch = rb.continue_orbit(rest, "stop.gap", (0.2, 0.6), progress=False)
    grazing = next(point for point in branch.specials if point.kind == "grazing")
    assert grazing.value == pytest.approx(reach(2.0), abs=1e-9)


def stopped(omega, restitution, gap, amplitude=1.0):
    """Return an oscillator with a rigid stop under a load of some circular frequency."""
    return rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=1.0, damping_ratio=0.05),
        stop=rb.Stop(gap=gap, contact=rb.Linear(stiffness=1.0, restitution=max(restitution, 0.1))),
        load=rb.Harmonic(amplitude=amplitude, frequency=f"{omega!r} rad/s"),
        duration=300.0,
        method=rb.Newton(restitution=restitution),
    )


def reach(omega):
    """Return the amplitude of the motion without a stop."""
    return 1 / abs(1 - omega**2 + 0.1j * omega)


@pytest.mark.parametrize(("omega", "folds"), [(0.45, False), (0.55, True), (0.9, False), (1.1, True), (2.5, False)])
def test_branch_past_a_grazing(omega, folds):
    """Past a grazing the branch has one impact more: it turns back or continues as the closed form of that motion does.

    The search for this motion began at the grazing state on the wrong side or with an overlap of the wrong order, so that
    many branches ended there; no test followed a branch from a near miss to an impact.
    """
    size = reach(omega)
    rest = rb.find_orbit(stopped(omega, 0.5, 1.1 * size), near=[0.1 * size, 0.0], period=1)
    branch = rb.continue_orbit(rest, "stop.gap", (0.9 * size, 1.3 * size), points=60, progress=False)
    point = next(each for each in branch.specials if each.kind == "grazing")
    assert point.value == pytest.approx(size, rel=1e-9)
    assert point.passage == ("nonsmooth fold, turns back with 1 impact" if folds else "continues with 1 impact")
    assert point.passage in str(branch)
    past = branch.data.isel(point=branch.data.impacts.values == 1).isel(point=slice(0, 20))
    assert (np.sign(past.value.values[0] - size) > 0) == folds
    for gap, speed in zip(past.value.values, past.slowest_impact.values, strict=True):
        exact = [each.speed for each in impact_oscillator.candidates(0.05, omega, float(gap), 0.5)]
        assert min(abs(each - speed) for each in exact) < 1e-8 * size


@pytest.mark.parametrize("gap", [0.3, 0.5])
def test_beginning_of_sticking(gap):
    """The mass begins to rest at the stop where its acceleration directly after the impact is zero in the closed form.

    The point was named after the first computed motion that sticks, up to a whole step away from the limit.
    """

    def departure(omega):
        return max(impact_oscillator.candidates(0.05, omega, gap, 0.0), key=lambda each: each.speed).departure

    limit = brentq(departure, 1.3, 1.6, xtol=1e-14) / (2 * math.pi)
    orbit = rb.find_orbit(stopped(1.6, 0.0, gap), period=1)
    branch = rb.continue_orbit(orbit, "load.frequency", ("1.25 rad/s", "1.7 rad/s"), progress=False)
    (point,) = (each for each in branch.specials if each.kind == "sticking")
    assert point.value == pytest.approx(limit, rel=1e-10)


def test_beginning_of_chatter():
    """The limit of complete chatter is located to 1e-8: the motion sticks below this frequency and not above it."""
    branch = rb.continue_orbit(
        rb.find_orbit(stopped(0.75, 0.2, 0.5), period=1), "load.frequency", ("0.7 rad/s", "0.78 rad/s"), progress=False
    )
    (point,) = (each for each in branch.specials if each.kind == "sticking")
    sticks = [
        rb.find_orbit(point.orbit.case.replaced({"load.frequency": point.value * side}), near=point.orbit).sticks
        for side in (1 - 1e-8, 1 + 1e-8)
    ]
    assert sticks == [True, False]


@pytest.mark.parametrize("kind", ["grazing", "impact lost"])
def test_curve_of_grazing(kind):
    """Over frequency and amplitude the stop is just reached where the amplitude of the linear motion is its gap.

    Curves of grazing were refused, so that no test compared one.
    """
    if kind == "grazing":
        orbit = rb.find_orbit(stopped(0.9, 0.5, 1.1 * reach(0.9)), near=[0.1, 0.0], period=1)
        branch = rb.continue_orbit(orbit, "stop.gap", (0.9 * reach(0.9), 1.3 * reach(0.9)), points=60, progress=False)
    else:
        orbit = rb.find_orbit(stopped(1.5, 0.5, 0.5))
        branch = rb.continue_orbit(orbit, "load.frequency", ("1.4 rad/s", "2 rad/s"), progress=False)
    point = next(each for each in branch.specials if each.kind == kind)
    axes, limits = ("load.frequency", "load.amplitude"), [("0.2 rad/s", "3 rad/s"), (0.01, 6.0)]
    curve = rb.continue_point(point, axes, limits, step=0.05, points=60, progress=False)
    assert curve.point.size > 40
    omega = 2 * math.pi * curve["load.frequency"].values
    assert omega.max() - omega.min() > 0.5
    gap = point.orbit.case.stops[0].gap
    np.testing.assert_allclose(curve["load.amplitude"].values, [gap / reach(each) for each in omega], rtol=1e-9)
    assert "smallest gap" in curve.attrs["equation"]
    assert np.isnan(curve["angle"].values).all()


def test_curve_of_sticking():
    """Over frequency and gap the mass begins to rest where its acceleration after an inelastic impact is zero."""
    orbit = rb.find_orbit(stopped(1.6, 0.0, 0.4), period=1)
    branch = rb.continue_orbit(orbit, "load.frequency", ("1.3 rad/s", "1.7 rad/s"), progress=False)
    (point,) = (each for each in branch.specials if each.kind == "sticking")
    axes, limits = ("load.frequency", "stop.gap"), [("1.2 rad/s", "1.8 rad/s"), (0.1, 0.8)]
    curve = rb.continue_point(point, axes, limits, step=0.1, points=8, progress=False)
    assert curve.point.size > 10
    for omega, gap in zip(2 * math.pi * curve["load.frequency"].values, curve["stop.gap"].values, strict=True):

        def departure(each, gap=gap):
            return max(impact_oscillator.candidates(0.05, each, gap, 0.0), key=lambda one: one.speed).departure

        assert omega == pytest.approx(brentq(departure, 0.99 * omega, 1.01 * omega, xtol=1e-14), abs=1e-9)


def riding(gap):
    """Return a plastic ball in a cavity that moves by 1 mm, with some gap on each side [m]."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz")),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="10 mm", material="steel"), gap=gap, contact=rb.Tsuji(restitution=0.5)
        ),
        method=rb.Newton(restitution=0.0),
        duration="2 s",
    )


def test_sticking_and_lost_impacts_of_a_ball():
    """A plastic ball rides on the walls up to a gap of pi/2 amplitudes, and is never touched beyond one amplitude.

    It leaves a wall where that has its greatest speed v, and needs half a cycle for the clearance: 2 gap = v T / 2. The
    limit of impacts was extrapolated from points that differed by rounding only.
    """
    branch = rb.continue_orbit(rb.find_orbit(riding(1.7e-3)), "damper.gap", (0.99e-3, 2e-3), progress=False)
    located = {point.kind: point for point in branch.specials}
    assert located["sticking"].value == pytest.approx(1e-3 * math.pi / 2, rel=1e-10)
    assert located["impact lost"].value == pytest.approx(1e-3, rel=1e-9)
    assert located["impact lost"].passage == "nonsmooth fold, turns back with 0 impacts"
    axes, limits = ("damper.gap", "structure.motion.amplitude"), [(0.5e-3, 3e-3), (0.5e-3, 2e-3)]
    curve = rb.continue_point(located["sticking"], axes, limits, step=0.2, points=6, progress=False)
    assert curve.point.size > 8
    np.testing.assert_allclose(curve[axes[0]].values, curve[axes[1]].values * math.pi / 2, rtol=1e-9)
    curve = rb.continue_point(located["impact lost"], axes, limits, step=0.2, points=6, progress=False)
    assert curve.point.size > 8
    np.testing.assert_allclose(curve[axes[0]].values, curve[axes[1]].values, rtol=1e-9)


def damped_by_a_plastic_ball(exact):
    """Return the case of a plastic ball in an oscillator."""
    return rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=1.0, damping_ratio=exact.zeta),
        damper=rb.ImpactDamper(
            ball=impact_cases.ball(exact.mass_ratio), gap=exact.gap, contact=rb.Tsuji(restitution=0.5)
        ),
        load=rb.Harmonic(amplitude=1.0, frequency=f"{exact.omega!r} rad/s"),
        method=rb.Newton(restitution=0.0),
        duration=400.0,
    )


@pytest.mark.parametrize(
    ("mass_ratio", "gap", "zeta", "omega"),
    [(0.1, 1.0, 0.02, 0.9), (0.1, 2.0, 0.02, 0.9), (0.05, 0.5, 0.05, 1.3), (0.2, 1.0, 0.05, 1.1), (0.2, 0.5, 0.1, 0.7)],
)
def test_ball_that_rides_on_the_walls(mass_ratio, gap, zeta, omega):
    """Impacts and multipliers of a plastic ball in an oscillator are those of the motion of both bodies, by its equations.

    A map that began while the ball rests had one impact more, of some nm/s; sticking was compared for an oscillator that
    rests at a stop and for a ball on a prescribed motion.
    """
    exact = riding_ball.motion(mass_ratio, gap, zeta, omega)
    orbit = rb.find_orbit(damped_by_a_plastic_ball(exact))
    assert orbit.sticks and orbit.is_symmetric
    assert len(orbit.impacts) == 2
    for impact in orbit.impacts:
        assert impact.approach_speed == pytest.approx(exact.approach, rel=1e-10)
    sizes = np.sort(np.abs(orbit.multipliers))
    np.testing.assert_allclose(sizes[:2], 0, atol=1e-12)
    np.testing.assert_allclose(sizes[2:], np.sort(np.abs(exact.multipliers())), rtol=1e-7)


def test_ball_ceases_to_ride_on_the_walls():
    """The ball ceases to ride at the gap at which no force would press it on the wall directly after the impact."""

    def pressing(gap):
        return riding_ball.motion(0.1, gap, 0.02, 1.1).pressing

    limit = brentq(pressing, 2.0, 6.0, xtol=1e-12)
    orbit = rb.find_orbit(damped_by_a_plastic_ball(riding_ball.motion(0.1, 0.8 * limit, 0.02, 1.1)))
    branch = rb.continue_orbit(orbit, "damper.gap", (0.7 * limit, 1.1 * limit), progress=False)
    (point,) = (each for each in branch.specials if each.kind == "sticking")
    assert point.value == pytest.approx(limit, rel=1e-9)


def test_three_hundred_points():
    """A branch of 300 points takes less than 10 s of processor time."""
    (exact,) = masri_caughey.orbits(0.1, 0.5, 20.0)
    orbit = rb.find_orbit(impact_cases.impact_damper(exact, 2.0), period=1)
    begin = time.process_time()
    branch = rb.continue_orbit(orbit, "damper.gap", (4.0, 18.0), step=0.004, progress=False)
    used = time.process_time() - begin
    assert used / len(branch) * 300 < 10
