"""Notches of profiles by a limit of the force on the base."""

import warnings
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.analysis import apparent_mass, notch, transfer_function

ZETA, HERTZ, MASS = 0.03, 80.0, 4.0
BOX = rb.Case(structure=rb.SDOF(mass=MASS, frequency=HERTZ, damping_ratio=ZETA), duration="1 s")
FLAT = [("20 Hz", "1.5 g"), ("300 Hz", "1.5 g")]
G = 9.80665


def exact(frequency: Any) -> Any:
    """Return the apparent mass of the box [kg]."""
    r = np.asarray(frequency) / HERTZ
    return MASS * (1 + 2j * ZETA * r) / (1 - r**2 + 2j * ZETA * r)


def test_apparent_mass_of_one_mass() -> None:
    """The apparent mass of a mass on a spring is that of the closed form."""
    frequency = np.geomspace(1, 2000, 201)
    assert apparent_mass(BOX, frequency).values == pytest.approx(exact(frequency), rel=1e-12)


def test_apparent_mass_with_a_tuned_mass() -> None:
    """With a tuned mass, whose damping couples the modes, it is that of the matrices of both masses."""
    tuned = rb.TunedMass(mass=0.5, frequency=70.0, damping_ratio=0.1)
    case = BOX.model_copy(update={"tuned_masses": (tuned,)})
    k, c = MASS * (2 * np.pi * HERTZ) ** 2, 2 * ZETA * MASS * 2 * np.pi * HERTZ
    own, loss = 0.5 * (2 * np.pi * 70) ** 2, 2 * 0.1 * 0.5 * 2 * np.pi * 70
    stiffness, damping = np.array([[k + own, -own], [-own, own]]), np.array([[c + loss, -loss], [-loss, loss]])
    frequency = np.linspace(5, 300, 60)
    expected = []
    for w in 2 * np.pi * frequency:
        moved = np.linalg.solve(stiffness + 1j * w * damping - w**2 * np.diag([MASS, 0.5]), [-MASS, -0.5])
        expected.append(-(k + 1j * w * c) * moved[0])
    assert apparent_mass(case, frequency).values == pytest.approx(np.array(expected), rel=1e-9)


def test_truncated_modes_keep_their_mass() -> None:
    """At low frequencies the apparent mass is the total mass, also if a structure has few of its modes."""
    tower = rb.ShearBuilding(masses=[3.0] * 5, stiffnesses=[4e4] * 5, damping_ratio=0.02)
    case = rb.Case(structure=tower, duration="1 s")
    assert complex(apparent_mass(case, [1e-3])[0]) == pytest.approx(15.0, rel=1e-6)


def test_a_sine_notch_is_at_the_limit() -> None:
    """In the notch the force is the limit, outside the profile is unchanged, and the depth is that of the closed form."""
    found = notch(FLAT, BOX, force="240 N")
    f, before, after = (found.levels[name].values for name in ("frequency", "before", "after"))
    force = after * np.abs(exact(f))
    inside = after < before
    assert force[inside] == pytest.approx(240, rel=1e-12) and (force <= 240 * (1 + 1e-12)).all()
    assert before == pytest.approx(1.5 * G, rel=1e-12) and (after[~inside] == before[~inside]).all()
    # The largest apparent mass is at r^2 = (sqrt(1 + 8 zeta^2) - 1) / (4 zeta^2).
    top = HERTZ * np.sqrt((np.sqrt(1 + 8 * ZETA**2) - 1) / (4 * ZETA**2))
    assert found.depth == pytest.approx(20 * np.log10(1.5 * G * abs(exact(top)) / 240), abs=1e-3)
    assert found.frequency == pytest.approx(top, rel=2e-3)
    assert found.levels.force_after.values == pytest.approx(force, rel=1e-12)
    # The lines of the new profile, also between its points.
    points = np.array(found.profile)
    fine = np.geomspace(20, 300, 200_001)
    line = np.exp(np.interp(np.log(fine), *np.log(points).T))
    assert (line * np.abs(exact(fine))).max() <= 240 * (1 + 5e-4)
    low, high = found.band
    assert abs(exact(low)) * 1.5 * G == pytest.approx(240, rel=0.02) == abs(exact(high)) * 1.5 * G


@pytest.mark.parametrize("zeta", [1e-4, 0.002, 0.3])
def test_narrow_and_broad_modes(zeta: float) -> None:
    """The force between the points of the profile stays within 0.05 % of the limit for any damping, with two modes."""
    modal = rb.ShearBuilding(masses=[2.0, 3.0], stiffnesses=[5e5, 7e5], damping_ratio=zeta)
    case = rb.Case(structure=modal, duration="1 s")
    found = notch(rb.Random([("10 Hz", 0.5), ("2 kHz", 0.5)], "1 s", unit="m/s^2"), case, force_density="40 N^2/Hz")
    points = np.array(found.profile.psd)
    natural = np.sqrt(case.modes.stiffness) / (2 * np.pi)
    steps = np.concatenate([-np.geomspace(1e-6, 0.3, 20_000), np.geomspace(1e-6, 0.3, 20_000)])
    fine = np.unique((natural[:, None] * (1 + steps)).ravel())
    density = np.exp(np.interp(np.log(fine), *np.log(points).T)) * np.abs(apparent_mass(case, fine).values) ** 2
    assert 40 * (1 - 1e-6) <= density.max() <= 40 * (1 + 5e-4)


def test_the_rms_force_is_the_limit() -> None:
    """A limit of the RMS force is met by the density, and by the force of a run within its scatter."""
    shaking = rb.Random([("20 Hz", "0.02 g^2/Hz"), ("500 Hz", "0.02 g^2/Hz")], "40 s", seed=3)
    found = notch(shaking, BOX, force_rms="70 N")
    density = found.profile.corners
    fine = np.geomspace(20, 500, 400_001)
    after = np.exp(np.interp(np.log(fine), *np.log(density).T)) * np.abs(exact(fine)) ** 2
    assert np.sqrt(np.trapezoid(after, fine)) == pytest.approx(70, rel=1e-3)
    assert found.profile.seed == 3 and found.profile.duration == 40

    def rms(base: rb.Random) -> float:
        case = BOX.model_copy(update={"base": (base,), "duration": 40.0, "output": rb.Output(rate="4 kHz")})
        return float(rb.simulate(case).summary().values["rms_interface_force"])

    assert rms(found.profile) == pytest.approx(70, rel=0.03) and rms(shaking) > 100


def test_a_sweep_with_a_notch_runs() -> None:
    """The force in a slow sweep with a notch reaches the limit; the sweep without one exceeds it four times."""
    sweep = rb.SineSweep(amplitude="0.4 g", first_frequency="50 Hz", last_frequency="130 Hz", sweep_rate="1 oct/min")
    found = notch(sweep, BOX, force="60 N")
    run = {"duration": sweep.length, "output": rb.Output(rate="2 kHz")}
    peaks = []
    for base in (sweep, found.profile):
        result = rb.simulate(BOX.model_copy(update={"base": (base,), **run}))
        assert not any("before 0 s" in note for note in result.notes)
        peaks.append(np.abs(result.arrays.interface_force).max())
    assert peaks[0] > 3 * 60 and peaks[1] == pytest.approx(60, rel=0.02)


def test_a_fast_sweep_warns_of_its_transients() -> None:
    """The largest force of a fast sweep over a narrow notch is that of a run, and the advice keeps it within the limit.

    The only sweep of the tests was slow, and the limit of the method was a sentence of the docstring.
    """
    narrow = rb.Case(structure=rb.SDOF(mass="3 kg", frequency="140 Hz", damping_ratio=0.006), duration="1 s")
    given = {"amplitude": "0.5 g", "first_frequency": "60 Hz", "last_frequency": "300 Hz"}
    fast = rb.SineSweep(**given, sweep_rate="8 oct/min")
    with pytest.warns(UserWarning, match=r"reaches .* times its limit; try: a lower sweep_rate, or force = ") as caught:
        found = notch(fast, narrow, force="400 N")

    def largest(base: Any) -> float:
        run = narrow.model_copy(update={"base": (base,), "duration": fast.length, "output": rb.Output(rate="8 kHz")})
        return float(np.abs(rb.simulate(run).arrays.interface_force).max())

    assert found.swept_force == pytest.approx(largest(found.profile), rel=0.01) and found.swept_force > 1.05 * 400
    advised = float(str(caught[0].message).rpartition("force = ")[2])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert largest(notch(fast, narrow, force=advised).profile) < 400
    slow = notch(rb.SineSweep(**given, sweep_rate="0.25 oct/min"), narrow, force="400 N")
    assert slow.swept_force == pytest.approx(400, rel=0.05)
    assert np.isnan(notch(FLAT, BOX, force="500 N").swept_force)


def test_a_transfer_function_of_a_damped_structure() -> None:
    """The force over the acceleration of a run with a ball is a structure, within the frequencies that it covers."""
    ball = rb.ImpactDamper(
        ball=rb.Sphere(radius="15 mm", material="steel"), gap="0.2 mm", contact=rb.Tsuji(restitution=0.5)
    )
    shaking = rb.Random([("30 Hz", "0.02 g^2/Hz"), ("200 Hz", "0.02 g^2/Hz")], "20 s", seed=1)
    output = rb.Output(rate="1 kHz")
    case = BOX.model_copy(update={"dampers": (ball,), "base": (shaking,), "duration": 20.0, "output": output})
    motion = rb.simulate(case).along()
    measured = transfer_function(motion.time, motion.base_acceleration, motion.interface_force, resolution=1.0)
    found = notch([("40 Hz", "1 g"), ("150 Hz", "1 g")], measured, force="100 N")
    assert found.levels.force_after.values.max() == pytest.approx(100, rel=1e-9)
    assert 0 < found.depth < notch([("40 Hz", "1 g"), ("150 Hz", "1 g")], BOX, force="100 N").depth
    with pytest.raises(rb.CaseError, match="is known from 0 to 500 Hz"):
        notch([("40 Hz", "1 g"), ("900 Hz", "1 g")], measured, force="100 N")
    with pytest.raises(rb.CaseError, match="not proportional to the motion"):
        notch(FLAT, case, force="100 N")


def test_a_force_below_the_limit_leaves_the_profile() -> None:
    """Without a notch the profile is the same, with a depth of 0."""
    found = notch(FLAT, BOX, force="1 MN")
    assert found.depth == 0 and "no notch" in repr(found) and np.isnan(found.band).all()
    assert np.array(found.profile) == pytest.approx(np.array([[20, 1.5 * G], [300, 1.5 * G]]))
    shaking = rb.Random([("20 Hz", "0.02 g^2/Hz"), ("500 Hz", "0.02 g^2/Hz")], "4 s")
    random = notch(shaking, BOX, force_rms="1 MN")
    assert random.profile.rms == pytest.approx(shaking.rms, rel=1e-12)
    # The words were those of a notch of 0.0 dB, depending on rounding; only the RMS was compared.
    other = rb.Case(structure=rb.SDOF(mass="5 kg", frequency="60 Hz", damping_ratio=0.015), duration="1 s")
    shaking = rb.Random([("20 Hz", "0.013 g^2/Hz"), ("300 Hz", "0.013 g^2/Hz")], "4 s")
    for found in (random, notch(shaking, other, force_rms="1 MN")):
        assert found.depth == 0 and "no notch" in repr(found)


@pytest.mark.parametrize(
    ("profile", "options", "message"),
    [
        (FLAT, {}, "needs one limit, force, not none"),
        (FLAT, {"force_rms": "3 N"}, "a sine profile needs one limit"),
        (FLAT, {"force": "3 kg"}, "force"),
        (FLAT, {"force": "-3 N"}, "greater than zero"),
        ([("20 Hz", "1 g")], {"force": "3 N"}, "must rise"),
        (rb.HalfSine(amplitude="3 g", duration="11 ms"), {"force": "3 N"}, "no levels over frequency"),
        ("sine", {"force": "3 N"}, "pairs of frequency and amplitude"),
        (rb.Random([(20, 1.0), (30, 1.0)], "1 s", unit="N"), {"force_rms": "3 N"}, "not an acceleration"),
        (rb.Random([(20, 1.0), (30, 1.0)], "1 s", unit="g"), {"force": "3 N"}, "random vibration needs one limit"),
        (rb.Random([(20, 1.0), (30, 1.0)], "1 s", unit="g"), {"force_density": "3 g^2/Hz"}, "density of a force"),
    ],
)
def test_limits_that_do_not_fit(profile: Any, options: dict[str, Any], message: str) -> None:
    """A limit of another kind, unit or sign, and a profile that is none, raise with what is needed."""
    with pytest.raises(rb.CaseError, match=message):
        notch(profile, BOX, **options)
    with pytest.raises(rb.CaseError, match="neither a case nor a transfer function"):
        notch(FLAT, "box", force="3 N")


def test_structures_without_damping_are_refused() -> None:
    """At a natural frequency without damping the apparent mass is infinite, which gave NaN as the depth of the notch."""
    bare = BOX.model_copy(update={"structure": rb.SDOF(mass=MASS, frequency=HERTZ)})
    with pytest.raises(rb.CaseError, match="no damping at 80 Hz"):
        notch(FLAT, bare, force="10 N")
    with pytest.raises(rb.CaseError, match="no damping at 80 Hz"):
        apparent_mass(bare, [10.0, 80.0])
    assert notch([("100 Hz", "1 g"), ("200 Hz", "1 g")], bare, force="10 N").depth > 0
