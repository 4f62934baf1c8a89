"""Cavities that turn about an axis of the machine, against closed forms in the machine frame."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb

BALL = rb.Material(name="ball", density=7800, young=2e9, poisson=0.3)
RADIUS = 2e-3
ROOM = rb.SphericalCavity(diameter="0.3 m")
MASS = 4 / 3 * math.pi * RADIUS**3 * 7800
INERTIA = 0.4 * MASS * RADIUS**2


def damper(positions: Any, cavity: Any, rotation: Any, **values: Any) -> rb.ParticleDamper:
    """Return a damper with balls at positions, without friction and gravity by default."""
    velocities = values.pop("velocities", None)
    values = {"contact": rb.Tsuji(restitution=0.5), "gravity": (0, 0, 0)} | values
    return rb.ParticleDamper(
        particles=rb.Particles(material=BALL, radius=RADIUS, count=len(positions)),
        cavity=cavity,
        packing=rb.Positions(positions=positions, velocities=velocities),
        rotation=rotation,
        **values,
    )


def run_of(damper: rb.ParticleDamper, duration: float, rate: float = 1000.0, dt: Any = "auto", **values: Any) -> rb.Run:
    """Run a damper on a fixed structure; its energy ledger must close."""
    values = {"structure": rb.Fixed()} | values
    run = rb.simulate(
        rb.Case(
            damper=damper, duration=duration, output=rb.Output(rate=rate), method=rb.Dem(dt=dt, threads=1), **values
        )
    )
    assert run.status == "finished"
    assert run.ledger.energy_residual < 2e-3
    return run


def in_machine(run: rb.Run) -> tuple[np.ndarray, np.ndarray]:
    """Return positions from the axis and velocities of all particles at the end, in the machine frame."""
    (damper,) = run.case.particle_dampers
    rotation, arrays = damper.rotation, run.arrays
    assert rotation is not None
    axis, angle = np.array([0.0, 0.0, 1.0]), float(arrays.cavity_angle[-1, 0])
    place = np.asarray(arrays.particles.position) + np.array(rotation.arm)
    speed = np.asarray(arrays.particles.velocity) + float(arrays.cavity_speed[-1, 0]) * np.cross(axis, place)
    return rotation.to_machine(place, angle), rotation.to_machine(speed, angle)


MOTIONS = {
    "constant": {"speed": "900 rpm"},
    "run-up": {"times": ["0 ms", "2 ms", "4 ms"], "speeds": ["100 rpm", "1500 rpm", "700 rpm"]},
    "angles": {"times": [0, 0.002, 0.004, 0.008], "angles": ["0 deg", "12 deg", "5 deg", "20 deg"]},
    "rocking": {"amplitude": "25 deg", "frequency": "80 Hz"},
    "both": {"speed": "-400 rpm", "amplitude": "5 deg", "frequency": "200 Hz", "angle": "30 deg"},
}


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("dt", ["auto", 2e-6])
def test_free_particle_moves_on_a_straight_line(motion: str, dt: Any) -> None:
    """A ball that touches nothing moves on a straight line in the machine, to rounding and with any step.

    No test saw a turning cavity, since cavities did not turn. The free motion is computed in the machine frame, so that the
    error has no order in the step: a scheme of order two would have 1e-6 here.
    """
    rotation = rb.Rotation(arm=("70 mm", "-20 mm", "5 mm"), **MOTIONS[motion])
    start, velocity, duration = np.array([5e-3, -4e-3, 3e-3]), np.array([0.3, -0.2, 0.1]), 0.005
    run = run_of(damper([start], ROOM, rotation, velocities=[velocity]), duration, dt=dt)
    begin = rotation.at(0.0)
    arm = start + np.array(rotation.arm)
    speed = rotation.to_machine(velocity + float(begin.speed) * np.cross([0.0, 0.0, 1.0], arm), begin.angle)
    place = rotation.to_machine(arm, begin.angle) + speed * duration
    end, end_speed = in_machine(run)
    assert np.abs(end[0] - place).max() < 1e-12
    assert np.abs(end_speed[0] - speed).max() < 1e-10
    assert run.arrays.cavity_angle[-1, 0] == pytest.approx(float(rotation.at(duration).angle), abs=1e-12)


def test_projectile_in_turning_cavity() -> None:
    """A ball flies on a parabola under gravity, whose direction turns in the cavity; its energy is kept."""
    rotation = rb.Rotation(arm=("50 mm", 0, 0), speed="600 rpm")
    run = run_of(damper([(0, 0, 0)], ROOM, rotation, gravity=(1.0, -9.81, 0.5)), 0.03)
    place = np.array([0.05, 0, 0]) + np.array([0, 0.05 * 20 * math.pi, 0]) * 0.03
    assert np.allclose(in_machine(run)[0][0], place + 0.5 * np.array([1.0, -9.81, 0.5]) * 0.03**2, atol=1e-12)
    total = run.ledger.total
    assert np.abs(total - total[0]).max() < 1e-12 * abs(total[0]) + 1e-15


def test_ball_in_radial_slot() -> None:
    """Without friction r = r0 cosh(Wt) + (v0/W) sinh(Wt), and the wall pushes with 2 m W r'."""
    speed, r0, v0, width = 50.0, 0.03, 0.2, 2 * RADIUS + 2e-6
    # The ball touches the trailing wall, in the radial plane through the axis.
    rotation = rb.Rotation(arm=("60 mm", 1e-6, 0), speed=speed)
    slot = rb.Box(size=("80 mm", width, "10 mm"))
    run = run_of(
        damper([(r0 - 0.06, -1e-6, 0)], slot, rotation, velocities=[(v0, 0, 0)], contact=rb.Tsuji(restitution=0.05)),
        0.025,
        20_000.0,
    )
    time = run.arrays.time
    exact = r0 * np.cosh(speed * time) + v0 / speed * np.sinh(speed * time)
    rate = r0 * speed * np.sinh(speed * time) + v0 * np.cosh(speed * time)
    assert (
        np.abs(run.arrays.centre_of_mass[:, 0, 0] + 0.06 - exact).max() < 5e-5 * exact[-1]
    )  # by the compliance of the wall
    late = time > 0.005
    force = run.arrays.turning_force[late, 0]
    assert np.allclose(-force[:, 1], 2 * MASS * speed * rate[late], rtol=5e-3)
    assert np.abs(force[:, [0, 2]]).max() < 1e-15
    # The drive supplies the kinetic energy that the ball gains, and the loss.
    gained = 0.5 * MASS * (rate**2 + (speed * exact) ** 2)
    assert run.arrays.drive_work[-1, 0] == pytest.approx(gained[-1] - gained[0], rel=2e-3)


@pytest.mark.parametrize("rolls", [True, False])
def test_oscillation_in_the_centrifugal_field(rolls: bool) -> None:
    """In a can whose axis is parallel to that of the rotation a ball swings with period 2 pi sqrt(7 (Rc - r) / (5 W^2 R)).

    Without friction it slides, and the factor 7/5 is missing. The Coriolis force is normal to the path.
    """
    speed, arm, can = 60.0, 0.1, 0.02
    swing, start = can - RADIUS, 0.06
    position = [swing * math.cos(start), swing * math.sin(start), 0]
    friction = {"friction": 2.0} if rolls else {}
    run = run_of(
        damper(
            [position],
            rb.Cylinder(diameter=2 * can, length="20 mm", axis="z"),
            rb.Rotation(arm=(arm, 0, 0), speed=speed),
            contact=rb.Tsuji(restitution=0.3),
            **friction,
        ),
        0.4,
        10_000.0,
    )
    across, time = run.arrays.centre_of_mass[:, 0, 1], run.arrays.time
    up = np.flatnonzero((across[:-1] < 0) & (across[1:] >= 0))
    crossings = time[up] - across[up] * (time[up + 1] - time[up]) / (across[up + 1] - across[up])
    period = np.diff(crossings).mean()
    exact = 2 * math.pi * math.sqrt((1.4 if rolls else 1.0) * swing / (speed**2 * arm))
    assert period == pytest.approx(exact * (1 + start**2 / 16), rel=1.5e-3)


def test_equilibrium_on_a_turning_wall() -> None:
    """A ball at rest on the outer wall presses with m W^2 r, and the drive does no work."""
    speed, arm, half = 80.0, 0.05, 0.01
    run = run_of(
        damper(
            [(half - RADIUS, 0, 0)],
            rb.Cylinder(diameter=2 * half, length="20 mm", axis="z"),
            rb.Rotation(arm=(arm, 0, 0), speed=speed),
            friction=0.5,
            rolling=0.1,
            contact=rb.Tsuji(restitution=0.1),
        ),
        0.05,
    )
    late = run.arrays.time > 0.02
    force, radius = run.arrays.turning_force[late, 0], arm + half - RADIUS
    assert np.allclose(force[:, 0], MASS * speed**2 * radius, rtol=1e-4)
    assert np.abs(force[:, 1:]).max() < 1e-4 * force[:, 0].max()
    assert np.allclose(np.linalg.norm(run.arrays.cavity_force[late, 0], axis=1), np.linalg.norm(force, axis=1))
    assert np.abs(np.asarray(run.arrays.particles.velocity)).max() < 1e-6
    assert np.abs(np.asarray(run.arrays.particles.spin)).max() < 1e-3
    assert np.abs(np.diff(run.arrays.drive_work[late, 0])).max() < 1e-9 * run.ledger.particles[0]


@pytest.mark.parametrize(("ratio", "stays"), [(1.03, True), (0.9, False)])
def test_critical_speed_of_a_drum(ratio: float, stays: bool) -> None:
    """A ball stays at the wall of a drum with lifters where W^2 R > g, and leaves it at the top where not."""
    radius = 0.05
    speed = math.sqrt(ratio * 9.81 / radius)
    # The drum turns about y: the slot between two lifters starts at the bottom.
    slot = rb.Box(size=(2 * RADIUS + 1e-7, "10 mm", 2 * (radius + RADIUS)))
    run = run_of(
        damper(
            [(0, 0, -radius)],
            slot,
            rb.Rotation(arm=(0, 0, 0), axis="y", speed=speed),
            gravity=(0, 0, -9.81),
            contact=rb.Tsuji(restitution=0.1),
        ),
        2 * math.pi / speed,
        2000.0,
    )
    depth = radius + run.arrays.centre_of_mass[:, 0, 2]
    assert (depth.max() < 1e-4) == stays
    if not stays:
        at_top = abs(run.arrays.cavity_angle[depth > 1e-4, 0][0] - math.pi)
        assert at_top < 0.6


def test_run_up_of_a_stuck_ball() -> None:
    """With W = a t the drive exerts the moment of inertia about the axis, of a ball that is held, times a."""
    acceleration, arm, duration = 400.0, 0.08, 0.1
    run = run_of(
        damper(
            [(0, 0, 0)],
            rb.Box(size=(2 * RADIUS * (1 + 1e-9),) * 3),
            rb.Rotation(arm=(arm, 0, 0), times=[0, duration], speeds=[0, acceleration * duration]),
            friction=1.0,
            contact=rb.Tsuji(restitution=0.1),
        ),
        duration,
        20_000.0,
    )
    inertia = MASS * arm**2 + INERTIA
    late = run.arrays.time > 0.02
    assert run.arrays.drive_torque[late, 0].mean() == pytest.approx(inertia * acceleration, rel=1e-3)
    energy = 0.5 * inertia * (acceleration * duration) ** 2
    assert run.arrays.drive_work[-1, 0] == pytest.approx(energy, rel=1e-3)
    assert run.ledger.particles[-1] == pytest.approx(energy, rel=1e-3)


def test_angular_momentum_in_a_smooth_can() -> None:
    """In a can without friction, centred on the axis, the angular momentum in the machine is kept and the drive is idle."""
    rng = np.random.default_rng(7)
    positions = rb.Lattice().place(rb.Cylinder(diameter="24 mm", length="16 mm", axis="z"), np.full(40, RADIUS))
    velocities = rng.normal(0, 0.3, (40, 3))
    can = rb.Cylinder(diameter="24 mm", length="16 mm", axis="z")
    rotation = rb.Rotation(arm=(0, 0, 0), times=[0, 0.05], speeds=["500 rpm", "-900 rpm"])
    run = run_of(damper(positions.tolist(), can, rotation, velocities=velocities.tolist()), 0.05)
    begin = velocities + 500 * math.pi / 30 * np.cross([0, 0, 1.0], positions)
    before = MASS * np.cross(positions, begin).sum(axis=0)[2]
    place, speed = in_machine(run)
    assert MASS * np.cross(place, speed).sum(axis=0)[2] == pytest.approx(before, rel=1e-9)
    assert np.abs(run.arrays.drive_torque).max() < 1e-12
    assert np.abs(run.arrays.drive_work).max() < 1e-15
    assert run.counts["first_touches_particle"] > 20


def bed(rotation: Any, **values: Any) -> rb.ParticleDamper:
    """Return a settled bed of 30 balls with friction and rolling resistance."""
    values = {"friction": rb.LinearSpring(0.3, ratio=0.3), "rolling": 0.02, "gravity": (0, 0, -9.81)} | values
    return rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="4 mm", count=30),
        cavity=rb.Box(size=("24 mm", "20 mm", "18 mm")),
        contact=rb.Linear(contact_time="0.3 ms", restitution=0.7),
        packing=rb.Settled(seed=1),
        rotation=rotation,
        **values,
    )


SHAKEN: dict[str, Any] = {
    "structure": rb.SDOF(mass="0.5 kg", frequency="60 Hz", damping_ratio=0.01, displacement="1 mm"),
    "load": rb.Harmonic(amplitude="20 N", frequency="60 Hz"),
}


def test_rotation_at_rest_is_the_plain_case() -> None:
    """A rotation with speed 0 gives the motion of a cavity without rotation, to rounding until chaos magnifies it."""
    still = rb.Rotation(arm=("60 mm", 0, 0), axis="y", speed=0.0)
    plain, turning = (run_of(bed(rotation), 0.01, 2000.0, dt=5e-6, **SHAKEN) for rotation in (None, still))
    for name in ("displacement", "centre_of_mass", "kinetic_energy", "cavity_force", "normal_loss", "sliding_loss"):
        one, other = getattr(plain.arrays, name), getattr(turning.arrays, name)
        assert np.abs(one - other).max() < 1e-7 * np.abs(one).max(), name


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("vibration", ["machine", "cavity"])
def test_ledger_closes_in_a_vibrating_bed(motion: str, vibration: Any) -> None:
    """The energy of structure and bed changes by the work of load, gravity and drive less the losses, with order two."""
    rotation = rb.Rotation(arm=("60 mm", 0, 0), axis="y", vibration=vibration, **MOTIONS[motion])
    runs = [run_of(bed(rotation), 0.03, 2000.0, dt=dt, **SHAKEN) for dt in (7e-6, 3.5e-6)]
    coarse, fine = (np.abs(run.ledger.residual).max() / run.ledger.losses[-1] for run in runs)
    assert coarse < 2e-3
    assert 2.5 < coarse / fine < 7
    assert np.abs(runs[0].arrays.drive_work[-1, 0]) > 0.01 * runs[0].ledger.losses[-1]
    assert runs[0].ledger.contact_loss[-1] > 0


def test_momentum_balance_in_the_machine() -> None:
    """The momentum of the bed in the machine changes by its weight and the force of the cavity, averaged over samples."""
    rotation = rb.Rotation(arm=("60 mm", 0, 0), axis="y", speed="600 rpm")
    run = run_of(bed(rotation), 0.02, 100_000.0, **SHAKEN)
    arrays = run.arrays
    mass = arrays.particle_mass[0]
    force = 0.5 * (arrays.cavity_force[1:, 0] + arrays.cavity_force[:-1, 0])
    change = np.cumsum((mass * np.array([0, 0, -9.81]) - force) * np.diff(arrays.time)[:, None], axis=0)
    gained = arrays.momentum[1:, 0] - arrays.momentum[0, 0]
    assert np.abs(gained - change).max() < 2e-3 * np.abs(gained).max()


def test_restart_and_threads_keep_the_bits(tmp_path: Path) -> None:
    """A turning run has the same bits with any number of threads, from a checkpoint, and continued at its end."""
    rotation = rb.Rotation(arm=("60 mm", 0, 0), axis="y", amplitude="20 deg", frequency="30 Hz", speed="500 rpm")
    method = rb.Dem(threads=1, dt=5e-6, checkpoint_every="8 ms")
    case = rb.Case(damper=bed(rotation), duration=0.02, output=rb.Output(rate=1000), method=method, **SHAKEN)
    whole = rb.simulate(case)
    two = rb.simulate(case.replaced({"method.threads": 2}))
    assert whole.arrays == two.arrays
    file = tmp_path / "turning.checkpoint"
    stopped = rb.simulate(case, checkpoint=file, progress=lambda done, _: done < 1000)
    assert stopped.status == "interrupted"
    assert rb.simulate(case, checkpoint=file).arrays == whole.arrays
    first = rb.simulate(case.replaced({"duration": 0.01}))
    rest = rb.simulate(case, start=first)
    for name in ("displacement", "centre_of_mass", "momentum", "cavity_angle", "turning_force"):
        assert np.array_equal(getattr(rest.arrays, name)[-1], getattr(whole.arrays, name)[-1]), name


def test_sweep_files_and_pictures(tmp_path: Path) -> None:
    """The speed is an axis of sweeps; files keep the arrays of a turning run; a format without a frame refuses it."""
    rotation = rb.Rotation(arm=("60 mm", 0, 0), axis="y", speed="100 rpm")
    case = rb.Case(damper=bed(rotation), duration=0.005, **SHAKEN)
    result = rb.sweep(case, {"damper.rotation.speed": ["100 rpm", "300 rpm"]})
    assert np.allclose(result["damper.rotation.speed"], [100 * math.pi / 30, 10 * math.pi])
    path = tmp_path / "turning.vtkhdf"
    run = rb.simulate(case.replaced({"output": rb.Output(snapshots=2)}), snapshots=path)
    run.save(tmp_path / "turning.nc")
    assert rb.load(tmp_path / "turning.nc").arrays == run.arrays
    with pytest.raises(rb.DataError, match="turns"):
        rb.Snapshots(path).to_ondem(tmp_path / "turning_ondem.vtkhdf")


def test_continued_run_at_another_speed() -> None:
    """A run that continues another one at another speed starts at its angle, and its ledger closes."""
    one = rb.Rotation(arm=("60 mm", 0, 0), axis="y", speed="500 rpm")
    case = rb.Case(damper=bed(one), duration=0.02, output=rb.Output(rate=1000), method=rb.Dem(threads=1), **SHAKEN)
    first = rb.simulate(case)
    rest = rb.simulate(case.replaced({"duration": 0.04, "damper.rotation.speed": "700 rpm"}), start=first)
    assert rest.status == "finished"
    assert rest.arrays.cavity_angle[0, 0] == pytest.approx(first.arrays.cavity_angle[-1, 0], abs=1e-12)
    turned = rest.arrays.cavity_angle[-1, 0] - rest.arrays.cavity_angle[0, 0]
    assert turned == pytest.approx(700 * math.pi / 30 * 0.02, rel=1e-9)
    assert rest.ledger.energy_residual < 2e-3
    moved = case.replaced({"duration": 0.04, "damper.rotation.arm": (0.07, 0, 0)})
    with pytest.raises(rb.CaseError, match="axis of the rotation"):
        rb.simulate(moved, start=first)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"speed": "700 rpm"}, "arm"),
        ({"arm": (0.1, 0, 0)}, "no angular velocity"),
        ({"arm": (0.1, 0, 0), "speed": "700 mm"}, "angular velocity"),
        ({"arm": ("60 deg", 0, 0), "speed": "700 rpm"}, "length"),
        ({"arm": (0.1, 0), "speed": "700 rpm"}, "three lengths"),
        ({"arm": (0.1, 0, 0), "speed": "700 rpm", "axis": (0, 0, 0)}, "must not be zero"),
        ({"arm": (0.1, 0, 0), "speed": "700 rpm", "axis": "w"}, "a direction is"),
        ({"arm": (0.1, 0, 0), "speed": 1, "times": [0, 1], "speeds": [0, 1]}, "exclude"),
        ({"arm": (0.1, 0, 0), "times": [0, 1], "speeds": [0]}, "same length"),
        ({"arm": (0.1, 0, 0), "times": [0, 0], "speeds": [0, 1]}, "increase"),
        ({"arm": (0.1, 0, 0), "times": [0, 1]}, "no angular velocity"),
        ({"arm": (0.1, 0, 0), "amplitude": "5 deg"}, "rocking"),
        ({"arm": (0.1, 0, 0), "speed": 1, "frequency": "5 Hz"}, "rocking"),
        ({"arm": (0.1, 0, 0), "amplitude": "-5 deg", "frequency": "5 Hz"}, "negative"),
        ({"arm": (0.1, 0, 0), "speed": float("nan")}, "finite"),
        ({"arm": (0.1, 0, 0), "speed": 1, "vibration": "rotor"}, "machine"),
    ],
)
def test_wrong_rotations_are_refused(values: dict[str, Any], message: str) -> None:
    """A rotation without an axis, an arm or a speed, or in wrong units, is refused by the name of the field."""
    with pytest.raises(rb.CaseError, match=message):
        rb.Rotation(**values)
