"""Accelerations and the force on the base, against equations of motion and derivatives."""

import math
from typing import Any

import numpy as np
import pytest

import rattlebox as rb

M, K, C = 4.0, 16e3, 30.0


def test_forced_oscillator_on_a_moving_base() -> None:
    """The absolute acceleration times the mass is the load minus the force on the base, which is K z + C z'."""
    case = rb.Case(
        structure=rb.SDOF(mass=M, stiffness=K, damping=C, displacement=1e-3),
        load=rb.Harmonic(amplitude=3.0, frequency=7.0),
        base=rb.Harmonic(amplitude=0.5, frequency=9.0),
        duration=1.0,
        output=rb.Output(rate=2000.0),
    )
    run = rb.simulate(case)
    motion = run.motion.sel(point="mass")
    force = K * motion.displacement + C * motion.velocity
    np.testing.assert_allclose(run.along().interface_force, force, atol=1e-12)
    np.testing.assert_allclose(M * motion.absolute_acceleration, run.motion["load"].sum("source") - force, atol=1e-11)
    np.testing.assert_allclose(
        motion.absolute_acceleration - motion.acceleration, run.along().base_acceleration, atol=1e-14
    )
    derivative = np.gradient(motion.velocity, motion.time)
    np.testing.assert_allclose(motion.acceleration[1:-1], derivative[1:-1], atol=1e-3 * np.abs(derivative).max())
    energy = 0.5 * (run.motion.modal_velocity**2 + K / M * run.motion.modal_displacement**2)
    np.testing.assert_allclose(energy, run.energy.mode_energy, rtol=1e-13)


def test_the_interface_force_of_a_building_balances_all_inertia() -> None:
    """Storey masses times absolute accelerations, contacts and a tuned mass included, add up to the force on the base."""
    mass, stiffness = np.diag([2.0, 1.0]), 1e4 * np.array([[2.0, -1.0], [-1.0, 1.0]])
    building = rb.Matrices(M=mass, C=[[0, 0], [0, 5]], K=stiffness, points={"first": 0, "second": 1})
    tuned = rb.TunedMass(mass=0.1, frequency=8.0, damping_ratio=0.1, point="second")
    ball = rb.ImpactDamper(
        ball=rb.Sphere(radius="12 mm", material="steel"),
        gap="0.2 mm",
        point="second",
        contact=rb.Tsuji(restitution=0.6),
    )
    case = rb.Case(
        structure=building, tuned_mass=tuned, damper=ball, base=rb.HalfSine(amplitude=30.0, duration=0.05), duration=0.5
    )
    run = rb.simulate(case)
    assert len(run.arrays.impacts) > 5
    masses = {"first": 2.0, "second": 1.0, "tuned mass": 0.1}
    inertia = sum(m * run.motion.absolute_acceleration.sel(point=name) for name, m in masses.items())
    contact = run.along().cavity_force.sum("damper")
    expected = contact - inertia
    np.testing.assert_allclose(run.along().interface_force, expected, atol=1e-9 * float(abs(contact).max()))


@pytest.mark.parametrize("base", [(), rb.Harmonic(amplitude=3.0, frequency=20.0, direction="z")])
def test_three_dimensions(base: Any) -> None:
    """In 3-D the force on the base balances the inertia along each axis, with particles in the cavity."""
    structure = rb.Modal(
        frequencies=[30.0, 40.0],
        damping_ratios=[0.01, 0.02],
        shapes={"box": [[0.5, 0.0, 0.0], [0.0, 0.0, 0.5]]},
        participation=[[2.0, 0.0, 0.0], [0.0, 0.0, 2.0]],
        velocity=[0.4, 0.3],
    )
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="6 mm", count=20),
        cavity=rb.Box(size=("20 mm",) * 3),
        contact=rb.Tsuji(restitution=0.6),
        friction=0.2,
        packing=rb.Lattice(),
        softening=1000,
    )
    run = rb.simulate(
        rb.Case(structure=structure, damper=damper, base=base, duration=0.05, output=rb.Output(rate=4000.0))
    )
    motion = run.motion
    for axis in "xz":
        acceleration = motion.absolute_acceleration.sel(point=f"box {axis}")
        contact = motion.cavity_force.sel(axis=axis).sum("damper")
        expected = contact - 4.0 * acceleration
        np.testing.assert_allclose(motion.interface_force.sel(axis=axis), expected, atol=1e-9)
    assert float(abs(motion.interface_force.sel(axis="y")).max()) == 0.0


def test_the_interface_force_of_a_fixed_cavity() -> None:
    """The force on the base of a fixed structure is the contact force; without participations it is NaN."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="5 mm", material="steel"), gap="1 mm", velocity=1.0, contact=rb.Tsuji(restitution=0.6)
    )
    run = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, duration=0.01))
    np.testing.assert_array_equal(run.motion.interface_force, run.motion.cavity_force.isel(damper=0))
    modal = rb.Modal(frequencies=[10.0], damping_ratios=[0.1], shapes={"tip": [1.0]}, velocity=[1.0])
    assert np.isnan(rb.simulate(rb.Case(structure=modal, duration=0.1)).motion.interface_force).all()


def test_measures_of_acceleration() -> None:
    """Peak and RMS absolute acceleration of a sweep agree with those of a run."""
    case = rb.Case(
        structure=rb.SDOF(mass=M, stiffness=K, damping=C),
        base=rb.Harmonic(amplitude=0.5, frequency=9.0),
        duration=2.0,
        output=rb.Output(rate=1000.0),
    )
    result = rb.sweep(case, {"base.amplitude": [0.5, 1.0]}, ["peak_acceleration", "rms_acceleration"], skip=1.0)
    run = rb.simulate(case)
    late = run.motion.absolute_acceleration.sel(point="mass", time=slice(1.0, 2.0))
    assert float(result.peak_acceleration[0]) == pytest.approx(float(abs(late).max()), rel=1e-4)
    assert float(result.rms_acceleration[0]) == pytest.approx(math.sqrt(float((late**2).mean())), rel=1e-3)
    assert float(result.rms_acceleration[1]) == pytest.approx(2 * float(result.rms_acceleration[0]), rel=1e-9)


@pytest.mark.parametrize("samples_per_cycle", [5.3, 8.3, 20.0])
@pytest.mark.parametrize("driven", ["load", "base"])
def test_rms_accelerations_of_a_harmonic_motion_are_exact(samples_per_cycle: float, driven: str) -> None:
    """RMS and peak acceleration of a vibration are those in closed form with a few samples a cycle, in both engines.

    No test saw that they were too small by (pi f dt)^2 / 6, 6 % with 5.3 samples: tests had a hundred samples a cycle, or
    allowed for the mean over a step.
    """
    structure, frequency, cycles = rb.SDOF(mass=2.5, frequency=13.0, damping_ratio=0.08), 11.0, 31
    signal = rb.Harmonic(amplitude=4.0, frequency=frequency)
    still = rb.ImpactDamper(
        ball=rb.Sphere(diameter="4 mm", mass="0.1 g", material="steel"), gap="1 m", contact=rb.Tsuji(restitution=0.5)
    )
    grain = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="1 mm", count=1),
        cavity=rb.Box(size=("0.5 m", "0.5 m", "0.5 m")),
        contact=rb.Tsuji(restitution=0.5),
        packing=rb.Lattice(),
        gravity=(0.0, 0.0, 0.0),
        softening=1e4,
    )
    omega, own = 2 * np.pi * frequency, 2 * np.pi * 13.0
    dynamic = own**2 - omega**2 + 2j * 0.08 * own * omega
    relative = abs(omega**2 * (4.0 / 2.5 if driven == "load" else 4.0) / dynamic)
    absolute = relative if driven == "load" else abs(4.0 * (own**2 + 2j * 0.08 * own * omega) / dynamic)
    for damper in (still, grain):
        case = rb.Case(
            structure=structure,
            damper=damper,
            duration=(cycles + 42) / frequency,
            output=rb.Output(rate=samples_per_cycle * frequency),
            **{driven: signal},
        )
        count = 1 + round(cycles * samples_per_cycle)
        names = ["rms_acceleration", "rms_relative_acceleration", "peak_acceleration"]
        result = rb.sweep(
            case, {f"{driven}.amplitude": [4.0]}, names, skip=42 / frequency, samples=count, progress=False
        )
        assert float(result.rms_acceleration[0]) == pytest.approx(absolute / math.sqrt(2), rel=2e-3)
        assert float(result.rms_relative_acceleration[0]) == pytest.approx(relative / math.sqrt(2), rel=2e-3)
        assert float(result.peak_acceleration[0]) == pytest.approx(absolute, rel=0.02)
        values = rb.simulate(case).summary().values
        assert values["steady_rms_acceleration[mass]"] == pytest.approx(absolute / math.sqrt(2), rel=2e-3)
        assert values["steady_rms_displacement[mass]"] == pytest.approx(relative / omega**2 / math.sqrt(2), rel=2e-3)


def test_short_pulses_of_loads_count_in_accelerations() -> None:
    """A pulse between two samples adds its mean over the step to the acceleration."""
    case = rb.Case(
        structure=rb.SDOF(mass=2.0, frequency=2.0),
        load=rb.HalfSine(amplitude="300 N", duration="0.4 ms", start="20.3 ms"),
        duration="0.1 s",
        output=rb.Output(rate="1 kHz"),
    )
    impulse = 2 / np.pi * 300 * 0.4e-3 / 2.0
    values = rb.simulate(case).summary().values
    assert values["peak_acceleration[mass]"] == pytest.approx(impulse / 1e-3, rel=1e-2)
    result = rb.sweep(case, {"load.amplitude": [300.0]}, ["peak_acceleration", "rms_acceleration"], samples=101)
    assert float(result.peak_acceleration[0]) == pytest.approx(values["peak_acceleration[mass]"], rel=1e-6)
    assert float(result.rms_acceleration[0]) == pytest.approx(values["rms_acceleration[mass]"], rel=1e-6)


def test_hard_impacts_have_no_finite_acceleration() -> None:
    """Hard impacts have no peak of force or acceleration, whereas the same balls with contacts of a duration have one.

    Only the contact force was left out: means over steps without a duration, across an impact, gave up to 1e15 m/s^2, and
    the other tests of accelerations have contacts with a duration.
    """
    for method, is_hard in ((rb.Newton(), True), (rb.EventDriven(), False)):
        case = rb.Case(
            structure=rb.SDOF(mass=2.0, frequency=18.0, damping_ratio=0.01),
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius="18 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.7)
            ),
            load=rb.Harmonic(amplitude=6.0, frequency=18.0),
            method=method,
            duration="2 s",
        )
        run = rb.simulate(case)
        values = run.summary().values
        names = ["peak_contact_force", *(f"{kind}_damper_force[damper]" for kind in ("peak", "rms"))]
        names += [f"{kind}_acceleration[mass]" for kind in ("peak", "rms", "steady_rms")]
        for name in names:
            assert math.isnan(float(values[name])) == is_hard, name
        assert math.isnan(rb.analysis.largest_acceleration(run)) == is_hard
        assert float(values["peak_displacement[mass]"]) > 0


def test_truncated_modes_follow_the_base() -> None:
    """Two of twenty modes with the residual mass give the base force of the full model at low frequencies."""
    motion = rb.HalfSine(amplitude=30.0, duration=0.2)
    full = rb.ShearBuilding(masses=[1000.0] * 20, stiffnesses=[4e7] * 20, damping_ratio=0.02)
    modes = full.modes()
    selected = {"frequencies": (np.sqrt(modes.stiffness[:2]) / (2 * math.pi)).tolist(), "damping_ratios": [0.02, 0.02]}
    selected |= {
        "shapes": {"top": modes.shapes["storey 20"][:2].tolist()},
        "participation": modes.participation[:2].tolist(),
    }
    assert modes.residual_mass == pytest.approx(0.0, abs=1e-9 * modes.total_mass)
    forces = {}
    for name, structure in {
        "full": full,
        "truncated": rb.Modal(**selected),
        "corrected": rb.Modal(**selected, total_mass="20 t"),
    }.items():
        run = rb.simulate(rb.Case(structure=structure, base=motion, duration=0.5, output=rb.Output(rate=4000)))
        forces[name] = run.motion.interface_force.interp(time=np.arange(0.0, 0.5, 1e-3))
        assert any("total_mass" in note for note in run.notes) == (name == "truncated")
    early = {name: force.sel(time=slice(0, 0.2)) for name, force in forces.items()}
    largest = float(abs(forces["full"]).max())
    lacking = float(abs(early["truncated"] - early["full"]).max()) / largest
    corrected = float(abs(early["corrected"] - early["full"]).max()) / largest
    assert lacking > 0.05
    assert corrected < 0.01
    # The structure follows a slow base motion as a rigid body.
    slow = rb.Harmonic(amplitude=1.0, frequency=0.05, phase=math.pi / 2)
    run = rb.simulate(rb.Case(structure=rb.Modal(**selected, total_mass="20 t"), base=slow, duration=60.0))
    late = run.motion.sel(time=slice(40, 60))
    np.testing.assert_allclose(late.interface_force, -20e3 * late.base_acceleration, atol=0.03 * 20e3)


@pytest.mark.parametrize(
    ("structure", "mass"),
    [
        (
            rb.Beam(length="0.4 m", width="30 mm", height="20 mm", material="steel", tip_mass="0.3 kg", mode_count=40),
            None,
        ),
        (rb.Plate(length="0.5 m", width="0.4 m", thickness="4 mm", material="aluminium", mode_count=200), None),
        (rb.ShearBuilding(masses=[2.0, 1.0], stiffnesses=[1e4, 1e4], damping_ratio=0.01), 3.0),
        (rb.SDOF(mass=3.0, frequency=10.0), 3.0),
    ],
)
def test_the_residual_mass_of_built_in_structures(structure: Any, mass: float | None) -> None:
    """The residual mass of structures with many modes is small and never negative."""
    modes = structure.modes()
    if mass is not None:
        assert modes.total_mass == pytest.approx(mass)
    assert -1e-9 * modes.total_mass <= modes.residual_mass < 0.08 * modes.total_mass


def test_the_residual_mass_with_a_tuned_mass() -> None:
    """A tuned mass does not change the residual mass."""
    beam = rb.Beam(length="0.4 m", width="30 mm", height="20 mm", material="steel", mode_count=2, damping_ratio=0.01)
    tuned = rb.TunedMass(mass="50 g", frequency="80 Hz", damping_ratio=0.1, point="tip")
    case = rb.Case(structure=beam, tuned_mass=tuned, duration=0.1)
    assert case.modes.residual_mass == pytest.approx(beam.modes().residual_mass, rel=1e-9)
    assert beam.modes().residual_mass > 0.1 * beam.modes().total_mass


def test_a_total_mass_below_the_effective_masses() -> None:
    """A total mass below the effective mass of the modes is refused."""
    with pytest.raises(rb.CaseError, match="more than the total mass"):
        rb.Modal(frequencies=[10], damping_ratios=[0.01], shapes={"a": [1.0]}, participation=[2.0], total_mass="1 kg")


def test_base_motions_with_small_participation() -> None:
    """A base motion with very small participation of the modes gives a warning."""
    for participation, warned in ((1e-5, True), (0.9, False)):
        modal = rb.Modal(frequencies=[10], damping_ratios=[0.01], shapes={"a": [1.0]}, participation=[participation])
        run = rb.simulate(rb.Case(structure=modal, base=rb.HalfSine(amplitude=1.0, duration=0.01), duration=0.1))
        assert any("excites the modes" in note for note in run.notes) == warned
