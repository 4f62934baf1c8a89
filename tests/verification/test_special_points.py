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
