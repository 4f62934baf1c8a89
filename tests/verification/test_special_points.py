"""Special points of branches: curves that begin where a branch ends, and branches with soft contacts near grazing."""

import itertools
import math

import numpy as np
import pytest

import rattlebox as rb


def damped(frequency="33 Hz", amplitude="5 N"):
    """Return an impact damper with two impacts a cycle."""
    return rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness="38 kN/m", damping_ratio=0.012),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="14 mm", material="steel"), gap="0.95 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        load=rb.Harmonic(amplitude=amplitude, frequency=frequency),
        method=rb.Newton(),
        duration="3 s",
    )


AXES, LIMITS = ("load.frequency", "damper.gap"), [("24 Hz", "40 Hz"), ("0.7 mm", "1.3 mm")]


def test_curve_and_switch_from_the_end_of_a_branch():
    """A branch that begins at a pitchfork and ends at another one has both as points of the symmetric motion.

    Curves from the point at the end had one point, because the map over the whole period is singular there; tests followed
    pitchforks of symmetric branches only.
    """
    branch = rb.continue_orbit(rb.find_orbit(damped()), "load.frequency", ("24 Hz", "40 Hz"), progress=False)
    below, above = (point for point in branch.specials if point.kind == "pitchfork")
    crooked = branch.switch(above, progress=False)
    begin, end = (point for point in crooked.specials if point.kind == "pitchfork")
    for point, same in ((begin, above), (end, below)):
        assert point.value == pytest.approx(same.value, rel=1e-9)
        assert point.orbit.is_symmetric
        one, other = (rb.continue_point(each, AXES, LIMITS, points=5, progress=False) for each in (point, same))
        assert one.sizes["point"] == 11
        # Both have points at other places of the same line.
        line = np.polynomial.Polynomial.fit(other[AXES[1]].values, other[AXES[0]].values, 5)
        np.testing.assert_allclose(one[AXES[0]].values, line(one[AXES[1]].values), rtol=1e-7)
    again = crooked.switch(end, points=20, progress=False)
    assert not again.data.symmetric.values[1:].any()


@pytest.mark.parametrize("ratio", [1.15, 1.25, 1.4, 1.55, 1.7])
@pytest.mark.parametrize("restitution", [0.2, 0.5])
def test_curve_of_grazing_of_a_stop(ratio, restitution):
    """Where a stop is just reached, its curve over frequency and gap is the resonance curve of the structure alone.

    Located points had gaps of the size at which a near miss counts as a contact, so that some curves were refused.
    """
    stiffness, force, zeta = 9e4, 250.0, 0.05
    omega = ratio * math.sqrt(stiffness)

    def reach(omega):
        return force / abs(stiffness - omega**2 + 2j * zeta * math.sqrt(stiffness) * omega)

    case = rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness=stiffness, damping_ratio=zeta),
        stop=rb.Stop(gap=2.5 * reach(omega), contact=rb.Linear(stiffness=2e6, restitution=0.5)),
        load=rb.Harmonic(amplitude=force, frequency=omega / (2 * math.pi)),
        method=rb.Newton(restitution=restitution),
        duration="2 s",
    )
    f = omega / (2 * math.pi)
    free = rb.find_orbit(case, near=[0.1 * reach(omega), 0.0], period=1)
    rest = rb.find_orbit(case.replaced({"stop.gap": 1.03 * reach(omega)}), near=free)
    branch = rb.continue_orbit(rest, "load.frequency", (0.8 * f, 1.2 * f), points=40, step=0.03, progress=False)
    point = next(each for each in branch.specials if each.kind == "grazing")
    limits = [(0.8 * f, 1.2 * f), (0.7 * reach(omega), 1.4 * reach(omega))]
    curve = rb.continue_point(point, ("load.frequency", "stop.gap"), limits, points=8, progress=False)
    assert curve.sizes["point"] > 8
    exact = [reach(2 * math.pi * each) for each in curve["load.frequency"].values]
    np.testing.assert_allclose(curve["stop.gap"].values, exact, rtol=1e-9)


def soft():
    """Return a tuned mass and a soft damper, whose motions with four and with five impacts exist at the same load."""
    return rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness="12.558 kN/m", damping_ratio=0.042059),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="5.0557 mm", material="steel"), gap="0.48984 mm", contact=rb.Tsuji(restitution=0.3)
        ),
        tuned_mass=rb.TunedMass(mass="36.996 g", frequency="18.6387 Hz", damping_ratio=0.067166),
        loads=[
            rb.Harmonic(amplitude="2.6313 N", frequency="12.979 Hz"),
            rb.Harmonic(amplitude="0.32275 N", frequency="19.4685 Hz", phase="2.44072 rad"),
        ],
        duration="7 s",
    )


def test_branch_does_not_jump_over_a_grazing():
    """A soft branch with five impacts folds before it grazes, and has a curve where the impact is lost.

    A step led from the motion with five impacts to the one with four, which both exist there, and the loss of an impact
    was named at the fold; folds on the last part before a grazing were missed, too. No test had soft contacts.
    """
    path = "loads[0].amplitude"
    branch = rb.continue_orbit(rb.find_orbit(soft()), path, (2.11, 2.9), points=60, step=0.03, progress=False)
    located = {point.kind: point for point in branch.specials}
    assert {"fold", "impact lost"} <= located.keys()
    lost = located["impact lost"]
    assert lost.value > located["fold"].value + 0.03
    assert lost.passage == "nonsmooth fold, turns back with 4 impacts"
    assert lost.passage in str(branch)
    # Without the impact the ball just touches the wall there, and passes it by at a smaller load.
    below = [
        rb.find_orbit(
            lost.orbit.case.replaced({path: lost.value - change}), near=_without(branch, lost.value), period=1
        )
        for change in (2e-3, 1e-3)
    ]
    gaps = [each.nearest_miss.gap for each in below]
    assert [len(each.impacts) for each in below] == [4, 4]
    assert gaps[0] / gaps[1] == pytest.approx(2, abs=1e-2)
    curve = rb.continue_point(
        lost, (path, "damper.gap"), [(2.0, 2.6), (4.5e-4, 5.4e-4)], points=4, step=0.05, progress=False
    )
    assert curve.sizes["point"] == 9
    # Neighbouring points with maps that begin at the same time are near each other.
    data = branch.data
    sizes = np.abs(data.state.values).max(axis=0)
    for k, j in itertools.pairwise(range(len(branch))):
        if float(data.phase[k]) == float(data.phase[j]):
            assert np.abs((data.state.values[k] - data.state.values[j]) / sizes).max() < 0.1


def _without(branch, value):
    """Return the motion with four impacts at the point of a branch that is nearest to a value."""
    four = np.flatnonzero(branch.data.impacts.values == 4)
    return branch.orbit(int(four[np.argmin(np.abs(branch.data.value.values[four] - value))]))


def test_branch_ends_at_its_limit_before_it_grazes():
    """A branch whose next grazing is outside the limits ends at the limit.

    Its points continued to the grazing outside, which could then not be followed between the limits.
    """
    stiffness, force, zeta, omega = 4e4, 30.0, 0.04, 260.0
    reach = force / abs(stiffness - omega**2 + 2j * zeta * math.sqrt(stiffness) * omega)
    case = rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness=stiffness, damping_ratio=zeta),
        stop=rb.Stop(gap=1.3 * reach, contact=rb.Linear(stiffness=2e6, restitution=0.5)),
        load=rb.Harmonic(amplitude=force, frequency=omega / (2 * math.pi)),
        method=rb.Newton(restitution=0.5),
        duration="2 s",
    )
    rest = rb.find_orbit(case, near=[0.1 * reach, 0.0], period=1)
    assert not rest.impacts
    for limit, step in itertools.product((1.001, 1.01, 1.03), (0.02, 0.05, 0.1)):
        limits = (limit * reach, 1.5 * reach)
        branch = rb.continue_orbit(rest, "stop.gap", limits, step=step, progress=False)
        values = branch.data.value.values
        assert not branch.specials
        assert (values.min(), values.max()) == pytest.approx(limits, rel=1e-12)
        assert not branch.data.attrs["ended"]


def test_curve_where_a_contact_divides():
    """The curve on which a lasting contact divides into two is a straight line over gap and load, if contacts are linear.

    Then all lengths of a motion are proportional to the load. Curves of such points were refused.
    """
    case = rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness="31.3 kN/m", damping_ratio=0.021),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="11.1 mm", material="steel"),
            gap="0.695 mm",
            contact=rb.Linear(stiffness="3.43 MN/m", restitution=0.3),
        ),
        load=rb.Harmonic(amplitude="5.15 N", frequency="28.15 Hz"),
        duration="3.2 s",
    )
    axes, limits = ("damper.gap", "load.amplitude"), [("0.6 mm", "0.9 mm"), ("4.5 N", "6 N")]
    branch = rb.continue_orbit(rb.find_orbit(case), axes[0], limits[0], points=20, step=0.04, progress=False)
    point = next(each for each in branch.specials if each.kind == "grazing")
    assert point.passage == "continues with 8 impacts"
    curve = rb.continue_point(point, axes, limits, points=3, step=0.1, progress=False)
    assert curve.sizes["point"] == 7
    assert "pressed together" in curve.attrs["equation"]
    ratio = curve[axes[0]].values / curve[axes[1]].values
    np.testing.assert_allclose(ratio, point.value / 5.15, rtol=1e-8)


def biased(gravity=0.0, second=0.0, ratio=2):
    """Return a symmetric case that gravity or a second load makes asymmetric."""
    case = damped()
    loads = [*case.loads, rb.Harmonic(amplitude=second, frequency=f"{33 * ratio} Hz", phase="0.4 rad")]
    return case.replaced({"loads": loads, "damper.gravity": gravity})


@pytest.mark.parametrize(
    ("axis", "limits"),
    [("damper.gravity", (-1.0, 1.0)), ("loads[1].amplitude", (0.0, 2.0)), ("damper.gap", (8e-4, 1.1e-3))],
)
def test_parameter_that_breaks_the_symmetry(axis, limits):
    """Motions stay symmetric along a parameter only if the case does; gravity and even harmonics break the symmetry.

    The whole branch had the map over half a period of its first motion, whose fixed points are no motions then: speeds of
    impacts were wrong by 5 %. Only parameters that keep the symmetry were tested.
    """
    branch = rb.continue_orbit(rb.find_orbit(biased()), axis, limits, points=25, step=0.1, progress=False)
    breaks = axis != "damper.gap"
    assert branch.data.value.values[[0, -1]] == pytest.approx(limits)
    assert branch.data.symmetric.values.all() == (not breaks)
    for k in (0, 3, -1):
        orbit = branch.orbit(k)
        run = orbit.run().arrays
        np.testing.assert_allclose(run.displacement[-1], run.displacement[0], rtol=1e-8)
        same = rb.find_orbit(orbit.case, near=orbit, period=1)
        speeds = [sorted(impact.approach_speed for impact in each.impacts) for each in (orbit, same)]
        np.testing.assert_allclose(speeds[0], speeds[1], rtol=1e-9)


def test_pitchfork_in_a_plane_without_symmetry():
    """A pitchfork is refused in a plane in which only one line has symmetric cases, with the reason."""
    branch = rb.continue_orbit(rb.find_orbit(damped()), "load.frequency", ("31 Hz", "35 Hz"), progress=False)
    (point,) = (each for each in branch.specials if each.kind == "pitchfork")
    with pytest.raises(rb.CaseError, match="only in symmetric cases"):
        rb.continue_point(point, ("load.frequency", "damper.gravity"), [("31 Hz", "35 Hz"), (-1, 1)], progress=False)


@pytest.mark.parametrize(("axis", "high"), [("structure.damping_ratio", 0.02), ("stop.gap", 4e-4)])
def test_limit_at_the_last_valid_value(axis, high):
    """A branch reaches a limit beyond which no case exists, such as a gap or a damping ratio of 0.

    A step beyond the limit raised the error of a negative value.
    """
    case = damped()
    if axis == "stop.gap":
        stop = rb.Stop(gap="0.2 mm", contact=rb.Linear(stiffness="2 MN/m", restitution=0.5))
        case = case.replaced({"dampers": (), "stops": (stop,), "load.amplitude": "30 N", "load.frequency": "41 Hz"})
    branch = rb.continue_orbit(rb.find_orbit(case), axis, (0, high), points=60, progress=False)
    assert branch.data.value.values[[0, -1]].tolist() == [0, high]
    assert not branch.data.attrs["ended"]


def test_amplitude_of_a_subharmonic_load_to_zero():
    """Limits that include the amplitude 0 of a load that doubles the period are refused; motions have other cycles there."""
    orbit = rb.find_orbit(biased(second=0.2, ratio=0.5))
    with pytest.raises(rb.CaseError, match="limits without 0"):
        rb.continue_orbit(orbit, "loads[1].amplitude", (0, 0.4), progress=False)
    branch = rb.continue_orbit(orbit, "loads[1].amplitude", (0.01, 0.4), points=20, step=0.1, progress=False)
    assert branch.data.value.values[[0, -1]] == pytest.approx([0.01, 0.4])


def test_route_of_period_doublings():
    """Each doubled branch of a ball in a shaken box is stable at first, and doubles again.

    The first point of a new branch was so far from its beginning that a stable part shorter than this was missed.
    """
    case = rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1.2 mm", frequency="25 Hz")),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="8 mm", material="steel"), gap="0.6 mm", contact=rb.Tsuji(restitution=0.75)
        ),
        method=rb.Newton(),
        duration="6 s",
    )
    axis, limits, values = "structure.motion.amplitude", ("0.3 mm", "3 mm"), []
    branch = rb.continue_orbit(rb.find_orbit(case, period=1), axis, limits, progress=False)
    for _ in range(3):
        flips = [point for point in branch.specials if point.kind == "flip"]
        point = min(
            (each for each in flips if not values or each.value > values[-1] * (1 + 1e-9)), key=lambda p: p.value
        )
        values.append(point.value)
        branch = branch.switch(point, points=15, progress=False)
        assert branch.data.stable.values[1]
    ratio = (values[1] - values[0]) / (values[2] - values[1])
    assert 3 < ratio < 8  # towards the constant of Feigenbaum, 4.67


def lying(restitution):
    """Return a ball that lies on the floor of a cavity at the tip of a structure with two modes."""
    return rb.Case(
        structure=rb.Modal(frequencies=[17.0, 45.9], damping_ratios=[0.03, 0.02], shapes={"tip": [0.9, 0.5]}),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="13 mm", material="steel"),
            gap="1.2 mm",
            contact=rb.Tsuji(restitution=0.4),
            gravity="9.81 m/s^2",
        ),
        load=rb.Harmonic(amplitude="2 N", frequency="13 Hz"),
        method=rb.Newton(restitution=restitution),
        duration="6 s",
    )


@pytest.mark.parametrize("restitution", [0.0, 0.4])
def test_ball_that_lies_on_the_floor(restitution):
    """A ball that rests at all times moves with the structure, with its multipliers, and leaves the floor at 1 g.

    Searches began at the last sample in flight, in the transient, and found no motion; along the branch the ball hit the
    floor at speeds of rounding, which changed multipliers and stability; the end of the rest was not named. Tests had balls
    that rest for a part of the period only.
    """
    case = lying(restitution)
    shape, omega, zeta = np.array([0.9, 0.5]), 2 * np.pi * np.array([17.0, 45.9]), np.array([0.03, 0.02])
    mass = np.eye(2) + 7850 * 4 / 3 * np.pi * 0.013**3 * np.outer(shape, shape)
    damping, stiffness = np.diag(2 * zeta * omega), np.diag(omega**2)
    system = np.block(
        [[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)]]
    )
    exact = np.sort_complex(np.exp(np.linalg.eigvals(system) / 13.0))
    drive = 2 * np.pi * 13.0
    reply = shape @ np.linalg.solve(stiffness + 1j * drive * damping - drive**2 * mass, shape)
    lifts = 9.81 / (drive**2 * abs(reply))

    branch = rb.continue_orbit(rb.find_orbit(case), "load.amplitude", (1.0, 1.2 * lifts), points=120, progress=False)
    data = branch.data
    multipliers = data.multiplier_real.values + 1j * data.multiplier_imaginary.values
    resting = data.impacts.values == 0
    assert resting.sum() > 20
    assert (data.value.values[resting] <= lifts * (1 + 1e-9)).all()
    for row in multipliers[resting]:
        sizes = np.argsort(np.abs(row))
        np.testing.assert_allclose(row[sizes[:2]], 0, atol=1e-12)
        np.testing.assert_allclose(np.sort_complex(row[sizes[2:]]), exact, rtol=1e-9)
    assert data.stable.values.all()
    (point,) = branch.specials
    assert point.kind == "grazing"
    assert point.value == pytest.approx(lifts, rel=1e-9)


def test_order_of_impacts_of_two_dampers():
    """A branch ends where impacts of two dampers coincide, because the motion with the other order is another one.

    A step led over the jump to the other motion, so that the stability changed without a special point: sequences were
    compared without their order, and a jump was only noticed by the direction of the branch. Tests had one damper.
    """
    case = rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness="12.1 kN/m", damping_ratio=0.071),
        dampers=[
            rb.ImpactDamper(
                name=name, ball=rb.Sphere(radius=radius, material="steel"), gap=gap, contact=rb.Tsuji(restitution=0.3)
            )
            for name, radius, gap in (("one", "7.2 mm", "0.61 mm"), ("other", "9 mm", "0.64 mm"))
        ],
        load=rb.Harmonic(amplitude="2.85 N", frequency="14.1 Hz"),
        method=rb.Newton(restitution=0.3),
        duration="8 s",
    )
    branch = rb.continue_orbit(rb.find_orbit(case), "dampers[0].gap", ("0.52 mm", "0.74 mm"), points=40, progress=False)
    orders = [[impact.contact for impact in branch.orbit(k).impacts] for k in range(len(branch))]
    # Without an impact more or less in between, impacts of different dampers keep their order.
    for one, other in itertools.pairwise(orders):
        assert one == other or sorted(one) != sorted(other)
    assert "coincide" in branch.data.attrs["ended"]


def test_motion_without_losses():
    """Impacts below the speed of yield lose nothing: the multipliers are on the circle along the branch, and are no torus.

    Rounding made a Neimark-Sacker bifurcation of it every few points, and changed the stability. Tests had constant
    restitution below 1.
    """
    case = rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="0.4 mm", frequency="14 Hz")),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="11 mm", material="steel"),
            gap="0.45 mm",
            contact=rb.Tsuji(restitution=rb.JacksonGreen()),
        ),
        duration="4 s",
    )
    branch = rb.continue_orbit(
        rb.find_orbit(case, period=1), "structure.motion.amplitude", ("0.3 mm", "0.5 mm"), points=60, progress=False
    )
    assert [point.kind for point in branch.specials] == ["pitchfork", "flip"]
    stable = branch.data.stable.values.astype(bool)
    flip = branch.specials[1].index
    assert stable[1:flip].all()
    assert not stable[flip + 1 :].any()
    assert branch.orbit(5).stability == "at the limit of stability"
